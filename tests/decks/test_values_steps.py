"""What the parameters of steps and of their loads change: two values of each, known answers."""

import h5py
import numpy as np
import pytest
from changes import note_changes
from physics import follows, judge, material, mesh, nodes_of, side_shares
from test_physics_loads import (
    BLOCK, COLD, HOT, K, LENGTH, LOADS, POISSON, ROLLERS, TENT, WIDTH, XS, YOUNG,
    bar, block, cold_bar, course, heat, held_hot, static, stressed, top_forces,
)

import conduction

SMALL = 1e-9


def keyword_of(load):
    """Return the keyword of one of LOADS."""
    return "BOUNDARY" if load == "TEMPERATURES" else load


def with_tent(deck):
    """Return the cards of a deck with the amplitude TENT before its first step."""
    at = next(k for k, card in enumerate(deck) if card.startswith("*STEP"))
    return [*deck[:at], *TENT, *deck[at:]]


def marked(parameter):
    """Return LOADS, each marked with a parameter of its keyword."""
    return [pytest.param(load, marks=pytest.mark.changes(f"{keyword_of(load)}, {parameter}"))
            for load in LOADS]


@pytest.mark.parametrize("load", marked("AMPLITUDE"))
def test_amplitude_of_a_load_or_the_course_of_its_step(tmp_path, load):
    step, cards, model, (quantity, where, full) = course(load)

    def make(options):
        factors = (0.5, 1.0, 0.4) if options else (0.25, 0.5, 1.0)
        return with_tent(model(*step(*cards(options), times="0.25, 1."))), [
            (quantity, where, time, full * f, SMALL * abs(full), "ABS")
            for time, f in zip((0.25, 0.5, 1.0), factors, strict=True)]

    follows(tmp_path, make, "", ", AMPLITUDE=TENT")


@pytest.mark.changes("STEP, AMPLITUDE")
@pytest.mark.parametrize("load", LOADS)
def test_step_ramps_its_loads_or_not(tmp_path, load):
    step, cards, model, (quantity, where, full) = course(load)

    def make(first):
        factors = (1.0, 1.0) if "=STEP" in first else (0.5, 1.0)
        return model(*step(*cards(""), first=first, times="0.5, 1.")), [
            (quantity, where, time, full * f, SMALL * abs(full), "ABS")
            for time, f in zip((0.5, 1.0), factors, strict=True)]

    follows(tmp_path, make, "*STEP, AMPLITUDE=RAMP", "*STEP, AMPLITUDE=STEP")


# OP: the second step gives something else than the first. Models, both steps and what is found
# behind the second one, by OP.

ACROSS = [f"{n}, 1, {share * 2.0!r}" for n, share in side_shares(BLOCK, 0, WIDTH).items()]
BAR = mesh("BODY", XS, [0.0, 0.5])
MIDDLE = [f"{n}, 11, {4.0 * share!r}" for n, share in side_shares(BAR, 0, XS[1]).items()]
RIGHT = [f"{n}, 11, {10.0 * share!r}" for n, share in side_shares(BAR, 0, LENGTH).items()]
WALL = conduction.wall(LENGTH, K, *(pair[0] for pair in (HOT, COLD)), HOT[1], COLD[1])[1]
DOWN, ASIDE = ["3, P3, 5.", "4, P3, 5."], ["2, P2, 2.", "4, P2, 2."]


def at_right(rate):
    """Return the check of the temperature at the right end of the bar."""
    return [("NT", "BODY.RIGHT", 2.0, rate, SMALL, "ABS")]


REPLACED = {
    "CLOAD": (block, static, top_forces(-5.0), ACROSS,
              {"MOD": stressed([2.0, -5.0, 0.0]), "NEW": stressed([2.0, 0.0, 0.0])}),
    "DLOAD": (block, static, DOWN, ASIDE,
              {"MOD": stressed([-2.0, -5.0, 0.0]), "NEW": stressed([-2.0, 0.0, 0.0])}),
    "DSLOAD": (block, static, ["BODY.TOP, P, 5."], ["BODY.RIGHT, P, 2."],
               {"MOD": stressed([-2.0, -5.0, 0.0]), "NEW": stressed([-2.0, 0.0, 0.0])}),
    "BOUNDARY": (block, static, ["BODY.TOP, 2, 2, 0.01"], ROLLERS[1:],
                 {"MOD": [("U2", "BODY.TOP", 2.0, 0.01, 1e-12)],
                  "NEW": stressed([0.0, 0.0, 0.0])}),
    "TEMPERATURE": (held_hot, static, ["BODY, 50."], ["BODY.LEFT, 30."],
                    {"MOD": [("NT", "BODY.LEFT", 2.0, 30.0, SMALL), *at_right(50.0)],
                     "NEW": [("NT", "BODY.LEFT", 2.0, 30.0, SMALL), *at_right(0.0)]}),
    "TEMPERATURES": (cold_bar, heat, ["BODY.RIGHT, 11, 11, 40."], ["BODY.LEFT, 11"],
                     {"MOD": at_right(40.0), "NEW": at_right(0.0)}),
    "CFLUX": (cold_bar, heat, RIGHT, MIDDLE,
              {"MOD": at_right((10.0 * LENGTH + 4.0 * XS[1]) * 0.5 / (0.5 * K)),
               "NEW": at_right(4.0 * XS[1] * 0.5 / (0.5 * K))}),
    "DFLUX": (cold_bar, heat, ["2, S2, 10."], ["1, BF, 3."],
              {"MOD": at_right((10.0 * LENGTH + 3.0 * XS[1] ** 2 / 2) / K),
               "NEW": at_right(3.0 * XS[1] ** 2 / 2 / K)}),
    "FILM": (bar, heat, [f"1, F4, {HOT[0]}, {HOT[1]}", f"2, F2, {COLD[0]}, {COLD[1]}"],
             [f"2, F2, {COLD[0]}, {COLD[1]}"],
             {"MOD": at_right(WALL[1]), "NEW": at_right(COLD[0])}),
    "DSFLUX": (cold_bar, heat, ["BODY.RIGHT, S, 10."], ["BODY.TOP, S, 0."],
               {"MOD": at_right(10.0 * LENGTH / K), "NEW": at_right(0.0)}),
    "SFILM": (bar, heat, [f"BODY.LEFT, F, {HOT[0]}, {HOT[1]}", f"BODY.RIGHT, F, {COLD[0]}, "
                          f"{COLD[1]}"], [f"BODY.RIGHT, F, {COLD[0]}, {COLD[1]}"],
              {"MOD": at_right(WALL[1]), "NEW": at_right(COLD[0])}),
}


@pytest.mark.parametrize("load", [
    pytest.param(load, marks=pytest.mark.changes(f"{keyword_of(load)}, OP")) for load in REPLACED])
def test_loads_stay_with_mod_and_go_with_new(tmp_path, load):
    """At the end of the second step, in which they end where it ramps."""
    model, step, first, second, found = REPLACED[load]
    keyword = "*" + keyword_of(load)
    follows(tmp_path, lambda op: (
        model(*step(keyword, *first), *step(f"{keyword}, OP={op}", *second)), found[op]),
        "MOD", "NEW")


@pytest.mark.parametrize("load", REPLACED)
def test_a_load_on_the_same_place_is_replaced(tmp_path, load):
    """Also without OP=: what is given again there does not add up."""
    model, step, first, _, found = REPLACED[load]
    keyword = "*" + keyword_of(load)
    once = {"CLOAD": stressed([0.0, -5.0, 0.0]), "DLOAD": stressed([0.0, -5.0, 0.0]),
            "DSLOAD": stressed([0.0, -5.0, 0.0]), "TEMPERATURE": at_right(50.0),
            "CFLUX": at_right(10.0 * LENGTH / K), "DFLUX": at_right(10.0 * LENGTH / K)}
    judge(tmp_path, model(*step(keyword, *first), *step(keyword, *first)),
          once.get(load, found["MOD"]))


@pytest.mark.parametrize(("first", "second"), [(("*DSLOAD", "BODY.TOP, P, 5."), ("*DLOAD", ASIDE)),
                                               (("*DLOAD", *DOWN), ("*DSLOAD",
                                                                    ["BODY.RIGHT, P, 2."]))])
def test_new_pressures_end_those_of_the_other_keyword(tmp_path, first, second):
    keyword, rows = second
    follows(tmp_path, lambda op: (
        block(*static(*first), *static(f"{keyword}, OP={op}", *rows)),
        stressed([-2.0, -5.0 if op == "MOD" else 0.0, 0.0])), "MOD", "NEW")


def test_new_pressures_of_surfaces_leave_body_forces(tmp_path):
    """*DSLOAD, OP=NEW ends pressures of *DLOAD, not its body forces."""
    force = 3.0
    deck = [*BLOCK, *material("BODY", (YOUNG, POISSON)), "*BOUNDARY", "BODY, 2", "BODY.LEFT, 1",
            *static("*DLOAD", f"BODY, BX, {force!r}", *ASIDE), *static("*DSLOAD, OP=NEW",
                                                                      "BODY.TOP, P, 1.")]
    judge(tmp_path, deck, [("S11", "BODY.LEFT", 2.0, force * WIDTH, SMALL),
                           ("S11", "BODY.RIGHT", 2.0, 0.0, SMALL, "ABS")])


def test_ramp_down_of_what_ends(tmp_path):
    """Halfway through the second step half of it is left; a film ends by its coefficient."""
    first, second = static("*CLOAD", *top_forces(-5.0)), ["*CLOAD, OP=NEW", *ACROSS]
    judge(tmp_path, block(*first, *static(*second, times="0.5, 1.")),
          [("S22", "BODY", 1.5, -2.5, SMALL), ("S11", "BODY", 1.5, 1.0, SMALL)], name="forces")
    hot, cold = HOT, COLD
    _, faces = conduction.wall(LENGTH, K, hot[0], cold[0], hot[1] / 2, cold[1])
    deck = bar(*heat("*FILM", f"1, F4, {hot[0]}, {hot[1]}", f"2, F2, {cold[0]}, {cold[1]}"),
               *heat("*FILM, OP=NEW", f"2, F2, {cold[0]}, {cold[1]}", times="0.5, 1."))
    judge(tmp_path, deck, [("NT", "BODY.LEFT", 1.5, faces[0], SMALL)], name="films")


@pytest.mark.parametrize(("card", "keyword", "factors"), [
    pytest.param(card, keyword, factors, marks=pytest.mark.changes(f"{card}, {keyword}"))
    for card in ("FILM", "SFILM")
    for keyword, factors in (("AMPLITUDE", (0.5, 1.0)), ("FILM AMPLITUDE", (1.0, 0.5)))])
def test_amplitudes_of_a_film(tmp_path, card, keyword, factors):
    """At 0.25 TENT is 0.5; both sink and coefficient act whole in this step without it."""
    def make(options):
        sink, film = factors if options else (1.0, 1.0)
        _, faces = conduction.wall(LENGTH, K, 20.0, 300.0 * sink, film_cold=4.0 * film)
        face = "2, F2" if card == "FILM" else "BODY.RIGHT, F"
        deck = bar(*TENT, *heat("*BOUNDARY", "BODY.LEFT, 11, 11, 20.", f"*{card}{options}",
                                f"{face}, 300., 4.", times="0.25, 1.",
                                first="*STEP, AMPLITUDE=STEP"))
        return deck, [("NT", "BODY.RIGHT", 0.25, faces[1], 1e-10)]

    follows(tmp_path, make, "", f", {keyword}=TENT")


# Amplitudes: the pressure on top of the block, followed over two steps.

def cycled(first=0.0, factor=1.0, timing=""):
    """Return a block under a pressure of 4 with an amplitude that rises from a time to a factor,
    which it has one time unit later, in two equal steps; and its stress."""
    deck = block(f"*AMPLITUDE, NAME=RISE{timing}", f"{first!r}, 0., {first + 1.0!r}, {factor!r}",
                 *static("*DLOAD, AMPLITUDE=RISE", "3, P3, 4.", "4, P3, 4.", times="0.25, 1."),
                 *static("*DLOAD, AMPLITUDE=RISE", "3, P3, 4.", "4, P3, 4.", times="0.25, 1."))
    rows = []
    for time in (0.25, 0.75, 1.25, 1.75):
        own = time if "TOTAL" in timing else time % 1.0
        rows += [("S22", "BODY", time, -4.0 * factor * min(max(own - first, 0.0), 1.0), SMALL,
                  "ABS")]
    return deck, rows


@pytest.mark.changes("AMPLITUDE")
@pytest.mark.parametrize(("one", "other"), [((0.0, 1.0), (0.5, 1.0)), ((0.0, 1.0), (0.0, 0.8))])
def test_times_and_factors_of_an_amplitude(tmp_path, one, other):
    follows(tmp_path, lambda values: cycled(*values), one, other)


@pytest.mark.changes("AMPLITUDE, TIME")
@pytest.mark.parametrize("first", [0.0, 0.5])
def test_time_of_an_amplitude(tmp_path, first):
    follows(tmp_path, lambda timing: cycled(first, timing=timing), ", TIME=STEP TIME",
            ", TIME=TOTAL TIME")


def driven(parameters, data, factors):
    """Return the cards of a block whose top follows an amplitude, and its factors at the end of
    each quarter of the step."""
    deck = block("*STEP", "*STATIC", "0.25, 1.", "*BOUNDARY, AMPLITUDE=COURSE",
                 "BODY.TOP, 2, 2, 0.01", "*END STEP")
    at = next(k for k, card in enumerate(deck) if card.startswith("*STEP"))
    return [*deck[:at], f"*AMPLITUDE, NAME=COURSE{parameters}", data, *deck[at:]], [
        ("U2", "BODY.TOP", 0.25 * (k + 1), 0.01 * factor, 1e-12, "ABS")
        for k, factor in enumerate(factors)]


@pytest.mark.changes("AMPLITUDE, DEFINITION")
def test_definition_of_an_amplitude(tmp_path):
    """Smooth: x³ (10 - 15 x + 6 x²) of the step from point to point."""
    courses = {"TABULAR": (0.25, 0.5, 0.75, 1.0), "SMOOTH STEP": (53 / 512, 0.5, 459 / 512, 1.0)}
    follows(tmp_path, lambda kind: driven(f", DEFINITION={kind}", "0., 0., 1., 1.", courses[kind]),
            *courses)


@pytest.mark.changes("AMPLITUDE, FIXED INTERVAL")
def test_interval_of_an_amplitude(tmp_path):
    courses = {"0.25": (1.0, 0.4, 0.4, 0.4), "0.5": (0.5, 1.0, 0.7, 0.4)}
    follows(tmp_path, lambda interval: driven(
        f", DEFINITION=EQUALLY SPACED, FIXED INTERVAL={interval}", "0., 1., 0.4",
        courses[interval]), *courses)


@pytest.mark.changes("AMPLITUDE, BEGIN")
def test_begin_of_an_amplitude(tmp_path):
    courses = {"0.": (0.5, 1.0, 0.7, 0.4), "0.25": (0.0, 0.5, 1.0, 0.7)}
    follows(tmp_path, lambda begin: driven(
        f", DEFINITION=EQUALLY SPACED, FIXED INTERVAL=0.5, BEGIN={begin}", "0., 1., 0.4",
        courses[begin]), *courses)


# Increments of the three analyses.

ANALYSES = {
    "STATIC": lambda card, *loads: block("*STEP", card, *loads, "*DLOAD", *DOWN, "*END STEP"),
    "HEAT TRANSFER": lambda card, *loads: cold_bar(
        "*STEP", card, *loads, "*BOUNDARY", "BODY.RIGHT, 11, 11, 40.", "*END STEP"),
    "COUPLED TEMPERATURE-DISPLACEMENT": lambda card, *loads: cold_bar(
        *ROLLERS, "*STEP", card, *loads, "*BOUNDARY", "BODY.RIGHT, 11, 11, 40.", "*END STEP"),
}
STEADY = {"STATIC": ""}


def times_of(result):
    """Return the times of the increments."""
    with h5py.File(result) as file:
        return file["history/time"][()]


@pytest.mark.parametrize("analysis", [pytest.param(name, marks=pytest.mark.changes(name))
                                      for name in ANALYSES])
def test_increments_are_those_of_the_analysis(tmp_path, analysis):
    """The first field is their size, the second the length of the step; both default to 1."""
    card = f"*{analysis}{STEADY.get(analysis, ', STEADY STATE')}"
    decks = {}
    for data, times in (("0.25, 1.", [0.25, 0.5, 0.75, 1.0]), ("0.5, 1.", [0.5, 1.0]),
                        ("0.5, 1.5", [0.5, 1.0, 1.5]), ("0.5", [0.5, 1.0]), (", 2.", [1.0, 2.0])):
        decks[data] = ANALYSES[analysis](card, data)
        result = judge(tmp_path, decks[data], [("time", "", "LAST", times[-1], 1e-12)])
        np.testing.assert_allclose(times_of(result), times, rtol=1e-12)
    note_changes(decks["0.25, 1."], decks["0.5, 1."])


@pytest.mark.parametrize("analysis", [pytest.param(name, marks=pytest.mark.changes(
    f"{name}, DIRECT")) for name in ANALYSES])
def test_direct_increments_land_on_nothing_else(tmp_path, analysis):
    """Without DIRECT they land on the corners of an amplitude and on the times of checks, which
    are errors with it where no increment ends."""
    card = f"*{analysis}{STEADY.get(analysis, ', STEADY STATE')}"
    corner = ["*AMPLITUDE, NAME=CORNER", "0., 1., 0.6, 2.", "*STEP"]
    free, direct = [], []
    for deck, more in ((free, ""), (direct, ", DIRECT")):
        for line in ANALYSES[analysis](card + more, "0.25, 1.", "*BOUNDARY, AMPLITUDE=CORNER",
                                       "BODY.LEFT, 1"):
            deck += corner if line == "*STEP" else [line]
    result = judge(tmp_path, free, [("time", "", 0.3, 0.3, 1e-12)])
    np.testing.assert_allclose(times_of(result), [0.25, 0.3, 0.5, 0.6, 0.75, 1.0], rtol=1e-12)
    judge(tmp_path, direct, [("time", "", 0.3, 0.3, 1e-12)], status=1)
    result = judge(tmp_path, direct, [("time", "", 0.25, 0.25, 1e-12)])
    np.testing.assert_allclose(times_of(result), [0.25, 0.5, 0.75, 1.0], rtol=1e-12)
    note_changes(free, direct)


def direct(cards):
    """Return a deck whose increments stay as they are given."""
    return ["*STATIC, DIRECT" if card == "*STATIC" else card for card in cards]


@pytest.mark.changes("STEP, INC")
def test_a_direct_step_with_more_increments_than_inc_is_refused(tmp_path):
    decks = [direct(block(*static("*DLOAD", *DOWN, first=f"*STEP, INC={n}", times="0.25, 1.")))
             for n in (4, 3)]
    judge(tmp_path, decks[0], [("S22", "BODY", "LAST", -5.0, SMALL)])
    judge(tmp_path, decks[1], [("S22", "BODY", "LAST", -5.0, SMALL)], status=1)
    note_changes(*decks)


@pytest.mark.parametrize(("increments", "status"), [(100, 0), (101, 1)])
def test_a_direct_step_has_a_hundred_increments_without_inc(tmp_path, increments, status):
    judge(tmp_path, direct(block(*static("*DSLOAD", "BODY.TOP, P, 5.",
                                         times=f"1., {increments}."))),
          stressed([0.0, -5.0, 0.0]), status=status)


# Supports and given temperatures: every field.

@pytest.mark.changes("BOUNDARY")
@pytest.mark.parametrize(("one", "other"), [
    ("1, 1", "2, 2"), ("1", "1, 2"), ("1, 1, 0.001", "1, 1, 0.002"), ("1, 2, 0.001", "1, 1, 0.001"),
])
def test_degrees_of_freedom_of_a_support(tmp_path, one, other):
    """Of the right side of an element that is held at its left and pulled both ways at its right:
    what is prescribed there moves as said, what is free has no reaction."""
    cards = mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS4")
    right = [n for n, (x, _) in nodes_of(cards).items() if x == 1.0]
    forces = 5.0, 3.0

    def make(fields):
        numbers = [field.strip() for field in fields.split(",")]
        first, last = int(numbers[0]), int((numbers + [numbers[0]])[1])
        value = float((numbers + ["0", "0"])[2]) if len(numbers) > 2 else 0.0
        deck = [*cards, *material("BODY", (YOUNG, 0.0)), "*BOUNDARY", "BODY.LEFT, 1, 2",
                "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", f"BODY.RIGHT, {fields}",
                "*CLOAD", *(f"{n}, {k + 1}, {f!r}" for n in right for k, f in enumerate(forces)),
                "*END STEP"]
        rows = []
        for k, force in enumerate(forces):
            if first <= k + 1 <= last:
                rows += [(f"U{k + 1}", "BODY.RIGHT", "LAST", value, 1e-14, "ABS")]
                continue
            rows += [(f"RF{k + 1}", "BODY.RIGHT", "LAST", 0.0, SMALL, "ABS")]
        return deck, rows

    follows(tmp_path, make, one, other)


def test_what_stands_before_the_first_step_ends_there_with_new(tmp_path):
    """It belongs to the first step otherwise."""
    def make(op):
        deck = block("BODY.TOP, 2, 2, 0.01", *static(f"*BOUNDARY, OP={op}", *ROLLERS[1:]))
        free = stressed([0.0, 0.0, 0.0])
        return deck, [("U2", "BODY.TOP", "LAST", 0.01, 1e-12)] if op == "MOD" else free

    follows(tmp_path, make, "MOD", "NEW")


ONCE = {"CLOAD": stressed([0.0, -10.0, 0.0]), "DLOAD": stressed([0.0, -10.0, 0.0]),
        "DSLOAD": stressed([0.0, -10.0, 0.0]), "CFLUX": at_right(2 * 10.0 * LENGTH / K),
        "DFLUX": at_right(2 * 10.0 * LENGTH / K)}


@pytest.mark.parametrize("load", ONCE)
@pytest.mark.parametrize("cards", [1, 2])
def test_loads_of_one_step_on_one_place_add_up(tmp_path, load, cards):
    """On one card and on two."""
    model, step, rows, _, _ = REPLACED[load]
    again = [f"*{load}"] if cards == 2 else []
    checks = [(q, w, "LAST" if t == 2.0 else t, v, *more) for q, w, t, v, *more in ONCE[load]]
    judge(tmp_path, model(*step(f"*{load}", *rows, *again, *rows)), checks)


@pytest.mark.parametrize("cards", [1, 2])
def test_of_films_and_given_temperatures_the_last_of_a_step_holds(tmp_path, cards):
    hot, last = (50.0, 2.0), (80.0, 3.0)
    again = ["*FILM"] if cards == 2 else []
    _, faces = conduction.wall(LENGTH, K, 20.0, last[0], film_cold=last[1])
    judge(tmp_path, bar(*heat("*BOUNDARY", "BODY.LEFT, 11, 11, 20.", "*FILM",
                              f"2, F2, {hot[0]}, {hot[1]}", *again,
                              f"2, F2, {last[0]}, {last[1]}")),
          [("NT", "BODY.RIGHT", "LAST", faces[1], SMALL)], name="films")
    again = ["*TEMPERATURE"] if cards == 2 else []
    judge(tmp_path, held_hot(*static("*TEMPERATURE", "BODY, 50.", *again, "BODY.RIGHT, 70.")),
          [("NT", "BODY.LEFT", "LAST", 50.0, SMALL), ("NT", "BODY.RIGHT", "LAST", 70.0, SMALL)],
          name="temperatures")


def test_later_initial_temperatures_replace_earlier_ones(tmp_path):
    deck = held_hot("*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY.RIGHT, 30.", *static())
    judge(tmp_path, deck, [("NT", "BODY.LEFT", "LAST", 0.0, 0.0, "ABS"),
                           ("NT", "BODY.RIGHT", "LAST", 30.0, SMALL)])


def test_given_temperatures_end_where_heat_is_solved(tmp_path):
    """And are kept by a step of mechanics behind it; the heat of the second step is that of its
    own ends."""
    deck = bar("*BOUNDARY", "BODY.LEFT, 1", "BODY.BOTTOM, 2", *static("*TEMPERATURE", "BODY, 50."),
               *heat("*BOUNDARY", "BODY.LEFT, 11, 11, 20.", "BODY.RIGHT, 11, 11, 40."), *static())
    judge(tmp_path, deck, [("NT", "BODY", 1.0, 50.0, SMALL),
                           ("NT", "BODY.RIGHT", 3.0, 40.0, SMALL),
                           ("NT", "BODY.LEFT", 3.0, 20.0, SMALL)])


def test_degrees_of_freedom_out_of_the_plane_are_passed_over(tmp_path):
    judge(tmp_path, block(*static("*BOUNDARY", "BODY.TOP, 3, 6", "*DLOAD", *DOWN)),
          stressed([0.0, -5.0, 0.0]))
