"""Numerical uncertainties of a run against true errors that are known in closed form."""

import re
import shutil

import h5py
import numpy as np
import pytest
from blocks import block, solid, without_unused_surfaces, write
from deck_runs import CYLINDER, HERTZ, INPUT, copy_deck, run
from deck_runs import solve_as_written as solve
from physics import material, mesh, nodes_of   # puts tests/reference on the path, too

import rods

PRESS_FIT = INPUT / "examples" / "press_fit.inp"
FINE = 3   # refinements behind which the mesh's error is a thousandth of that of the deck's
FACTOR = 3 / (2**0.8 - 1)   # of a change, which makes it the uncertainty of a number
FULL = "*OPTIONS, ERRORS=FULL"


def errors(result, face):
    """Return the rows of /uncertainty at the end of a run: value, uncertainty, change, scatter,
    iteration."""
    with h5py.File(result) as file:
        return {name: data[-1] for name, data in file[f"uncertainty/{face}"].items()}


def bare(source, folder, name, cards=(), changes=()):
    """Copy a deck without its checks."""
    deck = copy_deck(source, folder / name, cards, changes)
    deck.write_text(deck.read_text().split("*VERIFY")[0])
    for part in (part for end in ("mesh", "inc", "step") for part in source.parent.glob(f"*.{end}")):
        shutil.copy(part, folder)
    return deck


def test_error_of_the_mesh_where_it_is_smooth(tmp_path):
    """The force of a press fit converges with h^4: a mesh with three refinements is exact beside
    it. A single increment without friction and heat tells neither scatter nor iteration."""
    coarse = errors(solve(bare(PRESS_FIT, tmp_path, "coarse.inp")), "SEAT")
    fine = errors(solve(bare(PRESS_FIT, tmp_path, "fine.inp", [f"*REFINE, LEVELS={FINE}"])), "SEAT")
    value, uncertainty, change, scatter, iteration = coarse["normal_force"]
    true = abs(fine["normal_force"][0] - value)
    assert true <= change <= FACTOR * true
    assert scatter == iteration == 0.0 and uncertainty == change


def test_error_of_hertz_peak_pressure(tmp_path):
    """Printed and true error of the deck's peak against its next refinements."""
    changes = {"*REFINE, LEVELS=1": "*REFINE, LEVELS=0"}
    coarse = errors(solve(bare(HERTZ, tmp_path, "coarse.inp", changes=changes)), "FACE")
    changes = {"*REFINE, LEVELS=1": "*REFINE, LEVELS=2"}
    fine = solve(bare(HERTZ, tmp_path, "fine.inp", ["*OPTIONS, ERRORS=NO"], changes))
    with h5py.File(fine) as file:
        peak = file["contact/FACE/pressure"][-1].max()
        edge = file["contact/FACE/edge_contact"][-1]
    value, uncertainty, *_ = coarse["peak_pressure"]
    assert uncertainty / FACTOR <= abs(peak - value) <= uncertainty
    value, uncertainty, *_ = coarse["edge_contact"]
    assert abs(edge - value) <= uncertainty


def bent_on_a_block(path, friction, cards=(), held="B.BOTTOM"):
    """Write a deck with two blocks of one row each, the upper one bent by heat until it touches in part:
    all elements are at the faces."""
    lines = np.linspace(0.0, 4.0, 9)
    return write(path, without_unused_surfaces([
        *block("A", lines, [1.0, 2.0]), *block("B", lines, [0.0, 1.0], first=1001),
        *solid("A", 1000.0, 0.3, 1e-4, 5.0), *solid("B", 1000.0, 0.3, 0.0, 5.0),
        "*SURFACE INTERACTION, NAME=I", *friction, "*GAP CONDUCTANCE", "1., 0.", "50., 5.",
        "*CONTACT PAIR, INTERACTION=I, NAME=P", "A.BOTTOM, B.TOP",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "A, 0.", "B, 0.", *cards,
        "*BOUNDARY", "A.LEFT, 1", "B.LEFT, 1", f"{held}, 2", "A.TOP, 2", f"{held}, 11", "*STEP",
        "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.",
        "*BOUNDARY", "A.LEFT, 11, 11, 200.", "A.RIGHT, 11, 11, -100.", "*END STEP"]))


@pytest.mark.parametrize("held", ["B.BOTTOM", "B"])
@pytest.mark.parametrize("friction", [["*FRICTION", "0.3"], []])
def test_change_of_a_complete_finer_run(tmp_path, friction, held):
    """With ERRORS=FULL it is that to a deck with all elements and increments halved, also where one
    body is held at all of its nodes."""
    halved = bent_on_a_block(tmp_path / "fine.inp", friction, ["*REFINE, LEVELS=1"], held)
    halved.write_text(halved.read_text().replace("\n1., 1.\n*BOUNDARY", "\n0.5, 1.\n*BOUNDARY"))
    coarse = errors(solve(bent_on_a_block(tmp_path / "coarse.inp", friction, [FULL], held)), "P")
    fine = errors(solve(halved), "P")
    assert 1.0 < coarse["edge_contact"][0] < 3.0
    for name in ("normal_force", "heat_rate", "peak_pressure", "shear_force")[:4 if friction else 3]:
        value, uncertainty, change, *_ = coarse[name]
        assert FACTOR * abs(fine[name][0] - value) == pytest.approx(change, rel=1e-6), name
        assert 0.0 < change <= uncertainty


@pytest.mark.parametrize("held", ["B.BOTTOM", "B"])
def test_change_of_the_last_increment_alone(tmp_path, held):
    """Without friction it is nearly that to a run with all elements halved: those that stay whole, as far
    from the faces, hold 0.05 of the squared errors."""
    coarse = errors(solve(bent_on_a_block(tmp_path / "coarse.inp", [], held=held)), "P")
    fine = errors(solve(bent_on_a_block(tmp_path / "fine.inp", [], ["*REFINE, LEVELS=1"], held)), "P")
    for name in ("normal_force", "heat_rate", "peak_pressure"):
        value, _, change, *_ = coarse[name]
        assert FACTOR * abs(fine[name][0] - value) == pytest.approx(change, rel=0.05), name


def test_a_body_without_stress_has_no_rounding_of_it(tmp_path):
    """Elements round the place of the largest stress are divided: that of rounding is another one on
    each processor."""
    body = errors(solve(bent_on_a_block(tmp_path / "held.inp", [], held="B")), "body 2")
    value, _, change, *_ = body["von_mises"]
    assert value == change == 0.0


def test_a_later_step_divides_the_elements_at_its_contact(tmp_path):
    """A block is pressed at its left end, then at its right one; without friction it does not remember
    the first step: the uncertainties are those of a deck with the second alone."""
    def deck(name, *steps):
        lines = np.linspace(0.0, 4.0, 9)
        cards = [*block("A", lines, [1.0, 1.5, 2.0, 2.5]), *block("B", lines, [0.0, 0.5, 1.0], first=1001),
                 *solid("A", 1000.0, 0.3), *solid("B", 1000.0, 0.3), "*SURFACE INTERACTION, NAME=I",
                 "*CONTACT PAIR, INTERACTION=I, NAME=P", "A.BOTTOM, B.TOP",
                 "*BOUNDARY", "A.LEFT, 1", "B.BOTTOM, 1, 2"]
        for element in steps:
            cards += ["*STEP", "*STATIC, DIRECT", "1., 1.", "*DLOAD, OP=NEW", f"{element}, P3, 10.",
                      "*END STEP"]
        return write(tmp_path / f"{name}.inp", without_unused_surfaces(cards))

    left, right = 17, 24
    both = errors(solve(deck("both", left, right)), "P")
    one = errors(solve(deck("one", right)), "P")
    for name, (value, uncertainty, *_) in one.items():
        if not np.isnan(value):
            assert both[name][0] == pytest.approx(value, rel=1e-9), name
            assert both[name][1] == pytest.approx(uncertainty, rel=1e-6), name


@pytest.mark.parametrize("friction", [["*FRICTION", "0.3"], []])
@pytest.mark.parametrize("order", [[FULL], [f"{FULL}, ORDER=1"]], ids=["order 2", "order 1"])
def test_mesh_of_a_model_with_equations(tmp_path, friction, order):
    """All nodes of the top move as one that is held: the uncertainties are those of a top that is held
    itself, but that its new nodes hang along x and in temperature, too: of linear elements that
    moves the peak."""
    is_linear = "ORDER=1" in order[0]
    plain = bent_on_a_block(tmp_path / "plain.inp", friction, order)
    top = [node for node, (x, y) in nodes_of(plain.read_text().splitlines()).items()
           if y == 2.0 and not (is_linear and 2 * x % 1)]   # which are corners, 0.5 apart
    equations = "".join(f"2\n{node}, 2, 1., 1050, 2, -1.\n" for node in top)
    cards = plain.read_text().replace("*ELEMENT", "*NODE\n1050, 2., 3.\n*ELEMENT", 1).replace(
        "*SURFACE INTERACTION", f"*EQUATION\n{equations}*SURFACE INTERACTION", 1)
    assert "A.TOP, 2\n" in cards
    (tmp_path / "equations.inp").write_text(cards.replace("A.TOP, 2\n", "1050, 2\n", 1))
    held, led = errors(solve(plain), "P"), errors(solve(tmp_path / "equations.inp"), "P")
    for name in ("normal_force", "heat_rate", "edge_contact", "peak_pressure")[:3 if is_linear else 4]:
        assert led[name][0] == pytest.approx(held[name][0], rel=1e-9), name
        assert led[name][2] == pytest.approx(held[name][2], rel=0.05), name


@pytest.mark.parametrize("steps", [1, 2])
def test_no_step_has_uncertainties_where_the_finer_mesh_does_not_match(tmp_path, steps):
    """A midside node of the base is moved along it: what the finer mesh adds is not opposite each
    other any more."""
    deck = bare(CYLINDER, tmp_path, "moved.inp", ["*REFINE, LEVELS=1, SURFACE=CURVED"],
                {"1008, 3.1, 0": "1008, 3.25, 0", "\n20., 900.": "\n450., 900."})
    step = deck.read_text()[deck.read_text().index("*STEP"):]
    deck.write_text(deck.read_text() + step * (steps - 1))
    result = solve(deck)
    with h5py.File(result) as file:
        assert np.isnan(file["uncertainty/FACE/normal_force"][:, 1]).tolist() == [True] * steps
    assert result.with_suffix(".lst").read_text().count(
        "numerical uncertainties cannot be estimated: contact pair FACE: slave node") == steps


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
def test_the_summary_says_that_a_peak_at_an_end_may_have_no_limit(tmp_path, pairing):
    """Two blocks of different materials that end together, stuck under a rigid plate: not two of the same
    material, whose pressure is uniform, nor Hertz's contact, whose peak is on the plane of symmetry."""
    def summary(deck):
        return run("run", deck, "--out", tmp_path).stdout

    lines = np.linspace(0.0, 4.0, 9)
    said = {}
    for name, young in (("unlike", 300.0), ("alike", 1000.0)):
        cards = [*block("A", lines, [1.0, 1.5, 2.0]), *block("B", lines, [0.0, 0.5, 1.0], first=1001),
                 *solid("A", young, 0.3), *solid("B", 1000.0, 0.3), FULL,
                 "*SURFACE INTERACTION, NAME=I", "*FRICTION", "10.",
                 f"*CONTACT PAIR, INTERACTION=I, NAME=P, PAIRING={pairing}",
                 "A.BOTTOM, B.TOP", "*BOUNDARY", "A.LEFT, 1", "B.LEFT, 1", "B.BOTTOM, 2",
                 "A.TOP, 2, 2, -0.01", "*STEP", "*STATIC", "0.5, 1.", "*END STEP"]
        said[name] = summary(write(tmp_path / f"{name}.inp", without_unused_surfaces(cards)))
    words = ", at an end, where it may have no limit\n"
    assert re.search(rf"peak pressure +\S+ \+- .+{words}", said["unlike"])
    assert "no limit" not in said["alike"] + summary(bare(HERTZ, tmp_path, "hertz.inp"))


def punched(name, first, shift=0.0, scale=1.0, side=1):
    """Return the cards of a punch on a wider block, named after the joint, and their supports: the
    edge of the punch is at its right or, mirrored (side=-1), at its left."""
    def xs(*places):
        return sorted(shift + side * x for x in places)

    top, base, middle = f"{name}P", f"{name}B", "LEFT" if side > 0 else "RIGHT"
    cards = [*mesh(top, xs(0.0, 0.4, 0.7, 1.0), [0.0, 0.5, 1.0], "CPE4", first=first),
             *mesh(base, xs(0.0, 0.4, 0.7, 1.0, 1.5, 3.0), [-2.0, -1.0, -0.4, 0.0], "CPE4",
                   first=first + 100),
             *material(top, (100.0 * scale, 0.3)), *material(base, (50.0 * scale, 0.3)),
             f"*CONTACT PAIR, INTERACTION=I, NAME={name}", f"{top}.BOTTOM, {base}.TOP"]
    return cards, [f"{base}.BOTTOM, 1, 2", f"{top}.{middle}, 1", f"{base}.{middle}, 1",
                   f"{top}.TOP, 2, 2, -0.01"]


def punches(path, *joints, law=(), behind=(), moved=()):
    """Solve a deck of joints with a law, cards behind them, and more supports; return the
    uncertainties of each."""
    cards, held = (sum(parts, []) for parts in zip(*(punched(*joint) for joint in joints), strict=True))
    result = solve(write(path, without_unused_surfaces([
        *([FULL] if law else []), "*SURFACE INTERACTION, NAME=I", *law, *cards, *behind]), [
        "*STEP", "*STATIC", "0.25, 1.", "*BOUNDARY", *held, *moved, "*END STEP"]))
    return {name: errors(result, name) for name, *_ in joints}


def test_every_joint_of_a_model_has_uncertainties_of_its_own(tmp_path):
    """Beside one of four times its modulus, whose forces and their errors are four times as large, it
    has that which it has alone."""
    alone = punches(tmp_path / "alone.inp", ("B", 1))["B"]["normal_force"]
    both = punches(tmp_path / "both.inp", ("A", 1001, 10.0, 4.0), ("B", 1))
    assert alone[1] > 0.0
    np.testing.assert_allclose(both["B"]["normal_force"][:2], alone[:2], rtol=1e-6)
    np.testing.assert_allclose(both["A"]["normal_force"][:2], 4.0 * alone[:2], rtol=1e-6)


def test_a_joint_that_closes_late_has_its_own_uncertainty_beside_one_that_is_closed(tmp_path):
    """It slides until it closes within the last increment."""
    late = {"law": ["*FRICTION", "5."], "moved": ["BP.LEFT, 1, 1, 0.004"],
            "behind": ["*CLEARANCE, SLAVE=BP.BOTTOM, MASTER=BB.TOP, VALUE=0.0085"]}
    alone = punches(tmp_path / "alone.inp", ("B", 1), **late)["B"]["shear_force"]
    both = punches(tmp_path / "both.inp", ("A", 1001, 10.0), ("B", 1), **late)["B"]["shear_force"]
    assert 0.0 < alone[1] < abs(alone[0])
    np.testing.assert_allclose(both[:2], alone[:2], rtol=1e-6)


def test_heat_across_an_open_gap_has_the_same_uncertainty_beside_a_closed_joint(tmp_path):
    """Where nothing is closed, all elements at the faces are divided."""
    parts = {"B": [], "A": []}
    held = {"B": ["BU.LEFT, 11, 11, 100.", "BL.BOTTOM, 11, 11, 0.", "BU.TOP, 2"],
            "A": ["AU, 11", "AL, 11", "AU.TOP, 2, 2, -0.01"]}
    for name, first, gap in ("B", 1, 0.1), ("A", 1001, 0.0):
        xs = [first + x for x in (0.0, 0.5, 1.0, 2.0)]
        parts[name] += [*mesh(f"{name}U", xs, [gap, gap + 0.5, gap + 1.0], "CPE4", first=first),
                        *mesh(f"{name}L", xs, [-1.0, -0.5, 0.0], "CPE4", first=first + 100),
                        f"*CONTACT PAIR, INTERACTION=I, NAME={name}",
                        f"{name}U.BOTTOM, {name}L.TOP"]
        for body in f"{name}U", f"{name}L":
            parts[name] += [*material(body, (1000.0, 0.0), 0.0, 1.0),
                            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"{body}, 0."]
            held[name] += [f"{body}, 1"]
        held[name] += [f"{name}L.BOTTOM, 2"]
    found = [errors(solve(write(tmp_path / f"{names}.inp", without_unused_surfaces([
        "*SURFACE INTERACTION, NAME=I", "*GAP LAW, TYPE=GAS", "0.5, 0.1", "*GAP LAW, TYPE=POWER",
        "5., 0., 1.", *sum((parts[name] for name in names), [])]), [
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.", "*BOUNDARY",
        *sum((held[name] for name in names), []), "*END STEP"])), "B")["heat_rate"][:2]
        for names in ("B", "BA")]
    assert 0.01 * found[0][0] < found[0][1]
    np.testing.assert_allclose(found[1], found[0], rtol=1e-6)


def test_uncertainties_are_the_same_whichever_face_is_the_slave(tmp_path):
    """Where the same nodes are opposite each other: elements on both sides are divided."""
    deck = bent_on_a_block(tmp_path / "deck.inp", [])
    cards, found = deck.read_text(), []
    for pair in "A.BOTTOM, B.TOP", "B.TOP, A.BOTTOM":
        deck.write_text(cards.replace("NAME=P\nA.BOTTOM, B.TOP",
                                      f"NAME=P, PAIRING=SURFACES\n{pair}"))
        found.append(errors(solve(deck), "P")["normal_force"][:2])
    assert found[0][1] > 0.0
    np.testing.assert_allclose(found[1], found[0], rtol=1e-6)


def test_a_mirrored_punch_has_the_same_uncertainty(tmp_path):
    punch = punches(tmp_path / "punch.inp", ("B", 1))["B"]
    mirrored = punches(tmp_path / "mirrored.inp", ("B", 1, 0.0, 1.0, -1))["B"]
    np.testing.assert_allclose(mirrored["normal_force"][:2], punch["normal_force"][:2], rtol=1e-6)


def test_the_uncertainty_holds_what_a_past_out_of_equilibrium_leaves(tmp_path):
    """Heat from a film and a source flows along y, which linear elements solve, behind a start that
    it is not at rest in."""
    deck = [*mesh("UP", [0.0, 1.0], [0.0, 1.0], "CPE4"),
            *mesh("LOW", [0.0, 1.0], [-1.0, 0.0], "CPE4", first=101)]
    for name in "UP", "LOW":
        deck += material(name, (1000.0, 0.0), 0.0, 2.0)
    result = solve(write(tmp_path / "deck.inp", [
        "*THERMAL SCHEME, TYPE=CRANK-NICOLSON", *deck, "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
        "UP, 40.", "LOW, 0.", "*SURFACE INTERACTION, NAME=I", "*GAP LAW, TYPE=POWER", "3., 0., 1.",
        "*CONTACT PAIR, INTERACTION=I, NAME=FACE", "UP.BOTTOM, LOW.TOP", "*STEP",
        "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.", "*BOUNDARY", "UP, 1",
        "LOW, 1", "LOW.BOTTOM, 2", "LOW.BOTTOM, 11, 11, 0.", "*SFILM", "UP.TOP, F, 100., 4.",
        "*DSFLUX", "UP.TOP, S, 6.", "*DSLOAD", "UP.TOP, P, 5.", "*END STEP"]))
    value, uncertainty, *_ = errors(result, "FACE")["heat_rate"]
    at_rest = (100.0 + 6.0 / 4.0) / (1 / 2 + 1 / 3 + 1 / 2 + 1 / 4)
    assert 0.1 * at_rest < abs(value - at_rest) <= uncertainty


def test_an_amplitude_moves_the_new_nodes_of_its_own_side_alone(tmp_path):
    """Half of twice the way, given node by node on a side of divided elements, beside another one
    that is held without an amplitude: the uncertainties of the way itself."""
    cards = [*mesh("P", [0.0, 0.4, 0.7, 1.0], [0.0, 0.5], "CPE4"), *material("P", (100.0, 0.3)),
             *mesh("B", [0.0, 0.4, 0.7, 1.0, 1.5, 3.0], [-1.0, 0.0], "CPE4", first=101),
             *material("B", (50.0, 0.3)), "*SURFACE INTERACTION, NAME=I",
             "*CONTACT PAIR, INTERACTION=I, NAME=FACE", "P.BOTTOM, B.TOP",
             "*AMPLITUDE, NAME=HALF", "0., 0., 1., 0.5"]
    held = ["*BOUNDARY", "B.BOTTOM, 1, 2", "P.LEFT, 1", "B.LEFT, 1"]
    top = [node for node, (_, y) in nodes_of(cards).items() if y == 0.5]
    plain, moved = (errors(solve(write(tmp_path / f"{name}.inp", without_unused_surfaces(cards), [
        "*STEP", "*STATIC", "0.25, 1.", *held, *way, "*END STEP"])), "FACE") for name, way in (
            ("plain", [f"{node}, 2, 2, -0.01" for node in top]),
            ("moved", ["*BOUNDARY, AMPLITUDE=HALF", *(f"{node}, 2, 2, -0.02" for node in top)])))
    assert plain["normal_force"][1] > 0.0
    np.testing.assert_allclose(moved["normal_force"][:2], plain["normal_force"][:2], rtol=1e-6)


def test_the_uncertainty_of_a_temperature_holds_the_error_of_elements_far_away(tmp_path):
    """A ring heated within, T = T(R) + q r ln(R/r)/k: its side towards the middle is fine, the
    others are not. Where it is cooled, its largest temperature is given."""
    inner, outer = 1.0, 9.0
    radii = [inner, 1.02, 1.04, 1.06, 1.08, 3.0, outer]

    def largest(flux, given):
        return errors(solve(write(
            tmp_path / f"ring{flux}{given}.inp", mesh("RING", radii, [0.0, 0.02], "CAX4"),
            material("RING", conductivity=2.0), [
                "*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY",
                f"RING.RIGHT, 11, 11, {given!r}", "*DSFLUX", f"RING.LEFT, S, {flux!r}",
                "*END STEP"])), "body 1")["temperature"][:2]

    value, uncertainty = largest(5.0, 0.0)
    assert 0.0 < abs(value - 5.0 * inner * np.log(outer / inner) / 2.0) <= uncertainty
    # Rounding of 300 among elements that are 300 times as long as high.
    np.testing.assert_allclose(largest(5.0, 300.0), [300.0 + value, uncertainty], rtol=1e-7)
    assert tuple(largest(-5.0, 300.0)) == (300.0, 0.0)


def test_every_body_has_its_own_stress_and_singular_corners(tmp_path):
    """Two plates, each held on its first side below, whose ends are singular; the second one is
    pulled twice as much."""
    cards, held, pull = [], [], []
    for name, first, load in ("A", 1, -1.0), ("B", 101, -2.0):
        xs = np.linspace(first, first + 2.0, 5)
        cards += [*mesh(name, xs, [0.0, 0.5, 1.0], "CPE4", first=first),
                  *material(name, (1000.0, 0.3))]
        held += [f"{first}, 1, 2", f"{first + 1}, 1, 2"]
        pull += [f"{name}.TOP, P, {load!r}"]
    deck = write(tmp_path / "deck.inp", cards, [
        "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", *held, "*DSLOAD", *pull, "*END STEP"])
    shown = run("run", deck, "--out", tmp_path).stdout
    one, two = (errors(deck.with_suffix(".vtkhdf"), f"body {b}")["von_mises"][:2] for b in (1, 2))
    np.testing.assert_allclose(two, 2.0 * one, rtol=1e-9)
    for body, named in zip(shown.split("largest in body")[1:], (["1", "2"], ["101", "102"]),
                           strict=True):
        assert re.findall(r"node (\d+)", body.partition("singular corner")[2]) == named


def test_the_uncertainty_holds_the_error_of_increments(tmp_path):
    """The explicit scheme is of the first order: its conductance is that of the last increment. The
    elements of the rods are exact."""
    cards = ["*THERMAL SCHEME, TYPE=EXPLICIT", FULL]
    for size in 0.25, 0.05:
        deck = bare(INPUT / "rods" / "r1.inp", tmp_path, "rods.inp", cards, {"\n1., 1.": f"\n{size}, 1."})
        value, uncertainty, *_ = errors(solve(deck), "FACE")["heat_rate"]
        assert abs(value - 48240.180765) <= uncertainty <= FACTOR * abs(value - 48240.180765)


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize("sides", [3, 6])
def test_friction_that_a_held_contact_point_lacks_is_in_the_uncertainty(tmp_path, pairing, sides):
    """A block expands on a held one, all of it slips away from the plane of symmetry: the shear force is
    mu times the normal force. The contact point in that plane is held, and its friction is missing."""
    lines = np.linspace(0.0, 3.0, sides + 1)
    cards = [*block("A", lines, [1.0, 1.5, 2.0]), *block("B", lines, [0.0, 0.5, 1.0], first=1001),
             *solid("A", 1000.0, 0.0, 1e-4), *solid("B", 1000.0, 0.0), FULL,
             "*SURFACE INTERACTION, NAME=I", "*FRICTION", "0.1",
             f"*CONTACT PAIR, INTERACTION=I, NAME=P, PAIRING={pairing}", "A.BOTTOM, B.TOP",
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "A, 0.", "B, 0.",
             "*BOUNDARY", "A.LEFT, 1", "B, 1, 2", "*STEP", "*STATIC, DIRECT", "0.05, 1.",
             "*DSLOAD", "A.TOP, P, 2.", "*TEMPERATURE", "A, 100.", "*END STEP"]
    found = errors(solve(write(tmp_path / "held.inp", without_unused_surfaces(cards))), "P")
    normal, (value, uncertainty, *_) = found["normal_force"][0], found["shear_force"]
    true = abs(0.1 * normal - abs(value))
    assert normal == pytest.approx(6.0)
    assert 0.01 * normal / sides < true <= uncertainty


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
def test_without_friction_the_shear_force_is_exact(tmp_path, pairing):
    """Normals of the finer mesh differ on a curved face: nothing of the pressure is friction."""
    changes = {"NAME=FACE": f"NAME=FACE, PAIRING={pairing}"}
    deck = bare(HERTZ, tmp_path, "smooth.inp", ["*REFINE, LEVELS=1, SURFACE=CURVED"], changes)
    value, uncertainty, *_ = errors(solve(deck), "FACE")["shear_force"]
    assert value == uncertainty == 0.0


@pytest.mark.parametrize("corner", [600, 720, 800])
def test_a_corner_of_an_amplitude_is_no_scatter(tmp_path, corner):
    """Heated to a corner inside the step and cooled from there on: the uncertainties are as large as those of a
    step that ends there and another one. They are taken over other increments, so not the same."""
    curve = [f"*AMPLITUDE, NAME=BENT\n0., 0., {corner}., 1.2, 900., 1."]
    bent = errors(solve(bare(CYLINDER, tmp_path, "bent.inp", curve, {
        "*BOUNDARY\nTOP, 11, 11, 900.": "*BOUNDARY, AMPLITUDE=BENT\nTOP, 11, 11, 900.\n*BOUNDARY"})),
        "FACE")
    text = bare(CYLINDER, tmp_path, "parts.inp").read_text()
    model, step = text.split("*STEP")
    parts = [step.replace("20., 900.", f"20., {time}.").replace("11, 11, 900.", f"11, 11, {top}")
             for time, top in ((corner, 1080), (900 - corner, 900))]
    (tmp_path / "parts.inp").write_text("*STEP".join([model, *parts]))
    apart = errors(solve(tmp_path / "parts.inp"), "FACE")
    for name, (value, *_) in bent.items():
        assert value == pytest.approx(apart[name][0], rel=1e-6), name
    # Of these scatter is the larger part. The finer mesh of the second step is that of the first.
    assert bent["edge_contact"][1] == pytest.approx(apart["edge_contact"][1], rel=0.3)
    assert 0.25 < bent["normal_force"][1] / apart["normal_force"][1] < 2.0


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize(("course", "increments"), [
    ("closes", 10), ("closes", 30), ("closes and opens and closes", 30)])
def test_a_whole_face_that_closes_or_opens_is_no_scatter(tmp_path, pairing, increments, course):
    """Two bars in plane strain, one above the other: a load at the end that fills the gap, as a ramp or
    with turns between the ends of the increments. The force is exact on every mesh."""
    lines = np.linspace(0.0, 1.0, 3)
    turns = "0.41, 0.6, 0.63, 0.1, " if "opens" in course else ""
    cards = [*block("A", lines, [1.02, 1.52, 2.02]), *block("B", lines, [0.0, 0.5, 1.0], first=1001),
             *solid("A", 1000.0, 0.0), *solid("B", 1000.0, 0.0), "*SURFACE INTERACTION, NAME=I",
             f"*CONTACT PAIR, INTERACTION=I, NAME=P, PAIRING={pairing}", "A.BOTTOM, B.TOP",
             "*AMPLITUDE, NAME=COURSE", f"0., 0., {turns}1., 1.",
             "*BOUNDARY", "A.LEFT, 1", "B.LEFT, 1", "B.BOTTOM, 2", "*STEP, INC=1000",
             "*STATIC, DIRECT", f"{1 / increments!r}, 1.", "*BOUNDARY, AMPLITUDE=COURSE",
             "A.TOP, 2, 2, -0.06", "*END STEP"]
    found = errors(solve(write(tmp_path / "bars.inp", without_unused_surfaces(cards))), "P")
    for name, (value, uncertainty, *_) in found.items():
        if name in ("normal_force", "peak_pressure"):
            assert abs(value - 20.0) <= max(uncertainty, 1e-7), name
            assert uncertainty < 1e-6 * value, name


@pytest.mark.parametrize("tolerance", ["1.E-2", "1.E-3"])
def test_the_part_of_the_iteration_holds_its_error(tmp_path, tolerance):
    """Loose tolerances, against one that is met to rounding."""
    def rows(value):
        cards = [f"*FIXED POINT, METHOD=ZAITSEV, TOL={value}"]
        changes = {"*FIXED POINT, METHOD=ZAITSEV\n": ""}
        return errors(solve(bare(CYLINDER, tmp_path, f"tol{value}.inp", cards, changes)), "FACE")

    loose, exact = rows(tolerance), rows("1.E-12")
    for name in ("normal_force", "heat_rate"):
        value, *_, iteration = loose[name]
        assert abs(exact[name][0] - value) <= iteration, name


# Rods over a gap in closed form (tests/reference/rods.py): the first, heated from the side that
# expands less, is next to its turning point; the gain of the second is largest in modulus.
LENGTH, WIDTH, CONDUCTIVITY, YOUNG, HOT = 0.1, 0.05, 20.0, 2e11, 500.0
TURNING = (1.133e-4, (0.0, 12e-6), (0.005, 1e-5), (500.0, 1e-4, 1.0))
STEEP = (4.7e-4, (12e-6, 0.0), (0.001, 1e-6), (1000.0, 1e-4, 1.0))


def rod_cards(name, number, gap, expansions, gas, power):
    """Return the cards of two rods that face each other, and those of their ends."""
    upper, lower = f"{name}1", f"{name}2"
    cards = [*block(upper, [0.0, WIDTH], [gap, gap + LENGTH], number),
             *block(lower, [0.0, WIDTH], [-LENGTH, 0.0], number + 100)]
    for body, expansion in zip((upper, lower), expansions, strict=True):
        cards += solid(body, YOUNG, 0.0, expansion, CONDUCTIVITY)
    return [*cards, f"*SURFACE INTERACTION, NAME={name}", "*GAP LAW, TYPE=GAS",
            ", ".join(map(repr, gas)), "*GAP LAW, TYPE=POWER", ", ".join(map(repr, power)),
            f"*CONTACT PAIR, INTERACTION={name}, NAME={name}", f"{upper}.BOTTOM, {lower}.TOP",
            "*BOUNDARY", f"{upper}, 1", f"{lower}, 1", f"{upper}.TOP, 2", f"{lower}.BOTTOM, 2",
            f"{upper}.TOP, 11, 11, {HOT!r}", f"{lower}.BOTTOM, 11, 11, 0."]


def known(gap, expansions, gas, power):
    """Return the rods and their laws for tests/reference/rods.py."""
    both = rods.Rods((LENGTH,) * 2, (CONDUCTIVITY,) * 2, expansions, (YOUNG,) * 2, (HOT, 0.0), gap)
    return both, rods.gas(*gas), rods.power(*power)


def test_error_of_the_iteration_near_a_turning_point(tmp_path):
    """A residual r moves omega by r/(1 - U'): here by 16 times r, though another gain is the
    largest in modulus. The heat of a rod moves by 1/(1 + R0 omega) of that."""
    cards = [*rod_cards("TURNING", 1, *TURNING), *rod_cards("STEEP", 1001, *STEEP),
             "*FIXED POINT, METHOD=NEWTON, TOL=1.E-4", "*START, FROM=OPEN", "*STEP",
             "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.", "*END STEP"]
    result = solve(write(tmp_path / "rods.inp", cards))
    with h5py.File(result) as file:
        residual = file["convergence/residual"][-1]
        gain = [file[f"history/{name}"][-1] for name in ("coupling_gain", "coupling_gain_max")]
    assert 0.0 < residual < 1e-4
    both, *laws = known(*TURNING)
    omega = rods.solutions(both, *laws)[0]
    nearest = rods.gain(both, *laws, omega)
    assert gain[0] < -10.0
    assert gain[1] == pytest.approx(nearest, rel=1e-3)
    value, *_, iteration = errors(result, "TURNING")["heat_rate"]
    assert iteration == pytest.approx(residual / (1 - nearest) * value, rel=2e-2)
    off = abs(value - WIDTH * both.flux(omega))
    assert residual * value < off < iteration


def test_the_listing_says_which_part_of_an_uncertainty_is_the_largest(tmp_path):
    """A table of every interface at the end of each step."""
    listing = solve(bare(CYLINDER, tmp_path, "cylinder.inp")).with_suffix(".lst").read_text()
    table = listing[listing.index("NUMERICAL UNCERTAINTY (95 %) OF FACE"):]
    row, = re.findall(r"^ +heat rate +(.*)$", table, flags=re.M)
    value, uncertainty, percent, change, scatter, _, part = row.split()
    assert float(value) == pytest.approx(30.87, rel=1e-2)
    assert float(uncertainty) >= float(change) > float(scatter) > 0.0
    assert float(percent) == pytest.approx(100 * float(uncertainty) / float(value), rel=0.05)
    assert part == "change"


def test_the_listing_has_no_shear_force_without_friction(tmp_path):
    table = solve(bare(HERTZ, tmp_path, "hertz.inp")).with_suffix(".lst").read_text()
    told = re.findall("^    (shear|normal) force ", table, flags=re.M)
    assert set(told) == {"normal"}


def test_heat_through_faces_that_only_touch_has_no_error(tmp_path):
    """Two rods one on the other, closed without pressure in a step of heat alone: temperatures are
    linear, exact on any mesh."""
    cards = ["*NODE", "1, 0., 0.", "2, 2., 0.", "3, 2., 1.", "4, 0., 1.", "11, 0., 1.",
             "12, 2., 1.", "13, 2., 2.", "14, 0., 2.", "*ELEMENT, TYPE=CPE4, ELSET=A",
             "1, 1, 2, 3, 4", "*ELEMENT, TYPE=CPE4, ELSET=B", "2, 11, 12, 13, 14",
             "*MATERIAL, NAME=M", "*CONDUCTIVITY", "50.", "*SOLID SECTION, ELSET=A, MATERIAL=M",
             "1.", "*SOLID SECTION, ELSET=B, MATERIAL=M", "1.", "*SURFACE, NAME=SA", "A, S3",
             "*SURFACE, NAME=SB", "B, S1", "*SURFACE INTERACTION, NAME=I", "*GAP CONDUCTANCE",
             "10., 0.", "*CONTACT PAIR, INTERACTION=I, NAME=F", "SB, SA", "*STEP",
             "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY", "13, 11, 11, 100.",
             "14, 11, 11, 100.", "1, 11, 11, 0.", "2, 11, 11, 0.", "*END STEP"]
    (tmp_path / "rods.inp").write_text("\n".join(cards) + "\n")
    value, uncertainty, *_ = errors(solve(tmp_path / "rods.inp"), "F")["heat_rate"]
    assert abs(value) == pytest.approx(2.0 * 100.0 / (1 / 10 + 2 / 50), rel=1e-12)
    assert uncertainty < 1e-9 * abs(value)
