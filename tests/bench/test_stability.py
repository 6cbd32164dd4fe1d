"""The theme of *STABILITY: instructions of an analysis over those of ten increments."""

import re

import report  # isort: skip, it makes the modules below known
import h5py
from deck_runs import COUPLED, CYLINDER, INPUT
from document import Table
from instructions import SOURCES, procedures, profile

TITLE = "Analysis of stability"
TEXT = """
An analysis by [\\*STABILITY](deck/steps.md#stability) takes 1.2 times the instructions of ten
increments of the cylinder with `ERRORS=NO` and without writing, as many as those of its twin, and a
quarter of those of two rods.
"""
IN_DOCUMENT = []
# Deck, and what its last step says of increments.
CASES = {
    "cylinder": (CYLINDER, "20., 900."),
    "coupled twin": (COUPLED, "20., 900."),
    "two rods of four elements": (INPUT / "examples" / "two_rods.inp", "20., 500."),
}


def deck(folder, name):
    """Write the deck of a case; return its path."""
    source, given = CASES[name]
    text = source.read_text().split("*VERIFY")[0]
    assert text.count(f"\n{given}\n") == 1
    text = text.replace(f"\n{given}\n", f"\n{given}\n*STABILITY\n")
    if "*DENSITY" not in text:
        text = re.sub(r"(\*CONDUCTIVITY\n.*\n)", r"\1*DENSITY\n1.\n*SPECIFIC HEAT\n3.6\n", text)
    text = text.replace("*STEP", "*OPTIONS, ERRORS=NO\n*STEP", 1)
    path = folder / "case.inp"
    path.write_text(text)
    return path


def costs(counts, result):
    """Return the instructions of an analysis and of ten increments."""
    with h5py.File(result) as file:
        increments = len(file["history/time"])

    def into(place):
        return sum(spent for (source, target), spent in counts.calls.items()
                   if place in (target[0], ":".join(target)) and source[0] != target[0])

    return into("growing_modes"), 10 * into("increments:advance") / increments


def tables(folder):
    """Return the table of all cases."""
    table = Table("Instructions of an analysis", [
        "deck", "ten increments [million]", "an analysis [million]", "ratio"])
    for name in CASES:
        path = deck(folder, name)
        counts = profile("run", "--quiet", path, "--out", folder, path=folder / "profile")
        analysis, ten = costs(counts, path.with_suffix(".vtkhdf"))
        table.rows.append([name, f"{ten / 1e6:.1f}", f"{analysis / 1e6:.1f}",
                           f"{analysis / ten:.2f}"])
    return [table]


def test_what_is_counted_is_called_from_other_modules():
    """Calls within a module are not counted."""
    users = "\n".join(path.read_text() for path in SOURCES.rglob("*.f90"))
    for module, procedure in (("growing_modes", "analyse_stability"), ("increments", "advance")):
        assert procedure in procedures(module)
        assert re.search(rf"^ *use {module}, only: .*\b{procedure}\b", users, re.M)
