"""Heat that is stored: closed forms over meshes and increments."""

import re
from dataclasses import replace
from math import log10, pi, sqrt

import numpy as np
from document import Table, verdict
from manual import Case, Check, check_short, errors_panel
from pictures import save, subplots
from physics import material, mesh, nodes_of
from scipy.optimize import brentq

import transient

TITLE = "Transients"
TEXT = """Temperatures after a jump converge with order 2, that of the scheme L-STABLE; every row of
the complete tables halves elements and increments. On the finest ones the error is below 0.01 % of
the jump."""
DETAILS = """Bodies that store heat, with increments of one length and the default scheme, L-STABLE.
Every row halves the elements and the increments of the row before. The last table has increments
that are chosen by their error instead.

The tolerance is 0.1 (dt/t)^2 of the jump that the case is about, at the time t with increments dt.
The scheme replaces exp(z) by exp(z) + 0.0404 z^3 for one increment, so that at t a mode that decays
at the rate r has lost 0.0404 (r dt)^2 (r t) exp(-r t) of its start, at most 0.054 (dt/t)^2, where
r t = 3. The modes of a half-space after a jump of its face add up to at most 0.026 (dt/t)^2. The
elements, of eight nodes, have the rest."""
TOGETHER = ("Rod that grows until it touches",)
PICTURE = "transients"
CAPTION = "Errors of transients over meshes and increments"
FINENESS = [1, 2, 4]


def allowed(part, level=1):
    """Return the tolerance of a unit jump; increments of fineness 1 are this part of the time."""
    return 0.1 * (part / level) ** 2


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
              100 * allowed(2.0 / t, level), "ABS", when=f"{t!r}")
        for x, t in ((0.08, 20.0), (0.08, 32.0), (0.04, 32.0))]


def shocked_wall(level):
    """Return half a wall whose face is at 100 at once."""
    cards = bar("WALL", np.linspace(0.0, 1.0, 10 * level + 1), 1.0, 1.0)
    return [*cards, *start("WALL"),
            *heat(0.02 / level, 0.8, "*BOUNDARY", "WALL.LEFT, 11, 11, 100.")], [
        Check(f"T at x = {x}, t = {t}", "NT", node_at(cards, x),
              100 * transient.shocked_wall(x, t), 100 * allowed(0.02 / t, level), "ABS",
              when=f"{t!r}")
        for x, t in ((0.2, 0.1), (0.8, 0.1), (0.2, 0.8))]


def slab_with_film(level):
    """Return half a slab that a film cools, Bi = 1."""
    cards = bar("SLAB", np.linspace(0.0, 1.0, 10 * level + 1), 1.0, 1.0)
    return [*cards, *start("SLAB", 1.0),
            *heat(0.02 / level, 1.0, "*SFILM", "SLAB.RIGHT, F, 0., 1.")], [
        Check(f"T of the {place}, t = {t}", "NT", node_at(cards, x),
              transient.slab_with_film(x, t, 1.0), allowed(0.02 / t, level), "ABS", when=f"{t!r}")
        for place, x, t in (("face", 1.0, 0.1), ("face", 1.0, 1.0), ("centre", 0.0, 1.0))]


def cylinder_with_film(level):
    """Return a cylinder that a film heats to 100."""
    cards = bar("ROD", np.linspace(0.0, 2.0, 10 * level + 1), 50.0, 3900.0, kind="CAX8")
    return [*cards, *start("ROD"),
            *heat(3.12 / level, 312.0, "*SFILM", "ROD.RIGHT, F, 100., 250.")], [
        Check(f"T at r = {r}, t = {t}", "NT", node_at(cards, r),
              100 * (1 - transient.cylinder_with_film(r / 2, 50 / 3900 * t / 4, 10.0)),
              100 * allowed(3.12 / t, level), "ABS", when=f"{t!r}")
        for r, t in ((2.0, 12.48), (2.0, 312.0), (0.0, 312.0))]


def graded(length, count, ratio):
    """Return points from 0 to a length, each spacing the one before times a ratio."""
    steps = ratio ** np.arange(count)
    return np.concatenate([[0.0], np.cumsum(steps)]) * length / np.sum(steps)


def half_space_with_film(level):
    """Return a half-space that a film of 1 heats to 1: steps of increments ten times as long each,
    ten of them to a time."""
    cards = bar("SOIL", graded(100.0, 40 * level, 1.2 ** (1 / level)), 1.0, 1.0)
    steps, times, before = [], (0.01, 1.0, 100.0), 0.0
    for time in times:
        # A whole number of increments that are at most a tenth of the time.
        count = round((time - before) / time * 10 + 0.5) * level
        steps += heat((time - before) / count, time - before, "*SFILM", "SOIL.LEFT, F, 1., 1.")
        before = time
    return [*cards, *start("SOIL"), *steps], [
        Check(f"T of the face, t = {t}", "NT", node_at(cards, 0.0),
              transient.half_space_with_film(sqrt(t)), allowed(0.1, level), "ABS", when=f"{t!r}")
        for t in times]


HALF_SPACE = 1.0   # m; sqrt(a t) is 0.08 at most


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
              transient.sudden_contact(2000.0, effusivities, 100.0, t), allowed(1.0 / t, level),
              when=f"{t!r}") for t in (10.0, 100.0)]


LENGTH, EXPANSION, RISE = 100.0, 1e-5, 100.0
COUNT = 10   # increments until the rod touches


def rod_that_touches(part):
    """Return a maker of a rod that expands until it touches a wall, over a part of the way that it
    would go."""
    touch = float(brentq(lambda t: transient.mean_of_shocked_wall(t) - part, 1e-4, 1))
    gap = part * EXPANSION * RISE * LENGTH

    def make(level):
        rod = bar("ROD", np.linspace(0.0, LENGTH, 10 * level + 1), 1.0, 1.0, elastic=(2e11, 0.0),
                  expansion=EXPANSION)
        wall = bar("WALL", LENGTH + gap + np.linspace(0.0, LENGTH, 3), 1.0, 1.0, first=10001,
                   elastic=(2e11, 0.0))
        seconds = touch * LENGTH**2
        increment = seconds / COUNT / level
        half = seconds / 2
        cards = [*rod, *wall, *start("ROD"), *start("WALL")[1:],
                 "*SURFACE INTERACTION, NAME=FACES",
                 "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "ROD.RIGHT, WALL.LEFT",
                 "*BOUNDARY", "ROD, 2", "WALL, 2", "ROD.LEFT, 1", "WALL.RIGHT, 1",
                 *heat(increment, seconds + increment, "*BOUNDARY", f"ROD.LEFT, 11, 11, {RISE!r}",
                       analysis="*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT")]
        return cards, [
            Check("gap at half the time", "gap", "FACE",
                  gap * (1 - transient.mean_of_shocked_wall(touch / 2) / part),
                  allowed(2 / COUNT, level) * gap / part, "ABS", when=f"{half!r}"),
            Check("open an increment before", "status", "FACE", 0.0, 0.5, "ABS",
                  when=f"{seconds - increment!r}"),
            Check("closed an increment after", "status", "FACE", 1.0, 0.5, "ABS")]

    return make


# Makers of cases, and their jumps: of temperatures, and of the heat flux that a drop of them is.
CHOSEN = {"Wall after a shock": (shocked_wall, 100.0), "Slab with a film": (slab_with_film, 1.0),
          "Cylinder with a film": (cylinder_with_film, 100.0),
          "Two half-spaces in sudden contact": (sudden_contact, 2000.0 * 100.0)}
LOCAL_ERRORS = [1e-2, 1e-3, 1e-4]


def of_local_error(row):
    """Return the finest mesh of a case, with increments that are chosen by their error."""
    title, error = row
    make, jump = CHOSEN[title]
    cards, checks = make(FINENESS[-1])
    assert sum(card.endswith(", DIRECT") for card in cards) == 1
    return [card.replace(", DIRECT", f", LOCAL ERROR={error!r}") for card in cards], [
        replace(check, tolerance=0.2 * error * jump, how="ABS") for check in checks]


class ChosenIncrements(Case):
    """A case of runs whose increments are chosen: a row of each, with what it took."""

    def table(self, runs):
        """Return the table; errors fall with what is allowed to increments."""
        table = Table(self.title, ["case", "LOCAL ERROR", "increments", "repeated",
                                   "factorisations", "largest error", "order", "allowed",
                                   "verdict"], text=self.text())
        before = {}
        for solved in runs:
            title, part = solved.mesh
            error = max(found.error for found in solved.verdicts) / CHOSEN[title][1]
            order = log10(before[title] / error) if title in before else None
            before[title] = error
            listing = solved.result.with_suffix(".lst").read_text()
            factored, increments = re.search(
                r"matrix of heat was factored (\d+) times in (\d+) increments", listing).groups()
            table.rows.append([title, f"{part:.0e}", increments, str(listing.count("  attempt ")),
                               factored, f"{error:.2g}", "" if order is None else f"{order:.1f}",
                               f"{0.2 * part:.2g}",
                               verdict(all(found.passed for found in solved.verdicts)
                                       and (order is None or order > 0.5))])
        return table


def cases():
    """Return the cases of the theme."""
    source = "Closed forms, H. S. Carslaw, J. C. Jaeger: Conduction of Heat in Solids, 1959."
    shared = {"meshes": FINENESS, "label": label}
    series = {"source": f"{source} tests/reference/transient.py sums them.", **shared,
              "tolerance": "0.1 (dt/t)^2 of the jump: see the beginning of the section."}

    def second(case):
        """Return a case whose temperatures must show the order of the scheme."""
        case.order = {check.name: 1.5 for check in case.make(1)[1] if check.quantity != "status"}
        return case

    found = [second(case) for case in (
        Case("NAFEMS T3",
             """A bar of 0.1 m at 0, k = 35 W/(m K), rho c = 3.1716e6 J/(m3 K), whose end follows
             100 sin(pi t/40). 10 elements and increments of 2 s, and finer. NAFEMS gives 36.60 at
             x = 0.08 m, t = 32 s.""", make=nafems_t3, **{
                 **series, "tolerance": """0.1 (dt/t)^2 of 100: the course of the load is a sum of
                 jumps, most of them long past."""}),
        Case("Wall after a shock",
             """A wall of half width 1, k = rho c = 1, at 0, its faces at 100 from t = 0 on. 10
             elements and increments of 0.02, and finer.""", make=shocked_wall, **series),
        Case("Slab with a film",
             """A slab of half width 1, k = rho c = 1, at 1, cooled to 0 by a film of 1. 10 elements
             and increments of 0.02, and finer.""", make=slab_with_film, **series),
        Case("Half-space with a film",
             """A half-space, k = rho c = 1, at 0, heated to 1 by a film of 1. 40 graded elements
             and a step to each of the times, with increments of about a tenth of it, and finer.""",
             make=half_space_with_film, **{**series, "source": source}),
        Case("Cylinder with a film",
             """A cylinder of radius 2, k = 50, rho c = 3900, at 0, heated to 100 by a film of 250.
             10 elements and increments of 3.12, and finer.""", make=cylinder_with_film, **series),
        Case("Two half-spaces in sudden contact",
             """k = 40 and 160, rho c = 3.6e6 and 2.4e6, at 100 and 0, joined at t = 0 by a
             conductance of 2000. 20 graded elements each and increments of 1 s, and finer.""",
             make=sudden_contact, **{**series, "source": source, "tolerance": """0.1 (dt/t)^2 of the
             flux itself, which is a sum of decaying modes."""}),
        *(Case(f"Rod that grows until it touches, {part} of its way",
               f"""A rod of 100, k = rho c = 1, alpha = 1e-5, nu = 0, one end at 100 from t = 0 on,
               the other insulated and apart from a wall by {part} of what the rod would grow to.
               10 elements, 10 increments until it touches, and finer.""",
               make=rod_that_touches(part), **{**series, "tolerance": f"""0.1 (dt/t)^2 of the whole
               growth, which is {1 / part:.3g} times the gap. The gap closes in the increment in
               which it does in closed form."""})
          for part in (0.25, 0.75)))]
    found.append(ChosenIncrements(
        "Increments chosen by their error",
        """The finest meshes of cases above, without DIRECT. `repeated` counts increments that erred
        too much, `factorisations` those of the matrix of heat, one for each size of an increment at
        least, and `order` is log10 of the ratio to the error of the row before.""",
        source, """The error of an increment is measured beside a scheme of first order. In a mode
        that decays by z in an increment it is 0.207 z^2; the increment errs by 0.0404 z^3, and
        those of 1/z increments add up: 0.2 of LOCAL ERROR.""",
        [(title, error) for title in CHOSEN for error in LOCAL_ERRORS], of_local_error,
        lambda row: f"{row[0]}_{row[1]:g}", short=3))
    return found


def of_values(solved):
    """Return a run with its checks of values, without those of what is open or closed."""
    kept = [k for k, check in enumerate(solved.checks) if check.quantity != "status"]
    return replace(solved, checks=[solved.checks[k] for k in kept],
                   verdicts=[solved.verdicts[k] for k in kept])


def draw(runs, path):
    """Draw the errors of all cases."""
    figure, panels = subplots(4, 2, height=10.5)
    over_meshes = [(title, solved) for title, solved in runs.items()
                   if solved[0].mesh == FINENESS[0]]
    for axes, (title, solved) in zip(panels.flat, over_meshes, strict=True):
        errors_panel(axes, [of_values(run) for run in solved], title,
                     "fineness of mesh and increments")
    save(figure, path)


def test_transients_against_closed_forms(tmp_path):
    import test_transients

    check_short(test_transients, tmp_path)
