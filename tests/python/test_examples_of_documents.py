"""The examples of docs/python.md and of the docstrings do what they say."""

import contextlib
import doctest
import io
import re

import numpy as np
import pytest
import thercon
import thercon.results
import thercon.runs
from first_deck import ROOT, heat_rate

BLOCK = re.compile(r"```python\n(.*?)```\n(?:\n((?:    [^\n]*\n)+))?", re.S)


def blocks(document):
    """Return the blocks of code of a document with what they are said to print."""
    return BLOCK.findall((ROOT / "docs" / document).read_text())


def run_block(code, space):
    """Run a block; return what it prints."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(code, "<document>", "exec"), space)
    return printed.getvalue()


def test_the_examples_print_what_the_document_says(joint):
    space = {}
    for code, said in blocks("python.md"):
        assert run_block(code, space) == re.sub("^    ", "", said, flags=re.M)
    pressure, factor, found = space["table"][["pressure", "factor", "heat_rate JOINT"]].to_numpy().T
    assert found == pytest.approx(heat_rate(pressure, factor), rel=1e-9)
    assert heat_rate(np.array(space["pressures"]), 2e-4, 0.95) == pytest.approx(
        space["measured"], abs=5e-4)


@pytest.mark.parametrize("module", [thercon, thercon.runs, thercon.results])
def test_the_examples_of_the_docstrings(joint, module):
    thercon.run("joint.inp", out="results")
    space = {"thercon": thercon, "result": thercon.open("results/joint")}
    failed, tried = doctest.testmod(module, extraglobs=space)
    assert failed == 0 and tried > 3
