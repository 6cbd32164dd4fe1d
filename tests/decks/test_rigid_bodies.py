"""Rigid bodies: drawings and lines as masters of contact, and elements that follow a node."""

from math import pi, sqrt

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import pairs, run, solve, solve_as_written
from physics import follows, judge, material, mesh

YOUNG, POISSON, RADIUS, SIZE = 7e4, 0.33, 100.0, 40.0
SMOOTH = ["*SURFACE INTERACTION, NAME=SMOOTH"]
STATIC = ["*STEP", "*STATIC", "1., 1."]


def graded(fine, count, end, ratio=1.35):
    """Return places from 0: `count` sides of equal length, then growing ones to the end."""
    places, side = [fine * k for k in range(count + 1)], fine
    while places[-1] + side * ratio < end - side * ratio / 2:
        side *= ratio
        places.append(places[-1] + side)
    return [*places[:-1], end]


def roller(kind, force, pairing, radius=RADIUS, size=SIZE, level=1):
    """Return the half of a rigid cylinder or a sphere that a force presses on a block."""
    across, down = graded(0.25, 8, size), graded(0.25, 6, size)
    return [*mesh("BLOCK", across, [-y for y in down[::-1]], kind), "*NODE",
            f"90001, 0., {radius}", "*SURFACE, NAME=ROLL, TYPE=SEGMENTS",
            f"START, {0.6 * radius}, {0.2 * radius}",
            f"CIRCL, {-0.6 * radius}, {0.2 * radius}, 0., {radius}",
            "*RIGID BODY, REF NODE=90001, ANALYTICAL SURFACE=ROLL",
            *material("BLOCK", (YOUNG, POISSON)), *SMOOTH,
            f"*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, PAIRING={pairing}", "BLOCK.TOP, ROLL",
            f"*REFINE, LEVELS={level}", *STATIC, "*BOUNDARY", "BLOCK.LEFT, 1", "BLOCK.BOTTOM, 2",
            "90001, 1", "90001, 6", "*CLOAD", f"90001, 2, {-force!r}", "*END STEP"]


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize("kind", ["CPE8", "CAX8"])
def test_rigid_cylinder_and_sphere_press_as_hertz_says(tmp_path, kind, pairing):
    """K. L. Johnson, Contact Mechanics, 1985, section 4.2: half-width 1. The normal force counts
    along normals that lean by x/(2 R)."""
    modulus = YOUNG / (1 - POISSON**2)
    force, peak = pi * modulus / 8 / RADIUS, modulus / 2 / RADIUS
    if kind == "CAX8":
        force, peak = 4 * modulus / 3 / RADIUS, 2 * modulus / pi / RADIUS
    judge(tmp_path, roller(kind, force, pairing), [
        ("normal_force", "FACE", "LAST", force, 1e-5),
        ("edge_contact", "FACE", "LAST", 1.0, 0.01),
        ("pressure", "FACE@0.", "LAST", peak, 0.01)])


@pytest.mark.parametrize(("pairing", "said"), [
    (", PAIRING=NODES", "NODES of the slave alone: the master is a rigid drawing"),
    (", PAIRING=SURFACES", "SURFACES"),
    ("", "SURFACES, because the master is a rigid drawing without nodes to pair"),
    (", SLIDING=FINITE", "SURFACES, because the master is a rigid drawing without nodes to pair")])
def test_check_says_why_faces_on_a_drawing_have_these_points(tmp_path, pairing, said):
    cards = [card.replace(", PAIRING=NODES", pairing) for card in roller("CPE8", 1.0, "NODES")]
    printed = run("check", write(tmp_path / "deck.inp", cards)).stdout
    assert f"   pairing of FACE ........... {said}\n" in printed


def hertz(kind, radius, width):
    """Return force, peak pressure, and the largest von Mises stress, which is below the middle."""
    modulus = YOUNG / (1 - POISSON**2)
    z = np.linspace(0.2, 1.5, 14000)
    if kind == "CPE8":
        peak, along, down = modulus * width / 2 / radius, (1 + 2 * z**2) / np.sqrt(1 + z**2) - 2 * z, (
            1 / np.sqrt(1 + z**2))
        across, force = POISSON * (along + down), pi * modulus * width**2 / 8 / radius
    else:
        peak, down = 2 * modulus * width / pi / radius, 1 / (1 + z**2)
        along = (1 + POISSON) * (1 - z * np.arctan(1 / z)) - down / 2
        across, force = along, 4 * modulus * width**3 / 3 / radius
    squares = (along - down)**2 + (down - across)**2 + (across - along)**2
    return force, peak, peak * np.sqrt(squares.max() / 2)


@pytest.mark.parametrize(("how", "kind", "pairing"), pairs(
    [(0, []), (1, []), (0, ["--accuracy", "1%"])], ["CPE8", "CAX8"], ["NODES", "SURFACES"]))
def test_errors_are_within_their_uncertainties(tmp_path, kind, pairing, how):
    """Johnson, sections 3.4, 4.2. Stress below a line load on a block errs by its width over the
    block's; normals lean by x/(2 R)."""
    level, options = how
    radius, size, width = 1000.0, 4e4 if kind == "CPE8" else 400.0, 1.0
    force, peak, stress = hertz(kind, radius, width)
    lean = (width / radius)**2 / (32 if kind == "CPE8" else 20)
    deck = write(tmp_path / "deck.inp", roller(kind, force, pairing, radius, size, level))
    with h5py.File(solve_as_written(deck, *options)) as file:
        errors = {name: file[f"uncertainty/{name}"][-1, :2] for name in (
            "FACE/normal_force", "FACE/peak_pressure", "FACE/edge_contact", "body 1/von_mises")}
    for (value, uncertainty), exact in zip(errors.values(), [force * (1 + lean), peak, width, stress],
                                     strict=True):
        assert abs(value - exact) <= uncertainty
    if options:
        assert max(uncertainty / value for value, uncertainty in list(errors.values())[:3]) <= 0.01


@pytest.mark.parametrize("kind", ["CAX4", "CAX4I"])
def test_pressure_of_linear_elements_on_the_axis_has_the_second_order(tmp_path, kind):
    """Half of the spacing leaves a quarter of the error; a third, with what is left of the logarithm of it."""
    force, peak, _ = hertz("CAX8", 1000.0, 1.0)
    errors = []
    for level in (1, 2, 3):
        deck = write(tmp_path / "deck.inp", roller(kind, force, "NODES", 1000.0, 400.0, level))
        with h5py.File(solve(deck)) as file:
            errors.append(abs(file["contact/FACE/pressure"][-1, 0] - peak))
    assert errors[0] < 0.02 * peak and errors[1] < errors[0] / 3 and errors[2] < errors[1] / 3


@pytest.mark.parametrize(("kind", "pairing"), [("CAX4", "NODES"), ("CAX4I", "SURFACES")])
def test_a_requested_peak_on_the_axis_of_linear_elements_is_within_its_uncertainty(tmp_path, kind, pairing):
    """One change of it may be small by chance: no round is the first and the last."""
    force, peak, _ = hertz("CAX8", 1000.0, 1.0)
    deck = write(tmp_path / "deck.inp", roller(kind, force, pairing, 1000.0, 400.0, 1))
    with h5py.File(solve_as_written(deck, "--accuracy", "pressure=5%")) as file:
        value, uncertainty = file["uncertainty/FACE/peak_pressure"][-1, :2]
        assert abs(value - peak) <= uncertainty <= 0.05 * peak and len(file["accuracy/elements"]) > 1


PLATE = ["*NODE", "9001, 0.5, 3.25", "9002, 2., 3.", "9003, 0., 3.", "9004, -2., 3."]
DRAWN = [*PLATE, "*SURFACE, NAME=PLATE, TYPE=SEGMENTS", "START, 2., 3.", "LINE, 0., 3.",
         "LINE, -2., 3.", "*RIGID BODY, REF NODE=9001, ANALYTICAL SURFACE=PLATE"]
LINES = [*PLATE, "*ELEMENT, TYPE=R2D2, ELSET=LINES", "9001, 9002, 9003", "9002, 9003, 9004",
         "*SURFACE, NAME=PLATE", "LINES, SPOS", "*RIGID BODY, REF NODE=9001, ELSET=LINES"]


@pytest.mark.parametrize("rigid", [DRAWN, LINES], ids=["drawing", "lines"])
def test_rigid_plate_tilts_under_a_moment(tmp_path, rigid):
    """A block without lateral contraction, 2 wide and 3 high, is a bar in bending; force and
    moment act 0.5 beside its middle."""
    force, moment = 20.0, -7.0
    cards = [*mesh("BLOCK", [-1.0, -0.5, 0.2, 1.0], [0.0, 1.0, 2.0, 3.0]), *rigid,
             *material("BLOCK", (1000.0, 0.0)), *SMOOTH,
             "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE", "BLOCK.TOP, PLATE", *STATIC,
             "*BOUNDARY", "BLOCK.BOTTOM, 2", "1, 1", "9001, 1", "*CLOAD",
             f"9001, 2, {-force!r}", f"9001, 6, {-moment!r}", "*END STEP"]
    pressure, bending = force / 2, (moment + force * 0.5) / (2.0**3 / 12)
    judge(tmp_path, cards, [
        ("normal_force", "FACE", "LAST", force, 1e-9),
        ("S22", "BLOCK.LEFT", "LAST", -pressure + bending, 1e-9),
        ("S22", "BLOCK.RIGHT", "LAST", -pressure - bending, 1e-9),
        ("U2", "9001", "LAST", -3.0 * (pressure + 0.5 * bending) / 1000.0, 1e-9)])


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
def test_rigid_bodies_are_as_one_of_a_far_larger_modulus(tmp_path, pairing):
    """A cylinder of a modulus 1e6 times that of the block, its elements rigid, or drawn."""
    across, up = graded(0.25, 8, SIZE), graded(0.25, 6, SIZE)
    elements = [*mesh("ROLL", across, up, "CPE8", first=50001, to=lambda x, y: (
        x, y + (RADIUS - sqrt(RADIUS**2 - x * x)) * (1 - y / SIZE))),
                *material("ROLL", (YOUNG * 1e6, POISSON))]
    arc = ["*SURFACE, NAME=ROLL.BOTTOM, TYPE=SEGMENTS", "START, 60., 20.",
           "CIRCL, -60., 20., 0., 100.",
           "*RIGID BODY, REF NODE=90001, ANALYTICAL SURFACE=ROLL.BOTTOM"]
    moved = ["90001, 1", "90001, 6", "90001, 2, 2, -0.05"]
    ways = ((elements, ["ROLL.TOP, 2, 2, -0.05", "ROLL.LEFT, 1"]),
            ([*elements, "*RIGID BODY, REF NODE=90001, ELSET=ROLL"], moved), (arc, moved))
    found = []
    for k, (body, supports) in enumerate(ways):
        deck = write(tmp_path / f"way{k}.inp", [
            *mesh("BLOCK", across, [-y for y in up[::-1]], "CPE8"), "*NODE", "90001, 0., 40.",
            *body, *material("BLOCK", (YOUNG, POISSON)), *SMOOTH,
            f"*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, PAIRING={pairing}",
            "BLOCK.TOP, ROLL.BOTTOM", *STATIC, "*BOUNDARY", "BLOCK.LEFT, 1", "BLOCK.BOTTOM, 2",
            *supports, "*END STEP"])
        with h5py.File(solve_as_written(deck)) as file:
            face = file["contact/FACE"]
            found.append([face["normal_force"][-1], face["edge_contact"][-1],
                          face["pressure"][-1].max()])
            assert file["uncertainty/FACE/normal_force"][-1, 1] < 0.01 * found[-1][0]
    assert found[1] == pytest.approx(found[0], rel=1e-5)
    assert found[2] == pytest.approx(found[0], rel=1e-5)


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
def test_a_ring_turns_with_the_rigid_shaft_that_it_sticks_to(tmp_path, pairing):
    """About a reference node beside the axis: every node moves by theta x r."""
    turn, at = 1e-3, np.array([0.4, -0.3])
    ring = mesh("RING", np.linspace(0.0, 2 * pi, 25), [1.0, 1.5], closed=True,
                to=lambda angle, r: (r * np.cos(-angle), r * np.sin(-angle)))
    shaft = ["*NODE", f"9001, {at[0]}, {at[1]}", "*SURFACE, NAME=SHAFT, TYPE=SEGMENTS",
             "START, 1., 0.", *(f"CIRCL, {x}, {y}, 0., 0." for x, y in (
                 ("0.", "-1."), ("-1.", "0."), ("0.", "1."), ("1.", "0."))),
             "*RIGID BODY, REF NODE=9001, ANALYTICAL SURFACE=SHAFT"]
    deck = write(tmp_path / "deck.inp", ["*OPTIONS, ERRORS=NO"], ring, shaft,
                 material("RING", (YOUNG, POISSON)), [
        "*SURFACE INTERACTION, NAME=ROUGH", "*FRICTION", "1.",
        f"*CONTACT PAIR, INTERACTION=ROUGH, NAME=FACE, PAIRING={pairing}", "RING.BOTTOM, SHAFT",
        *STATIC, "*BOUNDARY", "9001, 1, 2", "9001, 6", "*DSLOAD", "RING.TOP, P, 10.", "*END STEP",
        *STATIC, "*BOUNDARY", f"9001, 6, 6, {turn!r}", "*END STEP"])
    with h5py.File(solve(deck)) as file:
        places = file["VTKHDF/Points"][:, :2]
        pressed, turned = file["VTKHDF/PointData/displacement"][()].reshape(2, -1, 3)[:, :, :2]
    arm = (places - at)[:, ::-1] * [-1.0, 1.0]
    on_ring = np.hypot(*places.T) > 0.9
    np.testing.assert_allclose((turned - pressed)[on_ring], turn * arm[on_ring], atol=1e-5 * turn)


def test_the_pole_of_a_dome_is_above_the_point_that_it_faces(tmp_path):
    """Whatever its coarse mesh makes of the normal there: no direction has a larger part of the
    distance, and one between the axis and the normal of the side has no smaller one."""
    gap, rise = 0.1, 0.8
    deck = write(tmp_path / "deck.inp", mesh(
        "DOME", [0.0, 0.3, 0.6], [0.0, 0.5, 1.0], "CAX4",
        to=lambda x, y: (x, y + rise * x * x * (1 - y))), material("DOME", (YOUNG, POISSON)), [
        "*NODE", f"9001, 0., {-gap!r}", "*SURFACE, NAME=PLANE, TYPE=SEGMENTS",
        f"START, -2., {-gap!r}", f"LINE, 2., {-gap!r}",
        "*RIGID BODY, REF NODE=9001, ANALYTICAL SURFACE=PLANE", *SMOOTH,
        "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, PAIRING=NODES", "DOME.BOTTOM, PLANE",
        *STATIC, "*BOUNDARY", "DOME.LEFT, 1", "DOME.TOP, 2", "9001, 1, 2", "9001, 6", "*END STEP"])
    with h5py.File(solve(deck)) as file:
        found = file["contact/FACE/gap"][-1][0]
    assert gap / np.hypot(1.0, rise * 0.3) <= found <= gap * (1 + 1e-12)


@pytest.mark.parametrize("kind", ["CPE8", "CAX8"])
def test_drawings_serve_any_mesh(tmp_path, kind):
    """Linear elements of meshes that are refined everywhere and once more at the face."""
    force, *_ = hertz(kind, RADIUS, 1.0)
    cards = roller(kind, force, "SURFACES")
    cards.insert(cards.index("*REFINE, LEVELS=1"), "*REFINE, SURFACE=BLOCK.TOP, LEVELS=1")
    judge(tmp_path, ["*OPTIONS, ORDER=1", *cards], [
        ("normal_force", "FACE", "LAST", force, 1e-5), ("edge_contact", "FACE", "LAST", 1.0, 0.03)])


def test_a_drawing_moves_with_the_instance_of_its_part(tmp_path):
    """A bar under a plate that is drawn upright and turned by 90 degrees."""
    cards = ["*PART, NAME=BAR", *mesh("BLOCK", [-1.0, 0.0, 1.0], [0.0, 1.0, 3.0]),
             "*SOLID SECTION, ELSET=BLOCK, MATERIAL=BLOCK", "*END PART", "*PART, NAME=DIE",
             "*NODE, NSET=REF", "1, -0.5, 0.5", "*SURFACE, NAME=PLATE, TYPE=SEGMENTS",
             "START, 0., -2.", "LINE, 0., 0.", "LINE, 0., 2.", "*RIGID BODY, REF NODE=REF, "
             "ANALYTICAL SURFACE=PLATE", "*END PART", "*ASSEMBLY, NAME=BOTH",
             "*INSTANCE, NAME=B, PART=BAR", "*END INSTANCE", "*INSTANCE, NAME=D, PART=DIE",
             "0., 3., 0.", "0., 3., 0., 0., 3., 1., 90.", "*END INSTANCE", "*END ASSEMBLY",
             *material("BLOCK", (1000.0, 0.0))[:3], *SMOOTH,
             "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE", "B.BLOCK.TOP, D.PLATE", *STATIC,
             "*BOUNDARY", "B.BLOCK.BOTTOM, 1, 2", "D.REF, 1", "D.REF, 2, 2, -0.01",
             "D.REF, 6, 6, 0.002", "*END STEP"]
    judge(tmp_path, cards, [("normal_force", "FACE", "LAST", 2000.0 / 3.0 * 0.009, 1e-9)])


@pytest.mark.parametrize("load", ["*DLOAD\nEND, BX, 6.", "*DSLOAD\nBLOCK.RIGHT, P, -12.",
                                  "*CLOAD\n90001, 1, 12.", "*EQUATION"])
def test_loads_on_a_rigid_body_are_loads_on_its_reference_node(tmp_path, load):
    """A bar of two elements, 1 high, the outer one rigid."""
    equation = []
    if load.startswith("*EQUATION"):
        equation, load = [*load.split("\n"), "2", "90001, 1, 1., 90002, 1, -1."], (
            "*CLOAD\n90002, 1, 12.")
    cards = [*mesh("BLOCK", [0.0, 2.0, 4.0], [0.0, 1.0]), *material("BLOCK", (1000.0, 0.0)),
             "*ELSET, ELSET=END", "2", "*NODE", "90001, 7., 0.5", "90002, 5., 0.",
             *equation,
             "*RIGID BODY, REF NODE=90001, ELSET=END", *STATIC, "*BOUNDARY", "BLOCK.LEFT, 1, 2",
             "90001, 2", "90001, 6", *load.split("\n"), "*END STEP"]
    judge(tmp_path, cards, [("U1", "BLOCK.RIGHT", "LAST", 12.0 * 2.0 / 1000.0, 1e-9)])


def heated(value):
    """Return a bar, 2 high, between 0 and a rigid plate of a temperature, h = 4 in between."""
    cards = [*mesh("BLOCK", [-1.0, 0.0, 1.0], [0.0, 1.0, 3.0]), *DRAWN,
             *material("BLOCK", (1000.0, 0.0), conductivity=6.0), *SMOOTH, "*GAP CONDUCTANCE",
             "4., 0.", "4., 100.", "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE",
             "BLOCK.TOP, PLATE", "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE",
             "1., 1.", "*BOUNDARY", "BLOCK.BOTTOM, 1, 2", "BLOCK.BOTTOM, 11", "9001, 1, 1",
             "9001, 6", "9001, 2, 2, -0.01", f"9001, 11, 11, {value!r}", "*END STEP"]
    flux = value / (3.0 / 6.0 + 1.0 / 4.0)
    return cards, [("master_temperature", "FACE", "LAST", value, 1e-9),
                   ("heat_rate", "FACE", "LAST", -2.0 * flux, 1e-9),
                   ("slave_temperature", "FACE", "LAST", value - flux / 4.0, 1e-9)]


def test_heat_comes_from_the_reference_node(tmp_path):
    judge(tmp_path, *heated(60.0))


def test_a_hot_plate_that_leans_heats_as_its_mirror_image_and_as_one_of_elements_do(tmp_path):
    """It touches within the last side of the face, or within the first one."""
    held = ["9001, 1", "9001, 6", "9001, 2, 2, -0.006"]
    plate = [*mesh("PLATE", [0.0, 2.0], [1.0, 1.5], "CPE4", first=101,
                   to=lambda x, y: (x, y + x / 50)),
             *material("PLATE", (1000.0, 0.3), 0.0, 6.0), "*RIGID BODY, REF NODE=9001, ELSET=PLATE"]
    ways = [(["*SURFACE, NAME=PLATE.BOTTOM, TYPE=SEGMENTS", f"START, 2., {right!r}",
              f"LINE, 0., {left!r}", "*RIGID BODY, REF NODE=9001, ANALYTICAL SURFACE=PLATE.BOTTOM"],
             "9001, 11, 11, 80.") for left, right in ((1.04, 1.0), (1.0, 1.04))]
    found = []
    for way, (body, hot) in enumerate([*ways, (plate, "PLATE, 11, 11, 80.")]):
        deck = write(tmp_path / f"way{way}.inp", mesh(
            "BLOCK", [0.0, 0.5, 1.0, 1.5, 2.0], [0.0, 0.5, 1.0]),
            material("BLOCK", (1000.0, 0.3), 0.0, 6.0), ["*NODE", "9001, 1., 2."], body, [
            *SMOOTH, "*GAP LAW, TYPE=GAS", "0.01, 0.005", "*GAP LAW, TYPE=POWER", "2., 0.5, 1.",
            "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, PAIRING=SURFACES",
            "BLOCK.TOP, PLATE.BOTTOM", "*STEP",
            "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.", "*BOUNDARY",
            "BLOCK.BOTTOM, 1, 2", "BLOCK.BOTTOM, 11", *held, hot, "*END STEP"])
        with h5py.File(solve_as_written(deck)) as file:
            face = file["contact/FACE"]
            found.append([face[name][-1] for name in ("heat_rate", "normal_force")])
            assert 0 < np.count_nonzero(face["pressure"][-1]) < 3
    np.testing.assert_allclose(found[1:], [found[0]] * 2, rtol=1e-6)


def test_a_node_below_a_kink_of_a_drawing_is_pressed_as_its_mirror_image(tmp_path):
    found = []
    for left, right in ((1.2, 1.0), (1.0, 1.2)):
        deck = write(tmp_path / f"{left}.inp", mesh("BLOCK", [0.0, 0.5, 1.0, 1.5, 2.0],
                                                   [0.0, 0.5, 1.0], "CPE4"),
                     material("BLOCK", (1000.0, 0.3)), [
            "*NODE", "9001, 1., 2.", "*SURFACE, NAME=PLATE, TYPE=SEGMENTS", f"START, 3., {right!r}",
            "LINE, 1., 1.", f"LINE, -1., {left!r}",
            "*RIGID BODY, REF NODE=9001, ANALYTICAL SURFACE=PLATE", *SMOOTH,
            "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, PAIRING=NODES", "BLOCK.TOP, PLATE",
            "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "BLOCK.BOTTOM, 1, 2", "9001, 1", "9001, 6",
            "9001, 2, 2, -0.01", "*END STEP"])
        with h5py.File(solve(deck)) as file:
            pressure = file["contact/FACE/pressure"][-1]
            found.append([file["contact/FACE/normal_force"][-1], pressure.max()])
    np.testing.assert_allclose(found[1], found[0], rtol=1e-9)


def test_rotation_that_is_large_is_warned_of(tmp_path):
    cards, _ = heated(60.0)
    deck = tmp_path / "deck.inp"
    deck.write_text("\n".join(cards).replace("9001, 6", "9001, 6, 6, 0.5") + "\n")
    assert "a rotation of 0.5 rad is large" in run("check", deck).stderr


BLOCK = [*mesh("BLOCK", [-1.0, 0.0, 1.0], [0.0, 1.0, 3.0]),
         *material("BLOCK", (1000.0, 0.0), conductivity=6.0), "*NODE", "9001, 0., 2.",
         "9002, 0., 2.", "9003, 0., 2.", "9004, 0., 2.", "*ELSET, ELSET=TWO", "2",
         "*ELSET, ELSET=THREE", "3", "*NSET, NSET=TWO, ELSET=TWO", "*NSET, NSET=THREE, ELSET=THREE"]


@pytest.mark.parametrize(("parameter", "values"), [
    pytest.param("NSET", ("BLOCK.TOP", "BLOCK.RIGHT"), marks=pytest.mark.changes(
        "RIGID BODY, NSET")),
    pytest.param("TIE NSET", ("BLOCK.TOP", "BLOCK.RIGHT"), marks=pytest.mark.changes(
        "RIGID BODY, TIE NSET")),
    pytest.param("PIN NSET", ("BLOCK.TOP", "BLOCK.RIGHT"), marks=pytest.mark.changes(
        "RIGID BODY, PIN NSET")),
    pytest.param("ELSET", ("TWO", "THREE"), marks=pytest.mark.changes("RIGID BODY, ELSET"))])
def test_what_is_named_follows(tmp_path, parameter, values):
    follows(tmp_path, lambda value: (
        [*BLOCK, f"*RIGID BODY, REF NODE=9001, {parameter}={value}", *STATIC, "*BOUNDARY",
         "1, 1, 2", "9001, 1, 1, 0.02", "9001, 2", "9001, 6", "*END STEP"],
        [("U1", value, "LAST", 0.02, 1e-9)]), *values)


@pytest.mark.changes("RIGID BODY, REF NODE")
def test_reference_node_is_the_one_named(tmp_path):
    follows(tmp_path, lambda value: (
        [*BLOCK, f"*RIGID BODY, REF NODE={value}, NSET=BLOCK.TOP",
         f"*RIGID BODY, REF NODE={18003 - value}, NSET=BLOCK.BOTTOM", *STATIC, "*BOUNDARY",
         "9001, 1, 1, 0.02", "9001, 2", "9001, 6", "9002, 1, 2", "9002, 6", "*END STEP"],
        [("U1", "BLOCK.TOP", "LAST", 0.02 * (value == 9001), 1e-9, "ABS")]), 9001, 9002)


@pytest.mark.changes("RIGID BODY, ROT NODE")
def test_node_of_the_rotation_is_the_one_named(tmp_path):
    """The face is 1 above the reference node."""
    follows(tmp_path, lambda value: (
        [*BLOCK, f"*RIGID BODY, REF NODE=9001, ROT NODE={value}, NSET=BLOCK.TOP",
         f"*RIGID BODY, REF NODE=9002, ROT NODE={18007 - value}, NSET=BLOCK.BOTTOM", *STATIC,
         "*BOUNDARY", "9001, 1, 2", "9002, 1, 2", "9003, 1, 3, 0.01", "9004, 3", "*END STEP"],
        [("U1", "BLOCK.TOP", "LAST", -0.01 * (value == 9003), 1e-9, "ABS")]), 9003, 9004)


@pytest.mark.changes("RIGID BODY, ISOTHERMAL")
def test_rigid_body_has_one_temperature_if_asked_for(tmp_path):
    follows(tmp_path, lambda value: (
        [*BLOCK, f"*RIGID BODY, REF NODE=9001, NSET=BLOCK.TOP, ISOTHERMAL={value}", "*STEP",
         "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY", "BLOCK.BOTTOM, 11",
         "9001, 11, 11, 60.", "*END STEP"],
        [("NT", "BLOCK.TOP", "LAST", 60.0 * (value == "YES"), 1e-9, "ABS")]), "YES", "NO")


@pytest.mark.changes("RIGID BODY, ANALYTICAL SURFACE")
def test_drawing_is_the_one_named(tmp_path):
    corner = next(card.split(",")[0] for card in BLOCK if card.endswith(", -1, 3"))
    follows(tmp_path, lambda value: (
        [*BLOCK, "*SURFACE, NAME=WEST", "3, S3", "*SURFACE, NAME=EAST", "4, S3",
         "*SURFACE, NAME=ONE, TYPE=SEGMENTS", "START, 0., 3.", "LINE, -1., 3.",
         "*SURFACE, NAME=TWO, TYPE=SEGMENTS", "START, 1., 3.", "LINE, 0., 3.",
         f"*RIGID BODY, REF NODE=9001, ANALYTICAL SURFACE={value}",
         f"*RIGID BODY, REF NODE=9002, ANALYTICAL SURFACE={dict(ONE='TWO', TWO='ONE')[value]}",
         *SMOOTH, "*CONTACT PAIR, INTERACTION=SMOOTH, PAIRING=NODES", "WEST, ONE",
         "*CONTACT PAIR, INTERACTION=SMOOTH, PAIRING=SURFACES", "EAST, TWO", *STATIC,
         "*BOUNDARY", "BLOCK.BOTTOM, 1, 2", "9001, 1", "9001, 6", "9002, 1", "9002, 6",
         "9001, 2, 2, -0.01", "9002, 2, 2, -0.012", "*END STEP"],
        [("U2", corner, "LAST", -0.01 if value == "ONE" else -0.012, 1e-9)]), "ONE", "TWO")


def test_a_body_that_nothing_keeps_from_turning_is_named(tmp_path):
    cards = [card for card in roller("CPE8", 300.0, "SURFACES") if card != "90001, 6"]
    process = run("run", "--quiet", write(tmp_path / "deck.inp", cards), "--out", tmp_path)
    assert process.returncode == 2
    assert "is free to turn about its reference node" in process.stderr
    assert "the body of *RIGID BODY, line" in process.stderr
