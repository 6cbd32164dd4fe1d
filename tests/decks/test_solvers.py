"""Both solvers give the same results, and a second run the same as the first."""

import shutil

import h5py
import numpy as np
import pytest
from deck_runs import CYLINDER, assert_alike, copy_deck, datasets, solve

METHOD = "*FIXED POINT, METHOD=ZAITSEV"
TIGHT = {METHOD: METHOD + ", TOL=1E-12"}
ROUNDING = (
    "history/heat_imbalance",
    "history/heat_imbalance_pointwise",
    "history/force_imbalance",
    "history/iterations",
)


@pytest.fixture(scope="module", params=[0, 1], ids=["published", "refined"])
def results(request, tmp_path_factory):
    """Return the result files of both solvers, at the published mesh and refined once."""
    folder = tmp_path_factory.mktemp("solvers")
    refine = [f"*REFINE, LEVELS={request.param}"] if request.param else []
    files = {}
    for solver in ("SKYLINE", "MUMPS"):
        cards = [*refine, f"*SOLVER, TYPE={solver}"]
        files[solver] = solve(copy_deck(CYLINDER, folder / f"{solver}.inp", cards, TIGHT))
    return files


def test_each_run_names_its_solver(results):
    for solver, result in results.items():
        with h5py.File(result) as file:
            assert file["run"].attrs["solver"].upper() == solver


def test_mumps_gives_the_contact_of_the_skyline(results):
    """To 1e-10 of each dataset's largest value; what is itself rounding is not compared."""
    one, other = (datasets(results[s], "contact", "history") for s in ("SKYLINE", "MUMPS"))
    assert len(one) > 25
    for name in ROUNDING:
        del one[name], other[name]
    assert_alike(one, other, 1e-10)
    np.testing.assert_array_equal(one["contact/FACE/status"], other["contact/FACE/status"])


@pytest.mark.parametrize("solver", ["SKYLINE", "MUMPS"])
def test_a_second_run_gives_the_same_results(results, solver, tmp_path):
    deck = shutil.copy(results[solver].with_suffix(".inp"), tmp_path / "again.inp")
    groups = "contact", "history", "convergence", "VTKHDF"
    assert_alike(
        datasets(results[solver], *groups), datasets(solve(deck), *groups), 1e-12
    )
