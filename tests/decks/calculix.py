"""CalculiX beside thercon on one deck: both print the tables of *NODE PRINT and *EL PRINT."""

import os
import re
import subprocess

import numpy as np
from blocks import write
from deck_runs import run

# Tables of CalculiX's .dat: how its heading begins, numbers that name a row, columns that a plane
# model has.
TABLES = {
    "displacements": (1, ["U1", "U2"]),
    "temperatures": (1, ["NT"]),
    "forces": (1, ["RF1", "RF2"]),
    "heat generation": (1, ["RFL"]),
    "total force": (0, ["RF1", "RF2"]),
    "total heat generation": (0, ["RFL"]),
    "stresses": (2, ["S11", "S22", "S33", "S12"]),
    "heat flux": (2, ["HFL1", "HFL2"]),
}
HEADING = re.compile(r" (\D+?) (?:\(.*\) )?for set ?(\S+) and time +(\S+)")
ROW = {"NODES": 1, "INTEGRATION POINTS": 2, "TOTALS": 0}   # numbers that name a row of thercon


def calculix(deck):
    """Run CalculiX on a deck; return its tables by (time, quantity, set): values by row."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    process = subprocess.run(["ccx", deck.stem], cwd=deck.parent, capture_output=True, text=True,
                             timeout=300, env=environment)
    assert process.returncode == 0, process.stdout[-2000:]
    assert "*ERROR" not in process.stdout, process.stdout[-2000:]
    return read_dat(deck.with_suffix(".dat"))


def read_dat(path):
    """Return the tables of a .dat file by (time, quantity, set)."""
    found, rows, names, places = {}, 0, [], []
    for line in path.read_text().splitlines():
        heading = HEADING.match(line)
        if heading:
            title, name, time = heading.groups()
            rows, names = TABLES.get(title, (0, []))
            places = [found.setdefault((round(float(time), 6), column, name), {})
                      for column in names]
        elif line.strip() and names:
            fields = line.split()
            key = tuple(map(int, fields[:rows]))
            numbers = fields[rows:]
            for place, value in zip(places, numbers, strict=False):
                place[key] = float(value)
    return found


def thercon(deck):
    """Run thercon on a deck; return its tables as `calculix` does."""
    process = run("run", "--quiet", "--width", "400", deck, "--out", deck.parent)
    assert process.returncode == 0, process.stderr
    return read_listing(deck.with_suffix(".lst"))


def read_listing(path):
    """Return the tables of a listing by (time, quantity, set)."""
    found, time, rows, columns, name = {}, None, 0, None, ""
    for line in path.read_text().split("INCREMENTS\n", 1)[1].splitlines():
        title = re.fullmatch(r"   (NODES|TOTALS|INTEGRATION POINTS) OF (\S+)", line)
        begins = re.match(r"INCREMENT .*?TIME +(\S+)", line, flags=re.I)
        if begins:
            time, columns = round(float(begins[1].rstrip(",")), 6), None
        elif title:
            rows, columns, name = ROW[title[1]], [], title[2]
        elif not line.strip():
            columns = None
        elif columns == []:
            columns = line.split()
        elif columns:
            fields = dict(zip(columns, line.split(), strict=False))
            key = tuple(int(v) for v in line.split()[:rows])
            for column, value in fields.items():
                if column not in ("node", "element", "point", "x", "y"):
                    found.setdefault((time, column, name), {})[key] = float(value)
    return found


def compared(folder, *cards, name="deck"):
    """Run one deck by both programs; return for each quantity the largest difference by the
    largest value of CalculiX, over all tables, rows and times."""
    deck = write(folder / f"{name}.inp", *cards)
    theirs, ours = calculix(deck), thercon(deck)
    return differences(theirs, ours)


def differences(theirs, ours):
    scale, worst = {}, {}
    for key, table in theirs.items():
        largest = max(map(abs, table.values()), default=0.0)
        family = key[1].rstrip("0123456789")
        scale[family] = max(scale.get(family, 0.0), largest)
    assert theirs.keys() == ours.keys(), sorted(theirs.keys() ^ ours.keys())
    for key, table in theirs.items():
        rows = sorted(ours[key])
        assert table.keys() >= ours[key].keys(), key
        assert len(rows) == len(table) or key[1][0] in "SH", key   # points of further layers
        family = key[1].rstrip("0123456789")
        off = np.abs(np.array([table[r] - ours[key][r] for r in rows])).max(initial=0.0)
        worst[key[1]] = max(worst.get(key[1], 0.0), off / (scale[family] or 1.0))
    return worst
