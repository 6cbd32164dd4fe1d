"""The theme of recovered errors: the Zienkiewicz-Zhu estimate against true errors."""

import report  # isort: skip, it makes the modules below known
import h5py
import lame
import numpy as np
from deck_runs import solve
from energy_norm import errors

TITLE = "Estimated error of the mesh"
TEXT = """
Every run estimates the discretisation error of stress and of heat flux in each body:
`/history/stress_error` and `/history/heat_flux_error`, the energy norm of the difference between
the recovered and the computed field over the norm of both
([theory.md](theory.md#6-recovery-of-printed-quantities)). Effectivity is the estimate over the true
error. It is between 0.94 and 1.21 on smooth fields and near singularities, and on rings once an
element turns by less than about 6 degrees.
"""
DETAILS = """
True errors are integrated from nodal values and the closed-form solution, at other points than the
program's. Meshes have n x n quadrilaterals, or twice as many triangles; corners are moved by
up to a quarter of the spacing, and all nodes of the outline are prescribed.
"""
IN_DOCUMENT = []
YOUNG, POISSON, CONDUCTIVITY = 1000.0, 0.3, 2.0
KINDS = {"CPE8": 8, "CPE8R": 8, "CPE4": 4, "CPE6": 6, "CPE3": 3}
HEAD = ["elements", "n", "true error of stress", "effectivity", "of heat flux", "effectivity"]
BOUNDS = 0.8, 1.25


def grid(nodes, n):
    """Return coordinates on the unit square and cells."""
    rng = np.random.default_rng(3)
    corner = np.stack(np.meshgrid(*[np.linspace(0, 1, n + 1)] * 2, indexing="ij"), 2)
    corner[1:-1, 1:-1] += 0.5 / n * (rng.random((n - 1, n - 1, 2)) - 0.5)
    places, number, cells = [], {}, []

    def node(place):
        key = tuple(np.round(place, 9))
        if key not in number:
            number[key] = len(places)
            places.append(place)
        return number[key]

    for i, j in np.ndindex(n, n):
        a, b, c, d = corner[i, j], corner[i + 1, j], corner[i + 1, j + 1], corner[i, j + 1]
        halves = [[a, b, c], [a, c, d]] if (i + j) % 2 else [[a, b, d], [b, c, d]]
        for shape in [[a, b, c, d]] if nodes in (4, 8) else halves:
            cell = [node(place) for place in shape]
            if nodes > 4:
                cell += [node((p + q) / 2) for p, q in zip(shape, shape[1:] + shape[:1])]
            cells.append(cell)
    return np.array(places), np.array(cells)


class Potential:
    """u = grad phi and T = phi_x of a harmonic phi, given its second derivative as f(z)."""

    def __init__(self, slope, curvature):
        self.slope, self.curvature = slope, curvature

    def displacement(self, x, y):
        w = 1e-3 * self.slope(x + 1j * y)
        return np.stack([w.real, -w.imag], 1)

    def stress(self, x, y):
        w = 1e-3 * YOUNG / (1 + POISSON) * self.curvature(x + 1j * y)
        return np.stack([w.real, -w.real, 0 * x, -w.imag], 1)

    def temperature(self, x, y):
        return self.slope(x + 1j * y).real

    def heat_flux(self, x, y):
        w = -CONDUCTIVITY * self.curvature(x + 1j * y)
        return np.stack([w.real, -w.imag], 1)


class Tube:
    """Lame's tube, radii 1 and 2, under unit inner pressure; T is linear in log r."""

    def stresses(self, r):
        return lame.cylinder(r, 1.0, 2.0, inside=1.0)

    def displacement(self, x, y):
        r = np.hypot(x, y)
        u = lame.displacement(r, *self.stresses(r), YOUNG, POISSON, "strain")
        return np.stack([x, y], 1) * (u / r)[:, None]

    def stress(self, x, y):
        r = np.hypot(x, y)
        radial, hoop = self.stresses(r)
        c, s = x / r, y / r
        return np.stack([radial * c**2 + hoop * s**2, radial * s**2 + hoop * c**2,
                         POISSON * (radial + hoop), (radial - hoop) * c * s], 1)

    def temperature(self, x, y):
        return 100 * np.log(np.hypot(x, y))

    def heat_flux(self, x, y):
        return -100 * CONDUCTIVITY * np.stack([x, y], 1) / (x**2 + y**2)[:, None]


SMOOTH = Potential(lambda z: np.exp(2 * z), lambda z: 2 * np.exp(2 * z))
TIP = Potential(np.sqrt, lambda z: 0.5 / np.sqrt(z))


def to_ring(x):
    """Bend the unit square to a quarter ring."""
    radius, angle = 1 + x[:, 0], np.pi / 2 * x[:, 1]
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], 1)


def write(path, kind, x, cells, outline, case):
    """Write a deck: equilibrium, then heat, with the exact values on the outline."""
    u, t = case.displacement(*x.T), case.temperature(*x.T)
    cards = ["*NODE, NSET=ALL"]
    cards += [f"{k}, {p[0]:.14g}, {p[1]:.14g}" for k, p in enumerate(x, 1)]
    cards += [f"*ELEMENT, TYPE={kind}, ELSET=BODY"]
    cards += [", ".join(map(str, [k, *(cell + 1)])) for k, cell in enumerate(cells, 1)]
    cards += ["*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG}, {POISSON}", "*CONDUCTIVITY",
              f"{CONDUCTIVITY}", "*SOLID SECTION, ELSET=BODY, MATERIAL=M",
              "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 0", "*STEP", "*STATIC", "1, 1",
              "*BOUNDARY"]
    cards += [f"{k + 1}, {i + 1}, {i + 1}, {u[k, i]:.14g}" for k in outline for i in (0, 1)]
    cards += ["*END STEP", "*STEP", "*HEAT TRANSFER, STEADY STATE", "1, 1", "*BOUNDARY"]
    cards += [f"{k + 1}, 11, 11, {t[k]:.14g}" for k in outline]
    path.write_text("\n".join([*cards, "*END STEP"]) + "\n")


def elasticity():
    """Return stresses xx, yy, zz, xy from strains."""
    shear = YOUNG / (2 * (1 + POISSON))
    matrix = np.diag([2 * shear, 2 * shear, 2 * shear, shear])
    matrix[:3, :3] += YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    return matrix


def measure(folder, kind, n, case, place):
    """Return (true error, effectivity) of stress, then of heat flux."""
    x, cells = grid(KINDS[kind], n)
    outline = np.flatnonzero((x.min(1) < 1e-9) | (x.max(1) > 1 - 1e-9))
    x = place(x)
    deck = folder / f"{kind}-{n}.inp"
    write(deck, kind, x, cells, outline, case)
    with h5py.File(solve(deck)) as file:
        points = {name: file["VTKHDF/PointData"][name][-len(x):]
                  for name in ("displacement", "temperature")}
        estimates = [file["history"][f"{name}_error"][-1, 0] for name in ("stress", "heat_flux")]
    matrix = elasticity()

    def stress(gradient, more=0.0):
        a, b = gradient[:, 0], gradient[:, 1]
        return np.stack([a[:, 0] + more, b[:, 1] + more, 0 * a[:, 0] + more,
                         a[:, 1] + b[:, 0]], 1) @ matrix

    true = [errors(x, cells, points["displacement"][:, :2], stress, case.stress,
                   np.linalg.inv(matrix), kind == "CPE4"),
            errors(x, cells, points["temperature"][:, None],
                   lambda gradient: -CONDUCTIVITY * gradient[:, 0], case.heat_flux,
                   np.eye(2) / CONDUCTIVITY)]
    relative = np.sqrt([error / energy for error, energy in true])
    return [float(relative[0]), float(estimates[0] / relative[0]),
            float(relative[1]), float(estimates[1] / relative[1])]


def table(folder, title, text, case, place, sizes, judged=()):
    """Return the table of a case; effectivities of the sizes that are judged must be near 1."""
    rows = []
    for kind in KINDS:
        for n in sizes:
            row = measure(folder, kind, n, case, place)
            good = all(BOUNDS[0] < row[i] < BOUNDS[1] for i in (1, 3))
            rows.append([kind, n, *row, report.verdict(good) if n in judged else ""])
    return report.Table(title, [*HEAD, "0.8 to 1.25"], rows, text)


def tables(folder):
    """Return the tables of the theme."""
    return [
        table(folder, "A smooth field on a square", "u = grad phi, T = phi_x, phi = e^2x cos 2y / 4.",
              SMOOTH, lambda x: x, (16,), judged=(16,)),
        table(folder, "Lame's tube and a hot tube", "A quarter ring of radii 1 and 2.",
              Tube(), to_ring, (16,), judged=(16,)),
        table(folder, "A singularity", "Stress and flux grow as r^-1/2 to the middle of a side, as at the tip of a "
              "crack: all elements converge as h^1/2. Effectivities stay near 1, though no patch can follow there.",
              TIP, lambda x: x - [0.5, 0.0], (16,)),
    ]


def test_recovered(tmp_path):
    """Effectivities are near 1, and the document tells the same."""
    report.check(__import__(__name__), tmp_path)
