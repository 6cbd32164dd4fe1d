"""Histories of sets: what *NODE PRINT and *EL PRINT keep in the result file, /history/nodes and
/history/elements; and those of pre-tension sections and reference nodes, which are in /history."""

import re
from dataclasses import dataclass

import h5py
import numpy as np

from .checked_file import need, numbers
from .errors import UserError, nearest_name
from .result import NOISE, text, words_of
from .units import unit_of

KINDS = {"nodes": "node", "elements": "element"}
OF_ROWS = ("increment", "time")
OF_MEMBERS = (*KINDS.values(), "point")
RUN_SETS = {"pre-tension": ("section", ("pre_tension",)),
           "reference nodes": ("reference node", ("U3", "UR1", "UR2", "RF3", "RM1", "RM2"))}


@dataclass
class SetHistory:
    """One set: a row for each increment at which it was printed."""

    kind: str  # nodes, elements or, of all increments, run
    name: str
    increment: np.ndarray  # (rows), from 1
    time: np.ndarray  # (rows)
    members: list  # numbers of the nodes, as text; of points "element.point"; of a run in words
    values: dict  # quantity -> (rows, members), of a total (rows)
    units: dict  # quantity -> unit; empty where the deck names none

    @property
    def member_word(self):
        """What one of the members is."""
        return {"nodes": "node ", "elements": "point ", "run": ""}[self.kind]

    def told(self):
        """Return the quantities that differ from zero, by more than rounding beside others of their
        unit; all where none does."""
        sizes = {key: np.nanmax(np.abs(values), initial=0.0) for key, values in self.values.items()}
        largest = {}
        for key, size in sizes.items():
            largest[self.units[key]] = max(size, largest.get(self.units[key], 0.0))
        return [key for key, size in sizes.items()
                if size > NOISE * largest[self.units[key]]] or list(sizes)

    def curves(self, quantity):
        """Return [(words, values)] of a quantity: one for each member, or that of a total."""
        values = self.values[quantity]
        if values.ndim == 1:
            return [("", values)]
        return [(f"{self.member_word}{member}", values[:, k])
                for k, member in enumerate(self.members)]


def set_histories(result):
    """Return the histories of all sets of a result, those of nodes first."""
    found = []
    for kind, word in KINDS.items():
        groups = result.file.get(f"history/{kind}", {})
        need(result.file["history"], not isinstance(groups, h5py.Dataset), f"{kind} is no group")
        for name in groups:
            need(result.file["history"], isinstance(groups[name], h5py.Group),
                 f"{kind}/{name} is no group")
            found.append(read_set(groups[name], kind, word, text(name)))
    return found + [run_set(result, name) for name, (_, keys) in RUN_SETS.items()
                    if any(key in result.history for key in keys)]


def run_set(result, name):
    """Return the history of pre-tension sections or reference nodes, which have the names that sections
    of the deck give, or numbers in its order."""
    word, keys = RUN_SETS[name]
    values = {key: result.history[key] for key in keys if key in result.history}
    columns = max(found.shape[1:] for found in values.values())
    units = {key: unit_of(text(result.file["history"][key].attrs.get("unit", ""))) for key in values}
    members = [f"{word} {k + 1}" for k in range(*columns or (1,))]
    nodes = [re.search(r"\bREF *NODE *= *([^,<>]+?) *(?:,|$)", card, re.IGNORECASE) for card in result.deck
             if card.startswith("*")]
    nodes = list(dict.fromkeys(found[1] for found in nodes if found))
    if word == "reference node" and len(nodes) == len(members):
        members = [f"{word} {node}" for node in nodes]
    return SetHistory("run", name, np.arange(1, result.increments + 1), result.history["time"],
                      members, values, units)


def read_set(group, kind, word, name):
    """Return the history of one set."""
    rows = len(numbers(group, "time", like=(None,), finite=True))
    labels = member_labels(group, word)
    values, units = {}, {}
    for key in group:
        if key in (*OF_ROWS, *OF_MEMBERS):
            continue
        values[key] = numbers(group, key)
        fits = values[key].shape in ((rows,), (rows, len(labels)))
        need(group, fits, f"{key} has not one row for each increment")
        units[key] = unit_of(text(group[key].attrs.get("unit", "")))
    increment, time = (numbers(group, key, like=(rows,)) for key in OF_ROWS)
    need(group, np.all(increment > 0), "increment has values that are no counts from 1")
    return SetHistory(kind, name, increment, time, labels, values, units)


def member_labels(group, word):
    """Return the numbers of the members of a set as text: of nodes, of points "element.point"."""
    labels = [f"{n}" for n in numbers(group, word, like=(None,))]
    if word == KINDS["elements"]:
        labels = [f"{label}.{p}" for label, p in zip(
            labels, numbers(group, "point", like=(len(labels),)))]
    return labels


def chosen(result, wanted):
    """Return the sets that names mean in any case, all without one."""
    found = [each for each in set_histories(result) if len(each.time) and each.values]
    if not found:
        raise UserError(f"{result.path}: holds no histories: *NODE PRINT and *EL PRINT of the deck "
                        "say of which sets it keeps them")
    names = list(dict.fromkeys(each.name for each in found))
    for name in wanted or ():
        if name.lower() not in [each.lower() for each in names]:
            raise UserError(f"{result.path}: has no history of a set '{name}'"
                            f"{nearest_name(name, names)}: there are {', '.join(names)}")
    meant = [name.lower() for name in wanted or names]
    return [each for each in found if each.name.lower() in meant]


def label(quantity):
    """Return a quantity in words."""
    words = words_of(quantity).replace("external force", "reaction or load")
    return words[:1].upper() + words[1:]
