"""Runs of the program on copies of the published deck, for the tests here."""

import os
import subprocess
from pathlib import Path

PROGRAM = os.environ.get("THERCON", "thercon")
CYLINDER = Path(__file__).resolve().parents[2] / "input" / "cylinder" / "cylinder.inp"


def write_deck(path, model_cards=(), end_cards=()):
    """Write the published deck with more cards before its first *STEP and at its end; refined, it
    loses the checks of its own mesh."""
    text = CYLINDER.read_text()
    if any(card.startswith("*REFINE") for card in model_cards):
        text = text.split("** On this mesh")[0]
    lines = text.splitlines()
    step = next(i for i, line in enumerate(lines) if line.upper().startswith("*STEP"))
    path.write_text("\n".join([*lines[:step], *model_cards, *lines[step:], *end_cards]) + "\n")
    return path


def start(deck, *options):
    """Start the program on a deck; the results go beside it."""
    return subprocess.Popen(
        [PROGRAM, "run", "--quiet", str(deck), "--out", str(deck.parent), *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def run(deck, *options):
    """Run the program on a deck; return its exit status and what it said."""
    process = start(deck, *options)
    said, _ = process.communicate()
    return process.returncode, said


def increments_in(sta):
    """Return the running numbers that stand in a .sta file, without its heading; a run that goes on
    may just be writing the last line."""
    try:
        lines = sta.read_text().rpartition("\n")[0].splitlines()
    except FileNotFoundError:   # a run that begins tries whether it can be written, and removes it
        return []
    return [int(line.split()[0]) for line in lines[1:]]
