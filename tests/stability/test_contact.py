"""Contact and friction at the extremes."""

import math
import random
import re

import h5py
import numpy as np
from blocks import write
from deck_runs import HERTZ, copy_deck
from outcomes import contact, solve_all
from physics import material, mesh, nodes_of
from report import Table, check_rows, verdict
from test_held import strip

import one_pair

TITLE = "Contact"
TEXT = """
Contact states are found for coefficients of friction up to 10, also of 300 random blocks that are
pressed, pushed and lifted: no run of this section ends early, none needs a cut-back, and none of
the 16,169 increments violates the conditions of contact by more than 1e-10. [Every run makes this check](theory.md#7-checks-on-every-increment).

- Beyond the friction at which uniqueness ends, the state of the increment before is kept as long as
  it is valid, and the run reports other states where it proves them.
- Without friction the final state depends on the load alone. With it, five cycles of opening and
  closing repeat to the last digit, and tractions of a reversed push are the negative ones to 4e-12.
- Slip under cycles dies out or continues as Melan's theorem says.
- Strips up to 2000 times as long as they are high, held by contact alone, carry their load to 1e-6.
"""
DETAILS = """
The violation is relative to the largest displacement or force. The last table has the largest
violation in all runs of this section.
"""
IN_DOCUMENT = []
ROUNDING = 1e-9  # of the largest value; some hundred unknowns condensed and recovered leave 1e-12
PROVEN = []  # outcomes of all runs


def solved(decks):
    """Solve decks; keep their outcomes for the last table, and return them."""
    PROVEN.extend(outcomes := solve_all(decks))
    return outcomes


def solved_one(folder, name, *cards):
    """Write and solve one deck, which must end well; return its path."""
    deck = write(folder / f"{name}.inp", ["*OPTIONS, WIDTH=200"], *cards)
    (outcome,) = solved([deck])
    assert not outcome.message, outcome.message
    return deck


def faces(friction, slave="UP.BOTTOM", master="LO.TOP"):
    """Return the cards of the contact."""
    cards = ["*SURFACE INTERACTION, NAME=F", *(["*FRICTION", f"{friction!r}"] if friction else [])]
    return [*cards, "*CONTACT PAIR, INTERACTION=F, NAME=P", f"{slave}, {master}"]


def step(*cards, increment="1., 1.", analysis="*STATIC"):
    """Return the cards of a step."""
    return ["*STEP, INC=1000", analysis, increment, *cards, "*END STEP"]


# Random blocks

RANGES = [0.1, 0.3, 1.0, 3.0, 10.0]
DECKS = 300
# Of these the tests run the first ones, of the decks whose increments may be cut back fewer: none
# needs it. Among them are two of those at which several states are proven.
TESTED, TESTED_CUT = 30, 10


def random_deck(folder, seed, analysis):
    """Return a deck of a block that is pressed on another one and pushed about; its friction."""
    r = random.Random(7 * seed + 1)
    kind, columns = r.choice(["CPE8", "CPE4", "CPE6", "CPE3"]), r.choice([3, 6, 10, 16])
    friction, gap = 10 ** r.uniform(-1, 1), r.choice([0.0, 0.0, 1e-3, 5e-3])
    tilt = r.choice([0.0, 0.0, 2e-3, -1e-3])
    xs = [2.0 * i / columns for i in range(columns + 1)]
    upper = mesh("UP", xs, [0.0, 0.3, 1.0], kind, to=lambda x, y: (x, y + gap + tilt * x))
    cards = [*upper, *mesh("LO", xs, [-1.0, -0.3, 0.0], kind, first=1001),
             *material("UP", (1000.0, 0.3)),
             *material("LO", (10 ** r.uniform(2, 6), r.choice([0.0, 0.3, 0.45]))),
             *faces(friction)]
    for _ in range(6):
        down = gap + 10 ** r.uniform(-4, -2) - r.choice([0.0, 0.0, 0.005])
        cards += step(
            "*BOUNDARY", "LO.BOTTOM, 1, 2", f"UP.TOP, 2, 2, {-down!r}",
            f"UP.TOP, 1, 1, {r.uniform(-0.01, 0.01)!r}", "*DSLOAD",
            f"UP.LEFT, P, {r.uniform(-3, 3)!r}", f"UP.RIGHT, P, {r.uniform(-3, 3)!r}",
            "*CONTACT FILE, FREQUENCY=0", analysis=analysis,
            increment=f"{r.choice(['0.1', '0.5', '1.'])}, 1.")
    # The others estimate their errors, too.
    errors = "NO" if "DIRECT" in analysis else "YES"
    return write(folder / f"random{seed}.inp", [f"*OPTIONS, WIDTH=200, ERRORS={errors}"],
                 cards), friction


def random_blocks(folder, fixed, cut):
    """Return the table of the random blocks, so many with fixed increments and with such that may
    be cut back."""
    table = Table(
        "Random blocks",
        ["friction", "runs", "increments", "cut-backs", "runs that end early",
         "runs with DIRECT", "of these end early", "several states proven",
         "largest violation", "verdict"],
        text=f"""{fixed} blocks above a base that is 0.1 to 1000 times as stiff, with and without a gap and a slope between them, of elements of 8, 6, 4
and 3 nodes; six steps of random motion down and aside, with lifts, and of pressures on the sides, in 1, 2 or 10 increments each. All of them are solved
again with DIRECT, which allows no cut-back.""")
    free, direct = (blocks_of(folder / name, analysis, number) for name, analysis, number in (
        ("cut", "*STATIC", cut), ("fixed", "*STATIC, DIRECT", fixed)))
    for low, high in zip(RANGES, RANGES[1:], strict=False):
        of_free, of_fixed = ([o for o, mu in found if low <= mu < high] for found in (free, direct))
        both = of_free + of_fixed
        ended = [sum(bool(o.message) for o in some) for some in (of_free, of_fixed)]
        table.rows.append(
            [f"{low} to {high}", len(of_free), sum(o.increments for o in of_free),
             sum(o.cut_backs for o in of_free), ended[0], len(of_fixed), ended[1],
             sum(o.several for o in both), max(v for o in both for v in o.violations),
             verdict(ended == [0, 0])])
    return table


def blocks_of(folder, analysis, count):
    """Return the outcomes of so many random blocks, with their friction."""
    folder.mkdir()
    decks = [random_deck(folder, seed, analysis) for seed in range(count)]
    outcomes = solved([deck for deck, _ in decks])
    return [(outcome, mu) for outcome, (_, mu) in zip(outcomes, decks, strict=True)]


# One pair whose uniqueness ends

SPRINGS, MANY = ((2.0, -0.8), (-0.8, 1.0)), 2.0
PUSHES = [0.5, 1.2, 1.3, 1.6, 1.9, 1.99, 2.01, 2.2, 2.0, 1.6, 1.3, 1.24, 1.0, 0.5, 0.0, -0.5, -1.9]
CLOSES = -1.25  # where the open pair closes again, by hand: S_tt c_n = S_nt c_t

PAIR = """
*NODE
1, 0., 0.
2, 0.8, 0.2
3, 0., 1.
4, 0., {below}
5, 0.8, {beside}
6, 0., -2.
*ELEMENT, TYPE=CPE3, ELSET=UP
1, 1, 2, 3
*ELEMENT, TYPE=CPE3, ELSET=LO
2, 4, 6, 5
*SURFACE, NAME=ABOVE
1, S1
*SURFACE, NAME=BELOW
2, S3
*MATERIAL, NAME=M
*ELASTIC, TYPE=ORTHO
1., {d1122}, 3., 0., 0., 1., 1., 1.
1.
*SOLID SECTION, ELSET=UP, MATERIAL=M
1.25
*SOLID SECTION, ELSET=LO, MATERIAL=M
1.25
*BOUNDARY
2, 1, 2
3, 1, 2
4, 1, 2
5, 1
6, 1, 2
"""


def springs(coupling, gap=0.0):
    """Return the cards of one pair on the springs (2, coupling; coupling, 1).

    The shape function of node 1 of the upper triangle has the gradient (-1, -1), on which its
    stiffness is (D1111 + D1212, D1122 + D1212; ., D2222 + D1212)/2; both faces slope alike, so that
    the normal is along y. The other pair stays wide open.
    """
    return PAIR.format(below=-gap, beside=-gap - 0.2, d1122=-2.0 * coupling - 1.0)


def one_pair_table(folder):
    """Return the table of a pair that is pushed until it lets go, and back."""
    table = Table(
        "Friction 2 on coupled springs: where uniqueness ends",
        ["push", "valid states", "state found", "error of gap and forces", "verdict"],
        text="""One contact point on the springs S = (2, -0.8; -0.8, 1), a triangle with one free node, pressed by
1 and pushed aside. Uniqueness ends at friction 1/0.8. By hand (tests/reference/one_pair.py)
between pushes of 1.25 and 2 it may stick or be open: it lets go at 2 and closes again at 1.25.
The state of the increment before is kept as long as it is valid. The run reports other states
only where it proves them, which is where the path of states turns back: never here, sometimes
above.""")
    pushes = [step("*CLOAD", "1, 2, -1."), *(step("*CLOAD", f"1, 1, {-push}") for push in PUSHES)]
    deck = solved_one(folder, "pair", springs(SPRINGS[0][1]), faces(MANY, "ABOVE", "BELOW"), *pushes)
    gap, pressure, shear, status, weight = contact(
        deck, "P", "gap", "pressure", "shear", "status", "weight")
    reference, opened = 0.0, False
    for row, push in enumerate(PUSHES, start=1):
        if opened and status[row, 0] != 0:
            reference = CLOSES
        holds = one_pair.states(SPRINGS, MANY, (1.0, -push), reference)
        found = ["open", "slip", "stick"][status[row, 0]]
        force = pressure[row, 0] * weight[0], shear[row, 0] * weight[0]
        error, state = min(((abs(s.gap - gap[row, 0]) + abs(s.force - force[0])
                             + abs(s.shear - force[1]), s) for s in holds if s.name == found),
                           default=(math.inf, None), key=lambda pair: pair[0])
        stays = [s for s in holds if s.name != "slip"] if len(holds) > 1 else holds
        kept = state in stays and (len(stays) == 1 or (found == "open") == opened)
        table.rows.append([push, ", ".join(s.name for s in holds), found, error,
                           verdict(error < ROUNDING and kept)])
        opened = found == "open"
        reference = state.place if state else reference
    return table


# Advancing, receding and closing again

LAYER = [0.05 * i for i in range(33)] + [1.7, 1.85, 2.1, 2.5, 3.0, 4.0]
HALF_LOAD = 0.5


def layers(loads):
    """Return the half of two equal layers, pressed together by loads on half their height's width:
    each lies on the other as on a rigid base without friction."""
    ys = [0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0]
    pressed = sum(x < HALF_LOAD - 1e-9 for x in LAYER[:-1])
    rows = (len(ys) - 2) * (len(LAYER) - 1)
    cards = [*mesh("UP", LAYER, ys), *mesh("LO", LAYER, [-y for y in ys[::-1]], first=5001),
             *material("UP", (1000.0, 0.3)), *material("LO", (1000.0, 0.3)), *faces(0.0),
             "*NSET, NSET=MIDDLE", "UP.LEFT, LO.LEFT"]
    below = next(n for n, p in nodes_of(cards).items() if p == (0.0, -1.0))
    held = ["*BOUNDARY", "MIDDLE, 1", f"{below}, 2"]
    for load in loads:
        pressures = [f"{first + rows + k}, P{side}, {load!r}"
                 for first, side, rows in ((1, 3, rows), (5001, 1, 0)) for k in range(pressed)]
        cards += step(*held, "*DLOAD", *pressures)
    return cards


def receding_contact(folder):
    """Return the table of a layer that lifts off when it is pressed."""
    table = Table("Receding contact", ["load", "half-width", "difference from the first load", "verdict"],
                  text="""A layer of height 1 on a rigid base without friction, pressed over a width of 1: contact shrinks at
once, to a size that does not depend on the load; [verification.md](verification.md) judges that size.""")
    loads = [1.0, 10.0, 1e-3]
    deck = solved_one(folder, "layer", layers(loads))
    pressure, edges, status = contact(deck, "P", "pressure", "edge_contact", "status")
    for k, load in enumerate(loads):
        change = abs(pressure[k] / load - pressure[0]).max() / pressure[0].max()
        holds = change < ROUNDING and (status[k] == status[0]).all()
        holds &= abs(edges[k] - edges[0]) < ROUNDING
        table.rows.append([load, edges[k], change, verdict(holds)])
    return table


def advancing_contact(folder):
    """Return the table of Hertz's contact as the load grows."""
    table = Table("Advancing contact", ["load", "half-width over theory", "verdict"],
                  text="Hertz (input/hertz), without friction: the half-width grows with the root of the load.")
    deck = copy_deck(HERTZ, folder / "hertz.inp")
    (outcome,) = solved([deck])
    theory = float(re.search(r"a  = ([\d.]+)", HERTZ.read_text())[1])
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        load, edges = file["history/time"][()], file["contact/FACE/edge_contact"][()]
    for at, edge in zip(load, edges, strict=True):
        part = edge / theory / at**0.5
        table.rows.append([at, part, verdict(not outcome.message and abs(part - 1) < 0.02)])
    return table


def closing_again(folder):
    """Return the table of cycles that open and close the same contact."""
    table = Table("Open, closed, open again: five cycles",
                  ["case", "contact points closed, most and fewest", "difference between cycles", "verdict"],
                  text="""Frictionless states depend on the load alone, and friction starts anew whenever a contact point
closes. So every cycle ends like the first.""")
    xs = [0.25 * i for i in range(9)]
    blocks = [*mesh("UP", xs, [0.01, 0.3, 1.0]), *mesh("LO", xs, [-1.0, -0.3, 0.0], first=1001),
              *material("UP", (1000.0, 0.3)), *material("LO", (5000.0, 0.45))]
    for name, friction in (("blocks, no friction", 0.0), ("blocks, friction 0.3", 0.3),
                           ("blocks, friction 10", 10.0)):
        moves = [(-0.03, 0.02), (0.0, 0.0)] * 5
        cards = [*blocks, *faces(friction)]
        for down, aside in moves:
            cards += step("*BOUNDARY", "LO.BOTTOM, 1, 2", f"UP.TOP, 2, 2, {down}",
                          f"UP.TOP, 1, 1, {aside}", increment="0.25, 1.")
        table.rows.append(cycle_row(name, solved_one(folder, f"again{friction}", cards), 8))
    deck = solved_one(folder, "relayered", layers([1.0, 0.05, 3.0, 0.2] * 5))
    table.rows.append(cycle_row("layer, pressed more and less", deck, 4))
    return table


def cycle_row(name, deck, period):
    """Return a row on five cycles of so many increments."""
    found = contact(deck, "P", "gap", "pressure", "shear")
    closed = (contact(deck, "P", "status")[0] != 0).sum(axis=1)
    cycles = [values.reshape(5, period, -1) for values in found]
    change = max(abs(rows - rows[0]).max() / max(abs(rows).max(), 1e-300) for rows in cycles)
    return [name, f"{closed.max()} and {closed.min()}", change, verdict(change < ROUNDING)]


# Shakedown and loops

RUB = 0.5
PARTS = [(0.0, 0.95), (0.0, 1.5), (0.0, 1.95), (0.0, 2.1), (0.0, 2.5), (-1.0, 0.95), (-1.0, 1.05)]


def mirrored(friction, places):
    """Return two blocks, each the other's mirror image, pressed and then moved through places:
    their pressure does not feel the shear. (The lower one is held, which is a shift of both.)"""
    xs = [0.2 * i for i in range(11)]
    ys = [0.0, 0.15, 0.4, 1.0]
    cards = [*mesh("UP", xs, ys), *mesh("LO", xs, [-y for y in ys[::-1]], first=1001),
             *material("UP", (1000.0, 0.3)), *material("LO", (1000.0, 0.3)), *faces(friction),
             *step("*BOUNDARY", "LO.BOTTOM, 1, 2", "UP.TOP, 2, 2, -0.01", "UP.TOP, 1, 1, 0.")]
    for place in places:
        cards += step("*BOUNDARY", f"UP.TOP, 1, 1, {place!r}", increment="0.25, 1.")
    return cards


def shakedown(folder):
    """Return the table of a block sheared to and fro."""
    table = Table(
        "Shakedown", ["cycle between", "slip of the first loading", "slip of the 2nd cycle",
                      "slip of the 8th cycle", "ratio to the 7th", "expected", "verdict"],
        text="""Two blocks that mirror each other, so that shear does not change their pressure, moved between two positions, in
units of the move at which the first contact point slips. Melan's theorem is valid for such contact (A. Klarbring, M. Ciavarella, J. R. Barber,
Int. J. Solids Struct. 44, 2007, 8355): slip dies out if some frozen state of slip keeps all contact points within their friction: here
if the positions are less than 2 apart. Slip: the largest motion of a contact point within a cycle, in the same units.""")
    unit = 1e-3
    deck = solved_one(folder, "stuck", mirrored(1000.0, [unit]))
    pressure, shear = contact(deck, "P", "pressure", "shear")
    first = float(unit * (RUB * pressure[0] / abs(shear[-1])).min())
    for low, high in PARTS:
        places = [first * part for _ in range(8) for part in (high, low)]
        (slip,) = contact(solved_one(folder, f"shaken{low}{high}", mirrored(RUB, places)),
                          "P", "slip")
        slip = np.diff(slip, axis=0) / first
        of = [abs(np.cumsum(slip[8 * k:8 * k + 8], axis=0)).max() for k in range(8)]
        loading = abs(slip[:4].sum(axis=0)).max()
        ends, ratio = high - low < 2.0, of[7] / of[6] if of[6] > ROUNDING else 0.0
        holds = ratio < 0.9 if ends else 0.99 < ratio < 1.01 and of[7] > 1e-3
        holds &= (loading > ROUNDING) == (high > 1.0)
        table.rows.append([f"{low} and {high}", loading, of[1], of[7], ratio,
                           "dies out" if ends else "continues", verdict(holds)])
    return table


RADIUS, YOUNG, POISSON, MINDLIN = 1e4, 1e4, 0.3, 0.4
SPACING = 0.1


def cylinders(down, moves):
    """Return two equal bodies, one of them curved, pressed and then moved through places."""
    half, size = [SPACING * i for i in range(13)], SPACING
    while half[-1] < 40.0:
        size *= 1.5
        half.append(half[-1] + size)
    ys, size = [0.0, SPACING], SPACING
    while ys[-1] < 40.0:
        size *= 1.5
        ys.append(ys[-1] + size)
    xs, height = [-x for x in half[:0:-1]] + half, ys[-1]
    cards = [*mesh("UP", xs, ys, to=lambda x, y: (x, y + (1 - y / height) * x * x / 2 / RADIUS)),
             *mesh("LO", xs, [-y for y in ys[::-1]], first=20001),
             *material("UP", (YOUNG, POISSON)), *material("LO", (YOUNG, POISSON)),
             *faces(MINDLIN)]
    cards += step("*BOUNDARY", "LO.BOTTOM, 1, 2", "UP.TOP, 1, 1, 0.", f"UP.TOP, 2, 2, {-down!r}",
                  "*NODE FILE, FREQUENCY=0")
    for move in moves:
        cards += step("*BOUNDARY", f"UP.TOP, 1, 1, {move!r}", increment="0.2, 1.")
    return cards


def partial_slip(folder):
    """Return the table of cylinders in partial slip, pushed to and fro."""
    table = Table(
        "Partial slip of cylinders", ["shear traction", "change", "verdict"],
        text="""Two equal cylinders are pressed together and pushed to and fro: the tractions repeat in every cycle, and
those of a reversed push are the negative ones. [verification.md](verification.md) compares them with Cattaneo and Mindlin.""")
    reach = 1.1e-4
    deck = solved_one(folder, "mindlin", cylinders(2e-4, [reach, -reach, reach, -reach, reach]))
    (shear,) = contact(deck, "P", "shear")
    scale = abs(shear).max()
    for name, one, other in (("the same a cycle later", 5, 15), ("two cycles later", 5, 25),
                             ("reversed, with the opposite sign", 5, 10)):
        sign = -1 if other == 10 else 1
        order = slice(None, None, sign)
        change = abs(shear[one] - sign * shear[other][order]).max() / scale
        table.rows.append([name, change, verdict(change < (1e-6 if sign < 0 else ROUNDING))])
    return table


# Bodies held by contact alone, and the proof of all states

def held_by_contact(folder):
    """Return the table of strips that only contact holds along y."""
    table = Table("Held by contact alone", ["height over length", "runs", "least force over load",
                                            "largest", "largest violation", "verdict"],
                  text="Strips pressed on a base, up to 2000 times as long as they are high, so that their bending stiffness is "
                       "almost zero; with and without a gap before, frictionless and with friction 0.3 and 10.")
    for height in 0.03, 0.01, 0.002:
        runs, forces = [], []
        for gap in 0.0, 0.01:
            for friction in 0.0, 0.3, 10.0:
                deck = write(folder / f"strip{height}-{gap}-{friction}.inp",
                             strip(height, 40, gap, friction))
                runs += solved([deck])
                forces.append(contact(deck, "FACE", "normal_force")[0][-1] / 40.0)
        holds = not any(run.message for run in runs) and np.abs(np.array(forces) - 1).max() < 1e-6
        table.rows.append([height / 4.0, len(runs), f"{min(forces):.6f}", f"{max(forces):.6f}",
                           max(v for run in runs for v in run.violations), verdict(holds)])
    return table


def proof():
    """Return the table of all states of this theme."""
    violations = [v for outcome in PROVEN for v in outcome.violations]
    return Table("Proof of the final states", ["runs", "increments", "largest violation", "verdict"],
                 [[len(PROVEN), len(violations), max(violations), verdict(max(violations) < 1e-8)]])


def tables(folder, fixed=DECKS, cut=DECKS):
    """Run the cases, so many of the random ones with fixed and with cut increments; return their
    tables."""
    PROVEN.clear()
    return [random_blocks(folder, fixed, cut), one_pair_table(folder),
            advancing_contact(folder), receding_contact(folder),
            closing_again(folder), shakedown(folder), partial_slip(folder),
            held_by_contact(folder), proof()]


def test_contact(tmp_path):
    check_rows(tables(tmp_path, TESTED, TESTED_CUT))
