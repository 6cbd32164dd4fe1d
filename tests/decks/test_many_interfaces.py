"""Many interfaces between many bodies: the sparse tail against the full matrix of all contact
unknowns, on rods of pellets that heat closes onto their tube, each pellet pressed on the next.
"""

import os
import re
import resource
import subprocess

import h5py
import numpy as np
import pytest
from blocks import write
from changes import note_changes
from deck_runs import COUPLED, copy_deck, run, solve
from pellets import ALONG, HEIGHT, PRESS, rod
from physics import material, mesh

KINDS = ["CAX4", "CAX8", "mortar", "tables", "transient", "rubbing", "rubbing tables", "dilating transient"]
MOTIONS = ["transient", "mortar transient", "tables transient", "rubbing transient"]


def contact_of(result):
    """Return the values of all contact points at the end, and their states."""
    with h5py.File(result) as file:
        groups = [file["contact"][name] for name in sorted(file["contact"])]
        return {name: np.concatenate([g[name][-1] for g in groups])
                for name in ("pressure", "shear", "heat_flux", "gap", "slip", "status")}


def assert_same(found, expected):
    """Assert that contact points do the same to 1e-9 of the largest values."""
    assert np.array_equal(found["status"], expected["status"])
    for name, scale in (("pressure", "pressure"), ("shear", "pressure"), ("heat_flux", "heat_flux"),
                        ("gap", "gap"), ("slip", "gap")):
        largest = np.max(np.abs(expected[scale]))
        assert found[name] == pytest.approx(expected[name], rel=0, abs=1e-9 * largest), name


@pytest.mark.changes("SOLVER, TAIL")
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("pellets", [3, 8])
def test_the_sparse_tail_gives_what_the_full_matrix_gives(tmp_path, pellets, kind):
    found, gains = {}, {}
    for tail in ("FULL", "SPARSE"):
        deck = write(tmp_path / f"{tail}.inp", rod(pellets, tail, kind))
        found[tail] = contact_of(result := solve(deck))
        with h5py.File(result) as file:
            # Beside heat of friction the matrix is less normal, and a gain near 0 is none.
            gains[tail] = [np.maximum(file["history"][name][:], floor) for name, floor in (
                ("coupling_gain", -np.inf), ("coupling_gain_max", 0.0 if "rubbing" in kind else -np.inf))]
            special = [part for part in ("friction", "dilatation") if f"history/heat_{part}" in file]
            heat = [np.max(np.abs(file[f"history/heat_{part}"][:])) for part in special]
        assert len(special) == ("rubbing" in kind) + ("dilating" in kind)
        assert all(part > 0.5 for part in heat)
    note_changes(rod(pellets, "FULL", kind), rod(pellets, "SPARSE", kind))
    full = found["FULL"]
    assert 0 < np.sum(full["status"] > 0) < len(full["status"])
    assert_same(found["SPARSE"], full)
    assert np.max(np.abs(np.subtract(gains["SPARSE"], gains["FULL"]))) <= 1e-3


@pytest.mark.parametrize("kind", MOTIONS)
def test_small_motions_on_a_sparse_tail_are_those_with_the_full_matrix(tmp_path, kind):
    """Rates and periods of the leading motions, the fastest one, and that none can grow."""
    found = {}
    for tail in ("FULL", "SPARSE"):
        with h5py.File(solve(write(tmp_path / f"{tail}.inp", rod(3, tail, kind)))) as file:
            found[tail] = {name: values[:] for name, values in file["stability"].items()}
            found[tail]["mode"] = file["VTKHDF/PointData/mode_temperature"][:]
    full, sparse = found["FULL"], found["SPARSE"]
    assert full.pop("certain") == ("tables" not in kind)
    # The bound of the gain beside heat of friction is above 1.
    assert sparse["certain"] == (kind in ("transient", "mortar transient"))
    assert np.all(full["growth_rates"] < 0.0)
    for name, values in full.items():
        assert sparse[name] == pytest.approx(values, rel=1e-6, abs=1e-6, nan_ok=True), name


@pytest.mark.parametrize("tail", ["FULL", "SPARSE"])
@pytest.mark.parametrize(("base", "offset"), [(1700.0, 0.0), (0.0, 1e-12), (0.0, 1e-8), (0.0, 1e-4)])
def test_mortar_points_that_all_but_form_cycles_act_as_cycles(tmp_path, tail, base, offset):
    """Nothing depends on where a rod is, and no more than in proportion on a small offset.

    Wall, wall and end of two pellets make a cycle where the nodes of the tube are opposite theirs.
    """
    exact = contact_of(solve(write(tmp_path / "exact.inp", rod(4, tail, "mortar"))))
    deck = write(tmp_path / "moved.inp", rod(4, tail, "mortar", starts=(base, base + offset)))
    moved = contact_of(solve(deck))
    part = offset / (HEIGHT / ALONG)
    assert np.array_equal(exact["status"], moved["status"])
    for name in ("pressure", "shear", "heat_flux", "gap"):
        scale = np.max(np.abs(exact[name]))
        assert moved[name] == pytest.approx(exact[name], rel=0, abs=(1e-8 + 100 * part) * scale), name


def test_forces_on_every_pellet_balance(tmp_path):
    """What presses on its top and what its wall takes leave what it presses on the next with."""
    pellets = 12
    result = solve(write(tmp_path / "rod.inp", rod(pellets, "SPARSE")))
    with h5py.File(result) as file:
        contact = file["contact"]
        press = [PRESS * np.pi * 4.1**2]
        press += [contact[f"E{k}"]["normal_force"][-1] for k in range(pellets - 1, 0, -1)]
        wall = [contact[f"W{k}"]["shear_force"][-1] for k in range(pellets - 1, 0, -1)]
    for above, below, taken in zip(press[:-1], press[1:], wall, strict=True):
        assert abs(abs(below - above) - abs(taken)) <= 1e-9 * max(press)


def test_a_rod_of_many_pellets_has_a_sparse_tail(tmp_path):
    """Without *SOLVER; a full matrix of its contact unknowns would need thirty times the memory."""
    sizes = {}
    for tail in (None, "FULL"):
        deck = write(tmp_path / f"{tail}.inp", rod(200, tail))
        text = run("check", deck).stdout
        sizes[tail] = float(text.split("memory of a run")[1].split()[1])
    assert 10 * sizes[None] < sizes["FULL"]
    deck = write(tmp_path / "rod.inp", rod(25))
    with h5py.File(solve(deck)) as file:
        assert file["run"].attrs["solver"] == "SKYLINE, sparse tail"


def test_the_listing_of_many_interfaces_tells_the_largest_and_where_the_rest_is(tmp_path):
    """Every interface only at the end of the step; contact points where *CONTACT PRINT asks."""
    pellets, interfaces = 15, 29
    cards = rod(pellets)
    process = run("run", deck := write(tmp_path / "short.inp", cards), "--out", tmp_path)
    assert len(process.stdout.splitlines()) < 20
    listing = deck.with_suffix(".lst").read_text()
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        contact = file["contact"]
        for name in ("normal_force", "shear_force", "heat_rate"):
            values = {pair: contact[pair][name][:] for pair in contact}
            for increment, head in ((0, "INCREMENT 1 "), (-1, "SUMMARY")):
                block = listing.split(head)[1].split("INCREMENT ")[0]
                line = next(line for line in block.splitlines() if name.replace("_", " ") in line)
                told = line.split(name.replace("_", " "))[1].replace("(", " ").replace(")", "").split()
                found = values[told[1 if increment == 0 else -1]][increment]
                assert abs(found) == max(abs(each[increment]) for each in values.values())
                assert float(told[0]) == pytest.approx(found, rel=1e-5)
        states = np.concatenate([contact[pair]["status"][0] for pair in contact])
    counts = "   ".join(f"{zone} {np.sum(states == k)}" for k, zone in enumerate(("I", "II", "III")))
    assert f"{interfaces} interfaces   {counts}" in listing
    blocks = listing.split("INCREMENT ")
    assert len(blocks[1].splitlines()) < 12
    assert blocks[-1].count("edge of contact") == interfaces
    assert listing.count("   INTERFACE ") == 2
    assert "ZONE DIAGRAM OF" not in listing
    assert "*CONTACT PRINT" in listing.split("ZONE DIAGRAMS")[1].split("WARNINGS")[0]
    place = cards.index("*END STEP")
    deck = write(tmp_path / "long.inp", [*cards[:place], "*CONTACT PRINT, FREQUENCY=2", *cards[place:]])
    solve(deck)
    listing = deck.with_suffix(".lst").read_text()
    assert listing.count("ZONE DIAGRAM OF") == interfaces
    assert listing.count("CONTACT POINTS OF") == 2 * interfaces


def test_listing_and_result_grow_with_the_rod(tmp_path):
    sizes = {}
    for pellets in (20, 40):
        deck = write(tmp_path / f"{pellets}.inp", rod(pellets))
        solve(deck)
        sizes[pellets] = [deck.with_suffix(kind).stat().st_size for kind in (".lst", ".vtkhdf")]
    # The trees of HDF5 that find the groups of interfaces grow a little faster than the file.
    assert all(large < 2.05 * small for small, large in zip(sizes[20], sizes[40], strict=True)), sizes


def test_many_pairs_that_slide_too_far_are_warned_of_in_six_lines(tmp_path):
    deck = write(tmp_path / "rod.inp", rod(12, expansion=2e-4, friction=0.0))
    process = run("run", "--quiet", deck, "--out", tmp_path)
    last = [line for line in process.stderr.splitlines() if "slide" in line and "increment" in line]
    named = {line.split("contact pair ")[1].split()[0] for line in last if "contact pair " in line}
    further = [line for line in last if "further contact pairs slide too far" in line]
    assert named
    assert len(named) <= 4 * 5
    assert further


def test_many_pairs_that_never_close_are_warned_of_in_six_lines(tmp_path):
    deck = write(tmp_path / "rod.inp", rod(12, expansion=1e-9))
    told = [line for line in run("run", "--quiet", deck, "--out", tmp_path).stderr.splitlines() if " never " in line]
    assert len(told) == 6
    assert "7 further contact pairs never close" in told[-1]


def test_newtons_method_follows_where_mixing_fails(tmp_path):
    """The heat that crosses opens the face that it crosses: no mixing of conductances converges."""
    found = {}
    for tail in ("FULL", "SPARSE"):
        deck = copy_deck(COUPLED, tmp_path / f"{tail}.inp", [f"*SOLVER, TAIL={tail}"])
        found[tail] = contact_of(solve(deck))
    scale = np.max(found["FULL"]["pressure"])
    assert found["SPARSE"]["pressure"] == pytest.approx(found["FULL"]["pressure"], rel=0,
                                                        abs=1e-7 * scale)


@pytest.mark.parametrize(("kind", "passes"), [("CAX4", 6), ("tables", 4), ("transient", 6), ("rubbing", 6),
                                              ("rubbing tables", 4)])
def test_newtons_steps_from_products_lead_where_those_of_a_matrix_lead(tmp_path, kind, passes):
    """Too few passes for mixing are enough for Newton's method, whose steps halve no residual."""
    found, cards = {}, {tail: rod(4, tail, kind) for tail in ("FULL", "SPARSE")}
    for tail, most in (("FULL", 50), ("SPARSE", passes)):
        place = cards[tail].index("*FIXED POINT, TOL=1E-12")
        cards[tail][place] += f", METHOD=NEWTON, MAXITER={most}"
        deck = write(tmp_path / f"{tail}.inp", cards[tail])
        found[tail] = contact_of(solve(deck))
    rows = [line.split() for line in deck.with_suffix(".cvg").read_text().splitlines()[1:]]
    newton = [row for row in rows if float(row[4]) == 1.0]
    assert newton
    assert sum(float(row[2]) <= 1e-12 for row in newton) >= len(newton) // 4
    assert_same(found["SPARSE"], found["FULL"])


def stack(tail, expansions, width, law, gap, temperatures, source):
    """Return the cards of plates above each other with jumping conductances at their gaps, ends with
    temperatures, and sources between them that heat and cool. Their NEWTON may take 20 passes."""
    names, (a, b, touch, c) = [f"B{k}" for k in range(len(expansions))], law
    cards = [card for k, name in enumerate(names) for card in [
        *mesh(name, np.linspace(0, width, 3), [k, k + 0.5, k + 1], "CPE4", first=100 * k + 1),
        *material(name, (2e5, 0.3), expansions[k], 20.0)]]
    cards += ["*SURFACE INTERACTION, NAME=G", "*FRICTION", "0.1", "*GAP LAW, TYPE=GAS", f"{a}, {b}",
              "*GAP LAW, TYPE=POWER", f"{touch}, {c}, 1."]
    for upper, lower in zip(names[1:], names, strict=False):
        cards += [f"*CONTACT PAIR, INTERACTION=G, NAME={upper}", f"{upper}.BOTTOM, {lower}.TOP",
                  f"*CLEARANCE, MASTER={lower}.TOP, SLAVE={upper}.BOTTOM, VALUE={gap}"]
    return ["*OPTIONS, ERRORS=NO", *cards, f"*SOLVER, TAIL={tail}",
            "*FIXED POINT, METHOD=NEWTON, MAXITER=20, TOL=1E-11",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", *[f"{name}, 0." for name in names],
            "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.", "*BOUNDARY",
            *[f"{name}.LEFT, 1" for name in names], *[f"{name}.BOTTOM, 2" for name in names],
            f"{names[-1]}.TOP, 2", f"{names[0]}.BOTTOM, 11, 11, {temperatures[0]}",
            f"{names[-1]}.TOP, 11, 11, {temperatures[1]}", "*DFLUX",
            *[f"{name}, BF, {source * (-1)**k}" for k, name in enumerate(names[1:-1])], "*END STEP"]


@pytest.mark.parametrize("plates", [
    ((1e-5, 4e-5, 4e-5, 2e-5, 0.0), 2.0, (9.6e-4, 1e-5, 78.0, 0.11), 1.7e-5, (0.0, -500.0), 790.0),
    ((0.0, 4e-5, 2e-5, 4e-5, 1e-5), 2.0, (2.1e-3, 5.4e-6, 390.0, 0.429), 3.1e-5, (0.0, -500.0), 4100.0)])
def test_the_path_on_a_sparse_tail_leads_where_that_with_the_full_matrix_leads(tmp_path, plates):
    found = {}
    # On a sparse tail mixing comes before Newton's method, with as many passes.
    for tail, without_path in (("FULL", 20), ("SPARSE", 40)):
        deck = write(tmp_path / f"{tail}.inp", stack(tail, *plates))
        found[tail] = contact_of(result := solve(deck))
        with h5py.File(result) as file:
            assert file["history/iterations"][-1] > without_path
    assert_same(found["SPARSE"], found["FULL"])


def test_a_path_leads_on_where_the_heat_of_newtons_steps_runs_away(tmp_path):
    plates = ((1e-5, 2e-5, 0.0, 1e-5, 0.0, 2e-5), 2.0, (8.6e-6, 3.4e-6, 3.8, 2.9e-3), 1.2e-5,
              (-500.0, -500.0), 1400.0)
    found = {}
    for tail in ("FULL", "SPARSE"):
        cards = [card.replace(", MAXITER=20", "") for card in stack(tail, *plates)]
        found[tail] = contact_of(solve(write(tmp_path / f"{tail}.inp", cards)))
    assert_same(found["SPARSE"], found["FULL"])


def test_a_full_matrix_that_is_too_large_is_refused_with_its_reason(tmp_path):
    cards = rod(100)
    place = cards.index("*SFILM")
    cards[place:place + 2] = []
    place = cards.index("*STEP")
    cards[place:place + 3] = ["*BOUNDARY", "TUBE.RIGHT, 11", *cards[place:place + 3], "*CONTINUATION"]
    deck = write(tmp_path / "rod.inp", cards)
    limit = 2000 * 2**20
    process = subprocess.run(
        [os.environ["THERCON"], "check", deck], capture_output=True, text=True, check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
    assert process.returncode == 3
    assert re.search(r"the run needs about \d{4,} MB and may use \d+ MB \(.+\); \*CONTINUATION "
                     "needs derivatives between all contact points", process.stderr)


def test_what_needs_the_full_matrix_is_refused_on_a_sparse_tail(tmp_path):
    cards = rod(3, "SPARSE")
    place = cards.index("*STEP") + 3
    cards[place:place] = ["*CONTINUATION"]
    process = run("check", write(tmp_path / "rod.inp", cards))
    assert process.returncode == 1
    assert "TAIL=SPARSE does not go with *CONTINUATION" in process.stderr + process.stdout


def test_bodies_that_move_together_are_named_in_few_words(tmp_path):
    names = [f"B{k}" for k in range(5)]
    cards = [card for k, name in enumerate(names) for card in [
        *mesh(name, [0, 1], [k, k + 1], "CPE4", first=100 * k + 1), *material(name, (1e5, 0.3))]]
    cards += ["*SURFACE INTERACTION, NAME=G", "*FRICTION", "0.3"]
    for upper, lower in zip(names[1:], names, strict=False):
        cards += [f"*CONTACT PAIR, INTERACTION=G, NAME={upper}", f"{upper}.BOTTOM, {lower}.TOP"]
    deck = write(tmp_path / "pile.inp", [*cards, "*STEP", "*STATIC", "*BOUNDARY", "B0.BOTTOM, 2",
                                         "*DSLOAD", "B4.TOP, P, 1.", "*END STEP"])
    process = run("check", deck)
    assert "can move along x together with bodies 2 to 5: no *BOUNDARY" in process.stderr
