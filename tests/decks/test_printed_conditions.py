"""What is printed of every pair obeys the conditions of contact, also where pairs have no weight:
on the axis and at the tip of quarter points."""

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import solve
from physics import material, mesh, nodes_of

import rods

OPEN, CLOSED = (0.01, 0.01), (3.0, 1.0, 1.0)   # A/(B + gap); C0 + C1 p^n


def law(gap, pressure, closed):
    """Return the conductances."""
    return np.where(closed, CLOSED[0] + CLOSED[1] * pressure ** CLOSED[2],
                    OPEN[0] / (OPEN[1] + gap))


def plain(x, y):
    """Leave the nodes where they are."""
    return x, y


def quarter(x, y):
    """Place the midside node of the first side at its quarter point, and those above with it."""
    return (0.125 if abs(x - 0.25) < 1e-9 else x), y


@pytest.mark.parametrize(("kind", "to"), [
    ("CAX8", plain), ("CAX4", plain), ("CPE8", quarter), ("CPE8", plain)])
@pytest.mark.parametrize("open_end", [True, False])
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_printed_values_obey_the_conditions(tmp_path, kind, to, open_end, friction):
    xs = [0.0, 0.5, 1.0]

    def up(x, y):
        x, y = to(x, y)
        return x, y + (0.001 if open_end and x == 0.0 and y == 1.0 else 0.0)

    # The corner of the upper body, raised, keeps its pair open.
    bodies = {"LOW": mesh("LOW", xs, [0.0, 1.0], kind, to=to),
              "UP": mesh("UP", xs, [1.0, 2.0], kind, 101, to=up)}
    cards = []
    for name, body in bodies.items():
        cards += [*body, *material(name, (1e4, 0.3), None, 1.0),
                  *(f"*NSET, NSET=AXIS\n{n}" for n, p in nodes_of(body).items() if p[0] == 0.0)]
    path = solve(write(
        tmp_path / "deck.inp", ["*OPTIONS, WIDTH=120"], cards,
        ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LOW, 0.", "UP, 0.",
         "*SURFACE INTERACTION, NAME=I", *(["*FRICTION", f"{friction!r}"] if friction else []),
         "*GAP LAW, TYPE=GAS", f"{OPEN[0]!r}, {OPEN[1]!r}",
         "*GAP LAW, TYPE=POWER", ", ".join(map(repr, CLOSED)),
         "*CONTACT PAIR, INTERACTION=I, NAME=P", "UP.BOTTOM, LOW.TOP",
         "*BOUNDARY", "LOW.BOTTOM, 2", "AXIS, 1", "*STEP",
         "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
         "LOW.BOTTOM, 11, 11, 0.", "UP.TOP, 11, 11, 100.", "*DSLOAD", "UP.TOP, P, 1.",
         "*END STEP"]))
    with h5py.File(path) as file:
        found = {name: values[-1] for name, values in file["contact/P"].items()
                 if values.ndim == 2}
    closed = found["status"] > 0
    assert not closed[0] if open_end else closed.all()
    assert (found["pressure"] >= 0.0).all()
    assert (found["gap"] >= 0.0).all()
    assert not (found["pressure"] * found["gap"]).any()
    assert not found["pressure"][~closed].any()
    assert not found["shear"][~closed].any()
    assert (np.abs(found["shear"]) <= friction * found["pressure"] + 1e-12).all()
    np.testing.assert_allclose(
        found["conductance"], law(found["gap"], found["pressure"], closed), rtol=1e-7)
    np.testing.assert_allclose(
        found["heat_flux"], found["conductance"]
        * (found["slave_temperature"] - found["master_temperature"]), rtol=1e-9)


def pushed_rods(folder, middle, first):
    """Solve two rods between walls, one of which expands and is pushed along the face; return the
    result. Midside nodes of the face are at `middle` of 2, increments are `first` of 500."""
    def to(x, y):
        return (middle if x == 1.0 and abs(y) < 0.1 else x), y

    cards = [*mesh("HOT", [0.0, 2.0], [0.03, 10.03], to=to),
             *mesh("COLD", [0.0, 2.0], [-10.0, 0.0], first=101, to=to)]
    for name, alpha in (("HOT", 1.2e-5), ("COLD", 0.0)):
        cards += material(name, (2e5, 0.0), alpha, 0.2)
    return solve(write(
        folder / "rods.inp", cards,
        ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HOT, 0.", "COLD, 0.",
         "*SURFACE INTERACTION, NAME=ENDS", "*GAP LAW, TYPE=GAS", "0.1E-3, 1.E-3",
         "*GAP LAW, TYPE=POWER", "15., 0.01, 1.", "*CONTACT PAIR, INTERACTION=ENDS, NAME=GAP",
         "HOT.BOTTOM, COLD.TOP", "*FIXED POINT, TOL=1.E-12", "*STEP",
         "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", f"{first}, 500.", "*BOUNDARY",
         "HOT, 1, 1, 0.25", "COLD, 1", "HOT.TOP, 2", "COLD.BOTTOM, 2",
         "HOT.TOP, 11, 11, 500.", "COLD.BOTTOM, 11, 11, 0.", "*END STEP"]))


def test_a_pair_at_the_tip_of_quarter_points_is_pressed_as_those_beside_it(tmp_path):
    """One pressure and one flux on the whole face, as in tests/reference/rods.py, also at the pair
    whose force is nothing but rounding."""
    one = rods.Rods(length=(10.0, 10.0), conductivity=(0.2, 0.2), expansion=(1.2e-5, 0.0),
                    young=(2e5, 2e5), temperature=(500.0, 0.0), gap=0.03)
    state = rods.solve(one, rods.gas(0.1e-3, 1e-3), rods.power(15.0, 0.01, 1.0))
    with h5py.File(pushed_rods(tmp_path, 0.5, 20.0)) as file:
        pairs = file["contact/GAP"]
        np.testing.assert_allclose(pairs["pressure"][-1], state.pressure, rtol=1e-8)
        np.testing.assert_allclose(pairs["conductance"][-1], state.conductance, rtol=1e-8)
        np.testing.assert_allclose(pairs["heat_flux"][-1], state.flux, rtol=1e-8)
        assert (pairs["pressure"][:] >= 0.0).all()
        assert (pairs["gap"][:] >= 0.0).all()
        assert set(pairs["status"][-1]) == {1.0}


def test_a_pair_that_comes_to_rest_closes_at_the_end_of_the_increment(tmp_path):
    """The gap closes at 323.5 with the open law and stays open to 333.2 with the closed one: at 330
    the pairs rest. They carry no force, so that they touch at the end and have not slipped."""
    with h5py.File(pushed_rods(tmp_path, 1.0, 10.0)) as file:
        pairs = {name: file[f"contact/GAP/{name}"][31:35]
                 for name in ("status", "pressure", "conductance", "slip")}
    assert pairs["status"].tolist() == [[0] * 3] + [[1] * 3] * 3
    assert not pairs["pressure"][1].any()
    assert ((pairs["conductance"][1] > 0.1) & (pairs["conductance"][1] < 15.0)).all()
    np.testing.assert_allclose(
        pairs["slip"], np.outer([0.0, 0.0, 0.005, 0.01], np.ones(3)), atol=1e-15)
