#!/usr/bin/env python3
"""Repeat the runs on record of thercon and CalculiX and say what came out against them.

Runs that are dominated by a wide margin (another one is no worse and takes less than a third of the
CPU seconds) are left out, unless --all is given. THERCON is the program. What came out is written
to the folder given, or, with --record, to runs.csv here; --add measures other runs, too.
"""

import argparse
import statistics
import sys
import time
from dataclasses import fields
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "documents")]

import envelope  # noqa: E402  its folder is made known first
import numpy as np  # noqa: E402
import records  # noqa: E402
import runs  # noqa: E402
from decks import Case  # noqa: E402
from records import Record  # noqa: E402

SHORT, REPEATS = 5.0, 3   # runs below so many CPU seconds are repeated, and their median is taken


def measure(case, folder):
    """Run a case, a short one several times; return its record."""
    found = runs.solve(case, folder)
    if found is None:
        return Record(case)
    costs = [found[0]]
    while costs[0].cpu < SHORT and len(costs) < REPEATS:
        costs.append(runs.solve(case, folder)[0])
    return Record(case, statistics.median(one.cpu for one in costs),
                  max(one.memory for one in costs), found[1])


def worth_repeating(recorded):
    """Return the runs that no other dominates by a wide margin, cheapest first."""
    scores = {one.record.case: one for one in envelope.scored(recorded)}
    kept = []
    for one in recorded:
        score = scores.get(one.case)
        others = [other for other in scores.values()
                  if other.record.case.program == one.case.program]
        if score is None or not any(other.error <= score.error and 3 * other.record.cpu < one.cpu
                                    for other in others):
            kept.append(one)
    return sorted((one for one in kept if not one.failed), key=lambda one: one.cpu)


def described(one):
    """Return the words for the cheapest run."""
    return f"{one.record.cpu:9.3f} s {100 * one.error:6.2f} %" if one else f"{'none':>20}"


def tell(recorded, found):
    """Print the cheapest runs at each error, on record and now."""
    print(f"{'error':>6} {'':10}{'on record':^22}{'now':^22}")
    for level in envelope.LEVELS:
        for program in envelope.PROGRAMS:
            best = [envelope.cheapest(runs, program, level) for runs in (recorded, found)]
            print(f"{100 * level:4g} % {program:10}" + "".join(f"{described(b):22}" for b in best))
        ratios = [envelope.ratio(runs, level) or np.nan for runs in (recorded, found)]
        print(f"{'':7}{'ratio':10}" + "".join(f"{ratio:9.0f}{'':13}" for ratio in ratios))


def changed(old, new):
    """Return the largest relative difference of the values of two runs."""
    if new.failed:
        return np.inf
    one, other = (run.values[:len(records.QUANTITIES)] for run in (old, new))
    return float(np.nanmax(np.abs(other - one) / np.abs(one).max(axis=1, keepdims=True)))


def repeat(chosen, folder):
    """Run these again, saying how each compares; return their records."""
    found, start = [], time.monotonic()
    for count, old in enumerate(chosen, start=1):
        new = measure(old.case, folder)
        found.append(new)
        print(f"{count:3}/{len(chosen)} {time.monotonic() - start:6.0f} s  {old.case.name}:",
              f"{new.cpu:.3f} s, on record {old.cpu:.3f} s;",
              f"values differ by {changed(old, new):.1e}", flush=True)
    return found


def case_of(text):
    """Return the case of a line of runs.csv."""
    words = text.split(",")
    return Case(**{f.name: f.type(word) for f, word in zip(fields(Case), words, strict=False)})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="where the runs and what came out are written")
    parser.add_argument("--all", action="store_true", help="repeat runs that are dominated, too")
    parser.add_argument("--only", choices=envelope.PROGRAMS, help="repeat the runs of one program")
    parser.add_argument("--record", action="store_true", help="write to runs.csv here")
    parser.add_argument("--add", nargs="+", metavar="CASE",
                        help="measure and record these alone: first fields of lines of runs.csv")
    options = parser.parse_args()
    recorded = records.read()
    if options.add:
        for case in map(case_of, options.add):
            new = measure(case, options.folder)
            records.write([one for one in records.read() if one.case != case] + [new])
        return
    chosen = [one for one in (recorded if options.all else worth_repeating(recorded))
              if options.only in (None, one.case.program)]
    again = {one.case: one for one in repeat(chosen, options.folder)}
    now = [again.get(one.case, one) for one in recorded if options.record or one.case in again]
    records.write(now, records.RUNS if options.record else options.folder / "runs.csv")
    tell(envelope.scored(recorded), envelope.scored(now))


if __name__ == "__main__":
    main()
