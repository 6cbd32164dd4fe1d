"""The deck of README.md: it runs as it is printed, without a warning, and its contact is that of three
thermal resistances in series under a uniform pressure."""

import h5py
import pytest
from deck_runs import DECKS, run

README = DECKS.parents[1] / "README.md"
LENGTH, CONDUCTIVITY = 10.0, 0.05           # of each block
PRESSURE, HOT, COLD = 50.0, 200.0, 20.0
CONDUCTANCE = 2.0e-4 * PRESSURE


def test_the_deck_of_the_readme_agrees_with_theory(tmp_path):
    deck = tmp_path / "joint.inp"
    deck.write_text(README.read_text().split("```")[1].lstrip())
    done = run("run", deck, "--out", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "warning" not in done.stdout + done.stderr
    flux = (HOT - COLD) / (2 * LENGTH / CONDUCTIVITY + 1 / CONDUCTANCE)
    with h5py.File(tmp_path / "joint.vtkhdf") as result:
        joint = result["contact/JOINT"]
        assert joint["pressure"][-1] == pytest.approx(PRESSURE, rel=1e-9)
        assert joint["heat_flux"][-1] == pytest.approx(flux, rel=1e-9)
        assert joint["slave_temperature"][-1] == pytest.approx(
            HOT - flux * LENGTH / CONDUCTIVITY, rel=1e-9)
        assert joint["heat_rate"][-1] == pytest.approx(flux * LENGTH, rel=1e-9)
