"""The series of a CSV file with a heading."""

import csv
from pathlib import Path

import numpy as np

from ..errors import UserError
from .numbers import fortran_number
from .series import AXES, COORDINATES, KEYS, Source, masked, split


def read(path):
    """Return the source of a CSV file: columns are keys, coordinates, time or load, quantities.

    Empty fields are missing values, lines that begin with '#' are passed over.
    """
    try:
        lines = Path(path).read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as reason:
        raise UserError(f"{path}: cannot be read ({reason})") from None
    kept = [(k, line) for k, line in enumerate(lines, 1) if line.strip() and line[0] != "#"]
    if len(kept) < 2:
        raise UserError(f"{path}: has no heading, or a heading and no rows")
    names = [name.strip() for name in next(csv.reader([kept[0][1]]))]
    if "" in names or len(set(names)) != len(names):
        raise UserError(f"{path}:{kept[0][0]}: a column has no name, or one stands twice")
    rows = [fields(f"{path}:{k}", line, names) for k, line in kept[1:]]
    columns = {name: column(name, [row[k] for row in rows]) for k, name in enumerate(names)}
    source = Source(str(path), "CSV", [split(columns)])
    check_keys(path, columns)
    return source


def fields(where, line, names):
    """Return the fields of a row: texts for names of contacts, else numbers, None where empty."""
    words = [word.strip() for word in next(csv.reader([line]))]
    if len(words) != len(names):
        raise UserError(f"{where}: {len(words)} fields, the heading has {len(names)}")
    row = []
    for name, word in zip(names, words):
        value = word if name == "contact" else fortran_number(word) if word else None
        if value is None and word:
            raise UserError(f"{where}: '{word}' in column {name} is no number")
        row.append(value)
    return row


def column(name, values):
    """Return one column: an array for keys, else numbers with a mask."""
    return np.array(values) if name == "contact" else masked(values)


def check_keys(path, columns):
    """Raise the error for a key, coordinate or time that a row has not."""
    for name in (*KEYS, *COORDINATES, *AXES):
        if name in columns and np.ma.getmaskarray(columns[name]).any():
            raise UserError(f"{path}: column {name} has empty fields; it tells the rows apart")
