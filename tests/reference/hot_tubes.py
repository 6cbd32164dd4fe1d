#!/usr/bin/env python3
"""One tube in another under a radial heat flow, over a gap or pressed, in closed form, to check thercon against."""
import lame
import numpy as np


def hot_fit(radii, tubes, temperatures, gap, open_law, closed_law, plane):
    """One tube in another, heat from the bore to the outside: gap, pressure, conductance, flux at the face, and the
    temperatures of both faces.

    radii are those of the bore, the face and the outside; a tube is (E, nu, alpha, k); temperatures are those of the bore
    and of the outside, above the natural state, in which the tubes are `gap` apart (negative: they overlap). Laws are
    functions of the gap and of the pressure; s is a gap where it is positive, else an overlap that pressure takes up.
    """
    inner, face, outer = radii
    hub, rim = tubes
    give = (lame.wall_compliance(inner, face, face, hub[0], hub[1], plane)
            + lame.wall_compliance(face, outer, face, rim[0], rim[1], plane))

    def state(s):
        omega = open_law(s) if s > 0 else closed_law(-s / give)
        resistances = face * np.log(face / inner) / hub[3], 1 / omega, face * np.log(outer / face) / rim[3]
        flux = (temperatures[0] - temperatures[1]) / sum(resistances)
        return omega, flux, (temperatures[0] - flux * resistances[0], temperatures[1] + flux * resistances[2])

    def excess(s):
        _, _, (inside, outside) = state(s)
        hub_grows = lame.hot_tube(face, inner, face, temperatures[0], inside, *hub[:3], plane)[3]
        rim_grows = lame.hot_tube(face, face, outer, outside, temperatures[1], *rim[:3], plane)[3]
        return s - (gap + rim_grows - hub_grows)

    low, high = -face, face
    while low < (middle := (low + high) / 2) < high:
        low, high = (middle, high) if excess(middle) < 0 else (low, middle)
    return max(middle, 0.0), max(-middle, 0.0) / give, *state(middle)
