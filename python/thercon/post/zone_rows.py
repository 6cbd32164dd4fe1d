"""Rows of a zone diagram: interfaces that overlap along a coordinate, one above the other."""

import numpy as np

from . import style
from .words import number_text

FILLED = 0.8  # of the height of a row; the rest parts it from the next
ROW, NAME = 0.16, 0.13  # heights of a row and of its name, in inches
TALLEST = 9.6  # height of a picture, in inches: further rows are thinner
LETTER = 0.065  # width of a letter of a name, in inches


class Rows:
    """Where the contact points of several interfaces lie in rows of height 1, in their order."""

    def __init__(self, contact, along):
        self.along, at = contact.own_axis(along)
        self.names, self.ends = list(contact.parts), (float(at.min()), float(at.max()))
        self.places = FILLED * (at - at.min()) / (np.ptp(at) or 1.0)
        for number, part in enumerate(contact.parts.values()):
            self.places[part] += number
        self.window = FILLED - 1.0, float(len(self.names))

    def labels(self):
        """Return what the ordinate tells of the rows."""
        return self.names, self.along, self.ends

    def size(self, width):
        """Return width and height of a figure: more names make it taller, long ones wider."""
        height = np.clip(ROW * len(self.names), style.SINGLE_COLUMN, TALLEST)
        return width + LETTER * max(map(len, self.names)), float(height)

    def name(self, axes, units):
        """Name the rows, as many as there is room for, and say what each shows."""
        every = int(np.ceil(NAME * len(self.names) / self.size(0.0)[1]))
        shown = range(0, len(self.names), every)
        axes.set_yticks([number + 0.5 * FILLED for number in shown],
                        [style.plain(self.names[number]) for number in shown])
        axes.tick_params(axis="y", length=0.0)
        low, high = map(number_text, self.ends)
        words = f"Each interface, upwards from ${self.along}$ = {low} to {high}"
        axes.set_ylabel(f"{words} {units.names.get('length', '')}".rstrip())
