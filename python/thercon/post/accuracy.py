"""A requested accuracy: the uncertainty over each target, against the cost of the rounds."""

import numpy as np

from . import style
from .errors import UserError
from .result import words_of
from .style import plt
from .tables import stack_tables

SMALLEST = 1e-3  # of a target: smaller ones are marked at the foot, missing ones at the top


def draw(result, options):
    """Draw the rounds of a result; return the files written."""
    rounds = result.accuracy
    if rounds is None:
        raise UserError(f"{result.path}: no accuracy was requested (*ACCURACY, --accuracy), or its "
                        "first round did not come to its end")
    cost = np.cumsum(rounds["cpu_seconds"])
    series = list(targets(result, rounds))
    if not series:
        raise UserError(f"{result.path}: no quantity has a target")
    figure, axes = plt.subplots(
        figsize=(style.DOUBLE_COLUMN * 0.62, 3.2), layout="constrained"
    )
    tables, marks = [], {}
    for number, (name, rows, unit) in enumerate(series):
        value, uncertainty, allowed = rows[:, 1], rows[:, 2], rows[:, 3]
        is_there = rows[:, 0] > 0
        ratio = np.divide(uncertainty, allowed, out=np.full(len(cost), np.nan), where=is_there)
        is_missing = is_there & np.isnan(uncertainty)
        label = f"{name}, target {target_words(allowed[is_there][-1], unit)}"
        label += missing_words(is_missing)
        marks |= draw_target(axes, cost, ratio, is_missing, number, label)
        table = {"target": np.full(len(cost), name, dtype=object), "cpu_seconds": cost}
        table |= {"unknowns": rounds["unknowns"], "value": value}
        tables.append(table | {"uncertainty": uncertainty, "allowed": allowed})
    axes.axhline(1.0, color=style.GREY, lw=0.8, ls="--", label="target")
    for words, mark in marks.items():
        axes.plot([], [], mark, color=style.GREY, ms=4, mfc="none", label=words)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(style.decade(cost))
    for axis in (axes.xaxis, axes.yaxis):
        style.log_ticks(axis, *sorted(axis.get_view_interval()))
    axes.set_xlabel("CPU time of all rounds, s")
    axes.set_ylabel("uncertainty (95 %) / target")
    figure.legend(**style.BELOW, ncols=2, fontsize=7)
    name = style.file_name(result, "accuracy")
    return style.write(figure, stack_tables(tables), options, name)


def draw_target(axes, cost, ratio, is_missing, number, label):
    """Draw the rounds of one target; its entry in the legend shows a curve, lone points or the marks
    of a border, as the picture does. Return what these marks mean."""
    colour = style.SERIES[number % len(style.SERIES)]
    is_below = ratio < SMALLEST
    shown = np.where(is_below, np.nan, ratio)
    count = np.isfinite(shown).sum()
    axes.plot(cost, shown, color=colour, marker=style.marker(number), ms=3.5, lw=0.9,
              ls="solid" if count > 1 else "none", label=label if count else None)
    label, marks = None if count else label, {}
    for words, mark, rounds, height, transform in (
            ("below the scale", "v", is_below, SMALLEST, axes.transData),
            ("no estimate", "^", is_missing, 1.0, axes.get_xaxis_transform())):
        if rounds.any():
            axes.plot(cost[rounds], np.full(rounds.sum(), height), mark, color=colour, clip_on=False,
                      ms=4 + 2 * number, mfc="none", transform=transform, label=label)
            label, marks[words] = None, mark
    return marks


def missing_words(is_missing):
    """Return in which rounds there is no estimate, in words."""
    if not is_missing.any():
        return ""
    if is_missing.all():
        return " (no estimate)"
    return f" (no estimate in round {', '.join(map(str, np.flatnonzero(is_missing) + 1))})"


def target_words(allowed, unit):
    """Return what the target of the last round allows, in words."""
    return f"{style.number_words(float(f'{allowed:.2g}'))} {unit}".rstrip()


def targets(result, rounds):
    """Yield name, rows (step, value, uncertainty, target) and unit of each quantity there."""
    for contact in result.contacts():
        for quantity, rows in rounds["uncertainty"].get(contact.name, {}).items():
            if np.any(rows[:, 0] > 0):
                yield f"{style.plain(contact.name)} {style.plain(words_of(quantity))}", rows, contact.unit(quantity)
