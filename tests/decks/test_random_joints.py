"""Bodies that contact alone holds, loaded on nodes that constraints relate to them: four by hand,
and random ones whose equations are assembled outside the program."""

import h5py
import pytest
from blocks import write
from deck_runs import solve
from random_joints import trial

ROUNDING = 1e-9   # of the largest force or displacement

BLOCKS = """
*NODE, NSET=BOTTOM
1, 0., 0.
2, 10., 0.
*NODE
3, 10., 10.
4, 0., 10.
5, 0., 10.
6, 10., 10.
7, 10., 20.
8, 0., 20.
*NODE, NSET=REF
100, 5., 25.
*ELEMENT, TYPE=CPE4, ELSET=BLOCKS
1, 1, 2, 3, 4
2, 5, 6, 7, 8
*MATERIAL, NAME=STEEL
*ELASTIC
2.1E5, 0.3
*SOLID SECTION, ELSET=BLOCKS, MATERIAL=STEEL
*SURFACE, NAME=UPPER
2, S1
*SURFACE, NAME=LOWER
1, S3
*NSET, NSET=TOP
7, 8
*SURFACE INTERACTION, NAME=DRY
*FRICTION
0.5
*CONTACT PAIR, INTERACTION=DRY, NAME=JOINT
UPPER, LOWER
"""
COUPLING = """
*SURFACE, NAME=LID
2, S3
*COUPLING, REF NODE=REF, SURFACE=LID, CONSTRAINT NAME=C
*KINEMATIC
1, 2
"""
EQUATIONS = """
*EQUATION
2
TOP, 1, 1., 100, 1, -1.
2
TOP, 2, 1., 100, 2, -1.
"""
AXES = """
*TRANSFORM, NSET=TOP, TYPE=R
0.6, 0.8, 0., -0.8, 0.6, 0.
"""
PUSH = "*CLOAD\n100, 1, 5.\n100, 2, -7.\n"


@pytest.mark.parametrize(("relation", "loads", "normal", "shear"), [
    (COUPLING, PUSH, 107.0, -5.0),
    (EQUATIONS, PUSH, 107.0, -5.0),
    (AXES, "*CLOAD\n7, 1, 5.\n", 96.0, -3.0),   # 5 along (0.6, 0.8)
    (COUPLING, "*BOUNDARY\n100, 1\n100, 6\n*CLOAD\n100, 2, -7.\n", 107.0, 0.0)],
    ids=["coupling", "equations", "axes", "held in part"])
def test_forces_on_related_nodes_cross_the_contact_that_alone_holds_the_body(
        tmp_path, relation, loads, normal, shear):
    deck = write(tmp_path / "deck.inp", BLOCKS, relation, "*STEP\n*STATIC\n0.5, 1.\n*BOUNDARY\n"
                 "BOTTOM, 1, 2\n*DLOAD\n2, P3, 10.\n", loads, "*END STEP")
    with h5py.File(solve(deck)) as file:
        joint = file["contact/JOINT"]
        assert joint["normal_force"][-1] == pytest.approx(normal, rel=1e-9)
        assert joint["shear_force"][-1] == pytest.approx(shear, rel=1e-9, abs=1e-7)


@pytest.mark.parametrize("first", range(0, 60, 10))
def test_random_stacks_are_in_equilibrium(tmp_path, first):
    """Reference nodes, equations and axes of their own, loaded, held or moved, on stacks that
    contact, friction, ties, node pairs and mortar points hold, with thermal strains."""
    unique = 0
    for seed in range(first, first + 10):
        stack, process, faults, is_unique = trial(seed, tmp_path)
        assert process.returncode == 0, (seed, stack.way, process.stderr)
        assert max(faults.values()) < ROUNDING, (seed, stack.way, faults)
        unique += is_unique
    assert unique >= 5   # of which the referee knows each contact force
