"""The result file of a run, as interfaces and pictures name its parts."""

import re
from dataclasses import dataclass, field
from functools import cached_property, reduce
from pathlib import Path

import h5py
import numpy as np

from . import stresses
from .cells import Cells
from .checked_file import need, numbers, open_checked
from .errors import UserError, nearest_name
from .joined_contacts import common, join
from .units import UNIT_NAMES, Units, unit_of
from .words import number_text, place_words, printable, runs_text

OPEN, SLIP, STICK = 0, 1, 2

# Columns of the VTKHDF arrays with several components: picture quantity -> array, component.
# Those of CELL_FIELDS have one number an element, the others one a point.
CELL_FIELDS = ("stress_error", "heat_flux_error")
MODE = "mode_temperature"  # of the leading mode, with mode_displacement
FIELD_SOURCES = {
    "temperature": ("temperature", None),
    "von_mises": ("von_mises", None),
    "xx": ("stress", 0),
    "yy": ("stress", 1),
    "zz": ("stress", 2),
    "xy": ("stress", 3),
    "principal_1": ("principal_stress", 0),
    "principal_2": ("principal_stress", 1),
    "principal_3": ("principal_stress", 2),
    "radial": ("radial_stress", None),
    "hoop": ("hoop_stress", None),
    "plastic_strain": ("equivalent_plastic_strain", None),
    "creep_strain": ("equivalent_creep_strain", None),
    "solid_fraction": ("solid_fraction", None),
    "flux_x": ("heat_flux", 0),
    "flux_y": ("heat_flux", 1),
    "stress_error": ("stress_error", None),
    "heat_flux_error": ("heat_flux_error", None),
    MODE: (MODE, None),
}
# Of contact points, at nodes of both faces and NaN at others.
FACE_SOURCES = {name: (f"contact_{name}", None) for name in ("pressure", "gap", "wear_slave", "wear_master")}


# Datasets of a contact that hold one value a contact point.
GEOMETRY = ("slave_node", "master_node", "x", "y", "s", "piece", "weight")
# Those that every contact has of its points at the increments, and of its edges.
STATES = ("pressure", "status")
EDGES = ("edge_contact", "edge_stick", "edges_contact", "edges_stick")
FACES = "face_node"  # nodes of both faces, of faces that slide
PATTERN = "*"  # in names of contacts: any characters
NOISE = 1e-9  # of what it is beside: smaller values are rounding
LOADS_TO = 1e-12  # of the largest load: loads are sums of at most some thousand increments
NEARLY_ALL = 0.05  # of a picture: a narrower rest of the face is shown, too
INCLINED = 0.7  # of the length of a face: where x changes by less, places are lengths along it
LEFT_OUT = 0.01  # of the force and of the heat: as much may be outside of a profile
TOLD = 1e-4  # of force or heat: smaller shares are not told
UNJUDGED = "inside a step: the mesh is not refined for this time"
MARKED = "dotted lines are ends of steps; the accuracy is judged at these alone"
ROUND = ("cpu_seconds", "unknowns", "elements", "increments")
ANALYSIS = ("time", "unstable_modes", "growth_rate", "period")
NO_FINER_VALUE = "not there on a finer mesh"  # why growth rates have no uncertainty
NO_ANALYSIS = ("no state was analysed: the run did not come to the end of a step with *STABILITY, nor to "
               "an increment of its FREQUENCY=")
ITERATION = ("increment", "iteration", "residual", "g_min", "g_max")
COMPONENTS = {"displacement": 3, "mode_displacement": 3, "stress": 4, "principal_stress": 3,
              "heat_flux": 3}


SPOKEN = {  # where a name says too little
    "heat_friction": "heat of friction", "heat_dilatation": "heat that strains take up",
    "heat_imbalance_pointwise": "imbalance of heat at the end of the increment",
    "coupling_gain_max": "largest real coupling gain",
    "growth_rate": "growth rate of the leading mode", "period": "period of the leading mode",
    "worn_volume_slave": "worn volume of the slave",
    "worn_volume_master": "worn volume of the master",
    "ALLSE": "elastic energy (ALLSE)", "ALLWK": "work of all loads (ALLWK)",
    "ALLFD": "energy dissipated by friction (ALLFD)",
    "ALLPD": "energy dissipated by plasticity (ALLPD)",
    "ALLCD": "energy dissipated by creep (ALLCD)",
}


def words_of(name):
    """Return the name of a quantity as one speaks it."""
    spoken = re.sub("^edge_", "edge of ", name).replace("pre_tension", "pre-tension")
    return SPOKEN.get(name, spoken.replace("_", " "))


def uncertainty_of(group):
    """Return the uncertainties in a file or in its /accuracy, under their former names in files of
    earlier versions; None where there are none."""
    names = ("uncertainty", "errors", "bounds")
    return next((group[name] for name in names if name in group), None)


@dataclass
class Contact:
    """One contact pair of the deck: arrays over its m contact points, states over n increments."""

    name: str
    data: dict
    friction: float | None
    pairing: str = "NODES"
    units: dict = field(default_factory=dict)
    parts: dict = field(default_factory=dict)  # of several interfaces: the points of each
    slides: bool = False  # whether its points follow sliding

    def __getitem__(self, key):
        return self.data[key]

    def get(self, key, otherwise=None):
        """Return the dataset `key`; None, or something else, where the deck does not model it."""
        return self.data.get(key, otherwise)

    @property
    def pieces(self):
        """Return the pairs of each piece of the faces, as slices."""
        changes = np.flatnonzero(np.diff(self.data["piece"])) + 1
        starts = [0, *changes.tolist(), len(self.data["piece"])]
        return [slice(first, last) for first, last in zip(starts, starts[1:])]

    def totals(self):
        """Return the quantities of the whole contact by name, forces first: one value an
        increment."""
        peak = self.data["pressure"].max(axis=1)
        found = self.data | {"peak_pressure": peak}
        return {key: found[key] for key in sorted(found, key=lambda key: not key.endswith("_force"))
                if key == "peak_pressure" or self.is_total(key)}

    def is_end_of_face(self, key, value):
        """Whether a value is an edge at the end of the face, which no mesh moves."""
        ends = [self.data["s"][piece][-1] for piece in self.pieces]
        return key.startswith("edge_") and value in ends

    def is_total(self, key):
        """Whether a dataset has one value an increment: its length alone does not tell, as there may
        be as many contact points as increments."""
        return self.data[key].ndim == 1 and key not in GEOMETRY

    def unit(self, key):
        """Return the unit of a quantity; empty where the deck names none."""
        return unit_of(self.units.get("pressure" if key == "peak_pressure" else key, ""))

    def axis(self, along):
        """Return (name, coordinate of the pairs): x where it grows along the face, which is not steep,
        of several interfaces y where that does, else s; of interfaces that overlap that of each.

        `along` is "x", "y", "s" or None for the choice made here.
        """
        if self.overlap(along):
            return self.own_axis(along)
        if along in ("x", "y") and not self.grows(along):
            raise UserError(f"{along} does not grow along contact '{self.name}': use --along s")
        choices = ("x", "y") if self.parts else () if self.is_steep() else ("x",)
        name = along or next(filter(self.grows, choices), "s")
        return name, self.data[name]

    def is_steep(self):
        """Whether x changes little along the face, as on an inclined one or an arc."""
        spans = [[np.ptp(self.data[name][piece]) for piece in self.pieces] for name in "xs"]
        return sum(spans[0]) < INCLINED * sum(spans[1])

    def grows(self, name):
        """Whether a coordinate grows along each piece of the face, and never falls."""
        places = self.data[name]
        return bool(np.all(np.diff(places) >= 0.0)) and all(
            np.all(np.diff(places[piece]) > 0.0) for piece in self.pieces
        )

    def overlap(self, along):
        """Whether there are several interfaces that overlap along a coordinate (None: x and y), as in
        a stack; in a rod they follow one another."""
        return bool(self.parts) and not any(self.grows(name) for name in "xy" if along in (name, None))

    def part_number(self, piece):
        """Return which of several interfaces, from 0, a piece is of."""
        return sum(part.stop <= piece.start for part in self.parts.values())

    def places(self):
        """Return where the contact points are as columns of tables: x and s, of several interfaces
        with the name of each point's, y, and s along that one."""
        if not self.parts:
            return {"x": self.data["x"], "s": self.data["s"]}
        counts = [part.stop - part.start for part in self.parts.values()]
        starts = [self.data["s"][part.start] for part in self.parts.values()]
        return {"contact": np.repeat(np.array(list(self.parts), dtype=object), counts),
                "x": self.data["x"], "y": self.data["y"],
                "s": self.data["s"] - np.repeat(starts, counts)}

    def own_axis(self, along):
        """Return (name, coordinate of the pairs) for several interfaces that overlap: the first of x,
        y and the own arc length s of each that varies within every one, or that of `along`."""
        places = self.places()
        for name in along or "xys":
            steps = [np.diff(places[name][part]) for part in self.parts.values()]
            if all(np.all(each >= 0.0) or np.all(each <= 0.0) for each in steps) and all(
                np.all(np.diff(places[name][piece]) != 0.0) for piece in self.pieces
            ):
                return name, places[name]
        raise UserError(f"{along} is constant or turns along an interface of '{self.name}': "
                        f"use --along {self.own_axis(None)[0]}")

    def edge_on_axis(self, edge, coordinate):
        """Return zone edges, given as arc length s, on the coordinate of the pairs."""
        edge = np.asarray(edge, dtype=float)
        moved = np.interp(edge, self.data["s"], coordinate)
        return np.where(np.isnan(edge), np.nan, moved)

    def contact_edges(self, coordinate, rows=slice(None)):
        """Return the edges of contact at these increments on the coordinate of the pairs."""
        edges = np.ravel(self.data["edges_contact"][rows])
        return self.edge_on_axis(edges[~np.isnan(edges)], coordinate)

    def window(self, coordinate, rows=slice(None), of_loads=False):
        """Return the range that pictures show, and somewhat more: the edges of contact and the pairs
        that close at these increments or, if asked, those that carry all but LEFT_OUT of force and
        heat; the whole face where there are none."""
        low, high = map(float, coordinate[[0, -1]])
        shown = (self.data["status"][rows] != OPEN).any(axis=0)
        if of_loads:
            shown[:] = False
            for shares in (self.force_shares(rows), self.heat_shares(rows)):
                before, behind = shares.cumsum(axis=1), shares[:, ::-1].cumsum(axis=1)[:, ::-1]
                shown |= (np.minimum(before, behind) > 0.5 * LEFT_OUT).any(axis=0)
        if not shown.any():
            return low, high
        places = np.concatenate((coordinate[shown], self.contact_edges(coordinate, rows)))
        first, last = float(places.min()), float(places.max())
        room = 0.3 * max(last - first, 2.0 * np.min(np.diff(coordinate), initial=high - low))
        first, last = first - room, last + room
        rest = NEARLY_ALL * (last - first)
        return low if first < low + rest else first, high if last > high - rest else last

    def heat_shares(self, rows):
        """Return the share of each pair in the heat that crosses, (increments, pairs); zero where
        there is none."""
        flux, conductance, temperature = (
            np.abs(np.nan_to_num(self.data.get(key, np.zeros(self.data["status"].shape))[rows]))
            for key in ("heat_flux", "conductance", "slave_temperature")
        )
        return shares_of(np.where(flux > NOISE * conductance * temperature, flux, 0.0)
                         * self.data["weight"])

    def force_shares(self, rows):
        """Return the share of each pair in the normal force, (increments, pairs); zero where there
        is none."""
        return shares_of(np.nan_to_num(self.data["pressure"][rows]) * self.data["weight"])

    def part_words(self, coordinate, window, unit, rows=slice(None)):
        """Return what a window leaves out of the face, and what that carries, in words; nothing where
        it shows all."""
        outside = (coordinate < window[0]) | (coordinate > window[1])
        if not outside.any():
            return ""
        shares = [share_words(shares[:, outside].sum(axis=1).max()) for shares in
                  (self.force_shares(rows), self.heat_shares(rows))]
        carried = [f"{words} of the {of}" for words, of in zip(shares, ("force", "heat")) if words]
        edges = self.contact_edges(coordinate, rows)
        is_cut = np.any((edges < window[0]) | (edges > window[1]))  # it may be between two points
        is_open = not is_cut and np.all(self.data["status"][rows][:, outside] == OPEN)
        ends = " to ".join(place_words(end, coordinate) for end in coordinate[[0, -1]])
        face = f"{ends} {unit}".rstrip().replace("-", "\N{MINUS SIGN}")
        words = f"The face runs from {face}; the part not shown"
        if is_open:
            crosses = f",\nand {carried[0]} crosses it" if carried else ""
            return f"{words} is open{crosses}"
        nothing = "has edges of contact" if is_cut else "carries nothing"
        return f"{words}\n{'carries ' + ' and '.join(carried) if carried else nothing}"


def shares_of(loads):
    """Return each of loads (increments, pairs) over the sum of its increment; zero where that is."""
    whole = loads.sum(axis=1, keepdims=True)
    return np.divide(loads, whole, out=np.zeros_like(loads), where=whole > 0.0)


def share_words(share):
    """Return a share in words; nothing where it is too small to tell."""
    return f"up to {100.0 * share:.2g} %" if share > TOLD else ""


def completed(path):
    """Return the path of a file, with the ending of a result where that is left out, as decks are
    named."""
    whole = Path(f"{path}.vtkhdf")
    return whole if whole.is_file() and not Path(path).is_file() else Path(path)


class Result:
    """A result file, open for reading; use it in a `with` statement."""

    def __init__(self, path):
        self.path = completed(path)
        if not self.path.exists():
            raise UserError(f"{path}: no such file")
        if self.path.is_dir():
            raise UserError(f"{path}: is a folder, not a result file")
        self.file = open_checked(self.path)
        missing = [group for group in ("history", "VTKHDF", "run")
                   if not isinstance(self.file.get(group), h5py.Group)]
        if missing:
            self.file.close()
            raise UserError(f"{path}: is HDF5 but not a thercon result: it has no /{missing[0]}")
        self.name = self.path.stem
        self.notes = []  # what pictures of it say on the terminal

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.file.close()

    @cached_property
    def units(self):
        """Units that `*OPTIONS, UNITS=` gave; none where it did not."""
        run = self.file["run"].attrs
        load = self.file["history/load"].attrs.get("unit", "time")
        return Units({name: text(run.get(f"unit_{name}", "")) for name in UNIT_NAMES}, text(load))

    @cached_property
    def history(self):
        """Datasets of /history by name: one value for each accepted increment."""
        group = self.file["history"]
        # Its groups are the histories of sets.
        found = {key: numbers(group, key) for key in group
                 if not isinstance(group[key], h5py.Group)}
        for key in ("time", "load"):
            found[key] = numbers(group, key, like=(None,), finite=True)
        for key, values in found.items():
            fits = values.ndim in (1, 2) and len(values) == len(found["time"])
            need(group, fits, f"{key} has not one row for each increment")
        return found

    @cached_property
    def load_label(self):
        """What the load axis shows, as the file names it."""
        label = text(self.file["history"]["load"].attrs.get("label", "load"))
        label = re.sub(r"^u_([xy]) of", r"displacement \1 of", label)
        label = re.sub(r" of (\d+)$", r" of node \1", label)
        return label.replace("$", "")  # which begins a formula in a picture

    def abscissa(self, over=None):
        """Return label and values, one an increment, of the axis that curves over the run have: time or
        load; where `over` is neither, time where heat is stored or the load turns, else the load."""
        load = self.history["load"]
        if over == "load" and self.load_label == "time":
            raise UserError(f"{self.path}: the deck has no LOAD= on *OPTIONS, so its load is the time: "
                            "give it LOAD=nset,dof, or leave --over load out")
        rises = np.all(np.diff(load) > 0.0) or np.all(np.diff(load) < 0.0)
        if over == "time" or over is None and ("heat_stored" in self.history or not rises):
            return self.units.label("Time", "time"), self.history["time"]
        return self.units.load_label(self.load_label), load

    @property
    def increments(self):
        """Number of accepted increments."""
        return len(self.history["load"])

    @cached_property
    def convergence(self):
        """Datasets of /convergence by name: one value for each iteration."""
        group = self.file.get("convergence")
        if group is None or len(group.get("iteration", ())) == 0:
            raise UserError(
                f"{self.path}: holds no iterations: nothing in this deck is iterated on"
            )
        count = len(numbers(group, "increment", like=(None,)))
        found = {key: numbers(group, key, like=(count,)) for key in {*group, *ITERATION}}
        for key in ("increment", "iteration"):
            is_count = found[key].dtype.kind in "iu" and np.all(found[key] > 0)
            need(group, is_count, f"{key} has values that are no counts from 1")
        return found

    @cached_property
    def accuracy(self):
        """Attributes and datasets of /accuracy by name, one value a round, and `uncertainty`:
        {contact: {quantity: rows (step, value, uncertainty, target)}}; None where no accuracy was
        requested."""
        group = self.file.get("accuracy")
        if group is None:
            return None
        rounds = len(numbers(group, "cpu_seconds", like=(None,)))
        judged = uncertainty_of(group)
        need(group, rounds > 0 and judged is not None, "there are no rounds")
        found = {key: numbers(group, key, like=(rounds,)) for key in ROUND}
        found |= {key: bool(group.attrs.get(key)) for key in ("reached", "later_round_begun")}
        found["uncertainty"] = {name: {key: numbers(judged[name], key, like=(rounds, 4))
                                       for key in judged[name]} for name in judged}
        return found

    @cached_property
    def judged(self):
        """Which increments have uncertainties; all where no accuracy was requested."""
        if self.accuracy is None:
            return np.ones(self.increments, dtype=bool)
        known = uncertainty_of(self.file)
        need(self.file, known is not None, "there are no uncertainties")
        return np.isin(self.history["time"], numbers(known, "time", like=(None,)))

    @cached_property
    def load_factors(self):
        """The load factor of every increment; NaN where it is no point of a branch."""
        return self.history.get("load_factor", np.full(self.increments, np.nan))

    @cached_property
    def stability(self):
        """Datasets of /stability by name: one value an analysis; None where there was none."""
        group = self.file.get("stability")
        if group is None:
            return None
        count = len(numbers(group, "time", like=(None,), finite=True))
        return {key: numbers(group, key, like=(count,)) for key in ANALYSIS}

    def uncertainties(self, name):
        """Return of every quantity with an uncertainty, of a contact, a body or the increment, by
        its key: unit, names of the columns, their rows at all increments (value, uncertainty,
        parts), and in words why the last one has none. Increments may have no row but NaN: by
        default ends of steps alone have one."""
        found = uncertainty_of(self.file)
        if found is None or name not in found:
            return {}
        times, group = numbers(found, "time", like=(None,)), found[name]
        row_at = {time: row for row, time in enumerate(times)}
        rows = [row_at.get(time, -1) for time in self.history["time"]]
        why = {}
        if rows[-1] >= 0 and "no_estimate" in group:  # not in files of earlier versions
            names = text(group["no_estimate"].attrs["components"]).split()
            reasons = numbers(group, "no_estimate", like=(len(times), len(names)))[rows[-1]]
            why = {key: text(found["reasons"][k]) for key, k in zip(names, reasons)}
        inside = text(found.attrs.get("inside_step", "")) if rows[-1] < 0 else ""
        known = {}
        for key in sorted(set(group) - {"no_estimate"}):
            attributes = group[key].attrs
            values = np.vstack([numbers(group, key, like=(len(times), 5)), np.full(5, np.nan)])
            known[key] = (text(attributes.get("unit", "")), text(attributes.get("components", "")).split(),
                          values[rows], why.get(key, inside))
        return known

    def reason_of(self, name):
        """Return why a quantity that `uncertainties` does not have has none, if there is a reason."""
        if not name.startswith("worn_volume"):
            return ""
        # The group `increment` is there with ERRORS=FULL only.
        full = "increment" in (uncertainty_of(self.file) or {})
        return "only for *VERIFY" if full else "*VERIFY; ERRORS=FULL"

    @property
    def maxima(self):
        """Return what `uncertainties` says of each body, by their names in the order of the numbers."""
        names = [name for name in uncertainty_of(self.file) or {} if name.startswith("body ")]
        return {name: self.uncertainties(name) for name in sorted(names, key=lambda n: int(n[5:]))}

    def label_of_body(self, name):
        """Return what a body is called, such as body 2 (HUB of STEEL, first node 38); where it has no
        uncertainties, its name."""
        groups = uncertainty_of(self.file) or {}
        return text(groups[name].attrs.get("label", name)) if name in groups else name

    @cached_property
    def deck(self):
        """Card images of the deck."""
        return [text(card) for card in self.file["deck"][()]] if "deck" in self.file else []

    @cached_property
    def verify_cards(self):
        """The cards *VERIFY of the deck."""
        return [card.upper() for card in self.deck if card.upper().startswith("*VERIFY")]

    @cached_property
    def is_axisymmetric(self):
        """Whether the model is axisymmetric."""
        return stresses.is_axisymmetric(self.deck)

    @cached_property
    def is_of_heat(self):
        """Whether the run is of heat alone: it has temperatures, and no contact carries a force."""
        steps = len(self.field_times)
        has_stress = steps and self.source("von_mises", steps - 1) is not None
        forces = [np.nanmax(contact["pressure"], initial=0.0) for contact in self.contacts()] \
            if self.contact_names else []
        has_force = has_stress if not forces else max(forces) > 0.0
        return bool(steps and self.source("temperature", steps - 1) is not None and not has_force)

    @cached_property
    def given_gaps(self):
        """The first keyword of the deck that gives gaps that the mesh does not have, with the value
        where it is a number; empty where there is none."""
        for card in self.deck:
            found = re.match(r"\*(CLEARANCE|CONTACT +INTERFERENCE)\b", card.upper())
            value = re.search(r"\bVALUE *= *([-+.\dE]+) *(?:,|$)", card.upper())
            if found and value:
                words = f"{found[0]}, {value[1]} {self.units.names.get('length', '')}".rstrip()
                return f"{words} here,".replace("-", "\N{MINUS SIGN}")
            if found:
                return found[0]
        return ""

    @cached_property
    def contact_names(self):
        """Names of the contact pairs in the order of the deck, those of a pattern by their numbers."""
        cards = "\n".join(self.deck).upper()
        pairs = re.findall(r"^\*CONTACT +PAIR\b((?:.*, *\n)*.*)\n *([^,\n]*)", cards, re.MULTILINE)
        given = [found[1] if (found := re.search(r"\bNAME *= *([^,\n]+?) *(?:,|$)", card)) else slave
                 for card, slave in pairs]

        def place(name):
            upper = name.upper()
            own = [k for k, each in enumerate(given) if upper == each]
            own += [k for k, each in enumerate(given) if upper.startswith(f"{each}-")]
            by_numbers = [(int(part), "") if part.isdecimal() else (-1, part)
                          for part in re.split(r"(\d+)", upper)]
            return [*own, len(given)][0], by_numbers

        return sorted(self.file["contact"], key=place) if "contact" in self.file else []

    def contact(self, name):
        """Return one contact pair by name, or those that a pattern means as one."""
        if PATTERN in name:
            words = ".*".join(map(re.escape, name.split(PATTERN)))
            found = [self.contact(each) for each in self.contact_names
                     if re.fullmatch(words, each, re.IGNORECASE)]
            if found:
                data, parts = join(found)
                return Contact(name, data, common([each.friction for each in found]),
                               common([each.pairing for each in found]) or "NODES", found[0].units,
                               parts)
        if name not in self.contact_names:
            known = ", ".join(self.contact_names) or "none"
            hint = nearest_name(name, self.contact_names)
            raise UserError(f"{self.path}: no contact '{name}'{hint} (contacts: {known})")
        group = self.file["contact"][name]
        data = self.contact_data(group)
        units = {key: text(item.attrs.get("unit", "")) for key, item in group.items()}
        friction = group.attrs.get("friction")
        need(group, friction is None or isinstance(friction, np.number), "friction is no number")
        pairing = text(group.attrs.get("pairing", "NODES"))
        return Contact(name, data, None if friction is None else float(friction), pairing, units,
                       slides="sliding" in group.attrs)

    def moved(self, contact, row, along):
        """Return how far contact points that follow sliding have moved along x or y at a row of
        /history; None where they stay, or the file has no fields then."""
        is_known = self.history["time"][row] in self.field_times
        if along == "s" or not (contact.slides and is_known):
            return None
        displacement = self.point_data("displacement", self.field_row(row))
        if displacement is None:
            return None
        of_node = dict(zip(self.cells.node_id.tolist(), displacement[:, "xy".index(along)]))
        return np.array([of_node.get(int(node), 0.0) for node in contact["slave_node"]])

    def contact_data(self, group):
        """Return the datasets of a contact by name."""
        points = len(numbers(group, "x", like=(None,)))
        need(group, points > 0, "there are no contact points")
        data = {"piece": np.ones(points)}  # files of earlier versions have faces of one piece
        data |= {key: numbers(group, key, like=(points,), finite=True) for key in GEOMETRY
                 if key in group or key not in data}
        states = {key: numbers(group, key, like=(self.increments, points)) for key in STATES}
        edges = {key: numbers(group, key, like=(self.increments, None)[: 1 + key.startswith("edges")])
                 for key in EDGES}
        need(group, np.all(np.diff(data["s"]) >= 0.0), "s does not grow along the face")
        need(group, np.isin(states["status"], (OPEN, SLIP, STICK)).all(), "status is not 0, 1 or 2")
        others = {key: numbers(group, key) for key in group
                  if key not in {*data, *states, *edges, FACES}}
        for key, values in others.items():
            fits = values.shape in ((self.increments,), (self.increments, points))
            need(group, fits, f"{key} has not one row for each increment")
        return data | states | edges | others

    def contacts(self, name=None):
        """Return the contact pairs asked for: the named one, or all."""
        if not self.contact_names:
            raise UserError(f"{self.path}: the deck has no contact")
        return [self.contact(each) for each in ([name] if name else self.contact_names)]

    def rows(self, loads=None, increments=None, with_fields=False):
        """Return rows of /history for loads, increments (from 1) or, with neither, the last. A load
        that no increment has, or none with fields, gives the nearest one, and a note of that."""
        if self.increments == 0:
            raise UserError(f"{self.path}: holds no accepted increment")
        times = self.history["time"]
        there = np.isin(times, self.field_times) if with_fields else np.ones(len(times), bool)
        rows = [self.row_of(load, np.flatnonzero(there)) for load in loads or ()]
        for number in increments or ():
            if not 1 <= number <= self.increments:
                raise UserError(
                    f"{self.path}: no increment {number}: there are 1 to {self.increments}"
                )
            rows.append(number - 1)
        return rows or [self.increments - 1]

    def row_of(self, load, there):
        """Return the row, of those that are `there`, whose load is nearest; the last one where
        several are."""
        loads = self.history["load"]
        low, high = loads.min(), loads.max()
        room = LOADS_TO * max(abs(low), abs(high))
        if not low - room <= load <= high + room:
            raise UserError(f"{self.path}: no increment has load {load:g}: there are {low:g} to {high:g}")
        if not there.size:
            raise UserError(f"{self.path}: holds no fields (thinned by FREQUENCY)")
        nearest = loads[there][np.argmin(np.abs(loads[there] - load))]
        if f"{nearest:g}" != f"{load:g}":
            self.notes.append(f"{self.path}: no increment{' with fields' * (there.size < loads.size)} "
                              f"has load {load:g}; the nearest, {nearest:g}, is drawn")
        same = there[np.abs(loads[there] - nearest) <= room]
        if same.size > 1:
            self.notes.append(f"{self.path}: increments {runs_text(same + 1)} have load {nearest:g}; the "
                              "last is drawn, --increment draws another")
        return int(same[-1])

    def load_words(self, row):
        """Return load and time of a row of /history in words, and what is not known there."""
        words = self.units.load_value(self.load_label, float(self.history["load"][row]))
        if self.load_label != "time":
            words += f", {self.units.time_value(float(self.history['time'][row]))}"
        factor = float(self.load_factors[row])
        words += "" if np.isnan(factor) else f", load factor {number_text(factor)}"
        return words if self.judged[row] else f"{words}\n({UNJUDGED})"

    def row_words(self, row):
        """Return what stands in a file name for a row of /history: its load, and its increment
        where other increments have that load too."""
        load = float(self.history["load"][row])
        words = [f"{each:g}" for each in self.history["load"]]
        return [load, "increment", row + 1] if words.count(f"{load:g}") > 1 else [load]

    @cached_property
    def cells(self):
        """Mesh as written: points, cells and what bounds them."""
        return Cells.read(self.file["VTKHDF"])

    def faces(self, contact):
        """Return the element edges of slave and master of a contact.

        Where its nodes are not paired, they are those that carry contact quantities: the slave's
        have contact points at their ends, the master's none. Faces that slide have all their nodes.
        """
        cells, group = self.cells, self.file["contact"][contact.name]
        if FACES in group:
            both = cells.face(numbers(group, FACES, like=(None,)))
            own = np.isin(cells.node_id[both[:, :2]], contact["slave_node"]).all(axis=1)
            return [both[own], both[~own]]
        if contact.pairing == "NODES":
            return [cells.face(contact[key]) for key in ("slave_node", "master_node")]
        ends = np.concatenate([each["slave_node"] for each in self.contacts()])
        step = len(self.field_times) - 1
        status = self.point_data("contact_status", step) if step >= 0 else None
        carry = np.zeros(len(cells.points), bool) if status is None else ~np.isnan(status)
        both = cells.face(cells.node_id[carry])
        of_slaves = np.isin(cells.node_id[both[:, :2]], ends).all(axis=1)
        own = np.isin(cells.node_id[both[:, :2]], contact["slave_node"]).all(axis=1)
        return [both[own], both[~of_slaves]]

    @cached_property
    def field_times(self):
        """Total times at which the file has fields."""
        return numbers(self.file["VTKHDF"], "Steps/Values", like=(None,), finite=True)

    def field_row(self, row):
        """Return the index of the VTKHDF time step that holds the increment in `row`."""
        times, time = self.field_times, self.history["time"][row]
        if len(times) == 0:
            raise UserError(f"{self.path}: holds no fields (thinned by FREQUENCY)")
        if time not in times:
            near = np.searchsorted(self.history["time"], times[np.argmin(np.abs(times - time))])
            raise UserError(
                f"{self.path}: no fields at increment {row + 1} (thinned by FREQUENCY); nearest "
                f"with fields: {near + 1}"
            )
        return int(np.flatnonzero(times == time)[-1])

    def point_data(self, name, step):
        """Return a point data array of /VTKHDF at a time step; None where it is absent."""
        return self.data_at("Point", name, step, len(self.cells.points))

    def cell_data(self, name, step):
        """Return a cell data array of /VTKHDF at a time step; None where it is absent."""
        return self.data_at("Cell", name, step, self.cells.count)

    def data_at(self, kind, name, step, count, rows=None):
        """Return `count` rows of point or cell data at a time step, or some of these, in ascending
        order; None where they are absent."""
        group = self.file["VTKHDF"]
        data = group.get(f"{kind}Data/{name}")
        if data is None:
            return None
        start = 0
        if f"Steps/{kind}DataOffsets/{name}" in group:
            offsets = numbers(group, f"Steps/{kind}DataOffsets/{name}")
            need(group, len(offsets) > step, f"{name} has no offset for each time")
            start = int(np.ravel(offsets[step])[0])
        columns = (COMPONENTS[name],) if name in COMPONENTS else ()
        fits = data.shape[1:] == columns and 0 <= start <= len(data) - count
        need(group, fits and data.dtype.kind in "biuf", f"{name} is no field of {count} rows a time")
        values = data[start : start + count] if rows is None else data[start + rows]
        need(group, name != "displacement" or np.isfinite(values).all(),
             "displacement has values that are no numbers")
        return values

    def source(self, quantity, step):
        """Return the array that a picture quantity is of, with all components, NaN at nodes of no
        element; None where it is absent."""
        name = (FIELD_SOURCES | FACE_SOURCES)[quantity][0]
        if quantity in CELL_FIELDS:
            return self.cell_data(name, step)
        values = self.point_data(name, step)
        values = self.stress_of(name, step) if values is None else values
        if values is None or self.cells.used.all():
            return values
        return np.where(self.cells.used.reshape(-1, *[1] * (values.ndim - 1)), values, np.nan)

    def stress_of(self, name, step):
        """Return principal, radial or hoop stress computed from the stress, where the file has the
        stress alone; None for other names."""
        stress = self.point_data("stress", step)
        if stress is None:
            return None
        if name == "principal_stress":
            return stresses.principal(stress)
        turned = {"radial_stress": stresses.radial, "hoop_stress": stresses.hoop}.get(name)
        return turned and turned(stress, self.cells.points, self.is_axisymmetric)

    def field(self, quantity, step):
        """Return a picture quantity over points or elements at a time step; None where it is
        absent."""
        _, component = (FIELD_SOURCES | FACE_SOURCES)[quantity]
        values = self.source(quantity, step)
        if quantity == "solid_fraction" and values is not None:
            values = np.where(self.melts, values, np.nan)
        return values if values is None or component is None else values[:, component]

    @cached_property
    def melts(self):
        """Which points are of bodies that are not solid at all times; all of them where none is."""
        cells, steps = self.cells, range(len(self.field_times))
        least = reduce(np.fmin, (self.point_data("solid_fraction", step) for step in steps))
        bodies = [cells.bodies[kind][(least[group] < 1.0).any(axis=1)]
                  for kind, group in cells.groups.items()]
        found = np.zeros(len(least), dtype=bool)
        for kind, group in cells.groups.items():
            found[group[np.isin(cells.bodies[kind], np.concatenate(bodies))]] = True
        return found if found.any() else ~found


def text(value):
    """Return an HDF5 string attribute as str, however it was stored."""
    if isinstance(value, np.ndarray):
        value = value.ravel()[0] if value.size else ""
    words = value.decode(errors="replace") if isinstance(value, bytes) else str(value)
    return printable(words)
