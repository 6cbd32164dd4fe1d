"""Elements: fields that are known everywhere, and thick cylinders."""

from dataclasses import dataclass

import h5py
import manufactured
import numpy as np
from manual import Case, Check, check_short, log_sizes, order_of, solve, verdict
from pictures import save, subplots
from document import Table
from physics import material, mesh, nodes_of

import lame

TITLE = "Elements"
TEXT = """Manufactured fields, a tube, a cantilever and a membrane: every element converges with its
theoretical order. In the tube with Poisson's ratios up to 0.49999, CAX8R, CAX4, CAX4I and CAX6 stay
within 0.6 %; CAX8 and CAX3 lock above 0.49, and the program warns."""
PICTURE = "elements"
CAPTION = "Errors of manufactured solutions and of thick cylinders over the mesh"
KINDS = [family + nodes for nodes in ("8", "8R", "6", "4", "4I", "3") for family in ("CPE", "CPS", "CAX")]
FINEST = {2: 16, 1: 32}  # elements a side, by that order
ORDER = {"8": 2, "8R": 2, "6": 2, "4": 1, "4I": 1, "3": 1}  # of the polynomials


@dataclass
class Manufactured(Case):
    """The manufactured solution with every element."""

    def tables(self, folder, meshes):
        """Return the table of all elements, and the errors for the picture."""
        heads = ["T", "grad T", "u", "grad u"]
        columns = [column for head in heads for column in (head, "order")]
        table = Table(self.title, ["element", "mesh"] + columns
                      + ["nodes judged", "largest share of allowed", "verdict"], text=self.text())
        found = {}
        for kind in KINDS:
            before = None
            degree = ORDER[kind[3:]]
            # Linear elements reach their order on finer meshes.
            for n in [*meshes, 2 * meshes[-1]] if degree == 1 and len(meshes) > 1 else meshes:
                cards, checks = self.make((kind, n))
                solved = solve(folder, f"{kind}_{n}".lower(), cards, checks)
                errors = manufactured.norms(kind, n, nodal_values(solved.result))
                share = max(v.error / c.tolerance
                            for v, c in zip(solved.verdicts, checks, strict=True))
                holds = all(v.passed for v in solved.verdicts)
                orders = [None] * 4 if before is None else [
                    order_of(*pair) for pair in zip(before, errors, strict=True)]
                if n == FINEST[degree]:
                    holds &= all(o > least - 0.15 for o, least in
                                 zip(orders, (degree + 1, degree) * 2, strict=True))
                table.rows.append([kind, f"{n} x {n}"] + [
                    cell for error, order in zip(errors, orders, strict=True)
                    for cell in (f"{error:.2e}", "" if order is None else f"{order:.2f}")]
                    + [len(checks) // 3, f"{share:.2f}", verdict(holds)])
                before = errors
                found.setdefault(kind, []).append((n, errors))
        return [table], found


def nodal_values(path):
    """Return T, u_x, u_y of the only increment by the number of the node."""
    with h5py.File(path) as file:
        points = file["VTKHDF/PointData"]
        numbers, heat = points["node_id"][:], points["temperature"][:]
        moved = points["displacement"][:]
    return {int(n): np.array([t, *u[:2]]) for n, t, u in zip(numbers, heat, moved, strict=True)}


RADII = 1.0, 2.0


def tube(kind, n, poisson, tolerance):
    """Return a tube under internal pressure, n elements through its wall, and its checks."""
    inner, outer = RADII
    xs = list(np.linspace(inner, outer, n + 1))
    cards = [*mesh("TUBE", xs, [0.0, 0.3], kind), *material("TUBE", (1000.0, poisson)),
             "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "TUBE.BOTTOM, 2", "TUBE.TOP, 2",
             "*DSLOAD", "TUBE.LEFT, P, 1.", "*END STEP"]
    radial, hoop = lame.cylinder(inner, inner, outer, 1.0)
    moved = float(lame.displacement(inner, radial, hoop, 1000.0, poisson, "strain"))
    return cards, [Check("u_r at the bore", "U1", "TUBE.LEFT", moved, tolerance)], float(hoop)


def cylinder(n):
    """Return the tube of CAX8 and its checks."""
    cards, checks, hoop = tube("CAX8", n, 0.3, 2e-3 * (2 / n) ** 3)
    return cards, [*checks, Check("hoop stress at the bore", "S33", "TUBE.LEFT", hoop,
                                  0.1 * (2 / n) ** 2)]


@dataclass
class Incompressible(Case):
    """Thick cylinders of every element and Poisson's ratio."""

    def tables(self, folder, meshes):
        """Return the table of the errors of the bore: one row a ratio."""
        kinds = ["CAX8", "CAX8R", "CAX4", "CAX4I", "CAX6", "CAX3"]
        table = Table(self.title, ["nu", *kinds, "verdict"], text=self.text())
        found = []
        for poisson in meshes:
            errors, holds = [], True
            for kind in kinds:
                locks = kind in ("CAX8", "CAX3") and poisson > 0.49
                tolerance = 1.0 if locks else {"CAX3": 0.15, "CAX4I": 0.01}.get(kind, 0.005)
                cards, checks, _ = tube(kind, 6, poisson, tolerance)
                solved = solve(folder, f"nu{poisson}_{kind}".replace(".", "_").lower(), cards,
                               checks)
                errors.append(solved.verdicts[0].error)
                holds &= solved.verdicts[0].passed
            table.rows.append([f"{poisson:g}", *(f"{e:.1e}" for e in errors), verdict(holds)])
            found.append((poisson, errors))
        return [table], found


ELEMENTS_ALONG, BEAM = 6, (6.0, 0.2, 0.1)  # length, height, thickness
SLANTS = {"rectangles": (0, 0), "parallelograms": (1, 1), "trapezia": (-1, 1)}  # of odd, even sides
HYBRID = {"rectangles": 0.993, "parallelograms": 0.632, "trapezia": 0.052}


def beam(shape):
    """Return MacNeal and Harder's cantilever, one row of elements, and its check: sides between
    elements are upright or at 45 degrees."""
    length, height, thickness = BEAM

    def to(x, y):
        inner = 0 < x < ELEMENTS_ALONG
        slant = SLANTS[shape][int(x) % 2 == 0] if inner else 0
        return x * length / ELEMENTS_ALONG + slant * (y - height / 2), y

    cards = mesh("BEAM", list(range(ELEMENTS_ALONG + 1)), [0.0, height], "CPS4I", to=to)
    tip = next(n for n, p in nodes_of(cards).items() if abs(p[0] - length) + abs(p[1]) < 1e-9)
    return [*cards, *material("BEAM", (1e7, 0.3)), f"{thickness!r}", "*STEP", "*STATIC", "1., 1.",
            "*BOUNDARY", "BEAM.LEFT, 1, 2", "*CLOAD", "BEAM.RIGHT, 2, 0.5", "*END STEP"], [
                Check("u_y of the tip", "U2", str(tip), 0.1081 * HYBRID[shape],
                      5e-4 / HYBRID[shape] + 1e-4)]


def cook(n):
    """Return Cook's membrane of n x n CPS4I, and its check."""
    def to(x, y):
        return 48 * x, 44 * x + y * (44 - 28 * x)

    sides = list(np.linspace(0, 1, n + 1))
    cards = mesh("MEMBRANE", sides, sides, "CPS4I", to=to)
    middle = next(k for k, p in nodes_of(cards).items() if abs(p[0] - 48) + abs(p[1] - 52) < 1e-9)
    return [*cards, *material("MEMBRANE", (1.0, 1 / 3)), "*STEP", "*STATIC", "1., 1.", "*BOUNDARY",
            "MEMBRANE.LEFT, 1, 2", "*DSLOAD", f"MEMBRANE.RIGHT, TRVEC, {1 / 16!r}, 0., 1., 0.",
            "*END STEP"], [Check("u_y of C", "U2", str(middle), 23.96, 0.13 * 2 / n)]


def cases():
    """Return the cases of the theme."""
    return [
        Manufactured(
            "Manufactured solutions",
            """Temperatures and displacements given by smooth closed-form fields are prescribed on
            the outline of a unit square (axisymmetric: radii 1 to 2), and all nodes inside are
            judged. Plane: T = Re e^(1.5 z), and Kolosov and Muskhelishvili's displacements of phi =
            e^(1.5 z)/100, psi = (e^(1.5 z) + z^4)/100. Axisymmetric: T = z^3 - 3/2 z r^2, and
            Papkovich's displacements of B = T and b = z^4 - 3 z^2 r^2 + 3/8 r^4. Both satisfy the
            equations without sources and body forces. The inner corners of a mesh of 4 x 4 are
            moved by up to a quarter of a cell; each finer mesh divides every cell of it in four. E
            = 1000, nu = 0.3.""",
            """The fields themselves. N. I. Muskhelishvili, Some Basic Problems of the Mathematical
            Theory of Elasticity, 1953; S. P. Timoshenko, J. N. Goodier, Theory of Elasticity, 1970.
            Orders: O. C. Zienkiewicz, The Finite Element Method, 1977.""",
            """A node may be off by twice what the exact field differs, at most, from the field that
            its own nodal values make in the elements: a Galerkin solution is as good as the best
            field of the elements but for a constant. This figure comes from the exact field alone.
            Errors in the mean square, relative to the field, have to fall with the powers p + 1 for
            values and p for gradients, p = 2 for quadratic and 1 for linear elements, less 0.15, on
            the finest mesh.""",
            [4, 8, 16], lambda at: manufactured.deck(*at), short=1),
        Case(
            "Thick cylinder",
            """A tube of radii 1 and 2 in plane strain under an internal pressure of 1, E = 1000, nu
            = 0.3, in any consistent units; CAX8, n elements through the wall.""",
            "G. Lamé; Timoshenko and Goodier, section 28.",
            """Of the displacement 0.2 % with two elements, falling with h^3, the order of
            displacements (nodes do better); of the stress, which is extrapolated from inside the
            element to the bore, 10 % with two elements, falling with h^2.""",
            [2, 4, 8, 16], cylinder, lambda n: f"n = {n}", order={"u_r at the bore": 3.5,
                                                                  "hoop stress at the bore": 1.7},
            short=2),
        Incompressible(
            "Thick cylinder, nearly incompressible",
            """The same tube with six elements through the wall, for Poisson's ratios up to 1/2. The
            table has the relative error of the radial displacement of the bore.""",
            "As above.",
            """Elements that do not lock: 0.5 % at every ratio, of CAX4I 1 %, h^2/3, of CAX3 15 % up
            to 0.49. CAX8 and CAX3 lock: no error is promised above 0.49, and the program warns.""",
            [0.3, 0.49, 0.499, 0.49999], None),
        Case(
            "Cantilever of one row of elements",
            """A beam 6 long, 0.2 high and 0.1 thick of six CPS4I in one row, E = 1e7, nu = 0.3,
            held at one end under a force of 1 across it at the other. Sides between elements are
            upright, or at 45 degrees: parallelograms and trapezia.""",
            """R. H. MacNeal, R. L. Harder, Finite Elem. Anal. Des. 1 (1985) 3-20: theory 0.1081.
            The references are this times what the hybrid element of T. H. H. Pian and K. Sumihara,
            Int. J. Num. Meth. Eng. 20 (1984) 1685, has on these meshes, formed from its equations:
            0.993, 0.632 and 0.052. CPS4 has 0.093, 0.034 and 0.027.""",
            """Half of the last digit, and 1e-4, by which hybrid stresses and enhanced strains differ
            in these parallelograms.""",
            list(SLANTS), beam, kind="EXTERNAL", cite="MacNeal and Harder", named="elements",
            short=3),
        Case(
            "Cook's membrane",
            """A panel 48 wide, 44 high on the left, where it is held, and 16 on the right, where a
            uniform shear of 1 in all pulls it up; plane stress, E = 1, nu = 1/3. n x n CPS4I.""",
            """R. D. Cook, J. Struct. Div. ASCE 100 (1974) 1851-1863; converged 23.96 at C, the
            middle of the right side. The element of Pian and Sumihara has 21.13 and 23.02 with n =
            2 and 4, CPS4 11.8 and 18.3.""",
            "13 % with 2 x 2 elements, where that element has 12 %, halved on each finer mesh.",
            [2, 4, 8, 16], cook, lambda n: f"n = {n}", kind="EXTERNAL", cite="Cook 1974", short=2),
    ]


def draw(runs, path):
    """Draw the errors of u with every element, and those of the tube."""
    figure, (left, right) = subplots(1, 2, 2.9)
    found = runs["Manufactured solutions"]
    for nodes, marker in (("8", "o"), ("8R", "s"), ("6", "^"), ("4", "D"), ("4I", "x"), ("3", "v")):
        rows = found["CPE" + nodes]
        left.loglog([n for n, _ in rows], [e[2] for _, e in rows], marker=marker,
                    label="CPE" + nodes)
    left.set_title("Manufactured solution")
    log_sizes(left, [4, 8, 16, 32], "elements a side")
    left.set_ylabel("error of u in the mean square")
    left.legend(loc="lower left")
    for k, name in enumerate(("u_r at the bore", "hoop stress at the bore")):
        right.loglog([s.mesh for s in runs["Thick cylinder"]],
                     [s.verdicts[k].error for s in runs["Thick cylinder"]], marker="o", label=name)
    right.set_title("Thick cylinder, CAX8")
    log_sizes(right, [2, 4, 8, 16], "elements through the wall")
    right.set_ylabel("error")
    right.legend()
    save(figure, path)


def test_elements(tmp_path):
    import test_elements

    check_short(test_elements, tmp_path)
