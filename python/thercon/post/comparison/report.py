"""What a comparison says on the terminal and in its tables."""

import numpy as np

from ..words import place_words
from .match import row_words

HEADING = (
    "quantity",
    "by",
    "times",
    "rows",
    "not in A",
    "not in B",
    "largest |a-b|",
    "of max |b|",
    "a",
    "b",
    "tolerance",
    "outside",
    "",
    "where",
)


def quantities(blocks):
    """Return {quantity: its blocks}, in the order of the blocks."""
    found = {}
    for block in blocks:
        found.setdefault(block.quantity, []).append(block)
    return found


def passed(blocks, all_keys):
    """Whether all blocks are within tolerance, and, where that is asked, all rows have met."""
    complete = not any(b.not_in_a or b.not_in_b or b.missing or b.ambiguous for b in blocks)
    complete = complete and not any(sum(b.examples.get("times", (0, 0))) for b in blocks)
    return all(block.passed for block in blocks) and (complete or not all_keys)


def table(blocks, all_keys):
    """Return the lines of the table: one row a quantity, at its largest difference."""
    rows = [HEADING]
    for name, group in quantities(blocks).items():
        rows.append(row(name, group, all_keys))
    left = (0, 1, 10, 12, 13)
    widths = [max(len(each[k]) for each in rows) for k in range(len(HEADING))]
    lines = []
    for each in rows:
        words = [
            w.ljust(n) if k in left else w.rjust(n) for k, (w, n) in enumerate(zip(each, widths))
        ]
        lines.append("  ".join(words).rstrip())
    return lines


def row(name, group, all_keys):
    """Return the fields of one quantity."""
    judged = [block for block in group if block.rows]
    verdict = "ok" if passed(group, all_keys) else "DIFFERS"
    times = str(sum(block.rows_met > 0 for block in group))
    counts = [str(sum(getattr(b, key) for b in group)) for key in ("not_in_a", "not_in_b")]
    rows = str(sum(block.rows for block in group))
    head = [name, group[0].by, times, rows, *counts]
    if not judged:
        return (*head, "", "", "", "", group[0].allowed, "0", verdict, "every value is missing")
    worst = max(judged, key=lambda block: float(np.max(block.difference)))
    k = worst.worst
    outside = str(sum(int(block.outside.sum()) for block in judged))
    if worst.state:
        differences = [f"{outside} states", ""]
    else:
        largest = worst.difference[k]
        share = percent(largest / worst.largest) if worst.largest > 0.0 else "-"
        differences = [f"{largest:.4g}", share]
    where = place(worst, k) if worst.difference[k] > 0.0 else ""
    values = [f"{worst.a[k]:.7g}", f"{worst.b[k]:.7g}"]
    return (*head, *differences, *values, worst.allowed, outside, verdict, where)


def percent(part):
    """Return a part in per cent, to three digits and without a power of ten."""
    return f"{float(f'{100.0 * part:.3g}'):g} %"


def place(block, k):
    """Return in words where a row of a block is."""
    words = [f"{block.axis} {block.at:g}"] if block.at is not None else []
    keys = row_words(block.columns, k)
    if block.axis in block.columns:
        words.append(f"{block.axis} {block.columns[block.axis][k]:g}")
    elif not keys.startswith("row "):
        words.append(keys)
    inside = [
        f"{name}={place_words(block.columns[name][k], block.columns[name])}"
        for name in ("x", "y")
        if name in block.columns
    ]
    return " ".join([*words, *inside])


def remarks(blocks, a, b, only=None):
    """Return lines on what was not compared: times, rows, missing values, NaN, quantities."""
    lines = []
    for name, group in quantities(blocks).items():
        words = []
        times = group[0].examples.get("times", (0, 0))
        for side, count in zip("AB", times):
            words += [f"{count} times not in {side}"] if count else []
        for key, side in (("not_in_a", "A"), ("not_in_b", "B")):
            found = next((each for each in group if getattr(each, key)), None)
            if found:
                at = f"at {found.axis} {found.at:g}: " if found.at is not None else ""
                words.append(f"not in {side}, {at}{', '.join(found.examples[key])}, ...")
        words += counted(group, "ambiguous", "rows at places with several points left out")
        words += counted(group, "missing", "rows with a missing value left out")
        words += counted(group, "nan_equal", "rows NaN in both, taken as equal")
        words += counted(group, "rounding", "rows of rounding in both, taken as equal")
        lines += [f"  {name}: {'; '.join(words)}"] if words else []
    if only:
        return lines
    met = set(quantities(blocks))
    bases = {name.partition("@")[0] for name in met}
    for side, source in (("A", a), ("B", b)):
        alone = [n for n in source.names() if n not in met and n.partition("@")[0] not in bases]
        lines += (
            [f"  only in {side}, or not compared unless asked for: {', '.join(alone)}"]
            if alone
            else []
        )
    return lines


def counted(group, key, words):
    """Return a count of all blocks of a quantity in words, or nothing."""
    count = sum(getattr(block, key) for block in group)
    return [f"{count} {words}"] if count else []


def block_table(label, blocks):
    """Return one row a block as columns."""
    columns = {name: [] for name in ("b_file", "quantity", "by", "axis", "at", "rows")}
    columns |= {name: [] for name in ("not_in_a", "not_in_b", "ambiguous", "missing", "nan_equal")}
    columns |= {name: [] for name in ("outside", "passed", "largest_difference", "largest_b")}
    columns |= {name: [] for name in ("a", "b", "limit", "where")}
    for block in blocks:
        k = block.worst if block.rows else None
        values = {
            "b_file": label,
            "at": "" if block.at is None else block.at,
            "outside": int(block.outside.sum()),
            "largest_difference": "" if k is None else float(block.difference[k]),
            "largest_b": block.largest,
            "a": "" if k is None else float(block.a[k]),
            "b": "" if k is None else float(block.b[k]),
            "limit": "" if k is None else float(block.limit[k]),
            "where": "" if k is None else place(block, k),
        }
        for name, column in columns.items():
            column.append(values[name] if name in values else getattr(block, name))
    return columns


def row_table(label, blocks):
    """Return one row a compared row as columns."""
    names = ("b_file", "quantity", "time", "load", "contact", "node", "element", "point")
    names += ("x", "y", "s", "a", "b", "difference", "limit", "outside")
    columns = {name: [] for name in names}
    for block in blocks:
        whole = {"b_file": label, "quantity": block.quantity}
        whole |= {block.axis: block.at} if block.at is not None else {}
        each = block.columns | {
            name: getattr(block, name) for name in ("a", "b", "difference", "limit", "outside")
        }
        for name, column in columns.items():
            values = each.get(name)
            filled = [whole.get(name, "")] * block.rows if values is None else values.tolist()
            column.extend(filled)
    return columns
