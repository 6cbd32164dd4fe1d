"""Decks of heat and contact as Abaqus/CAE writes them run unchanged, with the answer that physics
gives."""

import math

import h5py
import numpy as np
import pytest
from deck_runs import DECKS, run
from physics import judge

LAST = "LAST"


def solved(folder, name, *checks):
    """Solve a deck of the folder `foreign` with checks; return the result's path."""
    cards = (DECKS / "foreign" / f"cae_{name}.inp").read_text().splitlines()
    return judge(folder, cards, checks, name=name)


def history(result):
    """Return the histories of a result by their names."""
    with h5py.File(result) as file:
        return {name: values[()] for name, values in file["history"].items()}


def interface(result, quantity):
    """Return a history of the only interface of a result."""
    with h5py.File(result) as file:
        (contact,) = file["contact"].values()
        return contact[quantity][()]


def assert_heat_balances(result, tolerance=1e-8, content=0.0):
    """Assert in each increment that heat goes in or is made by friction, and goes out or stays, to
    a part of the largest rate of the run, of contact too, and to the rounding of the heat that the
    bodies hold, which a short increment divides by its duration."""
    courses = history(result)
    rounding = 16 * np.finfo(float).eps * content / np.diff(courses["time"], prepend=0.0)
    solved_heat = ~np.isnan(courses["heat_in"])
    given, taken = (courses[name][solved_heat] for name in ("heat_in", "heat_out"))
    stored, made = (np.nan_to_num(courses[name][solved_heat]) if name in courses else 0.0
                    for name in ("heat_stored", "heat_friction"))
    crossing = abs(interface(result, "heat_rate")[solved_heat])
    largest = max(np.max(rates) for rates in (given, taken, crossing))
    assert largest > 0.0
    allowed = tolerance * largest + rounding[solved_heat]
    assert np.all(abs(given + made - taken - stored) <= allowed)


def integral(table, low, high):
    """Return the integral of a table of values over temperature, held at both of its ends."""
    values, temperatures = zip(*table, strict=True)
    inside = [t for t in temperatures if low < t < high]
    points = np.array([low, *inside, high])
    return float(np.trapezoid(np.interp(points, temperatures, values), points))


def root(function, low, high):
    """Return where a rising function is zero, by bisection."""
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (low, middle) if function(middle) > 0 else (middle, high)
    return low


def test_a_pad_slides_on_a_disc(tmp_path):
    """Once the whole pad slips, 90 % of the work of friction, mu F v, becomes heat, and bodies that
    lose none store all of it."""
    force, power = 2.0 * 20.0, 0.9 * 0.3 * 2.0 * 20.0 * 8.0 / 0.008
    result = solved(tmp_path, "brake_disc", ("heat_friction", "", 0.008, power, 1e-5),
                    ("heat_stored", "", 0.008, power, 1e-5),
                    ("heat_out", "", 0.008, 0.0, 0.0, "ABS"),
                    ("normal_force", "PadFace", 0.008, force, 1e-9),
                    ("shear_force", "PadFace", 0.008, -0.3 * force, 1e-9))
    disc, pad = 40.0 * 6.0 * 7.2e-9 * 5e8, 20.0 * 8.0 * 2.5e-9 * 9e8
    assert_heat_balances(result, content=20.0 * (disc + pad))


def test_a_hot_hub_shrinks_onto_a_shaft(tmp_path):
    """A solid shaft in a hub of the same steel: p = E d/(2 b) (1 - b^2/c^2), where d is what the
    free hub shrinks by as it cools from 220 to 20."""
    bore, rim = 0.02, 0.04
    pressure = 2.1e11 * 1.2e-5 * 200 / 2 * (1 - (bore / rim) ** 2)
    result = solved(tmp_path, "shrink_fit",
                    ("pressure", "ShaftSeat", LAST, pressure, 2e-4),
                    ("NT", "MAX", LAST, 20.0, 1e-6),
                    ("S22", "Shaft-1.Set-1", LAST, 0.0, 2e-4 * pressure, "ABS"),
                    ("S11", "Shaft-1.Set-1", LAST, -pressure, 2e-4))
    assert_heat_balances(result)


def test_a_fuel_pellet_radiates_to_its_cladding(tmp_path):
    """Heat made in the pellet crosses the gap by radiation alone; the integral of the conductivity
    of UO2 from the surface to the center is q R^2/4."""
    source, radius, bore, outside, height = 3e7, 0.0041, 0.0042, 0.0048, 0.004
    uo2 = [(6.8, 200.0), (4.3, 600.0), (3.0, 1000.0), (2.4, 1400.0), (2.2, 1800.0)]
    per_length = source * math.pi * radius**2
    bore_temperature = (290 + per_length / (2 * math.pi * outside * 3e4)
                        + per_length * math.log(outside / bore) / (2 * math.pi * 16))
    flux = per_length / (2 * math.pi * (radius + bore) / 2)
    emissivity = 1 / (1 / 0.8 + 1 / 0.6 - 1)
    surface = ((bore_temperature + 273.15) ** 4 + flux / (5.67e-8 * emissivity)) ** 0.25 - 273.15
    center = root(lambda t: integral(uo2, surface, t) - source * radius**2 / 4, surface, 3000.0)
    result = solved(tmp_path, "fuel_pellet",
                    ("heat_rate", "PelletSide", LAST, per_length * height, 1e-9),
                    ("NT", "Bore", LAST, bore_temperature, 1e-5),
                    ("NT", "Surface", LAST, surface, 1e-5), ("NT", "Center", LAST, center, 1e-4))
    assert_heat_balances(result)


def test_a_valve_closes_and_opens(tmp_path):
    """Closed, the gas presses it on its seat and all heat crosses there; open, valve and seat have
    the temperatures of gas and water."""
    force = 10.0 * math.pi * (12.0**2 - 8.0**2)
    result = solved(tmp_path, "valve_seat", ("normal_force", "ValveFace", 1000.0, force, 1e-9),
                    ("heat_rate", "ValveFace", LAST, 0.0, 0.0, "ABS"),
                    ("normal_force", "ValveFace", LAST, 0.0, 0.0, "ABS"),
                    ("NT", "Valve", LAST, 600.0, 1e-4), ("NT", "Seat-1.Set-1", LAST, 80.0, 1e-4))
    assert_heat_balances(result)
    courses = history(result)
    closed = np.flatnonzero(courses["time"] == 1000.0)[0]
    crossing = interface(result, "heat_rate")[closed]
    assert crossing == pytest.approx(courses["heat_in"][closed], rel=1e-6)
    assert crossing == pytest.approx(courses["heat_out"][closed], rel=1e-6)


def test_a_billet_cools_on_a_die(tmp_path):
    """Billet and die, insulated, come to the temperature at which one has taken up the heat that
    the other gave; their specific heats are tables."""
    billet = [(450.0, 0.0), (900.0, 750.0), (650.0, 1200.0)]
    die = [(460.0, 20.0), (600.0, 700.0)]
    common = root(lambda t: 7700 * 0.08 * 0.04 * integral(die, 200.0, t)
                  - 7800 * 0.06 * 0.03 * integral(billet, t, 1100.0), 200.0, 1100.0)
    result = solved(tmp_path, "die", ("NT", "MIN", LAST, common, 1e-5),
                    ("NT", "MAX", LAST, common, 1e-5), ("heat_out", "", LAST, 0.0, 0.0, "ABS"))
    assert_heat_balances(result)


def test_a_blade_hangs_in_its_root(tmp_path):
    """Its root carries half the blade: the density times the squared speed times the moment of its
    area about the axis, times the thickness. All heat of the gas crosses the root."""
    root_block, neck = 1.5 * (11**2 - 10**2) / 2, 0.5 * (17**2 - 11**2) / 2
    force = 2.0 * 8.2e-9 * 1e6 * (root_block + neck)
    result = solved(tmp_path, "blade_root", ("normal_force", "Flank", LAST, force, 1e-9))
    assert_heat_balances(result)
    courses = history(result)
    assert interface(result, "heat_rate")[-1] == pytest.approx(courses["heat_in"][-1], rel=1e-8)


def test_a_mould_is_hot_while_the_melt_is_in_it(tmp_path):
    """Four resistances in series; after a long pause the mould has the temperature of the water."""
    flux, width = 5e4, 0.06
    cold = 20 + flux / 2000
    faces = cold + flux * 0.05 / 30, cold + flux * (0.05 / 30 + 1 / 5000)
    result = solved(tmp_path, "mould", ("heat_rate", "InsertFace", 1.0, flux * width, 1e-9),
                    ("NT", "Cold", 1.0, cold, 1e-9), ("master_temperature", "InsertFace", 1.0,
                                                      faces[0], 1e-9),
                    ("slave_temperature", "InsertFace", 1.0, faces[1], 1e-9),
                    ("NT", "Hot", 1.0, faces[1] + flux * 0.03 / 350, 1e-9),
                    ("NT", "Hot", LAST, 20.0, 1e-4), ("heat_in", "", LAST, 0.0, 1e-3, "ABS"))
    assert_heat_balances(result)


def test_a_clamp_shares_the_heat_of_an_overload(tmp_path):
    """Bar and jaw lose no heat: in the end both have the temperature of all heat made in the
    bar."""
    bar, jaw = 20.0 * 5.0 * 5.0, 12.0 * 6.0 * 5.0
    capacity = bar * 8.9e-9 * 3.9e8 + jaw * 8.5e-9 * 3.8e8
    level = 20.0 + 60.0 * bar * 5.0 / capacity
    result = solved(tmp_path, "clamp", ("normal_force", "JawFace", 1.0, 25.0 * 12.0 * 5.0, 1e-9),
                    ("heat_stored", "", 6.0, 60.0 * bar, 1e-8),
                    ("NT", "Everything", LAST, level, 1e-8))
    assert_heat_balances(result, content=level * capacity)


def test_a_clamp_goes_on_from_a_state(tmp_path):
    """CAE writes *RESTART, WRITE, FREQUENCY=1: the run that goes on from step 2 is the same."""
    whole = solved(tmp_path, "clamp", ("heat_out", "", LAST, 0.0, 0.0, "ABS"))
    with h5py.File(whole) as file:
        instants = file["history/time"][()]
    folder = tmp_path / "again"
    folder.mkdir()
    at = float(instants[len(instants) // 2])
    process = run("run", "--quiet", whole.with_suffix(".inp"), "--restart", f"{whole}@{at!r}",
                  "--errors", "no", "--out", folder)
    assert process.returncode == 0, process.stderr
    again = history(folder / whole.name)
    for name, values in history(whole).items():
        np.testing.assert_array_equal(again[name], values, err_msg=name)


def test_a_bearing_ring_grows_into_its_housing(tmp_path):
    """Two rings free along the axis: the pressure closes what the hot ring grows beyond the
    clearance, with E and the expansion of 120 degrees."""
    young, expansion = 200e3, 1.2e-5 * 100
    a, b, c = 20.0, 25.0, 35.005
    clearance = 0.005
    outer = b + clearance
    inward = b / young * ((b**2 + a**2) / (b**2 - a**2) - 0.3)
    outward = outer / 70e3 * ((c**2 + outer**2) / (c**2 - outer**2) + 0.33)
    pressure = (expansion * b - clearance) / (inward + outward)
    result = solved(tmp_path, "bearing_ring", ("pressure", "RingOutside", LAST, pressure, 2e-3),
                    ("U1", "Seat", LAST, expansion * b - pressure * inward, 2e-3))
    assert_heat_balances(result)


def test_a_tube_is_expanded_into_a_tube_sheet(tmp_path):
    """Films, walls and the joint in series round a tube; the sleeve is welded to the sheet."""
    resistance = (1 / (4000 * 0.010) + math.log(12 / 10) / 20 + 1 / (6000 * 0.012)
                  + math.log(25 / 12) / 16 + 1 / (1500 * 0.025))
    heat = math.pi / 2 * 150 / resistance
    result = solved(tmp_path, "tube_sheet", ("heat_rate", "TubeOutside", LAST, heat, 1e-4),
                    ("NT", "Inside", LAST, 180 - heat / (math.pi / 2 * 0.010 * 4000), 1e-4),
                    ("NT", "Outside", LAST, 30 + heat / (math.pi / 2 * 0.025 * 1500), 1e-4),
                    ("heat_stored", "", LAST, 0.0, 1e-3 * heat, "ABS"))
    assert_heat_balances(result)
