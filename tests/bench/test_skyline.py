"""The theme of the skyline solver beside LAPACK."""

import os
import subprocess
from pathlib import Path

import report  # isort: skip, it makes the modules below known
from document import Table

TITLE = "Skyline and LAPACK"
TEXT = """
The skyline factors uniform bands of 12,000 equations, 100 to 800 wide, in 1.15 to 1.17 times the
time of LAPACK's `dpbtrf`, and the pivots of both agree to 1e-10.
"""
IN_DOCUMENT = []
ROOT = Path(__file__).resolve().parents[2]
SOURCES = ("src/core/kinds.f90", "src/linalg/blas_lapack.f90", "src/linalg/column_panels.f90",
           "tests/bench/skyline.f90")


def band_times(folder, equations):
    """Return bandwidth, seconds of dpbtrf and of the skyline, and their ratio, a row a band."""
    program = folder / "skyline"
    subprocess.run(["gfortran", "-O3", "-std=f2008", "-o", program, *(ROOT / s for s in SOURCES),
                    "-llapack", "-lblas"], cwd=folder, check=True)
    said = subprocess.run([program, str(equations)], capture_output=True, text=True, check=True,
                          env=dict(os.environ, OPENBLAS_NUM_THREADS="1")).stdout
    rows = [line.split() for line in said.splitlines()[1:]]
    return [[int(row[0]), *map(float, row[1:])] for row in rows]


def tables(folder):
    """Return the table of all bands."""
    return [Table("Factors of a uniform band",
                  ["bandwidth", "`dpbtrf` [s]", "skyline [s]", "ratio"],
                  band_times(folder, 12000))]


def test_bands_are_factored_and_timed(tmp_path):
    """The program compares the pivots itself."""
    assert [row[0] for row in band_times(tmp_path, 1000)] == [100, 200, 400, 800]
