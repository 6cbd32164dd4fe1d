"""post/report: no text of a result or its listing is ever read as HTML, nor runs as a script."""

import ast
import base64
import hashlib
import re
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

POST = Path(__file__).resolve().parents[2] / "post"
sys.path.insert(0, str(POST.parent / "python"))

from synthetic import write_result  # noqa: E402

from thercon.post.report.cli import main  # noqa: E402
from thercon.post.report.html import html, joined  # noqa: E402

REPORT = POST.parent / "python" / "thercon" / "post" / "report"
RUN = "document.documentElement.dataset.ran='yes'"


def payload(field, slash="/"):
    """Return a text that adds an element and runs a script wherever it is read as HTML."""
    return f"\"'><i data-p={field}><img src=x onerror={RUN}><{slash}script><script>{RUN}<{slash}script>&lt;"


def name(field):
    """Return such a text that can be the name of a file or dataset."""
    return payload(field, "")


LISTING = """SUMMARY
-------
   {outcome}, 15 increments, or see ENDED EARLY at the end

VERIFICATION
   531  ANALYTIC   <svg/onload=i()>x        <i data-p=where>       LAST  0.0000000E+00\
              -         -  1.00E-15 REL FAIL
        source: {source}
        failed: {failed}

REQUESTED ACCURACY
------------------
   - requested accuracy not reached after 1 round: {accuracy}
   - {contact} {quantity}    not met: uncertainty 2 %, target 1 % ({remark})

WARNINGS
--------
   - {warning}

DECK
----
       1  *HEADING
       2  {card}

ENDED EARLY
-----------
   {early}
"""
IN_LISTING = ("outcome", "source", "failed", "accuracy", "remark", "warning", "card", "early")
IN_RUN = ("unit_length", "unit_stress", "unit_power", "unit_temperature", "heading", "version",
          "solver", "modelled")
NAMED = ("contact", "quantity", "sum", "history", "file")
SHOWN = (*IN_LISTING, *IN_RUN, *NAMED, "label", "unit")


@pytest.fixture(scope="module")
def hostile(tmp_path_factory):
    """Return the page of a result all of whose texts try to run a script."""
    folder = tmp_path_factory.mktemp("hostile")
    path = folder / f"{name('file')}.vtkhdf"
    write_result(path, contacts=(name("contact"), "OTHER"), label=payload("label"))
    with h5py.File(path, "r+") as file:
        for key in IN_RUN:
            file["run"].attrs[key] = payload(key)
        file["run"].attrs["verify_failed"] = 1
        del file["deck"]
        file["deck"] = ["*HEADING", payload("card")]
        increments = np.arange(1.0, 16.0)
        contact = file["contact"][name("contact")]
        contact[name("sum")] = increments
        contact[name("sum")].attrs["unit"] = payload("unit")
        file["history"][name("history")] = increments
        group = file.create_group("accuracy")
        group.attrs["reached"], group.attrs["later_round_begun"] = 0, 0
        for key in ("cpu_seconds", "unknowns", "elements", "increments"):
            group[key] = [1]
        file["uncertainty/time"] = [15.0]
        judged = group.create_group("uncertainty").create_group(name("contact"))
        judged[name("quantity")] = [[1.0, 5.0, 2.0, 0.1]]
    words = {key: payload(key) for key in IN_LISTING}
    words |= {key: name(key) for key in ("contact", "quantity")}
    path.with_suffix(".lst").write_text(LISTING.format(**words))
    assert main([str(path), "--out", str(folder)]) == 0
    return path.with_suffix(".html")


def test_no_text_becomes_an_element_or_runs(hostile, browser):
    browser.open(hostile)
    for key in ("home", "right", "end"):
        browser.press("#load", key)
        found = browser.run("""return {
            ran: document.documentElement.dataset.ran || '',
            made: document.querySelectorAll('[data-p], img, [onerror], [onload]').length,
            drawn: document.querySelectorAll('#zones path').length}""")
        assert found["ran"] == "" and found["made"] == 0 and found["drawn"] > 0
    assert browser.messages() == []


def test_every_text_is_shown_as_it_is(hostile, browser):
    """On the page, or in the name of a picture."""
    browser.open(hostile)
    browser.run("const of = document.getElementById('quantity'); of.value = '0';"
                "of.dispatchEvent(new Event('input'))")  # the temperature
    seen = browser.run("""return document.title + document.body.innerText +
        [...document.querySelectorAll('svg text, option, pre')].map(e => e.textContent).join(' ') +
        [...document.querySelectorAll('[aria-label]')].map(e => e.getAttribute('aria-label'))""")
    for field in SHOWN:
        assert f"<i data-p={field}><img src=x onerror={RUN}>".lower() in seen.lower(), field
    assert "<svg/onload=i()>x" in seen and "<i data-p=where>" in seen


def test_the_policy_stops_a_script_that_is_in_the_page_all_the_same(hostile, browser):
    """The page itself still works, and is one file."""
    text = hostile.read_text()
    bad = hostile.with_name("bad.html")
    bad.write_text(text.replace("<main>", f"<main><img src=x onerror={RUN}><script>{RUN}</script>"
                                          f"<a id=bad href=\"javascript:{RUN}\">x</a>"))
    browser.open(bad)
    browser.press("#load", "home")
    browser.run("document.getElementById('bad').click()")
    assert browser.run("return document.documentElement.dataset.ran || ''") == ""
    assert browser.run("return document.getElementById('now').textContent").startswith("1 of 15")
    assert sum("Content Security Policy" in each for each in browser.messages()) >= 2


def test_the_policy_allows_the_script_of_the_page_alone(hostile):
    text = hostile.read_text()
    policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', text)[1]
    rules = dict(rule.strip().split(" ", 1) for rule in policy.replace("&#x27;", "'").split(";"))
    (script,) = re.findall(r"<script>(.*?)</script>", text, re.S)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert rules["script-src"] == f"'sha256-{digest}'"
    assert rules["default-src"] == rules["base-uri"] == rules["form-action"] == "'none'"


def test_html_escapes_all_that_is_no_html():
    assert html("<b>{}</b>", "<&\"'") == "<b>&lt;&amp;&quot;&#x27;</b>"
    assert html("{x}", x=html("<i>{}</i>", 1)) == "<i>1</i>"
    assert joined(["<", html("<br>")], " ") == "&lt; <br>"
    assert html("{}", str(html("<br>")) + "") == "&lt;br&gt;", "text that was put together is text"
    assert html("{}", "a\udcff\x00b") == "a\ufffd\ufffdb", "a page has no such characters"


def calls_of(tree, function):
    """Return the calls of a function in a syntax tree."""
    return [node for node in ast.walk(tree) if isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name) and node.func.id == function]


@pytest.mark.parametrize("path", sorted(REPORT.glob("*.py")), ids=lambda path: path.name)
def test_only_one_module_makes_html_out_of_text(path):
    """Forms are written in the source; no other string holds a tag with something put into it."""
    tree = ast.parse(path.read_text())
    for call in calls_of(tree, "html"):
        assert isinstance(call.args[0], (ast.Constant, ast.Name)), ast.unparse(call)
    if path.name == "html.py":
        return
    assert not calls_of(tree, "Html") and "import escape" not in path.read_text()
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            assert not re.search(r"<[/a-z!]", ast.unparse(node)), ast.unparse(node)


def test_the_scripts_put_html_onto_the_page_in_one_place():
    script = "".join(path.read_text() for path in sorted(REPORT.glob("*.js")))
    assert script.count("innerHTML") == script.count("new Markup(") == 1
    assert not re.search(r"outerHTML|insertAdjacentHTML|document\.write|\beval\b|new Function", script)
    bare = re.findall(r"(?<!html)`[^`]*<[/a-z]", script)
    assert not bare
