"""Finite sliding beside CalculiX with NLGEOM and node-to-surface contact: a pad with friction, and an
elastic roller. With surface-to-surface contact its forces scatter by 3 % as the pad slides."""

from math import sqrt

import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from calculix import calculix, thercon
from physics import material, mesh

STEEL = 2e5, 0.3
PRINTS = ["*NODE PRINT, NSET=RAIL.BOTTOM, TOTALS=ONLY", "RF",
          "*NODE PRINT, NSET=FOLLOWED", "U"]


def deck(bodies, friction, depth, slide, followed, penalty):
    """Return a slider that is pressed down by a depth at its top and slid: one deck for both."""
    law = ["*SURFACE INTERACTION, NAME=FACES",
           "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", penalty]
    if friction:
        law += ["*FRICTION", f"{friction}, 1e7"]
    return without_unused_surfaces([
        *bodies, *material("RAIL", STEEL), *material("SLIDER", STEEL), "*NSET, NSET=FOLLOWED",
        *map(str, followed), *law,
        "*CONTACT PAIR, INTERACTION=FACES, TYPE=NODE TO SURFACE, SLIDING=FINITE, PAIRING=NODES",
        "SLIDER.BOTTOM, RAIL.TOP",
        "*BOUNDARY", "RAIL.BOTTOM, 1, 2", "*STEP, NLGEOM, INC=1000", "*STATIC", "0.25, 1.",
        "*BOUNDARY", "SLIDER.TOP, 1, 1, 0.", f"SLIDER.TOP, 2, 2, {-depth}", *PRINTS, "*END STEP",
        "*STEP, NLGEOM, INC=1000", "*STATIC", "0.1, 1.", "*BOUNDARY",
        f"SLIDER.TOP, 1, 1, {slide}", *PRINTS, "*END STEP"])


def pad():
    """Return a pad whose nodes do not match those of its rail, with friction."""
    rail = mesh("RAIL", np.linspace(0.0, 6.0, 31), [-2.0, -1.0, -0.5, -0.2, 0.0], "CPE4")
    slider = mesh("SLIDER", np.linspace(2.0, 3.5, 10), [0.0, 0.2, 0.5, 1.0], "CPE4", first=2001)
    return deck([*rail, *slider], 0.2, 1e-3, 0.9, [2001, 2005, 2010], "1e8")


def roller():
    """Return a round slider without friction."""
    side = 0.1

    def curved(x, y):
        low = 10.0 - sqrt(100.0 - x * x)
        return x, low + y * (10.0 - low) / 10.0

    def graded(even, end):
        places = list(np.arange(0.0, even + side / 2, side))
        step = side
        while places[-1] < end:
            step *= 1.4
            places.append(places[-1] + step)
        return [float(p) for p in places]

    def both(places):
        return [-p for p in places[:0:-1]] + places

    rail = mesh("RAIL", both(graded(1.2, 6.0)), [-y for y in graded(0.4, 6.0)[::-1]], "CPE4")
    slider = mesh("SLIDER", both([0.9 * x for x in graded(0.7, 5.0)]),
                  [10.0 * y / 9.0 for y in np.linspace(0.0, 1.0, 13)**2 * 9.0], "CPE4", first=20001,
                  to=curved)
    return deck([*rail, *slider], 0.0, 0.02, 0.5, [20001], "1e7")


DEPTH = {pad: 1e-3, roller: 0.02}   # by which they are pressed


@pytest.mark.parametrize("make", [pad, roller])
def test_forces_of_a_slide_are_those_of_calculix(tmp_path, make):
    path = write(tmp_path / "deck.inp", make())
    theirs, ours = calculix(path), thercon(path)
    for time in (1.0, 2.0):
        scale = 0.01 * theirs[time, "RF2@RAIL.BOTTOM"][()]
        for name in ("RF1@RAIL.BOTTOM", "RF2@RAIL.BOTTOM"):
            assert ours[time, name][()] == pytest.approx(theirs[time, name][()], abs=scale)
        for name in ("U1", "U2"):
            for node, value in theirs[time, name].items():
                assert ours[time, name][node] == pytest.approx(value, abs=1e-2 * DEPTH[make])
