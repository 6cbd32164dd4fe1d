"""Plasticity and creep beside CalculiX: a flange, a bolt, a cycle, a fit; where rules differ.

Run as a program it prints the table of docs/compare.md.
"""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from blocks import write
from calculix import DIGITS, assert_within, calculix, differences, ring, thercon
from physics import material, mesh, nodes_of
from test_inelastic import YOUNG, law

WITHIN = 5e-3
CREEP = "*CREEP, LAW=NORTON", "3.125E-14, 5., 0."
TO_TIGHTEN = 0.03   # by how much the bolt is shortened; it then carries 180 to 190 MPa
SLOPE = 0.05 * YOUNG   # of kinematic hardening


def graded(*parts):
    """Return places from end to end of parts (first, last, divisions)."""
    return [parts[0][0], *(float(x) for a, b, n in parts for x in np.linspace(a, b, n + 1)[1:])]


def joined(one, other):
    """Return two meshes whose nodes at the same places move alike; on the axis only along it."""
    there = {place: n for n, place in nodes_of(one).items()}
    pairs = [(n, there[p], p[0]) for n, p in nodes_of(other).items() if p in there]
    return [*one, *other, "*EQUATION", *(
        line for n, m, x in pairs for d in ((1, 2) if x > 0.0 else (2,))
        for line in ("2", f"{n}, {d}, 1., {m}, {d}, -1."))]


def contact(slave, master, penalty=1e7):
    """Return the cards of a contact; only CalculiX takes the penalty."""
    return ["*SURFACE INTERACTION, NAME=FACES", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
            f"{penalty!r}", "*CONTACT PAIR, INTERACTION=FACES, TYPE=SURFACE TO SURFACE",
            f"{slave}, {master}"]


def step(analysis, times, *cards, bodies=("BODY",), sums=None, options=", NLGEOM=NO"):
    """Return a step that prints displacements and stresses of bodies, and the force on a set."""
    tables = [line for body in bodies for line in (
        f"*NODE PRINT, NSET={body}", "U", f"*EL PRINT, ELSET={body}", "S")]
    force = [f"*NODE PRINT, NSET={sums}, TOTALS=ONLY", "RF"] if sums else []
    return [f"*STEP, INC=100000{options}", analysis, times, *cards, *tables, *force, "*END STEP"]


def flange(divisions=1, penalty=1e7):
    """Return a flange and its pipe that bolts press on a base, and that are then pulled: the pipe
    yields where they meet, and the flange leaves the base at its bore."""
    n, steel = divisions, ("*PLASTIC", "250., 0.", "450., 0.05")
    xs = graded((50.0, 60.0, 2 * n), (60.0, 70.0, 2 * n), (70.0, 90.0, 4 * n), (90.0, 100.0, 2 * n))
    bolts = [f"{1001 + 10 * n * (4 * n - 1) + k}, P3, 200." for k in range(2 * n, 6 * n)]
    end = [f"{5001 + 2 * n * (8 * n - 1) + k}, P3, -220." for k in range(2 * n)]
    deck = [*joined(mesh("FLANGE", xs, graded((0.0, 20.0, 4 * n)), "CAX8R", first=1001),
                    mesh("PIPE", xs[:2 * n + 1], graded((20.0, 40.0, 4 * n), (40.0, 80.0, 4 * n)),
                         "CAX8R", first=5001)),
            *law(*steel, name="FLANGE"), *law(*steel, name="PIPE"),
            *mesh("BASE", xs, graded((-20.0, 0.0, 4 * n)), "CAX8R", first=9001),
            *material("BASE", (YOUNG, 0.3)), *contact("FLANGE.BOTTOM", "BASE.TOP", penalty),
            "*BOUNDARY", "BASE.BOTTOM, 2"]
    for loads in (bolts, [*bolts, *end]):
        deck += step("*STATIC, DIRECT", "0.5, 1.", "*DLOAD", *loads,
                     bodies=("FLANGE", "PIPE", "BASE"), sums="BASE.BOTTOM")
    return deck


def bolt(visco="*VISCO, DIRECT, CETOL=1.", times="0.01, 0.1", scheme="IMPLICIT"):
    """Return a bolt that a section in its shank tightens on a sleeve, and that creeps."""
    heights = graded((0.0, 20.0, 4))
    under = graded((6.0, 9.0, 2))
    hold = ["*BOUNDARY", "SHANK.BOTTOM, 2", f"999, 1, 1, {TO_TIGHTEN!r}"]
    return [f"*THERMAL SCHEME, TYPE={scheme}",
            *joined(mesh("SHANK", graded((0.0, 5.0, 2)), heights, "CAX8R", first=1001),
                    mesh("HEAD", [*graded((0.0, 5.0, 2)), *under], graded((20.0, 26.0, 2)), "CAX8R",
                         first=5001)),
            *law(*CREEP, name="SHANK"), *law(*CREEP, name="HEAD"),
            *mesh("SLEEVE", [*under, 13.0], heights, "CAX8R", first=9001),
            *material("SLEEVE", (YOUNG, 0.3)), "*SURFACE, NAME=UNDER", "5004, S1", "5005, S1",
            *contact("UNDER", "SLEEVE.TOP"), "*NODE", "999, 0., 50.",
            "*SURFACE, NAME=CUT", "1003, S1", "1004, S1",
            "*PRE-TENSION SECTION, SURFACE=CUT, NODE=999", "0., -1., 0.",
            "*BOUNDARY", "SLEEVE.BOTTOM, 2", "SHANK.LEFT, 1", "HEAD.LEFT, 1",
            *step("*STATIC, DIRECT", "1., 1.", *hold, bodies=["SHANK"], sums="SLEEVE.BOTTOM"),
            *step(visco, times, *hold, bodies=["SHANK"], sums="SLEEVE.BOTTOM")]


def cycle(strain=1e-3, kind="CPE8R", thickness="", hardening="KINEMATIC"):
    """Return a quarter of a strip with a waist that is pulled, let go and pushed; with NLGEOM where
    CalculiX needs it."""
    def waist(x, y):
        return x * (0.7 + 0.3 * min(y, 1.0) ** 2 * (3.0 - 2.0 * min(y, 1.0))), y

    limit = 0.5 * YOUNG * strain
    deck = [*mesh("BODY", graded((0.0, 1.0, 3)), graded((0.0, 1.0, 3), (1.0, 2.0, 2)), kind,
                  to=waist),
            *law(f"*PLASTIC, HARDENING={hardening}", f"{limit!r}, 0.",
                 f"{limit + SLOPE!r}, 1.", section=thickness),
            "*BOUNDARY", "BODY.LEFT, 1", "BODY.BOTTOM, 2"]
    for moves in (2 * strain, 0.0, -2 * strain):
        deck += step("*STATIC, DIRECT", "0.125, 1.", "*BOUNDARY", f"BODY.TOP, 2, 2, {moves!r}",
                     sums="BODY.BOTTOM",
                     options=", NLGEOM" if hardening == "KINEMATIC" else ", NLGEOM=NO")
    return deck


def fit(divisions=1, penalty=1e7):
    """Return a shaft that is heated in a hub, which yields at the bore, and cools half way."""
    deck = [*mesh("SHAFT", graded((0.0, 50.0, 2 * divisions)), [0.0, 5.0], "CAX8R"),
            *mesh("HUB", graded((50.0, 100.0, 8 * divisions)), [0.0, 5.0], "CAX8R", first=1001),
            *material("SHAFT", (YOUNG, 0.3), 1.2e-5),
            *law("*PLASTIC", "300., 0.", "700., 0.05", name="HUB", expansion=1.2e-5),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "SHAFT, 0.", "HUB, 0.",
            *contact("SHAFT.RIGHT", "HUB.LEFT", penalty),
            "*BOUNDARY", "SHAFT.LEFT, 1", "SHAFT.BOTTOM, 2", "HUB.BOTTOM, 2"]
    for hot in (200.0, 100.0):
        deck += step("*STATIC, DIRECT", "0.25, 1.", "*TEMPERATURE", f"SHAFT, {hot!r}",
                     bodies=("SHAFT", "HUB"))
    return deck


def tables(folder, deck, name="deck", rings=True):
    """Return the tables of CalculiX and of thercon."""
    path = write(folder / f"{name}.inp", deck)
    theirs = calculix(path)
    return ring(theirs) if rings else theirs, thercon(path)


def kept(tables):
    """Return the part of its force that a bolt keeps."""
    return tables[1.1, "RF2@SLEEVE.BOTTOM"][()] / tables[1.0, "RF2@SLEEVE.BOTTOM"][()]


@pytest.mark.parametrize("deck", [flange(), bolt(), fit()], ids=["flange", "bolt", "fit"])
def test_the_same_increments_by_the_same_rule(tmp_path, deck):
    assert_within(differences(*tables(tmp_path, deck)), WITHIN)


def test_increments_in_which_points_yield_and_unload_in_turn(tmp_path):
    """Both take Euler's rule; CalculiX's residuals are made as small as thercon's."""
    deck = [line for card in cycle(hardening="ISOTROPIC") for line in (
        ["*CONTROLS, PARAMETERS=FIELD", "1.E-9, 1.E-9"] if card.startswith("*STATIC") else [])
        + [card]]
    assert_within(differences(*tables(tmp_path, deck, rings=False)), DIGITS)


def test_a_kinematic_cycle_is_that_of_small_strains(tmp_path):
    """CalculiX has kinematic hardening at large strains only; what differs follows the strain."""
    found = [differences(*tables(tmp_path, cycle(strain), f"{strain}", rings=False))
             for strain in (1e-3, 1e-4)]
    assert_within(found[0], WITHIN)
    assert_within(found[1], WITHIN / 10)
    assert all(found[1][q] < 0.2 * found[0][q] for q in ("U1", "U2", "S22", "RF2@BODY.BOTTOM"))


def test_calculix_softens_where_kinematic_hardening_has_small_strains(tmp_path):
    """2.20 takes the back stress off: the second plastic increment falls by the slope it should
    rise by."""
    bar = [*mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS8R"),
           *law("*PLASTIC, HARDENING=KINEMATIC", "200., 0.", f"{200.0 + SLOPE!r}, 1."),
           "*BOUNDARY", "BODY.LEFT, 1", "BODY.BOTTOM, 2",
           *step("*STATIC, DIRECT", "0.25, 1.", "*BOUNDARY", "BODY.TOP, 2, 2, 0.004")]
    theirs, ours = tables(tmp_path, bar, rings=False)
    rise = SLOPE / (1.0 + SLOPE / YOUNG) * 0.001
    for time in (0.5, 0.75, 1.0):
        value = 200.0 + (time - 0.25) / 0.25 * rise
        assert ours[time, "S22"][1, 1] == pytest.approx(value, rel=1e-6)
    assert theirs[1.0, "S22"][1, 1] - theirs[0.75, "S22"][1, 1] == pytest.approx(
        -SLOPE / (1.0 - SLOPE / YOUNG) * 0.001, rel=0.02)


def test_what_differs_in_real_time_is_the_increments_of_calculix(tmp_path):
    """Its rule is of first order: with a quarter of CETOL, and half of the increments, half; by
    that much again it comes to what thercon has."""
    found = []
    for allowed in (8e-5, 2e-5):
        theirs, ours = tables(tmp_path, bolt(f"*VISCO, CETOL={allowed}", "1.E-4, 0.1", "L-STABLE"),
                              f"{allowed}")
        found.append(kept(theirs) / kept(ours) - 1.0)
    assert 0.0 < found[1] < 0.6 * found[0]
    assert abs(2 * found[1] - found[0]) < WITHIN


def test_calculix_makes_one_viscous_law_of_both_cards(tmp_path):
    """It creeps by the stress beyond the yield surface, so not at all on it; Abaqus and thercon add
    creep and plastic strains."""
    bar = [*mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CAX8R"),
           *law("*PLASTIC", "200., 0.", "300., 0.02", *CREEP), "*BOUNDARY", "BODY.LEFT, 1",
           "BODY.BOTTOM, 2", *step("*STATIC, DIRECT", "1., 1.", "*DLOAD", "1, P3, -250."),
           *step("*VISCO, DIRECT, CETOL=1.", "0.05, 0.1", "*DLOAD", "1, P3, -250.")]
    theirs, ours = [found[1.1, "U2"].values() for found in tables(tmp_path, bar)]
    yielded = 250.0 / YOUNG + 0.01
    assert max(theirs) == pytest.approx(yielded, rel=1e-4)
    assert max(ours) == pytest.approx(yielded + 3.125e-14 * 250.0**5 * 0.1, rel=1e-6)


def printed():
    """Print the values of both programs and their largest differences, for docs/compare.md."""
    (end,) = [n for n, place in nodes_of(flange()).items() if place == (50.0, 80.0)]
    (rim,) = [n for n, place in nodes_of(fit()).items() if place == (100.0, 0.0)]
    lift, grown = (2.0, "U2", (end,)), (2.0, "U1", (rim,))
    clamp, pushed = (1.1, "RF2@SLEEVE.BOTTOM", ()), (3.0, "RF2@BODY.BOTTOM", ())
    decks = {
        "flange": (flange(), lift),
        "flange, penalty times 10": (flange(1, 1e8), lift),
        "flange, elements of half the size": (flange(2), None),
        "bolt, increments of 0.01 by Euler": (bolt(), clamp),
        "bolt, increments of 0.01, thercon's scheme": (bolt(scheme="L-STABLE"), clamp),
        "bolt, CETOL=2E-5": (bolt("*VISCO, CETOL=2.E-5", "1.E-4, 0.1", "L-STABLE"), clamp),
        "bolt, CETOL=5E-6": (bolt("*VISCO, CETOL=5.E-6", "1.E-4, 0.1", "L-STABLE"), clamp),
        "cycle": (cycle(), pushed),
        "cycle, strains of a tenth": (cycle(1e-4), pushed),
        "cycle, plane stress 0.1 thick": (cycle(1e-4, "CPS8R", "\n0.1"), pushed),
        "fit": (fit(), grown),
        "fit, penalty times 10": (fit(1, 1e8), grown),
        "fit, elements of half the size": (fit(2), None)}
    with tempfile.TemporaryDirectory() as folder:
        for k, (name, (deck, key)) in enumerate(decks.items()):
            theirs, ours = tables(Path(folder), deck, f"{k}", rings=not name.startswith("cycle"))
            values = [found[key[:2]][key[2]] for found in (theirs, ours)] if key else []
            worst = differences({key: theirs[key] for key in theirs.keys() & ours.keys()}, ours)
            print(name, *values, *(f"{kind} {max(v for q, v in worst.items() if q[0] == kind):.2%}"
                                   for kind in "US"), sep="; ", flush=True)


if __name__ == "__main__":
    printed()
