"""Models of steps that store heat: what ties, relates and divides bodies leaves their course, and
heat that goes in without going out is heat in the bodies."""

from itertools import pairwise

import h5py
import numpy as np
import pytest
import transients as two
from blocks import write
from calculix import thercon
from deck_runs import assert_alike, datasets, run, solve
from physics import material, mesh, nodes_of, verify
from scipy.optimize import brentq
from transients import HIGH, LOW, XS

OTHER = [0.0, 0.25, 0.7, 1.0]
FIELDS = "contact", "VTKHDF/PointData"
TIGHT = ["*FIXED POINT, TOL=1.E-12"]
PARTS = {"upper": (XS, [0.5, 1.0]), "middle": (XS, [0.0, 0.2, 0.5])}
OTHERS = {"upper": (OTHER, [0.5, 1.0]), "middle": (XS, [0.0, 0.2, 0.5])}
PLACES = nodes_of(two.bodies(**PARTS))
EQUAL = ["*EQUATION", *(
    line for n, place in PLACES.items() for m, other in PLACES.items() for dof in (2, 11)
    for line in ("2", f"{n}, {dof}, 1., {m}, {dof}, -1.") if n < 1000 and m > 2000
    and place == other)]
GRIP = ["*NODE, NSET=GRIP", "9000, 0.3, 1.5", "*COUPLING, REF NODE=9000, SURFACE=UPPER.TOP, "
        "CONSTRAINT NAME=GRIP", "*KINEMATIC", "2", "*BOUNDARY", "9000, 1, 1", "9000, 6, 6"]
BY_GRIP = ("*BOUNDARY", f"9000, 2, 2, {two.PRESSED!r}")

# Cards of model and contact, and how the step presses the blocks.
FORMS = {
    "mortar points": (two.bodies(), two.contact(pairing="SURFACES"), {}),
    "mortar points on other meshes":
        (two.bodies(upper=(OTHER, HIGH)), two.contact(pairing="SURFACES"), {}),
    "a tie": (two.bodies(**PARTS) + two.TIE, two.contact("MIDDLE.BOTTOM"), {}),
    "a tie of other meshes": (two.bodies(**OTHERS) + two.TIE, two.contact("MIDDLE.BOTTOM"), {}),
    "equations": (two.bodies(**PARTS) + EQUAL, two.contact("MIDDLE.BOTTOM"), {}),
    "a coupling": (two.bodies() + GRIP, two.contact(), {"pressed": BY_GRIP}),
    "MUMPS": (two.bodies() + ["*SOLVER, TYPE=MUMPS"], two.contact(), {}),
}
STEPS = {"fixed": {}, "by error": {"how": ", LOCAL ERROR=1.E-3"},
         "with heat of strains": {"how": ", DIRECT, DILATATION=YES"}}


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """Return the results of two blocks of one mesh with node pairs, for each kind of step."""
    folder = tmp_path_factory.mktemp("plain")
    return {name: solve(two.two_blocks(folder / f"{name}.inp", **step))
            for name, step in STEPS.items()}


def model(path, form, *cards, **of_step):
    """Write the deck of a form; return its path."""
    bodies, contact, pressing = FORMS[form]
    return two.write_deck(path, bodies, contact, TIGHT, cards, two.heated(**pressing, **of_step))


@pytest.mark.parametrize(("form", "step"), [
    *((form, "by error") for form in FORMS), ("mortar points", "fixed"), ("MUMPS", "fixed"),
    ("mortar points", "with heat of strains"), ("a tie", "with heat of strains")])
def test_a_form_leaves_the_course(tmp_path, plain, form, step):
    found = solve(model(tmp_path / "deck.inp", form, **STEPS[step]))
    one, other = two.course(plain[step]), two.course(found)
    assert 0.3 * max(one["pressure"]) < np.ptp(one["pressure"])   # heat and contact are coupled
    two.assert_same_course(one, other)


def test_a_node_of_no_element_has_no_part_in_absolute_temperatures(tmp_path):
    """It starts at 0, which is absolute zero here, and the bodies above it."""
    forms = {"plain": ([], {}), "grip": (GRIP, FORMS["a coupling"][2])}
    plain, gripped = (solve(two.write_deck(
        tmp_path / f"{name}.inp", two.bodies(zero=0.0), cards, two.contact(), TIGHT,
        two.heated(how=", DILATATION=YES", **pressing)))
        for name, (cards, pressing) in forms.items())
    two.assert_same_course(two.course(plain), two.course(gripped))


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("refine", [
    "*REFINE, LEVELS=1", "*REFINE, LEVELS=1, SURFACE=UPPER.BOTTOM"], ids=["all", "faces"])
def test_divided_elements_are_those_of_a_finer_mesh(tmp_path, refine, step):
    """A surface in contact has its other face divided, too."""
    def halved(points, everywhere="SURFACE" not in refine):
        return sorted([*points, *((a + b) / 2 for a, b in pairwise(points)
                                  if everywhere or 0.0 in (a, b))])

    parts = two.bodies(upper=(halved(XS, True), halved(HIGH)),
                       lower=(halved(XS, True), halved(LOW)))
    written = two.write_deck(tmp_path / "written.inp", parts, two.contact(), TIGHT,
                             two.heated(**STEPS[step]))
    divided = two.two_blocks(tmp_path / "divided.inp", refine, **STEPS[step])
    two.assert_same_course(two.course(solve(written)), two.course(solve(divided)))


SCHEMES = {"IMPLICIT": 1.0, "CRANK-NICOLSON": 0.5, "GALERKIN": 2 / 3}
ENTERING = two.HOT_FILM * (two.HOT - two.START) + two.COLD_FILM * (two.COLD - two.START)


@pytest.mark.parametrize(("scheme", "form"), [
    *(("CRANK-NICOLSON", form) for form in [*FORMS, "hanging nodes"]),
    *((scheme, "mortar points") for scheme in SCHEMES if scheme != "CRANK-NICOLSON")])
def test_heat_that_is_stored_is_in_the_bodies(tmp_path, form, scheme):
    """The mean over an increment is a part of the rate at its end, the rest of that at its start;
    the films alone act at first."""
    cards = [f"*THERMAL SCHEME, TYPE={scheme}"]
    if form == "hanging nodes":
        deck = two.two_blocks(tmp_path / "deck.inp", *cards,
                              "*ELSET, ELSET=CORNER", "1, 1001", "*REFINE, LEVELS=2, ELSET=CORNER")
    else:
        deck = model(tmp_path / "deck.inp", form, *cards)
    result = solve(deck)
    times, heat = two.content(result)
    stored, entering, leaving = two.history(result, "heat_stored", "heat_in", "heat_out")
    np.testing.assert_allclose(entering - leaving, stored, rtol=0, atol=1e-9 * entering.max())
    part = SCHEMES[scheme]
    mean = part * stored + (1 - part) * np.array([ENTERING, *stored[:-1]])
    sizes = np.diff(times, prepend=0.0)
    np.testing.assert_allclose(np.cumsum(mean * sizes), heat, rtol=1e-9)


@pytest.mark.parametrize("form", [*FORMS, "node pairs"])
def test_heat_of_strains_is_in_the_balance(tmp_path, form):
    """Beside what is stored, which is without it."""
    of_step = {"how": ", DIRECT, DILATATION=YES"}
    deck = (two.two_blocks(tmp_path / "deck.inp", **of_step) if form == "node pairs"
            else model(tmp_path / "deck.inp", form, **of_step))
    entering, *others = two.history(solve(deck), *two.OF_BODIES)
    np.testing.assert_allclose(sum(others), entering, rtol=0, atol=1e-9 * entering.max())
    assert np.abs(others[-1]).max() > 1e-5 * entering.max()


@pytest.mark.parametrize("form", [*FORMS, "node pairs"])
def test_heat_balances_with_the_default_scheme_and_increments_by_error(tmp_path, form):
    deck = (two.two_blocks(tmp_path / "deck.inp", how="") if form == "node pairs"
            else model(tmp_path / "deck.inp", form, how=""))
    result = solve(deck)
    stored, entering, leaving = two.history(result, "heat_stored", "heat_in", "heat_out")
    np.testing.assert_allclose(entering - leaving, stored, rtol=0, atol=1e-9 * entering.max())
    times, heat = two.content(result)
    # Over increments that err by a thousandth the trapezoidal sum of the rates is near the heat.
    sizes = np.diff(times, prepend=0.0)
    before = np.array([ENTERING, *stored[:-1]])
    np.testing.assert_allclose(np.cumsum((stored + before) / 2 * sizes), heat, rtol=2e-2)


HOT = f"11, 11, {two.HOT!r}"
CORNER = ["*ELSET, ELSET=CORNER", "5", "*REFINE, LEVELS=1, ELSET=CORNER"]
TIED = two.bodies(**PARTS) + two.TIE
# Bodies, slave, prescribed temperatures, and the integral of shape functions of the nodes there: a
# sixth of the elements beside them. Hanging nodes have 3/8 and -1/8 of the corner above them, and a
# third of half the small elements beside.
JUMPS = {
    "given": (two.bodies(), "UPPER.BOTTOM", [f"UPPER.TOP, {HOT}"], 0.5 / 6),
    "above hanging nodes": (two.bodies() + CORNER, "UPPER.BOTTOM", [f"UPPER.TOP, {HOT}"],
                            0.6 * 0.5 / 6 + 0.4 * 0.25 / 6 + 0.2 * 0.25 / 3 * (3 / 8 - 1 / 8)),
    "by a coupling": (two.bodies() + GRIP[:-4] + ["11"], "UPPER.BOTTOM", [f"9000, {HOT}"], 0.5 / 6),
    "of a master": (TIED, "MIDDLE.BOTTOM", [f"MIDDLE.TOP, {HOT}"], (0.5 + 0.3) / 6),
    "of a slave": (TIED, "MIDDLE.BOTTOM", [f"UPPER.BOTTOM, {HOT}"], (0.5 + 0.3) / 6),
    "of a face in contact": (two.bodies(), "UPPER.BOTTOM", [f"UPPER.BOTTOM, {HOT}"], 0.2 / 6),
}


@pytest.mark.parametrize("jump", JUMPS)
def test_temperatures_that_jump_hold_their_heat_at_once(tmp_path, jump):
    bodies, slave, hot, beside = JUMPS[jump]
    result = solve(two.write_deck(tmp_path / "deck.inp", bodies, two.contact(slave), TIGHT,
                                  ["*THERMAL SCHEME, TYPE=IMPLICIT"],
                                  two.heated("*BOUNDARY", *hot)))
    times, heat = two.content(result)
    stored, = two.history(result, "heat_stored")
    at_once = beside * two.CAPACITY["UPPER"] * (two.HOT - two.START)
    np.testing.assert_allclose(at_once + np.cumsum(stored * np.diff(times, prepend=0.0)), heat,
                               rtol=1e-9)


@pytest.mark.parametrize("analysis", ["HEAT TRANSFER", "COUPLED TEMPERATURE-DISPLACEMENT"])
@pytest.mark.parametrize("scheme", ["IMPLICIT", "GALERKIN", "CRANK-NICOLSON", "L-STABLE"])
def test_a_step_begins_with_the_rates_that_its_start_has(tmp_path, scheme, analysis):
    """A face of the temperature T takes up the heat of the other face, at 100 at once, of a body at
    -50 at once, of a film, of a source that rises in total time, and of friction: C T' = R(t, T),
    in one increment from t = 1 to 2. The lower body expands between supports, which the pressure
    follows in a coupled step. Another pair, in front of it, is open and makes no heat."""
    start, conductance, film, sink, friction = 10.0, 0.7, 0.4, 30.0, (0.1, 5.0, 3.0, 0.2)
    conduct, content = [(2.0, -50.0), (4.0, 150.0)], [(1.0, -50.0), (3.0, 150.0)]   # 1.5 + T/100
    coefficient, pressure, speed, share = friction

    def pressed(warmth):
        mean = (warmth - 50.0) / 2 - start if analysis.startswith("COUPLED") else 0.0
        return pressure + 1000.0 / 2 * 1e-4 * mean

    def rate(time, warmth, force):
        return (conductance * (100.0 - warmth) - (2.5 + (warmth - 50.0) / 200) * (warmth + 50.0)
                + (4.0 + 8.0 * (time - 1.0)) / 2 - film * (warmth - sink)
                + coefficient * force * speed * (1 - share))

    def stored(warmth):
        return (1.5 * warmth + warmth**2 / 200) / 2

    def solved(time, size, before):
        return brentq(lambda t: stored(t) - before - size * rate(time, t, pressed(t)), -50.0, 100.0,
                      xtol=1e-13)

    if scheme == "L-STABLE":
        part = 1 - 0.5**0.5
        first = stored(solved(1 + part, part, stored(start))) - stored(start)
        end = solved(2.0, part, stored(start) + (1 / part - 1) * first)
    else:
        part = {"IMPLICIT": 1.0, "GALERKIN": 2 / 3, "CRANK-NICOLSON": 0.5}[scheme]
        end = solved(2.0, part, stored(start) + (1 - part) * rate(1.0, start, pressure))
    solve(write(tmp_path / "deck.inp", ["*OPTIONS, ERRORS=NO", f"*THERMAL SCHEME, TYPE={scheme}"],
                mesh("UPPER", [0.0, 1.0], [0.0, 1.0], "CPE4"),
                mesh("LOWER", [0.0, 1.0], [-1.0, 0.0], "CPE4", first=101),
                mesh("IDLE", [2.0, 3.0], [0.1, 1.0], "CPE4", first=201),
                mesh("BACK", [2.0, 3.0], [-1.0, 0.0], "CPE4", first=301),
                *(material(name, (1000.0, 0.0), 1e-4 if name == "LOWER" else None, conduct, 1.0,
                           content) for name in ("UPPER", "LOWER", "IDLE", "BACK")), [
        "*SURFACE INTERACTION, NAME=OTHER",
        "*CONTACT PAIR, INTERACTION=OTHER, NAME=IDLE", "IDLE.BOTTOM, BACK.TOP",
        "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=POWER", f"{conductance!r}, 0., 1.",
        "*FRICTION", f"{coefficient!r}", "*GAP HEAT GENERATION", f"1., {share!r}, {speed!r}",
        "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "UPPER.BOTTOM, LOWER.TOP",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
        *(f"{name}, {start!r}" for name in ("UPPER", "LOWER", "IDLE", "BACK")),
        "*AMPLITUDE, NAME=RISE, TIME=TOTAL TIME", "1., 4., 2., 12.",
        "*BOUNDARY", "UPPER, 1", "LOWER, 1", "LOWER.BOTTOM, 2", "IDLE, 1, 2", "BACK, 1, 2",
        *(f"{name}, 11, 11, {start!r}" for name in ("IDLE", "BACK")),
        "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", f"UPPER.TOP, 2, 2, {-pressure / 500!r}",
        "*END STEP",
        "*STEP", f"*{analysis}, DIRECT", "1., 1.", "*BOUNDARY", "UPPER, 11, 11, 100.",
        "LOWER.BOTTOM, 11, 11, -50.", "*DFLUX, AMPLITUDE=RISE", "LOWER, BF, 1.", "*SFILM",
        f"LOWER.TOP, F, {sink!r}, {film!r}", "*END STEP",
        *verify(("NT", "LOWER.TOP", "LAST", end, 1e-8),
                ("heat_stored", "", "LAST", rate(2.0, end, pressed(end)), 1e-7))]))


# Steps and methods

STEADY = [f"{two.COUPLED}, STEADY STATE", "0.1, 0.2"]
OTHER_STEPS = {
    "a static step before": ["*STEP", "*STATIC", "0.5, 1.", "*BOUNDARY",
                             f"UPPER.TOP, 2, 2, {two.PRESSED!r}", "*END STEP"],
    "a transient of heat alone before": [
        "*STEP", "*HEAT TRANSFER, DIRECT", "0.05, 0.3", "*DFLUX", "UPPER, BF, 100.", "*END STEP"],
    "a coupled transient before": two.heated("*DFLUX", "UPPER, BF, 50.", times="0.03, 0.3"),
}


@pytest.mark.parametrize("before", OTHER_STEPS)
@pytest.mark.parametrize("scheme", ["IMPLICIT", "EXPLICIT"])
def test_heat_is_kept_from_step_to_step(tmp_path, before, scheme):
    """What the step before stored is where the next one begins."""
    result = solve(two.two_blocks(tmp_path / "deck.inp", f"*THERMAL SCHEME, TYPE={scheme}",
                                  *OTHER_STEPS[before]))
    times, heat = two.content(result)
    stored, = two.history(result, "heat_stored")
    gained = np.cumsum(np.nan_to_num(stored) * np.diff(times, prepend=0.0))
    np.testing.assert_allclose(gained, heat, rtol=1e-9, atol=1e-9 * heat.max())
    assert heat[-1] > 0


@pytest.mark.parametrize("scheme", ["IMPLICIT", "GALERKIN"])
def test_temperatures_that_are_released_and_prescribed_again_leave_the_balance(tmp_path, scheme):
    """Hot from the first step on, free in the second, and at another temperature in the third."""
    again = 25.0
    quiet = {"pressed": (), "times": "0.02, 0.1"}
    result = solve(two.two_blocks(
        tmp_path / "deck.inp", f"*THERMAL SCHEME, TYPE={scheme}",
        *two.heated("*BOUNDARY", f"UPPER.TOP, {HOT}", times="0.02, 0.1"),
        *two.heated("*BOUNDARY, OP=NEW", "UPPER, 1", "LOWER, 1", "LOWER.BOTTOM, 2",
                    f"UPPER.TOP, 2, 2, {two.PRESSED!r}", **quiet),
        **quiet | {"pressed": ("*BOUNDARY", f"UPPER.TOP, 11, 11, {again!r}")}))
    times, heat = two.content(result)
    stored, = two.history(result, "heat_stored")
    with h5py.File(result) as file:
        y = file["VTKHDF/Points"][:, 1]
        top = file["VTKHDF/PointData/temperature"][()].reshape(len(times), -1)[:, y == 1.0][:, 0]
    ends = [round(t / 0.02) - 1 for t in (0.1, 0.2)]
    share = 0.5 / 6 * two.CAPACITY["UPPER"]
    jumps = {0: two.HOT - two.START, ends[1] + 1: again - top[ends[1]]}
    part = SCHEMES[scheme]
    before = np.concatenate([[np.nan], stored[:-1]])
    mean = part * stored + (1 - part) * before if part < 1 else stored
    for row in range(len(times)):
        gained = heat[row] - (heat[row - 1] if row else 0.0) - share * jumps.get(row, 0.0)
        if part < 1 and row in (0, ends[0] + 1, ends[1] + 1):
            continue   # the rate at the start of a step is not that of the step before
        assert gained == pytest.approx(0.02 * mean[row], rel=1e-9, abs=1e-9 * heat.max())


def test_a_steady_step_between_transients_stores_nothing_and_what_follows_starts_from_it(tmp_path):
    """Loads that act at once as they are find the steady state, and nothing changes."""
    steady = two.heated(times="0.1, 0.2", how=", STEADY STATE")
    result = solve(two.two_blocks(tmp_path / "deck.inp", *two.heated(times="0.05, 0.1"), *steady))
    time, stored, entering = two.history(result, "time", "heat_stored", "heat_in")
    assert np.isnan(stored[(time > 0.1 + 1e-9) & (time < 0.3 + 1e-9)]).all()
    last = time > 0.3 + 1e-9
    np.testing.assert_allclose(stored[last], 0.0, atol=1e-7 * entering[-1])
    np.testing.assert_allclose(entering[last], entering[~last][-1], rtol=1e-7)


def test_faces_that_are_removed_conduct_nothing_and_conduct_again_when_added(tmp_path):
    steps = []
    for change in ("REMOVE", "ADD"):
        steps += ["*STEP", f"{two.COUPLED}, DIRECT", "0.05, 0.2",
                  f"*MODEL CHANGE, TYPE=CONTACT PAIR, {change}", "UPPER.BOTTOM, LOWER.TOP",
                  "*END STEP"]
    bodies = two.bodies(held=["LOWER.BOTTOM, 1, 2", "LOWER, 1", "UPPER, 1"])
    deck = two.write_deck(tmp_path / "deck.inp", bodies, two.contact(), TIGHT,
                          ["*THERMAL SCHEME, TYPE=IMPLICIT"], two.heated(times="0.05, 0.2"), steps)
    result = solve(deck)
    times, heat = two.content(result)
    stored, = two.history(result, "heat_stored")
    with h5py.File(result) as file:
        crossing = file["contact/FACE/heat_rate"][()]
    np.testing.assert_allclose(np.cumsum(stored * np.diff(times, prepend=0.0)), heat, rtol=1e-9)
    removed = (times > 0.2 + 1e-9) & (times < 0.4 + 1e-9)
    assert np.abs(crossing[removed]).max() == 0.0
    assert np.abs(crossing[~removed]).min() > 0.1


def test_a_scheme_that_is_given_is_that_of_its_coefficients(tmp_path):
    names = "*THERMAL SCHEME, TYPE=GALERKIN", "*THERMAL SCHEME, TYPE=FREE"
    given = "4., 1., 3., 2., 1., 1., 2., 4."   # six times as large
    found = [datasets(solve(two.two_blocks(tmp_path / "deck.inp", *cards)), *FIELDS)
             for cards in (names[:1], (names[1], given))]
    assert_alike(*found, 1e-9)


@pytest.mark.parametrize("start", ["BOTH", "OPEN", "CLOSED"])
def test_the_start_of_the_iteration_leaves_the_solution(tmp_path, start):
    found = [datasets(solve(two.two_blocks(tmp_path / "deck.inp", *cards)), *FIELDS)
             for cards in ((), (f"*START, FROM={start}",))]
    assert_alike(*found, 1e-9)


def mirrored(cards):
    """Return the cards with x turned round: elements begin at their other lower corner."""
    turned, inside = [], ""
    for card in cards:
        if card.startswith("*"):
            inside = card.split(",")[0]
        elif inside == "*NODE":
            number, x, y = card.split(", ")
            card = f"{number}, {1.0 - float(x):.15g}, {y}"
        elif inside == "*ELEMENT":
            number, a, b, c, d, ab, bc, cd, da = card.split(", ")
            card = ", ".join((number, b, a, d, c, ab, da, cd, bc))
        elif inside == "*SURFACE":
            card = card[:-1] + {"2": "4", "4": "2"}.get(card[-1], card[-1])
        turned.append(card)
    return turned


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
def test_a_mirrored_twin_finds_the_same(tmp_path, pairing):
    """Two blocks that rub on each other and are heated on one side: all fields vary along x."""
    found = []
    for turn, sign in ((lambda cards: cards, 1), (mirrored, -1)):
        bodies = turn(two.bodies(held=["LOWER.BOTTOM, 1, 2", "UPPER.TOP, 1"]))
        cards = two.contact(pairing=pairing, laws=["*FRICTION", "0.2", *two.LAWS])
        slide = ("*BOUNDARY", f"UPPER.TOP, 2, 2, {two.PRESSED!r}",
                 f"UPPER.TOP, 1, 1, {sign * 4e-3!r}")
        deck = two.write_deck(tmp_path / f"{pairing}{sign}.inp", bodies, cards, TIGHT, two.heated(
            "*CFLUX", "1, 11, 20.", pressed=slide, how=""))
        with h5py.File(solve(deck)) as file:
            face = file["contact/FACE"]
            rows = np.argsort(sign * face["x"][()])
            found.append({name: face[name][()][:, rows] for name in (
                "pressure", "heat_flux", "slave_temperature", "gap", "status")})
            found[-1]["shear"] = sign * face["shear"][()][:, rows]
            found[-1] |= {name: file[f"history/{name}"][()] for name in two.OF_BODIES[:3]}
    assert np.ptp(found[0]["heat_flux"][-1]) > 0.1 * np.abs(found[0]["heat_flux"][-1]).max()
    assert {1, 2} <= set(found[0]["status"].ravel())
    assert_alike(*found, 1e-8)


@pytest.mark.parametrize("scheme", ["L-STABLE", "CRANK-NICOLSON"])
def test_reactions_of_prescribed_temperatures_are_the_heat_that_enters(tmp_path, scheme):
    """With the heat that the nodes there store; a film takes the rest at the other end."""
    prints = [line for name in ("UPPER.TOP", "LOWER.BOTTOM") for line in (
        f"*NODE PRINT, NSET={name}, TOTALS=ONLY", "RFL")]
    course = ["*AMPLITUDE, NAME=A", "0., 0.2, 0.25, 1., 0.5, 0.2"]
    held = ["*BOUNDARY", f"UPPER.TOP, 2, 2, {two.PRESSED!r}", "*BOUNDARY, AMPLITUDE=A",
            f"UPPER.TOP, {HOT}"]
    deck = two.two_blocks(tmp_path / "deck.inp", f"*THERMAL SCHEME, TYPE={scheme}", *course,
                          pressed=(*held, *prints))
    tables = thercon(deck)
    time, stored = two.history(deck.with_suffix(".vtkhdf"), "time", "heat_stored")
    top, bottom = ([tables[t, f"RFL@{name}"][()] for t in sorted({t for t, _ in tables})]
                   for name in ("UPPER.TOP", "LOWER.BOTTOM"))
    assert len(top) == len(time)
    np.testing.assert_allclose(np.add(top, bottom), stored, atol=1e-6 * np.abs(top).max())
    assert min(top) < 0 < max(top) and max(bottom) < 0


@pytest.mark.parametrize(("kind", "pairing"), [
    *((kind, "NODES") for kind in ["CPE8R", "CPS8", "CAX8", "CPE6", "CPE4", "CPE4I", "CPE3", "CAX4"]),
    ("CAX8", "SURFACES")])
def test_heat_balances_in_elements_of_all_kinds(tmp_path, kind, pairing):
    """A uniform source heats insulated bodies as a whole: the heat that is stored is known."""
    bodies = two.bodies(kind, held=["LOWER.BOTTOM, 2", "LOWER, 1", "UPPER, 1"])
    step = ["*STEP, INC=100000", two.COUPLED, "0.05, 0.5", "*BOUNDARY",
            f"UPPER.TOP, 2, 2, {two.PRESSED!r}", "*DFLUX", "UPPER, BF, 30.", "*END STEP"]
    result = solve(two.write_deck(tmp_path / "deck.inp", bodies, two.contact(pairing=pairing),
                                  TIGHT, step))
    volume = np.pi if "CAX" in kind else 1.0
    stored, entering, leaving = two.history(result, "heat_stored", "heat_in", "heat_out")
    np.testing.assert_allclose(stored, 30.0 * volume, rtol=1e-9)
    np.testing.assert_allclose(entering, 30.0 * volume, rtol=1e-9)
    np.testing.assert_allclose(leaving, 0.0, atol=1e-9)


def test_mumps_gives_what_skyline_does(tmp_path):
    found = {}
    for solver in ("SKYLINE", "MUMPS"):
        deck = two.two_blocks(tmp_path / f"{solver}.inp", f"*SOLVER, TYPE={solver}", how="")
        found[solver] = datasets(solve(deck), "contact", "history", "VTKHDF/PointData")
        with h5py.File(deck.with_suffix(".vtkhdf")) as file:
            assert file["run"].attrs["solver"].upper() == solver
        for name in ("heat_imbalance", "heat_imbalance_pointwise", "force_imbalance"):
            assert found[solver].pop(f"history/{name}").max() < 1e-9
    assert_alike(found["SKYLINE"], found["MUMPS"], 1e-10)


@pytest.mark.parametrize(("scheme", "stages"), [("L-STABLE", 2), ("IMPLICIT", 1)])
def test_increments_count_the_passes_of_all_their_stages(tmp_path, scheme, stages):
    """One for each where the conductance is constant."""
    laws = ["*GAP LAW, TYPE=POWER", "0.4, 0., 1."]
    deck = two.write_deck(tmp_path / "deck.inp", two.bodies(), two.contact(laws=laws),
                          two.heated(f"*THERMAL SCHEME, TYPE={scheme}"))
    with h5py.File(solve(deck)) as file:
        assert (file["history/iterations"][:] == stages).all()


@pytest.mark.parametrize("scheme", ["L-STABLE", "IMPLICIT"])
def test_a_stage_that_fails_is_one_of_its_increment(tmp_path, scheme):
    """The listing has its passes."""
    deck = two.write_deck(tmp_path / "deck.inp", two.bodies(), two.contact(), [
        f"*THERMAL SCHEME, TYPE={scheme}", "*FIXED POINT, METHOD=PICARD, TOL=1E-12, MAXITER=2"],
        two.heated())
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 2
    assert "error: increment 1 (time 5E-2): the conductance does not converge" in process.stderr
    rows = [row.split()[:2] for row in deck.with_suffix(".cvg").read_text().splitlines()[1:]]
    assert rows == [["1", "1"], ["1", "2"]]
