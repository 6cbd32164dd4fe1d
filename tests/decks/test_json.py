"""`--json`: one document on standard output, with what the terminal and the result file have."""

import json
import re

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import DECKS, INPUT, copy_deck, run
from test_command_line import GOOD

RODS = INPUT / "examples" / "two_rods.inp"
PUBLISHED = "normal_force", "shear_force", "heat_rate", "edge_contact", "edge_stick"


def document_of(*arguments, status=0, folder=None):
    """Run the program with --json; return the document and what stderr has."""
    process = run(*arguments, "--json", folder=folder)
    assert process.returncode == status, process.stderr
    assert process.stdout.count("\n") == 1 and process.stdout.isascii()
    document = json.loads(process.stdout, parse_constant=pytest.fail)
    assert document["program"] == "thercon" and document["command"] == arguments[0]
    assert document["status"] == status
    return document, process.stderr


def test_results_are_those_of_the_result_file(tmp_path):
    document, said = document_of("run", RODS, "--out", tmp_path)
    assert said == "" and document["messages"] == []
    assert all(map(h5py.is_hdf5, document["files"][:2])) and document["files"][2].endswith(".lst")
    summary = document["summary"]
    found = summary["interfaces"]["GAP"]
    with h5py.File(tmp_path / "two_rods.vtkhdf") as file:
        run_of, history, contact = file["run"].attrs, file["history"], file["contact/GAP"]
        assert document["increments"] == len(history["time"]) == summary["increment"]
        assert document["iterations"] == history["iterations"][:].sum()
        assert document["checks_passed"] == run_of["verify_passed"] == len(document["checks"])
        for name in ("equations_thermal", "equations_mechanical", "contact_unknowns", "modelled"):
            assert document["model"][name] == run_of[name]
        assert (summary["time"], summary["load"]) == (history["time"][-1], history["load"][-1])
        assert summary["load_label"] == history["load"].attrs["label"]
        assert found["contact_points"] == contact["pressure"].shape[1]
        assert found["closed_contact_points"] == np.count_nonzero(contact["status"][-1])
        for name in PUBLISHED:
            value = contact[name][-1]
            assert found[name]["value"] == (None if np.isnan(value) else value)
            assert found[name]["unit"] == contact[name].attrs["unit"]
        assert found["peak_pressure"]["value"] == contact["pressure"][-1].max()
        for name in ("normal_force", "shear_force", "heat_rate", "peak_pressure"):
            value, uncertainty = file[f"uncertainty/GAP/{name}"][-1, :2]
            assert (found[name]["value"], found[name]["uncertainty"]) == (value, uncertainty)
        assert found["edge_contact"]["no_estimate"] == "end of the face"
        for name in ("heat_in", "heat_out"):
            assert summary["fields"][name]["value"] == history[name][-1]
        for number, body in enumerate(summary["bodies"], start=1):
            for name in ("von_mises", "temperature"):
                value, uncertainty = file[f"uncertainty/body {number}/{name}"][-1, :2]
                assert (body[name]["value"], body[name]["uncertainty"]) == (value, uncertainty)


def test_a_reason_stands_where_there_is_no_uncertainty(tmp_path):
    document, _ = document_of("run", RODS, "--out", tmp_path, "--errors", "no")
    force = document["summary"]["interfaces"]["GAP"]["normal_force"]
    assert force["no_estimate"] == "ERRORS=NO" and "uncertainty" not in force
    assert len(document["summary"]["bodies"]) == 2
    for body in document["summary"]["bodies"]:
        assert body["temperature"]["no_estimate"] == body["von_mises"]["no_estimate"] == "ERRORS=NO"


def test_units_that_the_deck_does_not_name_are_told_by_what_is_measured(tmp_path):
    deck = copy_deck(RODS, tmp_path / "deck.inp", ['*OPTIONS, UNITS="mm MPa"'])
    document, _ = document_of("run", deck, "--out", tmp_path)
    told = document["summary"]["interfaces"]["GAP"]
    assert (told["normal_force"]["unit"], told["heat_rate"]["unit"]) == ("MPa mm^2", "power")


def test_nothing_else_is_on_standard_output(tmp_path):
    """Not what ERRORS=FULL costs either."""
    document, _ = document_of("run", RODS, "--out", tmp_path, "--errors", "full")
    assert all(check["no_estimate"] != "needs ERRORS=FULL"
               for check in document["checks"] if "no_estimate" in check)


def test_a_failed_check_has_its_numbers_and_its_place(tmp_path):
    deck = write(tmp_path / "deck.inp", GOOD,
                 ['*VERIFY, KIND=ANALYTIC, SOURCE="wrong on purpose"', "time, , LAST, 2., 1.E-6",
                  "time, , 0.5, 0.5, 1.E-6"])
    document, said = document_of("run", deck, "--out", tmp_path, status=4)
    first, second = document["checks"]
    assert (first["expected"], first["found"], first["deviation"], first["passed"]) == \
        (2.0, 1.0, 0.5, False)
    assert f"{first['address']}: check failed" in said
    assert second["passed"] and (second["time"], second["found"]) == (0.5, 0.5)
    assert document["outcome"] == "check failed" and document["checks_failed"] == 1


def test_a_run_that_does_not_converge_has_its_reason_and_what_was_kept(tmp_path):
    deck = copy_deck(RODS, tmp_path / "deck.inp", changes={"TOL=1.E-12": "TOL=1.E-12, MAXITER=1"})
    process = run("run", deck, "--out", tmp_path, "--json")
    document = json.loads(process.stdout)
    assert document["status"] == process.returncode == 2
    assert document["outcome"] == "not converged"
    last = document["messages"][-1]
    assert last["severity"] == "error" and f"{deck}: error: {last['message']}" in process.stderr
    assert "line" not in last


@pytest.mark.parametrize("name", ["arithmetic", "parameters", "settings", "undefined_twice"])
def test_messages_of_a_refused_deck_are_those_of_the_terminal(name):
    """Also places in included files, and messages on the deck as a whole."""
    folder = DECKS / "refused"
    arguments = folder / f"{name}.args"
    more = arguments.read_text().split() if arguments.exists() else []
    document, said = document_of("check", f"{name}.inp", *more, status=1, folder=folder)
    lines = [line for line in said.splitlines() if re.search(r": (error|warning): ", line)]
    assert len(lines) > 0
    assert lines == [
        ":".join([m["file"], *(str(m[key]) for key in ("line", "column") if key in m)])
        + f": {m['severity']}: {m['message']}" for m in document["messages"]]
    assert "model" not in document


def test_check_tells_what_the_deck_holds(tmp_path):
    document, _ = document_of("check", RODS)
    assert document["model"]["bodies"] == 2
    memory = re.search(r"memory of a run \.* (\d+) MB", run("check", RODS).stdout)[1]
    assert document["model"]["memory_megabytes"] == int(memory)
    assert "memory of a run" not in document["model"]
    assert document["interfaces"]["GAP"]["contact_points"] == 3
    assert document["interfaces"]["GAP"]["smallest_initial_gap"] == pytest.approx(0.03, rel=1e-12)
    assert list(tmp_path.iterdir()) == []


def test_any_text_is_in_the_document(tmp_path):
    """Quotes, backslashes, control characters, and characters beyond U+FFFF."""
    name = 'a "b" \\ µ\t\N{GRINNING FACE}.inp'
    deck = write(tmp_path / name, GOOD)
    document, _ = document_of("run", name, folder=tmp_path)
    assert document["deck"] == name
    assert {(tmp_path / file).name for file in document["files"]} == \
        {name.replace(".inp", end) for end in (".vtkhdf", ".lst", ".sta", ".cvg")}
    assert deck.exists()


@pytest.mark.parametrize(("arguments", "said"), [
    (["run", "a.inp", "b.inp"], "--json takes one deck, without --jobs"),
    (["run", "a.inp", "--jobs", "2"], "--json takes one deck, without --jobs"),
    (["check", "a.inp", "b.inp"], "--json takes one deck, without --jobs"),
    (["trade", "a.inp"], "option --json does not go with trade")])
def test_it_is_for_one_deck(arguments, said):
    process = run(*arguments, "--json")
    assert process.returncode == 1 and said in process.stderr and process.stdout == ""


def test_the_table_of_keywords_has_every_one(tmp_path):
    """As the source has them, and where they may be as a deck is judged."""
    lines = run("--keywords").stdout.splitlines()
    source = (DECKS.parents[1] / "src/deck/reading/keywords.f90").read_text()
    names = re.findall(r"keyword_type\('([^']+)'", source)
    assert [re.split(r"  +", line)[0] for line in lines[1:]] == [f"*{name}" for name in names]
    where = lines[0].index("where")
    table = {line[:where].strip(): line[where:].split("  ")[0] for line in lines[1:]}
    for keyword, place in (("*NODE", "model"), ("*CLOAD", "step"), ("*BOUNDARY", "model or step")):
        assert table[keyword] == place
    row = next(line for line in lines if line.startswith("*SURFACE "))
    assert row.endswith("1 or more    NAME=, TYPE=, (INTERNAL), (TRIM=), (MAX RATIO=)")
    deck = write(tmp_path / "deck.inp", ["*CLOAD", "1, 1, 2."], GOOD)
    assert "1:1: error: *CLOAD" in run("check", deck).stderr


def test_the_table_of_some_keywords():
    whole = run("--keywords").stdout.splitlines()
    for words in (["gap", "cond"], ["*GAP CONDUCTANCE"]):
        assert run("--keywords", *words).stdout.splitlines() == [
            whole[0], *(line for line in whole if line.startswith("*GAP CONDUCTANCE "))]
    process = run("--keywords", "FLIM")
    assert process.returncode == 1 and process.stdout == ""
    assert process.stderr == "thercon: error: no keyword begins with *FLIM; thercon --keywords prints all\n"
