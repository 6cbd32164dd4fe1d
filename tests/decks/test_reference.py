"""The cylinder against tests/reference/cylinder_reference.py, which shares nothing but the deck:
flexibility in place of stiffness, Newton's method in place of eq. (4.2)."""

import shutil
import subprocess
import sys
from functools import cache

import h5py
import numpy as np
import pytest

from deck_runs import CYLINDER, DECKS, OWN_MESH, PATIENCE, copy_deck, solve

sys.path[:0] = [str(DECKS.parent / "reference"), str(CYLINDER.parent)]
import make_decks  # noqa: E402
from cylinder_reference import solve_deck  # noqa: E402

DATASETS = {"gap": "g", "pressure": "p", "shear": "t", "slip": "slip", "heat_flux": "q"}
SUMS = ["normal_force", "shear_force", "heat_rate", "edge_contact", "edge_stick"]
TOLERANCE = 1e-8  # of each dataset's largest value: the tolerance of both fixed points is 1e-12 and
# a conductance of 1/B = 3e5 per unit of gap carries the rounding of the gap to the flux.


@cache
def independent(levels):
    """Return the states of the independent solver on the deck's mesh, refined."""
    return solve_deck(CYLINDER, levels=levels)[1]


@pytest.mark.parametrize("levels", [0, 1])
def test_every_increment_is_that_of_the_independent_solver(tmp_path, levels):
    cards = ["*FIXED POINT, METHOD=ZAITSEV, TOL=1e-12", f"*REFINE, LEVELS={levels}"]
    if levels == 0:
        cards.pop()
    changes = {"*FIXED POINT, METHOD=ZAITSEV\n": ""}
    result = solve(copy_deck(CYLINDER, tmp_path / "cylinder.inp", cards, changes))
    states = independent(levels)
    with h5py.File(result) as file:
        found = {name: file[f"contact/FACE/{name}"][()] for name in [*DATASETS, *SUMS, "status"]}
    assert len(states) == len(found["normal_force"]) == 45
    expected = {name: np.array([getattr(s, key) for s in states]) for name, key in DATASETS.items()}
    expected |= {name: np.array([getattr(s, name) for s in states]) for name in SUMS}
    status = np.array([s.status for s in states])
    np.testing.assert_array_equal(found["status"], np.abs(status))
    for name, values in expected.items():
        scale = np.nanmax(np.abs(values))
        np.testing.assert_allclose(
            found[name], values, rtol=0.0, atol=TOLERANCE * scale, err_msg=name
        )


def test_checks_of_the_deck_are_those_of_the_independent_solver():
    """Nine digits of what it finds on the deck's own mesh, in the deck as in the script."""
    states = independent(0)
    at = {state.load: state for state in states}
    for load, *values in make_decks.SAME_MESH:
        expected = at[load].shear_force, at[load].edge_contact, at[load].edge_stick
        np.testing.assert_allclose(values, expected, rtol=5e-9, err_msg=load)
    _, checks = CYLINDER.read_text().split(OWN_MESH)
    assert checks.endswith("\n" + make_decks.same_mesh_cards() + "\n")


def test_deck_is_the_one_that_the_script_writes(tmp_path):
    folder = tmp_path / "cylinder"
    shutil.copytree(CYLINDER.parent, folder, ignore=shutil.ignore_patterns("*.inp"))
    subprocess.run([sys.executable, folder / "make_decks.py"], check=True, timeout=PATIENCE)
    for deck in CYLINDER.parent.glob("*.inp"):
        assert (folder / deck.name).read_text() == deck.read_text(), deck.name


@pytest.fixture(scope="module")
def heated(tmp_path_factory):
    """Return force and heat rate of the cylinder at every increment, by the deck's name."""
    folder = tmp_path_factory.mktemp("heated")
    found = {}
    for name in ("cylinder", *(f"cylinder-{name}" for name in make_decks.TRANSIENTS)):
        deck = folder / f"{name}.inp"
        deck.write_text((CYLINDER.parent / deck.name).read_text())
        with h5py.File(solve(deck)) as file:   # which ends with all checks passed
            found[name] = file["contact/FACE/normal_force"][()], file["contact/FACE/heat_rate"][()]
    return found


def test_the_slower_the_cylinder_is_heated_the_nearer_it_is_to_its_quasi_steady_course(heated):
    steady = np.array(heated["cylinder"])
    lags = [1 - np.array(heated[f"cylinder-{name}"]) / steady for name in make_decks.TRANSIENTS]
    assert (lags[0] > lags[1]).all() and (lags[1] > lags[2]).all()
    # The heat rate of one mesh depends on where between two nodes the edge of contact is.
    assert (lags[2][0] > 0.0).all() and (lags[2][1] > -0.01).all()


def test_the_slowly_heated_cylinder_lags_by_a_time_that_does_not_grow(heated):
    """The mean temperature of a slab of 120 lags by 120^2/(12 k/(rho c)) = 24000 s, in which the top
    warms by 3. Where the edge of contact passes a node, the force as a function of the top's
    temperature has a kink, which the interpolation between increments of 20 cuts."""
    top = np.linspace(20.0, 900.0, 45)
    force, slow = heated["cylinder"][0], heated["cylinder-slow"][0]
    lag = top - np.interp(slow, force, top)
    assert lag[1:] == pytest.approx(3.0, rel=0.1)
    assert np.median(lag) == pytest.approx(3.0, rel=0.01)
