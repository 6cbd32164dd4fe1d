"""Plasticity and creep: paths of strain, tubes, bars, press fits, Bree's plate, first yield."""

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, log, pi, sin, sqrt

import h5py
import numpy as np
from document import Table
from inelastic import (BORE, OUTSIDE, POISSON, SOFT, YIELD, YOUNG, A, N, bar, bree, fit, hill, law,
                       left, overlap, pressed, pulled, relaxing, step, strain_of_bree, stretched,
                       tube)
from manual import Case, Check, Verdict, check_short, errors_panel, log_sizes, solve, verdict
from physics import mesh, nodes_of
from pictures import save, subplots
from scipy.optimize import brentq
from test_contact import graded

TITLE = "Plasticity and creep"
TEXT = """Creep at constant stress is exact to rounding; paths and relaxation have the order of the
scheme; tubes, their collapse and press fits are met to 0.1 %, Bree's rates to 0.5 %.

For plastic flow in the plane use CPE8R, which has the collapse load of a tube on all meshes, or
CPE4I or CPE4, which approach it from above. CPE8 locks: on coarse meshes its load keeps growing
beyond collapse. CPE3 and CPE6 collapse at about the right load in a wrong shape, an oval."""
DETAILS = """Plasticity of von Mises without hardening. Where nothing else is said, E = 200 GPa, nu =
0.3, and the rate of creep is A q^n with n = 5 and A = 3.125e-14/(MPa^5 h). Units: mm, MPa, h."""
PICTURE = "inelastic"
CAPTION = "Errors of a bar that relaxes and of a tube that creeps, and collapse loads by elements"


@dataclass
class Read(Case):
    """A case with a row for each mesh of what no card judges.

    `read` returns a check of a run and its value.
    """

    read: Callable | None = None

    def tables(self, folder, meshes):
        """Return the table with these rows."""
        (table,), runs = super().tables(folder, meshes)
        for solved in runs:
            check, value = self.read(solved)
            error = abs(value - check.value) / (abs(check.value) if check.how == "REL" else 1.0)
            found = Verdict(value, error, error <= check.tolerance)
            table.rows.append(self.row(solved, check, found, None))
        return [table], runs


END = [(16.317215, 19.712236), (9.825444, 15.560181), (0.235107, -2.997115)]   # steps 4, 5, 8


def path(scheme):
    """Return a maker of the path of NAFEMS in some increments a step."""
    analysis, order = {"EULER": ("*STATIC", 1), "L-STABLE": ("*VISCO", 2)}[scheme]

    def make(increments):
        cards = [*mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPE4"),
                 *law("*PLASTIC", "5.", elastic=(250e3, 0.25)),
                 "*BOUNDARY", "BODY.LEFT, 1", "BODY.BOTTOM, 2"]
        strain = [0.0, 0.0]
        for k in range(8):
            strain[k // 2 % 2] += 2.5e-5 if k < 4 else -2.5e-5
            cards += step(f"{analysis}, DIRECT", f"{1 / increments!r}, 1.", "*BOUNDARY",
                          f"BODY.RIGHT, 1, 1, {strain[0]!r}", f"BODY.TOP, 2, 2, {strain[1]!r}",
                          options=", AMPLITUDE=RAMP")
        return cards, [
            Check(f"sigma_{'xy'[k] * 2}, step {at}", f"S{k + 1}{k + 1}", "BODY", stress[k],
                  0.7 / increments**order, "ABS", f"{at}.")
            for at, stress in zip((4, 5, 8), END, strict=True) for k in (0, 1)]

    return make


def straight(elements):
    """Return half of the square of the size of elements of the tube, over its bore: by this a
    straight line misses a stress that falls with the square of the radius."""
    return 0.5 * ((OUTSIDE - BORE) / BORE / elements) ** 2


RADII = {p: brentq(lambda c, p=p: hill(c)[0] - p, BORE, OUTSIDE) for p in (12.0, 14.0, 18.0)}
COLLAPSE = hill(OUTSIDE)[0]


def of_hill(elements):
    """Return the checks of the tube of Hill, whose time is its pressure."""
    checks = []
    for pressure, radius in RADII.items():
        _, moved, hoop = hill(radius)
        checks += [Check(f"{name} at p = {pressure:g}", quantity, "BODY.RIGHT", value,
                         straight(elements), when=f"{pressure!r}")
                   for name, quantity, value in (("u(b)", "U1", moved),
                                                 ("hoop stress of the outside", "S33", hoop))]
    return checks


def pressed_tube(elements):
    """Return the tube of Hill under a pressure that grows with time until it collapses."""
    return tube(["*PLASTIC", f"{YIELD!r}"], *pressed(20.0, times="1., 20."),
                elements=elements), of_hill(elements)


def collapse_of_tube(solved):
    """Return a check of the last load that was carried, and this load."""
    return Check("collapse", "", "", COLLAPSE, straight(solved.mesh)), solved.carried


def tube_of(kind):
    """Return the tube of Hill of another element."""
    return tube(["*PLASTIC", f"{YIELD!r}"], *pressed(18.0, times="1., 18."), kind=kind), [
        check for check in of_hill(20) if check.quantity == "U1"]


KINDS = ["CPE4", "CPE4I", "CPE8", "CPE8R", "CPE3", "CPE6"]
TO_TAKE = ["CPE4", "CPE4I", "CPE8R"]
NEAR = 0.99   # of the collapse
MOST = 1.1
SMALLEST = 1e-3   # increment of the load
NEAR_RADIUS = brentq(lambda c: hill(c)[0] - NEAR * COLLAPSE, BORE, OUTSIDE)


def quarter(kind, across, poisson, share):
    """Return a quarter of the tube of Hill, as many elements through it as around an eighth, up to
    a share of its collapse; time is the share."""
    def to(radius, angle):
        x, y = radius * cos(angle), radius * sin(angle)
        return (0.0 if abs(x) < 1e-9 * radius else x), y

    cards = mesh("BODY", [float(r) for r in np.linspace(BORE, OUTSIDE, across + 1)],
                 [float(t) for t in np.linspace(0.0, pi / 2, 2 * across + 1)], kind, to=to)
    return [*cards, *law("*PLASTIC", f"{YIELD!r}", elastic=(SOFT[0], poisson)),
            "*BOUNDARY", "BODY.BOTTOM, 2", "BODY.TOP, 1",
            *step("*STATIC, STRAIN LIMIT=1.", f"0.02, {share!r}, {SMALLEST!r}", "*NODE FILE, "
                  "FREQUENCY=0", "U", "*DSLOAD", f"BODY.LEFT, P, {share * COLLAPSE!r}")]


LOCKING = """Take CPE8R, which has the collapse load on all meshes, or CPE4I or CPE4, which come to
it from above; CPE4R is CPE4I here. CPE8 locks in flow that keeps the volume: on coarse meshes its
load goes on growing beyond collapse. With nu = 0.499 its elasticity locks, too, hence u(b) on
coarse meshes. CPE3 and CPE6 carry about the right load by a flow of their own, a tube that becomes
oval, CPE6 less so on finer meshes."""


@dataclass
class Locking(Case):
    """Collapse of the tube of Hill in elements of the plane."""

    def tables(self, folder, meshes):
        """Return the table of collapse loads and of displacements just before."""
        table = Table(self.title, ["element", "through the wall", "collapse load over exact",
                                   "u(b) over exact along x", "along y", "verdict"],
                      text=self.text())
        found = {}
        for kind in KINDS:
            for across in meshes:
                carried, one = self.collapse(folder, kind, across)
                moved, other = self.near(folder, kind, across)
                table.rows.append([
                    kind, across, f"{carried:.4f}" if carried else f"> {MOST}",
                    *(f"{value:.3f}" if value else "-" for value in moved),
                    verdict(one and other) if kind in TO_TAKE else ""])
                found.setdefault(kind, []).append(carried or MOST)
        return [table], found

    @staticmethod
    def allowed(across):
        """Return how far the collapse load of an element may be off."""
        return 0.05 * (2 / across) ** 2 + SMALLEST

    def collapse(self, folder, kind, across):
        """Return the last load that was carried, none if all were, and the verdict."""
        cards = quarter(kind, across, POISSON, MOST)
        half = [Check("half of the load", "time", "", 0.5, 1e-9, when="0.5")]
        carried = solve(folder, f"collapse_{kind}_{across}".lower(), cards, half,
                        may_end=True).carried
        return carried, carried is not None and abs(carried - 1) <= self.allowed(across)

    def near(self, folder, kind, across):
        """Return the displacements of the outside over the exact one, and the verdict."""
        cards = quarter(kind, across, SOFT[1], NEAR)
        exact, checks = hill(NEAR_RADIUS)[1], []
        for axis in (0, 1):
            node = next(n for n, place in nodes_of(cards).items()
                        if abs(place[axis] - OUTSIDE) < 1e-9)
            checks.append(Check("u(b)", f"U{axis + 1}", str(node), exact,
                                8 * self.allowed(across)))
        solved = solve(folder, f"near_{kind}_{across}".lower(), cards, checks, may_end=True)
        return [None if solved.carried else found.value / exact for found in solved.verdicts], \
            all(found.passed for found in solved.verdicts)


def plastic_hub(radius):
    """Return a press fit whose hub yields up to a radius."""
    tresca = 300.0 / 2 * (1 - (radius / 100.0) ** 2 + 2 * log(radius / 50.0))
    delta = 50.0 * 300.0 / YOUNG * (radius / 50.0) ** 2
    widest = 2 / sqrt(3.0)
    return [*fit("*PLASTIC", "300.", free=True), *overlap(delta),
            *step("*STATIC", "0.1, 1.", "*CONTACT INTERFERENCE",
                  f"SHAFT.RIGHT, BODY.LEFT, {delta!r}")], [
        Check("pressure", "pressure", "FIT@2.5", tresca * (1 + widest) / 2,
              (widest - 1) / (widest + 1))]


CREEPS = "*CREEP", f"{A!r}, {N!r}"


def crept(loads):
    """Return bars that creep at constant stresses: by Norton's law under one tension and two, and
    by laws of hardening under a second tension for another 100 h."""
    strain = A * 200.0**N * 1000.0
    both = ["*DSLOAD", "BODY.RIGHT, P, -200.", "BODY.TOP, P, -200."]
    primary = f"{A / 2!r}, {N!r}, -0.5"   # A q^n t^.5
    if loads == "one tension":
        return [*bar(*CREEPS), *pulled(200.0, "*VISCO", "1., 1000.")], creep_checks(
            strain, -strain / 2, -strain / 2)
    if loads == "two tensions":
        return [*bar(*CREEPS), *step("*VISCO", "1., 1000.", *both)], creep_checks(
            strain / 2, strain / 2, -strain)
    if loads == "primary creep":
        return [*bar("*CREEP, LAW=TIME", primary), *pulled(200.0, "*VISCO", "1., 1000.")], [
            Check("CEEQ", "CEEQ", "BODY", A * 200.0**N * sqrt(1000.0), 1e-6)]
    first, rate = A * 200.0**N * sqrt(100.0), A * 250.0**N
    if loads == "time hardening":
        last = first + rate * (sqrt(200.0) - sqrt(100.0))
    else:
        last = rate * sqrt((first / rate) ** 2 + 100.0)
    return [*bar(f"*CREEP, LAW={loads.split()[0].upper()}", primary),
            *pulled(200.0, "*VISCO", "1., 100."), *pulled(250.0, "*VISCO", "1., 100.")], [
        Check("CEEQ", "CEEQ", "BODY", last, 1e-6)]


def creep_checks(*strains):
    """Return the checks of creep strains."""
    return [Check(f"CE{axis}{axis}", f"CE{axis}{axis}", "BODY", strain, 1e-6)
            for axis, strain in enumerate(strains, 1)]


EARLY = 1 / ((N - 1) * A * YOUNG * 200.0 ** (N - 1))   # t0: the stress falls as (1 + t/t0)^(-1/4)


def relaxed(scheme):
    """Return a maker of a bar that relaxes in fixed increments."""
    def make(increments):
        part = 1 / increments
        allowed = {"IMPLICIT": 5 / 16 * part * log(1 / EARLY),
                   "L-STABLE": 0.1 * part**2 / EARLY}[scheme]
        return relaxing("*VISCO, DIRECT", f"{part!r}, 1.", f"*THERMAL SCHEME, TYPE={scheme}"), [
            Check("stress after 1 h", "S11", "BODY", left(1.0), allowed)]

    return make


def creeping_tube(elements):
    """Return a tube that creeps under pressure until its stresses are stationary."""
    cards = tube(CREEPS, *pressed(200.0, "*VISCO", "1.E-4, 10., 1.E-9"), elements=elements,
                 elastic=(YOUNG, POISSON))
    widest = (OUTSIDE / BORE) ** (2 / N)
    hoop = [200.0 * ((2 / N - 1) * ratio + 1) / (widest - 1) for ratio in (widest, 1.0)]
    return cards, [Check(f"hoop stress of the {name}", "S33", f"BODY.{side}", value,
                         straight(elements))
                   for name, side, value in zip(("bore", "outside"), ("LEFT", "RIGHT"), hoop,
                                                strict=True)]


FITS = ((0.0, 82.4176), (0.1, 73.773), (1.0, 56.350), (10.0, 36.158), (100.0, 21.003),
        (1000.0, 11.873))


def relaxing_fit(elements):
    """Return a press fit whose hub creeps."""
    return [*fit(*CREEPS, elements=elements), *overlap(0.05), *step("*STATIC", "1., 1."),
            *step("*VISCO", "1.E-4, 1000., 1.E-9")], [
        Check(f"pressure after {time:g} h", "pressure", "FIT@2.5", pressure, 1e-3,
              when=f"{1 + time!r}") for time, pressure in FITS]


def bolt(error):
    """Return the bolt of VM132 [psi]."""
    strain, start = 1000.0 / 30e6, 1e-6
    return [*bar("*CREEP", "4.8E-30, 7.", elastic=(30e6, 0.3)),
            *stretched(strain, "*STATIC", f"{start!r}, {start!r}"),
            *stretched(strain, f"*VISCO, LOCAL ERROR={error!r}", "1., 690.")], [
        Check(f"stress after {time:g} h", "S11", "BODY", stress, error, when=f"{time + start!r}")
        for time, stress in ((190.0, 974.985), (690.0, 925.026))]


CYCLES = 8
PLATES = {(0.8, 1.5): "ratchets", (0.6, 2.0): "ratchets", (0.3, 4.0): "ratchets",
          (0.4, 0.55): "elastic", (0.8, 0.75): "shakes down", (0.8, 0.85): "just ratchets",
          (0.2, 2.5): "flows to and fro", (0.3, 3.2): "flows to and fro",
          (0.3, 3.5): "just ratchets"}


def plate(of):
    """Return Bree's plate after some cycles."""
    strain = strain_of_bree(*of, CYCLES)
    judged = strain - 1 if PLATES[of] == "ratchets" else strain
    unit = 0.05 * 100.0 / YOUNG
    return bree(*of, f"*CYCLE, STEPS=2, REPEAT={CYCLES - 1}"), [
        Check("elongation", "U1", "BODY.RIGHT", strain * unit, 5e-3 * judged * unit, "ABS")]


YIELDS_AT, DEPTH = 1.79367, 0.7043   # pressure over yield stress, depth over half-width
SIZE, SIDE = 1000.0, 0.25            # of the block and of elements, in half-widths
MARGIN = 0.01


def under_cylinder(level):
    """Return a rigid cylinder on a block, pressed to just below the first yield and to just
    above."""
    stress = 100.0
    modulus = YOUNG / (1 - POISSON**2)
    radius = modulus / (2 * YIELDS_AT * stress)   # for a half-width of 1 at first yield
    across, down = graded(SIDE, 8, SIZE), graded(SIDE, 8, SIZE)
    cards = [*mesh("BLOCK", across, [-y for y in down[::-1]], "CPE8R"),
             "*NODE", f"900001, 0., {radius!r}", "*SURFACE, NAME=ARC, TYPE=SEGMENTS",
             f"START, {0.6 * radius!r}, {0.2 * radius!r}",
             f"CIRCL, {-0.6 * radius!r}, {0.2 * radius!r}, 0., {radius!r}",
             "*RIGID BODY, REF NODE=900001, ANALYTICAL SURFACE=ARC",
             *law("*PLASTIC", f"{stress!r}", name="BLOCK"), "*SURFACE INTERACTION, NAME=SMOOTH",
             "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE, PAIRING=NODES", "BLOCK.TOP, ARC",
             f"*REFINE, LEVELS={level}"]
    for share in (1 - MARGIN, 1 + MARGIN):   # of the width, and so of the pressure
        cards += step("*STATIC", "1., 1.", "*BOUNDARY", "BLOCK.LEFT, 1", "BLOCK.BOTTOM, 2",
                      "900001, 1", "900001, 6", "*CLOAD",
                      f"900001, 2, {-pi * modulus * share**2 / 8 / radius!r}")
    below = 1 - MARGIN
    return cards, [
        Check("pressure in the middle, below", "pressure", "FACE@0.", YIELDS_AT * stress * below,
              0.02 / 2**level, when="1."),
        Check("largest equivalent stress, below", "MISES", "MAX", stress * below, 0.02 / 4**level,
              when="1."),
        Check("largest plastic strain, below", "PEEQ", "MAX", 0.0, 1e-12, "ABS", "1.")]


def depth_of_yield(solved):
    """Return a check of the depth of the largest plastic strain, and the depth."""
    with h5py.File(solved.result) as file:
        count = int(file["VTKHDF/NumberOfPoints"][-1])
        strains = file["VTKHDF/PointData/equivalent_plastic_strain"][-count:]
        depth = -file["VTKHDF/Points"][-count:, 1][strains.argmax()]
    return Check("depth of the largest plastic strain, above", "", "", DEPTH * (1 + MARGIN),
                 SIDE / 2**solved.mesh, "ABS"), depth if strains.max() > 0.0 else float("nan")


def cases():
    """Return the cases of the theme."""
    increments, elements = "{} increments".format, "n = {}".format
    path_is = """One element in plane strain, E = 250 GPa, nu = 0.25, yield stress 5 MPa; eight
    steps of strain of 2.5e-5 each: twice along x, twice along y, then back, twice along x, twice
    along y."""
    path_from = """NAFEMS NL1 and PL1. References are the exact integral of the law along the
    path."""
    relaxes = "A bar at a fixed strain, from 200 MPa."
    relaxes_by = "s = (200^-4 + 4 A E t)^(-1/4)."
    return [
        Case("Path of strain, static", path_is + " `*STATIC`: the implicit rule of Euler.",
             path_from, """0.7/n MPa, n increments a step: twice what one increment a step errs by,
             0.35 after step 4, since the rule is of the first order.""",
             [20, 40, 80], path("EULER"), increments, short=3,
             order={f"sigma_{xy}, step {at}": 0.85 for xy in ("xx", "yy") for at in (4, 5, 8)}),
        Case("Path of strain in real time", path_is + " `*VISCO`: a scheme of the second order.",
             path_from, "0.7/n^2 MPa.", [20, 40, 80], path("L-STABLE"), increments, short=3,
             order={f"sigma_{xy}, step {at}": 1.85 for xy in ("xx", "yy") for at in (4, 5)},
             remarks="""After step 8, in which the element yields anew within an increment, the
             error depends on where in the increment that is."""),
        Read("Tube of Hill",
             """A tube of bore a = 100 and outside b = 200 mm in plane strain, E = 21 GPa, nu =
             0.499, yield stress s = 24 MPa, under a pressure p in the bore that grows until the
             tube collapses; n CAX8R through the wall. The collapse is the last load that was
             carried, as the message of the run has it.""",
             """R. Hill, The Mathematical Theory of Plasticity, 1950. Yielding up to a radius c: p =
             k (ln(c/a) + (1 - c^2/b^2)/2), k = 2 s/sqrt(3); collapse at c = b. What is outside c is
             elastic, so that its hoop stress at b is k c^2/b^2, and u(b) = (1 - nu^2) k c^2/(E b):
             3/4 of it is often printed, which is that of nu = 1/2 and 0.13 % less. That the plastic
             zone is taken as incompressible costs the square of 1 - 2 nu.""",
             """Half of (h/a)^2, h being the size of an element, 0.125 % with 20: by this a straight
             line misses a stress that falls with 1/r^2, as it does outside of c.""",
             [5, 10, 20, 40], pressed_tube, elements, short=2, may_end=True,
             named="through the wall", read=collapse_of_tube,
             remarks="""Errors depend on where in an element the plastic zone ends, and so have no
             order."""),
        Case("Tube of Hill, other elements",
             "The same with 20 elements through the wall, up to p = 18.", "As above.",
             "As above.",
             ["CAX8", "CAX4", "CAX4I"], tube_of, named="element", short=3),
        Locking(
            "Collapse in elements of the plane",
            """A quarter of the tube of Hill, as many elements through the wall as around an eighth
            of it; triangles are halves of quadrilaterals, cut all in one direction. The load grows
            in steps of 0.02 and at last of 0.001 of the exact collapse load, to 1.1 of it; nu =
            0.3, of which the collapse does not depend. The displacements of the outside along x and
            y are those at 0.99 of the collapse load, with nu = 0.499, as Hill's solution needs. A
            dash is a run that ended before.""",
            "As above.",
            """Only elements to take are judged. Collapse: 5 % with two elements, falling with the
            square of their size, and the last increment: flow that keeps the volume of each element
            gives an upper bound, whose error is of the second order in h/a. u(b): eight times this,
            because the pressure is k (1 - c/b)^2 below that of the collapse, so that 1 % below it a
            load that differs by 1 % makes 8 % of c^2.""",
            [2, 4, 8, 16], None, short=2, remarks=LOCKING),
        Case("Press fit with a plastic hub",
             """A solid shaft of radius 50 in a hub 50/100 of yield stress s = 300 MPa, which is
             shrunk on until it yields up to the radius c; ends are free. 20 CAX8R through the
             hub.""",
             """Equilibrium of a hub in plane stress with Tresca's condition, hoop stress less
             radial stress = s up to c: pressure p = s/2 (1 - c^2/100^2 + 2 ln(c/50)), interference
             50 (s/E) (c/50)^2.""",
             """Von Mises' condition lies between Tresca's and 2/sqrt(3) times as much, and so does
             the pressure. The reference is the middle of both, and the tolerance reaches to either.
             A hub that does not yield is beyond.""",
             [70.0, 80.0, 90.0], plastic_hub, "c = {:g}".format, named="hub", short=3),
        Case("Bars that creep",
             """An element under a tension of 200 MPa for 1000 h, also along both axes, and with
             primary creep, A q^n t^0.5. With the latter also 200 MPa for 100 h and then 250 for
             another 100 h, once the rate depends on time (LAW=TIME) and once on the strain
             (LAW=STRAIN).""",
             """Integrals of the laws at constant stress; J. T. Boyle, J. Spence, Stress Analysis
             for Creep, 1983.""",
             "1e-6: creep at a constant stress is integrated exactly.",
             ["one tension", "two tensions", "primary creep", "time hardening", "strain hardening"],
             crept, named="loads", short=5),
        Case("Relaxation, second order",
             relaxes + " `*VISCO` with increments of 1/n h and the scheme L-STABLE.", relaxes_by,
             """0.1 dt^2/(t t0), t0 = 0.025 h, in which the stress begins to fall: as for
             [heat](#transients), whose scheme it is.""",
             [40, 80, 160], relaxed("L-STABLE"), "n = {}".format, short=3,
             order={"stress after 1 h": 1.8}),
        Case("Relaxation, first order",
             relaxes + " The same with `*THERMAL SCHEME, TYPE=IMPLICIT`.", relaxes_by,
             """Twice the leading term of the rule of Euler, dt/2 f ln(f/f0) with the rates f and f0
             of the stress at the end and the start: 5/16 ln(t/t0) dt/t of the stress.""",
             [40, 80, 160], relaxed("IMPLICIT"), "n = {}".format, short=3,
             order={"stress after 1 h": 0.85}),
        Case("Bolt that relaxes",
             """A bar at a fixed strain, E = 30e6 psi, from 1000 psi, rate 4.8e-30 q^7 per psi^7 and
             h; increments are chosen for a LOCAL ERROR.""",
             "ANSYS Verification Manual, VM132. s = (1000^-6 + 6 A E t)^(-1/6).",
             """The local error: that of an increment is a part of the largest elastic strain, here
             of the stress, and later ones undo some of it.""",
             [1e-3, 1e-4, 1e-5], bolt, "{:g}".format, kind="EXTERNAL", cite="VM132",
             named="local error", short=3),
        Case("Tube that creeps",
             """A tube 100/200 in plane strain under 200 MPa until its stresses are stationary,
             after 10 h; n CAX8R through the wall.""",
             """Boyle and Spence: hoop stress p ((2/n - 1)(b/r)^(2/n) + 1)/((b/a)^(2/n) - 1) with
             the exponent n; elastic 333.33 in the bore and 133.33 outside.""",
             "Half of (h/a)^2, as for the tube of Hill.",
             [5, 10, 20, 40], creeping_tube, elements, short=4,
             order={"hoop stress of the bore": 1.7, "hoop stress of the outside": 1.7}),
        Case("Press fit that relaxes",
             """An elastic shaft of radius 50 in a hub 50/100 that creeps, interference 0.05 mm,
             plane strain; n CAX8R through the hub, LOCAL ERROR 1e-3.""",
             """At once Lamé's pressure; then an independent one-dimensional program, within 0.002
             MPa.""",
             "0.1 %.",
             [5, 10, 20], relaxing_fit, elements, kind="EXTERNAL", cite="one-dimensional program",
             named="elements", short=3),
        Case("Bree's plate",
             f"""A plate of yield stress s = 100 MPa under a constant tension X s, and temperatures
             across it that come and go {CYCLES} times, of elastic thermal stresses +- Y s; it stays
             straight. 40 CPS4 through a thickness of 1, 0.05 long.""",
             """J. Bree, J. Strain Analysis 2 (1967) 226-238. In units of s/E the strain grows in a
             cycle by 2 Y (1 - d), d = 2 sqrt((1 - X)/Y), if Y (1 - X) <= 1 and d < 1, and by 2 (X Y
             - 1) if Y (1 - X) > 1 and X Y > 1. From the same equilibrium of fibres the strain after
             m cycles is 1 and m times that; without growth X + Y (2 - d)^2/4 where it shakes down,
             X Y where it flows to and fro, and X where it is elastic. Boundaries are Y = 4 (1 - X)
             and X Y = 1.""",
             """0.5 % of the strain that has grown, and of the strain where none has or, next to a
             boundary, what grows is a small difference: fibres are two in an element, and edges of
             plastic zones lie between these.""",
             list(PLATES), plate, lambda of: f"X = {of[0]:g}, Y = {of[1]:g}: {PLATES[of]}",
             named="plate", short=9),
        Read(
            "First yield under a cylinder",
            """A rigid cylinder is pressed on a block of yield stress s = 100 MPa, 1000 half-widths
            of the contact wide and high, in plane strain, CPE8R of sides a/4 at the contact and
            finer. Half-width a and pressure are at first 1 % below, then 1 % above those of first
            yield.""",
            """K. L. Johnson, Contact Mechanics, 1985, chapter 4: stresses under a Hertz pressure p0
            along the line of symmetry. With nu = 0.3 the largest equivalent stress is p0/1.79367,
            0.7043 a deep.""",
            """Pressure: 2 % on the coarsest mesh, halved on each finer one, as for [Hertz's
            contacts](#contact). Equivalent stress: 2 % with elements of a/4, falling with the
            square of their sides, the order of stresses; the block, which is finite, changes it by
            the part of 0.1 %, the mean pressure at its foot. Nothing yields below. Above, the
            largest plastic strain, which the result file has at nodes, is within the side of an
            element of the depth.""",
            [0, 1, 2], under_cylinder, lambda level: f"a/{4 * 2**level}", short=2,
            read=depth_of_yield),
    ]


def draw(runs, path):
    """Draw errors over increments and elements, and collapse loads."""
    figure, (left, middle, right) = subplots(1, 3, 2.6)
    for order in ("first", "second"):
        solved = runs[f"Relaxation, {order} order"]
        left.loglog([s.mesh for s in solved], [s.verdicts[0].error for s in solved], marker="o",
                    label=f"{order} order")
    left.set_title("Relaxation")
    left.set_ylabel("error of the stress after 1 h")
    log_sizes(left, [s.mesh for s in solved], "increments an hour")
    left.legend()
    errors_panel(middle, runs["Tube that creeps"], "Tube that creeps")
    for kind, loads in runs["Collapse in elements of the plane"].items():
        right.plot([2, 4, 8, 16], loads, marker="o", label=kind)
    right.set_title("Collapse of Hill's tube")
    right.set_ylabel("load over exact")
    right.set_ylim(top=1.18)
    log_sizes(right, [2, 4, 8, 16], "elements through the wall")
    right.legend(ncols=2)
    save(figure, path)


def test_inelastic(tmp_path):
    import test_inelastic

    check_short(test_inelastic, tmp_path)
