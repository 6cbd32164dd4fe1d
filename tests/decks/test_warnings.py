"""Decks that can be solved but may not be meant so are warned of, others are not."""

import re

import pytest
from blocks import block, solid, write
from deck_runs import run
from physics import nodes_of

XS = [0.0, 1.0, 2.0, 3.0, 4.0]


def blocks(shift=0.0, gap=0.0, thickness=("1.", "1."), pair="B.BOTTOM, A.TOP", clearance=None):
    """Return two blocks, the upper one moved."""
    cards = block("A", XS, [0.0, 1.0, 2.0])
    cards += block("B", [x + shift for x in XS], [2.0 + gap, 3.0 + gap, 4.0 + gap], first=101)
    for name, value in zip("AB", thickness, strict=True):
        cards += [*solid(name, 2e5, 0.3), value]
    cards += ["*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I, NAME=F", pair]
    slave, master = pair.split(", ")
    if clearance is not None:
        cards += [f"*CLEARANCE, SLAVE={slave}, MASTER={master}, VALUE={clearance!r}"]
    return [*cards, "*BOUNDARY", "A.BOTTOM, 1, 2", "B.LEFT, 1"]


PRESSED = ["*STEP", "*STATIC", "1., 1.", "*DSLOAD", "B.TOP, P, 1.", "*END STEP"]


def warnings(folder, *cards, status=0):
    """Check a deck; return its warnings as (line image, message)."""
    deck = write(folder / "deck.inp", *cards)
    process = run("check", deck)
    assert process.returncode == status, process.stderr
    return re.findall(r"^.*: warning: (.*)\n(.*)$", process.stderr, re.M)


def one(found, card):
    """Return the message of the only warning, which stands at a card."""
    assert len(found) == 1, found
    assert found[0][1].startswith(card)
    return found[0][0]


@pytest.mark.parametrize(("shift", "told"), [(0.0, None), (0.02, None), (0.03, "6 %"),
                                             (-0.2, "40 %"), (0.49, "98 %")])
def test_nodes_beside_each_other(tmp_path, shift, told):
    """Node spacing 0.5; a twentieth of it is allowed."""
    found = warnings(tmp_path, blocks(shift), PRESSED)
    if told is None:
        assert found == []
        return
    message = one(found, "*CONTACT PAIR")
    slave, master = ({p: n for n, p in nodes_of(block(*b)).items()}[x, 2.0] for *b, x in (
        ("B", [x + shift for x in XS], [2.0, 3.0, 4.0], 101, shift),
        ("A", XS, [0.0, 1.0, 2.0], 1, 0.0)))
    assert f"contact pair F: slave node {slave} and master node {master} lie " in message
    assert float(re.search(r"lie (\S+) beside each other", message)[1]) == abs(shift)
    assert f"{told} of the node spacing (pairs with more than 5 %: 9)" in message
    assert "moment" in message


def test_an_offset_far_from_the_contact_is_that_of_curved_faces(tmp_path):
    """Half the gap is allowed, as where faces are refused."""
    assert warnings(tmp_path, blocks(0.2, gap=0.41), PRESSED) == []
    assert "40 %" in one(warnings(tmp_path, blocks(0.2, gap=0.39), PRESSED), "*CONTACT PAIR")


def test_warnings_of_pairs_stand_in_the_listing_too(tmp_path):
    deck = write(tmp_path / "deck.inp", blocks(0.2), PRESSED)
    assert "moment of force times offset is lost" in run("run", "--quiet", deck, "--out",
                                                         tmp_path).stderr
    listing = deck.with_suffix(".lst").read_text()
    assert "contact pair F: slave node" in listing[listing.index("WARNINGS"):]


@pytest.mark.parametrize(("gap", "clearance", "warned"), [
    (-0.9, None, False), (-1.0, None, True), (-1.0, -1e-3, False)])
def test_bodies_inside_each_other(tmp_path, gap, clearance, warned):
    found = warnings(tmp_path, blocks(gap=gap, clearance=clearance), PRESSED)
    if not warned:
        assert found == []
        return
    assert "the faces overlap by 1 at slave node " in one(found, "*CONTACT PAIR")


def test_swapped_faces(tmp_path):
    """Top of the upper and bottom of the lower block named as the faces in contact."""
    found = warnings(tmp_path, blocks(pair="B.TOP, A.BOTTOM"), PRESSED)
    assert "overlap by 4" in one(found, "*CONTACT PAIR")


def test_conductance_that_rounding_leaves_unknown(tmp_path):
    """TOL below what a few units in the last place of the displacements change in omega."""
    cards = blocks()
    at = cards.index("*CONTACT PAIR, INTERACTION=I, NAME=F")
    heated = PRESSED.copy()
    heated[1:2] = ["*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.", "*BOUNDARY",
                   "A.BOTTOM, 11", "B.TOP, 11, 11, 50."]
    del heated[6]
    for tolerance, warned in (("1.E-8", False), ("1.E-25", True)):
        deck = write(tmp_path / "deck.inp", cards[:at],
                     ["*GAP LAW, TYPE=POWER", "0., 0.1, 1."], cards[at:],
                     [f"*FIXED POINT, TOL={tolerance}"], heated)
        process = run("run", "--quiet", deck, "--out", tmp_path)
        assert process.returncode == 0, process.stderr
        found = re.findall(r"increment 2: the conductance of the contacts is known to (\S+) only, "
                           r"not to TOL=", process.stderr)
        assert len(found) == warned
        assert all(0 < float(value) < 1e-8 for value in found)


def test_bodies_of_different_thickness(tmp_path):
    """The areas are the slave's; axisymmetric models have no thickness."""
    cards = blocks(thickness=("1.", "5."))
    message = one(warnings(tmp_path, cards, PRESSED), "*CONTACT PAIR")
    assert "is 1 thick; pressure and flux of all pairs are for the thickness 5 of" in message
    assert warnings(tmp_path, blocks(thickness=("5.", "5.")), PRESSED) == []
    assert warnings(tmp_path, ["*OPTIONS, PLANE=AXISYMMETRIC"], cards, PRESSED) == []
