#!/usr/bin/env python3
"""Closed forms of transient conduction, with numpy and scipy only.

H. S. Carslaw, J. C. Jaeger: Conduction of Heat in Solids, 2nd ed., Oxford 1959.
"""

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import erfcx, j0, j1

MODES = 400


def roots(equation, first, last, period, count=MODES):
    """Return the roots of an equation, one between first and last of each period."""
    ends = [(first + k * period + 1e-12, last + k * period - 1e-12) for k in range(count)]
    return np.array([brentq(equation, *pair, xtol=1e-15) for pair in ends])


def shocked_wall(place, fourier):
    """Rise of a wall whose face, at 0, takes a unit step, insulated at 1."""
    waves = (np.arange(MODES) + 0.5) * np.pi
    return 1 - 2 * np.sum(np.sin(waves * place) / waves * np.exp(-(waves**2) * fourier))


def mean_of_shocked_wall(fourier):
    """Mean rise of the same wall."""
    waves = (np.arange(MODES) + 0.5) * np.pi
    return 1 - 2 * np.sum(np.exp(-(waves**2) * fourier) / waves**2)


def slab_with_film(place, fourier, biot):
    """Temperature over that of the start, film at 1 to a sink at 0, insulated at 0."""
    waves = roots(lambda z: z * np.sin(z) - biot * np.cos(z), 0.0, np.pi / 2, np.pi)
    shares = 4 * np.sin(waves) / (2 * waves + np.sin(2 * waves))
    return np.sum(shares * np.cos(waves * place) * np.exp(-(waves**2) * fourier))


def cylinder_with_film(radius, fourier, biot):
    """Temperature over that of the start, film at radius 1 to a sink at 0."""
    waves = roots(lambda z: z * j1(z) - biot * j0(z), 0.0, 2.404825557695773, np.pi, 60)
    shares = 2 * j1(waves) / (waves * (j0(waves) ** 2 + j1(waves) ** 2))
    return np.sum(shares * j0(waves * radius) * np.exp(-(waves**2) * fourier))


def half_space_with_film(scale):
    """Rise of the face, of the sink's: scale is h sqrt(a t)/k."""
    return 1 - erfcx(scale)


def sudden_contact(conductance, effusivities, drop, time):
    """Heat flux between two half-spaces that meet at time 0, their temperatures drop apart."""
    scale = conductance * (1 / effusivities[0] + 1 / effusivities[1]) * np.sqrt(time)
    return conductance * drop * erfcx(scale)


def rubbing(conductance, effusivities, time):
    """Rises of the faces of two half-spaces in contact, the first heated at its face by a unit flux
    from time 0 on.

    Transformed: the jump D = 1/(s e1 (sqrt s + H)), H = h (1/e1 + 1/e2); the second face rises by
    h D/(e2 sqrt s), the first by D more.
    """
    first, second = effusivities
    rate = conductance * (1 / first + 1 / second)
    jump = (1 - erfcx(rate * np.sqrt(time))) / (first * rate)
    rise = conductance / second * (2 * np.sqrt(time / np.pi) / (first * rate) - jump / rate)
    return rise + jump, rise


def braking(conductance, effusivities, duration, time):
    """Rises of the same faces while the flux falls linearly from 1 to 0 over the duration."""
    def of_face(k):
        return (rubbing(conductance, effusivities, time)[k]
                - quad(lambda t: rubbing(conductance, effusivities, t)[k], 0, time)[0] / duration)
    return of_face(0), of_face(1)


def nafems_t3(place, time, length=0.1, conductivity=35.0, capacity=3.1716e6, period=40.0):
    """Temperature where T(length) = 100 sin(pi t/period), T(0) = 0 and T = 0 at first."""
    rate = np.pi / period
    diffusivity = conductivity / capacity
    waves = np.arange(1, 4000) * np.pi / length
    decay = diffusivity * waves**2
    # T = 100 sin(rate t) x/length + sum of b(t) sin(wave x), b' + decay b = -share rate cos(rate t)
    share = -2 * (-1.0) ** np.arange(1, 4000) / (waves * length) * 100
    forced = (decay * np.cos(rate * time) + rate * np.sin(rate * time)
              - decay * np.exp(-decay * time)) / (decay**2 + rate**2)
    modes = -share * rate * forced * np.sin(waves * place)
    return 100 * np.sin(rate * time) * place / length + np.sum(modes)


def largest_rate(conductivity, capacity, length, conductance, closing):
    """Return the largest rate s of exp(s t) of two equal rods between walls at given temperatures.

    The first does not expand. closing is the change of the conductance by a unit mean rise of the
    second rod, times the difference of the temperatures of the faces. With T = sinh(m x),
    m^2 = s c/k, in the second rod and its negative in the first, the heat at the faces gives

        k m cosh(m L) = -2 omega sinh(m L) + closing (cosh(m L) - 1)/(m L).

    Where cosh(m L) = 0 no heat crosses the faces, and both rods have shares of their own.
    """
    def excess(rate):
        m = np.sqrt(complex(rate * capacity / conductivity)) * length
        return float(np.real(conductivity / length * np.cosh(m) + 2 * conductance * np.sinh(m) / m
                             - closing * (np.cosh(m) - 1) / m**2))

    unit = conductivity / capacity / length**2
    apart = -np.pi**2 / 4 * unit
    # Above 100 the first term is the largest; the others keep the spacing below that of the roots.
    rates = np.linspace(100 * unit, apart, 20000)
    signs = np.sign([excess(rate) for rate in rates])
    changes = np.flatnonzero(signs[:-1] * signs[1:] < 0)
    if not changes.size:
        return apart
    return brentq(excess, rates[changes[0] + 1], rates[changes[0]], xtol=1e-18, rtol=1e-14)


def main():
    """Print the values of published tables."""
    print("NAFEMS T3     ", nafems_t3(0.08, 32.0), nafems_t3(0.08, 20.0), nafems_t3(0.04, 32.0))
    print("wall          ", [100 * shocked_wall(0.2, t) for t in (0.1, 0.2, 0.7, 2.0)])
    print("slab          ", [slab_with_film(1, t, 1.0) for t in (0.01, 0.1, 0.2, 1.0)],
          [slab_with_film(0, t, 1.0) for t in (0.1, 0.2, 1.0)])
    print("cylinder      ", [100 * (1 - cylinder_with_film(1.0, 50 / 3900 * t / 4, 250 * 2 / 50))
                             for t in (0.312, 12.48, 312)])
    print("half-space    ", [half_space_with_film(z) for z in (0.1, 1.0, 10.0)])
    e = np.sqrt(40 * 3.6e6), np.sqrt(160 * 2.4e6)
    print("sudden contact", [sudden_contact(2000.0, e, 100.0, t) for t in (1, 10, 100, 1000)])
    print("touch         ", [brentq(lambda t, m=m: mean_of_shocked_wall(t) - m, 1e-4, 1)
                             for m in (0.25, 0.5, 0.75)])


if __name__ == "__main__":
    main()
