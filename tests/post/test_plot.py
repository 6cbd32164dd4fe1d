"""post/plot: every picture and table is written, tables hold the file's values, errors are told."""

import csv
import re
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

POST = Path(__file__).resolve().parents[2] / "post"
sys.path.insert(0, str(POST.parent / "python"))

from matplotlib.collections import LineCollection, PolyCollection, QuadMesh  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
import program  # noqa: E402
from synthetic import (  # noqa: E402
    FRICTION,
    edge_of_contact,
    edge_of_stick,
    errors_at,
    write_result,
)

from thercon.post import element_fields, field_colours, fields, mesh  # noqa: E402
from thercon.post import profile_legends, profiles, style, tables, trade, zones  # noqa: E402
from thercon.post.cells import Cells  # noqa: E402
from thercon.post.cli import main, parser, spread  # noqa: E402
from thercon.post.errors import UserError  # noqa: E402
from thercon.post.fine_mesh import refine  # noqa: E402
from thercon.post.overlay import read_overlays  # noqa: E402
from thercon.post.result import Result  # noqa: E402
from thercon.post.units import Units, unit_of  # noqa: E402
from thercon.post.words import known_name  # noqa: E402


@pytest.fixture
def draw(tmp_path, capsys):
    """Return a function that calls plot with --out and gives the names of the files written."""

    def call(*arguments):
        csv = [] if arguments[0] == "trade" else ["--csv"]
        status = main([*map(str, arguments), *csv, "--out", str(tmp_path / "out")])
        captured = capsys.readouterr()
        assert status == 0, captured.err
        written = [Path(line) for line in captured.out.splitlines()]
        for path in written:
            assert path.parent == tmp_path / "out"
            assert path.stat().st_size > 0
        return [path.name for path in written]

    return call


@pytest.fixture
def unrendered(monkeypatch):
    """Write a text in place of every picture: rendering takes most of the time."""
    monkeypatch.setattr(Figure, "savefig",
                        lambda self, path, **options: path.write_text("not rendered"))


@pytest.fixture
def unnamed(monkeypatch):
    """Leave the names of regions out of zone diagrams: to find their places lays the figure out."""
    monkeypatch.setattr(zones, "name_regions", lambda picture, axes: None)


@pytest.fixture
def tabulate(unrendered, unnamed, draw):
    """Return draw for tests of names and tables: figures are made, but not rendered."""
    return draw


def keeper(draw, monkeypatch, before_write=lambda figure: None):
    """Return a function that calls plot and gives the figures drawn."""

    def call(*arguments):
        figures, write = [], style.write

        def keep(figure, *rest):
            figures.append(figure)
            before_write(figure)
            return write(figure, *rest)

        with monkeypatch.context() as patch:
            patch.setattr(style, "write", keep)
            draw(*arguments)
        return figures

    return call


@pytest.fixture
def kept(unrendered, unnamed, draw, monkeypatch):
    """Return a keeper for tests of what figures contain."""
    return keeper(draw, monkeypatch)


@pytest.fixture
def laid_out(unrendered, draw, monkeypatch):
    """Return a keeper for tests of places, which are those on paper; it takes twice as long."""
    # Places in dots are those of the figure, not of the file.
    return keeper(draw, monkeypatch, Figure.draw_without_rendering)


@pytest.fixture
def fail(capsys):
    """Return a function that calls plot, expects exit status 2, and gives the message."""

    def call(*arguments):
        assert main([*map(str, arguments)]) == 2
        captured = capsys.readouterr()
        assert captured.err.startswith("plot: error: ")
        assert captured.err.count("\n") == 1
        return captured.err

    return call


def table(tmp_path, name):
    """Return a written table as {column: list of texts}."""
    with open(tmp_path / "out" / name, newline="") as file:
        rows = list(csv.DictReader(file))
    return {column: [row[column] for row in rows] for column in rows[0]}


def numbers(column):
    """Return a column of a table as numbers."""
    return np.array(column, dtype=float)


def three(name):
    """Return the files of one picture."""
    return [f"{name}.{kind}" for kind in ("png", "svg", "csv")]


def test_mesh_is_drawn_with_the_coordinates_of_the_file(draw, result, tmp_path):
    assert draw("mesh", result) == three("case.mesh")
    drawn = table(tmp_path, "case.mesh.csv")
    with h5py.File(result) as file:
        points = file["VTKHDF/Points"][()]
        connectivity = file["VTKHDF/Connectivity"][()]
    np.testing.assert_array_equal(numbers(drawn["node"]), connectivity + 1)
    np.testing.assert_array_equal(numbers(drawn["x"]), points[connectivity, 0])
    np.testing.assert_array_equal(numbers(drawn["y"]), points[connectivity, 1])


def test_the_legend_of_a_mesh_without_contact_leaves_the_axis_label_free(laid_out, tmp_path):
    path = tmp_path / "alone.vtkhdf"
    write_result(path, contacts=())
    (figure,) = laid_out("mesh", path)
    label = figure.axes[0].xaxis.label.get_window_extent()
    assert figure.legends[0].get_window_extent().y1 < label.y0


def test_the_slave_face_is_seen_below_the_master_face_where_both_touch(kept, result):
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        nodes = {key: contact[key][()] - 1 for key in ("slave_node", "master_node")}
        points = file["VTKHDF/Points"]
        points[nodes["slave_node"]] = points[nodes["master_node"], :]
    (figure,) = kept("mesh", result)
    assert len(figure.axes) == 2
    for axes in figure.axes:
        faces = [each for each in axes.collections if each.get_zorder() == 3]
        slave, master = (each.get_linewidth()[0] for each in faces)
        assert slave > 1.5 * master
    slave, master = (line.get_markersize() for line in figure.axes[1].lines)
    assert slave > 1.5 * master
    drawn = [line for line in figure.legends[0].get_lines() if line.get_marker() != "None"]
    assert drawn[0].get_linewidth() > 1.5 * drawn[1].get_linewidth()


def test_the_close_up_of_a_wide_model_is_named_clear_of_its_frame(laid_out, result):
    with h5py.File(result, "r+") as file:
        file["VTKHDF/Points"][:, 0] *= 4.0
    (figure,) = laid_out("mesh", result)
    (name,) = figure.axes[0].texts
    (window,) = figure.axes[0].patches
    assert name.get_text() == "(b)"
    gap = name.get_window_extent().y0 - window.get_window_extent().y1
    assert 0.0 < gap < 5.0
    whole, close = (axes.get_tightbbox() for axes in figure.axes)
    assert 0.0 < whole.y0 - close.y1 < 0.5 * figure.dpi


@pytest.mark.parametrize("columns", [10, 41])
def test_a_close_up_of_the_whole_model_is_left_out(laid_out, tmp_path, columns):
    path = tmp_path / "flat.vtkhdf"
    write_result(path, columns=columns)
    with h5py.File(path, "r+") as file:
        file["contact/CYLINDER/status"][...] = 1
        file["VTKHDF/Points"][:, 1] *= 0.1
    (figure,) = laid_out("mesh", path)
    (axes,) = figure.axes
    assert not axes.texts and not axes.get_title(loc="left")
    marked = [line.get_marker() for line in axes.lines]
    assert marked == (["o", "s"] if columns == 10 else [])  # 83 nodes are too many
    named = [line.get_marker() for line in figure.legends[0].get_lines()]
    assert named == (marked or ["None", "None"])
    gap = axes.get_tightbbox().y0 - figure.legends[0].get_window_extent().y1
    assert 0.0 < gap < 0.5 * figure.dpi


@pytest.mark.parametrize("loads", [[540], [180, 360, 540]])
def test_profiles_at_chosen_loads_hold_the_values_of_the_file(tabulate, result, tmp_path, loads):
    name = "-".join(["case.profiles", *map(str, loads)])
    assert tabulate("profiles", "--load", *loads, result) == three(name)
    drawn = table(tmp_path, f"{name}.csv")
    with h5py.File(result) as file:
        rows = [int(np.flatnonzero(file["history/load"][()] == load)[0]) for load in loads]
        contact = file["contact/CYLINDER"]
        for key in ("pressure", "shear", "heat_flux", "status"):
            np.testing.assert_array_equal(numbers(drawn[key]), contact[key][()][rows].ravel())
        np.testing.assert_array_equal(numbers(drawn["x"]), np.tile(contact["x"][()], len(rows)))
        pressure = contact["pressure"][()][rows].ravel()
    np.testing.assert_array_equal(numbers(drawn["mu_p"]), FRICTION * pressure)


def test_profiles_of_faces_that_wear_have_a_panel_for_the_depth(kept, result, tmp_path):
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        depth = 1e-3 * contact["pressure"][()]
        contact["wear_slave"], contact["wear_master"] = depth, 0.0 * depth
    (figure,) = kept("profiles", result)
    axes = figure.axes[-1]
    assert axes.get_ylabel().startswith("Wear of the slave")
    curves = [line.get_ydata() for line in axes.get_lines() if len(line.get_ydata()) > 2]
    assert np.max(np.concatenate(curves)) == depth[-1].max()
    drawn = table(tmp_path, "case.profiles.csv")
    np.testing.assert_array_equal(numbers(drawn["wear_slave"]), depth[-1])


def test_profiles_are_of_the_last_load_unless_said(tabulate, result, tmp_path):
    assert tabulate("profiles", result) == three("case.profiles")
    assert set(table(tmp_path, "case.profiles.csv")["load"]) == {"900.0"}


def test_load_can_be_given_more_than_once_and_increments_by_number(tabulate, result, tmp_path):
    tabulate("profiles", "--load", 60, "--load", 120, "--increment", 3, result)
    drawn = table(tmp_path, "case.profiles-60-120-180.csv")
    assert set(drawn["load"]) == {"60.0", "120.0", "180.0"}
    assert set(drawn["increment"]) == {"1", "2", "3"}


@pytest.mark.parametrize("points", [1, 2])
def test_a_face_of_one_or_two_contact_points_is_drawn(tabulate, tmp_path, points):
    path = tmp_path / "case.vtkhdf"
    write_result(path, loads=(300.0, 900.0))
    with h5py.File(path, "r+") as file:
        contact = file["contact/CYLINDER"]
        for name, values in {name: item[()] for name, item in contact.items()}.items():
            if not name.startswith("edge"):
                del contact[name]
                contact[name] = values[..., :points]
    for picture in ("profiles", "zones"):
        tabulate(picture, path)
    drawn = table(tmp_path, "case.profiles.csv")
    with h5py.File(path) as file:
        pressure = file["contact/CYLINDER/pressure"][-1]
    np.testing.assert_array_equal(numbers(drawn["pressure"]), pressure)


def test_courses_are_means_and_ranges_over_the_face_and_the_rates_of_the_model(draw, result, tmp_path):
    with h5py.File(result, "r+") as file:
        contact, history = file["contact/CYLINDER"], file["history"]
        count = len(history["time"])
        history["heat_in"] = np.linspace(5.0, 1.0, count)
        history["heat_friction"] = np.linspace(0.5, 2.0, count)
        history["heat_stored"] = np.where(np.arange(count) < 1, np.nan, 0.5)  # a step stores none
        history["heat_out"] = np.full(count, 1e-9)  # rounding, which has no curve
        pressure, weight = contact["pressure"][()], contact["weight"][()]
        gap = contact["gap"][()]
    assert draw("courses", result) == three("case.courses")
    drawn = table(tmp_path, "case.courses.csv")
    assert not {"heat_out_of_it", "temperature_slave"} & set(drawn)
    mean = (pressure * weight).sum(axis=1) / weight.sum()
    np.testing.assert_allclose(numbers(drawn["pressure"]), mean, rtol=1e-12)
    np.testing.assert_array_equal(numbers(drawn["pressure_max"]), pressure.max(axis=1))
    np.testing.assert_array_equal(numbers(drawn["gap_min"]), gap.min(axis=1))
    np.testing.assert_allclose(numbers(drawn["heat_into_the_model"]), np.linspace(5.0, 1.0, count))
    np.testing.assert_allclose(numbers(drawn["heat_of_friction"]), np.linspace(0.5, 2.0, count))
    assert np.isnan(numbers(drawn["heat_stored"])[0])


def test_courses_of_faces_that_wear_have_the_worn_volume(kept, result, tmp_path):
    with h5py.File(result, "r+") as file:
        volume = 1e-3 * file["history/load"][()]
        contact = file["contact/CYLINDER"]
        contact["worn_volume_slave"], contact["worn_volume_master"] = volume, 0.0 * volume
    (figure,) = kept("courses", result)
    (axes,) = [axes for axes in figure.axes if axes.get_ylabel() == "Worn volume (cm$^3$)"]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["slave"]
    np.testing.assert_array_equal(numbers(table(tmp_path, "case.courses.csv")["worn_slave"]), volume)


def test_courses_of_one_increment_are_points_and_their_ranges(kept, tmp_path):
    path = tmp_path / "case.vtkhdf"
    write_result(path, loads=(900.0,))
    (figure,) = kept("courses", path)
    pressure = figure.axes[0]
    assert {line.get_marker() for line in pressure.lines} == {"o"}
    (ranges,) = pressure.collections
    assert ranges.get_linewidth()[0] > 0


def test_legends_of_courses_hide_no_curve_and_no_title(laid_out, result):
    with h5py.File(result, "r+") as file:
        for k, name in enumerate(("in", "friction", "out", "stored", "dilatation")):
            file[f"history/heat_{name}"] = np.linspace(k, 1.0, len(file["history/time"]))
    (figure,) = laid_out("courses", result)
    (axes,) = [each for each in figure.axes if each.get_legend()]
    box, frame, title = (each.get_window_extent() for each in (axes.get_legend(), axes, axes._left_title))
    assert box.y0 >= frame.y1 - 5.0 and box.x0 > title.x1 and box.x1 < figure.bbox.x1


def test_pictures_may_share_a_range_of_values(kept, tabulate, fail, result):
    (figure,) = kept("profiles", result, "--values", "heat_flux", "-1", "2", "--values", "pressure", 0, 500)
    assert [axes.get_ylim() for axes in figure.axes] == [(0.0, 500.0), (-1.0, 2.0)]
    written = tabulate("profiles", result, "--values", "pressure", 0, 500)
    assert written == three("case.profiles-pressure-0-500")
    assert "no panel shows 'presure', nearest: 'pressure'" in fail(
        "profiles", result, "--values", "presure", 0, 500)
    for ends in ((5, 0), (0, "x"), (1, 1), (0, "nan")):
        assert "is no range from LOW to HIGH" in fail("profiles", result, "--values", "pressure", *ends)


def test_two_dozen_bodies_have_tints_of_their_own():
    tints = np.array([style.body_tint(k) for k in range(24)])
    apart = [np.abs(one - other).max() for k, one in enumerate(tints) for other in tints[:k]]
    assert min(apart) > 0.02 and tints.min() > 0.1


def test_bands_are_told_where_they_are_seen(kept, result):
    def words():
        (figure,) = kept("courses", result)
        return figure._supxlabel.get_text()

    assert words() == "Lines are means over the face, bands reach from the smallest to the largest value"
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        for key in ("pressure", "gap"):
            contact[key][...] = np.linspace(1.0, 2.0, len(contact[key]))[:, None]
        contact["heat_flux"][...] = 0.0
    assert words() == "Lines are means over the face"


@pytest.fixture
def turning(result):
    """Return a result whose load, a displacement, rises from 1 to 8 and falls to 1 again."""
    with h5py.File(result, "r+") as file:
        load = file["history/load"]
        load[...] = 8.0 - np.abs(np.arange(15.0) - 7.0)
        load.attrs["label"], load.attrs["unit"] = "u_y of PIN_A-1", "cm"
    return result


@pytest.mark.parametrize("picture", ["courses", "history"])
def test_a_band_over_a_load_that_turns_is_filled_on_both_ways(kept, turning, picture):
    """Pressures from 1 to 2 going, from 1 to 3 coming back; so are those of a set of eight nodes."""
    with h5py.File(turning, "r+") as file:
        contact, count = file["contact/CYLINDER"], len(file["history/load"])
        high = np.where(np.arange(count) < 7, 2.0, 3.0)[:, None]
        contact["pressure"][...] = 1.0 + (high - 1.0) * np.linspace(0.0, 1.0, contact["pressure"].shape[1])
        nodes = file.create_group("history/nodes/TOP")
        nodes["node"], nodes["time"] = np.arange(1, 9), file["history/time"][()]
        nodes["increment"] = np.arange(1, count + 1)
        nodes["temperature"] = 1.0 + (high - 1.0) * np.linspace(0.0, 1.0, 8)
    (figure,) = kept(picture, turning, "--over", "load")
    bands = figure.axes[0].collections
    assert len(bands) == 2
    for place, filled in (((4.0, 1.5), 2), ((4.0, 2.5), 1), ((4.0, 3.5), 0)):
        assert sum(path.contains_point(place) for band in bands for path in band.get_paths()) == filled
    assert figure.axes[0].get_xlabel() in ("", "Displacement y of PIN_A-1 (cm)")


def test_a_band_over_the_time_is_one(kept, result):
    (figure,) = kept("courses", result, "--over", "time")
    assert len(figure.axes[0].collections) == 1


@pytest.mark.parametrize("picture", ["courses", "history"])
def test_a_deck_without_a_load_has_no_courses_over_it(fail, result, picture, tmp_path):
    with h5py.File(result, "r+") as file:
        file["history/load"].attrs["label"] = "time"
        file["history/pre_tension"] = np.ones(15)
    said = fail(picture, result, "--over", "load", "--out", tmp_path)
    assert "the deck has no LOAD= on *OPTIONS" in said


def test_faces_that_slide_are_drawn_where_they_are_with_their_forces(tabulate, result, tmp_path):
    with h5py.File(result, "r+") as file:
        contact, points = file["contact/CYLINDER"], file["VTKHDF/PointData"]
        contact.attrs["sliding"] = "FINITE"
        contact["normal_force"] = np.arange(1.0, 1.0 + len(contact["pressure"]))
        points["displacement"][:, 0] = 3.0
        x = contact["x"][()]
        contact["gap"][0, 0] = np.nan   # no master is opposite
        contact["gap"][1, :] = np.nan
        gap, weight = contact["gap"][0, 1:], contact["weight"][1:]
    tabulate("profiles", result)
    np.testing.assert_allclose(numbers(table(tmp_path, "case.profiles.csv")["x"]), x + 3.0)
    tabulate("courses", result)
    forces = numbers(table(tmp_path, "case.courses.csv")["force_normal"])
    np.testing.assert_array_equal(forces, np.arange(1.0, 1.0 + len(forces)))
    gaps = [numbers(table(tmp_path, "case.courses.csv")[f"gap{end}"]) for end in ("", "_min", "_max")]
    np.testing.assert_allclose([each[0] for each in gaps],
                               [gap @ weight / weight.sum(), gap.min(), gap.max()])
    assert np.isnan([each[1] for each in gaps]).all() and np.isfinite([each[2:] for each in gaps]).all()
    with h5py.File(result, "r+") as file:
        del file["contact/CYLINDER"].attrs["sliding"]
    tabulate("profiles", result)
    np.testing.assert_array_equal(numbers(table(tmp_path, "case.profiles.csv")["x"]), x)


def test_rates_below_zero_are_drawn_on_a_logarithmic_axis_and_told(kept, result, tmp_path):
    """A body that cools stores less and less; what the axis does not show, the legend does not name."""
    with h5py.File(result, "r+") as file:
        history, count = file["history"], len(file["history/time"])
        history["heat_in"] = np.linspace(5.0, 1.0, count)
        history["heat_stored"] = stored = np.linspace(-4.0, -1.0, count)
        history["heat_dilatation"] = np.linspace(-1.0, 1.0, count)
        history["heat_out"] = np.full(count, 1e-4)  # below the three decades of the axis

    def rates(*options):
        (figure,) = kept("courses", result, *options)
        (axes,) = [each for each in figure.axes if each.get_ylabel() == "Heat rate (W)"]
        return axes, dict(zip([text.get_text() for text in axes.get_legend().get_texts()], axes.lines))

    axes, drawn = rates("--log")
    assert (tmp_path / "out" / "case.courses-log.png").exists()
    assert list(drawn) == ["into the model", "\N{MINUS SIGN}stored", "|taken up by strains|"]
    np.testing.assert_allclose(drawn["\N{MINUS SIGN}stored"].get_ydata(), -stored)
    low, high = axes.get_ylim()
    for line in drawn.values():
        assert ((low < line.get_ydata()) & (line.get_ydata() < high)).any()
    np.testing.assert_allclose(rates()[1]["stored"].get_ydata(), stored)


def test_of_a_load_that_occurs_twice_the_last_increment_is_drawn(tabulate, tmp_path):
    """Loading and unloading pass it; here unloading has other pressures and temperatures."""
    path = tmp_path / "case.vtkhdf"
    write_result(path, loads=(10.0, 20.0, 30.0, 20.0, 10.0))
    with h5py.File(path, "r+") as file:
        file["history/time"][...] = file["VTKHDF/Steps/Values"][...] = np.arange(1.0, 6.0)
        pressure, temperature = file["contact/CYLINDER/pressure"], file["VTKHDF/PointData/temperature"]
        pressure[3:] *= 0.5
        temperature[3 * len(temperature) // 5:] += 7.0
        pressures, temperatures = pressure[()], np.split(temperature[()], 5)
    for load, row in ((20, 3), (10, 4)):
        tabulate("profiles", path, "--load", load)
        drawn = table(tmp_path, f"case.profiles-{load}-increment-{row + 1}.csv")
        assert set(drawn["increment"]) == {str(row + 1)}
        np.testing.assert_array_equal(numbers(drawn["pressure"]), pressures[row])
        tabulate("fields", path, "--load", load, "--quantity", "temperature")
        drawn = table(tmp_path, f"case.fields-temperature-{load}-increment-{row + 1}.csv")
        np.testing.assert_array_equal(numbers(drawn["temperature"]), temperatures[row])
    tabulate("profiles", path, "--increment", 2)
    drawn = table(tmp_path, "case.profiles-20-increment-2.csv")
    np.testing.assert_array_equal(numbers(drawn["pressure"]), pressures[1])


def test_zone_curves_are_the_sharpened_edges_on_the_axis_of_the_picture(draw, result, tmp_path):
    assert draw("zones", result) == [*three("case.zones"), "case.zones-pairs.csv"]
    drawn = table(tmp_path, "case.zones.csv")
    load = numbers(drawn["load"])
    np.testing.assert_allclose(numbers(drawn["edge_contact"]), edge_of_contact(load), rtol=1e-12)
    np.testing.assert_allclose(numbers(drawn["edge_stick"]), edge_of_stick(load), rtol=1e-12)
    with h5py.File(result) as file:
        contact = file["contact/CYLINDER"]
        np.testing.assert_array_equal(numbers(drawn["s_edge_stick"]), contact["edge_stick"][()])
        pairs = table(tmp_path, "case.zones-pairs.csv")
        np.testing.assert_array_equal(numbers(pairs["status"]), contact["status"][()].ravel())


def test_zones_of_several_results_have_one_scale_of_places_and_one_legend(kept, tmp_path):
    paths = [tmp_path / "cold.vtkhdf", tmp_path / "hot.vtkhdf"]
    for path, loads in zip(paths, ((60.0, 120.0, 180.0), (300.0, 600.0, 900.0))):
        write_result(path, loads=loads)
    (figure,) = kept("zones", *paths)
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["(a) cold", "(b) hot"]
    assert figure.axes[0].get_ylim() == figure.axes[1].get_ylim()
    assert figure.axes[0].get_xlim() != figure.axes[1].get_xlim()
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert len(labels) == len(set(labels)) and "edge of stick" in labels
    drawn = table(tmp_path, "cold.zones-hot.csv")
    assert list(drawn["result"]) == 3 * ["cold"] + 3 * ["hot"]
    np.testing.assert_array_equal(numbers(drawn["load"]), [60.0, 120.0, 180.0, 300.0, 600.0, 900.0])


def test_zone_curves_along_s_are_those_of_the_file_and_keep_nan(tabulate, tmp_path):
    path = tmp_path / "case.vtkhdf"
    write_result(path, loads=(2.0, 300.0, 600.0))
    tabulate("zones", path, "--along", "s")
    drawn = table(tmp_path, "case.zones-along-s.csv")
    with h5py.File(path) as file:
        stick = file["contact/CYLINDER/edge_stick"][()]
    assert np.isnan(stick[0]) and not np.isnan(stick[1:]).any()
    np.testing.assert_array_equal(numbers(drawn["edge_stick"]), stick)


def split_contact(path):
    """Give a result a zone of contact that a gap parts for four increments: its edges are two, four,
    two. Return what is open, (increments, points)."""
    with h5py.File(path, "r+") as file:
        contact = file["contact/CYLINDER"]
        s, edges = contact["s"][()], np.full((15, 4), np.nan)
        status = np.zeros((15, len(s)), int)
        for row in range(15):
            zones = [(4, 7 - (row > 9)), (9 + (row > 10), 15)] if 8 <= row < 12 else [(4 - (row > 11), 15)]
            for number, (first, last) in enumerate(zones):
                status[row, first : last + 1] = 1
                middles = [0.5 * (s[k] + s[k + 1]) for k in (first - 1, last)]
                edges[row, 2 * number : 2 * number + 2] = middles
        contact["status"][...], contact["edges_contact"][...] = status, edges
        contact["edge_contact"][...] = np.nanmax(edges, axis=1)
        contact["edge_stick"][...] = contact["edges_stick"][...] = np.nan
    return status == 0


def test_an_edge_goes_on_at_its_zone_where_two_edges_become_four(kept, result):
    split_contact(result)
    with h5py.File(result) as file:
        edges, load = file["contact/CYLINDER/edges_contact"][()], file["history/load"][()]
    (figure,) = kept("zones", result, "--along", "s")
    lower, upper = edges[:, 0], np.nanmax(edges, axis=1)
    expected = [(load, lower), (load, upper), *((load[8:12], edges[8:12, k]) for k in (1, 2))]
    found = [line.get_xydata() for line in figure.axes[0].lines if line.get_linestyle() == "-"]
    assert len(found) == len(expected)
    for line, curve in zip(found, expected):
        np.testing.assert_allclose(line, np.transpose(curve), rtol=1e-12)


def test_zones_are_named_by_the_states_of_their_pairs(kept, result):
    """Open first, closed behind, with the edge on a pair that is closed."""
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        s = contact["s"][()]
        contact["status"][...] = np.where(np.arange(len(s)) < 8, 0, 1)
        contact["edges_contact"][...], contact["edges_stick"][...] = np.nan, np.nan
        contact["edges_contact"][:, 0] = s[8]
    (figure,) = kept("profiles", result, "--along", "s")
    words = {text.get_text(): text.xy[0] for text in figure.axes[0].texts}
    assert words["open"] < s[8] < words["slip"]


def test_no_curve_goes_from_a_piece_of_the_faces_to_the_next(kept, result):
    """Neither a profile nor an edge, which may be as near to one of the next piece."""
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        s = contact["s"][()]
        contact["piece"] = np.where(np.arange(len(s)) < 8, 1, 2)
        contact["status"][...], contact["edges_contact"][...] = 0, np.nan
        contact["status"][:, 4:8] = contact["status"][:, 8:12] = 1
        for row in range(15):
            ends = (4, 12) if row < 8 else (4, 13)
            contact["edges_contact"][row, :2] = [0.5 * (s[k - 1] + s[k]) for k in ends]
        contact["status"][8:, 12] = 1
    for picture in ("profiles", "zones"):
        (figure,) = kept(picture, result, "--along", "s")
        curves = [line for axes in figure.axes for line in axes.lines if line.get_linestyle() != "None"
                  and len(line.get_xdata()) > 2]
        places = [line.get_xdata() if picture == "profiles" else line.get_ydata() for line in curves]
        assert len(places) > 1
        for at in places:
            assert np.max(at) <= s[7] or np.min(at) >= s[8]


def test_an_edge_that_is_there_at_one_increment_is_seen(kept, result):
    with h5py.File(result, "r+") as file:
        edges = file["contact/CYLINDER/edges_stick"]
        edges[6, 1], edges[6, 2] = 0.5 * edges[6, 0], 0.7 * edges[6, 0]
        edges[6] = np.sort(edges[6])
    (figure,) = kept("zones", result)
    marks = [line for line in figure.axes[0].lines if line.get_marker() == "_"]
    assert [len(line.get_xdata()) for line in marks] == [1, 1]
    assert len({text.get_text() for text in figure.legends[0].get_texts()}) == 5


def test_zones_over_the_logarithm_of_the_load_show_the_first_increments(laid_out, fail, result):
    loads = np.geomspace(0.01, 300.0, 15)
    with h5py.File(result, "r+") as file:
        file["history/load"][...] = loads
    (figure,) = laid_out("zones", result, "--log")
    axes = figure.axes[0]
    assert axes.get_xscale() == "log"
    at = (axes.transData + axes.transAxes.inverted()).transform([(load, 0.0) for load in loads])[:, 0]
    assert (np.diff(at) > 0.05).all() and at[0] > 0.0 and at[-1] < 1.0
    frame = axes.get_window_extent()
    for name in axes.texts:
        box = name.get_window_extent()
        assert frame.x0 < box.x0 and box.x1 < frame.x1
    with h5py.File(result, "r+") as file:
        file["history/load"][0] = 0.0
    assert "increment 1 is at 0, which a logarithmic axis does not have" in fail("zones", result, "--log")


def test_the_left_edge_of_a_symmetric_contact_is_an_edge(kept, result):
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        contact["edges_contact"][:, 1] = contact["edge_contact"][()]
        contact["edges_contact"][:, 0] = left = 0.2 * contact["edge_contact"][()]
    (figure,) = kept("zones", result, "--along", "s")
    assert any(len(line.get_ydata()) == 15 and np.allclose(line.get_ydata(), left, rtol=1e-6)
               for line in figure.axes[0].lines)


def test_names_of_zones_stand_apart_inside_the_axes_where_there_are_results(laid_out, tmp_path):
    path = tmp_path / "late.vtkhdf"
    write_result(path, loads=(300.0, 450.0, 600.0, 750.0, 900.0))
    with h5py.File(path, "r+") as file:
        contact = file["contact/CYLINDER"]
        status = contact["status"][()]
        first = np.argmax(status == 0, axis=1)
        status[:, :] = np.where(np.arange(status.shape[1]) < first[:, None] - 1, 2, 0)
        status[np.arange(5), first - 1] = 1  # one pair slips: too narrow for its name
        contact["status"][...] = status
        contact["edge_stick"][...] = 0.9 * contact["edge_contact"][()]
    (figure,) = laid_out("zones", path)
    (axes,) = figure.axes
    boxes = [text.get_window_extent() for text in axes.texts]
    assert [text.get_text()[-4:] for text in axes.texts].count("slip") == 1
    inside = axes.get_window_extent()
    start = axes.transData.transform((300.0, 0.0))[0]
    for number, box in enumerate(boxes):
        assert start < box.x0 and box.x1 < inside.x1
        assert inside.y0 < box.y0 and box.y1 < inside.y1
        assert not any(box.overlaps(other) for other in boxes[:number])


@pytest.mark.parametrize("count", [5, 60])
def test_names_of_zones_cover_no_mark_where_there_is_room_between_them(laid_out, tmp_path, count):
    """Of a few loads, in whose middle is a column of marks; of many no edge."""
    path = tmp_path / "slip.vtkhdf"
    write_result(path, loads=tuple(np.linspace(300.0, 900.0, count)))
    with h5py.File(path, "r+") as file:
        contact = file["contact/CYLINDER"]
        contact["status"][...] = 1
        contact["status"][:, -1] = 0
        for key in ("edge_stick", "edges_contact", "edges_stick"):
            contact[key][...] = np.nan

    def name_and_marks(kinds):
        (figure,) = laid_out("zones", path)
        (axes,) = figure.axes
        marks = [axes.transData.transform(line.get_xydata()) for line in axes.lines
                 if line.get_marker() in kinds]  # fmt: skip
        (box,) = [text.get_window_extent() for text in axes.texts if text.get_text() == "II\nslip"]
        middle = np.mean(axes.transData.inverted().transform(box), axis=0)
        return middle, np.vstack(marks), box

    (_, place), marks, box = name_and_marks(".os")
    assert len(marks) == 21 * count and (count > 5 or box.count_contains(marks) == 0)
    with h5py.File(path, "r+") as file:
        contact = file["contact/CYLINDER"]
        contact["edges_contact"][:, 0], contact["edges_contact"][:, 1] = place, contact["s"][-3]
    (figure,) = laid_out("zones", path)
    (axes,) = figure.axes
    (box,) = [text.get_window_extent() for text in axes.texts if text.get_text() == "II\nslip"]
    y = axes.transData.transform((0.0, place))[1]
    assert not box.y0 < y < box.y1


def test_an_edge_of_stick_is_seen_where_it_is_the_edge_of_contact(kept, result):
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        for key in ("edge_{}", "edges_{}"):
            contact[key.format("stick")][...] = contact[key.format("contact")][()]
    (figure,) = kept("zones", result)
    lines = [line for line in figure.axes[0].lines if len(line.get_xdata()) == 15
             and line.get_linestyle() != "None"]  # fmt: skip
    assert [line.get_linestyle() for line in lines] == ["-", "--"]
    assert lines[1].get_linewidth() > 1.5 * lines[0].get_linewidth()
    handles = figure.legends[0].legend_handles[:2]
    assert [each.get_linewidth() for each in handles] == [each.get_linewidth() for each in lines]


def test_the_bound_of_friction_is_seen_where_friction_lies_on_it(kept, result):
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        contact["shear"][...] = -FRICTION * contact["pressure"][()]
    (figure,) = kept("profiles", result)
    handles = zip(figure.legends[0].get_texts(), figure.legends[0].legend_handles)
    width = {text.get_text(): handle.get_linewidth() for text, handle in handles}
    assert width[r"$\mu p$"] > 1.5 * width[r"friction $-\tau$"]
    drawn = [line.get_linewidth() for line in figure.axes[0].lines]
    assert drawn.count(width[r"$\mu p$"]) == 1


def test_a_traction_does_not_fall_to_zero_at_the_end_of_the_face(kept, result):
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        contact["status"][14], contact["pressure"][14] = 1, 50.0
        contact["edges_contact"][14] = [contact["s"][-1], np.nan, np.nan, np.nan]
    (figure,) = kept("profiles", result)
    curves = [line for line in figure.axes[0].lines if np.all(line.get_ydata() == 50.0)]
    assert [len(line.get_xdata()) for line in curves] == [21, 21], "the nodes and the line"


def test_a_point_that_is_both_edges_of_contact_is_a_peak(kept, result):
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        s, alone = contact["s"][()], np.arange(len(contact["s"])) == 7
        contact["status"][14], contact["pressure"][14] = alone, 50.0 * alone
        contact["edges_contact"][14] = [s[7], s[7], np.nan, np.nan]
        del contact["shear"]
    (figure,) = kept("profiles", result)
    (curve,) = [line for line in figure.axes[0].lines if len(line.get_xdata()) == 23]
    assert curve.get_ydata()[6:11].tolist() == [0.0, 0.0, 50.0, 0.0, 0.0]


def test_a_digitised_figure_has_a_legend_entry_for_each_of_its_curves(kept, result, tmp_path):
    figure = tmp_path / "fig3.csv"
    figure.write_text("load,edge_contact,edge_stick\n100,2.5,1\n900,7.5,4\n")
    (drawn,) = kept("zones", result, "--with", figure)
    texts = [text.get_text() for text in drawn.legends[0].get_texts()]
    assert texts[-2:] == ["fig3: edge of contact", "fig3: edge of stick"]


@pytest.mark.parametrize("picture", ["profiles", "zones"])
def test_a_picture_that_shows_a_part_of_the_face_says_what_it_leaves_out(kept, result, picture):
    def label():
        (figure,) = kept(picture, result)
        return figure.axes[-1].get_xlabel().split("\n")[1:]

    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        contact["heat_flux"][...] = contact["heat_flux"][()] * (contact["status"][()] > 0)
    assert label() == ["The face runs from 0 to 20 cm; the part not shown is open"]
    with h5py.File(result, "r+") as file:
        file["contact/CYLINDER/status"][14] = 1
    words = ["The face runs from 0 to 20 cm; the part not shown", "carries nothing"]
    assert label() == (words if picture == "profiles" else [])


@pytest.mark.parametrize("rest", [0.01, 2.0])
def test_no_part_of_a_face_is_called_hidden_that_the_axis_shows(kept, result, rest):
    """Closed from x = 0 to 10; of the face, `rest` is beyond what is shown beside that."""
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        contact["x"][...] = np.append(np.linspace(0.0, 10.0, len(contact["x"]) - 1), 13.0 + rest)
        contact["s"][...] = contact["x"][()]
        contact["status"][...] = contact["x"][()] <= 10.0
        contact["pressure"][...] = contact["status"][()]
        contact["heat_flux"][...] = contact["status"][()]
        contact["edges_contact"][...] = contact["edge_contact"][...] = np.nan
        contact["edges_stick"][...] = contact["edge_stick"][...] = np.nan
    (figure,) = kept("profiles", result)
    is_shown = figure.axes[-1].get_xlim()[1] >= 13.0 + rest
    assert is_shown == (rest < 1.0)
    assert is_shown == ("not shown" not in figure.axes[-1].get_xlabel())


@pytest.mark.parametrize("slope, name", [(0.5, "x"), (2.0, "s")])
def test_places_on_a_steep_face_are_lengths_along_it(kept, result, slope, name):
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        contact["s"][...] = contact["x"][()] * np.hypot(1.0, slope)
    (figure,) = kept("profiles", result)
    assert figure.axes[-1].get_xlabel().startswith(f"${name}$")


def test_the_open_part_that_carries_heat_is_shown(kept, result):
    """The profiles leave out 0.5 % of the heat on either side at most; zones, which show none, tell it."""
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        contact["heat_flux"][...] = 2.0 + 0.0 * contact["status"][()]
        x, weight = contact["x"][()], contact["weight"][()]
    (figure,) = kept("profiles", result)
    assert figure.axes[-1].get_xlim()[1] > 20.0
    assert "The face" not in figure.axes[-1].get_xlabel()
    (figure,) = kept("zones", result)
    low, high = figure.axes[0].get_ylim()
    share = 100.0 * weight[x > high].sum() / weight.sum()
    label = figure.axes[0].get_xlabel()
    assert label.endswith(f"is open,\nand up to {share:.2g} % of the heat crosses it")
    with h5py.File(result, "r+") as file:
        flux = np.where(x > high, 0.004 * weight[x <= high].sum() / weight[x > high].sum(), 1.0)
        file["contact/CYLINDER/heat_flux"][...] = flux + np.zeros((15, 1))
    (figure,) = kept("profiles", result)
    last = figure.axes[-1].get_xlim()[1]
    assert last < 20.0
    share = 100.0 * (flux * weight)[x > last].sum() / (flux * weight).sum()
    assert share < 0.5
    assert f"is open,\nand up to {share:.2g} % of the heat crosses it" in figure.axes[-1].get_xlabel()


def test_profiles_show_what_carries_the_force_and_say_what_the_rest_carries(kept, result):
    """The whole face is closed, but its outer part carries 0.4 % of the force, and of the heat less."""
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        x, weight = contact["x"][()], contact["weight"][()]
        outer = x > 5.0
        pressure = np.where(outer, 0.004 * weight[~outer].sum() / weight[outer].sum(), 1.0)
        contact["pressure"][...], contact["status"][...] = pressure, 1
        contact["heat_flux"][...] = np.where(outer, 1e-9, 1.0)
    (figure,) = kept("profiles", result)
    high = figure.axes[-1].get_xlim()[1]
    assert 5.0 < high < 10.0
    share = 100.0 * (pressure * weight)[x > high].sum() / (pressure * weight).sum()
    assert figure.axes[-1].get_xlabel().endswith(
        f"the part not shown\ncarries up to {share:.2g} % of the force")


def test_without_a_force_profiles_and_courses_begin_with_temperatures(kept, result):
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        contact["pressure"][...] = contact["shear"][...] = contact["status"][...] = 0
        contact["slave_temperature"] = hot = 500.0 + 10.0 * np.zeros((15, 1)) + contact["x"][()]
        contact["master_temperature"] = hot - 100.0
    (figure,) = kept("profiles", result)
    first, second = figure.axes
    assert (first.get_ylabel(), second.get_ylabel()[:9]) == ("Temperature of the faces (\N{DEGREE SIGN}C)",
                                                            "Heat flux")
    assert 300.0 < first.get_ylim()[0] < 400.0, "from no zero"
    assert [text.get_text() for text in figure.legends[0].get_texts()][:2] == ["slave", "master"]
    (figure,) = kept("courses", result)
    assert figure.axes[0].get_ylabel().startswith("Temperature of the faces")


def test_the_rounding_of_a_coordinate_is_no_place(kept, result):
    with h5py.File(result, "r+") as file:
        file["contact/CYLINDER/x"][0] = 1.093e-16
    (figure,) = kept("profiles", result, "--range", 0, 3)
    assert "The face runs from 0 to 20 cm" in figure.axes[-1].get_xlabel()
    with h5py.File(result, "r+") as file:
        file["contact/CYLINDER/x"][0] = 1.5e-6  # a mesh may begin there
    (figure,) = kept("profiles", result, "--range", 0, 3)
    assert "The face runs from 1.5e\N{MINUS SIGN}06 to 20 cm" in figure.axes[-1].get_xlabel()


@pytest.mark.parametrize("card", ["*CLEARANCE, MASTER=A, SLAVE=B, VALUE=-0.1", "*HEADING"])
@pytest.mark.parametrize("scale", [1, 2])
def test_no_line_below_the_fields_ends_in_a_semicolon(kept, result, card, scale):
    with h5py.File(result, "r+") as file:
        del file["deck"]
        file["deck"] = [card]
        file["VTKHDF/PointData/mode_temperature"] = file["VTKHDF/PointData/temperature"][()]
        file["VTKHDF/PointData/mode_displacement"] = file["VTKHDF/PointData/displacement"][()]
    for quantity in ("yy", "mode_temperature"):
        (figure,) = kept("fields", result, "--quantity", quantity, "--scale", scale)
        lines = figure.get_supxlabel().splitlines()
        assert lines[0].startswith("temperature of node set TOP = 900")
        assert not any(line.rstrip().endswith(";") for line in lines)


def test_a_range_of_the_profiles_does_not_call_closed_points_open(kept, result):
    (figure,) = kept("profiles", result, "--range", 0, 3)
    label = figure.axes[-1].get_xlabel()
    assert "The face runs from 0 to 20 cm; the part not shown\ncarries up to " in label


@pytest.mark.parametrize("picture", ["profiles", "zones"])
def test_an_edge_of_contact_far_from_the_last_closed_point_is_shown(kept, result, picture):
    """As on a coarse mesh, where the edge lies beyond the room round the points that are closed."""
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        is_closed = contact["x"][()] < 1.0
        contact["pressure"][...], contact["status"][...] = 1.0 * is_closed, 1 * is_closed
        contact["heat_flux"][...] = 0.0
        for key in ("edge_stick", "edges_stick"):
            contact[key][...] = np.nan
        contact["edge_contact"][...] = contact["edges_contact"][:, 0] = contact["s"][12]
        edge = contact["x"][12]
    (figure,) = kept(picture, result)
    limits = figure.axes[-1].get_xlim() if picture == "profiles" else figure.axes[0].get_ylim()
    assert edge < limits[1] < 20.0
    assert figure.axes[-1].get_xlabel().endswith("the part not shown is open")


def test_a_range_inside_the_contact_is_not_called_open_and_names_no_edge(kept, result):
    """The points outside are open, but the edge of contact lies beyond the range."""
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        is_closed = contact["x"][()] < 1.0
        contact["pressure"][...], contact["status"][...] = 1.0 * is_closed, 1 * is_closed
        contact["heat_flux"][...] = 0.0
    (figure,) = kept("profiles", result, "--range", 0, 3)
    assert figure.axes[-1].get_xlabel().endswith("the part not shown\nhas edges of contact")
    names = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "edge of contact" not in names


def test_a_name_beside_its_narrow_zone_is_left_out_where_it_would_cover_marks(laid_out, tmp_path):
    """One increment sticks: of few contact points its name has room between marks, of many it has none."""
    for columns, is_named in ((3, True), (40, False)):
        path = tmp_path / f"dense{columns}.vtkhdf"
        write_result(path, loads=tuple(np.linspace(300.0, 900.0, 60)), columns=columns)
        with h5py.File(path, "r+") as file:
            contact = file["contact/CYLINDER"]
            contact["status"][...] = 1
            contact["status"][30] = 2
            for key in ("edge_contact", "edge_stick", "edges_contact", "edges_stick"):
                contact[key][...] = np.nan
        (figure,) = laid_out("zones", path)
        assert any(text.get_text().startswith("III") for text in figure.axes[0].texts) == is_named
        assert any("in stick" in text.get_text() for text in figure.legends[0].get_texts())


def test_no_zone_is_named_beyond_its_edge(laid_out, result):
    """Half of the way from a lone point in slip to the next ones is nearest to it, but open. At the
    first increment all points stick."""
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        s, x = contact["s"][()], contact["x"][()]
        contact["status"][...] = 1 * (np.arange(len(s)) == 18)
        contact["status"][0] = 2
        for key in ("edge_stick", "edges_stick", "edges_contact"):
            contact[key][...] = np.nan
        contact["edge_contact"][...] = s[18] + 0.1
        contact["edges_contact"][1:, :2] = s[18] - 0.1, s[18] + 0.1
    (figure,) = laid_out("zones", result)
    (axes,) = figure.axes
    named = [text for text in axes.texts if text.get_text() == "II\nslip"]
    low, high = axes.get_ylim()
    for text in named:  # where there is room to point at it
        assert abs(low + text.xy[1] * (high - low) - x[18]) < 0.15


def test_zones_of_a_load_that_turns_are_drawn_over_time(result):
    with h5py.File(result, "r+") as file:
        file["history/load"][10:] = [540.0, 480.0, 420.0, 360.0, 300.0]
    with Result(result) as opened:
        contact = opened.contact("CYLINDER")
        picture = zones.Picture(opened, contact, *contact.axis("x"))
        np.testing.assert_array_equal(picture.abscissa, opened.history["time"])
        assert picture.abscissa_label == "Time"


def test_fields_are_those_of_the_file_at_the_load(draw, result, tmp_path):
    quantities = ("temperature", "von_mises", "yy")
    assert draw("fields", result, "--load", 540, "--region", "contact", "--scale", 2) == three(
        "case.fields-540-contact-scale-2"
    )
    drawn = table(tmp_path, "case.fields-540-contact-scale-2.csv")
    with h5py.File(result) as file:
        data, count = file["VTKHDF/PointData"], int(file["VTKHDF/NumberOfPoints"][0])
        step = int(np.flatnonzero(file["VTKHDF/Steps/Values"][()] == 540.0)[0])
        rows = slice(step * count, (step + 1) * count)
        expected = [data["temperature"][rows], data["von_mises"][rows], data["stress"][rows, 1]]
        for quantity, values in zip(quantities, expected):
            np.testing.assert_array_equal(numbers(drawn[quantity]), values)
        moved = file["VTKHDF/Points"][:, 1] + 2.0 * data["displacement"][rows, 1]
        np.testing.assert_allclose(numbers(drawn["y_drawn"]), moved, rtol=1e-14, atol=1e-14)


def test_values_that_differ_by_rounding_have_one_colour():
    values = -10.0 + 1e-14 * np.array([-3.0, 0.0, 2.0])
    np.testing.assert_allclose(field_colours.limits(values, "yy", 10.0), [-20.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(field_colours.limits(values + 0.009, "yy", 10.0), [-19.991, 0.009])
    noise = 1e-15 * np.array([-1.0, 0.5, 1.0])
    assert list(field_colours.limits(noise, "xx", 10.0)) == [-10.0, 10.0]
    assert len(field_colours.limits(np.array([10.0, 10.02]), "temperature", 10.0)) > 2
    overshot = np.array([19.993, 20.0, 24.5])  # an oscillation of the mesh below what is cold
    assert field_colours.limits(overshot, "temperature", 24.5)[0] == 20.0
    # What differs by more stays as it is.
    values = np.array([0.0, 4.0, 4.0 + 1e-6, 10.0])
    levels = field_colours.limits(values, "von_mises", 10.0)
    np.testing.assert_array_equal(field_colours.settle(values, levels, 10.0), values)


def test_a_motion_has_symmetric_colours_and_a_neutral_one_about_zero():
    levels = field_colours.limits(np.array([-0.5, 1e-8, -1e-8, 1.0]), "mode_temperature", 1.0)
    np.testing.assert_array_equal(levels, -levels[::-1])
    assert levels[-1] == 1.0
    colours, norm = field_colours.colours_of("mode_temperature", levels)
    tiny = [colours(norm(value)) for value in (-1e-8, 0.0, 1e-8)]
    assert tiny[0] == tiny[1] == tiny[2]
    assert np.ptp(tiny[0][:3]) < 0.02 < np.ptp(colours(norm(0.1))[:3])


def test_colours_leave_out_a_spike_of_little_area():
    """However many points a spike has: a mesh is fine there. Temperatures are covered whole."""
    values, areas = np.concatenate((np.linspace(0.0, 100.0, 100), np.full(300, 1000.0))), np.ones(400)
    for share, quantity, highest in ((0.003, "von_mises", 100.0), (0.02, "von_mises", 1000.0),
                                     (0.003, "temperature", 1000.0)):
        areas[100:] = share * 100.0 / 300.0
        assert field_colours.limits(values, quantity, 1000.0, areas)[-1] == highest
    near = np.where(values == 1000.0, 130.0, values)
    assert field_colours.limits(near, "von_mises", 130.0, areas)[-1] == 130.0, "no spike"
    np.testing.assert_allclose(field_colours.limits(values, "yy", 1.0, areas, (-30.0, 70.0))[[0, -1]],
                               [-30.0, 70.0])


def test_a_colour_bar_says_how_far_values_lie_beyond_it(kept, result):
    """A spike at one node of the corner; the range that is asked for leaves both ends out."""
    with h5py.File(result, "r+") as file:
        stress, points = file["VTKHDF/PointData/stress"], len(file["VTKHDF/Points"])
        lone = int(np.argmax(file["VTKHDF/Points"][:, 0] + file["VTKHDF/Points"][:, 1]))
        stress[lone::points, 1] = 1234.0
        low = stress[-points:, 1].min()
    (figure,) = kept("fields", result, "--quantity", "yy")
    (bar,) = bars_of(figure)
    assert (bar.get_xlabel() + bar.get_ylabel()).endswith("to 1234") and bar.get_ylim()[1] < 100.0
    (figure,) = kept("fields", result, "--quantity", "yy", "--range", -50, 0)
    (bar,) = bars_of(figure)
    assert bar.get_xlabel() + bar.get_ylabel() == f"values beyond: {low:.4g} to 1234".replace("-", "\N{MINUS SIGN}")
    assert bar.get_ylim() == (-50.0, 0.0)


def test_panels_with_one_scale_have_one_colour_bar(kept, fail, result, tmp_path):
    (figure,) = kept("fields", result, "--quantity", "xx", "yy", "zz", "--range", -100, 50)
    assert len(bars_of(figure)) == 1 and len(panels_of(figure)) == 3
    assert (tmp_path / "out" / "case.fields-xx-yy-zz-range--100-50.png").exists()
    (figure,) = kept("fields", result, "--quantity", "xx", "von_mises", "--range", -100, 50)
    assert len(bars_of(figure)) == 2, "their colours differ"
    assert "--range is of one unit" in fail("fields", result, "--range", 0, 1)
    assert "must be below" in fail("fields", result, "--quantity", "yy", "--range", 1, 0)


def test_drawings_of_rigid_bodies_are_drawn_where_their_nodes_take_them(kept, result):
    with h5py.File(result, "r+") as file:
        group = file.create_group("rigid_surfaces/DIE")
        group["points"] = points = np.array([[-1.0, -15.0], [-1.0, 5.0]])
        group.attrs["reference_node"], group.attrs["rotation_node"] = 1, 2
        displacement, count = file["VTKHDF/PointData/displacement"], len(file["VTKHDF/Points"])
        displacement[0::count, :2], displacement[1::count, 0] = [0.5, 0.0], 0.01
        x, y = file["VTKHDF/Points"][0, :2]

    def drawn(axes):
        return [path.vertices for each in axes.collections if isinstance(each, LineCollection)
                and each.get_zorder() == 3.5 for path in each.get_paths()]

    (figure,) = kept("mesh", result)
    line, *strokes = drawn(figure.axes[0])
    np.testing.assert_array_equal(line, points)
    assert len(strokes) > 10 and all(stroke[1, 0] < stroke[0, 0] for stroke in strokes), "on its left"
    assert "rigid surface" in [text.get_text() for text in figure.legends[0].get_texts()]
    (figure,) = kept("fields", result, "--quantity", "yy", "--scale", 2)
    arms = points - [x, y]
    expected = points + 2.0 * ([0.5, 0.0] + 0.01 * np.stack((-arms[:, 1], arms[:, 0]), axis=1))
    np.testing.assert_allclose(drawn(figure.axes[0])[0], expected)
    assert figure.axes[0].get_xlim()[0] < expected[:, 0].min()


@pytest.mark.parametrize("levels", [[-400, -200, 0, 50], [-20, -10, 0], [-99, -98, -97], [-1, 0]])
def test_compression_is_blue_and_tension_red_in_every_panel(levels):
    for sign in (1.0, -1.0):
        given = np.sort(sign * np.array(levels, dtype=float))
        colours, norm = field_colours.colours_of("yy", given)
        middles = 0.5 * (given[1:] + given[:-1])
        red, _, blue, _ = colours(norm(middles)).T
        assert (np.sign(red - blue) == np.sign(middles)).all()
        darkness = -colours(norm(middles))[:, :3].sum(axis=1)
        same = np.sign(middles) == np.sign(middles[np.argmax(np.abs(middles))])
        assert (np.diff(darkness[same][np.argsort(np.abs(middles[same]))]) > 0.0).all()


def test_a_uniform_panel_has_one_colour_with_its_value(laid_out, result):
    with h5py.File(result, "r+") as file:
        stress = file["VTKHDF/PointData/stress"]
        stress[:, 1] = -100.0 + 0.04 * np.tile(np.linspace(-1.0, 1.0, len(stress) // 15), 15)
    (figure,) = laid_out("fields", result, "--quantity", "yy")
    (bar,) = bars_of(figure)
    assert [text.get_text() for text in bar.get_xticklabels() + bar.get_yticklabels()
            if text.get_text()] == ["\N{MINUS SIGN}100"]


def test_the_rounding_of_stresses_that_have_gone_is_no_concentration(laid_out, result):
    """As of bodies that come apart: nothing is left but 1e-7 of what there was."""
    with h5py.File(result, "r+") as file:
        stress = file["VTKHDF/PointData/stress"]
        stress[-len(stress) // 15:] *= 1e-7
    (figure,) = laid_out("fields", result, "--quantity", "yy")
    (bar,) = bars_of(figure)
    labels = [text.get_text() for text in bar.get_xticklabels() + bar.get_yticklabels() if text.get_text()]
    assert labels == ["0"]


@pytest.mark.parametrize(("factors", "colours"), [
    ((1.0, 0.02), "body"), ((0.02, 1.0), "panel"), ((0.02, 1.0), "body"), ((1.0, 0.4), "panel"),
    ((1.0, 1.0), "body")])
def test_colour_bars_of_thin_and_flat_bodies_overlap_nothing(laid_out, result, factors, colours):
    with h5py.File(result, "r+") as file:
        for axis in (0, 1):
            file["VTKHDF/Points"][:, axis] *= factors[axis]
        data, points = file["VTKHDF/PointData/temperature"], len(file["VTKHDF/Points"])
        data[...] = np.where(np.tile(np.arange(points) < points // 2, 15), data[...], 20.0 + 0.01 * data[...])
        file["VTKHDF/PointData/displacement"][...] = 0.0
        file["VTKHDF/PointData/stress"][...] *= 1e-6  # whose labels have many digits
    (figure,) = laid_out("fields", result, "--colours", colours,
                         "--quantity", "temperature", "xx", "yy")
    assert len(bars_of(figure)) == (3 if colours == "panel" else 4)
    groups = [[axes.get_window_extent() for axes in panels_of(figure)]
              + [bar.get_tightbbox() for bar in bars_of(figure)]]
    for bar in bars_of(figure):
        labels = bar.get_xticklabels() + bar.get_yticklabels()
        groups.append([label.get_window_extent() for label in labels if label.get_text()])
    for boxes in groups:
        for number, box in enumerate(boxes):
            assert not any(box.overlaps(other) for other in boxes[:number])


def test_stresses_of_axisymmetry_are_radial_and_hoop(tabulate, result, tmp_path):
    with h5py.File(result, "r+") as file:
        del file["deck"]
        file["deck"] = ["*OPTIONS, PLANE=AXISYMMETRIC"]
    tabulate("fields", result)
    assert {"temperature", "radial", "hoop"} <= set(table(tmp_path, "case.fields.csv"))
    assert "yy" not in table(tmp_path, "case.fields.csv")


def test_a_reference_node_is_in_no_range_and_no_window(kept, result):
    with h5py.File(result, "r+") as file:
        last = file["VTKHDF/Connectivity"][-8:].max()
        lone = int(np.setdiff1d(np.arange(len(file["VTKHDF/Points"])), file["VTKHDF/Connectivity"][8:])[0])
        file["VTKHDF/Connectivity"][:8] = file["VTKHDF/Connectivity"][8:16]  # the first cell goes
        file["VTKHDF/Points"][lone] = [1e3, 1e3, 0.0]
        data, points = file["VTKHDF/PointData/temperature"], len(file["VTKHDF/Points"])
        assert last < points
        data[lone::points] = -5e4
    with Result(result) as opened:
        assert not opened.cells.used[lone] and np.isnan(opened.field("temperature", 3)[lone])
    (figure,) = kept("fields", result, "--quantity", "temperature")
    assert figure.axes[0].get_xlim()[1] < 100.0
    assert bars_of(figure)[0].get_ylim()[0] >= 0.0


def test_without_csv_there_are_pictures_alone(result, tmp_path, unrendered, capsys):
    for picture in ("zones", "profiles", "fields"):
        assert main([picture, str(result), "--out", str(tmp_path / "out")]) == 0
    assert {path.suffix for path in (tmp_path / "out").iterdir()} == {".png", ".svg"}


def bars_of(figure):
    """Return the axes of the colour bars."""
    return [axes for axes in figure.axes if axes.get_label() == "<colorbar>"]


def panels_of(figure):
    """Return the axes of the panels."""
    return [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]


def test_the_window_of_the_contact_follows_the_deformed_faces(result):
    with Result(result) as opened:
        cells, contacts = opened.cells, opened.contacts()
    there = mesh.contact_window(contacts, cells, cells.points)
    moved = mesh.contact_window(contacts, cells, cells.points + [3.0, -7.0])
    np.testing.assert_allclose(moved - there, [[3.0, -7.0], [3.0, -7.0]], rtol=1e-12)


def test_fields_of_chosen_quantities_only(tabulate, result, tmp_path):
    assert tabulate("fields", result, "--quantity", "xy") == three("case.fields-xy")
    columns = table(tmp_path, "case.fields-xy.csv")
    assert "xy" in columns and "temperature" not in columns
    for named in (["--quantity", "xx", "yy"], ["--quantity=xx", "yy"]):
        for words in ([*named, "r.vtkhdf"], [*named, "--out", "o", "r.vtkhdf"], ["r.vtkhdf", *named]):
            options = parser().parse_args(spread(["fields", *words]))
            assert (options.results, options.quantity) == (["r.vtkhdf"], ["xx", "yy"])


@pytest.mark.parametrize("last", [True, False])
def test_a_quantity_that_there_is_not_is_named(last):
    """And not the next word, whichever of several names is misspelt."""
    for names in (["xx", "misess"], ["misess", "xx"], ["xx", "misess", "yy"]):
        words = [["--quantity", *names], ["r.vtkhdf"]]
        told = "invalid choice: 'misess', nearest: 'von_mises' .choose from temperature"
        with pytest.raises(UserError, match=told):
            parser().parse_args(spread(["fields", *sum(words[:: 1 - 2 * last], [])]))


def test_quantities_have_the_names_of_verify_too():
    """Of fields and of histories, in any case; names of the file go before."""
    names = ["MISES", "nt", "S12", "HFL2", "PEEQ", "Von_Mises"]
    options = parser().parse_args(spread(["fields", "--quantity", *names, "r.vtkhdf"]))
    assert options.quantity == ["von_mises", "temperature", "xy", "flux_y", "plastic_strain", "von_mises"]
    known = ["stress_xy", "heat_flux_y", "equivalent_plastic_strain", "creep_strain_zz", "displacement_x"]
    assert [known_name(name, known) for name in ("S12", "HFL2", "PEEQ", "CE33", "u1")] == known
    assert known_name("U2", known) == "U2"


def test_titles_of_fields_side_by_side_stand_apart(laid_out, result):
    with h5py.File(result, "r+") as file:
        file["VTKHDF/Points"][:, 0] *= 0.3  # a slender model has narrow panels
    for quantities in ((), ("--quantity", "stress_error", "heat_flux_error")):
        (figure,) = laid_out("fields", result, *quantities)
        titles = [axes._left_title for axes in panels_of(figure)]
        boxes = [title.get_window_extent() for title in titles]
        assert [title.get_text()[:3] for title in titles] == ["(a)", "(b)", "(c)"][: len(boxes)]
        for left, right in zip(boxes, boxes[1:]):
            assert right.x0 - left.x1 > 0.1 * figure.dpi



def test_titles_side_by_side_begin_on_one_height(laid_out, result):
    with h5py.File(result, "r+") as file:
        points, count = file["VTKHDF/PointData"], len(file["VTKHDF/Points"])
        points["solid_fraction"] = np.arange(len(points["temperature"])) % (count // 2) / (count // 2)
        points["equivalent_plastic_strain"] = points["solid_fraction"][()]
    (figure,) = laid_out("fields", result, "--quantity", "temperature", "solid_fraction")
    first, second = (axes._left_title.get_window_extent() for axes in panels_of(figure))
    assert second.y1 == pytest.approx(first.y1, abs=1.0)
    assert figure._supxlabel.get_text().endswith(
        "\nthick line inside: 1 % of the largest plastic strain; dashed line: solid fraction 0.5")


@pytest.mark.parametrize(("axis", "ratio", "stretch", "words"), [
    (0, 80.0, 0.1, "$x$ stretched by 10"), (1, 80.0, 10.0, "$y$ stretched by 10"),
    (1, 16.0, 2.0, "$y$ stretched by 2"), (None, 2.0, 1.0, "")])
def test_a_thin_strip_is_stretched_and_says_by_how_much(laid_out, result, axis, ratio, stretch, words):
    """A model 1 to 2, thinned to the ratio."""
    with h5py.File(result, "r+") as file:
        points = file["VTKHDF/Points"]
        if axis is not None:
            low, high = np.ptp(points[:, axis]), np.ptp(points[:, 1 - axis])
            points[:, axis] = points[:, axis] * high / (ratio * low)
        file["VTKHDF/PointData/displacement"][...] = 0.0
    (figure,) = laid_out("fields", result, "--quantity", "temperature", "yy")
    axes, *_ = panels = panels_of(figure)
    box = axes.get_window_extent()
    drawn = box.width / np.ptp(axes.get_xlim()), box.height / np.ptp(axes.get_ylim())
    assert drawn[1] / drawn[0] == pytest.approx(stretch, rel=1e-6)
    assert ("stretched" in figure.get_supxlabel()) == bool(words)
    assert words in figure.get_supxlabel()
    bars = [each.get_tightbbox() for each in figure.axes if each not in panels]
    places = [each.get_window_extent() for panel in panels for each in (panel, panel._left_title)]
    assert len(bars) == len(panels) == 2
    assert not any(bar.overlaps(place) for bar in bars for place in places)


@pytest.mark.parametrize("lower", [0.0, 0.8])
def test_a_line_is_named_below_the_fields_where_one_is_drawn(kept, result, lower):
    """There is none where each body yields everywhere or nowhere, nor outside of the window."""
    with h5py.File(result, "r+") as file:
        points = file["VTKHDF/PointData"]
        count = len(file["VTKHDF/Points"])
        is_upper = np.arange(len(points["temperature"])) % count < count // 2
        points["equivalent_plastic_strain"] = np.where(is_upper, 1.0, lower)
    words = "1 % of the largest plastic strain"
    (figure,) = kept("fields", result, "--quantity", "yy")
    assert words not in figure.get_supxlabel()
    with h5py.File(result, "r+") as file:
        across = np.tile(file["VTKHDF/Points"][:, 0], 15)
        file["VTKHDF/PointData/equivalent_plastic_strain"][...] = np.maximum(0.0, 10.0 - across)
    (figure,) = kept("fields", result, "--quantity", "yy")
    assert words in figure.get_supxlabel()
    (figure,) = kept("fields", result, "--quantity", "yy", "--window", -1, 5, -1, 5)
    assert words not in figure.get_supxlabel()


def filled_at(figure, place):
    """Return whether the colours of the first panel cover a place."""
    contours = [each for each in figure.axes[0].collections if getattr(each, "filled", False)]
    return any(path.contains_point(place) for each in contours for path in each.get_paths())


def test_bodies_that_never_melt_are_blank_and_what_is_solid_is_not(kept, result):
    """The upper body melts below y = 10, and is solid at the end."""
    with h5py.File(result, "r+") as file:
        count, y = len(file["VTKHDF/Points"]), file["VTKHDF/Points"][:, 1]
        is_upper = np.arange(count) < count // 2
        melting = np.where(is_upper, np.clip(y / 10.0, 0.0, 1.0), 1.0)
        file["VTKHDF/PointData/solid_fraction"] = np.concatenate([melting] * 14 + [np.ones(count)])
        file["VTKHDF/Steps/PointDataOffsets/solid_fraction"] = np.arange(15) * count
    for increment in (14, 15):
        (figure,) = kept("fields", result, "--quantity", "solid_fraction", "--scale", 0, "--increment",
                         increment)
        assert [filled_at(figure, (10.0, y)) for y in (17.0, 5.0, -10.0)] == [True, True, False]
    with h5py.File(result, "r+") as file:  # all that there is stays solid
        file["VTKHDF/PointData/solid_fraction"][...] = 1.0
    (figure,) = kept("fields", result, "--quantity", "solid_fraction", "--scale", 0)
    assert filled_at(figure, (10.0, -10.0))


def test_stresses_about_an_axis_have_names_of_their_own(kept, result):
    for card, names in (("TYPE=CAX4", ["Axial stress", "Hoop stress"]), ("TYPE=CPE4", ["Stress", "Stress"])):
        with h5py.File(result, "r+") as file:
            del file["deck"]
            file["deck"] = [f"*ELEMENT, {card}"]
        (figure,) = kept("fields", result, "--quantity", "yy", "zz")
        titles = [axes.get_title(loc="left") for axes in panels_of(figure)]
        assert [title[4:].splitlines()[0] for title in titles] == names


def test_labels_beside_a_very_long_model_stand_apart(laid_out, result):
    with h5py.File(result, "r+") as file:
        file["VTKHDF/Points"][:, 0] *= 100.0
        file["VTKHDF/Points"][:, 1] -= 7.0
    (figure,) = laid_out("fields", result, "--quantity", "temperature", "yy")
    for axes in panels_of(figure):
        low, high = axes.get_ylim()
        labels = [label for at, label in zip(axes.get_yticks(), axes.get_yticklabels()) if low <= at <= high]
        boxes = [label.get_window_extent() for label in labels]
        assert labels and all(upper.y0 >= lower.y1 for lower, upper in zip(boxes, boxes[1:]))


def test_a_window_shows_its_part_of_the_model_in_colours_of_its_own(kept, fail, result):
    (figure,) = kept("fields", result, "--quantity", "temperature", "--window", -1, 4, -2, 3)
    panel, bar = figure.axes
    assert (*panel.get_xlim(), *panel.get_ylim()) == (-1.0, 4.0, -2.0, 3.0)
    (whole,) = kept("fields", result, "--quantity", "temperature")
    assert np.ptp(bar.get_ylim()) < 0.5 * np.ptp(whole.axes[1].get_ylim())
    assert "--window 21 22 0 1 shows nothing: the model is from 0 to 20.2 in x" in fail(
        "fields", result, "--window", 21, 22, 0, 1)
    assert "X0 must be below X1" in fail("fields", result, "--window", 2, 1, 0, 1)


def test_outlines_are_seen_on_the_darkest_colour(kept, result):
    (figure,) = kept("fields", result, "--quantity", "temperature", "--range", 1e6, 2e6)
    lines = [each for each in figure.axes[0].collections if isinstance(each, LineCollection)]
    looks = [(tuple(each.get_colors()[0][:3]), each.get_linewidth()[0]) for each in lines[-2:]]
    (below, wide), (above, narrow) = looks
    assert below == (1.0, 1.0, 1.0) and above == (0.0, 0.0, 0.0) and wide > narrow


def test_sections_of_generalised_plane_strain_show_the_stress_along_z(tabulate, result, tmp_path):
    with h5py.File(result, "r+") as file:
        file["history/U3"] = np.zeros(len(file["history/time"]))
    tabulate("fields", result)
    drawn = table(tmp_path, "case.fields.csv")
    assert "zz" in drawn and "yy" not in drawn


def test_many_fields_are_drawn_in_rows_of_panels_large_enough(laid_out, result):
    quantities = ["xx", "yy", "zz", "xy", "von_mises"]
    (figure,) = laid_out("fields", result, "--region", "contact", "--quantity", *quantities)
    panels = panels_of(figure)
    boxes = [axes.get_window_extent() for axes in panels]
    assert len(boxes) == 5 and min(min(box.size) for box in boxes) > figure.dpi  # an inch
    assert [bool(axes.get_xlabel()) for axes in panels] == [False, False, True, True, True]
    assert [bool(axes.get_ylabel()) for axes in panels] == [True, False, False, True, False]


def test_errors_are_drawn_element_by_element(kept, result, tmp_path):
    chosen = ["stress_error", "heat_flux_error"]
    (figure,) = kept("fields", result, "--load", 540, "--quantity", *chosen)
    drawn = table(tmp_path, "case.fields-stress_error-heat_flux_error-540.csv")
    elements = np.arange(1, 81)
    np.testing.assert_array_equal(numbers(drawn["element"]), elements)
    np.testing.assert_array_equal(numbers(drawn["body"]), np.where(elements <= 40, 1, 2))
    for quantity, axes in zip(chosen, figure.axes):
        np.testing.assert_array_equal(numbers(drawn[quantity]), errors_at(80, 540.0))
        filled = next(each for each in axes.collections if isinstance(each, PolyCollection))
        np.testing.assert_array_equal(filled.get_array(), errors_at(80, 540.0))
        shades = filled.to_rgba(filled.get_array())[:, :3].sum(axis=1)
        assert (np.diff(shades) >= -0.1).all() and np.ptp(shades) > 1.0, "bright where it is large"
        # A side is drawn in eight pieces.
        centres = np.array([path.vertices[:-1:8].mean(axis=0) for path in filled.get_paths()])
        places = np.column_stack([numbers(drawn[f"{axis}_drawn"]) for axis in "xy"])
        np.testing.assert_allclose(centres, places, rtol=0.0, atol=1e-12)


def test_errors_of_elements_of_several_types_stay_with_their_elements():
    arrays = {
        "Points": np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [4, 1, 0]]),
        "Connectivity": np.array([0, 1, 2, 3, 1, 4, 2]),
        "Offsets": np.array([0, 4, 7]),
        "Types": np.array([9, 5]),
        "PointData/node_id": np.arange(1, 6),
    }
    with h5py.File("mesh", "w", driver="core", backing_store=False) as file:
        for name, values in arrays.items():
            file[name] = values
        cells = Cells.read(file)
    places = element_fields.centres(cells, cells.points)
    np.testing.assert_allclose(places, [[1.0, 1.0], [8.0 / 3.0, 1.0]])
    window = np.array([[3.0, 0.0], [5.0, 2.0]])
    assert list(element_fields.in_window(cells, cells.points, window)) == [False, True]
    filled = element_fields.fill(
        Figure().subplots(), cells, cells.points, np.array([1.0, 9.0]),
        *field_colours.colours_of("stress_error", np.arange(11.0))
    )
    corners = [len(np.unique(np.round(path.vertices[::8], 9), axis=0)) for path in filled.get_paths()]
    assert dict(zip(corners, filled.get_array())) == {3: 9.0, 4: 1.0}


def test_fields_of_elements_are_drawn_apart_from_those_of_nodes(fail, result):
    message = fail("fields", result, "--quantity", "stress_error", "yy")
    assert "stress_error and heat_flux_error are fields of elements" in message


def test_bodies_whose_ranges_differ_tenfold_have_colour_bars_of_their_own_if_asked(kept, result):
    def bars(figure):
        return [axes.get_xlabel() + axes.get_ylabel() for axes in bars_of(figure)]

    with h5py.File(result, "r+") as file:
        data = file["VTKHDF/PointData/temperature"]
        points = len(file["VTKHDF/Points"])
        upper = np.tile(np.arange(points) < points // 2, 15)
        given = data[...]
        for factor, titles in ((0.2, [""]), (0.01, ["body 1", "body 2"]), (0.0, [""])):
            data[...] = np.where(upper, given, 20.0 + factor * given)
            file.flush()
            (figure,) = kept("fields", result, "--quantity", "temperature", "--colours", "body")
            assert bars(figure) == titles
            (figure,) = kept("fields", result, "--quantity", "temperature")
            assert bars(figure) == [""]
        file["VTKHDF/CellData/stress_error"][...] = np.tile(np.where(np.arange(80) < 40, 1.0, 50.0)
                                                            * np.linspace(0.0, 1.0, 80), 15)
        file.flush()
        (figure,) = kept("fields", result, "--quantity", "stress_error", "--colours", "body")
        assert bars(figure) == ["body 2", "body 1"]


def test_bodies_share_colours_with_the_widest_range_that_is_not_ten_times_theirs():
    near = {1: 100.0, 2: 11.0, 3: 5.0, 4: 0.0, 5: 0.4}
    near = {body: np.array([50.0, 50.0 + width]) for body, width in near.items()}
    assert field_colours.scale_groups(near) == [[1, 2], [3], [5, 4]]
    assert field_colours.scale_groups({1: np.array([7.0, 7.0]), 2: np.array([])}) == [[1]]


def test_profiles_and_fields_name_load_and_time(kept, result):
    with h5py.File(result, "r+") as file:
        file["history/time"][...] /= 100.0
        file["VTKHDF/Steps/Values"][...] /= 100.0
    words = "temperature of node set TOP = 540 \N{DEGREE SIGN}C, time 5.4"
    (figure,) = kept("profiles", result, "--load", 540)
    assert figure.get_supxlabel() == words
    (figure,) = kept("fields", result, "--load", 540, "--quantity", "temperature")
    assert figure.get_supxlabel() == words
    (figure,) = kept("profiles", result, "--load", 180, 540)
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend[-2:] == ["edge of contact", "edge of stick"]
    assert legend[-4:-2] == ["180 \N{DEGREE SIGN}C, time 1.8", "540 \N{DEGREE SIGN}C, time 5.4"]


def test_magnified_displacements_name_their_factor_and_why_bodies_overlap(result):
    def words(factor):
        with Result(result) as opened:
            return fields.words_below(opened, 8, factor)

    assert r"displacements $\times$ 20" in words(20.0)
    assert "bodies that touch seem to overlap" in words(20.0).replace("\n", " ")
    assert r"$\times$ 0.5" in words(0.5) and "overlap" not in words(0.5)
    assert "displacements" not in words(1.0)
    with h5py.File(result, "r+") as file:  # faces that touch in the mesh, as those of a crack
        file["contact/CYLINDER/master_node"][...] = file["contact/CYLINDER/slave_node"][()]
    assert r"$\times$ 20" in words(20.0) and "overlap" not in words(20.0)
    with h5py.File(result, "r+") as file:
        del file["deck"]
        file["deck"] = ["*Clearance, SLAVE=A, MASTER=B, VALUE=-0.01"]
    for factor in (1.0, 20.0):
        assert words(factor).endswith("\nthe mesh has the faces as drawn; *CLEARANCE, \N{MINUS SIGN}0.01 cm "
                                      "here, is not drawn")


def test_uniform_contact_is_tinted_and_names_hide_no_symbol(laid_out, result):
    with h5py.File(result, "r+") as file:
        status = file["contact/CYLINDER/status"]
        status[:5] = 0
        status[5:] = 1
    (figure,) = laid_out("zones", result)
    (axes,) = figure.axes
    (tints,) = [each for each in axes.collections if isinstance(each, QuadMesh)]
    np.testing.assert_array_equal(tints.get_array().ravel(), [0] * 5 + [1] * 10)
    assert all(text.get_bbox_patch() is None for text in axes.texts)
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"contact point open", "contact point in slip", "all contact points in slip"} <= set(legend)
    assert "all contact points in stick" not in legend


def test_contact_with_an_edge_inside_is_not_tinted(kept, result):
    (figure,) = kept("zones", result)
    assert not any(isinstance(each, QuadMesh) for each in figure.axes[0].collections)
    assert not any("all" in text.get_text() for text in figure.legends[0].get_texts())


def test_principal_radial_and_hoop_stress_are_the_files_or_made_of_its_stress(tabulate, result,
                                                                             tmp_path):
    names = ["principal_1", "principal_3", "radial", "hoop"]
    picture = "case.fields-principal_1-principal_3-radial-hoop.csv"
    tabulate("fields", result, "--quantity", *names)
    made = table(tmp_path, picture)
    with h5py.File(result, "r+") as file:
        points = len(file["VTKHDF/Points"])
        xx, yy, zz, xy = file["VTKHDF/PointData/stress"][-points:].T
        x, y = file["VTKHDF/Points"][:, :2].T
        whole = [np.array([[a, d, 0], [d, b, 0], [0, 0, c]]) for a, b, c, d in zip(xx, yy, zz, xy)]
        expected = np.linalg.eigvalsh(whole)
        np.testing.assert_allclose(numbers(made["principal_1"]), expected[:, 2], atol=1e-12)
        np.testing.assert_allclose(numbers(made["principal_3"]), expected[:, 0], atol=1e-12)
        radius = np.hypot(x, y)
        away = radius > 0.0
        normal = np.column_stack((x, y))[away] / radius[away, None]
        plane = np.array(whole)[away, :2, :2]
        along = np.einsum("ni,nij,nj->n", normal, plane, normal)
        np.testing.assert_allclose(numbers(made["radial"])[away], along, atol=1e-11)
        np.testing.assert_allclose(numbers(made["hoop"])[away], (xx + yy)[away] - along, atol=1e-11)
        file["VTKHDF/PointData/hoop_stress"] = np.arange(15.0 * points)
        file["VTKHDF/Steps/PointDataOffsets/hoop_stress"] = np.arange(15) * points
    tabulate("fields", result, "--quantity", *names)
    np.testing.assert_array_equal(numbers(table(tmp_path, picture)["hoop"]),
                                  np.arange(14.0 * points, 15.0 * points))


@pytest.fixture
def said(unrendered, tmp_path, capsys):
    """Return a function that calls plot and gives the names of the pictures and the notes."""

    def call(*arguments):
        assert main([*map(str, arguments), "--out", str(tmp_path / "out")]) == 0
        captured = capsys.readouterr()
        return [Path(line).stem for line in captured.out.splitlines()[::2]], captured.err

    return call


def test_a_load_that_no_increment_has_gives_the_nearest_and_says_so(said, fail, result):
    note = f"plot: note: {result}: no increment has load 550; the nearest, 540, is drawn\n"
    assert said("profiles", result, "--load", 550, 600) == (["case.profiles-540-600"], note)
    assert said("fields", result, "--load", 550) == (["case.fields-540"], note)
    assert "no increment has load 950: there are 60 to 900" in fail("profiles", result, "--load", 950)
    assert "no increment 99: there are 1 to 15" in fail("profiles", result, "--increment", 99)


def test_a_load_of_several_increments_says_which_it_is_of(said, turning):
    note = f"plot: note: {turning}: increments {{}} have load {{}}; the last is drawn, --increment draws another\n"
    for picture in ("profiles", "fields"):
        assert said(picture, turning, "--load", 5, 8)[1] == note.format("5, 11", 5)
        assert said(picture, turning, "--increment", 5) == ([f"case.{picture}-5-increment-5"], "")
    with h5py.File(turning, "r+") as file:
        file["history/load"][:4] = 5.0
    assert said("profiles", turning, "--load", 5)[1] == note.format("1 to 5, 11", 5)
    with h5py.File(turning, "r+") as file:
        file["history/load"][...] = np.arange(15) % 2
    assert said("profiles", turning, "--load", 0)[1] == note.format("1, 3, 5, ..., 13, 15", 0)


def test_curves_outside_the_range_of_a_panel_are_told(said, result):
    """At 60 the pressure is at most 90 sqrt(60/900) = 23 MPa; at the other loads it passes 30."""
    with h5py.File(result, "r+") as file:
        file["contact/CYLINDER/pressure"][...] += 0.1   # closed throughout: no fall to zero
        file["contact/CYLINDER/edges_contact"][...] = np.nan
    note = f"plot: note: {result}: panel of pressure: {{}} curves lie outside {{}}\n"
    call = ["profiles", result, "--load", 60, 300, 900, "--values", "pressure"]
    assert said(*call, 0, 500)[1] == ""
    assert said(*call, 30, 500)[1] == note.format("1 of 3", "30 to 500")
    assert said(*call, -5, 0)[1] == note.format("3 of 3", "-5 to 0")


def test_numbers_of_legends_and_footers_have_minus_signs(turning):
    with h5py.File(turning, "r+") as file:
        file["history/load"][...] *= -1.0
    with Result(turning) as opened:
        assert opened.load_words(4) == "displacement y of PIN_A-1 = \N{MINUS SIGN}5 cm, time 300"
    with h5py.File(turning, "r+") as file:
        file["history/load"].attrs["label"] = "u_y of 9000"
    with Result(turning) as opened:
        assert opened.load_label == "displacement y of node 9000"
        assert opened.units.short_load(opened.load_label, -0.00002) == "\N{MINUS SIGN}2e\N{MINUS SIGN}05 cm"
        assert opened.row_words(7) == [-8.0]


def test_edges_of_stick_are_dashed_unlike_friction():
    _, (_, dashes) = profile_legends.EDGES["edges_stick"]
    for _, other in (line for line in profile_legends.QUANTITY_LINES.values() if line != "solid"):
        assert len(dashes) != len(other)


def test_of_loads_that_are_small_beside_the_last_the_one_asked_for_is_drawn(said, result):
    """Times of a shock begin with less than a millionth of the end."""
    with h5py.File(result, "r+") as file:
        times = np.geomspace(1e-5, 1e4, 15)
        for name in ("history/load", "history/time", "VTKHDF/Steps/Values"):
            file[name][...] = times
    for load in times[:3]:
        for picture in ("profiles", "fields"):
            assert said(picture, result, "--load", load) == ([f"case.{picture}-{load:g}"], "")


def test_a_load_without_fields_gives_the_nearest_with_fields_and_says_so(said, fail, tmp_path):
    path = tmp_path / "thin.vtkhdf"
    write_result(path, fields_every=5)
    assert said("fields", path, "--load", 660) == (
        ["thin.fields-600"],
        f"plot: note: {path}: no increment with fields has load 660; the nearest, 600, is drawn\n",
    )
    message = fail("fields", path, "--increment", 11)
    assert "no fields at increment 11 (thinned by FREQUENCY); nearest with fields: 10" in message


def test_fields_of_another_increment_are_never_taken(fail, result):
    """However near its time is: an absolute tolerance is none for times in nanoseconds."""
    with h5py.File(result, "r+") as file:
        file["history/time"][...] = 1e-10 * np.arange(1.0, 16.0)
        file["VTKHDF/Steps/Values"][...] = 1e-10 * np.array([*range(2, 16), 15.0])
    assert "no fields at increment 1" in fail("fields", result, "--increment", 1)


def test_convergence_holds_every_iteration_and_marks_what_failed(draw, monkeypatch, tmp_path):
    for name, failing in (("picard", True), ("good", False)):
        write_result(tmp_path / f"{name}.vtkhdf", failing=failing, loads=(60.0, 120.0, 180.0))
    picard, good = tmp_path / "picard.vtkhdf", tmp_path / "good.vtkhdf"
    assert draw("convergence", picard) == three("picard.convergence")
    drawn = table(tmp_path, "picard.convergence.csv")
    with h5py.File(picard) as file:
        for key, values in file["convergence"].items():
            np.testing.assert_array_equal(numbers(drawn[key]), values[()])
    outcome = {}
    for increment, attempt, kind in zip(drawn["increment"], drawn["attempt"], drawn["outcome"]):
        outcome[int(increment), int(attempt)] = kind
    accepted = {(increment, 1): "accepted" for increment in (1, 2, 3)}
    assert outcome == accepted | {(4, 1): "cut back", (4, 2): "failed"}
    with h5py.File(picard, "r+") as file:   # as if the two were stages of one try
        file["convergence/cut_backs"][...] = 0
    assert draw("convergence", picard) == three("picard.convergence")
    assert set(table(tmp_path, "picard.convergence.csv")["outcome"]) == {"accepted", "failed"}
    monkeypatch.setattr(Figure, "savefig", lambda self, path, **options: path.write_text("not rendered"))
    assert draw("convergence", picard, good) == three("picard.convergence-good")
    both = table(tmp_path, "picard.convergence-good.csv")
    assert both["result"].count("good") == 12 and "failed" in both["outcome"]


def test_convergence_has_ticks_at_increments_and_room_above_g(laid_out, tmp_path):
    for loads, ticks in (((60.0,), [1]), (np.arange(1.0, 46.0), [10, 20, 30, 40])):
        path = tmp_path / "many.vtkhdf"
        write_result(path, loads=tuple(loads))
        (figure,) = laid_out("convergence", path)
        axes = figure.axes[-1]
        low, high = axes.get_xlim()
        assert [tick for tick in axes.get_xticks() if low <= tick <= high] == ticks
        frame, top = axes.transAxes.transform((0, 1))[1], axes.transData.transform((1, 1.0))[1]
        assert frame - top > 0.05 * axes.get_window_extent().height


def test_convergence_marks_a_solve_that_is_longer_than_others_alone(kept, result):
    def words():
        (figure,) = kept("convergence", result)
        return [text.get_text() for text in figure.axes[0].get_legend().get_texts()]

    assert words() == ["solves of accepted increments"]
    with h5py.File(result, "r+") as file:
        increment = file["convergence/increment"]
        for key in file["convergence"]:   # a fifth iteration of the last one
            values = file[f"convergence/{key}"][()]
            del file[f"convergence/{key}"]
            file[f"convergence/{key}"] = np.append(values, values[-1] + (key == "iteration"))
    assert words()[1:] == ["the longest, in increment 15"]
    with h5py.File(result, "r+") as file:   # one of the first goes to the second increment
        increment = file["convergence/increment"]
        increment[...] = np.where(np.arange(61) < 5, 1, increment[()])
        file["convergence/iteration"][:8] = [1, 2, 3, 4, 5, 1, 2, 3]
    assert words()[1:] == ["one of the 2 longest, in increment 1"]


def test_convergence_shows_g_where_it_relaxes(kept, result):
    (figure,) = kept("convergence", result)
    assert [axes.get_ylabel() for axes in figure.axes][2:] == ["Relaxation $g$"]
    with h5py.File(result, "r+") as file:
        file["convergence/g_min"][...] = 0.999
    (figure,) = kept("convergence", result)
    assert len(figure.axes) == 2 and figure.axes[-1].get_xlabel() == "Increment"
    assert np.isclose(figure.axes[-1].get_xlim()[1], 15.9)


def test_convergence_without_iterations_says_so(fail, result):
    with h5py.File(result, "r+") as file:
        del file["convergence"]
    assert "holds no iterations" in fail("convergence", result)


@pytest.mark.parametrize("choices", [{"heat": False}, {"friction": None}])
def test_decks_without_heat_or_friction_are_drawn(tabulate, tmp_path, choices):
    path = tmp_path / "case.vtkhdf"
    write_result(path, loads=(300.0, 600.0), **choices)
    for picture in ("profiles", "zones", "fields"):
        tabulate(picture, path)
    columns = table(tmp_path, "case.profiles.csv")
    assert ("heat_flux" in columns) == choices.get("heat", True)
    assert ("mu_p" in columns) == ("friction" not in choices)


def test_a_temperature_without_heat_is_drawn_where_it_tells_something(tabulate, tmp_path):
    """As it is left by a deck of mechanics, the initial one, or as *TEMPERATURE gives it."""
    path = tmp_path / "case.vtkhdf"
    for varies in (False, True):
        write_result(path, loads=(300.0, 600.0))
        with h5py.File(path, "r+") as file:
            assert "heat_flux" not in file["VTKHDF/PointData"]
            if not varies:
                file["VTKHDF/PointData/temperature"][...] = 20.0
        tabulate("fields", path)
        assert ("temperature" in table(tmp_path, "case.fields.csv")) == varies
        tabulate("fields", path, "--quantity", "temperature")
        assert "temperature" in table(tmp_path, "case.fields-temperature.csv")


def test_every_contact_has_a_picture_of_its_own(tabulate, fail, tmp_path):
    path = tmp_path / "case.vtkhdf"
    write_result(path, loads=(300.0, 600.0), contacts=("LEFT", "RIGHT"))
    assert tabulate("profiles", path) == [
        *three("case.profiles-LEFT"),
        *three("case.profiles-RIGHT"),
    ]
    assert tabulate("profiles", path, "--contact", "RIGHT") == three("case.profiles-RIGHT")
    assert "no contact 'RIHGT', nearest: 'RIGHT'" in fail("zones", path, "--contact", "RIHGT")


def test_pictures_of_other_options_have_other_names(tabulate, tmp_path):
    path = tmp_path / "case.vtkhdf"
    write_result(path, loads=(300.0, 600.0, 300.0))
    assert tabulate("profiles", path, "--range", 0, 2.5) == three("case.profiles-range-0-2.5")
    assert tabulate("profiles", path, "--along", "s") == three("case.profiles-along-s")
    for number in (1, 3):
        assert tabulate("fields", path, "--increment", number) == three(
            f"case.fields-300-increment-{number}"
        )
    assert tabulate("fields", path, "--increment", 2) == three("case.fields-600")


@pytest.mark.parametrize("units", ["cm MPa W C", ""])
def test_axes_have_the_units_of_the_file_or_none(tmp_path, units):
    path = tmp_path / "case.vtkhdf"
    write_result(path, units=units)
    options = parser().parse_args(["profiles", str(path)])
    with Result(path) as opened:
        contact = opened.contact("CYLINDER")
        figure = profiles.Picture(opened, contact, [8], options).draw([])
        labels = [axes.get_ylabel() for axes in figure.axes]
        labels.append(figure.axes[-1].get_xlabel().split("\n")[0])
        style.plt.close(figure)
        load = opened.units.load_label(opened.load_label)
    if units:
        assert labels == ["Contact traction (MPa)", "Heat flux $q$ (W/cm$^2$)", "$x$ (cm)"]
        assert load == "Temperature of node set TOP (\N{DEGREE SIGN}C)"
    else:
        assert labels == ["Contact traction", "Heat flux $q$", "$x$"]
        assert load == "Temperature of node set TOP"


@pytest.mark.parametrize(("load", "unit", "label", "value"), [
    ("K", "K", "U_y of TEMPERATURE_FACE (K)", "0.5 K"),
    ("mm", "mm", "U_y of TEMPERATURE_FACE (mm)", "0.5 mm"),
    ("time", "", "U_y of TEMPERATURE_FACE", "u_y of TEMPERATURE_FACE = 0.5"),
])
def test_the_load_axis_has_the_unit_of_the_file_whatever_its_name(load, unit, label, value):
    names = {"length": "mm", "stress": "MPa", "power": "mW", "temperature": "K"}
    units = Units(names, load)
    assert units.load_unit() == unit
    assert units.load_label("u_y of TEMPERATURE_FACE") == label
    assert units.short_load("u_y of TEMPERATURE_FACE", 0.5) == value


@pytest.mark.parametrize("load", ["temperature", "length"])
def test_a_load_axis_without_units_has_its_value(load):
    units = Units({}, load)
    assert units.short_load("u_y of TEMPERATURE_FACE", 0.5) == "0.5"
    assert units.load_label("temperature of HOT") == "Temperature of HOT"


def test_times_have_the_unit_of_the_deck(kept, result):
    with h5py.File(result, "r+") as file:
        file["run"].attrs["unit_time"] = "s"
        contact = file["contact/CYLINDER"]
        contact["slave_temperature"] = 20.0 + contact["pressure"][()]
    with Result(result) as opened:
        assert opened.load_words(8).endswith("540 \N{DEGREE SIGN}C, time 540 s")
        assert Units({"time": "s"}).load_label("time") == "Time (s)"
        assert Units({"time": "s"}).short_load("time", 5.0) == "5 s"
        assert Units({}).short_load("time", 5.0) == "time 5"
    for over, label in (((), "Temperature of node set TOP (\N{DEGREE SIGN}C)"), (("--over", "time"), "Time (s)"),
                        (("--log",), "Time (s)")):
        (figure,) = kept("courses", result, *over)
        assert {axes.get_xlabel() for axes in figure.axes if axes.get_visible()} == {"", label}


def test_forces_are_newtons_where_units_are_those_of_newtons():
    units = {"length": "mm", "stress": "MPa"}
    assert Units(units).label("Force", "force") == "Force (N)"
    assert Units(units | {"length": "m"}).label("Force", "force") == "Force (MPa m$^2$)"
    assert (unit_of("MPa mm^2"), unit_of("Pa m^2")) == ("N", "N")
    assert (unit_of("MPa mm^3"), unit_of("Pa m^3")) == ("N mm", "N m")
    assert unit_of("stress length^3") == unit_of("time") == ""
    assert unit_of("MPa cm^2") == "MPa cm\N{SUPERSCRIPT TWO}"


def test_celsius_is_the_unit_of_a_load_axis():
    assert Units({"temperature": "C", "length": "mm"}, "C").load_unit() == "\N{DEGREE SIGN}C"


def test_a_digitised_figure_is_laid_over(kept, result, tmp_path):
    figure = tmp_path / "fig2.csv"
    figure.write_text("# from the printed figure\nx,pressure,heat_flux\n0,70,\n3,60,\n1,,0.9\n")
    (drawn,) = kept("profiles", result, "--load", 540, "--with", figure)
    laid = [[line.get_xydata().tolist() for line in axes.lines if line.get_marker() == "x"]
            for axes in drawn.axes]
    assert laid == [[[[0.0, 70.0], [3.0, 60.0]]], [[[1.0, 0.9]]]]
    figure.write_text("load,edge_contact\n100,2.5\n900,7.5\n")
    (drawn,) = kept("zones", result, "--with", figure)
    (laid,) = [line for line in drawn.axes[0].lines if line.get_marker() == "x"]
    np.testing.assert_array_equal(laid.get_xydata(), [[100.0, 2.5], [900.0, 7.5]])
    out = tmp_path / "out"
    assert {path.name for path in out.iterdir() if "zones" in path.name} == {
        *three("case.zones-with-fig2"),
        "case.zones-with-fig2-pairs.csv",
    }


def test_tables_written_here_can_be_laid_over(tabulate, result, tmp_path):
    tabulate("profiles", result, "--load", 300, 540)
    tabulate("zones", result)
    written = tmp_path / "out" / "case.profiles-300-540.csv"
    (overlay,) = read_overlays([written], "x", profiles.CURVES, ["s", *profiles.PASSED_OVER])
    pressure = numbers(table(tmp_path, written.name)["pressure"])
    assert [len(overlay.columns["pressure"][rows]) for rows in overlay.curves("x")] == [21, 21]
    np.testing.assert_array_equal(overlay.columns["pressure"], pressure)
    tabulate("zones", result, "--with", tmp_path / "out" / "case.zones.csv")


@pytest.mark.parametrize(
    ("picture", "text", "message"),
    [
        ("profiles", "x,presure\n0,1\n", ":1: unknown column 'presure', nearest: 'pressure'"),
        ("profiles", "pressure\n1\n", "wanted: 'x' and at least one of pressure, shear, slave_temperature"),
        ("profiles", "x\n1\n", "columns are x; wanted: 'x' and at least one of"),
        ("profiles", "x,shear,x\n1,2,3\n", "stands twice"),
        ("profiles", "x,pressure\n0,1\n2\n", ":3: 1 fields, the heading has 2"),
        ("profiles", "x,pressure\n0,one\n", ":2: 'one' in column pressure is no number"),
        ("profiles", "x,pressure\n", "no rows"),
        ("profiles", "", "is empty"),
        ("zones", "x,pressure\n0,1\n", "wanted: 'load' and at least one of edge_contact"),
    ],
)
def test_a_digitised_figure_that_does_not_fit_is_refused(fail, result, picture, text, message):
    figure = result.with_name("figure.csv")
    figure.write_text(text)
    told = fail(picture, result, "--with", figure)
    assert str(figure) in told and message in told


def test_what_is_no_result_is_refused(fail, tmp_path):
    assert "no such file" in fail("mesh", tmp_path / "none.vtkhdf")
    (tmp_path / "text.vtkhdf").write_text("text")
    assert "is not an HDF5 file" in fail("mesh", tmp_path / "text.vtkhdf")
    with h5py.File(tmp_path / "other.vtkhdf", "w") as file:
        file["run"] = 1
    assert "not a thercon result" in fail("mesh", tmp_path / "other.vtkhdf")
    assert "is a folder" in fail("mesh", tmp_path)


def test_mistakes_on_the_command_line_have_status_1(fail, result):
    assert "invalid choice: 'zone'" in fail("zone", result)
    assert "--lod" in fail("profiles", result, "--lod", 540)
    assert "no field 'flux_x'" in fail("fields", result, "--quantity", "flux_x")


def test_help_of_every_picture(capsys):
    for picture in ([], ["mesh"], ["profiles"], ["zones"], ["fields"], ["convergence"], ["trade"],
                    ["accuracy"], ["courses"]):
        with pytest.raises(SystemExit) as ended:
            main([*picture, "--help"])
        assert ended.value.code == 0
        assert "usage: plot" in capsys.readouterr().out


SQUARE = np.array([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [2, 0.5], [1, 1], [0, 0.5]])
TRIANGLE = np.array([[0, 0], [2, 0], [0, 1], [1, 0], [1, 0.5], [0, 0.5]])


@pytest.mark.parametrize(
    ("kind", "points", "area", "degree"),
    [
        (23, SQUARE, 2.0, 2),
        (9, SQUARE[:4], 2.0, 1),
        (22, TRIANGLE, 1.0, 2),
        (5, TRIANGLE[:3], 1.0, 1),
    ],
)
def test_cut_elements_fill_their_area_and_carry_polynomials(kind, points, area, degree):
    one = {kind: np.arange(len(points))[None, :]}
    body = {kind: np.array([1])}
    cells = Cells(points.astype(float), np.arange(len(points)), one, body, body)
    fine = refine(cells, 4)
    (x, y), (a, b, c) = fine.values(cells.points).T, fine.triangles.T
    doubled = (x[b] - x[a]) * (y[c] - y[a]) - (x[c] - x[a]) * (y[b] - y[a])
    assert np.all(doubled > 0.0)
    np.testing.assert_allclose(0.5 * doubled.sum(), area, rtol=1e-13)
    np.testing.assert_allclose(fine.values((points[:, 0] + 1.0) ** degree), (x + 1.0) ** degree)


def test_bodies_share_no_points_of_the_cut_mesh_and_neighbours_do(result):
    with Result(result) as opened:
        cells = opened.cells
    fine = refine(cells, 3)
    (_, _, points), (bodies,) = fine.sources[0], cells.bodies.values()
    upper, lower = set(points[bodies == 1].ravel()), set(points[bodies == 2].ravel())
    assert not upper & lower
    # 10 by 4 elements cut in three: 31 by 13 points if neighbours share theirs.
    assert len(upper) == len(lower) == 31 * 13


def test_faces_are_the_boundary_edges_along_the_contact(result):
    with Result(result) as opened:
        cells, contact = opened.cells, opened.contact("CYLINDER")
        face = cells.face(contact["slave_node"])
    assert len(face) == 10
    x, y = cells.points[face.ravel()].T
    np.testing.assert_allclose(y, x**2 / 200.0, atol=1e-12)


def test_launcher_takes_the_python_of_the_build_and_names_missing_packages(tmp_path):
    for folder in (POST, POST.parent / "python"):
        shutil.copytree(folder, tmp_path / folder.name, ignore=shutil.ignore_patterns("__pycache__"))
    post = tmp_path / "post"
    bare = [sys.executable, "-S", "-E", str(post / "plot"), "--help"]
    told = subprocess.run(bare, capture_output=True, text=True, check=False)
    assert told.returncode == 2
    assert f"is missing; install the packages of {post / 'requirements.txt'}" in told.stderr
    python = tmp_path / "build" / "venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text('#!/bin/sh\necho "build: $*"\n')
    python.chmod(0o755)
    told = subprocess.run([post / "plot", "mesh", "a"], capture_output=True, text=True, check=False)
    assert told.stdout == f"build: {post / 'plot'} mesh a\n"


TRADE = ("row,default,elements,level,contact_level,increment_factor,varied,status,reason,"
         "increments,passes,runs,cpu_seconds,peak_megabytes,error_normal_force,error_heat_rate,"
         "error_peak_pressure,error_edge_contact,error_edge_stick,error_temperature,"
         "error_worst,pareto,recommended_10,recommended_1,recommended_0.1")  # fmt: skip


def changed(row, **values):
    """Return a row of a trade with other values in the columns named."""
    cells = row.split(",")
    for name, value in values.items():
        cells[TRADE.split(",").index(name)] = str(value)
    return ",".join(cells)


def write_trade(path, change=None):
    """Write a made-up table of a trade; `change` alters its rows."""
    rows = [
        "1,0,Q4,0,0,2,,0,,4,9,7,0.01,10,0.1,,0.2,0,,,0.2,1,all,,",
        "2,1,Q8,1,0,1,,0,,8,20,7,0.1,12,0.01,,0.004,1e-12,,,0.01,1,,all,",
        "3,0,Q8,1,0,1,MUMPS,0,,8,20,7,0.2,14,0.01,,0.004,1e-12,,,0.01,0,,,",
        '4,0,Q8,1,0,1,PICARD,2,"it fails, here",0,50,1,0.1,12,,,,,,,,0,,,',
        "5,0,Q8,0,2,1,,0,,8,20,7,0.05,11,0.02,,0.003,1e-12,,,0.02,1,,,",
        "reference,,,,,,,,,,,,,,0.001,,0.002,0,,,0.002,,,,",
    ]
    path.write_text("\n".join([TRADE, *(change(rows) if change else rows)]) + "\n")
    return path


def test_trade_draws_the_quantities_that_there_are(kept, tmp_path):
    (figure,) = kept("trade", write_trade(tmp_path / "deck.trade.csv"))
    titles = [axes.get_title(loc="left") for axes in figure.axes if axes.lines]
    assert titles == ["(a) worst of all", "(b) normal force", "(c) peak pressure"]
    words = figure.legends[0].get_title().get_text()
    assert words == "no panel, all errors below $10^{-6}$ %: edge of contact"
    force = figure.axes[1]
    points = {(line.get_xdata()[0], line.get_ydata()[0]) for line in force.lines
              if len(line.get_xdata()) == 1}  # fmt: skip
    assert points == {(0.01, 10.0), (0.05, 2.0), (0.1, 1.0), (0.2, 1.0)}
    diamonds = [line.get_xdata()[0] for line in force.lines if line.get_marker() == "D"]
    assert diamonds == [0.05]
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "failed, not drawn: 1" in labels
    assert "finer at the contact" in labels


def labelled_ticks(figure):
    """Return the number of tick labels that are seen on every axis of the panels that have curves."""
    found = []
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis) if axes.lines else ():
            low, high = sorted(axis.get_view_interval())
            found.append(sum(bool(tick.label1.get_text()) and low <= tick.get_loc() <= high
                             for tick in axis.get_major_ticks() + axis.get_minor_ticks()))
    return found


@pytest.mark.parametrize("factor", [3.0, 1e-5])
def test_axes_of_a_trade_have_two_labelled_ticks_at_least(laid_out, tmp_path, factor):
    def scaled(rows):
        near = [changed(row, cpu_seconds=0.03 * (1.0 + 0.1 * k),  # nearly one time
                        error_normal_force=factor * 0.004 * (1.0 + 0.2 * k),
                        error_peak_pressure=factor * 0.004, error_worst=factor * 0.005)
                for k, row in enumerate(rows[:3])]
        return [*near, rows[3], rows[5]]

    (figure,) = laid_out("trade", write_trade(tmp_path / "deck.trade.csv", scaled))
    found = labelled_ticks(figure)
    assert len(found) == 2 * 3 and min(found) >= 2


def test_another_method_far_off_does_not_stretch_the_scale_of_a_trade(kept, tmp_path):
    def spoilt(rows):
        return [*rows[:2], changed(rows[2], error_normal_force=90.0), *rows[3:]]

    (figure,) = kept("trade", write_trade(tmp_path / "deck.trade.csv", spoilt))
    force = figure.axes[1]
    low, high = force.get_ylim()
    assert low < 1.0 and 10.0 < high < 30.0
    (marked,) = [line for line in force.lines if line.get_marker() == "^"]
    assert marked.get_ydata()[0] == high and marked.get_xdata()[0] == 0.2
    assert "off the scale" in [text.get_text() for text in figure.legends[0].get_texts()]


def test_errors_of_a_trade_below_the_scale_are_marked_as_such(kept, tmp_path):
    def exact(rows):
        return [changed(rows[0], error_normal_force=0.0), *rows[1:]]

    (figure,) = kept("trade", write_trade(tmp_path / "deck.trade.csv", exact))
    (marked,) = [line for line in figure.axes[1].lines if line.get_marker() == "v"]
    low, _ = figure.axes[1].get_ylim()
    assert marked.get_ydata()[0] == low > trade.SMALLEST
    assert "below the scale" in [text.get_text() for text in figure.legends[0].get_texts()]


def test_an_uncertainty_below_the_scale_is_told_and_not_drawn_elsewhere(kept, tmp_path):
    dashed = []
    for known in ({}, {"error_worst": 1e-3}, {"error_worst": 1e-12}):
        unknown = dict.fromkeys(["error_normal_force", "error_peak_pressure", "error_edge_contact"], "")
        (figure,) = kept("trade", write_trade(
            tmp_path / "deck.trade.csv",
            lambda rows, known=known: [*rows[:-1], changed(rows[-1], **{"error_worst": "", **unknown, **known})]))
        lines = [line for line in figure.axes[0].lines if line.get_linestyle() == "--"]
        words = [text.get_text() for text in figure.axes[0].texts]
        named = [text.get_text() for text in figure.legends[0].get_texts()]
        dashed.append((len(lines), "uncertainty below $10^{-6}$ %" in words,
                       "uncertainty of the reference" in named))
    assert dashed == [(0, False, False), (1, False, True), (0, True, False)]


@pytest.mark.parametrize(("errors", "curves"), [
    ((0.1, 0.01), 1), ((0.1, 1e-12), 1), ((0.1, ""), 0), ((1e-12, 1e-13), 0),
])
def test_a_pareto_curve_is_in_the_legend_where_it_is_in_the_picture(kept, tmp_path, errors, curves):
    """One row is no curve, and none is seen of rows below the scale."""
    def optimal(rows):
        best = [changed(row, error_worst=error or 0.5, pareto="1" if error else "0")
                for row, error in zip(rows, errors)]
        return [*best, changed(rows[4], pareto="0"), rows[5]]

    (figure,) = kept("trade", write_trade(tmp_path / "deck.trade.csv", optimal))
    worst = figure.axes[0]
    drawn = [line for line in worst.lines if line.get_color() == style.BLUE]
    assert len(drawn) == curves
    assert all(line.get_ydata().min() >= worst.get_ylim()[0] for line in drawn)
    named = [text.get_text() for text in figure.legends[0].get_texts()]
    assert named.count("Pareto-optimal") == curves


def test_trade_leaves_its_table_alone(draw, tmp_path):
    table = write_trade(tmp_path / "deck.trade.csv")
    before = table.read_text()
    assert draw("trade", table) == ["deck.trade.png", "deck.trade.svg"]
    assert table.read_text() == before


def test_what_is_no_trade_is_refused(fail, result, tmp_path):
    assert "cannot be read" in fail("trade", tmp_path / "none.csv")
    assert "cannot be read" in fail("trade", result)
    other = tmp_path / "other.csv"
    other.write_text("load,edge\n1,2\n")
    assert "no table of thercon trade: no column row" in fail("trade", other)
    empty = write_trade(tmp_path / "empty.trade.csv", lambda rows: [rows[3], rows[5]])
    assert "nothing to draw" in fail("trade", empty)


def test_accuracy_draws_each_target_against_the_cost(laid_out, fail, result, tmp_path):
    """Uncertainties over targets, at the CPU seconds of all rounds so far."""
    assert "no accuracy was requested" in fail("accuracy", result)
    asked = tmp_path / "asked.vtkhdf"
    asked.write_bytes(result.read_bytes())
    with h5py.File(asked, "a") as file:
        group = file.create_group("accuracy")
        group["cpu_seconds"], group["unknowns"] = [0.1, 0.3], [100, 900]
        group["elements"], group["increments"] = [10, 40], [15, 15]
        group["uncertainty/CYLINDER/normal_force"] = [[1, 5.0, 0.4, 0.1], [1, 5.1, 0.05, 0.1]]
        group["uncertainty/CYLINDER/heat_rate"] = np.zeros((2, 4))
    (figure,) = laid_out("accuracy", asked)
    (line, limit) = figure.axes[0].get_lines()
    np.testing.assert_allclose(line.get_xdata(), [0.1, 0.4])
    np.testing.assert_allclose(line.get_ydata(), [4.0, 0.5])
    assert list(limit.get_ydata()) == [1.0, 1.0]
    with h5py.File(asked, "a") as file:
        file["accuracy/uncertainty/CYLINDER/normal_force"][...] = [[1, 5.0, np.nan, 0.1], [1, 5.1, 1e-9, 0.1]]
    (figure,) = laid_out("accuracy", asked)
    (_, foot, top, *_) = figure.axes[0].get_lines()
    assert (foot.get_marker(), list(foot.get_xdata())) == ("v", [0.4])
    assert (top.get_marker(), list(top.get_xdata())) == ("^", [0.1])
    # At the frame, wherever the uncertainties of others lie.
    height = figure.axes[0].transAxes.inverted().transform(
        top.get_transform().transform([[0.1, top.get_ydata()[0]]]))[0, 1]
    assert height == pytest.approx(1.0)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        "CYLINDER normal force, target 0.1 (no estimate in round 1)", "target", "below the scale",
        "no estimate"]
    with h5py.File(asked, "a") as file:
        file["accuracy/uncertainty/CYLINDER/normal_force"][...] = [[1, 5.0, 0.4, 0.1], [0, 0.0, 0.0, 0.0]]
    (figure,) = laid_out("accuracy", asked)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        "CYLINDER normal force, target 0.1", "target"]


@pytest.mark.parametrize(("uncertainties", "line", "marker"), [
    ((4.0, 0.5), "-", "o"), ((np.nan, 0.5), "None", "o"), ((1e-9, 1e-9), "None", "v"),
    ((np.nan, np.nan), "None", "^"), ((np.nan, 1e-9), "None", "v"),
])
def test_the_legend_of_an_accuracy_shows_what_is_drawn(kept, result, uncertainties, line, marker):
    with h5py.File(result, "a") as file:
        group = file.create_group("accuracy")
        group["cpu_seconds"], group["unknowns"] = [0.1, 0.3], [100, 900]
        group["elements"], group["increments"] = [10, 40], [15, 15]
        rows = [[1, 1e4, 340.0 * each, 340.0] for each in uncertainties]
        group["uncertainty/CYLINDER/normal_force"] = rows
    (figure,) = kept("accuracy", result)
    handle = figure.legends[0].legend_handles[0]
    assert (handle.get_linestyle(), handle.get_marker()) == (line, marker)
    assert "target 340" in figure.legends[0].get_texts()[0].get_text()


def test_numbers_are_written_as_people_write_them():
    words = [style.number_words(value) for value in (0.0, 0.05, 340.0, 1900.0, 3.4e7, 1e-6, 2e-6)]
    assert words == ["0", "0.05", "340", "1900", r"$3.4\times10^{7}$", "$10^{-6}$",
                     r"$2\times10^{-6}$"]  # fmt: skip


def test_a_table_holds_no_formula_of_a_spreadsheet_and_plain_numbers(tmp_path):
    texts = ["=1+1", "+1", "-1", "@A1", "\t=1", "A=1"]
    tables.write_table(tmp_path / "table.csv", {"=label": texts, "x": np.linspace(-1.0, 0.5, 6)})
    with (tmp_path / "table.csv").open(newline="") as file:
        heading, *rows = csv.reader(file)
    assert tables.cell("\r=1") == "'\r=1"
    assert heading == ["'=label", "x"]
    assert [row[0] for row in rows] == [*("'" + text for text in texts[:-1]), "A=1"]
    assert [float(row[1]) for row in rows] == pytest.approx(np.linspace(-1.0, 0.5, 6))


@pytest.mark.parametrize("gap", [0.0, 0.01])
@pytest.mark.parametrize("pairing", ["NODES", "SURFACES", "rigid"])
def test_faces_that_touch_in_the_mesh_do_not_seem_to_overlap(tmp_path, gap, pairing):
    """Magnified, only faces that close a gap of the mesh are drawn beyond each other."""
    deck = tmp_path / "touch.inp"
    lower, upper = [(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1 + gap), (1, 1 + gap), (1, 2), (0, 2)]
    low, choice = ["*SURFACE, NAME=LOW", "1, S3"], f", PAIRING={pairing}"
    if pairing == "rigid":
        lower = [(x, y - 5) for x, y in lower]
        low, choice = ["*SURFACE, NAME=LOW, TYPE=SEGMENTS", "START, -1., 1.", "LINE, 2., 1.",
                       "*RIGID BODY, REF NODE=9, ANALYTICAL SURFACE=LOW", "*BOUNDARY", "9, 1, 2", "9, 6"], ""
    deck.write_text("\n".join([
        "*NODE", *(f"{n}, {x}, {y}" for n, (x, y) in enumerate([*lower, *upper, (0, 1)], 1)),
        "*ELEMENT, TYPE=CPE4, ELSET=E", "1, 1, 2, 3, 4", "2, 5, 6, 7, 8", "*MATERIAL, NAME=M",
        "*ELASTIC", "1000., 0.", "*SOLID SECTION, ELSET=E, MATERIAL=M", "*SURFACE, NAME=UP", "2, S1",
        *low, "*SURFACE INTERACTION, NAME=I", f"*CONTACT PAIR, INTERACTION=I, NAME=C{choice}", "UP, LOW", "*STEP", "*STATIC",
        "*BOUNDARY", "1, 1, 2", "2, 1, 2", "5, 1", "6, 1", "7, 1", "8, 1", "7, 2, 2, -0.02",
        "8, 2, 2, -0.02", "*END STEP", ""]))
    status, said = program.run(deck)
    assert status == 0, said
    with Result(deck.with_suffix(".vtkhdf")) as result:
        assert ("seem to overlap" in fields.words_below(result, 0, 20.0)) == (gap > 0.0)
