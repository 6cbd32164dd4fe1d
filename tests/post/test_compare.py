"""post/compare: what is matched with what, and what counts as equal."""

import csv

import h5py
import numpy as np
import pytest
from comparing import (  # noqa: F401  fixtures
    blocks_of,
    compare,
    line_of,
    refused,
    write_csv,
)
from synthetic import edge_of_contact, write_result

from thercon.post import style


def pairs_table(path, rows):
    """Return the pairs of a result at some rows of its history as a long table."""
    with h5py.File(path) as file:
        contact = {key: item[()] for key, item in file["contact/CYLINDER"].items()}
        times = file["history/time"][()][rows]
    count = len(contact["x"])
    columns = {"time": np.repeat(times, count)}
    for key, name in (("slave_node", "node"), ("x", "x"), ("y", "y")):
        columns[name] = np.tile(contact[key], len(rows))
    for key in ("pressure", "shear", "status"):
        columns[key] = contact[key][rows].ravel()
    return columns


def shuffled(columns, seed=1):
    """Return a table with its lines in another order."""
    order = np.random.default_rng(seed).permutation(len(columns["time"]))
    return {name: np.asarray(values)[order] for name, values in columns.items()}


def only(columns, *names):
    """Return some columns of a table."""
    return {name: columns[name] for name in names}


def test_a_result_equals_itself_in_every_quantity_named_with_or_without_its_ending(compare, result):
    status, said, _ = compare(result, result.with_suffix(""), "--block", 0)
    assert status == 0
    assert said.splitlines()[-1] == "all within tolerance"
    for quantity in ("pressure", "status", "NT", "U1", "S12", "edge_contact", "stress_error@body2"):
        line = line_of(said, quantity)
        assert line["ok"] and line["rows"] > 0 and line["not_in_a"] == line["not_in_b"] == 0


def test_nodes_of_no_element_are_left_out(compare, result):
    """Theirs are no displacements; a midside node that no element has any more."""
    def rows():
        return line_of(compare(result, result, "--block", 0)[1], "U1")["rows"]

    before = rows()
    with h5py.File(result, "r+") as file:
        grid = file["VTKHDF"]
        nodes = grid["Connectivity"][()]
        left = np.flatnonzero(np.bincount(nodes)[nodes] == 1)[0]
        nodes[left] = nodes[left - 1]
        grid["Connectivity"][...] = nodes
        times = len(grid["Steps/Values"])
    assert before - rows() in (1, times)


def test_rows_meet_by_node_whatever_the_order_of_the_lines(compare, result, tmp_path):
    columns = only(pairs_table(result, [2, 8]), "time", "node", "pressure", "shear", "status")
    legacy = write_csv(tmp_path / "b.csv", shuffled(columns))
    status, said, _ = compare(result, legacy, "--block", 0)
    assert status == 0
    line = line_of(said, "pressure")
    assert (line["by"], line["times"], line["rows"]) == ("node", 2, 42)
    assert "pressure: 13 times not in B" in said


def test_one_wrong_value_is_found_at_its_node_and_time(compare, result, tmp_path):
    columns = pairs_table(result, [2, 8])
    columns["pressure"][21 + 4] += 0.5
    legacy = write_csv(tmp_path / "b.csv", shuffled(only(columns, "time", "node", "pressure")))
    assert compare(result, legacy)[0] == 1
    wrong = [row for row in blocks_of(tmp_path) if row["passed"] == "False"]
    assert [float(row["at"]) for row in wrong] == [540.0]
    assert f"node {columns['node'][4]:g} " in wrong[0]["where"]
    assert float(wrong[0]["largest_difference"]) == pytest.approx(0.5, rel=1e-12)


def test_rows_meet_by_coordinate_under_other_numbers_and_among_more_points(
    compare, result, tmp_path
):
    columns = shuffled(pairs_table(result, [2, 8]))
    more = {name: values.copy() for name, values in columns.items()}
    more["x"] = more["x"] + 0.05
    both = {name: np.concatenate((columns[name], more[name])) for name in columns}
    legacy = write_csv(tmp_path / "b.csv", only(both, "time", "x", "y", "pressure", "status"))
    status, said, _ = compare(result, legacy, "--block", 0)
    assert status == 0
    line = line_of(said, "pressure")
    assert (line["by"], line["rows"], line["not_in_a"]) == ("coordinate", 42, 42)


@pytest.mark.parametrize("shift, met", [(0.9e-3, 21), (1.1e-3, 0)])
def test_places_are_the_same_within_the_distance_asked_for(compare, result, tmp_path, shift, met):
    columns = pairs_table(result, [8])
    columns["x"] = columns["x"] + shift
    legacy = write_csv(tmp_path / "b.csv", only(columns, "time", "x", "y", "pressure"))
    status, said, error = compare(result, legacy, "--within", 1e-3)
    assert status == (0 if met else 2)
    assert line_of(said, "pressure")["rows"] == met if met else "no row of one meets" in error


def test_places_with_two_points_are_left_out_and_counted(compare, result, tmp_path):
    columns = pairs_table(result, [8])
    twice = {name: np.append(values, values[3]) for name, values in columns.items()}
    twice["pressure"][-1] += 7.0
    legacy = write_csv(tmp_path / "b.csv", only(twice, "time", "x", "y", "pressure"))
    status, said, _ = compare(result, legacy)
    assert status == 0
    line = line_of(said, "pressure")
    assert (line["rows"], line["not_in_a"], line["not_in_b"]) == (20, 0, 0)
    assert "1 rows at places with several points left out" in said
    assert compare(result, legacy, "--all-keys")[0] == 1


def test_two_rows_of_a_at_one_place_are_ambiguous_too(compare, tmp_path):
    two = {"node": [1, 2, 3], "x": [0.0, 0.0, 1.0], "y": [0.0, 0.0, 1.0], "T": [5.0, 6.0, 7.0]}
    first = write_csv(tmp_path / "case.csv", two)
    one = {"x": [1.0, 0.0], "y": [1.0, 0.0], "T": [7.0, 5.0]}
    status, said, _ = compare(first, write_csv(tmp_path / "b.csv", one))
    assert status == 0
    assert line_of(said, "T")["rows"] == 1
    assert "2 rows at places with several points left out" in said


def test_missing_keys_are_counted_on_both_sides(compare, result, tmp_path):
    columns = pairs_table(result, [8])
    columns["node"][[0, 5]] = 7001, 7002
    columns = {name: values[:-1] for name, values in columns.items()}
    legacy = write_csv(tmp_path / "b.csv", only(columns, "time", "node", "pressure"))
    status, said, _ = compare(result, legacy)
    assert status == 0
    line = line_of(said, "pressure")
    assert (line["rows"], line["not_in_a"], line["not_in_b"]) == (18, 2, 3)
    assert "node 7001, node 7002" in said
    status, said, _ = compare(result, legacy, "--all-keys")
    assert status == 1 and "DIFFERS" in said


@pytest.mark.parametrize("key, shift", [("node", 9000), ("time", 7.0)])
def test_nothing_in_common_is_an_error(refused, result, tmp_path, key, shift):
    columns = only(pairs_table(result, [8]), "time", "node", "pressure")
    columns[key] = columns[key] + shift
    said = refused(result, write_csv(tmp_path / "b.csv", columns))
    assert "share pressure, but no row of one meets a row of the other" in said


def test_files_without_a_common_quantity_name_what_they_have(refused, result, tmp_path):
    legacy = write_csv(tmp_path / "b.csv", {"node": [1], "PRESS": [2.0]})
    said = refused(result, legacy)
    assert "no quantity in common" in said and "PRESS" in said and "pressure" in said


def test_equal_numbers_at_other_places_are_no_match(refused, compare, result, tmp_path):
    columns = pairs_table(result, [8])
    columns["x"] = columns["x"][::-1].copy()
    legacy = write_csv(tmp_path / "b.csv", only(columns, "time", "node", "x", "y", "pressure"))
    assert "--by coordinate or --by curve" in refused(result, legacy)


def test_a_key_that_stands_twice_with_two_values_is_an_error(refused, compare, result, tmp_path):
    columns = only(pairs_table(result, [8]), "time", "node", "pressure")
    twice = {name: np.append(values, values[2]) for name, values in columns.items()}
    assert compare(result, write_csv(tmp_path / "b.csv", twice))[0] == 0
    twice["pressure"][-1] += 1.0
    said = refused(result, write_csv(tmp_path / "b.csv", twice))
    assert f"node {columns['node'][2]} twice with other values" in said


# B is 100 and 1 at two nodes; A is B + 2 at both. So the largest value is 100.
@pytest.mark.parametrize(
    "tolerance, passed",
    [
        (["--abs", 2.001], True),
        (["--abs", 1.999], False),
        (["--rel", 2.001], True),  # of 1, at the second node
        (["--rel", 1.999], False),
        (["--block", 0.02001], True),
        (["--block", 0.01999], False),
        (["--abs", 1.0, "--block", 0.01001], True),  # they add up
        (["--abs", 1.0, "--block", 0.00999], False),
        (["--abs", 9, "--tol", "T=abs:1.999"], False),
        (["--tol", "T=abs:1,block:0.01001"], True),
    ],
)
def test_each_tolerance_just_inside_and_just_outside(compare, tmp_path, tolerance, passed):
    nodes = {"node": [1, 2]}
    first = write_csv(tmp_path / "case.csv", nodes | {"T": [102.0, 3.0]})
    second = write_csv(tmp_path / "b.csv", nodes | {"T": [100.0, 1.0]})
    usual = [] if "--block" in tolerance else ["--block", 0]
    assert compare(first, second, *usual, *tolerance)[0] == (0 if passed else 1)


def test_the_largest_value_is_that_of_the_time_and_of_b(compare, tmp_path):
    keys = {"time": [1, 1, 2, 2], "node": [1, 2, 1, 2]}
    first = write_csv(tmp_path / "case.csv", keys | {"T": [1.0, 1.05, 1000.0, 0.0]})
    second = write_csv(tmp_path / "b.csv", keys | {"T": [1.0, 1.0, 1000.0, 0.05]})
    compare(first, second, "--block", 0.01)
    assert [row["passed"] for row in blocks_of(tmp_path)] == ["False", "True"]


@pytest.mark.parametrize(("theirs", "status"), [(-3e-9, 0), (3e-8, 1)])
def test_rounding_equals_rounding(compare, tmp_path, theirs, status):
    """S12 is measured by the largest stress of all times, here 10."""
    one = {"time": [1.0, 2.0], "node": [1, 1], "S11": [10.0, 1e-9], "S12": [1e-12, 1e-12]}
    other = one | {"S11": [10.0, -1e-9], "S12": [2e-12, theirs]}
    files = [write_csv(tmp_path / f"{n}.csv", each) for n, each in (("a", one), ("b", other))]
    found, said, _ = compare(*files)
    assert found == status
    assert f"S12: {2 - status} rows of rounding in both" in said


@pytest.mark.parametrize(("name", "beside"), [
    ("shear", "pressure"), ("MISES", "S22"), ("heat_rate@A", "heat_rate@B"), ("slip", "U1"),
    ("RFL@TOP", "heat_in"), ("shear_force", "normal_force"), ("stress_error@body1", None),
])  # fmt: skip
def test_rounding_is_measured_by_all_quantities_of_its_kind(compare, tmp_path, name, beside):
    one = {"time": [1.0, 2.0], name: [3e-10, -2e-13]}
    other = {"time": [1.0, 2.0], name: [1e-14, 1e-13]}
    files = [write_csv(tmp_path / f"{n}.csv", each) for n, each in (("a", one), ("b", other))]
    found, said, _ = compare(*files)
    assert (found == 0) == (beside is None)
    for largest, status in ((345.0, 0), (0.01, 1)):
        more = {beside: [largest, largest]} if beside else {}
        for path, columns in zip(files, (one, other)):
            write_csv(path, columns | more)
        found, said, _ = compare(*files)
        assert found == (status if beside else 0)
        assert line_of(said, name)["ok"] == (found == 0)


def test_a_displacement_is_not_measured_by_the_place_of_an_edge(compare, tmp_path):
    columns = {"time": [1.0, 2.0], "U1": [1e-9, 2e-9], "edge_contact": [1e3, 1e3]}
    files = [write_csv(tmp_path / "a.csv", columns)]
    files += [write_csv(tmp_path / "b.csv", columns | {"U1": [1e-9, 3e-9]})]
    assert compare(*files)[0] == 1


def test_nan_equals_nan_and_nothing_else(compare, tmp_path):
    nodes = {"node": [1, 2]}
    first = write_csv(tmp_path / "case.csv", nodes | {"T": [np.nan, 3.0]})
    status, said, _ = compare(first, first)
    assert status == 0 and "1 rows NaN in both, taken as equal" in said
    second = write_csv(tmp_path / "b.csv", nodes | {"T": [1.0, 3.0]})
    assert compare(first, second, "--abs", 1e9)[0] == 1
    assert compare(second, first, "--abs", 1e9)[0] == 1


def test_empty_fields_are_missing_and_counted(compare, tmp_path):
    nodes = {"node": [1, 2]}
    first = write_csv(tmp_path / "case.csv", nodes | {"T": [5.0, 3.0]})
    second = write_csv(tmp_path / "b.csv", nodes | {"T": ["", "3.D0"]})
    status, said, _ = compare(first, second, "--block", 0)
    assert status == 0 and "1 rows with a missing value left out" in said
    assert compare(first, second, "--all-keys")[0] == 1


@pytest.mark.parametrize("allowed, status", [(3, 0), (2, 1)])
def test_states_are_compared_by_counting_mismatches(compare, result, tmp_path, allowed, status):
    columns = pairs_table(result, [2, 8])
    columns["status"][[1, 3, 4]] = (columns["status"][[1, 3, 4]] + 1) % 3
    legacy = write_csv(tmp_path / "b.csv", only(columns, "time", "node", "status"))
    got, said, _ = compare(result, legacy, "--mismatches", allowed, "--abs", 10)
    assert got == status
    assert line_of(said, "status")["rest"][:2] == ["3", "states"]


def test_a_profile_on_other_abscissae_is_interpolated(compare, result, tmp_path):
    # The pressure that B has is the straight line 3 x - 7, so that interpolation is exact.
    with h5py.File(result, "r+") as file:
        contact = file["contact/CYLINDER"]
        contact["pressure"][8] = 3.0 * contact["x"][()] - 7.0
    x = np.array([11.3, 0.7, 4.1, 18.0, 2.9])
    legacy = write_csv(
        tmp_path / "b.csv", {"time": np.full(5, 540.0), "x": x, "pressure": 3 * x - 7}
    )
    status, said, _ = compare(result, legacy, "--block", 1e-12)
    with h5py.File(result) as file:
        at = file["contact/CYLINDER/x"][()]
    inside = int(((at >= 0.7) & (at <= 18.0)).sum())
    assert status == 0
    line = line_of(said, "pressure")
    assert (line["by"], line["rows"], line["not_in_b"]) == ("curve", inside, 21 - inside)


def test_a_face_without_growing_x_is_a_curve_over_s(compare, refused, result):
    with h5py.File(result, "r+") as file:
        file["contact/CYLINDER/x"][()] = 4.0
    status, said, _ = compare(result, result, "--by", "curve", "--block", 0)
    assert status == 0
    line = line_of(said, "pressure")
    assert (line["by"], line["rows"]) == ("curve", 15 * 21)
    assert "NT" not in [line.split()[0] for line in said.splitlines()]  # a plane is no curve
    said = refused(result, result, "--by", "curve", "--along", "x")
    assert "B has several rows at x = 4: no curve over x" in said


def test_a_digitised_history_is_compared_along_the_load(compare, result, tmp_path):
    loads = np.linspace(100.0, 800.0, 400)
    columns = {"load": loads, "edge_contact": edge_of_contact(loads)}
    legacy = write_csv(tmp_path / "b.csv", columns)
    with h5py.File(result, "r+") as file:
        file["contact/CYLINDER/edge_contact"][()] = edge_of_contact(file["history/load"][()])
    status, said, _ = compare(result, legacy, "--by", "curve", "--block", 1e-4)
    assert status == 0
    # Loads are 60, 120 ... 900: all but 60, 840 and 900 lie within the curve.
    line = line_of(said, "edge_contact")
    assert (line["by"], line["rows"], line["not_in_b"]) == ("curve", 12, 3)
    assert compare(result, legacy, "--by", "curve", "--block", 1e-9)[0] == 1


def test_names_units_times_and_signs_are_mapped(compare, result, tmp_path):
    columns = pairs_table(result, [2, 8])
    legacy = write_csv(
        tmp_path / "b.csv",
        {
            "time": columns["time"] / 60.0,
            "NO": columns["node"] - 1000,
            "P": 10.0 * columns["pressure"],
            "TAU": -columns["shear"],
            "OFF": 2.0 * columns["status"] - 3.0,
        },
    )
    maps = [
        "node=NO + 1000",
        "pressure=0.1*P",
        "shear=-TAU",
        "time=60*time",
        "status=0.5*OFF + 1.5",
    ]
    maps = [word for each in maps for word in ("--map", each)]
    status, said, _ = compare(result, legacy, *maps, "--block", 1e-14)
    assert status == 0
    assert all(line_of(said, name)["rows"] == 42 for name in ("pressure", "shear", "status"))


def test_times_are_chosen_and_axes_too(compare, refused, result, tmp_path):
    columns = only(pairs_table(result, [2, 8]), "time", "node", "pressure")
    columns["load"] = columns.pop("time")
    legacy = write_csv(tmp_path / "b.csv", columns)
    status, said, _ = compare(result, legacy, "--at", 540)
    assert status == 0 and line_of(said, "pressure")["times"] == 1
    assert "no common axis" in refused(result, legacy, "--axis", "time")
    assert "no row of one meets" in refused(result, legacy, "--at", 541)


def test_a_table_without_time_meets_the_last_increment(compare, result, tmp_path):
    columns = only(pairs_table(result, [14]), "node", "pressure")
    legacy = write_csv(tmp_path / "b.csv", columns)
    assert compare(result, legacy, "--block", 0)[0] == 0
    assert compare(result, legacy, "--block", 0, "--at", 540)[0] == 1


def test_several_contacts_are_told_apart(compare, refused, tmp_path):
    path = tmp_path / "case.vtkhdf"
    write_result(path, contacts=("LEFT", "RIGHT"))
    assert compare(path, path, "--block", 0)[0] == 0
    columns = pairs_table_of(path, "RIGHT")
    named = write_csv(tmp_path / "b.csv", columns | {"contact": ["RIGHT"] * 21})
    status, said, _ = compare(path, named, "--block", 0)
    assert status == 0 and line_of(said, "pressure")["rows"] == 21
    plain = write_csv(tmp_path / "c.csv", columns)
    assert "--contact" in refused(path, plain)
    assert compare(path, plain, "--contact", "RIGHT", "--block", 0)[0] == 0
    assert "nearest: 'RIGHT'" in refused(path, plain, "--contact", "RIGT")


def pairs_table_of(path, name):
    """Return nodes and pressures of one contact at the last increment."""
    with h5py.File(path) as file:
        contact = file[f"contact/{name}"]
        nodes, values = contact["slave_node"][()], contact["pressure"][-1]
    return {"time": np.full(21, 900.0), "node": nodes, "pressure": values}


def test_every_compared_row_is_written_on_request(compare, result, tmp_path):
    columns = only(pairs_table(result, [8]), "time", "node", "pressure")
    legacy = write_csv(tmp_path / "b.csv", shuffled(columns))
    compare(result, legacy, "--rows")
    with open(tmp_path / "out" / "case.compare-rows.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [int(row["node"]) for row in rows] == list(columns["node"])
    np.testing.assert_array_equal([float(row["b"]) for row in rows], columns["pressure"])


def test_each_map_of_differences_has_one_colour_bar(compare, result, tmp_path, monkeypatch):
    """Of two B the maps would lie on each other; profiles of both have one panel."""
    figures, write = [], style.write
    monkeypatch.setattr(style, "write", lambda figure, *rest: (figures.append(figure), write(figure, *rest))[1])
    others = [tmp_path / f"{name}.vtkhdf" for name in ("cold", "hot")]
    for path, factor in zip(others, (0.5, 2.0)):
        write_result(path)
        with h5py.File(path, "r+") as file:
            for name in ("temperature", "displacement"):
                file[f"VTKHDF/PointData/{name}"][...] *= factor
    compare(result, *others, "--only", "NT", "U1", "pressure", picture=True)
    panels = [axes for axes in figures[0].axes if axes.get_label() != "<colorbar>" and axes.axison]
    titles = [axes.get_title(loc="left").split(" ", 1)[1] for axes in panels]
    assert [title.partition(",")[0] for title in titles] == ["pressure", "NT", "NT", "U1", "U1"]
    assert [title.rpartition(", ")[2] for title in titles[1:]] == 2 * ["cold.vtkhdf", "hot.vtkhdf"]
    assert sum(axes.get_label() == "<colorbar>" for axes in figures[0].axes) == 4
    assert all(len(axes.collections) == 1 for axes in panels[1:])


def test_a_picture_is_drawn_for_every_kind_of_table(compare, result, tmp_path):
    other = tmp_path / "other.vtkhdf"
    write_result(other, loads=tuple(np.arange(180.0, 901.0, 180.0)))
    quantities = ["pressure", "edge_contact", "NT", "status"]
    arguments = [result, other, other, "--csv", "--only", *quantities, "--at", 180, 540]
    status, said, error = compare(*arguments, picture=True)
    assert (status, error) == (0, "")
    for ending in ("png", "svg", "csv"):
        path = tmp_path / "out" / f"case.compare.{ending}"
        assert path.stat().st_size > 0 and str(path) in said
    with open(tmp_path / "out" / "case.compare.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["panel"] for row in rows} == set(quantities)
    assert {row["at"] for row in rows if row["panel"] == "pressure"} == {"180.0", "540.0"}


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["--only", "presure"], "nearest: 'pressure'"),
        (["--map", "pressure"], "write NAME=OTHER"),
        (["--map", "pressure=NOTHING"], "no B has a quantity or key 'NOTHING'"),
        (["--tol", "pressure=0.1"], "write QUANTITY=abs:A"),
        (["--tol", "pressure=block:-1"], "not negative"),
        (["--tol", "presure=block:1"], "is not compared"),
        (["--abs", "-1"], "not negative"),
        (["--by", "line"], "invalid choice"),
        (["--draw", "presure"], "is not compared"),
    ],
)
def test_wrong_options_are_named(refused, result, arguments, words):
    assert words in refused(result, result, *arguments)


def test_files_that_cannot_be_read_are_named(refused, result, tmp_path):
    cases = {
        "no.vtkhdf": (None, "no such file"),
        "text.vtkhdf": ("hello", "HDF5"),
        "junk.frd": ("hello\n", "no nodes, as"),
        "empty.dat": ("", "no line fits"),
        "plain.lst": ("hello\n", "needs --template"),
        "head.csv": ("node,T\n", "a heading and no rows"),
        "twice.csv": ("node,T,T\n1,2,3\n", "stands twice"),
        "short.csv": ("node,T\n1,2\n1\n", "short.csv:3: 1 fields"),
        "word.csv": ("node,T\n1,abc\n", "word.csv:2: 'abc' in column T is no number"),
        "key.csv": ("node,T\n,2\n", "column node has empty fields"),
    }
    for name, (text, words) in cases.items():
        path = tmp_path / name
        if text is not None:
            path.write_text(text)
        assert words in refused(result, path)


def test_help_says_the_exit_status(capsys):
    from thercon.post.comparison.cli import main

    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    said = capsys.readouterr().out
    assert "exit status: 0 all within tolerance; 1 something is not; 2 wrong usage" in said


@pytest.fixture
def sections(tmp_path):
    """Return a function that writes a result with two sections along x = 1, and a table of its nodes.

    Nodes 2 and 5 are points 1 and 4 of the left section, 6 and 7 of the right one, with the same
    displacement and another stress.
    """

    def call(name, right=(6, 7)):
        path = tmp_path / f"{name}.vtkhdf"
        write_result(path, contacts=(), loads=(1.0,), columns=1, rows=1)
        points = np.zeros((8, 3))
        points[:, :2] = [[0, 0], [1, 0], [2, 0], [2, 1], [1, 1], [0, 1], [1, 0], [1, 1]]
        nodes = np.array([1, 2, 3, 4, 5, 6, 2, 5])
        stress = np.zeros((8, 4))
        stress[:, 0] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 20.0, 50.0]
        moved = np.zeros((8, 3))
        moved[:, 0] = 0.1 * nodes
        with h5py.File(path, "r+") as file:
            grid = file["VTKHDF"]
            for key in ("PointData", "CellData", "Points", "Types", "Offsets", "Connectivity"):
                del grid[key]
            grid["Points"], grid["Types"], grid["Offsets"] = points, np.array([9, 9]), [0, 4, 8]
            grid["Connectivity"] = [0, 1, 4, 5, right[0], 2, 3, right[1]]
            grid["CellData/body"], grid["CellData/material"] = [1, 1], [1, 2]
            grid["PointData/node_id"] = nodes
            grid["PointData/stress"], grid["PointData/displacement"] = stress, moved
        return path

    return call


def test_nodes_of_two_sections_are_compared_side_by_side(compare, sections):
    """Every point of a result meets itself; another stress on one side of a node is found."""
    first, second = sections("one"), sections("two")
    status, said, _ = compare(first, second, "--all-keys")
    assert status == 0
    for quantity in ("U1", "S11"):
        line = line_of(said, quantity)
        assert (line["rows"], line["not_in_a"], line["not_in_b"]) == (8, 0, 0)
    with h5py.File(second, "r+") as file:
        file["VTKHDF/PointData/stress"][6, 0] = 21.0
    status, said, _ = compare(first, second, "--only", "S11")
    assert status == 1 and "node 2 x=1 y=0" in said


@pytest.mark.parametrize("is_a", [True, False])
def test_a_file_with_a_node_once_meets_both_of_its_points_where_they_agree(compare, sections, tmp_path,
                                                                           is_a):
    """The displacement is that of both sections. Which stress is meant is open: it is left out."""
    rows = {"node": np.arange(1, 7), "x": [0, 1, 2, 2, 1, 0], "y": [0, 0, 0, 1, 1, 1],
            "U1": 0.1 * np.arange(1, 7), "S11": [1.0, 11.0, 3.0, 4.0, 27.5, 6.0]}
    files = [sections("one"), write_csv(tmp_path / "mean.csv", rows)]
    status, said, _ = compare(*(files if is_a else files[::-1]))
    assert status == 0
    moved, stress = line_of(said, "U1"), line_of(said, "S11")
    assert (moved["rows"], moved["not_in_a"], moved["not_in_b"]) == (6, 0, 0)
    assert (stress["rows"], stress["not_in_a"], stress["not_in_b"]) == (4, 0, 0)
    assert "S11: 2 rows at places with several points left out" in said and "U1: " not in said
    assert compare(*files, "--all-keys")[0] == 1
    rows["U1"][1] += 0.01
    write_csv(tmp_path / "mean.csv", rows)
    status, said, _ = compare(*(files if is_a else files[::-1]), "--only", "U1")
    assert status == 1 and "node 2 x=1 y=0" in said


def test_a_result_without_increments_is_named(refused, result):
    with h5py.File(result, "r+") as file:
        for group in ("history", "VTKHDF/Steps"):
            for name, item in list(file[group].items()):
                if isinstance(item, h5py.Dataset):
                    empty = item[:0]
                    del file[group][name]
                    file[group][name] = empty
    assert "holds no accepted increment" in refused(result, result)


def test_a_table_that_has_a_node_twice_is_still_an_error(refused, sections, tmp_path):
    rows = {"node": [1, 2, 2, 3], "x": [0, 1, 1, 2], "y": [0, 0, 0, 0], "U1": [0.1, 0.2, 0.3, 0.3]}
    said = refused(sections("one"), write_csv(tmp_path / "twice.csv", rows))
    assert "B has node 2 twice with other values, 0.2 and 0.3" in said


def test_a_contact_point_beside_its_node_is_matched_by_the_node(compare, refused, tmp_path):
    """The last point of a slave that overhangs its master lies at the master's end."""
    for name in ("one", "two"):
        write_result(tmp_path / f"{name}.vtkhdf", loads=(5.0,))
        with h5py.File(tmp_path / f"{name}.vtkhdf", "r+") as file:
            contact = file["contact/CYLINDER"]
            contact.attrs["pairing"] = "SURFACES"
            at, pressure, nodes = contact["x"][()], contact["pressure"][0], contact["slave_node"][()]
            heights = contact["y"][()]
            contact["x"][-1] = at[-1] - 0.3 * (at[-1] - at[-2])
    files = [tmp_path / "one.vtkhdf", tmp_path / "two.vtkhdf"]
    status, said, _ = compare(*files, "--all-keys")
    assert status == 0 and line_of(said, "pressure")["rows"] == len(at)
    columns = {"node": nodes, "x": at, "y": heights, "pressure": pressure}
    other = write_csv(tmp_path / "nodes.csv", columns)
    status, said, _ = compare(files[0], other)
    assert status == 0 and line_of(said, "pressure")["rows"] == len(at)
    columns["x"] = at + 0.1
    write_csv(other, columns)
    assert "other meshes are matched" in refused(files[0], other)


def test_each_row_says_the_tolerance_that_it_is_judged_by(compare, result):
    _, said, _ = compare(result, result, "--tol", "pressure=block:0.02,abs:1", "--mismatches", 2)
    lines = {line.split()[0]: line for line in said.splitlines() if "  ok" in line}
    assert "  abs 1, block 0.02  " in lines["pressure"]
    assert "  block 0.001  " in lines["NT"] and "  2 at a time  " in lines["status"]
