"""Uniform states that two blocks in contact must reproduce exactly, and Coulomb's law by hand."""

import h5py
import numpy as np
import pytest
from blocks import block, solid, write
from deck_runs import solve

XS = [0.0, 0.3, 1.0]  # the sides differ in length
UPPER, LOWER = [0.0, 0.4, 0.5], [-1.0, -0.3, 0.0]
PAIRS = 5
MESH = [*block("UPPER", XS, UPPER, 1, 0.05), *block("LOWER", XS, LOWER, 101, -0.05)]
FACES = ["*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "UPPER.BOTTOM, LOWER.TOP"]


def read(result, *names):
    """Return datasets of the contact at the last increment."""
    with h5py.File(result) as file:
        return [file[f"contact/FACE/{name}"][-1] for name in names]


def fields(result, name):
    """Return coordinates and a nodal field at the last increment."""
    with h5py.File(result) as file:
        data = file["VTKHDF"]
        count = len(data["PointData/node_id"])
        return data["Points"][()][-count:, :2], data[f"PointData/{name}"][()][-count:]


def test_heat_crosses_two_blocks_and_a_constant_conductance(tmp_path):
    """q = (T1 - T2)/(L1/k1 + L2/k2 + 1/omega); the bodies do not expand and do touch."""
    hot, cold, omega, conductivity = 90.0, 20.0, 0.7, (3.0, 0.5)
    deck = write(
        tmp_path / "heat.inp",
        MESH,
        solid("UPPER", 1e4, 0.3, 0.0, conductivity[0]),
        solid("LOWER", 2e4, 0.2, 0.0, conductivity[1]),
        f"""
        *SURFACE INTERACTION, NAME=FACES
        *GAP LAW, TYPE=POWER
        {omega}, 0., 1.
        """,
        FACES,
        f"""
        *STEP
        *COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE
        1., 1.
        *BOUNDARY
        UPPER.TOP, 2, 2, -1.E-3
        LOWER.BOTTOM, 2, 2, 0.
        UPPER.LEFT, 1, 1, 0.
        LOWER.LEFT, 1, 1, 0.
        UPPER.TOP, 11, 11, {hot}
        LOWER.BOTTOM, 11, 11, {cold}
        *END STEP
        """,
    )
    flux = (hot - cold) / (0.5 / conductivity[0] + 1.0 / conductivity[1] + 1.0 / omega)
    result = solve(deck)
    names = "heat_flux", "slave_temperature", "master_temperature", "conductance", "heat_rate"
    found = read(result, *names)
    upper, lower = hot - flux * 0.5 / conductivity[0], cold + flux / conductivity[1]
    for name, values, expected in zip(names, found, (flux, upper, lower, omega, flux), strict=True):
        np.testing.assert_allclose(values, expected, rtol=1e-11, err_msg=name)
    points, temperature = fields(result, "temperature")
    _, body_flux = fields(result, "heat_flux")
    with h5py.File(result) as file:
        above = file["VTKHDF/PointData/node_id"][()][: len(points)] < 101
    expected = np.where(above, hot - flux * (0.5 - points[:, 1]) / conductivity[0],
                        cold + flux * (points[:, 1] + 1.0) / conductivity[1])
    np.testing.assert_allclose(temperature, expected, rtol=1e-11)
    np.testing.assert_allclose(body_flux[:, 1], -flux, rtol=1e-10)
    np.testing.assert_allclose(body_flux[:, 0], 0.0, atol=1e-10 * flux)


@pytest.mark.parametrize("solver", ["SKYLINE", "MUMPS"])
@pytest.mark.parametrize("levels", [0, 1, 2])
def test_uniform_pressure_passes_every_pair(tmp_path, levels, solver):
    """Corner and midside pairs alike; the upper block is held by the contact alone."""
    pressure = 12.5
    deck = write(
        tmp_path / "pressure.inp",
        MESH,
        solid("UPPER", 1e4, 0.3),
        solid("LOWER", 2e3, 0.45),
        "*SURFACE INTERACTION, NAME=FACES",
        FACES,
        f"""
        *REFINE, LEVELS={levels}
        *SOLVER, TYPE={solver}
        *STEP
        *STATIC
        0.5, 1.
        *BOUNDARY
        LOWER.BOTTOM, 2, 2, 0.
        UPPER.LEFT, 1, 1, 0.
        LOWER.LEFT, 1, 1, 0.
        *DLOAD
        3, P3, {pressure}
        4, P3, {pressure}
        *END STEP
        """,
    )
    result = solve(deck)
    found, status, force, gap = read(result, "pressure", "status", "normal_force", "gap")
    assert len(found) == (PAIRS - 1) * 2**levels + 1
    np.testing.assert_allclose(found, pressure, rtol=1e-10)
    assert np.all(status == 1)
    assert np.all(gap == 0.0)
    assert force == pytest.approx(pressure, rel=1e-10)
    _, stress = fields(result, "stress")
    np.testing.assert_allclose(stress[:, 1], -pressure, rtol=1e-9)
    np.testing.assert_allclose(stress[:, [0, 3]], 0.0, atol=1e-9 * pressure)


PRESSURE, YOUNG, FRICTION = 100.0, 1e4, 0.3
SHEAR_MODULUS = YOUNG / 2.0  # nu = 0


def side_forces(name, side, shear):
    """Return the data of *CLOAD for the shear on a vertical side: 1 : 4 : 1 on three-node sides."""
    ys, first = (UPPER, 1) if name == "UPPER" else (LOWER, 101)
    cards = block(name, XS, ys, first)
    nodes = cards[1 : cards.index(f"*ELEMENT, TYPE=CPE8, ELSET={name}")]
    rows = [card.split(", ") for card in nodes]
    edge, sign = (XS[-1], 1.0) if side == "RIGHT" else (XS[0], -1.0)
    on_side = sorted((float(y), n) for n, x, y in rows if float(x) == edge)
    forces = {n: 0.0 for _, n in on_side}
    for low, middle, high in zip(on_side[:-2:2], on_side[1::2], on_side[2::2], strict=True):
        for (_, n), share in ((low, 1), (middle, 4), (high, 1)):
            forces[n] += sign * shear * share * (high[0] - low[0]) / 6
    return [f"{n}, 2, {force!r}" for n, force in forces.items()]


def shear_deck(path, shear, slip, friction=FRICTION):
    """Press one block on another and shear both uniformly, with a slip between them."""
    heights = UPPER[-1] - LOWER[0]
    down = PRESSURE * heights / YOUNG
    aside = shear * heights / SHEAR_MODULUS + slip
    return write(
        path,
        MESH,
        solid("UPPER", YOUNG, 0.0),
        solid("LOWER", YOUNG, 0.0),
        f"""
        *SURFACE INTERACTION, NAME=FACES
        *FRICTION
        {friction}, 1.E5
        """,
        FACES,
        f"""
        *STEP
        *STATIC
        0.25, 1.
        *BOUNDARY
        UPPER.TOP, 1, 1, {aside!r}
        UPPER.TOP, 2, 2, {-down!r}
        LOWER.BOTTOM, 1, 2, 0.
        *CLOAD
        """,
        *(side_forces(name, "LEFT", shear) for name in ("UPPER", "LOWER")),
        *(side_forces(name, "RIGHT", shear) for name in ("UPPER", "LOWER")),
        "*END STEP",
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_block_below_the_limit_sticks(tmp_path, sign):
    shear = sign * 0.9 * FRICTION * PRESSURE
    result = solve(shear_deck(tmp_path / "stick.inp", shear, 0.0))
    pressure, traction, slip, status = read(result, "pressure", "shear", "slip", "status")
    assert np.all(status == 2)
    np.testing.assert_allclose(pressure, PRESSURE, rtol=1e-9)
    np.testing.assert_allclose(traction, -shear, rtol=1e-9)  # on the slave, against its motion
    np.testing.assert_allclose(slip, 0.0, atol=1e-15)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_block_at_the_limit_slips(tmp_path, sign):
    shear, slipped = sign * FRICTION * PRESSURE, sign * 0.004
    result = solve(shear_deck(tmp_path / "slip.inp", shear, slipped))
    names = "pressure", "shear", "slip", "status", "shear_force", "normal_force"
    pressure, traction, slip, status, shear_force, normal_force = read(result, *names)
    assert np.all(status == 1)
    np.testing.assert_allclose(pressure, PRESSURE, rtol=1e-9)
    np.testing.assert_allclose(traction, -shear, rtol=1e-9)
    np.testing.assert_allclose(slip, slipped, rtol=1e-9)
    assert shear_force == pytest.approx(-sign * FRICTION * normal_force, rel=1e-12)
