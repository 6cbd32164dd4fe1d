"""Words of Abaqus that decks may use: values abbreviated, supports of antisymmetry, fields that mean nothing."""

import pytest
from blocks import write
from deck_runs import run
from physics import material, mesh

WALL = mesh("WALL", [0.0, 1.0], [0.0, 1.0]) + material("WALL", (1000.0, 0.0), 1e-5)


def heated(kind):
    """Return a held square whose initial temperatures have a TYPE=."""
    return [*WALL, "*INITIAL CONDITIONS, TYPE=" + kind, "WALL, 0.", "*STEP", "*STATIC", "1., 1.",
            "*BOUNDARY", "WALL, PINNED", "*END STEP"]


@pytest.mark.parametrize("kind", ["TEMPERATURE", "TEMP", "T"])
def test_a_value_may_be_abbreviated(tmp_path, kind):
    deck = write(tmp_path / "deck.inp", heated(kind))
    process = run("check", "--quiet", deck)
    assert process.returncode == 0, process.stderr


def test_an_ambiguous_value_is_refused(tmp_path):
    deck = write(tmp_path / "deck.inp", heated("S"))
    process = run("check", "--quiet", deck)
    assert process.returncode == 1 and "unknown TYPE=S of *INITIAL CONDITIONS" in process.stderr


@pytest.mark.parametrize(("support", "free"), [("XASYMM", "x"), ("YASYMM", "y"), ("ZASYMM", "")])
def test_antisymmetry_holds_what_abaqus_says(tmp_path, support, free):
    """A plane of antisymmetry of normal x holds u_y, of normal y u_x, of normal z both."""
    cards = [*WALL, "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", f"WALL.BOTTOM, {support}", "*DSLOAD",
             "WALL.TOP, P, 5.", "*END STEP"]
    process = run("check", "--quiet", write(tmp_path / "deck.inp", cards))
    assert process.returncode == (1 if free else 0), process.stderr
    assert ("move along" in process.stderr) == bool(free), process.stderr
    assert free == "" or f"move along {free}" in process.stderr, process.stderr


def test_the_fifth_field_of_heat_transfer_is_named(tmp_path):
    cards = [*WALL, "*DENSITY", "1.", "*SPECIFIC HEAT", "1.", "*CONDUCTIVITY", "1.", "*STEP",
             "*HEAT TRANSFER, END=SS", "500,100000,,,1E-5", "*BOUNDARY", "WALL.BOTTOM, 11", "*END STEP"]
    process = run("check", "--quiet", write(tmp_path / "deck.inp", cards))
    assert "the fifth field" in process.stderr and "decimal comma" not in process.stderr


def test_nothing_is_filled_in_one_interval(tmp_path):
    cards = ["*NODE, NSET=A", "1, 0., 0.", "2, 1., 0.", "*NODE, NSET=B", "11, 0., 1.", "12, 1., 1.",
             "*NFILL, NSET=ALL", "A, B, 1, 10", "*ELEMENT, TYPE=CPE4, ELSET=E", "1, 1, 2, 12, 11",
             "*MATERIAL, NAME=M", "*CONDUCTIVITY", "1.", "*SOLID SECTION, ELSET=E, MATERIAL=M", "*STEP",
             "*HEAT TRANSFER, STEADY STATE", "*BOUNDARY", "ALL, 11, 11, 3.", "*END STEP"]
    process = run("check", "--quiet", write(tmp_path / "deck.inp", cards))
    assert process.returncode == 0, process.stderr
