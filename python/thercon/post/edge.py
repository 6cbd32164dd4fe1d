"""Fields along the outline of a body, such as a free face: from node to node, over the arc length."""

from string import ascii_lowercase

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from . import style
from .cells import curves
from .errors import UserError
from .fields import read_fields, title_of
from .result import CELL_FIELDS, FACE_SOURCES
from .style import plt

PIECES = 16  # into which a side is divided for its length


def draw(result, options):
    """Draw the fields asked for along the way at all loads; return the files written."""
    elementwise = [name for name in options.quantity or () if name in CELL_FIELDS]
    if elementwise:
        raise UserError(f"{elementwise[0]} is a field of elements and has no values along an edge")
    points, s, turns = way(result, options.nodes)
    rows = result.rows(options.load, options.increment, with_fields=True)
    fields = [read_fields(result, result.field_row(row), options.quantity, FACE_SOURCES) for row in rows]
    keys = [key for key in fields[-1] if all(key in each for each in fields)]
    table = {"load": np.repeat(result.history["load"][rows], len(points)),
             "node": np.tile(result.cells.node_id[points], len(rows)), "s": np.tile(s, len(rows)),
             "x": np.tile(result.cells.points[points, 0], len(rows)),
             "y": np.tile(result.cells.points[points, 1], len(rows))}
    table |= {key: np.concatenate([each[key][points] for each in fields]) for key in keys}
    parts = [*options.nodes, *(options.quantity or ())]
    if options.load or options.increment:
        parts += [part for row in rows for part in result.row_words(row)]
    figure = picture(result, rows, s, turns, {key: [each[key][points] for each in fields] for key in keys})
    return style.write(figure, table, options, style.file_name(result, "edge", *parts))


def picture(result, rows, s, turns, curves_of):
    """Return the figure: a panel for each field, a curve for each load; dotted lines are the nodes
    that the way turns to."""
    figure, grid = plt.subplots(len(curves_of), sharex=True, layout="constrained", squeeze=False,
                                figsize=(style.SINGLE_COLUMN * 1.3, 0.7 + 1.8 * len(curves_of)))
    for axes, letter, (key, values) in zip(grid.flat, ascii_lowercase, curves_of.items()):
        for row, colour, each in zip(rows, style.shades(len(rows)), values, strict=True):
            axes.plot(s, each, color=colour, label=style.plain(result.load_words(row)))
        for place in turns:
            axes.axvline(place, color=style.BLACK, lw=0.5, ls=":")
        axes.set_ylabel(result.units.label(*title_of(result, key)))
        style.panel_title(axes, "", letter if len(curves_of) > 1 else "")
    grid.flat[-1].set_xlabel(result.units.label("Arc length $s$", "length"))
    figure.legend(*grid.flat[0].get_legend_handles_labels(), **style.BELOW, ncols=min(len(rows), 3))
    return figure


def way(result, numbers):
    """Return the points of the shortest way along outlines by nodes, their arc lengths before
    deformation, and those of the nodes between the first and the last."""
    if len(numbers or ()) < 2:
        raise UserError("an edge needs two nodes of an outline at least: --nodes FIRST LAST")
    links = links_of(result.cells)
    points, s, ends = [], [], []
    for number in numbers:
        there = np.intersect1d(np.flatnonzero(result.cells.node_id == number), links.nonzero())
        if not there.size:
            raise UserError(f"{result.path}: node {number} is on no outline of a body")
        start = points[-1:] or there
        lengths, before, _ = dijkstra(links, indices=start, return_predecessors=True, min_only=True)
        leg = [there[np.argmin(lengths[there])]]
        if np.isinf(lengths[leg[0]]):
            raise UserError(f"{result.path}: node {number} is on another outline than the node before it: "
                            "a way stays on that of one body")
        while leg[-1] not in start:
            leg.append(before[leg[-1]])
        new = leg[::-1][1 if points else 0:]
        s += ((s[-1] if s else 0.0) + lengths[new]).tolist()
        points += new
        ends.append(s[-1])
    return np.array(points), np.array(s), ends[1:-1]


def links_of(cells):
    """Return the distances of neighbours along the sides of outlines, as a sparse matrix of points."""
    edges = cells.boundary()
    chords = np.linalg.norm(np.diff(curves(edges, cells.points, PIECES), axis=1), axis=2)
    halves = chords.reshape(len(edges), 2, -1).sum(axis=2)
    first, last, middle = edges.T
    curved = middle >= 0
    ends = [(first[~curved], last[~curved], halves[~curved].sum(axis=1)),
            (first[curved], middle[curved], halves[curved, 0]),
            (middle[curved], last[curved], halves[curved, 1])]
    one, other, length = (np.concatenate(each) for each in zip(*ends, strict=True))
    count = len(cells.points)
    return csr_array((np.tile(length, 2), (np.append(one, other), np.append(other, one))), (count, count))
