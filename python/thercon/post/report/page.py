"""The page: what does not change with the load, around the script that draws the rest."""

from ..deck_changes import changed
from ..result import text
from . import tables
from .data import FINE, contacts_of, page_data
from .html import compressed, digest, html, joined, own
from .listing import read_listing

# Nothing on the page may ask for anything outside it, and no script but its own may run.
POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; script-src '{}'; img-src data:; "
    "base-uri 'none'; form-action 'none'"
)
PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<link rel="icon" href="data:,">
<title>{heading} – {name}, thercon</title>
<style>{styles}</style>
</head>
<body>
<a class="skip" href="#summary">Skip to the summary</a>
<header>
<h1>{heading}</h1>
<p>{file}, written by thercon {version}</p>
{changed}
<nav aria-label="Sections"><ul>{links}</ul></nav>
</header>
{bar}
<main>
<noscript><p class="note">The pictures need JavaScript; the tables do not.</p></noscript>
{body}
</main>
<script type="application/gzip" id="data">{data}</script>
<script>{script}</script>
</body>
</html>
"""
LARGE = 5e6  # bytes
SECTION = """<section id="{key}" aria-labelledby="{key}-title">
<h2 id="{key}-title">{title}</h2>
{content}
</section>"""
LINK = '<li><a href="#{key}">{title}</a></li>'


def page(result):
    """Return the whole page as text."""
    result.rows()  # without an increment there is nothing to show
    listing = read_listing(result.path.with_suffix(".lst"), result.deck)
    script, data = own("field.js", "page.js"), compressed(page_data(result))
    summary = [tables.facts(result, listing), tables.uncertainties(result),
               tables.stability(result, listing), tables.rounds(result, listing)]
    sections = [
        ("summary", "Summary", joined(summary)),
        *([("contact", "Contact", contact_section(result))] if result.contact_names else []),
        ("fields", "Fields", joined([html(FIELDS), large_words(data, result.cells)])),
        ("history", "History", html('<div id="histories" class="plots"></div>')),
        ("checks", "Checks", tables.checks(result, listing)),
        ("warnings", "Warnings", tables.warnings(result, listing)),
        ("deck", "Deck", tables.deck(result)),
    ]
    named = [dict(zip(("key", "title", "content"), section)) for section in sections]
    return html(
        PAGE,
        policy=POLICY.format(digest(script)),
        heading=run_text(result, "heading") or result.name,
        name=result.name,
        file=result.path.name,
        version=run_text(result, "version"),
        changed=html('<p class="note">{}.</p>', words) if (words := changed(result)) else "",
        styles=own("page.css"),
        links=joined(html(LINK, **each) for each in named),
        bar=load_bar(result),
        body=joined([html(SECTION, **each) for each in named], "\n"),
        data=data,
        script=script,
    )


def large_words(data, cells):
    """Return what the page of a fine mesh leaves out, and why it is large, where it is."""
    if cells.count <= FINE:
        return ""
    large = f" Even so it has {1e-6 * len(data):.0f} MB." if len(data) > LARGE else ""
    return html('<p class="note">The mesh has {} elements: to stay small, the page draws sides '
                "straight and has no principal, radial and hoop stress.{}</p>", cells.count, large)


def run_text(result, key):
    """Return an attribute of /run in words; nothing where it is not there."""
    return text(result.file["run"].attrs.get(key, ""))


def load_bar(result):
    """Return the slider that chooses the increment of all pictures: by its number, or by the time
    where heat is stored and times are real."""
    what, first, last, step = "Increment", "1", str(result.increments), "1"
    if "heat_stored" in result.history:
        first, last = (repr(float(result.history["time"][row])) for row in (0, -1))
        what, step = "Time", "any"
    return html("""<form id="bar" aria-label="Load of all pictures">
<label for="load">{what}</label>
<input type="range" id="load" min="{first}" max="{last}" step="{step}" value="{last}">
<output id="now" for="load"></output>
</form>
<p id="unjudged" class="note" aria-live="polite"></p>""", what=what, first=first, last=last, step=step)


def contact_section(result):
    """Return the frame of the pictures of a contact."""
    options = [html('<option value="{}">{}</option>', k, contact.name)
               for k, contact in enumerate(contacts_of(result))]
    return html("""<p class="choice"><label for="interface">Interface</label> <select id="interface">\
{options}</select> <label><input type="checkbox" id="same"> same scale at every load</label></p>
<div id="totals" aria-live="polite"></div>
<div class="plots">
<figure id="zones"></figure>
<figure id="faces"></figure>
<figure id="tractions"></figure>
<figure id="flux"></figure>
<figure id="gap"></figure>
<figure id="wear"></figure>
</div>""", options=joined(options))


FIELDS = """<form class="choice" aria-label="What the field shows">
<label>Quantity <select id="quantity"></select></label>
<label>Show <select id="region"><option value="model">whole model</option>
<option value="near">contact</option></select></label>
<label>Displacements × <input type="number" id="scale" min="0" step="any" value="1"></label>
<span><label>Colours from <input type="number" id="low" step="any"></label>
<label>to <input type="number" id="high" step="any"></label></span>
<label><input type="checkbox" id="fixed"> same colours at all loads</label>
<label><input type="checkbox" id="apart"> colours for each body</label>
</form>
<p id="field-note" class="note"></p>
<figure id="field">
<div id="panel"><canvas aria-hidden="true"></canvas><div id="lines"></div></div>
<div id="bars"></div>
<figcaption id="range" aria-live="polite"></figcaption>
</figure>"""
