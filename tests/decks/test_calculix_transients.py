"""Decks that CalculiX and thercon read as they are: steps in which bodies store heat.

CalculiX takes backward differences in time, thercon's TYPE=IMPLICIT, and passes the card of the
scheme over. Its reactions RFL are those of conduction alone, thercon's also of what is stored, so
that they are left out. Its mechanics have inertia: densities are small and specific heats large.
"""

import numpy as np
import pytest
from blocks import write
from calculix import DIGITS, assert_within, calculix, compared, differences, thercon
from physics import material, mesh

IMPLICIT = "*THERMAL SCHEME, TYPE=IMPLICIT"
XS, YS = [1.0, 1.6, 2.5], [0.0, 0.5, 1.1]
LIGHT, CAPACITY = 1e-9, 1.0   # density; heat capacity of a volume


def solid(name, young, poisson=0.3, expansion=1e-6, conductivity=2.0):
    """Return a material that stores heat and hardly any momentum."""
    return material(name, (young, poisson), expansion, conductivity, LIGHT, CAPACITY / LIGHT)


# Bodies alone

def finer(points, divisions):
    """Return points with each interval divided."""
    places = np.arange((len(points) - 1) * divisions + 1) / divisions
    return [float(x) for x in np.interp(places, range(len(points)), points)]


def warmed(kind, divisions=1, *loads):
    """Return a body that is heated at once along its bottom and cooled in a second step."""
    step = ["*STEP, INC=100", "*HEAT TRANSFER, DIRECT", "0.1, 0.4"]
    prints = ["*NODE PRINT, NSET=BODY.TOP", "NT", "*NODE PRINT, NSET=BODY.RIGHT", "NT"]
    return [IMPLICIT, *mesh("BODY", finer(XS, divisions), finer(YS, divisions), kind, skew=0.07
                            / divisions), *solid("BODY", 1000.0),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20.", "*AMPLITUDE, NAME=COURSE",
            "0., 0., 0.2, 1., 0.4, 0.5", *step, "*BOUNDARY", "BODY.BOTTOM, 11, 11, 100.",
            "*DFLUX, AMPLITUDE=COURSE", "BODY, BF, 60.", *loads, *prints, "*END STEP", *step,
            "*BOUNDARY", "BODY.BOTTOM, 11, 11, 0.", *prints, "*END STEP"]


@pytest.mark.parametrize("kind", ["CPE8", "CAX8", "CPS8"])
def test_courses_digit_for_digit(tmp_path, kind):
    assert_within(compared(tmp_path, warmed(kind, 1, "*FILM", "BODY, F3, 0., 1.")), DIGITS)


@pytest.mark.parametrize(("kind", "most"), [("CPE6", 0.03), ("CPE4", 0.1)])
def test_courses_of_other_elements_meet_with_finer_meshes(tmp_path, kind, most):
    """The difference is one of discretisations: CalculiX lumps no capacities, and takes the points
    of the stiffness for those of CPE8R and CPE6, thercon enough for the integrals."""
    found = [compared(tmp_path, warmed(kind, n), name=f"deck{n}")["NT"] for n in (1, 4)]
    assert found[1] < found[0] / 4
    assert found[0] < most


# Bodies in contact

# Small strains, since CalculiX takes heat through faces as they are deformed.
YOUNG, PRESS, PENALTY = 1e5, 4e-5, 1e9


def faces(law, slave="BODY.BOTTOM", master="BASE.TOP"):
    """Return the cards of the contact."""
    return ["*SURFACE INTERACTION, NAME=FACES", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
            f"{PENALTY!r}", "*GAP CONDUCTANCE", *law,
            "*CONTACT PAIR, INTERACTION=FACES, TYPE=SURFACE TO SURFACE", f"{slave}, {master}",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.", "BASE, 0."]


def heated(analysis, *cards):
    """Return a step of twenty increments; CalculiX wants energies in the first step of dynamics."""
    return ["*STEP, INC=1000", f"*{analysis} TEMPERATURE-DISPLACEMENT, DIRECT", "0.05, 1.", *cards,
            "*EL FILE", "ENER", "*NODE PRINT, NSET=BODY", "NT, U", "*NODE PRINT, NSET=BASE",
            "NT, U", "*EL PRINT, ELSET=BODY", "HFL", "*END STEP"]


def pressed(law, analysis="COUPLED", crown=0.0, columns=2):
    """Return a block, its lower side a parabola, that is pressed on another one and then heated."""
    xs, ys = [list(np.linspace(0.0, 1.0, n + 1)) for n in (columns, columns // 2)]
    return [*mesh("BODY", xs, ys, to=lambda x, y: (x, y + (1 - y) * crown * x**2)),
            *solid("BODY", YOUNG), *mesh("BASE", xs, [y - 1.0 for y in ys], first=1001),
            *solid("BASE", 3 * YOUNG, 0.2, 0.5e-6), *faces(law),
            "*BOUNDARY", "BASE.BOTTOM, 2, 2", "BODY.LEFT, 1", "BASE.LEFT, 1",
            "*STEP, INC=1000", "*STATIC", "0.25, 1.", "*BOUNDARY", f"BODY.TOP, 2, 2, {-PRESS!r}",
            "*EL FILE", "ENER", "*END STEP", *heated(
                analysis, "*BOUNDARY", f"BODY.TOP, 2, 2, {-PRESS!r}", "BODY.TOP, 11, 11, 50.",
                "BASE.BOTTOM, 11, 11, 0.")]


def rings(law):
    """Return a ring in another one, which it presses when heat comes through its bore."""
    ys = [0.0, 0.25, 0.5]
    return [*mesh("BODY", [1.0, 1.25, 1.5, 2.0], ys, "CAX8"), *solid("BODY", YOUNG),
            *mesh("BASE", [2.0, 2.5, 3.0], ys, "CAX8", first=1001),
            *solid("BASE", 3 * YOUNG, 0.2, 0.0), *faces(law, "BODY.RIGHT", "BASE.LEFT"),
            "*BOUNDARY", "BODY, 2", "BASE, 2",
            *heated("COUPLED", "*BOUNDARY", "BODY.LEFT, 11, 11, 50.", "BASE.RIGHT, 11, 11, 0.")]


def compared_at_all_times(folder, *cards):
    """Run both programs; return the differences at all times and at the end."""
    deck = write(folder / "deck.inp", *cards)
    theirs, ours = calculix(deck), thercon(deck)
    end = max(time for time, _ in theirs)
    return differences(theirs, ours), differences(
        {key: table for key, table in theirs.items() if key[0] == end}, ours)


def test_heat_then_mechanics_with_a_constant_conductance(tmp_path):
    """What is left of heat is the penalty of the conductance."""
    found, at_end = compared_at_all_times(tmp_path, pressed(("5., 0.", "5., 10."), "UNCOUPLED"))
    assert_within({"NT": found["NT"]}, 1e-4)
    assert_within({q: at_end[q] for q in ("U1", "U2")}, 1e-3)


# CalculiX ends its iterations with residuals of 0.5 %, and takes one temperature of an element for
# strains, which shows in displacements as long as temperatures bend. The penalty and strains of
# 1e-4 have the rest.
BENT, ENDED = 0.06, 5e-3


@pytest.mark.parametrize("deck", [
    pressed(("1., 0.", "11., 10.")), pressed(("0., 0.", "20., 20."), crown=4e-5, columns=4),
    rings(("0.1, 0.", "20.1, 20."))], ids=["blocks", "a crown", "rings"])
def test_a_conductance_that_follows_the_pressure(tmp_path, deck):
    found, at_end = compared_at_all_times(tmp_path, [IMPLICIT, *deck])
    assert_within(found, ENDED, but={"NT": 2e-3, "U1": BENT, "U2": BENT})
    assert_within(at_end, ENDED, but={"NT": 5e-4, "U1": 1e-3, "U2": 1e-3})
