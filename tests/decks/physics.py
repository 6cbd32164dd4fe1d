"""Small decks whose answer is known, for the tests of the physics."""

import sys
from itertools import pairwise

import numpy as np
from blocks import write
from changes import note_changes
from deck_runs import DECKS, no_uncertainties, run

sys.path.insert(0, str(DECKS.parent / "reference"))
import plates  # noqa: E402

SIDES = "BOTTOM", "RIGHT", "TOP", "LEFT"


def corners_of(kind):
    """Return the number of corners of an element of a kind."""
    return 3 if kind.rstrip("R")[-1] in "36" else 4


def mesh(name, xs, ys, kind="CPE8", first=1, skew=0.0, to=None, closed=False):
    """Return the cards of a rectangle of elements of any kind, corner nodes at xs and ys.

    Inner corners are moved by skew. Triangles are halves of the rectangles. `to` moves every node,
    also those between corners, from (x, y) to its place; `closed` joins the last x to the first.
    Node set and element set have the block's name; node sets and surfaces of its sides end in
    .BOTTOM, .RIGHT, .TOP and .LEFT.
    """
    quadratic, triangles = kind.rstrip("R")[-1] in "68", corners_of(kind) == 3
    columns, rows = len(xs) - 1, len(ys) - 1
    numbers, places, elements = {}, {}, []
    faces = {side: [] for side in SIDES}

    def place(i, j):
        inner = 0 < i < 2 * columns and 0 < j < 2 * rows and i % 2 == 0 and j % 2 == 0
        if i % 2 or j % 2:
            ends = [(i - i % 2, j - j % 2), (i + i % 2, j + j % 2)]
            return tuple(sum(place(*end)[k] for end in ends) / 2 for k in (0, 1))
        x, y = xs[i // 2], ys[j // 2]
        return (x + skew, y - skew / 2) if inner and skew else (x, y)

    def node(i, j):
        key = (i % (2 * columns), j) if closed else (i, j)
        if key not in numbers:
            numbers[key] = first + len(numbers)
            places[numbers[key]] = to(*place(*key)) if to else place(*key)
        return numbers[key]

    for j in range(0, 2 * rows, 2):
        for i in range(0, 2 * columns, 2):
            square = [(i, j), (i + 2, j), (i + 2, j + 2), (i, j + 2)]
            parts = [[0, 1, 2], [0, 2, 3]] if triangles else [[0, 1, 2, 3]]
            owner = {"BOTTOM": (0, 1), "RIGHT": (0, 2), "TOP": (-1, 2), "LEFT": (-1, 3)} \
                if triangles else {side: (0, k + 1) for k, side in enumerate(SIDES)}
            start = first + len(elements)
            for part in parts:
                corners = [square[k] for k in part]
                middles = [((p[0] + q[0]) // 2, (p[1] + q[1]) // 2)
                           for p, q in pairwise([*corners, corners[0]])]
                elements.append([node(*p) for p in corners + (middles if quadratic else [])])
            on_side = {"BOTTOM": j == 0, "RIGHT": i == 2 * (columns - 1),
                       "TOP": j == 2 * (rows - 1), "LEFT": i == 0}
            for side in SIDES:
                if on_side[side]:
                    part, face = owner[side]
                    faces[side].append((start + part % len(parts), face))
    edge = {"BOTTOM": (1, 0), "RIGHT": (0, 2 * columns), "TOP": (1, 2 * rows), "LEFT": (0, 0)}
    cards = [f"*NODE, NSET={name}"]
    cards += [f"{n}, {x:.15g}, {y:.15g}" for n, (x, y) in places.items()]
    cards += [f"*ELEMENT, TYPE={kind}, ELSET={name}"]
    cards += [", ".join(map(str, [first + k, *e])) for k, e in enumerate(elements)]
    for side in SIDES:
        if closed and side in ("LEFT", "RIGHT"):
            continue
        axis, value = edge[side]
        cards += [f"*NSET, NSET={name}.{side}"]
        cards += [str(n) for key, n in numbers.items() if key[axis] == value]
        cards += [f"*SURFACE, NAME={name}.{side}"]
        cards += [f"{element}, S{face}" for element, face in faces[side]]
    return cards


def nodes_of(cards):
    """Return the places of the nodes of some cards by their numbers."""
    found, inside = {}, False
    for card in cards:
        if card.startswith("*"):
            inside = card.upper().startswith("*NODE,")
        elif inside:
            fields = card.split(",")
            found[int(fields[0])] = float(fields[1]), float(fields[2])
    return found


def outer_nodes(cards, tolerance=1e-12):
    """Return the places of the nodes on the sides of a rectangle by their numbers."""
    nodes = nodes_of(cards)
    ends = [(min(p[k] for p in nodes.values()), max(p[k] for p in nodes.values())) for k in (0, 1)]
    return {n: p for n, p in nodes.items()
            if any(abs(p[k] - end) < tolerance for k in (0, 1) for end in ends[k])}


def side_shares(cards, axis, value):
    """Return the shares of the nodes of three-node sides on a straight side in a uniform load."""
    side = sorted((p[1 - axis], n) for n, p in nodes_of(cards).items() if p[axis] == value)
    shares = {n: 0.0 for _, n in side}
    for low, middle, high in zip(side[:-2:2], side[1::2], side[2::2], strict=True):
        for (_, n), share in ((low, 1), (middle, 4), (high, 1)):
            shares[n] += share * (high[0] - low[0]) / 6
    return shares


def material(name, elastic=(1000.0, 0.3), expansion=None, conductivity=None, density=None,
             specific_heat=None, elastic_type=None, expansion_type=None, conductivity_type=None,
             section="", zero=None):
    """Return the cards of a material and its section. A property is a number, its constants, or a
    list of rows of constants and a temperature; data beyond eight fields continue."""
    cards = [f"*MATERIAL, NAME={name}"]
    ending = "" if zero is None else f", ZERO={zero!r}"
    for keyword, kind, data in (("*ELASTIC", elastic_type, elastic),
                                ("*EXPANSION" + ending, expansion_type, expansion),
                                ("*CONDUCTIVITY", conductivity_type, conductivity),
                                ("*DENSITY", None, density),
                                ("*SPECIFIC HEAT", None, specific_heat)):
        if data is None:
            continue
        values = [data] if isinstance(data, float) else list(data)
        rows = values if isinstance(values[0], tuple) else [values]
        cards += [keyword + (f", TYPE={kind}" if kind else "")]
        cards += [", ".join(f"{float(v)!r}" for v in row[k : k + 8])
                  for row in rows for k in range(0, len(row), 8)]
    return [*cards, f"*SOLID SECTION, ELSET={name}, MATERIAL={name}{section}"]


def verify(*rows):
    """Return the cards of checks (quantity, where, when, value, tolerance[, ABS])."""
    cards = ['*VERIFY, KIND=ANALYTIC, SOURCE="tests/reference"']
    for quantity, where, when, value, tolerance, *how in rows:
        ending = f", {how[0]}" if how else ""
        cards += [f"{quantity}, {where}, {when}, {float(value)!r}, {tolerance!r}{ending}"]
    return cards


def judge(folder, cards, checks, status=0, name="deck"):
    """Run a deck with checks, which pass (status 0) or fail (4); return the result's path."""
    deck = write(folder / f"{name}.inp", ["*OPTIONS, WIDTH=300"], cards, verify(*checks))
    process = run("run", "--quiet", deck, "--out", folder, *no_uncertainties(deck))
    assert process.returncode == status, process.stderr + listed(deck)
    return deck.with_suffix(".vtkhdf")


def judge_linear_fields(folder, options, cards, kind):
    """Give linear displacements and temperatures at the outer nodes of the one body BODY; check
    that stress and heat flux are the constant ones everywhere."""
    young, poisson, conductivity = 1000.0, 0.3, 2.0
    plane = "strain" if kind.startswith("CPE") else "stress"
    strain = np.array([1e-3, -4e-4, 7e-4])
    values = ["*BOUNDARY"]
    for node, (x, y) in outer_nodes(cards).items():
        (u, v), = plates.displacements([(x, y)], strain)
        values += [f"{node}, 1, 1, {float(u)!r}", f"{node}, 2, 2, {float(v)!r}",
                   f"{node}, 11, 11, {50.0 + 20.0 * x - 30.0 * y!r}"]
    stress = plates.stress(plates.isotropic(young, poisson), strain, plane)
    deck = [*options, *cards, *material("BODY", (young, poisson), conductivity=conductivity),
            "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", *values,
            "*END STEP"]
    checks = [(f"S{name}", "BODY", "LAST", value, 1e-10, "ABS")
              for name, value in zip(("11", "22", "33", "12"), stress, strict=True)]
    judge(folder, deck, [*checks, ("HFL1", "BODY", "LAST", -40.0, 1e-10),
                         ("HFL2", "BODY", "LAST", 60.0, 1e-10)])


def listed(deck):
    """Return the checks that failed, as the listing of a deck prints them."""
    listing = deck.with_suffix(".lst")
    if not listing.exists():
        return ""
    return "\n".join(row for row in listing.read_text().splitlines() if "FAIL" in row)


def follows(folder, make, one, other):
    """Assert that a deck's answer follows a value of its cards: make(value) returns cards and
    checks. Each of two decks passes its own checks, and fails those of the other: by their values, or
    else in a run."""
    (cards, checks), (other_cards, other_checks) = make(one), make(other)
    note_changes(cards, other_cards)
    judge(folder, cards, checks, name="one")
    judge(folder, other_cards, other_checks, name="other")
    if not any(are_apart(check, beside) for check in checks for beside in other_checks):
        judge(folder, cards, other_checks, status=4, name="crossed")
        judge(folder, other_cards, checks, status=4, name="crossed-back")


def are_apart(check, other):
    """Return whether two checks are of one quantity, and no value passes both."""
    values = [float(row[3]) for row in (check, other)]
    widths = [row[4] * (1.0 if "ABS" in row else abs(value))
              for row, value in zip((check, other), values, strict=True)]
    return check[:3] == other[:3] and abs(values[1] - values[0]) > sum(widths)
