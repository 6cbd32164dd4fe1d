"""Runs of the cylinder and of its coupled twin, refined, in other increments, by other methods."""

import re
from dataclasses import dataclass

import h5py
import numpy as np
from deck_runs import COUPLED, CYLINDER, run

DECKS = {"cylinder": CYLINDER, "twin": COUPLED}
QUANTITIES = ("gap", "pressure", "shear", "conductance", "heat_flux")
LOAD = 900.0
OPEN_LAW = "*GAP LAW, TYPE=GAS\n0.24E-5, 0.3E-5\n"


@dataclass(frozen=True)
class Run:
    """Increments that were solved, their passes and gains, and quantities of the pairs."""

    increments: int
    passes: np.ndarray
    gain: np.ndarray
    gain_max: np.ndarray
    imbalance: float
    contact: dict

    @property
    def solved(self):
        """Return the number of increments that were solved."""
        return len(self.passes)


def solve(folder, name, method="NEWTON", levels=0, increments=45, cards=(), changes=()):
    """Solve a deck in so many increments, without estimates of its errors; one that stops must say
    why."""
    text = DECKS[name].read_text()
    text = text[: text.index("*VERIFY")]
    text = re.sub(r"\*FIXED POINT, METHOD=\w+", f"*FIXED POINT, METHOD={method}", text)
    text = re.sub(r"(\*\w+ FILE|\*CONTACT PRINT)", r"\1, FREQUENCY=0", text)
    for old, new in {"20., 900.": f"{LOAD / increments!r}, {LOAD!r}", "INC=100": "INC=1000",
                     **dict(changes)}.items():
        assert old in text, old
        text = text.replace(old, new)
    cards = ["*OPTIONS, ERRORS=NO", *cards]
    if levels:
        cards = [f"*REFINE, LEVELS={levels}", *cards]
    deck = folder / f"{name}.inp"
    deck.write_text(text.replace("*STEP", "".join(f"{card}\n" for card in cards) + "*STEP", 1))
    process = run("run", "--quiet", deck, "--out", folder)
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        history = {name: file[f"history/{name}"][()] for name in file["history"]}
        contact = {name: file[f"contact/FACE/{name}"][()] for name in (*QUANTITIES, "s", "status")}
    solved = len(history["time"])
    stopped = "not converge" in process.stderr and f"increment {solved + 1} " in process.stderr
    assert process.returncode == (0 if solved == increments else 2), process.stderr
    assert solved == increments or stopped, process.stderr
    return Run(increments, history["iterations"], history["coupling_gain"],
               history["coupling_gain_max"],
               np.max([history["heat_imbalance"], history["force_imbalance"]]), contact)


def difference(one, other):
    """Return the largest difference of two runs in the increments that both have, by the largest
    value of each quantity in the increment."""
    deviations = []
    for name in QUANTITIES:
        for a, b in zip(one.contact[name], other.contact[name], strict=False):
            scale = np.abs(a).max()
            deviations.append(np.abs(a - b).max() / (scale if scale > 0.0 else 1.0))
    return float(np.max(deviations))   # NaN where any is


def resting(run):
    """Return increment, place and soundness of the pairs that rest: closed without pressure, gap
    and shear, with a conductance between none and that of a closed pair, 0.8."""
    contact = run.contact
    rests = (contact["status"] > 0) & (contact["pressure"] == 0.0)
    return [(int(i) + 1, float(contact["s"][k]),
             contact["gap"][i, k] == 0.0 == contact["shear"][i, k]
             and 0.0 < contact["conductance"][i, k] < 0.8) for i, k in np.argwhere(rests)]
