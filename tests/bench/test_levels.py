"""The theme of refinement: what each stage of a run costs, how it grows, what limits a machine."""

import csv
import math
import os
import re
from dataclasses import dataclass

import report  # isort: skip, it makes the modules below known
import h5py
from cylinder import refined
from deck_runs import run
from document import Table

TITLE = "Refined meshes"
TEXT = """
The published cylinder, 45 increments, refined uniformly: each level has four times the elements and
twice the contact points. Errors are not estimated, fields are those of the last increment only.
Without `*SOLVER` the solver is SKYLINE below 5000 displacements, MUMPS from there on. *Reducing* is
factoring the thermal and the mechanical matrix, each with its Schur complement on the contact
points, and what a unit temperature jump at each contact point makes of the forces there.
"""
IN_DOCUMENT = ["Seconds by stage", "What limits one machine"]
STAGES = ("read", "assemble", "reduce", "iterate", "recover", "write")
RUNS = (*((solver, level) for level in range(4) for solver in ("SKYLINE", "MUMPS")),
        ("MUMPS", 4), ("MUMPS", 5))
SHORT = 2.0   # CPU seconds below which a run is repeated


@dataclass(frozen=True)
class Measured:
    """A run: its solver and level, CPU seconds of all and of each stage, memory [MB], and
    attributes of /run."""

    solver: str
    level: int
    seconds: float
    stages: dict
    memory: float
    run: dict


def measure(folder, solver, level, repeats=3):
    """Run the cylinder, a short run so many times; return the run with the median of seconds."""
    deck = refined(folder, level, f"*SOLVER, TYPE={solver}")
    found = []
    while not found or (found[-1].seconds < SHORT and len(found) < repeats):
        process = run("run", "--quiet", "--jobs", 1, deck.name, folder=folder, seconds=900)
        assert process.returncode == 0, process.stderr
        with open(folder / "thercon-batch.csv") as file:
            (row,) = csv.DictReader(file)
        seconds, memory = float(row["cpu_seconds"]), float(row["peak_megabytes"])
        with h5py.File(deck.with_suffix(".vtkhdf")) as file:
            about = dict(file["run"].attrs)
        elapsed = {stage: float(about[f"seconds_{stage}"]) for stage in STAGES}
        share = seconds / sum(elapsed.values())
        found.append(Measured(solver, level, seconds,
                              {stage: share * t for stage, t in elapsed.items()}, memory, about))
    return sorted(found, key=lambda one: one.seconds)[len(found) // 2]


def stage_table(measured):
    """Return the table of seconds and memory."""
    table = Table("Seconds by stage", [
        "refinements", "displacements", "contact unknowns", "solver", *STAGES, "all [s]",
        "memory [MB]"])
    for one in measured:
        table.rows.append([one.level, f"{int(one.run['equations_mechanical']):,}",
                           int(one.run["contact_unknowns"]), one.solver,
                           *(one.stages[stage] for stage in STAGES), one.seconds,
                           f"{one.memory:.0f}"])
    return table


def growth_table(measured):
    """Return the table of exponents of the number of displacements."""
    table = Table("Growth", ["levels", "solver", "factor of all", *STAGES, "all", "memory"],
                  text="Exponents p, where seconds and memory grow as the number of displacements "
                       "to the power of p from one level to the next.")
    by_run = {(one.solver, one.level): one for one in measured}
    for (solver, level), one in by_run.items():
        if level == 0 or (solver, level - 1) not in by_run:
            continue
        before = by_run[solver, level - 1]
        unknowns = math.log(one.run["equations_mechanical"] / before.run["equations_mechanical"])
        pairs = [(before.stages[stage], one.stages[stage]) for stage in STAGES]
        pairs += [(before.seconds, one.seconds), (before.memory, one.memory)]
        table.rows.append([f"{level - 1} to {level}", solver, f"{one.seconds / before.seconds:.1f}",
                           *(f"{math.log(b / a) / unknowns:.2f}" for a, b in pairs)])
    return table


def ratio_table(measured):
    """Return the table of the whole run beside its factorisations."""
    return Table("The whole run by its factorisations",
                 ["refinements", "solver", "reducing [s]", "all [s]", "ratio"],
                 [[one.level, one.solver, one.stages["reduce"], one.seconds,
                   f"{one.seconds / one.stages['reduce']:.1f}"] for one in measured])


def estimate(folder, solver, level):
    """Return the memory that the program says a run will need [MB], from a check or where it
    refuses the deck for want of memory."""
    process = run("check", refined(folder, level, f"*SOLVER, TYPE={solver}"), folder=folder)
    found = re.search(r"memory of a run\W+(\d+) MB|needs about (\d+) MB",
                      process.stdout + process.stderr)
    return int(found[1] or found[2])


def machine_table(folder, measured, levels):
    """Return the table of the memory needed."""
    peaks = {(one.solver, one.level): f"{one.memory:.0f}" for one in measured}
    table = Table(
        "What limits one machine",
        ["refinements", "SKYLINE estimated [MB]", "used [MB]", "MUMPS estimated [MB]", "used [MB]"],
        text=f"""
A run uses one thread, and memory is what ends first. The program estimates what a run will need
before it refines the mesh, and refuses decks for which the machine has too little (exit status 3).
This one has {memory():.0f} GB. Dense matrices of the contact unknowns grow by four from level to
level, factors in nested dissection (MUMPS) a little faster, the skyline by eight.
""")
    for level in levels:
        row = [level]
        for solver in ("SKYLINE", "MUMPS"):
            row += [estimate(folder, solver, level), peaks.get((solver, level), "-")]
        table.rows.append(row)
    return table


def memory():
    """Return the memory of this machine [GB]."""
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9


def tables(folder, chosen=RUNS, levels=range(7), repeats=3):
    """Return the tables of some runs, and of the memory at some levels."""
    measured = [measure(folder, *one, repeats) for one in chosen]
    return [stage_table(measured), growth_table(measured), ratio_table(measured),
            machine_table(folder, measured, levels)]


def test_a_run_has_its_stages_growth_and_memory(tmp_path):
    """On the published mesh and refined once."""
    stages, growth, ratios, machine = tables(
        tmp_path, [("SKYLINE", 0), ("SKYLINE", 1)], levels=[0, 1], repeats=1)
    assert [row[0] for row in stages.rows] == [0, 1]
    assert all(math.isclose(sum(row[4:10]), row[10]) for row in stages.rows)
    assert [row[0] for row in growth.rows] == ["0 to 1"]
    for row, of_run in zip(ratios.rows, stages.rows, strict=True):   # all and reducing, of the other table
        assert row[-1] == f"{of_run[10] / of_run[6]:.1f}"
    assert all(row[1] >= float(row[2]) for row in machine.rows)
