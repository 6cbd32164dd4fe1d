"""Strains that take up heat: bodies loaded at once, columns that settle, the damping of a strip."""

from dataclasses import replace
from math import pi, sin, sqrt

import numpy as np
from manual import Case, Check, check_short, errors_panel
from pictures import save, subplots
from physics import material, mesh, nodes_of
from test_transients import FINENESS, allowed, heat, label, start

import transient
from thermoelastic import Solid

TITLE = "Heat of strains"
TEXT = """Steps with DILATATION=YES: sudden loads agree with closed forms to rounding, slow ones
converge with order 2 for any coupling delta = beta^2 T0/(M C_e) of heat and strains."""
DETAILS = """Steps with DILATATION=YES, with increments of one length and the default scheme, L-STABLE.
Temperatures are rises from T0, the temperature of the start. Steel has E = 2.1e5 N/mm2, nu = 0.3,
alpha = 1.2e-5/K, rho c_p = 3.588 mJ/(mm3 K), k = 50 mW/(mm K) and T0 = 293 K. The coupling of heat
and strains in a column that cannot widen is delta = beta^2 T0/(M C_e), 0.0117 in steel. No material
has 0.5 or 2; those that stand for it here have E = 1, nu = 0.3, k = 1, alpha = 1, T0 = 1, and the
heat capacity follows from delta."""
TOGETHER = ("A column that settles",)
PICTURE = "dilatation"
CAPTION = "Errors of columns and of a strip in bending, and the damping of the strip"
ANALYSIS = "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT, DILATATION=YES"
STEEL = Solid(2.1e5, 0.3, 1.2e-5, 50.0, 3.588, 293.0)   # N, mm, s, K
PRESSURE = 100.0


def made_up(coupling):
    """Return a material with a delta."""
    soft = Solid(1.0, 0.3, 1.0, 1.0, 1.0, 1.0)
    clamped = soft.beta**2 / soft.column_modulus / coupling
    return Solid(1.0, 0.3, 1.0, 1.0, clamped + 3 * soft.beta, 1.0)


# Material, pressure, height.
COLUMNS = {"steel": (STEEL, PRESSURE, 1000.0), "delta 0.5": (made_up(0.5), 0.1, 1.0),
           "delta 2": (made_up(2.0), 0.1, 1.0)}


def body(name, xs, ys, kind, solid, first=1, **more):
    """Return a body and its material."""
    return [*mesh(name, [float(x) for x in xs], [float(y) for y in ys], kind, first=first, **more),
            *material(name, (solid.young, solid.poisson), solid.expansion, solid.conductivity, 1.0,
                      solid.capacity)]


def absolute(solid, *names):
    """Return the cards of absolute zero, T0 below the temperature of the start, which is 0."""
    return [f"*PHYSICAL CONSTANTS, ABSOLUTE ZERO={-solid.temperature!r}", *start(names[0]),
            *(f"{name}, 0." for name in names[1:])]


def pulled_plate(kind):
    """Return a plate of steel that is pulled at once, and a check of its temperature."""
    sides = [0.0, 0.4, 1.0]
    cards = body("PLATE", sides, sides, kind, STEEL, skew=0.05)
    return [*cards, *absolute(STEEL, "PLATE"),
            *heat(0.5, 1.0, "*BOUNDARY", "PLATE.LEFT, 1", "PLATE.BOTTOM, 2",
                  "*DSLOAD", f"PLATE.RIGHT, P, {-PRESSURE!r}", analysis=ANALYSIS)], [
        Check("T", "NT", "PLATE", STEEL.pulled(PRESSURE), 1e-8)]


def column(name, level, times, *more):
    """Return a column under pressure that cannot widen."""
    solid, pressure, height = COLUMNS[name]
    cards = body("COLUMN", [0.0, height / 10], np.linspace(0.0, height, 10 * level + 1), "CPE8",
                 solid)
    return [*cards, *absolute(solid, "COLUMN"),
            *heat(*times, "*BOUNDARY", "COLUMN.LEFT, 1", "COLUMN.RIGHT, 1", "COLUMN.BOTTOM, 2",
                  *more, "*DSLOAD", f"COLUMN.TOP, P, {pressure!r}", analysis=ANALYSIS)]


def pressed_column(name):
    """Return a column that is pressed at once, insulated all around, and stays so."""
    solid, pressure, height = COLUMNS[name]
    last = -pressure * height / solid.column_modulus
    return column(name, 1, (0.01, 1.0)), [
        Check("T", "NT", "COLUMN", solid.pressed(pressure), 1e-8),
        Check("displacement", "U2", "COLUMN.TOP", last / (1 + solid.coupling), 1e-8)]


def held_block(name):
    """Return a block that cannot expand and is heated evenly: it warms as C_e lets it."""
    solid, source = COLUMNS[name][0], COLUMNS[name][1] / 1e3
    cards = body("BLOCK", [0.0, 1.0], [0.0, 1.0], "CPE8", solid)
    return [*cards, *absolute(solid, "BLOCK"),
            *heat(0.5, 1.0, "*BOUNDARY", "BLOCK, 1, 2", "*DFLUX", f"BLOCK, BF, {source!r}",
                  analysis=ANALYSIS)], [
        Check("T", "NT", "BLOCK", source / solid.clamped_capacity, 1e-8)]


def settling_column(name):
    """Return a maker of a column that is pressed at once and gives off its heat through the loaded
    face."""
    solid, pressure, height = COLUMNS[name]
    unit = height**2 / solid.diffusivity_of_column()
    last = -pressure * height / solid.column_modulus
    at_once = last / (1 + solid.coupling)
    warmer = solid.pressed(pressure)

    def make(level):
        cards = column(name, level, (0.02 * unit / level, unit), "*BOUNDARY", "COLUMN.TOP, 11")
        checks = [Check(f"displacement at {part}", "U2", "COLUMN.TOP",
                        at_once + transient.mean_of_shocked_wall(part) * (last - at_once),
                        allowed(0.02 / part, level) * abs(last - at_once), "ABS",
                        when=f"{part * unit!r}") for part in (0.1, 0.2, 0.5, 1.0)]
        return cards, [*checks, Check(
            "T of the other end at 0.5", "NT", "COLUMN.BOTTOM",
            warmer * (1 - transient.shocked_wall(1.0, 0.5)), allowed(0.02 / 0.5, level) * warmer,
            "ABS", when=f"{0.5 * unit!r}")]

    return make


# The strip: E alpha^2 T0/(rho c_p), about that of steel; cycles, and increments of the coarsest row
# in one of them.

RELAXATION, CYCLES, OFTEN = 0.0025, 20, 16
PARTS = [0.1, 0.3, 1.0, 3.0, 10.0]   # w tau


def conducting(part):
    """Return a material of unit properties whose conductivity makes w tau of a period of 1."""
    return Solid(1.0, 0.3, 1.0, 2 / pi / part, 1.0, RELAXATION)


def instants(level):
    """Return the ends of the stages of all increments."""
    increment = 1 / OFTEN / level
    ends = np.arange(CYCLES * OFTEN * level + OFTEN * level // 4 + 1) * increment
    return np.sort(np.concatenate([ends, ends[:-1] + (1 - sqrt(0.5)) * increment]))


def bent_strips(level):
    """Return strips whose bending moment follows a sine, each with a conductivity of its own.

    Both ends stay plane: one is held, at the other all nodes move along as the corner does, by 1 at
    the largest moment, and by -1/Q where there is none.
    """
    times = instants(level).tolist()
    rows = [f"{t!r}, {sin(2 * pi * t)!r}" for t in times]
    most = 0.03 * RELAXATION * (2 * pi / OFTEN / level) ** 2
    strips, held, loads, checks = [], [], [], []
    for k, part in enumerate(PARTS):
        name, solid = f"STRIP{k}", conducting(part)
        strip = body(name, [0.0, 1.0], np.linspace(-0.5, 0.5, 4 * level + 1), "CPS8", solid,
                     first=1 + 1000 * k)
        places = nodes_of(strip)
        corner = next(n for n, place in places.items() if place == (1.0, 0.5))
        foot = next(n for n, place in places.items() if place == (1.0, -0.5))
        centre = next(n for n, place in places.items() if place == (0.0, 0.0))
        strips += [*strip, "*EQUATION", *(line for n, (x, y) in places.items()
                                          if x == 1.0 and n != corner
                                          for line in plane(n, corner, y))]
        held += [f"{name}.LEFT, 1", f"{centre}, 2"]
        answer = 1 / solid.bent_modulus(2 * pi, 1.0)
        # A moment of 1/6 of the force, over I = 1/12 the curvature, and half of it the corner.
        loads.append(f"{corner}, 1, {float(1 / 3 / answer.real)!r}")
        checks += [Check(f"1/Q at w tau = {part:g}", "U1", str(foot),
                         -answer.imag / answer.real, most, "ABS", when=f"{float(CYCLES)!r}"),
                   Check(f"largest at w tau = {part:g}", "U1", str(corner), 1.0, most)]
    return [*strips, "*AMPLITUDE, NAME=SINE", *rows,
            *absolute(conducting(1.0), *(f"STRIP{k}" for k in range(len(PARTS)))),
            *heat(1 / OFTEN / level, times[-1], "*BOUNDARY", *held,
                  "*CLOAD, AMPLITUDE=SINE", *loads, analysis=ANALYSIS)], checks


def plane(node, corner, height):
    """Return an equation by which a node of an end moves along as the corner lets it."""
    if height == 0.0:
        return ["1", f"{node}, 1, 1."]
    return ["2", f"{node}, 1, 1., {corner}, 1, {-2 * height!r}"]


def cases():
    """Return the cases of the theme."""
    at_once = "1e-8, a hundred times the part to which the heat of strains is iterated."
    forms = "Closed forms of tests/reference/thermoelastic.py"
    found = [
        Case("A plate that is pulled",
             """Plane stress, steel under 100 MPa at once. Temperatures are the same everywhere, so
             that nothing depends on mesh and increments; elements inside are distorted.""",
             """W. Thomson (Lord Kelvin), Trans. R. Soc. Edinburgh 20 (1853) 261:
             -alpha T0 sigma/(rho c_p), -0.0979933 K.""", at_once,
             ["CPS8", "CPS8R", "CPS4", "CPS6", "CPS3"], pulled_plate, named="element", short=5),
        Case("A column that is pressed",
             """A column that cannot widen, insulated, under a pressure at once: 100 MPa on 1000 mm
             of steel, 0.1 on the others, which are 1 high. T is the same everywhere.""",
             f"""{forms}: T0 beta p/(M C_e (1 + delta)), 0.183281 K for steel, and
             1/(1 + delta) of the displacement without heat.""", at_once, list(COLUMNS),
             pressed_column, named="material", short=3),
        Case("A block that cannot expand",
             """Plane strain, all displacements held, insulated, heated by a source: 0.1 mW/mm3 in
             steel, 1e-4 in the others, for a time of 1.""",
             "The source over C_e = rho c_p - 3 T0 alpha beta.", at_once, list(COLUMNS), held_block,
             named="material", short=3)]
    found += [
        Case(f"A column that settles, {name}",
             """The same column, at T0 at its loaded face: it gives off the heat of its compression
             and settles. 10 elements, increments of 0.02 of C_e (1 + delta) H^2/k, and finer. The
             times are parts of that.""",
             """M. A. Biot, J. Appl. Phys. 27 (1956) 240: T and displacement are those of Terzaghi's
             consolidation. The degrees at 0.1, 0.2, 0.5 and 1 are 0.356823, 0.504088, 0.763950 and
             0.931260.""",
             """0.1 (dt/t)^2 of the way between the first and the last displacement, or of the first
             rise: see [Transients](#transients).""",
             FINENESS, settling_column(name), label) for name in COLUMNS]
    found.append(Case(
        "A strip in bending",
        f"""Plane stress, thickness 1, E = alpha = rho c_p = 1 and T0 = {RELAXATION}, so that
        E alpha^2 T0/(rho c_p) is about that of steel. The bending moment follows a sine of period
        1, the faces are insulated. Five strips differ in conductivity, for w tau from 0.1 to 10,
        tau = rho c_p b^2/(pi^2 k). The corner of the end moves by 1 at the largest moment, and by
        the loss 1/Q where there is none, after {CYCLES} cycles. 4 elements across and {OFTEN}
        increments in a cycle, and finer.""",
        """The strip has a complex modulus in closed form (tests/reference/thermoelastic.py);
        its parts have the ratio 1/Q. Zener's formula E alpha^2 T0/(rho c_p) w tau/(1 + (w tau)^2) is
        its first mode with all of the weight, which is 96/pi^4, 98.6 %: it is 1.3 % larger
        at w tau = 0.1 and 5 % smaller at 10.""",
        """0.03 (w dt)^2 E alpha^2 T0/(rho c_p). A mode whose heat follows a sine has errors of at
        most 0.027 (w dt)^2 in both parts: those of the scheme in r y' + y = sin(w t) for all r.""",
        FINENESS, bent_strips, label))
    for case in found[3:]:
        case.order = {check.name: 1.5 for check in case.make(1)[1]
                      if not check.name.startswith("largest")}
    return found


def of_loss(solved):
    """Return a run of strips with its checks of 1/Q."""
    return replace(solved, checks=solved.checks[::2], verdicts=solved.verdicts[::2])


def draw(runs, path):
    """Draw the errors of two columns and of the strips, and their damping."""
    figure, panels = subplots(2, 2, height=5.6)
    for axes, name in zip(panels[0], ("steel", "delta 2"), strict=True):
        title = f"A column that settles, {name}"
        errors_panel(axes, runs[title], title, "fineness of mesh and increments")
    solved = [of_loss(run) for run in runs["A strip in bending"]]
    left, right = panels[1]
    errors_panel(left, solved, "A strip in bending", "fineness of mesh and increments")
    parts = np.geomspace(0.03, 30, 200)
    exact = [conducting(part).bent_modulus(2 * pi, 1.0) for part in parts]
    right.loglog(parts, [modulus.imag / modulus.real for modulus in exact], label="closed form")
    right.loglog(parts, RELAXATION * parts / (1 + parts**2), "--", label="Zener's formula")
    right.loglog(PARTS, [v.value for v in solved[-1].verdicts], "o", label="finest row")
    right.set_xlabel("w tau")
    right.set_ylabel("1/Q")
    right.set_title("Damping of the strip")
    right.legend()
    save(figure, path)


def test_heat_of_strains_against_closed_forms(tmp_path):
    import test_dilatation

    check_short(test_dilatation, tmp_path)
