"""Runs of many decks at once, and what their listings say of every increment."""

import re
from dataclasses import dataclass, field

import h5py
from deck_runs import run

SEVERAL = "with so much friction other contact states satisfy all conditions, too"


@dataclass
class Outcome:
    """What became of a deck."""

    message: str = ""
    several: int = 0
    cut_backs: int = 0
    violations: list[float] = field(default_factory=list)

    @property
    def increments(self):
        """Return the number of increments that were accepted."""
        return len(self.violations)


def outcome(deck, errors):
    """Return what became of a deck, by its files and what was said on all decks."""
    of_deck = [line for line in errors.splitlines() if line.startswith(str(deck))]
    listing = deck.with_suffix(".lst").read_text()
    status = deck.with_suffix(".sta").read_text().splitlines()[1:]
    message = next((line for line in of_deck if "error: " in line), "")
    return Outcome(message.partition("error: ")[2], sum(SEVERAL in line for line in of_deck),
                   sum(int(line.split()[5]) for line in status),
                   [float(x) for x in re.findall(r"conditions violated by +(\S+)", listing)])


def solve_all(decks, *arguments):
    """Solve decks, results beside them; return the outcome of each."""
    process = run("run", "--quiet", *decks, "--out", decks[0].parent, *arguments)
    assert process.returncode in (0, 2), process.stderr
    return [outcome(deck, process.stderr) for deck in decks]


def contact(deck, pair, *names):
    """Return datasets of a contact pair, one row an increment."""
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        return [file[f"contact/{pair}/{name}"][()] for name in names]
