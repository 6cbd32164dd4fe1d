"""A run that is killed leaves a file that opens and holds every increment that its .sta names."""

import os
import random
import time
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np
import pytest
from program import increments_in, run, start, write_deck

KILLS = 24
MOST_TRIES = 400
POLL_SECONDS = 0.0005
REFINEMENT = "*REFINE, LEVELS=1"
SEED = 1987


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """Return all numbers of an undisturbed run and the time it took behind its first .sta line."""
    deck = write_deck(tmp_path_factory.mktemp("reference") / "cylinder.inp", [REFINEMENT])
    process = start(deck)
    wait_for_first_line(process, deck)
    since = time.monotonic()
    said, _ = process.communicate()
    assert process.returncode == 0, said
    return numbers_in(deck.with_suffix(".vtkhdf")), time.monotonic() - since


def wait_for_first_line(process, deck):
    """Wait until the .sta file has the line of an increment; return whether the run goes on."""
    while process.poll() is None:
        if increments_in(deck.with_suffix(".sta")):
            return True
        time.sleep(POLL_SECONDS)
    return False


def numbers_in(path):
    """Return every dataset of increments in a result file, as rows of increments."""
    numbers = {}
    with h5py.File(path) as file:
        increments = len(file["history/time"])
        points = len(file["VTKHDF/Points"])
        assert file["VTKHDF/Steps"].attrs["NSteps"] == increments
        for name, dataset in file["history"].items():
            numbers[f"history/{name}"] = dataset[()]
        for contact in file["contact"].values():
            for name, dataset in contact.items():
                if name in ("slave_node", "master_node", "x", "y", "s", "weight"):
                    continue
                numbers[f"{contact.name}/{name}"] = dataset[()]
        for name, dataset in file["VTKHDF/PointData"].items():
            if name != "node_id":
                numbers[f"VTKHDF/PointData/{name}"] = dataset[()].reshape(increments, points, -1)
        for name in ("Values", "PartOffsets", "NumberOfParts", "PointDataOffsets/displacement"):
            numbers[f"VTKHDF/Steps/{name}"] = file[f"VTKHDF/Steps/{name}"][()]
    assert {len(rows) for rows in numbers.values()} == {increments}
    return numbers


def kill_once(deck, chance, seconds):
    """Kill a run somewhere behind its first .sta line; return whether it was still alive then."""
    process = start(deck)
    if not wait_for_first_line(process, deck):
        return False
    if chance.random() < 0.5:
        time.sleep(chance.uniform(0.0, seconds))
    else:
        # In the midst of writing: the working copy has just appeared.
        until = time.monotonic() + chance.uniform(0.0, seconds)
        working_copy = deck.with_suffix(".vtkhdf.tmp")
        while process.poll() is None:
            if time.monotonic() > until and working_copy.exists():
                break
            time.sleep(POLL_SECONDS)
        time.sleep(chance.uniform(0.0, 0.01))
    alive = process.poll() is None
    process.kill()
    process.communicate()
    return alive


def check_what_is_left(deck, reference):
    """Compare the file with the reference; return the number of increments that .sta names."""
    named = increments_in(deck.with_suffix(".sta"))
    assert named == list(range(1, len(named) + 1))
    left = numbers_in(deck.with_suffix(".vtkhdf"))
    held = len(left["history/time"])
    assert held >= len(named)
    assert left.keys() == reference.keys()
    for name, rows in left.items():
        np.testing.assert_array_equal(rows, reference[name][:held], err_msg=name)
    return len(named)


def kill_many(folder, kills, seed, reference, seconds):
    """Kill as many runs; return the numbers of increments that their .sta files named."""
    chance = random.Random(seed)
    deck = write_deck(folder / "cylinder.inp", [REFINEMENT])
    last = len(reference["history/time"])
    named = []
    for _ in range(MOST_TRIES):
        for extension in (".sta", ".vtkhdf"):
            deck.with_suffix(extension).unlink(missing_ok=True)
        if not kill_once(deck, chance, seconds):
            continue
        increments = check_what_is_left(deck, reference)
        if 0 < increments < last:
            named.append(increments)
        if len(named) == kills:
            break
    return named


def test_a_killed_run_leaves_every_increment_of_its_sta(reference, tmp_path):
    numbers, seconds = reference
    workers = max(1, min(2, os.cpu_count() or 1))
    folders = [tmp_path / str(worker) for worker in range(workers)]
    for folder in folders:
        folder.mkdir()
    with ThreadPoolExecutor(workers) as pool:
        jobs = [
            pool.submit(kill_many, folder, KILLS // workers, SEED + worker, numbers, seconds)
            for worker, folder in enumerate(folders)
        ]
        named = [job.result() for job in jobs]
    assert sum(map(len, named)) >= KILLS
    # Kills at one and the same instant would show nothing.
    assert len(set(sum(named, []))) >= 3

    # What a killed run left beside its file does not disturb the next one.
    deck = folders[0] / "cylinder.inp"
    deck.with_suffix(".vtkhdf.tmp").write_bytes(b"left by a killed run")
    status, said = run(deck)
    assert status == 0, said
    assert check_what_is_left(deck, numbers) == len(numbers["history/time"])
    assert not deck.with_suffix(".vtkhdf.tmp").exists()
