"""Meshes of the cylinder on its base: structured ones, ones that are thinned by transitions, even
on the contact or graded towards the axis, and graded ones that are refined where contact ends.

A body is strips between rows of points, from the contact outwards; the base is the mirror image of
the cylinder with a flat face. Nodes of both faces stand opposite each other.
"""

from dataclasses import dataclass

import numpy as np

WIDTH, HEIGHT, FINE = 30.0, 60.0, 9.0   # [cm]; contact never reaches beyond FINE
GRADED = 3.0   # last by first length up to there in a graded mesh
# Middles of the sides that are divided in a refined mesh: contact ends from 2.9 to 7.5.
DIVIDED = 2.5, 8.0   # [cm]
# Corner abscissae of the published mesh's contact.
PUBLISHED = [0.0, 0.8, 1.7, 2.6, 3.6, 4.8, 6.0, 7.4, 9.0, 14.0, WIDTH]


@dataclass(frozen=True)
class Body:
    """Places of nodes by their numbers, elements as corners and midside nodes, sides in contact,
    and of each hanging node the nodes of the larger side with their factors."""

    nodes: dict
    elements: list
    sides: int
    hanging: dict


def growth(first, total, count):
    """Return the ratio of `count` lengths that begin with `first` and make up `total`."""
    low, high = 1.0, 50.0
    for _ in range(100):
        middle = (low + high) / 2
        long = sum(first * middle**k for k in range(count)) > total
        low, high = (low, middle) if long else (middle, high)
    return low


def face(family, count):
    """Return the corner abscissae of the contact: up to FINE even or graded, then ever longer."""
    ratio = GRADED if family in ("graded", "refined") else 1.0
    if count == len(PUBLISHED) - 1 and ratio == 1.0:
        return list(PUBLISHED)
    outside = max(2, round(2 * np.log2(count / 5)))
    steps = ratio ** (np.arange(count - outside) / (count - outside - 1))
    inner = np.concatenate([[0.0], FINE * np.cumsum(steps) / steps.sum()])
    last = inner[-1] - inner[-2]
    more = growth(last, WIDTH - FINE, outside)
    outer = np.cumsum(last * more ** np.arange(1, outside + 1))
    return [*inner, *(FINE + outer * (WIDTH - FINE) / outer[-1])]


def thinned(row, longest):
    """Return a row in which three sides make one, unless it were longer than `longest`."""
    points, k = [row[0]], 0
    while k < len(row) - 1:
        k += 3 if k + 3 < len(row) and row[k + 3] - row[k] < longest else 1
        points.append(row[k])
    return points


def transition(low, high):
    """Return the quadrilaterals between a row of points and the same thinned."""
    quads, k = [], 0
    for left, right in zip(high, high[1:], strict=False):
        step = 3 if k + 3 < len(low) and np.isclose(low[k + 3][0], right[0]) else 1
        base = [np.array(p) for p in low[k:k + step + 1]]
        k += step
        left, right = np.array(left), np.array(right)
        if step == 1:
            quads.append([base[0], base[1], right, left])
            continue
        inner = [np.array([base[n][0], (base[n][1] + left[1]) / 2]) for n in (1, 2)]
        quads += [[base[0], base[1], inner[0], left], [base[1], base[2], inner[1], inner[0]],
                  [base[2], base[3], right, inner[1]], [inner[0], inner[1], right, left]]
    return quads


def structured_rows(row, ratio):
    """Return rows of one layout, whose distance grows by a ratio."""
    first = FINE / (0.8 * (len(row) - 1))
    layers = max(3, round(np.log(1 + HEIGHT * (ratio - 1) / first) / np.log(ratio)))
    exact = growth(first, HEIGHT, layers)
    heights = np.cumsum([0.0, *(first * exact**k for k in range(layers))])
    return [row] * (layers + 1), heights * HEIGHT / heights[-1]


def thinned_rows(row):
    """Return rows that are thinned as long as sides do not get too long for so fine a mesh: two
    layers, a transition, and so on, as high as sides are long; then ever higher ones."""
    count, rows, heights = len(row) - 1, [row], [0.0]
    size, longest = FINE / (0.8 * count), 60 / np.sqrt(count)
    while 3 * size < longest:
        row = rows[-1]
        rows += [row, row, thinned(row, longest)]
        heights += [heights[-1] + size, heights[-1] + 2 * size, heights[-1] + 4 * size]
        size *= 3
    row = rows[-1]
    left = HEIGHT - heights[-1]
    layers = max(1, round(np.log(1 + 0.6 * left / size) / np.log(1.6)))
    ratio = growth(size, left, layers)
    steps = np.cumsum([size * ratio**k for k in range(layers)])
    return rows + [row] * layers, [*heights, *(heights[-1] + steps * left / steps[-1])]


def quadrilaterals(rows, heights):
    """Return the corners of all elements of a rectangle."""
    quads = []
    points = [[(x, y) for x in row] for row, y in zip(rows, heights, strict=True)]
    for low, high in zip(points, points[1:], strict=False):
        if len(low) == len(high):
            quads += [[low[i], low[i + 1], high[i + 1], high[i]] for i in range(len(low) - 1)]
        else:
            quads += transition(low, high)
    return quads


def middle(p, q):
    """Return the point between two, as a key."""
    return tuple(np.round(np.add(p, q) / 2, 9))


def quarters(quad):
    """Return the quadrilaterals into which a rectangle is divided, the lower ones first."""
    (left, low), (right, high) = quad[0], quad[2]
    x, y = middle(*quad[::2])
    return [[(a, c), (b, c), (b, d), (a, d)]
            for c, d in ((low, y), (y, high)) for a, b in ((left, x), (x, right))]


def is_divided(left, right):
    """Return whether a side of the contact is divided in a refined mesh."""
    return DIVIDED[0] < (left + right) / 2 < DIVIDED[1]


def hanging_points(large, small, order):
    """Return the points of small elements that hang on sides of large ones, with their factors."""
    ends, found = {p for corners in small for p in corners}, {}
    for corners in large:
        for p, q in zip(corners, corners[1:] + corners[:1], strict=True):
            m = middle(p, q)
            if m in ends and order == 1:
                found[m] = {p: 0.5, q: 0.5}
            elif m in ends:
                found |= {middle(p, m): {p: 0.375, m: 0.75, q: -0.125},
                          middle(q, m): {q: 0.375, m: 0.75, p: -0.125}}
    return found


def body(rows, heights, radius, order, refined=False):
    """Return a body; its face is on y = x^2/(2 radius), or flat with an infinite radius. A refined
    one is divided along the face as *REFINE does it: new nodes are where the shape functions of
    the element are that they divide."""
    def bent(x, y):
        return x, y + (1 - y / HEIGHT) * x * x / (2 * radius)

    def inside(quad, x, y):
        (left, low), (right, high) = quad[0], quad[2]
        s, t = (x - left) / (right - left), (y - low) / (high - low)
        x, y = np.dot([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t],
                      [bent(*corner) for corner in quad])
        sag = s * (1 - s) * (right - left)**2 / (2 * radius)   # of the chord above the face
        return x, y - (1 - t) * sag * (order == 2)

    places, faces, others, large, small = {}, [], [], [], []
    for k, quad in enumerate(quadrilaterals(rows, heights)):
        quad = [tuple(np.round(p, 9)) for p in quad]
        on_face = k < len(rows[0]) - 1
        divided = refined and on_face and is_divided(quad[0][0], quad[1][0])
        for n, corners in enumerate(quarters(quad) if divided else [quad]):
            middles = [middle(corners[k], corners[(k + 1) % 4]) for k in range(4)]
            (small if divided else large).append(corners)
            (faces if on_face and n < 2 else others).append(corners + middles * (order == 2))
            if divided:
                places |= {p: inside(quad, *p) for p in corners + middles * (order == 2)}
                continue
            places |= {p: bent(*p) for p in corners}
            if order == 2:
                places |= {p: bent(*p) if p[1] == 0.0 else tuple(
                    np.mean([bent(*corners[k]), bent(*corners[(k + 1) % 4])], axis=0))
                    for k, p in enumerate(middles)}
    number = {p: n for n, p in enumerate(sorted(places, key=lambda p: (p[1], p[0])), start=1)}
    return Body({number[p]: tuple(map(float, places[p])) for p in number},
                [[number[p] for p in element] for element in faces + others], len(faces),
                {number[p]: {number[q]: factor for q, factor in terms.items()}
                 for p, terms in hanging_points(large, small, order).items()})


def below(upper, first):
    """Return the mirror image of a body, its numbers behind `first`."""
    turned = (1, 0, 3, 2, 4, 7, 6, 5)
    return Body({n + first: (x, 0.0 - y) for n, (x, y) in upper.nodes.items()},
                [[e[k] + first for k in turned[: len(e)]] for e in upper.elements], upper.sides,
                {n + first: {q + first: factor for q, factor in terms.items()}
                 for n, terms in upper.hanging.items()})


def make(family, count, order, radius, divided=True):
    """Return cylinder and base of a family, of a refined mesh before its sides are divided if they
    are not."""
    row = face(family, count)
    rows = structured_rows(row, 1.6) if family == "structured" else thinned_rows(row)
    refined = divided and family == "refined"
    flat = body(*rows, np.inf, order, refined)
    return body(*rows, radius, order, refined), below(flat, 10 ** len(str(len(flat.nodes) + 1)))
