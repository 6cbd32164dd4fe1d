"""Receding contact of an elastic layer, pressed on a frictionless base: numpy only.

J. Dundurs and M. Stippes (J. Appl. Mech. 37, 1970, 965): contact that a load makes smaller does so
at once, to an extent that does not depend on the load's magnitude. The layer of height 1 is long
and weightless, the load uniform over |x| < half_load. The base is rigid, or a half-plane whose
compliance is `base` times that of a half-plane of the layer's material.

With pressures cos(k x) of magnitudes p below and P above, the lower face of the layer goes into it
by 2 ((C_s + C_a)/2 p - (C_a - C_s)/2 P)/(E' k), C_s and C_a being those of pressures that are alike
and opposite on both faces. The slope of the face against the base is zero where they touch. The
pressure is q_0/sqrt(1 - (x/c)^2) + sqrt(1 - (x/c)^2) sum q_n U_2n-2(x/c); faces that part there
leave no singularity, q_0 = 0, which chooses c.
"""

import numpy as np

TERMS = 12
LARGEST_WAVE = 40.0  # the terms of the layer fall off like exp(-k)
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(400)


def pressure(c, half_load, base):
    """Return q_0, q_1, ... of the pressure over |x| < c that balances a unit load."""
    k, w = LARGEST_WAVE / 2 * (POINTS + 1), LARGEST_WAVE / 2 * WEIGHTS
    alike = (np.cosh(k) - 1) / (np.sinh(k) + k)
    cross = ((np.cosh(k) + 1) / (np.sinh(k) - k) - alike) / 2
    angles = np.pi * (np.arange(200) + 0.5) / 200
    odd = 2 * np.arange(TERMS) + 1
    terms = np.vstack([np.ones(200), np.sin(np.outer(odd, angles)) * np.sin(angles)]) * np.pi / 200
    # Transforms of the terms without their values at k = 0, whose sum is that of the load.
    fall = -2 * c * terms @ np.sin(np.outer(np.cos(angles), k * c) / 2) ** 2
    places = np.pi * (np.arange(TERMS) + 0.5) / TERMS / 2
    waves = np.sin(np.outer(c * np.cos(places), k)) * w
    slopes = waves @ ((alike + cross - 1) * fall).T
    slopes[:, 1:] += (1 + base) * np.pi * np.cos(np.outer(places, odd))
    load = 1 - np.sinc(k * half_load / np.pi)
    return np.linalg.solve(np.vstack([slopes, c * terms.sum(axis=1)]),
                           np.append(-waves @ (alike + cross * load - 1), 1.0))


def extent(half_load, base=0.0):
    """Return the half-width of contact, and the pressure in the middle under a unit load."""
    low, high = 0.2, 5.0
    for _ in range(50):
        c = (low + high) / 2
        low, high = (c, high) if pressure(c, half_load, base)[0] > 0.0 else (low, c)
    q = pressure(c, half_load, base)[1:]
    return c, float(np.sum(q * (-1.0) ** np.arange(TERMS)))


def main():
    for base in 0.0, 1.0:
        for half_load in 1e-6, 0.5, 1.0:
            print(f"base {base}, load over {half_load}: extent and middle", extent(half_load, base))


if __name__ == "__main__":
    main()
