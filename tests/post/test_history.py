"""Pictures and pages of the histories of sets, and their tables, against the result file."""

import base64
import csv
import gzip
import json
import re
import shutil
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / each) for each in ("decks", "reference")] + [str(TESTS.parent / "python")]

from physics import material, mesh  # noqa: E402
from synthetic import write_result  # noqa: E402
from test_prints import BODY, HELD, static  # noqa: E402
from test_reached import WARM, judged  # noqa: E402
from test_set_histories import solve  # noqa: E402

import thercon  # noqa: E402
from thercon.post import history  # noqa: E402
from thercon.post.cli import main as plot  # noqa: E402
from thercon.post.report.cli import main as report  # noqa: E402
from thercon.post.report.sets import of_sets  # noqa: E402
from thercon.post.result import Result  # noqa: E402
from thercon.post.set_histories import set_histories  # noqa: E402

CARDS = ["*NODE PRINT, NSET=BLOCK.TOP, FREQUENCY=2", "U", "*NODE PRINT, NSET=BLOCK.BOTTOM, TOTALS=ONLY",
         "RF", "*EL PRINT, ELSET=BLOCK", "S"]


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """Return the result of a pressed block with histories of two node sets and an element set."""
    return solve(tmp_path_factory.mktemp("block"), BODY, ['*OPTIONS, UNITS="mm MPa W C"'], static(
        *HELD, "*DLOAD", "BLOCK, P3, 6.", *CARDS, times="0.2, 1."))


def rows(path):
    """Return the columns of a CSV file."""
    with open(path, newline="") as file:
        found = list(csv.DictReader(file))
    return {key: np.array([float(row[key]) for row in found]) for key in found[0]}


def test_every_set_has_a_picture_and_a_table(result, tmp_path, capsys):
    assert plot(["history", str(result), "--csv", "--out", str(tmp_path)]) == 0
    names = [f"deck.history-{name}" for name in ("BLOCK.BOTTOM", "BLOCK.TOP", "BLOCK")]
    assert capsys.readouterr().out.split() == [
        str(tmp_path / f"{name}.{end}") for name in names for end in ("png", "svg", "csv")]
    with h5py.File(result) as file:
        group = file["history/nodes/BLOCK.TOP"]
        table = rows(tmp_path / "deck.history-BLOCK.TOP.csv")
        for k, node in enumerate(group["node"]):
            np.testing.assert_array_equal(table[f"displacement_y_{node}"],
                                          group["displacement_y"][:, k])
        np.testing.assert_array_equal(table["increment"], [2, 4, 5])
        assert set(thercon.open(result).history["block.top"].table()) == {*table} - {"time", "load"}
        stress = file["history/elements/BLOCK/stress_yy"][:, 9]
    np.testing.assert_array_equal(rows(tmp_path / "deck.history-BLOCK.csv")["stress_yy_2.1"], stress)
    total = rows(tmp_path / "deck.history-BLOCK.BOTTOM.csv")["total_external_force_y"]
    np.testing.assert_allclose(total, 1.25 * 6.0 * np.arange(1, 6) / 5)


@pytest.mark.parametrize("name", ["displacement_y", "U2"])
def test_a_set_and_a_quantity_are_chosen(result, tmp_path, capsys, name):
    arguments = ["--set", "block.top", "--quantity", name, "--csv", "--out", str(tmp_path)]
    assert plot(["history", str(result), *arguments]) == 0
    with h5py.File(result) as file:
        nodes = file["history/nodes/BLOCK.TOP/node"][()]
    assert list(rows(tmp_path / "deck.history-BLOCK.TOP-displacement_y.csv")) == [
        "increment", "time", "load", *(f"displacement_y_{node}" for node in nodes)]


def test_several_sets_are_chosen(result, tmp_path):
    for arguments in (["--set", "block.top", "BLOCK.BOTTOM"],
                      ["--set", "block.top", "--set=BLOCK.BOTTOM"]):
        folder = tmp_path / str(len(arguments))
        assert plot(["history", *arguments, str(result), "--csv", "--out", str(folder)]) == 0
        assert sorted(path.name for path in folder.glob("*.csv")) == [
            "deck.history-BLOCK.BOTTOM.csv", "deck.history-BLOCK.TOP.csv"]


@pytest.mark.parametrize(("arguments", "words"), [
    (["--set", "BLOCK.TOPP"], "has no history of a set 'BLOCK.TOPP', nearest: 'BLOCK.TOP': there are "
     "BLOCK.BOTTOM, BLOCK.TOP, BLOCK"),
    (["--quantity", "temperatur"], "has no history of 'temperatur'"),
    (["--set", "BLOCK.TOP", "--quantity", "displacement"],
     "has no history of 'displacement', nearest: 'displacement_"),
])
def test_what_is_not_there_is_said(result, tmp_path, capsys, arguments, words):
    assert plot(["history", str(result), *arguments, "--out", str(tmp_path)]) == 2
    assert words in capsys.readouterr().err


def test_a_result_without_histories_says_what_makes_them(tmp_path, capsys):
    plain = solve(tmp_path, BODY, static(*HELD, "*DLOAD", "BLOCK, P3, 6."))
    assert plot(["history", str(plain), "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err == (
        f"plot: error: {plain}: holds no histories: *NODE PRINT and *EL PRINT of the deck say of which "
        "sets it keeps them\n")


def test_what_is_zero_has_no_panel_and_reference_nodes_have_their_names(tmp_path):
    path = tmp_path / "case.vtkhdf"
    write_result(path, units="mm MPa W C", contacts=())
    with h5py.File(path, "r+") as file:
        del file["deck"]
        file["deck"] = ["*SOLID SECTION, ELSET=A, MATERIAL=M, REF NODE=REFA",
                        "*SOLID SECTION, ELSET=B, MATERIAL=M, REF NODE=9002"]
        count = len(file["history/time"])
        for key, unit, size in (("U3", "mm", 1.0), ("UR1", "-", 0.0), ("RM1", "MPa mm^3", 1e6),
                                ("RM2", "MPa mm^3", 1e-6), ("RF3", "MPa mm^2", 2.0)):
            file[f"history/{key}"] = size * np.ones((count, 2))
            file[f"history/{key}"].attrs["unit"] = unit
    with Result(path) as opened:
        (nodes,) = set_histories(opened)
        assert nodes.told() == ["U3", "RF3", "RM1"]
        assert nodes.members == ["reference node REFA", "reference node 9002"]
        assert nodes.units["RF3"] == "N"
        assert [each["key"] for each in of_sets(opened, list)] == nodes.told()


def test_forces_of_pre_tension_sections_are_drawn(tmp_path, capsys):
    """Two bars, held at both ends: the forces are those that the deck prescribes."""
    bars, forces = [], {"900": 5.0, "901": 7.0}
    for name, node, first, x in (("ONE", "900", 1, 0.0), ("TWO", "901", 101, 3.0)):
        bars += [*mesh(name, [x, x + 1.0], [0.0, 1.0, 2.0], first=first),
                 *material(name, (1e3, 0.0)), "*NODE", f"{node}, {x}, 9.",
                 f"*SURFACE, NAME=CUT{name}", f"{first}, S3",
                 f"*PRE-TENSION SECTION, NODE={node}, SURFACE=CUT{name}"]
    held = [f"{name}.{end}, {axis}" for name in ("ONE", "TWO")
            for end, axis in (("BOTTOM", 2), ("TOP", 2), ("LEFT", 1))]
    path = solve(tmp_path, bars, static("*BOUNDARY", *held, "*CLOAD", *(
        f"{node}, 1, {force}" for node, force in forces.items()), times="0.5, 1."))
    assert plot(["history", str(path), "--quantity", "pre_tension", "--csv", "--out",
                 str(tmp_path)]) == 0
    assert report([str(path), "--out", str(tmp_path)]) == 0
    chart, = (each for each in page_data(tmp_path / "deck.html")["history"]
              if each["key"] == "pre_tension")
    table = rows(tmp_path / "deck.history-pre_tension.csv")
    for k, force in enumerate(forces.values()):
        np.testing.assert_allclose(table[f"pre_tension_{k + 1}"], [0.5 * force, force])
        assert chart["curves"][k]["name"] == f"section {k + 1}"
        np.testing.assert_allclose(chart["curves"][k]["values"], [0.5 * force, force])


def page_data(path):
    """Return what the script of a page is given."""
    packed = re.search('<script type="application/gzip" id="data">(.*?)</script>', path.read_text())[1]
    return json.loads(gzip.decompress(base64.b64decode(packed)))


def test_the_page_has_a_chart_of_each_quantity(result, tmp_path):
    """Of many points their smallest, mean and largest values; of few the curve of each."""
    assert report([str(result), "--out", str(tmp_path)]) == 0
    found = {each["label"]: each for each in page_data(tmp_path / "deck.html")["history"]
             if "curves" in each}
    with h5py.File(result) as file:
        stress = file["history/elements/BLOCK/stress_yy"][()]
        moved = file["history/nodes/BLOCK.TOP/displacement_y"][()]
        nodes = file["history/nodes/BLOCK.TOP/node"][()]
    many = found["Stress yy of BLOCK, mean"]
    assert many["unit"] == "MPa" and many["at"] == list(range(5))
    for curve, take in zip(many["curves"], (np.min, np.mean, np.max), strict=True):
        np.testing.assert_allclose(curve["values"], take(stress, axis=1))
    few = found[f"Displacement y of BLOCK.TOP, node {nodes[0]}"]
    assert few["at"] == [1, 3, 4] and few["values"][0] is None
    assert [curve["name"] for curve in few["curves"]] == [f"node {n}" for n in nodes]
    for k, curve in enumerate(few["curves"]):
        np.testing.assert_allclose(curve["values"], moved[:, k])
    total = found["Total reaction or load y of BLOCK.BOTTOM"]
    assert [curve["name"] for curve in total["curves"]] == [""]


def test_the_browser_draws_the_curves(result, tmp_path, browser):
    """A curve for each node of a set, with its name below, and three of many points."""
    assert report([str(result), "--out", str(tmp_path)]) == 0
    entries = page_data(tmp_path / "deck.html")["history"]
    browser.open(tmp_path / "deck.html")
    for k, each in enumerate(entries):
        if "curves" not in each:
            continue
        lines, names, caption = browser.run(
            "const chart = document.getElementById('history-' + arguments[0]);"
            "return [chart.querySelectorAll('g path[fill=none]').length, "
            "[...chart.querySelectorAll('svg > text')].map(e => e.textContent), "
            "chart.querySelector('figcaption').textContent];", k)
        assert lines == len(each["curves"])
        assert {curve["name"] for curve in each["curves"]} - {""} <= set(names)
        assert caption.startswith(each["label"])
    assert not browser.messages()


def test_times_and_temperatures_have_their_units(usual, tmp_path):
    path = Path(shutil.copy(usual, tmp_path))
    with h5py.File(path, "r+") as file:
        file["run"].attrs["unit_time"] = "s"
        times = file["history/time"][()]
        file["history/heat_stored"] = 0.0 * times
        file["history/nodes/TOP/node"], file["history/nodes/TOP/time"] = [7], times
        file["history/nodes/TOP/increment"] = np.arange(1, len(times) + 1)
        file["history/nodes/TOP/temperature"] = times[:, None]
        file["history/nodes/TOP/temperature"].attrs["unit"] = "C"
    with Result(path) as opened:
        (top,) = history.chosen(opened, ["TOP"])
        (axes,) = history.picture(opened, top, ["temperature"]).axes
        (over_load,) = history.picture(opened, top, ["temperature"], "load").axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("Time (s)", "Temperature (\N{DEGREE SIGN}C)")
    assert over_load.get_xlabel() == "Temperature of node set TOP (\N{DEGREE SIGN}C)"
    assert report([str(path), "--out", str(tmp_path)]) == 0
    (chart,) = [each for each in page_data(tmp_path / "case.html")["history"] if "curves" in each]
    assert chart["unit"] == "\N{DEGREE SIGN}C"


def test_the_page_has_the_checks_of_reached_values(tmp_path):
    """Also one whose words are wider than the column of the listing."""
    judged(tmp_path, WARM, "heat_imbalance_pointwise reaches 1.E3, , LAST, 1., 1.",
           "NT reaches 70., BLOCK.TOP, LAST, 0.2, 1.E-9", status=4)
    assert report([str(tmp_path / "deck.vtkhdf"), "--out", str(tmp_path)]) == 0
    rows = re.findall("<tr><th scope=\"row\".*?</tr>", (tmp_path / "deck.html").read_text())
    told = [row for row in rows if " reaches " in row]
    assert "heat_imbalance_pointwise reaches 1000<" in told[0] and "FAIL</span> never reached" in told[0]
    assert "NT reaches 70<" in told[1] and ">PASS</span>" in told[1]
