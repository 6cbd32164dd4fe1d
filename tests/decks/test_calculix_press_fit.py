"""A heated pin in a ring beside CalculiX, with a conductance that follows the pressure."""

import sys

import h5py
import numpy as np
import pytest
from blocks import write
from calculix import assert_within, calculix, differences, ring, thercon
from deck_runs import DECKS
from physics import material, mesh

sys.path.insert(0, str(DECKS.parent / "reference"))
import lame  # noqa: E402

FACE, OUTER, SOURCE, START = 20.0, 60.0, 50.0, 20.0
STEEL, ALUMINIUM = (2.1e5, 0.3), (7e4, 0.33)
STEEL_EXPANSION, ALUMINIUM_EXPANSION, STEEL_CONDUCTIVITY, ALUMINIUM_CONDUCTIVITY = 1.2e-5, 2.3e-5, 45.0, 170.0
STRAIN = 5e-3   # CalculiX switches NLGEOM on; the largest strain of the pin is 0.2 %


def fit(first, last):
    """Return a pin in a ring; the conductance rises from `first` at no pressure to `last` at 500."""
    heights = [0.0, 4.0]
    return [*mesh("PIN", list(np.linspace(0.0, FACE, 4)), heights, "CAX8R"),
            *mesh("RING", list(np.linspace(FACE, OUTER, 9)), heights, "CAX8R", first=101),
            *material("PIN", STEEL, STEEL_EXPANSION, STEEL_CONDUCTIVITY),
            *material("RING", ALUMINIUM, ALUMINIUM_EXPANSION, ALUMINIUM_CONDUCTIVITY),
            "*NSET, NSET=ALL", "PIN, RING",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"ALL, {START}",
            "*SURFACE INTERACTION, NAME=FIT",
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", "1.E7",
            "*GAP CONDUCTANCE", f"{first}, 0.", f"{last}, 500.",
            "*CONTACT PAIR, INTERACTION=FIT, TYPE=SURFACE TO SURFACE", "PIN.RIGHT, RING.LEFT",
            "*STEP, INC=1000", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.1, 1.",
            "*BOUNDARY", "PIN.LEFT, 1", "ALL, 2", f"RING.RIGHT, 11, 11, {START}",
            "*DFLUX", f"PIN, BF, {SOURCE}", "*NODE PRINT, NSET=ALL", "NT, U", "*END STEP"]


def pressure_of_fit(first, last):
    """Return the pressure: Lame's, with the pin as much hotter as the heat needs at this pressure."""
    flux = SOURCE * FACE / 2
    rise = flux * FACE / ALUMINIUM_CONDUCTIVITY * np.log(OUTER / FACE)
    bore = lame.hot_tube(FACE, FACE, OUTER, rise, 0.0, *ALUMINIUM, ALUMINIUM_EXPANSION, "strain")[3]

    def excess(pressure):
        hotter = flux / (first + (last - first) * pressure / 500.0)
        mean = rise + hotter + SOURCE * FACE**2 / (8 * STEEL_CONDUCTIVITY)
        free = (1 + STEEL[1]) * STEEL_EXPANSION * mean * FACE
        return lame.press_fit(0.0, FACE, OUTER, STEEL, ALUMINIUM, free - bore, "strain") - pressure

    low, high = 0.0, 500.0
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if excess(middle) > 0.0 else (low, middle)
    return low


def both(deck):
    """Return the tables of both programs at the end: CalculiX lets increments grow."""
    return [{key: table for key, table in tables.items() if key[0] == 1.0}
            for tables in (ring(calculix(deck)), thercon(deck))]


def corrections(deck):
    """Return the last correction of temperature of each increment of CalculiX, in per cent of the
    largest change."""
    last = {}
    for line in (deck.parent / "ccx" / deck.name).with_suffix(".cvg").read_text().splitlines():
        fields = line.split()
        if fields and fields[0].isdigit():
            last[fields[1]] = float(fields[8])
    return list(last.values())


@pytest.mark.parametrize(("first", "last"), [(10.0, 20.0), (1.0, 101.0)])
def test_a_fit_has_the_pressure_of_lame(tmp_path, first, last):
    deck = write(tmp_path / "deck.inp", fit(first, last))
    thercon(deck)
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        (contact,) = file["contact"].values()
        assert contact["pressure"][-1] == pytest.approx(pressure_of_fit(first, last), rel=1e-4)


def test_a_conductance_that_hardly_follows_the_pressure_is_as_in_calculix(tmp_path):
    deck = write(tmp_path / "deck.inp", fit(10.0, 20.0))
    assert_within(differences(*both(deck)), STRAIN)
    assert max(corrections(deck)) < 1.0


def test_calculix_ends_increments_while_temperatures_change_by_all_of_their_rise(tmp_path):
    """2.20 looks at residuals only where they vanish, as those of heat do in each iteration."""
    deck = write(tmp_path / "deck.inp", fit(1.0, 101.0))
    assert differences(*both(deck))["U1"] > 0.05
    assert corrections(deck)[-1] == pytest.approx(100.0)
