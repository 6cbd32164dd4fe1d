"""Requested peak pressures on the axis under a rigid ball, on linear elements: decks whose radius, size, load, material,
mesh, pairing and request are drawn, against CAX8 on a fine mesh.

`python tests/accuracy/axis_decks.py FIRST LAST KIND...` prints for each seed error, uncertainty and their ratio. Seeds
from 1000 on judge; no constant was chosen on any of them.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import report  # isort: skip, it makes the modules below known
import h5py
import numpy as np
from deck_runs import run
from drawn_decks import log_uniform
from judged_decks import estimate
from physics import material, mesh

FINE = 64   # elements along the fine part of the reference


def corners(spacing, count, end, growth):
    """Return `count` equal sides from 0, then growing ones to the end."""
    even = spacing * np.arange(count + 1)
    beyond = np.cumsum(spacing * growth ** np.arange(1, 200))
    beyond = beyond[:np.searchsorted(beyond, end - even[-1]) + 1]
    return np.concatenate([even, even[-1] + beyond * (end - even[-1]) / beyond[-1]])


def ball(seed, kind=None):
    """Return the deck of a seed on elements of a kind; by default the one that has its true value."""
    draw = np.random.default_rng([seed, 78])
    radius, young, poisson, size = log_uniform(draw, 20, 500), log_uniform(draw, 3e4, 3e5), *draw.uniform(
        (0.1, 2.5), (0.4, 6.0))
    count, half, growth, row = int(draw.integers(5, 25)), draw.uniform(0.3, 1.2), *draw.uniform((1.1, 0.8), (1.5, 2.0))
    pairing, is_load = ("NODES", "SURFACES")[draw.integers(2)], draw.uniform() < 0.4
    levels = int(draw.integers(0, 3)) if count < 9 else 0
    if kind is None:
        kind, count, growth, row, pairing, levels = "CAX8", FINE, 1.3 ** (8 / FINE), 2.0, "NODES", 0
    across, down = corners(1 / count, count, size, growth), corners(2 * row / count, 2, size, growth)
    height = radius - np.sqrt(radius**2 - 1.8**2)
    force = 4 / 3 * young / (1 - poisson**2) * half**3 / radius
    cards = [*mesh("LOW", across, -down[::-1], kind), "*NODE", "900001, 0., 1.", "*SURFACE, NAME=DIE, TYPE=SEGMENTS",
             f"START, 1.8, {height:.15g}", f"CIRCL, 0., 0., 0., {radius:.15g}",
             "*RIGID BODY, REF NODE=900001, ANALYTICAL SURFACE=DIE", *material("LOW", (young, poisson)),
             "*SURFACE INTERACTION, NAME=I", f"*CONTACT PAIR, INTERACTION=I, NAME=FACE, PAIRING={pairing}",
             "LOW.TOP, DIE", *([f"*REFINE, LEVELS={levels}, SURFACE=LOW.TOP"] if levels else []),
             "*BOUNDARY", "LOW.BOTTOM, 2, 2", "LOW.LEFT, 1, 1", "900001, 1, 1", "900001, 6, 6", "*STEP",
             "*STATIC, DIRECT", "1., 1.", *(["*CLOAD", f"900001, 2, {-force:.9g}"] if is_load else [
                 "*BOUNDARY", f"900001, 2, 2, {-half**2 / radius:.9g}"]), "*END STEP"]
    return "\n".join(cards) + "\n"


def peak_of(text, options, folder):
    """Return the peak pressure of a deck, its uncertainty, and why it has none."""
    deck = folder / "ball.inp"
    deck.write_text(text)
    process = run("run", "--quiet", deck, "--out", folder, *options)
    assert process.returncode in (0, 4), process.stderr
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        return estimate(file, "FACE", "peak_pressure")


def judged(seed, kind, folder):
    """Return error and uncertainty of a request, relative to the true peak."""
    request = f"{np.random.default_rng([seed, 5]).choice([2, 1, 0.5])}%"
    true = peak_of(ball(seed), [], folder)[0]
    value, uncertainty, _ = peak_of(ball(seed, kind), ["--accuracy", request], folder)
    return value / true - 1, uncertainty / true


def main(first, last, *kinds):
    """Print all errors and uncertainties."""
    with TemporaryDirectory() as folder:
        for seed in range(int(first), int(last)):
            for kind in kinds:
                error, uncertainty = judged(seed, kind, Path(folder))
                print(seed, kind, f"{error:.5f} {uncertainty:.5f} {abs(error) / uncertainty:.2f}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
