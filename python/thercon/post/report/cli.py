"""Command line of post/report."""

import argparse
from pathlib import Path

from ..errors import UserError, program
from ..result import Result
from .page import page

SUMMARY = """Writes DIR/NAME.html, RESULT being NAME.vtkhdf: one page with the summary, the contact
and the fields at every load, the history, the checks, the warnings and the deck. It needs no
other file and no network. Checks and warnings are those of the listing NAME.lst beside the
result."""


class Parser(argparse.ArgumentParser):
    """A parser whose errors have the exit status of user errors."""

    def error(self, message):
        raise UserError(f"{message} (see `{self.prog} --help`)")


def parser():
    """Return the parser of the command line."""
    found = Parser(prog="report", description=SUMMARY)
    found.add_argument("result", metavar="RESULT", help="result file")
    found.add_argument(
        "--out", default=".", metavar="DIR", help="folder for the page (default: here)"
    )
    return found


def write(text, folder, name):
    """Write the page as folder/name.html; return its path."""
    path = Path(folder) / f"{name}.html"
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as reason:
        raise UserError(f"{path}: cannot be written ({reason})") from None
    return path


@program("report")
def main(arguments):
    """Run the command line; return the exit status."""
    options = parser().parse_args(arguments)
    with Result(options.result) as result:
        print(write(page(result), options.out, result.name))
    return 0
