"""Whether states last: growing small motions of rods, against dense eigenvalues of the rods in
closed form, and what *STABILITY says where there is nothing to analyse."""

import re

import h5py
import numpy as np
import pytest
from deck_runs import run
from physics import mesh, material

import rod_modes
import rods

WIDTH = 0.02
RODS = 500


def rod_deck(both, law, capacities, omega, *cards, stability="*STABILITY", elements=(8, 8)):
    """Return the cards of two rods with the laws gas(a, b) and power(touch, c, 1), solved steadily
    from a conductance."""
    a, b, touch, c = law
    cold = np.linspace(-both.length[1], 0.0, elements[1] + 1)
    hot = np.linspace(0.0, both.length[0], elements[0] + 1)
    xs = [0.0, WIDTH]
    made = [*mesh("HOT", xs, hot), *mesh("COLD", xs, cold, first=1001)]
    for i, name in enumerate(("HOT", "COLD")):
        made += material(name, (both.young[i], 0.0), expansion=both.expansion[i],
                         conductivity=both.conductivity[i], **(
                             {"density": 1.0, "specific_heat": capacities[i]} if capacities else {}))
    ends = "HOT.TOP", "COLD.BOTTOM"
    return [*made, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HOT, 0.", "COLD, 0.",
            "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=GAS", f"{a!r}, {b!r}",
            "*GAP LAW, TYPE=POWER", f"{touch!r}, {c!r}, 1.",
            "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "HOT.BOTTOM, COLD.TOP",
            f"*CLEARANCE, SLAVE=HOT.BOTTOM, MASTER=COLD.TOP, VALUE={both.gap!r}",
            "*FIXED POINT, METHOD=NEWTON, TOL=1.E-11", "*START, FROM=GIVEN", f"FACE, {omega!r}",
            *cards, "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.",
            stability, "*BOUNDARY", "HOT, 1, 1, 0.", "COLD, 1, 1, 0.",
            *(line for end, t in zip(ends, both.temperature, strict=True)
              for line in (f"{end}, 2, 2, 0.", f"{end}, 11, 11, {t!r}")), "*END STEP"]


def stability_of(result):
    """Return the rows of /stability."""
    with h5py.File(result) as file:
        return {name: values[:] for name, values in file["stability"].items()}


def random_rods(random):
    """Return two rods, their laws and capacities, and one of their solutions that does not rest."""
    while True:
        length, conductivity = random.uniform(0.05, 0.2, 2), 10 ** random.uniform(0.7, 2, 2)
        capacity = 10 ** random.uniform(6, 7, 2)
        expansion = random.uniform(0.0, 2e-5, 2)
        temperature = (500.0, 0.0) if random.integers(2) else (0.0, 500.0)
        a, b = 10 ** random.uniform(-3, -1), 10 ** random.uniform(-6, -4)
        law = a, b, a / b, 10 ** random.uniform(-6, -3)
        both = rods.Rods(*(tuple(map(float, values)) for values in (
            length, conductivity, expansion, (2e11, 2e11))), temperature, 0.0)
        # The gap of a conductance by which the gain is of the order of 1.
        gap = -both.separation(both.flux(10 ** random.uniform(0, 5))) + 10 ** random.uniform(-6, -3)
        both = rods.Rods(both.length, both.conductivity, both.expansion, both.young,
                         both.temperature, float(gap))
        found = [s for s in rods.exact_solutions(both, *map(float, law)) if s.slope]
        if found:
            return (both, tuple(map(float, law)), tuple(map(float, capacity)),
                    found[random.integers(len(found))])


def test_number_of_growing_modes_is_that_of_dense_eigenvalues(tmp_path):
    random = np.random.default_rng(17)
    expected = {}
    for i in range(RODS):
        both, law, capacities, solution = random_rods(random)
        (tmp_path / f"{i}.inp").write_text("\n".join(rod_deck(
            both, law, capacities, solution.conductance)) + "\n")
        expected[i] = rod_modes.rates(both, capacities, solution), solution
    process = run("run", "--quiet", *(f"{i}.inp" for i in expected), folder=tmp_path, seconds=600)
    assert process.returncode == 0, process.stderr
    counts = []
    for i, (rates, solution) in expected.items():
        with h5py.File(tmp_path / f"{i}.vtkhdf") as file:
            assert file["contact/FACE/conductance"][-1] == pytest.approx(solution.conductance)
        found = stability_of(tmp_path / f"{i}.vtkhdf")
        growing = np.count_nonzero(rates.real > 0.0)
        assert found["unstable_modes"] == growing, (i, rates[:3], found)
        assert found["growth_rate"] == pytest.approx(rates[0].real, rel=1e-3), (i, rates[:3])
        assert found["period"] == pytest.approx(2 * np.pi / abs(rates[0].imag) if rates[0].imag
                                                else 0.0, rel=1e-3)
        counts.append((growing, rates[0].imag != 0.0))
    # The rods show all kinds of motions.
    for kind in (0, False), (0, True), (1, False), (2, True):
        assert counts.count(kind) > 5, kind
