"""docs/verification.md from decks that *VERIFY cards judge: the verification manual.

A theme is a file test_<theme>.py here, with TITLE, TEXT and cases(), which returns its cases in
order. `python tests/verification/manual.py` with THERCON set runs all meshes of all cases, or of
the themes named, and writes the document, a row for each case, and build/documents/verification.md,
a row for each value (`./setup.sh verify`). The test of a theme runs the first meshes only.
"""

import re
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from math import ceil, floor, isnan, log2, log10
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), *(str(HERE.parent / n) for n in ("documents", "decks", "reference",
                                                            "accuracy"))]

from blocks import write  # noqa: E402  its folder is made known first
from deck_runs import run  # noqa: E402
from document import Document, Picture, Table, check_verdicts, masked, verdict  # noqa: E402

PREFACE = """# Verification manual

Problems with known answers, and how far the program is from them on the finest mesh. Every value is
within its tolerance.

`./setup.sh verify` runs all meshes of all problems (some minutes), and writes this page and
`build/documents/verification.md`, which has every problem in full: data, source, tolerance and its
reason, and each value on each mesh. The verdicts are the program's own, by `*VERIFY` cards.

- `finest` is the finest mesh; a blank means that a problem has variants instead of meshes.
- `largest error` is that of all values on it, relative to the reference; `abs.` marks errors in the
  unit of the value, for references of 0 and edges of zones.
- `of allowed` is the largest ratio of an error to its tolerance. Tolerances come from theory, from
  the digits of the source or from the order of the elements, never from the program's own results.
- `order` is log2 of the ratio of the errors of that value on the two finest meshes, left out where
  errors are rounding or change their sign.
"""
RESULTANTS = ("normal_force", "shear_force", "heat_in", "heat_out")
ROUNDING = 1e-9  # errors below it have no order
THEMES = ("elements", "nafems", "contact", "friction", "heat", "bodies", "transients",
          "dilatation", "frictional_heat", "sliding", "tables", "melting", "inelastic", "stability")
DOCUMENT = Document("verification.md", HERE, THEMES, PREFACE)
HEAD = ["mesh", "quantity", "value", "reference", "error", "order", "allowed", "verdict"]
BOUND = 5  # column of the bound in tables that have one
SHORT_HEAD = ["problem", "reference", "finest", "largest error", "of allowed", "order", "verdict"]


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
    rounded: float = 0.0   # half of the last digit of the references, for bounds
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

    def exceeds(self, check, found):
        """Return whether a reference is farther from a value than its bound and its digits allow."""
        return not abs(found.value - check.value) <= found.bound + self.rounded

    def text(self):
        """Return what comes before the table."""
        parts = [f"*Problem.* {self.problem}", f"*Source.* {self.source}",
                 f"*Tolerance.* {self.tolerance}", self.remarks]
        return "\n\n".join(" ".join(part.split()) for part in parts if part)

    def cited(self):
        """Return the source without what follows its first sentence."""
        source = " ".join(self.source.split())
        return re.split(r"[:;] |(?<![A-Z])\. (?=[A-Z][\w']+ [a-z])", source)[0].rstrip(".")

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


def brief(theme, parts):
    """Return the parts of a section of the document: a row for each case, and the picture."""
    tables = {part.title: part for part in parts if isinstance(part, Table)}
    rows = [short_row(case, tables[case.title]) for case in theme.cases()]
    return [Table(theme.TITLE, SHORT_HEAD, together(rows, getattr(theme, "TOGETHER", ())), heading=False),
            *(part for part in parts if isinstance(part, Picture))]


def short_row(case, table):
    """Return the row of a case: the worst of its values on the finest mesh."""
    rows = [dict(zip(table.head, map(str, row), strict=True)) for row in table.rows]
    finest = rows[-1].get("mesh", "") if table.head[0] == case.named == "mesh" else ""
    last = [row for row in rows if row.get("mesh", "") == finest or not finest]
    allowed = [row.get("allowed", "") for row in last]
    errors = [row.get("error", row.get("largest error", "")) for row in last]
    relative = [e for e, a in zip(errors, allowed, strict=True) if e and "abs." not in a]
    absolute = [e for e in errors if e and not relative]
    shares = [(float(row["largest share of allowed"]), "") for row in rows
              if "largest share of allowed" in row]
    shares += [(float(e) / float(a.removesuffix(" abs.")), row.get("order", "") if finest else "")
               for row, e, a in zip(last, errors, allowed, strict=True) if e and a]
    share, order = max(shares, default=("", ""))
    most = max(relative or absolute, key=float, default="") + " abs." * bool(absolute)
    return [case.title, case.cited(), finest, most, f"{share:.1g}" if shares else "", order,
            verdict("FAIL" not in (r["verdict"] for r in rows))]


def together(rows, problems):
    """Return the rows with those of the variants of these problems, "problem, variant", as one: the
    largest error, and the largest share of a tolerance with its order."""
    found = []
    for row in rows:
        problem, _, variant = row[0].partition(", ")
        if problem not in problems or not found or not found[-1][0].startswith(f"{problem}, "):
            found.append(row)
            continue
        last = found[-1]
        _, _, _, error, share, order, _ = max(last, row, key=lambda one: float(one[4]))
        error = max(last[3], row[3], key=lambda one: float(one.removesuffix(" abs.")))
        found[-1] = [f"{last[0]}; {variant}", *row[1:3], error, share, order,
                     verdict("FAIL" not in (last[6], row[6]))]
    return found


def check_short(theme, folder):
    """Assert that the short form of a theme passes, and that the document has its problems."""
    parts = parts_of(theme, folder, short=True)
    check_verdicts(parts)
    DOCUMENT.check_parts([theme.TEXT])
    told = {row["problem"]: row for row in DOCUMENT.rows(theme.TITLE)}
    rows = [dict(zip(SHORT_HEAD, row, strict=True)) for row in brief(theme, parts)[0].rows]
    assert [row["problem"] for row in rows] == list(told)
    for row in rows:
        for head in ("reference", "verdict"):
            assert row[head] == told[row["problem"]][head], row
        assert masked([row["finest"]]) == masked([told[row["problem"]]["finest"]]), row


def write_document(names):
    """Run the themes named, or all, and write the document; fail where a row does."""
    for theme in DOCUMENT.present().values():
        theme.tables = partial(parts_of, theme)
        theme.brief = partial(brief, theme)
    DOCUMENT.write(names)
    failed = [line for line in DOCUMENT.complete.read_text().splitlines() if "FAIL" in line]
    if failed:
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
