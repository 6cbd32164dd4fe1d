"""Curved faces whose nodes do not match: rings in closed form, Hertz, the published cylinder."""

import importlib.util
import math

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from deck_runs import CYLINDER, HERTZ, solve
from physics import material, mesh, nodes_of

import lame


def script(path):
    """Return a script that writes decks, as a module of its own."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


INNER, FACE, OUTER, OVERLAP = 1.0, 2.0, 3.0, 0.01
HUB, RIM = (1000.0, 0.3), (500.0, 0.25)
EXACT = lame.press_fit(INNER, FACE, OUTER, HUB, RIM, OVERLAP, "stress")


def arc(name, radii, count, first, angle=math.pi / 2, closed=False, start=0.0, kind="CPS8"):
    """Return the cards of a ring or a part of one, with `count` elements around it."""
    ends = [-angle + angle * k / count for k in range(count + 1)]
    return mesh(name, ends, radii, kind, first, closed=closed,
                to=lambda x, y: (y * math.cos(start - x), y * math.sin(start - x)))


def fit(hub, rim, slave, supports, path, refine=()):
    """Solve a press fit by *CLEARANCE and return the contact."""
    pair = ["IN.TOP", "OUT.BOTTOM"] if slave == "IN" else ["OUT.BOTTOM", "IN.TOP"]
    deck = write(path, ["*OPTIONS, WIDTH=200"], without_unused_surfaces(
        [*hub, *rim, *material("IN", HUB), *material("OUT", RIM), "*SURFACE INTERACTION, NAME=I",
         "*CONTACT PAIR, INTERACTION=I, NAME=C, PAIRING=SURFACES", ", ".join(pair),
         f"*CLEARANCE, MASTER={pair[1]}, SLAVE={pair[0]}, VALUE={-OVERLAP}", *refine,
         "*STEP", "*STATIC, DIRECT", "1., 1.", "*BOUNDARY", *supports, "*END STEP"]))
    with h5py.File(solve(deck)) as file:
        assert file["history/force_imbalance"][-1] < 1e-10
        face = file["contact/C"]
        return face["weight"][()], face["pressure"][-1]


@pytest.mark.parametrize("slave", ["IN", "OUT"])
@pytest.mark.parametrize(("kind", "order"), [("CPS8", 4), ("CPS4", 2)])
def test_press_fit_of_quarter_rings_converges_with_the_order_of_the_element(
        tmp_path, kind, order, slave):
    """3 sides against 4, and twice that: the force has twice the order of the strains. With one
    normal a contact point it would err by h^2/6 with elements of any order."""
    errors = []
    for level in (1, 2):
        depths = [k / (2 * level) for k in range(2 * level + 1)]
        weight, pressure = fit(arc("IN", [INNER + d for d in depths], 3 * level, 1, kind=kind),
                               arc("OUT", [FACE + d for d in depths], 4 * level, 5001, kind=kind),
                               slave,
                               ["IN.LEFT, 1", "OUT.LEFT, 1", "IN.RIGHT, 2", "OUT.RIGHT, 2"],
                               tmp_path / "fit.inp")
        errors.append(abs(weight @ pressure / weight.sum() / EXACT - 1.0))
    side = math.pi / 2 / (3 if slave == "IN" else 4)
    if kind == "CPS8":
        assert errors[0] < side**2 / 6 / 20
    assert errors[1] < errors[0] / 2**(order - 0.3)


@pytest.mark.parametrize("count", [10, 14, 24])
def test_ends_of_matching_arcs_on_axes_of_symmetry(tmp_path, count):
    """Both faces are held across the axis where they end; the number of sides does not matter. The
    ends are as good as the middle, to the order of the elements, with h^2/2 as sides cut the arc."""
    depths = [k / 4 for k in range(5)]
    supports = ["IN.LEFT, 1", "OUT.LEFT, 1", "IN.RIGHT, 2", "OUT.RIGHT, 2"]
    for other in (count, count + 1):
        _, pressure = fit(arc("IN", [INNER + d for d in depths], count, 1, kind="CPS4"),
                          arc("OUT", [FACE + d for d in depths], other, 5001, kind="CPS4"), "IN",
                          supports, tmp_path / "arcs.inp")
        np.testing.assert_allclose(pressure, pressure[::-1], rtol=1e-8)
        assert pressure[count // 2] == pytest.approx(EXACT, rel=1e-2)
        np.testing.assert_allclose(pressure, pressure[count // 2],
                                   rtol=(math.pi / 2 / count)**2 / 2)


@pytest.mark.parametrize("slave", ["IN", "OUT"])
def test_closed_ring_in_a_ring_that_is_turned(tmp_path, slave):
    """12 sides in 16 whose corners lie elsewhere: no side is the first or the last one."""
    turn = 2 * math.pi / 32
    hub = arc("IN", [1.0, 1.5, 2.0], 12, 1, 2 * math.pi, closed=True)
    rim = arc("OUT", [2.0, 2.5, 3.0], 16, 5001, 2 * math.pi, closed=True, start=turn)
    supports = []
    for cards, radius in ((hub, INNER), (rim, OUTER)):
        for angle, dof in ((0.0, 2), (math.pi, 2), (math.pi / 2, 1)):
            at = radius * math.cos(angle), radius * math.sin(angle)
            node, place = min(nodes_of(cards).items(), key=lambda item: math.dist(item[1], at))
            assert math.dist(place, at) < 1e-9
            supports.append(f"{node}, {dof}")
    weight, pressure = fit(hub, rim, slave, supports, tmp_path / "rings.inp")
    assert len(pressure) == (12 if slave == "IN" else 16)
    np.testing.assert_allclose(pressure, EXACT, rtol=2e-3)
    assert weight.sum() == pytest.approx(4 * math.pi, rel=1e-4)


def hertz(upper, lower, slave):
    """Return the cards of the Hertz contact with `upper` and `lower` elements from 0 to 1.2."""
    deck = script(HERTZ.parent / "make_deck.py")
    deck.INNER, deck.RINGS = 1.2, 8
    deck.ACROSS = upper
    above = deck.make_body(lambda x, y: (x, y + (1 - y / deck.SIZE) * x**2 / (2 * deck.RADIUS)))
    deck.ACROSS = lower
    below, elements = deck.make_body(lambda x, y: (x, 0.0 - y))
    mirrored = [[e[k] + 100000 for k in (1, 0, 3, 2, 4, 7, 6, 5)] for e in elements]
    bodies = above, ({n + 100000: p for n, p in below.items()}, mirrored)
    cards = []
    named = zip(bodies, ("CYLINDER", "BLOCK"), (1, 100001), strict=True)
    for (nodes, around), name, first in named:
        cards += [f"*NODE, NSET={name}", *(f"{n}, {x!r}, {y!r}" for n, (x, y) in nodes.items()),
                  f"*ELEMENT, TYPE=CPE8, ELSET={name}",
                  *(", ".join(map(str, [first + k, *e])) for k, e in enumerate(around))]
    (high, over), (deep, under) = bodies
    nodes = {**high, **deep}
    curved = {n for n, (x, y) in high.items() if abs(y - x**2 / 200.0) < 1e-8 and x <= deck.SIZE}
    cards += ["*ELSET, ELSET=LOADED",
              *(str(k + 1) for k, e in enumerate(over)
                if all(high[e[c]][1] == deck.SIZE for c in (1, 2))),
              "*NSET, NSET=BOTTOM", *(str(n) for n, p in nodes.items() if p[1] == -deck.SIZE),
              "*NSET, NSET=AXIS", *(str(n) for n, p in nodes.items() if p[0] == 0.0),
              "*SURFACE, NAME=CURVED",
              *(f"{k + 1}, S1" for k, e in enumerate(over) if {e[0], e[1], e[4]} <= curved),
              "*SURFACE, NAME=FLAT",
              *(f"{k + 100001}, S1" for k, e in enumerate(under)
                if deep[e[0]][1] == deep[e[1]][1] == 0.0)]
    surfaces = "CURVED, FLAT" if slave == "CURVED" else "FLAT, CURVED"
    model = deck.MODEL.replace("*REFINE, LEVELS=1\n", "").replace("0.25, 1.", "1., 1.").replace(
        "NAME=FACE\nCURVED, FLAT", f"NAME=FACE, PAIRING=SURFACES\n{surfaces}")
    return [*cards, *model.splitlines()], deck.theory()


@pytest.mark.parametrize(("upper", "lower", "slave"), [(23, 15, "CURVED"), (15, 23, "FLAT"),
                                                       (23, 6, "CURVED"), (6, 23, "FLAT")])
def test_peak_pressure_of_hertz_with_sizes_2_to_3_and_1_to_4(tmp_path, upper, lower, slave):
    """The slave has 20 elements along the contact."""
    cards, (_, peak, force) = hertz(upper, lower, slave)
    with h5py.File(solve(write(tmp_path / "hertz.inp", ["*OPTIONS, WIDTH=200"], cards))) as file:
        face = file["contact/FACE"]
        assert np.count_nonzero(face["pressure"][-1]) == 20
        assert face["pressure"][-1][0] == pytest.approx(peak, rel=0.01)
        assert face["pressure"][-1].max() == pytest.approx(peak, rel=0.01)
        assert face["normal_force"][-1] == pytest.approx(force, rel=2e-5)


@pytest.mark.parametrize(("upper", "lower", "slave"),
                         [(24, 16, "CURVED"), (16, 24, "FLAT"), (24, 6, "CURVED"), (6, 24, "FLAT")])
def test_half_width_of_hertz_with_sizes_2_to_3_and_1_to_4(tmp_path, upper, lower, slave):
    """The half-width is 20 sides of the slave."""
    cards, (half_width, *_) = hertz(upper, lower, slave)
    assert int(half_width / (1.2 / 24)) == 20
    with h5py.File(solve(write(tmp_path / "hertz.inp", ["*OPTIONS, WIDTH=200"], cards))) as file:
        edge = file["contact/FACE/edge_contact"][-1]
    assert edge == pytest.approx(half_width, rel=0.01)


def cylinder(count, base_count, slave):
    """Return the published cylinder on its base with these numbers of sides from 0 to 10."""
    script_of_deck = script(CYLINDER.parent / "make_decks.py")
    heights = [0.0, 0.35, 0.8, 1.5, 2.6, 4.2, 6.5, 10.0, 16.0, 28.0, 60.0]
    cards = []
    for name, sides, ys, first, to in (
            ("CYLINDER", count, heights, 1, lambda x, y: (x, y + (1 - y / 60) * x**2 / 200)),
            ("BASE", base_count, [-y for y in reversed(heights)], 100001, None)):
        xs = [10 * k / sides for k in range(sides + 1)] + [12.0, 15.0, 20.0, 30.0]
        cards += mesh(name, xs, ys, "CPE8", first, to=to)
    nodes = nodes_of(cards)
    for name, axis, value in (("TOP", 1, 60.0), ("BOTTOM", 1, -60.0), ("AXIS", 0, 0.0)):
        cards += [f"*NSET, NSET={name}"]
        cards += [str(n) for n, place in nodes.items() if abs(place[axis] - value) < 1e-9]
    model = script_of_deck.MODEL.format(base_expansion="1.2E-5", method="NEWTON",
                                        poisson=(0.4, 0.2), ends="").splitlines()
    at = next(k for k, card in enumerate(model) if card.startswith("*CONTACT PAIR"))
    faces = ["CYLINDER.BOTTOM", "BASE.TOP"]
    model[at:at + 2] = ["*CONTACT PAIR, INTERACTION=FACES, NAME=FACE, PAIRING=SURFACES",
                        ", ".join(faces if slave == "CYLINDER" else faces[::-1])]
    return without_unused_surfaces([*cards, *model])


def test_cylinder_with_30_sides_on_22_is_the_converged_one_whichever_is_the_slave(tmp_path):
    """Converged values at 540 and 900 C of tests/reference/cylinder_reference.py."""
    reference = {26: (1363.74, 17.265, 316.19), 44: (2486.96, 30.80, 428.78)}
    found = {}
    for slave in ("CYLINDER", "BASE"):
        cards = cylinder(30, 22, slave)
        deck = write(tmp_path / "cylinder.inp", ["*OPTIONS, WIDTH=200"], cards)
        with h5py.File(solve(deck)) as file:
            face = file["contact/FACE"]
            for row in reference:
                found[slave, row] = (face["normal_force"][row], abs(face["heat_rate"][row]),
                                     face["pressure"][row].max())
    for row, exact in reference.items():
        one, other = np.array(found["CYLINDER", row]), np.array(found["BASE", row])
        assert np.all(np.abs(one / exact - 1.0) < [1e-3, 8e-3, 3e-3])
        assert np.all(np.abs(one / other - 1.0)[:2] < [2e-3, 8e-3])
