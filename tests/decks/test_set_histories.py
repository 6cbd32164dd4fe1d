"""/history/nodes and /history/elements: what *NODE PRINT and *EL PRINT ask for, with values known in
closed form."""

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import run
from physics import nodes_of
from test_prints import BLOCK, BODY, CONDUCTIVITY, HELD, POISSON, YOUNG, heated, static, tables, turned
from test_restart import assert_same, go_on

DOWN = -(1 - POISSON**2) / YOUNG   # of a pressed block in plane strain, by pressure and height
TOP = [n for n, (_, y) in nodes_of(BLOCK).items() if y == 1.0]
BOTTOM = [n for n, (_, y) in nodes_of(BLOCK).items() if y == 0.0]


def pressed(*cards, pressure=6.0, times="0.2, 1."):
    """Return a step that presses the block."""
    return static(*HELD, "*DLOAD, OP=NEW", f"BLOCK, P3, {pressure!r}", *cards, times=times)


def solve(folder, *cards):
    """Solve a deck; return the path of its result."""
    deck = write(folder / "deck.inp", *cards)
    process = run("run", "--quiet", deck, "--out", folder)
    assert process.returncode == 0, process.stderr
    return deck.with_suffix(".vtkhdf")


def history(result, path):
    """Return the datasets of a group of /history, their units and their descriptions."""
    with h5py.File(result) as file:
        group = file[f"history/{path}"]
        return ({name: item[()] for name, item in group.items()},
                {name: item.attrs["unit"] for name, item in group.items()},
                {name: item.attrs["description"] for name, item in group.items()})


@pytest.mark.parametrize("frequency", [1, 2])
def test_nodes_of_a_pressed_block_move_with_the_load(tmp_path, frequency):
    """At every n-th increment and the last; the supports carry the sum."""
    result = solve(tmp_path, BODY, ["*OPTIONS, UNITS=\"mm MPa W C\""], pressed(
        f"*NODE PRINT, NSET=BLOCK.TOP, FREQUENCY={frequency}", "U",
        f"*NODE PRINT, NSET=BLOCK.BOTTOM, FREQUENCY={frequency}, TOTALS=ONLY", "RF"))
    values, units, words = history(result, "nodes/BLOCK.TOP")
    due = [k for k in range(1, 6) if k % frequency == 0 or k == 5]
    assert set(values) == {"node", "increment", "time", "displacement_x", "displacement_y"}
    np.testing.assert_array_equal(values["increment"], due)
    np.testing.assert_allclose(values["time"], np.array(due) / 5, rtol=1e-14)
    np.testing.assert_array_equal(values["node"], TOP)
    assert values["displacement_y"].shape == (len(due), len(TOP))
    np.testing.assert_allclose(values["displacement_y"], np.outer(
        6.0 * DOWN * values["time"], np.ones(len(TOP))), rtol=1e-10)
    assert units["displacement_x"] == "mm" and units["node"] == "-" and units["time"] == "time"
    assert words["displacement_y"] == "displacement y, a column for each row of node"
    values, units, _ = history(result, "nodes/BLOCK.BOTTOM")
    assert set(values) == {"node", "increment", "time", "total_external_force_x",
                           "total_external_force_y"}
    np.testing.assert_allclose(values["total_external_force_y"], 1.25 * 6.0 * np.array(due) / 5,
                               rtol=1e-10)
    assert units["total_external_force_y"] == "MPa mm^2"


def test_points_have_their_stress_and_flux(tmp_path):
    result = solve(tmp_path, BODY, [
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.", "*BOUNDARY",
        "BLOCK.BOTTOM, 2", "1, 1", "BLOCK.BOTTOM, 11, 11, 5.", "BLOCK.TOP, 11, 11, 12.",
        "BLOCK.TOP, 2, 2, 0.003", "*EL PRINT", "S, HFL, COORD", "*END STEP"])
    values, _, _ = history(result, "elements/ALL")
    assert set(values) == {"element", "point", "increment", "time", "stress_xx", "stress_yy",
                           "stress_zz", "stress_xy", "heat_flux_x", "heat_flux_y"}
    np.testing.assert_array_equal(values["element"], np.repeat([1, 2], 9))
    np.testing.assert_array_equal(values["point"], [*range(1, 10)] * 2)
    for k, part in enumerate((0.5, 1.0)):
        np.testing.assert_allclose(values["stress_yy"][k], part * 0.003 * YOUNG / (1 - POISSON**2),
                                   rtol=1e-10)
    np.testing.assert_allclose(values["heat_flux_y"][-1], -CONDUCTIVITY * 7.0, rtol=1e-10)


def test_steps_share_a_group_and_what_one_has_not_is_nan(tmp_path):
    """Heat comes first without U; the second step prints U and NT by two cards; the third nothing."""
    result = solve(tmp_path, BODY, heated("*BOUNDARY", "BLOCK.LEFT, 11, 11, 3.",
                                          "*NODE PRINT, NSET=BLOCK.TOP", "NT", times="0.5, 1."),
                   pressed("*NODE PRINT, NSET=BLOCK.TOP, FREQUENCY=2", "U",
                           "*NODE PRINT, NSET=BLOCK.TOP, FREQUENCY=5", "NT"),
                   static("*NODE PRINT, NSET=BLOCK.LEFT", "U"))
    values, _, _ = history(result, "nodes/BLOCK.TOP")
    np.testing.assert_array_equal(values["increment"], [1, 2, 4, 6, 7])
    temperature, moved = values["temperature"][:, 0], values["displacement_y"][:, 0]
    # The heat step ramps to 3.
    np.testing.assert_allclose(temperature[[0, 1, 4]], [1.5, 3.0, 3.0])
    np.testing.assert_array_equal(np.isnan(temperature), [False, False, True, True, False])
    np.testing.assert_array_equal(np.isnan(moved), [True, True, False, False, False])
    np.testing.assert_allclose(moved[2:], 6.0 * DOWN * np.array([0.4, 0.8, 1.0]), rtol=1e-10)
    assert len(history(result, "nodes/BLOCK.LEFT")[0]["time"]) == 1


@pytest.mark.parametrize(("values", "names"), [("NO", "11 22 33 12".split()),
                                               ("YES", "xx yy zz xy".split())])
def test_names_say_along_which_axes_components_are(tmp_path, values, names):
    found, _, _ = history(solve(tmp_path, turned(30.0, values)), "elements/BLOCK")
    assert {name for name in found if name.startswith("stress")} == {f"stress_{a}" for a in names}
    across, along = 0.25 * 6, 0.75 * 6
    expected = (along, across, -np.sqrt(along * across)) if values == "NO" else (6.0, 0.0, 0.0)
    for name, value in zip((names[0], names[1], names[3]), expected, strict=True):
        np.testing.assert_allclose(found[f"stress_{name}"], value, rtol=1e-9, atol=1e-9)


def test_nodes_with_axes_of_their_own_have_numbers_for_names(tmp_path):
    """x turned by 90 degrees: what is along y is along its first axis."""
    cards = [*BODY, "*TRANSFORM, NSET=BLOCK.TOP", "0., 1., 0., -1., 0., 0."]
    result = solve(tmp_path, cards, pressed(
        "*NODE PRINT, NSET=BLOCK.TOP", "U", "*NODE PRINT, NSET=BLOCK.BOTTOM", "U",
        "*NODE PRINT, NSET=BLOCK.TOP, GLOBAL=YES", "U"))
    top, bottom = (history(result, f"nodes/BLOCK.{side}")[0] for side in ("TOP", "BOTTOM"))
    np.testing.assert_allclose(top["displacement_1"][-1], 6.0 * DOWN, rtol=1e-10)
    np.testing.assert_allclose(top["displacement_y"], top["displacement_1"], rtol=1e-12)
    assert "displacement_x" in bottom and "displacement_1" not in bottom


def test_any_name_of_a_set_is_a_group(tmp_path):
    """A slash would begin a group inside a group; a set may have the name of all nodes."""
    result = solve(tmp_path, BODY, ["*NSET, NSET=A/B", "1, 2", "*NSET, NSET=\".\"", "3",
                                    "*NSET, NSET=ALL", "1"], pressed(
        "*NODE PRINT, NSET=A/B", "U", "*NODE PRINT, NSET=\".\"", "U", "*NODE PRINT", "U",
        "*NODE PRINT, NSET=ALL", "U"))
    with h5py.File(result) as file:
        found = {name: len(group["node"]) for name, group in file["history/nodes"].items()}
    assert found == {"A|B": 2, "|": 1, "ALL": len(nodes_of(BLOCK)), "ALL (2)": 1}


def test_without_the_cards_there_are_no_groups(tmp_path):
    with h5py.File(solve(tmp_path, BODY, pressed())) as file:
        assert not {"nodes", "elements"} & set(file["history"])


def test_a_run_that_goes_on_keeps_its_histories(tmp_path):
    """Within a step, and with new steps: what only the dropped steps asked for is gone."""
    old = [*pressed("*NODE PRINT, NSET=BLOCK.TOP, FREQUENCY=2", "U", "*EL PRINT, ELSET=BLOCK", "S"),
           *pressed(pressure=9.0), *pressed("*NODE PRINT, NSET=BLOCK.TOP", "RF",
                                            "*NODE PRINT, NSET=BLOCK.LEFT", "U", pressure=3.0)]
    new = pressed("*NODE PRINT, NSET=BLOCK.RIGHT, TOTALS=YES", "RF", "*EL PRINT, ELSET=BLOCK",
                  "S", pressure=2.0)
    (tmp_path / "old").mkdir()
    whole = solve(tmp_path / "old", BODY, ["*RESTART, WRITE"], old)
    deck = whole.with_suffix(".inp")
    for time in (0.6, 1.8, 2.2):
        assert_same(whole, go_on(deck, whole, tmp_path / f"from{time}", time))
    more = write(tmp_path / "deck.inp", ["*RESTART, READ, STEP=2"], new)
    added = go_on(more, whole, tmp_path / "added")
    at_once = solve(tmp_path, BODY, ["*RESTART, WRITE"], old[:old.index("*END STEP", old.index(
        "*END STEP") + 1) + 1], new)
    assert_same(at_once, added, but="restart/")
    with h5py.File(added) as file:
        assert set(file["history/nodes"]) == {"BLOCK.TOP", "BLOCK.RIGHT"}
        assert "external_force_x" not in file["history/nodes/BLOCK.TOP"]


PLATE = ["*NODE", "9001, 0.5, 3.", "*NSET, NSET=PLATE", "9001"]
GRIPS = {   # what has a reference node -> cards
    "a rigid body": ["*SURFACE, NAME=PLATE, TYPE=SEGMENTS", "START, 3., 1.", "LINE, -1., 1.",
                     "*RIGID BODY, REF NODE=9001, ANALYTICAL SURFACE=PLATE",
                     "*SURFACE INTERACTION, NAME=SMOOTH", "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=SEAT",
                     "BLOCK.TOP, PLATE"],
    "a coupling": ["*COUPLING, REF NODE=9001, SURFACE=BLOCK.TOP, CONSTRAINT NAME=GRIP", "*KINEMATIC",
                   "2, 2"]}


@pytest.mark.parametrize("grip", GRIPS.values(), ids=GRIPS)
def test_a_reference_node_has_its_way_and_force(tmp_path, grip):
    """It presses the block evenly: 1.25 wide and 1 high, so the force is -1.25 u/DOWN."""
    cards = [BODY, PLATE, grip, static(*HELD, "9001, 1", "9001, 6", "9001, 2, 2, -0.004",
                                       "*NODE PRINT, NSET=PLATE, TOTALS=YES", "U, RF",
                                       times="0.5, 1.")]
    result = solve(tmp_path, *cards)
    values, _, _ = history(result, "nodes/PLATE")
    np.testing.assert_array_equal(values["node"], [9001])
    np.testing.assert_allclose(values["displacement_y"], [[-0.002], [-0.004]], rtol=1e-12)
    force = 1.25 / DOWN * np.array([0.002, 0.004])
    np.testing.assert_allclose(values["external_force_y"][:, 0], force, rtol=1e-8)
    np.testing.assert_allclose(values["total_external_force_y"], force, rtol=1e-8)
    (table,) = [t for t in tables(tmp_path, *cards) if t[:3] == (2, "NODES", "PLATE")]
    assert [float(word) for word in table[4][0]] == pytest.approx(
        [9001, 0.5, 3.0, 0.0, -0.004, 0.0, force[1]], rel=1e-6, abs=1e-9)


def test_a_set_of_nodes_without_rows_is_told(tmp_path):
    deck = write(tmp_path / "deck.inp", BODY, ["*NODE", "9001, 0.5, 3.", "*NSET, NSET=STRAY", "9001"],
                 pressed("*NODE PRINT, NSET=STRAY", "U", "*NODE PRINT, NSET=BLOCK.TOP", "U"))
    process = run("check", deck)
    assert process.returncode == 0
    (line,) = [line for line in process.stderr.splitlines() if "nothing is printed" in line]
    assert "STRAY" in line and "*VERIFY" in line
