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
OTHER_EDGE = "other_edge"   # of CalculiX, whose better one counts
KEYS = [field.name for field in fields(Case)]
HEAD = [*KEYS, "cpu", "memory", *(f"{name}@{load:g}" for name in (*QUANTITIES, OTHER_EDGE)
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
    """Return the limit that both programs go to, a row a quantity, and how far apart the runs that
    it is made of are. All is the mean of the finest meshes; friction, which alone needs many
    increments, also gets what ever more of them change on a middling mesh, and as much again."""
    runs = read(LIMIT)
    fine = np.array([run.values for run in runs if run.case.sides >= 100])
    middling = {run.case.each: run.values for run in runs if run.case.sides < 100}
    mean, most = fine.mean(axis=0), max(middling)
    coarse = next(run.case.each for run in runs if run.case.sides >= 100)
    friction = QUANTITIES.index("shear_force")
    more = 2 * middling[most] - middling[most // 2] - middling[coarse]
    mean[friction] += more[friction]
    return mean, fine.std(axis=0) / mean


def errors(record, limit):
    """Return the relative errors, a row a quantity, of CalculiX with the better one of its edges."""
    off = np.abs(record.values[:len(QUANTITIES)] / limit - 1)
    if len(record.values) > len(QUANTITIES):
        other = np.abs(record.values[-1] / limit[-1] - 1)
        if not other.max() > off[-1].max():
            off[-1] = other
    return np.nan_to_num(off, nan=np.inf)


def worst(record, limit):
    """Return the largest error, infinite where a run failed."""
    return np.inf if record.failed else float(errors(record, limit).max())
