"""Runs with steps that store heat: repeated increments, signals, batches, checks, settings."""

import csv
import re
import signal
import subprocess
import time
from contextlib import suppress

import h5py
import numpy as np
import pytest
import transients as two
from blocks import write
from deck_runs import PATIENCE, PROGRAM, assert_alike, datasets, run, solve
from physics import judge, material, mesh

TIGHT = ["*FIXED POINT, TOL=1.E-12"]
EVERYWHERE = "contact", "history", "VTKHDF/PointData"
ROUNDING = "heat_imbalance", "heat_imbalance_pointwise", "force_imbalance"

# Increments that are repeated: bodies, contact, method, step, and how the reason begins.
FEW_PASSES = ["*FIXED POINT, METHOD=PICARD, TOL=1.E-12, MAXITER=4"]
APART = two.contact() + ["*CLEARANCE, MASTER=LOWER.TOP, SLAVE=UPPER.BOTTOM, VALUE=1.E-3"]
SLIDING = two.bodies(held=["LOWER.BOTTOM, 1, 2"])
RUBBING = two.contact(laws=["*FRICTION", "0.2", *two.LAWS])
SLIDE = ("*BOUNDARY", f"UPPER.TOP, 2, 2, {two.PRESSED!r}", "UPPER.TOP, 1, 1, 0.004")
STILL = ("*BOUNDARY", "UPPER.TOP, 2, 2, 0.")
REPEATED = {
    "too few passes": (two.bodies(), two.contact(), FEW_PASSES, {"how": ", LOCAL ERROR=1."},
                       "the conductance does not converge"),
    "error in time": (two.bodies(), two.contact(), [], {"how": ""}, "its temperatures err by"),
    "DELTMX": (two.bodies(), two.contact(), [], {"how": ", LOCAL ERROR=1., DELTMX=4."},
               "a temperature changes by"),
    "touch": (two.bodies(), APART, [], {"how": ", LOCAL ERROR=1.", "pressed": STILL},
              "contact pair FACE touches or parts"),
    "with friction": (SLIDING, RUBBING, [], {"how": "", "pressed": SLIDE},
                      "its temperatures err by"),
    "with heat of strains": (two.bodies(), two.contact(), [], {"how": ", DILATATION=YES"},
                             "its temperatures err by"),
}


def attempts(result):
    """Return the reasons of the attempts that are not kept, as the listing gives them."""
    listing = " ".join(result.with_suffix(".lst").read_text().split())
    return re.findall(r"attempt \d+ of size \S+, to time \S+, not kept: ([^;.]*)", listing)


@pytest.mark.parametrize(("case", "steps"), [
    *((case, 1) for case in REPEATED), ("with heat of strains", 2)])
def test_an_increment_that_is_repeated_starts_from_the_same_state(tmp_path, case, steps):
    """A run whose increments end at the same instants, none of which fails, finds the same."""
    bodies, contact, method, step, reason = REPEATED[case]
    first = f"{two.PERIOD!r}, {two.PERIOD!r}"
    heated = two.heated(times=first, **step)
    again = two.heated(times=first, **step | {"pressed": ()})[:-1] + ["*DFLUX", "LOWER, BF, 90.",
                                                                     "*END STEP"]
    course = heated + (again if steps == 2 else [])
    result = solve(two.write_deck(tmp_path / "repeated.inp", bodies, contact, TIGHT, method,
                                  course))
    assert any(words.startswith(reason) for words in attempts(result)), attempts(result)
    ends, = two.history(result, "time")
    points = ["*TIME POINTS, NAME=ENDS, TIME=TOTAL TIME", *map(repr, ends.tolist())]
    at_once = two.write_deck(
        tmp_path / "once.inp", bodies, contact, TIGHT, points,
        [re.sub(r", (LOCAL ERROR|DELTMX)=[^,]*", "", card) + ", LOCAL ERROR=1."
         if card.startswith(two.COUPLED) else card
         for card in course for card in (
             [card, "*NODE FILE, FREQUENCY=1, TIME POINTS=ENDS"]
             if card == first else [card])])
    once = solve(at_once)
    assert attempts(once) == []
    found, expected = datasets(result, *EVERYWHERE), datasets(once, *EVERYWHERE)
    for name in (*ROUNDING, "iterations"):
        del found[f"history/{name}"], expected[f"history/{name}"]
    assert_alike(expected, found, 1e-9)


# Signals

LONG, BEFORE = 200000, 100   # increments, those before a signal
FIXED = {"times": f"1.E-5, {1e-5 * LONG!r}"}


def lines_of(sta):
    """Return the lines of a .sta file without its heading and one that is being written."""
    with suppress(FileNotFoundError):
        return sta.read_text().rpartition("\n")[0].splitlines()[1:]
    return []


@pytest.fixture(scope="module")
def first_increments(tmp_path_factory):
    """Return a function that gives what the long run has found after some increments."""
    folder = tmp_path_factory.mktemp("first")

    def call(count):
        alone = two.two_blocks(folder / f"{count}.inp", times=f"1.E-5, {1e-5 * count!r}")
        return datasets(solve(alone), *EVERYWHERE)

    return call


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGKILL"])
def test_what_a_run_wrote_before_a_signal_is_valid(tmp_path, first_increments, name):
    """Its increments are those of a run that ends there; a kill may leave one more than .sta."""
    deck = two.two_blocks(tmp_path / "deck.inp", **FIXED)
    process = subprocess.Popen([PROGRAM, "run", "--quiet", str(deck), "--out", str(tmp_path)],
                               text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    until = time.monotonic() + PATIENCE
    while len(lines_of(tmp_path / "deck.sta")) < BEFORE:
        assert process.poll() is None and time.monotonic() < until
        time.sleep(0.002)
    process.send_signal(getattr(signal, name))
    _, said = process.communicate(timeout=PATIENCE)
    named = len(lines_of(tmp_path / "deck.sta"))
    found = datasets(tmp_path / "deck.vtkhdf", *EVERYWHERE)
    count = len(found["history/time"])
    assert BEFORE <= count < LONG
    if name == "SIGKILL":
        assert process.returncode == -signal.SIGKILL
        assert named <= count <= named + 1
    else:
        assert process.returncode == 5
        assert f"{deck}: error: ended by {name} after increment {count} (time " in said
        assert count == named
        assert not list(tmp_path.glob("*.tmp"))
    expected = first_increments(count)
    for each in ROUNDING:
        del found[f"history/{each}"], expected[f"history/{each}"]
    assert_alike(expected, found, 1e-12)


# Batches and settings

def test_a_batch_finds_what_single_runs_do(tmp_path):
    """To the last bit, beside a deck that does not converge."""
    decks = [two.two_blocks(tmp_path / "fixed.inp"), two.two_blocks(tmp_path / "free.inp", how=""),
             two.write_deck(tmp_path / "fails.inp", two.bodies(), two.contact(), [
                 "*FIXED POINT, METHOD=PICARD, TOL=1.E-12, MAXITER=2"], two.heated())]
    single = [datasets(solve(deck), *EVERYWHERE) for deck in decks[:2]]
    for jobs in (1, 2):
        folder = tmp_path / f"jobs{jobs}"
        process = run("run", *decks, "--out", folder, "--jobs", jobs)
        assert process.returncode == 2
        with (folder / "thercon-batch.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        assert [row["outcome"] for row in rows] == ["solved", "solved", "not converged"]
        for deck, row, expected in zip(decks, rows, single, strict=False):
            found = datasets(folder / f"{deck.stem}.vtkhdf", *EVERYWHERE)
            assert int(row["increments"]) == len(found["history/time"])
            assert_alike(expected, found, 0.0)


def test_settings_of_a_sweep_are_those_of_decks_of_their_own(tmp_path):
    """The film's temperature and the first increment are parameters of one deck."""
    def deck(name, hot, first, cards=()):
        step = [card.replace(f"F, {two.HOT!r}", f"F, {hot}")
                for card in two.heated(times=f"{first}, {two.PERIOD!r}", how="")]
        return two.write_deck(tmp_path / name, two.bodies(), two.contact(), TIGHT, cards, step)

    swept = deck("swept.inp", "<HOT>", "<FIRST>",
                 ["*PARAMETER", f"HOT = {two.HOT!r}", "FIRST = 0.05"])
    found = []
    for hot, first in ((60.0, 0.05), (90.0, 0.01)):
        one = datasets(solve(swept, "--set", f"HOT={hot}", "--set", f"FIRST={first}"), *EVERYWHERE)
        found.append(one["history/heat_in"][-1])
        assert_alike(datasets(solve(deck("own.inp", hot, first)), *EVERYWHERE), one, 0.0)
    assert found[1] > 1.2 * found[0]


# Checks

def squeezed(share, dilatation="YES"):
    """Return a block that is squeezed at a steady rate and stores heat of a source; T0 is 300."""
    young, poisson, alpha, period, rate = 1000.0, 0.25, 1e-3, 2.0, 0.004
    beta = young * alpha / (1 - 2 * poisson)
    heat, width, height = 7.0, 0.5, 1.0
    cards = ["*PHYSICAL CONSTANTS, ABSOLUTE ZERO=-280.",
             *mesh("BODY", [0.0, 0.2, width], [0.0, height]),
             *material("BODY", (young, poisson), alpha, 1.0, 1.0, 50.0),
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20.",
             "*STEP, AMPLITUDE=RAMP", f"{two.COUPLED}, DIRECT, DILATATION={dilatation}",
             f"0.25, {period!r}", "*BOUNDARY", "BODY, 1", "BODY.BOTTOM, 2",
             f"BODY.TOP, 2, 2, {-rate * period!r}", "*AMPLITUDE, NAME=ALL", "0., 1., 10., 1.",
             "*DFLUX, AMPLITUDE=ALL", f"BODY, BF, {heat!r}", "*END STEP"]
    at = cards.index("*AMPLITUDE, NAME=ALL")
    cards = cards[at:at + 2] + cards[:at] + cards[at + 2:]
    of_strains = -300.0 * beta * rate * width
    source = heat * width * height
    rows = [("heat_in", "", "LAST", source, 1e-9), ("heat_out", "", "LAST", 0.0, 1e-9, "ABS")]
    if dilatation == "NO":
        return cards, [*rows, ("heat_stored", "", "LAST", share * source, 1e-9)]
    for when in ("0.25", "LAST"):
        rows += [("heat_dilatation", "", when, share * of_strains, 1e-9),
                 ("heat_stored", "", when, share * (source - of_strains), 1e-9)]
    return cards, rows


@pytest.mark.parametrize("dilatation", ["YES", "NO"])
def test_stored_heat_and_heat_of_strains_are_judged(tmp_path, dilatation):
    """T0 beta:eps' of a block that cannot widen, and what a source gives beside it."""
    judge(tmp_path, *squeezed(1.0, dilatation))
    judge(tmp_path, *squeezed(1.01, dilatation), status=4)


def test_heat_that_grows_from_nothing_does_not_take_the_smallest_increment(tmp_path):
    """An insulated body at one temperature: rho c T' = q t/P, so that T - T0 = q t^2/(2 P rho c)."""
    start, load, period = 20.0, 40.0, 2.0
    deck = write(tmp_path / "grows.inp", mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPE8"), material(
        "BODY", None, None, 1.0, 3.0, 2.0), ["*AMPLITUDE, NAME=GROWS", f"0., 0., {period!r}, 1.",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"BODY, {start!r}", "*STEP, INC=1000",
        "*HEAT TRANSFER", f"0.1, {period!r}", "*DFLUX, AMPLITUDE=GROWS", f"BODY, BF, {load!r}",
        "*NODE FILE", "NT", "*END STEP"])
    with h5py.File(solve(deck)) as file:
        time = file["history/time"][()]
        found = file["VTKHDF/PointData/temperature"][()].reshape(len(time), -1)
    # Errors by the range so far let increments grow by a part of the time that has passed.
    assert time[0] > 1e-3
    rise = load * time**2 / (2 * period * 3.0 * 2.0)
    np.testing.assert_allclose(found, np.tile(start + rise, (found.shape[1], 1)).T,
                               atol=1e-3 * rise[-1])


def test_faces_that_loads_close_at_once_are_not_searched_for(tmp_path):
    """The upper block, 0.01 above the other one, is pushed onto it as the step begins."""
    deck = write(tmp_path / "closes.inp",
                 mesh("UP", [0.0, 1.0], [0.01, 1.01], "CPE8"),
                 mesh("LOW", [0.0, 1.0], [-1.0, 0.0], "CPE8", first=1001),
                 material("UP", (1000.0, 0.0), 1e-5, 1.0, 1.0, 1.0),
                 material("LOW", (1000.0, 0.0), 1e-5, 1.0, 1.0, 1.0),
                 ["*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=POWER", "0., 1., 1.",
                  "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "UP.BOTTOM, LOW.TOP",
                  "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "UP, 10.", "LOW, 0.", "*STEP, INC=500",
                  "*COUPLED TEMPERATURE-DISPLACEMENT", "0.05, 1.", "*BOUNDARY",
                  "UP.TOP, 2, 2, -0.05", "LOW.BOTTOM, 2", "UP, 1", "LOW, 1", "*END STEP"])
    listing = solve(deck).with_suffix(".lst").read_text()
    assert listing.count("touches or parts within it") <= 3
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        # Strains of 0.04 over both heights, E 1000 and nu 0; heat that is stored changes it little.
        np.testing.assert_allclose(file["contact/FACE/pressure"][0], 20.0, rtol=1e-2)


@pytest.mark.parametrize("start", [20.0, 293.15, -5.0])
def test_bodies_of_one_temperature_have_no_range_to_err_by(tmp_path, start):
    """Nothing heats them: they are pressed, and increments grow to the end."""
    deck = write(tmp_path / "pressed.inp",
                 mesh("BODY", [0.0, 1.0, 2.0], [0.0, 1.0, 2.0], "CPE8"),
                 material("BODY", (1000.0, 0.3), 1e-5, 1.0, 1.0, 1.0),
                 ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"BODY, {start!r}",
                  "*STEP, INC=40, AMPLITUDE=RAMP", "*COUPLED TEMPERATURE-DISPLACEMENT",
                  "1., 100.", "*BOUNDARY", "BODY.BOTTOM, 1, 2", f"BODY.BOTTOM, 11, 11, {start!r}",
                  "*DSLOAD", "BODY.TOP, P, 1.", "*END STEP"])
    with h5py.File(solve(deck)) as file:
        time = file["history/time"][()]
    assert time[0] == pytest.approx(1.0)
    assert len(time) < 12


def test_increments_too_short_to_change_what_many_nodes_hold_balance(tmp_path):
    """What rounding leaves of the heat of a body is that of all its nodes."""
    grid = [i / 40 for i in range(41)]
    deck = write(tmp_path / "short.inp", mesh("BODY", grid, grid, "DC2D4"),
                 material("BODY", elastic=None, conductivity=1e-3, density=1.0, specific_heat=1.0),
                 ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20.", "*STEP",
                  "*HEAT TRANSFER, DIRECT", "1.E-9, 3.E-9", "*DFLUX", "BODY, BF, 1.E-6", "*END STEP"])
    with h5py.File(solve(deck)) as file:
        np.testing.assert_allclose(file["history/heat_in"][()], 1e-6, rtol=1e-12)


@pytest.mark.parametrize(("how", "told"), [
    (", DELTMX=0.75", "kept short by DELTMX=0.75"), (", DELTMX=1.5", ""),
    (", LOCAL ERROR=1.E-8", "kept short by LOCAL ERROR=1E-8")])
def test_the_summary_says_what_makes_increments_of_a_step_many(tmp_path, how, told):
    """A bar that is heated by 100 in all, evenly or from one end: more than 100 increments."""
    heat = ["*DFLUX", "BAR, BF, 100."] if "DELTMX" in how else ["*BOUNDARY", "BAR.LEFT, 11, 11, 100."]
    cards = [*mesh("BAR", [0.0, 1.0, 2.0], [0.0, 1.0], "CPE4"), *material(
        "BAR", conductivity=1.0, density=1.0, specific_heat=1.0), "*INITIAL CONDITIONS, "
        "TYPE=TEMPERATURE", "BAR, 0."]
    step = ["*STEP, INC=1000000", f"*HEAT TRANSFER{how}", "0.01, 1.", *heat, "*END STEP"]
    process = run("run", write(tmp_path / "bar.inp", cards + step), "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    line = re.search(r"^  (\d+) increments in step 1, (.*)$", process.stdout, re.MULTILINE)
    assert (line[2] if line else "") == told
    if told:
        assert int(line[1]) > 100
    step[0] = "*STEP, INC=20"
    process = run("run", write(tmp_path / "few.inp", cards + step), "--out", tmp_path)
    assert ("of its period 1; a larger INC= allows more, a larger LOCAL ERROR=, CETOL= or DELTMX= "
            "takes fewer") in process.stderr


@pytest.mark.parametrize("deltmx", ["", ", DELTMX=50."])
def test_increments_grow_where_all_temperatures_are_prescribed(tmp_path, deltmx):
    """None of them is free, so none errs: the increments double from 0.01 on."""
    cards = [*mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS4"),
             *material("BODY", (2e5, 0.3), 1e-5, conductivity=10.0, density=1.0, specific_heat=3.0),
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20.", "*AMPLITUDE, NAME=UP", "0., 20., 10., 120.",
             "*STEP", f"*COUPLED TEMPERATURE-DISPLACEMENT{deltmx}", "0.01, 10.", "*BOUNDARY", "BODY.LEFT, 1", "BODY.BOTTOM, 2",
             "*BOUNDARY, AMPLITUDE=UP", "BODY, 11, 11, 1.", "*END STEP"]
    with h5py.File(solve(write(tmp_path / "deck.inp", cards))) as file:
        assert 8 <= len(file["history/time"]) <= 20
