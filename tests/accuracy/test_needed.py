"""The theme of what is needed only: what each part of a model costs, and what one that is off does."""

import os
import resource
import shutil
import statistics
import subprocess
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import report  # isort: skip, it makes the modules below known
import h5py
import pytest
from instructions import PROGRAM, Profile, profile
from needed_decks import CASES, Case, write_deck
from program_parts import PARTS

TITLE = "Only what is needed"
TEXT = """
A deck pays for the physics that it uses: parts that are off take less than 1 % of the instructions,
which callgrind counts and a test repeats. On the mesh of the cylinder, 20 increments with `ERRORS=NO`
take 116 million instructions with heat alone, 150 with mechanics alone, 199 with contact, 267 with
heat, contact and friction, and 314 with the conductance of the paper; the default estimate of
errors makes that 516.
"""
DETAILS = """
A deck pays for the physics that it uses: parts that are off take less than 2 % of the instructions.
The mesh is that of the published cylinder, with heat, contact, friction and coupling switched on
one by one. Without heat the top is pushed down; with heat it is held and heated. `heat, mechanics,
contact, friction` has a constant conductance, `the same, coupled` that of the paper.

Instructions are counted by callgrind on the program as users have it, and are the same in every
run. CPU seconds are medians, user and system together, from start to end of the process.
"""
IN_DOCUMENT = []
ALLOWED = 0.02   # of all instructions, for a part that is off
RUNS = 5         # of which CPU seconds are the median
# Uniform refinements, increments, and the decks: of the finer mesh those in which most is off.
SIZES = ((0, 20, CASES), (2, 2, tuple(CASES[k] for k in (0, 3, 6))))
# What the test runs instead: the coarser mesh, in fewer increments, each part off beside as much as
# can be on without it.
WITHOUT_FRICTION = replace(CASES[6], name="heat, mechanics, contact", friction=False)
TESTED = ((0, 3, (CASES[2], CASES[4], CASES[5], WITHOUT_FRICTION)), (2, 2, ()))
MEASURED = pytest.mark.skipif(
    os.environ.get("THERCON_BUILD_TYPE", "Release") != "Release" or not shutil.which("valgrind"),
    reason="instructions are those of a release build under valgrind")


@dataclass(frozen=True)
class Measured:
    """A deck that was run: its profile, CPU seconds, attributes of /run."""

    case: Case
    profile: Profile
    seconds: float
    run: dict


def cpu_seconds(deck, runs):
    """Return the median of the CPU seconds of some runs of a deck."""
    taken = []
    for _ in range(runs):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([PROGRAM, "run", "--quiet", deck, "--out", deck.parent], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        taken.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return statistics.median(taken)


def measured(cases, folder, levels, increments, runs=RUNS, jobs=None):
    """Run the decks of cases under callgrind, as many side by side as there are processors or jobs,
    then without it, one by one."""
    decks = [write_deck(case, folder / f"deck-{levels}-{k}.inp", levels, increments)
             for k, case in enumerate(cases)]

    def profiled(deck):
        return profile("run", "--quiet", deck, "--out", folder, path=deck.with_suffix(".out"))

    with ThreadPoolExecutor(jobs or os.cpu_count()) as pool:
        profiles = list(pool.map(profiled, decks))
    return [of_result(case, profile, deck, runs)
            for case, profile, deck in zip(cases, profiles, decks, strict=True)]


def of_result(case, profiled, deck, runs):
    """Return what a deck that was run under callgrind costs without it, and its sizes."""
    seconds = cpu_seconds(deck, runs)
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        return Measured(case, profiled, seconds, dict(file["run"].attrs))


def costs(runs, levels, increments):
    """Return the table of what runs cost and of the unknowns that they carry."""
    table = report.Table(
        f"Cost of parts that are on, *REFINE, LEVELS={levels}, {increments} increments",
        ["deck", "unknown temperatures", "displacements", "contact unknowns", "kB of factors",
         "million instructions", "CPU s"])
    for run in runs:
        sizes = [int(run.run[name]) for name in (
            "equations_thermal", "equations_mechanical", "contact_unknowns", "factor_bytes")]
        table.rows.append([run.case.name, *sizes[:3], sizes[3] // 1000, run.profile.total / 1e6,
                           run.seconds])
    return table


def per_cent(shares):
    """Return the largest of some shares in per cent, or a dash where there are none."""
    return f"{100 * max(shares):.2f} %" if shares else "-"


def has_part(run, part, levels):
    """Return whether a part is on in a run: refinement and MUMPS follow from the mesh."""
    return (part in run.case.on or (part == "refinement" and levels > 0)
            or (part == "MUMPS" and run.run["solver"] == "MUMPS"))


def off(groups):
    """Return the table of what parts take where they are off, at most, and where they are on."""
    table = report.Table(
        "Parts that are off",
        ["part", *(f"off, LEVELS={levels}" for levels, *_ in SIZES), "on", "verdict"], text="""
Largest part of a run's instructions over all decks above in which a part is off, or on: those spent in lines of modules and
procedures that exist for that part only (`tests/accuracy/program_parts.py`), inlined ones too, and in whatever these call.""".strip())
    for part, names in PARTS.items():
        shares = {is_on: [[run.profile.share(names) for run in runs
                           if has_part(run, part, levels) is is_on]
                          for (levels, *_), runs in zip(SIZES, groups, strict=True)]
                  for is_on in (False, True)}
        largest = max(max(of_size, default=0.0) for of_size in shares[False])
        table.rows.append([part, *map(per_cent, shares[False]), per_cent(sum(shares[True], [])),
                           report.verdict(largest < ALLOWED)])
    return table


def tables(folder):
    """Run all decks and return the tables of the theme."""
    groups = [measured(cases, folder, *size) for *size, cases in SIZES]
    return [costs(groups[0], *SIZES[0][:2]), off(groups)]


@MEASURED
def test_parts_that_are_off_cost_next_to_nothing(tmp_path):
    """A part that is off takes less than 2 % of the instructions, as the document tells."""
    groups = [measured(cases, tmp_path, levels, increments, runs=1, jobs=1)
              for levels, increments, cases in TESTED]
    table = off(groups)
    told = {row["part"]: row["verdict"] for row in report.rows(table.title)}
    assert told == {part: verdict for part, *_, verdict in table.rows}
    assert report.verdict(False) not in told.values()


def test_a_profile_that_names_a_file_once_is_of_that_file(tmp_path):
    """Callgrind names the file of a function only where it is another than that of the function
    before, whatever was inlined into that one."""
    from instructions import SOURCES, read

    inlined, home = (next(SOURCES.rglob(f"{name}.f90")) for name in ("clock", "deck_run"))
    line = 1 + next(k for k, text in enumerate(home.read_text().splitlines())
                    if "subroutine solve_deck" in text)
    path = tmp_path / "profile"
    path.write_text(f"fl=(1) {home}\nfn=(1) first\n{line} 2\nfi=(2) {inlined}\n+3 5\n\n"
                    f"fn=(2) second\n{line} 7\nsummary: 14\n")
    assert read(path).own[("deck_run", "solve_deck")] == 9


def test_parts_name_what_the_program_has():
    """Every module and procedure of the parts is there, so that none is left out by a new name."""
    from instructions import SOURCES, procedures

    modules = {path.stem for path in SOURCES.rglob("*.f90")}
    for name in set().union(*PARTS.values()):
        module, _, procedure = name.partition(":")
        assert module in modules, name
        assert not procedure or procedure in procedures(module), name
