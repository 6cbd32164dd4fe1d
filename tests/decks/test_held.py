"""Bodies that only contact and friction hold, and bodies that nothing holds."""

import h5py
import numpy as np
import pytest
from blocks import block, solid, without_unused_surfaces, write
from deck_runs import run, solve
from physics import mesh, nodes_of

XS = [0.0, 0.3, 1.0]
UPPER, LOWER = [0.0, 0.4, 0.5], [-1.0, -0.3, 0.0]
MESH = [*block("UPPER", XS, UPPER, 1, 0.05), *block("LOWER", XS, LOWER, 101, -0.05)]
RAISED = [*block("UPPER", XS, [y + 0.02 for y in UPPER], 1), *block("LOWER", XS, LOWER, 101)]
FACES = ["*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "UPPER.BOTTOM, LOWER.TOP"]
PRESSURE, MU = 12.5, 0.3
SOLIDS = [*solid("UPPER", 1e4, 0.3), *solid("LOWER", 2e3, 0.45)]
ELASTIC = [*solid("UPPER", 1e4, 0.0), *solid("LOWER", 1e4, 0.0)]
PRESS = ["*DLOAD", f"3, P3, {PRESSURE}", f"4, P3, {PRESSURE}"]
FLOOR = ["*BOUNDARY", "LOWER.BOTTOM, 1, 2, 0."]


def interaction(friction):
    """Return the cards of the surface interaction."""
    cards = ["*SURFACE INTERACTION, NAME=FACES"]
    return cards + (["*FRICTION", f"{friction}, 1.E5"] if friction else [])


def step(*cards, increment="1., 1."):
    """Return the cards of a static step."""
    return ["*STEP", "*STATIC", increment, *(c for part in cards for c in part), "*END STEP"]


def read(result, pair, *names):
    """Return datasets of a contact pair at the last increment."""
    with h5py.File(result) as file:
        return [file[f"contact/{pair}/{name}"][-1] for name in names]


def refuse(deck, status):
    """Run a deck that must fail; return what it says."""
    process = run("run", "--quiet", deck, "--out", deck.parent)
    assert process.returncode == status, process.stderr
    return process.stderr


def pushed_aside(path, force, friction=MU):
    """Press a block that has no support of its own on the floor and push its nodes aside.

    The force acts on all nodes of the sole alike, so that it does not tilt the block.
    """
    sole = 5  # pairs
    push = ["*CLOAD", f"UPPER.SOLE, 1, {force / sole!r}"]
    nset = ["*NSET, NSET=UPPER.SOLE", "UPPER.BOTTOM"]
    return write(path, MESH, nset, SOLIDS, interaction(friction), FACES, step(FLOOR, PRESS, push))


def test_frictionless_block_is_held_by_the_pressure(tmp_path):
    """Uniform pressure is the exact solution."""
    held = ["UPPER.LEFT, 1, 1, 0.", "LOWER.BOTTOM, 2, 2, 0.", "LOWER.LEFT, 1, 1, 0."]
    for mesh in MESH, RAISED:
        deck = write(tmp_path / "press.inp", mesh, SOLIDS, interaction(0.0), FACES,
                     step(["*BOUNDARY", *held], PRESS))
        pressure, gap, status = read(solve(deck), "FACE", "pressure", "gap", "status")
        np.testing.assert_allclose(pressure, PRESSURE, rtol=1e-10)
        assert np.all(gap == 0.0)
        assert np.all(status == 1)


@pytest.mark.parametrize("share", [0.2, 0.6, 0.95, -0.6])
def test_friction_holds_a_block_against_a_push(tmp_path, share):
    """Equilibrium: normal force p b, shear force the push."""
    push = share * MU * PRESSURE
    result = solve(pushed_aside(tmp_path / "push.inp", push))
    normal, shear, pressure, traction = read(
        result, "FACE", "normal_force", "shear_force", "pressure", "shear"
    )
    assert normal == pytest.approx(PRESSURE, rel=1e-9)
    assert shear == pytest.approx(-push, rel=1e-9)
    assert np.all(np.abs(traction) <= MU * pressure * (1 + 1e-9))


@pytest.mark.parametrize("share", [1.05, -3.0])
def test_a_push_beyond_friction_slides_the_block(tmp_path, share):
    text = refuse(pushed_aside(tmp_path / "slide.inp", share * MU * PRESSURE), 2)
    assert "body 1 (of UPPER, first node 1) is free to slide along x" in text


def test_a_block_that_is_pulled_off_is_named(tmp_path):
    pull = ["*DLOAD", f"3, P3, {-PRESSURE}", f"4, P3, {-PRESSURE}"]
    deck = write(tmp_path / "pull.inp", MESH, SOLIDS, interaction(MU), FACES, step(FLOOR, pull))
    text = refuse(deck, 2)
    assert "body 1 (of UPPER, first node 1) is free to move along x, move along y, turn about (0." in text


@pytest.mark.parametrize("friction", [0.0, MU])
def test_a_block_pressed_after_a_gap_rests_on_the_floor(tmp_path, friction):
    """It has fallen freely; friction, which counts from the instant of closing, has no resultant."""
    held = ["*BOUNDARY", "LOWER.BOTTOM, 1, 2, 0."] + ["UPPER.LEFT, 1, 1, 0."] * (friction == 0.0)
    deck = write(tmp_path / "drop.inp", RAISED, ELASTIC, interaction(friction), FACES,
                 step(held, PRESS, increment="0.25, 1."))
    normal, shear, pressure, gap = read(
        solve(deck), "FACE", "normal_force", "shear_force", "pressure", "gap"
    )
    assert normal == pytest.approx(PRESSURE, rel=1e-10)
    assert shear == pytest.approx(0.0, abs=1e-10 * PRESSURE)
    np.testing.assert_allclose(pressure, PRESSURE, rtol=1e-10 if friction == 0.0 else 1e-2)
    assert np.all(gap == 0.0)


def clamped(path, push, friction=MU):
    """Clamp a block between two platens that approach by 0.001 each; push its middle down."""
    mesh = [*block("MIDDLE", XS, [0.0, 0.5, 1.0], 1), *block("LOWER", XS, LOWER, 101),
            *block("UPPER", XS, [1.0, 1.4, 1.5], 201)]
    materials = [card for name in ("MIDDLE", "LOWER", "UPPER") for card in solid(name, 1e4, 0.0)]
    faces = ["*CONTACT PAIR, INTERACTION=FACES, NAME=BELOW", "MIDDLE.BOTTOM, LOWER.TOP",
             "*CONTACT PAIR, INTERACTION=FACES, NAME=ABOVE", "MIDDLE.TOP, UPPER.BOTTOM"]
    approach = ["*BOUNDARY", "LOWER.BOTTOM, 1, 1, 0.", "LOWER.BOTTOM, 2, 2, 0.001",
                "UPPER.TOP, 1, 1, 0.", "UPPER.TOP, 2, 2, -0.001"]
    cards = [step(approach)]
    if push:
        force = ["*CLOAD", f"MIDDLE.BOTTOM, 1, {push / 10!r}", f"MIDDLE.TOP, 1, {push / 10!r}"]
        cards.append(step(force))
    return write(path, mesh, materials, interaction(friction), faces, *cards)


CLAMP = 1e4 * 0.002 / 2.5  # E times the approach over the height, nu = 0


def test_friction_alone_clamps_a_block(tmp_path):
    for pair in "BELOW", "ABOVE":
        result = solve(clamped(tmp_path / "clamp.inp", 0.0))
        pressure, shear = read(result, pair, "pressure", "shear")
        np.testing.assert_allclose(pressure, CLAMP, rtol=1e-9)
        np.testing.assert_allclose(shear, 0.0, atol=1e-8 * CLAMP)


def test_clamped_block_carries_a_push_up_to_the_friction_of_both_faces(tmp_path):
    limit = 2 * MU * CLAMP
    result = solve(clamped(tmp_path / "hold.inp", 0.9 * limit))
    forces = [read(result, pair, "shear_force")[0] for pair in ("BELOW", "ABOVE")]
    assert sum(forces) == pytest.approx(-0.9 * limit, rel=1e-9)
    text = refuse(clamped(tmp_path / "slip.inp", 1.1 * limit), 2)
    assert "body 1 (of MIDDLE, first node 1) is free to slide along x" in text


def strip(thickness, columns, gap, friction, young=2e5):
    """Return a strip that is pressed on a base; only contact holds it along y."""
    xs = [4.0 * k / columns for k in range(columns + 1)]
    base = solid("LOWER", 2e5, 0.3)
    return [*block("LOWER", xs, [0.0, 1.0, 2.0], 1),
            *block("UPPER", xs, [2.0 + gap, 2.0 + gap + thickness], 5001),
            *solid("UPPER", young, 0.3), *base, *interaction(friction), *FACES,
            *step(FLOOR, [] if friction else ["UPPER.LEFT, 1"],
                  ["*DLOAD"] + [f"{5001 + k}, P3, 10." for k in range(columns)],
                  increment="0.5, 1.")]


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("gap", [0.0, 0.01])
@pytest.mark.parametrize(("thickness", "columns"), [(0.03, 4), (0.01, 40), (0.002, 40)])
def test_thin_strip_lies_where_it_is_pressed(tmp_path, thickness, columns, gap, friction):
    """Soft in bending, so that its stiffness is near to that of a body that moves as a whole."""
    deck = write(tmp_path / "strip.inp", strip(thickness, columns, gap, friction))
    force, gaps = read(solve(deck), "FACE", "normal_force", "gap")
    np.testing.assert_allclose(force, 40.0, rtol=1e-9)
    assert gaps.max() < 1e-3


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("young", [1e9, 1e11, 1e13])
def test_stiff_block_rests_on_a_soft_one(tmp_path, young, friction):
    deck = write(tmp_path / "stiff.inp", strip(2.0, 4, 0.0, friction, young))
    (force,) = read(solve(deck), "FACE", "normal_force")
    np.testing.assert_allclose(force, 40.0, rtol=1e-6)


def test_blocks_that_slip_apart_on_both_sides_stay_where_they_are(tmp_path):
    """The middle opens, and all closed pairs slip: a shift would meet no resistance. None is made,
    as if a node of the middle were held, where there is no reaction."""
    xs = [0.0, 1.0, 2.0, 3.0, 4.0]
    upper = block("UPPER", xs, [2.0, 3.0, 4.0], 1001)
    middle = next(n for n, place in nodes_of(upper).items() if place == (2.0, 4.0))
    found = []
    for name, held in (("free", []), ("held", [f"{middle}, 1"])):
        deck = write(tmp_path / f"{name}.inp",
                     block("LOWER", xs, [0.0, 1.0, 2.0], 1), upper,
                     solid("LOWER", 2e5, 0.3, 1e-5, 0.05), solid("UPPER", 2e5, 0.3, 1e-5, 0.05),
                     interaction(0.3), ["*GAP LAW, TYPE=GAS", "1.E-4, 1.E-3",
                                        "*GAP LAW, TYPE=POWER", "0.1, 0.01, 1."], FACES,
                     ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.",
                      *FLOOR, "LOWER.BOTTOM, 11, 11, 0.", "UPPER.TOP, 11, 11, 300.", *held,
                      "*DLOAD", *(f"{1005 + k}, P3, 10." for k in range(4)), "*END STEP"])
        found.append(read(solve(deck), "FACE", "gap", "pressure", "slip", "status"))
    gap, pressure, slip, status = found[0]
    assert (status[[0, -1]] == 1).all()
    assert (status[[3, 4, 5]] == 0).all()
    np.testing.assert_allclose(slip, -slip[::-1], rtol=0.0, atol=1e-9 * np.abs(slip).max())
    for one, other in zip((gap, pressure, slip), found[1], strict=False):
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9 * np.abs(other).max())


def test_block_above_the_floor_stays_there_without_a_load(tmp_path):
    deck = write(tmp_path / "hover.inp", RAISED, SOLIDS, interaction(MU), FACES,
                 step(FLOOR, increment="0.5, 1."))
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 0
    assert process.stderr.count("no load drives it: the smallest movement is used") == 1
    assert "along y" in process.stderr
    gap, status = read(deck.with_suffix(".vtkhdf"), "FACE", "gap", "status")
    np.testing.assert_allclose(gap, 0.02, rtol=1e-12)
    assert (status == 0).all()


def films(path, *points):
    """Heat a block by a film alone, whose coefficient follows an amplitude."""
    amplitude = ["*AMPLITUDE, NAME=COURSE", ", ".join(map(str, points))]
    return write(path, block("A", XS, UPPER), solid("A", 1e4, 0.3), amplitude,
                 ["*STEP", "*HEAT TRANSFER, STEADY STATE", "0.5, 1.",
                  "*FILM, FILM AMPLITUDE=COURSE", "A, F3, 50., 0.01", "*END STEP"])


def test_a_film_of_nothing_leaves_a_temperature_undetermined(tmp_path):
    """At once: an error of the deck; later: the increments before are kept."""
    said = "the temperature of body 1 (of A, first node 1) is undetermined: no *BOUNDARY"
    deck = films(tmp_path / "never.inp", 0.0, 0.0, 1.0, 0.0)
    assert f"increment 1 (time 0.5): {said}" in refuse(deck, 1)
    deck = films(tmp_path / "ends.inp", 0.0, 1.0, 0.5, 1.0, 1.0, 0.0)
    assert f"increment 2 (time 1): {said}" in refuse(deck, 2)
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        assert list(file["history/time"]) == [0.5]


LAWS = ["*GAP LAW, TYPE=GAS", "1.E-4, 1.E-3", "*GAP LAW, TYPE=POWER", "0.1, 0.01, 1."]
SQUARES = [0.0, 1.0, 2.0, 3.0, 4.0]
TWO = [*block("LOWER", SQUARES, [0.0, 1.0, 2.0], 1), *block("UPPER", SQUARES, [2.0, 3.0, 4.0], 1001),
       *solid("LOWER", 2e5, 0.3, 1.2e-5, 0.05), *solid("UPPER", 2e5, 0.3, 1.2e-5, 0.05)]
COUPLED = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.", "*BOUNDARY"]


def at(bottom, top):
    """Return the cards of prescribed temperatures."""
    return [f"LOWER.BOTTOM, 11, 11, {bottom!r}", f"UPPER.TOP, 11, 11, {top!r}"]


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("initial", [20.0, 300.0, 1000.0 / 3.0])
@pytest.mark.parametrize("peak", [None, 400.0])
def test_nothing_is_pressed_at_the_initial_temperature(tmp_path, initial, friction, peak):
    """At once, and after a cycle: what rounding leaves of the strain is no load and no gap."""
    supports = ["LOWER.BOTTOM, 1, 2", *([] if friction else ["UPPER.LEFT, 1"])]
    cards = [*COUPLED, *supports, *at(peak or initial, peak or initial), "*END STEP"]
    if peak:
        cards += [*COUPLED, *at(initial, initial), "*END STEP"]
    deck = write(tmp_path / "rest.inp", TWO, interaction(friction), LAWS, FACES,
                 ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"LOWER, {initial!r}",
                  f"UPPER, {initial!r}"], cards)
    gap, pressure = read(solve(deck), "FACE", "gap", "pressure")
    np.testing.assert_allclose(gap, 0.0, atol=1e-12)
    np.testing.assert_allclose(pressure, 0.0, atol=1e-6)


@pytest.mark.parametrize("kind", ["CPE8", "CPE6", "CPE3"])
@pytest.mark.parametrize("hot", [100.0, 1000.0])
def test_block_that_stands_on_its_bulge_keeps_its_place(tmp_path, kind, hot):
    """The lower face of the upper block is convex: few pairs carry all of its load, and it could
    turn on them."""
    parts = [*mesh("LOWER", SQUARES, [0.0, 1.0, 2.0], kind),
             *mesh("UPPER", SQUARES, [2.0, 3.0, 4.0], kind, 1001), *TWO[-16:]]
    deck = write(tmp_path / "bulge.inp", ["*OPTIONS, WIDTH=120"], parts, interaction(0.3), LAWS,
                 FACES, [*COUPLED, *FLOOR[1:], *at(hot, 0.0), "*DSLOAD", "UPPER.TOP, P, 1.",
                         "*END STEP"])
    result = solve(deck)
    (force,) = read(result, "FACE", "normal_force")
    np.testing.assert_allclose(force, 4.0, rtol=1e-9)
    with h5py.File(result) as file:
        assert np.isfinite(file["VTKHDF/PointData/displacement"][()]).all()
        assert np.abs(file["VTKHDF/PointData/displacement"][()]).max() < 0.1


def test_heated_block_above_the_floor_only_expands(tmp_path):
    """Nothing drives it; the forces that heat makes in it balance but for rounding."""
    deck = write(tmp_path / "hover.inp", RAISED,
                 solid("UPPER", 1e4, 0.3, 1e-5), solid("LOWER", 2e3, 0.45, 1e-5), interaction(0.0),
                 ["*GAP LAW, TYPE=GAS", "1., 1."], FACES,
                 COUPLED, FLOOR[1:], ["UPPER.LEFT, 1"], at(100.0, 100.0), ["*END STEP"])
    gap, force = read(solve(deck), "FACE", "gap", "normal_force")
    np.testing.assert_allclose(force, 0.0, atol=1e-12)
    assert (np.abs(gap - 0.02) < 2e-3).all()


def node_at(cards, point):
    """Return the number of the node at a point."""
    rows = [card.split(",") for card in cards[1:cards.index("*ELEMENT, TYPE=CPE8, ELSET=BODY")]]
    return next(int(n) for n, x, y in rows if (float(x), float(y)) == point)


def one_body(xs, kind):
    """Return the cards of a body that two corners hold, pulled upwards, with elements of a kind."""
    cards = block("BODY", xs, [0.0, 3.0])
    first, last = (node_at(cards, (x, 0.0)) for x in (xs[0], xs[-1]))
    cards = [card.replace("CPE8", kind) for card in without_unused_surfaces(cards)]
    load = ["*DLOAD", *(f"{k + 1}, P3, -4." for k in range(len(xs) - 1))]
    return [*cards, *solid("BODY", 1000.0, 0.3),
            *step(["*BOUNDARY", f"{first}, 1, 2", f"{last}, 2"], load)]


@pytest.mark.parametrize("solver", ["SKYLINE", "MUMPS"])
@pytest.mark.parametrize("kind", ["CPE8R", "CPS8R"])
def test_a_single_element_that_deforms_without_stress_is_named(tmp_path, kind, solver):
    """Four points give twelve strains for sixteen degrees of freedom, three of them rigid."""
    deck = write(tmp_path / "one.inp", [f"*SOLVER, TYPE={solver}", *one_body([0.0, 2.0], kind)])
    message = refuse(deck, 1)
    assert "body 1 (of BODY, first node 1) can deform without stress: no *BOUNDARY" in message
    assert "take CPE8 in place of CPE8R, or CPS8 in place of CPS8R, or a finer mesh" in message


def resting(kind, pairing, friction, slant, held, load):
    """Return one element that rests on another one, which is held, under a pressure of 3."""
    def to(x, y):
        return x + slant * x * (y - 1.0) ** 2, y
    return [*mesh("UPPER", [0.0, 1.0], [1.0, 2.0], kind, 11, to=to),
            *mesh("LOWER", [0.0, 1.0], [0.0, 1.0], "CPE8", 1), *solid("UPPER", 1000.0, 0.3),
            *solid("LOWER", 1000.0, 0.3), *interaction(friction), FACES[0] + f", PAIRING={pairing}",
            FACES[1], *step(["*BOUNDARY", "LOWER, 1, 2", *held], ["*DSLOAD", "UPPER.TOP, P, 3."], load)]


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("slant", [0.0, 0.2])
def test_contact_holds_an_element_that_deforms_without_stress(tmp_path, friction, slant):
    """Three pairs hold what two supports leave: the pressure is that of the load, and the motion
    that of an element of full integration."""
    found = []
    for kind in "CPE8R", "CPE8":
        held = ["11, 1", "14, 1"][2 * (friction > 0.0):]
        cards = resting(kind, "NODES", friction, slant, held, [])
        result = solve(write(tmp_path / f"{kind}.inp", cards))
        force, pressure = read(result, "FACE", "normal_force", "pressure")
        with h5py.File(result) as file:
            found.append(np.abs(file["VTKHDF/PointData/displacement"][()]).max())
        assert force == pytest.approx(3.0 * (1.0 + slant), rel=1e-9)
        if not slant and not friction:
            np.testing.assert_allclose(pressure, 3.0, rtol=0.03)
    assert found[0] == pytest.approx(found[1], rel=0.1)


def test_contact_that_does_not_hold_such_an_element_is_told(tmp_path):
    """Two mortar points do not hold it; three pairs hold it until forces pull it off."""
    cards = resting("CPE8R", "SURFACES", 0.0, 0.0, ["11, 1", "14, 1"], [])
    text = refuse(write(tmp_path / "mortar.inp", cards), 1)
    assert "body 1 (of UPPER, first node 11) can deform without stress" in text
    pull = ["*CLOAD", "15, 2, 6.", "13, 2, -3.", "14, 2, -3."]
    cards = resting("CPE8R", "NODES", 0.0, 0.0, ["11, 1", "14, 1"], pull)
    text = refuse(write(tmp_path / "pulled.inp", cards), 2)
    assert "body 1 (of UPPER, first node 11) is free to deform without stress" in text


@pytest.mark.parametrize("solver", ["SKYLINE", "MUMPS"])
@pytest.mark.parametrize("kind", ["CPE4", "CPE8"])
def test_parts_of_a_body_that_hinge_on_a_node_are_named(tmp_path, kind, solver):
    """The second square meets the first at a corner; at two corners it does not turn."""
    first, second = mesh("BODY", [0.0, 1.0], [0.0, 1.0], kind), mesh(
        "BODY", [1.0, 2.0], [1.0, 2.0], kind, 101)
    corner = next(n for n, place in nodes_of(first).items() if place == (1.0, 1.0))
    again = next(n for n, place in nodes_of(second).items() if place == (1.0, 1.0))
    far = next(n for n, place in nodes_of(second).items() if place == (2.0, 2.0))
    element = next(card for card in second if card.startswith("101,") and card.count(",") > 2)
    element = element.replace(f" {again},", f" {corner},")
    cards = [*first[:first.index("*NSET, NSET=BODY.BOTTOM")], "*NODE",
             *(f"{n}, {x}, {y}" for n, (x, y) in nodes_of(second).items() if n != again),
             f"*ELEMENT, TYPE={kind}, ELSET=BODY", element, *solid("BODY", 1000.0, 0.3)]
    held = [f"{n}, 1, 2" for n in (1, 2)]
    for more, status in (([], 1), ([f"{far}, 1"], 0)):
        deck = write(tmp_path / "hinge.inp", [f"*SOLVER, TYPE={solver}"], cards,
                     step(["*BOUNDARY", *held, *more], ["*CLOAD", f"{far}, 2, 1."]))
        process = run("run", "--quiet", deck, "--out", tmp_path)
        assert process.returncode == status, process.stderr
        said = "the part of body 1 (of BODY, first node 1) with element 101 can turn about (1, 1)"
        assert (said in process.stderr) == (status == 1)


@pytest.mark.parametrize(("xs", "kind"), [([0.0, 2.0], "CPE8"), ([0.0, 1.0, 2.0], "CPE8R"),
                                          ([0.0, 2.0], "CAX8R")])
def test_other_elements_do_not_deform_without_stress(tmp_path, xs, kind):
    solve(write(tmp_path / "others.inp", one_body(xs, kind)))


@pytest.mark.parametrize("solver", ["SKYLINE", "MUMPS"])
def test_a_body_too_soft_beside_another_is_named(tmp_path, solver):
    materials = [*solid("UPPER", 1e4, 0.3), *solid("LOWER", 1e-50, 0.3)]
    deck = write(tmp_path / "soft.inp", [f"*SOLVER, TYPE={solver}"], MESH, materials,
                 interaction(MU), [FACES[0] + ", PAIRING=SURFACES", FACES[1]], step(FLOOR, PRESS))
    message = refuse(deck, 1)
    assert "body 2 (of LOWER, first node 101) is 1E+54 times softer than body 1 (of UPPER" in message
    assert "check the values and units of *ELASTIC" in message
