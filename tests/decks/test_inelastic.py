"""Plasticity and creep of small decks; the verification manual has the larger ones."""

import math
import re

import h5py
import numpy as np
import pytest
from blocks import write
from changes import note_changes
from deck_runs import CYLINDER, assert_alike, copy_deck, datasets, run, solve
from inelastic import (OUTSIDE, POISSON, YIELD, YOUNG, A, N, bar, bree, fit, hill, law, left,
                       overlap, pressed, pulled, relaxing, step, strain_of_bree, stretched, tube)
from physics import follows, judge, material, mesh

FILES = "VTKHDF/PointData", "history"


def increments(folder, make, one, other):
    """Return how many increments a deck takes with each of two values of its cards."""
    decks = [make(value) for value in (one, other)]
    note_changes(*decks)
    return [len(datasets(solve(write(folder / f"{k}.inp", deck)), "history")["history/time"])
            for k, deck in enumerate(decks)]


@pytest.mark.changes("PLASTIC")
def test_plastic_strain_follows_the_table(tmp_path):
    def make(last):
        strain = 50.0 / (last - 200.0) * 0.02
        return [*bar("*PLASTIC", "200., 0.", f"{last!r}, 0.02"), *pulled(250.0)], [
            ("PEEQ", "BODY", "LAST", strain, 1e-6), ("PE11", "BODY", "LAST", strain, 1e-6),
            ("PE22", "BODY", "LAST", -strain / 2, 1e-6),
            ("PE33", "BODY", "LAST", -strain / 2, 1e-6),
            ("U1", "BODY.RIGHT", "LAST", 250.0 / YOUNG + strain, 1e-6)]

    follows(tmp_path, make, 300.0, 400.0)


@pytest.mark.changes("PLASTIC, HARDENING")
def test_kinematic_hardening_yields_early_in_reverse(tmp_path):
    # A surface that grew to 250 does not yield at -225; one that moved by 50 yields at -150, and
    # its back stress goes on to -25.
    def make(hardening):
        plastic = {"ISOTROPIC": 0.01, "KINEMATIC": -0.005}[hardening]
        cards = bar(f"*PLASTIC, HARDENING={hardening}", "200., 0.", "300., 0.02")
        return [*cards, *pulled(250.0), *pulled(-225.0)], [
            ("PE11", "BODY", 1.0, 0.01, 1e-6), ("PE11", "BODY", "LAST", plastic, 1e-6)]

    follows(tmp_path, make, "ISOTROPIC", "KINEMATIC")


def saturating(data, *more):
    """Return a bar whose back stress saturates, under tension 225."""
    return [*bar("*PLASTIC, HARDENING=COMBINED, DATA TYPE=PARAMETERS", data, *more),
            *pulled(225.0, times="0.0005, 1.")]


@pytest.mark.changes("PLASTIC")
def test_back_stress_saturates(tmp_path):
    # X = C/gamma (1 - exp(-gamma p)); increments of Euler's rule err by 1e-3
    def make(c):
        strain = -math.log(1 - 25.0 * 100.0 / c) / 100.0
        return saturating(f"200., {c!r}, 100."), [("PEEQ", "BODY", "LAST", strain, 2e-3)]

    follows(tmp_path, make, 5000.0, 1e4)


@pytest.mark.changes("CYCLIC HARDENING")
def test_surface_that_moves_grows_by_a_table_of_its_own(tmp_path):
    # sigma = 200 + 5000 p + p (last - 200)/0.01
    def make(last):
        strain = 25.0 / (5000.0 + (last - 200.0) / 0.01)
        cards = saturating("200., 5000., 0.", "*CYCLIC HARDENING", "200., 0.", f"{last!r}, 0.01")
        return cards, [("PEEQ", "BODY", "LAST", strain, 1e-6)]

    follows(tmp_path, make, 250.0, 300.0)


def test_yield_stress_falls_with_the_temperature(tmp_path):
    cards = [*bar("*PLASTIC", "300., 0., 0.", "400., 0.02, 0.", "100., 0., 400.",
                  "140., 0.02, 400."),
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 200.", *pulled(220.0)]
    # Half way between the tables: 200 + 70 p/0.02
    judge(tmp_path, cards, [("PEEQ", "BODY", "LAST", 20.0 / 3500.0, 1e-6)])


@pytest.mark.parametrize("kind", ["CPE3", "CPE4", "CPE4I", "CPE6", "CPE8", "CPE8R", "CPS3",
                                  "CPS4I", "CPS6", "CPS8R", "CAX3", "CAX4", "CAX4I", "CAX8R", "CAX6"])
def test_uniform_plastic_states_are_exact_in_all_elements(kind, tmp_path):
    # A skewed patch that is stretched along y only, by a strain e of which p is plastic, so that
    # q = 2 G (e - 3/2 p) = s + h p in plane strain and around an axis.
    strain, h = 0.004, 4000.0
    shear = YOUNG / (2 * (1 + POISSON))
    sides = ["BODY, 1"] if kind[:3] != "CPS" else ["BODY.LEFT, 1"]
    cards = [*mesh("BODY", [1.0, 1.6, 2.4, 3.0], [0.0, 0.5, 1.1], kind, skew=0.1),
             *law("*PLASTIC", "200., 0.", f"{200.0 + 0.05 * h!r}, 0.05"), "*BOUNDARY", *sides,
             "BODY.BOTTOM, 2",
             *step("*STATIC", "0.05, 1.", "*BOUNDARY", f"BODY.TOP, 2, 2, {1.1 * strain!r}")]
    if kind[:3] == "CPS":
        p = (YOUNG * strain - 200.0) / (YOUNG + h)
        stress, small = 200.0 + h * p, 1e-6
    else:
        p = (2 * shear * strain - 200.0) / (3 * shear + h)
        bulk = YOUNG / (3 * (1 - 2 * POISSON))
        stress, small = bulk * strain + 2 / 3 * (200.0 + h * p), 1e-6
    judge(tmp_path, cards, [("PEEQ", "BODY", "LAST", p, small),
                            ("S22", "BODY", "LAST", stress, small),
                            ("S12", "BODY", "LAST", 0.0, 1e-4, "ABS")])


@pytest.mark.changes("STATIC, STRAIN LIMIT")
def test_limit_of_strain_cuts_increments_back(tmp_path):
    def make(limit):
        return [*bar("*PLASTIC", "200., 0.", "220., 0.04"),
                *stretched(0.03, f"*STATIC, STRAIN LIMIT={limit!r}", "1., 1.")]

    few, many = increments(tmp_path, make, 0.1, 0.01)
    assert few == 1
    assert many >= 3


@pytest.mark.parametrize(("cards", "load"), [
    (tube(["*PLASTIC", f"{YIELD!r}"], *pressed(20.0, times="0.05, 1.")), hill(OUTSIDE)[0] / 20.0),
    ([*bar("*PLASTIC", "200."), *pulled(250.0)], 0.8),
    ([*bar("*PLASTIC", "200.", kind="CAX8R"), *pulled(250.0, "*STATIC, DIRECT")], 0.8)],
    ids=["tube", "bar that yields as a whole", "fixed increments"])
def test_collapse_is_told_with_the_last_load(cards, load, tmp_path):
    process = run("run", "--quiet", write(tmp_path / "deck.inp", cards), "--out", tmp_path)
    assert process.returncode == 2
    last = float(process.stderr.split("collapse: the last load that was carried is that of time ")[1]
                 .split(",")[0])
    assert last == pytest.approx(load, rel=3e-3)


def test_a_load_that_acts_at_once_is_no_collapse(tmp_path):
    """It would strain the bar by 0.05 in the first increment, however short."""
    deck = write(tmp_path / "deck.inp", [*bar("*PLASTIC", "200., 0.", "400., 0.1"), *pulled(
        300.0, options=", AMPLITUDE=STEP")])
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 2
    assert "collapse" not in process.stderr and "*STEP, AMPLITUDE=RAMP ramps them" in process.stderr


def test_bodies_that_yield_without_a_load_that_grows_do_not_collapse(tmp_path):
    cards = [*mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS4"),
             *material("BODY", (YOUNG, POISSON), expansion=1e-5)]
    cards[-1:] = ["*PLASTIC", "200.", cards[-1], "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
                  "BODY, 0."]
    process = run("run", "--quiet", write(tmp_path / "deck.inp", [*cards, *step(
        "*STATIC, DIRECT", "1., 1.", "*BOUNDARY", "BODY.LEFT, 1", "BODY.RIGHT, 1",
        "BODY.BOTTOM, 2", "*TEMPERATURE", "BODY, 1.E6")]), "--out", tmp_path)
    assert process.returncode == 2
    assert ("the law of BODY finds no stress for the strain of element 1 at x = 0, y = 0 in body 1 "
            "(of BODY, first node 1), temperature 1E+6;") in process.stderr
    assert "collapse" not in process.stderr


@pytest.mark.parametrize("kind", ["CPE4I", "CAX4I"])
def test_modes_that_flow_freely_end_no_run(kind, tmp_path):
    # A part of the top of a perfectly plastic block is pushed in: no stress is beyond yield.
    cards = [*mesh("BODY", [1.0, 1.5, 2.0], [-1.0, 0.0], kind),
             *law("*PLASTIC", "30.", elastic=(48e3, 0.27)), "*BOUNDARY", "BODY.BOTTOM, 1, 2",
             "BODY.LEFT, 1", *step("*STATIC", "0.1, 1.", "*BOUNDARY", "4, 2, 2, -0.02",
                                   "5, 2, 2, -0.02", "*EL PRINT, FREQUENCY=1000", "S")]
    deck = write(tmp_path / "deck.inp", cards)
    solve(deck)
    rows = [[float(word) for word in line.split()[4:]] for line in
            deck.with_suffix(".lst").read_text().split("S12\n")[-1].split("\n\n")[0].splitlines()]
    xx, yy, zz, xy = np.array(rows).T
    assert len(rows) == 8
    equivalent = np.sqrt(((xx - yy)**2 + (yy - zz)**2 + (zz - xx)**2) / 2 + 3 * xy**2)
    assert equivalent.max() == pytest.approx(30.0, rel=1e-5)


def test_a_held_element_with_enhanced_modes_carries_the_stress_of_its_heat(tmp_path):
    # No strain but that of heat, 2e-4, from all sides; its corners are not those of a rectangle.
    cards = [*mesh("BODY", [0.0, 5.0], [0.0, 1.3], "CPE4I"),
             *law("*PLASTIC", "1000.", expansion=1e-5), "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
             "BODY, 0.", *step("*STATIC", "1., 1.", "*BOUNDARY", "BODY, 1, 2", "*TEMPERATURE",
                               "BODY, 20.")]
    skew = [card.replace("5, 1.3", "5.1, 1.25") for card in cards]
    assert skew != cards
    exact = -YOUNG * 20.0 * 1e-5 / (1 - 2 * POISSON)
    judge(tmp_path, skew, [("S11", "BODY", "LAST", exact, 1e-9),
                           ("S12", "BODY", "LAST", 0.0, 1e-9, "ABS")])


def test_strains_beyond_their_limit_are_told_by_the_limit(tmp_path):
    # Strains of 0.05 in the one increment that yields, which must not be shorter.
    cards = [*bar("*PLASTIC", "200., 0.", "220., 0.2"), *pulled(205.0, "*STATIC", "0.1, 1., 0.1")]
    process = run("run", "--quiet", write(tmp_path / "deck.inp", cards), "--out", tmp_path)
    assert process.returncode == 2
    words = "): plastic strains grow in an increment by more than STRAIN LIMIT=1E-2; "
    assert words in process.stderr


@pytest.mark.changes("CREEP", "VISCO")
def test_norton_creep(tmp_path):
    def make(rate):
        time = 1000.0 if rate == A else 500.0
        strain = rate * 200.0**N * time
        return [*bar("*CREEP", f"{rate!r}, 5."), *pulled(200.0, "*VISCO", f"1., {time!r}")], [
            ("CEEQ", "BODY", "LAST", strain, 1e-8), ("CE22", "BODY", "LAST", -strain / 2, 1e-8),
            ("U1", "BODY.RIGHT", "LAST", 200.0 / YOUNG + strain, 1e-8)]

    follows(tmp_path, make, A, 3 * A)


def test_tables_have_strains_along_the_axes_of_the_section(tmp_path):
    # A bar that yields by 0.01 and creeps by 0.002 along x, seen from axes 30 degrees away.
    cards = bar("*PLASTIC", "200., 0.", "300., 0.02", "*CREEP", f"{0.002 / 250.0**N!r}, {N!r}")
    section = next(k for k, card in enumerate(cards) if card.startswith("*SOLID SECTION"))
    cards[section] += ", ORIENTATION=AXES"
    cards += ["*ORIENTATION, NAME=AXES", "1., 0., 0., 0., 1., 0.", "3, 30."]
    deck = write(tmp_path / "deck.inp", [
        *cards, *step("*STATIC", "0.1, 1.", "*DSLOAD", "BODY.RIGHT, P, -250.",
                      "*EL PRINT, FREQUENCY=1000", "PEEQ, PE, CE, CEEQ"), *step("*VISCO", "0.5, 1.")])
    solve(deck)
    head, *rows = deck.with_suffix(".lst").read_text().split("   INTEGRATION POINTS OF ALL\n")[
        -1].split("\n\n")[0].splitlines()
    assert head.split()[4:] == ["PEEQ", "PE11", "PE22", "PE33", "PE12", "CE11", "CE22", "CE33",
                                "CE12", "CEEQ"]
    # e11 = e (1 + 3 cos 2a)/4, e22 with -cos, 2 e12 = -3/2 e sin 2a
    turned = [(1 + 1.5) / 4, (1 - 1.5) / 4, -0.5, -1.5 * math.sqrt(0.75)]
    exact = 0.01 * np.array([1.0, *turned, *np.multiply(0.2, turned), 0.2])
    for row in rows:
        np.testing.assert_allclose([float(word) for word in row.split()[4:14]], exact, rtol=1e-5)


@pytest.mark.changes("CREEP, LAW")
def test_creep_hardens_by_time_or_by_strain(tmp_path):
    def make(name):
        strain = {"TIME": 0.2264079, "STRAIN": 0.3211421}[name]
        return [*bar(f"*CREEP, LAW={name}", f"{A / 2!r}, 5., -0.5"),
                *pulled(200.0, "*VISCO", "1., 100."), *pulled(250.0, "*VISCO", "1., 100.")], [
            ("CEEQ", "BODY", "LAST", strain, 1e-6)]

    follows(tmp_path, make, "TIME", "STRAIN")


@pytest.mark.changes("VISCO, LOCAL ERROR")
def test_relaxation_is_as_accurate_as_asked_for(tmp_path):
    decks = [relaxing(f"*VISCO, LOCAL ERROR={allowed!r}", "1.E-4, 100., 1.E-9")
             for allowed in (1e-3, 1e-5)]
    note_changes(*decks)
    errors = []
    for k, deck in enumerate(decks):
        found = datasets(solve(write(tmp_path / f"{k}.inp", deck)), *FILES)
        times = found["history/time"]
        stress = found["VTKHDF/PointData/stress"].reshape(len(times), -1, 4)[:, 0, 0]
        errors.append(np.abs(stress[1:] / left(times[1:] - 1.0) - 1).max())
    assert errors[0] < 1e-3
    assert errors[1] < 0.1 * errors[0]


def test_a_stress_that_relaxes_keeps_its_sign(tmp_path):
    """Creep of the first increment as it is given is sixty times the strain that is held."""
    start = 1000.0
    for times, holds in (("0.01, 1000.", True), ("0.01, 1000., 0.01", False)):
        cards = [*bar("*CREEP", f"{A!r}, {N!r}"), *stretched(start / YOUNG, "*STATIC", "1., 1."),
                 *stretched(start / YOUNG, "*VISCO", times)]
        result = solve(write(tmp_path / "deck.inp", cards))
        stress = datasets(result, *FILES)["VTKHDF/PointData/stress"].reshape(-1, 4)[-1, 0]
        listing = result.with_suffix(".lst").read_text()
        words = "the increment is the smallest of its step and is kept, though its inelastic"
        assert (words in " ".join(listing.split())) is not holds
        if holds:
            assert stress == pytest.approx(left(1000.0, start), rel=1e-3)


@pytest.mark.changes("VISCO, CETOL")
def test_creep_tolerance_shortens_increments(tmp_path):
    few, many = increments(tmp_path, lambda allowed: relaxing(
        f"*VISCO, LOCAL ERROR=1., CETOL={allowed!r}", "1.E-4, 100., 1.E-9"), 1e-3, 1e-7)
    assert many > 2 * few


@pytest.mark.changes("VISCO, STRAIN LIMIT")
def test_limit_of_strain_holds_in_real_time(tmp_path):
    def make(limit):
        return [*bar("*PLASTIC", "200., 0.", "220., 0.04"),
                *stretched(0.03, f"*VISCO, STRAIN LIMIT={limit!r}, LOCAL ERROR=1.E3", "1., 1.",
                           options=", AMPLITUDE=RAMP")]

    few, many = increments(tmp_path, make, 0.1, 0.01)
    assert many > few == 1


def test_transient_steps_creep_too(tmp_path):
    # The bar relaxes as without heat, and CREEP=NONE keeps its stress.
    for creep, stress in (("", left(1.0)), (", CREEP=NONE", 200.0)):
        cards = [*bar("*CREEP", f"{A!r}, {N!r}", conductivity=1.0, density=1.0, specific_heat=1.0),
                 "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20.",
                 *stretched(200.0 / YOUNG, "*STATIC", "1., 1."),
                 *stretched(200.0 / YOUNG, f"*COUPLED TEMPERATURE-DISPLACEMENT{creep}",
                            "1.E-4, 1., 1.E-9")]
        if creep:
            cards += stretched(200.0 / YOUNG, "*VISCO", "1.E-9, 1.E-9")
        judge(tmp_path, cards, [("S11", "BODY", 2.0, stress, 1e-3)])


def test_creep_and_plasticity_in_one_material(tmp_path):
    # Yielding at once to p = 50/5000, then creep at the stress that stays.
    cards = [*bar("*PLASTIC", "200., 0.", "300., 0.02", "*CREEP", f"{A!r}, {N!r}"),
             *pulled(250.0), *pulled(250.0, "*VISCO", "1., 10.")]
    judge(tmp_path, cards, [("PEEQ", "BODY", "LAST", 0.01, 1e-6),
                            ("CEEQ", "BODY", "LAST", A * 250.0**N * 10.0, 1e-6)])


def test_restart_goes_on_bit_for_bit(tmp_path):
    cards = ["*RESTART, WRITE, FREQUENCY=1",
             *fit("*PLASTIC", "100., 0.", "150., 0.01", "*CREEP", f"{A!r}, {N!r}"),
             *overlap(0.05), *step("*STATIC", "0.25, 1.", "*CONTACT INTERFERENCE",
                                   "SHAFT.RIGHT, BODY.LEFT, 0.05"), *step("*VISCO", "0.01, 1.")]
    deck = write(tmp_path / "deck.inp", cards)
    whole = solve(deck)
    for time in (0.75, 1.0, 1.01):
        folder = tmp_path / str(time)
        process = run("run", "--quiet", deck, "--restart", f"{whole}@{time!r}", "--out", folder,
                      "--errors", "no")
        assert process.returncode == 0, process.stderr
        assert_alike(datasets(whole, *FILES), datasets(folder / whole.name, *FILES), 0.0)


def test_what_stays_elastic_answers_as_without_the_cards(tmp_path):
    results = []
    for laws in ([], ["*PLASTIC", "1.E6"]):
        cards = [*fit(*laws), *overlap(0.05), *step("*STATIC", "0.5, 1.")]
        results.append(datasets(solve(write(tmp_path / f"{len(laws)}.inp", cards)), "contact"))
    assert_alike(*results, 1e-8)


def energies(result):
    """Return energies stored, those dissipated by plasticity, creep and friction, and the work."""
    found = datasets(result, "history")
    return [found[f"history/{name}"] for name in ("ALLSE", "ALLPD", "ALLCD", "ALLFD", "ALLWK")]


def balances(folder, make):
    """Assert that work is what is stored and dissipated, but for an error of increments; return the
    energies at the end."""
    gaps = []
    for n in (20, 40):
        found = energies(solve(write(folder / f"{n}.inp", make(n))))
        gaps.append(np.abs(found[4] - sum(found[:4])).max() / found[4].max())
    assert found[1][-1] > 0.0
    assert gaps[1] < 0.6 * gaps[0]
    assert gaps[1] < 0.02
    return [values[-1] for values in found]


@pytest.mark.parametrize("kind", ["CPS4", "CPE4I", "CAX8R", "CPE6"])
def test_work_is_stored_or_dissipated(kind, tmp_path):
    # A bar that yields, is unloaded, and creeps; it stores what its stress says.
    def make(n):
        return [*mesh("BODY", [1.0, 1.5, 2.0], [0.0, 0.4, 1.0], kind, skew=0.05),
                *law("*PLASTIC", "200., 0.", "300., 0.02", "*CREEP", f"{A!r}, {N!r}"), "*BOUNDARY",
                "BODY.BOTTOM, 2", "BODY.LEFT, 1",
                *step("*STATIC, DIRECT", f"{1 / n!r}, 1.", "*DSLOAD", "BODY.TOP, P, -280."),
                *step("*STATIC, DIRECT", f"{1 / n!r}, 1.", "*DSLOAD", "BODY.TOP, P, -150."),
                *step("*VISCO, DIRECT", f"{10 / n!r}, 10.")]

    assert balances(tmp_path, make)[2] > 0.0


def test_friction_dissipates_what_slides(tmp_path):
    # A block that is pressed down and pushed along by 0.1 with friction 0.3
    base = mesh("BASE", [-1.0, 3.0], [-1.0, 0.0], "CPE4", first=101)
    cards = [*mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPE4"), *law("*PLASTIC", "1.E6"), *base,
             *material("BASE", (YOUNG, POISSON)), "*SURFACE INTERACTION, NAME=RUB", "*FRICTION",
             "0.3", "*CONTACT PAIR, INTERACTION=RUB, PAIRING=SURFACES, NAME=RUB",
             "BODY.BOTTOM, BASE.TOP", "*BOUNDARY", "BASE, 1, 2",
             *step("*STATIC", "1., 1.", "*BOUNDARY", "BODY.TOP, 1", "BODY.TOP, 2, 2, -1.E-4"),
             *step("*STATIC", "0.01, 1.", "*BOUNDARY", "BODY.TOP, 1, 1, 0.1")]
    result = solve(write(tmp_path / "slide.inp", cards))
    stored, _, _, friction, work = energies(result)
    force = datasets(result, "contact")["contact/RUB/normal_force"][-1]
    assert friction[-1] == pytest.approx(0.3 * force * 0.1, rel=1e-2)
    assert work[-1] - stored[-1] == pytest.approx(friction[-1], rel=1e-2)


def told(folder, cards, name="bree"):
    """Return what the summary says of the last cycle, and the times of the increments."""
    deck = write(folder / f"{name}.inp", cards)
    times = datasets(solve(deck), "history")["history/time"]
    words = [line.strip() for line in deck.with_suffix(".lst").read_text().splitlines()
             if re.match(r" +(shakes down|creeps by|alternates|ratchets by|displacements)", line)]
    return words[0], times


@pytest.mark.parametrize(("tension", "thermal", "verdict"), [
    (0.4, 0.55, "shakes down"), (0.8, 0.75, "shakes down"), (0.3, 3.2, "alternates"),
    (0.8, 1.5, "ratchets by"), (0.3, 4.0, "ratchets by")])
def test_summary_tells_what_the_last_cycle_of_bree_did(tension, thermal, verdict, tmp_path):
    words, _ = told(tmp_path, bree(tension, thermal, "*CYCLE, STEPS=2, REPEAT=20"))
    assert words.startswith(verdict)
    if verdict == "ratchets by":
        before, last = (strain_of_bree(tension, thermal, cycles) for cycles in (1, 2))
        rate = (last - before) * 100.0 / YOUNG
        assert float(words.split()[2]) == pytest.approx(rate, rel=5e-3)


def cycled(*parameters):
    """Return a bar that is strained to and fro, less plastically each time as it hardens."""
    ends = [stretched(strain, "*STATIC", "0.2, 1.")
            for strain in (0.003, 0.0)]
    return [*bar("*PLASTIC", "200., 0.", "700., 0.05"), *ends[0], *ends[1],
            "*CYCLE, " + ", ".join(parameters)]


@pytest.mark.changes("CYCLE, REPEAT", "CYCLE, STEPS")
def test_cycle_repeats_as_many_steps_as_often_as_it_says(tmp_path):
    decks = [cycled(f"STEPS={steps}", f"REPEAT={repeat}", "TOLERANCE=0.")
             for steps, repeat in ((2, 3), (1, 4))]
    note_changes(*decks)
    # The second step alone changes nothing when it is repeated.
    for k, (deck, ends) in enumerate(zip(decks, (8, 3), strict=True)):
        _, times = told(tmp_path, deck, f"{k}")
        assert times[-1] == ends


@pytest.mark.changes("CYCLE, TOLERANCE")
def test_cycles_end_where_strains_repeat(tmp_path):
    decks = [cycled("STEPS=2", "REPEAT=200", f"TOLERANCE={tolerance!r}")
             for tolerance in (1e-4, 1e-6)]
    note_changes(*decks)
    few, many = [told(tmp_path, deck, f"{k}") for k, deck in enumerate(decks)]
    assert few[1][-1] < many[1][-1] < 400


@pytest.mark.changes("CYCLE, UNTIL")
def test_cycles_wait_for_strains_or_displacements(tmp_path):
    # Strains of some 1e-3 are told as they are, displacements over the largest.
    decks = [cycled("STEPS=2", "REPEAT=200", f"UNTIL={until}", "TOLERANCE=1.E-4")
             for until in ("PE", "U")]
    note_changes(*decks)
    strains, displacements = [told(tmp_path, deck, f"{k}")[1][-1] for k, deck in enumerate(decks)]
    assert strains < displacements < 400


def test_cycles_of_elastic_bodies_tell_how_far_they_repeat(tmp_path):
    """Not that strains shake down: nothing yields."""
    words, times = told(tmp_path, [*bar(), *stretched(0.003, "*STATIC", "1., 1."),
                                   "*CYCLE, UNTIL=U, REPEAT=9"])
    assert words == "displacements change by 0 of the largest one in the last cycle"
    assert times[-1] == 2.0


def test_what_creeps_on_does_not_shake_down(tmp_path):
    cards = [*bar("*CREEP", f"{A!r}, {N!r}"), *pulled(200.0, "*VISCO", "1., 10."),
             "*CYCLE, REPEAT=2, TOLERANCE=1."]
    words, times = told(tmp_path, cards)
    assert times[-1] == 20.0
    assert float(re.match("creeps by (.*) a cycle", words)[1]) == pytest.approx(10 * A * 200.0**N)


def test_steps_behind_a_cycle_follow_it(tmp_path):
    deck = cycled("STEPS=2", "REPEAT=200", "TOLERANCE=1.E-4")
    short = told(tmp_path, deck, "short")[1]
    longer = [*deck, *pulled(100.0, "*STATIC", "0.5, 1."), *pulled(0.0, "*STATIC", "1., 1.")]
    _, times = told(tmp_path, longer, "longer")
    assert times[-1] == short[-1] + 2.0
    whole = solve(write(tmp_path / "kept.inp", ["*RESTART, WRITE, FREQUENCY=1", *longer]))
    for time in (float(short[-1] - 2.0), float(short[-1] + 0.5)):
        folder = tmp_path / str(time)
        process = run("run", "--quiet", tmp_path / "kept.inp", "--restart", f"{whole}@{time!r}",
                      "--out", folder, "--errors", "no")
        assert process.returncode == 0, process.stderr
        assert_alike(datasets(whole, *FILES), datasets(folder / whole.name, *FILES), 0.0)


@pytest.mark.changes("INELASTIC HEAT FRACTION")
def test_inelastic_work_heats_the_body(tmp_path):
    # An insulated bar of yield stress 200 that is strained by 0.011 and then relaxes by creep.
    def make(fraction):
        cards = [*bar("*PLASTIC", "200.", "*CREEP", f"{A!r}, {N!r}", "*INELASTIC HEAT FRACTION",
                      f"{fraction!r}", conductivity=1.0, density=2.0, specific_heat=0.25),
                 "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20.",
                 *stretched(0.011, "*COUPLED TEMPERATURE-DISPLACEMENT", "1.E-7, 1.E-6",
                            options=", AMPLITUDE=RAMP"),
                 *stretched(0.011, "*COUPLED TEMPERATURE-DISPLACEMENT", "1.E-3, 1., 1.E-9")]
        plastic = 200.0 * (0.011 - 200.0 / YOUNG)
        creep = (200.0**2 - left(1.0) ** 2) / (2 * YOUNG)
        return cards, [
            ("NT", "BODY", 1e-6, 20.0 + fraction * plastic / 0.5, 1e-3),
            ("NT", "BODY", "LAST", 20.0 + fraction * (plastic + creep) / 0.5, 1e-3),
            ("heat_imbalance", "", "LAST", 0.0, 1e-8, "ABS")]

    follows(tmp_path, make, 0.9, 0.4)


@pytest.mark.parametrize("scheme", ["IMPLICIT", "L-STABLE"])
@pytest.mark.parametrize("more", [[], ["*ANNEAL TEMPERATURE", "900."]], ids=["", "annealed"])
@pytest.mark.parametrize("times", ["1., 1.", "0.25, 1."])
def test_work_of_a_strain_at_once_heats_the_body_once(tmp_path, scheme, more, times):
    # The second stage of an increment in which strain jumps starts where the first one ended.
    cards = [f"*THERMAL SCHEME, TYPE={scheme}",
             *bar("*PLASTIC", "200.", "*INELASTIC HEAT FRACTION", "0.9", *more, conductivity=1.0,
                  density=2.0, specific_heat=0.25), "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20.",
             *stretched(0.011, "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", times)]
    judge(tmp_path, cards, [
        ("NT", "BODY", "LAST", 20.0 + 0.9 * 200.0 * (0.011 - 200.0 / YOUNG) / 0.5, 1e-9),
        ("ALLPD", "", "LAST", 200.0 * (0.011 - 200.0 / YOUNG), 1e-9),
        ("heat_imbalance", "", "LAST", 0.0, 1e-8, "ABS")])
    with h5py.File(tmp_path / "deck.vtkhdf") as file:
        stored, made = (file[f"history/heat_{name}"][()] for name in ("stored", "dilatation"))
    assert abs(made[0]) > 1.0
    np.testing.assert_allclose(stored + made, 0.0, atol=1e-8 * abs(made[0]))


def joint_of_esposito(held):
    """Return the joint of docs/compare.md [mm, MPa, s], with all planes held or its ends free."""
    radii = [float(x) for x in np.linspace(4.51, 5.315, 17)]
    hub = mesh("BODY", radii, [0.0, 0.2], "CAX8R", first=101)
    return [*mesh("SHAFT", [0.0, 1.5, 3.0, 4.5], [0.0, 0.2], "CAX8R"), *hub,
            *material("SHAFT", (200e3, 0.345)),
            *law("*CREEP", "1.0083E-16, 3.", elastic=(99.3e3, 0.37)),
            "*SURFACE INTERACTION, NAME=JOINT",
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR", "0., 0.", "3500., 1.",
            "*CONTACT PAIR, INTERACTION=JOINT, NAME=FIT", "SHAFT.RIGHT, BODY.LEFT",
            *overlap(0.01473), "*BOUNDARY", "SHAFT.LEFT, 1",
            *(["SHAFT, 2", "BODY, 2"] if held else ["SHAFT.BOTTOM, 2", "BODY.BOTTOM, 2"]),
            *step("*STATIC", "1., 1."), *step("*VISCO", "100., 2.16E8")]


def test_disputed_joint_is_that_of_plane_strain(tmp_path):
    # The independent values are of one radius for both faces, which are 0.2 % apart here.
    days = ((0, 26.353), (200, 13.271), (1240, 6.041), (2500, 4.315))
    judge(tmp_path, joint_of_esposito(held=True), [
        ("pressure", "FIT@0.1", 1.0 + 86400.0 * day, p, 2e-3) for day, p in days])
    judge(tmp_path, joint_of_esposito(held=False), [
        ("pressure", "FIT@0.1", "LAST", 4.315 * 5 / 6, 1e-2)], name="free")


def punch(kind, solver="SKYLINE", pairing="NODES"):
    """Return a stiff punch that is pressed into a yielding block, taken off and pressed again."""
    xs = [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0]
    block = mesh("BODY", xs, [0.0, 1.0, 2.0, 2.5, 3.0], kind)
    top = mesh("PUNCH", xs[:5], [3.0, 3.5, 4.0], kind, first=201)
    return [*block, *top, *law("*PLASTIC", "200., 0.", "300., 0.05"),
            *material("PUNCH", (600e3, 0.3)), f"*SOLVER, TYPE={solver}",
            "*SURFACE INTERACTION, NAME=RUB", "*FRICTION", "0.2",
            f"*CONTACT PAIR, INTERACTION=RUB, PAIRING={pairing}, NAME=RUB",
            "PUNCH.BOTTOM, BODY.TOP" if pairing == "SURFACES" else "PUNCH.BOTTOM, UNDER",
            "*SURFACE, NAME=UNDER", *[f"{e}, S3" for e in range(19, 23)],
            "*BOUNDARY", "BODY.BOTTOM, 2", "BODY.LEFT, 1", "PUNCH.LEFT, 1",
            *[card for depth in (0.03, 0.0, 0.04) for card in step(
                "*STATIC", "0.1, 1.", "*BOUNDARY", f"PUNCH.TOP, 2, 2, {-depth!r}")]]


@pytest.mark.parametrize("kind", ["CPE4", "CPE4I", "CPS4"])
def test_punch_yields_unloads_and_yields_again(kind, tmp_path):
    results = {}
    for solver, pairing in (("SKYLINE", "NODES"), ("MUMPS", "NODES"), ("SKYLINE", "SURFACES")):
        deck = write(tmp_path / f"{solver}{pairing}.inp", punch(kind, solver, pairing))
        results[solver, pairing] = datasets(solve(deck), "history", "contact")
    one, other, mortar = results.values()
    np.testing.assert_allclose(one["contact/RUB/normal_force"],
                               other["contact/RUB/normal_force"], rtol=1e-6)
    force, times = one["contact/RUB/normal_force"], one["history/time"]
    assert force[np.isclose(times, 1.0)][0] > 0.0
    assert force[np.isclose(times, 2.0)][0] == 0.0   # a dent is left
    assert one["history/largest_plastic_strain"].max() > 0.01
    assert mortar["contact/RUB/normal_force"][-1] == pytest.approx(force[-1], rel=0.05)


def test_stages_of_a_run_that_corrects_its_bodies_add_up_to_its_time(tmp_path):
    """Without uncertainties: the sum is what a run without them takes."""
    deck = copy_deck(CYLINDER.with_stem("cylinder-yielding"), tmp_path / "deck.inp",
                     ["*OPTIONS, ERRORS=NO"], {"20., 900.": "60., 900."})
    deck.write_text(deck.read_text().split("*VERIFY")[0])
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        spent = sum(value for name, value in file["run"].attrs.items() if name.startswith("seconds_"))
    told = float(re.search(r"increments in (\S+) s", process.stdout)[1])
    assert 0.85 * told < spent < 1.02 * told
