"""Fields along outlines, against fields and lengths that are known."""

import csv
import shutil
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / each) for each in ("decks", "reference")] + [str(TESTS.parent / "python")]

from physics import material, mesh, nodes_of  # noqa: E402
from test_set_histories import solve  # noqa: E402

from thercon.post.cli import main as plot  # noqa: E402

BLOCK = mesh("BODY", [0.0, 0.5, 1.25, 2.0], [0.0, 0.5, 1.0], "CPE8")
NODE_AT = {place: number for number, place in nodes_of(BLOCK).items()}
STEP = ["*STEP", "*HEAT TRANSFER, STEADY STATE", "0.5, 1.", "*BOUNDARY", "BODY.LEFT, 11, 11, 20.",
        "BODY.RIGHT, 11, 11, 100.", "*END STEP"]


def table(folder, result, *options):
    """Draw an edge; return its picture's name and the columns of its table."""
    assert plot(["edge", str(result), "--csv", "--out", str(folder), *map(str, options)]) == 0
    (path,) = folder.glob("*.csv")
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return path.stem, {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    """Return the result of a block 2 wide and 1 high whose temperature rises along x."""
    return solve(tmp_path_factory.mktemp("block"), BLOCK, material("BODY", conductivity=3.0), STEP)


def test_a_way_round_a_corner_has_the_fields_of_its_places(block, tmp_path):
    ends = [NODE_AT[place] for place in ((0, 0), (2, 0), (2, 1))]
    name, found = table(tmp_path, block, "--nodes", *ends, "--load", 0.5, 1, "--quantity", "NT")
    assert name == f"deck.edge-{'-'.join(map(str, ends))}-temperature-0.5-1"
    assert {path.suffix for path in tmp_path.iterdir()} == {".png", ".svg", ".csv"}
    first = found["load"] == 0.5
    x = [0, 0.25, 0.5, 0.875, 1.25, 1.625, 2, 2, 2, 2, 2]
    for rows, share in ((first, 0.5), (~first, 1.0)):
        np.testing.assert_allclose(found["x"][rows], x)
        np.testing.assert_allclose(found["s"][rows], [*x[:7], 2.25, 2.5, 2.75, 3])
        np.testing.assert_allclose(found["y"][rows], [0] * 7 + [0.25, 0.5, 0.75, 1])
        np.testing.assert_allclose(found["temperature"][rows],
                                   share * (20 + 40 * found["x"][rows]), rtol=1e-9)
    assert found["node"][0] == ends[0] and found["node"][-1] == ends[-1]


def test_the_shorter_way_is_taken(block, tmp_path):
    ends = [NODE_AT[place] for place in ((0, 0.5), (1.25, 0))]
    _, found = table(tmp_path, block, "--nodes", *ends)
    assert found["s"][-1] == pytest.approx(1.75) and found["x"].max() == 1.25


def test_curved_sides_have_their_length(tmp_path):
    """A quarter of a ring by four elements: its sides are parabolas."""
    angles = np.linspace(0.0, np.pi / 2, 9)
    nodes = [f"{100 * i + k}, {r * np.cos(a):.14g}, {r * np.sin(a):.14g}"
             for i, r in enumerate((1.0, 1.5, 2.0), 1) for k, a in enumerate(angles)]
    cells = [f"{k}, {100 + a}, {300 + a}, {302 + a}, {102 + a}, {200 + a}, {301 + a}, {202 + a}, {101 + a}"
             for k, a in enumerate(range(0, 8, 2), 1)]
    body = ["*NODE, NSET=BODY", *nodes, "*ELEMENT, TYPE=CPE8, ELSET=BODY", *cells, "*NSET, NSET=BODY.LEFT",
            "100, 200, 300", "*NSET, NSET=BODY.RIGHT", "108, 208, 308"]
    result = solve(tmp_path, body, material("BODY", conductivity=3.0), STEP)
    (tmp_path / "out").mkdir()
    _, found = table(tmp_path / "out", result, "--nodes", 300, 308)
    np.testing.assert_allclose(found["s"], 2.0 * angles, rtol=2e-4)


def test_gaps_and_wear_are_drawn_along_a_face(usual, tmp_path, capsys):
    """On both faces, nothing beside them; other pictures of fields have none."""
    result = shutil.copy(usual, tmp_path)
    with h5py.File(result, "r+") as file:
        grid = file["VTKHDF"]
        ids, x = grid["PointData/node_id"][:len(grid["Points"])], grid["Points"][:, 0]
        face = file["contact/CYLINDER/slave_node"][()]
        times = len(grid["Steps/Values"])
        gap = np.where(np.isin(ids, face), 0.1 * x, np.nan)
        grid["PointData/contact_gap"] = np.tile(gap, times)
        grid["PointData/contact_wear_slave"] = np.tile(2.0 * gap, times)
    (tmp_path / "out").mkdir()
    _, found = table(tmp_path / "out", result, "--nodes", face[0], face[-1], "--quantity", "gap", "wear_slave")
    np.testing.assert_allclose(found["gap"], 0.1 * found["x"])
    np.testing.assert_allclose(found["wear_slave"], 2.0 * found["gap"])
    assert plot(["fields", str(result), "--out", str(tmp_path), "--quantity", "gap"]) == 2
    assert "no field 'gap'" in capsys.readouterr().err


@pytest.mark.parametrize(("nodes", "message"), [
    ((1,), "needs two nodes"), ((1, 999), "node 999 is on no outline")])
def test_what_is_no_edge_is_refused(block, tmp_path, capsys, nodes, message):
    assert plot(["edge", str(block), "--out", str(tmp_path), "--nodes", *map(str, nodes)]) == 2
    assert message in capsys.readouterr().err


def test_fields_of_elements_are_refused(block, tmp_path, capsys):
    words = ["edge", str(block), "--out", str(tmp_path), "--nodes", "1", "2", "--quantity", "heat_flux_error"]
    assert plot(words) == 2
    assert "heat_flux_error is a field of elements" in capsys.readouterr().err
