"""Decks that CalculiX and thercon read as they are: every element, its stiffness and conduction.

CalculiX integrates as it does in three dimensions, which is the same for most elements. Where it
is not, the difference is that of two discretisations, and the test says which.
"""

import math

import pytest
from blocks import write
from calculix import (
    DIGITS,
    HEAT,
    MECHANICS,
    assert_within,
    calculix,
    compared,
    differences,
    thercon,
)
from physics import material, mesh

YOUNG, POISSON = 1000.0, 0.3
HELD = ["*BOUNDARY", "BODY.BOTTOM, 2, 2", "1, 1, 1"]
CLAMPED = ["*BOUNDARY", "BODY.BOTTOM, 1, 2, 0."]
FORCES = ["*CLOAD", "BODY.TOP, 1, .5", "*DLOAD", "BODY, P2, 3.", "BODY, GRAV, 9.81, 0.5, -2., 0.",
          "BODY, BX, 0.3", "BODY, BY, -0.2", "*DSLOAD", "BODY.TOP, P, 2."]
WARMTH = ["*BOUNDARY", "BODY.BOTTOM, 11, 11, 100.", "*DFLUX", "BODY, BF, 6.", "BODY, S2, 5.",
          "*CFLUX", "BODY.TOP, 11, 0.7"]
FILM = ["*FILM", "BODY.LEFT, F4, 10., 2."]
WEIGHT = ["*DLOAD", "BODY, GRAV, 9.81, -1., -1., 0."]


def body(kind, divisions=2, thickness=0.5, young=YOUNG, poisson=POISSON):
    """Return a distorted block of an element kind, off the axis x = 0."""
    xs = [1.0 + 1.5 * (i / divisions) ** 1.2 for i in range(divisions + 1)]
    ys = [1.1 * i / divisions for i in range(divisions + 1)]
    return [*mesh("BODY", xs, ys, kind=kind, skew=0.14 / divisions),
            *material("BODY", (young, poisson), 1e-5, 4.0, 2.0),
            *([] if kind.startswith("CAX") else [f"{thickness}"]),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20."]


def pushed(kind, *loads, held=HELD, **how):
    return [*body(kind, **how), *held, "*STEP", "*STATIC", *(loads or FORCES), *MECHANICS,
            "*END STEP"]


def warmed(kind, *loads, **how):
    return [*body(kind, **how), "*STEP", "*HEAT TRANSFER, STEADY STATE", *(loads or WARMTH), *HEAT,
            "*END STEP"]


@pytest.mark.parametrize("kind", ["CPE8", "CPE8R", "CPE6", "CPE3"])
def test_plane_strain_digit_for_digit(tmp_path, kind):
    assert_within(compared(tmp_path, pushed(kind)), DIGITS)


@pytest.mark.parametrize("kind", ["CPE8", "CPE8R", "CPE6", "CPE4", "CPE3", "CPS8", "CPS4"])
def test_heat_digit_for_digit(tmp_path, kind):
    assert_within(compared(tmp_path, warmed(kind)), DIGITS)


@pytest.mark.parametrize("kind", ["CPE8", "CPE4"])
def test_films_digit_for_digit(tmp_path, kind):
    assert_within(compared(tmp_path, warmed(kind, *WARMTH, *FILM)), DIGITS)


@pytest.mark.parametrize("kind", ["CPE8R", "CPE6"])
def test_films_of_reduced_elements_and_triangles(tmp_path, kind):
    """CalculiX takes fewer points on their sides, which a product of two parabolas needs more of."""
    found = [compared(tmp_path, warmed(kind, "*BOUNDARY", "BODY.BOTTOM, 11, 11, 100.", *FILM,
                                       divisions=n)) for n in (2, 8)]
    assert found[1]["NT"] < found[0]["NT"] / 4
    assert max(found[0].values()) < 1e-2


def test_four_nodes_of_calculix_are_fully_integrated(tmp_path):
    """thercon's CPE4 has a mean dilatation, CalculiX's has not: it is thercon's CPS4 with the
    constants of plane strain, and all but sigma_zz is the same there."""
    theirs = calculix(write(tmp_path / "theirs.inp", pushed("CPE4")))
    ours = thercon(write(tmp_path / "ours.inp", pushed(
        "CPS4", young=YOUNG / (1 - POISSON**2), poisson=POISSON / (1 - POISSON))))
    found = differences({key: table for key, table in theirs.items() if key[1] != "S33"}, ours)
    assert_within({q: v for q, v in found.items() if q[0] != "S"}, DIGITS)


def test_four_nodes_meet_with_finer_meshes(tmp_path):
    found = [compared(tmp_path, pushed("CPE4", *WEIGHT, held=CLAMPED, divisions=n))
             for n in (2, 8)]
    assert found[1]["U1"] < found[0]["U1"] / 4
    assert found[1]["U2"] < found[0]["U2"] / 4


@pytest.mark.parametrize("kind", ["CPS8", "CPS8R", "CPS6", "CPS4", "CPS3"])
def test_uniform_plane_stress_digit_for_digit(tmp_path, kind):
    assert_within(compared(tmp_path, pushed(kind, "*DSLOAD", "BODY.LEFT, P, 3.",
                                            "BODY.RIGHT, P, 3.", "BODY.TOP, P, 2.")), DIGITS)


@pytest.mark.parametrize("kind", ["CPS8", "CPS8R", "CPS6", "CPS4"])
def test_plane_stress_of_a_thin_plate(tmp_path, kind):
    """CalculiX's sigma_zz vanishes in the mean only, for the thickness is continuous; that makes
    the plate stiffer by what falls with the mesh, as long as the plate is thin."""
    found = [compared(tmp_path, pushed(kind, *WEIGHT, held=CLAMPED, divisions=n,
                                       thickness=0.01)) for n in (2, 8)]
    assert found[0]["U2"] < 2e-2
    assert found[1]["U2"] < found[0]["U2"] / 3


# The sides of a wedge of two degrees stand at 1 - cos(1 degree) of the radius from its middle.
WEDGE = 2 * 1.5e-4


@pytest.mark.parametrize("kind", ["CAX8", "CAX8R"])
def test_rings(tmp_path, kind):
    loads = ["*CLOAD", "BODY.TOP, 2, .5", "*DLOAD", "BODY, P3, 3.", "*DSLOAD", "BODY.LEFT, P, 2."]
    if kind == "CAX8":   # with r in it the weight takes more points than CAX8R has in CalculiX
        loads += ["*DLOAD", "BODY, GRAV, 9.81, 0., -1., 0."]
    assert_within(compared(tmp_path, pushed(kind, *loads), rings=True), WEDGE)


@pytest.mark.parametrize("kind", ["CAX8", "CAX8R", "CAX4"])
def test_heat_of_rings(tmp_path, kind):
    assert_within(compared(tmp_path, warmed(kind), rings=True), WEDGE)


def test_triangles_of_rings_meet_with_finer_meshes(tmp_path):
    """Weight along the axis: both integrate it in their own points."""
    loads = ["*DLOAD", "BODY, GRAV, 9.81, 0., -1., 0."]
    found = [max(compared(tmp_path, pushed("CAX6", *loads, divisions=n), rings=True).values())
             for n in (2, 8)]
    assert found[1] < found[0] / 4
    assert found[0] < 1e-2


def test_radial_forces_of_a_wedge_are_not_those_of_the_ring(tmp_path):
    """What docs/deck.md says of RF1: the reaction of a ring held at its inner face."""
    deck = write(tmp_path / "deck.inp", [
        *body("CAX8"), "*BOUNDARY", "BODY.LEFT, 1, 1", "1, 2, 2", "*STEP", "*STATIC", "*DSLOAD",
        "BODY.RIGHT, P, 3.", "*NODE PRINT, NSET=BODY.LEFT, TOTALS=ONLY", "RF", "*END STEP"])
    theirs, = calculix(deck)[1.0, "RF1@BODY.LEFT"].values()
    ours, = thercon(deck)[1.0, "RF1@BODY.LEFT"].values()
    assert not math.isclose(180 * theirs, ours, rel_tol=0.01)
