"""Runs of both programs: what they cost and what they find."""

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import decks
import h5py
import numpy as np

QUANTITIES = ("normal_force", "heat_rate", "shear_force", "edge_contact")
SECONDS = 3600


@dataclass(frozen=True)
class Cost:
    """CPU seconds, user and system, and peak memory [MB]."""

    cpu: float
    memory: float


# Runs a command and writes its cost and exit status to a file. A small process does this, because
# memory and the end of the process that starts a program count as the program's.
LAUNCHER = """
import os, resource, sys
resource.setrlimit(resource.RLIMIT_CPU, (int(sys.argv[1]),) * 2)
_, status, usage = os.wait4(os.posix_spawnp(sys.argv[2], sys.argv[2:], os.environ), 0)
with open("cost", "w") as file:
    print(usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, status, file=file)
"""


def measured(command, folder, seconds=SECONDS):
    """Run a command in a folder; return its cost, None where it failed or took too long."""
    with open(folder / "said", "w") as said:
        subprocess.run(
            [sys.executable, "-I", "-S", "-c", LAUNCHER, str(seconds), *command], cwd=folder,
            stdout=said, stderr=subprocess.STDOUT, check=True,
            env=dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1"))
    cpu, memory, status = map(float, (folder / "cost").read_text().split())
    return Cost(cpu, memory) if status == 0 else None


def thercon_values(result):
    """Return the quantities at the five loads, a row a quantity."""
    with h5py.File(result) as file:
        loads = file["history/load"][()]
        at = [int(np.argmin(np.abs(loads - load))) for load in decks.LOADS]
        assert np.abs(loads[at] - decks.LOADS).max() < 1e-6
        face = file["contact/FACE"]
        values = np.array([face[name][()][at] for name in QUANTITIES])
    return np.abs(values)


def edge_of_gap(x, gap, every=1):
    """Return the zero of the line through gap^(2/3) of the second and third open node, or of the
    parabola through those of the second to fourth open corner, which are every second node."""
    if not (gap <= 0.0).any():
        return np.nan
    last = np.flatnonzero(gap <= 0.0)[-1]
    nodes = np.arange(last + 1, len(gap))
    nodes = nodes[nodes % every == 0][1:3 + (every > 1)]
    if len(nodes) < 2 + (every > 1):
        return np.nan
    return float(np.polyfit(gap[nodes] ** (2 / 3), x[nodes], len(nodes) - 1)[-1])


def edge_of_both(x, pressure, gap):
    """Return the edge by the formula of thercon: p^2 from inside and gap^(2/3) from outside go to
    zero, each between the last closed and the first open node; the edge is their mean."""
    k = np.flatnonzero(gap <= 0.0)[-1] if (gap <= 0.0).any() else len(gap)
    if k + 3 > len(gap) or k == 0:
        return np.nan
    inner, last = pressure[k - 1] ** 2, pressure[k] ** 2
    reach = (x[k] - x[k - 1]) * last / (inner - last) if inner > last else np.inf
    first, outer = gap[k + 1] ** (2 / 3), gap[k + 2] ** (2 / 3)
    back = (x[k + 2] - x[k + 1]) * first / (outer - first) if outer > first else np.inf
    return float(min(x[k] + reach, x[k + 1]) + max(x[k + 1] - back, x[k])) / 2


def blocks(text):
    """Return the tables of a .dat file: kind, set, time, rows."""
    found = []
    for line in text.splitlines():
        head = re.match(r"\s*(.+?) for set (\w+) and time\s+(\S+)", line)
        if head:
            found.append((head[1].split("(")[0].strip(), head[2], float(head[3]), []))
        elif line.strip() and found:
            found[-1][3].append([float(word) for word in line.split()])
    return found


def calculix_values(case, path):
    """Return the quantities at the five loads, a row a quantity; the last rows are the edge by
    other formulas."""
    bodies = decks.bodies_of(case)
    faces = [list(body.nodes.items())[:decks.face_nodes(bodies[0])] for body in bodies]
    x = np.array([place[0] for _, place in faces[0]])
    start = np.array([a[1][1] - b[1][1] for a, b in zip(*faces, strict=True)])
    rows = {(kind, name, round(instant)): table
            for kind, name, instant, table in blocks(path.read_text())}
    values = []
    for at in range(case.sections - 3, case.sections + 2):   # behind the first step, of period 1
        moved = {int(row[0]): row[2] for row in rows["displacements", "FACES", at]}
        gap = start + [moved[a[0]] - moved[b[0]] for a, b in zip(*faces, strict=True)]
        pressure = case.penalty * case.small * np.maximum(-gap, 0.0)
        values.append([-rows["total force", "TOP", at][0][1],
                       rows["total heat generation", "TOP", at][0][0],
                       rows["total force", "AXISCYLINDER", at][0][0],
                       edge_of_gap(x, gap), edge_of_both(x, pressure, gap),
                       edge_of_gap(x, gap, every=2)])
    return np.array(values).T


def solve(case, folder):
    """Solve a case in a folder of its own; return cost and values, None where it fails."""
    folder = Path(folder) / case.name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    write = decks.thercon_deck if case.program == "thercon" else decks.calculix_deck
    (folder / "deck.inp").write_text("\n".join(write(case)) + "\n")
    if case.program == "thercon":
        command = [os.environ.get("THERCON", "thercon"), "run", "--quiet", "deck.inp"]
    else:
        command = ["ccx", "deck"]
    cost = measured(command, folder)
    if cost is None:
        return None
    if case.program == "thercon":
        return cost, thercon_values(folder / "deck.vtkhdf")
    return cost, calculix_values(case, folder / "deck.dat")
