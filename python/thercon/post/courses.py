"""Courses over time or load: pressure, gap and temperatures of the faces, heat of the whole model."""

from string import ascii_lowercase

import numpy as np

from . import style
from .errors import UserError
from .result import MARKED
from .style import plt

LABELS = {
    "pressure": ("Pressure $p$", "stress"),
    "force": ("Force", "force"),
    "gap": ("Gap", "length"),
    "worn": ("Worn volume", "volume"),
    "temperature": ("Temperature of the faces", "temperature"),
    "heat": ("Heat rate", "power"),
}
HEAT = {"heat_in": "into the model", "heat_friction": "of friction", "heat_out": "out of the model",
        "heat_stored": "stored", "heat_dilatation": "taken up by strains"}
FORCES = {"normal_force": "normal", "shear_force": "of friction"}   # of faces that slide
WORN = {"worn_volume_slave": "slave", "worn_volume_master": "master"}
FACES = {"slave_temperature": "slave", "master_temperature": "master"}
MEANS = "Lines are means over {}"
BANDS = ", bands reach from the smallest to the largest value"
DECADES = 1e-3  # of the largest heat rate, the smallest that a logarithmic axis shows
ORDER = {"master": 1, "out of the model": 1, "stored": 2, "through the contact": 3,
         "sum over the interfaces": 3,
         "taken up by strains": 4, "of friction": 5}
RIGHT_ABOVE = {"loc": "lower right", "bbox_to_anchor": (1.02, 0.98)}  # on curves it would hide them
COLUMNS, LEGEND_LINE = 2, 0.14  # of a legend; height of a line of it, in inches
NOTHING = 1e-6  # of the largest of a panel: curves below it are not drawn
LOOKS = [  # dashes show what lies below them
    (style.BLACK, "-"),
    (style.BLUE, (0, (4, 1.5))),
    (style.VERMILION, (0, (2, 2))),
    (style.GREEN, "-."),
    (style.ORANGE, ":"),
    (style.SKY, (0, (6, 2))),
]


def draw(result, options):
    """Draw the courses of every contact asked for; return the files written."""
    written = []
    for contact in result.contacts(options.contact):
        picture = Picture(result, contact, options.log, options.over)
        parts = [contact.name] if len(result.contact_names) > 1 else []
        parts += ["log"] * options.log + (["over", options.over] if options.over else [])
        name = style.file_name(result, "courses", *parts)
        written += style.write(picture.draw(), picture.table(), options, name)
    return written


class Picture:
    """The courses of one contact and of the model."""

    def __init__(self, result, contact, log=False, over=None):
        if result.increments == 0:
            raise UserError(f"{result.path}: holds no accepted increment")
        self.result, self.contact, self.log = result, contact, log
        self.label, self.at = result.abscissa(over or ("time" if log else None))
        self.panels = self.present()

    def present(self):
        """Return the curves of each panel that has some: panel -> [(label, values)], values (n) or,
        over the points of the face, (n, m)."""
        panels = {"pressure": [("", self.contact.get("pressure"))]}
        if self.contact.slides:
            panels["force"] = [(words, self.contact.get(key)) for key, words in FORCES.items()]
        panels["gap"] = [("", self.contact.get("gap"))]
        panels["worn"] = [(words, self.contact.get(key)) for key, words in WORN.items()]
        panels["temperature"] = [(words, self.contact.get(key)) for key, words in FACES.items()]
        heat = [(words, self.result.history.get(key)) for key, words in HEAT.items()]
        through = "through the contact" if not self.contact.parts else "sum over the interfaces"
        panels["heat"] = [*heat, (through, self.contact.get("heat_rate"))]
        panels = {name: seen(curves) for name, curves in panels.items()}
        if self.result.is_of_heat:
            panels = {name: panels[name] for name in ("temperature", "heat", *panels)}
        return {name: curves for name, curves in panels.items() if curves}

    def draw(self):
        """Return the finished figure: two panels a row, one axis of time or load."""
        rows = -(-len(self.panels) // 2)
        columns = min(2, len(self.panels))
        legends = [-(-len(curves) // COLUMNS) * has_names(curves) for curves in self.panels.values()]
        above = sum(max(legends[row : row + 2]) for row in range(0, len(legends), 2))
        figure, grid = plt.subplots(
            rows, columns, sharex=True, layout="constrained", squeeze=False,
            figsize=(style.DOUBLE_COLUMN * 0.5 * columns, 0.4 + 2.1 * rows + LEGEND_LINE * above),
        )
        for axes, (name, curves), letter in zip(grid.flat, self.panels.items(), ascii_lowercase):
            if name == "heat" and self.log:
                curves = sizes(curves)
                self.spread(axes, curves)
            self.draw_panel(axes, curves)
            words, quantity = LABELS[name]
            axes.set_ylabel(self.result.units.label(words, quantity))
            style.mark_judged(axes, self.at, self.result.judged)
            style.panel_title(axes, "", letter)
        for axes in grid.flat[len(self.panels):]:
            axes.set_visible(False)
        for column in range(columns):
            lowest = [row for row in range(rows) if grid[row, column].get_visible()][-1]
            grid[lowest, column].set_xlabel(self.label)
            grid[lowest, column].tick_params(labelbottom=True)
        first = self.at[self.at > 0.0].min(initial=self.at[-1])
        if self.log and first < self.at[-1]:
            style.log_abscissa(grid[0, 0], first, self.at[-1])
        words = [self.words_below(), "" if self.result.judged.all() else MARKED]
        figure.supxlabel("\n".join(filter(None, words)), fontsize=8.5)
        return figure

    def words_below(self):
        """Return what lines and bands are, as far as there are some."""
        of_faces = [values for curves in self.panels.values() for _, values in curves
                    if values.ndim == 2]
        if not of_faces:
            return ""
        faces = "the faces of all these interfaces" if self.contact.parts else "the face"
        return MEANS.format(faces) + (BANDS if any(map(style.has_band, of_faces)) else "")

    def draw_panel(self, axes, curves):
        """Draw curves: the mean over the face and a band of its range."""
        for words, values in curves:
            colour, line = LOOKS[ORDER.get(words.strip("|\N{MINUS SIGN}"), 0)]
            if values.ndim == 2:
                style.band(axes, self.at, *ends(values), colour)
            axes.plot(self.at, self.mean(values), color=colour, ls=line, label=words or None,
                      marker="o" if len(self.at) == 1 else "", ms=2.4)
        if has_names(curves):
            axes.legend(**RIGHT_ABOVE, ncols=COLUMNS, handlelength=1.8, columnspacing=1.2)
        low, high = axes.get_ylim()
        if low < 0.0 and all(np.nanmin(values) >= -1e-6 * high for _, values in curves):
            axes.set_ylim(0.0, high)

    @staticmethod
    def spread(axes, curves):
        """Show rates by their logarithm: a shock begins with a power of time."""
        high = max(np.nanmax(values) for _, values in curves)
        axes.set(yscale="log", ylim=(DECADES * high, 1.5 * high))
        style.log_ticks(axes.yaxis, DECADES * high, 1.5 * high)

    def mean(self, values):
        """Return the mean of values over the face, by the areas of its contact points; those without
        a master have no gap."""
        if values.ndim == 1:
            return values
        weight = np.where(np.isnan(values), 0.0, self.contact["weight"])
        whole = weight.sum(axis=1)
        return np.divide(np.nansum(values * weight, axis=1), whole, out=np.full(len(values), np.nan),
                         where=whole > 0.0)

    def table(self):
        """Return the curves as columns, means and ranges over the face."""
        columns = {"increment": np.arange(1, len(self.at) + 1)}
        columns |= {key: self.result.history[key] for key in ("time", "load")}
        for name, curves in self.panels.items():
            for words, values in curves:
                key = "_".join([name, *words.split()])
                columns[key] = self.mean(values)
                if values.ndim == 2:
                    columns |= dict(zip((f"{key}_min", f"{key}_max"), ends(values)))
        return columns


def has_names(curves):
    """Whether a legend tells curves apart, or what the only one is of."""
    return any(words for words, _ in curves)


def ends(values):
    """Return the smallest and the largest value of each row, NaN where it has none."""
    return np.fmin.reduce(values, axis=1), np.fmax.reduce(values, axis=1)


def seen(curves):
    """Return the curves that are in the file and differ from zero beside the others."""
    curves = [(words, np.asarray(values, float)) for words, values in curves
              if values is not None and np.isfinite(values).any()]
    sizes = [np.nanmax(np.abs(values)) for _, values in curves]
    least = NOTHING * max(sizes, default=0.0)
    return [curve for curve, size in zip(curves, sizes) if size > least]


def sizes(curves):
    """Return the sizes of rates for a logarithmic axis, which their labels tell, without those that
    lie below it."""
    found, least = [], DECADES * max(np.nanmax(np.abs(values)) for _, values in curves)
    for words, values in curves:
        is_negative, is_positive = np.nanmin(values) < -least, np.nanmax(values) > least
        if is_negative:
            words = f"|{words}|" if is_positive else f"\N{MINUS SIGN}{words}"
        if is_negative or is_positive:
            found.append((words, np.abs(values)))
    return found
