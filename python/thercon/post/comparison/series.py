"""Tables of one file, as the comparison sees them: rows with keys, split into frames by time."""

from dataclasses import dataclass, field

import numpy as np

# What names a row. The axis of the frames, time or load, is no key within a frame.
KEYS = ("contact", "node", "element", "point")
COORDINATES = ("x", "y", "s")
AXES = ("time", "load")

# Quantities that are states: compared by counting mismatches, never by difference.
STATES = ("status", "closed")


@dataclass
class Series:
    """Tables with the same columns, one a time.

    `frames` are dictionaries {column: values (rows)}, or functions without arguments that return
    one. `axes` holds the frames' {"time": values, "load": values}, either or both; a table that
    has no time has one frame and no axes. A history is one frame with its axes as columns. Values
    that a file should have and has not are masked.
    """

    quantities: list
    frames: list
    axes: dict = field(default_factory=dict)
    history: bool = False

    def frame(self, number):
        """Return the columns of one frame."""
        columns = self.frames[number]
        return columns() if callable(columns) else columns


def alias(name, names):
    """Return `name` as it stands among names; None where it is not there.

    `normal_force` also stands for `normal_force@FACE` where there is no other one.
    """
    if name in names:
        return name
    places = [each for each in names if each.partition("@")[0] == name]
    return places[0] if len(places) == 1 and "@" not in name else None


@dataclass
class Source:
    """One file: its series, and what its reader has to say about it."""

    label: str
    kind: str
    series: list
    notes: list = field(default_factory=list)
    states: set = field(default_factory=lambda: set(STATES))
    units: object = None
    load_label: str = ""

    def names(self):
        """Return the names of all quantities."""
        return list(dict.fromkeys(name for each in self.series for name in each.quantities))


def masked(values):
    """Return values as numbers with a mask: None is what is missing."""
    mask = [value is None for value in values]
    return np.ma.array(
        [0.0 if value is None else value for value in values], mask=mask, dtype=float
    )


def split(columns):
    """Return the series of a long table {column: values}: a frame for each time, or load.

    A table without keys and coordinates, but with time or load, is a history.
    """
    axes = [name for name in AXES if name in columns]
    places = [name for name in (*KEYS, *COORDINATES) if name in columns]
    quantities = [name for name in columns if name not in (*axes, *places)]
    if axes and not places:
        return Series(quantities, [columns], history=True)
    if not axes:
        return Series(quantities, [columns])
    values = np.asarray(columns[axes[0]], dtype=float)
    starts = np.unique(values, return_index=True)[1]
    frames = [{key: each[values == values[k]] for key, each in columns.items()} for k in starts]
    at = {axis: np.asarray(columns[axis], dtype=float)[starts] for axis in axes}
    return Series(quantities, frames, at)
