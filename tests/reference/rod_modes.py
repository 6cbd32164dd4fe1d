"""Small motions of the two rods of rods.py in time: dense eigenvalues.

Each rod has the temperature of its far end and, beside its steady state, a sum of polynomials that
vanish there, x P_j(2x - 1) with Legendre's P_j. What crosses the faces changes by

    dq = omega dtheta + theta domega,   domega = (domega/ds) ds,   ds = -sum of a_i times the
                                                                   integral of dT_i,

and each rod stores rho c of it: M dc/dt = -K c - f dq.
"""

import numpy as np
from numpy.polynomial import Legendre

TERMS = 24


def integrals(points=2 * TERMS):
    """Return the integrals of products, of products of derivatives, and of the polynomials."""
    x, w = np.polynomial.legendre.leggauss(points)
    x, w = (x + 1) / 2, w / 2
    legendre = np.array([Legendre.basis(j)(2 * x - 1) for j in range(TERMS)])
    derivative = np.array([Legendre.basis(j).deriv()(2 * x - 1) for j in range(TERMS)])
    values, slopes = x * legendre, legendre + 2 * x * derivative
    return (values * w) @ values.T, (slopes * w) @ slopes.T, values @ w


def rates(rods, capacities, solution):
    """Return the rates of all small motions about a solution of rods.exact_solutions, the fastest
    first."""
    n = TERMS
    products, slopes, means = integrals()
    mass, conduction = np.zeros((2 * n, 2 * n)), np.zeros((2 * n, 2 * n))
    face, separation = np.ones(2 * n), np.zeros(2 * n)
    face[n:] = -1.0
    for i in range(2):
        rows = slice(i * n, (i + 1) * n)
        mass[rows, rows] = capacities[i] * rods.length[i] * products
        conduction[rows, rows] = rods.conductivity[i] / rods.length[i] * slopes
        separation[rows] = -rods.expansion[i] * rods.length[i] * means
    jump = rods.flux(solution.conductance) / solution.conductance
    crossing = solution.conductance * face + jump * solution.slope * separation
    values = np.linalg.eigvals(np.linalg.solve(mass, -conduction - np.outer(face, crossing)))
    return values[np.argsort(-values.real)]
