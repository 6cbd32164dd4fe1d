"""Bounds of errors against true ones: decks that are known and decks drawn at random, on three meshes
with two sizes of increments; and the converged values of five decks, which other themes use."""

import re
from dataclasses import dataclass
from pathlib import Path

import h5py
import held_bounds
import numpy as np
from bound_decks import FITTED, SEEDS, all_decks, drawn_deck, mismatched_deck, mismatched_decks
from deck_runs import COUPLED, CYLINDER, HERTZ, INPUT, solve
from instructions import profile
from program_parts import PARTS
from report import Table, check_parts, rows

TITLE = "Bounds of errors"
TEXT = """
Every run with contact bounds its errors at the end of each step: how far normal and shear force, heat
rate, peak pressure and the edges of contact and of stick may be from their exact values, to either
side. There is one bound for each quantity, made in `src/accuracy`; listing, summary, report page and
requests for an accuracy all use it. `/errors/<pair>/<quantity>` of the result file holds one row for
each step: value, bound, and the parts of the bound by mesh, increments and iteration.

- **Mesh.** The last increment of the step is corrected to what it would be if every element were
  divided into four; the finer mesh is never factored. The bound takes twice that change, as for errors
  that fall with h. The error at a single load is partly chance, because it changes its sign as the edge
  of contact passes a node. So how much the quantity scatters about a smooth course over the last nine
  increments is added, or over nine of every second one if that is more. In steps with fewer increments
  it is three times the change alone.
- **Friction.** The slip at which a node sticks as the contact grows over it is that of the present
  mesh. To the shear force 0.6 of the largest sum of stuck shear forces so far is added, times the
  spacing at the edge of contact over the length that is closed; to the peak pressure 0.15 of that, in
  proportion.
- **Edges.** 0.08 of the spacing of the contact points for the edge of contact and 0.9 for that of
  stick, with its scatter; 0.15 where both are one, and 0.25 for an edge that lies at a node itself;
  twice what halved elements move it by beyond that; and as large a part of the length that is closed as
  the mesh's part of the bound is of the force.
- **Increments.** Where friction or the scheme of (3.4) make the path matter, a companion run with
  increments of twice the size is solved in parallel on the contact points alone. The bound is the
  difference.
- **Iteration.** Residual of the fixed point over the distance of the coupling gain from 1.
- **Mortar points and ties.** With them the finer mesh is not relaxed but solved: only the elements
  at the faces are divided, so its factors take little, and the last increment of a step is solved
  there. That changes contact quantities as much as dividing all elements does, and counts three
  times. The spacing of friction and edges is that of the slave's nodes, and an edge of contact is
  taken to be four times as far off as that of node pairs. These two factors were chosen on decks of
  seeds below 20 with faces that do not match (`mismatched_deck`). The decks of seeds 20 to 51, the
  published cylinder with 30 sides on 22 and Hertz with 3 on 2 are kept aside. The same increments mean
  that true errors are those to a mesh refined four times at both faces, without the error of the
  increments; with shorter ones the drawn decks are judged as node pairs are. With the same increments
  only forces miss the goal of 95 %, with shorter ones all but heat rates and edges of contact.
- **Uncertain.** No bound is given with equations, couplings and transformed axes, because the finer
  mesh has nodes that they do not name, and for a single increment with friction. Listing and summary
  say *uncertain*, the result file NaN. At a corner, where one face ends and the other goes on, the
  pressure of a punch grows without limit as the mesh is refined: no error of it is finite. With mortar
  points a peak there is uncertain; with node pairs the bound is only large.

The constants were fitted to one part of the decks below; the others are kept aside and judge them.
Decks with a number have materials, friction, geometry and loads drawn at random
(`tests/accuracy/bound_decks.py`). The form of the bounds was found with both parts in view, except for
the decks from 16 on, which were run only when forms and constants stood. Each is solved on the mesh as it is and refined once and twice, with
the increments as written and half as long. A true error is that to the converged value: on a mesh
refined four times at the faces and twice elsewhere, with increments a quarter as long, and with what
increments a sixteenth as long change on the mesh refined once. Errors below 1e-7 of the value (forces
that the deck prescribes) and edges that are the ends of a face are not judged. The goals are 95 % that
hold, a median of bound over error of at most 4, and at most 10 % uncertain.

The recovered energy norm (`stress_error`, `heat_flux_error`) is no second estimate of these quantities:
it only tells where a requested accuracy divides elements. `thercon trade` keeps the extrapolation of
its rows, because its reference is uncertain in temperatures of all nodes and at times inside the steps,
for which there is no bound.
"""
QUANTITIES = {"normal_force": "normal force", "heat_rate": "heat rate",
              "peak_pressure": "peak pressure"}
EDGES = {"edge_contact": "edge of contact", "edge_stick": "edge of stick"}
UNITS = """Forces, heat rates, pressures and edges in MPa cm^2, W, MPa and cm for the cylinders, in MPa
mm^2, W, MPa and mm for Hertz, press fit and cracked plate; decks with a number have no
units. `-`: the deck does not have the quantity."""
MOST = 0.7  # ratio of changes from mesh to mesh above which nothing is extrapolated
FINEST_PARTS = 8
LATE = {drawn_deck(seed).name for seed in SEEDS if seed not in FITTED}
DECKS = {"chosen on": lambda case: case.is_fitted, "kept aside": lambda case: not case.is_fitted,
         "of these from 16 on": lambda case: case.deck in LATE, "all": lambda case: True}
MORTAR = {"drawn": lambda case: "mortar" in case.deck,
          "cylinder 30 to 22": lambda case: "cylinder" in case.deck,
          "Hertz 3 to 2": lambda case: "Hertz" in case.deck}
ANALYSIS = re.compile(r"^(\*(?:STATIC|COUPLED|HEAT).*\n)\s*([0-9.eE+-]+)", re.M | re.I)


@dataclass(frozen=True)
class Case:
    """A deck, its interface, and whether the path to the end of the load matters."""

    name: str
    deck: Path
    face: str
    has_path: bool = False


CASES = (Case("cylinder", CYLINDER, "FACE", True),
         Case("coupled twin", COUPLED, "FACE", True),
         Case("Hertz", HERTZ, "FACE"),
         Case("cracked plate", INPUT / "examples" / "cracked_plate.inp", "CRACK"),
         Case("press fit", INPUT / "examples" / "press_fit.inp", "SEAT"))


def case_deck(case, level, parts, folder, estimates, pairing="NODES"):
    """Write the deck of a case; return its path."""
    text = re.sub(r", PAIRING=\w+", "", case.deck.read_text())
    text = text.replace("*CONTACT PAIR,", f"*CONTACT PAIR, PAIRING={pairing},")
    text = re.sub(r"^\*REFINE.*\n", "", text, flags=re.M)
    text = text.split("*VERIFY")[0]
    text = re.sub(r"INC=\d+", "INC=10000", text)
    text = ANALYSIS.sub(lambda found: f"{found[1]}{float(found[2]) / parts!r}", text)
    cards = f"*REFINE, LEVELS={level}\n" + ("*SOLVER, TYPE=MUMPS\n" if level > 2 else "")
    cards += f"*OPTIONS, ERRORS={'YES' if estimates else 'NO'}\n"
    text = re.sub(r"^\*STEP", cards + "*STEP", text, count=1, flags=re.M | re.I)
    text = re.sub(r"^(\*(?:NODE|EL|CONTACT) FILE)", r"\1, FREQUENCY=0", text, flags=re.M | re.I)
    for mesh in case.deck.parent.glob("*.mesh"):
        (folder / mesh.name).write_text(mesh.read_text())
    deck = folder / f"{case.name.replace(' ', '_')}_{level}_{parts}.inp"
    deck.write_text(text)
    return deck


def solve_case(case, level, parts, folder, estimates):
    """Return the result file of a run."""
    return solve(case_deck(case, level, parts, folder, estimates), seconds=900)


def values_of(case, level, parts, folder):
    """Return the quantities at the end of a run that estimates nothing."""
    with h5py.File(solve_case(case, level, parts, folder, False)) as file:
        face = file[f"contact/{case.face}"]
        found = {name: face[name][-1] for name in ("normal_force", *EDGES)}
        found["heat_rate"] = face["heat_rate"][-1] if "heat_rate" in face else 0.0
        return found | {"peak_pressure": face["pressure"][-1].max()}


def limits(case, folder):
    """Return the converged values of the quantities: over the mesh, and with what smaller increments
    change on the second mesh."""
    runs = [values_of(case, level, 1, folder) for level in (2, 3, 4)]
    fine = values_of(case, 1, FINEST_PARTS, folder) if case.has_path else None
    coarse = values_of(case, 1, 1, folder)
    found = {}
    for name in (*QUANTITIES, *EDGES):
        values = [run[name] for run in runs]
        last, before = values[2] - values[1], values[1] - values[0]
        ratio = last / before if before else 0.0
        left = last * ratio / (1.0 - ratio) if 0.0 < ratio < MOST and name in QUANTITIES else 0.0
        path = fine[name] - coarse[name] if fine and name in QUANTITIES else 0.0
        found[name] = values[2] + left + path
    return found


def five_decks(folder):
    """Return the table of converged values of the five decks."""
    table = Table("Converged values of the five decks", ["deck", *QUANTITIES.values(), *EDGES.values()],
                  text=UNITS)
    for case in CASES:
        exact = limits(case, folder)
        exact["heat_rate"] = exact["heat_rate"] or np.nan  # no step of the deck has heat
        table.rows.append([case.name, *map(told_value, (exact[name] for name in (*QUANTITIES, *EDGES)))])
    return table


def told_value(value):
    """Return a value as the document tells it."""
    return "-" if np.isnan(value) else f"{value:.10g}"


def shares(cases, name="Bounds that hold", groups=DECKS):
    """Return the table of how many bounds hold, of groups of decks."""
    table = Table(name, ["quantity", "decks", "cases", "uncertain", "hold", "% hold",
                         "median of bound/error"])
    for quantity, title in held_bounds.QUANTITIES.items():
        for decks, is_in in groups.items():
            some = [case for case in cases if case.quantity == quantity and is_in(case)]
            known = [case for case in some if not case.is_uncertain]
            if not known:
                continue
            held = sum(case.is_held for case in known)
            median = np.median([case.bound / abs(case.error) for case in known])
            table.rows.append([title, decks, len(some), len(some) - len(known), held,
                               f"{100 * held / len(known):.0f}", f"{median:.1f}"])
    return table


def mismatched(folder):
    """Return the tables of how many bounds hold on faces that do not match, against the finer mesh with
    the same increments and with shorter ones."""
    decks = mismatched_decks()
    same = [case for deck in decks for case in held_bounds.judged_with_same_increments(deck, folder)]
    drawn = [case for deck in decks if "mortar" in deck.name for case in held_bounds.judged(deck, folder)]
    return [shares(same, "Faces that do not match, same increments", MORTAR),
            shares(drawn, "Faces that do not match, shorter increments", MORTAR)]


def misses(cases):
    """Return the table of the bounds that do not hold."""
    table = Table("Bounds that do not hold", ["deck", "refinements", "increments", "step", "quantity",
                                              "true error, %", "bound, %"])
    for case in cases:
        if case.is_held or case.is_uncertain:
            continue
        scale = 100 / abs(case.converged)
        table.rows.append([case.deck, case.level, increments_of(case.part), case.step,
                           held_bounds.QUANTITIES[case.quantity], f"{scale * abs(case.error):.3g}",
                           f"{scale * case.bound:.3g}"])
    return table


def converged_table(decks, folder):
    """Return the converged values at the ends of the steps of decks."""
    table = Table("Converged values of all decks",
                  ["deck", "decks", "step", *held_bounds.QUANTITIES.values()], text=UNITS)
    for deck in decks:
        with h5py.File(held_bounds.run(deck, 0, 1, folder)) as file:
            times = file["errors/time"][:]
        exact = held_bounds.converged_values(deck, times, folder)
        for step in range(len(times)):
            values = [exact[q][step] if q in exact else np.nan for q in held_bounds.QUANTITIES]
            table.rows.append([deck.name, "chosen on" if deck.is_fitted else "kept aside", step + 1,
                               *map(told_value, values)])
    return table


def costs(folder):
    """Return the table of what the bounds cost."""
    table = Table("Cost of the bounds", ["deck", "million instructions of the run", "of the bounds",
                                         "% of the rest"], text="""The meshes as they are, with fields of
the last increment only. The aim of a third is reached with 45 increments; Hertz has four and no heat,
so that assembling and smoothing the finer mesh count for more.""")
    for case in CASES[:3]:
        deck = case_deck(case, 0, 1, folder, True)
        spent = profile("run", "--quiet", deck, "--out", folder, path=folder / "profile.out")
        share = spent.share(PARTS["estimated errors"])
        table.rows.append([case.name, f"{spent.total / 1e6:.0f}", f"{share * spent.total / 1e6:.0f}",
                           f"{100 * share / (1 - share):.0f}"])
    return table


def tables(folder):
    """Run all decks; return shares, misses, costs and converged values."""
    decks = all_decks()
    cases = [case for deck in decks for case in held_bounds.judged(deck, folder)]
    return [shares(cases), misses(cases), *mismatched(folder), costs(folder), converged_table(decks, folder),
            five_decks(folder)]


def increments_of(part):
    """Return how increments are told that are a part of those of the deck."""
    return "as written" if part == 1 else f"1/{part}"


def test_bounds_of_decks_kept_aside_hold_as_the_document_tells(tmp_path):
    """Three decks on their two coarser meshes, against the converged values that are told."""
    check_parts([TEXT])
    told, missed = rows("Converged values of all decks"), rows("Bounds that do not hold")
    chosen = {"cylinder, mu = 0.3, aluminium", "Hertz", "plane 4"}
    for deck in all_decks():
        if deck.name not in chosen:
            continue
        steps = [row for row in told if row["deck"] == deck.name]
        assert steps[0]["decks"] == "kept aside"
        exact = {q: [np.nan if row[title] == "-" else float(row[title]) for row in steps]
                 for q, title in held_bounds.QUANTITIES.items()}
        cases = held_bounds.judged(deck, tmp_path, (0, 1), told=exact)
        assert len(cases) > 7 and not any(case.is_uncertain for case in cases)
        known = [row for row in missed if row["deck"] == deck.name and row["refinements"] != "2"]
        found = [[str(cell) for cell in row[:5]] for row in misses(cases).rows]
        assert found == [list(row.values())[:5] for row in known]


def test_bounds_of_mortar_points_hold_on_faces_that_do_not_match(tmp_path):
    """Against a finer mesh with the same increments: at most one of all bounds does not hold."""
    cases = []
    for seed in (4, 5, 7):
        cases += held_bounds.judged_with_same_increments(mismatched_deck(seed), tmp_path, (0, 1))
    assert len(cases) > 20 and not any(case.is_uncertain for case in cases)
    assert sum(not case.is_held for case in cases) < 2
    assert np.median([case.bound / abs(case.error) for case in cases]) < 6
    # Without supports of the new nodes they are about 1.
    assert np.median([case.bound / abs(case.converged) for case in cases
                      if case.quantity == "peak_pressure"]) < 0.1


def test_the_document_counts_right():
    """Of each quantity as many are missed as are listed."""
    missed = [row["quantity"] for row in rows("Bounds that do not hold")]
    table = rows("Bounds that hold")
    assert len(table) == len(DECKS) * len(held_bounds.QUANTITIES)
    for row in table:
        if row["decks"] == "all":
            judged = int(row["cases"]) - int(row["uncertain"])
            assert judged - int(row["hold"]) == missed.count(row["quantity"])
