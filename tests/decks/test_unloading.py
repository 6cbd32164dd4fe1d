"""Bodies that touch in the mesh, under loads that start smoothly or return to nothing: no force is
left but what rounding of the coordinates makes of the stiffness."""

import sys

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from deck_runs import solve
from physics import material, mesh
from test_mortar_patch import even

YOUNG, FRICTION = 2.1e5, 0.3
WIDTH, FACE = 1.3, 0.7   # of the blocks; their interface, of no exact binary fraction
LOWER = ["LOW.BOTTOM, 1, 2"]
DIE = ["*NODE, NSET=REF", "9000, 0.3, 0.", "*SURFACE, TYPE=SEGMENTS, NAME=DIE", "START, 0., 0.7",
       "LINE, 7., 0.7", "*RIGID BODY, REF NODE=9000, ANALYTICAL SURFACE=DIE"]
# Loads and their histories, which end at nothing
RISE_AND_FALL = "*AMPLITUDE, NAME=A\n0., 0., 1., 1., 2., 0."
SMOOTH = "*AMPLITUDE, NAME=A, DEFINITION=SMOOTH STEP\n0., 0., 1., 1., 2., 0."
REVERSAL = "*AMPLITUDE, NAME=A\n0., 0., 0.5, 1., 1., 0., 1.5, -0.7, 2., 0."
ALLOWED = "*AMPLITUDE, NAME=A\n0., 1., 1., 0., 2., 1."
MOVED = ["*BOUNDARY, AMPLITUDE=A", "UP.TOP, 2, 2, -1.E-4"]
PRESSED = ["*DSLOAD, AMPLITUDE=A", "UP.TOP, P, 17."]
WARMED = ["*BOUNDARY", "UP.TOP, 2", "*TEMPERATURE, AMPLITUDE=A", "EVERY, 30."]
FITTED = ["*BOUNDARY", "UP.TOP, 2", "*CONTACT INTERFERENCE, AMPLITUDE=A", "UP.BOTTOM, LOW.TOP, 1.E-4"]
WAYS = {"moved": (RISE_AND_FALL, MOVED), "moved back and forth": (REVERSAL, MOVED),
        "pressed smoothly": (SMOOTH, PRESSED), "warmed smoothly": (SMOOTH, WARMED),
        "fitted": (ALLOWED, FITTED)}


def stack(kind, sides, master):
    """Return two blocks, or one on a drawing, that touch: cards and supports."""
    left = 0.5 if kind.startswith("CAX") else 0.0
    cards = mesh("UP", even(left, left + WIDTH, sides[0]), [FACE, 1.1, 1.9], kind)
    cards += material("UP", (YOUNG, 0.3), 1e-5)
    if master == "DIE":
        return [*cards, *DIE, "*NSET, NSET=EVERY", "UP"], ["9000, 1, 2", "9000, 6"]
    cards += mesh("LOW", even(left, left + WIDTH, sides[1]), [0.0, 0.4, FACE], kind, 5001)
    return [*cards, *material("LOW", (0.3 * YOUNG, 0.2), 1e-5), "*NSET, NSET=EVERY", "UP, LOW"], LOWER


def run(path, cards, supports, load, pairing="SURFACES", friction=None, master="LOW.TOP"):
    """Solve two units of time in increments of a quarter; return the normal force over time."""
    pair = ["*SURFACE INTERACTION, NAME=I", *(["*FRICTION", str(friction)] if friction else []),
            f"*CONTACT PAIR, INTERACTION=I, NAME=C, PAIRING={pairing}", f"UP.BOTTOM, {master}"]
    step = ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "EVERY, 0.", "*STEP", "*STATIC", "0.25, 2.",
            "*BOUNDARY", *supports, *load, "*END STEP"]
    deck = write(path, ["*OPTIONS, ERRORS=NO"], without_unused_surfaces([*cards, *pair, *step]))
    with h5py.File(solve(deck)) as file:
        return file["contact/C/normal_force"][()]


def rounding(points):
    """Return the force that some units in the last place of the largest coordinate make at each
    contact point of the largest, on a whole circumference."""
    return points * 4 * sys.float_info.epsilon * 1.9 * YOUNG * 2 * np.pi * 1.8


@pytest.mark.parametrize("friction", [None, FRICTION])
@pytest.mark.parametrize("kind", ["CPE4", "CPE8", "CPS8", "CAX4", "CAX8"])
@pytest.mark.parametrize(("way", "master"), [*((way, "LOW.TOP") for way in WAYS), ("moved", "DIE"),
                                             ("pressed smoothly", "DIE"), ("warmed smoothly", "DIE")])
def test_faces_that_touch_are_released_to_no_force(tmp_path, kind, way, master, friction):
    history, load = WAYS[way]
    cards, supports = stack(kind, (4, 3), master)
    supports = [*supports, *([] if kind.startswith("CAX") else ["UP.TOP, 1"])]
    if way == "fitted":
        cards += ["*CLEARANCE, SLAVE=UP.BOTTOM, MASTER=LOW.TOP, VALUE=-1.E-4"]
    force = run(tmp_path / "released.inp", [*cards, *history.splitlines()], supports, load,
                friction=friction, master=master)
    assert force.max() > 1.0
    assert abs(force[-1]) <= rounding(5)


def test_faces_that_match_bear_what_node_pairs_bear(tmp_path):
    """Of elements with straight sides both pairings have the same conditions."""
    history, load = WAYS["moved back and forth"]
    cards, supports = stack("CPE4", (4, 4), "LOW.TOP")
    cards += history.splitlines()
    forces = [run(tmp_path / f"{pairing}.inp", cards, [*supports, "UP.TOP, 1"], load, pairing)
              for pairing in ("SURFACES", "NODES")]
    np.testing.assert_allclose(*forces, rtol=1e-9, atol=rounding(5))


@pytest.mark.parametrize("gap", [0.0, 0.2])
@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize("master", ["LOW.TOP", "DIE"])
def test_two_contact_points_alone_hold_a_block_and_let_it_go(tmp_path, master, pairing, gap):
    """Nothing strains where they move it: each force follows from the load."""
    up = mesh("UP", [0.0, WIDTH], [FACE + gap, 1.9], "CPE4") + material("UP", (YOUNG, 0.3))
    cards, supports = ([*up, *DIE], ["9000, 1, 2", "9000, 6"]) if master == "DIE" else (
        [*up, *mesh("LOW", [0.0, WIDTH], [0.0, FACE], "CPE4", 5001),
         *material("LOW", (YOUNG, 0.3))], LOWER)
    force = run(tmp_path / "held.inp", [*cards, "*NSET, NSET=EVERY", "UP", *SMOOTH.splitlines()],
                [*supports, "UP.TOP, 1"], PRESSED, pairing, master=master)
    at = np.concatenate([np.arange(1, 5), np.arange(3, -1, -1)]) / 4   # of the rise
    np.testing.assert_allclose(force, 17.0 * WIDTH * at**3 * (10 - 15 * at + 6 * at**2),
                               rtol=1e-9, atol=rounding(2))
