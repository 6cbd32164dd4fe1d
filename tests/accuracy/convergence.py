"""Observed orders, Richardson extrapolation and uncertainty bands of quantities over loads.

A series holds a quantity at the same loads on grids each twice as fine as the one before. They meet
an edge of contact here and there between two nodes, which makes errors that change sign with the
load; so orders are those of the rms over all loads, which is steady where a single load tells an
order by chance.
"""

from dataclasses import dataclass

import numpy as np

STEADY, FORMAL = 0.7, 2.0
LEAST = 0.5
SAFETY_FORMAL, NEAR, SAFETY = 1.25, 0.2, 3.0
WINDOW = 9


def rms(values):
    """Return the root of the mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def local_rms(values):
    """Return the rms of each value and its neighbours, four on both sides where they are."""
    window = np.ones(min(WINDOW, len(values)))
    mean = np.convolve(np.square(values), window, "same") / np.convolve(values**0, window, "same")
    return np.sqrt(mean)


@dataclass(frozen=True)
class Series:
    """Values (grids, loads), from the coarsest grid to the finest; three grids or more."""

    values: np.ndarray

    @property
    def changes(self):
        """Return what each refinement changes, (grids - 1, loads)."""
        return np.diff(self.values, axis=0)

    @property
    def sizes(self):
        """Return the rms of these changes over all loads."""
        return [rms(change) for change in self.changes]

    @property
    def order(self):
        """Return the observed order: the slope of the last three sizes, by least squares."""
        sizes = np.log2(self.sizes[-3:])
        return -float(np.polyfit(range(len(sizes)), sizes, 1)[0])

    @property
    def steadiness(self):
        """Return the cosine between the last two changes: 1 where all loads converge alike."""
        one, other = self.changes[-2:]
        return float((one @ other) / np.sqrt((one @ one) * (other @ other)))

    @property
    def steady(self):
        """Return whether extrapolation has something to go by."""
        return self.steadiness > STEADY and self.order > LEAST

    @property
    def correction(self):
        """Return what Richardson's extrapolation adds to the finest grid: nothing where errors
        change sign from grid to grid."""
        gain = 2 ** min(self.order, FORMAL) - 1
        return self.changes[-1] / gain if self.steady else np.zeros_like(self.changes[-1])

    @property
    def value(self):
        """Return the extrapolated values."""
        return self.values[-1] + self.correction

    @property
    def band(self):
        """Return how far the extrapolated values may be off, for each load.

        Steady: the grid convergence index, the correction or its rms nearby, times 1.25 where the
        order is the formal one, else times 3. Errors of random sign fall like 2^-p, so a change has
        the rms E sqrt(1 + 4^p), E that of the finer grid: three times E. Without an order: three
        times the largest change.
        """
        if self.steady:
            safety = SAFETY_FORMAL if abs(self.order - FORMAL) < NEAR else SAFETY
            return safety * np.maximum(np.abs(self.correction), local_rms(self.correction))
        if self.order > LEAST:
            fall = np.sqrt(1 + 4 ** min(self.order, FORMAL))
            return SAFETY * local_rms(self.changes[-1]) / fall
        return SAFETY * np.max([local_rms(change) for change in self.changes[-3:]], axis=0)
