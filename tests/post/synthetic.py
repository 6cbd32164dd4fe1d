"""A small result file, laid out as thercon's, with fields in closed form: half a cylinder on a
base.

Contact is Hertz's (pressure p0 sqrt(1 - x^2/a^2)) with Cattaneo's friction, stick for x < c. Half
width a and stick width c grow with the square root of the load. Two blocks of eight-node elements
meet on y = x^2/(2 R) (cylinder, the slave) and y = 0 (base).
"""

from dataclasses import dataclass

import h5py
import numpy as np

RADIUS, WIDTH, HEIGHT = 100.0, 20.0, 20.0
FRICTION, PEAK = 0.155, 90.0
QUADRATIC_QUAD = 23


@dataclass
class Options:
    """What the file holds; the defaults are the cylinder's."""

    loads: tuple = tuple(np.arange(60.0, 901.0, 60.0))
    columns: int = 10
    rows: int = 4
    units: str = "cm MPa W C"
    label: str = "temperature of node set TOP"
    heat: bool = True
    friction: float | None = FRICTION
    contacts: tuple = ("CYLINDER",)
    fields_every: int = 1
    failing: bool = False


def write_result(path, **choices):
    """Write a result file to `path`; return its Options."""
    options = Options(**choices)
    mesh = build_mesh(options)
    with h5py.File(path, "w") as file:
        run = file.create_group("run")
        run.attrs["version"] = "0.0.0"
        for k, name in enumerate(("length", "stress", "power", "temperature")):
            run.attrs[f"unit_{name}"] = (options.units.split() or [""] * 4)[k]
        file["deck"] = np.array([b"*HEADING", b"synthetic"])
        write_history(file, options)
        for name in options.contacts:
            write_contact(file.create_group(f"contact/{name}"), mesh, options)
        write_convergence(file, options)
        write_fields(file.create_group("VTKHDF"), mesh, options)
    return options


def edge_of_contact(load):
    """Return the half width a at a load."""
    return 7.5 * np.sqrt(load / 900.0)


def edge_of_stick(load):
    """Return the half width c of the stick zone; NaN while it is narrower than the first pairs."""
    c = 0.6 * edge_of_contact(load) - 0.4
    return np.where(c > 0.0, c, np.nan)


def build_mesh(options):
    """Return nodes (n, 2), cells (m, 8), bodies (m) and the pairs' slave and master nodes."""
    points, cells, bodies, faces = [], [], [], []
    for body in (1, 2):
        index, start = {}, len(points)
        for j in range(2 * options.rows + 1):
            for i in range(2 * options.columns + 1):
                if i % 2 and j % 2:
                    continue
                index[i, j] = len(points)
                points.append(place(i / (2 * options.columns), j / (2 * options.rows), body))
        for j in range(0, 2 * options.rows, 2):
            for i in range(0, 2 * options.columns, 2):
                ring = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
                cells.append([index[i + di, j + dj] for di, dj in ring])
                bodies.append(body)
        side = 0 if body == 1 else 2 * options.rows
        faces.append([index[i, side] for i in range(2 * options.columns + 1)])
        assert start <= min(faces[-1])
    return np.array(points), np.array(cells), np.array(bodies), np.array(faces)


def place(u, v, body):
    """Return the point of a body at mesh coordinates in [0, 1], fine near the contact."""
    x = WIDTH * (0.4 * u + 0.6 * u**3)
    if body == 1:
        low = x**2 / (2.0 * RADIUS)
        return x, low + (HEIGHT - low) * v**1.6
    return x, -HEIGHT * (1.0 - v) ** 1.6


def write_history(file, options):
    """Write /history; time is the load."""
    loads = np.array(options.loads)
    group = file.create_group("history")
    group["time"] = loads
    group["load"] = loads
    group["load"].attrs["label"] = options.label
    unit = (options.units.split() or ["", "", "", "temperature"])[3]
    group["load"].attrs["unit"] = unit if options.label.startswith("temperature") else "time"
    group["iterations"] = np.full(len(loads), 4)
    group["stress_error"] = np.linspace(0.01, 0.05, 2 * len(loads)).reshape(-1, 2)


def write_contact(group, mesh, options):
    """Write /contact/<name>: Hertz pressure, Cattaneo friction, a flux that peaks at the edge."""
    points, _, _, (slave, master) = mesh
    x, y = points[slave].T
    s = np.concatenate(([0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))))
    loads = np.array(options.loads)[:, None]
    a, c = edge_of_contact(loads), edge_of_stick(loads)
    inside = np.sqrt(np.clip(1.0 - (x / a) ** 2, 0.0, None))
    core = np.nan_to_num(np.sqrt(np.clip(1.0 - (x / c) ** 2, 0.0, None)) * c / a)
    pressure = PEAK * a / 7.5 * inside
    status = np.where(x < a, 1, 0)
    if options.friction is not None:
        group.attrs["friction"] = options.friction
        group["shear"] = -options.friction * PEAK * a / 7.5 * (inside - core)
        status = np.where(x < np.nan_to_num(c), 2, status)
    if options.friction is None:
        c = np.full_like(c, np.nan)
    data = {
        "x": x,
        "y": y,
        "s": s,
        "weight": np.gradient(s),
        "pressure": pressure,
        "status": status,
    }
    data |= {"gap": np.clip(x**2 - a**2, 0.0, None) / (2.0 * RADIUS)}
    data |= {"slave_node": slave + 1, "master_node": master + 1}
    if options.heat:
        data["heat_flux"] = loads / 900.0 * np.where(x < a, 1.5 + 3.0 * (x / a) ** 8, 0.03)
    for key, place in (("contact", a[:, 0]), ("stick", c[:, 0])):
        edge = np.interp(place, x, s, left=np.nan)
        data[f"edge_{key}"] = edge
        data[f"edges_{key}"] = np.column_stack((edge, np.full((len(edge), 3), np.nan)))
    for key, values in data.items():
        group[key] = values
    group["pressure"].attrs["unit"] = (options.units.split() or ["", "stress"])[1]


def write_convergence(file, options):
    """Write /convergence: four iterations an increment, then one increment that never ends."""
    rows = []
    for increment in range(1, len(options.loads) + 1):
        rows += [
            (increment, i, 0.1 / increment * 10.0 ** (-2.5 * i), 0.6, 1.0, 0) for i in range(1, 5)
        ]
    if options.failing:
        increment = len(options.loads) + 1
        for cut_back in (0, 1):
            rows += [
                (increment, i, 0.3 + 0.2 * (-1) ** i, 0.05, 0.4, cut_back) for i in range(1, 16)
            ]
    columns = np.array(rows).T
    group = file.create_group("convergence")
    group["increment"], group["iteration"] = columns[0].astype(int), columns[1].astype(int)
    group["residual"], group["g_min"], group["g_max"] = columns[2:5]
    group["cut_backs"] = columns[5].astype(int)
    group["pairs_changed"] = np.zeros(columns.shape[1], dtype=int)


def write_fields(group, mesh, options):
    """Write /VTKHDF: temperature linear in y, a jump at the contact, stress decaying from it."""
    points, cells, bodies, (slave, _) = mesh
    count = len(points)
    group.attrs["Version"], group.attrs["Type"] = (2, 0), np.bytes_("UnstructuredGrid")
    group["NumberOfPoints"], group["NumberOfCells"] = [count], [len(cells)]
    group["NumberOfConnectivityIds"] = [cells.size]
    group["Points"] = np.column_stack((points, np.zeros(count)))
    group["Connectivity"], group["Offsets"] = cells.ravel(), np.arange(len(cells) + 1) * 8
    group["Types"] = np.full(len(cells), QUADRATIC_QUAD, dtype=np.uint8)
    group["CellData/body"], group["CellData/element_id"] = bodies, np.arange(1, len(cells) + 1)
    loads = np.array(options.loads)
    kept = [k for k in range(len(loads)) if (k + 1) % options.fields_every == 0]
    first_of_base = slave.min() + count // 2
    arrays = {"node_id": np.tile(np.arange(1, count + 1), len(kept))}
    parts = [fields_at(points, np.arange(count) >= first_of_base, loads[k]) for k in kept]
    for name in parts[0]:
        if name != "temperature" or options.heat:
            arrays[name] = np.concatenate([part[name] for part in parts])
    steps = group.create_group("Steps")
    steps.attrs["NSteps"] = len(kept)
    steps["Values"] = loads[kept]
    for name, values in arrays.items():
        group[f"PointData/{name}"] = values
        steps[f"PointDataOffsets/{name}"] = np.arange(len(kept)) * count
    for name in ("stress_error", "heat_flux_error")[: 1 + options.heat]:
        group[f"CellData/{name}"] = np.concatenate([errors_at(len(cells), loads[k]) for k in kept])
        steps[f"CellDataOffsets/{name}"] = np.arange(len(kept)) * len(cells)


def errors_at(count, load):
    """Return an error of each element: larger from one to the next."""
    return load / 900.0 * np.arange(1.0, count + 1.0)


def fields_at(points, base, load):
    """Return the point data of one load."""
    x, y = points.T
    a = edge_of_contact(load)
    temperature = load * (0.5 + np.where(base, -0.08, 0.08) + 0.42 * y / HEIGHT)
    depth = np.hypot(np.clip(np.abs(x) - 0.5 * a, 0.0, None), y)
    yy = -PEAK * a / 7.5 / (1.0 + (depth / a) ** 2)
    stress = np.column_stack((0.4 * yy + 5.0, yy, 0.3 * yy, -0.2 * yy * x / WIDTH))
    down = np.where(base, 0.0, -(a**2) / (2.0 * RADIUS)) * (1.0 - x / WIDTH / 2.0)
    displacement = np.column_stack((0.01 * x * load / 900.0, down, 0.0 * x))
    return {
        "temperature": temperature,
        "displacement": displacement,
        "stress": stress,
        "von_mises": np.abs(0.7 * yy),
    }
