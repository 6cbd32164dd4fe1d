#!/usr/bin/env python3
"""Write hertz.inp, the deck of the Hertz contact of a cylinder and a block, beside this file.

Theory (K. L. Johnson, Contact Mechanics, 1985, section 4.2c): a load P per length of cylinder presses a cylinder of
radius R against a half-space; with 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 (plane strain)

    a^2 = 4 P R/(pi E*),   p(x) = p0 sqrt(1 - x^2/a^2),   p0 = 2 P/(pi a) = E* a/(2 R).

The deck has one half of both bodies, so it carries P/2. Needs numpy.
"""
from math import pi, sqrt
from pathlib import Path

import numpy as np

RADIUS, SIZE = 100.0, 40.0               # mm; both bodies are SIZE wide and SIZE high
YOUNG, POISSON = (2.1e5, 7.0e4), (0.3, 0.33)    # MPa; cylinder, block
TOP_PRESSURE = 6.0                       # MPa
INNER, ACROSS = 1.5, 6                   # mm; square at the contact, elements along each of its sides
RINGS = 11                               # rings of elements from there to the outer sides


def theory():
    """Half-width [mm], peak pressure [MPa] and the force on the half model [N/mm]."""
    half_force = TOP_PRESSURE * SIZE
    compliance = sum((1 - nu**2) / young for young, nu in zip(YOUNG, POISSON))
    half_width = sqrt(4 * 2 * half_force * RADIUS * compliance / pi)
    return half_width, 2 * 2 * half_force / (pi * half_width), half_force


def plain_elements():
    """Quadrilaterals of the square (0, SIZE) x (0, SIZE), counter-clockwise: a small square of equal elements, and
    rings around it, each the last one enlarged, so that elements keep their shape however large they grow."""
    side = np.linspace(0.0, INNER, ACROSS + 1)
    quads = [[(x, y), (right, y), (right, top), (x, top)]
             for y, top in zip(side, side[1:]) for x, right in zip(side, side[1:])]
    rim = np.array([(INNER, y) for y in side] + [(x, INNER) for x in side[-2::-1]])
    scales = np.geomspace(1.0, SIZE / INNER, RINGS + 1)
    for low, high in zip(scales, scales[1:]):
        quads += [[low * p, high * p, high * q, low * q] for p, q in zip(rim, rim[1:])]
    return quads


def make_body(bend):
    """Nodes (number to x, y) and elements of a body above the contact face; `bend` gives the place of the point
    (x, height). Numbers run along the contact first, then row by row away from it."""
    points, elements = {}, []
    for quad in plain_elements():
        corners = [tuple(np.round(p, 6)) for p in quad]
        sides = [tuple(np.round(np.add(corners[k], corners[(k + 1) % 4]) / 2, 7)) for k in range(4)]
        elements.append(corners + sides)
        points.update((p, bend(*p)) for p in corners)
        for k in range(4):
            ends = points[corners[k]], points[corners[(k + 1) % 4]]
            points[sides[k]] = bend(*sides[k]) if sides[k][1] == 0.0 else tuple(np.mean(ends, axis=0))
    number = {p: n for n, p in enumerate(sorted(points, key=lambda p: (p[1], p[0])), start=1)}
    nodes = {number[p]: tuple(round(float(c), 10) for c in points[p]) for p in number}
    return nodes, [[number[p] for p in element] for element in elements]


def make_mesh():
    """Cylinder and block, each as (nodes, elements); the block has its numbers from 1001."""
    upper, elements = make_body(lambda x, y: (x, y + (1 - y / SIZE) * x**2 / (2 * RADIUS)))
    lower, _ = make_body(lambda x, y: (x, 0.0 - y))
    mirrored = [[e[k] + 1000 for k in (1, 0, 3, 2, 4, 7, 6, 5)] for e in elements]
    return (upper, elements), ({n + 1000: p for n, p in lower.items()}, mirrored)


def number_lines(numbers, width=12):
    """Data cards with whole numbers, `width` a card."""
    return [", ".join(map(str, numbers[i:i + width])) for i in range(0, len(numbers), width)]


def mesh_cards(bodies):
    """Cards of nodes, elements, sets and surfaces."""
    cards, nodes = [], {**bodies[0][0], **bodies[1][0]}
    for (own, _), name in zip(bodies, ("CYLINDER", "BLOCK")):
        cards += [f"*NODE, NSET={name}"] + [f"{n}, {x:.12g}, {y:.12g}" for n, (x, y) in own.items()]
    for (_, elements), name, first in zip(bodies, ("CYLINDER", "BLOCK"), (1, 1001)):
        cards += [f"*ELEMENT, TYPE=CPE8, ELSET={name}"]
        cards += [", ".join(map(str, [n] + e)) for n, e in enumerate(elements, start=first)]
    (upper, elements), _ = bodies
    faces = [n for n, e in enumerate(elements, start=1) if all(upper[e[k]][1] == SIZE for k in (1, 2))]
    cards += ["*ELSET, ELSET=LOADED"] + number_lines(faces)
    for name, chosen in (("BOTTOM", [n for n, (x, y) in nodes.items() if y == -SIZE]),
                         ("AXIS", [n for n, (x, y) in nodes.items() if x == 0.0])):
        cards += [f"*NSET, NSET={name}"] + number_lines(chosen)
    faces = [n for n, e in enumerate(elements) if all(bodies[1][0][e[k] + 1000][1] == 0.0 for k in (0, 1))]
    for name, first in (("CURVED", 1), ("FLAT", 1001)):
        cards += [f"*SURFACE, NAME={name}, TYPE=ELEMENT"] + [f"{first + k}, S1" for k in faces]
    return cards


OPENING = """\
*HEADING
Hertz contact of a cylinder and a block, plane strain, without friction
** Written by make_deck.py.
**
** Theory (K. L. Johnson, Contact Mechanics, 1985, section 4.2c), with the load
** P per length of the whole cylinder and its radius R = 100:
**   1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2         E* = {modulus:.3f}
**   a    = sqrt(4 P R/(pi E*))                     a  = {half_width:.7f}
**   p0   = 2 P/(pi a)                              p0 = {peak:.5f}
**   p(x) = p0 sqrt(1 - x^2/a^2)
**
** Half model about the symmetry axis x = 0, both bodies 40 wide and 40 high; it
** carries P/2 = 6 x 40 = 240, a pressure of 6 on top. a is 1/39 of the bodies'
** size: what their ends change in a and p0 is of the order of (a/40)^2.
**
** The curved face is y = x^2/(2 R), midside nodes at mid-x and on the curve;
** each node stands opposite one of the block. The elements at the contact are
** 0.25 = a/4 wide before they are refined, and grow in rings around it that
** keep their shape. The checks hold as well without refinement and with more.
"""

MODEL = """\
*MATERIAL, NAME=STEEL
*ELASTIC
2.1E5, 0.3
*MATERIAL, NAME=ALUMINIUM
*ELASTIC
7.E4, 0.33
*SOLID SECTION, ELSET=CYLINDER, MATERIAL=STEEL
*SOLID SECTION, ELSET=BLOCK, MATERIAL=ALUMINIUM
*SURFACE INTERACTION, NAME=SMOOTH
*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE
CURVED, FLAT
*REFINE, LEVELS=1
*BOUNDARY
BOTTOM, 2, 2, 0.
AXIS, 1, 1, 0.
*STEP
*STATIC, DIRECT
0.25, 1.
*DLOAD
LOADED, P2, 6.
*NODE FILE
U
*EL FILE
S
*CONTACT FILE
CDIS, CSTR
*CONTACT PRINT
CDIS, CSTR
*END STEP
"""

CHECKS = """\
*VERIFY, KIND=ANALYTIC, SOURCE="Hertz: half-width as root of the load"
edge_contact, , 0.25, {quarter:.7f}, 2.E-2
edge_contact, , LAST, {half_width:.7f}, 1.E-2
*VERIFY, KIND=ANALYTIC, SOURCE="Hertz: pressure at x = 0 and 0.5 and outside"
pressure, MAX, LAST, {peak:.5f}, 1.E-2
pressure, FACE@0., LAST, {peak:.5f}, 1.E-2
pressure, FACE@0.5, LAST, {inner:.5f}, 1.E-2
pressure, FACE@1.25, LAST, 0., 1.E-12, ABS
** The normals of the closed pairs lean by up to a/(2 R), 1 - cos = 1.3e-5.
*VERIFY, KIND=ANALYTIC, SOURCE="balance with the load on top"
normal_force, , 0.25, {quarter_force:g}, 2.E-5
normal_force, , LAST, {half_force:g}, 2.E-5
** Under 1e-11 here; it is rounding, which grows as the mesh is refined.
force_imbalance, , LAST, 0., 1.E-8, ABS
*VERIFY, KIND=ANALYTIC, SOURCE="supports; no friction"
U1, AXIS, LAST, 0., 1.E-15, ABS
U2, BOTTOM, LAST, 0., 1.E-15, ABS
shear, MAX, LAST, 0., 1.E-12, ABS
"""


def main():
    half_width, peak, half_force = theory()
    values = {"half_width": half_width, "peak": peak, "half_force": half_force, "quarter": half_width / 2,
              "quarter_force": half_force / 4, "inner": peak * sqrt(1 - 0.25 / half_width**2),
              "modulus": 2 * RADIUS * peak / half_width}
    cards = OPENING.format(**values).splitlines() + ['*OPTIONS, UNITS="mm MPa W C"'] + mesh_cards(make_mesh())
    cards += MODEL.splitlines() + CHECKS.format(**values).splitlines()
    assert max(map(len, cards)) <= 80
    (Path(__file__).parent / "hertz.inp").write_text("\n".join(cards) + "\n")


if __name__ == "__main__":
    main()
