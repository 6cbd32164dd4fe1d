"""The strongly coupled twin of the cylinder: (4.1) and (4.2) do not converge on all of its
increments, and the program says so."""

import re
import subprocess
import sys

import h5py
import numpy as np
import pytest
from deck_runs import COUPLED, INPUT, copy_deck, run

PLOT = INPUT.parent / "post" / "plot"
MAX_ITERATIONS = 50  # the default


@pytest.fixture(
    scope="module",
    params=[("ZAITSEV", 0), ("PICARD", 0), ("ZAITSEV", 1), ("PICARD", 1)],
    ids=lambda p: f"{p[0]}-refined{p[1]}",
)
def twin(request, tmp_path_factory):
    """Return the finished process of the twin, by one method, and its result file."""
    method, levels = request.param
    folder = tmp_path_factory.mktemp("twin")
    refine = [f"*REFINE, LEVELS={levels}"] if levels else []
    given = re.search(r"^\*FIXED POINT.*$", COUPLED.read_text(), flags=re.MULTILINE)[0]
    changes = {given: f"*FIXED POINT, METHOD={method}, MAXITER={MAX_ITERATIONS}"}
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


def test_history_is_plotted(twin, tmp_path):
    _, result = twin
    command = [sys.executable, PLOT, "convergence", result, "--out", tmp_path]
    subprocess.run(command, check=True, capture_output=True)
    (picture,) = tmp_path.glob("*.png")
    assert picture.read_bytes().startswith(b"\x89PNG")
