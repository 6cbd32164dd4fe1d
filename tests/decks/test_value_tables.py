"""`thercon run DECK --table`: a run for each row of values, and one table of their results."""

import csv
import os
import signal
import subprocess
import time
from pathlib import Path

import h5py
import pytest
from deck_runs import INPUT, PATIENCE, PROGRAM, copy_deck, run
from test_sweep import AREA, EXPANSION, LENGTH, YOUNG

FACTS = ["run", "status", "outcome", "reason", "increments", "iterations", "checks_passed",
         "checks_failed", "seconds", "cpu_seconds", "peak_megabytes"]
CHECKS = ('*VERIFY, KIND=ANALYTIC, SOURCE="boundary"', "NT, 6, LAST, 300., 1.E-9", "NT, 6, 0.5, 150., 1.E-9",
          "heat_rate, FACE, LAST, 1., 1.E9, ABS", "NT, 6, LAST, 999., 1.E-9",
          "NT reaches 75., 6, LAST, 1., 1.E9, ABS")


@pytest.fixture
def joint(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return copy_deck(INPUT / "sweep/joint.inp", Path("joint.inp"))


def values(text, name="values.csv"):
    with open(name, "w") as file:
        file.write(text)
    return name


def rows(path="out/joint.table.csv"):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_each_row_is_the_run_with_its_values(joint):
    """In the order of the table, whatever ends first; blank lines and blanks are no matter."""
    table = values("gap, hot\n1e-4,300\n\n2e-4, 500\n 3.E-4,800\n")
    done = run("run", joint, "--table", table, "--jobs", 2, "--out", "out")
    assert done.returncode == 0, done.stderr
    found = rows()
    assert list(found[0])[:13] == ["gap", "hot", *FACTS]
    assert [(row["run"], row["gap"], row["hot"]) for row in found] == [
        ("joint-1", "1e-4", "300"), ("joint-2", "2e-4", "500"), ("joint-3", "3.E-4", "800")]
    assert [row["outcome"] for row in found] == ["solved"] * 3
    for number, row in enumerate(found, 1):
        done = run("run", joint, "--quiet", "--out", "single", "--set", f"gap={row['gap']}",
                   "--set", f"hot={row['hot']}")
        assert done.returncode == 0, done.stderr
        with h5py.File("single/joint.vtkhdf") as file, h5py.File(f"out/joint-{number}.vtkhdf") as own:
            for name in ("heat_rate", "normal_force"):
                assert float(row[f"{name} FACE"]) == file["contact/FACE"][name][-1]
                assert own["contact/FACE"][name][-1] == file["contact/FACE"][name][-1]
                estimate = file["uncertainty/FACE"][name][-1, 1]
                assert float(row[f"{name} FACE uncertainty"]) == estimate
        assert float(row["highest_temperature"]) == float(row["hot"])
        assert float(row["heat_in"]) == pytest.approx(float(row["heat_rate FACE"]), rel=1e-9)


def test_checks_are_columns_by_their_names(joint):
    """Those of quantities at the end that the summary has are no second column; later times are named."""
    joint.write_text(joint.read_text() + "\n".join(CHECKS) + "\n")
    done = run("run", joint, "--table", values("hot\n300\n600\n"), "--out", "out", "--quiet")
    assert done.returncode == 4
    first, second = rows()
    names = list(first)
    assert names.count("heat_rate FACE") == 1 and names.count("NT 6") == 1
    named = [line.rpartition(",")[0] for line in Path("out/joint-1.csv").read_text().splitlines()]
    assert len(set(named)) == len(named)
    assert (float(first["NT 6"]), float(second["NT 6"])) == (300.0, 600.0)
    assert (float(first["NT 6 at 0.5"]), float(second["NT 6 at 0.5"])) == (150.0, 300.0)
    # Heated evenly from 0 in a time of 1.
    reached = [float(row["NT reaches 75 6"]) for row in (first, second)]
    assert reached == pytest.approx([0.25, 0.125], rel=1e-9)
    assert [(row["checks_passed"], row["checks_failed"]) for row in rows()] == [("4", "1"), ("2", "3")]
    assert [row["status"] for row in rows()] == ["4", "4"]


def test_a_row_that_fails_leaves_the_others_alone(joint):
    """And its messages are told with its values; what an earlier run left is no result of it."""
    joint.write_text(joint.read_text().replace("*STEP", "*AMPLITUDE, NAME=A\n0., 0., <last>, 1.\n*STEP", 1)
                     .replace("*PARAMETER\n", "*PARAMETER\nlast = 1.\n"))
    assert run("run", joint, "--table", values("last\n1.\n2.\n"), "--out", "out").returncode == 0
    done = run("run", joint, "--table", values("last\n1.\n-2.\n"), "--out", "out")
    assert done.returncode == 1
    assert "joint-2: last=-2.\njoint.inp:" in done.stderr
    good, bad = rows()
    assert good["status"] == "0" and good["heat_rate FACE"]
    assert bad["status"] == "1" and bad["outcome"] == "deck error" and bad["reason"]
    assert not bad["heat_rate FACE"]


@pytest.mark.parametrize(("table", "said"), [
    ("gap,hott\n1,2\n", ["1:5: error: no *PARAMETER of joint.inp has the name hott"]),
    ("gap;hot\n1;2\n", ["1:1: error: commas separate the fields of a table, not semicolons"]),
    ("gap\thot\n1\t2\n", ["1:1: error: commas separate the fields of a table, not tabs"]),
    ("gap,hot,GAP\n1,2,3\n", ["1:9: error: column GAP is there twice"]),
    ("gap,,hot\n1,2,3\n", ["1:5: error: column 2 has no name"]),
    ("gap,hot\n1\n2,\n,3\n", ["2:1: error: there is no value of hot in this row",
                               "3:3: error: there is no value of hot", "4:1: error: there is no value of gap"]),
    ("gap,hot\n1,2\nx,2\n1,2,3\n", ["3:1: error: gap needs a number, not x",
                                     "4:5: error: this row has 3 values, and the table 2 columns"]),
    ("", ["1:1: error: the table is empty"]),
    ("\ngap\n", ["2:1: error: no row of values follows"]),
    (None, [" error: the table cannot be read: there is no such file"]),
])
def test_mistakes_of_a_table_are_told_with_their_places(joint, table, said):
    """Each once, and nothing is run."""
    if table is not None:
        values(table)
    done = run("run", joint, "--table", "values.csv", "--out", "out")
    assert done.returncode == 1 and not os.path.exists("out")
    errors = [line for line in done.stderr.splitlines() if ": error: " in line]
    assert len(errors) == len(said)
    for error, words in zip(errors, said):
        assert error.startswith(f"values.csv:{words}")


@pytest.mark.parametrize(("more", "said"), [
    (["--set", "hot=5"], "values.csv:1:5: error: --set gives hot, too"),
    (["--json"], "--json takes one deck"), (["--restart", "x"], "--restart does not go with --table"),
    (["other.inp"], "--table takes one deck")])
def test_what_does_not_go_with_a_table_is_refused(joint, more, said):
    done = run("run", joint, "--table", values("gap,hot\n1,2\n"), *more)
    assert done.returncode == 1 and said in done.stderr


def test_a_parameter_like_a_column_of_the_results_is_refused(joint):
    joint.write_text(joint.read_text().replace("*PARAMETER\n", "*PARAMETER\nstatus = 1\n"))
    done = run("run", joint, "--table", values("status\n1\n"))
    assert "1:1: error: the table of results has a column status of its own" in done.stderr


def test_a_table_is_not_overwritten(joint):
    run("run", joint, "--table", values("gap\n1e-4\n"), "--out", ".")
    for name in ("joint-1.csv", "joint.table.csv"):
        before = os.stat(values("gap\n1e-4\n", name)).st_mtime_ns
        done = run("run", joint, "--table", name, "--out", ".")
        assert done.returncode == 1 and "would be written over" in done.stderr
        assert os.stat(name).st_mtime_ns == before


def wait_for(path, process):
    until = time.monotonic() + PATIENCE
    while not os.path.exists(path):
        assert time.monotonic() < until and process.poll() is None
        time.sleep(0.005)


@pytest.mark.parametrize("kills", [False, True])
def test_an_interrupted_table_goes_on(joint, kills):
    """By SIGINT, which all hear, or SIGKILL: rows that are finished stay as they are, the others are
    solved, and the table is that of a run that was not interrupted."""
    copy_deck(joint, joint, changes={"0.1, 1.": "0.002, 1."})
    table = values("gap\n1e-4\n1.5e-4\n2e-4\n3e-4\n")
    command = [PROGRAM, "run", "joint.inp", "--table", table, "--out", "out", "--quiet"]
    process = subprocess.Popen(command, stderr=subprocess.DEVNULL)
    wait_for("out/joint-2.csv", process)
    process.send_signal(signal.SIGKILL if kills else signal.SIGINT)
    assert process.wait(PATIENCE) == (-signal.SIGKILL if kills else 5)
    assert any(row["status"] in ("", "5") for row in rows())
    before = os.stat("out/joint-1.vtkhdf").st_mtime_ns
    done = run("run", "joint.inp", "--table", table, "--out", "out", "--quiet", "--resume")
    assert done.returncode == 0, done.stderr
    assert os.stat("out/joint-1.vtkhdf").st_mtime_ns == before
    assert rows()[0]["reason"] == "its result is finished"
    assert run("run", "joint.inp", "--table", table, "--out", "whole", "--quiet").returncode == 0
    for own, other in zip(rows(), rows("whole/joint.table.csv")):
        results = list(own)[1 + len(FACTS):]
        assert results and [own[name] for name in results] == [other[name] for name in results]


def test_a_finished_row_without_its_line_is_solved_again(joint):
    """As where the program was killed between its result and that."""
    table = values("gap\n1e-4\n")
    run("run", joint, "--table", table, "--out", "out", "--quiet")
    force = rows()[0]["normal_force FACE"]
    os.remove("out/joint-1.csv")
    done = run("run", joint, "--table", table, "--out", "out", "--quiet", "--resume")
    assert done.returncode == 0 and rows()[0]["normal_force FACE"] == force
    assert not rows()[0]["reason"]


def test_a_row_with_other_values_is_solved_again(joint):
    """The forces are those of two rods whose ends are held, test_sweep."""
    for hot in (500, 600):
        done = run("run", joint, "--table", values(f"gap,hot\n0.,{hot}\n"), "--out", "out", "--resume")
        assert done.returncode == 0, done.stderr
        (row,) = rows()
        heat = float(row["heat_rate FACE"]) / AREA
        expansion = EXPANSION * (LENGTH * hot - LENGTH**2 * heat / 40.0)
        assert float(row["normal_force FACE"]) / AREA == pytest.approx(
            expansion * YOUNG / (2 * LENGTH), rel=1e-6)


def test_a_row_that_begins_anew_has_no_results_of_an_earlier_run(joint):
    """As where a run with another deck was killed before it wrote its own."""
    table = values("gap\n1e-4\n")
    run("run", joint, "--table", table, "--out", "out", "--quiet")
    copy_deck(joint, joint, changes={"0.1, 1.": "0.0001, 1."})
    process = subprocess.Popen([PROGRAM, "run", "joint.inp", "--table", table, "--out", "out", "--quiet"])
    until = time.monotonic() + PATIENCE
    while os.path.exists("out/joint-1.csv"):
        assert time.monotonic() < until and process.poll() is None
    process.kill()
    process.wait()
