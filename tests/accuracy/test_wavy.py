"""Bounds of the edge of contact on wavy faces and other periodic profiles, with heat and without, against
closed forms and a spectral solution (wavy_faces)."""

import h5py
import numpy as np
import wavy_faces
from deck_runs import run
from report import Table, check_parts, rows

TITLE = "Bounds of edges on wavy faces"
TEXT = """
An elastic half-space is pressed on a hard face of a periodic profile, with 24 to 40 elements a wave, in 1, 5
or 10 increments, with node pairs and with mortar points; width of the contact, heat, mesh and increments are
drawn. Without heat and with heat into or out of the half-space through a perfect contact the edge is known
in closed form (Westergaard; Panek and Dundurs). Where the conductance is continuous in gap and pressure, and
for the families that chose no constant, it is that of a spectral solution
(`tests/accuracy/wavy_faces.py`), which is accurate to 1 % of the spacing: smaller errors are not judged. Each
deck is solved on the mesh as it is, half of them refined once as well. The constants of the edge of contact
were chosen on seeds below 2 modulo 4; the families that chose none are flat punches with round edges, wedges, and two elastic bodies
of other materials, all with heat.
"""
LEAST = 0.01           # of the spacing: errors that the spectral solution may have
LEVELS = {0: wavy_faces.SEEDS, 1: range(8)}   # refinements, and the seeds solved with them
TESTED = (("cold", 1), ("cold", 2), ("heat in", 1), ("heat out", 4))


def is_chosen(seed):
    """Return whether the constants were chosen on the decks of a seed."""
    return seed % 4 < 2


def judged(face, level, folder):
    """Return error and bound of the edge of contact in the spacing; NaN where the deck has no solution, the
    bound alone where it is uncertain."""
    path = folder / f"{face.name.replace(' ', '_').replace(',', '')}_{level}.inp"
    cards = f"*REFINE, LEVELS={level}\n" if level else ""
    path.write_text(face.text.replace("*STEP", f"{cards}*STEP", 1))
    if run("run", "--quiet", path, "--out", folder).returncode:
        return np.array([np.nan, np.nan])
    with h5py.File(path.with_suffix(".vtkhdf")) as file:
        value, bound = file["errors/J/edge_contact"][-1][:2]
    return np.array([value - face.edge, bound]) / face.spacing * 2**level


def tables(folder):
    """Return the table of all families."""
    table = Table("Edges of contact of all families", ["family", "points", "decks", "held", "not solved",
                                                       "worst error/bound", "median bound/error"])
    for family in wavy_faces.CHOSEN + wavy_faces.NEW:
        found = [(seed, judged(wavy_faces.drawn(family, seed), level, folder))
                 for level, seeds in LEVELS.items() for seed in seeds]
        groups = {"chosen on": is_chosen, "kept aside": lambda seed: not is_chosen(seed)}
        if family in wavy_faces.NEW:
            groups = {"new": lambda seed: True}
        for pairing, title in enumerate(("node pairs", "mortar points")):
            for group, is_in in groups.items():
                some = [case for seed, case in found if seed % 2 == pairing and is_in(seed)]
                table.rows.append([family, title, group, *shares(np.array(some))])
    return [table]


def shares(cases):
    """Return how many of the bounds hold, how many decks have no solution, the worst error over bound, and the
    median of bound over error."""
    error, bound = np.abs(cases).T
    is_solved, is_judged = np.isfinite(error), error > LEAST
    known = is_judged & np.isfinite(bound)
    held = int((error[known] <= bound[known]).sum())
    text = f"{held}/{known.sum()}, {100 * held / known.sum():.0f} %"
    uncertain = int((is_judged & ~known).sum())
    text += f", {uncertain} uncertain" if uncertain else ""
    return (text, int((~is_solved).sum()), f"{(error / bound)[known].max():.2f}",
            f"{np.median((bound / error)[known]):.1f}")


def test_the_spectral_solution_has_the_edge_of_the_closed_form(monkeypatch):
    """To a part of a cell; the flux through a perfect contact has a root singularity at the edge."""
    monkeypatch.setattr(wavy_faces, "CELLS", 160)
    for a, heat, part in ((0.15, 0.0, 0.1), (0.3, 0.0, 0.1), (0.4, 0.0, 0.1), (0.3, 2.0, 0.3)):
        pressure, drop = wavy_faces.closed_form(a, heat)
        drop = drop if heat else 0.0
        found = wavy_faces.spectral(wavy_faces.cosine, pressure, drop,
                                    lambda gap, p: np.where(p > 0, 3e3, 0.0), (0.0,) * 3)
        assert abs(found - a) < part / (2 * wavy_faces.CELLS)


def test_bounds_of_edges_hold_on_wavy_faces(tmp_path):
    """Four decks with closed forms, as the document says that bounds hold."""
    check_parts([TEXT])
    for family, seed in TESTED:
        error, bound = np.abs(judged(wavy_faces.drawn(family, seed), 0, tmp_path))
        assert error <= bound < 10 * error


def test_the_document_has_all_families():
    told = {row["family"] for row in rows("Edges of contact of all families")}
    assert told == {*wavy_faces.CHOSEN, *wavy_faces.NEW}
