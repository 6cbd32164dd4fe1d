"""The strongly coupled twin of the cylinder: (4.1) and (4.2) do not converge on all of its
increments, and the program says so; Newton's method does."""

import re

import h5py
import numpy as np
import pytest
from deck_runs import COUPLED, copy_deck, run, solve

CARD = "*FIXED POINT, METHOD=NEWTON"
MAX_ITERATIONS = 50  # the default


@pytest.fixture(
    scope="module",
    params=[("PICARD", 0), ("ZAITSEV", 1)],
    ids=lambda p: f"{p[0]}-refined{p[1]}",
)
def twin(request, tmp_path_factory):
    """Return the finished process of the twin, by one method, and its result file."""
    method, levels = request.param
    folder = tmp_path_factory.mktemp("twin")
    refine = [f"*REFINE, LEVELS={levels}"] if levels else []
    changes = {CARD: f"*FIXED POINT, METHOD={method}, MAXITER={MAX_ITERATIONS}"}
    deck = copy_deck(COUPLED, folder / "twin.inp", refine, changes)
    return run("run", "--quiet", deck, "--out", folder), folder / "twin.vtkhdf"


def failing_increment(process):
    """Return the increment that the messages name, and its time."""
    named = re.search(r"increment (\d+) \(time ([^)]+)\)", process.stderr)
    assert named, process.stderr
    return int(named[1]), float(named[2])


def test_run_ends_with_status_2_and_names_the_first_increment_that_fails(twin):
    process, result = twin
    assert process.returncode == 2
    increment, time = failing_increment(process)
    assert "not converge" in process.stderr
    with h5py.File(result) as file:
        times = file["history/time"][()]
    assert increment == len(times) + 1
    assert time == pytest.approx(20.0 * increment)
    assert 500.0 <= time <= 640.0  # before and about first touch, near 560


def test_results_up_to_the_last_good_increment_are_kept(twin):
    process, result = twin
    increment, _ = failing_increment(process)
    with h5py.File(result) as file:
        times = file["history/time"][()]
        np.testing.assert_allclose(times, 20.0 * np.arange(1, increment), rtol=1e-12)
        assert np.all(file["history/iterations"][()] <= MAX_ITERATIONS)
        for name in ("gap", "pressure", "heat_flux"):
            values = file[f"contact/FACE/{name}"][()]
            assert len(values) == len(times)
            assert np.all(np.isfinite(values))
        assert len(file["VTKHDF/Steps/Values"]) == len(times)
    lines = result.with_suffix(".sta").read_text().splitlines()[1:]
    assert [int(line.split()[0]) for line in lines] == list(range(1, increment))


def test_history_of_the_failing_increment_is_kept(twin):
    process, result = twin
    increment, _ = failing_increment(process)
    rows = [line.split() for line in result.with_suffix(".cvg").read_text().splitlines()[1:]]
    failing = [row for row in rows if int(row[0]) == increment]
    assert rows[-1][0] == str(increment)
    assert [int(row[1]) for row in failing] == list(range(1, MAX_ITERATIONS + 1))
    with h5py.File(result) as file:
        group = file["convergence"]
        last = group["increment"][()] == increment
        assert len(group["increment"]) == len(rows)
        np.testing.assert_array_equal(group["iteration"][last], range(1, MAX_ITERATIONS + 1))
        residual = group["residual"][last]
        np.testing.assert_allclose(residual, [float(row[2]) for row in failing], rtol=1e-3)
        assert residual.min() > 1e-8  # the tolerance
        kept = group["residual"][~last]
        assert len(kept) == file["history/iterations"][()].sum()
    listing = result.with_suffix(".lst").read_text()
    assert f"{residual[0]:.3E}" in listing or f"{residual[0]:.2E}" in listing


def test_checks_of_the_deck_pass(twin):
    _, result = twin
    with h5py.File(result) as file:
        assert file["run"].attrs["verify_passed"] >= 8
        assert file["run"].attrs["verify_failed"] == 0


QUANTITIES = ("gap", "pressure", "shear", "conductance", "heat_flux")


def solved(path, cards=(), changes=()):
    """Solve a changed twin; return its quantities over the pairs, and the history."""
    result = solve(copy_deck(COUPLED, path, cards, changes))
    with h5py.File(result) as file:
        contact = {name: file[f"contact/FACE/{name}"][()] for name in QUANTITIES}
        return contact, {name: file[f"history/{name}"][()] for name in file["history"]}


def assert_one_solution(one, other, increments):
    """Assert that two solutions are one, to 1e-6 of the largest value in each increment."""
    for name, values in one.items():
        for i in range(increments):
            scale = np.abs(values[i]).max()
            np.testing.assert_allclose(
                other[name][i], values[i], rtol=0, atol=1e-6 * scale, err_msg=f"{name} at {i + 1}"
            )


@pytest.mark.parametrize(
    ("levels", "step"), [(1, 20), (0, 5), (0, 60), (2, 300)]
)
def test_newton_converges_in_every_increment(tmp_path, levels, step):
    text = COUPLED.read_text()
    deck = tmp_path / "twin.inp"
    deck.write_text(text[: text.index("*VERIFY")])
    cards = [f"*REFINE, LEVELS={levels}", "*OPTIONS, ERRORS=NO"] if levels else []
    deck = copy_deck(
        deck, deck, cards, {"20., 900.": f"{step}., 900.", CARD: "", "INC=100": "INC=1000"}
    )
    with h5py.File(solve(deck)) as file:   # the default method
        assert len(file["history/time"]) == 900 // step
        assert file["history/iterations"][()].max() <= MAX_ITERATIONS
        # While the bodies are apart heat and forces are little more than rounding.
        assert file["history/heat_imbalance"][()].max() < 1e-8
        assert file["history/force_imbalance"][()].max() < 1e-8
        # Hot above a base that does not expand: heat opens the gap it crosses.
        assert file["history/coupling_gain_max"][()].max() < 1.0


@pytest.fixture(scope="module")
def by_newton(tmp_path_factory):
    """Return the refinement cards, and quantities and history of the twin by Newton's method. The mesh of
    the deck is the matter of tests/stability/test_fixed_point.py."""
    cards = ["*REFINE, LEVELS=1"]
    path = tmp_path_factory.mktemp("newton") / "twin.inp"
    return cards, *solved(path, cards)


@pytest.mark.parametrize("end", ["OPEN", "CLOSED"])
def test_a_second_start_ends_at_the_same_solution(by_newton, tmp_path, end):
    cards, contact, _ = by_newton
    other, _ = solved(tmp_path / "twin.inp", [*cards, f"*START, FROM={end}"])
    assert_one_solution(contact, other, 45)


def test_paper_method_agrees_where_it_converges(by_newton, tmp_path):
    """(4.2) in place of Newton's method up to the increment that it fails in."""
    cards, contact, _ = by_newton
    changes = {CARD: "*FIXED POINT, METHOD=ZAITSEV"}
    deck = copy_deck(COUPLED, tmp_path / "twin.inp", cards, changes)
    with h5py.File(solve(deck, status=2)) as file:
        other = {name: file[f"contact/FACE/{name}"][()] for name in QUANTITIES}
    assert len(other["gap"]) >= 24
    assert_one_solution(contact, other, len(other["gap"]))


def test_gain_tells_where_plain_iteration_fails(by_newton, tmp_path):
    cards, _, history = by_newton
    changes = {CARD: "*FIXED POINT, METHOD=PICARD"}
    deck = copy_deck(COUPLED, tmp_path / "twin.inp", cards, changes)
    process = run("run", "--quiet", deck, "--out", tmp_path)
    first = int(re.search(r"increment (\d+) \(time", process.stderr)[1])
    beyond = np.flatnonzero(history["coupling_gain"] < -1.0) + 1
    assert first == beyond[0]
    assert history["coupling_gain"].min() < -200.0
