"""Colours of the fields: which bodies share them, their levels and their bars."""

import matplotlib
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.ticker import Locator, MaxNLocator

PRINCIPAL = ("principal_1", "principal_2", "principal_3")
SIGNED = ("xx", "yy", "zz", "xy", *PRINCIPAL, "radial", "hoop", "flux_x", "flux_y",
          "mode_temperature")
ROUNDING = 1e-9  # values that differ by this part of the largest magnitude are the same
NOTHING = 1e-6  # of the largest magnitude: what is smaller everywhere is 0
UNSEEN = 1e-4  # of the range of temperatures: so far they may be beyond the colours
UNIFORM = 1e-3  # of the largest magnitude: a smaller range has one colour
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


def limits(values, quantity, scale):
    """Return levels for the colours: round numbers that cover the values of the window.

    Values whose range is below UNIFORM of the magnitude `scale` have two levels, about their middle.

    Stress peaks in re-entrant and clamped corners grow with every refinement and would leave one
    colour for the rest: beyond the middle 99 % stresses share the colours at the ends.
    """
    values = values[np.isfinite(values)]
    low, high = values.min(), values.max()
    if high - low <= UNIFORM * scale:
        middle = 0.5 * (low + high)
        middle = middle if abs(middle) > NOTHING * scale else 0.0
        return middle + np.array([-1.0, 1.0]) * (scale or 1.0)  # one band
    if quantity != "temperature":
        ends = np.percentile(values, (0.5, 99.5))
        low, high = ends if np.ptp(ends) > UNIFORM * scale else (low, high)
    unseen = UNSEEN * (high - low) * (quantity == "temperature")
    return MaxNLocator(nbins=14, steps=[1, 2, 2.5, 5, 10]).tick_values(low + unseen, high - unseen)


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


def overflow(values, levels):
    """Return which ends of the colour bar values run past."""
    slack = 1e-6 * (levels[-1] - levels[0])
    below, above = values.min() < levels[0] - slack, values.max() > levels[-1] + slack
    return [["neither", "max"], ["min", "both"]][int(below)][int(above)]


class LevelLocator(Locator):
    """Ticks of a colour bar: every n-th level, as many as there is room for."""

    def __init__(self, levels):
        self.levels = levels

    def __call__(self):
        """Return the levels that have labels, those at whole multiples of their distance."""
        count, steps = len(self.levels), np.rint(self.levels / np.diff(self.levels[:2]))
        rounded = [float(f"{level:.6g}") for level in self.levels]
        digits = max(len(np.format_float_positional(level, trim="-")) for level in rounded)
        # Digits are half as wide as high.
        share = 6 / (digits + 1) if self.axis.axis_name == "x" else 1.5
        room = 1 + share * self.axis.get_tick_space()  # which leaves space between labels
        every = max(1, round(count / 7), int(np.ceil(count / room)))
        return self.levels[steps % every == 0]


def draw_bar(axes, filled, levels, extend, bodies):
    """Draw a colour bar of a panel beside it, below wide panels, with arrows at the ends that values
    run past; it names `bodies`."""
    width, height = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
    is_wide = width > WIDE * height
    across = 0.03 * max(width, height) / (height if is_wide else width)
    bar = axes.figure.colorbar(filled, ax=axes, location="bottom" if is_wide else "right", extend=extend,
                               fraction=max(0.05, across), pad=0.02, aspect=30, shrink=0.9)
    bar.ax.tick_params(direction="out", width=0.4, length=2, labelsize=7)
    bar.outline.set_linewidth(0.4)
    bar.set_ticks(LevelLocator(levels))
    if len(levels) == 2:
        middle = 0.5 * (levels[0] + levels[1])
        bar.set_ticks([middle], labels=[f"{middle:.4g}".replace("-", "\N{MINUS SIGN}")])
    if len(bodies):
        words = ", ".join(str(body) for body in sorted(bodies))
        bar.set_label(f"bod{'y' if len(bodies) == 1 else 'ies'} {words}", fontsize=7)
