"""Residual history, iterations and the range of g, for one run or several."""

from dataclasses import dataclass

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

from . import style
from .style import plt
from .tables import stack_tables

SMALLEST = 1e-17  # residuals of zero are drawn here
KINDS = {
    "accepted": {"color": "#9A9A9A", "lw": 0.5, "zorder": 2},
    "cut back": {"color": style.BLUE, "lw": 0.7, "ls": (0, (3, 1.5)), "zorder": 3},
    "slowest": {"color": "black", "lw": 1.0, "marker": "o", "ms": 2.4, "zorder": 4},
    "failed": {"color": style.VERMILION, "lw": 1.0, "marker": "x", "ms": 3.0, "zorder": 5},
}


@dataclass
class Attempt:
    """One solve of an increment, of its stages and tries: its rows of /convergence."""

    increment: int
    number: int
    kind: str
    rows: np.ndarray


class Run:
    """The iterations of one result, split into solves."""

    def __init__(self, result):
        self.result = result
        self.data = result.convergence
        increment, iteration = self.data["increment"], self.data["iteration"]
        cut_backs = self.data.get("cut_backs", np.zeros(len(increment)))
        new = (np.diff(increment) != 0) | (np.diff(iteration) <= 0)
        self.attempts, count = [], {}
        last = dict(zip(increment.tolist(), cut_backs.tolist()))
        for rows in np.split(np.arange(len(increment)), np.flatnonzero(new) + 1):
            at = int(increment[rows[0]])
            count[at] = count.get(at, 0) + 1
            kind = "accepted" if at <= result.increments else "failed"
            kind = "cut back" if cut_backs[rows[0]] < last[at] else kind
            self.attempts.append(Attempt(at, count[at], kind, rows))
        accepted = self.of_kind("accepted")
        counts = [len(attempt.rows) for attempt in accepted]
        longest = max(counts, default=0)
        self.equals = counts.count(longest)  # of the longest solves
        self.slowest = accepted[counts.index(longest)] if self.equals < len(counts) else None

    @property
    def relaxes(self):
        """Whether some g differs from 1.00."""
        return bool(min(self.data["g_min"]) < 0.995 or max(self.data["g_max"]) > 1.005)

    def of_kind(self, kind):
        """Return the solves of one kind."""
        return [attempt for attempt in self.attempts if attempt.kind == kind]

    def table(self):
        """Return all iterations as columns."""
        data = self.data
        count = len(data["increment"])
        attempt, outcome = np.empty(count, dtype=int), np.empty(count, dtype=object)
        for each in self.attempts:
            attempt[each.rows], outcome[each.rows] = each.number, each.kind
        columns = {"result": np.full(count, self.result.name, dtype=object), "attempt": attempt}
        columns |= {"outcome": outcome}
        order = (
            "increment",
            "iteration",
            "residual",
            "g_min",
            "g_max",
            "pairs_changed",
            "cut_backs",
        )
        return columns | {key: data[key] for key in order if key in data}


def draw(results, options):
    """Draw the convergence of one result, or of several side by side; return the files written."""
    runs = [Run(result) for result in results]
    heights = [1.7, 1.0, 1.0][: 2 + any(run.relaxes for run in runs)]
    figure = plt.figure(
        layout="constrained",
        figsize=(style.DOUBLE_COLUMN * (0.62 if len(runs) == 1 else 0.9), 5.6 if len(heights) > 2 else 4.1),
    )
    grid = figure.add_gridspec(len(heights), len(runs), height_ratios=heights)
    first = None
    for column, run in enumerate(runs):
        first = draw_residuals(figure, grid[0, column], run, first)
    counts = figure.add_subplot(grid[1, :])
    relaxation = figure.add_subplot(grid[2, :], sharex=counts) if len(heights) > 2 else None
    for number, run in enumerate(runs):
        shift = 0.3 * (number - 0.5 * (len(runs) - 1))
        draw_counts(counts, run, number, shift)
        if relaxation:
            draw_relaxation(relaxation, run, number, shift)
    finish_counts(counts, runs)
    if relaxation:
        counts.tick_params(labelbottom=False)
        finish_relaxation(relaxation, runs)
    figure.axes[-1].set_xlabel("Increment")
    names = [style.plain(run.result.name) for run in runs] if len(runs) > 1 else [""]
    for axes, letter, name in zip(figure.axes, "abcdefgh", [*names, "", ""]):
        style.panel_title(axes, name, letter)
    parts = [run.result.name for run in runs[1:]]
    name = style.file_name(results[0], "convergence", *parts)
    columns = stack_tables([run.table() for run in runs])
    return style.write(figure, columns, options, name)


def draw_residuals(figure, place, run, first):
    """Draw residual against iteration, a line for each solve; return the axes that set the scale."""
    axes = figure.add_subplot(place, sharey=first, sharex=first)
    for attempt in run.attempts:
        looks = KINDS["slowest" if attempt is run.slowest else attempt.kind]
        residual = np.maximum(run.data["residual"][attempt.rows], SMALLEST)
        axes.semilogy(run.data["iteration"][attempt.rows], residual, **looks)
    axes.set_xlabel("Iteration of a solve")
    axes.xaxis.set_major_locator(whole_numbers())
    axes.yaxis.set_major_locator(LogLocator(numticks=9))
    axes.yaxis.set_minor_formatter(NullFormatter())
    if first is None:
        axes.set_ylabel(r"Residual  $\max\,|U(\omega)-\omega|/\omega$")
    else:
        axes.tick_params(labelleft=False)
    axes.legend(handles=residual_handles(run), loc="best", fontsize=7)
    return first or axes


def residual_handles(run):
    """Return the legend's entries for the kinds of solves that are there."""
    handles = []
    if len(run.of_kind("accepted")) > (run.slowest is not None):
        handles.append(Line2D([], [], label="solves of accepted increments", **KINDS["accepted"]))
    if run.slowest:
        which = "the longest" if run.equals == 1 else f"one of the {run.equals} longest"
        label = f"{which}, in increment {run.slowest.increment}"
        handles.append(Line2D([], [], label=label, **KINDS["slowest"]))
    if run.of_kind("cut back"):
        handles.append(Line2D([], [], label="ended by cut-back", **KINDS["cut back"]))
    for increment in sorted({attempt.increment for attempt in run.of_kind("failed")}):
        label = f"increment {increment} (not converged)"
        handles.append(Line2D([], [], label=label, **KINDS["failed"]))
    return handles


def draw_counts(axes, run, number, shift):
    """Draw the iterations of each increment, all solves together; mark those that failed."""
    looks = series_looks(number)
    increments = np.unique([attempt.increment for attempt in run.attempts])
    spent = np.array([np.sum(run.data["increment"] == at) for at in increments])
    axes.vlines(increments + shift, 0, spent, color=looks["color"], lw=0.5)
    axes.plot(increments + shift, spent, ls="none", label=style.plain(run.result.name), **looks)
    mark_failed(axes, run, shift, increments, spent)


def draw_relaxation(axes, run, number, shift):
    """Draw the range of g over the last solve of each increment."""
    last = {attempt.increment: attempt for attempt in run.attempts}
    at = np.array(sorted(last))
    low = np.array([np.min(run.data["g_min"][last[k].rows]) for k in at])
    high = np.array([np.max(run.data["g_max"][last[k].rows]) for k in at])
    looks = series_looks(number)
    axes.vlines(at + shift, low, high, color=looks["color"], lw=0.6)
    axes.plot(at + shift, high, ls="none", **looks)
    axes.plot(at + shift, low, ls="none", **looks)
    mark_failed(axes, run, shift, at, high)


def mark_failed(axes, run, shift, increments, values):
    """Cross out the increments that did not converge."""
    for attempt in run.of_kind("failed"):
        value = values[np.flatnonzero(increments == attempt.increment)[0]]
        axes.plot(
            attempt.increment + shift, value, "x", color=style.VERMILION, ms=6, mew=1.2, zorder=5
        )


def series_looks(number):
    """Return colour and marker of the run with this number."""
    colour = [style.BLACK, style.BLUE, style.GREEN, style.ORANGE][number % 4]
    return {"color": colour, "marker": style.MARKERS[number % 6], "mfc": "white", "ms": 3.0}


def finish_counts(counts, runs):
    """Label and scale the panel of iterations."""
    counts.set_ylabel("Iterations of all solves")
    most = max(np.unique(run.data["increment"], return_counts=True)[1].max() for run in runs)
    counts.set_ylim(0, 1.12 * most)
    counts.yaxis.set_major_locator(whole_numbers(5))
    if len(runs) > 1:
        counts.legend(loc="best", ncols=len(runs))
    counts.xaxis.set_major_locator(whole_numbers())
    last = max(np.max(run.data["increment"]) for run in runs)
    room = max(0.9, 0.02 * last)
    counts.set_xlim(1 - room, last + room)


def finish_relaxation(relaxation, runs):
    """Label and scale the panel of g."""
    relaxation.set_ylabel("Relaxation $g$")
    least = min(np.min(run.data["g_min"]) for run in runs)
    if 0.0 < least < 0.02:
        relaxation.set_yscale("log")
        relaxation.set_ylim(least**1.12, least**-0.12)
    else:
        relaxation.set_ylim(min(0.0, 1.12 * least), 1.12)


def whole_numbers(most=9):
    """Return ticks at whole numbers in steps of 1, 2, 5, 10 and so on, `most` + 1 at most."""
    return MaxNLocator(nbins=most, steps=[1, 2, 5, 10], integer=True, min_n_ticks=1)
