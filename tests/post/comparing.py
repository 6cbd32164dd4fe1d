"""Calls of post/compare, for the tests here."""

import csv
import sys
from pathlib import Path

import numpy as np
import pytest

POST = Path(__file__).resolve().parents[2] / "post"
sys.path.insert(0, str(POST.parent / "python"))

from thercon.post.comparison.cli import main  # noqa: E402

CALCULIX = Path(__file__).resolve().parent / "calculix"


@pytest.fixture
def compare(tmp_path, capsys):
    """Return a function that calls compare and gives exit status, output and message."""

    def call(*arguments, picture=False):
        quick = [] if picture else ["--no-picture"]
        status = main([*map(str, arguments), "--out", str(tmp_path / "out"), *quick])
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return call


@pytest.fixture
def refused(compare):
    """Return a function that calls compare, expects exit status 2, and gives the message."""

    def call(*arguments):
        status, _, said = compare(*arguments)
        assert status == 2
        assert said.startswith("compare: error: ") and said.count("\n") == 1
        return said

    return call


def write_csv(path, columns):
    """Write {name: values} as a CSV file; return its path."""
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*(np.asarray(values).tolist() for values in columns.values())))
    return path


def line_of(output, quantity):
    """Return the fields of one quantity of the printed table, without `where`.

    Keys: by, times, rows, not_in_a, not_in_b, and whatever follows as `rest`.
    """
    (words,) = [w.split() for w in output.splitlines() if w.split()[:1] == [quantity]]
    names = ("by", "times", "rows", "not_in_a", "not_in_b")
    line = dict(zip(names, [words[1], *map(int, words[2:6])]))
    return line | {"rest": words[6:], "ok": "ok" in words[6:]}


def blocks_of(tmp_path, stem="case"):
    """Return the rows of the table of blocks."""
    with open(tmp_path / "out" / f"{stem}.compare-blocks.csv", newline="") as file:
        return list(csv.DictReader(file))
