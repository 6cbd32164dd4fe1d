"""A body that is held all around has the capacity at constant strain, rho c_p - T0 beta:alpha, which
must be positive."""

import json
import re

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import run
from physics import judge, material, mesh

START, ABSOLUTE, POWER, TIME = 20.0, 293.0, 3.0, 0.5
ALPHA = np.array([1e-3, 2e-3, 0.5e-3])
YOUNG, POISSON, SHEAR = (1000.0, 400.0, 600.0), (0.3, 0.25, 0.2), (300.0, 250.0, 200.0)
TURNED = ["*ORIENTATION, NAME=TURNED", "1., 0., 0., 0., 1., 0.", "3, 30."]


def expansion_heat(plane, is_isotropic):
    """Return beta:alpha; in plane stress beta has no part across the plane."""
    (a, b, c), (ab, ac, bc) = YOUNG, POISSON
    alpha = np.full(3, ALPHA[0]) if is_isotropic else ALPHA
    if is_isotropic:
        b, c, ac, bc = a, a, ab, ab
    compliance = np.array([[1 / a, -ab / a, -ac / a], [-ab / a, 1 / b, -bc / b],
                           [-ac / a, -bc / b, 1 / c]])
    n = 2 if plane == "CPS" else 3
    return alpha[:n] @ np.linalg.solve(compliance[:n, :n], alpha[:n])


def held(folder, kind, is_isotropic, ratio):
    """Run a body that is held and heated within; its rho c_p is a multiple of T0 beta:alpha."""
    capacity = ratio * ABSOLUTE * expansion_heat(kind[:3], is_isotropic)
    given = {"elastic": (YOUNG[0], POISSON[0]), "expansion": ALPHA[0]}
    if not is_isotropic:
        given = {"elastic": (*YOUNG, *POISSON, *SHEAR), "elastic_type": "ENGINEERING CONSTANTS",
                 "expansion": tuple(ALPHA), "expansion_type": "ORTHO"}
    turned = not is_isotropic and not kind.startswith("CAX")
    deck = write(folder / "deck.inp", ["*OPTIONS, ERRORS=NO"], TURNED if turned else [],
                 mesh("BODY", [1.0, 2.0, 3.0], [0.0, 0.5, 1.0], kind),
                 material("BODY", conductivity=1.0, density=2.0, specific_heat=capacity / 2.0,
                          section=", ORIENTATION=TURNED" if turned else "", **given), [
        f"*PHYSICAL CONSTANTS, ABSOLUTE ZERO={START - ABSOLUTE!r}",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"BODY, {START!r}", "*BOUNDARY", "BODY, 1, 2",
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT, DILATATION=YES", f"0.1, {TIME!r}",
        "*DFLUX", f"BODY, BF, {POWER!r}", "*END STEP"])
    return capacity, deck, run("run", "--quiet", deck, "--out", folder)


KINDS = pytest.mark.parametrize("kind", ["CPE4", "CPS8", "CAX8", "CAX4"])
MATERIALS = pytest.mark.parametrize("is_isotropic", [True, False], ids=["isotropic", "orthotropic"])


@KINDS
@MATERIALS
def test_a_held_body_warms_by_its_capacity_at_constant_strain(tmp_path, kind, is_isotropic):
    capacity, deck, process = held(tmp_path, kind, is_isotropic, 1.01)
    assert process.returncode == 0, process.stderr
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        nodes = int(file["VTKHDF/NumberOfPoints"][0])
        found = file["VTKHDF/PointData/temperature"][-nodes:]
    rise = POWER * TIME / (capacity - capacity / 1.01)
    np.testing.assert_allclose(found - START, rise, rtol=1e-6)


@KINDS
@MATERIALS
def test_a_capacity_at_constant_strain_that_is_not_positive_is_refused(tmp_path, kind, is_isotropic):
    capacity, _, process = held(tmp_path, kind, is_isotropic, 0.999)
    assert process.returncode == 1
    told = re.search(r"rho c_p - T0 beta:alpha, is (\S+), not positive", process.stderr)
    assert float(told[1]) == pytest.approx(-capacity / 999, rel=1e-4)


def test_bodies_cool_by_the_strain_times_their_own_initial_temperature(tmp_path):
    """Stretched at once without heat from outside: (rho c - T0 beta:alpha) dT = -T0 beta e, with
    beta = E alpha/(1 - 2 nu) of an isotropic body."""
    strain, expansion, capacity = 1e-2, 1e-3, 4.0
    beta = YOUNG[0] * expansion / (1 - 2 * POISSON[0])
    deck, held, checks = ["*PHYSICAL CONSTANTS, ABSOLUTE ZERO=0."], ["*BOUNDARY"], []
    for name, first, start in (("COOL", 1, 100.0), ("WARM", 101, 200.0)):
        deck += [*mesh(name, [0.0, 1.0], [first, first + 1.0], "CPE4", first=first),
                 *material(name, (YOUNG[0], POISSON[0]), expansion, 1.0, 1.0, capacity),
                 "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"{name}, {start!r}"]
        held += [f"{name}, 2", f"{name}.LEFT, 1", f"{name}.RIGHT, 1, 1, {strain!r}"]
        change = -start * beta * strain / (capacity - 3 * start * expansion * beta)
        checks += [("NT", name, "LAST", start + change, 1e-9)]
    judge(tmp_path, [*deck, "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT, DILATATION=YES",
                     "1., 1.", *held, "*END STEP"], checks)


@pytest.mark.parametrize("scheme", ["L-STABLE", "IMPLICIT", "CRANK-NICOLSON"])
def test_an_even_stretch_takes_up_heat_at_an_even_rate(tmp_path, scheme):
    """T0 beta e' of the volume in every increment, however many stages it has."""
    rate, expansion, width = 1e-3, 1e-4, 2.0
    beta = YOUNG[0] * expansion / (1 - 2 * POISSON[0])
    taken = ABSOLUTE * beta * rate * width
    judge(tmp_path, [
        f"*PHYSICAL CONSTANTS, ABSOLUTE ZERO={START - ABSOLUTE!r}",
        *mesh("BODY", [0.0, 1.0, width], [0.0, 1.0], "CPE4"),
        *material("BODY", (YOUNG[0], POISSON[0]), expansion, 1.0, 1.0, 4.0),
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"BODY, {START!r}",
        "*AMPLITUDE, NAME=EVENLY, TIME=TOTAL TIME", "0., 0., 1., 1.",
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT, DILATATION=YES", "0.25, 1.",
        f"*THERMAL SCHEME, TYPE={scheme}", "*BOUNDARY, AMPLITUDE=EVENLY", "BODY, 2", "BODY.LEFT, 1",
        f"BODY.RIGHT, 1, 1, {rate * width!r}", "*END STEP"],
        [("heat_dilatation", "", when, taken, 1e-9) for when in ("0.25", "LAST")])


@pytest.mark.parametrize("strains", ["", ", DILATATION=YES"], ids=["", "heat of strains"])
@pytest.mark.parametrize("errors", ["NO", "FULL"])
def test_a_jump_that_closes_a_gap_at_once_is_followed(tmp_path, strains, errors):
    """A face that is 100 hotter at once lengthens its bar by more than the gap; the first increment
    ends just behind. The force is linear in the gap: that is uniaxial strain."""
    young, poisson, length = 2e5, 0.3, 20.0
    held = young * (1 - poisson) / (1 + poisson) / (1 - 2 * poisson) * 2.0 / length
    given = {"elastic": (young, poisson), "expansion": 2e-5, "conductivity": 20.0, "density": 1.0, "specific_heat": 3.0}
    forces = []
    for gap in (0.0175, 0.018, 0.0183):
        folder = tmp_path / str(gap)
        folder.mkdir()
        deck = write(folder / "deck.inp", [
            f"*OPTIONS, ERRORS={errors}", "*PHYSICAL CONSTANTS, ABSOLUTE ZERO=-273.15",
            *mesh("LOW", [0.0, 2.0], [0.0, 10.0], "CPE4"), *mesh("HIGH", [0.0, 2.0], [10.0, 20.0], "CPE4", first=101),
            *material("LOW", **given), *material("HIGH", **given),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LOW, 20.", "HIGH, 20.",
            "*SURFACE INTERACTION, NAME=I", "*GAP LAW, TYPE=GAS", "0.005, 0.001", "*CONTACT PAIR, INTERACTION=I, NAME=J",
            "LOW.TOP, HIGH.BOTTOM", f"*CLEARANCE, SLAVE=LOW.TOP, MASTER=HIGH.BOTTOM, VALUE={gap!r}",
            "*STEP, INC=5000", f"*COUPLED TEMPERATURE-DISPLACEMENT{strains}", "0.5, 10.", "*BOUNDARY", "LOW, 1", "HIGH, 1",
            "LOW.BOTTOM, 2", "HIGH.TOP, 2", "LOW.BOTTOM, 11, 11, 120.", "*END STEP"])
        process = run("run", "--json", deck, "--out", folder)
        assert process.returncode == 0, process.stderr
        forces.append(json.loads(process.stdout)["summary"]["interfaces"]["J"]["normal_force"]["value"])
    slope = (forces[0] - forces[1]) / 0.0005
    assert (forces[1] - forces[2]) / 0.0003 == pytest.approx(slope, rel=1e-3)
    # The heat of strains stiffens a bar, at most by T0 beta^2 over its capacity at constant strain.
    beta = young * 2e-5 / (1 - 2 * poisson)
    stiffer = 293.15 * beta**2 / (3.0 - 293.15 * 3 * 2e-5 * beta) * 2.0 / length
    assert slope == pytest.approx(held, rel=1e-3) if strains == "" else held < slope < held + stiffer
