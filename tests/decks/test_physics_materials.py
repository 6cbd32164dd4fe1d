"""Orthotropic and anisotropic materials, turned in the plane, in states known in closed form."""

import numpy as np
import pytest
from physics import follows, judge, material, mesh, nodes_of, outer_nodes
from test_physics_planes import PLANES, checks, moved, static

import conduction
import plates

XS, YS = [0.0, 0.4, 1.0, 1.7], [0.0, 0.5, 1.2]
CONSTANTS = {"E1": 4000.0, "E2": 1500.0, "E3": 900.0, "nu12": 0.25, "nu13": 0.2, "nu23": 0.3,
             "G12": 700.0, "G13": 500.0, "G23": 400.0}
EXPANSION = {"a1": 1e-5, "a2": 3e-5, "a3": 5e-5}
STRAIN = np.array([1e-3, -4e-4, 6e-4])
RISE = 40.0


def orientation(degrees, name="TURNED"):
    """Return the card of material axes turned anticlockwise: points on the first and second."""
    first, second, _ = plates.turn(degrees).T
    data = [*first, *second]
    return [f"*ORIENTATION, NAME={name}, SYSTEM=RECTANGULAR",
            ", ".join(f"{float(v):.15g}" for v in data)]


def elastic_deck(family, constants, kind="ENGINEERING CONSTANTS", degrees=0.0, strain=STRAIN):
    """Return the cards of a body of one material under a uniform strain, and its checks."""
    stiffness = plates.engineering(*constants.values())
    turned = plates.turned(stiffness, degrees)
    data = {"ENGINEERING CONSTANTS": list(constants.values())}.get(kind)
    axes, section = orientation(degrees), ", ORIENTATION=TURNED"
    if kind == "ANISO":   # given along x and y
        data, axes, section = plates.constants(turned, "ANISO"), [], ""
    elif kind == "ORTHO":
        data = plates.constants(stiffness, "ORTHO")
    cards = mesh("BODY", XS, YS, family + "8", skew=0.05)
    deck = [*axes, *cards, *material("BODY", data, elastic_type=kind, section=section),
            *static(*moved(cards, strain))]
    return deck, checks(plates.stress(turned, strain, PLANES[family]), cards, strain)


@pytest.mark.parametrize("degrees", [0.0, 30.0, -75.0])
@pytest.mark.parametrize("kind", ["ENGINEERING CONSTANTS", "ORTHO", "ANISO"])
@pytest.mark.parametrize("family", ["CPE", "CPS"])
def test_uniform_strain_of_an_anisotropic_body(tmp_path, family, kind, degrees):
    judge(tmp_path, *elastic_deck(family, CONSTANTS, kind, degrees))


@pytest.mark.parametrize("constant", ["E1", "E2", "nu12", "nu13", "nu23", "G12"])
@pytest.mark.changes("ELASTIC")
def test_every_constant_in_the_plane_counts(tmp_path, constant):
    """E3, G13, G23 and the other kinds of data stand in test_values_materials.py."""
    def make(factor):
        return elastic_deck("CPE", CONSTANTS | {constant: factor * CONSTANTS[constant]})

    follows(tmp_path, make, 1.0, 0.8)


@pytest.mark.changes("ORIENTATION")
def test_orientation_turns_the_stiffness(tmp_path):
    follows(tmp_path, lambda degrees: elastic_deck("CPE", CONSTANTS, degrees=degrees), 15.0, 20.0)


def heated(family, expansion, degrees=0.0, start=5.0, rise=RISE):
    """Return a body that is held on its sides and heated, and its checks."""
    turned = plates.turned(plates.engineering(*CONSTANTS.values()), degrees)
    alpha = plates.turned(np.diag(list(expansion.values())), degrees)
    cards = mesh("BODY", XS, YS, family + "8")
    deck = [*orientation(degrees), *cards,
            *material("BODY", CONSTANTS.values(), elastic_type="ENGINEERING CONSTANTS",
                      expansion=expansion.values(), expansion_type="ORTHO",
                      section=", ORIENTATION=TURNED"),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"BODY, {start!r}",
            *static(*moved(cards, np.zeros(3)), "*TEMPERATURE", f"BODY, {start + rise!r}")]
    stress = plates.stress(turned, np.zeros(3), PLANES[family], alpha, rise)
    return deck, checks(stress, cards, np.zeros(3))


@pytest.mark.parametrize("degrees", [0.0, 25.0])
@pytest.mark.parametrize("family", ["CPE", "CPS"])
def test_stress_of_a_heated_orthotropic_body_that_is_held(tmp_path, family, degrees):
    judge(tmp_path, *heated(family, EXPANSION, degrees))


@pytest.mark.parametrize("coefficient", EXPANSION)
@pytest.mark.changes("EXPANSION")
def test_every_expansion_counts(tmp_path, coefficient):
    follows(tmp_path, lambda factor: heated("CPE", EXPANSION | {
        coefficient: factor * EXPANSION[coefficient]}), 1.0, 1.1)


def test_thermal_strain_is_counted_from_the_initial_temperature(tmp_path):
    """The body is brought to one temperature from two initial ones."""
    follows(tmp_path, lambda start: heated("CPS", EXPANSION, start=start, rise=50.0 - start),
            5.0, 10.0)


def test_free_heated_body_has_no_stress(tmp_path):
    """Strains are alpha dT in turned axes; plane stress."""
    degrees = 35.0
    alpha = plates.turned(np.diag(list(EXPANSION.values())), degrees)
    strain = RISE * np.array([alpha[0, 0], alpha[1, 1], 2 * alpha[0, 1]])
    cards = mesh("BODY", XS, YS, "CPS8")
    nodes = nodes_of(cards)
    origin, end = (next(n for n, p in nodes.items() if p == q) for q in ((0.0, 0.0), (1.7, 0.0)))
    deck = [*orientation(degrees), *cards,
            *material("BODY", CONSTANTS.values(), elastic_type="ENGINEERING CONSTANTS",
                      expansion=EXPANSION.values(), expansion_type="ORTHO",
                      section=", ORIENTATION=TURNED"),
            *static("*BOUNDARY", f"{origin}, 1, 2", f"{end}, 2", "*TEMPERATURE", f"BODY, {RISE!r}")]
    rows = [(name, "BODY", "LAST", 0.0, 1e-10, "ABS") for name in ("S11", "S22", "S33", "S12")]
    moves = plates.displacements(list(nodes.values()), strain)
    rows += [(f"U{k + 1}", n, "LAST", u[k], 1e-14, "ABS")
             for n, u in zip(nodes, moves, strict=True) for k in (0, 1)]
    judge(tmp_path, deck, rows)


def conducting(along, across, degrees, kind="CPE8", analysis="*HEAT TRANSFER"):
    """Return a body with a uniform temperature gradient, and the checks of its flux."""
    gradient = np.array([7.0, -3.0])
    cards = mesh("BODY", XS, YS, kind, skew=0.05)
    rows = [f"{n}, 11, 11, {100.0 + float(gradient @ p)!r}"
            for n, p in outer_nodes(cards).items()]
    deck = [*orientation(degrees), *cards,
            *material("BODY", conductivity=(along, across, 1.0), conductivity_type="ORTHO",
                      section=", ORIENTATION=TURNED"),
            "*STEP", f"{analysis}, STEADY STATE", "1., 1.", "*BOUNDARY", *rows, "*END STEP"]
    flux = -conduction.conductivity_tensor(along, across, degrees) @ gradient
    found = [(f"HFL{k + 1}", "BODY", "LAST", flux[k], 1e-9) for k in (0, 1)]
    return deck, found + [("NT", n, "LAST", 100.0 + gradient @ p, 1e-11)
                          for n, p in nodes_of(cards).items()]


@pytest.mark.parametrize("kind", ["CPE3", "CPE4", "CPE4I", "CPE6", "CPE8", "CPE8R"])
def test_uniform_flux_in_turned_axes(tmp_path, kind):
    judge(tmp_path, *conducting(3.0, 0.5, 40.0, kind))


@pytest.mark.parametrize("change", [(3.3, 0.5, 40.0), (3.0, 0.6, 40.0), (3.0, 0.5, 45.0)])
def test_both_conductivities_and_their_axes_count(tmp_path, change):
    follows(tmp_path, lambda values: conducting(*values), (3.0, 0.5, 40.0), change)
