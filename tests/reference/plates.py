#!/usr/bin/env python3
"""Uniform states of anisotropic plates in closed form, to check thercon against: numpy only.

Hooke's law sigma = E:(eps - alpha dT) with tensors of fourth and second order, material axes turned in the plane, and
the two plane states: "strain" (eps_zz = 0) and "stress" (sigma_zz = 0). Strains are (eps_xx, eps_yy, gamma_xy),
stresses (xx, yy, zz, xy).
"""
import numpy as np

VOIGT = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
ORTHO = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2), (3, 3), (4, 4), (5, 5)]   # CalculiX, TYPE=ORTHO
ANISO = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2), (0, 3), (1, 3), (2, 3), (3, 3), (0, 4), (1, 4), (2, 4),
         (3, 4), (4, 4), (0, 5), (1, 5), (2, 5), (3, 5), (4, 5), (5, 5)]            # CalculiX, TYPE=ANISO


def tensor(matrix):
    """Tensor of fourth order of a 6 x 6 stiffness matrix in the order xx, yy, zz, xy, xz, yz."""
    full = np.zeros((3, 3, 3, 3))
    for p, (i, j) in enumerate(VOIGT):
        for q, (k, m) in enumerate(VOIGT):
            full[i, j, k, m] = full[j, i, k, m] = full[i, j, m, k] = full[j, i, m, k] = matrix[p, q]
    return full


def matrix(stiffness):
    """6 x 6 matrix of a stiffness tensor."""
    return np.array([[stiffness[i, j, k, m] for k, m in VOIGT] for i, j in VOIGT])


def engineering(e1, e2, e3, nu12, nu13, nu23, g12, g13, g23):
    """Stiffness from Young's moduli, Poisson's ratios nu_ij (strain -nu_ij e_i along j) and shear moduli."""
    compliance = np.diag([1 / e1, 1 / e2, 1 / e3, 1 / g12, 1 / g13, 1 / g23])
    compliance[0, 1] = compliance[1, 0] = -nu12 / e1
    compliance[0, 2] = compliance[2, 0] = -nu13 / e1
    compliance[1, 2] = compliance[2, 1] = -nu23 / e2
    return tensor(np.linalg.inv(compliance))


def isotropic(young, poisson):
    """Stiffness of an isotropic material."""
    return engineering(*[young] * 3, *[poisson] * 3, *[young / 2 / (1 + poisson)] * 3)


def constants(stiffness, kind):
    """The data of *ELASTIC, TYPE=ORTHO or ANISO, for a stiffness in its material axes."""
    full = matrix(stiffness)
    return [float(full[p]) for p in {"ORTHO": ORTHO, "ANISO": ANISO}[kind]]


def turn(degrees):
    """Columns are the material axes, turned anticlockwise from x and y."""
    a = np.deg2rad(degrees)
    return np.array([[np.cos(a), -np.sin(a), 0.0], [np.sin(a), np.cos(a), 0.0], [0.0, 0.0, 1.0]])


def turned(quantity, degrees):
    """A tensor of second or fourth order, given in material axes that are turned so, along x, y and z."""
    r = turn(degrees)
    if quantity.ndim == 2:
        return r @ quantity @ r.T
    return np.einsum("ia,jb,kc,md,abcd->ijkm", r, r, r, r, quantity, optimize=True)


def stress(stiffness, strain, plane, expansion=None, rise=0.0):
    """Stresses of a uniform strain and temperature rise; expansion is a 3 x 3 tensor."""
    elastic = np.array([[strain[0], strain[2] / 2, 0.0], [strain[2] / 2, strain[1], 0.0], [0.0, 0.0, 0.0]])
    if expansion is not None:
        elastic -= rise * np.asarray(expansion, float)
    if plane == "stress":
        # sigma_xz = sigma_yz = 0 holds with eps_xz = eps_yz = 0 where z is an axis of symmetry.
        elastic[2, 2] = 0.0
        elastic[2, 2] = -np.einsum("km,km", stiffness[2, 2], elastic) / stiffness[2, 2, 2, 2]
    found = np.einsum("ijkm,km", stiffness, elastic)
    return np.array([found[0, 0], found[1, 1], found[2, 2], found[0, 1]])


def strain(stiffness, load, plane, expansion=None, rise=0.0):
    """Strains of the uniform stresses load = (xx, yy, xy) and a temperature rise."""
    in_plane = [0, 1, 3]
    thermal = stress(stiffness, np.zeros(3), plane, expansion, rise)[in_plane]
    columns = np.array([stress(stiffness, unit, plane)[in_plane] for unit in np.eye(3)]).T
    return np.linalg.solve(columns, np.asarray(load, float) - thermal)


def displacements(points, strains):
    """Displacements of uniform strains at points (x, y), the origin fixed and the x axis not turned."""
    x, y = np.asarray(points, float).T
    return np.array([strains[0] * x + strains[2] * y, strains[1] * y]).T
