"""Errors of stress and heat flux in the energy norm, from displacements and temperatures alone.

Elements are integrated here by their own shape functions with 4 x 4 Gauss points, so the figures
owe nothing to the program but its nodal values.
"""

import numpy as np

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)
# Terms x^i y^j that span the shape functions of an element by its number of nodes.
TERMS = {
    3: [(0, 0), (1, 0), (0, 1)],
    4: [(0, 0), (1, 0), (0, 1), (1, 1)],
    6: [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)],
    8: [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2), (2, 1), (1, 2)],
}
SQUARE = [(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0)]
TRIANGLE = [(0, 0), (1, 0), (0, 1), (0.5, 0), (0.5, 0.5), (0, 0.5)]


def rule(nodes):
    """Return (points, weights) of an element with so many nodes."""
    a, b = (each.ravel() for each in np.meshgrid(POINTS, POINTS))
    weight = np.outer(WEIGHTS, WEIGHTS).ravel()
    if nodes in (4, 8):
        return np.stack([a, b], 1), weight
    u, v = (1 + a) / 2, (1 + b) / 2  # the square folded to the triangle
    return np.stack([u, v * (1 - u)], 1), weight / 4 * (1 - u)


def shapes(nodes, at):
    """Return psi (points, nodes) and its slopes (2, points, nodes)."""
    terms = TERMS[nodes]
    corners = np.array((SQUARE if nodes in (4, 8) else TRIANGLE)[:nodes], dtype=float)

    def power(x, n):
        return x**n if n >= 0 else np.zeros_like(x)

    def monomials(p):
        return np.stack([p[:, 0] ** i * p[:, 1] ** j for i, j in terms], 1)

    coefficients = np.linalg.inv(monomials(corners))
    xi = np.stack([i * power(at[:, 0], i - 1) * at[:, 1] ** j for i, j in terms], 1)
    eta = np.stack([j * at[:, 0] ** i * power(at[:, 1], j - 1) for i, j in terms], 1)
    return monomials(at) @ coefficients, np.stack([xi @ coefficients, eta @ coefficients])


def errors(coordinates, cells, values, law, exact, softness, mean_dilatation=False):
    """Return (error^2, energy^2) of s = law(gradient of values) against exact(x, y).

    `values` is (nodes, k); `law` takes gradients (points, k, 2); s is (points, components).
    """
    error = energy = 0.0
    for cell in cells:
        points, weights = rule(len(cell))
        psi, slope = shapes(len(cell), points)
        jacobian = np.einsum("dgn,ni->gid", slope, coordinates[cell])
        volume = weights * np.linalg.det(jacobian)
        gradient = np.einsum("dgn,gdi->gni", slope, np.linalg.inv(jacobian))
        change = np.einsum("gni,nk->gki", gradient, values[cell])
        if mean_dilatation:
            dilatation = np.einsum("gkk->g", change)
            more = (volume @ dilatation / volume.sum() - dilatation) / 3
            s = law(change, more)
        else:
            s = law(change)
        true = exact(*(psi @ coordinates[cell]).T)
        error += volume @ np.einsum("gi,ij,gj->g", s - true, softness, s - true)
        energy += volume @ np.einsum("gi,ij,gj->g", true, softness, true)
    return error, energy
