"""Heat that is stored: closed forms over meshes and increments."""

from math import pi, sqrt

import numpy as np
from manual import Case, Check, check_short, errors_panel
from pictures import save, subplots
from physics import material, mesh, nodes_of

import transient

TITLE = "Transients"
TEXT = """Every row halves the elements and the increments of the row before, so that the order is
that of the scheme in time, 2 by default."""
PICTURE = "transients"
CAPTION = "Errors of transients over meshes and increments"
FINENESS = [1, 2, 4]
MOST = 5e-3   # allowed error of the coarsest mesh; a quarter of it on each finer one


def allowed(level):
    """Return the tolerance of a fineness."""
    return MOST / level**2


def label(level):
    """Return how fine a row is."""
    return f"{level} x"


def heat(increment, period, *cards, analysis="*HEAT TRANSFER, DIRECT"):
    """Return a transient step with fixed increments."""
    return ["*STEP, INC=100000", analysis, f"{increment!r}, {period!r}", *cards, "*END STEP"]


def start(name, value=0.0):
    """Return the card of an initial temperature."""
    return ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"{name}, {value!r}"]


def bar(name, points, conductivity, capacity, kind="CPE8", first=1, **more):
    """Return a bar along x of one element across, and its material."""
    ends = [float(x) for x in points]
    across = (ends[-1] - ends[0]) / (len(ends) - 1)
    return [*mesh(name, ends, [0.0, across], kind, first=first),
            *material(name, more.pop("elastic", None), conductivity=conductivity, density=1.0,
                      specific_heat=capacity, **more)]


def node_at(cards, x):
    """Return the number of a node at an x."""
    return str(next(n for n, p in nodes_of(cards).items() if abs(p[0] - x) < 1e-9))


def nafems_t3(level):
    """Return NAFEMS T3: one end follows a sine, as an amplitude of 0.1 s."""
    cards = bar("BAR", np.linspace(0.0, 0.1, 10 * level + 1), 35.0, 3.1716e6)
    times = np.linspace(0.0, 32.0, 321)
    rows = [f"{t:.3f}, {np.sin(pi * t / 40):.15g}" for t in times]
    return [*cards, *start("BAR"), "*AMPLITUDE, NAME=SINE", *rows,
            *heat(2.0 / level, 32.0, "*BOUNDARY", "BAR.LEFT, 11, 11, 0.",
                  "*BOUNDARY, AMPLITUDE=SINE", "BAR.RIGHT, 11, 11, 100.")], [
        Check(f"T at x = {x}, t = {t}", "NT", node_at(cards, x), transient.nafems_t3(x, t),
              allowed(level), when=f"{t!r}") for x, t in ((0.08, 20.0), (0.08, 32.0), (0.04, 32.0))]


def shocked_wall(level):
    """Return half a wall whose face is at 100 at once."""
    cards = bar("WALL", np.linspace(0.0, 1.0, 10 * level + 1), 1.0, 1.0)
    return [*cards, *start("WALL"),
            *heat(0.02 / level, 0.8, "*BOUNDARY", "WALL.LEFT, 11, 11, 100.")], [
        Check(f"T at x = {x}, t = {t}", "NT", node_at(cards, x),
              100 * transient.shocked_wall(x, t), allowed(level), when=f"{t!r}")
        for x, t in ((0.2, 0.1), (0.8, 0.1), (0.2, 0.8))]


def slab_with_film(level):
    """Return half a slab that a film cools, Bi = 1."""
    cards = bar("SLAB", np.linspace(0.0, 1.0, 10 * level + 1), 1.0, 1.0)
    return [*cards, *start("SLAB", 1.0),
            *heat(0.05 / level, 1.0, "*SFILM", "SLAB.RIGHT, F, 0., 1.")], [
        Check(f"T of the {place}, t = {t}", "NT", node_at(cards, x),
              transient.slab_with_film(x, t, 1.0), allowed(level), when=f"{t!r}")
        for place, x, t in (("face", 1.0, 0.1), ("face", 1.0, 1.0), ("centre", 0.0, 1.0))]


def cylinder_with_film(level):
    """Return a cylinder that a film heats to 100."""
    cards = bar("ROD", np.linspace(0.0, 2.0, 10 * level + 1), 50.0, 3900.0, kind="CAX8")
    return [*cards, *start("ROD"),
            *heat(3.12 / level, 312.0, "*SFILM", "ROD.RIGHT, F, 100., 250.")], [
        Check(f"T at r = {r}, t = {t}", "NT", node_at(cards, r),
              100 * (1 - transient.cylinder_with_film(r / 2, 50 / 3900 * t / 4, 10.0)),
              allowed(level), when=f"{t!r}") for r, t in ((2.0, 12.48), (2.0, 312.0), (0.0, 312.0))]


def graded(length, count, ratio):
    """Return points from 0 to a length, each spacing the one before times a ratio."""
    steps = ratio ** np.arange(count)
    return np.concatenate([[0.0], np.cumsum(steps)]) * length / np.sum(steps)


HALF_SPACE = 1.0   # deep enough at t = 1000 s


def sudden_contact(level):
    """Return two half-spaces that meet at time 0 over a conductance of 2000."""
    depth = graded(HALF_SPACE, 20 * level, 1.2 ** (1 / level))
    hot = bar("HOT", -depth[::-1], 40.0, 3.6e6)
    cold = bar("COLD", depth, 160.0, 2.4e6, first=10001)
    effusivities = sqrt(40.0 * 3.6e6), sqrt(160.0 * 2.4e6)
    return [*hot, *cold, *start("HOT", 100.0), *start("COLD", 0.0)[1:],
            "*SURFACE INTERACTION, NAME=FACES", "*GAP CONDUCTANCE, CLEARANCE", "2000., 0.",
            "2000., 1.", "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "HOT.RIGHT, COLD.LEFT",
            *heat(1.0 / level, 100.0)], [
        Check(f"heat flux, t = {t}", "heat_flux", "FACE",
              transient.sudden_contact(2000.0, effusivities, 100.0, t), allowed(level),
              when=f"{t!r}") for t in (10.0, 100.0)]


def cases():
    """Return the cases of the theme."""
    source = "Closed forms, Carslaw and Jaeger 1959, tests/reference/transient.py."
    tolerance = """0.5 % with the coarsest elements and increments, less by the order 2 of elements
        and scheme with the finer ones."""
    shared = {"source": source, "tolerance": tolerance, "meshes": FINENESS, "label": label}
    return [
        Case("NAFEMS T3",
             """A bar of 0.1 m at 0, k = 35 W/(m K), rho c = 3.1716e6 J/(m3 K), whose end follows
             100 sin(pi t/40). 10 elements and increments of 2 s, and finer. The target of NAFEMS
             is 36.60 at x = 0.08 m, t = 32 s.""", make=nafems_t3, **shared),
        Case("Wall after a shock",
             """A wall of half width 1, k = rho c = 1, at 0, its faces at 100 from t = 0 on. 10
             elements and increments of 0.02, and finer.""", make=shocked_wall, **shared),
        Case("Slab with a film",
             """A slab of half width 1, k = rho c = 1, at 1, cooled to 0 by a film of 1. 10 elements
             and increments of 0.05, and finer.""", make=slab_with_film, **shared),
        Case("Cylinder with a film",
             """A cylinder of radius 2, k = 50, rho c = 3900, at 0, heated by a film of 250 to 100.
             10 elements and increments of 3.12, and finer.""", make=cylinder_with_film, **shared),
        Case("Two half-spaces in sudden contact",
             """k = 40 and 160, rho c = 3.6e6 and 2.4e6, at 100 and 0, joined at t = 0 by a
             conductance of 2000. 20 graded elements each and increments of 1 s, and finer.""",
             make=sudden_contact, **shared),
    ]


def draw(runs, path):
    """Draw the errors of all cases."""
    figure, panels = subplots(2, 3)
    for axes, (title, solved) in zip(panels.flat, runs.items(), strict=False):
        errors_panel(axes, solved, title, "fineness of mesh and increments")
    panels.flat[-1].set_visible(False)
    save(figure, path)


def test_transients_against_closed_forms(tmp_path):
    import test_transients

    check_short(test_transients, tmp_path)
