"""The theme of the factors that change with the contact conductance."""

import re

import report  # isort: skip, it makes the modules below known
from cylinder import refined
from deck_runs import solve
from document import Table

TITLE = "Tail and full factorisation"
TEXT = """
Contact conductance changes the thermal matrix only in its last columns, the tail, which hold the
temperature jumps of the contact points. Only the part of the tail from the first changed column on
is factored again; *in full* is the cost of factoring the whole matrix each time. The listing gives
these numbers for each increment ("refactored"); here they are summed over the published cylinder.
"""
SAID = re.compile(r"refactored (\d+) of (\d+) columns .*?, (\d+) of (\d+) flops")


def counts(deck):
    """Return columns factored again and of full factorisations, and likewise operations."""
    listing = solve(deck).with_suffix(".lst").read_text()
    found = [[int(word) for word in match.groups()] for match in SAID.finditer(listing)]
    return [sum(column) for column in zip(*found, strict=True)]


def tables(folder, levels=range(4)):
    """Return the table of these refinements, with both solvers."""
    table = Table("Columns and operations of the thermal factors",
                  ["refinements", "solver", "columns", "in full", "their part", "operations",
                   "in full", "their part"])
    for level in levels:
        for solver in ("SKYLINE", "MUMPS"):
            deck = refined(folder, level, f"*SOLVER, TYPE={solver}")
            columns, all_columns, flops, all_flops = counts(deck)
            table.rows.append([
                level, solver, f"{columns:,}", f"{all_columns:,}",
                f"{100 * columns / all_columns:.2g} %", f"{flops:,}", f"{all_flops:,}",
                f"{100 * flops / all_flops:.2g} %"])
    return [table]


def test_the_tail_is_a_small_part_of_the_factors(tmp_path):
    """Of the published mesh less than a tenth of the columns are those of contact points."""
    deck = refined(tmp_path, 0)
    columns, all_columns, flops, all_flops = counts(deck)
    assert 0 < columns < 0.1 * all_columns
    assert 0 < flops < 0.1 * all_flops
    assert [row[0] for row in tables(tmp_path, levels=[0])[0].rows] == [0, 0]
