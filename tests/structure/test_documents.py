"""The size of documents: what a reader has to go through, and what a table can show."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
MOST_LINES = {"README.md": 110, "verification.md": 300, "accuracy.md": 300, "stability.md": 300,
              "performance.md": 300, "theory.md": 700}
MOST = 400        # lines of any other
ALL = 5500        # lines of all documents together
WIDTH = 100       # of prose
CELL = 200        # characters of a cell of a table


def named(path):
    return str(path.relative_to(ROOT))


def prose(text):
    """Return the lines outside of code."""
    return re.sub(r"^```.*?^```", "", text, flags=re.S | re.M).splitlines()


def wide(text):
    """Return what is wider than a reader sees at once: cells of tables, lines of prose."""
    for line in prose(text):
        if line.startswith("|"):
            cells = re.split(r"(?<!\\)\|", line.strip("|"))
            yield from (cell for cell in cells if len(cell.strip()) > CELL)
        elif len(line) > WIDTH and not re.match(r" {4}|!?\[|#", line):
            yield line


@pytest.mark.parametrize("path", DOCUMENTS, ids=named)
def test_a_document_is_short_enough_to_be_read(path):
    lines = path.read_text().count("\n")
    assert lines <= MOST_LINES.get(path.name, MOST), f"{named(path)} has {lines} lines"


def test_all_documents_together_are_short_enough_to_be_read():
    lines = sum(path.read_text().count("\n") for path in DOCUMENTS)
    assert lines <= ALL, f"the documents have {lines} lines"


@pytest.mark.parametrize("path", DOCUMENTS, ids=named)
def test_no_cell_and_no_line_is_wider_than_a_page(path):
    assert not list(wide(path.read_text()))


def headless(text):
    """Return the first rows of tables that begin without a head."""
    blocks = re.split(r"\n{2,}", "\n".join(prose(text)))
    tables = [re.sub(r"^(?!\|).*\n", "", block, flags=re.M) for block in blocks if "\n|" in f"\n{block}"]
    return [table for table in tables if not re.match(r"\|.*\n\|[-|]+\|(\n|$)", table)]


@pytest.mark.parametrize("path", DOCUMENTS, ids=named)
def test_every_table_has_a_head(path):
    assert not headless(path.read_text())


def test_tables_that_a_line_divides_are_found():
    assert headless("| a |\n|---|\n| b |\n\n| c |\n") == ["| c |"]
    assert not headless("## \\*CARD\n| a |\n|---|\n| b |\n\nText\n")


def test_wide_cells_and_lines_are_found():
    assert list(wide(f"| a | {'b' * 201} |\n{'word ' * 21}\n")) == [f" {'b' * 201} ", "word " * 21]
    assert not list(wide(f"| {'a' * 150} | {'b' * 150} |\n```\n{'c' * 120}\n```\n"))


def test_running_has_every_reason_for_which_a_number_has_no_uncertainty():
    source = (ROOT / "src" / "model" / "no_estimates.f90").read_text()
    words = re.search(r":: words\(.*?\[(.*?)\]", source, re.S)[1]
    reasons = re.findall(r"'(.*?)'", words)
    text = (ROOT / "docs" / "running.md").read_text()
    assert len(reasons) > 10
    assert [reason for reason in reasons if f"`{reason}`" not in text] == []
