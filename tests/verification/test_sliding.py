"""Faces that slide by any distance, SLIDING=FINITE."""

from itertools import pairwise
from math import dist, pi, sqrt

import h5py
import numpy as np
from manual import Case, Check, check_short
from pictures import save, subplots
from physics import material, mesh, nodes_of

from moving_source import face_temperature

TITLE = "Sliding"
TEXT = """Faces that slide along each other by many spacings of their nodes, with `SLIDING=FINITE`:
a constant pressure is kept to rounding, Hertz's pressure and Jaeger's temperatures to 1 % at every
place."""
PICTURE = "sliding"
CAPTION = "Pressure under a roller before and after its slide; temperature of a rail under a pad"
SMOOTH = ["*SURFACE INTERACTION, NAME=SMOOTH"]
STEEL = 2.1e5, 0.3
MODULUS = STEEL[0] / (1 - STEEL[1] ** 2)
WIDTH, DEPTH = 0.2, 20.0        # half the width of the contact of a roller; of the rail
# Of a rigid roller: its contact strains the face by 1e-3, and displaced faces touch elsewhere than
# Hertz's by as much.
RADIUS = 50.0
SPACINGS, PARTS = 10, 20        # of a slide, and its increments


def graded(side, even, end, ratio=1.35):
    """Return places from 0 to the end: sides of equal length up to `even`, then growing ones."""
    places = [side * k for k in range(round(even / side) + 1)]
    while places[-1] + side * ratio < end - side * ratio / 2:
        side *= ratio
        places.append(places[-1] + side)
    return [*places[:-1], end] if end - places[-1] < side / 2 else [*places, end]


def both_ways(places):
    """Return places from 0 with those on the other side of it."""
    return [-x for x in places[:0:-1]] + places


def rail(side, first=1):
    """Return a rail whose sides are equal as far as a roller slides."""
    down = graded(side, 1.2 * WIDTH, DEPTH)
    return mesh("RAIL", both_ways(graded(side, 1.2 * WIDTH + SPACINGS * side, DEPTH)),
                [-y for y in down[::-1]], "CPE4", first=first)


def pressed_and_slid(load, held, moved, slide):
    """Return the steps: pressed by a force, then held at that depth and slid."""
    return ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", f"{moved}, 1", *load, "*END STEP",
            "*STEP, INC=1000", "*STATIC", f"{1 / PARTS!r}, 1.", "*BOUNDARY, FIXED",
            f"{held}, 2, 2", "*BOUNDARY", f"{moved}, 1, 1, {slide!r}", f"{load[0]}, OP=NEW",
            "*END STEP"]


def hertz_checks(force, middle, travel, side):
    """Return the checks of Hertz's pressure where the middle of a roller is: `travel` of its slide
    along the slave is seen as such, none where the roller is the slave."""
    peak, checks = 2 * force / pi / WIDTH, []
    for time in (1.0, 1.25, 2.0):
        place = middle + (time - 1.0) * travel
        checks += [
            Check(f"normal force, t = {time}", "normal_force", "FACE", force, 5e-3, when=f"{time}"),
            *(Check(f"pressure at {part:+} a, t = {time}", "pressure",
                    f"FACE@{place + part * WIDTH!r}", peak * sqrt(1 - part**2),
                    1e-2, when=f"{time}") for part in (-0.8, -0.5, 0.0, 0.5, 0.8)),
            Check(f"edge of contact, t = {time}", "edge_contact", "FACE", place + WIDTH, side / 10,
                  "ABS", when=f"{time}")]
    return checks


def rigid_roller(kind):
    """Return a rigid roller, the master, on a rail."""
    pairing, count = kind
    side = WIDTH / count
    force = pi * MODULUS * WIDTH**2 / 4 / RADIUS
    cards = [*rail(side), "*NODE", f"90001, 0., {RADIUS!r}", "*SURFACE, NAME=ARC, TYPE=SEGMENTS",
             f"START, {0.28 * RADIUS!r}, {0.04 * RADIUS!r}",
             f"CIRCL, {-0.28 * RADIUS!r}, {0.04 * RADIUS!r}, 0., {RADIUS!r}",
             "*RIGID BODY, REF NODE=90001, ANALYTICAL SURFACE=ARC", *material("RAIL", STEEL),
             *SMOOTH, "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, SLIDING=FINITE, "
             f"PAIRING={pairing}", "RAIL.TOP, ARC", "*BOUNDARY", "RAIL.BOTTOM, 1, 2", "90001, 6",
             *pressed_and_slid(["*CLOAD", f"90001, 2, {-force!r}"], 90001, 90001, SPACINGS * side)]
    return cards, hertz_checks(force, DEPTH, SPACINGS * side, side)


def elastic_roller(kind):
    """Return half of an elastic roller of radius 10, cut off at its sides, on a rail."""
    slave, count = kind
    side, radius = WIDTH / count, 10.0
    force = pi * MODULUS / 2 * WIDTH**2 / 4 / radius
    # The slave has the finer mesh, and nodes do not match.
    own = side * (0.93 if slave == "roller" else 1.07)
    across = both_ways(graded(own, 1.2 * WIDTH, 7.5))

    def curved(x, y):
        low = radius - sqrt(radius**2 - x**2)
        return x, low + y * (radius - low) / radius

    faces = ["ROLLER.BOTTOM", "RAIL.TOP"]
    roller = mesh("ROLLER", across, graded(own, 1.2 * WIDTH, radius), "CPE4", first=100001, to=curved)
    # A second node of its middle: without friction a round face turns freely about its centre.
    middle = next(n for n, (x, y) in nodes_of(roller).items() if x == 0.0 and y > radius / 2)
    cards = [*rail(side), *roller, "*NSET, NSET=ROLLER.DRIVEN", f"ROLLER.TOP, {middle}",
             *material("RAIL", STEEL), *material("ROLLER", STEEL), *SMOOTH,
             "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, SLIDING=FINITE",
             ", ".join(faces if slave == "roller" else faces[::-1]), "*BOUNDARY",
             "RAIL.BOTTOM, 1, 2",
             *pressed_and_slid(["*DSLOAD", f"ROLLER.TOP, P, {force / 15.0!r}"], "ROLLER.TOP",
                               "ROLLER.DRIVEN", SPACINGS * side)]
    if slave == "rail":
        return cards, hertz_checks(force, DEPTH, SPACINGS * side, side)
    arc = [curved(x, 0.0) for x in across if x < own / 2]
    return cards, hertz_checks(force, sum(dist(*ends) for ends in pairwise(arc)), 0.0, side)


def sleeve(rows):
    """Return a sleeve with an overlap of 1e-6 that slides along a rigid shaft, by two lengths."""
    inside, outside, overlap = 1.0, 2.0, 1e-6
    cards = [*mesh("SLEEVE", np.linspace(inside, outside, rows + 1), np.linspace(0.0, 1.0, 6),
                   "CAX8"), "*NODE", "90001, 0., 0.", "*SURFACE, NAME=SHAFT, TYPE=SEGMENTS",
             f"START, {inside + overlap!r}, 4.", f"LINE, {inside + overlap!r}, -3.",
             "*RIGID BODY, REF NODE=90001, ANALYTICAL SURFACE=SHAFT",
             *material("SLEEVE", (1000.0, 0.3)), *SMOOTH,
             "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, SLIDING=FINITE", "SLEEVE.LEFT, SHAFT",
             "*BOUNDARY", "90001, 1, 6", "*STEP", "*STATIC", "1., 1.", "*BOUNDARY",
             "SLEEVE.BOTTOM, 2", "SLEEVE.TOP, 2", "*END STEP", "*STEP, INC=1000", "*STATIC",
             "0.1, 1.", "*BOUNDARY", "SLEEVE.BOTTOM, 2, 2, 2.", "SLEEVE.TOP, 2, 2, 2.",
             "*END STEP"]
    # Lame: u(a) = p a (1 + nu) ((1 - 2 nu) a^2 + b^2)/(E (b^2 - a^2)) in plane strain
    pressure = overlap / inside * 1000.0 * (outside**2 - inside**2) / 1.3 / (
        0.4 * inside**2 + outside**2)
    return cards, [Check(f"pressure, all contact points, t = {time}", "pressure", "FACE", pressure,
                         {4: 1e-3, 8: 1e-4}[rows], when=f"{time}")
                   for time in (1.0, 1.55, 2.0)]


PAD_START, PAD_WIDTH, RAIL_END = 0.2, 1.2, 4.0


def patch(kind):
    """Return a pad under a pressure of 3 that slides along a rail whose nodes do not match."""
    pressure, places = 3.0, [0.0, 0.4, 0.7, 1.2, 1.5, 2.0, 2.35, 2.8, 3.1, 3.7, RAIL_END]
    below = mesh("RAIL", places, [-1.0, -0.4, 0.0], kind)
    pad = mesh("PAD", [PAD_START, 0.5, 0.9, 1.1, PAD_START + PAD_WIDTH], [0.0, 0.5, 1.0], kind,
               first=1001, skew=0.05)
    cards = [*below, *pad, *material("RAIL", (1000.0, 0.0)), *material("PAD", (1000.0, 0.0)),
             *SMOOTH, "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, SLIDING=FINITE",
             "PAD.BOTTOM, RAIL.TOP", "*BOUNDARY", "RAIL, 1, 2", "*STEP", "*STATIC", "1., 1.",
             "*BOUNDARY", "PAD.LEFT, 1", "*DSLOAD", f"PAD.TOP, P, {pressure!r}", "*END STEP",
             "*STEP, INC=1000", "*STATIC", "0.025, 1.", "*BOUNDARY", "PAD.LEFT, 1, 1, 2.4",
             "*END STEP"]
    times = [1.0, 1.1, 1.3, 1.525, 1.75, 2.0]
    # At t = 1.3 the pad covers the sides on both sides of x = 1.5.
    node = next(n for n, place in nodes_of(below).items() if place == (1.5, 0.0))
    share = (0.3 + 0.5) / (6 if kind[-1] in "68" else 2)
    return cards, [*(Check(f"{name}, t = {time}", quantity, where, value, 1e-10, when=f"{time}")
                     for time in times for name, quantity, where, value in (
                         ("pressure, all contact points", "pressure", "FACE", pressure),
                         ("sigma_yy of the pad, all nodes", "S22", "PAD", -pressure))),
                   Check("force on a node of the rail, t = 1.3", "RF2", node, pressure * share,
                         1e-10, when="1.3")]


PECLET, TRAVEL, MU = 2.0, 10.0, 0.5        # v b/(2 kappa); way of the pad over half its width
SPEED = 2 * PECLET                         # b = k = rho c = p = 1


def jaeger(ahead):
    """Return the temperature under the band, from its middle on."""
    return face_temperature(ahead, 1.0, SPEED, MU * SPEED, 1.0, 1.0)


def pad_that_heats_a_rail(count):
    """Return a soft pad under a uniform pressure that slides along a rail and heats it."""
    side, back, front = 1.0 / count, -2.0, 3.0
    down = graded(side / 2, 0.0, 8.0, 1.3)
    below = mesh("RAIL", [back + side * k for k in range(round((TRAVEL + front - back) * count)
                                                         + 1)], [-y for y in down[::-1]], "CPE4")
    # Shear within a thin layer: friction does not tilt the pad.
    pad = mesh("PAD", np.linspace(-1.0, 1.0, 2 * count + 1), [0.0, 0.02, side], "CPE4", first=200001)
    unit = {"conductivity": 1.0, "density": 1.0, "specific_heat": 1.0}
    period = TRAVEL / SPEED
    cards = [*below, *pad, "*NSET, NSET=HELD", *(f"{n}" for n, (_, y) in nodes_of(pad).items() if y),
             *material("RAIL", (1e6, 0.0), **unit), *material("PAD", (1e3, 0.0), **unit),
             "*SURFACE INTERACTION, NAME=RUB", "*FRICTION", f"{MU!r}", "*GAP HEAT GENERATION",
             "1., 0.", "*GAP LAW, TYPE=POWER", "0., 0., 1.",
             "*CONTACT PAIR, INTERACTION=RUB, NAME=FACE, SLIDING=FINITE", "PAD.BOTTOM, RAIL.TOP",
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "RAIL, 0.", "PAD, 0.",
             "*AMPLITUDE, NAME=SLIDE", f"0., 0., {period!r}, 1.", "*BOUNDARY", "RAIL.BOTTOM, 1, 2",
             "HELD, 1", "*STEP", "*STATIC", "1., 1.", "*DSLOAD", "PAD.TOP, P, 1.", "*END STEP",
             "*STEP, INC=100000", "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT",
             f"{side / 2 / SPEED!r}, {period!r}", "*BOUNDARY, AMPLITUDE=SLIDE",
             f"HELD, 1, 1, {TRAVEL!r}", "*END STEP"]
    at = {round(x - TRAVEL, 6): n for n, (x, y) in nodes_of(below).items() if y == 0.0}
    return cards, [
        *(Check(f"T of the rail at {ahead:+} b", "NT", at[ahead], jaeger(ahead),
                0.01 * jaeger(-0.75), "ABS") for ahead in (-4.0, -2.0, -0.75, -0.5, 0.0, 0.5, 1.25)),
        Check("heat of friction", "heat_friction", "", MU * 2 * SPEED, 1e-3),
        Check("force of the drive", "shear_force", "FACE", -MU * 2, 1e-3)]


def cases():
    """Return the cases of the theme."""
    rollers = f"""The half-width of the contact is a = {WIDTH}; a rail of {2 * DEPTH:g} x {DEPTH:g}
        has sides of a/n along the slide. The roller is pressed by the force P that makes that
        width, then held at its depth and slid, without turning, by {SPACINGS} spacings in {PARTS}
        increments. t = 1.25 is 2.5 spacings."""
    hertz = "Hertz: a^2 = 4 P R/(pi E*), p = 2 P/(pi a) sqrt(1 - x^2/a^2)."
    limits = "Force 0.5 %, pressures 1 %, the edge a tenth of a spacing."
    return [
        Case("Rigid roller slid along a rail", f"A rigid arc of radius {RADIUS:g}, the master. {rollers}",
             hertz, limits, [("NODES", 20), ("SURFACES", 24.4)], rigid_roller,
             lambda kind: f"{kind[0]}, n = {kind[1]}", named="contact points"),
        Case("Elastic roller slid along a rail", f"""Half of a roller of radius 10 under a pressure
             at its plane face, nodes that do not match. {rollers}""", hertz, limits,
             [("roller", 12), ("rail", 20)], elastic_roller,
             lambda kind: f"{kind[0]}, n = {kind[1]}", named="slave"),
        Case("Sleeve slid along a shaft", """Axisymmetric: a sleeve of radii 1 and 2 and length 1
             on a rigid shaft with an overlap of 1e-6, E = 1000, nu = 0.3, both ends held and moved
             along the axis by 2. 4 elements through the wall, and more.""", "Lamé, plane strain.",
             "1e-3 for 4 elements, a tenth of it for twice as many.", [4, 8], sleeve,
             lambda rows: f"{rows} elements"),
        Case("Pad under a constant pressure", """A pad of distorted elements, nu = 0, under the
             pressure 3, slides by two of its widths along a rail with sides of other lengths, whose
             nodes are all held.""", """Equilibrium: the stress is uniform, and a node of the rail
             carries the pressure times its share of the sides beside it.""",
             "Rounding, at every position.", ["CPE4", "CPE3", "CPE8", "CPE6"], patch,
             named="element", short=4),
        Case("Pad that heats a rail", f"""A soft pad of width 2 b under the pressure p slides along
             a rail with friction {MU}, whose heat all enters the rail: Pe = v b/(2 kappa) = {PECLET:g},
             b = p = k = rho c = 1, after a way of {TRAVEL:g} b. Sides of b/n and increments of half
             a side.""", """Jaeger's band, `tests/reference/moving_source.py`, q = mu p v. Work of the
             drive: heat of friction mu P v.""", """1 % of the highest temperature; heat and force 0.1 %.""",
             [8, 16], pad_that_heats_a_rail, lambda count: f"n = {count}")]


def draw(runs, path):
    """Draw the pressure under a roller and the temperature of a rail."""
    figure, (left, right) = subplots(1, 2, height=3.2)
    solved = runs["Rigid roller slid along a rail"][0]
    side = WIDTH / 20
    with h5py.File(solved.result) as file:
        times, face = file["history/time"][()], file["contact/FACE"]
        for time in (1.0, 1.5, 2.0):
            k = int(np.argmin(abs(times - time)))
            left.plot(face["x"][()], face["pressure"][k], "o", markersize=3, label=f"t = {time}")
            x = (time - 1.0) * SPACINGS * side + WIDTH * np.cos(np.linspace(0.0, pi, 61))
            middle = (time - 1.0) * SPACINGS * side
            left.plot(x, MODULUS * WIDTH / 2 / RADIUS * np.sqrt(
                np.maximum(0.0, 1 - ((x - middle) / WIDTH) ** 2)), "k-", linewidth=0.8)
    left.set(xlim=(-1.5 * WIDTH, 2.5 * WIDTH), xlabel="x", ylabel="pressure",
             title="Rigid roller: points, and Hertz's lines")
    left.legend()
    cards, _ = pad_that_heats_a_rail(8)
    with h5py.File(runs["Pad that heats a rail"][0].result) as file:
        number = file["VTKHDF/PointData/node_id"][()]
        last = file["VTKHDF/PointData/temperature"][()][-len(number):]
    top = [(x - TRAVEL, n) for n, (x, y) in nodes_of(cards).items() if y == 0.0 and n < 200000]
    at = {int(n): float(value) for n, value in zip(number, last, strict=True)}
    top = [(x, at[n]) for x, n in sorted(top) if -5.0 <= x <= 2.0]
    right.plot(*zip(*top, strict=True), "o", markersize=3, label="rail")
    xs = np.linspace(-5.0, 2.0, 141)
    right.plot(xs, [jaeger(x) for x in xs], "k-", linewidth=0.8, label="Jaeger")
    right.set(xlabel="distance from the middle of the pad over b", ylabel="temperature",
              title="Rail under a pad that slides to the right")
    right.legend()
    save(figure, path)


def test_sliding_against_closed_forms(tmp_path):
    import test_sliding

    check_short(test_sliding, tmp_path)
