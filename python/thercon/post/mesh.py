"""The undeformed mesh (Fig. 1 of the paper) with a close-up of the contact."""

import re

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import ConnectionPatch, Patch, Rectangle

from . import style
from .cells import curves, outlines
from .rigid_surfaces import draw_rigid, lines_of, with_lines
from .style import plt

SMALLER = 0.8  # of the model: a larger close-up would show nothing new
LEGEND_WIDTH = 4.6  # inches
LEGEND_CHARACTERS = 100  # in a line of the legend, with the signs before them
MOST_MARKED = 80  # contact points are marked one by one up to here
# The slave's band and nodes are wider than the master's, which lie upon them where the faces touch.
SLAVE = {"color": style.VERMILION, "lw": 3.4, "ls": "solid", "marker": "o", "ms": 6.0}
MASTER = {"color": style.BLUE, "lw": 1.8, "ls": (0, (2.2, 1.4)), "marker": "s", "ms": 2.4}


def draw(result, options):
    """Draw the mesh of `result`; return the files written."""
    cells = result.cells
    contacts = result.contacts() if result.contact_names else []
    lines = lines_of(result, None)
    model = with_lines(bounds_of(cells.points[cells.used]), lines)
    near = contact_window(contacts, cells, cells.points) if contacts else model
    has_close_up = np.max(np.ptp(near, axis=0)) < SMALLER * np.max(np.ptp(model, axis=0))
    if has_close_up:
        figure, (whole, close) = two_panels(model, near)
        panels = [(whole, model, False), (close, near, True)]
    else:
        width, height = np.ptp(model, axis=0)
        size = (LEGEND_WIDTH, min(LEGEND_WIDTH, (LEGEND_WIDTH - 0.7) * height / width + 1.2))
        figure, whole = plt.subplots(layout="constrained", figsize=size)
        panels = [(whole, model, True)]
    for axes, window, nodes in panels:
        draw_elements(axes, cells, nodes)
        for contact in contacts:
            draw_faces(axes, cells, result.faces(contact), contact, nodes and is_marked(contacts))
        frame(axes, window, result.units, cut=nodes and has_close_up)
        draw_rigid(axes, lines)
    if has_close_up:
        mark_window(whole, close, near)
        style.panel_title(whole, "", "a")
        style.panel_title(close, "", "b")
    handles = legend_handles(result, contacts, lines)
    longest = max(len(handle.get_label()) for handle in handles)
    figure.legend(
        handles=handles,
        **style.BELOW,
        ncols=int(np.clip(LEGEND_CHARACTERS // (longest + 6), 1, 4)),
        columnspacing=1.4,
    )
    name = style.file_name(result, "mesh")
    return style.write(figure, table(cells), options, name)


def two_panels(model, window):
    """Return a figure and two axes: side by side for a tall model, stacked for a wide one."""
    shares = [float(np.divide(*np.ptp(box, axis=0))) for box in (model, window)]
    if shares[0] <= 1.0:
        height = min(3.1, (style.DOUBLE_COLUMN * 0.8 - 1.7) / sum(shares))
        return plt.subplots(
            1,
            2,
            layout="constrained",
            figsize=(max(height * sum(shares) + 1.7, LEGEND_WIDTH), height + 1.2),
            gridspec_kw={"width_ratios": [max(shares[0], 0.25) + 0.12, shares[1]]},
        )
    wide = style.DOUBLE_COLUMN * 0.7
    heights = [max(1.0 / share, 0.1) for share in shares]
    return plt.subplots(
        2,
        1,
        layout="constrained",
        figsize=(wide, 0.85 * wide * sum(heights) + 1.5),
        gridspec_kw={"height_ratios": heights},
    )


def bounds_of(points):
    """Return [[x least, y least], [x most, y most]] of the points."""
    return np.array([points.min(axis=0), points.max(axis=0)])


def contact_window(contacts, cells, points):
    """Return the window, as in `bounds_of`, about the pairs that ever close (else all pairs).

    `points` (n, 2) are those of `cells`, where they are drawn.
    """
    model, chosen = bounds_of(points[cells.used]), []
    for contact in contacts:
        ever = (contact["status"] > 0).any(axis=0)
        if not ever.any():
            ever[:] = True
        chosen.append(points[np.isin(cells.node_id, contact["slave_node"][ever])])
    low, high = bounds_of(np.concatenate(chosen))
    half = 0.75 * max(np.max(high - low), 0.02 * np.max(model[1] - model[0]))
    middle = 0.5 * (low + high)
    margin = 0.05 * half
    return np.array(
        [np.maximum(middle - half, model[0] - margin), np.minimum(middle + half, model[1] + margin)]
    )


def frame(axes, window, units, cut=False, stretch=1.0):
    """Show the window with labelled axes, y stretched against x; boxed where it cuts the model."""
    width, height = np.ptp(window, axis=0) * (1.0, stretch)
    margin = 0.0 if cut else 0.035 * max(width, height)
    axes.set_aspect(stretch)
    axes.set_xlim(window[0, 0] - margin, window[1, 0] + margin)
    axes.set_ylim(window[0, 1] - margin / stretch, window[1, 1] + margin / stretch)
    axes.set_xlabel(units.label("$x$", "length"))
    axes.set_ylabel(units.label("$y$", "length"))
    aspect = width / height
    labels = 6 if aspect >= 0.6 else int(np.clip(22.0 * aspect, 1, 3))  # that have room
    axes.locator_params(axis="x", nbins=labels, min_n_ticks=min(labels, 2))
    axes.locator_params(axis="y", min_n_ticks=1 if aspect > 10.0 else 2)
    axes.tick_params(direction="out", top=False, right=False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(cut)


def draw_elements(axes, cells, close):
    """Draw the elements tinted by body, and the boundary."""
    names = body_names(cells)
    width = float(np.clip((16.0 if close else 6.0) / np.sqrt(cells.count), 0.12, 0.45))
    for kind, group in cells.groups.items():
        tints = [style.body_tint(names.index(b)) for b in cells.bodies[kind]]
        shapes = outlines(kind, group, cells.points)
        axes.add_collection(
            PolyCollection(shapes, facecolors=tints, edgecolors="#555555", linewidths=width)
        )
    lines = curves(cells.boundary(), cells.points)
    axes.add_collection(LineCollection(lines, colors="black", linewidths=0.9, capstyle="round"))


def draw_faces(axes, cells, faces, contact, close):
    """Mark the two faces of a contact: slave solid, master dashed; nodes in the close-up."""
    thin = 1.0 if close else 0.8
    slave, master = faces
    nodes = contact["slave_node"], contact["master_node"]
    if contact.pairing != "NODES":
        nodes = nodes[0], np.unique(cells.node_id[master[master >= 0]])
    for edges, numbers, looks in ((slave, nodes[0], SLAVE), (master, nodes[1], MASTER)):
        lines = curves(edges, cells.points)
        width, colour = thin * looks["lw"], looks["color"]
        axes.add_collection(
            LineCollection(lines, colors=colour, linewidths=width, linestyles=looks["ls"], zorder=3)
        )
        if close:
            at = cells.points[np.isin(cells.node_id, numbers)]
            marks = {"ls": "none", "mfc": "white", "mew": 0.8, "zorder": 4}
            axes.plot(*at.T, **(looks | marks))


def is_marked(contacts):
    """Return whether there are few enough contact points for marks."""
    return sum(len(contact["slave_node"]) for contact in contacts) <= MOST_MARKED


def mark_window(whole, close, window):
    """Outline the close-up's window in the whole model and lead the eye to it."""
    size = window[1] - window[0]
    looks = {"color": "#303030", "zorder": 6}
    whole.add_patch(Rectangle(window[0], *size, fill=False, linewidth=0.9, **looks))
    if whole.get_subplotspec().get_gridspec().nrows > 1:
        # Lines to a panel below would cross the labels between the two.
        at = {"xytext": (0, 3), "textcoords": "offset points", "ha": "right", "va": "bottom"}
        box = {"boxstyle": "square,pad=0.1", "fc": "white", "ec": "none"}
        whole.annotate("(b)", window[1], fontsize=7.5, zorder=6, bbox=box, **at)
        return
    close.yaxis.tick_right()
    close.yaxis.set_label_position("right")
    for height in (0, 1):
        ends = {"xyA": window[0] + (1, height) * size, "xyB": (0, height)}
        spaces = {"coordsA": whole.transData, "coordsB": close.transAxes}
        link = ConnectionPatch(**ends, **spaces, linewidth=0.5, linestyle=(0, (4, 3)), **looks)
        whole.figure.add_artist(link)


def body_names(cells):
    """Return the bodies' numbers in order."""
    return sorted({int(b) for bodies in cells.bodies.values() for b in bodies})


def legend_handles(result, contacts, lines):
    """Return the legend's entries: bodies, drawings of rigid ones and, where there is contact, the two
    faces; of a drawing no master face is marked."""
    cells = result.cells
    handles = [
        Patch(
            facecolor=style.body_tint(k),
            edgecolor="#555555",
            label=re.sub(r", first node \d+| [(]first node.*", "", result.label_of_body(f"body {name}")),
        )
        for k, name in enumerate(body_names(cells))
    ]
    if contacts:
        looks = [("slave", SLAVE), ("master", MASTER)]
        masters = np.concatenate([contact["master_node"] for contact in contacts])
        if lines and not np.isin(masters, cells.node_id[cells.used]).any():
            looks.pop()
        plain = {} if is_marked(contacts) else {"marker": None}
        handles += [
            Line2D([], [], mfc="white", label=f"contact face, {name}", **(look | plain))
            for name, look in looks
        ]
    if lines:
        handles.append(Line2D([], [], color="black", lw=1.1, label="rigid surface"))
    return handles


def table(cells):
    """Return the drawn mesh as columns: one row for each node of each element, in its order."""
    columns = {"element": [], "body": [], "node": [], "x": [], "y": []}
    for kind, group in cells.groups.items():
        nodes = group.shape[1]
        flat = group.ravel()
        columns["element"].append(np.repeat(cells.element_ids[kind], nodes))
        columns["body"].append(np.repeat(cells.bodies[kind], nodes))
        columns["node"].append(cells.node_id[flat])
        columns["x"].append(cells.points[flat, 0])
        columns["y"].append(cells.points[flat, 1])
    return {name: np.concatenate(parts) for name, parts in columns.items()}
