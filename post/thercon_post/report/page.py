"""The page: what does not change with the load, around the script that draws the rest."""

from html import escape
from pathlib import Path

from ..result import text
from . import tables
from .data import as_json, contacts_of
from .listing import read_listing

HERE = Path(__file__).parent
# Nothing on the page may ask for anything outside it.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"


def page(result):
    """Return the whole page as text."""
    result.rows()  # without an increment there is nothing to show
    listing = read_listing(result.path.with_suffix(".lst"), result.deck)
    heading = text(result.file["run"].attrs.get("heading", "")) or result.name
    sections = [
        ("summary", "Summary", tables.facts(result, listing) + tables.bounds(result)
         + tables.rounds(result, listing)),
        *([("contact", "Contact", contact_section(result))] if result.contact_names else []),
        ("fields", "Fields", FIELDS),
        ("history", "History", '<div id="histories" class="plots"></div>'),
        ("checks", "Checks", tables.checks(result, listing)),
        ("warnings", "Warnings", tables.warnings(result, listing)),
        ("deck", "Deck", tables.deck(result)),
    ]
    links = "".join(f'<li><a href="#{key}">{title}</a></li>' for key, title, _ in sections)
    body = "\n".join(
        f'<section id="{key}" aria-labelledby="{key}-title">\n<h2 id="{key}-title">{title}</h2>\n'
        f"{content}\n</section>"
        for key, title, content in sections
    )
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<link rel="icon" href="data:,">
<title>{escape(heading)} – {escape(result.name)}, thercon</title>
<style>
{own("page.css")}</style>
</head>
<body>
<a class="skip" href="#summary">Skip to the summary</a>
<header>
<h1>{escape(heading)}</h1>
<p>{escape(result.path.name)}, written by thercon {escape(run_text(result, "version"))}</p>
<nav aria-label="Sections"><ul>{links}</ul></nav>
</header>
{load_bar(result)}
<main>
<noscript><p class="note">The pictures need JavaScript; the tables do not.</p></noscript>
{body}
</main>
<script type="application/json" id="data">{as_json(result)}</script>
<script>
{own("field.js")}{own("page.js")}</script>
</body>
</html>
"""


def own(name):
    """Return a file that stands beside this one."""
    return (HERE / name).read_text(encoding="utf-8")


def run_text(result, key):
    """Return an attribute of /run in words; nothing where it is not there."""
    return text(result.file["run"].attrs.get(key, ""))


def load_bar(result):
    """Return the slider that chooses the increment of all pictures."""
    last = result.increments
    return f"""<form id="bar" aria-label="Load of all pictures">
<label for="load">Increment</label>
<input type="range" id="load" min="1" max="{last}" step="1" value="{last}">
<output id="now" for="load"></output>
</form>"""


def contact_section(result):
    """Return the frame of the pictures of a contact."""
    options = "".join(
        f'<option value="{k}">{escape(contact.name)}</option>'
        for k, contact in enumerate(contacts_of(result))
    )
    choice = f'<p class="choice"><label for="interface">Interface</label> <select id="interface">' \
             f"{options}</select> <label><input type=\"checkbox\" id=\"same\"> " \
             "same scale at every load</label></p>"
    return f"""{choice}
<div id="totals" aria-live="polite"></div>
<div class="plots">
<figure id="zones"></figure>
<figure id="tractions"></figure>
<figure id="flux"></figure>
<figure id="gap"></figure>
</div>"""


FIELDS = """<form class="choice" aria-label="What the field shows">
<label>Quantity <select id="quantity"></select></label>
<label>Show <select id="region"><option value="model">whole model</option>
<option value="near">contact</option></select></label>
<label>Displacements × <input type="number" id="scale" min="0" step="any" value="1"></label>
<label><input type="checkbox" id="fixed"> same colours at all loads</label>
</form>
<p id="field-note" class="note"></p>
<figure id="field">
<div id="panel"><canvas aria-hidden="true"></canvas><div id="lines"></div></div>
<div id="bars"></div>
<figcaption id="range" aria-live="polite"></figcaption>
</figure>"""
