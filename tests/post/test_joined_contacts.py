"""Interfaces that a pattern means are drawn as one, along a common coordinate."""

import re
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "decks"), str(TESTS.parent / "python")]

from blocks import without_unused_surfaces, write  # noqa: E402
from matplotlib.collections import QuadMesh  # noqa: E402
from deck_runs import solve, solve_as_written  # noqa: E402
from pellets import rod  # noqa: E402
from physics import material, mesh  # noqa: E402
from synthetic import write_result  # noqa: E402

from thercon.post import profiles, style, zones  # noqa: E402
from thercon.post.cli import main as plot, parser  # noqa: E402
from thercon.post.errors import UserError  # noqa: E402
from thercon.post.report.tables import uncertainties  # noqa: E402
from thercon.post.result import Result  # noqa: E402

PELLETS = 11   # W10 comes before W2 by name


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return solve(write(tmp_path_factory.mktemp("joined") / "rod.inp", rod(PELLETS)))


def test_points_of_all_interfaces_follow_each_other_along_the_rod(result):
    with Result(result) as one, h5py.File(result) as file:
        joined = one.contact("w*")
        along, places = joined.axis(None)
        assert along == "y"
        assert np.all(np.diff(places) >= 0.0)
        assert places[[0, -1]] == pytest.approx([0.0, 10.0 * PELLETS])
        pairs = [file[f"contact/W{k}"] for k in range(PELLETS)]
        for name in ("y", "status", "pressure", "heat_flux"):
            assert np.array_equal(joined[name], np.concatenate([pair[name][()] for pair in pairs], axis=-1))
        assert joined["normal_force"] == pytest.approx(sum(pair["normal_force"][()] for pair in pairs))
        assert joined.friction == pytest.approx(0.1)
        assert len(joined.pieces) == PELLETS
        own = np.sort(np.concatenate([pair["y"][0] + pair["edges_contact"][-1] for pair in pairs]))
        edges = joined.edge_on_axis(joined["edges_contact"][-1], places)
        assert np.sum(~np.isnan(own)) > PELLETS
        assert edges == pytest.approx(own, nan_ok=True)


def test_zones_and_profiles_of_all_interfaces_are_one_picture_each(result, tmp_path, capsys):
    for picture in ("zones", "profiles"):
        assert plot([picture, str(result), "--contact", "W*", "--out", str(tmp_path), "--csv"]) == 0
    written = {Path(line).name for line in capsys.readouterr().out.split()}
    assert {"rod.zones-W_.png", "rod.zones-W_-pairs.csv", "rod.profiles-W_.png"} <= written


def test_a_pattern_that_no_interface_has_is_an_error(result, tmp_path, capsys):
    assert plot(["zones", str(result), "--contact", "Q*", "--out", str(tmp_path)]) == 2
    assert "no contact 'Q*'" in capsys.readouterr().err


def write_stack(path, names, **choices):
    """Write a result whose interfaces are flat, the first at y = 0, each 5 above the one before; the
    last runs from the right to the left. Return the path."""
    write_result(path, contacts=tuple(names), **choices)
    with h5py.File(path, "a") as file:
        for k, name in enumerate(names):
            group = file[f"contact/{name}"]
            group["y"][:] = 5.0 * k
            group["normal_force"] = np.arange(len(file["history/load"])) + 100.0 * k
        group["x"][:] = group["x"][()][::-1]
    return path


@pytest.mark.parametrize("columns", [6, 7])
def test_places_are_joined_and_forces_summed_with_as_many_increments_as_contact_points(tmp_path, columns):
    path, names = write_stack(tmp_path / "stack.vtkhdf", ("A1", "A2"), columns=columns), ("A1", "A2")
    with Result(path) as one:
        pairs, joined = [one.contact(name) for name in names], one.contact("A*")
        assert (len(pairs[0]["x"]) == one.increments) == (columns == 7)
        for name in ("x", "y", "weight", "slave_node", "master_node", "pressure"):
            assert np.array_equal(joined[name], np.concatenate([pair[name] for pair in pairs], axis=-1))
        assert np.array_equal(joined["normal_force"], 100.0 + 2.0 * np.arange(one.increments))
        assert set(joined.totals()) == {"normal_force", "edge_contact", "edge_stick", "peak_pressure"}


@pytest.mark.parametrize("picture", ["zones", "profiles", "courses"])
def test_pictures_are_drawn_with_as_many_increments_as_contact_points(tmp_path, picture):
    path = write_stack(tmp_path / "stack.vtkhdf", ("A1", "A2"), columns=7)
    for pattern, word in (("A*", "A_"), ("*", "all")):
        assert plot([picture, str(path), "--contact", pattern, "--out", str(tmp_path), "--csv"]) == 0
        assert (tmp_path / f"stack.{picture}-{word}.png").exists()


def zone_picture(result, *options, pattern="*"):
    """Return the zone diagram of interfaces, usually all, of a result that is open."""
    options = parser().parse_args(["zones", str(result.path), *options])
    return zones.picture_of(result, pattern, options)


def test_interfaces_of_a_stack_have_a_row_each_along_their_common_coordinate(tmp_path):
    names = [f"P{k}" for k in (2, 9, 10, 11)]  # P10 comes before P2 by name
    with Result(write_stack(tmp_path / "stack.vtkhdf", names)) as one:
        for options, key in (((), "x"), (("--along", "x"), "x"), (("--along", "s"), "s")):
            picture = zone_picture(one, *options)
            figure = picture.draw([])
            (axes,) = figure.axes
            assert [label.get_text() for label in axes.get_yticklabels()] == names
            assert f"${key}$ = 0 to " in axes.get_ylabel()
            ticks, count = axes.get_yticks(), len(picture.coordinate) // len(names)
            for k, name in enumerate(names):
                drawn = picture.coordinate[k * count : (k + 1) * count]
                own = one.contact(name)[key]
                assert np.diff(drawn) / np.diff(own) == pytest.approx(0.8 / np.ptp(own))
                assert np.min(drawn) + np.max(drawn) == pytest.approx(2.0 * ticks[k])
            assert np.diff(ticks) == pytest.approx(1.0)
            style.plt.close(figure)
        with pytest.raises(UserError, match=r"y is constant .* use --along x"):
            zone_picture(one, "--along", "y")


def test_the_picture_of_a_stack_grows_with_its_interfaces_up_to_a_limit(tmp_path):
    heights, shown = [], []
    for count in (10, 40, 150):
        path = write_stack(tmp_path / f"{count}.vtkhdf", [f"P{k:03}" for k in range(count)], columns=2)
        with Result(path) as one:
            figure = zone_picture(one).draw([])
            heights.append(figure.get_figheight())
            shown.append([label.get_text() for label in figure.axes[0].get_yticklabels()])
            style.plt.close(figure)
    assert heights[0] < heights[1] < heights[2] < 11.7  # inches of a page
    assert [len(each) for each in shown[:2]] == [10, 40]
    assert shown[2][:2] in (["P000", "P003"], ["P000", "P002"])  # as many as there is room for
    room = 72.0 * heights[2] / len(shown[2])
    assert room > style.SETTINGS["ytick.labelsize"]


def test_open_differs_from_where_no_interface_is(tmp_path):
    with Result(write_stack(tmp_path / "stack.vtkhdf", ("A1", "A2"))) as one:
        figure = zone_picture(one).draw([])
        (axes,) = figure.axes
        assert {mesh.cmap(0) for mesh in axes.collections}.isdisjoint({axes.get_facecolor()})
        style.plt.close(figure)


def test_a_rod_has_one_diagram_and_a_row_each_along_a_coordinate_in_which_its_interfaces_overlap(result):
    with Result(result) as one:
        picture = zone_picture(one, pattern="W*")
        assert picture.rows is None and picture.along == "y"
        assert len(zone_picture(one, "--along", "s", pattern="W*").rows.names) == PELLETS


def test_tables_of_several_interfaces_name_the_one_of_each_contact_point(tmp_path):
    with Result(write_stack(tmp_path / "stack.vtkhdf", ("A2", "A10"))) as one:
        table = zone_picture(one).pair_table()
        for name in ("A2", "A10"):
            rows = table["contact"] == name
            assert np.array_equal(table["status"][rows], one.contact(name)["status"].ravel())
            for place in "xys":
                assert table[place][rows] == pytest.approx(np.tile(one.contact(name)[place], one.increments))


def test_results_with_other_interfaces_and_digitised_figures_are_refused(tmp_path, capsys):
    two = write_stack(tmp_path / "two.vtkhdf", ("A1", "A2"))
    three = write_stack(tmp_path / "three.vtkhdf", ("A1", "A2", "A3"))
    asked = ["--contact", "A*", "--out", str(tmp_path)]
    assert plot(["zones", str(two), str(three), *asked]) == 2
    assert "three.vtkhdf: the interfaces 'A*' are not those of" in capsys.readouterr().err
    assert plot(["zones", str(two), str(two), *asked]) == 0
    (tmp_path / "paper.csv").write_text("load,edge_contact\n60,1\n900,2\n")
    assert plot(["zones", str(two), "--with", str(tmp_path / "paper.csv"), *asked]) == 2
    assert "--with paper: several interfaces" in capsys.readouterr().err


def profile_picture(result, *options):
    """Return the profiles of all interfaces of a result that is open."""
    options = parser().parse_args(["profiles", str(result.path), *options])
    return profiles.Picture(result, result.contact("*"), [result.increments - 1], options)


def test_profiles_of_a_stack_have_a_line_for_each_interface_along_its_own_coordinate(tmp_path):
    names = [f"P{k}" for k in (2, 9, 10)]
    with Result(write_stack(tmp_path / "stack.vtkhdf", names)) as one:
        picture = profile_picture(one)
        figure = picture.draw([])
        lines, pairs = figure.axes[-1].lines, [one.contact(name) for name in names]  # heat flux
        assert len(lines) == len({line.get_color() for line in lines}) == len(names)
        for line, pair in zip(lines, pairs):
            assert np.array_equal(line.get_xdata(), pair["x"])
            assert np.array_equal(line.get_ydata(), pair["heat_flux"][-1])
        named = {text.get_text(): handle.get_color() for text, handle in
                 zip(figure.legends[0].get_texts(), figure.legends[0].legend_handles)}
        assert [named[name] for name in names] == [line.get_color() for line in lines]
        style.plt.close(figure)


@pytest.mark.parametrize("count", [9, 24, 25])
def test_no_interface_is_missing_from_a_legend_that_does_not_say_so(tmp_path, count):
    with Result(write_stack(tmp_path / "stack.vtkhdf", [f"P{k}" for k in range(count)])) as one:
        figure = profile_picture(one).draw([])
        named = [text.get_text() for text in figure.legends[0].get_texts()]
        style.plt.close(figure)
    if count <= 24:
        assert {f"P{k}" for k in range(count)} <= set(named)
    else:
        assert named[-1] == f"{count - 8} more between these, in their order"


def test_interfaces_are_in_the_order_of_the_deck_and_of_their_numbers(tmp_path):
    names = ["END-P-2", "END-P-10", "GAP-P-1", "OTHER", "GAP", "SIDE.1"]
    path = write_stack(tmp_path / "stack.vtkhdf", names)
    with h5py.File(path, "r+") as file:
        del file["deck"]
        file["deck"] = ["*CONTACT PAIR, INTERACTION=GAS,", " NAME=Gap", "P-*, TUBE",
                        "*Contact Pair, INTERACTION=DRY", "Side.1, TUBE",
                        "*Contact Pair, NAME=END, INTERACTION=DRY", "P-*, Q-*"]
    with Result(path) as one:
        assert one.contact_names == ["GAP", "GAP-P-1", "SIDE.1", "END-P-2", "END-P-10", "OTHER"]


@pytest.mark.parametrize("count", [6, 7])
def test_tables_of_more_than_six_interfaces_are_folded(tmp_path, count):
    with Result(write_stack(tmp_path / "stack.vtkhdf", [f"P{k}" for k in range(count)])) as one:
        words = uncertainties(one)
    assert words.count("<table>") == count
    opened = f"<details><summary>{count} interfaces at the last increment</summary>"
    assert words.startswith(opened) == (count > 6)


@pytest.mark.parametrize("count", [6, 7])
def test_tables_of_more_than_six_bodies_are_folded_and_tell_which_they_are(tmp_path, count):
    """Tied blocks of one material."""
    cards = [card for k in range(count)
             for card in mesh(f"B{k}", [0.0, 1.0], [k, k + 1.0], "DC2D4", first=10 * k + 1)]
    cards += material("STEEL", elastic=None, conductivity=50.0)[:-1]
    cards += [f"*SOLID SECTION, MATERIAL=STEEL, ELSET=B{k}" for k in range(count)]
    cards += [card for k in range(1, count) for card in (f"*TIE, NAME=T{k}", f"B{k}.BOTTOM, B{k - 1}.TOP")]
    cards += ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY", "B0.BOTTOM, 11, 11, 20.",
              f"B{count - 1}.TOP, 11, 11, 100.", "*END STEP"]
    with Result(solve_as_written(write(tmp_path / "deck.inp", without_unused_surfaces(cards)))) as one:
        words = uncertainties(one)
    opened = f"<details><summary>{count} bodies at the last increment</summary>"
    assert (opened in words) == (count > 6)
    assert re.findall(r"<caption>Body (.*?) at the last", words) == [
        f"{k + 1} (B{k} of STEEL, first node {10 * k + 1})" for k in range(count)]


def test_zones_end_at_the_last_increment(result):
    """So nothing is tinted at loads that no increment has."""
    with Result(result) as one:
        for each in (zone_picture(one, pattern="W1"), zone_picture(one, pattern="W*")):
            figure = each.draw([])
            last = one.history["load" if each.rising else "time"][-1]
            for mesh in figure.axes[0].collections:
                if isinstance(mesh, QuadMesh):
                    assert mesh.get_coordinates()[..., 0].max() == last
            style.plt.close(figure)


def test_a_zone_that_begins_and_ends_at_contact_points_has_a_symmetric_profile(tmp_path):
    path = write_stack(tmp_path / "stack.vtkhdf", ("A1", "A2"))
    with h5py.File(path, "a") as file:
        for group in file["contact"].values():
            group["x"][:] = group["s"][:] = np.arange(21.0)
            group["status"][:] = group["pressure"][:] = 0
            group["status"][:, 8:13], group["pressure"][:, 8:13] = 1, [3.0, 2.0, 1.0, 2.0, 3.0]
            group["edges_contact"][:, :2] = 8.0, 12.0
    with Result(path) as one:
        figure = profile_picture(one).draw([])
        for line in figure.axes[0].lines:
            assert np.array_equal(line.get_xdata(), 20.0 - line.get_xdata()[::-1])
            assert np.array_equal(line.get_ydata(), line.get_ydata()[::-1])
        style.plt.close(figure)


def test_profiles_of_a_stack_at_several_loads_are_refused(tmp_path, capsys):
    path = write_stack(tmp_path / "stack.vtkhdf", ("A1", "A2"))
    assert plot(["profiles", str(path), "--contact", "A*", "--load", "300", "600"]) == 2
    assert "give one load" in capsys.readouterr().err
