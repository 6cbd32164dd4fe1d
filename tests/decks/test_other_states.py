"""Where the conductance jumps as a gap closes, several contact states satisfy all conditions.

An elastic body on a wavy conductor, both held at the sides: as far as the wave goes, contact ends at
0.3 of it (C. Panek, J. Dundurs, J. Appl. Mech. 46 (1979) 854-860).
"""

import math
import re

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import solve
from physics import material, mesh

SIDES, DEPTH, EDGE = 15, 3.0, 0.3


def face(folder, increments, errors):
    """Solve the body in some increments; return the edge of contact, its uncertainty and the notes."""
    xs = [0.5 * i / SIDES for i in range(SIDES + 1)]
    ys = [DEPTH * (1.24**j - 1.0) / (1.24**16 - 1.0) for j in range(17)]
    wave = mesh("RG", xs, [-0.1, 0.0], first=10001, to=lambda x, y: (
        x, y - 1e-3 * (1.0 - math.cos(2.0 * math.pi * x)) * (1.0 + 10.0 * y)))
    deck = write(folder / f"in{increments}.inp", [
        f"*OPTIONS, ERRORS={errors}",
        *mesh("EL", xs, ys), *wave, *material("EL", (1e3, 0.3), 2e-3, 1.0),
        *material("RG", (1e3, 0.3), None, 1.0), "*SURFACE INTERACTION, NAME=I", "*GAP LAW, TYPE=POWER",
        "1.E5, 0., 1.", "*CONTACT PAIR, INTERACTION=I, NAME=J", "EL.BOTTOM, RG.TOP",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "EL, 0.", "RG, 0.", "*STEP, INC=400",
        "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", f"{1.0 / increments}, 1.",
        "*BOUNDARY", "RG, 1, 2", "EL.LEFT, 1", "EL.RIGHT, 1", "RG, 11, 11, 12.2698444756",
        "EL.TOP, 11, 11, 0.", "*DSLOAD", "EL.TOP, P, 2.67347837203", "*END STEP"])
    result = solve(deck)
    with h5py.File(result) as file:
        value, uncertainty = file["uncertainty/J/edge_contact"][-1, :2]
    notes = [" ".join(note.split()) for note in re.findall(
        r"note: (.*(?:\n {5,}\S.*)*)", deck.with_suffix(".lst").read_text())]
    return value, uncertainty, [note for note in notes if note.startswith("edge_contact of J is ")]


@pytest.mark.parametrize("errors", ["LAST", "FULL"])
def test_where_increments_decide_between_states_both_are_told(tmp_path, errors):
    """Heat enters at a contact point that is closed and expands the body there: it stays closed, or
    it stays open and cold. One increment ends at the exact edge, ten before it."""
    one, ten = face(tmp_path, 1, errors), face(tmp_path, 10, errors)
    assert one[0] == pytest.approx(EDGE) and one[1] > 0.0 and not one[2]
    assert one[0] - ten[0] > 0.3 * 0.25 / SIDES
    assert np.isnan(ten[1])
    note, = ten[2]
    told = re.match(r"edge_contact of J is (\S+) or (\S+): the conductance jumps as the gap closes, "
                    "two contact states satisfy all conditions", note)
    assert [float(edge) for edge in told.groups()] == pytest.approx([ten[0], EDGE], rel=1e-5)
