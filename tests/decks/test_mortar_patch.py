"""Faces whose nodes do not match: uniform states that PAIRING=SURFACES must reproduce exactly."""

import math
from itertools import pairwise

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from deck_runs import run, solve
from physics import material, mesh, nodes_of

PRESSURE, HOT, EXACT = 7.0, 100.0, 1e-9
RADIUS = 5.0   # inner radius of the blocks about an axis
CONDUCTIVITY, CLOSED = 2.0, "10., 1., 0.5"
UPPER, LOWER = [0.0, 0.6, 1.0], [-1.0, -0.4, 0.0]
KINDS = ["CPE8", "CPE8R", "CPS8", "CPE4", "CPE6", "CPE3", "CAX8", "CAX8R", "CAX4", "CAX6", "CAX3",
         "CPE4I", "CPS4I", "CAX4I"]


def even(low, high, count):
    """Return the ends of sides of equal length."""
    return [low + (high - low) * k / count for k in range(count + 1)]


def turned(angle, kind="CPE8"):
    """Return a rotation, of axisymmetric models a shift away from the axis."""
    cosine, sine = math.cos(angle), math.sin(angle)
    away = RADIUS if kind.startswith("CAX") else 0.0
    return lambda x, y: (away + cosine * x - sine * y, sine * x + cosine * y)


def joint(kind, upper, lower, angle=0.0, slave="UP", poisson=0.25, friction=None, first=1, names="",
          shift=0.0):
    """Return two blocks that touch, with the ends of their sides, and their interface C."""
    move = turned(angle, kind)
    to = (lambda x, y: move(x + shift, y))
    up, low, pair = f"UP{names}", f"LOW{names}", f"C{names}"
    cards = [*mesh(up, upper, UPPER, kind, first, to=to),
             *mesh(low, lower, LOWER, kind, first + 5000, to=to)]
    for body in (up, low):
        cards += material(body, (1000.0, poisson), 0.0, CONDUCTIVITY)
    surfaces = [f"{up}.BOTTOM", f"{low}.TOP"]
    if slave == "LOW":
        surfaces.reverse()
    cards += [f"*SURFACE INTERACTION, NAME={pair}",
              *(["*FRICTION", str(friction)] if friction else []),
              "*GAP LAW, TYPE=POWER", CLOSED, "*GAP LAW, TYPE=GAS", "1.E-3, 1.E-4",
              f"*CONTACT PAIR, INTERACTION={pair}, NAME={pair}, PAIRING=SURFACES",
              ", ".join(surfaces)]
    return cards


def press(cards, *boundary, loads, path, status=0):
    """Solve a step with heat under these supports and loads; return the result's path."""
    deck = write(path, ["*OPTIONS, WIDTH=200"], without_unused_surfaces(
        [*cards, "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.",
         "*BOUNDARY", *boundary, "*DSLOAD", *loads, "*END STEP"]))
    return solve(deck, status=status)


def deck_of(path, cards, supports, *loads, increment="1., 1."):
    """Write a static step of one or several increments."""
    return write(path, ["*OPTIONS, WIDTH=200"], without_unused_surfaces(
        [*cards, "*STEP", "*STATIC, DIRECT", increment, "*BOUNDARY", *supports, *loads,
         "*END STEP"]))


def contact(result, name="C"):
    """Return all datasets of an interface at the last increment."""
    with h5py.File(result) as file:
        return {key: data[-1] if data.ndim > 1 else data[()]
                for key, data in file[f"contact/{name}"].items() if data.shape[0] > 0}


def assert_uniform(found, pressure=PRESSURE):
    np.testing.assert_allclose(found["pressure"], pressure, rtol=EXACT)
    np.testing.assert_allclose(found["heat_flux"], found["heat_flux"][0], rtol=EXACT)


def corner(cards, body, to, x, y):
    """Return the number of the node of a body at a place."""
    place = to(x, y)
    nodes = nodes_of(cards)
    numbers = range(5001, 10000) if body == "LOW" else range(1, 5001)
    return min((n for n in numbers if n in nodes), key=lambda n: math.dist(nodes[n], place))


@pytest.mark.parametrize(("kind", "slave"), [*((kind, "UP") for kind in KINDS), ("CPE8", "LOW"),
                                             ("CAX4", "LOW")])
def test_uniform_pressure_and_heat_cross_faces_that_do_not_match(tmp_path, kind, slave):
    """Straight and inclined; 3 sides against 4 and 7, 10 against 1 and the reverse. Heat goes
    through both blocks and the interface in a row."""
    conductance = 10.0 + PRESSURE**0.5
    for one, other, angle in ((3, 4, 0.0), (7, 3, 0.0), (10, 1, 0.0), (1, 10, 0.0), (3, 7, 0.4)):
        if angle and kind.startswith("CAX"):
            continue
        cards = joint(kind, even(0.0, 2.0, one), even(0.0, 2.0, other), angle, slave)
        to = turned(angle, kind)
        low = [corner(cards, "LOW", to, x, -1.0) for x in (0.0, 2.0)]
        supports = [f"{low[0]}, 2"] if kind.startswith("CAX") else \
            [f"{low[0]}, 1, 2", f"{low[1]}, 2", f"{corner(cards, 'UP', to, 0.0, 1.0)}, 1"]
        found = contact(press(cards, *supports, f"UP.TOP, 11, 11, {HOT}", "LOW.BOTTOM, 11, 11, 0.",
                              loads=[f"{side}, P, {PRESSURE}" for side in ("UP.TOP", "LOW.BOTTOM")],
                              path=tmp_path / "patch.inp"))
        assert len(found["pressure"]) == (one if slave == "UP" else other) + 1
        assert_uniform(found)
        sign = 1.0 if slave == "UP" else -1.0
        flux = HOT / (2.0 / CONDUCTIVITY + 1.0 / conductance)
        np.testing.assert_allclose(found["heat_flux"], sign * flux, rtol=EXACT)


# Overhang in sides of the slave: none, slivers, any part of a side, whole sides.
OVERHANGS = [0.0, 1e-13, 1e-9, 1e-6, 1e-3, 0.03, 0.1, 0.12, 0.5, 0.9, 0.97, 1.0 - 1e-9, 1.0,
             1.0 + 1e-12, 1.0 + 1e-6, 1.3, 2.0]


def overhanging(overhang, who, side):
    """Return ends of sides of slave and master: one of them, of five sides, has the other one's
    length, 2, and this overhang at one end or both."""
    per_end = overhang * 2.0 / (5 - overhang * (2 if side == "both" else 1))
    long = even(-per_end, 2.0 + (per_end if side == "both" else 0.0), 5)
    short = even(0.0, 2.0, 6)
    return (long, short) if who == "slave" else (short, long)


@pytest.mark.parametrize("who", ["slave", "master"])
@pytest.mark.parametrize(("kind", "side"), [("CPE8", "both"), ("CAX4", "left")])
def test_uniform_pressure_on_the_covered_part_whatever_the_overhang(tmp_path, kind, who, side):
    """The face that hangs over is held and isothermal. The other block, nu = 0, is a column."""
    for overhang in OVERHANGS:
        upper, lower = overhanging(overhang, who, side)
        held, free, outer = ("UP", "LOW", "LOW.BOTTOM")
        if who == "master":
            held, free, outer = ("LOW", "UP", "UP.TOP")
        found = contact(press(joint(kind, upper, lower, poisson=0.0), f"{held}, 1, 2", f"{free}, 1",
                              f"{held}, 11, 11, {HOT}", f"{outer}, 11, 11, 0.",
                              loads=[f"{outer}, P, {PRESSURE}"], path=tmp_path / "held.inp"))
        assert_uniform(found)
        area = 2.0 if kind.startswith("CP") else math.pi * ((RADIUS + 2.0)**2 - RADIUS**2)
        assert found["weight"].sum() == pytest.approx(area, rel=EXACT)
        assert found["weight"].min() > 0.0
        # The first point lies on the end of what is covered, and none on a sliver.
        assert np.diff(found["s"]).min() > 0.1 * 2.0 / 7


@pytest.mark.parametrize(("kind", "friction"), [("CPE8", 0.3), ("CPE4", None)])
def test_forces_balance_whatever_the_overhang(tmp_path, kind, friction):
    """Of elastic bodies the pressure is not uniform; its resultant is the load."""
    for who in ("slave", "master"):
        ends = []
        for overhang in OVERHANGS[:-1]:
            upper, lower = overhanging(overhang, who, "both")
            cards = joint(kind, upper, lower, friction=friction)
            to = turned(0.0)
            result = press(cards, "LOW.BOTTOM, 1, 2", "LOW.BOTTOM, 11, 11, 0.",
                           f"UP.TOP, 11, 11, {HOT}",
                           f"{corner(cards, 'UP', to, (upper[0] + upper[-1]) / 2, 1.0)}, 1",
                           loads=[f"UP.TOP, P, {14.0 / (upper[-1] - upper[0])!r}"],
                           path=tmp_path / "free.inp")
            found = contact(result)
            with h5py.File(result) as file:
                assert file["history/force_imbalance"][-1] < 1e-10
                assert file["history/heat_imbalance"][-1] < 1e-9
                assert file["contact/C/normal_force"][-1] == pytest.approx(14.0, rel=EXACT)
            assert found["weight"] @ found["pressure"] == pytest.approx(14.0, rel=EXACT)
            ends.append(found["pressure"].max())
        # Slivers change nothing: pressure follows the overhang without jumps.
        np.testing.assert_allclose(ends[1:4], ends[0], rtol=1e-5)
        np.testing.assert_allclose(ends[11:15], ends[11], rtol=1e-3)


def test_narrow_punch_on_a_wide_block_leaves_points_without_a_master_open(tmp_path):
    """The wide block is the slave: points beyond the punch are none, or open."""
    for width, sides in ((0.3, 1), (0.55, 3), (1.1, 4)):
        cards = joint("CPE8", even(0.85, 0.85 + width, sides), even(0.0, 2.0, 8), slave="LOW")
        result = press(cards, "LOW.BOTTOM, 1, 2", "LOW.BOTTOM, 11, 11, 0.", "UP.TOP, 11, 11, 9.",
                       "UP.TOP, 1", loads=[f"UP.TOP, P, {PRESSURE}"], path=tmp_path / "punch.inp")
        found = contact(result)
        inside = (found["x"] > 0.85 - 1e-9) & (found["x"] < 0.85 + width + 1e-9)
        assert np.all(found["pressure"][~inside] == 0.0)
        with h5py.File(result) as file:
            force = file["contact/C/normal_force"][-1]
        assert force == pytest.approx(PRESSURE * width, rel=EXACT)


def test_solvers_and_rotated_meshes_agree(tmp_path):
    """MUMPS and SKYLINE, and the whole model turned by 30 degrees, to rounding."""
    found = []
    for solver, angle in (("SKYLINE", 0.0), ("MUMPS", 0.0), ("SKYLINE", math.pi / 6)):
        cards = joint("CPE8", even(-0.15, 2.15, 5), even(0.0, 2.0, 6), angle, friction=0.3)
        supports = ["LOW.BOTTOM, 1, 2", "LOW.BOTTOM, 11, 11, 0.", f"UP.TOP, 11, 11, {HOT}"]
        cards += [f"*SOLVER, TYPE={solver}"]
        found.append(contact(press(cards, *supports, loads=[f"UP.TOP, P, {PRESSURE}"],
                                   path=tmp_path / "turned.inp")))
    for other in found[1:]:
        for name in ("pressure", "shear", "gap", "heat_flux", "weight", "s"):
            scale = np.abs(found[0]["pressure" if name == "shear" else name]).max() or 1.0
            np.testing.assert_allclose(other[name], found[0][name], rtol=0.0, atol=1e-9 * scale)


@pytest.mark.parametrize("angle", [0.1, 0.7, 1.3])
def test_a_rotated_model_has_no_gap(tmp_path, angle):
    """Nothing acts: what is left is the rounding of the coordinates."""
    cards = joint("CPE8", even(-0.15, 2.15, 5), even(0.0, 2.0, 6), angle)
    deck = deck_of(tmp_path / "gap.inp", cards, ["LOW.BOTTOM, 1, 2", "UP.TOP, 1, 2"])
    assert np.abs(contact(solve(deck))["gap"]).max() < 1e-14


def test_three_stacked_blocks_share_no_node_and_press_alike(tmp_path):
    """Two interfaces of a thin block, slave of one and master of the other; levels of refinement
    and elements of the first order in the same deck."""
    for extra in ([], ["*REFINE, LEVELS=1"], ["*OPTIONS, ORDER=1"]):
        cards = [*mesh("A", even(0.0, 2.0, 3), [0.0, 0.5, 1.0], "CPE8", 1),
                 *mesh("B", even(0.0, 2.0, 5), [1.0, 1.3], "CPE8", 1001),
                 *mesh("D", even(0.0, 2.0, 4), [1.3, 2.0], "CPE8", 2001)]
        for body in "ABD":
            cards += material(body, (1000.0, 0.3), 0.0, CONDUCTIVITY)
        cards += [*extra, "*SURFACE INTERACTION, NAME=I", "*GAP LAW, TYPE=POWER", CLOSED,
                  "*CONTACT PAIR, INTERACTION=I, NAME=ONE", "B.BOTTOM, A.TOP",
                  "*CONTACT PAIR, INTERACTION=I, NAME=TWO", "B.TOP, D.BOTTOM"]
        nodes = nodes_of(cards)
        left = [n for n, (x, y) in nodes.items() if x == 0.0]
        supports = ["A.BOTTOM, 2", *(f"{n}, 1" for n in left), "A.BOTTOM, 11, 11, 0.",
                    f"D.TOP, 11, 11, {HOT}"]
        result = press(cards, *supports, loads=[f"D.TOP, P, {PRESSURE}"],
                       path=tmp_path / "three.inp")
        for name in ("ONE", "TWO"):
            assert_uniform(contact(result, name))


REFUSED = {
    "*CONTACT PAIR, INTERACTION=C, NAME=C, PAIRING=NODES": "6 slave nodes but 5 master nodes",
    "*CONTACT PAIR, INTERACTION=C, NAME=C, PAIRING=MORTAR": "PAIRING",
}


@pytest.mark.parametrize(("card", "message"), REFUSED.items())
def test_a_pairing_that_does_not_fit_is_refused(tmp_path, card, message):
    cards = joint("CPE4", even(0.0, 2.0, 5), even(0.0, 2.0, 4))
    at = next(k for k, line in enumerate(cards) if line.startswith("*CONTACT PAIR"))
    cards[at] = card
    deck = deck_of(tmp_path / "refused.inp", cards, ["LOW.BOTTOM, 1, 2", "UP.TOP, 1, 2"])
    process = run("check", deck)
    assert process.returncode == 1
    assert message in process.stderr


@pytest.mark.parametrize("shift", [3.0, -2.5])
def test_faces_of_which_none_is_opposite_are_refused(tmp_path, shift):
    cards = joint("CPE8", even(shift, shift + 2.0, 5), even(0.0, 2.0, 4))
    deck = deck_of(tmp_path / "apart.inp", cards, ["LOW.BOTTOM, 1, 2", "UP.TOP, 1, 2"])
    process = run("check", deck)
    assert process.returncode == 1
    assert "no face of the master lies opposite" in process.stderr


def test_sides_with_midside_nodes_off_the_middle_pass(tmp_path):
    """At 0.4 and 0.62 of their sides: hats are linear in the side's own coordinate."""
    cards = joint("CPE8", even(0.0, 2.0, 3), even(0.0, 2.0, 4))
    nodes = nodes_of(cards)
    faces = [sorted(n for n, (_, y) in nodes.items() if y == 0.0 and (n < 5000) == upper)
             for upper in (True, False)]
    moved = {}
    for face, part in zip(faces, (0.4, 0.62), strict=True):
        ordered = sorted(face, key=lambda n: nodes[n][0])
        for low, middle, high in zip(ordered[:-2:2], ordered[1::2], ordered[2::2], strict=True):
            moved[middle] = nodes[low][0] + part * (nodes[high][0] - nodes[low][0])
    cards = [f"{card.split(',')[0]}, {moved[int(card.split(',')[0])]!r}, 0."
             if card.count(",") == 2 and card.split(",")[0].isdigit()
             and int(card.split(",")[0]) in moved and card.split(",")[2].strip() in ("0", "-0")
             else card for card in cards]
    assert {n for n, (x, y) in nodes_of(cards).items() if (x, y) != nodes[n]} == set(moved)
    low = [corner(cards, "LOW", turned(0.0), x, -1.0) for x in (0.0, 2.0)]
    found = contact(press(cards, f"{low[0]}, 1, 2", f"{low[1]}, 2",
                          f"{corner(cards, 'UP', turned(0.0), 0.0, 1.0)}, 1",
                          f"UP.TOP, 11, 11, {HOT}", "LOW.BOTTOM, 11, 11, 0.",
                          loads=[f"{side}, P, {PRESSURE}" for side in ("UP.TOP", "LOW.BOTTOM")],
                          path=tmp_path / "off.inp"))
    assert_uniform(found)
    assert all(b > a for a, b in pairwise(found["s"]))


HELD = [("CPE4", 5, 4, False), ("CPE4", 4, 5, True), ("CPE4", 13, 4, False), ("CPE4", 6, 6, True),
        ("CPE8", 7, 2, False), ("CPE8", 6, 3, True)]


@pytest.mark.parametrize(("kind", "slave", "master", "runs"), HELD)
@pytest.mark.parametrize("friction", [None, 0.3])
def test_a_held_slave_presses_uniformly_or_is_refused(tmp_path, kind, slave, master, runs,
                                                      friction):
    """All of its nodes are held: forces of more corners than the master has nodes would be
    undetermined. Exchanged, the faces always have a solution."""
    for swap in (False, True):
        cards = joint(kind, even(0.0, 2.0, slave), even(0.0, 2.0, master),
                      slave="LOW" if swap else "UP", poisson=0.0, friction=friction)
        deck = deck_of(tmp_path / "held.inp", cards,
                       ["UP, 1, 2", "LOW.LEFT, 1", "LOW.RIGHT, 1"], "*DSLOAD",
                       f"LOW.BOTTOM, P, {PRESSURE}")
        if runs or swap:
            np.testing.assert_allclose(contact(solve(deck))["pressure"], PRESSURE, rtol=EXACT)
        else:
            process = run("check", deck)
            assert process.returncode == 1
            assert "step 1: contact pair C: *BOUNDARY holds slave node" in process.stderr
            assert "exchange slave and master" in process.stderr
