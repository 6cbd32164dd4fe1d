"""Decks as other programs write them run unchanged."""

import pytest
from deck_runs import DECKS, run
from physics import judge

FOREIGN = DECKS / "foreign"


def cards_of(name):
    """Return the cards of a deck of the folder `foreign`."""
    return (FOREIGN / name).read_text().splitlines()


def pressed_and_heated():
    """Return what is known of two blocks of height 2 and width 2 between smooth walls, E = 1000,
    nu = 0, K = 10, pressed by 20 and heated from 0 to 100: a closed contact with 5 + 0.2 p."""
    flux = 100.0 / (2.0 / 10.0 + 1.0 / (5.0 + 0.2 * 20.0) + 2.0 / 10.0)
    lower, upper = flux * 0.2, 100.0 - flux * 0.2
    mean = (lower / 2.0 + (upper + 100.0) / 2.0) / 2.0
    return [("pressure", "Slave", "LAST", 20.0, 1e-9),
            ("heat_rate", "Slave", "LAST", 2.0 * flux, 1e-9),
            ("slave_temperature", "Slave", "LAST", upper, 1e-9),
            ("U2", "Top", "LAST", 4.0 * (1e-5 * mean - 20.0 / 1000.0), 1e-9),
            ("NT", "Top", 0.5, 50.0, 1e-12)]


def test_a_flat_deck_of_abaqus_cae(tmp_path):
    judge(tmp_path, cards_of("abaqus_cae_flat.inp"), pressed_and_heated())


@pytest.mark.parametrize("name", sorted(path.name for path in FOREIGN.glob("*.inp")))
def test_it_is_sound_as_it_is(name):
    process = run("check", FOREIGN / name)
    assert process.returncode == 0, process.stderr
    assert "error" not in process.stderr
