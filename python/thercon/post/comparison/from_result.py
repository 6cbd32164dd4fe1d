"""The series of a result file of thercon."""

from functools import partial

import numpy as np

from ..result import OPEN, Result
from . import match
from .series import Series, Source

# Names of *VERIFY -> point data of /VTKHDF and component.
FIELDS = {
    "U1": ("displacement", 0),
    "U2": ("displacement", 1),
    "NT": ("temperature", None),
    "S11": ("stress", 0),
    "S22": ("stress", 1),
    "S33": ("stress", 2),
    "S12": ("stress", 3),
    "MISES": ("von_mises", None),
    "HFL1": ("heat_flux", 0),
    "HFL2": ("heat_flux", 1),
}


def read(path, stack):
    """Return the source of a result file, kept open as long as `stack`."""
    result = stack.enter_context(Result(path))
    result.rows()  # without an increment there is nothing to compare
    source = Source(str(path), "result", [history(result)])
    source.units, source.load_label = result.units, result.load_label
    if result.contact_names:
        source.series.append(pairs(result))
    if "Steps" in result.file["VTKHDF"]:
        source.series.append(nodes(result))
    return source


def history(result):
    """Return /history with the sums and edges of the contacts, `name@contact` where several; what
    has a value for each body is `name@body` with its number."""
    columns = {}
    for key, values in result.history.items():
        if values.ndim == 1:
            columns[key] = values
        else:
            columns |= {f"{key}@body{k + 1}": values[:, k] for k in range(values.shape[1])}
    for contact in result.contacts() if result.contact_names else []:
        where = f"@{contact.name}" if len(result.contact_names) > 1 else ""
        columns |= {key + where: values for key, values in contact.totals().items()
                    if key in contact.data}
    names = [name for name in columns if name not in ("time", "load")]
    return Series(names, [columns], history=True)


def pairs(result):
    """Return the states of all pairs, one frame an increment."""
    contacts = result.contacts()
    states = [key for key, each in contacts[0].data.items() if is_state(each, contacts[0], result)]
    states = [key for key in states if all(key in contact.data for contact in contacts)]
    frames = [partial(pair_frame, result, contacts, states, row) for row in range(result.increments)]
    axes = {axis: result.history[axis] for axis in ("time", "load")}
    return Series([*states, "closed"], frames, axes)


def is_state(values, contact, result):
    """Whether a dataset of a contact holds one value a pair and increment."""
    return values.shape == (result.increments, len(contact["x"]))


def pair_frame(result, contacts, states, row):
    """Return the columns of all pairs at one increment; the node is the slave's, which may lie
    beside the contact point: beyond the end of the master."""
    frame = {
        "contact": np.concatenate([np.full(len(each["x"]), each.name) for each in contacts]),
        "node": np.concatenate([each["slave_node"] for each in contacts]),
    }
    for key in ("x", "y", "s"):
        frame[key] = np.concatenate([each[key] for each in contacts])
    order = np.argsort(result.cells.node_id, kind="stable")
    rows = order[np.searchsorted(result.cells.node_id, frame["node"], sorter=order) % len(order)]
    frame["node_x"], frame["node_y"] = result.cells.points[rows].T
    for key in states:
        frame[key] = np.concatenate([each[key][row] for each in contacts])
    frame["closed"] = (frame["status"] != OPEN).astype(int)
    return frame


def nodes(result):
    """Return the fields of the nodes, one frame a time step of /VTKHDF."""
    times = result.field_times
    present = result.file["VTKHDF/PointData"]
    names = [name for name, (array, _) in FIELDS.items() if array in present]
    load = np.interp(times, result.history["time"], result.history["load"])
    frames = [partial(node_frame, result, names, step) for step in range(len(times))]
    return Series(names, frames, {"time": times, "load": load})


def node_frame(result, names, step):
    """Return the columns of the nodes of elements at one time step; a node of several bodies or
    sections is a point for each of them, numbered by `copy`."""
    used = result.cells.used
    x, y = result.cells.points[used].T
    frame = {"node": result.cells.node_id[used], "x": x, "y": y}
    frame["copy"] = match.numbered(frame["node"])
    arrays = {FIELDS[name][0] for name in names}
    arrays = {array: result.point_data(array, step)[used] for array in arrays}
    for name in names:
        array, component = FIELDS[name]
        frame[name] = arrays[array] if component is None else arrays[array][:, component]
    return frame
