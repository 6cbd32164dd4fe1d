"""The pages of docs/tutorial and the README, read as a user does: decks are saved, commands and Python are
run in the order of the page, and what the page tells of their output must be in it."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted((ROOT / "docs" / "tutorial").glob("*.md"))
README = ROOT / "README.md"
PACKAGES = ROOT / "python"
PROGRAMS = {"thercon": [os.environ.get("THERCON", "thercon")],
            "thercon-plot": [sys.executable, str(ROOT / "post" / "plot")]}
# A deck to save, cards to add, a command, and what it prints.
PARTS = re.compile(r"Save this as\s+`(?P<save>[\w.]+)`[^`]*```\n(?P<deck>.*?)```"
                   r"|[Aa]dd this to\s+`(?P<add>[\w.]+)`[^`]*```\n(?P<cards>.*?)```"
                   r"|^    (?P<command>thercon\S* [^\n]*)$"
                   r"|^```python\n(?P<python>.*?)```"
                   r"|^```text\n(?P<output>.*?)```", re.M | re.S)
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:E[-+]\d+)?(?![\w.])")
SAME = 0.02    # of a number: rounding moves uncertainties
VALUE = 0.001  # of a number with five digits and more, which is a value


def run(command, folder):
    """Run a command in a folder; return what it prints."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300,
                          env=os.environ | {"PYTHONPATH": str(PACKAGES)})
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def alike(told, found):
    """Return whether a line that a page tells is a line of an output, or its beginning."""
    told, found = " ".join(told.split()), " ".join(found.split())
    if not re.match(re.escape(NUMBER.sub("#", told)), NUMBER.sub("#", found)):
        return False
    return all(abs(float(one) - float(other)) <= allowed(one) * abs(float(one))
               for one, other in zip(NUMBER.findall(told), NUMBER.findall(found), strict=False))


def allowed(number):
    """Return by which part a number that a page tells may differ."""
    return VALUE if len(re.sub(r"E.*|\D", "", number).lstrip("0")) >= 5 else SAME


def follow(page, folder):
    """Do what a page says; return how many lines of output it told."""
    printed, told = "", 0
    for part in PARTS.finditer(page.read_text()):
        if part["save"]:
            (folder / part["save"]).write_text(part["deck"])
        elif part["add"]:
            with (folder / part["add"]).open("a") as deck:
                deck.write(part["cards"])
        elif part["command"]:
            program, *arguments = part["command"].split()
            printed = run([*PROGRAMS[program], *arguments], folder)
        elif part["python"]:
            printed = run([sys.executable, "-c", part["python"]], folder)
        else:
            for line in part["output"].splitlines():
                assert any(alike(line, found) for found in printed.splitlines()), (line, printed)
                told += 1
    return told


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_runs_as_it_is_written(page, tmp_path):
    assert follow(page, tmp_path) >= 5


def test_the_readme_runs_as_it_is_written(tmp_path):
    follow(README, tmp_path)


def test_another_number_or_word_is_seen():
    assert alike("peak pressure 118.8 +- 1.4", "    peak pressure    118.9 +- 1.4 (1.2 %)")
    assert not alike("von Mises stress 276.166 +- 3.8", "von Mises stress 273.407 +- 3.8 (1.4 %)")
    assert not alike("peak pressure 108.8", "    peak pressure    118.9 +- 1.4 (1.2 %)")
    assert not alike("peak force 118.9", "    peak pressure    118.9")
