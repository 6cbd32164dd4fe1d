"""Pairs that form rings: a block in an inner corner, blocks round a point, pellets in a tube.

Stuck pairs of a ring give by 1e-8 of what the bodies at their nodes give; GIVE is ten times that.
"""

import math

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces
from physics import follows, judge, material, mesh

GIVE = 1e-7
EXACT = 1e-9
YOUNG, POISSON = 1000.0, 0.3
XS = [0.0, 0.4, 1.0]
BLOCK = mesh("BLOCK", XS, XS)
# An L of elements, as one body: its inner corner is the node that floor and wall share.
ELBOW = mesh("ELBOW", [-1.0, -0.4, 0.0, 0.4, 1.0], [-1.0, -0.4, 0.0, 0.4, 1.0], first=101)


def elbow():
    """Return the L, all of it held, and the surfaces along its inner sides."""
    nodes, elements, inside = {}, [], None
    for card in ELBOW:
        if card.startswith("*"):
            inside = card.split(",")[0]
        elif inside == "*NODE":
            number, x, y = card.split(",")
            nodes[int(number)] = float(x), float(y)
        elif inside == "*ELEMENT":
            elements.append([int(field) for field in card.split(",")])
    kept = [e for e in elements
            if not all(nodes[n][0] >= 0.0 and nodes[n][1] >= 0.0 for n in e[1:])]
    used = sorted({n for e in kept for n in e[1:]})
    floor = [e[0] for e in kept if all(nodes[n][0] >= 0.0 for n in e[1:])
             and nodes[e[3]][1] == 0.0]
    wall = [e[0] for e in kept if all(nodes[n][1] >= 0.0 for n in e[1:])
            and nodes[e[2]][0] == 0.0]
    return ["*NODE, NSET=ELBOW", *(f"{n}, {nodes[n][0]!r}, {nodes[n][1]!r}" for n in used),
            "*ELEMENT, TYPE=CPE8, ELSET=ELBOW", *(", ".join(map(str, e)) for e in kept),
            "*SURFACE, NAME=FLOOR", *(f"{e}, S3" for e in floor),
            "*SURFACE, NAME=WALL", *(f"{e}, S2" for e in wall)]


def interaction(friction):
    """Return the cards of an interaction, without friction where that is None."""
    return ["*SURFACE INTERACTION, NAME=FACES",
            *([] if friction is None else ["*FRICTION", f"{friction!r}"])]


def corner_pairs(swapped):
    """Return both contact pairs of the block in the corner, in either order."""
    pairs = [["*CONTACT PAIR, INTERACTION=FACES, NAME=UNDER", "BLOCK.BOTTOM, FLOOR"],
             ["*CONTACT PAIR, INTERACTION=FACES, NAME=BESIDE", "BLOCK.LEFT, WALL"]]
    return [card for pair in (pairs[::-1] if swapped else pairs) for card in pair]


def cornered(friction, swapped, held="ELBOW, 1, 2"):
    """Return a function of the pressure on the right: a block pressed into a rigid corner."""

    def make(right, top=3.0):
        cards = [*BLOCK, *elbow(), *material("BLOCK", (YOUNG, POISSON)),
                 *material("ELBOW", (YOUNG, POISSON)), *interaction(friction),
                 *corner_pairs(swapped), "*STEP", "*STATIC", "0.5, 1.", "*BOUNDARY", held,
                 "*DSLOAD", f"BLOCK.TOP, P, {top!r}", f"BLOCK.RIGHT, P, {right!r}", "*END STEP"]
        return cards, [("pressure", "UNDER", "LAST", top, EXACT),
                       ("pressure", "BESIDE", "LAST", right, EXACT),
                       ("normal_force", "UNDER", "LAST", top, EXACT),
                       ("normal_force", "BESIDE", "LAST", right, EXACT),
                       ("S11", "BLOCK", "LAST", -right, 1e-5),
                       ("S22", "BLOCK", "LAST", -top, 1e-5),
                       ("force_imbalance", "", "LAST", 0.0, 1e-9, "ABS")]

    return make


@pytest.mark.parametrize("swapped", [False, True])
def test_block_in_a_rigid_corner_is_pressed_evenly_on_both_sides(tmp_path, swapped):
    """The corner nodes are two pairs with normals at a right angle."""
    follows(tmp_path, cornered(None, swapped), 2.0, 2.5)


@pytest.mark.parametrize("clearance", [[], ["0.0015"]])
@pytest.mark.parametrize("friction", [0.2, 2.0])
def test_order_of_the_pairs_round_a_corner_does_not_matter(tmp_path, friction, clearance):
    """Which pair closes the ring; with friction, so that all of its forces count."""
    found = []
    for swapped in (False, True):
        cards, _ = cornered(friction, swapped)(2.0)
        at = cards.index("*STEP")
        cards[at:at] = [f"*CLEARANCE, MASTER=WALL, SLAVE=BLOCK.LEFT, VALUE={value}"
                        for value in clearance]
        result = judge(tmp_path, cards, [("time", "", "LAST", 1.0, 1e-12)], name=f"order{swapped:d}")
        with h5py.File(result) as file:
            pairs = {name: {key: values[()] for key, values in file[f"contact/{name}"].items()}
                     for name in ("UNDER", "BESIDE")}
        # The shear force on the block acts along increasing s: to the right, and up.
        up = pairs["UNDER"]["normal_force"] + pairs["BESIDE"]["shear_force"]
        right = pairs["BESIDE"]["normal_force"] + pairs["UNDER"]["shear_force"]
        np.testing.assert_allclose(up, [1.5, 3.0], rtol=1e-9)
        np.testing.assert_allclose(right, [1.0, 2.0], rtol=1e-9)
        found.append(pairs)
    for name in ("UNDER", "BESIDE"):
        for key in ("gap", "pressure", "shear", "slip", "status"):
            one, other = found[0][name][key], found[1][name][key]
            scale = {"gap": 1e-2, "slip": 1e-2}.get(key, np.abs(one).max())
            np.testing.assert_allclose(one, other, rtol=0.0, atol=GIVE * scale,
                                       err_msg=f"{name} {key}")


def sliding(friction):
    """Return a block, nu = 0, that slides down the wall under even shear, above the floor.

    Its right side goes down by `down`; what the shear strain leaves of that is the slip.
    """
    down, pressure, clearance = 0.01, 4.0, 0.02
    shear = friction * pressure
    slip = down - shear * 2 / YOUNG
    # The floor ends under the block: its right side is moved down, and so may not face the floor.
    held = elbow()
    del held[held.index("*SURFACE, NAME=WALL") - 1]
    short = ["*SURFACE, NAME=UNDERSIDE", "1, S1"]
    pairs = [card.replace("BLOCK.BOTTOM", "UNDERSIDE") for card in corner_pairs(False)]
    cards = [*BLOCK, *held, *short, *material("BLOCK", (YOUNG, 0.0)),
             *material("ELBOW", (YOUNG, 0.0)), *interaction(friction), *pairs,
             f"*CLEARANCE, MASTER=FLOOR, SLAVE=UNDERSIDE, VALUE={clearance!r}",
             "*STEP", "*STATIC", "0.25, 1.", "*BOUNDARY", "ELBOW, 1, 2",
             f"BLOCK.RIGHT, 2, 2, {-down!r}", "*DSLOAD", f"BLOCK.RIGHT, P, {pressure!r}",
             f"BLOCK.TOP, TRVEC, {shear!r}, -1., 0., 0.",
             f"BLOCK.BOTTOM, TRVEC, {shear!r}, 1., 0., 0.", "*END STEP"]
    return cards, [("pressure", "BESIDE", "LAST", pressure, EXACT),
                   ("shear", "BESIDE", "LAST", shear, EXACT),
                   ("slip", "BESIDE", "LAST", -slip, GIVE),
                   ("gap", "UNDER@0", "LAST", clearance - slip, EXACT),
                   ("gap", "UNDER@0.4", "LAST", clearance - slip - 0.4 * (down - slip), EXACT),
                   ("status", "BESIDE", "LAST", 1.0, 0.0, "ABS"),
                   ("status", "UNDER", "LAST", 0.0, 0.0, "ABS")]


def test_corner_of_a_block_slips_like_the_rest_of_its_side(tmp_path):
    follows(tmp_path, sliding, 0.2, 0.3)


def four_blocks(conductance, solver):
    """Return four blocks round the point (1, 1), pressed from above and from the right.

    Heat goes from left to right: across two interfaces side by side, none across the others.
    """
    right, top, hot, conductivity, expansion = 5.0, 3.0, 100.0, 2.0, 0.0
    cards = [f"*SOLVER, TYPE={solver}"]
    for name, x, y, first in (("A", 0, 0, 1), ("B", 1, 0, 101), ("C", 1, 1, 201), ("D", 0, 1, 301)):
        cards += [*mesh(name, [x, x + 0.4, x + 1.0], [y, y + 0.6, y + 1.0], first=first),
                  *material(name, (YOUNG, POISSON), expansion, conductivity)]
    cards += ["*SURFACE INTERACTION, NAME=FACES", "*FRICTION", "0.3", "*GAP LAW, TYPE=POWER",
              f"{conductance!r}, 0., 1."]
    for name, faces in (("AB", "A.RIGHT, B.LEFT"), ("BC", "C.BOTTOM, B.TOP"),
                        ("CD", "C.LEFT, D.RIGHT"), ("DA", "D.BOTTOM, A.TOP")):
        cards += [f"*CONTACT PAIR, INTERACTION=FACES, NAME={name}", faces]
    cards += ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.", "*BOUNDARY",
              "A.LEFT, 1", "D.LEFT, 1", "A.BOTTOM, 2", "B.BOTTOM, 2", "A.LEFT, 11, 11, 100.",
              "D.LEFT, 11, 11, 100.", "B.RIGHT, 11, 11, 0.", "C.RIGHT, 11, 11, 0.", "*DSLOAD",
              f"B.RIGHT, P, {right!r}", f"C.RIGHT, P, {right!r}", f"C.TOP, P, {top!r}",
              f"D.TOP, P, {top!r}", "*END STEP"]
    flux = hot / (2.0 / conductivity + 1.0 / conductance)
    left, beyond = hot - flux / conductivity, flux / conductivity
    rows = [("heat_in", "", "LAST", 2 * flux, EXACT), ("heat_imbalance", "", "LAST", 0.0, 1e-9, "ABS")]
    for pair, sign, hot_side, cold_side in (("AB", 1, "slave", "master"),
                                            ("CD", -1, "master", "slave")):
        rows += [("heat_flux", pair, "LAST", sign * flux, EXACT),
                 ("pressure", pair, "LAST", right, EXACT),
                 ("heat_rate", pair, "LAST", sign * flux, EXACT),
                 (f"{hot_side}_temperature", pair, "LAST", left, EXACT),
                 (f"{cold_side}_temperature", pair, "LAST", beyond, EXACT)]
    for pair in ("BC", "DA"):
        rows += [("heat_flux", pair, "LAST", 0.0, EXACT * flux, "ABS"),
                 ("pressure", pair, "LAST", top, EXACT)]
    rows += [("shear", pair, "LAST", 0.0, EXACT * right, "ABS") for pair in ("AB", "BC", "CD", "DA")]
    return cards, rows


@pytest.mark.parametrize("solver", ["SKYLINE", "MUMPS"])
def test_four_blocks_round_a_point_carry_pressure_and_heat_evenly(tmp_path, solver):
    follows(tmp_path, lambda conductance: four_blocks(conductance, solver), 4.0, 5.0)


def pellets(pressure, order=("ENDS", "LOWER", "UPPER"), hollow=0.0, friction=None):
    """Return two pellets about an axis, on each other in a rigid tube: sigma_r = nu/(1-nu) p.

    A hollow in the top of the first one leaves them in touch at its edge alone.
    """
    ys = [0.0, 0.3, 1.0]
    first = mesh("FIRST", XS, ys, "CAX8", to=lambda x, y: (x, y - hollow * y * (1.0 - x)))
    cards = [*first, *mesh("SECOND", XS, [1 + y for y in ys], "CAX8", 101),
             *mesh("TUBE", [1.0, 1.3], [*ys, *(1 + y for y in ys[1:])], "CAX8", 201)]
    for name in ("FIRST", "SECOND", "TUBE"):
        cards += material(name, (YOUNG, POISSON))
    # Rows of the tube: two beside each pellet.
    cards += ["*SURFACE, NAME=BORE1", "201, S4", "202, S4", "*SURFACE, NAME=BORE2", "203, S4",
              "204, S4", *interaction(friction)]
    faces = {"ENDS": "SECOND.BOTTOM, FIRST.TOP", "LOWER": "FIRST.RIGHT, BORE1",
             "UPPER": "SECOND.RIGHT, BORE2"}
    for name in order:
        cards += [f"*CONTACT PAIR, INTERACTION=FACES, NAME={name}", faces[name]]
    cards += ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "TUBE, 1, 2", "FIRST.BOTTOM, 2",
              "FIRST.LEFT, 1", "SECOND.LEFT, 1", "*DSLOAD", f"SECOND.TOP, P, {pressure!r}",
              "*END STEP"]
    radial = POISSON / (1 - POISSON) * pressure
    return cards, [("normal_force", "ENDS", "LAST", math.pi * pressure, EXACT),
                   ("normal_force", "LOWER", "LAST", 2 * math.pi * radial, EXACT),
                   ("normal_force", "UPPER", "LAST", 2 * math.pi * radial, EXACT),
                   ("pressure", "ENDS", "LAST", pressure, EXACT),
                   ("pressure", "LOWER", "LAST", radial, EXACT),
                   ("pressure", "UPPER", "LAST", radial, EXACT),
                   ("U1", "FIRST.RIGHT", "LAST", 0.0, 1e-9, "ABS")]


@pytest.mark.parametrize("last", ["ENDS", "LOWER", "UPPER"])
def test_two_pellets_and_their_tube_meet_in_one_ring(tmp_path, last):
    order = sorted(("ENDS", "LOWER", "UPPER"), key=lambda name: name == last)
    follows(tmp_path, lambda pressure: pellets(pressure, order), 2.0, 3.0)


def test_edges_that_alone_carry_a_pellet_stick_and_slip_in_their_ring(tmp_path):
    """The pair that closes the ring is the only one between the pellets."""
    cards, _ = pellets(0.2, ("LOWER", "UPPER", "ENDS"), hollow=5e-2, friction=0.4)
    at = cards.index("*STEP")
    cards[at:at] = [f"*CLEARANCE, SLAVE={slave}, MASTER={master}, VALUE={gap}"
                    for slave, master, gap in (("SECOND.RIGHT", "BORE2", 0.01),
                                               ("FIRST.RIGHT", "BORE1", 0.01))]
    result = judge(tmp_path, cards, [("time", "", "LAST", 1.0, 1e-12)])
    with h5py.File(result) as file:
        assert (file["contact/ENDS/status"][-1] > 0).sum() == 1
        assert file["contact/ENDS/normal_force"][-1] > 0.1 * math.pi
        assert file["history/force_imbalance"][-1] < 1e-10


@pytest.mark.parametrize("kind", ["CAX8", "CAX4"])
def test_on_the_axis_a_resting_face_has_the_heat_of_its_other_points(tmp_path, kind):
    """Round bars of length 1 between plates, conductivities 2 and 1, hot above, a gap g between.

    Open, the upper bar is longer than the gap; with the conductance of closed faces both are
    shorter. They rest with the flux q that makes them as long: alpha (T - q/k2/2 + q/k1/2) = g. On
    the axis three-node sides give a contact point no area, so no force tells that it rests.
    """
    hot, expansion, flux = 100.0, 1e-4, 20.0
    gap = expansion * (hot - flux / 4)
    cards = [*mesh("LOW", [0.0, 0.3, 1.0], [0.0, 0.5, 1.0], kind),
             *mesh("UP", [0.0, 0.3, 1.0], [1.0 + gap, 1.5 + gap, 2.0 + gap], kind, first=101),
             *material("LOW", (YOUNG, 0.0), expansion, 2.0),
             *material("UP", (YOUNG, 0.0), expansion, 1.0),
             "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=POWER", "100., 0., 1.",
             "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE, PAIRING=NODES", "UP.BOTTOM, LOW.TOP",
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LOW, 0.", "UP, 0.", "*STEP",
             "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
             "LOW.BOTTOM, 2", "UP.TOP, 2", "LOW, 1", "UP, 1", "LOW.BOTTOM, 11, 11, 0.",
             f"UP.TOP, 11, 11, {hot}", "*END STEP"]
    judge(tmp_path, without_unused_surfaces(cards), [
        ("heat_flux", where, "LAST", flux, 1e-6) for where in ("MIN", "MAX", "FACE@0")])
