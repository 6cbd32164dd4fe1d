"""A run that is killed leaves a file that opens and holds every increment that its .sta names."""

import ctypes
import os
import random
import struct
import time
from concurrent.futures import ThreadPoolExecutor

import h5py
import numpy as np
import pytest
from program import increments_in, run, start, write_deck

KILLS = 8
MOST_TRIES = 400
POLL_SECONDS = 0.0005
STEPS = 6
SEED = 1987


def write_long_deck(folder):
    """Write the published deck in some steps, the end of each of which is published."""
    deck = write_deck(folder / "cylinder.inp", ["*REFINE, LEVELS=1"])
    head, step = deck.read_text().split("*VERIFY")[0].split("*STEP")
    assert "\n20., 900." in step and "TOP, 11, 11, 900." in step
    for k in range(STEPS):
        ramp = step.replace("\n20., 900.", "\n30., 150.")
        head += "*STEP" + ramp.replace("TOP, 11, 11, 900.", f"TOP, 11, 11, {150 * (k + 1)}.")
    deck.write_text(head)
    return deck


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """Return all numbers of an undisturbed run."""
    deck = write_long_deck(tmp_path_factory.mktemp("reference"))
    status, said = run(deck)
    assert status == 0, said
    return numbers_in(deck.with_suffix(".vtkhdf"))


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
                if name in ("slave_node", "master_node", "x", "y", "s", "piece", "weight"):
                    continue
                numbers[f"{contact.name}/{name}"] = dataset[()]
        for name, dataset in file["VTKHDF/PointData"].items():
            if name != "node_id":
                numbers[f"VTKHDF/PointData/{name}"] = dataset[()].reshape(increments, points, -1)
        for name in ("Values", "PartOffsets", "NumberOfParts", "PointDataOffsets/displacement"):
            numbers[f"VTKHDF/Steps/{name}"] = file[f"VTKHDF/Steps/{name}"][()]
    assert {len(rows) for rows in numbers.values()} == {increments}
    return numbers


def working_copies(deck):
    """Return the working copies of the result file that are there."""
    return list(deck.parent.glob(deck.stem + ".vtkhdf.*.tmp"))


def kill_once(deck, chance, named):
    """Kill a run somewhere behind the .sta line of an increment; return whether it was still alive
    then."""
    process = start(deck)
    while process.poll() is None and len(increments_in(deck.with_suffix(".sta"))) < named:
        time.sleep(POLL_SECONDS)
    if chance.random() < 0.5:
        time.sleep(chance.uniform(0.0, 0.1))
    else:
        # In the midst of writing: the working copy has just appeared.
        while process.poll() is None and not working_copies(deck):
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


def kill_many(folder, kills, seed, reference):
    """Kill as many runs; return the numbers of increments that their .sta files named."""
    chance = random.Random(seed)
    deck = write_long_deck(folder)
    last = len(reference["history/time"])
    named = []
    for _ in range(MOST_TRIES):
        for extension in (".sta", ".vtkhdf"):
            deck.with_suffix(extension).unlink(missing_ok=True)
        if not kill_once(deck, chance, chance.randrange(1, last)):
            continue
        increments = check_what_is_left(deck, reference)
        if 0 < increments < last:
            named.append(increments)
        if len(named) == kills:
            break
    return named


def test_a_killed_run_leaves_every_increment_of_its_sta(reference, tmp_path):
    workers = max(1, min(2, os.cpu_count() or 1))
    folders = [tmp_path / str(worker) for worker in range(workers)]
    for folder in folders:
        folder.mkdir()
    with ThreadPoolExecutor(workers) as pool:
        jobs = [
            pool.submit(kill_many, folder, KILLS // workers, SEED + worker, reference)
            for worker, folder in enumerate(folders)
        ]
        named = [job.result() for job in jobs]
    assert sum(map(len, named)) >= KILLS
    # Kills at one and the same instant would show nothing.
    assert len(set(sum(named, []))) >= 3

    # What a killed run left beside its file does not disturb the next one.
    deck = folders[0] / "cylinder.inp"
    deck.with_suffix(".vtkhdf.99.tmp").write_bytes(b"\x89HDF\r\n\x1a\n: left by a killed run")
    status, said = run(deck)
    assert status == 0, said
    assert check_what_is_left(deck, reference) == len(reference["history/time"])
    assert not working_copies(deck)


MODIFIED, CLOSED, PUT_IN_PLACE, CREATED = 0x2, 0x8, 0x80, 0x100   # inotify(7)
BLOCK = """*NODE
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*ELEMENT, TYPE=CPS4, ELSET=BLOCK
1, 1, 2, 3, 4
*MATERIAL, NAME=STEEL
*ELASTIC
2e5, 0.3
*SOLID SECTION, ELSET=BLOCK, MATERIAL=STEEL
"""
STEP = """*STEP
*STATIC
0.5, 1.
*BOUNDARY
1, 1, 2
2, 2
3, 2, 2, {0}e-3
*END STEP
"""


def changes_during(folder, work):
    """Return what happened to the files of a folder while work was done, in its order, as
    (event, name)."""
    libc = ctypes.CDLL(None, use_errno=True)
    watch = libc.inotify_init1(os.O_NONBLOCK)
    assert libc.inotify_add_watch(watch, os.fsencode(folder),
                                  MODIFIED | CLOSED | PUT_IN_PLACE | CREATED) >= 0
    try:
        work()
        found, heard = b"", []
        with os.fdopen(watch, "rb", buffering=0, closefd=False) as queue:
            while part := queue.read(65536):
                found += part
    finally:
        os.close(watch)
    while found:
        _, event, _, length = struct.unpack_from("iIII", found)
        heard.append((event, found[16:16 + length].rstrip(b"\0").decode()))
        found = found[16 + length:]
    return heard


def test_files_change_in_an_order_that_no_kill_can_spoil(tmp_path):
    """The result file is closed before it is put in place, and not written to there; `.sta` is
    emptied before the first one is in place, and has its lines behind each. Between two of these
    changes a kill strikes too seldom to be met by chance."""
    steps = 4
    deck = tmp_path / "block.inp"
    deck.write_text(BLOCK + "".join(STEP.format(k + 1) for k in range(steps)))
    deck.with_suffix(".sta").write_text("heading\n1\n2\n3\n")
    heard = changes_during(tmp_path, lambda: run(deck))
    assert increments_in(deck.with_suffix(".sta")) == list(range(1, 2 * steps + 1))
    complete, order = False, []
    for event, name in heard:
        if name.startswith("block.vtkhdf.") and name.endswith(".tmp"):
            complete = event == CLOSED
        elif name == "block.vtkhdf":
            if event != PUT_IN_PLACE:   # tried before anything is solved
                assert "result" not in order, "written where it is read"
                continue
            assert complete, "put in place before it was closed"
            order.append("result")
        elif name == "block.sta" and event == MODIFIED and order[-1:] != ["lines"]:
            order.append("lines")
    # What empties .sta is the first change of it.
    assert order == ["lines", *["result", "lines"] * (len(order) // 2)]
    assert len(order) // 2 >= steps
