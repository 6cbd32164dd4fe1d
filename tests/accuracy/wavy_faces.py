"""Families of faces of a periodic profile, whose edges of contact are known: by closed forms, or by a
spectral solution that shares nothing with the program.

An elastic half-space (y > 0, modelled DEPTH deep) of the period 1 is pressed on a profile. Without heat
on a cosine: H. M. Westergaard, J. Appl. Mech. 6 (1939) A49-A53. With heat H a wave through a perfect
contact: C. Panek, J. Dundurs, J. Appl. Mech. 46 (1979) 854-860. With other profiles, conductances and
with two elastic bodies, pressure p and heat flux q are cosine series on equal cells: p_n displaces the
face by 2 p_n/(Es 2 pi n), q_n by alpha (1 + nu) q_n/(k (2 pi n)^2), and heats it by q_n/(2 pi n k). The
edges of the latter take long: `python tests/accuracy/wavy_faces.py` writes them to wavy_edges.csv.
"""

import csv
import functools
from dataclasses import dataclass
from pathlib import Path

import numpy as np

DEPTH, BASE, HEIGHT = 3.0, 0.1, 1e-3   # depths of the bodies, height of the profile
YOUNG, POISSON, EXPANSION, CONDUCTIVITY = 1e3, 0.3, 2e-3, 1.0
MODULUS = YOUNG / (1 - POISSON**2)
BULGE = EXPANSION * (1 + POISSON) / CONDUCTIVITY   # curvature in the heat flux
PERFECT = 1e5
# With two elastic bodies strains and heights are this much smaller, and moduli as much larger: the
# expansion of the lower one makes its waves higher, which is of second order.
SLIGHT = 0.01
CELLS, ROUNDS = 400, 400
CHOSEN = ("cold", "heat in", "heat out", "continuous, heat in", "continuous, heat out")
NEW = ("punches with round edges", "wedges", "two elastic bodies")
PAIRINGS = ("NODES", "SURFACES")
COUNTS = (1, 5, 10)       # increments
WIDTHS = range(12, 21)    # elements on half a wave
SEEDS = range(16)
FILE = Path(__file__).resolve().parent / "wavy_edges.csv"


@dataclass(frozen=True)
class WavyFace:
    """A deck and its exact edge of contact."""

    name: str
    text: str
    edge: float
    spacing: float


def cosine(x):
    """Return the depth of a cosine below its crest, of the height 2."""
    return 1 - np.cos(2 * np.pi * x)


def wedge(x):
    """Return the depth of a wedge below its tip."""
    return 4 * np.abs(x)


def punch(x):
    """Return the depth below a punch that is flat up to an eighth of the wave and then round."""
    return 14 * np.maximum(0.0, np.abs(x) - 0.125) ** 2


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
        return {(row["family"], int(row["seed"])): float(row["edge"]) for row in csv.DictReader(file)}


def drawn(family, seed, is_told=True):
    """Return the face of a family with a width, a heat, a mesh and increments that are drawn; edges that
    need the spectral solution are those of the file, or solved anew."""
    draw = np.random.default_rng([seed, (CHOSEN + NEW).index(family)])
    a, part = draw.uniform(0.12, 0.4), draw.uniform(0.15, 1.0)
    sides, count = int(draw.choice(WIDTHS)), int(draw.choice(COUNTS))
    pairing = PAIRINGS[seed % 2]
    heat = {"cold": 0.0, "heat in": 4.0}.get(family, -1.6 if "out" in family else 3.0) * part
    profile = {"wedges": wedge, "punches with round edges": punch}.get(family, cosine)
    other, law = (0.0, 0.0, 0.0), f"*GAP LAW, TYPE=POWER\n{PERFECT:g}, 0., 1.\n"
    pressure, drop = closed_form(a, heat)
    if family in CHOSEN[3:] + NEW:
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
            a = told_edges()[family, seed]
        else:
            a = spectral(profile, pressure, drop,
                         lambda gap, p: closed_in * length / (length + gap) + growth * p, other)
    text = deck(sides, profile, law, pressure, drop, count, pairing, other)
    return WavyFace(f"{family} {seed}", text, a, 0.25 / sides)


def deck(sides, profile, law, pressure, drop, count, pairing, other):
    """Return the deck of half a wave; the lower face is the profile."""
    rows = [0.0, 1.5]
    while rows[-1] < DEPTH * 2 * sides - 2 * (rows[-1] - rows[-2]):
        rows.append(rows[-1] + 1.35 * (rows[-1] - rows[-2]))
    rows = np.array([*rows, DEPTH * 2 * sides]) / (2 * sides)
    is_rigid = other[0] == 0.0
    slight = 1.0 if is_rigid else SLIGHT
    below = np.array([-BASE, -BASE / 2, 0.0]) if is_rigid else -rows[::-1]
    total = -below[0]
    cards = body("EL", 0, sides, rows, lambda x, y: y)
    cards += body("RG", 100000, sides, below, lambda x, y: y - slight * HEIGHT * profile(x) * (total + y) / total)
    upper = YOUNG / slight
    young = upper if is_rigid else upper / other[0]
    conductivity = CONDUCTIVITY if is_rigid else CONDUCTIVITY / other[1]
    expansion = 0.0 if is_rigid else slight * EXPANSION * other[2] / other[1]
    for name, values in (("EL", (upper, slight * EXPANSION, CONDUCTIVITY)), ("RG", (young, expansion, conductivity))):
        cards += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{values[0]:.9g}, {POISSON}", "*EXPANSION",
                  f"{values[1]:.9g}", "*CONDUCTIVITY", f"{values[2]:.9g}",
                  f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"]
    cards += ["*SURFACE, NAME=UP", "EL_BOTTOM, S1", "*SURFACE, NAME=DOWN", "RG_TOP, S3",
              "*SURFACE INTERACTION, NAME=I", law.strip(),
              f"*CONTACT PAIR, INTERACTION=I, NAME=J, PAIRING={pairing}", "UP, DOWN",
              "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "EL_NODES, 0.", "RG_NODES, 0.", "*STEP, INC=400",
              "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", f"{1 / count!r}, 1.", "*BOUNDARY"]
    # A rigid body has one temperature.
    held = "RG_NODES" if is_rigid else "RG_FOOT"
    cards += ["RG_NODES, 1, 2"] if is_rigid else ["RG_FOOT, 2", "RG_SIDES, 1"]
    cards += ["EL_SIDES, 1", f"{held}, 11, 11, {drop:.12g}", "EL_HEAD, 11, 11, 0.", "*DLOAD",
              f"EL_TOP, P3, {pressure:.12g}", "*END STEP"]
    return "\n".join(cards) + "\n"


def body(name, first, sides, rows, height):
    """Return the cards of a body of eight-node elements between rows."""
    numbers, nodes, count = {}, [f"*NODE, NSET={name}_NODES"], first
    for j in range(2 * len(rows) - 1):
        level = rows[j // 2] if j % 2 == 0 else (rows[j // 2] + rows[j // 2 + 1]) / 2
        for i in range(0, 2 * sides + 1, 1 + j % 2):
            count += 1
            numbers[i, j] = count
            x = i / (4 * sides)
            nodes.append(f"{count}, {x:.12g}, {height(x, level):.15g}")
    around = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    elements = [f"*ELEMENT, TYPE=CPE8, ELSET={name}"]
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
    return nodes + elements + [card for head, members in sets.items()
                               for card in (head, *(f"{member}," for member in members))]


def write_file():
    """Write the edges that need the spectral solution."""
    with FILE.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["family", "seed", "edge"])
        for family in CHOSEN[3:] + NEW:
            writer.writerows([family, seed, f"{drawn(family, seed, False).edge:.8g}"] for seed in SEEDS)


if __name__ == "__main__":
    write_file()
