"""Files that cannot be written, or that another run writes: said before solving, with the reason."""

import os
import resource
import signal
import subprocess
import time
from contextlib import contextmanager, suppress

import h5py
import pytest
from blocks import block, solid, without_unused_surfaces, write
from deck_runs import PATIENCE, PROGRAM, run
from test_interrupted import INCREMENTS, heat, lines_of

SMALL = [
    *without_unused_surfaces(block("BLOCK", [0.0, 1.0], [0.0, 1.0])),
    *solid("BLOCK", 1000.0, 0.25),
    *["*BOUNDARY", "BLOCK.BOTTOM, 2, 2, 0.", "BLOCK.LEFT, 1, 1, 0."],
    *["*STEP", "*STATIC", "0.5, 1.", "*DLOAD", "1, P3, 1.", "*END STEP"],
]
WRONG_CHECK = ['*VERIFY, KIND=ANALYTIC, SOURCE="wrong on purpose"', "time, , LAST, 2., 1.E-6"]
root_only = pytest.mark.skipif(os.geteuid() != 0, reason="mounts a file system")


@pytest.fixture
def small(tmp_path):
    """Return a deck that solves at once."""
    return write(tmp_path / "small.inp", SMALL)


@contextmanager
def running(deck, out):
    """Run a deck of many increments until some of them are in place; then let the caller go on."""
    process = subprocess.Popen(
        [PROGRAM, "run", str(deck), "--out", str(out)], text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )
    try:
        wait_until(lambda: len(lines_of(out / f"{deck.stem}.sta")) > 5)
        yield process
    finally:
        process.kill()
        process.communicate()


def wait_until(condition):
    until = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.005)


def size_of(path):
    """Return the size of a file, 0 where there is none; a run that begins may create it, delete it
    and create it again."""
    with suppress(FileNotFoundError):
        return path.stat().st_size
    return 0


def names(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.fixture
def full(tmp_path):
    """Return a small file system of a few blocks, in which hardly anything has room."""
    folder = tmp_path / "full"
    folder.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "tmpfs", folder], check=True)
    yield folder
    subprocess.run(["umount", "-l", folder], check=True)


def refused(process, path, reason):
    """Assert that a run ended with status 3 and one message that names a file and the reason."""
    assert process.returncode == 3, process.stderr
    assert process.stderr.count("error:") == 1, process.stderr
    assert f'cannot write "{path}"' in process.stderr
    assert reason in process.stderr


def test_a_second_run_with_the_same_output_stops_before_it_solves(tmp_path):
    deck = heat(tmp_path, "long.inp", INCREMENTS)
    with running(deck, tmp_path) as first:
        second = run("run", deck, "--out", tmp_path)
        assert second.returncode == 3
        assert "another run writes here" in second.stderr
        assert second.stderr.count("error:") == 1
        assert first.poll() is None
        first.send_signal(signal.SIGTERM)
        first.communicate(timeout=PATIENCE)
        assert first.returncode == 5
    with h5py.File(tmp_path / "long.vtkhdf") as file:
        assert len(file["history/time"]) == len(lines_of(tmp_path / "long.sta"))
    assert names(tmp_path) == ["long.contact.vtkhdf", "long.cvg", "long.inp", "long.lst", "long.sta",
                               "long.vtkhdf"]
    assert "ENDED EARLY" in (tmp_path / "long.lst").read_text()


def test_the_lock_of_a_killed_run_dies_with_it(tmp_path):
    deck = heat(tmp_path, "long.inp", INCREMENTS)
    with running(deck, tmp_path) as process:
        process.kill()
        process.communicate()
    short = heat(tmp_path / "..", f"{tmp_path.name}.inp", 2)
    short = short.rename(deck)
    (tmp_path / "long.vtkhdf.99.tmp").write_bytes(b"\x89HDF\r\n\x1a\n: left by a killed run")
    (tmp_path / "long.vtkhdf.mine.tmp").write_bytes(b"not of this program")
    process = run("run", "--quiet", short, "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    assert names(tmp_path) == ["long.contact.vtkhdf", "long.cvg", "long.inp", "long.lst", "long.sta", "long.vtkhdf",
                               "long.vtkhdf.mine.tmp"]


def test_runs_with_other_names_do_not_disturb_each_other(tmp_path, small):
    deck = heat(tmp_path, "long.inp", INCREMENTS)
    with running(deck, tmp_path):
        assert run("run", "--quiet", small, "--out", tmp_path).returncode == 0


def test_no_name_of_a_folder_is_refused(tmp_path, small):
    for command in ("run", "trade"):
        process = run(command, small, "--out", "", folder=tmp_path)
        assert process.returncode == 1
        assert "option --out needs a value" in process.stderr
    assert names(tmp_path) == ["small.inp"]


@pytest.mark.parametrize("extension", ["lst", "sta", "cvg", "vtkhdf"])
def test_a_folder_in_place_of_a_file_is_said_before_solving(tmp_path, small, extension):
    out = tmp_path / "out"
    (out / f"small.{extension}").mkdir(parents=True)
    refused(run("run", small, "--out", out), out / f"small.{extension}", "Is a directory")
    assert names(out) == [f"small.{extension}"]


def test_a_folder_that_cannot_be_is_said_with_the_reason(tmp_path, small):
    (tmp_path / "file").write_text("")
    out = tmp_path / "file" / "out"
    for folder, reason in ((out, "Not a directory"), ("/dev/full", "Not a directory"),
                           ("/proc/none/out", "No such file or directory")):
        told = f'cannot write to the folder "{folder}": {reason}; name another one with --out'
        for command in (["run"], ["run", "--jobs", "1"], ["trade"]):
            process = run(*command, small, "--out", folder)
            assert process.returncode == 3
            assert process.stderr.endswith(f"error: {told}\n") and process.stderr.count("\n") == 1
            assert process.stdout == ""
    folder = tmp_path / "new" / "folder"
    assert run("run", small, "--quiet", "--out", f"{folder}/").returncode == 0
    assert "small.vtkhdf" in names(folder)


@pytest.mark.parametrize("extension", ["lst", "sta", "cvg"])
def test_a_full_disk_is_said_with_its_reason(tmp_path, extension):
    deck = write(tmp_path / "small.inp", SMALL, WRONG_CHECK)
    out = tmp_path / "out"
    out.mkdir()
    (out / f"small.{extension}").symlink_to("/dev/full")
    refused(run("run", deck, "--out", out), out / f"small.{extension}", "No space left on device")
    assert not [name for name in names(out) if name.endswith(".tmp")]


@root_only
def test_a_disk_that_is_full_at_the_start_solves_nothing(full, small):
    (full / "filler").write_bytes(b"x" * 16384)
    process = run("run", small, "--out", full)
    refused(process, full / "small.vtkhdf", "No space left on device")
    assert "solved" not in process.stdout
    assert names(full) == ["filler"]


@root_only
@pytest.mark.parametrize("room", ["48k", "64k", "96k", "128k", "200k", "400k"])
def test_a_disk_that_fills_up_ends_the_run_with_the_reason(full, tmp_path, room):
    """Whichever file finds no room, there is one message and what is in place opens."""
    subprocess.run(["mount", "-o", f"remount,size={room}", full], check=True)
    deck = heat(tmp_path, "long.inp", 2000)
    text = deck.read_text().split("*VERIFY")[0]
    deck.write_text(text + "\n".join(WRONG_CHECK) + "\n")
    process = run("run", "--quiet", deck, "--out", full)
    assert process.returncode == 3, process.stderr
    assert process.stderr.count("error:") == 1, process.stderr
    assert "No space left on device" in process.stderr
    assert "VERIFY" not in process.stderr
    assert not [name for name in names(full) if name.endswith(".tmp")]
    if (full / "long.vtkhdf").exists():
        with h5py.File(full / "long.vtkhdf") as file:
            assert len(file["history/time"]) >= len(lines_of(full / "long.sta")) - 1


def test_a_limit_of_file_sizes_is_said_with_its_reason(tmp_path):
    deck = heat(tmp_path, "long.inp", 200)

    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000))

    process = subprocess.run([PROGRAM, "run", "--quiet", deck, "--out", tmp_path], text=True,
                             capture_output=True, preexec_fn=limit, check=False)
    assert process.returncode == 3, process.stderr
    assert "File too large" in process.stderr


def in_the_way(deck, out):
    """Run a deck, with a folder in place of its result file from between the trial of its name and
    its first use, a tenth of a second later; return the process, None where that was missed."""
    process = subprocess.Popen([PROGRAM, "run", "--quiet", str(deck), "--out", str(out)],
                               text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    wait_until(lambda: size_of(out / f"{deck.stem}.lst") > 0)
    try:
        (out / f"{deck.stem}.vtkhdf").mkdir()
    except FileExistsError:
        process.kill()
        process.communicate()
        (out / f"{deck.stem}.vtkhdf").unlink()
        (out / f"{deck.stem}.lst").unlink()
        return None
    return process


def test_a_working_file_that_cannot_be_renamed_stays_and_is_named(tmp_path):
    """A folder stands for any reason a system may have."""
    deck = heat(tmp_path, "long.inp", INCREMENTS)
    deck.write_text("\n".join([deck.read_text().split("*VERIFY")[0], *WRONG_CHECK, ""]))
    listing = tmp_path / "long.lst"
    process = next(filter(None, (in_the_way(deck, tmp_path) for _ in range(50))))
    _, messages = process.communicate(timeout=PATIENCE)
    assert process.returncode == 3, messages
    assert messages.count("error:") == 1, messages
    assert "Is a directory" in messages
    assert "VERIFY" not in messages
    (left,) = [name for name in names(tmp_path) if name.startswith("long.vtkhdf.")]
    assert f'the results are in "{tmp_path / left}"' in messages
    with h5py.File(tmp_path / left) as file:
        assert len(file["history/time"]) >= 1
    assert "Is a directory" in listing.read_text()
    # The next run does not take it for a leftover.
    (tmp_path / "long.vtkhdf").rmdir()
    assert run("run", "--quiet", heat(tmp_path, "long.inp", 2), "--out", tmp_path).returncode == 0
    assert left in names(tmp_path)


def test_full_standard_output_is_said(small, tmp_path):
    with open("/dev/full", "w") as sink:
        process = subprocess.run([PROGRAM, "check", small], stdout=sink, stderr=subprocess.PIPE,
                                 text=True, check=False)
    assert process.returncode == 3
    assert "cannot write to standard output: No space left on device" in process.stderr


def names_written(deck, folder):
    """Return the names of all files that a run of a deck leaves."""
    assert run("run", "--quiet", deck, "--out", folder).returncode == 0
    return names(folder)


def includes(folder, name, included):
    """Write a deck that is read from another file; return the paths of both."""
    file = heat(folder, included, 2)
    write(file, without_unused_surfaces(file.read_text().splitlines()))
    return write(folder / name, [f"*INCLUDE, INPUT={included}"]), file


def keeps(file, *arguments):
    """Assert that a command is refused before it writes anything, with one message that names a
    file."""
    before, content = names(file.parent), file.read_bytes()
    process = run(*arguments)
    assert process.returncode == 1, process.stderr
    assert process.stderr.count("error:") == 1 and process.stderr.count("\n") == 1, process.stderr
    assert "would be written over" in process.stderr and str(file.name) in process.stderr
    assert process.stdout == ""
    assert (names(file.parent), file.read_bytes()) == (before, content)


def test_no_result_is_written_over_a_file_that_the_deck_includes(tmp_path):
    deck = heat(tmp_path, "joint.inp", 2)
    written = names_written(deck, tmp_path / "first")
    assert written == ["joint.contact.vtkhdf", "joint.cvg", "joint.lst", "joint.sta",
                       "joint.vtkhdf"]
    for number, name in enumerate(written):
        folder = tmp_path / str(number)
        folder.mkdir()
        deck, file = includes(folder, "joint.inp", name)
        keeps(file, "run", deck, "--out", folder)
        keeps(file, "run", deck, "--out", folder, "--accuracy", "10%")
        assert run("run", "--quiet", deck, "--out", folder / "out").returncode == 0


@pytest.mark.parametrize("link", ["symlink_to", "hardlink_to"])
def test_no_result_is_written_over_a_link_to_what_is_read(tmp_path, small, link):
    getattr(tmp_path / "small.lst", link)(small)
    keeps(small, "run", small, "--out", tmp_path)
    (tmp_path / "small.lst").unlink()
    (tmp_path / "folder").symlink_to(tmp_path)
    (tmp_path / "folder" / "small.trade.csv").symlink_to(small)
    keeps(small, "trade", small, "--out", tmp_path / "folder")


def test_a_trade_writes_over_nothing_that_is_read(tmp_path):
    deck, file = includes(tmp_path, "joint.inp", "joint.trade.csv")
    keeps(file, "trade", deck, "--out", tmp_path)


def test_a_batch_writes_over_no_file_of_any_of_its_decks(tmp_path, small):
    table, file = includes(tmp_path, "joint.inp", "thercon-batch.csv")
    keeps(file, "run", small, table, "--out", tmp_path)
    keeps(file, "run", table, "--jobs", "1", "--out", tmp_path)
    keeps(file, "run", file, "--jobs", "1", "--out", tmp_path)
    file.unlink()
    deck, file = includes(tmp_path, "joint.inp", "small.lst")
    keeps(file, "run", deck, small, "--out", tmp_path)
    assert run("run", "--quiet", deck, small, "--out", tmp_path / "out").returncode == 0


def test_a_file_with_the_name_of_a_result_is_read_from_another_folder(tmp_path):
    deck, file = includes(tmp_path, "joint.lst", "joint.vtkhdf.12.tmp")
    for _ in range(2):
        assert run("run", "--quiet", deck, "--out", tmp_path / "out").returncode == 0
        assert run("run", "--quiet", deck, "--jobs", "1", "--out", tmp_path / "out").returncode == 0
    assert file.exists()


def test_an_included_file_with_the_name_of_a_leftover_stays(tmp_path):
    deck, file = includes(tmp_path, "joint.inp", "joint.vtkhdf.12.tmp")
    assert run("run", "--quiet", deck, "--out", tmp_path).returncode == 0
    assert file.exists()


def test_a_file_that_vanishes_during_a_run_is_said(tmp_path):
    """A file that is there at the end, but is another one, is no result of the run either."""
    for extension in ("lst", "sta", "cvg"):
        for others in ((), ("another file",)):
            out = tmp_path / f"{extension}{len(others)}"
            deck = heat(tmp_path, "long.inp", INCREMENTS)
            with running(deck, out) as process:
                (out / f"long.{extension}").unlink()
                for text in others:
                    (out / f"long.{extension}").write_text(text)
                process.send_signal(signal.SIGTERM)
                _, messages = process.communicate(timeout=PATIENCE)
            assert process.returncode == 3, messages
            assert f'long.{extension}": it was removed or replaced during the run' in messages
            assert messages.count("error:") == 1, messages


def test_a_folder_that_vanishes_during_a_run_is_said(tmp_path):
    deck = heat(tmp_path, "long.inp", INCREMENTS)
    with running(deck, tmp_path / "out") as process:
        (tmp_path / "out").rename(tmp_path / "elsewhere")
        _, messages = process.communicate(timeout=PATIENCE)
    assert process.returncode == 3, messages
    # Which file misses its folder first depends on the instant.
    assert any(reason in messages for reason in ("No such file or directory", "it was removed or replaced")), messages
