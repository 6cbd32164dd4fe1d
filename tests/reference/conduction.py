#!/usr/bin/env python3
"""Steady heat conduction in closed form, to check thercon against: numpy only."""
import numpy as np


def wall(thickness, conductivity, hot, cold, film_hot=np.inf, film_cold=np.inf, contacts=()):
    """Flux through a wall between two fluids, and the temperatures of its faces.

    The wall may be of layers (sequences of thicknesses and conductivities) with conductances between them; the
    temperatures are those of both faces of every layer.
    """
    layers = np.atleast_1d(np.asarray(thickness, float) / np.asarray(conductivity, float))
    resistances = [1 / film_hot]
    for k, layer in enumerate(layers):
        resistances += [layer, 1 / contacts[k] if k < len(contacts) else 0.0]
    resistances[-1] = 1 / film_cold
    flux = (hot - cold) / sum(resistances)
    return flux, hot - flux * np.cumsum(resistances)[:-1]


def heated_wall(x, thickness, conductivity, source, left, right):
    """Temperature in a wall with a uniform source W and its faces at two temperatures: a parabola."""
    x = np.asarray(x, float)
    return left + (right - left) * x / thickness + source * x * (thickness - x) / (2 * conductivity)


def tube(r, inner, outer, inside, outside):
    """Temperature in a tube with its faces at two temperatures."""
    return inside + (outside - inside) * np.log(np.asarray(r, float) / inner) / np.log(outer / inner)


def tube_rate(inner, outer, conductivity, inside, outside):
    """Heat that flows outward through a tube, per unit of its length."""
    return 2 * np.pi * conductivity * (inside - outside) / np.log(outer / inner)


def rod(r, radius, conductivity, source, surface):
    """Temperature in a solid cylinder with a uniform source and a surface temperature."""
    return surface + source * (radius**2 - np.asarray(r, float) ** 2) / (4 * conductivity)


def conductivity_tensor(along, across, degrees):
    """K_xx, K_yy, K_xy of a material whose first axis is turned anticlockwise from x."""
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    return np.array([[along * c * c + across * s * s, (along - across) * c * s],
                     [(along - across) * c * s, along * s * s + across * c * c]])


def amplification(scheme):
    """What a step of eq. (3.4) at constant omega makes of the error of the last temperature: -b1/a1, where the
    weights of the start and of the end are (1 - theta) and theta."""
    theta = {"IMPLICIT": 1.0, "GALERKIN": 2 / 3, "CRANK-NICOLSON": 1 / 2, "EXPLICIT": 1.0}[scheme]
    return -(1 - theta) / theta


def stepped(scheme, conductances, ends, omegas, loads):
    """Temperatures of the two faces in contact of two rods, at every instant, by eq. (3.4).

    `scheme` is a1, a2, a3, b1, b2, b3, c1, c2; `conductances` are k/L of the rods, `ends` the temperatures of their far
    ends, `omegas` the conductance of the contact and `loads` the heat into the first face, one for every instant; the
    first instant is in equilibrium without heat at zero. Within the rods K T = 0 then stays so, and they count by k/L.
    """
    a1, a2, a3, b1, b2, b3, c1, c2 = scheme
    rods, contact = np.diag(conductances), np.array([[1.0, -1.0], [-1.0, 1.0]])
    faces = [np.zeros(2)]
    for i in range(len(omegas) - 1):
        now, later = omegas[i], omegas[i + 1]
        left = a1 * rods + (a2 * now + a3 * later) * contact
        right = -(b1 * rods + (b2 * now + b3 * later) * contact) @ faces[-1]
        right += rods @ (a1 * np.asarray(ends[i + 1], float) + b1 * np.asarray(ends[i], float))
        right += np.array([c1 * loads[i] + c2 * loads[i + 1], 0.0])
        faces.append(np.linalg.solve(left, right))
    return faces


def stepped_with_film(scheme, conductance, ends, films, sinks):
    """Temperatures of the end of a rod under a film, at every instant, by eq. (3.4) with the film in the place of G and
    its sink in that of Q; from an equilibrium at zero. With c1 = 0 loads count as they are at the end, films with them.
    """
    a1, a2, a3, b1, b2, b3, c1, c2 = scheme
    if c1 == 0.0:
        a2, a3, b2, b3 = 0.0, a2 + a3, 0.0, b2 + b3
    found = [0.0]
    for i in range(len(films) - 1):
        now, later = films[i], films[i + 1]
        right = -(b1 * conductance + b2 * now + b3 * later) * found[-1]
        right += conductance * (a1 * ends[i + 1] + b1 * ends[i]) + c1 * now * sinks[i] + c2 * later * sinks[i + 1]
        found.append(right / (a1 * conductance + a2 * now + a3 * later))
    return found
