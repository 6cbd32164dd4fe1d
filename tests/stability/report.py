"""docs/stability.md from runs: tables of cases at the extremes, each with its figures and a verdict.

A theme is a file test_<theme>.py here, with TITLE, TEXT and a function tables(folder), which runs
its cases in a folder and returns their tables (see tests/documents/document.py).
`python tests/stability/report.py` with THERCON set runs all themes, or those named, and writes the
document and build/documents/stability.md. Each theme's test runs it again, or a part of a long one,
and fails if a verdict fails or if the document differs. Figures may differ in their digits.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), *(str(HERE.parent / n) for n in ("documents", "decks", "reference"))]

from document import Document, Picture, Table, verdict  # noqa: E402, F401  its folder is made known first

PREFACE = """# Stability at the extremes

How the program behaves where methods may fail. Every case passes, or is refused with a clear
message.

`tests/stability/report.py` runs all cases, with `THERCON` set to the program, and writes this page
and `build/documents/stability.md`, which has every table in full. In the tables a verdict is `pass`, or
`refused` where the program says clearly that it cannot solve the case. The tests `stability_*`
repeat the cases, the longest ones in part.
"""
DOCUMENT = Document("stability.md", HERE, ("fixed_point", "contact", "extremes", "invariance",
                                           "time_steps", "stored_heat", "modes", "hysteresis"),
                    PREFACE)
check, check_parts, check_rows = DOCUMENT.check, DOCUMENT.check_parts, DOCUMENT.check_rows

if __name__ == "__main__":
    DOCUMENT.write(sys.argv[1:])
