"""CalculiX beside thercon on one deck: both print the tables of *NODE PRINT and *EL PRINT.

Debian's calculix-ccx is the program `ccx`. It expands a plane element to a solid one over the
thickness, and a ring to a wedge of two degrees, which shows in what it prints:

- stresses and fluxes stand at the points of several equal layers, the first as in thercon;
- forces and heat of rings are those of the wedge: 1/180 of the circumference.
"""

import os
import re
import shutil
import subprocess

import numpy as np
from blocks import write
from deck_runs import run

# Tables of CalculiX's .dat: how the heading begins, numbers that name a row, columns of the plane.
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

# Numbers that name a row of thercon's listing.
ROW = {"NODES": 1, "INTEGRATION POINTS": 2, "TOTALS": 0}

# Both print seven digits; a force is what is left of larger ones.
DIGITS = 1e-6

MECHANICS = ["*NODE PRINT, NSET=BODY", "U, RF", "*NODE PRINT, NSET=BODY.BOTTOM, TOTALS=ONLY", "RF",
             "*EL PRINT, ELSET=BODY", "S"]
HEAT = ["*NODE PRINT, NSET=BODY", "NT, RFL", "*NODE PRINT, NSET=BODY.BOTTOM, TOTALS=ONLY", "RFL",
        "*EL PRINT, ELSET=BODY", "HFL"]
BOTH = ["*NODE PRINT, NSET=BODY", "U, RF, NT, RFL", "*EL PRINT, ELSET=BODY", "S, HFL"]


def calculix(deck):
    """Run CalculiX on a deck; return its tables by (time, quantity, set): values by row."""
    assert shutil.which("ccx"), "needs CalculiX: apt-get install calculix-ccx"
    folder = deck.parent / "ccx"   # both programs write .sta and .cvg
    shutil.copytree(deck.parent, folder, dirs_exist_ok=True, ignore=lambda *_: ["ccx"])
    process = subprocess.run(["ccx", deck.stem], cwd=folder, capture_output=True, text=True,
                             timeout=60, env={**os.environ, "OMP_NUM_THREADS": "1"})
    assert process.returncode == 0, process.stdout[-2000:]
    assert "*ERROR" not in process.stdout, process.stdout[-2000:]
    return read_dat((folder / deck.name).with_suffix(".dat"))


def read_dat(path):
    """Return the tables of a .dat file by (time, quantity, set)."""
    found, rows, tables = {}, 0, []
    for line in path.read_text().splitlines():
        heading = HEADING.match(line)
        if heading:
            title, name, time = heading.groups()
            rows, names = TABLES.get(title, (0, []))
            tables = [found.setdefault((round(float(time), 6), column, name), {})
                      for column in names]
        elif line.strip() and tables:
            fields = line.split()
            key = tuple(map(int, fields[:rows]))
            for table, value in zip(tables, fields[rows:], strict=False):
                table[key] = float(value)
    return {key: table for key, table in found.items() if table}


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
            key = tuple(int(v) for v in line.split()[:rows])
            for column, value in zip(columns, line.split(), strict=False):
                if column not in ("node", "element", "point", "x", "y"):
                    found.setdefault((time, column, name), {})[key] = float(value)
    return found


def ring(tables):
    """Return tables of CalculiX for rings with the forces and heat of the whole circumference.

    Radial forces are left out: those of its wedge lack what the sides of the wedge exert.
    """
    return {key: {row: 180 * v for row, v in table.items()} if key[1] in ("RF2", "RFL") else table
            for key, table in tables.items() if key[1] != "RF1"}


def differences(theirs, ours):
    """Return for each quantity of CalculiX the largest difference, by the largest value that its
    kind (displacements, stresses, ...) has, over all sets, rows and the times that CalculiX has."""
    scale, worst = {}, {}
    for (_, quantity, _), table in theirs.items():
        kind = quantity.rstrip("0123456789")
        scale[kind] = max(scale.get(kind, 0.0), *map(abs, table.values()))
    missing = sorted(theirs.keys() - ours.keys())
    assert theirs, "CalculiX printed no table"
    assert not missing, missing
    for key, table in theirs.items():
        rows = sorted(table.keys() & ours[key].keys())
        # CalculiX has more points, in further layers, or fewer: one in a three-node triangle.
        assert {row[:1] for row in rows} == {row[:1] for row in table}, key
        assert key[1][0] in "SH" or len(rows) == len(table) == len(ours[key]), key
        off = max(abs(table[row] - ours[key][row]) for row in rows)
        kind = key[1].rstrip("0123456789")
        worst[key[1]] = max(worst.get(key[1], 0.0), off / (scale[kind] or 1.0))
    return worst


def compared(folder, *cards, name="deck", rings=False):
    """Run both programs on one deck; return the differences of their tables."""
    deck = write(folder / f"{name}.inp", *cards)
    theirs = calculix(deck)
    return differences(ring(theirs) if rings else theirs, thercon(deck))


def assert_within(found, tolerance, but=()):
    """Assert that all quantities differ by less than a tolerance, those named in `but` by theirs."""
    but = dict(but)
    wrong = {q: v for q, v in found.items() if not v <= but.get(q, tolerance)}
    assert not wrong, wrong
    assert np.isfinite(list(found.values())).all()
