"""Heat of friction: half-spaces that rub, sliding blocks, instability of sliding, a ring."""

from math import cos, e, exp, pi, sqrt

import numpy as np
from manual import Case, Check, check_short, errors_panel
from pictures import save, subplots
from physics import material, mesh, nodes_of
from test_transients import bar, graded, node_at, start

from frictional_heat import BarMode, burton, half_spaces

TITLE = "Heat of friction"
TEXT = """Heat is the work of friction to rounding; rates at which motions grow are met to 1 %."""
DETAILS = """Faces that rub. Increments have one length and the default scheme, L-STABLE; every row
halves the elements and the increments of the row before."""
PICTURE = "frictional_heat"
CAPTION = "Errors of the heat of friction over meshes and increments"
FINENESS = [1, 2, 4]


def label(level):
    """Return how fine a row is."""
    return f"{level} x"


def rubbing(friction, heat, slave, master, *laws, name="FACE"):
    """Return the cards of an interface that friction heats."""
    return [f"*SURFACE INTERACTION, NAME={name}", "*FRICTION", f"{friction!r}",
            f"*GAP HEAT GENERATION{heat[3] if len(heat) > 3 else ''}",
            ", ".join(repr(value) for value in heat[:3] if value is not None), *laws,
            f"*CONTACT PAIR, INTERACTION={name}, NAME={name}", f"{slave}, {master}"]


def coupled(increment, period, *cards):
    """Return a coupled transient step with fixed increments."""
    return ["*STEP, INC=100000", "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT",
            f"{increment!r}, {period!r}", *cards, "*END STEP"]


def half_spaces_that_rub(share, conductance):
    """Return how to make the decks of two half-spaces, mu p v = 1e5, at which a share of the heat
    enters the first."""

    def make(level):
        depth = graded(1.0, 20 * level, 1.2 ** (1 / level))
        first = bar("ONE", -depth[::-1], 40.0, 3.6e6, elastic=(1e9, 0.0))
        second = bar("TWO", depth, 160.0, 2.4e6, first=10001, elastic=(1e9, 0.0))
        effusivities = sqrt(40.0 * 3.6e6), sqrt(160.0 * 2.4e6)
        laws = ["*GAP CONDUCTANCE, PRESSURE", f"{conductance!r}, 0.", f"{conductance!r}, 1e9"]
        steps, times, before = [], (1.0, 10.0, 100.0), 0.0
        for time in times:
            count = round((time - before) / time * 10) * level
            steps += coupled((time - before) / count, time - before)
            before = time
        held = ["*BOUNDARY", "TWO, 1, 2, 0.", "ONE.BOTTOM, 2, 2, 0."]
        return [*first, *second, *start("ONE"), *start("TWO")[1:],
                *rubbing(0.2, (1.0, share, 5.0), "ONE.RIGHT", "TWO.LEFT", *laws), *held,
                "*STEP", "*STATIC", "1., 1.", "*DSLOAD", "ONE.LEFT, P, 1e5", "*END STEP", *steps], [
            Check(f"T of the {which} face, t = {t}", "NT",
                  node_at(cards, 0.0), half_spaces(1e5, share, conductance, effusivities, t)[i],
                  0.1 * (0.1 / level) ** 2 * 2e5 * sqrt(t / pi) / effusivities[i], "ABS",
                  when=f"{t + 1!r}")
            for t in times for i, (which, cards) in enumerate((("first", first),
                                                               ("second", second)))]
    return make


SLIDE, PERIOD = 3.75, 0.375   # of the blocks


def sliding_blocks(level):
    """Return the blocks after Wriggers and Miehe, pressed, slid at a constant speed, and left until
    their temperature is uniform."""
    sides = np.linspace(0.0, 5.0, 4 * level + 1)
    lower = mesh("LOWER", sides, np.linspace(0.0, 1.25, level + 1))
    upper = mesh("UPPER", sides, np.linspace(1.25, 2.5, level + 1), first=10001)
    thermal = {"conductivity": 150.0, "density": 2.7e-9, "specific_heat": 9e8}
    laws = ["*GAP CONDUCTANCE, PRESSURE", "1e3, 0.", "1e3, 100."]
    count = 10 * level
    speed = SLIDE / PERIOD
    return [*lower, *upper, *material("LOWER", (70000.0, 0.3), **thermal),
            *material("UPPER", (70000.0, 0.3), **thermal), *start("LOWER"), *start("UPPER")[1:],
            *rubbing(0.2, (1.0, 0.5), "UPPER.BOTTOM", "LOWER.TOP", *laws),
            "*AMPLITUDE, NAME=SLIDE", f"0., 0., {PERIOD}, 1., {2 * PERIOD}, 1.",
            "*BOUNDARY", "LOWER.BOTTOM, 1, 2, 0.", "UPPER.TOP, 1, 1, 0.",
            "*STEP", "*STATIC", "1., 1.", "*DSLOAD", "UPPER.TOP, P, 10.", "*END STEP",
            *coupled(PERIOD / count, PERIOD, "*BOUNDARY, AMPLITUDE=SLIDE",
                     f"UPPER.TOP, 1, 1, {SLIDE}"),
            *coupled(PERIOD / count, PERIOD)], [
        Check("heat of friction while the blocks slide", "heat_friction", "",
              0.2 * 10.0 * 5.0 * speed, 1e-9, when=f"{1 + PERIOD!r}"),
        Check("friction force", "shear_force", "FACE", -0.2 * 10.0 * 5.0, 1e-9,
              when=f"{1 + PERIOD!r}"),
        *(Check(f"T of the {block} block in the end", "NT", f"{block.upper()}.BOTTOM",
                0.2 * 10.0 * SLIDE / 2.43 / 2.5, 1e-3) for block in ("lower", "upper"))]


SPEEDS = 1.0, 1.5, 2.5, 3.0, 4.0


def bars_on_a_wall(level):
    """Return bars of length 1 that slide out of the plane with several speeds, each at rest in
    time but for a unit of its slowest mode, with capacities by which all rates are 1 or -1."""
    cards, initial, step, checks = [], [], [], []
    n = 8 * level
    for k, number in enumerate(SPEEDS):
        mode, name, wall = BarMode(number), f"BAR{k}", f"WALL{k}"
        y = 2.0 * k
        sides = [y, y + 1.0 / n]
        cards += [*mesh(name, np.linspace(0.0, 1.0, n + 1), sides, "CPS8", first=10000 * k + 1),
                  *material(name, (1000.0, 0.0), expansion=(1e-3, 0.0, 0.0), conductivity=1.0,
                            density=1.0, specific_heat=abs(mode.rate), expansion_type="ORTHO"),
                  *mesh(wall, [-1.0 / n, 0.0], sides, "CPS8", first=10000 * k + 5001),
                  *material(wall, (1000.0, 0.0), conductivity=1.0),
                  # mu V = S k/(E alpha L)
                  *rubbing(0.5, (1.0, 1.0, 2 * number), f"{name}.LEFT", f"{wall}.RIGHT",
                           name=f"FACE{k}")]
        # Under a pressure of 1 the temperature falls from S to 0. Bodies expand from their start.
        initial += [f"{node}, {number * (1 - x) + mode.at(x)!r}" for node, (x, _) in
                    nodes_of(cards[-len(cards):]).items()
                    if 10000 * k < node <= 10000 * k + 5000]
        step += [f"{wall}, 1, 2, 0.", f"{wall}, 11, 11, 0.", f"{name}.BOTTOM, 2, 2, 0.",
                 f"{name}.RIGHT, 1, 1, {-(1 + mode.mean) / 1000!r}", f"{name}.RIGHT, 11, 11, 0."]
        after = exp(np.sign(mode.rate))
        checks.append(Check(f"T of the face, S = {number}, rate {mode.rate:.7g}", "NT",
                            f"{name}.LEFT", number + after, 0.01 * after, "ABS"))
    return [*cards, *start("WALL0"), *(f"WALL{k}, 0." for k in range(1, len(SPEEDS))), *initial,
            *coupled(1.0 / (16 * level), 1.0, "*BOUNDARY", *step)], checks


RATIOS = 0.5, 2.0, 4.0


def burtons_half_planes(level):
    """Return half-planes that slide out of the plane with several speeds, each with a disturbance
    of its temperature, with capacities by which all rates are 1 or -1."""
    cards, field, held, load, checks = [], [], [], [], []
    xs, ys = np.linspace(0.0, pi, 12 * level + 1), graded(14.0, 20 * level, 1.25 ** (0.5 / level))
    for k, ratio in enumerate(RATIOS):
        rate, depth = burton(ratio)
        name, wall, left, amplitude = f"HALF{k}", f"WALL{k}", 10.0 * k, 0.05
        half = mesh(name, xs + left, ys, first=200000 * k + 1)
        # Vcr = 2 m k (1 - nu)/(mu alpha E)
        heating = ratio * 2 * 0.7 / (1e-3 * 1000.0)
        cards += [*half, *material(name, (1000.0, 0.3), expansion=1e-3, conductivity=1.0,
                                   density=1.0, specific_heat=abs(rate)),
                  *mesh(wall, xs + left, [-0.2, 0.0], first=200000 * k + 100001),
                  *material(wall, (1000.0, 0.3), conductivity=1.0),
                  *rubbing(0.5, (1.0, 1.0, heating / 0.5), f"{name}.BOTTOM", f"{wall}.TOP",
                           name=f"FACE{k}")]
        field += [f"{node}, {amplitude * cos(x - left) * exp(-depth * y)!r}"
                  for node, (x, y) in nodes_of(half).items()]
        held += [f"{wall}, 1, 2, 0.", f"{wall}, 11, 11, 0.", f"{name}.LEFT, 1, 1, 0.",
                 f"{name}.RIGHT, 1, 1, 0."]
        load += [f"{name}.TOP, P, 1."]
        after = depth * amplitude / heating * exp(np.sign(rate))
        checks.append(Check(f"pressure at the crest, V/Vcr = {ratio}, rate {rate:.7g}", "pressure",
                            f"FACE{k}@0.", 1 + after, 0.01 * after, "ABS"))
    initial = [f"{name}{k}, 0." for k in range(len(RATIOS)) for name in ("HALF", "WALL")]
    return [*cards, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", *initial, "*BOUNDARY", *held,
            "*STEP", "*STATIC", "1., 1.", "*TEMPERATURE", *field, "*DSLOAD", *load, "*END STEP",
            *coupled(1.0 / (16 * level), 1.0)], checks


def turning_ring(level):
    """Return a ring that turns on another with the angular velocity 3, and cools on its back."""
    radii = np.linspace(1.0, 2.0, 2 * level + 1)
    lower = mesh("LOWER", radii, [0.0, 0.25], "CAX8")
    upper = mesh("UPPER", radii, [0.25, 0.5], "CAX8", first=10001)
    heat = 0.9 * 0.3 * 3.0 * 10.0 * 2 * pi * (2**3 - 1) / 3
    step = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
            "LOWER.BOTTOM, 2, 2, 0.", "LOWER.BOTTOM, 11, 11, 0.", "*DSLOAD", "UPPER.TOP, P, 10.",
            "*END STEP"]
    laws = ["*GAP CONDUCTANCE, PRESSURE", "1e3, 0.", "1e3, 100."]
    return [*lower, *upper, *material("LOWER", (1e5, 0.0), conductivity=5.0),
            *material("UPPER", (1e5, 0.0), conductivity=5.0),
            *rubbing(0.3, (0.9, 0.5, None, ", ANGULAR VELOCITY=3."), "UPPER.BOTTOM", "LOWER.TOP",
                     *laws), *step], [
        Check("heat of friction", "heat_friction", "", heat, 1e-9),
        Check("heat out", "heat_out", "", heat, 1e-9),
        Check("heat across the interface", "heat_rate", "FACE", heat / 2, 1e-9)]


def cases():
    """Return the cases of the theme."""
    source = "Closed form, `tests/reference/frictional_heat.py`."
    series = {"meshes": FINENESS, "label": label, "source": source}
    spaces = """k = 40 and 160, rho c = 3.6e6 and 2.4e6, mu p v = 1e5 W/m2 from t = 0 on. 20 graded
        elements each and a step to each of the times, with increments of a tenth of it, and
        finer."""
    limit = """0.1 (dt/t)^2, as of other transients, of the rise that all of the heat would make in
        the face alone."""
    return [
        Case("Half-spaces that rub in perfect contact", f"""{spaces} f = 0.9, and a conductance of
             1e9: f has no effect.""", make=half_spaces_that_rub(0.9, 1e9), tolerance=limit,
             **series),
        Case("Half-spaces that rub over a finite conductance", f"""{spaces} f = 0.2, and a
             conductance of 2000.""", make=half_spaces_that_rub(0.2, 2000.0), tolerance=limit,
             **series),
        Case("Sliding blocks", """After Wriggers and Miehe (1994): two blocks of 5 x 1.25,
             E = 70000, nu = 0.3, k = 150, rho c = 2.43, mu = 0.2, under a pressure of 10; the upper
             one slides by 3.75 in 0.375, and heat spreads for as long. 4 elements by 1 each and
             increments of 0.0375, and finer.""", make=sliding_blocks, **{**series, "source": """Work of friction:
             the rise is mu p s/(rho c h), h = 2.5 the height of both."""},
             tolerance="""Heat and force while the blocks slide 1e-9; temperatures 0.1 %: the
             blocks take up 0.008 % of the slide as they deform."""),
        Case("Bars on a sliding wall", """Bars, E alpha = k = L = 1, pressed to an insulating wall
             that slides out of the plane, at 0 at the other end, S = mu V E alpha L/k; rho c by
             which the rate of the slowest mode is 1 or -1. They start with a unit of this mode
             beside their steady state, at S in the face, which is stable below S = 2. 8 elements
             and increments of 1/16, and finer.""", make=bars_on_a_wall, **series,
             tolerance=f"1 % of the rate: 0.01 {e:.3g}^(+-1) after a time of 1."),
        Case("Burton's half-planes", """Half-planes in plane strain, E alpha = k = 1, nu = 0.3, on a
             rigid insulator that slides out of the plane, with the disturbance cos x exp(-z y) of
             the temperature; rho c by which its rate is 1 or -1. Half a wave of 12 elements, 20
             graded elements to a depth of 14, and increments of 1/16, and finer.""",
             make=burtons_half_planes, **{**series, "meshes": FINENESS[:2]},
             tolerance="1 % of the rate, as of the bars."),
        Case("Ring that turns on another", """Two rings of 1 to 2, mu = 0.3, under a pressure of 10,
             turning with the angular velocity 3, eta = 0.9, f = 0.5, cooled at the back of one. 2
             elements, and finer.""", make=turning_ring, **{**series, "source": """Moment of
             friction times angular velocity, 2 pi mu p w (b^3 - a^3)/3. Half of the heat
             crosses."""},
             tolerance="Rounding: the radius is linear in the elements.")]


def draw(runs, path):
    """Draw the errors of the cases with an order."""
    figure, panels = subplots(2, 2, height=5.3)
    kept = {title: solved for title, solved in runs.items() if title[:5] not in ("Slidi", "Ring ")}
    for axes, (title, solved) in zip(panels.flat, kept.items(), strict=True):
        errors_panel(axes, solved, title, "fineness of mesh and increments")
    save(figure, path)


def test_frictional_heat_against_closed_forms(tmp_path):
    import test_frictional_heat

    check_short(test_frictional_heat, tmp_path)
