"""Node pairs against mortar points on faces that match: errors and CPU seconds of known decks."""

import resource
from dataclasses import replace

import h5py
import numpy as np
from converged_values import QUANTITIES
from deck_runs import run
from report import Table, rows
from test_estimate import CASES, case_deck, converged

TITLE = "Node pairs against mortar points"
TEXT = """
Where faces match, both pairings are possible. Node pairs are the default: a mesh has twice as many
of them as mortar points, and on most decks they are more accurate. Mortar points take up to 1.6
times the CPU seconds. Use `PAIRING=SURFACES` on the faces of a crack whose force or heat counts.

| deck | errors of mortar points against those of node pairs |
|---|---|
| cylinder, its twin, Hertz: the edge of contact moves along the face | peak pressure alike; edge of contact mostly 2 to 30 times as far off, and edge of stick on the twin |
| heat of the cylinder | about twice as large, more where an edge at a node favours node pairs |
| heat of the twin | less than a tenth on the coarse mesh, alike on the fine one |
| cracked plate | force and heat less than a tenth: node pairs leave out the share of the tip |

Where the edge of contact lies inside a side, single pressures of mortar points alternate about the
true ones, by up to 13 % of the largest one next to the edge of Hertz's contact with 8 sides, and by
more where a peak is narrower than a side, as where a flat passes into a round: refine faces there.
"""
DETAILS = """
The errors below are magnitudes, in per cent of converged values (`tests/accuracy/converged.csv`), at the end of the load,
with the increments of the decks and `ERRORS=NO`. CPU seconds are the smallest of three
runs.
"""
IN_DOCUMENT = []
LEVELS = (0, 2)
PAIRINGS = ("NODES", "SURFACES")
NAMES = {name: QUANTITIES[name] for name in ("normal_force", "heat_rate", "peak_pressure", "edge_contact", "edge_stick")}
HEAD = ["deck", "refinements", "pairing", "contact points", "seconds", *NAMES.values()]
RUNS = 3


def seconds_of(deck):
    """Run a deck; return its CPU seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    process = run("run", "--quiet", deck, "--out", deck.parent)
    assert process.returncode == 0, process.stderr
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def measured(case, level, pairing, folder, runs=RUNS):
    """Return contact points, CPU seconds and errors in per cent of a deck."""
    deck = case_deck(replace(case, name=f"{case.name} {pairing}"), level, folder, "NO", pairing)
    seconds = min(seconds_of(deck) for _ in range(runs))
    exact = {name: converged(case.name).get(name, np.nan) for name in NAMES}
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        face = file[f"contact/{case.face}"]
        found = {name: face[name][-1] if name in face else np.nan for name in NAMES}
        found["peak_pressure"] = face["pressure"][-1].max()
        errors = [100.0 * abs(found[name] / exact[name] - 1.0) if exact[name] else np.nan
                  for name in NAMES]
        return len(face["s"]), seconds, errors


def tables(folder):
    """Run all cases on two meshes with both pairings."""
    table = Table("Errors in % and seconds", HEAD)
    for case in CASES:
        for level in LEVELS:
            for pairing in PAIRINGS:
                points, seconds, errors = measured(case, level, pairing, folder)
                cells = ["-" if np.isnan(error) else f"{error:.3f}" for error in errors]
                table.rows.append([case.name, level, pairing, points, f"{seconds:.2f}", *cells])
    return [table]


def test_pairings_have_the_errors_that_the_document_tells(tmp_path):
    told = {(row["deck"], row["refinements"], row["pairing"]): row
            for row in rows("Errors in % and seconds")}
    for case in (CASES[0], CASES[2]):
        for pairing in PAIRINGS:
            _, _, errors = measured(case, 0, pairing, tmp_path, runs=1)
            cells = [told[case.name, "0", pairing][head] for head in HEAD[5:]]
            for cell, error in zip(cells, errors, strict=True):
                assert np.isnan(error) if cell == "-" else abs(error - float(cell)) < 0.02
