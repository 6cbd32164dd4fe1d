"""--map: quantities, keys and units of B as A has them."""

import re
from dataclasses import dataclass, replace

import numpy as np

from ..errors import UserError
from .series import AXES, COORDINATES, KEYS, Series, alias, split

NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[Ee][-+]?\d+)?"
FORM = re.compile(
    rf"^\s*(?P<name>[^\s=*]+)\s*=\s*(?P<sign>[-+]?)\s*(?:(?P<factor>{NUMBER})\s*\*\s*)?"
    r"(?P<minus>-?)\s*(?P<other>[A-Za-z_][^\s=*]*)"
    rf"(?:\s+(?P<shift>[-+])\s*(?P<offset>{NUMBER}))?\s*$"
)


@dataclass
class Mapping:
    """`name` of A is factor * `other` of B + offset."""

    name: str
    other: str
    factor: float
    offset: float

    def of(self, values):
        """Return values of B as A has them."""
        if self.factor == 1.0 and self.offset == 0.0:
            return values
        return self.factor * np.ma.asanyarray(values) + self.offset


def read_mappings(texts):
    """Return the mappings that texts such as 'NT = 0.5556*TEMP - 17.78' stand for."""
    mappings = []
    for text in texts:
        found = FORM.match(text)
        if not found:
            raise UserError(
                f"--map {text}: write NAME=OTHER, NAME=-OTHER, NAME=180*OTHER or 'NAME=2*OTHER + 3'"
            )
        sign = -1.0 if (found["sign"] == "-") != (found["minus"] == "-") else 1.0
        shift = -1.0 if found["shift"] == "-" else 1.0
        factor = sign * float(found["factor"] or 1.0)
        offset = shift * float(found["offset"] or 0.0)
        mappings.append(Mapping(found["name"], found["other"], factor, offset))
    names = [each.name for each in mappings]
    if len(set(names)) != len(names):
        raise UserError("--map: a name of A stands twice")
    return mappings


def apply(source, mappings):
    """Map the series of a source; return the mappings that something was found for."""
    found = [each for each in mappings if any(column(one, each.other) for one in source.series)]
    source.series = [mapped(series, found) for series in source.series]
    return found


def column(series, name):
    """Return the column of a series that a name stands for; None where there is none."""
    names = [*series.quantities, *series.axes]
    if name in (*KEYS, *COORDINATES, *AXES):
        names += list(series.frame(0))
    return alias(name, names)


def mapped(series, mappings):
    """Return a series with mappings applied to its columns; what is mapped loses its old name."""
    found = [(each, column(series, each.other)) for each in mappings]
    mappings = [replace(each, other=other) for each, other in found if other]
    if not mappings:
        return series
    if series.history or not series.axes:  # keys, or the time, may only now have their names
        return split(rename(series.frame(0), mappings))
    axes = rename(series.axes, mappings)
    frames = [lambda k=k: rename(series.frame(k), mappings) for k in range(len(series.frames))]
    places = (*KEYS, *COORDINATES, *AXES)
    names = [n for n in rename(dict.fromkeys(series.quantities, 0), mappings) if n not in places]
    return Series(names, frames, axes)


def rename(columns, mappings):
    """Return columns with the mapped ones under the names of A, in its units."""
    others = {each.other for each in mappings}
    kept = {name: values for name, values in columns.items() if name not in others}
    for each in mappings:
        if each.other in columns:
            kept[each.name] = each.of(columns[each.other])
    return kept
