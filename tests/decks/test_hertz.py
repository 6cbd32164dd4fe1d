"""Two bodies in contact without heat or friction, against the theory of Hertz."""

from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import HERTZ, copy_deck, data_cards, solve
from physics import material, mesh


def theory():
    """Return half-width, peak pressure and force on the half model, from the numbers of the deck.

    K. L. Johnson, Contact Mechanics, 1985, section 4.2c, in plane strain. The half model carries
    half of the load P of the whole cylinder.
    """
    compliance = 0.0
    for young, poisson in data_cards(HERTZ, "*ELASTIC"):
        compliance += (1.0 - float(poisson) ** 2) / float(young)
    points = {int(n): (float(x), float(y)) for n, x, y in data_cards(HERTZ, "*NODE")}
    width = max(x for x, _ in points.values())
    ((_, _, pressure),) = data_cards(HERTZ, "*DLOAD")
    force = float(pressure) * width
    radius = points[2][0] ** 2 / (2.0 * points[2][1])
    half_width = np.sqrt(4.0 * 2.0 * force * radius * compliance / np.pi)
    peak = 2.0 * 2.0 * force / (np.pi * half_width)
    return SimpleNamespace(
        half_width=half_width, peak=peak, force=force, size=width, radius=radius
    )


@pytest.fixture(
    scope="module",
    params=[("SKYLINE", 1), ("SKYLINE", 2), ("MUMPS", 1), ("MUMPS", 2)],
    ids=lambda p: f"{p[0]}-{p[1]}",
)
def contact(request, tmp_path_factory):
    """Return the contact at the last increment of the deck, at its own level and one finer."""
    solver, levels = request.param
    deck = tmp_path_factory.mktemp("hertz") / "hertz.inp"
    copy_deck(
        HERTZ,
        deck,
        cards=[f"*SOLVER, TYPE={solver}"],
        changes={"*REFINE, LEVELS=1": f"*REFINE, LEVELS={levels}"},
    )
    with h5py.File(solve(deck)) as file:
        face = file["contact/FACE"]
        last = {name: face[name][-1] for name in ("pressure", "edge_contact", "normal_force")}
        return SimpleNamespace(
            x=face["x"][()],
            y=face["y"][()],
            weight=face["weight"][()],
            edges=face["edge_contact"][()],
            load=file["history/time"][()],
            force_imbalance=file["history/force_imbalance"][()],
            gap=face["gap"][-1],
            shear=face["shear"][()],
            **last,
        )


def test_bodies_are_large_against_the_contact():
    assert theory().size > 35.0 * theory().half_width


def test_contact_nodes_lie_on_the_curve(contact):
    """New nodes of a refined side too: the curve is the parabola that the side itself is."""
    on_curve = contact.x**2 / (2.0 * theory().radius)
    np.testing.assert_allclose(contact.y, on_curve, rtol=0.0, atol=1e-9)


def test_half_width_and_peak_pressure_are_within_1_percent(contact):
    assert contact.edge_contact == pytest.approx(theory().half_width, rel=0.01)
    assert contact.pressure[0] == pytest.approx(theory().peak, rel=0.01)
    assert contact.pressure.max() == pytest.approx(theory().peak, rel=0.01)


def test_half_width_grows_with_the_root_of_the_load(contact):
    np.testing.assert_allclose(contact.edges, theory().half_width * contact.load**0.5, rtol=0.02)


def errors_of_pressure(contact):
    """Return the difference of the pressure from the ellipse, over the peak."""
    inside = np.clip(1.0 - (contact.x / theory().half_width) ** 2, 0.0, None)
    return contact.pressure / theory().peak - np.sqrt(inside)


def test_pressure_is_the_ellipse(contact):
    error = errors_of_pressure(contact)
    near = contact.x < 1.2 * theory().half_width
    assert np.sqrt(np.mean(error[near] ** 2)) < 0.01
    assert np.all(contact.pressure[contact.x > 1.1 * theory().half_width] == 0.0)


def test_pressure_does_not_alternate_between_corner_and_midside_nodes(contact):
    """The forces of a uniform pressure on a three-node side are as 1 : 4 : 1. Divided by equal
    shares of its length they would alternate by a third; what is left must be no more than the
    error that is allowed for the peak."""
    error = errors_of_pressure(contact)
    alternating = (error[:-2] - 2.0 * error[1:-1] + error[2:]) / 4.0
    inner = contact.x[1:-1] < 0.8 * theory().half_width
    assert np.count_nonzero(inner) > 10
    assert np.abs(alternating[inner]).max() < 0.01


def test_forces_balance(contact):
    assert contact.force_imbalance.max() <= 1e-10
    # The normals lean by a/(2 R) at most, half a hundredth, which the cosine takes to 1.3e-5.
    assert contact.normal_force == pytest.approx(theory().force, rel=2e-5)
    assert contact.normal_force == pytest.approx(contact.weight @ contact.pressure, rel=1e-12)


def test_there_is_no_shear_and_no_overlap(contact):
    assert np.all(contact.shear == 0.0)
    assert np.all(contact.gap >= 0.0)
    assert np.all(contact.gap * contact.pressure == 0.0)


def dome(folder, zone, spacing=0.125, radius=20.0):
    """Return the pressures and the force on a dome of CAX8 pressed on a block, and Hertz's peak: the
    zone of contact has this radius, nodes lie this far from each other."""
    young, poisson = 1000.0, 0.3
    xs = [2 * spacing * k for k in range(5)]

    def bulge(x, y):
        return x, y + (1.0 - y) * x**2 / (2.0 * radius)

    force = float(4.0 / 3.0 * young / (2.0 * (1.0 - poisson**2)) * zone**3 / radius)
    deck = write(folder / "dome.inp", ["*OPTIONS, WIDTH=300"],
                 mesh("LOW", xs, [-1.0, -0.5, -0.2, 0.0], "CAX8"),
                 mesh("DOME", xs, [0.0, 0.2, 0.5, 1.0], "CAX8", 1001, to=bulge),
                 material("LOW", (young, poisson)), material("DOME", (young, poisson)),
                 ["*SURFACE INTERACTION, NAME=CUT", "*CONTACT PAIR, INTERACTION=CUT, NAME=CUT",
                  "DOME.BOTTOM, LOW.TOP", "*STEP", "*STATIC", "1., 1.", "*BOUNDARY",
                  "LOW.BOTTOM, 2", "LOW.LEFT, 1", "DOME.LEFT, 1", "*DSLOAD",
                  f"DOME.TOP, P, {float(force / np.pi / xs[-1]**2)!r}", "*END STEP"])
    with h5py.File(solve(deck)) as file:
        pairs = file["contact/CUT"]
        found = pairs["pressure"][-1], float(pairs["normal_force"][-1])
    return *found, 1.5 * force / (np.pi * zone**2)


def test_a_dome_that_touches_at_its_axis_alone_has_the_pressure_of_its_force(tmp_path):
    """The mesh then tells the force F alone: a parabola to the next node at r2 carries it.
    The dome's area exceeds that of its shadow by (r2/R)^2/2."""
    pressure, force, _ = dome(tmp_path, 0.6 * 0.125)
    assert np.count_nonzero(pressure) == 1
    assert pressure[0] == pytest.approx(2.0 * force / (np.pi * 0.125**2), rel=2e-5)


@pytest.mark.parametrize(("nodes", "error"), [(3.0, 0.05), (4.0, 0.025)])
def test_the_force_on_the_axis_tells_the_peak_of_a_dome(tmp_path, nodes, error):
    """Beside the parabola through the next two nodes, which is 9 and 5 % too low: pressures of
    half-ellipsoids bend down more than parabolas."""
    pressure, _, peak = dome(tmp_path, nodes * 0.125)
    assert pressure[0] == pytest.approx(peak, rel=error)
