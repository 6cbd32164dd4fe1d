"""Speed for accuracy, measured by `thercon trade` on three decks, and what each of them teaches."""

import csv
import os
import shutil
from functools import partial
from pathlib import Path

from deck_runs import INPUT, run
from pictures import save
from report import DOCUMENT, Picture, Table
from thercon.post import style, trade

TITLE = "Speed for accuracy, measured"
TEXT = """
`thercon trade DECK` measures what accuracy costs; [running.md](running.md#speed-against-accuracy)
describes the command, its table and how it finds reference and recommendations. Three decks teach:

- Refine the mesh, at the contact faces first, with elements that have midside nodes: on the
  cylinder `Q8 x 2:8` has the errors of the uniform mesh `Q8 x 8` in a sixth of its time, and linear
  elements need the mesh halved twice more for the same force.
- Leave increments, tolerance and method as they are. Increments matter only for the edge of stick;
  `GALERKIN` and `CRANK-NICOLSON` do not damp the error that a closing contact point leaves in the
  heat rate; only `NEWTON` solves the strongly coupled twin.

The table shows the deck as written (=), the recommended rows, and those that vary one thing where
that changes errors; \\* marks Pareto-optimal ones. The picture shows all rows.
"""
DETAILS = """
The tables show the deck as written (=), the recommended rows, and those that vary one thing where that changes
errors; \\* marks Pareto-optimal ones. The pictures show all rows. Here the command ran with `--limit 8`.

[running.md](running.md#speed-against-accuracy) defines errors, reference and recommendation. CPU seconds are
user and system time of a process that solves only this row, without reading the deck and without output,
medians of 7 runs below 0.1 s, 5 below 1 s, 3 below 5 s. MB is the largest resident memory.
"""
IN_DOCUMENT = ["The published cylinder", "Errors and CPU time: The published cylinder"]
LIMIT = "8"
ROUNDING = 1e-8
CYLINDER = "Tolerance and method change nothing here; `MUMPS` takes longer at this size."
TWIN = """\
At first contact, near 540 C, two contact points compete for the heat; the results there depend on
the mesh far more than anything on the cylinder above. The uncertainty of the reference shows it:
with these meshes heat and temperatures are accurate to 1 %, force to 1.2 %, peak and edge of
contact to 6 %, the edge of stick to 20 %. A finer mesh improves all of them, and it suffices to
refine at the contact faces: `Q8 x 2:8` is as accurate as `Q8 x 8` in two fifths of the time.
Shorter increments improve only the edge of stick. Only `NEWTON` completes the run; the three other
methods fail at 500 and 520 C and are listed as failed."""
ROD = """\
Uniform states are exact on any mesh: all rows of the grid agree with the closed form, so the
cheapest is sufficient; the choice between them is arbitrary. The method matters: `PICARD` cycles
without end at a gain of -11, the schemes that weight the start of the increment are wrong by 30 %
and more in a single increment from a cold start, and TOL=1E-3 leaves 4e-7 of the heat."""
CASES = {
    "cylinder": ("cylinder/cylinder.inp", "The published cylinder", CYLINDER),
    "cylinder-coupled": ("cylinder/cylinder-coupled.inp", "Its coupled twin", TWIN),
    "r2": ("rods/r2.inp", "Rod R2", ROD),
}
HEADS = {"normal_force": "force", "heat_rate": "heat", "peak_pressure": "peak",
         "edge_contact": "contact", "edge_stick": "stick", "temperature": "temp."}
WISHES = {"recommended_10": "10 %", "recommended_1": "1 %", "recommended_0.1": "0.1 %"}


def table_of(name, folder):
    """Return the file of the trade of a deck: one of the folder THERCON_TRADES, where runs may have
    been made before, or of a run in this folder."""
    before = Path(os.environ.get("THERCON_TRADES", folder)) / f"{name}.trade.csv"
    if not before.exists():
        process = run("trade", INPUT / CASES[name][0], "--out", folder, "--quiet", "--limit", LIMIT,
                      seconds=3000)
        assert process.returncode == 0, process.stderr
        before = folder / f"{name}.trade.csv"
    return before


def percent(text):
    """Return a relative error in percent with two digits, or -."""
    if not text:
        return "-"
    number = 100 * float(text)
    return "> 1000" if number >= 1000 else f"{number:.2g}" if number < 99.5 else f"{number:.0f}"


def described(row):
    """Return mesh, increments and what is varied of a row."""
    factor = float(row["increment_factor"])
    times = f"x {factor:g}" if factor >= 1 else f"x 1/{1 / factor:g}"
    level, more = int(row["level"]), int(row["contact_level"])
    sides = f"{2 ** level}:{2 ** (level + more)}" if more else f"{2 ** level}"
    return f"{row['elements']} x {sides}, {times}"


def case_table(name, path):
    """Return the table of a deck."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    shown = [key for key in HEADS if any(row[f"error_{key}"] for row in rows)]
    table = Table(CASES[name][1], ["row", "", "mesh, increments", "varied", "CPU s", "MB",
                                   *(f"{HEADS[key]}, %" for key in shown), "for"],
                  text=CASES[name][2])
    written = next(row for row in rows if row["default"] == "1")
    for row in rows[:-1]:
        wishes = [WISHES[key] + (" (not all)" if row[key] != "all" else "")
                  for key in WISHES if row[key]]
        if not (wishes or row["default"] == "1" or row["varied"] and differs(row, written)):
            continue
        marks = "\\*" * (row["pareto"] == "1") + "=" * (row["default"] == "1")
        errors = [percent(row[f"error_{key}"]) for key in shown]
        if row["status"] != "0":
            errors = ["failed"] * len(shown)
        table.rows.append([row["row"], marks, described(row), row["varied"],
                           f"{float(row['cpu_seconds']):.2g}", f"{float(row['peak_megabytes']):.0f}",
                           *errors, ", ".join(wishes)])
    table.rows.append(["", "", "uncertainty of the reference", "", "", "",
                       *(percent(rows[-1][f"error_{key}"]) for key in shown), ""])
    return table


def differs(row, written):
    """Return whether a row fails or has other errors than the deck as written, to two digits."""
    names = [name for name in row if name.startswith("error_") and written[name]]
    return row["status"] != "0" or any(percent(row[name]) != percent(written[name]) for name in names
                                       if float(row[name]) > ROUNDING)


def draw(path, target):
    """Draw a trade as post/plot does."""
    style.apply()
    save(trade.figure_of(trade.Trade(path)), target)


def tables(folder):
    """Return the parts of the section: a table and a picture for each deck."""
    parts = []
    for name in CASES:
        path = table_of(name, folder)
        table = case_table(name, path)
        kept = folder / f"{name}.trade.csv"
        if path != kept:
            shutil.copy(path, kept)
        parts += [table, Picture(f"trade-{name}.png", f"Errors and CPU time: {CASES[name][1]}", partial(draw, kept))]
    return parts


def test_r2_is_as_the_document_tells(tmp_path):
    """Times differ from run to run, and with them the rows that are best; what is varied, what
    fails and the size of the errors do not."""
    told = {row["varied"]: row for row in DOCUMENT.rows(CASES["r2"][1]) if row["varied"]}
    table = case_table("r2", table_of("r2", tmp_path))
    found = {row[3]: dict(zip(table.head, row, strict=True)) for row in table.rows if row[3]}
    assert found.keys() == told.keys()
    for varied, row in found.items():
        for key in ("heat, %", "temp., %"):
            if "failed" in (row[key], told[varied][key]):
                assert row[key] == told[varied][key]
            elif float(told[varied][key]) > 1e-6:
                assert float(row[key]) == float(told[varied][key])
