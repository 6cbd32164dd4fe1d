"""The cylinder against tests/reference/cylinder_reference.py, which shares nothing but the deck:
flexibility in place of stiffness, Newton's method in place of eq. (4.2)."""

import sys

import h5py
import numpy as np
import pytest

from deck_runs import CYLINDER, DECKS, copy_deck, solve

sys.path.insert(0, str(DECKS.parent / "reference"))
from cylinder_reference import solve_deck  # noqa: E402

DATASETS = {"gap": "g", "pressure": "p", "shear": "t", "slip": "slip", "heat_flux": "q"}
SUMS = ["normal_force", "shear_force", "heat_rate", "edge_contact", "edge_stick"]
TOLERANCE = 1e-8  # of each dataset's largest value: the tolerance of both fixed points is 1e-12 and
# a conductance of 1/B = 3e5 per unit of gap carries the rounding of the gap to the flux.


@pytest.mark.parametrize("levels", [0, 1])
def test_every_increment_is_that_of_the_independent_solver(tmp_path, levels):
    cards = ["*FIXED POINT, METHOD=ZAITSEV, TOL=1e-12", f"*REFINE, LEVELS={levels}"]
    if levels == 0:
        cards.pop()
    changes = {"*FIXED POINT, METHOD=ZAITSEV\n": ""}
    result = solve(copy_deck(CYLINDER, tmp_path / "cylinder.inp", cards, changes))
    contact, states = solve_deck(CYLINDER, levels=levels)
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
