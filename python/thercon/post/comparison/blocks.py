"""The blocks of a comparison: B's values on the rows of A, by quantity and time."""

import numpy as np

from ..errors import UserError, nearest_name
from . import match
from .judge import Block
from .series import AXES, COORDINATES, KEYS

EXAMPLES = 3


def history_blocks(first, second, shared, states, options):
    """Return one block for each quantity of a history."""
    a, b = first.frame(0), second.frame(0)
    axes = [{axis: 0 for axis in AXES if axis in each} for each in (a, b)]
    axis = match.axis_for(*axes, options.axis)
    at, theirs = (np.ma.getdata(each[axis]).astype(float) for each in (a, b))
    columns = {axis: at}
    blocks = []
    for name, other in shared:
        there = np.flatnonzero(~np.ma.getmaskarray(b[other]))
        if options.by == "curve":
            rows = match.along_curve({axis: at}, {axis: theirs[there]}, axis)
            rows.not_in_a = there[rows.not_in_a]
            rows.curves = [(x, nodes, there[k]) for x, nodes, k in rows.curves]
        else:
            pairs = match.same_times(at, theirs[there])
            i = np.array([k for k, _ in pairs], dtype=int)
            j = np.array([k for _, k in pairs], dtype=int)
            left_a = np.setdiff1d(np.arange(len(at)), i)
            left_b = np.setdiff1d(np.arange(len(there)), j)
            rows = match.Rows(i, there[j], there[left_b], left_a)
        block = make_block(name, other, rows, a, b, columns, states)
        block.by = "curve" if options.by == "curve" else axis
        block.axis = axis
        block.examples = {
            "not_in_b": [f"{axis} {each:g}" for each in at[rows.not_in_b[:EXAMPLES]]],
            "not_in_a": [f"{axis} {each:g}" for each in theirs[rows.not_in_a[:EXAMPLES]]],
        }
        blocks.append(block)
    return blocks


def frame_blocks(first, second, shared, states, options):
    """Return one block for each quantity and time of tables with rows.

    None where the tables have no keys or coordinates in common by which rows could meet.
    """
    a_numbers, b_numbers = range(len(first.frames)), range(len(second.frames))
    axis = match.axis_for(first.axes, second.axes, options.axis)
    pairs, lost = paired_frames(first, second, axis, options)
    blocks, last = [], None
    for i, j in pairs:
        a, b = selected(first.frame(a_numbers[i]), options.contact), second.frame(b_numbers[j])
        way = match.method_for(a, b, options.by)
        if way is None:
            return None
        last = rows_of(way, a, b, options, last)
        rows, keys = last[0], [name for name in (*KEYS, *COORDINATES) if name in a]
        columns = {name: np.ma.getdata(a[name]) for name in keys}
        at = None if not first.axes else float(first.axes[axis or axis_of(first)][i])
        for name, other in shared:
            block = make_block(name, other, rows, a, b, columns, states)
            block.by = {"key": "+".join(match.shared_keys(a, b))}.get(way, way)
            block.axis, block.at = axis or axis_of(first), at
            block.examples = {
                "not_in_b": [match.row_words(a, k) for k in rows.not_in_b[:EXAMPLES]],
                "not_in_a": [match.row_words(b, k) for k in rows.not_in_a[:EXAMPLES]],
                "times": lost,
            }
            blocks.append(block)
    return blocks


def axis_of(series):
    """Return the axis of a series, time before load; None where it has none."""
    return next((axis for axis in AXES if axis in series.axes), None)


def paired_frames(first, second, axis, options):
    """Return the pairs of frames to compare, and how many times have no counterpart: (A's, B's).

    Without a common axis the one frame of one side meets A's chosen, or last, frame.
    """
    if axis is None:
        side = first if first.axes else second
        name = options.axis or axis_of(side)
        chosen = [len(side.frames) - 1]
        if name and options.at:
            chosen = [k for k, _ in match.same_times(side.axes[name], options.at)]
        return [(k, 0) if side is first else (0, k) for k in chosen], (0, 0)
    here, there = first.axes[axis], second.axes[axis]
    pairs = match.same_times(here, there)
    if not options.at:
        return pairs, (len(there) - len(pairs), len(here) - len(pairs))
    known = {k for k, _ in match.same_times(here, options.at)}
    kept = [(i, j) for i, j in pairs if i in known]
    return kept, (0, len(options.at) - len(kept))


def selected(frame, contact):
    """Return the rows of one contact, where one was chosen and the frame names contacts."""
    if contact is None or "contact" not in frame:
        return frame
    rows = frame["contact"] == contact
    if not rows.any():
        names = list(np.unique(frame["contact"]))
        hint = nearest_name(contact, names)
        raise UserError(f"A has no contact '{contact}'{hint} (contacts: {listed(names)})")
    return {name: values[rows] for name, values in frame.items()}


def rows_of(way, a, b, options, last):
    """Return (rows, frames) for two frames; those of `last` where keys and places are the same."""
    if last and all(same_rows(old, new) for old, new in zip(last[1], (a, b))):
        return last[0], (a, b)
    if way == "key":
        rows = match.by_key(a, b)
    elif way == "coordinate":
        rows = match.by_coordinate(a, b, options.within)
    else:
        along = options.along or abscissa(a, b)
        if along not in a or along not in b:
            raise UserError(f"--along {along}: one of the files has no {along}")
        rows = match.along_curve(a, b, along)
    return rows, (a, b)


def abscissa(a, b):
    """Return the abscissa of curves: x where both have it and A has it once a contact, else s."""
    if "x" not in a or "x" not in b:
        return "s"
    contacts = a["contact"] if "contact" in a else np.zeros(len(a["x"]), dtype=int)
    rows = set(zip(contacts.tolist(), np.ma.getdata(a["x"]).tolist()))
    return "s" if "s" in a and "s" in b and len(rows) < len(a["x"]) else "x"


def same_rows(old, new):
    """Whether two frames have the same rows, told by their keys, places and padding."""
    names = [name for name in (*KEYS, *COORDINATES, "padding") if name in old or name in new]
    return all(n in old and n in new and np.array_equal(old[n], new[n]) for n in names)


def make_block(name, other, rows, a, b, columns, states):
    """Return the block of a quantity, with B's values on the rows of A."""
    state = name in states
    values, theirs = np.ma.asanyarray(a[name]), np.ma.asanyarray(b[other])
    first, left_out = rows.first, 0
    if rows.second is None:
        met = [along(theirs, curve, state) for curve in rows.curves]
        there = np.ma.concatenate(met) if met else theirs[:0]
    else:
        first, second, left_out = united(rows, a, b, values, theirs)
        first, second = single(name, first, second, a, theirs)
        there = theirs[second]
    padding = np.asarray(b.get("padding", np.zeros(len(theirs), dtype=bool)))
    curve = None
    if len(rows.curves) == 1:
        _, nodes, k = rows.curves[0]
        curve = (nodes, np.ma.filled(theirs[k].astype(float), np.nan))
    block = Block(
        name,
        "",
        None,
        None,
        picked(columns, first),
        values[first],
        there,
        int((~padding[rows.not_in_a]).sum()),
        len(rows.not_in_b),
        rows.ambiguous + left_out,
        state=state,
        curve=curve,
    )
    block.rows_met = len(first)
    return block


def picked(columns, rows):
    """Return rows of columns; the columns themselves, not copies, where these are all rows."""
    count = len(next(iter(columns.values()), rows))
    if np.array_equal(rows, np.arange(count)):
        return columns
    return {key: column[rows] for key, column in columns.items()}


def along(values, curve, state):
    """Return the values of B's curve at A's abscissae; a state is that of the nearest row."""
    at, nodes, rows = curve
    there = ~np.ma.getmaskarray(values[rows])
    nodes, heights = nodes[there], np.ma.getdata(values[rows])[there].astype(float)
    if len(nodes) == 0:
        return np.ma.masked_all(len(at))
    if state:
        return np.ma.array(heights[np.abs(nodes[None, :] - at[:, None]).argmin(axis=1)])
    return np.ma.array(np.interp(at, nodes, heights))


def united(rows, a, b, values, theirs):
    """Return rows of A and B, and how many are left out.

    Where a file has several points of a node and the other one has not as many, these are one if
    their values are the same; else it is open which of them is meant.
    """
    first, second, left_out = rows.first, rows.second, 0
    if "copy" in a:
        starts, differs = groups(second, values[first])
        left_out += int((starts & differs).sum())
        first, second = first[starts & ~differs], second[starts & ~differs]
    if "copy" in b:
        starts, differs = groups(first, theirs[second])
        left_out += int((starts & differs).sum())
        first, second = first[starts & ~differs], second[starts & ~differs]
    return first, second, left_out


def groups(keys, values):
    """Return which rows are the first of their key, and which have a key with several values."""
    _, starts, group = np.unique(keys, return_index=True, return_inverse=True)
    data = np.ma.filled(values.astype(float), np.nan)
    reference = data[starts][group]
    other = ~((data == reference) | (np.isnan(data) & np.isnan(reference)))
    is_first = np.zeros(len(keys), dtype=bool)
    is_first[starts] = True
    return is_first, np.bincount(group, other, len(starts))[group] > 0


def single(name, first, second, a, values):
    """Return rows of A and B once each; equal keys are an error unless B repeats the value."""
    if len(np.unique(second)) < len(second):
        k = int(np.flatnonzero(np.bincount(second)[second] > 1)[0])
        raise UserError(
            f"{name}: {match.row_words(a, first[k])} and another row of A have the same row of B: "
            "choose one contact with --contact"
        )
    starts, differs = groups(first, values[second])
    if differs.any():
        row = first[differs][0]
        found = np.ma.filled(values[second][first == row].astype(float), np.nan)
        other = found[found != found[0]][0]
        raise UserError(
            f"{name}: B has {match.row_words(a, row)} twice with other values, {found[0]:g} and "
            f"{other:g}"
        )
    return first[starts], second[starts]


def listed(names):
    """Return names in words."""
    return ", ".join(names) or "none"
