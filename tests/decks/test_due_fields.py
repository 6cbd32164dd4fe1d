"""Stress and flux are recovered where something needs them: thinned output changes no value."""

import h5py
import numpy as np
import pytest
from deck_runs import datasets, solve
from test_error_estimates import COLUMNS, HOT, ROWS, write

TENSION = 8.0
FREQUENCIES = 3, 2, 0, 1   # of the steps
DUE = [2, 3, 5, 7, 8, 11, 12, 13]   # rows of /history whose fields are written
JUDGED = 6


def deck(path, frequencies):
    """Write a deck: heat, uniform tension, a force on a corner, heat again."""
    files = [[f"*EL FILE, FREQUENCY={n}", "S, HFL"] for n in frequencies]
    right = [f"{(COLUMNS - 1) * ROWS + j}, P2, {-TENSION}" for j in range(1, ROWS + 1)]
    table = ["*EL PRINT, ELSET=BODY, FREQUENCY=2", "S"]
    return write(path, [
        "*STEP", "*HEAT TRANSFER, STEADY STATE", "0.25, 1", "*BOUNDARY", "LEFT, 11, 11, 0",
        f"CORNER, 11, 11, {HOT}", *files[0], "*END STEP",
        "*STEP", "*STATIC", "0.2, 1", "*BOUNDARY", "LEFT, 1, 1, 0", "1, 2, 2, 0", "*DLOAD", *right,
        *files[1], *table, "*END STEP",
        "*STEP", "*STATIC", "0.25, 0.75", "*CLOAD", "CORNER, 2, -3", *files[2], "*END STEP",
        "*STEP", "*HEAT TRANSFER, STEADY STATE", "0.5, 1", *files[3], "*END STEP",
        "*VERIFY, KIND=ANALYTIC", f"S11, ALL, 1.6, {0.6 * TENSION}, 1e-9"])


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Return results and listings with all fields and with thinned ones."""
    found = []
    for name, frequencies in ("all", (1, 1, 1, 1)), ("thinned", FREQUENCIES):
        path = deck(tmp_path_factory.mktemp(name) / "square.inp", frequencies)
        found.append((solve(path), path.with_suffix(".lst").read_text()))
    return found


def fields(result):
    """Return the times of the fields, and each field as rows of these."""
    with h5py.File(result) as file:
        group = file["VTKHDF"]
        times = group["Steps/Values"][()]
        names = [f"{kind}/{name}" for kind, names in (
            ("PointData", ("displacement", "stress", "von_mises", "heat_flux", "temperature")),
            ("CellData", ("stress_error", "heat_flux_error"))) for name in names]
        return times, {name: group[name][()].reshape(len(times), -1) for name in names}


def test_fields_are_those_of_the_run_that_writes_all(runs):
    """Every one written, and no other; a step with heat alone keeps the stress of the last."""
    (times, every), (thinned, some) = (fields(result) for result, _ in runs)
    np.testing.assert_array_equal(thinned, times[DUE])
    for name, values in some.items():
        np.testing.assert_array_equal(values, every[name][DUE], err_msg=name)
    for name in "PointData/stress", "CellData/stress_error":
        np.testing.assert_array_equal(some[name][-2:], some[name][[-3, -3]])
        assert np.isfinite(some[name][2:]).all()


def test_numbers_are_the_same_but_errors_that_nothing_needs(runs):
    """Of /history, /convergence and /contact; the errors of other increments are NaN."""
    every, some = (datasets(result, "history", "convergence", "contact") for result, _ in runs)
    assert every.keys() == some.keys()
    needed = np.isin(np.arange(14), [*DUE, JUDGED])
    for name in "history/stress_error", "history/heat_flux_error":
        expected = np.where(needed[:, None], every.pop(name), np.nan)
        np.testing.assert_array_equal(some.pop(name), expected, err_msg=name)
    for name, values in every.items():
        np.testing.assert_array_equal(some[name], values, err_msg=name)


def test_listings_are_the_same(runs):
    """Checks are judged alike, tables and the errors at the end of steps are there."""
    said = []
    for _, listing in runs:
        body = listing.split("INCREMENTS\n", 1)[1].split("SECONDS")[0]
        said.append([line for line in body.splitlines() if not line.startswith("*")])
    assert said[0] == said[1]
    assert sum("INTEGRATION POINTS OF BODY" in line for line in said[0]) == 3 + 2 + 1
    assert any(line.endswith("PASS") for line in said[0])
