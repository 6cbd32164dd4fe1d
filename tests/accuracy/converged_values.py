"""Converged values of the decks of drawn_decks, and runs on other meshes with other increments.

The converged value of a quantity at the end of a step is that on a mesh refined four times at the
faces and twice elsewhere, with increments a quarter as long; what a sixteenth changes is added, from
the mesh refined once. Where the path does not matter, errors that fall steadily as the faces are
divided are extrapolated. The file converged.csv keeps these values, which take long:
`python tests/accuracy/converged_values.py DECK...` writes those of the decks named anew, or of all.
"""

import csv
import re
import sys
import tempfile
from pathlib import Path

import report  # noqa: F401  # isort: skip, it makes the modules below known
import h5py
import numpy as np
from drawn_decks import EXAMPLES, all_decks, mismatched_decks
from deck_runs import solve

QUANTITIES = {"normal_force": "normal force", "shear_force": "shear force", "heat_rate": "heat rate",
              "peak_pressure": "peak pressure", "edge_contact": "edge of contact",
              "edge_stick": "edge of stick"}
FINE = (2, 2)  # divisions of all elements, and beyond that of those at the faces
MOST = 0.7     # ratio of changes from mesh to mesh above which nothing is extrapolated
FILE = Path(__file__).resolve().parent / "converged.csv"
# Edges without a converged value, by deck, step and quantity: this one lies where elements become five times as long,
# and moves by 1.5 % from mesh to mesh.
UNSETTLED = {("ball 17", 1, "edge_contact")}
LEAST_EDGE = 0.01   # of the spacing of the contact points: errors that converged edges may have
ANALYSIS = re.compile(r"^(\*(?:STATIC|VISCO|COUPLED|HEAT).*\n)\s*([0-9.eE+-]+)", re.M | re.I)


def run(deck, level, part, folder, errors="LAST", checked=""):
    """Solve a deck with other elements and increments, and the errors of *OPTIONS; return the result file. The
    level is that of all elements, or a pair with the one of those at the faces beyond it.
    Cards of `checked` are added."""
    # The faces of node pairs are divided together, those of mortar points each for itself, those of rigid bodies not.
    rigid = re.findall(r"^\*RIGID BODY.*(?:SURFACE|ELSET)=(\w+)", deck.text, re.M)
    divided = [face for pair, faces in re.findall(r"^(\*CONTACT PAIR.*)\n(.+)", deck.text, re.M)
               for face in faces.split(", ")[:2 if "PAIRING=SURFACES" in pair else 1]
               if face.split(".")[0] not in rigid]
    everywhere, at_faces = level if isinstance(level, tuple) else (level, 0)
    cards = [f"*REFINE, LEVELS={everywhere}"] if everywhere else []
    cards += [f"*REFINE, LEVELS={at_faces}, SURFACE={face}" for face in divided if at_faces]
    cards.append(f"*OPTIONS, ERRORS={errors}")
    text = re.sub(r"^\*REFINE.*\n", "", deck.text.split("*VERIFY")[0], flags=re.M)
    text = re.sub(r"INC=\d+", "INC=100000", text)
    text = ANALYSIS.sub(lambda found: f"{found[1]}{float(found[2]) / part!r}", text)
    text = re.sub(r"^\*STEP", "\n".join([*cards, "*STEP"]), text, count=1, flags=re.M)
    text = re.sub(r"^(\*(?:NODE|EL|CONTACT) FILE)(, FREQUENCY=0)?", r"\1, FREQUENCY=0", text, flags=re.M)
    for mesh in EXAMPLES.glob("*.mesh"):
        (folder / mesh.name).write_text(mesh.read_text())
    path = folder / f"{re.sub('[^a-z0-9]+', '_', deck.name.lower())}_{everywhere}_{at_faces}_{part}.inp"
    path.write_text(text + checked)
    return solve(path, seconds=900)


def values_of(deck, level, part, times, folder):
    """Return the quantities at times, from a run without uncertainties."""
    with h5py.File(run(deck, level, part, folder, "NO")) as file:
        face = file[f"contact/{deck.face}"]
        found = {q: face[q][:] for q in QUANTITIES if q in face}
        found["peak_pressure"] = face["pressure"][:].max(axis=1)
        rows = [int(np.argmin(np.abs(file["history/time"][:] - time))) for time in times]
        return {q: values[rows] for q, values in found.items()}


def converged_values(deck, times, folder):
    """Return the converged quantities at times."""
    if deck.has_path:
        fine = values_of(deck, FINE, 4, times, folder)
        shorter, longer = (values_of(deck, 1, part, times, folder) for part in (16, 4))
        return {q: fine[q] + (shorter[q] - longer[q]) for q in fine}
    runs = [values_of(deck, (FINE[0], k), 1, times, folder) for k in range(FINE[1] + 1)]
    # Edges lie between nodes and scatter from mesh to mesh.
    left = {q: [0.0 if q.startswith("edge") else rest(*values)
                for values in zip(*(run[q] for run in runs), strict=True)] for q in runs[0]}
    return {q: runs[-1][q] + np.array(left[q]) for q in left}


def rest(first, second, third):
    """Return what is left of a series whose changes fall by a steady ratio, or 0."""
    ratio = (third - second) / (second - first) if second != first else 0.0
    return (third - second) * ratio / (1.0 - ratio) if 0.0 < ratio < MOST else 0.0


def told_values(deck):
    """Return the converged values of a deck that are kept, by quantity: one for each step."""
    with FILE.open(newline="") as file:
        steps = [row for row in csv.DictReader(file) if row["deck"] == deck.name]
    assert steps, f"{FILE.name} does not tell {deck.name}"
    return {q: [float(row[q]) for row in steps] for q in QUANTITIES if any(row[q] for row in steps)}


def renewed(deck, folder):
    """Return the rows of the file for a deck, one for each step."""
    with h5py.File(run(deck, 0, 1, folder, "LAST")) as file:
        times = file["uncertainty/time"][:]
    found = converged_values(deck, times, folder)
    for name, step, quantity in UNSETTLED:
        if name == deck.name:
            found[quantity][step - 1] = np.nan
    return [[deck.name, step + 1, *(f"{found[q][step]:.10g}" if q in found else "" for q in QUANTITIES)]
            for step in range(len(times))]


def write_file(names):
    """Write the file, with the decks named anew; with no name all."""
    with FILE.open(newline="") as file:
        kept = list(csv.reader(file))[1:]
    rows = [["deck", "step", *QUANTITIES]]
    for deck in all_decks() + mismatched_decks():
        with tempfile.TemporaryDirectory() as folder:
            old = [row for row in kept if row[0] == deck.name]
            rows += renewed(deck, Path(folder)) if not names or deck.name in names else old
    with FILE.open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    write_file(sys.argv[1:])
