"""SLIDING=FINITE: contact where faces are, whatever way they came there."""

import re

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from calculix import thercon
from deck_runs import assert_alike, datasets, run, solve, solve_as_written
from physics import follows, judge, material, mesh, nodes_of
from test_restart import assert_same, go_on
from thercon.post.result import Result

FINITE = ", SLIDING=FINITE"
RAIL = mesh("RAIL", np.linspace(0.0, 10.0, 41), [-2.0, -1.0, -0.5, -0.25, 0.0], "CPE4")
AMONG_RAIL = [n for n, (_, y) in nodes_of(RAIL).items() if y == 0.0]
START, WIDTH = 2.0, 1.5
TAILS = pytest.mark.parametrize("tail", ["FULL", "SPARSE"])
SCALE = 1e-3   # by which strains are 1e-6


def pad(start=START, kind="CPE4", name="PAD", first=5001, level=0.0):
    """Return a pad whose nodes do not match those of the rail."""
    return mesh(name, start + np.linspace(0.0, WIDTH, 8), [level, level + 0.4, level + 1.0], kind,
                first=first)


def sliding(way, pair=FINITE, start=START, scale=1.0, friction=0.0, increment=0.1, heat=True,
            press=-1e-3, direct="", level=0.0, cards=(), more=(), turned=False):
    """Return a hot pad that is pressed on a cold rail and slid along it by a way, or by each of
    several ways; `turned`: the rail is moved instead, the other way."""
    own = {"expansion": 1e-5 * scale, "conductivity": 50.0}
    steps = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE" if heat else "*STATIC",
             "1., 1.", "*BOUNDARY", "RAIL.BOTTOM, 1, 2", "PAD.TOP, 1",
             f"PAD.TOP, 2, 2, {press * scale!r}", "*END STEP"]
    if heat:
        steps[-1:] = ["RAIL.BOTTOM, 11, 11, 0.", "PAD.TOP, 11, 11, 100.", "*END STEP"]
    for to in way if isinstance(way, list) else [way] if way else []:
        moved = f"RAIL.BOTTOM, 1, 1, {-to!r}" if turned else f"PAD.TOP, 1, 1, {to!r}"
        steps += ["*STEP, INC=1000", steps[1] + direct, f"{increment!r}, 1.", "*BOUNDARY", moved,
                  "*END STEP"]
    return without_unused_surfaces([
        *RAIL, *pad(start, level=level), *material("RAIL", (2e5, 0.3), **own),
        *material("PAD", (2e5, 0.3), **own), *more,
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "RAIL, 0.", "PAD, 0.",
        "*SURFACE INTERACTION, NAME=FACES", "*FRICTION", f"{friction!r}",
        "*GAP CONDUCTANCE, PRESSURE", "0., 0.", f"100., {1000.0 * scale!r}",
        f"*CONTACT PAIR, INTERACTION=FACES, NAME=FACE{pair}", "PAD.BOTTOM, RAIL.TOP", *cards,
        *steps])


def final(folder, name, cards, face="FACE"):
    """Return the fields of the last increment of a deck, and its way along x in its pad."""
    result = solve(write(folder / f"{name}.inp", cards))
    with h5py.File(result) as file:
        found = {key: file[f"contact/{face}/{key}"][-1] for key in ("pressure", "gap", "heat_flux",
                                                                    "shear", "conductance")
                 if f"contact/{face}/{key}" in file}
        number = file["VTKHDF/PointData/node_id"][()]
        for key in ("temperature", "von_mises", "displacement"):
            if f"VTKHDF/PointData/{key}" in file:
                found[key] = file[f"VTKHDF/PointData/{key}"][-len(number):]
        found["pad"] = number > 5000
    return found


def assert_same_fields(one, other, tolerance, way=0.0):
    """Assert that fields agree, but for a way of the pad along x."""
    for key in one.keys() - {"pad", "gap"}:
        values = one[key].copy()
        if key == "displacement":
            values[one["pad"], 0] -= way
        scale = abs(other[key]).max()
        np.testing.assert_allclose(values, other[key], rtol=0.0, atol=tolerance * scale, err_msg=key)


PAIRS = [FINITE, FINITE + ", PAIRING=NODES"]


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("way", [0.5, 0.37, 3.123, -1.4])
def test_a_pad_slid_is_the_pad_drawn_there(tmp_path, way, pair):
    slid = final(tmp_path, "slid", sliding(way, pair))
    drawn = final(tmp_path, "drawn", sliding(0, pair, START + way))
    assert_same_fields(slid, drawn, 1e-6, way)
    assert drawn["heat_flux"].max() > 10.0


def test_a_pad_of_a_pattern_slides_along_all_of_the_rail(tmp_path):
    cards = sliding(1.9)
    by_pattern = [card.replace("PAD.BOTTOM, RAIL.TOP", "P*.BOTTOM, RAIL.TOP") for card in cards]
    assert by_pattern != cards
    assert_same_fields(final(tmp_path, "pattern", by_pattern, "FACE-PAD.BOTTOM"),
                       final(tmp_path, "names", cards), 1e-12)


@pytest.mark.parametrize("amplitude", ["STEP", "RAMP"])
def test_a_slide_that_acts_at_once_names_the_ramp(tmp_path, amplitude):
    """A twentieth of a second is too long for a ramp of 3 within one."""
    cards = sliding(3.0, heat=False)
    at = len(cards) - cards[::-1].index("*STEP, INC=1000") - 1
    cards[at:at + 3] = [f"*STEP, INC=1000, AMPLITUDE={amplitude}", "*STATIC", "0.2, 1., 0.1"]
    process = run("run", "--quiet", write(tmp_path / "deck.inp", cards), "--out", tmp_path)
    assert process.returncode == 2 and "contact pair FACE slips by" in process.stderr
    assert ("*STEP, AMPLITUDE=RAMP ramps them" in process.stderr) == (amplitude == "STEP")


def flush(pair, kind, ends, short=0.0, rigid=False):
    """Return a hot body across a gap of gas from a cold one that ends with it, but for `short`."""
    own = {"expansion": 1e-5, "conductivity": 0.003, "density": 1e-5, "specific_heat": 300.0}
    xs = [short, 0.5, 1.0, 1.5, 2.0 - short]
    cold = [*mesh("COLD", xs, [-0.5, 0.0], kind), *material("COLD", (2e5, 0.3), **own),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "COLD, 20."]
    held = ["COLD.BOTTOM, 2", *(f"COLD.{end}, 1" for end in ends)]
    hold = "COLD.BOTTOM, 11, 11, 20."
    if rigid:
        cold = ["*NODE, NSET=COLD", "1, 1., -1.", "*SURFACE, TYPE=SEGMENTS, NAME=COLD.TOP",
                f"START, {short!r}, 0.", f"LINE, {xs[-1]!r}, 0.",
                "*RIGID BODY, REF NODE=1, ANALYTICAL SURFACE=COLD.TOP",
                "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "COLD, 20."]
        held, hold = ["COLD, 1, 2", "COLD, 6"], "COLD, 11, 11, 20."
    return without_unused_surfaces([
        *mesh("HOT", [0.0, 0.5, 1.0, 1.5, 2.0], [0.02, 0.52, 1.02], kind, first=1001), *cold,
        *material("HOT", (2e5, 0.3), **own), "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HOT, 20.",
        "*SURFACE INTERACTION, NAME=GAS", "*GAP LAW, TYPE=GAS", "3e-4, 0.01",
        f"*CONTACT PAIR, INTERACTION=GAS, NAME=FACE{pair}", "HOT.BOTTOM, COLD.TOP",
        "*BOUNDARY", "HOT.TOP, 2", *(f"HOT.{end}, 1" for end in ends), *held,
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", "5., 10.", "*DFLUX", "HOT, BF, 0.5",
        "*BOUNDARY", hold, "*END STEP"])


@pytest.mark.parametrize(("kind", "ends", "short", "rigid"), [
    ("CPE8", ("LEFT", "RIGHT"), 0.0, False), ("CPE4", ("LEFT", "RIGHT"), 1e-5, False),
    ("CPE4", ("LEFT",), 0.0, False), ("CPE8", ("LEFT", "RIGHT"), 1e-6, True)])
def test_nodes_where_both_faces_end_stay_opposite(tmp_path, kind, ends, short, rigid):
    """Gas cools a node where it has a master, which tilts its normal; strains are 2e-3."""
    result, other = (final(tmp_path, name, flush(pair, kind, ends, short, rigid))
                     for name, pair in (("slid", PAIRS[1]), ("drawn", ", PAIRING=SURFACES")))
    np.testing.assert_allclose(result["heat_flux"][:: 2 if kind == "CPE8" else 1],
                               other["heat_flux"], rtol=3e-3)
    assert np.nanmax(abs(result["temperature"] - other["temperature"])) < 2e-3 * np.nanmax(
        other["temperature"])


@pytest.mark.parametrize("count", [3, 5])
@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_hot_blocks_that_yield_follow_sliding_in_whole_increments(tmp_path, friction, count):
    """What faces that follow sliding do else than those that do not falls with the strains, here all of
    3e-3 and a tenth of them with the same stresses."""
    off = []
    for part in 1.0, 0.1:
        slid, drawn = (final(tmp_path, f"{name}{part}", hot_block(pair, friction, count, part))
                       for name, pair in (("slid", PAIRS[0]), ("drawn", ", PAIRING=SURFACES")))
        assert slid["von_mises"].max() > 100.0   # it yields
        off.append([abs(slid[name] - drawn[name]).max() / abs(drawn[name]).max()
                    for name in ("pressure", "heat_flux")])
    assert np.all(np.array(off[1]) < 0.2 * np.array(off[0]))


def hot_block(pair, friction, count, part):
    """Return a hot block that is pressed on a cold one and yields; strains are a part of 3e-3."""
    upper, lower = (material(name, (young / part, 0.3), 1.2e-5 * part, 50.0)
                    for name, young in (("UP", 2e5), ("LOW", 1e5)))
    return [*mesh("UP", np.linspace(1.0, 3.6, count + 1), [0.0, 1.4], "CPE4", first=101),
            *mesh("LOW", np.linspace(0.0, 5.0, 6), [-1.5, 0.0], "CPE4"),
            *upper[:-1], "*PLASTIC", "100., 0.", f"200., {0.05 * part!r}", upper[-1], *lower,
            "*SURFACE INTERACTION, NAME=I", "*FRICTION", repr(friction), "*GAP LAW, TYPE=GAS",
            f"{0.02 * part!r}, {0.01 * part!r}", "*GAP LAW, TYPE=POWER", "2., 0.05, 0.9",
            f"*CONTACT PAIR, INTERACTION=I, NAME=FACE{pair}", "UP.BOTTOM, LOW.TOP",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "UP, 20.", "LOW, 20.",
            "*BOUNDARY", "LOW.BOTTOM, 1, 2", "*STEP",
            "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT, STEADY STATE", "0.25, 1.", "*BOUNDARY",
            "UP.TOP, 1, 1, 0.", f"UP.TOP, 2, 2, {-0.002 * part!r}", "UP.TOP, 11, 11, 280.",
            "LOW.BOTTOM, 11, 11, 20.", "*END STEP"]


def test_tiny_strains_give_what_small_sliding_gives_where_the_pad_is_drawn(tmp_path):
    slid = final(tmp_path, "slid", sliding(0.37, scale=SCALE))
    drawn = final(tmp_path, "drawn", sliding(0, ", PAIRING=SURFACES", START + 0.37, SCALE))
    assert_same_fields(slid, drawn, 4e-6, 0.37)


@TAILS
@pytest.mark.parametrize("pair", PAIRS)
def test_what_slides_is_relative(tmp_path, pair, tail):
    """The rail moved the other way, its nodes by far more than strains."""
    one = final(tmp_path, "pad", sliding(0.8, pair))
    other = final(tmp_path, "rail", sliding(0.8, pair, turned=True, cards=[f"*SOLVER, TAIL={tail}"]))
    other["displacement"][:, 0] += 0.8
    assert_same_fields(other, one, 1e-6)


def test_a_tie_and_another_interface_beside(tmp_path):
    """A block is tied to the end of the rail; another pad rests on it."""
    own = {"expansion": 1e-5, "conductivity": 50.0}
    more = [*mesh("BLOCK", [10.0, 10.5, 11.0], [-2.0, -1.2, 0.0], "CPE4", first=9001),
            *material("BLOCK", (2e5, 0.3), **own), "*TIE, NAME=SEAM", "BLOCK.LEFT, RAIL.RIGHT",
            *pad(8.0, name="REST", first=7001), *material("REST", (2e5, 0.3), **own),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BLOCK, 0.", "REST, 0."]
    cards = ["*CONTACT PAIR, INTERACTION=FACES, NAME=BESIDE, SLIDING=FINITE",
             "REST.BOTTOM, RAIL.TOP", "*BOUNDARY", "REST.TOP, 1", "REST.TOP, 2, 2, -5e-4",
             "REST.TOP, 11, 11, 50."]
    slid = final(tmp_path, "slid", sliding(1.3, more=more, cards=cards))
    drawn = final(tmp_path, "drawn", sliding(0, start=START + 1.3, more=more, cards=cards))
    for field in (slid, drawn):
        del field["displacement"]
    assert_same_fields(slid, drawn, 1e-6)


@TAILS
@pytest.mark.parametrize("pair", PAIRS)
def test_friction_takes_the_work_of_the_drive(tmp_path, pair, tail):
    """Once all slips; strains are 1e-4."""
    changes = {"*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE": "*COUPLED TEMPERATURE-DISPLACEMENT",
               "*CONDUCTIVITY": "*DENSITY\n1.\n*SPECIFIC HEAT\n1.\n*CONDUCTIVITY",
               "*FRICTION": "*GAP HEAT GENERATION\n0.5\n*FRICTION",
               "*STEP, INC": "*AMPLITUDE, NAME=SLIDE\n0., 0., 1., 1.\n*STEP, INC"}
    text = "\n".join(sliding(1.0, pair, scale=0.1, friction=0.2, increment=0.05, direct=", DIRECT",
                             cards=[f"*SOLVER, TAIL={tail}"]))
    for old, new in changes.items():
        text = text.replace(old, new)
    text = text.replace("*BOUNDARY\nPAD.TOP, 1, 1", "*BOUNDARY, AMPLITUDE=SLIDE\nPAD.TOP, 1, 1")
    deck = write(tmp_path / "deck.inp", [text])
    solve(deck)
    parts = re.findall(r"heat of friction less work of the drive +(\S+) of it",
                       deck.with_suffix(".lst").read_text())
    assert len(parts) >= 20
    assert max(abs(float(part)) for part in parts[-18:]) < 1e-3
    with h5py.File(tmp_path / "deck.vtkhdf") as file:
        assert file["history/heat_friction"][-1] > 0.0
        told = f"heat of friction {file['history/heat_friction'][-1]:.6g} (no estimate: "
    assert told in " ".join(deck.with_suffix(".lst").read_text().split())


def test_the_picture_of_the_mesh_marks_both_faces_to_their_ends(tmp_path):
    """Also where the pad never is."""
    with Result(solve(write(tmp_path / "deck.inp", sliding(0.3, heat=False)))) as result:
        marked = [np.unique(result.cells.node_id[edges[:, :2]])
                  for edges in result.faces(result.contact("FACE"))]
    own = [n for n, (_, y) in nodes_of(pad()).items() if y == 0.0]
    for found, expected in zip(marked, (own, AMONG_RAIL), strict=True):
        np.testing.assert_array_equal(found, expected)


LOAD = 200.0


def loaded(friction, pair):
    """Return a pad under a force that a coupling drives along a rail that another one holds."""
    held = ["*NODE", "90001, 5., -2.", "90002, 3., 1.",
            "*COUPLING, REF NODE=90001, SURFACE=RAIL.BOTTOM, CONSTRAINT NAME=HOLD", "*KINEMATIC",
            "1, 2", "*COUPLING, REF NODE=90002, SURFACE=PAD.TOP, CONSTRAINT NAME=DRIVE",
            "*KINEMATIC", "1, 2"]
    return without_unused_surfaces([
        *RAIL, *pad(), *material("RAIL", (2e5, 0.3)), *material("PAD", (2e5, 0.3)), *held,
        "*SURFACE INTERACTION, NAME=FACES", "*FRICTION", f"{friction!r}",
        f"*CONTACT PAIR, INTERACTION=FACES, NAME=FACE{pair}", "PAD.BOTTOM, RAIL.TOP", "*BOUNDARY",
        "90001, 1, 2", "90001, 6", "90002, 6", "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "90002, 1",
        "*CLOAD", f"90002, 2, {-LOAD!r}", "*END STEP", "*STEP, INC=1000", "*STATIC", "0.1, 1.",
        "*BOUNDARY", "90002, 1, 1, 1.3", "*END STEP"])


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_the_forces_of_both_faces_are_equal(tmp_path, friction, pair):
    """The rail carries the load; what drives the pad, it is held against. Normals lean by 1e-3."""
    cards = loaded(friction, pair)
    judge(tmp_path, cards, [("RF2", "90001", "LAST", LOAD, 1e-9),
                            ("RF1", "90001", "LAST", -friction * LOAD, 1e-3 * LOAD, "ABS"),
                            ("RF1", "90002", "LAST", friction * LOAD, 1e-3 * LOAD, "ABS"),
                            ("normal_force", "FACE", "LAST", LOAD, 1e-3),
                            ("shear_force", "FACE", "LAST", -friction * LOAD, 1e-3 * LOAD, "ABS"),
                            ("force_imbalance", "", "LAST", 0.0, 1e-9, "ABS")])


@pytest.mark.parametrize("pair", PAIRS)
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_moments_are_in_balance_about_displaced_points(tmp_path, friction, pair):
    """Forces of all supports, at the places that they have been moved to."""
    every = ["*NSET, NSET=HELD", "RAIL.BOTTOM, PAD.TOP"]
    cards = sliding(1.3, pair, scale=SCALE, heat=False, friction=friction, more=every)
    cards[-1:] = ["*NODE PRINT, NSET=HELD", "U, RF", "*END STEP"]
    tables = thercon(write(tmp_path / "deck.inp", cards))
    place = {n: p for n, p in nodes_of(cards).items()}
    u1, u2, f1, f2 = ({key[0]: value for key, value in tables[2.0, name].items()}
                      for name in ("U1", "U2", "RF1", "RF2"))
    force = np.array([[f1[n], f2[n]] for n in f1])
    at = np.array([[place[n][0] + u1[n], place[n][1] + u2[n]] for n in f1])
    moment = at[:, 0] * force[:, 1] - at[:, 1] * force[:, 0]
    assert np.all(abs(force.sum(axis=0)) < 1e-7 * abs(force).sum())
    assert abs(moment.sum()) < 2e-6 * abs(moment).sum()


@pytest.mark.parametrize("pair", PAIRS)
def test_a_pad_that_slides_off_the_end_and_back(tmp_path, pair):
    """Its force goes to 0 as it leaves, nothing fails, and each is told once."""
    deck = write(tmp_path / "deck.inp", sliding([7.0, 0.0], pair, heat=False, increment=0.02,
                                                friction=0.1, cards=["*OPTIONS, ERRORS=NO"]))
    result = solve(deck)
    with h5py.File(result) as file:
        times, force = file["history/time"][()], file["contact/FACE/normal_force"][()]
    # The rail ends at 10: the pad's left end is past it from a way of 8 - x on.
    assert force[times == 1.0] > 100.0
    off = (times > 1.0) & (times < 1.7)
    assert np.all(force[off] > 0.0)
    text = deck.with_suffix(".lst").read_text()
    assert len(re.findall("the first contact points leave the master", text)) == 1


def test_a_pad_that_left_comes_back_as_it_was(tmp_path):
    """Nothing is left of the way, without friction: also where all of it was off the rail."""
    there = final(tmp_path, "there", sliding(0.5, increment=0.02))
    back = final(tmp_path, "back", sliding([8.7, 0.5], increment=0.02))
    assert_same_fields(back, there, 1e-6)
    with h5py.File(tmp_path / "back.vtkhdf") as file:
        contact, off = file["contact/FACE"], file["history/time"][()] == 2.0
        assert contact["normal_force"][off] == 0.0
        assert np.all(contact["heat_rate"][off] == 0.0)
        assert np.all(np.isnan(contact["gap"][off]))
        assert np.all(np.isfinite(contact["gap"][-1]))
    text = (tmp_path / "back.lst").read_text()
    for word in ("leave", "reach"):
        assert len(re.findall(f"the first contact points {word} the master", text)) == 1


def test_a_pad_that_slides_on_from_beyond_the_rail(tmp_path):
    here = final(tmp_path, "here", sliding(0, start=5.0))
    arrived = final(tmp_path, "arrived", sliding(-6.0, start=11.0, increment=0.02))
    assert_same_fields(arrived, here, 1e-6, -6.0)


def test_a_long_increment_is_cut_back_to_one_spacing(tmp_path):
    deck = write(tmp_path / "long.inp", sliding(1.5, increment=1.0))
    solve(deck)
    slips = re.findall(r"slips by (\S+) in an increment, more than the spacing of nodes, 0.214286",
                       " ".join(deck.with_suffix(".lst").read_text().split()))
    assert slips
    assert all(float(slip) > 0.214 for slip in slips)
    short = final(tmp_path, "short", sliding(1.5, increment=0.05))
    assert_same_fields(final(tmp_path, "long", sliding(1.5, increment=1.0)), short, 1e-6)
    movement = datasets(tmp_path / "long.vtkhdf", "contact/FACE")["contact/FACE/slip"]
    assert np.max(np.abs(np.diff(movement, axis=0))) < 0.2143


def test_increments_that_were_cut_back_grow_no_farther_than_slip_allows(tmp_path):
    """Twenty increments of 0.3 are wanted, where nodes are 0.214 apart."""
    deck = write(tmp_path / "deck.inp", sliding(6.0, increment=0.05, heat=False))
    solve(deck)
    rows = np.loadtxt(deck.with_suffix(".sta"), skiprows=1)
    assert rows[:, 5].sum() <= 2   # how often one was
    assert len(rows) < 1.7 * 6.0 / 0.214


def stderr(folder, cards, status):
    process = run("run", "--quiet", write(folder / "deck.inp", cards), "--out", folder)
    assert process.returncode == status, process.stderr
    return process.stderr


def test_fixed_increments_that_slip_too_far_are_warned_of(tmp_path):
    said = stderr(tmp_path, sliding(0.5, increment=1.0, direct=", DIRECT"), 0)
    assert re.search(r"contact pair FACE slips by 0.5\d* in an increment, more than the spacing of "
                     r"nodes, 0.214286, at slave node 50\d\d, time 2, which DIRECT does not allow to "
                     "be cut back", said), said


def test_a_step_that_slides_past_all_of_the_master_at_once(tmp_path):
    """No contact point is closed at its end."""
    said = stderr(tmp_path, sliding(9.0, increment=1.0, direct=", DIRECT"), 0)
    assert re.search(r"slips by 8\.99\d* in an increment, .* at slave node \d+, time 2,", said), said
    solve(write(tmp_path / "cut.inp", sliding(9.0, increment=1.0)))
    assert "slips by 8.99" in (tmp_path / "cut.lst").read_text()


@pytest.mark.parametrize("direct", ["", ", DIRECT"])
def test_a_slave_that_comes_from_behind_the_master(tmp_path, direct):
    """It slides beside the rail, below its face, into it."""
    said = stderr(tmp_path, sliding(-6.0, start=11.0, increment=0.1, direct=direct, level=-0.7,
                                    heat=False), 2)
    assert re.search(r"increment \d+ \(time 1\.\d+\): contact pair FACE: slave node 5001 would pass "
                     r"through the master from behind: it is 0\.7\S* inside", said), said


@pytest.mark.changes("CONTACT PAIR, SLIDING")
def test_what_the_parameter_changes(tmp_path):
    """The pad presses on other nodes of a rail that is held everywhere."""
    node = {x: n for n, (x, y) in nodes_of(RAIL).items() if y == 0.0}

    def make(word):
        cards = without_unused_surfaces([
            *RAIL, *pad(), *material("RAIL", (2e5, 0.0)), *material("PAD", (2e5, 0.0)),
            "*SURFACE INTERACTION, NAME=FACES", "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE, "
            f"PAIRING=SURFACES, SLIDING={word}", "PAD.BOTTOM, RAIL.TOP", "*BOUNDARY", "RAIL, 1, 2",
            "*STEP, INC=100", "*STATIC", "0.1, 1.", "*BOUNDARY", "PAD.LEFT, 1, 1, 2.", "*DSLOAD",
            "PAD.TOP, P, 3.", "*END STEP"])
        here, there = (2.5, 4.5) if word == "SMALL" else (4.5, 2.5)
        return cards, [("RF2", node[here], "LAST", 0.75, 1e-9),
                       ("RF2", node[there], "LAST", 0.0, 1e-9, "ABS")]

    follows(tmp_path, make, "FINITE", "SMALL")


def test_small_sliding_is_the_default_and_has_two_names(tmp_path):
    one, *others = (
        datasets(solve(write(tmp_path / f"{k}.inp", sliding(0.01, ", PAIRING=SURFACES" + words))),
                 "contact", "history", "VTKHDF")
        for k, words in enumerate(("", ", SLIDING=SMALL", ", SMALL SLIDING")))
    for other in others:
        assert_alike(one, other, 0.0)


NOTE = "Abaqus follows sliding there"


@pytest.mark.parametrize(("words", "told"), [
    ("", True), (", SMALL SLIDING", False), (FINITE, False), (", SLIDING=SMALL", False)])
def test_nlgeom_without_a_word_of_sliding_is_noted(tmp_path, words, told):
    cards = [c.replace("*STEP", "*STEP, NLGEOM") if c == "*STEP" else c
             for c in sliding(0, words)]
    deck = write(tmp_path / "deck.inp", cards)
    solve(deck)
    assert (NOTE in " ".join(deck.with_suffix(".lst").read_text().split())) == told


RUNS = {
    "frictionless": {},
    "friction and node-to-side": {"friction": 0.3, "pair": PAIRS[1]},
    "full errors": {"friction": 0.2, "cards": ["*OPTIONS, ERRORS=FULL"], "way": [0.4]},
}


@pytest.mark.parametrize("name", RUNS)
def test_a_run_that_goes_on_equals_one_that_was_not_interrupted(tmp_path, name):
    kept = {"way": [0.9, -0.2], "increment": 0.125, **RUNS[name]}
    cards = sliding(kept.pop("way"), **kept, more=["*RESTART, WRITE"])
    deck = write(tmp_path / "deck.inp", cards)
    whole = solve_as_written(deck)
    (tmp_path / "on").mkdir()
    assert_same(whole, go_on(deck, whole, tmp_path / "on", 1.5))


def test_numerical_uncertainties_hold(tmp_path):
    """Of every increment; the reference has a quarter of the sides and of the increments."""
    def made(name, levels, increment, errors):
        return solve(write(tmp_path / f"{name}.inp", sliding(
            0.8, increment=increment, friction=0.2,
            more=[f"*REFINE, LEVELS={levels}", f"*OPTIONS, ERRORS={errors}"])))

    holds = []
    with h5py.File(made("fine", 2, 0.0625, "NO")) as fine, h5py.File(
            made("coarse", 0, 0.25, "FULL")) as file:
        for key in ("normal_force", "shear_force", "heat_rate"):
            rows, true = file[f"errors/FACE/{key}"][()], fine[f"contact/FACE/{key}"][()]
            at = [np.argmin(abs(fine["history/time"][()] - t)) for t in file["errors/time"][()]]
            assert np.isfinite(rows).all() and len(rows) == 5
            holds += list(abs(rows[:, 0] - true[at]) <= rows[:, 1])
    assert np.mean(holds) >= 0.95


def tilted(way):
    """Return a pad that slides off a rail, pressed on it at the end that stays."""
    pad_cards = mesh("PAD", np.linspace(5.0, 15.0, 5), [5.0, 10.0], "CPS4", first=1001)
    tops = sorted((-way * x, n) for n, (x, y) in nodes_of(pad_cards).items() if y == 10.0)
    own = {"conductivity": 1.0}
    return [*mesh("RAIL", np.linspace(0.0, 20.0, 9), [0.0, 5.0], "CPS4"), *pad_cards,
            *material("RAIL", (1000.0, 0.3), **own), *material("PAD", (1000.0, 0.3), **own),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "RAIL, 0.", "PAD, 0.",
            "*SURFACE INTERACTION, NAME=FACES", "*GAP CONDUCTANCE, CLEARANCE", "0.1, 0.", "0., 0.5",
            f"*CONTACT PAIR, INTERACTION=FACES, NAME=FACE{FINITE}, PAIRING=SURFACES",
            "PAD.BOTTOM, RAIL.TOP", "*STEP, INC=1000",
            "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.1, 1.", "*BOUNDARY",
            "RAIL.BOTTOM, 1, 2", "RAIL.BOTTOM, 11, 11, 0.", "PAD.TOP, 11, 11, 100.",
            f"PAD.TOP, 1, 1, {way!r}",
            *(f"{n}, 2, 2, {0.25 - 0.075 * k!r}" for k, (_, n) in enumerate(tops)), "*END STEP"]


def test_points_beyond_the_master_tell_no_edge(tmp_path):
    """To the left is to the right in a mirror: the last points have no master, whichever they are."""
    found = []
    for way in (7.5, -7.5):
        with h5py.File(solve(write(tmp_path / f"{way}.inp",
                                   without_unused_surfaces(tilted(way))))) as file:
            face = file["contact/FACE"]
            edge = face["edges_contact"][-1][0]
            found.append((face["heat_rate"][-1], edge if way > 0.0 else 10.0 - edge))
            gap = face["gap"][-1][1 if way > 0.0 else -2]
    assert found[0] == pytest.approx(found[1], rel=1e-9)
    assert 0.0 < found[0][1] < 1.25 and gap > 0.0, "nearer to the point that is closed"


def test_a_body_whose_free_nodes_are_all_prescribed_or_in_contact_has_no_inside(tmp_path):
    """One row of elements, its upper nodes moved: nothing of it is left to eliminate."""
    block = mesh("UPPER", [3.0, 5.0, 7.0], [4.0, 6.0], "CPE4", first=501)
    base = mesh("LOWER", np.linspace(0.0, 10.0, 6), [0.0, 2.0, 4.0], "CPE4")
    found = [final(tmp_path, solver, without_unused_surfaces([
        *block, *base, *material("UPPER", (1000.0, 0.3)), *material("LOWER", (1000.0, 0.3)),
        "*SURFACE INTERACTION, NAME=FACES", f"*CONTACT PAIR, INTERACTION=FACES, NAME=FACE{FINITE}",
        "UPPER.BOTTOM, LOWER.TOP", f"*SOLVER, TYPE={solver}", "*STEP", "*STATIC", "0.5, 1.",
        "*BOUNDARY", "LOWER.BOTTOM, 1, 2", "UPPER.TOP, 1, 1, 0.1", "UPPER.TOP, 2, 2, -0.01",
        "*END STEP"])) for solver in ("MUMPS", "SKYLINE")]
    assert found[0]["pressure"].max() > 1.0
    assert_same_fields(*found, 1e-10)


@pytest.mark.parametrize("unit", [1.0, 1e-3, 0.3, 7.0])
@pytest.mark.parametrize("pair", ["", ", PAIRING=SURFACES"])
def test_a_face_that_lies_on_a_drawing_to_rounding_touches_it(tmp_path, unit, pair):
    """A disc on a drawing that bends at its edge; heat alone, so that nothing presses."""
    radius, height = 10.0 * unit, 5.0 * unit
    judge(tmp_path, [
        *mesh("DISC", [0.0, radius], [0.0, height], "CAX4"), *material("DISC", None, conductivity=4.0 * unit),
        "*NODE, NSET=REF", f"900, 0., {-unit!r}", "*SURFACE, NAME=DIE, TYPE=SEGMENTS", "START, 0., 0.",
        f"LINE, {radius!r}, 0.", f"LINE, {2 * radius!r}, {0.43181129346902686 * unit!r}",
        "*RIGID BODY, REF NODE=REF, ANALYTICAL SURFACE=DIE", "*SURFACE INTERACTION, NAME=I",
        "*GAP CONDUCTANCE, PRESSURE", "5., 0.", "10., 100.", f"*CONTACT PAIR, INTERACTION=I, NAME=FACE{FINITE}{pair}",
        "DISC.BOTTOM, DIE", "*BOUNDARY", "DISC.TOP, 11, 11, 400.", "REF, 11, 11, 78.", "*STEP",
        "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*END STEP"], [
        ("heat_rate", "FACE", "LAST", np.pi * radius**2 * (400.0 - 78.0) / (5.0 / 4.0 + 1.0 / 5.0), 1e-9)])
