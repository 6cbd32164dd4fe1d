"""Units and labels of the axes."""

UNIT_NAMES = ("length", "stress", "power", "temperature")


class Units:
    """The user's own units."""

    def __init__(self, names):
        """Take {length, stress, power, temperature: unit}; empty texts give no unit."""
        self.names = {quantity: unit.replace("$", "") for quantity, unit in names.items() if unit}
        if self.names.get("temperature") == "C":
            self.names["temperature"] = "\N{DEGREE SIGN}C"
        if {"power", "length"} <= set(self.names):
            self.names["flux"] = f"{self.names['power']}/{self.names['length']}$^2$"

    def label(self, words, quantity=None):
        """Return an axis label: `words` with the unit of `quantity`, where there is one."""
        unit = self.names.get(quantity)
        return f"{words} ({unit})" if unit else words

    def load_label(self, label):
        """Return the label of the load axis, with the unit of what it names."""
        return self.label(label[:1].upper() + label[1:], load_quantity(label))

    def load_value(self, label, value):
        """Return one load in words, such as "temperature of TOP 540 C"."""
        return f"{label} {value:g} {self.load_unit(label)}".strip()

    def short_load(self, label, value):
        """Return one load in few words: with its unit, or its name where it is the time."""
        if load_quantity(label) is None:
            return self.load_value(label, value)
        return f"{value:g} {self.load_unit(label)}".strip()

    def load_unit(self, label):
        """Return the unit of the load axis, or an empty text."""
        return self.names.get(load_quantity(label), "")


def load_quantity(label):
    """Return the kind of unit of the load axis by the words of its label, None for the time."""
    kinds = {"temperature": "temperature", "displacement": "length"}
    return next((kind for word, kind in kinds.items() if word in label.lower()), None)
