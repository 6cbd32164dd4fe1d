"""Numerical uncertainties against true errors, on the decks of judged_families and inelastic_families.

The true value at the end of a step is that of a mesh refined twice everywhere and twice more at the faces, with
increments a quarter as long; what a sixteenth changes is added. Where the path does not matter the mesh alone is
refined, and values that change by a steady ratio are extrapolated. The last changes of mesh and increments say how
accurate it is; some decks have true values from elsewhere (`exact`): an error is judged where it is at least KNOWN times that. A deck holds where all ends of its steps
do; the shares of a family count each quantity of a deck.

`python tests/accuracy/judged_decks.py SEED...` (or FIRST-LAST) adds the true values of the decks of seeds to
judged.csv, or to `--file FILE`, unless it has them. With `--judge ERRORS` it then solves these decks with
`*OPTIONS, ERRORS=ERRORS` and prints the shares of uncertainties that hold. `--family NAME` does one family alone.
"""

import argparse
import csv
import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import report  # isort: skip, it makes the modules below known
import h5py
import numpy as np
from converged_values import ANALYSIS, LEAST_EDGE, QUANTITIES, rest, run
from inelastic_families import FAMILIES as INELASTIC
from judged_families import FAMILIES as ELASTIC

FAMILIES = ELASTIC | INELASTIC
FILE = Path(__file__).resolve().parent / "judged.csv"
HEAD = ["family", "deck", "step", "place", "quantity", "value", "known"]
WORDS = QUANTITIES | {"von_mises": "largest stress", "temperature": "largest temperature",
                      "displacement": "displacement", "dissipated": "dissipated energy",
                      "work": "work of loads"}
FINE, FACES = 2, 2                 # divisions of all elements, and beyond those of elements at the faces
KNOWN = 3.0
LEAST = 1e-5    # of the value: smaller errors are not judged; forces that loads prescribe have them
SAME = 1e-6     # part of a value by which that of another place is the same
PARTS = 4, 16   # into which increments are divided


@dataclass(frozen=True)
class Case:
    """An error at the end of a step and its uncertainty, NaN with the reason for which there is none; whether
    the true value is accurate enough to judge by."""

    family: str
    deck: str
    quantity: str
    error: float
    uncertainty: float
    reason: str
    is_known: bool = True

    @property
    def is_told(self):
        """Return whether there is an uncertainty."""
        return np.isfinite(self.uncertainty)

    @property
    def is_held(self):
        """Return whether the error is inside the uncertainty."""
        return abs(self.error) <= self.uncertainty


def ends_of_steps(text):
    """Return the times at which the steps of a deck end."""
    return np.cumsum([float(card.split(",")[1]) for card in re.findall(ANALYSIS.pattern + r"(.*)", text, re.M | re.I)
                      for card in ["".join(card[1:])]])


def values_of(file, deck):
    """Return the values of a result at the ends of the steps, by place and quantity."""
    ends, times, found = ends_of_steps(deck.text), file["history/time"][:], {}
    rows = [int(np.argmin(np.abs(times - end))) for end in ends]
    for name in deck.faces:
        face = file[f"contact/{name}"]
        found |= {(name, q): face[q][:][rows] for q in QUANTITIES if q in face}
        if not deck.has_corners:
            found[name, "peak_pressure"] = face["pressure"][:].max(axis=1)[rows]
    for body, quantity, circle in deck.maxima:
        found[f"body {body}", quantity] = largest(file["VTKHDF"], body, quantity, circle, ends)
    for quantity, name, node in deck.checks:
        values = at_node(file["VTKHDF"], node, ends) if node else file[f"history/{name}"][:][rows]
        found[place_of(node), quantity] = values
    return found


def place_of(node):
    """Return the name of the place of a check."""
    return f"node {node}" if node else "model"


def at_node(grid, node, ends):
    """Return the displacement of a node along x at times."""
    row = int(np.flatnonzero(grid["PointData/node_id"][:] == node)[0])
    firsts = [grid["Steps/PointDataOffsets/displacement"][int(k)] for k in (
        np.argmin(np.abs(grid["Steps/Values"][:] - end)) for end in ends)]
    return np.array([grid["PointData/displacement"][first + row, 0] for first in firsts])


def cards_of_checks(deck):
    """Return the cards of checks at the ends of all steps, which pass."""
    cards = [f"{name}, {node or ''}, {float(end)!r}, 0., 1.E99, ABS\n"
             for end in ends_of_steps(deck.text) for _, name, node in deck.checks]
    return "".join(['*VERIFY, KIND=ANALYTIC, SOURCE="inelastic_rings"\n' if cards else "", *cards])


def judged_checks(listing, deck):
    """Return the uncertainties of checks in a listing, NaN with the reason where there is none, by
    place, quantity and step."""
    told = re.findall(r"^ +found: +\S+ *(?:\+- (\S+)|\(no estimate: (.*)\))?", listing, re.M)
    keys = [(place_of(node), quantity, step) for step in range(1, len(ends_of_steps(deck.text)) + 1)
            for quantity, _, node in deck.checks]
    return {key: (float(number or "nan"), why)
            for key, (number, why) in zip(keys, told, strict=True)}


def largest(grid, body, quantity, circle, ends):
    """Return the largest values of a field in a body, or where a circle has a part of it, at times."""
    points, offsets = grid["Points"][:], grid["Offsets"][:]
    of_cell = np.repeat(grid["CellData/body"][:len(offsets) - 1], np.diff(offsets))
    inside = np.zeros(len(points), bool)
    inside[grid["Connectivity"][:][of_cell == body]] = True
    if circle:
        inside &= np.hypot(points[:, 0] - circle[0], points[:, 1] - circle[1]) <= circle[2]
    written, found = grid["Steps/Values"][:], []
    for end in ends:
        first = grid[f"Steps/PointDataOffsets/{quantity}"][int(np.argmin(np.abs(written - end)))]
        found.append(grid[f"PointData/{quantity}"][first:first + len(points)][inside].max())
    return np.array(found)


def solved(deck, level, part, folder):
    """Return the values of a deck on another mesh, with other increments."""
    path = run(deck, level, part, folder, "NO")
    with h5py.File(path) as file:
        found = values_of(file, deck)
    for each in folder.glob(f"{path.stem}.*"):
        each.unlink()
    return found


def faces_of(deck):
    """Return how many times elements at the faces are divided beyond all: less often where bodies
    yield, all of whose elements count, and take their time."""
    return deck.own_levels + 1 if deck.own_levels or deck.checks else FACES


def reference(deck, folder):
    """Return true values at the ends of the steps, and how accurate they are, by place and quantity."""
    faces = faces_of(deck)
    if deck.exact:
        return {key: tuple(np.array(pairs).T) for key, pairs in deck.exact().items()}
    if deck.has_path:
        coarse, fine = (solved(deck, (k, faces), PARTS[0], folder) for k in (FINE - 1, FINE))
        longer, shorter = (solved(deck, 1, part, folder) for part in PARTS)
        moved = {key: shorter[key] - longer[key] for key in fine}
        return {key: (fine[key] + moved[key], abs(fine[key] - coarse[key]) + abs(moved[key])) for key in fine}
    runs = [solved(deck, (k, faces), 1, folder) for k in range(FINE + 1)]
    found = {}
    for key, fine in runs[-1].items():
        # Edges lie between nodes and scatter from mesh to mesh.
        left = np.array([0.0 if key[1].startswith("edge") else rest(*values)
                         for values in zip(*(values[key] for values in runs), strict=True)])
        found[key] = fine + left, np.where(left == 0, abs(fine - runs[-2][key]), abs(left))
    return found


def renewed(deck):
    """Return the rows of the file for a deck."""
    with tempfile.TemporaryDirectory() as folder:
        found = reference(deck, Path(folder))
    return [[deck.family, deck.name, step, *key, f"{value:.10g}", f"{known:.3g}"] for key, parts in found.items()
            for step, (value, known) in enumerate(zip(*parts, strict=True), 1)]


def told_values(file):
    """Return the true values that are kept and how accurate they are, by deck, place, quantity and step."""
    with file.open(newline="") as lines:
        return {(row["deck"], row["place"], row["quantity"], int(row["step"])): (float(row["value"]), float(
            row["known"])) for row in csv.DictReader(lines)}


def write_file(decks, file):
    """Add the true values of decks that the file lacks."""
    if not file.exists():
        file.write_text(",".join(HEAD) + "\n")
    kept = {key[0] for key in told_values(file)}
    for deck in decks:
        if deck.name in kept:
            continue
        try:
            rows = renewed(deck)
        except AssertionError as error:   # the exit status of a run
            print(f"{deck.name} has no true values, and is not judged: {str(error)[-300:]}", file=sys.stderr)
        else:
            with file.open("a", newline="") as lines:
                csv.writer(lines, lineterminator="\n").writerows(rows)


def estimate(file, place, quantity, row=-1):
    """Return value and uncertainty in a row of a result file, and why there is no uncertainty."""
    group = file["uncertainty"]
    why = group[place]["no_estimate"]
    reason = group["reasons"][why[row, why.attrs["components"].split().index(quantity)]].decode()
    return (*group[place][quantity][row][:2], reason)


def cases_of(path, deck, told):
    """Return the cases of a result file: errors that are more than rounding, of edges that are not the ends of
    the face and of largest values at their place."""
    found, checks = [], judged_checks(path.with_suffix(".lst").read_text(), deck)
    with h5py.File(path) as file:
        times = file["uncertainty/time"][:]
        rows = [int(np.argmin(np.abs(times - end))) for end in ends_of_steps(deck.text)]
        for (place, quantity), own in values_of(file, deck).items():
            is_check = (place, quantity, 1) in checks
            if not is_check and quantity not in file["uncertainty"].get(place, ()):
                continue
            is_edge = quantity.startswith("edge")
            for step, row in enumerate(rows, 1):
                if deck.exact and (deck.name, place, quantity, step) not in told:
                    continue
                true, known = told[deck.name, place, quantity, step]
                value, uncertainty, reason = (
                    (own[step - 1], *checks[place, quantity, step]) if is_check
                    else estimate(file, place, quantity, row))
                least = LEAST * abs(true)
                if is_edge:
                    spacing = spacing_at(file[f"contact/{place}/s"][:], value)
                    least = LEAST_EDGE * spacing
                    if quantity == "edge_stick":   # a contact point, or midway between two
                        known = max(known, spacing / 2 ** (FINE + faces_of(deck) - deck.own_levels + 1))
                is_there = is_edge or abs(value - own[step - 1]) <= SAME * abs(value)
                if is_there and abs(true - value) > least:
                    found.append(Case(deck.family, deck.name, quantity, true - value, uncertainty, reason,
                                      abs(true - value) > KNOWN * known))
    return found


def spacing_at(places, value):
    """Return the spacing of contact points at an edge, infinite at the end of the face."""
    beyond = np.searchsorted(places, value + SAME * places[-1])
    return places[beyond] - places[max(0, beyond - 1)] if beyond < len(places) else np.inf


def judged(deck, told, errors="LAST"):
    """Solve a deck as written; return its cases."""
    with tempfile.TemporaryDirectory() as folder:
        path = run(deck, (0, deck.own_levels), 1, Path(folder), errors, cards_of_checks(deck))
        return cases_of(path, deck, told)


def by_deck(cases):
    """Return the share of decks in which a quantity holds at all ends of steps, that of decks with a number
    without estimate, the median and the ninth decile of uncertainty over error of all numbers, and how many
    errors are too small to be judged by these true values."""
    known = [case for case in cases if case.is_known]
    some, holds = [case for case in known if case.is_told], {}
    for case in some:
        key = case.deck, case.quantity
        holds[key] = holds.get(key, True) and case.is_held
    without = {(case.deck, case.quantity) for case in known if not case.is_told}
    share = f"{sum(holds.values())}/{len(holds)}, {100 * np.mean([*holds.values()]):.0f} %" if holds else "-"
    ratios = [case.uncertainty / abs(case.error) for case in some]
    return [share, f"{len(without)}/{len({(case.deck, case.quantity) for case in known})}",
            *((f"{np.quantile(ratios, part):.1f}" if ratios else "-") for part in (0.5, 0.9)),
            f"{len(cases) - len(known)}/{len(cases)}"]


def judgement(cases):
    """Return the tables of all families together, of each, and of the reasons."""
    head = ["decks that hold", "without estimate", "uncertainty/error, median", "90 %", "not judged"]
    pooled = report.Table("Uncertainties of all families", ["quantity", *head])
    each = report.Table("Uncertainties of each family", ["family", "quantity", *head])
    families = [*dict.fromkeys(case.family for case in cases)]
    for quantity, words in WORDS.items():
        own = [case for case in cases if case.quantity == quantity]
        pooled.rows += [[words, *by_deck(own)]] if own else []
        each.rows += [[family, words, *by_deck(some)] for family in families
                      if (some := [case for case in own if case.family == family])]
    each.rows.sort(key=lambda row: families.index(row[0]))
    each.rows += [[family, "all", *by_deck([case for case in cases if case.family == family])] for family in families]
    why = report.Table("Numbers without estimate", ["family", "reason", "numbers"])
    counts = {}
    for case in cases:
        if case.is_known and not case.is_told:
            counts[case.family, case.reason] = counts.get((case.family, case.reason), 0) + 1
    why.rows += [[*key, count] for key, count in counts.items()]
    return [pooled, each, why]


def compared(title, found, text=""):
    """Return the table of all families together, of the cases of each setting of ERRORS."""
    words = "decks that hold", "without", "median", "90 %"
    table = report.Table(title, ["quantity", *(f"{errors}: {word}" for errors in found for word in words)], text=text)
    for quantity, name in WORDS.items():
        own = [[case for case in cases if case.quantity == quantity] for cases in found.values()]
        if any(map(len, own)):
            table.rows.append([name, *(cell for cases in own for cell in by_deck(cases)[:4])])
    return table


def of_families(title, found):
    """Return the table of the decks of each family that hold: of each quantity for the last setting of ERRORS, of
    all quantities together for each."""
    families, last = dict.fromkeys(case.family for cases in found.values() for case in cases), [*found][-1]
    quantities = [quantity for quantity in WORDS if any(case.quantity == quantity for case in found[last])]
    table = report.Table(title, ["family", *(f"{last}: {WORDS[quantity]}" for quantity in quantities),
                                 *(f"{errors}: all" for errors in found)])
    for family in families:
        own = {errors: [case for case in cases if case.family == family] for errors, cases in found.items()}
        each = [by_deck([case for case in own[last] if case.quantity == quantity])[0] for quantity in quantities]
        table.rows.append([family, *(share.split(",")[0] for share in each),
                           *(by_deck(own[errors])[0] for errors in found)])
    return table


def check_shares(title, column="decks that hold", least=95):
    """Assert that the document tells at least so many per cent in the columns of a table that end so, or all
    decks but one."""
    told = [map(int, cell.split(",")[0].split("/")) for row in report.rows(title) for head, cell in row.items()
            if head.endswith(column) and "/" in cell]
    assert told, title
    assert all(round(100 * held / number) >= least or number - held == 1 for held, number in told), report.rows(title)


def misses(found):
    """Return the table of the uncertainties that do not hold, of the cases of each setting of ERRORS."""
    table = report.Table("Uncertainties that do not hold", ["ERRORS", "deck", "quantity", "error/uncertainty"])
    worst = {}
    for errors, cases in found.items():
        for case in cases:
            if case.is_known and case.is_told and not case.is_held:
                key = errors, case.deck, WORDS[case.quantity]
                worst[key] = max(worst.get(key, 0.0), abs(case.error) / case.uncertainty)
    table.rows += [[*key, f"{ratio:.2f}"] for key, ratio in worst.items()]
    return table


def main(arguments):
    """Add true values; judge."""
    parser = argparse.ArgumentParser()
    parser.add_argument("seeds", nargs="+")
    parser.add_argument("--file", type=Path, default=FILE)
    parser.add_argument("--judge", metavar="ERRORS")
    parser.add_argument("--family", choices=FAMILIES, action="append")
    told = parser.parse_args(arguments)
    seeds = []
    for ends in told.seeds:
        first, last = (ends.split("-") * 2)[:2]
        seeds += range(int(first), int(last) + 1)
    decks = [FAMILIES[family](seed) for family in told.family or FAMILIES for seed in seeds]
    write_file(decks, told.file)
    if told.judge:
        kept = told_values(told.file)
        known = {key[0] for key in kept}
        cases = [case for deck in decks if deck.name in known for case in judged(deck, kept, told.judge)]
        for table in [*judgement(cases), misses({told.judge: cases})]:
            print("\n".join(report.lines_of(table)))


if __name__ == "__main__":
    main(sys.argv[1:])
