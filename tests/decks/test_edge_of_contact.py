"""Heat where the contact ends inside a side of a mortar face."""

import sys

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import COUPLED, CYLINDER, DECKS, OWN_MESH, solve
from physics import material, mesh

sys.path.insert(0, str(DECKS.parent / "documents"))
from document import Document  # noqa: E402

A, B = 0.24e-5, 0.3e-5             # of the gas
# Heat rate at 180, 360 ... 900 C that docs/accuracy.md tells with its band, "5.044 ± 0.006".
CONVERGED = np.array([
    float(row["heat rate, W/cm"].split()[0])
    for row in Document("accuracy.md", DECKS, (), "").rows("Converged values")])


GAS = f"{A * 1e5:.2f}E-5, {B * 1e5:.1f}E-5"


def cylinder(folder, conductivity="0.18", gas=GAS, closed="0.8, 0.24, 1."):
    """Solve the cylinder on mortar points in increments of 180 C, perhaps with other laws; return
    the values of its face."""
    text = CYLINDER.read_text().split(OWN_MESH)[0]
    head, steps = text.split("*STEP", 1)
    steps = "*STEP" + steps.split("*VERIFY")[0]
    text = head.split("*VERIFY")[0] + steps.replace("20., 900.", "180., 900.")
    assert all(part in text for part in ("PAIRING=NODES", "\n0.18\n", f"\n{GAS}\n",
                                         "\n0.8, 0.24, 1.\n"))
    deck = folder / "edge.inp"
    deck.write_text(text.replace("PAIRING=NODES", "PAIRING=SURFACES")
                    .replace("\n0.18\n", f"\n{conductivity}\n").replace(GAS, gas)
                    .replace("0.8, 0.24, 1.", closed))
    with h5py.File(solve(deck)) as file:
        face = file["contact/FACE"]
        return {name: face[name][()] for name in face if isinstance(face[name], h5py.Dataset)}


def integral(values, ends, edge):
    """Integrate from one end to another, on points that crowd at an edge between them."""
    total = 0.0
    for low, high in ((ends[0], edge), (edge, ends[1])):
        if high <= low:
            continue
        u = np.linspace(0.0, 1.0, 40001)
        x = low + (high - low) * (1 - (1 - u)**6 if high == edge else u**6)
        y = values(x)
        total += np.sum((y[1:] + y[:-1]) * np.diff(x)) / 2
    return total


def conductance_of_face(face, last):
    """Integrate the conductance over the face, from pressures, gaps and the edge of an increment."""
    s, pressure, gap = face["s"], face["pressure"][last], face["gap"][last]
    edge = face["edge_contact"][last]
    k = np.flatnonzero(face["status"][last] > 0)[-1]
    h, a = s[k + 1] - s[k], edge
    assert s[k] < a < s[k + 1]
    # The force of point k is the integral of what falls to the edge, and of its hat before it.
    beside = (s[k] - s[k - 1]) / 2
    pressure[k] *= (beside + h / 2) / (beside + 2 / 3 * (a - s[k]))
    own = np.where(np.arange(len(s)) <= k, 0.8 + 0.24 * pressure, A / (B + gap))
    rising = integral(lambda x: (x - a).clip(0)**1.5 * np.interp(x, s[k:k + 3], [0, 1, 0]),
                      (s[k], s[k + 2]), s[k + 1])
    rate = gap[k + 1] * (s[k + 2] - s[k]) / 2 / rising

    def along(x):
        inside = 0.8 + 0.24 * pressure[k] * np.sqrt((a - x).clip(0) / (a - s[k]))
        return np.where(x < a, inside, A / (B + rate * (x - a).clip(0)**1.5))

    halves = sum(own[i] * (s[j] - s[i]) * np.sign(j - i) / 2 for i in range(len(s))
                 for j in (i - 1, i + 1) if 0 <= j < len(s) and {i, j} != {k, k + 1})
    return halves + integral(along, (s[k], s[k + 1]), a)


def test_bodies_of_one_temperature_each_exchange_the_integral_of_the_conductance(tmp_path):
    # The sides are curved: their area per coordinate varies by x h/R^2, 7e-4 at the edge, at most
    # half of it to either side of the mean. A tenth of the heat crosses the side with the edge.
    face = cylinder(tmp_path, "1.E+10")
    for last in (0, 2, 4):
        expected = 180.0 * (last + 1) * conductance_of_face(face, last)
        assert abs(face["heat_rate"][last] / expected - 1) < 3.5e-5


def test_a_law_that_grows_with_pressure_conducts_what_the_force_carries(tmp_path):
    """Bodies of one temperature each, next to no heat across gaps; four to eight points closed."""
    face = cylinder(tmp_path, "1.E+10", "3.E-11, 0.3E-5", "1.E-5, 0.24, 1.")
    assert all(0 < np.count_nonzero(closed) < len(closed) for closed in face["status"])
    force = (face["pressure"] * face["weight"]).sum(axis=1)
    expected = 180.0 * np.arange(1, 6) * 0.24 * force
    np.testing.assert_allclose(face["heat_rate"], expected, rtol=1e-4)


def test_heat_has_a_third_of_the_error_of_whole_hats(tmp_path):
    # Whole hats: 1.2 % rms and 2.1 % at most.
    error = cylinder(tmp_path)["heat_rate"] / CONVERGED - 1
    assert np.sqrt(np.mean(error**2)) < 0.0037
    assert abs(error).max() < 0.007


@pytest.mark.parametrize(("gas", "a", "cuts"), [
    (GAS, A, True), ("0.48E-5, 0.3E-5", 2 * A, False), (f"{GAS}, 0.\n{GAS}, 1000.", A, False)],
    ids=["continuous", "jumps", "varies with temperature"])
def test_hats_are_cut_where_laws_neither_jump_nor_vary_with_temperature(tmp_path, gas, a, cuts):
    """Whole hats have the conductance of their own pressure or gap; in a cut one, at either side of
    the edge, it varies by an order of magnitude."""
    face = cylinder(tmp_path, gas=gas)
    for last in range(5):
        pressure, gap = face["pressure"][last], face["gap"][last]
        rests = (pressure == 0.0) & (gap == 0.0)
        own = np.where(pressure > 0.0, 0.8 + 0.24 * pressure, a / (B + gap))
        differs = np.flatnonzero((abs(face["conductance"][last] / own - 1) > 1e-6) & ~rests)
        edge = np.flatnonzero(pressure > 0.0)[-1]
        assert differs.tolist() == ([edge, edge + 1] if cuts else [])


def test_newtons_method_follows_edges_that_move(tmp_path):
    """In the coupled twin heat moves the edge. With the edge of the pass before, most increments take
    10 to 50 passes, and in some the edge jumps over a contact point without end."""
    head, steps = COUPLED.read_text().split("*STEP", 1)
    deck = tmp_path / "twin.inp"
    deck.write_text(head.split("*VERIFY")[0].replace("PAIRING=NODES", "PAIRING=SURFACES")
                    + "*STEP" + steps.split("*VERIFY")[0])
    with h5py.File(solve(deck)) as file:
        assert file["contact/FACE"].attrs["pairing"] in (b"SURFACES", "SURFACES")
        assert file["contact/FACE/status"][-1].any()
        assert file["history/iterations"][:].max() < 10
    assert "undivided" not in " ".join(deck.with_suffix(".lst").read_text().split())


def curved(name, first, side):
    """Return the cards of a hot curved face that touches a cold one on one side of it, and their
    supports."""
    xs = sorted(side * np.linspace(0.0, 1.0, 5))
    up, low = f"U{name}", f"L{name}"
    middle = "LEFT" if side > 0 else "RIGHT"
    cards = [*mesh(up, xs, [0.0, 0.4, 1.0], first=first,
                   to=lambda x, y: (x, y + 2e-3 * x * x * (1 - y))),
             *mesh(low, sorted(side * np.linspace(0.0, 1.0, 7)), [-1.0, -0.4, 0.0],
                   first=first + 1000),
             *material(up, (1e5, 0.0), 1e-5, 1.0), *material(low, (1e5, 0.0), None, 50.0),
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"{up}, 0.", f"{low}, 0.",
             f"*CONTACT PAIR, INTERACTION=FACES, NAME={name}, PAIRING=SURFACES",
             f"{up}.BOTTOM, {low}.TOP"]
    return cards, [f"{up}.{middle}, 1", f"{low}.{middle}, 1", f"{low}.BOTTOM, 2", f"{up}.TOP, 2",
                   f"{up}.TOP, 11, 11, 100.", f"{low}.BOTTOM, 11, 11, 0."]


def joined(path, *joints):
    """Solve joints in one deck; return the heat of each and the largest gain."""
    cards, held = (sum(parts, []) for parts in zip(*(curved(*joint) for joint in joints),
                                                   strict=True))
    result = solve(write(path, [
        "*OPTIONS, ERRORS=NO", "*FIXED POINT, METHOD=NEWTON, TOL=1e-12",
        "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=GAS", "1e-6, 1.",
        "*GAP LAW, TYPE=POWER", "1e-6, 0.05, 1.", *cards, "*STEP",
        "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "0.25, 1.", "*BOUNDARY", *held,
        "*END STEP"]))
    with h5py.File(result) as file:
        states = [file[f"contact/{name}/status"][-1] for name, *_ in joints]
        assert all(0 < np.count_nonzero(closed) < len(closed) for closed in states)
        return ([file[f"contact/{name}/heat_rate"][-1] for name, *_ in joints],
                file["history/coupling_gain"][-1])


def test_heat_and_gain_are_the_same_at_either_side_of_a_face(tmp_path):
    """Alone, mirrored, and both in one deck."""
    (heat,), gain = joined(tmp_path / "right.inp", ("R", 1, 1))
    (mirrored,), mirrored_gain = joined(tmp_path / "left.inp", ("L", 1, -1))
    both, both_gain = joined(tmp_path / "both.inp", ("R", 1, 1), ("L", 5001, -1))
    np.testing.assert_allclose([mirrored, *both], heat, rtol=1e-9)
    np.testing.assert_allclose([mirrored_gain, both_gain], gain, rtol=1e-6)


def ridge(path, law, slopes, pairing, grid):
    """Press a ridge, from which a face rises to one end or to both, on a flat face; return the
    contact. Each body has one temperature. The grid has the ends of elements from the ridge on."""
    xs, ys, out = (np.append(-part[:0:-1], part) if mirrored else part for part, mirrored in
                   ((grid, slopes == 2), (grid[grid <= 2], False), (grid[grid <= 1], True)))
    out = np.append(out[out < 0], xs) if slopes == 1 else xs
    first = 10001 + (len(out) - 1) * (len(ys) - 2)
    result = solve(write(path, [
        "*OPTIONS, ERRORS=NO",
        *mesh("UP", xs, ys, "CPE4", to=lambda x, y: (x, y + 5e-3 * abs(x) * (1 - y / 2))),
        *mesh("LOW", out, -ys[::-1], "CPE4", first=10001),
        *material("UP", (1e5, 0.3), None, 1e6), *material("LOW", (1e5, 0.3), None, 1e6),
        "*NODE, NSET=HAND", "9999, 0., 3.",
        "*COUPLING, REF NODE=HAND, SURFACE=UP.TOP, CONSTRAINT NAME=GRIP", "*KINEMATIC", "1, 2",
        "*SURFACE, NAME=FLAT",
        *[f"{first + i}, S3" for i in range(len(out) - len(xs), len(out) - 1)],
        "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=GAS", "3e-4, 5e-3", *law,
        f"*CONTACT PAIR, INTERACTION=FACES, NAME=RIDGE, PAIRING={pairing}", "UP.BOTTOM, FLAT",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "UP, 0.", "LOW, 0.", "*STEP",
        "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.", "*BOUNDARY",
        "HAND, 1", "HAND, 6", "LOW.BOTTOM, 1, 2", "UP.TOP, 11, 11, 100.", "LOW.BOTTOM, 11, 11, 0.",
        "*CLOAD", f"HAND, 2, {-25.0 * slopes}", "*END STEP"]))
    with h5py.File(result) as file:
        contact = file["contact/RIDGE"]
        edges = contact["edges_contact"][-1]
        return (contact["heat_rate"][-1], np.count_nonzero(contact["status"][-1]),
                edges[0] if slopes == 1 else edges[1] - edges[0])


@pytest.mark.parametrize("slopes", [1, 2], ids=["at an end of the face", "inside the face"])
@pytest.mark.parametrize("law", [["*GAP LAW, TYPE=POWER", "0.06, 0.002, 1."],
                                 ["*GAP CONDUCTANCE, PRESSURE", "0.06, 0.", "0.46, 200."]],
                         ids=["linear", "table that ends"])
def test_a_ridge_on_one_contact_point_conducts_as_on_a_mesh_that_resolves_it(tmp_path, law, slopes):
    fine, closed, width = ridge(tmp_path / "fine.inp", law, slopes, "NODES",
                                np.append(0.0, 2.0**np.arange(-10, 2.5, 0.5)))
    assert closed > 12
    heat, closed, zone = ridge(tmp_path / "coarse.inp", law, slopes, "SURFACES", np.linspace(0, 4, 9))
    assert closed == 1
    assert abs(heat / fine - 1) < 0.03
    assert 0.5 < zone / width < 1.5
