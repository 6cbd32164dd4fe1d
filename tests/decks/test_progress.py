"""A terminal shows from the first second what a run is doing; nothing else does."""

import os
import pty
import re
import select
import subprocess
import time

import pytest
from deck_runs import CYLINDER, PROGRAM, copy_deck, run

PATIENCE = 60.0  # seconds for what takes a small part of one


def shown_by(arguments, seconds=PATIENCE):
    """Run the program at a terminal, for some seconds at most; return what stands there."""
    reader, writer = pty.openpty()
    process = subprocess.Popen([PROGRAM, *map(str, arguments)], stdout=writer, stderr=writer)
    os.close(writer)
    shown, until = "", time.monotonic() + seconds
    try:
        while (left := until - time.monotonic()) > 0:
            if select.select([reader], [], [], left)[0]:
                shown += os.read(reader, 65536).decode()
    except OSError:
        pass  # the program has ended
    os.close(reader)
    process.kill()
    process.wait()
    return shown


@pytest.fixture
def large(tmp_path):
    """Return a deck whose bodies take some seconds to be reduced."""
    return copy_deck(CYLINDER, tmp_path / "large.inp", ["*REFINE, LEVELS=4"])


def test_a_terminal_shows_the_stage_from_the_first_second(large, tmp_path):
    assert "reading" in shown_by(["run", large, "--out", tmp_path], 1.0)


def test_stages_come_in_their_order_and_increments_are_counted(tmp_path):
    deck = copy_deck(CYLINDER, tmp_path / "some.inp", ["*REFINE, LEVELS=1"])
    shown = shown_by(["run", deck, "--out", tmp_path])
    stages = re.findall(r"reading|assembling|reducing|increment 1 of 45", shown)
    assert stages[:4] == ["reading", "assembling", "reducing", "increment 1 of 45"]
    numbers = [int(n) for n in re.findall(r"increment (\d+) of 45", shown)]
    assert numbers == sorted(numbers)
    assert numbers[-1] > 30
    # Of the line nothing is left behind the run's last words.
    assert "increment" not in shown.split("\r")[-1].split(" increments in ")[0].splitlines()[0]


def test_no_terminal_shows_no_stage(tmp_path):
    process = run("run", CYLINDER, "--out", tmp_path)
    assert process.returncode == 0
    assert process.stderr == ""
    assert "reading" not in process.stdout


def test_quiet_shows_no_stage(tmp_path):
    assert shown_by(["run", "--quiet", CYLINDER, "--out", tmp_path]) == ""
