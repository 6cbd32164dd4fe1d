#!/usr/bin/env python3
"""Closed forms of the heat of friction, with numpy and scipy only.

J. R. Barber: Thermoelasticity and contact, J. Thermal Stresses 22 (1999) 513.
R. A. Burton, V. Nerlikar, S. R. Kilaparti: Thermoelastic instability in a seal-like configuration,
Wear 24 (1973) 177.
"""

from math import cos, cosh, pi, sin, sinh, sqrt

from scipy.optimize import brentq
from scipy.special import erfcx


def half_spaces(power, share, conductance, effusivities, time):
    """Temperatures of two faces at which friction makes a power per area, a share of it on the
    first: with D(s) = (power/s) A/(sqrt s + H), H = h (1/e1 + 1/e2), A = share/e1 - (1 - share)/e2.
    """
    first, second = effusivities
    both = conductance * (1 / first + 1 / second)
    part = power * (share / first - (1 - share) / second)
    jump = part / both * (1 - erfcx(both * sqrt(time)))
    mean = 2 * power * sqrt(time / pi)
    return (mean + second * jump) / (first + second), (mean - first * jump) / (first + second)


class BarMode:
    """Growing or decaying mode of a bar of length 1 that slides on an insulating wall and is at 0
    at its other end, S = mu V E alpha L/k: T'' = rate T, -T'(0) = S times the mean of T."""

    def __init__(self, number):
        grows = number > 2
        even, odd = (cosh, sinh) if grows else (cos, sin)

        def condition(m):
            return m * m * even(m) - number * abs(even(m) - 1)

        m = brentq(condition, 1e-3, 20.0 if grows else pi / 2, xtol=1e-14)
        self.rate = m * m if grows else -m * m
        self.at = lambda x: odd(m * (1 - x)) / odd(m)
        self.mean = abs(even(m) - 1) / m / odd(m)


def burton(ratio):
    """Rate over kappa m^2, and waves per depth over m, of the disturbance cos(m x) of a half-plane
    that slides out of the plane on a rigid insulator, V/Vcr = ratio: z (z + 1) = 2 ratio."""
    depth = (sqrt(1 + 8 * ratio) - 1) / 2
    return depth * depth - 1, depth


if __name__ == "__main__":
    for number in (1.0, 1.5, 2.5, 3.0, 4.0):
        print(f"bar, S = {number}: rate {BarMode(number).rate:.9g}")
    for ratio in (0.5, 2.0, 4.0):
        print(f"half-plane, V/Vcr = {ratio}: rate {burton(ratio)[0]:.9g}")
