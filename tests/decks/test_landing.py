"""On which instants increments end, and which decks are refused before anything is solved."""

import h5py
import numpy as np
import pytest
from blocks import block, solid, write
from deck_runs import CYLINDER, copy_deck, run, solve
from physics import material, mesh

DIRECT = {", STEADY STATE, DIRECT": ", STEADY STATE", "20., 900.": "100., 900."}
CHECK = '*VERIFY, KIND=ANALYTIC, SOURCE="prescribed"'


def test_increments_land_on_the_times_of_verify_cards_and_return_to_their_multiples(tmp_path):
    deck = tmp_path / "cylinder.inp"
    copy_deck(CYLINDER, deck, [CHECK, "NT, TOP, 450., 450., 1.E-12"], DIRECT)
    text = deck.read_text()
    deck.write_text(text[: text.rindex("*END STEP")] + "*END STEP\n")
    with h5py.File(solve(deck)) as file:
        times = file["history/time"][()]
    np.testing.assert_allclose(times, [100, 200, 300, 400, 450, 500, 600, 700, 800, 900])


def test_a_deck_is_never_overwritten_by_its_own_results(tmp_path):
    for extension in (".lst", ".sta", ".cvg", ".vtkhdf"):
        deck = copy_deck(CYLINDER, tmp_path / f"deck{extension}")
        before = deck.read_bytes()
        process = run("run", deck, "--out", tmp_path)
        assert process.returncode == 1
        assert f'{deck.name}" would be written over' in process.stderr
        assert deck.read_bytes() == before


def test_two_nodes_paired_twice_are_refused_by_their_numbers(tmp_path):
    twice = ["*CONTACT PAIR, INTERACTION=FACES, NAME=AGAIN", "CURVED, FLAT"]
    process = run("check", copy_deck(CYLINDER, tmp_path / "twice.inp", twice))
    assert process.returncode == 1
    assert "nodes 1 and" in process.stderr
    assert "by an earlier *CONTACT PAIR already" in process.stderr
    assert "*CONTACT PAIR, INTERACTION=FACES, NAME=AGAIN" in process.stderr


@pytest.mark.parametrize(("timing", "corner", "ends"), [
    ("", 0.3, [0.3, 0.5, 1.0, 1.3, 1.5, 2.0, 2.5, 3.0]),
    ("", 1.3, [0.5, 1.0, 1.5, 2.0, 2.3, 2.5, 3.0]),
    (", TIME=TOTAL TIME", 0.3, [0.3, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0]),
    (", TIME=TOTAL TIME", 1.3, [0.5, 1.0, 1.3, 1.5, 2.0, 2.5, 3.0])])
def test_increments_land_on_the_corners_of_amplitudes_in_step_or_total_time(
        tmp_path, timing, corner, ends):
    """Steps of 1 and 2 in increments of 0.5."""
    deck = write(tmp_path / "corner.inp", block("BLOCK", [0.0, 1.0], [0.0, 1.0]),
                 solid("BLOCK", 1000.0, 0.0), [
        f"*AMPLITUDE, NAME=TENT{timing}", f"0., 0., {corner}, 1., 3., 0.",
        "*BOUNDARY", "BLOCK.BOTTOM, 1, 2",
        "*STEP", "*STATIC", "0.5, 1.", "*DLOAD, AMPLITUDE=TENT", "1, P3, 1.", "*END STEP",
        "*STEP", "*STATIC", "0.5, 2.", "*END STEP"])
    with h5py.File(solve(deck)) as file:
        np.testing.assert_allclose(file["history/time"], ends, rtol=1e-12)


@pytest.mark.parametrize("timing", ["", ", TIME=TOTAL TIME"])
@pytest.mark.parametrize("width", [1e-3, 4e-4, 1e-5])
@pytest.mark.parametrize("where", [0.0, 500.0, "end"])
def test_the_heat_of_a_pulse_arrives_however_short_it_is(tmp_path, timing, width, where):
    """Without diffusion in the way: all of the body has the heat of the pulse, 0.5, at the end. It
    rises and falls in the second of two steps of 1000, which begins with increments of 1."""
    start = 1000.0 - width if where == "end" else where
    times = [start, start + width / 2, start + width]
    if timing:
        times = [1000.0 + time for time in times]
    corners = ", ".join(f"{time!r}, {factor}" for time, factor in zip(times, (0, 1, 0), strict=True))
    deck = write(tmp_path / "pulse.inp", mesh("BODY", [0.0, 1.0], [0.0, 1.0, 2.0], "CPE4"),
                 material("BODY", conductivity=1.0, density=1.0, specific_heat=1.0), [
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.", f"*AMPLITUDE, NAME=PULSE{timing}",
        corners, "*STEP, INC=1000", "*HEAT TRANSFER", "1., 1000.", "*END STEP",
        "*STEP, INC=1000", "*HEAT TRANSFER", "1., 1000.", "*DFLUX, AMPLITUDE=PULSE",
        f"BODY, BF, {1.0 / width!r}", "*END STEP"])
    with h5py.File(solve(deck)) as file:
        found = file["VTKHDF/PointData/temperature"][-6:]
        np.testing.assert_allclose(found, 0.5, rtol=1e-6)
        for time in times:
            total = time if timing else time + 1000.0
            assert np.abs(file["history/time"][()] - total).min() <= 1e-12 * total
