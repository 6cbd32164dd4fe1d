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


def confocal(x, y, half_length):
    """Return mu and theta of points beside the crack."""
    zeta = np.arccosh((x + 1j * y) / half_length)
    return np.abs(zeta.real), np.where(zeta.real < 0, -zeta.imag, zeta.imag)


def slope(function, step):
    """Return a derivative at 0 by differences of fourth order."""
    return (8 * (function(step) - function(-step))
            - (function(2 * step) - function(-2 * step))) / (12 * step)


CRACKED = 1.3   # half-length of the crack


@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("state", ["tension", "flow", "bent"])
def test_fields_about_a_crack_are_in_equilibrium_and_its_faces_free(state, plane):
    shear, _ = crack.constants(YOUNG, POISSON, plane)
    expansion, gradient, beta = 1e-3, 7.0, 0.8

    def temperature(x, y):
        if state != "flow":
            return 0.0 * x
        return crack.flow_temperature(*confocal(x, y, CRACKED), CRACKED, gradient, beta)

    def moved(x, y):
        if state == "bent":
            return np.array(crack.bent_displacement(x, y, CRACKED, 5.0, YOUNG, POISSON, plane))
        at = *confocal(x, y, CRACKED), CRACKED
        if state == "tension":
            return np.array(crack.tension_displacement(*at, 5.0, YOUNG, POISSON, plane))
        return np.array(crack.flow_displacement(*at, gradient, beta, YOUNG, POISSON, expansion,
                                                plane))

    def stress(x, y):
        along = slope(lambda h: moved(x + h, y), 1e-4)
        across = slope(lambda h: moved(x, y + h), 1e-4)
        free = expansion * temperature(x, y) * (1 + POISSON if plane == "strain" else 1.0)
        nu = POISSON / (1 - POISSON) if plane == "strain" else POISSON
        modulus = 2 * shear / (1 - nu)
        xx, yy = along[0] - free, across[1] - free
        return np.array([modulus * (xx + nu * yy), modulus * (yy + nu * xx),
                         shear * (along[1] + across[0])])

    x, y = np.meshgrid(np.linspace(-2.0, 2.0, 5), [-1.5, -0.4, 0.3, 1.1])
    along = slope(lambda h: stress(x + h, y), 2e-3)
    across = slope(lambda h: stress(x, y + h), 2e-3)
    np.testing.assert_allclose([along[0] + across[2], along[2] + across[1]], 0.0, atol=1e-6)
    inside = np.linspace(-0.25 if state == "bent" else -0.9, 0.9, 7) * CRACKED
    for side in (-1, 1):
        faces = stress(inside, side * 2.1e-4 + 0 * inside)
        np.testing.assert_allclose(faces[1:], 0.0, atol=0.01)   # 2e-4 from the face
    if state == "bent":
        shut = np.linspace(-0.95, -0.4, 5) * CRACKED
        np.testing.assert_allclose(-stress(shut, 2.1e-4 + 0 * shut)[1],
                                   crack.bent_pressure(shut, CRACKED, 5.0), rtol=1e-3)


def test_gas_in_an_elliptic_gap_conducts_what_the_plate_brings():
    conductivity, gas, widest, gradient = 4.0, 0.05, 0.02, 7.0
    beta = crack.gas_number(CRACKED, conductivity, gas, widest)
    x = np.linspace(-0.8, 0.8, 5) * CRACKED
    theta = np.arccos(x / CRACKED)

    def temperature(mu, side):
        return crack.flow_temperature(mu, side * theta, CRACKED, gradient, beta)

    jump = temperature(0.0, 1) - temperature(0.0, -1)
    insulated = crack.jump(x, CRACKED, conductivity * gradient, conductivity)
    np.testing.assert_allclose(jump, insulated / (1 + beta), rtol=1e-12)
    gap = widest * np.sqrt(1 - (x / CRACKED)**2)
    for side in (1, -1):   # dy = a sin(theta) dmu
        out = slope(lambda h, side=side: temperature(h, side), 1e-3) / (CRACKED * np.sin(theta))
        np.testing.assert_allclose(side * conductivity * out, gas / gap * jump, rtol=1e-9)
    far = confocal(0.0, 400.0, CRACKED)
    there = float(crack.flow_temperature(*far, CRACKED, gradient, beta))
    assert there == pytest.approx(400.0 * gradient, rel=1e-5)


def test_pressure_of_a_bent_crack_has_its_sum():
    places = -CRACKED / 3 - np.linspace(0.0, 1.0, 20001)**2 * 2 * CRACKED / 3
    middles = (places[1:] + places[:-1]) / 2
    force = np.sum(crack.bent_pressure(middles, CRACKED, 5.0) * -np.diff(places))
    assert force == pytest.approx(crack.bent_force(CRACKED, 5.0), rel=1e-6)


def test_sliding_of_a_crack_is_the_jump_of_the_displacement():
    for plane in ("stress", "strain"):
        theta = np.linspace(0.3, 2.8, 5)
        body = CRACKED, 7.0, 0.8, YOUNG, POISSON, 1e-3, plane
        up, low = (crack.flow_displacement(0.0, side * theta, *body) for side in (1, -1))
        slid = crack.sliding(CRACKED * np.cos(theta), CRACKED, 7.0, 0.8, POISSON, 1e-3, plane)
        np.testing.assert_allclose(up[0] - low[0], slid, rtol=1e-12)
        np.testing.assert_allclose(up[1] - low[1], 0.0, atol=1e-16)
