"""Decks that CalculiX and thercon read as they are: every element, its stiffness and conduction.

CalculiX integrates as it does in three dimensions, which is the same for most elements. Where it
is not, the difference is that of two discretisations, the test says which, and its limits are the
figures that docs/deck tells of it.
"""

import math
import re

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
from deck_runs import DECKS
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


ROUNDED = 1.05   # by how much figures of two digits are at most told too small


def told(row):
    """Return the percentages in a row of docs/deck/other_programs.md as limits."""
    text = (DECKS.parents[1] / "docs" / "deck" / "other_programs.md").read_text()
    (told_of,) = re.findall(rf"^\| {re.escape(row)} \|.*\n(?:\| \|.*\n)*", text, re.M)
    return [ROUNDED * float(number) / 100 for number in re.findall(r"([\d.]+) %", told_of)]


def largest(differs, *quantities):
    """Return the largest difference of some quantities."""
    return max(differs[quantity] for quantity in quantities)


FOUR_NODES = told("`CPE4`, `CAX4`")   # displacements of 2 x 2 and 8 x 8 elements; stresses of a ring


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
    for differs, most in zip(found, FOUR_NODES, strict=False):
        assert largest(differs, "U1", "U2") < most


@pytest.mark.parametrize("kind", ["CPS8", "CPS8R", "CPS6", "CPS4", "CPS3"])
def test_uniform_plane_stress_digit_for_digit(tmp_path, kind):
    assert_within(compared(tmp_path, pushed(kind, "*DSLOAD", "BODY.LEFT, P, 3.",
                                            "BODY.RIGHT, P, 3.", "BODY.TOP, P, 2.")), DIGITS)


@pytest.mark.parametrize(("kind", "moved", "stressed"), [
    ("CPS8", 0, 2), ("CPS8R", 0, 2), ("CPS6", 0, 2), ("CPS4", 4, 6), ("CPS3", 8, 6)])
def test_plane_stress_of_a_thin_plate(tmp_path, kind, moved, stressed):
    """CalculiX's sigma_zz vanishes in the mean only, for the thickness is continuous; that makes
    the plate stiffer by what falls with the mesh, as long as the plate is thin."""
    figures = told("`CPS...`")
    found = [compared(tmp_path, pushed(kind, *WEIGHT, held=CLAMPED, divisions=n,
                                       thickness=0.01)) for n in (2, 8)]
    for k, differs in enumerate(found):
        assert largest(differs, "U1", "U2") < figures[moved + k]
        assert largest(differs, "S11", "S22", "S12") < figures[stressed + k]
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


def spinning(kind, columns, inner=1.0, rows=1):
    """Return a ring on rollers, its outer radius 2.5, that turns round its axis."""
    xs = [inner + (2.5 - inner) * i / columns for i in range(columns + 1)]
    return [*mesh("BODY", xs, [1.1 * j / rows for j in range(rows + 1)], kind=kind),
            *material("BODY", (YOUNG, POISSON), density=2.0), "*BOUNDARY", "BODY.BOTTOM, 2",
            "*STEP", "*STATIC", "*DLOAD", "BODY, CENTRIF, 4., 0., 0., 0., 0., 1., 0.", *MECHANICS,
            "*END STEP"]


def displaced(found):
    """Return the largest difference of displacements and stresses."""
    return max(v for q, v in found.items() if q[0] in "US")


def test_spinning_rings_digit_for_digit(tmp_path):
    found = compared(tmp_path, spinning("CAX8", 1), rings=True)
    assert displaced(found) < WEDGE


@pytest.mark.parametrize(("inner", "first"), [(1.0, 0), (0.25, 3)])
@pytest.mark.parametrize("kind", ["CAX8R", "CAX6"])
def test_spinning_rings_of_fewer_points(tmp_path, kind, inner, first):
    """One, two and eight elements from the bore to the rim: the force grows with the square of the
    radius, which takes more points than CalculiX has."""
    most = told("CENTRIF of axisymmetric elements on `8R` and `6`")[first:first + 3]
    found = [displaced(compared(tmp_path, spinning(kind, n, inner), rings=True))
             for n in (1, 2, 8)]
    assert all(f < m for f, m in zip(found, most, strict=True)), found
    assert found[0] > 4e-3   # not the tenth of a percent of finer meshes


def test_spinning_rings_of_four_nodes_meet_with_finer_meshes(tmp_path):
    coarse, fine = (compared(tmp_path, spinning("CAX4", n, rows=n), rings=True) for n in (2, 8))
    for differs, moved, stressed in zip((coarse, fine), FOUR_NODES[:2], FOUR_NODES[2:], strict=True):
        assert largest(differs, "U1", "U2") < moved
        assert displaced(differs) < stressed


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


RING_AND_BOLTS = """
*NODE, NSET=ALL
1, 10., 0.
2, 11., 0.
3, 11., 2.
4, 10., 2.
5, 10.5, 0.
6, 11., 1.
7, 10.5, 2.
8, 10., 1.
9, 11., 4.
10, 10., 4.
11, 11., 3.
12, 10.5, 4.
13, 10., 3.
*ELEMENT, TYPE=CAX8, ELSET=RING
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=CPS8, ELSET=BOLTS
2, 4, 3, 9, 10, 7, 11, 12, 13
*NSET, NSET=BOTTOM
1, 2, 5
*NSET, NSET=TOP
9, 10, 12
*MATERIAL, NAME=STEEL
*ELASTIC
1000., 0.3
*EXPANSION
1.E-5
*SOLID SECTION, ELSET=RING, MATERIAL=STEEL
*SOLID SECTION, ELSET=BOLTS, MATERIAL=STEEL
20.
*INITIAL CONDITIONS, TYPE=TEMPERATURE
ALL, 0.
*STEP
*STATIC
*BOUNDARY
BOTTOM, 2
TOP, 1
TOP, 2, 2, 0.01
*TEMPERATURE
ALL, 50.
*NODE PRINT, NSET=ALL
U, RF
*EL PRINT, ELSET=RING
S
*EL PRINT, ELSET=BOLTS
S
*END STEP
"""


def test_bolts_in_plane_stress_on_a_ring_are_as_thick_as_all_of_them(tmp_path):
    found = compared(tmp_path, RING_AND_BOLTS, rings=True)
    assert_within(found, WEDGE)
