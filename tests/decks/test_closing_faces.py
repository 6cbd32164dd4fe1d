"""Flat faces that close over a gap as a whole: uniform pressure and no shear, whatever the mesh."""

import numpy as np
import pytest
from deck_runs import pairs
from physics import judge, material, mesh

GAP, MOVED, FORCE = 1e-3, -1.5e-3, 10.0
STIFF, SOFT = 2e5, 1e5
# Two blocks of height 1 take up what is left of the motion.
HELD = (-MOVED - GAP) / (1 / STIFF + 1 / SOFT)

# Elements, pairing, sides of a face and increments.
CASES = [(kind, pairing, *rest) for kind, pairing, rest in pairs(
    ("CPE4", "CPE4I", "CPE8", "CAX4", "CAX8", "CPE3", "CPE6"), ("NODES", "SURFACES"),
    ((1, 1), (4, 3), (1, 3), (4, 1)))]


def blocks(kind, pairing, sides, tilt=0.0):
    """Return the cards of two blocks with Poisson's ratio 0 and a gap that grows along the face."""
    xs = np.linspace(0, 1, sides + 1)
    return [*mesh("LOW", xs, [-1.0, 0.0], kind),
            *mesh("UP", xs, [GAP, 1 + GAP], kind, first=1001, to=lambda x, y: (x, y + tilt * x)),
            *material("LOW", (STIFF, 0.0)), *material("UP", (SOFT, 0.0)),
            "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.3",
            f"*CONTACT PAIR, INTERACTION=I, NAME=F, PAIRING={pairing}", "UP.BOTTOM, LOW.TOP",
            "*BOUNDARY", "LOW.BOTTOM, 2", "LOW.LEFT, 1", "UP.LEFT, 1"]


def static(increments, *cards):
    """Return the cards of a mechanical step of increments of one size."""
    return ["*STEP, INC=100", "*STATIC", f"{1 / increments!r}, 1.", *cards, "*END STEP"]


def uniform(pressure):
    """Return the checks of a uniform pressure without shear."""
    return [("shear", "F", "LAST", 0.0, 1e-9 * pressure, "ABS"),
            ("shear_force", "F", "LAST", 0.0, 1e-9 * pressure, "ABS"),
            ("pressure", "F", "LAST", pressure, 1e-9)]


@pytest.mark.parametrize(("kind", "pairing", "sides", "increments"), CASES)
def test_a_face_that_a_force_closes_has_no_shear(tmp_path, kind, pairing, sides, increments):
    """Nothing but contact holds the upper block along the normal."""
    cards = blocks(kind, pairing, sides)
    cards += static(increments, "*DSLOAD", f"UP.TOP, P, {FORCE!r}")
    judge(tmp_path, cards, uniform(FORCE))


@pytest.mark.parametrize(("kind", "pairing", "sides", "increments"), CASES)
def test_a_face_that_a_motion_closes_has_no_shear(tmp_path, kind, pairing, sides, increments):
    """The points close within an increment, opened and closed once more too."""
    cards = blocks(kind, pairing, sides)
    for motion in (MOVED, 0.0, MOVED):
        cards += static(increments, "*BOUNDARY", f"UP.TOP, 2, 2, {motion!r}")
    judge(tmp_path, cards, uniform(HELD))


@pytest.mark.parametrize("tilt", [1e-17, 1e-13, 1e-11])
@pytest.mark.parametrize("closing", ["force", "motion"])
def test_a_face_tilted_by_next_to_nothing_has_next_to_no_shear(tmp_path, closing, tilt):
    """The points close one after the other, and the state goes continuously with the tilt."""
    cards = blocks("CPE4", "NODES", 4, tilt)
    load = (["*DSLOAD", f"UP.TOP, P, {FORCE!r}"] if closing == "force"
            else ["*BOUNDARY", f"UP.TOP, 2, 2, {MOVED!r}"])
    pressure = FORCE if closing == "force" else HELD
    judge(tmp_path, cards + static(1, *load), [
        ("shear", "F", "LAST", 0.0, 1e-5 * pressure, "ABS"),
        ("pressure", "F", "LAST", pressure, 1e-5)])
