"""Decks of bodies that yield and creep, and closed forms of what they do."""

from math import log, sqrt

import numpy as np
from physics import material, mesh, nodes_of

YOUNG, POISSON = 200e3, 0.3
A, N = 3.125e-14, 5.0   # Norton's law [MPa, h]


def law(*cards, elastic=(YOUNG, POISSON), name="BODY", **more):
    """Return a material with laws behind its elasticity, and its section."""
    given = material(name, elastic=elastic, **more)
    return [*given[:-1], *cards, given[-1]]


def bar(*cards, kind="CPS4", **more):
    """Return a square of one element that may strain freely."""
    return [*mesh("BODY", [0.0, 1.0], [0.0, 1.0], kind), *law(*cards, **more),
            "*BOUNDARY", "BODY.LEFT, 1", "BODY.BOTTOM, 2"]


def step(analysis, times, *cards, options=""):
    """Return a step."""
    return [f"*STEP, INC=100000{options}", analysis, times, *cards, "*END STEP"]


def pulled(stress, analysis="*STATIC", times="0.05, 1.", options=""):
    """Return a step to a tension along x."""
    return step(analysis, times, "*DSLOAD", f"BODY.RIGHT, P, {-stress!r}", options=options)


def stretched(strain, analysis, times, **more):
    """Return a step to an elongation along x."""
    return step(analysis, times, "*BOUNDARY", f"BODY.RIGHT, 1, 1, {strain!r}", **more)


BORE, OUTSIDE = 100.0, 200.0
SOFT, YIELD = (21e3, 0.499), 24.0   # of the tube of Hill


def tube(laws, *steps, kind="CAX8R", elements=20, elastic=SOFT):
    """Return a tube in plane strain."""
    xs = [float(x) for x in np.linspace(BORE, OUTSIDE, elements + 1)]
    return [*mesh("BODY", xs, [0.0, 5.0], kind), *law(*laws, elastic=elastic), "*BOUNDARY",
            "BODY, 2", *steps]


def pressed(pressure, analysis="*STATIC", times="0.1, 1."):
    """Return a step to a pressure in the bore."""
    return step(analysis, times, "*DSLOAD", f"BODY.LEFT, P, {pressure!r}")


def hill(radius):
    """Return the pressure that makes a tube yield up to a radius, and the displacement and the hoop
    stress of its outside, which is elastic from there on."""
    young, poisson = SOFT
    k = 2 * YIELD / sqrt(3.0)
    hoop = k * (radius / OUTSIDE) ** 2
    return (k * (log(radius / BORE) + (1 - (radius / OUTSIDE) ** 2) / 2),
            (1 - poisson**2) * hoop / young * OUTSIDE, hoop)


def fit(*laws, free=False, elements=20, joint=()):
    """Return a solid shaft 50 in a hub 50/100 with elements through it; ends are free, or all
    planes are held."""
    hub = [float(x) for x in np.linspace(50.0, 100.0, elements + 1)]
    return [*mesh("SHAFT", [0.0, 12.5, 25.0, 37.5, 50.0], [0.0, 5.0], "CAX8R"),
            *mesh("BODY", hub, [0.0, 5.0], "CAX8R", first=101),
            *material("SHAFT", (YOUNG, POISSON)), *law(*laws),
            "*SURFACE INTERACTION, NAME=JOINT", *joint,
            "*CONTACT PAIR, INTERACTION=JOINT, NAME=FIT", "SHAFT.RIGHT, BODY.LEFT", "*BOUNDARY", "SHAFT.LEFT, 1",
            *(["SHAFT.BOTTOM, 2", "BODY.BOTTOM, 2"] if free else ["SHAFT, 2", "BODY, 2"])]


def overlap(value):
    """Return the card of an overlap of shaft and hub."""
    return ["*CLEARANCE, SLAVE=SHAFT.RIGHT, MASTER=BODY.LEFT, VALUE=" + repr(-value)]


def relaxing(card, times, *more):
    """Return a bar that creeps at a fixed strain, from a stress of 200."""
    return [*bar("*CREEP", f"{A!r}, {N!r}"), *more, *stretched(200.0 / YOUNG, "*STATIC", "1., 1."),
            *stretched(200.0 / YOUNG, card, times)]


def left(time, start=200.0, young=YOUNG, a=A, n=N):
    """Return the stress that is left after a time at a fixed strain."""
    return (start ** (1 - n) + (n - 1) * a * young * time) ** (1 / (1 - n))


def bree(tension, thermal, *cycle, rows=40, yield_stress=100.0):
    """Return Bree's plate under a constant tension, with temperatures across it that come and go;
    parts of the yield stress."""
    alpha = 1e-5
    warmth = 2 * thermal * yield_stress / (YOUNG * alpha)
    ys = [float(y) for y in np.linspace(0.0, 1.0, rows + 1)]
    plate = mesh("BODY", [0.0, 0.05], ys, "CPS4")
    nodes = nodes_of(plate)
    right = [n for n, (x, _) in nodes.items() if x > 0.0]
    tied = [line for n in right[1:] for line in ("2", f"{n}, 1, 1., {right[0]}, 1, -1.")]
    hot = [f"{n}, {y * warmth!r}" for n, (_, y) in nodes.items()]
    return [*plate, *law("*PLASTIC", f"{yield_stress!r}", expansion=alpha), "*EQUATION", *tied,
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.", "*BOUNDARY", "BODY.LEFT, 1",
            "1, 2",
            *step("*STATIC", "1., 1.", "*CLOAD", f"{right[0]}, 1, {tension * yield_stress!r}"),
            *step("*STATIC", "0.05, 1.", "*TEMPERATURE", *hot),
            *step("*STATIC", "0.05, 1.", "*TEMPERATURE", "BODY, 0."), *cycle]


def strain_of_bree(tension, thermal, cycles):
    """Return the strain of Bree's plate after cycles, over that at the yield stress.

    Equilibrium of fibres that expand by their temperature: hot, the plate yields at its cold face,
    and at both where Y (1 - X) > 1; cold again, its stresses are mirrored if it ratchets, and those
    of elastic unloading if it shakes down. Yielding at both faces without ratcheting is that of
    flow to and fro, Y > 2.
    """
    if tension + thermal <= 1:
        return tension
    if thermal * (1 - tension) <= 1:
        elastic = 2 * sqrt((1 - tension) / thermal)   # of the half thickness, where it is hot
        if elastic < 1:
            return 1 + cycles * 2 * thermal * (1 - elastic)
        return tension + thermal * (2 - elastic) ** 2 / 4
    return 1 + cycles * 2 * (tension * thermal - 1) if tension * thermal > 1 else tension * thermal
