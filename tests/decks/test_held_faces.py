"""Faces whose motion towards each other is prescribed: solved while a gap is left, else refused."""

import numpy as np
import pytest
from blocks import solid, write
from deck_runs import run, solve
from test_held import COUPLED, FACES, RAISED, at, interaction, read, refuse

GAP = 0.02
HELD = {
    "all nodes": ["LOWER, 1, 2", "UPPER, 1", "UPPER, 2, 2, {}"],
    "the faces": ["LOWER.TOP, 1, 2", "UPPER.BOTTOM, 1", "UPPER.BOTTOM, 2, 2, {}"],
    "along the normal": ["LOWER.LEFT, 1", "UPPER.LEFT, 1", "LOWER.TOP, 2", "UPPER.BOTTOM, 2, 2, {}"],
    "rigid": ["LOWER, 1, 2", "9000, 1", "9000, 2, 2, {}", "9000, 6"],
}
TABLE = ["*GAP CONDUCTANCE, CLEARANCE", "10., 0.", f"0., {GAP}"]


def lowered(path, held, approach, friction=0.3, pairing="NODES", solver="SKYLINE", more=()):
    """Lower a block onto another one by a prescribed displacement; heat crosses the gap."""
    rigid = ["*NODE", "9000, 0., 0.", "*RIGID BODY, REF NODE=9000, ELSET=UPPER"] if held == "rigid" else []
    return write(path, [f"*SOLVER, TYPE={solver}"], RAISED, solid("UPPER", 1e4, 0.3),
                 solid("LOWER", 1e4, 0.3), rigid, interaction(friction), TABLE,
                 [FACES[0] + f", PAIRING={pairing}", FACES[1]], COUPLED,
                 [card.format(-approach) for card in HELD[held]], at(0.0, 100.0), ["*END STEP"], more)


@pytest.mark.parametrize("held", HELD)
@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize(("friction", "solver"), [(0.0, "SKYLINE"), (0.3, "SKYLINE"), (0.3, "MUMPS")])
def test_heat_crosses_the_gap_that_supports_leave(tmp_path, held, pairing, friction, solver):
    """In series: 1.5 of conductivity 1, and the conductance of what is left of the gap."""
    deck = lowered(tmp_path / "gap.inp", held, 0.6 * GAP, friction, pairing, solver)
    gap, pressure, heat = read(solve(deck), "FACE", "gap", "pressure", "heat_rate")
    np.testing.assert_allclose(gap, 0.4 * GAP, rtol=1e-9)
    np.testing.assert_allclose(pressure, 0.0, atol=1e-9)
    assert abs(heat) == pytest.approx(100.0 / (1.5 + 1.0 / 6.0), rel=1e-9)


@pytest.mark.parametrize("held", HELD)
@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize("approach", [GAP, 1.2 * GAP])
def test_supports_that_close_the_gap_are_named(tmp_path, held, pairing, approach):
    deck = lowered(tmp_path / "closed.inp", held, approach, pairing=pairing)
    process = run("check", "--quiet", deck)
    assert process.returncode == 1, process.stderr
    assert "moves against master node" in process.stderr
    assert "leaves no gap between them" in process.stderr
    assert "is prescribed by *BOUNDARY, line " in process.stderr or held == "rigid"
    assert ("*RIGID BODY, line " in process.stderr) == (held == "rigid")


def test_a_gap_that_closes_within_a_step_ends_the_run(tmp_path):
    """The end of the step leaves a gap, an increment before it does not."""
    cards = ["*AMPLITUDE, NAME=DIP", "0., 0., 0.5, 2., 1., 1."]
    deck = lowered(tmp_path / "dip.inp", "all nodes", 0.6 * GAP)
    text = deck.read_text().replace("*STEP", "\n".join(cards) + "\n*STEP", 1)
    deck.write_text(text.replace("*BOUNDARY", "*BOUNDARY, AMPLITUDE=DIP", 1))
    assert run("check", "--quiet", deck).returncode == 0
    assert "increment 1 (time 0.5): contact pair FACE: how slave node" in refuse(deck, 2)


def test_a_removed_pair_may_overlap(tmp_path):
    deck = lowered(tmp_path / "removed.inp", "all nodes", 1.2 * GAP)
    text = deck.read_text().replace("*BOUNDARY", "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\n"
                                    "UPPER.BOTTOM, LOWER.TOP\n*BOUNDARY", 1)
    deck.write_text(text)
    (heat,) = read(solve(deck), "FACE", "heat_rate")
    assert heat == pytest.approx(0.0, abs=1e-9)
