"""Decks of families with independent solutions, on which no constant was chosen: geometry, materials, loads,
elements, meshes and increments are drawn.

skew waves, friction: two elastic bodies with beta = 0 meet in a wave of two harmonics without symmetry, between
periodic sides; the top moves down, then along (skew_waves).
hot dies: a hard die between a parabola and a quartic is pressed into a layer; without heat, with a conductance
that is continuous in gap and pressure and heat in or out, and with one of closed points only (hot_dies).
"""

from dataclasses import dataclass

import hot_dies
import numpy as np
from physics import material, mesh, nodes_of
from skew_waves import SkewWave

FAMILIES = "skew waves, friction", "hot dies, plane", "hot dies, axisymmetric"
SEEDS = range(32)
HEIGHT, DEPTH = 1e-5, 1.5     # of the wave, of each body
KINDS = "8", "8", "8R", "6", "4"
LAWS = "cold", "heat in", "heat out", "jump"
YOUNG, THICK = 1e3, 0.1       # of the layer; thickness of the die
GROWTH = 1.35                 # of elements away from the contact


@dataclass(frozen=True)
class Problem:
    """A deck, its exact values at the end by their names in /uncertainty, and the spacing of its contact
    points."""

    name: str
    text: str
    exact: dict
    spacing: float


@dataclass(frozen=True)
class Mesh:
    """A drawn mesh: the element, the elements in the contact, how much finer all elements are, and the
    pairing. Straight sides have node pairs, whose gaps are those of the nodes."""

    kind: str
    sides: int
    finer: int
    pairing: str
    part: float   # of the master's number of sides

    def spacing(self, element):
        """Return the spacing of contact points on sides of a length."""
        return element / (1 if self.pairing == "SURFACES" or self.kind == "4" else 2)

    def corners(self, first, last, spacing, end, is_both=False, is_master=False):
        """Return even corners from first to last, growing to the end, and on both sides to 0."""
        count = round((last - first) / spacing)
        even = np.linspace(first, last, max(1, round(count * self.part)) + 1 if is_master else count + 1)
        growth = GROWTH ** (1 / self.finer)

        def beyond(length):
            grown, size = [0.0], even[1] - even[0]
            while grown[-1] < length:
                size *= growth
                grown.append(grown[-1] + size)
            return np.array(grown[1:]) * length / grown[-1]

        before = first - beyond(first)[::-1] if is_both else np.empty(0)
        found = np.concatenate([before, even, last + beyond(end - last)])
        found[0], found[-1] = 0.0 if is_both else first, end
        return found


def drawn(family, seed, finer=1):
    """Return the problem of a family and a seed, on a mesh so much finer."""
    draw = np.random.default_rng([seed, 81 + FAMILIES.index(family)])
    pairing = ("NODES", "SURFACES")[seed % 2]
    kind = str(draw.choice(KINDS[:4] if pairing == "SURFACES" else KINDS))
    grid = Mesh(kind, int(draw.integers(12, 49)) * finer, finer, pairing,
                draw.uniform(0.7, 0.9) if pairing == "SURFACES" else 1.0)
    make = skew_wave if family == FAMILIES[0] else hot_die
    return make(draw, seed, grid, *([] if family == FAMILIES[0] else [family == FAMILIES[2]]))


def skew_wave(draw, seed, grid):
    """Return the problem of a skew wave."""
    poisson = draw.uniform(0.2, 0.4, 2)
    shear = np.array([500.0, 500.0 * (1 - 2 * poisson[1]) / (1 - 2 * poisson[0])])
    young = 2 * shear * (1 + poisson)
    friction, half, ratio = draw.uniform(0.05, 0.5), draw.uniform(0.12, 0.33), draw.uniform(0.2, 0.85)
    wave = SkewWave(HEIGHT, draw.uniform(0.05, 0.2), draw.uniform(-1.5, 1.5), 1 / np.sum((1 - poisson**2) / young))
    contact = wave.contact(half)
    assert contact.is_one, "the contact has more than one part"
    stick = wave.contact_of((1 - ratio) * contact.mean, half)
    down = contact.approach + contact.mean * np.sum(DEPTH * (1 - 2 * poisson) / (2 * shear * (1 - poisson)))
    along = friction * (contact.approach - stick.approach + ratio * contact.mean * np.sum(DEPTH / shear))
    spacing = 2 * half / grid.sides
    first, last = contact.middle + half * draw.uniform(1.1, 1.4, 2) * (-1, 1)
    sizes = max(first, 0.04), min(last, 0.96), spacing, 1.0, True
    rows = grid.corners(0.0, spacing, spacing, DEPTH)
    cards = mesh("UP", grid.corners(*sizes), rows, "CPE" + grid.kind)
    cards += mesh("LOW", grid.corners(*sizes, True), -rows[::-1], "CPE" + grid.kind, 100001, to=lambda x, y: (
        x, y - float(wave.depth(x)) * (1 + y / DEPTH)))
    for name, *constants in zip(("UP", "LOW"), young, poisson, strict=True):
        cards += material(name, constants)
    for name, held in (("UP", DEPTH), ("LOW", -DEPTH)):
        cards += periodic(cards, name, held)
    pair = "LOW.TOP, UP.BOTTOM" if grid.pairing == "NODES" and seed // 2 % 2 else "UP.BOTTOM, LOW.TOP"
    cards += ["*SURFACE INTERACTION, NAME=I", "*FRICTION", f"{friction:.15g}",
              f"*CONTACT PAIR, INTERACTION=I, NAME=J, PAIRING={grid.pairing}", pair]
    for count, move in zip(draw.integers(2, 11, 2), (0.0, along), strict=True):
        cards += ["*STEP", "*STATIC, DIRECT", f"{1 / count:.15g}, 1.", "*BOUNDARY", "LOW.BOTTOM, 1, 2",
                  f"UP.TOP, 1, 1, {move:.15g}", f"UP.TOP, 2, 2, {-down:.15g}", "*END STEP"]
    exact = {"normal_force": contact.mean, "shear_force": friction * ratio * contact.mean,
             "peak_pressure": contact.peak, "edge_contact": contact.middle + half,
             "edge_stick": stick.middle + stick.half}
    return Problem(f"wave_{seed}", "\n".join(cards) + "\n", exact, grid.spacing(spacing))


def periodic(cards, name, held):
    """Return equations of both sides, without those of the nodes that *BOUNDARY holds."""
    nodes = {n: place for n, place in nodes_of(cards).items() if (n > 100000) == (name == "LOW")}
    found = []
    for letter, end in (("L", 0.0), ("R", 1.0)):
        side = sorted((y, n) for n, (x, y) in nodes.items() if x == end and y != held)
        found += [f"*NSET, NSET={name}_{letter}", *(f"{n}," for _, n in side)]
    return found + ["*EQUATION"] + [card for k in (1, 2) for card in (
        "2", f"{name}_R, {k}, 1., {name}_L, {k}, -1.")]


def hot_die(draw, seed, grid, is_round):
    """Return the problem of a die."""
    law_kind = LAWS[seed // 2 % 4]
    is_hot = law_kind == "heat in" or law_kind == "jump" and draw.uniform() < 0.5
    a, poisson, mixed, is_held = draw.uniform(0.3, 1.0), draw.uniform(0.2, 0.4), draw.uniform(), draw.uniform() < 0.5
    width, closed, growth = a + draw.uniform(1.5, 2.5), 2 * 25 ** draw.uniform(), draw.uniform(10.0, 150.0)
    length = HEIGHT * draw.uniform(0.05, 0.5)
    warmth = draw.uniform(0.6, 2.4) if is_hot else -draw.uniform(0.2, 1.0)
    law = hot_dies.Law(closed, closed * growth, 0.0 if law_kind == "jump" else closed, length)
    die = 0.0 if law_kind == "cold" else warmth * (1 - poisson) / (1 + poisson)

    def shape(x):
        return HEIGHT * ((1 - mixed) * (x / a) ** 2 + mixed * (x / a) ** 4)

    layer = hot_dies.Layer(a, width, is_round, poisson, YOUNG / (1 - poisson**2), is_held)
    state = hot_dies.pressed_die(layer, shape, HEIGHT, die, law)
    while not state.is_one:
        die *= 0.7
        state = hot_dies.pressed_die(layer, shape, HEIGHT, die, law)
    spacing, element = 2 * a / grid.sides, ("CAX" if is_round else "CPE") + grid.kind
    sizes = 0.0, a * draw.uniform(1.1, 1.4), spacing, width, False
    cards = mesh("LAYER", grid.corners(*sizes), -grid.corners(0.0, spacing, spacing, 1.0)[::-1], element)
    cards += mesh("DIE", grid.corners(*sizes, True), [0.0, THICK], element, 100001,
                  to=lambda x, y: (x, y + float(shape(x))))
    heated = (HEIGHT, 1.0) if die else ()
    cards += [card for name in ("LAYER", "DIE") for card in material(name, (YOUNG, poisson), *heated)]
    cards += ["*SURFACE INTERACTION, NAME=I"]
    if die:
        cards += ["*GAP LAW, TYPE=POWER", f"{law.closed:.15g}, {law.growth:.15g}, 1."]
        cards += ["*GAP LAW, TYPE=GAS", f"{law.opened * length:.15g}, {length:.15g}"] if law.opened else []
        cards += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LAYER, 0.", "DIE, 0."]
    pair = "DIE.BOTTOM, LAYER.TOP" if grid.pairing == "NODES" and seed // 8 % 2 else "LAYER.TOP, DIE.BOTTOM"
    cards += [f"*CONTACT PAIR, INTERACTION=I, NAME=J, PAIRING={grid.pairing}", pair, "*STEP",
              "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT" if die else "*STATIC, DIRECT",
              f"{1 / draw.integers(1, 11):.15g}, 1.", "*BOUNDARY", "LAYER.BOTTOM, 2", "LAYER.LEFT, 1",
              "LAYER.RIGHT, 1", "DIE, 1", f"DIE, 2, 2, {-state.approach:.15g}"]
    cards += ["LAYER.BOTTOM, 1"] if is_held else []
    cards += ["LAYER.BOTTOM, 11", f"DIE, 11, 11, {die:.15g}"] if die else []
    exact = {"normal_force": state.force, "peak_pressure": state.peak, "edge_contact": a}
    exact |= {"heat_rate": abs(state.heat)} if die else {}
    exact |= {"temperature": state.hottest} if die > 0 else {}
    name = f"die_{'round' if is_round else 'plane'}_{seed}"
    return Problem(name, "\n".join([*cards, "*END STEP"]) + "\n", exact, grid.spacing(spacing))
