"""Plain iteration (4.1) and the paper's (4.2) on the published mesh: two ways to one fixed point."""

import h5py
import numpy as np
from deck_runs import CYLINDER, copy_deck, datasets, solve

METHOD = "*FIXED POINT, METHOD=ZAITSEV"
COUNTS = (
    "history/iterations",
    "history/heat_imbalance",
    "history/heat_imbalance_pointwise",
    "history/force_imbalance",
)


def test_both_methods_end_at_the_same_fixed_point(tmp_path):
    results = {}
    for method in ("PICARD", "ZAITSEV"):
        changes = {METHOD: f"*FIXED POINT, METHOD={method}, TOL=1E-10"}
        deck = copy_deck(CYLINDER, tmp_path / f"{method}.inp", changes=changes)
        results[method] = datasets(solve(deck), "contact", "history")
    assert len(results["PICARD"]["history/time"]) == 45
    # A residual of 1e-10 leaves an error of 1e-10/|1 - U'|; U' <= 0 where heat flows out of the
    # body that expands, so no more than the residual. Rounding of the gaps adds its 1e-9.
    for name, values in results["PICARD"].items():
        if name not in COUNTS:
            scale = np.nanmax(np.abs(values), initial=0.0)
            other = results["ZAITSEV"][name]
            np.testing.assert_allclose(other, values, rtol=0, atol=2e-9 * scale, err_msg=name)


def test_every_pass_is_on_record_with_its_g(tmp_path):
    result = solve(copy_deck(CYLINDER, tmp_path / "cylinder.inp"))
    with h5py.File(result) as file:
        passes = {name: file[f"convergence/{name}"][()] for name in file["convergence"]}
        iterations = file["history/iterations"][()]
    np.testing.assert_array_equal(np.bincount(passes["increment"])[1:], iterations)
    # Three iterations with the constant g, in which the first mixing uses it: its default is 0.5.
    early = passes["iteration"] <= 4
    np.testing.assert_array_equal(passes["g_min"][early], 0.5)
    assert np.all((passes["g_min"] > 0.0) & (passes["g_max"] <= 1.0))
    last = np.flatnonzero(np.diff(passes["increment"], append=-1))
    assert np.all(passes["residual"][last] <= 1e-8)
