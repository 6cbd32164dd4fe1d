"""Decks that CalculiX and thercon read as they are: materials, temperatures, courses over steps."""

import pytest
from blocks import write
from calculix import (
    BOTH,
    DIGITS,
    HEAT,
    MECHANICS,
    assert_within,
    calculix,
    compared,
    thercon,
)
from physics import material, mesh
from test_calculix_elements import HELD, WEDGE, body

ORTHOTROPIC = [
    "*MATERIAL, NAME=WOOD", "*ELASTIC, TYPE=ENGINEERING CONSTANTS",
    "1200., 500., 800., .3, .2, .25, 260., 240.", "230.", "*EXPANSION, TYPE=ORTHO",
    "1e-5, 2e-5, 3e-5", "*CONDUCTIVITY, TYPE=ORTHO", "4., 1., 2.", "*DENSITY", "2.",
    "*ORIENTATION, NAME=GRAIN", "1., 0.5, 0., -0.5, 1., 0.",
    "*SOLID SECTION, ELSET=BODY, MATERIAL=WOOD, ORIENTATION=GRAIN"]
STIFFNESSES = [card.replace("ENGINEERING CONSTANTS", "ORTHO").replace(
    "1200., 500., 800., .3, .2, .25, 260., 240.", "1200., 200., 600., 150., 180., 900., 260., 240.")
    for card in ORTHOTROPIC]
GRAIN = ORTHOTROPIC.index("*ORIENTATION, NAME=GRAIN")
TURNED = [*ORTHOTROPIC[:GRAIN + 2], "3, 25.", *ORTHOTROPIC[GRAIN + 2:]]
ROUND = [*ORTHOTROPIC[:GRAIN], "*ORIENTATION, NAME=GRAIN, SYSTEM=CYLINDRICAL",
         "0., -1., 0., 0., -1., 1.", *ORTHOTROPIC[GRAIN + 2:]]
ANISOTROPIC = [*ORTHOTROPIC[:1], "*ELASTIC, TYPE=ANISO",
               "1200., 200., 600., 150., 180., 900., 60., 30.",
               "20., 260., 0., 0., 0., 0., 240., 0.", "0., 0., 0., 0., 230.", *ORTHOTROPIC[4:]]
COUPLED = "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT"
CONDUCTION = "*HEAT TRANSFER, STEADY STATE, DIRECT"

# In a coupled step CalculiX takes heat and pressure through faces as they are deformed.
RIGID = {"young": 1e8}
SMALL_STRAINS = [card if card != "1e-05" else "1e-09" for card in body("CPE8R", **RIGID)]


def grained(kind, section=ORTHOTROPIC):
    xs, ys = [1.0, 1.6, 2.5], [0.0, 0.5, 1.1]
    return [*mesh("BODY", xs, ys, kind=kind, skew=0.07), *section,
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20."]


def step(analysis, *cards, options=""):
    return ["*STEP" + options, *analysis.splitlines(), *cards, "*END STEP"]


@pytest.mark.parametrize(("kind", "section"), [
    ("CPE8", ORTHOTROPIC), ("CPE8R", ORTHOTROPIC), ("CPE6", ORTHOTROPIC), ("CPE8R", STIFFNESSES),
    ("CPE8R", TURNED), ("CPE8R", ROUND), ("CPE8R", ANISOTROPIC)])
def test_solids_with_axes_of_their_own(tmp_path, kind, section):
    """Values are printed along these axes."""
    assert_within(compared(tmp_path, grained(kind, section), HELD, step(
        "*STATIC", "*TEMPERATURE", "BODY, 90.", "*DLOAD", "BODY, P2, 3.",
        "BODY, GRAV, 9.81, 0., -2., 0.", *MECHANICS)), DIGITS)


def test_an_orthotropic_ring(tmp_path):
    """The third axis is the circumference."""
    assert_within(compared(tmp_path, grained("CAX8"), HELD, step(
        "*STATIC", "*TEMPERATURE", "BODY, 90.", "*DLOAD", "BODY, P2, 3.", *MECHANICS), rings=True),
        WEDGE)


@pytest.mark.parametrize(("kind", "section"), [
    ("CPE8", ORTHOTROPIC), ("CPE8R", ROUND), ("CPE6", TURNED), ("CPS8", ORTHOTROPIC)])
def test_orthotropic_conductors_with_axes_of_their_own(tmp_path, kind, section):
    assert_within(compared(tmp_path, grained(kind, section), step(
        CONDUCTION, "*BOUNDARY", "BODY.BOTTOM, 11, 11, 100.", "*DFLUX", "BODY, BF, 6.",
        "BODY, S2, 5.", *HEAT)), DIGITS)


@pytest.mark.parametrize("kind", ["CPE8", "CPE8R", "CPE6", "CPE3"])
def test_given_temperatures_that_are_uniform(tmp_path, kind):
    found = compared(tmp_path, body(kind), HELD,
                     step("*STATIC", "*TEMPERATURE", "BODY, 90.", *MECHANICS))
    assert_within({q: v for q, v in found.items() if q[:2] != "RF"}, DIGITS)   # which are zero


@pytest.mark.parametrize("kind", ["CPE8R", "CPE6"])
def test_given_temperatures_that_vary(tmp_path, kind):
    assert_within(compared(tmp_path, body(kind), HELD, step(
        "*STATIC", "*TEMPERATURE", "BODY, 90.", "BODY.TOP, 120.", *MECHANICS)), DIGITS)


def test_calculix_flattens_temperatures_of_fully_integrated_elements(tmp_path):
    """It takes them bilinear in eight nodes, to suit the strains (and constant in four); in finer
    meshes, under a temperature that is smooth, this is the same."""
    conduct = step(CONDUCTION, "*BOUNDARY", "BODY.BOTTOM, 11, 11, 100.", "*DFLUX", "BODY, BF, 90.")
    found = [compared(tmp_path, body("CPE8", divisions=n), ["*BOUNDARY", "BODY.BOTTOM, 1, 2"],
                      conduct, step("*STATIC", *MECHANICS)) for n in (2, 8)]
    assert found[1]["U2"] < found[0]["U2"] / 4
    assert found[0]["U2"] < 0.1


def test_a_plate_that_turns_round_a_point(tmp_path):
    assert_within(compared(tmp_path, body("CPE8"), HELD, step(
        "*STATIC", "*DLOAD", "BODY, CENTRIF, 4., .3, .2, 0., 0., 0., 1.", *MECHANICS)), DIGITS)


def test_a_ring_that_turns_round_its_axis(tmp_path):
    assert_within(compared(tmp_path, body("CAX8"), HELD, step(
        "*STATIC", "*DLOAD", "BODY, CENTRIF, 4., 0., 0., 0., 0., 1., 0.", *MECHANICS), rings=True),
        WEDGE)


CURVES = ["*AMPLITUDE, NAME=TENT", "0., 0., 0.5, 1., 1., 0.25",
          "*AMPLITUDE, NAME=LONG, TIME=TOTAL TIME", "0., 0., 1., 1., 2., 3., 3., 0.5"]


def test_forces_and_supports_over_steps(tmp_path):
    """They stay, are replaced, and end."""
    assert_within(compared(
        tmp_path, body("CPE8R"), HELD,
        step("*STATIC", "*CLOAD", "3, 1, .5", "5, 2, 1.", "*DLOAD", "BODY, P2, 3.", *MECHANICS),
        step("*STATIC", "*CLOAD", "3, 1, .2", "3, 1, .1", "*DLOAD", "1, P2, 1.",
             "BODY, GRAV, 9., 0., -1., 0."),
        step("*STATIC", "*CLOAD, OP=NEW", "3, 2, .2", "*DLOAD, OP=NEW", "2, P2, 1.",
             "*BOUNDARY, OP=NEW", "BODY.BOTTOM, 1, 2", "BODY.TOP, 2, 2, -0.01")), DIGITS)


def test_forces_and_supports_along_amplitudes(tmp_path):
    """One on step time ends with its step; one on total time goes on."""
    assert_within(compared(
        tmp_path, CURVES, body("CPE8R"), HELD,
        step("*STATIC", "*CLOAD, AMPLITUDE=TENT", "3, 1, .5", "*DLOAD, AMPLITUDE=LONG",
             "BODY, P2, 2.", "*BOUNDARY, AMPLITUDE=TENT", "BODY.TOP, 2, 2, -.02", *MECHANICS),
        step("*STATIC\n0.5, 0.5", "*CLOAD", "5, 1, .2"), step("*STATIC", "*DLOAD", "1, P3, 2."),
        step("*STATIC")), DIGITS)


@pytest.mark.parametrize("curve", ["", ", AMPLITUDE=TENT", ", AMPLITUDE=LONG"])
def test_loads_in_increments_of_coupled_steps(tmp_path, curve):
    """Ramps, amplitudes, what stays behind them, and what ends, *CFLUX with the OP=NEW of *CLOAD;
    temperatures and forces at once."""
    found = compared(
        tmp_path, CURVES, SMALL_STRAINS, HELD,
        step(f"{COUPLED}\n0.25, 1.", f"*BOUNDARY{curve}", "BODY.BOTTOM, 11, 11, 100.",
             f"*CLOAD{curve}", "14, 1, 5.", f"*DFLUX{curve}", "2, S3, 4.", f"*DLOAD{curve}",
             "2, P2, 2.", *BOTH),
        step(f"{COUPLED}\n0.25, 1.", "*CFLUX", "3, 11, 2."),
        step(f"{COUPLED}\n0.25, 0.5", "*CLOAD, OP=NEW", "*DFLUX, OP=NEW", "*DLOAD, OP=NEW"),
        step(f"{COUPLED}\n0.25, 0.5", "*BOUNDARY, OP=NEW", "BODY.BOTTOM, 2, 2", "1, 1",
             "BODY.TOP, 11, 11, 30."))
    assert_within(found, DIGITS)


def test_faces_of_coupled_steps_stretch_in_calculix(tmp_path):
    """What SMALL_STRAINS is for: heat goes with the area, which the strain makes larger. CalculiX
    sees it once it is made to iterate."""
    tight = [card for field in ("TEMPERATURE", "DISPLACEMENT") for card in (
        f"*CONTROLS, PARAMETERS=FIELD, FIELD={field}", "1.E-9, 1.E-9, , , 1.E-9")]
    found = compared(tmp_path, body("CPE8R"), HELD, step(
        "\n".join([*tight, COUPLED]), "*BOUNDARY", "BODY.BOTTOM, 11, 11, 100.", "*DFLUX",
        "BODY.TOP, S3, 5.", "*DSLOAD", "BODY.TOP, P, 2.", *BOTH))
    strain = 1.3 * (1e-5 * 80.0 + 0.3 * 2.0 / 1000.0)   # plane strain: 80 degrees, pressure 2
    assert found["RFL"] == pytest.approx(strain, rel=0.1)
    assert found["NT"] < strain


def test_films_over_steps(tmp_path):
    """The coefficient ramps and the sink acts at once; both follow amplitudes; films end.

    All faces are loaded from the first step on: CalculiX loses track of ramps where one is added.
    """
    conduct = f"{CONDUCTION}\n0.25, 1."
    assert_within(compared(
        tmp_path, CURVES, body("CPE8"),
        step(conduct, "*BOUNDARY", "BODY.BOTTOM, 11, 11, 100.", "*FILM", "BODY, F3, 10., 2.",
             "2, F2, 50., 1.E-9", "*DFLUX", "BODY.TOP, S3, 0.", *HEAT),
        step(conduct, "*FILM, AMPLITUDE=TENT, FILM AMPLITUDE=LONG", "BODY.TOP, F3, 30., 2."),
        step(conduct, "*DFLUX", "BODY.TOP, S3, 3."), step(conduct, "*FILM, OP=NEW"),
        step(conduct, "*FILM", "2, F2, 50., 3.")), DIGITS)


def test_loads_that_act_at_once(tmp_path):
    assert_within(compared(tmp_path, body("CPE8R"), step(
        f"{CONDUCTION}\n0.5, 1.", "*BOUNDARY", "BODY.BOTTOM, 11, 11, 100.", "*DFLUX",
        "BODY.TOP, S3, 3.", *HEAT, options=", AMPLITUDE=STEP")), DIGITS)


@pytest.mark.parametrize("analysis", [CONDUCTION, COUPLED])
def test_mechanics_at_the_temperatures_of_the_step_before(tmp_path, analysis):
    assert_within(compared(tmp_path, SMALL_STRAINS, HELD, step(
        analysis, "*BOUNDARY", "BODY.BOTTOM, 11, 11, 100.", "BODY.TOP, 11, 11, 30.",
        "BODY.LEFT, 11, 11, 60.", *HEAT), step("*STATIC", "*DSLOAD", "BODY.TOP, P, 4.",
                                               *MECHANICS)), DIGITS)


def test_linear_steps_of_calculix_have_one_increment(tmp_path):
    """thercon has those that *STATIC asks for; the last ones agree."""
    deck = write(tmp_path / "deck.inp", body("CPE8R"), HELD,
                 step("*STATIC\n0.25, 1.", "*DLOAD", "BODY, P2, 3.", *MECHANICS))
    assert {time for time, _ in calculix(deck)} == {1.0}
    assert {time for time, _ in thercon(deck)} == {0.25, 0.5, 0.75, 1.0}


def test_two_blocks_pressed_together_with_friction(tmp_path):
    """CalculiX's penalty gives by p/K, 1e-4 of the blocks' shortening, and along the faces by ten
    times that per stress."""
    blocks = [*mesh("BODY", [1.0, 1.75, 2.5], [0.0, 0.5, 1.0]), *material("BODY", (1000.0, 0.3)),
              *mesh("BASE", [1.0, 1.75, 2.5], [-1.0, -0.5, 0.0], first=101),
              *material("BASE", (3000.0, 0.2))]
    contact = ["*SURFACE INTERACTION, NAME=FACES",
               "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", "1.E7", "*FRICTION", "0.3, 1.E6",
               "*CONTACT PAIR, INTERACTION=FACES, TYPE=SURFACE TO SURFACE", "BODY.BOTTOM, BASE.TOP"]
    assert_within(compared(
        tmp_path, blocks, contact, "*BOUNDARY", "BASE.BOTTOM, 1, 2", "BODY.LEFT, 1",
        step("*STATIC, DIRECT\n0.25, 1.", "*DSLOAD", "BODY.TOP, P, 5.",
             "*NODE PRINT, NSET=BODY", "U", "*EL PRINT, ELSET=BODY", "S")), 2e-3)
