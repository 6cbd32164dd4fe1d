"""Heat that is stored: orders of the schemes in time, limits of long and short increments, and what
of several states a course ends in."""

import math
import shutil

import h5py
import numpy as np
from blocks import write
from deck_runs import COUPLED, CYLINDER, INPUT, solve
from physics import material, mesh
from report import Table, check_rows, verdict
from test_known_rods import BRANCH, RODS

import rods
import transient

TITLE = "Stored heat"
TEXT = """
Bodies that store heat. The schemes converge with the orders of theory, however the conductance
depends on gap and pressure: L-STABLE and CRANK-NICOLSON with 2, IMPLICIT, EXPLICIT and GALERKIN
with 1. Increments that are long give the steady states: heat and force lag behind a growing load by
at most the inverse of the increment in time constants.

After a sudden change of a face, temperatures leave the range of the old and the new one by less
than 1 % if the elements beside the face have h^2 = 4 kappa dt, if they are smaller and one
increment with TYPE=IMPLICIT, in a step of its own, comes first, or if LOCAL ERROR chooses the
increments. Temperatures in three- and four-node elements never fall below the range.

Of three steady states of two rods a run ends in a stable one, if its increments resolve the growth
of the unstable one: IMPLICIT stays there if rate times increment is above 2, L-STABLE above 11.7,
with a warning. The rates at which temperatures leave such a state or return to it are those of
[closed forms](#three-states-of-two-rods) to 1e-3.
"""
IN_DOCUMENT = []

# Orders in time

SCHEMES = {"L-STABLE": 2, "CRANK-NICOLSON": 2, "GALERKIN": 1, "IMPLICIT": 1, "EXPLICIT": 1}
COUNTS = [10, 20, 40, 80]
FINEST = 16 * COUNTS[-1]
CORNERS = 4096   # of the amplitude, so that its kinks are far below the errors
HOT, CONDUCTIVITY, YOUNG = 80.0, 2.0, 1000.0
XS = [0.0, 0.5, 1.0]


def course():
    """Return the cards of an amplitude that begins and ends at rest."""
    times = np.arange(CORNERS + 1) / CORNERS
    points = [f"{float(t)!r}, {math.sin(math.pi * t / 2) ** 2!r}" for t in times]
    return ["*AMPLITUDE, NAME=COURSE", *(", ".join(points[k:k + 4])
                                         for k in range(0, len(points), 4))]


def blocks(law, gap=0.0, press=0.0, expansion=1e-4, xs=XS, to=None):
    """Return a block above another one, heated from its top."""
    cards = [*mesh("UPPER", xs, [0.0, 0.1, 0.25, 0.5], to=to or (lambda x, y: (x, y + gap))),
             *mesh("LOWER", xs, [-1.0, -0.6, -0.3, -0.1, 0.0], first=1001)]
    for name, growth in (("UPPER", expansion), ("LOWER", 0.0)):
        cards += material(name, (YOUNG, 0.0), growth, CONDUCTIVITY, 1.0, 1.0)
    return [*cards, *course(), "*SURFACE INTERACTION, NAME=FACES", *law,
            "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "UPPER.BOTTOM, LOWER.TOP",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "UPPER, 0.", "LOWER, 0.",
            "*FIXED POINT, METHOD=NEWTON, TOL=1.E-12",
            "*BOUNDARY", f"UPPER.TOP, 2, 2, {-press!r}", "LOWER.BOTTOM, 2", "UPPER.LEFT, 1",
            "LOWER.LEFT, 1"]


def curved(x, y):
    """Return a place in a block with a round lower side."""
    return x, y + (0.5 - y) * x * x / 15


CASES = {
    "constant conductance": blocks(["*GAP LAW, TYPE=GAS", "0.7e9, 1.e9"], gap=0.01),
    "gas in an open gap": blocks(["*GAP LAW, TYPE=GAS", "0.01, 0.005"], gap=0.01),
    "gas in a gap that closes": blocks(["*GAP LAW, TYPE=GAS", "0.01, 0.005"], gap=0.01,
                                       expansion=3e-4),
    "pressure": blocks(["*GAP LAW, TYPE=POWER", "0.2, 0.5, 1."], press=0.001),
    "moving edge": blocks(["*GAP LAW, TYPE=GAS", "0.01, 0.005", "*GAP LAW, TYPE=POWER",
                           "2., 0.5, 1."], gap=None, expansion=3e-4, to=curved,
                          xs=np.linspace(0.0, 1.0, 17)),
}


def scheme_cards(scheme):
    """Return the card of a scheme; L-STABLE is that of steps that store heat, without a card."""
    return [] if scheme == "L-STABLE" else [f"*THERMAL SCHEME, TYPE={scheme}"]


def slave_temperatures(folder, case, scheme, count):
    """Return temperatures of the slave face at the end of a course in so many increments."""
    deck = write(folder / f"{scheme}{count}.inp", ["*OPTIONS, ERRORS=NO, WIDTH=200"], CASES[case],
                 scheme_cards(scheme), ["*STEP, INC=100000",
                 "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", f"{1 / count!r}, 1.",
                 "*BOUNDARY", "LOWER.BOTTOM, 11", "*BOUNDARY, AMPLITUDE=COURSE",
                 f"UPPER.TOP, 11, 11, {HOT!r}", "*NODE FILE, FREQUENCY=0", "NT", "*END STEP"])
    with h5py.File(solve(deck)) as file:
        return file["contact/FACE/slave_temperature"][-1]


def orders(folder, cases=tuple(CASES), finest=FINEST):
    """Return the table of the orders of the schemes in time."""
    table = Table("Order of the schemes in time", [
        "conductance", "scheme", *(f"{n} increments" for n in COUNTS), "order", "expected",
        "verdict"], text=f"""A block that is heated from its top, smoothly from rest to rest, expands towards another one that is held at 0 below. Both store heat; the course lasts as long as heat takes through the lower one.
Largest error of the temperatures of the upper face at the end, relative to the largest of them, against {finest} increments of L-STABLE on the same mesh; the order is that from {COUNTS[-2]} to {COUNTS[-1]} increments.
The laws are continuous where contact points close, so that an increment in which some do has a kink and no jump, and keeps the order. EXPLICIT is IMPLICIT where the conductance is constant.""")
    for case in cases:
        best = slave_temperatures(folder, case, "L-STABLE", finest)
        for scheme, should in SCHEMES.items():
            errors = [float(abs(slave_temperatures(folder, case, scheme, count) - best).max()
                            / abs(best).max()) for count in COUNTS]
            found = math.log2(errors[-2] / errors[-1])
            # Closing points keep the last digit of it from settling.
            table.rows.append([case, scheme, *errors, f"{found:.2f}", str(should),
                               verdict(abs(found - should) < 0.2)])
    return table


# Long increments

COMPARED = "normal_force", "heat_rate", "edge_contact", "pressure", "shear_force", "edge_stick"
SETS = {"all": 6, "all but the edge of stick": 5, "all but shear": 4,
        "force, heat, edge of contact": 3}                   # how many of these
ACROSS, DIFFUSIVITY = 120.0, 0.18 / 3.6                      # cm, cm^2/s
CONSTANT = ACROSS**2 / DIFFUSIVITY / math.pi**2              # of the slowest mode, s
TOP, COUNT = 900.0, 45                                       # last temperature of the top, and in
BODIES = {"cylinder": (CYLINDER, True), "cylinder without friction": (CYLINDER, False),
          "coupled twin": (COUPLED, True)}
STORED = {"*CONDUCTIVITY\n0.18\n": "*CONDUCTIVITY\n0.18\n*DENSITY\n1.\n*SPECIFIC HEAT\n3.6\n"}


def heated(analysis, times, top, *cards, first="*STEP, INC=100"):
    """Return a coupled step up to a temperature of the top."""
    return [first, f"*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT{analysis}", times, *cards,
            "*BOUNDARY", f"TOP, 11, 11, {top!r}", "BOTTOM, 11", "*NODE FILE, FREQUENCY=0", "NT",
            "*END STEP"]


def ramped(length):
    """Return a step whose loads grow, in increments so many time constants long."""
    increment = length * CONSTANT
    return heated("", f"{increment!r}, {COUNT * increment!r}", TOP,
                  "*THERMAL SCHEME, TYPE=IMPLICIT", first="*STEP, INC=100, AMPLITUDE=RAMP")


def at_once(length, parts):
    """Return steps whose loads act at once, so many time constants long, in some increments."""
    period = length * CONSTANT
    return [card for k in range(COUNT)
            for card in heated("", f"{period / parts!r}, {period!r}", TOP / COUNT * (k + 1),
                               "*THERMAL SCHEME, TYPE=IMPLICIT")]


def cylinder_course(folder, name, steps, changes=STORED, parts=1):
    """Return quantities of the interface of a cylinder at each of its loads."""
    deck, rubs = BODIES[name]
    head, step, _ = deck.read_text().partition("*STEP")
    assert step
    changes = changes | {"METHOD=ZAITSEV" if deck == CYLINDER else "METHOD=NEWTON":
                         "METHOD=NEWTON, TOL=1.E-11"}
    if not rubs:
        changes = changes | {"*FRICTION\n0.155, 1.E5\n": ""}
    for old, new in changes.items():
        assert old in head, old
        head = head.replace(old, new)
    path = write(folder / f"{deck.stem}.inp", ["*OPTIONS, ERRORS=NO"], head, steps)
    with h5py.File(solve(path)) as file:
        return {quantity: file[f"contact/FACE/{quantity}"][parts - 1::parts]
                for quantity in COMPARED}


def apart(found, steady, quantities):
    """Return by how much two courses differ, relative to the largest value of each quantity."""
    return max(float(np.nanmax(abs(found[name] - steady[name])) / np.nanmax(abs(steady[name])))
               for name in quantities)


def long_increments(folder, bodies=tuple(BODIES), lengths=(1e3, 1e4, 1e5, 1e6)):
    """Return the table of the cylinders, whose increments are far longer than heat takes."""
    table = Table("Long increments", ["case", "loads", "length", "increments", "compared",
                                      "deviation", "allowed", "verdict"],
                  text=f"""The cylinder and its coupled twin (input/cylinder) with a capacity of 3.6 J/(cm3 K) and TYPE=IMPLICIT, heated to {TOP:g} in {COUNT} loads: largest deviation from the steady run at any of them, of {", ".join(name.replace("_", " ") for name in COMPARED)}, relative to the largest value of each. Lengths are in time constants L^2/(pi^2 kappa) of the slowest mode, L the height of both bodies.
An increment leaves 1/(1 + z) of a mode that decays by z, so that temperatures lag behind growing loads by at most the inverse of the length. Loads at once in steps of two increments leave the square of 1/500 of each of the {COUNT} parts where steps are 1000 time constants long. Friction depends on the path: points that have slid keep what the first of the two increments left over, in the shear and by it in the pressure, until they slide on, and the second one, which hardly moves them, makes some of them stick.""")
    for name in bodies:
        steady = cylinder_course(folder, name, heated(", STEADY STATE", f"{TOP / COUNT!r}, {TOP!r}",
                                                      TOP), {})
        everything = "all" if BODIES[name][1] else "all but shear"
        rows = [("ramped", length, 1, everything, 1 / length) for length in lengths]
        if name == "cylinder":
            rows += [("at once", 1e3, 2, "force, heat, edge of contact", 1e-6),
                     ("at once", 1e5, 2, "all but the edge of stick", 1e-6)]
        else:
            rows += [("at once", 1e3, 2, everything, 1e-6)]
        for loads, length, parts, chosen, allowed in rows:
            steps = ramped(length) if loads == "ramped" else at_once(length, parts)
            found = apart(cylinder_course(folder, name, steps, parts=parts), steady,
                          COMPARED[:SETS[chosen]])
            table.rows.append([name, loads, f"{length:.0e}", str(parts), chosen, found,
                               allowed, verdict(found < allowed)])
    return table


# Short increments

KINDS = "CPE3", "CPE4", "CPE6", "CPE8", "CAX8"
FOURIER, SHORT = 1e-4, 25   # of the body's size; increments until then
FIT = 4                     # h^2/(kappa dt) that elements of all kinds pass
MOST = 0.01


def shocked(times, *cards):
    """Return a step that holds two sides at 1."""
    return ["*STEP, INC=1000", *cards, times, "*BOUNDARY", "BODY.LEFT, 11, 11, 1.",
            "BODY.BOTTOM, 11, 11, 1.", "*NODE FILE", "NT", "*END STEP"]


# How increments are made.
MADE = {"fixed": shocked(f"{FOURIER / SHORT!r}, {FOURIER!r}", "*HEAT TRANSFER, DIRECT"),
        "first IMPLICIT": [*shocked(f"{FOURIER / SHORT!r}, {FOURIER / SHORT!r}",
                                    "*THERMAL SCHEME, TYPE=IMPLICIT", "*HEAT TRANSFER, DIRECT"),
                           *shocked(f"{FOURIER / SHORT!r}, {FOURIER - FOURIER / SHORT!r}",
                                    "*THERMAL SCHEME, TYPE=L-STABLE", "*HEAT TRANSFER, DIRECT")],
        "chosen": shocked(f"{FOURIER!r}, {FOURIER!r}", "*HEAT TRANSFER")}


def beyond(folder, kind, ratio, made):
    """Return h^2/(kappa dt) of the first increment, and how far temperatures go below 0 and above 1
    in any increment, and at the end.

    The smallest elements have h^2 = ratio kappa dt, dt being that of fixed increments also where
    they are chosen by their error.
    """
    spacings = math.sqrt(ratio * FOURIER / SHORT) * 1.3 ** np.arange(60)
    places = np.concatenate([[0.0], np.cumsum(spacings)])
    places = places[: np.searchsorted(places, 1.0) + 1] / places[np.searchsorted(places, 1.0)]
    xs = 1.0 + places if kind.startswith("CAX") else places
    deck = write(folder / "shock.inp", ["*OPTIONS, ERRORS=NO"], mesh("BODY", list(xs), list(places),
                                                                    kind),
                 material("BODY", None, None, 1.0, 1.0, 1.0),
                 ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0."], MADE[made])
    with h5py.File(solve(deck)) as file:
        ends = file["history/time"][()]
        found = file["VTKHDF/PointData/temperature"][()].reshape(len(ends), -1)
    return ratio * FOURIER / SHORT / ends[0], [float(max(part, 0.0)) for part in (
        -found.min(), found.max() - 1, -found[-1].min(), found[-1].max() - 1)]


def short_increments(folder, kinds=KINDS):
    """Return the table of what a sudden change of a face leaves beyond its ends."""
    table = Table("A face that changes at once", [
        "element", "smallest", "increments", "h^2/(kappa dt)", "below", "above",
        "below at the end", "above at the end", "verdict"], text=f"""Two sides of a square, at 0, are at 1 from the start on. The scheme is L-STABLE and the course ends at a Fourier number of {FOURIER:g} of the size of the square, after {SHORT} fixed increments or after those that LOCAL ERROR=1E-3, the default, chooses. Elements grow by 1.3 from one to the next; the table has the smallest ones, in parts of the square, and h^2/(kappa dt) for them and the first increment. How far temperatures lie below 0 or above 1 in any increment, and at the end.
Three- and four-node elements, whose capacities are lumped, stay above 0 always. Those with nodes between corners fall below it beside the face while heat has not crossed an element. L-STABLE replaces exp(-z) by (1 - 0.41 z)/(1 + 0.29 z)^2, which is negative for long increments, down to -0.2, and so goes above 1 in the first ones; one increment of TYPE=IMPLICIT, in a step of its own before the others, prevents that. Increments that are chosen begin no shorter than h^2/(4 kappa) beside elements with nodes between corners, and long ones err too much to be kept.
Required are {100 * MOST:g} % in any increment where h^2 = {FIT} kappa dt, the first one is IMPLICIT or increments are chosen, and at the end always.""")
    cases = [*((ratio, "fixed") for ratio in (1 / 4, 1, FIT, 16)), (1 / 4, "first IMPLICIT"),
             (1, "first IMPLICIT"), (3 / 8, "chosen"), (12, "chosen")]
    for kind in kinds:
        for ratio, made in cases:
            first, parts = beyond(folder, kind, ratio, made)
            judged = parts if ratio == FIT or made != "fixed" else parts[2:]
            if kind[-1] in "34":
                judged = [*judged, 0.0 if parts[0] < ROUNDING else 1.0]
            smallest = math.sqrt(ratio * FOURIER / SHORT)
            table.rows.append([kind, f"{smallest:.2g}", made, f"{first:.3g}",
                               *(shown_part(part) for part in parts),
                               verdict(max(judged) < MOST)])
    return table


ROUNDING = 1e-9   # of a temperature


def shown_part(part):
    """Return a part of the jump as text."""
    return "0" if part < ROUNDING else f"{part:.1e}"


# Rods with three steady states

CAPACITY, LENGTH, HOT_END, CONDUCTING = 3.6e6, 0.1, 500.0, 20.0
LAW = 0.005, 1e-5, 500.0, 1e-4   # a, b of the gas; conductance of faces that touch, and by pressure
SETTLED = 4e4                    # s
HIDES = "too long to show a mode that grows"


def states():
    """Return the steady states of R3, by the names of their decks."""
    found = rods.exact_solutions(RODS["r3-open"][0], *LAW)
    return {name: found[BRANCH.get(name, 0)] for name in RODS if name.startswith("r3")}


def rod_course(folder, name, scheme, increment, pulse, period, cards=()):
    """Return times, separations and temperatures of the slave in a course from a steady state.

    The course begins with a pulse: its part of the hot end's temperature, and how long it lasts.
    Separations are gaps, or, where the rods press, by how much they are shortened, negative.
    """
    copy = folder / "rods"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(INPUT / "rods", copy)
    model = (copy / "rods.inc").read_text()
    stored = "*CONDUCTIVITY\n20.\n"
    assert stored in model
    (copy / "rods.inc").write_text(model.replace(
        stored, f"{stored}*DENSITY\n1.\n*SPECIFIC HEAT\n{CAPACITY!r}\n"))
    text = (copy / f"{name}.inp").read_text()
    more = "".join(f"{card}\n" for card in cards)
    text = text[:text.index("*VERIFY")].replace("*STEP", more + "*STEP", 1)
    steps = []
    for part, seconds in (pulse, (0.0, period)):
        steps += ["*STEP, INC=100000", *scheme_cards(scheme),
                  "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT",
                  f"{min(increment, seconds)!r}, {seconds!r}", "*START, FROM=PREVIOUS",
                  "*BOUNDARY", f"HOT, 11, 11, {HOT_END * (1 + part)!r}",
                  "*NODE FILE, FREQUENCY=0", "NT", "*END STEP"]
    deck = write(copy / "course.inp", ["*OPTIONS, ERRORS=NO"], text, steps)
    with h5py.File(solve(deck)) as file:
        contact = file["contact/FACE"]
        apart = contact["gap"][:, 0] - contact["pressure"][:, 0] * 2 * LENGTH / 2e11
        return file["history/time"][()], apart, contact["slave_temperature"][:, 0]


# Scheme, increment [s], and whether that is too long to show that the middle state is unstable.
ENDS = (("L-STABLE", 20.0, False), ("L-STABLE", 100.0, False), ("L-STABLE", 5000.0, True),
        ("IMPLICIT", 20.0, False), ("IMPLICIT", 100.0, False), ("IMPLICIT", 850.0, True),
        ("EXPLICIT", 100.0, False), ("GALERKIN", 20.0, False))


def end_states(folder, ends=ENDS):
    """Return the table of the states that a course from beside the unstable one ends in."""
    known = states()
    both, nearest = RODS["r3-open"][0], ["r3-open", "r3-middle", "r3-closed"]
    middle = known["r3-middle"]
    rate = growth(both, middle)
    table = Table("Rods with three steady states", [
        "scheme", "increment, s", "rate times increment", "hot end by", "ends", "expected",
        "deviation", "warned of", "verdict"], text=f"""The rods R3 of input/rods with {CAPACITY:g} J/(m3 K), from their middle state, which is unstable, with the hot end 1e-3 off for 10 s; the state after {SETTLED:g} s.
A hotter hot end leads to one stable state and a colder one to the other, if the increments are short. The middle state is left at the rate {rate:.4g}/s. IMPLICIT multiplies what grows by 1/(1 - z), z the rate times the increment: beyond 2 that is below 1, and the run stays. L-STABLE has (1 + 0.41 z)/(1 - 0.29 z)^2 and stays beyond 11.7. There the run warns that its increments are too long to show a mode that grows.""")
    for scheme, increment, hidden in ends:
        for part, leads_to in ((1e-3, "r3-closed"), (-1e-3, "r3-open")):
            _, apart, _ = rod_course(folder, "r3-middle", scheme, increment, (part, 10.0), SETTLED)
            deviations = {name: abs(float(apart[-1]) / known[name].separation - 1)
                          for name in nearest}
            ends = min(deviations, key=deviations.get)
            warned = HIDES in (folder / "rods/course.lst").read_text()
            should = "r3-middle" if hidden else leads_to
            table.rows.append([scheme, f"{increment:g}", f"{rate * increment:.3f}", f"{part:+g}",
                               ends[3:], should[3:], deviations[ends], "yes" if warned else "no",
                               verdict(ends == should and deviations[ends] < 1e-4
                                       and warned == hidden)])
    return table


def growth(both, state):
    """Return the rate of a steady state in closed form."""
    drop = both.flux(state.conductance) / state.conductance
    closing = -state.slope * both.expansion[1] * LENGTH * drop
    return transient.largest_rate(CONDUCTING, CAPACITY, LENGTH, state.conductance, closing)


# Increment, pulse, and two times between which other modes are gone and the course is still linear.
WINDOWS = {"r3-open": (20.0, (0.01, 2000.0), 16000.0, 18000.0),
           "r3-middle": (20.0, (1e-7, 20.0), 2500.0, 3500.0),
           "r3-closed": (20.0, (0.01, 2000.0), 6000.0, 8000.0)}


def rates(folder):
    """Return the table of the rates of the three states."""
    table = Table("Rates of the three steady states", ["state", "rate, 1/s", "closed form",
                                                       "deviation", "allowed", "verdict"],
                  text="""The same rods after a small pulse of the hot end, refined twice, in increments of 20 s: the rate at which temperatures of the slave leave a state or come back to it, against tests/reference/transient.py. L-STABLE errs by 0.04 (rate dt)^2 of the rate, 1e-4, the mesh by 3e-5, and what other modes leave of the rest is below 1e-3.""")
    for name, (increment, pulse, first, last) in WINDOWS.items():
        time, _, temperature = rod_course(folder, name, "L-STABLE", increment, pulse, last,
                                          ["*REFINE, LEVELS=2"])
        start = time[0]   # the end of the steady step
        parts = [float(np.interp(start + at, time, temperature - temperature[0]))
                 for at in (first, last)]
        found = math.log(parts[1] / parts[0]) / (last - first)
        exact = growth(RODS["r3-open"][0], states()[name])
        table.rows.append([name[3:], f"{found:.6g}", f"{exact:.6g}", abs(found / exact - 1), 1e-3,
                           verdict(abs(found / exact - 1) < 1e-3)])
    return table


def tables(folder):
    """Run the cases; return their tables."""
    return [orders(folder), long_increments(folder), short_increments(folder), end_states(folder),
            rates(folder)]


def test_stored_heat(tmp_path):
    """Of the orders those of the hardest case, against half as many increments, which errs by 1/64 of
    what is measured; of the cylinders two, of the elements one that lumps and one that does not; the
    shortest increments to the end with one scheme."""
    check_rows([orders(tmp_path, ("moving edge",), FINEST // 2),
                long_increments(tmp_path, ("cylinder", "coupled twin"), (1e3, 1e6)),
                short_increments(tmp_path, ("CPE4", "CPE8")),
                end_states(tmp_path, [end for end in ENDS if end[1] > 20.0 or end[0] == "GALERKIN"]),
                rates(tmp_path)])
