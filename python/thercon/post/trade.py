"""Speed against accuracy: the rows of `thercon trade` as errors over CPU seconds."""

import csv
from pathlib import Path
from string import ascii_lowercase

import numpy as np
from matplotlib.lines import Line2D

from . import style
from .errors import UserError
from .result import words_of
from .style import plt

NEEDED = ["row", "default", "elements", "level", "contact_level", "increment_factor", "varied"]
NEEDED += ["status", "pareto", "cpu_seconds", "error_worst"]
LOCAL = "D"  # meshes that are finer at the contact
SMALLEST = 1e-6  # percent: errors below it are marked at the foot
BEYOND = 3.0
COLUMNS = 3


class Trade:
    """The table of one trade."""

    def __init__(self, path):
        path = Path(path)
        self.name = path.name.removesuffix(".csv").removesuffix(".trade")
        try:
            with open(path, newline="", encoding="utf-8") as file:
                table = list(csv.DictReader(file))
        except (OSError, UnicodeDecodeError, csv.Error) as reason:
            raise UserError(f"{path}: cannot be read ({reason})") from None
        missing = [name for name in NEEDED if not table or name not in table[0]]
        if missing:
            raise UserError(f"{path}: no table of thercon trade: no column {missing[0]}")
        self.uncertainty = next((row for row in table if row["row"] == "reference"), {})
        table = [row for row in table if row["row"] != "reference"]
        self.failed = [row for row in table if row["status"] != "0"]
        self.rows = [row for row in table if row["status"] == "0"]
        if not any(row["error_worst"] for row in self.rows):
            raise UserError(f"{path}: no row has an error: there is nothing to draw")

    def panels(self):
        """Return the columns that hold errors on the scale, the worst of all first."""
        names = [name for name in self.known() if name not in self.exact()]
        return sorted(names, key=lambda name: name != "error_worst")

    def exact(self):
        """Return the columns without a panel: all of their errors are below the scale."""
        found = {name: [row[name] for row in [*self.rows, self.uncertainty] if row.get(name)]
                 for name in self.known() if name != "error_worst"}
        return [name for name, texts in found.items() if all(map(is_below, texts))]

    def known(self):
        """Return the columns that hold errors."""
        names = [name for name in self.rows[0] if name.startswith("error_")]
        return [name for name in names if any(row[name] for row in self.rows)]

    def best(self):
        """Return CPU seconds and worst errors, in percent, of the Pareto-optimal rows; nothing
        where they make no curve on the scale."""
        found = sorted((float(row["cpu_seconds"]), percent(row["error_worst"]))
                       for row in self.rows if row["pareto"] == "1")
        return found if len(found) > 1 and found[0][1] > SMALLEST else []


def draw(path, options):
    """Draw a table; return the files written."""
    trade = Trade(path)
    return style.write(figure_of(trade), None, options, f"{trade.name}.trade")


def figure_of(trade):
    """Return the figure of a trade: a panel a quantity."""
    panels = trade.panels()
    rows = -(-len(panels) // COLUMNS)
    figure, axes = plt.subplots(
        rows, COLUMNS, figsize=(style.DOUBLE_COLUMN, 2.1 * rows + 0.5), sharex=True, squeeze=False,
        layout="constrained",
    )  # fmt: skip
    for number, (name, panel) in enumerate(zip(panels, axes.flat, strict=False)):
        draw_panel(panel, trade, name)
        style.panel_title(panel, quantity_words(name), ascii_lowercase[number])
    for panel in axes.flat[len(panels) :]:
        panel.set_axis_off()
    times = style.decade([float(row["cpu_seconds"]) for row in trade.rows])
    for number, panel in enumerate(axes.flat[: len(panels)]):
        panel.set_xlim(*times)
        style.log_ticks(panel.xaxis, *times)
        panel.tick_params(labelbottom=True)
        if number >= len(panels) - COLUMNS:
            panel.set_xlabel("CPU time, s")
    for line in axes:
        line[0].set_ylabel("error, %")
    exact = ", ".join(quantity_words(name) for name in trade.exact())
    exact = exact and f"no panel, all errors below {style.number_words(SMALLEST)} %: {exact}"
    figure.legend(handles=legend(trade), **style.BELOW, ncols=5, title=exact,
                  title_fontsize=7.5)
    return figure


def quantity_words(name):
    """Return what the errors of a column are of."""
    return "worst of all" if name == "error_worst" else style.plain(words_of(name.removeprefix("error_")))


def draw_panel(axes, trade, name):
    """Draw the errors of one quantity; other methods far above the rest are marked at the frame."""
    levels = sorted({int(row["level"]) for row in trade.rows})
    colours = dict(zip(levels, style.shades(max(len(levels), 2)), strict=False))
    low, high = ordinates(trade, name)
    for row in trade.rows:
        if not row[name]:
            continue
        below = is_below(row[name])
        at = float(row["cpu_seconds"]), low if below else percent(row[name])
        if row["varied"]:
            mark, at = ("x", at) if at[1] <= high else ("^", (at[0], high))
            mark = "v" if below else mark
            axes.plot(*at, mark, color=style.GREY, ms=3, zorder=2, clip_on=mark == "x")
            continue
        factor = float(row["increment_factor"])
        axes.plot(
            *at, "v" if below else shape(row), clip_on=not below, color=colours[int(row["level"])],
            ms=3.2 - 0.5 * np.log2(factor), mfc="none" if factor > 1 else None, zorder=3,
        )  # fmt: skip
        if row["default"] == "1":
            axes.plot(*at, "o", ms=9, mfc="none", mec=style.VERMILION, mew=0.9, zorder=4,
                      clip_on=False)  # fmt: skip
    if name == "error_worst" and trade.best():
        best = [(seconds, max(error, low)) for seconds, error in trade.best()]
        axes.step(*zip(*best, strict=True), where="post", color=style.BLUE, lw=0.8, zorder=1)
    if trade.uncertainty.get(name) and is_below(trade.uncertainty[name]):
        words = f"uncertainty below {style.number_words(SMALLEST)} %"
        axes.text(0.97, 0.03, words, transform=axes.transAxes, ha="right", va="bottom", fontsize=6,
                  color=style.GREY)  # fmt: skip
    elif trade.uncertainty.get(name):
        axes.axhline(percent(trade.uncertainty[name]), color=style.GREY, lw=0.7, ls="--", zorder=1)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    style.log_ticks(axes.yaxis, low, high)


def ordinates(trade, name):
    """Return the range of a panel.

    A method whose error is more than BEYOND times that of every mesh and increment does not stretch
    it.
    """
    values = {True: [], False: []}
    for row in trade.rows:
        if row[name] and not is_below(row[name]):
            values[bool(row["varied"])].append(percent(row[name]))
    usual = values[False] or values[True] or [SMALLEST]
    shown = usual + [value for value in values[True] if value <= BEYOND * max(usual)]
    if trade.uncertainty.get(name) and not is_below(trade.uncertainty[name]):
        shown.append(percent(trade.uncertainty[name]))
    return style.decade(shown)


def is_beyond(trade, name):
    """Whether the panel of a quantity leaves out another method."""
    _, high = ordinates(trade, name)
    return any(row["varied"] and row[name] and percent(row[name]) > high for row in trade.rows)


def is_below(text):
    """Whether a relative error is below what is drawn."""
    return 100 * float(text) < SMALLEST


def shape(row):
    """Return the marker of a row of the grid; that of its elements tells whether all have nodes on
    their sides."""
    if row["contact_level"] != "0":
        return LOCAL
    return "s" if set(row["elements"].split("+")) & {"Q4", "Q4I", "T3"} else "o"


def percent(text):
    """Return a relative error in percent, not below what is drawn."""
    return max(100 * float(text), SMALLEST)


def legend(trade):
    """Return the handles of the legend."""
    levels = sorted({int(row["level"]) for row in trade.rows})
    colours = dict(zip(levels, style.shades(max(len(levels), 2)), strict=False))

    def handle(label, **look):
        return Line2D([], [], **({"ls": "none", "color": "black", "ms": 4} | look), label=label)

    handles = [
        handle(row["elements"], marker=shape(row))
        for row in {row["elements"]: row for row in trade.rows if row["contact_level"] == "0"}.values()
    ]
    if any(row["contact_level"] != "0" for row in trade.rows):
        handles.append(handle("finer at the contact", marker=LOCAL))
    handles += [handle(f"mesh / {2**k}", marker="o", color=colours[k]) for k in levels]
    handles.append(handle("longer increments", marker="o", mfc="none"))
    if any(row["varied"] for row in trade.rows):
        handles.append(handle("other method", marker="x", color=style.GREY))
        if any(is_beyond(trade, name) for name in trade.panels()):
            handles.append(handle("off the scale", marker="^", color=style.GREY))
    if any(row[name] and is_below(row[name]) for row in trade.rows for name in trade.panels()):
        handles.append(handle("below the scale", marker="v"))
    handles.append(handle("deck as written", marker="o", ms=8, mfc="none", color=style.VERMILION))
    if trade.best():
        handles.append(handle("Pareto-optimal", ls="-", color=style.BLUE))
    known = (trade.uncertainty.get(name) for name in trade.panels())
    if any(text and not is_below(text) for text in known):
        handles.append(handle("uncertainty of the reference", ls="--", color=style.GREY))
    if trade.failed:
        handles.append(handle(f"failed, not drawn: {len(trade.failed)}", alpha=0))
    return handles
