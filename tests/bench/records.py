"""Runs on record: their cases, costs and values, and how far the values are from the limit.

`runs.csv` has all runs, `limit.csv` those of thercon on fine meshes that the limit is made of.
"""

import csv
from dataclasses import dataclass, fields
from pathlib import Path

import decks
import numpy as np
from decks import Case

HERE = Path(__file__).resolve().parent
RUNS, LIMIT = HERE / "runs.csv", HERE / "limit.csv"
QUANTITIES = ("normal_force", "heat_rate", "shear_force", "edge_contact")
OTHER_EDGES = ("edge_of_both", "edge_of_corners")   # of CalculiX, whose best one counts
KEYS = [field.name for field in fields(Case)]
HEAD = [*KEYS, "cpu", "memory", *(f"{name}@{load:g}" for name in (*QUANTITIES, *OTHER_EDGES)
                                  for load in decks.LOADS)]


@dataclass(frozen=True)
class Record:
    """A run: CPU seconds, memory [MB], and values, a row a quantity; failed ones have none."""

    case: Case
    cpu: float = np.nan
    memory: float = np.nan
    values: np.ndarray | None = None

    @property
    def failed(self):
        """Return whether the program gave up."""
        return self.values is None


def read(path=RUNS):
    """Return the runs of a file."""
    found = []
    with open(path) as file:
        for row in csv.DictReader(file):
            case = Case(**{f.name: f.type(row[f.name]) for f in fields(Case)})
            if not row["cpu"]:
                found.append(Record(case))
                continue
            values = [float(row[name]) for name in HEAD[len(KEYS) + 2:] if row[name]]
            found.append(Record(case, float(row["cpu"]), float(row["memory"]),
                                np.array(values).reshape(-1, len(decks.LOADS))))
    return found


def write(records, path=RUNS):
    """Write runs to a file."""
    with open(path, "w") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(HEAD)
        for one in records:
            figures = [] if one.failed else [f"{one.cpu:.4g}", f"{one.memory:.1f}",
                                             *(f"{v:.7g}" for v in one.values.ravel())]
            row = [*(getattr(one.case, key) for key in KEYS), *figures]
            out.writerow(row + [""] * (len(HEAD) - len(row)))


def limit():
    """Return the limit that both programs go to, a row a quantity, and the relative scatter of the
    runs that it is made of: the mean of fine meshes in few increments. Friction alone needs many;
    it is that of the run with most, and its scatter is what the last doubling of increments and
    elements changed."""
    runs = read(LIMIT)
    few = min(run.case.each for run in runs)
    fine = np.array([run.values for run in runs if run.case.each == few])
    half, most = sorted((run for run in runs if run.case.each > few),
                        key=lambda run: run.case.each)[-2:]
    mean, scatter = fine.mean(axis=0), fine.std(axis=0) / fine.mean(axis=0)
    friction = QUANTITIES.index("shear_force")
    mean[friction] = most.values[friction]
    scatter[friction] = np.abs(half.values[friction] / mean[friction] - 1)
    return mean, scatter


def errors(record, limit):
    """Return the relative errors, a row a quantity, of CalculiX with the best one of its edges."""
    off = np.abs(record.values / limit[[0, 1, 2] + [3] * (len(record.values) - 3)] - 1)
    off = np.nan_to_num(off, nan=np.inf)
    return np.vstack([off[:3], min(off[3:], key=np.max)])


def worst(record, limit):
    """Return the largest error, infinite where a run failed."""
    return np.inf if record.failed else float(errors(record, limit).max())
