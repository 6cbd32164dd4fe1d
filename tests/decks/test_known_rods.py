"""Rods whose solutions, gains and numbers of solutions are known: every method on each of them.

The rods are those of input/rods: R1 open and R1b closed, mildly coupled; R2 with a gain of -11.4;
R3, heated from the side that expands less, with three solutions; and R2 with a law that jumps.
"""

import re
import shutil

import h5py
import numpy as np
import pytest
from changes import note_changes
from deck_runs import INPUT, run
from physics import DECKS  # noqa: F401  puts tests/reference on the path

import rods

FOLDER = INPUT / "rods"
METHODS = ("NEWTON", "ANDERSON", "ZAITSEV", "PICARD")
CARD = "*FIXED POINT, METHOD=NEWTON, TOL=1.E-11"
YOUNG, CONDUCTIVITY, LENGTH = 2e11, 20.0, 0.1


def known(gap, alpha1, alpha2, a, b):
    """Return the rods and their laws."""
    both = rods.Rods((LENGTH, LENGTH), (CONDUCTIVITY,) * 2, (alpha1, alpha2), (YOUNG,) * 2,
                     (500.0, 0.0), gap)
    return both, rods.gas(a, b), rods.power(a / b, 1e-4, 1.0)


RODS = {
    "r1": known(5e-4, 12e-6, 0.0, 0.15, 1e-5),
    "r1b": known(4.4e-4, 12e-6, 0.0, 0.15, 1e-5),
    "r2": known(4.7e-4, 12e-6, 0.0, 0.001, 1e-6),
    "r3-open": known(1.2e-4, 0.0, 12e-6, 0.005, 1e-5),
    "r3-middle": known(1.2e-4, 0.0, 12e-6, 0.005, 1e-5),
    "r3-closed": known(1.2e-4, 0.0, 12e-6, 0.005, 1e-5),
}
TAILS = pytest.mark.parametrize("tail", ["FULL", "SPARSE"])
BRANCH = {"r3-middle": 1, "r3-closed": 2}   # of the solutions, by ascending conductance


@pytest.fixture
def rod(tmp_path):
    """Return a function that solves a rod with some texts of its decks replaced, and returns the
    process, the conductance, the gain and the number of passes."""

    def solve(name, changes=(), *arguments):
        folder = tmp_path / "rods"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(FOLDER, folder)
        for path in folder.iterdir():
            text = path.read_text()
            for old, new in dict(changes).items():
                text = text.replace(old, new)
            path.write_text(text)
        process = run("run", "--quiet", f"{name}.inp", *arguments, folder=folder)
        if not (result := folder / f"{name}.vtkhdf").exists():
            return process, None, None, None
        with h5py.File(result) as file:
            omega = file["contact/FACE/conductance"][-1]
            gain = file["history/coupling_gain"][-1], file["history/coupling_gain_max"][-1]
            return process, omega, gain, file["history/iterations"][-1]

    return solve


@pytest.mark.parametrize("name", RODS)
def test_decks_hold_their_own_checks(name, tmp_path):
    process = run("run", "--quiet", FOLDER / f"{name}.inp", "--out", tmp_path)
    assert process.returncode == 0, process.stderr


@pytest.mark.parametrize("name", RODS)
def test_conductance_and_gain_are_those_of_the_closed_form(rod, name):
    expected = rods.solutions(*RODS[name])
    assert len(expected) == (3 if name.startswith("r3") else 1)
    omega = expected[BRANCH.get(name, 0)]
    _, found, gain, _ = rod(name)
    np.testing.assert_allclose(found, omega, rtol=1e-8)
    # All pairs together move as the rod does; what they do against each other is less. The closed
    # form's own difference is good to 1e-8.
    assert gain[0] == pytest.approx(rods.gain(*RODS[name], omega), rel=1e-5)


# Where a method must converge, with most passes that it may take; None: it must not. Relaxed is
# METHOD=ZAITSEV with the constant g = 0.5 throughout. Both that fail cycle for ever: R2 has the
# gain -11.4, and 0.5*(-11.4) + 0.5 = -5.2. On the middle branch of R3 the gain is 1.7, and the
# fixed point repels (4.1) and (4.2).
PASSES = {
    ("NEWTON", "r1"): 8, ("NEWTON", "r1b"): 8, ("NEWTON", "r2"): 12, ("NEWTON", "r3-open"): 10,
    ("NEWTON", "r3-middle"): 8, ("NEWTON", "r3-closed"): 10,
    ("ANDERSON", "r1"): 20, ("ANDERSON", "r1b"): 20, ("ANDERSON", "r2"): 50,
    ("ANDERSON", "r3-open"): 50, ("ANDERSON", "r3-closed"): 50,
    ("ZAITSEV", "r1"): 20, ("ZAITSEV", "r1b"): 20, ("ZAITSEV", "r2"): 50,
    ("ZAITSEV", "r3-open"): 50, ("ZAITSEV", "r3-closed"): 50,
    ("PICARD", "r1"): 20, ("PICARD", "r1b"): 20, ("PICARD", "r2"): None,
    ("PICARD", "r3-open"): 60, ("PICARD", "r3-closed"): 60,
    ("RELAXED", "r1"): 50, ("RELAXED", "r1b"): 50, ("RELAXED", "r2"): None,
}   # fmt: skip


@pytest.mark.parametrize(("method", "name"), PASSES)
def test_methods_on_the_rods(rod, method, name):
    card = CARD.replace("NEWTON", method) + ", MAXITER=400"
    if method == "RELAXED":
        card = CARD.replace("NEWTON", "ZAITSEV") + ", G=0.5, CONSTANT=400, MAXITER=400"
    process, omega, _, passes = rod(name, {CARD: card})
    most = PASSES[method, name]
    if most is None:
        assert process.returncode == 2
        assert "not converge in 400 iterations" in process.stderr
        assert "*FIXED POINT, METHOD=NEWTON solves it" in process.stderr
    else:
        assert process.returncode == 0, process.stderr
        np.testing.assert_allclose(omega, rods.solutions(*RODS[name])[BRANCH.get(name, 0)], 1e-8)
        assert passes <= most


def test_newton_that_fails_does_not_suggest_itself(rod):
    process, *_ = rod("r2", {CARD: f"{CARD}, MAXITER=2"})
    assert process.returncode == 2
    assert "not converge in 2 iterations" in process.stderr
    assert "NEWTON solves" not in process.stderr


@pytest.mark.parametrize("exponent", [-8, -10, -12, -14])
@pytest.mark.parametrize("kept", ["a", "a/b"])
@pytest.mark.parametrize("name", ["r1", "r1b", "r2"])
def test_newton_does_not_mind_how_steep_the_law_is(rod, name, kept, exponent):
    """B down to 1e-14, with A kept or with A/B kept; the passes stay those of the tame rods."""
    b = 10.0**exponent
    both, open_law, _ = RODS[name]
    touch = open_law(0.0)
    a = touch * {"r2": 1e-6}.get(name, 1e-5) if kept == "a" else touch * b
    sets = ["--set", f"a={a!r}", "--set", f"b={b!r}", "--set", f"touch={a / b!r}"]
    process, omega, _, passes = rod(name, {"TOL=1.E-11": "TOL=1.E-8"}, *sets)
    assert passes is not None, process.stderr
    assert passes <= 12
    (expected,) = rods.solutions(*known(both.gap, *both.expansion, a, b))
    # A unit in the last place of the displacements, 5e-4, is 1e-19: against B it is what remains.
    np.testing.assert_allclose(omega, expected, rtol=max(1e-8, 4e-18 / b))


@pytest.mark.parametrize(("exponent", "factor"), [(0.5, 0.1), (2.0, 1e-11)])
def test_newton_squares_the_residual_under_a_power_of_the_pressure(rod, tmp_path, exponent, factor):
    """Its derivative has the exponent in it: with another one the residual falls by a constant
    factor. Closed rods with a gain of -4 or less."""
    gap, a, b = 5.2e-4, 1e-5, 1e-5
    both, open_law, _ = known(gap, 12e-6, 0.0, a, b)
    laws = open_law, rods.power(a / b, factor, exponent)
    expected, = rods.solutions(both, *laws)
    assert rods.gain(both, *laws, expected) < -4.0
    law = {"<touch>, 1.E-4, 1.": f"<touch>, {factor!r}, {exponent!r}"}
    values = {"gap": gap, "a": a, "b": b, "touch": a / b}
    sets = [word for name, value in values.items() for word in ("--set", f"{name}={value!r}")]
    process, omega, *_ = rod("r1b", law, *sets)
    assert omega is not None, process.stderr
    np.testing.assert_allclose(omega, expected, rtol=1e-9)
    with h5py.File(tmp_path / "rods" / "r1b.vtkhdf") as file:
        residual = file["convergence/residual"][()]
    near = residual[np.argmax(residual < 0.1):]
    assert len(near) <= 6   # 0.1, 1e-2, 1e-4, 1e-8, 1e-16, and one for the constant
    assert (near[1:-1] < near[:-2]**1.5).all(), near


@TAILS
def test_several_solutions_are_said_only_on_proof(rod, tail):
    process, _, gain, _ = rod("r3-middle")
    assert "at least two other solutions" in process.stderr
    assert gain[0] == gain[1]
    for name in ("r1", "r3-open", "r3-closed"):
        assert "solutions" not in rod(name)[0].stderr
    process, omega, *_ = rod("r3-open", {"FROM=OPEN": f"FROM=BOTH\n*SOLVER, TAIL={tail}"})
    assert "different solutions; this is one of several" in process.stderr
    np.testing.assert_allclose(omega, rods.solutions(*RODS["r3-open"])[0], rtol=1e-8)


@pytest.mark.parametrize(("cards", "other"), [
    pytest.param(("FROM=GIVEN", 50.0, 0), ("FROM=GIVEN", 700.0, 2),
                 marks=pytest.mark.changes("START")),
    pytest.param(("FROM=OPEN", None, 0), ("FROM=CLOSED", None, 2),
                 marks=pytest.mark.changes("START, FROM"))])
def test_start_decides_which_solution_is_found(rod, tmp_path, cards, other):
    """The card, its datum and the solution, by ascending conductance."""
    decks = []
    for parameter, omega, branch in (cards, other):
        start = f"*START, {parameter}" + ("" if omega is None else f"\nFACE, {omega!r}")
        _, found, *_ = rod("r3-middle", {"*START, FROM=GIVEN\nFACE, 320.": start})
        np.testing.assert_allclose(found, rods.solutions(*RODS["r3-middle"])[branch], rtol=1e-8)
        decks.append((tmp_path / "rods" / "r3-middle.inp").read_text().splitlines())
    note_changes(*decks)


@TAILS
def test_both_ends_lead_to_one_solution(rod, tmp_path, tail):
    process, *_ = rod("r2", {CARD: CARD + f"\n*START, FROM=BOTH\n*SOLVER, TAIL={tail}"})
    assert process.returncode == 0, process.stderr
    assert "solutions" not in process.stderr
    assert "lead to one solution" in (tmp_path / "rods" / "r2.lst").read_text()


def test_gain_below_minus_one_is_warned_of_with_plain_iteration_alone(rod):
    """Which here starts at its solution."""
    (omega,) = rods.solutions(*RODS["r2"])
    start = f"{CARD.replace('NEWTON', 'PICARD').replace('E-11', 'E-6')}\n*START, FROM=GIVEN\nFACE, {omega!r}"
    warning = r"the coupling gain is -11\.35\d*, below -1: plain iteration \(4\.1\) would diverge"
    assert re.search(warning, rod("r2", {CARD: start})[0].stderr)
    assert "gain" not in rod("r2")[0].stderr


OPEN_LAW = "*GAP LAW, TYPE=GAS\n<a>, <b>\n"
JUMP = {OPEN_LAW: "", "*GAP LAW, TYPE=POWER\n<touch>, 1.E-4, 1.": "*GAP LAW, TYPE=POWER\n<touch>, 0., 1."}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("touch", [700.0, 1.5e4, 1e12])
def test_a_pair_rests_where_the_law_jumps(rod, tmp_path, method, touch):
    """Without an open law the rods open where they touch and touch where they are apart: there is
    no solution but at rest, with the conductance that leaves neither gap nor pressure."""
    omega = rods.resting(RODS["r2"][0])
    assert 0.0 < omega < 700.0
    changes = JUMP | {CARD: CARD.replace("NEWTON", method)}
    _, found, gain, _ = rod("r2", changes, "--set", f"touch={touch!r}")
    np.testing.assert_allclose(found, omega, rtol=1e-9)
    assert gain == (0.0, 0.0)   # no omega is left that could vary
    with h5py.File(tmp_path / "rods" / "r2.vtkhdf") as file:
        contact = file["contact/FACE"]
        np.testing.assert_array_equal(contact["status"][-1], 1)
        for name in ("gap", "pressure", "shear"):
            np.testing.assert_array_equal(contact[name][-1], 0.0)
        assert file["history/heat_imbalance"][-1] < 1e-10
        assert file["history/force_imbalance"][-1] < 1e-7
    listing = " ".join((tmp_path / "rods" / "r2.lst").read_text().split())
    assert ("NEWTON solves this increment" in listing) == (method != "NEWTON")


def test_a_resting_pair_keeps_its_conductance_without_mechanics(rod, tmp_path):
    step = "*STEP\n*HEAT TRANSFER, STEADY STATE\n1., 1.\n*END STEP\n*VERIFY"
    _, found, *_ = rod("r2", JUMP | {"*VERIFY, KIND=ANALYTIC, SOURCE=\"two": step + ", KIND=ANALYTIC, SOURCE=\"two"})
    with h5py.File(tmp_path / "rods" / "r2.vtkhdf") as file:
        assert len(file["history/time"]) == 2
    np.testing.assert_allclose(found, rods.resting(RODS["r2"][0]), rtol=1e-9)
