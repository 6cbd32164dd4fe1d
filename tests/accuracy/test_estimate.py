"""The estimated errors against true ones: five decks on four meshes with three sizes of increments."""

import re
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from deck_runs import COUPLED, CYLINDER, HERTZ, INPUT, solve
from report import Table, check_parts, rows, verdict

TITLE = "Estimated errors"
TEXT = """
Every run with contact estimates its errors and prints them at the end of each step, beside each other: those of the mesh, of the increments and of the
fixed point. `/errors/<pair>/<quantity>` of the result file holds them, a row a step: value, error of the mesh, of the increments, of
the iteration. They say what would have to be added to the value; for edges of zones, how far they may be off to either side.

- **Mesh.** The last increment of the step is corrected to what it would be if every element were divided into four (`src/accuracy`), and the error is
  1.25 of the change: errors that fall with h^4 are 1.07 of it, those that fall with h are twice the change. The finer mesh is never factored.
- **Increments.** Where friction or the scheme of (3.4) make the path matter, a second run on the pairs alone is led beside the first with
  increments of twice the size. The error is 0.6 of the difference: between 1/3 and 1, what errors of the second and the first order are.
- **Iteration.** Residual of the fixed point over the distance of the coupling gain from 1: a bound.
- **Edges of zones** are known to a part of the nodal spacing beside that: 0.2 for the edge of contact and 0.6 for that of stick.

Below, true errors are differences to a mesh one level finer than the finest in the table, with what is left there extrapolated, and to increments an
eighth as long. A ratio is true error over estimate; 0.5 to 2 is the goal. Errors of less than 1e-8 of the value are not judged: forces that the
deck prescribes. Where a pressure grows without limit as the mesh is refined, at the corner of a punch, no error of it is finite, and the
estimate only says that it is large; such decks are not among the five.
"""
LEVELS = (0, 1, 2, 3)
PARTS = (1, 2, 4)
QUANTITIES = {"normal_force": "normal force", "heat_rate": "heat rate",
              "peak_pressure": "peak pressure"}
EDGES = {"edge_contact": "edge of contact", "edge_stick": "edge of stick"}
LEAST = 1e-8
MOST = 0.7  # ratio of changes from mesh to mesh above which nothing is extrapolated
GOAL = 0.9
FINEST_PARTS = 8
ANALYSIS = re.compile(r"^(\*(?:STATIC|COUPLED|HEAT).*\n)\s*([0-9.eE+-]+)", re.M | re.I)


@dataclass(frozen=True)
class Case:
    """A deck, its interface, and whether the path to the end of the load matters."""

    name: str
    deck: Path
    face: str
    has_path: bool = False


CASES = (Case("cylinder", CYLINDER, "FACE", True),
         Case("coupled twin", COUPLED, "FACE", True),
         Case("Hertz", HERTZ, "FACE"),
         Case("cracked plate", INPUT / "examples" / "cracked_plate.inp", "CRACK"),
         Case("press fit", INPUT / "examples" / "press_fit.inp", "SEAT"))


def run_case(case, level, parts, folder, estimate=True):
    """Return the rows of /errors at the end of a run, by quantity."""
    text = case.deck.read_text()
    text = re.sub(r"^\*REFINE.*\n", "", text, flags=re.M)
    text = text.split("*VERIFY")[0]
    text = re.sub(r"INC=\d+", "INC=10000", text)
    text = ANALYSIS.sub(lambda found: f"{found[1]}{float(found[2]) / parts!r}", text)
    cards = f"*REFINE, LEVELS={level}\n" + ("*SOLVER, TYPE=MUMPS\n" if level > 2 else "")
    text = re.sub(r"^\*STEP", cards + "*STEP", text, count=1, flags=re.M | re.I)
    text = re.sub(r"^(\*(?:NODE|EL|CONTACT) FILE)", r"\1, FREQUENCY=0", text, flags=re.M | re.I)
    for mesh in case.deck.parent.glob("*.mesh"):
        (folder / mesh.name).write_text(mesh.read_text())
    deck = folder / f"{case.name.replace(' ', '_')}_{level}_{parts}.inp"
    deck.write_text(text)
    result = solve(deck, seconds=900)
    with h5py.File(result) as file:
        return {name: data[-1] for name, data in file[f"errors/{case.face}"].items()}


def limits(case, folder):
    """Return the converged values of the quantities: over the mesh, and with what smaller increments
    change on the second mesh."""
    runs = [run_case(case, level, 1, folder) for level in (2, 3, 4)]
    fine = run_case(case, 1, FINEST_PARTS, folder) if case.has_path else None
    coarse = run_case(case, 1, 1, folder)
    found = {}
    for name in (*QUANTITIES, *EDGES):
        values = [run[name][0] for run in runs]
        last, before = values[2] - values[1], values[1] - values[0]
        ratio = last / before if before else 0.0
        left = last * ratio / (1.0 - ratio) if 0.0 < ratio < MOST and name in QUANTITIES else 0.0
        path = fine[name][0] - coarse[name][0] if fine and name in QUANTITIES else 0.0
        found[name] = values[2] + left + path
    return found


def judged(case, folder, levels=LEVELS, parts=PARTS, exact=None):
    """Return, for each run, the ratios of true to estimated errors, or for edges whether the band
    holds; NaN where there is nothing to judge."""
    exact = exact or limits(case, folder)
    found = []
    for level in levels:
        for part in parts:
            run = run_case(case, level, part, folder)
            figures = {}
            for name in QUANTITIES:
                value, mesh, increment, _ = run[name]
                true = exact[name] - value
                too_small = not abs(true) > LEAST * abs(exact[name])
                figures[name] = np.nan if too_small else true / (mesh + increment)
            for name in EDGES:
                value, mesh, increment, _ = run[name]
                figures[name] = np.nan if np.isnan(exact[name]) else float(
                    abs(exact[name] - value) <= mesh + abs(increment))
            found.append((level, part, figures))
    return found


def share(figures, good):
    """Return how many of some figures are good, and how many there are."""
    known = [figure for figure in figures if not np.isnan(figure)]
    return sum(map(good, known)), len(known)


def within(ratio):
    """Return whether an estimate is within a factor of two of the error."""
    return 0.5 <= ratio <= 2.0


def tables(folder):
    """Run all cases; return the table of ratios and that of the shares."""
    runs = Table("True error over estimate", ["deck", "refinements", "increments",
                 *QUANTITIES.values(), *(f"{name} in band" for name in EDGES.values())])
    everything = []
    for case in CASES:
        for level, part, figures in judged(case, folder):
            everything.append(figures)
            cells = [figures[name] for name in QUANTITIES]
            edges = [figures[name] for name in EDGES]
            runs.rows.append([case.name, level, f"1/{part}" if part > 1 else "as written",
                              *("-" if np.isnan(cell) else f"{cell:.2f}" for cell in cells),
                              *("-" if np.isnan(e) else "yes" if e else "no" for e in edges)])
    total = Table("How many hold", ["quantity", "runs", "hold", "goal 90 %"])
    for name, title in QUANTITIES.items():
        hold, of = share([run[name] for run in everything], within)
        total.rows.append([title, of, hold, verdict(hold >= GOAL * of)])
    for name, title in EDGES.items():
        hold, of = share([run[name] for run in everything], bool)
        total.rows.append([title, of, hold, verdict(hold >= GOAL * of)])
    return [total, runs]
