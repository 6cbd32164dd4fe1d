"""Principal, radial and hoop stresses of a stress (n, 4): xx, yy, zz, xy."""

import re

import numpy as np


def principal(stress):
    """Return the principal stresses (n, 3), the largest first."""
    xx, yy, zz, xy = stress.T
    middle, radius = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    return -np.sort(-np.column_stack((middle + radius, middle - radius, zz)), axis=1)


def radial(stress, points, axisymmetric):
    """Return the stress along the radius: from the axis, in plane models from the origin.

    `points` (n, 2) are the undeformed places; at the origin the radius is x.
    """
    xx, yy, _, xy = stress.T
    if axisymmetric:
        return xx
    angle = np.arctan2(points[:, 1], points[:, 0])
    c, s = np.cos(angle), np.sin(angle)
    return xx * c**2 + yy * s**2 + 2.0 * xy * c * s


def hoop(stress, points, axisymmetric):
    """Return the stress around the axis, in plane models around the origin."""
    if axisymmetric:
        return stress[:, 2]
    return stress[:, 0] + stress[:, 1] - radial(stress, points, axisymmetric)


def is_axisymmetric(cards):
    """Whether the cards of a deck describe an axisymmetric model: *OPTIONS, PLANE= decides, else
    the element type."""
    keywords = [card.upper().replace(" ", "") for card in cards if card.lstrip().startswith("*")]
    planes = [re.search(r"PLANE=(\w+)", card) for card in keywords if card.startswith("*OPTIONS")]
    planes = [found.group(1) for found in planes if found]
    if planes:
        return planes[-1].startswith("AXI")
    return any(re.match(r"\*ELEMENT,.*TYPE=CAX", card) for card in keywords)
