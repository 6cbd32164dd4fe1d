"""Rods of pellets in a tube that heat closes onto it, each pressed on the next: many interfaces."""

import numpy as np
from physics import material, mesh

HEIGHT, POWER, PRESS = 10.0, 0.4, 2.0
ALONG = 4   # elements of a pellet along the rod


def rod(pellets, tail=None, kind="CAX4", expansion=1e-5, friction=0.1, counts=(4, ALONG, 1),
        starts=(0.0, 0.0)):
    """Return the cards of a rod; its kind is that of its elements, or what is special, by words.

    Counts are elements of a pellet across and along, and of the tube across; starts are where the
    pellets and the tube begin.
    """
    across, along, of_tube = counts
    element = kind if kind.startswith("CAX") else "CAX4"
    rows = "tables" in kind
    stores = {"density": 1e-5, "specific_heat": 300.0} if "transient" in kind else {}

    def over(hot, *values):
        return [(*values, 0.0), (hot * values[0], *values[1:], 1000.0)] if rows else list(values)

    pair = ", PAIRING=SURFACES" if "mortar" in kind else ", PAIRING=NODES"
    names = [f"P{k}" for k in range(pellets)]
    cards = [*mesh("TUBE", np.linspace(4.12, 4.7, of_tube + 1),
                   starts[1] + np.linspace(0, HEIGHT * pellets, along * pellets + 1), element,
                   first=100001),
             *material("TUBE", over(0.8, 7e4, 0.35), over(1.2, 6e-6), over(0.7, 0.017), **stores)]
    for k, name in enumerate(names):
        cards += [*mesh(name, np.linspace(0, 4.1, across + 1),
                        starts[0] + np.linspace(HEIGHT * k, HEIGHT * (k + 1), along + 1), element,
                        first=100 * k + 1),
                  *material(name, over(0.8, 1.8e5, 0.316), over(1.2, expansion), over(0.7, 3e-3),
                           **stores)]
    cards += ["*SURFACE INTERACTION, NAME=G", "*FRICTION", f"{friction}",
              *(["*GAP HEAT GENERATION", "1., 0.3"] if "rubbing" in kind else []),
              "*GAP LAW, TYPE=GAS",
              *(["3.E-4, 0.005, 0.", "9.E-4, 0.005, 1000."] if rows else ["3.E-4, 0.005"])]
    for k, name in enumerate(names):
        cards += [f"*SURFACE, NAME=TUBE{k}",
                  *[f"{100001 + of_tube * (along * k + e)}, S4" for e in range(along)],
                  f"*CONTACT PAIR, INTERACTION=G, NAME=W{k}{pair}", f"{name}.RIGHT, TUBE{k}"]
        if k:
            cards += [f"*CONTACT PAIR, INTERACTION=G, NAME=E{k}{pair}",
                      f"{name}.BOTTOM, {names[k - 1]}.TOP"]
    cards += [f"*SOLVER, TAIL={tail}"] if tail else []
    # So short that friction makes heat that moves the contact.
    period = 0.3 if "rubbing" in kind else 1.0
    step = ["*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", f"{period / 4}, {period}"]
    if "transient" in kind:
        strains = ", DILATATION=YES" if "dilating" in kind else ""
        step = [f"*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT{strains}", "25., 100.", "*STABILITY"]
    # So near that strains take up a tenth of the heat that is stored.
    zero = ["*PHYSICAL CONSTANTS, ABSOLUTE ZERO=-10."] if "dilating" in kind else []
    return ["*OPTIONS, ERRORS=NO", *zero, *cards, "*FIXED POINT, TOL=1E-12",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", *[f"{n}, 0." for n in (*names, "TUBE")],
            "*BOUNDARY", "TUBE.BOTTOM, 2", "P0.BOTTOM, 2", *[f"{n}.LEFT, 1" for n in names],
            "*STEP", *step, "*DFLUX", *[f"{n}, BF, {POWER}" for n in names],
            "*SFILM", "TUBE.RIGHT, F, 300., 0.03", "*DSLOAD", f"{names[-1]}.TOP, P, {PRESS}",
            "*END STEP"]
