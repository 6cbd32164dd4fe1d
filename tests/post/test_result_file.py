"""The result file of the published cylinder, read with VTK's own reader and with h5py."""

import re
import shutil
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest
from program import CYLINDER, increments_in, run, write_deck
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as pipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))

from thercon.post.result import Result  # noqa: E402
from thercon.post.rigid_surfaces import lines_of, motion_of, surfaces  # noqa: E402

INCREMENTS, NODES, ELEMENTS, PAIRS = 45, 326, 92, 21
ENDS, AXIS = 5 + 5, 13 + 13   # nodes of the heated and the cold section, of the axis of symmetry
QUADRATIC_QUAD, LINE = 23, 3
DOCS, EXAMPLES = ROOT / "docs", ROOT / "input" / "examples"


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Return the folder with the results of the published deck."""
    folder = tmp_path_factory.mktemp("cylinder")
    deck = folder / "cylinder.inp"
    shutil.copy(CYLINDER, deck)
    assert run(deck) == (0, "")
    return folder


@pytest.fixture
def stored(results):
    """Return the result file, open with h5py."""
    with h5py.File(results / "cylinder.vtkhdf") as file:
        yield file


@pytest.fixture
def reader(results):
    """Return VTK's reader on the result file."""
    reader = vtkHDFReader()
    reader.SetFileName(str(results / "cylinder.vtkhdf"))
    reader.UpdateInformation()
    return reader


def grid_at(reader, step):
    """Return the times that the reader knows, and its grid at one of them."""
    information = reader.GetOutputInformation(0)
    times = information.Get(pipeline.TIME_STEPS())
    information.Set(pipeline.UPDATE_TIME_STEP(), times[step])
    reader.Update()
    return times, reader.GetOutput()


def arrays_of(data):
    """Return the arrays of point or cell data by their names."""
    arrays = map(data.GetArray, range(data.GetNumberOfArrays()))
    return {array.GetName(): vtk_to_numpy(array) for array in arrays}


@pytest.mark.parametrize("step", [11, INCREMENTS - 1])
def test_vtk_reads_the_values_that_h5py_reads(reader, stored, step):
    times, grid = grid_at(reader, step)
    assert list(times) == list(stored["history/time"])
    assert (grid.GetNumberOfPoints(), grid.GetNumberOfCells()) == (NODES, ELEMENTS)
    points = arrays_of(grid.GetPointData())
    assert points.keys() == stored["VTKHDF/PointData"].keys()
    rows = slice(step * NODES, (step + 1) * NODES)
    for name, values in points.items():
        expected = stored[f"VTKHDF/PointData/{name}"]
        expected = expected[()] if name == "node_id" else expected[rows]
        np.testing.assert_array_equal(values, expected, err_msg=name)
    cells = arrays_of(grid.GetCellData())
    fixed = {"element_id", "body", "material"}
    assert cells.keys() == fixed | {"stress_error", "heat_flux_error"}
    rows = slice(step * ELEMENTS, (step + 1) * ELEMENTS)
    for name, values in cells.items():
        expected = stored[f"VTKHDF/CellData/{name}"]
        expected = expected[()] if name in fixed else expected[rows]
        np.testing.assert_array_equal(values, expected, err_msg=name)


def test_the_two_time_steps_differ(reader):
    fields = []
    for step in (11, INCREMENTS - 1):
        _, grid = grid_at(reader, step)
        fields.append(arrays_of(grid.GetPointData())["temperature"].copy())
    assert fields[0].max() == pytest.approx(240.0, rel=1e-9)
    assert fields[1].max() == pytest.approx(900.0, rel=1e-9)


def test_cells_are_eight_node_quadrilaterals_with_midside_nodes_in_the_order_of_vtk(reader):
    _, grid = grid_at(reader, 0)
    xy = vtk_to_numpy(grid.GetPoints().GetData())[:, :2]
    for cell in range(ELEMENTS):
        assert grid.GetCellType(cell) == QUADRATIC_QUAD
        ids = grid.GetCell(cell).GetPointIds()
        x = xy[[ids.GetId(i) for i in range(8)]]
        for side in range(4):
            ends = x[side], x[(side + 1) % 4]
            off = np.linalg.norm(x[4 + side] - (ends[0] + ends[1]) / 2)
            assert off < 0.05 * np.linalg.norm(ends[1] - ends[0])


def test_node_and_element_numbers_are_those_of_the_deck(stored):
    deck = CYLINDER.read_text()
    for keyword, ids, fields in (("*NODE", "PointData/node_id", 3), ("*ELEMENT", "", 9)):
        numbers = set()
        for block in re.split(r"^\*(?!\*)", deck, flags=re.MULTILINE):
            if not re.match(keyword[1:] + r"\s*(,|$)", block, re.IGNORECASE | re.MULTILINE):
                continue
            for card in block.splitlines()[1:]:
                if not card.startswith("**") and card.count(",") >= fields - 1:
                    numbers.add(int(card.split(",")[0]))
        ids = stored["VTKHDF/" + (ids or "CellData/element_id")][()]
        assert set(ids.tolist()) == numbers
        assert len(ids) == len(numbers)


def test_contact_fields_stand_on_both_faces_and_are_nan_elsewhere(stored):
    node_id = stored["VTKHDF/PointData/node_id"][()]
    (name,) = stored["contact"]
    contact = stored["contact"][name]
    for face in ("slave_node", "master_node"):
        points = [int(np.flatnonzero(node_id == node)[0]) for node in contact[face]]
        for quantity in ("pressure", "shear", "gap", "status", "conductance", "heat_flux"):
            field = stored[f"VTKHDF/PointData/contact_{quantity}"][()].reshape(INCREMENTS, NODES)
            np.testing.assert_array_equal(field[:, points], contact[quantity], err_msg=quantity)
            assert np.count_nonzero(~np.isnan(field)) == INCREMENTS * 2 * PAIRS


def test_von_mises_is_that_of_the_stress(stored):
    xx, yy, zz, xy = stored["VTKHDF/PointData/stress"][()].T
    expected = np.sqrt(((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) / 2 + 3 * xy**2)
    np.testing.assert_allclose(stored["VTKHDF/PointData/von_mises"], expected, rtol=1e-12)


def test_datasets_have_the_shapes_that_are_promised(stored):
    shapes = {
        (): (
            "time load iterations heat_in heat_out heat_imbalance heat_imbalance_pointwise"
            " force_imbalance",
            "history",
        ),
        (PAIRS,): (
            "gap pressure shear slip status conductance heat_flux slave_temperature"
            " master_temperature",
            "contact/{}",
        ),
        (4,): ("edges_contact edges_stick", "contact/{}"),
        None: ("normal_force shear_force heat_rate edge_contact edge_stick", "contact/{}"),
    }
    (name,) = stored["contact"]
    for width, (datasets, group) in shapes.items():
        for dataset in datasets.split():
            shape = stored[f"{group.format(name)}/{dataset}"].shape
            assert shape == (INCREMENTS, *(width or ())), dataset
    for dataset in ("slave_node", "master_node", "x", "y", "s", "weight"):
        assert stored[f"contact/{name}/{dataset}"].shape == (PAIRS,)
    status = stored[f"contact/{name}/status"]
    assert status.dtype.kind == "i"
    assert set(np.unique(status)) == {0, 1, 2}
    assert stored["VTKHDF/PointData/displacement"].shape == (INCREMENTS * NODES, 3)
    assert stored["VTKHDF/PointData/stress"].shape == (INCREMENTS * NODES, 4)
    assert stored["history/load"].attrs["label"]


def test_pairs_are_ordered_along_the_surface(stored):
    (name,) = stored["contact"]
    contact = stored["contact"][name]
    assert contact["s"][0] == 0.0
    assert np.all(np.diff(contact["s"]) > 0)
    assert contact["x"][0] < contact["x"][-1]


def test_one_row_an_iteration_in_file_and_cvg(results, stored):
    rows = stored["convergence"]
    counts = np.bincount(rows["increment"][()], minlength=INCREMENTS + 1)[1:]
    np.testing.assert_array_equal(counts, stored["history/iterations"])
    lines = (results / "cylinder.cvg").read_text().splitlines()[1:]
    assert len(lines) == len(rows["residual"])
    for line, increment, iteration in zip(lines, rows["increment"], rows["iteration"], strict=True):
        assert line.split()[:2] == [str(increment), str(iteration)]


def test_sta_has_one_line_an_increment_under_a_heading(results):
    assert increments_in(results / "cylinder.sta") == list(range(1, INCREMENTS + 1))
    assert not (results / "cylinder.sta").read_text()[0].isdigit()


def test_the_file_holds_the_card_images_and_the_run(results, stored):
    cards = stored["deck"].asstr()[()].tolist()
    assert cards == (results / "cylinder.inp").read_text().splitlines()
    run_attributes = stored["run"].attrs
    assert run_attributes["solver"].upper() == "SKYLINE"
    thermal, mechanical = NODES - ENDS, 2 * NODES - ENDS - AXIS
    assert run_attributes["equations_thermal"] == thermal
    assert run_attributes["equations_mechanical"] == mechanical
    # Jumps, gaps and slips; both nodes on the axis are held along it.
    assert run_attributes["contact_unknowns"] == 3 * PAIRS - 1
    diagonals, triangles = (sum(f(n) for n in (thermal, mechanical))
                            for f in (lambda n: n, lambda n: n * (n + 1) // 2))
    assert 8 * diagonals < run_attributes["factor_bytes"] < 8 * triangles
    assert 0 < run_attributes["smallest_pivot"] <= 1
    for name in "read assemble reduce iterate recover write".split():
        assert run_attributes[f"seconds_{name}"] > 0, name
    for name in "heat contact friction coupling".split():
        assert name in run_attributes["modelled"]
    checks = sum(line.endswith((" PASS", " FAIL")) for line in listing_of(results))
    assert run_attributes["verify_passed"] == checks > 0
    assert run_attributes["verify_failed"] == 0
    assert run_attributes["version"]


def listing_of(results):
    """Return the lines of the listing."""
    return (results / "cylinder.lst").read_text().splitlines()


def test_the_zone_diagram_of_the_listing_is_the_status(results, stored):
    lines = listing_of(results)
    assert max(map(len, lines)) <= 132
    first = next(i for i, line in enumerate(lines) if line.startswith("ZONE DIAGRAM"))
    rows = [line.split() for line in lines[first:lines.index("SECONDS")]
            if re.match(r" *\d+ +\S+ +I", line)]
    (name,) = stored["contact"]
    numerals = np.array(["I", "II", "III"])[stored[f"contact/{name}/status"]]
    assert [row[2:] for row in rows] == numerals.tolist()
    assert [float(row[1]) for row in rows] == pytest.approx(stored["history/load"][()], rel=1e-5)


def test_two_runs_give_the_same_numbers(results, stored, tmp_path):
    deck = tmp_path / "cylinder.inp"
    shutil.copy(CYLINDER, deck)
    assert run(deck) == (0, "")
    with h5py.File(tmp_path / "cylinder.vtkhdf") as other:

        def compare(name, item):
            if isinstance(item, h5py.Dataset):
                np.testing.assert_array_equal(item[()], other[name][()], err_msg=name)

        stored.visititems(compare)


def test_a_check_that_fails_is_exit_status_4(tmp_path):
    cards = ['*VERIFY, KIND=ANALYTIC, SOURCE="wrong on purpose"', "time, , LAST, 901., 1E-6, REL"]
    deck = write_deck(tmp_path / "wrong.inp", cards)
    status, _ = run(deck)
    assert status == 4
    with h5py.File(tmp_path / "wrong.vtkhdf") as file:
        assert file["run"].attrs["verify_failed"] == 1
        assert len(file["history/time"]) == INCREMENTS


def test_a_run_without_an_increment_sets_the_older_result_aside(results, tmp_path):
    deck = write_deck(tmp_path / "cylinder.inp", ["*FIXED POINT, MAXITER=1, TOL=1E-14"])
    older = results / "cylinder.vtkhdf"
    shutil.copy(older, tmp_path)
    shutil.copy(results / "cylinder.sta", tmp_path)
    status, said = run(deck)
    assert status == 2, said
    assert not (tmp_path / "cylinder.vtkhdf").exists()
    assert (tmp_path / "cylinder.earlier.vtkhdf").read_bytes() == older.read_bytes()
    assert increments_in(tmp_path / "cylinder.earlier.sta") == list(range(1, INCREMENTS + 1))
    assert increments_in(tmp_path / "cylinder.cvg")
    assert set(increments_in(tmp_path / "cylinder.cvg")) == {1}
    assert "ENDED EARLY" in (tmp_path / "cylinder.lst").read_text()


def every_dataset(file):
    """Return all datasets of an open file by their paths."""
    found = {}
    file.visititems(lambda name, item: found.update({name: item})
                    if isinstance(item, h5py.Dataset) else None)
    return found


def test_every_dataset_says_what_it_is_and_the_document_says_the_same(results):
    document = (DOCS / "results.md").read_text()
    (field_of_faces,) = re.findall(r"^\| `contact_<quantity>` .*", document, re.MULTILINE)
    for name in ("cylinder.vtkhdf", "cylinder.contact.vtkhdf"):
        with h5py.File(results / name) as file:
            for path, dataset in every_dataset(file).items():
                said, unit = dataset.attrs["description"], dataset.attrs["unit"]
                assert said and unit, path
                if dataset.ndim == 2 and dataset.shape[1] in (3, 4) and "edges_" not in path:
                    components = dataset.attrs.get("components", "x y z").split()
                    assert len(components) == dataset.shape[1], path
                group, _, last = path.rpartition("/")
                if group == "":
                    continue
                if group.startswith("errors/"):  # the former name, which comes first
                    assert dataset == file[path.replace("errors", "uncertainty", 1)]
                    words = "value and its numerical uncertainty (95 %), with its parts"
                    assert f"`{last}`" in document and words in document
                    assert said.startswith((words, "reason for")), path
                    continue
                if path.startswith("VTKHDF/") and not group.endswith(("PointData", "CellData")):
                    place = path.removeprefix("VTKHDF/")
                    named = f"{group}/<quantity>" if group.endswith("Offsets") else place
                    named = named.removeprefix("VTKHDF/")
                    rows = [row for row in document.splitlines() if row.startswith("| `")
                            and (f"`{named}`" in row or f"`{last}`" in row)]
                    assert rows, path
                    constant = said.startswith("offset 0")
                    assert constant or any(f"| {said} |" in row for row in rows), path
                    continue
                if (group, name) == ("VTKHDF/PointData", "cylinder.contact.vtkhdf"):
                    assert f"| `{last}` |" in document
                    continue
                if group == "VTKHDF/PointData" and last.startswith("contact_"):
                    of_points = file[f"contact/FACE/{last.removeprefix('contact_')}"]
                    assert said == of_points.attrs["description"] + "; on both faces, else NaN"
                    assert f"`{last.removeprefix('contact_')}`" in field_of_faces
                    continue
                assert re.search(rf"^\| `{last}` .*\| {re.escape(said)}[ |(]", document,
                                 re.MULTILINE), path


# A step that stores heat, of which strains take up a part.
STRETCHED = """*RESTART, WRITE
*PHYSICAL CONSTANTS, ABSOLUTE ZERO=-273.15
*NODE, NSET=ALL
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*ELEMENT, TYPE=CPE4, ELSET=BODY
1, 1, 2, 3, 4
*MATERIAL, NAME=STEEL
*ELASTIC
2.1E11, 0.3
*EXPANSION
1.2E-5
*CONDUCTIVITY
50.
*DENSITY
7800.
*SPECIFIC HEAT
460.
*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL
*INITIAL CONDITIONS, TYPE=TEMPERATURE
ALL, 20.
*STEP
*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT, DILATATION=YES
0.5, 1.
*BOUNDARY
1, 1, 2
2, 2
4, 1
*CLOAD
3, 2, 1.E6
*END STEP
"""


RUBBED = """*NODE, NSET=ALL
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
5, 0., 1.
6, 1., 1.
7, 1., 2.
8, 0., 2.
*ELEMENT, TYPE=CPE4, ELSET=BODIES
1, 1, 2, 3, 4
2, 5, 6, 7, 8
*SURFACE, NAME=LOWER
1, S3
*SURFACE, NAME=UPPER
2, S1
*MATERIAL, NAME=STEEL
*ELASTIC
2.1E11, 0.3
*CONDUCTIVITY
50.
*DENSITY
7800.
*SPECIFIC HEAT
460.
*SOLID SECTION, ELSET=BODIES, MATERIAL=STEEL
*SURFACE INTERACTION, NAME=DRY
*FRICTION
0.2
*GAP CONDUCTANCE
1000., 0.
*GAP HEAT GENERATION
1., 0.5, 3.
*CONTACT PAIR, INTERACTION=DRY, NAME=FACE
UPPER, LOWER
*STEP
*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE
1., 1.
*STABILITY
*NODE PRINT, TOTALS=YES
U, NT, RF, RFL
*EL PRINT
S, HFL
*BOUNDARY
1, 1, 2
2, 2
8, 1
1, 11
2, 11
*DLOAD
2, P3, 1.E6
*END STEP
"""


def of_the_file(document):
    """Return a document without its section on what is printed and in no file."""
    return re.sub(r"^## One JSON document.*?(?=^## )", "", document, flags=re.DOTALL | re.MULTILINE)


def test_the_file_has_all_that_the_document_tells(results, tmp_path):
    """Names in the first columns of its tables are datasets, or attributes of /run."""
    shutil.copy(EXAMPLES / "press_fit.inp", tmp_path)
    shutil.copy(EXAMPLES / "press_fit.mesh", tmp_path)
    for ending in "inp", "mesh":
        shutil.copy(EXAMPLES / f"bolted_flange.{ending}", tmp_path)
    shutil.copy(EXAMPLES / "free_fit.inp", tmp_path)
    for name in "bolted_flange", "free_fit":
        status, said = run(tmp_path / f"{name}.inp")
        assert status == 0, said
    status, said = run(tmp_path / "press_fit.inp", "--accuracy", "1%")
    assert status == 0, said
    rods = EXAMPLES.parent / "rods"
    branch = (rods / "r1.inp").read_text().replace("INPUT=", f"INPUT={rods}/").split("*VERIFY")[0]
    branch = "*OPTIONS, WIDTH=300\n" + branch.replace(", DIRECT\n1., 1.", "\n0.5, 1.\n*CONTINUATION")
    tube = (EXAMPLES / "autofrettage.inp").read_text().split("*VERIFY")[0]
    creeping = tube.replace("*SOLID SECTION", "*CREEP, LAW=NORTON\n1.E-20, 5., 0.\n*SOLID SECTION").replace(
        "*STATIC\n0.1, 1.", "*VISCO\n0.1, 1.\n*EL PRINT\nPEEQ, PE, CEEQ, CE", 1)
    worn = RUBBED.replace("*FRICTION", "*WEAR\n1.E-9\n*FRICTION", 1).replace("*STABILITY\n", "").replace(
        "NAME=FACE", "NAME=FACE, SLIDING=FINITE")
    melting = STRETCHED.replace("*SOLID SECTION", "*LATENT HEAT\n1., 1.E3, 2.E3\n*SOLID SECTION", 1)
    die = (EXAMPLES / "hot_die.inp").read_text().replace("MPa W C", "MPa W C s", 1)
    for name, deck in (("stretched", STRETCHED), ("die", die), ("rubbed", RUBBED), ("branch", branch), ("creeping", creeping),
                       ("melting", melting), ("worn", worn)):
        (tmp_path / f"{name}.inp").write_text(deck)
        status, said = run(tmp_path / f"{name}.inp")
        assert status == 0, said
    names = set()
    for path in (results / "cylinder.vtkhdf", results / "cylinder.contact.vtkhdf",
                 *(tmp_path / f"{name}.vtkhdf" for name in ("press_fit", "bolted_flange", "free_fit",
                                                            "stretched", "rubbed", "branch", "creeping",
                                                            "melting", "worn", "die"))):
        with h5py.File(path) as file:
            names |= {name.rpartition("/")[2] for name in every_dataset(file)}
            names |= set(file["run"].attrs) if "run" in file else set()
            names |= set(file["VTKHDF/Steps"])  # some are links to others
    text = of_the_file((DOCS / "results.md").read_text())
    told = [name for row in re.findall(r"^\| (`.*?) \|", text, re.MULTILINE)
            for name in re.findall(r"`([^`]+)`", row)]
    assert len(told) > 90
    for name in told:
        last = name.rpartition("/")[2]
        assert last in names or "<" in last or last.replace("..._", "seconds_") in names, name


def test_units_are_those_of_the_deck(stored):
    units = {"history/load": "C", "history/heat_in": "W", "contact/FACE/pressure": "MPa",
             "contact/FACE/weight": "cm^2", "contact/FACE/normal_force": "MPa cm^2",
             "contact/FACE/conductance": "W/(cm^2 C)", "VTKHDF/PointData/heat_flux": "W/cm^2",
             "VTKHDF/Points": "cm", "history/heat_imbalance": "-"}
    assert {path: stored[path].attrs["unit"] for path in units} == units
    assert stored["run"].attrs["format_version"] == 1


BLOCK = """*NODE, NSET=ALL
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*NSET, NSET=TEMPERATURE_FACE
3, 4
*ELEMENT, TYPE=CPE4, ELSET=ALL
1, 1, 2, 3, 4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*EXPANSION
1.E-5
*CONDUCTIVITY
1.
*SOLID SECTION, ELSET=ALL, MATERIAL=M
*INITIAL CONDITIONS, TYPE=TEMPERATURE
ALL, 20.
*STEP
*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE
0.5, 1.
*BOUNDARY
1, 1, 2
2, 2
2, 11, 11, 20.
TEMPERATURE_FACE, 2, 2, 0.01
TEMPERATURE_FACE, 11, 11, 80.
*END STEP
"""


def test_a_title_is_that_of_the_deck_and_not_of_its_mesh(tmp_path):
    """As gmsh writes one."""
    mesh, rest = BLOCK.split("*MATERIAL", 1)
    (tmp_path / "block.mesh").write_text(f"*Heading\n block.mesh\n{mesh}")
    for heading in ("", "*HEADING\nA block\n"):
        deck = tmp_path / "block.inp"
        deck.write_text(f"*INCLUDE, INPUT=block.mesh\n{heading}*MATERIAL{rest}")
        assert run(deck)[0] == 0
        with h5py.File(tmp_path / "block.vtkhdf") as file:
            assert file["run"].attrs["heading"] == heading[9:].strip()


def test_a_drawing_is_in_the_file_with_its_body_on_the_left_and_follows_its_nodes(tmp_path):
    """The die of the example: flat from -24 to 24, edges rounded by 4, 10 high, moved and turned."""
    deck = tmp_path / "die.inp"
    text = (EXAMPLES / "hot_die.inp").read_text().split("*END STEP")[0] + "*END STEP\n"
    deck.write_text(text.replace("9000, 6", "9000, 6, 6, 1.E-4"))
    status, said = run(deck)
    assert status == 0, said
    with Result(tmp_path / "die.vtkhdf") as result:
        last = len(result.field_times) - 1
        (((points, group),), (shown,)) = surfaces(result), lines_of(result, last)
        _, displacement, rotation = motion_of(result, group, last)
    np.testing.assert_allclose(points[[0, -1]], [[-28.0, 10.0], [28.0, 10.0]])
    flat = np.abs(points[:, 0]) < 24.0
    assert not points[flat, 1].any() and np.all(np.diff(points[:, 0]) >= -1e-12), "the body is above"
    edge = points[points[:, 0] > 24.0]
    edge = edge[edge[:, 1] < 4.0]
    np.testing.assert_allclose(np.hypot(edge[:, 0] - 24.0, edge[:, 1] - 4.0), 4.0, rtol=1e-9)
    assert displacement[1] == pytest.approx(-0.005) and rotation == pytest.approx(1e-4)
    arms = points - [0.0, 10.0]
    np.testing.assert_allclose(shown - points, displacement + 1e-4 * np.stack((-arms[:, 1], arms[:, 0]), 1),
                               rtol=0.0, atol=1e-14)


@pytest.mark.parametrize(("options", "unit", "shown"), [
    ('LOAD=TEMPERATURE_FACE,2, UNITS="mm MPa W K"', "mm", "Displacement y of TEMPERATURE_FACE (mm)"),
    ('LOAD=TEMPERATURE_FACE,11, UNITS="mm MPa W K"', "K", "Temperature of TEMPERATURE_FACE (K)"),
    ('UNITS="mm MPa W K"', "time", "Time"),
    ('UNITS="mm MPa W K s"', "s", "Time (s)"),
    ('LOAD=TEMPERATURE_FACE,2', "length", "Displacement y of TEMPERATURE_FACE"),
    ('LOAD=TEMPERATURE_FACE,11', "temperature", "Temperature of TEMPERATURE_FACE"),
])
def test_the_load_axis_has_the_unit_of_what_it_follows(tmp_path, options, unit, shown):
    deck = tmp_path / "block.inp"
    deck.write_text(f"*OPTIONS, {options}\n{BLOCK}")
    assert run(deck)[0] == 0
    with Result(tmp_path / "block.vtkhdf") as result:
        assert result.file["history/load"].attrs["unit"] == unit
        assert result.units.load_label(result.load_label) == shown


@pytest.mark.parametrize("step", [0, INCREMENTS - 1])
def test_vtk_reads_the_contact_faces_as_lines_with_their_quantities(results, stored, step):
    reader = vtkHDFReader()
    reader.SetFileName(str(results / "cylinder.contact.vtkhdf"))
    reader.UpdateInformation()
    times, grid = grid_at(reader, step)
    face = stored["contact/FACE"]
    assert list(times) == list(stored["history/time"])
    assert (grid.GetNumberOfPoints(), grid.GetNumberOfCells()) == (PAIRS, PAIRS - 1)
    assert {grid.GetCellType(cell) for cell in range(PAIRS - 1)} == {LINE}
    xy = vtk_to_numpy(grid.GetPoints().GetData())
    np.testing.assert_array_equal(xy[:, :2], np.transpose([face["x"], face["y"]]))
    points = arrays_of(grid.GetPointData())
    assert points.keys() == {name for name, item in face.items()
                             if item.shape[-1] == PAIRS}
    for name, values in points.items():
        assert np.isfinite(values).all(), name
        expected = face[name][()]
        np.testing.assert_array_equal(values, expected if expected.ndim == 1 else expected[step])


def test_principal_radial_and_hoop_stresses_are_those_of_the_tensor(stored):
    data = stored["VTKHDF/PointData"]
    xx, yy, zz, xy = data["stress"][-NODES:].T
    tensors = np.zeros((NODES, 3, 3))
    tensors[:, 0, 0], tensors[:, 1, 1], tensors[:, 2, 2] = xx, yy, zz
    tensors[:, 0, 1] = tensors[:, 1, 0] = xy
    principal = np.linalg.eigvalsh(tensors)[:, ::-1]
    scale = np.abs(tensors).max()
    np.testing.assert_allclose(data["principal_stress"][-NODES:], principal, atol=1e-12 * scale)
    x, y = stored["VTKHDF/Points"][:, :2].T
    angle = np.arctan2(y, x)
    radial = np.transpose([np.cos(angle), np.sin(angle), 0 * x])
    around = np.transpose([-np.sin(angle), np.cos(angle), 0 * x])
    for name, along in (("radial_stress", radial), ("hoop_stress", around)):
        expected = np.einsum("ni,nij,nj->n", along, tensors, along)
        np.testing.assert_allclose(data[name][-NODES:], expected, atol=1e-12 * scale)
