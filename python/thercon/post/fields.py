"""Temperature, stress and errors on the deformed mesh."""

import re
from string import ascii_lowercase

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.tri import Triangulation

from . import element_fields, mesh, style
from .cells import curves
from .errors import UserError
from .field_colours import (
    NOTHING,
    ROUNDING,
    SIGNED,
    WIDE,
    Layer,
    colours_of,
    draw_bars,
    extend_words,
    limits,
    overflow,
    scale_groups,
    settle,
)
from .fine_mesh import refine
from .result import CELL_FIELDS, FIELD_SOURCES, MODE, NO_ANALYSIS, OPEN
from .rigid_surfaces import draw_rigid, lines_of, surfaces, with_lines
from .style import plt

USUAL = {False: ("temperature", "von_mises", "yy"), True: ("temperature", "radial", "hoop")}
TITLES = {
    "temperature": ("Temperature $T$", "temperature"),
    "von_mises": (r"von Mises stress $\sigma_\mathrm{M}$", "stress"),
    "xx": (r"Stress $\sigma_{xx}$", "stress"),
    "yy": (r"Stress $\sigma_{yy}$", "stress"),
    "zz": (r"Stress $\sigma_{zz}$", "stress"),
    "xy": (r"Stress $\sigma_{xy}$", "stress"),
    "principal_1": (r"Principal stress $\sigma_1$", "stress"),
    "principal_2": (r"Principal stress $\sigma_2$", "stress"),
    "principal_3": (r"Principal stress $\sigma_3$", "stress"),
    "radial": (r"Radial stress $\sigma_r$", "stress"),
    "hoop": (r"Hoop stress $\sigma_\theta$", "stress"),
    "plastic_strain": (r"Equivalent plastic strain $\varepsilon_\mathrm{p}$", None),
    "solid_fraction": ("Solid fraction", None),
    "creep_strain": (r"Equivalent creep strain $\varepsilon_\mathrm{c}$", None),
    "flux_x": ("Heat flux $q_x$", "flux"),
    "flux_y": ("Heat flux $q_y$", "flux"),
    "stress_error": ("Estimated error of stress", "stress"),
    "heat_flux_error": ("Estimated error of heat flux", "flux"),
    MODE: ("Temperature of the leading mode", None),
    "pressure": ("Pressure $p$", "stress"),
    "gap": ("Gap", "length"),
    "wear_slave": ("Wear of the slave", "length"),
    "wear_master": ("Wear of the master", "length"),
}
OF_AXES = {"xx": "Radial stress", "yy": "Axial stress", "zz": "Hoop stress", "xy": "Shear stress"}
AMPLITUDE = 0.02  # of the size of the model: displacement of a mode that is drawn
CAPTION = 0.5  # height of what is told below, in inches
THIN, DRAWN = 12.0, 8.0  # ratio of the sides of a strip that is stretched, and about that drawn
COLUMNS = 3  # of panels
LOOKED_AT = 20  # times at most
MOST_NAMED = 8  # increments
FINE_CELLS = 60000  # about as many parts as a page can show


def draw(result, options):
    """Draw the fields at every load asked for; return the files written."""
    written = []
    for row in result.rows(options.load, options.increment, with_fields=True):
        written += draw_row(result, row, options)
    return written


def draw_row(result, row, options):
    """Draw one picture: a panel for each quantity, at the increment in `row` of /history."""
    step = result.field_row(row)
    fields = read_fields(result, step, options.quantity)
    check_range(options.range, fields)
    displacement = result.point_data("mode_displacement" if MODE in fields else "displacement", step)
    factor = options.scale
    if factor is None:
        factor = mode_factor(result.cells, displacement) if MODE in fields else 1.0
    moved = result.cells.points.copy()
    if displacement is not None:
        moved += factor * displacement[:, :2]
    pieces = int(np.clip(np.sqrt(FINE_CELLS / result.cells.count), 2, 12))
    fine = refine(result.cells, pieces)
    at = fine.values(moved)
    grid = Triangulation(*at.T, fine.triangles)
    lines = lines_of(result, step if displacement is not None else None, factor)
    window = with_lines(mesh.bounds_of(moved[result.cells.used]), lines)
    is_part = options.window is not None or options.region == "contact"
    if options.region == "contact":
        window = contact_window(result, moved, window)
    if options.window:
        window = given_window(options.window, window)
    stretch = stretch_of(window)
    figure, panels = layout(len(fields), window * (1.0, stretch))
    layers, titles = [], titles_of(fields, result, panels[0])
    for axes, letter, (quantity, given) in zip(panels, ascii_lowercase, fields.items()):
        mesh.frame(axes, window, result.units, cut=is_part, stretch=stretch)
        look = quantity, magnitude(result, quantity, step), options
        if quantity in CELL_FIELDS:
            layers.append(draw_elements(axes, result.cells, moved, given, look, window))
        else:
            layers.append(draw_points(axes, grid, fine, given.astype(float), look,
                                      inside_of(result.cells, moved, at, window)))
        draw_lines(axes, result.cells, moved)
        draw_rigid(axes, lines)
        lines_of_state = [
            outline_plastic_zone(axes, grid, fine, result.point_data("equivalent_plastic_strain", step)),
            draw_front(axes, grid, fine, result.point_data("solid_fraction", step)),
        ]
        title = titles[quantity] + (fate(result, row) if quantity == MODE else "")
        style.panel_title(axes, title, letter if len(fields) > 1 else "")
    draw_bars(panels.tolist(), layers)
    share_labels(panels)
    words = [words_below(result, row, factor, MODE in fields), stretch_words(stretch),
             "; ".join(filter(None, lines_of_state))]
    figure.supxlabel("\n".join(filter(None, words)), fontsize=8.5)
    return style.write(
        figure,
        table(result, moved, displacement, fields),
        options,
        name_of(result, row, options),
    )


def title_of(result, quantity):
    """Return title and unit of a quantity; stresses about an axis have names of their own."""
    words, unit = TITLES[quantity]
    if result.is_axisymmetric and quantity in OF_AXES:
        words = words.replace("Stress", OF_AXES[quantity])
    return words, unit


def titles_of(fields, result, axes):
    """Return {quantity: title}: of panels side by side in two lines, if one of them needs two."""
    titles = {quantity: result.units.label(*title_of(result, quantity)) for quantity in fields}
    if axes.get_subplotspec().get_gridspec().ncols > 1:
        titles = {q: re.sub(r" (?=[$(]|of )", "\n", title, count=1) for q, title in titles.items()}
    if any("\n" in title for title in titles.values()):
        titles = {q: title if "\n" in title else f"{title}\n" for q, title in titles.items()}
    return titles


def outline_plastic_zone(axes, grid, fine, strain):
    """Draw where the plastic strain is a hundredth of its largest value; return what the line is."""
    if strain is None or not np.nanmax(strain) > 0.0:
        return ""
    values, level = np.nan_to_num(fine.values(strain.astype(float))), 0.01 * np.nanmax(strain)
    if values.min() >= level:
        return ""
    line = axes.tricontour(grid, values, levels=[level], colors="black", linewidths=1.0)
    return "thick line inside: 1 % of the largest plastic strain" if is_seen(axes, line) else ""


def is_seen(axes, line):
    """Whether a line of equal value has a part within the axes."""
    points = np.concatenate([np.empty((0, 2)), *line.allsegs[0]])
    low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
    return bool(np.any(np.all((points >= low) & (points <= high), axis=1)))


def draw_front(axes, grid, fine, fraction):
    """Draw the front of solidification, where the solid fraction is a half; return what the line is."""
    if fraction is None or not np.nanmin(fraction) < 0.5 < np.nanmax(fraction):
        return ""
    line = axes.tricontour(grid, fine.values(fraction.astype(float)), levels=[0.5], colors="black",
                           linewidths=1.4, linestyles=[(0, (2.0, 1.0))])
    return "dashed line: solid fraction 0.5" if is_seen(axes, line) else ""


def stretch_of(window):
    """Return by how much y is stretched against x, lest a thin strip be a line."""
    width, height = np.ptp(window, axis=0)
    ratio = max(width, height) / min(width, height)
    if ratio <= THIN:
        return 1.0
    by = float(f"{ratio / DRAWN:.1g}")
    return by if width > height else 1.0 / by


def stretch_words(stretch):
    """Return along which axis a thin strip is stretched, and by how much."""
    axis, by = ("y", stretch) if stretch > 1.0 else ("x", 1.0 / stretch)
    return "" if stretch == 1.0 else f"${axis}$ stretched by {by:g}"


def contact_window(result, moved, whole):
    """Return the window of the contact; a note says how to see more where that is the whole model."""
    near = mesh.contact_window(result.contacts(), result.cells, moved)
    if np.all(np.ptp(near, axis=0) >= mesh.SMALLER * np.ptp(whole, axis=0)):
        result.notes.append(f"{result.path}: the contact is all over the model: --window shows a part")
    return near


def given_window(ends, whole):
    """Return the window that --window gives, which must show some of the model."""
    window = np.array([ends[0::2], ends[1::2]])
    words = " ".join(f"{end:g}" for end in ends)
    if not np.all(window[0] < window[1]):
        raise UserError(f"--window {words}: X0 must be below X1, and Y0 below Y1")
    if np.any(window[1] <= whole[0]) or np.any(window[0] >= whole[1]):
        (left, foot), (right, top) = whole
        raise UserError(f"--window {words} shows nothing: the model is from {left:.4g} to {right:.4g} in x "
                        f"and {foot:.4g} to {top:.4g} in y")
    return window


def rate_of(result, row):
    """Return the growth rate of the mode at a row of /history; NaN where the file has none."""
    found = result.stability
    at = np.flatnonzero(found["time"] == result.history["time"][row]) if found else []
    return found["growth_rate"][at[-1]] if len(at) else np.nan


def fate(result, row):
    """Return whether the mode at a row of /history grows, as the end of a title."""
    rate = rate_of(result, row)
    return ", which grows" if rate > 0.0 else ", which decays" if rate < 0.0 else ""


def mode_factor(cells, displacement):
    """Return a round factor that makes a motion visible: its size is arbitrary."""
    size = np.ptp(cells.points[cells.used], axis=0).max()
    largest = np.abs(displacement[cells.used]).max()
    return float(f"{AMPLITUDE * size / largest:.1g}") if largest > 0.0 else 1.0


def words_below(result, row, factor, is_mode=False):
    """Return load, time and what a magnification does."""
    words = result.load_words(row)
    words += f"{rate_words(result, row)}\nlargest temperature set to 1" if is_mode else ""
    words += f"; displacements $\\times$ {factor:g}" if factor != 1.0 else ""
    if result.given_gaps:
        return f"{words}\n{apart_words(result)}"
    if is_mode and result.contact_names:
        words += ",\nfaces that slip may seem to part or overlap"
    elif factor > 1.0 and touches_after_a_gap(result):
        words += ",\ninitial gaps are not magnified:\nbodies that touch seem to overlap"
    return words


def rate_words(result, row):
    """Return a line with the growth rate of the mode that is drawn, where the file has it."""
    rate, unit = rate_of(result, row), result.units.names.get("time")
    if np.isnan(rate):
        return ""
    return f"\ngrowth rate {rate:.4g}".replace("-", "\N{MINUS SIGN}") + (f" 1/{unit}" if unit else "")


def apart_words(result):
    """Return that gaps that a card gives are not in the mesh."""
    return f"the mesh has the faces as drawn; {result.given_gaps} is not drawn"


def touches_after_a_gap(result):
    """Whether points close that are apart in the mesh: magnified, they are drawn beyond each
    other."""
    cells = result.cells
    point = dict(zip(cells.node_id.tolist(), cells.points))
    rigid = np.concatenate([np.empty((0, 2, 2)), *(
        np.stack((points[:-1], points[1:]), axis=1) for points, _ in surfaces(result))])
    for contact in result.contacts() if result.contact_names else ():
        closed = (contact["status"] != OPEN).any(axis=0)
        slave, master = (contact[key][closed].tolist() for key in ("slave_node", "master_node"))
        if contact.pairing == "NODES":
            apart = [np.abs(point[n] - point[m]).max() for n, m in zip(slave, master)]
        else:
            outline = cells.boundary()
            apart = [from_outline(cells, outline, rigid, n) for n in slave]
        if apart and max(apart) > 1e-6 * np.ptp(cells.points, axis=0).max():
            return True
    return False


def from_outline(cells, outline, rigid, number):
    """Return the distance of a node from rigid surfaces and the edges that bodies end at, but its own."""
    (node,) = np.flatnonzero(cells.node_id == number)
    edges = outline[(outline != node).all(axis=1)]
    halves = np.where(edges[:, 2:] >= 0, edges[:, [0, 2, 2, 1]], edges[:, [0, 1, 0, 1]])
    first, last = np.concatenate((cells.points[halves.reshape(-1, 2)], rigid)).swapaxes(0, 1)
    place = cells.points[node]
    along = np.clip(((place - first) * (last - first)).sum(axis=1)
                    / ((last - first) ** 2).sum(axis=1), 0.0, 1.0)
    return np.linalg.norm(first + along[:, None] * (last - first) - place, axis=1).min()


def name_of(result, row, options):
    """Return the file name: what was chosen by options stands in it."""
    parts = list(options.quantity or ())
    if options.load or options.increment:
        parts += result.row_words(row)
    if options.region == "contact":
        parts.append("contact")
    if options.window:
        parts += ["window", *options.window]
    if options.scale not in (None, 1.0):
        parts += ["scale", options.scale]
    if options.range:
        parts += ["range", *options.range]
    return style.file_name(result, "fields", *parts)


def read_fields(result, step, quantities, of_faces=()):
    """Return {quantity: values over points or elements} for those asked for, or the usual ones; of
    faces, those named."""
    there = {q: result.field(q, step) for q in (*FIELD_SOURCES, *of_faces)}
    there = {q: v for q, v in there.items() if v is not None and np.isfinite(v).any()}
    for quantity in quantities or ():
        if quantity not in there:
            why = f"; {motion_words(result)}" if quantity == MODE else ""
            raise UserError(
                f"{result.path}: no field '{quantity}' at this load "
                f"(there are: {', '.join(there) or 'none'}){why}"
            )
    if 0 < sum(quantity in CELL_FIELDS for quantity in quantities or ()) < len(quantities or ()):
        raise UserError(
            f"{' and '.join(CELL_FIELDS)} are fields of elements: draw them apart from those of nodes"
        )
    if MODE in (quantities or ()) and len(quantities) > 1:
        raise UserError(f"{MODE} is drawn on the shape of its motion: draw it apart from other fields")
    usual = USUAL[result.is_axisymmetric]
    if "U3" in result.history:  # generalised plane strain
        usual = (*usual[:2], "zz")
    chosen = quantities or [q for q in usual if q in there]
    if not quantities and len(chosen) > 1 and tells_nothing(result, there, step):
        chosen.remove("temperature")
    if not chosen:
        raise UserError(f"{result.path}: no temperature or stress field at this load")
    return {quantity: there[quantity] for quantity in chosen}


def motion_words(result):
    """Return which increments have a small motion, or why none has."""
    if result.stability is None:
        return "the deck has no *STABILITY"
    times = result.history["time"]
    there = np.isin(times, result.stability["time"]) & np.isin(times, result.field_times)
    numbers = [f"{row + 1}" for row in np.flatnonzero(there)]
    if len(numbers) > MOST_NAMED:
        numbers[MOST_NAMED - 1 : -1] = ["..."]
    return f"increments that have it: {', '.join(numbers)}" if numbers else NO_ANALYSIS


def check_range(given, fields):
    """Refuse a range of colours that falls, or of panels with several units."""
    if given and not given[0] < given[1]:
        raise UserError(f"--range {given[0]:g} {given[1]:g}: the first must be below the second")
    if given and len({TITLES[quantity][1] for quantity in fields}) > 1:
        raise UserError(f"--range is of one unit: choose of {', '.join(fields)} with --quantity")


def tells_nothing(result, there, step):
    """Whether there is a temperature that is the same everywhere, in a deck without heat."""
    if "temperature" not in there or result.point_data("heat_flux", step) is not None:
        return False
    values = there["temperature"]
    return np.nanmax(values) - np.nanmin(values) <= ROUNDING * np.nanmax(np.abs(values))


def magnitude(result, quantity, step):
    """Return the largest magnitude of a quantity, with all components of what it is one of; that at
    other times where it is NOTHING beside it, the rounding of what has gone."""
    others = np.unique(np.linspace(0, len(result.field_times) - 1, LOOKED_AT).astype(int))
    sizes = {k: np.abs(result.source(quantity, k)) for k in (step, *others.tolist())}
    largest = {k: float(np.max(size, initial=0.0, where=np.isfinite(size))) for k, size in sizes.items()}
    most = max(largest.values())
    return largest[step] if largest[step] > NOTHING * most else most


def layout(count, window):
    """Return a figure and its axes: panels in rows, one below the other for wide models."""
    width, height = np.ptp(window, axis=0)
    if width > WIDE * height:
        size = (
            style.DOUBLE_COLUMN * 0.75,
            count * (style.DOUBLE_COLUMN * 0.6 * height / width + 1.0) + CAPTION,
        )
        figure, panels = plt.subplots(count, 1, layout="compressed", figsize=size, squeeze=False)
    else:
        columns = min(count, COLUMNS)
        rows = -(-count // columns)
        each = style.DOUBLE_COLUMN / max(columns, 2)
        size = (each * columns, rows * (min((each - 0.9) * height / width, 4.6) + 0.8))
        figure, panels = plt.subplots(
            rows, columns, layout="compressed", figsize=size, squeeze=False
        )
    for axes in panels.ravel()[count:]:
        axes.remove()
    return figure, panels.ravel()[:count]


def share_labels(panels):
    """Leave out what a panel's neighbour says already."""
    columns = panels[0].get_subplotspec().get_gridspec().ncols
    for number, axes in enumerate(panels):
        if number % columns:
            axes.set_ylabel("")
            axes.tick_params(labelleft=False)
        if number + columns < len(panels):
            axes.set_xlabel("")
            axes.tick_params(labelbottom=False)


def inside_of(cells, moved, at, window):
    """Return which fine points are in a window, and the nodes of each body that are."""
    inside, near = (np.all((places >= window[0]) & (places <= window[1]), axis=1)
                    for places in (at, moved))
    nodes = {}
    for kind, group in cells.groups.items():
        for body in np.unique(cells.bodies[kind]):
            own = np.unique(group[cells.bodies[kind] == body])
            nodes[body] = np.union1d(nodes.get(body, own), own)
    return inside, {body: own[near[own]] for body, own in nodes.items()}


def draw_elements(axes, cells, moved, values, look, window):
    """Fill one panel element by element; return its layers, one for each group of bodies.

    `look` is the quantity, its magnitude and the options, of which colours and range count here."""
    quantity, scale, options = look
    bodies = element_fields.of_elements(cells, cells.bodies)
    areas = element_fields.areas(cells, moved)
    inside = element_fields.in_window(cells, moved, window)
    near = {body: values[inside & (bodies == body)] for body in np.unique(bodies)}
    groups = scale_groups(near) if options.colours == "body" else [list(near)]
    layers = []
    for group in groups:
        own = np.where(np.isin(bodies, group), values, np.nan)
        levels = limits(own[inside], quantity, scale, areas[inside], options.range)
        colours, norm = colours_of(quantity, levels)
        filled = element_fields.fill(axes, cells, moved, own, colours, norm)
        shown = own[inside & np.isfinite(own)]
        layers.append(layer_of(filled, levels, shown, group if len(groups) > 1 else (), quantity))
    return layers


def draw_points(axes, grid, fine, given, look, where):
    """Fill one panel with colours between thin lines of equal value; return its layers, one for each
    group of bodies. `given` are values at nodes; `look` is as above, `where` what `inside_of` returns."""
    (quantity, scale, options), (inside, nodes) = look, where
    values = fine.values(given)
    if quantity in ("von_mises", "plastic_strain", "creep_strain", "solid_fraction"):
        # Quadratic interpolation can leave the range that there is.
        values = np.clip(values, 0.0, 1.0 if quantity == "solid_fraction" else np.inf)
    broken = ~np.isfinite(values)
    members = {body: fine.triangles[fine.bodies == body] for body in np.unique(fine.bodies)}
    members = {body: np.unique(triangles) for body, triangles in members.items()}
    members = {body: points[inside[points]] for body, points in members.items()}
    areas = fine.areas(np.column_stack((grid.x, grid.y)))
    groups = scale_groups({body: values[points] for body, points in members.items()}) \
        if options.colours == "body" else [list(members)]
    layers = []
    for group in groups:
        near = np.concatenate([members[body] for body in group])
        levels = limits(values[near], quantity, scale, areas[near], options.range)
        settled = settle(np.where(broken, levels[0], values), levels, scale)
        hidden = ~np.isin(fine.bodies, group) | broken[grid.triangles].any(axis=1)
        if hidden.all():
            continue
        grid.set_mask(hidden)
        shown = given[np.concatenate([nodes[body] for body in group])]
        shown = shown[np.isfinite(shown)]
        below, above = overflow(shown, levels) if shown.size else (False, False)
        # What is interpolated beyond all nodes, or out of sight, has the colours at the ends.
        # A region that is at the last level is filled where it is below that by less than rounding.
        highest = levels[-1] - ROUNDING * np.ptp(levels)
        settled = np.clip(settled, -np.inf if below else levels[0], np.inf if above else highest)
        extend = extend_words(below, above)
        colours, norm = colours_of(quantity, levels)
        filled = axes.tricontourf(grid, settled, levels=levels, cmap=colours, norm=norm, extend=extend)
        for bands in getattr(filled, "collections", [filled]):
            bands.set(edgecolor="face", linewidth=0.15)  # no light seams between the bands of an SVG
        lines = {"colors": "black", "linewidths": 0.15, "linestyles": "solid"}
        if len(levels) > 2:
            axes.tricontour(grid, settled, levels=levels[1:-1], **lines)
        layers.append(layer_of(filled, levels, shown, group if len(groups) > 1 else (), quantity))
    return layers


def layer_of(filled, levels, shown, bodies, quantity):
    """Return the layer of a panel; `shown` are the values at nodes or of elements in it."""
    ends = (shown.min(), shown.max()) if shown.size and len(levels) > 2 else levels[[0, -1]]
    kind = f"{TITLES[quantity][1]} {'signed' if quantity in SIGNED else quantity}"
    return Layer(filled, levels, tuple(ends), list(bodies), kind)


def draw_lines(axes, cells, moved):
    """Draw the elements faintly, where they are few, and the outlines of the bodies."""
    if cells.count <= 600:
        edges, _ = cells.edges()
        axes.add_collection(
            LineCollection(curves(edges, moved), colors="black", linewidths=0.2, alpha=0.45)
        )
    outline = curves(cells.boundary(), moved)
    for colour, width in (("white", 1.1), ("black", 0.7)):  # to be seen on dark colours, too
        axes.add_collection(LineCollection(outline, colors=colour, linewidths=width))


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
