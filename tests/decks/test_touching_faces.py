"""Faces that touch in the mesh conduct by the closed law, whatever rounding leaves between them."""

import math

import h5py
import pytest
from blocks import without_unused_surfaces, write
from deck_runs import pairs, run, solve
from physics import material, mesh

CLOSED, CONDUCTIVITY, WARM = 10.0, 1e3, 100.0
HELD = ["LOW.BOTTOM, 1, 2", "UP.TOP, 1, 2"]
COUPLED = "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE"
UNCOUPLED = "*UNCOUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE"
HEAT = "*HEAT TRANSFER, STEADY STATE"


def inclined(x, y):
    """Turn by 30 degrees, far from the origin."""
    return 1000 + math.sqrt(0.75) * x - y / 2, x / 2 + math.sqrt(0.75) * y


def tubes(x, y):
    """Put the length along the axis, and the height along the radius: UP is the inner tube."""
    return 3 - y, x


def arcs(x, y):
    """Bend a length of 1 to a quarter of a ring, faces at radius 2: UP is the inner one."""
    return (3 - y) * math.cos(math.pi / 2 * x), (3 - y) * math.sin(math.pi / 2 * x)


def flat(area):
    """Return the heat across two blocks of height 1 with faces of this area."""
    return WARM * area / (2 / CONDUCTIVITY + 1 / CLOSED)


def round_faces(length):
    """Return the heat from radius 1 to 3 across faces at radius 2; `length` is that at radius 1."""
    return WARM * length / (math.log(3) / CONDUCTIVITY + 1 / (2 * CLOSED))


def solid(name, kind):
    """Return the material of a block; DC elements have no elasticity."""
    return material(name, elastic=None if kind.startswith("DC") else (1000.0, 0.3),
                    conductivity=CONDUCTIVITY)


def deck(path, shape, kind, sides, steps, pair="", digits=None,
         law=("*GAP CONDUCTANCE", "10., 0.")):
    """Write a deck of two blocks of length 1 that touch at height 1; return its path."""
    blocks = [mesh(name, [k / n for k in range(n + 1)], [y, y + 1], kind, first, to=shape)
              for name, n, y, first in (("LOW", sides[0], 0.0, 1), ("UP", sides[1], 1.0, 5001))]
    if digits:
        blocks = [[rounded(card, digits) for card in cards] for cards in blocks]
    cards = []
    for card in steps:
        cards += ["*STEP", card, "0.5, 1., 0.5, 0.5", "*BOUNDARY"]
        cards += HELD if "MENT" in card or "STATIC" in card else []
        cards += ["UP.TOP, 11, 11, 100.", "LOW.BOTTOM, 11, 11, 0."] if "STATIC" not in card else []
        cards += ["*END STEP"]
    return write(path, ["*OPTIONS, WIDTH=200"], without_unused_surfaces(
        [*blocks[0], *blocks[1], *solid("LOW", kind), *solid("UP", kind),
         "*SURFACE INTERACTION, NAME=I", *law, f"*CONTACT PAIR, INTERACTION=I, NAME=C{pair}",
         "UP.BOTTOM, LOW.TOP"]), cards)


def rounded(card, digits):
    """Return a card of a node with fewer digits; others as they are."""
    fields = card.split(", ")
    if card.startswith("*") or "." not in card:
        return card
    return ", ".join([fields[0], *(f"{float(x):.{digits}g}" for x in fields[1:])])


def heat(path):
    """Solve a deck; return the heat across the faces at its end."""
    with h5py.File(solve(path)) as file:
        face = file["contact/C"]
        return face["heat_flux"][-1] @ face["weight"][()]


@pytest.mark.parametrize(("steps", "faces", "shape"), pairs([
    [HEAT], [COUPLED], [UNCOUPLED], [HEAT, COUPLED], [COUPLED, HEAT], ["*STATIC", HEAT],
    ["*STATIC", UNCOUPLED]],
    [((4, 4), ""), ((4, 4), ", PAIRING=SURFACES"), ((3, 4), ""), ((4, 3), ""), ((13, 7), "")],
    [None, inclined]))
def test_flat_faces_that_touch_conduct_in_every_kind_of_step(tmp_path, steps, faces, shape):
    sides, pair = faces
    path = deck(tmp_path / "d.inp", shape, "CPE4", sides, steps, pair)
    assert abs(heat(path) / flat(1.0) - 1) < 1e-9
    assert "never closes" not in path.with_suffix(".lst").read_text()


@pytest.mark.parametrize(("shape", "kind", "expected"), [
    (None, "DC2D8", flat(1.0)), (inclined, "DC2D8", flat(1.0)),
    (None, "DCAX4", flat(math.pi)), (None, "DCAX8", flat(math.pi)),
    (tubes, "DCAX8", round_faces(2 * math.pi))])
@pytest.mark.parametrize(("sides", "pair"), [
    ((4, 4), ""), ((4, 4), ", PAIRING=SURFACES"), ((3, 4), ""), ((7, 3), "")])
def test_other_elements_and_axes(tmp_path, shape, kind, expected, sides, pair):
    """Temperatures are linear or logarithms: one element each side errs by 1e-3 of their part."""
    rate = heat(deck(tmp_path / "d.inp", shape, kind, sides, [HEAT], pair))
    tolerance = 1e-9 if shape is not tubes else 1e-3 * expected / CONDUCTIVITY
    assert abs(rate / expected - 1) < tolerance


@pytest.mark.parametrize("kind", ["DC2D4", "DC2D8"])
@pytest.mark.parametrize(("sides", "pair"), [
    ((6, 6), ""), ((6, 6), ", PAIRING=SURFACES"), ((5, 6), ", ADJUST=0.1"),
    ((6, 5), ", ADJUST=0.1")])
def test_curved_faces_converge_to_the_closed_form(tmp_path, kind, sides, pair):
    errors = [abs(heat(deck(tmp_path / "d.inp", arcs, kind, [n * level for n in sides], [HEAT],
                            pair)) / round_faces(math.pi / 2) - 1) for level in (1, 2)]
    # Sides with midside nodes leave what one element makes of the logarithm along the radius.
    assert errors[1] < (errors[0] / 3 if kind == "DC2D4" else 1e-4)


@pytest.mark.parametrize("kind", ["DC2D4", "DC2D8"])
@pytest.mark.parametrize("sides", [(3, 4), (4, 3), (12, 16)])
def test_a_gap_of_chords_is_named_with_what_closes_it(tmp_path, kind, sides):
    """Nodes of both faces are on one circle; heat that is lost is never lost without a word."""
    path = deck(tmp_path / "d.inp", arcs, kind, sides, [HEAT])
    told = run("check", path).stderr
    lost = heat(path) < 0.99 * round_faces(math.pi / 2)
    assert ("Chords of curved faces" in told) == lost
    if not lost:
        return
    advised = told.split("put ADJUST=")[1].split()[0]
    again = deck(tmp_path / "a.inp", arcs, kind, sides, [HEAT], f", ADJUST={advised}")
    assert "touching faces conduct" not in run("check", again).stderr
    assert abs(heat(again) / round_faces(math.pi / 2) - 1) < 0.02


def test_gaps_of_printed_decimals_are_named(tmp_path):
    path = deck(tmp_path / "d.inp", inclined, "DC2D4", (3, 4), [HEAT], digits=8)
    told = run("check", path).stderr
    assert "decimals of coordinates leave" in told
    advised = told.split("put ADJUST=")[1].split()[0]
    again = deck(tmp_path / "a.inp", inclined, "DC2D4", (3, 4), [HEAT], f", ADJUST={advised}", 8)
    assert abs(heat(again) / flat(1.0) - 1) < 1e-4   # their area has 8 digits, too


def test_gaps_that_do_not_matter_or_that_mechanics_closes_are_not_named(tmp_path):
    gas = ("*GAP LAW, TYPE=GAS", "1000., 100.")
    for path in (deck(tmp_path / "g.inp", arcs, "DC2D4", (9, 12), [HEAT], law=gas),
                 deck(tmp_path / "c.inp", arcs, "CPE4", (3, 4), [COUPLED])):
        assert "touching faces conduct" not in run("check", path).stderr
