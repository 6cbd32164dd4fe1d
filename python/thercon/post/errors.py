"""What ends a program early, told in one line with exit status 2."""

import os
import sys
import traceback
import warnings
from difflib import get_close_matches
from functools import wraps
from pathlib import Path

FAILED = 2  # 1 is what post/compare ends with where values differ
WHOLE = "THERCON_TRACEBACK"  # set it to see where an error that is not the user's came from


class UserError(Exception):
    """A mistake in what was asked for or handed over; ends the program with status 2."""


def program(name):
    """Return the decorator of the `main` of a program: whatever goes wrong there is one line.

    `main` takes the arguments and returns the exit status.
    """

    def decorate(work):
        @wraps(work)
        def main(arguments=None):
            arguments = sys.argv[1:] if arguments is None else arguments
            for stream in (sys.stdout, sys.stderr):  # names of files may be no UTF-8
                stream.reconfigure(errors="surrogateescape")
            try:
                with warnings.catch_warnings():
                    if WHOLE not in os.environ:
                        warnings.simplefilter("ignore")  # numpy's, of values that are not finite
                    return work(arguments)
            except UserError as error:
                words = str(error)
            except MemoryError:
                words = f"{files_of(arguments)}: memory ran out"
            except Exception as error:  # noqa: BLE001  of a damaged file, or of this program
                if WHOLE in os.environ:
                    raise
                words = unexpected(error, arguments)
            print(f"{name}: error: {' '.join(words.split())}", file=sys.stderr)
            return FAILED

        return main

    return decorate


def unexpected(error, arguments):
    """Return what to say of an error that nothing foresaw: where it came from, and what to do."""
    place = traceback.extract_tb(error.__traceback__)
    own = [each for each in place if Path(each.filename).parent.is_relative_to(HERE)] or place
    at = f"{Path(own[-1].filename).name}:{own[-1].lineno}"
    return (f"{files_of(arguments)}: cannot be evaluated ({type(error).__name__}: {error}, at {at}): "
            f"the file may be damaged; if it is not, {WHOLE}=1 shows what to report")


def files_of(arguments):
    """Return the arguments that are files, in words."""
    return ", ".join(each for each in arguments if os.path.isfile(each)) or "what was asked for"


HERE = Path(__file__).parent


def nearest_name(name, known):
    """Return ", nearest: 'x'" for the known name closest to `name`, or an empty text."""
    spelling = {each.lower(): each for each in known}
    matches = get_close_matches(name.lower(), spelling, n=1, cutoff=0.5)
    return f", nearest: '{spelling[matches[0]]}'" if matches else ""
