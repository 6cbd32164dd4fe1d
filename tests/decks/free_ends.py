"""Decks of bodies in generalized plane strain, whose ends are free, and closed forms of what they
do."""

from math import cos, log, pi, radians, sin

import numpy as np
from inelastic import A, N, YOUNG, law, step
from physics import material, mesh, nodes_of

WIDTH, HEIGHT, THICK, MODULUS = 4.0, 2.0, 1.5, 1000.0
KINDS = ["CPEG8", "CPEG8R", "CPEG4I", "CPEG6"]


def general(cards, node=900, place=(0.0, 0.0), thickness=THICK):
    """Return the cards of a body with a reference node; they end with its section."""
    return ["*NODE", f"{node}, {place[0]!r}, {place[1]!r}", *cards[:-1],
            f"{cards[-1]}, REF NODE={node}", f"{thickness!r}"]


def corner(cards, x, y):
    """Return the number of the node at a place, which the deck may have."""
    places = nodes_of(cards)
    return min(places, key=lambda n: np.hypot(places[n][0] - x, places[n][1] - y))


def bar(kind="CPEG8", place=(0.0, 0.0), counts=(2, 2), **more):
    """Return a bar that nothing holds along z, without rigid motions."""
    body = mesh("BODY", [float(x) for x in np.linspace(-2.0, 2.0, counts[0] + 1)],
                [float(y) for y in np.linspace(-1.0, 1.0, counts[1] + 1)], kind)
    given = material("BODY", **({"elastic": (MODULUS, 0.3)} | more))
    return [*body, *general(given, place=place), "*BOUNDARY",
            f"{corner(body, -2, -1)}, 1, 2", f"{corner(body, 2, -1)}, 2"]


def forces(strain, place):
    """Return force and moments about a place of a strain along z a + b y + c x."""
    a, b, c = strain
    area = WIDTH * HEIGHT
    force = MODULUS * a * area
    about_x = MODULUS * b * area * HEIGHT**2 / 12 - force * place[1]
    about_y = -MODULUS * c * area * WIDTH**2 / 12 + force * place[0]
    return force, about_x, about_y


def freedoms(strain, place):
    """Return degrees of freedom 3 to 5 of a reference node."""
    a, b, c = strain
    return THICK * (a + b * place[1] + c * place[0]), THICK * b, -THICK * c


STRAIN = 2e-3, 1e-3, -4e-4


def bent(strain, place, kind, is_loaded):
    """Return a bar under force and moments, or with given strains, and its checks."""
    known = forces(strain, place), freedoms(strain, place)
    given = known[0] if is_loaded else known[1]
    keyword, between = ("*CLOAD", "{0}") if is_loaded else ("*BOUNDARY", "{0}, {0}")
    most = MODULUS * (strain[0] + strain[1] - 2 * strain[2])
    return [*bar(kind, place), *step("*STATIC", "1., 1.", keyword, *(
        f"900, {between.format(dof)}, {value!r}"
        for dof, value in zip((3, 4, 5), given, strict=True)))], [
            *((name, "900", "LAST", value, 1e-9) for name, value in zip(
                ("RF3", "RM1", "RM2", "U3", "UR1", "UR2"), [*known[0], *known[1]], strict=True)),
            ("S33", "MAX", "LAST", most, 1e-9), ("S11", "MAX", "LAST", 0.0, 1e-9, "ABS"),
            ("S22", "MAX", "LAST", 0.0, 1e-9, "ABS"), ("S12", "MAX", "LAST", 0.0, 1e-9, "ABS"),
            ("force_imbalance", "", "LAST", 0.0, 1e-10, "ABS")]


def hot_ring(around, kind="CPEG8R"):
    """Return a whole ring 50/100, 100 hot in the bore and cold outside, T being linear in log r, and
    what it does with free ends: it grows by its mean temperature, and sigma_z is that of plane
    strain less its mean. The reference node is aside."""
    bore, outside, growth, warmth, length = 50.0, 100.0, 1.2e-5, 100.0, 3.0
    body = mesh("RING", [float(t) for t in np.linspace(0.0, 2 * pi, around + 1)],
                [float(r) for r in np.linspace(outside, bore, around // 4 + 1)], kind, closed=True,
                to=lambda t, r: (r * cos(t), r * sin(t)))
    hot = [f"{n}, {warmth * log(outside / np.hypot(x, y)) / log(outside / bore)!r}"
           for n, (x, y) in nodes_of(body).items()]
    mean = warmth * (0.5 / log(outside / bore) - bore**2 / (outside**2 - bore**2))
    unit = YOUNG * growth / 0.7
    given = material("RING", (YOUNG, 0.3), growth)
    cards = [*body, *general(given, 90000, (30.0, -20.0), length),
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "RING, 0.", "*BOUNDARY",
             f"{corner(body, bore, 0)}, 2", f"{corner(body, -bore, 0)}, 2",
             f"{corner(body, 0, bore)}, 1", *step("*STATIC", "1., 1.", "*TEMPERATURE", *hot)]
    return cards, {"U3": (90000, length * growth * mean), "bore": (corner(body, bore, 0),
                   unit * (mean - warmth)), "outside": (corner(body, outside, 0), unit * mean)}


SEAT = 50.0


def free_fit(elements, *steps, turn=10.0):
    """Return a sector of a solid shaft 50 in a creeping hub 50/100 with elements through it, each
    with a reference node, and the force of a unit pressure between them."""
    low, high = (SEAT, 0.0), (SEAT * cos(radians(turn)), SEAT * sin(radians(turn)))
    middle = SEAT * cos(radians(turn / 2)), SEAT * sin(radians(turn / 2))
    places = [(0.0, 0.0), low, high, (SEAT / 2, 0.0), middle, (high[0] / 2, high[1] / 2)]
    hub = mesh("HUB", [float(r) for r in np.linspace(SEAT, 2 * SEAT, elements + 1)],
               [0.0, turn], "CPEG8R", first=101,
               to=lambda r, t: (r * cos(radians(t)), r * sin(radians(t))))
    axes = f"{cos(radians(turn))!r}, {sin(radians(turn))!r}, 0., {-sin(radians(turn))!r}, " \
           f"{cos(radians(turn))!r}, 0."
    return ["*NODE", *(f"{n}, {x!r}, {y!r}" for n, (x, y) in enumerate(places, 1)),
            "*ELEMENT, TYPE=CPEG6, ELSET=SHAFT", "1, 1, 2, 3, 4, 5, 6", "*SURFACE, NAME=SEAT", "1, S2",
            *hub, *general(material("SHAFT", (YOUNG, 0.3)), 9000),
            *general(law("*CREEP", f"{A!r}, {N!r}", name="HUB"), 9001),
            "*NSET, NSET=HIGH", "3, 6, HUB.TOP", "*TRANSFORM, NSET=HIGH", axes,
            "*SURFACE INTERACTION, NAME=JOINT", "*CONTACT PAIR, INTERACTION=JOINT, NAME=FIT",
            "SEAT, HUB.LEFT", "*CLEARANCE, SLAVE=SEAT, MASTER=HUB.LEFT, VALUE=-0.05",
            "*BOUNDARY", "1, 1, 2", "2, 2", "4, 2", "HUB.BOTTOM, 2", "HIGH, 2",
            "9000, 4, 5", "9001, 4, 5", *step("*STATIC", "1., 1."), *steps], \
        SEAT * radians(turn) * THICK
