"""The decks on which the constants of numerical uncertainties were chosen: known ones, and ones whose
materials, friction, geometry and loads are drawn at random with a fixed seed."""

import sys
from dataclasses import dataclass, replace

import numpy as np
from deck_runs import COUPLED, CYLINDER, HERTZ, INPUT
from test_mortar_curved import hertz

sys.path.insert(0, str(INPUT / "cylinder"))

import make_decks  # noqa: E402

EXAMPLES = INPUT / "examples"
FINE, HEIGHT = make_decks.FINE, make_decks.HEIGHT
FAMILIES = ("plane", "ball", "ring", "punch")
SEEDS = range(20)
MORE = range(52, 68)
MISMATCHED = [seed for seed in range(20, 68) if FAMILIES[seed % len(FAMILIES)] != "ring"]


@dataclass(frozen=True)
class DrawnDeck:
    """A deck, its interface, and whether the path to its loads matters."""

    name: str
    text: str
    face: str
    has_path: bool


@dataclass(frozen=True)
class Rounded(make_decks.Reading):
    """A body with a face that is flat up to an abscissa, and of one curvature from there on."""

    radius: float = 100.0
    flat: float = 0.0

    def face(self, x):
        """Return the height of the curved face."""
        return max(0.0, x - self.flat) ** 2 / (2 * self.radius)


def known_decks():
    """Return the decks that are not drawn."""
    cylinder = CYLINDER.read_text()
    aluminium = (cylinder.replace("0.155, 1.E5", "0.3, 1.E5").replace("ZAITSEV\n", "NEWTON\n").replace(
        "LOWER\n*ELASTIC\n2.E4, 0.2\n*EXPANSION\n1.2E-5\n*CONDUCTIVITY\n0.18",
        "LOWER\n*ELASTIC\n7.E3, 0.33\n*EXPANSION\n2.4E-5\n*CONDUCTIVITY\n2."))
    return [DrawnDeck("cylinder", cylinder, "FACE", True),
            DrawnDeck("cylinder, mu = 0.3, aluminium", aluminium, "FACE", True),
            DrawnDeck("coupled twin", COUPLED.read_text(), "FACE", True),
            DrawnDeck("Hertz", HERTZ.read_text(), "FACE", False),
            DrawnDeck("press fit", (EXAMPLES / "press_fit.inp").read_text(), "SEAT", False),
            DrawnDeck("cracked plate", (EXAMPLES / "cracked_plate.inp").read_text(), "CRACK", False)]


def all_decks():
    """Return the known decks, then those of the seeds."""
    return known_decks() + [drawn_deck(seed) for seed in (*SEEDS, *MORE)]


def mismatched_deck(seed):
    """Return the drawn deck with mortar points: nodes of the base moved along x, by a power that is drawn,
    so that they lie beside those of the other body. Not for rings."""
    deck, power = drawn_deck(seed), np.random.default_rng(1000 + seed).uniform(0.88, 1.15)
    cards, is_base = [], False
    for card in deck.text.replace("PAIRING=NODES", "PAIRING=SURFACES").splitlines():
        is_base = card == "*NODE, NSET=BASE" or is_base and not card.startswith("*")
        if is_base and not card.startswith("*"):
            number, x, y = card.split(",")
            card = f"{number}, {make_decks.WIDTH * (float(x) / make_decks.WIDTH) ** power:.12g},{y}"
        cards.append(card)
    return replace(deck, name=f"{deck.name}, mortar", text="\n".join(cards) + "\n")


def mismatched_decks():
    """Return the decks with mortar points on faces that do not match: those of seeds, then Hertz with 3
    sides on 2, each face as the slave."""
    decks = [mismatched_deck(seed) for seed in MISMATCHED]
    for slave, sides in (("CURVED", (24, 16)), ("FLAT", (16, 24))):
        text = "\n".join(hertz(*sides, slave)[0]) + "\n"
        decks.append(DrawnDeck(f"Hertz 3 to 2, slave {slave}", text, "FACE", False))
    return decks


def log_uniform(draw, low, high):
    """Return a number whose logarithm is drawn evenly."""
    return float(low * (high / low) ** draw.uniform())


def drawn_deck(seed):
    """Return a deck on the cylinder's mesh, everything else drawn: a plane or axisymmetric body with a
    round face or a punch with round edges, pushed or heated towards a flat one, or a crowned ring
    about another that is hotter; in one step, or loaded and then unloaded in part."""
    draw = np.random.default_rng(seed)
    family = FAMILIES[seed % len(FAMILIES)]
    is_ring, is_heated = family == "ring", bool(draw.uniform() < 0.7)
    ratio = log_uniform(draw, 0.25, 4.0)
    young = 2e5 * ratio**0.5, 2e5 / ratio**0.5
    poisson = draw.uniform(0.15, 0.42, 2)
    expansion = [log_uniform(draw, 0.5e-5, 2e-5) for _ in range(2)]
    conductivity = [log_uniform(draw, 0.05, 1.0) for _ in range(2)]
    friction = 0.0 if draw.uniform() < 0.15 else log_uniform(draw, 0.03, 0.4)
    radius = log_uniform(draw, 40.0, 400.0)
    # At a node, so that the sides of the elements follow the face.
    flat = float(draw.choice(make_decks.CONTACT[2:5])) if family == "punch" else 0.0
    approach = draw.uniform(1.0, 3.5) * (FINE - flat) ** 2 / (2 * radius)
    lift = 0.0 if draw.uniform() < 0.5 else draw.uniform(0.1, 0.5) * approach
    omega = log_uniform(draw, 0.3, 10.0) * min(conductivity) / FINE
    increments, is_unloaded = int(draw.integers(10, 30)), bool(draw.uniform() < 0.4)
    bodies = make_decks.make_mesh(round(lift, 6), Rounded(radius=radius, flat=flat))
    cards, bore = make_decks.mesh_cards(bodies), draw.uniform(20.0, 200.0)
    if is_ring:
        cards = turned(cards, bodies, bore)
    cards = [card.replace("CPE8", "CAX8") if family in ("ball", "ring") else card for card in cards]
    for name, *values in zip(("UPPER", "LOWER"), young, poisson, expansion, conductivity, strict=True):
        cards += material(name, *values)
    cards += ["*SOLID SECTION, ELSET=CYLINDER, MATERIAL=UPPER",
              "*SOLID SECTION, ELSET=BASE, MATERIAL=LOWER", "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
              "CYLINDER, 0.", "BASE, 0.", "*SURFACE INTERACTION, NAME=FACES"]
    cards += ["*FRICTION", f"{friction:.6g}"] if friction else []
    if is_heated:
        growth = omega * log_uniform(draw, 1e-3, 1e-1)
        cards += ["*GAP LAW, TYPE=GAS", f"{omega * 1e-5:.9g}, 1.E-5", "*GAP LAW, TYPE=POWER",
                  f"{omega:.9g}, {growth:.9g}, {draw.uniform(0.8, 1.0):.6g}"]
    cards += ["*CONTACT PAIR, INTERACTION=FACES, NAME=FACE, PAIRING=NODES", "CURVED, FLAT"]
    parts = (1.0, draw.uniform(0.3, 0.8)) if is_unloaded else (1.0,)
    size = (approach + lift) * (1.3 if is_ring else 1.0)
    if is_heated:
        hot, cold = (1, 0) if is_ring else (0, 1)
        size /= HEIGHT * (0.75 * expansion[hot] * (1 + poisson[hot])
                          + 0.25 * expansion[cold] * (1 + poisson[cold]))
    cards += loading(size, parts, increments, is_ring, is_heated)
    return DrawnDeck(f"{family} {seed}", "\n".join(cards) + "\n", "FACE", friction > 0.0)


def turned(cards, bodies, bore):
    """Return the cards of bodies turned by a right angle, so that the base is a ring with a bore and
    the other body a ring about it. The sets keep their nodes."""
    nodes = {n: place for body, _ in bodies for n, place in body.items()}
    found, is_node = [], False
    for card in cards:
        is_node = card.startswith("*NODE,") or is_node and not card.startswith("*")
        if is_node and not card.startswith("*"):
            number = int(card.split(",")[0])
            x, y = nodes[number]
            card = f"{number}, {bore + HEIGHT + y:.12g}, {-x:.12g}"
        found.append(card)
    return found


def material(name, young, poisson, expansion, conductivity):
    """Return the cards of a material."""
    return [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{young:.9g}, {poisson:.6g}", "*EXPANSION",
            f"{expansion:.9g}", "*CONDUCTIVITY", f"{conductivity:.9g}"]


def loading(size, parts, increments, is_ring, is_heated):
    """Return supports and steps that end at parts of a temperature or a displacement."""
    normal = 1 if is_ring else 2
    hot, cold = ("BOTTOM", "TOP") if is_ring else ("TOP", "BOTTOM")
    cards = ["*BOUNDARY", f"{cold}, {normal}, {normal}, 0.", f"AXIS, {3 - normal}, {3 - normal}, 0."]
    before = 0.0
    for part in parts:
        kind = "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE" if is_heated else "*STATIC"
        count = max(4, round(increments * abs(part - before)))
        cards += ["*STEP, INC=1000", f"{kind}, DIRECT", f"{1.0 / count!r}, 1.", "*BOUNDARY"]
        if is_heated:
            cards += [f"{hot}, 11, 11, {size * part:.9g}", f"{cold}, 11, 11, 0.",
                      f"{hot}, {normal}, {normal}, 0."]
        else:
            cards += [f"{hot}, {normal}, {normal}, {(1 if is_ring else -1) * size * part:.9g}"]
        cards += ["*NODE FILE, FREQUENCY=0", "U", "*END STEP"]
        before = part
    return cards
