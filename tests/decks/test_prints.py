"""*NODE PRINT and *EL PRINT: tables of the listing with values known in closed form."""

import re

import numpy as np
import pytest
from blocks import write
from changes import note_changes
from deck_runs import run
from physics import material, mesh, nodes_of

PLACE = {"NODES": 1, "INTEGRATION POINTS": 2, "TOTALS": 0}   # numbers that name a row
YOUNG, POISSON, CONDUCTIVITY = 1000.0, 0.25, 4.0
BLOCK = mesh("BLOCK", [0.0, 0.5, 1.25], [0.0, 1.0])   # 1.25 wide, 1 high
BODY = [*BLOCK, *material("BLOCK", (YOUNG, POISSON), conductivity=CONDUCTIVITY)]
HELD = ["*BOUNDARY", "BLOCK.BOTTOM, 2", "1, 1"]
ROUNDING = 1e-6   # of the seven digits that are printed


def tables(folder, *cards):
    """Solve a deck; return its tables in their order: (increment, kind, set, columns, rows)."""
    deck = write(folder / "deck.inp", ["*OPTIONS, WIDTH=200"], *cards)
    process = run("run", "--quiet", deck, "--out", folder)
    assert process.returncode == 0, process.stderr
    found, increment, head = [], 0, False
    for line in deck.with_suffix(".lst").read_text().split("INCREMENTS\n", 1)[1].splitlines():
        title = re.fullmatch(r"   (NODES|TOTALS|INTEGRATION POINTS) OF (\S+)", line)
        if line.startswith("INCREMENT "):
            increment, head = int(line.split()[1]), False
        elif title:
            found.append((increment, *title.groups(), None, []))
            head = True
        elif head and not line.strip():
            head = False
        elif head and found[-1][3] is None:
            assert len(line) <= 132
            found[-1] = (*found[-1][:3], line.split(), found[-1][4])
        elif head:
            assert len(line) <= 132
            found[-1][4].append(line.split())
    return found


def columns(table):
    """Return the columns of numbers of a table by their names."""
    names = table[3]
    return {name: np.array([float(row[k]) for row in table[4]]) for k, name in enumerate(names)}


def static(*cards, times="1., 1."):
    return ["*STEP", "*STATIC", times, *cards, "*END STEP"]


def heated(*cards, times="1., 1."):
    return ["*STEP", "*HEAT TRANSFER, STEADY STATE", times, *cards, "*END STEP"]


@pytest.mark.parametrize("pressure", [10.0, 12.0])
def test_displacements_and_external_forces_of_a_pressed_block(tmp_path, pressure):
    """Plane strain: eps_yy = -p (1 - nu^2)/E, eps_xx = p nu (1 + nu)/E; the supports carry p."""
    found = tables(tmp_path, BODY, static(
        *HELD, "*DLOAD", f"BLOCK, P3, {pressure!r}", "*NODE PRINT, NSET=BLOCK, TOTALS=YES",
        "U, RF", "*NODE PRINT, NSET=BLOCK.BOTTOM, TOTALS=ONLY", "RF, U"))
    assert [t[1:3] for t in found] == [("NODES", "BLOCK"), ("TOTALS", "BLOCK"),
                                       ("NODES", "BLOCK.BOTTOM"), ("TOTALS", "BLOCK.BOTTOM")]
    table = columns(found[0])
    assert list(table) == ["node", "x", "y", "U1", "U2", "RF1", "RF2"]
    places = nodes_of(BLOCK)
    assert [tuple(p) for p in zip(table["x"], table["y"], strict=True)] == list(places.values())
    assert list(table["node"]) == list(places)
    down = -pressure * (1 - POISSON**2) / YOUNG
    aside = pressure * POISSON * (1 + POISSON) / YOUNG
    np.testing.assert_allclose(table["U1"], aside * table["x"], atol=ROUNDING * aside)
    np.testing.assert_allclose(table["U2"], down * table["y"], atol=ROUNDING * -down)
    # Loads count as the supports do: only nodes without either have no force.
    share = {0.0: 1 / 12, 0.25: 1 / 3, 0.5: 5 / 24, 0.875: 1 / 2, 1.25: 1 / 8}
    sign = {0.0: 1.0, 0.5: 0.0, 1.0: -1.0}
    expected = [pressure * sign[y] * share.get(x, 0.0) for x, y in zip(table["x"], table["y"],
                                                                       strict=True)]
    np.testing.assert_allclose(table["RF2"], expected, atol=ROUNDING * pressure)
    np.testing.assert_allclose(table["RF1"], 0.0, atol=1e-12 * pressure)
    assert found[1][3] == found[3][3] == ["RF1", "RF2"]
    np.testing.assert_allclose(list(map(float, found[1][4][0])), 0.0, atol=1e-12 * pressure)
    np.testing.assert_allclose(float(found[3][4][0][1]), 1.25 * pressure, rtol=ROUNDING)
    assert found[2][3] == ["node", "x", "y", "U1", "U2"]


@pytest.mark.parametrize("force", [3.0, 4.0])
def test_a_force_on_a_support_is_part_of_the_external_force(tmp_path, force):
    """CalculiX's RF: the support takes the force, so nothing is left; *VERIFY's RF2 is it alone."""
    found = tables(tmp_path, BODY, static(
        *HELD, "*CLOAD", f"2, 2, {force!r}", "*NODE PRINT, NSET=BLOCK.BOTTOM", "RF"),
        ["*VERIFY, KIND=ANALYTIC", f"RF2, 2, LAST, {-force!r}, 1.E-12"])
    np.testing.assert_allclose(columns(found[0])["RF2"], 0.0, atol=1e-12 * force)


@pytest.mark.parametrize("pressure", [10.0, 12.0])
def test_what_crosses_a_contact_is_not_external(tmp_path, pressure):
    """Two blocks pressed and heated: at their faces neither a force nor heat comes from outside."""
    lower = mesh("LOWER", [0.0, 0.5, 1.25], [-1.0, 0.0], first=101)
    found = tables(tmp_path, BODY, lower, material("LOWER", (YOUNG, 0.1), conductivity=2.0), [
        "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=POWER", "1.5, 0., 1.",
        "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "BLOCK.BOTTOM, LOWER.TOP",
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
        "LOWER.BOTTOM, 2", "101, 1", "1, 1", "BLOCK.TOP, 11, 11, 90.", "LOWER.BOTTOM, 11, 11, 20.",
        "*DLOAD", f"BLOCK, P3, {pressure!r}", "*NODE PRINT, NSET=LOWER.TOP", "RF, RFL",
        "*NODE PRINT, NSET=LOWER.BOTTOM, TOTALS=ONLY", "RF, RFL", "*END STEP",
        "*VERIFY, KIND=ANALYTIC", f"pressure, FACE, LAST, {pressure!r}, 1.E-9"])
    for name in ("RF1", "RF2", "RFL"):
        np.testing.assert_allclose(columns(found[0])[name], 0.0, atol=1e-10)
    flux = 70.0 / (1 / CONDUCTIVITY + 1 / 1.5 + 1 / 2.0)
    np.testing.assert_allclose([float(v) for v in found[1][4][0]],
                               [0.0, 1.25 * pressure, -1.25 * flux], rtol=ROUNDING, atol=1e-10)


@pytest.mark.parametrize("flux", [8.0, 6.0])
def test_temperatures_and_external_heat_of_a_wall(tmp_path, flux):
    """Flux in on the right, a film on the left: T falls from the right by q/k; sums are q A."""
    film, sink = 2.0, 20.0
    found = tables(tmp_path, BODY, heated(
        "*DFLUX", f"2, S2, {flux!r}", "*FILM", f"1, F4, {sink!r}, {film!r}",
        "*NODE PRINT, NSET=BLOCK", "RFL, TS", "*NODE PRINT, NSET=BLOCK.LEFT, TOTALS=ONLY", "RFL",
        "*NODE PRINT, NSET=BLOCK.RIGHT, TOTALS=YES", "RFL"))
    assert [t[1:3] for t in found] == [("NODES", "BLOCK"), ("TOTALS", "BLOCK.LEFT"),
                                       ("NODES", "BLOCK.RIGHT"), ("TOTALS", "BLOCK.RIGHT")]
    table = columns(found[0])
    assert list(table) == ["node", "x", "y", "RFL", "NT"]
    np.testing.assert_allclose(table["NT"], sink + flux / film + flux / CONDUCTIVITY * table["x"],
                               rtol=ROUNDING)
    share = {0.0: 1 / 6, 0.5: 2 / 3, 1.0: 1 / 6}
    sign = {0.0: -1.0, 1.25: 1.0}
    np.testing.assert_allclose(
        table["RFL"], [flux * sign.get(x, 0.0) * share[y] for x, y in
                       zip(table["x"], table["y"], strict=True)], atol=ROUNDING * flux)
    for k, rate in ((1, -flux), (3, flux)):
        np.testing.assert_allclose(float(found[k][4][0][0]), rate, rtol=ROUNDING)


@pytest.mark.parametrize("kind", ["CPE8", "CPE8R", "CPE4", "CPE4I", "CPE6", "CPE3"])
def test_stress_and_flux_stand_at_the_integration_points(tmp_path, kind):
    """Uniform states; the centroid of the points is that of each element."""
    points = {"CPE8": 9, "CPE8R": 4, "CPE4": 4, "CPE4I": 4, "CPE6": 3, "CPE3": 3}[kind]
    body = mesh("BODY", [0.0, 0.5, 1.5], [0.0, 1.0], kind)
    found = tables(tmp_path, body, material("BODY", (YOUNG, POISSON), conductivity=CONDUCTIVITY), [
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
        "BODY.BOTTOM, 2", "1, 1", "BODY.BOTTOM, 11, 11, 5.", "BODY.TOP, 11, 11, 12.",
        "BODY.TOP, 2, 2, 0.003", "*EL PRINT, ELSET=BODY", "S", "HFL", "*END STEP"])
    table = columns(found[0])
    assert list(table) == ["element", "point", "x", "y", "S11", "S22", "S33", "S12", "HFL1", "HFL2"]
    elements = 4 if kind in ("CPE6", "CPE3") else 2
    assert list(table["point"]) == list(range(1, points + 1)) * elements
    assert list(table["element"]) == [e for e in range(1, elements + 1) for _ in range(points)]
    np.testing.assert_allclose(table["S22"], 0.003 * YOUNG / (1 - POISSON**2), rtol=ROUNDING)
    np.testing.assert_allclose(table["S33"], POISSON * table["S22"], rtol=2 * ROUNDING)
    np.testing.assert_allclose(table["HFL2"], -CONDUCTIVITY * 7.0, rtol=ROUNDING)
    for name in ("S11", "S12", "HFL1"):
        np.testing.assert_allclose(table[name], 0.0, atol=1e-10)
    for part, centre in ((slice(0, points * elements // 2), 0.25),
                         (slice(points * elements // 2, None), 1.0)):
        np.testing.assert_allclose(table["x"][part].mean(), centre, rtol=1e-4)


def turned(angle, values="NO"):
    """Return a plate pulled along x, its material's axes turned, and *EL PRINT."""
    return [*BLOCK, "*ORIENTATION, NAME=TURNED", "1., 0., 0., 0., 1., 0.", f"3, {angle!r}",
            *material("BLOCK", (YOUNG, POISSON), conductivity=CONDUCTIVITY,
                      section=", ORIENTATION=TURNED"),
            "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
            "BLOCK.LEFT, 1", "1, 2", "BLOCK.LEFT, 11, 11, 0.", "*DFLUX", "2, S2, 8.",
            "*DLOAD", "2, P2, -6.", f"*EL PRINT, ELSET=BLOCK, GLOBAL={values}", "S, HFL",
            "*END STEP"]


@pytest.mark.parametrize("angle", [30.0, 75.0])
def test_without_global_values_are_along_the_axes_of_the_orientation(tmp_path, angle):
    """CalculiX's GLOBAL=NO, the default: sigma_11 = s cos^2, sigma_12 = -s sin cos."""
    c, s = np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))
    table, = tables(tmp_path, turned(angle))
    assert {row.pop() for row in table[4]} == {"TURNED"}
    found = columns(table)
    for name, value in (("S11", 6 * c * c), ("S22", 6 * s * s), ("S12", -6 * s * c),
                        ("S33", POISSON * 6), ("HFL1", -8 * c), ("HFL2", 8 * s)):
        np.testing.assert_allclose(found[name], value, rtol=ROUNDING, err_msg=name)


def test_with_global_values_are_along_x_and_y(tmp_path):
    table, = tables(tmp_path, turned(30.0, "YES"))
    found = columns(table)
    for name, value in (("S11", 6.0), ("S22", 0.0), ("S12", 0.0), ("HFL1", -8.0), ("HFL2", 0.0)):
        np.testing.assert_allclose(found[name], value, atol=6 * ROUNDING, err_msg=name)


# Cards of a block under pressure 6 along y, nu = 0.25, and what their tables show.
SELECTED = {
    "NODE PRINT": (("NSET=BLOCK.TOP", "U"), ("NSET=BLOCK.TOP", "NT")),
    "NODE PRINT, NSET": (("NSET=BLOCK.TOP", "U"), ("NSET=BLOCK.BOTTOM", "U")),
    "NODE PRINT, FREQUENCY": (("NSET=BLOCK.TOP, FREQUENCY=1", "U"),
                              ("NSET=BLOCK.TOP, FREQUENCY=2", "U")),
    "NODE PRINT, TOTALS": (("NSET=BLOCK.TOP, TOTALS=YES", "RF"),
                           ("NSET=BLOCK.TOP, TOTALS=ONLY", "RF")),
    "EL PRINT": (("ELSET=BLOCK", "S"), ("ELSET=BLOCK", "COORD")),
    "EL PRINT, ELSET": (("ELSET=BLOCK", "COORD"), ("ELSET=FIRST", "COORD")),
    "EL PRINT, FREQUENCY": (("ELSET=BLOCK, FREQUENCY=1", "S"), ("ELSET=BLOCK, FREQUENCY=2", "S")),
    "EL PRINT, GLOBAL": (("ELSET=BLOCK, GLOBAL=NO", "S"), ("ELSET=BLOCK, GLOBAL=YES", "S")),
}
SHAPES = {   # (increment, kind, rows, columns) of the tables of either card
    "NODE PRINT": ([(1, "NODES", 5, 5), (2, "NODES", 5, 5)],
                   [(1, "NODES", 5, 4), (2, "NODES", 5, 4)]),
    "NODE PRINT, NSET": ([(1, "NODES", 5, 5), (2, "NODES", 5, 5)],) * 2,
    "NODE PRINT, FREQUENCY": ([(1, "NODES", 5, 5), (2, "NODES", 5, 5)], [(2, "NODES", 5, 5)]),
    "NODE PRINT, TOTALS": (
        [(1, "NODES", 5, 5), (1, "TOTALS", 1, 2), (2, "NODES", 5, 5), (2, "TOTALS", 1, 2)],
        [(1, "TOTALS", 1, 2), (2, "TOTALS", 1, 2)]),
    "EL PRINT": ([(1, "INTEGRATION POINTS", 18, 9), (2, "INTEGRATION POINTS", 18, 9)],
                 [(1, "INTEGRATION POINTS", 18, 5), (2, "INTEGRATION POINTS", 18, 5)]),
    "EL PRINT, ELSET": ([(1, "INTEGRATION POINTS", 18, 5), (2, "INTEGRATION POINTS", 18, 5)],
                        [(1, "INTEGRATION POINTS", 9, 5), (2, "INTEGRATION POINTS", 9, 5)]),
    "EL PRINT, FREQUENCY": ([(1, "INTEGRATION POINTS", 18, 9), (2, "INTEGRATION POINTS", 18, 9)],
                            [(2, "INTEGRATION POINTS", 18, 9)]),
    "EL PRINT, GLOBAL": ([(1, "INTEGRATION POINTS", 18, 9), (2, "INTEGRATION POINTS", 18, 9)],
                         [(1, "INTEGRATION POINTS", 18, 8), (2, "INTEGRATION POINTS", 18, 8)]),
}


@pytest.mark.parametrize("card", [pytest.param(k, marks=pytest.mark.changes(k)) for k in SELECTED])
def test_tables_are_those_that_the_card_asks_for(tmp_path, card):
    turned_body = [*BLOCK, "*ELSET, ELSET=FIRST", "1", "*ORIENTATION, NAME=TURNED",
                   "0., 1., 0., -1., 0., 0.",
                   *material("BLOCK", (YOUNG, POISSON), section=", ORIENTATION=TURNED")]
    decks = []
    for (parameters, data), shapes in zip(SELECTED[card], SHAPES[card], strict=True):
        keyword = card.split(",")[0]
        decks.append([*turned_body, *static(*HELD, "*DLOAD", "BLOCK, P3, 6.",
                                            f"*{keyword}, {parameters}", data, times="0.5, 1.")])
        found = tables(tmp_path, decks[-1])
        assert [(t[0], t[1], len(t[4]), len(t[4][0])) for t in found] == shapes
        last = columns(found[-1])
        if "U2" in last:
            down = 0.0 if "BOTTOM" in parameters else -6.0 * (1 - POISSON**2) / YOUNG
            np.testing.assert_allclose(last["U2"], down, rtol=ROUNDING, atol=1e-12)
        if "S22" in last:
            along, across = ("S22", "S11") if "GLOBAL=YES" in parameters else ("S11", "S22")
            np.testing.assert_allclose(last[along], -6.0, rtol=ROUNDING)
            np.testing.assert_allclose(last[across], 0.0, atol=1e-9)
    note_changes(*decks)


def test_frequency_and_steps(tmp_path):
    """Every third and the last; cards hold on until others of their keyword replace them all."""
    node = ["*NODE PRINT, NSET=BLOCK.TOP, FREQUENCY=3", "U"]
    element = ["*EL PRINT, ELSET=BLOCK, FREQUENCY=0", "S"]
    found = tables(tmp_path, BODY, static(*HELD, "*DLOAD", "BLOCK, P3, 1.", *node, *element,
                                          times="0.2, 1."),
                   static(times="0.5, 1."),
                   static("*NODE PRINT, NSET=BLOCK.BOTTOM", "U", "*NODE PRINT, NSET=BLOCK.LEFT",
                          "RF"),
                   static("*EL PRINT, ELSET=BLOCK, FREQUENCY=9", "COORD", times="0.5, 1."))
    assert [t[:3] for t in found] == [
        (3, "NODES", "BLOCK.TOP"), (5, "NODES", "BLOCK.TOP"), (7, "NODES", "BLOCK.TOP"),
        (8, "NODES", "BLOCK.BOTTOM"), (8, "NODES", "BLOCK.LEFT"), (9, "NODES", "BLOCK.BOTTOM"),
        (9, "NODES", "BLOCK.LEFT"), (10, "NODES", "BLOCK.BOTTOM"), (10, "NODES", "BLOCK.LEFT"),
        (10, "INTEGRATION POINTS", "BLOCK")]
    assert found[-1][3] == ["element", "point", "x", "y"]


def test_the_summary_counts_many_rows(tmp_path):
    """A thousand nodes ten times; sums over sets are no rows of them."""
    lines = [float(x) for x in np.linspace(0.0, 1.0, 32)]
    body = [*mesh("BLOCK", lines, lines, "CPE4"), *material("BLOCK", (YOUNG, POISSON)), *HELD]
    for card, told in (("NSET=BLOCK", True), ("NSET=BLOCK, FREQUENCY=2", False),
                       ("NSET=BLOCK, TOTALS=ONLY", False)):
        deck = write(tmp_path / "deck.inp", body, static(f"*NODE PRINT, {card}", "RF", times="0.1, 1."))
        process = run("run", deck, "--out", tmp_path)
        assert process.returncode == 0, process.stderr
        assert (f"  {10 * 32 * 32} rows of *NODE PRINT and *EL PRINT" in process.stdout) == told


def test_what_a_step_has_not_is_said(tmp_path):
    """Heat comes first, so that there is no stress yet; mechanics alone has no flux."""
    both = ["*NODE PRINT, NSET=BLOCK.TOP", "U, NT", "*EL PRINT, ELSET=BLOCK", "S, HFL"]
    found = tables(tmp_path, BODY, heated("*BOUNDARY", "BLOCK.LEFT, 11, 11, 3.", *both),
                   static(*HELD))
    assert [t[3][2:] for t in found[:2]] == [["x", "y", "NT"][1:], ["x", "y", "HFL1", "HFL2"]]
    assert [t[3][2:] for t in found[2:]] == [["y", "U1", "U2", "NT"],
                                             ["x", "y", "S11", "S22", "S33", "S12"]]
    listing = (tmp_path / "deck.lst").read_text()
    for words in ("NODES OF BLOCK.TOP: there is no U at", "POINTS OF BLOCK: there is no S at",
                  "POINTS OF BLOCK: there is no HFL at"):
        assert words in listing


def test_stress_that_a_heat_step_keeps_is_that_of_its_own_temperatures(tmp_path):
    """Heated after the last mechanics: the stress at the points stays, as at the nodes."""
    body = [*BLOCK, *material("BLOCK", (YOUNG, POISSON), expansion=1e-4, conductivity=1.0)]
    found = tables(tmp_path, body, static(*HELD, "*DLOAD", "BLOCK, P3, 6.",
                                          "*EL PRINT, ELSET=BLOCK", "S"), heated("*BOUNDARY", "BLOCK.LEFT, 11, 11, 300."))
    for table in found:
        np.testing.assert_allclose(columns(table)["S22"], -6.0, rtol=ROUNDING)
    assert len(found) == 2


def test_tables_follow_refinement(tmp_path):
    found = tables(tmp_path, BODY, ["*REFINE, LEVELS=1"], static(
        *HELD, "*DLOAD", "BLOCK, P3, 6.", "*NODE PRINT, NSET=BLOCK.TOP, TOTALS=YES", "RF",
        "*EL PRINT, ELSET=BLOCK", "S"))
    assert [len(t[4]) for t in found] == [9, 1, 8 * 9]
    np.testing.assert_allclose(float(found[1][4][0][1]), -6.0 * 1.25, rtol=ROUNDING)


def test_what_is_not_computed_is_passed_over_with_a_warning(tmp_path):
    deck = write(tmp_path / "deck.inp", BODY, static(
        *HELD, "*NODE PRINT, NSET=BLOCK, GLOBAL=YES", "VF, U", "*EL PRINT, ELSET=BLOCK", "E",
        "ENER"))
    process = run("check", deck)
    assert process.returncode == 0
    for words in ("VF of *NODE PRINT is not computed", "E of *EL PRINT is not computed",
                  "ENER of *EL PRINT is not computed"):
        assert words in process.stderr
