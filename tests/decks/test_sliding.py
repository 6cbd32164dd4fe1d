"""Sliding beyond what contact points of the undeformed mesh allow is never silent."""

import math
import re

import pytest
from blocks import without_unused_surfaces, write
from deck_runs import HERTZ, run
from physics import material, mesh

TOO_FAR = "too far for contact points of the undeformed mesh"


def told(path):
    """Run a deck; return the slip, the node and what is said of sliding, or nothing."""
    process = run("run", path, "--out", path.parent)
    assert process.returncode == 0, process.stderr
    said = process.stderr
    found = re.findall(r"slides by ([^,]*), " + TOO_FAR + r": slave node (\d+) (.*)", said)
    assert len(found) <= 1, said
    unsure = "(no estimate: slides beyond its contact points)"
    assert (unsure in process.stdout) == bool(found), process.stdout
    assert not (found and "+-" in process.stdout), process.stdout
    return (float(found[0][0]), int(found[0][1]), found[0][2]) if found else None


def roller(path, slide, pairing, mu=0.0, depth=-0.01):
    """Write a deck of a rigid cylinder of radius 5, pressed into a block and pushed aside; return
    its path. Half the width of the contact is about 0.2."""
    block = mesh("BLOCK", [k / 20 - 1 for k in range(41)], [k / 4 - 2 for k in range(9)], "CPE4")
    pair = [f"*CONTACT PAIR, INTERACTION=I, NAME=C, PAIRING={pairing}", "BLOCK.TOP, ROLL"]
    return write(
        path, without_unused_surfaces([*block, *material("BLOCK"), *pair]),
        ["*NODE", "9999, 0., 5.", "*SURFACE, NAME=ROLL, TYPE=SEGMENTS", "START, 3., 1.",
         "CIRCL, -3., 1., 0., 5.", "*RIGID BODY, REF NODE=9999, ANALYTICAL SURFACE=ROLL",
         "*SURFACE INTERACTION, NAME=I", "*FRICTION", f"{mu!r}",
         "*STEP", "*STATIC", "0.5, 1.", "*BOUNDARY", "BLOCK.BOTTOM, 1, 2", "9999, 1", "9999, 6",
         f"9999, 2, 2, {depth!r}", "*END STEP",
         "*STEP", "*STATIC", "0.5, 1.", "*BOUNDARY", f"9999, 1, 1, {slide!r}", "*END STEP"])


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize(("slide", "warns"), [
    (0.0, False), (0.005, False), (0.02, True), (-0.2, True)])
def test_a_roller_that_moves_aside_by_a_tenth_of_its_contact(tmp_path, pairing, slide, warns):
    """At the edge a the gap x^2/(2R) changes by s a/R, over a^2/(2R) by 2s/a."""
    found = told(roller(tmp_path / "d.inp", slide, pairing))
    assert (found is not None) == warns
    if warns:
        assert "to where the gap of the mesh differs by" in found[2]
        assert abs(slide) / 2.1 < found[0] < 1.05 * abs(slide)   # of either increment


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
def test_partial_slip_is_within_the_theory(tmp_path, pairing):
    """Friction 0.3 carries the roller aside by less than it slides: Cattaneo and Mindlin."""
    assert told(roller(tmp_path / "d.inp", 0.001, pairing, mu=0.3)) is None


def blocks(path, upper, lower, slide, pairing="", kind="CPE4"):
    """Write a deck of a block (columns, left, right) dragged along a wider one; return its path."""
    parts = [mesh(name, [left + (right - left) * k / n for k in range(n + 1)], [y, y + 1], kind,
                  first) for name, (n, left, right), y, first in (
                      ("UP", upper, 0.0, 1), ("LOW", lower, -1.0, 501))]
    return write(path, without_unused_surfaces(
        [*parts[0], *parts[1], *material("UP"), *material("LOW"), "*SURFACE INTERACTION, NAME=I",
         f"*CONTACT PAIR, INTERACTION=I, NAME=C{pairing}", "UP.BOTTOM, LOW.TOP",
         "*STEP", "*STATIC", "0.5, 1.", "*BOUNDARY", "LOW.BOTTOM, 1, 2", f"UP.TOP, 1, 1, {slide!r}",
         "UP.TOP, 2, 2, -0.001", "*END STEP"]))


@pytest.mark.parametrize("kind", ["CPE4", "CPE8"])
@pytest.mark.parametrize(("columns", "pairing"), [
    (4, ""), (4, ", PAIRING=SURFACES"), (3, "")])
@pytest.mark.parametrize("slide", [0.3, -0.3])
def test_a_slave_that_leaves_the_end_of_the_master(tmp_path, kind, columns, pairing, slide):
    found = told(blocks(tmp_path / "d.inp", (4, 0, 4), (columns, 0, 4), slide, pairing, kind))
    assert "slides past the end of the master surface by 0." in found[2]
    assert math.isclose(found[0], 0.3, rel_tol=0.01)
    assert told(blocks(tmp_path / "s.inp", (4, 0, 4), (columns, 0, 4), slide / 10, pairing,
                       kind)) is None


@pytest.mark.parametrize(("columns", "slide", "limit"), [
    (4, 0.2, None), (4, 0.3, "0.25"), (40, 0.04, None), (40, 0.06, "5E-2")])
def test_a_slip_of_more_than_the_spacing_of_nodes(tmp_path, columns, slide, limit):
    """And of more than a twentieth of the length in contact, 1, however fine the mesh is."""
    found = told(blocks(tmp_path / "d.inp", (columns, 1, 2), (4 * columns, 0, 4), slide))
    assert (found is not None) == (limit is not None)
    if limit:
        assert "slides farther than the spacing of its nodes and a twentieth of the length in " \
            f"contact, {limit}" in found[2]


def test_a_rigid_plane_is_the_same_everywhere(tmp_path):
    """It neither ends nor deforms; one that ends where the slave slides past it is named."""
    for end, warns in ((9.0, False), (1.1, True)):
        path = write(
            tmp_path / "d.inp", without_unused_surfaces(
                [*mesh("UP", [0.0, 0.25, 0.5, 0.75, 1.0], [0.0, 1.0], "CPE4"), *material("UP"),
                 "*CONTACT PAIR, INTERACTION=I, NAME=C", "UP.BOTTOM, FLOOR"]),
            ["*NODE", "999, 0., -1.", "*SURFACE, NAME=FLOOR, TYPE=SEGMENTS",
             "START, -9., 0.", f"LINE, {end!r}, 0.",
             "*RIGID BODY, REF NODE=999, ANALYTICAL SURFACE=FLOOR", "*SURFACE INTERACTION, NAME=I",
             "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "999, 1, 6",
             "UP.TOP, 1, 1, 0.4", "UP.TOP, 2, 2, -0.001", "*END STEP"])
        found = told(path)
        assert (found is not None) == warns
        assert not warns or "past the end of the master" in found[2]


def test_hertz_is_within_the_theory(tmp_path):
    path = tmp_path / "hertz.inp"
    path.write_text(HERTZ.read_text())
    assert told(path) is None
