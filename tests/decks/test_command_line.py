"""What the command line promises: batches, folders, widths, included files, exit statuses."""

import os
import re
import subprocess

import h5py
import numpy as np
import pytest
from blocks import block, solid, without_unused_surfaces, write
from changes import note_changes
from deck_runs import CYLINDER, INPUT, PATIENCE, PROGRAM, copy_deck, run

GOOD = [
    *without_unused_surfaces(block("BLOCK", [0.0, 1.0], [0.0, 1.0])),
    *solid("BLOCK", 1000.0, 0.25),
    *["*BOUNDARY", "BLOCK.BOTTOM, 2, 2, 0.", "BLOCK.LEFT, 1, 1, 0."],
    *["*STEP", "*STATIC", "0.5, 1.", "*DLOAD", "1, P3, 1.", "*END STEP"],
]
SUFFIXES = ".vtkhdf", ".lst", ".sta", ".cvg"
WRONG_CHECK = ['*VERIFY, KIND=ANALYTIC, SOURCE="wrong on purpose"', "time, , LAST, 2., 1.E-6"]


@pytest.fixture
def good(tmp_path):
    """Return a deck that solves, in a folder of its own."""
    (tmp_path / "decks").mkdir()
    return write(tmp_path / "decks" / "good.inp", GOOD)


@pytest.fixture
def bad(tmp_path):
    """Return a deck with a mistake."""
    return write(tmp_path / "bad.inp", GOOD, ["*NONSENSE"])


def names(folder):
    """Return the names of the files in a folder."""
    return sorted(path.name for path in folder.iterdir())


def test_results_go_to_the_current_folder(good, tmp_path):
    here = tmp_path / "here"
    here.mkdir()
    assert run("run", good, folder=here).returncode == 0
    assert names(here) == sorted("good" + suffix for suffix in SUFFIXES)
    assert names(good.parent) == ["good.inp"]


def test_out_names_the_folder_of_the_results_and_makes_it(good, tmp_path):
    out = tmp_path / "results"
    process = run("run", os.path.relpath(good, tmp_path), "--out", out, folder=tmp_path)
    assert process.returncode == 0, process.stderr
    assert names(out) == sorted("good" + suffix for suffix in SUFFIXES)
    assert names(good.parent) == ["good.inp"]


def test_messages_stand_in_their_order_where_both_outputs_are_one_file(good, bad):
    process = subprocess.run([PROGRAM, "check", bad, good, bad], stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, text=True, timeout=PATIENCE)
    assert [line.split(":")[0] for line in process.stdout.splitlines() if ".inp:" in line] == [
        str(bad), str(good), str(bad)]


def test_counts_of_one_are_singular_and_settings_named_as_given(good, tmp_path):
    good.write_text(good.read_text().replace("0.5, 1.", "1., 1."))
    assert "solved, 1 increment in " in run("run", good, "--out", tmp_path).stdout
    assert "\n1 deck in " in run("run", good, "--jobs", "1", "--out", tmp_path).stdout
    assert "--set x: no *PARAMETER" in run("check", good, "--set", "x=1").stderr


def test_blanks_around_a_setting_do_not_count_and_a_name_is_set_once(tmp_path):
    parameter = ["*PARAMETER", "p = x", *("1, P3, <p>" if line == "1, P3, 1." else line
                                          for line in GOOD)]
    deck = write(tmp_path / "set.inp", parameter)
    assert "'x' is not a number" in run("check", deck).stderr
    for setting in ("p= 2. ", " P =2.", "p=\t2."):
        process = run("check", deck, "--set", setting)
        assert process.returncode == 0, process.stderr
    process = run("check", deck, "--set", "p=2.", "--set", "P=3.")
    assert (process.returncode, process.stdout) == (1, "")
    assert "--set gives P twice" in process.stderr
    for setting in ("p= ", " =2.", "p"):
        assert run("check", deck, "--set", setting).returncode == 1


@pytest.mark.parametrize("request_", ["force=1%,force=2%", "force=1%,normal_force=2%"])
def test_a_quantity_has_one_target(good, tmp_path, request_):
    process = run("run", good, "--accuracy", request_, "--out", tmp_path)
    assert process.returncode == 1
    assert "each once" in process.stderr
    assert names(tmp_path) == ["decks"]


def test_quiet_silences_the_summary_but_no_error(good, bad, tmp_path):
    loud = run("run", good, "--out", tmp_path)
    assert "good.inp" in loud.stdout + loud.stderr
    quiet = run("run", "--quiet", good, "--out", tmp_path)
    assert (quiet.returncode, quiet.stdout, quiet.stderr) == (0, "", "")
    quiet = run("check", "--quiet", good)
    assert (quiet.returncode, quiet.stdout, quiet.stderr) == (0, "", "")
    assert "error: " in run("check", "--quiet", bad).stderr
    refused = run("run", "--quiet", bad, "--out", tmp_path)
    assert refused.returncode == 1
    assert f"{bad}:{len(bad.read_text().splitlines())}:1: error: " in refused.stderr


def test_a_bad_deck_does_not_stop_a_batch(good, bad, tmp_path):
    other = write(tmp_path / "other.inp", GOOD)
    process = run("run", good, bad, other, "--out", tmp_path)
    assert process.returncode == 1
    for name in ("good", "other"):
        with h5py.File(tmp_path / f"{name}.vtkhdf") as file:
            assert len(file["history/time"]) == 2
    assert not (tmp_path / "bad.vtkhdf").exists()
    said = process.stdout + process.stderr
    assert all(f"{name}.inp" in said for name in ("good", "bad", "other"))


def test_a_batch_returns_its_largest_status(good, bad, tmp_path):
    failing = write(tmp_path / "failing.inp", GOOD, WRONG_CHECK)
    for decks in ((failing, bad, good), (good, bad, failing)):
        assert run("run", "--quiet", *decks, "--out", tmp_path).returncode == 4
    assert run("run", "--quiet", failing, "--out", tmp_path).returncode == 4
    assert run("run", "--quiet", bad, good, "--out", tmp_path).returncode == 1


def test_equal_base_names_are_an_error_before_anything_runs(good, tmp_path):
    twin = write(tmp_path / "good.inp", GOOD)
    out = tmp_path / "out"
    process = run("run", good, twin, "--out", out)
    assert process.returncode == 1
    assert "good" in process.stderr
    assert not out.exists() or names(out) == []


def test_width_widens_the_card(tmp_path):
    deck = write(tmp_path / "wide.inp", GOOD, ["*NSET, NSET=WIDE", "1" + ", 1" * 90])
    lines = deck.read_text().splitlines()
    lines = [*lines[-2:], ""]
    deck = write(tmp_path / "wide.inp", GOOD[: GOOD.index("*STEP")], lines,
                 GOOD[GOOD.index("*STEP"):])
    narrow = run("run", "--quiet", deck, "--out", tmp_path)
    assert narrow.returncode == 1
    assert ":257: error: " in narrow.stderr
    wide = run("run", "--quiet", deck, "--out", tmp_path, "--width", 280)
    assert (wide.returncode, wide.stderr) == (0, "")


def test_included_cards_count_as_the_decks_own(good, tmp_path):
    start = GOOD.index("*STEP")
    write(tmp_path / "model.inc", GOOD[:start])
    deck = write(tmp_path / "whole.inp", ["*INCLUDE, INPUT=model.inc"], GOOD[start:])
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    for path in (deck, good):
        process = run("run", "--quiet", path, "--out", tmp_path, folder=elsewhere)
        assert process.returncode == 0, process.stderr
    with h5py.File(tmp_path / "whole.vtkhdf") as one, h5py.File(tmp_path / "good.vtkhdf") as other:
        field = "VTKHDF/PointData/displacement"
        assert one[field][()].tobytes() == other[field][()].tobytes()


def test_check_reads_and_solves_nothing(good, bad, tmp_path):
    process = run("check", good, folder=tmp_path)
    assert process.returncode == 0
    assert ": no errors, 0 warnings\n" in process.stdout
    assert run("check", bad, folder=tmp_path).returncode == 1
    assert run("check", good, bad, folder=tmp_path).returncode == 1
    assert names(tmp_path) == ["bad.inp", "decks"]


def test_bodies_that_nothing_holds_are_no_solution(tmp_path):
    loose = [card for card in GOOD if not card.startswith("BLOCK.BOTTOM")]
    process = run("run", "--quiet", write(tmp_path / "loose.inp", loose), "--out", tmp_path)
    assert process.returncode in (1, 2)
    assert "loose.inp" in process.stderr
    assert not (tmp_path / "loose.vtkhdf").exists()


def test_a_folder_that_cannot_be_made_is_status_3(good, tmp_path):
    (tmp_path / "file").write_text("in the way")
    process = run("run", "--quiet", good, "--out", tmp_path / "file")
    assert process.returncode == 3
    assert "error: " in process.stderr


@pytest.mark.parametrize(
    "arguments",
    [["run"], ["solve", "a.inp"], ["run", "a.inp", "--outt", "b"], ["run", "a.inp", "--out"]],
)
def test_a_wrong_command_is_status_1(arguments, tmp_path):
    process = run(*arguments, folder=tmp_path)
    assert process.returncode == 1
    assert "error: " in process.stderr
    assert names(tmp_path) == []


def test_a_deck_that_does_not_exist_is_named(tmp_path):
    process = run("run", "nowhere.inp", folder=tmp_path)
    assert process.returncode == 1
    assert "nowhere.inp" in process.stderr


def test_help_and_version(tmp_path):
    usage = run("--help", folder=tmp_path)
    assert usage.returncode == 0
    assert "thercon run DECK" in usage.stdout and "b.contact.vtkhdf" in usage.stdout
    version = run("--version", folder=tmp_path)
    assert version.returncode == 0
    assert all(name in version.stdout for name in ("thercon", "MUMPS", "METIS", "HDF5", "LAPACK"))


@pytest.mark.parametrize("processor", ["Prescott", "Nehalem"])
def test_version_names_the_processor_of_openblas(tmp_path, monkeypatch, processor):
    monkeypatch.setenv("OPENBLAS_CORETYPE", processor)
    last = run("--version", folder=tmp_path).stdout.splitlines()[-1]
    assert last.startswith("LAPACK") and last.endswith(f", OpenBLAS for {processor}")


def test_help_goes_with_every_command(tmp_path):
    assert run("run", "--help", folder=tmp_path).stdout == run("--help", folder=tmp_path).stdout


def test_files_without_a_step_are_skipped_in_a_batch_only(good, bad, tmp_path):
    mesh = write(tmp_path / "mesh.inp", GOOD[:GOOD.index("*STEP")])
    batch = run("run", good, mesh, "--out", tmp_path / "out")
    assert batch.returncode == 0, batch.stderr
    assert f"{mesh}: note: skipped: it has no *STEP" in batch.stderr
    assert "solved 1, skipped 1" in batch.stdout
    assert names(tmp_path / "out") == sorted(
        ["good" + suffix for suffix in SUFFIXES] + ["thercon-batch.csv"])
    assert run("check", good, mesh).returncode == 0
    alone = run("run", mesh, "--out", tmp_path / "alone")
    assert alone.returncode == 1
    assert "*STEP" in alone.stderr
    faulty = write(tmp_path / "faulty.inp", GOOD[:GOOD.index("*STEP")], ["*NONSENSE"])
    assert run("run", good, faulty, "--out", tmp_path / "out").returncode == 1


def pellets_without_tables(folder):
    """Write the fuel pellets with the first row of each property, so that numbers have uncertainties."""
    text = (INPUT / "examples" / "fuel_pellet.inp").read_text().split("*VERIFY")[0]
    text = re.sub(r"(?m)^(\*(?:ELASTIC|EXPANSION|CONDUCTIVITY).*\n.*\n)(?:\d.*\n)+", r"\1", text)
    text = text.replace("INPUT=", f"INPUT={INPUT / 'examples'}/")
    return write(folder / "pellets.inp", text.replace("FUEL, BF, 0.6", "FUEL, BF, 0.8"))


@pytest.mark.changes("OPTIONS, ERRORS")
def test_errors_says_which_numbers_have_an_uncertainty_whatever_the_deck_says(tmp_path):
    """Those of the ends of steps, all, or none; YES means LAST."""
    rods, rows = INPUT / "examples" / "two_rods.inp", {}
    for name, card, options in (
            ("default", None, ()), ("yes", "YES", ()), ("last", "NO", ("--errors", "last")),
            ("in the deck", "FULL", ()), ("full", "NO", ("--errors", "full")),
            ("no", "FULL", ("--errors", "no"))):
        cards = [f"*OPTIONS, ERRORS={card}"] if card else []
        note_changes(cards, ["*OPTIONS, ERRORS=LAST"])
        deck = copy_deck(rods, tmp_path / "deck.inp", cards)
        process = run("run", deck, "--out", tmp_path, *options)
        assert process.returncode == 0, process.stderr
        with h5py.File(deck.with_suffix(".vtkhdf")) as file:
            rows[name] = file["uncertainty/GAP/normal_force"][:], file["uncertainty/time"][:]
            increments = len(file["history/time"])
            if options:
                assert file["run"].attrs["settings"] == " ".join(options)
    for one, other in ("default", "yes"), ("default", "last"), ("in the deck", "full"):
        for k in range(2):
            np.testing.assert_array_equal(rows[one][k], rows[other][k])
    assert len(rows["full"][1]) == increments > len(rows["last"][1]) == len(rows["no"][1])
    assert np.isfinite(rows["last"][0]).all() and np.isfinite(rows["full"][0]).all()
    assert np.isnan(rows["no"][0][:, 1:]).all()


@pytest.mark.parametrize(("arguments", "words"), [
    (("run", CYLINDER, "--errors", "some"), "option --errors needs last, full or no, not some"),
    (("trade", CYLINDER, "--errors", "full"), "option --errors does not go with trade")])
def test_errors_is_refused_where_it_says_nothing(tmp_path, arguments, words):
    process = run(*arguments, folder=tmp_path)
    assert process.returncode == 1 and words in process.stderr
    assert not list(tmp_path.iterdir())


def test_a_summary_tells_zones_without_an_edge(tmp_path):
    """The faces of the press fit are closed from end to end, those of the rods open."""
    press_fit = run("run", INPUT / "examples" / "press_fit.inp", "--out", tmp_path).stdout
    assert re.search(r"\n    edge of contact +10 +mm, whole face\n", press_fit)
    table = (tmp_path / "press_fit.lst").read_text().split("NUMERICAL UNCERTAINTY (95 %) OF SEAT")[1]
    assert "peak pressure" in table.split("\n\n")[0] and "edge" not in table.split("\n\n")[0]
    pellets = run("run", pellets_without_tables(tmp_path), "--out", tmp_path).stdout
    assert re.search(r"\n    edge of contact +10 +mm, up to an end of the face, closed at 10\n", pellets)
    assert re.search(r"\n    edge of contact +0.51\d+ \+- .* mm, closed from 0 to 0.51\d+, width 0.51\d+\n", pellets)
    assert "edge of stick" not in press_fit, "there is no friction"
    rods = run("run", INPUT / "rods" / "r2.inp", "--out", tmp_path).stdout
    assert re.search(r"\n    edge of contact +none \(open\)\n", rods)
    sliding = run("run", INPUT / "examples" / "brake_pad.inp", "--out", tmp_path).stdout
    assert re.search(r"\n    edge of stick +none\n", sliding)


def test_a_summary_tells_the_interface_then_the_results_then_what_failed(tmp_path):
    deck = copy_deck(CYLINDER, tmp_path / "cylinder.inp", [
        '*VERIFY, KIND=ANALYTIC, SOURCE="wrong on purpose"', "pressure, MAX, LAST, 2., 1.E-6"])
    process = run("run", deck, "--out", tmp_path, "--errors", "full")
    assert process.returncode == 4
    cost, *lines = process.stdout.splitlines()
    assert "ERRORS=FULL solves the deck once more beside itself" in cost
    assert lines[1] == "  at time 900 (increment 45), temperature of TOP 900:"
    assert lines[2] == "  FACE"
    with h5py.File(tmp_path / "cylinder.vtkhdf") as file:
        face = file["contact/FACE"]
        expected = {"normal force": face["normal_force"][-1],
                    "shear force": face["shear_force"][-1],
                    "heat rate": face["heat_rate"][-1],
                    "peak pressure": face["pressure"][-1].max(),
                    "edge of contact": face["edge_contact"][-1],
                    "edge of stick": face["edge_stick"][-1]}
        told = [file[f"uncertainty/FACE/{name}"][-1, 1] for name in (
            "normal_force", "shear_force", "heat_rate", "peak_pressure", "edge_contact", "edge_stick")]
    units = ["MPa cm^2", "MPa cm^2", "W", "MPa", "cm", "cm"]
    for line, (name, value), unit, uncertainty in zip(lines[3:9], expected.items(), units, told, strict=True):
        assert line[4:21].strip() == name
        assert float(line[21:34]) == pytest.approx(value, rel=1e-5)
        assert line.split(",")[0].endswith(" " + unit)
        assert float(line.split("+-")[1].split()[0]) == pytest.approx(uncertainty, rel=0.05)
    assert lines[9].startswith("  largest in body 1 (CYLINDER of UPPER")
    assert any(line.startswith("  largest in body 2 (BASE of LOWER") for line in lines)
    assert re.fullmatch(r" +von Mises stress +\S+ \+- \S+ +\(\S+ %\) +MPa, node \d+ \(\S+, \S+\)",
                        lines[10])
    at = next(k for k, line in enumerate(lines) if line.startswith("  results: "))
    assert lines[at].endswith("cylinder.vtkhdf, .contact.vtkhdf, .lst, .sta, .cvg")
    assert lines[at + 1] == "  37 checks passed, 1 failed"
    assert re.search(r"^\S*cylinder\.inp:\d+: check failed: .* at time \S+: \S+( \+- \S+)?, "
                     r"expected \S+ \(off by \S+ %, allowed \S+ %\)$", process.stderr, re.M)
    listing = (tmp_path / "cylinder.lst").read_text().splitlines()
    start = listing.index("SUMMARY")
    assert [line.strip() for line in listing[start + 2:start + 5]] == [
        "check failed, 45 increments", "37 checks passed, 1 failed", "no warnings"]
    assert [line.strip() for line in listing[start + 5:start + 13]] == [
        line.strip() for line in lines[1:9]]
    titles = [line for line, under in zip(listing, listing[1:], strict=False)
              if under and set(under) == {"-"}]
    order = ["SUMMARY", "MODEL", "INCREMENTS", "SECONDS", "DECK"]
    assert [title for title in titles if title in order] == order
    assert listing.index("VERIFICATION") < listing.index("SECONDS")


def test_a_run_that_ends_early_counts_what_it_could_not_judge(tmp_path):
    deck = copy_deck(CYLINDER, tmp_path / "cylinder.inp", changes={
        "*STEP, INC=": "*FIXED POINT, MAXITER=1\n*STEP, INC="})
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 2
    assert process.stderr.count("error: ") == 1
    assert "note: 37 *VERIFY checks could not be judged" in process.stderr
    listing = (tmp_path / "cylinder.lst").read_text()
    assert "   ended early after 0 increments, see ENDED EARLY below" in listing
    assert listing.count("ENDED EARLY") == 2
    assert "no *VERIFY" not in listing


@pytest.mark.parametrize("command", ["run", "check", "trade"])
def test_a_deck_without_its_ending(tmp_path, command):
    """CalculiX takes the name without .inp; a file of just this name comes first, a folder does
    not."""
    deck = tmp_path / "joint.inp"
    deck.write_text("*NONSENSE\n")
    process = run(command, tmp_path / "joint")
    assert process.returncode == 1
    assert process.stderr.startswith(f"{deck}:1:1: error: unknown keyword")
    (tmp_path / "joint").write_text("*OTHER\n")
    assert run(command, tmp_path / "joint").stderr.startswith(f"{tmp_path / 'joint'}:1:1: ")
    (tmp_path / "joint").unlink()
    (tmp_path / "joint").mkdir()
    assert run(command, tmp_path / "joint").stderr.startswith(f"{deck}:1:1: ")
    missing = tmp_path / "nowhere"
    assert run(command, missing).stderr == (
        f"{missing}: error: the deck cannot be read: there is no such file, and no {missing}.inp\n")


def test_a_run_without_contact_says_what_came_of_it(tmp_path):
    """A bar of length 2 conducts from 400 to 100; at conductivity 50 and width 1 the heat is 7500."""
    deck = tmp_path / "bar.inp"
    deck.write_text("\n".join([
        "*NODE", "1, 0., 0.", "2, 2., 0.", "3, 2., 1.", "4, 0., 1.", "*ELEMENT, TYPE=CPE4, ELSET=BAR",
        "1, 1, 2, 3, 4", "*MATERIAL, NAME=STEEL", "*CONDUCTIVITY", "50.",
        "*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL", "*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.",
        "*BOUNDARY", "1, 11, 11, 400.", "4, 11, 11, 400.", "2, 11, 11, 100.", "3, 11, 11, 100.",
        "*END STEP", ""]))
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    lines = [" ".join(line.split()) for line in process.stdout.splitlines()]
    told = ["at time 1 (increment 1):", "lowest temperature 100", "highest temperature 400",
            "heat in 7500 (no estimate: needs ERRORS=FULL)",
            "heat out 7500 (no estimate: needs ERRORS=FULL)", "largest in body 1 (BAR of STEEL, first node 1)",
            "temperature 400 +- 0 (0 %), node 1 (0, 0)"]
    assert lines[1:8] == told
    assert lines[8].endswith("bar.vtkhdf, .lst, .sta, .cvg")
    listing = [" ".join(line.split()) for line in (tmp_path / "bar.lst").read_text().splitlines()]
    assert listing[listing.index("solved, 1 increment") + 3:][:7] == told


def test_a_summary_tells_all_edges_of_a_zone(tmp_path):
    """Both faces of the turbine joint slip at both ends."""
    said = run("run", INPUT / "examples" / "turbine_joint.inp", "--out", tmp_path).stdout
    with h5py.File(tmp_path / "turbine_joint.vtkhdf") as file:
        for face in file["contact"].values():
            outermost = face["edge_stick"][-1]
            (other,) = (edge for edge in face["edges_stick"][-1][:2] if edge != outermost)
            end = ", up to an end of the face" if outermost == face["s"][-1] else ""
            zone = f"stick from {other:g} to {outermost:g}, width {outermost - other:g}"
            assert re.search(rf"\n    edge of stick +{outermost:g} .* mm{end}, {zone}\n", said)


def test_a_summary_has_a_line_for_each_step_and_interface(tmp_path):
    """With what the interface was at the end of the step, in the listing, too."""
    said = run("run", INPUT / "examples" / "turbine_joint.inp", "--out", tmp_path).stdout
    lines = [line.split() for line in said.splitlines() if line.endswith("whole face") and ":" in line]
    with h5py.File(tmp_path / "turbine_joint.vtkhdf") as file:
        times = file["history/time"][()]
        for line, (step, name) in zip(lines, [(1, "UPPER"), (1, "LOWER"), (2, "UPPER"), (2, "LOWER")],
                                      strict=True):
            face, row = file[f"contact/{name}"], np.flatnonzero(times <= step)[-1]
            assert (int(line[0]), float(line[1]), line[5]) == (step, times[row], name + ":")
            assert float(line[2]) == pytest.approx(face["normal_force"][row], rel=1e-5)
            assert float(line[4]) == pytest.approx(face["pressure"][row].max(), rel=1e-5)
            assert (line[3] == "-") == (step == 1)
    assert re.search(r"whole face\n +the listing has their uncertainties\n +at time", said)
    listing = (tmp_path / "turbine_joint.lst").read_text()
    assert listing.count("LOWER: whole face") == 2
    assert listing.count("NUMERICAL UNCERTAINTY (95 %) OF LOWER") == 2
    assert "their uncertainties" not in run("run", INPUT / "examples" / "turbine_joint.inp", "--errors", "no",
                                            "--out", tmp_path).stdout
    assert "  step  " not in run("run", INPUT / "examples" / "press_fit.inp", "--out", tmp_path).stdout


def test_results_of_an_earlier_run_are_set_aside_or_named(tmp_path):
    """A run that fails before its first increment leaves nothing that a picture takes for its own;
    one that finds a mistake touches nothing, but says what is there."""
    for path in (INPUT / "rods").iterdir():
        (tmp_path / path.name).write_text(path.read_text())
    deck = tmp_path / "r2.inp"
    assert run("run", deck, "--out", tmp_path).returncode == 0
    kept = (tmp_path / "r2.vtkhdf").read_bytes()
    good = deck.read_text()
    deck.write_text(good.replace("*COUPLED", "*COUPLD"))
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 1 and (tmp_path / "r2.vtkhdf").read_bytes() == kept
    assert f'note: "{tmp_path}/r2.vtkhdf" is of an earlier run' in process.stderr
    assert "note:" not in run("check", deck).stderr
    deck.write_text(good.replace("METHOD=NEWTON", "METHOD=PICARD"))
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 2
    assert f'note: the results of an earlier run are in "{tmp_path}/r2.earlier.vtkhdf"' in process.stderr
    assert {path.name for path in tmp_path.glob("r2.*")} == {"r2.inp", "r2.lst", "r2.cvg", *(
        f"r2.earlier.{end}" for end in ("vtkhdf", "contact.vtkhdf", "sta"))}
    assert (tmp_path / "r2.earlier.vtkhdf").read_bytes() == kept


@pytest.mark.parametrize(("arguments", "said"), [
    (["good.inp"], "good.inp is no command; write thercon run good.inp, or thercon check good.inp"),
    (["nowhere.inp"], "nowhere.inp is no command; write thercon run nowhere.inp"),
    (["chekc", "good.inp"], "unknown command chekc; the nearest known is check"),
    (["solve", "good.inp"], "unknown command solve; see thercon --help"),
    (["run", "--acuracy", "1%", "good.inp"], "the nearest known is --accuracy"),
    (["run", "-x", "good.inp"], "unknown option -x; see thercon --help")])
def test_a_wrong_word_is_answered_with_the_one_that_is_meant(good, tmp_path, arguments, said):
    process = run(*arguments, folder=good.parent)
    assert process.returncode == 1
    assert said in process.stderr
