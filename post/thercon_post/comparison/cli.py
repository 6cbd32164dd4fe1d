"""Command line of post/compare."""

import argparse
import sys
from contextlib import ExitStack
from pathlib import Path

from .. import style
from ..errors import UserError
from ..tables import write_table
from . import from_csv, from_frd, from_result, mapping, picture, print_file, report
from .compare import compare, listed
from .judge import Tolerance, read_tolerances
from .match import METHODS
from .series import AXES
from .template import read_template

SUMMARY = """Compares result A with each B: another result, a CSV file, a CalculiX .frd or .dat file,
or a print file with fixed columns that a template describes. Rows are matched by key (time, node,
contact), by coordinate, or along a curve, never by line. What only one side has is counted."""

EPILOG = """A row is within tolerance where |a - b| <= ABS + REL |b| + BLOCK max |b|; the maximum is
over the rows of one quantity at one time, or over a history. B is the reference. States (status,
closed) are compared by counting mismatches.

Quantities of a result: /history and the sums and edges of /contact, with @CONTACT behind their name
where there are several contacts; the states of pairs; U1 U2 NT S11 S22 S33 S12 MISES HFL1 HFL2 of
nodes. CalculiX files have the same names, RF1 RF2 RFL (sums as RF2@SET), CSHEAR1, CSLIP1, COPEN, and
contact_area, normal_force and shear_force_size of *CONTACT PRINT. Axisymmetric RF and RFL of
CalculiX are 1/180 of the whole: --map RFL@TOP=180*RFL@TOP. A template is described in docs/compare.md.

exit status: 0 all within tolerance; 1 something is not; 2 wrong usage, a file that cannot be read,
or files that have nothing in common."""

RESULT_ENDINGS = (".vtkhdf", ".hdf", ".h5", ".hdf5")


class Parser(argparse.ArgumentParser):
    """A parser whose errors have the exit status of user errors."""

    def error(self, message):
        raise UserError(f"{message} (see `compare --help`)")


def parser():
    """Return the parser of the command line."""
    top = Parser(
        prog="compare",
        description=SUMMARY,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("a", metavar="A", help="result, or any file that B may be")
    top.add_argument("b", metavar="B", nargs="+", help="file to compare with")
    top.add_argument("--out", default=".", metavar="DIR", help="folder for the files (default: here)")
    top.add_argument(
        "--template",
        action="append",
        default=[],
        metavar="FORM.toml",
        help="how the tables of print files look: of .dat files too, which are else CalculiX's",
    )
    add_choice(top.add_argument_group("what is compared"))
    add_tolerances(top.add_argument_group("tolerances"))
    shown = top.add_argument_group("what is written")
    shown.add_argument("--draw", nargs="+", metavar="QUANTITY", help="quantities in the picture")
    shown.add_argument("--no-picture", action="store_true", help="draw nothing")
    shown.add_argument("--rows", action="store_true", help="also write every compared row")
    return top


def add_choice(group):
    """Add the options that choose quantities, times and ways to match."""
    group.add_argument("--only", nargs="+", metavar="QUANTITY", help="quantities (default: all shared)")
    group.add_argument(
        "--map",
        action="append",
        default=[],
        metavar="NAME=OTHER",
        help="NAME of A is OTHER of B; also NAME=-OTHER, NAME=180*OTHER, 'NAME=2*OTHER + 3'; "
        "keys, coordinates and time as well",
    )
    group.add_argument("--contact", metavar="NAME", help="contact of A (default: all)")
    group.add_argument(
        "--at",
        nargs="+",
        type=float,
        metavar="TIME",
        help="times of pairs and nodes (default: all shared); histories are compared whole",
    )
    group.add_argument(
        "--axis", choices=AXES, help="match by time or by load (default: time where both have it)"
    )
    group.add_argument(
        "--by",
        choices=METHODS,
        help="match by key, by coordinate, or along a curve on which B is interpolated (default: "
        "by the first of these that both files allow)",
    )
    group.add_argument(
        "--within", type=float, metavar="DISTANCE", help="same place (default: 1e-6 of the model)"
    )
    group.add_argument("--along", choices=("x", "s"), help="abscissa of profiles (default: x)")


def add_tolerances(group):
    """Add the options that say what is within tolerance."""
    group.add_argument("--abs", type=float, default=0.0, help="absolute (default: 0)")
    group.add_argument("--rel", type=float, default=0.0, help="of the value of B (default: 0)")
    group.add_argument(
        "--block", type=float, default=1e-3, help="of the block's largest value of B (default: 1e-3)"
    )
    group.add_argument(
        "--tol",
        action="append",
        default=[],
        metavar="QUANTITY=abs:A,rel:R,block:M",
        help="tolerance of one quantity; what is not named is 0",
    )
    group.add_argument(
        "--mismatches", type=int, default=0, metavar="N", help="states that may differ at a time (0)"
    )
    group.add_argument(
        "--all-keys",
        action="store_true",
        help="rows, times or values that only one side has are beyond tolerance too",
    )


def open_source(path, template, stack):
    """Return the source of a file, by its ending."""
    if not Path(path).is_file():
        raise UserError(f"{path}: no such file")
    ending = Path(path).suffix.lower()
    if ending in RESULT_ENDINGS:
        return from_result.read(path, stack)
    if ending == ".frd":
        return from_frd.read(path)
    if ending == ".csv":
        return from_csv.read(path)
    if template:
        return print_file.read(path, template)
    if ending == ".dat":
        return print_file.read_calculix_dat(path)
    raise UserError(f"{path}: is no result, .frd, .dat or .csv; a print file needs --template")


def read_templates(paths):
    """Return all templates as one; None without any."""
    joined = None
    for path in paths:
        template = read_template(path)
        joined = joined.joined(template) if joined else template
    return joined


def check(options):
    """Raise the error for options that make no sense."""
    for name in ("abs", "rel", "block", "mismatches", "within"):
        value = getattr(options, name)
        if value is not None and not 0.0 <= value < float("inf"):
            raise UserError(f"--{name} {value}: is finite and not negative")
    for name in options.draw or ():
        if options.only and name not in options.only:
            raise UserError(f"--draw {name}: is not among --only")


def run(arguments):
    """Compare what the arguments name; return whether all is within tolerance."""
    options = parser().parse_args(arguments)
    check(options)
    tolerances, mappings = read_tolerances(options.tol), mapping.read_mappings(options.map)
    template = read_templates(options.template)
    usual = Tolerance(options.abs, options.rel, options.block)
    print(f"tolerance: {usual.words()}; states: {options.mismatches} mismatches at a time")
    compared, used = [], []
    with ExitStack() as stack:
        a = open_source(options.a, template, stack)
        announce("A", a)
        for path in options.b:
            b = open_source(path, template, stack)
            used += mapping.apply(b, mappings)
            announce("B", b)
            blocks = compare(a, b, options)
            for block in blocks:
                block.judge(tolerances.get(block.quantity, usual), options.mismatches)
            print("\n".join([*report.table(blocks, options.all_keys), *report.remarks(blocks, a, b, options.only)]))
            compared.append((path, blocks))
        check_used(options, mappings, used, tolerances, compared)
        write(a, compared, options)
    passed = all(report.passed(blocks, options.all_keys) for _, blocks in compared)
    print("all within tolerance" if passed else "NOT within tolerance")
    return passed


def announce(side, source):
    """Print what a file is and what its reader had to say."""
    print(f"{side}: {source.label} ({source.kind})")
    print("".join(f"  {note}\n" for note in source.notes), end="")


def check_used(options, mappings, used, tolerances, compared):
    """Raise the error for options that named something that is nowhere."""
    met = {block.quantity for _, blocks in compared for block in blocks}
    for each in mappings:
        if each not in used:
            raise UserError(f"--map: no B has a quantity or key '{each.other}'")
    for option, names in (("tol", tolerances), ("draw", options.draw), ("only", options.only)):
        for name in names or ():
            if name not in met:
                raise UserError(f"--{option} {name}: is not compared; compared are {listed(sorted(met))}")


def write(a, compared, options):
    """Write picture and tables; print their names."""
    name = f"{Path(a.label).stem}.compare"
    folder, written = Path(options.out), []
    tables = {"blocks": report.block_table}
    tables |= {"rows": report.row_table} if options.rows else {}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for kind, make in tables.items():
            path = folder / f"{name}-{kind}.csv"
            write_table(path, stack([make(label, blocks) for label, blocks in compared]))
            written.append(path)
    except OSError as reason:
        raise UserError(f"{folder}: cannot be written ({reason})") from None
    if not options.no_picture:
        style.apply()
        figure, drawn = picture.draw(a, compared, options)
        written += style.write(figure, drawn, folder, name)
    print("\n".join(map(str, written)))


def stack(tables):
    """Return tables of the same columns, of lists, as one."""
    return {name: [value for table in tables for value in table[name]] for name in tables[0]}


def main(arguments=None):
    """Run the command line; return the exit status."""
    try:
        return 0 if run(sys.argv[1:] if arguments is None else arguments) else 1
    except UserError as error:
        print(f"compare: error: {error}", file=sys.stderr)
        return 2
