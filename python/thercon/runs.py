"""Runs of decks: each is a process of the program `thercon`."""

import csv
import json
import os
import re
import shutil
import subprocess
import sysconfig
from pathlib import Path
from typing import NamedTuple

from .post.errors import nearest_name

HERE = Path(__file__).resolve().parent
VARIABLE = "THERCON"
INTERRUPTED = 5
NO_RESULT = (1, 2, 3, INTERRUPTED)  # exit statuses; with 0 and 4 all increments are solved
LINE = re.compile(r"(?P<file>.*?)(?::(?P<line>\d+):(?P<column>\d+))?: "
                  r"(?P<severity>error|warning|note): (?P<message>.*)")


class Message(NamedTuple):
    """What the program says of a deck."""

    severity: str       # error, warning or note
    message: str        # one sentence
    file: str           # as given; "table" for the one of `run_many`
    line: int | None    # from 1; None for the deck as a whole, and for a table
    column: int | None  # from 1, likewise

    def __str__(self):
        """Return it as the program prints it."""
        place = f":{self.line}:{self.column}" if self.line else ""
        return f"{self.file}{place}: {self.severity}: {self.message}"


class RunError(RuntimeError):
    """A run that did not come to its end.

    status: exit status: 1 mistakes in the deck, 2 not converged, 3 internal error or no memory,
        5 interrupted (docs/running.md).
    messages: list of `Message`: severity, message, file, line and column.
    document: all that `--json` printed, a dictionary; empty if nothing was printed. Its `files` are
        those with the increments that were solved before.

    >>> try:
    ...     thercon.run("joint.inp", out="results", presure=60)
    ... except thercon.RunError as error:
    ...     print(error.status, error.messages[0].severity, error.messages[0].message)
    1 error --set presure: no *PARAMETER of the deck has this name; the nearest known is PRESSURE
    """

    def __init__(self, deck, status, messages, document=None):
        """Take how a run ended; the errors among the messages are the text of the exception."""
        self.status, self.messages, self.document = status, messages, document or {}
        said = [each for each in messages if each.severity == "error"] or messages
        super().__init__("\n".join(map(str, said)) or f"{deck}: ended with status {status}")


def run(deck, *, out=".", accuracy=None, errors=None, limit=None, restart=None, resume=False,
        width=None, parameters=None, **values):
    """Solve a deck; return its result.

    deck: path of the deck.
    out: folder of the results, created if missing.
    accuracy, errors, limit, restart, width: values of the options of `thercon run` of these names,
        as on the command line: accuracy="1%", errors="full".
    resume: take a result of the same deck and values that is finished, and go on with one that keeps
        a state.
    All other names are those of `*PARAMETER` in the deck, in any case: a number, or a text. A
    parameter that has the name of an option above is given as `parameters={"out": 0.3}`.

    Returns a `thercon.results.Result`. With failed *VERIFY checks, and where a requested accuracy is
    not reached, it is returned, too: see `Result.status` and `Result.checks`. Raises RunError where
    the run does not come to its end.

    >>> harder = thercon.run("joint.inp", out="harder", pressure=100)
    >>> harder.summary.value["normal_force JOINT"].round(6)
    np.float64(1000.0)
    """
    from .results import Result

    options = settings(parameters, values) + options_of(
        accuracy=accuracy, errors=errors, limit=limit, restart=restart, width=width, resume=resume)
    process = execute("run", deck, "--json", "--out", out, *options)
    # A run that is ended within an increment prints no document.
    document = json.loads(process.stdout) if process.stdout.strip() else {}
    messages = messages_of(process.stderr)
    if document:
        messages = [Message(each["severity"], each["message"], each["file"], each.get("line"),
                            each.get("column")) for each in document["messages"]]
    if process.returncode in NO_RESULT or not document:
        raise RunError(deck, process.returncode, messages, document)
    return Result(result_path(deck, out), document, messages)


def run_many(deck, table, *, jobs=1, out=".", quantities=None, accuracy=None, errors=None,
             limit=None, width=None, parameters=None, **values):
    """Solve a deck with each row of a table, some at a time; return the table with the results.

    deck: path of the deck `NAME.inp`.
    table: pandas data frame, or what makes one, such as a dictionary of lists; each column is a
        *PARAMETER of the deck, each row the numbers of a run.
    jobs: runs at a time.
    out: folder of the results, which are `NAME-1.vtkhdf` and so on.
    quantities: names of the results that are wanted, such as ["heat_rate JOINT"]; None for all.
    Other options are as in `run`; parameters that are no columns are the same in all rows.

    Returns a data frame with the index and the columns of `table`, then `run` (name of the result),
    `status` (exit status), `outcome` and `reason` in words, counts and times, then the results at
    the last increment by the names of *VERIFY with their uncertainties (docs/batch.md). A row that
    fails has its status and reason, and NaN for the results. Raises RunError where nothing runs: the
    table has a mistake, told by row, from 1, and column; or the folder cannot be written. KeyError: no row has a quantity.

    Calling it again with the same rows goes on after an interruption: rows that are finished are not
    solved again. This is `thercon run DECK --table VALUES.csv --resume`.

    >>> table = thercon.run_many("joint.inp", {"pressure": [25, 50]}, jobs=2, out="results",
    ...                          quantities=["heat_rate JOINT"])
    >>> table[["pressure", "outcome", "heat_rate JOINT"]].round(6)
       pressure outcome  heat_rate JOINT
    0        25  solved              3.0
    1        50  solved              3.6
    """
    import pandas

    table = pandas.DataFrame(table)
    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    path = result_path(deck, out).with_suffix("")
    given, found = (path.with_name(f"{path.name}.{end}.csv") for end in ("values", "table"))
    found.unlink(missing_ok=True)
    table.to_csv(given, index=False)
    options = settings(parameters, values) + options_of(
        accuracy=accuracy, errors=errors, limit=limit, width=width, resume=True)
    process = execute("run", deck, "--table", given, "--jobs", jobs, "--out", out, "--quiet", *options)
    if not found.exists():
        raise RunError(deck, process.returncode, of_table(messages_of(process.stderr), given))
    frame = pandas.read_csv(found, keep_default_na=False, na_values=[""])
    frame.index = table.index
    frame[table.columns] = table
    if quantities is None:
        return frame
    facts = list(frame.columns[:list(frame.columns).index("peak_megabytes") + 1])
    for name in quantities:
        if name in frame.columns:
            facts += [each for each in (name, f"{name} uncertainty") if each in frame.columns]
        elif frame.status.isin(NO_RESULT).all():
            frame[name] = float("nan")
            facts.append(name)
        else:
            raise KeyError(f"no row has {name}{nearest_name(name, frame.columns)}")
    return frame[facts]


def find_program():
    """Return the path of the program `thercon`.

    It is that of the environment variable THERCON, else that of the environment or the installed
    tree that this package is in, else build/release/thercon of the source tree, else that on the
    PATH. Raises FileNotFoundError where there is none.
    """
    if os.environ.get(VARIABLE):
        return os.environ[VARIABLE]
    above = list(HERE.parents)
    places = [above[0] / "bin", Path(sysconfig.get_path("scripts")), above[1] / "build" / "release",
              *(each / "bin" for each in above[3:4])]
    found = [each / "thercon" for each in places if os.access(each / "thercon", os.X_OK)]
    path = next((str(each) for each in found if each.is_file()), None) or shutil.which("thercon")
    if path is None:
        raise FileNotFoundError("there is no program thercon: install it, or set the environment "
                                f"variable {VARIABLE} to its path")
    return path


def execute(*arguments):
    """Run the program; return the process that ended, with what it printed. On Ctrl-C it ends as on
    a terminal, with complete files."""
    command = [find_program(), *map(str, arguments)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                          errors="replace") as process:
        try:
            printed = process.communicate()
        except KeyboardInterrupt:
            process.terminate()
            process.communicate()
            raise KeyboardInterrupt from None  # without the frames of waiting
    return subprocess.CompletedProcess(command, process.returncode, *printed)


def settings(parameters, values):
    """Return the options --set of the parameters of a deck."""
    both = set(parameters or ()) & set(values)
    if both:
        raise TypeError(f"given twice: {', '.join(sorted(both))}")
    return [word for name, value in ((parameters or {}) | values).items()
            for word in ("--set", f"{name}={value}")]


def options_of(**options):
    """Return options of the command line, without those that are None or False."""
    return [word for name, value in options.items() if value not in (None, False)
            for word in ([f"--{name}"] if value is True else [f"--{name}", value])]


def messages_of(printed):
    """Return the messages among lines that the program printed."""
    found = filter(None, map(LINE.fullmatch, printed.splitlines()))
    return [Message(each["severity"], each["message"], each["file"],
                    *(each[key] and int(each[key]) for key in ("line", "column"))) for each in found]


def of_table(messages, path):
    """Return messages with places in the file of a table as those of rows, from 1, and columns."""
    lines = path.read_text().splitlines()
    found = []
    for each in messages:
        if each.file == str(path):
            place = ""
            if each.line:
                before = lines[each.line - 1].encode()[:each.column - 1].decode(errors="replace")
                names, cells = (next(csv.reader([line])) for line in (lines[0], before + "|"))
                row = f"row {each.line - 1}, " if each.line > 1 else ""
                place = f"{row}column {names[len(cells) - 1]}: "
            each = Message(each.severity, place + each.message, "table", None, None)
        found.append(each)
    return found


def result_path(deck, out):
    """Return the path of the result of a deck, which may be named without its ending."""
    name = Path(deck).name
    stem = name[:name.rindex(".")] if "." in name[1:] else name
    return Path(out) / f"{stem}.vtkhdf"
