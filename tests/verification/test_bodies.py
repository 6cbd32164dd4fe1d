"""Several interfaces, rings and cracks, with heat: decks of tests/decks."""

import h5py
import numpy as np
from free_ends import KINDS, STRAIN, bent, free_fit, hot_ring
from inelastic import step
from manual import Case, Check, check_short, errors_panel
from pictures import save, subplots
from test_physics_contact import LAWS, sheared
from test_physics_cracks import HALF, arc_length, caliper, gassy
from test_physics_rings import CLOSED, RADII, tubes

TITLE = "Several interfaces, rings and cracks"
TEXT = """Uniform states are exact to rounding, with several interfaces, too; tubes, rings and the
crack converge; press fits are met to 0.002 MPa."""
PICTURE = "bodies"
CAPTION = "Errors of tubes and of a crack filled with gas, and the gap of that crack"
CALIPERS = {"pressed": -0.002, "apart": 0.02, "closed by heat": 0.009}
STACKS = {"upper interface weaker": (0.1, 0.3), "lower interface weaker": (0.25, 0.2)}


def checks_of(rows, chosen):
    """Return checks of rows (quantity, where, when, value, tolerance[, ABS]) of some quantities."""
    return [Check(f"{quantity}, {where}" + ("" if when == "LAST" else f", t = {when}"), quantity,
                  where, value, tolerance, *(how or ("REL",)), when=str(when))
            for quantity, where, when, value, tolerance, *how in rows if quantity in chosen]


def jaws(name):
    """Return a body whose two faces meet, against two rods."""
    cards, rows = caliper(CALIPERS[name])
    return cards, checks_of(rows, ("gap", "pressure", "conductance", "heat_flux"))


def stack(name):
    """Return three blocks with two interfaces, pushed aside and back."""
    cards, rows = sheared((STACKS[name], LAWS))
    chosen = [row for row in rows if row[2] in (2, 4, 6)]
    return cards, checks_of(chosen, ("shear", "slip", "heat_flux"))


def rings(count):
    """Return a hot tube in another, whole rings."""
    cards, known = tubes("CPE8", count, CLOSED)
    part = 16 / count
    return cards, [Check("normal force", "normal_force", "FACE", known["normal_force"],
                         1e-4 * part**4),
                   Check("heat rate", "heat_rate", "FACE", known["heat_rate"], 1e-4 * part**4),
                   Check("pressure at the nodes", "pressure", "FACE", known["pressure"],
                         0.02 * part**2)]


def gas_crack(count):
    """Return a crack that a tension opens, with gas in it, in a flow of heat across it."""
    cards, known = gassy(count, "strain", 0.05)
    middle, part = f"CRACK@{arc_length(cards, 0.0)!r}", (32 / count) ** 2
    return cards, [Check("gap in the middle", "gap", middle, known["gap"], 0.01 * part),
                   Check("T of the upper face", "slave_temperature", middle, known["jump"] / 2,
                         0.01 * part),
                   Check("heat flux in the middle", "heat_flux", middle, known["heat_flux"],
                         0.01 * part),
                   Check("heat through the gas", "heat_rate", "CRACK", known["heat_rate"],
                         0.02 * part)]


def bar(kind):
    """Return a bar that a force and moments about an excentric node stretch and bend along z."""
    cards, rows = bent(STRAIN, (0.7, -1.2), kind, True)
    return cards, [Check(name, name, where, value, tolerance)
                   for name, where, _, value, tolerance, *_ in rows
                   if name in ("U3", "UR1", "UR2") or name == "S33"]


def free_ring(around):
    """Return a ring with free ends and a logarithmic temperature."""
    cards, known = hot_ring(around)
    part = (32 / around) ** 2
    return cards, [
        Check("growth along z", "U3", str(known["U3"][0]), known["U3"][1], 2e-6 * part**2),
        *(Check(f"axial stress, {place}", "S33", str(known[place][0]), known[place][1], 0.02 * part)
          for place in ("bore", "outside"))]


PRESSURES = {"1.": 75.0, "2.": 54.37554, "101.": 20.47499, "1001.": 11.55326}


def creeping_fit(elements):
    """Return a press fit with free ends before its hub creeps, and after 1, 100 and 1000 h."""
    cards, area = free_fit(elements, *step("*VISCO", "0.01, 1000."))
    return cards, [Check(f"force after {float(when) - 1:g} h", "normal_force", "FIT", p * area,
                         0.002 / p, when=when) for when, p in PRESSURES.items()]


def cases():
    """Return the cases of the theme."""
    return [
        Case("A caliper",
             """Two faces of one body meet or stay apart: pressed by an overlap, apart with gas
             between them, and closed by heat alone. Laws of the gap and of the pressure,
             nu = 0.""",
             "Two rods in closed form: tests/reference/rods.py.",
             "1e-9: rounding. The states are uniform along the faces.",
             list(CALIPERS), jaws, named="state", short=3),
        Case("Three blocks, two interfaces",
             """A stack, pressed and hot at the top, is pushed aside until its weaker interface
             slips, on, and back until it slips back. Frictions and conductances of the interfaces
             differ.""",
             "Uniform shear and conduction through layers in closed form.",
             "1e-8 of the largest shear and slip, 1e-9 of the flux: rounding and the fixed point.",
             list(STACKS), stack, named="friction", short=2),
        Case("A hot tube in a tube",
             f"""Tubes of radii {RADII[0]:g} to {RADII[1]:g} and {RADII[1]:g} to {RADII[2]:g}, whole
             rings of CPE8 elements whose contact faces are closed, hot inside; heat closes them,
             and their pressure makes the contact conduct.""",
             """Lamé, and radial conduction (Timoshenko and Goodier, sections 28, 151):
             tests/reference/hot_tubes.py.""",
             """Sums 1e-4 with 16 elements around, falling with h^4, since sides are parabolas that
             leave the circle; pressures at nodes, forces over tributary lengths, 2 %, falling with
             h^2.""",
             [16, 32, 64], rings, lambda n: f"{n} around", short=1,
             order={"normal force": 3.5, "heat rate": 3.5, "pressure at the nodes": 1.7}),
        Case("Gas in an open crack",
             """A tension opens a crack in an infinite plate (plane strain), gas in it carries a
             part of a heat flow across it, and the rest makes the faces slide. The gap is an
             ellipse, so that the flux through the gas is uniform.""",
             """H. M. Westergaard, J. Appl. Mech. 6 (1939) A49; G. C. Sih, J. Appl. Mech. 29 (1962)
             587-589: tests/reference/crack.py.""",
             """1 % with 32 elements around the crack, 2 % for the sum, in which contact points at
             the tips count, falling with h^2: the order of displacements about a tip with quarter
             points.""",
             [32, 64, 128], gas_crack, lambda n: f"{n} around", short=1),
        Case("A bar that bends along z",
             """A force and moments about a node aside of a rectangle in generalized plane strain, whose
             section deforms freely.""",
             "N = E A e and M = E I kappa about both axes; uniaxial stress.",
             "1e-9: rounding. Displacements are quadratic.",
             KINDS, bar, named="element", short=4),
        Case("A hot ring with free ends",
             """A whole ring of radii 50 and 100 in generalized plane strain, CPEG8R, its temperature
             linear in log r, about a reference node aside of its axis. Nothing holds it along z.""",
             """Timoshenko and Goodier, section 151: it grows by its mean temperature, and the axial
             stress is that of plane strain less its mean.""",
             """2e-6 of the growth with 32 elements around, which falls with h^4 as sides that leave the
             circle do, 2 % of the stresses at nodes, falling with h^2.""",
             [16, 32, 64], free_ring, lambda n: f"{n} around", short=2,
             order={"growth along z": 3.5, "axial stress, bore": 1.8, "axial stress, outside": 1.8}),
        Case("A press fit with free ends that creeps",
             """A sector of a solid shaft 50 in a hub 50/100, 0.05 larger than its bore, one element
             around, each with a reference node of its own. E = 200 GPa, nu = 0.3; the hub creeps by
             3.125e-14 q^5/h. In plane strain the pressure would be 82.418. Forces are 13.09 times the
             pressures in MPa, 75, 54.376, 20.475 and 11.553.""",
             "Lamé with free ends; after that, tests/reference/creeping_fit.py, in one dimension.",
             """0.002 MPa, of a pressure of 11.553 in the end: sides that leave the circle, and increments
             of the default accuracy.""",
             [5, 10, 20], creeping_fit, lambda n: f"{n} through the hub", short=1, kind="EXTERNAL"),
    ]


def draw(runs, path):
    """Draw the errors, and the gap."""
    figure, (left, middle, right) = subplots(1, 3, 2.6)
    errors_panel(left, runs["A hot tube in a tube"], "Tube in a tube")
    errors_panel(middle, runs["Gas in an open crack"], "Crack with gas")
    solved = runs["Gas in an open crack"][0]
    widest = solved.checks[0].value
    x = np.linspace(-1, 1, 201)
    right.plot(x, 1e3 * widest * np.sqrt(1 - x**2), label="ellipse")
    with h5py.File(solved.result) as file:
        face = file["contact/CRACK"]
        right.plot(face["x"][:] / HALF, 1e3 * face["gap"][-1], ".", label="32 around")
    right.set_xlabel("x/a")
    right.set_ylabel("1000 gap")
    right.set_title("Gap of the crack")
    right.legend(loc="lower center")
    save(figure, path)


def test_bodies(tmp_path):
    import test_bodies

    check_short(test_bodies, tmp_path)
