"""Properties that follow the temperature: closed forms and one-dimensional solutions over meshes."""

from math import log

import numpy as np
from manual import Case, Check, check_short, errors_panel
from pictures import save, subplots
from physics import material, mesh, nodes_of
from test_transients import allowed, graded, heat, label, node_at, start

import tables

TITLE = "Properties over temperature"
TEXT = """Materials whose properties are tables over temperature.

Steady fields are allowed twice the largest difference between the exact temperature and its
interpolation by the elements, which falls with h^2 for elements without nodes between corners and
with h^3 for the others; other quantities state their own. Transients are allowed what those of the
section before are: 0.1 (dt/t)^2 of the jump."""
PICTURE = "tables"
CAPTION = "Errors of bodies with tables over meshes and increments"
KINDS = ("CPE8", "CPE8R", "CPE6", "CPE4", "CPE3")
FINENESS = [1, 2, 4]


def strips(points, kinds, place=lambda k, x, y: (x, y), **properties):
    """Return bars of one element across, one of each kind, beside each other, and of one material;
    and their names."""
    cards, names = [], []
    across = float(points[-1] - points[0]) / (len(points) - 1)
    for k, kind in enumerate(kinds):
        names.append(f"BAR{kind}")
        low = 2 * k * across
        cards += mesh(names[-1], [float(x) for x in points], [low, low + across], kind,
                      first=10000 * k + 1, to=lambda x, y, k=k: place(k, x, y))
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
    for low, high in zip(points[:-1], points[1:], strict=True):
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
        return tables.across(SLAB, x / 0.1, 0.0, 500.0)

    checks = [Check(f"T in the middle, {kind}", "NT", node, field(0.05),
                    2 * interpolation(field, points, kind), "ABS")
              for kind, node in zip(KINDS, nodes_at(cards, names, 0.05), strict=True)]
    area = sum(0.1 / (2 * level) for _ in KINDS)
    checks.append(Check("heat through all", "heat_in", "", area * 75000.0,
                        2 * interpolation(field, points, "CPE4") / 500.0))
    return [*cards, *steady("*BOUNDARY", *held)], checks


def pulled(level):
    """Return bars of all kinds whose modulus is linear along them, under a tension."""
    kinds = tuple(kind.replace("CPE", "CPS") for kind in KINDS)
    points = np.linspace(0.0, 10.0, 2 * level + 1)
    cards, names = strips(points, kinds, elastic=[(200.0, 0.0, 0.0), (80.0, 0.0, 100.0)],
                          conductivity=1.0)
    held = [line for name in names for line in (
        f"{name}.LEFT, 11, 11, 0.", f"{name}.RIGHT, 11, 11, 100.", f"{name}.LEFT, 1, 1",
        f"{name}.BOTTOM, 2, 2")]
    pulls = [f"{name}.RIGHT, P, -0.5" for name in names]

    def stretch(x):
        return 0.5 * x / 10 * 10 * (log(200.0 / (200.0 - 12 * x)) / (12 * x) if x else 1 / 200.0)

    return [*cards, *start(names[0]), *[f"{name}, 0." for name in names[1:]],
            *steady("*BOUNDARY", *held, "*DSLOAD", *pulls,
                    analysis="*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE")], [
        Check(f"u of the end, {kind}", "U1", node, tables.bar_stretch(0.5, 10.0, 200.0, 80.0),
              2 * interpolation(stretch, points, kind), "ABS")
        for kind, node in zip(kinds, nodes_at(cards, names, 10.0), strict=True)]


# Half-spaces

GROWING = [(1.0, 0.0), (3.0, 4.0)]   # 1 + T/2


def half_space_under_flux(level):
    """Return a half-space, k = rho c = 1 + T/2, under a flux of 1."""
    cards, names = strips(graded(12.0, 30 * level, 1.2 ** (1 / level)), ("CPE8",), elastic=None,
                          conductivity=GROWING, density=1.0, specific_heat=GROWING)
    step = (0.1 / 10 / level, 0.1), (0.9 / 9 / level, 0.9)
    return [*cards, *start(names[0]), *[card for dt, period in step for card in heat(
        dt, period, "*DSFLUX", f"{names[0]}.LEFT, S, 1.")]], [
        Check(f"T at x = 0, t = {t}", "NT", node_at(cards, 0.0),
              tables.flux_into_half_space(0.0, t), allowed(0.1, level), "ABS", when=f"{t!r}")
        for t in (0.1, 1.0)]


def half_space_after_step(level):
    """Return a half-space, k = 200 + T, rho c = 8e6, whose face takes 200 at once."""
    depth = graded(0.4, 20 * level, 1.1 ** (1 / level))
    place = depth[np.searchsorted(graded(0.4, 20, 1.1), 0.02) * level], depth[10 * level]
    cards, names = strips(depth, ("CPE8",), elastic=None,
                          conductivity=[(200.0, 0.0), (600.0, 400.0)], density=8000.0,
                          specific_heat=1000.0)
    exact = tables.step_of_half_space(1.0, 200.0, 8e6, 100.0, 200.0)
    return [*cards, *start(names[0], 100.0), *heat(
        0.2 / level, 10.0, "*BOUNDARY", f"{names[0]}.LEFT, 11, 11, 200.")], [
        Check(f"T at x = {x:.4f}, t = {t}", "NT", node_at(cards, x), exact(x, t),
              100 * allowed(0.2 / t, level), "ABS", when=f"{t!r}")
        for x in place for t in (2.0, 10.0)]


def cases():
    """Return the cases of the theme."""
    source = "tests/reference/tables.py"
    return [
        Case("Slab with k(T)",
             """k = 10 (1 + T/500), 0 and 500 on the faces of 0.1, in all kinds of elements side by
             side. 2 elements, and more.""",
             f"Kirchhoff's integral; {source}.",
             """Twice the difference of the field from its interpolation; heat the same part, of
             two-node sides.""", FINENESS, slab, label,
             order={f"T in the middle, {kind}": 1.8 for kind in KINDS}, short=2),
        Case("Bar with E(T)",
             """A bar of 10, one end at 0, where E = 200, the other at 100, where E = 80, under a
             tension of 0.5, in all kinds of elements of plane stress. 2 elements, and more.""",
             f"u = s L ln(E1/E2)/(E1 - E2); {source}.",
             "Twice the difference of the displacement from its interpolation.",
             FINENESS, pulled, label,
             order={f"u of the end, {kind.replace('CPE', 'CPS')}": 1.8 for kind in KINDS}, short=2),
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
    ]


def draw(runs, path):
    """Draw the errors of all cases."""
    figure, panels = subplots(-(-len(runs) // 2), 2, height=10.5)
    for axes, (title, solved) in zip(panels.flat, runs.items(), strict=True):
        errors_panel(axes, solved, title)
    save(figure, path)


def test_tables_against_closed_forms(tmp_path):
    import test_tables

    check_short(test_tables, tmp_path)
