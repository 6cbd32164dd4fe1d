"""Command line of post/plot."""

import argparse
import sys
from contextlib import ExitStack
from itertools import chain

from . import (accuracy, branch, convergence, courses, edge, fields, history, mesh, profiles, style,
               trade, zones)
from .deck_changes import changed
from .errors import UserError, nearest_name, program
from .result import FACE_SOURCES, FIELD_SOURCES, MODE, Result
from .words import known_name

SUMMARY = """Pictures of a thercon result: each call writes PNG and SVG.

Files are DIR/NAME.PICTURE.png and so on, RESULT being NAME.vtkhdf; what was chosen by options
stands in the name. Axes have the units of `*OPTIONS, UNITS=`, or none."""

OF_SEVERAL = """--contact 'GAP-*' draws all interfaces whose names match: along x or y where they
follow one another, as in a rod; where they overlap in it, as in a stack, {}. All show the same
coordinate: x if it varies within every interface, else y, else the arc length s of each; --along
selects another one."""

WITH_PROFILES = """A digitised figure is a CSV file with a heading. Columns: x (or s, with --along
s) and any of pressure, shear, heat_flux, slave_temperature, master_temperature; one called load separates curves of several loads. Empty
fields are passed over, so curves need not share their x. Where friction has one sign, that of the
digitised shear is immaterial. Columns of the tables written here are passed over. """ + OF_SEVERAL.format(
    "a line for each, from light to dark in the order of the stack, at one load")

WITH_ZONES = """A digitised figure is a CSV file with a heading. Columns: load and any of
edge_contact, edge_stick, on the axis of the picture (x, or s with --along s). Empty fields are
passed over, so curves need not share their loads. """ + OF_SEVERAL.format(
    "a row for each, with its name, in the order of the stack")


class Parser(argparse.ArgumentParser):
    """A parser whose errors have the exit status of user errors."""

    def error(self, message):
        raise UserError(f"{message} (see `{self.prog} --help`)")


class Values(argparse.Action):
    """Collects a quantity and the range of its values each time."""

    def __call__(self, parser, namespace, words, option=None):
        """Add the three words, two of which are numbers."""
        if not all(map(is_number, words[1:])) or not float(words[1]) < float(words[2]):
            parser.error(f"argument {option}: {' '.join(words[1:])} is no range from LOW to HIGH")
        setattr(namespace, self.dest, [*getattr(namespace, self.dest), (words[0], *map(float, words[1:]))])


def parser():
    """Return the parser of the whole command line."""
    top = Parser(
        prog="plot", description=SUMMARY, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    top.set_defaults(note="")  # what every picture says of its deck
    pictures = top.add_subparsers(dest="picture", metavar="PICTURE", required=True)
    one = {
        "mesh": ("undeformed mesh, with a close-up of the contact", None),
        "profiles": ("pressure, friction, mu p and heat flux along the contact", WITH_PROFILES),
        "zones": ("open, slip and stick against the load", WITH_ZONES),
        "fields": ("temperature and stress on the deformed mesh", None),
        "edge": ("fields along the outline of a body, such as a free face, over the arc length", None),
        "courses": ("pressure, force, gap, temperatures and heat over time, or over the load", None),
        "history": ("nodes and elements of *NODE PRINT and *EL PRINT over time, or over the load", None),
        "branch": ("a quantity over the load factor of *CONTINUATION, unstable parts dashed", None),
        "accuracy": ("uncertainties of a requested accuracy against the cost of its rounds", None),
    }
    added = {}
    for name, (help_, epilog) in one.items():
        added[name] = add_picture(pictures, name, help_, epilog)
        several = name == "zones"
        words = "result file; several are drawn side by side" if several else "result file"
        added[name].add_argument("results", nargs="+" if several else 1, metavar="RESULT", help=words)
    several = add_picture(pictures, "convergence", "residuals, iterations and g of each increment")
    several.add_argument(
        "results", nargs="+", metavar="RESULT", help="result file; several are compared"
    )
    table = add_picture(pictures, "trade", "errors over CPU seconds of the rows of thercon trade")
    table.add_argument("table", metavar="FILE", help="NAME.trade.csv of `thercon trade`")
    for name in ("profiles", "fields", "edge"):
        add_loads(added[name])
    for name in ("profiles", "zones"):
        add_contact(added[name])
    added["profiles"].add_argument(
        "--range", nargs=2, type=float, metavar=("FROM", "TO"), help="range of the abscissa"
    )
    added["profiles"].add_argument(
        "--values", nargs=3, action=Values, default=[], metavar=("QUANTITY", "LOW", "HIGH"),
        help="range of the values of a panel, such as pressure 0 300, the same in several pictures; may "
        "be given for several",
    )
    for name in ("fields", "edge"):
        add_quantity(added[name])
    add_fields(added["fields"])
    added["edge"].add_argument(
        "--nodes", action="append", type=int, required=True, metavar="N ...",
        help="nodes of the deck on the outline: the first, the last, and others between them that the "
        "way passes; each part is the shortest",
    )
    add_name(added["courses"])
    added["history"].add_argument(
        "--set", action="append", metavar="NAME ...",
        help="node or element set, or several (default: all, a picture each)",
    )
    added["history"].add_argument(
        "--quantity", action="append", metavar="QUANTITY ...",
        help="quantity, or several, such as temperature or displacement_x, or as *VERIFY names them "
        "(default: all)",
    )
    add_name(added["branch"])
    added["branch"].add_argument(
        "--quantity",
        metavar="QUANTITY",
        help="of /contact/NAME, or peak_pressure (default: heat_rate)",
    )
    for name in ("courses", "history"):
        added[name].add_argument(
            "--over", choices=("time", "load"), help="axis of the curves: time, or the load of *OPTIONS, "
            "LOAD=, such as a prescribed displacement (default: time where heat is stored or the load "
            "turns, else the load)",
        )
    for name, axis in (("zones", "load, or of the time where it turns"), ("courses", "time")):
        added[name].add_argument("--log", action="store_true", help=f"logarithmic axis of the {axis}")
    return top


def add_picture(pictures, name, help_, epilog=None):
    """Add a sub-command with the options that all have."""
    added = pictures.add_parser(
        name, help=help_, description=help_.capitalize() + ".", epilog=epilog
    )
    added.add_argument(
        "--out", default=".", metavar="DIR", help="folder for the files (default: here)"
    )
    added.add_argument("--csv", action="store_true", help="write what is drawn as CSV too")
    return added


def add_loads(picture):
    """Add the choice of load levels."""
    picture.add_argument(
        "--load",
        action="append",
        type=float,
        metavar="LOAD ...",
        help="load level, or several, on the axis of /history/load (default: the last); where no "
        "increment has it, the nearest is drawn and named; of several that have it the last",
    )
    picture.add_argument(
        "--increment",
        action="append",
        type=int,
        metavar="N ...",
        help="increment, or several, from 1; distinguishes load levels that occur more than once",
    )


def add_contact(picture):
    """Add the choice of contact and axis, and digitised figures."""
    add_name(picture)
    picture.add_argument(
        "--along",
        choices=("x", "y", "s"),
        help="x, y or arc length s (default: x where it grows along a face that is not steep, else s; of "
        "several interfaces see below)",
    )
    picture.add_argument(
        "--with",
        action="append",
        default=[],
        dest="figures",
        metavar="FIGURE.csv",
        help="overlay a digitised figure",
    )


def add_name(picture):
    """Add the choice of contact."""
    picture.add_argument(
        "--contact", metavar="NAME", help="interface (default: all, a picture each); those that a pattern "
        "such as 'GAP-*' means are drawn in one picture"
    )


def add_quantity(picture):
    """Add the choice of fields."""
    picture.add_argument(
        "--quantity",
        action="append",
        type=field_name,
        metavar="QUANTITY ...",
        help=f"panel to draw, or several, of {', '.join(FIELD_SOURCES)}, for edge also "
        f"{', '.join(FACE_SOURCES)}, or as *VERIFY names them (default: those present of {', '.join(fields.USUAL[False])}; zz in place of yy for elements "
        f"CPEG...; in axisymmetry {', '.join(fields.USUAL[True])})",
    )


def add_fields(picture):
    """Add what only `fields` has."""
    picture.add_argument(
        "--colours",
        choices=("panel", "body"),
        default="panel",
        help="one colour scale for a panel (default), or one for each group of bodies whose ranges "
        "differ tenfold",
    )
    picture.add_argument(
        "--range",
        nargs=2,
        type=float,
        metavar=("LOW", "HIGH"),
        help="range of the colours, of panels with one unit (default: the values of 99 %% of the area; "
        "of temperatures all)",
    )
    picture.add_argument(
        "--scale",
        type=float,
        metavar="FACTOR",
        help="magnify displacements (default 1; of a mode, whose size is arbitrary, so much "
        "that it is seen); initial gaps are not magnified, so that above 1 bodies that touch seem to "
        "overlap",
    )
    picture.add_argument(
        "--region",
        choices=("model", "contact"),
        default="model",
        help="what to show (default: model)",
    )
    picture.add_argument(
        "--window",
        nargs=4,
        type=float,
        metavar=("X0", "X1", "Y0", "Y1"),
        help="show this part of the model, such as a piece of a thin tube; colours cover its values",
    )


def field_name(word):
    """Return the field that a word of the command line means."""
    if word.lower() == "mode_displacement":
        raise argparse.ArgumentTypeError(f"{word} is the shape that {MODE} is drawn on: choose that one")
    names = [*FIELD_SOURCES, *FACE_SOURCES]
    name = known_name(word, names)
    if name not in names:
        raise argparse.ArgumentTypeError(f"invalid choice: '{word}'{nearest_name(word, names)} "
                                         f"(choose from {', '.join(names)})")
    return name


def spread(arguments):
    """Write `--load 180 360 RESULT` as `--load 180 --load 360 RESULT`, and the like."""
    words, option, values = [], None, 0
    for word in chain.from_iterable(map(parted, arguments)):
        if word in SEVERAL:
            option, values = word, 0
        elif option and values and SEVERAL[option](word):
            words.append(option)
        elif option and values:
            option = None
        values += word not in SEVERAL
        words.append(word)
    return words


def parted(word):
    """Return `--load=180` as the two words `--load 180`, and the like."""
    option, _, value = word.partition("=")
    return [option, value] if value and option in SEVERAL else [word]


def is_name(word):
    """Whether a word may be the name of a quantity, misspelt or not: no option and no file."""
    return not word.startswith("-") and "." not in word and "/" not in word


def is_set(word):
    """Whether a word may be the name of a set, which may have dots: no option and no result file."""
    return not word.startswith("-") and "/" not in word and not word.endswith(".vtkhdf")


def is_number(word):
    """Whether a word is a number."""
    try:
        float(word)
    except ValueError:
        return False
    return True


# Options that take several values -> what tells a value from the RESULT that may follow.
SEVERAL = {"--load": is_number, "--increment": is_number, "--nodes": is_number, "--quantity": is_name,
           "--set": is_set}


def run(arguments):
    """Draw what the arguments ask for; return the files written."""
    options = parser().parse_args(spread(arguments))
    style.apply()
    if options.picture == "trade":
        return trade.draw(options.table, options)
    with ExitStack() as stack:
        results = [stack.enter_context(Result(path)) for path in options.results]
        options.note = "\n".join(filter(None, map(changed, results)))
        say(options.note.splitlines())
        of_several = {"convergence": convergence, "zones": zones}
        of_one = {"mesh": mesh, "profiles": profiles, "fields": fields, "edge": edge}
        of_one |= {"accuracy": accuracy, "courses": courses, "branch": branch}
        of_one |= {"history": history}
        if options.picture in of_several:
            written = of_several[options.picture].draw(results, options)
        else:
            written = of_one[options.picture].draw(results[0], options)
        say(chain(*(result.notes for result in results)))
        return written


def say(notes):
    """Print notes on stderr."""
    for note in notes:
        print(f"plot: note: {note}", file=sys.stderr)


@program("plot")
def main(arguments):
    """Run the command line; return the exit status."""
    print("".join(f"{path}\n" for path in run(arguments)), end="")
    return 0
