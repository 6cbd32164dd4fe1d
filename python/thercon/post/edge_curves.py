"""Edges of zones, joined from increment to increment."""

import numpy as np

from .result import OPEN, STICK


def edge_curves(contact, key):
    """Return the curves of the edges of "contact" or "stick": [(rows of /history, s)], one for
    each edge, from the increment at which it appears to that at which it goes.

    Each edge parts a zone from what is beside it. Two edges of successive increments are one if
    both the zone and what is beside it overlap, however many edges each increment has. Those of one
    piece of the faces are none of another.
    """
    return [curve for piece in contact.pieces for curve in curves_of(contact, key, piece)]


def curves_of(contact, key, piece):
    """Return the curves of one piece."""
    first, last = contact["s"][piece][[0, -1]]
    states = contact["status"][:, piece][:, [0, -1]]
    inside = states == STICK if key == "stick" else states != OPEN
    curves, before = [], []  # before: the edges of the increment before, each with its curve
    for row, edges in enumerate(contact[f"edges_{key}"]):
        found = []
        own = edges[(edges >= first) & (edges <= last)]
        for edge in sides_of(own, *inside[row], last):
            same = [old for old in before if is_one(old[0], edge)]
            if same:
                old = min(same, key=lambda each: abs(each[0][1] - edge[1]))
                before.remove(old)
                curve = old[1]
            else:
                curve = ([], [])
                curves.append(curve)
            curve[0].append(row)
            curve[1].append(edge[1])
            found.append((edge, curve))
        before = found
    return [(np.array(rows), np.array(places)) for rows, places in curves]


def sides_of(edges, begins_inside, ends_inside, end):
    """Return each edge of one increment as (from, edge, to, whether the zone is below it): it parts
    what is between `from` and itself from what is between itself and `to`.

    A zone that reaches the last contact point, at `end`, has an edge there.
    """
    edges = [(edge, bool(begins_inside) == (k % 2 == 0)) for k, edge in enumerate(edges.tolist())]
    if ends_inside:
        edges.append((end, True))
    places = [-np.inf, *(edge for edge, _ in edges), np.inf]
    return [(*places[k : k + 3], is_upper) for k, (_, is_upper) in enumerate(edges)]


def is_one(old, new):
    """Whether two edges of successive increments are one."""
    below = old[0] <= new[1] and new[0] <= old[1]
    above = old[1] <= new[2] and new[1] <= old[2]
    return old[3] == new[3] and below and above


def zeros_of(contact, row, piece):
    """Return edges of contact inside a piece, where tractions fall to zero, and the numbers of its
    points before which each falls: at a contact point that is an edge, on the open side of it; of
    one that is both edges, on either side."""
    s, status = contact["s"][piece], contact["status"][row, piece]
    edges = contact["edges_contact"][row]
    edges = edges[(edges > s[0]) & (edges < s[-1])]  # no fall to zero at the face's end
    after = np.searchsorted(s, edges, side="right")
    begins = (status[after - 2] == OPEN) & (np.diff(edges, prepend=s[0]) > 0.0)
    return edges, after - ((s[after - 1] == edges) & begins)
