"""What the cards of the method and of the output change: two values of each."""

import h5py
import numpy as np
import pytest
from blocks import write
from changes import note_changes
from deck_runs import run, solve
from physics import follows, judge, material, mesh, verify
from test_physics_loads import block, heat, static, stressed

import conduction
import rods as reference

# Two rods across a gap, in one increment from the law at the gap of the mesh: the passes of the
# fixed point are those of one number.

RODS = reference.Rods(length=(0.1, 0.06), conductivity=(20.0, 30.0), expansion=(12e-6, 5e-6),
                      young=(2e11, 1e11), temperature=(500.0, 40.0), gap=9e-4)
GAS = 0.5, 5e-5
LAW = reference.gas(*GAS)
IMAGE = reference.image(RODS, LAW, None)


def rods(*control):
    """Return the deck of the rods with a card of the method."""
    (l1, l2), gap = RODS.length, RODS.gap
    deck = [*mesh("HOT", [0.0, 0.05], [gap, gap + 0.4 * l1, gap + l1], first=1),
            *mesh("COLD", [0.0, 0.05], [-l2, -0.4 * l2, 0.0], first=101)]
    for k, name in enumerate(("HOT", "COLD")):
        deck += material(name, (RODS.young[k], 0.0), RODS.expansion[k], RODS.conductivity[k])
    return [*deck, "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=GAS",
            f"{GAS[0]!r}, {GAS[1]!r}", "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE",
            "HOT.BOTTOM, COLD.TOP", "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HOT, 0.", "COLD, 0.",
            *control, "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.",
            "*BOUNDARY", "HOT.TOP, 2", "COLD.BOTTOM, 2", "HOT, 1", "COLD, 1",
            f"HOT.TOP, 11, 11, {RODS.temperature[0]!r}",
            f"COLD.BOTTOM, 11, 11, {RODS.temperature[1]!r}", "*END STEP"]


def residuals(result):
    """Return the residuals of all passes."""
    with h5py.File(result) as file:
        return file["convergence/residual"][()]


PASSES = [("METHOD", "ZAITSEV", "PICARD"), ("G", 0.5, 0.8), ("CONSTANT", 3, 1), ("CONSTANT", 3, 5),
          ("TOL", 1e-8, 1e-3)]
EXACT = 1e-10   # residuals are differences: the rounding of gaps is about that of omega


@pytest.mark.parametrize(("parameter", "one", "other"), [
    pytest.param(*case, marks=pytest.mark.changes(f"FIXED POINT, {case[0]}")) for case in PASSES])
def test_every_pass_is_that_of_the_equations(tmp_path, parameter, one, other):
    names = {"TOL": "tolerance"}
    decks, found, known = [], [], []
    for value in (one, other):
        asked = {"tolerance": 1e-8} | {names.get(parameter, parameter.lower()): value}
        known.append(reference.passes(IMAGE, LAW(RODS.gap), **asked))
        method = "" if parameter == "METHOD" else "METHOD=ZAITSEV, "
        decks.append(rods(f"*FIXED POINT, {method}{parameter}={value}"))
        result = judge(tmp_path, decks[-1], [("iterations", "", "LAST", len(known[-1]), 0.0)])
        found.append(residuals(result))
        np.testing.assert_allclose(found[-1], known[-1], rtol=1e-7, atol=EXACT)
    note_changes(*decks)
    assert len(known[0]) != len(known[1]) or not np.allclose(*known, rtol=1e-2, atol=0.0)


@pytest.mark.changes("FIXED POINT, MAXITER")
@pytest.mark.parametrize("method", ["ZAITSEV", "PICARD"])
def test_run_ends_where_more_passes_would_be_needed(tmp_path, method):
    needed = len(reference.passes(IMAGE, LAW(RODS.gap), 1e-8, method=method))
    decks = [[card.replace("STEADY STATE", "STEADY STATE, DIRECT") for card in
              rods(f"*FIXED POINT, METHOD={method}, MAXITER={n}")] for n in (needed, needed - 1)]
    judge(tmp_path, decks[0], [("iterations", "", "LAST", needed, 0.0)])
    process = run("run", "--quiet", write(tmp_path / "few.inp", ["*OPTIONS, WIDTH=300"], decks[1]),
                  "--out", tmp_path)
    assert process.returncode == 2
    assert not (tmp_path / "few.vtkhdf").exists()
    note_changes(*decks)


def test_method_of_a_step_holds_from_it_on(tmp_path):
    """What a later card does not say stays; the passes of a step are those of its method."""
    first = rods("*FIXED POINT, METHOD=PICARD, TOL=1E-3")
    text = "\n".join(first)
    again = "*STEP\n*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE\n1., 1.\n"
    deck = write(tmp_path / "steps.inp", f"*OPTIONS, WIDTH=300\n{text}",
                 again + "*FIXED POINT, TOL=1E-10\n*END STEP", again + "*END STEP")
    with h5py.File(solve(deck)) as file:
        passes = {name: file[f"convergence/{name}"][()] for name in file["convergence"]}
    last = [passes["residual"][passes["increment"] == i][-1] for i in (1, 2, 3)]
    assert 1e-10 < last[0] <= 1e-3
    assert max(last[1:]) <= 1e-10
    np.testing.assert_array_equal(passes["g_min"], 1.0)


# The coefficients of eq. (3.4), on two rods whose gap is moved while they do not expand.

K, SIDES, HOT, COLD, FLUX, GAP = 2.0, (0.5, 1.0), 80.0, 10.0, 60.0, 0.02
BASE = {"a1": 0.75, "a2": 0.3, "a3": 0.45, "b1": 0.25, "b2": 0.15, "b3": 0.1, "c1": 0.2, "c2": 0.8}
SHIFTS = [("a1", "b1"), ("a2", "a3"), ("a2", "b2"), ("a3", "b3"), ("b2", "b3"), ("c1", "c2")]


def stepping(scheme):
    """Return the deck of a scheme (eight coefficients), and the temperatures of its faces."""
    times = [0.0, 0.25, 0.5, 0.75, 1.0]
    omegas = [0.02 / (0.01 + GAP - 0.018 * t) for t in times]
    faces = conduction.stepped(
        scheme, [K / side for side in SIDES], [(HOT * t, COLD * t) for t in times], omegas,
        [FLUX * t for t in times])
    deck = [*mesh("UPPER", [0.0, 0.4, 1.0], [GAP, GAP + SIDES[0]]),
            *mesh("LOWER", [0.0, 0.4, 1.0], [-SIDES[1], 0.0], first=101)]
    for name in ("UPPER", "LOWER"):
        deck += material(name, (1000.0, 0.0), 0.0, K)
    deck += ["*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=GAS", "0.02, 0.01",
             "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "UPPER.BOTTOM, LOWER.TOP",
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "UPPER, 0.", "LOWER, 0.",
             "*THERMAL SCHEME, TYPE=FREE", ", ".join(f"{c:.15g}" for c in scheme),
             "*FIXED POINT, TOL=1E-12",
             "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.25, 1.", "*BOUNDARY",
             "UPPER.TOP, 2, 2, -0.018", "LOWER.BOTTOM, 2", "UPPER, 1", "LOWER, 1",
             f"UPPER.TOP, 11, 11, {HOT!r}", f"LOWER.BOTTOM, 11, 11, {COLD!r}", "*DFLUX",
             f"1, S1, {FLUX!r}", f"2, S1, {FLUX!r}", "*END STEP"]
    rows = [(f"{side}_temperature", "FACE", time, face[k], 1e-8)
            for time, face in list(zip(times, faces, strict=True))[1:]
            for k, side in enumerate(("slave", "master"))]
    return deck, [*rows, *(("heat_imbalance", "", time, 0.0, 1e-10, "ABS") for time in times[1:])]


def shifted(one, other, by):
    """Return the coefficients with a part of one given to another, so that the sums stay."""
    return list((BASE | {one: BASE[one] + by, other: BASE[other] - by}).values())


@pytest.mark.changes("THERMAL SCHEME")
@pytest.mark.parametrize(("one", "other"), SHIFTS)
def test_every_coefficient_of_a_free_scheme(tmp_path, one, other):
    follows(tmp_path, lambda by: stepping(shifted(one, other, by)), 0.0, 0.05)


def test_a_multiple_of_all_coefficients_is_the_same_scheme(tmp_path):
    _, rows = stepping(list(BASE.values()))
    deck, _ = stepping([3.0 * c for c in BASE.values()])
    judge(tmp_path, deck, rows)


NAMED = {"IMPLICIT": (1, 0, 1, 0, 0, 0, 0, 1), "EXPLICIT": (1, 1, 0, 0, 0, 0, 0, 1),
         "CRANK-NICOLSON": (1 / 2, 1 / 4, 1 / 4, 1 / 2, 1 / 4, 1 / 4, 1 / 2, 1 / 2),
         "GALERKIN": (2 / 3, 1 / 6, 1 / 2, 1 / 3, 1 / 6, 1 / 6, 1 / 3, 2 / 3)}


@pytest.mark.parametrize("name", NAMED)
def test_coefficients_of_the_named_schemes(tmp_path, name):
    """At a conductance that changes: the digest's table of eq. (3.4)."""
    deck, rows = stepping(NAMED[name])
    at = deck.index("*THERMAL SCHEME, TYPE=FREE")
    judge(tmp_path, [*deck[:at], f"*THERMAL SCHEME, TYPE={name}", *deck[at + 2:]], rows)


FILM, SINK, END = 6.0, 300.0, 20.0
@pytest.mark.parametrize("name", [*NAMED, "FREE"])
def test_a_film_that_grows_follows_the_scheme(tmp_path, name):
    """Its coefficient stands where the conductance of the contact does. Implicit and explicit
    schemes have its steady state at the end of every increment, whatever it was before."""
    times, scheme = [0.0, 0.25, 0.5, 0.75, 1.0], NAMED.get(name, tuple(BASE.values()))
    found = conduction.stepped_with_film(scheme, K / SIDES[1], [END * t for t in times],
                                         [FILM * t for t in times], [SINK] * 5)
    if name in ("IMPLICIT", "EXPLICIT"):
        for t, temperature in list(zip(times, found, strict=True))[1:]:
            _, faces = conduction.wall(SIDES[1], K, END * t, SINK, film_cold=FILM * t)
            assert temperature == pytest.approx(faces[1], rel=1e-12)
    data = [", ".join(f"{c:.15g}" for c in scheme)] if name == "FREE" else []
    deck = [*mesh("BODY", [0.0, 0.4, SIDES[1]], [0.0, 0.5]), *material("BODY", conductivity=K),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.", f"*THERMAL SCHEME, TYPE={name}",
            *data, *heat("*BOUNDARY", f"BODY.LEFT, 11, 11, {END!r}", "*FILM",
                         f"2, F2, {SINK!r}, {FILM!r}", times="0.25, 1.")]
    judge(tmp_path, deck, [("NT", "BODY.RIGHT", t, value, 1e-9)
                           for t, value in list(zip(times, found, strict=True))[1:]])


# Solver and refinement.

@pytest.mark.changes("SOLVER, TYPE")
def test_solver_is_the_one_named(tmp_path):
    """With the same answer."""
    decks = [block(f"*SOLVER, TYPE={name}", *static("*DSLOAD", "BODY.TOP, P, 5."))
             for name in ("SKYLINE", "MUMPS")]
    for deck, name in zip(decks, ("SKYLINE", "MUMPS"), strict=True):
        with h5py.File(judge(tmp_path, deck, stressed([0.0, -5.0, 0.0]))) as file:
            found = file["run"].attrs["solver"]
        assert (found.decode() if isinstance(found, bytes) else found) == name
    note_changes(*decks)


@pytest.mark.changes("REFINE, LEVELS")
@pytest.mark.parametrize(("one", "other"), [(0, 1), (1, 2)])
def test_every_level_makes_four_elements_of_each(tmp_path, one, other):
    """Two elements in contact with two: the first pair's weight is a sixth of an element's side."""
    def make(levels):
        deck = rods(f"*REFINE, LEVELS={levels}")
        return deck, [("weight", "MIN", "LAST", 0.05 / 2**levels / 6, 1e-10)]

    follows(tmp_path, make, one, other)
    for levels, name in ((one, "one"), (other, "other")):
        with h5py.File(tmp_path / f"{name}.vtkhdf") as file:
            assert len(file["VTKHDF/CellData/element_id"]) == 4 * 4**levels


# Output.

def written(deck, folder):
    """Solve a deck; return the times of the fields, and at which increments a table is printed."""
    deck = write(folder / "deck.inp", ["*OPTIONS, WIDTH=300"], deck)
    with h5py.File(solve(deck)) as file:
        times = file["VTKHDF/Steps/Values"][()].tolist()
        assert len(file["history/time"]) == len(file["contact/FACE/gap"]) > len(times) // 2
    increment, tables = 0, []
    for line in deck.with_suffix(".lst").read_text().splitlines():
        if line.startswith("INCREMENT "):
            increment = int(line.split()[1])
        if line.strip() == "CONTACT POINTS OF FACE":
            tables.append(increment)
    return times, tables


def printed(*cards, second=()):
    """Return the rods with seven increments and output cards, then with two more."""
    deck = rods()
    at = deck.index("*STEP")
    held = "*BOUNDARY", "HOT.TOP, 2", "COLD.BOTTOM, 2", "HOT, 1", "COLD, 1"
    return [*deck[:at], *static(*held, *cards, times="1., 7."),
            *static(*second, times="1., 2.")]


EVERY = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
THINNED = {1: EVERY, 2: [2.0, 4.0, 6.0, 7.0], 3: [3.0, 6.0, 7.0], 0: [7.0]}
SECOND = {1: [8.0, 9.0], 2: [9.0], 3: [9.0], 0: [9.0]}


@pytest.mark.parametrize("keyword", [
    pytest.param(keyword, marks=pytest.mark.changes(f"{keyword}, FREQUENCY"))
    for keyword in ("NODE FILE", "EL FILE", "CONTACT FILE")])
def test_frequency_of_the_fields(tmp_path, keyword):
    decks = {n: printed(f"*{keyword}, FREQUENCY={n}") for n in THINNED}
    for n, deck in decks.items():
        times, tables = written(deck, tmp_path)
        np.testing.assert_allclose(times, THINNED[n] + SECOND[n])
        assert tables == []
    note_changes(decks[2], decks[3])


@pytest.mark.changes("NODE FILE", "EL FILE", "CONTACT FILE")
def test_quantities_of_the_files_change_nothing(tmp_path):
    """All are written."""
    decks = [printed("*NODE FILE, FREQUENCY=2", nodes, "*EL FILE", elements, "*CONTACT FILE", pairs)
             for nodes, elements, pairs in (("U, NT", "S", "CDIS"), ("U", "S, HFL", "CSTR"))]
    names = []
    for deck in decks:
        assert written(deck, tmp_path) == (THINNED[1] + SECOND[1], [])
        with h5py.File(tmp_path / "deck.vtkhdf") as file:
            names.append(set(file["VTKHDF/PointData"]))
    assert names[0] == names[1]
    assert {"displacement", "stress", "contact_gap", "temperature"} <= names[0]
    note_changes(*decks)


def test_the_smallest_frequency_of_a_step_holds_until_the_next_cards(tmp_path):
    several = "*NODE FILE, FREQUENCY=3", "*EL FILE, FREQUENCY=2", "*CONTACT FILE, FREQUENCY=5"
    times, _ = written(printed(*several, second=["*EL FILE, FREQUENCY=1"]), tmp_path)
    np.testing.assert_allclose(times, THINNED[2] + SECOND[1])
    np.testing.assert_allclose(written(printed(), tmp_path)[0], THINNED[1] + SECOND[1])


@pytest.mark.changes("CONTACT PRINT, FREQUENCY")
def test_frequency_of_the_tables_of_pairs(tmp_path):
    decks = {n: printed(f"*CONTACT PRINT, FREQUENCY={n}") for n in THINNED}
    for n, deck in decks.items():
        known = [] if n == 0 else [int(t) for t in THINNED[n] + SECOND[n]]
        assert written(deck, tmp_path) == (THINNED[1] + SECOND[1], known)
    _, tables = written(printed("*CONTACT PRINT, FREQUENCY=3", second=["*CONTACT PRINT"]), tmp_path)
    assert tables == [3, 6, 7, 8, 9]
    note_changes(decks[2], decks[3])


@pytest.mark.changes("CONTACT PRINT")
def test_quantities_of_a_table_change_nothing(tmp_path):
    decks = [printed("*CONTACT PRINT", data) for data in ("CDIS", "CSTR")]
    for deck in decks:
        assert written(deck, tmp_path)[1] == [1, 2, 3, 4, 5, 6, 7, 8, 9]
    note_changes(*decks)


# Checks: S22 is -5.

def checked(folder, *cards):
    """Run the block with checks; return the exit status and what the listing says of them."""
    deck = write(folder / "deck.inp", block(*static("*DSLOAD", "BODY.TOP, P, 5.")), list(cards))
    process = run("run", "--quiet", deck, "--out", folder)
    listing = deck.with_suffix(".lst").read_text()
    return process.returncode, listing[listing.index("\nVERIFICATION"):]


KIND = '*VERIFY, KIND=ANALYTIC, SOURCE="uniform stress"'


@pytest.mark.changes("VERIFY")
@pytest.mark.parametrize(("right", "wrong"), [
    ("S22, BODY, LAST, -5., 1.E-9", "S22, BODY, LAST, -5.1, 1.E-9"),   # the value
    ("S22, BODY, LAST, -5., 1.E-9", "S11, BODY, LAST, -5., 1.E-9"),    # the quantity
    ("U2, BODY.BOTTOM, LAST, 0., 1.E-9, ABS", "U2, BODY, LAST, 0., 1.E-9, ABS"),   # the place
    ("S22, BODY, 0.5, -2.5, 1.E-9", "S22, BODY, LAST, -2.5, 1.E-9"),   # the time
    ("S22, BODY, LAST, -4., 0.26", "S22, BODY, LAST, -4., 0.24"),      # the tolerance
    ("S22, BODY, LAST, -4., 0.26, REL", "S22, BODY, LAST, -4., 0.26, ABS"),
    ("S22, BODY, LAST, -4., 1.01, ABS", "S22, BODY, LAST, -4., 0.99, ABS"),
    ("S22, BODY, LAST, -8., 0.4", "S22, BODY, LAST, -8., 0.4, ABS"),
    ("S22, MAX, LAST, -5., 1.E-9", "S12, MIN, LAST, -5., 1.E-9")])
def test_every_field_of_a_check(tmp_path, right, wrong):
    status, text = checked(tmp_path, KIND, right)
    assert (status, "PASS" in text, "FAIL" in text) == (0, True, False)
    status, text = checked(tmp_path, KIND, wrong)
    assert (status, "PASS" in text, "FAIL" in text) == (4, False, True)
    note_changes([KIND, right], [KIND, wrong])


@pytest.mark.changes("VERIFY, KIND", "VERIFY, SOURCE")
def test_kind_and_source_of_a_check_are_printed(tmp_path):
    """Of every kind a failed check is status 4."""
    cards = {kind: [f'*VERIFY, KIND={kind}, SOURCE="from {kind.title()}, p. 7"',
                    "S22, BODY, LAST, -6., 1.E-9"]
             for kind in ("ANALYTIC", "EXTERNAL", "LEGACY", "FIGURE", "REGRESSION")}
    for kind, own in cards.items():
        status, text = checked(tmp_path, *own)
        assert status == 4
        assert [other for other in cards if f" {other} " in text] == [kind]
        assert f"source: from {kind.title()}, p. 7\n" in text
    note_changes(cards["LEGACY"], cards["FIGURE"])


def test_checks_may_stand_anywhere(tmp_path):
    """Before the first step, within one and behind the last."""
    steps = static("*DSLOAD", "BODY.TOP, P, 5.")
    wrong = [KIND, "S22, BODY, LAST, -6., 1.E-9"]
    for at in (0, 3, len(steps)):
        deck = write(tmp_path / "deck.inp", block(*steps[:at], *wrong, *steps[at:]),
                     verify(*stressed([0.0, -5.0, 0.0])))
        assert run("run", "--quiet", deck, "--out", tmp_path).returncode == 4


def test_gap_of_these_rods_stays_open():
    """So that the passes of the fixed point see one branch of one law."""
    state = reference.solve(RODS, LAW, lambda p: LAW(0.0))
    assert 0.1 * RODS.gap < state.gap < 0.9 * RODS.gap
