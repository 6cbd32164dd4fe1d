"""Runs of two rods between walls, many in a batch, by every method."""

import shutil
from dataclasses import dataclass

import h5py
from blocks import write
from deck_runs import run
from physics import material, mesh

import rods

MAXITER = 200
METHODS = {
    "NEWTON": "METHOD=NEWTON",
    "ANDERSON": "METHOD=ANDERSON",
    "ZAITSEV": "METHOD=ZAITSEV",
    "PICARD": "METHOD=PICARD",
    "relaxed 0.5": f"METHOD=ZAITSEV, G=0.5, CONSTANT={MAXITER}",
}
PLAIN = {"PICARD": 1.0, "relaxed 0.5": 0.5}   # their g
EPSILON = 2.0**-52
COORDINATES = 1e-15   # rounding that the program allows them, in the extent of the model
AT_ONCE = 250   # decks of one batch
UNITS = 8   # in the last place that displacements are wrong by, where elements are square


@dataclass(frozen=True)
class Case:
    """Two rods with the laws gas(a, b) and power(touch, c, 1), and where the iteration starts."""

    rods: rods.Rods
    a: float
    b: float
    touch: float
    c: float
    tolerance: float = 1e-8
    start: float | None = None
    slender: float = 16   # length of the shorter rod by its width

    @property
    def jumps(self):
        """Return whether the laws differ where the gap closes."""
        return abs(self.touch - self.a / self.b) > 1e-9 * self.touch

    def solutions(self):
        """Return all solutions in closed form."""
        return rods.exact_solutions(self.rods, self.a, self.b, self.touch, self.c)

    @property
    def moves(self):
        """Return how far the ends can move towards each other by heat, and the gap."""
        hottest = max(abs(t) for t in self.rods.temperature)
        return abs(self.rods.gap) + sum(a * l * hottest for a, l in zip(
            self.rods.expansion, self.rods.length, strict=True))

    @property
    def rounding(self):
        """Return what the rounding of displacements and of coordinates makes of a gap. Elements
        resist more across than along by the square of their length over their width, and one rod
        more than the other, to forces or to heat."""
        def ratio(values):
            return max(values) / min(values)

        def of_rods(constants):
            return ratio([c / l for c, l in zip(constants, self.rods.length, strict=True)])

        resists = max(of_rods(self.rods.young), of_rods(self.rods.conductivity))
        slenderness = self.slender * ratio(self.rods.length)
        return slenderness**2 * (UNITS * EPSILON * resists * self.moves
                                 + COORDINATES * sum(self.rods.length))

    @property
    def gap_allowed(self):
        """Return the error of a gap that residual and rounding explain."""
        return 2 * (self.tolerance * self.moves + self.rounding)

    def allowed(self, solution):
        """Return the error of a conductance that residual and rounding explain, relative."""
        rounding = self.rounding * abs(solution.slope) / solution.conductance
        error = 2 * (self.tolerance + rounding) / min(abs(1 - solution.gain), 1)
        if self.jumps and abs(solution.separation) <= self.gap_allowed:
            # The pair is at rest, or as good as: gap and pressure are what is left.
            error += self.gap_allowed / abs(solution.opening * solution.conductance)
        return error


@dataclass(frozen=True)
class Outcome:
    """What a run found; no conductance where the method did not converge. At its end, datasets of
    the pairs by their names."""

    passes: int = 0
    conductance: float | None = None
    gain: float | None = None
    pairs: dict | None = None

    @property
    def has_unlike_pairs(self):
        """Return whether some pairs are open, pressed or at rest, and others are not."""
        return len(set(zip(self.pairs["gap"] > 0, self.pairs["pressure"] > 0, strict=True))) > 1


def cards(case, method):
    """Return the deck of a case: one element a rod, of area 1, and so slender that the pairs of its
    end cannot but do the same; across wide ends they may be in different states."""
    (l1, l2), (k1, k2), (a1, a2) = case.rods.length, case.rods.conductivity, case.rods.expansion
    (e1, e2), (t1, t2) = case.rods.young, case.rods.temperature
    width = min(l1, l2) / case.slender
    start = [] if case.start is None else ["*START, FROM=GIVEN", f"FACE, {case.start!r}"]
    return ["*OPTIONS, WIDTH=200", *mesh("HOT", [0.0, width], [0.0, l1]),
            *mesh("COLD", [0.0, width], [-l2, 0.0], first=101),
            *material("HOT", (e1, 0.0), a1, k1), repr(1 / width),
            *material("COLD", (e2, 0.0), a2, k2), repr(1 / width),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HOT, 0.", "COLD, 0.",
            "*SURFACE INTERACTION, NAME=FACES",
            "*GAP LAW, TYPE=GAS", f"{case.a!r}, {case.b!r}",
            "*GAP LAW, TYPE=POWER", f"{case.touch!r}, {case.c!r}, 1.",
            "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "HOT.BOTTOM, COLD.TOP",
            f"*CLEARANCE, MASTER=COLD.TOP, SLAVE=HOT.BOTTOM, VALUE={case.rods.gap!r}",
            f"*FIXED POINT, {METHODS[method]}, MAXITER={MAXITER}, TOL={case.tolerance!r}", *start,
            "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.",
            "*NODE FILE, FREQUENCY=0", "U",
            "*BOUNDARY", "HOT, 1", "COLD, 1", "HOT.TOP, 2", "COLD.BOTTOM, 2",
            f"HOT.TOP, 11, 11, {t1!r}", f"COLD.BOTTOM, 11, 11, {t2!r}", "*END STEP"]


def outcomes(folder, cases, method):
    """Run cases by a method; return their outcomes."""
    found = []
    for first in range(0, len(cases), AT_ONCE):
        found += outcomes_at_once(folder, cases[first:first + AT_ONCE], method)
        shutil.rmtree(folder)
    return found


def outcomes_at_once(folder, cases, method):
    """Run some cases by a method; return their outcomes."""
    folder.mkdir()
    decks = [write(folder / f"case{i}.inp", cards(case, method)) for i, case in enumerate(cases)]
    process = run("run", "--quiet", *decks, "--out", folder)
    assert process.returncode in (0, 2), process.stderr
    found = []
    for deck in decks:
        result = deck.with_suffix(".vtkhdf")
        if not result.exists():
            said = [row for row in process.stderr.splitlines() if row.startswith(f"{deck}:")]
            assert any("not converge" in row for row in said), said
            found.append(Outcome())
            continue
        with h5py.File(result) as file:
            pairs = {name: file[f"contact/FACE/{name}"][-1]
                     for name in ("conductance", "heat_flux", "gap", "pressure")}
            pairs["weight"] = weight = file["contact/FACE/weight"][()]
            # Heat by mean jump: pairs that rest may share out their heat in many ways.
            flux = pairs["heat_flux"]
            omega = weight @ flux / (weight @ (flux / pairs["conductance"]))
            found.append(Outcome(int(file["history/iterations"][-1]), float(omega),
                                 float(file["history/coupling_gain"][-1]), pairs))
    return found


def landed(case, outcome):
    """Return the solution that a run found, the one that is nearest, and its relative error."""
    def error(solution):
        return abs(outcome.conductance / solution.conductance - 1)

    nearest = min(case.solutions(), key=error)
    return nearest, error(nearest)


def attracts(method, gain):
    """Return whether a solution with a gain attracts (4.1) with a constant g."""
    g = PLAIN[method]
    return abs(1 - g + g * gain) < 1
