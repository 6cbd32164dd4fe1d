"""Letters, legends and zone names of the profiles."""

import numpy as np
from matplotlib.lines import Line2D

from . import style
from .result import OPEN, SLIP, STICK

EDGES = {
    "edges_contact": ("edge of contact", "solid"),
    "edges_stick": ("edge of stick", (0, (5, 1.5, 1, 1.5))),
}
QUANTITY_LINES = {
    "pressure": "solid",
    "shear": (0, (4.5, 1.5)),
    "slave_temperature": "solid",
    "master_temperature": (0, (4.5, 1.5)),
    "mu_p": (0, (1.2, 1.2)),
    "heat_flux": "solid",
    "wear_slave": "solid",
    "wear_master": "solid",
}
SECOND = ("shear", "master_temperature")  # curves of a panel whose marks are hollow
MU_P_WIDTH = 1.4  # its dots are seen where friction lies on them

COLUMNS = 2  # of the legend
MOST_NAMED, SOME_NAMED = 24, 8  # of the interfaces that overlap: all, or some of more
LEGEND_LINE = 0.16  # height of a line of the legend, in inches


def add(picture, panels, kinds, overlays):
    """Name curves, loads, zone edges and digitised figures on the panels of a picture."""
    several = picture.several
    handles = []
    for axes, quantities, letter in zip(panels, kinds, "abcde"):
        handles += quantity_handles(picture, quantities) if len(quantities) > 1 else []
        if len(kinds) > 1:
            place = {"xytext": (-30, 4), "textcoords": "offset points"}
            axes.annotate(f"({letter})", (0, 1), xycoords="axes fraction", **place)
    handles += (part_handles if picture.overlap else load_handles)(picture) if several else []
    handles += edge_handles(picture)
    handles += [overlay.handle() for overlay in overlays]
    if handles:  # outside: within the panels it would lie on curves
        figure = panels[0].figure
        figure.set_figheight(figure.get_figheight() + LEGEND_LINE * -(-len(handles) // COLUMNS))
        figure.legend(handles=handles, **style.ABOVE, ncols=COLUMNS)
    if not several:
        name_zones(picture, panels[0])


def quantity_handles(picture, quantities):
    """Return the legend's entries for the quantities of one panel."""
    tau = r"$\tau$" if picture.sign > 0.0 else r"$-\tau$"
    bound = r"$\pm\mu p$" if picture.two_signs() else r"$\mu p$"
    names = {"pressure": "pressure $p$", "shear": f"friction {tau}", "mu_p": bound,
             "slave_temperature": "slave", "master_temperature": "master"}
    markers = {} if picture.several else {
        quantity: "s" if quantity in SECOND else "o" for quantity in quantities if quantity != "mu_p"}
    return [
        Line2D(
            [],
            [],
            color="black",
            ls=QUANTITY_LINES[quantity],
            **({"lw": MU_P_WIDTH} if quantity == "mu_p" else {}),
            marker=markers.get(quantity),
            mfc="white" if quantity in SECOND else "black",
            label=names[quantity],
        )
        for quantity in quantities
    ]


def load_handles(picture):
    """Return the legend's entries for the loads."""
    return [
        Line2D([], [], color=colour, marker=style.marker(number), label=text)
        for number, (colour, text) in enumerate(zip(picture.colours, load_texts(picture)))
    ]


def part_handles(picture):
    """Return the legend's entries for the curves of interfaces that overlap: of very many for some,
    their colours being in the order of their places, and one that says so."""
    names = list(picture.contact.parts)
    count = len(names) if len(names) <= MOST_NAMED else SOME_NAMED
    shown = np.unique(np.linspace(0, len(names) - 1, count).round().astype(int))
    handles = [Line2D([], [], color=picture.colours[k], label=style.plain(names[k])) for k in shown]
    if count < len(names):
        words = f"{len(names) - count} more between these, in their order"
        handles.append(Line2D([], [], ls="none", label=words))
    return handles


def load_texts(picture):
    """Return the loads of a picture in few words, with their times where these are other numbers."""
    result, found = picture.result, []
    for load, time in zip(*(result.history[key][picture.rows] for key in ("load", "time"))):
        words = result.units.short_load(result.load_label, load)
        time_words = result.units.time_value(time)
        found.append(words if result.load_label == "time" else f"{words}, {time_words}")
    return found


def edge_handles(picture):
    """Return the legend's entries for the marks of zone edges."""
    colour, width = edge_looks(picture)
    return [
        Line2D([], [], color=colour, lw=width, ls=line, label=name)
        for key, (name, line) in EDGES.items()
        if any(len(picture.marked_edges(key, row)) for row in picture.rows)
    ]


def edge_looks(picture):
    """Return colour and line width of zone edges: thin through the panels, or at their foot."""
    return ("#606060", 0.5) if len(picture.rows) == 1 else ("black", 0.8)


def name_zones(picture, axes):
    """Name the zones above the panel, between edges and ends of pieces, by the state of most of
    their pairs."""
    row, at = picture.rows[0], picture.at(picture.rows[0])
    low, high = picture.window
    names = {OPEN: "open", SLIP: "slip", STICK: "stick"}
    if picture.contact.friction == 0.0 or picture.contact.get("shear") is None:
        names = {OPEN: "open", SLIP: "contact", STICK: "contact"}
    edges = np.concatenate([picture.edges(key, row) for key in EDGES])
    for piece in picture.contact.pieces:
        first, last = np.min(at[piece]), np.max(at[piece])
        limits = [first, *np.sort(edges[(edges > first) & (edges < last)]), last]
        for ends in zip(limits, limits[1:]):
            between = (at[piece] > ends[0]) & (at[piece] < ends[1])
            left, right = np.clip(ends, low, high)
            if not between.any() or right - left <= 0.09 * (high - low):
                continue
            states = picture.contact["status"][row, piece][between].astype(int)
            name = names[int(np.argmax(np.bincount(states)))]
            place = {"xytext": (0, 2.5), "textcoords": "offset points"}
            middle = (0.5 * (left + right), 1.0)
            coordinates = ("data", "axes fraction")
            axes.annotate(name, middle, xycoords=coordinates, ha="center", fontsize=7.5, **place)
