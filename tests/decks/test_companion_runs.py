"""Error estimates solve companion runs beside a run. They read it and change nothing of it: with
and without them all results are equal bit for bit."""

import itertools
import shutil

import numpy as np
import pytest
from deck_runs import INPUT, copy_deck, datasets, solve

SCHEMES = ["IMPLICIT", "GALERKIN", "CRANK-NICOLSON", "EXPLICIT"]
BRAKE_PAD = INPUT / "examples" / "brake_pad.inp"
COUPLED_STEP = "*STEP\n*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE\n"


def assert_equal_results(deck, cards=()):
    """Assert that a deck has the same histories with error estimates and without."""
    results = []
    for errors, changes in (("YES", {}), ("NO", {"*OPTIONS,": "*OPTIONS, ERRORS=NO,"})):
        folder = deck.parents[1] / errors
        shutil.copytree(deck.parent, folder)
        if changes and "*OPTIONS," not in deck.read_text():
            cards, changes = ["*OPTIONS, ERRORS=NO", *cards], {}
        copy = copy_deck(deck, folder / "changed.inp", cards, changes)
        results.append(datasets(solve(copy), "history", "contact"))
    assert results[0].keys() == results[1].keys()
    for name, values in results[0].items():
        np.testing.assert_array_equal(values, results[1][name], err_msg=name)


def copy_without_checks(source, folder, more=""):
    """Copy a deck and the files beside it, its checks replaced by more steps; return its path."""
    deck = shutil.copytree(source.parent, folder / "deck") / "deck.inp"
    deck.write_text(source.read_text().split("*VERIFY")[0] + more)
    return deck


@pytest.mark.parametrize("deck", sorted(deck for deck in INPUT.glob("**/*.inp") if "ERRORS=NO" not in deck.read_text()),
    ids=lambda deck: deck.stem)
def test_estimates_change_no_digit_of_a_deck(tmp_path, deck):
    folder = shutil.copytree(deck.parent, tmp_path / "deck")
    assert_equal_results(folder / deck.name)


@pytest.mark.parametrize(("name", "scheme"), [
    ("examples/fuel_pellet", "GALERKIN"), *itertools.product(["cylinder/cylinder-coupled", "rods/r1"], SCHEMES)])
def test_estimates_change_no_digit_with_any_scheme(tmp_path, name, scheme):
    deck = copy_without_checks(INPUT / f"{name}.inp", tmp_path)
    assert_equal_results(deck, [f"*THERMAL SCHEME, TYPE={scheme}"])


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("films", ["ramped", "at once"])
def test_estimates_change_no_digit_with_films(tmp_path, films, scheme):
    """Films that begin at once are other ones in increments of twice the size; the others grow in
    one step, end in the last and stay in between."""
    more = COUPLED_STEP + "0.25, 1.\n*DFLUX\nAHEAD, S3, 0.7\n*END STEP\n" + \
        COUPLED_STEP + "0.25, 1.\n*FILM, OP=NEW\nDISCBACK, F1, 20., 5.E-3\n*END STEP\n"
    deck = copy_without_checks(BRAKE_PAD, tmp_path, more)
    cards = [f"*THERMAL SCHEME, TYPE={scheme}"]
    if films == "at once":
        deck.write_text(deck.read_text().replace("*FILM\n", "*FILM, FILM AMPLITUDE=ON\n"))
        cards += ["*AMPLITUDE, NAME=ON", "0., 1., 1., 1."]
    assert_equal_results(deck, cards)
