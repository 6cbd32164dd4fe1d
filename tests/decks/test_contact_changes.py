"""What steps change of contact: frictions, contact pairs that are removed and added, and
interferences; in closed form, and beside CalculiX."""

import h5py
import numpy as np
import pytest
from blocks import write
from calculix import assert_within, compared
from changes import note_changes
from deck_runs import run, solve
from physics import follows, judge, material, mesh
from test_calculix_loads import step
from test_hysteresis import PRESSURE, STIFFNESS, sheared
from test_physics_contact import FACE, LOWER, SMOOTH, UPPER, YOUNG, static

BLOCKS = [*UPPER, *LOWER, *material("UPPER", (YOUNG, 0.0), conductivity=2.0),
          *material("LOWER", (YOUNG, 0.0), conductivity=2.0),
          "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "UPPER, 0.", "LOWER, 0."]
HELD = ["*BOUNDARY", "LOWER.BOTTOM, 1, 2", "UPPER.LEFT, 1", "LOWER.LEFT, 1"]
PAIR = "UPPER.BOTTOM, LOWER.TOP"
LENGTH = 1.5


# *CHANGE FRICTION.

def changed(folder, frictions):
    """Return a deck whose third step gives the second of two coefficients, and what is expected
    of shear and slip: the top stays where the second step moved it."""
    limits = [mu * PRESSURE for mu in frictions]
    top = 0.9 * limits[0] / STIFFNESS
    shear = min(0.9 * limits[0], limits[1])
    deck = sheared(folder / f"changed{frictions[1]}.inp", [top, top], [0.9 * limits[0], shear],
                   frictions[0])
    text = deck.read_text().replace("*STATIC\n1., 2.", "*STATIC\n1., 1.")
    return write(deck, text.splitlines(), [
        "*STEP", "*STATIC", "1., 1.", "*CHANGE FRICTION, INTERACTION=FACES", "*FRICTION",
        f"{frictions[1]!r}", "*END STEP"]), shear, top - shear / STIFFNESS


@pytest.mark.changes("FRICTION")
def test_friction_of_a_step(tmp_path):
    """The faces slip back to a smaller cone, and stay where they are under a wider one."""
    decks = []
    for frictions in ((0.3, 0.1), (0.3, 0.4)):
        deck, shear, slip = changed(tmp_path, frictions)
        decks.append(deck.read_text().splitlines())
        with h5py.File(solve(deck)) as file:
            found = {name: file[f"contact/FACE/{name}"][-1] for name in ("shear", "slip", "status")}
        np.testing.assert_allclose(found["shear"], -shear, rtol=1e-9)
        np.testing.assert_allclose(found["slip"], slip, rtol=1e-9, atol=1e-15)
        assert set(found["status"]) == {1 if frictions[1] < 0.27 else 2}
    note_changes(*decks)


@pytest.mark.changes("CHANGE FRICTION, INTERACTION")
def test_friction_begins_and_ends_with_a_step(tmp_path):
    """Two pairs with an interaction each: friction ends on one of them, and begins on the other.

    A pressed block is drawn aside by what friction and a spring of its own length take up."""
    def make(name):
        cards = [*BLOCKS, "*SURFACE INTERACTION, NAME=ONE", "*FRICTION", "0.5",
                 "*SURFACE INTERACTION, NAME=TWO",
                 "*CONTACT PAIR, INTERACTION=ONE, NAME=FACE", PAIR]
        deck = [*cards, *static("*BOUNDARY", "LOWER.BOTTOM, 1, 2", "UPPER.TOP, 2, 2, -0.015",
                                "UPPER.LEFT, 1", "LOWER.LEFT, 1"),
                *static(f"*CHANGE FRICTION, INTERACTION={name}", "*FRICTION", "0.")]
        return deck, [("status", "FACE", 1.0, 2.0, 0.0, "ABS"),
                      ("status", "FACE", 2.0, 1.0 if name == "ONE" else 2.0, 0.0, "ABS"),
                      ("pressure", "FACE", 2.0, YOUNG * 0.01, 1e-9)]

    follows(tmp_path, make, "ONE", "TWO")


# *MODEL CHANGE.

def change(kind):
    """Return the cards that add or remove the pair."""
    return [f"*MODEL CHANGE, TYPE=CONTACT PAIR, {kind}", PAIR]


def pressed(*cards):
    """Return the blocks brought together by 0.015 in the first step."""
    return [*BLOCKS, *SMOOTH, "*GAP LAW, TYPE=POWER", "4., 0., 1.", *FACE, *cards]


COUPLED = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1."]
DOWN = ["UPPER.TOP, 2, 2, -0.015", "UPPER.TOP, 11, 11, 90.", "LOWER.BOTTOM, 11, 11, 20."]
FLUX = -(90.0 - 20.0) / (LENGTH / 2.0 + 1 / 4.0)


def state(time, closed):
    """Return the checks of the pair at a time: pressed and conducting, or overlapping and not."""
    return [("pressure", "FACE", time, 10.0 if closed else 0.0, 1e-9, "ABS"),
            ("gap", "FACE", time, 0.0 if closed else -0.015, 1e-12, "ABS"),
            ("status", "FACE", time, float(closed), 0.0, "ABS"),
            ("heat_flux", "FACE", time, -FLUX if closed else 0.0, 1e-7, "ABS"),
            ("S22", "UPPER", time, -10.0 if closed else 0.0, 1e-9, "ABS")]


@pytest.mark.changes("MODEL CHANGE, REMOVE", "MODEL CHANGE, ADD", "MODEL CHANGE")
def test_pairs_are_removed_and_added(tmp_path):
    """Removed faces pass through each other, without pressure and heat; added ones close again."""
    def make(kind):
        deck = pressed(*COUPLED, "*BOUNDARY", *HELD[1:], *DOWN, "*END STEP",
                       *COUPLED, *change("REMOVE"), "*END STEP",
                       *COUPLED, *change(kind), "*END STEP")
        return deck, [*state(1.0, True), *state(1.5, False), *state(2.0, False),
                      *state(3.0, kind == "ADD")]

    follows(tmp_path, make, "ADD", "REMOVE")
    plain = pressed(*COUPLED, "*BOUNDARY", *HELD[1:], *DOWN, "*END STEP", *COUPLED, "*END STEP")
    at = plain.index("*END STEP")
    removed = [*plain[:at], *change("REMOVE"), *plain[at:]]
    note_changes(plain, removed)
    judge(tmp_path, plain, state(2.0, True))
    judge(tmp_path, removed, [*state(0.5, False)[2:], *state(2.0, False)])


def test_a_body_that_only_a_removed_pair_holds_is_named(tmp_path):
    deck = write(tmp_path / "free.inp", BLOCKS, SMOOTH, FACE, static(
        "*BOUNDARY", "LOWER.BOTTOM, 1, 2", "UPPER.LEFT, 1", "LOWER.LEFT, 1", "*DSLOAD",
        "UPPER.TOP, P, 5."), static(*change("REMOVE")))
    process = run("check", deck)
    assert process.returncode == 1
    assert "step 2: body 1" in process.stderr
    assert "can move along y" in process.stderr


@pytest.mark.parametrize(("slope", "tolerance", "cards"), [
    ("1.E6", 5e-3, ["*CHANGE FRICTION, INTERACTION=FACES", "*FRICTION", "0.05, 1.E6"]),
    ("1.E7", 2e-3, ["*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", "BODY.BOTTOM, BASE.TOP"])])
def test_changes_as_in_calculix(tmp_path, slope, tolerance, cards):
    """Of a body that friction holds back from growing wide. The stick slope gives by the shear over
    it, 3e-3 of the displacements with 1e6; with more CalculiX does not find the new friction."""
    blocks = [*mesh("BODY", [1.0, 1.75, 2.5], [0.0, 0.5, 1.0]), *material("BODY", (1000.0, 0.3)),
              *mesh("BASE", [1.0, 1.75, 2.5], [-1.0, -0.5, 0.0], first=101),
              *material("BASE", (3000.0, 0.2))]
    contact = ["*SURFACE INTERACTION, NAME=FACES",
               "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", "1.E7", "*FRICTION", f"0.3, {slope}",
               "*CONTACT PAIR, INTERACTION=FACES, TYPE=SURFACE TO SURFACE", "BODY.BOTTOM, BASE.TOP"]
    found = compared(
        tmp_path, blocks, contact, "*BOUNDARY", "BASE.BOTTOM, 1, 2", "BODY.LEFT, 1",
        step("*STATIC, DIRECT\n0.25, 1.", "*BOUNDARY", "BODY.TOP, 2, 2, -0.01",
             "*NODE PRINT, NSET=BODY", "U", "*EL PRINT, ELSET=BODY", "S"),
        step("*STATIC, DIRECT\n0.25, 1.", *cards))
    assert_within(found, tolerance)


# *CONTACT INTERFERENCE.

def interfering(*cards, overlap=0.003, amplitude=()):
    """Return the blocks with an overlap, in four increments."""
    return [*BLOCKS, *amplitude, *SMOOTH, *FACE,
            f"*CLEARANCE, MASTER=LOWER.TOP, SLAVE=UPPER.BOTTOM, VALUE={-overlap!r}",
            *static("*BOUNDARY", *HELD[1:], "UPPER.TOP, 2", *cards, times="0.25, 1.")]


def overlaps(*pairs):
    """Return the checks of the pressure under overlaps at some times."""
    return [("pressure", "FACE", time, YOUNG * overlap / LENGTH, 1e-9, "ABS")
            for time, overlap in pairs]


@pytest.mark.changes("CONTACT INTERFERENCE")
def test_an_allowed_overlap_is_taken_away_over_the_step(tmp_path):
    follows(tmp_path, lambda v: (
        interfering("*CONTACT INTERFERENCE", f"{PAIR}, {v!r}"),
        overlaps((0.25, 0.003 - 0.75 * v), (0.5, 0.003 - 0.5 * v), (1.0, 0.003))), 0.003, 0.001)


@pytest.mark.changes("CONTACT INTERFERENCE, AMPLITUDE")
def test_an_allowed_overlap_follows_an_amplitude(tmp_path):
    """Negative ones press the faces farther together."""
    course = ["*AMPLITUDE, NAME=COURSE", "0., 1., 0.5, -1., 1., 0.5"]
    spare = ["*AMPLITUDE, NAME=SPARE", "0., 1., 1., 0.2"]

    def make(name):
        factors = (0.0, -1.0, 0.5) if name == "COURSE" else (0.8, 0.6, 0.2)
        return interfering(f"*CONTACT INTERFERENCE, AMPLITUDE={name}", f"{PAIR}, 0.002",
                           amplitude=[*course, *spare]), overlaps(
            *((time, 0.003 - 0.002 * f) for time, f in zip((0.25, 0.5, 1.0), factors, strict=True)))

    follows(tmp_path, make, "COURSE", "SPARE")


@pytest.mark.changes("CONTACT INTERFERENCE, SHRINK", "CONTACT INTERFERENCE")
def test_all_overlaps_shrink(tmp_path):
    plain, shrunk = (interfering(*cards) for cards in (
        ("*CONTACT INTERFERENCE", f"{PAIR}, 0.001"), ("*CONTACT INTERFERENCE, SHRINK", PAIR)))
    note_changes(plain, shrunk)
    judge(tmp_path, shrunk, overlaps((0.25, 0.00075), (0.5, 0.0015), (1.0, 0.003)))


@pytest.mark.changes("CONTACT INTERFERENCE, OP")
def test_an_allowed_overlap_stays_with_mod_and_ends_with_new(tmp_path):
    """The second step names another pair, which is far open."""
    hold = ["*AMPLITUDE, NAME=HOLD", "0., 1., 1., 1."]
    aside = [*mesh("SIDE", [2.0, 3.0], [0.0, 0.5], first=501), *material("SIDE", (YOUNG, 0.0)),
             "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=ASIDE", "UPPER.RIGHT, SIDE.LEFT",
             "*BOUNDARY", "SIDE.RIGHT, 1, 2"]

    def make(op):
        deck = interfering("*CONTACT INTERFERENCE, AMPLITUDE=HOLD", f"{PAIR}, 0.002",
                           amplitude=hold)
        at = deck.index("*STEP")
        return [*deck[:at], *aside, *deck[at:], *static(
            f"*CONTACT INTERFERENCE, OP={op}", "UPPER.RIGHT, SIDE.LEFT, 0.001",
            times="0.25, 1.")], overlaps((1.0, 0.001), (2.0, 0.001 if op == "MOD" else 0.003))

    follows(tmp_path, make, "MOD", "NEW")


@pytest.mark.parametrize(("clearance", "interference", "total"), [
    (-0.003, 0.002, None), (-0.002, 0.002, None), (-0.002, -0.001, None), (0.002, 0.001, None),
    (0.0, -0.001, None), (0.001, 0.0, None), (None, -0.001, None), (0.0, 0.0, None),
    (0.25, -0.75, "-0.5"), (0.75, -0.25, "0.5"), (0.5, -0.5, "0"), (-0.25, 0.75, "0.5"),
    (-0.25, -0.25, "-0.5"), (0.25, 0.25, "0.5")])
def test_an_interference_against_or_beside_an_equal_clearance_is_warned_of(
        tmp_path, clearance, interference, total):
    """But not where it allows an overlap, which is how a press fit is ramped up."""
    found = warned_of_fit(tmp_path, clearance, interference, "add up to")
    assert len(found) == (total is not None)
    assert all(f"the interference {interference:g} and the *CLEARANCE {clearance:g} add up to {total};" in line
               for line in found)


def warned_of_fit(folder, clearance, interference, words):
    """Return the warnings with some words of an interference beside a clearance."""
    cards = interfering("*CONTACT INTERFERENCE", f"{PAIR}, {interference!r}")
    at = next(k for k, card in enumerate(cards) if card.startswith("*CLEARANCE"))
    cards[at:at + 1] = [] if clearance is None else [
        f"*CLEARANCE, MASTER=LOWER.TOP, SLAVE=UPPER.BOTTOM, VALUE={clearance!r}"]
    process = run("check", write(folder / "fit.inp", cards))
    assert process.returncode == 0, process.stderr
    return [line for line in process.stderr.splitlines() if words in line]


# ADJUST= on *CONTACT PAIR.

@pytest.mark.changes("CONTACT PAIR, ADJUST")
@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize(("gap", "down", "closes", "leaves"), [
    (0.004, 0.01, "0.005", "0.003"), (0.004, 0.01, "UPPER.BOTTOM", "UPPER.TOP"),
    (-0.002, 0.001, "0.", "UPPER.TOP")])
def test_slave_nodes_start_without_a_gap(tmp_path, pairing, gap, down, closes, leaves):
    """Those up to a distance, which overlaps are too, or of a node set."""
    upper = mesh("UPPER", [0.0, 0.4, 1.0], [gap, 0.5])

    def make(adjust):
        start = 0.0 if adjust == closes else gap
        deck = [*upper, *LOWER, *material("UPPER", (YOUNG, 0.0)), *material("LOWER", (YOUNG, 0.0)),
                *SMOOTH, f"*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, PAIRING={pairing}, "
                f"ADJUST={adjust}", PAIR,
                *static("*BOUNDARY", *HELD[1:], f"UPPER.TOP, 2, 2, {-down!r}")]
        return deck, [("pressure", "FACE", "LAST", YOUNG * (down - start) / (1.5 - gap), 1e-9)]

    follows(tmp_path, make, closes, leaves)
