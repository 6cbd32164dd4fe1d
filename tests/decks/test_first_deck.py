"""The deck at the beginning of docs/deck.md: it runs as it is printed, without a warning, and its
contact is that of three thermal resistances in series under a uniform pressure."""

import re
import textwrap

import h5py
import pytest
from deck_runs import DECKS, run

REFERENCE = DECKS.parents[1] / "docs" / "deck.md"
LENGTH, CONDUCTIVITY = 10.0, 0.05           # of each block
PRESSURE, HOT, COLD = 50.0, 200.0, 20.0
CONDUCTANCE = 2.0e-4 * PRESSURE


def test_the_deck_that_the_reference_begins_with_agrees_with_theory(tmp_path):
    deck = tmp_path / "joint.inp"
    _, cards, text = REFERENCE.read_text().split("```")[:3]
    check = re.search(r"\n((?:    .*\n)+)", text)[1]
    deck.write_text(cards.lstrip() + textwrap.dedent(check))
    done = run("run", deck, "--out", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 check passed, 0 failed" in done.stdout
    assert "warning" not in done.stdout + done.stderr
    flux = (HOT - COLD) / (2 * LENGTH / CONDUCTIVITY + 1 / CONDUCTANCE)
    with h5py.File(tmp_path / "joint.vtkhdf") as result:
        joint = result["contact/JOINT"]
        assert joint["pressure"][-1] == pytest.approx(PRESSURE, rel=1e-9)
        assert joint["heat_flux"][-1] == pytest.approx(flux, rel=1e-9)
        assert joint["slave_temperature"][-1] == pytest.approx(
            HOT - flux * LENGTH / CONDUCTIVITY, rel=1e-9)
        assert joint["heat_rate"][-1] == pytest.approx(flux * LENGTH, rel=1e-9)
