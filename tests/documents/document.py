"""A document of docs/ that is written from runs: sections of themes, each with its tables.

A theme is a module with TITLE, TEXT and a function tables(folder), which runs its cases in a folder
and returns the parts of the section: tables, pictures, or text. The document has those that the
theme lists as IN_DOCUMENT, by their titles, or that its brief(parts) returns, or all of them. The
complete section, with DETAILS of the theme after its TEXT, is written to build/documents. Figures
may differ in their digits from those of another run; everything else may not.
"""

import importlib
import os
import re
import sys
import tempfile
import textwrap
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import chain, takewhile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
COMPLETE = ROOT / "build" / "documents"
PICTURES = DOCS / "pictures"
COLUMNS = 100


@dataclass
class Table:
    """A table of the document; a verdict is a cell that says pass, refused or FAIL. A table without
    a heading of its own has the title of its section."""

    title: str
    head: list[str]
    rows: list[list] = field(default_factory=list)
    text: str = ""
    heading: bool = True

    def markdown(self):
        """Return the lines of the table."""
        lines = [f"### {self.title}", ""] * self.heading + wrapped(self.text)
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


def in_document(theme, parts):
    """Return the parts of a theme that the document has."""
    if hasattr(theme, "brief"):
        return theme.brief(parts)
    titles = getattr(theme, "IN_DOCUMENT", None)
    if titles is None:
        return parts
    kept = [part for part in parts if getattr(part, "title", None) in titles]
    assert len(kept) == len(titles), f"{theme.TITLE}: IN_DOCUMENT names parts that it has not"
    return kept


def rows_of(text, title):
    """Return the rows of a table in a text: cells by the heads of the columns."""
    lines = text.splitlines()
    at = next(k for k, line in enumerate(lines) if line in (f"## {title}", f"### {title}"))
    at += next(k for k, line in enumerate(lines[at:]) if line.startswith("|"))
    found = [[cell.strip() for cell in line.strip("|").split("|")]
             for line in takewhile(lambda line: line.startswith("|"), lines[at:])]
    return [dict(zip(found[0], row, strict=True)) for row in found[2:]]


def is_in(text, part):
    """Return whether a text has a table or a picture; prose must be in all of them."""
    names = ([part.file] if isinstance(part, Picture) else
             [f"\n## {part.title}\n", f"\n### {part.title}\n"] if isinstance(part, Table) else [""])
    return any(name in text for name in names)


def sections_of(path):
    """Return the lines of the sections of a file, by their titles."""
    found, lines = {}, []
    for line in path.read_text().splitlines() if path.exists() else ():
        if line.startswith("## "):
            lines = found.setdefault(line[3:], [])
        lines.append(line)
    return {title: [*"\n".join(lines).rstrip().splitlines(), ""] for title, lines in found.items()}


@dataclass
class Document:
    """A file of docs/, the folder of its themes, their names in order, and what comes first.

    Where runs take hours, the complete sections are on record in a file of the folder instead of
    build/documents, and tests compare with it.
    """

    file: str
    folder: Path
    themes: tuple[str, ...]
    preface: str
    record: str = ""

    @property
    def path(self):
        """Return the path of the document."""
        return DOCS / self.file

    @property
    def complete(self):
        """Return the path of the complete sections."""
        return self.folder / self.record if self.record else COMPLETE / self.file

    def texts(self):
        """Return what tests compare with: the document, and what is on record."""
        return [path.read_text() for path in (self.path, self.complete) if path == self.path or self.record]

    def present(self):
        """Return the themes whose files are there, by their names and in their order."""
        return {name: importlib.import_module(f"test_{name}") for name in self.themes
                if (self.folder / f"test_{name}.py").exists()}

    def write(self, names=()):
        """Run the themes named, or all, and write their sections; the others stay as they are."""
        themes = self.present()
        unknown = set(names) - themes.keys()
        if unknown:
            sys.exit(f"no theme {', '.join(sorted(unknown))}; there are {', '.join(themes)}")
        brief, complete = sections_of(self.path), sections_of(self.complete)
        for name in names or themes:
            theme = themes[name]
            brief[theme.TITLE], complete[theme.TITLE] = self.sections(theme, self.parts(theme))
        title = self.preface.split("\n", 1)[0]
        self.save(self.path, self.preface, brief)
        self.save(self.complete, f"{title}: complete tables\n\ndocs/{self.file} is the short form.",
                  complete)

    def save(self, path, preface, sections):
        """Write the sections that there are, in the order of the themes."""
        lines = wrapped(preface)
        for theme in self.present().values():
            lines += sections.get(theme.TITLE, [])
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines).rstrip() + "\n")

    @staticmethod
    def parts(theme):
        """Run a theme, draw its pictures and return its parts."""
        with tempfile.TemporaryDirectory() as folder:
            parts = theme.tables(Path(folder))
            for part in parts:
                if isinstance(part, Picture):
                    PICTURES.mkdir(exist_ok=True)
                    part.draw(PICTURES / part.file)
        return parts

    def sections(self, theme, parts):
        """Return the lines of the section of the document, and of the complete one."""
        head = [f"## {theme.TITLE}", "", *wrapped(theme.TEXT)]
        brief = chain(head, *map(lines_of, in_document(theme, parts)))
        details = wrapped(getattr(theme, "DETAILS", ""))
        place = os.path.relpath(DOCS, self.complete.parent)
        complete = [re.sub(r"\]\((?=[\w./]+\.(md|png))", f"]({place}/", line)
                    for line in chain(head, details, *map(lines_of, parts))]
        return list(brief), complete

    def check(self, theme, folder):
        """Assert that all cases of a theme hold, and that the document tells the same of them."""
        self.check_parts([theme.TEXT, *theme.tables(folder)])

    def check_parts(self, parts):
        """Assert that no verdict of these parts fails, and that the document, and what is on
        record, tell the same of those that they have."""
        check_verdicts(part for part in parts if isinstance(part, Table))
        for document in self.texts():
            words = masked(re.sub(r"\]\((\.\./)+docs/", "](", document).splitlines())
            for part in parts:
                if not is_in(document, part):
                    continue
                text = masked(lines_of(part)).strip()
                assert text in words, f"docs/{self.file} tells something else than\n{text}"
                assert not isinstance(part, Picture) or (PICTURES / part.file).exists()

    def check_rows(self, tables):
        """Assert that no verdict of these tables fails, and that the document, and what is on
        record, have their rows among those of the same table, if they have the table: for tests
        that run a part of the cases of a theme."""
        check_verdicts(tables)
        for document in self.texts():
            for table in (table for table in tables if is_in(document, table)):
                told = [masked(row.values()) for row in rows_of(document, table.title)]
                for row in table.rows:
                    found = dict(zip(table.head, map(shown, row), strict=True))
                    assert masked(found.values()) in told, f"docs/{self.file} does not tell {found}"

    def rows(self, title):
        """Return the rows of a table as they are on record, or as the document has them, for tests
        that run only a part of a theme and compare with what is told."""
        return rows_of(self.complete.read_text() if self.record else self.path.read_text(), title)
