"""*SURFACE of elements without a side: their sides that no other element of the mesh has."""

import pytest
from physics import judge, material, mesh
from test_physics_loads import HEIGHT, POISSON, WIDTH, XS, YS, YOUNG, heat, static

PRESSURE, FILM, HOT, COLD = 3.0, 0.4, 50.0, 20.0
SIDES = "LEFT", "RIGHT", "TOP", "BOTTOM"


def hydrostatic(*names):
    """Return the checks of a pressure on all sides of bodies."""
    return [(f"S{name}", body, "LAST", value, 1e-9, "ABS") for body in names
            for name, value in (("11", -PRESSURE), ("22", -PRESSURE), ("12", 0.0))]


@pytest.mark.parametrize("kind", ["CPE3", "CPE4", "CPE4I", "CPE6", "CPE8", "CPE8R"])
def test_pressure_on_all_of_them_is_hydrostatic(tmp_path, kind):
    cards = [*mesh("BODY", XS, YS, kind, skew=0.1), "*SURFACE, NAME=SKIN", "BODY"]
    judge(tmp_path, [*cards, *material("BODY", (YOUNG, POISSON)), *static(
        "*BOUNDARY", "BODY.LEFT, 1", "1, 2", "*DSLOAD", f"SKIN, P, {PRESSURE!r}")],
        hydrostatic("BODY"))


def test_faces_of_two_bodies_at_one_place_are_free(tmp_path):
    """Elements share sides by nodes, not by places."""
    deck = [*mesh("LOWER", [0.0, 1.0], [0.0, 1.0]),
            *mesh("UPPER", [0.0, 1.0], [1.0, 2.0], first=101),
            *material("LOWER", (YOUNG, POISSON)), *material("UPPER", (YOUNG, POISSON)),
            "*SURFACE, NAME=SKIN", "LOWER", "UPPER",
            *static("*BOUNDARY", "LOWER.LEFT, 1", "UPPER.LEFT, 1", "1, 2", "101, 2",
                    "*DSLOAD", f"SKIN, P, {PRESSURE!r}")]
    judge(tmp_path, deck, hydrostatic("LOWER", "UPPER"))


@pytest.mark.parametrize(("data", "length"), [
    (["BODY"], 2 * (WIDTH + HEIGHT)), (["1"], XS[1] + YS[1]), (["LOWER"], WIDTH + 2 * YS[1]),
    (["LOW*"], WIDTH + 2 * YS[1]), (["1", "2, S1", "LOWER"], WIDTH + 2 * YS[1])])
def test_a_film_acts_on_the_free_sides(tmp_path, data, length):
    """Of a body of uniform temperature, of its lower row, of an element in a corner: not on sides
    to elements outside the set, and on each side once."""
    deck = [*mesh("BODY", XS, YS), *material("BODY", (YOUNG, POISSON), conductivity=2.0),
            "*ELSET, ELSET=LOWER", "1, 2", "*SURFACE, NAME=SKIN", *data,
            *heat("*BOUNDARY", *(f"BODY.{side}, 11, 11, {HOT!r}" for side in SIDES),
                  "*SFILM", f"SKIN, F, {COLD!r}, {FILM!r}")]
    judge(tmp_path, deck, [("heat_in", "", "LAST", FILM * (HOT - COLD) * length, 1e-9)])


@pytest.mark.parametrize(("data", "length"), [
    ([", NAME=SKIN", "BODY"], 2 * (WIDTH + HEIGHT)),
    ([", NAME=SKIN, TYPE=NODE", "BODY.BOTTOM", "BODY.LEFT", "BODY.RIGHT"], WIDTH + 2 * HEIGHT)])
def test_a_film_acts_on_faces_in_contact_unless_the_others_are_named(tmp_path, data, length):
    deck = [*mesh("BODY", XS, YS), *mesh("LID", XS, [y + YS[-1] for y in YS], first=1001)]
    for name in ("BODY", "LID"):
        deck += material(name, (YOUNG, POISSON), conductivity=2.0)
    deck += ["*SURFACE INTERACTION, NAME=I", "*GAP CONDUCTANCE", "1., 0.", "*CONTACT PAIR, INTERACTION=I",
             "BODY.TOP, LID.BOTTOM", f"*SURFACE{data[0]}", *data[1:], *heat(
                 "*BOUNDARY", *(f"{name}.{side}, 11, 11, {HOT!r}" for name in ("BODY", "LID")
                                for side in SIDES), "*SFILM", f"SKIN, F, {COLD!r}, {FILM!r}")]
    judge(tmp_path, deck, [("heat_in", "", "LAST", FILM * (HOT - COLD) * length, 1e-9)])
