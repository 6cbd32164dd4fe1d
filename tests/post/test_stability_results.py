"""Results with *STABILITY: the page tells of every analysis, the picture has the motion."""

import csv
import re
import shutil
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / each) for each in ("decks", "reference")] + [str(TESTS.parent / "python")]

import rod_modes  # noqa: E402
from test_stability import BRANCHES, MIDDLE, middle, solved, stability_of  # noqa: E402

from thercon.post.cli import main as plot  # noqa: E402
from thercon.post.fields import words_below  # noqa: E402
from thercon.post.report.cli import main as report  # noqa: E402
from thercon.post.result import Result  # noqa: E402

MODE = ["--quantity", "mode_temperature"]


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """Return the result of rods in their unstable state, analysed at every other increment."""
    cards = [line.replace("1., 1.", "0.25, 1.") for line in middle(
        stability="*STABILITY, FREQUENCY=2")]
    return solved(tmp_path_factory.mktemp("rods"), cards)[0]


def page(result):
    """Return the rows of the analyses on the page of a result: lists of cells."""
    assert report([str(result), "--out", str(result.parent)]) == 0
    text = result.with_suffix(".html").read_text()
    tables = re.findall("<caption>Stability in time</caption>.*?</table>", text)
    rows = re.findall("<tr>(.*?)</tr>", tables[0].split("<tbody>")[1]) if tables else []
    return [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in rows]


def number(cell):
    """Return a number of the page."""
    return float(cell.replace("\N{MINUS SIGN}", "-"))


def test_the_page_tells_of_every_analysis(result):
    rate = rod_modes.rates(MIDDLE, (3.6e6, 3.6e6), BRANCHES[1])[0].real
    half, full = page(result)
    assert half[:3] == ["0.5", "stable", "0"] and half[5].startswith("falls to 1/e in ")
    assert full[:3] == ["1", "unstable", "1"] and full[6] == "none"
    assert full[4] == "no estimate: not there on a finer mesh"
    assert number(full[3]) == pytest.approx(rate, rel=1e-3)
    assert number(full[5].removeprefix("doubles in ")) == pytest.approx(np.log(2) / rate, rel=1e-3)


def test_the_page_tells_what_decays_is_uncertain_or_not_known(tmp_path):
    stable, _ = solved(tmp_path, middle(branch=0), name="stable")
    rate = stability_of(stable)["growth_rate"][0]
    assert page(stable)[0][1] == "stable"
    assert number(page(stable)[0][5].removeprefix("falls to 1/e in ")) == pytest.approx(
        -1 / rate, rel=1e-3)
    stable.with_suffix(".lst").unlink()
    assert page(stable)[0][1] == "–"
    unknown, _ = solved(tmp_path, middle(capacities=None, branch=0), name="unknown")
    assert page(unknown) == [["1", "uncertain", *("–" * 5)]]
    without, _ = solved(tmp_path, middle(stability="**"), name="without")
    assert page(without) == []


def test_a_motion_is_drawn_on_its_shape(result, tmp_path, capsys):
    factors, options = {}, ["--csv", "--out", str(tmp_path)]
    for name, chosen in (("", []), ("-scale-500", ["--scale", "500"])):
        assert plot(["fields", str(result), *MODE, *chosen, *options]) == 0
        with open(tmp_path / f"deck.fields-mode_temperature{name}.csv", newline="") as file:
            drawn = [{key: float(cell) for key, cell in row.items()} for row in csv.DictReader(file)]
        factors[name] = drawn
    assert plot(["fields", str(result), "--quantity", "mode_displacement", *options]) == 2
    assert "is the shape that mode_temperature is drawn on" in capsys.readouterr().err
    with h5py.File(result) as file:
        grid = file["VTKHDF"]
        count = len(grid["Points"])
        mode = grid["PointData/mode_temperature"][-count:]
        moved = grid["PointData/mode_displacement"][-count:, 1]
        places = grid["Points"][:, 1]
    np.testing.assert_array_equal([row["mode_temperature"] for row in drawn], mode)
    most = abs(moved).argmax()
    # One digit of the factor that makes a fiftieth of the rods, 0.2 long; or what is asked for.
    expected = {"": float(f"{0.02 * 0.2 / abs(moved[most]):.1g}"), "-scale-500": 500.0}
    for name, drawn in factors.items():
        shift = np.array([row["y_drawn"] for row in drawn]) - places
        np.testing.assert_allclose(shift, expected[name] * moved, atol=1e-9 * expected[name] * abs(moved[most]))


def test_the_picture_of_a_motion_tells_its_rate(result):
    with Result(result) as opened:
        said = words_below(opened, 3, 1.0, is_mode=True)
    rate = rod_modes.rates(MIDDLE, (3.6e6, 3.6e6), BRANCHES[1])[0].real
    assert number(re.search(r"growth rate (\S+)", said)[1]) == pytest.approx(rate, rel=1e-3)


def test_a_motion_is_drawn_alone_and_where_there_is_one(result, tmp_path, capsys):
    assert plot(["fields", str(result), *MODE, "yy", "--out", str(tmp_path)]) == 2
    assert "draw it apart from other fields" in capsys.readouterr().err
    assert plot(["fields", str(result), *MODE, "--increment", "3", "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "no field 'mode_temperature' at this load" in said
    assert said.endswith("; increments that have it: 2, 4\n")


def test_a_run_that_ended_before_an_analysis_says_so(result, tmp_path, capsys):
    path = Path(shutil.copy(result, tmp_path))
    with h5py.File(path, "r+") as file:
        for key in list(file["stability"]):
            none = file["stability"][key][:0]
            del file["stability"][key]
            file["stability"][key] = none
        file["VTKHDF/PointData/mode_temperature"][...] = np.nan
    assert plot(["fields", str(path), *MODE, "--out", str(tmp_path)]) == 2
    assert "; no state was analysed: the run did not come to" in capsys.readouterr().err
    assert page(path) == []
    assert "<p>Stability in time: no state was analysed: " in path.with_suffix(".html").read_text()
