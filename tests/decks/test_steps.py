"""Steps, ramps and amplitudes on a block that answers in proportion to its load."""

import h5py
import numpy as np
import pytest
from blocks import block, solid, without_unused_surfaces, write
from deck_runs import solve
from physics import material, mesh

YOUNG, HEIGHT, PRESSURE = 1000.0, 2.0, 4.0
SHORTENS = PRESSURE * HEIGHT / YOUNG  # nu = 0
BLOCK = [*block("BLOCK", [0.0, 1.0], [0.0, 0.5, HEIGHT]), *solid("BLOCK", YOUNG, 0.0)]
HELD = ["*BOUNDARY", "BLOCK.BOTTOM, 2, 2, 0.", "BLOCK.LEFT, 1, 1, 0."]


def step(increment, period, pressure, step_card="*STEP", load_card="*DLOAD"):
    """Return the cards of a step that brings the pressure on top to a value."""
    return [step_card, "*STATIC", f"{increment}, {period}", load_card, f"2, P3, {pressure}",
            "*END STEP"]


def answer(result):
    """Return the times, and the motion of the top downwards over that under the full pressure."""
    with h5py.File(result) as file:
        data = file["VTKHDF"]
        times = file["history/time"][()]
        count = len(data["PointData/node_id"])
        top = np.isclose(data["Points"][()][-count:, 1], HEIGHT)
        down = -data["PointData/displacement"][()].reshape(len(times), count, 3)[:, top, 1]
    np.testing.assert_allclose(down, down[:, :1] * np.ones(down.shape[1]), rtol=0, atol=1e-14)
    return times, down[:, 0] / SHORTENS


def test_loads_ramp_from_their_last_value_in_every_step(tmp_path):
    deck = write(tmp_path / "steps.inp", BLOCK, HELD, step(0.5, 1.0, PRESSURE),
                 step(0.5, 2.0, -PRESSURE), ["*STEP", "*STATIC", "1., 1.", "*END STEP"],
                 step(1.0, 1.0, 0.0))
    times, down = answer(solve(deck))
    np.testing.assert_allclose(times, [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0], rtol=1e-13)
    expected = [0.5, 1.0, 0.5, 0.0, -0.5, -1.0, -1.0, 0.0]
    np.testing.assert_allclose(down, expected, rtol=0, atol=1e-12)


def test_last_increment_of_a_step_ends_it(tmp_path):
    deck = write(tmp_path / "rest.inp", BLOCK, HELD, step(0.4, 1.0, PRESSURE))
    times, down = answer(solve(deck))
    np.testing.assert_allclose(times, [0.4, 0.8, 1.0], rtol=1e-13)
    np.testing.assert_allclose(down, [0.4, 0.8, 1.0], rtol=1e-12)


def test_amplitude_of_the_step_may_be_a_jump(tmp_path):
    cards = step(0.25, 0.5, PRESSURE, "*STEP, AMPLITUDE=STEP")
    times, down = answer(solve(write(tmp_path / "jump.inp", BLOCK, HELD, cards)))
    np.testing.assert_allclose(times, [0.25, 0.5], rtol=1e-13)
    np.testing.assert_allclose(down, [1.0, 1.0], rtol=1e-12)


@pytest.mark.parametrize(
    ("timing", "second"), [("", [0.5, 1.0, 0.75, 0.5]), (", TIME=TOTAL TIME", [0.5, 0.5, 0.5, 0.5])]
)
def test_amplitude_follows_step_or_total_time(tmp_path, timing, second):
    """A table holds its end value."""
    amplitude = [f"*AMPLITUDE, NAME=TENT{timing}", "0., 0., 0.5, 1., 1., 0.5"]
    cards = [card for _ in range(2)
             for card in step(0.25, 1.0, PRESSURE, load_card="*DLOAD, AMPLITUDE=TENT")]
    times, down = answer(solve(write(tmp_path / "tent.inp", BLOCK, amplitude, HELD, cards)))
    np.testing.assert_allclose(times, 0.25 * np.arange(1, 9), rtol=1e-13)
    np.testing.assert_allclose(down, [0.5, 1.0, 0.75, 0.5, *second], rtol=1e-12)


def test_a_prescribed_displacement_ramps_too(tmp_path):
    cards = ["*STEP", "*STATIC", "0.25, 1.", "*BOUNDARY", f"BLOCK.TOP, 2, 2, {-SHORTENS}",
             "*END STEP"]
    times, down = answer(solve(write(tmp_path / "pushed.inp", BLOCK, HELD, cards)))
    np.testing.assert_allclose(down, times, rtol=1e-12)


def test_nodes_on_the_axis_stay_there_when_new_supports_end_all_others(tmp_path):
    """Heat near the axis of a disc pulls these nodes along the radius."""
    cards = [*mesh("DISC", [0.0, 1.0, 2.0], [0.0, 1.0], "CAX4"),
             *material("DISC", (YOUNG, 0.3), expansion=1e-3)]
    held = ["*BOUNDARY, OP=NEW", "DISC.BOTTOM, 2"]
    deck = write(tmp_path / "disc.inp", without_unused_surfaces(cards),
                 ["*STEP", "*STATIC", "1., 1.", *held, "*TEMPERATURE", "DISC.LEFT, 50.",
                  "*END STEP", "*STEP", "*STATIC", "1., 1.", *held, "*END STEP"])
    with h5py.File(solve(deck)) as file:
        radius = file["VTKHDF/Points"][()][:, 0]
        first, second = file["VTKHDF/PointData/displacement"][()].reshape(2, len(radius), 3)
    assert np.all(first[radius > 0.0, 0] > 1e-3)
    assert np.all(second[radius == 0.0, 0] == 0.0)
    np.testing.assert_allclose(second, first, rtol=0.0, atol=1e-12)
