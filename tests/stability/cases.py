"""What a case of the themes leaves behind: exit status, figures, datasets."""

import h5py
import numpy as np
import report
from blocks import write
from deck_runs import run

HEAD = ["case", "deviation", "allowed", "iterations", "smallest pivot", "residual", "verdict"]


class Outcome:
    """A deck that was run: its exit status, what it said and its result file."""

    def __init__(self, folder, name, *cards, status=0):
        """Write the cards as a deck, run it and keep how it ended."""
        deck = write(folder / f"{name}.inp", ["*OPTIONS, WIDTH=200"], *cards)
        process = run("run", "--quiet", deck, "--out", folder)
        self.path = deck.with_suffix(".vtkhdf")
        self.status, self.said = process.returncode, process.stderr
        assert self.status == status, self.said

    def read(self, name):
        """Return a dataset."""
        with h5py.File(self.path) as file:
            return file[name][()]

    def last(self, name, pair="F"):
        """Return a dataset of a contact pair at the last increment."""
        return self.read(f"contact/{pair}/{name}")[-1]

    def field(self, name):
        """Return a point field at the last increment, a row a node."""
        with h5py.File(self.path) as file:
            start = file["VTKHDF/Steps/PointDataOffsets"][name][-1]
            return file[f"VTKHDF/PointData/{name}"][start:]

    def figures(self):
        """Return the passes of all increments, the smallest pivot and the largest imbalance."""
        with h5py.File(self.path) as file:
            history = file["history"]
            passes = int(history["iterations"][()].sum())
            balances = [history[name][()] for name in ("heat_imbalance", "force_imbalance")
                        if name in history]
            pivot = float(file["run"].attrs["smallest_pivot"])
        return [passes, pivot, float(np.max(balances, initial=0.0))]


def deviation(value, expected, scale=None):
    """Return the largest difference of values from what is expected, relative to the largest."""
    value, expected = np.broadcast_arrays(np.asarray(value, float), np.asarray(expected, float))
    scale = np.abs(expected).max() if scale is None else scale
    return float(np.abs(value - expected).max() / scale)


def largest(*deviations):
    """Return the largest; NaN, as max does not, where any is."""
    return float(np.max(deviations))


def judged(name, outcome, off, allowed):
    """Return the row of a case whose result is off by so much."""
    return [name, off, allowed, *outcome.figures(), report.verdict(off <= allowed)]


def refused(name, outcome, words):
    """Return the row of a case that the program refuses, saying these words."""
    said = words in outcome.said
    return [name, "", "", "", "", "", "refused" if said else "FAIL"]
