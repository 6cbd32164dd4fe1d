"""thercon trade: rows that are recommended hold on decks with known answers; failures are told.

A row is measured against the truth by a run of the deck that its row describes, written here as
cards, and not by what the table says of it.
"""

import csv
import itertools
import os
import re
import signal
import subprocess
import time
from contextlib import contextmanager

import h5py
import numpy as np
import pytest
import transients
from blocks import write
from deck_runs import CYLINDER, HERTZ, INPUT, PATIENCE, PROGRAM, of_release, run, solve
from physics import DECKS  # noqa: F401  puts tests/reference on the path
from test_known_rods import BRANCH, RODS
from test_physics_rings import CLOSED, tubes

import lame
import rods

FIGURES = "normal_force", "heat_rate", "peak_pressure", "edge_contact", "edge_stick"
QUANTITIES = *FIGURES, "temperature"
SAME_TIME = 2e-3  # seconds: docs/running.md
WISHES = {"recommended_10": 0.1, "recommended_1": 0.01, "recommended_0.1": 0.001}
COLUMNS = [
    *("row", "default", "elements", "level", "contact_level", "increment_factor", "varied"),
    *("status", "reason", "increments", "passes", "runs", "cpu_seconds", "peak_megabytes"),
    *(f"error_{name}" for name in QUANTITIES),
    *("error_worst", "pareto", *WISHES),
]
CARDS = {"TOL": "*FIXED POINT, <>", "MUMPS": "*SOLVER, TYPE=<>"}
CARDS |= {name: "*FIXED POINT, METHOD=<>" for name in ("NEWTON", "ANDERSON", "ZAITSEV", "PICARD")}
CARDS |= {name: "*THERMAL SCHEME, TYPE=<>" for name in ("IMPLICIT", "L-STABLE", "GALERKIN", "CRANK", "EXPLICIT")}
PAIRINGS = "NODES", "SURFACES"
ACCURACIES = "--accuracy 10 %", "--accuracy 1 %", "--accuracy 0.1 %"


def trade(deck, folder, *arguments, status=0):
    """Run a trade; return its rows, the last of which is that of the reference, and its output."""
    process = run("trade", deck, "--out", folder, *arguments)
    assert process.returncode == status, process.stderr
    with open(folder / f"{deck.stem}.trade.csv", newline="") as file:
        reader = csv.DictReader(file)
        rows = list(reader)
    assert reader.fieldnames == COLUMNS
    return rows, process


def slaves(deck):
    """Return the slave surfaces of the contact pairs of a deck or of what it includes."""
    lines = [line for path in (deck, *deck.parent.glob("*.inc")) for line in
             path.read_text().splitlines() if not line.startswith("**")]
    return [data.split(",")[0].strip() for card, data in itertools.pairwise(lines)
            if card.startswith("*CONTACT PAIR")]


def as_cards(deck, row, target):
    """Write the deck that a row stands for: cards of mesh, elements and increments, and of the one
    thing varied. Return its path."""
    lines, keep, due = [], True, False
    for line in deck.read_text().splitlines():
        if line.startswith("*") and not line.startswith("**"):
            keep = not re.match(r"\*(VERIFY|REFINE)", line)
            due = due or bool(re.match(r"\*(STATIC|COUPLED|HEAT)", line))
            if line.startswith("*STEP") and not any("*REFINE" in card for card in lines):
                order = 1 if row["elements"] == "Q4" else 2
                lines += [f"*OPTIONS, ORDER={order}", f"*REFINE, LEVELS={row['level']}"]
                if row["contact_level"] != "0":   # on all of these decks nodes of faces match
                    lines += [f"*REFINE, LEVELS={row['contact_level']}, SURFACE={name}"
                              for name in slaves(deck)]
                lines += [card for word, card in CARDS.items() if row["varied"].startswith(word)]
                lines = [card.replace("<>", row["varied"]) for card in lines]
                lines += accuracy_cards(row["varied"])
            line = line.replace("INC=100", "INC=1000")
            if line.startswith("*CONTACT PAIR") and row["varied"] in PAIRINGS:
                line = re.sub(r", PAIRING=\w+", "", line) + f", PAIRING={row['varied']}"
        elif due and not line.startswith("*"):
            first, period = line.split(",")[:2]
            longer = min(float(first) * float(row["increment_factor"]), float(period))
            line, due = f"{longer!r}, {period}", False
        if keep:
            lines.append(line)
    target.write_text("\n".join(lines) + "\n")
    return target


def accuracy_cards(varied):
    """Return the cards that ask for what --accuracy asks for; none where nothing is."""
    if not varied.startswith("--accuracy"):
        return []
    target = float(varied.split()[1]) / 100.0
    names = ("normal_force", "heat_rate", "peak_pressure", "edge_contact")
    return ["*ACCURACY", *(f"{name}, {target!r}" for name in names)]


def last_figures(result, name):
    """Return the figures of a contact pair at the last increment."""
    with h5py.File(result) as file:
        face = file[f"contact/{name}"]
        found = {key: face[key][-1] for key in FIGURES if key in face}
        return found | {"peak_pressure": face["pressure"][-1].max()}


def rod(name):
    """Return a deck of the rods with its last figures: their area is one."""
    both, open_law, closed_law = RODS[name]
    omega = rods.solutions(both, open_law, closed_law)[BRANCH.get(name, 0)]
    flux = both.flux(omega)
    pressure = max(-both.separation(flux), 0.0) / both.compliance
    known = {"heat_rate": flux, "normal_force": pressure, "peak_pressure": pressure}
    return INPUT / "rods" / f"{name}.inp", "FACE", {key: v for key, v in known.items() if v}, 1e-8


def hertz():
    """Return the Hertz deck: a and p0 of the half plane; that the bodies are 39 times as large as
    the contact changes them by the order of (a/40)^2 = 6.5e-4."""
    known = {"normal_force": 240.0, "peak_pressure": 299.23593, "edge_contact": 1.0211925}
    return HERTZ, "FACE", known, 1.5e-3


def press_fit():
    """Return the press fit: Lame in plane stress, exact."""
    pressure = lame.press_fit(20.0, 40.0, 60.0, (2.1e5, 0.3), (7.0e4, 0.33), 0.05, "stress")
    known = {"peak_pressure": pressure, "normal_force": pressure * 2 * np.pi * 40.0 * 10.0}
    return INPUT / "examples" / "press_fit.inp", "SEAT", known, 1e-8


def hot_tubes(folder):
    """Return tubes that heat presses together. Refined elements keep the shape that the deck's 16
    elements around have: their parabolas are off the circle by less than 1e-4 of the radius, and
    the overlap is 1e-2 of it."""
    cards, known = tubes("CPE8", 16, CLOSED)
    deck = write(folder / "tubes.inp", ["*OPTIONS, WIDTH=300"], cards)
    sums = {key: known[key] for key in ("normal_force", "heat_rate") if key in known}
    return deck, "FACE", sums, 1e-3


# Closed, and the middle one of three solutions, which only its start leads to; R2 is below.
KNOWN = {name: lambda _, name=name: rod(name) for name in ("r1", "r3-middle")}
KNOWN |= {"hertz": lambda _: hertz(), "press_fit": lambda _: press_fit(), "hot_tubes": hot_tubes}


def check_recommendations(rows, deck, name, known, model_error):
    """Assert that every row recommended has a true error within the wish, but for what its
    recommendation names; model_error is by how far the known answer is not that of the deck."""
    checked = set()
    for column, wish in WISHES.items():
        for row in rows:
            if not row[column]:
                continue
            result = solve(as_cards(deck, row, deck.with_name(f"row-{row['row']}.inp")))
            for key, found in last_figures(result, name).items():
                if key not in known or f"{key}:" in row[column]:
                    continue
                assert found == pytest.approx(known[key], rel=wish + model_error), (key, row)
                checked.add((column, key))
    return checked


def copied(source, folder):
    """Copy a deck and what it may include to a folder; return its path."""
    folder.mkdir(exist_ok=True)
    for path in source.parent.iterdir():
        if path.suffix in (".inp", ".inc", ".step", ".mesh") and path.parent != folder:
            (folder / path.name).write_text(path.read_text())
    return folder / source.name


@pytest.mark.parametrize("case", KNOWN)
def test_recommended_rows_have_the_accuracy_wished_for(case, tmp_path):
    """Force, heat and peak pressure are known well enough for 1 % on all of these; of the tubes only
    longer rows are, so that 10 % is due."""
    source, *answer = KNOWN[case](tmp_path)
    deck = copied(source, tmp_path)
    rows, _ = trade(deck, tmp_path, "--quiet", "--limit", "0.02")
    checked = check_recommendations(rows, deck, *answer)
    target = "recommended_10" if case == "hot_tubes" else "recommended_1"
    due = {(target, key) for key in answer[1] if key != "edge_contact"}
    assert checked >= due


@pytest.fixture(scope="module")
def r2(tmp_path_factory):
    """Return rows and output of a trade of R2."""
    return trade(INPUT / "rods" / "r2.inp", tmp_path_factory.mktemp("r2"))


def test_recommended_rows_of_an_open_gap_have_the_accuracy_wished_for(r2, tmp_path):
    source, *answer = rod("r2")
    checked = check_recommendations(r2[0], copied(source, tmp_path), *answer)
    assert ("recommended_1", "heat_rate") in checked


def test_every_axis_is_varied(r2):
    rows, _ = r2
    grid = {(row["elements"], row["level"], row["increment_factor"]) for row in rows[:-1]
            if not row["varied"] and row["contact_level"] == "0"}
    # One increment over the whole step cannot be longer.
    assert grid == {(kind, str(level), factor) for kind in ("Q4", "Q8") for level in range(4)
                    for factor in ("1", "0.5", "0.25")}
    local = [(row["elements"], int(row["level"]), int(row["contact_level"]),
              row["increment_factor"]) for row in rows[:-1] if row["contact_level"] != "0"]
    assert sorted(local) == [("Q8", level, more, "1") for level in range(3)
                             for more in range(1, 4 - level)]
    single = {row["varied"] for row in rows} - {""}
    assert single == {"TOL=1E-3", "TOL=1E-5", "TOL=1E-8", "GALERKIN", "CRANK-NICOLSON", "EXPLICIT",
                      "PICARD", "ZAITSEV", "ANDERSON", "SURFACES", "MUMPS", *ACCURACIES}
    (default,) = (row for row in rows if row["default"] == "1")
    assert (default["elements"], default["level"], default["increment_factor"]) == ("Q8", "0", "1")


def test_rows_of_a_requested_accuracy_meet_it(r2):
    """R2 is one-dimensional and linear over each rod: its first round is exact."""
    rows, _ = r2
    found = {row["varied"]: row for row in rows if row["varied"] in ACCURACIES}
    for name, target in zip(ACCURACIES, WISHES.values(), strict=True):
        assert found[name]["status"] == "0"
        assert float(found[name]["error_heat_rate"]) <= target


def test_elements_are_named_as_the_deck_has_them(tmp_path):
    """The first rod of two six-node triangles, the second of one element with eight nodes."""
    deck = copied(INPUT / "rods" / "r2.inp", tmp_path)
    rods_ = tmp_path / "rods.inc"
    rods_.write_text(rods_.read_text().replace("""*ELEMENT, TYPE=CPE8, ELSET=FIRST
1, 1, 3, 8, 6, 2, 5, 7, 4
""", """*NODE, NSET=FIRST
9, 0.025, 0.05
*ELEMENT, TYPE=CPE6, ELSET=FIRST
1, 1, 3, 8, 2, 5, 9
3, 1, 8, 6, 9, 7, 4
""").replace("FIRST, S1", "1, S1"))
    rows, process = trade(deck, tmp_path, "--limit", "0.001")
    assert {row["elements"] for row in rows[:-1]} == {"Q8+T6", "Q4+T3"}
    assert "Q8+T6 x 1" in process.stdout and "Q8 x" not in process.stdout


def test_a_row_that_fails_is_listed_with_its_reason(r2):
    rows, process = r2
    (failed,) = (row for row in rows if row["varied"] == "PICARD")
    assert failed["status"] == "2"
    assert "does not converge in 50 iterations" in failed["reason"]
    assert not any(failed[f"error_{name}"] for name in (*QUANTITIES, "worst"))
    assert failed["pareto"] == "0" and not any(failed[wish] for wish in WISHES)
    assert "PICARD" in process.stdout and "failed (2)" in process.stdout


def test_quantities_that_the_deck_has_not_are_empty(r2):
    """R2 is open: no force, no pressure, no edge."""
    rows, _ = r2
    for row in rows:
        if row["status"] in ("0", ""):
            assert [name for name in QUANTITIES if row[f"error_{name}"]] == \
                ["heat_rate", "temperature"]


def test_the_reference_row_has_the_uncertainty_that_all_errors_contain(r2):
    rows, _ = r2
    reference = rows[-1]
    assert reference["row"] == "reference"
    for row in rows[:-1]:
        if row["status"] == "0":
            assert float(row["error_heat_rate"]) >= float(reference["error_heat_rate"])


def test_optimal_rows_are_beaten_by_none(r2):
    """With the two digits that count, as Fortran and Python print them; errors below 1e-6 count
    as 1e-6, times that differ by chance as equal."""
    rows = [row for row in r2[0][:-1] if row["status"] == "0"]
    points = [tuple(float(f"{number:.1e}") for number in
                    (float(row["cpu_seconds"]), max(float(row["error_worst"]), 1e-6)))
              for row in rows]
    for row, (cost, error) in zip(rows, points, strict=True):
        beaten = any(c <= cost + SAME_TIME and e < error or c < cost - SAME_TIME and e <= error
                     for c, e in points)
        assert row["pareto"] == str(int(not beaten)), row


@of_release
def test_cheap_rows_are_repeated_and_their_figures_make_sense(r2):
    rows, _ = r2
    solved = [row for row in rows[:-1] if row["status"] == "0"]
    assert {row["runs"] for row in solved} <= {"5", "7"}
    assert all(0.0 < float(row["cpu_seconds"]) < 10.0 for row in solved)
    assert all(3.0 < float(row["peak_megabytes"]) < 200.0 for row in solved)
    small, large = (next(row for row in solved if row["elements"] == "Q8" and row["level"] == level)
                    for level in "03")
    assert float(small["cpu_seconds"]) < float(large["cpu_seconds"])


def stated_and_true(rows, deck, names, exact):
    """Return stated and true errors of the rows with some names, at the last increment."""
    for row in rows:
        if row["varied"] in names or row["recommended_1"]:
            found = last_figures(solve(as_cards(deck, row, deck.with_name("row.inp"))), "FACE")
            for key in ("heat_rate", "normal_force", "peak_pressure"):
                yield row, float(row[f"error_{key}"]), abs(found[key] / exact[key] - 1.0)


def test_rows_of_steps_that_store_heat_have_the_errors_that_are_stated(tmp_path):
    """Against a fine mesh with 64 times as many increments; every scheme but the deck's is a row."""
    deck = transients.two_blocks(tmp_path / "deck.inp", "*THERMAL SCHEME, TYPE=L-STABLE")
    rows, _ = trade(deck, tmp_path, "--quiet", "--limit", "0.02")
    schemes = {"IMPLICIT", "GALERKIN", "CRANK-NICOLSON", "EXPLICIT"}
    assert {row["varied"] for row in rows} >= schemes
    fine = transients.two_blocks(tmp_path / "fine.inp", "*REFINE, LEVELS=2",
                                 times=f"{transients.FIRST / 64!r}, {transients.PERIOD!r}")
    exact = last_figures(solve(fine), "FACE")
    pairs = list(stated_and_true(rows[:-1], deck, schemes, exact))
    for row, stated, true in pairs:
        assert true <= stated * 1.01 + 1e-6, row
    assert max(true for *_, true in pairs) > 3e-3


def test_schemes_are_varied_in_the_steps_that_follow_them(tmp_path):
    """A steady step does with L-STABLE as with IMPLICIT."""
    steady = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
              "UPPER.TOP, 2, 2, -0.01", "UPPER.TOP, 11, 11, 20.", "LOWER.BOTTOM, 11, 11, 0.",
              "*END STEP"]
    every = ["L-STABLE", "IMPLICIT", "GALERKIN", "CRANK-NICOLSON", "EXPLICIT"]
    for steps, varied in ((steady, every[2:]), (steady + transients.heated(), every[1:])):
        deck = transients.write_deck(tmp_path / "deck.inp", transients.bodies(), transients.contact(),
                                     steps)
        rows, _ = trade(deck, tmp_path, "--quiet", "--limit", "0.001")
        assert [row["varied"] for row in rows if row["varied"] in every] == varied


def test_increments_by_error_are_varied_by_their_error(tmp_path):
    """Half of the factor takes twice the increments, whose error is a quarter. Fields follow y, for
    which a column of elements does."""
    column = [0.0, 1.0]
    deck = transients.write_deck(
        tmp_path / "deck.inp",
        transients.bodies(upper=(column, transients.HIGH), lower=(column, transients.LOW)),
        transients.contact(), ["*FIXED POINT, TOL=1.E-12"],
        transients.heated(how=", LOCAL ERROR=2.E-3"))
    rows, _ = trade(deck, tmp_path, "--quiet", "--limit", "0.01")
    found = {row["increment_factor"]: row for row in rows[:-1] if row["elements"] == "Q8"
             and (row["level"], row["contact_level"], row["varied"]) == ("0", "0", "")}
    for one, other in itertools.pairwise(("4", "2", "1", "0.5", "0.25")):
        assert 1.6 < int(found[other]["increments"]) / int(found[one]["increments"]) < 2.4
    from_reference = {factor: float(row["error_heat_rate"]) - float(rows[-1]["error_heat_rate"])
                      for factor, row in found.items()}
    assert from_reference["1"] < from_reference["4"] / 6


@pytest.fixture(scope="module")
def r1(tmp_path_factory):
    """Return rows, output and folder of a trade of R1 that stops early."""
    out = tmp_path_factory.mktemp("r1") / "new" / "folder"
    return *trade(INPUT / "rods" / "r1.inp", out, "--quiet", "--limit", "0.001"), out


def test_only_the_table_is_left_and_rows_out_of_balance_are_named(r1):
    """The gap of the rods changes in one increment, which only the implicit scheme takes whole."""
    _, process, out = r1
    assert [path.name for path in out.iterdir()] == ["r1.trade.csv"]
    assert process.stdout == ""
    (warning,) = process.stderr.splitlines()
    assert "heat is out of balance by more than 1 %" in warning
    named = [name for *_, name in re.findall(r"row (\d+) \(([> 0-9.]+) %, ([-A-Z]+)\)", warning)]
    assert named == ["GALERKIN", "CRANK-NICOLSON", "EXPLICIT"]


def test_rows_that_would_take_longer_than_the_limit_are_left_out_and_named(tmp_path):
    rows, process = trade(INPUT / "rods" / "r1.inp", tmp_path, "--limit", "0.001")
    assert not [row for row in rows[:-1] if row["level"] != "0"]
    named = re.findall(r"left out by --limit: (Q\d x [0-9:]+), increments x [0-9/]+: at least [0-9.]+ s",
                       process.stdout)
    assert set(named) == {"Q4 x 2", "Q8 x 2", "Q8 x 1:2"}


def test_a_deck_that_fails_as_written_has_a_table_and_its_status(tmp_path):
    deck = tmp_path / "rods" / "r2.inp"
    deck.parent.mkdir()
    for path in (INPUT / "rods").iterdir():
        text = path.read_text().replace("METHOD=NEWTON", "METHOD=PICARD")
        (deck.parent / path.name).write_text(text)
    rows, process = trade(deck, tmp_path, "--limit", "0.001", status=2)
    (default,) = (row for row in rows if row["default"] == "1")
    assert default["status"] == "2"
    assert "the deck as written fails" in process.stderr
    (newton,) = (row for row in rows if row["varied"] == "NEWTON")
    assert newton["status"] == "0"


def test_settings_and_width_reach_the_deck(tmp_path):
    """A name that the deck has not is its mistake; one that it has changes what rows find."""
    refused = run("trade", INPUT / "rods" / "r1.inp", "--set", "nothing=1", "--out", tmp_path)
    assert refused.returncode == 1
    assert "nothing" in refused.stderr.lower()
    rows, _ = trade(INPUT / "rods" / "r1.inp", tmp_path, "--set", "gap=-1.E-4", "--width", "99",
                    "--limit", "0.001")
    solved = [row for row in rows if row["status"] == "0"]
    assert solved
    assert all(row["error_normal_force"] for row in solved)


def test_a_deck_with_mistakes_has_no_table(tmp_path):
    deck = write(tmp_path / "bad.inp", ["*NONSENSE"])
    process = run("trade", deck, "--out", tmp_path)
    assert process.returncode == 1
    assert "unknown keyword" in process.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["bad.inp"]


REFUSED = {
    "no deck is named": ["trade"],
    "trade takes one deck": ["trade", HERTZ, CYLINDER],
    "--jobs needs a whole number of at least 1, not 0": ["trade", HERTZ, "--jobs", "0"],
    "--jobs needs a whole number of at least 1, not two": ["trade", HERTZ, "--jobs", "two"],
    "--limit needs a number of seconds above 0, such as 60s, not -1": ["trade", HERTZ, "--limit", "-1"],
    "option --limit needs a value": ["trade", HERTZ, "--limit"],
    "option --limit does not go with check": ["check", HERTZ, "--limit", "1"],
    "option --jobs does not go with check": ["check", HERTZ, "--jobs", "2"],
    "unknown option --job": ["trade", HERTZ, "--job", "2"],
}


@pytest.mark.parametrize("message", REFUSED)
def test_refused_command_lines(message):
    process = run(*REFUSED[message])
    assert process.returncode == 1
    assert message in process.stderr


def children(process):
    """Return the numbers of the children of a process."""
    with open(f"/proc/{process.pid}/task/{process.pid}/children") as file:
        return [int(number) for number in file.read().split()]


@contextmanager
def in_first_row(folder):
    """Start a trade whose rows have so many increments that the first one does not end by itself;
    let the caller go on with it and the number of its child."""
    (folder / "decks").mkdir()
    deck = folder / "decks" / "cylinder.inp"
    text = CYLINDER.read_text().replace("20., 900.", "0.001, 900.").replace("INC=100", "INC=9000000")
    deck.write_text(text[: text.index("*VERIFY")])
    process = subprocess.Popen([PROGRAM, "trade", str(deck), "--out", str(folder)],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    yield process, next_child(process)


def next_child(process, before=None):
    """Wait for a child with another number; return that."""
    while process.poll() is None:
        for child in children(process):
            if child != before:
                return child
        time.sleep(0.01)
    raise AssertionError(process.communicate())


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_the_trade_and_its_child(number, tmp_path):
    with in_first_row(tmp_path) as (process, child):
        process.send_signal(number)
        _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 5
    assert "ended by " + number.name in said
    assert [path.name for path in tmp_path.iterdir()] == ["decks"]
    with pytest.raises(ProcessLookupError):
        os.kill(child, 0)


def test_a_trade_that_a_signal_ends_keeps_the_rows_that_were_measured(tmp_path):
    deck = tmp_path / "cylinder.inp"
    text = CYLINDER.read_text().replace("20., 900.", "450., 900.")
    deck.write_text(text[: text.index("*VERIFY")])
    process = subprocess.Popen([PROGRAM, "trade", str(deck), "--out", str(tmp_path)],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    begun = set()
    while len(begun) < 15 and process.poll() is None:   # a row has at most seven processes
        begun.update(children(process))
    process.send_signal(signal.SIGINT)
    table, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 5, said
    with open(tmp_path / "cylinder.trade.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) >= 3 and rows[-1]["row"] == "reference"
    assert all(row["status"] == "0" and float(row["cpu_seconds"]) > 0 for row in rows[:-1])
    words = f"ended by SIGINT: the table contains only the {len(rows) - 1} rows measured before"
    assert f"{deck}: error: {words}\n" in said
    assert words in table
    assert [file.name for file in tmp_path.iterdir() if file.suffix == ".tmp"] == []


def test_a_row_that_the_system_kills_is_only_that_row_s_failure(tmp_path):
    """As it does where memory runs out."""
    with in_first_row(tmp_path) as (process, child):
        os.kill(child, signal.SIGKILL)
        next_child(process, before=child)   # the second row
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=PATIENCE)
    assert process.returncode == 5, said
    with open(tmp_path / "cylinder.trade.csv", newline="") as file:
        failed, _ = csv.DictReader(file)
    assert (failed["row"], failed["status"]) == ("1", "3")
    assert failed["reason"] == "ended by signal 9 (SIGKILL), as where memory runs out"


def test_rows_beside_each_other_find_the_same(r1, tmp_path):
    alone, *_ = r1
    beside, _ = trade(INPUT / "rods" / "r1.inp", tmp_path, "--limit", "0.001", "--jobs", "2")
    errors = [[row[f"error_{name}"] for name in QUANTITIES] for row in alone if not row["varied"]]
    assert errors[:6] == [[row[f"error_{name}"] for name in QUANTITIES]
                          for row in beside if not row["varied"]][:6]
