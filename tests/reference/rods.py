"""Two rods between rigid walls: heat across their gap, or under their pressure, in closed form.

The first rod has the length L1, its far end at the temperature T1; the second L2 and T2. The ends
meet over a gap g0 when nothing is warm. All motion across the rods is held and nu = 0, the area is
one. The heat flux from the first to the second is

    q = (T1 - T2)/(R0 + 1/omega),    R0 = L1/k1 + L2/k2,

temperatures are linear in each rod, and so the free expansion is

    e = a1 L1 T1 + a2 L2 T2 + e1 q,    e1 = -a1 L1^2/(2 k1) + a2 L2^2/(2 k2).

Open: gamma = g0 - e > 0 and omega = omega(gamma). Closed: p = (e - g0)/(L1/E1 + L2/E2) >= 0 and
omega = omega(p). With s = g0 - e, positive for a gap, both are one equation for s, solved here by
bisection: no derivative of a law is asked for.
"""

from bisect import bisect_right
from dataclasses import dataclass
from decimal import Decimal, localcontext
from itertools import pairwise


@dataclass(frozen=True)
class Rods:
    """Lengths, conductivities, expansions and moduli of both rods, end temperatures and gap."""

    length: tuple[float, float]
    conductivity: tuple[float, float]
    expansion: tuple[float, float]
    young: tuple[float, float]
    temperature: tuple[float, float]
    gap: float

    @property
    def resistance(self):
        """Return R0."""
        return sum(l / k for l, k in zip(self.length, self.conductivity, strict=True))

    @property
    def compliance(self):
        """Return L1/E1 + L2/E2."""
        return sum(l / e for l, e in zip(self.length, self.young, strict=True))

    def flux(self, omega):
        """Return q for a conductance."""
        if omega == 0.0:
            return 0.0
        return (self.temperature[0] - self.temperature[1]) / (self.resistance + 1 / omega)

    def separation(self, flux):
        """Return s = g0 - e for a heat flux."""
        (l1, l2), (k1, k2), (a1, a2) = self.length, self.conductivity, self.expansion
        t1, t2 = self.temperature
        slope = -a1 * l1**2 / (2 * k1) + a2 * l2**2 / (2 * k2)
        return self.gap - (a1 * l1 * t1 + a2 * l2 * t2 + slope * flux)


@dataclass(frozen=True)
class State:
    """The solution: one of gap and pressure is zero."""

    gap: float
    pressure: float
    conductance: float
    flux: float
    face_temperature: tuple[float, float]


def gas(a, b):
    """Return omega(gamma) = a/(b + gamma)."""
    return lambda gap: a / (b + gap)


def power(c0, c1, n):
    """Return omega(p) = c0 + c1 p^n."""
    return lambda pressure: c0 + c1 * pressure**n


def table(*rows):
    """Return omega of rows (omega, abscissa): linear between them, end values held outside."""
    omegas, places = zip(*rows, strict=True)

    def law(at):
        i = bisect_right(places, at)
        if i == 0 or i == len(places):
            return omegas[min(i, len(places) - 1)]
        part = (at - places[i - 1]) / (places[i] - places[i - 1])
        return omegas[i - 1] * (1 - part) + omegas[i] * part

    return law


def image(rods, open_law, closed_law):
    """Return U of eq. (2.3): conductance -> heat -> gap or pressure -> conductance by the laws."""
    def of(omega):
        s = rods.separation(rods.flux(omega))
        return open_law(s) if s > 0.0 else closed_law(-s / rods.compliance)

    return of


def passes(u, omega, tolerance, g=0.5, constant=3, method="ZAITSEV"):
    """Return the residuals |U(omega) - omega|/omega of the passes until one is within a tolerance:
    eq. (4.1), PICARD, or eq. (4.2), ZAITSEV, where no tangent reaches 1."""
    residuals, stars, images = [], [], []
    while not residuals or residuals[-1] > tolerance:
        stars.append(omega)
        images.append(u(omega))
        residuals.append(abs(images[-1] - omega) / omega)
        if method == "ZAITSEV" and len(stars) > max(constant, 1):
            tangent = (images[-1] - images[-2]) / (stars[-1] - stars[-2])
            if not tangent < 1.0:
                raise ValueError("the paper gives no g")
            g = min(1.0 / (1.0 - tangent), 1.0)
        omega = images[-1] if method == "PICARD" else (1.0 - g) * omega + g * images[-1]
    return residuals


def gain(rods, open_law, closed_law, omega):
    """Return U' by a central difference."""
    step = 1e-5 * omega
    ends = [image(rods, open_law, closed_law)(omega + k * step) for k in (-1, 1)]
    return (ends[1] - ends[0]) / (2 * step)


def solutions(rods, open_law, closed_law, count=2000):
    """Return the conductances of all solutions: changes of sign of U(omega) - omega between count
    conductances over all magnitudes, 100 a decade, each narrowed down by bisection."""
    of = image(rods, open_law, closed_law)

    def excess(omega):
        return of(omega) - omega

    found = []
    omegas = [10.0 ** (-4.0 + 20.0 * k / count) for k in range(count + 1)]
    below = [(omega, excess(omega) < 0.0) for omega in omegas]
    for (low, rises), (high, falls) in pairwise(below):
        if rises == falls:
            continue
        while low < (middle := (low + high) / 2) < high:
            low, high = (middle, high) if (excess(middle) < 0.0) == rises else (low, middle)
        found.append(middle)
    return found


@dataclass(frozen=True)
class Solution:
    """A solution: conductance, derivatives of s by it and of the law by s, which is 0 at rest, and
    s itself, the gap or how far the rods press into each other, negative."""

    conductance: float
    opening: float
    slope: float
    separation: float

    @property
    def gain(self):
        """Return U'."""
        return self.slope * self.opening


def exact_solutions(rods, a, b, touch, c):
    """Return all solutions with the laws gas(a, b) and power(touch, c, 1), by ascending
    conductance: the roots of a quadratic on either side, with 60 digits, and where the laws jump
    the state at rest.

    With y the distance b + gamma, or the conductance of a closed pair, and G = g0 - e0,

        (y - b - G)(y + a R0) + e1 (T1 - T2) a = 0,
        ((y - touch) (L1/E1 + L2/E2)/c + G)(R0 y + 1) - e1 (T1 - T2) y = 0.
    """
    with localcontext(prec=60):
        (l1, l2), (k1, k2), (a1, a2), (y1, y2), (t1, t2) = (
            [Decimal(v) for v in pair] for pair in (rods.length, rods.conductivity, rods.expansion,
                                                    rods.young, rods.temperature))
        a, b, touch, c = map(Decimal, (a, b, touch, c))
        resistance, stiff = l1 / k1 + l2 / k2, (l1 / y1 + l2 / y2) / c
        space = Decimal(rods.gap) - (a1 * l1 * t1 + a2 * l2 * t2)
        closing = (-a1 * l1**2 / (2 * k1) + a2 * l2**2 / (2 * k2)) * (t1 - t2)
        r = a * resistance
        found = [(a / y, -a / y**2, y - b) for y in roots(
            Decimal(1), r - b - space, closing * a - r * (b + space)) if y > b]
        found += [(y, -1 / stiff, (touch - y) * stiff) for y in roots(
            stiff * resistance, stiff + (space - stiff * touch) * resistance - closing,
            space - stiff * touch) if y >= touch]
        if closing * space > 0:   # at rest s = space - e1 q = 0
            y = 1 / (closing / space - resistance)
            if min(a / b, touch) < y < max(a / b, touch):
                found.append((y, Decimal(0), Decimal(0)))
        return [Solution(float(y), float(-closing / (resistance * y + 1)**2), float(slope), float(s))
                for y, slope, s in sorted(found)]


def roots(a, b, c):
    """Return the real roots of a y^2 + b y + c, Decimals."""
    discriminant = b * b - 4 * a * c
    if discriminant < 0:
        return []
    larger = -(b + discriminant.sqrt().copy_sign(b)) / 2
    return [larger / a, c / larger] if larger else [Decimal(0)] * 2


def resting(rods):
    """Return the conductance with which neither gap nor pressure is left: s = 0."""
    slope = rods.separation(1.0) - rods.separation(0.0)
    flux = -rods.separation(0.0) / slope
    return 1.0 / ((rods.temperature[0] - rods.temperature[1]) / flux - rods.resistance)


def solve(rods, open_law, closed_law):
    """Return the solution. A law that is missing is None: without the open one no heat crosses a
    gap, without the closed one a closed pair has the open value at no gap.

    The laws must be continuous at gamma = p = 0 unless the solution lies clear of it, and the
    solution must be the only one: heat leaves the rod that expands more."""

    def conductance(s):
        if s > 0.0:
            return open_law(s) if open_law else 0.0
        return closed_law(-s / rods.compliance) if closed_law else open_law(0.0)

    def excess(s):
        return s - rods.separation(rods.flux(conductance(s)))

    reach = 2 * max(abs(rods.separation(rods.flux(w))) for w in (0.0, 1e30))
    low, high = -reach, reach
    if not excess(low) < 0.0 < excess(high):
        raise ValueError("no solution is enclosed")
    while low < (middle := (low + high) / 2) < high:
        low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
    s = high if low < 0.0 < high else middle
    omega = conductance(s)
    flux = rods.flux(omega)
    faces = (rods.temperature[0] - flux * rods.length[0] / rods.conductivity[0],
             rods.temperature[1] + flux * rods.length[1] / rods.conductivity[1])
    return State(max(s, 0.0), max(-s, 0.0) / rods.compliance, omega, flux, faces)
