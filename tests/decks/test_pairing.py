"""Node pairs and mortar points: which a deck has and why, what is said of them, what results hold."""

import sys

import h5py
import numpy as np
import pytest
from deck_runs import DECKS, run, solve

sys.path.append(str(DECKS.parents[1] / "python"))
from thercon.post.result import Result  # noqa: E402  its folder is made known first

MODEL = """*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*CONDUCTIVITY
2.
*SOLID SECTION, ELSET=UPPER, MATERIAL=M
*SOLID SECTION, ELSET=LOWER, MATERIAL=M
*SURFACE INTERACTION, NAME=I
*GAP LAW, TYPE=POWER
0.5, 0.3, 1.
*CONTACT PAIR, INTERACTION=I, NAME=F{pairing}
UP, LOW
*STEP
*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT
0.5, 1.
*BOUNDARY
TOP, 2, 2, -0.001
TOP, 1, 1, {slide}
BOTTOM, 1, 2, 0.
TOP, 11, 11, 100.
BOTTOM, 11, 11, 0.
*CONTACT PRINT, FREQUENCY=100
*END STEP
"""


def block(columns, left, width, low, name, first):
    """Return cards of a block of eight-node elements, one high, with its nodes at top and bottom."""
    x = left + width * np.arange(2 * columns + 1) / (2 * columns)
    number = {(i, j): first + j * 100 + i for j in range(3) for i in range(len(x)) if i % 2 * j != 1}
    cards = ["*NODE"]
    cards += [f"{n}, {float(x[i])!r}, {low + j / 2!r}" for (i, j), n in number.items()]
    cards.append(f"*ELEMENT, TYPE=CPE8, ELSET={name}")
    around = (0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)
    for e in range(columns):
        nodes = [number[2 * e + i, j] for i, j in around]
        cards.append(", ".join(map(str, (first + e, *nodes))))
    return cards, [[n for (_, k), n in number.items() if k == j] for j in (0, 2)]


def write(path, upper, lower, pairing="", slide=0.0):
    """Write a deck of a block (columns, left, width) on another one; return its path."""
    above, (_, top) = block(*upper, 0.0, "UPPER", 1)
    below, (bottom, _) = block(*lower, -1.0, "LOWER", 1001)
    cards = [*above, *below, "*NSET, NSET=TOP", *map(str, top), "*NSET, NSET=BOTTOM"]
    cards += [*map(str, bottom), "*SURFACE, NAME=UP", "UPPER, S1", "*SURFACE, NAME=LOW"]
    text = MODEL.format(pairing=pairing and f", PAIRING={pairing}", slide=slide)
    path.write_text("\n".join([*cards, "LOWER, S3"]) + "\n" + text)
    return path


@pytest.mark.parametrize(
    ("columns", "asked", "pairing", "said"),
    [
        (3, "", "NODES", "pairing ................... NODES, because the faces match"),
        (3, "NODES", "NODES", "pairing ................... NODES\n"),
        (3, "SURFACES", "SURFACES", "pairing ................... SURFACES\n"),
        (4, "", "SURFACES", "SURFACES, because the faces do not match: 7 slave nodes but 9 master"),
    ],
)
def test_listing_and_result_name_the_pairing_and_why(tmp_path, columns, asked, pairing, said):
    deck = write(tmp_path / "d.inp", (3, 0.0, 3.0), (columns, 0.0, 3.0), asked)
    with h5py.File(solve(deck)) as file:
        assert file["contact/F"].attrs["pairing"] == pairing
        assert len(file["contact/F/slave_node"]) == (7 if pairing == "NODES" else 4)
    assert said in deck.with_suffix(".lst").read_text()
    assert f"pairing of F .............. {pairing}" in run("check", deck).stdout


def test_faces_that_slide_far_are_why_faces_that_match_have_mortar_points(tmp_path):
    deck = write(tmp_path / "d.inp", (3, 0.0, 3.0), (3, 0.0, 3.0))
    deck.write_text(deck.read_text().replace("NAME=F", "NAME=F, SLIDING=FINITE"))
    said = "SURFACES, because SLIDING=FINITE moves the faces along each other\n"
    assert f"pairing of F .............. {said}" in run("check", deck).stdout


def test_a_node_beside_its_partner_is_why_faces_do_not_match(tmp_path):
    deck = write(tmp_path / "d.inp", (3, 0.1, 3.0), (3, 0.0, 3.0))
    solve(deck)
    words = " ".join(deck.with_suffix(".lst").read_text().split())
    assert ("because the faces do not match: slave node 1 and master node 1201 are offset by "
            "0.1, 20 % of the node spacing") in words


def test_fields_are_linear_along_the_slave_and_projected_to_the_master(tmp_path):
    deck = write(tmp_path / "d.inp", (4, -2.5, 8.0), (3, 0.0, 3.0))
    with h5py.File(solve(deck)) as file:
        contact, mesh = file["contact/F"], file["VTKHDF"]
        count = int(mesh["NumberOfPoints"][0])
        x, y = mesh["Points"][:count, :2].T
        on_faces = np.abs(y) < 1e-12
        slave = on_faces & (mesh["PointData/node_id"][:count] < 1000)
        # The corners -0.5, 1.5 and 3.5, the nodes between them, and all of the master.
        covered = np.where(slave, (x > -0.6) & (x < 3.6), on_faces)
        for name in ("pressure", "gap", "heat_flux", "conductance"):
            field = mesh[f"PointData/contact_{name}"][-count:]
            assert np.array_equal(~np.isnan(field), covered), name
            expected = np.interp(x[covered], contact["x"], contact[name][-1])
            np.testing.assert_allclose(field[covered], expected, rtol=1e-9, atol=1e-12)
        jump = contact["slave_temperature"][()] - contact["master_temperature"][()]
        flux = contact["conductance"][()] * jump
        np.testing.assert_allclose(flux, contact["heat_flux"][()], rtol=1e-9)
        # The integral of the temperature over the covered part, by Simpson's rule on each piece.
        t = dict(zip(np.round(x[on_faces & ~slave], 6),
                     mesh["PointData/temperature"][-count:][on_faces & ~slave], strict=True))
        integral = sum((t[k] + 4 * t[k + 0.5] + t[k + 1]) / 6 for k in (0.0, 1.0, 2.0))
        means = contact["weight"][()] @ contact["master_temperature"][-1]
        np.testing.assert_allclose(means, integral, rtol=1e-12)
    assert "2 of 5 slave corners have no master opposite" in deck.with_suffix(".lst").read_text()


@pytest.mark.parametrize(("pairing", "slide", "node"), [
    ("", 0.2, 7), ("", -0.2, 1), ("", 0.01, 0), ("SURFACES", 0.2, 7)])
def test_contact_that_slides_past_the_end_of_the_master_is_warned_of(tmp_path, pairing, slide, node):
    deck = write(tmp_path / "d.inp", (3, 0.0, 3.0), (4, 0.0, 3.0), pairing, slide)
    told = run("run", deck, "--out", tmp_path).stderr
    assert told.count("slides past the end of the master surface") == (node > 0)
    assert not node or f"slave node {node} slides past" in told


def test_contact_that_slides_along_a_longer_master_is_not_warned_of(tmp_path):
    deck = write(tmp_path / "d.inp", (3, 1.0, 1.0), (8, 0.0, 3.0), slide=0.2)
    assert "slides past" not in run("run", deck, "--out", tmp_path).stderr


def test_both_faces_are_found_for_pictures(tmp_path):
    deck = write(tmp_path / "d.inp", (4, -2.5, 8.0), (3, 0.0, 3.0))
    with Result(solve(deck)) as result:
        slave, master = result.faces(result.contact("F"))
        ends = [np.sort(result.cells.points[edges[:, :2], 0].ravel()) for edges in (slave, master)]
    np.testing.assert_allclose(ends[0], [-0.5, 1.5, 1.5, 3.5])
    np.testing.assert_allclose(ends[1], [0.0, 1.0, 1.0, 2.0, 2.0, 3.0])


def bridge(path, *pairs):
    """Write a bridge on two feet, on a base."""
    upper = [f"{10 + 4 * j + i + 1}, {float(i)}, {1.0 + j}" for j in range(3) for i in range(4)]
    return path, "\n".join([
        "*NODE, NSET=BASE", *(f"{4 * j + i + 1}, {float(i)}, {float(j)}" for j in (0, 1) for i in range(4)),
        "*NODE, NSET=BRIDGE", *upper, "*ELEMENT, TYPE=CPE4, ELSET=BASE", "1, 1, 2, 6, 5", "2, 2, 3, 7, 6",
        "3, 3, 4, 8, 7", "*ELEMENT, TYPE=CPE4, ELSET=BRIDGE", "4, 11, 12, 16, 15", "5, 13, 14, 18, 17",
        "6, 15, 16, 20, 19", "7, 16, 17, 21, 20", "8, 17, 18, 22, 21", "*MATERIAL, NAME=M", "*ELASTIC",
        "2.1E5, 0.3", "*SOLID SECTION, ELSET=BASE, MATERIAL=M", "*SOLID SECTION, ELSET=BRIDGE, MATERIAL=M",
        "*SURFACE, NAME=FEET", "4, S1", "5, S1", "*SURFACE, NAME=LEFT", "4, S1", "*SURFACE, NAME=RIGHT",
        "5, S1", "*SURFACE, NAME=TOP", "BASE, S3", "*SURFACE INTERACTION, NAME=I", *pairs, "*STEP",
        "*STATIC", "*BOUNDARY", "1, 1, 2", "2, 2", "3, 2", "4, 2", "19, 1", "19, 2, 2, -0.001",
        "20, 2, 2, -0.001", "21, 2, 2, -0.001", "22, 2, 2, -0.001", "*END STEP", ""])


def test_each_data_card_of_a_contact_pair_is_a_pair(tmp_path):
    """Alike on both feet, as from a card each; with a NAME= the slave surface is added to it. A pair
    of a surface with both feet has the sum."""
    found = []
    for name, pairs in (("one", ["*CONTACT PAIR, INTERACTION=I", "LEFT, TOP", "RIGHT, TOP"]),
                        ("two", ["*CONTACT PAIR, INTERACTION=I", "LEFT, TOP",
                                 "*CONTACT PAIR, INTERACTION=I", "RIGHT, TOP"]),
                        ("named", ["*CONTACT PAIR, INTERACTION=I, NAME=F", "LEFT, TOP", "RIGHT, TOP"])):
        deck, text = bridge(tmp_path / f"{name}.inp", *pairs)
        deck.write_text(text)
        with h5py.File(solve(deck)) as file:
            assert list(file["contact"]) == (["F-LEFT", "F-RIGHT"] if name == "named" else ["LEFT", "RIGHT"])
            found.append([pair["normal_force"][-1] for pair in file["contact"].values()])
    assert found[0] == found[1] == found[2]
    deck, text = bridge(tmp_path / "whole.inp", "*CONTACT PAIR, INTERACTION=I", "FEET, TOP")
    deck.write_text(text)
    with h5py.File(solve(deck)) as file:
        assert file["contact/FEET/normal_force"][-1] == pytest.approx(sum(found[0]), rel=1e-12)
    assert found[0][0] == pytest.approx(found[0][1], rel=0.2) and found[0][0] > 0.0
