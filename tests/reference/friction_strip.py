#!/usr/bin/env python3
"""A strip pressed on a rigid base, heated and cooled: slip and stick in closed form, to check thercon against.

One dimension: the strip of height h lies on 0 <= x <= L, held at x = 0, free at x = L, pressed by p with friction mu and
heated evenly by T. The stuck middle has the stress E alpha T; mu p balances it over the slip length
d = E alpha T h/(mu p) from the free end. On the way back slip of the other sign enters from the free end over the
length that a change of 2 mu p balances: half of d when T returns to 0.
"""


def slip_length(height, young, expansion, rise, friction, pressure):
    """Length of the slip zone at the free end at the first heating."""
    return young * expansion * rise * height / (friction * pressure)


def reversed_slip_length(height, young, expansion, change, friction, pressure):
    """Length of the zone that slips back after a change of the temperature."""
    return slip_length(height, young, expansion, change, 2 * friction, pressure)


def held_force(height, young, expansion, rise):
    """Sum of the friction on the strip, per thickness: the force in the stuck middle."""
    return young * expansion * rise * height
