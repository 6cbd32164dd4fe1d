"""Picture of a comparison: histories and profiles of both files, differences over the nodes."""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from .. import style
from ..style import plt
from ..units import Units
from ..words import number_text
from .judge import kind_of
from .report import quantities

MOST_PANELS = 9

LENGTHS = ("displacement", "place")


def draw(a, compared, options):
    """Return the figure of A against all B, [(label, blocks)], and what it shows as columns."""
    panels = panels_of(compared, options)
    columns = min(len(panels), 2 if len(panels) <= 4 else 3)
    rows = -(-len(panels) // columns)
    width = style.DOUBLE_COLUMN if columns > 1 else style.SINGLE_COLUMN * 1.3
    figure, axes = plt.subplots(
        rows, columns, squeeze=False, layout="constrained", figsize=(width, 0.4 + 2.3 * rows)
    )
    drawn = Drawn()
    for k, (place, (quantity, contact, only)) in enumerate(zip(axes.flat, panels)):
        panel = Panel(place, a, quantity, contact, options, drawn)
        for number, (label, blocks) in enumerate(compared):
            if only in (None, number):
                panel.add(number, label, [b for b in blocks if b.quantity == quantity and b.rows])
        shown = "" if only is None else short(compared[only][0])
        panel.finish("abcdefghi"[k] if len(panels) > 1 else "", shown)
    for place in axes.flat[len(panels) :]:
        place.set_axis_off()
    add_legend(figure, a, compared)
    return figure, drawn.columns


def panels_of(compared, options):
    """Return [(quantity, contact or None, number of the only B or None)]: those of --draw, else what
    differs most. Of several B, each has a map of its own."""
    panels = []
    for number, (_, blocks) in enumerate(compared):
        groups = quantities(blocks)
        if len(groups) > MOST_PANELS:
            groups = dict(sorted(groups.items(), key=lambda each: agreement(each[1])))
        for quantity, group in groups.items():
            if options.draw and quantity not in options.draw:
                continue
            contacts = [None]
            if "contact" in group[0].columns:
                found = np.unique(np.concatenate([b.columns["contact"] for b in group]))
                contacts = list(found) if len(found) > 1 else [None]
            only = number if len(compared) > 1 and is_map(group[0]) else None
            panels += [(quantity, c, only) for c in contacts if (quantity, c, only) not in panels]
    order = options.draw or list(dict.fromkeys(quantity for quantity, _, _ in panels))
    panels.sort(key=lambda each: order.index(each[0]))
    return panels[:MOST_PANELS]


def is_history(block):
    """Whether a block is drawn over its axis, which is time or load."""
    return block.at is None and block.axis in block.columns


def is_map(block):
    """Whether a block is drawn as differences over the plane."""
    return not (is_history(block) or "s" in block.columns or block.by == "curve")


def agreement(group):
    """Return what sorts quantities: beyond tolerance first, then by the largest difference."""
    shares = [np.max(b.difference, initial=0.0) / (b.largest or 1.0) for b in group]
    return all(block.passed for block in group), -max(shares)


class Drawn:
    """The points drawn, as columns of one table."""

    def __init__(self):
        names = ("panel", "file", "at", "abscissa", "x", "y", "value")
        self.columns = {name: [] for name in names}

    def add(self, panel, file, at, abscissa, x, value, y=None):
        """Add the points of one curve, or of one map."""
        for k, each in enumerate(np.asarray(value, dtype=float).tolist()):
            height = "" if y is None else float(y[k])
            at_ = "" if at is None else at
            points = (panel, file, at_, abscissa, float(x[k]), height, each)
            for column, entry in zip(self.columns.values(), points):
                column.append(entry)


class Panel:
    """One quantity."""

    def __init__(self, axes, a, quantity, contact, options, drawn):
        self.axes, self.a, self.quantity, self.contact = axes, a, quantity, contact
        self.options, self.drawn = options, drawn
        self.units = a.units or Units({})
        self.times, self.at = [], ""

    def add(self, number, label, blocks):
        """Draw the blocks of one B."""
        if not blocks:
            return
        if is_history(blocks[0]):
            self.draw_history(number, label, blocks[0])
            return
        times = self.options.at or [self.worst(blocks).at]
        chosen = [b for t in times for b in blocks if b.at is None or near(b.at, t)] or blocks[-1:]
        if is_map(blocks[0]):
            self.draw_differences(label, self.worst(chosen))
        else:
            self.draw_profiles(number, label, chosen)

    def worst(self, blocks):
        """Return the block with the largest difference."""
        return max(blocks, key=lambda block: float(np.max(block.difference)))

    def draw_history(self, number, label, block):
        """Draw A as a line and B as marks over time or load."""
        at = block.columns[block.axis]
        self.line(at, block.a, style.BLACK, number)
        x, y = block.curve if block.curve else (at, block.b)
        self.marks(x, y, style.SERIES[1 + number % 5], number)
        self.drawn.add(self.quantity, self.a.label, None, block.axis, at, block.a)
        self.drawn.add(self.quantity, label, None, block.axis, x, y)
        words = self.units.load_label(self.a.load_label) if block.axis == "load" else None
        self.axes.set_xlabel(words or block.axis.capitalize())

    def draw_profiles(self, number, label, blocks):
        """Draw profiles along the contact, one shade a time."""
        name = self.abscissa(blocks[0])
        shades = style.shades(len(blocks))
        for block, shade in zip(blocks, shades):
            rows = self.rows(block)
            at = block.columns[name][rows]
            x, y = block.curve if block.curve else (at, block.b[rows])
            self.line(at, block.a[rows], shade, number, steps=block.state)
            self.marks(x, y, style.SERIES[1 + number % 5], number)
            self.drawn.add(self.quantity, self.a.label, block.at, name, at, block.a[rows])
            self.drawn.add(self.quantity, label, block.at, name, x, y)
            if len(blocks) > 1 and number == 0:
                self.times.append((shade, f"{block.axis} {number_text(block.at)}"))
        if len(blocks) == 1 and blocks[0].at is not None:
            self.note(blocks[0])
        self.axes.set_xlabel(self.units.label(f"${name}$", "length"))

    def draw_differences(self, label, block):
        """Draw a - b over the plane, or over the numbers of the nodes where no places are known."""
        order = np.argsort(block.difference, kind="stable")  # the largest lie on top
        difference = (block.a - block.b)[order]
        if {"x", "y"} <= set(block.columns):
            x, y = block.columns["x"][order], block.columns["y"][order]
            size = float(np.nanmax(np.abs(difference), initial=0.0)) or 1.0
            looks = {"cmap": "RdBu_r", "vmin": -size, "vmax": size, "s": 7, "lw": 0.2}
            shown = self.axes.scatter(x, y, c=difference, edgecolors=style.GREY, **looks)
            bar = self.axes.figure.colorbar(shown, ax=self.axes, fraction=0.05)
            bar.set_label(self.units.label("A - B", unit(self.quantity)))
            across, up = np.ptp(x), np.ptp(y)
            if max(across, up) < 6.0 * min(across, up):
                self.axes.set_aspect("equal")
            self.axes.set_xlabel(self.units.label("$x$", "length"))
            self.axes.set_ylabel(self.units.label("$y$", "length"))
            self.drawn.add(self.quantity, label, block.at, "x, y: a - b", x, difference, y)
        else:
            key = next((k for k in ("node", "element") if k in block.columns), None)
            x = block.columns[key][order] if key else order
            self.marks(x, difference, style.VERMILION, 0)
            self.axes.set_xlabel(key or "row")
            self.axes.set_ylabel(self.units.label("A - B", unit(self.quantity)))
            self.drawn.add(self.quantity, label, block.at, f"{key}: a - b", x, difference)
        if block.at is not None:
            self.note(block)

    def abscissa(self, block):
        """Return the axis of a profile: x where it grows along the face, else s."""
        if self.options.along in block.columns:
            return self.options.along
        x = block.columns.get("x", np.zeros(2))[self.rows(block)] if "x" in block.columns else None
        if x is not None and (np.all(np.diff(x) > 0.0) or "s" not in block.columns):
            return "x"
        return "s"

    def rows(self, block):
        """Return the rows of this panel's contact."""
        if self.contact is None:
            return np.ones(block.rows, dtype=bool)
        return block.columns["contact"] == self.contact

    def line(self, x, y, colour, number, steps=False):
        """Draw a curve of A, once whatever it is compared with; states go in steps."""
        if steps:
            self.axes.yaxis.set_major_locator(MaxNLocator(integer=True))
        if number == 0 or not self.axes.lines:
            form = "steps-mid" if steps else "default"
            self.axes.plot(x, y, color=colour, zorder=3, drawstyle=form)

    def marks(self, x, y, colour, number):
        """Draw points of B."""
        looks = {"marker": style.marker(number), "mfc": "none", "mec": colour, "ls": "none"}
        self.axes.plot(x, y, zorder=2, clip_on=False, **looks)

    def note(self, block):
        """Name the time of what is shown."""
        self.at = f"{block.axis} {number_text(block.at)}"

    def finish(self, letter, only):
        """Label the ordinate, name quantity, times and the only B that is shown, if it is one."""
        words = [" ".join([self.quantity, self.contact or ""]).strip(), self.at, only]
        style.panel_title(self.axes, style.plain(", ".join(filter(None, words))), letter)
        if not self.axes.get_ylabel():
            self.axes.set_ylabel(self.units.label(style.plain(self.quantity), unit(self.quantity)))
        if self.times:
            handles = [Line2D([], [], color=colour, label=words) for colour, words in self.times]
            self.axes.legend(handles=handles, loc="best")


def near(first, second):
    """Whether two times are the same."""
    return abs(first - second) <= 1e-6 * max(abs(first), abs(second), 1e-300)


def unit(quantity):
    """Return the kind of unit of a quantity, None where it has none here."""
    kind = kind_of(quantity)
    return "length" if kind in LENGTHS else kind


def add_legend(figure, a, compared):
    """Name the files below the panels."""
    handles = [Line2D([], [], color=style.BLACK, label=f"A: {style.plain(short(a.label))}")]
    for number, (label, _) in enumerate(compared):
        looks = {"marker": style.marker(number), "mfc": "none", "ls": "none"}
        looks["mec"] = style.SERIES[1 + number % 5]
        handles.append(Line2D([], [], label=f"B: {style.plain(short(label))}", **looks))
    figure.legend(handles=handles, **style.BELOW, ncols=min(len(handles), 4))


def short(label):
    """Return the name of a file without its folders."""
    return label.replace("\\", "/").rpartition("/")[2]
