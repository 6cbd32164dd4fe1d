"""The largest stress and temperature of a body: their uncertainties, and singular corners that are named."""

import re

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import run
from deck_runs import solve_as_written as solve
from pellets import rod
from physics import material, mesh, nodes_of

STATIC = ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY"]


def block(name="BODY", kind="CPE8", n=4, first=1, x=0.0, y=0.0):
    """Return the cards of a unit square of n x n elements."""
    return mesh(name, x + np.linspace(0, 1, n + 1), y + np.linspace(0, 1, n + 1), kind, first)


def summary(folder, *cards):
    """Run a deck; return its summary and its listing."""
    deck = write(folder / "deck.inp", list(cards))
    solve(deck)
    text = " ".join(deck.with_suffix(".lst").read_text().split())
    return text[:text.index("PHYSICS")], text


def corner(place):
    """Return the words that name one corner."""
    x, y = place
    return rf"no estimate: node \d+ \({x:g}, {y:g}\)"


def test_a_clamped_side_ends_at_singular_corners(tmp_path):
    head, rest = summary(tmp_path, *block(), *material("BODY"), *STATIC, "BODY.BOTTOM, 1, 2",
                         "*DSLOAD", "BODY.TOP, P, -1.", "*END STEP")
    for text in head, rest:
        assert re.search(corner((0, 0)) + r", node \d+ \(1, 0\)", text)
    assert re.search(r"von Mises stress +\S+ \+- \S+ \(\S+ %\), node \d+ \(", head)


def test_held_in_one_direction_a_side_has_none(tmp_path):
    head, _ = summary(tmp_path, *block(), *material("BODY"), *STATIC, "BODY.BOTTOM, 2",
                      "BODY.LEFT, 1", "*DSLOAD", "BODY.TOP, P, -1.", "*END STEP")
    assert "singular" not in head and "von Mises stress" in head


def test_a_force_on_one_node_is_singular(tmp_path):
    cards = block()
    (node,) = [n for n, p in nodes_of(cards).items() if p == (0.5, 1.0)]
    head, _ = summary(tmp_path, *cards, *material("BODY"), *STATIC, "BODY.BOTTOM, 2",
                      "BODY.LEFT, 1", "*CLOAD", f"{node}, 2, -1.", "*END STEP")
    assert re.search(corner((0.5, 1)), head)


def test_a_node_that_an_equation_pulls_alone_is_singular(tmp_path):
    """A node of no element moves it; a whole side that equations pull is none."""
    cards = block()
    top = sorted(n for n, p in nodes_of(cards).items() if p[1] == 1.0)
    (middle,) = [n for n, p in nodes_of(cards).items() if p == (0.5, 1.0)]
    for name, pulled in (("one", [middle]), ("all", top)):
        folder = tmp_path / name
        folder.mkdir()
        pulls = [card for n in pulled for card in ("*EQUATION", "2", f"{n}, 2, 1., 900, 2, -1.")]
        head, _ = summary(folder, *cards, "*NODE", "900, 2., 2.", *material("BODY"), *pulls, *STATIC,
                          "BODY.BOTTOM, 2", "BODY.LEFT, 1", "900, 1", "900, 2, 2, -0.01", "*END STEP")
        assert bool(re.search(corner((0.5, 1)), head)) == (name == "one")


def test_a_reentrant_corner_is_singular(tmp_path):
    # An L whose inner corner is (1, 1).
    cards, number, elements = ["*NODE, NSET=ALL"], {}, []
    for j in range(9):
        for i in range(9):
            if i <= 4 or j <= 4:
                number[i, j] = len(number) + 1
                cards.append(f"{number[i, j]}, {i / 4}, {j / 4}")
    for j in range(8):
        for i in range(8):
            if i < 4 or j < 4:
                elements.append([number[i, j], number[i + 1, j], number[i + 1, j + 1],
                                 number[i, j + 1]])
    cards += ["*ELEMENT, TYPE=CPE4, ELSET=BODY"]
    cards += [", ".join(map(str, [k, *e])) for k, e in enumerate(elements, 1)]
    top = [f"{elements.index(e) + 1}, S3" for e in elements if e[2] in
           [number[i, 8] for i in range(1, 5)] and e[3] in [number[i, 8] for i in range(4)]]
    cards += ["*SURFACE, NAME=TOP", *top, "*NSET, NSET=BOTTOM",
              *[str(number[i, 0]) for i in range(9)], "*NSET, NSET=LEFT",
              *[str(number[0, j]) for j in range(9)]]
    head, _ = summary(tmp_path, *cards, *material("BODY"), *STATIC, "BOTTOM, 2", "LEFT, 1",
                      "*DSLOAD", "TOP, P, -1.", "*END STEP")
    assert re.search(corner((1, 1)), head)


@pytest.mark.parametrize(("where", "is_known"), [("MAX", True), ("1", True), ("BODY.LEFT", False)])
def test_checks_of_largest_values_and_of_nodes_have_uncertainties(tmp_path, where, is_known):
    _, text = summary(tmp_path, *block(), *material("BODY", None, conductivity=1.0),
                      "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.", "*STEP",
                      "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY",
                      "BODY.RIGHT, 11, 11, 0.", "BODY.TOP, 11, 11, 0.", "*DFLUX", "BODY, BF, 1.",
                      "*END STEP", '*VERIFY, KIND=ANALYTIC, SOURCE="a quarter of a square"',
                      f"NT, {where}, LAST, 0.2947, 1.")
    # 0.294685 in the middle of a square of side 2 (S. P. Timoshenko, J. N. Goodier, section 109).
    found = re.search(r"found: (\S+) \+- (\S+)", text)
    assert bool(found) == is_known
    assert not is_known or abs(float(found[1]) - 0.294685) < float(found[2]) < 0.01


def test_without_uncertainties_a_reason_is_told(tmp_path):
    deck = write(tmp_path / "deck.inp", ["*OPTIONS, ERRORS=NO", *block(), *material("BODY"), *STATIC,
                                         "BODY.BOTTOM, 1, 2", "*DSLOAD", "BODY.TOP, P, -1.",
                                         "*END STEP"])
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 0
    assert re.search(r"^ +von Mises stress +\S+ \(no estimate: ERRORS=NO\)", process.stdout, re.M)
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        assert set(file["uncertainty"]) == {"reasons", "time"}


def test_many_interfaces_have_the_largest_values_at_each_step(tmp_path):
    """Each is of its own interface; a node that no element uses does not make the lowest temperature."""
    cards = rod(6, counts=(2, 2, 1))
    second = cards[cards.index("*STEP"):]
    deck = write(tmp_path / "deck.inp", ["*NODE", "999999, 0., 0."], cards, second)
    lines = run("run", deck, "--out", tmp_path).stdout.splitlines()
    at = next(k for k, line in enumerate(lines) if "at the end of each step" in line)
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        faces = list(file["contact"].values())
        rows = [int(np.argmin(np.abs(file["history/time"][()] - end))) for end in (1.0, 2.0)]
        largest = [[max(abs(face["normal_force"][row]) for face in faces),
                    max(abs(face["heat_rate"][row]) for face in faces),
                    max(face["pressure"][row].max() for face in faces)] for row in rows]
        closed = [sum(bool(np.all(face["status"][row])) for face in faces) for row in rows]
        temperature = file["VTKHDF/PointData/temperature"][()]
        count_of_points = file["VTKHDF/NumberOfPoints"][0]
    for step, line, expected, count in zip("12", lines[at + 2:at + 4], largest, closed, strict=True):
        words = line.split()
        assert words[0] == step and words[5:7] == [f"{count}", "closed,"]
        assert [abs(float(word)) for word in words[2:5]] == pytest.approx(expected, rel=1e-5)
    assert np.isnan(temperature).any()
    lowest = float(next(line for line in lines if "lowest temperature" in line).split()[2])
    assert lowest > 1.0 and lowest == pytest.approx(np.nanmin(temperature[-count_of_points:]), rel=1e-5)
