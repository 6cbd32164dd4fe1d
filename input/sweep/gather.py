#!/usr/bin/env python3
"""Gather the runs of a sweep in the current folder, which has sweep.toml and runs/.

sweep.csv has every row of the values, with what became of it; sweep.png those with a result.
"""

import csv
import sys
import tomllib
from collections import Counter
from pathlib import Path

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  the backend is chosen before

TOLD = "thercon-batch.csv"  # what `thercon run --jobs 1` leaves of a run in its folder
WRITTEN = ("sweep.csv", "sweep.png")


def outcome(folder):
    """Return what became of a run, and why."""
    path = folder / TOLD
    if not path.exists():
        return "not run", f"no {path}"
    with path.open(newline="") as file:
        for row in csv.DictReader(file):
            return row["outcome"], row["reason"]
    return "not run", f"nothing in {path}"


def gather(settings):
    """Return the rows of the table."""
    stem = Path(settings["deck"]).stem
    with open(settings["values"], newline="") as file:
        rows = [{"run": str(n)} | row for n, row in enumerate(csv.DictReader(file), 1)]
    for row in rows:
        folder = Path("runs") / row["run"]
        row["outcome"], row["reason"] = outcome(folder)
        row.update(dict.fromkeys(settings["quantities"], ""))
        result = folder / f"{stem}.vtkhdf"
        # What a run that failed left behind, or one before it, is no result of these values.
        if row["outcome"] != "solved" or not result.exists():
            continue
        with h5py.File(result) as file:
            for name, dataset in settings["quantities"].items():
                if dataset not in file:
                    sys.exit(f"sweep.toml: {result} has no dataset {dataset} for {name}")
                row[name] = repr(float(np.max(file[dataset][-1])))
    return rows


def draw(rows, x, y, curves):
    """Draw a column over another, a curve for each value of a third."""
    figure, axes = plt.subplots(figsize=(6.5, 4.5), layout="constrained")
    solved = [row for row in rows if row["outcome"] == "solved"]
    values = sorted({float(row[curves]) for row in solved})
    for number, value in enumerate(values):
        points = sorted((float(row[x]), float(row[y])) for row in solved
                        if float(row[curves]) == value)
        axes.plot(*zip(*points), ".-", label=f"{value:g}",
                  color=plt.cm.viridis(number / max(len(values) - 1, 1)))
    axes.set(xlabel=x, ylabel=y)
    missing = len(rows) - len(solved)
    axes.set_title(f"{len(solved)} runs" + (f", {missing} without a result" if missing else ""))
    if values:
        figure.legend(title=curves, loc="outside right upper")
    figure.savefig(WRITTEN[1], dpi=150)


def main():
    with open("sweep.toml", "rb") as file:
        settings = tomllib.load(file)
    for written in WRITTEN:
        if Path(written).exists() and Path(written).samefile(settings["values"]):
            sys.exit(f"sweep.toml: {written} would be written over the values; rename their file")
    rows = gather(settings)
    with open(WRITTEN[0], "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, **settings["plot"])
    counts = Counter(row["outcome"] for row in rows)
    print(", ".join(WRITTEN) + ":", ", ".join(f"{name} {n}" for name, n in counts.items()))
    for row in rows:
        if row["outcome"] != "solved":
            print(f"run {row['run']}: {row['outcome']}: {row['reason']}")


if __name__ == "__main__":
    sys.exit(main())
