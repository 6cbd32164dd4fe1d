"""Names of the regions of a zone diagram, where each has most room."""

import numpy as np
from matplotlib.patheffects import withStroke

CURVES = ("edge_contact", "edge_stick")
NO_STATE = -1  # outside the loads and pairs of the result
LABEL_GRID = (60, 48)  # where region names may stand: loads x places
LABEL_ROOM = 0.08  # room that a name needs around its middle, in parts of the axes


def name_regions(picture, axes):
    """Write I, II and III where each region has most room around it.

    A region too narrow for its name has it outside, with a line, so that no curve is covered.
    """
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    u, v = (np.linspace(0.0, 1.0, n) for n in LABEL_GRID)
    states = states_at(picture, left + u * (right - left), low + v * (high - low)).ravel()
    points = np.stack(np.meshgrid(u, v, indexing="ij"), axis=-1).reshape(-1, 2)
    room = np.where(states == NO_STATE, 0.0, room_around(points, states))
    middles = {
        state: np.flatnonzero(states == state)[np.argmax(room[states == state])]
        for state in picture.names
        if np.any(states == state)
    }
    taken = []
    for state, at in sorted(middles.items(), key=lambda item: -room[item[1]]):
        place = at
        if room[at] < LABEL_ROOM:
            place = free_place(points, room, points[at], points[taken])
        taken.append(place)
        axes.annotate(
            "\n".join(picture.names[state]),
            xy=points[at],
            xytext=points[place],
            xycoords="axes fraction",
            textcoords="axes fraction",
            ha="center",
            va="center",
            linespacing=0.95,
            zorder=5,
            fontsize=9,
            path_effects=[withStroke(linewidth=1.6, foreground="white")],  # apart from the marks
            arrowprops=None if place == at else {"arrowstyle": "-", "lw": 0.6, "shrinkB": 0},
        )


def states_at(picture, loads, places):
    """Return the states (loads, places) of the nearest increments and pairs.

    They are NO_STATE on the main curves, before the first increment and pair, and behind the
    last.
    """
    row = np.argmin(np.abs(loads[:, None] - picture.abscissa[None, :]), axis=1)
    pair = np.argmin(np.abs(places[:, None] - picture.coordinate[None, :]), axis=1)
    states = picture.status[np.ix_(row, pair)].astype(int)
    states[:, is_outside(places, picture.coordinate)] = NO_STATE
    if len(picture.abscissa) == 1:  # its names stand beside its marks
        return states
    states[is_outside(loads, picture.abscissa)] = NO_STATE
    order, near = np.argsort(picture.abscissa), np.ptp(places) / len(places)
    for key in CURVES:
        edge = np.interp(loads, picture.abscissa[order], picture.edges(key)[order])
        states[np.abs(places - edge[:, None]) < near] = NO_STATE
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


def free_place(points, room, target, taken):
    """Return the number of the point near `target` that has room for a name, clear of others."""
    clear = np.linalg.norm(points - target, axis=1)
    for other in taken:
        room = np.minimum(room, 0.5 * np.linalg.norm(points - other, axis=1))
    return int(np.argmin(np.where(room >= min(LABEL_ROOM, room.max()), clear, np.inf)))
