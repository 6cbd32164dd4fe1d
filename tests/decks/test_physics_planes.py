"""Uniform states of every kind of element in plane strain, plane stress and about an axis."""

import numpy as np
import pytest
from physics import follows, judge, material, mesh, nodes_of, outer_nodes

import plates

YOUNG, POISSON = 1000.0, 0.3
STRAIN = np.array([1e-3, -4e-4, 6e-4])
XS, YS = [1.0, 1.4, 2.0, 2.7], [0.0, 0.5, 1.2]
PLANES = {"CPE": "strain", "CPS": "stress"}
KINDS = ["3", "4", "6", "8", "8R"]


def moved(cards, strain=STRAIN):
    """Return *BOUNDARY cards that move the nodes on the sides by a uniform strain."""
    nodes = outer_nodes(cards)
    moves = plates.displacements(list(nodes.values()), strain)
    rows = [f"{n}, {k + 1}, {k + 1}, {float(u[k])!r}"
            for n, u in zip(nodes, moves, strict=True) for k in (0, 1)]
    return ["*BOUNDARY", *rows]


def static(*cards):
    """Return a step."""
    return ["*STEP", "*STATIC", "1., 1.", *cards, "*END STEP"]


def checks(stress, cards, strain=STRAIN):
    """Return the checks of a uniform stress, and of the displacements within."""
    scale = float(np.abs(stress).max())
    rows = [(name, "BODY", "LAST", value, 1e-9 * scale, "ABS")
            for name, value in zip(("S11", "S22", "S33", "S12"), stress, strict=True)]
    nodes = nodes_of(cards)
    for n, u in zip(nodes, plates.displacements(list(nodes.values()), strain), strict=True):
        rows += [(f"U{k + 1}", n, "LAST", u[k], 1e-13, "ABS") for k in (0, 1)]
    return rows


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("family", ["CPE", "CPS"])
def test_uniform_strain_on_skewed_elements(tmp_path, family, kind):
    cards = mesh("BODY", XS, YS, family + kind, skew=0.06)
    stress = plates.stress(plates.isotropic(YOUNG, POISSON), STRAIN, PLANES[family])
    judge(tmp_path, [*cards, *material("BODY", (YOUNG, POISSON)), *static(*moved(cards))],
          checks(stress, cards))


@pytest.mark.parametrize("kind", KINDS)
def test_uniform_strain_about_an_axis(tmp_path, kind):
    """u_r = a r and u_z = b z: eps_rr = eps_tt = a, eps_zz = b."""
    radial, axial = 1e-3, -4e-4
    strain = np.array([radial, axial, 0.0])
    cards = mesh("BODY", XS, YS, "CAX" + kind, skew=0.06)
    factor = YOUNG / (1 + POISSON) / (1 - 2 * POISSON)
    hoop = factor * (radial + POISSON * axial)
    along = factor * ((1 - POISSON) * axial + 2 * POISSON * radial)
    judge(tmp_path, [*cards, *material("BODY", (YOUNG, POISSON)), *static(*moved(cards, strain))],
          checks(np.array([hoop, along, hoop, 0.0]), cards, strain))


@pytest.mark.parametrize("kind", KINDS)
def test_uniform_strain_of_a_cylinder_that_reaches_the_axis(tmp_path, kind):
    strain = np.array([1e-3, -4e-4, 0.0])
    cards = mesh("BODY", [0.0, 0.5, 1.2], YS, "CAX" + kind)
    factor = YOUNG / (1 + POISSON) / (1 - 2 * POISSON)
    hoop = factor * (strain[0] + POISSON * strain[1])
    along = factor * ((1 - POISSON) * strain[1] + 2 * POISSON * strain[0])
    judge(tmp_path, [*cards, *material("BODY", (YOUNG, POISSON)), *static(*moved(cards, strain))],
          checks(np.array([hoop, along, hoop, 0.0]), cards, strain))


@pytest.mark.parametrize("named", ["CPE8", "CPS8", "CAX8"])
@pytest.mark.changes("OPTIONS, PLANE")
def test_plane_option_overrides_the_names_of_the_elements(tmp_path, named):
    """Plane strain and plane stress differ in S33 and, under one strain, in S11."""
    def make(plane):
        cards = mesh("BODY", XS, YS, named)
        stress = plates.stress(plates.isotropic(YOUNG, POISSON), STRAIN, plane.lower())
        return [f"*OPTIONS, PLANE={plane}", *cards, *material("BODY", (YOUNG, POISSON)),
                *static(*moved(cards))], checks(stress, cards)

    follows(tmp_path, make, "STRAIN", "STRESS")


def test_plane_option_makes_a_mesh_axisymmetric(tmp_path):
    strain = np.array([1e-3, -4e-4, 0.0])
    cards = mesh("BODY", XS, YS, "CPS8")
    factor = YOUNG / (1 + POISSON) / (1 - 2 * POISSON)
    hoop = factor * (strain[0] + POISSON * strain[1])
    along = factor * ((1 - POISSON) * strain[1] + 2 * POISSON * strain[0])
    judge(tmp_path, ["*OPTIONS, PLANE=AXISYMMETRIC", *cards, *material("BODY", (YOUNG, POISSON)),
                     *static(*moved(cards, strain))],
          checks(np.array([hoop, along, hoop, 0.0]), cards, strain))


@pytest.mark.changes("SOLID SECTION")
def test_thickness_of_a_section_scales_forces(tmp_path):
    """The reaction of a corner of one four-node element: half of pressure x width x thickness."""
    def make(thickness):
        cards = [*mesh("BODY", [0.0, 2.0], [0.0, 1.0], "CPS4"), *material("BODY"),
                 f"{thickness!r}", *static("*BOUNDARY", "BODY.BOTTOM, 2", "1, 1", "*DLOAD",
                                           "BODY, P3, 5.")]
        return cards, [("RF2", 1, "LAST", 5.0 * 2.0 / 2 * thickness, 1e-10),
                       ("S22", "BODY", "LAST", -5.0, 1e-10)]

    follows(tmp_path, make, 1.0, 0.3)
