#!/usr/bin/env python3
"""Write cylinder.inp and cylinder-coupled.inp, the decks of the published cylinder, and those of
the cylinder that yields and that is heated in finite time, beside this file; with `--calculix FILE`
write only FILE, the cylinder with a conductance that CalculiX knows too, for both programs; with
`--yielding` as well, that of the cylinder that yields.

The paper (Zaitsev, 1987) gives 92 eight-node elements, 326 nodes and 21 contact pairs; layout and grading are ours.
Each body has six strips, seen from the contact: two layers of 10 elements, a 3-to-1 transition from 10 to 4 columns
(13 elements), two layers of 4 and a transition from 4 to 2 (5 elements). The base is the mirror image of the cylinder
but for the curved face, which fades out towards the top. Needs numpy.
"""
import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np

RADIUS, WIDTH, HEIGHT, LIFT = 100.0, 30.0, 60.0, 0.5
FINE, NEAR = 9.0, 7.0    # abscissa and height up to which the grading suits the contact

# Corner abscissae of the seven rows between the strips and the heights of these rows, from the contact outwards.
CONTACT = [0.0, 0.8, 1.7, 2.6, 3.6, 4.8, 6.0, 7.4, 9.0, 14.0, WIDTH]
LAYER = [0.0, 1.1, 2.2, 3.4, 4.6, 5.9, 7.3, 8.9, 11.2, 16.0, WIDTH]
COARSE = [0.0, 4.0, 9.0, 17.0, WIDTH]
ROWS = [CONTACT, CONTACT, LAYER, COARSE, COARSE, COARSE, [0.0, 15.0, WIDTH]]
HEIGHTS = [0.0, 1.0, 2.5, 7.0, 14.0, 30.0, HEIGHT]


@dataclass(frozen=True)
class Reading:
    """What the paper leaves open, as the decks here read it: half the width and the height of each body, its curved
    face, its supports, and the Poisson ratios of cylinder and base. `fine` moves the nodes of the face."""

    width: float = WIDTH
    height: float = HEIGHT
    fine: float = FINE
    arc: bool = False
    ends_held: bool = False
    plane_stress: bool = False
    poisson: tuple = (0.4, 0.2)

    def abscissa(self, x):
        """Place of a row's point: the fine part in proportion, the rest up to the width."""
        return rescaled(x, FINE, WIDTH, self.fine, self.width)

    def rows(self):
        """Corner abscissae of the seven rows."""
        return [[self.abscissa(x) for x in row] for row in ROWS[:-1]] + [[0.0, self.width / 2, self.width]]

    def heights(self):
        """Heights of the seven rows."""
        return [rescaled(y, NEAR, HEIGHT, NEAR, self.height) for y in HEIGHTS]

    def face(self, x):
        """Height of the curved face."""
        return RADIUS - (RADIUS**2 - x**2)**0.5 if self.arc else x**2 / (2 * RADIUS)


PUBLISHED = Reading()


def rescaled(value, inner, outer, new_inner, new_outer):
    """A value from 0 to `outer`, moved so that `inner` and `outer` come to other places and all between in proportion;
    values stay as they are, to the last digit, where nothing moves."""
    if value <= inner:
        return value if new_inner == inner else value * new_inner / inner
    if (new_inner, new_outer) == (inner, outer):
        return value
    return new_inner + (value - inner) * (new_outer - new_inner) / (outer - inner)


def strip_elements(low, high):
    """Quadrilaterals of a strip between two rows of points, counter-clockwise: with equal rows one an interval,
    else every three intervals of the lower row meet one of the upper (four elements), a last one stays single."""
    if len(low) == len(high):
        return [[low[i], low[i + 1], high[i + 1], high[i]] for i in range(len(low) - 1)]
    quads = []
    for column in range(len(high) - 1):
        base = [np.array(p) for p in low[3 * column:3 * column + 4]]
        left, right = np.array(high[column]), np.array(high[column + 1])
        if len(base) == 2:
            quads.append([base[0], base[1], right, left])
            continue
        inner = [(base[k] + left + (right - left) * k / 3) / 2 for k in (1, 2)]
        quads += [[base[0], base[1], inner[0], left], [base[1], base[2], inner[1], inner[0]],
                  [base[2], base[3], right, inner[1]], [inner[0], inner[1], right, left]]
    return quads


def make_body(curved, reading=PUBLISHED):
    """Nodes (number to x, y) and elements (lists of eight numbers) of the upper body, its contact face either on
    the reading's curve or flat. Numbers run along the contact first, then row by row away from it."""
    rows = [[(x, height) for x in row] for row, height in zip(reading.rows(), reading.heights())]
    quads = [quad for low, high in zip(rows, rows[1:]) for quad in strip_elements(low, high)]
    points, elements = {}, []
    for quad in quads:
        corners = [tuple(np.round(p, 9)) for p in quad]
        sides = [tuple(np.round(np.add(corners[k], corners[(k + 1) % 4]) / 2, 9)) for k in range(4)]
        elements.append(corners + sides)
        for k in range(4):
            points[corners[k]] = bend(corners[k], curved, reading)
        for k in range(4):
            ends = points[corners[k]], points[corners[(k + 1) % 4]]
            on_face = sides[k][1] == 0.0
            points[sides[k]] = bend(sides[k], curved, reading) if on_face else tuple(np.mean(ends, axis=0))
    number = {p: n for n, p in enumerate(sorted(points, key=lambda p: (p[1], p[0])), start=1)}
    nodes = {number[p]: tuple(round(float(c), 9) for c in points[p]) for p in number}
    return nodes, [[number[p] for p in element] for element in elements]


def bend(point, curved, reading):
    """Move a point of the plain rectangle to its place over the curved face."""
    x, height = point
    return (x, height + curved * (1 - height / reading.height) * reading.face(x))


def make_mesh(lift=0.0, reading=PUBLISHED):
    """Both bodies, the upper one first, as (nodes, elements); the base has its numbers from 1001."""
    upper, upper_elements = make_body(True, reading)
    lower, lower_elements = make_body(False, reading)
    upper = {n: (x, round(y + lift, 9)) for n, (x, y) in upper.items()}
    lower = {n + 1000: (x, 0.0 - y) for n, (x, y) in lower.items()}
    mirrored = [[e[k] + 1000 for k in (1, 0, 3, 2, 4, 7, 6, 5)] for e in lower_elements]
    return (upper, upper_elements), (lower, mirrored)


def smallest_jacobian(nodes, elements):
    """Smallest determinant of the Jacobian over 3x3 Gauss points and nodes, relative to the element's mean."""
    gauss = [(a, b) for a in (-0.6**0.5, 0, 0.6**0.5) for b in (-0.6**0.5, 0, 0.6**0.5)]
    corners = [(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0)]
    smallest = np.inf
    for element in elements:
        place = np.array([nodes[n] for n in element])
        values = [np.linalg.det(shape_derivatives(*p) @ place) for p in gauss + corners]
        smallest = min(smallest, min(values) / np.mean(values))
    return smallest


def shape_derivatives(a, b):
    """Derivatives (2, 8) of the eight-node shape functions by the two element coordinates."""
    by_a, by_b = [], []
    for p, q in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        by_a.append(p * (1 + b * q) * (2 * a * p + b * q) / 4)
        by_b.append(q * (1 + a * p) * (2 * b * q + a * p) / 4)
    by_a += [-a * (1 - b), (1 - b * b) / 2, -a * (1 + b), -(1 - b * b) / 2]
    by_b += [-(1 - a * a) / 2, -b * (1 + a), (1 - a * a) / 2, -b * (1 - a)]
    return np.array([by_a, by_b])


def check_mesh(bodies, lift, reading=PUBLISHED):
    """Stop unless the mesh has the published counts, positive Jacobians and opposite contact nodes."""
    (upper, upper_elements), (lower, lower_elements) = bodies
    assert len(upper) + len(lower) == 326 and len(upper_elements) + len(lower_elements) == 92
    for nodes, elements in bodies:
        assert smallest_jacobian(nodes, elements) > 0.2
        edges = [tuple(sorted((e[k], e[(k + 1) % 4]))) for e in elements for k in range(4)]
        assert len([e for e in set(edges) if edges.count(e) == 1]) == 24    # conforming: 10 + 2 + 2*6 outer edges
    for n in range(1, 22):
        x, y = upper[n]
        assert lower[n + 1000] == (x, 0.0) and abs(y - lift - reading.face(x)) < 2e-9    # nine decimals
    assert all(abs(2 * upper[n][0] - upper[n - 1][0] - upper[n + 1][0]) < 4e-9 for n in range(2, 21, 2))


def number_lines(numbers, width=12):
    """Data cards with whole numbers, `width` a card."""
    return [", ".join(map(str, numbers[i:i + width])) for i in range(0, len(numbers), width)]


def mesh_cards(bodies):
    """Cards of nodes, elements, sets and surfaces."""
    (upper, upper_elements), (lower, lower_elements) = bodies
    cards = []
    for nodes, name in ((upper, "CYLINDER"), (lower, "BASE")):
        cards += [f"*NODE, NSET={name}"] + [f"{n}, {x:.12g}, {y:.12g}" for n, (x, y) in nodes.items()]
    for elements, name, first in ((upper_elements, "CYLINDER", 1), (lower_elements, "BASE", 1001)):
        cards += [f"*ELEMENT, TYPE=CPE8, ELSET={name}"]
        cards += [", ".join(map(str, [n] + e)) for n, e in enumerate(elements, start=first)]
    nodes = {**upper, **lower}
    highest, lowest = max(y for _, y in nodes.values()), min(y for _, y in nodes.values())
    for name, chosen in (("TOP", [n for n, (x, y) in nodes.items() if y == highest]),
                         ("BOTTOM", [n for n, (x, y) in nodes.items() if y == lowest]),
                         ("AXIS", [n for n, (x, y) in nodes.items() if x == 0.0])):
        cards += [f"*NSET, NSET={name}"] + number_lines(chosen)
    for name, first in (("CURVED", 1), ("FLAT", 1001)):
        cards += [f"*SURFACE, NAME={name}, TYPE=ELEMENT"] + [f"{first + k}, S1" for k in range(10)]
    return cards


OPENING = """\
*HEADING
{heading}
** V. I. Zaitsev, On the contact problem of the coupled theory of thermal
** stresses and a method of its numerical solution, 1987: the example.
** Written by make_decks.py.
**
** From the paper: part of a cylinder of radius 100, 30 x 60, on a base of the
** same size; materials, friction and conductance; 92 eight-node elements, 326
** nodes, 21 contact pairs; top heated from 0 to 900, bottom held at 0.
**
** Our reading, where the paper is silent:
** - half model about the symmetry axis x = 0, 30 wide, each body 60 high;
** - plane strain;
** - u_y = 0 on the top and bottom sections, u_x = 0 on the axis, the sides
**   free and insulated;
{first_touch}
** - the curved face is y = x^2/(2 R), corner and midside nodes alike, midside
**   nodes at mid-x, each node opposite one of the base;
** - layout: from the contact, layers of 10 and 10 elements, a 3-to-1
**   transition to 4 (13 elements), layers of 4 and 4, a transition to 2 (5);
** - grading: the face is finest between x = 0 and 9, where the contact lives;
** - 45 increments of 20.
"""

MODEL = """\
*MATERIAL, NAME=UPPER
*ELASTIC
2.E4, {poisson[0]}
*EXPANSION
1.2E-5
*CONDUCTIVITY
0.18
*MATERIAL, NAME=LOWER
*ELASTIC
2.E4, {poisson[1]}
*EXPANSION
{base_expansion}
*CONDUCTIVITY
0.18
*SOLID SECTION, ELSET=CYLINDER, MATERIAL=UPPER
*SOLID SECTION, ELSET=BASE, MATERIAL=LOWER
*INITIAL CONDITIONS, TYPE=TEMPERATURE
CYLINDER, 0.
BASE, 0.
*SURFACE INTERACTION, NAME=FACES
*FRICTION
0.155, 1.E5
*GAP LAW, TYPE=GAS
0.24E-5, 0.3E-5
*GAP LAW, TYPE=POWER
0.8, 0.24, 1.
*CONTACT PAIR, INTERACTION=FACES, NAME=FACE, PAIRING=NODES
CURVED, FLAT
*FIXED POINT, METHOD={method}
*BOUNDARY
TOP, 2, 2, 0.
BOTTOM, 2, 2, 0.
AXIS, 1, 1, 0.{ends}
*STEP, INC=100
*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT
20., 900.
*BOUNDARY
TOP, 11, 11, 900.
BOTTOM, 11, 11, 0.
*NODE FILE
U, NT
*EL FILE
S, HFL
*CONTACT FILE
CDIS, CSTR
*CONTACT PRINT
CDIS, CSTR
*END STEP
"""

CHECKS = """\
*VERIFY, KIND=ANALYTIC, SOURCE="prescribed values and symmetry"
NT, TOP, LAST, 900., 1.E-12
NT, TOP, 460., 460., 1.E-12
NT, BOTTOM, LAST, 0., 1.E-9, ABS
NT, MAX, LAST, 900., 1.E-12
U1, AXIS, LAST, 0., 1.E-15, ABS
U2, TOP, LAST, 0., 1.E-15, ABS
U2, BOTTOM, LAST, 0., 1.E-15, ABS
*VERIFY, KIND=ANALYTIC, SOURCE="closed at x = 0 and open at the side"
gap, FACE@0., LAST, 0., 1.E-12, ABS
shear, FACE@0., LAST, 0., 1.E-9, ABS
pressure, MIN, LAST, 0., 1.E-12, ABS
status, MIN, LAST, 0., 0.5, ABS
*VERIFY, KIND=ANALYTIC, SOURCE="balance of heat and forces"
heat_imbalance, , LAST, 0., 1.E-9, ABS
force_imbalance, , LAST, 0., 1.E-9, ABS
** From tests/reference/cylinder_reference.py with four uniform refinements.
*VERIFY, KIND=EXTERNAL, SOURCE="independent solver and 160 contact elements"
{reference}
*VERIFY, KIND=EXTERNAL, SOURCE="CalculiX 2.20 with 40 contact elements"
normal_force, FACE, 540., 1361.3, 1.E-2
heat_rate, FACE, 540., 17.27, 2.5E-2
pressure, MAX, 540., 316.6, 2.E-2
** On this mesh and with these increments only: leave the rest out where either
** is changed. Friction and its path are in no check above. Both programs find
** omega to 1e-8 or better; a hundred times that is allowed.
*VERIFY, KIND=EXTERNAL, SOURCE="independent solver on this mesh"
{same_mesh}
"""

# Load, normal force, heat rate, largest pressure, edge of contact: converged values.
REFERENCE = [(180, 384.33, 5.044, 167.27, 2.95), (540, 1363.74, 17.265, 316.19, 5.54),
             (900, 2486.96, 30.80, 428.78, 7.46)]

# About a sixth of the nodal spacing at these edges, 0.5 to 0.8: as near as sharpened edges are to the converged ones.
EDGE_TOLERANCE = 0.1

# Load, shear force, edges of contact and of stick: tests/reference/cylinder_reference.py on the published mesh with
# increments of 20 C. A fault of friction moves these, and hardly the pressure.
SAME_MESH = [(180, -34.1300602, 2.97593244, 2.29154645), (540, -118.191833, 5.52063091, 4.85594289),
             (900, -211.494395, 7.45576268, 6.70500935)]

COUPLED_CHECKS = """\
*VERIFY, KIND=ANALYTIC, SOURCE="prescribed values and symmetry"
NT, TOP, 200., 200., 1.E-12
NT, BOTTOM, 200., 0., 1.E-9, ABS
U1, AXIS, 200., 0., 1.E-15, ABS
U2, TOP, 200., 0., 1.E-15, ABS
*VERIFY, KIND=ANALYTIC, SOURCE="the bodies are apart"
normal_force, FACE, 200., 0., 1.E-12, ABS
pressure, MAX, 200., 0., 1.E-12, ABS
status, MAX, 200., 0., 0.5, ABS
** Hot to the face but for the heat that the gap lets through, under 0.1 %:
** height (1 + nu) alpha T downwards, width (1 + nu) alpha T to the side.
*VERIFY, KIND=ANALYTIC, SOURCE="free expansion in plane strain"
gap, FACE@0., 20., 0.47984, 1.E-4
gap, FACE@0., 200., 0.2984, 1.E-3
U1, 21, 20., 0.01008, 1.E-2
*VERIFY, KIND=ANALYTIC, SOURCE="balance of heat"
heat_imbalance, , 200., 0., 1.E-6, ABS
** From tests/reference/cylinder_reference.py with two uniform refinements.
*VERIFY, KIND=EXTERNAL, SOURCE="independent solver and 40 contact elements"
heat_rate, FACE, 200., 0.016398, 5.E-3
heat_rate, FACE, 480., 0.18426, 5.E-3
gap, FACE@0., 480., 0.017404, 1.E-3
"""

YIELDS = """\
** Changed against the paper: both bodies yield, at 250 when cold and at 200
** when at 900. Elements have 2 x 2 points, and are divided once."""
PLASTIC = "*CONDUCTIVITY\n0.18\n*PLASTIC\n250., 0., 0.\n200., 0., 900.\n"
DIVIDED = "*REFINE, LEVELS=1\n*MATERIAL, NAME=UPPER"

# Of CalculiX the normal forces and the area of its contact statistics and the largest CPRESS, on
# the deck of `--calculix FILE --yielding`. Its penalty has half a percent of the force.
YIELDING_CHECKS = """\
*VERIFY, KIND=EXTERNAL, SOURCE="elastic cylinder: nothing yields up to 540"
{elastic}
*VERIFY, KIND=EXTERNAL, SOURCE="CalculiX 2.20 on the mesh that is not divided"
normal_force, FACE, 800., 2142.6, 1.E-2
pressure, MAX, 800., 387.0, 2.E-2
normal_force, FACE, 900., 2415.3, 1.E-2
pressure, MAX, 900., 392.8, 2.E-2
edge_contact, FACE, 900., 7.61, 0.1, ABS
** Across the plane expansion is held: the whole top yields.
*VERIFY, KIND=ANALYTIC, SOURCE="yield stress of the table"
MISES, 159, LAST, 200., 1.E-2
"""

# The cylinder heated in finite time: the end of each deck's name and the Fourier number of the heating.
TRANSIENTS = {"fast": 0.01, "medium": 1.0, "slow": 100.0}
CONDUCTIVITY, DENSITY, SPECIFIC_HEAT = 0.18, 7.5e-3, 480.0    # W/(cm K), kg/cm^3, J/(kg K)
STORED = "*CONDUCTIVITY\n0.18\n*DENSITY\n7.5E-3\n*SPECIFIC HEAT\n480.\n"
QUASI_STEADY = "*STEP, INC=100\n*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT\n20., 900.\n"

STORES = """\
** Changed against the paper: both bodies store heat, 3.6 J/(cm^3 K), and the
** temperature of the top grows to 900 in {period:g} s. The Fourier number of this
** time, k t/(rho c 60^2), is {fourier:g}. The elements below the top are refined,
** to resolve the heat that enters there."""

BALANCE = """\
*VERIFY, KIND=ANALYTIC, SOURCE="balance of heat and forces"
heat_imbalance, , LAST, 0., 1.E-9, ABS
force_imbalance, , LAST, 0., 1.E-9, ABS
"""

# Until the heat reaches the contact, as it goes into a half-space, of which 30 cm^2 are heated.
RAMPED = """\
*VERIFY, KIND=ANALYTIC, SOURCE="half-space whose face warms at an even rate"
heat_in, , {time}, {heat:.6f}, {tolerance}
"""

COLD_CONTACT = """\
** The heat is some 12 deep, 2 sqrt(k t/(rho c)), the cylinder 60 high.
*VERIFY, KIND=ANALYTIC, SOURCE="no heat reaches the contact"
heat_rate, FACE, LAST, 0., 1.E-3, ABS
"""

# Heated evenly for t, a slab of 120 has a mean temperature that is 120^2/(12 k t/(rho c)) of itself below the steady
# one: 0.6 % at 540, 0.3 % at 900.
LAGGING = """\
** The mean temperature lags behind by 0.6 and 0.3 % of itself; the mesh has the
** rest.
*VERIFY, KIND=EXTERNAL, SOURCE="converged quasi-steady values of the cylinder"
{reference}
"""

CALCULIX_HEAD = """\
*HEADING
Cylinder on a base, for CalculiX and thercon
** Written by make_decks.py --calculix. As cylinder.inp but for the conductance:
** 0.8 + 0.24 p closed and nothing across a gap, which CalculiX does not do.
** For CalculiX, and reported by thercon as not needed: the penalty, the stick
** slope, *CONTROLS (with its defaults CalculiX gives up at 700), and the tiny
** first step (else CalculiX ramps an initial penetration out over 20 degrees).
"""

CALCULIX_CONTACT = """\
*SURFACE INTERACTION, NAME=FACES
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
1.E5
*FRICTION
0.155, 1.E5
*GAP CONDUCTANCE
0.8, 0.
480.8, 2000.
*CONTACT PAIR, INTERACTION=FACES, TYPE=SURFACE TO SURFACE
CURVED, FLAT
"""

CALCULIX_STEP = """\
*STEP, INC=100
*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT
{increment}, {period}
*CONTROLS, PARAMETERS=TIME INCREMENTATION
40, 60, 9, 100, 10, 4, , 20, ,
*BOUNDARY
TOP, 11, 11, {top}
BOTTOM, 11, 11, 0.
*NODE FILE
U, NT
*EL FILE
S, HFL
*CONTACT FILE
CDIS, CSTR
*NODE PRINT, NSET=TOP, TOTALS=ONLY
RF, RFL
*CONTACT PRINT, SLAVE=CURVED, MASTER=FLAT
CF
*END STEP
"""

# Increment, period and temperature of the top at the end of each step.
CALCULIX_STEPS = [("0.018", "0.018", "0.018"), ("19.982", "19.982", "20."), ("20.", "880.", "900.")]

TOUCH = "** - the bodies touch at x = 0 at the start, without clearance or load;"
APART = """\
** Changed against the paper, to couple strongly: the base does not expand, and
** the cylinder stands 0.5 above it."""


def reading_cards(reading=PUBLISHED, lift=0.0, base_expansion="1.2E-5", method="NEWTON"):
    """Cards of options, mesh and model of a reading."""
    bodies = make_mesh(lift, reading)
    check_mesh(bodies, lift, reading)
    plane = ", PLANE=STRESS" if reading.plane_stress else ""
    ends = "\nTOP, 1, 1, 0.\nBOTTOM, 1, 1, 0." if reading.ends_held else ""
    model = MODEL.format(base_expansion=base_expansion, method=method, poisson=reading.poisson, ends=ends)
    return [f'*OPTIONS, UNITS="cm MPa W C", LOAD=TOP,11{plane}', *mesh_cards(bodies), *model.splitlines()]


def write_deck(path, heading, first_touch, base_expansion, lift, method, checks):
    """Write one deck; no card image may be wider than 80 columns."""
    cards = OPENING.format(heading=heading, first_touch=first_touch).splitlines()
    cards += reading_cards(PUBLISHED, lift, base_expansion, method) + checks.splitlines()
    assert max(map(len, cards)) <= 80
    path.write_text("\n".join(cards) + "\n")


def write_transient_deck(path, fourier, checks):
    """Write the cylinder whose top is heated in finite time."""
    period = heating_time(fourier)
    heading = f"Cylinder on a base, heated in {period:g} s"
    opening = OPENING.format(heading=heading, first_touch="\n".join([TOUCH, STORES.format(
        period=period, fourier=fourier)]))
    text = opening + "\n".join(reading_cards()) + "\n" + checks
    transient = ("*STEP, INC=100, AMPLITUDE=RAMP\n*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT\n"
                 f"{period / 45:g}, {period:g}\n")
    heated = "\n".join(["*SURFACE, NAME=HEATED", *top_faces(), "*REFINE, LEVELS=2, SURFACE=HEATED, DISTANCE=10."])
    changes = ((QUASI_STEADY, transient, 1), ("*CONDUCTIVITY\n0.18\n", STORED, 2),
               ("*MATERIAL, NAME=UPPER", f"{heated}\n*MATERIAL, NAME=UPPER", 1))
    text = changed(text, changes)
    assert max(map(len, text.splitlines())) <= 80
    path.write_text(text)


def write_yielding_deck(path):
    """Write the cylinder whose bodies yield."""
    opening = OPENING.format(heading="Cylinder on a base, both of which yield",
                             first_touch=f"{TOUCH}\n{YIELDS}")
    checks = YIELDING_CHECKS.format(elastic="\n".join(reference_cards().splitlines()[4:8]))
    text = opening + "\n".join(reading_cards()) + "\n" + checks + BALANCE
    text = changed(yielding(text), [("*MATERIAL, NAME=UPPER", DIVIDED, 1)])
    assert max(map(len, text.splitlines())) <= 80
    path.write_text(text)


def yielding(text):
    """Cards of bodies that yield in place of elastic ones."""
    return changed(text, [("TYPE=CPE8", "TYPE=CPE8R", 2), ("*CONDUCTIVITY\n0.18\n", PLASTIC, 2)])


def changed(text, changes):
    """Cards with changes: what is replaced, by what, and how often it is there."""
    for old, new, count in changes:
        assert text.count(old) == count
        text = text.replace(old, new)
    return text


def heating_time(fourier):
    """Seconds in which the top is heated."""
    return fourier * HEIGHT**2 * DENSITY * SPECIFIC_HEAT / CONDUCTIVITY


def ramped_heat(fourier, top):
    """Heat rate into the top when it has a temperature and the heat has not reached the contact."""
    rate = 900.0 / heating_time(fourier)
    diffusivity = CONDUCTIVITY / (DENSITY * SPECIFIC_HEAT)
    return WIDTH * 2 * CONDUCTIVITY * rate * (top / rate / (np.pi * diffusivity))**0.5


def top_faces():
    """Data cards of the faces of the top."""
    nodes, elements = make_body(True)
    return [f"{number}, S{k + 1}" for number, e in enumerate(elements, start=1) for k in range(4)
            if nodes[e[k]][1] == nodes[e[(k + 1) % 4]][1] == HEIGHT]


def transient_checks(name, fourier):
    """*VERIFY cards of a deck of the cylinder that is heated in finite time."""
    end = heating_time(fourier)
    if name == "fast":
        return BALANCE + RAMPED.format(time="LAST", heat=ramped_heat(fourier, 900.0), tolerance="1.E-3") + COLD_CONTACT
    if name == "medium":
        return BALANCE + RAMPED.format(time=f"{end / 5:g}", heat=ramped_heat(fourier, 180.0), tolerance="5.E-3")
    cards = []
    for top, force, heat, pressure, edge in REFERENCE[1:]:
        when = f"{end * top / 900:g}"
        cards += [f"normal_force, FACE, {when}, {force}, 1.E-2", f"heat_rate, FACE, {when}, {heat}, 2.5E-2",
                  f"pressure, MAX, {when}, {pressure}, 2.E-2",
                  f"edge_contact, FACE, {when}, {edge}, {EDGE_TOLERANCE}, ABS"]
    return BALANCE + LAGGING.format(reference="\n".join(cards))


def write_calculix_deck(path, yields):
    """Write the deck for both programs: bodies, supports and steps that either of them takes."""
    bodies, rest = "\n".join(reading_cards()).split("*SURFACE INTERACTION")
    supports = rest[rest.index("*BOUNDARY"):rest.index("*STEP")]
    cards = (CALCULIX_HEAD + bodies + CALCULIX_CONTACT + supports).splitlines()
    for increment, period, top in CALCULIX_STEPS:
        cards += CALCULIX_STEP.format(increment=increment, period=period, top=top).splitlines()
    assert max(map(len, cards)) <= 80
    text = "\n".join(cards) + "\n"
    path.write_text(yielding(text) if yields else text)


def reference_cards():
    """*VERIFY data from the converged values, with what the published mesh is due to hold."""
    cards = []
    for load, force, heat, pressure, edge in REFERENCE:
        cards += [f"normal_force, FACE, {load}., {force}, 5.E-3", f"heat_rate, FACE, {load}., {heat}, 2.5E-2",
                  f"pressure, MAX, {load}., {pressure}, 2.E-2",
                  f"edge_contact, FACE, {load}., {edge}, {EDGE_TOLERANCE}, ABS"]
    return "\n".join(cards)


def same_mesh_cards():
    """*VERIFY data from the independent solver on the published mesh."""
    return "\n".join(f"{name}, FACE, {load}., {value}, 1.E-6" for load, *values in SAME_MESH
                     for name, value in zip(("shear_force", "edge_contact", "edge_stick"), values))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--calculix", type=Path, metavar="FILE", help="write only the deck for both programs")
    parser.add_argument("--yielding", action="store_true", help="bodies of that deck yield")
    chosen = parser.parse_args()
    if chosen.calculix:
        write_calculix_deck(chosen.calculix, chosen.yielding)
        return
    folder = Path(__file__).parent
    write_deck(folder / "cylinder.inp", "Cylinder on a base, heated from the top", TOUCH, "1.2E-5", 0.0,
               "ZAITSEV", CHECKS.format(reference=reference_cards(), same_mesh=same_mesh_cards()))
    write_deck(folder / "cylinder-coupled.inp", "Cylinder above a base that does not expand, strongly coupled",
               APART, "0.", LIFT, "NEWTON", COUPLED_CHECKS)
    write_yielding_deck(folder / "cylinder-yielding.inp")
    for name, fourier in TRANSIENTS.items():
        write_transient_deck(folder / f"cylinder-{name}.inp", fourier, transient_checks(name, fourier))


if __name__ == "__main__":
    main()
