"""Tables of the page that do not change with the load."""

import re

import numpy as np

from ..comparison.from_result import FIELDS
from ..result import ANALYSIS, NO_ANALYSIS, NO_FINER_VALUE, text, words_of
from ..units import unit_of
from .data import contacts_of, friction_heat, plain, told_totals
from .html import html, joined

FACTS = {  # attribute of /run -> words
    "modelled": "modelled",
    "solver": "solver",
    "equations_thermal": "unknown temperatures",
    "equations_mechanical": "unknown displacements",
    "contact_unknowns": "contact unknowns",
}


def table(caption, head, rows, numbers=()):
    """Return a table; the columns `numbers` of `rows` are set as numbers."""
    looks = [html(' class="number"') if k in numbers else "" for k in range(len(head))]
    top = joined(html('<th scope="col"{}>{}</th>', *each) for each in zip(looks, head))
    lines = []
    for row in rows:
        cells = [html('<th scope="row" data-head="{}">{}</th>', head[0], row[0])]
        cells += [html('<td{} data-head="{}">{}</td>', looks[k], head[k], cell)
                  for k, cell in enumerate(row[1:], 1)]
        lines.append(html("<tr>{}</tr>", joined(cells)))
    return html(
        '<div class="wide"><table><caption>{}</caption><thead><tr>{}</tr></thead>'
        "<tbody>{}</tbody></table></div>", caption, top, joined(lines)
    )


def facts(result, listing):
    """Return what the run was."""
    run, cells = result.file["run"].attrs, result.cells
    bodies = {int(b) for group in cells.bodies.values() for b in group}
    seconds = sum(float(run[key]) for key in run if key.startswith("seconds_"))
    rows = []
    if listing:
        told = ("outcome", listing.outcome), ("ended early", listing.ended_early)
        rows += [(name, words) for name, words in told if words]
    rows += [
        ("increments", result.increments),
        ("last increment", last_load(result)),
        ("checks", counts_of_checks(result)),
        ("mesh", f"{cells.count} elements, {len(np.unique(cells.node_id))} nodes, "
         f"{len(bodies)} bod{'y' if len(bodies) == 1 else 'ies'}"),
    ]
    rows += [(words, text(run[key])) for key, words in FACTS.items() if key in run]
    if result.accuracy:
        words = listing.accuracy[0] if listing and listing.accuracy else ""
        words = words.removeprefix("requested accuracy ")
        rows += [("requested accuracy", words or accuracy_words(result.accuracy))]
    spent = f"{seconds:.2f} s"
    if result.accuracy:
        cpu = result.accuracy["cpu_seconds"]
        spent += f" in round {len(cpu)}; all rounds took {sum(cpu):.2f} CPU seconds"
    rows += [("time without uncertainties", spent)]
    listed = joined(html("<div><dt>{}</dt><dd>{}</dd></div>", *row) for row in rows)
    return html('<dl class="facts">{}</dl>', listed)


def counts_of_checks(result):
    """Return how many *VERIFY checks passed and failed; values of KIND=NONE do neither."""
    run = result.file["run"].attrs
    passed, failed = (int(run.get(f"verify_{key}", 0)) for key in ("passed", "failed"))
    if passed + failed:
        return f"{passed} passed, {failed} failed"
    is_judging = [not re.search(r"\bKIND *= *NONE\b", card) for card in result.verify_cards]
    without = "none judged" if any(is_judging) else "none: KIND=NONE asks for values alone"
    return without if is_judging else "none"


def last_load(result):
    """Return time and load of the last increment in words."""
    words = plain(result.units.time_value(result.history["time"][-1]))
    if result.load_label == "time":
        return words
    load = result.units.load_value(result.load_label, result.history["load"][-1])
    return f"{words}, {plain(load)}"


LARGEST = {"von_mises": "largest von Mises stress", "temperature": "largest temperature",
           "equivalent_plastic_strain": "largest plastic strain",
           "equivalent_creep_strain": "largest creep strain"}


def uncertainties(result):
    """Return what has numerical uncertainties at the last increment: the quantities of every
    interface, the largest values of every body and the heat of the model."""
    said, found = "at the last increment", []
    for contact in contacts_of(result):
        rows, known = [], result.uncertainties(contact.name)
        for key, values in told_totals(contact).items():
            value = float(values[-1])
            if np.isnan(value) or (key == "shear_force" and not value):
                continue
            cells = uncertainty_cells(*known[key][2:], contact.unit(key)) if key in known else None
            if contact.is_end_of_face(key, value):
                cells = ["none: end of the face", contact.unit(key), *NO_PARTS]
            cells = cells or [no_estimate(result.reason_of(key)), contact.unit(key), *NO_PARTS]
            rows.append([words_of(key) + (", s" if key.startswith("edge_") else ""), number(value), *cells])
        found.append(uncertainty_table(f"Interface {contact.name} {said}", known, rows))
    found = [folded(found, f"{len(found)} interfaces {said}")] if len(found) > MOST_OPEN else found
    largest = f"{said}, stress away from singular corners"
    bodies = [values_table(f"{capital(result.label_of_body(name))} {largest}", known)
              for name, known in result.maxima.items()]
    bodies = list(filter(None, bodies))
    found += [folded(bodies, f"{len(bodies)} bodies {said}")] if len(bodies) > MOST_OPEN else bodies
    return joined([*found, heat_of_model(result, f"Heat of the model {said}")])


def heat_of_model(result, caption):
    """Return the table of the heat of the model: without uncertainties that of friction alone."""
    known = result.uncertainties("increment")
    why = no_estimate("needs ERRORS=FULL")
    rows = [[each["label"], number(each["values"][-1]), why, each["unit"], *NO_PARTS]
            for each in friction_heat(result) if each["values"][-1]]
    return uncertainty_table(caption, known, rows) if rows and not known else values_table(caption, known)


def capital(words):
    """Return words that begin with a capital letter."""
    return words[0].upper() + words[1:]


def values_table(caption, known):
    """Return the table of what is known at the last increment; nothing where that is nothing."""
    rows = [[LARGEST.get(key, words_of(key)), number(each[-1, 0]), *uncertainty_cells(each, why, unit_of(unit))]
            for key, (unit, _, each, why) in known.items() if np.nan_to_num(each[-1, 0])]
    return uncertainty_table(caption, known, rows) if rows else ""


NO_PARTS = "–", "–", "–"
MOST_OPEN = 6  # tables of interfaces, or of bodies; more are folded, so that pictures are near


def folded(parts, words):
    """Return parts of the page behind words that open them."""
    return html("<details><summary>{}</summary>{}</details>", words, joined(parts))


def uncertainty_table(caption, known, rows):
    """Return a table of values and their uncertainties, with the parts that the file names."""
    _, columns, *_ = next(iter(known.values()), ("", ["", "", "change", "scatter", "iteration"]))
    parts = [f"by {part}" for part in columns[2:]]
    head = ["quantity", "value", "uncertainty (95 %)", "unit", *parts]
    return table(caption, head, rows, (1, 2, 4, 5, 6))


def uncertainty_cells(rows, why, unit):
    """Return uncertainty or why there is none, unit and the parts of it."""
    value, uncertainty, *parts = rows[-1]
    words = no_estimate(why)
    if np.isfinite(uncertainty):
        share = f" ({number(100.0 * uncertainty / abs(value), 2)} %)" if value else ""
        words = f"± {number(uncertainty, 2)}{share}"
    return [words, unit, *(number(part, 2) for part in parts)]


def no_estimate(why):
    """Return what stands in place of an uncertainty, with the reason where there is one."""
    return f"no estimate: {why}" if why else "no estimate"


def stability(result, listing):
    """Return the analyses of stability: the leading mode of each state. Whether an answer is uncertain
    is in the listing alone."""
    found = result.stability
    if found is None:
        return ""
    if not len(found["time"]):
        return html("<p>Stability in time: {}.</p>", NO_ANALYSIS)
    rows = []
    for time, modes, rate, period in zip(*(found[key] for key in ANALYSIS)):
        row = int(np.argmin(np.abs(result.history["time"] - time)))
        said = listing.stability.get(row + 1, "–") if listing else "–"
        lasts = "neither grows nor decays" if rate == 0.0 else "–"
        if rate > 0.0:
            lasts = f"doubles in {number(np.log(2.0) / rate, 4)}"
        elif rate < 0.0:
            lasts = f"falls to 1/e in {number(-1.0 / rate, 4)}"
        swing = "none" if period == 0.0 else number(period, 4)
        growing = "–" if np.isnan(rate) else round(modes)
        known = "–" if np.isnan(rate) else no_estimate(NO_FINER_VALUE)
        rows.append([number(time), said, growing, number(rate, 4), known, lasts, swing])
    unit = result.units.names.get("time")
    rate = "growth rate of the leading mode" + (f" (1/{unit})" if unit else "")
    head = ["time", "state", "growing modes", rate, "uncertainty (95 %)", "which",
            "period of its oscillation"]
    told = table("Stability in time", head, rows, (2, 3))
    return told if listing else joined([told, missing(result)])


def accuracy_words(group):
    """Return whether a requested accuracy is reached, after how many rounds."""
    count = len(group["unknowns"])
    words = f"{'' if group['reached'] else 'not '}reached after {count} round"
    words += "" if count == 1 else "s"
    return words + (f"; round {count + 1} was begun" if group["later_round_begun"] else "")


def rounds(result, listing):
    """Return the rounds of a requested accuracy: what each cost, and its uncertainties."""
    group = result.accuracy
    if group is None:
        return ""
    named = [(contact.name, words_of(key), contact.unit(key), rows)
             for contact in contacts_of(result)
             for key, rows in group["uncertainty"].get(contact.name, {}).items()]
    costs = [group[key] for key in ("unknowns", "elements", "increments")]
    found = [[k + 1, *(each[k] for each in costs), f"{seconds:.2f}"]
             for k, seconds in enumerate(group["cpu_seconds"])]
    head = ["round", "unknowns", "elements", "increments", "CPU seconds"]
    told = table("Rounds of the requested accuracy", head, found, range(1, 5))
    head = ["interface", "quantity", *(f"round {k + 1}" for k in range(len(found))), "target",
            "unit", "verdict"]
    said = listing.accuracy if listing else []
    rows = [[name, words, *target_cells(each, unit, remark(said, f"{name} {words}"))]
            for name, words, unit, each in named]
    return joined([told, table("Uncertainties (95 %) of each round against their targets", head,
                               rows, range(2, len(found) + 3))])


def remark(said, target):
    """Return what the listing says of a target: step and reason of one that is not met, or what there
    is where it has nothing to judge."""
    words = re.compile(re.escape(target) + r" +(?:not met: .*, target .*?(?=, step | \(|: |$)"
                       r"|nothing to judge)(.*)$")
    return next((found[1] for found in map(words.match, said) if found), "")


def target_cells(rows, unit, remark):
    """Return the uncertainties of all rounds, target, unit and verdict of the last one."""
    step, _, found, allowed = rows[-1]
    digits = 2  # or as many as show that it is above the target
    while found > allowed and digits < 6 and number(found, digits) == number(allowed, digits):
        digits += 1
    cells = ["–" if each[0] == 0 else "no estimate" if np.isnan(each[2]) else number(each[2], digits)
             for each in rows]
    if step == 0:
        return [*cells, "–", unit, f"nothing to judge{remark}"]
    verdict = "met" if found <= allowed else "not met"
    look = "pass" if found <= allowed else "fail"
    told = html('<span class="{}">{}</span>{}', look, verdict, remark)
    return [*cells, number(allowed, digits), unit, told]


def number(value, digits=6):
    """Return a number in words; a dash where there is none."""
    return "–" if np.isnan(value) else f"{float(f'{value:.{digits}g}'):.6g}".replace("-", "−")


def missing(result):
    """Return the note where the listing of the run is not beside its result."""
    return html('<p class="note">They are in the listing of the run, but {} beside the result is '
                "missing, incomplete or of another deck.</p>", result.path.with_suffix(".lst").name)


def checks(result, listing):
    """Return the verdicts of the *VERIFY cards."""
    words = counts_of_checks(result)
    if words == "none":
        return html("<p>The deck has no *VERIFY checks.</p>")
    told = html("<p>{}.</p>", capital(words))
    if listing is None:
        return joined([told, missing(result)])
    if not listing.checks:  # the listing is that of a later round, or of a run that was broken off
        earlier = html("<p>They were judged in round 1, on the deck as written.</p>")
        return joined([told, earlier if result.accuracy else ""])
    head = ["card", "quantity", "where", "time", "expected", "found", "uncertainty (95 %)", "unit",
            "deviation", "allowed", "verdict", "kind and source"]
    rows = []
    for check in sorted(listing.checks, key=lambda each: each.verdict != "FAIL"):
        source = f"{check.kind}: {check.source}" if check.source else check.kind
        said = check.verdict.replace("-", "–")  # those of KIND=NONE pass in listings of earlier versions
        said = "–" if (check.kind, said) == ("NONE", "PASS") else said
        verdict = f"– {check.failed}".rstrip() if said == "–" else html(
            '<span class="{}">{}</span> {}', said.lower(), said, check.failed)
        known = f"± {check.uncertainty}" if check.uncertainty else ""
        known = known if check.no_estimate is None else no_estimate(check.no_estimate)
        where = f"{check.where} (node {check.node})" if check.node else check.where
        allowed = check.allowed if check.allowed == "-" else f"{check.allowed} {check.measure}"
        cells = (check.card, check.quantity, where, check.time, check.expected, check.found, known,
                 unit_of_check(result, check.quantity), check.deviation, allowed, verdict, source)
        rows.append(["–" if cell == "-" else cell for cell in cells])
    numbers = {"time", "expected", "found", "uncertainty (95 %)", "deviation", "allowed"}
    told_columns = [k for k in range(len(head)) if any(row[k] not in ("", "–") for row in rows)]
    head = [head[k] for k in told_columns]
    return joined([told, table("*VERIFY checks, failed ones first", head,
                               [[row[k] for k in told_columns] for row in rows],
                               [k for k, name in enumerate(head) if name in numbers])])


def unit_of_check(result, quantity):
    """Return the unit of a quantity of *VERIFY; nothing where it has none, or none that the file tells."""
    if " reaches " in quantity:
        return result.units.names.get("time", "")
    name, _ = FIELDS.get(quantity.upper(), (quantity, None))
    contacts = (result.file["contact"][contact] for contact in result.contact_names)
    for group in (result.file["history"], *contacts, result.file.get("VTKHDF/PointData", {})):
        if name in group:
            return unit_of(text(group[name].attrs.get("unit", "")))
    return plain(result.units.names.get({"RFL": "power"}.get(quantity, "force"), "")) \
        if re.match("RF[123L]$", quantity) else ""


def warnings(result, listing):
    """Return the warnings of the run."""
    if listing is None:
        return missing(result)
    if not listing.warnings:
        return html("<p>No warnings.</p>")
    items = joined(html("<li>{}</li>", words) for words in listing.warnings)
    return html('<ul class="warnings">{}</ul>', items)


def deck(result):
    """Return the card images with their numbers."""
    width = len(str(len(result.deck)))
    cards = "\n".join(f"{k:{width}}  {card}" for k, card in enumerate(result.deck, 1))
    return html('<details><summary>{} cards</summary><pre tabindex="0" aria-label="Deck">{}</pre>'
                "</details>", len(result.deck), cards)
