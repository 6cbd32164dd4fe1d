"""Numerical uncertainties solve companion runs beside a run. They read it and change nothing of it:
with and without them all results are equal bit for bit, and messages to the letter."""

import re
import shutil

import numpy as np
import pytest
from deck_runs import CYLINDER, INPUT, copy_deck, datasets, run

SCHEMES = ["IMPLICIT", "GALERKIN", "CRANK-NICOLSON", "EXPLICIT"]
EXAMPLES = INPUT / "examples"
BRAKE_PAD = EXAMPLES / "brake_pad.inp"
COUPLED_STEP = "*STEP\n*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE\n"


def assert_equal_results(deck, cards=(), errors="last"):
    """Assert that a deck has the same results with uncertainties and without."""
    results, messages = [], []
    for word in (errors, "no"):
        folder = shutil.copytree(deck.parent, deck.parents[1] / word)
        copy = copy_deck(deck, folder / "changed.inp", cards)
        process = run("run", "--quiet", copy, "--out", folder, "--errors", word)
        assert process.returncode == 0, process.stderr
        messages.append(process.stderr.replace(str(folder), ""))
        results.append(copy.with_suffix(".vtkhdf"))
    assert messages[0] == messages[1]
    assert_equal_numbers(*results)


def assert_equal_numbers(*results):
    """Assert that two results are equal bit for bit."""
    one, other = (datasets(result, "history", "contact", "VTKHDF") for result in results)
    assert one.keys() == other.keys()
    for name, values in one.items():
        np.testing.assert_array_equal(values, other[name], err_msg=name)


def copy_without_checks(source, folder, more=""):
    """Copy a deck and the files beside it, its checks replaced by more steps; return its path."""
    deck = shutil.copytree(source.parent, folder / "deck") / "deck.inp"
    deck.write_text(source.read_text().split("*VERIFY")[0] + more)
    return deck


def is_estimated(deck):
    """Return whether the last increment alone tells something: the deck stores no heat, and so on."""
    return not re.search(r"ERRORS=NO|^\*SPECIFIC HEAT|^\*PRE-TENSION", deck.read_text(), re.M)


@pytest.mark.parametrize("deck", sorted(deck for deck in INPUT.glob("**/*.inp")
                                        if is_estimated(deck) and deck.parent != EXAMPLES),
                         ids=lambda deck: deck.stem)
def test_estimates_change_no_digit_of_a_deck(tmp_path, deck):
    """Of the examples test_physics_examples.py has the results without uncertainties."""
    folder = shutil.copytree(deck.parent, tmp_path / "deck")
    assert_equal_results(folder / deck.name)


@pytest.mark.parametrize("deck", [CYLINDER, EXAMPLES / "warm_blocks.inp"],
                         ids=lambda deck: deck.stem)
def test_a_complete_finer_run_changes_no_digit_of_a_deck(tmp_path, deck):
    """Also where increments of a transient follow its own error."""
    folder = shutil.copytree(deck.parent, tmp_path / "deck")
    assert_equal_results(folder / deck.name, errors="full")


@pytest.mark.parametrize(("name", "scheme"), [
    ("cylinder/cylinder-coupled", "CRANK-NICOLSON"), *(("rods/r1", scheme) for scheme in SCHEMES)])
def test_estimates_change_no_digit_with_any_scheme(tmp_path, name, scheme):
    deck = copy_without_checks(INPUT / f"{name}.inp", tmp_path)
    assert_equal_results(deck, [f"*THERMAL SCHEME, TYPE={scheme}"])


@pytest.mark.parametrize(("films", "scheme"), [
    *(("ramped", scheme) for scheme in SCHEMES), ("at once", "GALERKIN")])
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
