"""Plasticity and creep beside ties, rigid bodies, bolts, mortar points, couplings and heat."""

import math
import re

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import datasets, run, solve
from inelastic import (POISSON, YIELD, YOUNG, A, N, bar, fit, hill, law, left, overlap, pressed,
                       pulled, step, tube)
from physics import corners_of, judge, material, mesh, nodes_of
from test_inelastic import balances

HARD = 5000.0   # slope of the yield stress over plastic strain, from 200 on
PLASTIC = ["*PLASTIC", "200., 0.", f"{200.0 + 0.04 * HARD!r}, 0.04"]
SMOOTH = ["*SURFACE INTERACTION, NAME=SMOOTH"]
SAME = 1e-6   # what corrections leave, 1e-9 of the forces, times Young's modulus over HARD
ACROSS = [0.0, 0.25, 0.5, 0.75, 1.0]
LOW, HIGH = [0.0, 0.5, 1.0], [1.0, 1.5, 2.0]


def alike(folder, decks, names=("ALLPD", "ALLSE", "ALLWK")):
    """Assert that two decks have the same values at the end of every increment."""
    one, other = (datasets(solve(write(folder / f"{k}.inp", deck)), "history")
                  for k, deck in enumerate(decks))
    for name in names:
        values = one[f"history/{name}"]
        assert np.abs(values).max() > 0.0
        np.testing.assert_allclose(other[f"history/{name}"], values, rtol=0.0,
                                   atol=SAME * np.abs(values).max(), err_msg=name)


def pressed_half(cards):
    """Return a step that presses the left half of the top of a body of height 2 down."""
    half = [f"{n}, 2, 2, -0.02" for n, place in nodes_of(cards).items()
            if place[1] == 2.0 and place[0] <= 0.5]
    return step("*STATIC", "0.1, 1.", "*BOUNDARY", "BODY.BOTTOM, 1, 2", *half)


@pytest.mark.parametrize("kind", ["CPE4", "CAX8R", "CPS6"])
def test_a_tie_to_an_elastic_body_makes_one_mesh(kind, tmp_path):
    elastic = material("UPPER", (YOUNG, POISSON))
    upper = mesh("UPPER", ACROSS, HIGH, kind, first=501)
    two = [*mesh("BODY", ACROSS, LOW, kind), *upper, *law(*PLASTIC), *elastic,
           "*TIE, NAME=GLUE", "UPPER.BOTTOM, BODY.TOP", *pressed_half(upper)]
    whole = mesh("BODY", ACROSS, LOW + HIGH[1:], kind)
    half = 2 * 4 * (5 - corners_of(kind))
    one = [*whole, "*ELSET, ELSET=LOWER, GENERATE", f"1, {half}",
           "*ELSET, ELSET=UPPER, GENERATE", f"{half + 1}, {2 * half}",
           *law(*PLASTIC, name="LOWER"), *elastic, *pressed_half(whole)]
    alike(tmp_path, [two, one])


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
def test_a_rigid_plate_presses_as_a_prescribed_displacement(pairing, tmp_path):
    body = [*mesh("BODY", ACROSS, LOW + HIGH[1:], "CPE4I"), *law(*PLASTIC)]
    plate = ["*NODE", "9001, 0.5, 2.5", "*SURFACE, NAME=PLATE, TYPE=SEGMENTS", "START, 2., 2.",
             "LINE, -1., 2.", "*RIGID BODY, REF NODE=9001, ANALYTICAL SURFACE=PLATE", *SMOOTH,
             f"*CONTACT PAIR, INTERACTION=SMOOTH, PAIRING={pairing}", "BODY.TOP, PLATE"]
    alike(tmp_path, [[*body, *cards, *step("*STATIC", "0.1, 1.", "*BOUNDARY", "BODY.BOTTOM, 1, 2",
                                           *moved)] for cards, moved in (
        ([], ["BODY.TOP, 2, 2, -0.02"]),
        (plate, ["9001, 1", "9001, 6", "9001, 2, 2, -0.02"]))])


def bolt(*cards):
    """Return a bar 4 x 1 that a section cuts in the middle, its ends held."""
    return [
        *mesh("BODY", [0.0, 1.0, 2.0, 3.0, 4.0], LOW, "CPS8R"), *law(*cards),
        "*NODE, NSET=BOLT", "900, 0., 9.", "*SURFACE, NAME=CUT", "2, S2", "6, S2",
        "*PRE-TENSION SECTION, NODE=BOLT, SURFACE=CUT", "*BOUNDARY", "BODY.LEFT, 1",
        "BODY.RIGHT, 1", "1, 2"]


def test_a_bolt_that_is_tightened_yields_and_unloads(tmp_path):
    # Shortened by 4 e it yields by p, s = E (e - p) = 200 + HARD p; let go by 4 g it loses E g.
    strain, gone = 0.003, 0.0005
    p = (YOUNG * strain - 200.0) / (YOUNG + HARD)
    cards = bolt(*PLASTIC)
    for length in (strain, strain - gone):
        cards += step("*STATIC", "0.1, 1.", "*BOUNDARY", f"BOLT, 1, 1, {4 * length!r}")
    judge(tmp_path, cards, [
        ("pre_tension", "BOLT", 1.0, 200.0 + HARD * p, SAME), ("PEEQ", "BODY", 1.0, p, SAME),
        ("pre_tension", "BOLT", "LAST", 200.0 + HARD * p - YOUNG * gone, SAME)])


def test_a_bolt_of_fixed_length_relaxes_by_creep(tmp_path):
    cards = [*bolt("*CREEP", f"{A!r}, {N!r}"),
             *step("*STATIC", "1., 1.", "*CLOAD", "BOLT, 1, 200."),
             *step("*VISCO, LOCAL ERROR=1.E-4", "1.E-4, 100., 1.E-9", "*BOUNDARY, FIXED",
                   "BOLT, 1")]
    judge(tmp_path, cards, [("pre_tension", "BOLT", "LAST", left(100.0), 1e-4),
                            ("S11", "BODY", "LAST", left(100.0), 1e-4)])


def test_a_note_tells_of_steps_without_creep(tmp_path):
    creeps = pulled(200.0, "*VISCO", "1., 10.")
    for steps, is_told in (([*pulled(200.0), *creeps], True), (creeps, False)):
        deck = write(tmp_path / "deck.inp", [*bar("*CREEP", f"{A!r}, {N!r}"), *steps])
        listing = " ".join(solve(deck).with_suffix(".lst").read_text().split())
        words = "*CREEP: materials do not creep in steps without real time, such as step 1"
        assert (words in listing) == is_told


def stack(*cards, upper=(0.0, 0.3, 0.7, 1.0), pairing="SURFACES"):
    """Return an elastic block on a plastic one, each 1 high, whose nodes do not match."""
    return [*mesh("BODY", ACROSS, LOW, "CPS8R"), *law(*cards),
            *mesh("UPPER", list(upper), HIGH, "CPS8R", first=501),
            *material("UPPER", (YOUNG, POISSON)), *SMOOTH,
            f"*CONTACT PAIR, INTERACTION=SMOOTH, PAIRING={pairing}, NAME=FACE",
            "UPPER.BOTTOM, BODY.TOP", "*BOUNDARY", "BODY.BOTTOM, 2", "BODY.LEFT, 1",
            "UPPER.LEFT, 1"]


def test_mortar_points_pass_a_uniform_plastic_state_and_removal_leaves_its_strain(tmp_path):
    # Removed, the blocks are free of stress, and the lower one stays shorter by its plastic strain.
    stress = 260.0
    p = (stress - 200.0) / HARD
    cards = [*stack(*PLASTIC), *step("*STATIC", "0.1, 1.", "*DSLOAD", f"UPPER.TOP, P, {stress!r}"),
             *step("*STATIC", "1., 1.", "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE",
                   "UPPER.BOTTOM, BODY.TOP", "*BOUNDARY", "UPPER.TOP, 2", "*DSLOAD, OP=NEW",
                   "UPPER.TOP, P, 0.")]
    judge(tmp_path, cards, [
        ("pressure", "FACE", 1.0, stress, SAME), ("PEEQ", "BODY", 1.0, p, SAME),
        ("U2", "BODY.TOP", 1.0, -p - stress / YOUNG, SAME), ("PEEQ", "BODY", "LAST", p, SAME),
        ("U2", "BODY.TOP", "LAST", -p, SAME), ("S22", "BODY", "LAST", 0.0, stress * SAME, "ABS")])


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
def test_plastic_plates_on_a_sparse_tail_are_those_of_the_full_matrix(pairing, tmp_path):
    # Three plates that yield, one on the other, with friction, the top pressed down askew.
    def deck(tail):
        cards = ["*SURFACE INTERACTION, NAME=RUB", "*FRICTION", "0.2", f"*SOLVER, TAIL={tail}"]
        for k in range(3):
            cards += mesh(f"P{k}", ACROSS, [float(k), k + 0.5, k + 1.0], "CPE4", first=1 + 200 * k)
            cards += law(*PLASTIC, name=f"P{k}")
            if k:
                cards += [f"*CONTACT PAIR, INTERACTION=RUB, PAIRING={pairing}",
                          f"P{k}.BOTTOM, P{k - 1}.TOP"]
        nodes = [(n, x) for n, (x, y) in nodes_of(cards).items() if y == 3.0]
        return [*cards, *step("*STATIC", "0.1, 1.", "*BOUNDARY", "P0.BOTTOM, 1, 2", "P2.TOP, 1",
                              *[f"{n}, 2, 2, {-0.02 - 0.01 * x!r}" for n, x in nodes]),
                *step("*STATIC", "0.1, 1.", "*BOUNDARY", "P2.TOP, 1, 1, 0.01")]

    alike(tmp_path, [deck("FULL"), deck("SPARSE")], ["ALLPD", "ALLSE", "ALLFD", "ALLWK"])


def heated_bar(n):
    """Return a held bar of tables that is heated until it yields, and cooled, in 2 n increments."""
    return [*mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS4"),
            *law("*PLASTIC", "300., 0., 0.", "100., 0., 400.",
                 elastic=[(YOUNG, POISSON, 0.0), (0.8 * YOUNG, POISSON, 400.0)],
                 expansion=[(3e-6, 0.0), (5e-6, 400.0)]),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.", "*BOUNDARY", "BODY.LEFT, 1",
            "BODY.RIGHT, 1", "BODY.BOTTOM, 2",
            *[card for warm in (400.0, 0.0) for card in step(
                "*STATIC, DIRECT", f"{1 / n!r}, 1.", "*TEMPERATURE", f"BODY, {warm!r}")]]


def test_a_held_bar_that_is_heated_follows_its_tables(tmp_path):
    # Between 0 and 400 all of E, the expansion and the yield stress follow lines: at 400
    # sigma = -100 = E (-alpha 400 - p); cooled to 0 again it is elastic, E (-p).
    p = 100.0 / (0.8 * YOUNG) - 5e-6 * 400.0
    judge(tmp_path, heated_bar(20), [("S11", "BODY", 1.0, -100.0, SAME),
                                     ("PE11", "BODY", 1.0, p, SAME),
                                     ("S11", "BODY", "LAST", -YOUNG * p, SAME)])


def test_a_strip_that_a_coupling_bends_has_the_moment_of_its_plastic_zones(tmp_path):
    # M = (3 - (k0/k)^2)/2 M0 in plane stress, M0 = 2/3 s of a height of 2, k0 = s/E.
    moment = 1.3 * 2 / 3 * 200.0
    curvature = 200.0 / YOUNG / math.sqrt(3 - 2 * 1.3)
    cards = [
        *mesh("BODY", [0.0, 0.1], [float(y) for y in np.linspace(-1.0, 1.0, 41)], "CPS8R"),
        *law("*PLASTIC", "200."), "*NODE", "9001, 0.1, 0.",
        "*COUPLING, REF NODE=9001, SURFACE=BODY.RIGHT, CONSTRAINT NAME=GRIP", "*KINEMATIC",
        "1, 1", "*BOUNDARY", "BODY.LEFT, 1", "1, 2",
        *step("*STATIC", "0.1, 1.", "*CLOAD", f"9001, 6, {-moment!r}")]
    corner = next(n for n, place in nodes_of(cards).items() if place == (0.1, 1.0))
    # The edge of the zones lies inside an element of 1/20.
    judge(tmp_path, cards, [("U1", str(corner), "LAST", 0.1 * curvature, 2e-3)])


def test_work_of_friction_and_of_plasticity_heat_together(tmp_path):
    # An insulated block that is pressed until it yields and pushed along an insulated base; after a
    # while all has one temperature. Heat: of slip all, of plastic work 0.9.
    heat = {"conductivity": 1e3, "density": 1.0, "specific_heat": 2.0}
    warm = "*COUPLED TEMPERATURE-DISPLACEMENT"
    cards = [*mesh("BODY", ACROSS, [0.0, 0.5, 1.0], "CPE4"),
             *law(*PLASTIC, "*INELASTIC HEAT FRACTION", **heat),
             *mesh("BASE", [-0.5, 2.0], [-1.0, 0.0], "CPE4", first=501),
             *material("BASE", (YOUNG, POISSON), **heat), "*SURFACE INTERACTION, NAME=RUB",
             "*FRICTION", "0.1", "*GAP CONDUCTANCE", "1.E4, 0.", "1.E4, 1.", "*GAP HEAT GENERATION",
             "1., 0.5", "*CONTACT PAIR, INTERACTION=RUB, PAIRING=SURFACES, NAME=RUB",
             "BODY.BOTTOM, BASE.TOP", "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.",
             "BASE, 0.",
             "*BOUNDARY", "BASE, 1, 2",
             *step(warm, "0.1, 1.", "*BOUNDARY", "BODY.TOP, 1", "BODY.TOP, 2, 2, -0.02",
                   options=", AMPLITUDE=RAMP"),
             *step(warm, "0.05, 1.", "*BOUNDARY", "BODY.TOP, 1, 1, 0.3",
                   options=", AMPLITUDE=RAMP"),
             *step(warm, "1.E-3, 10.")]
    result = solve(write(tmp_path / "rub.inp", cards))
    history = datasets(result, "history", "VTKHDF/PointData")
    plastic, friction = (history[f"history/{name}"][-1] for name in ("ALLPD", "ALLFD"))
    assert min(plastic, friction) > 0.05 * max(plastic, friction)
    temperature = history["VTKHDF/PointData/temperature"]
    last = temperature[-len(temperature) // len(history["history/time"]):]
    assert np.ptp(last) < 1e-3 * last.mean()
    capacity = 2.0 * (1.0 + 2.5)
    assert capacity * last.mean() == pytest.approx(friction + 0.9 * plastic, rel=1e-3)


def interference(n, at_once=0.0, joint=()):
    """Return a press fit whose hub yields as its overlap grows, from a part that acts at once."""
    return [*fit(*PLASTIC, joint=joint), *overlap(0.15), *step(
        "*STATIC, DIRECT", f"{1 / n!r}, 1.", "*CONTACT INTERFERENCE",
        f"SHAFT.RIGHT, BODY.LEFT, {0.15 - at_once!r}")]


def parted(n):
    """Return one that is taken apart."""
    return [*interference(n), *step(
        "*STATIC, DIRECT", "1., 1.", "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE",
        "SHAFT.RIGHT, BODY.LEFT")]


def tightened(n):
    """Return a bolt that yields as it is tightened, and creeps at its length."""
    return [*bolt(*PLASTIC, "*CREEP", f"{A!r}, {N!r}"),
            *step("*STATIC, DIRECT", f"{1 / n!r}, 1.", "*CLOAD", "BOLT, 1, 230."),
            *step("*VISCO, DIRECT", f"{1 / n!r}, 1.", "*BOUNDARY, FIXED", "BOLT, 1")]


@pytest.mark.parametrize("make", [
    heated_bar, interference, parted, tightened,
    lambda n: interference(n, at_once=0.02),
    lambda n: interference(n, joint=["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", "5.E3"])],
    ids=["temperatures", "interference", "removal", "bolt", "overlap", "soft faces"])
def test_work_of_what_is_no_load_is_stored_or_dissipated(make, tmp_path):
    balances(tmp_path, make)


def told(folder, name, errors, laws, *steps, **more):
    """Return the summary of a tube, and values and uncertainties of its largest strain, or none."""
    deck = write(folder / "tube.inp", [f"*OPTIONS, ERRORS={errors}", *tube(laws, *steps, **more)])
    process = run("run", deck, "--out", folder)
    assert process.returncode == 0, process.stderr
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        rows = file["uncertainty"].get(f"body 1/equivalent_{name}_strain")
        return process.stdout, None if rows is None else rows[:, :2]


@pytest.mark.parametrize("kind", ["CAX8R", "CAX4"])
def test_largest_strains_have_uncertainties_or_reasons(kind, tmp_path):
    # At the bore p = s/E (c^2/a^2 - 1), and A q t of a viscous tube under pressure 10, where
    # q = sqrt(3) 10 4/3: exact without change of volume, with Poisson's ratio 0.499 to 2e-3.
    creeps = 1e-6 * 10.0 * math.sqrt(3.0) * 4 / 3
    for name, laws, steps, exact in (
            ("plastic", ["*PLASTIC", f"{YIELD!r}"], pressed(hill(160.0)[0]),
             YIELD / 21e3 * (1.6**2 - 1)),
            ("creep", ["*CREEP", "1.E-9, 1."], pressed(10.0, "*VISCO", "1., 1000."),
             creeps)):
        errors, sizes = [], (8, 16)
        for elements in sizes:
            summary, rows = told(tmp_path, name, "FULL", laws, *steps, kind=kind, elements=elements)
            assert np.isfinite(rows[rows[:, 0] > 0.0]).all()
            value, uncertainty = rows[-1]
            found = re.search(rf"^ +{name} strain +(\S+) \+- ", summary, re.M)
            assert float(found[1]) == pytest.approx(value, rel=1e-6)
            assert f"{name} strain up to" not in summary
            assert abs(value - exact) <= uncertainty + 2e-3 * exact
            errors.append(uncertainty)
        assert errors[1] < 0.6 * errors[0]
        for option, reason in (("LAST", "path; ERRORS=FULL"), ("NO", "ERRORS=NO")):
            summary, rows = told(tmp_path, name, option, laws, *steps, kind=kind)
            assert rows is None
            assert re.search(rf"^ +{name} strain +\S+ \(no estimate: {reason}\), node ", summary,
                             re.M)
            assert f"{name} strain up to" not in summary
