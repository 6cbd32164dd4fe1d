"""A branch of solutions (*CONTINUATION): a quantity over the load, stable parts full, others dashed."""

import numpy as np

from . import style
from .errors import UserError, nearest_name
from .result import words_of
from .style import plt

LOOKS = {False: {"ls": "-"}, True: {"ls": (0, (3, 2))}}
PREFERRED = ("heat_rate", "peak_pressure")


def of_branch(result):
    """Return the rows of the branch, their load factors, and which are unstable; None without
    one."""
    factor = result.history.get("load_factor")
    if factor is None or not np.isfinite(factor).any():
        return None
    rows = np.flatnonzero(np.isfinite(factor))
    modes = growing_modes(result, rows)
    unstable = result.history["unstable"][rows] if modes is None else modes
    return rows, factor[rows], np.asarray(unstable) > 0


def growing_modes(result, rows):
    """Return how many modes grow at each of the rows; None where *STABILITY, FREQUENCY=1 does not
    tell it for all of them."""
    if "stability" not in result.file:
        return None
    group = result.file["stability"]
    told = dict(zip(group["time"][:], group["unstable_modes"][:], strict=True))
    modes = [told.get(time) for time in result.history["time"][rows]]
    return None if None in modes else np.array(modes)


def labels(result):
    """Return what full and dashed lines mean: without a count of growing modes the sign of
    det(I - U') tells whether it is odd."""
    rows = of_branch(result)[0]
    if growing_modes(result, rows) is not None:
        return "stable", "unstable"
    return "none or an even number of modes grows", "unstable: an odd number of modes grows"


def parts(unstable):
    """Return the runs of points, neighbours joined: (first, behind the last, unstable). A line
    between points of which one is stable is drawn as the first of both."""
    ends = [0, *(np.flatnonzero(np.diff(unstable)) + 1), len(unstable)]
    return [(first, min(behind + 1, len(unstable)), bool(unstable[first]))
            for first, behind in zip(ends, ends[1:])]


def draw(result, options):
    """Draw a quantity of every contact asked for; return the files written."""
    branch = of_branch(result)
    if branch is None:
        raise UserError(f"{result.path}: holds no branch: its deck has no *CONTINUATION")
    written = []
    for contact in result.contacts(options.contact):
        name = quantity_of(contact, options.quantity)
        named = [contact.name] if len(result.contact_names) > 1 else []
        named += [name] if options.quantity else []
        rows, factor, unstable = branch
        values = contact.totals()[name][rows]
        table = {"increment": rows + 1, "load_factor": factor, name: values,
                 "fold": result.history["fold"][rows], "unstable": unstable.astype(int)}
        figure = picture(result, contact, name, branch, values)
        written += style.write(figure, table, options, style.file_name(result, "branch", *named))
    return written


def quantity_of(contact, name):
    """Return the name of the quantity to draw."""
    known = [key for key, values in contact.totals().items() if np.isfinite(values).any()]
    if name is None:
        return next(key for key in [*PREFERRED, *known] if key in known)
    if name not in known:
        raise UserError(f"contact '{contact.name}' has no quantity '{name}'"
                        f"{nearest_name(name, known)}; it has {', '.join(known)}")
    return name


def picture(result, contact, name, branch, values):
    """Return the finished figure; dots are folds, where the load factor turns."""
    rows, factor, unstable = branch
    figure, axes = plt.subplots(layout="constrained", figsize=(style.SINGLE_COLUMN * 1.15, 2.6))
    for first, behind, is_unstable in parts(unstable):
        axes.plot(factor[first:behind], values[first:behind], color=style.BLACK,
                  **LOOKS[is_unstable])
    for is_unstable, words in enumerate(labels(result)):
        if np.any(unstable == is_unstable):
            axes.plot([], [], color=style.BLACK, label=words, **LOOKS[bool(is_unstable)])
    folds = result.history["fold"][rows] > 0
    if folds.any():
        axes.plot(factor[folds], values[folds], "o", ls="none", color=style.VERMILION, mfc="white",
                  label="fold")
    unit = contact.unit(name)
    axes.set_xlabel("Load factor")
    axes.set_ylabel(words_of(name).capitalize() + (f" ({unit})" if unit else ""))
    axes.legend(loc="best")
    return figure
