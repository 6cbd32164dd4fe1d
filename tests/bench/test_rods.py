"""The theme of many interfaces: rods of pellets, on a sparse tail and with the full matrix."""

import os

import report  # isort: skip, it makes the modules below known
import h5py
import numpy as np
import pytest
from blocks import write
from document import Table
from pellets import rod
from runs import measured

TITLE = "Many interfaces"
TEXT = """
Rods of pellets in a tube, friction and gas between pellets
and tube and from pellet to pellet, four increments, with `ERRORS=NO`. The exponent is that of the
time with the length of the rod, from the row before. A full matrix of all contact unknowns is what
one interface has; from 200 contact points between more than two bodies on the tail is sparse.
"""
PELLETS = {"SPARSE": (10, 20, 40, 80, 160, 360), "FULL": (10, 20, 40)}
COUNTS = (6, 8, 2)   # elements of a pellet across and along, and of the tube across


def cost(folder, pellets, tail):
    """Return CPU seconds, peak memory, displacements and contact points of a run."""
    cards = [card for card in rod(pellets, tail, friction=0.3, counts=COUNTS)
             if not card.startswith("*FIXED POINT")]   # of decks whose solutions are compared
    deck = write(folder / f"{tail}{pellets}.inp", cards)
    spent = measured([os.environ["THERCON"], "run", "--quiet", deck, "--out", folder], folder)
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        points = sum(group["gap"].shape[1] for group in file["contact"].values())
        return spent.cpu, spent.memory, 2 * file["VTKHDF/NumberOfPoints"][0], points


def tables(folder):
    """Return the table of both tails."""
    table = Table("Rods of pellets", ["tail", "pellets", "displacements", "contact points",
                                      "time [s]", "exponent", "memory [MB]"])
    for tail, lengths in PELLETS.items():
        before = None
        for pellets in lengths:
            spent, memory, unknowns, points = cost(folder, pellets, tail)
            grows = np.log(spent / before[0]) / np.log(pellets / before[1]) if before else None
            table.rows.append([tail, str(pellets), f"{unknowns:,}", f"{points:,}", f"{spent:.2f}",
                               f"{grows:.1f}" if before else "", f"{memory:.0f}"])
            before = spent, pellets
    return [table]


@pytest.mark.skipif(os.environ.get("THERCON_BUILD_TYPE", "Release") != "Release",
                    reason="time is that of a release build")
def test_a_rod_has_a_cost(tmp_path):
    spent, memory, unknowns, points = cost(tmp_path, 3, "SPARSE")
    assert spent > 0
    assert memory > 0
    assert unknowns == 2 * (3 * 63 + 3 * 25)
    assert points == 3 * 9 + 2 * 7
