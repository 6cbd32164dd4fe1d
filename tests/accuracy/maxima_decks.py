"""Problems with closed forms whose largest stress or temperature judges their uncertainties.

A family draws a problem from a random generator: a function of the element and the number of
elements along each side that returns the cards of its deck, and the exact maxima.
"""

import lame
import numpy as np
from physics import material, mesh, nodes_of

KINDS = ("8", "8R", "4", "4I", "6", "3")
STATIC = ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY"]
HEAT = ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY"]
END = ["*END STEP"]
COLD = ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0."]


def von_mises(x, y, z, shear=0.0):
    """Return the equivalent stress."""
    return np.sqrt(0.5 * ((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) + 3 * shear**2)


def ring(inner, outer):
    """Return the places of a quarter of a ring for the unit square."""
    def place(s, t):
        r, angle = inner + (outer - inner) * s, np.pi / 2 * t
        return tuple(0.0 if abs(v) < 1e-12 else float(v)
                     for v in (r * np.cos(angle), r * np.sin(angle)))
    return place


def block(kind, n, to=None, skew=0.0, rows=None):
    """Return the cards of n x n elements of the unit square, moved to their places."""
    return mesh("BODY", np.linspace(0, 1, n + 1), np.linspace(0, 1, (rows or n) + 1), kind,
                skew=skew / n, to=to)


def tube(rng):
    """A tube under pressures and a difference of temperatures."""
    outer, inside, outside, warm = (rng.uniform(1.3, 4), rng.uniform(0.2, 1), rng.uniform(0, 0.5),
                                    rng.uniform(-300, 300))
    poisson = rng.uniform(0.2, 0.35)
    r = np.linspace(1, outer, 2001)
    cold = lame.cylinder(r, 1.0, outer, inside, outside)
    t, radial, hoop, _ = lame.hot_tube(r, 1.0, outer, warm, 0.0, 1000.0, poisson, 1e-5, "strain")
    radial, hoop = radial + cold[0], hoop + cold[1]
    axial = lame.axial_stress(radial, hoop, poisson, "strain", 1e-5 * t, 1000.0)

    def make(kind, n):
        return [*block("CPE" + kind, n, ring(1.0, outer)),
                *material("BODY", (1000.0, poisson), 1e-5, 1.0), *COLD, "*STEP",
                "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
                "BODY.BOTTOM, 2", "BODY.TOP, 1", f"BODY.LEFT, 11, 11, {warm!r}",
                "BODY.RIGHT, 11, 11, 0.", "*DSLOAD", f"BODY.LEFT, P, {inside!r}",
                f"BODY.RIGHT, P, {outside!r}", *END]

    return make, (von_mises(radial, hoop, axial).max(), None)


def bent(rng):
    """A quarter of a ring whose ends turn (Golovin)."""
    outer, turn = rng.uniform(1.4, 3), rng.uniform(0.5, 2) * 1e-3
    b = turn * 1000.0 / (2 * np.pi)
    a, c = np.linalg.solve([[1.0, 2.0], [1 / outer**2, 2.0]],
                           [-b, -b * (1 + 2 * np.log(outer))])
    r = np.linspace(1, outer, 2001)
    radial = a / r**2 + b * (1 + 2 * np.log(r)) + 2 * c
    hoop = -a / r**2 + b * (3 + 2 * np.log(r)) + 2 * c

    def make(kind, n):
        cards = block("CPS" + kind, n, ring(1.0, outer))
        side = [f"{k}, 1, 1, {-turn * y!r}" for k, (x, y) in nodes_of(cards).items() if x == 0]
        return [*cards, *material("BODY", (1000.0, 0.3)), *STATIC, "BODY.BOTTOM, 2", *side, *END]

    return make, (von_mises(radial, hoop, 0 * r).max(), None)


def rotor(rng):
    """A disc with a bore that turns."""
    bore, poisson, speed = rng.uniform(0.1, 0.6), rng.uniform(0.2, 0.35), rng.uniform(1, 3)
    r = np.linspace(bore, 1, 4001)
    factor = (3 + poisson) / 8 * speed**2
    radial = factor * (1 + bore**2 - bore**2 / r**2 - r**2)
    hoop = factor * (1 + bore**2 + bore**2 / r**2 - (1 + 3 * poisson) / (3 + poisson) * r**2)

    def make(kind, n):
        return [*block("CPS" + kind, n, ring(bore, 1.0)),
                *material("BODY", (1000.0, poisson), density=1.0), *STATIC, "BODY.BOTTOM, 2",
                "BODY.TOP, 1", "*DLOAD", f"BODY, CENTRIF, {speed**2!r}, 0., 0., 0., 0., 0., 1.", *END]

    return make, (von_mises(radial, hoop, 0 * r).max(), None)


def hole(rng):
    """A plate with an elliptic hole (Inglis), displacements given on a confocal ellipse."""
    m, far, along = rng.uniform(0.05, 0.5), rng.uniform(2, 4), rng.random() < 0.5
    poisson, young = 0.3, 1000.0
    turn = 1.0 if along else -1.0     # exp(2 i angle of the tension)
    kappa, shear = (3 - poisson) / (1 + poisson), young / (2 * (1 + poisson))

    def omega(s):
        return s + m / s

    def phi(s):
        return (s + (2 * turn - m) / s) / 4

    def d(f, s):
        return (f(s + 1e-5) - f(s - 1e-5)) / 2e-5

    def slope(s):   # phi'/omega'
        return (1 - (2 * turn - m) / s**2) / 4 / (1 - m / s**2)

    def psi(s):   # the hole is free: phi + omega conj(phi'/omega') + conj(psi) = 0 on |s| = 1
        return -(1 / s + (2 * turn - m) * s) / 4 - (1 / s + m * s) * slope(s)

    def stress(s):
        mean = 4 * slope(s).real
        swing = 2 * (np.conj(omega(s)) * d(slope, s) + d(psi, s)) / (1 - m / s**2)
        x, y = (mean - swing.real) / 2, (mean + swing.real) / 2
        return x, y, swing.imag / 2

    def move(s):
        return (kappa * phi(s) - omega(s) * np.conj(slope(s)) - np.conj(psi(s))) / (2 * shear)

    def to(s, t):
        z = omega((1 + (far - 1) * s**1.5) * np.exp(0.5j * np.pi * t))
        return tuple(0.0 if abs(v) < 1e-12 else float(v) for v in (z.real, z.imag))

    def make(kind, n):
        cards = block("CPS" + kind, n, to)
        places = nodes_of(cards)
        side = cards[cards.index("*NSET, NSET=BODY.RIGHT") + 1:cards.index(
            "*SURFACE, NAME=BODY.RIGHT")]
        given = []
        for k in map(int, side):
            z = complex(*places[k])
            s = (z + np.sqrt(z * z - 4 * m)) / 2
            u = move(s if abs(s) > 1 else m / s)
            given += [f"{k}, 1, 1, {float(u.real)!r}", f"{k}, 2, 2, {float(u.imag)!r}"]
        return [*cards, *material("BODY", (young, poisson)), *STATIC, "BODY.BOTTOM, 2",
                "BODY.TOP, 1", *given, *END]

    ring_of = np.exp(1j * np.linspace(0, np.pi / 2, 2001))
    x, y, shear_stress = stress(ring_of)
    return make, (von_mises(x, y, 0 * x, shear_stress).max(), None)


def sphere(rng):
    """A hollow sphere under pressure."""
    outer, inside = rng.uniform(1.3, 3), rng.uniform(0.5, 2)

    def make(kind, n):
        return [*block("CAX" + kind, n, ring(1.0, outer)), *material("BODY", (1000.0, 0.3)),
                *STATIC, "BODY.BOTTOM, 2", "BODY.TOP, 1", "*DSLOAD", f"BODY.LEFT, P, {inside!r}",
                *END]

    return make, (1.5 * inside * outer**3 / (outer**3 - 1), None)


def rod(rng):
    """A solid cylinder with a source of heat, held along its axis, T = 0 outside."""
    source, poisson = rng.uniform(1, 4), rng.uniform(0.2, 0.35)
    r = np.linspace(0, 1, 2001)
    t = source * (1 - r**2) / 4
    factor = 1000.0 * 1e-3 * source / (16 * (1 - poisson))
    radial, hoop = factor * (r**2 - 1), factor * (3 * r**2 - 1)
    axial = poisson * (radial + hoop) - 1.0 * t

    def make(kind, n):
        return [*mesh("BODY", np.linspace(0, 1, n + 1), [0.0, 1.0 / n, 2.0 / n], "CAX" + kind),
                *material("BODY", (1000.0, poisson), 1e-3, 1.0), *COLD, "*STEP",
                "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
                "BODY.BOTTOM, 2", "BODY.TOP, 2", "BODY.RIGHT, 11, 11, 0.", "*DFLUX",
                f"BODY, BF, {source!r}", *END]

    return make, (von_mises(radial, hoop, axial).max(), t.max())


def warm_tube(rng):
    """A tube with a source of heat: temperatures given outside, inside too or insulated."""
    outer, source, inside = rng.uniform(1.5, 4), rng.uniform(1, 4), rng.random() < 0.5
    r = np.linspace(1, outer, 20001)
    if inside:
        slope = source / 4 * (outer**2 - 1) / np.log(outer)
        t = source * (1 - r**2) / 4 + slope * np.log(r)
    else:
        t = source * (outer**2 - r**2) / 4 + source / 2 * np.log(r / outer)

    def make(kind, n):
        given = ["BODY.LEFT, 11, 11, 0."] if inside else []
        step = (outer - 1) / n
        return [*mesh("BODY", np.linspace(1, outer, n + 1), [0.0, step, 2 * step], "CAX" + kind),
                *material("BODY", None, conductivity=1.0), *COLD, *HEAT, *given,
                "BODY.RIGHT, 11, 11, 0.", "*DFLUX", f"BODY, BF, {source!r}", *END]

    return make, (None, t.max())


def bar(rng):
    """A rectangular bar with a source of heat, T = 0 outside; a quarter."""
    high, source = rng.uniform(0.6, 1.6), rng.uniform(1, 4)
    k = (2 * np.arange(200) + 1) * np.pi / 2
    signs = (-1.0) ** np.arange(200)
    top = source * (0.5 - 2 * np.sum(signs / (k**3 * np.cosh(np.minimum(k * high, 300)))))
    skew = rng.uniform(0, 0.2)

    def make(kind, n):
        return [*mesh("BODY", np.linspace(0, 1, n + 1), np.linspace(0, high, n + 1),
                      "CPE" + kind, skew=skew / n),
                *material("BODY", None, conductivity=1.0), *COLD, *HEAT, "BODY.RIGHT, 11, 11, 0.",
                "BODY.TOP, 11, 11, 0.", "*DFLUX", f"BODY, BF, {source!r}", *END]

    return make, (None, top)


def fin(rng):
    """A plate into which heat flows on the left; films on the right and above, nothing below."""
    biot, flux, high = rng.uniform(0.5, 5), rng.uniform(1, 4), rng.uniform(0.6, 1.6)
    # T = sum of a_k cos(k y) X_k(x), k tan(k high) = biot.
    roots = []
    for i in range(400):
        low, up = (i * np.pi + 1e-12) / high, (i * np.pi + np.pi / 2 - 1e-12) / high
        for _ in range(200):
            middle = (low + up) / 2
            if middle * np.sin(middle * high) < biot * np.cos(middle * high) and i % 2 == 0 or \
               middle * np.sin(middle * high) > biot * np.cos(middle * high) and i % 2 == 1:
                low = middle
            else:
                up = middle
        roots.append(low)
    k = np.array(roots)
    share = 2 * np.sin(k * high) / (k * high + np.sin(k * high) * np.cos(k * high))
    tanh = np.tanh(k)
    at_left = flux * share / k * (k + biot * tanh) / (k * tanh + biot)

    def make(kind, n):
        return [*mesh("BODY", np.linspace(0, 1, n + 1), np.linspace(0, high, n + 1), "CPE" + kind),
                *material("BODY", None, conductivity=1.0), *COLD, *HEAT[:-1], "*DSFLUX",
                f"BODY.LEFT, S, {flux!r}", "*FILM", f"BODY.RIGHT, F, 0., {biot!r}",
                f"BODY.TOP, F, 0., {biot!r}", *END]

    return make, (None, float(at_left.sum()))


FAMILIES = {f.__name__: f for f in (tube, bent, rotor, hole, sphere, rod, warm_tube, bar, fin)}
