"""Estimated discretisation errors in results and listing: fields and numbers belong together."""

import h5py
import numpy as np
import pytest
from deck_runs import COUPLED, copy_deck, run
from deck_runs import solve_as_written as solve
from physics import material, mesh

COLUMNS, ROWS = 4, 3
VOLUME = 1.0 / (COLUMNS * ROWS)   # of an element of the unit square
YOUNG, CONDUCTIVITY, HOT = 700.0, 3.0, 50.0


def write(path, loads):
    """Write a deck of a square of eight-node elements with nu = 0; return its path."""
    number, cards = {}, ["*NODE, NSET=ALL"]
    for i, j in np.ndindex(2 * COLUMNS + 1, 2 * ROWS + 1):
        if not (i % 2 and j % 2):
            number[i, j] = len(number) + 1
            cards.append(f"{number[i, j]}, {i / (2 * COLUMNS):.14g}, {j / (2 * ROWS):.14g}")
    cards.append("*ELEMENT, TYPE=CPE8, ELSET=BODY")
    around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    for e, (i, j) in enumerate(np.ndindex(COLUMNS, ROWS), 1):
        nodes = [number[2 * i + a, 2 * j + b] for a, b in around]
        cards.append(", ".join(map(str, [e, *nodes])))
    cards += ["*NSET, NSET=LEFT", *(str(number[0, j]) for j in range(2 * ROWS + 1))]
    cards += ["*NSET, NSET=CORNER", str(number[2 * COLUMNS, 2 * ROWS])]
    cards += ["*MATERIAL, NAME=M", "*ELASTIC", f"{YOUNG}, 0", "*CONDUCTIVITY", f"{CONDUCTIVITY}",
              "*SOLID SECTION, ELSET=BODY, MATERIAL=M",
              "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 0"]
    path.write_text("\n".join([*cards, *loads]) + "\n")
    return path


HEAT = ["*STEP", "*HEAT TRANSFER, STEADY STATE", "0.5, 1", "*BOUNDARY", "LEFT, 11, 11, 0",
        f"CORNER, 11, 11, {HOT}", "*END STEP"]
PULL = ["*STEP", "*STATIC", "1, 1", "*BOUNDARY", "LEFT, 1, 2, 0", "*CLOAD", "CORNER, 1, 4",
        "CORNER, 2, -3", "*END STEP"]


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """Return the results of a step with heat, then one with forces, and the listing."""
    deck = write(tmp_path_factory.mktemp("estimate") / "square.inp", HEAT + PULL)
    with h5py.File(solve(deck)) as file:
        groups = ("history", "VTKHDF", "VTKHDF/PointData", "VTKHDF/CellData",
                  "VTKHDF/Steps/CellDataOffsets")
        found = {f"{group}/{name}": item[()] for group in groups
                 for name, item in file[group].items() if isinstance(item, h5py.Dataset)}
    return found, deck.with_suffix(".lst").read_text()


def rows(result, name):
    """Return the field of each increment, by the offsets that ParaView follows."""
    values = result[0][f"VTKHDF/CellData/{name}"]
    offsets = result[0][f"VTKHDF/Steps/CellDataOffsets/{name}"]
    return [values[first:first + COLUMNS * ROWS] for first in offsets]


def relative(error, energy):
    """Return the number that `/history` must hold."""
    return np.sqrt(error / (error + energy))


def test_number_of_the_flux_is_that_of_its_field(result):
    """The norm of the flux is the heat that enters at HOT times HOT; all integrals are exact."""
    field = rows(result, "heat_flux_error")[1]
    error = np.sum(field**2) * VOLUME / CONDUCTIVITY
    energy = HOT * result[0]["history/heat_in"][1]
    found = result[0]["history/heat_flux_error"]
    assert found[1, 0] == pytest.approx(relative(error, energy), rel=1e-9)
    # Linear: the same relative error at half the load.
    assert found[0, 0] == pytest.approx(found[1, 0], rel=1e-9)
    assert field.argmax() == COLUMNS * ROWS - 1, "largest where heat enters at a point"


def test_number_of_the_stress_is_that_of_its_field(result):
    """With nu = 0 the energy is |s|^2/E, and its integral the work of the forces."""
    data = result[0]
    field = rows(result, "stress_error")[2]
    node = data["VTKHDF/PointData/node_id"].argmax()
    corner = data["VTKHDF/PointData/displacement"][-len(data["VTKHDF/Points"]):][node]
    error = np.sum(field**2) * VOLUME / YOUNG
    expected = relative(error, 4 * corner[0] - 3 * corner[1])
    assert data["history/stress_error"][2, 0] == pytest.approx(expected, rel=1e-9)
    assert field.argmax() == COLUMNS * ROWS - 1


def test_what_a_step_does_not_solve_has_no_error(result):
    """Rows without physics are NaN; a kept stress keeps its error."""
    data, _ = result
    assert data["history/stress_error"].shape == (3, 1)
    assert np.isnan(data["history/stress_error"][:2]).all()
    assert np.isnan(data["history/heat_flux_error"][2]).all()
    assert np.isnan(rows(result, "stress_error")[:2]).all()
    assert np.isnan(rows(result, "heat_flux_error")[2]).all()


def test_a_heat_step_keeps_the_error_of_the_stress_that_it_keeps(tmp_path):
    """Mechanics first: the body, which does not expand, keeps its stress."""
    deck = write(tmp_path / "kept.inp", PULL + HEAT)
    with h5py.File(solve(deck)) as file:
        history, field = (file[f"{group}/stress_error"][()] for group in ("history",
                                                                        "VTKHDF/CellData"))
    assert 0.0 < history[0, 0] < 1.0
    np.testing.assert_array_equal(history[1:], history[:1].repeat(2, axis=0))
    np.testing.assert_array_equal(field.reshape(3, -1)[1:], field.reshape(3, -1)[[0, 0]])


def test_listing_tells_the_errors_at_the_end_of_each_step(result):
    """One line a body and step."""
    data, listing = result
    lines = [line for line in listing.splitlines() if "estimated error of the mesh" in line]
    assert len(lines) == 2
    assert float(lines[0].split("heat flux")[1].split()[0]) == pytest.approx(
        data["history/heat_flux_error"][1, 0], rel=5e-3)
    assert float(lines[1].split("stress")[1].split()[0]) == pytest.approx(
        data["history/stress_error"][2, 0], rel=5e-3)


def test_no_dataset_without_the_physics(tmp_path):
    """A deck without heat has no error of heat flux; huge and tiny loads change no digit."""
    found = []
    for force in ("4", "4e80", "4e-80"):
        pull = [card.replace("1, 4", f"1, {force}").replace("2, -3", "2, 0") for card in PULL]
        deck = write(tmp_path / "pull.inp", pull)
        with h5py.File(solve(deck)) as file:
            assert "heat_flux_error" not in file["history"]
            assert "heat_flux_error" not in file["VTKHDF/CellData"]
            found.append(file["history/stress_error"][-1, 0])
    assert found == pytest.approx([found[0]] * 3, rel=1e-9)


def test_body_of_one_element_estimates_nothing(tmp_path):
    """A body without a patch has no smoother stress than its own; nothing fails."""
    deck = tmp_path / "one.inp"
    deck.write_text("""*NODE, NSET=ALL
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
*ELEMENT, TYPE=CPS4, ELSET=BODY
1, 1, 2, 3, 4
*MATERIAL, NAME=M
*ELASTIC
100, 0.3
*SOLID SECTION, ELSET=BODY, MATERIAL=M
*STEP
*STATIC
1, 1
*BOUNDARY
1, 1, 2, 0
4, 1, 2, 0
*CLOAD
2, 2, 1
*END STEP
""")
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 0, process.stderr


def test_a_body_that_only_rounding_stresses_has_no_error(tmp_path):
    """The base of the coupled twin, which does not expand, before anything touches it."""
    with h5py.File(solve(copy_deck(COUPLED, tmp_path / "twin.inp"))) as file:
        is_open = file["contact/FACE/normal_force"][:] <= 0.0
        upper, base = file["history/stress_error"][:].T
    assert is_open[0] and not is_open[-1]
    assert not base[is_open].any() and np.all(base[~is_open] > 0.0) and np.all(upper > 0.0)


@pytest.mark.parametrize("shift", [0.0, 300.0])
@pytest.mark.parametrize("kind", ["CPS8", "CPS4", "CPS6", "CPS3", "CAX8"])
def test_a_body_that_expands_freely_has_no_error_of_stress_nor_of_heat_flux(tmp_path, kind, shift):
    """It is as hot everywhere: all strain is thermal, and no heat flows."""
    cards = [*mesh("A", np.linspace(1.0, 2.0, 4), [0.0, 0.4, 0.7], kind, skew=0.05),
             *material("A", (2e5, 0.3), expansion=1.2e-5, conductivity=0.05),
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"A, {shift}"]
    held = ["A.BOTTOM, 2"] + (["A.LEFT, 1"] if kind != "CAX8" else [])
    deck = tmp_path / "free.inp"
    deck.write_text("\n".join([
        *cards, "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.", "*BOUNDARY",
        *held, f"A, 11, 11, {shift + 100.0}", "*END STEP"]) + "\n")
    with h5py.File(solve(deck)) as file:
        assert np.abs(file["VTKHDF/PointData/displacement"][:]).max() > 1e-4
        for name in ("stress_error", "heat_flux_error"):
            assert not file[f"history/{name}"][:].any(), name


def half_ring(folder, kind, span, turned):
    """Return the relative error of stress in half a ring that is one element, with its ends held and
    turned about a point far from it."""
    points = [(1.0, 0), (2.0, 0), (2.0, span), (1.0, span), (1.5, 0), (2.0, span / 2), (1.5, span),
              (1.0, span / 2)]
    nodes = (f"{n}, {9 + r * np.cos(turned + t):.15g}, {r * np.sin(turned + t):.15g}"
             for n, (r, t) in enumerate(points, 1))
    deck = folder / "ring.inp"
    deck.write_text("\n".join(["*NODE, NSET=ALL", *nodes, f"*ELEMENT, TYPE={kind}, ELSET=RING",
                               "1, 1, 2, 3, 4, 5, 6, 7, 8", *material("RING"), "*STEP", "*STATIC",
                               "*BOUNDARY", *(f"{n}, 1, 2" for n in (1, 2, 3, 4, 5, 7)), "*DLOAD",
                               "RING, P4, 100.", "*END STEP\n"]))
    with h5py.File(solve(deck)) as file:
        return file["history/stress_error"][0, 0]


@pytest.mark.parametrize("kind", ["CPE8", "CPE8R", "CAX8"])
def test_half_a_ring_of_one_element_is_like_a_little_less_of_it(tmp_path, kind):
    """Its four corners lie on a line, wherever it is turned."""
    for turned in (0.0, np.pi / 2) if kind == "CAX8" else (0.0, 0.5, np.pi / 2):
        less = half_ring(tmp_path, kind, 0.9999 * np.pi, turned)
        assert half_ring(tmp_path, kind, np.pi, turned) == pytest.approx(less, rel=1e-4)
