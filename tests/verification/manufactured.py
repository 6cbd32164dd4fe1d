"""Fields that satisfy the equations without heat sources and body forces, and what elements make of
them: nodal values on *VERIFY cards, and norms of the error over the elements.

Plane: T = Re f, and 2G (u + iv) = kappa phi - z conj(phi') - conj(psi), by Kolosov and
Muskhelishvili, with entire functions f, phi, psi. Axisymmetric: harmonic polynomials of r and z,
and Papkovich's 2G u = 4 (1 - nu) B e_z - grad(z B + b) with harmonic B and b.
"""

from itertools import product

import numpy as np
from energy_norm import rule, shapes
from manual import Check
from physics import material, mesh, nodes_of

YOUNG, POISSON = 1000.0, 0.3
SHEAR = YOUNG / 2 / (1 + POISSON)
BASE = 4  # cells a side of the mesh whose inner corners are moved
# Offsets of the inner corners in parts of a cell, up to a quarter.
OFFSETS = np.array([[(0.18, -0.11), (-0.21, 0.16), (0.09, 0.23)],
                    [(-0.14, 0.07), (0.24, -0.19), (-0.17, -0.08)],
                    [(0.12, 0.21), (-0.06, -0.24), (0.2, 0.13)]])


def distorted(x, y):
    """Return the place of a point of the unit square: bilinear between the moved corners."""
    at = np.array([x, y]) * BASE
    low = np.minimum(at.astype(int), BASE - 1)
    part = at - low
    place = np.zeros(2)
    for step in product((0, 1), (0, 1)):
        corner = low + step
        moved = corner.astype(float)
        if (corner > 0).all() and (corner < BASE).all():
            moved += OFFSETS[corner[0] - 1, corner[1] - 1]
        place += np.prod(np.where(step, part, 1 - part)) * moved
    return place / BASE


def plane_fields(x, y, plane):
    """Return T, u_x, u_y and their gradients (2, 3, points)."""
    z = x + 1j * y
    kappa = 3 - 4 * POISSON if plane == "CPE" else (3 - POISSON) / (1 + POISSON)
    wave = np.exp(1.5 * z)
    heat, phi, psi = wave, wave / 100, (wave + z**4) / 100
    slope, curve = 1.5 * phi, 2.25 * phi
    psi_slope = (1.5 * wave + 4 * z**3) / 100
    moved = kappa * phi - z * np.conj(slope) - np.conj(psi)
    common = kappa * slope - np.conj(slope)
    other = -z * np.conj(curve) - np.conj(psi_slope)
    # d/dy of z conj(phi') is i conj(phi') - i z conj(phi''), that of kappa phi is i kappa phi'.
    along = [common + other, 1j * (common - other)]
    values = np.array([heat.real, moved.real / 2 / SHEAR, moved.imag / 2 / SHEAR])
    gradient = np.array([[(turn * 1.5 * heat).real, d.real / 2 / SHEAR, d.imag / 2 / SHEAR]
                         for turn, d in zip((1, 1j), along, strict=True)])
    return values, gradient


def axial_fields(r, z):
    """Return T, u_r, u_z and their gradients (2, 3, points)."""
    heat = z**3 - 1.5 * z * r**2
    heat_r, heat_z = -3 * z * r, 3 * z**2 - 1.5 * r**2
    # B = z^3 - 3/2 z r^2, b = z^4 - 3 z^2 r^2 + 3/8 r^4; F = z B + b.
    strength = 0.02 * SHEAR
    b_r, b_z = heat_r, heat_z
    f_r = -3 * z**2 * r - 6 * z**2 * r + 1.5 * r**3
    f_z = 4 * z**3 - 3 * z * r**2 + 4 * z**3 - 6 * z * r**2
    f_rr = -9 * z**2 + 4.5 * r**2
    f_rz = -18 * z * r
    f_zz = 24 * z**2 - 9 * r**2
    scale = strength / 2 / SHEAR
    c = 4 * (1 - POISSON)
    values = np.array([heat, -scale * f_r, scale * (c * heat - f_z)])
    gradient = np.array([[heat_r, -scale * f_rr, scale * (c * b_r - f_rz)],
                         [heat_z, -scale * f_rz, scale * (c * b_z - f_zz)]])
    return values, gradient


def fields(x, y, family):
    """Return T, u and their gradients at points."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    return axial_fields(x, y) if family == "CAX" else plane_fields(x, y, family)


def place(family):
    """Return the map of the unit square to the body."""
    shift = 1.0 if family == "CAX" else 0.0

    def to(x, y):
        at = distorted(x, y)
        return float(at[0] + shift), float(at[1])

    return to


def cells_of(cards):
    """Return the nodes of each element."""
    start = next(k for k, card in enumerate(cards) if card.startswith("*ELEMENT"))
    rows = []
    for card in cards[start + 1:]:
        if card.startswith("*"):
            break
        rows.append([int(n) for n in card.split(",")][1:])
    return np.array(rows)


def grid(kind, n):
    """Return the cards of the mesh."""
    sides = [k / n for k in range(n + 1)]
    return mesh("BODY", sides, sides, kind, to=place(kind[:3]))


def deck(kind, n):
    """Return the cards of a deck and its checks: T and u on the outline prescribed, those of all
    other nodes judged, each to twice what the exact field differs from its interpolation."""
    cards = grid(kind, n)
    nodes = nodes_of(cards)
    held = sides_of(cards)
    numbers = np.array(list(nodes))
    values, _ = fields(*np.array([nodes[k] for k in numbers]).T, kind[:3])
    allowed = 2 * np.array(interpolation_error(kind, n))
    prescribed, checks = ["*BOUNDARY"], []
    for k, number in enumerate(numbers):
        rows = zip((11, 1, 2), ("NT", "U1", "U2"), values[:, k], allowed, strict=True)
        for dof, quantity, value, most in rows:
            if number in held:
                prescribed.append(f"{number}, {dof}, {dof}, {value:.17g}")
            else:
                checks.append(Check(quantity, quantity, str(number), value, most, "ABS"))
    return [*cards, *material("BODY", (YOUNG, POISSON), conductivity=2.0),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.",
            "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.",
            *prescribed, "*END STEP"], checks


def sides_of(cards):
    """Return the numbers of the nodes on the outline."""
    found, inside = set(), False
    for card in cards:
        if card.startswith("*"):
            inside = card.startswith("*NSET")
        elif inside:
            found.add(int(card))
    return found


def sampled(kind, n):
    """Return the cells, shape functions, their slopes (2, cells, points, nodes), weights and places
    of the integration points."""
    cards = grid(kind, n)
    nodes, cells = nodes_of(cards), cells_of(cards)
    coordinates = np.array([nodes[k] for row in cells for k in row]).reshape(*cells.shape, 2)
    points, weights = rule(cells.shape[1])
    psi, slope = shapes(cells.shape[1], points)
    jacobian = np.einsum("dgn,eni->egid", slope, coordinates)
    slopes = np.einsum("dgn,egdi->iegn", slope, np.linalg.inv(jacobian))
    places = np.einsum("gn,eni->ieg", psi, coordinates)
    return cells, psi, slopes, weights * np.linalg.det(jacobian), places


def interpolation_error(kind, n):
    """Return by how much T and u differ at most from what their nodal values make in the elements;
    of both displacements the larger one."""
    cells, psi, _, _, places = sampled(kind, n)
    nodes = nodes_of(grid(kind, n))
    exact, _ = fields(*places, kind[:3])
    corners = np.array([nodes[k] for row in cells for k in row]).reshape(*cells.shape, 2)
    nodal, _ = fields(corners[..., 0], corners[..., 1], kind[:3])
    worst = np.abs(np.einsum("gn,ken->keg", psi, nodal) - exact).max(axis=(1, 2))
    return worst[0], worst[1:].max(), worst[1:].max()


def norms(kind, n, values):
    """Return the relative errors of T, its gradient, u and its gradient in the mean square, for
    nodal values (3) by the number of the node."""
    cells, psi, slopes, volume, places = sampled(kind, n)
    exact, gradient = fields(*places, kind[:3])
    nodal = np.array([[values[k] for k in row] for row in cells])
    found = np.einsum("gn,enk->keg", psi, nodal)
    slope = np.einsum("iegn,enk->ikeg", slopes, nodal)

    def part(error, whole):
        return float(np.sqrt((volume * error**2).sum() / (volume * whole**2).sum()))

    return tuple(error for chosen in (slice(0, 1), slice(1, 3)) for error in (
        part(found[chosen] - exact[chosen], exact[chosen]),
        part(slope[:, chosen] - gradient[:, chosen], gradient[:, chosen])))
