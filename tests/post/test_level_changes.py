"""The outline of a mesh on which elements of two sizes meet."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))

from thercon.post.cells import Cells  # noqa: E402


def mesh(quadratic):
    """Return a square of side 1 and, on its right, two of side 1/2 one upon the other."""
    squares = [(0, 0, 1), (1, 0, 0.5), (1, 0.5, 0.5)]
    number, cells = {}, []
    for x, y, side in squares:
        corners = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]
        after = [*corners[1:], corners[0]]
        middles = [((a + c) / 2, (b + d) / 2)
                   for (a, b), (c, d) in zip(corners, after, strict=True)]
        nodes = corners + (middles if quadratic else [])
        cells.append([number.setdefault(place, len(number)) for place in nodes])
    kind = 23 if quadratic else 9
    ones = {kind: np.ones(3, dtype=int)}
    return Cells(np.array(list(number)), np.arange(len(number)), {kind: np.array(cells)}, ones,
                 ones)


@pytest.mark.parametrize("quadratic", [False, True])
def test_sides_of_two_sizes_are_no_outline(quadratic):
    """The outline is 1 + 1/2 wide and 1 high; of its seven sides none lies at x = 1."""
    cells = mesh(quadratic)
    outline = cells.boundary()
    ends = cells.points[outline[:, :2]]
    assert np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum() == pytest.approx(5.0)
    assert len(outline) == 7
    assert not np.any(np.all(ends[:, :, 0] == 1.0, axis=1))
