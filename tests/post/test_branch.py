"""Pictures and page of a branch of solutions: stable parts are full lines, unstable ones dashed."""

import csv
import re
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "decks"), str(TESTS.parent / "python")]

from deck_runs import INPUT, solve  # noqa: E402

from thercon.post.branch import parts  # noqa: E402
from thercon.post.cli import main as plot  # noqa: E402
from thercon.post.report.cli import main as report  # noqa: E402
from thercon.post.result import Result  # noqa: E402


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """Return the branch of the rods R3 through both folds."""
    deck = tmp_path_factory.mktemp("branch") / "r3.inp"
    text = (INPUT / "rods" / "r3-open.inp").read_text().split("*VERIFY")[0]
    for old, new in {"*START, FROM=OPEN\n": "", ", DIRECT\n1., 1.": "\n0.02, 1.\n*CONTINUATION, HIGHEST=1.5",
                     "INPUT=": f"INPUT={INPUT}/rods/"}.items():
        assert old in text
        text = text.replace(old, new)
    deck.write_text("*OPTIONS, WIDTH=300\n" + text)
    return solve(deck)


def history(result, *names):
    with h5py.File(result) as file:
        return [file["history"][name][:] for name in names]


def test_parts_join_where_stability_changes():
    assert parts(np.array([0, 0, 1, 1, 1, 0]) > 0) == [(0, 3, False), (2, 6, True), (5, 6, False)]
    assert parts(np.array([0, 0]) > 0) == [(0, 2, False)]


def test_picture_has_all_points_and_the_quantity_asked_for(result, tmp_path):
    factor, fold, unstable = history(result, "load_factor", "fold", "unstable")
    for arguments, name, key in (([], "r3.branch", "heat_rate"),
                                 (["--quantity", "normal_force"], "r3.branch-normal_force", "normal_force")):
        assert plot(["branch", str(result), "--csv", "--out", str(tmp_path), *arguments]) == 0
        with (tmp_path / f"{name}.csv").open() as file:
            rows = list(csv.DictReader(file))
        np.testing.assert_allclose([float(row["load_factor"]) for row in rows], factor, rtol=1e-12)
        assert [int(float(row["fold"])) for row in rows] == list(fold)
        assert [int(float(row["unstable"])) for row in rows] == list(unstable)
        with h5py.File(result) as file:
            np.testing.assert_allclose([float(row[key]) for row in rows],
                                       file[f"contact/FACE/{key}"][:], rtol=1e-12)
        assert (tmp_path / f"{name}.png").exists()


def test_a_point_of_a_branch_has_one_time_and_its_load_factor(result, tmp_path, browser):
    """The load axis is the time, as nothing else is asked for; so all pictures and tables say."""
    with Result(result) as opened:
        last = opened.increments - 1
        assert opened.load_words(last) == f"time {opened.history['time'][last]:g}, load factor 1.5"
    listing = result.with_suffix(".lst").read_text()
    times, loads = zip(*re.findall(r"^INCREMENT \d+ +STEP \d+ +TIME (\S+) +LOAD (\S+)", listing, re.M))
    assert times == loads
    assert report([str(result), "--out", str(tmp_path)]) == 0
    browser.open(tmp_path / "r3.html")
    assert browser.run("return document.getElementById('now').textContent").endswith(", load factor 1.5")


def test_unknown_quantity_and_a_result_without_a_branch_are_errors(result, tmp_path, capsys):
    assert plot(["branch", str(result), "--quantity", "hat_rate", "--out", str(tmp_path)]) == 2
    assert "has no quantity 'hat_rate', nearest: 'heat_rate'" in capsys.readouterr().err
    other = tmp_path / "r1.inp"
    other.write_text((INPUT / "rods" / "r1.inp").read_text().replace("INPUT=", f"INPUT={INPUT}/rods/"))
    other.write_text("*OPTIONS, WIDTH=300\n" + other.read_text())
    assert plot(["branch", str(solve(other)), "--out", str(tmp_path)]) == 2
    assert "its deck has no *CONTINUATION" in capsys.readouterr().err


def test_page_draws_quantities_over_the_load_factor(result, tmp_path, browser):
    assert report([str(result), "--out", str(tmp_path)]) == 0
    browser.open(tmp_path / "r3.html")
    words, dashes = browser.run(
        """const all = document.getElementById('history-0');
        return [all.textContent, [...all.querySelectorAll('svg path[stroke="var(--blue)"]')]
            .map(line => line.getAttribute('stroke-dasharray'))]""")
    assert "Load factor" in words and "unstable: an odd number of modes grows" in words
    assert "5 3" in dashes and "" in dashes
