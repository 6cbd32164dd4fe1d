"""Decks, runs and results of thercon from Python.

`run` solves a deck, `run_many` solves it with each row of a table of values, and `open` reads the
result of an earlier run:

>>> import thercon
>>> result = thercon.run("joint.inp", out="results")
>>> float(round(result.interface("JOINT").heat_rate[-1], 6))
3.6

Arrays are NumPy arrays, tables pandas data frames. Both packages, and h5py, are imported only when
they are needed. docs/python.md has examples.
"""

from .post.errors import UserError
from .runs import RunError, find_program, run, run_many

__all__ = ["RunError", "UserError", "find_program", "open", "run", "run_many"]


def open(path):  # noqa: A001  the builtin is not used here
    """Open the result of a run.

    path: the file `NAME.vtkhdf`, with or without that ending.

    Returns a `thercon.results.Result`. Raises UserError where there is no such file, or where it is
    damaged or no result.

    >>> thercon.open("results/joint").times.tolist()
    [0.25, 0.5, 0.75, 1.0]
    """
    from .results import Result

    return Result(path)
