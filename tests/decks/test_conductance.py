"""Every conductance law on two rods, open and closed, against tests/reference/rods.py."""

import sys
from dataclasses import replace

import h5py
import pytest
from blocks import block, solid, write
from deck_runs import DECKS, solve

sys.path.insert(0, str(DECKS.parent / "reference"))
import rods as reference  # noqa: E402

RODS = reference.Rods(
    length=(0.1, 0.06), conductivity=(20.0, 30.0), expansion=(12e-6, 5e-6),
    young=(2e11, 1e11), temperature=(500.0, 40.0), gap=6.4e-4)  # fmt: skip
OPEN, FAR, VERY_FAR, CLOSED = 6.4e-4, 9e-4, 1.4e-3, 0.0

GAS = {"A": 0.05, "B": 5e-4}
POWER = {"C0": 100.0, "C1": 3.6e-6, "N": 0.95}
CLEARANCE = {"W1": 100.0, "X1": 0.0, "W2": 60.0, "X2": 1.2e-4, "W3": 20.0, "X3": 6e-4}
PRESSURE = {"V1": 100.0, "Y1": 0.0, "V2": 250.0, "Y2": 3e8, "V3": 400.0, "Y3": 6e8}
GAS_CARDS = ["*GAP LAW, TYPE=GAS", "<A>, <B>"]
POWER_CARDS = ["*GAP LAW, TYPE=POWER", "<C0>, <C1>, <N>"]
CLEARANCE_CARDS = ["*GAP LAW, TYPE=CLEARANCE", "<W1>, <X1>", "<W2>, <X2>", "<W3>, <X3>"]
PRESSURE_CARDS = ["*GAP CONDUCTANCE", "<V1>, <Y1>, 20.", "<V2>, <Y2>, 20.", "<V3>, <Y3>, 20."]

# Constants, cards of the deck, open and closed law of the reference.
LAWS = {
    "gas": (GAS, GAS_CARDS, lambda c: reference.gas(*c.values()), None),
    "power": (POWER, POWER_CARDS, None, lambda c: reference.power(*c.values())),
    "clearance": (CLEARANCE, CLEARANCE_CARDS, lambda c: rows_of(c), None),
    "pressure": (PRESSURE, PRESSURE_CARDS, None, lambda c: rows_of(c)),
}


def rows_of(constants):
    """Return the law of a table of three rows."""
    values = list(constants.values())
    return reference.table(*zip(values[::2], values[1::2], strict=True))


def expected(name, constants, gap):
    """Return the closed form with one law of LAWS."""
    _, _, open_law, closed_law = LAWS[name]
    return reference.solve(
        replace(RODS, gap=gap), open_law and open_law(constants),
        closed_law and closed_law(constants))  # fmt: skip


def checks(state):
    """Return the *VERIFY cards of a state of the rods."""
    cards = ['*VERIFY, KIND=ANALYTIC, SOURCE="tests/reference/rods.py"']
    values = {"gap": state.gap, "pressure": state.pressure, "conductance": state.conductance,
              "heat_flux": state.flux, "slave_temperature": state.face_temperature[0],
              "master_temperature": state.face_temperature[1]}  # fmt: skip
    for quantity, value in values.items():
        tolerance = "1.E-8, REL" if value else "1.E-12, ABS"
        cards += [f"{quantity}, {at}, LAST, {value!r}, {tolerance}" for at in ("MIN", "MAX")]
    return cards


def write_rods(path, constants, law_cards, gap, state):
    """Write the deck of two rods with a law, and checks of the state; return its path."""
    (l1, l2), xs = RODS.length, [0.0, 0.02, 0.05]
    return write(
        path,
        block("HOT", xs, [gap, gap + 0.4 * l1, gap + l1], 1),
        block("COLD", xs, [-l2, -0.4 * l2, 0.0], 101),
        solid("HOT", RODS.young[0], 0.0, RODS.expansion[0], RODS.conductivity[0]),
        solid("COLD", RODS.young[1], 0.0, RODS.expansion[1], RODS.conductivity[1]),
        ["*PARAMETER", *(f"{name} = {value!r}" for name, value in constants.items())],
        ["*SURFACE INTERACTION, NAME=FACES", *law_cards],
        f"""
        *CONTACT PAIR, INTERACTION=FACES, NAME=FACE
        HOT.BOTTOM, COLD.TOP
        *FIXED POINT, TOL=1.E-12
        *INITIAL CONDITIONS, TYPE=TEMPERATURE
        HOT, 0.
        COLD, 0.
        *STEP
        *COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE
        0.05, 1.
        *BOUNDARY
        HOT.TOP, 2, 2, 0.
        COLD.BOTTOM, 2, 2, 0.
        HOT, 1, 1, 0.
        COLD, 1, 1, 0.
        HOT.TOP, 11, 11, {RODS.temperature[0]}
        COLD.BOTTOM, 11, 11, {RODS.temperature[1]}
        *END STEP
        """,
        checks(state),
    )


def last_flux(result):
    """Return the heat flux of the first pair at the last increment."""
    with h5py.File(result) as file:
        return file["contact/FACE/heat_flux"][-1][0]


CASES = [("gas", OPEN), ("gas", CLOSED), ("power", CLOSED), ("power", VERY_FAR),
         ("clearance", OPEN), ("clearance", FAR), ("clearance", VERY_FAR), ("clearance", CLOSED),
         ("pressure", CLOSED), ("pressure", VERY_FAR)]  # fmt: skip


@pytest.mark.parametrize(("name", "gap"), CASES)
def test_rods_have_the_closed_form(tmp_path, name, gap):
    constants, cards = LAWS[name][:2]
    state = expected(name, constants, gap)
    assert (state.gap > 0.0) == (gap != CLOSED)
    solve(write_rods(tmp_path / "rods.inp", constants, cards, gap, state))


@pytest.mark.parametrize("gap", [OPEN, CLOSED])
def test_an_open_and_a_closed_table_stand_in_one_interaction(tmp_path, gap):
    state = reference.solve(replace(RODS, gap=gap), rows_of(CLEARANCE), rows_of(PRESSURE))
    cards = [*PRESSURE_CARDS, *CLEARANCE_CARDS]
    solve(write_rods(tmp_path / "rods.inp", CLEARANCE | PRESSURE, cards, gap, state))


@pytest.mark.parametrize("gap", [OPEN, CLOSED])
def test_a_gap_conductance_beside_a_power_law_changes_nothing(tmp_path, gap):
    gas, power = reference.gas(*GAS.values()), reference.power(*POWER.values())
    state = reference.solve(replace(RODS, gap=gap), gas, power)
    cards = [*PRESSURE_CARDS, *GAS_CARDS, *POWER_CARDS]
    solve(write_rods(tmp_path / "rods.inp", GAS | POWER | PRESSURE, cards, gap, state))


CONSTANTS = [("gas", OPEN, "A"), ("gas", OPEN, "B"), ("gas", CLOSED, "A"), ("gas", CLOSED, "B"),
             ("power", CLOSED, "C0"), ("power", CLOSED, "C1"), ("power", CLOSED, "N"),
             ("clearance", OPEN, "W1"), ("clearance", OPEN, "W2"), ("clearance", OPEN, "X2"),
             ("clearance", FAR, "W3"), ("clearance", FAR, "X3"), ("clearance", VERY_FAR, "W3"),
             ("clearance", CLOSED, "W1"), ("pressure", CLOSED, "V2"), ("pressure", CLOSED, "Y2"),
             ("pressure", CLOSED, "V3"), ("pressure", CLOSED, "Y3")]  # fmt: skip


@pytest.mark.parametrize(("name", "gap", "constant"), CONSTANTS)
def test_each_constant_changes_the_heat_by_a_known_amount(tmp_path, name, gap, constant):
    constants, cards = LAWS[name][:2]
    changed = constants | {constant: 1.02 * constants[constant]}
    before, after = (expected(name, c, gap) for c in (constants, changed))
    deck = write_rods(tmp_path / "rods.inp", constants, cards, gap, before)
    flux = last_flux(solve(deck))
    setting = f"{constant}={changed[constant]!r}"
    change = last_flux(solve(deck, "--set", setting, status=4)) - flux
    assert abs(change) > 1e-4 * flux
    assert change == pytest.approx(after.flux - before.flux, rel=1e-5)
