"""The comparison of one file with another: which quantities, at which times, row by row."""

from ..errors import UserError, nearest_name
from .blocks import frame_blocks, history_blocks, listed
from .series import alias

# What says how a run went, not what it found: compared only when it is asked for.
NOT_COMPARED = (
    "iterations",
    "heat_imbalance",
    "heat_imbalance_pointwise",
    "force_imbalance",
    "coupling_gain",
    "coupling_gain_max",
)


def compare(a, b, options):
    """Return the blocks of all quantities that the sources `a` and `b` share.

    Raises the error for a quantity that is wanted or shared and of which no row meets another.
    """
    names = wanted(a, b, options.only)
    if not names:
        raise UserError(
            f"{a.label} and {b.label} have no quantity in common (--map NAME=OTHER renames); "
            f"A has {listed(a.names())}; B has {listed(b.names())}"
        )
    blocks, met = [], set()
    for first in a.series:
        for second in b.series:
            shared = [(n, alias(n, second.quantities)) for n in names if n in first.quantities]
            shared = [(name, other) for name, other in shared if other]
            if not shared or first.history != second.history:
                continue
            work = history_blocks if first.history else frame_blocks
            found = work(first, second, shared, a.states | b.states, options)
            if found is not None:
                blocks += found
                met |= {name for name, _ in shared}
    check_overlap(a, b, [name for name in names if name in met or options.only], blocks, options)
    if not blocks:
        raise UserError(f"{a.label} and {b.label} have no keys or coordinates in common")
    return blocks


def wanted(a, b, only):
    """Return the quantities to compare: those of --only, else all that both have."""
    for name in only or ():
        if name not in a.names():
            hint = nearest_name(name, a.names())
            raise UserError(f"A {a.label} has no quantity '{name}'{hint}")
    shared = [n for n in a.names() if any(alias(n, series.quantities) for series in b.series)]
    if only:
        return [name for name in only if name in shared]
    shared = [name for name in shared if name not in NOT_COMPARED]
    return [name for name in shared if name != "closed" or "status" not in shared]


def check_overlap(a, b, names, blocks, options):
    """Raise the error for quantities of which nothing was compared."""
    for name in names:
        if not any(block.rows_met for block in blocks if block.quantity == name):
            way = f" by {options.by}" if options.by else ""
            raise UserError(
                f"{a.label} and {b.label} share {name}, but no row of one meets a row of the "
                f"other{way}: see to times (--axis, --at, --map time=...), keys (--map node=...) "
                "or --by"
            )
