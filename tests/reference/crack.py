#!/usr/bin/env python3
"""A straight crack of half-length a in an infinite plate in closed form, to check thercon against: numpy only."""
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
