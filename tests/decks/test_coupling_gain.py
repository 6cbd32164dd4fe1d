"""The gain of the coupled twin against finite differences of U by tests/reference/cylinder_reference.py,
which shares nothing but the deck."""

import h5py
import numpy as np
import pytest
from deck_runs import COUPLED, copy_deck, solve
from physics import DECKS  # noqa: F401  puts tests/reference on the path

from cylinder_reference import Contact, read_deck


@pytest.fixture(scope="module")
def twin(tmp_path_factory):
    """Return conductance, gap, pressure and both gains of the twin."""
    card = "*FIXED POINT, METHOD=NEWTON"
    path = tmp_path_factory.mktemp("twin") / "twin.inp"
    with h5py.File(solve(copy_deck(COUPLED, path, (), {card: card + ", TOL=1E-11"}))) as file:
        found = {n: file[f"contact/FACE/{n}"][()] for n in ("conductance", "gap", "pressure")}
        found |= {n: file[f"history/{n}"][()] for n in ("coupling_gain", "coupling_gain_max")}
    return found


def test_gain_is_that_of_finite_differences(twin):
    bodies = read_deck(COUPLED)
    contact = Contact(*bodies, (bodies[0].xy[:, 1].max(), bodies[1].xy[:, 1].min()))
    state, gains = contact.start(), []
    for i, conductance in enumerate(twin["conductance"]):
        # The rounding of a gap, 1e-16, by B = 3e-6 and a gain of 1e3: nothing below 1e-8 is left.
        before, state = state, contact.increment(state, 20.0 * (i + 1), 1e-8, conductance)
        gains.append(contact.gains(before, state))
        for name, values in (("gap", state.g), ("pressure", state.p)):
            scale = max(values.max(), 1e-6)
            np.testing.assert_allclose(twin[name][i], values, rtol=0, atol=1e-6 * scale)
    largest = [e[np.abs(e).argmax()].real for e in gains]
    np.testing.assert_allclose(twin["coupling_gain"], largest, rtol=0.01)
    assert min(largest) < -1000.0
    real = [e[np.abs(e.imag) <= 1e-6 * np.abs(e).max()].real.max() for e in gains]
    # Small beside the others: what is left of them by the rounding of their own differences.
    np.testing.assert_allclose(twin["coupling_gain_max"], real, rtol=0.01, atol=1e-4)
