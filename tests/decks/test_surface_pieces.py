"""Contact pairs whose surfaces consist of several lines of faces: as pairs of one line each, and by
theory."""

import sys

import h5py
import numpy as np
import pytest
from blocks import block, solid, without_unused_surfaces, write
from deck_runs import DECKS, HERTZ, run, solve, solve_as_written
from physics import material, mesh
from test_restart import assert_same, go_on

sys.path.append(str(DECKS.parents[1] / "python"))
from thercon.post.result import Result  # noqa: E402  its folder is made known first

ROUNDING = 1e-9   # of the largest value: one deck in another order of contact points
COUPLED = "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE\n0.25, 1."
INTERACTION = ("*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.4", "*GAP CONDUCTANCE, PRESSURE", "1., 0.",
               "3., 100.", "*GAP CONDUCTANCE, CLEARANCE", "1., 0.", "0.2, 0.1", "0., 0.2")


def faces_of(cards, surface):
    """Return the data of a surface of one of these blocks."""
    first = cards.index(f"*SURFACE, NAME={surface}") + 1
    last = next((k for k in range(first, len(cards)) if cards[k].startswith("*")), len(cards))
    return cards[first:last]


def joined(name, cards, *surfaces):
    """Return the cards of a surface of the faces of others."""
    return [f"*SURFACE, NAME={name}", *(face for each in surfaces for face in faces_of(cards, each))]


def model(slaves, masters, conforming):
    """Return the cards of blocks on blocks, one or two of each, and their names."""
    cards = []
    fine = 4 if conforming else 5

    def add(kind, spans, ys, parts):
        for k, (low, high) in enumerate(spans):
            cells = round((high - low) * parts)
            cards.extend(block(f"{kind}{k + 1}", np.linspace(low, high, cells + 1), ys,
                               first=1 + 1000 * len([c for c in cards if c.startswith("*ELEMENT")])))

    add("M", [(0.0, 1.0), (2.0, 3.0)] if masters == 2 else [(-0.5, 3.5)], (0.0, 0.5, 1.0), 4)
    add("S", [(0.0, 1.0), (2.0, 3.0)] if slaves == 2 else [(-0.25, 3.25)], (1.0, 1.5, 2.0), fine)
    upper, lower = (np.arange(n) + 1 for n in (slaves, masters))
    return cards, [f"S{k}" for k in upper], [f"M{k}" for k in lower]


def deck(path, slaves, masters, pieces, pairing="SURFACES", cards=(), step=COUPLED):
    """Write blocks that are pressed together at their left, lifted at their right, sheared and
    heated: with one pair, or one for each two blocks that touch."""
    blocks, upper, lower = model(slaves, masters, pairing == "NODES")
    names = [f"{name}.BOTTOM" for name in upper], [f"{name}.TOP" for name in lower]
    if pieces:
        joints = ["FEET, GROUND"]
        blocks += joined("FEET", blocks, *names[0]) + joined("GROUND", blocks, *names[1])
    else:
        joints = [f"{names[0][min(k, slaves) - 1]}, {names[1][min(k, masters) - 1]}" for k in (1, 2)]
    pair = [f"*CONTACT PAIR, INTERACTION=I, PAIRING={pairing}", *joints]
    bounds = ["*BOUNDARY", *(f"{name}.BOTTOM, 1, 2" for name in lower),
              *(f"{name}.BOTTOM, 11, 11" for name in lower)]
    loads = ["*BOUNDARY"]
    for k, name in enumerate(upper):
        loads += [f"{name}.TOP, 1, 1, 0.0002", f"{name}.LEFT, 2, 2, {-0.004 * (k + 1)}",
                  f"{name}.RIGHT, 2, 2, 0.004", f"{name}.TOP, 11, 11, {100.0 + 20.0 * k}"]
    return write(path, without_unused_surfaces(blocks + pair)[:-len(pair)],
                 *(solid(name, 1000.0, 0.3, 1e-5, 2.0) for name in upper + lower), INTERACTION, pair,
                 cards, bounds, ["*STEP", step], loads,
                 ["*NODE FILE", "U, NT", "*EL FILE", "S", "*CONTACT FILE", "CDIS, CSTR", "*END STEP"])


CASES = [(2, 1, "SURFACES"), (1, 2, "SURFACES"), (2, 2, "SURFACES"), (2, 2, "NODES")]


def states(result):
    """Return fields of a result, and the quantities of its interfaces in one row."""
    with h5py.File(result) as file:
        pairs = list(file["contact"].values())
        found = {name: np.hstack([np.atleast_2d(pair[name][()]) for pair in pairs])
                 for name in ("pressure", "shear", "heat_flux", "gap", "slip", "x", "weight", "status")}
        totals = {name: sum(pair[name][()] for pair in pairs)
                  for name in ("normal_force", "shear_force", "heat_rate")}
        totals["edges"] = np.sort(np.hstack([pair["x"][0] + pair["edges_contact"][()] for pair in pairs]))[:, :4]
        points = file["VTKHDF/PointData"]
        fields = {name: points[name][()] for name in (
            "displacement", "temperature", "contact_pressure", "contact_heat_flux", "contact_status")}
    return found | totals | fields


@pytest.mark.parametrize("cards", [(), ("*REFINE, LEVELS=2",), ("*REFINE, LEVELS=1, ELSET=S1",)])
@pytest.mark.parametrize(("slaves", "masters", "pairing"), CASES)
def test_pieces_are_as_pairs_of_their_own(tmp_path, slaves, masters, pairing, cards):
    """All fields and quantities of contact points, and the totals are their sums."""
    one, two = (states(solve(deck(tmp_path / f"{name}.inp", slaves, masters, name == "one", pairing, cards)))
                for name in ("one", "two"))
    assert one.keys() == two.keys()
    for name, values in one.items():
        scale = np.nanmax(np.abs(values), initial=0.0)
        np.testing.assert_allclose(values, two[name], rtol=0.0, atol=ROUNDING * scale, err_msg=name)
    assert {0, 1} <= set(one["status"].ravel()) and np.all(one["normal_force"] > 0.0)


@pytest.mark.parametrize(("slaves", "masters", "pairing"), CASES)
def test_s_goes_on_straight_from_piece_to_piece(tmp_path, slaves, masters, pairing):
    path = solve(deck(tmp_path / "d.inp", slaves, masters, True, pairing))
    with h5py.File(path) as file:
        assert list(file["contact"]) == ["FEET"]
        face = file["contact/FEET"]
        np.testing.assert_allclose(face["s"], face["x"][()] - face["x"][0], atol=1e-12)
        np.testing.assert_array_equal(face["piece"], np.where(face["x"][()] < 1.5, 1, 2))
        assert np.ptp(face["x"]) == pytest.approx(3.0)
    assert "in 2 pieces of the faces" in path.with_suffix(".lst").read_text()


MODULUS = 1000.0 * 0.7 / (1.3 * 0.4)   # E (1 - nu)/((1 + nu) (1 - 2 nu)) of a column held sideways


def columns(path, pairing, *cards):
    """Write two columns of width 1 that cannot move sideways, in one pair."""
    blocks, upper, lower = model(2, 2, True)
    blocks += joined("FEET", blocks, "S1.BOTTOM", "S2.BOTTOM") + joined("GROUND", blocks, "M1.TOP", "M2.TOP")
    pair = [f"*CONTACT PAIR, INTERACTION=I, PAIRING={pairing}", "FEET, GROUND"]
    names = upper + lower
    return write(path, without_unused_surfaces(blocks + pair)[:-len(pair)],
                 *(solid(name, 1000.0, 0.3, 0.0, 2.0) for name in names),
                 "*SURFACE INTERACTION, NAME=I\n*GAP CONDUCTANCE\n5., 0.\n5., 1.", pair, cards,
                 ["*BOUNDARY", *(f"{name}, 1" for name in names)],
                 [f"{name}.BOTTOM, {dof}" for name in lower for dof in (2, 11)], ["*STEP", COUPLED],
                 ["*BOUNDARY", "S1.TOP, 2, 2, -0.002", "S2.TOP, 2, 2, -0.004", "S1.TOP, 11, 11, 100.",
                  "S2.TOP, 11, 11, 50.", "*NODE FILE", "U, NT", "*CONTACT FILE", "CDIS, CSTR", "*END STEP"])


@pytest.mark.parametrize("pairing", ["SURFACES", "NODES"])
def test_two_columns_in_one_pair_have_the_forces_and_heat_of_two_columns(tmp_path, pairing):
    """Force MODULUS d/h of each; heat T/(1/k + 1/k + 1/h)."""
    with h5py.File(solve(columns(tmp_path / "d.inp", pairing))) as file:
        face = file["contact/FEET"]
        is_first = face["piece"][()] == 1
        np.testing.assert_allclose(face["pressure"][-1], MODULUS * np.where(is_first, 0.001, 0.002), rtol=1e-9)
        np.testing.assert_allclose(face["heat_flux"][-1], np.where(is_first, 100.0, 50.0) / 1.2, rtol=1e-9)
        assert face["normal_force"][-1] == pytest.approx(MODULUS * 0.003, rel=1e-9)
        assert face["heat_rate"][-1] == pytest.approx(150.0 / 1.2, rel=1e-9)


def test_checks_select_places_on_pieces(tmp_path):
    """One place on the second piece; one between both is refused."""
    check = '*VERIFY, KIND=ANALYTIC, SOURCE="E_c d/h"\n'
    path = columns(tmp_path / "d.inp", "SURFACES")
    text = path.read_text()
    rows = f"pressure, FEET@1., LAST, {MODULUS * 0.001!r}, 1E-9\npressure, FEET@2., LAST, {MODULUS * 0.002!r}, 1E-9\n"
    path.write_text(text + check + rows)
    solve(path)
    path.write_text(text + check + f"pressure, FEET@1.5, LAST, {MODULUS * 0.001!r}, 1E-9\n")
    process = run("check", path)
    assert process.returncode == 1
    assert "the arc length of contact pair FEET goes from 0 to 1, from 2 to 3" in process.stderr


def test_ties_of_two_pieces_hold_both(tmp_path):
    """As bars of one piece: u is linear."""
    path = columns(tmp_path / "d.inp", "SURFACES")
    text = path.read_text().replace("*CONTACT PAIR, INTERACTION=I, PAIRING=SURFACES", "*TIE, NAME=T")
    path.write_text(text.replace("*CONTACT FILE\nCDIS, CSTR\n", "").replace(
        "*SURFACE INTERACTION, NAME=I\n*GAP CONDUCTANCE\n5., 0.\n5., 1.\n", ""))
    with h5py.File(solve(path)) as file:
        displacement = file["VTKHDF/PointData/displacement"][()]
        y = file["VTKHDF/Points"][:, 1]
        x = file["VTKHDF/Points"][:, 0]
    last = displacement[-len(x):, 1]
    np.testing.assert_allclose(last, -np.where(x < 1.5, 0.001, 0.002) * y, atol=1e-12)


def moved(cards, dx, more):
    """Return cards of nodes and elements moved along x, their numbers higher, in sets of their own."""
    result, keyword = [], ""
    for card in cards:
        fields = [field.strip() for field in card.split(",")]
        if card.startswith("*"):
            keyword = fields[0].upper()
            result.append(card.replace("SET=", "SET=OTHER") if "SET=" in card else card)
        elif keyword == "*NODE":
            result.append(f"{int(fields[0]) + more}, {float(fields[1]) + dx!r}, {fields[2]}")
        else:
            result.append(", ".join(str(int(f) + more) if f.isdigit() else f for f in fields))
    return result


def rollers(path, pairing, *cards):
    """Write the deck of Hertz with a second one beside it, which carries a quarter of its load."""
    lines = HERTZ.read_text().split("*VERIFY")[0].splitlines()
    nodes, steel = lines.index("*NODE, NSET=CYLINDER"), lines.index("*MATERIAL, NAME=STEEL")
    curved, flat = (lines.index(f"*SURFACE, NAME={name}, TYPE=ELEMENT") for name in ("CURVED", "FLAT"))
    text = "\n".join([
        *lines[:curved], *moved(lines[nodes:curved], 100.0, 5000), *lines[curved:flat],
        *moved(lines[curved + 1:flat], 0.0, 5000), *lines[flat:steel], *moved(lines[flat + 1:steel], 0.0, 5000),
        *lines[steel:], ""])
    for old, new in {"INTERACTION=SMOOTH, NAME": f"INTERACTION=SMOOTH, PAIRING={pairing}, NAME",
                     "AXIS, 1, 1, 0.\n": "AXIS, 1, 1, 0.\nOTHERAXIS, 1, 1, 0.\nOTHERBOTTOM, 2, 2, 0.\n",
                     "LOADED, P2, 6.\n": "LOADED, P2, 6.\nOTHERLOADED, P2, 1.5\n",
                     "*SURFACE INTERACTION": "*SOLID SECTION, ELSET=OTHERCYLINDER, MATERIAL=STEEL\n"
                     "*SOLID SECTION, ELSET=OTHERBLOCK, MATERIAL=ALUMINIUM\n" + "".join(
                         f"{card}\n" for card in cards) + "*SURFACE INTERACTION"}.items():
        assert old in text
        text = text.replace(old, new, 1)
    path.write_text(text)
    return path


A, PEAK = 1.0211925, 299.23593   # of the load 6: half-width and peak pressure by theory, as in the deck


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
def test_two_rollers_in_one_pair_are_those_of_hertz(tmp_path, pairing):
    """Edges, peaks and forces go with the root of the load of each."""
    path = solve(rollers(tmp_path / "d.inp", pairing))
    with h5py.File(path) as file:
        face = file["contact/FACE"]
        s, piece, pressure = face["s"][()], face["piece"][()], face["pressure"][-1]
        start = s[piece == 2][0]
        edges = face["edges_contact"][-1]
        np.testing.assert_allclose(edges[:2], [A, start + A / 2.0], rtol=0.0, atol=0.01 * A)
        assert np.isnan(edges[2:]).all()
        assert face["edge_contact"][-1] == edges[1]
        assert pressure[piece == 1].max() == pytest.approx(PEAK, rel=0.01)
        assert pressure[piece == 2].max() == pytest.approx(PEAK / 2.0, rel=0.02)
        assert face["normal_force"][-1] == pytest.approx(300.0, rel=1e-4)
        line = 50.0 * (0.4 * np.sqrt(1.16) + np.arcsinh(0.4))   # length of y = x^2/200 up to x = 40
        assert start == pytest.approx(line + np.hypot(60.0, 8.0), rel=1e-6)


def test_a_requested_accuracy_holds_the_errors_of_both_rollers(tmp_path):
    """The edge is that of the second roller, the peak that of the first."""
    path = rollers(tmp_path / "d.inp", "SURFACES")
    process = run("run", path, "--out", tmp_path, "--accuracy", "edge=1%,pressure=1%")
    assert process.returncode == 0, process.stderr
    assert "closed from 0 to 1.02" in process.stdout and ", from 101.57" in process.stdout
    with Result(path.with_suffix(".vtkhdf")) as result:
        contact, known = result.contact("FACE"), result.uncertainties("FACE")
        start = contact["s"][contact["piece"] == 2][0]
    for name, exact in (("edge_contact", start + A / 2.0), ("peak_pressure", PEAK)):
        _, _, rows, _ = known[name]
        value, uncertainty = rows[-1, :2]
        assert abs(value - exact) <= uncertainty <= 0.01 * exact, name


def test_a_restart_goes_on_with_all_pieces(tmp_path):
    cards = ("*RESTART, WRITE",)
    whole = solve_as_written(deck(tmp_path / "d.inp", 2, 1, True, cards=cards))
    (tmp_path / "part").mkdir()
    assert_same(whole, go_on(tmp_path / "d.inp", whole, tmp_path / "part", at=0.5))


@pytest.mark.parametrize("pairing", ["SURFACES", "NODES"])
def test_two_columns_stand_on_one_rigid_line(tmp_path, pairing):
    """MODULUS d/h of each; the rigid body carries both."""
    blocks, upper, _ = model(2, 2, True)
    blocks = blocks[:next(k for k, card in enumerate(blocks) if "NSET=M1" in card)] + \
        blocks[next(k for k, card in enumerate(blocks) if "NSET=S1" in card):]
    blocks += joined("FEET", blocks, "S1.BOTTOM", "S2.BOTTOM")
    pair = [f"*CONTACT PAIR, INTERACTION=I, PAIRING={pairing}", "FEET, FLOOR"]
    path = write(tmp_path / "d.inp", without_unused_surfaces(blocks + pair)[:-len(pair)],
                 *(solid(name, 1000.0, 0.3) for name in upper),
                 ["*NODE", "9000, 1.5, 0.", "*SURFACE, NAME=FLOOR, TYPE=SEGMENTS", "START, -0.5, 1.",
                  "LINE, 3.5, 1.", "*RIGID BODY, REF NODE=9000, ANALYTICAL SURFACE=FLOOR",
                  "*SURFACE INTERACTION, NAME=I"], pair,
                 ["*BOUNDARY", "9000, 1, 2", "9000, 6", *(f"{name}, 1" for name in upper), "*STEP", "*STATIC",
                  "*BOUNDARY", "S1.TOP, 2, 2, -0.002", "S2.TOP, 2, 2, -0.004", "*END STEP"])
    with h5py.File(solve(path)) as file:
        face = file["contact/FEET"]
        is_first = face["piece"][()] == 1
        np.testing.assert_allclose(face["pressure"][-1], MODULUS * np.where(is_first, 0.002, 0.004), rtol=1e-9)
        assert face["normal_force"][-1] == pytest.approx(MODULUS * 0.006, rel=1e-9)


@pytest.mark.parametrize("pairing", ["SURFACES", "NODES"])
def test_rings_in_one_pair_are_as_pairs_of_their_own(tmp_path, pairing):
    """Two shafts in two holes: each line is closed."""
    blocks, names = [], []
    for k, x in enumerate((0.0, 10.0)):
        for name, radii, sides in ((f"SHAFT{k}", (0.5, 1.0), 12 if pairing == "NODES" else 16),
                                   (f"HUB{k}", (1.0, 2.0), 12)):
            blocks += mesh(name, list(np.linspace(0.0, 2.0 * np.pi, sides + 1)), list(radii), closed=True,
                           first=1 + 1000 * len(names),
                           to=lambda a, r, x=x: (x + r * np.cos(-a), r * np.sin(-a)))
            names.append(name)
    found = []
    for pieces in (True, False):
        pairs = ["SHAFT0.TOP, HUB0.BOTTOM", "SHAFT1.TOP, HUB1.BOTTOM"]
        more, clearances = [], ["SLAVE=SHAFT0.TOP, MASTER=HUB0.BOTTOM", "SLAVE=SHAFT1.TOP, MASTER=HUB1.BOTTOM"]
        if pieces:
            more = joined("SHAFTS", blocks, "SHAFT0.TOP", "SHAFT1.TOP") + \
                joined("HOLES", blocks, "HUB0.BOTTOM", "HUB1.BOTTOM")
            pairs, clearances = ["SHAFTS, HOLES"], ["SLAVE=SHAFTS, MASTER=HOLES"]
        pair = [f"*CONTACT PAIR, INTERACTION=I, PAIRING={pairing}", *pairs]
        path = write(tmp_path / f"{pieces}.inp", without_unused_surfaces(blocks + more + pair)[:-len(pair)],
                     *(material(name) for name in names), ["*SURFACE INTERACTION, NAME=I"], pair,
                     [f"*CLEARANCE, {each}, VALUE=-0.001" for each in clearances],
                     ["*BOUNDARY", *(f"HUB{k}.TOP, 1, 2" for k in (0, 1)),
                      *(f"SHAFT{k}.BOTTOM, 1, 2" for k in (0, 1)), "*STEP", "*STATIC", "*BOUNDARY",
                      "SHAFT1.BOTTOM, 1, 1, 0.0001", "*END STEP"])
        with h5py.File(solve(path)) as file:
            found.append(np.hstack([pair["pressure"][-1] for pair in file["contact"].values()]))
    assert len(found[0]) == (48 if pairing == "NODES" else 32) and found[0].min() > 0.0
    np.testing.assert_allclose(*found, rtol=1e-9)


@pytest.mark.parametrize("extra", ["a plate behind the master", "a plate behind the slave"])
def test_a_line_behind_another_one_touches_nothing(tmp_path, extra):
    """Nor does heat cross to it through the body in between; it is named."""
    found = []
    for pieces in (True, False):
        blocks = [*block("M1", np.linspace(-0.5, 1.5, 5), (0.0, 1.0)),
                  *block("S1", np.linspace(0.0, 1.0, 4), (1.0, 2.0), first=1001),
                  *block("M2", np.linspace(-0.3, 1.3, 4), (-1.5, -0.5), first=2001),
                  *block("S2", np.linspace(0.1, 0.9, 4), (2.5, 3.5), first=3001)]
        behind = extra.endswith("master")
        slave = joined("FEET", blocks, "S1.BOTTOM", *["S2.BOTTOM"] * (pieces and not behind))
        master = joined("GROUND", blocks, "M1.TOP", *["M2.TOP"] * (pieces and behind))
        pair = ["*CONTACT PAIR, INTERACTION=I, PAIRING=SURFACES", "FEET, GROUND"]
        names = ["M1", "M2", "S1", "S2"]
        path = write(tmp_path / f"{pieces}.inp", without_unused_surfaces(blocks + slave + master + pair)[:-len(pair)],
                     *(solid(name, 1000.0, 0.3, 1e-5) for name in names),
                     ["*SURFACE INTERACTION, NAME=I", "*GAP CONDUCTANCE", "5., 0.", "1., 10."], pair,
                     ["*BOUNDARY", "M1.BOTTOM, 1, 2", "M2.BOTTOM, 1, 2", "S2.TOP, 1, 2", "M1.BOTTOM, 11, 11",
                      "M2.BOTTOM, 11, 11, 50.", "S2.TOP, 11, 11, 70.", "*STEP", COUPLED, "*BOUNDARY",
                      "S1.TOP, 1", "S1.TOP, 2, 2, -0.002", "S1.TOP, 11, 11, 100.", "*END STEP"])
        process = run("run", path, "--out", tmp_path)
        assert ("takes no part" in process.stderr) == pieces
        result = path.with_suffix(".vtkhdf")
        assert "pieces" not in result.with_suffix(".lst").read_text().split("STEP 1")[0].split("INTERFACE")[-1]
        found.append(states(result))
    for name, values in found[0].items():
        np.testing.assert_allclose(values, found[1][name], rtol=0.0, atol=ROUNDING * np.nanmax(np.abs(values), initial=0.0))


def test_a_line_between_parts_of_another_one_is_refused(tmp_path):
    """A block in a notch, both masters of one face above."""
    base = mesh("BASE", [0.0, 1.0, 2.0, 3.0], [0.0, 0.5, 1.0])
    base = [card for card in base if not card.startswith("5, ") or card.count(",") < 4]
    fill = block("FILL", [1.1, 1.5, 1.9], (0.6, 1.0), first=501)
    above = block("ABOVE", np.linspace(0.0, 3.0, 7), (1.0, 2.0), first=1001)
    path = write(tmp_path / "d.inp", without_unused_surfaces(base + fill + above), *(
        solid(name, 1000.0, 0.3) for name in ("BASE", "FILL", "ABOVE")),
        ["*SURFACE, NAME=UNDER", *faces_of(above, "ABOVE.BOTTOM"), "*SURFACE, NAME=GROUND", "4, S3", "4, S2",
         "2, S3", "6, S4", "6, S3", *faces_of(fill, "FILL.TOP"), "*SURFACE INTERACTION, NAME=I",
         "*CONTACT PAIR, INTERACTION=I", "UNDER, GROUND", "*BOUNDARY", "BASE.BOTTOM, 1, 2",
         "FILL, 1, 2", "ABOVE.TOP, 1", "*STEP", "*STATIC", "*BOUNDARY", "ABOVE.TOP, 2, 2, -0.001", "*END STEP"])
    process = run("check", path)
    assert process.returncode == 1
    assert "a line of surface GROUND lies between parts of another one; make surfaces of these" in process.stderr


@pytest.mark.parametrize(("foot", "slide", "told"), [(1, 0.2, True), (2, -0.2, True), (1, 0.02, False)])
def test_a_foot_that_slides_past_its_own_master_is_warned_of(tmp_path, foot, slide, told):
    """Not only where the last line of the master ends, or the first one begins."""
    path = deck(tmp_path / "d.inp", 2, 2, True, step="*STATIC\n1., 1.")
    text = path.read_text().replace("*FRICTION\n0.4\n", "")
    for k in (1, 2):
        text = text.replace(f"S{k}.TOP, 1, 1, 0.0002", f"S{k}.TOP, 1, 1, {slide if k == foot else 0.0}")
        text = "\n".join(line for line in text.splitlines() if not line.startswith(f"S{k}.TOP, 11"))
        text = text.replace(f"S{k}.RIGHT, 2, 2, 0.004", f"S{k}.RIGHT, 2, 2, {-0.004 * k!r}")
    path.write_text(text + "\n")
    stderr = run("run", path, "--out", tmp_path).stderr
    assert ("slides past the end of the master surface by 0.19" in stderr) == told
    assert not told or f"slave node {'2' if foot == 1 else '3'}0" in stderr
