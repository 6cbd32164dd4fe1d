"""A run that goes on from a state of its result equals one that was never interrupted, bit for bit."""

import csv
import os
import re
import shutil
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path

import h5py
import numpy as np
import pytest
import test_fixed_point_limits as limits
import test_rods as rods
import transients as two
from blocks import write
from changes import note_changes
from deck_runs import COUPLED, INPUT, PATIENCE, PROGRAM, copy_deck, run
from deck_runs import solve_as_written as solve
from physics import material, mesh, verify

EXAMPLES = INPUT / "examples"
WRITE = "*RESTART, WRITE"


def written(source, folder, card=WRITE, changes=(), cards=()):
    """Write a copy of a deck with its mesh and a *RESTART; return its path."""
    for beside in source.parent.glob("*"):
        if beside.suffix in {".mesh", ".gmsh", ".inc"}:
            shutil.copy(beside, folder)
    return copy_deck(source, folder / source.name, [*cards, card], changes)


def contents(result):
    """Return the numbers of a result and of its contact file, those of its states too."""
    found = {}

    def keep(name, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu":
            found[name] = item[()]

    for path in (result, result.with_suffix(".contact.vtkhdf")):
        if path.exists():
            with h5py.File(path) as file:
                file.visititems(lambda name, item, path=path: keep(path.name + name, item))
    return found


def assert_same(one, other, but="nothing"):
    """Assert that results are equal to the last bit, and their .sta and .cvg to the last letter."""
    whole, parts = ({name: values for name, values in contents(path).items() if but not in name}
                    for path in (one, other))
    assert whole.keys() == parts.keys()
    for name, values in whole.items():
        assert values.shape == parts[name].shape, name
        np.testing.assert_array_equal(parts[name], values, err_msg=name)
    for end in (".sta", ".cvg"):
        assert one.with_suffix(end).read_text() == other.with_suffix(end).read_text(), end


def kept(result, name="time"):
    """Return times, or other places, of the states that a result keeps."""
    with h5py.File(result) as file:
        places = file["restart/places"]
        return places[:, places.attrs["components"].split().index(name)]


def go_on(deck, result, folder, at=None):
    """Go on from a state of a result with results in another folder; return the new result."""
    place = f"{result}@{at!r}" if at is not None else str(result)
    process = run("run", "--quiet", deck, "--restart", place, "--out", folder)
    assert process.returncode in (0, 4), process.stderr
    return folder / result.name



# Friction that turns round, mortar points, a transient whose increments follow its error, with one
# that touches, a scheme with a past, uncertainties of complete finer runs.
@pytest.mark.parametrize(("name", "cards"), [
    ("thermal_cycling", ()),
    ("warm_blocks", ()),
    ("roller", ["*OPTIONS, ERRORS=FULL"]),
    ("warm_blocks", ["*OPTIONS, ERRORS=FULL"]),
    ("warm_blocks", ["*SOLVER, TYPE=MUMPS"]),
    ("two_rods", ["*THERMAL SCHEME, TYPE=GALERKIN"]),
    ("brake_pad", ["*SOLVER, TYPE=MUMPS"]),
    ("turbine_joint", ()),
])
def test_a_run_goes_on_to_the_last_bit(tmp_path, name, cards):
    deck = written(EXAMPLES / f"{name}.inp", tmp_path, cards=cards)
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode in (0, 4), process.stderr
    whole = deck.with_suffix(".vtkhdf")
    times = kept(whole)
    with h5py.File(whole) as file:
        np.testing.assert_array_equal(times, file["history/time"][()])
    for i in sorted({0, len(times) // 2} if cards else {0, len(times) // 2, len(times) - 2}):
        assert_same(whole, go_on(deck, whole, tmp_path / f"from{i}", float(times[i])))
    if "ERRORS=FULL" in "".join(cards):
        with h5py.File(whole) as file:
            assert len(file["uncertainty/time"]) == len(file["history/time"])
    shown = (tmp_path / "from0" / f"{name}.lst").read_text()
    assert f"goes on   {whole}, increment 1 (time " in shown


TABLES = {"0.045": "0.2, 0.\n0.01, 300.", "2.1E5, 0.\n": "2.1E5, 0., 0.\n1.E5, 0., 300.\n",
          "1.2E-5\n": "1.E-5, 0.\n1.4E-5, 300.\n", "480.\n": "480., 0.\n700., 300.\n"}


def test_properties_over_temperature_go_on_to_the_last_bit(tmp_path):
    """Operators that were formed again at temperatures of the run are formed at these."""
    text = (EXAMPLES / "warm_blocks.inp").read_text()
    unchecked = {text[text.index("** Increments follow the local error"):]: ""}
    deck = written(EXAMPLES / "warm_blocks.inp", tmp_path, changes=TABLES | unchecked)
    whole = solve(deck)
    listing = whole.with_suffix(".lst").read_text()
    again = [len(re.findall("^INCREMENT", listing[:found.start()], re.M))
             for found in re.finditer("operators formed again", listing)]
    assert len(again) > 1
    times = kept(whole)
    for i in sorted({again[0] - 1, again[-1]}):
        assert_same(whole, go_on(deck, whole, tmp_path / f"from{i}", float(times[i])))


def test_films_of_the_past_go_on_to_the_last_bit(tmp_path):
    """A scheme with a past takes those at the start of the increment, too."""
    deck = two.two_blocks(tmp_path / "deck.inp", "*THERMAL SCHEME, TYPE=CRANK-NICOLSON", WRITE,
                          times="0.1, 0.3")
    whole = solve(deck)
    assert_same(whole, go_on(deck, whole, tmp_path / "again", float(kept(whole)[1])))


def test_values_that_ramp_from_where_the_step_before_left_them_go_on(tmp_path):
    """A plate is pulled and heated at an end that is given a place and a temperature thereafter."""
    coupled = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "0.25, 1."]
    deck = write(tmp_path / "deck.inp", mesh("BAR", [0.0, 1.0], [0.0, 1.0], "CPS4"), material(
        "BAR", (1000.0, 0.3), 1e-4, 1.0), ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BAR, 0."], [
        WRITE, *coupled, "*BOUNDARY", "BAR.BOTTOM, 1, 2", "BAR.BOTTOM, 11", "*DSLOAD",
        "BAR.TOP, P, -5.", "*DSFLUX", "BAR.TOP, S, 20.", "*END STEP",
        *coupled, "*BOUNDARY", "BAR.TOP, 2, 2, 0.04", "BAR.TOP, 11, 11, 50.", "*END STEP"])
    whole = solve(deck)
    for at in 0.5, 1.25, 1.75:
        assert_same(whole, go_on(deck, whole, tmp_path / f"from{at}", at))


def test_it_goes_on_within_increments_that_are_cut_back(tmp_path):
    """Plain iteration allows too few passes for the increments of the deck."""
    path = rods.write_rods(tmp_path / "rods.inp")
    deck = copy_deck(path, path, [WRITE], {
        "0.1, 1.": "1., 1.", "ZAITSEV, TOL=1.E-12": "PICARD, TOL=1.E-12, MAXITER=10"})
    whole = solve(deck)
    cut_backs = [int(row.split()[5]) for row in whole.with_suffix(".sta").read_text().splitlines()[1:]]
    assert cut_backs[0] > 0
    assert len(cut_backs) > 2
    times = kept(whole)
    for i in sorted({0, 1, len(times) // 2, len(times) - 2}):
        assert_same(whole, go_on(deck, whole, tmp_path / f"from{i}", float(times[i])))


def test_a_run_that_fails_behind_a_thermal_runaway_fails_again_in_the_same_words(tmp_path):
    """The first attempt runs away at the end of the step, later ones do not converge."""
    cards = [card.replace("0.125, 1., 1E-3", "1., 1., 0.01").replace("3000", "50")
             for card in limits.bars("PICARD", 2 * limits.GAS_A / limits.SHRINKS)]
    deck = write(tmp_path / "bars.inp", [WRITE], cards)
    first, again = (run("run", "--quiet", deck, *options, "--out", tmp_path / folder)
                    for folder, options in (("one", ()), ("two", (
                        "--restart", tmp_path / "one" / "bars.vtkhdf"))))
    assert first.returncode == again.returncode == 2
    assert "ended in thermal runaway in contact pair FACE" in first.stderr
    assert again.stderr == first.stderr


@pytest.mark.parametrize("solver", ["SKYLINE", "MUMPS"])
def test_the_order_of_unknowns_is_that_of_the_steps_before(tmp_path, solver):
    """Heat alone orders them otherwise than both fields do, and the order stays."""
    deck = written(COUPLED, tmp_path, cards=[f"*SOLVER, TYPE={solver}"])
    text = deck.read_text()
    first = re.search(r"^\*STEP.*?^\*END STEP\n", text, flags=re.M | re.S)[0]
    heat = re.sub(r"^\*COUPLED.*$", "*HEAT TRANSFER, STEADY STATE", first, count=1, flags=re.M)
    deck.write_text(text.replace(first, heat + first))
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode in (0, 4), process.stderr
    whole = deck.with_suffix(".vtkhdf")
    steps = kept(whole, "step")
    for i in (0, int(np.argmax(steps == 2)) - 1, int(np.argmax(steps == 2)), len(steps) - 2):
        assert_same(whole, go_on(deck, whole, tmp_path / f"from{i}", float(kept(whole)[i])))


@pytest.mark.changes("RESTART, FREQUENCY", "RESTART, OVERLAY", "RESTART, WRITE")
def test_states_are_kept_at_every_nth_increment_and_the_last(tmp_path):
    cards = {"all": "*RESTART, WRITE", "some": "*RESTART, WRITE, FREQUENCY=4",
             "none": "*RESTART, WRITE, FREQUENCY=0", "last": "*RESTART, WRITE, OVERLAY"}
    decks = {}
    for name, card in cards.items():
        (tmp_path / name).mkdir()
        decks[name] = written(EXAMPLES / "thermal_cycling.inp", tmp_path / name, card)
        note_changes([cards["all"]], [card])
    note_changes([], ["*RESTART, WRITE"])
    results = {name: solve(deck) for name, deck in decks.items()}
    with h5py.File(results["none"]) as file:
        assert "restart" not in file
    within, steps = (kept(results["all"], name) for name in ("increment_in_step", "step"))
    ends = np.append(steps[1:] > steps[:-1], True)
    due = (within % 4 == 0) | ends
    np.testing.assert_array_equal(kept(results["some"]), kept(results["all"])[due])
    np.testing.assert_array_equal(kept(results["last"]), kept(results["all"])[ends])
    at = float(kept(results["some"])[3])
    assert_same(results["some"], go_on(decks["some"], results["some"], tmp_path / "again", at))
    assert_same(results["last"], go_on(decks["last"], results["last"], tmp_path / "once",
                                       float(kept(results["last"])[1])))
    with h5py.File(results["last"]) as file:
        assert len(file["restart/values"]) == kept(results["last"], "values").sum()


NEW_STEPS = """*RESTART, READ{place}
*AMPLITUDE, NAME=LATER, TIME=STEP TIME
0., 1., 1., 1.
*STEP, AMPLITUDE=STEP
*STATIC
0.25, 1.
*TEMPERATURE, AMPLITUDE=LATER
STRIP, 30.
*END STEP
"""


@pytest.fixture(scope="module")
def cycling(tmp_path_factory):
    """Return the deck of a strip that is heated and cooled in steps, and its result."""
    deck = written(EXAMPLES / "thermal_cycling.inp", tmp_path_factory.mktemp("cycling"))
    return deck, solve(deck)


def with_steps(deck, folder, steps, more):
    """Write the deck with so many of its steps and without its checks, and more; return it."""
    text = re.sub(r"^\*VERIFY[^*]*", "", deck.read_text(), flags=re.M)
    ends = [match.end() for match in re.finditer(r"^\*END STEP\n", text, flags=re.M)]
    head, _, tail = more.partition("*STEP")
    first = text.index("*STEP")
    path = folder / "in_one.inp"
    path.write_text(text[:first] + head + text[first:ends[steps - 1]] + "*STEP" + tail)
    for mesh in deck.parent.glob("*.mesh"):
        shutil.copy(mesh, folder)
    return path


@pytest.mark.changes("RESTART, READ", "RESTART, STEP", "RESTART, INC")
def test_a_deck_adds_steps_behind_those_of_a_result(cycling, tmp_path):
    """It equals one deck that has all of them from the start, at whatever increment it goes on."""
    _, result = cycling
    new = tmp_path / "in_one.inp"
    ends = []
    for i, place in enumerate((", STEP=2, INC=3", ", STEP=2", ", STEP=3")):
        note_changes(["*RESTART, READ, STEP=2"], [f"*RESTART, READ{place}"])
        whole = solve(with_steps(cycling[0], tmp_path, 2 if i < 2 else 3,
                                 NEW_STEPS.format(place="").split("\n", 1)[1]), "--out",
                      tmp_path / f"whole{i}")
        title = "*HEADING\nOnce more\n" if i == 1 else ""
        new.write_text(title + NEW_STEPS.format(place=place))
        process = run("run", "--quiet", new, "--restart", result, "--out", tmp_path / f"new{i}")
        assert process.returncode == 0, process.stderr
        whole = tmp_path / f"whole{i}" / "in_one.vtkhdf"
        # The states of the old deck tell of its checks.
        assert_same(whole, tmp_path / f"new{i}" / "in_one.vtkhdf", but="restart/")
        with h5py.File(whole) as file:
            ends.append(file["history/time"][-1])
    assert ends[0] == ends[1] < ends[2]
    note_changes([], ["*RESTART, READ"])
    # Its own result has all steps, so it can go on from there too.
    own = tmp_path / "new2" / "in_one.vtkhdf"
    new.write_text(NEW_STEPS.format(place=", STEP=3"))
    assert_same(own, go_on(new, own, tmp_path / "own", float(kept(own)[-2])))


def test_a_run_without_a_finer_one_goes_on_without_it(tmp_path):
    """Plain iteration solves the whole increment, but not its halves on the finer mesh."""
    deck = copy_deck(COUPLED, tmp_path / "deck.inp", ["*OPTIONS, ERRORS=FULL", WRITE], {
        "METHOD=NEWTON": "METHOD=PICARD, MAXITER=50", "20., 900.": "1040., 1040.",
        "TOP, 11, 11, 900.": "TOP, 11, 11, 1040."})
    deck.write_text(deck.read_text().split("*VERIFY")[0])
    result = solve(deck)
    more = tmp_path / "more.inp"
    more.write_text("*RESTART, READ, STEP=1\n*STEP\n*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, "
                    "DIRECT\n1., 1.\n*BOUNDARY\nTOP, 11, 11, 1050.\n*END STEP\n")
    process = run("run", more, "--restart", result, "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    assert "(no estimate: no solution on a finer mesh)" in process.stdout
    why = r"numerical uncertainties cannot be estimated: (.*\n.*)"
    said = [re.findall(why, path.with_suffix(".lst").read_text()) for path in (result, more)]
    assert len(said[0]) == 1
    assert said[0] == said[1]


def test_the_increment_named_is_that_of_the_step_named(tmp_path):
    """Both steps have four increments: the second of step 2 is the sixth, at time 1.5."""
    heated = ["*STEP", "*HEAT TRANSFER, STEADY STATE", "0.25, 1.", "*BOUNDARY"]
    old = write(tmp_path / "old.inp", mesh("BAR", [0.0, 1.0], [0.0, 1.0], "CPE4"),
                material("BAR", conductivity=1.0), [
        WRITE, *heated, "BAR, 11, 11, 10.", "*END STEP", *heated, "BAR, 11, 11, 30.", "*END STEP"])
    new = write(tmp_path / "new.inp", ["*RESTART, READ, STEP=2, INC=2", *heated[:-1], "*END STEP"],
                verify(*(("NT", "BAR", time, value, 1e-12)
                         for time, value in ((1.75, 25), (2, 30), (3, 30)))))
    result = solve(new, "--restart", solve(old))
    assert "increment 6 (time 1.5)" in result.with_suffix(".lst").read_text()


def refused(*arguments):
    """Return the messages of a run that is refused before anything is solved."""
    process = run("run", *arguments)
    assert process.returncode == 1, process.stdout
    return process.stderr


def test_results_of_other_decks_meshes_options_and_versions_are_refused(cycling, tmp_path):
    deck, result = cycling
    other = written(deck, tmp_path)
    mesh = tmp_path / "thermal_cycling.mesh"
    lines = mesh.read_text().splitlines()
    k = next(i for i, line in enumerate(lines) if re.match(r"\d+, ", line))
    was, lines[k] = lines[k], lines[k].replace(",", ",  ", 1)
    other.write_text(deck.read_text())
    mesh.write_text("\n".join(lines) + "\n")
    said = refused(other, "--restart", result, "--out", tmp_path)
    assert f'is of another deck, which has "{was}" in place of "{lines[k]}"' in said
    assert f"thermal_cycling.mesh:{k + 1}:1: error: " in said
    shutil.copy(deck.parent / mesh.name, mesh)
    other.write_text(deck.read_text() + "** only a comment\n")
    last = go_on(other, result, tmp_path / "same")
    np.testing.assert_array_equal(kept(last), kept(result))
    other.write_text(deck.read_text().replace("*DSLOAD", "*DSLOAD, OP=NEW", 1))
    said = refused(other, "--restart", result, "--out", tmp_path)
    assert 'which has "*DSLOAD" in place of "*DSLOAD, OP=NEW"' in said
    said = refused(deck, "--restart", result, "--set", "N=1", "--out", tmp_path)
    assert "N" in said
    foreign = tmp_path / "foreign.vtkhdf"
    shutil.copy(result, foreign)
    with h5py.File(foreign, "r+") as file:
        version = file["run"].attrs["version"]
        file["run"].attrs["version"] = "0.0.1"
    said = refused(deck, "--restart", foreign, "--out", tmp_path)
    assert f'"{foreign}" is of thercon 0.0.1, not of {version}: solve its deck anew' in said
    assert not (tmp_path / "thermal_cycling.lst").exists()


def test_a_check_takes_the_options_that_a_run_goes_on_with(cycling, tmp_path):
    deck = cycling[0]
    full = ("--errors", "full")
    assert run("run", "--quiet", deck, *full, "--out", tmp_path).returncode in (0, 4)
    again = ("--restart", tmp_path / "thermal_cycling.vtkhdf")
    said = run("check", deck, *again).stderr
    assert 'was solved with --errors full, this run has no --set, --accuracy or --errors: give' in said
    assert run("check", deck, *again, *full).returncode == 0


def test_places_that_a_result_does_not_keep_are_refused(cycling, tmp_path):
    deck, result = cycling
    at = float(kept(result)[2])
    said = refused(deck, "--restart", f"{result}@{at + 0.01}", "--out", tmp_path)
    assert f"keeps no state at time {at + 0.01:.6g}; the nearest one is at time {at:.6g}" in said
    # A time as it is printed, with six digits, is the nearest one.
    assert run("run", deck, "--restart", f"{result}@{at * (1 + 3e-6)!r}", "--out",
               tmp_path / "printed").returncode == 0
    assert "there is no result" in refused(deck, "--restart", tmp_path / "none", "--out", tmp_path)
    broken = tmp_path / "broken.vtkhdf"
    broken.write_text("no HDF5\n")
    assert "cannot be read" in refused(deck, "--restart", broken, "--out", tmp_path)
    new = tmp_path / "new.inp"
    last = np.count_nonzero(kept(result, "step") == 2)
    for place, words in ((", STEP=9", "keeps no state of step 9"), (
            ", STEP=2, INC=99", "keeps no state at increment 99 of step 2; the nearest one is at "
            f"increment {last}\n")):
        new.write_text(NEW_STEPS.format(place=place))
        assert words in refused(new, "--restart", result, "--out", tmp_path)
    new.write_text(NEW_STEPS.format(place=", STEP=2"))
    assert "both say where" in refused(new, "--restart", f"{result}@{at}", "--out", tmp_path)
    for name in ("none", "last"):
        (tmp_path / name).mkdir()
    without = written(EXAMPLES / "thermal_cycling.inp", tmp_path / "none", "*RESTART, WRITE, FREQUENCY=0")
    assert "keeps no state to go on from" in refused(without, "--restart", solve(without),
                                                     "--out", tmp_path)


# More increments than are solved while a test waits.
INCREMENTS = 2000


@pytest.fixture(scope="module")
def long(tmp_path_factory):
    """Return a deck of many increments that keeps its states."""
    path = rods.write_rods(tmp_path_factory.mktemp("long") / "long.inp")
    return copy_deck(path, path, ["*RESTART, WRITE, FREQUENCY=7"], {
        "0.1, 1.": f"{1.0 / INCREMENTS!r}, 1.", "*STEP\n": f"*STEP, INC={INCREMENTS}\n"})


@pytest.fixture(scope="module")
def long_result(long):
    """Return its result."""
    return solve(long, "--out", long.parent / "whole") and long.parent / "whole" / "long.vtkhdf"


def begin(decks, folder, *options):
    """Start a run; return its process once its first increments are in place."""
    process = subprocess.Popen([PROGRAM, "run", "--quiet", *map(str, decks), "--out", str(folder),
                                *options], stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + PATIENCE
    lines = []
    while len(lines) < 50:
        with suppress(FileNotFoundError):   # it comes and goes while a run takes its place
            lines = (folder / "long.sta").read_text().splitlines()
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < until
        time.sleep(0.002)
    return process


@pytest.mark.parametrize("name", ["SIGKILL", "SIGTERM"])
def test_a_run_that_was_ended_goes_on_in_its_own_files(long, long_result, tmp_path, name):
    """Ended twice: the second time it has gone on itself."""
    process = begin([long], tmp_path)
    process.send_signal(getattr(signal, name))
    process.communicate(timeout=PATIENCE)
    result = tmp_path / "long.vtkhdf"
    first = kept(result, "increment")[-1]
    assert 0 < first < INCREMENTS
    process = begin([long], tmp_path, "--restart", str(result))
    process.send_signal(getattr(signal, name))
    process.communicate(timeout=PATIENCE)
    assert kept(result, "increment")[-1] >= first
    assert_same(long_result, go_on(long, result, tmp_path))


def batch_rows(folder):
    """Return the rows of the table of a batch by the names of their decks."""
    with (folder / "thercon-batch.csv").open(newline="") as file:
        return {Path(row["deck"]).stem: row for row in csv.DictReader(file)}


def stage_seconds(result):
    """Return the seconds of all stages of a run, which its result has."""
    with h5py.File(result) as file:
        return sum(value for name, value in file["run"].attrs.items() if name.startswith("seconds_"))


def test_a_batch_is_resumed(long, long_result, tmp_path):
    """A finished deck is skipped, an interrupted one goes on, and the others begin."""
    short = rods.write_rods(tmp_path / "short.inp")
    later = written(EXAMPLES / "two_rods.inp", tmp_path)
    process = begin([short, long, later], tmp_path)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=PATIENCE)
    assert not (tmp_path / "two_rods.vtkhdf").exists()
    first = batch_rows(tmp_path)["short"]
    spent = stage_seconds(tmp_path / "long.vtkhdf")
    before = (tmp_path / "short.vtkhdf").stat().st_mtime_ns
    process = run("run", short, long, later, "--out", tmp_path, "--resume")
    assert process.returncode == 0, process.stderr
    assert f"{short}: note: skipped: its result is finished" in process.stderr
    assert (tmp_path / "short.vtkhdf").stat().st_mtime_ns == before
    again = batch_rows(tmp_path)["short"]
    told = ("status", "outcome", "increments", "iterations", "checks_passed", "checks_failed")
    assert [again[key] for key in told] == [first[key] for key in told]
    assert again["reason"] == "its result is finished"
    assert again["seconds"] == f"{stage_seconds(tmp_path / 'short.vtkhdf'):.3f}"
    assert again["cpu_seconds"] == again["peak_megabytes"] == ""
    assert "solved 3" in process.stdout
    # What went on counts with what was done before.
    resumed = batch_rows(tmp_path)["long"]
    with h5py.File(long_result) as file:
        assert int(resumed["iterations"]) == file["history/iterations"][:].sum()
    assert stage_seconds(tmp_path / "long.vtkhdf") > spent
    assert float(resumed["seconds"]) > spent
    assert_same(long_result, tmp_path / "long.vtkhdf")
    assert kept(tmp_path / "two_rods.vtkhdf").size > 0
    assert "goes on" in (tmp_path / "long.lst").read_text()
    assert "goes on" not in (tmp_path / "two_rods.lst").read_text()[:2000]
    # Of a deck that was changed since, the old result is of no use.
    text = short.read_text()
    short.write_text(text.replace("0.1, 1.", "0.2, 1."))
    process = run("run", short, "--out", tmp_path, "--resume")
    assert process.returncode == 0
    assert 'begins again: "' in process.stderr
    assert "is of another deck" in process.stderr


def test_checks_that_failed_in_a_finished_run_fail_again(tmp_path):
    path = rods.write_rods(tmp_path / "rods.inp")
    deck = copy_deck(path, path, ["*VERIFY, KIND=ANALYTIC, SOURCE=none",
                                  "gap, FACE, 1., -5., 1.E-3",
                                  f"NT, HOT.TOP, 1., {rods.HOT}, 1.E-9",
                                  "NT, COLD.BOTTOM, 1., 0., 1.E-9, ABS"])
    assert run("run", deck, "--out", tmp_path, "--jobs", "1").returncode == 4
    first = batch_rows(tmp_path)["rods"]
    process = run("run", deck, "--out", tmp_path, "--resume", "--jobs", "1")
    assert process.returncode == 4, process.stderr
    again = batch_rows(tmp_path)["rods"]
    told = ("status", "outcome", "increments", "iterations", "checks_passed", "checks_failed")
    assert [again[key] for key in told] == [first[key] for key in told]
    assert [int(again[key]) for key in told[-2:]] == [2, 1] and int(again["increments"]) > 0


def test_the_command_line_refuses_what_does_not_go_together(tmp_path):
    for arguments, words in [
        (("a.inp", "b.inp", "--restart", "x"), "--restart takes one deck"),
        (("a.inp", "--resume", "--restart", "x"), "leave one out"),
        (("a.inp", "--restart", "x@later"), "RESULT or RESULT@TIME"),
        (("a.inp", "--restart"), "option --restart needs a value"),
    ]:
        process = run("run", *arguments, folder=tmp_path)
        assert process.returncode == 1
        assert words in process.stderr
    for command, option in (("check", "--resume"), ("trade", "--resume")):
        process = run(command, "a.inp", option, folder=tmp_path)
        assert f"{option} does not go with {command}" in process.stderr
    assert "does not go with trade" in run("trade", "a.inp", "--restart", "x",
                                           folder=tmp_path).stderr


def test_a_requested_accuracy_keeps_no_state(tmp_path):
    deck = written(EXAMPLES / "press_fit.inp", tmp_path)
    assert run("run", "--quiet", deck, "--accuracy", "20%", "--out", tmp_path).returncode in (0, 4)
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        assert "restart" not in file


def test_without_the_card_nothing_is_kept_and_nothing_changes(cycling, tmp_path):
    """But for last digits: loads that were solved earlier are forgotten where a state is kept."""
    deck = written(EXAMPLES / "thermal_cycling.inp", tmp_path, "** none")
    with h5py.File(solve(deck)) as plain, h5py.File(cycling[1]) as other:
        assert "restart" not in plain
        moved, again = (file["VTKHDF/PointData/displacement"][()] for file in (plain, other))
        np.testing.assert_allclose(again, moved, rtol=0.0, atol=1e-10 * np.abs(moved).max())


def test_states_survive_the_file_that_is_read(cycling, tmp_path):
    """A run may go on in the file that it reads; links and other names of it are the same file."""
    deck, result = cycling
    folder = tmp_path / "copy"
    shutil.copytree(result.parent, folder)
    (tmp_path / "link.vtkhdf").symlink_to(folder / result.name)
    (tmp_path / "link.contact.vtkhdf").symlink_to(folder / "thermal_cycling.contact.vtkhdf")
    for end in (".sta", ".cvg"):
        (tmp_path / f"link{end}").symlink_to(folder / f"thermal_cycling{end}")
    at = float(kept(result)[4])
    process = run("run", "--quiet", folder / deck.name, "--restart",
                  f"{tmp_path / 'link.vtkhdf'}@{at!r}", "--out", folder)
    assert process.returncode == 0, process.stderr
    assert_same(result, folder / result.name)
    assert not list(folder.glob("*.tmp"))
    assert os.path.islink(Path(tmp_path / "link.vtkhdf"))


def damage(path, seed):
    """Change bytes of a file, anywhere or in its first ones, set a range to zero, or cut it off."""
    random = np.random.default_rng(seed)
    content = bytearray(path.read_bytes())
    way = random.integers(4)
    last = len(content) if way else 8192
    places = np.sort(random.integers(last, size=int(random.integers(2, 60))))
    if way < 2:
        for place in places:
            content[place] ^= int(random.integers(1, 256))
    elif way == 2:
        content[places[0]:places[1] + 1] = bytes(places[1] + 1 - places[0])
    else:
        del content[places[0]:]
    changed = content != path.read_bytes()
    path.write_bytes(content)
    return changed


def test_a_damaged_result_is_refused(cycling, tmp_path):
    """HDF5 itself crashes on some of these, or reads other numbers. THERCON_FUZZ=N tries N of them."""
    deck, result = cycling
    contact = result.with_suffix(".contact.vtkhdf")
    for seed in range(int(os.environ.get("THERCON_FUZZ", "20"))):
        for path in (result, contact):
            shutil.copy(path, tmp_path)
        if damage(tmp_path / (contact if seed % 5 == 4 else result).name, seed):
            said = refused(deck, "--restart", tmp_path / result.name, "--out", tmp_path / "new")
            assert re.search(r'\.vtkhdf" (is damaged|cannot be read): ', said), (seed, said)


def test_a_result_without_a_seal_is_one_of_an_earlier_version(cycling, tmp_path):
    deck, result = cycling
    for path in (result, result.with_suffix(".contact.vtkhdf")):
        content = path.read_bytes()
        assert content[-16:-8] == b"thercon\n"
        (tmp_path / path.name).write_bytes(content[:-16])
    for end in (".sta", ".cvg"):
        shutil.copy(result.with_suffix(end), tmp_path)
    assert_same(result, go_on(deck, tmp_path / result.name, tmp_path / "new"))
