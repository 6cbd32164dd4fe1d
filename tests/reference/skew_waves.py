"""Frictionless contact of half-planes in a wave of two harmonics without symmetry, period 1.

Over the contact (1/E*) int p(v) cot(pi (x - v)) dv is half the slope of the wave. With t = tan(pi (x - c)),
c the middle of the contact, this is the equation of one contact with the kernel 1/(t - t'), and of a
constant more; Gauss and Chebyshev solve it for pressures that vanish at both ends (F. Erdogan, G. D.
Gupta, Q. Appl. Math. 29 (1972) 525-534).

With friction: bodies with beta = 0 that a load presses and then a shear force moves have the shear mu times
the pressure less that of a smaller load, whose contact is the stick zone (M. Ciavarella, Int. J. Solids
Struct. 35 (1998) 2349-2362; J. Jaeger, J. Tribol. 120 (1998) 677-684).
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

TERMS = 60


@dataclass(frozen=True)
class Contact:
    """A contact of a period: its middle and half-width, mean and largest pressure, the approach of the
    bodies since they touched, and whether it is closed inside and open outside."""

    middle: float
    half: float
    mean: float
    peak: float
    approach: float
    is_one: bool


@dataclass(frozen=True)
class SkewWave:
    """A wave of a height, with a second harmonic of a part and a phase, between bodies of a modulus E*."""

    height: float
    part: float
    phase: float
    modulus: float

    def depth(self, x):
        """Return the depth below 0, which is the crest near 1/2 but for the second harmonic."""
        s = 2 * np.pi * (x - 0.5)
        return self.height * (1 - np.cos(s) + self.part * (1 - np.cos(2 * s + self.phase)))

    def slope(self, x):
        """Return the derivative of the depth."""
        s = 2 * np.pi * (x - 0.5)
        return 2 * np.pi * self.height * (np.sin(s) + 2 * self.part * np.sin(2 * s + self.phase))

    def pressed(self, middle, half):
        """Return the pressure over the root of 1 - s^2, the places x and the weights at the zeros s of U_n,
        and what is left of the condition that the pressure vanishes at both ends."""
        k = np.arange(1, TERMS + 1)
        s, between = np.cos(np.pi * k / (TERMS + 1)), np.cos(np.pi * (2 * np.arange(1, TERMS + 2) - 1) / (
            2 * TERMS + 2))
        weights, root = np.pi / (TERMS + 1) * (1 - s**2), np.tan(np.pi * half)
        t = root * s
        # An equation more than pressures: a constant is added that is 0 at the right middle.
        system = np.column_stack([weights / np.pi * (1 / (between[:, None] - s) + root * t / (1 + t**2)),
                                  np.ones(TERMS + 1)])
        found = np.linalg.solve(system, self.modulus / 2 * self.slope(
            middle + np.arctan(root * between) / np.pi))
        return found[:-1], middle + np.arctan(t) / np.pi, root * weights / np.pi / (1 + t**2), found[-1]

    def contact(self, half):
        """Return the contact of a half-width."""
        middle = brentq(lambda c: self.pressed(c, half)[3], 0.38, 0.62, xtol=1e-13)
        factor, x, weights, _ = self.pressed(middle, half)

        def gap(at):
            waves = np.log(np.abs(2 * np.sin(np.pi * (at[:, None] - x))))
            return self.depth(at) - 2 / np.pi / self.modulus * waves @ (factor * weights)

        angle = np.linspace(0, np.pi, 2001)
        smooth = np.polynomial.legendre.Legendre.fit(
            np.tan(np.pi * (x - middle)) / np.tan(np.pi * half), factor, TERMS - 1)
        approach = float(np.mean(gap(middle + half * np.array([-1.0, 1.0]))))
        outside = np.linspace(middle + half + 0.02, middle + 1 - half - 0.02, 60)
        return Contact(middle, half, float(factor @ weights),
                       float((np.sin(angle) * smooth(np.cos(angle))).max()), approach,
                       bool(factor.min() > 0 and gap(outside).min() > approach))

    def contact_of(self, mean, half):
        """Return the contact of a mean pressure, which has at most a half-width."""
        return self.contact(brentq(lambda b: self.contact(b).mean - mean, 0.02, half, xtol=1e-12))
