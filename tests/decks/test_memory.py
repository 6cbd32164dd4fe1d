"""The memory of a run is estimated before it is solved, and refused where there is less."""

import csv
import os
import re
import resource
import subprocess

import pytest
from deck_runs import COUPLED, CYLINDER, INPUT, PROGRAM, copy_deck, of_release, run

MEGABYTE = 1e6

pytestmark = of_release


def estimate(deck):
    """Return what `check` says of the memory of a run [byte]."""
    said = run("check", deck)
    assert said.returncode == 0, said.stderr
    return MEGABYTE * float(re.search(r"memory of a run \.+ (\d+) MB", said.stdout)[1])


def peak(deck):
    """Return the largest resident memory of a run, as the table of a batch has it [byte]."""
    process = run("run", "--quiet", "--jobs", 1, deck, "--out", deck.parent)
    assert process.returncode == 0, process.stderr
    with open(deck.parent / "thercon-batch.csv") as file:
        (row,) = csv.DictReader(file)
    return MEGABYTE * float(row["peak_megabytes"])


def few_increments(deck):
    """Let the cylinder have three increments, after which its memory does not grow; return it."""
    text = deck.read_text()
    assert "\n20., 900." in text
    deck.write_text(text.replace("\n20., 900.", "\n300., 900."))
    return deck


def without_checks(source, folder, cards):
    """Copy a deck, without its checks and its solver, to a folder; return its path."""
    for mesh in source.parent.glob("*.mesh"):
        (folder / mesh.name).symlink_to(mesh)
    text = re.sub(r"^\*SOLVER.*\n", "", source.read_text(), flags=re.M)
    (folder / "source.inp").write_text(re.sub(r"(?ms)^\*VERIFY.*?(?=^\*(?!VERIFY|\*)|\Z)", "", text))
    return copy_deck(folder / "source.inp", folder / "deck.inp", cards)


@pytest.mark.parametrize(("source", "cards"), [
    (CYLINDER, ["*REFINE, LEVELS=0"]),
    (CYLINDER, ["*REFINE, LEVELS=1"]),
    (CYLINDER, ["*REFINE, LEVELS=2"]),
    (CYLINDER, ["*REFINE, LEVELS=2", "*SOLVER, TYPE=MUMPS"]),
    (COUPLED, ["*REFINE, LEVELS=1", "*SOLVER, TYPE=MUMPS"]),
    (INPUT / "examples" / "cracked_plate.inp", ["*REFINE, LEVELS=1"]),
])
def test_the_estimate_is_not_under_the_peak_nor_twice_as_much(tmp_path, source, cards):
    deck = without_checks(source, tmp_path, cards)
    if source == CYLINDER:
        few_increments(deck)
    assert 1.0 <= estimate(deck) / peak(deck) <= 2.0


def test_the_estimate_has_room_for_the_factors_of_the_finer_mesh_beside_mortar_points(tmp_path):
    deck = few_increments(without_checks(CYLINDER, tmp_path, ["*REFINE, LEVELS=3"]))
    deck.write_text(deck.read_text().replace("PAIRING=NODES", "PAIRING=SURFACES"))
    assert 1.0 <= estimate(deck) / peak(deck) <= 2.0


def test_the_estimate_has_room_for_the_motions_of_a_state(tmp_path):
    """*STABILITY keeps what contact points make of all temperatures, at several rates."""
    deck = few_increments(without_checks(CYLINDER, tmp_path, ["*REFINE, LEVELS=2"]))
    text = deck.read_text().replace("*CONDUCTIVITY", "*DENSITY\n1.\n*SPECIFIC HEAT\n3.6\n*CONDUCTIVITY")
    deck.write_text(text.replace("\n300., 900.", "\n300., 900.\n*STABILITY"))
    assert 1.0 <= estimate(deck) / peak(deck) <= 2.0


@pytest.mark.parametrize("command", ["check", "run"])
def test_what_no_machine_has_is_refused_before_it_is_refined(tmp_path, command):
    deck = copy_deck(CYLINDER, tmp_path / "large.inp", ["*REFINE, LEVELS=8"])
    process = run(command, deck, folder=tmp_path)
    if process.returncode == 0:
        pytest.skip("this machine has the memory")
    assert process.returncode == 3
    message = re.search(r": error: not enough memory: the run needs about (\d+) MB and may "
                        r"use (\d+) MB \(.+\)\n", process.stderr)
    assert process.stderr.count("\n") == 1
    assert int(message[1]) > int(message[2])
    assert not list(tmp_path.glob("large.[!i]*"))


@pytest.mark.parametrize("megabytes", [*range(100, 400, 60), 1000])
def test_a_limit_of_the_process_ends_the_run_with_one_line(tmp_path, megabytes):
    deck = few_increments(without_checks(CYLINDER, tmp_path, ["*REFINE, LEVELS=1"]))
    limit = int(megabytes * MEGABYTE)
    process = subprocess.run(
        [PROGRAM, "run", "--quiet", deck, "--out", tmp_path], capture_output=True, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)), check=False)
    if process.returncode == 0:
        assert process.stderr == ""
        return
    assert process.returncode == 3, process.stderr
    assert re.fullmatch(r"\S+: error: (memory ran out|not enough memory): .*\d+ MB.*\n", process.stderr)


def groups():
    """Return a folder in which groups of processes with limits of memory can be made, or nothing."""
    for folder, name in (("/sys/fs/cgroup", "memory.max"),
                         ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")):
        if os.access(folder, os.W_OK) and os.path.exists(f"{folder}/cgroup.procs"):
            return folder, name
    return None


def test_a_limit_of_the_control_group_counts(tmp_path):
    found = groups()
    if not found:
        pytest.skip("no control group can be made here")
    folder = f"{found[0]}/thercon_test_{os.getpid()}"
    try:
        os.mkdir(folder)
        with open(f"{folder}/{found[1]}", "w") as file:
            file.write("100000000")
    except OSError:
        pytest.skip("no limit can be set here")
    deck = copy_deck(CYLINDER, tmp_path / "deck.inp", ["*REFINE, LEVELS=2"])

    def enter():
        with open(f"{folder}/cgroup.procs", "w") as file:
            file.write(str(os.getpid()))

    try:
        process = subprocess.run([PROGRAM, "run", "--quiet", deck, "--out", tmp_path], text=True,
                                 capture_output=True, preexec_fn=enter, check=False)
    finally:
        os.rmdir(folder)
    assert process.returncode == 3, process.stderr
    assert f"may use 100 MB ({found[1]})" in process.stderr


@pytest.mark.parametrize("kilobytes", [256])
@pytest.mark.parametrize("arguments", [["run", "--quiet"], ["run", "--quiet", "--jobs", 1], ["check"]])
def test_a_soft_limit_of_the_stack_is_raised(tmp_path, arguments, kilobytes):
    deck = few_increments(without_checks(CYLINDER, tmp_path, ["*REFINE, LEVELS=1"]))
    limits = 1024 * kilobytes, resource.getrlimit(resource.RLIMIT_STACK)[1]
    process = subprocess.run(
        [PROGRAM, *map(str, arguments), deck], cwd=tmp_path, capture_output=True, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_STACK, limits), check=False)
    assert process.returncode == 0, process.stderr


@pytest.mark.parametrize("kilobytes", [256, 8191])
@pytest.mark.parametrize("arguments", [["run"], ["run", "--jobs", 1], ["check"], ["trade"]])
def test_a_hard_limit_of_the_stack_is_told_with_what_to_do(tmp_path, arguments, kilobytes):
    limit = 1024 * kilobytes
    process = subprocess.run(
        [PROGRAM, *map(str, arguments), CYLINDER], cwd=tmp_path, capture_output=True, text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_STACK, (limit, limit)), check=False)
    assert process.returncode == 3
    assert process.stderr == (f"thercon: error: the stack may have {kilobytes} kB and needs 8192 kB; "
                              "raise its hard limit (ulimit -Hs)\n")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("solver", ["SKYLINE", "MUMPS"])
def test_the_estimate_covers_a_plain_run(tmp_path, solver):
    """Without uncertainties, which take most of the memory: what is left is the solver's."""
    deck = few_increments(without_checks(CYLINDER, tmp_path, [
        "*REFINE, LEVELS=2", "*OPTIONS, ERRORS=NO", f"*SOLVER, TYPE={solver}"]))
    assert 1.0 <= estimate(deck) / peak(deck) <= 2.0
