"""Decks from pipes, decks beyond the limits of docs/deck.md, bytes that are no plain text."""

import os
import re
import subprocess
import threading

import h5py
import pytest
from blocks import block, solid, without_unused_surfaces, write
from deck_runs import PATIENCE, PROGRAM, run

BODY = [
    *without_unused_surfaces(block("BLOCK", [0.0, 1.0], [0.0, 1.0])),
    *solid("BLOCK", 1000.0, 0.25),
    *["*BOUNDARY", "BLOCK.BOTTOM, 2, 2, 0.", "BLOCK.LEFT, 1, 1, 0."],
]
STEP = ["*STEP", "*STATIC", "0.5, 1.", "*DLOAD", "1, P3, 1.", "*END STEP"]
GOOD = "\n".join(BODY + STEP) + "\n"
PAIR = [*without_unused_surfaces(
            block("UPPER", [0.0, 1.0], [1.0, 2.0])
            + ["*SURFACE INTERACTION, NAME=DRY", "*CONTACT PAIR, INTERACTION=DRY",
               "UPPER.BOTTOM, LOWER.TOP"] + block("LOWER", [0.0, 1.0], [0.0, 1.0], 101)),
        *solid("UPPER", 1000.0, 0.25), *solid("LOWER", 1000.0, 0.25),
        "*BOUNDARY", "LOWER.BOTTOM, 1, 2, 0.", "UPPER.LEFT, 1, 1, 0.", "UPPER.TOP, 2, 2, -0.01",
        "*STEP", "*STATIC", "1., 1.", "*END STEP"]
CONTROL = re.compile(rb"[\x00-\x09\x0b-\x1f\x7f]|\xc2[\x80-\x9f]")


def check(deck, *arguments):
    """Check a deck; return its exit status and what it printed, as bytes."""
    process = subprocess.run([PROGRAM, "check", deck, *arguments], capture_output=True, timeout=PATIENCE,
                             check=False)
    return process.returncode, process.stdout + process.stderr


def refused(deck, message, *arguments):
    """Assert that a deck is refused with this one message."""
    status, said = check(deck, *arguments)
    assert status == 1, said[-400:]
    assert said.count(b"error:") == 1, said[:800]
    assert message.encode() in said, said[:800]
    assert max(map(len, said.splitlines())) < 400


@pytest.mark.parametrize("arguments", [("/dev/stdin",), ("--jobs", "1", "/dev/stdin")])
def test_a_deck_is_read_from_standard_input(tmp_path, arguments):
    for source in ("pipe", "file"):
        out = tmp_path / source
        process = subprocess.run([PROGRAM, "run", "--quiet", *arguments, "--out", out], text=True,
                                 input=GOOD, capture_output=True, check=False)
        assert (process.returncode, process.stderr) == (0, "")
        with h5py.File(out / "stdin.vtkhdf") as file:
            assert len(file["history/time"]) == 2
            assert [line.decode() for line in file["deck"]] == GOOD.splitlines()


def test_a_deck_is_read_from_a_process_substitution(tmp_path):
    write(tmp_path / "good.inp", BODY + STEP)
    line = f"{PROGRAM} run --quiet <(cat good.inp) --out out && ls out"
    process = subprocess.run(["bash", "-c", line], cwd=tmp_path, capture_output=True, text=True,
                             check=False)
    assert process.returncode == 0, process.stderr
    assert process.stdout.split() == ["stdin.cvg", "stdin.lst", "stdin.sta", "stdin.vtkhdf"]


def feed(path, text):
    thread = threading.Thread(target=lambda: path.write_text(text), daemon=True)
    thread.start()
    return thread


def test_a_deck_and_what_it_includes_are_read_from_fifos(tmp_path):
    for name in ("deck.inp", "body.inc"):
        os.mkfifo(tmp_path / name)
    threads = [feed(tmp_path / "deck.inp", "*INCLUDE, INPUT=body.inc\n" + "\n".join(STEP)),
               feed(tmp_path / "body.inc", "\n".join(BODY))]
    process = run("run", "--quiet", tmp_path / "deck.inp", "--out", tmp_path / "out")
    assert (process.returncode, process.stderr) == (0, "")
    for thread in threads:
        thread.join(10)
    assert (tmp_path / "out" / "deck.vtkhdf").exists()


def test_trade_reads_a_deck_through_a_pipe(tmp_path):
    process = subprocess.run([PROGRAM, "trade", "/dev/stdin", "--out", tmp_path, "--limit", "0.001"],
                             text=True, input=GOOD, capture_output=True, check=False, timeout=PATIENCE)
    assert process.returncode == 0, process.stderr
    assert len((tmp_path / "stdin.trade.csv").read_text().splitlines()) > 3


def test_an_endless_file_is_no_deck():
    refused("/dev/zero", "the deck cannot be read: it has more than")


def test_a_parameter_that_doubles_itself_meets_a_limit(tmp_path):
    cards = ["*PARAMETER", "a0 = 12345678"]
    for n in range(39):
        cards += ["*PARAMETER", f"a{n + 1} = <a{n}><a{n}>"]
    deck = write(tmp_path / "doubling.inp", cards, BODY, STEP)
    refused(deck, "10000 characters")


def test_many_includes_meet_a_limit(tmp_path):
    for level in range(20):
        write(tmp_path / f"{level}.inc", [f"*INCLUDE, INPUT={level + 1}.inc"] * 8)
    write(tmp_path / "20.inc", ["** nothing"])
    for first in (10, 0):
        deck = write(tmp_path / "deck.inp", BODY, [f"*INCLUDE, INPUT={first}.inc"], STEP)
        refused(deck, "more than 1000 files, or more than 16 within each other")


@pytest.mark.parametrize("line", ["x" * 10_000_000, "*" + "Y" * 10_000_000, "1," * 5_000_000,
                                  "*ELSET, ELSET=A" + "B" * 10_000_000])
def test_a_long_line_meets_a_limit(tmp_path, line):
    deck = tmp_path / "long.inp"
    deck.write_text("\n".join([*BODY, line, *STEP]))
    refused(deck, "100000 characters", "--width", "20000000")


def test_a_comment_has_any_length(tmp_path):
    deck = write(tmp_path / "long.inp", ["** " + "c" * 1_000_000], BODY, STEP)
    assert run("run", "--quiet", deck, "--out", tmp_path).returncode == 0


def test_a_card_is_echoed_up_to_200_characters(tmp_path):
    for before in (0, 50, 150, 500, 5000):
        card = "*MATERIAL, " + "NAME=A, " + " " * before + "WRONG=1" + " " * 3000 + ", NAME=B"
        deck = write(tmp_path / "wide.inp", BODY, [card, *STEP])
        process = run("check", deck, "--width", 20000)
        image, caret = process.stderr.splitlines()[1:3]
        assert len(image) <= 200
        assert image[caret.index("^"):].startswith("WRONG=1"), (before, image)


@pytest.mark.parametrize("name", [".", "..", "a/b", "/", "./a"])
def test_a_pair_whose_name_is_no_name_in_hdf5_is_refused(tmp_path, name):
    cards = [card.replace("*CONTACT PAIR,", f'*CONTACT PAIR, NAME="{name}",') for card in PAIR]
    refused(write(tmp_path / "pair.inp", cards), "a contact pair must not")


@pytest.mark.parametrize("name", [".", ".."])
def test_a_surface_may_have_any_name_but_a_pair_does_not_take_it(tmp_path, name):
    cards = [card.replace("NAME=UPPER.BOTTOM", f"NAME={name}")
             .replace("UPPER.BOTTOM, LOWER", f"{name}, LOWER") for card in PAIR]
    refused(write(tmp_path / "surface.inp", cards), "a contact pair must not")
    cards = [card.replace("*CONTACT PAIR,", "*CONTACT PAIR, NAME=FACE,") for card in cards]
    assert check(write(tmp_path / "surface.inp", cards))[0] == 0


@pytest.mark.parametrize("name", ["...", "a.b", "A-1_2", ".a"])
def test_other_names_of_pairs_are_taken(tmp_path, name):
    cards = [card.replace("*CONTACT PAIR,", f'*CONTACT PAIR, NAME="{name}",') for card in PAIR]
    deck = write(tmp_path / "pair.inp", cards)
    assert run("run", "--quiet", deck, "--out", tmp_path).returncode == 0
    with h5py.File(tmp_path / "pair.vtkhdf") as file:
        assert [found.upper() for found in file["contact"]] == [name.upper()]


def test_units_in_latin_1_are_those_in_utf_8(tmp_path):
    text = '*HEADING\nWärme\n*OPTIONS, UNITS="cm MPa W °C"\n' + GOOD
    texts = {}
    for code in ("latin-1", "utf-8", "utf-8-sig"):
        deck = tmp_path / f"{code}.inp"
        deck.write_bytes(text.encode(code))
        process = run("run", "--quiet", deck, "--out", tmp_path)
        assert (process.returncode, process.stderr) == (0, "")
        with h5py.File(tmp_path / f"{code}.vtkhdf") as file:
            texts[code] = [line.decode() for line in file["deck"]]
        assert "Wärme" in (tmp_path / f"{code}.lst").read_text(encoding="utf-8")
    assert texts["latin-1"] == texts["utf-8"] == texts["utf-8-sig"] == text.splitlines()


def test_no_control_character_reaches_the_terminal(tmp_path):
    names = ["\x1b[31mred.inp", "bell\x07.inp", "csi\u009b31m.inp", "tab\there.inp",
             "new\nline.inp", "rub\x7fout.inp"]
    for name in names:
        deck = write(tmp_path / name, BODY, STEP)
        for command in ("check", "run"):
            process = run(command, deck, folder=tmp_path)
            assert process.returncode == 0, process.stderr
            said = (process.stdout + process.stderr).encode()
            assert not CONTROL.search(said), said
            assert b"new\nline" not in said
        assert not CONTROL.search(next(tmp_path.glob("*.lst")).read_bytes())
        for path in tmp_path.glob("*.lst"):
            path.unlink()
        bad = write(tmp_path / name, BODY, ["*NONSENSE"], STEP)
        status, said = check(bad)
        assert status == 1
        assert not CONTROL.search(said), said
    for arguments in (["check", "\x1b[2J.inp"], ["run", "no\x1b[2J.inp", "b\x1b.inp"],
                      ["\x1b[2J"], ["run", "--\x1b[2J"], ["run", "a.inp", "--width", "\x1b"],
                      ["check", tmp_path / "a.inp", "--set", "\x1b]0;x\x07=1"],
                      ["run", tmp_path / "a.inp", "--out", "/dev/null/\x1b[2J"]):
        write(tmp_path / "a.inp", BODY, STEP)
        process = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, check=False,
                                 cwd=tmp_path)
        assert process.returncode != 0
        assert not CONTROL.search(process.stdout + process.stderr), process.stderr


@pytest.mark.parametrize("byte", [0, 7, 8, 11, 12, 13, 27, 127])
def test_a_control_character_in_a_deck_is_refused_by_number(tmp_path, byte):
    deck = tmp_path / "control.inp"
    deck.write_bytes(b"** comment" + bytes([byte]) + b"31m red\n" + GOOD.encode())
    refused(deck, f"control character {byte} in line 1")


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
def test_a_deck_in_utf_16_is_refused(tmp_path, encoding):
    deck = tmp_path / "wide.inp"
    deck.write_bytes(GOOD.encode(encoding))
    refused(deck, "it is not text in UTF-8: control character 0 in line 1")


def test_lines_that_end_in_carriage_returns_alone_are_refused(tmp_path):
    deck = tmp_path / "returns.inp"
    deck.write_bytes(GOOD.replace("\n", "\r").encode())
    refused(deck, "it is not text in UTF-8: control character 13 in line 1")


def test_what_is_not_utf_8_is_shown_without_control_characters(tmp_path):
    deck = tmp_path / "latin.inp"
    deck.write_bytes(b"*NONSENSE \x9b31m\t\xe9\n" + GOOD.encode())
    status, said = check(deck)
    assert status == 1
    assert not CONTROL.search(said), said
    assert "é".encode() in said
