"""Results of runs as arrays and tables; arrays are read from the file when they are asked for."""

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from .post.checked_file import numbers
from .post.errors import UserError, nearest_name
from .post.report.listing import read_listing
from .post.result import Result as ResultFile
from .post.result import text
from .post.set_histories import KINDS, OF_MEMBERS, member_labels

ESTIMATED = ("value", "uncertainty", "change", "scatter", "iteration")


class Arrays(Mapping):
    """Arrays by name: `these.pressure` and `these["pressure"]` are the same one.

    units: the unit of each array by its name, `""` or `"-"` where it has none. Where the deck names
        no units they are those of what is measured, such as `stress length^2`.
    times: (n,) total times of the rows.
    """

    def __init__(self, what, readers, units, times, members=()):
        """Take what the arrays are of, in words, for each name a procedure that reads it, and the
        labels of the members of a set."""
        self._what, self._readers, self._known = what, readers, {}
        self.units, self.times, self._members = units, times, members

    def __getitem__(self, name):
        """Return the array; (n, ...) where it has one row for each time."""
        if name not in self._readers:
            raise self._missing(name, self._readers)
        if name not in self._known:
            self._known[name] = self._readers[name]()
        return self._known[name]

    def _missing(self, name, known):
        hint = nearest_name(str(name), known)
        return KeyError(f"{self._what} has no {name}{hint}; it has {', '.join(known)}")

    def __getattr__(self, name):
        """Return the array of this name."""
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self[name]
        except KeyError as error:
            raise AttributeError(error.args[0]) from None

    def __iter__(self):
        """Iterate over the names."""
        return iter(self._readers)

    def __len__(self):
        """Return how many there are."""
        return len(self._readers)

    def __dir__(self):
        """Return the names, for completion."""
        return [*super().__dir__(), *self]

    def __repr__(self):
        """Return what these are and their names."""
        return f"<{self._what}: {', '.join(self)}>"

    def table(self):
        """Return the arrays with one or a few numbers for each time as a pandas data frame, whose
        index is the time; columns of arrays (n, k) are numbered from 1, those of sets named by node
        or element and integration point: `temperature_31`, `stress_xx_7.2`. `attrs["units"]` has the
        units."""
        import pandas

        columns = {}
        for name in self:
            values = self[name]
            if not isinstance(values, np.ndarray) or len(values) != len(self.times):
                continue
            if self._members and name in OF_MEMBERS:
                continue
            if values.ndim == 1:
                columns[name] = values
            elif values.ndim == 2 and self._members:
                columns |= {f"{name}_{each}": column for each, column in zip(self._members, values.T)}
            elif values.ndim == 2:
                columns |= {f"{name} {k + 1}": column for k, column in enumerate(values.T)}
        columns.pop("time", None)
        frame = pandas.DataFrame(columns, index=pandas.Index(self.times, name="time"))
        frame.attrs["units"] = dict(self.units)
        return frame


class History(Arrays):
    """Arrays of `/history`; the sets of *NODE PRINT and *EL PRINT are found by name in any case, too:
    `history["TOP"]` is `history.nodes["TOP"]`."""

    def __getitem__(self, name):
        """Return the array, or the `Arrays` of the set."""
        if name in self._readers:
            return super().__getitem__(name)
        places = {f'{kind}["{each}"]': (kind, each) for kind in KINDS if kind in self._readers
                  for each in self[kind]}
        found = [place for place, (_, each) in places.items() if each.upper() == str(name).upper()]
        if len(found) == 1:
            kind, each = places[found[0]]
            return self[kind][each]
        if found:
            raise KeyError(f"{name} is a set of nodes and one of elements: "
                           f"{' or '.join(f'history.{place}' for place in found)}")
        sets = [each for _, each in places.values()]
        raise self._missing(name, [*self._readers, *sets])


class Interface(Arrays):
    """One contact pair, over n increments and m contact points, in the order of the slave face.

    Arrays (m,): x, y, s (arc length), weight (area), slave_node, master_node. Arrays (n, m):
    pressure, shear, gap, status (0 open, 1 slip, 2 stick), heat_flux, conductance, slave_temperature,
    master_temperature, slip ... Arrays (n,): normal_force, shear_force, heat_rate, peak_pressure,
    edge_contact, edge_stick ... docs/results.md describes all of them and their signs.

    name, friction (coefficient of friction, or None) and pairing are as in the deck.
    """

    def __init__(self, contact, times):
        """Take a contact of the file."""
        self.name, self.friction, self.pairing = contact.name, contact.friction, contact.pairing
        self._totals = contact.totals()
        units = contact.units | {"peak_pressure": contact.units.get("pressure", "")}
        data = contact.data | {"peak_pressure": self._totals["peak_pressure"]}
        super().__init__(f"interface {contact.name}", {key: values.view for key, values in data.items()},
                         units, times)

    def table(self):
        """Return the quantities of the whole interface, (n,) each, as a pandas data frame, whose index
        is the time."""
        import pandas

        frame = pandas.DataFrame(self._totals, index=pandas.Index(self.times, name="time"))
        frame.attrs["units"] = {name: self.units.get(name, "") for name in frame}
        return frame

    def points(self, row=-1):
        """Return the contact points at one increment as a pandas data frame, one row for each.

        row: the increment, as an index of `times`.
        """
        import pandas

        columns = {key: values for key, values in self.items() if len(values) == len(self["x"])
                   and values.ndim == 1 and key not in self._totals}
        columns |= {key: values[row] for key, values in self.items()
                    if values.shape == (len(self.times), len(self["x"]))}
        frame = pandas.DataFrame(columns)
        frame.attrs["units"] = {name: self.units.get(name, "") for name in frame}
        return frame


class Node(Arrays):
    """One node at the k times for which the file has fields, which `FREQUENCY=` may thin.

    Arrays (k,): temperature, von_mises ...; (k, 3): displacement (x, y, z), heat_flux, principal_stress;
    (k, 4): stress (xx, yy, zz, xy). docs/results.md lists all of them under "Point data". NaN where
    the node has no such quantity.

    number: of the node in the deck; x, y: its coordinates before deformation.
    """

    def __init__(self, file, number, points):
        """Take the file, and the points of the grid that the node is."""
        self.number, self._points = number, points
        self.x, self.y = map(float, file.cells.points[points[0], :2])
        group = file.file["VTKHDF/PointData"]
        names = [key for key in group if key != "node_id"]
        super().__init__(f"node {number}", {key: lambda key=key: self._read(file, key) for key in names},
                         {key: text(group[key].attrs.get("unit", "")) for key in names}, file.field_times)

    def _read(self, file, name):
        """Return a quantity at all times; it must be the same in all points of the node."""
        count = len(file.cells.points)
        found = [file.data_at("Point", name, step, count, self._points) for step in range(len(self.times))]
        values = np.array(found).reshape(len(self.times), len(self._points), *np.shape(found)[2:])
        if not np.array_equal(values, np.broadcast_to(values[:, :1], values.shape), equal_nan=True):
            raise UserError(f"{name} of node {self.number} is averaged for each of its bodies and "
                            f"materials: name one, as in node({self.number}, body=1)")
        return values[:, 0]


class Result:
    """The result of a run: what the file `NAME.vtkhdf` holds, as docs/results.md describes it.

    path: of the file; name: `NAME`; times: (n,) total times of the accepted increments.
    status, outcome, checks, messages and document are those of the run; `thercon.open` knows the
    first two alone, from the file: status 0, 4 where *VERIFY checks failed, None where the run was
    not finished.

    >>> result = thercon.open("results/joint")
    >>> result.interfaces
    ['JOINT']
    """

    def __init__(self, path, document=None, messages=()):
        """Open a file; `document` is what `--json` printed of its run."""
        self._file = ResultFile(path)
        self.path, self.name = self._file.path, self._file.name
        self.times = self._file.history["time"]
        self.document, self.messages = document or {}, list(messages)
        attributes = self._file.file["run"].attrs
        known = (0, "solved") if attributes.get("finished", 1) else (None, "not finished")
        if known[0] == 0 and attributes.get("verify_failed", 0):
            known = 4, "check failed"
        self.status, self.outcome = (self.document.get(key, value) for key, value in
                                     zip(("status", "outcome"), known))

    def __repr__(self):
        """Return what result it is."""
        return f"<result {self.path}: {self.outcome}, {len(self.times)} increments>"

    def close(self):
        """Close the file; what was read of it stays."""
        self._file.file.close()

    def __enter__(self):
        """Return the result, which is closed at the end of the block."""
        return self

    def __exit__(self, *_):
        """Close the file."""
        self.close()

    @property
    def units(self):
        """Units of the deck by what is measured: length, stress, power, temperature; `""` without
        `*OPTIONS, UNITS=`. Each array and table has the units of its own (`units`, `attrs["units"]`).
        """
        attributes = self._file.file["run"].attrs
        return {name.removeprefix("unit_"): text(attributes[name]) for name in attributes
                if name.startswith("unit_")}

    @property
    def interfaces(self):
        """Names of the contact pairs, in the order of the file."""
        return self._file.contact_names

    def interface(self, name):
        """Return one contact pair as an `Interface`; the case of its name does not matter.

        >>> joint = result.interface("joint")
        >>> joint.pressure.shape, joint.units["pressure"]
        ((4, 5), 'stress')
        >>> joint.s
        array([ 0. ,  2.5,  5. ,  7.5, 10. ])
        """
        named = {each.upper(): each for each in self.interfaces}
        return Interface(self._file.contact(named.get(name.upper(), name)), self.times)

    def node(self, number, body=None, material=None):
        """Return one node as a `Node`.

        number: in the deck; nodes of a divided mesh are numbered on.
        body, material: of which body and which material, numbered from 1. A node between several has
            stress and heat flux of each, and this is needed for them.

        >>> node = result.node(8)
        >>> node.temperature
        array([ 50., 100., 150., 200.])
        >>> node.displacement.shape, node.units["stress"]
        ((4, 3), 'stress')
        """
        cells = self._file.cells
        points = np.flatnonzero(cells.node_id == number)
        for name, value in (("body", body), ("material", material)):
            if value is not None:
                points = np.intersect1d(points, self._points_of(name, value))
        if not len(points):
            where = "".join(f" in {name} {value}" for name, value in
                            (("body", body), ("material", material)) if value is not None)
            raise UserError(f"{self.path}: there is no node {number}{where}")
        return Node(self._file, number, points)

    def _points_of(self, name, value):
        """Return the points of the cells that belong to a body or are of a material."""
        grid = self._file.file["VTKHDF"]
        owner = np.repeat(numbers(grid, f"CellData/{name}"), np.diff(numbers(grid, "Offsets")))
        return numbers(grid, "Connectivity")[owner == value]

    @cached_property
    def history(self):
        """Arrays of `/history`, (n,) or (n, bodies) each, as `Arrays`: time, load, heat_in ...

        `history["SET"]` are those of a set of *NODE PRINT or *EL PRINT; of a name that sets of nodes
        and of elements have, `history.nodes["SET"]` and `history.elements["SET"]`. `table()` is a
        data frame.

        >>> result.history.heat_in.round(3)
        array([2.057, 3.   , 3.429, 3.6  ])
        >>> result.history.table().loc[1.0, "heat_in"].round(3)
        np.float64(3.6)
        """
        return self._group("history", History)

    @property
    def convergence(self):
        """Arrays of `/convergence`, one value for each iteration, as `Arrays`."""
        return self._group("convergence")

    @property
    def stability(self):
        """Arrays of `/stability`, one value for each analysis of *STABILITY, as `Arrays`."""
        return self._group("stability")

    @property
    def accuracy(self):
        """Arrays of `/accuracy`, one value for each round of a requested accuracy, as `Arrays`."""
        return self._group("accuracy")

    def _group(self, name, kind=Arrays):
        if name not in self._file.file:
            raise UserError(f"{self.path}: has no /{name}")
        return arrays_of(self._file.file[name], f"/{name}", self.times, kind)

    @cached_property
    def errors(self):
        """Numerical uncertainties (95 %) as a pandas data frame, one row for each quantity and time.

        Columns: time, where (interface, body or `increment`), quantity, value, uncertainty, its parts
        change, scatter and iteration, and unit. Rows are ends of steps, with ERRORS=FULL all
        increments. uncertainty is NaN where there is none; `summary` says why.

        >>> result.errors.query("quantity == 'heat_rate'")[["time", "where", "value"]].round(6)
           time  where  value
        0   1.0  JOINT    3.6
        """
        import pandas

        rows = [(time, where, key, *values, unit)
                for where in self._estimated for key, (unit, _, found, _) in
                self._file.uncertainties(where).items()
                for time, values in zip(self.times, found) if not np.isnan(values[0])]
        frame = pandas.DataFrame(rows, columns=["time", "where", "quantity", *ESTIMATED, "unit"])
        return frame

    @cached_property
    def summary(self):
        """The last increment as a pandas data frame, with a row for each quantity by its name in
        *VERIFY, such as `heat_rate JOINT`, or `von_mises body 1`.

        Columns: value, uncertainty (95 %, NaN: none), unit, no_estimate (why there is none).

        >>> result.summary.loc["heat_rate JOINT", ["value", "unit"]].tolist()
        [3.6, 'power']
        """
        import pandas

        rows = {}
        for name in self.interfaces:
            contact, known = self._file.contact(name), self._file.uncertainties(name)
            for key, values in contact.totals().items():
                unit = contact.units.get("pressure" if key == "peak_pressure" else key, "")
                estimate = estimate_of(known.get(key), self._file.reason_of(key))
                if contact.is_end_of_face(key, values[-1]):
                    estimate = np.nan, "end of the face"
                rows[f"{key} {name}"] = (values[-1], *estimate, unit)
        rows |= self._ranges()
        known = self._file.uncertainties("increment")
        for key in ("heat_in", "heat_out", "solid_time"):
            if key in self.history:
                rows[key] = (self.history[key][-1], *estimate_of(known.get(key)), self.history.units[key])
        for name, known in self._file.maxima.items():
            for key, entry in known.items():
                if not np.isnan(entry[2][-1, 0]):
                    rows[f"{key} {name}"] = (entry[2][-1, 0], *estimate_of(entry), entry[0])
        columns = ["value", "uncertainty", "no_estimate", "unit"]
        frame = pandas.DataFrame.from_dict(rows, orient="index", columns=columns)
        return frame[["value", "uncertainty", "unit", "no_estimate"]]

    def _ranges(self):
        """Return the extremes of the fields at the last increment as rows of the summary; none where
        the file has no fields then."""
        file, rows = self._file, {}
        if self.times[-1] not in file.field_times:
            return rows
        step = file.field_row(len(self.times) - 1)
        temperature, displacement = (file.point_data(name, step) for name in ("temperature", "displacement"))
        if temperature is not None:
            for key, value in (("lowest_temperature", np.nanmin(temperature)),
                               ("highest_temperature", np.nanmax(temperature))):
                rows[key] = value, np.nan, "", self._unit("temperature")
        if displacement is not None:
            largest = np.nanmax(np.linalg.norm(displacement, axis=1))
            rows["largest_displacement"] = largest, np.nan, "", self._unit("displacement")
        return rows

    def _unit(self, name):
        return text(self._file.file[f"VTKHDF/PointData/{name}"].attrs.get("unit", ""))

    @property
    def checks(self):
        """The *VERIFY checks of the run as a pandas data frame, in the order of the deck: quantity,
        where, expected, found, deviation, tolerance, passed ... (docs/results.md). A check that fails
        raises no exception. Of a result of `thercon.open`, and where `resume` skipped the run, they are
        those of the listing beside it, with its digits, and `where` of at most 16 characters.
        """
        import pandas

        rows = self.document.get("checks") or (checks_of_listing(self._file) if self._file.verify_cards else [])
        return pandas.DataFrame(rows)

    @property
    def _estimated(self):
        """Names of what has numerical uncertainties."""
        return [*self.interfaces, *self._file.maxima, "increment"]


def checks_of_listing(file):
    """Return the checks that the listing beside a result has, as `--json` prints them."""
    path = file.path.with_suffix(".lst")
    listing = read_listing(path, file.deck)
    if listing is None:
        raise UserError(f"{file.path}: its checks are in its listing, and {path} is missing, "
                        "incomplete or of another deck")
    last = file.history["time"][-1]
    return [{"quantity": each.quantity, "where": each.where,
             **({"expected": float(each.expected), "tolerance": float(each.allowed),
                 "kind": "relative" if each.measure == "REL" else "absolute"}
                if each.expected != "-" else {}),
             "passed": each.verdict == "PASS" or each.kind == "NONE" and not each.failed.startswith("the run"),
             **({"reason": each.failed} if each.found == "-" else
                {"time": last if each.time == "LAST" else float(each.time), "found": float(each.found)}),
             **({"deviation": float(each.deviation)} if each.deviation != "-" else {}),
             **({"node": int(each.node)} if each.node else {}),
             **({"uncertainty": float(each.uncertainty)} if each.uncertainty else {}),
             **({} if each.no_estimate is None else {"no_estimate": each.no_estimate})}
            for each in listing.checks]


def estimate_of(entry, why=""):
    """Return uncertainty at the last increment, and why there is none, of an entry of
    `uncertainties`; `why` where there is no entry."""
    if entry is None:
        return np.nan, why
    _, _, rows, why = entry
    return (np.nan, why) if why else (rows[-1, 1], "")


def arrays_of(group, what, times, kind=Arrays):
    """Return the datasets of a group of the file, and the groups in it, as `Arrays`."""
    readers, units = {}, {}
    word = next((KINDS[each] for each in KINDS if what.startswith(f"/history/{each}/")), None)
    if "time" in group:
        times = numbers(group, "time", like=(None,))
    for key, item in group.items():
        if hasattr(item, "keys"):
            readers[key] = lambda item=item, key=key: arrays_of(item, f"{what}/{key}", times)
        elif item.dtype.kind in "biuf":
            readers[key] = lambda key=key: numbers(group, key)
            units[key] = text(item.attrs.get("unit", ""))
        else:
            readers[key] = lambda item=item: [text(each) for each in np.ravel(item[()])]
    return kind(what, readers, units, times, word and member_labels(group, word))
