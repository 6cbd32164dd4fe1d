"""One body whose faces meet: a caliper that is one-dimensional, and a crack with its tips.

A mesh of confocal lines about the crack has midside nodes at quarter points at the tips. What the
crack does far from its tips then converges as h^2: displacements near a tip are smooth along the
radius of the mesh's own coordinates, but not over them. So results at h and h/2 give the limit to a
small part of the error at h/2.
"""

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from deck_runs import solve
from physics import follows, material, mesh, nodes_of

import crack
import rods

HALF, YOUNG, POISSON, CONDUCTIVITY, EXPANSION = 1.3, 1000.0, 0.3, 4.0, 1e-3
FAMILY = {"strain": "CPE8", "stress": "CPS8"}
EDGE = 1.2   # of the plate, as mu: an ellipse of half-axes 1.81 a and 1.51 a
GRADIENT, TENSION = 7.0, 5.0
COARSEST = 16   # elements around the crack, of which all others are multiples


def weld(bodies, apart, surfaces):
    """Return cards in which bodies share the nodes that lie at one place, but for those that
    `apart` names by their place; only these surfaces are kept, for faces inside a body make none.
    """
    owner, twin = {}, {}
    for cards in bodies:
        for n, (x, y) in nodes_of(cards).items():
            twin[n] = n if apart(x, y) else owner.setdefault((round(x, 9), round(y, 9)), n)
    welded, inside = [], ""
    for card in (card for cards in bodies for card in cards):
        if card.startswith("*"):
            inside = card.split(",")[0]
            if inside == "*SURFACE" and card.split("NAME=")[1] not in surfaces:
                inside = ""
        elif inside == "*NODE":
            number = int(card.split(",")[0])
            if twin[number] != number:
                continue
        elif inside == "*ELEMENT":
            element, *around = map(int, card.split(","))
            card = ", ".join(map(str, [element, *(twin[n] for n in around)]))
        elif inside == "*NSET":
            card = str(twin[int(card)])
        if inside:
            welded.append(card)
    return welded


HOT, COLD = 120.0, 20.0
JAWS = rods.Rods(length=(1.0, 0.7), conductivity=(3.0, 2.0), expansion=(1e-4, 3e-5),
                 young=(YOUNG, 600.0), temperature=(HOT, COLD), gap=0.0)


def caliper(gap):
    """Return one body, two jaws on a frame, and the state of the jaws.

    Displacement and temperature of both jaws are given where they leave the frame; they expand
    along their length only and have nu = 0, so each is a rod, whatever the frame does.
    """
    xs, (upper, lower) = [0.0, 0.4, 1.0], JAWS.length
    parts = {"UP": (xs, [0.0, 0.3, upper]), "DOWN": (xs, [-lower, -0.3, 0.0]),
             "HEAD": ([*xs, 2.0, 3.0], [upper, upper + 0.5]),
             "FOOT": ([*xs, 2.0, 3.0], [-lower - 0.5, -lower]),
             "BACK": ([2.0, 3.0], [-lower, -0.3, 0.0, 0.3, upper])}
    bodies = [mesh(name, *lines, first=1 + 100 * k)
              for k, (name, lines) in enumerate(parts.items())]
    deck = weld(bodies, lambda x, y: y == 0.0 and x <= 1.0, ["UP.BOTTOM", "DOWN.TOP"])
    for k, name in enumerate(("UP", "DOWN")):
        deck += material(name, (JAWS.young[k], 0.0), (0.0, JAWS.expansion[k], 0.0),
                         JAWS.conductivity[k], expansion_type="ORTHO")
    for name in ("HEAD", "FOOT", "BACK"):
        deck += material(name, (YOUNG, POISSON), EXPANSION, CONDUCTIVITY)
    deck += ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", *(f"{name}, 0." for name in parts),
             "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=POWER", "0.5, 0.2, 1.",
             "*GAP LAW, TYPE=GAS", "0.005, 0.01", "*FRICTION", "0.2",
             "*CONTACT PAIR, INTERACTION=FACES, NAME=CUT", "UP.BOTTOM, DOWN.TOP",
             "*FIXED POINT, TOL=1.E-13",
             "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
             "UP.TOP, 1", f"UP.TOP, 2, 2, {gap!r}", "DOWN.BOTTOM, 1, 2", f"UP.TOP, 11, 11, {HOT}",
             f"DOWN.BOTTOM, 11, 11, {COLD}", "*END STEP"]
    state = rods.solve(rods.Rods(**{**vars(JAWS), "gap": gap}), rods.gas(0.005, 0.01),
                       rods.power(0.5, 0.2, 1.0))
    values = {"gap": state.gap, "pressure": state.pressure, "conductance": state.conductance,
              "heat_flux": state.flux, "slave_temperature": state.face_temperature[0],
              "master_temperature": state.face_temperature[1], "normal_force": state.pressure,
              "heat_rate": state.flux, "shear": 0.0, "status": 2.0 if state.pressure else 0.0}
    return deck, [(name, "CUT", "LAST", value, *((1e-9,) if value else (1e-9, "ABS")))
                  for name, value in values.items()]


@pytest.mark.parametrize(("one", "other"), [(-0.002, -0.003), (0.02, 0.03), (0.009, 0.02)])
def test_faces_of_one_body_meet_as_those_of_two_rods(tmp_path, one, other):
    """Pressed together, apart with gas between, and closed by heat alone against open."""
    follows(tmp_path, caliper, one, other)
    with h5py.File(tmp_path / "one.vtkhdf") as file:
        assert set(file["VTKHDF/CellData/body"][:]) == {1}


def plate(count, plane, corner, above=None):
    """Return an ellipse cut along its crack, `count` elements around it, and its outer nodes.

    Two lines between elements meet the crack where theta is `corner`. Above the crack there may be
    another number of elements, evenly spread.
    """
    def to(angle, mu):
        x, y = crack.place(mu, -angle, HALF)
        return float(x), float(y)

    part = round(COARSEST * corner / (2 * np.pi)) * count // COARSEST
    half = np.concatenate([np.linspace(0.0, corner, part + 1),
                           np.linspace(corner, np.pi, count // 2 - part + 1)[1:]])
    upper = half if above is None else np.linspace(0.0, np.pi, above + 1)
    cards = mesh("PLATE", [*(-upper[:0:-1]), *half], list(np.linspace(0.0, EDGE, count // 4 + 1)),
                 FAMILY[plane], to=to, closed=True)
    start = cards.index("*NSET, NSET=PLATE.TOP")
    outer = [int(card) for card in cards[start + 1:cards.index("*SURFACE, NAME=PLATE.TOP")]]
    first, last = len(upper) - 1, len(upper) + len(half) - 2
    faces = ["*SURFACE, NAME=UP", *(f"{e}, S1" for e in range(1, first + 1)),
             "*SURFACE, NAME=LOW", *(f"{e}, S1" for e in range(first + 1, last + 1))]
    return [*cards, *faces], outer


def prescribed(outer, *components):
    """Return *BOUNDARY with values of degrees of freedom 1, 2 and perhaps 11 at the outer nodes."""
    cards = ["*BOUNDARY"]
    for dof, values in zip((1, 2, 11), components, strict=False):
        cards += [f"{n}, {dof}, {dof}, {value:.17g}"
                  for n, value in zip(outer, values, strict=True)]
    return cards


def gassy(count, plane, gas, above=None):
    """Return a crack that a tension opens, filled with gas, in a heat flow across it, and what is
    known of it: values at x = 0, sliding at x = a/sqrt(2), heat."""
    widest = crack.widest(HALF, TENSION, YOUNG, POISSON, plane)
    beta = crack.gas_number(HALF, CONDUCTIVITY, gas, widest)
    cards, outer = plate(count, plane, 0.5 * np.pi, above)
    nodes = nodes_of(cards)
    zeta = np.arccosh(np.array([complex(*nodes[n]) for n in outer]) / HALF)
    zeta = np.where(zeta.real < 0, -zeta, zeta)
    at = zeta.real, zeta.imag, HALF
    moved = np.add(crack.flow_displacement(*at, GRADIENT, beta, YOUNG, POISSON, EXPANSION, plane),
                   crack.tension_displacement(*at, TENSION, YOUNG, POISSON, plane))
    deck = [*cards, *material("PLATE", (YOUNG, POISSON), EXPANSION, CONDUCTIVITY),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "PLATE, 0.",
            "*SURFACE INTERACTION, NAME=GAS", "*GAP LAW, TYPE=GAS", f"{gas!r}, 1.E-12",
            "*CONTACT PAIR, INTERACTION=GAS, NAME=CRACK", "UP, LOW",
            "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.",
            *prescribed(outer, *moved, crack.flow_temperature(*at, GRADIENT, beta)), "*END STEP"]
    jump = crack.jump(0.0, HALF, CONDUCTIVITY * GRADIENT, CONDUCTIVITY) / (1 + beta)
    flux = CONDUCTIVITY * GRADIENT * beta / (1 + beta)
    known = {"gap": widest, "jump": jump, "heat_flux": flux, "heat_rate": 2 * HALF * flux,
             "sliding": float(crack.sliding(HALF / np.sqrt(2), HALF, GRADIENT, beta, POISSON,
                                            EXPANSION, plane))}
    return deck, known


def bent(count, plane, slope, above=None):
    """Return a crack that a stress slope*x opens on one side and closes on the other, what is known
    of it, and the places of its pressure and gap, corners of every mesh."""
    edge = np.arccos(-1 / 3)
    cards, outer = plate(count, plane, edge, above)
    nodes = nodes_of(cards)
    places = np.array([nodes[n] for n in outer]).T
    moved = crack.bent_displacement(*places, HALF, slope, YOUNG, POISSON, plane)
    deck = [*cards, *material("PLATE", (YOUNG, POISSON)), "*SURFACE INTERACTION, NAME=SMOOTH",
            "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=CRACK", "UP, LOW",
            "*STEP", "*STATIC", "1., 1.", *prescribed(outer, *moved), "*END STEP"]
    inside, outside = HALF * np.cos(edge + (np.pi - edge) / 3), HALF * np.cos(0.4 * edge)
    return deck, {
        "force": crack.bent_force(HALF, slope),
        "pressure": crack.bent_pressure(inside, HALF, slope),
        "gap": crack.bent_opening(outside, HALF, slope, YOUNG, POISSON, plane)}, (inside, outside)


def pressed(side, plane, stress, tip, side_below=None, pairing="NODES"):
    """Return two blocks of square elements that touch on y = 0 but for a lens -a < x < a, which is
    twice as high as the stress far away closes it; the lens is a crack that a compression narrows.

    Elements about its tips have their midside nodes at `tip` of their sides, from there. Those below
    may have sides of another length.
    """
    flat = crack.widest(HALF, stress, YOUNG, POISSON, plane)

    def block(sign):
        count = round(HALF / (side if sign > 0 else side_below or side))
        size = HALF / count

        def to(x, y):
            for end in (-HALF, HALF):
                if abs(abs(x - end) + abs(y) - size / 2) < 1e-9:
                    x, y = end + 2 * tip * (x - end), 2 * tip * y
            if y == 0.0 and abs(x) < HALF:
                y = sign * flat * np.sqrt(1 - (x / HALF) ** 2)
            return float(x), float(y)

        xs = [k * HALF / count for k in range(-2 * count, 2 * count + 1)]
        ys = sorted(sign * k * HALF / count for k in range(2 * count + 1))
        return mesh("UP" if sign > 0 else "LOW", xs, ys, FAMILY[plane], 1 if sign > 0 else 100001,
                    to=to)

    deck = ["*SURFACE INTERACTION, NAME=SMOOTH",
            f"*CONTACT PAIR, INTERACTION=SMOOTH, NAME=CRACK, PAIRING={pairing}",
            "UP.BOTTOM, LOW.TOP", "*STEP", "*STATIC", "1., 1."]
    cards = []
    for name, sign in (("UP", 1.0), ("LOW", -1.0)):
        cards += [*block(sign), *material(name, (YOUNG, POISSON))]
        outer = {n: p for n, p in nodes_of(block(sign)).items()
                 if max(abs(p[0]), abs(p[1])) > 2 * HALF - 1e-9}
        x, y = np.array(list(outer.values())).T
        zeta = np.arccosh((np.abs(x) + 1j * np.abs(y)) / HALF)
        u, v = crack.tension_displacement(zeta.real, zeta.imag, HALF, -stress, YOUNG, POISSON,
                                          plane)
        # The ends of the face are held along x only.
        on_face = {f"{n}, 2, 2, " for n, p in outer.items() if abs(p[1]) < 1e-9}
        deck += [card for card in prescribed(outer, u * np.sign(x), v * np.sign(y))
                 if not card.startswith(tuple(on_face))]
    return [*cards, *deck, "*END STEP"]


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_quarter_points_at_the_tips_of_a_crack_in_a_contact_face(tmp_path, plane):
    """The gap narrows as an ellipse, and beside it the faces press as s x/sqrt(x^2 - a^2), without
    bound at the tips: elements about them follow it with quarter points only."""
    stress, errors = 5e-4, {}
    for tip in (0.25, 0.5):
        path = solve(write(tmp_path / "crack.inp", ["*OPTIONS, WIDTH=300"],
                           pressed(HALF / 6, plane, stress, tip)))
        with h5py.File(path) as file:
            pairs = {name: values[-1] if name not in ("x", "weight") else values[:]
                     for name, values in file["contact/CRACK"].items()}
        x = pairs["x"]
        inside, beside = np.abs(x) < HALF - 1e-9, np.abs(x) > HALF + 1e-9
        assert not pairs["status"][inside].any()
        assert pairs["status"][~inside].all()
        assert pairs["weight"].sum() == pytest.approx(4 * HALF, rel=1e-9)
        gap = crack.widest(HALF, stress, YOUNG, POISSON, plane) * np.sqrt(
            1 - (x[inside] / HALF) ** 2)
        pressure = stress * np.abs(x[beside]) / np.sqrt(x[beside] ** 2 - HALF**2)
        errors[tip] = {
            "gap": pairs["gap"][inside] / gap - 1, "pressure": pairs["pressure"][beside] / pressure
            - 1, "force": pairs["normal_force"] / (2 * stress * HALF * np.sqrt(3)) - 1}
        if tip == 0.25:
            assert set(pairs["weight"][~inside & ~beside]) == {0.0}
    worst = {tip: {name: np.abs(values).max() for name, values in found.items()}
             for tip, found in errors.items()}
    assert worst[0.25]["gap"] < 0.04 < 0.12 < worst[0.5]["gap"]
    assert worst[0.25]["pressure"] < 0.06 < 0.14 < worst[0.5]["pressure"]
    assert worst[0.25]["force"] < 0.003 < 0.01 < worst[0.5]["force"]
    assert abs(errors[0.25]["gap"][len(gap) // 2]) < 0.001


def test_quarter_points_at_the_tips_of_a_crack_in_faces_that_do_not_match(tmp_path):
    """Hats are linear along a side and closed at the tips, so that the crack is too short by a part
    of a side: the gap in its middle and the force beside it err with h, and pressures beside a tip
    alternate about the singular ones and settle away from it."""
    stress, plane, errors = 5e-4, "strain", []
    for sides in (6, 12):
        path = solve(write(tmp_path / "crack.inp", without_unused_surfaces(pressed(
            HALF / sides, plane, stress, 0.25, HALF / (4 * sides // 3), "SURFACES"))))
        with h5py.File(path) as file:
            assert file["history/force_imbalance"][-1] < 1e-12
            points = {name: values[-1] if values.ndim > 1 or "force" in name else values[:]
                      for name, values in file["contact/CRACK"].items()}
        x, weight = points["x"], points["weight"]
        assert len(x) == 4 * sides + 1
        assert weight.min() > 0.1 * HALF / sides
        assert weight.sum() == pytest.approx(4 * HALF, rel=1e-9)
        assert not points["status"][np.abs(x) < HALF - 1e-9].any()
        assert points["status"][np.abs(x) > HALF + 1e-9].all()
        middle = points["gap"][2 * sides] / crack.widest(HALF, stress, YOUNG, POISSON, plane) - 1
        force = points["normal_force"] / (2 * stress * HALF * np.sqrt(3)) - 1
        errors.append((-middle, -force))
    away = np.abs(x) > 1.55 * HALF
    singular = stress * np.abs(x[away]) / np.sqrt(x[away] ** 2 - HALF**2)
    np.testing.assert_allclose(points["pressure"][away], singular, rtol=0.02)
    assert max(errors[0]) < 1 / 6 / 4
    for coarse, fine in zip(*errors, strict=True):
        assert coarse / fine == pytest.approx(2.0, abs=0.2)


def at_pair(pairs, name, x):
    """Return the value of the pair at x."""
    places = pairs["x"][:]
    k = int(np.argmin(np.abs(places - x)))
    assert abs(places[k] - x) < 1e-9 * HALF
    values = pairs[name]
    return values[k] if values.ndim == 1 else values[-1, k]


def found_gassy(path):
    """Return what a run of gassy() found."""
    with h5py.File(path) as file:
        pairs, points = file["contact/CRACK"], file["VTKHDF/PointData"]
        u = dict(zip(points["node_id"][:], points["displacement"][:, 0], strict=False))
        up, low = (at_pair(pairs, name, HALF / np.sqrt(2)) for name in ("slave_node", "master_node"))
        return {"gap": at_pair(pairs, "gap", 0.0), "heat_flux": at_pair(pairs, "heat_flux", 0.0),
                "jump": at_pair(pairs, "slave_temperature", 0.0)
                - at_pair(pairs, "master_temperature", 0.0), "heat_rate": pairs["heat_rate"][-1],
                "sliding": u[up] - u[low]}


def found_bent(path, inside, outside):
    """Return what a run of bent() found."""
    with h5py.File(path) as file:
        pairs = file["contact/CRACK"]
        return {"force": pairs["normal_force"][-1], "gap": at_pair(pairs, "gap", outside),
                "pressure": at_pair(pairs, "pressure", inside),
                "edge": pairs["edges_contact"][-1, 0] + pairs["x"][0]}


def arc_length(deck, x):
    """Return the arc length of the pairs at x: from the first that is no tip."""
    on_crack = sorted(p[0] for p in nodes_of(deck).values() if p[1] == 0.0 and abs(p[0]) <= HALF)
    return float(x - on_crack[1])


FINE = 64   # elements around the crack; again with twice as many


def limits(folder, make, found):
    """Return what is known, what runs on two meshes found, and how far their limit is known.

    Errors fall as h^2, so the limit is the finer result and a third of the change. The next term is
    smaller by one order of h or more, so that the limit is known to h times the change, with h the
    angle of the finer elements.
    """
    runs = []
    for count in (FINE, 2 * FINE):
        deck, known, *places = make(count)
        path = solve(write(folder / f"deck{count}.inp", ["*OPTIONS, WIDTH=300, ERRORS=NO"], deck))
        runs.append(found(path, *(places[0] if places else ())))
    for name, value in known.items():
        if name == "heat_rate":
            continue   # of tip pairs too: h^2 log h
        coarse, fine = (run[name] - value for run in runs)
        assert coarse / fine == pytest.approx(4.0, abs=0.4), name
        change = runs[1][name] - runs[0][name]
        limit = runs[1][name] + change / 3
        assert limit == pytest.approx(value, abs=abs(change) * np.pi / FINE), name
    return known, runs[1]


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_gas_in_an_open_crack_carries_its_share_of_the_heat(tmp_path, plane):
    """Gap, jump of the temperature, flux and sliding to some 1e-6."""
    known, fine = limits(tmp_path, lambda count: gassy(count, plane, 0.05), found_gassy)
    assert fine["heat_rate"] == pytest.approx(known["heat_rate"], rel=5e-4)


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_a_crack_in_bending_closes_over_a_third_of_its_length(tmp_path, plane):
    """The edge of contact is sharpened to a tenth of the nodal spacing, as in Hertz's contact."""
    _, fine = limits(tmp_path, lambda count: bent(count, plane, 5.0), found_bent)
    spacing = HALF * np.sqrt(8.0) / 3 * np.pi / (2 * FINE)
    assert fine["edge"] == pytest.approx(-HALF / 3, abs=0.1 * spacing)


@pytest.mark.parametrize("above", [24, 48])
def test_gas_in_an_open_crack_whose_faces_do_not_match(tmp_path, above):
    """Gap and jump of a mortar point are means with its hat: of an ellipse, over two sides of an
    angle h each, 1 - h^2/12 of the middle. What is left is the error of pairs of nodes."""
    deck, known = gassy(FINE, "strain", 0.05, above)
    with h5py.File(solve(write(tmp_path / "gas.inp", ["*OPTIONS, WIDTH=300"], deck))) as file:
        points = file["contact/CRACK"]
        assert points.attrs["pairing"] == "SURFACES"
        assert len(points["x"]) == above - 1
        middle = (above - 1) // 2
        assert points["x"][middle] == pytest.approx(0.0, abs=1e-9)
        jump = points["slave_temperature"][-1, middle] - points["master_temperature"][-1, middle]
        mean = 1 - (np.pi / above) ** 2 / 12
        assert points["gap"][-1, middle] == pytest.approx(mean * known["gap"], rel=2e-4)
        assert abs(jump) == pytest.approx(mean * known["jump"], rel=2e-4)
        assert points["heat_rate"][-1] == pytest.approx(known["heat_rate"], rel=1e-3)


@pytest.mark.parametrize("above", [24, 48])
def test_a_crack_in_bending_closes_whose_faces_do_not_match(tmp_path, above):
    """The force errs with the square of the slave's sides; the edge, which lies between two contact
    points, by less than a fifth of their distance."""
    deck, known, _ = bent(FINE, "strain", 5.0, above)
    with h5py.File(solve(write(tmp_path / "bent.inp", ["*OPTIONS, WIDTH=300"], deck))) as file:
        points = file["contact/CRACK"]
        assert points.attrs["pairing"] == "SURFACES"
        force, edge = points["normal_force"][-1], points["edges_contact"][-1, 0] + points["x"][0]
        assert file["history/force_imbalance"][-1] < 1e-12
    assert force == pytest.approx(known["force"], rel=(np.pi / above) ** 2 / 8)
    assert edge == pytest.approx(-HALF / 3, abs=0.2 * HALF * np.sqrt(8.0) / 3 * np.pi / above)


def test_heat_follows_the_gas(tmp_path):
    """Errors at this mesh are 1e-4, those of *GAP LAW, TYPE=GAS, A are 0.1."""

    def make(gas):
        deck, known = gassy(FINE, "strain", gas)
        middle = f"CRACK@{arc_length(deck, 0.0)!r}"
        return deck, [("gap", middle, "LAST", known["gap"], 1e-4),
                      ("heat_flux", middle, "LAST", known["heat_flux"], 1e-4),
                      ("slave_temperature", middle, "LAST", known["jump"] / 2, 1e-4),
                      ("master_temperature", middle, "LAST", -known["jump"] / 2, 1e-4),
                      ("heat_rate", "CRACK", "LAST", known["heat_rate"], 1.2e-3),
                      ("status", "CRACK", "LAST", 0.0, 0.0, "ABS")]

    follows(tmp_path, make, 0.05, 0.06)


def test_contact_of_a_crack_in_bending_recedes_to_the_same_edge_under_any_load(tmp_path):
    """Pressure and gap grow with the load, the edge stays."""

    def make(slope):
        deck, known, (_, outside) = bent(FINE, "stress", slope)
        spacing = float(HALF * np.sqrt(8.0) / 3 * np.pi / FINE)
        edge = arc_length(deck, -HALF / 3)
        return deck, [("normal_force", "CRACK", "LAST", known["force"], 1.2e-4),
                      ("gap", f"CRACK@{arc_length(deck, outside)!r}", "LAST", known["gap"], 6e-4),
                      ("edge_contact", "CRACK", "LAST", edge, 0.1 * spacing, "ABS"),
                      ("shear_force", "CRACK", "LAST", 0.0, 1e-9, "ABS")]

    follows(tmp_path, make, 5.0, 5.5)
