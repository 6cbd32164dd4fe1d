"""Properties over temperature beside CalculiX, which reads the same cards.

CalculiX turns engineering constants into stiffnesses before it interpolates them, thercon afterwards,
so that orthotropic tables here are of stiffnesses. Its elements of plane stress have stresses across
the plane where temperatures differ; there the temperature is uniform. Its wedges of two degrees leave
cos(1 degree) in fields that follow the radius.
"""

import numpy as np
import pytest
from blocks import write
from calculix import DIGITS, assert_within, calculix, compared, differences, thercon
from physics import material, mesh, nodes_of

XS, YS = [1.0, 1.6, 2.5, 3.0], [0.0, 0.5, 1.1]
TABLES = {"elastic": [(1000.0, 0.3, 0.0), (700.0, 0.34, 150.0), (300.0, 0.2, 400.0)],
          "expansion": [(1e-5, 0.0), (1.6e-5, 150.0), (1.8e-5, 400.0)],
          "conductivity": [(2.0, 0.0), (1.2, 150.0), (1.7, 400.0)], "zero": 20.0}
CONSTANTS = [(1000.0, 400.0, 600.0, 0.3, 0.25, 0.2, 300.0, 250.0, 200.0, 0.0),
             (500.0, 450.0, 200.0, 0.2, 0.3, 0.28, 180.0, 250.0, 200.0, 400.0)]


def stiffness(e1, e2, e3, nu12, nu13, nu23, *others):
    """Return the constants of TYPE=ORTHO from engineering constants, and what follows these."""
    d = np.linalg.inv([[1 / e1, -nu12 / e1, -nu13 / e1], [-nu12 / e1, 1 / e2, -nu23 / e2],
                       [-nu13 / e1, -nu23 / e2, 1 / e3]])
    return d[0, 0], d[0, 1], d[1, 1], d[0, 2], d[1, 2], d[2, 2], *others


ORTHOTROPIC = {
    "elastic": [stiffness(*row) for row in CONSTANTS], "elastic_type": "ORTHO",
    "expansion": [(1e-5, 2e-5, 0.5e-5, 0.0), (1.4e-5, 2.2e-5, 1e-5, 400.0)],
    "expansion_type": "ORTHO", "zero": 20.0}
WEDGE = 3e-4
START = ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 50."]


def body(kind, **properties):
    """Return a body and where it starts."""
    return [*mesh("BODY", XS, YS, kind), *material("BODY", **properties), *START]


@pytest.mark.parametrize("kind", ["CPE8", "CPE8R", "CPS8", "CPE6", "CAX8"])
@pytest.mark.parametrize("properties", [TABLES, ORTHOTROPIC], ids=["isotropic", "orthotropic"])
def test_stresses_of_given_temperatures(tmp_path, kind, properties):
    """Linear ones, so that both take the same temperature at each integration point."""
    cards = body(kind, **properties)
    slopes = (0.0, 0.0) if kind == "CPS8" else (60.0, 110.0)
    given = [f"{n}, {90.0 + slopes[0] * x + slopes[1] * y!r}" for n, (x, y) in nodes_of(cards).items()]
    found = compared(
        tmp_path, cards, ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "BODY.BOTTOM, 2, 2",
                          "BODY.LEFT, 1, 1", "BODY.TOP, 2, 2, 1.E-3", "*TEMPERATURE", *given,
                          "*NODE PRINT, NSET=BODY", "U", "*EL PRINT, ELSET=BODY", "S", "*END STEP"],
        rings=kind.startswith("CAX"))
    assert_within(found, WEDGE if kind.startswith("CAX") else 3 * DIGITS)


@pytest.mark.parametrize(("kind", "most"), [("CPE8R", 3 * DIGITS), ("CPS8R", 3 * DIGITS),
                                            ("CPE6", 3 * DIGITS), ("CAX8R", WEDGE), ("CPE8", 1e-2)])
def test_temperatures_and_fluxes_of_a_steady_state(tmp_path, kind, most):
    """With full integration CalculiX takes conductivities at temperatures that are linear in an
    element."""
    deck = write(tmp_path / "deck.inp", body(kind, **TABLES), [
        "*STEP, INC=100", "*CONTROLS, PARAMETERS=FIELD, FIELD=TEMPERATURE",
        "1.E-9, 1.E-9, , , 1.E-9", "*HEAT TRANSFER, STEADY STATE, DIRECT", "0.25, 1.", "*BOUNDARY",
        "BODY.LEFT, 11, 11, 10.", "BODY.RIGHT, 11, 11, 380.", "*DFLUX", "BODY, BF, 100.",
        "*NODE PRINT, NSET=BODY", "NT", "*EL PRINT, ELSET=BODY", "HFL", "*END STEP"])
    theirs, ours = calculix(deck), thercon(deck)
    assert_within(differences(theirs, ours), most)
