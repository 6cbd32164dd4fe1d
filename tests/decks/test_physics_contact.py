"""Contact in states known in closed form: clearances, corners, cracks, rings, interfaces."""

import numpy as np
import pytest
from physics import follows, judge, material, mesh, nodes_of

import conduction
import lame

XS = [0.0, 0.4, 1.0]
YOUNG = 1000.0
UPPER = mesh("UPPER", XS, [0.0, 0.5])
LOWER = mesh("LOWER", XS, [-1.0, -0.4, 0.0], first=101)
SMOOTH = ["*SURFACE INTERACTION, NAME=SMOOTH"]
FACE = ["*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE", "UPPER.BOTTOM, LOWER.TOP"]


def static(*cards, times="1., 1."):
    """Return a step of mechanics."""
    return ["*STEP", "*STATIC", times, *cards, "*END STEP"]


def stack(clearance, down):
    """Return two blocks, nu = 0, brought together by a displacement, and the gap or pressure."""
    cards = [] if clearance is None else [
        f"*CLEARANCE, MASTER=LOWER.TOP, SLAVE=UPPER.BOTTOM, VALUE={clearance!r}"]
    deck = [*UPPER, *LOWER, *material("UPPER", (YOUNG, 0.0)), *material("LOWER", (YOUNG, 0.0)),
            *SMOOTH, *FACE, *cards,
            *static("*BOUNDARY", f"UPPER.TOP, 2, 2, {-down!r}", "LOWER.BOTTOM, 2", "UPPER.LEFT, 1",
                    "LOWER.LEFT, 1")]
    overlap = down - (clearance or 0.0)
    pressure = max(overlap, 0.0) * YOUNG / 1.5
    return deck, [("gap", "FACE", "LAST", max(-overlap, 0.0), 1e-12, "ABS"),
                  ("pressure", "FACE", "LAST", pressure, 1e-9 * YOUNG * 0.01, "ABS"),
                  ("normal_force", "FACE", "LAST", pressure, 1e-9 * YOUNG * 0.01, "ABS"),
                  ("status", "FACE", "LAST", float(overlap > 0.0), 0.0, "ABS")]


@pytest.mark.parametrize(("one", "other"), [(0.004, 0.005), (0.02, 0.03), (-0.003, -0.002),
                                            (0.0, 0.001), (0.012, 0.008)])
@pytest.mark.changes("CLEARANCE, VALUE")
def test_clearance_takes_the_place_of_the_gap(tmp_path, one, other):
    """Closed, open, overlapping, touching, and one of each; the blocks approach by 0.01."""
    follows(tmp_path, lambda clearance: stack(clearance, 0.01), one, other)


def test_gap_of_the_geometry_holds_without_a_clearance(tmp_path):
    judge(tmp_path, *stack(None, 0.01))


def test_overlap_acts_whole_in_the_first_increment(tmp_path):
    deck, _ = stack(-0.003, 0.0)
    at = deck.index("1., 1.")
    deck[at] = "0.25, 1."
    pressure = 0.003 * YOUNG / 1.5
    judge(tmp_path, deck, [("pressure", "FACE", 0.25, pressure, 1e-9),
                           ("pressure", "FACE", 1.0, pressure, 1e-9)])


HUB, RIM, RADII = (2000.0, 0.3), (700.0, 0.33), (1.0, 2.0, 3.0)


def fitted(plane, kinds=("CAX8", "CAX8")):
    """Return a function of the overlap: two rings about an axis, and Lame's values."""
    inner, face, outer = RADII

    def make(overlap):
        cards = [*mesh("HUB", list(np.linspace(inner, face, 9)), [0.0, 0.2, 0.5], kinds[0]),
                 *mesh("RIM", list(np.linspace(face, outer, 9)), [0.0, 0.2, 0.5], kinds[1], 1001),
                 *material("HUB", HUB), *material("RIM", RIM), *SMOOTH,
                 "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE", "HUB.RIGHT, RIM.LEFT",
                 f"*CLEARANCE, MASTER=RIM.LEFT, SLAVE=HUB.RIGHT, VALUE={-overlap!r}"]
        held = ["HUB.BOTTOM, 2", "RIM.BOTTOM, 2"]
        held += ["HUB.TOP, 2", "RIM.TOP, 2"] if plane == "strain" else []
        pressure = lame.press_fit(inner, face, outer, HUB, RIM, overlap, plane)
        rows = [("pressure", "FACE", "LAST", pressure, 1e-4),
                ("normal_force", "FACE", "LAST", pressure * 2 * np.pi * face * 0.5, 1e-4)]
        for where, r, body, ends, pressures in (
                ("HUB.LEFT", inner, HUB, (inner, face), (0.0, pressure)),
                ("RIM.RIGHT", outer, RIM, (face, outer), (pressure, 0.0))):
            stresses = lame.cylinder(r, *ends, *pressures)
            rows += [("S33", where, "LAST", stresses[1], 5e-3), ("U1", where, "LAST",
                     lame.displacement(r, *stresses, *body, plane), 1e-4)]
        return [*cards, *static("*BOUNDARY", *held)], rows

    return make


@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.changes("CLEARANCE, VALUE")
def test_press_fit_about_an_axis(tmp_path, plane):
    """Ends free: Lame in plane stress; ends held: in plane strain."""
    follows(tmp_path, fitted(plane), 0.01, 0.012)


def polar(angle, radius):
    """Return the place of a point; angles grow clockwise, so that elements are anticlockwise."""
    turned = np.deg2rad(-angle)
    return float(radius * np.cos(turned)), float(radius * np.sin(turned))


def rings(kind, angles, closed):
    """Return a hub and a rim in the plane, and the supports that symmetry allows."""
    inner, face, outer = RADII
    cards = [*mesh("HUB", angles, list(np.linspace(inner, face, 6)), kind, to=polar, closed=closed),
             *mesh("RIM", angles, list(np.linspace(face, outer, 6)), kind, 1001, to=polar,
                   closed=closed)]
    nodes = nodes_of(cards)
    held = [f"{n}, 1" for n, p in nodes.items() if abs(p[0]) < 1e-9]
    return cards, held + [f"{n}, 2" for n, p in nodes.items() if abs(p[1]) < 1e-9]


@pytest.mark.parametrize(("angles", "closed"), [(np.linspace(0.0, 90.0, 9), False),
                                                (np.linspace(0.0, 360.0, 33), True)])
@pytest.mark.parametrize("family", ["CPE8", "CPS8"])
@pytest.mark.changes("CLEARANCE, VALUE")
def test_hub_in_a_rim(tmp_path, family, angles, closed):
    """A quarter, and the whole with a contact surface that is closed; sides are parabolas."""
    cards, held = rings(family, list(angles), closed)
    plane = {"CPE8": "strain", "CPS8": "stress"}[family]

    def make(overlap):
        pressure = lame.press_fit(*RADII, HUB, RIM, overlap, plane)
        length = RADII[1] * np.deg2rad(angles[-1] - angles[0])
        deck = [*cards, *material("HUB", HUB), *material("RIM", RIM), *SMOOTH,
                "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE", "HUB.TOP, RIM.BOTTOM",
                f"*CLEARANCE, MASTER=RIM.BOTTOM, SLAVE=HUB.TOP, VALUE={-overlap!r}",
                *static("*BOUNDARY", *held)]
        return deck, [("pressure", "FACE", "LAST", pressure, 2.5e-3),
                      ("normal_force", "FACE", "LAST", pressure * length, 1e-5),
                      ("status", "FACE", "LAST", 1.0, 0.0, "ABS")]

    follows(tmp_path, make, 0.01, 0.012)


def test_node_in_two_pairs(tmp_path):
    """A block in a corner, pressed from above and from the left: its corner node has two pairs.

    All is frictionless; every block has a uniform stress.
    """
    corner = mesh("CORNER", XS, [0.0, 0.4, 1.0])
    below = mesh("BELOW", XS, [-1.0, 0.0], first=101)
    beside = mesh("BESIDE", [1.0, 1.7], [0.0, 0.4, 1.0], first=201)
    bodies = [*corner, *below, *beside]
    for name in ("CORNER", "BELOW", "BESIDE"):
        bodies += material(name, (YOUNG, 0.3))

    def make(pressures):
        down, aside = pressures
        deck = [*bodies, *SMOOTH, "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=UNDER",
                "CORNER.BOTTOM, BELOW.TOP", "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=SIDE",
                "CORNER.RIGHT, BESIDE.LEFT",
                *static("*BOUNDARY", "BELOW.BOTTOM, 2", "BELOW.LEFT, 1", "BESIDE.RIGHT, 1",
                        "BESIDE.BOTTOM, 2", "*DLOAD", *(f"{e}, P3, {down!r}" for e in (3, 4)),
                        *(f"{e}, P4, {aside!r}" for e in (1, 3)))]
        rows = [("pressure", "UNDER", "LAST", down, 1e-9),
                ("pressure", "SIDE", "LAST", aside, 1e-9)]
        for body, stress in (("CORNER", (-aside, -down)), ("BELOW", (0.0, -down)),
                             ("BESIDE", (-aside, 0.0))):
            rows += [(name, body, "LAST", value, 1e-9, "ABS")
                     for name, value in zip(("S11", "S22"), stress, strict=True)]
        return deck, rows

    follows(tmp_path, make, (5.0, 3.0), (5.0, 4.0))


def cracked(pressure, friction, aside=0.0):
    """Return a plate cut from its left side to its middle, pressed on top, and its stress."""
    xs, down, up = [0.0, 0.5, 1.0, 2.0], [-1.0, -0.4, 0.0], [0.0, 0.4, 1.0]
    lower = mesh("LOWER", xs, down)
    upper = mesh("UPPER", xs, up, first=101)
    double = {n: m for m, p in nodes_of(lower).items() for n, q in nodes_of(upper).items()
              if p == q and p[0] >= 1.0}   # the tip and beyond: one body
    cards, inside = [], ""
    for card in [*lower, *upper]:
        if card.startswith("*"):
            inside = card.split(",")[0]
            if card in ("*SURFACE, NAME=LOWER.TOP", "*SURFACE, NAME=UPPER.BOTTOM"):
                inside = "inner faces"
        if inside == "inner faces" or card.startswith("*"):
            cards += [card] * (inside != "inner faces")
            continue
        if inside == "*NODE" and int(card.split(",")[0]) in double:
            continue
        if inside == "*ELEMENT":
            element, *around = map(int, card.split(","))
            card = ", ".join(map(str, [element, *(double.get(n, n) for n in around)]))
        elif inside == "*NSET":
            card = str(double.get(int(card), int(card)))
        cards.append(card)
    deck = [*cards, *material("LOWER", (YOUNG, 0.3)), *material("UPPER", (YOUNG, 0.3)),
            "*SURFACE, NAME=CRACK.UP", "101, S1", "102, S1", "*SURFACE, NAME=CRACK.LOW", "4, S3",
            "5, S3", *SMOOTH, *(["*FRICTION", f"{friction!r}"] if friction else []),
            "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=CRACK", "CRACK.UP, CRACK.LOW",
            *static("*BOUNDARY", "LOWER.BOTTOM, 2", "1, 1", "*DLOAD",
                    *(f"{e}, P3, {pressure!r}" for e in (104, 105, 106)),
                    *(f"{e}, P4, {aside!r}" for e in (1, 4, 101, 104)),
                    *(f"{e}, P2, {aside!r}" for e in (3, 6, 103, 106)))]
    rows = [(name, body, "LAST", value, 1e-9 * pressure, "ABS") for body in ("LOWER", "UPPER")
            for name, value in (("S11", -aside), ("S22", -pressure), ("S12", 0.0))]
    return deck, [*rows, ("pressure", "CRACK", "LAST", pressure, 1e-9),
                  ("gap", "CRACK", "LAST", 0.0, 0.0, "ABS"),
                  ("status", "CRACK", "LAST", 2.0 if friction else 1.0, 0.0, "ABS")]


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_a_closed_crack_does_not_disturb_the_stress(tmp_path, friction):
    """One body with a crack; its tip is one node. Uniform stress as if there were no crack."""
    follows(tmp_path, lambda p: cracked(*p), (6.0, friction, 2.0), (5.0, friction, 2.0))


CONDUCTING = {"UPPER": 3.0, "MIDDLE": 0.5, "LOWER": 2.0}


def layered(conductances):
    """Return a stack of three blocks with two interfaces, hot at the top, and its heat."""
    omega, other = conductances
    bodies = [*mesh("UPPER", XS, [0.5, 1.0]), *mesh("MIDDLE", XS, [0.0, 0.5], first=101),
              *mesh("LOWER", XS, [-1.0, 0.0], first=201)]
    for name, k in CONDUCTING.items():
        bodies += material(name, (YOUNG, 0.3), conductivity=k)
    hot, cold = 90.0, 20.0
    flux, faces = conduction.wall([0.5, 0.5, 1.0], list(CONDUCTING.values()), hot, cold,
                                  contacts=[omega, other])
    deck = [*bodies, "*SURFACE INTERACTION, NAME=FIRST", "*GAP LAW, TYPE=POWER",
            f"{omega!r}, 0., 1.", "*SURFACE INTERACTION, NAME=SECOND", "*GAP LAW, TYPE=POWER",
            f"{other!r}, 0., 1.", "*CONTACT PAIR, INTERACTION=FIRST, NAME=ONE",
            "UPPER.BOTTOM, MIDDLE.TOP", "*CONTACT PAIR, INTERACTION=SECOND, NAME=TWO",
            "MIDDLE.BOTTOM, LOWER.TOP", "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "UPPER, 20.",
            "MIDDLE, 20.", "LOWER, 20.",
            "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.",
            "*BOUNDARY", "LOWER.BOTTOM, 2", *(f"{n}.LEFT, 1" for n in CONDUCTING),
            f"UPPER.TOP, 11, 11, {hot}", f"LOWER.BOTTOM, 11, 11, {cold}", "*DLOAD", "1, P3, 5.",
            "2, P3, 5.", "*END STEP"]
    return deck, [("heat_rate", "ONE", "LAST", flux, 1e-10), ("heat_rate", "TWO", "LAST", flux,
                  1e-10), ("slave_temperature", "ONE", "LAST", faces[1], 1e-10),
                  ("master_temperature", "ONE", "LAST", faces[2], 1e-10),
                  ("slave_temperature", "TWO", "LAST", faces[3], 1e-10),
                  ("master_temperature", "TWO", "LAST", faces[4], 1e-10),
                  ("pressure", "ONE", "LAST", 5.0, 1e-9), ("pressure", "TWO", "LAST", 5.0, 1e-9),
                  ("heat_imbalance", "", "LAST", 0.0, 1e-10, "ABS")]


@pytest.mark.parametrize("other", [(0.8, 0.2), (0.7, 0.3)])
@pytest.mark.changes("GAP LAW")
def test_two_interfaces_have_conductances_of_their_own(tmp_path, other):
    follows(tmp_path, layered, (0.7, 0.2), other)


HEIGHTS, MODULI = {"UPPER": 0.5, "MIDDLE": 0.3, "LOWER": 0.2}, (1000.0, 700.0, 1500.0)
PRESSED, BACK_AND_FORTH = 6.0, (0.004, 0.003)


def sheared(values):
    """Return a stack of three blocks, pressed, hot at the top and pushed aside and back, and its
    uniform states.

    With nu = 0, expansion along y only and the complementary shear on the sides every block is in
    uniform shear t. The top moves by t sum(h/G) until t is mu p on the weaker interface, then that
    one slips by all the rest. On the way back t goes from mu p to -mu p first.
    """
    frictions, laws = values
    bodies, base = [], 0.0
    for k, (name, height) in reversed(list(enumerate(HEIGHTS.items()))):
        bodies += mesh(name, XS, [base, base + 0.4 * height, base + height], first=1 + 100 * k)
        bodies += material(name, (MODULI[k], 0.0), (0.0, 1e-4, 0.0), CONDUCTING[name],
                           expansion_type="ORTHO")
        base += height
    compliances = [2 * h / e for h, e in zip(HEIGHTS.values(), MODULI, strict=True)]
    tops = {name: sum(compliances[k:]) for k, name in enumerate(HEIGHTS)}
    shear = min(frictions) * PRESSED
    weak = frictions.index(min(frictions))
    onward, backward = BACK_AND_FORTH
    hot, cold = 90.0, 20.0
    omegas = [c0 + c1 * PRESSED for c0, c1 in laws]
    flux, faces = conduction.wall(list(HEIGHTS.values()), list(CONDUCTING.values()), hot, cold,
                                  contacts=omegas)
    deck = bodies
    for k, name in enumerate(("FIRST", "SECOND")):
        deck += [f"*SURFACE INTERACTION, NAME={name}", "*FRICTION", f"{frictions[k]!r}",
                 "*GAP LAW, TYPE=POWER", f"{laws[k][0]!r}, {laws[k][1]!r}, 1."]
    deck += ["*CONTACT PAIR, INTERACTION=FIRST, NAME=ONE", "UPPER.BOTTOM, MIDDLE.TOP",
             "*CONTACT PAIR, INTERACTION=SECOND, NAME=TWO", "MIDDLE.BOTTOM, LOWER.TOP",
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", *(f"{name}, 0." for name in HEIGHTS)]
    deck += ["*FIXED POINT, TOL=1.E-11"]
    rows = []
    turn = tops["UPPER"] * shear
    # Time, place of the top, shear, slip of the weaker interface.
    path = [(1, 0.0, 0.0, 0.0), (2, turn / 2, shear / 2, 0.0), (3, turn, shear, 0.0),
            (4, turn + onward, shear, onward), (5, onward - turn, -shear, onward),
            (6, onward - turn - backward, -shear, onward - backward)]
    for time, top, t, slip in path:
        deck += ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.", "*BOUNDARY",
                 f"UPPER.TOP, 1, 1, {top!r}"]
        if time == 1:
            deck += ["LOWER.BOTTOM, 1, 2", f"UPPER.TOP, 11, 11, {hot}",
                     f"LOWER.BOTTOM, 11, 11, {cold}", "*DLOAD",
                     *(f"{e}, P3, {PRESSED!r}" for e in (3, 4))]
        deck += ["*DSLOAD", *(f"{name}.{side}, TRVEC, {t!r}, 0., {sign}, 0." for name in HEIGHTS
                              for side, sign in (("RIGHT", 1.0), ("LEFT", -1.0))), "*END STEP"]
        if time in (3, 5):
            continue   # at the limit itself either state may hold
        slips = [slip if k == weak else 0.0 for k in (0, 1)]
        for k, name in enumerate(("ONE", "TWO")):
            slides = k == weak and abs(t) == shear
            rows += [("shear", name, time, -t, 1e-8 * shear, "ABS"),
                     ("pressure", name, time, PRESSED, 1e-9),
                     ("slip", name, time, slips[k], 1e-8 * onward, "ABS"),
                     ("status", name, time, 1.0 if slides else 2.0, 0.0, "ABS"),
                     ("shear_force", name, time, -t, 1e-8 * shear, "ABS"),
                     ("conductance", name, time, omegas[k], 1e-9),
                     ("heat_flux", name, time, flux, 1e-9),
                     ("slave_temperature", name, time, faces[2 * k + 1], 1e-9),
                     ("master_temperature", name, time, faces[2 * k + 2], 1e-9)]
        for k, name in enumerate(HEIGHTS):
            moved = tops[name] * t + sum(slips[k:])
            rows += [("S12", name, time, t, 1e-8 * shear, "ABS"),
                     ("S22", name, time, -PRESSED, 1e-9),
                     ("U1", f"{name}.TOP", time, moved, 1e-8 * onward, "ABS")]
    return deck, rows


LAWS = (0.7, 0.1), (0.2, 0.05)


@pytest.mark.changes("FRICTION")
@pytest.mark.parametrize(("one", "other"), [((0.1, 0.3), (0.3, 0.1)), ((0.25, 0.2), (0.25, 0.15))])
def test_two_interfaces_have_frictions_of_their_own(tmp_path, one, other):
    """Stick, slip, stick on the way back, slip back."""
    follows(tmp_path, sheared, (one, LAWS), (other, LAWS))


@pytest.mark.parametrize(("one", "other"), [
    (((0.1, 0.3), LAWS), ((0.1, 0.3), LAWS[::-1])),
    (((0.1, 0.3), LAWS), ((0.1, 0.3), ((0.7, 0.1), (0.2, 0.06))))])
def test_two_interfaces_have_laws_of_the_pressure_of_their_own(tmp_path, one, other):
    follows(tmp_path, sheared, one, other)
