"""What a requested accuracy gives and costs: known and drawn decks, against converged values."""

import re
import resource
from dataclasses import dataclass, replace

import converged_values
import h5py
import numpy as np
from deck_runs import COUPLED, CYLINDER, HERTZ, INPUT, run
from drawn_decks import EXAMPLES, all_decks, drawn_deck, mismatched_decks
from judged_decks import LEAST
from report import Table, check_parts, rows
from test_estimate import converged

TITLE = "Accuracy on request"
TEXT = """
`thercon run DECK --accuracy P%` solves in rounds until the uncertainties of normal force, heat rate,
peak pressure and edge of contact are within P per cent ([\\*ACCURACY](deck/method.md#accuracy) has the
rules). Each round solves the deck from its beginning on a mesh refined where it errs most. True
errors are those to the converged values, CPU seconds those of all rounds. "By hand" is the cheapest
of six meshes whose true error is inside the target; choosing it takes the converged values. Requests
of 1 % on 32 drawn decks were all reached, with true errors of at most 0.41 % and 97 to 100 % of the uncertainties right.
"""
DETAILS = """
`thercon run DECK --accuracy P%` solves in rounds until the uncertainties of normal force, heat rate, peak
pressure and edge of contact are within P per cent ([\\*ACCURACY](deck/method.md#accuracy) has the rules, also where no
uncertainty can be given). Each round solves the deck from its beginning, with elements divided where the
recovered energy norm is large and round the edges of zones, the smaller the nearer. Of the peak pressure with
friction the last increment alone does not tell what builds up along the path: its uncertainty is at least that
which the change from the round before gives, so that there are two rounds at least.

True errors are those to the [converged values](#numerical-uncertainty), CPU seconds those of all rounds
together. All start from the deck's mesh without \\*REFINE. "By hand" is the cheapest of six meshes without
uncertainties whose true error is inside the target: that mesh refined uniformly (0 to 2 levels), at the contact
faces (1 or 2), or once and then there. Only who knows the converged values can choose it.
"""
IN_DOCUMENT = ["Targets, uncertainties and true errors"]
DRAWN = 16   # number of decks of each pairing
HEAD = ["deck", "target", "status", "rounds", "CPU s", "elements", "increments",
        "uncertainty/target", "true error/target", "by hand, CPU s", "mesh by hand"]
MESHES = {"x 1": (0, 0), "x 2": (1, 0), "x 4": (2, 0), "x 1:2": (0, 1), "x 1:4": (0, 2), "x 2:4": (1, 1)}
PERCENT = 3, 1
DECKS = {"cylinder": (CYLINDER, "FACE"), "coupled twin": (COUPLED, "FACE"), "Hertz": (HERTZ, "FACE"),
         "press fit": (INPUT / "examples" / "press_fit.inp", "SEAT"),
         "roller": (INPUT / "examples" / "roller.inp", "LINE")}
TITLES = {"normal_force": "normal force", "heat_rate": "heat rate", "peak_pressure": "peak pressure",
          "edge_contact": "edge of contact"}


def unrefined(name, folder):
    """Copy the meshes of a deck to a folder; return its text without refinement and checks."""
    deck, _ = DECKS[name]
    for mesh in (*deck.parent.glob("*.mesh"), *deck.parent.glob("*.gmsh")):
        (folder / mesh.name).write_text(mesh.read_text())
    return re.sub(r"^\*REFINE.*\n", "", deck.read_text().split("*VERIFY")[0], flags=re.M)


def refined(name, everywhere, at_faces, folder):
    """Run a deck on a mesh refined by hand; return its CPU seconds and its largest relative true error."""
    deck, face = DECKS[name]
    text = unrefined(name, folder)
    surface = re.search(rf"^\*CONTACT PAIR,.*{face}.*\n\s*([\w.]+)", text, re.M)[1]
    cards = [f"*REFINE, LEVELS={everywhere}"] if everywhere else []
    cards += [f"*REFINE, LEVELS={at_faces}, SURFACE={surface}"] if at_faces else []
    cards += ["*OPTIONS, ERRORS=NO"]
    path = folder / f"{deck.stem}_refined.inp"
    path.write_text(re.sub(r"^\*STEP", "\n".join([*cards, "*STEP"]), text, count=1, flags=re.M))
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    process = run("run", "--quiet", path, "--out", folder, seconds=900)
    assert process.returncode == 0, process.stderr
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    exact = {q: converged(name)[q] for q in TITLES if q in converged(name)}
    with h5py.File(folder / f"{deck.stem}_refined.vtkhdf") as file:
        group = file[f"contact/{face}"]
        found = {q: group["pressure"][-1].max() if q == "peak_pressure" else group[q][-1] for q in exact}
    return (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
            max(abs(found[q] / exact[q] - 1.0) for q in exact))


def by_hand(name, folder):
    """Return CPU seconds, true error and name of the meshes refined by hand, the cheapest first."""
    found = []
    for mesh, levels in MESHES.items():
        seconds, error = refined(name, *levels, folder)
        found.append((seconds, error, mesh))
    return sorted(found)


@dataclass(frozen=True)
class Request:
    """What a request found: exit status, CPU seconds of all rounds, elements and increments of the last,
    the largest uncertainty and true error over the target, and of each uncertainty whether it holds."""

    status: int
    seconds: list
    elements: int
    increments: int
    uncertainty: float
    error: float
    held: list


def request(text, face, exact, percent, path):
    """Ask for an accuracy; the converged values are those of all steps, and none of some decks."""
    path.write_text(text)
    process = run("run", "--quiet", path, "--out", path.parent, "--accuracy", f"{percent}%", seconds=900)
    told, errors, held = [], [], []
    with h5py.File(path.with_suffix(".vtkhdf")) as file:
        group = file["accuracy"]
        for quantity, found in group[f"uncertainty/{face}"].items():
            step, value, uncertainty, allowed = found[-1]
            if step == 0:
                continue
            told.append(uncertainty / allowed)
            if quantity in exact and np.isfinite(exact[quantity][int(step) - 1]):
                error = abs(value - exact[quantity][int(step) - 1])
                errors.append(error / allowed)
                if np.isfinite(uncertainty):
                    held.append(error <= max(uncertainty, LEAST * abs(value)))
        return Request(process.returncode, list(group["cpu_seconds"][:]), group["elements"][-1],
                       group["increments"][-1], np.nanmax(told, initial=0.0), max(errors) if errors else np.nan, held)


def measured(name, percent, folder):
    """Return the cells of a deck and a target, without the meshes refined by hand."""
    deck, face = DECKS[name]
    exact = {} if name == "roller" else {q: [value] for q, value in converged(name).items()}
    found = request(unrefined(name, folder), face, exact, percent, folder / deck.name)
    return [name, f"{percent} %", found.status, len(found.seconds), f"{sum(found.seconds):.2f}",
            found.elements, found.increments, f"{found.uncertainty:.2f}",
            "-" if np.isnan(found.error) else f"{found.error:.2f}"]


def drawn_requests(folder):
    """Return the table of requests on the decks that chose the constants."""
    table = Table("Requests on drawn decks",
                  ["decks", "target", "number", "reached", "of these true errors inside the target",
                   "largest true error/target of these", "uncertainties that hold", "CPU s of all"],
                  text="""Those of [numerical uncertainty](#numerical-uncertainty). Uncertainties are those of the last
round at the step that decides.""")
    matching = [replace(deck, text=re.sub(r"^\*REFINE.*\n", "", deck.text.split("*VERIFY")[0], flags=re.M))
                for deck in all_decks()[:DRAWN]]
    others = mismatched_decks()[:DRAWN]
    for mesh in EXAMPLES.glob("*.mesh"):
        (folder / mesh.name).write_text(mesh.read_text())
    for name, decks, percent in (("node pairs", matching, 1), ("mortar points", others, 1)):
        found = [request(deck.text, deck.face, converged_values.told_values(deck), percent, folder / "deck.inp")
                 for deck in decks]
        errors = [one.error for one in found if one.status == 0]
        held = [is_held for one in found for is_held in one.held]
        table.rows.append([name, f"{percent} %", len(found), len(errors), sum(error <= 1.0 for error in errors),
                           f"{max(errors):.2f}", f"{sum(held)}/{len(held)}, {100 * sum(held) / len(held):.0f} %",
                           f"{sum(sum(one.seconds) for one in found):.0f}"])
    return table


def tables(folder):
    """Run all decks with all targets."""
    table = Table("Targets, uncertainties and true errors", HEAD, text="""Of the roller, whose faces do not match,
no converged value is known.""")
    for name in DECKS:
        meshes = by_hand(name, folder) if name != "roller" else []
        for percent in PERCENT:
            best = next((mesh for mesh in meshes if 100 * mesh[1] <= percent), None)
            table.rows.append([*measured(name, percent, folder),
                               *((f"{best[0]:.2f}", best[2]) if best else ("-", "-"))])
    return [table, drawn_requests(folder)]


def test_cheap_requests_hold_as_the_document_tells(tmp_path):
    """All requests that the document tells are reached, with true errors inside."""
    check_parts([TEXT])
    told = {(row["deck"], row["target"]): row for row in rows("Targets, uncertainties and true errors")}
    for row in told.values():
        assert row["status"] == "0" and float(row["uncertainty/target"]) <= 1.0
        assert row["true error/target"] == "-" or float(row["true error/target"]) < 1.0
    for name, percent in (("cylinder", 1), ("coupled twin", 3), ("press fit", 1)):
        found = dict(zip(HEAD, measured(name, percent, tmp_path), strict=False))
        row = told[name, f"{percent} %"]
        assert [str(found[head]) for head in ("status", "rounds")] == [row["status"], row["rounds"]]
        np.testing.assert_allclose(float(found["true error/target"]), float(row["true error/target"]),
                                   rtol=0.1, atol=0.01)


def test_a_pressure_on_the_axis_settles_where_elements_are_small(tmp_path):
    """Contact points beside an axis have little weight: what two meshes leave out of balance there shows
    in no energy, but in the peak pressure of a ball. No round would help."""
    deck = drawn_deck(17)
    exact = converged_values.told_values(deck)
    for percent in (1, 0.3):
        found = request(deck.text, deck.face, exact, percent, tmp_path / "ball.inp")
        assert found.status == 0 and found.uncertainty <= 1.0
