"""Temperature, stress and errors on the deformed mesh."""

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from . import element_fields, mesh, style
from .cells import curves
from .errors import UserError
from .fine_mesh import refine
from .result import CELL_FIELDS, FIELD_SOURCES
from .style import plt

DEFAULT_QUANTITIES = ("temperature", "von_mises", "yy")
SIGNED = ("xx", "yy", "zz", "xy", "flux_x", "flux_y")
TITLES = {
    "temperature": ("Temperature $T$", "temperature"),
    "von_mises": (r"von Mises stress $\sigma_\mathrm{M}$", "stress"),
    "xx": (r"Stress $\sigma_{xx}$", "stress"),
    "yy": (r"Stress $\sigma_{yy}$", "stress"),
    "zz": (r"Stress $\sigma_{zz}$", "stress"),
    "xy": (r"Stress $\sigma_{xy}$", "stress"),
    "flux_x": ("Heat flux $q_x$", "flux"),
    "flux_y": ("Heat flux $q_y$", "flux"),
    "stress_error": ("Estimated error of stress", "stress"),
    "heat_flux_error": ("Estimated error of heat flux", "flux"),
}
FINE_CELLS = 60000  # about as many parts as a page can show
ROUNDING = 1e-9  # values that differ by this part of the largest magnitude are the same


def draw(result, options):
    """Draw the fields at every load asked for; return the files written."""
    written = []
    for row in result.rows(options.load, options.increment):
        written += draw_row(result, row, options)
    return written


def draw_row(result, row, options):
    """Draw one picture: a panel for each quantity, at the increment in `row` of /history."""
    step = result.field_row(row)
    fields = read_fields(result, step, options.quantity)
    displacement = result.point_data("displacement", step)
    moved = result.cells.points.copy()
    if displacement is not None:
        moved += options.scale * displacement[:, :2]
    pieces = int(np.clip(np.sqrt(FINE_CELLS / result.cells.count), 2, 12))
    fine = refine(result.cells, pieces)
    at = fine.values(moved)
    grid = Triangulation(*at.T, fine.triangles)
    window = mesh.bounds_of(moved)
    if options.region == "contact":
        window = mesh.contact_window(result.contacts(), result.cells, moved)
    figure, panels = layout(len(fields), window)
    inside = np.all((at >= window[0]) & (at <= window[1]), axis=1)
    for axes, letter, (quantity, given) in zip(panels, "abcdefghij", fields.items()):
        mesh.frame(axes, window, result.units, cut=options.region == "contact")
        scale = magnitude(result, quantity, step)
        if quantity in CELL_FIELDS:
            near = given[element_fields.in_window(result.cells, moved, window)]
            levels = limits(near, quantity, scale)
            draw_elements(axes, result.cells, moved, given, quantity, levels)
        else:
            values = fine.values(given.astype(float))
            if quantity == "von_mises":
                values = np.maximum(values, 0.0)  # quadratic interpolation can undershoot
            levels = limits(values[inside], quantity, scale)
            draw_points(axes, grid, values, quantity, levels, scale)
        draw_lines(axes, result.cells, moved)
        title = result.units.label(*TITLES[quantity])
        style.panel_title(axes, title, letter if len(fields) > 1 else "")
    share_labels(panels)
    load = float(result.history["load"][row])
    figure.supxlabel(result.units.load_value(result.load_label, load), fontsize=8.5)
    return style.write(
        figure,
        table(result, moved, displacement, fields),
        options.out,
        name_of(result, row, options),
    )


def name_of(result, row, options):
    """Return the file name: what was chosen by options stands in it."""
    parts = list(options.quantity or ())
    if options.load or options.increment:
        parts += result.row_words(row)
    if options.region == "contact":
        parts.append("contact")
    if options.scale != 1.0:
        parts += ["scale", options.scale]
    return style.file_name(result, "fields", *parts)


def read_fields(result, step, quantities):
    """Return {quantity: values over points or elements} for those asked for, or the usual ones."""
    there = {q: result.field(q, step) for q in FIELD_SOURCES}
    there = {q: v for q, v in there.items() if v is not None and np.isfinite(v).any()}
    for quantity in quantities or ():
        if quantity not in there:
            raise UserError(
                f"{result.path}: no field '{quantity}' at this load "
                f"(there are: {', '.join(there) or 'none'})"
            )
    if 0 < sum(quantity in CELL_FIELDS for quantity in quantities or ()) < len(quantities or ()):
        raise UserError(
            f"{' and '.join(CELL_FIELDS)} are fields of elements: draw them apart from those of nodes"
        )
    chosen = quantities or [q for q in DEFAULT_QUANTITIES if q in there]
    if not quantities and len(chosen) > 1 and tells_nothing(result, there, step):
        chosen.remove("temperature")
    if not chosen:
        raise UserError(f"{result.path}: no temperature or stress field at this load")
    return {quantity: there[quantity] for quantity in chosen}


def tells_nothing(result, there, step):
    """Whether there is a temperature that is the same everywhere, in a deck without heat."""
    if "temperature" not in there or result.point_data("heat_flux", step) is not None:
        return False
    values = there["temperature"]
    return np.nanmax(values) - np.nanmin(values) <= ROUNDING * np.nanmax(np.abs(values))


def magnitude(result, quantity, step):
    """Return the largest magnitude of a quantity, with all components of what it is one of."""
    return float(np.nanmax(np.abs(result.source(quantity, step))))


def layout(count, window):
    """Return a figure and its axes: panels side by side, one below the other for wide models."""
    width, height = np.ptp(window, axis=0)
    if width > 1.8 * height:
        size = (
            style.DOUBLE_COLUMN * 0.75,
            count * (style.DOUBLE_COLUMN * 0.6 * height / width + 0.6),
        )
        figure, panels = plt.subplots(count, 1, layout="compressed", figsize=size, squeeze=False)
    else:
        each = style.DOUBLE_COLUMN / max(count, 2)
        tall = min((each - 0.9) * height / width, 4.6) + 0.6
        figure, panels = plt.subplots(
            1, count, layout="compressed", figsize=(each * count, tall), squeeze=False
        )
    return figure, panels.ravel()


def share_labels(panels):
    """Leave out what a panel's neighbour says already."""
    for axes in panels:
        place = axes.get_subplotspec()
        if not place.is_first_col():
            axes.set_ylabel("")
            axes.tick_params(labelleft=False)
        if not place.is_last_row():
            axes.set_xlabel("")
            axes.tick_params(labelbottom=False)


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


def draw_elements(axes, cells, moved, values, quantity, levels):
    """Fill one panel element by element, with a colour bar."""
    extend = overflow(values[np.isfinite(values)], levels)
    colours = colour_map(quantity, levels)
    filled = element_fields.fill(axes, cells, moved, values, levels, colours, extend)
    draw_bar(axes, filled, levels)


def draw_points(axes, grid, values, quantity, levels, scale):
    """Fill one panel with colours between thin lines of equal value, with a colour bar."""
    broken = ~np.isfinite(values)
    grid.set_mask(broken[grid.triangles].any(axis=1) if broken.any() else None)
    values = settle(np.where(broken, levels[0], values), levels, scale)
    extend = overflow(values, levels)
    colours = colour_map(quantity, levels)
    filled = axes.tricontourf(grid, values, levels=levels, cmap=colours, extend=extend)
    filled.set_edgecolor("face")  # no light seams between the bands of an SVG
    filled.set_linewidth(0.15)
    lines = {"colors": "black", "linewidths": 0.15, "linestyles": "solid"}
    axes.tricontour(grid, values, levels=levels[1:-1], **lines)
    draw_bar(axes, filled, levels)


def draw_bar(axes, filled, levels):
    """Draw the colour bar of a panel."""
    bar = axes.figure.colorbar(filled, cax=axes.inset_axes(bar_place(axes)))
    bar.ax.tick_params(direction="out", width=0.4, length=2)
    bar.outline.set_linewidth(0.4)
    every = 2 if len(levels) > 8 else 1
    number = np.rint(levels / (levels[1] - levels[0])).astype(int)
    bar.set_ticks(levels[number % every == 0])


def bar_place(axes):
    """Return the colour bar's place in fractions of the axes: beside them and as high."""
    width, height = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
    thick = 0.03 * max(width, height) / width
    return [1.0 + thick, 0.0, thick, 1.0]


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


def draw_lines(axes, cells, moved):
    """Draw the elements faintly, where they are few, and the outlines of the bodies."""
    if cells.count <= 600:
        edges, _ = cells.edges()
        axes.add_collection(
            LineCollection(curves(edges, moved), colors="black", linewidths=0.2, alpha=0.45)
        )
    axes.add_collection(
        LineCollection(curves(cells.boundary(), moved), colors="black", linewidths=0.7)
    )


def table(result, moved, displacement, fields):
    """Return the drawn fields as columns: one row for each point, or element."""
    if set(fields) <= set(CELL_FIELDS):
        return element_fields.table(result.cells, moved, fields)
    columns = {
        "node": result.cells.node_id,
        "x": result.cells.points[:, 0],
        "y": result.cells.points[:, 1],
    }
    if displacement is not None:
        columns |= {"u_x": displacement[:, 0], "u_y": displacement[:, 1]}
    columns |= {"x_drawn": moved[:, 0], "y_drawn": moved[:, 1]}
    return columns | fields
