"""The options of post/compare."""

import argparse

from ..errors import UserError
from .match import METHODS
from .series import AXES

SUMMARY = """Compares result A with each B: another result, a CSV file, a CalculiX .frd or .dat
file, or a print file with fixed columns that a template describes. Rows are matched by key (time,
node, contact), by coordinate, or along a curve, never by line. What only one has is counted."""

EPILOG = """A row is within tolerance where |a - b| <= ABS + REL |b| + BLOCK max |b|; the maximum is
over the rows of one quantity at one time, or over a history. B is the reference. States (status,
closed) are compared by counting mismatches.

Quantities of a result: /history and the sums and edges of /contact, with @CONTACT behind their name
where there are several contacts; the states of pairs; U1 U2 NT S11 S22 S33 S12 MISES HFL1 HFL2 of
nodes. CalculiX files have the same names, RF1 RF2 RFL (sums as RF2@SET), CSHEAR1, CSLIP1, COPEN,
and contact_area, normal_force and shear_force_size of *CONTACT PRINT. Axisymmetric RF and RFL of
CalculiX are 1/180 of the whole: --map heat_in=180*RFL@TOP. Templates: see docs/compare.md.

exit status: 0 all within tolerance; 1 something is not; 2 wrong usage, a file that cannot be read,
or files that have nothing in common."""


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
    top.set_defaults(note="")  # its pictures say nothing of decks
    top.add_argument("a", metavar="A", help="result, or any file that B may be")
    top.add_argument("b", metavar="B", nargs="+", help="file to compare with")
    top.add_argument(
        "--out", default=".", metavar="DIR", help="folder for the files (default: here)"
    )
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
    shown.add_argument("--csv", action="store_true", help="write what is drawn as CSV too")
    shown.add_argument("--rows", action="store_true", help="also write every compared row")
    return top


def add_choice(group):
    """Add the options that choose quantities, times and ways to match."""
    group.add_argument(
        "--only", nargs="+", metavar="QUANTITY", help="quantities (default: all shared)"
    )
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
    group.add_argument(
        "--along",
        choices=("x", "s"),
        help="abscissa of profiles (default: x, or s where x does not grow along the face)",
    )


def add_tolerances(group):
    """Add the options that say what is within tolerance."""
    group.add_argument("--abs", type=float, default=0.0, help="absolute (default: 0)")
    group.add_argument("--rel", type=float, default=0.0, help="of the value of B (default: 0)")
    group.add_argument(
        "--block",
        type=float,
        default=1e-3,
        help="of the block's largest value of B (default: 1e-3)",
    )
    group.add_argument(
        "--tol",
        action="append",
        default=[],
        metavar="QUANTITY=abs:A,rel:R,block:M",
        help="tolerance of one quantity; what is not named is 0",
    )
    group.add_argument(
        "--mismatches",
        type=int,
        default=0,
        metavar="N",
        help="states that may differ at a time (0)",
    )
    group.add_argument(
        "--all-keys",
        action="store_true",
        help="rows, times or values that only one side has are beyond tolerance too",
    )


def check(options):
    """Raise the error for options that make no sense."""
    for name in ("abs", "rel", "block", "mismatches", "within"):
        value = getattr(options, name)
        if value is not None and not 0.0 <= value < float("inf"):
            raise UserError(f"--{name} {value}: is finite and not negative")
    for name in options.draw or ():
        if options.only and name not in options.only:
            raise UserError(f"--draw {name}: is not among --only")
