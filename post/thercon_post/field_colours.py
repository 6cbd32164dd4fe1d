"""Colours of the fields: which bodies share them, their levels and their bars."""

import numpy as np
from matplotlib.ticker import MaxNLocator

PRINCIPAL = ("principal_1", "principal_2", "principal_3")
SIGNED = ("xx", "yy", "zz", "xy", *PRINCIPAL, "radial", "hoop", "flux_x", "flux_y")
ROUNDING = 1e-9  # values that differ by this part of the largest magnitude are the same
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

    Values that differ by rounding only, measured by the magnitude `scale`, have levels about them.

    Stress peaks in re-entrant and clamped corners grow with every refinement and would leave one
    colour for the rest: beyond the middle 99 % stresses share the colours at the ends.
    """
    values = values[np.isfinite(values)]
    if quantity == "temperature":
        low, high = values.min(), values.max()
    else:
        low, high = np.percentile(values, (0.5, 99.5))
    if high - low <= ROUNDING * scale:
        room = 0.05 * scale or 0.5
        low, high = low - room, high + room
    elif quantity in SIGNED and low < 0.0 < high and min(-low, high) > 0.15 * max(-low, high):
        high = max(-low, high)
        low = -high
    return MaxNLocator(nbins=14, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)


def settle(values, levels, scale):
    """Return values with those that are at a level but for rounding put onto it."""
    nearest = levels[np.argmin(np.abs(values[:, None] - levels), axis=1)]
    return np.where(np.abs(values - nearest) <= ROUNDING * scale, nearest, values)


def colour_map(quantity, levels):
    """Return colours that the colour-blind can tell apart: about zero where values have both signs,
    else dark where the magnitude is small."""
    if quantity == "temperature":
        return "inferno"
    if abs(levels[0] + levels[-1]) <= 1e-9 * abs(levels[-1]):
        return "RdBu_r"
    return "viridis" if levels[-1] > -levels[0] else "viridis_r"


def overflow(values, levels):
    """Return which ends of the colour bar values run past."""
    slack = 1e-6 * (levels[-1] - levels[0])
    below, above = values.min() < levels[0] - slack, values.max() > levels[-1] + slack
    return [["neither", "max"], ["min", "both"]][int(below)][int(above)]


def draw_bar(axes, filled, levels, bodies, place):
    """Draw a colour bar of a panel; `place` is its number, from 0, and how many there are."""
    number, count = place
    bar = axes.figure.colorbar(filled, cax=axes.inset_axes(bar_place(axes, number, count)))
    bar.ax.tick_params(direction="out", width=0.4, length=2)
    bar.outline.set_linewidth(0.4)
    every = max(1, round(len(levels) / (8 if bar.ax.get_window_extent().height > 100 else 4)))
    steps = np.rint(levels / (levels[1] - levels[0])).astype(int)
    bar.set_ticks(levels[steps % every == 0])
    if count > 1:
        words = ", ".join(str(body) for body in sorted(bodies))
        bar.ax.set_title(f"bod{'y' if len(bodies) == 1 else 'ies'} {words}", fontsize=7, pad=6,
                         loc="left")


def bar_place(axes, number, count):
    """Return the place of a colour bar in fractions of the axes: beside them; several are one below
    the other, or, where the axes are wide, one beside the other."""
    width, height = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
    thick = 0.03 * max(width, height) / width
    if count == 1:
        return [1.0 + thick, 0.0, thick, 1.0]
    if width > WIDE * height:
        return [1.0 + thick + number * (thick + 0.12), 0.0, thick, 0.85]
    return [1.0 + thick, (count - 1 - number) / count, thick, 0.7 / count]
