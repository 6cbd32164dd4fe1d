"""A hard die, hot or cold, on an elastic layer of thickness 1 between smooth insulated walls, plane or
axisymmetric; the base is cold, and holds the layer or lets it slide.

The plane layer has the modes cos(n pi x/L), the round one J0(l_n r) with J1(l_n L) = 0. Displacement, bulge
and temperature of its surface are exact for each (a potential of the temperature, functions of Papkovich).
In the contact x = a sin(t) pressures are cos(t) times polynomials in cos(t)^2, fluxes polynomials in cos(t);
outside, where x = a + (L - a) w^2, polynomials in w.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from scipy.special import eval_legendre, j0, jn_zeros, jv, roots_legendre, spherical_jn

MODES, HEATED = 5000, 1000   # of pressure, of flux
TERMS, OUTER = 16, 24        # in the contact, outside
DEEP = 30                    # wave number from which the layer is a half-space


def half_space(k, poisson, modulus):
    """Return the kernels of a half-space."""
    return 2 / (modulus * k), (1 + poisson) / k**2, 1 / k


def kernels(k, poisson, modulus, is_held):
    """Return what the layer, E/(1 - nu^2) = modulus, does at its surface under a mode of wave number k:
    displacement into it per pressure, displacement out of it and temperature per flux, both for
    conductivity and expansion 1."""
    bulk = (1 + poisson) / (1 - poisson)
    if k == 0:
        return (1 - 2 * poisson) / (1 - poisson) ** 2 / modulus, bulk / 2, 1.0
    shear = modulus * (1 - poisson) / 2

    def rows(s, y, scale):
        """Return u, v, stress, shear of e^(s k y) and of its product with y (Papkovich)."""
        e = np.exp(s * k * (y - scale))
        return np.array([(-k, s * k, 2 * shear * k**2, -2 * s * shear * k**2),
                         (-k * y, s * k * y - (3 - 4 * poisson),
                          2 * shear * k * (k * y - 2 * s * (1 - poisson)),
                          -2 * shear * k * (s * k * y - (1 - 2 * poisson)))]).T * e

    top, base = (np.hstack([rows(1, y, 1.0), rows(-1, y, 0.0)]) for y in (1.0, 0.0))
    # Potential of the temperature sinh(k y)/(k cosh k), which a flux of 1 makes.
    f = bulk / (2 * k**2)
    df = f * (1 + k * np.tanh(k))
    warm_top = np.array([-k * f, df, 2 * shear * k**2 * f, -2 * shear * k * df])
    warm_base = np.array([0.0, f, 0.0, -2 * shear * k * f]) / np.cosh(k)
    held = [0, 1] if is_held else [1, 3]
    system = np.vstack([base[held], top[2:]])
    cold = np.linalg.solve(system, [0, 0, -1.0, 0])
    warm = np.linalg.solve(system, -np.concatenate([warm_base[held], warm_top[2:]]))
    return -top[1] @ cold, top[1] @ warm + df, np.tanh(k) / k


def wave_numbers(is_round):
    """Return the wave numbers of the modes times the width: n pi, or the zeros of J1."""
    n = np.arange(MODES)
    if not is_round:
        return np.pi * n
    b = np.pi * (n + 0.25)
    zeros = np.where(n > 0, b - 3 / (8 * b) + 3 / (128 * b**3), 0.0)   # McMahon
    zeros[1:HEATED] = jn_zeros(1, HEATED - 1)
    return zeros


class Layer:
    """The modes of a layer under a contact of half-width a, between walls at a width, and the terms of
    pressure and flux."""

    def __init__(self, a, width, is_round, poisson, modulus, is_held):
        self.a, self.width, self.is_round = a, width, is_round
        self.k = wave_numbers(is_round) / width
        norm = (width**2 / 2 * j0(self.k * width) ** 2 if is_round
                else np.where(self.k > 0, width / 2, width))[:, None]
        low = [kernels(k, poisson, modulus, is_held) for k in self.k[self.k <= DEEP]]
        self.response = np.vstack([low, np.array(half_space(self.k[self.k > DEEP], poisson, modulus)).T]).T
        self.press(norm)
        self.heat_up(norm[:HEATED])
        whole = norm[0] * (2 * np.pi if is_round else 1.0)
        self.force, self.heat = whole * self.pressure[0], whole * self.flux[0]

    def press(self, norm):
        """Keep the waves of the tests, polynomials over the root of a^2 - x^2, and of the pressures.

        int cos(k x) cos(2 m t) dt and int J0(k x) P_2m(cos t) sin(t) dt are functions of Bessel."""
        t, weight = gauss(200, np.pi / 2)
        order, z, measure = 2 * np.arange(TERMS + 1), self.k * self.a, self.a
        if self.is_round:
            known = [spherical_jn(m, z) * abs(eval_legendre(m, 0.0)) for m in order]
            told, measure = eval_legendre(order, np.cos(t)[:, None]), self.a**2
            weight = weight * np.sin(t)
        else:
            known, told = [np.pi / 2 * jv(m, z) for m in order], np.cos(order * t[:, None])
        tests = legendre.legvander(2 * np.cos(t) ** 2 - 1, TERMS)
        self.tests, self.places = measure * tests * weight[:, None], self.a * np.sin(t)
        self.test_waves = measure * np.array(known).T @ np.linalg.lstsq(told, tests, rcond=None)[0]
        pressures = tests[:, :TERMS] * np.cos(t)[:, None] ** 2
        self.pressure = self.test_waves @ np.linalg.lstsq(tests, pressures, rcond=None)[0] / norm

    def heat_up(self, norm):
        """Keep the waves of the terms of the flux."""
        t, weight = gauss(int(HEATED * self.a / self.width) + 200, np.pi / 2)
        w, other = gauss(int(HEATED * (1 - self.a / self.width)) + 200, 1.0)
        waves = []
        for x, terms, measure in (
                (self.a * np.sin(t), inner_terms(t), self.a * np.cos(t) * weight),
                (self.outside(w), outer_terms(w), 2 * w * (self.width - self.a) * other)):
            measure = measure * (x if self.is_round else 1.0)
            waves.append(self.form(np.outer(self.k[:HEATED], x)) @ (measure[:, None] * terms))
        self.flux = np.hstack(waves) / norm

    def outside(self, w):
        """Return places outside the contact."""
        return self.a + (self.width - self.a) * w**2

    def form(self, arguments):
        """Return the modes."""
        return j0(arguments) if self.is_round else np.cos(arguments)

    def surface(self, x):
        """Return displacement by pressure terms, displacement and temperature by flux terms at places."""
        waves = self.form(np.outer(x, self.k))
        down, up, warm = self.response[:, :, None]
        return (waves @ (down * self.pressure), waves[:, :HEATED] @ (up[:HEATED] * self.flux),
                waves[:, :HEATED] @ (warm[:HEATED] * self.flux))


def gauss(count, end):
    """Return places and weights of Gauss and Legendre from 0 to an end."""
    x, weight = roots_legendre(count)
    return (x + 1) * end / 2, weight * end / 2


def pressure_terms(t):
    """Return the terms of the pressure."""
    return np.cos(t)[:, None] * legendre.legvander(2 * np.cos(t) ** 2 - 1, TERMS - 1)


def inner_terms(t):
    """Return the terms of the flux in the contact."""
    return legendre.legvander(2 * np.cos(t) - 1, TERMS - 1)


def outer_terms(w):
    """Return the terms of the flux outside."""
    return legendre.legvander(2 * w - 1, OUTER - 1)


@dataclass(frozen=True)
class Law:
    """The conductance, closed + growth p at a pressure, opened length/(length + gap) at a gap."""

    closed: float
    growth: float
    opened: float
    length: float


@dataclass(frozen=True)
class Pressed:
    """A state: approach, force, heat into the layer, largest pressure and temperature of the layer, and
    whether it is closed inside the contact and open outside."""

    approach: float
    force: float
    heat: float
    peak: float
    hottest: float
    is_one: bool


def pressed_die(layer, shape, bulge, die, law):
    """Return the state under a die of a shape and a temperature, by Newton's method.

    Unknown are terms of pressure and of flux, and the approach. One test more than terms of pressure finds
    the approach at which pressures vanish at the edge. The law of the flux is met by least squares."""
    t, w = np.arccos(gauss(3 * TERMS, 1.0)[0]), gauss(3 * OUTER, 1.0)[0]
    warm, (fall, rise, hot) = layer.surface(layer.a * np.sin(t))[2], layer.surface(layer.outside(w))
    down, up, _ = layer.response[:, :, None]
    unit, size, out = shape(layer.a), 2 * TERMS + OUTER + 1, shape(layer.outside(w))

    def at(parts, count):
        """Return rows of all unknowns, of which the parts are not 0."""
        rows = np.zeros((count, size))
        for first, values in parts:
            rows[:, first : first + values.shape[1]] = values
        return rows

    # The weight keeps what is left of the law of the flux out of the contact.
    contact = 1e4 / unit * at([
        (0, layer.test_waves.T @ (down * layer.pressure)),
        (TERMS, -bulge * layer.test_waves[:HEATED].T @ (up[:HEATED] * layer.flux)),
        (size - 1, -layer.tests.sum(axis=0)[:, None])], TERMS + 1)
    given = 1e4 / unit * layer.tests.T @ shape(layer.places)
    pressure, inner = at([(0, pressure_terms(t))], len(t)), at([(TERMS, inner_terms(t))], len(t))
    outer, warms, hots = (at(part, n) for part, n in (
        ([(2 * TERMS, outer_terms(w))], len(w)), ([(TERMS, warm)], len(t)), ([(TERMS, hot)], len(w))))
    gaps = at([(0, fall), (TERMS, -bulge * rise), (size - 1, -np.ones((len(w), 1)))], len(w))
    z, scale = np.zeros(size), np.array([*[10 * unit] * TERMS, *[1.0] * (TERMS + OUTER), unit])
    for part in [0.0, 0.25, 0.5, 0.75, *[1.0] * 30] if die else [0.0, 0.0]:
        gap = np.maximum(out + gaps @ z, 0.0)
        closed, opened = law.closed + law.growth * pressure @ z, law.opened * law.length / (law.length + gap)
        drop_in, drop_out = part * die - warms @ z, part * die - hots @ z
        rows = np.vstack([
            contact, inner + closed[:, None] * warms - (law.growth * drop_in)[:, None] * pressure,
            outer + opened[:, None] * hots + (opened / (law.length + gap) * drop_out)[:, None] * gaps])
        left = np.concatenate([contact @ z + given, inner @ z - closed * drop_in, outer @ z - opened * drop_out])
        change = scale * np.linalg.lstsq(rows * scale, -left, rcond=1e-13)[0]
        z, step = z + change, np.abs(change / scale).max()
        if part == 1.0 and step < 1e-10:
            break
    t = np.linspace(0, np.pi / 2 - 0.02, 400)
    p, q = z[:TERMS], z[TERMS:-1]
    pressures, gap = pressure_terms(t) @ p, (out + gaps @ z)[3:]
    return Pressed(float(z[-1]), float(layer.force @ p), float(layer.heat @ q), float(pressures.max()),
                   float(np.max(layer.surface(layer.a * np.sin(t))[2] @ q)),
                   bool(pressures.min() > 0 and gap.min() > 0 and step < 1e-7))
