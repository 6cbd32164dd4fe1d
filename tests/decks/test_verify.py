"""Every quantity and every place that *VERIFY may name: the right value passes, a wrong one fails.

Two blocks of width 2 and height 1, one on the other, in plane strain with uniform stress: p on the
face, friction mu p while the upper one (the slave) slides to the right, and S11 along it. With no
expansion the heat is q = T/(2 h/k + 1/omega), omega = C0 + C1 p.
"""

import json
import re
from math import sqrt

import h5py
import physics
import pytest
from blocks import block, solid, write
from deck_runs import CYLINDER, copy_deck, run, solve
from physics import material, mesh

WIDTH, YOUNG, POISSON, CONDUCTIVITY = 2.0, 1000.0, 0.25, 5.0
PRESSURE, FRICTION, ALONG, SLIP, HOT = 3.0, 0.5, 2.0, 0.01, 100.0
SHEAR = FRICTION * PRESSURE
MODULUS = (1 - POISSON**2) / YOUNG
STRAIN_X = MODULUS * (ALONG + POISSON / (1 - POISSON) * PRESSURE)
STRAIN_Y = MODULUS * (-PRESSURE - POISSON / (1 - POISSON) * ALONG)
TURN = SHEAR * 2 * (1 + POISSON) / YOUNG
S33 = POISSON * (ALONG - PRESSURE)
MISES = sqrt(((ALONG + PRESSURE) ** 2 + (PRESSURE + S33) ** 2 + (S33 - ALONG) ** 2) / 2
             + 3 * SHEAR**2)
OMEGA = 0.8 + 0.2 * PRESSURE
FLUX = HOT / (2 / CONDUCTIVITY + 1 / OMEGA)
SLAVE_T, MASTER_T = HOT - FLUX / CONDUCTIVITY, FLUX / CONDUCTIVITY


def nodes_of(cards):
    """Return {number: (x, y)} of the cards of a block."""
    lines = cards[1 : next(k for k, card in enumerate(cards) if card.startswith("*ELEMENT"))]
    fields = [line.split(",") for line in lines]
    return {int(n): (float(x), float(y)) for n, x, y in fields}


def at(nodes, x, y):
    """Return the number of the node at a place."""
    return next(n for n, place in nodes.items() if place == (x, y))


LOWER = block("LOWER", [0.0, 1.0, 2.0], [-1.0, 0.0], 1)
UPPER = block("UPPER", [0.0, 1.0, 2.0], [0.0, 1.0], 101)
LOW, HIGH = nodes_of(LOWER), nodes_of(UPPER)


def displacement(x, y, upper):
    """Return the displacement of a point of the lower or the upper block."""
    return STRAIN_X * x + TURN * (y + 1) + upper * SLIP, STRAIN_Y * (y + 1)


def model():
    """Return the cards of the two blocks with all loads and supports."""
    held, forces = [], []
    for nodes, upper in ((LOW, False), (HIGH, True)):
        outer = 1.0 if upper else -1.0
        for n, (x, y) in nodes.items():
            if y == outer:
                held += [f"{n}, {k + 1}, {k + 1}, {u!r}"
                         for k, u in enumerate(displacement(x, y, upper))]
            if x in (0.0, WIDTH):
                share = (1 if x else -1) * (4 if y in (-0.5, 0.5) else 1) / 6
                forces += [f"{n}, 1, {share * ALONG!r}", f"{n}, 2, {share * SHEAR!r}"]
    return [
        "*OPTIONS, LOAD=UPPER.TOP, 2",
        *LOWER, *UPPER,
        *solid("LOWER", YOUNG, POISSON, 0.0, CONDUCTIVITY),
        *solid("UPPER", YOUNG, POISSON, 0.0, CONDUCTIVITY),
        "*SURFACE INTERACTION, NAME=FACES", "*FRICTION", f"{FRICTION}, 1.E6",
        "*GAP LAW, TYPE=POWER", "0.8, 0.2, 1.",
        "*CONTACT PAIR, INTERACTION=FACES, NAME=Face", "UPPER.BOTTOM, LOWER.TOP",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LOWER, 0.", "UPPER, 0.",
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.",
        "*BOUNDARY", *held, f"UPPER.TOP, 11, 11, {HOT}", "LOWER.BOTTOM, 11, 11, 0.",
        "*CLOAD", *forces, "*END STEP",
    ]  # fmt: skip


# quantity, where, when, value, tolerance (a number: absolute; None: relative)
MIDDLE = at(HIGH, 1.5, 1.0)
U_MIDDLE = displacement(1.5, 1.0, True)
FOOT = at(LOW, 0.5, -1.0)
SLAVES = [n for n, (_, y) in HIGH.items() if y == 0.0]
MASTERS = [n for n, (_, y) in LOW.items() if y == 0.0]
CHECKS = [
    ("time", "", "LAST", 1.0, None),
    ("load", "", "LAST", 2 * STRAIN_Y, None),
    ("load", "", "0.5", STRAIN_Y, None),
    ("iterations", "", "LAST", 25.5, 25.0),
    ("heat_in", "", "LAST", WIDTH * FLUX, None),
    ("heat_out", "", "LAST", WIDTH * FLUX, None),
    ("heat_imbalance", "", "LAST", 0.0, 1e-10),
    ("force_imbalance", "", "LAST", 0.0, 1e-10),
    ("normal_force", "", "LAST", WIDTH * PRESSURE, None),
    ("normal_force", "FACE", "0.5", WIDTH * PRESSURE / 2, None),
    ("normal_force", "MAX", "LAST", WIDTH * PRESSURE, None),
    ("shear_force", "Face", "LAST", -WIDTH * SHEAR, None),
    ("heat_rate", "Face", "LAST", WIDTH * FLUX, None),
    ("edge_contact", "Face", "LAST", WIDTH, None),
    ("gap", "Face", "LAST", 0.0, 1e-12),
    ("pressure", "FACE", "LAST", PRESSURE, None),
    ("pressure", "face", "0.5", PRESSURE / 2, None),
    ("pressure", "Face@0.3", "LAST", PRESSURE, None),
    ("shear", "Face", "LAST", -SHEAR, None),
    ("slip", "Face", "LAST", SLIP, None),
    ("slip", "Face", "0.5", SLIP / 2, None),
    ("status", "Face", "LAST", 1.0, None),
    ("conductance", "Face", "LAST", OMEGA, None),
    ("heat_flux", "MIN", "LAST", FLUX, None),
    ("slave_temperature", "Face", "LAST", SLAVE_T, None),
    ("master_temperature", "face @ 2.", "LAST", MASTER_T, None),
    ("x", "Face@0.7", "LAST", 0.7, None),
    ("x", "MAX", "LAST", WIDTH, None),
    ("y", "Face", "LAST", 0.0, 1e-12),
    ("s", "Face@1.3", "LAST", 1.3, None),
    ("weight", "Face@1.", "LAST", 2 / 6, None),
    ("weight", "MIN", "LAST", 1 / 6, None),
    ("slave_node", "Face@2.", "LAST", at(HIGH, 2.0, 0.0), None),
    ("slave_node", "MAX", "LAST", max(SLAVES), None),
    ("master_node", "Face@0.5", "LAST", at(LOW, 0.5, 0.0), None),
    ("master_node", "MIN", "LAST", min(MASTERS), None),
    ("U1", MIDDLE, "LAST", U_MIDDLE[0], None),
    ("U1", "MAX", "LAST", displacement(2.0, 1.0, True)[0], None),
    ("u2", MIDDLE, "0.5", U_MIDDLE[1] / 2, None),
    ("U2", "UPPER.TOP", "LAST", 2 * STRAIN_Y, None),
    ("U2", "MIN", "LAST", 2 * STRAIN_Y, None),
    ("NT", "UPPER.TOP", "LAST", HOT, None),
    ("NT", "UPPER.BOTTOM", "LAST", SLAVE_T, None),
    ("NT", "MIN", "LAST", 0.0, 1e-9),
    ("S11", "UPPER", "LAST", ALONG, None),
    ("S22", "LOWER", "LAST", -PRESSURE, None),
    ("S33", "UPPER", "LAST", S33, None),
    ("S12", "LOWER", "LAST", SHEAR, None),
    ("MISES", "MAX", "LAST", MISES, None),
    ("HFL1", "UPPER", "LAST", 0.0, 1e-8),
    ("HFL2", "UPPER", "LAST", -FLUX, None),
    ("RF1", FOOT, "LAST", -SHEAR * 4 / 6, None),
    ("RF2", FOOT, "LAST", PRESSURE * 4 / 6, None),
    ("RFL", FOOT, "LAST", -FLUX * 4 / 6, None),
    ("RFL", MIDDLE, "LAST", FLUX * 4 / 6, None),
]  # fmt: skip


def notched():
    """Return two blocks that touch up to x = 1 and part beyond: the edges lie in [1, 1.25]."""
    upper = block("UPPER", [0.0, 0.5, 1.0, 1.5, 2.0], [0.0, 1.0], 101)
    moved = {n: 0.3 * (x - 1) for n, (x, y) in nodes_of(upper).items() if y == 0.0 and x > 1.0}
    upper = [f"{card.rsplit(',', 1)[0]}, {moved[int(card.split(',')[0])]!r}"
             if 0 < k <= len(nodes_of(upper)) and int(card.split(",")[0]) in moved else card
             for k, card in enumerate(upper)]  # fmt: skip
    return [
        *block("LOWER", [0.0, 0.5, 1.0, 1.5, 2.0], [-1.0, 0.0], 1), *upper,
        *solid("LOWER", YOUNG, POISSON), *solid("UPPER", YOUNG, POISSON),
        "*SURFACE INTERACTION, NAME=FACES", "*FRICTION", "10., 1.E6",
        "*CONTACT PAIR, INTERACTION=FACES, NAME=Face", "UPPER.BOTTOM, LOWER.TOP",
        "*STEP", "*STATIC", "0.5, 1.", "*BOUNDARY", "LOWER.BOTTOM, 1, 2, 0.",
        "UPPER.TOP, 1, 1, 0.", "UPPER.TOP, 2, 2, -0.01", "*END STEP",
    ]  # fmt: skip


EDGES = [
    (f"{name}", where, "LAST", 1.125, 0.125)
    for name in ("edge_contact", "edge_stick", "edges_contact", "edges_stick")
    for where in ("", "face", "MIN", "MAX")
]


def card(quantity, where, when, value, tolerance):
    """Return the data card of a check."""
    kind = "1.E-6, REL" if tolerance is None else f"{tolerance!r}, ABS"
    return f"{quantity}, {where}, {when}, {value!r}, {kind}"


def wrong(quantity, where, when, value, tolerance):
    """Return the data card of a check whose value is a little off."""
    off = value * (1 + 1e-5) if tolerance is None else value + 3 * tolerance
    return card(quantity, where, when, off, tolerance)


def verify(path, cards, checks):
    """Write a deck with these checks; return its path."""
    return write(path, cards, ['*VERIFY, KIND=ANALYTIC, SOURCE="uniform stress"', *checks])


def verdicts(result):
    """Return how many checks passed and how many failed."""
    with h5py.File(result) as file:
        return tuple(int(file["run"].attrs[f"verify_{name}"]) for name in ("passed", "failed"))


@pytest.mark.parametrize(("cards", "checks"), [(model, CHECKS), (notched, EDGES)])
def test_right_values_pass(cards, checks, tmp_path):
    result = solve(verify(tmp_path / "right.inp", cards(), [card(*each) for each in checks]))
    assert verdicts(result) == (len(checks), 0)


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: f"{check[0]} {check[1]}")
def test_a_wrong_value_is_status_4(check, tmp_path):
    result = solve(verify(tmp_path / "wrong.inp", model(), [wrong(*check)]), status=4)
    assert verdicts(result) == (0, 1)


@pytest.mark.parametrize("check", EDGES, ids=lambda check: f"{check[0]} {check[1]}")
def test_a_wrong_edge_is_status_4(check, tmp_path):
    result = solve(verify(tmp_path / "wrong.inp", notched(), [wrong(*check)]), status=4)
    assert verdicts(result) == (0, 1)


def test_a_set_is_judged_at_its_worst_node(tmp_path):
    # Within its tolerance at the lower nodes of the block, not at the upper ones.
    check = f"NT, UPPER, LAST, {SLAVE_T!r}, 1., ABS"
    process = run("run", "--quiet", verify(tmp_path / "set.inp", model(), [check]), "--out",
                  tmp_path)  # fmt: skip
    assert process.returncode == 4
    worst = min(number for number, (_, y) in HIGH.items() if y == 1.0)
    assert (f": check failed: NT UPPER, node {worst} at time 1: 100 (no estimate: needs ERRORS=FULL), "
            "expected") in process.stderr
    assert f"ERRORS=FULL), node {worst}\n" in (tmp_path / "set.lst").read_text()


def test_the_node_that_reaches_a_value_at_another_time_is_named(tmp_path):
    """The upper nodes of the block are at HOT at the end and at half of it in the middle of the step; the
    document names one of them."""
    deck = verify(tmp_path / "reached.inp", model(), [f"NT reaches {HOT / 4}, UPPER.TOP, LAST, 0.5, 1.E-3",
                                                      f"NT, {MIDDLE}, LAST, 0., 1E9, ABS"])
    document = json.loads(run("run", "--json", deck, "--out", tmp_path).stdout)
    top = [number for number, (_, y) in HIGH.items() if y == 1.0]
    assert document["checks"][0]["node"] in top and "node" not in document["checks"][1]


def test_a_check_without_a_value_fails_with_the_reason(tmp_path):
    # Where all pairs slip there is no edge of stick.
    deck = verify(tmp_path / "none.inp", model(), ["edge_stick, Face, LAST, 1., 1.E9, ABS"])
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 4
    assert "there is no value" in process.stderr


def test_times_are_landed_on(tmp_path):
    # The increments are 0.5 long.
    check = f"pressure, Face, 0.3, {0.3 * PRESSURE!r}, 1.E-6"
    assert verdicts(solve(verify(tmp_path / "time.inp", model(), [check]))) == (1, 0)


@pytest.mark.parametrize(("quantity", "where", "name", "errors"), [
    ("normal_force", "FACE", "normal_force", "LAST"), ("heat_rate", "", "heat_rate", "LAST"),
    ("edge_contact", "face", "edge_contact", "FULL"), ("pressure", "MAX", "peak_pressure", "FULL")])
def test_values_are_told_with_their_uncertainties(tmp_path, quantity, where, name, errors):
    """At the end of a step, passed or failed, and in the middle of it with ERRORS=FULL."""
    checks = [f"{quantity}, {where}, {when}, {value}" for when, value in (
        ("LAST", "1., 1.E-3"), ("LAST", "1., 1.E9"), ("180.", "1., 1.E-3"))]
    (tmp_path / "plain.txt").write_text(CYLINDER.read_text().split("*VERIFY")[0])
    deck = copy_deck(tmp_path / "plain.txt", tmp_path / "told.inp", [
        f"*OPTIONS, ERRORS={errors}", "*VERIFY, KIND=FIGURE", *checks])
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 4
    with h5py.File(tmp_path / "told.vtkhdf") as file:
        rows = dict(zip(file["uncertainty/time"][:], file[f"uncertainty/FACE/{name}"][:], strict=True))
    failed = dict(zip((900.0, 180.0), sorted(line for line in process.stderr.splitlines()
                                             if "check failed" in line), strict=True))
    for time in (900.0, 180.0)[:1 if errors == "LAST" else 2]:
        value, uncertainty = rows[time][:2]
        found, said = re.search(r": (\S+) \+- (\S+), expected", failed[time]).groups()
        assert float(found) == pytest.approx(value, rel=1e-5)
        assert float(said) == pytest.approx(uncertainty, rel=0.06)
        assert (tmp_path / "told.lst").read_text().count(f"found:  {found} +- {said}\n") == 1 + (time > 180.0)
    if errors == "LAST":
        assert "(no estimate: needs ERRORS=FULL), expected" in failed[180.0]


def test_the_uncertainty_of_a_check_holds_the_error_of_the_increments(tmp_path):
    """Blocks slide faster and faster, as t^2: over the last increment, whose slip heats them, at the
    mean rate 2 - h, at its end at 2. Elements are exact but for the moment of little friction."""
    bodies = [*mesh("UP", [0.0, 1.0, 2.0], [0.0, 1.0], "CPE4"),
              *mesh("LOW", [0.0, 1.0, 2.0], [-1.0, 0.0], "CPE4", first=101)]
    size = 0.25
    deck = write(tmp_path / "deck.inp", bodies, *(
        [*material(name, (1e9, 0.0), 0.0, CONDUCTIVITY), "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
         f"{name}, 0."] for name in ("UP", "LOW")), [
        "*OPTIONS, ERRORS=FULL", "*AMPLITUDE, NAME=SLIDE",
        *(f"{k / 64}, {(k / 64)**2}" for k in range(65)),
        "*SURFACE INTERACTION, NAME=I", "*FRICTION", "1.E-3", "*GAP LAW, TYPE=POWER",
        "3., 0., 1.", "*GAP HEAT GENERATION", "1., 0.7",
        "*CONTACT PAIR, INTERACTION=I, NAME=FACE", "UP.BOTTOM, LOW.TOP",
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", f"{size}, 1.",
        "*BOUNDARY", "LOW, 1, 2", "UP.TOP, 11", "LOW.BOTTOM, 11", "*BOUNDARY, AMPLITUDE=SLIDE",
        "UP.TOP, 1, 1, 0.05", "*DSLOAD", "UP.TOP, P, 100.", "*END STEP",
        "*VERIFY, KIND=FIGURE", "NT, 1, LAST, 0., 1e-9, ABS"])
    process = run("run", "--quiet", deck, "--out", tmp_path)
    found, said = (float(word) for word in re.search(
        r": (\S+) \+- (\S+), expected", process.stderr).groups())
    true = found * (2.0 / (2.0 - size) - 1.0)
    assert 0.1 * found < true <= said <= 4.1 * true


def test_the_uncertainty_of_a_check_is_that_of_its_own_body(tmp_path):
    """A bent plate has the uncertainty that it has alone, beside one on which nothing acts."""
    said = {}
    for name, first in (("alone", 1), ("beside", 1001)):
        cards = mesh("BENT", [2.0 * column for column in range(9)], [0.0, 1.0], "CPS4", first=first)
        held = ["BENT.LEFT, 1, 2"]
        if name == "beside":
            cards = [*mesh("IDLE", [0.0, 1.0, 2.0], [9.0, 10.0], "CPS4"), *cards,
                     *material("IDLE", (YOUNG, POISSON))]
            held += ["IDLE.LEFT, 1, 2"]
        node = next(n for n, place in physics.nodes_of(cards).items() if place == (16.0, 1.0))
        deck = write(tmp_path / f"{name}.inp", cards, material("BENT", (YOUNG, POISSON)), [
            "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", *held, "*DSLOAD", "BENT.TOP, P, 1e-3",
            "*END STEP", "*VERIFY, KIND=FIGURE", f"MISES, {node}, LAST, 0., 1e-9, ABS"])
        run("run", "--quiet", deck, "--out", tmp_path)
        said[name] = re.search(r"found: +(\S+ \+- \S+)", deck.with_suffix(".lst").read_text())[1]
    assert said["beside"] == said["alone"]


def test_the_document_lists_all_kinds(tmp_path):
    told = run("check", write(tmp_path / "deck.inp", ["*VERIFY, KIND=OTHER", "NT, 1, LAST"])).stderr
    known = re.search(r"unknown KIND=OTHER of \*VERIFY; known: (.*)", told)[1].split(", ")
    text = (CYLINDER.parents[2] / "docs/deck/output.md").read_text()
    listed = re.search(r"origin of the expected value:([^;]*);", text)[1]
    assert re.split(r",\s+|\s+or\s+", listed.strip()) == known
