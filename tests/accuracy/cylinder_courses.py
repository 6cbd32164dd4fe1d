"""Courses of the published cylinder and of other readings of the paper: figures at each load."""

import sys

import cylinder_reference
import h5py
import numpy as np
from deck_runs import INPUT, run

sys.path.append(str(INPUT / "cylinder"))
import make_decks  # noqa: E402  its folder is made known first
from make_decks import PUBLISHED, Reading  # noqa: E402

STEP, LAST = 20.0, 900.0
LOADS = np.arange(STEP, LAST + STEP / 2, STEP)
QUANTITIES = ("normal force", "heat rate", "peak pressure", "edge of contact", "edge of stick")
UNITS = ("MPa cm", "W/cm", "MPa", "cm", "cm")
PUBLISHED_INCREMENTS = round(LAST / STEP)
INCREMENTS = tuple(PUBLISHED_INCREMENTS * n for n in (1, 2, 4, 8))
READINGS = {
    "ours": PUBLISHED,
    "plane stress": Reading(plane_stress=True),
    "top and bottom held in x": Reading(ends_held=True),
    "arc": Reading(arc=True),
    "60 wide, 30 high": Reading(height=30.0),
    "30 wide as a whole": Reading(width=15.0),
    "nu swapped": Reading(poisson=(0.2, 0.4)),
}
OTHER_GRADING = Reading(fine=8.1)


def deck_text(reading, level, increments):
    """Return the deck of a reading, refined, in so many increments, without fields and tables."""
    text = "\n".join(make_decks.reading_cards(reading)) + "\n"
    changes = {"20., 900.": f"{LAST / increments!r}, {LAST!r}",
               "*STEP, INC=100\n": "*STEP, INC=100000\n",
               " FILE\n": " FILE, FREQUENCY=0\n", " PRINT\n": " PRINT, FREQUENCY=0\n"}
    for old, new in changes.items():
        assert old in text, old
        text = text.replace(old, new)
    return text.replace("*STEP", f"*REFINE, LEVELS={level}\n*STEP", 1)


def course(folder, reading=PUBLISHED, level=0, increments=PUBLISHED_INCREMENTS):
    """Solve a reading on a mesh in so many increments, a multiple of 45; return the quantities at the loads
    20, 40, ..., 900."""
    deck = folder / "cylinder.inp"
    deck.write_text(deck_text(reading, level, increments))
    process = run("run", "--quiet", deck, "--out", folder, seconds=7200)
    assert process.returncode == 0, process.stderr
    every = increments // PUBLISHED_INCREMENTS
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        face = {name: file[f"contact/FACE/{name}"][()][every - 1::every]
                for name in ("normal_force", "heat_rate", "pressure", "edge_contact", "edge_stick")}
    found = (face["normal_force"], face["heat_rate"], face["pressure"].max(axis=1),
             face["edge_contact"], face["edge_stick"])
    return dict(zip(QUANTITIES, found, strict=True))


def independent_course(folder, reading=PUBLISHED, level=0, vertical=False,
                       increments=PUBLISHED_INCREMENTS):
    """Return the same quantities by the independent solver; `vertical`: normals along y."""
    deck = folder / "independent.inp"
    deck.write_text(deck_text(reading, 0, PUBLISHED_INCREMENTS))
    _, states = cylinder_reference.solve_deck(deck, level, LAST / increments, LAST, vertical)
    every = increments // PUBLISHED_INCREMENTS
    found = np.array([(state.normal_force, state.heat_rate, state.p.max(), state.edge_contact,
                       state.edge_stick) for state in states[every - 1::every]])
    return dict(zip(QUANTITIES, found.T, strict=True))
