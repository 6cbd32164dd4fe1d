"""The series of a CalculiX .frd file (ASCII).

Read here, for the readers on PyPI lose what a comparison needs: pyvista-frd-reader 0.3.1 gives
zeros for nodes that a block does not have (*NODE FILE, NSET=), ANYfileio 0.3.2 only the last time,
without temperatures; ccx2paraview 3.2.0 is a converter that writes files. Debian has none. The
format is that of the manual of cgx, "Result Format": records by their first columns.
"""

import re
from functools import partial

import numpy as np

from ..errors import UserError
from .series import Series, Source

# Blocks of the file -> names of *VERIFY and of /contact; None is passed over.
BLOCKS = {
    "DISP": ("U1", "U2", None),
    "NDTEMP": ("NT",),
    "STRESS": ("S11", "S22", "S33", "S12", None, None),
    "FORC": ("RF1", "RF2", None),
    "RFL": ("RFL",),
    "FLUX": ("HFL1", "HFL2", None),
    "CONTACT": ("COPEN", "CSLIP1", None, "pressure", "CSHEAR1", None),
}

# Values of 12 columns that touch where they are negative, or are wider with a long exponent.
VALUE = re.compile(r"[-+]?(?:\d\.\d+E[-+]\d{2,3}|\d+\.\d*|NaN|Inf)", re.I)


def read(path):
    """Return the source of a .frd file."""
    try:
        with open(path, "rb") as file:
            text = file.read().decode("latin-1")
    except OSError as reason:
        raise UserError(f"{path}: cannot be read ({reason})") from None
    reader = Reader(path, text.splitlines())
    if not reader.points:
        raise UserError(f"{path}: no nodes, as a CalculiX .frd file has them")
    notes = [] if reader.blocks else ["a mesh without values: *NODE FILE and *EL FILE write them"]
    return Source(str(path), "CalculiX .frd", reader.series(), notes)


class Reader:
    """Goes through the records of a file; `blocks` is [(time, name, nodes, values)]."""

    def __init__(self, path, lines):
        self.path, self.lines = path, lines
        self.points, self.blocks = {}, []
        self.time, number = None, 0
        while number < len(lines):
            line = lines[number]
            if line.startswith("    2C"):
                number = self.take_points(number)
            elif line.startswith("  100C"):
                self.time = self.numbers(number, line[12:24], 1)[0]
            elif line.startswith(" -4"):
                number = self.take_block(number)
            number += 1

    def take_points(self, number):
        """Read the nodes behind the record `number`; return the number behind their last record."""
        if self.lines[number].split()[-1] not in ("0", "1"):
            raise UserError(
                f"{self.path}: is binary; *NODE FILE and *EL FILE write ASCII, OUTPUT not"
            )
        self.key = slice(3, 13 if self.lines[number].split()[-1] == "1" else 8)
        number += 1
        while self.record(number).startswith(" -1"):
            line = self.lines[number]
            self.points[self.node(number)] = self.numbers(number, line[self.key.stop :], 3)
            number += 1
        return number

    def take_block(self, number):
        """Read the block named in the record `number`; return the number behind its last record."""
        name = self.lines[number].split()[1]
        number, components = number + 1, 0
        while self.record(number).startswith(" -5"):
            components += self.lines[number].split()[1] != "ALL"  # it is for cgx to compute
            number += 1
        nodes, values = [], []
        known = name in BLOCKS and len(BLOCKS[name]) == components
        while self.record(number).startswith((" -1", " -2")):
            if known:
                nodes.append(self.node(number))
                rest = self.lines[number][self.key.stop :]
                values.append(self.numbers(number, rest, components))
            number += 1
        if known and nodes:
            self.blocks.append((self.time, name, np.array(nodes), np.array(values)))
        return number

    def record(self, number):
        """Return a record, of a table that goes on up to its end."""
        if number >= len(self.lines):
            raise UserError(f"{self.path}: ends within a table")
        return self.lines[number]

    def node(self, number):
        """Return the node of a record."""
        try:
            return int(self.lines[number][self.key])
        except ValueError:
            raise UserError(f"{self.path}:{number + 1}: no node number") from None

    def numbers(self, number, text, count):
        """Return the numbers of a record."""
        found = VALUE.findall(text)
        if len(found) != count or VALUE.sub("", text).strip():
            raise UserError(f"{self.path}:{number + 1}: {count} numbers expected: '{text.strip()}'")
        return [float(each) for each in found]

    def series(self):
        """Return one series for each kind of block, its frames in the order of the file."""
        found = []
        for name in dict.fromkeys(name for _, name, _, _ in self.blocks):
            blocks = [each for each in self.blocks if each[1] == name]
            names = [each for each in BLOCKS[name] if each]
            names += {"STRESS": ["MISES"], "CONTACT": ["closed"]}.get(name, [])
            frames = [partial(self.frame, *block[1:]) for block in blocks]
            times = np.array([block[0] for block in blocks])
            found.append(Series(names, frames, {"time": times}))
        return found

    def frame(self, name, nodes, values):
        """Return the columns of one block."""
        points = np.array([self.points.get(node, [np.nan] * 3) for node in nodes.tolist()])
        columns = {"node": nodes, "x": points[:, 0], "y": points[:, 1]}
        columns |= {each: values[:, k] for k, each in enumerate(BLOCKS[name]) if each}
        if name == "STRESS":
            columns["MISES"] = von_mises(values)
        if name == "CONTACT":
            # The block has a row for every node: zeros where no slave face is in contact.
            columns["closed"] = (values[:, 3] > 0.0).astype(int)
            columns["padding"] = ~np.any(values != 0.0, axis=1)
        return columns


def von_mises(stress):
    """Return the equivalent stress of (rows, 6): xx, yy, zz, xy, yz, zx."""
    xx, yy, zz, xy, yz, zx = stress.T
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.sqrt(0.5 * normal + 3.0 * (xy**2 + yz**2 + zx**2))
