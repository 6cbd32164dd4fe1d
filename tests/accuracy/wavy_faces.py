"""Families of faces whose edges of contact and of stick are known: by closed forms, or by solutions that
share nothing with the program.

An elastic half-space (y > 0, modelled DEPTH deep) of the period 1 is pressed on a profile. Without heat
on a cosine: H. M. Westergaard, J. Appl. Mech. 6 (1939) A49-A53. With heat H a wave through a perfect
contact: C. Panek, J. Dundurs, J. Appl. Mech. 46 (1979) 854-860. With other profiles, conductances and
with two elastic bodies, pressure p and heat flux q are cosine series on equal cells: p_n displaces the
face by 2 p_n/(Es 2 pi n), q_n by alpha (1 + nu) q_n/(k (2 pi n)^2), and heats it by q_n/(2 pi n k). The
same of parabolas on the strip of a period, and with J0 in a tube: Hertz's contacts and the hot indenters of
J. R. Barber, Int. J. Heat Mass Transfer 16 (1973) 813-819, a layer that recedes (L. M. Keer, J. Dundurs, K. C.
Tsai, J. Appl. Mech. 39 (1972) 1115-1120), and edges of stick (C. Cattaneo, R. D. Mindlin, D. A. Spence) are
those of edge_solutions. `python tests/accuracy/wavy_faces.py` writes edges that take long to wavy_edges.csv.
"""

import csv
import functools
import sys
from dataclasses import dataclass
from pathlib import Path

import edge_solutions
import numpy as np

DEPTH, BASE, HEIGHT = 3.0, 0.1, 1e-3   # depths of the bodies, height of the profile
YOUNG, POISSON, EXPANSION, CONDUCTIVITY = 1e3, 0.3, 2e-3, 1.0
MODULUS = YOUNG / (1 - POISSON**2)
BULGE = EXPANSION * (1 + POISSON) / CONDUCTIVITY   # curvature in the heat flux
PERFECT = 1e5
# With two elastic bodies strains and heights are this much smaller, and moduli as much larger: the
# expansion of the lower one makes its waves higher, which is of second order.
SLIGHT = 0.01
CELLS, ROUNDS, ROUGH_CELLS = 400, 400, 150
CHOSEN = ("cold", "heat in", "heat out", "continuous, heat in", "continuous, heat out")
NEW = ("punches with round edges", "wedges", "two elastic bodies")
SPECTRAL = CHOSEN[3:] + NEW
PARABOLAS = ("cylinder, cold", "cylinder, hot", "sphere, cold", "sphere, hot")
LAYER, SHEARED, ROUGH = "receding layer", "Cattaneo and Mindlin", "Spence"
KNOWN = (*PARABOLAS, LAYER, SHEARED, ROUGH)
PAIRINGS = ("NODES", "SURFACES")
COUNTS = (1, 5, 10)       # increments
WIDTHS = range(12, 21)    # elements on half a wave
MORE_WIDTHS, MORE_COUNTS = range(8, 25), (1, 4, 10, 20)
SEEDS = range(16)
TOLD = ("edge", "stick", "pressure")
FILE = Path(__file__).resolve().parent / "wavy_edges.csv"


@dataclass(frozen=True)
class WavyFace:
    """A deck, its exact edge of contact, the spacing of its nodes, and the edge of stick where it is judged."""

    name: str
    text: str
    edge: float
    spacing: float
    stick: float = np.nan
    pressure: float = np.nan


def cosine(x):
    """Return the depth of a cosine below its crest, of the height 2."""
    return 1 - np.cos(2 * np.pi * x)


def wedge(x):
    """Return the depth of a wedge below its tip."""
    return 4 * np.abs(x)


def punch(x):
    """Return the depth below a punch that is flat up to an eighth of the wave and then round."""
    return 14 * np.maximum(0.0, np.abs(x) - 0.125) ** 2


def parabola(x):
    """Return the depth of the parabola with the curvature of the cosine at its crest."""
    return 2 * (np.pi * x) ** 2


def closed_form(a, heat):
    """Return mean pressure and drop of temperature at which contact ends at a, through a perfect contact."""
    b = np.sin(np.pi * a)
    # y = b sin(t) leaves a smooth integrand.
    t, weight = np.polynomial.legendre.leggauss(200)
    y = b * np.sin(t * np.pi / 2)
    value = np.sum(weight * y * (t * np.pi / 2 - np.arcsin(y)) / np.sqrt(1 - y**2)) * np.pi / 2
    pressure = np.pi * MODULUS * HEIGHT * b**2 + MODULUS * BULGE * heat * value / (2 * np.pi**2)
    return pressure, heat * (DEPTH + np.log(1 / b) / np.pi)


def spectral(profile, pressure, drop, law, other):
    """Return the edge of contact under a mean pressure and a drop of temperature, with the conductance
    law(gap, pressure); the other body is rigid and of one temperature, or has a part `other` of the
    compliance, resistance and bulge of the first."""
    x = (np.arange(CELLS) + 0.5) / (2 * CELLS)
    n = np.arange(1, CELLS)
    waves = np.cos(2 * np.pi * np.outer(x, n))
    # Cosines are orthogonal on cells.
    parts = 2 * waves.T / CELLS
    compliance, resistance, bulge = 1 + other[0], 1 + other[1], 1 - other[2]
    yields = waves @ (parts * (compliance / (MODULUS * np.pi * n))[:, None])
    warms = waves @ (parts * (resistance / (CONDUCTIVITY * 2 * np.pi * n))[:, None])
    warms += resistance * DEPTH / CONDUCTIVITY / CELLS
    rises = waves @ (parts * (bulge * BULGE / (2 * np.pi * n) ** 2)[:, None])
    flux, found = np.zeros(CELLS), None
    for _ in range(ROUNDS):
        shape = HEIGHT * profile(x) - rises @ flux
        p, gap = pressed(yields, shape, pressure)
        conductance = law(gap, p)
        new = np.linalg.solve(np.eye(CELLS) + conductance[:, None] * warms, conductance * drop)
        if drop == 0 or np.abs(new - flux).max() < 1e-9 * np.abs(new).max():
            found = edge_of(x, p, gap)
            break
        flux += 0.6 * (new - flux)
    assert found is not None, "no convergence"
    return found


def pressed(yields, shape, mean):
    """Return pressure and gap, by the set of closed cells."""
    cells = len(shape)
    inside = shape < np.median(shape)
    for _ in range(200):
        k = np.flatnonzero(inside)
        # shape + yields p = approach, mean p is given
        system = np.zeros((len(k) + 1,) * 2)
        system[:-1, :-1], system[:-1, -1], system[-1, :-1] = yields[np.ix_(k, k)], -1, 1 / cells
        found = np.linalg.solve(system, np.append(-shape[k], mean))
        p = np.zeros(cells)
        p[k] = found[:-1]
        gap = shape + yields @ p - found[-1]
        new = np.where(inside, p > 0, gap < 0)
        if (new == inside).all():
            return p, np.where(inside, 0.0, gap)
        inside = new
    raise ArithmeticError("no set of closed cells")


def edge_of(x, pressure, gap):
    """Return where p^2 and gap^(2/3) vanish, which are smooth there: the mean of both."""
    last = np.flatnonzero(pressure > 0)[-1]
    inside, outside = slice(last - 5, last - 1), slice(last + 3, last + 7)
    ends = [np.roots(np.polyfit(x[part] - x[last], values / values.max(), 2)) for part, values in
            ((inside, pressure[inside] ** 2), (outside, gap[outside] ** (2 / 3)))]
    ends = [found.real[np.argmin(np.abs(found.real))] for found in ends]
    return x[last] + float(np.mean(ends))


@functools.cache
def told_edges():
    """Return the edges of the file, by family and seed."""
    with FILE.open(newline="") as file:
        return {(row["family"], int(row["seed"])): tuple(float(row[key] or "nan") for key in TOLD)
                for row in csv.DictReader(file)}


def drawn(family, seed, is_told=True):
    """Return the face of a family with a width, a heat, a mesh and increments that are drawn; edges that
    need the spectral solution are those of the file, or solved anew."""
    if family in KNOWN:
        return known(family, seed, is_told)
    draw = np.random.default_rng([seed, (CHOSEN + NEW).index(family)])
    a, part = draw.uniform(0.12, 0.4), draw.uniform(0.15, 1.0)
    sides, count = int(draw.choice(WIDTHS)), int(draw.choice(COUNTS))
    pairing = PAIRINGS[seed % 2]
    heat = {"cold": 0.0, "heat in": 4.0}.get(family, -1.6 if "out" in family else 3.0) * part
    profile = {"wedges": wedge, "punches with round edges": punch}.get(family, cosine)
    other, law = (0.0, 0.0, 0.0), f"*GAP LAW, TYPE=POWER\n{PERFECT:g}, 0., 1.\n"
    pressure, drop = closed_form(a, heat)
    if family in SPECTRAL:
        if family == "two elastic bodies":
            other = tuple(draw.uniform(0.3, 2.0, 3))
        if family != CHOSEN[3]:
            heat *= 0.7
        closed_in, length = draw.uniform(3.0, 30.0), draw.uniform(0.05, 0.5) * HEIGHT
        growth = draw.uniform(1, 20)
        slight = SLIGHT if other[0] else 1.0
        law = (f"*GAP LAW, TYPE=GAS\n{closed_in * length * slight:.9g}, {length * slight:.9g}\n"
               f"*GAP LAW, TYPE=POWER\n{closed_in:.9g}, {growth:.9g}, 1.\n")
        pressure = np.pi * MODULUS * HEIGHT * np.sin(np.pi * a) ** 2 / (1 + other[0])
        drop *= 1 + other[1]
        if is_told:
            a = told_edges()[family, seed][0]
        else:
            a = spectral(profile, pressure, drop,
                         lambda gap, p: closed_in * length / (length + gap) + growth * p, other)
    text = deck(sides, profile, law, pressure, drop, count, pairing, other)
    return WavyFace(f"{family} {seed}", text, a, 0.25 / sides)


def known(family, seed, is_told):
    """Return the face of a family with a solution of edge_solutions that is drawn."""
    draw = np.random.default_rng([seed, (CHOSEN + NEW + KNOWN).index(family)])
    a, part, sides = draw.uniform(0.12, 0.4), draw.uniform(0.15, 1.0), int(draw.choice(MORE_WIDTHS))
    count, sign = int(draw.choice(MORE_COUNTS)), float(draw.choice((4.0, -1.6)))
    law, drop, c = f"*GAP LAW, TYPE=POWER\n{PERFECT:g}, 0., 1.\n", 0.0, np.nan
    other, profile, more = (0.0, 0.0, 0.0), parabola, {"slight": SLIGHT}
    if family in PARABOLAS:
        heat, about_axis = sign * part * ("hot" in family), "sphere" in family
        pressure, drop = edge_solutions.perfect(a, lambda x: HEIGHT * parabola(x), heat, MODULUS, CONDUCTIVITY,
                                                BULGE, about_axis)
        drop += heat * DEPTH / CONDUCTIVITY
        more["kind"] = "CAX8" if about_axis else "CPE8"
    elif family == LAYER:
        thickness, ratio = draw.uniform(0.06, 0.13), draw.uniform(0.2, 1)
        loaded = max(1, round(2 * sides * thickness * part))
        profile, pressure, other = np.zeros_like, 1.0, (ratio, 1.0, 1.0)
        more |= {"thickness": thickness, "loaded": loaded}
        if is_told:
            a = told_edges()[family, seed][0]
        else:
            a = edge_solutions.layer_edge(thickness, loaded / (2 * sides), ratio)
    elif family == SHEARED:
        # Shear is that of the difference of two contacts: M. Ciavarella, Int. J. Solids Struct. 35 (1998).
        profile, other, c, friction = cosine, (1.0, 1.0, 1.0), a * draw.uniform(0.3, 0.9), draw.uniform(0.1, 0.6)
        pressure, less = (closed_form(x, 0.0)[0] / 2 for x in (a, c))
        count = max(count, MORE_COUNTS[1])
        more |= {"friction": friction, "shear": friction * (pressure - less)}
    else:
        friction = draw.uniform(0.08, 0.2)
        count = int(draw.choice((10, 20, 40)))
        more |= {"friction": friction}
        if is_told:
            a, c, pressure = told_edges()[family, seed]
        else:
            pressure, pressures, gap, parts = edge_solutions.gripped(
                lambda x: HEIGHT * parabola(x), MODULUS, POISSON, friction, a, ROUGH_CELLS)
            a = edge_of((np.arange(ROUGH_CELLS) + 0.5) / (2 * ROUGH_CELLS), pressures, gap)
            c = a * np.polyval(np.polyfit(range(-8, 1), parts[-9:], 1), 0)
    text = deck(sides, profile, law, pressure, drop, count, PAIRINGS[seed % 2], other, **more)
    return WavyFace(f"{family} {seed}", text, a, 0.25 / sides, c, pressure)


def deck(sides, profile, law, pressure, drop, count, pairing, other, kind="CPE8", slight=None, thickness=DEPTH,
         loaded=None, friction=0.0, shear=None):
    """Return the deck of half a wave, or of a wave under shear; the lower face is the profile. Pressure acts
    on the elements of the top, or on as many as are loaded."""
    rows = graded(sides)
    is_rigid = other[0] == 0.0
    slight = slight or (1.0 if is_rigid else SLIGHT)
    start, across = (0.0, sides) if shear is None else (-0.5, 2 * sides)
    below = np.array([-BASE, -BASE / 2, 0.0]) if is_rigid else -rows[::-1]
    above = rows if thickness == DEPTH else np.linspace(0, thickness, int(np.ceil(thickness * 2 * sides)) + 1)
    total = -below[0]
    cards = body("EL", 0, start, across, above, kind, lambda x, y: y)
    cards += body("RG", 100000, start, across, below, kind,
                  lambda x, y: y - slight * HEIGHT * profile(x) * (total + y) / total)
    upper = YOUNG / slight
    young = upper if is_rigid else upper / other[0]
    conductivity = CONDUCTIVITY if is_rigid else CONDUCTIVITY / other[1]
    expansion = 0.0 if is_rigid else slight * EXPANSION * other[2] / other[1]
    for name, values in (("EL", (upper, slight * EXPANSION, CONDUCTIVITY)), ("RG", (young, expansion, conductivity))):
        cards += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{values[0]:.9g}, {POISSON}", "*EXPANSION",
                  f"{values[1]:.9g}", "*CONDUCTIVITY", f"{values[2]:.9g}",
                  f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"]
    cards += ["*SURFACE, NAME=UP", "EL_BOTTOM, S1", "*SURFACE, NAME=DOWN", "RG_TOP, S3",
              "*SURFACE INTERACTION, NAME=I", law.strip()]
    cards += ["*FRICTION", f"{friction:.9g}"] if friction else []
    cards += [f"*CONTACT PAIR, INTERACTION=I, NAME=J, PAIRING={pairing}", "UP, DOWN",
              "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "EL_NODES, 0.", "RG_NODES, 0."]
    if shear is not None:
        cards += [card for side in ("EL", "RG") for dof in (1, 2)
                  for card in ("*EQUATION", "2", f"{side}_LEFT, {dof}, 1., {side}_RIGHT, {dof}, -1.")]
    step = ["*STEP, INC=400", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", f"{1 / count!r}, 1."]
    # A rigid body has one temperature.
    held = "RG_NODES" if is_rigid else "RG_FOOT"
    cards += [*step, "*BOUNDARY"]
    if shear is not None:
        cards += ["RG_FOOT, 1, 2"]
    else:
        cards += ["RG_NODES, 1, 2"] if is_rigid else ["RG_FOOT, 2", "RG_SIDES, 1"]
        cards += ["EL_SIDES, 1"]
    cards += [f"{held}, 11, 11, {drop:.12g}", "EL_HEAD, 11, 11, 0.", "*DLOAD"]
    cards += [f"EL_TOP, P3, {pressure:.12g}"] if loaded is None else [
        f"{(len(above) - 2) * across + i}, P3, {pressure:.12g}" for i in range(1, loaded + 1)]
    cards.append("*END STEP")
    if shear is not None:
        # Even shear is a third and two thirds of a side at its ends and its middle, ends have two sides.
        top = cards[cards.index("*NSET, NSET=EL_HEAD") + 1:][:2 * across + 1]
        parts = [2 / 3 if i % 2 else 1 / 3 for i in range(len(top))]
        parts[0] = parts[-1] = 1 / 6
        cards += [*step, "*CLOAD", *(f"{node} 1, {part * shear / (2 * sides):.12g}"
                                     for node, part in zip(top, parts, strict=True)), "*END STEP"]
    return "\n".join(cards) + "\n"


def graded(sides):
    """Return rows of nodes that are the larger, the farther from the face."""
    rows = [0.0, 1.5]
    while rows[-1] < DEPTH * 2 * sides - 2 * (rows[-1] - rows[-2]):
        rows.append(rows[-1] + 1.35 * (rows[-1] - rows[-2]))
    return np.array([*rows, DEPTH * 2 * sides]) / (2 * sides)


def body(name, first, start, sides, rows, kind, height):
    """Return the cards of a body of eight-node elements between rows, from an abscissa on to 1/2."""
    numbers, nodes, count = {}, [f"*NODE, NSET={name}_NODES"], first
    for j in range(2 * len(rows) - 1):
        level = rows[j // 2] if j % 2 == 0 else (rows[j // 2] + rows[j // 2 + 1]) / 2
        for i in range(0, 2 * sides + 1, 1 + j % 2):
            count += 1
            numbers[i, j] = count
            x = start + (0.5 - start) * i / (2 * sides)
            nodes.append(f"{count}, {x:.12g}, {height(x, level):.15g}")
    around = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    elements = [f"*ELEMENT, TYPE={kind}, ELSET={name}"]
    last = len(rows) - 2
    sets = {f"*ELSET, ELSET={name}_BOTTOM": [], f"*ELSET, ELSET={name}_TOP": []}
    for j in range(last + 1):
        for i in range(sides):
            number = first + j * sides + i + 1
            places = ", ".join(str(numbers[2 * i + u, 2 * j + v]) for u, v in around)
            elements.append(f"{number}, {places}")
            for end, which in ((0, "BOTTOM"), (last, "TOP")):
                if j == end:
                    sets[f"*ELSET, ELSET={name}_{which}"].append(number)
    places = numbers.items()
    sets[f"*NSET, NSET={name}_SIDES"] = [n for (i, _), n in places if i in (0, 2 * sides)]
    sets[f"*NSET, NSET={name}_FOOT"] = [n for (_, j), n in places if j == 0]
    sets[f"*NSET, NSET={name}_HEAD"] = [n for (_, j), n in places if j == 2 * len(rows) - 2]
    # Of a wave the foot of the lower body is held.
    for side, end in (("LEFT", 0), ("RIGHT", 2 * sides)):
        sets[f"*NSET, NSET={name}_{side}"] = [n for (i, j), n in places if i == end and (j or name == "EL")]
    return nodes + elements + [card for head, members in sets.items()
                               for card in (head, *(f"{member}," for member in members))]


def write_file(names):
    """Write the edges that need long: those that are missing, and those of the families named anew."""
    with FILE.open(newline="") as file:
        kept = {(row[0], int(row[1])): row for row in list(csv.reader(file))[1:] if row[0] not in names}
    rows = [["family", "seed", *TOLD]]
    for family in (*SPECTRAL, LAYER, ROUGH):
        for seed in SEEDS:
            if (family, seed) not in kept:
                face = drawn(family, seed, False)
                kept[family, seed] = [family, seed, *(f"{value:.8g}" if np.isfinite(value) else ""
                                                      for value in (face.edge, face.stick, face.pressure))]
            rows.append(kept[family, seed])
    with FILE.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    write_file(sys.argv[1:])
