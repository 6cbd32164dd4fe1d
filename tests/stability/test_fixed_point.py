"""The fixed point of the conductance: every method on rods with known answers and on the cylinder."""

from collections import Counter
from dataclasses import dataclass

import numpy as np
import report
from cylinder_runs import DECKS, OPEN_LAW, difference, resting, solve
from report import Table, verdict
from rod_cases import COUNT, HARD, JUMPING, known_case, random_cases, steep_cases
from rod_equations import solves
from rod_runs import MAXITER, METHODS, PLAIN, Case, attracts, landed, outcomes
from test_known_rods import RODS

from rods import Rods

TITLE = "Fixed point of the conductance"
TEXT = """
NEWTON, the default, finds a solution in every case: rods whose solutions are known in closed form
with 60 digits, 10,000 random rods whose conductance jumps where they touch, and all increments of
the published cylinder and its strongly coupled twin on three meshes. It takes three passes
(iterations) an increment on the cylinder, up to 22 on the twin. The other methods fail in 5 to 13 %
of the cases, where the coupling is strong. Where methods find a solution, all find the same to
1e-8, also from other starts (FROM=OPEN, FROM=CLOSED).
"""
DETAILS = f"""
Every method solves omega = U(omega); "relaxed 0.5" is (4.2) with the constant g = 0.5. Only NEWTON must not give up; the others may, with a message, after {MAXITER} passes (iterations) on the rods and 50 on the
cylinder. What a method finds must be a solution. (4.1) converges only if |U'| < 1, and with g = 0.5 only if |0.5 + 0.5 U'| < 1: on R2 both cycle without end, which counts as `pass`.

All solutions of the rods are known in closed form, with 60 digits: roots of quadratics, and the state at rest where laws jump (`tests/reference/rods.py`). Where laws jump, contact points across one
end may also be in different states, which the closed forms do not cover; such states are counted as "unlike" and must satisfy the equations of both rods, assembled independently
(`tests/stability/rod_equations.py`). Errors are relative errors of omega. "Error of what is allowed" is their share of 2 (TOL + rounding)/min(|1 - U'|, 1), where rounding is that of the
displacements in omega. `tests/decks/test_coupling_gain.py` compares `coupling_gain` with finite differences of U.
"""
IN_DOCUMENT = ["The default"]
BRANCHES = "open", "middle", "closed"
ON_CYLINDER = tuple(METHODS)[:4]
SAME = 1e-6


@dataclass(frozen=True)
class Extent:
    """How much is run: each n-th of the steep laws and so many random rods by methods that may give
    up; random rods by NEWTON, and jumping ones; refinements of the cylinder, also with a jump; and
    the most increments."""

    steep: int
    rods: int
    by_newton: int
    jumping: int
    levels: tuple[int, ...]
    jump_levels: tuple[int, ...]
    increments: int


WHOLE = Extent(1, COUNT, COUNT, JUMPING, (0, 1, 2), (0, 1), 450)
TESTED = Extent(5, 6, 10, 10, (0,), (0,), 45)


class Tally:
    """Cases that each method tried, those it solved, and their passes."""

    def __init__(self):
        """Start without cases."""
        self.tried, self.solved, self.passes = Counter(), Counter(), Counter()

    def add(self, method, tried, passes):
        """Count cases, with the passes of those that were solved."""
        self.tried[method] += tried
        self.solved[method] += len(passes)
        self.passes[method] += int(sum(passes))


def known_rods(folder, tally):
    """Return the table of R1 to R3."""
    table = Table("Rods with known answers", ["rod", "U'", *METHODS, "largest error", "verdict"],
                  text="Passes of each method, TOL=1e-11. R3 starts near each of its three "
                       "solutions; where a method ends at another one, this is named. A method must "
                       "find the solution, unless the solution repels it: then it must not. (4.2) "
                       "promises nothing where U' > 1.")
    for name in RODS:
        case = known_case(name)
        every = case.solutions()
        wanted = every[BRANCHES.index(name[3:])] if name.startswith("r3") else every[0]
        cells, worst, right = [], 0.0, True
        for method in METHODS:
            (outcome,) = outcomes(folder / f"{name}-{method}", [case], method)
            repels = method in PLAIN and not attracts(method, wanted.gain)
            free = repels or (method == "ZAITSEV" and wanted.gain > 1)
            cell, holds = "cycles", free
            if outcome.conductance is not None:
                solution, error = landed(case, outcome)
                cell = str(outcome.passes)
                if solution != wanted:
                    cell += f", {BRANCHES[every.index(solution)]}"
                worst = np.maximum(worst, error)   # NaN where any is
                holds = error <= case.allowed(solution) and (
                    solution != wanted if repels else free or solution == wanted)
            if wanted.gain < 1:
                tally.add(method, 1, [outcome.passes] if outcome.passes else [])
            cells.append(cell)
            right = right and holds
        label = name.upper() if len(every) == 1 else f"R3, {name[3:]}"
        table.rows.append([label, wanted.gain, *cells, float(worst), verdict(right)])
    return table


GROUP = ["method", "cases", "failures", "passes, mean", "95 %", "largest", "U', lowest",
         "unlike", "error of what is allowed", "verdict"]


def group(folder, cases, method, tally):
    """Return what one method makes of cases, a row with its verdict."""
    passes, gains, unlike, worst, right = [], [], 0, 0.0, True
    for case, outcome in zip(cases, outcomes(folder, cases, method), strict=True):
        if outcome.conductance is None:
            right = right and method != "NEWTON"
            continue
        solution, error = landed(case, outcome)
        passes.append(outcome.passes)
        gains.append(solution.gain)
        if outcome.has_unlike_pairs and solves(case, outcome.pairs):
            unlike += 1
        else:
            worst = np.maximum(worst, error / case.allowed(solution))   # NaN where any is
        if method in PLAIN and not case.jumps:
            right = right and attracts(method, solution.gain)
    tally.add(method, len(cases), passes)
    passes.sort()
    return [method, len(cases), len(cases) - len(passes), sum(passes) / len(passes),
            passes[int(0.95 * len(passes))], passes[-1], float(min(gains)), unlike, float(worst),
            verdict(right and worst <= 1)]


def steep_laws(folder, tally, extent):
    """Return the table of ever steeper laws."""
    others = tuple(METHODS)[1:]
    table = Table("Ever steeper laws",
                  ["closed law at p = 0", "kept", "NEWTON: failures", "passes, mean", "largest",
                   "U', lowest", *(f"{method}: failures" for method in others),
                   "error of what is allowed", "verdict"],
                  text="R1, R1b and R2 with B = 1e-8, 1e-10, 1e-12 and 1e-14: 12 cases each. Where "
                       "laws jump, contact points may rest, and the other methods leave increments "
                       "to NEWTON.")
    for factor, law in ((1.0, "A/B"), (100.0, "100 A/B"), (0.01, "A/(100 B)")):
        for kept in ("A", "A/B"):
            cases = steep_cases(kept, factor)
            rows = {method: dict(zip(GROUP, group(
                folder / f"steep-{factor:g}-{kept[-1]}-{method}",
                cases if method == "NEWTON" else cases[::extent.steep], method, tally),
                strict=True)) for method in METHODS}
            newton = rows["NEWTON"]
            table.rows.append([
                law, kept, *(newton[key] for key in ("failures", "passes, mean", "largest",
                                                     "U', lowest")),
                *(rows[method]["failures"] for method in others),
                float(np.max([row["error of what is allowed"] for row in rows.values()])),
                verdict(all(row["verdict"] == verdict(True) for row in rows.values()))])
    return table


def random_rods(folder, tally, extent):
    """Return the table of random rods."""
    table = Table("Random rods", ["laws", *GROUP])
    for jumps, law in ((False, "continuous"), (True, "with a jump")):
        cases = random_cases(jumps, JUMPING if jumps else COUNT)
        newton = cases[:extent.jumping if jumps else extent.by_newton]
        if jumps:
            newton += [cases[i] for i in HARD if i >= extent.jumping]
        gains = [one.gain for case in cases for one in case.solutions()]
        several = sum(len(case.solutions()) > 1 for case in cases)
        table.text += (f"Laws {law}: {several} rods have several solutions, U' is between "
                       f"{min(gains):.3g} and {max(gains):.3g}. ")
        for method in METHODS:
            where = folder / f"random-{jumps}-{method}"
            tried = newton if method == "NEWTON" else cases[: extent.rods]
            table.rows.append([law, *group(where, tried, method, tally)])
    table.text = table.text.strip()
    return table


def cylinders(folder, tally, extent):
    """Return the tables of the cylinder and its twin, and of the same solution by other ways."""
    others = ON_CYLINDER[1:]
    starts = {f"FROM={end}": [f"*START, FROM={end}"] for end in ("OPEN", "CLOSED")}
    table = Table("Cylinder and coupled twin",
                  ["deck", "refined", "increments", "NEWTON: passes", "largest", "U', lowest",
                   "largest real", "imbalance", *others, "verdict"],
                  text="The other methods have their passes; a method that gives up does so with "
                       "exit status 2, and names the increment: `refused`.")
    other = Table("One solution by other ways",
                  ["deck", "refined", *others, *starts, "verdict"],
                  text="Gap, pressure, shear, conductance and heat flux of all contact points, in 45 "
                       "increments or up to the one at which a method gives up: largest difference "
                       "from NEWTON, relative to the largest value of each in the increment.")
    for name in DECKS:
        for levels in extent.levels:
            runs = {count: solve(folder, name, "NEWTON", levels, count)
                    for count in ((45, 9, 90, 450) if levels == 0 else (45, 9, 90))
                    if count <= extent.increments}
            whole = runs[45]
            tally.add("NEWTON", whole.increments, whole.passes)
            ways = {method: solve(folder, name, method, levels, 45, ()) for method in others}
            for method, run in ways.items():
                tally.add(method, run.increments, run.passes)
            for count, run in runs.items():
                beside = [ways[method] if count == 45 else None for method in others]
                table.rows.append(described(name, levels, run, beside))
            ways |= {start: solve(folder, name, "NEWTON", levels, 45, cards)
                     for start, cards in starts.items()}
            apart = [difference(whole, run) for run in ways.values()]
            right = np.max(apart) <= SAME and all(ways[start].solved == 45 for start in starts)
            other.rows.append([name, levels, *apart, verdict(right)])
    return [table, other]


def described(name, levels, run, beside):
    """Return the row of a run by NEWTON and of those of the other methods."""
    right, cells = run.solved == run.increments and run.imbalance < 1e-8, []
    for other in beside:
        cells.append("-")
        if other:
            cells[-1] = "refused" if other.solved < other.increments else int(other.passes.sum())
            right = right and other.imbalance < 1e-8
    return [name, levels, run.increments, int(run.passes.sum()), int(run.passes.max()),
            float(run.gain.min()), float(run.gain_max.max()), float(run.imbalance), *cells,
            verdict(right)]


def with_a_jump(folder, extent):
    """Return the table of the cylinder and its twin where they conduct only if they touch."""
    table = Table("Cylinder and coupled twin with a jump",
                  ["deck", "refined", "increments", *(f"{m}: passes" for m in ON_CYLINDER),
                   "increments with contact points at rest", "first and last at rest, s", "verdict"],
                  text="omega = 0.8 + 0.24 p closed, 0 open: every increment must have a "
                       "solution, by every method the same. A contact point at rest has neither "
                       "gap, pressure nor shear, and a conductance between 0 and 0.8; it is at the "
                       "edge of contact.")
    cases = [(name, levels, 45, ON_CYLINDER) for name in DECKS for levels in extent.jump_levels]
    if extent is WHOLE:
        cases += [(name, levels, extent.increments, ("NEWTON",)) for name in DECKS
                  for levels in extent.jump_levels]
    for name, levels, increments, methods in cases:
        runs = [solve(folder, name, method, levels, increments, (), {OPEN_LAW: ""})
                for method in methods]
        at_rest = [resting(run) for run in runs]
        rests = at_rest[0]
        ends = f"{rests[0][1]:.3g}, {rests[-1][1]:.3g}" if rests else "none"
        right = all(run.solved == increments for run in runs) and all(
            [one[:2] for one in found] == [one[:2] for one in rests] and all(
                sound for *_, sound in found) for found in at_rest)
        passes = [int(run.passes.sum()) for run in runs]
        table.rows.append([name, levels, increments, *passes,
                           *["-"] * (len(ON_CYLINDER) - len(passes)), len({i for i, *_ in rests}),
                           ends, verdict(right)])
    return table


def summary(tally):
    """Return the table that chooses the default: fewest failures, then fewest passes."""
    table = Table("The default", ["method", "cases", "failures", "passes of those solved, mean",
                                  "verdict"],
                  text="All rods above except the middle solution of R3, and all 45 increments of "
                       "the cylinder and its twin, refined 0, 1 and 2 times; increments that a "
                       "method does not reach count as failures. The default is the method with "
                       "the fewest failures, then the fewest passes.")
    rows = [[method, tally.tried[method], tally.tried[method] - tally.solved[method],
             tally.passes[method] / tally.solved[method]] for method in METHODS]
    best = min(rows, key=lambda row: (row[2] / row[1], row[3]))
    table.rows = [[*row, verdict(best[0] == "NEWTON") + ", the default" if row is best else ""]
                  for row in rows]
    return table


def tables(folder, extent=WHOLE):
    """Run all cases; return their tables."""
    tally = Tally()
    found = [known_rods(folder, tally), steep_laws(folder, tally, extent),
             random_rods(folder, tally, extent)]
    found += cylinders(folder, tally, extent)
    return [*found, with_a_jump(folder, extent), summary(tally)]


def test_fixed_point(tmp_path):
    report.check_rows(tables(tmp_path, TESTED))


def test_newton_goes_where_the_flow_does(tmp_path):
    """Heat closes the gap that it crosses: on the way J has negative eigenvalues, though not at the
    solution. Steps of Newton's method alone end at the kink of the laws for ever."""
    both = Rods((0.1426932995503629, 0.05678957688670939), (1.0543627145695347, 223.4145064701015),
                (4.3904163306229486e-05, 0.0), (4256828408.151583, 3767112319.318943),
                (-783.5291524779992, 148.54668055669367), 1.960515316790889e-05)
    a, b = 0.0005948941903041914, 2.8008134282491983e-05
    case = Case(both, a, b, a / b, 0.00015069214558152761)
    (solution,) = case.solutions()
    assert abs(solution.gain) < 0.01
    (outcome,) = outcomes(tmp_path / "rods", [case], "NEWTON")
    assert outcome.conductance is not None
    assert landed(case, outcome)[1] <= case.allowed(solution)
    assert outcome.passes <= 50


def test_pairs_in_unlike_states_must_satisfy_the_equations(tmp_path):
    """Of the pairs of a rod's end the middle one is pressed, the others are open: what the program
    finds satisfies the equations assembled anew, and nothing else does."""
    case = random_cases(True, 191)[190]
    (outcome,) = outcomes(tmp_path / "rods", [case], "NEWTON")
    assert outcome.has_unlike_pairs
    assert solves(case, outcome.pairs)
    for name, values in outcome.pairs.items():
        for k in np.flatnonzero(values):
            wrong = values.copy()
            wrong[k] = 1.5 * values[k] + (name == "gap") * 10 * case.gap_allowed
            assert not solves(case, {**outcome.pairs, name: wrong}), (name, k)
