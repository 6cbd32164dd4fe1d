"""Random rods in a row between two walls, and a scan for all of their steady states.

Rods face each other across one or two contacts. Half rods number from the hot wall; the half rods on
both sides of a contact j are 2j and 2j + 1, and those of one rod meet where it is held. One heat flux
q per area crosses all, and contact j has the opening z: its gap, or minus the overlap that its
pressure takes up. At the load factor t, with the far temperatures t T0 and t T1,

    q (R + sum of 1/omega_j(z_j)) = t (T0 - T1),      z_j = g_j - sum of a L (mean temperature)

over both half rods. The mean temperatures of the first contact follow from T0, q and omega_0, those of the last from T1, q
and its omega: the opening of the first contact gives q, q the conductance of the last one, that its
opening, and this q again. A scan over the first opening finds all solutions."""

import numpy as np
from scipy.optimize import brentq

YOUNG, WIDTH = 2e11, 0.05


class Rods:
    """A random row of rods."""

    def __init__(self, seed):
        random = np.random.default_rng(seed)
        self.contacts = int(random.integers(1, 3))
        halves = 2 * self.contacts
        self.length = random.uniform(0.05, 0.15, halves)
        self.conductivity = random.uniform(10.0, 40.0, halves)
        # Mostly the cold half rods expand more: heat closes the gap that it crosses.
        even = random.choice([0.0, 3e-6, 15e-6], self.contacts, p=[0.6, 0.3, 0.1])
        odd = random.choice([8e-6, 15e-6, 25e-6], self.contacts)
        self.expansion = np.stack([even, odd], axis=1).ravel()
        self.far = np.array([random.uniform(300.0, 900.0), random.choice([0.0, 50.0])])
        # Parts of what the half rods expand by in perfect contact.
        fall = self.length / self.conductivity
        means = self.far[0] - np.ptp(self.far) * (np.cumsum(fall) - fall / 2) / fall.sum()
        expands = (self.expansion * self.length * means).reshape(-1, 2).sum(axis=1)
        self.gap = random.uniform(0.6, 1.1, self.contacts) * expands
        self.offset = self.gap * 10.0 ** random.uniform(-2.0, -0.7, self.contacts)   # B of the gas
        self.touching = 10.0 ** random.uniform(2.0, 4.0, self.contacts)              # A/B
        self.slope = 10.0 ** random.uniform(-5.5, -3.5, self.contacts)
        self.far *= 1.5

    def omega(self, j, z):
        """Return the conductance of contact j with the opening z."""
        halves = slice(2 * j, 2 * j + 2)
        pressure = np.maximum(-z, 0.0) * YOUNG / self.length[halves].sum()
        gas = self.touching[j] * self.offset[j] / (self.offset[j] + np.maximum(z, 0.0))
        return np.where(z > 0.0, gas, self.touching[j] + self.slope[j] * pressure)

    def flux(self, j, z, t):
        """Return the flux that contact j has with the opening z, from the temperature of the wall
        on its side and its own omega."""
        near, beyond = (0, 1) if j == 0 else (3, 2)
        r, a = self.length / self.conductivity, self.expansion * self.length
        wall, sign = (self.far[0], 1.0) if j == 0 else (self.far[1], -1.0)
        falls = a[near] * r[near] / 2 + a[beyond] * (r[near] + 1 / self.omega(j, z) + r[beyond] / 2)
        return sign * (z - self.gap[j] + (a[near] + a[beyond]) * t * wall) / falls

    def state(self, z, t):
        """Return flux, openings, and what the last contact lacks, where the first opens by z."""
        q = self.flux(0, z, t)
        drop = t * (self.far[0] - self.far[1]) - q * (self.length / self.conductivity).sum()
        drop = drop - q / self.omega(0, z)
        if self.contacts == 1:
            return q, (z,), drop
        omega = q / drop
        last = self.opening(1, omega)
        return q, (z, last), np.where(omega > 0.0, self.flux(1, last, t) - q, np.nan)

    def opening(self, j, omega):
        """Return the opening with which contact j has a conductance."""
        pressure = (omega - self.touching[j]) / self.slope[j]
        closed = -pressure * self.length[2 * j:2 * j + 2].sum() / YOUNG
        return np.where(pressure > 0.0, closed, self.offset[j] * (self.touching[j] / omega - 1.0))

    def solutions(self, t, z=None):
        """Return all states at a load factor, of openings z of the first contact where these are
        given: rows of q and the openings."""
        if z is None:
            fine = np.geomspace(1e-9, 30.0, 40001) * self.gap[0]
            z = np.concatenate([-fine[::-1], [0.0], fine])
        with np.errstate(all="ignore"):
            lacks = self.state(z, t)[2]
            found = []
            for k in np.flatnonzero(lacks[:-1] * lacks[1:] <= 0.0):
                root = brentq(lambda x: float(self.state(x, t)[2]), z[k], z[k + 1], xtol=1e-20)
                if abs(self.state(root, t)[2]) < 1e-3 * abs(lacks[k:k + 2]).max():   # no pole
                    q, openings, _ = self.state(root, t)
                    found.append([q, *openings])
        return np.array(sorted(found))

    def cards(self, *, first, continuation, start=()):
        """Return the deck: the branch from a first load factor on."""
        lines = ["*HEADING", "Random rods in a row", "*OPTIONS, ERRORS=NO"]
        y, number, held = 0.0, 0, []
        for i in range(2 * self.contacts):
            bottom = y - float(self.length[i])
            top = held[-1] if i and i % 2 == 0 else None
            nodes = {}
            for row, height in enumerate((y, (y + bottom) / 2, bottom)):
                for column in (0, 1, 2):
                    if (row, column) == (1, 1):
                        continue
                    if row == 0 and top:
                        nodes[row, column] = top[column]
                        continue
                    number += 1
                    nodes[row, column] = number
                    lines += ["*NODE, NSET=ALL", f"{number}, {column * WIDTH / 2:.17g}, {height:.17g}"]
            corners = [(2, 0), (2, 2), (0, 2), (0, 0), (2, 1), (1, 2), (0, 1), (1, 0)]
            lines += [f"*ELEMENT, TYPE=CPE8, ELSET=HALF{i}",
                      ", ".join(map(str, [i + 1, *(nodes[c] for c in corners)])),
                      f"*MATERIAL, NAME=HALF{i}", "*ELASTIC", f"{YOUNG!r}, 0.",
                      "*EXPANSION", repr(float(self.expansion[i])),
                      "*CONDUCTIVITY", repr(float(self.conductivity[i])),
                      f"*SOLID SECTION, ELSET=HALF{i}, MATERIAL=HALF{i}", repr(1.0 / WIDTH),
                      f"*SURFACE, NAME=FACE{i}", f"HALF{i}, {'S3' if i % 2 else 'S1'}"]
            held.append([nodes[2 if i % 2 else 0, column] for column in (0, 1, 2)])
            y = bottom
        for j in range(self.contacts):
            lines += [f"*SURFACE INTERACTION, NAME=LAW{j}", "*GAP LAW, TYPE=GAS",
                      f"{self.touching[j] * self.offset[j]:.17g}, {self.offset[j]:.17g}",
                      "*GAP LAW, TYPE=POWER", f"{self.touching[j]:.17g}, {self.slope[j]:.17g}, 1.",
                      f"*CONTACT PAIR, INTERACTION=LAW{j}, NAME=C{j}", f"FACE{2 * j}, FACE{2 * j + 1}",
                      f"*CLEARANCE, SLAVE=FACE{2 * j}, MASTER=FACE{2 * j + 1}, "
                      f"VALUE={self.gap[j]:.17g}"]
        lines += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 0.", *start, "*STEP",
                  "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", f"{first}, 1.",
                  continuation, "*BOUNDARY", "ALL, 1, 1, 0."]
        for nodes in held:
            lines += [f"{node}, 2, 2, 0." for node in nodes]
        for nodes, value in zip((held[0], held[-1]), self.far):
            lines += [f"{node}, 11, 11, {float(value)!r}" for node in nodes]
        return "\n".join([*lines, "*END STEP"]) + "\n"
