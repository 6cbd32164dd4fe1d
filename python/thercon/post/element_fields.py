"""Fields with one number an element, drawn element by element."""

import numpy as np
from matplotlib.collections import PolyCollection

from .cells import CORNERS, outlines


def centres(cells, points):
    """Return the means of the corners (m, 2) of all elements, in the file's order."""
    found = np.empty((cells.count, 2))
    for kind, group in cells.groups.items():
        found[cells.members[kind]] = points[group[:, : CORNERS[kind]]].mean(axis=1)
    return found


def areas(cells, points):
    """Return the areas (m) of all elements between their corners, in the file's order."""
    found = np.empty(cells.count)
    for kind, group in cells.groups.items():
        x, y = np.moveaxis(points[group[:, : CORNERS[kind]]], 2, 0)
        turned = x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y
        found[cells.members[kind]] = 0.5 * np.abs(turned.sum(axis=1))
    return found


def of_elements(cells, parts):
    """Return {element type: values} as one array over all elements, in the file's order."""
    found = np.empty(cells.count, dtype=next(iter(parts.values())).dtype)
    for kind, members in cells.members.items():
        found[members] = parts[kind]
    return found


def in_window(cells, points, window):
    """Tell which elements have a corner in the window."""
    inside = np.all((points >= window[0]) & (points <= window[1]), axis=1)
    found = np.zeros(cells.count, dtype=bool)
    for kind, group in cells.groups.items():
        found[cells.members[kind]] = inside[group[:, : CORNERS[kind]]].any(axis=1)
    return found


def fill(axes, cells, points, values, colours, norm):
    """Fill each element with the colour of its value; return what a colour bar needs."""
    shapes = {kind: outlines(kind, group, points) for kind, group in cells.groups.items()}
    numbers = np.concatenate([cells.members[kind] for kind in shapes])
    filled = PolyCollection(
        [shape for group in shapes.values() for shape in group],
        array=np.ma.masked_invalid(values[numbers]),
        cmap=colours,
        norm=norm,
        edgecolors="face",  # no light seams between elements
        linewidths=0.15,
    )
    axes.add_collection(filled)
    return filled


def table(cells, moved, fields):
    """Return the drawn fields as columns: one row for each element."""
    number, body = (of_elements(cells, parts) for parts in (cells.element_ids, cells.bodies))
    x, y = centres(cells, cells.points).T
    x_drawn, y_drawn = centres(cells, moved).T
    columns = {"element": number, "body": body, "x": x, "y": y}
    return columns | {"x_drawn": x_drawn, "y_drawn": y_drawn} | fields
