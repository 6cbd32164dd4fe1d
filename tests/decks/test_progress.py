"""A terminal shows at once what a run is doing; nothing else does."""

import os
import pty
import re
import select
import subprocess

from deck_runs import CYLINDER, PATIENCE, PROGRAM, copy_deck, run
from test_interrupted import read_terminal


def at_terminal(*arguments):
    """Start the program at a terminal; return the process and the terminal's other end."""
    reader, writer = pty.openpty()
    process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdout=writer, stderr=writer)
    os.close(writer)
    return process, reader


def shown_by(*arguments):
    """Run the program at a terminal; return what stands there."""
    process, reader = at_terminal(*arguments)
    shown = read_terminal(reader)
    os.close(reader)
    process.wait()
    return shown


def test_a_terminal_shows_the_stage_while_it_lasts(tmp_path):
    """The deck is a pipe that says nothing: it is read without an end."""
    deck = tmp_path / "silent.inp"
    os.mkfifo(deck)
    process, reader = at_terminal("run", deck, "--out", tmp_path)
    with deck.open("w"):   # waits for its reader
        shown = bool(select.select([reader], [], [], PATIENCE)[0])
        process.kill()
    process.wait()
    assert shown and "reading" in read_terminal(reader)
    os.close(reader)


def test_stages_come_in_their_order_and_increments_are_counted(tmp_path):
    """The line is drawn some times a second at most: the second half takes longer than that."""
    deck = copy_deck(CYLINDER, tmp_path / "some.inp", ["*REFINE, LEVELS=1"],
                     {"INC=100": "INC=200", "\n20., 900.": "\n5., 900."})
    shown = shown_by("run", deck, "--out", tmp_path)
    stages = re.findall(r"reading|assembling|reducing|increment 1 of 180", shown)
    assert stages[:4] == ["reading", "assembling", "reducing", "increment 1 of 180"]
    numbers = [int(n) for n in re.findall(r"increment (\d+) of 180", shown)]
    assert numbers == sorted(numbers)
    assert numbers[-1] > 90
    # Of the line nothing is left behind the run's last words.
    assert "increment" not in shown.split("\r")[-1].split(" increments in ")[0].splitlines()[0]


def test_no_terminal_shows_no_stage(tmp_path):
    process = run("run", CYLINDER, "--out", tmp_path)
    assert process.returncode == 0
    assert process.stderr == ""
    assert "reading" not in process.stdout


def test_quiet_shows_no_stage(tmp_path):
    assert shown_by("run", "--quiet", CYLINDER, "--out", tmp_path) == ""
