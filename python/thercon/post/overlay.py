"""Figures that users digitised themselves, laid over profiles and zone diagrams."""

import csv
from pathlib import Path

import numpy as np
from matplotlib.lines import Line2D

from . import style
from .errors import UserError, nearest_name


class Overlay:
    """One digitised figure: its columns, and the looks of its curves."""

    def __init__(self, path, columns, number):
        self.label, self.columns = style.plain(Path(path).stem), columns
        colour = style.SERIES[1 + number % (len(style.SERIES) - 1)]
        self.looks = {"color": colour, "lw": 0.7, "marker": "x", "ms": 3.2}

    def plot(self, axes, abscissa, quantity, linestyle, magnitude=False):
        """Draw one column against another; the column `load`, where it is not the abscissa,
        separates curves. Returns the ordinates drawn."""
        if quantity not in self.columns:
            return np.array([])
        at, values = self.columns[abscissa], self.columns[quantity]
        values = np.abs(values) if magnitude else values
        there = ~(np.isnan(at) | np.isnan(values))
        for curve in self.curves(abscissa):
            rows = there & curve
            axes.plot(at[rows], values[rows], linestyle=linestyle, zorder=4, **self.looks)
        return values[there]

    def curves(self, abscissa):
        """Return row masks: one for each value of the column `load`, or one for all rows."""
        load = self.columns.get("load")
        if abscissa == "load" or load is None or np.isnan(load).all():
            return [np.ones(len(self.columns[abscissa]), dtype=bool)]
        return [load == value for value in np.unique(load[~np.isnan(load)])]

    def handle(self):
        """Return the legend's entry."""
        return Line2D([], [], label=self.label, **self.looks)

    def handles(self, names, lines):
        """Return the legend's entries, one for each column of {quantity: name} that is there."""
        return [
            Line2D([], [], label=f"{self.label}: {name}", ls=lines[quantity], **self.looks)
            for quantity, name in names.items()
            if quantity in self.columns
        ]


def file_parts(paths):
    """Return what stands in a file name for the digitised figures laid over."""
    return ["with", *(Path(path).stem for path in paths)] if paths else []


def axis_words(along):
    """Return what stands in a file name for the axis asked for, if one was."""
    return ["along", along] if along else []


def read_overlays(paths, abscissa, curves, others):
    """Read digitised figures; the arguments are those of `read_figure`."""
    return [Overlay(p, read_figure(p, abscissa, curves, others), k) for k, p in enumerate(paths)]


def read_figure(path, abscissa, curves, others):
    """Read a digitised figure: columns `abscissa` and at least one of `curves`.

    Empty fields are passed over, as are lines that begin with '#' and the columns `others`,
    which the tables written here have. Returns {name: values (rows), NaN where empty}.
    """
    path = Path(path)
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as reason:
        raise UserError(f"{path}: cannot be read ({reason})") from None
    kept = [(k, line) for k, line in enumerate(lines, 1) if line.strip() and line[0] != "#"]
    if not kept:
        raise UserError(f"{path}: is empty")
    number, heading = kept[0]
    names = [name.strip().lower() for name in next(csv.reader([heading]))]
    check_heading(f"{path}:{number}", names, abscissa, curves, others)
    values = [numbers_of(f"{path}:{k}", line, names, others) for k, line in kept[1:]]
    if not values:
        raise UserError(f"{path}: has a heading and no rows")
    columns = dict(zip(names, np.array(values).T))
    return {name: columns[name] for name in names if name in (abscissa, "load", *curves)}


def check_heading(where, names, abscissa, curves, others):
    """Raise the error that says which columns do not fit."""
    wanted = f"'{abscissa}' and at least one of {', '.join(curves)}"
    known = [abscissa, *curves]
    for name in names:
        if name not in known and name not in others:
            hint = nearest_name(name, known)
            raise UserError(f"{where}: unknown column '{name}'{hint}; wanted: {wanted}")
    if len(set(names)) != len(names):
        raise UserError(f"{where}: a column stands twice")
    if abscissa not in names or not set(curves) & set(names):
        raise UserError(f"{where}: columns are {', '.join(names)}; wanted: {wanted}")


def numbers_of(where, line, names, others):
    """Return the numbers of one row, NaN for empty fields and passed-over columns."""
    fields = next(csv.reader([line]))
    if len(fields) != len(names):
        raise UserError(f"{where}: {len(fields)} fields, the heading has {len(names)}")
    row = []
    for name, field in zip(names, fields):
        try:
            passed_over = name in others and name != "load"
            row.append(float(field) if field.strip() and not passed_over else np.nan)
        except ValueError:
            raise UserError(f"{where}: '{field.strip()}' in column {name} is no number") from None
    return row
