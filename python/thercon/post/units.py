"""Units and labels of the axes."""

import re

from .words import number_text

UNIT_NAMES = ("length", "stress", "power", "temperature", "time")


NEWTON = {"MPa mm^2": "N", "Pa m^2": "N", "MPa mm^3": "N mm", "Pa m^3": "N m"}


class Units:
    """The user's own units."""

    def __init__(self, names, load="time"):
        """Take {length, stress, power, temperature, time: unit}; empty texts give no unit. The unit of
        the load axis is one of these, or the quantity itself where it has no unit."""
        self.names = {quantity: plain_unit(unit) for quantity, unit in names.items() if unit}
        self.load = next((quantity for quantity in ("temperature", "length", "time")
                          if plain_unit(load) in (quantity, self.names.get(quantity))
                          and (quantity != "time" or quantity in self.names)), None)
        if {"power", "length"} <= set(self.names):
            self.names["flux"] = f"{self.names['power']}/{self.names['length']}$^2$"
        if "length" in self.names:
            self.names["volume"] = f"{self.names['length']}$^3$"
        if {"stress", "length"} <= set(self.names):
            force = f"{self.names['stress']} {self.names['length']}^2"
            self.names["force"] = NEWTON.get(force, force.replace("^2", "$^2$"))

    def label(self, words, quantity=None):
        """Return an axis label: `words` with the unit of `quantity`, where there is one."""
        unit = self.names.get(quantity)
        return f"{words} ({unit})" if unit else words

    def load_label(self, label):
        """Return the label of the load axis, with its unit."""
        return self.label(label[:1].upper() + label[1:], self.load)

    def load_value(self, label, value):
        """Return one load in words, such as "temperature of TOP = 540 C"."""
        equal = "" if label == "time" else " ="
        return f"{label}{equal} {number_text(value)} {self.load_unit()}".strip()

    def short_load(self, label, value):
        """Return one load in few words: with its unit, or its name where it is the time."""
        if self.load is None:
            return self.load_value(label, value)
        return f"{number_text(value)} {self.load_unit()}".strip()

    def time_value(self, time):
        """Return a time in words, such as "time 60 s"."""
        return f"time {number_text(time)} {self.names.get('time', '')}".rstrip()

    def load_unit(self):
        """Return the unit of the load axis, or an empty text."""
        return self.names.get(self.load, "")


def plain_unit(unit):
    """Return a unit as pictures show it."""
    return "\N{DEGREE SIGN}C" if unit == "C" else unit.replace("$", "")


def unit_of(words):
    """Return the unit that a dataset names as pictures and page show it; empty where the deck names
    none and it has a quantity in its place."""
    words = NEWTON.get(words, words)
    is_named = words != "-" and not re.search("length|stress|power|temperature|time", words)
    raised = plain_unit(words).replace("^2", "\N{SUPERSCRIPT TWO}")
    return raised.replace("^3", "\N{SUPERSCRIPT THREE}") if is_named else ""
