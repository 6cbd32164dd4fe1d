#!/usr/bin/env python3
"""Judges displacements of elastic bodies by equations that are assembled here: numpy and scipy only.

Stiffness and thermal loads of CPE8, CPS8, CAX8 and CPS4 elements, linear rows that supports, equations and contacts
impose, and the part of the nodal forces that no such row can carry.
"""
import numpy as np
from scipy.linalg import lstsq

CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
SIDES = np.array([(0, -1), (1, 0), (0, 1), (-1, 0)], dtype=float)


def shape(kind, a, b):
    """Return shape functions and their derivatives (2, n) at a point of the unit square."""
    corners = (1 + a * CORNERS[:, 0]) * (1 + b * CORNERS[:, 1]) / 4
    da = CORNERS[:, 0] * (1 + b * CORNERS[:, 1]) / 4
    db = CORNERS[:, 1] * (1 + a * CORNERS[:, 0]) / 4
    if kind.endswith("4"):
        return corners, np.array([da, db])
    on_a = SIDES[:, 0] == 0
    middle = np.where(on_a, (1 - a * a) * (1 + b * SIDES[:, 1]), (1 - b * b) * (1 + a * SIDES[:, 0])) / 2
    ma = np.where(on_a, -2 * a * (1 + b * SIDES[:, 1]), (1 - b * b) * SIDES[:, 0]) / 2
    mb = np.where(on_a, (1 - a * a) * SIDES[:, 1], -2 * b * (1 + a * SIDES[:, 0])) / 2

    def with_sides(corner, side):
        return np.concatenate([corner - (side + np.roll(side, 1)) / 2, side])

    return with_sides(corners, middle), np.array([with_sides(da, ma), with_sides(db, mb)])


def hooke(kind, young, poisson):
    """Return the matrix from strains (xx, yy, zz, xy) to stresses."""
    if kind.startswith("CPS"):
        plane = young / (1 - poisson**2) * np.array([[1, poisson], [poisson, 1]])
        matrix = np.zeros((4, 4))
        matrix[:2, :2] = plane
    else:
        matrix = np.full((4, 4), poisson) + (1 - 2 * poisson) * np.eye(4)
        matrix[3] = matrix[:, 3] = 0.0
        matrix *= young / (1 + poisson) / (1 - 2 * poisson)
    matrix[3, 3] = young / 2 / (1 + poisson)
    return matrix


def element(kind, places, temperature, young, poisson, expansion):
    """Return stiffness and thermal load of an element; temperatures are rises at its nodes."""
    law, n = hooke(kind, young, poisson), len(places)
    stiffness, load = np.zeros((2 * n, 2 * n)), np.zeros(2 * n)
    points, weights = np.polynomial.legendre.leggauss(2 if kind.endswith("4") else 3)
    # In plane stress the strain along z is free; law has no row of it.
    heat = expansion * np.array([1.0, 1.0, 0.0 if kind.startswith("CPS") else 1.0, 0.0])
    for a, wa in zip(points, weights, strict=True):
        for b, wb in zip(points, weights, strict=True):
            values, derivatives = shape(kind, a, b)
            jacobian = derivatives @ places
            gradient = np.linalg.solve(jacobian, derivatives)
            strain = np.zeros((4, 2 * n))
            strain[0, ::2], strain[1, 1::2] = gradient
            strain[3, ::2], strain[3, 1::2] = gradient[1], gradient[0]
            area = wa * wb * np.linalg.det(jacobian)
            if kind.startswith("CAX"):
                radius = values @ places[:, 0]
                strain[2, ::2] = values / radius
                area *= 2 * np.pi * radius
            stiffness += area * strain.T @ law @ strain
            load += area * strain.T @ law @ heat * (values @ temperature)
    return stiffness, load


class Bodies:
    """Stiffness and thermal load of elements: kind, nodes, (E, nu, alpha); places and rises by node number."""

    def __init__(self, places, elements, rises):
        self.dof = {(n, c): 2 * i + c for i, n in enumerate(places) for c in (0, 1)}
        self.stiffness = np.zeros((len(self.dof),) * 2)
        self.thermal = np.zeros(len(self.dof))
        for kind, nodes, properties in elements:
            matrix, load = element(kind, np.array([places[n] for n in nodes]),
                                   np.array([rises[n] for n in nodes]), *properties)
            at = [self.dof[n, c] for n in nodes for c in (0, 1)]
            self.stiffness[np.ix_(at, at)] += matrix
            self.thermal[at] += load

    def row(self, terms):
        """Return the row of a sum of (node, component, coefficient)."""
        row = np.zeros(len(self.dof))
        for node, component, coefficient in terms:
            row[self.dof[node, component]] += coefficient
        return row

    def uncarried(self, displacement, forces, rows):
        """Return the forces that no multiplier of a row carries, the multipliers, and whether these are unique."""
        left = self.stiffness @ displacement - self.thermal - forces
        lengths = np.linalg.norm(rows, axis=1)
        found, _, rank, _ = lstsq((rows / lengths[:, None]).T, left, cond=1e-10)
        multipliers = found / lengths
        return left - rows.T @ multipliers, multipliers, rank == len(rows)
