"""Steps with mechanics, with heat and with both, in any order, on the two rods of test_rods.

With nu = 0 and all motion across the rods held, the pressure is p = (e + d - g0)/c with the push
d, the meshed gap g0, c = 2 L/E and the free expansion e = e0 + e1 q of test_rods; heat is
q = T1/(R0 + 1/omega). What is kept while the other field is solved is said in docs/deck.md.
"""

import re

import h5py
import numpy as np
import pytest
from blocks import block, solid, write
from deck_runs import run, solve
from test_rods import (
    CLOSED_C, CONDUCTIVITY, EXPANSION, FREE, GAS_A, GAS_B, HOT, LENGTH, MESHED_GAP, PER_FLUX,
    RESISTANCE, YOUNG, closed_rods,
)

PUSH = 6e-4
TOUCH, COMPLIANCE = GAS_A / GAS_B, 2 * LENGTH / YOUNG
LAWS = f"""
    *GAP LAW, TYPE=GAS
    {GAS_A}, {GAS_B}
    *GAP LAW, TYPE=POWER
    {TOUCH!r}, {CLOSED_C}, 1.
    """
HELD = """
    *BOUNDARY
    COLD.BOTTOM, 2, 2, 0.
    HOT, 1, 1, 0.
    COLD, 1, 1, 0.
    """
HEATED = f"""
    *BOUNDARY
    HOT.TOP, 11, 11, {HOT}
    COLD.BOTTOM, 11, 11, 0.
    """
STATIC = "*STATIC"
HEAT = "*HEAT TRANSFER, STEADY STATE"
COUPLED = "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE"
POINTS = "VTKHDF/PointData"


def pushed(push):
    """Return the card that moves the hot wall towards the cold one."""
    return f"*BOUNDARY\nHOT.TOP, 2, 2, {-push!r}\n"


def rods(path, steps, laws=LAWS, gap=MESHED_GAP, start=0.0, more="", elastic=True):
    """Write a deck of the rods with steps (analysis, further cards); return its path."""
    xs = [0.0, 0.02, 0.05]
    cards = [f"*STEP\n{analysis}\n1., 1.\n{loads}\n*END STEP\n" for analysis, loads in steps]
    sections = solid("HOT", YOUNG, 0.0, EXPANSION, CONDUCTIVITY)
    sections += solid("COLD", YOUNG, 0.0, 0.0, CONDUCTIVITY)
    if not elastic:
        sections = [card for card in sections if card != "*ELASTIC" and card != f"{YOUNG!r}, 0.0"]
    return write(
        path,
        block("HOT", xs, [gap, gap + 0.04, gap + LENGTH], 1),
        block("COLD", xs, [-LENGTH, -0.04, 0.0], 101),
        sections,
        f"""
        *SURFACE INTERACTION, NAME=FACES
        {laws}
        *CONTACT PAIR, INTERACTION=FACES, NAME=FACE
        HOT.BOTTOM, COLD.TOP
        *FIXED POINT, METHOD=ZAITSEV, TOL=1.E-12
        *INITIAL CONDITIONS, TYPE=TEMPERATURE
        HOT, {start}
        COLD, 0.
        {more}
        """,
        "\n".join(cards),
    )


def closed_flux(pressure):
    """Return q through pairs under a pressure."""
    return HOT / (RESISTANCE + 1 / (TOUCH + CLOSED_C * pressure))


def open_flux(gap):
    """Return q through pairs with a gap."""
    return HOT / (RESISTANCE + (GAS_B + gap) / GAS_A)


@pytest.fixture(scope="module")
def orders(tmp_path_factory):
    """Return the result of seven steps: mechanics and heat in turn, both, and unloading."""
    folder = tmp_path_factory.mktemp("orders")
    steps = [
        (STATIC, HELD + pushed(PUSH)), (HEAT, HEATED), (STATIC, ""), (HEAT, ""), (COUPLED, ""),
        (STATIC, pushed(0.0)), (HEAT, ""),
    ]
    return solve(rods(folder / "orders.inp", steps))


def test_each_step_starts_from_what_the_one_before_left(orders):
    first = (PUSH - MESHED_GAP) / COMPLIANCE
    second = closed_flux(first)
    third = (PUSH + FREE - PER_FLUX * second - MESHED_GAP) / COMPLIANCE
    fourth = closed_flux(third)
    fifth, fifth_flux = closed_rods(MESHED_GAP - PUSH)
    gap = MESHED_GAP - (FREE - PER_FLUX * fifth_flux)
    nan = np.nan
    pressures = [first, first, third, third, fifth, 0.0, 0.0]
    fluxes = [nan, second, nan, fourth, fifth_flux, nan, open_flux(gap)]
    with h5py.File(orders) as file:
        contact, history = file["contact/FACE"], file["history"]
        for name, expected in (("pressure", pressures), ("heat_flux", fluxes),
                               ("gap", [0.0] * 5 + [gap] * 2)):
            found = contact[name][()]
            np.testing.assert_allclose(
                found, np.tile(np.array(expected)[:, None], found.shape[1]), rtol=1e-8, atol=1e-12,
                err_msg=name,
            )
        np.testing.assert_allclose(history["heat_in"], np.array(fluxes) * 0.05, rtol=1e-8)
        mechanics = np.array([1, 0, 1, 0, 1, 1, 0], dtype=bool)
        assert np.array_equal(np.isfinite(history["force_imbalance"]), mechanics)
        assert np.nanmax(history["force_imbalance"]) < 1e-10
        heat = np.isfinite(fluxes)
        for name in ("heat_imbalance", "heat_imbalance_pointwise"):
            assert np.array_equal(np.isfinite(history[name]), heat)
            assert np.nanmax(history[name]) < 1e-10
        assert np.array_equal(history["iterations"][()] > 0, [0, 0, 0, 0, 1, 0, 0])


def test_a_heat_step_keeps_displacement_and_stress_and_a_static_one_temperatures(orders):
    with h5py.File(orders) as file:
        points = file[POINTS]
        count = len(file["VTKHDF/Points"])
        rows = {name: points[name][()].reshape(7, count, -1) for name in points
                if name in ("displacement", "stress", "temperature", "heat_flux")}
        pressures = file["contact/FACE/pressure"][:, 0]
    for heat, before in ((1, 0), (3, 2), (6, 5)):
        np.testing.assert_array_equal(rows["displacement"][heat], rows["displacement"][before])
        np.testing.assert_array_equal(rows["stress"][heat], rows["stress"][before])
    np.testing.assert_allclose(rows["stress"][1, :, 1], -pressures[0], rtol=1e-8)
    for static, before in ((2, 1), (5, 4)):
        np.testing.assert_array_equal(rows["temperature"][static], rows["temperature"][before])
        assert np.all(np.isnan(rows["heat_flux"][static]))
    assert np.all(rows["temperature"][0] == 0)


def test_sizes_are_the_largest_of_all_steps(orders, tmp_path):
    # 42 nodes: 10 with a temperature; u_x of all, u_y of 10 held. 5 pairs, without friction. Both
    # fields have one unknown a node, of the same nodes: their factors are of one size.
    heat = solve(rods(tmp_path / "heat.inp", [(HEAT, HEATED)], elastic=False))
    with h5py.File(orders) as file, h5py.File(heat) as half:
        attributes = dict(file["run"].attrs)
        of_one_field = half["run"].attrs["factor_bytes"]
    assert attributes["equations_thermal"] == 42 - 10
    assert attributes["equations_mechanical"] == 42 - 10
    assert attributes["contact_unknowns"] == 5 + 5
    assert attributes["factor_bytes"] == 2 * of_one_field
    # More than a chain has and less than a full triangle; tests/unit/linalg knows the profile.
    assert 8 * (32 + 31) < of_one_field < 8 * 32 * 33 // 2


def test_supports_that_a_later_step_removes_make_its_problem_the_larger_one(tmp_path):
    pressure = 1e6
    freed = HELD.replace("*BOUNDARY", "*BOUNDARY, OP=NEW")
    freed += f"*DLOAD\n3, P3, {pressure}\n4, P3, {pressure}"
    steps = [(STATIC, HELD + pushed(PUSH)), (STATIC, freed), (STATIC, pushed(PUSH))]
    result = solve(rods(tmp_path / "freed.inp", steps))
    with h5py.File(result) as file:
        # u_x of all 42 nodes is held, u_y of 10, then of 5, then of 10 again.
        assert file["run"].attrs["equations_mechanical"] == 42 - 5
        found = file["contact/FACE/pressure"][()]
    first = (PUSH - MESHED_GAP) / COMPLIANCE
    # A wall that is held sets the pressure by its place, a free one carries that of *DLOAD.
    np.testing.assert_allclose(found[0], first, rtol=1e-8)
    np.testing.assert_allclose(found[1], pressure, rtol=1e-8)
    np.testing.assert_allclose(found[2], first, rtol=1e-8)


def names(result):
    """Return the names of all datasets that may be absent."""
    with h5py.File(result) as file:
        return {f"{group}/{name}" for group in ("history", "contact/FACE", POINTS)
                for name in file[group]}


MECHANICS_ONLY = {"history/force_imbalance"} | {
    f"{POINTS}/{name}" for name in ("displacement", "stress", "von_mises")
}
HEAT_ONLY = {"history/" + name for name in (
    "heat_in", "heat_out", "heat_imbalance", "heat_imbalance_pointwise")} | {
    "contact/FACE/" + name for name in (
        "conductance", "heat_flux", "heat_rate", "slave_temperature", "master_temperature")} | {
    f"{POINTS}/{name}" for name in ("heat_flux", "contact_conductance", "contact_heat_flux")}
ALWAYS = {f"contact/FACE/{name}" for name in ("gap", "pressure", "shear", "slip", "status")}


def test_a_deck_of_heat_steps_has_no_mechanics_and_needs_no_elasticity(tmp_path):
    deck = rods(tmp_path / "heat.inp", [(HEAT, HEATED), (HEAT, "")], elastic=False)
    result = solve(deck)
    assert not names(result) & MECHANICS_ONLY
    assert names(result) >= HEAT_ONLY | ALWAYS
    with h5py.File(result) as file:
        contact = file["contact/FACE"]
        np.testing.assert_allclose(contact["heat_flux"], open_flux(MESHED_GAP), rtol=1e-10)
        np.testing.assert_allclose(contact["gap"], MESHED_GAP, rtol=1e-10)
        for name in ("pressure", "shear", "slip", "status", "normal_force"):
            assert np.all(contact[name][()] == 0), name
        assert file["run"].attrs["equations_mechanical"] == 0
        assert file["run"].attrs["contact_unknowns"] == 5
        assert file["run"].attrs["modelled"] in (b"heat, contact", "heat, contact")
    listing = deck.with_suffix(".lst").read_text()
    for text in ("elasticity is off: no step but *HEAT TRANSFER",
                 "CONTACT POINTS THAT NEVER APPROACHED: 5 of 5 of FACE", "heat, scheme IMPLICIT",
                 "A/(B + gap)"):
        assert text in listing, text
    assert "force imbalance" not in listing


def test_a_deck_of_static_steps_has_no_heat(tmp_path):
    deck = rods(tmp_path / "static.inp", [(STATIC, HELD + pushed(PUSH))])
    result = solve(deck)
    assert not names(result) & HEAT_ONLY
    assert names(result) >= MECHANICS_ONLY | ALWAYS
    listing = deck.with_suffix(".lst").read_text()
    assert "heat is off: no step solves temperatures" in listing
    assert "NEVER APPROACHED" not in listing


def test_given_temperatures_are_a_result_of_a_deck_of_static_steps(tmp_path):
    deck = rods(tmp_path / "given.inp", [
        (STATIC, HELD + pushed(PUSH) + "*TEMPERATURE\nHOT, 40.\nCOLD.BOTTOM, 15.\n")])
    with h5py.File(solve(deck)) as file:
        height = file["VTKHDF/Points"][()][:, 1]
        count = len(height)
        temperature = file[f"{POINTS}/temperature"][()][-count:]
    hot = height > 0.5 * MESHED_GAP
    np.testing.assert_allclose(temperature[hot], 40.0, rtol=1e-12)
    at_bottom = np.isclose(height, -LENGTH)
    np.testing.assert_allclose(temperature[at_bottom], 15.0, rtol=1e-12)
    np.testing.assert_allclose(temperature[~hot & ~at_bottom], 0.0, atol=1e-12)


def test_what_no_step_solved_so_far_is_nan(tmp_path):
    steps = [(HEAT, HEATED), (STATIC, HELD + pushed(PUSH))]
    result = solve(rods(tmp_path / "later.inp", steps))
    assert names(result) >= MECHANICS_ONLY | HEAT_ONLY | ALWAYS
    flux = open_flux(MESHED_GAP)
    pressure = (PUSH + FREE - PER_FLUX * flux - MESHED_GAP) / COMPLIANCE
    with h5py.File(result) as file:
        count = len(file["VTKHDF/Points"])
        for name in ("displacement", "stress", "von_mises"):
            values = file[f"{POINTS}/{name}"][()].reshape(2, count, -1)
            assert np.all(np.isnan(values[0])), name
            assert np.all(np.isfinite(values[1])), name
        assert np.all(np.isfinite(file[f"{POINTS}/temperature"]))
        np.testing.assert_allclose(file["contact/FACE/heat_flux"][0], flux, rtol=1e-10)
        np.testing.assert_allclose(file["contact/FACE/pressure"][1], pressure, rtol=1e-8)


def test_faces_that_touch_before_any_mechanics_conduct_as_closed_ones(tmp_path):
    law = f"*GAP LAW, TYPE=POWER\n{TOUCH!r}, {CLOSED_C}, 1."
    result = solve(rods(tmp_path / "touching.inp", [(HEAT, HEATED)], law, gap=0.0))
    with h5py.File(result) as file:
        np.testing.assert_allclose(file["contact/FACE/heat_flux"], closed_flux(0.0), rtol=1e-10)
        assert np.all(file["contact/FACE/status"][()] == 1)


@pytest.mark.parametrize("laws", ["", "*GAP LAW, TYPE=GAS\n1.E-3, 1.\n"])
@pytest.mark.parametrize("overlap", [0.0, 1e-6])
def test_faces_that_touch_start_a_coupled_step_as_closed_ones(tmp_path, laws, overlap):
    """The explicit scheme shows the start: heat of the first increment is that of p = 0."""
    law = f"{laws}*GAP LAW, TYPE=POWER\n{TOUCH!r}, {CLOSED_C}, 1."
    deck = rods(tmp_path / "start.inp", [(COUPLED, HELD + HEATED + pushed(1e-5))], law,
                gap=-overlap, more="*THERMAL SCHEME, TYPE=EXPLICIT")
    with h5py.File(solve(deck)) as file:
        np.testing.assert_allclose(file["contact/FACE/heat_flux"][0], closed_flux(0.0), rtol=1e-10)
        assert np.all(file["contact/FACE/status"][0] == 1)


def test_a_scheme_that_leaves_heat_out_of_balance_is_named(tmp_path):
    """Once for as long as it stays so; a pair that closes puts it out of balance."""
    steps = [(COUPLED, HELD + HEATED + pushed(PUSH)), (COUPLED, ""), (COUPLED, "")]
    for scheme in "IMPLICIT", "GALERKIN", "CRANK-NICOLSON", "EXPLICIT":
        deck = rods(tmp_path / f"{scheme}.inp", steps, more=f"*THERMAL SCHEME, TYPE={scheme}")
        process = run("run", "--quiet", deck, "--out", tmp_path)
        assert process.returncode == 0, process.stderr
        with h5py.File(deck.with_suffix(".vtkhdf")) as file:
            imbalance = file["history/heat_imbalance_pointwise"][()]
        out = imbalance > 0.01
        assert out.any() == (scheme != "IMPLICIT")
        found = re.findall(r"out of balance by ([^ ]*) % .* left by the scheme ([-A-Z]*);",
                           process.stderr)
        starts = np.flatnonzero(np.diff([0, *out]) == 1)
        np.testing.assert_allclose([float(percent) for percent, _ in found],
                                   100 * imbalance[starts], rtol=1e-3)
        assert all(name == scheme for _, name in found)


def test_crank_nicolson_warns_when_it_starts_out_of_equilibrium(tmp_path):
    scheme = "*THERMAL SCHEME, TYPE=CRANK-NICOLSON"
    for start, warns in ((0.0, False), (100.0, True)):
        deck = rods(tmp_path / f"start{warns}.inp", [(HEAT, HEATED), (HEAT, "")], start=start,
                    more=scheme)
        process = run("run", "--quiet", deck, "--out", tmp_path)
        assert process.returncode == 0
        listing = deck.with_suffix(".lst").read_text()
        text = "heat starts out of equilibrium"
        assert process.stderr.count(f"{deck}: warning: increment 1: {text}") == warns
        assert listing.count(text) == 2 * warns
        assert process.stderr.count(f"{deck}: warning") == warns
        with h5py.File(deck.with_suffix(".vtkhdf")) as file:
            assert np.all(file["history/heat_imbalance"][()] < 1e-10)
            assert np.all((file["history/heat_imbalance_pointwise"][()] > 1e-3) == warns)
