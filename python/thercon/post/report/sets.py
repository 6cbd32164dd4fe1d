"""Histories of sets of nodes and elements, pre-tension and reference nodes on the page."""

import numpy as np

from ..history import MOST_CURVES
from ..set_histories import label, set_histories


def of_sets(result, listed):
    """Return a chart of each quantity of each set: the curves of its members, of many their smallest,
    mean and largest values. `listed` makes a list of values."""
    return [chart(history, key, listed, result.increments) for history in set_histories(result)
            for key in (history.told() if len(history.time) else ())
            if history.kind != "run" or history.values[key].ndim > 1]


def chart(history, key, listed, count):
    """Return one chart: the rows that it has, from 0, and its curves; `values` at all increments are
    those of the caption."""
    curves = history.curves(key)
    if len(curves) > MOST_CURVES:
        values = history.values[key]
        known = np.isfinite(values).any(axis=1)
        kinds = {"smallest": np.nanmin, "mean": np.nanmean, "largest": np.nanmax}
        curves = [(words, np.full(len(values), np.nan)) for words in kinds]
        for (words, found) in curves:
            found[known] = kinds[words](values[known], axis=1)
    middle = curves[1 if len(history.curves(key)) > MOST_CURVES else 0][1]
    values = np.full(count, np.nan)
    values[history.increment - 1] = middle
    told = f", {curves[0][0]}" if 1 < len(curves) <= MOST_CURVES else ""
    of = "" if history.kind == "run" else f" of {history.name}"
    told = ", mean" if len(history.curves(key)) > MOST_CURVES else told
    return {
        "key": key,
        "label": f"{label(key)}{of}{told}",
        "unit": history.units[key],
        "values": listed(values),
        "uncertainty": [],
        "at": (history.increment - 1).tolist(),
        "curves": [{"name": words if len(curves) > 1 else "", "values": listed(found)}
                   for words, found in curves],
    }
