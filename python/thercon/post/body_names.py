"""What bodies are, in words: the sets of their sections and the materials, as far as the deck tells."""

import re

import numpy as np

from .checked_file import numbers

CARD = r"^\*\s*(?:{})\b((?:.*,\s*\n)*.*)"


def body_names(result):
    """Return words behind the number of each body, such as " (PAD, of LINING)"; with a node of it where
    others have the same words, and none for files and decks that do not tell."""
    group, cells = result.file["VTKHDF"], result.cells
    if "CellData/material" not in group:
        return {}
    body, element, material, first_node = (np.zeros(cells.count, int) for _ in range(4))
    material[:] = numbers(group, "CellData/material")[: cells.count]
    for kind, places in cells.members.items():
        body[places], element[places] = cells.bodies[kind], cells.element_ids[kind]
        first_node[places] = cells.node_id[cells.groups[kind]].min(axis=1)
    sections, names = sections_of(result.deck), {}
    materials = [parameter(card, "NAME") for card in cards_of("MATERIAL", result.deck)]
    for number in np.unique(body):
        own = body == number
        known = [materials[m - 1] for m in np.unique(material[own]) if 0 < m <= len(materials)]
        sets = [name for name, of, element_of in sections if of in map(str.upper, known)
                and (element_of in element[own] if element_of else
                     [each[1] for each in sections].count(of) == 1)]
        names[int(number)] = ", ".join([*dict.fromkeys(sets), "of " + " and ".join(known)]) if known else ""
    said = list(names.values())
    for number, name in names.items():
        if said.count(name) > 1:
            names[number] = f"{name}, first node {first_node[body == number].min()}"
    return {number: f" ({name})" for number, name in names.items() if name}


def sections_of(deck):
    """Return element set, material in capitals and an element of every section; 0 where the cards of the
    set do not begin with one."""
    first = {}
    for card in cards_of("ELEMENT|ELSET", deck, r"\n *(\d+)"):
        first.setdefault(parameter(card[0], "ELSET").upper(), int(card[1]))
    found = [(parameter(card, "ELSET"), parameter(card, "MATERIAL").upper())
             for card in cards_of(r"SOLID\s+SECTION", deck)]
    return [(*section, first.get(section[0].upper(), 0)) for section in found]


def cards_of(keyword, deck, data=""):
    """Return the parameters of all cards of a keyword, with what matches a pattern in their data."""
    return re.findall(CARD.format(keyword) + data, "\n".join(deck), re.MULTILINE | re.IGNORECASE)


def parameter(card, name):
    """Return the value of a parameter of a card; nothing where it has none."""
    found = re.search(rf"\b{name}\s*=\s*\"?([^,\"\n]+)", card, re.IGNORECASE)
    return found[1].strip() if found else ""
