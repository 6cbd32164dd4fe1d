"""A hot tube in another one, in the plane: whole rings, whose contact surfaces are closed, against
tests/reference/hot_tubes.py.

Sides are parabolas through points of the circles. Sums over the ring converge as h^4; pressures at
nodes, forces over tributary lengths, as h^2; temperatures as h^3 or better.
"""

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import solve
from physics import follows, material, mesh, nodes_of

import hot_tubes

RADII = (1.0, 2.0, 3.0)
HUB, RIM = (2000.0, 0.3, 1e-4, 3.0), (700.0, 0.33, 4e-5, 2.0)   # E, nu, alpha, k
HOT, COLD = 150.0, 20.0
AROUND = 2 * np.pi * RADII[1]
CLOSED, OPEN = 0.001, 0.05   # gaps of the cold tubes
SUMS = ("normal_force", "heat_rate")


def gas(gap):
    return 0.005 / (0.01 + gap)


def polar(angle, radius):
    """Return the place of a point; angles grow clockwise, so that elements are anticlockwise."""
    turned = np.deg2rad(-angle)
    return float(radius * np.cos(turned)), float(radius * np.sin(turned))


def tubes(kind, count, gap, slope=0.02):
    """Return two tubes of `count` elements around, hot at the bore, and what is known of them."""
    plane = {"E": "strain", "S": "stress"}[kind[2]]
    inner, face, outer = RADII
    angles, layers = list(np.linspace(0.0, 360.0, count + 1)), count // 4 + 1
    cards = [*mesh("HUB", angles, list(np.linspace(inner, face, layers)), kind, to=polar,
                   closed=True),
             *mesh("RIM", angles, list(np.linspace(face, outer, layers)), kind, 100001, to=polar,
                   closed=True)]
    held = [f"{n}, {axis + 1}" for n, p in nodes_of(cards).items() for axis in (0, 1)
            if abs(p[axis]) < 1e-9]
    for name, (young, poisson, expansion, conductivity) in (("HUB", HUB), ("RIM", RIM)):
        cards += material(name, (young, poisson), expansion, conductivity)
    cards += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HUB, 0.", "RIM, 0.",
              "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=POWER", f"0.5, {slope!r}, 1.",
              "*GAP LAW, TYPE=GAS", "0.005, 0.01", "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE",
              "HUB.TOP, RIM.BOTTOM", f"*CLEARANCE, MASTER=RIM.BOTTOM, SLAVE=HUB.TOP, VALUE={gap!r}",
              "*FIXED POINT, TOL=1.E-12",
              "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
              *held, f"HUB.BOTTOM, 11, 11, {HOT!r}", f"RIM.TOP, 11, 11, {COLD!r}", "*END STEP"]
    opened, pressure, omega, flux, faces = hot_tubes.hot_fit(
        RADII, (HUB, RIM), (HOT, COLD), gap, gas, lambda p: 0.5 + slope * p, plane)
    known = {"gap": opened, "pressure": pressure, "conductance": omega, "heat_flux": flux,
             "slave_temperature": faces[0], "master_temperature": faces[1],
             "normal_force": pressure * AROUND, "heat_rate": flux * AROUND}
    return cards, {name: float(value) for name, value in known.items() if value}


def errors(folder, kind, count, gap):
    """Return the relative errors of a run: of sums, and the largest over the pairs."""
    cards, known = tubes(kind, count, gap)
    path = solve(write(folder / f"tubes{count}.inp", ["*OPTIONS, WIDTH=300, ERRORS=NO"], cards))
    with h5py.File(path) as file:
        pairs = file["contact/FACE"]
        found = {name: np.atleast_1d(pairs[name][-1]) for name in known}
        assert set(pairs["status"][-1]) == {float(gap == CLOSED)}
    return {name: float((values / known[name] - 1)[np.argmax(np.abs(values - known[name]))])
            for name, values in found.items()}


@pytest.mark.parametrize("gap", [CLOSED, OPEN])
@pytest.mark.parametrize("kind", ["CPE8", "CPS8", "CPE8R", "CPS8R", "CPE6", "CPS6"])
def test_forces_and_heat_of_a_ring_converge_as_the_fourth_power(tmp_path, kind, gap):
    """At 32 elements around to 4e-6, their limit to a few hundredths of that."""
    coarse, fine = (errors(tmp_path, kind, count, gap) for count in (16, 32))
    for name in SUMS if gap == CLOSED else SUMS[1:]:
        assert abs(fine[name]) < 4e-6, name
        assert coarse[name] / fine[name] == pytest.approx(16.0, abs=4.0), name
        assert (16 * fine[name] - coarse[name]) / 15 == pytest.approx(0.0, abs=1.5e-7), name
    at_pairs = ("pressure", 4.0) if gap == CLOSED else ("gap", 8.0)
    for name, least in (at_pairs, ("slave_temperature", 7.0)):
        assert abs(fine[name]) < 3e-3, name
        assert abs(coarse[name] / fine[name]) > 0.85 * least, name


def test_forces_and_heat_of_a_fine_ring(tmp_path):
    """64 elements around: 3e-7."""
    fine = errors(tmp_path, "CPE8", 64, CLOSED)
    for name in SUMS:
        assert fine[name] == pytest.approx(0.0, abs=3e-7), name


@pytest.mark.parametrize(("one", "other"), [((0.001, 0.02), (0.0011, 0.02)),
                                            ((0.001, 0.02), (0.001, 0.021)),
                                            ((0.05, 0.02), (0.051, 0.02))])
def test_a_ring_follows_its_clearance_and_its_law(tmp_path, one, other):
    """Closed and open; a change of the law by 5 % changes the flux by 1e-3."""
    tolerance = {"normal_force": 4e-6, "heat_rate": 4e-6, "slave_temperature": 2e-5,
                 "master_temperature": 5e-5, "pressure": 3e-3, "conductance": 1e-3, "gap": 1e-4,
                 "heat_flux": 1e-3}

    def make(values):
        cards, known = tubes("CPE8", 32, *values)
        return cards, [(name, "FACE", "LAST", value, tolerance[name])
                       for name, value in known.items()]

    follows(tmp_path, make, one, other)
