"""The cheapest run of each program at each error, and their picture."""

from dataclasses import dataclass

import numpy as np
from records import Record, limit, read, worst

LEVELS = {0.1: None, 0.03: 50, 0.01: None, 0.003: 200}   # worst error, ratio that is aimed at
PROGRAMS = ("thercon", "calculix")
NAMES = {"thercon": "thercon", "calculix": "CalculiX 2.20"}


@dataclass(frozen=True)
class Scored:
    """A run and its worst error."""

    record: Record
    error: float


def scored(runs=None):
    """Return the runs that both programs model alike, with their errors."""
    reference, _ = limit()
    return [Scored(one, worst(one, reference)) for one in runs or read()
            if one.case.model == "small"]


def cheapest(runs, program, level):
    """Return the cheapest run of a program within an error, None where there is none."""
    within = [one for one in runs if one.record.case.program == program and one.error <= level]
    return min(within, key=lambda one: one.record.cpu, default=None)


def lower(runs, program):
    """Return the runs that no other of the program beats in both error and cost, cheapest first."""
    kept = []
    own = [one for one in runs if one.record.case.program == program and np.isfinite(one.error)]
    for one in sorted(own, key=lambda one: (one.record.cpu, one.error)):
        if not kept or one.error < kept[-1].error:
            kept.append(one)
    return kept


def ratio(runs, level):
    """Return CPU seconds of CalculiX by those of thercon, None where one does not get there."""
    ours, theirs = (cheapest(runs, program, level) for program in PROGRAMS)
    return theirs.record.cpu / ours.record.cpu if ours and theirs else None


def draw(path):
    """Draw error against CPU seconds: all runs, and the lower envelope of each program."""
    import pictures

    runs = scored()
    figure, axes = pictures.subplots(1, 1, 3.4, width=5.0)
    colours = pictures.style.BLUE, pictures.style.VERMILION
    for program, colour, marker in zip(PROGRAMS, colours, "os", strict=True):
        own = [one for one in runs if one.record.case.program == program]
        axes.loglog([one.record.cpu for one in own], [100 * one.error for one in own], marker,
                    color=colour, alpha=0.35, markeredgewidth=0)
        best = lower(runs, program)
        axes.loglog([one.record.cpu for one in best], [100 * one.error for one in best],
                    "-" + marker, color=colour, label=NAMES[program])
    for level in LEVELS:
        axes.axhline(100 * level, color=pictures.style.GREY, linewidth=0.4, zorder=0)
    axes.set_yticks([100 * level for level in LEVELS], [f"{100 * level:g}" for level in LEVELS])
    axes.minorticks_off()
    axes.set_xlabel("CPU seconds")
    axes.set_ylabel("worst error, %")
    axes.legend()
    pictures.save(figure, path)
