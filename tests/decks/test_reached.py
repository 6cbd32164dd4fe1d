"""*VERIFY of the time at which a value reaches another one: linear courses, whose times are known."""

import json
import math
import re

import h5py
import pytest
from blocks import write
from deck_runs import run
from physics import material, mesh, nodes_of
from test_prints import BLOCK, BODY, CONDUCTIVITY, HELD, POISSON, YOUNG, static
from test_restart import go_on

START, HOT = 20.0, 120.0   # at 0 and 0.4; START again at 1
WARM = [*BODY, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"BLOCK, {START!r}",
        "*AMPLITUDE, NAME=UP, VALUE=RELATIVE", f"0., {START / HOT!r}, 0.4, 1., 1., {START / HOT!r}",
        "*STEP", "*HEAT TRANSFER, STEADY STATE", "0.1, 1.", "*BOUNDARY", f"BLOCK.BOTTOM, 11, 11, {START!r}",
        "*BOUNDARY, AMPLITUDE=UP", f"BLOCK.TOP, 11, 11, {HOT!r}", "*END STEP"]
DOWN = (1 - POISSON**2) / YOUNG


def pressed(pressure=6.0, times="0.2, 1."):
    """Return a block under a pressure that ramps."""
    return [*BODY, *static(*HELD, "*DLOAD", f"BLOCK, P3, {pressure!r}", "*NODE FILE, FREQUENCY=0",
                           times=times)]


def judged(folder, cards, *checks, status=0):
    """Solve cards with checks; return the checks of --json and what was said."""
    deck = write(folder / "deck.inp", cards, ["*VERIFY, KIND=ANALYTIC, SOURCE=\"linear\"", *checks])
    process = run("run", deck, "--json", "--out", folder)
    assert process.returncode == status, process.stderr
    return json.loads(process.stdout)["checks"], process.stderr


@pytest.mark.parametrize(("cards", "check"), [
    (WARM, "NT reaches 70., BLOCK.TOP, LAST, 0.2"),
    (WARM, "NT reaches 45., BLOCK.TOP, LAST, 0.1"),       # the end of an increment
    (WARM, "nt  Reaches  3.25E1, MAX, LAST, 0.05"),       # in the first one, from the initial state
    (WARM, "NT reaches 70., BLOCK.TOP, 0.3, 0.2"),
    (WARM, "RFL reaches -250., 1, LAST, 0.1"),
    (pressed(), f"U2 reaches {-3.0 * DOWN!r}, BLOCK.TOP, LAST, 0.5"),
    (pressed(), "S22 reaches -3., BLOCK, LAST, 0.5"),     # fields are written at the end alone
    (pressed(), "load reaches 0.7, , LAST, 0.7"),
], ids=lambda value: value if isinstance(value, str) else "")
def test_times_of_linear_courses_pass_and_others_fail(tmp_path, cards, check):
    if "RFL" in check:   # what enters at a corner of the bottom: a sixth of half of an element
        check = f"RFL reaches {-CONDUCTIVITY * 25.0 * 0.5 / 6!r}, 1, LAST, 0.1"
    found, _ = judged(tmp_path, cards, f"{check}, 1.E-9")
    assert found[0]["passed"] and "uncertainty" not in found[0]   # of the last increment alone
    found, said = judged(tmp_path, cards, f"{check}01, 1.E-9", status=4)
    assert not found[0]["passed"] and "expected " in said


def test_a_check_has_its_words_and_its_time(tmp_path):
    (found,), _ = judged(tmp_path, WARM, "NT reaches 70., BLOCK.TOP, LAST, 0.2, 1.E-9")
    assert found["quantity"] == "NT reaches 70" and found["where"] == "BLOCK.TOP"
    assert found["found"] == pytest.approx(0.2, rel=1e-12) and found["time"] == 1.0
    assert " NT reaches 70            BLOCK.TOP " in (tmp_path / "deck.lst").read_text()


@pytest.mark.parametrize(("cards", "check"), [
    (WARM, "NT reaches 130., BLOCK.TOP, LAST"),
    (WARM, "NT reaches 110., BLOCK.TOP, 0.3"),     # later than that
    (pressed(), "S22 reaches 1., BLOCK, LAST"),
])
def test_what_is_never_reached_has_no_value(tmp_path, cards, check):
    (found,), said = judged(tmp_path, cards, f"{check}, 1., 1.E9", status=4)
    assert found["reason"] == "never reached" and not {"found", "time"} & set(found)
    assert "expected 1, but never reached" in said
    assert "failed: never reached" in (tmp_path / "deck.lst").read_text()


def test_what_a_part_of_a_set_reaches_is_told_with_how_many_do_not(tmp_path):
    """The bottom of the block keeps its temperature."""
    (found,), _ = judged(tmp_path, WARM, "NT reaches 110., BLOCK, LAST, 1., 1.E9", status=4)
    below = sum(y < 0.9 for _, y in nodes_of(BLOCK).values())
    told = f"never reached by {below} of the {len(nodes_of(BLOCK))} values; MIN or MAX asks for a single one"
    assert found["reason"] == told and not {"found", "time"} & set(found)


def test_a_set_is_judged_at_its_worst_node(tmp_path):
    """At half of the height the temperature is half of the way from START."""
    pair = [n for n, place in nodes_of(BLOCK).items() if place in ((0.0, 0.5), (0.0, 1.0))]
    (found,), _ = judged(tmp_path, [*WARM, "*NSET, NSET=PAIR", *map(str, pair)],
                         "NT reaches 70., PAIR, LAST, 0.2, 0.3, ABS")
    assert found["found"] == pytest.approx(0.4, rel=1e-12)


def closing(times):
    """Return blocks with a gap of a fifth of the way: closed from 0.2 on, the pressure grows linearly."""
    lower = mesh("LOWER", [0.0, 0.5, 1.25], [-1.0, 0.0], first=101)
    return [*BLOCK, *lower, *material("BLOCK", (YOUNG, 0.0)), *material("LOWER", (YOUNG, 0.0)),
            "*SURFACE INTERACTION, NAME=FACES",
            "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "BLOCK.BOTTOM, LOWER.TOP",
            "*CLEARANCE, SLAVE=BLOCK.BOTTOM, MASTER=LOWER.TOP, VALUE=0.002",
            *static("*BOUNDARY", "LOWER.BOTTOM, 2", "101, 1", "1, 1", "BLOCK.TOP, 2, 2, -0.01",
                    times=times)]


def test_contact_is_passed_by_the_pressure_of_an_interface(tmp_path):
    # p = E (0.01 t - 0.002)/2
    found, _ = judged(tmp_path, closing("0.2, 1."), "pressure reaches 2., FACE, LAST, 0.6, 1.E-9",
                      "pressure reaches 2., FACE@0.5, LAST, 0.6, 1.E-9",
                      "normal_force reaches 1.25, , LAST, 0.4, 1.E-9")
    assert len(found) == 3 and all(each["passed"] for each in found)


@pytest.mark.parametrize("increment", [0.1, 0.15])
def test_a_gap_reaches_0_at_the_end_of_the_increment_in_which_it_closes(tmp_path, increment):
    """One of the first points of these blocks has a gap of 2E-18 there, by rounding."""
    cards = ["*OPTIONS, ERRORS=FULL", *closing(f"{increment!r}, 1.")]
    closed = increment * math.ceil(0.2 / increment - 1e-9)
    found, _ = judged(tmp_path, cards, *(f"gap reaches 0., {where}, LAST, {closed!r}, 1.E-9"
                                         for where in ("FACE", "MIN", "FACE@0.")))
    assert len(found) == 3 and found[1]["uncertainty"] <= increment + 1e-9


def test_a_run_that_goes_on_remembers_what_was_reached(tmp_path):
    """Before the state, and between it and the increment before."""
    checks = ["NT reaches 70., BLOCK.TOP, LAST, 0.2, 1.E-9", "NT reaches 30., MAX, LAST, 0.04, 1.E-9",
              "NT reaches 112.5, MAX, LAST, 0.37, 1.E-9"]
    judged(tmp_path, [*WARM[:-8], "*RESTART, WRITE", *WARM[-8:]], *checks)
    deck = tmp_path / "deck.inp"
    for time in (0.1, 0.3, 0.8):
        result = go_on(deck, deck.with_suffix(".vtkhdf"), tmp_path / f"from{time}", time)
        with h5py.File(result) as file:
            assert file["run"].attrs["verify_passed"] == 3


@pytest.mark.parametrize(("increment", "level"), [(0.3, 50.0), (0.15, 50.0), (0.3, 71.0), (0.4, 20.0), (0.25, 5.0)])
def test_the_time_at_which_a_block_has_cooled_is_within_its_uncertainty(tmp_path, increment, level):
    """A block so conductive that its temperature is even: exp(-t), by hand."""
    def cooled(errors):
        return [f"*OPTIONS, ERRORS={errors}", *BLOCK,
                *material("BLOCK", conductivity=1e6, density=1.0, specific_heat=1.0),
                "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BLOCK, 100.", "*STEP", "*HEAT TRANSFER, DIRECT",
                f"{increment!r}, 6.", "*FILM", "BLOCK, F3, 0., 1.", "*END STEP"]

    check = f"NT reaches {level!r}, 1, LAST, 1., 10., ABS"
    (found,), _ = judged(tmp_path, cooled("FULL"), check)
    error = abs(found["found"] - math.log(100.0 / level))
    assert 1e-6 < error < found["uncertainty"] < 20.0 * error
    (found,), _ = judged(tmp_path, cooled("LAST"), check)
    assert found["no_estimate"] == "path; ERRORS=FULL"


@pytest.mark.parametrize(("labels", "units"), [
    ("mm MPa W C s", (" s", " C", " W/mm^2")), ("mm MPa W C", ("", " C", " W/mm^2")), ("", ("", "", ""))])
def test_a_value_that_is_asked_for_has_its_unit_and_how_far_it_may_be_off_in_percent(tmp_path, labels, units):
    options = f'*OPTIONS, ERRORS=FULL, UNITS="{labels}"' if labels else "*OPTIONS, ERRORS=FULL"
    deck = write(tmp_path / "deck.inp", [options, *WARM, "*VERIFY, KIND=NONE", "NT reaches 70., BLOCK.TOP, LAST",
                                         "NT, MAX, 0.2", "HFL2, MIN, 0.2", "heat_imbalance, , LAST"])
    lines = run("run", deck, "--out", tmp_path).stdout.splitlines()
    told = [line.partition(": ")[2] for line in lines[-5:-1]]
    assert told[0].startswith("0.2 (no estimate: ") and told[0].endswith(f"){units[0]}")
    assert re.fullmatch(rf"70 \+- \S+ \(\S+ %\){units[1]}", told[1])
    assert told[2].startswith("-200 (") and told[2].endswith(f"){units[2]}")
    assert float(told[3]) < 1e-8   # a pure number


def test_a_value_is_asked_for_without_an_expectation(tmp_path):
    """It has its uncertainty, and fails no run where it does not exist."""
    deck = write(tmp_path / "deck.inp", ["*OPTIONS, ERRORS=FULL", *WARM, "*VERIFY, KIND=NONE",
                                         "NT reaches 70., 1, LAST", "NT, BLOCK.TOP, 0.2",
                                         "NT reaches 500., 1, LAST"])
    process = run("run", deck, "--json", "--out", tmp_path)
    assert process.returncode == 0 and "check failed" not in process.stderr
    said = run("run", deck, "--out", tmp_path).stdout
    assert re.search(r"\n  NT BLOCK.TOP at time 0.2, node \d+: 70 \+- ", said)
    assert "\n  NT reaches 500 1: never reached\n" in said
    _, value, never = json.loads(process.stdout)["checks"]
    assert never["reason"] == "never reached" and "found" not in never
    assert value["found"] == pytest.approx(70.0) and value["uncertainty"] < 1e-9
    assert not {"expected", "tolerance", "deviation"} & value.keys()
