"""ERRORS=FULL: every number of every increment has an uncertainty, with all that relates nodes, and
95 % of them hold the error: that to increments of a quarter and elements of an eighth."""

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from deck_runs import solve
from physics import material, mesh, nodes_of

PRESSED = -0.02
XS = np.linspace(0.0, 2.0, 9)
UPPER = [*mesh("U", XS, [0.0, 0.4, 1.0], "CPE4", to=lambda x, y: (x, y + 0.03 * x**2 * (1.0 - y))),
         *material("U", (100.0, 0.3), 1e-4, 1.0)]
TOP = [node for node, (_, y) in nodes_of(UPPER).items() if y == 1.0]


def further(name, ys, first, xs=XS, young=100.0):
    """Return the cards of another body."""
    return [*mesh(name, xs, ys, "CPE4", first=first), *material(name, (young, 0.3), None, 1.0),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"{name}, 0."]


LOWER = further("L", [-1.0, -0.4, 0.0], 101, young=50.0)
HELD = ["U.LEFT, 1", "L.BOTTOM, 2", "L.LEFT, 1", "L.BOTTOM, 11"]
DOWN = [f"U.TOP, 2, 2, {PRESSED}", "U.TOP, 11, 11, 50."]
RELATED = [DOWN[1], "9001, 1", "9001, 6", f"9001, 2, 2, {PRESSED}"]
WAYS = {   # what relates nodes -> cards, supports
    "nothing": (LOWER, [*HELD, *DOWN]),
    "equations": ([*LOWER, "*EQUATION", *(line for node in TOP[1:] for line in (
        "2", f"{node}, 2, 1., {TOP[0]}, 2, -1."))], [*HELD, DOWN[1], f"{TOP[0]}, 2, 2, {PRESSED}"]),
    "a coupling": ([*LOWER, "*NODE", "9001, 0., 2.", "*COUPLING, REF NODE=9001, SURFACE=U.TOP, "
                    "CONSTRAINT NAME=GRIP", "*KINEMATIC", "2, 2"], [*HELD, *RELATED]),
    "turned axes": ([*LOWER, "*TRANSFORM, NSET=U, TYPE=R", "0., 1., 0., -1., 0., 0."], [
        "U.LEFT, 2", *HELD[1:], DOWN[1], f"U.TOP, 1, 1, {PRESSED}"]),
    "a tie": ([*LOWER, *further("V", [1.0, 1.5], 201, [0.0, 0.7, 1.4, 2.0]), "*TIE, NAME=SEAM",
               "U.TOP, V.BOTTOM"], [*HELD, "V.LEFT, 1", f"V.TOP, 2, 2, {PRESSED}", "V.TOP, 11, 11, 50."]),
    "a rigid body": (["*NODE", "9001, 0., -1.", "*RIGID BODY, REF NODE=9001, ELSET=L",
                      *further("L", [-1.0, 0.0], 101)],
                     [HELD[0], *DOWN, "9001, 1, 2", "9001, 6", "L, 11"]),
    "a spring": ([*LOWER, "*NODE", "9001, 3., 0.5", "*ELEMENT, TYPE=SPRINGA, ELSET=SPRING",
                  f"901, 9001, {TOP[-1]}", "*SPRING, ELSET=SPRING", "", "20."],
                 [*HELD, *DOWN, "9001, 1, 2"]),
    "two interfaces": ([*LOWER, *further("M", [-2.0, -1.0], 201), "*CONTACT PAIR, INTERACTION=I, "
                        "NAME=BELOW", "L.BOTTOM, M.TOP"],
                       [*HELD[::2], *DOWN, "M.LEFT, 1", "M.BOTTOM, 2", "M.BOTTOM, 11"])}


def deck(path, way, size, cards):
    """Write a deck of a round body on another one, with increments of a size; return its path."""
    related, supports = WAYS[way]
    return write(path, without_unused_surfaces([
        *cards, *UPPER, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "U, 0.",
        "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.2", "*GAP LAW, TYPE=POWER", "0.5, 1., 1.",
        *related, "*CONTACT PAIR, INTERACTION=I, NAME=FACE", "U.BOTTOM, L.TOP"]), [
        "*STEP, INC=100", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", f"{size}, 1.",
        "*BOUNDARY", *supports, "*END STEP", "*VERIFY, KIND=FIGURE", *(
            f"{asked}, 0.5, 0., 1.E9, ABS" for asked in (
                "normal_force, FACE", "pressure, FACE@0.1", "slip, FACE", f"U1, {TOP[-1]}", "S22, U.LEFT",
                "MISES, MAX"))])


@pytest.mark.parametrize("way", WAYS)
def test_uncertainties_at_every_increment_hold_the_errors(tmp_path, way):
    found = solve(deck(tmp_path / "deck.inp", way, 0.25, ["*OPTIONS, ERRORS=FULL"]))
    # *REFINE gives equations no new nodes, uncertainties do.
    fine = solve(deck(tmp_path / "fine.inp", "nothing" if way == "equations" else way, 0.0625,
                      ["*OPTIONS, ERRORS=NO", "*REFINE, LEVELS=3"]))
    holds = []
    with h5py.File(found) as file, h5py.File(fine) as exact:
        known = file["uncertainty"]
        np.testing.assert_array_equal(known["time"][:], file["history/time"][:])
        groups = {name: f"contact/{name}" for name in file["contact"]} | {"increment": "history"}
        for name, where in groups.items():
            for quantity in set(known[name]) - {"no_estimate"}:
                rows = known[name][quantity][:]
                if quantity == "peak_pressure":
                    true = exact[f"{where}/pressure"][3::4].max(axis=1)
                elif quantity in exact[where]:
                    true = exact[f"{where}/{quantity}"][3::4]
                else:
                    assert np.isnan(rows).all(), quantity   # the deck does not have it
                    continue
                assert np.isfinite(rows).all() and (rows[:, 1] >= 0.0).all(), (name, quantity)
                holds += list(abs(rows[:, 0] - true) <= rows[:, 1] + 1e-9)
        for body in (name for name in known if name.startswith("body")):
            assert np.isfinite(known[body]["von_mises"][:]).all(), body
            assert np.isfinite(known[body]["temperature"][:]).all(), body
    assert len(holds) >= 4 * 8 and np.mean(holds) >= 0.95
    listing = found.with_suffix(".lst").read_text()
    without = listing.count("(no estimate:")
    assert listing.count("found: ") == 6 and listing.count(" +- ") >= 6
    # Stress is largest at the node of the spring, where it has no limit.
    assert without == listing.count(" (no estimate: at a corner)\n") == (way == "a spring")
