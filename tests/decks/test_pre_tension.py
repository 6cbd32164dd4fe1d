"""*PRE-TENSION SECTION and *BOUNDARY, FIXED: CalculiX on the same decks, and closed forms."""

import re

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from calculix import DIGITS, assert_within, calculix, differences, thercon
from changes import note_changes
from deck_runs import run, solve
from physics import judge, material, mesh

MODULUS, EXPANSION, LENGTH, HEIGHT = 1000.0, 1e-5, 4.0, 1.0
STEP = ["*STEP", "*STATIC", "1., 1."]
PRINTS = ["*NODE PRINT, NSET=BODY", "U", "*EL PRINT, ELSET=BODY", "S"]
HELD = ["*BOUNDARY", "BODY.LEFT, 1, 1", "BODY.RIGHT, 1, 1", "1, 2, 2"]


def bar(kind="CPE8", poisson=0.0, cut=("2, S2", "6, S2"), normal=(), node="900",
        heights=(0.0, 0.5, HEIGHT), to=None):
    """Return a bar of 4 x 2 elements along x that a section cuts in the middle."""
    return [*mesh("BODY", [0.0, 1.0, 2.0, 3.0, LENGTH], list(heights), kind, 1, to=to),
            *material("BODY", (MODULUS, poisson), EXPANSION, 2.0),
            "*NODE, NSET=BOLT", "900, 0., 9.", "*NODE, NSET=OTHER", "901, 0., 9.",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20.",
            "*SURFACE, NAME=CUT", *cut, "*SURFACE, NAME=LATER", "3, S2", "7, S2",
            f"*PRE-TENSION SECTION, NODE={node}, SURFACE=CUT", *normal]


def judged(folder, model, steps, checks):
    """Run a deck with checks at its end."""
    judge(folder, without_unused_surfaces([*model, *steps]), checks)


@pytest.mark.parametrize("kind", ["CPE8", "CPS8R", "CPE4"])
@pytest.mark.parametrize("load", [["*CLOAD", "900, 1, 3."], ["*BOUNDARY", "900, 1, 1, 0.02"]],
                         ids=["force", "length"])
def test_a_section_as_in_calculix(tmp_path, kind, load):
    deck = write(tmp_path / "deck.inp", without_unused_surfaces(
        [*bar(kind, 0.3), *STEP, *HELD, *load, *PRINTS, "*NODE PRINT, NSET=BOLT", "U",
         "*END STEP"]))
    theirs, ours = calculix(deck), thercon(deck)
    assert_within(differences(theirs, ours), DIGITS)
    assert (900,) in ours[1.0, "U1"].keys() & theirs[1.0, "U1"].keys()


@pytest.mark.parametrize("normal", ["1., 0., 0.", "-1., 0., 0.", "1., 0.5, 0."])
def test_a_normal_of_the_card_is_taken_as_it_is_as_in_calculix(tmp_path, normal):
    deck = write(tmp_path / "deck.inp", without_unused_surfaces(
        [*bar("CPS8", 0.3, normal=[normal]), *STEP, *HELD, "*CLOAD", "900, 1, 3.", *PRINTS,
         "*END STEP"]))
    assert_within(differences(calculix(deck), thercon(deck)), DIGITS)


BEND, LEAN = 0.25, 0.3   # above this height the section leans by as much a height


def bent(heights, normal=()):
    """Return the cards of a bar whose section is bent, pulled by a force."""
    def lean(x, y):
        return x + LEAN * max(y - BEND, 0.0) * x * (LENGTH - x) / 4, y

    cut = [f"{element}, S2" for element in range(2, 4 * len(heights) - 4, 4)]
    model = bar("CPE8", 0.3, cut, normal, heights=heights, to=lean)
    return without_unused_surfaces([*model, *STEP, *HELD, "*CLOAD", "900, 1, 3.", *PRINTS,
                                    "*END STEP"])


@pytest.mark.parametrize("heights", [[0.0, BEND, HEIGHT], [0.0, BEND, 0.4, HEIGHT]])
def test_a_bent_section_has_the_normal_of_its_chord_however_it_is_divided(tmp_path, heights):
    chord = LEAN * (HEIGHT - BEND)
    plain = write(tmp_path / "plain.inp", bent(heights))
    given = write(tmp_path / "given.inp", bent(heights, [f"{HEIGHT}, {-chord}"]))
    assert_within(differences(thercon(given), thercon(plain)), DIGITS)


def test_a_bent_section_with_the_mean_of_the_normals_of_its_sides_is_as_in_calculix(tmp_path):
    heights = [0.0, BEND, HEIGHT]
    length = np.hypot(1.0, LEAN)
    plain = write(tmp_path / "plain.inp", bent(heights))
    given = write(tmp_path / "given.inp", bent(heights, [f"{1.0 + 1.0 / length}, {-LEAN / length}"]))
    assert_within(differences(calculix(plain), thercon(given)), DIGITS)


def test_triangles_with_one_node_at_a_section_are_on_its_side(tmp_path):
    judged(tmp_path, bar("CPS6", 0.3, ("3, S2", "11, S2")),
           [*STEP, *HELD, "*CLOAD", "900, 1, 3.", "*END STEP"],
           [("S11", "MIN", "LAST", 3.0, 1e-9), ("S11", "MAX", "LAST", 3.0, 1e-9)])


@pytest.mark.parametrize("options", [[], ["*OPTIONS, ORDER=1"], ["*REFINE, LEVELS=1"],
                                     ["*REFINE, LEVELS=1, SURFACE=CUT"],
                                     ["*REFINE, LEVELS=1, SURFACE=BODY.LEFT"]],
                         ids=["", "order", "levels", "section", "end"])
def test_a_bar_between_walls(tmp_path, options):
    """A force F is the same in the whole bar, which it shortens by F L/(E A); a length that is held
    then changes the force by -E A alpha per degree."""
    force = 10.0
    hold = ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY, FIXED", "900, 1, 1", "*CLOAD, OP=NEW",
            "*TEMPERATURE", "BODY, 120.", "*END STEP"]
    judged(tmp_path, [*options, *bar()],
           [*STEP, *HELD, "*CLOAD", f"900, 1, {force}", "*END STEP", *hold], [
        ("pre_tension", "BOLT", "1.", force, 1e-10),
        ("U1", "900", "1.", force * LENGTH / (MODULUS * HEIGHT), 1e-10),
        ("S11", "MAX", "1.", force / HEIGHT, 1e-9), ("S11", "MIN", "1.", force / HEIGHT, 1e-9),
        ("pre_tension", "900", "LAST", force - MODULUS * EXPANSION * 100.0, 1e-9),
        ("S11", "MAX", "LAST", force - MODULUS * EXPANSION * 100.0, 1e-9),
        ("S11", "MIN", "LAST", force - MODULUS * EXPANSION * 100.0, 1e-9),
        ("force_imbalance", "", "LAST", 0.0, 1e-10, "ABS")])


@pytest.mark.parametrize(("errors", "words"), [
    ("LAST", r"\(no estimate: path; ERRORS=FULL\)"), ("FULL", r"\+- 0 +\(0 %\)")])
def test_the_summary_has_the_force_of_a_section(tmp_path, errors, words):
    """One that the deck prescribes has no error."""
    deck = write(tmp_path / "deck.inp", [f"*OPTIONS, ERRORS={errors}"], without_unused_surfaces(
        [*bar(), *STEP, *HELD, "*CLOAD", "900, 1, 10.", "*END STEP"]))
    told = run("run", deck, "--out", tmp_path).stdout
    assert re.search(rf"\n  pre-tension\n    force +10 {words}, node 900\n", told), told


def test_heat_crosses_a_section_as_if_there_were_none(tmp_path):
    """A linear temperature, and no stress of it in a bar that is free to expand."""
    steps = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
             "BODY.LEFT, 11, 11, 20.", "BODY.RIGHT, 11, 11, 60.", "1, 1, 1", "BODY.BOTTOM, 2, 2",
             "900, 1, 1, 0.", "*END STEP"]
    judged(tmp_path, bar(), steps, [
        ("HFL1", "MIN", "LAST", -20.0, 1e-9), ("HFL1", "MAX", "LAST", -20.0, 1e-9),
        ("pre_tension", "900", "LAST", 0.0, 1e-9, "ABS"), ("S11", "MAX", "LAST", 0.0, 1e-9, "ABS"),
        ("heat_imbalance", "", "LAST", 0.0, 1e-10, "ABS")])


def test_a_section_up_to_the_axis(tmp_path):
    """A round bar of radius 0.5 under a force: sigma = F/(pi r^2), of the whole circumference."""
    radius, force = 0.5, 7.0
    model = [*mesh("BODY", [0.0, 0.2, radius], [0.0, 1.0, 2.0], "CAX8", 1),
             *material("BODY", (MODULUS, 0.3), EXPANSION, 2.0), "*NODE, NSET=BOLT", "900, 0., 9.",
             "*SURFACE, NAME=CUT", "1, S3", "2, S3",
             "*PRE-TENSION SECTION, NODE=BOLT, SURFACE=CUT",
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0."]
    judged(tmp_path, model, [*STEP, "*BOUNDARY", "BODY.BOTTOM, 2, 2", "BODY.TOP, 2, 2", "*CLOAD",
                             f"900, 1, {force}", "*END STEP"],
           [("S22", "MAX", "LAST", force / (np.pi * radius**2), 1e-9),
            ("S22", "MIN", "LAST", force / (np.pi * radius**2), 1e-9),
            ("pre_tension", "BOLT", "LAST", force, 1e-10)])


@pytest.mark.changes("PRE-TENSION SECTION", "PRE-TENSION SECTION, NODE",
                     "PRE-TENSION SECTION, SURFACE", "BOUNDARY, FIXED")
def test_node_surface_and_normal_of_a_section(tmp_path):
    """Wherever a bar between walls is cut, an overlap stretches it by E A/L times its part along
    the bar; FIXED in the first step holds what nothing has moved."""
    first = [*bar(), *STEP, *HELD, "*BOUNDARY", "900, 1, 1, 0.01", "*END STEP"]
    second = [card.replace("NODE=900, SURFACE=CUT", "NODE=OTHER, SURFACE=LATER")
              .replace("900, 1, 1, 0.01", "901, 1, 1, 0.01")
              for card in [*bar(normal=["3., 4., 0."]), *first[len(bar()):]]]
    held = [*first[:-3], "*BOUNDARY, FIXED", *first[-2:]]
    note_changes(first, second)
    note_changes(first, held)
    force = MODULUS * HEIGHT * 0.01 / LENGTH
    judge(tmp_path, without_unused_surfaces(first), [
        ("pre_tension", "900", "LAST", force, 1e-9), ("S11", "MAX", "LAST", force / HEIGHT, 1e-9)])
    judge(tmp_path, without_unused_surfaces(second), [
        ("S11", "MAX", "LAST", 0.6 * force / HEIGHT, 1e-9)])
    judge(tmp_path, without_unused_surfaces(held), [
        ("pre_tension", "900", "LAST", 0.0, 1e-9, "ABS")])


def test_nodes_of_the_deck_keep_their_numbers(tmp_path):
    deck = write(tmp_path / "bar.inp", without_unused_surfaces(
        [*bar(), *STEP, *HELD, "*CLOAD", "900, 1, 3.", "*END STEP"]))
    with h5py.File(solve(deck)) as file:
        numbers = file["/VTKHDF/PointData/node_id"][:]
        assert file["/history/pre_tension"][:] == pytest.approx([3.0])
    assert set(numbers) - {900, 901} == {*range(1, 38), *range(902, 907)}
