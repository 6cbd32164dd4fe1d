"""docs/stability.md from runs: tables of cases at the extremes, each with its figures and a verdict.

A theme is a file test_<theme>.py here, with TITLE, TEXT and a function tables(folder), which runs
its cases in a folder and returns their tables. `python tests/stability/report.py` with THERCON set
runs all themes and writes the document; each theme's test runs it again, and fails where a verdict
does or where the document tells something else. Figures may differ in their digits.
"""

import importlib
import re
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
DOCUMENT = HERE.parents[1] / "docs" / "stability.md"
sys.path[:0] = [str(HERE), str(HERE.parent / "decks"), str(HERE.parent / "reference")]

THEMES = ("fixed_point", "contact", "extremes", "invariance", "time_steps")
PREFACE = """# Stability at the extremes

Where methods break: cases with their figures and a verdict, `pass` or `refused` where the program says clearly that
it cannot. The document is written by `python tests/stability/report.py` from runs of the program; the tests
`stability_*` run them all again.
"""


@dataclass
class Table:
    """A table of the document; a verdict is a cell that says pass, refused or FAIL."""

    title: str
    head: list[str]
    rows: list[list] = field(default_factory=list)
    text: str = ""

    def markdown(self):
        """Return the lines of the table."""
        lines = [f"### {self.title}", "", *([self.text, ""] if self.text else [])]
        lines += ["| " + " | ".join(self.head) + " |", "|" + "---|" * len(self.head)]
        return lines + ["| " + " | ".join(map(shown, row)) + " |" for row in self.rows] + [""]


def shown(cell):
    """Return a cell's text; numbers with three digits."""
    return f"{cell:.3g}" if isinstance(cell, float) else str(cell)


def verdict(holds):
    """Return the verdict on a case that must come out right."""
    return "pass" if holds else "FAIL"


def section(theme, tables):
    """Return the lines of a theme."""
    lines = [f"## {theme.TITLE}", "", theme.TEXT.strip(), ""]
    for table in tables:
        lines += table.markdown()
    return lines


def masked(lines):
    """Return the text of lines without the digits of its numbers."""
    number = r"(?<![\w.])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?"
    return re.sub(number, "#", "\n".join(lines))


def check(theme, folder):
    """Assert that all cases of a theme hold, and that the document tells the same of them."""
    tables = theme.tables(folder)
    failed = [row for table in tables for row in table.rows if "FAIL" in map(str, row)]
    assert not failed, f"these cases fail: {failed}"
    document = masked(DOCUMENT.read_text().splitlines())
    for table in tables:
        text = masked(table.markdown()).strip()
        assert text in document, f"docs/stability.md tells something else than\n{text}"


def write_document():
    """Run all themes and write the document."""
    lines = PREFACE.splitlines() + [""]
    for name in THEMES:
        if not (HERE / f"test_{name}.py").exists():
            continue
        theme = importlib.import_module(f"test_{name}")
        with tempfile.TemporaryDirectory() as folder:
            lines += section(theme, theme.tables(Path(folder)))
    DOCUMENT.write_text("\n".join(lines).rstrip() + "\n")


if __name__ == "__main__":
    write_document()
