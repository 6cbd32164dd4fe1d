"""Colours of the fields: which bodies share them, their levels and their bars."""

from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.ticker import Locator, MaxNLocator

PRINCIPAL = ("principal_1", "principal_2", "principal_3")
SIGNED = ("xx", "yy", "zz", "xy", *PRINCIPAL, "radial", "hoop", "flux_x", "flux_y",
          "mode_temperature")
ROUNDING = 1e-9  # values that differ by this part of the largest magnitude are the same
NOTHING = 1e-6  # of the largest magnitude: what is smaller everywhere is 0
UNSEEN = 2e-3  # of the range of temperatures: so far they may be beyond the colours
UNIFORM = 1e-3  # of the largest magnitude: a smaller range has one colour
BEYOND = 0.005  # of the area, at either end of a scale: so much may have values beyond its colours
FAR = 1.5  # times the range of the others: values that extend it by less have colours too
NEUTRAL = np.array([0.05, 0.2, 0.4, 0.6, 0.8, 1.0])  # levels of a mode: about 0 its sign tells nothing
WIDE = 1.8  # width over height of models whose panels are one below the other


def scale_groups(near):
    """Return bodies that share their colours: [bodies], the widest range first.

    `near` holds the values of each body in the window: {body: values}. A body whose range is less
    than a tenth of the widest of a group begins another one; rounding is no range.
    """
    near = {body: values[np.isfinite(values)] for body, values in near.items()}
    ranges = {body: np.ptp(values) for body, values in near.items() if len(values)}
    size = max((np.abs(near[body]).max() for body in ranges), default=0.0)
    groups, widest = [], np.inf
    for body in sorted(ranges, key=ranges.get, reverse=True):
        if not groups or ROUNDING * size < ranges[body] < 0.1 * widest:
            groups.append([])
            widest = ranges[body]
        groups[-1].append(body)
    return groups


def limits(values, quantity, scale, areas=None, given=None):
    """Return levels for the colours: round numbers that cover the values of the window, or the range
    `given`.

    Values whose range is below UNIFORM of the magnitude `scale` have two levels, about their middle.

    Stress peaks in re-entrant and clamped corners grow with every refinement and would leave one
    colour for the rest: where they are FAR, colours of other values than temperatures cover 99 % of the
    area alone, by the `areas` that they stand for (None: equal ones).
    """
    if given is not None:
        levels = ticks(*given)
        is_round = np.allclose(levels[[0, -1]], given, rtol=0.0, atol=1e-9 * np.ptp(levels))
        return levels if is_round else np.linspace(*given, 11)
    is_number = np.isfinite(values)
    areas = np.ones(len(values)) if areas is None else areas
    values, areas = values[is_number], areas[is_number]
    low, high = values.min(), values.max()
    if high - low <= UNIFORM * scale:
        middle = 0.5 * (low + high)
        middle = middle if abs(middle) > NOTHING * scale else 0.0
        return middle + np.array([-1.0, 1.0]) * (scale or 1.0)  # one band
    if quantity == "mode_temperature":
        return scale * np.concatenate((-NEUTRAL[::-1], NEUTRAL))
    if quantity != "temperature":
        order = np.argsort(values)
        below = np.cumsum(areas[order])
        ends = values[order[np.searchsorted(below, np.array([BEYOND, 1.0 - BEYOND]) * below[-1])]]
        if np.ptp(ends) > UNIFORM * scale and high - low > FAR * np.ptp(ends):
            low, high = ends
    unseen = UNSEEN * (high - low) * (quantity == "temperature")
    return ticks(low + unseen, high - unseen)


def ticks(low, high):
    """Return round numbers, about a dozen, that cover a range."""
    return MaxNLocator(nbins=14, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)


def settle(values, levels, scale):
    """Return values with those that are at a level but for rounding put onto it, and those that are
    hardly beyond the first and the last."""
    nearest = levels[np.argmin(np.abs(values[:, None] - levels), axis=1)]
    beyond = (values < levels[0]) | (values > levels[-1])
    room = np.maximum(ROUNDING * scale, beyond * UNSEEN * (levels[-1] - levels[0]))
    return np.where(np.abs(values - nearest) <= room, nearest, values)


def colours_of(quantity, levels):
    """Return colours of the bands between levels that the colour-blind can tell apart, and their
    norm.

    A colour means the same in every panel: of quantities with a sign, red is positive, as tension,
    and blue negative, as compression, the darker the larger; of the others, bright is large.
    """
    count = len(levels) - 1
    shades = np.linspace(0.0, 1.0, count) if count > 1 else np.array([0.5])
    if quantity in SIGNED:
        middles = 0.5 * (levels[1:] + levels[:-1])
        sizes = np.abs(middles)
        least = 0.0 if levels[0] < 0.0 < levels[-1] else sizes.min()
        dark = 0.15 + 0.85 * (sizes - least) / (sizes.max() - least) if count > 1 else 0.5
        shades = 0.5 + 0.5 * np.sign(middles) * dark
    name = "RdBu_r" if quantity in SIGNED else "inferno" if quantity == "temperature" else "viridis"
    return ListedColormap(matplotlib.colormaps[name](shades)), BoundaryNorm(levels, count)


@dataclass
class Layer:
    """What a panel is filled with, in one scale of colours."""

    filled: object
    levels: np.ndarray
    ends: tuple  # smallest and largest value at nodes, or of elements, that are shown
    bodies: list  # whose colours they are, where other bodies have others
    kind: str  # of colours and unit: scales of one kind can be shared

    @property
    def beyond(self):
        """Whether there are values below the colours and above them, more than UNSEEN."""
        return overflow(self.ends, self.levels)

    def beyond_words(self):
        """Return how far values lie beyond the colours, in words; nothing where none do."""
        below, above = self.beyond
        low, high = (f"{end:.4g}".replace("-", "\N{MINUS SIGN}") for end in self.ends)
        if below and above:
            return f"{low} to {high}"
        return f"down to {low}" if below else f"up to {high}" if above else ""

    def has_scale_of(self, other):
        """Whether another layer can be read by the colour bar of this one."""
        return (self.kind == other.kind and not self.bodies and not other.bodies
                and np.array_equal(self.levels, other.levels))


def overflow(values, levels):
    """Return whether values lie below the first and above the last level."""
    slack = UNSEEN * (levels[-1] - levels[0])
    return bool(np.min(values) < levels[0] - slack), bool(np.max(values) > levels[-1] + slack)


def extend_words(below, above):
    """Return at which ends a colour bar has arrows, as Matplotlib names them."""
    return [["neither", "max"], ["min", "both"]][int(below)][int(above)]


class LevelLocator(Locator):
    """Ticks of a colour bar: every n-th level, as many as there is room for."""

    def __init__(self, levels):
        self.levels = levels

    def __call__(self):
        """Return the levels that have labels, those at whole multiples of their distance; all where
        their distances differ."""
        if not np.allclose(np.diff(self.levels), self.levels[1] - self.levels[0]):
            return self.levels
        count, steps = len(self.levels), np.rint(self.levels / np.diff(self.levels[:2]))
        rounded = [float(f"{level:.6g}") for level in self.levels]
        digits = max(len(np.format_float_positional(level, trim="-")) for level in rounded)
        # Digits are half as wide as high.
        share = 6 / (digits + 1) if self.axis.axis_name == "x" else 1.5
        room = 1 + share * self.axis.get_tick_space()  # which leaves space between labels
        every = max(1, round(count / 7), int(np.ceil(count / room)))
        return self.levels[steps % every == 0]


def draw_bars(panels, layers):
    """Draw the colour bars of panels with their `layers`: neighbours in a row or column whose scales
    are one share a bar."""
    grid = panels[0].get_subplotspec().get_gridspec()
    first = 0
    while first < len(panels):
        last = first + 1
        while last < len(panels) and (grid.ncols == 1 or last % grid.ncols) and all(
                len(each) == 1 and layers[first][0].has_scale_of(each[0])
                for each in (layers[first], layers[last])):
            last += 1
        for number in range(len(layers[first])):
            draw_bar(panels[first:last], [each[number] for each in layers[first:last]])
        first = last


def draw_bar(panels, layers):
    """Draw a colour bar beside panels, below wide ones, with arrows at the ends that values run past,
    and words of how far; it names the bodies whose it is."""
    axes, levels = panels[0], layers[0].levels
    width, height = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim()) * axes.get_aspect()
    is_wide = width > WIDE * height
    across = 0.03 * max(width, height) / (height if is_wide else width) / len(panels)
    below, above = np.any([layer.beyond for layer in layers], axis=0)
    bar = axes.figure.colorbar(layers[0].filled, ax=panels, location="bottom" if is_wide else "right",
                               extend=extend_words(below, above), fraction=max(0.05, across),
                               pad=max(0.02, 0.3 * across), aspect=30, shrink=0.9)
    bar.ax.tick_params(direction="out", width=0.4, length=2, labelsize=7)
    bar.outline.set_linewidth(0.4)
    bar.set_ticks(LevelLocator(levels))
    if len(levels) == 2:
        middle = 0.5 * (levels[0] + levels[1])
        bar.set_ticks([middle], labels=[f"{middle:.4g}".replace("-", "\N{MINUS SIGN}")])
    words = [bar_words(layers, [axes.get_title(loc="left")[:4] for axes in panels])]
    if layers[0].bodies:
        names = ", ".join(str(body) for body in sorted(layers[0].bodies))
        words.insert(0, f"bod{'y' if len(layers[0].bodies) == 1 else 'ies'} {names}")
    bar.set_label(("; " if is_wide else "\n").join(filter(None, words)), fontsize=7)


def bar_words(layers, letters):
    """Return how far values lie beyond the colours of a bar, of several panels with their letters."""
    told = [(letter, layer.beyond_words()) for letter, layer in zip(letters, layers)]
    told = [f"{letter}{words}" if len(layers) > 1 else words for letter, words in told if words]
    return f"values beyond: {', '.join(told)}" if told else ""
