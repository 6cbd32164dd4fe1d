"""Drawings of rigid bodies: lines with short strokes on the side of the body."""

import numpy as np
from matplotlib.collections import LineCollection

from .checked_file import need, numbers

REACH = 0.15  # of the size of the model: so far from it drawings are shown
STROKES = 45  # of a line as long as the window
STROKE = 0.02  # length of a stroke, of the size of the window


def lines_of(result, step, factor=1.0):
    """Return the drawings as lines [(k, 2)], displaced at a time step of the fields (None: not)."""
    return [points + factor * moved(points, *motion_of(result, group, step)) for points, group in
            surfaces(result)]


def surfaces(result):
    """Return points (k, 2) and group of each rigid surface; none in files of earlier versions."""
    whole = result.file.get("rigid_surfaces", {})
    return [(numbers(whole[name], "points", like=(None, 2), finite=True), whole[name])
            for name in whole]


def motion_of(result, group, step):
    """Return where the reference node is, (2), and its displacement and rotation at a time step."""
    found = [np.flatnonzero(result.cells.node_id == group.attrs.get(f"{name}_node", -1))
             for name in ("reference", "rotation")]
    need(group, all(len(each) for each in found), "its nodes are no points of the mesh")
    reference, rotation = (int(each[0]) for each in found)
    displacement = None if step is None else result.point_data("displacement", step)
    if displacement is None:
        return result.cells.points[reference], np.zeros(2), 0.0
    return (result.cells.points[reference], displacement[reference, :2],
            float(displacement[rotation, 0]))


def moved(points, centre, displacement, rotation):
    """Return the displacements of points that follow a node by small rotations."""
    arms = points - centre
    return displacement + rotation * np.column_stack((-arms[:, 1], arms[:, 0]))


def with_lines(window, lines):
    """Return a window, [[x, y least], [x, y most]], with what lines have near it."""
    reach = REACH * np.max(window[1] - window[0])
    for line in lines:
        low, high = line.min(axis=0), line.max(axis=0)
        if np.all(low <= window[1] + reach) and np.all(high >= window[0] - reach):
            window = np.array([np.minimum(window[0], np.maximum(low, window[0] - reach)),
                               np.maximum(window[1], np.minimum(high, window[1] + reach))])
    return window


def draw_rigid(axes, lines):
    """Draw lines with strokes at their left, where the rigid bodies are."""
    size = max(np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim()))
    for line in lines:
        steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
        along = np.concatenate(([0.0], np.cumsum(steps)))
        at = np.arange(0.5, along[-1] * STROKES / size) * size / STROKES
        piece = np.clip(np.searchsorted(along, at) - 1, 0, len(steps) - 1)
        tangent = (np.diff(line, axis=0) / np.maximum(steps, 1e-300)[:, None])[piece]
        foot = line[piece] + (at - along[piece])[:, None] * tangent
        # Half-way between the left normal and backwards.
        away = np.column_stack((-tangent[:, 1], tangent[:, 0])) - tangent
        strokes = np.stack((foot, foot + STROKE * size * away / np.sqrt(2.0)), axis=1)
        looks = {"colors": "black", "zorder": 3.5}
        axes.add_collection(LineCollection([line], linewidths=1.1, **looks))
        axes.add_collection(LineCollection(strokes, linewidths=0.4, **looks))
