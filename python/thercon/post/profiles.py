"""Contact tractions and heat flux along the contact (Fig. 2 of the paper)."""

import numpy as np

from . import profile_legends, style
from .edge_curves import zeros_of
from .overlay import axis_words, file_parts, read_overlays
from .profile_legends import EDGES, QUANTITY_LINES, SECOND
from .errors import UserError, nearest_name
from .result import UNJUDGED
from .style import plt
from .tables import stack_tables

FACES = ("slave_temperature", "master_temperature")
CURVES = ("pressure", "shear", *FACES, "heat_flux", "wear_slave", "wear_master")
TRACTIONS = ("pressure", "shear", "mu_p")   # end at the sharpened edges of contact
WORN = {"wear_slave": "slave", "wear_master": "master"}
CURVE_ORDERS = (2, 4)   # zorder of curves and of digitised ones; marks and edges have others
PASSED_OVER = ("x", "y", "s", "contact", "increment", "load", "status", "mu_p")


def draw(result, options):
    """Draw the profiles of every contact asked for; return the files written."""
    rows = result.rows(options.load, options.increment)
    contacts = result.contacts(options.contact)
    written = []
    for contact in contacts:
        along, _ = contact.axis(options.along)
        others = [name for name in PASSED_OVER if name != along]
        overlays = read_overlays(options.figures, along, CURVES, others)
        figure = Picture(result, contact, rows, options).draw(overlays)
        parts = [contact.name] if len(result.contact_names) > 1 else []
        if options.load or options.increment:
            parts += [word for row in rows for word in result.row_words(row)]
        parts += axis_words(options.along)
        if options.range:
            parts += ["range", *options.range]
        parts += [word for each in options.values for word in each]
        name = style.file_name(result, "profiles", *parts, *file_parts(options.figures))
        written += style.write(figure, table(result, contact, rows), options, name)
    return written


class Picture:
    """One figure: panels of one contact at one or several loads."""

    def __init__(self, result, contact, rows, options):
        self.result, self.contact, self.rows = result, contact, rows
        self.along, self.coordinate = contact.axis(options.along)
        self.overlap = contact.overlap(options.along)
        if self.overlap and len(rows) > 1:
            raise UserError(f"profiles of '{contact.name}' overlap, so several loads would hide each "
                            "other: give one load, or name one interface with --contact")
        self.moved = {row: result.moved(contact, row, self.along) for row in rows}
        self.slides = any(moved is not None for moved in self.moved.values())
        self.window = options.range or self.find_window()
        self.colours = style.shades(len(contact.parts) if self.overlap else len(rows))
        self.sign = friction_sign(contact, rows)
        self.ranges = options.values
        drawn = [name for kind in self.panel_kinds() for name in kind]
        for name, *_ in self.ranges:
            if name not in drawn:
                raise UserError(f"no panel shows '{name}'{nearest_name(name, drawn)}: there are "
                                f"{', '.join(drawn)}")

    def at(self, row):
        """Return where the contact points are: those that follow sliding on the displaced face."""
        moved = self.moved[row]
        return self.coordinate if moved is None else self.coordinate + moved

    def find_window(self):
        """Return the range that is shown."""
        if self.overlap:
            return float(self.coordinate.min()), float(self.coordinate.max())
        if not self.slides:
            return self.contact.window(self.coordinate, self.rows, of_loads=True)
        ends = [self.contact.window(self.at(row), [row], of_loads=True) for row in self.rows]
        return min(low for low, _ in ends), max(high for _, high in ends)

    def draw(self, overlays):
        """Return the finished figure, with digitised figures laid over."""
        kinds = self.panel_kinds()
        size = (style.SINGLE_COLUMN * 1.15, 0.5 + 1.75 * len(kinds))
        figure, panels = plt.subplots(
            len(kinds), sharex=True, layout="constrained", squeeze=False, figsize=size
        )
        panels = panels[:, 0]
        for axes, quantities in zip(panels, kinds):
            drawn = []
            for number, row in enumerate(self.rows):
                drawn += [self.draw_curve(axes, quantity, row, number) for quantity in quantities]
                self.mark_edges(axes, row, self.colours[number])
            for overlay in overlays:
                for quantity in quantities:
                    size = quantity == "shear" and not self.two_signs()
                    line = QUANTITY_LINES[quantity]
                    drawn.append(overlay.plot(axes, self.along, quantity, line, magnitude=size))
            axes.set_ylabel(self.ordinate(quantities))
            scale(axes, np.concatenate(drawn), from_zero=quantities[0] not in FACES)
            for name, low, high in self.ranges:
                if name in quantities:
                    axes.set(ylim=(low, high))
                    plt.setp(axes.lines, clip_on=True)
                    self.note_hidden(axes, name, low, high)
        profile_legends.add(self, panels, kinds, overlays)
        units = self.result.units
        unit = units.names.get("length", "")
        part = "" if self.slides else self.contact.part_words(self.coordinate, self.window, unit,
                                                              self.rows)
        label = units.label(f"${self.along}$", "length")
        panels[-1].set_xlabel(f"{label}\n{part}".rstrip())
        room = 0.02 * (self.window[1] - self.window[0])
        panels[-1].set_xlim(self.window[0] - room, self.window[1] + room)
        if len(self.rows) == 1:
            figure.supxlabel(self.result.load_words(self.rows[0]), fontsize=8.5)
        elif not self.result.judged[self.rows].all():
            times = profile_legends.load_texts(self)
            late = ", ".join(t for t, row in zip(times, self.rows) if not self.result.judged[row])
            figure.supxlabel(f"{late}:\n{UNJUDGED}", fontsize=8.5)
        return figure

    def note_hidden(self, axes, name, low, high):
        """Add a note of the curves of a panel that lie outside the range of its values."""
        curves = [line.get_ydata()[self.in_window(line.get_xdata())] for line in axes.lines
                  if line.get_zorder() in CURVE_ORDERS]
        curves = [values[~np.isnan(values)] for values in curves]
        curves = [values for values in curves if values.size]
        hidden = sum(values.min() > high or values.max() < low for values in curves)
        if hidden:
            self.result.notes.append(f"{self.result.path}: panel of {name}: {hidden} of {len(curves)} "
                                     f"curves lie outside {low:g} to {high:g}")

    def panel_kinds(self):
        """Return the quantities of each panel; with several curves friction has its own."""
        traction, flux = self.contact.get("shear"), self.contact.get("heat_flux")
        friction = []
        if traction is not None and np.any(traction[self.rows] != 0.0):
            friction = ["shear"] if self.contact.friction is None else ["shear", "mu_p"]
        kinds = [["pressure", *friction]]
        faces = [name for name in FACES if self.contact.get(name) is not None]
        if faces and not np.any(self.contact["pressure"][self.rows]):
            kinds = [faces]
        if self.several and friction:
            kinds = [["pressure"], friction]
        worn = [[name] for name in WORN if np.any(self.contact.get(name, 0.0) != 0.0)]
        has_flux = flux is not None and np.any(flux[self.rows])
        return kinds + ([["heat_flux"]] if has_flux else []) + worn

    @property
    def several(self):
        """Whether panels have a curve for each of several loads or interfaces."""
        return len(self.colours) > 1

    def values(self, quantity, row):
        """Return what is drawn of a quantity: the file's values, friction with one sign."""
        if quantity == "mu_p":
            return self.contact.friction * self.contact["pressure"][row]
        values = self.contact[quantity][row]
        return self.sign * values if quantity == "shear" else values

    def draw_curve(self, axes, quantity, row, number):
        """Draw one curve through the nodal values, tractions ending at the sharpened edge.

        `number` counts the loads. Returns the values that lines in the window touch.
        """
        at, values, shown = self.at(row), self.values(quantity, row), self.inside(row)
        both = quantity == "mu_p" and self.two_signs()
        near = np.convolve(shown, [1, 1, 1])[1:-1] > 0  # lines run on to the next pairs
        drawn = np.concatenate((values[near], -values[near])) if both else values[near]
        looks = {"color": self.colours[number], "linestyle": QUANTITY_LINES[quantity]}
        if quantity != "mu_p" and not self.overlap:  # the marks of some would hide the others
            is_second = quantity in SECOND
            marker = "s" if is_second and len(self.rows) == 1 else style.marker(number)
            looks["mfc"] = "white" if is_second else looks["color"]
            symbols = looks | {"linestyle": "none", "marker": marker}
            axes.plot(at[shown], values[shown], zorder=3, clip_on=False, **symbols)
        if quantity == "mu_p":
            looks["lw"] = profile_legends.MU_P_WIDTH
        for piece in self.contact.pieces:
            places, heights = at[piece], values[piece]
            if self.overlap:
                looks["color"] = self.colours[self.contact.part_number(piece)]
            if quantity in TRACTIONS:
                places, heights = self.with_edges(row, piece, heights)
            for sign in (1, -1) if both else (1,):
                axes.plot(places, sign * heights, zorder=2, **looks)
        return drawn

    def inside(self, row):
        """Return which pairs lie inside the window."""
        return self.in_window(self.at(row))

    def in_window(self, at):
        """Return which places lie inside the window."""
        return (at >= self.window[0]) & (at <= self.window[1])

    def two_signs(self):
        """Whether friction has both signs along the contact at these loads."""
        return two_signed(self.contact["shear"][self.rows])

    def marked_edges(self, key, row):
        """Return the edges of a kind that are marked, those in the window: of many interfaces they
        would hide the rest."""
        edges = self.edges(key, row)
        is_inside = (edges >= self.window[0]) & (edges <= self.window[1])
        return [] if self.contact.parts else edges[is_inside]

    def with_edges(self, row, piece, values):
        """Return places and values of a piece with zeros at the edges of contact inside it."""
        edges, before = zeros_of(self.contact, row, piece)
        on_axis = self.contact.edge_on_axis(edges, self.at(row))
        return np.insert(self.at(row)[piece], before, on_axis), np.insert(values, before, 0.0)

    def edges(self, key, row):
        """Return the sharpened edges of a kind at one load, on the axis of the picture."""
        edges = np.atleast_1d(self.contact[key][row])
        return self.contact.edge_on_axis(edges[~np.isnan(edges)], self.at(row))

    def mark_edges(self, axes, row, colour):
        """Mark zone edges: through the panel for one load, at its foot for several."""
        single = len(self.rows) == 1
        usual, width = profile_legends.edge_looks(self)
        for key, (_, line) in EDGES.items():
            for edge in self.marked_edges(key, row):
                axes.axvline(
                    edge,
                    ymax=1.0 if single else 0.09,
                    color=usual if single else colour,
                    linestyle=line,
                    lw=width,
                    zorder=1,
                )

    def ordinate(self, quantities):
        """Return the label of a panel's ordinate."""
        units = self.result.units
        if quantities == ["heat_flux"]:
            return units.label("Heat flux $q$", "flux")
        if quantities[0] in WORN:
            return units.label(f"Wear of the {WORN[quantities[0]]}", "length")
        if quantities[0] in FACES:
            return units.label("Temperature of the faces", "temperature")
        if quantities == ["pressure"]:
            return units.label("Pressure $p$", "stress")
        return units.label("Contact traction" if "pressure" in quantities else "Friction", "stress")


def scale(axes, drawn, from_zero=True):
    """Set the ordinate's range to the values drawn, if asked from zero where nothing is negative."""
    if not from_zero:
        low, high = np.nanmin(drawn), np.nanmax(drawn)
        room = 0.06 * (high - low) if high - low > 1e-6 * max(abs(low), abs(high)) else 0.5
        axes.set_ylim(low - room, high + 2 * room)
        return
    low, high = np.nanmin(drawn, initial=0.0), np.nanmax(drawn, initial=0.0)
    room = 0.06 * ((high - low) or 1.0)
    if -low <= 0.01 * high:
        axes.set_ylim(0.0, high + 2 * room)
    else:
        axes.set_ylim(low - room, high + 2 * room)
        axes.axhline(0.0, color="black", lw=0.4, zorder=1)


def two_signed(shear):
    """Whether friction has, beyond rounding and noise, both signs."""
    low = np.nanmax(-shear, initial=0.0)
    high = np.nanmax(shear, initial=0.0)
    return min(low, high) > 0.02 * max(low, high)


def friction_sign(contact, rows):
    """Return the sign that turns a friction of one sign positive; 1 where it has both."""
    shear = contact.get("shear")
    if shear is None or two_signed(shear[rows]):
        return 1.0
    return -1.0 if np.nansum(shear[rows]) < 0.0 else 1.0


def table(result, contact, rows):
    """Return the drawn profiles as columns: the pairs of one load below those of another."""
    count = len(contact["x"])
    tables = []
    for row in rows:
        places, moved = contact.places(), result.moved(contact, row, "x")
        if moved is not None:
            places["x"] = places["x"] + moved
        columns = {
            "increment": np.full(count, row + 1),
            "load": np.full(count, result.history["load"][row]),
            **places,
            "status": contact["status"][row],
        }
        columns |= {key: contact[key][row] for key in CURVES if contact.get(key) is not None}
        if contact.friction is not None:
            columns["mu_p"] = contact.friction * contact["pressure"][row]
        tables.append(columns)
    return stack_tables(tables)
