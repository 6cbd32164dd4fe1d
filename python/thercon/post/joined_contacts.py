"""Several interfaces as one, its pieces those of all, in the order of their places along x or y."""

import numpy as np

APART = 1e-6  # least distance of pieces along s, in parts of the whole: each edge belongs to one


def join(contacts):
    """Return the datasets of interfaces as those of one, and the points of each by its name, in order.
    Sums over the interfaces are its totals; the edge of stick, of the widest zone, is none of all
    interfaces."""
    places = [np.array([np.mean(contact["x"]), np.mean(contact["y"])]) for contact in contacts]
    axis = int(np.argmax(np.ptp(places, axis=0)))
    contacts = [contacts[k] for k in np.argsort([place[axis] for place in places], kind="stable")]
    starts, first_pieces, end, pieces, parts, points = [], [], 0.0, 0.0, {}, 0
    length = sum(np.ptp(contact["s"]) for contact in contacts)
    for k, contact in enumerate(contacts):
        if k:
            step = [contact[c][0] - contacts[k - 1][c][-1] for c in "xy"]
            end += max(float(np.hypot(*step)), APART * length)
        starts.append(end - contact["s"][0])
        first_pieces.append(pieces)
        end += np.ptp(contact["s"])
        pieces += contact["piece"][-1]
        parts[contact.name] = slice(points, points + len(contact["s"]))
        points = parts[contact.name].stop

    def moved(key, by):
        return [contact[key] + first for contact, first in zip(contacts, by)]

    increments = len(contacts[0]["status"])
    shared = [key for key in contacts[0].data if all(key in contact.data for contact in contacts)]
    data = {key: np.concatenate([contact[key] for contact in contacts], axis=-1) for key in shared
            if not contacts[0].is_total(key)}
    data |= {key: np.sum([contact[key] for contact in contacts], axis=0) for key in shared
             if key not in data}
    data["s"] = np.concatenate(moved("s", starts))
    data["piece"] = np.concatenate(moved("piece", first_pieces))
    for key in ("edges_contact", "edges_stick"):
        data[key] = np.sort(np.concatenate(moved(key, starts), axis=1), axis=1)
    data["edge_contact"] = np.fmax.reduce(moved("edge_contact", starts))
    data["edge_stick"] = np.full(increments, np.nan)
    return data, parts


def common(values):
    """Return the value that all have; None where they differ."""
    return values[0] if all(value == values[0] for value in values) else None
