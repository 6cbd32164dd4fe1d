"""docs/accuracy.md from runs: what accuracy costs, and how accurate results are.

A theme is a file test_<theme>.py here, with TITLE, TEXT and a function tables(folder), which runs
its cases in a folder and returns tables, pictures and text (see tests/documents/document.py).
`python tests/accuracy/report.py` with THERCON set runs all themes and writes the document;
`python tests/accuracy/report.py cylinder` renews that section alone. Some themes take long: their
tests run a part of them, and compare it with complete.md, which has all tables on record. The values that true errors
refer to are in converged.csv and judged.csv, which converged_values.py and judged_decks.py write.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), *(str(HERE.parent / n) for n in ("documents", "decks", "reference"))]

from document import Document, Picture, Table, lines_of, verdict  # noqa: E402, F401

PREFACE = """# Accuracy, and what it costs

How accurate results are, what more accuracy costs, and how another program compares.

| question | answer | section |
|---|---|---|
| How accurate is my run? | Its summary has an uncertainty (95 %) for each force, heat rate, peak pressure and edge, and the largest stress and temperature of each body | [Numerical uncertainty](#numerical-uncertainty) |
| Which numbers have none? | Under the default, `ERRORS=LAST`, what errors build up in along the path; `ERRORS=FULL` gives them at four to six times the cost | [Numerical uncertainty](#numerical-uncertainty) |
| How often do they hold? | For 96 to 100 % of the decks and each kind of number, largest stresses 13 of 14; against independent solutions for 95 to 100 % | [Uncertainties judged](#uncertainties-judged-on-decks-drawn-afterwards) |
| Where bodies yield or creep? | With `ERRORS=FULL` for 98 % of all numbers | [Uncertainties of bodies that yield or creep](#uncertainties-of-bodies-that-yield-or-creep) |
| How accurate are the largest stress and temperature? | Their uncertainties are in the summary, away from singular corners, which are named | [Largest stress and temperature](#largest-stress-and-temperature) |
| How do I get 1 %? | `thercon run DECK --accuracy 1%`; most decks take one to three rounds, with friction at least two | [Accuracy on request](#accuracy-on-request) |
| Node pairs or mortar points? | Keep the default, but use `PAIRING=SURFACES` on the faces of a crack whose force or heat counts | [Node pairs against mortar points](#node-pairs-against-mortar-points) |
| Where is the mesh too coarse? | Where `stress_error` and `heat_flux_error` are large: both are true to about 20 % | [Estimated error of the mesh](#estimated-error-of-the-mesh) |
| What should I spend time on? | On the mesh, at the contact faces first. Shorter increments help only the edge of stick | [Speed for accuracy](#speed-for-accuracy-measured) |
| How accurate is the published cylinder? | On the mesh of the paper, from 60 C on: force 0.4 %, heat rate 2.1 %, peak pressure 3 %, edge of contact 0.15 cm, edge of stick 0.3 cm | [The published cylinder](#the-published-cylinder-with-uncertainty) |
| Do I pay for physics that is off? | No: below 1 % of the instructions | [Only what is needed](#only-what-is-needed) |
| How does CalculiX compare? | At equal error it takes 25 to 160 times as much CPU time | [Against CalculiX](#against-calculix-at-equal-error) |

`tests/accuracy/report.py` writes this page from runs, some of which take hours, and every table to
`tests/accuracy/complete.md`; the tests `accuracy_*` repeat a part of the runs and compare.
"""
THEMES = ("estimate", "judged", "judged_inelastic", "maxima", "wavy", "new", "requested", "pairing",
          "recovered", "trade", "cylinder", "needed", "calculix")
DOCUMENT = Document("accuracy.md", HERE, THEMES, PREFACE, record="complete.md")
check, check_parts, rows = DOCUMENT.check, DOCUMENT.check_parts, DOCUMENT.rows
check_rows = DOCUMENT.check_rows

if __name__ == "__main__":
    DOCUMENT.write(sys.argv[1:])
