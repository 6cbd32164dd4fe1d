"""Elements cut into small triangles by their shape functions, for smooth pictures."""

from dataclasses import dataclass

import numpy as np

from .cells import CORNERS, QUADRATIC


def shape_functions(kind, r, s):
    """Return shape functions (points, nodes) in VTK's node order at local coordinates.

    Quadrilaterals have r, s in [-1, 1], triangles r, s >= 0 with r + s <= 1.
    """
    if kind == 5:
        return np.column_stack((1 - r - s, r, s))
    if kind == 22:
        t = 1 - r - s
        corner = [t * (2 * t - 1), r * (2 * r - 1), s * (2 * s - 1)]
        return np.column_stack([*corner, 4 * r * t, 4 * r * s, 4 * s * t])
    ends = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    if kind == 9:
        return np.column_stack([0.25 * (1 + r * a) * (1 + s * b) for a, b in ends])
    corner = [0.25 * (1 + r * a) * (1 + s * b) * (r * a + s * b - 1) for a, b in ends]
    side = [
        0.5 * (1 - r**2) * (1 - s),
        0.5 * (1 + r) * (1 - s**2),
        0.5 * (1 - r**2) * (1 + s),
        0.5 * (1 - r) * (1 - s**2),
    ]
    return np.column_stack([*corner, *side])


@dataclass
class FineMesh:
    """Triangles (k, 3), each of a body, over `count` fine points.

    `sources` holds, for each element type, connectivity (m, nodes), shape functions (p, nodes)
    and the numbers (m, p) of the fine points. Elements share fine points only where they share
    nodes, so nothing is smeared across faces that merely touch.
    """

    triangles: np.ndarray
    bodies: np.ndarray
    sources: list
    count: int

    def areas(self, places):
        """Return the area that each fine point, at `places` (count, 2), stands for: a third of those
        of its triangles."""
        (first, second, third) = np.moveaxis(places[self.triangles], 1, 0)
        across, along = second - first, third - first
        parts = np.abs(across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0]) / 6.0
        return np.bincount(self.triangles.ravel(), np.repeat(parts, 3), self.count)

    def values(self, nodal):
        """Interpolate nodal values (n,) or (n, d) to the fine points."""
        fine = np.empty((self.count, *nodal.shape[1:]))
        for cells, shape, numbers in self.sources:
            fine[numbers] = np.einsum("pk,mk...->mp...", shape, nodal[cells])
        return fine


def edge_keys(first, last, middle, nodes):
    """Return numbers that tell edges apart: the two faces of a crack may share both ends."""
    straight = np.minimum(first, last) * nodes + np.maximum(first, last)
    return np.where(middle < 0, straight, nodes * nodes + middle)


def refine(cells, pieces):
    """Cut every element of `cells` into pieces x pieces parts of two triangles each."""
    nodes = len(cells.points)
    edges, _ = cells.edges()
    keys = np.unique(edge_keys(*edges.T, nodes))
    count = nodes + len(keys) * (pieces - 1)
    sources, triangles, bodies = [], [], []
    for kind, group in cells.groups.items():
        corners = CORNERS[kind]
        grid = local_grid(corners, pieces)
        numbers = np.empty((len(group), len(grid.coordinates[0])), dtype=int)
        numbers[:, grid.corners] = group[:, :corners]
        for k, side in enumerate(grid.sides):
            first, last = group[:, k], group[:, (k + 1) % corners]
            middle = group[:, corners + k] if kind in QUADRATIC else np.full(len(group), -1)
            key = edge_keys(first, last, middle, nodes)
            start = nodes + np.searchsorted(keys, key) * (pieces - 1)
            along = np.arange(pieces - 1)
            along = np.where((first > last)[:, None], along[::-1], along)
            numbers[:, side] = start[:, None] + along
        inner = np.arange(len(group) * len(grid.inner)).reshape(len(group), -1)
        numbers[:, grid.inner] = count + inner
        count += inner.size
        sources.append((group, shape_functions(kind, *grid.coordinates), numbers))
        triangles.append(numbers[:, grid.triangles].reshape(-1, 3))
        bodies.append(np.repeat(cells.bodies[kind], len(grid.triangles)))
    used, triangles = np.unique(np.concatenate(triangles), return_inverse=True)
    place = np.full(count, -1)
    place[used] = np.arange(len(used))
    sources = [(group, shape, place[numbers]) for group, shape, numbers in sources]
    return FineMesh(triangles.reshape(-1, 3), np.concatenate(bodies), sources, len(used))


@dataclass
class LocalGrid:
    """Points of one cut element: which are corners, on the sides (ends left out), inside."""

    coordinates: tuple
    corners: list
    sides: list
    inner: list
    triangles: np.ndarray


def local_grid(corners, n):
    """Return the reference element with 3 or 4 corners, cut n times along each side."""
    steps, squares = range(n + 1), [(i, j) for j in range(n) for i in range(n)]
    if corners == 4:
        where = [(i, j) for j in steps for i in steps]
        walks = [(0, 0, 1, 0), (n, 0, 0, 1), (n, n, -1, 0), (0, n, 0, -1)]
        lower, upper = squares, squares
        scale, shift = 2.0 / n, -1.0
    else:
        where = [(i, j) for j in steps for i in steps if i + j <= n]
        walks = [(0, 0, 1, 0), (n, 0, -1, 1), (0, n, 0, -1)]
        lower = [(i, j) for i, j in squares if i + j < n]
        upper = [(i, j) for i, j in squares if i + j < n - 1]
        scale, shift = 1.0 / n, 0.0
    index = {ij: k for k, ij in enumerate(where)}
    sides = [[index[i + k * di, j + k * dj] for k in steps] for i, j, di, dj in walks]
    parts = [[(i, j), (i + 1, j), (i, j + 1)] for i, j in lower]
    parts += [[(i + 1, j), (i + 1, j + 1), (i, j + 1)] for i, j in upper]
    rim = {k for side in sides for k in side}
    return LocalGrid(
        coordinates=tuple(np.array(where, dtype=float).T * scale + shift),
        corners=[side[0] for side in sides],
        sides=[side[1:-1] for side in sides],
        inner=[k for k in range(len(where)) if k not in rim],
        triangles=np.array([[index[ij] for ij in part] for part in parts]),
    )
