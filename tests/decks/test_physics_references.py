"""The closed forms in tests/reference obey the equations that they are said to solve."""

import numpy as np
import pytest
from physics import DECKS  # noqa: F401  puts tests/reference on the path

import conduction
import crack
import lame
import plates
import rotating

INNER, OUTER, YOUNG, POISSON, H = 1.0, 2.0, 1000.0, 0.3, 1e-5
RADII = np.linspace(1.1, 1.9, 5)


def derivative(function, r):
    """Return a central difference."""
    return (function(r + H) - function(r - H)) / (2 * H)


@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_rotating_cylinder_is_in_equilibrium_and_compatible(plane):
    density, speed = 3.0, 4.0

    def state(r):
        return rotating.disc(r, INNER, OUTER, density, speed, YOUNG, POISSON, plane)

    radial, hoop, axial, _ = state(RADII)
    force = derivative(lambda r: r * state(r)[0], RADII) - hoop + density * speed**2 * RADII**2
    np.testing.assert_allclose(force, 0.0, atol=1e-7)
    strain = (radial - POISSON * (hoop + axial)) / YOUNG
    np.testing.assert_allclose(derivative(lambda r: state(r)[3], RADII), strain, rtol=1e-7)
    np.testing.assert_allclose([state(INNER)[0], state(OUTER)[0]], 0.0, atol=1e-12)


@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_hot_tube_is_in_equilibrium_and_compatible(plane):
    expansion = 1e-3

    def state(r):
        return lame.hot_tube(r, INNER, OUTER, 100.0, 10.0, YOUNG, POISSON, expansion, plane)

    rise, radial, hoop, _ = state(RADII)
    force = derivative(lambda r: r * state(r)[1], RADII) - hoop
    np.testing.assert_allclose(force, 0.0, atol=1e-7)
    axial = lame.axial_stress(radial, hoop, POISSON, plane, expansion * rise, YOUNG)
    strain = (radial - POISSON * (hoop + axial)) / YOUNG + expansion * rise
    np.testing.assert_allclose(derivative(lambda r: state(r)[3], RADII), strain, rtol=1e-6)
    np.testing.assert_allclose([state(INNER)[1], state(OUTER)[1]], 0.0, atol=1e-10)


def test_ring_of_unequal_moduli_is_in_equilibrium_and_obeys_hooke():
    along, across, nu = 900.0, 2500.0, 0.2

    def state(r, *moduli):
        return lame.polar_orthotropic(r, INNER, OUTER, 10.0, *moduli)

    radial, hoop, moved = state(RADII, along, across, nu)
    force = derivative(lambda r: r * state(r, along, across, nu)[0], RADII) - hoop
    np.testing.assert_allclose(force, 0.0, atol=1e-7)
    strain = derivative(lambda r: state(r, along, across, nu)[2], RADII)
    np.testing.assert_allclose(strain, (radial - nu * hoop) / along, rtol=1e-7)
    np.testing.assert_allclose(moved / RADII, hoop / across - nu * radial / along, rtol=1e-12)
    assert state(INNER, along, across, nu)[0] == pytest.approx(-10.0)
    for found, known in zip(state(RADII, YOUNG, YOUNG, POISSON)[:2],
                            lame.cylinder(RADII, INNER, OUTER, 10.0), strict=True):
        np.testing.assert_allclose(found, known, rtol=1e-12)


def test_press_fit_closes_the_overlap():
    hub, rim, overlap = (2000.0, 0.3), (700.0, 0.33), 0.01
    for plane in ("stress", "strain"):
        p = lame.press_fit(1.0, 2.0, 3.0, hub, rim, overlap, plane)
        inwards = lame.displacement(2.0, *lame.cylinder(2.0, 1.0, 2.0, 0.0, p), *hub, plane)
        outwards = lame.displacement(2.0, *lame.cylinder(2.0, 2.0, 3.0, p), *rim, plane)
        assert outwards - inwards == pytest.approx(overlap, rel=1e-12)


def test_anisotropic_plates_reduce_to_isotropic_ones():
    strain, nu = np.array([1e-3, -2e-4, 5e-4]), POISSON
    modulus = YOUNG / (1 - nu**2)
    expected = [modulus * (1e-3 - nu * 2e-4), modulus * (nu * 1e-3 - 2e-4), 0.0,
                YOUNG / 2 / (1 + nu) * 5e-4]
    turned = plates.turned(plates.isotropic(YOUNG, nu), 33.0)
    np.testing.assert_allclose(plates.stress(turned, strain, "stress"), expected, atol=1e-13)
    held = plates.stress(turned, np.zeros(3), "strain", 1e-5 * np.eye(3), 10.0)
    np.testing.assert_allclose(held[:3], -YOUNG * 1e-4 / (1 - 2 * nu), rtol=1e-12)
    load = np.array([3.0, -2.0, 1.0])
    back = plates.stress(turned, plates.strain(turned, load, "strain"), "strain")
    np.testing.assert_allclose(back[[0, 1, 3]], load, rtol=1e-12)


def test_walls_carry_the_flux_of_their_resistances():
    flux, faces = conduction.wall([0.1, 0.2], [20.0, 10.0], 500.0, 0.0, 5.0, 7.0, [3.0])
    assert flux == pytest.approx(500.0 / (0.2 + 0.005 + 1 / 3 + 0.02 + 1 / 7), rel=1e-13)
    np.testing.assert_allclose([500.0 - faces[0], faces[1] - faces[2], faces[3]],
                               [flux / 5.0, flux / 3.0, flux / 7.0], rtol=1e-12)


def test_finite_width_of_a_crack_tends_to_that_of_an_infinite_plate():
    assert crack.finite_width(1e-6, 1.0) == pytest.approx(1.0, abs=1e-5)
    assert crack.finite_width_heat(1e-3, 1.0) == pytest.approx(1.0, abs=1e-5)
