"""Runs of two rods between walls, many in a batch, by every method."""

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
UNITS = 64   # in the last place that displacements are wrong by, where elements are square


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

    def allowed(self, solution):
        """Return the error of a conductance that residual and rounding explain, relative."""
        both = self.rods
        hottest = max(abs(t) for t in both.temperature)
        moves = max(abs(both.gap), *(a * l * hottest for a, l in
                                     zip(both.expansion, both.length, strict=True)))
        # Elements are stiffer across than along by the square of their length over their width.
        loss = (self.slender * max(both.length) / min(both.length)) ** 2
        wrong = UNITS * EPSILON * loss * moves
        if solution.slope == 0.0:   # at rest gap and pressure are what is left
            rest = 2 * (self.tolerance * moves + wrong)
            return rest / abs(solution.opening * solution.conductance)
        rounding = wrong * abs(solution.slope) / solution.conductance
        return 2 * (self.tolerance + rounding) / min(abs(1 - solution.gain), 1)


@dataclass(frozen=True)
class Outcome:
    """What a run found; no conductance where the method did not converge."""

    passes: int = 0
    conductance: float | None = None
    gain: float | None = None


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
            omega, flux = (file[f"contact/FACE/{n}"][-1] for n in ("conductance", "heat_flux"))
            weight = file["contact/FACE/weight"][()]
            # Heat by mean jump: pairs that rest may share out their heat in many ways.
            omega = weight @ flux / (weight @ (flux / omega))
            found.append(Outcome(int(file["history/iterations"][-1]), float(omega),
                                 float(file["history/coupling_gain"][-1])))
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
