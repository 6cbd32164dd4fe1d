"""Node pairs on drawings: each node of the slave is paired with the point that its normal meets, and
with none where the drawing is not opposite it, however steep the drawing is."""

from itertools import pairwise
from math import atan2, cos, radians, sin, sqrt, tan

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import solve
from physics import material, mesh, nodes_of
from test_mortar_patch import even

TOP, MIDDLE, WIDTH, SIDES = 0.8, 1.0, 2.0, 20   # of the slave's face
STATIC = ["*STEP", "*STATIC, DIRECT", "1., 1.", "*BOUNDARY"]


def line(x, y):
    return f"LINE, {x!r}, {y!r}"


def arc(x, y, centre):
    return f"CIRCL, {x!r}, {y!r}, {centre[0]!r}, {centre[1]!r}"


def drawn(start, *pieces):
    """Return the cards of a rigid drawing."""
    return ["*NODE", "9000, 1., 2.", "*SURFACE, NAME=DIE, TYPE=SEGMENTS",
            f"START, {start[0]!r}, {start[1]!r}", *pieces,
            "*RIGID BODY, REF NODE=9000, ANALYTICAL SURFACE=DIE"]


def pressed(path, drawing, down, kind="CPE4", to=None):
    """Press a drawing on a block; return the interface's datasets at the end."""
    block = mesh("BLOCK", even(0.0, WIDTH, SIDES), even(0.0, TOP, 2), kind, to=to)
    deck = write(path, ["*OPTIONS, ERRORS=NO"], block, material("BLOCK", (1e5, 0.3)), drawing,
                 ["*SURFACE INTERACTION, NAME=I",
                  "*CONTACT PAIR, INTERACTION=I, NAME=C, PAIRING=NODES", "BLOCK.TOP, DIE", *STATIC,
                  "BLOCK.BOTTOM, 1, 2", "9000, 1", "9000, 6", f"9000, 2, 2, {-down!r}",
                  *(["BLOCK.LEFT, 1"] if kind.startswith("CAX") else []), "*END STEP"])
    with h5py.File(solve(deck)) as file:
        found = {key: data[-1] if data.ndim > 1 else data[()]
                 for key, data in file["contact/C"].items() if data.shape[0] > 0}
    return found, nodes_of(block)


@pytest.mark.parametrize("angle", [30.0, 58.0, 70.0, 80.0, 90.0, 120.0])
def test_the_ends_of_a_punch_take_in_no_node_beside_it(tmp_path, angle):
    """Arcs that turn up behind the last nodes change nothing of the flat punch; beyond a right angle
    they show their backs. Above a gap, too, the weight of each node is a side of the face."""
    gap = 0.02
    level, down = TOP + gap, 0.003 + gap
    flat, _ = pressed(tmp_path / "flat.inp", drawn((1.33, level), line(0.68, level)), down)
    radius, turn = 0.05, radians(angle)
    aside, up = radius * sin(turn), level + radius * (1 - cos(turn))
    round_, _ = pressed(tmp_path / "round.inp", drawn(
        (1.33 + aside, up), arc(1.33, level, (1.33, level + radius)), line(0.68, level),
        arc(0.68 - aside, up, (0.68, level + radius))), down)
    np.testing.assert_allclose(round_["x"], np.arange(7, 14) / 10, rtol=1e-12)
    np.testing.assert_allclose(flat["weight"], 0.1, rtol=1e-9)
    for name in ("x", "weight", "gap", "pressure"):
        np.testing.assert_allclose(round_[name], flat[name], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(flat["pressure"], flat["pressure"][::-1], rtol=1e-9)


@pytest.mark.parametrize("angle", [20.0, 50.0, 66.0, 75.0, 85.0])
def test_gaps_of_a_ramp_are_those_along_the_normals(tmp_path, angle):
    """Along the slave's normal, seen along the normal midway between both faces."""
    slope, reach = tan(radians(angle)), 0.33
    found, _ = pressed(tmp_path / "ramp.inp", drawn((MIDDLE + reach, TOP + reach * slope),
                       line(MIDDLE, TOP)), 0.0)
    np.testing.assert_allclose(found["x"], np.arange(10, 14) / 10, rtol=1e-12)
    np.testing.assert_allclose(found["gap"], (found["x"] - MIDDLE) * slope * cos(radians(angle) / 2),
                               atol=1e-9)


@pytest.mark.parametrize("closed", [False, True])
def test_gaps_of_a_roller_are_those_along_the_normals(tmp_path, closed):
    """As far as its radius, also of the whole roller: its upper half shows its back."""
    radius = 0.65
    centre = MIDDLE, TOP + radius
    corners = [(MIDDLE + radius, centre[1]), (MIDDLE, TOP), (MIDDLE - radius, centre[1]),
               (MIDDLE, centre[1] + radius), (MIDDLE + radius, centre[1])][:5 if closed else 3]
    found, _ = pressed(tmp_path / "roller.inp", drawn(corners[0], *(
        arc(*end, centre) for end in corners[1:])), 0.0)
    np.testing.assert_allclose(found["x"], np.arange(4, 17) / 10, rtol=1e-12)
    turn = np.arcsin(np.abs(found["x"] - MIDDLE) / radius)
    np.testing.assert_allclose(found["gap"], radius * (1 - np.cos(turn)) * np.cos(turn / 2), atol=1e-9)


@pytest.mark.parametrize("kind", ["CAX6", "CAX8"])
def test_a_face_that_leans_at_the_axis_meets_a_drawing_there(tmp_path, kind):
    """A ball in a dimple whose sides do not end level at the axis."""
    radius, bottom = 0.6, TOP + 1e-4

    def dimple(x, y):
        return x, y * (1 - 0.1 * x * (1 - x) / TOP)

    found, nodes = pressed(tmp_path / "ball.inp", drawn((0.5, bottom + radius - sqrt(radius**2 - 0.25)),
                           arc(0.0, bottom, (0.0, bottom + radius))), 0.0, kind, dimple)
    face = sorted(place for place in nodes.values() if place[1] > 0.9 * TOP)[:3]
    assert found["x"][0] == 0.0 and found["weight"][0] == 0.0
    assert (found["weight"][1:] > 0.0).all() and (found["pressure"] == 0.0).all()
    (dx, dy), (ex, ey) = ((b[0] - a[0], b[1] - a[1]) for a, b in pairwise(face))
    lean = atan2(3 * dy - ey, 3 * dx - ex)   # of the parabola through the side at its end
    assert found["gap"][0] == pytest.approx(1e-4 * cos(lean / 2), abs=1e-9)


def test_a_drawing_faces_a_slave_whose_face_goes_round_a_corner(tmp_path):
    """Its last node, which is farther away, is on the side, where nothing is met."""
    forces = []
    for sides in ("TOP",), ("TOP", "RIGHT"):
        block = mesh("BLOCK", even(0.0, WIDTH, 4), even(0.0, TOP, 2), "CPE4")
        faces = [block[k] for side in sides for k in range(
            block.index(f"*SURFACE, NAME=BLOCK.{side}") + 1, len(block)) if block[k].endswith(
                {"TOP": "S3", "RIGHT": "S2"}[side])]
        faces = list(dict.fromkeys(faces))
        deck = write(tmp_path / "deck.inp", ["*OPTIONS, ERRORS=NO"], block, [
            "*SURFACE, NAME=ROUND", *faces], material("BLOCK", (1e5, 0.0)), drawn(
                (3.0, TOP), line(-1.0, TOP)), [
            "*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I, NAME=C, PAIRING=NODES",
            "ROUND, DIE", *STATIC, "BLOCK.BOTTOM, 1, 2", "9000, 1", "9000, 6",
            "9000, 2, 2, -0.0008", "*END STEP"])
        with h5py.File(solve(deck)) as file:
            forces.append(file["contact/C/normal_force"][-1])
    assert forces[0] == pytest.approx(200.0, rel=1e-9)
    assert 0.0 < forces[1] <= forces[0] * (1 + 1e-9)
