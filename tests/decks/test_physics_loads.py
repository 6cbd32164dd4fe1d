"""Loads and supports of every kind on bodies whose answer is known in closed form.

Each load is tested twice: its value (two decks, each passes its own checks and fails the other's)
and its course (amplitudes). What a later step does to it stands in test_values_steps.py.
"""

import numpy as np
import pytest
from blocks import write
from deck_runs import run
from physics import follows, judge, material, mesh, nodes_of, side_shares

import conduction
import lame
import plates
import rotating

YOUNG, POISSON, WIDTH, HEIGHT = 1000.0, 0.3, 2.0, 3.0
XS, YS = [0.0, 0.7, WIDTH], [0.0, 1.1, HEIGHT]
BLOCK = mesh("BODY", XS, YS)
ISOTROPIC = plates.isotropic(YOUNG, POISSON)
ROLLERS = ["*BOUNDARY", "BODY.LEFT, 1", "BODY.BOTTOM, 2"]
SMALL = 1e-11


def stressed(load):
    """Return the checks of uniform stresses (xx, yy, xy): stresses, displacements of the corners.

    Rollers on x = 0 and y = 0.
    """
    strain = plates.strain(ISOTROPIC, load, "strain")
    rows = [(f"S{name}", "BODY", "LAST", value, 1e-9, "ABS")
            for name, value in zip(("11", "22", "12"), load, strict=True)]
    return [*rows, ("U1", "BODY.RIGHT", "LAST", strain[0] * WIDTH, SMALL, "ABS"),
            ("U2", "BODY.TOP", "LAST", strain[1] * HEIGHT, SMALL, "ABS")]


def static(*cards, first="*STEP", times="1., 1."):
    """Return a step of mechanics."""
    return [first, "*STATIC", times, *cards, "*END STEP"]


def block(*cards, density=None):
    """Return a model of the block."""
    return [*BLOCK, *material("BODY", (YOUNG, POISSON), density=density), *ROLLERS, *cards]


def top_forces(total, degree=2):
    """Return *CLOAD data of a uniform traction on top with this resultant per width."""
    return [f"{n}, {degree}, {share * total!r}"
            for n, share in side_shares(BLOCK, 1, HEIGHT).items()]


@pytest.mark.changes("CLOAD")
def test_forces_on_nodes(tmp_path):
    follows(tmp_path, lambda p: (block(*static("*CLOAD", *top_forces(-p))),
                                 stressed([0.0, -p, 0.0])), 5.0, 5.5)


def test_forces_on_one_node_add_up(tmp_path):
    judge(tmp_path, block(*static("*CLOAD", *top_forces(-3.0), *top_forces(-2.0))),
          stressed([0.0, -5.0, 0.0]))


@pytest.mark.parametrize(("face", "held", "stress"), [
    (1, "BODY.TOP, 2", (0, 1)), (2, "BODY.LEFT, 1", (1, 0)), (3, "BODY.BOTTOM, 2", (0, 1)),
    (4, "BODY.RIGHT, 1", (1, 0))])
@pytest.mark.parametrize("kind", ["CPE3", "CPE4", "CPE4I", "CPE6", "CPE8", "CPE8R"])
@pytest.mark.changes("DLOAD")
def test_pressure_on_a_face_of_an_element(tmp_path, kind, face, held, stress):
    """One rectangle; triangles have the faces of their own, found by the surface."""
    cards = mesh("BODY", [0.0, WIDTH], [0.0, HEIGHT], kind)
    side = ("BOTTOM", "RIGHT", "TOP", "LEFT")[face - 1]
    at = cards.index(f"*SURFACE, NAME=BODY.{side}") + 1
    element, own_face = cards[at].split(", S")
    across = "1" if face in (1, 3) else "2"
    corner = 1 if face != 1 else next(n for n, p in nodes_of(cards).items() if p == (0.0, HEIGHT))
    if face == 4:
        corner = next(n for n, p in nodes_of(cards).items() if p == (WIDTH, 0.0))

    def make(p):
        deck = [*cards, *material("BODY", (YOUNG, POISSON)),
                *static("*BOUNDARY", held, f"{corner}, {across}", "*DLOAD",
                        f"{element}, P{own_face}, {p!r}")]
        return deck, [("S11", "BODY", "LAST", -p * stress[0], 1e-9, "ABS"),
                      ("S22", "BODY", "LAST", -p * stress[1], 1e-9, "ABS"),
                      ("S12", "BODY", "LAST", 0.0, 1e-9, "ABS")]

    follows(tmp_path, make, 4.0, -3.0)


@pytest.mark.changes("DSLOAD")
def test_pressure_on_a_surface(tmp_path):
    follows(tmp_path, lambda p: (block(*static("*DSLOAD", f"BODY.TOP, P, {p!r}")),
                                 stressed([0.0, -p, 0.0])), 5.0, -4.0)


def test_pressures_on_two_surfaces(tmp_path):
    judge(tmp_path, block(*static("*DSLOAD", "BODY.TOP, P, 5.", "BODY.RIGHT, P, 2.")),
          stressed([-2.0, -5.0, 0.0]))


@pytest.mark.parametrize("direction", [(0.0, 1.0), (0.0, -2.0)])
@pytest.mark.changes("DSLOAD")
def test_traction_across_a_surface(tmp_path, direction):
    """The vector is a direction: its length does not count."""
    sign = np.sign(direction[1])
    follows(tmp_path, lambda t: (
        block(*static("*DSLOAD", f"BODY.TOP, TRVEC, {t!r}, {direction[0]}, {direction[1]}, 0.")),
        stressed([0.0, sign * t, 0.0])), 5.0, 6.0)


@pytest.mark.changes("DSLOAD")
def test_tractions_along_surfaces_shear_the_block(tmp_path):
    """Bottom held: u_x = gamma y."""
    def make(shear):
        cards = [*BLOCK, *material("BODY", (YOUNG, POISSON)), *static(
            "*BOUNDARY", "BODY.BOTTOM, 1, 2", "*DSLOAD", f"BODY.TOP, TRVEC, {shear!r}, 1., 0., 0.",
            f"BODY.RIGHT, TRVEC, {shear!r}, 0., 1., 0.",
            f"BODY.LEFT, TRVEC, {shear!r}, 0., -1., 0.")]
        moved = shear / (YOUNG / 2 / (1 + POISSON)) * HEIGHT
        return cards, [("S12", "BODY", "LAST", shear, 1e-9), ("S22", "BODY", "LAST", 0.0, 1e-9,
                       "ABS"), ("U1", "BODY.TOP", "LAST", moved, 1e-10)]

    follows(tmp_path, make, 3.0, -2.0)


HELD_ASIDE = ["*BOUNDARY", "BODY, 1", "BODY.BOTTOM, 2"]


def heavy(weight, *cards, density=None):
    """Return a column held aside, and its checks under a weight per volume towards -y."""
    deck = [*BLOCK, *material("BODY", (YOUNG, POISSON), density=density), *HELD_ASIDE,
            *static(*cards)]
    modulus = rotating.oedometer(YOUNG, POISSON)
    rows = []
    for n, (_, y) in nodes_of(BLOCK).items():
        stress, moved = rotating.column(y, HEIGHT, weight, modulus)
        rows += [("S22", n, "LAST", stress, 1e-9, "ABS"), ("U2", n, "LAST", moved, 1e-13, "ABS")]
    return deck, rows


@pytest.mark.changes("DLOAD")
def test_body_force_along_y(tmp_path):
    follows(tmp_path, lambda f: heavy(-f, "*DLOAD", f"BODY, BY, {f!r}"), -2.0, 1.5)


@pytest.mark.parametrize(("density", "other"), [
    pytest.param((3.0, 9.81), (3.3, 9.81), marks=pytest.mark.changes("DENSITY")),
    pytest.param((3.0, 9.81), (3.0, 9.0), marks=pytest.mark.changes("DLOAD"))])
def test_gravity_acts_by_density(tmp_path, density, other):
    """The direction is a direction: its length does not count."""
    follows(tmp_path, lambda values: heavy(values[0] * values[1], "*DLOAD",
            f"BODY, GRAV, {values[1]!r}, 0., -1., 0.", density=values[0]), density, other)


@pytest.mark.changes("DLOAD")
def test_body_force_along_x(tmp_path):
    """The column lies along x."""
    modulus = rotating.oedometer(YOUNG, POISSON)

    def make(f):
        deck = [*BLOCK, *material("BODY", (YOUNG, POISSON)), "*BOUNDARY", "BODY, 2", "BODY.LEFT, 1",
                *static("*DLOAD", f"BODY, BX, {f!r}")]
        rows = []
        for n, (x, _) in nodes_of(BLOCK).items():
            stress, moved = rotating.column(x, WIDTH, -f, modulus)
            rows += [("S11", n, "LAST", stress, 1e-9, "ABS"),
                     ("U1", n, "LAST", moved, 1e-13, "ABS")]
        return deck, rows

    follows(tmp_path, make, 2.0, -3.0)


INNER, OUTER, DENSITY = 1.0, 2.0, 0.7


@pytest.mark.parametrize(("plane", "inner"), [("stress", INNER), ("strain", INNER),
                                               ("strain", 0.0)])
@pytest.mark.changes("DLOAD")
def test_centrifugal_force(tmp_path, plane, inner):
    """Of a long cylinder between smooth ends, of one with a bore, and of a thin disc."""
    radii = list(np.linspace(inner, OUTER, 17))
    cards = mesh("BODY", radii, [0.0, 0.02, 0.04], "CAX8")

    def make(speed):
        held = ["BODY.BOTTOM, 2"] + (["BODY.TOP, 2"] if plane == "strain" else [])
        held += ["BODY.LEFT, 1"] if inner == 0.0 else []
        deck = [*cards, *material("BODY", (YOUNG, POISSON), density=DENSITY), *static(
            "*BOUNDARY", *held, "*DLOAD",
            f"BODY, CENTRIF, {speed**2!r}, 0., 0., 0., 0., 1., 0.")]
        rows = []
        for r, where in ((OUTER, "BODY.RIGHT"), (inner, "BODY.LEFT")):
            radial, hoop, axial, moved = rotating.disc(r, inner, OUTER, DENSITY, speed, YOUNG,
                                                       POISSON, plane)
            # The thin disc is in plane stress but for (height/radius)^2.
            rows += [("U1", where, "LAST", moved, 1e-3 if r else 1e-14, "REL" if r else "ABS"),
                     ("S33", where, "LAST", hoop, 1e-2)]
            if plane == "strain":
                rows += [("S22", where, "LAST", axial, 3e-2)]
        return deck, rows

    follows(tmp_path, make, 3.0, 3.2)


@pytest.mark.changes("BOUNDARY")
def test_prescribed_displacement(tmp_path):
    def make(down):
        strain = -down / HEIGHT
        load = plates.stress(ISOTROPIC, np.array([-POISSON / (1 - POISSON) * strain, strain, 0.0]),
                             "strain")
        return block(*static("*BOUNDARY", f"BODY.TOP, 2, 2, {-down!r}")), stressed(load[[0, 1, 3]])

    follows(tmp_path, make, 0.003, 0.0025)


def test_prescribed_displacement_before_the_first_step_ramps_in_it(tmp_path):
    deck = block(f"BODY.TOP, 2, 2, {-0.003!r}", *static(times="0.5, 1."))
    judge(tmp_path, deck, [("U2", "BODY.TOP", 0.5, -0.0015, 1e-12),
                           ("U2", "BODY.TOP", 1.0, -0.003, 1e-12)])


# Heat. A bar along x, one material; its sides y are insulated.

K, LENGTH = 2.5, 2.0


def heat(*cards, times="1., 1.", first="*STEP"):
    """Return a step of heat conduction."""
    return [first, "*HEAT TRANSFER, STEADY STATE", times, *cards, "*END STEP"]


def bar(*cards, kind="CPE8"):
    """Return a bar that conducts."""
    return [*mesh("BODY", XS, [0.0, 0.5], kind), *material("BODY", (YOUNG, POISSON),
            conductivity=K), "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20.", *cards]


def temperatures(function, when="LAST", tolerance=1e-10):
    """Return the checks of a temperature along x."""
    return [("NT", n, when, function(x), tolerance)
            for n, (x, _) in nodes_of(mesh("BODY", XS, [0.0, 0.5])).items()]


@pytest.mark.changes("BOUNDARY")
def test_prescribed_temperatures(tmp_path):
    follows(tmp_path, lambda hot: (
        bar(*heat("*BOUNDARY", "BODY.LEFT, 11, 11, 20.", f"BODY.RIGHT, 11, 11, {hot!r}")),
        [*temperatures(lambda x: 20.0 + (hot - 20.0) * x / LENGTH),
         ("HFL1", "BODY", "LAST", -K * (hot - 20.0) / LENGTH, 1e-10)]), 90.0, 70.0)


@pytest.mark.changes("CFLUX")
def test_heat_into_nodes(tmp_path):
    shares = side_shares(mesh("BODY", XS, [0.0, 0.5]), 0, LENGTH)

    def make(flux):
        rows = [f"{n}, 11, {share * flux!r}" for n, share in shares.items()]
        return bar(*heat("*BOUNDARY", "BODY.LEFT, 11, 11, 20.", "*CFLUX", *rows)), [
            *temperatures(lambda x: 20.0 + flux * x / K),
            ("heat_in", "", "LAST", 0.5 * flux, 1e-10)]

    follows(tmp_path, make, 30.0, 25.0)


@pytest.mark.parametrize("face", [1, 2, 3, 4])
@pytest.mark.changes("DFLUX")
def test_flux_into_a_face(tmp_path, face):
    """One element; the opposite face is held. Positive flux goes into the body."""
    cards = mesh("BODY", [0.0, LENGTH], [0.0, HEIGHT])
    opposite = ("TOP", "LEFT", "BOTTOM", "RIGHT")[face - 1]
    loaded = ("BOTTOM", "RIGHT", "TOP", "LEFT")[face - 1]
    distance = HEIGHT if face in (1, 3) else LENGTH

    def make(flux):
        deck = [*cards, *material("BODY", conductivity=K), *heat(
            "*BOUNDARY", f"BODY.{opposite}, 11, 11, 20.", "*DFLUX", f"BODY, S{face}, {flux!r}")]
        return deck, [("NT", f"BODY.{loaded}", "LAST", 20.0 + flux * distance / K, 1e-10)]

    follows(tmp_path, make, 30.0, -4.0)


@pytest.mark.changes("DSFLUX")
def test_flux_into_a_surface(tmp_path):
    follows(tmp_path, lambda flux: (
        bar(*heat("*BOUNDARY", "BODY.LEFT, 11, 11, 20.", "*DSFLUX", f"BODY.RIGHT, S, {flux!r}")),
        temperatures(lambda x: 20.0 + flux * x / K)), 30.0, -4.0)


@pytest.mark.parametrize("kind", ["CPE6", "CPE8", "CPE8R"])
@pytest.mark.changes("DFLUX")
def test_heat_source(tmp_path, kind):
    """The temperature is a parabola, which quadratic elements have."""
    follows(tmp_path, lambda source: (
        bar(*heat("*BOUNDARY", "BODY.LEFT, 11, 11, 20.", "BODY.RIGHT, 11, 11, 50.", "*DFLUX",
                  f"BODY, BF, {source!r}"), kind=kind),
        [("NT", n, "LAST", conduction.heated_wall(x, LENGTH, K, source, 20.0, 50.0), 1e-9)
         for n, (x, _) in nodes_of(mesh("BODY", XS, [0.0, 0.5], kind)).items()]), 12.0, 10.0)


HOT, COLD = (400.0, 3.0), (30.0, 7.0)


@pytest.mark.parametrize("other", [((380.0, 3.0), COLD), ((400.0, 3.5), COLD)])
@pytest.mark.parametrize(("card", "faces"), [
    pytest.param("FILM", ("1, F4", "2, F2"), marks=pytest.mark.changes("FILM")),
    pytest.param("SFILM", ("BODY.LEFT, F", "BODY.RIGHT, F"), marks=pytest.mark.changes("SFILM"))])
def test_films_on_both_sides_of_a_wall(tmp_path, card, faces, other):
    def make(films):
        (hot, film_hot), (cold, film_cold) = films
        flux, ends = conduction.wall(LENGTH, K, hot, cold, film_hot, film_cold)
        return bar(*heat(f"*{card}", f"{faces[0]}, {hot}, {film_hot}",
                         f"{faces[1]}, {cold}, {film_cold}")), [
            *temperatures(lambda x: ends[0] - flux * x / K),
            ("heat_in", "", "LAST", 0.5 * flux, 1e-10), ("heat_out", "", "LAST", 0.5 * flux, 1e-10),
            ("heat_imbalance", "", "LAST", 0.0, 1e-10, "ABS")]

    follows(tmp_path, make, (HOT, COLD), other)


def filmed(sink, film, when, sinks=(1.0, 1.0, 1.0), films=(0.25, 0.5, 1.0)):
    """Return checks of the bar, 20 at its left, under fractions of sink and film at some times."""
    rows = []
    for time, part, share in zip(when, sinks, films, strict=True):
        flux, faces = conduction.wall(LENGTH, K, 20.0, sink * part, film_cold=film * share)
        rows.append(("NT", "BODY.RIGHT", time, faces[1], 1e-10))
    return rows


TENT = ["*AMPLITUDE, NAME=TENT", "0., 0., 0.5, 1., 1., 0.4"]


@pytest.mark.parametrize(("options", "sinks", "films"), [
    ("", (1, 1, 1), (0.25, 0.5, 1)),             # the film ramps, the sink acts whole
    (", AMPLITUDE=TENT", (0.5, 1, 0.4), (0.25, 0.5, 1)),
    (", FILM AMPLITUDE=TENT", (1, 1, 1), (0.5, 1, 0.4)),
    (", AMPLITUDE=TENT, FILM AMPLITUDE=TENT", (0.5, 1, 0.4), (0.5, 1, 0.4))])
def test_course_of_a_film(tmp_path, options, sinks, films):
    deck = bar(*TENT, *heat("*BOUNDARY", "BODY.LEFT, 11, 11, 20.", f"*FILM{options}",
                            "2, F2, 300., 4.", times="0.25, 1."))
    judge(tmp_path, deck, filmed(300.0, 4.0, (0.25, 0.5, 1.0), sinks, films))
    notes = (tmp_path / "deck.lst").read_text()
    assert ("the coefficient ramps over the step" in notes) == (films == (0.25, 0.5, 1))
    assert ("the sink temperature acts fully at once" in notes) == (sinks == (1, 1, 1))


def test_film_of_a_step_that_jumps(tmp_path):
    deck = bar(*heat("*BOUNDARY", "BODY.LEFT, 11, 11, 20.", "*FILM", "2, F2, 300., 4.",
                     times="0.25, 1.", first="*STEP, AMPLITUDE=STEP"))
    judge(tmp_path, deck, filmed(300.0, 4.0, (0.25, 0.5, 1.0), films=(1, 1, 1)))
    assert "the coefficient acts fully at once" in (tmp_path / "deck.lst").read_text()


@pytest.mark.changes("FILM")
def test_film_outside_of_a_tube(tmp_path):
    """Weights of a film are 2 pi r: heat of a source leaves whole, T outside is known."""
    inner, outer, source, film, sink = 1.0, 2.0, 5.0, 0.3, 20.0

    def make(value):
        cards = [*mesh("BODY", [inner, 1.4, outer], [0.0, 0.5], "CAX8"),
                 *material("BODY", conductivity=K),
                 *heat("*DFLUX", f"BODY, BF, {source}", "*FILM", f"2, F2, {sink}, {value!r}")]
        rate = source * np.pi * (outer**2 - inner**2) * 0.5
        rise = rate / (2 * np.pi * outer * 0.5 * value)
        return cards, [("NT", "BODY.RIGHT", "LAST", sink + rise, 1e-9),
                       ("heat_in", "", "LAST", rate, 1e-9), ("heat_out", "", "LAST", rate, 1e-9)]

    follows(tmp_path, make, film, 0.4)


@pytest.mark.changes("BOUNDARY")
def test_temperature_through_a_tube(tmp_path):
    radii = list(np.linspace(1.0, 2.0, 9))
    cards = mesh("BODY", radii, [0.0, 0.1], "CAX8")

    def make(inside):
        rows = [("NT", n, "LAST", conduction.tube(r, 1.0, 2.0, inside, 10.0), 1e-5)
                for n, (r, _) in nodes_of(cards).items()]
        rate = 0.1 * conduction.tube_rate(1.0, 2.0, K, inside, 10.0)
        return [*cards, *material("BODY", conductivity=K), *heat(
            "*BOUNDARY", f"BODY.LEFT, 11, 11, {inside!r}", "BODY.RIGHT, 11, 11, 10.")], [
            *rows, ("heat_in", "", "LAST", rate, 1e-6)]

    follows(tmp_path, make, 100.0, 90.0)


@pytest.mark.changes("BOUNDARY")
def test_thermal_stresses_of_a_tube(tmp_path):
    """Plane strain between smooth ends; S11 radial, S33 hoop, S22 along the axis."""
    inner, outer, expansion = 1.0, 2.0, 1e-4
    cards = mesh("BODY", list(np.linspace(inner, outer, 25)), [0.0, 0.1], "CAX8")

    def make(inside):
        rows = []
        for r, where in ((inner, "BODY.LEFT"), (outer, "BODY.RIGHT")):
            rise, radial, hoop, moved = lame.hot_tube(r, inner, outer, inside, 10.0, YOUNG,
                                                      POISSON, expansion, "strain")
            axial = lame.axial_stress(radial, hoop, POISSON, "strain", expansion * rise, YOUNG)
            rows += [("U1", where, "LAST", moved, 1e-4), ("S33", where, "LAST", hoop, 1e-2),
                     ("S22", where, "LAST", axial, 3e-2)]
        return [*cards, *material("BODY", (YOUNG, POISSON), expansion, K),
                "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.",
                "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.",
                "*BOUNDARY", "BODY.BOTTOM, 2", "BODY.TOP, 2", f"BODY.LEFT, 11, 11, {inside!r}",
                "BODY.RIGHT, 11, 11, 10.", "*END STEP"], rows

    follows(tmp_path, make, 100.0, 80.0)


ALPHA = 1e-5


def held_hot(*cards, start=0.0):
    """Return a body that cannot move at all."""
    return [*BLOCK, *material("BODY", (YOUNG, POISSON), ALPHA), "*INITIAL CONDITIONS, "
            "TYPE=TEMPERATURE", f"BODY, {start!r}", "*BOUNDARY", "BODY, 1, 2", *cards]


def held_stress(rise):
    """Return the stress of a body that cannot move, heated."""
    return -YOUNG * ALPHA * rise / (1 - 2 * POISSON)


@pytest.mark.changes("TEMPERATURE")
def test_given_temperature(tmp_path):
    follows(tmp_path, lambda hot: (
        held_hot(*static("*TEMPERATURE", f"BODY, {hot!r}"), start=20.0),
        [(name, "BODY", "LAST", held_stress(hot - 20.0), 1e-9) for name in ("S11", "S22", "S33")]
        + [("NT", "BODY", "LAST", hot, 1e-12)]), 120.0, 100.0)


@pytest.mark.changes("INITIAL CONDITIONS")
def test_initial_temperature_is_the_natural_state(tmp_path):
    follows(tmp_path, lambda start: (
        held_hot(*static("*TEMPERATURE", "BODY, 120."), start=start),
        [("S22", "BODY", "LAST", held_stress(120.0 - start), 1e-9)]), 20.0, 30.0)


# Courses: each load of full value gives an answer in proportion, read at three times.

LOADS = {
    "CLOAD": (static, lambda o: [f"*CLOAD{o}", *top_forces(-5.0)], block, ("S22", "BODY", -5.0)),
    "DLOAD": (static, lambda o: [f"*DLOAD{o}", "3, P3, 5.", "4, P3, 5."], block,
              ("S22", "BODY", -5.0)),
    "DSLOAD": (static, lambda o: [f"*DSLOAD{o}", "BODY.TOP, P, 5."], block, ("S22", "BODY", -5.0)),
    "BOUNDARY": (static, lambda o: [f"*BOUNDARY{o}", "BODY.TOP, 2, 2, 0.01"], block,
                 ("U2", "BODY.TOP", 0.01)),
    "TEMPERATURE": (static, lambda o: [f"*TEMPERATURE{o}", "BODY, 50."], held_hot,
                    ("S22", "BODY", held_stress(50.0))),
    "DSFLUX": (heat, lambda o: [f"*DSFLUX{o}", "BODY.RIGHT, S, 10."], "cold",
               ("HFL1", "BODY", -10.0)),
    "DFLUX": (heat, lambda o: [f"*DFLUX{o}", "2, S2, 10."], "cold", ("HFL1", "BODY", -10.0)),
    "CFLUX": (heat, lambda o: [f"*CFLUX{o}", *(f"{n}, 11, {s * 10.0!r}" for n, s in side_shares(
        mesh("BODY", XS, [0.0, 0.5]), 0, LENGTH).items())], "cold", ("HFL1", "BODY", -10.0)),
    "TEMPERATURES": (heat, lambda o: [f"*BOUNDARY{o}", "BODY.RIGHT, 11, 11, 40."], "cold",
                     ("HFL1", "BODY", -K * 40.0 / LENGTH)),
}


def cold_bar(*cards):
    """Return the bar, at 0 at first and 0 at its left."""
    return [*mesh("BODY", XS, [0.0, 0.5]), *material("BODY", (YOUNG, POISSON), conductivity=K),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.", "*BOUNDARY", "BODY.LEFT, 11",
            *cards]


def course(load):
    """Return the step, cards, model and answer of a load."""
    step, cards, model, answer = LOADS[load]
    return step, cards, cold_bar if model == "cold" else model, answer


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize(("first", "options", "factors"), [
    ("*STEP", "", (0.25, 0.5, 1.0)), ("*STEP, AMPLITUDE=STEP", "", (1.0, 1.0, 1.0)),
    ("*STEP", ", AMPLITUDE=TENT", (0.5, 1.0, 0.4)),
    ("*STEP, AMPLITUDE=STEP", ", AMPLITUDE=TENT", (0.5, 1.0, 0.4))])
def test_course_of_a_load(tmp_path, load, first, options, factors):
    step, cards, model, (quantity, where, full) = course(load)
    deck = model(*step(*cards(options), first=first, times="0.25, 1."))
    at = next(k for k, card in enumerate(deck) if card.startswith("*STEP"))
    scale = 1e-9 * abs(full)
    judge(tmp_path, [*deck[:at], *TENT, *deck[at:]],
          [(quantity, where, time, full * f, scale, "ABS")
           for time, f in zip((0.25, 0.5, 1.0), factors, strict=True)])


@pytest.mark.parametrize("load", [load for load in LOADS if load not in ("BOUNDARY", "TEMPERATURES")])
def test_new_alone_ends_all_loads_of_its_kind(tmp_path, load):
    """OP=NEW needs no data: nothing is left, as in CalculiX. Supports stay."""
    step, cards, model, (quantity, where, full) = course(load)
    judge(tmp_path, model(*step(*cards("")), *step(f"{cards('')[0]}, OP=NEW")),
          [(quantity, where, 1.0, full, 1e-9 * abs(full), "ABS"),
           (quantity, where, 2.0, 0.0, 1e-9 * abs(full), "ABS")])


def test_new_alone_ends_supports_and_films(tmp_path):
    """The supports that a second body has no more are named; another film's heat stays out."""
    deck = write(tmp_path / "freed.inp", block(*static("*DSLOAD", "BODY.TOP, P, 5."),
                                               *static("*BOUNDARY, OP=NEW")))
    process = run("check", deck)
    assert process.returncode == 1
    assert "step 2: body 1 (of BODY, first node 1) can move along x" in process.stderr
    heat = ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1."]
    judge(tmp_path, [*BLOCK, *material("BODY", conductivity=0.5),
                     *heat, "*BOUNDARY", "BODY.LEFT, 11, 11, 40.",
                     "*FILM", "2, F2, 100., 3.", "4, F2, 100., 3.", "*END STEP",
                     *heat, "*FILM, OP=NEW", "*END STEP"],
          [("NT", "BODY.RIGHT", 1.0, 40 + 60 * (WIDTH / 0.5) / (WIDTH / 0.5 + 1 / 3.0), 1e-10),
           ("NT", "BODY.RIGHT", 2.0, 40.0, 1e-10)])
