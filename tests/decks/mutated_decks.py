"""Decks that are changed at random, and what must not happen to them."""

import random
import re
import shutil
import subprocess
from functools import cache
from itertools import chain

import h5py
import numpy as np
from deck_runs import DECKS, INPUT, PATIENCE, datasets, run
from test_broken_names import ASSEMBLY, CARDS, MESH, MODEL, STEP, ignored, plain, table

INCLUDED = {".mesh", ".gmsh", ".inc", ".step"}
NUMBERS = ("0", "-1", "7777", "2147483648", "1e300", "-1e-300", "nan", "1e", "", "0.5", "11", "3", "1", "2")
CRASHES = ("On entry", "IEEE", "Fortran runtime", "Backtrace", "Sanitizer", "runtime error")


@cache
def types():
    """Return all element types that the program knows, with the number of their nodes."""
    text = (DECKS.parents[1] / "src" / "deck" / "reading" / "element_types.f90").read_text()
    planes, kinds = (re.findall(r"'(\w+) *'", re.search(rf"{name}\(\d\) = \[(.*)\]", text)[1])
                     for name in ("plane_names", "kind_names"))
    found = {plane + kind: int(kind[0]) for plane in planes for kind in kinds}
    for names, count in re.findall(r"case \((.*)\)\n +line_node_count = (\d)", text):
        found |= dict.fromkeys(re.findall(r"'(\w+)'", names), int(count))
    return found


@cache
def sources():
    """Return groups of decks, as texts, each with the folder of the files that it includes."""
    right = [*INPUT.glob("*/*.inp"), *(DECKS / "foreign").glob("*.inp")]
    groups = [[(path.read_text(errors="replace"), path.parent) for path in sorted(paths)]
              for paths in (right, (DECKS / "refused").glob("*.inp"))]
    own = [MESH + MODEL + STEP, ASSEMBLY, *(deck for decks in CARDS.values() for deck in decks)]
    return [*groups, [(plain(deck) + "*END STEP\n", None) for deck in own]]


@cache
def cards():
    """Return cards of all decks, each with its first lines of data."""
    found = []
    for text, _ in chain(*sources()):
        found += [card[:300] for card in re.findall(r"^\*[^*].*\n(?:[^*\n].*\n){0,3}", text, re.M)]
    return found + ignored("11").splitlines(keepends=True)


def change_field(line, chance, others):
    """Return a line with a field removed, repeated or replaced."""
    fields = line.split(",")
    i = chance.randrange(len(fields))
    way = chance.randrange(5)
    if way == 0:
        del fields[i]
    elif way == 1:
        fields.insert(i, fields[i])
    elif way == 2:
        name, equals, _ = fields[i].partition("=")
        fields[i] = name + equals + chance.choice(NUMBERS) if equals else chance.choice(NUMBERS)
    elif way == 3:
        fields[i] = chance.choice(chance.choice(others).split(","))
    else:
        name, equals, _ = fields[i].partition("=")
        fields[i] = name + "=" + chance.choice(chance.choice(others).split(",")).rpartition("=")[2]
    return ",".join(fields)


def change(lines, chance):
    """Change a deck in one place."""
    i = chance.randrange(len(lines))
    if chance.random() < 0.5:   # cards of the model, not of a long mesh
        keywords = [k for k, line in enumerate(lines) if line.startswith("*")]
        i = min(chance.choice(keywords or [i]) + chance.randrange(2), len(lines) - 1)
    way = chance.randrange(12)
    if way == 0:
        del lines[i]
    elif way == 1:
        lines.insert(i, lines[i])
    elif way == 2:
        k = chance.randrange(len(lines))
        lines[i], lines[k] = lines[k], lines[i]
    elif way == 3:
        lines[i:i] = chance.choice(cards()).splitlines()
    elif way == 4:
        lines[i] = re.sub(r"^\*[^,]*", lambda _: "*" + chance.choice(list(table())), lines[i])
    elif way == 5:
        elements = [k for k, line in enumerate(lines) if line.upper().startswith("*ELEMENT,")]
        if elements:
            k = chance.choice(elements)
            lines[k] = re.sub(r"TYPE=[^,]*", "TYPE=" + chance.choice([*types(), "C3D8"]), lines[k], flags=re.I)
    elif way == 6 and len(lines[i]) > 0:
        k = chance.randrange(len(lines[i]))
        lines[i] = lines[i][:k] + chr(chance.randrange(32, 127)) + lines[i][k + 1:]
    elif way == 7 and chance.random() < 0.2:
        del lines[i:]
    else:
        lines[i] = change_field(lines[i], chance, lines)
    if not lines:
        lines.append("*NODE")


def mutated(folder, seed):
    """Write a deck that is changed in one to four places; return its path."""
    chance = random.Random(seed)
    text, beside = chance.choice(chance.choice(sources()))
    lines = text.splitlines() or ["*NODE"]
    for _ in range(chance.choice((1, 1, 2, 4))):
        change(lines, chance)
    for path in beside.glob("*") if beside else ():
        if path.suffix in INCLUDED and not (folder / path.name).exists():
            shutil.copy(path, folder)
    deck = folder / "mutated.inp"
    deck.write_text("\n".join(lines) + "\n")
    return deck


def outcome(deck, command="run", seconds=PATIENCE, words=CRASHES):
    """Run or check a deck; return its exit status, -1 where it hangs, and what must not be in its
    ending."""
    arguments = ["--out", deck.parent] if command == "run" else []
    try:
        process = run(command, "--quiet", deck, *arguments, seconds=seconds)
    except subprocess.TimeoutExpired:
        return -1, ["hangs"]
    said = process.stdout + process.stderr
    faults = [word for word in words if word in said]
    if process.returncode not in (0, 1, 2, 4):
        faults.append(f"status {process.returncode}")
    if process.returncode in (1, 2) and "error: " not in said:
        faults.append("no word of error")
    if command == "run" and process.returncode == 0:
        faults += [name for name, values in numbers(deck).items() if unsound(name, values)]
    return process.returncode, faults


def numbers(deck):
    """Return all numbers of a result by their names, a row an increment or a time; of points those that
    elements use: others have no temperature."""
    result = deck.with_suffix(".vtkhdf")
    with h5py.File(result) as file:
        groups = file.keys() & {"VTKHDF", "history", "contact"}
    found = datasets(result, *groups)
    times, used = len(found["VTKHDF/Steps/Values"]), np.unique(found["VTKHDF/Connectivity"])
    points = len(found["VTKHDF/Points"])
    found |= {name: values.reshape(-1, points, *values.shape[1:])[:, used] for name, values in found.items()
              if "PointData/" in name}
    return {name: values.reshape(times if "CellData/" in name else len(values), -1)
            for name, values in found.items() if values.dtype.kind == "f"}


def unsound(name, rows):
    """Return whether numbers are infinite or missing. A step has NaN in all places for what it does not
    solve; so have edges that are not there, and points without a contact."""
    missing = np.isnan(rows)
    partly = missing.any(axis=1) & ~missing.all(axis=1)
    return bool(np.isinf(rows).any() or (partly.any() and "edge" not in name and "contact_" not in name))
