"""The series of a print file with fixed columns, read as a template says."""

from collections import Counter
from pathlib import Path

import numpy as np

from ..errors import UserError
from .numbers import fortran_number
from .series import AXES, STATES, Source, masked, split
from .template import read_template

CALCULIX_DAT = Path(__file__).with_name("calculix_dat.toml")
PRINT_FILE = "print file"


def read_calculix_dat(path):
    """Return the source of a CalculiX .dat file."""
    return read(path, read_template(CALCULIX_DAT), "CalculiX .dat")


def read(path, template, kind=PRINT_FILE):
    """Return the source of a print file."""
    try:
        text = Path(path).read_text(encoding="latin-1")
    except OSError as reason:
        raise UserError(f"{path}: cannot be read ({reason})") from None
    reader = Reader(path, template)
    for number, line in enumerate(text.split("\n"), 1):
        # A form feed begins a page; it is no column. Tabs go to the next eighth column.
        reader.take(number, line.rstrip("\r").replace("\f", "").expandtabs(8))
    notes = reader.notes() + (reader.unfitted() if kind == PRINT_FILE else [])
    source = Source(str(path), kind, reader.series(), notes)
    source.states = set(STATES) | reader.states
    return source


class Reader:
    """Goes through a print file line by line; what no form fits is counted, never guessed."""

    def __init__(self, path, template):
        self.path, self.template = path, template
        self.context = {}  # time, and texts that headings named
        self.form, self.skip, self.left = None, 0, None
        self.above = {}
        self.rows = {}  # names of the columns -> {name: values}
        self.counts, self.first = Counter(), {}
        self.states = set()
        self.fitted = set()  # patterns of the template that some line fits

    def take(self, number, line):
        """Take one line."""
        here = f"{self.path}:{number}"
        if self.template.ignore and self.template.ignore.search(line):
            return
        if self.form and self.form.ignore and self.form.ignore.search(line):
            return
        if self.open_table(here, line) or self.take_values(here, line) or self.form is None:
            return
        if self.skip:
            self.skip -= 1
        elif self.form.end and self.form.end.search(line):
            self.form = None
        elif line.strip():
            self.take_row(here, line)

    def open_table(self, here, line):
        """Begin a table if the line is a heading."""
        for form in self.template.tables:
            found = form.heading.search(line)
            if found:
                self.fitted.add(form.heading.pattern)
                self.remember(here, found.groupdict())
                continued = form is self.form
                self.form, self.skip, self.left = form, form.skip, form.rows
                self.above = self.above if continued else {}
                return True
        return False

    def remember(self, here, groups):
        """Keep what named groups hold; time and load are numbers."""
        for name, text in groups.items():
            if name in AXES and fortran_number(text or "") is None:
                raise UserError(f"{here}: '{text}' is no {name}")
            self.context[name] = fortran_number(text) if name in AXES else text

    def take_values(self, here, line):
        """Take the time and other values that the line holds; return whether there were any."""
        found = False
        for form in self.template.values:
            match = form.pattern.search(line)
            if match:
                self.fitted.add(form.pattern.pattern)
            if match and form.name is None:
                self.remember(here, match.groupdict())
            elif match:
                self.take_value(here, form, match.group(1))
            found = found or match is not None
        return found

    def take_value(self, here, form, text):
        """Take one named value: the time of what follows, or a value at that time."""
        number = fortran_number(text)
        if number is None and form.name not in AXES and self.is_overflow(text):
            self.count("overflow", here)
        elif number is None:
            raise UserError(f"{here}: '{text}', the value of {form.name}, is no number")
        number = None if number is None else form.factor * number
        if form.name in AXES:
            self.context[form.name] = number
        else:
            self.add(here, {form.name: number})

    def take_row(self, here, line):
        """Take a row; a line whose keys are no numbers, or that has only keys, is none."""
        fields = [(each, line[each.first - 1 : each.last].strip()) for each in self.form.columns]
        keys = [(each, text) for each, text in fields if each.is_key]
        values = [text for each, text in fields if not each.is_key]
        if any(self.is_overflow(text) for _, text in keys) and any(values):
            self.count("lost", here)
            return
        readable = all(self.is_key_text(each, text) for each, text in keys)
        if not readable or not any(values):
            self.count("stray", here)
            return
        row = {each.name: self.field(here, each, text) for each, text in fields}
        self.above |= row
        self.add(here, row)
        self.left = self.left and self.left - 1
        if self.left == 0:
            self.form = None

    def is_overflow(self, text):
        """Whether a text is all stars."""
        return bool(text) and set(text) == {self.template.overflow}

    def is_key_text(self, column, text):
        """Whether a text can be a key, a blank one only where it stands for the one above."""
        if not text:
            return column.blank == "above" and column.name in self.above
        return column.name == "contact" or text.lstrip("+-").isdigit()

    def field(self, here, column, text):
        """Return the value of one field, None where it is missing."""
        if not text and column.blank == "above":
            return self.above.get(column.name)
        if not text:
            return 0.0 if column.blank == "zero" else None
        if column.name == "contact":
            return text
        if column.states is not None:
            self.states.add(column.name)
            if text not in column.states:
                known = ", ".join(column.states)
                raise UserError(f"{here}: '{text}' is no state of {column.name}; known: {known}")
            return float(column.states[text])
        if self.is_overflow(text):
            self.count("overflow", here)
            return None
        number = fortran_number(text)
        if number is None:
            place = f"columns {column.first}-{column.last}"
            raise UserError(f"{here}: {place}: '{text}' is no number ({column.name})")
        return number if column.is_key else column.factor * number

    def add(self, here, row):
        """Add a row, with the time at hand, to the rows that have the same columns."""
        names = {name: self.full_name(here, name) for name in row}
        axes = {axis: self.context[axis] for axis in AXES if axis in self.context}
        columns = {**axes, **{names[name]: value for name, value in row.items()}}
        rows = self.rows.setdefault(tuple(columns), {name: [] for name in columns})
        for name, value in columns.items():
            rows[name].append(value)

    def full_name(self, here, name):
        """Return a column's name, with what its braces stand for."""
        try:
            return name.format(**self.context)
        except (KeyError, IndexError, ValueError):
            raise UserError(f"{here}: nothing gave the name in braces of '{name}'") from None

    def count(self, kind, here):
        """Count something to report, and keep where it was first."""
        self.counts[kind] += 1
        self.first.setdefault(kind, here)

    def unfitted(self):
        """Return a note of the patterns of the template that no line fits."""
        patterns = [form.heading.pattern for form in self.template.tables]
        patterns += [form.pattern.pattern for form in self.template.values]
        missing = [f"'{pattern}'" for pattern in patterns if pattern not in self.fitted]
        return [f"no line fits {', '.join(missing)} of the template"] if missing else []

    def series(self):
        """Return the tables as series."""
        if not self.rows:
            raise UserError(f"{self.path}: no line fits the headings and values looked for")
        long = []
        for columns in self.rows.values():
            plain = ("contact",)
            long.append({k: np.array(v) if k in plain else masked(v) for k, v in columns.items()})
        return [split(columns) for columns in long]

    def notes(self):
        """Return what was passed over, in words."""
        words = {
            "overflow": "values overflowed (stars): taken as missing",
            "lost": "rows left out, for their key overflowed (stars)",
            "stray": "lines inside tables are no rows and were passed over",
        }
        return [
            f"{self.counts[k]} {words[k]}; first {self.first[k]}" for k in words if self.counts[k]
        ]
