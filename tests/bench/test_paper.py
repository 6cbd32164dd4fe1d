"""The theme of the published case: instructions of each stage."""

import os
import shutil

import report  # isort: skip, it makes the modules below known
import pytest
from deck_runs import CYLINDER
from document import Table
from instructions import SOURCES, profile

TITLE = "The published case"
TEXT = """
`input/cylinder/cylinder.inp` as it is delivered: 45 increments, all fields, tables and estimates of
errors. Instructions are those of callgrind, and the same from run to run, but for writing, which goes by
elapsed time. Estimates of errors include the increments that they solve themselves.
"""
OUTPUT = {path.stem for path in (SOURCES / "output").glob("*.f90")}
ESTIMATES = {path.stem for path in (SOURCES / "accuracy").glob("*.f90")}
ALLOWED = 1.0e9  # instructions, about 0.15 s on one core
# Calls from one place to another that begin a stage: modules, or `module:procedure`.
STAGES = {
    "reading the deck": ({"deck_preparation"}, {"deck_reader", "deck_builder"}),
    "assembling": ({"deck_run"}, {"simulation:assemble"}),
    "reducing": ({"deck_run"}, {"simulation:reduce"}),
    "iterating": ({"increment_attempts"}, {"increment_solution:solve_points"}),
    "recovering": ({"increments", "increment_attempts"}, {"increment_solution:recover_fields", "increment_records"}),
    "estimating errors": ({"adaptive_rounds"}, ESTIMATES),
    "writing": ({"deck_run"}, OUTPUT),
}


def is_in(place, names):
    """Return whether a place is in one of these modules and procedures."""
    return place[0] in names or ":".join(place) in names


def stage_instructions(deck, folder):
    """Return the instructions of each stage, of the rest and of all."""
    found = profile("run", "--quiet", deck, "--out", folder, path=folder / "profile")
    costs = {stage: sum(cost for (source, target), cost in found.calls.items()
                        if is_in(source, sources) and is_in(target, targets))
             for stage, (sources, targets) in STAGES.items()}
    costs["starting, preparing and ending"] = found.total - sum(costs.values())
    return {**costs, "all": found.total}


def tables(folder):
    """Return the table of stages."""
    costs = stage_instructions(CYLINDER, folder)
    return [Table("Instructions by stage", ["stage", "million instructions", "part"],
                  [[stage, f"{cost / 1e6:.1f}", f"{100 * cost / costs['all']:.1f} %"]
                   for stage, cost in costs.items()])]


@pytest.mark.skipif(
    os.environ.get("THERCON_BUILD_TYPE", "Release") != "Release" or not shutil.which("valgrind"),
    reason="instructions are those of a release build under valgrind")
def test_the_published_case_takes_few_instructions_and_each_stage_has_some(tmp_path):
    """From reading the deck to closing the result file, with the estimates; a time would tell more of
    the machine and its load than of the program. A stage without instructions has lost the calls that
    begin it."""
    costs = stage_instructions(CYLINDER, tmp_path)
    assert (tmp_path / "cylinder.sta").read_text().splitlines()[-1].split()[0] == "45"
    assert all(cost > 0 for cost in costs.values()), costs
    assert costs["all"] <= ALLOWED
