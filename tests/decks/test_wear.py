"""Wear of faces: Archard's law under a constant force, at a fixed interference, over temperatures;
beside sliding by any distance, friction, restart and uncertainties."""

import json
import re
from itertools import pairwise
from math import exp

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import run, solve, solve_as_written
from physics import follows, material, mesh, verify
from test_restart import assert_same, go_on

YOUNG, LENGTH, PRESSURE = 1e5, 10.0, 100.0
K, SPEED = 1e-6, 100.0


def bar(increment=0.1, law=(f"{K}, 1.",), force=None, sliding="", friction=None, speed=SPEED,
        steps=1, count=None, temperature=None, width=1.0):
    """Return the cards of a bar on a wall that slides below it in the second step, its end held at
    an interference or pressed by a force; without a Poisson's ratio, so its pressure is uniform."""
    cards = [*mesh("BAR", [0.0, width / 2, width], [0.0, LENGTH / 2, LENGTH], "CPS4"),
             *mesh("WALL", [-20.0, 150.0], [-1.0, 0.0], "CPS4", first=101),
             *material("BAR", (YOUNG, 0.0)), *material("WALL", (YOUNG, 0.0)),
             "*SURFACE INTERACTION, NAME=I"]
    if friction:
        cards += ["*FRICTION", f"{friction!r}"]
    cards += ["*WEAR", *law, f"*CONTACT PAIR, INTERACTION=I, NAME=C{sliding}",
              "BAR.BOTTOM, WALL.TOP"]
    if temperature is not None:
        cards += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"BAR, {temperature}",
                  f"WALL, {temperature}"]
    cards += ["*BOUNDARY", "WALL, 1, 2", "BAR.TOP, 1"]
    if not friction:
        cards += ["BAR.BOTTOM, 1"]
    cards += ["*STEP", "*STATIC", "1., 1."]
    if force is None:
        cards += ["*BOUNDARY", f"BAR.TOP, 2, 2, {-PRESSURE * LENGTH / YOUNG!r}"]
    else:
        cards += ["*DSLOAD", f"BAR.TOP, P, {force!r}"]
    cards += ["*END STEP"]
    for k in range(steps):
        cards += ["*STEP, INC=100000", "*STATIC, DIRECT", f"{increment!r}, 1."]
        cards += [f"*WEAR, CYCLES={count!r}"] if count else []
        cards += ["*BOUNDARY", f"WALL, 1, 1, {(-1.0) ** (k + 1) * speed * ((k + 1) % 2)!r}",
                  "*END STEP"]
    return cards


def state(folder, cards, *arguments):
    """Solve a deck; return the quantities of its interface over time by their names."""
    result = solve(write(folder / "deck.inp", cards), *arguments)
    with h5py.File(result) as file:
        return {name: item[()] for name, item in file["contact/C"].items()}


def test_a_block_under_a_constant_force_wears_by_k_p_v_t(tmp_path):
    found = state(tmp_path, bar(force=PRESSURE))
    assert found["wear_slave"][-1] == pytest.approx(K * PRESSURE * SPEED, rel=1e-9)
    assert found["worn_volume_slave"][-1] == pytest.approx(K * PRESSURE * SPEED, rel=1e-9)


@pytest.mark.parametrize("heat", [0.0, 1.0])
def test_faces_that_slide_out_of_the_plane_wear_with_heat_of_friction_and_without(tmp_path, heat):
    cards = bar(force=PRESSURE, friction=0.1, speed=0.0)
    place = cards.index("*FRICTION")
    cards[place:place] = ["*GAP HEAT GENERATION", f"{heat!r}, 0.5, {SPEED!r}"]
    found = state(tmp_path, cards)
    # A time of 1 in each of both steps.
    assert found["wear_slave"][-1] == pytest.approx(2 * K * PRESSURE * SPEED, rel=1e-9)


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize("kind", ["CAX8", "CAX4"])
def test_a_disc_wears_on_its_axis_as_elsewhere(tmp_path, kind, pairing):
    """On the axis three-node sides give weight 0."""
    size, push, time = 4.0, 0.0018, 100.0
    cards = [*mesh("DISC", [0.0, 2.0, size], [0.0, size], kind), *mesh("BASE", [0.0, 2.0, size], [-size, 0.0], kind, first=101),
             *material("DISC", (YOUNG, 0.0)), *material("BASE", (YOUNG, 0.0)),
             "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.1", "*GAP HEAT GENERATION", "1., 0.5, 1.", "*WEAR", f"{K}, 1.",
             f"*CONTACT PAIR, INTERACTION=I, NAME=C, PAIRING={pairing}", "DISC.BOTTOM, BASE.TOP",
             "*BOUNDARY", "DISC, 1", "BASE, 1", "BASE.BOTTOM, 2", f"DISC.TOP, 2, 2, {-push!r}",
             "*STEP, INC=1000", "*STATIC, DIRECT", f"0.25, {time!r}", "*END STEP"]
    found = state(tmp_path, cards)
    # Worn while pushed evenly: 2 h p / E + w = d t / T, w' = K p v.
    rate = YOUNG * K / (2 * size)
    pressure = push / (K * time) * (1 - exp(-rate * time))
    assert found["pressure"][-1] == pytest.approx(pressure, rel=2e-3)
    assert found["wear_slave"][-1] == pytest.approx(push - 2 * size * pressure / YOUNG, rel=2e-3)


def test_a_bar_at_a_fixed_interference_loses_its_pressure_with_the_first_order(tmp_path):
    exact = PRESSURE * exp(-K * YOUNG * SPEED / LENGTH)
    errors = []
    for n in (10, 20, 40):
        found = state(tmp_path, bar(1.0 / n))
        # Euler's implicit rule, whose factor of an increment is known too.
        rule = PRESSURE * (1.0 + K * YOUNG * SPEED / LENGTH / n) ** -n
        assert found["pressure"][-1] == pytest.approx(rule, rel=1e-8)
        errors.append(abs(found["pressure"][-1][0] - exact))
    assert [a / b for a, b in pairwise(errors)] == pytest.approx([2.0, 2.0], rel=0.05)


@pytest.mark.parametrize("law", [f"{1e3 * K}, 1.", "1., 1."])
def test_increments_are_stable_however_fast_faces_wear(tmp_path, law):
    pressure = state(tmp_path, bar(0.25, law=(law,)))["pressure"].min(axis=1)
    assert np.all(np.diff(pressure[1:]) < 0.0) or pressure[-1] < 1e-9 * PRESSURE
    assert np.all(pressure >= 0.0)


def test_frictionless_faces_wear_as_others(tmp_path):
    with_friction = state(tmp_path, bar(0.05, friction=0.01, force=PRESSURE, width=40.0))
    without = state(tmp_path, bar(0.05, force=PRESSURE, width=40.0))
    assert with_friction["shear_force"][-1] == pytest.approx(-0.01 * 40.0 * PRESSURE)
    # The bar itself gives way by a hundredth of a millimetre before it slips.
    assert with_friction["worn_volume_slave"][-1] == pytest.approx(
        without["worn_volume_slave"][-1], rel=1e-3)


@pytest.mark.parametrize("sliding", ["", ", SLIDING=FINITE"])
def test_the_volume_is_k_times_the_work_of_friction_over_mu(tmp_path, sliding):
    result = solve(write(tmp_path / "deck.inp", bar(0.05, friction=0.2, width=40.0, sliding=sliding)))
    with h5py.File(result) as file:
        work, worn = file["history/ALLFD"][()], file["contact/C/worn_volume_slave"][()]
    assert worn[-1] > 0.5 * K * PRESSURE * SPEED * 40.0
    assert worn == pytest.approx(K * work / 0.2, rel=1e-8)


@pytest.mark.changes("WEAR")
def test_the_law_is_that_of_the_card(tmp_path):
    def make(rate):
        depth = rate * PRESSURE * SPEED
        return bar(force=PRESSURE, law=(f"{rate!r}, 1.",)), [("wear_slave", "MAX", "LAST", depth,
                                                              1e-8)]

    follows(tmp_path, make, K, 2 * K)


@pytest.mark.changes("WEAR, CYCLES")
def test_the_slip_of_a_step_stands_for_many_cycles(tmp_path):
    def make(count):
        return bar(force=PRESSURE, count=count), [
            ("wear_slave", "MAX", "LAST", count * K * PRESSURE * SPEED, 1e-8)]

    follows(tmp_path, make, 10.0, 1000.0)


def test_the_master_loses_the_rest_of_the_depth(tmp_path):
    found = state(tmp_path, bar(force=PRESSURE, law=(f"{K}, 0.25",)))
    depth = K * PRESSURE * SPEED
    assert found["wear_slave"][-1] == pytest.approx(0.25 * depth, rel=1e-8)
    assert found["wear_master"][-1] == pytest.approx(0.75 * depth, rel=1e-8)
    assert found["worn_volume_master"][-1] == pytest.approx(0.75 * depth, rel=1e-8)


def test_the_rate_is_that_of_the_faces_temperature(tmp_path):
    law = (f"{K}, 1., 0.", f"{3 * K}, 1., 100.")
    found = state(tmp_path, bar(force=PRESSURE, law=law, temperature=50.0))
    assert found["wear_slave"][-1] == pytest.approx(2 * K * PRESSURE * SPEED, rel=1e-8)


def test_wear_goes_with_a_slave_that_slides_by_any_distance(tmp_path):
    """What the slave loses opens its gap wherever it is; what the master loses stays behind."""
    small = state(tmp_path, bar(0.01, speed=SPEED))
    finite = state(tmp_path, bar(0.01, sliding=", SLIDING=FINITE"))
    assert finite["pressure"][-1] == pytest.approx(small["pressure"][-1], rel=1e-6)
    hard = state(tmp_path, bar(0.01, sliding=", SLIDING=FINITE", law=(f"{K}, 0.",)))
    assert hard["pressure"][-1] == pytest.approx(PRESSURE, rel=1e-6)
    assert hard["worn_volume_master"][-1] == pytest.approx(K * PRESSURE * SPEED, rel=1e-6)


@pytest.mark.parametrize("rate", [1e-6, 1e-20])
def test_a_pad_that_is_only_pressed_needs_no_smaller_increment(tmp_path, rate):
    """Its wear is far below what the bodies give way, where rounding of slip must not count."""
    edges = np.linspace(0.0, 8.0, 9)
    cards = [*mesh("PAD", [*edges], [0.0, 1.0, 2.0, 3.0, 4.0], "CPE4I"),
             *mesh("RAIL", [*np.linspace(-4.0, 26.0, 31)], [-6.0, -4.5, -3.0, -1.5, 0.0], "CPE4I",
                   first=501),
             *material("PAD", (2000.0, 0.3)), *material("RAIL", (2.1e5, 0.3)),
             "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.25", "*WEAR", f"{rate!r}, 1.",
             "*CONTACT PAIR, INTERACTION=I, NAME=C, SLIDING=FINITE", "PAD.BOTTOM, RAIL.TOP",
             "*BOUNDARY", "RAIL.BOTTOM, 1, 2", "PAD.TOP, 1", "*STEP", "*STATIC, DIRECT", "1., 1.",
             "*DSLOAD", "PAD.TOP, P, 2.", "*END STEP"]
    assert state(tmp_path, cards)["normal_force"][-1] == pytest.approx(16.0, rel=1e-5)


@pytest.mark.parametrize("tail", ["FULL", "SPARSE"])
@pytest.mark.parametrize("rate", [1e-7, 1e-10])
def test_however_little_faces_wear_it_is_k_p_and_the_slip(tmp_path, rate, tail):
    """Of an elastic block that is pressed and pushed, in each increment: slip is not uniform."""
    found = state(tmp_path, [
        *mesh("UP", [0.5, 1.3, 2.0], [0.0, 1.0], "CPE8", first=101),
        *mesh("LOW", [0.0, 1.0, 2.0, 3.0], [-1.0, 0.0], "CPE8"),
        *material("UP", (2e5, 0.3)), *material("LOW", (1e5, 0.3)),
        "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.1", "*WEAR", f"{rate!r}",
        "*CONTACT PAIR, INTERACTION=I, NAME=C, SLIDING=FINITE", "UP.BOTTOM, LOW.TOP",
        f"*SOLVER, TAIL={tail}", "*BOUNDARY", "LOW.BOTTOM, 1, 2", "*STEP", "*STATIC, DIRECT",
        "0.25, 1.", "*BOUNDARY", "UP.TOP, 1, 1, 0.005", "*DSLOAD", "UP.TOP, P, 300.", "*END STEP"])
    slip = np.abs(np.diff(found["slip"], axis=0))
    depth = np.diff(found["wear_slave"], axis=0)
    assert depth.max() > 0.0
    np.testing.assert_allclose(depth, rate * found["pressure"][1:] * slip, rtol=1e-7,
                               atol=1e-7 * depth.max())


def test_a_motion_to_and_fro_wears_both_ways(tmp_path):
    found = state(tmp_path, bar(0.1, force=PRESSURE, steps=2))
    assert found["wear_slave"][-1] == pytest.approx(2 * K * PRESSURE * SPEED, rel=1e-8)


@pytest.mark.parametrize("sliding", [False, True])
def test_a_run_goes_on_from_a_worn_state_to_the_last_bit(tmp_path, sliding):
    if sliding:
        cards = bar(0.1, friction=0.1, sliding=", SLIDING=FINITE")
    else:
        cards = bar(0.1, friction=0.3, speed=0.02, law=(f"{3e3 * K}, 1.",), width=1.7)
        cards.insert(cards.index("*STEP"),
                     "*CLEARANCE, SLAVE=BAR.BOTTOM, MASTER=WALL.TOP, VALUE=0.00123")
    whole = solve_as_written(write(tmp_path / "deck.inp", ["*RESTART, WRITE", *cards]))
    for at in (1.5,) if sliding else (1.3, 1.5, 1.7, 1.8):
        assert_same(whole, go_on(tmp_path / "deck.inp", whole, tmp_path / f"from{at}", at))


def test_its_uncertainty_holds_the_exact_volume(tmp_path):
    exact = (PRESSURE - PRESSURE * exp(-K * YOUNG * SPEED / LENGTH)) * LENGTH / YOUNG
    deck = write(tmp_path / "deck.inp", ["*OPTIONS, ERRORS=FULL", *bar(0.05)],
                 verify(("worn_volume_slave", "C", "LAST", 2 * exact, 1e-3)))
    told = run("run", "--quiet", deck, "--out", tmp_path).stderr
    value, half = map(float, re.search(r": (\S+) \+- ([^\s,]+)", told).groups())
    assert abs(value - exact) < half < 5 * abs(value - exact)


@pytest.mark.parametrize(("errors", "reason"), [("LAST", "*VERIFY; ERRORS=FULL"),
                                                ("FULL", "only for *VERIFY"), ("NO", "ERRORS=NO")])
def test_without_a_check_it_says_what_estimates_it(tmp_path, errors, reason):
    """The master does not wear."""
    deck = write(tmp_path / "deck.inp", [f'*OPTIONS, ERRORS={errors}, UNITS="mm MPa W C"',
                                         *bar(0.25)])
    found = json.loads(run("run", "--json", deck, "--out", tmp_path).stdout)
    for side in ("slave", "master"):
        told = found["summary"]["interfaces"]["C"][f"worn_volume_{side}"]
        assert told["no_estimate"] == reason and "uncertainty" not in told
    value = found["summary"]["interfaces"]["C"]["worn_volume_slave"]["value"]
    (line,) = re.findall("^ +worn volume .*", (tmp_path / "deck.lst").read_text(), re.M)
    told, rest = re.fullmatch(r" +worn volume +(\S+) (.*)", line).groups()
    assert float(told) == pytest.approx(value, rel=1e-5)
    assert rest.rstrip() == f"(no estimate: {reason}) mm^3, slave"
