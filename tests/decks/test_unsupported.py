"""Bodies that touch others and are pressed by nothing: named, while light loads still press."""

from math import atan, cos

import numpy as np
import pytest
from blocks import block, solid, write
from deck_runs import INPUT, run
from test_held import FACES, FLOOR, MESH, SOLIDS, interaction, read, step

GAS_A, GAS_B = 0.24e-5, 0.3e-5
GAS = ["*GAP LAW, TYPE=GAS", f"{GAS_A}, {GAS_B}"]
FLOATS = "no load drives it: the smallest movement is used"
HOT = 300.0


def outcome(deck, *names, pair="FACE"):
    """Run a deck that is solved; return its messages and datasets of the last increment."""
    process = run("run", "--quiet", deck, "--out", deck.parent)
    assert process.returncode == 0, process.stderr
    return process.stderr, *read(deck.with_suffix(".vtkhdf"), pair, *names)


def bulging(path, laws, load=0.0, friction=0.3, length=1.0, force=1.0):
    """Heat a convex block over a block that nothing holds along y but the load on its sole."""
    young = 2e4 * force / length**2
    upper = ["*NODE, NSET=UP", *(f"{n}, {x * length!r}, {y * length!r}" for n, x, y in (
        (1, 0.0, 0.0), (2, 1.0, 0.1), (3, 1.0, 1.0), (4, 0.0, 1.0)))]
    lower = ["*NODE, NSET=LO", *(f"{n}, {x * length!r}, {y * length!r}" for n, x, y in (
        (11, 0.0, -1.0), (12, 1.0, -1.0), (13, 1.0, 0.0), (14, 0.0, 0.0)))]
    press = ["*DLOAD", f"2, P1, {load * force / length**2!r}"] if load else []
    return write(
        path, upper, lower,
        ["*ELEMENT, TYPE=CPE4, ELSET=UP", "1, 1, 2, 3, 4", "*ELEMENT, TYPE=CPE4, ELSET=LO",
         "2, 11, 12, 13, 14", "*SURFACE, NAME=A", "1, S1", "*SURFACE, NAME=B", "2, S3"],
        solid("UP", young, 0.3, 1.2e-5, 0.18), solid("LO", young, 0.3, 1.2e-5, 0.18),
        interaction(friction), laws, ["*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "A, B"],
        ["*BOUNDARY", "3, 2", "4, 2", "1, 1", "4, 1", "11, 1", "14, 1", "*STEP",
         "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.25, 1.", "*BOUNDARY",
         f"3, 11, 11, {HOT}", f"4, 11, 11, {HOT}", "11, 11", "12, 11", *press, "*END STEP"])


LAWS = [
    (["*GAP LAW, TYPE=POWER", "0.8, 0.24, 1."], GAS, 0.8, 0.8),
    (["*GAP LAW, TYPE=POWER", "0.8, 0.24, 0.1"], GAS, 0.8, 0.8),
    (["*GAP LAW, TYPE=POWER", "0.8, 0.24, 1."], [], 0.0, 0.8),
    (["*GAP LAW, TYPE=POWER", "0.1, 0.24, 0.1"], GAS, 0.1, 0.8),
]


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(("closed", "opened", "least", "most"), LAWS)
def test_a_body_that_only_rounding_holds_is_named(tmp_path, closed, opened, least, most, friction):
    """Its pair conducts without pressure: by the open law, between both where they differ."""
    deck = bulging(tmp_path / "floats.inp", closed + opened, friction=friction)
    text, pressure, shear, gap, omega, status = outcome(
        deck, "pressure", "shear", "gap", "conductance", "status")
    assert text.count(FLOATS) == 1
    assert "increment 1: " in text
    assert "body 2 (of LO, first node 11) is free to move along y; no load drives it" in text
    assert (pressure == 0.0).all()
    assert (shear == 0.0).all()
    assert gap[0] == pytest.approx(0.0, abs=1e-12)
    assert least * (1 - 1e-8) <= omega[0] <= most * (1 + 1e-8)
    assert status[0] == (least < most)


def test_the_cylinder_on_a_base_without_support_is_named(tmp_path):
    text = (INPUT / "cylinder" / "cylinder.inp").read_text()
    assert "BOTTOM, 2, 2, 0.\n" in text
    deck = tmp_path / "cylinder.inp"
    deck.write_text(text.replace("BOTTOM, 2, 2, 0.\n", "").split("*VERIFY")[0])
    messages, force, pressure = outcome(deck, "normal_force", "pressure")
    assert messages.count(FLOATS) == 1
    assert "body 2 (BASE of LOWER, first node 1001) is free to move along y" in messages
    assert force == 0.0
    assert pressure.min() == 0.0


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_body_that_is_pressed_no_longer_is_named(tmp_path, friction):
    floor = [*FLOOR, *([] if friction else ["UPPER.LEFT, 1"])]
    press = ["*DLOAD", "3, P3, 12.5", "4, P3, 12.5"]
    off = ["*DLOAD, OP=NEW"]
    deck = write(tmp_path / "off.inp", MESH, SOLIDS, interaction(friction), FACES,
                 step(floor, press, increment="0.5, 1."), step(off, increment="0.5, 1."))
    text, pressure = outcome(deck, "pressure")
    assert text.count(FLOATS) == 1
    assert "increment 4: " in text
    assert "body 1 (of UPPER, first node 1) is free to move along" in text
    np.testing.assert_array_equal(pressure, 0.0)


@pytest.mark.parametrize("units", [(1.0, 1.0), (1e3, 1e6), (0.0254, 4.448)])
@pytest.mark.parametrize("load", [1.0, 1e-4, 1e-8])
def test_a_light_load_beside_thermal_forces_presses(tmp_path, load, units):
    """The thermal forces are about 100. The normal of the pair that carries halves the slope of 0.1
    between the faces; the axis of symmetry takes the rest."""
    length, force = units
    share = cos(atan(0.1) / 2)
    deck = bulging(tmp_path / "light.inp", LAWS[0][0] + GAS, load, 0.0, length, force)
    text, normal = outcome(deck, "normal_force")
    assert FLOATS not in text
    assert share * normal == pytest.approx(load * force / length,
                                           rel=max(1e-9, 1e-13 * 100 / load))


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(("load", "gap"), [
    (1e-3, 0.0), (1e-3, 0.02), (1e-8, 0.0), (1e-8, 0.02), (1e-12, 0.0)])
def test_a_light_load_alone_presses(tmp_path, load, gap, friction):
    raised = [*block("UPPER", [0.0, 0.3, 1.0], [gap, gap + 0.4, gap + 0.5], 1),
              *block("LOWER", [0.0, 0.3, 1.0], [-1.0, -0.3, 0.0], 101)]
    floor = [*FLOOR, *([] if friction else ["UPPER.LEFT, 1"])]
    deck = write(tmp_path / "alone.inp", raised, solid("UPPER", 1e4, 0.0),
                 solid("LOWER", 1e4, 0.0), interaction(friction), FACES,
                 step(floor, ["*DLOAD", f"3, P3, {load!r}", f"4, P3, {load!r}"]))
    text, normal = outcome(deck, "normal_force")
    assert FLOATS not in text
    assert normal == pytest.approx(load, rel=1e-4)


def test_a_light_load_presses_beside_a_heavy_one(tmp_path):
    xs, heavy = [0.0, 0.3, 1.0], 100.0
    beside = [*block("LEAD", xs, [10.0, 10.4, 10.5], 201), *block("BED", xs, [9.0, 9.7, 10.0], 301),
              *solid("LEAD", 1e4, 0.3), *solid("BED", 2e3, 0.45)]
    pairs = [*FACES, "*CONTACT PAIR, INTERACTION=FACES, NAME=OTHER", "LEAD.BOTTOM, BED.TOP"]
    held = [*FLOOR, "BED.BOTTOM, 1, 2", "UPPER.LEFT, 1", "LEAD.LEFT, 1"]
    for load in 1e-6, 1e-9, 0.0:
        press = [f"{n}, P3, {p!r}" for n, p in ((3, load), (4, load), (203, heavy), (204, heavy))]
        deck = write(tmp_path / "beside.inp", MESH, beside, SOLIDS, interaction(0.0), pairs,
                     step(held, ["*DLOAD", *press]))
        text, normal = outcome(deck, "normal_force")
        assert (FLOATS in text) == (load == 0.0)
        assert normal == pytest.approx(load, rel=1e-3)
