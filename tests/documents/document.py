"""A document of docs/ that is written from runs: sections of themes, each with its tables.

A theme is a module with TITLE, TEXT and a function tables(folder), which runs its cases in a folder
and returns the parts of the section: tables, pictures, or text. Figures of the document may differ
in their digits from those of another run; everything else may not.
"""

import importlib
import re
import sys
import tempfile
import textwrap
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
PICTURES = DOCS / "pictures"
COLUMNS = 100


@dataclass
class Table:
    """A table of the document; a verdict is a cell that says pass, refused or FAIL."""

    title: str
    head: list[str]
    rows: list[list] = field(default_factory=list)
    text: str = ""

    def markdown(self):
        """Return the lines of the table."""
        lines = [f"### {self.title}", "", *wrapped(self.text)]
        lines += ["| " + " | ".join(self.head) + " |", "|" + "---|" * len(self.head)]
        return lines + ["| " + " | ".join(map(shown, row)) + " |" for row in self.rows] + [""]


@dataclass
class Picture:
    """A picture of the document; draw(path) draws it, only where the document is written."""

    file: str
    title: str
    draw: Callable

    def markdown(self):
        """Return the lines of the picture."""
        return [f"![{self.title}](pictures/{self.file})", ""]


def shown(cell):
    """Return a cell's text; numbers with three digits."""
    return f"{cell:.3g}" if isinstance(cell, float) else str(cell)


def verdict(holds):
    """Return the verdict on a case that must come out right."""
    return "pass" if holds else "FAIL"


def wrapped(text):
    """Return the lines of prose, wrapped, and an empty one; tables, headings, pictures and code
    stay as they are."""
    kept, paragraphs = r"[|#!]| {4}|$", []
    for line in text.strip().splitlines():
        if not paragraphs or re.match(kept + "|- ", line) or re.match(kept, paragraphs[-1]):
            paragraphs.append(line)
        else:
            paragraphs[-1] += " " + line.strip()
    lines = []
    for paragraph in paragraphs:
        # What would begin a list or a heading stays behind the word before it.
        bound = re.sub(r"(?<=\S) (?=([-+*#>]|\d+[.)]) )", "\0", paragraph)
        lines += [paragraph] if re.match(kept, paragraph) else textwrap.wrap(
            bound, COLUMNS, break_long_words=False, break_on_hyphens=False,
            subsequent_indent="  " * bound.startswith("- "))
    return [*(line.replace("\0", " ") for line in lines), ""] if lines else []


def lines_of(part):
    """Return the lines of a table, a picture or a text."""
    return wrapped(part) if isinstance(part, str) else part.markdown()


def masked(lines):
    """Return the words of lines without the digits of their numbers: where lines end depends on
    these."""
    number = r"(?<![\w.])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?"
    return re.sub(number, "#", " ".join(" ".join(lines).split()))


def check_verdicts(tables):
    """Assert that no verdict of tables fails."""
    failed = [row for table in tables for row in table.rows if "FAIL" in map(str, row)]
    assert not failed, f"these cases fail: {failed}"


@dataclass
class Document:
    """A file of docs/, the folder of its themes, their names in order, and what comes first."""

    file: str
    folder: Path
    themes: tuple[str, ...]
    preface: str

    @property
    def path(self):
        """Return the path of the document."""
        return DOCS / self.file

    def present(self):
        """Return the themes whose files are there, by their names and in their order."""
        return {name: importlib.import_module(f"test_{name}") for name in self.themes
                if (self.folder / f"test_{name}.py").exists()}

    def sections(self):
        """Return the lines of the sections of the document, by their titles."""
        found, lines = {}, []
        for line in self.path.read_text().splitlines() if self.path.exists() else ():
            if line.startswith("## "):
                lines = found.setdefault(line[3:], [])
            lines.append(line)
        return found

    def write(self, names=()):
        """Run the themes named, or all, and write their sections; the others stay as they are."""
        themes, sections = self.present(), self.sections()
        unknown = set(names) - themes.keys()
        if unknown:
            sys.exit(f"no theme {', '.join(sorted(unknown))}; there are {', '.join(themes)}")
        for name in names or themes:
            sections[themes[name].TITLE] = self.section(themes[name])
        lines = wrapped(self.preface)
        for theme in themes.values():
            lines += sections.get(theme.TITLE, [])
        self.path.write_text("\n".join(lines).rstrip() + "\n")

    def section(self, theme):
        """Run a theme, draw its pictures and return its lines."""
        lines = [f"## {theme.TITLE}", "", *wrapped(theme.TEXT)]
        with tempfile.TemporaryDirectory() as folder:
            for part in theme.tables(Path(folder)):
                lines += lines_of(part)
                if isinstance(part, Picture):
                    PICTURES.mkdir(exist_ok=True)
                    part.draw(PICTURES / part.file)
        return lines

    def check(self, theme, folder):
        """Assert that all cases of a theme hold, and that the document tells the same of them."""
        self.check_parts(theme.tables(folder))

    def check_parts(self, parts):
        """Assert that no verdict of these parts fails, and that the document tells the same."""
        check_verdicts(part for part in parts if isinstance(part, Table))
        document = masked(self.path.read_text().splitlines())
        for part in parts:
            text = masked(lines_of(part)).strip()
            assert text in document, f"docs/{self.file} tells something else than\n{text}"
            assert not isinstance(part, Picture) or (PICTURES / part.file).exists()

    def check_rows(self, tables):
        """Assert that no verdict of these tables fails, and that the document has their rows among
        those of the same table: for tests that run a part of the cases of a theme."""
        check_verdicts(tables)
        for table in tables:
            told = [masked(row.values()) for row in self.rows(table.title)]
            for row in table.rows:
                found = dict(zip(table.head, map(shown, row), strict=True))
                assert masked(found.values()) in told, f"docs/{self.file} does not tell {found}"

    def rows(self, title):
        """Return the rows of a table as the document has them: cells by the heads of the columns,
        for tests that run only a part of a theme and compare with what is told."""
        lines = self.path.read_text().splitlines()
        at = lines.index(f"### {title}")
        at += next(k for k, line in enumerate(lines[at:]) if line.startswith("|"))
        found = []
        for line in lines[at:]:
            if not line.startswith("|"):
                break
            found.append([cell.strip() for cell in line.strip("|").split("|")])
        return [dict(zip(found[0], row, strict=True)) for row in found[2:]]
