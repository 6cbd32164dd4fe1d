"""A fuel rod whose heat closes its gap: conductivities, moduli and expansion over temperature, gas
that conducts more when it is warm, contact that conducts more when it is pressed.

Rings of pellet and tube without strain along the axis, against tests/reference/fuel_rod.py.
"""

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import solve
from physics import material, mesh, nodes_of

import fuel_rod

POWERS = [0.1, 0.2, 0.3, 0.4, 0.5]   # W/mm^3, an increment each


def strip(count, transient=False):
    """Return a strip of the rod of the example."""
    rod = fuel_rod.example(along=0.0)
    a, b, c = rod.radii
    height = 0.2

    def body(name, ring, ends, elements, conductivity, first):
        elastic = [(young, ring.poisson, t) for young, t in ring.young]
        points = [float(r) for r in np.linspace(*ends, elements + 1)]
        stores = {"density": 1e-5, "specific_heat": 300.0} if transient else {}
        return [*mesh(name, points, [0.0, height], "CAX8", first=first),
                *material(name, elastic, ring.expansion, conductivity, zero=ring.zero, **stores)]

    gas = fuel_rod.table(fuel_rod.helium_conductivity, fuel_rod.POINTS[:5])
    step = ["*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", "100., 500."] if transient else [
        "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "0.2, 1."]
    return [*body("PELLET", rod.pellet, (0.0, a), 8 * count, rod.oxide, 1),
            *body("TUBE", rod.tube, (b, c), count, rod.wall, 5001),
            "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=GAS",
            *[f"{k}, 5.E-3, {t}" for k, t in gas], "*GAP CONDUCTANCE, PRESSURE",
            *[f"{k / 5e-3 + 2e-3 * p!r}, {p}, {t}" for k, t in gas for p in (0.0, 200.0)],
            "*CONTACT PAIR, INTERACTION=FACES, NAME=WALL", "PELLET.RIGHT, TUBE.LEFT",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "PELLET, 20.", "TUBE, 20.",
            "*BOUNDARY", "PELLET, 2", "TUBE, 2", "PELLET.LEFT, 1",
            "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*SFILM",
            "TUBE.RIGHT, F, 300., 0.03", "*END STEP", "*STEP, INC=1000", *step, "*DFLUX",
            f"PELLET, BF, {POWERS[-1]}", "*END STEP"]


def at_node(cards, r):
    """Return the row of a node on the lower side."""
    nodes = list(nodes_of(cards).values())
    return next(k for k, p in enumerate(nodes) if abs(p[0] - r) < 1e-9 and p[1] == 0.0)


def final(result):
    """Return temperatures of the nodes, and values of the contact, of all increments."""
    with h5py.File(result) as file:
        contact = {name: values[()] for name, values in file["contact/WALL"].items()
                   if name in ("gap", "pressure", "conductance", "heat_flux", "slave_temperature",
                               "master_temperature")}
        count = file["VTKHDF/NumberOfPoints"][0]
        return file["VTKHDF/PointData/temperature"][()].reshape(-1, count), contact


@pytest.mark.parametrize("count", [1, 2])
def test_states_of_the_rising_power(tmp_path, count):
    """Open, with gas alone, and closed: gap, pressure and temperatures at each power. Errors of the
    coarser mesh fall with h^4."""
    cards = strip(count)
    temperature, contact = final(solve(write(
        tmp_path / "rod.inp", ["*OPTIONS, ERRORS=NO"], cards)))
    rod, states = fuel_rod.example(along=0.0), []
    for k, power in enumerate(POWERS):
        expected = rod.solve(power)
        states.append(expected["pressure"] > 0.0)
        row = k - len(POWERS)
        part = 1e-4 / count**3
        for name, key in (("gap", "gap"), ("pressure", "pressure"),
                          ("conductance", "conductance"), ("slave_temperature", "face"),
                          ("master_temperature", "bore")):
            scale = max(abs(expected[key]), {"gap": 0.02, "pressure": 20.0}.get(name, 0.0))
            np.testing.assert_allclose(contact[name][row], expected[key], rtol=0,
                                       atol=10 * part * scale, err_msg=f"{name} {power}")
        np.testing.assert_allclose(contact["heat_flux"][row], power * 4.1**2 / 2 / 4.11, rtol=1e-8)
        np.testing.assert_allclose(temperature[row][at_node(cards, 0.0)], expected["centre"],
                                   rtol=part)
    assert states == [False] * 4 + [True]


def test_a_rod_that_is_switched_on_comes_to_the_steady_state(tmp_path):
    cards = strip(1, transient=True)
    temperature, contact = final(solve(write(
        tmp_path / "rod.inp", ["*OPTIONS, ERRORS=NO"], cards)))
    expected = fuel_rod.example(along=0.0).solve(POWERS[-1])
    np.testing.assert_allclose(temperature[-1][at_node(cards, 0.0)], expected["centre"], rtol=1e-3)
    np.testing.assert_allclose(contact["pressure"][-1], expected["pressure"], rtol=2e-2)
