"""*CONTACT PRINT and the pairs that never approached: what the listing says of the pairs."""

import re

import h5py
import numpy as np
import pytest
from blocks import block, solid, write
from deck_runs import CYLINDER, solve

# Heads of the columns and what /contact calls them, with heat and without.
MECHANICS = {"slave": "slave_node", "master": "master_node", "x": "x", "y": "y", "zone": "status",
             "gap": "gap", "p": "pressure", "tau": "shear", "slip": "slip"}
HEAT = {"T1": "slave_temperature", "T2": "master_temperature", "omega": "conductance",
        "q": "heat_flux"}
ZONES = "I", "II", "III"
PRINTED = 0.5e-3   # of the three digits behind the point
PUSHED = ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "LOWER.BOTTOM, 1, 2", "UPPER.TOP, 1",
          "UPPER.TOP, 2, 2, -1.25", "*CONTACT PRINT", "CDIS", "*END STEP"]


def tables(listing):
    """Return the heads of the contact tables of a listing, and their rows, increment by increment;
    the zone of a pair as the number of its status."""
    heads, rows = [], []
    for part in listing.read_text().split("   CONTACT POINTS OF FACE\n")[1:]:
        head, *lines = part.split("\n\n")[0].splitlines()
        heads.append(head.split())
        cells = [line.split() for line in lines if re.match(r" *\d+ +\d+ +\d+ ", line)]
        zone = heads[-1].index("zone")
        rows.append([[float(ZONES.index(cell) if k == zone else cell)
                      for k, cell in enumerate(row)] for row in cells])
    return heads, np.array(rows)


def assert_printed(result, columns):
    """Assert that every column of every increment is its dataset of /contact; return these."""
    heads, rows = tables(result.with_suffix(".lst"))
    with h5py.File(result) as file:
        stored = {name: file["contact/FACE"][name][()] for name in columns.values()}
        increments = len(file["history/time"])
    assert heads == [["no.", *columns]] * increments
    np.testing.assert_array_equal(rows[:, :, 0],
                                  [range(1, len(stored["x"]) + 1)] * increments)
    for k, (head, name) in enumerate(columns.items(), 1):
        expected = np.broadcast_to(stored[name], rows[:, :, k].shape)
        exact = head in ("slave", "master", "zone")
        np.testing.assert_allclose(rows[:, :, k], expected, rtol=0.0 if exact else PRINTED,
                                   err_msg=head)
    return stored


def test_table_of_a_heated_contact_with_friction_is_that_of_the_result(tmp_path):
    """All 45 tables of the published cylinder: no two columns are alike, each has its sign."""
    deck = tmp_path / "cylinder.inp"
    deck.write_text(CYLINDER.read_text().split("*VERIFY")[0])
    stored = assert_printed(solve(deck), MECHANICS | HEAT)
    assert set(stored["status"].ravel()) == {0, 1, 2}
    assert (stored["heat_flux"] < -1.0).any() != (stored["heat_flux"] > 1.0).any()
    assert (stored["shear"] < -1.0).any() != (stored["shear"] > 1.0).any()
    assert (np.abs(stored["slip"]) > 1e-4).any()
    assert (stored["slave_temperature"] - stored["master_temperature"] > 1.0).any()


def blocks(*steps):
    """Return two blocks of two elements, 1 apart, and their steps."""
    return [*block("LOWER", [0.0, 1.0, 2.0], [-1.0, 0.0]),
            *block("UPPER", [0.0, 1.0, 2.0], [1.0, 2.0], first=101),
            *solid("LOWER", 1e3, 0.0), *solid("UPPER", 1e3, 0.0),
            "*SURFACE INTERACTION, NAME=FACES", "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE",
            "UPPER.BOTTOM, LOWER.TOP", *(card for step in steps for card in step)]


def test_table_without_heat_ends_with_the_slip(tmp_path):
    assert_printed(solve(write(tmp_path / "deck.inp", blocks(PUSHED))), MECHANICS)


def turned(left, right):
    """Return a step that turns the upper block: its ends are lifted by these, without strain."""
    places = {108: 0.0, 103: 0.25, 107: 0.5, 111: 0.75, 113: 1.0}   # along the top, in its width
    lifts = [f"{node}, 2, 2, {left + place * (right - left)!r}" for node, place in places.items()]
    return ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "LOWER.BOTTOM, 1, 2", "UPPER.TOP, 1",
            *lifts, "*END STEP"]


NEAR_AND_AWAY = turned(-0.2, 0.4), turned(0.5, 0.5)   # gaps of 0.8, 0.95, 1.1 ...; all of 1.5


@pytest.mark.parametrize(("steps", "never"), [
    (NEAR_AND_AWAY, ["106-7", "109-11", "112-13"]),
    (NEAR_AND_AWAY[1:], ["105-8", "101-3", "106-7", "109-11", "112-13"]),
    ((turned(-0.2, -0.1), *NEAR_AND_AWAY[1:]), [])])
def test_a_pair_that_approached_and_left_did_approach(tmp_path, steps, never):
    """The smallest gap of all increments decides, not the last one."""
    deck = write(tmp_path / "deck.inp", blocks(*steps))
    with h5py.File(solve(deck)) as file:
        np.testing.assert_allclose(file["contact/FACE/gap"][-1], 1.5, rtol=1e-12)
    said = re.findall(r"^CONTACT POINTS THAT NEVER APPROACHED: (\d+) of 5 of FACE\n.*\n +slave "
                      r"and master nodes (.*)$", deck.with_suffix(".lst").read_text(), re.M)
    assert said == ([(str(len(never)), " ".join(never))] if never else [])
