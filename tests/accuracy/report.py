"""docs/accuracy.md from runs: what accuracy costs, and how accurate results are.

A theme is a file test_<theme>.py here, with TITLE, TEXT and a function tables(folder), which runs
its cases in a folder and returns tables, pictures and text (see tests/documents/document.py).
`python tests/accuracy/report.py` with THERCON set runs all themes and writes the document;
`python tests/accuracy/report.py cylinder` renews that section alone. Some themes take long: their
tests run a part of them, and compare it with what the document tells.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), *(str(HERE.parent / n) for n in ("documents", "decks", "reference"))]

from document import Document, Picture, Table, lines_of, verdict  # noqa: E402, F401

PREFACE = """# Accuracy, and what it costs

How accurate results are, what more accuracy costs, and how another program compares. The script
`tests/accuracy/report.py` writes this document from runs of the program; the tests `accuracy_*`
repeat a part of them.
"""
DOCUMENT = Document("accuracy.md", HERE, ("estimate", "requested", "pairing", "recovered", "trade",
                                          "cylinder", "needed", "calculix"), PREFACE)
check, check_parts, rows = DOCUMENT.check, DOCUMENT.check_parts, DOCUMENT.rows
check_rows = DOCUMENT.check_rows

if __name__ == "__main__":
    DOCUMENT.write(sys.argv[1:])
