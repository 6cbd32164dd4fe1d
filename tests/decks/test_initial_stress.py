"""Initial stresses: closed forms, and CalculiX on the same deck."""

import h5py
import numpy as np
import pytest
from blocks import write
from calculix import DIGITS, MECHANICS, assert_within, compared, read_listing
from deck_runs import run, solve
from physics import follows, judge, material, mesh, nodes_of
from test_calculix_elements import CLAMPED, HELD, WEDGE, body
from test_physics_planes import KINDS, XS, YS, static

import plates

YOUNG, POISSON = 1000.0, 0.3
# Points of the solid elements that CalculiX makes of plane ones.
SOLID_POINTS = {"8": 27, "8R": 8, "4": 8, "6": 9, "3": 2}
# xx, yy, zz, xy; what is 0 in a plane is left out there.
STRESS = np.array([7.0, -4.0, 5.0, 3.0])


def stressed(*rows):
    """Return the card of initial stresses: (element or set, components)."""
    return ["*INITIAL CONDITIONS, TYPE=STRESS",
            *(f"{where}, " + ", ".join(f"{float(s)!r}" for s in stress) for where, stress in rows)]


def printed(stress):
    """Return the checks of a uniform stress."""
    return [(name, "BODY", "LAST", value, 1e-8, "ABS")
            for name, value in zip(("S11", "S22", "S33", "S12"), stress, strict=True)]


def free_strain(family):
    """Return the strains xx, yy, xy (an angle) of a free body, and its stress: what the plane does
    not let go stays along zz."""
    compliance = np.array([[1.0, -POISSON, -POISSON], [-POISSON, 1.0, -POISSON],
                           [-POISSON, -POISSON, 1.0]]) / YOUNG
    relief, left = -STRESS[:3].copy(), np.zeros(4)
    if family == "CPS":
        relief[2] = 0.0
    if family == "CPE":
        relief[2] = POISSON * (relief[0] + relief[1])
        left[2] = STRESS[2] + relief[2]
    strain = compliance @ relief
    return [strain[0], strain[1], -STRESS[3] * 2 * (1 + POISSON) / YOUNG], left


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("family", ["CPE", "CPS"])
def test_a_free_body_lets_go_of_a_uniform_stress(tmp_path, family, kind):
    """Displacements are -S sigma0, on skewed elements of a mesh that is refined locally too."""
    cards = mesh("BODY", XS, YS, family + kind, skew=0.06)
    strain, left = free_strain(family)
    moves = plates.displacements(list(nodes_of(cards).values()), strain)
    first = next(iter(nodes_of(cards)))
    low = [n for n, (_, y) in nodes_of(cards).items() if y == YS[0]]
    held = ["*BOUNDARY", f"{first}, 1, 1, {float(moves[0][0])!r}"]
    held += [f"{n}, 2, 2, {float(u[1])!r}"
             for n, u in zip(nodes_of(cards), moves, strict=True) if n in low]
    given = STRESS if family == "CPE" else STRESS[[0, 1, 3]]
    checks = printed(left) + [
        (f"U{k + 1}", n, "LAST", u[k], 1e-12, "ABS")
        for n, u in zip(nodes_of(cards), moves, strict=True) for k in (0, 1)]
    judge(tmp_path, ["*REFINE, LEVELS=1, ELSET=PART", *cards, "*ELSET, ELSET=PART", "1",
                     *material("BODY", (YOUNG, POISSON)), *stressed(("BODY", given)),
                     *static(*held)], checks)


@pytest.mark.parametrize("kind", KINDS)
def test_a_free_ring_lets_go_of_a_uniform_stress(tmp_path, kind):
    """Equal radial and hoop stresses keep a ring in equilibrium within; u_r = -r (S sigma0)_rr."""
    radial, axial = 6.0, -4.0
    strains = [-(radial * (1 - POISSON) - POISSON * axial) / YOUNG,
               -(axial - 2 * POISSON * radial) / YOUNG]
    cards = mesh("BODY", XS, YS, "CAX" + kind, skew=0.06)
    checks = printed(np.zeros(4)) + [
        (f"U{k + 1}", n, "LAST", strains[k] * place[k], 1e-12, "ABS")
        for n, place in nodes_of(cards).items() for k in (0, 1)]
    judge(tmp_path, [*cards, *material("BODY", (YOUNG, POISSON)),
                     *stressed(("BODY", [radial, axial, radial])),
                     *static("*BOUNDARY", "BODY.BOTTOM, 2")], checks)


def bar(*cards, kind="CPS8"):
    return [*mesh("BODY", [0.0, 2.0, 5.0], [0.0, 1.0], kind),
            *material("BODY", (YOUNG, POISSON), 1e-5, 4.0), *cards]


@pytest.mark.changes("INITIAL CONDITIONS")
@pytest.mark.parametrize("order", [1, 2])
def test_a_bar_held_at_both_ends_keeps_its_stress_until_one_is_released(tmp_path, order):
    """Then u = -sigma0 L/E."""
    def make(stress, levels):
        ends = ["*BOUNDARY", "BODY.LEFT, 1", "1, 2"]
        deck = [f"*OPTIONS, ORDER={order}", f"*REFINE, LEVELS={levels}", *bar(),
                *stressed(("BODY", [stress])), *static(*ends, "BODY.RIGHT, 1"),
                *static("*BOUNDARY, OP=NEW", *ends[1:])]
        return deck, [("S11", "BODY", 1.0, stress, 1e-9),
                      ("U1", "BODY.RIGHT", 1.0, 0.0, 1e-12, "ABS"),
                      ("S11", "BODY", "LAST", 0.0, 1e-9, "ABS"),
                      ("U1", "BODY.RIGHT", "LAST", -stress * 5.0 / YOUNG, 1e-9),
                      ("U2", 1, "LAST", 0.0, 1e-12, "ABS")]

    follows(tmp_path, lambda stress: make(stress, 1), 20.0, -30.0)
    judge(tmp_path, *make(20.0, 0), name="coarse")


def test_a_stress_stays_where_the_modulus_falls_with_the_temperature(tmp_path):
    """A free bar gives way by -sigma0 L/E(T)."""
    deck = [*mesh("BODY", [0.0, 2.0, 5.0], [0.0, 1.0], "CPS8"),
            *material("BODY", [(1000.0, 0.0, 0.0), (500.0, 0.0, 100.0)]), *stressed(("BODY", [20.0])),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.", *static(
                "*BOUNDARY", "BODY.LEFT, 1", "1, 2", "*TEMPERATURE", "BODY, 100.")]
    judge(tmp_path, deck, [("U1", "BODY.RIGHT", "LAST", -20.0 * 5.0 / 500.0, 1e-8)])


@pytest.mark.changes("INITIAL CONDITIONS, TYPE")
def test_initial_stresses_are_no_initial_temperatures(tmp_path):
    def make(kind):
        deck = [*bar(), f"*INITIAL CONDITIONS, TYPE={kind}", "BODY, 20.",
                *static("*BOUNDARY", "BODY, 1, 2")]
        stress, warmth = (20.0, 0.0) if kind == "STRESS" else (0.0, 20.0)
        return deck, [("S11", "BODY", "LAST", stress, 1e-9, "ABS"),
                      ("NT", "BODY", "LAST", warmth, 1e-9, "ABS")]

    follows(tmp_path, make, "STRESS", "TEMPERATURE")


def test_supports_carry_the_stress_of_a_held_bar_and_no_error_is_estimated(tmp_path):
    """Integration points print it, in a step of heat alone behind it too."""
    points = ["*EL PRINT, ELSET=BODY", "S"]
    deck = write(tmp_path / "deck.inp", bar(), stressed(("BODY", [20.0])),
                 ["*BOUNDARY", "BODY.LEFT, 1", "BODY.RIGHT, 1", "1, 2"],
                 static(*points, "*NODE PRINT, NSET=BODY.LEFT, TOTALS=ONLY", "RF"),
                 ["*STEP", "*HEAT TRANSFER, STEADY STATE", "*BOUNDARY", "BODY.LEFT, 11, 11, 0.",
                  *points, "*END STEP"])
    with h5py.File(solve(deck)) as file:
        errors = [file[name][()] for name in named(file, "stress_error")]
    assert errors
    assert max(np.nanmax(e) for e in errors) < 1e-9
    found = read_listing(deck.with_suffix(".lst"))
    assert found[1.0, "RF1@BODY.LEFT"][()] == pytest.approx(-20.0)
    for time in (1.0, 2.0):
        values = list(found[time, "S11"].values())
        assert values == pytest.approx([20.0] * 18)


def named(file, name):
    """Return the paths of the datasets of a result file that have a name."""
    found = []
    file.visititems(lambda path, item: found.append(path)
                    if isinstance(item, h5py.Dataset) and path.endswith(name) else None)
    return found


@pytest.mark.parametrize("kind", ["CPE8", "CPE8R", "CPE6", "CPE3", "CAX8", "CAX8R"])
def test_calculix_agrees(tmp_path, kind):
    """Its form gives one card an integration point of the solid element; another stress in one
    element, and loads beside it."""
    count = SOLID_POINTS[kind[3:]]
    cards = body(kind)
    elements = [card.split(",")[0] for card in cards[cards.index(
        f"*ELEMENT, TYPE={kind}, ELSET=BODY") + 1:cards.index("*NSET, NSET=BODY.BOTTOM")]]
    rows = []
    for k, element in enumerate(elements):
        stress = STRESS * (-0.5 if k == 1 else 1.0)
        rows += [(f"{element}, {p + 1}", [*stress, 0.0, 0.0]) for p in range(count)]
    rings = kind.startswith("CAX")
    loads = ["*DSLOAD", "BODY.LEFT, P, 2."] if rings else ["*DLOAD", "BODY, P2, 3."]
    found = compared(tmp_path, cards, stressed(*rows), HELD if rings else CLAMPED,
                     ["*STEP", "*STATIC", *loads, *MECHANICS, "*END STEP"], rings=rings)
    assert_within(found, WEDGE if rings else DIGITS)


CONTACT = [
    *mesh("LOWER", [0.0, 1.0, 2.0], [0.0, 1.0], "CPE8"), *material("LOWER", (YOUNG, 0.0)),
    *mesh("UPPER", [0.0, 1.0, 2.0], [1.0, 2.0], "CPE8", first=101),
    *material("UPPER", (YOUNG, 0.0)), "*SURFACE INTERACTION, NAME=FACES",
    "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "LOWER.TOP, UPPER.BOTTOM",
    "*BOUNDARY", "LOWER.BOTTOM, 2", "UPPER.TOP, 2", "LOWER.LEFT, 1", "UPPER.LEFT, 1"]


def test_a_stress_presses_faces_together(tmp_path):
    """Two bars in a row between walls, the lower with sigma0 = -10: both carry half of it. The
    errors of mesh and increments are estimated as 0."""
    deck = ["*OPTIONS, ERRORS=LAST", *CONTACT, *stressed(("LOWER", [0.0, -10.0])), *static()]
    result = judge(tmp_path, deck, [("normal_force", "FACE", "LAST", 10.0, 1e-9),
                                    ("S22", "LOWER", "LAST", -5.0, 1e-9),
                                    ("S22", "UPPER", "LAST", -5.0, 1e-9)])
    with h5py.File(result) as file:
        value, *errors = file["uncertainty/FACE/normal_force"][0]
    assert value == pytest.approx(10.0)
    assert np.abs(errors) == pytest.approx(0.0, abs=1e-9)


def test_heat_alone_needs_no_initial_stress(tmp_path):
    deck = write(tmp_path / "deck.inp", bar(), stressed(("BODY", [20.0])), [
        "*STEP", "*HEAT TRANSFER, STEADY STATE", "*BOUNDARY", "BODY.LEFT, 11, 11, 0.", "*END STEP"])
    process = run("check", deck)
    assert process.returncode == 0, process.stderr
    solve(deck)
    assert "initial stresses are ignored" in deck.with_suffix(".lst").read_text()
