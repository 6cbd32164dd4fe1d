"""Runs of the program on decks and on changed copies of them, for the tests here."""

import os
import re
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

PROGRAM = os.environ.get("THERCON", "thercon")
DECKS = Path(__file__).resolve().parent
INPUT = DECKS.parents[1] / "input"
CYLINDER = INPUT / "cylinder" / "cylinder.inp"
COUPLED = INPUT / "cylinder" / "cylinder-coupled.inp"
HERTZ = INPUT / "hertz" / "hertz.inp"
PATIENCE = 600.0   # seconds after which a run hangs, whatever the build and the load of the machine
OWN_MESH = "** On this mesh"   # begins the checks of CYLINDER that hold on no other
# A program for finding faults is larger, and has guards and shadows of what it allocates.
of_release = pytest.mark.skipif(os.environ.get("THERCON_BUILD_TYPE", "Release") != "Release",
                                reason="memory is that of the optimised program")


def run(*arguments, folder=None, seconds=PATIENCE):
    """Run the program with these arguments, in a folder; return the finished process."""
    command = [PROGRAM, *map(str, arguments)]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=seconds)


def solve_as_written(deck, *arguments, status=0, seconds=PATIENCE):
    """Solve a deck, results beside it, with the exit status given; return the result file."""
    process = run("run", "--quiet", deck, "--out", deck.parent, *arguments, seconds=seconds)
    assert process.returncode == status, process.stderr
    return deck.with_suffix(".vtkhdf")


def solve(deck, *arguments, **more):
    """Solve a deck without uncertainties unless it asks for them; return the result file."""
    return solve_as_written(deck, *arguments, *no_uncertainties(deck), **more)


def no_uncertainties(deck):
    """Return arguments of a run without uncertainties, which change no other number
    (test_companion_runs.py) and take half of the time; none for a deck that asks for them."""
    return () if "ERRORS=" in deck.read_text() else ("--errors", "no")


def copy_deck(source, target, cards=(), changes=()):
    """Write a copy of a deck with more cards before its first *STEP and some texts, each of which
    stands in it, replaced; return its path. Refined, it loses the checks of its own mesh."""
    text = source.read_text()
    if any(card.upper().startswith("*REFINE") for card in cards):
        text = text.split(OWN_MESH)[0]
    for old, new in dict(changes).items():
        assert old in text, old
        text = text.replace(old, new)
    more = "".join(card + "\n" for card in cards)
    target.write_text(re.sub(r"^\*STEP", more + "*STEP", text, count=1, flags=re.M | re.I))
    return target


def pairs(first, second, third):
    """Return combinations of three lists: all pairs of the first two, each with one of the third, which
    changes with both."""
    return [(a, b, third[(i + j) % len(third)]) for i, a in enumerate(first) for j, b in enumerate(second)]


def data_cards(deck, keyword):
    """Return the fields of the data cards of every card with a keyword, in one list."""
    rows, inside = [], False
    for line in deck.read_text().splitlines():
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            inside = line.split(",")[0].strip().upper() == keyword
        elif inside:
            rows.append([field.strip() for field in line.split(",")])
    return rows


def datasets(result, *groups):
    """Return all numeric datasets of these groups of a result file by their names."""
    found = {}
    with h5py.File(result) as file:

        def keep(name, item):
            if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu":
                found[name] = item[()]

        for group in groups:
            file[group].visititems(lambda name, item, group=group: keep(f"{group}/{name}", item))
    return found


def assert_alike(one, other, tolerance):
    """Assert that datasets of equal names agree to a fraction of the largest value of each."""
    assert one.keys() == other.keys()
    for name, values in one.items():
        scale = np.nanmax(np.abs(values), initial=0.0)
        np.testing.assert_allclose(
            other[name], values, rtol=0.0, atol=tolerance * scale, err_msg=name
        )
