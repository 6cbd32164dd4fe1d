"""docs/stability.md from runs: tables of cases at the extremes, each with its figures and a verdict.

A theme is a file test_<theme>.py here, with TITLE, TEXT and a function tables(folder), which runs
its cases in a folder and returns their tables (see tests/documents/document.py).
`python tests/stability/report.py` with THERCON set runs all themes, or those named, and writes the
document. Each theme's test runs it again, or a part of a long one, and fails if a verdict fails or
if the document differs. Figures may differ in their digits.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), *(str(HERE.parent / n) for n in ("documents", "decks", "reference"))]

from document import Document, Picture, Table, verdict  # noqa: E402, F401  its folder is made known first

PREFACE = """# Stability at the extremes

How the program behaves where methods may fail. Every case below passes, or is refused with a clear
message.

| section | cases | result |
|---|---|---|
| [Fixed point of the conductance](#fixed-point-of-the-conductance) | rods with known solutions, 10,000 random ones, laws that jump, the cylinder and its strongly coupled twin | NEWTON solves all of them; the other methods fail in 5 to 13 % |
| [Contact](#contact) | random blocks with friction up to 10, cycles, shakedown, thin strips that only contact holds | no run ends early, contact conditions are met to 1e-10 |
| [Values at the extremes](#values-at-the-extremes) | conductances and conductivities over 30 decades, lengths over 60, friction up to 10, slender elements | closed forms are met; what rounding would spoil is refused |
| [Invariance](#invariance) | other units, positions, numbers, exchanged faces | the same results to 1e-11 |
| [Time steps](#time-steps) | friction along paths, schemes of (3.4) | the orders of theory; straight paths are exact |
| [Stored heat](#stored-heat) | orders in time, long and short increments, rods with three steady states | the orders of theory; steady states in the limit; a course never ends in the unstable state if increments resolve its growth |
| [States in time](#states-in-time) | \\*STABILITY on rods with one and three states, a sliding face, the cylinder and its twin, maps over load and conductance | growth rates and periods of dense eigenvalues and closed forms to 1e-3, critical speed to 1e-3; no number of growing motions is wrong; the cylinder and its twin last |
| [Branches](#branches) | \\*CONTINUATION on rods that turn smoothly and in corners, a twin of the cylinder with a hysteresis | folds to 1e-6 of the load; the upper fold of the twin converges with order 2, the lower one does not: contact points close one by one |

In the tables a verdict is `pass`, or `refused` where the program says clearly that it cannot solve
the case. The script `tests/stability/report.py` writes this document from runs of the program; the
tests `stability_*` repeat them, the longest ones in part.
"""
DOCUMENT = Document("stability.md", HERE, ("fixed_point", "contact", "extremes", "invariance",
                                           "time_steps", "stored_heat", "modes", "hysteresis"),
                    PREFACE)
check, check_parts, check_rows = DOCUMENT.check, DOCUMENT.check_parts, DOCUMENT.check_rows

if __name__ == "__main__":
    DOCUMENT.write(sys.argv[1:])
