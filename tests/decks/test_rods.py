"""Two rods between rigid walls: heat and gap, or heat and pressure, in closed form.

q = (T1 - T2)/(R0 + 1/omega) with R0 = L1/k1 + L2/k2. The free expansion is e = e0 + e1 q with
e0 = a1 L1 T1 + a2 L2 T2 and e1 = -a1 L1^2/(2 k1) + a2 L2^2/(2 k2). Open: gamma = g0 - e and
omega = A/(B + gamma); closed: p = (e - g0)/(L1/E1 + L2/E2) and omega = A/B + C p. With nu = 0 and
all motion across the rods held, plane strain is this.
"""

from math import sqrt

import h5py
import numpy as np
import pytest
from blocks import block, solid, write
from deck_runs import solve

LENGTH, CONDUCTIVITY, YOUNG, EXPANSION, HOT = 0.1, 20.0, 2e11, 12e-6, 500.0
GAS_A, GAS_B, CLOSED_C = 0.15, 1e-5, 1e-4
MESHED_GAP = 5e-4
RESISTANCE = 2 * LENGTH / CONDUCTIVITY
FREE = EXPANSION * LENGTH * HOT  # e0
PER_FLUX = EXPANSION * LENGTH**2 / (2 * CONDUCTIVITY)  # -e1


def open_rods(gap):
    """Return gamma and q of the open branch: the positive root of
    (gamma - gap + e0) (R0 A + B + gamma) = -e1 A T1."""
    sum_ = RESISTANCE * GAS_A + GAS_B + FREE - gap
    product = (FREE - gap) * (RESISTANCE * GAS_A + GAS_B) - PER_FLUX * GAS_A * HOT
    gamma = (-sum_ + sqrt(sum_**2 - 4 * product)) / 2
    return gamma, HOT / (RESISTANCE + (GAS_B + gamma) / GAS_A)


def closed_rods(gap):
    """Return p and q of the closed branch: with c = 2 L/E and omega = A/B + C p,
    (c p - e0 + gap) (R0 omega + 1) = e1 T1 omega."""
    compliance, touch = 2 * LENGTH / YOUNG, GAS_A / GAS_B
    square = compliance * RESISTANCE * CLOSED_C
    linear = compliance * (RESISTANCE * touch + 1) + CLOSED_C * (
        (gap - FREE) * RESISTANCE + PER_FLUX * HOT
    )
    constant = (gap - FREE) * (RESISTANCE * touch + 1) + PER_FLUX * HOT * touch
    pressure = (-linear + sqrt(linear**2 - 4 * square * constant)) / (2 * square)
    return pressure, HOT / (RESISTANCE + 1 / (touch + CLOSED_C * pressure))


def write_rods(path):
    """Write the deck of the rods; *PARAMETER NEARER moves the hot wall towards the cold one."""
    xs = [0.0, 0.02, 0.05]
    return write(
        path,
        block("HOT", xs, [MESHED_GAP, MESHED_GAP + 0.04, MESHED_GAP + LENGTH], 1),
        block("COLD", xs, [-LENGTH, -0.04, 0.0], 101),
        solid("HOT", YOUNG, 0.0, EXPANSION, CONDUCTIVITY),
        solid("COLD", YOUNG, 0.0, 0.0, CONDUCTIVITY),
        f"""
        *PARAMETER
        NEARER = 0.
        *SURFACE INTERACTION, NAME=FACES
        *GAP LAW, TYPE=GAS
        {GAS_A}, {GAS_B}
        *GAP LAW, TYPE=POWER
        {GAS_A / GAS_B!r}, {CLOSED_C}, 1.
        *CONTACT PAIR, INTERACTION=FACES, NAME=FACE
        HOT.BOTTOM, COLD.TOP
        *FIXED POINT, METHOD=ZAITSEV, TOL=1.E-12
        *INITIAL CONDITIONS, TYPE=TEMPERATURE
        HOT, 0.
        COLD, 0.
        *STEP
        *COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE
        0.1, 1.
        *BOUNDARY
        HOT.TOP, 2, 2, <NEARER>
        COLD.BOTTOM, 2, 2, 0.
        HOT, 1, 1, 0.
        COLD, 1, 1, 0.
        HOT.TOP, 11, 11, {HOT}
        COLD.BOTTOM, 11, 11, 0.
        *END STEP
        """,
    )


@pytest.fixture
def deck(tmp_path):
    """Return the deck of the rods."""
    return write_rods(tmp_path / "rods.inp")


def last(result, name):
    """Return a dataset of the contact at the last increment."""
    with h5py.File(result) as file:
        return file[f"contact/FACE/{name}"][-1]


def test_open_rods(deck):
    gamma, flux = open_rods(MESHED_GAP)
    result = solve(deck)
    assert np.all(last(result, "status") == 0)
    np.testing.assert_allclose(last(result, "gap"), gamma, rtol=1e-8)
    np.testing.assert_allclose(last(result, "heat_flux"), flux, rtol=1e-8)
    np.testing.assert_allclose(last(result, "conductance"), GAS_A / (GAS_B + gamma), rtol=1e-8)


def test_a_parameter_set_on_the_command_line_closes_the_rods(deck):
    nearer = 6e-5
    pressure, flux = closed_rods(MESHED_GAP - nearer)
    result = solve(deck, "--set", f"NEARER={-nearer!r}")
    assert np.all(last(result, "status") == 1)
    np.testing.assert_allclose(last(result, "pressure"), pressure, rtol=1e-8)
    np.testing.assert_allclose(last(result, "heat_flux"), flux, rtol=1e-8)


def test_parameter_of_the_deck_and_of_the_command_line_mean_the_same(deck, tmp_path):
    by_command = solve(deck, "--set", "NEARER=-3.E-5")
    expected = last(by_command, "gap")
    own = write(tmp_path / "own.inp", deck.read_text().replace("NEARER = 0.", "NEARER = -3.E-5"))
    np.testing.assert_array_equal(last(solve(own), "gap"), expected)
