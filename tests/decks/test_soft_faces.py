"""Faces that overlap under pressure, `*SURFACE BEHAVIOR`: closed forms, and CalculiX."""

from math import log, sqrt

import h5py
import numpy as np
import pytest
from blocks import write
from calculix import calculix, differences, thercon
from changes import note_changes
from deck_runs import solve
from physics import judge, material, mesh, nodes_of

YOUNG = 1000.0
TABLE = [(0.0, 0.0), (2.0, 0.002), (10.0, 0.004)]
CLEARANCE, TOUCHING = 0.002, 0.5


def table(rows=TABLE):
    return ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=TABULAR", *(f"{p!r}, {o!r}" for p, o in rows)]


def exponential(clearance=CLEARANCE, touching=TOUCHING):
    return ["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=EXPONENTIAL", f"{clearance!r}, {touching!r}"]


def of_table(pressure, rows=TABLE):
    """Return the overlap under a pressure; the last line of a table goes on."""
    i = max(1, sum(p <= pressure for p, _ in rows[1:-1]) + 1)
    (low, start), (high, end) = rows[i - 1:i + 1]
    return start + (pressure - low) * (end - start) / (high - low)


def of_exponential(pressure, clearance=CLEARANCE, touching=TOUCHING):
    """Return the overlap at which p = p0 exp(ln(100) overlap/c0)."""
    return clearance * log(pressure / touching) / log(100.0)


LAWS = {"table": (table(), of_table), "exponential": (exponential(), of_exponential)}


def root(function, low, high):
    """Return where a function that rises is 0."""
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if function(middle) < 0.0 else (low, middle)
    return middle


def pressed(kind, behavior, gap, step, pairing="NODES", laws=()):
    """Return a block of height 2 above one of height 1, without lateral strain, and their step."""
    xs, finer = [1.0, 1.5, 2.0], [1.0, 1.3, 1.5, 1.8, 2.0]
    expansion, conductivity = (1e-4, 1.0) if laws else (None, None)
    upper = xs if pairing == "NODES" else finer
    return [*mesh("UP", upper, [gap, 1.0 + gap, 2.0 + gap], kind, first=101),
            *mesh("LOW", xs, [-1.0, 0.0], kind),
            *material("UP", (YOUNG, 0.0), expansion, conductivity),
            *material("LOW", (YOUNG, 0.0), expansion, conductivity),
            "*SURFACE INTERACTION, NAME=I", *behavior, *laws,
            f"*CONTACT PAIR, INTERACTION=I, NAME=FACE, PAIRING={pairing}", "UP.BOTTOM, LOW.TOP",
            "*STEP", *step, "*END STEP"]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("kind", "pairing"), [
    ("CPE8", "NODES"), ("CPS8", "SURFACES"), ("CPE4", "NODES"), ("CPE6", "SURFACES"),
    ("CAX8", "NODES"), ("CAX4", "SURFACES")])
def test_pressed_faces_overlap_as_the_law_says(tmp_path, kind, pairing, law):
    """From a gap of 0.003 on, in four increments up to 8, which are on both lines of the table."""
    behavior, overlap = LAWS[law]
    step = ["*STATIC", "0.25, 1.", "*BOUNDARY", "LOW.BOTTOM, 2", "UP, 1", "LOW, 1",
            "*DSLOAD", "UP.TOP, P, 8."]
    checks = [row for t in (0.25, 0.5, 0.75, 1.0) for row in (
        ("pressure", "FACE", t, 8.0 * t, 1e-9),
        ("U2", "UP.TOP", t, -(3.0 * 8.0 * t / YOUNG + 0.003 + overlap(8.0 * t)), 1e-9),
        ("S22", "LOW", t, -8.0 * t, 1e-8))]
    judge(tmp_path, pressed(kind, behavior, 0.003, step, pairing), checks)


@pytest.mark.changes("SURFACE BEHAVIOR", "SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE")
def test_overlaps_follow_the_data(tmp_path):
    """Rows of half the pressure, half the clearance c0, and twice the p0."""
    step = ["*STATIC", "1., 1.", "*BOUNDARY", "LOW.BOTTOM, 2", "UP, 1", "LOW, 1",
            "*DSLOAD", "UP.TOP, P, 8."]
    softer = [(p / 2.0, o) for p, o in TABLE]
    decks = [(table(), of_table(8.0)), (table(softer), of_table(8.0, softer)),
             (exponential(), of_exponential(8.0)),
             (exponential(CLEARANCE / 2.0), of_exponential(8.0, CLEARANCE / 2.0)),
             (exponential(CLEARANCE, 2.0 * TOUCHING), of_exponential(8.0, CLEARANCE, 1.0))]
    cards = [pressed("CPE8", behavior, 0.0, step) for behavior, _ in decks]
    for number, (deck, (_, overlap)) in enumerate(zip(cards, decks, strict=True)):
        judge(tmp_path, deck, [("U2", "UP.TOP", "LAST", -(0.024 + overlap), 1e-9)],
              name=f"deck{number}")
    for changed, plain in ((1, 0), (3, 2), (4, 2), (2, 0)):
        note_changes(cards[plain], cards[changed])


@pytest.mark.parametrize("law", LAWS)
def test_faces_press_and_part_along_the_law(tmp_path, law):
    """The upper block comes down by 0.02 and goes back: the pressure closes 3 p/E + overlap, with a
    reach of 1.217 c0 across the gap where the law is exponential."""
    behavior, overlap = LAWS[law]
    way, gap = 0.02, 0.0025
    reach = {"table": 0.0, "exponential": CLEARANCE * (1.0 + 1.0 / log(100.0))}[law]
    pressure = root(lambda p: 3.0 * p / YOUNG + gap + overlap(p) - way, 1e-12, 20.0)
    half = root(lambda p: 3.0 * p / YOUNG + gap + overlap(p) - way / 2.0, 1e-12, 20.0)
    step = ["*STATIC", "0.5, 1.", "*BOUNDARY", "LOW.BOTTOM, 2", "UP, 1", "LOW, 1",
            f"UP.TOP, 2, 2, {-way!r}", "*END STEP", "*STEP", "*STATIC", "1., 1.",
            "*BOUNDARY", "UP.TOP, 2, 2, 0."]
    judge(tmp_path, pressed("CPE8", behavior, gap, step), [
        ("pressure", "FACE", 0.5, half, 1e-9), ("pressure", "FACE", 1.0, pressure, 1e-9),
        ("gap", "FACE", 2.0, gap - reach, 1e-9), ("pressure", "FACE", 2.0, 0.0, 1e-12, "ABS")])


@pytest.mark.parametrize("count", [1, 100])
@pytest.mark.parametrize("law", LAWS)
def test_faces_that_close_while_they_slide_stick_from_where_they_begin_to_press(tmp_path, law, count):
    """Down by 0.02 and aside by 0.01 at once: what was left of the way when the gap was the reach of
    the law shears the block. Equations keep it from bending and warping."""
    behavior, overlap = LAWS[law]
    way, aside, gap = 0.02, 0.01, 0.006
    reach = {"table": 0.0, "exponential": CLEARANCE * (1.0 + 1.0 / log(100.0))}[law]
    pressure = root(lambda p: p / YOUNG + gap + overlap(p) - way, 1e-12, 50.0)
    shear = YOUNG / 2 * aside * (1 - (gap - reach) / way)
    judge(tmp_path, [
        *mesh("UP", [0.0, 1.0], [gap, 1.0 + gap], "CPS4"),
        *mesh("LOW", [0.0, 1.0], [-1.0, 0.0], "CPS4", first=101),
        *material("UP", (YOUNG, 0.0)), *material("LOW", (YOUNG, 0.0)),
        "*EQUATION", "2", "1, 1, 1., 2, 1, -1.", "2", "1, 2, 1., 2, 2, -1.",
        "*SURFACE INTERACTION, NAME=I", *behavior, "*FRICTION", "100.",
        "*CONTACT PAIR, INTERACTION=I, NAME=FACE", "UP.BOTTOM, LOW.TOP", "*STEP, INC=1000",
        "*STATIC, DIRECT", f"{1.0 / count!r}, 1.", "*BOUNDARY", "LOW, 1, 2",
        f"UP.TOP, 2, 2, {-way!r}", f"UP.TOP, 1, 1, {aside!r}", "*END STEP"], [
        ("pressure", "FACE", "LAST", pressure, 1e-8),
        ("S12", "UP", "LAST", shear, 1e-6)])


def test_the_exponential_law_ends_in_its_tangent(tmp_path):
    """From the gap c0 on, where the pressure is a hundredth of p0, it falls linearly to 0 at
    1.217 c0; it pushes the faces apart by 3 p/E."""
    rate, step = log(100.0) / CLEARANCE, ["*STATIC", "1., 1.", "*BOUNDARY", "LOW.BOTTOM, 2",
                                          "UP, 1", "LOW, 1", "UP.TOP, 2"]
    for part in (0.0, 0.1, 0.25):
        pressure = max(0.0, 0.01 * TOUCHING * (1.0 - rate * part * CLEARANCE)) / (
            1.0 + 0.01 * TOUCHING * rate * 3.0 / YOUNG)
        judge(tmp_path, pressed("CPE8", exponential(), (1.0 + part) * CLEARANCE, step),
              [("pressure", "FACE", "LAST", pressure, 1e-12, "ABS")], name=f"deck{part}")


@pytest.mark.parametrize("law", LAWS)
def test_heat_across_soft_faces_follows_their_pressure(tmp_path, law):
    """Both ends are held and 100 apart: the blocks expand into the overlap, and the conductance is
    0.05 times the pressure. One equation for the pressure is left."""
    behavior, overlap = LAWS[law]

    def flux(p):
        return 100.0 / (2.0 + 1.0 / (0.05 * p) + 1.0)

    def surplus(p):
        expansion = 1e-4 * (2.0 * (100.0 - flux(p)) + 0.5 * flux(p))
        return overlap(p) + 3.0 * p / YOUNG - expansion

    pressure = root(surplus, 1e-6, 20.0)
    step = ["*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.25, 1.", "*BOUNDARY",
            "LOW.BOTTOM, 2", "UP.TOP, 2", "UP, 1", "LOW, 1",
            "UP.TOP, 11, 11, 100.", "LOW.BOTTOM, 11, 11, 0."]
    for pairing in ("NODES", "SURFACES"):
        judge(tmp_path, pressed("CPE8", behavior, 0.0, step, pairing,
                                ["*GAP LAW, TYPE=POWER", "0., 0.05, 1."]),
              [("pressure", "FACE", "LAST", pressure, 1e-7),
               ("heat_flux", "FACE", "LAST", flux(pressure), 1e-7)], name=pairing.lower())


def test_a_free_block_settles_on_the_reach_of_its_faces(tmp_path):
    """A block that only contact with friction holds along y is within the reach of an exponential
    law from the start."""
    step = ["*STATIC", "0.25, 1.", "*BOUNDARY", "LOW.BOTTOM, 2", "LOW.LEFT, 1", "UP.LEFT, 1",
            "*DSLOAD", "UP.TOP, P, 0.1"]
    judge(tmp_path, pressed("CAX4", [*exponential(0.02, 0.001), "*FRICTION", "0.1"], 0.0, step), [
        ("pressure", "FACE", "LAST", 0.1, 1e-9),
        ("U2", "UP.TOP", "LAST", -0.3 / YOUNG - of_exponential(0.1, 0.02, 0.001), 1e-9)])


def test_faces_that_are_nearly_hard_close_as_hard_ones(tmp_path):
    """A warm block that nothing holds along y, and against turning, falls on faces with friction: from
    where it touches, slip counts on a layer of 1e9 as without one."""
    found = []
    for name, behavior in ("hard", []), ("soft", table([(0.0, 0.0), (1e9, 1.0)])):
        deck = write(tmp_path / f"{name}.inp", [
            *mesh("UP", [1.0, 1.5, 2.2, 3.0], [0.01, 0.7, 1.4], "CPE4", first=101),
            *mesh("LOW", [0.0, 1.0, 2.0, 3.0, 4.0], [-1.0, 0.0], "CPE4"),
            *material("UP", (YOUNG, 0.3), 1e-4), *material("LOW", (3 * YOUNG, 0.3), 1e-4),
            "*SURFACE INTERACTION, NAME=I", *behavior, "*FRICTION", "0.2",
            "*CONTACT PAIR, INTERACTION=I, NAME=FACE, PAIRING=SURFACES", "UP.BOTTOM, LOW.TOP",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "UP, 0.", "LOW, 0.",
            "*BOUNDARY", "LOW.BOTTOM, 1, 2", "UP.TOP, 1", "*STEP", "*STATIC", "1., 1.",
            "*TEMPERATURE", "UP.TOP, 100.", "*DSLOAD", "UP.TOP, P, 20.", "*END STEP"])
        with h5py.File(solve(deck)) as file:
            found.append([file[f"contact/FACE/{name}"][-1] for name in ("slip", "pressure", "shear")])
    assert abs(found[0][0]).max() > 1e-3
    for hard, soft in zip(*found, strict=True):
        np.testing.assert_allclose(soft, hard, atol=1e-5 * abs(hard).max(), rtol=0.0)


def test_gaps_count_from_where_faces_begin_to_press(tmp_path):
    """So the conductance of the gas has no jump there: in heat alone, and as the blocks part."""
    gap, reach = 0.004, CLEARANCE * (1.0 + 1.0 / log(100.0))
    laws = ["*GAP LAW, TYPE=GAS", "0.001, 0.002", "*GAP LAW, TYPE=POWER", "0.5, 0.05, 1."]
    ends = ["*BOUNDARY", "UP.TOP, 11, 11, 100.", "LOW.BOTTOM, 11, 11, 0."]
    flux = 100.0 / (3.0 + (0.002 + gap - reach) / 0.001)
    expansion = 1e-4 * (2.0 * (100.0 - flux) + 0.5 * flux)
    coupled = ["*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", *ends, "UP, 1", "LOW, 1",
               "LOW.BOTTOM, 2", f"UP.TOP, 2, 2, {expansion!r}"]
    for name, step in (("heat", ["*HEAT TRANSFER, STEADY STATE", "1., 1.", *ends]),
                       ("coupled", coupled)):
        judge(tmp_path, pressed("CPE8", exponential(), gap, step, "NODES", laws),
              [("gap", "FACE", "LAST", gap - reach, 1e-9), ("heat_flux", "FACE", "LAST", flux, 1e-9)],
              name=name)


STIFF, LAYER, WIDTH = 1e8, 100.0, 4.0


def punch(eccentricity, divisions):
    """Return a nearly rigid block on a layer of 100 per length, under a force of 8 beside its
    middle."""
    xs = np.linspace(-WIDTH / 2, WIDTH / 2, divisions + 1).tolist()
    return [*mesh("UP", xs, [0.0, 1.0], first=1001), *mesh("LOW", xs, [-1.0, 0.0]),
            *material("UP", (STIFF, 0.0)), *material("LOW", (STIFF, 0.0)),
            "*NODE, NSET=HAND", f"9001, {eccentricity!r}, 1.",
            "*COUPLING, REF NODE=9001, SURFACE=UP.TOP, CONSTRAINT NAME=C", "*KINEMATIC", "1, 2",
            "*SURFACE INTERACTION, NAME=I", *table([(0.0, 0.0), (LAYER, 1.0)]),
            "*CONTACT PAIR, INTERACTION=I, NAME=FACE", "UP.BOTTOM, LOW.TOP",
            "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "LOW, 1", "LOW.BOTTOM, 2", "9001, 1",
            "*CLOAD", "9001, 2, -8.", "*END STEP"]


def test_a_rigid_punch_on_a_layer_presses_as_a_beam_section(tmp_path):
    """Within the kern the pressure is N/b (1 + 12 e x/b^2)."""
    deck = write(tmp_path / "deck.inp", punch(0.5, 8))
    with h5py.File(solve(deck)) as result:
        x, pressure = (result["contact/FACE"][name][...] for name in ("x", "pressure"))
    np.testing.assert_allclose(pressure[-1], 8.0 / WIDTH * (1.0 + 12.0 * 0.5 * x / WIDTH**2), rtol=1e-5)


def test_a_layer_opens_where_the_force_leaves_the_kern(tmp_path):
    """The closed length is 3 (b/2 - e), and the largest pressure twice the mean over it."""
    closed = 3.0 * (WIDTH / 2 - 1.2)
    judge(tmp_path, punch(1.2, 40), [
        ("pressure", "MAX", "LAST", 2.0 * 8.0 / closed, 2e-3),
        ("normal_force", "FACE", "LAST", 8.0, 1e-7)])


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
def test_a_rigid_roller_on_a_layer_presses_as_a_parabola(tmp_path, pairing):
    """p = K (a^2 - x^2)/(2 R), whose sum 2 K a^3/(3 R) is the force: a = 1."""
    radius, force = 50.0, 2.0 * LAYER / (3.0 * 50.0)
    end = radius - sqrt(radius**2 - 9.0)
    xs = np.linspace(-WIDTH / 2, WIDTH / 2, 81).tolist()
    judge(tmp_path, [
        *mesh("LOW", xs, [-1.0, 0.0]), *material("LOW", (STIFF, 0.0)),
        "*NODE", "9001, 0., 1.", "*SURFACE, NAME=ROLLER, TYPE=SEGMENTS", f"START, 3., {end!r}",
        f"CIRCL, -3., {end!r}, 0., {radius!r}",
        "*RIGID BODY, REF NODE=9001, ANALYTICAL SURFACE=ROLLER",
        "*SURFACE INTERACTION, NAME=I", *table([(0.0, 0.0), (LAYER, 1.0)]),
        f"*CONTACT PAIR, INTERACTION=I, NAME=FACE, PAIRING={pairing}", "LOW.TOP, ROLLER",
        "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "LOW, 1", "LOW.BOTTOM, 2", "9001, 1", "9001, 6",
        "*CLOAD", f"9001, 2, {-force!r}", "*END STEP"],
        [("pressure", "MAX", "LAST", LAYER / (2.0 * radius), 2e-3),
         # Half of the spacing of nodes: the law of gaps at an edge is that of elastic bodies.
         ("edge_contact", "FACE", "LAST", WIDTH / 2 + 1.0, 0.0125, "ABS"),
         ("U2", "9001", "LAST", -1.0 / (2.0 * radius), 2e-3)])


@pytest.mark.parametrize(("theirs", "ours"), [
    (exponential(0.004, 1.0), exponential(0.004, 1.0)),
    (["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", "2500."], table([(0.0, 0.0), (2500.0, 1.0)]))],
    ids=["exponential", "layer"])
def test_soft_faces_are_those_of_calculix(tmp_path, theirs, ours):
    """Half of the upper of two blocks comes down by 0.03. CalculiX has points of contact within
    sides, so both agree as the mesh resolves the pressure; its LINEAR is a layer."""
    xs, ys = np.linspace(0.0, 2.0, 17).tolist(), np.linspace(0.0, 1.0, 5).tolist()
    upper = mesh("BODY", xs, ys, first=101)
    loaded = [str(n) for n, (x, y) in nodes_of(upper).items() if y == 1.0 and x >= 1.0]
    tables = []
    for name, behavior, program in (("ccx", theirs, calculix), ("ours", ours, thercon)):
        (tmp_path / name).mkdir()
        tables += [program(write(
            tmp_path / name / "deck.inp", upper, mesh("LOW", xs, [y - 1.0 for y in ys], first=5001),
            material("BODY", (YOUNG, 0.3)), material("LOW", (YOUNG, 0.3)),
            ["*NSET, NSET=LOADED", *loaded, "*SURFACE INTERACTION, NAME=I", *behavior,
             "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE", "BODY.BOTTOM, LOW.TOP",
             "*BOUNDARY", "BODY.LEFT, 1", "LOW.LEFT, 1", "LOW.BOTTOM, 2", "LOADED, 2, 2, -0.03",
             "*STEP, NLGEOM=NO", "*STATIC", "1., 1.",
             "*NODE PRINT, NSET=BODY", "U", "*EL PRINT, ELSET=BODY", "S", "*END STEP"]))]
    worst = differences(*tables)
    assert max(worst["U1"], worst["U2"]) < 1e-4, worst
    assert max(value for name, value in worst.items() if name[0] == "S") < 1e-3, worst
