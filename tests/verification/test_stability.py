"""Stability in time: growth rates and periods of small motions against closed forms."""

from math import pi

import numpy as np
from manual import Case, Check, check_short, errors_panel
from pictures import save, subplots
from physics import material, mesh, nodes_of
from test_frictional_heat import rubbing
from test_transients import graded

import rod_modes
import rods
from frictional_heat import BarMode, burton

TITLE = "Stability in time"
TEXT = r"""The number of growing motions that \*STABILITY reports is right in every case; rates and
periods are met to four digits."""
DETAILS = """Every row halves the elements of the row before."""
TOGETHER = ("Rods", "Rods with one solution", "Barber's rod",
            "Bar on a sliding wall", "Burton's half-plane")
PICTURE = "stability"
CAPTION = "Errors of rates and periods over meshes"
FINENESS = [1, 2, 4]
STEADY = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.",
          "*STABILITY"]


def label(level):
    """Return how fine a row is."""
    return f"{level} x"


def rates(modes, rate, period=0.0, tolerance=1e-2):
    """Return the checks of what *STABILITY finds."""
    found = [Check("growing motions", "unstable_modes", "", modes, 1e-9, "ABS"),
             Check("growth rate", "growth_rate", "", rate, tolerance)]
    return [*found, Check("period", "period", "", period, tolerance)] if period else found


def rod(name, ends, n, first, capacity, **properties):
    """Return the cards of a rod of n elements along y."""
    return [*mesh(name, [0.0, 0.02], np.linspace(*ends, n + 1), first=first),
            *material(name, (2e11, 0.0), density=1.0, specific_heat=capacity, **properties)]


def two_rods(gap, expansions, a, b, capacities, branch, level):
    """Return two rods of 0.1 between walls at 500 and 0, in one of their solutions, and what is
    known of their motions."""
    both = rods.Rods((0.1, 0.1), (20.0, 20.0), expansions, (2e11, 2e11), (500.0, 0.0), gap)
    touch, c = a / b, 1e-4
    solution = rods.exact_solutions(both, a, b, touch, c)[branch]
    motions = rod_modes.rates(both, capacities, solution)
    n = 2 * level
    cards = [*rod("HOT", (0.0, 0.1), n, 1, capacities[0], expansion=expansions[0],
                  conductivity=20.0),
             *rod("COLD", (-0.1, 0.0), n, 1001, capacities[1], expansion=expansions[1],
                  conductivity=20.0),
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HOT, 0.", "COLD, 0.",
             "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=GAS", f"{a!r}, {b!r}",
             "*GAP LAW, TYPE=POWER", f"{touch!r}, {c!r}, 1.",
             "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "HOT.BOTTOM, COLD.TOP",
             f"*CLEARANCE, SLAVE=HOT.BOTTOM, MASTER=COLD.TOP, VALUE={gap!r}",
             "*FIXED POINT, METHOD=NEWTON, TOL=1.E-11", "*START, FROM=GIVEN",
             f"FACE, {solution.conductance!r}", *STEADY, "*BOUNDARY", "HOT, 1, 1, 0.",
             "COLD, 1, 1, 0.", "HOT.TOP, 2, 2, 0.", "COLD.BOTTOM, 2, 2, 0.",
             "HOT.TOP, 11, 11, 500.", "COLD.BOTTOM, 11, 11, 0.", "*END STEP"]
    fastest = motions[0]
    return cards, rates(np.count_nonzero(motions.real > 0.0), fastest.real,
                        2 * pi / abs(fastest.imag) if fastest.imag else 0.0)


def rods_r3(branch):
    """Return how to make the rods with three solutions."""
    return lambda level: two_rods(1.2e-4, (0.0, 12e-6), 0.005, 1e-5, (3.6e6, 3.6e6), branch, level)


def rods_that_oscillate(ratio):
    """Return how to make two rods with one solution, the hot one with more capacity."""
    return lambda level: two_rods(6.05e-4, (12e-6, 12e-6), 0.005, 1e-6, (ratio * 3.6e6, 3.6e6), 0,
                                  level)


# The first two roots of Barber's rod, phi'' = l phi, phi'(1) + phi(1) = 4 d int phi.
BARBER = {0.96: -0.160143571, 1.02: 0.0799646108, 2.0: 3.92822408}


def barbers_rod(d):
    """Return how to make a rod against a hot wall, conductance 1 with the slope 8 d over the
    pressure, which is 1: the wall is at 1, the face at 1/2."""

    def make(level):
        n, slope = 4 * level, 8 * d
        sides = [0.0, 1.0 / n]
        cards = [*mesh("ROD", np.linspace(0.0, 1.0, n + 1), sides, "CPS8", first=1),
                 *material("ROD", (1000.0, 0.0), expansion=(1e-3, 0.0, 0.0), conductivity=1.0,
                           density=1.0, specific_heat=1.0, expansion_type="ORTHO"),
                 *mesh("WALL", [1.0, 1.0 + 1.0 / n], sides, "CPS8", first=1001),
                 *material("WALL", (1000.0, 0.0), conductivity=1.0),
                 "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ROD, 0.", "WALL, 0.",
                 "*SURFACE INTERACTION, NAME=FACE", "*GAP CONDUCTANCE, PRESSURE",
                 f"{1 - 0.9 / (1 + slope) * slope!r}, {1 - 0.9 / (1 + slope)!r}",
                 f"{1 + slope!r}, 2.", "*CONTACT PAIR, INTERACTION=FACE, NAME=FACE",
                 "ROD.RIGHT, WALL.LEFT", "*FIXED POINT, METHOD=NEWTON, TOL=1.E-11",
                 "*START, FROM=GIVEN", "FACE, 1.", *STEADY, "*BOUNDARY", "WALL, 1, 2, 0.",
                 # The temperature of 1/4 in the mean makes a quarter of the pressure.
                 "WALL, 11, 11, 1.", "ROD.LEFT, 1, 1, 0.75e-3", "ROD.BOTTOM, 2, 2, 0.",
                 "ROD.LEFT, 11, 11, 0.", "*END STEP"]
        return cards, rates(int(d > 1), BARBER[d])
    return make


def sliding_bar(number):
    """Return how to make a bar on a wall that slides, in its steady state under the pressure 1."""

    def make(level):
        n, wall = 4 * level, [-0.25 / level, 0.0]
        sides = [0.0, 1.0 / n]
        bar = mesh("BAR", np.linspace(0.0, 1.0, n + 1), sides, "CPS8", first=1)
        steady = [f"{node}, {number * (1 - x)!r}" for node, (x, _) in nodes_of(bar).items()]
        return [*bar, *material("BAR", (1000.0, 0.0), expansion=(1e-3, 0.0, 0.0), conductivity=1.0,
                                density=1.0, specific_heat=1.0, expansion_type="ORTHO"),
                *mesh("WALL", wall, sides, "CPS8", first=5001),
                *material("WALL", (1000.0, 0.0), conductivity=1.0),
                *rubbing(0.5, (1.0, 1.0, 2 * number), "BAR.LEFT", "WALL.RIGHT"),
                "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "WALL, 0.", *steady,
                # Bodies expand from their start.
                "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", "1e-3, 1e-3", "*STABILITY",
                "*BOUNDARY", "WALL, 1, 2, 0.", "WALL, 11, 11, 0.", "BAR.BOTTOM, 2, 2, 0.",
                "BAR.RIGHT, 1, 1, -1e-3", "BAR.RIGHT, 11, 11, 0.", "*END STEP"], rates(
            int(number > 2), BarMode(number).rate)
    return make


def burtons_half_plane(ratio, growing):
    """Return how to make half a wave of a half-plane that slides out of the plane, V/Vcr = ratio:
    all its waves that are shorter by a whole number fit in, too."""

    def make(level):
        xs, ys = np.linspace(0.0, pi, 12 * level + 1), graded(14.0, 20 * level,
                                                              1.25 ** (0.5 / level))
        heating = ratio * 2 * 0.7   # of Vcr = 2 m k (1 - nu)/(mu alpha E)
        rate = max(m**2 * burton(ratio / m)[0] for m in range(1, 6))
        return [*mesh("HALF", xs, ys), *material("HALF", (1000.0, 0.3), expansion=1e-3,
                                                 conductivity=1.0, density=1.0, specific_heat=1.0),
                *mesh("WALL", xs, [-0.2, 0.0], first=100001),
                *material("WALL", (1000.0, 0.3), conductivity=1.0),
                *rubbing(0.5, (1.0, 1.0, heating / 0.5), "HALF.BOTTOM", "WALL.TOP"),
                "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HALF, 0.", "WALL, 0.", *STEADY,
                "*BOUNDARY", "WALL, 1, 2, 0.", "WALL, 11, 11, 0.", "HALF.LEFT, 1, 1, 0.",
                "HALF.RIGHT, 1, 1, 0.", "HALF.TOP, 11, 11, 0.", "*DSLOAD", "HALF.TOP, P, 1.",
                "*END STEP"], rates(growing, rate)
    return make


def cases():
    """Return the cases of the theme."""
    dense = """Dense eigenvalues of both rods with polynomials of degree 24,
        `tests/reference/rod_modes.py`; the closed form gives the same digits."""
    why = """1 %, of the coarsest mesh; the finest is within 1e-4."""
    series = {"meshes": FINENESS, "label": label, "tolerance": why, "order": {"growth rate": 2.5}}
    three = """Rods of 0.1 each, k = 20, rho c = 3.6e6, E = 2e11, walls at 500 and 0, heated from
        the side that expands less, gap 1.2e-4, omega = 0.005/(1e-5 + gap)."""
    one = """The same rods, both with alpha 12e-6, gap 6.05e-4, omega = 0.005/(1e-6 + gap): the
        only solution has a gap of 5e-6 and U' = 0."""
    barber = """phi'' = l phi, phi(0) = 0, phi'(1) + phi(1) = 4 d int phi, in units of
        kappa/L^2. The wall is at 1, the face at 1/2, conductance 1 at the pressure 1 with the slope
        8 d: unstable above d = 1. 4 elements, and finer."""
    bar = """E alpha = k = L = rho c = 1, on an insulating wall that slides out of the plane,
        S = mu V E alpha L/k, unstable above S = 2. 4 elements, and finer."""
    plane = """In plane strain, E alpha = k = rho c = 1, nu = 0.3, on a rigid insulator that slides
        out of the plane: half a wave of 12 elements, 20 graded ones to a depth of 14, and finer."""
    return [
        *(Case(f"Rods, {name} solution", three, dense, make=rods_r3(branch), **series)
          for branch, name in enumerate(("open", "middle", "closed"))),
        *(Case(f"Rods with one solution, capacities {ratio} : 1", f"{one} {words}", dense,
               make=rods_that_oscillate(ratio), **series)
          for ratio, words in ((1.5, "It lasts."), (2.0, "It oscillates, ever more."))),
        *(Case(f"Barber's rod, d = {d}", barber, "Root of the characteristic equation.",
               make=barbers_rod(d), **series) for d in BARBER),
        *(Case(f"Bar on a sliding wall, S = {number}", bar, """Closed form,
               `tests/reference/frictional_heat.py`.""", make=sliding_bar(number), **series)
          for number in (1.0, 1.5, 2.5, 3.0, 4.0)),
        *(Case(f"Burton's half-plane, V/Vcr = {ratio}", f"{plane} {words}", """Closed form,
               `tests/reference/frictional_heat.py`.""", make=burtons_half_plane(ratio, growing),
               **{**series, "meshes": FINENESS[:2]})
          for ratio, growing, words in (
              (1.9, 1, "The second wave is slower than its own critical speed."),
              (3.9, 3, "The second wave grows fastest, twice as often at half the ratio.")))]


def draw(runs, path):
    """Draw the errors of some cases."""
    figure, panels = subplots(2, 2, height=5.3)
    shown = [title for title in runs if any(word in title for word in (
        "middle", "2.0 : 1", "d = 1.02", "S = 4"))]
    for axes, title in zip(panels.flat, shown, strict=True):
        errors_panel(axes, runs[title], title, "fineness of the mesh")
    save(figure, path)


def test_stability_against_closed_forms(tmp_path):
    import test_stability

    check_short(test_stability, tmp_path)
