"""Pairs at the ends of contact faces whose two nodes supports hold along x or y, at any tilt.

A block cut along a straight line and squeezed alike along x and y is under one pressure p
everywhere, and so is the cut, whatever its angle: pressures, gaps, reactions and displacements are
those of two elements of any kind, exactly.
"""

import re

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import run, solve
from physics import material, mesh, nodes_of

YOUNG, POISSON, SQUEEZE = 1000.0, 0.3, 1e-3
PRESSURE = YOUNG * SQUEEZE / ((1 + POISSON) * (1 - 2 * POISSON))
WIDTH, MIDDLE, HEIGHT = 1.0, 2.0, 4.0
TILTS = [0.0, 1e-7, 0.5, 5.0, 8.0, 8.3, 30.0, 60.0]   # degrees


def blocks(kind, tilt, apart=0.0, columns=2):
    """Return two blocks that face each other along a line through (0, MIDDLE); LOW carries UP,
    which is moved up by `apart`."""
    slope = np.tan(np.deg2rad(tilt))

    def low(x, y):
        return x, y * (MIDDLE + slope * x) / MIDDLE

    def up(x, y):
        bottom = MIDDLE + slope * x
        return x, HEIGHT + apart - (HEIGHT - y) * (HEIGHT - bottom) / (HEIGHT - MIDDLE)

    xs = [float(x) for x in np.linspace(0.0, WIDTH, columns + 1)]
    return [*mesh("LOW", xs, [0.0, 0.7, MIDDLE], kind, to=low),
            *mesh("UP", xs, [MIDDLE, 3.1, HEIGHT], kind, 1001, to=up),
            *material("LOW", (YOUNG, POISSON)), *material("UP", (YOUNG, POISSON))]


def interface(friction=0.0, slave="UP.BOTTOM", master="LOW.TOP"):
    """Return the cards of the contact."""
    return ["*SURFACE INTERACTION, NAME=CUT", *(["*FRICTION", f"{friction!r}"] if friction else []),
            "*CONTACT PAIR, INTERACTION=CUT, NAME=CUT", f"{slave}, {master}"]


def moved(cards, dof, place, value):
    """Return *BOUNDARY data that give the nodes at a place this displacement."""
    return [f"{n}, {dof}, {dof}, {value!r}" for n, at in nodes_of(cards).items()
            if abs(at[dof - 1] - place) < 1e-9]


def squeezed(kind, tilt, friction=0.0, gap=0.0, slave_above=True):
    """Return the block, squeezed by SQUEEZE along both axes once a gap along y is closed."""
    cards = blocks(kind, tilt, gap)
    faces = ("UP.BOTTOM", "LOW.TOP") if slave_above else ("LOW.TOP", "UP.BOTTOM")
    return [*cards, *interface(friction, *faces), "*STEP", "*STATIC", "1., 1.", "*BOUNDARY",
            *moved(cards, 1, 0.0, 0.0), *moved(cards, 1, WIDTH, -SQUEEZE * WIDTH),
            *moved(cards, 2, 0.0, 0.0), *moved(cards, 2, HEIGHT + gap, -gap - SQUEEZE * HEIGHT),
            "*END STEP"]


@pytest.mark.parametrize("kind", ["CPE4", "CPE4I", "CPE8", "CPE6"])
@pytest.mark.parametrize("tilt", TILTS)
def test_a_tilted_cut_is_under_the_same_pressure_up_to_its_held_ends(tmp_path, kind, tilt):
    path = solve(write(tmp_path / "cut.inp", ["*OPTIONS, WIDTH=300"], squeezed(kind, tilt)))
    with h5py.File(path) as file:
        pairs = file["contact/CUT"]
        np.testing.assert_allclose(pairs["pressure"][-1], PRESSURE, rtol=1e-9)
        np.testing.assert_allclose(pairs["gap"][-1], 0.0, atol=1e-15)
        np.testing.assert_allclose(pairs["slip"][-1], 0.0, atol=1e-14)
        u = file["VTKHDF/PointData/displacement"][:]
        x = file["VTKHDF/Points"][:]
    half = len(x) - len(x) // 2
    np.testing.assert_allclose(u[-half:, :2], -SQUEEZE * x[-half:, :2], atol=1e-12)


@pytest.mark.parametrize("slave_above", [True, False])
@pytest.mark.parametrize(("tilt", "friction"), [(5.0, 0.0), (5.0, 0.4), (30.0, 0.0), (30.0, 0.4)])
def test_a_gap_closes_along_the_normal_and_friction_at_held_ends_is_left_to_supports(
        tmp_path, tilt, friction, slave_above):
    """A gap g along y is g cos(tilt) wide. While it closes, pairs that are not held may slide;
    those at the ends close where they are, stick, and carry no shear."""
    gap = 1e-4
    deck = write(tmp_path / "cut.inp", ["*OPTIONS, WIDTH=300"],
                 squeezed("CPE4", tilt, friction, gap, slave_above))
    path = solve(deck)
    with h5py.File(path) as file:
        pairs = {name: values[-1] for name, values in file["contact/CUT"].items()
                 if values.ndim == 2 and values.shape[1] == 3}
    np.testing.assert_allclose(pairs["gap"], 0.0, atol=1e-15)
    ends = [0, -1]
    np.testing.assert_allclose(pairs["slip"][ends], 0.0, atol=1e-15)
    np.testing.assert_allclose(pairs["shear"][ends], 0.0, atol=1e-12)
    assert set(pairs["status"][ends]) == {2.0 if friction else 1.0}
    if not friction:
        np.testing.assert_allclose(pairs["pressure"], PRESSURE, rtol=1e-9)
    found = re.search(r"initial gaps\s+(\S+)\s+to\s+(\S+)", run("check", deck).stdout)
    assert [float(found[k]) for k in (1, 2)] == pytest.approx(
        [gap * np.cos(np.deg2rad(tilt))] * 2, rel=1e-5)


@pytest.mark.parametrize("tilt", [0.0, 3.0, 20.0])
def test_a_wedge_that_is_pushed_lifts_what_it_carries(tmp_path, tilt):
    """Both nodes of every pair are held along x, those of the wedge pushed by d: the upper block
    rises by d tan(tilt), and the wedge slides by d/cos(tilt) under it. With nu = 0 both blocks are
    rods under the load p along y, which on the face is p normal to it."""
    push, load = 0.01, 3.0
    cards = [re.sub(f", {POISSON}$", ", 0.", card) for card in blocks("CPE8", tilt)]
    path = solve(write(
        tmp_path / "wedge.inp", ["*OPTIONS, WIDTH=300"], cards, interface(),
        ["*AMPLITUDE, NAME=NOW", "0., 1., 1., 1.", "*STEP", "*STATIC, DIRECT", "0.5, 1.",
         "*BOUNDARY", "UP, 1", f"LOW, 1, 1, {-push!r}", "LOW.BOTTOM, 2",
         "*DSLOAD, AMPLITUDE=NOW", f"UP.TOP, P, {load!r}", "*END STEP"]))
    angle = np.deg2rad(tilt)
    with h5py.File(path) as file:
        pairs = file["contact/CUT"]
        np.testing.assert_allclose(pairs["pressure"][:], load, rtol=1e-9)
        np.testing.assert_allclose(
            pairs["slip"][:], np.outer([0.5, 1.0], np.full(5, push / np.cos(angle))), rtol=1e-9)
        u = file["VTKHDF/PointData/displacement"][:]
        x = file["VTKHDF/Points"][:]
    top = np.isclose(x[-len(x) // 4:, 1], HEIGHT)
    np.testing.assert_allclose(
        u[-len(x) // 4:, 1][top], push * np.tan(angle) - load * HEIGHT / YOUNG, rtol=1e-9)


def ring(kind, divisions, friction, whole):
    """Return a tube in another one that it overlaps by 0.002, a quarter of both or a half, from the
    y axis on, with as many elements in a quarter."""
    def polar(angle, radius):
        turned = np.deg2rad(90.0 - angle)
        return float(radius * np.cos(turned)), float(radius * np.sin(turned))

    angles = [float(a) for a in np.linspace(0.0, 90.0 * (1 + whole), divisions * (1 + whole) + 1)]
    cards = [*mesh("HUB", angles, [1.0, 1.5, 2.001], kind, to=polar),
             *mesh("RIM", angles, [1.999, 2.5, 3.0], kind, 1001, to=polar)]
    for n, (x, y) in nodes_of(cards).items():
        cards += [f"*NSET, NSET=AXIS{dof}\n{n}" for dof, at in ((1, x), (2, y)) if abs(at) < 1e-9]
    return [*cards, *material("HUB", (YOUNG, POISSON)), *material("RIM", (YOUNG, POISSON)),
            *interface(friction, "HUB.TOP", "RIM.BOTTOM"), "*STEP", "*STATIC", "1., 1.",
            "*BOUNDARY", "AXIS1, 1", "AXIS2, 2", "*END STEP"]


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(("kind", "divisions"), [
    ("CPE4", 1), ("CPE4", 2), ("CPE4", 4), ("CPE8", 1), ("CPE8", 2)])
def test_a_coarse_quarter_ring_moves_as_the_half_ring_of_which_it_is_a_part(
        tmp_path, kind, divisions, friction):
    """Sides of 4-node elements tilt by half their angle at the ends, 45 degrees with one element.
    In the half ring the pair on the x axis is an inner one; its normal lies in that axis."""
    found = []
    for whole in (0, 1):
        path = solve(write(tmp_path / f"ring{whole}.inp", ["*OPTIONS, WIDTH=300"],
                           ring(kind, divisions, friction, whole)))
        with h5py.File(path) as file:
            x, u = file["VTKHDF/Points"][:], file["VTKHDF/PointData/displacement"][:]
            body = file["VTKHDF/PointData/node_id"][:] > 1000
            found.append({(bool(b), *np.round(p[:2], 9)): v[:2]
                          for b, p, v in zip(body[-len(x):], x, u[-len(x):], strict=False)})
    part, half = found
    assert len(part) > 8
    for place, value in part.items():
        np.testing.assert_allclose(value, half[place], atol=1e-12, err_msg=str(place))


@pytest.mark.parametrize(("kind", "error"), [("CPE4", 0.03), ("CPE8", 0.002)])
def test_a_quarter_ring_is_pressed_as_lame_says(tmp_path, kind, error):
    """p = overlap/(R (compliance of both)), for every friction."""
    stiff, poisson = YOUNG / (1 - POISSON**2), POISSON / (1 - POISSON)
    both = (2**2 + 1**2) / (2**2 - 1**2) - poisson + (3**2 + 2**2) / (3**2 - 2**2) + poisson
    path = solve(write(tmp_path / "ring.inp", ["*OPTIONS, WIDTH=300"], ring(kind, 6, 0.3, 0)))
    with h5py.File(path) as file:
        pairs = file["contact/CUT"]
        mean = pairs["normal_force"][-1] / pairs["weight"][:].sum()
        assert mean == pytest.approx(0.002 * stiff / (2 * both), rel=error)
        np.testing.assert_allclose(pairs["shear"][-1], 0.0, atol=1e-4 * mean)


@pytest.mark.parametrize(("tilt", "supports"), [
    (90.0, ["1"]), (0.0, ["2"]), (30.0, ["1, 2"])])
def test_a_prescribed_normal_motion_is_refused(tmp_path, tilt, supports):
    """Along the held axis itself, and along both, the force is undetermined."""
    cards = blocks("CPE4", tilt if tilt < 90.0 else 0.0)
    if tilt == 90.0:
        cards = turned(cards)
    deck = write(tmp_path / "held.inp", ["*OPTIONS, WIDTH=300"], cards, interface(),
                 ["*STEP", "*STATIC", "*BOUNDARY", "LOW.BOTTOM, 1, 2", "UP.TOP, 1, 2",
                  *(f"{nodes}.LEFT, {dofs}" for nodes in ("UP", "LOW") for dofs in supports),
                  "*END STEP"])
    process = run("check", deck)
    assert process.returncode == 1
    assert "their contact force is undetermined" in process.stderr


def turned(cards):
    """Return the cards with x and y of all nodes turned by a right angle."""
    places = nodes_of(cards)
    swapped, inside = [], False
    for card in cards:
        if card.startswith("*"):
            inside = card.startswith("*NODE,")
        elif inside:
            n = int(card.split(",")[0])
            card = f"{n}, {-places[n][1]!r}, {places[n][0]!r}"
        swapped.append(card)
    return swapped
