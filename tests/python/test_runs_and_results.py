"""The package thercon: what it imports, runs, tables of runs, and results."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
import thercon
from first_deck import ROOT, heat_rate

HEAVY = "numpy", "h5py", "pandas", "matplotlib"


def test_import_takes_no_other_package(joint):
    """And a run needs no pandas, as long as no table is asked for."""
    code = (f"import sys; sys.path.insert(0, {str(ROOT / 'python')!r}); import thercon\n"
            f"assert not set({HEAVY}) & set(sys.modules)\n"
            "thercon.run('joint.inp').interface('JOINT').pressure\n"
            "assert not {'pandas', 'matplotlib'} & set(sys.modules)\n")
    subprocess.run([sys.executable, "-c", code], check=True)


def test_quantities_are_those_of_the_file(joint):
    result = thercon.run("joint.inp", out="out", pressure=20, errors="full")
    with h5py.File("out/joint.vtkhdf") as file:
        contact = file["contact/JOINT"]
        of_interface = result.interface("joint")
        for name in ("pressure", "x", "s", "normal_force", "heat_flux"):
            assert np.array_equal(of_interface[name], contact[name][()])
        assert of_interface.units["pressure"] == "stress"
        assert np.array_equal(result.times, file["history/time"][()])
        assert np.array_equal(result.history.load, file["history/load"][()])
        points, nodes = file["VTKHDF/PointData"], file["VTKHDF/PointData/node_id"][()]
        place = int(np.flatnonzero(nodes == 8)[0])
        for name in ("temperature", "displacement", "stress"):
            values = points[name][()].reshape(len(result.times), len(nodes), -1)[:, place]
            assert np.array_equal(result.node(8)[name].reshape(values.shape), values)
        rows = file["uncertainty/JOINT/heat_rate"][()]
        mine = result.errors.query("where == 'JOINT' and quantity == 'heat_rate'")
        assert np.array_equal(mine[["value", "uncertainty", "change", "scatter", "iteration"]], rows)
        assert set(mine["unit"]) == {"power"}
    assert list(result.interface("JOINT").table()["heat_rate"]) == list(of_interface.heat_rate)
    assert result.interface("JOINT").points(-1)["pressure"].to_numpy() == pytest.approx(20.0)


def test_a_set_is_found_by_its_name_and_its_columns_by_the_numbers_of_the_deck(joint):
    """As many nodes as increments; their temperatures are prescribed, the stress is the pressure."""
    joint.write_text(joint.read_text().replace("*STEP\n", "*NSET, NSET=TWICE\n1, 3, 6, 8\n"
                                               "*ELSET, ELSET=TWICE\n2\n*STEP\n", 1).replace(
        "*END STEP", "*NODE PRINT, NSET=TWICE\nNT\n*EL PRINT, ELSET=BLOCKS\nS\n"
                     "*EL PRINT, ELSET=TWICE\nS\n*END STEP"))
    history = thercon.run("joint.inp", pressure=40).history
    table = history.nodes["TWICE"].table()
    assert set(table) == {"increment", *(f"temperature_{n}" for n in (1, 3, 6, 8))}
    assert table["temperature_1"].to_numpy() == pytest.approx([5, 10, 15, 20])
    assert table["temperature_8"].to_numpy() == pytest.approx([50, 100, 150, 200])
    points = history["blocks"].table()
    assert points.loc[1.0, "stress_yy_2.1"] == pytest.approx(-40.0)
    assert np.array_equal(history["top"].temperature, history.nodes.TOP.temperature)
    assert "heat_in" in history.table() and "TOP" not in history.table()
    with pytest.raises(KeyError, match="nearest: 'BLOCKS'; .*heat_in.*, TOP, TWICE, BLOCKS"):
        history["BLOCK"]
    with pytest.raises(KeyError, match=r'history.nodes\["TWICE"\] or history.elements\["TWICE"\]'):
        history["twice"]


def test_stress_of_a_node_between_materials_is_that_of_the_one_named(joint):
    """Side by side under one strain, the stress of each is in proportion to its modulus."""
    cards = joint.read_text().split("*SURFACE, NAME=UPPER")[0]
    cards = cards.replace("5, 0., 10.\n6, 10., 10.\n", "5, 20., 0.\n6, 20., 10.\n").replace(
        "2, 5, 6, 7, 8", "2, 2, 5, 6, 3").replace("*NODE, NSET=TOP\n7, 10., 20.\n8, 0., 20.\n", "")
    cards = cards.replace("*SOLID SECTION, ELSET=BLOCKS, MATERIAL=STEEL", "\n".join((
        "*MATERIAL, NAME=SOFT", "*ELASTIC", "1.05E5, 0.", "*ELSET, ELSET=ONE", "1", "*ELSET, ELSET=TWO",
        "2", "*SOLID SECTION, ELSET=ONE, MATERIAL=STEEL", "*SOLID SECTION, ELSET=TWO, MATERIAL=SOFT")))
    for old, new in (("2.1E5, 0.3", "2.1E5, 0."), ("*CONDUCTIVITY\n0.05\n", ""), ("*REFINE, LEVELS=2\n", "")):
        cards = cards.replace(old, new)
    joint.write_text(cards + "*STEP\n*STATIC\n*BOUNDARY\n1, 1\n1, 2\n2, 2\n5, 2\n3, 2, 2, 0.1\n"
                     "4, 2, 2, 0.1\n6, 2, 2, 0.1\n*END STEP\n")
    result = thercon.run("joint.inp")
    with pytest.raises(thercon.UserError, match=r"node\(3, body=1\)"):
        result.node(3).stress
    assert result.node(3).displacement[-1, 1] == pytest.approx(0.1)
    for material, modulus in ((1, 2.1e5), (2, 1.05e5)):
        assert result.node(3, material=material).stress[-1, 1] == pytest.approx(0.01 * modulus)


def test_a_summary_has_the_columns_of_a_table_of_runs(joint):
    table = thercon.run_many("joint.inp", {"pressure": [20]}, out="many", errors="last")
    summary = thercon.open("many/joint-1").summary
    first = list(table).index("peak_megabytes") + 1
    assert sorted(name for name in list(table)[first:] if not name.endswith(" uncertainty")) == \
        sorted(summary.index)
    for name, row in summary.iterrows():
        values = table.loc[0, name], table.get(f"{name} uncertainty", [np.nan])[0]
        assert values == pytest.approx((row["value"], row["uncertainty"]), rel=1e-14, abs=1e-14,
                                       nan_ok=True)


def test_a_failed_check_is_no_exception(joint):
    joint.write_text(joint.read_text() + '*VERIFY, KIND=ANALYTIC, SOURCE="resistances"\n'
                     "heat_rate, JOINT, LAST, 3.6, 1.E-9\nNT, 8, LAST, 199., 1.E-9\n"
                     "NT, 8, 0.5, 100., 0.1, ABS\nNT reaches 500., 8, LAST, 1., 0.1\n"
                     "*VERIFY, KIND=NONE\nNT, 8, LAST\nNT reaches 500., 8, LAST\n")
    result = thercon.run("joint.inp")
    assert result.status == 4 and list(result.checks["passed"]) == [True, False, True, False, True, True]
    assert result.checks["found"][1] == pytest.approx(200.0)
    assert "2 checks passed, 2 failed" in Path("joint.lst").read_text()   # what none is expected of is none
    opened = thercon.open("joint")
    assert opened.status == 4
    for name in ("quantity", "where", "kind", "passed", "expected", "tolerance", "time", "found", "reason"):
        one, other = opened.checks[name], result.checks[name]
        assert list(one) == pytest.approx(list(other), rel=1e-7, nan_ok=True) \
            if one.dtype.kind == "f" else one.fillna("").equals(other.fillna("")), name
    os.remove("joint.lst")
    with pytest.raises(thercon.UserError, match="its checks are in its listing, and joint.lst is missing"):
        opened.checks


def test_values_that_nothing_is_expected_of_are_checks_of_an_open_result_too(joint):
    joint.write_text(joint.read_text() + "*VERIFY, KIND=NONE\nNT, 8, LAST\nheat_rate, JOINT, LAST\n"
                     "MISES, MAX, LAST\nNT reaches 100., 8, LAST\n")
    result = thercon.run("joint.inp")
    assert {"uncertainty", "no_estimate"} < set(result.checks)
    opened = thercon.open("joint").checks
    assert sorted(opened) == sorted(set(result.checks) - {"address"})
    for name in opened:
        one, other = (each[name] for each in (opened, result.checks))
        assert list(one) == pytest.approx(list(other), rel=0.06, abs=1e-9, nan_ok=True) \
            if one.dtype.kind in "fi" else one.fillna("").equals(other.fillna("")), name


def test_an_exception_has_the_messages_with_their_places(joint):
    lines = joint.read_text().splitlines()
    at = lines.index("*FRICTION")
    lines[at] = "*FRICTON"
    joint.write_text("\n".join(lines))
    with pytest.raises(thercon.RunError) as raised:
        thercon.run("joint.inp")
    error = raised.value
    assert error.status == 1 and error.document["command"] == "run"
    (message,) = [each for each in error.messages if each.severity == "error"]
    assert (message.file, message.line, message.column) == ("joint.inp", at + 1, 1)
    assert str(error).startswith(f"joint.inp:{at + 1}:1: error: ")
    with pytest.raises(thercon.RunError, match="thercon: error: option --errors needs"):
        thercon.run("joint.inp", errors="some")


def test_a_name_that_is_not_there_is_met_with_the_nearest(joint):
    result = thercon.run("joint.inp")
    with pytest.raises(AttributeError, match="nearest: 'temperature'"):
        result.node(8).temprature
    with pytest.raises(thercon.UserError, match="nearest: 'JOINT'"):
        result.interface("JOIN")
    with pytest.raises(thercon.UserError, match="no node 99999"):
        result.node(99999)
    with pytest.raises(KeyError, match="nearest: 'heat_rate JOINT'"):
        thercon.run_many("joint.inp", {"pressure": [20]}, quantities=["heat_rate"])


def test_a_row_that_fails_leaves_the_others_alone(joint):
    """A factor below 0 is refused."""
    table = thercon.run_many("joint.inp", {"factor": [2e-4, -1.0, 1e-4]}, jobs=2, out="many",
                             pressure=25)
    assert list(table["status"]) == [0, 1, 0]
    assert table["reason"][1] and np.isnan(table["heat_rate JOINT"][1])
    for row in (0, 2):
        assert table["heat_rate JOINT"][row] == pytest.approx(
            heat_rate(25, table["factor"][row]), rel=1e-9)


def test_a_mistake_in_the_table_is_an_exception(joint):
    """Which is named by row and column: the user has not seen the file made of it."""
    for column, value, told in (("presure", 30, "column presure: no *PARAMETER"),
                                ("factor", "few", "row 2, column factor: factor needs a number")):
        with pytest.raises(thercon.RunError) as raised:
            thercon.run_many("joint.inp", {"pressure": [20, 30], column: [1, value]}, out="many")
        (message,) = raised.value.messages
        assert (message.file, message.line) == ("table", None) and message.message.startswith(told)
        assert "values.csv" not in str(raised.value)


def test_ctrl_c_ends_a_table_and_the_same_call_goes_on(joint):
    """In another process, which is told to end while its rows run."""
    cards = joint.read_text().replace("0.25, 1.", "0.001, 1.")
    joint.write_text(cards)
    code = (f"import sys; sys.path.insert(0, {str(ROOT / 'python')!r}); import thercon\n"
            "table = thercon.run_many('joint.inp', {'pressure': [10, 20, 30, 40]}, out='many')\n"
            "table.to_csv('answer.csv')")
    process = subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE, text=True)
    until = time.monotonic() + 300
    while not os.path.exists("many/joint-1.csv"):
        assert time.monotonic() < until and process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate()
    assert "KeyboardInterrupt" in said and "subprocess.py" not in said
    assert not os.path.exists("answer.csv")
    first = os.stat("many/joint-1.vtkhdf").st_mtime_ns
    subprocess.run([sys.executable, "-c", code], check=True)
    assert os.stat("many/joint-1.vtkhdf").st_mtime_ns == first
    table = thercon.run_many("joint.inp", {"pressure": [10, 20, 30, 40]}, out="many")
    assert table["heat_rate JOINT"].to_numpy() == pytest.approx(
        heat_rate(table["pressure"].to_numpy()), rel=1e-9)
    assert set(table["reason"]) == {"its result is finished"}
