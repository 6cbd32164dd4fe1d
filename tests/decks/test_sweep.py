"""input/sweep: runs by Snakemake, one of them failing, and a second start that runs what is missing.

Every run is held to the closed form of its two rods: with the free expansion e = a L T - a L^2 q/(2 k) of the first,
the gap is g - e and omega = A/(B + gap) while they are apart, else p = (e - g)/(2 L/E) and omega = A/B + C p; and
q = T/(2 L/k + 1/omega).
"""

import csv
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from deck_runs import INPUT, PATIENCE, PROGRAM

# `./setup.sh test` installs it there; the packages are none of those of the post-processing.
SNAKEMAKE = Path(__file__).resolve().parents[2] / "build" / "sweep" / "bin" / "snakemake"
LENGTH, CONDUCTIVITY, YOUNG, EXPANSION = 0.1, 20.0, 2e11, 12e-6
GAS_A, GAS_B, CLOSED_C = 0.15, 1e-5, 1e-4
AREA = 0.05 * 20.0
EVERY, RUNS = 10, 20  # every tenth row of the table
WRONG = 110  # the run whose gap is no number

with_snakemake = pytest.mark.skipif(not SNAKEMAKE.exists(),
                                reason="build/sweep has no Snakemake; ./setup.sh test makes it")


def start(folder):
    """Start the workflow; return the finished process."""
    return subprocess.run(
        [SNAKEMAKE, "--cores", "2", "--keep-going", "--config", f"thercon={PROGRAM}",
         f"python={sys.executable}"],
        cwd=folder, capture_output=True, text=True, timeout=PATIENCE,
        env={**os.environ, "HOME": str(folder), "XDG_CACHE_HOME": str(folder / "cache")},
    )


def workflow(folder):
    """Copy the workflow into a folder, with the part of its table that is run here."""
    shutil.copytree(INPUT / "sweep", folder)
    path = folder / "values.csv"
    heading, *rows = path.read_text().splitlines()
    path.write_text("\n".join([heading, *rows[EVERY - 1::EVERY]]) + "\n")


def change(folder, run, old, new):
    """Change a field of a run in the table of values."""
    path = folder / "values.csv"
    lines = path.read_text().splitlines()
    (line,) = (number for number, text in enumerate(lines) if text.startswith(f"{run:03d},"))
    fields = lines[line].split(",")
    fields[fields.index(old)] = new
    lines[line] = ",".join(fields)
    path.write_text("\n".join(lines) + "\n")


def gathered(folder):
    """Return the rows of the gathered table by run."""
    with (folder / "sweep.csv").open(newline="") as file:
        rows = {row["run"]: row for row in csv.DictReader(file)}
    assert (folder / "sweep.png").read_bytes().startswith(b"\x89PNG")
    return rows


def ages(folder):
    """Return when each result was written, by run."""
    return {path.parent.name: path.stat().st_mtime_ns for path in folder.glob("runs/*/joint.vtkhdf")}


def assert_closed_form(row):
    """Assert that the gathered values of a run are those of its rods; the tolerance is ten times the fixed point's
    default, and of the gap's closed form, which takes the difference of two lengths."""
    gap, hot = float(row["gap"]), float(row["hot"])
    flux = float(row["heat_rate"]) / AREA
    free = EXPANSION * LENGTH * hot - EXPANSION * LENGTH**2 * flux / (2 * CONDUCTIVITY)
    pressure = max(0.0, (free - gap) / (2 * LENGTH / YOUNG))
    left = max(0.0, gap - free)
    omega = GAS_A / GAS_B + CLOSED_C * pressure if pressure > 0 else GAS_A / (GAS_B + left)
    assert flux == pytest.approx(hot / (2 * LENGTH / CONDUCTIVITY + 1 / omega), rel=1e-7)
    assert float(row["gap_left"]) == pytest.approx(left, rel=1e-7, abs=1e-7 * gap)
    assert float(row["pressure"]) == pytest.approx(pressure, rel=1e-7, abs=1e-7 * YOUNG * gap)


@with_snakemake
def test_runs_one_of_them_failing_and_a_second_start(tmp_path):
    folder = tmp_path / "sweep"
    workflow(folder)
    change(folder, WRONG, "5.0E-04", "5.0E-04m")
    process = start(folder)
    assert process.returncode == 1
    assert f"run {WRONG}: deck error" in process.stderr + process.stdout
    rows = gathered(folder)
    assert len(rows) == RUNS
    wrong = rows.pop(str(WRONG))
    assert wrong["outcome"] == "deck error" and "is not a number" in wrong["reason"]
    assert wrong["heat_rate"] == wrong["gap_left"] == wrong["pressure"] == ""
    assert {row["outcome"] for row in rows.values()} == {"solved"}
    for row in rows.values():
        assert_closed_form(row)
    closed = [row for row in rows.values() if float(row["pressure"]) > 0]
    assert RUNS / 10 < len(closed) < RUNS - RUNS / 10

    # Mended, lost and changed rows are run, and nothing else is.
    change(folder, WRONG, "5.0E-04m", "5.0E-04")
    change(folder, 10, "5.0E-04", "5.2E-04")
    shutil.rmtree(folder / "runs" / "020")
    before = ages(folder)
    process = start(folder)
    assert process.returncode == 0, process.stderr
    after = ages(folder)
    assert {run for run in after if after[run] != before.get(run)} == {"010", "020", str(WRONG)}
    rows = gathered(folder)
    assert len(rows) == RUNS
    for row in rows.values():
        assert row["outcome"] == "solved"
        assert_closed_form(row)


@pytest.mark.parametrize(("dataset", "told"), [("contact/FACE/heat_rate", None), ("contact/FACE/heat", "has no dataset contact/FACE/heat")])
def test_rows_without_names_are_numbered_and_a_wrong_quantity_is_told(tmp_path, dataset, told):
    folder = tmp_path / "sweep"
    workflow(folder)
    (folder / "values.csv").write_text("gap,hot\n5.0E-05,100.\n5.0E-04,200.\n")
    settings = folder / "sweep.toml"
    settings.write_text(settings.read_text().replace('"contact/FACE/heat_rate"', f'"{dataset}"'))
    for run, row in enumerate((("5.0E-05", "100."), ("5.0E-04", "200.")), 1):
        subprocess.run([PROGRAM, "run", "joint.inp", "--set", f"gap={row[0]}", "--set", f"hot={row[1]}", "--quiet", "--jobs", "1",
                        "--out", f"runs/{run}"], cwd=folder, check=True)
    process = subprocess.run([sys.executable, "gather.py"], cwd=folder, capture_output=True, text=True, check=False)
    if told:
        assert process.returncode == 1
        assert told in process.stderr and process.stderr.count("\n") == 1
    else:
        assert process.returncode == 0, process.stderr
        assert list(gathered(folder)) == ["1", "2"]
        for row in gathered(folder).values():
            assert_closed_form(row)


@pytest.mark.parametrize("name", ["sweep.csv", "values.csv"])
def test_the_values_are_not_written_over(tmp_path, name):
    folder = tmp_path / "sweep"
    workflow(folder)
    (folder / "values.csv").rename(folder / name)
    (folder / "link.csv").symlink_to(name)
    settings = folder / "sweep.toml"
    settings.write_text(settings.read_text().replace('"values.csv"', '"link.csv"'))
    before = (folder / name).read_bytes()
    process = subprocess.run([sys.executable, "gather.py"], cwd=folder, capture_output=True,
                             text=True, check=False)
    assert (folder / name).read_bytes() == before
    assert process.returncode == (1 if name == "sweep.csv" else 0), process.stderr
    assert ("would be written over the values" in process.stderr) == (name == "sweep.csv")
    assert (folder / "sweep.png").exists() == (name == "values.csv")
