"""A requested accuracy: *ACCURACY and --accuracy. True errors are those to the converged values of
tests/accuracy/converged.csv, from meshes far finer than any here."""

import csv
import fcntl
import json
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from functools import cache

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from changes import note_changes
from deck_runs import (COUPLED, CYLINDER, DECKS, HERTZ, INPUT, PATIENCE, PROGRAM, copy_deck, of_release,
                       run)
from deck_runs import solve_as_written as solve
from physics import material, mesh, nodes_of

QUANTITIES = "normal_force", "heat_rate", "peak_pressure", "edge_contact"
with (DECKS.parent / "accuracy" / "converged.csv").open(newline="") as told:
    TOLD = {row["deck"]: row for row in csv.DictReader(told)}
CONVERGED = {deck: {quantity: float(TOLD[name][quantity]) for quantity in QUANTITIES}
             for deck, name in ((CYLINDER, "cylinder"), (COUPLED, "coupled twin"))}
FRICTIONLESS = {"*FRICTION\n0.155, 1.E5\n": ""}   # the last increment alone tells all
PRESS_FIT = INPUT / "examples" / "press_fit.inp"


def rounds_of(result, face="FACE"):
    """Return the rounds of a result file: cost, the rows of each quantity (step, value, uncertainty,
    target), and whether the request was reached."""
    with h5py.File(result) as file:
        group = file["accuracy"]
        costs = {name: group[name][:] for name in ("cpu_seconds", "unknowns", "elements", "increments")}
        known = {name: rows[:] for name, rows in group[f"uncertainty/{face}"].items()}
        return costs, known, int(group.attrs["reached"])


@pytest.fixture(scope="module")
def requested(tmp_path_factory):
    """Solve decks once with each target; return the folder of the results and the finished process."""

    @cache
    def solved(deck, percent):
        folder = tmp_path_factory.mktemp("requested")
        process = run("run", deck, "--out", folder, "--accuracy", f"{percent}%")
        assert process.returncode == 0, process.stderr
        return folder, process

    return solved


@pytest.mark.parametrize(("deck", "percent", "rounds"), [(CYLINDER, 1, 2), (COUPLED, 3, 2), (COUPLED, 1, 2)])
def test_true_errors_are_inside_the_target_and_the_uncertainty(requested, deck, percent, rounds):
    """Rounds are as many as are told; the mesh is refined only where the deck's own does not do."""
    folder, process = requested(deck, percent)
    assert f"requested accuracy reached after {rounds} round" in process.stdout
    costs, known, reached = rounds_of(folder / f"{deck.stem}.vtkhdf")
    assert reached == 1 and len(costs["unknowns"]) == rounds
    assert np.all(np.diff(costs["unknowns"]) > 0) and np.all(costs["cpu_seconds"] > 0)
    with h5py.File(folder / f"{deck.stem}.vtkhdf") as file:
        found = {name: file[f"contact/FACE/{name}"][-1] for name in CONVERGED[deck] if "peak" not in name}
        found["peak_pressure"] = file["contact/FACE/pressure"][-1].max()
        elements = len(file["VTKHDF/CellData/element_id"])
        unknowns = sum(file["run"].attrs[name] for name in (
            "equations_thermal", "equations_mechanical", "contact_unknowns"))
        told = {name: file[f"uncertainty/FACE/{name}"][-1, 1] for name in found}
    assert (elements, unknowns) == (costs["elements"][-1], costs["unknowns"][-1])
    # With friction the last increment alone does not tell the peak: what the next round changes does.
    assert np.isnan(known["peak_pressure"][0, 2])
    assert all(np.isfinite(rows[1:]).all() for rows in known.values())
    for name, exact in CONVERGED[deck].items():
        step, value, uncertainty, allowed = known[name][-1]
        assert step == 1 and value == pytest.approx(found[name], rel=1e-12), name
        assert allowed == pytest.approx(percent / 100 * abs(found[name]), rel=0.1), name
        assert abs(value - exact) <= uncertainty <= allowed, name
        assert uncertainty == told[name], f"{name} has two uncertainties"
    listing = (folder / f"{deck.stem}.lst").read_text()
    assert "REQUESTED ACCURACY" in listing and "not met" not in listing


def test_the_listing_has_a_bullet_for_each_sentence_and_none_in_the_table(requested):
    """No line ends in blanks but those of the summary, which is written over."""
    folder, process = requested(CYLINDER, 1)
    told = process.stdout
    said = told[told.index("  requested accuracy"):told.index("  results:")].splitlines()
    table = next(k for k, line in enumerate(said) if line.startswith("     round "))
    listing = (folder / "cylinder.lst").read_text()
    section = listing[listing.index("REQUESTED ACCURACY\n"):].split("\n\n", 2)
    assert table == 6 and [f"   - {line.strip()}" for line in said[:table]] == section[0].splitlines()[2:]
    assert said[table:] == section[1].splitlines()
    summary = listing[:listing.index("INCREMENTS\n")].count("\n")
    lines = listing[:listing.rindex("\nDECK\n")].splitlines()
    assert len(lines) > summary + 500
    assert not [line for line in lines[summary:] if line.endswith(" ")]


@pytest.mark.changes("ACCURACY", "ACCURACY, ROUNDS")
def test_targets_that_are_missed_are_told_with_status_4(tmp_path):
    """One round does not reach what two do; a target in the unit of the quantity is taken as such."""
    cards = "*ACCURACY, ROUNDS=1", "edge_contact, 0.03, ABS, FACE", "normal_force, 0.01"
    deck = copy_deck(CYLINDER, tmp_path / "one.inp", cards)
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 4
    missed = "requested accuracy not reached after 1 round: *ACCURACY, ROUNDS=1 allows no more"
    assert process.stderr == f"{deck}: error: {missed}; not met: FACE edge of contact\n"
    assert f"{deck}: accuracy not reached, " in process.stdout
    assert "check failed" not in process.stdout + process.stderr
    assert "   accuracy not reached, " in deck.with_suffix(".lst").read_text()
    told = re.search(r"FACE edge of contact +not met: uncertainty (\S+) cm, target 0.03 cm\n",
                     process.stdout)
    costs, known, reached = rounds_of(tmp_path / "one.vtkhdf")
    assert reached == 0 and costs["elements"].tolist() == [92]
    assert set(known) == {"edge_contact", "normal_force"}
    assert known["edge_contact"][0, 3] == 0.03 < known["edge_contact"][0, 2]
    assert float(told[1]) == pytest.approx(known["edge_contact"][0, 2], rel=0.05)

    others = "*ACCURACY, ROUNDS=2", *cards[1:2]
    note_changes(cards, others)
    deck = copy_deck(CYLINDER, tmp_path / "two.inp", others)
    _, known, reached = rounds_of(solve(deck))
    assert reached == 1 and known["edge_contact"][1, 2] <= 0.03
    # Only the edge is missed: the elements away from it stay as they are.
    with h5py.File(tmp_path / "two.vtkhdf") as file:
        assert file["accuracy/elements"][1] < 3 * 92


def test_sides_at_an_edge_fall_with_the_distance_from_it(tmp_path):
    """Divided often where it lies, they are as long as before away from it."""
    cards = "*ACCURACY, ROUNDS=2", "edge_contact, 0.027, ABS, FACE"
    result = solve(copy_deck(CYLINDER, tmp_path / "graded.inp", cards))
    with h5py.File(result) as file:
        s, edge = file["contact/FACE/s"][:], file["contact/FACE/edge_contact"][-1]
    with h5py.File(solve(copy_deck(CYLINDER, tmp_path / "plain.inp"))) as file:
        plain = file["contact/FACE/s"][::2]
    # How often each side of the deck's own mesh was divided; its halves are alike to the curvature.
    middle = 0.5 * (s[:-1:2] + s[2::2])
    whole = np.searchsorted(plain, middle) - 1
    divided = np.rint(np.log2(np.diff(plain)[whole] / np.diff(s[::2]))).astype(int)
    assert divided[np.argmin(abs(middle - edge))] == divided.max() > 1
    assert np.abs(np.diff(divided)).max() == 1 and len(middle) < 2 * (len(plain) - 1)


def test_a_course_that_bends_by_itself_keeps_no_request_from_its_target(tmp_path):
    """The crack closes at once: heat and force bend by 23 and 2.5 % of them, which is no scatter. Closed
    as a whole it leaves stresses uniform, and only the sides at its tip can be divided."""
    deck = INPUT / "examples" / "cracked_plate.inp"
    process = run("run", "--quiet", deck, "--out", tmp_path, "--accuracy", "1%")
    assert process.returncode == 0, process.stderr
    _, known, _ = rounds_of(tmp_path / "cracked_plate.vtkhdf", "CRACK")
    step, value, uncertainty, _ = known["heat_rate"][0]
    assert step == 4 and uncertainty < 0.02 * abs(value)
    exact = {quantity: float(TOLD["cracked plate"][quantity]) for quantity in QUANTITIES}
    for quantity, rows in known.items():
        if rows[-1][0] == 4:
            _, value, uncertainty, allowed = rows[-1]
            assert max(abs(value - exact[quantity]), uncertainty) <= allowed, quantity


def test_increments_are_shortened_where_they_are_the_larger_part(tmp_path):
    """With five of them friction errs by 2 %: halves of them reach what no mesh does."""
    cards = "*ACCURACY, ROUNDS=3", "shear_force, 0.02"
    changes = {"\n20., 900.\n": "\n180., 900.\n"}
    text = CYLINDER.read_text().split("*VERIFY")[0]
    source = tmp_path / "long.txt"
    source.write_text(text)
    deck = copy_deck(source, tmp_path / "long.inp", cards, changes)
    run("run", deck, "--out", tmp_path, "--quiet")
    costs, known, _ = rounds_of(tmp_path / "long.vtkhdf")
    assert costs["increments"].tolist() == [5, 5, 10]
    with h5py.File(tmp_path / "long.vtkhdf") as file:
        assert len(file["history/time"]) == costs["increments"][-1]


def test_what_a_deck_does_not_have_is_not_judged(tmp_path):
    """Nothing heats the rings, whose steps solve no heat, nor is there friction."""
    cards = "*ACCURACY", *(f"{name}, 0.03" for name in (*QUANTITIES, "shear_force"))
    shutil.copy(PRESS_FIT.with_suffix(".mesh"), tmp_path)
    deck = copy_deck(PRESS_FIT, tmp_path / "press_fit.inp", cards)
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    told = dict(line.strip().split("nothing to judge: ") for line in process.stdout.splitlines()
                if "nothing to judge" in line)
    assert {name.strip(): words for name, words in told.items()} == {
        "SEAT heat rate": "no heat", "SEAT edge of contact": "whole face",
        "SEAT shear force": "0 at the end of each step"}


def test_steps_without_an_edge_say_what_there_is(tmp_path):
    """The crack is closed, opens, and closes again."""
    process = run("run", INPUT / "examples" / "cracked_plate.inp", "--out", tmp_path, "--accuracy", "90%")
    told = re.search(r"CRACK edge of contact +nothing to judge: (.*)\n", process.stdout)
    assert told[1] == "whole face or none (open)"


def roller(folder):
    """Write a deck of a round face on the middle of a flat one; return its path."""
    xs = np.linspace(0.0, 3.0, 25)
    cards = [
        *mesh("A", xs, [1.0, 1.5, 2.0], "CPE4", to=lambda x, y: (x, y + 0.02 * (x - 1.5) ** 2)),
        *material("A", (200.0, 0.3)),
        *mesh("B", xs, [0.0, 0.5, 1.0], "CPE4", first=101), *material("B", (100.0, 0.3)),
        "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I, NAME=P", "A.BOTTOM, B.TOP"]
    return write(folder / "roller.inp", without_unused_surfaces(cards), [
        "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "B.BOTTOM, 1, 2", "A.TOP, 1", "A.TOP, 2, 2, -0.01",
        "*END STEP"])


def test_per_cent_are_of_what_is_told_beside_them(tmp_path):
    """Of an edge this is the width of the contact, as the summary has it; where that is not the
    value, one line says so."""
    process = run("run", CYLINDER, "--out", tmp_path, "--accuracy", "3%")
    known = rounds_of(tmp_path / "cylinder.vtkhdf")[1]
    told = dict(re.findall(r"FACE (\S.*\S) +met: (uncertainty .*), target 3 %\n", process.stdout))
    assert set(told) == {name.replace("_", " ").replace("edge", "edge of") for name in QUANTITIES}
    for name in QUANTITIES:
        words = name.replace("_", " ").replace("edge", "edge of")
        _, value, uncertainty, allowed = known[name][-1]
        percent, scale, unit = re.fullmatch(r"uncertainty (\S+) % of (\S+) (.*)", told[words]).groups()
        assert float(scale) == pytest.approx(allowed / 0.03, rel=1e-5)
        assert float(percent) == pytest.approx(100 * uncertainty / float(scale), rel=0.06)
        assert float(scale) == pytest.approx(value, rel=1e-5)
        assert unit == {"normal_force": "MPa cm^2", "heat_rate": "W", "peak_pressure": "MPa",
                        "edge_contact": "cm"}[name]
    of_length = "     % of an edge: of the closed length; of a small value: of a part of the largest so far\n"
    assert of_length not in process.stdout
    told = run("run", roller(tmp_path), "--out", tmp_path, "--accuracy", "edge=90%").stdout
    value, width = re.search(r"edge of contact +(\S+) .* width (\S+)\n", told).groups()
    scale = re.search(r"edge of contact +met: uncertainty .* % of (\S+), target", told)[1]
    assert scale == width and float(value) > 1.5 * float(width) and of_length in told


def test_a_target_missed_in_an_earlier_step_has_its_value(tmp_path):
    """The summary has the values of the last step only."""
    cards = ["*ACCURACY, ROUNDS=1", "peak_pressure, 0.01"]
    deck = punch(tmp_path, "A.BOTTOM, B.TOP", 12, cards, 4, length=3)
    text = deck.read_text()
    deck.write_text(text + text[text.index("*STEP"):].replace("-0.01", "-0.001"))
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 4
    step, value, uncertainty, _ = rounds_of(tmp_path / "punch.vtkhdf", "P")[1]["peak_pressure"][-1]
    told = re.search(r"P peak pressure +not met: .*, step (\d) with (\S+) \+- (\S+)\n", process.stdout)
    assert int(told[1]) == step == 1
    assert float(told[2]) == pytest.approx(value, rel=1e-5)
    assert float(told[3]) == pytest.approx(uncertainty, rel=0.06)
    told = run("run", INPUT / "examples" / "brake_pad.inp", "--out", tmp_path, "--accuracy", "5%").stdout
    value = rounds_of(tmp_path / "brake_pad.vtkhdf", "TRACK")[1]["peak_pressure"][-1, 1]
    words = re.search(r"TRACK peak pressure +not met: no estimate, .*, step 1 with (\S+) MPa:", told)
    assert float(words[1]) == pytest.approx(value, rel=1e-5)
    # Those of the last step are in the summary.
    assert re.search(r"TRACK heat rate +met: .*, step 2\n", told)


def test_nothing_is_written_when_nothing_is_requested(tmp_path):
    process = run("run", PRESS_FIT, "--out", tmp_path)
    assert process.returncode == 0 and "requested" not in process.stdout
    with h5py.File(tmp_path / "press_fit.vtkhdf") as file:
        assert "accuracy" not in file


@pytest.mark.parametrize("arguments", [
    ("run", HERTZ, "--accuracy"), ("trade", HERTZ, "--accuracy", "1%")])
def test_options_that_say_nothing_are_refused(tmp_path, arguments):
    process = run(*arguments, folder=tmp_path)
    assert process.returncode == 1 and "--accuracy" in process.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("value", ["1", "0%", "100%", "%"])
def test_a_percentage_out_of_range_is_refused_with_its_limits(tmp_path, value):
    process = run("run", HERTZ, "--accuracy", value, folder=tmp_path)
    assert process.returncode == 1 and not list(tmp_path.iterdir())
    assert "--accuracy needs a percentage above 0% and below 100%, such as 1%, or those of " in process.stderr
    assert process.stderr.endswith(f", not {value}\n")


def test_a_misspelt_quantity_is_told_with_the_nearest(tmp_path):
    process = run("run", HERTZ, "--accuracy", "force=1%,pressur=1%", folder=tmp_path)
    assert process.returncode == 1
    assert process.stderr.endswith(", not force=1%,pressur=1%; the nearest known is pressure\n")


def test_named_quantities_have_targets_of_their_own(tmp_path):
    process = run("run", HERTZ, "--accuracy", "force=1%,peak_pressure=20%", "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    told = re.findall(r"^     FACE (.*?)  +met: .*, target (.*)$", process.stdout, flags=re.M)
    assert told == [("normal force", "1 %"), ("peak pressure", "20 %")]
    with h5py.File(tmp_path / "hertz.vtkhdf") as file:
        assert file["run"].attrs["settings"] == "--accuracy force=1%,peak_pressure=20%"


def test_a_time_limit_ends_the_rounds_with_the_last_whole_one(tmp_path):
    """Between two rounds or within one; the first is always whole. It needs a request."""
    process = run("run", HERTZ, "--accuracy", "0.001%", "--limit", "1s", "--out", tmp_path)
    assert process.returncode == 4 and "--limit" in process.stderr
    with h5py.File(tmp_path / "hertz.vtkhdf") as file:
        assert not file["accuracy"].attrs["reached"] and file["run"].attrs["verify_passed"] == 12
    process = run("run", HERTZ, "--accuracy", "0.001%", "--limit", "0.001", "--out", tmp_path)
    assert process.returncode == 4
    assert "not reached after 1 round: --limit leaves no time for another one" in process.stderr
    process = run("run", HERTZ, "--limit", "1s", "--out", tmp_path / "none")
    assert process.returncode == 1 and "--limit ends the rounds of a requested" in process.stderr


@pytest.mark.parametrize("name", ["brake_pad", "roller", "press_fit"])
def test_a_number_has_one_verdict(tmp_path, name):
    """The uncertainty in the summary is the one that its target is judged by."""
    process = run("run", INPUT / "examples" / f"{name}.inp", "--accuracy", "5%", "--out", tmp_path)
    met = set(re.findall(r"^     \S+ (.*?)  +met: ", process.stdout, flags=re.M))
    unsure = set(re.findall(r"^    (\S.*?)  +\S+ \(no estimate: ", process.stdout, flags=re.M))
    assert met and not met & unsure
    with h5py.File(tmp_path / f"{name}.vtkhdf") as file:
        for face, targets in file["accuracy/uncertainty"].items():
            for key, rows in targets.items():
                step, value, uncertainty, _ = rows[-1]
                if step == len(file["uncertainty/time"]):
                    told = file[f"uncertainty/{face}/{key}"][-1, :2]
                    np.testing.assert_array_equal(told, [value, uncertainty])


def test_a_deck_without_contact_has_nothing_to_request(tmp_path):
    deck = tmp_path / "bar.inp"
    deck.write_text(
        "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n*ELEMENT, TYPE=CPE4, ELSET=ALL\n1, 1, 2, 3, 4\n"
        "*MATERIAL, NAME=STEEL\n*ELASTIC\n2.E5, 0.3\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n"
        "*STEP\n*STATIC\n1., 1.\n*BOUNDARY\n1, 1, 2\n2, 2, 2\n*CLOAD\n3, 2, 1.\n*END STEP\n")
    assert run("run", deck, "--out", tmp_path).returncode == 0
    process = run("run", deck, "--out", tmp_path, "--accuracy", "1%")
    assert process.returncode == 1 and "no *CONTACT PAIR" in process.stderr


EQUATION = "*EQUATION", "2", "127, 2, 1., 138, 2, 1."


def punch(folder, faces, columns, cards=(), width=None, length=1):
    """Write a deck of a punch on a wider body, whose face has a number of columns of elements, or of a
    part of these; or of a block of which only a length of 1 is in contact. Return its path."""
    cards = [
        *mesh("A", np.linspace(0.0, length, 4 * length + 1), [1.0, 1.5, 2.0], "CPE4"),
        *material("A", (200.0, 0.3)),
        *mesh("B", np.linspace(0.0, 3.0, columns + 1), [0.0, 0.5, 1.0], "CPE4", first=101),
        *material("B", (100.0, 0.3)),
        "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I, NAME=P", faces, *cards]
    cards = without_unused_surfaces(cards)
    top = cards.index("*SURFACE, NAME=B.TOP") + 1
    del cards[top + (width or columns):top + columns]
    top = cards.index("*SURFACE, NAME=A.BOTTOM") + 1
    del cards[top + 4:top + 4 * length]
    return write(folder / "punch.inp", cards, [
        "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "B.BOTTOM, 1, 2", "A.LEFT, 1", "B.LEFT, 1",
        "A.TOP, 2, 2, -0.01", "*END STEP"])


@pytest.mark.parametrize("faces", ["A.BOTTOM, B.TOP", "B.TOP, A.BOTTOM"])
@pytest.mark.parametrize(("columns", "width"), [(8, None), (12, 4)], ids=["mortar points", "node pairs"])
def test_a_pressure_without_limit_is_never_reached_and_costs_no_round(tmp_path, faces, columns, width):
    """The pressure at the edge of a punch grows without limit, whichever face is the slave."""
    reason = "1 round: a pressure without a limit meets no target: ask for other quantities, on " \
        "*ACCURACY or as --accuracy force=5%"
    deck = punch(tmp_path, faces, columns, width=width)
    process = run("run", deck, "--out", tmp_path, "--accuracy", "95%")
    assert process.returncode == 4, process.stderr
    for words in (process.stdout, " ".join(deck.with_suffix(".lst").read_text().split())):
        assert "not met: no estimate, target 95 %: at a corner" in words
        assert f" not reached after {reason}" in words
    assert re.fullmatch(f".*{re.escape(reason)}; not met: P peak pressure\n", process.stderr)
    _, known, reached = rounds_of(tmp_path / "punch.vtkhdf", "P")
    assert not reached and np.all(np.isnan(known["peak_pressure"][:, 2]))
    with h5py.File(tmp_path / "punch.vtkhdf") as file:
        assert np.isnan(file["uncertainty/P/peak_pressure"][-1, 1])
        assert file["uncertainty/P/normal_force"][-1, 1] < 0.1


@pytest.mark.parametrize(("columns", "width"), [(8, None), (12, 4)], ids=["mortar points", "node pairs"])
def test_the_other_targets_are_met_beside_a_pressure_without_limit(tmp_path, columns, width):
    """The peak grows on from round to round all the same."""
    deck = punch(tmp_path, "A.BOTTOM, B.TOP", columns, width=width)
    process = run("run", deck, "--out", tmp_path, "--accuracy", "1%")
    assert process.returncode == 4, process.stderr
    assert "or as --accuracy force=5%; not met: P peak pressure\n" in process.stderr
    _, known, _ = rounds_of(tmp_path / "punch.vtkhdf", "P")
    force, peak = known["normal_force"], known["peak_pressure"]
    assert force[0, 2] > force[0, 3] and force[-1, 2] <= force[-1, 3]
    assert peak[-1, 1] > 1.05 * peak[0, 1]


def advice_of(process, deck):
    """Return what limits a request, as the last lines of the run, the listing and --json have it."""
    lines = process.stdout.splitlines()
    last = max(k for k, line in enumerate(lines) if re.match(r" +\d+ +\d+\.\d\d ", line))
    told = [line.strip() for line in lines[last + 1:] if " limits it: " in line]
    assert lines[last + 1:last + 1 + len(told)] == [f"     {words}" for words in told]
    listing = " ".join(deck.with_suffix(".lst").read_text().split())
    assert all(words in listing for words in told)
    return told


@pytest.mark.parametrize(("targets", "instead"), [
    ("95%", "force=95%"), ("pressure=1%", "force=5%")])
def test_the_corner_that_limits_a_pressure_is_named(tmp_path, targets, instead):
    """Node 9 is at (1, 1), the corner of the punch; the node of the body opposite is at (1.125, 1)."""
    deck = punch(tmp_path, "A.BOTTOM, B.TOP", 8)
    process = run("run", deck, "--out", tmp_path, "--accuracy", targets)
    assert process.returncode == 4
    told, = advice_of(process, deck)
    place = nodes_of(deck.read_text().splitlines())
    node, other = map(int, re.search(r"where nodes (\d+) and (\d+) meet;", told).groups())
    assert place[node] == (1.0, 1.0) and place[other] == (1.125, 1.0)
    assert told.startswith("P peak pressure limits it: ") and told.endswith(f"--accuracy {instead}")
    process = run("run", deck, "--out", tmp_path, "--accuracy", targets, "--json")
    assert json.loads(process.stdout)["accuracy"]["lines"][-1] == told


def test_rounds_that_are_missing_are_as_many_as_are_told(tmp_path):
    """The order is that of the rounds in the file, and the deck with as many more reaches its target."""
    cards = "edge_contact, 0.001", "*OPTIONS, ERRORS=LAST"
    deck = copy_deck(HERTZ, tmp_path / "two.inp", ["*ACCURACY, ROUNDS=2", *cards])
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 4, process.stderr
    told, = advice_of(process, deck)
    order, more, seconds, rounds, within = re.fullmatch(
        r"FACE edge of contact limits it: its uncertainty falls as unknowns to the power -(\S+); about "
        r"(\d+) more rounds? \((\S+) CPU seconds\) would do: \*ACCURACY, ROUNDS=(\d+); "
        r"this mesh reaches --accuracy edge=(\S+)%", told).groups()
    costs, known, _ = rounds_of(tmp_path / "two.vtkhdf")
    slope = np.diff(np.log(known["edge_contact"][:, 2])) / np.diff(np.log(costs["unknowns"]))
    assert float(order) == pytest.approx(-slope[0], rel=0.05)
    assert int(rounds) == 2 + int(more) and float(seconds) > costs["cpu_seconds"][1]
    part = 0.001 * known["edge_contact"][1, 2] / known["edge_contact"][1, 3]
    assert part <= float(within) / 100 <= 2.5 * part
    deck = copy_deck(HERTZ, tmp_path / "more.inp", [f"*ACCURACY, ROUNDS={rounds}", *cards])
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    _, known, reached = rounds_of(tmp_path / "more.vtkhdf")
    assert reached and len(known["edge_contact"]) in (int(rounds), int(rounds) - 1)
    assert " limits it: " not in process.stdout


def test_pressures_of_linear_elements_stay_alike_from_round_to_round(tmp_path):
    """A ring on a shaft as long: pressures fall to the free end, smoothly. Where sides of two lengths
    met inside of the contact, they would alternate by 4 %."""
    cards = [*mesh("A", np.linspace(50.0, 75.0, 9), np.linspace(0.0, 20.0, 9), "CAX4"),
             *material("A", (210e3, 0.3)),
             *mesh("B", np.linspace(10.0, 50.0, 9), np.linspace(0.0, 20.0, 9), "CAX4", first=101),
             *material("B", (600e3, 0.22)),
             "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.1",
             "*CONTACT PAIR, INTERACTION=I, NAME=P, PAIRING=SURFACES", "A.LEFT, B.RIGHT",
             "*CLEARANCE, SLAVE=A.LEFT, MASTER=B.RIGHT, VALUE=-0.05"]
    deck = write(tmp_path / "fit.inp", without_unused_surfaces(cards), [
        "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "A.BOTTOM, 2", "B.BOTTOM, 2", "*END STEP"])
    process = run("run", deck, "--out", tmp_path, "--accuracy", "1%")
    assert process.returncode == 0, process.stderr
    with h5py.File(tmp_path / "fit.vtkhdf") as file:
        s, p = (file[f"contact/P/{name}"][...] for name in ("s", "pressure"))
    p = p[-1][s < 10.0]
    assert np.all(np.abs(p[1:-1] - (p[:-2] + p[2:]) / 2) < 0.005 * p[1:-1])


def test_a_request_that_stops_at_an_end_of_the_face_says_so(tmp_path):
    """Both bodies go on where the faces end, so that there is an uncertainty, which is large in every round."""
    deck = punch(tmp_path, "A.BOTTOM, B.TOP", 12, width=4, length=3)
    process = run("run", deck, "--out", tmp_path, "--accuracy", "3%")
    assert process.returncode == 4, process.stderr
    for words in (process.stdout, " ".join(deck.with_suffix(".lst").read_text().split())):
        assert "; the peak is at an end of the face, where the pressure may grow without limit" in words
        assert "its uncertainty did not fall in the last rounds, and its peak is at an end of the face" in words


def test_a_model_with_equations_is_judged_by_its_uncertainties(tmp_path):
    """Both bodies go on where the faces end, so that the peak has an uncertainty in every round."""
    cards = [*EQUATION, "*ACCURACY", "peak_pressure, 0.6"]
    deck = punch(tmp_path, "A.BOTTOM, B.TOP", 12, cards, 4, length=3)
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 4, process.stderr
    assert "the last two came no nearer to the targets; not met: P peak pressure\n" in process.stderr
    peak = rounds_of(tmp_path / "punch.vtkhdf", "P")[1]["peak_pressure"]
    assert np.all(np.diff(peak[:, 1], 2) > 0.0) and np.all(peak[:, 2] > 0.6 * peak[:, 1])


@pytest.mark.parametrize(("columns", "width"), [(8, None), (12, 4)], ids=["mortar points", "node pairs"])
def test_a_number_without_an_uncertainty_says_why(tmp_path, columns, width):
    """In the summary, in the table of uncertainties, and where a target is missed by it."""
    cards = ["*ACCURACY, ROUNDS=1", "peak_pressure, 0.01"]
    deck = punch(tmp_path, "A.BOTTOM, B.TOP", columns, cards, width)
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 4, process.stderr
    told = re.findall(r"^    (\S.*\S) +\S+ \(no estimate: (.*?)\)", process.stdout, flags=re.M)
    assert told == [("peak pressure", "at a corner")]
    assert "\n    no estimate: at a corner\n" in deck.with_suffix(".lst").read_text()
    assert "not met: no estimate, target 1 %: at a corner\n" in process.stdout


def test_an_edge_that_a_finer_mesh_does_not_have_has_no_uncertainty(tmp_path):
    """A punch that is moved aside sticks at one contact point of its own mesh alone."""
    deck = punch(tmp_path, "A.BOTTOM, B.TOP", 8)
    text = deck.read_text().replace("*CONTACT PAIR", "*FRICTION\n0.02\n*CONTACT PAIR")
    deck.write_text(text.replace("1., 1.\n", "0.25, 1.\n").replace("A.LEFT, 1\n", "").replace(
        "A.TOP, 2, 2, -0.01", "A.TOP, 2, 2, -0.01\nA.TOP, 1, 1, -0.001"))
    process = run("run", deck, "--out", tmp_path, "--errors", "full")
    assert re.search(r"\n    edge of stick .*\(no estimate: not there on a finer mesh\).*, stick from 0.375 to ",
                     process.stdout), process.stdout
    assert "\n    no estimate: not there on a finer mesh\n" in deck.with_suffix(".lst").read_text()


def kept_round(folder, name, words):
    """Return the round that the files of a run are of, whose request ended early; they are whole, of
    one and the same round, and say so."""
    assert sorted(f.name for f in folder.iterdir()) == sorted(
        name + end for end in (".contact.vtkhdf", ".cvg", ".inp", ".lst", ".sta", ".vtkhdf"))
    costs, _, reached = rounds_of(folder / f"{name}.vtkhdf")
    whole = len(costs["elements"])
    with h5py.File(folder / f"{name}.vtkhdf") as file:
        assert reached == 0 and file["accuracy"].attrs["later_round_begun"] == 1
        times = file["history/time"][:]
        assert len(times) == costs["increments"][-1]
        assert len(file["VTKHDF/CellData/element_id"]) == costs["elements"][-1]
        passes = len(file["convergence/increment"])
    with h5py.File(folder / f"{name}.contact.vtkhdf") as file:
        np.testing.assert_array_equal(file["VTKHDF/Steps/Values"][:], times)
    assert len((folder / f"{name}.sta").read_text().splitlines()) == 1 + len(times)
    assert len((folder / f"{name}.cvg").read_text().splitlines()) == 1 + passes
    said = f"; the results are those of round {whole}"
    assert said in words, words
    listing = (folder / f"{name}.lst").read_text()
    assert (f"accuracy not reached, {len(times)} increments; round {whole + 1} is being solved, or "
            "see ENDED EARLY at the end\n") in re.sub(" +\n", "\n", listing)
    assert re.search(rf"requested accuracy not reached after {whole} rounds?; round {whole + 1} was "
                     "begun", listing)
    assert listing.count("\nSECONDS\n") == 1
    reason = re.search(r"error: (?:round \d+: )?([^;\n]+)", words)[1]
    if "\nENDED EARLY\n" in listing:   # one that ends within an increment prints its line alone
        ended = " ".join(listing[listing.index("\nENDED EARLY\n"):].split())
        assert reason in ended and ended.count("esults are those of round ") == 1
        assert f"The results are those of round {whole}" in ended
    return whole


def in_a_later_round(folder, seconds):
    """Start a run whose later rounds take seconds; return it so long after the first one."""
    deck = copy_deck(CYLINDER, folder / "deck.inp", ["*REFINE, LEVELS=1"], FRICTIONLESS)
    process = subprocess.Popen(
        [PROGRAM, "run", "--accuracy", "0.01%", deck, "--out", folder], text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    wait_for(process, folder / "deck.lst", "REQUESTED ACCURACY")
    time.sleep(seconds)
    return process


def wait_for(process, path, words):
    """Wait until a file of a run holds some words."""
    until = time.monotonic() + PATIENCE
    while words not in text_of(path):
        assert process.poll() is None and time.monotonic() < until
        time.sleep(0.01)


def text_of(path):
    """Return the text of a file, none where it is not there: a run that begins may create it, delete
    it and create it again."""
    with suppress(FileNotFoundError):
        return path.read_text()
    return ""


@pytest.mark.parametrize("seconds", [0.0, 0.3, 1.2])
def test_a_signal_in_a_later_round_keeps_the_last_whole_one(tmp_path, seconds):
    """Wherever it comes: while the next round is prepared, reduced, or solved. One that ends within an
    increment prints one line only."""
    process = in_a_later_round(tmp_path, seconds)
    process.send_signal(signal.SIGINT)
    output, words = process.communicate(timeout=PATIENCE)
    assert process.returncode == 5, words
    whole = kept_round(tmp_path, "deck", words)
    assert f"ended by SIGINT in round {whole + 1} " in words
    if output:
        assert "deck.inp: interrupted, 45 increments" in output
        assert f"results: {tmp_path}/deck" in output
        assert re.search(rf"not reached after {whole} rounds?; round {whole + 1} was begun\n", output)


def test_a_first_round_that_is_not_whole_has_no_row(tmp_path):
    deck = copy_deck(CYLINDER, tmp_path / "deck.inp", ["*REFINE, LEVELS=3"], FRICTIONLESS)
    process = subprocess.Popen(
        [PROGRAM, "run", "--accuracy", "1%", deck, "--out", tmp_path], text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    wait_for(process, tmp_path / "deck.sta", "\n")
    process.send_signal(signal.SIGINT)
    output, words = process.communicate(timeout=PATIENCE)
    assert process.returncode == 5, words
    told = "requested accuracy not reached: round 1 did not come to its end\n"
    assert told in output and told in (tmp_path / "deck.lst").read_text()
    assert "CPU seconds" not in output
    assert "(no estimate: needs ERRORS=FULL)" in output
    with h5py.File(tmp_path / "deck.vtkhdf") as file:
        assert "accuracy" not in file


def test_files_of_a_later_round_hold_the_verdicts_of_the_first(tmp_path):
    check = ['*VERIFY, KIND=ANALYTIC, SOURCE="wrong on purpose"', "time, , LAST, 2., 1.E-6",
             "time, , LAST, 900., 1.E-6"]
    deck = copy_deck(CYLINDER, tmp_path / "deck.inp", changes={"*VERIFY": "** VERIFY"})
    deck.write_text(deck.read_text().split("** VERIFY")[0] + "\n".join(check) + "\n")
    process = run("run", deck, "--out", tmp_path, "--accuracy", "1%")
    assert process.returncode == 4 and "reached after 2 rounds" in process.stdout
    assert "\n  1 check passed, 1 failed" in process.stdout
    listing = (tmp_path / "deck.lst").read_text()
    assert "check failed, 45 increments" in listing
    assert "1 check passed, 1 failed" in listing
    with h5py.File(tmp_path / "deck.vtkhdf") as file:
        assert file["run"].attrs["verify_passed"] == file["run"].attrs["verify_failed"] == 1


def test_a_later_round_that_does_not_converge_keeps_the_last_whole_one(tmp_path):
    """With as many iterations as the mesh of the deck needs, and no cut-backs."""
    deck = copy_deck(COUPLED, tmp_path / "deck.inp", changes={
        "METHOD=NEWTON": "METHOD=NEWTON, MAXITER=9"} | FRICTIONLESS)
    process = run("run", deck, "--out", tmp_path, "--accuracy", "0.3%")
    assert process.returncode == 2
    whole = kept_round(tmp_path, "deck", process.stderr)
    assert whole > 0
    assert f"error: round {whole + 1}: increment " in process.stderr
    assert "the conductance does not converge in 9 iterations" in process.stderr
    assert "deck.inp: not converged, 45 increments" in process.stdout
    assert f"requested accuracy not reached after {whole} round" in process.stdout
    assert "results: " in process.stdout and "check failed" not in process.stderr
    listing = (tmp_path / "deck.lst").read_text()
    assert "ITERATION HISTORY" in listing[listing.index("\nENDED EARLY\n"):]


def test_a_later_round_that_is_refused_keeps_the_last_whole_one(tmp_path):
    """Numbers of elements near the largest integer leave none for those of a finer mesh."""
    deck = copy_deck(CYLINDER, tmp_path / "deck.inp", changes={
        "\n1046, 1148, ": "\n2147483600, 1148, "})
    process = run("run", deck, "--out", tmp_path, "--accuracy", "1%")
    assert process.returncode == 2, process.stderr
    assert "the numbers of new nodes and elements" in process.stderr
    assert "error: round 2 cannot begin; the results are those of round 1\n" in process.stderr
    rows, _, reached = rounds_of(tmp_path / "deck.vtkhdf")
    assert len(rows["elements"]) == 1 and reached == 0
    assert "requested accuracy not reached after 1 round" in process.stdout


@of_release
def test_a_later_round_without_memory_keeps_the_last_whole_one(tmp_path):
    """Some limit of the process lets it solve the first round and not a later one."""
    kept = []
    for megabytes in range(210, 310, 20):
        folder = tmp_path / str(megabytes)
        folder.mkdir()
        deck = copy_deck(CYLINDER, folder / "deck.inp")
        limit = megabytes * 1000000
        process = subprocess.run(
            [PROGRAM, "run", deck, "--out", folder, "--accuracy", "0.3%"],
            capture_output=True, text=True, check=False,
            preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        assert process.returncode in (0, 3), process.stderr
        if "results are those of round" in process.stderr:
            assert re.search("(not enough memory|memory ran out): ", process.stderr)
            assert "results: " in process.stdout or "memory ran out: " in process.stderr
            kept.append(kept_round(folder, "deck", process.stderr))
        elif process.returncode == 3:
            assert not (folder / "deck.vtkhdf").exists()
    assert kept, "no limit ends a later round"


@of_release
@pytest.mark.parametrize("seconds", [0.0, 0.5, 1.2])
def test_memory_that_runs_out_in_a_later_round_keeps_the_last_whole_one(tmp_path, seconds):
    """As where others take it meanwhile, which no estimate can foresee."""
    process = in_a_later_round(tmp_path, seconds)
    resource.prlimit(process.pid, resource.RLIMIT_AS, (1000000, 1000000))
    output, words = process.communicate(timeout=PATIENCE)
    assert process.returncode == 3, words
    assert kept_round(tmp_path, "deck", words) > 0
    if "memory ran out: " in words:   # within an increment or a reduction
        assert output == "" and words.count("\n") == 1
    else:
        assert "deck.inp: out of memory, 45 increments" in output and "results: " in output


def test_a_run_keeps_its_lock_from_round_to_round(tmp_path):
    """A lock that is asked for all the time is had when the run has ended; had it before, the run
    would end with "another run writes here"."""
    deck = copy_deck(CYLINDER, tmp_path / "deck.inp", changes=FRICTIONLESS)
    deck.write_text(deck.read_text().split("*VERIFY")[0])
    process = subprocess.Popen(
        [PROGRAM, "run", "--quiet", "--accuracy", "0.5%", deck, "--out", tmp_path],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    listing = tmp_path / "deck.lst"
    while not text_of(listing) and process.poll() is None:
        pass
    with listing.open() as file:
        while True:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                pass
        words = process.communicate(timeout=PATIENCE)[1]
    assert process.returncode == 0, words
    assert rounds_of(tmp_path / "deck.vtkhdf")[2] == 1


def test_all_rounds_are_of_the_deck_as_it_was_read_first(tmp_path):
    """A pipe can be read only once."""
    with subprocess.Popen(["cat", CYLINDER], stdout=subprocess.PIPE) as deck:
        process = subprocess.run([PROGRAM, "run", "/dev/stdin", "--accuracy", "1%"], text=True,
                                 cwd=tmp_path, stdin=deck.stdout, capture_output=True, check=False)
    assert process.returncode == 0, process.stderr
    assert "requested accuracy reached after 2 rounds" in process.stdout


@pytest.mark.parametrize("target", ["0.1%", "pressure=0.05%"])
def test_a_uniform_pressure_comes_nearer_to_its_target(tmp_path, target):
    """Of a shaft in a hub of the same steel, E overlap/(2 r) (1 - r^2/R^2): elements that err alike are
    divided alike, for pressures of four-node elements alternate beside hanging nodes."""
    cards = [*mesh("SHAFT", [*np.linspace(0.0, 20.0, 9)], [*np.linspace(0.0, 30.0, 9)], "CAX4I"),
             *mesh("HUB", [*np.linspace(20.0, 40.0, 9)], [*np.linspace(0.0, 30.0, 9)], "CAX4I", first=1001)]
    for name in ("SHAFT", "HUB"):
        cards += material(name, (2.1e5, 0.3))
    deck = write(tmp_path / "fit.inp", [
        *cards, "*SURFACE INTERACTION, NAME=DRY", "*CONTACT PAIR, INTERACTION=DRY, NAME=FIT",
        "SHAFT.RIGHT, HUB.LEFT", "*CLEARANCE, SLAVE=SHAFT.RIGHT, MASTER=HUB.LEFT, VALUE=-0.03",
        "*BOUNDARY", "SHAFT.BOTTOM, 2", "HUB.BOTTOM, 2", "*STEP", "*STATIC", "*END STEP",
        "*VERIFY, KIND=NONE", "pressure, MAX, LAST"])
    process = run("run", deck, "--out", tmp_path, "--accuracy", target)
    assert process.returncode == 0, process.stderr
    with h5py.File(tmp_path / "fit.vtkhdf") as file:
        found = file["contact/FIT/pressure"][-1]
    (told, own), = re.findall(r"peak pressure +(\S+) \+- (\S+)", process.stdout)
    assert np.abs(found - 118.125).max() <= float(own)
    # What a card asks for is that of the last round.
    (asked,) = re.findall(r"pressure MAX: (\S+) ", process.stdout)
    assert asked == told
