"""The examples pass their checks, and the values of these are those of tests/reference."""

import re
import subprocess
import sys
from functools import cache
from math import log, pi, radians, tan

import h5py
import numpy as np
import pytest
from deck_runs import INPUT, PATIENCE, data_cards, run
from physics import DECKS  # noqa: F401  puts tests/reference on the path
from scipy.optimize import brentq
from test_companion_runs import assert_equal_numbers, is_estimated

import conduction
import crack
import creeping_fit
import friction_strip
import fuel_rod as rings
import hot_tubes
import lame
import tables
import transient
from moving_source import face_temperature
from rods import Rods, gas, power, solve

EXAMPLES = INPUT / "examples"
NAMES = sorted(path.stem for path in EXAMPLES.glob("*.inp"))


def two_rods():
    """The rods of tests/reference/rods.py, with this example's data."""
    found = {}
    for when, hot in (("200.", 200.0), ("500.", 500.0)):
        rods = Rods((10.0, 10.0), (0.2, 0.2), (1.2e-5, 0.0), (2e5, 2e5), (hot, 0.0), 0.03)
        state = solve(rods, gas(1.5e-3, 1e-3), power(1.5, 0.01, 1.0))
        found |= {(name, "GAP", when): getattr(state, key)
                  for name, key in (("gap", "gap"), ("heat_flux", "flux"),
                                    ("conductance", "conductance"), ("pressure", "pressure"))}
    return found


def autofrettage():
    """Hill's tube, incompressible but for its displacement; unloading is elastic."""
    a, b, pressure, k, nu = 100.0, 200.0, 180.0, 480.0 / 3**0.5, 0.499
    c = brentq(lambda r: k * (log(r / a) + (1 - (r / b) ** 2) / 2) - pressure, a, b)
    hoop = [k - pressure - part * pressure * (b**2 + a**2) / (b**2 - a**2) for part in (0, 1, 0.5)]
    return {("U1", "81", "1."): (1 - nu**2) * k * c**2 / (2.1e5 * b),
            **{("S33", "1", when): s for when, s in zip(("1.", "2.", "3."), hoop, strict=True)}}


def hot_press_fit():
    """Lame in plane stress before any creep; then the fit in one dimension."""
    fit = creeping_fit.EXAMPLE
    overlaps = fit.interference, fit.interference + 0.8e-6 * 580.0 * fit.seat
    radii = 0.0, fit.seat, fit.outside
    found = {("pressure", "FIT", when): lame.press_fit(*radii, shaft[:2], hub[:2], overlap,
                                                       "stress")
             for when, shaft, hub, overlap in zip(("1.", "11."), fit.shaft, fit.hub, overlaps,
                                                  strict=True)}
    first, fifth, last = fit.course([4980.0, 5 * 4980.0, 8 * 4980.0])
    found |= {("pressure", "FIT", when): fit.response(strains, hot)[0] for when, strains, hot in
              (("4991.", first, 1), ("5001.", first, 0), ("25001.", fifth, 0), ("39991.", last, 1))}
    return found | {("gap", "FIT", "LAST"): fit.response(last, 0)[1]}


def free_fit():
    """Lame with free ends, and the fit in one dimension; on a sector of 10 degrees, 10 thick."""
    steel, seat, area = (2e5, 0.3, 0.0), 50.0, 50.0 * radians(10.0) * 10.0
    fit = creeping_fit.Fit(seat, 100.0, 0.05, (steel, steel), (steel, steel), 0.0, (3.125e-14, 5.0))
    p = lame.press_fit(0.0, seat, 100.0, steel[:2], steel[:2], 0.05, "stress")
    assert p == pytest.approx(75.0)
    hub = np.sum(lame.cylinder(seat, seat, 100.0, p))
    found = {("normal_force", "FIT", "1."): p * area,
             ("U3", "1001", "1."): 10.0 * 0.3 * 2 * p / 2e5,
             ("U3", "1002", "1."): -10.0 * 0.3 * hub / 2e5}
    return found | {("normal_force", "FIT", when): fit.response(strains, 1)[0] * area
                    for when, strains in zip(("2.", "101.", "1001."),
                                             fit.course([1.0, 100.0, 1000.0]), strict=True)}


def press_fit():
    """Lame in plane stress."""
    hub, rim, radii = (2.1e5, 0.3), (7.0e4, 0.33), (20.0, 40.0, 60.0)
    p = lame.press_fit(*radii, hub, rim, 0.05, "stress")
    inside, outside = (20.0, 40.0, 0.0, p), (40.0, 60.0, p)
    return {("pressure", "SEAT", "LAST"): p, ("normal_force", "SEAT", "LAST"): p * 800 * pi,
            ("S33", "HUB.LEFT", "LAST"): lame.cylinder(20.0, *inside)[1],
            ("S33", "RIM.LEFT", "LAST"): lame.cylinder(40.0, *outside)[1],
            ("S33", "RIM.RIGHT", "LAST"): lame.cylinder(60.0, *outside)[1],
            ("U1", "HUB.LEFT", "LAST"): lame.displacement(
                20.0, *lame.cylinder(20.0, *inside), *hub, "stress"),
            ("U1", "RIM.RIGHT", "LAST"): lame.displacement(
                60.0, *lame.cylinder(60.0, *outside), *rim, "stress")}


def hot_sleeve():
    """One tube in another, open and closed."""
    tubes = (2.1e5, 0.3, 1.2e-5, 0.045), (1.1e5, 0.26, 1e-5, 0.05)
    found = {}
    for when, hot in (("50.", 50.0), ("LAST", 300.0)):
        gap_left, pressure, omega, flux, faces = hot_tubes.hot_fit(
            (20.0, 40.0, 60.0), tubes, (hot, 0.0), 0.03, gas(3e-5, 0.005),
            power(0.006, 2e-4, 0.95), "strain")
        values = {"gap": gap_left, "pressure": pressure, "conductance": omega, "heat_flux": flux,
                  "slave_temperature": faces[0], "master_temperature": faces[1],
                  "normal_force": pressure * 20 * pi, "heat_rate": flux * 20 * pi}
        found |= {(name, "SEAT", when): value for name, value in values.items()}
    return found


def roller():
    """Hertz: a cylinder on a half-space, in plane strain."""
    force, radius = 400.0, 20.0
    compliance = (1 - 0.3**2) / 2.1e5 + (1 - 0.33**2) / 7.0e4
    a = (4 * force * radius * compliance / pi) ** 0.5
    return {("edge_contact", "LINE", "1."): a, ("pressure", "LINE@0.", "1."): 2 * force / (pi * a),
            ("normal_force", "LINE", "1."): force / 2, ("normal_force", "LINE", "LAST"): force / 2}


def fuel_pellet():
    """Free expansion, balances; the rod over its radius, without the ends of the pellets."""
    rod = rings.example()
    heat = 0.6 * pi * 4.1**2 * 30
    strain = tables.thermal_strain(rod.pellet.expansion, 20.0, 20.0, 300.0)
    young = tables.value(rod.pellet.young, 300.0)
    gap = 0.02 + 280 * 6e-6 * 4.12 - 4.1 * (strain + 0.316 * 0.5 / young)
    state = rod.solve(0.6)
    found = {(name, "WALL2@5.", "LAST"): state[key]
             for name, key in (("slave_temperature", "face"), ("master_temperature", "bore"),
                               ("conductance", "conductance"))}
    return found | {
        ("gap", "WALL1", "1."): gap, ("normal_force", "ENDS12", "LAST"): 0.5 * pi * 4.1**2,
        ("heat_in", "", "LAST"): heat, ("heat_out", "", "LAST"): heat,
        ("NT", "TUBE.RIGHT", "LAST"): state["outside"]}


def fuel_rod():
    """Free expansion and the spring, balances."""
    power = [float(row[2]) for row in data_cards(EXAMPLES / "fuel_rod.inp", "*DFLUX")]
    assert len(power) == 20
    gap = 0.015 + 280 * (6e-6 * 4.115 - 1.03e-5 * 4.1) - 4.1 * 0.316 * 2 / 1.8e5
    heat = sum(power) * pi * 4.1**2 * 10
    return {("gap", "GAP-PELLET-1.SIDE", "1."): gap, ("gap", "GAP-PELLET-20.SIDE", "1."): gap,
            ("normal_force", "END-PELLET-2.BOTTOM", "1."): 2 * pi * 4.1**2,
            ("heat_in", "", "LAST"): heat, ("heat_out", "", "LAST"): heat}


def test_tables_of_the_fuel_pellet_are_those_of_the_formulas():
    rod = rings.example()
    elastic = [[(young, ring.poisson, t) for young, t in ring.young]
               for ring in (rod.pellet, rod.tube)]
    expected = {"*ELASTIC": elastic[0] + elastic[1], "*CONDUCTIVITY": rod.oxide + rod.wall,
                "*EXPANSION": [*rod.pellet.expansion, (6e-6,)]}
    for keyword, rows in expected.items():
        found = data_cards(EXAMPLES / "fuel_pellet.inp", keyword)
        assert [tuple(map(float, row)) for row in found] == rows, keyword


def bolted_flange():
    """Force and equilibrium after tightening; springs behind and beside each other after that."""
    modulus, width, bore, thickness = 2.1e5, 32.0, 22.0, 30.0
    bolt = (31.0 + 10.0) / (modulus * pi * 10.0**2)
    cone = width + 2.0 * thickness * tan(radians(30.0))
    flange = log((width + bore) * (cone - bore) / ((width - bore) * (cone + bore))) / (
        pi * modulus * bore * tan(radians(30.0)))
    gasket = 1.0 / (500.0 * pi * (30.0**2 - 16.0**2))
    water = 30.0 * pi * (16.0**2 - 11.0**2)
    return {("pre_tension", "BOLT", "1."): 6e4, ("normal_force", "SEAT", "1."): 6e4,
            ("normal_force", "GASKET", "1."): 6e4,
            ("pre_tension", "BOLT", "2."): 6e4 + water * gasket / (bolt + flange + gasket)}


def cracked_plate():
    """A crack in a strip; heat around it."""
    from math import cos

    a, width, height, k = 10.0, 40.0, 160.0, 0.05
    longer = 4 * width / pi * log(1 / cos(pi * a / (2 * width)))
    flux = k * 100.0 / (height + longer)
    jump = crack.jump(0.0, a, flux, k) * crack.finite_width_heat(a, width)
    return {("gap", "CRACK@0.", "2."):
            crack.opening(0.0, a, 50.0, 2e5) * crack.finite_width(a, width),
            ("slave_temperature", "CRACK@0.", "3."): 50.0 + jump / 2,
            ("master_temperature", "CRACK@0.", "3."): 50.0 - jump / 2,
            ("heat_in", "", "3."): flux * width}


def turbine_joint():
    """A wall of three layers."""
    flux, _ = conduction.wall([12, 2, 15], [0.02, 0.35, 0.03], 600, 400,
                              contacts=[2e-4 + 2e-5 * 60**0.95, 4e-3])
    return {("heat_rate", name, "LAST"): 20 * flux for name in ("UPPER", "LOWER")}


def thermal_cycling():
    """A strip: forces in one dimension, edges between two nodes in two."""
    strip = 1.0, 1e5, 1e-5
    places, stuck = thermal_cycling_zones()
    found = {("shear_force", "SOLE", f"{time}."): -friction_strip.held_force(*strip, rise)
             for time, rise in ((1, 60.0), (3, 60.0), (4, 90.0))}
    for when, row, slip in (
            ("1.", 20, friction_strip.slip_length(*strip, 60.0, 0.3, 10.0)),
            ("2.", 40, friction_strip.reversed_slip_length(*strip, 60.0, 0.3, 10.0)),
            ("2.9", 58, friction_strip.reversed_slip_length(*strip, 54.0, 0.3, 10.0)),
            ("4.", 80, friction_strip.slip_length(*strip, 90.0, 0.3, 10.0))):
        last = np.flatnonzero(stuck[row])[-1]
        edge = places[last:last + 2].mean()
        assert edge == pytest.approx(40.0 - slip, abs=1.0)   # the height
        found["edge_stick", "SOLE", when] = edge
    return found


def thermal_cycling_zones():
    """Return the nodes behind the held one, and which of them stick after each increment."""
    rises = np.cumsum([0.0] + 20 * [3.0] + 20 * [-3.0] + 20 * [3.0] + 20 * [1.5])
    return friction_strip.strip_zones(40.0, 1.0, 1e5, 1e-5, 0.3, 10.0, rises, 40)


def warm_blocks():
    """A wall after a shock until the blocks touch, and the steady state of two rods."""
    stretch, scale = 1.2e-5 * 300.0 * 20.0, 0.045 / (7.5e-6 * 480.0) / 20.0**2
    gap = {when: stretch * (0.5 - transient.mean_of_shocked_wall(when * scale))
           for when in (2.0, 4.0, 6.0, 6.29, 6.3)}
    assert gap[6.29] > 0.0 > gap[6.3]   # between these two the deck sees the faces touch
    found = {("gap", "GAP", f"{when:g}."): gap[when] for when in (2.0, 4.0, 6.0)}
    for when in (4.0, 6.0):
        rise = 300.0 * transient.shocked_wall(1.0, when * scale)
        found["slave_temperature", "GAP", f"{when:g}."] = rise
    rods = Rods((20.0, 20.0), (0.045, 0.045), (1.2e-5, 1.2e-5), (2.1e5, 2.1e5), (300.0, 0.0),
                stretch / 2)
    state = solve(rods, None, power(0.0, 1e-4, 1.0))
    slave, master = state.face_temperature
    last = {"pressure": state.pressure, "heat_flux": state.flux, "slave_temperature": slave,
            "master_temperature": master}
    return found | {(name, "GAP", "LAST"): value for name, value in last.items()}


def shrink_shock():
    """Lame before and long after the shock, and a half-space with a film at its beginning."""
    steel, radii = (2.1e5, 0.3), (0.0, 20.0, 40.0)
    found = {}
    for when, overlap in (("0.01", 0.02), ("LAST", 0.02 - 1e-6 * 280 * 20)):
        p = lame.press_fit(*radii, steel, steel, overlap, "stress")
        found |= {("pressure", "SEAT", when): p,
                  ("normal_force", "SEAT", when): p * 2 * pi * 20 * 20}
    hoop = lame.cylinder(40.0, 20.0, 40.0, p)
    cold = lame.press_fit(*radii, steel, steel, 0.02, "stress")
    scale = 0.01 * (0.045 * 0.1 / (7.5e-6 * 480.0)) ** 0.5 / 0.045
    return found | {
        ("S33", "HUB.RIGHT", "0.01"): lame.cylinder(40.0, 20.0, 40.0, cold)[1],
        ("S11", "SHAFT.RIGHT", "0.01"): -cold,
        ("NT", "HUB.RIGHT", "0.11"): 20 + 280 * transient.half_space_with_film(scale),
        ("U1", "HUB.RIGHT", "LAST"): lame.displacement(40.0, *hoop, *steel, "stress", 280 * 1.2e-5)}


def brake_disc():
    """Half-spaces until the heat comes back from the disc's middle, and the heat of braking."""
    effusivities = (0.045 * 7.5e-6 * 480.0) ** 0.5, (1e-3 * 2e-6 * 1000.0) ** 0.5
    found = {}
    for when, time in (("0.051", 0.05), ("0.101", 0.1), ("0.501", 0.5)):
        disc, lining = transient.braking(0.005, effusivities, 4.0, time)
        found |= {("slave_temperature", "TRACK@20.", when): 25.0 + 3.0 * disc,
                  ("master_temperature", "TRACK@20.", when): 25.0 + 3.0 * lining}
    area = pi * (120.0**2 - 80.0**2)
    capacity = area * 10.0 * 2e-3 + pi * (130.0**2 - 60.0**2) * 6.0 * 3.6e-3
    warm = 25.0 + 3.0 * 4.0 / 2 * area / capacity
    return found | {("heat_in", "", "2.001"): 1.5 * area, ("NT", "MAX", "LAST"): warm,
                    ("NT", "MIN", "LAST"): warm, ("normal_force", "TRACK", "LAST"): 2.0 * area}


def brake_pad():
    """Balances."""
    return {("normal_force", "TRACK", "LAST"): 2.0 * 40, ("shear_force", "TRACK", "LAST"): 0.4 * 80,
            ("heat_in", "", "LAST"): 0.5 * 20, ("heat_out", "", "LAST"): 0.5 * 20}


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    """Solve examples once each, without uncertainties; return their results by name."""
    folder = tmp_path_factory.mktemp("examples")

    @cache
    def result(name):
        process = run("run", "--quiet", EXAMPLES / f"{name}.inp", "--out", folder, "--errors", "no")
        assert process.returncode == 0, process.stderr
        # The casting alone is warned of, once for each of its two gaps: the melt does not follow.
        told = process.stderr.splitlines()
        assert len(told) == (2 if name == "casting" else 0)
        assert all("opens where a face is above its *ANNEAL" in line for line in told)
        return folder / f"{name}.vtkhdf"

    return result


@pytest.mark.parametrize("name", NAMES)
def test_example_passes_its_checks(solved, name):
    with h5py.File(solved(name)) as file:
        # Rounding of sums over some hundred nodes; the shrink fit's radial sums are no imbalance.
        # Laws settle to 1e-9 of the largest force at a node, and few forces balance in a melt.
        assert (file["history/force_imbalance"][()] < (1e-7 if name == "casting" else 1e-9)).all()


@pytest.mark.parametrize("name", [name for name in NAMES if is_estimated(EXAMPLES / f"{name}.inp")])
def test_estimates_change_no_digit_of_an_example(solved, name, tmp_path):
    """As of the decks in test_companion_runs.py."""
    process = run("run", "--quiet", EXAMPLES / f"{name}.inp", "--out", tmp_path, "--errors", "last")
    assert process.returncode == 0, process.stderr
    assert process.stderr == ""
    assert_equal_numbers(solved(name), tmp_path / f"{name}.vtkhdf")


def test_heat_that_enters_the_shocked_fit_warms_it(solved):
    """The heat rate is a curve: the trapezoidal rule gives it to 0.1 % with these increments."""
    with h5py.File(solved("shrink_shock")) as file:
        time, rate = file["history/time"][1:], file["history/heat_in"][1:]
    heat = np.sum(np.diff(time) * (rate[1:] + rate[:-1]) / 2) + (time[0] - 0.01) * rate[0]
    assert heat == pytest.approx(7.5e-6 * 480.0 * 280.0 * pi * 40**2 * 20, rel=2e-3)


def test_zones_of_the_cycled_strip_are_those_of_the_independent_solution(solved):
    """Every node at every increment but the one at time 3, where all that slipped back is on the
    verge of slipping again."""
    with h5py.File(solved("thermal_cycling")) as file:
        status, s = file["contact/SOLE/status"][()], file["contact/SOLE/s"][()]
    places, stuck = thermal_cycling_zones()
    np.testing.assert_allclose(s[1:], places, rtol=1e-12)
    clear = np.arange(len(stuck)) != 60
    np.testing.assert_array_equal(status[clear, 1:], np.where(stuck, 2, 1)[clear])


def hot_die():
    """Conduction through a bar and its contact; a bar in plane strain, halfway between free and
    held along x."""
    flux = (120.0 - 20.0) / (10.0 / 0.2 + 1 / 0.02)
    strain, growth = 0.005 / 10.0, 2.3e-5 * flux * 10.0 / 0.2 / 2
    free = 7e4 / (1 - 0.3**2) * (strain + 1.3 * growth)
    held = 7e4 / 1.3 / 0.4 * (0.7 * strain + 1.3 * growth)
    assert [free, held] == pytest.approx([122.0 - 26.0, 122.0 + 26.0], abs=0.5)
    return {("heat_rate", "CONTACT", "1."): -40.0 * flux,
            ("slave_temperature", "CONTACT", "1."): 120.0 - flux / 0.02,
            ("master_temperature", "CONTACT", "1."): 120.0}


def rail_pad():
    """Jaeger's band after 40 mm, above 20 degrees; friction of 2000 N at 10 mm/s."""
    steel = 0.045, 0.045 / (7.5e-6 * 480.0)
    at = {"1007": -10.0, "1013": -5.0, "1019": 0.0, "1025": 5.0}
    return {("heat_friction", "", "LAST"): 1e-3 * 0.3 * 2000.0 * 10.0,
            **{("NT", node, "LAST"): 20.0 + face_temperature(ahead, 10.0, 10.0, 0.3, *steel)
               for node, ahead in at.items()}}


def test_friction_takes_the_work_of_the_drive_of_a_pad(solved):
    """Once all slips; expansion makes 4e-4 of it: the rail lifts the pad as it gets warm."""
    parts = re.findall(r"heat of friction less work of the drive +(\S+) of it",
                       solved("rail_pad").with_suffix(".lst").read_text())
    assert len(parts) == 64
    assert max(abs(float(part)) for part in parts[1:]) < 1e-3


PIN = {"radius": 10.0, "outside": 14.0, "overlap": 0.02, "young": 7e4, "poisson": 0.33, "mu": 0.1}


def seat_pressure(depth, radius, outside, overlap, young, poisson, mu):
    """Return the pressure below a depth of seat: Lame's with the axial stress of the friction above
    it, F' = 2 pi a mu p, p = (E d/a - nu F/A)/(...)."""
    ratio = (outside**2 + radius**2) / (outside**2 - radius**2) + poisson
    length = ratio * (outside**2 - radius**2) / (2 * radius * poisson * mu)
    return young * overlap / radius / ratio * np.exp(-depth / length)


def pin_in_hole():
    """In the middle of the seat, far from the lead-in and from the end of the hub."""
    return {("pressure", f"SEAT@{40 - depth}", "LAST"): seat_pressure(depth, **PIN)
            for depth in (18, 14, 10)}


def test_the_force_of_a_pin_grows_by_the_friction_of_its_seat(solved):
    with h5py.File(solved("pin_in_hole")) as file:
        depth, force = file["history/time"][()], -file["contact/SEAT/shear_force"][()]
    low, high = (int(np.argmin(abs(depth - at))) for at in (15.0, 30.0))
    # The seat begins 0.5 above the end of the hub.
    seats = np.linspace(depth[low] - 0.5, depth[high] - 0.5, 101)
    pressures = [seat_pressure(d, **PIN) for d in seats]
    grown = 2 * pi * PIN["radius"] * PIN["mu"] * np.mean(pressures) * (seats[-1] - seats[0])
    assert force[high] - force[low] == pytest.approx(grown, rel=0.01)


def worn_pad():
    """Archard's law: K times force times slip for 20000 cycles, and the force of the pressure."""
    force = 5.0 * 20.0 * 10.0
    return {("worn_volume_slave", "SEAT", "LAST"): 1e-8 * 20000 * force * 40.0,
            ("normal_force", "SEAT", "LAST"): force}


def valve_stem():
    """Lame's pressure of the overlap."""
    pressure = lame.press_fit(0.0, 4.0, 8.0, (2.1e5, 0.3), (1.1e5, 0.34), 0.002, "stress")
    return {("pressure", "GUIDE@4.", "1."): pressure,
            ("normal_force", "GUIDE", "1."): pressure * 2 * pi * 4.0 * 8.0}


def test_the_temperatures_of_a_valve_stem_repeat(solved):
    """And what comes in over a cycle goes out."""
    with h5py.File(solved("valve_stem")) as file:
        n = len(file["VTKHDF/PointData/node_id"])
        temperature = file["VTKHDF/PointData/temperature"][()].reshape(-1, n)
        history = {k: file[f"history/{k}"][()] for k in ("time", "heat_in", "heat_out",
                                                         "heat_friction")}
    cycle = round(4.0 / 0.4)
    times = history["time"]
    assert times[-1] - times[-1 - cycle] == pytest.approx(4.0)
    assert 5 * cycle < len(times) < 31 * cycle
    change = abs(temperature[-1] - temperature[-1 - cycle]).max()
    moved = abs(temperature[-1] - temperature[-1 - cycle // 2]).max()
    assert change < 0.2 < 3.0 < moved
    mean = {k: np.mean(v[-cycle:]) for k, v in history.items()}
    assert mean["heat_friction"] > 0.5
    assert mean["heat_in"] + mean["heat_friction"] == pytest.approx(mean["heat_out"], rel=0.02)


def casting():
    """Halfway between Chvorinov's time with the resistance of the coating, and with that of the gap
    besides by which the shell shrinks while it cools from 560 to 450."""
    heat = 2.6e-6 * (3.9e5 + 95 * 1000.0) / (585.0 - 200.0)
    ways = 0.0125 / 5e-5, (0.0125 + 0.05) / 5e-5
    times = [pi / 4 * heat**2 / (0.03 * 7.8e-6 * 500.0) * 10.0**2 + heat * 10.0 * way
             for way in ways]
    return {("solid_time", "", "LAST"): sum(times) / 2, ("MISES", "1", "10."): 0.0,
            ("SOLID", "1", "LAST"): 1.0}


@pytest.mark.parametrize("name", NAMES)
def test_checks_of_an_example_are_those_of_the_closed_forms(name):
    expected = globals()[name]()
    stated = {tuple(row[:3]): float(row[3])
              for row in data_cards(EXAMPLES / f"{name}.inp", "*VERIFY")}
    common = expected.keys() & stated.keys()
    assert len(common) >= 2
    for key in common:
        assert stated[key] == pytest.approx(expected[key], rel=2e-5), key


def test_meshes_are_those_that_the_script_writes(tmp_path):
    script = tmp_path / "make_meshes.py"
    script.write_text((EXAMPLES / "make_meshes.py").read_text())
    subprocess.run([sys.executable, script], check=True, timeout=PATIENCE)
    written = sorted(tmp_path.glob("*.mesh"))
    assert [path.name for path in written] == sorted(p.name for p in EXAMPLES.glob("*.mesh"))
    for path in written:
        assert path.read_text() == (EXAMPLES / path.name).read_text(), path.name
