"""A batch: what becomes of one deck leaves the others alone, and the table tells what it was."""

import csv
import os
import pty
import re
import resource
import signal
import subprocess
import time
from contextlib import suppress
from pathlib import Path

import h5py
import numpy as np
import pytest
import test_rods as rods
from deck_runs import CYLINDER, INPUT, PATIENCE, PROGRAM, copy_deck, datasets, run, solve
from test_interrupted import INCREMENTS, heat, lines_of

GOOD = [INPUT / "rods" / f"{name}.inp" for name in ("r1", "r1b", "r3-middle")]
TABLE = "thercon-batch.csv"
COLUMNS = ["deck", "status", "outcome", "reason", "increments", "iterations", "checks_passed",
           "checks_failed", "seconds", "cpu_seconds", "peak_megabytes"]
PLACE = 1_200_000_000  # bytes of address space: ten times what the small decks use beside OpenBLAS


def table(folder):
    """Return the rows of the CSV file by the names of their decks."""
    with (folder / TABLE).open(newline="") as file:
        reader = csv.DictReader(file)
        rows = list(reader)
    assert reader.fieldnames == COLUMNS
    return {Path(row["deck"]).stem: row for row in rows}


def start(decks, folder, *options, **more):
    """Start a batch; return its process."""
    return subprocess.Popen(
        [PROGRAM, "run", *map(str, decks), "--out", str(folder), *map(str, options)],
        text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more,
    )


def children(process):
    """Return the numbers of a batch's processes."""
    return [int(number) for number in
            Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]


def state_of(process):
    """Return the state of a process as ps names it, nothing once it is gone."""
    with suppress(FileNotFoundError, ProcessLookupError):
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    return ""


def wait_until(what):
    """Wait until something holds."""
    until = time.monotonic() + PATIENCE
    while not what():
        assert time.monotonic() < until
        time.sleep(0.002)


def awaits(process, number):
    """Whether a signal has been sent to a process that has not taken it yet."""
    words = Path(f"/proc/{process}/status").read_text()
    return int(re.search(r"ShdPnd:\s*(\w+)", words)[1], 16) >> number - 1 & 1


@pytest.fixture
def long(tmp_path):
    """Return a deck of many increments."""
    return heat(tmp_path, "long.inp", INCREMENTS)


def failing(folder):
    """Write a deck that is refused, one that does not converge and one whose check fails."""
    rods.write_rods(folder / "refused.inp")
    refused = copy_deck(folder / "refused.inp", folder / "refused.inp", ["*NONSENSE"])
    stopped = heat(folder, "stopped.inp", 10)
    plain = {"ZAITSEV, TOL=1.E-12": "PICARD, TOL=1.E-12, MAXITER=2", "INC=10": "INC=12"}
    copy_deck(stopped, stopped, changes=plain)
    check = ['*VERIFY, KIND=ANALYTIC, SOURCE="wrong on purpose"', "time, , LAST, 2., 1.E-6"]
    return refused, stopped, copy_deck(heat(folder, "checked.inp", 1), folder / "checked.inp", check)


@pytest.fixture(scope="module")
def single(tmp_path_factory):
    """Return the folder of the good decks' results, each from a run of its own."""
    folder = tmp_path_factory.mktemp("single")
    for deck in GOOD:
        assert run("run", "--quiet", deck, "--out", folder).returncode == 0
    return folder


def assert_as_single(folder, single):
    """Assert that the good decks have the results of single runs, to the last bit."""
    for deck in GOOD:
        groups = "VTKHDF", "history", "contact", "convergence"
        one, other = (datasets(f / f"{deck.stem}.vtkhdf", *groups) for f in (single, folder))
        assert one.keys() == other.keys() and len(one) > 30
        for name, values in one.items():
            np.testing.assert_array_equal(other[name], values, err_msg=name)
        row = table(folder)[deck.stem]
        assert (row["status"], row["outcome"], row["reason"]) == ("0", "solved", "")
        assert int(row["iterations"]) == len(one["convergence/iteration"]) > 0


@pytest.mark.parametrize("jobs", [1, 3])
def test_decks_that_fail_leave_the_others_alone(tmp_path, single, jobs):
    decks = [*failing(tmp_path), *GOOD, "nowhere.inp"]
    process = run("run", *decks, "--out", tmp_path, "--jobs", jobs)
    assert process.returncode == 4
    assert_as_single(tmp_path, single)
    rows = table(tmp_path)
    assert list(rows) == [Path(deck).stem for deck in decks]
    said = {name: (row["status"], row["outcome"]) for name, row in rows.items()}
    assert said["refused"] == ("1", "deck error") == said["nowhere"]
    assert said["stopped"] == ("2", "not converged")
    assert said["checked"] == ("4", "check failed")
    assert rows["stopped"]["increments"] == str(len(lines_of(tmp_path / "stopped.sta")))
    assert (rows["checked"]["checks_passed"], rows["checked"]["checks_failed"]) == ("0", "1")
    assert "*NONSENSE" in rows["refused"]["reason"]
    assert "no such file" in rows["nowhere"]["reason"]
    assert "checked.inp:" in rows["checked"]["reason"]
    assert ": check failed: " in rows["checked"]["reason"]
    assert all(rows[name]["reason"] for name in said if said[name][0] != "0")
    # On the terminal the same decks in the same order.
    lines = process.stdout[process.stdout.rindex("outcome"):].splitlines()[1:]
    assert [line.split()[0] for line in lines[:-1]] == [str(deck) for deck in decks]
    assert "solved 3" in lines[-1] and "deck error 2" in lines[-1]


def test_messages_of_decks_stand_together(tmp_path):
    """Twelve wrong decks at a time, of ten mistakes each."""
    decks = []
    for number in range(12):
        decks.append(tmp_path / f"wrong-{number}.inp")
        decks[-1].write_text("".join(f"*NONSENSE{number}\n" for _ in range(10)))
    process = run("run", *decks, "--out", tmp_path, "--jobs", 12)
    assert process.returncode == 1
    owners = []
    for line in process.stderr.splitlines():
        owner = [d for d in decks if line.startswith(f"{d}:")]
        if not owner:
            assert line.strip() in ("^", f"*NONSENSE{decks.index(owners[-1])}")
        owners.append(owner[0] if owner else owners[-1])
    turns = [one for one, other in zip(owners, [None, *owners]) if one != other]
    assert sorted(turns) == sorted(decks)


def test_a_crash_is_named_and_takes_no_other_deck_along(tmp_path, single, long):
    process = start([long, *GOOD], tmp_path)
    wait_until(lambda: len(lines_of(tmp_path / "long.sta")) > 10)
    (child,) = children(process)
    os.kill(child, signal.SIGSEGV)
    output, messages = process.communicate(timeout=PATIENCE)
    assert process.returncode == 3
    assert_as_single(tmp_path, single)
    row = table(tmp_path)["long"]
    assert (row["status"], row["outcome"]) == ("3", "crash: SIGSEGV")
    assert "signal 11 (SIGSEGV)" in row["reason"]
    assert f"{long}: error: ended by signal 11 (SIGSEGV), a crash" in messages
    assert "crash: SIGSEGV" in output
    with h5py.File(tmp_path / "long.vtkhdf") as file:
        written = len(file["history/time"])
    # The signal may come between an increment's file and its count.
    assert 10 < len(lines_of(tmp_path / "long.sta")) <= written <= int(row["increments"]) + 1


def test_decks_that_run_are_listed_so_at_once_and_again_as_they_go_on(tmp_path, long):
    """How often depends on the load of the machine: at most once a second."""
    other, rest = heat(tmp_path, "other.inp", INCREMENTS), heat(tmp_path, "rest.inp", 1)
    process = start([long, other, rest], tmp_path, "--jobs", 2)
    wait_until(lambda: (tmp_path / TABLE).exists()
               and [row["outcome"] for row in table(tmp_path).values()].count("running") == 2)
    rows, until = [table(tmp_path)], time.monotonic() + PATIENCE
    while len(rows) < 4:
        assert time.monotonic() < until
        time.sleep(0.002)
        row = table(tmp_path)
        rows += [row] if row["long"]["seconds"] != rows[-1]["long"]["seconds"] else []
    process.kill()
    process.communicate()
    for row in rows:
        assert [row[name]["outcome"] for name in row] == ["running", "running", "not run"]
        assert row["long"]["status"] == row["long"]["reason"] == ""
    for column in "increments", "iterations", "seconds":
        found = [float(row["long"][column]) for row in rows]
        assert found == sorted(found) and found[0] < found[-1]


def test_the_end_of_a_deck_is_in_the_table_while_others_run(tmp_path, long):
    other = heat(tmp_path, "other.inp", INCREMENTS)
    process = start([long, other], tmp_path, "--jobs", 2)
    wait_until(lambda: len(lines_of(tmp_path / "long.sta")) > 10)
    os.kill(min(children(process)), signal.SIGKILL)
    wait_until(lambda: table(tmp_path)["long"]["outcome"] != "running")
    rows = table(tmp_path)
    process.kill()
    process.communicate()
    assert (rows["long"]["status"], rows["long"]["outcome"]) == ("3", "killed: SIGKILL")
    assert "signal 9 (SIGKILL)" in rows["long"]["reason"]
    assert rows["other"]["outcome"] == "running"


@pytest.mark.parametrize("broken", ["stdout", "stderr"])
def test_output_that_nobody_reads_any_more_does_not_touch_the_table(tmp_path, broken):
    refused, _, _ = failing(tmp_path)
    process = start([*GOOD, refused], tmp_path)
    getattr(process, broken).close()
    setattr(process, broken, None)
    process.communicate(timeout=PATIENCE)
    assert process.returncode == 1
    assert [row["outcome"] for row in table(tmp_path).values()] == [*3 * ["solved"], "deck error"]


def test_a_batch_whose_caller_ignores_the_ends_of_children_sees_them(tmp_path):
    process = start(GOOD, tmp_path, preexec_fn=lambda: signal.signal(
        signal.SIGCHLD, signal.SIG_IGN))
    try:
        process.communicate(timeout=PATIENCE)
    finally:
        process.kill()
    assert process.returncode == 0
    assert {row["outcome"] for row in table(tmp_path).values()} == {"solved"}


def test_memory_that_runs_out_takes_no_other_deck_along(tmp_path, single):
    large = copy_deck(CYLINDER, tmp_path / "large.inp", ["*REFINE, LEVELS=5"])

    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (PLACE, PLACE))

    process = start([large, *GOOD], tmp_path, "--jobs", 2, preexec_fn=limit)
    _, messages = process.communicate(timeout=PATIENCE)
    assert process.returncode == 3, messages
    assert_as_single(tmp_path, single)
    row = table(tmp_path)["large"]
    assert (row["status"], row["outcome"]) == ("3", "out of memory"), messages
    assert f"{large}: error: not enough memory" in messages


def test_too_little_memory_for_any_deck_is_said(tmp_path):
    """OpenBLAS would wait for its memory without an end."""
    little = 190_000_000

    def limit():
        resource.setrlimit(resource.RLIMIT_AS, (little, little))

    process = start(GOOD, tmp_path, preexec_fn=limit)
    _, messages = process.communicate(timeout=PATIENCE)
    assert process.returncode == 3
    assert {row["outcome"] for row in table(tmp_path).values()} == {"out of memory"}
    assert messages.count("error: memory ran out") == len(GOOD)


def test_as_many_decks_run_at_a_time_as_are_asked_for(tmp_path):
    """They are pipes, so that each runs until it is given its cards."""
    text = heat(tmp_path, "short.inp", 10).read_text()
    decks = [tmp_path / f"{name}.inp" for name in "abcd"]
    for deck in decks:
        os.mkfifo(deck)
    pipes = {}

    def running():
        for deck in decks:
            with suppress(OSError):   # nobody reads it
                if deck not in pipes:
                    pipes[deck] = os.open(deck, os.O_WRONLY | os.O_NONBLOCK)
        return set(pipes)

    process = start(decks, tmp_path, "--jobs", 3, "--quiet")
    wait_until(lambda: running() == set(decks[:3]))
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(timeout=0.3)
    assert running() == set(decks[:3])
    for deck in decks:
        wait_until(lambda deck=deck: deck in running())
        os.write(pipes[deck], text.encode())
        os.close(pipes[deck])
    output, messages = process.communicate(timeout=PATIENCE)
    assert (output, process.returncode) == ("", 0)
    assert "error" not in messages


@pytest.mark.parametrize("name", ["SIGTERM", "SIGINT"])
def test_a_signal_ends_all_that_run_after_their_increments(tmp_path, long, name):
    other, rest = heat(tmp_path, "other.inp", INCREMENTS), heat(tmp_path, "rest.inp", 1)
    process = start([long, other, rest], tmp_path, "--jobs", 2)
    for stem in ("long", "other"):
        wait_until(lambda stem=stem: len(lines_of(tmp_path / f"{stem}.sta")) > 10)
    process.send_signal(getattr(signal, name))
    output, messages = process.communicate(timeout=PATIENCE)
    assert process.returncode == 5
    rows = table(tmp_path)
    for stem in ("long", "other"):
        count = len(lines_of(tmp_path / f"{stem}.sta"))
        assert 10 < count < INCREMENTS
        with h5py.File(tmp_path / f"{stem}.vtkhdf") as file:
            assert len(file["history/time"]) == count
        assert (rows[stem]["status"], rows[stem]["outcome"]) == ("5", "interrupted")
        assert rows[stem]["increments"] == str(count)
        assert f"ended by {name} after increment {count} " in rows[stem]["reason"]
        assert not list(tmp_path.glob(f"{stem}.vtkhdf.*.tmp"))
    assert rows["rest"]["outcome"] == "not run"
    assert all(rows["rest"][column] == "" for column in ["status", *COLUMNS[4:]])
    assert f"{rest}: error: not started because of {name}" in messages
    assert output.splitlines()[-2].split() == [str(rest), "not", "run"]


def test_a_second_signal_kills(tmp_path, long):
    """A stopped process stands for one whose increment has no end."""
    process = start([long, *GOOD], tmp_path)
    wait_until(lambda: len(lines_of(tmp_path / "long.sta")) > 10)
    (child,) = children(process)
    os.kill(child, signal.SIGSTOP)
    wait_until(lambda: state_of(child) == "T")
    process.send_signal(signal.SIGINT)
    wait_until(lambda: awaits(child, signal.SIGINT))   # two that come at once are one
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(timeout=1.5)
    process.send_signal(signal.SIGINT)
    _, messages = process.communicate(timeout=PATIENCE)
    assert process.returncode == 5
    assert f"{long}: error: killed because a second signal came" in messages
    assert not Path(f"/proc/{child}").exists()
    with h5py.File(tmp_path / "long.vtkhdf") as file:
        assert len(file["history/time"]) >= len(lines_of(tmp_path / "long.sta")) > 10


def test_decks_end_with_a_batch_that_is_killed_and_the_table_holds_what_had_ended(tmp_path, long):
    process = start([*GOOD, long], tmp_path)
    wait_until(lambda: len(lines_of(tmp_path / "long.sta")) > 10)
    (child,) = children(process)
    wait_until(lambda: (tmp_path / TABLE).exists()
               and all(table(tmp_path)[deck.stem]["outcome"] == "solved" for deck in GOOD))
    process.kill()
    process.communicate(timeout=PATIENCE)
    wait_until(lambda: state_of(child) in ("", "Z"))
    assert len(lines_of(tmp_path / "long.sta")) < INCREMENTS
    assert table(tmp_path)["long"]["outcome"] == "running"


def test_settings_hold_for_every_deck(tmp_path):
    decks = [rods.write_rods(tmp_path / f"{name}.inp") for name in ("one", "two")]
    process = run("run", *decks, "--set", "NEARER=3.E-4", "--out", tmp_path, "--jobs", 2)
    assert process.returncode == 0, process.stderr
    alone = solve(rods.write_rods(tmp_path / "alone.inp"), "--set", "NEARER=3.E-4")
    unset = solve(rods.write_rods(tmp_path / "unset.inp"))
    for deck in decks:
        result = deck.with_suffix(".vtkhdf")
        np.testing.assert_array_equal(rods.last(result, "pressure"), rods.last(alone, "pressure"))
        assert np.all(rods.last(result, "gap") != rods.last(unset, "gap"))


def test_one_deck_is_a_batch_where_jobs_is_given(tmp_path):
    assert run("run", GOOD[0], "--jobs", 4, "--out", tmp_path).returncode == 0
    assert list(table(tmp_path)) == ["r1"]
    alone = tmp_path / "alone"
    assert run("run", GOOD[0], "--out", alone).returncode == 0
    assert not (alone / TABLE).exists()


def test_a_table_that_cannot_be_written_is_status_3_before_anything_runs(tmp_path):
    (tmp_path / TABLE).mkdir()
    process = run("run", *GOOD, "--out", tmp_path)
    assert process.returncode == 3
    assert TABLE in process.stderr
    assert not list(tmp_path.glob("*.vtkhdf"))


def test_a_deck_with_the_name_of_the_table_is_refused(tmp_path):
    deck = rods.write_rods(tmp_path / TABLE)
    text = deck.read_text()
    assert run("run", deck, "--out", tmp_path).returncode == 1
    assert deck.read_text() == text


def test_a_terminal_shows_how_many_have_ended(tmp_path, long):
    """And the table stands there whole."""
    reader, writer = pty.openpty()
    decks = [*failing(tmp_path)[:1], GOOD[0], long]
    process = subprocess.Popen([PROGRAM, "run", *map(str, decks), "--out", str(tmp_path)],
                               stdout=writer, stderr=writer)
    os.close(writer)
    shown = ""
    try:
        while text := os.read(reader, 65536).decode():
            shown += text
            if "2 of 3 decks ended, 1 running, 1 failed" in shown and process.poll() is None:
                process.send_signal(signal.SIGINT)
    except OSError:
        pass  # the terminal's other end is closed
    os.close(reader)
    assert process.wait(timeout=PATIENCE) == 5
    assert "2 of 3 decks ended, 1 running, 1 failed" in shown
    lines = shown[shown.rindex("outcome"):].splitlines()
    assert [line.split()[0] for line in lines[1:4]] == [str(deck) for deck in decks]


def test_a_second_batch_in_a_folder_is_refused_until_the_first_has_ended(tmp_path, long):
    first = start([long], tmp_path, "--jobs", 1)
    wait_until(lambda: (tmp_path / TABLE).exists() and len(lines_of(tmp_path / "long.sta")) > 5)
    second = run("run", GOOD[0], "--jobs", 1, "--out", tmp_path)
    assert second.returncode == 3, second.stderr
    assert "another run writes here" in second.stderr and second.stdout == ""
    assert list(table(tmp_path)) == ["long"]
    first.send_signal(signal.SIGKILL)
    first.communicate()
    wait_until(lambda: run("run", "--quiet", GOOD[0], "--jobs", 1, "--out", tmp_path).returncode == 0)
    assert list(table(tmp_path)) == ["r1"]
    assert not (tmp_path / f"{TABLE}.lock").exists()


def test_a_deck_named_like_a_formula_is_none_in_the_table(tmp_path):
    deck = rods.write_rods(tmp_path / "=1+1.inp")
    process = run("run", "--quiet", deck.name, "--jobs", 1, folder=tmp_path)
    assert process.returncode == 0, process.stderr
    with (tmp_path / TABLE).open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert row["deck"] == "'=1+1.inp"
    assert row["outcome"] == "solved"
