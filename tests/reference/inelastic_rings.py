"""Rings about one axis between planes that do not move, which yield or creep: pressure on the bore,
temperatures and an overlap change, and the only displacement is along r. Elements have two nodes
and one point between them, and the implicit rules of Euler are solved by Newton's method. Errors
fall to a quarter where elements are halved and increments quartered, and are extrapolated.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dgtsv

DEVIATOR = np.eye(3) - 1 / 3
GRIDS = (50, 50), (100, 200), (200, 800)   # elements of each ring, increments of each step
SMALL, PASSES = 1e-8, 50                   # of the forces that are left over; passes at most


@dataclass(frozen=True)
class Ring:
    """Radii and constants of a material: yield stress and a modulus of hardening, by which the
    surface grows or moves, or a creep rate A q^n."""

    inner: float
    outer: float
    young: float
    poisson: float
    yield_stress: float = np.inf
    hardening: float = 0.0
    moves: bool = False
    rate: float = 0.0
    power: float = 1.0
    expansion: float = 0.0


@dataclass(frozen=True)
class Step:
    """What acts at the end of a step: pressure on the bore, overlap of two rings, temperatures at
    the first and last radius of the inner one, then of the outer one; or the time in which rings
    creep under it."""

    pressure: float = 0.0
    overlap: float = 0.0
    temperatures: tuple = (0.0, 0.0, 0.0, 0.0)
    time: float = 0.0


class Rings:
    """The state of one ring, or of two that touch, the inner one first."""

    def __init__(self, rings, elements):
        self.rings, self.joint = rings, elements
        radii = [np.linspace(ring.inner, ring.outer, elements + 1) for ring in rings]
        self.r = np.concatenate([radii[0], *(one[1:] for one in radii[1:])])
        self.h, self.middle = np.diff(self.r), (self.r[1:] + self.r[:-1]) / 2
        self.volume, self.of = self.middle * self.h, np.repeat(np.arange(len(rings)), elements)

        def each(name):
            return np.array([getattr(ring, name) for ring in rings], float)[self.of]

        young, poisson = each("young"), each("poisson")
        self.shear, self.bulk = young / (2 + 2 * poisson), young / (3 - 6 * poisson)
        self.limit, self.hardening = each("yield_stress"), each("hardening")
        self.moves, self.expansion = each("moves"), each("expansion")
        self.rate, self.power = each("rate"), each("power")
        # What displacements of both nodes make of strains along r and along the circumference
        self.left = np.stack([-1 / self.h, 1 / (2 * self.middle)], 1)
        self.right = np.stack([1 / self.h, 1 / (2 * self.middle)], 1)
        self.u, self.overlap, self.dissipated = np.zeros(len(self.r)), 0.0, 0.0
        self.inelastic, self.equivalent = np.zeros((len(self.h), 3)), np.zeros(len(self.h))
        self.stress = np.zeros((len(self.h), 3))

    def warmth(self, temperatures):
        """Return the temperatures of steady conduction at the middles of elements."""
        found = np.zeros(len(self.h))
        for k, ring in enumerate(self.rings):
            first, last = temperatures[2 * k:2 * k + 2]
            ratios = self.middle[self.of == k] / ring.inner, ring.outer / ring.inner
            found[self.of == k] = first + (last - first) * np.log(ratios[0]) / np.log(ratios[1])
        return found

    def strains(self):
        """Return strains along r, along the circumference and z."""
        left, right = self.u[:-1].copy(), self.u[1:]
        if len(self.rings) == 2:
            left[self.joint] += self.overlap
        found = np.zeros((len(left), 3))
        found[:, :2] = left[:, None] * self.left + right[:, None] * self.right
        return found

    def respond(self, elastic, time):
        """Return stress, its derivative by strain, the inelastic strain that is added and its
        equivalent, of the elastic strain before it is added."""
        shear, bulk = self.shear[:, None], self.bulk[:, None]
        back = (2 / 3 * self.hardening * self.moves)[:, None] * self.inelastic
        trial = 2 * shear * elastic @ DEVIATOR - back
        q = np.sqrt(1.5 * np.sum(trial**2, 1)) + 1e-300
        if time:
            p, slope = self.crept(q, time)
        else:
            size = self.limit + self.hardening * (1 - self.moves) * self.equivalent
            beyond = np.where(np.isinf(size), 0.0, np.maximum(0.0, q - size))
            p = beyond / (3 * self.shear + self.hardening)
            slope = np.where(p > 0, self.hardening / (3 * self.shear + self.hardening), 1.0)
        way = trial / q[:, None]
        added = 1.5 * p[:, None] * way
        stress = bulk * elastic.sum(1, keepdims=True) + 2 * shear * (elastic @ DEVIATOR - added)
        secant, slope = (1 - 3 * self.shear * p / q)[:, None, None], slope[:, None, None]
        turned = secant * DEVIATOR + 1.5 * (slope - secant) * way[:, :, None] * way[:, None, :]
        return stress, bulk[:, :, None] + 2 * shear[:, :, None] * turned, added, p

    def crept(self, q, time):
        """Return the creep strain in a time and the part of a change of q that stays. Newton's
        steps from above do not overshoot."""
        y, factor = q.copy(), 3 * self.shear * time * self.rate
        for _ in range(PASSES):
            grown = factor * y**self.power
            change = (y + grown - q) / (1 + self.power * grown / y)
            y = y - change
            if np.all(np.abs(change) <= 1e-14 * y):
                break
        return (q - y) / (3 * self.shear), 1 / (1 + self.power * factor * y ** (self.power - 1))

    def advance(self, pressure, overlap, temperatures, time):
        """Go on to the end of an increment."""
        self.overlap = overlap
        warm = (self.expansion * self.warmth(temperatures))[:, None] if any(temperatures) else 0.0
        for _ in range(PASSES):
            stress, tangent, added, p = self.respond(self.strains() - warm - self.inelastic, time)
            force = np.zeros(len(self.r))
            force[0] = pressure * self.r[0]
            force[:-1] -= self.volume * np.sum(self.left * stress[:, :2], 1)
            force[1:] -= self.volume * np.sum(self.right * stress[:, :2], 1)
            if self.r[0] == 0:
                force[0] = 0.0
            if np.abs(force).max() <= SMALL * self.r[-1] * np.abs(stress).max():
                break
            part, both = tangent[:, :2, :2] * self.volume[:, None, None], (self.left, self.right)
            self.u += self.solved([np.einsum("ei,eij,ej->e", a, part, b) for a in both
                                   for b in both], force)
        else:
            raise ArithmeticError("Newton's method does not converge")
        work = np.sum((stress + self.stress) / 2 * added, 1)
        self.dissipated += 2 * np.pi * np.sum(self.volume * work)
        self.stress, self.inelastic = stress, self.inelastic + added
        self.equivalent = self.equivalent + p

    def solved(self, blocks, force):
        """Return the solution of a matrix of three diagonals, by those of elements."""
        middle = np.append(blocks[0], 0.0) + np.append(0.0, blocks[3])
        if self.r[0] == 0:
            middle[0], blocks[1][0] = 1.0, 0.0
        return dgtsv(blocks[2], middle, blocks[1], force)[3]

    def follow(self, step, before, increments):
        """Go on to the end of a step, through increments that grow where rings creep, and in one
        where all stay elastic."""
        if not step.time and np.isinf(self.limit).all():
            increments = 1
        parts = np.linspace(0.0, 1.0, increments + 1)[1:]
        sizes = np.diff(step.time * parts**4, prepend=0.0)
        for part, size in zip(np.ones_like(parts) if step.time else parts, sizes, strict=True):
            self.advance(*(one + part * (other - one) for one, other in (
                (before.pressure, step.pressure), (before.overlap, step.overlap),
                (np.array(before.temperatures), np.array(step.temperatures)))), size)

    def values(self):
        """Return the displacement of the outside, the work dissipated for a height of 1, the
        largest von Mises stress of each ring, and the pressure at the joint."""
        q = np.sqrt(1.5 * np.sum((self.stress @ DEVIATOR) ** 2, 1))
        found = {"outside": self.u[-1], "dissipated": self.dissipated}
        for k in range(len(self.rings)):
            found["mises", k + 1] = largest(q[self.of == k])
        if len(self.rings) == 2:
            k = self.joint
            found["joint"] = self.volume[k] / self.r[k] * self.stress[k, :2] @ self.left[k]
        return found


def largest(values):
    """Return the largest of values at the middles of elements and, by parabolas, at both ends."""
    ends = (15 * a - 10 * b + 3 * c for a, b, c in (values[:3], values[:-4:-1]))
    return max(values.max(), *(end / 8 for end in ends))


def solved(rings, steps, elements, increments):
    """Return the values at the ends of the steps."""
    state, before, found = Rings(rings, elements), Step(), []
    for step in steps:
        state.follow(step, before, increments)
        found.append(state.values())
        before = step
    return found


def solution(rings, steps):
    """Return the values at the ends of the steps, and how accurate they are: what the last of the
    grids moves the extrapolated ones by falls to a quarter, too."""
    found = []
    for ends in zip(*(solved(rings, steps, *grid) for grid in GRIDS), strict=True):
        found.append({})
        for key in ends[0]:
            a, b, c = (end[key] for end in ends)
            value = c + (c - b) / 3
            found[-1][key] = value, abs(value - (b + (b - a) / 3)) / 3
    return found
