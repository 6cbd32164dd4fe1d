"""Names of the regions of a zone diagram, where each has room and covers the fewest marks."""

import numpy as np
from matplotlib.patheffects import withStroke

CURVES = ("edge_contact", "edge_stick")
NO_STATE = -1  # outside the loads and pairs of the result
LABEL_GRID = (60, 48)  # where region names may stand: loads x places
LABEL_ROOM = 0.08  # room that a name needs around its middle, in parts of the axes
MARK = 1.8  # half the size of a mark, in points
LOOKS = {"ha": "center", "va": "center", "linespacing": 0.95, "fontsize": 9}


def name_regions(picture, axes):
    """Write I, II and III where each region has room for it, on the fewest marks; of several such
    places where there is most room.

    A region too narrow for its name has it outside, with a line, so that no curve is covered.
    """
    axes.figure.draw_without_rendering()  # so that the size of the axes is known
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
        words = "\n".join(picture.names[state])
        covered = marks_under(picture, axes, words, u, v)
        if room[at] < LABEL_ROOM:
            place = free_place(points, room, points[at], points[taken], covered)
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
    """Return how many marks a name covers, by the place of its middle: of contact points, which lie
    on lines of one load and of one place, and of further edges."""
    measured, frame = axes.text(0.5, 0.5, words, **LOOKS), axes.get_window_extent()
    box, mark = measured.get_window_extent(), MARK * axes.figure.dpi / 72.0
    measured.remove()
    wide, high = 0.5 * box.width + mark, 0.5 * box.height + mark
    edges = np.hstack([picture.edges(f"edges_{key[5:]}") for key in CURVES])
    loads = np.repeat(picture.abscissa, edges.shape[1])[~np.isnan(edges.ravel())]

    def under(values, at, axis):
        """Return whether marks are near a middle, (middles, marks)."""
        pixels = axes.transData.transform(np.stack([values, values], axis=1))[:, axis]
        start, size = ((frame.x0, frame.width), (frame.y0, frame.height))[axis]
        return np.abs(start + at[:, None] * size - pixels) < (wide, high)[axis]

    columns = np.sum(under(picture.abscissa, u, 0), axis=1)
    rows = np.sum(under(picture.coordinate, v, 1), axis=1)
    further = under(loads, u, 0).astype(int) @ under(edges[~np.isnan(edges)], v, 1).astype(int).T
    return (np.outer(columns, rows) + further).ravel()


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


def free_place(points, room, target, taken, covered):
    """Return the number of a point near `target` that has room for a name, clear of others: up to
    twice as far as the nearest one if fewer marks are covered there."""
    clear = np.linalg.norm(points - target, axis=1)
    for other in taken:
        room = np.minimum(room, 0.5 * np.linalg.norm(points - other, axis=1))
    clear = np.where(room >= min(LABEL_ROOM, room.max()), clear, np.inf)
    return int(np.lexsort((clear, np.where(clear <= 2.0 * clear.min(), covered, np.inf)))[0])
