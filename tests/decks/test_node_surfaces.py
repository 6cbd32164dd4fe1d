"""`*SURFACE, TYPE=NODE`: the faces whose nodes it names."""

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import run, solve
from physics import material, mesh, nodes_of

XS = [0.0, 0.6, 1.3, 2.0]


def pair(kind, surface):
    """Return two blocks pressed together, the slave's surface as given."""
    return [*mesh("UP", XS, [0.0, 1.0], kind, first=101), *mesh("LOW", XS, [-1.0, 0.0], kind),
            *material("UP", (1000.0, 0.3)), *material("LOW", (1000.0, 0.2)), *surface,
            "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I, NAME=FACE",
            "SLAVE, LOW.TOP", "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "LOW.BOTTOM, 1, 2",
            "UP.LEFT, 1", "*DSLOAD", "UP.TOP, P, 5.", "*END STEP"]


@pytest.mark.parametrize("kind", ["CPE8", "CPS4", "CPE6"])
def test_nodes_name_the_faces_that_have_them(tmp_path, kind):
    """Numbers, and a set with an area as Abaqus has it, give what elements and faces give."""
    upper = mesh("UP", XS, [0.0, 1.0], kind, first=101)
    start = upper.index("*SURFACE, NAME=UP.BOTTOM") + 1
    faces = upper[start:start + len(XS) - 1]
    bottom = [f"{n}," for n, (_, y) in nodes_of(upper).items() if y == 0.0]
    results = []
    for name, surface in (("faces", ["*SURFACE, NAME=SLAVE", *faces]),
                          ("numbers", ["*SURFACE, NAME=SLAVE, TYPE=NODE", *bottom]),
                          ("set", ["*SURFACE, NAME=SLAVE, TYPE=NODE", "UP.BOTTOM, 1."])):
        with h5py.File(solve(write(tmp_path / f"{name}.inp", pair(kind, surface)))) as file:
            results += [file["contact/FACE/pressure"][-1]]
    assert np.max(results[0]) > 0.0
    for other in results[1:]:
        np.testing.assert_array_equal(other, results[0])


def test_a_node_beside_the_faces_is_refused(tmp_path):
    deck = write(tmp_path / "deck.inp", pair("CPE8", [
        "*SURFACE, NAME=SLAVE, TYPE=NODE", "UP.BOTTOM", "103"]))
    refused = run("check", deck)
    assert refused.returncode == 1
    assert "node 103 of surface SLAVE is on no side of an element" in refused.stderr
