"""Friction through unloading and reloading: two blocks sheared to and fro are a Jenkin element.

With nu = 0 and the complementary shear on the vertical sides both blocks are in uniform shear, so that the top moves by
shear*height/G plus the slip of the faces, and every pair does what tests/reference/jenkin.py says.
"""

import sys

import h5py
import numpy as np
import pytest
from blocks import solid, write
from deck_runs import DECKS, solve
from test_patch import FACES, LOWER, MESH, UPPER, side_forces

sys.path.insert(0, str(DECKS.parent / "reference"))
from jenkin import loop_work, path  # noqa: E402

PRESSURE, YOUNG, FRICTION = 100.0, 1e4, 0.3
HEIGHT = UPPER[-1] - LOWER[0]
STIFFNESS = YOUNG / 2.0 / HEIGHT  # shear over displacement of the top
LIMIT = FRICTION * PRESSURE
ONSET = LIMIT / STIFFNESS
# Forward slip, partial unloading and reloading, reverse slip, forward slip again, a smaller closed loop without slip.
TURNS = [3.0, 1.5, 4.0, -4.0, 4.0, 2.2, 3.9]


def moves():
    """Return the displacement of the top at the end of every increment after the pressing."""
    ends = [0.0, *TURNS]
    parts = [np.linspace(a, b, round(abs(b - a) * 10) + 1)[1:]
             for a, b in zip(ends[:-1], ends[1:], strict=True)]
    return ONSET * np.concatenate(parts)


def table(name, values):
    """Return an amplitude on total time: 0 until the blocks are pressed at time 1, then the values."""
    points = [(0.0, 0.0), (1.0, 0.0), *((2.0 + k, v) for k, v in enumerate(values))]
    return [f"*AMPLITUDE, NAME={name}, TIME=TOTAL TIME", *(f"{t!r}, {v!r}" for t, v in points)]


def sheared(file, displacements, shears, friction=FRICTION):
    """Press the blocks in the first step, then move the top along; one increment a displacement."""
    sides = [card for name in ("UPPER", "LOWER") for side in ("LEFT", "RIGHT")
             for card in side_forces(name, side, 1.0)]
    return write(
        file, MESH, solid("UPPER", YOUNG, 0.0), solid("LOWER", YOUNG, 0.0),
        table("ASIDE", [float(u) for u in displacements]),
        table("SIDES", [float(s) for s in shears]),
        ["*SURFACE INTERACTION, NAME=FACES", "*FRICTION", f"{friction!r}, 1.E5"], FACES,
        ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "LOWER.BOTTOM, 1, 2, 0.",
         f"UPPER.TOP, 2, 2, {-PRESSURE * HEIGHT / YOUNG!r}", "UPPER.TOP, 1, 1, 0.", "*END STEP"],
        ["*STEP, INC=1000", "*STATIC", f"1., {len(displacements)}.", "*BOUNDARY, AMPLITUDE=ASIDE",
         "UPPER.TOP, 1, 1, 1.", "*CLOAD, AMPLITUDE=SIDES", *sides, "*END STEP"],
    )


def history(result, *names):
    """Return datasets of the contact from the end of the pressing on, one row an increment."""
    with h5py.File(result) as file:
        return [file[f"contact/FACE/{name}"][()] for name in names]


@pytest.fixture(scope="module")
def cycled(tmp_path_factory):
    """Return displacements, expected shear and slip, and the result of the whole history."""
    displacements = moves()
    shears, slips = path(displacements, STIFFNESS, LIMIT)
    deck = sheared(tmp_path_factory.mktemp("jenkin") / "jenkin.inp", displacements, shears)
    return displacements, np.array(shears), np.array(slips), solve(deck)


def test_shear_and_slip_follow_the_jenkin_element(cycled):
    displacements, shears, slips, result = cycled
    pressure, shear, slip, status = history(result, "pressure", "shear", "slip", "status")
    assert len(shear) == len(displacements) + 1
    np.testing.assert_allclose(pressure, PRESSURE, rtol=1e-9)
    expected = np.concatenate([[0.0], shears])[:, None] * np.ones(shear.shape[1])
    np.testing.assert_allclose(shear, -expected, rtol=0, atol=1e-8 * LIMIT)
    expected = np.concatenate([[0.0], slips])[:, None] * np.ones(shear.shape[1])
    np.testing.assert_allclose(slip, expected, rtol=0, atol=1e-8 * ONSET)
    slipped = np.abs(np.diff(slips, prepend=0.0)) > 1e-6 * ONSET
    assert 20 < slipped.sum() < len(slipped) - 20
    certain = slipped | (np.abs(shears) < LIMIT * (1 - 1e-6))  # where slip begins either will do
    expected = np.where(slipped, 1, 2)[:, None] * np.ones(status.shape[1])
    np.testing.assert_array_equal(status[1:][certain], expected[certain])


def test_loop_dissipates_what_friction_takes(cycled):
    """From +4 to -4 and back, in units of the onset of slip: work done, friction's share, closed form."""
    displacements, _, _, result = cycled
    shear_force, slip = history(result, "shear_force", "slip")
    first, last = np.flatnonzero(np.isclose(displacements, 4.0 * ONSET))
    force = -shear_force[1 + first : 2 + last]
    u = displacements[first : last + 1]
    lowest = np.argmin(u)
    assert u[lowest] == pytest.approx(-4.0 * ONSET)
    work = np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(u))
    rubbed = np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(slip[1 + first : 2 + last, 0]))
    assert work == pytest.approx(loop_work(4.0 * ONSET, STIFFNESS, LIMIT), rel=1e-8)
    assert rubbed == pytest.approx(work, rel=1e-8)
