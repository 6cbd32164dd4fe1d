#!/usr/bin/env python3
"""A straight crack of half-length a in an infinite plate in closed form, to check thercon against: numpy only.

The crack is -a < x < a, y = 0. Fields stand on confocal coordinates mu >= 0, theta: x + i y = a cosh(mu + i theta); the
crack is mu = 0, its upper face 0 < theta < pi. A body cut along any ellipse mu = const and given its displacements and
temperatures there has these fields inside. `plane` is "stress" or "strain".
"""
import numpy as np


def opening(x, half_length, tension, young):
    """Distance of the faces under a tension across the crack (plane stress; plane strain with E/(1 - nu^2))."""
    return 4 * tension / young * np.sqrt(half_length**2 - np.asarray(x, float) ** 2)


def jump(x, half_length, flux, conductivity):
    """Jump of the temperature over insulated faces, with a uniform flux across the crack far from it."""
    return 2 * flux / conductivity * np.sqrt(half_length**2 - np.asarray(x, float) ** 2)


def finite_width(half_length, half_width):
    """Factor on the opening at the centre for a crack amid a long strip (H. Tada, P. C. Paris and G. R. Irwin, The
    Stress Analysis of Cracks Handbook, section 2.1; 0.6 %)."""
    s = half_length / half_width
    return (-0.071 - 0.535 * s + 0.169 * s**2 + 0.020 * s**3 - 1.071 / s * np.log(1 - s))


def finite_width_heat(half_length, half_width):
    """Factor on the jump at the centre for a crack amid a long strip with insulated sides: the potential of a row of
    cracks, T jump = 2 (q/k) (2 w/pi) arcosh(1/cos(pi a/2 w)) at x = 0 against 2 (q/k) a."""
    s = np.pi * half_length / (2 * half_width)
    return np.arccosh(1 / np.cos(s)) / s


def place(mu, theta, half_length):
    """x and y of a point."""
    return half_length * np.cosh(mu) * np.cos(theta), half_length * np.sinh(mu) * np.sin(theta)


def constants(young, poisson, plane):
    """Shear modulus G and Muskhelishvili's kappa."""
    return young / (2 * (1 + poisson)), 3 - 4 * poisson if plane == "strain" else (3 - poisson) / (1 + poisson)


def tension_displacement(mu, theta, half_length, tension, young, poisson, plane):
    """u_x, u_y under equal tensions along x and y far away: Westergaard's Z = s z/sqrt(z^2 - a^2)."""
    zeta = mu + 1j * np.asarray(theta, float)
    _, y = place(mu, theta, half_length)
    integral = tension * half_length * np.sinh(zeta)
    # At the tips, where Z is infinite, y is 0 and y Z has the limit 0.
    at_tip = np.abs(np.sinh(zeta)) < 1e-12
    z = tension * np.cosh(zeta) / np.where(at_tip, 1.0, np.sinh(zeta))
    return opened(integral, z, y, young, poisson, plane)


def opened(integral, z, y, young, poisson, plane):
    """u_x, u_y of a crack opened alike on both sides, from Westergaard's Z and its integral (H. M. Westergaard, J. Appl.
    Mech. 6 (1939) A49): sigma_xx = Re Z - y Im Z', sigma_yy = Re Z + y Im Z', sigma_xy = -y Re Z'."""
    shear, kappa = constants(young, poisson, plane)
    return (((kappa - 1) / 2 * integral.real - y * z.imag) / (2 * shear),
            ((kappa + 1) / 2 * integral.imag - y * z.real) / (2 * shear))


def widest(half_length, tension, young, poisson, plane):
    """Distance of the faces at the centre under a tension across the crack."""
    shear, kappa = constants(young, poisson, plane)
    return (kappa + 1) / (2 * shear) * tension * half_length


def gas_number(half_length, conductivity, gas, widest_gap):
    """beta = 2 omega a/k of gas (conductance gas/gap) at the centre of an elliptic gap; it is the share of the heat that
    crosses, beta/(1 + beta), in terms of what is held back, 1/(1 + beta)."""
    return 2 * gas * half_length / (widest_gap * conductivity)


def flow_temperature(mu, theta, half_length, gradient, beta):
    """Temperature at a gradient dT/dy far away: k dT/dn is (gas/gap) times the jump on an elliptic gap."""
    return gradient * half_length * (np.cosh(mu) + beta * np.sinh(mu)) * np.sin(theta) / (1 + beta)


def flow_displacement(mu, theta, half_length, gradient, beta, young, poisson, expansion, plane):
    """u_x, u_y of this heat flow about a crack without tractions on its faces.

    The free displacement alpha integral F dz of T = Re F has a jump that grows along the crack (a dislocation); sliding of
    the faces, Z_II = C/sqrt(z^2 - a^2), takes it back. This is G. C. Sih's K_II (J. Appl. Mech. 29 (1962) 587):
    E alpha (dT/dy) a sqrt(pi a)/4 in plane stress. The faces slide by alpha (dT/dy) x sqrt(a^2 - x^2).
    """
    shear, kappa = constants(young, poisson, plane)
    free = expansion * (1 + poisson if plane == "strain" else 1.0)
    held = free * gradient * half_length**2 / (1 + beta)
    x, y = place(mu, theta, half_length)
    # y Z of Z = 1/sqrt(z^2 - a^2), in confocal coordinates, and 0 at the tips.
    sinh = np.sinh(mu + 1j * np.asarray(theta, float))
    yz = np.where(np.abs(sinh) < 1e-12, 0.0, y / half_length / np.where(np.abs(sinh) < 1e-12, 1.0, sinh))
    burgers = 2 * shear / (kappa + 1)   # C / held; what makes u_x of one value
    u = held * (np.cosh(2 * mu) * np.sin(2 * theta) / 4 + burgers / (2 * shear) * yz.real)
    v = -held * (np.sinh(2 * mu) * np.cos(2 * theta) / 4 - mu / 2
                 + (kappa - 1) * burgers / (4 * shear) * mu + burgers / (2 * shear) * yz.imag)
    passed = free * gradient * beta / (1 + beta)   # the part of the gradient that the crack does not disturb
    return u + passed * x * y, v - passed * (x**2 - y**2) / 2


def sliding(x, half_length, gradient, beta, poisson, expansion, plane):
    """u_x of the upper face less that of the lower one in this heat flow."""
    free = expansion * (1 + poisson if plane == "strain" else 1.0)
    x = np.asarray(x, float)
    return free * gradient / (1 + beta) * x * np.sqrt(half_length**2 - x**2)


def bent(half_length):
    """Centre and half-length of the open part in a stress sigma_yy = S x: -a/3 < x < a, where the other part is closed
    by pressure that fades to 0 at -a/3 (K_I = 0 there)."""
    return half_length / 3, 2 * half_length / 3


def bent_displacement(x, y, half_length, slope, young, poisson, plane):
    """u_x, u_y for sigma_yy = sigma_xx = S x far away: Z = S (z^2 + m z - l^2/2)/sqrt(z^2 - l^2) about the centre m of the
    open part of half-length l = 2 m."""
    centre, length = bent(half_length)
    y = np.asarray(y, float)
    z = np.asarray(x, float) - centre + 1j * y
    root = np.sqrt(z - length) * np.sqrt(z + length)
    safe = np.where(np.abs(root) < 1e-12, 1.0, root)
    function = slope * np.where(np.abs(root) < 1e-12, 0.0, (z**2 + centre * z - length**2 / 2) / safe)
    return opened(slope * (z / 2 + centre) * root, function, y, young, poisson, plane)


def bent_pressure(x, half_length, slope):
    """Pressure between the closed faces, -a < x < -a/3."""
    centre, length = bent(half_length)
    s = centre - np.asarray(x, float)
    return slope * np.sqrt((s - length) / (s + length)) * (s + length / 2)


def bent_force(half_length, slope):
    """Its sum over the closed faces: the integral is -(z/2 + m) sqrt(z^2 - l^2)."""
    centre, length = bent(half_length)
    s = half_length + centre   # distance of the closed tip from the centre of the open part
    return slope * (s / 2 - centre) * np.sqrt(s**2 - length**2)


def bent_opening(x, half_length, slope, young, poisson, plane):
    """Distance of the faces of the open part."""
    shear, kappa = constants(young, poisson, plane)
    centre, length = bent(half_length)
    s = np.asarray(x, float) - centre
    return (kappa + 1) / (2 * shear) * slope * (s / 2 + centre) * np.sqrt(length**2 - s**2)
