"""Friction with a largest shear, and rough faces: closed forms, and the printed conditions."""

import re

import h5py
import numpy as np
import pytest
from blocks import write
from changes import note_changes
from deck_runs import INPUT, solve
from physics import material, mesh, nodes_of
from test_hysteresis import FRICTION, ONSET, PRESSURE, STIFFNESS, history, moves, sheared
from test_patch import read, shear_deck

from jenkin import path


def with_friction(deck, *cards):
    """Replace the *FRICTION cards of a deck."""
    text = deck.read_text()
    found = re.search(r"\*FRICTION\n.*\n", text)
    return write(deck, text[:found.start()].splitlines(), list(cards),
                 text[found.end():].splitlines())


@pytest.mark.changes("FRICTION, TAUMAX")
def test_largest_shear_bounds_the_jenkin_element(tmp_path):
    """Forward and reverse slip of two blocks: as with a coefficient whose cone ends there."""
    decks = []
    for limit in (0.5 * FRICTION * PRESSURE, 0.6 * FRICTION * PRESSURE):
        shears, slips = (np.array(values) for values in path(moves(), STIFFNESS, limit))
        deck = with_friction(sheared(tmp_path / f"jenkin{limit:.0f}.inp", moves(), shears),
                             f"*FRICTION, TAUMAX={limit!r}", f"{FRICTION!r}, 1.E5")
        decks.append(deck.read_text().splitlines())
        pressure, shear, slip = history(solve(deck), "pressure", "shear", "slip")
        np.testing.assert_allclose(pressure, PRESSURE, rtol=1e-9)
        np.testing.assert_allclose(shear[1:], -shears[:, None] * np.ones(shear.shape[1]),
                                   rtol=0, atol=1e-8 * limit)
        np.testing.assert_allclose(slip[1:], slips[:, None] * np.ones(slip.shape[1]), rtol=0,
                                   atol=1e-8 * ONSET)
    note_changes(*decks)


@pytest.mark.changes("FRICTION, ROUGH", "FRICTION")
def test_rough_faces_stick_under_any_shear(tmp_path):
    """Three times the pressure slips with a coefficient of 0.3, where the shear is that part of the
    pressure, and not on rough faces."""
    shear = 3.0 * PRESSURE
    plain = shear_deck(tmp_path / "plain.inp", shear, 0.0)
    rough = with_friction(shear_deck(tmp_path / "rough.inp", shear, 0.0), "*FRICTION, ROUGH")
    note_changes(plain.read_text().splitlines(), rough.read_text().splitlines())
    pressure, traction, slip, status = read(solve(rough), "pressure", "shear", "slip", "status")
    assert np.all(status == 2)
    np.testing.assert_allclose(pressure, PRESSURE, rtol=1e-9)
    np.testing.assert_allclose(traction, -shear, rtol=1e-9)
    np.testing.assert_allclose(slip, 0.0, atol=1e-15)
    assert "rough, no slip" in rough.with_suffix(".lst").read_text()
    pressure, traction, status = read(solve(plain), "pressure", "shear", "status")
    slipping = status == 1
    assert np.any(slipping)
    np.testing.assert_allclose(abs(traction[slipping]), FRICTION * pressure[slipping], rtol=1e-9)
    assert np.all(abs(traction) <= FRICTION * pressure * (1 + 1e-9))


@pytest.mark.parametrize(("kind", "pairing"), [
    ("CAX8", "NODES"), ("CAX4", "SURFACES"), ("CPE8", "NODES"), ("CPE8", "SURFACES")])
@pytest.mark.parametrize("friction", [
    ("*FRICTION, TAUMAX=0.05", "0.3"), ("*FRICTION, ROUGH",)])
def test_printed_shear_obeys_the_law(tmp_path, kind, pairing, friction):
    """A hot block on one that does not expand, the conductance depending on the pressure: in slip
    the shear is the smaller of mu p and TAUMAX, in stick no larger; rough faces have no slip."""
    xs = [0.0, 0.5, 1.0, 1.5, 2.0]
    low = mesh("LOW", xs, [0.0, 1.0], kind)
    up = mesh("UP", xs, [1.0, 2.0], kind, 101)
    axis = [n for body in (low, up) for n, p in nodes_of(body).items() if p[0] == 0.0]
    deck = write(
        tmp_path / "deck.inp", low, up, material("LOW", (1e4, 0.3), None, 1.0),
        material("UP", (1e3, 0.3), 1e-5, 1.0),
        ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LOW, 0.", "UP, 0.",
         "*SURFACE INTERACTION, NAME=I", *friction, "*GAP LAW, TYPE=GAS", "0.01, 0.01",
         "*GAP LAW, TYPE=POWER", "1., 1., 1.",
         f"*CONTACT PAIR, INTERACTION=I, NAME=P, PAIRING={pairing}", "UP.BOTTOM, LOW.TOP",
         "*BOUNDARY", "LOW.BOTTOM, 2", *(f"{n}, 1" for n in axis), "*STEP",
         "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.25, 1.", "*BOUNDARY",
         "LOW.BOTTOM, 11, 11, 0.", "UP.TOP, 11, 11, 200.", "*DSLOAD", "UP.TOP, P, 0.5",
         "*END STEP"])
    with h5py.File(solve(deck)) as file:
        found = {name: values[-1] for name, values in file["contact/P"].items()
                 if values.ndim == 2}
        weight, x = file["contact/P/weight"][:], file["contact/P/x"][:]
    closed, heavy = found["status"] > 0, (weight > 0.0) & (x > 0.0)   # x = 0 is held by supports
    if "ROUGH" in friction[0]:
        assert set(found["status"][closed]) == {2}
        np.testing.assert_allclose(found["slip"][closed & heavy], 0.0, atol=1e-12)
        return
    bound = np.minimum(0.3 * found["pressure"], 0.05)
    assert (np.abs(found["shear"]) <= bound + 1e-12).all()
    slips = (found["status"] == 1) & heavy
    np.testing.assert_allclose(np.abs(found["shear"][slips]), bound[slips], rtol=1e-9)
    assert (slips & (bound == 0.05)).any()


@pytest.mark.parametrize(("name", "count"), [("brake_pad", 4), ("thermal_cycling", 1)])
def test_shear_forces_that_cancel_sum_up_to_none(tmp_path, name, count):
    """As long as a strip is only pressed nothing pulls it along, whatever shear its nodes have."""
    source = INPUT / "examples" / f"{name}.inp"
    (tmp_path / f"{name}.mesh").symlink_to(source.with_suffix(".mesh"))
    deck = tmp_path / source.name
    deck.write_text(source.read_text().split("*VERIFY")[0])
    with h5py.File(solve(deck)) as file:
        (contact,) = file["contact"].values()
        shear, normal = contact["shear_force"][:], contact["normal_force"][:]
    assert np.all(normal > 0.0) and np.all(np.abs(shear[count:]) > 0.0)
    assert not shear[:count].any(), shear[:count]
