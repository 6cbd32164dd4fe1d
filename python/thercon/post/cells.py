"""The mesh of the result file: points, elements, curved element edges."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .checked_file import need, numbers

# VTK cell type -> corners; quadratic cells list their midside nodes after the corners.
CORNERS = {5: 3, 22: 3, 9: 4, 23: 4}
NODES = {5: 3, 22: 6, 9: 4, 23: 8}
QUADRATIC = {22, 23}


@dataclass
class Cells:
    """Points (n, 2) and cells grouped by VTK type: {type: connectivity (m, nodes)}.

    `members` are the places of the cells of a type among those of the file.
    """

    points: np.ndarray
    node_id: np.ndarray
    groups: dict
    bodies: dict
    element_ids: dict
    members: dict = field(default_factory=dict)

    @classmethod
    def read(cls, group):
        """Read the mesh of a VTKHDF group that has one part, the same at all times."""
        count = len(numbers(group, "Points", like=(None, 3)))
        cells = len(numbers(group, "Types", like=(None,)))
        need(group, count > 0 and cells > 0, "there are no points or cells")
        points = numbers(group, "Points", finite=True)[:, :2].astype(float)
        types = numbers(group, "Types").astype(int)
        offsets = numbers(group, "Offsets", like=(cells + 1,)).astype(int)
        connectivity = numbers(group, "Connectivity", like=(None,)).astype(int)
        node_id = numbers(group, "PointData/node_id")[:count].astype(int)
        need(group, np.isin(types, list(NODES)).all(), "Types has values that are no cells of thercon")
        need(group, offsets[0] == 0 and np.all(np.diff(offsets) == [NODES[k] for k in types])
             and offsets[-1] <= len(connectivity), "Offsets do not fit the types of the cells")
        connectivity = connectivity[: offsets[-1]]
        need(group, connectivity.min() >= 0 and connectivity.max() < count,
             "Connectivity names points that are not there")
        need(group, node_id.shape == (count,), "PointData/node_id has not one number for each point")
        body = cls._cell_data(group, "body", cells)
        element = cls._cell_data(group, "element_id", cells)
        groups, bodies, elements, places = {}, {}, {}, {}
        for kind in np.unique(types):
            members = np.flatnonzero(types == kind)
            groups[int(kind)] = connectivity[offsets[members][:, None] + np.arange(NODES[int(kind)])]
            bodies[int(kind)] = body[members]
            elements[int(kind)] = element[members]
            places[int(kind)] = members
        return cls(points, node_id, groups, bodies, elements, places)

    @staticmethod
    def _cell_data(group, name, cells):
        name = f"CellData/{name}"
        if name not in group:
            return np.ones(cells, dtype=int)
        data = numbers(group, name)[:cells].astype(int)
        need(group, data.shape == (cells,), f"{name} has not one number for each cell")
        return data

    @property
    def count(self):
        """Number of cells."""
        return sum(len(each) for each in self.groups.values())

    @cached_property
    def used(self):
        """Which points are of an element: reference nodes are not."""
        found = np.zeros(len(self.points), dtype=bool)
        for group in self.groups.values():
            found[group] = True
        return found

    def edges(self):
        """Return element edges (e, 3) as corner, corner, midside and how often each is used.

        A straight edge of a linear element has midside -1.
        """
        found = []
        for kind, cells in self.groups.items():
            corners = CORNERS[kind]
            for k in range(corners):
                first, last = cells[:, k], cells[:, (k + 1) % corners]
                middle = cells[:, corners + k] if kind in QUADRATIC else np.full(len(cells), -1)
                low, high = np.minimum(first, last), np.maximum(first, last)
                found.append(np.column_stack((low, high, middle)))
        return np.unique(np.concatenate(found), axis=0, return_counts=True)

    def boundary(self):
        """Return the edges that only one element has, without those where two sizes meet."""
        edges, uses = self.edges()
        edges = edges[uses == 1]
        return edges[~self.between_sizes(edges)]

    def between_sizes(self, edges):
        """Return which edges, each of one element, are a large element's or of two halves of it."""
        index = {frozenset(ends): i for i, ends in enumerate(edges[:, :2].tolist())}
        joined = {}
        for first, last in edges[:, :2].tolist():
            joined.setdefault(first, set()).add(last)
            joined.setdefault(last, set()).add(first)
        found = np.zeros(len(edges), dtype=bool)
        for i, (first, last, middle) in enumerate(edges.tolist()):
            for node in joined[first] & joined[last]:
                if middle >= 0:
                    is_middle = node == middle
                else:
                    a, b, m = self.points[[first, last, node]]
                    is_middle = np.allclose(m, 0.5 * (a + b), rtol=0.0,
                                            atol=1e-6 * np.linalg.norm(b - a))
                if is_middle:
                    halves = index[frozenset((first, node))], index[frozenset((node, last))]
                    found[[i, *halves]] = True
        return found

    def face(self, node_ids):
        """Return the boundary edges all of whose points carry one of the deck's node numbers."""
        edges = self.boundary()
        on_face = np.isin(self.node_id, node_ids)
        middle = np.where(edges[:, 2] < 0, True, on_face[edges[:, 2]])
        return edges[on_face[edges[:, 0]] & on_face[edges[:, 1]] & middle]


def curves(edges, points, pieces=8):
    """Return edges as polylines (e, pieces + 1, 2) on the given points (n, 2)."""
    t = np.linspace(0.0, 1.0, pieces + 1)[None, :, None]
    first, last = points[edges[:, 0]][:, None, :], points[edges[:, 1]][:, None, :]
    straight = 0.5 * (first + last)
    middle = points[edges[:, 2]][:, None, :]
    middle = np.where((edges[:, 2] < 0)[:, None, None], straight, middle)
    return (1 - t) * (1 - 2 * t) * first + t * (2 * t - 1) * last + 4 * t * (1 - t) * middle


def outlines(kind, cells, points, pieces=8):
    """Return the curved outlines (m, k, 2) of the cells of one type."""
    corners = CORNERS[kind]
    sides = []
    for k in range(corners):
        middle = cells[:, corners + k] if kind in QUADRATIC else np.full(len(cells), -1)
        edge = np.column_stack((cells[:, k], cells[:, (k + 1) % corners], middle))
        sides.append(curves(edge, points, pieces)[:, :-1])
    return np.concatenate(sides, axis=1)
