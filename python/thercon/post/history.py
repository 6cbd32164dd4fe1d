"""Histories of sets of nodes and elements, pre-tension and reference nodes over time or load."""

import numpy as np

from . import style
from .errors import UserError, nearest_name
from .set_histories import chosen, label
from .style import plt
from .words import known_name

MOST_CURVES = 6  # of one panel; more are drawn as their range
OF_SEVERAL = "Of {}: lines are means, bands reach from the smallest to the largest value"


def draw(result, options):
    """Draw the history of every set asked for; return the files written."""
    found = chosen(result, options.set)
    kinds = {}
    for each in found:
        kinds.setdefault(each.name, set()).add(each.kind)
    wanted = chosen_quantities(result, found, options.quantity or ())
    pictures = [(each, [key for key in wanted or each.told() if key in each.values]) for each in found]
    written = []
    for each, keys in pictures:
        if not keys:
            continue
        parts = [each.name] if len(found) > 1 or options.set else []
        parts += [each.kind] if len(kinds[each.name]) > 1 else []
        parts += wanted + (["over", options.over] if options.over else [])
        figure = picture(result, each, keys, options.over)
        name = style.file_name(result, "history", *parts)
        written += style.write(figure, table(result, each, keys), options, name)
    return written


def chosen_quantities(result, found, wanted):
    """Return the names, in the file, of the quantities asked for."""
    known = list(dict.fromkeys(key for each in found for key in each.values))
    names = [known_name(name, known) for name in dict.fromkeys(wanted)]
    for name in names:
        if name not in known:
            raise UserError(f"{result.path}: has no history of '{name}'{nearest_name(name, known)}: "
                            f"there are {', '.join(known)}")
    return names


def picture(result, history, keys, over=None):
    """Return the figure of a set: a panel for each quantity."""
    columns = min(2, len(keys))
    rows = -(-len(keys) // columns)
    figure, grid = plt.subplots(
        rows, columns, sharex=True, layout="constrained", squeeze=False,
        figsize=(style.DOUBLE_COLUMN * (0.5 if columns == 2 else 0.62) * columns, 0.4 + 2.1 * rows))
    words, at = result.abscissa(over)
    at = at[history.increment - 1]
    ranges = False
    for number, (axes, key) in enumerate(zip(grid.flat, keys)):
        ranges |= panel(axes, at, history, key)
        unit = f" ({history.units[key]})" if history.units[key] else ""
        axes.set_ylabel(f"{label(key)}{unit}")
        style.panel_title(axes, "", chr(ord("a") + number) if number < 26 else "")
        if number >= len(keys) - columns:
            axes.set_xlabel(words)
            axes.tick_params(labelbottom=True)
    for axes in grid.flat[len(keys):]:
        axes.set_visible(False)
    members = next((axes.get_legend_handles_labels() for axes in grid.flat
                    if len(axes.get_legend_handles_labels()[0]) > 1), None)
    if members:  # the same in all panels
        figure.legend(*members, **style.BELOW, ncols=len(members[0]))
    note = f"{history.kind.capitalize()} of {style.plain(history.name)}"
    members = {"nodes": "the nodes", "elements": "the integration points", "run": "all"}[history.kind]
    note = history.name.capitalize() if history.kind == "run" else note
    figure.supxlabel(f"{note}\n{OF_SEVERAL.format(members)}" if ranges else note, fontsize=8.5)
    return figure


def panel(axes, at, history, key):
    """Draw one quantity; return whether the members are too many for a curve each, and differ."""
    curves = history.curves(key)
    marks = {"marker": "o", "ms": 2.4, "mfc": "white"} if len(at) <= 30 else {}
    if len(curves) > MOST_CURVES:
        values = history.values[key]
        known = np.isfinite(values).any(axis=1)
        style.band(axes, at[known], np.nanmin(values[known], axis=1),
                   np.nanmax(values[known], axis=1), style.BLACK)
        axes.plot(at[known], np.nanmean(values[known], axis=1), color=style.BLACK, **marks)
        return style.has_band(values[known])
    for number, (words, values) in enumerate(curves):
        known = np.isfinite(values)
        axes.plot(at[known], values[known], color=style.SERIES[number], label=words or None, **marks)
    return False


def table(result, history, keys):
    """Return what is drawn as columns, one for each quantity and member."""
    columns = {"increment": history.increment, "time": history.time,
               "load": result.history["load"][history.increment - 1]}
    for key in keys:
        for words, values in history.curves(key):
            columns[f"{key}_{words.split()[-1]}" if words else key] = values
    return columns
