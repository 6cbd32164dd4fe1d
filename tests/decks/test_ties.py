"""Tied faces: blocks whose nodes do not match are as one body, whatever holds and loads them."""

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from changes import note_changes
from deck_runs import run, solve, solve_as_written
from physics import judge, material, mesh, nodes_of
from test_physics_rings import polar

import lame

KINDS = "CPE8", "CPE8R", "CPE4", "CPE4I", "CPE6", "CPE3"
YOUNG, POISSON, CONDUCTIVITY = 1e4, 0.3, 2.0
GLUE = ["*TIE, NAME=GLUE", "UPPER.BOTTOM, LOWER.TOP"]
COUPLED = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1."]
STATIC = ["*STEP", "*STATIC", "1., 1."]
NO_HEAT = ["*INITIAL CONDITIONS, TYPE=TEMPERATURE"]


def parts(count, low=0.0, high=1.0):
    """Return the corners of nearly equal parts."""
    x = np.linspace(low, high, count + 1)
    x[1:-1] += 0.07 * (high - low) / count * np.sin(np.arange(1, count))
    return [float(v) for v in x]


def turned(angle):
    """Return the turn about the origin."""
    c, s = np.cos(angle), np.sin(angle)
    return lambda x, y: (float(c * x - s * y), float(s * x + c * y))


def blocks(kind, counts, to=None, gap=0.0, width=(0.0, 1.0)):
    """Return an upper and a lower block with these numbers of elements along their common face."""
    return [*mesh("LOWER", parts(counts[0], *width), [-0.5, -0.2, 0.0], kind, 1, to=to),
            *mesh("UPPER", parts(counts[1], *width), [gap, gap + 0.3, gap + 0.6], kind, 5001,
                  to=to)]


def materials(*names, expansion=None):
    return [card for name in names for card in
            material(name, (YOUNG, POISSON), expansion, CONDUCTIVITY)] + [
                *NO_HEAT, *(f"{name}, 0." for name in names)]


def deck(path, *cards):
    return write(path, without_unused_surfaces([card for part in cards for card in part]))


def last(result, *names):
    """Return positions and nodal fields at the last increment, by node number."""
    with h5py.File(result) as file:
        data = file["VTKHDF"]
        number = data["PointData/node_id"][()]
        count = len(set(number))
        return data["Points"][()][-count:, :2], *(
            data[f"PointData/{name}"][()][-count:] for name in names)


def history(result, name):
    with h5py.File(result) as file:
        return file[f"history/{name}"][()]


def assert_balanced(result, heat=True):
    """Reactions, carried over the ties, balance the loads."""
    assert history(result, "force_imbalance").max() < 1e-9
    if heat:
        assert history(result, "heat_imbalance").max() < 1e-9


@pytest.mark.parametrize("counts", [(3, 7), (7, 3), (4, 4)], ids=["fine", "coarse", "matching"])
@pytest.mark.parametrize("kind", KINDS)
def test_uniform_strain_and_heat_cross_a_tie(tmp_path, kind, counts):
    """The outer sides of both blocks, the ends of the tied face included, move as a uniform strain
    asks; an inclined face, a gradient of temperature along and across it."""
    strain, slope = np.array([[1e-3, 1.5e-3], [0.5e-3, -2e-3]]), np.array([20.0, -30.0])
    cards, to = [], turned(0.3)
    place = turned(-0.3)
    for n, p in nodes_of(blocks(kind, counts, to)).items():
        x, y = place(*p)
        low, high = (-0.5, 0.0) if n < 5001 else (0.0, 0.6)
        outer = low if n < 5001 else high
        if min(abs(x), abs(x - 1), abs(y - outer)) > 1e-9 or not low - 1e-9 < y < high + 1e-9:
            continue
        u = strain @ p
        cards += [f"{n}, 1, 1, {u[0]:.15g}", f"{n}, 2, 2, {u[1]:.15g}",
                  f"{n}, 11, 11, {50 + slope @ p:.15g}"]
    result = solve(deck(tmp_path / "strain.inp", blocks(kind, counts, to),
                        materials("LOWER", "UPPER"), GLUE, COUPLED, ["*BOUNDARY"], cards,
                        ["*END STEP"]))
    x, u, t, stress = last(result, "displacement", "temperature", "stress")
    np.testing.assert_allclose(u[:, :2], x @ strain.T, rtol=0, atol=1e-9 * 2e-3)
    np.testing.assert_allclose(t, 50 + x @ slope, rtol=1e-9)
    np.testing.assert_allclose(stress, np.broadcast_to(stress[0], stress.shape), atol=1e-7)
    assert_balanced(result)


def traction(kind, counts, load, cards=()):
    """Return a bar of two tied blocks, one of them held and cold, the other one loaded on its end
    and heated there."""
    held = ["*BOUNDARY", "LOWER.BOTTOM, 2, 2", "LOWER.BOTTOM, 11, 11, 10."]
    if kind[2] != "X":
        held += ["1, 1, 1"]   # the corner
    return [*blocks(kind, counts), *materials("LOWER", "UPPER"), *GLUE, *cards, *COUPLED,
            *held, "*DSLOAD", f"UPPER.TOP, P, {-load!r}", "*DFLUX", "UPPER.TOP, S, 7.",
            "*END STEP"]


@pytest.mark.parametrize(("kind", "counts", "cards"), [
    *((kind, counts, ()) for kind in (*KINDS, "CAX8", "CAX4") for counts in ((3, 7), (7, 3))),
    ("CPE8", (4, 4), ()), ("CPE8", (3, 4), ("*REFINE, LEVELS=1",)),
    ("CPE8", (3, 4), ("*OPTIONS, ORDER=1",)), ("CPE8", (3, 4), ("*SOLVER, TYPE=MUMPS",))])
def test_a_bar_of_two_tied_blocks_is_one_bar(tmp_path, kind, counts, cards):
    """In tension and conduction; the tie alone holds and cools the upper block."""
    result = solve(deck(tmp_path / "bar.inp", traction(kind, counts, 12.0, cards=cards)))
    x, u, t, stress, flux = last(result, "displacement", "temperature", "stress", "heat_flux")
    axial = YOUNG if kind[2] == "X" else YOUNG / (1 - POISSON**2)   # plane strain
    np.testing.assert_allclose(u[:, 1], 12.0 / axial * (x[:, 1] + 0.5), atol=1e-9 * 12.0 / axial)
    np.testing.assert_allclose(stress[:, 1], 12.0, rtol=1e-9)
    np.testing.assert_allclose(stress[:, [0, 3]], 0.0, atol=1e-8)
    np.testing.assert_allclose(t, 10.0 + 7.0 / CONDUCTIVITY * (x[:, 1] + 0.5), rtol=1e-9)
    np.testing.assert_allclose(flux[:, :2], np.array([[0.0, -7.0]] * len(x)), atol=1e-8)
    assert_balanced(result)


@pytest.mark.parametrize("kind", ["CPE8", "CPE4"])
def test_shear_crosses_a_tie(tmp_path, kind):
    """Uniform shear by tractions on all sides; supports hold the lower block only."""
    tau, cards = 5.0, blocks(kind, (3, 7))
    edges = [f"{name}, TRVEC, {tau}, {x}, {y}, 0." for name, x, y in (
        ("UPPER.TOP", 1, 0), ("UPPER.LEFT", 0, -1), ("UPPER.RIGHT", 0, 1), ("LOWER.LEFT", 0, -1),
        ("LOWER.RIGHT", 0, 1))]
    result = solve(deck(tmp_path / "shear.inp", cards, materials("LOWER", "UPPER"), GLUE, STATIC,
                        ["*BOUNDARY", "LOWER.BOTTOM, 1, 2", "*DSLOAD", *edges, "*END STEP"]))
    x, u, stress = last(result, "displacement", "stress")
    rate = 2 * tau * (1 + POISSON) / YOUNG
    np.testing.assert_allclose(u[:, 0], rate * (x[:, 1] + 0.5), atol=1e-9 * rate)
    np.testing.assert_allclose(stress[:, 3], tau, rtol=1e-9)
    assert_balanced(result, heat=False)


def cantilever(folder, kind, count, tied=True):
    """Return the largest error of the displacements of a cantilever in two tied halves, above and
    below its neutral axis, over its deflection: exact for a force at its end in plane stress
    (S. P. Timoshenko and J. N. Goodier, Theory of Elasticity, 3rd ed., section 21)."""
    length, height, force = 4.0, 1.0, 1.0
    stiffness = YOUNG * height**3 / 12

    def exact(x, y):
        u = -force * y * ((6 * length - 3 * x) * x + (2 + POISSON) * (y**2 - height**2 / 4))
        v = force * (3 * POISSON * y**2 * (length - x) + (4 + 5 * POISSON) * height**2 * x / 4
                     + (3 * length - x) * x**2)
        return np.stack([u, v], axis=-1) / (6 * stiffness)

    cards = [*mesh("LOWER", parts(2 * count, 0.0, length), parts(count, -0.5, 0.0), kind, 1),
             *mesh("UPPER", parts(3 * count, 0.0, length), parts(count, 0.0, 0.5), kind, 5001)]
    held = []
    for n, (x, y) in nodes_of(cards).items():
        if x in (0.0, length):
            held += [f"{n}, {i + 1}, {i + 1}, {u:.15g}" for i, u in enumerate(exact(x, y))]
    result = solve(deck(folder / f"{kind}-{count}.inp", cards, materials("LOWER", "UPPER"), GLUE,
                        STATIC, ["*BOUNDARY"], held, ["*END STEP"]))
    x, u = last(result, "displacement")
    return abs(u[:, :2] - exact(*x.T)).max() / abs(exact(length, 0.0)[1])


@pytest.mark.parametrize(("kind", "falls"), [("CPS8", 7.0), ("CPS4", 3.5), ("CPS6", 7.0),
                                             ("CPS3", 3.0)])
def test_a_cantilever_of_tied_halves_converges_to_the_beam(tmp_path, kind, falls):
    """The tie carries the shear along the neutral axis, to its ends, which are held on both
    sides; errors fall with the order of the elements."""
    errors = [cantilever(tmp_path, kind, count) for count in (2, 4, 8)]
    assert errors[0] / errors[1] > falls
    assert errors[1] / errors[2] > falls


def shrink_ring(folder, kind, counts):
    """Return the relative error of the displacement of the bore of a hub on which a colder ring is
    tied, of all nodes there, and the shrink fit's pressure."""
    inner, face, outer = 1.0, 2.0, 2.5
    cards = [*mesh("HUB", list(np.linspace(0, 360, counts[0] + 1)), parts(counts[0] // 4, inner,
                                                                          face), kind, 1, to=polar,
                   closed=True),
             *mesh("RIM", list(np.linspace(0, 360, counts[1] + 1)), parts(counts[1] // 8, face,
                                                                          outer), kind, 50001,
                   to=polar, closed=True)]
    held = [f"{n}, {axis + 1}" for n, p in nodes_of(cards).items() for axis in (0, 1)
            if abs(p[axis]) < 1e-9 and n < 50001]
    pressure = lame.press_fit(inner, face, outer, (YOUNG, POISSON), (YOUNG, POISSON),
                              1e-5 * 100.0 * face, "stress")
    expected = lame.displacement(inner, *lame.cylinder(inner, inner, face, 0.0, pressure), YOUNG,
                                 POISSON, "stress")
    result = solve(deck(folder / f"{kind}-{counts[0]}.inp", cards,
                        materials("HUB", "RIM", expansion=1e-5),
                        ["*TIE, NAME=SHRUNK", "HUB.TOP, RIM.BOTTOM"], STATIC,
                        ["*BOUNDARY", *held, "*TEMPERATURE", "RIM, -100.", "*END STEP"]))
    assert_balanced(result, heat=False)
    x, u = last(result, "displacement")
    radius = np.hypot(*x.T)
    bore = abs(radius - inner) < 1e-9
    found = (x * u[:, :2]).sum(axis=1)[bore] / inner
    return abs(found / float(expected) - 1).max()


@pytest.mark.parametrize(("kind", "falls"), [("CPS8", 7.0), ("CPS4", 3.5)])
def test_a_shrink_ring_that_is_tied_converges_to_lame(tmp_path, kind, falls):
    """A closed face whose nodes do not match; nothing else holds the ring."""
    errors = [shrink_ring(tmp_path, kind, counts) for counts in ((16, 24), (32, 48))]
    assert errors[0] / errors[1] > falls


def quarters(kind, counts, skip=()):
    """Return four blocks around the origin, each with its own divisions, and the ties between
    them."""
    a, b, c, d = counts
    cards = [*mesh("SW", parts(a, -1.0, 0.0), parts(a, -1.0, 0.0), kind, 1),
             *mesh("SE", parts(b, 0.0, 1.0), parts(b, -1.0, 0.0), kind, 2001),
             *mesh("NE", parts(c, 0.0, 1.0), parts(c, 0.0, 1.0), kind, 4001),
             *mesh("NW", parts(d, -1.0, 0.0), parts(d, 0.0, 1.0), kind, 6001)]
    ties = [("SE.LEFT", "SW.RIGHT"), ("NE.BOTTOM", "SE.TOP"), ("NW.RIGHT", "NE.LEFT"),
            ("SW.TOP", "NW.BOTTOM")]
    cards += materials("SW", "SE", "NE", "NW")
    for k, pair in enumerate(ties):
        if k not in skip:
            cards += [f"*TIE, NAME=SEAM{k}", ", ".join(pair)]
    return cards


@pytest.mark.parametrize(("counts", "skip"), [
    ((3, 4, 5, 2), ()), ((3, 4, 5, 2), (3,)), ((3, 3, 3, 3), ())],
    ids=["four-different", "three-different", "four-equal"])
@pytest.mark.parametrize("kind", KINDS)
def test_ties_meet_in_a_point(tmp_path, kind, counts, skip):
    """Four blocks around a point, whose ties say the same of it several times: one plate, pulled
    and heated from one side to the other."""
    pull = ["*BOUNDARY", "SW.LEFT, 1, 1", "NW.LEFT, 1, 1", "SW.BOTTOM, 2, 2", "SE.BOTTOM, 2, 2",
            "SW.LEFT, 11, 11, 5.", "NW.LEFT, 11, 11, 5.", "*DSLOAD", "SE.RIGHT, P, -4.",
            "NE.RIGHT, P, -4.", "*DFLUX", "SE.RIGHT, S, 3.", "NE.RIGHT, S, 3.", "*END STEP"]
    result = solve(deck(tmp_path / "plate.inp", quarters(kind, counts, skip), COUPLED, pull))
    x, t, stress = last(result, "temperature", "stress")
    np.testing.assert_allclose(stress[:, 0], 4.0, rtol=1e-9)
    np.testing.assert_allclose(stress[:, [1, 3]], 0.0, atol=1e-8)
    np.testing.assert_allclose(t, 5.0 + 3.0 / CONDUCTIVITY * (x[:, 0] + 1.0), rtol=1e-9)
    assert_balanced(result)


def test_matching_faces_that_are_tied_are_as_shared_nodes(tmp_path):
    """Whatever the state: node pairs tie midside nodes, too."""
    cards = blocks("CPE8", (4, 4))
    places = nodes_of(cards)
    lower = {p: n for n, p in places.items() if n < 5001}
    shared = {n: lower[p] for n, p in places.items() if n > 5000 and p in lower}
    assert len(shared) == 9
    loads = ["*BOUNDARY", "LOWER.BOTTOM, 1, 2", "LOWER.BOTTOM, 11, 11, 10.",
             "UPPER.TOP, 11, 11, 90.", "*DSLOAD", "UPPER.RIGHT, P, 3.", "*DFLUX",
             "LOWER.LEFT, S, 20.", "*END STEP"]
    tied = solve(deck(tmp_path / "tied.inp", cards,
                      materials("LOWER", "UPPER", expansion=1e-5), GLUE, COUPLED, loads))
    merged, keyword = [], ""
    for card in cards:
        keyword = card.split(",")[0] if card.startswith("*") else keyword
        numbers = card.split(", ")
        if keyword == "*NODE" and numbers[0].isdigit() and int(numbers[0]) in shared:
            continue
        if keyword in ("*ELEMENT", "*NSET") and numbers[0].isdigit():
            first = numbers[:1] if keyword == "*ELEMENT" else []
            card = ", ".join(first + [str(shared.get(int(n), n)) for n in numbers[len(first):]])
        merged.append(card)
    whole = solve(deck(tmp_path / "whole.inp", merged,
                       materials("LOWER", "UPPER", expansion=1e-5), COUPLED, loads))
    for name in ("displacement", "temperature"):
        with h5py.File(tied) as one, h5py.File(whole) as other:
            values = [dict(zip(map(int, file["VTKHDF/PointData/node_id"][()]),
                               file[f"VTKHDF/PointData/{name}"][()], strict=False))
                      for file in (one, other)]
        expected = np.array([values[1][shared.get(n, n)] for n in values[0]])
        np.testing.assert_allclose(np.array(list(values[0].values())), expected, rtol=0,
                                   atol=1e-11 * abs(expected).max(), err_msg=name)


def on_a_table(ties, rows, friction=0.3):
    """Return a press whose ram, two blocks side by side, stands on a table and is tied along the
    vertical face between its halves; both halves touch the table with nodes that they share with
    the tied face."""
    cards = [*mesh("TABLE", [*parts(4), *parts(4, 1.0, 2.0)[1:]], [-1.0, -0.3, 0.0], "CPE8", 1),
             "*SURFACE, NAME=HERE", *(f"{e}, S3" for e in range(9, 13)),
             "*SURFACE, NAME=THERE", *(f"{e}, S3" for e in range(13, 17)),
             *mesh("ONE", parts(4), parts(rows[0]), "CPE8", 2001),
             *mesh("TWO", parts(4, 1.0, 2.0), parts(rows[1]), "CPE8", 4001)]
    return [*cards, *materials("TABLE", "ONE", "TWO"), *ties,
            "*SURFACE INTERACTION, NAME=FACES", "*FRICTION", f"{friction}, 1.E5",
            "*GAP LAW, TYPE=POWER", "0.5, 0., 1.",
            "*CONTACT PAIR, INTERACTION=FACES, NAME=A", "ONE.BOTTOM, HERE",
            "*CONTACT PAIR, INTERACTION=FACES, NAME=B", "TWO.BOTTOM, THERE"]


@pytest.mark.parametrize("rows", [(3, 5), (4, 4)], ids=["mortar", "matching"])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_tie_stands_beside_contact_that_shares_its_nodes(tmp_path, rows, friction):
    """One half of the ram is pressed; the other one, which only the tie and contact hold, is
    pressed along by the tie: the whole force arrives at the table, with its moment."""
    result = solve_as_written(deck(tmp_path / "press.inp",
                        on_a_table(["*TIE, NAME=SEAM", "TWO.LEFT, ONE.RIGHT"], rows, friction),
                        COUPLED, ["*BOUNDARY", *(() if friction else ("2001, 1",)),
                                  "TABLE.BOTTOM, 1, 2", "TABLE.BOTTOM, 11, 11, 0.", "*DSLOAD",
                                  "ONE.TOP, P, 6.", "TWO.TOP, P, 2.", "*DFLUX", "TWO.TOP, S, 9.",
                                  "*END STEP"]))
    assert_balanced(result)
    with h5py.File(result) as file:
        force = [file[f"contact/{name}/normal_force"][-1] for name in "AB"]
        heat = sum(file[f"contact/{name}/heat_rate"][-1] for name in "AB")
        moment = sum((file[f"contact/{name}/pressure"][-1] * file[f"contact/{name}/weight"][()]
                      * file[f"contact/{name}/x"][()]).sum() for name in "AB")
        assert sorted(file["contact"]) == ["A", "B"]
        assert all(np.isfinite(file[f"uncertainty/{name}/normal_force"][-1, 2]) for name in "AB")
    assert sum(force) == pytest.approx(8.0, rel=1e-9)
    assert moment == pytest.approx(6.0 * 0.5 + 2.0 * 1.5, rel=1e-6)
    assert heat == pytest.approx(9.0, rel=1e-9)
    assert force[1] > 2.0 + 1e-3   # the tie takes a part of the other half's


def pulled(folder, name, *cards, gap=0.0, counts=(4, 6), width=(0.0, 1.0), status=0):
    """Return the displacement of the top of a block that is tied to another one and pulled, and
    the listing."""
    path = deck(folder / f"{name}.inp", blocks("CPE8", counts, gap=gap, width=width),
                materials("LOWER", "UPPER"), cards, STATIC,
                ["*BOUNDARY", "LOWER.BOTTOM, 2, 2", "1, 1, 1", "*DSLOAD", "UPPER.TOP, P, -12.",
                 "*END STEP"])
    result = solve(path, status=status)
    x, u = last(result, "displacement")
    return u[x[:, 1] > gap + 0.6 - 1e-9, 1], path.with_suffix(".lst").read_text()


@pytest.mark.changes("TIE, ADJUST")
def test_an_initial_gap_is_not_closed(tmp_path):
    """Blocks 0.01 apart are tied as they are: the bar is shorter by the gap."""
    moved = 12.0 * (1 - POISSON**2) / YOUNG * 1.1
    listings, ties = [], []
    for adjust in ("YES", "NO"):
        ties.append([f"*TIE, NAME=GLUE, ADJUST={adjust}", "UPPER.BOTTOM, LOWER.TOP"])
        top, listing = pulled(tmp_path, adjust, *ties[-1], gap=0.01)
        np.testing.assert_allclose(top, moved, rtol=1e-9)
        assert "tie GLUE: 7 mortar points, up to 1E-2 apart; the gap is not closed" in " ".join(
            listing.split())
        listings.append(" ".join(listing.split()))
    assert ["nodes are not moved" in listing for listing in listings] == [True, False]
    note_changes(*ties)


@pytest.mark.changes("TIE", "TIE, NAME", "TIE, POSITION TOLERANCE")
def test_points_beyond_the_position_tolerance_are_not_tied(tmp_path):
    """Of a slave face that leaves its master, only the near part is tied: temperatures jump
    elsewhere."""
    def wedge(x, y):
        return x, y if y <= 0 else y + 0.2 * max(0.0, x - 0.5)

    jumps, listings, decks = [], [], []
    for name, tolerance, pair in (("FAR", ", POSITION TOLERANCE=0.2", "UPPER.BOTTOM, LOWER.TOP"),
                                  ("NEAR", ", POSITION TOLERANCE=1e-3", "UPPER.BOTTOM, LOWER.TOP"),
                                  ("TURN", "", "LOWER.TOP, UPPER.BOTTOM")):
        tie = [f"*TIE, NAME={name}{tolerance}", pair]
        decks.append(tie)
        path = deck(tmp_path / f"{name}.inp", mesh("LOWER", parts(4), [-0.5, -0.2, 0.0], "CPE8", 1),
                    mesh("UPPER", parts(4), [1e-4, 0.3, 0.6], "CPE8", 5001, to=wedge),
                    materials("LOWER", "UPPER"), tie,
                    ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY",
                     "LOWER.BOTTOM, 11, 11, 0.", "UPPER.TOP, 11, 11, 100.", "*END STEP"])
        x, t = last(solve(path), "temperature")
        lower = sorted(np.flatnonzero(x[:, 1] == 0.0), key=lambda i: x[i, 0])
        upper = [np.hypot(*(x - wedge(x[i, 0], 1e-4)).T).argmin() for i in lower]
        jumps.append(abs(t[upper] - t[lower]))
        listings.append(" ".join(path.with_suffix(".lst").read_text().split()))
    note_changes(decks[0], decks[1])
    note_changes(decks[0], decks[2])
    assert jumps[0].max() < 1e-9
    assert jumps[1][:4].max() < 1e-9
    assert jumps[1][4:].min() > 10.0
    assert "farther from the master than POSITION TOLERANCE=1E-3" in listings[1]
    assert "not tied" not in listings[0]
    assert jumps[2].max() < 1e-9


def test_a_narrow_block_is_tied_to_a_wide_one(tmp_path):
    """Either one may be the slave; corners without a master opposite are free, and said to be."""
    tops = []
    for name, pair in (("narrow", "UPPER.BOTTOM, LOWER.TOP"), ("wide", "LOWER.TOP, UPPER.BOTTOM")):
        path = deck(tmp_path / f"{name}.inp",
                    mesh("LOWER", parts(12, 0.0, 3.0), parts(6, -1.0, 0.0), "CPE8", 1),
                    mesh("UPPER", parts(7, 1.01, 2.02), parts(4), "CPE8", 5001),
                    materials("LOWER", "UPPER"), ["*TIE", pair, "*REFINE, LEVELS=2"], STATIC,
                    ["*BOUNDARY", "LOWER.BOTTOM, 1, 2", "*DSLOAD", "UPPER.RIGHT, P, 1.",
                     "*END STEP"])
        result = solve(path)
        assert_balanced(result, heat=False)
        x, u = last(result, "displacement")
        tops.append(u[abs(x[:, 1] - 1.0) < 1e-9, 0])
        text = " ".join(path.with_suffix(".lst").read_text().split())
        assert ("are not tied: no face of the master lies opposite" in text) == (name == "wide")
    # The corners of the block are singular; both meshes miss their share of it.
    np.testing.assert_allclose(tops[0], tops[1], rtol=0.01)


def prescribed(folder, upper, status, counts=(4, 6), kind="CPE8", dof=1, names=("UPPER.BOTTOM",)):
    """Prescribe displacements along a tied face on both of its sides; return the messages."""
    path = deck(folder / "both.inp", blocks(kind, counts), materials("LOWER", "UPPER"), GLUE,
                COUPLED, ["*BOUNDARY", "LOWER.BOTTOM, 1, 2", "LOWER.BOTTOM, 11, 11, 0.",
                          f"LOWER.TOP, {dof}, {dof}, 1e-3",
                          *(f"{name}, {dof}, {dof}, {upper!r}" for name in names), "*END STEP"])
    process = run("run", "--quiet", path, "--out", folder)
    assert process.returncode == status, process.stderr
    return process.stderr


@pytest.mark.parametrize("counts", [(4, 4), (4, 6), (6, 4)])
@pytest.mark.parametrize("kind", ["CPE8", "CPE4"])
@pytest.mark.parametrize("dof", [1, 11])
def test_supports_on_both_sides_of_a_tie_must_agree(tmp_path, kind, counts, dof):
    assert "GLUE" not in prescribed(tmp_path, 1e-3, 0, counts, kind, dof)
    message = prescribed(tmp_path, 2e-3, 1, counts, kind, dof)
    assert "tie GLUE: *BOUNDARY prescribes" in message
    assert "differ by 1E-3" in message
    assert "*TIE, NAME=GLUE" in message


def test_supports_that_disagree_at_the_end_of_the_faces_only(tmp_path):
    """There the row of a corner goes to its neighbour, but two nodes face to face still may not
    move apart."""
    message = prescribed(tmp_path, 2e-3, 1, names=("UPPER.LEFT",))
    assert "at nodes" in message


def test_a_tolerance_ties_bodies_on_the_same_side(tmp_path):
    """Two bars of different meshes side by side, tied where both end: they share the pull as their
    stiffnesses. Without a tolerance they are refused, because their faces do not face each other."""
    cards = [*mesh("LOWER", parts(2), [-1.0, -0.5, 0.0], "CPS8"),
             *mesh("UPPER", parts(3), [-1.0, -0.4, 0.0], "CPS8", 5001),
             *material("LOWER", (YOUNG, 0.0)), *material("UPPER", (3.0 * YOUNG, 0.0))]
    step = [*STATIC, "*BOUNDARY", "LOWER.BOTTOM, 2", "UPPER.BOTTOM, 2", "LOWER, 1", "UPPER, 1",
            "*DSLOAD", "UPPER.TOP, P, -8."]
    tie = ["*TIE, NAME=GLUE, POSITION TOLERANCE=0.01", "UPPER.TOP, LOWER.TOP"]
    judge(tmp_path, [*cards, *tie, *step, "*END STEP"], [
        ("U2", "UPPER.TOP", "LAST", 8.0 / (4.0 * YOUNG), 1e-9),
        ("S22", "LOWER", "LAST", 2.0, 1e-8), ("S22", "UPPER", "LAST", 6.0, 1e-8)])
    refused = run("check", write(tmp_path / "far.inp", cards, ["*TIE, NAME=GLUE", tie[1]], step,
                                 ["*END STEP"]))
    assert refused.returncode == 1
    assert "GLUE" in refused.stderr
