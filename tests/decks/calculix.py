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
import sys

import numpy as np
import pytest
from blocks import write
from deck_runs import DECKS, PATIENCE, run

sys.path.insert(0, str(DECKS.parents[1] / "python"))

from thercon.post.comparison.print_file import read_calculix_dat  # noqa: E402
from thercon.post.comparison.series import KEYS  # noqa: E402

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
    """Run CalculiX on a deck; return its tables by (time, quantity): values by row.

    The sum of RF1 over a set is a quantity of its own, RF1@SET, with one row.
    """
    if not shutil.which("ccx"):
        pytest.skip("needs CalculiX (calculix-ccx)")
    folder = deck.parent / "ccx"   # both programs write .sta and .cvg
    shutil.copytree(deck.parent, folder, dirs_exist_ok=True, ignore=lambda *_: ["ccx"])
    process = subprocess.run(["ccx", deck.stem], cwd=folder, capture_output=True, text=True,
                             timeout=PATIENCE, env={**os.environ, "OMP_NUM_THREADS": "1"})
    assert process.returncode == 0, process.stdout[-2000:]
    assert "*ERROR" not in process.stdout, process.stdout[-2000:]
    return read_dat((folder / deck.name).with_suffix(".dat"))


def read_dat(path):
    """Return the tables of a .dat file by (time, quantity)."""
    found = {}
    source = read_calculix_dat(path)
    assert not source.notes, source.notes
    for series in source.series:
        for number in range(len(series.frames)):
            frame = series.frame(number)
            keys = [frame[name].astype(int) for name in KEYS if name in frame]
            for quantity in series.quantities:
                for i, (time, value) in enumerate(zip(frame["time"], frame[quantity], strict=True)):
                    table = found.setdefault((round(float(time), 6), quantity), {})
                    table[tuple(int(key[i]) for key in keys)] = float(value)
    return found


def thercon(deck):
    """Run thercon on a deck; return its tables as `calculix` does."""
    process = run("run", "--quiet", "--width", "400", deck, "--out", deck.parent)
    assert process.returncode == 0, process.stderr
    return read_listing(deck.with_suffix(".lst"))


def read_listing(path):
    """Return the tables of a listing by (time, quantity)."""
    found, time, rows, columns, name = {}, None, 0, None, ""
    for line in path.read_text().split("INCREMENTS\n", 1)[1].splitlines():
        title = re.fullmatch(r"   (NODES|TOTALS|INTEGRATION POINTS) OF (\S+)", line)
        begins = re.match(r"INCREMENT .*?TIME +(\S+)", line, flags=re.I)
        if begins:
            time, columns = round(float(begins[1].rstrip(",")), 6), None
        elif title:
            rows, columns = ROW[title[1]], []
            name = f"@{title[2]}" if rows == 0 else ""
        elif not line.strip():
            columns = None
        elif columns == []:
            columns = line.split()
        elif columns:
            key = tuple(int(v) for v in line.split()[:rows])
            for column, value in zip(columns, line.split(), strict=False):
                if column not in ("node", "element", "point", "x", "y"):
                    found.setdefault((time, column + name), {})[key] = float(value)
    return found


def kind_of(quantity):
    """Return what a quantity is a component or a sum of."""
    return quantity.partition("@")[0].rstrip("0123456789")


def ring(tables):
    """Return tables of CalculiX for rings with the forces and heat of the whole circumference.

    Radial forces are left out: those of its wedge lack what the sides of the wedge exert.
    """
    factor = {"RF2": 180.0, "RFL": 180.0}
    return {(time, quantity): {row: factor.get(quantity.partition("@")[0], 1.0) * v
                               for row, v in table.items()}
            for (time, quantity), table in tables.items() if not quantity.startswith("RF1")}


def differences(theirs, ours):
    """Return for each quantity of CalculiX the largest difference, by the largest value that its
    kind (displacements, stresses, ...) has, over all rows and the times that CalculiX has."""
    scale, worst = {}, {}
    for (_, quantity), table in theirs.items():
        kind = kind_of(quantity)
        scale[kind] = max(scale.get(kind, 0.0), *map(abs, table.values()))
    missing = sorted(theirs.keys() - ours.keys())
    assert theirs, "CalculiX printed no table"
    assert not missing, missing
    for key, table in theirs.items():
        quantity = key[1]
        rows = sorted(table.keys() & ours[key].keys())
        # CalculiX has more points, in further layers, or fewer: one in a three-node triangle.
        assert {row[:1] for row in rows} == {row[:1] for row in table}, key
        assert kind_of(quantity) in ("S", "HFL") or len(rows) == len(table) == len(ours[key]), key
        off = np.max([abs(table[row] - ours[key][row]) for row in rows])   # NaN, unlike max, if any is
        worst[quantity] = float(np.maximum(worst.get(quantity, 0.0),
                                           off / (scale[kind_of(quantity)] or 1.0)))
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
