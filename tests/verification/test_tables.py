"""Properties over temperature: closed forms and one-dimensional solutions over meshes."""

from itertools import pairwise
from math import cos, log, pi, sin

import numpy as np
from manual import Case, Check, check_short, errors_panel
from pictures import save, subplots
from physics import material, mesh, nodes_of
from test_transients import allowed, graded, heat, label, node_at, start

import tables as known

TITLE = "Properties over temperature"
TEXT = """Materials whose properties are tables over temperature: rectangles with a linear k(T) are
exact to rounding, transients converge with order 2, cylinders are met to 0.01 %."""
DETAILS = """Steady fields are allowed twice the largest difference between the exact temperature and its
interpolation by the elements, which falls with h^2 for elements without nodes between corners and
with h^3 for the others; other quantities state their own. Transients are allowed what those of the
section before are: 0.1 (dt/t)^2 of the jump."""
PICTURE = "tables"
CAPTION = "Errors of bodies with tables over meshes and increments"
KINDS = ("CPE8", "CPE8R", "CPE6", "CPE4", "CPE3")
TRIANGLES = "CPE6", "CPE3"
FINENESS = [1, 2, 4]


def strips(points, kinds, **properties):
    """Return bars of one element across, one of each kind, beside each other, and of one material;
    and their names."""
    cards, names = [], []
    across = float(points[-1] - points[0]) / (len(points) - 1)
    for k, kind in enumerate(kinds):
        names.append(f"BAR{kind}")
        low = 2 * k * across
        cards += mesh(names[-1], [float(x) for x in points], [low, low + across], kind,
                      first=10000 * k + 1)
        cards += material(names[-1], **properties)
    return cards, names


def nodes_at(cards, names, x):
    """Return a node of each bar at an x."""
    nodes = nodes_of(cards)
    return [str(next(n for n, p in nodes.items()
                     if n // 10000 == k and abs(p[0] - x) < 1e-9 * (1 + abs(x))))
            for k in range(len(names))]


def interpolation(field, points, kind):
    """Return the largest difference between a field along x and its interpolation by elements."""
    worst = 0.0
    for low, high in pairwise(points):
        nodes = np.linspace(low, high, 3 if kind.rstrip("R")[-1] in "68" else 2)
        fit = np.polyfit(nodes - low, [field(x) for x in nodes], len(nodes) - 1)
        there = np.linspace(low, high, 17)
        worst = max(worst, *np.abs(np.polyval(fit, there - low) - [field(x) for x in there]))
    return float(worst)


def steady(*cards, analysis="*HEAT TRANSFER, STEADY STATE"):
    """Return a steady step of one increment."""
    return ["*STEP", analysis, "1., 1.", *cards, "*END STEP"]


# Bars

SLAB = [(10.0, 0.0), (20.0, 500.0)]


def slab(level):
    """Return slabs of all kinds between 0 and 500."""
    points = np.linspace(0.0, 0.1, 2 * level + 1)
    cards, names = strips(points, KINDS, elastic=None, conductivity=SLAB)
    held = [f"{name}.{side}, 11, 11, {value}" for name in names
            for side, value in (("LEFT", 0.0), ("RIGHT", 500.0))]

    def field(x):
        return known.across(SLAB, x / 0.1, 0.0, 500.0)

    part = 2 * interpolation(field, points, "CPE4") / 500.0
    checks = [Check(f"T in the middle, {kind}", "NT", node, field(0.05),
                    2 * interpolation(field, points, kind) if kind in TRIANGLES else 1e-6, "ABS")
              for kind, node in zip(KINDS, nodes_at(cards, names, 0.05), strict=True)]
    checks.append(Check("heat through all", "heat_in", "", len(KINDS) * 0.05 / level * 75000.0,
                        part**2))
    return [*cards, *steady("*BOUNDARY", *held)], checks


PULLED = tuple(kind.replace("CPE", "CPS") for kind in KINDS)


def pulled(level):
    """Return bars of all kinds whose modulus is linear along them, under a tension."""
    points = np.linspace(0.0, 10.0, 2 * level + 1)
    cards, names = strips(points, PULLED, elastic=[(200.0, 0.0, 0.0), (80.0, 0.0, 100.0)],
                          conductivity=1.0)
    held = [line for name in names for line in (
        f"{name}.LEFT, 11, 11, 0.", f"{name}.RIGHT, 11, 11, 100.", f"{name}.LEFT, 1, 1",
        f"{name}.BOTTOM, 2, 2")]
    pulls = [f"{name}.RIGHT, P, -0.5" for name in names]

    def stretch(x):
        return 0.5 * log(200.0 / (200.0 - 12 * x)) / 12

    return [*cards, *start(names[0]), *[f"{name}, 0." for name in names[1:]],
            *steady("*BOUNDARY", *held, "*DSLOAD", *pulls,
                    analysis="*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE")], [
        Check(f"u of the end, {kind}", "U1", node, known.bar_stretch(0.5, 10.0, 200.0, 80.0),
              2 * interpolation(stretch, points, kind), "ABS")
        for kind, node in zip(PULLED, nodes_at(cards, names, 10.0), strict=True)]


# Half-spaces

GROWING = [(1.0, 0.0), (3.0, 4.0)]   # 1 + T/2


def half_space_under_flux(level):
    """Return a half-space, k = rho c = 1 + T/2, under a flux of 1."""
    depth = graded(12.0, 30 * level, 1.2 ** (1 / level))
    inside = depth[20 * level]
    cards, names = strips(depth, ("CPE8",), elastic=None, conductivity=GROWING, density=1.0,
                          specific_heat=GROWING)
    step = (0.1 / 10 / level, 0.1), (0.9 / 9 / level, 0.9)
    return [*cards, *start(names[0]), *[card for dt, period in step for card in heat(
        dt, period, "*DSFLUX", f"{names[0]}.LEFT, S, 1.")]], [
        Check(f"T at x = {x:.4g}, t = {t}", "NT", node_at(cards, x),
              known.flux_into_half_space(x, t), allowed(0.1, level), "ABS", when=f"{t!r}")
        for x, t in ((0.0, 0.1), (0.0, 1.0), (inside, 1.0))]


def half_space_after_step(level):
    """Return a half-space, k = 200 + T, rho c = 8e6, whose face takes 200 at once."""
    depth = graded(0.4, 20 * level, 1.1 ** (1 / level))
    places = depth[3 * level], depth[4 * level]
    cards, names = strips(depth, ("CPE8",), elastic=None,
                          conductivity=[(200.0, 0.0), (600.0, 400.0)], density=8000.0,
                          specific_heat=1000.0)
    exact = known.step_of_half_space(1.0, 200.0, 8e6, 100.0, 200.0)
    return [*cards, *start(names[0], 100.0), *heat(
        0.2 / level, 10.0, "*BOUNDARY", f"{names[0]}.LEFT, 11, 11, 200.")], [
        Check(f"T at x = {x:.4f}, t = {t}", "NT", node_at(cards, x), exact(x, t),
              100 * allowed(0.2 / t, level), "ABS", when=f"{t!r}")
        for x in places for t in (2.0, 10.0)]


# Cylinders

RADII, HOT, COLD, START, PRESSURE = (20.0, 40.0), 550.0, 80.0, 50.0, 30.0
CONDUCTIVITY = [(0.05, 0.0), (0.03, 600.0)]
YOUNG = [(200000.0, 0.0), (120000.0, 600.0)]
POISSON = [(0.28, 0.0), (0.34, 600.0)]
EXPANSION = [(1.0e-5, 0.0), (1.4e-5, 600.0)]
ZERO = 20.0
METAL = {"elastic": [(e, nu, t) for (e, t), (nu, _) in zip(YOUNG, POISSON, strict=True)],
         "expansion": EXPANSION, "conductivity": CONDUCTIVITY, "zero": ZERO}


def ring(name, kind, level, first=1, **properties):
    """Return a cylinder: a strip about the axis, or a quarter in the plane, and supports."""
    radii = [float(r) for r in np.linspace(*RADII, 4 * level + 1)]
    if kind.startswith("CAX"):
        height = 5.0 / level
        cards = mesh(name, radii, [0.0, height], kind, first=first)
        held = [f"{name}, 2, 2"]
    else:
        angles = [float(a) for a in np.linspace(0.0, pi / 2, 4 * level + 1)]
        cards = mesh(name, radii, angles, kind, first=first,
                     to=lambda r, a: (r * cos(a), r * sin(a)))
        held = [f"{name}.BOTTOM, 2, 2", f"{name}.TOP, 1, 1"]
    return [*cards, *material(name, **properties), "*BOUNDARY", *held]


def hot_cylinder(*kinds):
    """Return a maker of cylinders of some kinds, hot inside, under a pressure there."""
    def make(level):
        names = [f"TUBE{kind}" for kind in kinds]
        cards = [card for k, (name, kind) in enumerate(zip(names, kinds, strict=True))
                 for card in ring(name, kind, level, 10000 * k + 1, **METAL)]
        cards += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", *[f"{name}, {START}" for name in names]]
        cards += steady("*BOUNDARY", *[f"{name}.LEFT, 11, 11, {HOT}" for name in names],
                        *[f"{name}.RIGHT, 11, 11, {COLD}" for name in names], "*DSLOAD",
                        *[f"{name}.LEFT, P, {PRESSURE}" for name in names],
                        analysis="*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE")
        temperature = known.steady_ring(RADII, CONDUCTIVITY, HOT, COLD)
        points, middle, checks = np.linspace(*RADII, 4 * level + 1), sum(RADII) / 2, []
        for kind, node in zip(kinds, nodes_at(cards, names, middle), strict=True):
            at = known.Cylinder(RADII, "stress" if kind[:3] == "CPS" else "strain", YOUNG, POISSON,
                                 EXPANSION, ZERO, START).solve(temperature, PRESSURE)
            largest = max(abs(v) for r in RADII for v in at(r)[1:])
            checks.append(Check(f"T at r = {middle:g}, {kind}", "NT", node,
                                float(temperature(middle)), 2 * interpolation(
                                    lambda r: float(temperature(r)), points, kind), "ABS"))
            inner, outer = (nodes_at(cards, names, r)[kinds.index(kind)] for r in RADII)
            checks += [Check(f"u at r = {r:g}, {kind}", "U1", node, at(r)[0], 2 * interpolation(
                lambda r, at=at: at(r)[0], points, kind), "ABS")
                for r, node in zip(RADII, (inner, outer), strict=True)]
            hoop = "S33" if kind[:3] == "CAX" else "S22"
            checks += [Check(f"hoop stress at r = {r:g}, {kind}", hoop, node, at(r)[2],
                             0.05 * largest / level**2, "ABS")
                       for r, node in zip(RADII, (inner, outer), strict=True)]
        return cards, checks

    return make


FILM, SINK, TIMES = 0.003, 600.0, (100.0, 200.0)
WARMED = {"elastic": [(2e5, 0.3, 0.0), (1.6e5, 0.3, 200.0), (1e5, 0.34, 500.0)],
          "expansion": [(1e-5, 0.0), (1.2e-5, 150.0), (1.5e-5, 400.0)],
          "conductivity": [(0.05, 0.0), (0.03, 600.0)], "density": [(7.8e-6, 0.0), (7.5e-6, 600.0)],
          "specific_heat": [(450.0, 0.0), (700.0, 600.0)], "zero": ZERO}


def warmed_cylinder(level):
    """Return a cylinder that a film warms from inside; all of its properties are tables."""
    cards = ring("TUBE", "CAX8", level, **WARMED)
    capacity = known.product(WARMED["density"], WARMED["specific_heat"])
    r, found = known.extrapolated(RADII, tuple(WARMED["conductivity"]), capacity, START, FILM,
                                   SINK, TIMES)
    at = known.Cylinder(RADII, "strain", [(row[0], row[2]) for row in WARMED["elastic"]],
                         [row[1:] for row in WARMED["elastic"]], WARMED["expansion"], ZERO,
                         START).solve(lambda radius: np.interp(radius, r, found[-1]))
    inner, outer = (node_at(cards, x) for x in RADII)
    jump, stretch = SINK - START, 1.5e-5 * 1.34 * RADII[1]
    increment = TIMES[0] / 10 / level
    return [*cards, *start("TUBE", START), *heat(
        increment, TIMES[-1], "*SFILM", f"TUBE.LEFT, F, {SINK}, {FILM}",
        analysis="*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT")], [
        *(Check(f"T at r = {x:g}, t = {t:g}", "NT", node, float(row[i]),
                jump * allowed(TIMES[0] / 10 / t, level), "ABS", when=f"{t!r}")
          for t, row in zip(TIMES, found, strict=True)
          for x, node, i in ((RADII[0], inner, 0), (RADII[1], outer, -1))),
        Check(f"u at r = {RADII[1]:g}, t = {TIMES[-1]:g}", "U1", outer, at(RADII[1])[0],
              stretch * jump * allowed(TIMES[0] / 10 / TIMES[-1], level), "ABS")]


def cases():
    """Return the cases of the theme."""
    source = "tests/reference/tables.py"
    return [
        Case("Slab with k(T)",
             """k = 10 (1 + T/500), 0 and 500 on the faces of 0.1, in all kinds of elements side by
             side. 2 elements, and more.""",
             f"Kirchhoff's integral; {source}.",
             """1e-6 in rectangles, whose corners are exact where k is linear; in triangles twice
             the difference of the field from its interpolation. Heat errs with the square of
             gradients: the square of that part in two-node sides.""", FINENESS, slab, label,
             order={f"T in the middle, {kind}": 1.8 for kind in TRIANGLES}, short=2),
        Case("Bar with E(T)",
             """A bar of 10, one end at 0, where E = 200, the other at 100, where E = 80, under a
             tension of 0.5, in all kinds of elements of plane stress. 2 elements, and more.""",
             f"u = s L ln(E1/E2)/(E1 - E2); {source}.",
             "Twice the difference of the displacement from its interpolation.",
             FINENESS, pulled, label,
             order={f"u of the end, {kind}": 1.5 for kind in PULLED}, short=2),
        Case("Half-space with k(T) and c(T) under a flux",
             """k = rho c = 1 + T/2, at 0, under a flux of 1. Increments of a tenth of the time, and
             finer.""",
             f"Kirchhoff's integral is the heat content, too, and its equation linear; {source}.",
             "0.1 (dt/t)^2 of 1.", FINENESS, half_space_under_flux, label,
             order={f"T at x = 0, t = {t}": 1.5 for t in (0.1, 1.0)}),
        Case("Half-space with k(T) after a step",
             """k = 200 + T, rho c = 8e6, at 100, its face at 200 from t = 0 on. Increments of 0.2,
             and finer.""",
             f"""T(x/sqrt t) of an ordinary differential equation (Boltzmann), by shooting;
             {source}.""", "0.1 (dt/t)^2 of 100.", FINENESS, half_space_after_step, label),
        *(Case(f"Cylinder with k(T), E(T), nu(T) and alpha(T), {words}",
               f"""Radii {RADII[0]:g} and {RADII[1]:g}, {HOT:g} inside and {COLD:g} outside, a
               pressure of {PRESSURE:g} inside; from 0 to 600 k falls from 0.05 to 0.03, E from 2e5
               to 1.2e5, nu grows from 0.28 to 0.34, alpha from 1e-5 to 1.4e-5 (secants from
               ZERO={ZERO:g}); it starts at {START:g}. 4 elements over the wall, and more.""",
               f"""Kirchhoff's integral; equilibrium and Hooke's law as a boundary value problem
               over the radius, by collocation to 1e-9; {source}.""",
               """T and u twice their difference from their interpolation; stresses 5 % of the
               largest, falling with h^2.""", FINENESS, hot_cylinder(*kinds), label, short=1)
          for words, kinds in (("rings", ("CAX8", "CAX8R")), ("plane", ("CPE8", "CPS8")))),
        Case("Cylinder that a film warms, all properties tables",
             f"""Radii {RADII[0]:g} and {RADII[1]:g}, at {START:g}, a film of {FILM:g} to {SINK:g}
             inside, insulated outside. Tables of two rows, k, rho and c, and of three, E, nu, and
             alpha from ZERO={ZERO:g}. Increments of {TIMES[0] / 10:g}, and finer.""",
             f"""Control volumes over the radius, 100 and 200 extrapolated, by stiff integration in
             time, then the boundary value problem of the cylinder; {source}.""",
             "0.1 (dt/t)^2 of the jump, and of what it strains.", FINENESS, warmed_cylinder, label),
    ]


DRAWN = {"Bar with E(T)": "Bar",
         "Half-space with k(T) and c(T) under a flux": "Flux into half-space",
         "Half-space with k(T) after a step": "Step of half-space",
         "Cylinder that a film warms, all properties tables": "Warmed cylinder"}


def draw(runs, path):
    """Draw the errors of the cases in which every quantity has one."""
    figure, panels = subplots(2, 2, height=6.0)
    for axes, (title, name) in zip(panels.flat, DRAWN.items(), strict=True):
        errors_panel(axes, runs[title], name)
    save(figure, path)


def test_tables_against_closed_forms(tmp_path):
    import test_tables

    check_short(test_tables, tmp_path)
