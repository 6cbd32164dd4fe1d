"""Decks in the style of CalculiX, PrePoMax, FreeCAD, gmsh and the manuals of Abaqus run unchanged,
with the answers of theory. Those of Abaqus/CAE are in test_abaqus_cae.py, the first ones of all in
test_foreign.py."""

import math

import pytest
from deck_runs import DECKS, run
from physics import judge

FOREIGN = DECKS / "foreign"
LAST = "LAST"


def wall():
    """Return the temperatures of a wall with a source, a film on either side."""
    length, conductivity, source, (hot, cold) = 0.3, 0.8, 400.0, ((12.0, 900.0), (8.0, 20.0))
    # Heat that enters, h1 (T1 - x): what leaves on the other side is that and the source.
    resistance = 1 / hot[0] + length / conductivity + 1 / cold[0]
    flux = (hot[1] - cold[1] - source * length * (length / 2 / conductivity + 1 / cold[0])) / resistance
    return hot[1] - flux / hot[0], cold[1] + (flux + source * length) / cold[0]


def across_a_gap():
    """Return the flux between slabs of 900 and 100 with gas and, half seen, radiation between."""
    def rest(flux):
        one, two = 900.0 - flux * 0.04 / 20.0, 100.0 + flux * 0.02 / 5.0
        radiated = 5.669e-8 * ((one + 273.15) ** 4 - (two + 273.15) ** 4) / (1 / 0.8 + 1 / 0.6 - 1)
        return 10.0 * (one - two) + 0.5 * radiated - flux

    low, high = 0.0, 1e6
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if rest(middle) > 0 else (low, middle)
    return low


def lame_in_plane_strain(radius, inner, outer, pressure, young, poisson):
    """Return the radial displacement of a long tube under internal pressure."""
    factor = (1 + poisson) * pressure * inner**2 / (young * (outer**2 - inner**2))
    return factor * ((1 - 2 * poisson) * radius + outer**2 / radius)


def coil(radius, inner=1.0, outer=2.0, force=3e8, young=1e11):
    """Return the radial displacement of a ring under a radial force per volume, nu = 0."""
    # u = A r + B/r - f r^2/(3 E): E u' is 0 at both radii.
    steep = 2 * force / (3 * young)
    b = steep * (outer - inner) / (1 / inner**2 - 1 / outer**2)
    a = steep * inner + b / inner**2
    return a * radius + b / radius - steep * radius**2 / 2


HOT, COLD = wall()
FLUX = across_a_gap()
BLOCKS = [("pressure", "SSLAVE", LAST, 40.0, 1e-9), ("U2", "MIN", LAST, -4 * 40.0 / 210e3, 1e-9),
          ("normal_force", "SSLAVE", LAST, 120.0, 1e-9)]
CHECKS = {
    "ccx_sheet": [("S11", "MIN", LAST, 10.0, 1e-9), ("S11", "MAX", LAST, 10.0, 1e-9),
                  ("U1", "Nload", LAST, 0.03, 1e-9), ("U2", "MAX", LAST, 0.0, 1e-12, "ABS")],
    "ccx_blocks": BLOCKS,
    "ccx_exponential": [*(row for row in BLOCKS if row[0] != "U2"), (
        "U2", "MIN", LAST, -4 * 40.0 / 210e3 - 1e-5 * math.log(40.0 / 10.0) / math.log(100.0), 1e-9)],
    "ccx_wall": [("NT", "nhot", LAST, HOT, 1e-9), ("NT", "ncold", LAST, COLD, 1e-9)],
    "ccx_shaft": [("S22", "MIN", LAST, 1e8, 1e-9), ("S22", "MAX", LAST, 1e8, 1e-9),
                  ("U2", "TOP", LAST, 0.04 * (1.25e-5 * 200 + 1e8 / 2e11), 1e-9)],
    "ccx_joint": [("normal_force", "S2", LAST, 80.0, 1e-9),
                  ("heat_rate", "S2", LAST, 4 * 100 / (2 / 10 + 1 / 9 + 2 / 10), 1e-6)],
    "prepomax_contact": [
        ("pressure", "Internal_Selection-1_Contact_pair-1_Slave", LAST, 25.0, 1e-9),
        ("U2", "MIN", LAST, -8 * 25 / 210e3, 1e-9)],
    "prepomax_heat": [("NT", "Node_Set-1", LAST, 85.0, 1e-9), ("heat_out", "", LAST, 7800.0, 1e-9)],
    "freecad_tube": [("U1", "MAX", LAST, lame_in_plane_strain(10, 10, 30, 100, 210e3, 0.3), 0.01)],
    "freecad_heat": [("NT", "MAX", LAST, 393.17, 1e-9),
                     ("U1", "MAX", LAST, 2e-5 * (100 * 20 + 0.02 * 20 / 2), 2e-3)],
    "gmsh_bodies": [("pressure", "OVER", LAST, 50.0, 1e-9),
                    ("heat_rate", "OVER", LAST, 2 * 90 / (2 / 40 + 1 / 30 + 2 / 40), 1e-9)],
    "abaqus_ring": [("U1", "1", LAST, 60 / 210e3 * (5 / 3 + 0.3), 3e-3),
                    ("U2", "1201", LAST, 60 / 210e3 * (5 / 3 + 0.3), 3e-3)],
    "abaqus_cylinder": [
        ("U1", "OUTSIDE", LAST, lame_in_plane_strain(20, 10, 20, 30, 1000, 0.3), 0.01)],
    "abaqus_rod": [
        (f"U{c}", corner, LAST, 0.01 * lame_in_plane_strain(20, 10, 20, 1, 1000, 0.3)
         / lame_in_plane_strain(10, 10, 20, 1, 1000, 0.3), 2e-3)
        for c, corner in ((1, "OUTMOST"), (2, "TOPMOST"))],
    "abaqus_platen": [("S22", "MIN", LAST, -10.0, 1e-9), ("S22", "MAX", LAST, -10.0, 1e-9),
                      ("normal_force", "TOP", LAST, 40.0, 1e-9)],
    "abaqus_stamp": [("S22", "MIN", LAST, -100 / (4 * math.pi), 1e-9),
                     ("U2", "REF", LAST, -2 * 100 / (4 * math.pi) / 1000, 1e-9)],
    "abaqus_panel": [("S12", "MIN", LAST, 8.0, 1e-9), ("S12", "MAX", LAST, 8.0, 1e-9),
                     ("U1", "CORNER", LAST, 2 * 8.0 / 80.0, 1e-9),
                     ("U1", "PANEL-1.MIDDLE", LAST, 8.0 / 80.0, 1e-9),
                     ("U1", "PANEL-1.UPPER", LAST, 2 * 8.0 / 80.0, 1e-9),
                     ("S12", "MAX", 0.5, 4.0, 1e-9)],
    "abaqus_disk": [("U1", "85", LAST, 4e-3 * math.sqrt(0.5), 1e-9),
                    ("U2", "25", LAST, 2.5e-3 * math.sqrt(0.5), 1e-9),
                    ("S11", "MAX", LAST, 0.0, 1e-6, "ABS")],
    "cae_coil": [("U1", "Coil-1.Bore", LAST, coil(1.0), 1e-3),
                 ("U1", "Coil-1.Rim", LAST, coil(2.0), 1e-3),
                 ("U2", "Coil-1.Rim", LAST, 5e10 * 0.1**2 / 2e11, 1e-3)],
    "abaqus_gap": [("heat_flux", "SL", LAST, FLUX, 1e-9),
                   ("slave_temperature", "SL", LAST, 900 - FLUX * 0.04 / 20, 1e-9)],
}


@pytest.mark.parametrize("name", CHECKS)
def test_a_deck_runs_unchanged(tmp_path, name):
    judge(tmp_path, (FOREIGN / f"{name}.inp").read_text().splitlines(), CHECKS[name])


def test_a_deck_without_analysis_is_read(tmp_path):
    process = run("run", FOREIGN / "abaqus_check.inp", "--out", tmp_path)
    assert process.returncode == 0
    assert "*NO ANALYSIS; it is read and found sound" in process.stderr


def test_there_are_thirty_of_them():
    """With those of the two other tests."""
    assert len(list(FOREIGN.glob("*.inp"))) >= 30
