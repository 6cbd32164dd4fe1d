"""Names of the regions of a zone diagram, where each has room and covers the fewest marks."""

import numpy as np
from matplotlib.patheffects import withStroke

from .result import OPEN

CURVES = ("edge_contact", "edge_stick")
NO_STATE = -1  # outside the loads and pairs of the result
LABEL_GRID = (60, 48)  # where region names may stand: loads x places
LABEL_ROOM = 0.06  # room that a name needs around its middle, in parts of the axes
OUTSIDE_ROOM = 0.08  # the same outside its region, where a line leads there
MARK = 1.8  # half the size of a mark, in points
LOOKS = {"ha": "center", "va": "center", "linespacing": 0.95, "fontsize": 9}


def name_regions(picture, axes):
    """Write I, II and III where each region has room for it, on the fewest marks; of several such
    places where there is most room.

    A region too narrow for its name has it outside, with a line, so that no curve is covered; or none
    where it would cover marks there, which the legend names, but for the dots of open points.
    """
    axes.figure.draw_without_rendering()  # so that the size of the axes is known
    u, v = (np.linspace(0.0, 1.0, n) for n in LABEL_GRID)
    states = states_at(picture, axes, u, v).ravel()
    points = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
    room = np.where(states == NO_STATE, 0.0, room_around(points, states))
    middles = {
        state: np.flatnonzero(states == state)[np.argmax(room[states == state])]
        for state in picture.names
        if np.any(states == state)
    }
    taken = []
    for state, at in sorted(middles.items(), key=lambda item: -room[item[1]]):
        words = "\n".join(picture.names[state])
        covered = marks_under(picture, axes, words, u, v)
        if room[at] < LABEL_ROOM:
            place = free_place(points, room, points[at], points[taken], covered)
            if covered[place] and states[place] != OPEN:
                continue
        else:
            fits = np.flatnonzero((states == state) & (room >= LABEL_ROOM))
            place = at = fits[np.lexsort((-room[fits], covered[fits]))[0]]
        taken.append(place)
        axes.annotate(
            words,
            xy=points[at],
            xytext=points[place],
            xycoords="axes fraction",
            textcoords="axes fraction",
            zorder=5,
            **LOOKS,
            path_effects=[withStroke(linewidth=1.6, foreground="white")],  # apart from the marks
            arrowprops=None if place == at else {"arrowstyle": "-", "lw": 0.6, "shrinkB": 0},
        )


def marks_under(picture, axes, words, u, v):
    """Return how many marks of contact points, which lie on lines of one load and of one place, a
    name covers, by the place of its middle."""
    measured, frame = axes.text(0.5, 0.5, words, **LOOKS), axes.get_window_extent()
    box, mark = measured.get_window_extent(), MARK * axes.figure.dpi / 72.0
    measured.remove()
    wide, high = 0.5 * box.width + mark, 0.5 * box.height + mark

    def under(values, at, size, room):
        """Return at how many values a mark is nearer to each middle than `room` pixels."""
        return np.sum(np.abs(at[:, None] - values) * size < room, axis=1)

    columns = under(shares(axes, picture.abscissa, 0), u, frame.width, wide)
    rows = under(shares(axes, picture.coordinate, 1), v, frame.height, high)
    return np.outer(columns, rows).ravel()


def shares(axes, values, axis):
    """Return where values of an axis (0: loads, 1: places) are, as shares of its length."""
    points = np.full((len(values), 2), axes.get_xlim()[0] if axis else axes.get_ylim()[0])
    points[:, axis] = values
    return (axes.transData + axes.transAxes.inverted()).transform(points)[:, axis]


def states_at(picture, axes, u, v):
    """Return the states (loads, places) of the nearest increments and pairs, at shares of the axes.

    They are NO_STATE on the curves of edges and where one is nearer than the pair, before the first increment and pair, behind the last,
    and between pieces of the faces.
    """
    loads, places = shares(axes, picture.abscissa, 0), shares(axes, picture.coordinate, 1)
    row = np.argmin(np.abs(u[:, None] - loads), axis=1)
    pair = np.argmin(np.abs(v[:, None] - places), axis=1)
    states = picture.status[np.ix_(row, pair)].astype(int)
    on_faces = [~is_outside(v, places[piece]) for piece in picture.contact.pieces]
    states[:, ~np.any(on_faces, axis=0)] = NO_STATE
    if len(loads) == 1:  # its names stand beside its marks
        return states
    states[is_outside(u, loads)] = NO_STATE
    for rows, edge in (curve for key in CURVES for curve in picture.curves[key]):
        order, own = np.argsort(loads[rows]), np.full((len(loads), 1), np.nan)
        own[rows, 0] = edge = shares(axes, edge, 1)
        beside = (own[row] - v) * (own[row] - places[pair])  # an open point on an edge is outside
        states[(beside < 0.0) | ((beside == 0.0) & (states != OPEN))] = NO_STATE
        edge = np.interp(u, loads[rows][order], edge[order], left=np.nan, right=np.nan)
        states[np.abs(v - edge[:, None]) < 1.0 / len(v)] = NO_STATE
    return states


def is_outside(values, of):
    """Return where values are below the least of others or above the largest."""
    return (values < np.min(of)) | (values > np.max(of))


def room_around(points, states):
    """Return how far each point (k, 2) of the axes is from other states and from the frame."""
    room = np.min(np.hstack([points, 1.0 - points]), axis=1)
    for state in np.unique(states):
        mine, others = states == state, points[states != state]
        if len(others):
            away = points[mine][:, None, :] - others[None, :, :]
            room[mine] = np.minimum(room[mine], np.sqrt(np.min(np.sum(away**2, axis=2), axis=1)))
    return room


def free_place(points, room, target, taken, covered):
    """Return the number of a point near `target` that has room for a name, clear of others: up to
    twice as far as the nearest one if fewer marks are covered there."""
    clear = np.linalg.norm(points - target, axis=1)
    for other in taken:
        room = np.minimum(room, 0.5 * np.linalg.norm(points - other, axis=1))
    clear = np.where(room >= min(OUTSIDE_ROOM, room.max()), clear, np.inf)
    return int(np.lexsort((clear, np.where(clear <= 2.0 * clear.min(), covered, np.inf)))[0])
