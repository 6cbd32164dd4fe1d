"""A body with a round face on a block, everything drawn, for the decks of judged_families."""

import zlib
from dataclasses import dataclass

import numpy as np
from drawn_decks import log_uniform
from new_families import Mesh
from physics import material, mesh

FINE = 1.0      # abscissa up to which elements at the contact are even
BASE = 100001   # number of the first node of the lower body


@dataclass(frozen=True)
class JudgedDeck:
    """A deck, its interfaces, whether the path to its loads matters, how many times its faces alone are
    divided, the largest values of bodies that have a limit (number of the body, quantity, and centre and
    radius of the circle where it is, or None), whether contact ends at corners, where pressure has none,
    values of the model or of nodes that are judged as checks (quantity, what *VERIFY calls it, node
    or 0), and true values from elsewhere: a function that returns pairs of value and accuracy for
    each step, by place and quantity."""

    family: str
    name: str
    text: str
    faces: tuple
    has_path: bool
    own_levels: int = 0
    maxima: tuple = ()
    has_corners: bool = False
    checks: tuple = ()
    exact: object = None


class Joint:
    """A body UP with a round face on a block LOW, in half of a plane or axisymmetric model, or in a whole one
    that is sheared. It is drawn step by step; what is left of it is written by `deck`."""

    def __init__(self, family, seed, is_whole=False, kinds=("8", "8"), part=1.0, pairing="NODES", most=17, rounds=0.4):
        self.family, self.seed = family, seed
        self.draw = np.random.default_rng([seed, zlib.crc32(family.encode())])
        self.is_whole = is_whole
        self.is_round = not is_whole and self.draw.uniform() < rounds
        self.kinds = [("CAX" if self.is_round else "CPE") + kind for kind in kinds]
        self.grid = Mesh(kinds[0], int(self.draw.integers(6, most)), 1, pairing, part)
        self.pairing, self.slave = pairing, ("UP", "LOW")[self.draw.integers(2)]
        self.width, self.depth, self.height = self.draw.uniform((3.0, 2.5, 1.5), (5.0, 4.0, 3.0))
        self.young = 1e5 * np.array([log_uniform(self.draw, 0.4, 2.5) for _ in range(2)])
        self.poisson = self.draw.uniform(0.15, 0.4, 2)
        self.expansion = [log_uniform(self.draw, 0.5e-5, 2e-5) for _ in range(2)]
        self.conductivity = [log_uniform(self.draw, 0.02, 0.2) for _ in range(2)]
        self.friction = 0.0 if self.draw.uniform() < 0.3 and not is_whole else log_uniform(self.draw, 0.05, 0.4)
        self.radius = log_uniform(self.draw, 30.0, 300.0)
        self.counts = [int(count) for count in self.draw.integers(2, 13, 3)]
        self.columns = {name: self.corners(self.width, name != self.slave) for name in ("UP", "LOW")}
        self.flat = 0.0
        if self.draw.uniform() < 0.3:
            even = self.columns["UP"][self.columns["UP"] > 1e-9]
            self.flat = float(even[np.argmin(np.abs(even - self.draw.uniform(0.3, 0.6) * FINE))])
        self.down = self.draw.uniform(1.2, 3.5) * (FINE - self.flat) ** 2 / (2 * self.radius)
        self.is_moved = is_whole or self.draw.uniform() < 0.6
        self.cards, self.law, self.held, self.steps = [], [], [], []
        self.laws = {}        # cards behind the elasticity of bodies
        self.top = "UP.TOP"   # what the loads act on

    def corners(self, end, is_master):
        """Return abscissae of corners."""
        spacing = FINE / self.grid.sides
        found = self.grid.corners(0.0, FINE, spacing, end, False, is_master)
        return np.concatenate([-found[:0:-1], found]) if self.is_whole else found

    def rows(self, name, height):
        """Return heights of corners above the face, the larger the farther."""
        return self.grid.corners(0.0, *[np.diff(self.columns[name]).min()] * 2, height)

    def face(self, x):
        """Return the height of the round face."""
        return max(0.0, abs(x) - self.flat) ** 2 / (2 * self.radius)

    def upper(self):
        """Add the body with the round face."""
        self.cards += mesh("UP", self.columns["UP"], self.rows("UP", self.height), self.kinds[0],
                           to=lambda x, y: (x, y + self.face(x) * (1 - y / self.height)))

    def lower(self):
        """Add the block."""
        self.cards += mesh("LOW", self.columns["LOW"], -self.rows("LOW", self.depth)[::-1], self.kinds[1], BASE)

    def materials(self, names=("UP", "LOW"), **more):
        """Add materials; more properties are lists of one value for each body."""
        for k, name in enumerate(names):
            given = {"elastic": (self.young[k], self.poisson[k]), "expansion": self.expansion[k],
                     "conductivity": self.conductivity[k]} | {key: values[k] for key, values in more.items()}
            cards = material(name, **given)
            self.cards += [*cards[:3], *self.laws.get(name, ()), *cards[3:]]
        self.cards += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", *(f"{name}, 0." for name in names)]

    def conductance(self, times=1.0):
        """Add a conductance without a jump, that grows with the pressure."""
        closed = log_uniform(self.draw, 0.3, 10.0) * min(self.conductivity) / FINE
        growth, length = closed * log_uniform(self.draw, 1e-3, 1e-1) * times, log_uniform(self.draw, 1e-3, 1e-2)
        self.law += ["*GAP LAW, TYPE=GAS", f"{closed * length:.9g}, {length:.9g}", "*GAP LAW, TYPE=POWER",
                     f"{closed:.9g}, {growth:.9g}, {self.draw.uniform(0.8, 1.0):.6g}"]

    def interact(self, surfaces=("UP.BOTTOM", "LOW.TOP")):
        """Add the interface, with the slave that is drawn."""
        pair = surfaces if self.slave == "UP" else surfaces[::-1]
        self.cards += ["*SURFACE INTERACTION, NAME=FACES", *self.law]
        self.cards += ["*FRICTION", f"{self.friction:.6g}"] if self.friction else []
        self.cards += [f"*CONTACT PAIR, INTERACTION=FACES, NAME=FACE, PAIRING={self.pairing}", ", ".join(pair)]

    def hold(self, bodies=("UP", "LOW")):
        """Hold the foot, and the line of symmetry."""
        self.held = ["*BOUNDARY", "LOW.BOTTOM, 2, 2"]
        self.held += ["LOW.BOTTOM, 1, 1"] if self.is_whole or self.draw.uniform() < 0.5 else []
        self.held += [] if self.is_whole else [f"{name}.LEFT, 1, 1" for name in bodies]

    def step(self, analysis, *cards, period=1.0, more=1):
        """Add a step of a number of increments that is drawn, or that number times more."""
        count = self.counts[len(self.steps) % 3] * more
        self.steps.append(["*STEP, INC=10000", f"{analysis}, DIRECT", f"{period / count!r}, {period!r}", *cards,
                           "*NODE FILE, FREQUENCY=0", "U", "*END STEP"])

    def press(self, times=1.0):
        """Add a step in which a displacement or a pressure acts."""
        if self.is_moved:
            self.step("*STATIC", "*BOUNDARY", *([f"{self.top}, 1, 1, 0."] if self.is_whole else []),
                      f"{self.top}, 2, 2, {-self.down * times:.9g}")
            return
        moduli = self.young / (1 - self.poisson**2)
        # Of half a cylinder between half-spaces, spread over the top.
        size = 0.04 * np.pi * moduli.prod() / moduli.sum() * self.down / self.width * (0.6 if self.is_round else 1.0)
        size *= 2 * times
        if self.top == "UP.TOP":
            self.step("*STATIC", "*DSLOAD", f"{self.top}, P, {size:.9g}")
        else:
            area = self.width * (np.pi * self.width if self.is_round else 1.0)
            self.step("*STATIC", "*CLOAD", f"{self.top}, 2, {-size * area:.9g}")

    def heat(self):
        """Add a step in which one side is heated."""
        rise = self.draw.uniform(0.2, 0.7) * self.down / (
            0.5 * self.expansion[0] * self.height + 0.5 * self.expansion[1] * self.depth)
        hot, cold = ((self.top, "LOW.BOTTOM"), ("LOW.BOTTOM", self.top))[self.draw.integers(2)]
        self.step("*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "*BOUNDARY",
                  f"{hot}, 11, 11, {rise:.9g}", f"{cold}, 11, 11, 0.")

    def shear(self):
        """Add a step in which the upper body moves along, about as far as friction lets it."""
        along = self.draw.uniform(0.4, 2.0) * self.friction * self.down
        self.step("*STATIC", "*BOUNDARY", f"{self.top}, 1, 1, {along:.9g}")

    def loaded(self, is_heated):
        """Add the steps: pressed, then heated or sheared or unloaded in part, or nothing."""
        self.press()
        if is_heated:
            self.heat()
        elif self.is_whole:
            self.shear()
        elif self.draw.uniform() < 0.5:
            self.press(self.draw.uniform(0.3, 0.8))

    def deck(self, has_path=False, **more):
        """Return the deck."""
        cards = [*self.cards, *self.held, *(card for step in self.steps for card in step)]
        return JudgedDeck(self.family, f"{self.family} {self.seed}", "\n".join(cards) + "\n", **{
            "faces": ("FACE",), "has_path": bool(self.friction) or has_path} | more)
