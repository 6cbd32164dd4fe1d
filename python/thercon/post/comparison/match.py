"""Which rows of B belong to which rows of A: by key, by coordinate, or along a curve."""

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import cKDTree

from ..errors import UserError
from .series import AXES, COORDINATES, KEYS

METHODS = ("key", "coordinate", "curve")

# Times within this part of their range are the same.
SAME_TIME = 1e-6

# Nodes of one number this far apart, as a part of the model's size, are not the same node.
SAME_PLACE = 1e-3

# Points within this part of the model's size are one place, unless --within says otherwise.
WITHIN = 1e-6


@dataclass
class Rows:
    """Rows of A and of B that belong together, and what has no counterpart.

    Along a curve `second` is None and B's values are interpolated from `nodes` to `at`.
    """

    first: np.ndarray
    second: np.ndarray | None
    not_in_a: np.ndarray
    not_in_b: np.ndarray
    ambiguous: int = 0
    curves: list = field(default_factory=list)


def method_for(a, b, wanted):
    """Return how two frames are matched: as wanted, else by key, coordinate or curve as they can.

    None where no way is open.
    """
    keys = [name for name in shared_keys(a, b) if name != "contact"]
    places = {name for name in COORDINATES if name in a and name in b}
    able = {
        "key": bool(keys),
        "coordinate": {"x", "y"} <= places,
        # Rows that both have x and y without s are points of a plane, not of a curve.
        "curve": bool(places & {"x", "s"}) and ("s" in a or "s" in b or "y" not in places),
    }
    if wanted:
        return wanted if able[wanted] else None
    return next((name for name in METHODS if able[name]), None)


def shared_keys(a, b):
    """Return the keys that both frames have."""
    return [name for name in KEYS if name in a and name in b]


def by_key(a, b):
    """Match rows by the keys that both have. Equal keys are told apart by the caller."""
    keys = shared_keys(a, b)
    count = len(a[keys[0]])
    codes = np.zeros(count + len(b[keys[0]]), dtype=np.int64)
    for name in keys:
        both = np.concatenate((np.ma.getdata(a[name]), np.ma.getdata(b[name])))
        inverse = np.unique(both, return_inverse=True)[1].ravel()
        codes = np.unique(codes * (inverse.max() + 1) + inverse, return_inverse=True)[1].ravel()
    if "copy" in a and "copy" in b:  # the n-th with the n-th, where both have as many
        here, there = (np.bincount(each, minlength=codes.max() + 1)[codes]
                       for each in (codes[:count], codes[count:]))
        copies = np.concatenate((a["copy"], b["copy"]))
        codes = codes * (copies.max() + 1) + np.where(here == there, copies, 0)
    rows = join(codes[:count], codes[count:])
    check_places(a, b, rows, keys)
    return rows


def numbered(keys):
    """Return for each row how many rows up to it have its key."""
    _, inverse, counts = np.unique(keys, return_inverse=True, return_counts=True)
    order = np.argsort(inverse, kind="stable")
    found = np.empty(len(keys), dtype=int)
    found[order] = np.arange(len(keys)) - np.repeat(np.cumsum(counts) - counts, counts) + 1
    return found


def join(first, second):
    """Match codes; of rows with one code every pair is a match."""
    order = np.argsort(second, kind="stable")
    low = np.searchsorted(second[order], first, "left")
    high = np.searchsorted(second[order], first, "right")
    repeats = high - low
    a_rows = np.repeat(np.arange(len(first)), repeats)
    offsets = np.arange(len(a_rows)) - np.repeat(np.cumsum(repeats) - repeats, repeats)
    b_rows = order[np.repeat(low, repeats) + offsets]
    left = np.setdiff1d(np.arange(len(second)), b_rows)
    return Rows(a_rows, b_rows, left, np.flatnonzero(repeats == 0))


def check_places(a, b, rows, keys):
    """Raise the error for nodes that have one number and lie at different places."""
    if not all(name in columns for name in ("x", "y") for columns in (a, b)) or not len(rows.first):
        return
    there, here = places(a, "node_")[rows.first], places(b, "node_")[rows.second]
    apart = np.hypot(*(there - here).T)
    worst = int(np.argmax(apart))
    if apart[worst] > SAME_PLACE * size(places(a)):
        name = row_words(a, rows.first[worst], keys)
        raise UserError(
            f"{name} is at ({there[worst, 0]:g}, {there[worst, 1]:g}) in A and at "
            f"({here[worst, 0]:g}, {here[worst, 1]:g}) in B: other meshes are matched "
            "with --by coordinate or --by curve"
        )


def places(columns, of=""):
    """Return the points of a frame (rows, 2), or those `of` its nodes where they lie elsewhere."""
    names = [of + name if of + name in columns else name for name in ("x", "y")]
    return np.column_stack([np.ma.getdata(columns[name]) for name in names]).astype(float)


def size(points):
    """Return the largest extent of points."""
    return float(np.max(np.ptp(points, axis=0), initial=0.0)) or 1.0


def by_coordinate(a, b, within=None):
    """Match rows by place; a place that holds several rows of A or of B is ambiguous.

    Rows of B that only fill a block with zeros are taken where nothing else is.
    """
    here, there = places(a), places(b)
    within = WITHIN * size(here) if within is None else within
    padding = np.asarray(b.get("padding", np.zeros(len(there), dtype=bool)))
    target = np.full(len(here), -1)
    several = np.zeros(len(here), dtype=bool)
    for chosen in (np.flatnonzero(~padding), np.flatnonzero(padding)):
        free = np.flatnonzero((target < 0) & ~several)
        if len(chosen) and len(free):
            distance, index = cKDTree(there[chosen]).query(here[free], k=[1, 2])
            target[free] = np.where(distance[:, 0] <= within, take(chosen, index[:, 0]), -1)
            several[free] = distance[:, 1] <= within
    hits = np.bincount(target[target >= 0], minlength=len(there))
    several |= (target >= 0) & (hits[target] > 1)
    good = (target >= 0) & ~several
    near = np.zeros(len(there), dtype=bool)
    near[target[target >= 0]] = True
    if several.any():  # the other rows of B at ambiguous places are not missing either
        near |= cKDTree(here[several]).query(there)[0] <= within
    return Rows(
        np.flatnonzero(good),
        target[good],
        np.flatnonzero(~near & ~padding),
        np.flatnonzero((target < 0) & ~several),
        int(several.sum()),
    )


def take(values, index):
    """Return values at indices, one of which may be past the end."""
    return values[np.minimum(index, len(values) - 1)]


def along_curve(a, b, along):
    """Match rows of A to the curve through the rows of B, contact by contact where both name it."""
    names = np.unique(a["contact"]) if "contact" in a else [None]
    if len(names) > 1 and "contact" not in b:
        raise UserError("A has several contacts, B names none: choose one with --contact")
    first, left, outside, curves = [], [], [], []
    for name in names:
        mine = np.flatnonzero(a["contact"] == name) if name is not None else all_rows(a, along)
        theirs = all_rows(b, along)
        if "contact" in b:
            theirs = np.flatnonzero(b["contact"] == name)
        if "padding" in b:
            theirs = theirs[~b["padding"][theirs]]
        at = np.ma.getdata(a[along]).astype(float)[mine]
        nodes = np.ma.getdata(b[along]).astype(float)[theirs]
        order = np.argsort(nodes, kind="stable")
        theirs, nodes = theirs[order], nodes[order]
        twice = np.flatnonzero(np.diff(nodes) == 0.0)
        if twice.size:
            raise UserError(
                f"B has several rows at {along} = {nodes[twice[0]]:g}: no curve over {along} "
                "(--along s, --axis time, or another --by)"
            )
        inside = between(at, nodes)
        first.append(mine[inside])
        left.append(mine[~inside])
        outside.append(theirs[~between(nodes, at)])
        curves.append((at[inside], nodes, theirs))
    return Rows(
        np.concatenate(first), None, np.concatenate(outside), np.concatenate(left), curves=curves
    )


def all_rows(columns, name):
    """Return the numbers of all rows."""
    return np.arange(len(columns[name]))


def between(at, nodes):
    """Return which abscissae lie within the range of others."""
    if len(nodes) == 0:
        return np.zeros(len(at), dtype=bool)
    room = 1e-9 * max(float(np.ptp(nodes)), float(np.max(np.abs(nodes))))
    return (at >= np.min(nodes) - room) & (at <= np.max(nodes) + room)


def axis_for(a, b, wanted):
    """Return the axis, time or load, that two series have; None where one of them has neither."""
    if not a or not b:
        return None
    axis = wanted or next((name for name in AXES if name in a and name in b), None)
    if axis is None or axis not in a or axis not in b:
        names = [f"{side} has {' and '.join(each)}" for side, each in (("A", a), ("B", b))]
        raise UserError(f"no common axis: {', '.join(names)} (--axis, or --map time=...)")
    return axis


def same_times(first, second):
    """Return indices of times that are the same, the n-th of equal ones with the n-th."""
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    both = np.concatenate((first, second))
    scale = max(float(np.ptp(both)), 1e-12 * float(np.max(np.abs(both)))) if len(both) else 0.0
    free, pairs = np.ones(len(second), dtype=bool), []
    for number, time in enumerate(first):
        near = np.flatnonzero(free & (np.abs(second - time) <= SAME_TIME * scale))
        if near.size:
            closest = near[np.argmin(np.abs(second[near] - time))]
            free[closest] = False
            pairs.append((number, int(closest)))
    return pairs


def row_words(columns, row, keys=KEYS):
    """Return the name of a row, such as 'FACE node 17'."""
    words = []
    for name in keys:
        if name in columns:
            key = columns[name][row]
            words.append(str(key) if name == "contact" else f"{name} {key:g}")
    return " ".join(words) or f"row {row + 1}"
