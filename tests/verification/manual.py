"""docs/verification.md from decks that *VERIFY cards judge: the verification manual.

A theme is a file test_<theme>.py here, with TITLE, TEXT and cases(), which returns its cases in
order. `python tests/verification/manual.py` with THERCON set runs all meshes of all cases, or of
the themes named, and writes the document (`./setup.sh verify`). The test of a theme runs the first
meshes only and compares the rows with the document, whose figures may differ in their digits.
"""

import re
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from math import ceil, floor, isnan, log2, log10
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), *(str(HERE.parent / n) for n in ("documents", "decks", "reference",
                                                            "accuracy"))]

from blocks import write  # noqa: E402  its folder is made known first
from deck_runs import run  # noqa: E402
from document import Document, Picture, Table, verdict  # noqa: E402

PREFACE = """# Verification manual

Problems with known answers, and what the program answers. Every value of this page is within its
tolerance.

| section | cases | result |
|---|---|---|
| [Elements](#elements) | manufactured solutions, thick cylinder, cantilever, Cook's membrane | every element converges with its theoretical order |
| [NAFEMS benchmarks](#nafems-benchmarks) | LE1, also of four-node elements, LE11, T1, T4 | on the finest mesh within 1 % of the targets |
| [Contact](#contact) | patch test, Hertz, NAFEMS cylinder on block, receding layer, press fit | uniform pressure to rounding; Hertz's pressures to 0.1 % |
| [Friction](#friction) | Cattaneo and Mindlin, block of Feijoo, Barbosa and Zouain | edges of stick within half a side, displacements to 3 % |
| [Heat and contact](#heat-and-contact) | walls and a slit, crack closed by heat, gas and radiation, rods, the published cylinder | closed forms of walls and rods to 1e-8; the cylinder on the mesh of the paper to 0.5 % in force and 2.5 % in heat |
| [Several interfaces, rings and cracks](#several-interfaces-rings-and-cracks) | caliper, three blocks, tubes, gas in a crack; bars, rings and press fits with free ends | uniform states to rounding; tubes, rings and the crack converge; press fits to 0.002 MPa |
| [Transients](#transients) | NAFEMS T3, walls, slabs, half-spaces and cylinders after a jump, sudden contact, a rod that touches | closed forms with the order 2 of the scheme; the finest increments to 0.01 % of the jump |
| [Heat of strains](#heat-of-strains) | plate and columns loaded at once, columns that settle, a strip's damping | closed forms of sudden loads to rounding; the others with order 2, whatever the coupling |
| [Heat of friction](#heat-of-friction) | half-spaces that rub, sliding blocks, sliding bars and half-planes that grow hot, a turning ring | heat is the work of friction to rounding; growth rates to 1 % |
| [Sliding](#sliding) | rollers, a sleeve and pads that slide by many spacings of nodes; Jaeger's moving source | Hertz's pressure to 1 % at every place, a constant one to rounding; Jaeger's temperatures to 1 % |
| [Properties over temperature](#properties-over-temperature) | slab, bar, half-spaces, cylinders, steady and warmed | rectangles with linear k(T) to rounding; transients with the order 2 of the scheme; cylinders to 0.01 % |
| [Melting](#melting) | Stefan's front for three latent heats, Neumann's of two phases, a bar that becomes solid between walls | fronts to 0.5 % of their place and half of it with each finer row; stress and plastic strain of the solid to rounding |
| [Plasticity and creep](#plasticity-and-creep) | NAFEMS's path, Hill's tube and its collapse in every element, Norton's laws, relaxing bars and press fits, Bree's plate, first yield under a cylinder | creep at constant stress to rounding; paths and relaxation with the order of the scheme; tubes, their collapse and press fits to 0.1 %, Bree's rates to 0.5 % |
| [Stability in time](#stability-in-time) | rods with three solutions and with one that oscillates, Barber's rod, sliding bars and half-planes | growth rates and periods to four digits |

`./setup.sh verify` writes this page from runs of the program. Every deck carries the reference
values and tolerances of its tables as `*VERIFY` cards, so the verdicts are the program's own; the
tests `verification_*` run the coarsest meshes of each case.

How to read the tables:

- `error` is the deviation of the value from the reference, relative to the reference; where the
  reference is 0, and for edges of zones, it is absolute, as where `allowed` says so.
- `order` is log2 of the ratio of the errors of this mesh and of the one before, which is half as
  fine. It is left out where errors are rounding, for edges of zones, whose errors change sign as
  an edge moves between two nodes, and for forces fixed by equilibrium.
- `allowed` is the tolerance on the `*VERIFY` card. It does not come from the program's own results:
  each case gives its reason.
- `bound`, in some tables, is how far the program says that the value may be off, relative to the
  reference; the row passes only if the reference is within.
"""
RESULTANTS = ("normal_force", "shear_force", "heat_in", "heat_out")
ROUNDING = 1e-9  # errors below it have no order
THEMES = ("elements", "nafems", "contact", "friction", "heat", "bodies", "transients",
          "dilatation", "frictional_heat", "sliding", "tables", "melting", "inelastic", "stability")
DOCUMENT = Document("verification.md", HERE, THEMES, PREFACE)
HEAD = ["mesh", "quantity", "value", "reference", "error", "order", "allowed", "verdict"]
BOUND = 5  # column of the bound in tables that have one


@dataclass
class Check:
    """A row of *VERIFY, and the name of its quantity in the table."""

    name: str
    quantity: str
    where: str
    value: float
    tolerance: float
    how: str = "REL"
    when: str = "LAST"

    @property
    def ordered(self):
        """Return whether its errors fall with a power of the mesh: those of edges change sign as
        an edge moves between two nodes, and resultants are those of the loads on any mesh."""
        return not (self.quantity.startswith("edge") or self.quantity == "unstable_modes"
                    or self.quantity in RESULTANTS)

    def card(self):
        """Return the data card."""
        return (f"{self.quantity}, {self.where}, {self.when}, {float(self.value)!r}, "
                f"{float(self.tolerance)!r}, {self.how}")


@dataclass
class Verdict:
    """What the listing says of a check."""

    value: float
    error: float
    passed: bool
    bound: float | None = None   # of the error of the value, in its unit


@dataclass
class Solved:
    """A deck that was run: its checks and what came of them, its result file, and the time of the
    last load that was carried where the run ended there."""

    mesh: object
    checks: list
    verdicts: list
    result: Path
    carried: float | None = None


@dataclass
class Case:
    """A problem, where its answer comes from, its tolerance and why, and its decks.

    `make(mesh)` returns the cards of a deck and its checks; `order` is the least order that the
    finest mesh may show, by the name of the quantity.
    """

    title: str
    problem: str
    source: str
    tolerance: str
    meshes: list
    make: Callable
    label: Callable = str
    kind: str = "ANALYTIC"
    cite: str = "docs/verification.md"
    order: dict = field(default_factory=dict)
    short: int = 1
    remarks: str = ""
    named: str = "mesh"  # what a row is of; without refinement rows have no order
    bounded: bool = False  # whether the program bounds the errors, and the references are within
    may_end: bool = False  # whether loads may be more than the bodies carry

    def solve(self, folder, mesh):
        """Run the deck of a mesh in a folder."""
        cards, checks = self.make(mesh)
        return solve(folder, self.file(mesh), cards, checks, mesh, self.kind, self.cite,
                     self.bounded, self.may_end)

    def file(self, mesh):
        """Return the name of the deck of a mesh."""
        return re.sub(r"[^a-z0-9]+", "_", f"{self.title}_{self.label(mesh)}".lower()).strip("_")

    def table(self, runs):
        """Return the table of these runs: the rows of a quantity follow each other."""
        table = Table(self.title, [self.named, *HEAD[1:]], text=self.text())
        if self.bounded:
            table.head.insert(BOUND, "bound")
        if self.named != "mesh":
            for solved in runs:
                for check, found in zip(solved.checks, solved.verdicts, strict=True):
                    table.rows.append(self.row(solved, check, found, None))
            return table
        for k, first in enumerate(runs[0].checks):
            errors = [solved.verdicts[k].error for solved in runs]
            orders = [None] + [order_of(*pair) if first.ordered else None
                               for pair in pairwise(errors)]
            for solved, order in zip(runs, orders, strict=True):
                table.rows.append(self.row(solved, solved.checks[k], solved.verdicts[k], order))
        return table

    def row(self, solved, check, found, order):
        """Return the row of a check."""
        least = self.order.get(check.name) if solved.mesh == self.meshes[-1] else None
        holds = found.passed and (least is None or order is None or order > least)
        cells = [self.label(solved.mesh), check.name, f"{found.value:.6g}", f"{check.value:.6g}",
                f"{found.error:.2g}", "" if order is None else f"{order:.1f}",
                f"{check.tolerance:.2g}" + (" abs." if check.how == "ABS" else ""),
                verdict(holds and not (self.bounded and self.exceeds(check, found)))]
        if self.bounded:
            cells.insert(BOUND, f"{found.bound / abs(check.value):.2g}")
        return cells

    @staticmethod
    def exceeds(check, found):
        """Return whether a reference is farther from a value than its bound."""
        return not abs(found.value - check.value) <= found.bound

    def text(self):
        """Return what comes before the table."""
        parts = [f"*Problem.* {self.problem}", f"*Source.* {self.source}",
                 f"*Tolerance.* {self.tolerance}", self.remarks]
        return "\n\n".join(" ".join(part.split()) for part in parts if part)

    def tables(self, folder, meshes):
        """Return the tables of some of the meshes, and the runs for the picture."""
        runs = [self.solve(folder, mesh) for mesh in meshes]
        return [self.table(runs)], runs


def order_of(coarse, fine):
    """Return log2 of the ratio of two errors, None where it says nothing."""
    if min(coarse, fine) < ROUNDING:
        return None
    return log2(coarse / fine)


def solve(folder, name, cards, checks, mesh=None, kind="ANALYTIC", cite="docs/verification.md",
          bounded=False, may_end=False):
    """Run a deck with its checks; return what the listing says of them.

    The exit status must be that of the verdicts: 0 where all passed, 4 where one failed; or 2, that
    of a load that is not carried, where a run may end so.
    """
    deck = write(folder / f"{name}.inp",
                 [f"*OPTIONS, WIDTH=300, ERRORS={'YES' if bounded else 'NO'}"], cards,
                 [f'*VERIFY, KIND={kind}, SOURCE="{cite}"'], [check.card() for check in checks])
    process = run("run", "--quiet", deck, "--out", folder)
    ended = may_end and process.returncode == 2
    carried = re.search(r"last load that was carried is that of time (\S+),", process.stderr)
    assert ended or process.returncode in (0, 4), f"{name}: {process.returncode}\n{process.stderr}"
    verdicts = read_verdicts(deck.with_suffix(".lst"))[-len(checks):]
    assert len(verdicts) == len(checks), f"{name}: {len(verdicts)} verdicts of {len(checks)}"
    if ended:
        assert carried, f"{name}: {process.stderr}"
    else:
        assert (process.returncode == 0) == all(v.passed for v in verdicts), name
        assert not any(isnan(v.value) for v in verdicts), name
    return Solved(mesh, checks, verdicts, deck.with_suffix(".vtkhdf"),
                  float(carried[1]) if ended else None)


def read_verdicts(listing):
    """Return what a listing says of each *VERIFY card, in the order of the deck."""
    number = r"(-?\d\.\d+E[+-]\d+|-?\d+\.?\d*|-)"
    row = re.compile(rf"{number} +{number} +{number} +{number} (REL|ABS) (PASS|FAIL)$")
    found = []
    for line in listing.read_text().splitlines():
        if match := row.search(line):
            expected, value, deviation, _, _, outcome = match.groups()
            # What is due after the end of a run has no value.
            found.append(Verdict(*(float("nan") if number == "-" else float(number)
                                   for number in (value, deviation)), outcome == "PASS"))
        elif bound := re.match(r" +found: +\S+ \+- (\S+)$", line):
            found[-1].bound = float(bound[1])
    return found


def parts_of(theme, folder, short=False):
    """Run the cases of a theme; return the parts of its section, for the short form without its
    picture."""
    parts, runs = [], {}
    for case in theme.cases():
        tables, solved = case.tables(folder, case.meshes[:case.short] if short else case.meshes)
        parts += tables
        runs[case.title] = solved
    if not short:
        parts.append(Picture(f"verification/{theme.PICTURE}.png", theme.CAPTION,
                             lambda path: draw(theme, runs, path)))
    return parts


def draw(theme, runs, path):
    """Draw the picture of a theme."""
    path.parent.mkdir(exist_ok=True)
    theme.draw(runs, path)


def check_short(theme, folder):
    """Assert that the short form of a theme passes, with the rows that the document has."""
    DOCUMENT.check_rows([p for p in parts_of(theme, folder, short=True) if isinstance(p, Table)])


def write_document(names):
    """Run the themes named, or all, and write the document."""
    for theme in DOCUMENT.present().values():
        theme.tables = lambda folder, theme=theme: parts_of(theme, folder)
    DOCUMENT.write(names)
    text = DOCUMENT.path.read_text()
    if "FAIL" in text:
        failed = [line for line in text.splitlines() if "FAIL" in line]
        sys.exit("these rows fail:\n" + "\n".join(failed))


def log_sizes(axes, sizes, label):
    """Make the axis of the meshes logarithmic, with the sizes themselves at its ticks."""
    axes.set_xscale("log")
    axes.set_xticks(sizes, [f"{size:g}" for size in sizes])
    axes.minorticks_off()
    axes.set_xlabel(label)


def errors_panel(axes, runs, title, label="fineness of the mesh"):
    """Draw the errors of all quantities of a case over its meshes, each twice as fine."""
    sizes = [2**k for k in range(len(runs))]
    for k, check in enumerate(runs[0].checks):
        if check.quantity != "unstable_modes":   # a number
            axes.semilogy(sizes, [solved.verdicts[k].error for solved in runs], marker="o",
                          label=check.name)
    axes.set_title(title)
    axes.set_ylabel("error")
    if len(runs[0].checks) == 1:
        axes.set_ylabel(f"error of {runs[0].checks[0].name}")
    else:
        axes.legend(loc="lower left")
    low, high = (log10(limit) for limit in axes.get_ylim())
    # Whole decades, so that two at least have a label; one more below where a legend needs it.
    axes.set_ylim(10 ** (floor(low) - (len(runs[0].checks) > 1)), 10 ** ceil(high))
    log_sizes(axes, sizes, label)


if __name__ == "__main__":
    # Themes import this file by its name, not as __main__.
    import manual

    manual.write_document(sys.argv[1:])
