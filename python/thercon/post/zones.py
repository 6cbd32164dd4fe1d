"""The zone diagram (Fig. 3 of the paper): open, slip and stick against the load."""

from pathlib import Path
from string import ascii_lowercase

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from . import style
from .edge_curves import edge_curves
from .errors import UserError
from .overlay import axis_words, file_parts, read_overlays
from .result import MARKED, OPEN, SLIP, STICK
from .style import plt
from .tables import stack_tables, write_table
from .zone_names import CURVES, name_regions
from .zone_rows import Rows

PASSED_OVER = ("increment", "time", "s_edge_contact", "s_edge_stick")
NAMES = {OPEN: ("I", "open"), SLIP: ("II", "slip"), STICK: ("III", "stick")}
CURVE_NAMES = {"edge_contact": "edge of contact", "edge_stick": "edge of stick"}
LINES = {"edge_contact": "solid", "edge_stick": (0, (3.5, 1.5))}
WIDTHS = {"edge_contact": 1.0, "edge_stick": 1.8}  # dashes are seen where they lie on the other
TINTS = ("#FFFFFF", "#DCE8F2", "#FBE9C8")  # of open, slip, stick
FILLS = ("#DEDEDE", "#7FB2D9", style.ORANGE)  # white is where no interface is


def draw(results, options):
    """Draw the zone diagram of every contact asked for, of several results side by side; return the
    files written."""
    written = []
    overlays = read_overlays(options.figures, "load", CURVES, PASSED_OVER)
    first, further = results[0], [result.name for result in results[1:]]
    for contact in first.contacts(options.contact):
        pictures = [picture_of(result, contact.name, options) for result in results]
        figure = pictures[0].draw(overlays) if not further else draw_beside(pictures, overlays)
        parts = [contact.name] if len(first.contact_names) > 1 else []
        parts += ["log"] * options.log + axis_words(options.along)
        parts += file_parts(options.figures) + further
        name = style.file_name(first, "zones", *parts)
        written += style.write(figure, tables_of(pictures, "table"), options, name)
        if options.csv:
            written.append(Path(options.out) / f"{style.file_name(first, 'zones', *parts, 'pairs')}.csv")
            write_table(written[-1], tables_of(pictures, "pair_table"))
    return written


def picture_of(result, name, options):
    """Return the diagram of one contact of a result."""
    contact = result.contact(name)
    if contact.overlap(options.along):
        rows = Rows(contact, options.along)
        return Picture(result, contact, rows.along, rows.places, options.log, rows)
    return Picture(result, contact, *contact.axis(options.along), options.log)


def tables_of(pictures, kind):
    """Return the columns of one diagram, or of several with the names of their results; None where
    a diagram has no such table."""
    tables = [getattr(picture, kind)() for picture in pictures]
    if None in tables:
        return None
    if len(tables) == 1:
        return tables[0]
    names = [np.full(len(table["load"]), picture.result.name, dtype=object)
             for picture, table in zip(pictures, tables)]
    return stack_tables([{"result": name} | table for name, table in zip(names, tables)])


def draw_beside(pictures, overlays):
    """Return a figure with a panel for each result, on one scale of places."""
    first = pictures[0]
    for picture in pictures[1:]:
        if (first.rows and first.rows.labels()) != (picture.rows and picture.rows.labels()):
            raise UserError(f"{picture.result.path}: the interfaces '{first.contact.name}' are not "
                            f"those of {first.result.path}: draw it alone")
    width, height = first.size(2.05 * len(pictures))
    figure, panels = plt.subplots(
        1, len(pictures), sharey=True, layout="constrained", squeeze=False,
        figsize=(0.9 + width, height),
    )
    handles = {}
    drawn = [picture.draw_panel(axes, overlays) for picture, axes in zip(pictures, panels[0])]
    low, high = np.transpose([picture.window(each) for picture, each in zip(pictures, drawn)])
    window = low.min(), high.max()
    parts = {picture.settle(axes, window) for picture, axes in zip(pictures, panels[0])}
    for picture, axes, letter in zip(pictures, panels[0], ascii_lowercase):
        style.panel_title(axes, style.plain(picture.result.name), letter)
        for handle in picture.legend_handles(overlays):
            handles.setdefault(handle.get_label(), handle)
        axes.label_outer()
        if len(parts) == 1 and axes is not panels[0][len(pictures) // 2]:
            axes.set_xlabel(picture.abscissa_label)  # one panel says for all what they leave out
        axes.set_xlabel(axes.get_xlabel().replace("; ", "\n"))
    figure.legend(handles=list(handles.values()), **style.BELOW, ncols=3,
                  columnspacing=1.4)
    for picture, axes in zip(pictures, panels[0]):
        if not picture.is_joined:
            name_regions(picture, axes)
    return figure


class Picture:
    """The diagram of one contact, or of several interfaces: along a common coordinate, or in rows."""

    def __init__(self, result, contact, along, coordinate, log=False, rows=None):
        if result.increments == 0:
            raise UserError(f"{result.path}: holds no accepted increment")
        self.result, self.contact = result, contact
        self.along, self.coordinate, self.log = along, coordinate, log
        self.is_joined = bool(contact.parts)  # its many edges would hide its zones
        self.rows = rows
        load = result.history["load"]
        rising = bool(np.all(np.diff(load) > 0.0) or np.all(np.diff(load) < 0.0))
        self.rising = rising
        # A load that turns would draw loading and unloading over each other.
        self.abscissa = load if rising else result.history["time"]
        self.abscissa_label = (result.units.load_label(result.load_label) if rising
                               else result.units.label("Time", "time"))
        least = int(np.argmin(self.abscissa))
        if log and self.abscissa[least] <= 0.0:
            raise UserError(
                f"{result.path}: increment {least + 1} is at {self.abscissa[least]:g}, which a "
                "logarithmic axis does not have: leave --log out"
            )
        self.status = contact["status"]
        self.curves = {
            key: [(rows, contact.edge_on_axis(places, coordinate)) for rows, places in
                  edge_curves(contact, key[5:])]
            for key in CURVES
        }
        frictionless = contact.friction == 0.0 or contact.get("shear") is None
        self.names = NAMES | ({SLIP: ("II", "contact")} if frictionless else {})

    def edges(self, key):
        """Return sharpened edges, (n) or (n, 4), on the axis of the picture."""
        return self.contact.edge_on_axis(self.contact[key], self.coordinate)

    def draw(self, overlays):
        """Return the finished figure, with digitised figures laid over."""
        figure, axes = plt.subplots(
            layout="constrained", figsize=self.size(style.SINGLE_COLUMN * 1.25)
        )
        self.settle(axes, self.window(self.draw_panel(axes, overlays)))
        figure.legend(
            handles=self.legend_handles(overlays),
            **style.BELOW,
            ncols=3,
            columnspacing=1.4,
        )
        if not self.is_joined:
            name_regions(self, axes)
        return figure

    def size(self, width):
        """Return width and height of a figure whose panels are as wide as given."""
        return self.rows.size(width) if self.rows else (width, style.SINGLE_COLUMN)

    def draw_panel(self, axes, overlays):
        """Draw zones, states and curves; return the places of the digitised figures laid over."""
        if overlays and self.is_joined:
            raise UserError(f"--with {overlays[0].label}: several interfaces have no curves to lay it "
                            "over: name one with --contact")
        if overlays and not self.rising:
            raise UserError(
                f"{self.result.path}: the load turns: no digitised figure fits over time"
            )
        self.draw_zones(axes)
        style.mark_judged(axes, self.abscissa, self.result.judged)
        if self.is_joined:
            return np.array([])
        self.draw_states(axes)
        for key in CURVES:
            self.draw_edges(axes, key)
        drawn = [
            overlay.plot(axes, "load", key, LINES[key]) for overlay in overlays for key in CURVES
        ]
        return np.concatenate([[], *drawn])

    def settle(self, axes, window):
        """Set ranges and labels of the axes; return what the label says of the rest of the face and
        of the increments that are marked."""
        if self.rows:
            self.rows.name(axes, self.result.units)
        else:
            axes.set_ylabel(self.result.units.label(f"${self.along}$", "length"))
        low, high = limits(np.log10(self.abscissa) if self.log else self.abscissa)
        if self.log:
            style.log_abscissa(axes, 10.0**low, 10.0**high)
        else:
            axes.set_xlim(0.0 if self.starts_near_zero(low) else low, high)
        if len(self.abscissa) == 1:
            axes.set_xticks(self.abscissa)
        axes.set_ylim(window)
        unit = self.result.units.names.get("length", "")
        part = self.contact.part_words(self.coordinate, window, unit)
        part += "" if self.result.judged.all() else f"\n{MARKED}"
        axes.set_xlabel(f"{self.abscissa_label}\n{part}".rstrip())
        return part

    def starts_near_zero(self, low):
        """Whether zero is next to the first value of the abscissa, and not above the axis' start."""
        first, last = np.min(self.abscissa), np.max(self.abscissa)
        return 0.0 < low and first <= 3.0 * (last - first) / max(len(self.abscissa) - 1, 1)

    def window(self, drawn):
        """Return the range of the ordinate: what contact has and digitised figures have."""
        if self.rows:
            return self.rows.window
        low, high = self.contact.window(self.coordinate)
        low, high = np.min(drawn, initial=low), np.max(drawn, initial=high)
        room = 0.025 * (high - low)
        return low - room, high + room

    def draw_zones(self, axes):
        """Tint the increments at which all points of a piece are closed alike: no edge inside shows
        these; of several interfaces every contact point, as wide as half-way to the next ones."""
        load = between(self.abscissa)
        if self.log:
            load = 10.0 ** between(np.log10(self.abscissa))
        if len(self.abscissa) > 1:
            load = np.clip(load, self.abscissa.min(), self.abscissa.max())
        looks = {"norm": BoundaryNorm([-0.5, 0.5, 1.5, 2.5], 3), "zorder": 0}
        for piece in self.contact.pieces:
            status = self.status[:, piece]
            if self.is_joined:
                at = self.coordinate[piece]
                places = np.clip(between(at), at.min(), at.max())
                # Dots have no light seams, and hide nothing of the narrow fields at the ends.
                axes.pcolormesh(load, places, status.T, cmap=ListedColormap(FILLS), rasterized=True,
                                **looks)
                continue
            alike = self.alike(piece)
            if not np.any(alike):
                continue
            axes.pcolormesh(
                load,
                between(self.coordinate[piece])[[0, -1]],
                alike[None, :],
                cmap=ListedColormap(TINTS),
                linewidth=0.15,
                edgecolors="face",  # no light seams
                **looks,
            )

    def alike(self, piece):
        """Return the state that all points of a piece have at each increment; OPEN where they differ."""
        status = self.status[:, piece]
        return np.where((status == status[:, :1]).all(axis=1), status[:, 0], OPEN)

    def draw_states(self, axes):
        """Draw the raw state of every pair as a small mark behind the curves."""
        load, place = np.meshgrid(self.abscissa, self.coordinate, indexing="ij")
        for state, marker, options in state_marks():
            there = self.status == state
            axes.plot(load[there], place[there], marker, ls="none", zorder=1, **options)

    def draw_edges(self, axes, key):
        """Draw the sharpened edges of a kind: a curve for each, a short line for one that is there
        at a single increment."""
        for rows, places in self.curves[key]:
            looks = {"linestyle": LINES[key], "lw": WIDTHS[key]}
            if len(rows) == 1:
                looks = {"marker": "_", "ms": 4, "mew": WIDTHS[key]}
            axes.plot(self.abscissa[rows], places, color="black", zorder=3, **looks)

    def legend_handles(self, overlays):
        """Return the legend's entries: curves, pair states, digitised figures; of several interfaces
        their zones."""
        if self.is_joined:
            return [Patch(facecolor=FILLS[state], edgecolor="black", lw=0.4,
                          label=" ".join(self.names[state]))
                    for state in self.names if np.any(self.status == state)]
        handles = [
            Line2D([], [], color="black", ls=LINES[key], lw=WIDTHS[key], label=CURVE_NAMES[key])
            for key in CURVES
            if self.curves[key]
        ]
        handles += [
            Line2D(
                [], [], ls="none", marker=marker, label=self.point_words(state), **options
            )
            for state, marker, options in state_marks()
            if np.any(self.status == state)
        ]
        tinted = [self.alike(piece) for piece in self.contact.pieces]
        handles += [
            Patch(facecolor=TINTS[state], edgecolor=style.GREY, lw=0.4,
                  label=f"all contact points {self.state_words(state)}")
            for state in (SLIP, STICK)
            if np.any([each == state for each in tinted])
        ]
        for overlay in overlays:
            handles += overlay.handles(CURVE_NAMES, LINES)
        return handles

    def point_words(self, state):
        """Return the legend's words for a contact point in a state."""
        return f"contact point {self.state_words(state)}"

    def state_words(self, state):
        """Return a state in words, such as "in slip"."""
        name = self.names[state][1]
        return {"open": "open", "contact": "closed"}.get(name, f"in {name}")

    def table(self):
        """Return the curves as columns: edges on the axis of the picture, and as arc length; None of
        several interfaces in rows, which have neither."""
        if self.rows:
            return None
        history = self.result.history
        columns = {
            "increment": np.arange(1, self.result.increments + 1),
            "time": history["time"],
            "load": history["load"],
        }
        columns |= {key: self.edges(key) for key in CURVES}
        columns |= {f"s_{key}": self.contact[key] for key in CURVES}
        return columns

    def pair_table(self):
        """Return the raw pair states as columns: the pairs of one increment below the last; of several
        interfaces with their names."""
        n, m = self.status.shape
        places = {name: np.tile(values, n) for name, values in self.contact.places().items()}
        return {
            "increment": np.repeat(np.arange(1, n + 1), m),
            "load": np.repeat(self.result.history["load"], m),
            **places,
            "status": self.status.ravel(),
        }


def limits(values):
    """Return the range of values, and somewhat more at both ends."""
    low, high = float(np.min(values)), float(np.max(values))
    room = 0.02 * (high - low) or 0.5
    return low - room, high + room


def between(values):
    """Return the limits half-way between values that rise or fall, and as far beyond both ends."""
    if len(values) == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middles = 0.5 * (values[1:] + values[:-1])
    ends = 2.0 * values[[0, -1]] - middles[[0, -1]]
    return np.concatenate((ends[:1], middles, ends[1:]))


def state_marks():
    """Return (state, marker, looks) of the raw pair states."""
    return [
        (OPEN, ".", {"color": "#B0B0B0", "ms": 2.2, "mew": 0}),
        (SLIP, "o", {"mfc": "white", "mec": style.BLUE, "ms": 2.5, "mew": 0.45}),
        (STICK, "s", {"mfc": style.ORANGE, "mec": style.ORANGE, "ms": 2.0, "mew": 0.3}),
    ]
