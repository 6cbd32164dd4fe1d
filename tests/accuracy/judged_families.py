"""Families of decks that judge the numerical uncertainties: functions of a seed, which draws materials,
friction, geometry, loads, mesh and increments. Seeds below 1000 may be looked at while constants are chosen;
those from 1000 on judge.
"""

import re

import numpy as np
from deck_runs import HERTZ
from drawn_decks import FAMILIES as DRAWN
from drawn_decks import drawn_deck, log_uniform, mismatched_deck
from judged_joint import BASE, FINE, Joint, JudgedDeck
from physics import material, mesh, nodes_of

REFERENCE = 900001   # number of the reference node of a section or a rigid body
SHIFT = 101          # to the seed of another family of drawn_decks
FORMS = "roller", "punch", "mesh"   # of rigid bodies


def stacked(joint, **of_materials):
    """Return the deck of a joint of two blocks."""
    joint.upper()
    joint.lower()
    joint.materials(**of_materials)
    is_heated = not joint.is_whole and joint.draw.uniform() < 0.6
    if is_heated:
        joint.conductance()
    joint.interact()
    joint.hold()
    joint.loaded(is_heated)
    return joint.deck()


def local(seed):
    """Local refinement: decks whose faces alone are divided, of this module, of drawn_decks, and Hertz's."""
    draw = np.random.default_rng([seed, 404])
    levels, is_mortar = int(draw.integers(1, 3)), bool(draw.integers(2))
    if seed % 3 == 0:
        pairing = {"part": draw.uniform(0.6, 0.9), "pairing": "SURFACES"} if is_mortar else {}
        deck = stacked(Joint("local", seed, draw.uniform() < 0.25, (str(draw.choice(["8", "8R", "6"])),) * 2, most=9,
                             **pairing))
        text, has_path = deck.text, deck.has_path
    elif seed % 3 == 1:
        deck = mismatched_deck(seed) if is_mortar and DRAWN[seed % len(DRAWN)] != "ring" else drawn_deck(seed)
        text, has_path = deck.text, deck.has_path
    else:
        text = HERTZ.read_text().split("*VERIFY")[0].replace("*REFINE, LEVELS=1\n", "")
        text = text.replace("P2, 6.", f"P2, {draw.uniform(1.5, 6.0):.6g}").replace(
            "DIRECT\n0.25,", f"DIRECT\n{1 / int(draw.integers(1, 6))!r},").replace("*STEP\n", "*STEP, INC=100\n")
        text = text.replace("2.1E5, 0.3", f"{log_uniform(draw, 5e4, 5e5):.6g}, {draw.uniform(0.2, 0.4):.6g}")
        has_path = False
    pair = re.search(r"^\*CONTACT PAIR.*\n(.+)", text, re.M)
    faces = pair[1].split(", ")[:2 if "PAIRING=SURFACES" in text else 1]
    cards = "".join(f"*REFINE, LEVELS={levels}, SURFACE={face}\n" for face in faces)
    return JudgedDeck("local", f"local {seed}", text.replace("*STEP", cards + "*STEP", 1), ("FACE",), has_path, levels)


def peak(seed):
    """Stress peaks away from the contact: an elliptic hole in the block, whose side is pulled, too."""
    joint = Joint("peak", seed)
    draw, width, depth = joint.draw, joint.width, joint.depth
    joint.kinds[1] = joint.kinds[0] = joint.kinds[0][:3] + str(draw.choice(["8", "8R", "6"]))
    centre = -draw.uniform(0.5, 0.6) * depth
    axes = draw.uniform(0.12, 0.22, 2) * depth
    top = [(x, 0.0) for x in joint.columns["LOW"][::-1]]
    foot = [(x, -depth) for x in np.linspace(0.0, width, draw.integers(3, 5))]
    side = [(width, y) for y in np.linspace(-depth, 0.0, draw.integers(4, 6))]
    outline = np.array([*foot, *side[1:], *top[1:]])
    ways = np.unwrap(np.arctan2(outline[:, 1] - centre, outline[:, 0]))

    def place(s, t):
        k = np.arange(len(outline))
        x, y = (np.interp(t, k, outline[:, i]) for i in (0, 1))
        angle = np.interp(t, k, ways)
        near = axes[0] * np.cos(angle), centre + axes[1] * np.sin(angle)
        found = near[0] + s * (x - near[0]), near[1] + s * (y - near[1])
        return tuple(0.0 if abs(v) < 1e-12 else float(v) for v in found)

    joint.upper()
    count = draw.integers(5, 9)
    sizes = draw.uniform(1.3, 1.7) ** np.minimum(np.arange(count), np.arange(count)[::-1])
    across = np.append(0.0, np.cumsum(sizes)) / sizes.sum()
    cards = mesh("LOW", across, np.arange(len(outline)), joint.kinds[1], BASE, to=place)
    faces = cards[cards.index("*SURFACE, NAME=LOW.RIGHT") + 1:cards.index("*NSET, NSET=LOW.TOP")]
    joint.cards += cards + ["*SURFACE, NAME=LOW.FACE", *faces[-len(top) + 1:], "*SURFACE, NAME=LOW.SIDE",
                            *faces[len(foot) - 1:1 - len(top)]]
    for name, axis, value in (("FOOT", 1, -depth), ("AXIS", 0, 0.0)):
        joint.cards += [f"*NSET, NSET={name}",
                        *(str(n) for n, where in nodes_of(cards).items() if abs(where[axis] - value) < 1e-9)]
    joint.materials()
    joint.interact(("UP.BOTTOM", "LOW.FACE"))
    joint.held = ["*BOUNDARY", "FOOT, 2, 2", "AXIS, 1, 1", "UP.LEFT, 1, 1"]
    joint.press()
    peak_of_hertz = joint.young[1] * np.sqrt(joint.down / joint.radius) / 4
    joint.step("*STATIC", "*DSLOAD", f"LOW.SIDE, P, {-draw.uniform(0.3, 0.8) * peak_of_hertz:.9g}")
    return joint.deck(maxima=((2, "von_mises", (0.0, centre, 1.15 * axes.max())),))


def triangles(seed):
    """Triangles in one body or both; linear ones in the block."""
    draw = np.random.default_rng([seed, 400])
    kinds = (("6", "6"), ("6", "8"), ("8", "6"), ("6", "3"), ("8", "3"), ("6", "6"))[draw.integers(6)]
    is_mortar = kinds[1] == "3" or draw.uniform() < 0.5
    joint = Joint("triangles", seed, draw.uniform() < 0.25, kinds, draw.uniform(0.7, 0.9) if is_mortar else 1.0,
                  "SURFACES" if is_mortar else "NODES", 11)
    return stacked(joint)


def coarse(seed):
    """Mortar points whose masters are two to five times as long."""
    draw = np.random.default_rng([seed, 401])
    kinds = str(draw.choice(["8", "8R", "6"])), str(draw.choice(["8", "8", "6", "4"]))
    joint = Joint("coarse", seed, draw.uniform() < 0.25, kinds, 1 / draw.uniform(2.0, 5.0), "SURFACES", 20)
    return stacked(joint)


def tables(seed):
    """Constants and conductances that follow temperatures."""
    joint = Joint("tables", seed, False, (str(np.random.default_rng([seed, 402]).choice(["8", "8R", "6"])),) * 2,
                  most=9)
    draw, joint.counts = joint.draw, [min(count, 6) for count in joint.counts]   # tables take their time
    top = 1.2 * 0.7 * joint.down / (0.5 * joint.expansion[0] * joint.height + 0.5 * joint.expansion[1] * joint.depth)

    def rows(value, least, most, *rest):
        """A table that ends at a part of the value that is drawn."""
        last = draw.uniform(least, most)
        return [(value * (1 + (last - 1) * part), *rest, top * part) for part in (0.0, draw.uniform(0.3, 0.7), 1.0)]

    joint.upper()
    joint.lower()
    joint.materials(
        elastic=[rows(joint.young[k], 0.4, 0.9, joint.poisson[k]) for k in (0, 1)],
        expansion=[rows(joint.expansion[k], 0.8, 1.5) for k in (0, 1)],
        conductivity=[rows(joint.conductivity[k], 0.3, 1.6) for k in (0, 1)], zero=[0.0, 0.0])
    closed, length = log_uniform(draw, 0.3, 10.0) * min(joint.conductivity), log_uniform(draw, 1e-3, 1e-2)
    times, growth = draw.uniform(1.2, 2.0), log_uniform(draw, 1.0, 10.0)
    joint.law = ["*GAP LAW, TYPE=GAS", *(f"{closed * length * t:.9g}, {length:.9g}, {x:.9g}"
                                        for t, x in ((1.0, 0.0), (times, top))), "*GAP CONDUCTANCE, PRESSURE"]
    joint.law += [f"{closed * t * g:.9g}, {p:.9g}, {x:.9g}" for t, x in ((1.0, 0.0), (times, top))
                  for g, p in ((1.0, 0.0), (1.0 + growth, 1000.0))]
    joint.interact()
    joint.hold()
    joint.press()
    joint.heat()
    return joint.deck()


def rigid(seed):
    """Rigid bodies."""
    kind = str(np.random.default_rng([seed, 403]).choice(["8", "8R", "6", "4"]))
    form = FORMS[seed % 3]
    pairing = "SURFACES" if seed // 3 % 2 else "NODES"
    # A rigid body with nodes on an axis cannot move but along it. Its elements cannot have hanging nodes.
    special = {"pairing": "SURFACES", "rounds": 0.0} if form == "mesh" else {"pairing": pairing}
    kinds = "8" if form == "mesh" and kind == "4" else kind, kind
    return pressed(Joint("rigid", seed, False, kinds, **special), form)


def pressed(joint, form):
    """Return the deck of a block under a drawn roller, a drawn punch with round edges, or a rigid
    mesh with a round face."""
    joint.slave = "LOW"
    draw, start, end = joint.draw, 1.8 * FINE, 0.0 if joint.is_round else -0.5
    joint.lower()
    joint.cards += ["*NODE, NSET=REF", f"{REFERENCE}, 0., {joint.height:.15g}"]
    if form == "mesh":
        joint.upper()
        joint.cards += [f"*RIGID BODY, REF NODE={REFERENCE}, ELSET=UP, ISOTHERMAL=YES"]
    elif form == "roller":
        heights = [joint.radius - np.sqrt(joint.radius**2 - x**2) for x in (start, end)]
        joint.cards += ["*SURFACE, NAME=DIE, TYPE=SEGMENTS", f"START, {start}, {heights[0]:.15g}",
                        f"CIRCL, {end}, {heights[1]:.15g}, 0., {joint.radius:.15g}"]
    else:
        flat, radius = draw.uniform(0.4, 0.7) * FINE, log_uniform(draw, 1.0, 20.0)
        across = min(0.8 * radius, start - flat)
        high = radius - np.sqrt(radius**2 - across**2)
        joint.cards += ["*SURFACE, NAME=DIE, TYPE=SEGMENTS", f"START, {flat + across:.15g}, {high:.15g}",
                        f"CIRCL, {flat:.15g}, 0., {flat:.15g}, {radius:.15g}", f"LINE, {end}, 0."]
    joint.cards += [] if form == "mesh" else [f"*RIGID BODY, REF NODE={REFERENCE}, ANALYTICAL SURFACE=DIE"]
    joint.materials(("UP", "LOW") if form == "mesh" else ("LOW",))
    is_heated = draw.uniform() < 0.5
    if is_heated:
        joint.conductance()
    joint.interact(("UP.BOTTOM" if form == "mesh" else "DIE", "LOW.TOP"))
    joint.top = "REF"
    joint.hold(("LOW",))
    joint.held += ["REF, 1, 1", "REF, 6, 6"]
    joint.loaded(is_heated)
    return joint.deck()


def transients(seed):
    """Bodies that store heat: a press fit under a shock, a brake, a casting in a die or about a core."""
    return (press_fit, brake, casting)[seed % 3](Joint("transients", seed, most=9))


def capacities(joint, factor=1.0):
    """Return densities and specific heats, and the time in which heat crosses a length squared of one."""
    heats = [log_uniform(joint.draw, 2.0, 5.0) * factor for _ in range(2)]
    times = [heat * 1e-3 / conductivity for heat, conductivity in zip(heats, joint.conductivity, strict=True)]
    return {"density": [1e-3] * 2, "specific_heat": heats}, float(np.mean(times))


def brake(joint):
    """A pad is pressed on a disc that slides out of the plane, with heat of friction."""
    joint.friction = joint.friction or 0.2
    joint.upper()
    joint.lower()
    more, time = capacities(joint)
    joint.materials(**more)
    joint.conductance(0.0)
    # About as warm as bulges a part of the approach.
    pressure = joint.young.min() * np.sqrt(joint.down / joint.radius) / 4
    rise = joint.draw.uniform(0.2, 0.6) * joint.down / (max(joint.expansion) * 2 * joint.height)
    speed = rise * min(joint.conductivity) / (joint.friction * pressure * FINE)
    joint.law += ["*GAP HEAT GENERATION", f"1., {joint.draw.uniform(0.3, 0.7):.6g}, {speed:.9g}"]
    joint.interact()
    joint.hold()
    joint.held += ["LOW.BOTTOM, 11, 11, 0."]
    joint.press()
    for period in joint.draw.uniform(0.3, 3.0, 2) * time:
        joint.step("*COUPLED TEMPERATURE-DISPLACEMENT", period=float(period), more=2)
    return joint.deck(True, maxima=((1, "temperature", None), (2, "temperature", None)))


def rings(joint, overlap):
    """Add a shaft or core and a ring about it that end together, their materials with capacities and the
    interface; return the time of heat through them."""
    draw = joint.draw
    joint.kinds = ["CAX" + str(draw.choice(["8", "8R", "6"]))] * 2
    bore, outer, high = draw.choice([0.0, 1.0]), draw.uniform(3.2, 4.5), draw.uniform(1.0, 3.0)
    sizes = draw.integers(4, 8, 2)
    is_matched = draw.uniform() < 0.5
    joint.pairing = "NODES" if is_matched else "SURFACES"
    for k, (name, xs) in enumerate((("UP", np.array([2.0, outer])), ("LOW", np.array([bore, 2.0])))):
        part = np.linspace(0, 1, sizes[k] + 1) ** 1.5
        xs = xs[0] + np.ptp(xs) * (part if name == "UP" else 1 - part[::-1])
        ys = high * (1 - (1 - np.linspace(0, 1, sizes[0 if is_matched else k] + 1)) ** 1.5)
        joint.cards += mesh(name, xs, ys, joint.kinds[k], 1 if name == "UP" else BASE)
    more, time = capacities(joint)
    joint.materials(**more)
    joint.conductance()
    joint.slave = "UP" if sizes[0] >= sizes[1] else "LOW"
    pair = ("UP.LEFT", "LOW.RIGHT")
    joint.interact(pair)
    if overlap:
        names = pair if joint.slave == "UP" else pair[::-1]
        joint.cards += [f"*CLEARANCE, SLAVE={names[0]}, MASTER={names[1]}, VALUE={-overlap!r}"]
    joint.held = ["*BOUNDARY", "UP.BOTTOM, 2", "LOW.BOTTOM, 2", *(["LOW.LEFT, 1"] if not bore else [])]
    return time


def press_fit(joint):
    """A shaft in a hub whose outside is suddenly heated or cooled by a film."""
    overlap = log_uniform(joint.draw, 5e-4, 4e-3)
    time = rings(joint, overlap)
    joint.step("*STATIC", period=1e-3 * time)
    rise = joint.draw.uniform(0.3, 1.2) * overlap / (2 * max(joint.expansion)) * joint.draw.choice([-1, 1])
    film = log_uniform(joint.draw, 0.3, 5.0) * joint.conductivity[0]
    for period in joint.draw.uniform(0.2, 2.0, 2) * time:
        joint.step("*COUPLED TEMPERATURE-DISPLACEMENT", "*SFILM", f"UP.RIGHT, F, {rise:.9g}, {film:.9g}",
                   period=float(period), more=2)
    return joint.deck(True, maxima=((1, "temperature", None), (2, "temperature", None)), has_corners=True)


def casting(joint):
    """A hot ring about a cold core, on which it shrinks, or a hot body in a cold die, where a gap opens."""
    time = rings(joint, 0.0)
    hot = "UP" if joint.draw.uniform() < 0.5 else "LOW"
    text = "\n".join(joint.cards).replace("TEMPERATURE\nUP, 0.\nLOW, 0.", "TEMPERATURE\n" + "\n".join(
        f"{name}, {joint.draw.uniform(200.0, 600.0) if name == hot else 0.0:.6g}" for name in ("UP", "LOW")))
    joint.cards = text.splitlines()
    film = log_uniform(joint.draw, 0.1, 2.0) * joint.conductivity[0]
    for period in joint.draw.uniform(0.2, 2.0, 2) * time:
        joint.step("*COUPLED TEMPERATURE-DISPLACEMENT", "*SFILM", f"UP.RIGHT, F, 0., {film:.9g}",
                   period=float(period), more=2)
    cold = 2 if hot == "UP" else 1
    return joint.deck(True, maxima=((cold, "temperature", None), (3 - cold, "temperature", None)), has_corners=True)


def bolts(seed):
    """A bolt clamps a flange on a gasket: tightened, then pressure, then heat, as in the examples."""
    joint = Joint("bolts", seed)
    draw, size = joint.draw, joint.draw.uniform(0.85, 1.15, 8)
    shank, bore, head, land, rim = np.array([10.0, 11.0, 16.0, 30.0, 40.0]) * size[0]
    long, thick, soft = 31.0 * size[1], 13.0 * size[2], 2.0 * size[3]
    under, seat, ring, beyond = draw.integers((3, 3, 4, 2), (5, 6, 8, 4))
    kind = "CAX" + str(draw.choice(["8", "8R", "6"]))
    seats = np.linspace(bore, head, seat + 1)
    lands = np.linspace(head, land, ring + 1)
    heads = np.concatenate([np.linspace(0, shank, under + 1), seats])
    flanges = np.concatenate([seats, lands[1:], np.linspace(land, rim, beyond + 1)[1:]])
    rows = [draw.integers(5, 9) for _ in range(3)]
    meshes = {"SHANK": (heads[:under + 1], np.linspace(-long, 0, rows[0] + 1)),
              "HEAD": (heads, -long - thick * np.linspace(1, 0, rows[1] // 2 + 2) ** 1.5),
              "FLANGE": (flanges, np.linspace(-long, -soft, rows[2] + 1)), "GASKET": (lands, [-soft, -soft / 2, 0.0])}
    cards = []
    for k, (name, places) in enumerate(meshes.items()):
        cards += mesh(name, *places, kind, 1 + 10000 * k)

    def part(side, name, first, count):
        """Give elements of a side a surface."""
        start = cards.index(f"*SURFACE, NAME={side}") + 1
        return [f"*SURFACE, NAME={name}", *cards[start + first:start + first + count]]

    cards += part("HEAD.TOP", "NECK", 0, under) + part("HEAD.TOP", "SEAT", under + 1, seat)
    cards += part("FLANGE.BOTTOM", "FACE", 0, seat) + part("FLANGE.TOP", "WET", 0, seat)
    cards += part("FLANGE.TOP", "LAND", seat, ring)
    row = under * (rows[0] // 2) * (2 if kind[3] == "6" else 1)
    cards += ["*SURFACE, NAME=CUT", *(f"{1 + row + (2 * k + 1 if kind[3] == '6' else k)}, S{2 if kind[3] == '6' else 3}"
                                      for k in range(under))]
    steel = 2.1e5, 0.3
    for name in meshes:
        cards += material(name, (log_uniform(draw, 300.0, 3000.0), 0.0) if name == "GASKET" else steel,
                          draw.uniform(1e-5, 2e-5), 5e-4 if name == "GASKET" else 0.045)
    cards += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", *(f"{name}, 20." for name in meshes)]
    cards += ["*NODE, NSET=BOLT", f"{REFERENCE}, 0., 0.", "*PRE-TENSION SECTION, NODE=BOLT, SURFACE=CUT",
              "*TIE, NAME=JOINED", "SHANK.BOTTOM, NECK", "*SURFACE INTERACTION, NAME=METAL", "*GAP LAW, TYPE=POWER",
              f"0., {log_uniform(draw, 1e-4, 1e-3):.6g}, 0.95"]
    cards += ["*FRICTION", f"{joint.friction:.6g}"] if joint.friction else []
    cards += ["*SURFACE INTERACTION, NAME=SOFT", "*GAP LAW, TYPE=POWER",
              f"0., {log_uniform(draw, 3e-5, 3e-4):.6g}, 0.95",
              "*CONTACT PAIR, INTERACTION=METAL, NAME=SEAT", "FACE, SEAT",
              "*CONTACT PAIR, INTERACTION=SOFT, NAME=GASKET", "GASKET.BOTTOM, LAND"]
    joint.cards = cards
    joint.held = ["*BOUNDARY", "SHANK.LEFT, 1", "HEAD.LEFT, 1", "SHANK.TOP, 2", "GASKET.TOP, 2"]
    force = draw.uniform(40.0, 90.0) * np.pi * shank**2
    joint.step("*STATIC", "*CLOAD", f"BOLT, 1, {force:.9g}")
    joint.step("*STATIC", "*BOUNDARY, FIXED", "BOLT, 1", "*CLOAD, OP=NEW", "*DSLOAD",
               f"WET, P, {draw.uniform(10, 40):.6g}")
    joint.step("*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "*SFILM",
               f"FLANGE.RIGHT, F, {draw.uniform(50, 300):.6g}, 0.001", "HEAD.BOTTOM, F, 20., 0.01",
               "GASKET.TOP, F, 20., 0.01")
    return joint.deck(faces=("SEAT", "GASKET"), has_corners=True)


def drawn(seed):
    """The decks of drawn_decks."""
    return renamed("drawn", seed, drawn_deck(seed))


def mortar(seed):
    """The decks of drawn_decks with mortar points; those of a ring have a punch in its place."""
    is_ring = DRAWN[seed % len(DRAWN)] == "ring"
    return renamed("mortar", seed, mismatched_deck(seed + SHIFT if is_ring else seed))


def renamed(family, seed, deck):
    """Return a deck of drawn_decks."""
    return JudgedDeck(family, f"{family} {seed}", deck.text, (deck.face,), deck.has_path)


FAMILIES = {make.__name__: make for make in (local, peak, triangles, coarse, transients, tables, bolts, rigid, drawn,
                                             mortar)}
