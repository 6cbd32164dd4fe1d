"""Templates: short TOML files that say how the tables of a print file look."""

import re
import tomllib
from dataclasses import dataclass
from pathlib import Path

from ..errors import UserError, nearest_name
from .series import AXES, COORDINATES, KEYS

BLANKS = ("missing", "zero", "above")
TABLE_WORDS = ("heading", "columns", "skip", "rows", "end", "ignore")
COLUMN_WORDS = ("name", "first", "last", "factor", "blank", "states")
VALUE_WORDS = ("pattern", "name", "factor")
TOP_WORDS = ("table", "value", "ignore", "overflow")


@dataclass
class Column:
    """One column: its place on the line, from 1, and what its texts mean."""

    name: str
    first: int
    last: int
    factor: float = 1.0
    blank: str = "missing"
    states: dict | None = None

    @property
    def is_key(self):
        """Whether the column tells rows apart."""
        return self.name in KEYS


@dataclass
class TableForm:
    """How one kind of table is recognised and read."""

    heading: re.Pattern
    columns: list
    skip: int = 0
    rows: int | None = None
    end: re.Pattern | None = None
    ignore: re.Pattern | None = None


@dataclass
class ValueForm:
    """A pattern that gives the time, or another value, wherever a line has it."""

    pattern: re.Pattern
    name: str | None = None
    factor: float = 1.0


@dataclass
class Template:
    """All forms of a print file."""

    tables: list
    values: list
    ignore: re.Pattern | None = None
    overflow: str = "*"

    def joined(self, other):
        """Return the forms of both."""
        ignore = [each.pattern for each in (self.ignore, other.ignore) if each]
        pattern = re.compile("|".join(f"(?:{each})" for each in ignore)) if ignore else None
        return Template(
            self.tables + other.tables, self.values + other.values, pattern, self.overflow
        )


def read_template(path):
    """Read and check a template."""
    try:
        words = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as reason:
        raise UserError(f"{path}: cannot be read ({reason})") from None
    except tomllib.TOMLDecodeError as reason:
        raise UserError(f"{path}: is no TOML: {reason}") from None
    check_words(path, words, TOP_WORDS)
    tables = [table(f"{path}: table {k}", each) for k, each in listed(path, words, "table")]
    values = [value(f"{path}: value {k}", each) for k, each in listed(path, words, "value")]
    if not tables and not any(each.name not in (None, *AXES) for each in values):
        raise UserError(f"{path}: has neither a [[table]] nor a [[value]] to compare")
    overflow = words.get("overflow", "*")
    if not isinstance(overflow, str) or len(overflow) != 1:
        raise UserError(f"{path}: overflow is one character")
    return Template(tables, values, pattern(path, words, "ignore"), overflow)


def listed(path, words, name):
    """Return the numbered entries of an array of tables."""
    entries = words.get(name, [])
    if not isinstance(entries, list) or not all(isinstance(each, dict) for each in entries):
        raise UserError(f"{path}: write [[{name}]], in two brackets")
    return enumerate(entries, 1)


def check_words(where, words, known):
    """Raise the error for a word that is not known."""
    for word in words:
        if word not in known:
            hint = nearest_name(word, known)
            raise UserError(f"{where}: unknown word '{word}'{hint}; known: {', '.join(known)}")


def pattern(where, words, name, needed=False):
    """Return the regular expression of an entry; None where it has none."""
    if name not in words:
        if needed:
            raise UserError(f"{where}: {name} is missing")
        return None
    try:
        return re.compile(words[name])
    except (re.error, TypeError) as reason:
        raise UserError(f"{where}: {name} is no regular expression: {reason}") from None


def whole(where, words, name, default, least):
    """Return a whole number of an entry."""
    number = words.get(name, default)
    if number is not None and (type(number) is not int or number < least):
        raise UserError(f"{where}: {name} is a whole number from {least}")
    return number


def factor(where, words):
    """Return the factor of an entry."""
    number = words.get("factor", 1.0)
    if type(number) not in (int, float):
        raise UserError(f"{where}: factor is a number")
    return float(number)


def table(where, words):
    """Return the form of one table."""
    check_words(where, words, TABLE_WORDS)
    if not isinstance(words.get("columns"), list) or not words["columns"]:
        raise UserError(f"{where}: columns is a list of {{name, first, last}}")
    columns = [column(f"{where}, column {k}", each) for k, each in enumerate(words["columns"], 1)]
    columns.sort(key=lambda each: each.first)
    for before, after in zip(columns, columns[1:]):
        if after.first <= before.last:
            raise UserError(f"{where}: columns {before.name} and {after.name} overlap")
    names = [each.name for each in columns]
    if len(set(names)) != len(names):
        raise UserError(f"{where}: a column stands twice")
    if all(name in (*KEYS, *COORDINATES, *AXES) for name in names):
        raise UserError(f"{where}: has no column to compare")
    return TableForm(
        pattern(where, words, "heading", needed=True),
        columns,
        whole(where, words, "skip", 0, 0),
        whole(where, words, "rows", None, 1),
        pattern(where, words, "end"),
        pattern(where, words, "ignore"),
    )


def column(where, words):
    """Return the form of one column."""
    if not isinstance(words, dict):
        raise UserError(f"{where}: is {{name = ..., first = ..., last = ...}}")
    check_words(where, words, COLUMN_WORDS)
    if not isinstance(words.get("name"), str) or not {"first", "last"} <= set(words):
        raise UserError(f"{where}: needs name, first and last")
    first = whole(where, words, "first", None, 1)
    last = whole(where, words, "last", None, first)
    blank = words.get("blank", "missing")
    if blank not in BLANKS:
        raise UserError(f"{where}: blank is one of {', '.join(BLANKS)}")
    states = words.get("states")
    if states is not None and not all(type(each) is int for each in states.values()):
        raise UserError(f"{where}: states is {{TEXT = whole number, ...}}")
    return Column(words["name"], first, last, factor(where, words), blank, states)


def value(where, words):
    """Return the form of a value outside the tables."""
    check_words(where, words, VALUE_WORDS)
    found = pattern(where, words, "pattern", needed=True)
    name = words.get("name")
    if name is not None and found.groups != 1:
        raise UserError(f"{where}: the pattern of a named value has one group")
    if name is None and not found.groupindex:
        raise UserError(f"{where}: needs a name, or groups with names in its pattern")
    return ValueForm(found, name, factor(where, words))
