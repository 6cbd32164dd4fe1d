"""Decks that are changed at random, and elements whose nodes are missing: no crash, no hang, no status 0
with values that are no numbers, no failure without a word.

100 checks and 20 runs here; THERCON_FUZZ=N tries N of each, from seed THERCON_FUZZ_FIRST on.
"""

import os

import pytest
from deck_runs import run
from mutated_decks import mutated, outcome, types
from test_broken_names import MESH, MODEL, NUMBER, STEP

FIRST = int(os.environ.get("THERCON_FUZZ_FIRST", "0"))
SECTION = "*SOLID SECTION, ELSET=X, MATERIAL=M\n"
BODY = "*RIGID BODY, ELSET=X, REF NODE=1\n"
CARDS = {"R2D2": BODY, "RAX2": BODY, "T3D2": "", "T3D3": "", "SPRINGA": "*SPRING, ELSET=X\n1.\n",
         "SPRING1": "*SPRING, ELSET=X\n1\n1.\n", "SPRING2": "*SPRING, ELSET=X\n1, 1\n1.\n"}
USES = ("", "*SURFACE, NAME=X\nX, S1\n", "*NSET, NSET=X, ELSET=X\n", "*REFINE, LEVELS=1\n",
        "*OPTIONS, ORDER=1\n")


@pytest.mark.parametrize(("command", "decks"), [("check", 100), ("run", 20)])
def test_a_changed_deck_ends_in_words(tmp_path, command, decks):
    found = {}
    for seed in range(FIRST, FIRST + int(os.environ.get("THERCON_FUZZ", decks))):
        folder = tmp_path / str(seed % 20)
        folder.mkdir(exist_ok=True)
        deck = mutated(folder, seed)
        status, faults = outcome(deck, command)
        if faults:
            kept = tmp_path / f"{command}-{seed}.inp"
            kept.write_text(deck.read_text())
            found[seed] = (status, faults)
    assert not found, found


@pytest.mark.parametrize("kind", types())
def test_a_missing_node_of_an_element_is_an_error(tmp_path, kind):
    count = types()[kind]
    cards = CARDS.get(kind, SECTION)
    deck = tmp_path / "deck.inp"
    for missing in range(count):
        nodes = ["1", "2", "3", "4", "11", "12", "13", "14"][:count]
        nodes[missing] = NUMBER
        element = f"*ELEMENT, TYPE={kind}, ELSET=X\n9, {', '.join(nodes)}\n"
        for use in USES if missing in (0, count - 1) else USES[:1]:
            deck.write_text(MESH + element + MODEL + cards + use + STEP + "*END STEP\n")
            process = run("check", "--quiet", deck)
            assert process.returncode == 1, deck.read_text() + process.stderr
            assert f"error: there is no node {NUMBER}" in process.stderr
            deck.write_text(element + cards + use)
            assert run("check", "--quiet", deck).returncode == 1
