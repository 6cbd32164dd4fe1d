"""CSV files of what was drawn."""

import csv

import numpy as np


FORMULA = ("=", "+", "-", "@", "\t", "\r")   # beginnings that a spreadsheet takes for a formula


def cell(value):
    """Return what is written of a value: a text that is no formula of a spreadsheet."""
    return "'" + value if isinstance(value, str) and value.startswith(FORMULA) else value


def write_table(path, columns):
    """Write columns {name: values}, all of one length; numbers keep every digit. A byte in the name
    of a file that is no UTF-8 becomes a question mark."""
    rows = zip(*(np.asarray(values).tolist() for values in columns.values()), strict=True)
    with open(path, "w", newline="", encoding="utf-8", errors="replace") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(map(cell, columns))
        writer.writerows(map(cell, row) for row in rows)


def stack_tables(tables):
    """Return tables {name: values} of the same columns as one, one below the other."""
    return {name: np.concatenate([np.asarray(t[name]) for t in tables]) for name in tables[0]}
