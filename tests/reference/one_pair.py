"""All contact states of one pair with Coulomb friction on two coupled springs, by trying each.

Forces on the slave are S d - c, in the frame (normal, tangent) with d = (d_n, d_t); the gap is
h - d_n. With S_nt not zero and much friction several states satisfy all conditions (1.6): slip
against which S_tt - mu |S_nt| < 0 is no stiffness (A. Klarbring, Ing. Archiv 60, 1990, 529).
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class State:
    """A state: name, gap, tangential place, force (compression is positive) and shear force."""

    name: str
    gap: float
    place: float
    force: float
    shear: float


def states(springs, friction, load, reference=0.0, gap=0.0, rounding=1e-12):
    """Return the states that hold under a load, friction counting from a reference."""
    (nn, nt), (_, tt) = springs
    cn, ct = load
    found = []

    def add(name, dn, dt, holds):
        state = State(name, gap - dn, dt, cn - nn * dn - nt * dt, nt * dn + tt * dt - ct)
        if holds(state):
            found.append(state)

    determinant = nn * tt - nt * nt
    add("open", (tt * cn - nt * ct) / determinant, (nn * ct - nt * cn) / determinant,
        lambda s: s.gap > rounding)
    add("stick", gap, reference,
        lambda s: s.force >= -rounding and abs(s.shear) <= friction * s.force + rounding)
    for way in 1, -1:
        # tt d_t + nt h - ct = way mu (cn - nn h - nt d_t)
        place = (way * friction * (cn - nn * gap) + ct - nt * gap) / (tt + way * friction * nt)
        add("slip", gap, place, lambda s, way=way: s.force > rounding
            and way * (s.place - reference) < -rounding)
    return found
