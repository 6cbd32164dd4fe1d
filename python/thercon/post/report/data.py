"""The numbers that the page draws: arrays are base64 of little-endian numbers."""

import base64

import numpy as np

from .. import branch, mesh
from ..edge_curves import edge_curves, zeros_of
from ..field_colours import PRINCIPAL, SIGNED
from ..cells import CORNERS
from ..fields import USUAL, apart_words, title_of, touches_after_a_gap
from ..rigid_surfaces import motion_of, surfaces
from ..result import CELL_FIELDS, FIELD_SOURCES, NOISE, UNJUDGED, text, words_of
from ..style import matplotlib
from ..units import unit_of
from .sets import of_sets

FIELD_NUMBERS = 1_400_000  # numbers of all fields together: at most 3.7 MB of text
FINE = 20_000  # elements: nodes on sides cannot be seen
DERIVED = (*PRINCIPAL, "radial", "hoop")  # left out of the pages of fine meshes
LEAST = {"gain": 1e-6, "imbalance": NOISE}  # gains are accurate to this, imbalances relative
KINDS = ("imbalance", "heat", "gain", "worn", "ALL")  # in names, of what is compared
IN_ORDER = ("normal_force", "shear_force", "heat_rate", "peak_pressure", "edge_contact", "edge_stick")
PROFILES = ("pressure", "shear", "heat_flux", "gap", "wear_slave", "wear_master")
OF_HEAT = ("slave_temperature", "master_temperature", "heat_flux", "gap")  # of runs of heat alone
COLOURS = ("viridis", "inferno", "RdBu_r")
SHADES = 64
LINEAR = {22: 5, 23: 9}  # VTK cell type without its midside nodes


def page_data(result):
    """Return all that the script of the page needs."""
    return {
        "load": loads(result),
        "units": {key: plain(unit) for key, unit in result.units.names.items()},
        "contacts": [contact_data(result, contact) for contact in contacts_of(result)],
        "history": [*histories(result), *of_sets(result, listed)],
        "branch": branch_data(result),
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


def counted(numbers):
    """Return whole numbers as base64 of their differences, which are small."""
    return packed(np.diff(np.ravel(numbers), prepend=0), "<i4")


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
        "factors": listed(result.load_factors),
        "judged": result.judged.tolist(),
        "unjudged": UNJUDGED,
        # A load that turns would draw loading and unloading over each other.
        "axis": plain(result.units.load_label(result.load_label) if rises
                      else result.units.label("Time", "time")),
        "rises": rises,
    }


def contact_data(result, contact):
    """Return the profiles, states, edges and totals of one contact."""
    name, coordinate = contact.axis(None)
    unit = plain(result.units.names.get("length", ""))
    windows = [contact.window(coordinate, of_loads=loads) for loads in (False, True)]
    return {
        "name": contact.name,
        "axis": f"{name} of the slave as drawn" if contact.slides else name,
        "at": packed(coordinate),
        "pieces": [[piece.start, piece.stop - 1] for piece in contact.pieces],
        "windows": dict(zip(("zones", "profiles"), windows)),
        "parts": {
            key: contact.part_words(coordinate, window, unit)
            for key, window in zip(("zones", "profiles"), windows)
        },
        "friction": contact.friction,
        "status": packed(contact["status"], "u1"),
        "profiles": {key: packed(contact[key]) for key in (OF_HEAT if result.is_of_heat else PROFILES)
                     if is_told(result, contact, key, coordinate, windows[1])},
        "edges": {
            key: packed(contact.edge_on_axis(contact[f"edges_{key}"], coordinate))
            for key in ("contact", "stick")
        },
        "zeros": counted(zeros(contact)),
        "curves": {
            key: [packed(values) for values in joined(contact, key, coordinate)]
            for key in ("contact", "stick")
        },
        "main": {
            key: packed(contact.edge_on_axis(contact[f"edge_{key}"], coordinate))
            for key in ("contact", "stick")
        },
        "totals": [*totals(result, contact), *friction_heat(result)],
    }


def joined(contact, key, coordinate):
    """Return increments, from 0, and places of the curves of an edge, with NaN between curves."""
    curves = [np.append(curve, [[np.nan], [np.nan]], axis=1) for curve in edge_curves(contact, key)]
    rows, places = np.hstack([np.zeros((2, 0)), *curves])
    return rows, contact.edge_on_axis(places, coordinate)


def zeros(contact):
    """Return the contact points before which tractions fall to zero at the edges of contact of each
    increment; -1 where they do not."""
    found = np.full(contact["edges_contact"].shape, -1)
    pieces = contact.pieces
    for row, edges in enumerate(contact["edges_contact"]):
        for piece in pieces:
            own, before = zeros_of(contact, row, piece)
            found[row, np.isin(edges, own)] = piece.start + before
    return found


def is_told(result, contact, key, coordinate, window):
    """Whether a contact has, in the window, a profile that is more than rounding."""
    if contact.get(key) is None:
        return False
    shown = (coordinate >= window[0]) & (coordinate <= window[1])
    size = {"shear": largest(contact["pressure"]), "gap": np.ptp(result.cells.points[result.cells.used]),
            "heat_flux": largest(hottest(contact) * contact.data.get("conductance", 0.0))}
    return key == "pressure" or largest(contact[key][:, shown]) > NOISE * size.get(key, 0.0)


def largest(values):
    """Return the largest magnitude."""
    return float(np.nanmax(np.abs(values), initial=0.0))


def hottest(contact):
    """Return the largest magnitude of temperature of a face; zero where there is no heat."""
    return largest(contact.data.get("slave_temperature", 0.0))


def told_totals(contact):
    """Return the quantities of a contact in the order of the summary, without volumes where nothing is
    worn."""
    found = {key: values for key, values in contact.totals().items()
             if not key.startswith("worn_volume") or largest(values)}
    return {key: found[key] for key in sorted(found, key=lambda key: (*IN_ORDER, key).index(key))}


def friction_heat(result):
    """Return the heat of friction of the model over the increments, as a total, where there is some."""
    values = result.history.get("heat_friction", np.zeros(1))
    if not largest(values):
        return []
    known, of_all = result.uncertainties("increment"), " in all" * (len(result.contact_names) > 1)
    return [{"key": "heat_friction", "label": words_of("heat_friction") + of_all,
             "unit": plain(result.units.names.get("power", "")), "values": listed(values),
             "uncertainty": uncertainty(known, "heat_friction")}]


def totals(result, contact):
    """Return the quantities of a contact over the increments; its edges are drawn elsewhere."""
    known = result.uncertainties(contact.name)
    return [{"key": key, "label": words_of(key), "unit": contact.unit(key),
             "values": listed(values), "uncertainty": uncertainty(known, key)}
            for key, values in told_totals(contact).items() if not key.startswith("edge_")]


def uncertainty(known, key):
    """Return the uncertainties of a quantity over the increments, of which there may be none."""
    return listed(known[key][2][:, 1]) if key in known else []


def listed(values):
    """Return values as a list, None where there is none."""
    return [float(v) if np.isfinite(v) else None for v in np.asarray(values, dtype=float)]


def histories(result):
    """Return what there is of every increment: totals of the contacts, then of the whole run, without
    what is rounding beside others of its kind. Balances are checked by the run."""
    found, contacts, peaks = [], contacts_of(result), {}
    known = result.uncertainties("increment")
    for contact in contacts:
        of = f" of {contact.name}" if len(contacts) > 1 else ""
        crossing = contact.data.get("conductance", 0.0) * contact["weight"]
        peaks["heat"] = max(peaks.get("heat", 0.0), hottest(contact) * largest(crossing))
        found += [each | {"label": capital(each["label"]) + of}
                  for each in totals(result, contact)]
    for key, values in result.history.items():
        if key not in ("time", "load") and values.ndim == 1 and not key.endswith("_imbalance"):
            unit = unit_of(text(result.file["history"][key].attrs.get("unit", "")))
            found.append({"key": key, "label": capital(words_of(key)), "unit": unit,
                          "values": listed(values), "uncertainty": uncertainty(known, key)})
    kinds = [next((kind for kind in KINDS if kind in each["key"]),
                  each["key"].split("_")[-1]) for each in found]
    sizes = [largest([v or 0.0 for v in each["values"]]) for each in found]
    for kind, size in zip(kinds, sizes):
        peaks[kind] = max(peaks.get(kind, 0.0), size)
    return [each for each, kind, size in zip(found, kinds, sizes)
            if size > max(NOISE * peaks[kind], LEAST.get(kind, 0.0))]


def capital(words):
    """Return words with a capital first letter, and names such as ALLSE as they are."""
    return words[:1].upper() + words[1:]


def branch_data(result):
    """Return load factors and which points are unstable; None without a branch."""
    found = branch.of_branch(result)
    if found is None or len(found[0]) < result.increments:
        return None
    _, factor, unstable = found
    return {"factor": factor.tolist(), "unstable": [bool(u) for u in unstable],
            "labels": branch.labels(result)}


def fields_data(result):
    """Return mesh and fields at the increments that the page keeps; None without fields. Fine meshes
    have corners only, and no derived stresses."""
    times, cells = result.field_times, result.cells
    is_fine = cells.count > FINE
    there = [q for q in FIELD_SOURCES if len(times) and not (is_fine and q in DERIVED)
             and result.field(q, len(times) - 1) is not None]
    if not there:
        return None
    groups = {kind: group[:, : CORNERS[kind] if is_fine else None] for kind, group in cells.groups.items()}
    used = np.isin(np.arange(len(cells.points)), np.concatenate([g.ravel() for g in groups.values()]))
    place = np.append(np.cumsum(used) - 1, -1)  # of midside -1, too
    place[:-1][~used] = -1
    each = sum(cells.count if q in CELL_FIELDS else used.sum() for q in there)
    keep = kept_steps(len(times), each + 2 * used.sum())
    edges, _ = cells.edges() if cells.count <= 600 else (np.empty((0, 3), int), None)
    near = None
    if result.contact_names:
        near = mesh.contact_window(contacts_of(result), cells, cells.points).tolist()
    moved = [result.point_data("displacement", step) for step in keep]
    usual = USUAL[result.is_axisymmetric][not result.is_of_heat]
    return {
        "rows": [int(np.argmin(np.abs(result.history["time"] - times[step]))) for step in keep],
        "points": packed(cells.points[used]),
        "node_id": counted(cells.node_id[used]),
        "cells": [
            {
                "kind": LINEAR.get(kind, kind) if is_fine else kind,
                "nodes": group.shape[1],
                "connectivity": counted(place[group]),
                "body": counted(cells.bodies[kind]),
                "member": counted(cells.members[kind]),
                "element": counted(cells.element_ids[kind]),
            }
            for kind, group in groups.items()
        ],
        "edges": counted(place[edges]),
        "boundary": counted(place[cells.boundary()]),
        "overlaps": touches_after_a_gap(result),
        "apart": apart_words(result) if result.given_gaps else "",
        "near": near,
        "rigid": [rigid_data(result, *each, keep) for each in surfaces(result)],
        "displacement": None if moved[0] is None else whole_numbers([u[used, :2] for u in moved]),
        "first": there.index(usual) if usual in there else 0,
        "quantities": [quantity_data(result, q, keep, used) for q in there],
    }


def rigid_data(result, points, group, steps):
    """Return a drawing of a rigid body, and what it follows at the steps that the page keeps."""
    centre, _, _ = motion_of(result, group, None)
    motion = [[*displacement, rotation] for _, displacement, rotation in
              (motion_of(result, group, step) for step in steps)]
    return {"points": packed(points), "centre": centre.tolist(), "motion": packed(motion)}


def kept_steps(count, numbers):
    """Return the steps of `count` whose fields the page has room for, the last among them."""
    most = max(1, min(count, FIELD_NUMBERS // numbers))
    return sorted({count - 1 - round(k * (count - 1) / max(most - 1, 1)) for k in range(most)})


def quantity_data(result, quantity, steps, used):
    """Return one field at the steps that the page keeps; `used` are the points that it has."""
    words, unit = title_of(result, quantity)
    is_of_elements = quantity in CELL_FIELDS
    values = [result.field(quantity, step) for step in steps]
    return {
        "key": quantity,
        "label": in_words(words),
        "unit": plain(result.units.names.get(unit, "")),
        "of": "elements" if is_of_elements else "points",
        "signed": quantity in SIGNED,
        "values": whole_numbers(values if is_of_elements else [each[used] for each in values]),
    }


def whole_numbers(steps):
    """Return values at each step as whole numbers from 0 for the smallest to 65534 for the largest
    of that step, 65535 for NaN."""
    low = [float(np.nan_to_num(np.min(each, initial=np.inf, where=np.isfinite(each)), posinf=0.0))
           for each in steps]
    high = [max(a, float(np.max(each, initial=a, where=np.isfinite(each)))) for a, each in zip(low, steps)]
    parts = [np.where(np.isfinite(each), np.rint(65534.0 * (each - a) / ((b - a) or 1.0)), 65535)
             for each, a, b in zip(steps, low, high)]
    return {"low": low, "high": high, "parts": packed(parts, "<u2")}


def in_words(title):
    """Return the title of a panel without formulas: $q_x$ as qx, Greek letters as such."""
    for tex, word in ((r"\sigma", "\N{GREEK SMALL LETTER SIGMA}"), (r"\theta", "θ"),
                      (r"\varepsilon", "ε"), (r"\mathrm", "")):
        title = title.replace(tex, word)
    return "".join(c for c in title if c not in "$_{}")
