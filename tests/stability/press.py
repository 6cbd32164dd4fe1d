"""A press of two blocks with everything in it, in any units, place, numbering and order of faces."""

import random
from dataclasses import dataclass, field

import numpy as np
from physics import mesh, nodes_of

ENDS = 0.0, 0.02, 0.05, 0.07, 0.085, 0.1  # corners along the faces [m]
SHIFT = 1.2e-5  # gap along y before anything is warm [m]
TIMES = 4  # increments


@dataclass
class Look:
    """How the press is written down: units, motion of the plane, numbers, order of the faces."""

    length: float = 1.0  # of a metre
    stress: float = 1.0  # of a pascal
    power: float = 1.0  # of a watt
    mass: float = 1.0  # of a kilogramme
    turn: np.ndarray = field(default_factory=lambda: np.eye(2))
    seed: int = 0  # of the numbers; 0 leaves them
    swapped: bool = False
    solver: str = "SKYLINE"


def bowed(x, y):
    """Return where a point of the blocks lies: faces are inclined and bent."""
    return x, y + 0.1 * x + 0.4 * x**2


def plain_mesh():
    """Return the cards of both blocks as they are."""
    ys = [0.0, 0.01, 0.03]
    return mesh("A", ENDS, [y - 0.03 for y in ys], skew=1e-3, to=bowed) + mesh(
        "B", ENDS, [y + SHIFT for y in ys], skew=-1e-3, first=1001, to=bowed)


def numbers(cards, seed):
    """Return the new numbers of all nodes and elements by the old ones."""
    maps = []
    for keyword in ("*NODE,", "*ELEMENT,"):
        old, inside = [], False
        for card in cards:
            if card.startswith("*"):
                inside = card.startswith(keyword)
            elif inside:
                old.append(int(card.split(",")[0]))
        new = list(old)
        if seed:
            random.Random(seed).shuffle(new)
        maps.append(dict(zip(old, new, strict=True)))
    return maps


def written(look):
    """Return the cards of the meshes as they look; mirrored elements are turned over."""
    cards = plain_mesh()
    nodes, elements = numbers(cards, look.seed)
    flips = np.linalg.det(look.turn) < 0.0
    lines, body, kind = [], [], ""

    def close():
        if look.seed and kind in ("*NODE", "*ELEMENT", "*NSET"):
            random.Random(look.seed + len(lines)).shuffle(body)
        lines.extend(body)
        body.clear()

    for card in cards:
        if card.startswith("*"):
            close()
            kind = card.split(",")[0]
            lines.append(card)
            continue
        fields = [f.strip() for f in card.split(",")]
        if kind == "*NODE":
            x, y = look.length * look.turn @ [float(fields[1]), float(fields[2])]
            body.append(f"{nodes[int(fields[0])]}, {x:.17g}, {y:.17g}")
        elif kind == "*ELEMENT":
            own = [nodes[int(f)] for f in fields[1:]]
            if flips:  # the corners 4, 3, 2, 1: the sides S1, S2, S3, S4 are S3, S2, S1, S4 then
                own = own[3::-1] + [own[6], own[5], own[4], own[7]]
            body.append(", ".join(map(str, [elements[int(fields[0])], *own])))
        elif kind == "*SURFACE":
            face = {"S1": "S3", "S3": "S1"}.get(fields[1], fields[1]) if flips else fields[1]
            body.append(f"{elements[int(fields[0])]}, {face}")
        else:
            body.append(str(nodes[int(fields[0])]))
    close()
    return lines, nodes


def cards(look):
    """Return the deck."""
    l, s, w = look.length, look.stress, look.power
    lines, _ = written(look)

    def along(x, y, size=1.0):
        return [repr(float(v)) for v in size * look.turn @ [x, y]]

    faces = "A.TOP, B.BOTTOM" if look.swapped else "B.BOTTOM, A.TOP"
    pushed = along(4e-6 * l, -1.5e-5 * l)
    gravity, pull, body = along(0.3, -1.0), along(0.8, 0.1), along(3e5, -2e5, s / l)
    point = along(400.0, -300.0, s * l * l)
    density = 7800.0 * look.mass / l**3
    for name, young, alpha, k in (("A", 2.1e11, 1.1e-5, 45.0), ("B", 7e10, 2.3e-5, 160.0)):
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{young * s!r}, 0.3", "*EXPANSION", f"{alpha!r}",
                  "*CONDUCTIVITY", f"{k * w / l!r}", "*DENSITY", f"{density!r}",
                  f"*SOLID SECTION, ELSET={name}, MATERIAL={name}", f"{0.02 * l!r}"]
    top = 1 if np.linalg.det(look.turn) < 0.0 else 3
    _, elements = numbers(plain_mesh(), look.seed)
    above = [elements[1001 + k] for k in range(5, 10)]
    lines += ["*ELSET, ELSET=ABOVE", *map(str, above), f"*ELSET, ELSET=END\n{elements[1010]}"]
    lines += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "A, 20.", "B, 20.",
              "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.6",
              "*GAP LAW, TYPE=GAS", f"{0.03 * w / l!r}, {3e-6 * l!r}",
              "*GAP LAW, TYPE=POWER", f"{1e4 * w / l**2!r}, {2e-3 * w / l**2 / s**0.95!r}, 0.95",
              "*CONTACT PAIR, INTERACTION=I, NAME=F", faces,
              "*FIXED POINT, TOL=1E-12", f"*SOLVER, TYPE={look.solver}",
              f"*STEP, INC={TIMES}", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT",
              f"{1 / TIMES!r}, 1.", "*BOUNDARY", "A.BOTTOM, 1, 2", "A.BOTTOM, 11, 11, 20.",
              f"B.LEFT, 1, 1, {pushed[0]}", f"B.LEFT, 2, 2, {pushed[1]}",
              "*FILM", f"ABOVE, F{top}, 140., {3000.0 * w / l**2!r}",
              "*DFLUX", f"END, BF, {2e6 * w / l**3!r}",
              "*CFLUX", f"B.RIGHT, 11, {0.4 * w!r}",
              "*DLOAD", f"B, BX, {body[0]}", f"B, BY, {body[1]}",
              f"A, GRAV, {9.81 * s * l * l / look.mass!r}, {gravity[0]}, {gravity[1]}, 0.",
              "*DSLOAD", f"B.RIGHT, P, {2e6 * s!r}", f"B.TOP, TRVEC, {3e6 * s!r}, {pull[0]}, {pull[1]}, 0.",
              "*CLOAD", f"B.RIGHT, 1, {point[0]}", f"B.RIGHT, 2, {point[1]}", "*CONTACT PRINT", "*END STEP"]
    return [line for text in lines for line in text.split("\n")]


def places(look):
    """Return the places of the nodes by their old numbers, as they look."""
    return {n: look.length * look.turn @ p for n, p in nodes_of(plain_mesh()).items()}
