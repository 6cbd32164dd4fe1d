"""Bodies with tables that have, or come to, one temperature: what is left to correct is rounding.

Every run must end, whatever the processor, its units and the origin of its temperatures, at the
temperature of the heat that the bodies were given.
"""

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import solve
from physics import material, mesh

import tables

START, WARM = 47.6, 110.3
ELASTIC = [(1000.0, 0.3, 20.0), (600.0, 0.34, 500.0)]
EXPANSION = [(1e-5, 20.0), (1.6e-5, 500.0)]
CONDUCTIVITY = [(3.0, 0.0), (5.0, 200.0)]
DENSITY = [(1.0, 0.0), (0.8, 400.0)]
SPECIFIC_HEAT = [(1.0, 0.0), (2.0, 200.0)]
CAPACITY = tables.product(DENSITY, SPECIFIC_HEAT, 400)
# Energy and length in other units, W and mW, m and mm; and the origin of temperatures.
UNITS = {"SI": (1.0, 1.0, 0.0), "mW": (1e3, 1.0, 0.0), "mm": (1.0, 1e3, 0.0),
         "kelvin": (1.0, 1.0, 273.15), "far": (1e-6, 1e-2, -1e4), "zero": (1.0, 1.0, -START)}
ANALYSES = {"heat": "*HEAT TRANSFER", "coupled": "*COUPLED TEMPERATURE-DISPLACEMENT",
            "dilatation": "*COUPLED TEMPERATURE-DISPLACEMENT, DILATATION=YES"}


class Deck:
    """Two blocks, tied, or joined by node pairs or mortar points under a pressure."""

    def __init__(self, unit="SI", kind="CPE4", joint="TIE", analysis="heat"):
        self.energy, self.length, self.origin = UNITS[unit]
        self.analysis, self.mechanics = ANALYSES[analysis], analysis != "heat"
        widths = (3, 4) if joint == "SURFACES" else (3, 3)
        self.cards = [f"*PHYSICAL CONSTANTS, ABSOLUTE ZERO={-273.15 + self.origin!r}"]
        for name, low, n, first in (("UP", 0.0, widths[0], 1), ("LOW", -1.0, widths[1], 5001)):
            self.cards += mesh(name, self.lengths(np.linspace(1.0, 3.0, n + 1)),
                               self.lengths([low, low + 0.4, low + 1.0]), kind, first=first,
                               skew=0.05 * self.length)
            self.cards += self.material(name, analysis == "dilatation")
        if joint == "TIE":
            self.cards += ["*TIE, NAME=C", "UP.BOTTOM, LOW.TOP"]
        else:
            conductance = 30.0 * self.energy / self.length**2
            self.cards += ["*SURFACE INTERACTION, NAME=C", "*GAP CONDUCTANCE",
                           f"{conductance!r}, 0.", f"{conductance!r}, {self.length!r}",
                           f"*CONTACT PAIR, INTERACTION=C, NAME=C, PAIRING={joint}",
                           "UP.BOTTOM, LOW.TOP"]
        self.cards += ["*BOUNDARY", "LOW.BOTTOM, 2", "LOW.LEFT, 1", "UP.LEFT, 1"]
        self.load = ["*DSLOAD", f"UP.TOP, P, {2.0 / self.length**2 * self.energy!r}"] \
            if self.mechanics and joint != "TIE" else []

    def lengths(self, values):
        """Return lengths in the unit of the deck."""
        return [float(value) * self.length for value in values]

    def material(self, name, is_simple):
        """Return a material; what strains take up is known for one row of elasticity alone."""
        def rows(table, factor):
            return [(row[0] * factor, *row[1:-1], row[-1] + self.origin) for row in table]

        energy, length = self.energy, self.length
        elastic, expansion = rows(ELASTIC, energy / length**3), rows(EXPANSION, 1.0)
        if is_simple:
            elastic, expansion = elastic[0][:-1], expansion[0][0]
        return material(name, elastic=elastic, expansion=expansion, zero=20.0 + self.origin,
                        conductivity=rows(CONDUCTIVITY, energy / length),
                        density=rows(DENSITY, 1.0 / length**3),
                        specific_heat=rows(SPECIFIC_HEAT, energy))

    def begin(self, up, low):
        """Give the initial temperatures."""
        self.cards += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"UP, {up + self.origin!r}",
                       f"LOW, {low + self.origin!r}"]

    def step(self, times, *cards, how=""):
        """Add a step."""
        self.cards += ["*STEP, INC=100000", self.analysis + how, times, *self.load, *cards,
                       "*END STEP"]

    def temperatures(self, folder):
        """Solve the deck; return the temperatures of all nodes at its end."""
        result = solve(write(folder / "deck.inp", ["*OPTIONS, ERRORS=NO"], self.cards))
        with h5py.File(result) as file:
            nodes = int(file["VTKHDF/NumberOfPoints"][0])
            assert file["history/heat_imbalance"][()].max() < 1e-6
            return file["VTKHDF/PointData/temperature"][-nodes:] - self.origin


CASES = [pytest.param(unit, kind, joint, analysis, how, id=f"{unit}-{kind}-{joint}-{analysis}{how}")
         for unit, kind, joint, analysis, how in (
    ("SI", "CPE4", "TIE", "heat", ""), ("SI", "CAX8", "TIE", "coupled", ", DIRECT"),
    ("SI", "CPE4", "TIE", "dilatation", ""), ("mW", "CPS8", "SURFACES", "coupled", ""),
    ("mm", "CPE8", "NODES", "coupled", ", DIRECT"), ("kelvin", "CAX4", "TIE", "dilatation", ", DIRECT"),
    ("kelvin", "CPE3", "SURFACES", "heat", ", DIRECT"), ("far", "CPE6", "TIE", "coupled", ""),
    ("zero", "CPE4", "TIE", "heat", ", DIRECT"), ("zero", "CPE8", "SURFACES", "coupled", ""))]


@pytest.mark.parametrize(("unit", "kind", "joint", "analysis", "how"), CASES)
def test_a_pair_in_equilibrium_stays_as_it_is(tmp_path, unit, kind, joint, analysis, how):
    deck = Deck(unit, kind, joint, analysis)
    deck.begin(START, START)
    for times in ("0.2, 4.", "20., 4E3"):
        deck.step(times, how=how)
    assert_even(deck, deck.temperatures(tmp_path), START)


@pytest.mark.parametrize(("unit", "kind", "joint", "analysis", "how"), CASES)
def test_a_pair_comes_to_the_temperature_of_its_heat(tmp_path, unit, kind, joint, analysis, how):
    """Insulated, from two temperatures; then held, moved far along the axis where that is solved."""
    deck = Deck(unit, kind, joint, analysis)
    deck.begin(WARM, START)
    move = ["*BOUNDARY", f"LOW.BOTTOM, 2, 2, {1e5 * deck.length!r}"] if deck.mechanics else []
    for times, cards in (("0.5, 100.", []), ("100., 1E4", move)):
        deck.step(times, *cards, how=how)
    content = (tables.integral(CAPACITY, WARM) + tables.integral(CAPACITY, START)) / 2
    assert_even(deck, deck.temperatures(tmp_path), tables.of_integral(CAPACITY, content),
                0.05 if analysis == "dilatation" else 1e-5)


@pytest.mark.parametrize(("unit", "kind", "joint", "analysis", "how"), CASES)
def test_a_film_warms_a_pair_before_it_is_shut_down(tmp_path, unit, kind, joint, analysis, how):
    """Both faces come to the temperature of the film, which then ends."""
    deck = Deck(unit, kind, joint, analysis)
    deck.begin(START, START)
    film = 2.5 * deck.energy / deck.length**2
    deck.step("1., 200.", "*SFILM", *(f"{side}, F, {WARM + deck.origin!r}, {film!r}"
                                      for side in ("UP.TOP", "LOW.BOTTOM")), how=how)
    deck.step("1., 50.", "*SFILM, OP=NEW", how=how)
    assert_even(deck, deck.temperatures(tmp_path), WARM)


@pytest.mark.parametrize(("unit", "kind", "joint", "analysis", "how"), CASES)
def test_nothing_changes_before_a_load(tmp_path, unit, kind, joint, analysis, how):
    deck = Deck(unit, kind, joint, analysis)
    deck.begin(START, START)
    deck.cards += ["*AMPLITUDE, NAME=LATE", "0., 0., 5., 0., 10., 1."]
    deck.step("0.5, 5.", "*DSFLUX, AMPLITUDE=LATE", f"UP.TOP, S, {deck.energy!r}", how=how)
    assert_even(deck, deck.temperatures(tmp_path), START)


def assert_even(deck, found, expected, part=1e-9):
    """Assert that all temperatures are one, to a part of the range of the test."""
    tolerance = part * WARM + 1e-11 * abs(deck.origin)
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance)
