"""Every constant of an anisotropic material, and the axes that it has: two values of each."""

import numpy as np
import pytest
from changes import note_changes
from physics import follows, judge, material, mesh, nodes_of
from test_physics_loads import static
from test_physics_materials import CONSTANTS, STRAIN, conducting, elastic_deck, orientation
from test_physics_planes import PLANES, checks, moved

import conduction
import lame
import plates

TURN = 20.0   # degrees: no constant of the plane is 0 along x and y
STIFFNESS = plates.engineering(*CONSTANTS.values())
NAMES = {"ORTHO": ["D1111", "D1122", "D2222", "D1133", "D2233", "D3333", "D1212", "D1313", "D2323"],
         "ANISO": ["D1111", "D1122", "D2222", "D1133", "D2233", "D3333", "D1112", "D2212", "D3312",
                   "D1212", "D1113", "D2213", "D3313", "D1213", "D1313", "D1123", "D2223", "D3323",
                   "D1223", "D1323", "D2323"]}
INDICES = {"ORTHO": plates.ORTHO, "ANISO": plates.ANISO}


def uniform(family, stiffness, kind, data):
    """Return a body of a material under a uniform strain, and its stress by Hooke's law."""
    cards = mesh("BODY", [0.0, 1.0], [0.0, 1.2], family + "8")
    return [*cards, *material("BODY", data, elastic_type=kind),
            *static(*moved(cards, STRAIN))], checks(
                plates.stress(stiffness, STRAIN, PLANES[family]), cards, STRAIN)


def altered(kind, name, factor):
    """Return the stiffness with one of its constants, as the card counts them, changed; an
    orthotropic one in its axes, an anisotropic one turned; and the data of the card."""
    stiffness = STIFFNESS if kind == "ORTHO" else plates.turned(STIFFNESS, TURN)
    matrix, data = plates.matrix(stiffness), plates.constants(stiffness, kind)
    at = NAMES[kind].index(name)
    p, q = INDICES[kind][at]
    matrix[p, q] = matrix[q, p] = data[at] = factor * data[at]
    assert np.linalg.eigvalsh(matrix)[0] > 0.0
    return plates.tensor(matrix), data


CASES = [*(("ORTHO", name) for name in NAMES["ORTHO"][:7]),
         *(("ANISO", name) for name in [*NAMES["ANISO"][:9], "D1212"])]


@pytest.mark.changes("ELASTIC")
@pytest.mark.parametrize(("kind", "name"), CASES)
def test_every_stiffness_of_the_plane_counts(tmp_path, kind, name):
    """D3333 does where sigma_zz = 0; the others where eps_zz = 0."""
    family = "CPS" if name == "D3333" else "CPE"

    def make(factor):
        stiffness, data = altered(kind, name, factor)
        return uniform(family, stiffness, kind, data)

    follows(tmp_path, make, 1.0, 1.05)


@pytest.mark.changes("ELASTIC")
def test_third_modulus_counts(tmp_path):
    """In plane strain, with the contractions along it kept; in plane stress it has no part."""
    follows(tmp_path, lambda e3: elastic_deck("CPE", CONSTANTS | {"E3": e3}), 900.0, 800.0)
    for e3 in (900.0, 800.0):
        judge(tmp_path, *elastic_deck("CPS", CONSTANTS | {"E3": e3}))
    _, one = elastic_deck("CPS", CONSTANTS)
    _, other = elastic_deck("CPS", CONSTANTS | {"E3": 800.0})
    np.testing.assert_allclose([row[3] for row in one], [row[3] for row in other], rtol=1e-12)


@pytest.mark.changes("ELASTIC")
@pytest.mark.parametrize(("kind", "name"), [
    ("ENGINEERING CONSTANTS", "G13"), ("ENGINEERING CONSTANTS", "G23"), ("ORTHO", "D1313"),
    ("ORTHO", "D2323"), ("ANISO", "D1313"), ("ANISO", "D1323"), ("ANISO", "D2323")])
@pytest.mark.parametrize("family", ["CPE", "CPS"])
def test_shear_out_of_the_plane_changes_nothing(tmp_path, family, kind, name):
    def make(factor):
        if kind in NAMES:
            stiffness, data = altered(kind, name, factor)
            return uniform(family, stiffness, kind, data)
        return elastic_deck(family, CONSTANTS | {name: factor * CONSTANTS[name]})

    (one, found), (other, _) = make(1.0), make(1.5)
    note_changes(one, other)
    for cards in (one, other):
        judge(tmp_path, cards, found)


@pytest.mark.changes("ELASTIC, TYPE")
def test_type_of_elasticity(tmp_path):
    """The same nine numbers mean a compliance or a stiffness."""
    data = [10.0, 3.0, 12.0, 0.2, 0.3, 0.4, 5.0, 4.0, 6.0]

    def make(kind):
        stiffness = plates.engineering(*data)
        if kind == "ORTHO":
            matrix = np.diag([10.0, 12.0, 0.4, 5.0, 4.0, 6.0])
            matrix[0, 1] = matrix[1, 0] = 3.0
            matrix[0, 2] = matrix[2, 0] = 0.2
            matrix[1, 2] = matrix[2, 1] = 0.3
            stiffness = plates.tensor(matrix)
        return uniform("CPE", stiffness, kind, data)

    follows(tmp_path, make, "ENGINEERING CONSTANTS", "ORTHO")


def test_third_conductivity_changes_nothing(tmp_path):
    deck, found = conducting(3.0, 0.5, 40.0)
    assert "3.0, 0.5, 1.0" in deck
    for k33 in ("1.0", "7.0"):
        judge(tmp_path, [card.replace("3.0, 0.5, 1.0", f"3.0, 0.5, {k33}") for card in deck], found)


# Axes.

@pytest.mark.changes("ORIENTATION")
@pytest.mark.parametrize(("one", "other"), [
    ("1., 0., 0., 0., 1., 0.\n3, 15.", "1., 0., 0., 0., 1., 0.\n3, 20."),
    ("1., 0.5, 0., 0., 1., 0.", "1., 0.4, 0., 0., 1., 0."),
    ("1., 0.5, 0., 0., 1., 0.\n3, 15.", "1., 0.5, 0., 0., -1., 0.\n3, 15.")])
def test_axes_of_an_orientation(tmp_path, one, other):
    """The first point gives axis 1; the second only on which side axis 2 lies, which a stiffness
    that is turned round axis 3 afterwards shows."""
    def make(data):
        rows = [[float(f) for f in row.split(",")] for row in data.splitlines()]
        a, b = rows[0][:2], rows[0][3:5]
        hand = np.sign(a[0] * b[1] - a[1] * b[0])
        degrees = np.rad2deg(np.arctan2(a[1], a[0])) + hand * sum(row[1] for row in rows[1:])
        deck, found = elastic_deck("CPE", CONSTANTS, degrees=float(degrees))
        at = deck.index("*ORIENTATION, NAME=TURNED, SYSTEM=RECTANGULAR") + 1
        return [*deck[:at], *data.splitlines(), *deck[at + 1:]], found

    follows(tmp_path, make, one, other)


INNER, OUTER, PRESSURE = 1.0, 2.0, 10.0
ROUND = ["*ORIENTATION, NAME=ROUND, SYSTEM=CYLINDRICAL", "0., 0., 0., 0., 0., 1."]


def polar(angle, radius):
    """Return the place of a point; the angle in degrees grows clockwise from y."""
    return (float(radius * np.sin(np.deg2rad(angle))), float(radius * np.cos(np.deg2rad(angle))))


def quarter(kind="CPS8", radii=7):
    """Return a quarter of a ring, its LEFT on y and its RIGHT on x, and its smooth supports."""
    cards = mesh("BODY", list(np.linspace(0.0, 90.0, 9)), list(np.linspace(INNER, OUTER, radii)),
                 kind, to=polar)
    nodes = nodes_of(cards)
    return cards, [f"{n}, {axis}" for n, p in nodes.items() for axis in (1, 2)
                   if abs(p[axis - 1]) < 1e-12]


def ring(axes, along, across):
    """Return the ring under a pressure inside, a card that turns its axes or none, its answer."""
    cards, held = quarter()
    radial, hoop, out = lame.polar_orthotropic(INNER, INNER, OUTER, PRESSURE, along, across, 0.2)
    assert radial < 0.0 < hoop
    corner = next(n for n, p in nodes_of(cards).items() if abs(p[1]) < 1e-12
                  and abs(p[0] - INNER) < 1e-12)
    moduli = (along, across, 0.2)
    if axes:   # turned: the first axis goes round
        moduli = (across, along, 0.2 * across / along)
    data = [moduli[0], moduli[1], 1000.0, moduli[2], 0.0, 0.0, 700.0, 700.0, 700.0]
    return [*ROUND, *axes, *cards, *material(
        "BODY", data, elastic_type="ENGINEERING CONSTANTS", section=", ORIENTATION=ROUND"),
        *static("*BOUNDARY", *held, "*DSLOAD", f"BODY.BOTTOM, P, {PRESSURE!r}")], [
        ("U1", corner, "LAST", out, 2e-4), ("S22", corner, "LAST", hoop, 2e-2)]


def test_axes_of_a_ring_go_round(tmp_path):
    """Moduli along the radius and across it; turned by 90 degrees they change places."""
    turn = ["3, 90."]
    judge(tmp_path, *ring([], 900.0, 2500.0))
    turned, found = ring(turn, 900.0, 2500.0)
    judge(tmp_path, turned, found)
    judge(tmp_path, [card for card in turned if card not in turn], found, status=4)
    follows(tmp_path, lambda across: ring([], 900.0, across), 2500.0, 2200.0)


@pytest.mark.changes("ORIENTATION", "ORIENTATION, SYSTEM")
def test_system_of_an_orientation(tmp_path):
    """Radial heat in a quarter of a ring meets the first conductivity round the axis, and both
    in a rectangular system, where the temperatures of all nodes are given."""
    cards, _ = quarter("CPE8", radii=25)
    nodes = nodes_of(cards)
    diagonal = min(nodes, key=lambda n: abs(nodes[n][0] - nodes[n][1])
                   + abs(np.hypot(*nodes[n]) - 1.5))
    gradient = np.array(nodes[diagonal]) / np.hypot(*nodes[diagonal]) ** 2

    def make(system):
        axes = ROUND if system == "CYLINDRICAL" else orientation(0.0, "ROUND")
        tensor = conduction.conductivity_tensor(3.0, 0.5, 45.0 if system == "CYLINDRICAL" else 0.0)
        given = [f"{n}, 11, 11, {np.log(np.hypot(*p)):.15g}" for n, p in nodes.items()]
        flux = -tensor @ gradient
        return [*axes, *cards, *material(
            "BODY", conductivity=(3.0, 0.5, 1.0), conductivity_type="ORTHO",
            section=", ORIENTATION=ROUND"), "*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.",
            "*BOUNDARY", *given, "*END STEP"], [
            # Parabolas through log r, fluxes extrapolated over elements of an eighth of 90 degrees.
            (f"HFL{k + 1}", diagonal, "LAST", flux[k], 0.03) for k in (0, 1)]

    follows(tmp_path, make, "CYLINDRICAL", "RECTANGULAR")


@pytest.mark.changes("ORIENTATION")
def test_axis_of_a_cylindrical_system(tmp_path):
    """Heat along x in a square far from the axis: there the system is all but rectangular."""
    far = 1e6

    def make(place):
        x, y, axis = place
        cards = mesh("BODY", [0.0, 2.0], [0.0, 1.0])
        along = 3.0 if x else 0.5
        deck = ["*ORIENTATION, NAME=ROUND, SYSTEM=CYLINDRICAL",
                f"{x!r}, {y!r}, 0., {x!r}, {y!r}, {axis!r}", *cards, *material(
                    "BODY", conductivity=(3.0, 0.5, 1.0), conductivity_type="ORTHO",
                    section=", ORIENTATION=ROUND"), "*STEP", "*HEAT TRANSFER, STEADY STATE",
                "1., 1.", "*BOUNDARY", "BODY.LEFT, 11, 11, 0.", "BODY.RIGHT, 11, 11, 10.",
                "*END STEP"]
        return deck, [("HFL1", "BODY", "LAST", -along * 5.0, 1e-5)]

    follows(tmp_path, make, (-far, 0.0, 1.0), (0.0, -far, 1.0))
    for axis in (1.0, -1.0):   # which way the axis points does not matter without a turn
        judge(tmp_path, *make((-far, 0.0, axis)))


def test_direction_of_the_axis_turns_axes_the_other_way(tmp_path):
    """With 3, 30 behind it: from x towards y where it points along z, else towards -y."""
    far, found = 1e6, {}
    for axis, degrees in ((1.0, 30.0), (-1.0, -30.0)):
        deck, rows = conducting(3.0, 0.5, degrees)
        at = next(k for k, card in enumerate(deck) if card.startswith("*ORIENTATION"))
        deck[at:at + 2] = ["*ORIENTATION, NAME=TURNED, SYSTEM=CYLINDRICAL",
                           f"{-far!r}, 0., 0., {-far!r}, 0., {axis!r}", "3, 30."]
        loose = [(q, w, t, v, 1e-4) for q, w, t, v, _ in rows if q.startswith("HFL")]
        judge(tmp_path, deck, loose)
        found[axis] = deck, loose
    judge(tmp_path, found[1.0][0], found[-1.0][1], status=4)


# About an axis: 1 along the radius, 2 along the axis, 3 round the circumference.

def bored(moduli):
    """Return a free ring about an axis under a pressure inside, and its answer: contractions from
    the axis and along it are 0, so that it is in plane stress."""
    along, axial, across = moduli
    radial, hoop, out = lame.polar_orthotropic(INNER, INNER, OUTER, PRESSURE, along, across, 0.2)
    data = [along, axial, across, 0.0, 0.2, 0.0, 400.0, 400.0, 400.0]
    return [*mesh("BODY", list(np.linspace(INNER, OUTER, 9)), [0.0, 0.2], "CAX8"), *material(
        "BODY", data, elastic_type="ENGINEERING CONSTANTS"), *static(
            "*BOUNDARY", "BODY.BOTTOM, 2", "*DSLOAD", f"BODY.LEFT, P, {PRESSURE!r}")], [
        ("U1", "BODY.LEFT", "LAST", out, 1e-4), ("S33", "BODY.LEFT", "LAST", hoop, 2e-2),
        ("S22", "BODY", "LAST", 0.0, 1e-7, "ABS"), ("U2", "BODY.TOP", "LAST", 0.0, 1e-10, "ABS")]


@pytest.mark.changes("ELASTIC")
@pytest.mark.parametrize("other", [(1000.0, 700.0, 2500.0), (900.0, 700.0, 2300.0)])
def test_moduli_of_a_ring_about_an_axis(tmp_path, other):
    follows(tmp_path, bored, (900.0, 700.0, 2500.0), other)


def test_modulus_along_the_axis_of_a_ring_that_is_pressed_on_its_ends(tmp_path):
    cards = mesh("BODY", [INNER, OUTER], [0.0, 0.5], "CAX8")

    def make(axial):
        data = [900.0, axial, 2500.0, 0.0, 0.2, 0.0, 400.0, 400.0, 400.0]
        return [*cards, *material("BODY", data, elastic_type="ENGINEERING CONSTANTS"), *static(
            "*BOUNDARY", "BODY.BOTTOM, 2", "*DSLOAD", "BODY.TOP, P, 7.")], [
            ("U2", "BODY.TOP", "LAST", -7.0 / axial * 0.5, 1e-9),
            ("S22", "BODY", "LAST", -7.0, 1e-9), ("U1", "BODY", "LAST", 0.0, 1e-12, "ABS")]

    follows(tmp_path, make, 700.0, 800.0)


@pytest.mark.changes("EXPANSION")
@pytest.mark.parametrize("k", [0, 1, 2])
def test_every_expansion_about_an_axis(tmp_path, k):
    """A heated ring that cannot move: Hooke's law along r, the axis and round it."""
    cards = mesh("BODY", [INNER, OUTER], [0.0, 0.5], "CAX8")
    rise = 40.0

    def make(factor):
        alpha = np.array([1e-5, 3e-5, 5e-5])
        alpha[k] *= factor
        stress = -rise * plates.matrix(STIFFNESS)[:3, :3] @ alpha
        return [*cards, *material("BODY", CONSTANTS.values(), elastic_type="ENGINEERING CONSTANTS",
                                  expansion=alpha, expansion_type="ORTHO"), *static(
            "*BOUNDARY", "BODY, 1, 2", "*TEMPERATURE", f"BODY, {rise!r}")], [
            (name, "BODY", "LAST", value, 1e-9)
            for name, value in zip(("S11", "S22", "S33"), stress, strict=True)]

    follows(tmp_path, make, 1.0, 1.1)


@pytest.mark.changes("EXPANSION, ZERO")
def test_secants_of_a_table_begin_at_zero(tmp_path):
    """A free square: alpha(T) (T - ZERO) - alpha(T0) (T0 - ZERO), coefficients linear between rows."""
    cards = mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS8")
    start, warm, slope = 50.0, 80.0, 2e-7

    def make(zero):
        def alpha(temperature):
            return 1e-5 + slope * temperature

        strain = alpha(warm) * (warm - zero) - alpha(start) * (start - zero)
        return [*cards, "*MATERIAL, NAME=M", "*ELASTIC", "2.E5, 0.3", f"*EXPANSION, ZERO={zero!r}",
                f"{alpha(0.0)!r}, 0.", f"{alpha(200.0)!r}, 200.",
                "*SOLID SECTION, ELSET=BODY, MATERIAL=M", "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
                f"BODY, {start!r}", *static("*BOUNDARY", "BODY.LEFT, 1", "BODY.BOTTOM, 2",
                                            "*TEMPERATURE", f"BODY, {warm!r}")], [
            ("U1", "BODY.RIGHT", "LAST", strain, 1e-8), ("U2", "BODY.TOP", "LAST", strain, 1e-8),
            ("S11", "BODY", "LAST", 0.0, 1e-6, "ABS")]

    follows(tmp_path, make, 20.0, 0.0)


@pytest.mark.changes("CONDUCTIVITY")
def test_conductivities_about_an_axis(tmp_path):
    """The first along the radius, the second along the axis; round it no heat flows."""
    cards = mesh("BODY", list(np.linspace(INNER, OUTER, 9)), [0.0, 0.5], "CAX8")
    height = 0.5

    def make(values):
        k, sides, rate = values
        return [*cards, *material("BODY", conductivity=k, conductivity_type="ORTHO"), "*STEP",
                "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY",
                f"BODY.{sides[0]}, 11, 11, 100.", f"BODY.{sides[1]}, 11, 11, 10.", "*END STEP"], [
            ("heat_in", "", "LAST", rate, 1e-5)]

    for k in ((3.0, 0.5, 2.0), (2.0, 0.7, 5.0)):
        through = height * conduction.tube_rate(INNER, OUTER, k[0], 100.0, 10.0)
        along = k[1] * 90.0 / height * np.pi * (OUTER**2 - INNER**2)
        judge(tmp_path, *make((k, ("LEFT", "RIGHT"), through)))
        judge(tmp_path, *make((k, ("TOP", "BOTTOM"), along)))
    follows(tmp_path, make, *(((k, 0.5, 1.0), ("LEFT", "RIGHT"), height * conduction.tube_rate(
        INNER, OUTER, k, 100.0, 10.0)) for k in (3.0, 2.0)))
