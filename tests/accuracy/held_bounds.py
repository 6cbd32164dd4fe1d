"""Bounds of errors against true errors, on decks, meshes and increments.

The converged value of a quantity at the end of a step is that on a mesh refined four times at the
faces and twice elsewhere, with increments a quarter as long; what a sixteenth changes is added, from
the mesh refined once. Runs that take long are kept in the folder $THERCON_CONVERGED, if that is set.
"""

import os
import re
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from bound_decks import EXAMPLES
from deck_runs import solve

QUANTITIES = {"normal_force": "normal force", "shear_force": "shear force", "heat_rate": "heat rate",
              "peak_pressure": "peak pressure", "edge_contact": "edge of contact",
              "edge_stick": "edge of stick"}
LEVELS, PARTS = (0, 1, 2), (1, 2)
FINE = "fine"
LEAST = 1e-7   # of the value: errors that are rounding, or forces that the deck prescribes
ANALYSIS = re.compile(r"^(\*(?:STATIC|COUPLED|HEAT).*\n)\s*([0-9.eE+-]+)", re.M | re.I)


@dataclass(frozen=True)
class Case:
    """A bound and the error that it should hold."""

    deck: str
    is_fitted: bool
    level: int
    part: int
    step: int
    quantity: str
    converged: float
    error: float
    bound: float

    @property
    def is_uncertain(self):
        """Return whether there is no bound."""
        return bool(np.isnan(self.bound))

    @property
    def is_held(self):
        """Return whether the error is inside the bound."""
        return abs(self.error) <= self.bound


def run(deck, level, part, folder, estimates=True):
    """Solve a deck with other elements and increments; return the result file."""
    pair, faces = re.search(r"^(\*CONTACT PAIR.*)\n(.+)", deck.text, re.M).groups()
    # The faces of node pairs are divided together, those of mortar points each for itself.
    divided = faces.split(",")[:2 if "PAIRING=SURFACES" in pair else 1]
    cards = {0: [], FINE: ["*REFINE, LEVELS=2", *(f"*REFINE, LEVELS=2, SURFACE={face.strip()}"
                                                  for face in divided)]}.get(
        level, [f"*REFINE, LEVELS={level}"])
    cards.append(f"*OPTIONS, ERRORS={'YES' if estimates else 'NO'}")
    text = re.sub(r"^\*REFINE.*\n", "", deck.text.split("*VERIFY")[0], flags=re.M)
    text = re.sub(r"INC=\d+", "INC=100000", text)
    text = ANALYSIS.sub(lambda found: f"{found[1]}{float(found[2]) / part!r}", text)
    text = re.sub(r"^\*STEP", "\n".join([*cards, "*STEP"]), text, count=1, flags=re.M)
    text = re.sub(r"^(\*(?:NODE|EL|CONTACT) FILE)(, FREQUENCY=0)?", r"\1, FREQUENCY=0", text, flags=re.M)
    for mesh in EXAMPLES.glob("*.mesh"):
        (folder / mesh.name).write_text(mesh.read_text())
    path = folder / f"{re.sub('[^a-z0-9]+', '_', deck.name.lower())}_{level}_{part}.inp"
    path.write_text(text)
    return solve(path, seconds=900)


def ends_of_steps(file):
    """Return the indices of the increments that end the steps of a result file."""
    times = file["history/time"][:]
    return [int(np.argmin(np.abs(times - end))) for end in file["errors/time"][:]]


def values_of(deck, level, part, times, folder):
    """Return the quantities at times, from a run that bounds nothing."""
    kept = Path(os.environ.get("THERCON_CONVERGED", folder))
    name = f"{re.sub('[^a-z0-9]+', '_', deck.name.lower())}_{level}_{part}.npz"
    if not (kept / name).exists():
        with h5py.File(run(deck, level, part, folder, False)) as file:
            face = file[f"contact/{deck.face}"]
            found = {q: face[q][:] for q in QUANTITIES if q in face}
            np.savez(kept / name, time=file["history/time"][:],
                     peak_pressure=face["pressure"][:].max(axis=1), **found)
    with np.load(kept / name) as found:
        rows = [int(np.argmin(np.abs(found["time"] - time))) for time in times]
        return {q: found[q][rows] for q in QUANTITIES if q in found}


def converged_values(deck, times, folder):
    """Return the converged quantities at times."""
    fine = values_of(deck, FINE, 4 if deck.has_path else 1, times, folder)
    if deck.has_path:
        shorter, longer = (values_of(deck, 1, part, times, folder) for part in (16, 4))
        fine = {q: fine[q] + (shorter[q] - longer[q]) for q in fine}
    return fine


def judged(deck, folder, levels=LEVELS, parts=PARTS, told=None):
    """Return the cases of a deck; edges that are the ends of the interface are not judged. The
    converged values are those told, by step and quantity, or found."""
    cases = []
    for level in levels:
        for part in parts:
            with h5py.File(run(deck, level, part, folder)) as file:
                times = file["errors/time"][:]
                exact = told or converged_values(deck, times, folder)
                last = file[f"contact/{deck.face}/s"][-1]
                for quantity, rows in file[f"errors/{deck.face}"].items():
                    if quantity not in exact:
                        continue
                    for step, row in enumerate(rows[:], 1):
                        value, true = row[0], exact[quantity][step - 1]
                        is_end = quantity.startswith("edge") and value >= last * (1 - 1e-6)
                        if is_end or not abs(true - value) > LEAST * abs(true):
                            continue
                        cases.append(Case(deck.name, deck.is_fitted, level, part, step, quantity, true,
                                          true - value, row[1]))
    return cases


def judged_with_same_increments(deck, folder, levels=LEVELS):
    """Return the cases of a deck as written, with the values of the finer mesh with the same increments
    as the converged ones."""
    with h5py.File(run(deck, 0, 1, folder)) as file:
        times = file["errors/time"][:]
    return judged(deck, folder, levels, (1,), values_of(deck, FINE, 1, times, folder))
