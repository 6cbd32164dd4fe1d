"""SIGINT and SIGTERM end a run after the current increment; the files are whole and agree."""

import os
import pty
import re
import signal
import subprocess
import time
from contextlib import suppress
from functools import partial
from pathlib import Path

import h5py
import numpy as np
import pytest
import test_rods as rods
from deck_runs import COUPLED, CYLINDER, HERTZ, PATIENCE, PROGRAM, copy_deck, solve

INCREMENTS, BEFORE = 200000, 100   # more than are solved while a test waits
AT_MOST = 5.0    # CPU seconds that a run goes on behind a signal, however busy the machine is


def heat(folder, name, increments, share=1.0):
    """Write the deck of the rods with a share of their load in so many increments; its path."""
    path = rods.write_rods(folder / name)
    changes = {"0.1, 1.": f"{share / increments!r}, {share!r}",
               "*STEP\n": f"*STEP, INC={increments}\n",
               f"11, 11, {rods.HOT}": f"11, 11, {share * rods.HOT!r}"}
    return copy_deck(path, path, changes=changes)


@pytest.fixture(scope="module")
def deck(tmp_path_factory):
    """Return a deck of many increments."""
    return heat(tmp_path_factory.mktemp("long"), "long.inp", INCREMENTS)


def lines_of(sta):
    """Return the lines of a .sta file without its heading; a run that begins creates the file,
    deletes it and creates it again."""
    with suppress(FileNotFoundError):
        return sta.read_text().splitlines()[1:]
    return []


def interrupt(decks, folder, number):
    """Send a signal to a run when some increments are in place; return the finished process, its
    output and its messages."""
    process = subprocess.Popen(
        [PROGRAM, "run", *map(str, decks), "--out", str(folder)], text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )
    until = time.monotonic() + PATIENCE
    while len(lines_of(folder / "long.sta")) < BEFORE:
        assert process.poll() is None and time.monotonic() < until
        time.sleep(0.002)
    process.send_signal(number)
    said = process.communicate(timeout=PATIENCE)
    return process, *said


@pytest.mark.parametrize("name", ["SIGTERM", "SIGINT"])
def test_a_signal_ends_the_run_after_the_current_increment(deck, tmp_path, name):
    process, _, messages = interrupt([deck], tmp_path, getattr(signal, name))
    assert process.returncode == 5, messages
    result = tmp_path / "long.vtkhdf"
    with h5py.File(result) as file:
        times = file["history/time"][()]
        assert file["VTKHDF/Steps"].attrs["NSteps"] == len(times)
        np.testing.assert_array_equal(file["VTKHDF/Steps/Values"][()], times)
        assert all(len(contact["gap"]) == len(times) for contact in file["contact"].values())
        gap = file["contact/FACE/gap"][-1]
        passes = file["convergence/increment"][()]
    count = len(times)
    assert BEFORE <= count < INCREMENTS
    np.testing.assert_allclose(times, np.arange(1, count + 1) / INCREMENTS, rtol=1e-12)
    numbers = [int(line.split()[0]) for line in lines_of(tmp_path / "long.sta")]
    assert numbers == list(range(1, count + 1))
    rows = (tmp_path / "long.cvg").read_text().splitlines()[1:]
    assert [int(row.split()[0]) for row in rows] == passes.tolist()
    assert passes[-1] == count
    reason = f"ended by {name} after increment {count} (time "
    assert f"{deck}: error: {reason}" in messages
    assert "not converged" not in messages
    listing = (tmp_path / "long.lst").read_text()
    assert reason in listing[listing.rindex("ENDED EARLY"):]
    assert f"The results hold the increments up to number {count}." in listing
    assert sorted(f.name for f in tmp_path.iterdir()) == [
        "long.contact.vtkhdf", "long.cvg", "long.lst", "long.sta", "long.vtkhdf"]
    # The last increment is the answer of its load, whatever ran before it.
    alone = solve(heat(tmp_path, "alone.inp", 1, float(times[-1])))
    np.testing.assert_allclose(gap, rods.last(alone, "gap"), rtol=1e-9)


def test_decks_behind_it_are_not_started_and_said_so(deck, tmp_path):
    other = heat(tmp_path, "other.inp", 10)
    process, output, messages = interrupt([deck, other], tmp_path, signal.SIGTERM)
    assert process.returncode == 5
    assert f"{other}: error: not started because of SIGTERM" in messages
    assert not (tmp_path / "other.lst").exists()
    table = output[output.rindex("outcome"):].splitlines()
    assert [row.split()[:3] for row in table[1:3]] == [
        [str(deck), "interrupted", str(len(lines_of(tmp_path / "long.sta")))],
        [str(other), "not", "run"],
    ]


def test_a_signal_that_the_caller_ignores_stays_ignored(tmp_path):
    """As under nohup, or of a job in the background of a script. The deck is a pipe, so that the run
    goes on when the signal comes."""
    text = heat(tmp_path, "short.inp", 10).read_text()
    deck = tmp_path / "piped.inp"
    os.mkfifo(deck)
    process = subprocess.Popen(
        [PROGRAM, "run", str(deck), "--out", str(tmp_path)], text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_IGN))
    with deck.open("w") as file:   # waits for its reader
        process.send_signal(signal.SIGINT)
        file.write(text)
    _, messages = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0, messages


# METIS asks for its first random number with its own handlers of signals in place.
METIS = """
#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

void srand(unsigned int seed)
{
   if (getenv("METIS_IS_SENT")) kill(getpid(), SIGTERM);
   ((void (*)(unsigned int))dlsym(RTLD_NEXT, "srand"))(seed);
}

int METIS_NodeND(int *n, int *start, int *next, int *weight, int *options, int *order, int *position)
{
   int (*order_nodes)(int *, int *, int *, int *, int *, int *, int *) =
      (int (*)(int *, int *, int *, int *, int *, int *, int *))dlsym(RTLD_NEXT, "METIS_NodeND");
   return getenv("METIS_FAILS") ? -4 : order_nodes(n, start, next, weight, options, order, position);
}
"""


@pytest.fixture(scope="module")
def metis(tmp_path_factory):
    """Return an environment in which METIS can be disturbed."""
    folder = tmp_path_factory.mktemp("metis")
    (folder / "metis.c").write_text(METIS)
    subprocess.run([os.environ.get("CC", "cc"), "-shared", "-fPIC", "-o", "metis.so", "metis.c", "-ldl"],
                   cwd=folder, check=True)
    return os.environ | {"LD_PRELOAD": str(folder / "metis.so"),
                         "ASAN_OPTIONS": "verify_asan_link_order=0"}   # of the preset `sanitize`


def by_mumps(folder, increments):
    """Return the command that solves heat and mechanics by MUMPS, with one order of both."""
    deck = heat(folder, "long.inp", increments)
    return [PROGRAM, "run", str(copy_deck(deck, deck, ["*SOLVER, TYPE=MUMPS"])), "--out", str(folder)]


@pytest.mark.parametrize("ignores", [False, True])
def test_a_signal_while_metis_orders_unknowns_waits_for_its_end(tmp_path, metis, ignores):
    """METIS would take it for an error of its own and leave by longjmp; ignored it changes nothing."""
    process = subprocess.run(
        by_mumps(tmp_path, 10), env=metis | {"METIS_IS_SENT": "1"}, capture_output=True, text=True,
        timeout=PATIENCE, preexec_fn=partial(signal.signal, signal.SIGTERM,
                                             signal.SIG_IGN if ignores else signal.SIG_DFL))
    assert process.returncode == (0 if ignores else 5), process.stderr
    assert ignores or process.stderr.endswith("error: ended by SIGTERM before the first increment\n")


def test_a_failure_of_metis_is_said(tmp_path, metis):
    """Not gone on from with an order at random."""
    process = subprocess.run(by_mumps(tmp_path, 10), env=metis | {"METIS_FAILS": "1"},
                             capture_output=True, text=True, timeout=PATIENCE)
    assert process.returncode == 3, process.stderr
    assert process.stderr.endswith(": METIS could not order the unknowns\n")


def test_handlers_of_signals_outlast_metis(tmp_path):
    """One that it puts back would serve a signal only, and the next one kill the run."""
    process = subprocess.Popen(by_mumps(tmp_path, INCREMENTS), text=True, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE)
    until = time.monotonic() + PATIENCE
    while len(lines_of(tmp_path / "long.sta")) < BEFORE:
        assert process.poll() is None and time.monotonic() < until
        time.sleep(0.002)
    while process.poll() is None and time.monotonic() < until:
        process.send_signal(signal.SIGTERM)
    _, messages = process.communicate(timeout=PATIENCE)
    assert process.returncode == 5, messages


def cpu_seconds(process):
    """Return the CPU seconds of a process that was not waited for, user and system."""
    fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def end_by_signal(process):
    """Send SIGINT to a run; return the CPU seconds for which it went on."""
    before = cpu_seconds(process)
    process.send_signal(signal.SIGINT)
    until = time.monotonic() + PATIENCE
    while not os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT):
        assert time.monotonic() < until
        time.sleep(0.01)
    seconds = cpu_seconds(process) - before
    assert process.wait() == 5
    return seconds


def read_terminal(reader, words=None):
    """Return what is shown at a terminal until some words are, or until its process ends."""
    shown = ""
    with suppress(OSError):
        while words is None or words not in shown:
            shown += os.read(reader, 65536).decode()
    return shown


def test_a_signal_ends_a_run_that_reduces_its_bodies(tmp_path):
    """At once, for there is nothing to keep; results of an earlier run stay."""
    deck = copy_deck(CYLINDER, tmp_path / "large.inp", ["*REFINE, LEVELS=4"])
    earlier = tmp_path / "large.vtkhdf"
    earlier.write_text("of an earlier run")
    reader, writer = pty.openpty()
    process = subprocess.Popen([PROGRAM, "run", str(deck), "--out", str(tmp_path)],
                               stdout=subprocess.DEVNULL, stderr=writer)
    os.close(writer)
    assert "reducing" in read_terminal(reader, "reducing")
    assert end_by_signal(process) < AT_MOST / 2
    assert read_terminal(reader).splitlines()[-1].endswith(
        f"{deck}: error: ended by SIGINT before the first increment")
    os.close(reader)
    assert earlier.read_text() == "of an earlier run"
    assert not list(tmp_path.glob("*.tmp")) and not (tmp_path / "large.lst").exists()


def test_a_terminal_shows_the_round_and_answers_a_signal_at_once(tmp_path):
    """One line that is written over, with the time, and states in words; it is gone at the end."""
    reader, writer = pty.openpty()
    process = subprocess.Popen([PROGRAM, "run", str(HERTZ), "--accuracy", "0.001%", "--out", str(tmp_path)],
                               stdout=writer, stderr=writer)
    os.close(writer)
    # Increments of the first rounds may be over before the line is written again.
    shown = read_terminal(reader, ", stick 0\x1b[K")
    if "\rround 2, " not in shown:
        shown += read_terminal(reader, "\rround 2, ")
    assert re.search(r"\rround \d, \d+ s: increment \d of \d+  load [0-9.]+  open \d+, slip \d+, "
                     r"stick 0\x1b\[K", shown)
    process.send_signal(signal.SIGINT)
    rest = read_terminal(reader)
    assert process.wait(timeout=PATIENCE) == 5
    os.close(reader)
    ended = int(re.search(r"error: ended by SIGINT in round (\d+)", rest)[1])
    assert ended > 1
    assert f"the results are those of round {ended - 1}" in rest
    assert all(line == "" or line.endswith("\x1b[K") or "\x1b[K" not in line
               for line in rest.split("\r") if line.startswith("round "))


def test_a_batch_names_no_results_of_a_deck_that_wrote_none(tmp_path):
    """The deck is a pipe that says nothing: the signal comes while it is read."""
    deck = tmp_path / "silent.inp"
    os.mkfifo(deck)
    process = subprocess.Popen(
        [PROGRAM, "run", str(deck), "--jobs", "1", "--out", str(tmp_path)], text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    with deck.open("w"):   # waits for its reader
        process.send_signal(signal.SIGINT)
        output, messages = process.communicate(timeout=PATIENCE)
    assert process.returncode == 5, messages
    assert f"{deck}: interrupted, 0 increments" in output
    assert "results:" not in output
    assert sorted(f.name for f in tmp_path.iterdir()) == ["silent.inp", "thercon-batch.csv"]


def test_a_signal_ends_an_increment_without_an_end_and_keeps_those_before(tmp_path):
    """By plain iteration, which goes round for ever where the gain of the coupling is below -1."""
    deck = copy_deck(COUPLED, tmp_path / "long.inp", ["*REFINE, LEVELS=1"], {
        "METHOD=NEWTON": "METHOD=PICARD, MAXITER=100000"})
    process = subprocess.Popen([PROGRAM, "run", str(deck), "--out", str(tmp_path)], text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    while cpu_seconds(process) < 1.0:   # the increments that end take some hundredths
        assert process.poll() is None
        time.sleep(0.05)
    assert end_by_signal(process) < AT_MOST
    _, messages = process.communicate()
    count = len(lines_of(tmp_path / "long.sta"))
    assert 0 < count < 45
    with h5py.File(tmp_path / "long.vtkhdf") as file:
        assert len(file["history/time"]) == count
    reason = f"ended by SIGINT after increment {count} (time "
    assert f"{deck}: error: {reason}" in messages
    listing = (tmp_path / "long.lst").read_text()
    assert reason in listing
    assert "\nSECONDS\n" in listing   # it came to its end
    assert not list(tmp_path.glob("*.tmp"))


def test_numbers_whose_finer_mesh_a_signal_ends_say_so(tmp_path):
    """Whole increments end; by plain iteration none of half their length does. No state is kept from
    which a run would go on without its finer mesh."""
    deck = copy_deck(COUPLED, tmp_path / "long.inp", ["*OPTIONS, ERRORS=FULL", "*RESTART, WRITE"], {
        "METHOD=NEWTON": "METHOD=PICARD, MAXITER=100000", "20., 900.": "1040., 2080.",
        "TOP, 11, 11, 900.": "TOP, 11, 11, 2080."})
    deck.write_text(deck.read_text().split("*VERIFY")[0])
    process = subprocess.Popen([PROGRAM, "run", str(deck), "--out", str(tmp_path)], text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    while cpu_seconds(process) < 1.0:   # the increment itself takes some hundredths
        assert process.poll() is None
        time.sleep(0.05)
    assert end_by_signal(process) < AT_MOST
    output, _ = process.communicate()
    assert len(re.findall(r"(?:force|rate|pressure|stress) .*\(no estimate: interrupted\)", output)) > 4
    assert "finer mesh" not in output
    with h5py.File(tmp_path / "long.vtkhdf") as file:
        assert len(file["history/time"]) == 1 and "restart" not in file
