"""docs/performance.md from runs: what runs cost, how that grows, and where the time goes.

A theme is a file test_<theme>.py here, with TITLE, TEXT and a function tables(folder), as in
tests/accuracy/report.py. `python tests/bench/report.py` with THERCON set runs all themes and writes
the document; `python tests/bench/report.py tail` renews that section alone.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), *(str(HERE.parent / n) for n in ("documents", "decks", "accuracy"))]

from document import Document, Table  # noqa: E402, F401

PREFACE = """# Performance

The cost of a run, its growth with the mesh, and where the time goes. In short:

- The published cylinder takes about a tenth of a second. Error estimates and output take half of
  its instructions.
- Each uniform refinement multiplies the displacements by four, and the time by 2 to 6: 142,336
  displacements take some 12 s and 0.6 GB, 567,296 about a minute and 2 GB. From the second
  refinement on MUMPS is the faster solver, and the program chooses it.
- Many interfaces between many bodies cost more than their number, but not its cube: 160 pellets in
  a tube take 2.1 times as long as 80, and 360 2.4 times as long as 160.
- Contact iterations factor only the columns of the contact again: below 2 % of the operations of a
  full factorisation.

**Processors newer than OpenBLAS.** On a processor that it does not know, OpenBLAS computes as for
one without AVX, and `thercon --version` ends with `OpenBLAS for Prescott`. Large models then take
up to twice as long. The variable `OPENBLAS_CORETYPE` of the environment names a known processor:
`SKYLAKEX` has AVX-512, `HASWELL` AVX2.

`./setup.sh bench performance` writes this page from runs, and every table to
`build/documents/performance.md`; with the names of sections (`skyline`, `tail`, `levels`, `rods`,
`paper`, `stability`) it renews these alone. Times are CPU seconds of one thread; those of another
machine, or of the same one on another day, differ. Operations and instructions do not.
"""
DOCUMENT = Document("performance.md", HERE, ("skyline", "tail", "levels", "rods", "paper", "stability"),
                    PREFACE)

if __name__ == "__main__":
    DOCUMENT.write(sys.argv[1:])
