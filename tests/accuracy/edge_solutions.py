"""Edges of contact and of stick that share nothing with the program, of an elastic half-space that is
periodic of the period 1 in a plane, or inside a smooth insulated tube of the radius 1/2.

Modes cos(lambda x), or J0(lambda r), of pressure p, shear q and heat flux h displace the face by
2 p/(Es lambda), 2 q/(Es lambda), alpha (1 + nu) h/(k lambda^2), and heat it by h/(k lambda): walls of a
period and of a tube leave these modes as they are in the half-space. On the contact, |x| < a, unknown
fields are sums of (1 - (x/a)^2)^(j - 1/2), the transforms of which are Bessel functions (Galerkin).
"""

import numpy as np
from scipy.optimize import brentq
from scipy.special import gamma, j0, j1, jv

HALF, MODES, FIELDS = 0.5, 8000, 9
STEP = 1e-3     # of an edge, of finite differences


class Contact:
    """A circle or strip of contact, and the transforms of the fields on it."""

    def __init__(self, a, about_axis=False):
        self.a = a
        n = np.arange(1, MODES + 1)
        if about_axis:
            zeros = (n + 0.25) * np.pi
            for _ in range(3):   # Newton's method for J1 = 0
                zeros -= j1(zeros) / (j0(zeros) - j1(zeros) / zeros)
            self.rate, self.area = zeros / HALF, HALF**2 / 2
            norm = self.area * j0(zeros) ** 2
        else:
            self.rate, self.area = n * np.pi / HALF, HALF
            norm = np.full(MODES, HALF / 2)
        j, z = np.arange(FIELDS + 1)[:, None], self.rate * a
        if about_axis:
            waves = a**2 * 2 ** (j - 0.5) * gamma(j + 0.5) * z ** -(j + 0.5) * jv(j + 0.5, z)
            self.sums = a**2 / (2 * j[:, 0] + 1)
        else:
            waves = a * np.sqrt(np.pi) / 2 * gamma(j + 0.5) * (2 / z) ** j * jv(j, z)
            self.sums = a * np.sqrt(np.pi) / 2 * gamma(j[:, 0] + 0.5) / gamma(j[:, 0] + 1)
        self.waves_left = HALF / (2 * np.pi * MODES) * a * (a if about_axis else 1.0)
        self.waves, self.norm = waves, norm
        t, weight = np.polynomial.legendre.leggauss(100)
        t, weight = np.pi / 4 * (t + 1), np.pi / 4 * weight
        self.places = a * np.sin(t)
        self.tests = weight * a * np.cos(t) ** (2 * j) * (self.places if about_axis else 1.0)

    def matrix(self, flexibility):
        """Return what fields displace as tests see it, mode by mode."""
        return (self.waves * (flexibility / self.norm)) @ self.waves.T

    def mean(self, field):
        """Return the mean of a field over the face."""
        return field @ self.sums[-len(field):] / self.area

    def even(self):
        """Return the field of flux or pressure that leaves one temperature or displacement, where modes have
        the flexibility 1/rate: that of a flat punch."""
        system = self.matrix(1 / self.rate)
        # What is left of the slowest series: squares of waves are half their envelope.
        system[0, 0] += self.waves_left
        return np.linalg.solve(system, self.sums)


def perfect(a, profile, heat, modulus, conductivity, bulge, about_axis):
    """Return the mean pressure, and the drop of temperature at the face, at which contact with a rigid
    profile ends at a, where mean heat flows through a perfect contact. By Betti's theorem the pressure is
    that of a flat punch, weighted with the displacements; it vanishes at an edge where it is largest."""
    contact = Contact(a, about_axis)
    field = contact.even()
    rise = heat / contact.mean(field)
    bulges = rise * bulge / (contact.rate**2 * contact.norm) * (field @ contact.waves)
    seen, sums = [], []
    for edge in ((1 - STEP) * a, (1 + STEP) * a, a):
        at = Contact(edge, about_axis)
        punch = at.even()
        seen.append(punch @ (at.tests @ profile(at.places) - at.waves @ bulges))
        sums.append(punch @ at.sums)
    approach = (seen[1] - seen[0]) / (sums[1] - sums[0])
    return modulus / 2 * (approach * sums[2] - seen[2]) / contact.area, rise / conductivity


def layer_edge(thickness, loaded, ratio):
    """Return the edge of the contact that a layer keeps with a half-space, where even pressure over a part
    of its top presses it; the half-space has a part `ratio` of the layer's compliance. The rates of modes
    times the thickness tell how its faces move together and apart."""

    def root_at(a):
        contact = Contact(a)
        z = np.minimum(contact.rate * thickness, 300.0)
        apart = (np.cosh(z) - 1) / (np.sinh(z) + z)
        along = (np.cosh(z) + 1) / (np.sinh(z) - z)
        top = np.sin(contact.rate * loaded) / contact.rate
        moved = (contact.waves * (along - apart) / (contact.rate * contact.norm)) @ top
        system = np.zeros((FIELDS + 2,) * 2)
        system[:-1, :-1] = contact.matrix((along + apart + 2 * ratio) / contact.rate)
        system[:-1, -1] = system[-1, :-1] = contact.sums
        # A pressure with a root singularity at the edge closes there.
        return np.linalg.solve(system, np.append(moved, loaded))[0]

    # Where it meets the wall there may be another.
    ends = np.linspace(0.02, 0.48, 24)
    first = next(k for k in range(1, len(ends)) if root_at(ends[k]) < 0)
    return brentq(root_at, *ends[first - 1:first + 1], xtol=1e-7)


def gripped(profile, modulus, poisson, friction, edge, cells):
    """Return the mean pressure under which contact of an elastic half-space with a rigid rough profile has
    grown to about an edge, its pressure and gap on cells, and the part of it that sticks. It grows cell by
    cell; what closes sticks for good where shear then grows less than friction (D. A. Spence, J. Elasticity
    5 (1975) 297-319). Pressure p and shear q move the face by N p - C q inwards and T q - C' p along."""
    width = HALF / cells
    x = (np.arange(cells) + 0.5) * width
    n = 2 * np.pi * np.arange(1, 8 * cells)
    even, odd = np.cos(np.outer(x, n)), np.sin(np.outer(x, n))
    # Both loads and displacements are means over cells.
    parts = 32 * np.sin(n * width / 2) ** 2 / (n**3 * width * modulus)
    inwards, along = (even * parts) @ even.T, (odd * parts) @ odd.T
    cross = (1 - 2 * poisson) / (2 * (1 - poisson)) * (even * parts) @ odd.T
    pressure, gap, parts, stuck = np.zeros(cells), profile(x) - profile(x[0]), [], 1
    for closed in range(1, round(edge / width) + 1):
        inside = slice(closed)
        while True:
            slips = np.arange(closed) >= stuck
            system = np.block([[inwards[inside, inside], -cross[inside, inside]],
                               [-cross[inside, inside].T, along[inside, inside]]])
            system[closed:][slips] = np.hstack([-friction * np.eye(closed), np.eye(closed)])[slips]
            p, q = np.split(np.linalg.solve(system, np.repeat([1.0, 0.0], closed)), 2)
            # Slip goes inwards.
            if stuck >= closed or (along[stuck, inside] @ q < cross[inside, stuck] @ p):
                break
            stuck += 1
        less = (friction * p - q)[:stuck] ** 2
        parts.append((stuck - 0.5 + (less[-1] / (less[-2] - less[-1]) if stuck > 1 else 0)) / closed)
        moved = inwards[:, inside] @ p - cross[:, inside] @ q - 1
        step = -gap[closed] / moved[closed]
        gap += step * moved
        gap[inside] = 0
        pressure[inside] += step * p
    return pressure.mean(), pressure, gap, parts
