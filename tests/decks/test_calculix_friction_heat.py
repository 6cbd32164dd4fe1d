"""Heat of friction by a given speed beside CalculiX: rubbing blocks, steady."""

import numpy as np
import pytest
from blocks import write
from calculix import DIGITS, assert_within, calculix, differences, thercon
from physics import material, mesh

PRESSURE, MU, ETA, SHARE, SPEED, CONDUCTANCE, K = 5.0, 0.3, 0.8, 0.3, 7.0, 4.0, 2.0


def rubbing_blocks(kind):
    """Return a block pressed on another, 80 above and 0 below; a stiff penalty for CalculiX."""
    xs = [0.0, 0.5, 1.0]
    bodies = [*mesh("UPPER", xs, xs, kind), *mesh("LOWER", xs, [-1.0, -0.5, 0.0], kind, first=101)]
    for name in ("UPPER", "LOWER"):
        bodies += material(name, (1e5, 0.0), 0.0, K)
    return [*bodies, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "UPPER, 0.", "LOWER, 0.",
            "*SURFACE INTERACTION, NAME=FACES",
            "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", "1e7, 0.", "*FRICTION", f"{MU}, 1e6",
            "*GAP CONDUCTANCE", f"{CONDUCTANCE}, 0.", f"{CONDUCTANCE}, 1000.",
            "*GAP HEAT GENERATION", f"{ETA}, {SHARE}, {SPEED}",
            "*CONTACT PAIR, INTERACTION=FACES, TYPE=SURFACE TO SURFACE",
            "UPPER.BOTTOM, LOWER.TOP",
            "*STEP, INC=100", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.",
            "*BOUNDARY", "LOWER.BOTTOM, 1, 2", "UPPER.LEFT, 1, 1", "LOWER.LEFT, 1, 1",
            "UPPER.TOP, 11, 11, 80.", "LOWER.BOTTOM, 11, 11, 0.",
            "*DLOAD", f"3, P3, {PRESSURE}", f"4, P3, {PRESSURE}",
            "*NODE PRINT, NSET=UPPER.BOTTOM", "NT", "*NODE PRINT, NSET=LOWER.TOP", "NT",
            "*END STEP"]


def faces_of(power):
    """Return the temperatures of slave and master with this heat of friction."""
    matrix = [[K + CONDUCTANCE, -CONDUCTANCE], [-CONDUCTANCE, K + CONDUCTANCE]]
    return np.linalg.solve(matrix, [K * 80.0 + SHARE * power, (1 - SHARE) * power])


@pytest.mark.parametrize(("kind", "part"), [("CPE4", 1.0), ("CPE8", 4 / 9)])
def test_heat_and_its_shares_are_those_of_calculix(tmp_path, kind, part):
    """On elements with midside nodes CalculiX 2.20 makes 4/9 of eta mu p v."""
    deck = write(tmp_path / "deck.inp", rubbing_blocks(kind))
    theirs, ours = calculix(deck), thercon(deck)
    power = ETA * MU * PRESSURE * SPEED
    for tables, made in ((theirs, part * power), (ours, power)):
        values = [value for (_, quantity), table in tables.items() if quantity == "NT"
                  for value in table.values()]
        assert sorted({round(value, 4) for value in values}) == pytest.approx(
            sorted(faces_of(made)), abs=2e-4)
    if part == 1.0:
        assert_within(differences(theirs, ours), 2 * DIGITS)
