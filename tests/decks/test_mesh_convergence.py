"""The published mesh of the cylinder against the same deck refined until it no longer changes."""

from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from deck_runs import CYLINDER, copy_deck, solve

LEVELS = 3
TEMPERATURES = 180.0, 360.0, 540.0, 720.0, 900.0
EDGES_FROM = 60.0
PEAK_TOLERANCE = {180.0: 0.08, 360.0: 0.04, 540.0: 0.02, 720.0: 0.02, 900.0: 0.02}
TOLERANCES = {  # at each of the temperatures
    "normal_force": dict.fromkeys(TEMPERATURES, 0.005),
    "heat_rate": dict.fromkeys(TEMPERATURES, 0.025),
    "peak pressure": PEAK_TOLERANCE,
}
EDGES = {"edge_contact": (0.2, 0.5), "edge_stick": (0.6, 1.2)}  # rms and worst, in nodal spacings


def solve_level(levels, folder):
    """Solve the deck, refined, in a third of its increments; return what is compared."""
    cards = [f"*REFINE, LEVELS={levels}", "*SOLVER, TYPE=MUMPS", "*OPTIONS, ERRORS=NO"]
    deck = copy_deck(CYLINDER, folder / f"level{levels}.inp", cards, {"\n20., 900.": "\n60., 900."})
    deck.write_text(deck.read_text().partition("*VERIFY")[0])
    with h5py.File(solve(deck)) as file:
        face = file["contact/FACE"]
        values = {name: face[name][()] for name in ("normal_force", "heat_rate", *EDGES, "s")}
        balances = [file[f"history/{name}_imbalance"][()] for name in ("heat", "force")]
        return SimpleNamespace(
            load=file["history/load"][()],
            values=values | {"peak pressure": face["pressure"][()].max(axis=1)},
            imbalance=np.max(balances),
        )


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Return the runs on the published mesh, on the finest, and on the one before that."""
    folder = tmp_path_factory.mktemp("levels")
    return [solve_level(levels, folder) for levels in (0, LEVELS, LEVELS - 1)]


def local_spacing(paper, edges):
    """Return the distances of the published mesh's pairs on both sides of the edges."""
    s = paper.values["s"]
    before = np.clip(np.searchsorted(s, edges) - 1, 0, len(s) - 2)
    return s[before + 1] - s[before]


def edge_errors(paper, one, other, name):
    """Return the differences of an edge from 60 degrees on, in local nodal spacings."""
    later = paper.load >= EDGES_FROM
    difference = one.values[name] - other.values[name]
    assert not np.any(np.isnan(difference[later])), name
    return (difference / local_spacing(paper, other.values[name]))[later]


def relative_error(one, other, name, temperature):
    """Return the relative difference of a quantity at a temperature of the top."""
    (row,) = np.flatnonzero(np.isclose(one.load, temperature))
    return one.values[name][row] / other.values[name][row] - 1.0


def print_table(runs):
    """Print the quantities on the published and on the finest mesh, and how they differ."""
    paper, fine, coarser = runs
    print(f"\n\nPublished mesh against {LEVELS} refinements; last: {LEVELS - 1} against {LEVELS}")
    print(f"{'top':>5}  {'quantity':<14}{'published':>12}{'refined':>12}{'differs':>9}{'last':>9}")
    for temperature in TEMPERATURES:
        row = np.argmin(np.abs(paper.load - temperature))
        for name in TOLERANCES:
            values = "".join(f"{run.values[name][row]:12.4f}" for run in (paper, fine))
            errors = (relative_error(run, fine, name, temperature) for run in (paper, coarser))
            differ = "".join(f"{error:9.2%}" for error in errors)
            print(f"{temperature:5.0f}  {name:<14}{values}{differ}")
    print(f"edges from {EDGES_FROM:g} on, differences in nodal spacings of the published mesh:")
    for name in EDGES:
        for title, run in (("published", paper), (f"{LEVELS - 1} refinements", coarser)):
            error = edge_errors(paper, run, fine, name)
            rms, worst = np.sqrt(np.mean(error**2)), np.abs(error).max()
            print(f"       {name:<14}{title:<14} rms {rms:5.2f}  worst {worst:5.2f}")


def test_refined_run_no_longer_changes(runs, capsys):
    """Another level changes less than a third of what is allowed to the published mesh."""
    with capsys.disabled():
        print_table(runs)
    paper, fine, coarser = runs
    for name, tolerances in TOLERANCES.items():
        for temperature in TEMPERATURES:
            allowed = tolerances[temperature] / 3.0
            assert abs(relative_error(coarser, fine, name, temperature)) < allowed, name
    for name, (rms, worst) in EDGES.items():
        error = edge_errors(paper, coarser, fine, name)
        assert np.sqrt(np.mean(error**2)) < rms / 3.0, name
        assert np.abs(error).max() < worst / 3.0, name


@pytest.mark.parametrize("temperature", TEMPERATURES)
@pytest.mark.parametrize("name", TOLERANCES)
def test_published_mesh_is_close_to_the_refined_one(runs, name, temperature):
    paper, fine, _ = runs
    error = relative_error(paper, fine, name, temperature)
    assert abs(error) < TOLERANCES[name][temperature]


@pytest.mark.parametrize("name", EDGES)
def test_edges_are_known_below_the_nodal_spacing(runs, name):
    paper, fine, _ = runs
    error = edge_errors(paper, paper, fine, name)
    rms, worst = EDGES[name]
    assert np.sqrt(np.mean(error**2)) < rms
    assert np.abs(error).max() < worst


def test_zones_grow_with_the_load(runs):
    for run in runs:
        assert np.all(np.diff(run.values["edge_contact"]) >= 0.0)
        stick = run.values["edge_stick"]
        assert not np.any(np.isnan(stick))
        assert np.all(np.diff(stick) >= -local_spacing(runs[0], stick[1:]))


def test_heat_and_forces_balance_on_the_published_mesh(runs):
    assert runs[0].imbalance <= 1e-10
