"""The numbers that the page draws: arrays are base64 of little-endian numbers."""

import base64

import numpy as np

from .. import mesh
from ..courses import HEAT
from ..field_colours import SIGNED
from ..fields import TITLES, touches_after_a_gap
from ..result import CELL_FIELDS, FIELD_SOURCES, words_of
from ..style import matplotlib

FIELD_NUMBERS = 700_000  # numbers of all fields together: 3.7 MB of text
PROFILES = ("pressure", "shear", "heat_flux", "gap", "slip", "conductance")
COLOURS = ("viridis", "inferno", "RdBu_r")
SHADES = 64


def page_data(result):
    """Return all that the script of the page needs."""
    return {
        "load": loads(result),
        "units": {key: plain(unit) for key, unit in result.units.names.items()},
        "contacts": [contact_data(result, contact) for contact in contacts_of(result)],
        "history": histories(result),
        "fields": fields_data(result),
        "colours": {name: shades(name) for name in COLOURS},
    }


def contacts_of(result):
    """Return all contacts, of which there may be none."""
    return result.contacts() if result.contact_names else []


def plain(words):
    """Return words of an axis without the marks of formulas."""
    return words.replace("$^2$", "\N{SUPERSCRIPT TWO}").replace("$", "")


def packed(values, kind="<f4"):
    """Return an array as base64."""
    with np.errstate(over="ignore"):
        return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()


def shades(name):
    """Return the shades of a colour map as one text of hexadecimal digits."""
    colours = matplotlib.colormaps[name](np.linspace(0.0, 1.0, SHADES))[:, :3]
    return (255.0 * colours + 0.5).astype(np.uint8).tobytes().hex()


def loads(result):
    """Return load and time of every increment, and the axis that pictures over the load have."""
    load = result.history["load"]
    rises = bool(np.all(np.diff(load) > 0.0) or np.all(np.diff(load) < 0.0))
    return {
        "label": result.load_label,
        "unit": plain(result.units.load_unit()),
        "values": load.tolist(),
        "times": result.history["time"].tolist(),
        # A load that turns would draw loading and unloading over each other.
        "axis": plain(result.units.load_label(result.load_label)) if rises else "Time",
        "rises": rises,
    }


def contact_data(result, contact):
    """Return the profiles, states, edges and totals of one contact."""
    name, coordinate = contact.axis(None)
    window, unit = contact.window(coordinate), plain(result.units.names.get("length", ""))
    return {
        "name": contact.name,
        "axis": name,
        "at": packed(coordinate),
        "window": window,
        "part": contact.part_words(coordinate, window, unit),
        "friction": contact.friction,
        "status": packed(contact["status"], "u1"),
        "profiles": {
            key: packed(contact[key]) for key in PROFILES if contact.get(key) is not None
        },
        "edges": {
            key: packed(contact.edge_on_axis(contact[f"edges_{key}"], coordinate))
            for key in ("contact", "stick")
        },
        "main": {
            key: packed(contact.edge_on_axis(contact[f"edge_{key}"], coordinate))
            for key in ("contact", "stick")
        },
        "totals": totals(contact),
    }


def totals(contact):
    """Return the quantities of a contact over the increments; its edges are drawn elsewhere."""
    return [{"label": words_of(key), "unit": contact.unit(key), "values": listed(values)}
            for key, values in contact.totals().items() if not key.startswith("edge_")]


def listed(values):
    """Return values as a list, None where there is none."""
    return [float(v) if np.isfinite(v) else None for v in np.asarray(values, dtype=float)]


def histories(result):
    """Return what there is of every increment: totals of the contacts, then of the whole run."""
    found, contacts = [], contacts_of(result)
    for contact in contacts:
        of = f" of {contact.name}" if len(contacts) > 1 else ""
        for each in totals(contact):
            if any(each["values"]):
                found.append(each | {"label": each["label"].capitalize() + of})
    for key, values in result.history.items():
        if key in ("time", "load") or values.ndim > 1 or not np.nan_to_num(values).any():
            continue
        unit = plain(result.units.names.get("power", "")) if key in HEAT else ""
        found.append({"label": words_of(key).capitalize(), "unit": unit, "values": listed(values)})
    return found


def fields_data(result):
    """Return mesh and fields at the increments that the page keeps; None without fields."""
    times = result.field_times
    if len(times) == 0:
        return None
    there = {q: result.field(q, len(times) - 1) for q in FIELD_SOURCES}
    there = [q for q, values in there.items() if values is not None]
    if not there:
        return None
    cells = result.cells
    points, each = cells.points, len(there) * max(len(cells.points), cells.count)
    keep = kept_steps(len(times), each + 2 * len(points))
    moved = [result.point_data("displacement", step) for step in keep]
    edges, _ = cells.edges() if cells.count <= 600 else (np.empty((0, 3)), None)
    near = mesh.contact_window(contacts_of(result), cells, points) if result.contact_names else None
    rows = [int(np.argmin(np.abs(result.history["time"] - times[step]))) for step in keep]
    return {
        "rows": rows,
        "all": len(times) == len(keep),
        "points": packed(points),
        "node_id": packed(cells.node_id, "<i4"),
        "cells": [
            {
                "kind": kind,
                "nodes": group.shape[1],
                "connectivity": packed(group, "<i4"),
                "body": packed(cells.bodies[kind], "<i4"),
                "member": packed(cells.members[kind], "<i4"),
                "element": packed(cells.element_ids[kind], "<i4"),
            }
            for kind, group in cells.groups.items()
        ],
        "edges": packed(edges, "<i4"),
        "boundary": packed(cells.boundary(), "<i4"),
        "overlaps": touches_after_a_gap(result),
        "near": None if near is None else near.tolist(),
        "displacement": None if moved[0] is None else packed([u[:, :2] for u in moved]),
        "quantities": [quantity_data(result, q, keep) for q in there],
    }


def kept_steps(count, numbers):
    """Return the steps of `count` whose fields the page has room for, the last among them."""
    most = max(1, min(count, FIELD_NUMBERS // numbers))
    return sorted({count - 1 - round(k * (count - 1) / max(most - 1, 1)) for k in range(most)})


def quantity_data(result, quantity, steps):
    """Return one field at the steps that the page keeps."""
    words, unit = TITLES[quantity]
    return {
        "key": quantity,
        "label": in_words(words),
        "unit": plain(result.units.names.get(unit, "")),
        "of": "elements" if quantity in CELL_FIELDS else "points",
        "signed": quantity in SIGNED,
        "values": packed([result.field(quantity, step) for step in steps]),
    }


def in_words(title):
    """Return the title of a panel without formulas: $q_x$ as qx, Greek letters as such."""
    for tex, word in ((r"\sigma", "\N{GREEK SMALL LETTER SIGMA}"), (r"\theta", "θ"),
                      (r"\mathrm{M}", "M")):
        title = title.replace(tex, word)
    return "".join(c for c in title if c not in "$_{}")
