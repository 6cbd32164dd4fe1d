"""Differences and tolerances of the rows that belong together."""

from dataclasses import dataclass, field

import numpy as np

from ..errors import UserError

KINDS = ("abs", "rel", "block")

# Quantities, without the number of a component, that have one unit and the rounding of one problem.
# Places are not displacements: they are larger by far.
QUANTITIES = {
    "temperature": ("NT", "slave_temperature", "master_temperature"),
    "displacement": ("U", "gap", "slip"),
    "place": ("edge_contact", "edge_stick"),
    "stress": ("pressure", "shear", "S", "MISES"),
    "flux": ("heat_flux", "HFL"),
    "force": ("normal_force", "shear_force", "RF"),
    "power": ("heat_rate", "heat_in", "heat_out", "heat_stored", "heat_friction", "heat_dilatation",
              "RFL"),
    "share": ("stress_error", "heat_flux_error"),
}

# Part of the largest value of a quantity below which values are rounding.
ROUNDING = 1e-9


@dataclass
class Tolerance:
    """|a - b| <= abs + rel |b| + block max |b|, the maximum over the rows of one block."""

    abs: float = 0.0
    rel: float = 0.0
    block: float = 0.0

    def limit(self, b):
        """Return the limits of rows with the values `b` of the reference."""
        finite = np.abs(np.where(np.isfinite(b), b, 0.0))
        return self.abs + self.rel * finite + self.block * np.max(finite, initial=0.0)

    def words(self):
        """Return the tolerance in words."""
        return ", ".join(f"{kind} {getattr(self, kind):g}" for kind in KINDS if getattr(self, kind)) or "0"


def read_tolerances(texts):
    """Return {quantity: tolerance} of texts such as 'pressure=block:0.02,abs:1'."""
    tolerances = {}
    for text in texts:
        name, _, rest = text.partition("=")
        parts = [part.partition(":") for part in rest.split(",")]
        try:
            values = {kind.strip(): float(value) for kind, _, value in parts}
        except ValueError:
            values = {}
        if not name or not values or not set(values) <= set(KINDS):
            raise UserError(f"--tol {text}: write QUANTITY=abs:A,rel:R,block:M, any of the three")
        if not all(0.0 <= value < np.inf for value in values.values()):
            raise UserError(f"--tol {text}: tolerances are finite and not negative")
        tolerances[name] = Tolerance(**values)
    return tolerances


def floors(blocks):
    """Return {quantity: value below which it is rounding}, by the largest of all quantities of its
    kind, components and times in both files: S12 of a bar is measured by S11, the shear of a smooth
    face by its pressure, the heat rate of one interface by that of another."""
    largest = {"share": 1.0}
    for block in blocks:
        for values in () if block.state else (block.a, block.b):
            values = np.ma.compressed(np.ma.asanyarray(values)).astype(float)
            finite = np.abs(values[np.isfinite(values)])
            kind = kind_of(block.quantity)
            largest[kind] = max(largest.get(kind, 0.0), float(np.max(finite, initial=0.0)))
    return {each.quantity: ROUNDING * largest.get(kind_of(each.quantity), 0.0) for each in blocks}


def kind_of(name):
    """Return the kind of a quantity; of one that has none here, that of which it is a component."""
    base = name.partition("@")[0].rstrip("0123456789")
    return next((kind for kind, names in QUANTITIES.items() if base in names), base)


@dataclass
class Block:
    """One quantity at one time, or one history: rows of A with B's values beside them."""

    quantity: str
    by: str
    axis: str | None
    at: float | None
    columns: dict
    a: np.ndarray
    b: np.ndarray
    not_in_a: int = 0
    not_in_b: int = 0
    ambiguous: int = 0
    missing: int = 0
    state: bool = False
    examples: dict = field(default_factory=dict)
    curve: tuple | None = None

    def judge(self, tolerance, mismatches, floor=0.0):
        """Fill in `difference`, `limit`, `outside` and `passed`; rows with a missing value go.

        Where both values are below `floor` they are rounding, and equal.
        """
        there = ~(np.ma.getmaskarray(self.a) | np.ma.getmaskarray(self.b))
        self.missing += int((~there).sum())
        if not there.all():
            self.columns = {name: values[there] for name, values in self.columns.items()}
        self.a = np.ma.getdata(self.a)[there].astype(float)
        self.b = np.ma.getdata(self.b)[there].astype(float)
        both_nan = np.isnan(self.a) & np.isnan(self.b)
        with np.errstate(invalid="ignore"):
            rounding = (np.abs(self.a) <= floor) & (np.abs(self.b) <= floor) & (self.a != self.b)
        self.rounding = int(rounding.sum())
        same = both_nan | rounding | (self.a == self.b)
        with np.errstate(invalid="ignore"):
            apart = np.where(same, 0.0, np.abs(self.a - self.b))
        self.nan_equal = int(both_nan.sum())
        self.difference = np.where(np.isnan(apart), np.inf, apart)
        self.largest = float(np.max(np.abs(self.b[np.isfinite(self.b)]), initial=0.0))
        self.limit = np.zeros(len(self.a)) if self.state else tolerance.limit(self.b)
        self.outside = self.difference > self.limit
        self.passed = int(self.outside.sum()) <= (mismatches if self.state else 0)
        self.allowed = f"{mismatches} at a time" if self.state else tolerance.words()
        return self

    @property
    def rows(self):
        """Number of rows compared."""
        return len(self.a)

    @property
    def worst(self):
        """Row with the largest difference."""
        return int(np.argmax(self.difference))
