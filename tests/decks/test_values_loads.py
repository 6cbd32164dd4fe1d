"""Where loads and prescribed values start, add up and end; gravity and films in two values."""

import h5py
import numpy as np
import pytest
from physics import follows, judge, material, mesh
from test_physics_loads import (
    K, LENGTH, POISSON, ROLLERS, WIDTH, YOUNG, block, cold_bar, heat, static, stressed,
)
from test_values_steps import DOWN, SMALL

import conduction

# Gravity is one load along each axis.

@pytest.mark.changes("DLOAD")
@pytest.mark.parametrize(("one", "other"), [((3.0, -4.0), (4.0, -3.0)), ((3.0, -4.0), (-3.0, -4.0)),
                                            ((3.0, -4.0), (3.0, 4.0))])
def test_direction_of_gravity(tmp_path, one, other):
    """Reactions of the block that cannot move at all: its weight, and which way it pulls."""
    weight, area = 2.0 * 9.81, WIDTH * 3.0

    def make(direction):
        pull = [weight * area * c / np.hypot(*direction) for c in direction]
        deck = [*single(2.0), *static(
            "*DLOAD", f"BODY, GRAV, 9.81, {direction[0]}, {direction[1]}, 0.")]
        return deck, corner_reactions(pull)

    follows(tmp_path, make, one, other)


def single(density):
    """Return one four-node element that cannot move."""
    return [*mesh("BODY", [0.0, WIDTH], [0.0, 3.0], "CPE4"),
            *material("BODY", (YOUNG, POISSON), density=density), "*BOUNDARY", "BODY, 1, 2"]


def corner_reactions(pull):
    """Return the checks of a body force: a quarter of it at each node."""
    return [(f"RF{k + 1}", "BODY", "LAST", -force / 4, SMALL, "ABS")
            for k, force in enumerate(pull)]


@pytest.mark.changes("DLOAD, OP")
def test_gravity_along_one_axis_stays_where_the_other_is_given(tmp_path):
    weight = 2.0 * 9.81 * WIDTH * 3.0
    follows(tmp_path, lambda op: (
        [*single(2.0), *static("*DLOAD", "BODY, GRAV, 9.81, 0., -1., 0."),
         *static(f"*DLOAD, OP={op}", "BODY, GRAV, 9.81, 1., 0., 0.")],
        corner_reactions([weight, -weight if op == "MOD" else 0.0])), "MOD", "NEW")


@pytest.mark.changes("FILM")
@pytest.mark.parametrize(("face", "side", "far"), [(1, "BOTTOM", "TOP"), (2, "RIGHT", "LEFT"),
                                                   (3, "TOP", "BOTTOM"), (4, "LEFT", "RIGHT")])
def test_film_on_every_face(tmp_path, face, side, far):
    """Of one element, the opposite face at 20; another sink and another coefficient."""
    thick = 3.0 if face in (1, 3) else WIDTH
    cards = [*mesh("BODY", [0.0, WIDTH], [0.0, 3.0]), *material("BODY", conductivity=K)]

    def make(film):
        _, faces = conduction.wall(thick, K, 20.0, film[0], film_cold=film[1])
        return [*cards, *heat("*BOUNDARY", f"BODY.{far}, 11, 11, 20.", "*FILM",
                              f"BODY, F{face}, {film[0]!r}, {film[1]!r}")], [
            ("NT", f"BODY.{side}", "LAST", faces[1], SMALL)]

    follows(tmp_path, make, (300.0, 4.0), (280.0, 4.0))
    follows(tmp_path, make, (300.0, 4.0), (300.0, 3.0))


# Where a value starts, and how it ends.

def test_a_prescribed_displacement_starts_from_where_the_node_is(tmp_path):
    """The first step moves the top by a pressure, the second takes it on from there; a third one
    lets it go, and the pressure of the first still acts."""
    strain = (1 - POISSON**2) * -5.0 / YOUNG
    start = strain * 3.0
    deck = block(*static("*DSLOAD", "BODY.TOP, P, 5."),
                 *static("*BOUNDARY", "BODY.TOP, 2, 2, 0.01", times="0.25, 1."),
                 *static("*BOUNDARY, OP=NEW", *ROLLERS[1:], times="0.5, 1."))
    judge(tmp_path, deck, [
        ("U2", "BODY.TOP", 1.0, start, SMALL),
        ("U2", "BODY.TOP", 1.25, 0.75 * start + 0.0025, SMALL),
        ("U2", "BODY.TOP", 2.0, 0.01, SMALL), ("U2", "BODY.TOP", 2.5, start, SMALL),
        ("S22", "BODY", 2.5, -5.0, SMALL)])


def test_a_prescribed_temperature_starts_from_that_of_the_node(tmp_path):
    """And is free at once where it ends."""
    start = 10.0 * LENGTH / K
    deck = cold_bar(*heat("*DFLUX", "2, S2, 10."),
                    *heat("*BOUNDARY", "BODY.RIGHT, 11, 11, 40.", times="0.25, 1."),
                    *heat("*BOUNDARY, OP=NEW", "BODY.LEFT, 11", times="0.5, 1."))
    judge(tmp_path, deck, [
        ("NT", "BODY.RIGHT", 1.0, start, SMALL), ("NT", "BODY.RIGHT", 1.25, 0.75 * start + 10.0,
                                                  SMALL),
        ("NT", "BODY.RIGHT", 2.0, 40.0, SMALL), ("NT", "BODY.RIGHT", 2.5, start, SMALL)])


@pytest.mark.parametrize(("first", "options", "second", "left"), [
    ("*STEP", "", "*STEP", 0.75), ("*STEP", "", "*STEP, AMPLITUDE=STEP", 0.0),
    ("*STEP, AMPLITUDE=STEP", "", "*STEP", 0.75), ("*STEP", ", AMPLITUDE=FULL", "*STEP", 0.75),
    ("*STEP", ", AMPLITUDE=ALL", "*STEP", 0.0)])
def test_end_of_a_load(tmp_path, first, options, second, left):
    """Over the step where that ramps; at once where it does not, or the load has an amplitude on
    total time, which alone outlives its step."""
    deck = block("*AMPLITUDE, NAME=FULL", "0., 1., 1., 1.",
                 "*AMPLITUDE, NAME=ALL, TIME=TOTAL TIME", "0., 1., 1., 1.",
                 *static(f"*DSLOAD{options}", "BODY.TOP, P, 5.", first=first),
                 *static("*DSLOAD, OP=NEW", "BODY.RIGHT, P, 0.", first=second, times="0.25, 1."))
    judge(tmp_path, deck, [("S22", "BODY", 1.0, -5.0, SMALL),
                           ("S22", "BODY", 1.25, -5.0 * left, SMALL, "ABS"),
                           ("S22", "BODY", 2.0, 0.0, SMALL, "ABS")])


def test_pressures_of_elements_and_surfaces_add_up(tmp_path):
    judge(tmp_path, block(*static("*DLOAD", *DOWN, "*DSLOAD", "BODY.TOP, P, 2.",
                                  "BODY.TOP, TRVEC, 1., 0., -1., 0.")),
          stressed([0.0, -8.0, 0.0]))


def test_a_set_loads_each_of_its_nodes_with_the_whole(tmp_path):
    """Three nodes on an end, of force and of heat."""
    cards = [*mesh("BODY", [0.0, WIDTH], [0.0, 3.0]), *material("BODY", (YOUNG, POISSON),
                                                               conductivity=K)]
    pushed = [*cards, *static("*BOUNDARY", "BODY.BOTTOM, 1, 2", "*CLOAD", "BODY.TOP, 2, -5.")]
    result = judge(tmp_path, pushed, [("RF1", "BODY.TOP", "LAST", 0.0, SMALL, "ABS")])
    with h5py.File(result) as file:
        y = file["VTKHDF/Points"][:, 1]
        down = file["VTKHDF/PointData/displacement"][:, 1]
    assert np.all(down[y == 3.0] < 0.0)
    judge(tmp_path, [*cards, *heat("*BOUNDARY", "BODY.BOTTOM, 11", "*CFLUX", "BODY.TOP, 11, 4.")],
          [("heat_in", "", "LAST", 12.0, SMALL), ("heat_out", "", "LAST", 12.0, SMALL)])


def test_faces_in_contact_are_loaded(tmp_path):
    """Two blocks pressed together by 5; a pressure of 2 on the upper one's sole takes 2 of it."""
    deck = [*mesh("UP", [0.0, 1.0], [0.0, 0.5]), *mesh("LOW", [0.0, 1.0], [-1.0, 0.0], first=101)]
    for name in ("UP", "LOW"):
        deck += material(name, (YOUNG, POISSON))
    deck += ["*SURFACE INTERACTION, NAME=SMOOTH", "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE",
             "UP.BOTTOM, LOW.TOP", *static(
                 "*BOUNDARY", "LOW.BOTTOM, 2", "UP.LEFT, 1", "LOW.LEFT, 1", "*DSLOAD",
                 "UP.TOP, P, 5.", "UP.BOTTOM, P, 2.")]
    judge(tmp_path, deck, [("pressure", "FACE", "LAST", 3.0, SMALL), ("S22", "UP", "LAST", -5.0,
                           SMALL), ("S22", "LOW", "LAST", -3.0, SMALL)])


@pytest.mark.parametrize("levels", [0, 1, 2])
def test_refinement_keeps_what_the_deck_gives(tmp_path, levels):
    """Heat for a set stays on the nodes of the deck; what is prescribed for a set, the flux into a
    face and the film go on to the new nodes and sides; a source goes on to the new elements."""
    cards = [*mesh("BODY", [0.0, WIDTH], [0.0, 3.0]), *material("BODY", conductivity=K),
             f"*REFINE, LEVELS={levels}"]
    judge(tmp_path, [*cards, *heat("*BOUNDARY", "BODY.BOTTOM, 11", "*CFLUX", "BODY.TOP, 11, 4.")],
          [("heat_in", "", "LAST", 12.0, SMALL), ("NT", "BODY.BOTTOM", "LAST", 0.0, SMALL, "ABS")],
          name="nodes")
    _, faces = conduction.wall(3.0, K, 20.0, 300.0, film_cold=4.0)
    judge(tmp_path, [*cards, *heat("*BOUNDARY", "BODY.BOTTOM, 11, 11, 20.", "*FILM",
                                   "BODY, F3, 300., 4.")],
          [("NT", "BODY.TOP", "LAST", faces[1], SMALL), ("NT", "BODY.BOTTOM", "LAST", 20.0, SMALL)],
          name="films")
    judge(tmp_path, [*cards, *heat("*BOUNDARY", "BODY.BOTTOM, 11", "*DFLUX", "BODY, S3, 10.",
                                   "BODY, BF, 6.")],
          [("NT", "BODY.TOP", "LAST", (10.0 * 3.0 + 6.0 * 9.0 / 2) / K, SMALL),
           ("heat_in", "", "LAST", (10.0 + 6.0 * 3.0) * WIDTH, SMALL)], name="fluxes")
