"""In which cards and parameters two decks differ.

A test that runs a deck with two values of a card says so: `@pytest.mark.changes("AMPLITUDE",
"AMPLITUDE, TIME")`, a keyword for its data and a keyword with a parameter for the parameter's
value. conftest.py holds the test to what it says, test_every_keyword.py holds the suite to docs.
"""

import re
from difflib import SequenceMatcher

OUTER_COMMA = re.compile(r',(?=(?:[^"]*"[^"]*")*[^"]*$)')   # not one inside quotes
CHANGED = set()   # by the test that is running


def note_changes(cards, other):
    """Remember in which keywords and parameters two decks, lists of cards, differ."""
    one, two = split(cards), split(other)
    names = [[card[0] for card in deck] for deck in (one, two)]
    for _, i, j, k, m in SequenceMatcher(None, *names, autojunk=False).get_opcodes():
        if names[0][i:j] == names[1][k:m]:
            for before, after in zip(one[i:j], two[k:m], strict=True):
                CHANGED.update(differences(before, after))
        else:
            for name, parameters, data in one[i:j] + two[k:m]:
                CHANGED.update(differences((name, {}, None), (name, parameters, data)))


def differences(before, after):
    """Return the keyword, if the data differ, and each parameter that does."""
    name = before[0]
    found = {name} if before[2] != after[2] else set()
    every = before[1].keys() | after[1].keys()
    return found | {f"{name}, {p}" for p in every if before[1].get(p) != after[1].get(p)}


def split(cards):
    """Return keyword, parameters and data of each keyword card."""
    found = []
    for line in "\n".join(cards).splitlines():
        fields = [field.strip() for field in OUTER_COMMA.split(line)]
        if line.strip().startswith("**"):
            continue
        if fields[0].startswith("*"):
            found.append((fields[0][1:].upper(), parameters_of(fields[1:]), []))
        else:
            found[-1][2].append(fields)
    return found


def parameters_of(fields):
    """Return the values of the parameters; a number belongs to the one before, as in LOAD=TOP,2."""
    found, last = {}, ""
    for field in fields:
        name, _, value = field.partition("=")
        if name.isdigit():
            found[last] += "," + name
        else:
            last = name.strip().upper()
            found[last] = value
    return found
