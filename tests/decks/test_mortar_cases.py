"""Mortar points in the situations that node pairs are tested in, and decks that must be refused."""

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from deck_runs import run, solve, solve_as_written
from physics import material, mesh
from test_mortar_patch import EXACT, PRESSURE, contact, deck_of, even, joint

FLAT = ["LOW.BOTTOM, 2", "LOW.LEFT, 1", "UP.LEFT, 1"]


def blocks(kind="CPE8", **other):
    return joint(kind, even(0.0, 2.0, 5), even(0.0, 2.0, 4), **other)


@pytest.mark.parametrize("kind", ["CPE4", "CPE8"])
def test_friction_on_an_axis_of_symmetry_has_no_shear_there(tmp_path, kind):
    """The upper block spreads more than the lower one, and friction holds it back everywhere else."""
    cards = blocks(kind, poisson=0.4, friction=0.1)
    at = max(k for k, card in enumerate(cards) if card == "*ELASTIC")
    cards[at + 1] = "1e5, 0."
    found = contact(solve(deck_of(tmp_path / "axis.inp", cards, FLAT, "*DSLOAD",
                                  f"UP.TOP, P, {PRESSURE}")))
    assert found["shear"][0] == 0.0
    np.testing.assert_allclose(found["shear"][1:], np.sign(found["shear"][-1]) * 0.1
                               * found["pressure"][1:], rtol=1e-9)
    assert found["weight"] @ found["pressure"] == pytest.approx(2 * PRESSURE, rel=EXACT)


def test_clearance_replaces_the_gap_of_the_mesh(tmp_path):
    """Blocks of nu = 0 are pressed by a displacement: it closes the clearance, the rest strains."""
    cards = [*blocks(poisson=0.0), "*CLEARANCE, MASTER=LOW.TOP, SLAVE=UP.BOTTOM, VALUE=0.004"]
    found = contact(solve(deck_of(tmp_path / "clear.inp", cards,
                                  [*FLAT, "UP.TOP, 2, 2, -0.01"], increment="0.2, 1.")))
    np.testing.assert_allclose(found["pressure"], 1000.0 * 0.006 / 2.0, rtol=EXACT)


def test_contact_and_friction_alone_hold_a_block(tmp_path):
    """Without any support of its own it is pressed and pushed aside."""
    cards = blocks(friction=0.3, poisson=0.0)
    result = solve(deck_of(tmp_path / "held.inp", cards, ["LOW.BOTTOM, 1, 2"], "*DSLOAD",
                           f"UP.TOP, P, {PRESSURE}", "UP.LEFT, P, 0.5"))
    with h5py.File(result) as file:
        face = file["contact/C"]
        assert face["normal_force"][-1] == pytest.approx(2 * PRESSURE, rel=EXACT)
        assert abs(face["shear_force"][-1]) == pytest.approx(0.5, rel=EXACT)
        assert file["history/force_imbalance"][-1] < 1e-10


def test_a_block_that_nothing_holds_is_named(tmp_path):
    deck = deck_of(tmp_path / "loose.inp", blocks(), ["LOW.BOTTOM, 1, 2"], "*DSLOAD",
                   f"UP.LEFT, P, {PRESSURE}")
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 1
    assert ("error: step 1: body 1 (of UP, first node 1) can move along x: no *BOUNDARY and no contact "
            "holds it") in process.stderr


@pytest.mark.parametrize("kind", ["CPE4", "CPE8"])
def test_a_block_in_an_inner_corner_shares_a_node_between_two_interfaces(tmp_path, kind):
    """Pressed on floor and wall at once, both faces of one body and of sides that do not match."""
    cards = [*mesh("UP", even(0.0, 1.0, 5), even(0.0, 1.0, 5), kind, 1),
             *mesh("FLOOR", even(0.0, 1.0, 4), [-1.0, -0.5, 0.0], kind, 2001),
             *mesh("WALL", [-1.0, -0.5, 0.0], even(0.0, 1.0, 3), kind, 4001)]
    for body in ("UP", "FLOOR", "WALL"):
        cards += material(body, (1000.0, 0.0))
    cards += ["*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.3",
              "*CONTACT PAIR, INTERACTION=I, NAME=ONE, PAIRING=SURFACES", "UP.BOTTOM, FLOOR.TOP",
              "*CONTACT PAIR, INTERACTION=I, NAME=TWO, PAIRING=SURFACES", "UP.LEFT, WALL.RIGHT"]
    result = solve(deck_of(tmp_path / "corner.inp", cards, ["FLOOR.BOTTOM, 1, 2", "WALL.LEFT, 1, 2"],
                           "*DSLOAD", f"UP.TOP, P, {PRESSURE}", "UP.RIGHT, P, 3."))
    with h5py.File(result) as file:
        assert file["history/force_imbalance"][-1] < 1e-10
        one, two = (file[f"contact/{name}"] for name in ("ONE", "TWO"))
        down = one["normal_force"][-1] + abs(two["shear_force"][-1])
        aside = two["normal_force"][-1] + abs(one["shear_force"][-1])
    assert down == pytest.approx(PRESSURE, rel=1e-9)
    assert aside == pytest.approx(3.0, rel=1e-9)


def refused(path, cards):
    process = run("check", deck_of(path, cards, ["LOW.BOTTOM, 1, 2", "UP.TOP, 1, 2"]))
    assert process.returncode == 1
    return process.stderr


@pytest.mark.parametrize("kind", ["CPE4", "CPE8"])
def test_faces_that_no_mortar_point_fits_are_refused(tmp_path, kind):
    def with_pair(data):
        cards = blocks(kind)
        cards[-1] = data
        return cards

    path = tmp_path / "refused.inp"
    assert "error: a surface cannot be in contact with itself\nUP.BOTTOM, UP.BOTTOM" in refused(
        path, with_pair("UP.BOTTOM, UP.BOTTOM"))
    assert "surface UP.TOP looks away from the other one" in refused(path,
                                                                     with_pair("UP.TOP, LOW.TOP"))
    corner = with_pair("ROUND, LOW.TOP")
    at = next(k for k, card in enumerate(corner) if card.startswith("*SURFACE INTERACTION"))
    corner[at:at] = ["*SURFACE, NAME=ROUND", "1, S1", "1, S4"]
    assert "the slave surface ROUND goes round a corner at node 1:" in refused(path, corner)


@pytest.mark.parametrize("slave", ["UP", "LOW"])
@pytest.mark.parametrize("kind", ["CAX4", "CAX8"])
def test_heat_crosses_a_radial_gap_on_the_radius_midway(tmp_path, kind, slave):
    """A gas between cylinders with radii 1 and 1.1, which themselves do not resist: its conductance
    1/(0.1 + 0.9) is that of an area of radius 1.05."""
    cards = [*mesh("LOW", [0.5, 1.0], even(0.0, 1.0, 3), kind),
             *mesh("UP", [1.1, 2.0], even(0.0, 1.0, 2), kind, first=101),
             *(card for name in ("LOW", "UP")
               for card in material(name, (1e5, 0.0), 0.0, conductivity=1e9))]
    pair = ["UP.LEFT", "LOW.RIGHT"] if slave == "UP" else ["LOW.RIGHT", "UP.LEFT"]
    cards += ["*SURFACE INTERACTION, NAME=I", "*GAP LAW, TYPE=GAS", "1., 0.9",
              "*CONTACT PAIR, INTERACTION=I, NAME=C, PAIRING=SURFACES", ", ".join(pair),
              "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.",
              "*BOUNDARY", "LOW.BOTTOM, 2", "UP.BOTTOM, 2", "LOW.LEFT, 11, 11, 100.",
              "UP.RIGHT, 11, 11, 0.", "*END STEP"]
    with h5py.File(solve(write(tmp_path / "gap.inp", without_unused_surfaces(cards)))) as file:
        heat = file["contact/C/heat_rate"][-1] * (1 if slave == "LOW" else -1)
    assert heat == pytest.approx(2 * np.pi * 1.05 * 100.0, rel=1e-7)


@pytest.mark.parametrize("friction", ["*FRICTION\n50.", "*FRICTION, ROUGH"])
def test_a_ring_that_lifts_off_a_rough_base_has_uncertainties_in_time(tmp_path, friction):
    """A hot disc on mortar points dishes and lifts, but for its rim, which carries all of the load.

    Near the edge of contact points slip with next to no force; the finer mesh of the uncertainties failed.
    """
    xs = even(0.0, 2.0, 5)
    cards = [*mesh("LOW", xs, [0.0, 1.0], "CAX4"), *mesh("UP", xs, [1.0, 2.0], "CAX4", first=101),
             *material("LOW", (1e4, 0.3), conductivity=1.0),
             *material("UP", (1e3, 0.3), 1e-5, 1.0),
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LOW, 0.", "UP, 0.",
             "*SURFACE INTERACTION, NAME=I", *friction.split("\n"), "*GAP LAW, TYPE=GAS",
             "0.01, 0.01", "*GAP LAW, TYPE=POWER", "1., 1., 1.",
             "*CONTACT PAIR, INTERACTION=I, NAME=P, PAIRING=SURFACES", "UP.BOTTOM, LOW.TOP",
             "*BOUNDARY", "LOW.BOTTOM, 2", "LOW.LEFT, 1", "UP.LEFT, 1", "*REFINE, LEVELS=3", "*STEP",
             "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.25, 1.", "*BOUNDARY",
             "LOW.BOTTOM, 11, 11, 0.", "UP.TOP, 11, 11, 200.", "*DSLOAD", "UP.TOP, P, 0.5",
             "*END STEP"]
    result = solve_as_written(write(tmp_path / "ring.inp", without_unused_surfaces(cards)))
    with h5py.File(result) as file:
        assert file["contact/P/normal_force"][-1] == pytest.approx(np.pi * 4.0 * 0.5, rel=1e-9)
        uncertainty = file["uncertainty/P/normal_force"][-1][1]
        assert 0.0 < uncertainty < 0.1 * np.pi * 4.0 * 0.5
