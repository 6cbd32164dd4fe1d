"""The theme of the extremes: values, shapes and loads of magnitudes where methods break."""

import os

import report  # isort: skip, it makes the modules below known
import fuzzing
import lame
import numpy as np
import rods
from cases import HEAD, Outcome, deviation, judged, largest, refused
from conduction import wall
from physics import material, mesh

TITLE = "Values at the extremes"
TEXT = """
Every case agrees with its closed form or invariant within what rounding allows, or is refused with
a message. Decks with values of any magnitude from 1e-300 to 1e300 end with a result or with a
message of the program, never with a crash or an infinite value.
"""
DETAILS = """
`deviation` is the largest difference, relative to the largest expected value, and
`allowed` its limit. `iterations` are all passes of the run, `smallest pivot` is that of the factors
of the bodies divided by its diagonal entry, `residual` is the larger of heat and force imbalance.
"""
DEBUG = os.environ.get("THERCON_BUILD_TYPE", "Release") != "Release"
FACES = ["*CONTACT PAIR, INTERACTION=I, NAME=F", "B.BOTTOM, A.TOP"]
HEAT = ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1."]
STATIC = ["*STEP", "*STATIC", "1., 1."]
COUPLED = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1."]
ROUNDING = 1e-9  # what a well-posed case may lose; a few digits more than its mesh needs
XS = [0.0, 0.5, 1.0]


def law(*cards):
    """Return the cards of an interaction with these laws, and of its pair."""
    return ["*SURFACE INTERACTION, NAME=I", *cards, *FACES]


def bases(*cards):
    """Return the cards of supports and loads of a step."""
    return ["*BOUNDARY", *cards]


def stack(below=1.0, above=1.0, xs=XS, gap=0.0, kind="CPE8"):
    """Return the cards of a block A and a block B on it, of these heights."""
    return mesh("A", xs, [-below, -below / 2, 0.0], kind) + mesh(
        "B", xs, [gap, gap + above / 2, gap + above], kind, first=1001)


def walls(folder, name, conductance, conductivities=(1.0, 1.0)):
    """Return the row of two walls of thickness one with a conductance between them."""
    k1, k2 = conductivities
    case = Outcome(
        folder, "walls", stack(), material("A", None, conductivity=k1),
        material("B", None, conductivity=k2), law("*GAP CONDUCTANCE", f"{conductance!r}, 0."),
        HEAT, bases("A.BOTTOM, 11, 11, 0.", "B.TOP, 11, 11, 100."), ["*END STEP"])
    flux, _ = wall([1.0, 1.0], [k2, k1], 100.0, 0.0, contacts=[conductance])
    return judged(name, case, deviation(case.last("heat_flux"), flux), ROUNDING)


def heat(folder):
    """Return the tables of conductances and conductivities."""
    table = report.Table("Conductance of the contact, in k/L of the bodies", HEAD)
    for exponent in (-15, -10, -5, 0, 5, 10, 15):
        table.rows.append(walls(folder, f"omega = 1e{exponent} k/L", float(f"1e{exponent}")))
    other = report.Table("Conductivities far apart", HEAD)
    for ratio in (1e4, 1e8, 1e-8, 1e16, 1e-16):
        pair = (ratio**0.5, ratio**-0.5)
        other.rows.append(walls(folder, f"ratio {ratio:.0e}", 1.0, pair))
    return [table, other]


R1 = rods.Rods((0.1, 0.1), (20.0, 20.0), (12e-6, 0.0), (2e11, 2e11), (500.0, 0.0), 5e-4)


def two_rods(folder, name, bar, gas, closed, allowed, steps=1):
    """Return the row of two rods with a gas in the gap and a conductance of pressure; the fluxes,
    gaps and pressures are compared."""
    (l1, l2), size = bar.length, bar.length[0]
    (a, b), (c0, c1) = gas, closed
    xs = [0.0, size / 2]
    case = Outcome(
        folder, "rods", mesh("A", xs, [-l2, -l2 / 2, 0.0]),
        mesh("B", xs, [bar.gap, bar.gap + l1 / 2, bar.gap + l1], first=1001),
        material("B", (bar.young[0], 0.0), bar.expansion[0], bar.conductivity[0]),
        material("A", (bar.young[1], 0.0), bar.expansion[1], bar.conductivity[1]),
        law("*GAP LAW, TYPE=GAS", f"{a!r}, {b!r}", "*GAP LAW, TYPE=POWER", f"{c0!r}, {c1!r}, 1."),
        [f"*CLEARANCE, MASTER=A.TOP, SLAVE=B.BOTTOM, VALUE={bar.gap!r}",
         "*FIXED POINT, TOL=1E-11", *COUPLED[:-1], f"{1 / steps!r}, 1."],
        bases("A, 1", "B, 1", "A.BOTTOM, 2", "B.TOP, 2", f"A.BOTTOM, 11, 11, {bar.temperature[1]!r}",
              f"B.TOP, 11, 11, {bar.temperature[0]!r}"), ["*END STEP"])
    answer = rods.solve(bar, rods.gas(a, b), rods.power(c0, c1, 1.0))
    off = deviation(case.last("heat_flux"), answer.flux)
    if answer.gap > 0.0:
        off = largest(off, deviation(case.last("gap"), answer.gap, bar.gap))
    else:
        off = largest(off, deviation(case.last("pressure"), answer.pressure))
    return judged(name, case, off, allowed)


def scaled(bar, factor):
    """Return rods of which all lengths are multiplied."""
    return rods.Rods(tuple(factor * l for l in bar.length), bar.conductivity, bar.expansion,
                     bar.young, bar.temperature, factor * bar.gap)


def laws(folder):
    """Return the tables of gas laws and of dimensions."""
    table = report.Table("Gas in the gap, omega = A/(B + gap), as B goes to 0", HEAD,
                         text="Rods whose gap stays open, or nearly closes.")
    for b in (1e-5, 1e-8, 1e-14, 1e-30, 1e-90):
        table.rows.append(two_rods(folder, f"B = {b:.0e}, A kept", R1, (0.15, b),
                                   (0.15 / b, 1e-4), ROUNDING))
    for b in (1e-8, 1e-14, 1e-30):
        table.rows.append(two_rods(folder, f"B = {b:.0e}, A/B kept", R1, (1.5e4 * b, b),
                                   (1.5e4, 1e-4), ROUNDING))
    sizes = report.Table("Very small and very large dimensions", HEAD,
                         text="The same rods with all lengths multiplied by a factor, gas and conductance accordingly.")
    for factor in (1e-30, 1e-9, 1e-3, 1e3, 1e9, 1e30):
        sizes.rows.append(two_rods(folder, f"lengths times {factor:.0e}", scaled(R1, factor),
                                   (0.15, 1e-5 * factor), (1.5e4 / factor, 1e-4 / factor), ROUNDING))
    return [table, sizes]


def dragged(folder, mu):
    """Return the row of a flat block that is pressed down and dragged off far beyond its grip."""
    case = Outcome(
        folder, "dragged", stack(0.05, 0.05, [0.0, 0.5, 1.0, 1.5, 2.0]),
        material("A", (1000.0, 0.3)), material("B", (1000.0, 0.3)), law("*FRICTION", f"{mu!r}"),
        STATIC, bases("A.BOTTOM, 1, 2", "B.TOP, 2, 2, -1.E-4", "B.TOP, 1, 1, 0.5"), ["*END STEP"])
    pressure, shear = case.last("pressure"), case.last("shear")
    off = largest(deviation(shear, -mu * pressure, pressure.max()),
                  max(-pressure.min(), 0.0) / pressure.max(),
                  abs(case.last("shear_force") + mu * case.last("normal_force"))
                  / case.last("normal_force"))
    assert np.all(case.last("status") <= 1)
    return judged(f"mu = {mu:g}", case, off, ROUNDING)


def friction(folder):
    """Return the table of coefficients of friction."""
    table = report.Table(
        "Friction", HEAD, text="A block is pressed down and dragged far: where it is closed it slips, and "
        "every contact point and the sum carry mu times the pressure.")
    table.rows = [dragged(folder, mu) for mu in (0.0, 1e-6, 1.0, 10.0)]
    return [table]


def pressed_cards(young, poisson=0.0, xs=XS, heights=(1.0, 1.0), pressure=5.0):
    """Return the cards of a stack under an even pressure."""
    return [stack(*heights, xs), material("A", (young[0], poisson)), material("B", (young[1], poisson)),
            law(), STATIC, bases("A.BOTTOM, 2", "A.LEFT, 1", "B.LEFT, 1"),
            ["*DSLOAD", f"B.TOP, P, {pressure!r}", "*END STEP"]]


def pressed(folder, name, young, allowed, poisson=0.0, xs=XS, heights=(1.0, 1.0)):
    """Return the row of a stack under an even pressure: pressure, and shortening of both blocks."""
    p, moduli = 5.0, [e / (1 - poisson**2) for e in young]
    case = Outcome(folder, "pressed", *pressed_cards(young, poisson, xs, heights, p))
    top = -p * sum(h / e for h, e in zip(heights, moduli, strict=True))
    off = largest(deviation(case.last("pressure"), p),
                  deviation(case.field("displacement")[:, 1].min(), top))
    return judged(name, case, off, allowed)


def stiffness(folder):
    """Return the tables of moduli and Poisson's ratios."""
    table = report.Table("Young's moduli far apart", HEAD, text="The reference of a punch is its base alone, the "
                         "nodes under the punch being pushed down evenly. A stiff block that only a soft one holds loses the "
                         "digits of the ratio of stiffness; below a pivot of 1e-9 the program warns.")
    for ratio in (1e4, 1e8, 1e-8):
        table.rows.append(pressed(folder, f"A is {ratio:.0e} as stiff as B, flat",
                                  (ratio**0.5, ratio**-0.5),
                                  ROUNDING + 1e-14 * max(ratio, 1 / ratio)))
    table.rows.append(refused("A is 1e-16 as stiff as B, flat", Outcome(
        folder, "pressed", *pressed_cards((1e-8, 1e8)), status=1), "singular"))
    for ratio in (1e4, 1e8):
        table.rows.append(punch(folder, ratio))
    soft = report.Table(
        "Nearly incompressible", HEAD, text="A ring shrunk on a tube, `CAX8R`, against the pressure in closed form. What "
        "remains is the error of the mesh, and rounding that grows like 1/(1 - 2 nu).")
    for poisson in (0.4999, 0.499999):
        soft.rows.append(shrunk(folder, poisson))
    return [table, soft]


def base(loaded):
    """Return the cards of a base with a refined middle, its surface there, and its supports."""
    xs = [-4.0, -3.0, -2.0, -1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0, 2.0, 3.0, 4.0]
    cards = mesh("A", xs, [-4.0, -3.0, -2.0, -1.0, -0.5, -0.25, 0.0])
    first = 5 * (len(xs) - 1) + 1
    return cards + ["*SURFACE, NAME=A.MIDDLE"] + [f"{first + k}, S3" for k in range(3, 11)] + loaded


def punch(folder, ratio):
    """Return the row of a flat punch, so many times as stiff as its base: against a base alone that
    is pushed down evenly, whose reactions are the forces of a rigid one."""
    depth, xs = 1e-3, [-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0]
    supports = bases("A.BOTTOM, 1, 2")
    case = Outcome(
        folder, "punch", base([]), mesh("B", xs, [0.0, 0.5, 1.0], first=5001),
        material("A", (1.0, 0.3)), material("B", (ratio, 0.3)),
        ["*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I, NAME=F",
         "B.BOTTOM, A.MIDDLE"], STATIC, supports, [f"B.TOP, 2, 2, -{depth!r}", "B.TOP, 1", "*END STEP"])
    nodes = case.read("contact/F/master_node")
    rigid = Outcome(
        folder, "rigid", base(["*NSET, NSET=PUSHED"] + [str(n) for n in nodes]),
        material("A", (1.0, 0.3)), STATIC, supports,
        [f"PUSHED, 2, 2, -{depth!r}", "*NODE PRINT, NSET=PUSHED, TOTALS=ONLY", "RF", "*END STEP"])
    lines = rigid.path.with_suffix(".lst").read_text().splitlines()
    total = float(lines[lines.index("   TOTALS OF PUSHED") + 2].split()[1])
    off = deviation(case.last("normal_force"), -total)
    return judged(f"punch {ratio:.0e} as stiff as its base", case, off, 10.0 / ratio + 1e-6)


def shrunk(folder, poisson):
    """Return the row of a ring that is shrunk on a tube."""
    inner, face, outer, over, young = 1.0, 2.0, 3.0, 1e-3, 1000.0
    ys = [0.0, 0.25]
    case = Outcome(
        folder, "shrunk", mesh("A", np.linspace(inner, face, 7), ys, "CAX8R"),
        mesh("B", np.linspace(face, outer, 7), ys, "CAX8R", first=1001),
        material("A", (young, poisson)), material("B", (young, poisson)),
        ["*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I, NAME=F", "A.RIGHT, B.LEFT",
         f"*CLEARANCE, MASTER=B.LEFT, SLAVE=A.RIGHT, VALUE=-{over!r}"],
        STATIC, bases("A, 2", "B, 2"), ["*END STEP"])
    side = (young, poisson)
    answer = lame.press_fit(inner, face, outer, side, side, over, "strain")
    return judged(f"nu = {poisson}", case, deviation(case.last("pressure"), answer), 1e-6)


def shapes(folder):
    """Return the tables of slender elements, near nodes and strips."""
    table = report.Table("Slender elements, near nodes, bodies far apart", HEAD, text="Blocks under a uniform pressure. The "
                         "loss grows with the square of the ratio of the sides; below a ratio of 1e-5 the program warns.")
    for width in (1e2, 1e4):
        table.rows.append(pressed(folder, f"elements {width:.0e} times as wide as high", (1000.0, 1000.0),
                                  spoilt(width), 0.3, [0.0, width, 2 * width], (2.0, 2.0)))
    for near in (1e-4, 1e-6):
        table.rows.append(pressed(folder, f"nodes {near:.0e} apart beside sides of 1",
                                  (1000.0, 1000.0), spoilt(1 / near), 0.3, [0.0, near, 1.0]))
    for near in (1e-8, 1e-12):
        case = Outcome(folder, "near", *near_nodes(near), status=1)
        table.rows.append(refused(f"nodes {near:.0e} apart beside sides of 1", case, "nearly coincide"))
    case = Outcome(folder, "near", *near_nodes(0.0), status=1)
    table.rows.append(refused("nodes in one place, so that elements have no area", case, "Jacobian"))
    for gap in (1e3, 1e6, 1e12):
        table.rows.append(far_apart(folder, gap))
    strips = report.Table(
        "Thin strips that contact alone holds", HEAD, text="Strips with friction and without supports, pressed "
        "on a base that cannot move: every face carries the pressure.")
    for thickness in (1e-2, 1e-4):
        strips.rows.append(strip(folder, thickness))
    return [table, strips]


def hanging(gap, load):
    """Return the cards of a block that hangs over another one and is pulled down."""
    return [stack(1.0, 1.0, XS, gap), material("A", (1000.0, 0.0)), material("B", (1000.0, 0.0)), law(),
            STATIC, bases("A.BOTTOM, 1, 2", "B.TOP, 2", "B.LEFT, 1"),
            ["*DLOAD", f"B, BY, -{load!r}", "*END STEP"]]


def far_apart(folder, gap):
    """Return the row of two blocks so many times their size apart: the upper one's displacement;
    its coordinates know its height to their last place."""
    load = 3.0
    case = Outcome(folder, "apart", *hanging(gap, load))
    end = load / 2 / 1000.0
    off = deviation(case.field("displacement")[:, 1].min(), -end)
    return judged(f"blocks {gap:.0e} times their size apart", case, off, ROUNDING + gap * np.finfo(float).eps)


def spoilt(ratio):
    """Return what pressures may be off beside nodes so much nearer than the longest side: the
    rounding of a stiffness times the ratio, over an area smaller by it; a few units."""
    return ROUNDING + 1e-15 * ratio**2


def near_nodes(near):
    """Return the cards of a pressed stack with nodes all but in one place."""
    return [stack(1.0, 1.0, [0.0, 0.5, 0.5 + near, 1.0]), material("A", (1.0, 0.3)),
            material("B", (1.0, 0.3)), law(), STATIC, bases("A.BOTTOM, 1, 2", "B.LEFT, 1"),
            ["*DSLOAD", "B.TOP, P, 1.", "*END STEP"]]


def strip(folder, thickness):
    """Return the row of two strips on a base, pressed evenly: both faces carry the pressure."""
    xs, p = [0.0, 0.25, 0.5, 0.75, 1.0], 3.0
    case = Outcome(
        folder, "strip", mesh("A", xs, [-1.0, 0.0]), mesh("B", xs, [0.0, thickness], first=1001),
        mesh("C", xs, [thickness, 2 * thickness], first=2001),
        *(material(name, (1000.0, 0.0)) for name in "ABC"),
        law("*FRICTION", "0.5"), ["*CONTACT PAIR, INTERACTION=I, NAME=G", "C.BOTTOM, B.TOP"], STATIC,
        bases("A.BOTTOM, 1, 2"), ["*DSLOAD", f"C.TOP, P, {p!r}", "*END STEP"])
    off = largest(*(deviation(case.last("pressure", name), p) for name in "FG"))
    return judged(f"strips {thickness:.0e} as thick as long", case, off, ROUNDING)


def grown(folder, increments):
    """Run a block that is pressed and pushed in proportion, in so many increments; its faces fit,
    so that its zones stay, and every increment is a part of the last state."""
    return Outcome(
        folder, f"grown{increments}", stack(1.0, 0.5, [0.0, 0.2, 0.5, 0.8, 1.0]),
        material("A", (1000.0, 0.3)), material("B", (300.0, 0.3)), law("*FRICTION", "0.3"),
        [f"*STEP, INC={increments}", "*STATIC, DIRECT", f"{1 / increments!r}, 1."],
        bases("A.BOTTOM, 1, 2"),
        ["*DSLOAD", "B.TOP, P, 4.", "B.TOP, TRVEC, 0.7, 1., 0., 0.", "*NODE FILE, FREQUENCY=0", "U",
         "*END STEP"])


def increments(folder):
    """Return the table of a load in one and in many increments."""
    many = 1000 if DEBUG else 10000
    one, cut = grown(folder, 1), grown(folder, many)
    names = ("gap", "pressure", "shear", "slip")
    off = largest(*(
        deviation(cut.last(name), one.last(name), max(abs(one.last(name)).max(), floor))
        for name, floor in zip(names, (1e-3, 1.0, 1.0, 1e-3), strict=True)))
    slips, sticks = (int((one.last("status") == k).sum()) for k in (1, 2))
    assert slips > 0 and sticks > 0, "the case has both zones"
    table = report.Table("A load in many increments", HEAD, text="Pressed and pushed in proportion, so that the "
                         "zones stay: the same state as in one increment.")
    table.rows.append(judged(f"{many} increments against 1", cut, off, ROUNDING))
    return [table]


def magnitudes(folder, decks):
    """Return the table of values of any magnitude, with so many decks a row."""
    table = report.Table(
        "Values of any magnitude", ["decades", "values changed", "runs", "solved", "refused by the cards",
                                    "ended in words", "verdict"],
        text="Decks with one to three values of any magnitude, by a fixed seed: no crash, no hang, no infinite "
        "or missing value where the run says 0, no message but the program's own.")
    sets = (-300, 300, (1,)), (-100, 100, (1, 2, 3))
    if DEBUG:  # where an overflow stops the program
        sets = (-20, 20, (1,)), (-20, 20, (1, 2, 3))
    for low, high, changed in sets:
        found = []
        for seed in range(20 if DEBUG else decks):
            deck = folder / "fuzzed.inp"
            values = fuzzing.fuzzed(deck, seed, (low, high), changed)
            status, faults = fuzzing.outcome(deck)
            found.append(status)
            assert not faults, (seed, values, faults)
        table.rows.append([f"{low} to {high}", "1" if changed == (1,) else "1 to 3", len(found),
                           found.count(0), found.count(1), found.count(2), "pass"])
    return [table]


def tables(folder, decks=150):
    """Return the tables of the theme."""
    return [*heat(folder), *laws(folder), *friction(folder), *stiffness(folder), *shapes(folder),
            *increments(folder), *magnitudes(folder, decks)]


def brief(parts):
    """Return the table of the document: a row for each group of cases."""
    table = report.Table(TITLE, ["cases", "number", "largest deviation", "of allowed", "refused", "verdict"],
                         heading=False)
    for part in parts:
        rows = [dict(zip(part.head, row, strict=True)) for row in part.rows]
        told = [(float(row["deviation"]), float(row["allowed"])) for row in rows if row.get("deviation")
                not in (None, "")]
        off, share = (max(d for d, _ in told), max(d / a for d, a in told)) if told else ("", "")
        refused = sum(row["verdict"] == "refused" for row in rows)
        table.rows.append([part.title, sum(int(row.get("runs", 1)) for row in rows),
                           *(f"{value:.1g}" if told else "" for value in (off, share)), refused or "",
                           report.verdict(all(row["verdict"] != "FAIL" for row in rows))])
    return [table]


def test_extremes(tmp_path):
    """Every case holds, and the document tells the same, of more decks at random."""
    parts = tables(tmp_path, decks=50)
    report.check_parts([TEXT, *parts, *brief(parts)])
