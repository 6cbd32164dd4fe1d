#!/usr/bin/env python3
"""A strip pressed on a rigid base, heated and cooled: slip and stick in closed form, to check thercon against.

One dimension: the strip of height h lies on 0 <= x <= L, held at x = 0, free at x = L, pressed by p with friction mu and
heated evenly by T. The stuck middle has the stress E alpha T; mu p balances it over the slip length
d = E alpha T h/(mu p) from the free end. On the way back slip of the other sign enters from the free end over the
length that a change of 2 mu p balances: half of d when T returns to 0.
"""
import numpy as np
from cylinder_reference import shape


def slip_length(height, young, expansion, rise, friction, pressure):
    """Length of the slip zone at the free end at the first heating."""
    return young * expansion * rise * height / (friction * pressure)


def reversed_slip_length(height, young, expansion, change, friction, pressure):
    """Length of the zone that slips back after a change of the temperature."""
    return slip_length(height, young, expansion, change, 2 * friction, pressure)


def held_force(height, young, expansion, rise):
    """Sum of the friction on the strip, per thickness: the force in the stuck middle."""
    return young * expansion * rise * height


# The same strip in two dimensions, on eight-node elements: the pressure sags at the end of the slip zone and the stuck
# part takes some of the shear, over about a height, which lengthens the stuck part. Numpy only.

def strip_matrices(length, height, young, expansion, count):
    """Stiffness with nu = 0, nodal forces of a unit rise of temperature and of a unit pressure on top, and the nodes
    (x index of half elements, 0 bottom, 1 middle, 2 top) of a row of `count` elements."""
    nodes = [(i, j) for i in range(2 * count + 1) for j in range(3) if not (i % 2 and j == 1)]
    number = {node: k for k, node in enumerate(nodes)}
    step, points = length / count, [(-0.6**0.5, 5 / 9), (0.0, 8 / 9), (0.6**0.5, 5 / 9)]
    around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    stiffness, warm = np.zeros((16, 16)), np.zeros(16)
    for a, weight_a in points:
        for b, weight_b in points:
            slope = shape(a, b)[1] * np.array([[2 / step], [2 / height]])
            strain = np.zeros((3, 16))
            strain[0, 0::2] = strain[2, 1::2] = slope[0]
            strain[1, 1::2] = strain[2, 0::2] = slope[1]
            area = weight_a * weight_b * step * height / 4
            stiffness += area * strain.T @ np.diag([young, young, young / 2]) @ strain
            warm += area * young * expansion * (strain[0] + strain[1])
    whole, heating, pressing = np.zeros((2 * len(nodes),) * 2), np.zeros(2 * len(nodes)), np.zeros(2 * len(nodes))
    for e in range(count):
        at = [number[2 * e + i, j] for i, j in around]
        freedoms = np.array([(2 * n, 2 * n + 1) for n in at]).ravel()
        whole[np.ix_(freedoms, freedoms)] += stiffness
        heating[freedoms] += warm
        for n, share in ((at[3], 1), (at[6], 4), (at[2], 1)):
            pressing[2 * n + 1] -= share * step / 6
    return whole, heating, pressing, nodes


def strip_zones(length, height, young, expansion, friction, pressure, rises, count):
    """Places of the bottom nodes, and which of them stick after each of the `rises`: all nodes stay closed on a rigid
    base, x = 0 is held. In each increment a stuck node keeps its place, a slipping one has mu times the normal force
    of its node against its motion."""
    whole, heating, pressing, nodes = strip_matrices(length, height, young, expansion, count)
    bottom = np.array([k for k, (_, j) in enumerate(nodes) if j == 0])
    held = np.zeros(len(whole), bool)
    held[[2 * k for k, (i, _) in enumerate(nodes) if i == 0]] = held[2 * bottom + 1] = True
    face, normal = 2 * bottom[1:], 2 * bottom[1:] + 1
    loads = np.column_stack([np.eye(len(whole))[:, face], heating, pressing])
    moved = np.zeros_like(loads)
    moved[~held] = np.linalg.solve(whole[np.ix_(~held, ~held)], loads[~held])
    lifted = (whole @ moved - loads)[normal]      # the base's forces on the strip
    sliding, place, found = np.zeros(len(face)), np.zeros(len(face)), []
    for rise in rises:
        given = np.array([rise, pressure])
        for _ in range(200):
            rows, right = moved[face][:, :-2].copy(), place - moved[face][:, -2:] @ given
            slips = sliding != 0
            rows[slips] = (np.eye(len(face)) - (friction * sliding * lifted[:, :-2].T).T)[slips]
            right[slips] = (friction * sliding * (lifted[:, -2:] @ given))[slips]
            force = np.linalg.solve(rows, right)
            carried = lifted[:, :-2] @ force + lifted[:, -2:] @ given
            motion = moved[face] @ np.r_[force, given] - place
            rounding = 1e-11 * np.abs(place).max(initial=1e-9)
            new = np.where(slips, np.where(sliding * motion > rounding, 0.0, sliding),
                           np.sign(force) * (np.abs(force) > friction * carried * (1 + 1e-11)))
            if (new == sliding).all():
                break
            sliding = new
        else:
            raise RuntimeError(f"the zones do not settle at {rise}")
        assert (carried > 0).all()
        place = place + motion
        found.append(sliding == 0)
    return length * np.arange(1, 2 * count + 1) / (2 * count), np.array(found)
