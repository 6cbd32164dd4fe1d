"""Decks whose values are of any magnitude, for the theme of the extremes."""

import random

import mutated_decks
import numpy as np
from blocks import block, write

VALUES = {
    "young": 2e5, "poisson": 0.3, "expansion": 1e-5, "conductivity": 0.05, "density": 1e-8,
    "thickness": 1.0, "friction": 0.3, "gas": 0.01, "length": 1e-3, "closed": 10.0, "rise": 0.01,
    "power": 0.95, "width": 2.0, "height": 1.0, "gap": 1e-4, "pressure": 10.0, "hot": 100.0,
    "film": 0.02, "sink": 20.0, "flux": 0.1, "force": 5.0, "initial": 10.0, "source": 0.01,
    "gravity": 9810.0, "sunk": 1e-3, "period": 1.0, "tolerance": 1e-8, "jump": 0.5,
    "specific": 5e8, "first": 0.1, "change": 20.0, "spring": 100.0, "speed": 10.0, "warm": 0.04,
}
LAWS = (
    "*FRICTION\n{friction}\n*GAP LAW, TYPE=GAS\n{gas}, {length}\n*GAP LAW, TYPE=POWER\n"
    "{closed}, {rise}, {power}",
    "*GAP LAW, TYPE=POWER\n{closed}, {rise}, {power}",
    "*FRICTION\n{friction}\n*GAP CONDUCTANCE\n{closed}, 0.\n{jump}, {pressure}",
    "*FRICTION\n{friction}\n*GAP CONDUCTANCE\n{closed}, 0.\n*GAP HEAT GENERATION\n1., 0.5, {speed}",
    "*FRICTION\n{friction}\n*GAP CONDUCTANCE, CLEARANCE\n{closed}, 0.\n{gas}, {width}",
)
LOADS = (
    "*DSLOAD\nB.TOP, P, {pressure}\n*BOUNDARY\nB.TOP, 11, 11, {hot}",
    "*CLOAD\nB.TOP, 2, -{force}\n*CLOAD\nB.TOP, 1, {force}\n*FILM\nB, F3, {sink}, {film}",
    "*BOUNDARY\nB.TOP, 2, 2, -{sunk}\nB.TOP, 11, 11, {hot}\n*DLOAD\nB, GRAV, {gravity}, 0., -1., 0.",
    "*DLOAD\nB, GRAV, {gravity}, 0., -1., 0.\n*DFLUX\nB, BF, {source}\n*DFLUX\nB, S3, {flux}",
)
STEPS = (
    "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE\n{period}, {period}",
    "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT\n0.5, 1.",
    "*HEAT TRANSFER, STEADY STATE\n1., 1.",
    "*COUPLED TEMPERATURE-DISPLACEMENT, DELTMX={change}\n{first}, {period}",
    "*UNCOUPLED TEMPERATURE-DISPLACEMENT, DELTMX={change}\n{first}, {period}",
)
BODIES = (
    "",
    "*NODE\n901, 1., 5.\n*ELEMENT, TYPE=SPRINGA, ELSET=S\n902, 101, 901\n*SPRING, ELSET=S\n{spring}\n"
    "*BOUNDARY\n901, 1, 2\n",
    "*ELEMENT, TYPE=T2D2, ELSET=S\n902, 1, 101\n*MATERIAL, NAME=T\n*ELASTIC\n{young}, {poisson}\n"
    "*EXPANSION\n{expansion}\n*CONDUCTIVITY\n{conductivity}\n*SOLID SECTION, ELSET=S, MATERIAL=T\n{spring}\n",
)
CARDS = """*MATERIAL, NAME=M
*ELASTIC
{young}, {poisson}
*EXPANSION
{expansion}
*CONDUCTIVITY
{conductivity}, 0.
{warm}, 100.
*SPECIFIC HEAT
{specific}
*DENSITY
{density}
*SOLID SECTION, ELSET=A, MATERIAL=M
{thickness}
*SOLID SECTION, ELSET=B, MATERIAL=M
{thickness}
%s*INITIAL CONDITIONS, TYPE=TEMPERATURE
A, {initial}
B, {initial}
*SURFACE INTERACTION, NAME=I
%s
*CONTACT PAIR, INTERACTION=I, NAME=F
B.BOTTOM, A.TOP
*FIXED POINT, TOL={tolerance}
*SOLVER, TYPE=%s
*STEP
%s
*BOUNDARY
A.BOTTOM, 1, 2
A.BOTTOM, 11, 11, 0.
B.TOP, 1
%s
*CONTACT PRINT
*END STEP"""


def fuzzed(path, seed, decades, changed=(1, 2, 3)):
    """Write a deck in which some values have a random magnitude; return what they are."""
    chance = random.Random(seed)
    values = dict(VALUES)
    names = chance.sample(sorted(values), chance.choice(changed))
    for name in names:
        values[name] = float(f"{10 ** chance.uniform(*decades):.3e}")
    law, step, load, body = (chance.choice(texts) for texts in (LAWS, STEPS, LOADS, BODIES))
    solver = chance.choice(("SKYLINE", "MUMPS"))
    texts = {name: f"{value!r}" for name, value in values.items()}
    xs = [0.0, values["width"] / 2, values["width"]]
    ys = [values["gap"], values["gap"] + values["height"]]
    write(path, ["*OPTIONS, WIDTH=200"], block("A", xs, [-values["height"], 0.0]),
          block("B", xs, ys, 100), (CARDS % (body, law, solver, step, load)).format(**texts))
    return {name: values[name] for name in names}


def outcome(deck):
    """Run a deck; return its exit status, -1 where it hangs, and what must not be in its ending."""
    words = (*mutated_decks.CRASHES, "DGE", "SIG", "NaN", "Inf")
    status, faults = mutated_decks.outcome(deck, words=words)
    meant = ("contact_", "edge", "coupling_gain", "force_imbalance", "displacement", "stress", "mises")
    if status == 0:
        faults += [name for name, values in mutated_decks.numbers(deck).items()
                   if np.isnan(values).any() and not any(word in name for word in meant)]
    return status, faults
