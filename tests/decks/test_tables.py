"""Properties over temperature: tables in all planes, elements, analyses and joints.

A table at a uniform temperature is a material with constants, those of an interpolation here; where
temperatures differ, answers are those of tests/reference/tables.py, or of the same problem put in
another way.
"""

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import assert_alike, datasets, pairs, run, solve
from physics import material, mesh, nodes_of, outer_nodes, verify
from scipy.optimize import brentq

import tables

KINDS = ["CPE3", "CPE4", "CPE6", "CPE8", "CPE8R", "CPS3", "CPS4", "CPS6", "CPS8", "CPS8R", "CAX3",
         "CAX4", "CAX6", "CAX8", "CAX8R", "CPE4I", "CPS4I", "CAX4I"]
XS, YS = [1.0, 1.7, 2.4, 3.0], [0.0, 0.5, 1.1]
START, ZERO, WARM = 50.0, 20.0, 230.0
EXACT = 1e-8   # of the largest value: corrections end at 1e-9 of the largest heat and force
STEADY = "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE"
FILES = "VTKHDF/PointData", "contact"

# Rows of constants and a temperature. They are no multiples of each other.
ISOTROPIC = {"elastic": [(1000.0, 0.3, 0.0), (700.0, 0.34, 300.0), (300.0, 0.2, 600.0)],
             "expansion": [(1e-5, 0.0), (1.6e-5, 300.0), (1.8e-5, 600.0)],
             "conductivity": [(2.0, 0.0), (1.3, 300.0), (1.7, 600.0)]}
ENGINEERING = [(1000.0, 400.0, 600.0, 0.3, 0.25, 0.2, 300.0, 250.0, 200.0, 0.0),
               (500.0, 450.0, 200.0, 0.2, 0.3, 0.28, 180.0, 250.0, 200.0, 600.0)]
ORTHOTROPIC = {"elastic": ENGINEERING, "elastic_type": "ENGINEERING CONSTANTS",
               "expansion": [(1e-5, 2e-5, 0.5e-5, 0.0), (1.4e-5, 2.2e-5, 1e-5, 600.0)],
               "expansion_type": "ORTHO",
               "conductivity": [(2.0, 0.7, 2.0, 0.0), (1.0, 0.8, 1.0, 600.0)],
               "conductivity_type": "ORTHO"}
STORING = {"density": [(2.0, 0.0), (1.5, 600.0)], "specific_heat": [(1.0, 0.0), (2.0, 600.0)]}
TURNED = ["*ORIENTATION, NAME=TURNED", "1., 0., 0., 0., 1., 0.", "3, 30."]


def at(rows, temperature):
    """Return the constants of rows at a temperature."""
    values, places = np.array([row[:-1] for row in rows]), [row[-1] for row in rows]
    return tuple(float(np.interp(temperature, places, column)) for column in values.T)


def constants(properties, temperature, start=START, zero=ZERO):
    """Return the material that tables are at a temperature; its expansion makes the same strain."""
    found = {}
    for key, rows in properties.items():
        if not isinstance(rows, list):
            found[key] = rows
        elif key == "expansion":
            ends = [np.array(at(rows, t)) * (t - zero) for t in (temperature, start)]
            found[key] = tuple((ends[0] - ends[1]) / (temperature - start))
        else:
            found[key] = at(rows, temperature)
    return found


def initial(*names, value=START):
    """Return the cards of an initial temperature."""
    return ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", *[f"{name}, {value!r}" for name in names]]


def step(*cards, analysis=STEADY, times="1., 1."):
    """Return a step."""
    return ["*STEP, INC=10000", analysis, times, *cards, "*END STEP"]


def solved(folder, cards, name="deck"):
    """Solve a deck; return its fields and contact points."""
    deck = write(folder / f"{name}.inp", ["*OPTIONS, WIDTH=400, ERRORS=NO"], cards)
    result = solve(deck)
    with h5py.File(result) as file:
        groups = [group for group in FILES if group in file]
        nodes = int(file["VTKHDF/NumberOfPoints"][0])
    return datasets(result, *groups) | {"nodes": nodes}


def history(folder, name="deck"):
    """Return the history of a deck that was solved."""
    return {key.split("/")[1]: values for key, values in datasets(
        folder / f"{name}.vtkhdf", "history").items()}


def last(found, name):
    """Return the values of a field of the nodes at the end."""
    return found[f"VTKHDF/PointData/{name}"][-found["nodes"]:]


# A uniform temperature

def strained(kind, temperature, section="", **properties):
    """Return a body at a temperature, with its outline displaced, but for its top."""
    cards = mesh("BODY", XS, YS, kind, skew=0.0 if kind.startswith("CAX") else 0.06)
    values = []
    for node, (x, y) in outer_nodes(cards).items():
        if y < max(YS) - 1e-9:
            values += [f"{node}, 1, 1, {1e-3 * x - 4e-4 * y:.17g}",
                       f"{node}, 2, 2, {-7e-4 * y + 2e-4 * x * y:.17g}"]
    return [*(TURNED if section else []), *cards, *material("BODY", section=section, zero=ZERO,
                                                            **properties),
            *initial("BODY"), *step("*BOUNDARY", f"BODY, 11, 11, {temperature!r}", *values,
                                    times="0.5, 1.")]


@pytest.mark.parametrize(("kind", "temperature"), [
    *((kind, WARM) for kind in KINDS), ("CPE3", -80.0), ("CPE8", 300.0), ("CAX4I", 900.0)])
def test_a_uniform_temperature_takes_the_constants_of_its_row(tmp_path, kind, temperature):
    """Between rows, in one, and beyond both ends, where the table is held."""
    one = solved(tmp_path, strained(kind, temperature, **ISOTROPIC), "one")
    other = solved(tmp_path, strained(kind, temperature, **constants(ISOTROPIC, temperature)),
                   "other")
    assert_last_alike(one, other)


@pytest.mark.parametrize(("temperature", "told"), [
    (-80.0, "below their first rows, *ELASTIC (0), *EXPANSION (0), *CONDUCTIVITY (0)"), (WARM, None),
    (900.0, "above their last rows, *ELASTIC (600), *EXPANSION (500), *CONDUCTIVITY (600)"),
    (550.0, "above their last rows, *EXPANSION (500)")])
def test_tables_that_a_run_leaves_are_one_warning(tmp_path, temperature, told):
    tables_of = ISOTROPIC | {"expansion": [(1e-5, 0.0), (1.6e-5, 500.0)]}
    deck = write(tmp_path / "deck.inp", strained("CPE4", temperature, **tables_of))
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    found = [line for line in process.stderr.splitlines() if "leaves the tables" in line]
    assert len(found) == (told is not None)
    for line in found:
        where, left = told.split(", ", 1)
        assert f"leaves the tables of BODY {where}, " in line and line.endswith(f"; {left}")
        assert f"temperature {temperature:g} at node" in line


@pytest.mark.parametrize(("analysis", "anneal"), [
    ("HEAT TRANSFER", []), ("COUPLED TEMPERATURE-DISPLACEMENT", ["*ANNEAL TEMPERATURE", "800."])])
def test_tables_of_stress_are_not_left_where_there_is_none(tmp_path, analysis, anneal):
    cards = [*mesh("BODY", XS, YS, "CPE4"), *material("BODY", zero=ZERO, **ISOTROPIC)]
    at = cards.index("*SOLID SECTION, ELSET=BODY, MATERIAL=BODY")
    cards[at:at] = [*(["*PLASTIC", "100."] if anneal else []), *anneal]
    deck = write(tmp_path / "deck.inp", [*cards, *initial("BODY"), "*STEP", f"*{analysis}, STEADY STATE",
                                         "1., 1.", "*BOUNDARY", "BODY.BOTTOM, 1, 2", "BODY, 11, 11, 900.",
                                         "*END STEP"])
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    found = [line for line in process.stderr.splitlines() if "leaves the tables" in line]
    assert len(found) == 1
    assert found[0].endswith("; *CONDUCTIVITY (600)")


@pytest.mark.parametrize("kind", ["CPE8", "CPS8", "CPE8R", "CPE4", "CPS3", "CAX8", "CPS4I"])
def test_orthotropic_constants_of_a_table_turn_with_their_axes(tmp_path, kind):
    section = "" if kind.startswith("CAX") else ", ORIENTATION=TURNED"
    one = solved(tmp_path, strained(kind, WARM, section, **ORTHOTROPIC), "one")
    other = solved(tmp_path, strained(kind, WARM, section, **constants(ORTHOTROPIC, WARM)), "other")
    assert_last_alike(one, other)


def assert_last_alike(one, other, tolerance=EXACT):
    """Assert that the fields at the end of two runs agree."""
    names = [name.split("/")[-1] for name in one if "PointData" in name]
    assert len(names) > 3
    assert_alike(*({name: last(found, name) for name in names} for found in (one, other)),
                 tolerance)


# Tables in which nothing changes

def joined(kind, joint, *more, analysis=STEADY, times="0.25, 1.", method=(), divisions=(3, 3),
           friction=0.2, **properties):
    """Return two blocks, hot above and cold below, with a joint between them: node pairs, mortar
    points or a tie."""
    xs = [[1.0 + 2.0 * k / n for k in range(n + 1)] for n in divisions]
    cards = [*method, *mesh("UP", xs[0], [0.0, 0.4, 1.0], kind),
             *mesh("LOW", xs[1], [-1.0, -0.6, 0.0], kind, first=5001)]
    for body in ("UP", "LOW"):
        cards += material(body, zero=ZERO, **properties)
    if joint == "TIE":
        cards += ["*TIE, NAME=C", "UP.BOTTOM, LOW.TOP"]
    else:
        slides = ["*FRICTION", f"{friction}"] if friction else []
        cards += ["*SURFACE INTERACTION, NAME=C", *slides, "*GAP LAW, TYPE=POWER", "1., 4., 0.5",
                  "*GAP LAW, TYPE=GAS", "0.001, 0.001",
                  f"*CONTACT PAIR, INTERACTION=C, NAME=C, PAIRING={joint}", "UP.BOTTOM, LOW.TOP"]
    return [*cards, *initial("UP", "LOW"), "*BOUNDARY", "LOW.BOTTOM, 1, 2", "UP.LEFT, 1", *more,
            *step("*BOUNDARY", "UP.TOP, 11, 11, 280.", "LOW.BOTTOM, 11, 11, 0.", "*DSLOAD",
                  "UP.TOP, P, 2.", analysis=analysis, times=times)]


def flat(properties):
    """Return tables whose rows beyond 300 differ, and which are constant below."""
    return {key: [(*rows[0][:-1], 0.0), (*rows[0][:-1], 300.0), rows[-1]] if isinstance(rows, list)
            else rows for key, rows in properties.items()}


def single(properties):
    """Return tables of their first row alone."""
    return {key: [rows[0]] if isinstance(rows, list) else rows for key, rows in properties.items()}


@pytest.mark.parametrize(("joint", "kind", "transient"), pairs(
    ["NODES", "SURFACES", "TIE"], ["CPE8", "CAX8", "CPS4"], [False, True]))
def test_tables_that_a_run_leaves_alone_change_nothing(tmp_path, kind, joint, transient):
    """One row, equal rows, and rows that are equal where the run goes."""
    how = {"analysis": "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT"} if transient else {}
    properties = ISOTROPIC | (STORING if transient else {})
    plain = {key: rows[0][:-1] for key, rows in properties.items()}
    expected = solved(tmp_path, joined(kind, joint, **how, **plain), "plain")
    alike = {key: [rows[0], (*rows[0][:-1], 300.0)] for key, rows in properties.items()}
    for name, given in (("single", single(properties)), ("alike", alike)):
        found = solved(tmp_path, joined(kind, joint, **how, **given), name)
        assert_alike(expected, found, 0.0)
    found = solved(tmp_path, joined(kind, joint, **how, **flat(properties)), "flat")
    assert_alike(expected, found, 1e-12)


# Two ways to put a problem

def assert_whole(folder, one, other, tolerance=EXACT, names=("temperature", "displacement")):
    """Assert that two decks have the same fields at the end."""
    first, second = solved(folder, one, "one"), solved(folder, other, "other")
    for name in names:
        a, b = last(first, name), last(second, name)
        np.testing.assert_allclose(b, a, rtol=0, atol=tolerance * np.abs(a).max())


@pytest.mark.parametrize(("joint", "kind", "properties"), pairs(
    ["NODES", "SURFACES", "TIE"], ["CPE8", "CAX6"], [ISOTROPIC, ORTHOTROPIC]))
def test_both_solvers_give_the_same_result(tmp_path, kind, joint, properties):
    divisions = (4, 3) if joint == "SURFACES" else (3, 3)
    one, other = ([*joined(kind, joint, method=[f"*SOLVER, TYPE={solver}"], divisions=divisions,
                           **properties)] for solver in ("SKYLINE", "MUMPS"))
    assert_whole(tmp_path, one, other)


@pytest.mark.parametrize("kind", ["CPE8", "CPS4", "CAX8"])
def test_increments_of_a_steady_state_end_in_one_state(tmp_path, kind):
    """Bodies that are tied have no history."""
    one, other = (joined(kind, "TIE", times=f"{size}, 1.", **ISOTROPIC) for size in (0.1, 1.0))
    assert_whole(tmp_path, one, other)


@pytest.mark.parametrize("kind", ["CPE8", "CPS8R", "CPE4", "CAX6", "CAX4I"])
def test_given_temperatures_strain_as_solved_ones(tmp_path, kind):
    """*STATIC with *TEMPERATURE, and the same field with heat."""
    cards = mesh("BODY", XS, YS, kind)
    fields = {n: 20.0 + 150.0 * y + 40.0 * x * x for n, (x, y) in nodes_of(cards).items()}
    body = [*cards, *material("BODY", zero=ZERO, **ISOTROPIC), *initial("BODY"), "*BOUNDARY",
            "BODY.BOTTOM, 2", "BODY.LEFT, 1"]
    given = [f"{n}, {t:.17g}" for n, t in fields.items()]
    held = [f"{n}, 11, 11, {t:.17g}" for n, t in fields.items()]
    assert_whole(tmp_path, [*body, *step("*TEMPERATURE", *given, analysis="*STATIC")],
                 [*body, *step("*BOUNDARY", *held)], names=("displacement",))


@pytest.mark.parametrize("kind", ["CPE8", "CPS6", "CPE4", "CPE4I"])
def test_orthotropic_tables_of_equal_constants_are_isotropic(tmp_path, kind):
    """In turned axes, with a field that is not uniform."""
    elastic = [(e, 0.3, t) for e, _, t in ISOTROPIC["elastic"]]
    same = {"elastic": [(e, e, e, nu, nu, nu, *3 * [e / 2 / (1 + nu)], t)
                        for e, nu, t in elastic],
            "elastic_type": "ENGINEERING CONSTANTS", "expansion_type": "ORTHO",
            "conductivity_type": "ORTHO",
            "expansion": [(a, a, a, t) for a, t in ISOTROPIC["expansion"]],
            "conductivity": [(k, k, k, t) for k, t in ISOTROPIC["conductivity"]]}
    one, other = (
        [*(TURNED if section else []), *joined(kind, "TIE", section=section, **properties)]
        for section, properties in (("", ISOTROPIC | {"elastic": elastic}),
                                    (", ORIENTATION=TURNED", same)))
    assert_whole(tmp_path, one, other)


def test_a_refined_deck_is_the_deck_of_its_mesh(tmp_path):
    """Rectangles are divided into four."""
    xs, ys = [0.0, 1.0, 2.0], [0.0, 1.0]

    def deck(xs, ys, *more):
        return [*more, *mesh("BODY", xs, ys), *material("BODY", zero=ZERO, **ISOTROPIC),
                *initial("BODY"), "*BOUNDARY", "BODY.BOTTOM, 2", "BODY.LEFT, 1",
                *step("*BOUNDARY", "BODY.LEFT, 11, 11, 500.", "BODY.RIGHT, 11, 11, 0.", "*SFILM",
                      "BODY.TOP, F, 0., 1.")]

    found = [solved(tmp_path, deck(xs, ys, "*REFINE, LEVELS=1"), "refined"),
             solved(tmp_path, deck([0.0, 0.5, 1.0, 1.5, 2.0], [0.0, 0.5, 1.0]), "fine")]
    for name in ("temperature", "displacement"):
        values = [np.sort(last(run, name), axis=0) for run in found]
        np.testing.assert_allclose(*values, rtol=0, atol=EXACT * np.abs(values[0]).max())


# Known answers

@pytest.mark.parametrize("joint", ["NODES", "SURFACES"])
@pytest.mark.parametrize("kind", ["CPE8", "CPE4", "CPS8R", "CPS4I"])
def test_heat_through_two_slabs_and_their_contact(tmp_path, kind, joint):
    """Rectangles are exact where conductivities are linear; each slab has a table of its own."""
    upper, lower = [(2.0, 0.0), (1.0, 600.0)], [(0.5, 0.0), (1.5, 600.0)]
    cards = joined(kind, joint, elastic=(1000.0, 0.0), expansion=0.0, conductivity=9.0,
                   divisions=(3, 3) if joint == "NODES" else (4, 3))
    for table in (upper, lower):
        k = cards.index("9.0")
        cards[k:k + 1] = [f"{value}, {place}" for value, place in table]
    conductance = 1.0 + 4.0 * 2.0**0.5

    def left(flux):
        first = tables.of_integral(upper, tables.integral(upper, 280.0) - flux)
        second = tables.of_integral(lower, flux)
        return conductance * (first - second) - flux

    flux = brentq(left, 1.0, 300.0)
    found = solved(tmp_path, cards)
    np.testing.assert_allclose(found["contact/C/heat_flux"][-1], flux, rtol=EXACT)
    np.testing.assert_allclose(found["contact/C/pressure"][-1], 2.0, rtol=EXACT)
    np.testing.assert_allclose(
        found["contact/C/slave_temperature"][-1],
        tables.of_integral(upper, tables.integral(upper, 280.0) - flux), rtol=EXACT)


SCHEMES = ["IMPLICIT", "GALERKIN", "CRANK-NICOLSON", "EXPLICIT", "L-STABLE"]
CAPACITY = tables.product([(row[0], row[1]) for row in STORING["density"]],
                          [(row[0], row[1]) for row in STORING["specific_heat"]], 400)


@pytest.mark.parametrize(("scheme", "kind", "power"), pairs(
    SCHEMES, ["CPE8", "CAX8R", "CPS3", "CAX4", "CPE6", "CPE4I"], [200.0, -60.0]))
def test_a_body_that_is_warmed_evenly_has_the_enthalpy_that_it_was_given(tmp_path, scheme, kind, power):
    """Heat within it, or cooled below its table, none through its sides; the integral of rho c."""
    cards = [f"*THERMAL SCHEME, TYPE={scheme}", *mesh("BODY", XS, YS, kind),
             *material("BODY", zero=ZERO, **(ISOTROPIC | STORING | {
                 "conductivity": [(1e3, 0.0), (2e3, 600.0)]})), *initial("BODY"),
             *step("*DFLUX", f"BODY, BF, {power!r}", analysis="*HEAT TRANSFER, DIRECT",
                   times="0.4, 4.")]
    found = last(solved(tmp_path, cards), "temperature")
    expected = tables.of_integral(CAPACITY, tables.integral(CAPACITY, START) + 4.0 * power)
    np.testing.assert_allclose(found, expected, rtol=0, atol=2e-5 * abs(expected - START))


@pytest.mark.parametrize(("scheme", "joint", "free"), pairs(
    SCHEMES, ["NODES", "SURFACES", "TIE"], [False, True]))
def test_heat_is_stored_or_leaves(tmp_path, scheme, joint, free):
    """In every increment; and all that a body stores is the change of its content."""
    analysis = "*COUPLED TEMPERATURE-DISPLACEMENT" + ("" if free else ", DIRECT")
    cards = joined("CPE8", joint, method=[f"*THERMAL SCHEME, TYPE={scheme}"], analysis=analysis,
                   times="0.05, 1.", **(ISOTROPIC | STORING))
    solved(tmp_path, cards)
    course = history(tmp_path)
    size = np.max(course["heat_in"] + course["heat_out"])
    off = course["heat_in"] - course["heat_out"] - course["heat_stored"]
    assert np.abs(off[1:]).max() < 1e-10 * size
    assert course["heat_imbalance"].max() < 1e-10
    assert course["force_imbalance"].max() < 1e-9


def test_a_past_counts_with_the_conductivity_that_it_had(tmp_path):
    """A bar of one linear element, k = 1 - 0.007 T, conducts the integral of k. Operators are formed
    again on the way; CRANK-NICOLSON keeps a flux that follows straight lines in equilibrium."""
    falling, course = [(1.0, 0.0), (0.3, 100.0)], {1: 40.0, 2: 90.0, 3: 60.0}
    flux = {time: tables.integral(falling, t) - tables.integral(falling, 0.0)
            for time, t in course.items()}
    solved(tmp_path, ["*THERMAL SCHEME, TYPE=CRANK-NICOLSON",
                      *mesh("BAR", [0.0, 1.0], [0.0, 1.0], "CPE4"),
                      *material("BAR", (1000.0, 0.3), conductivity=falling), "*INITIAL CONDITIONS, "
                      "TYPE=TEMPERATURE", "BAR, 0.", "*AMPLITUDE, NAME=COURSE", ", ".join(
                          ["0., 0.", *(f"{time}., {float(q)!r}" for time, q in flux.items())]),
                      *step("*BOUNDARY", "BAR.LEFT, 11, 11, 0.", "*DFLUX, AMPLITUDE=COURSE",
                            "1, S2, 1.", analysis="*HEAT TRANSFER, STEADY STATE, DIRECT",
                            times="1., 3."), *verify(*(("NT", "BAR.RIGHT", float(time), t, EXACT)
                                                       for time, t in course.items()))])
    assert "operators formed again" in (tmp_path / "deck.lst").read_text()


@pytest.mark.parametrize("scheme", ["IMPLICIT", "GALERKIN", "L-STABLE"])
def test_a_transient_ends_in_the_steady_state(tmp_path, scheme):
    """Those that damp the start and take the present conductance."""
    steady = joined("CPE8", "NODES", friction=None, **ISOTROPIC)
    transient = joined("CPE8", "NODES", method=[f"*THERMAL SCHEME, TYPE={scheme}"], friction=None,
                       analysis="*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", times="0.25, 50.",
                       **(ISOTROPIC | STORING))
    assert_whole(tmp_path, steady, transient, 1e-4, ("temperature",))


def test_a_failed_increment_leaves_no_trace(tmp_path):
    """Too few passes, so that it is cut; smaller ones without friction end in the same state."""
    few, enough = (
        solved(tmp_path, joined("CPE8", "NODES", method=method, times="1., 1.", friction=None,
                                **ISOTROPIC), name)
        for name, method in (("few", ["*FIXED POINT, METHOD=PICARD, MAXITER=4"]), ("enough", ())))
    rows = [line.split() for line in (tmp_path / "few.sta").read_text().splitlines()[1:]]
    assert sum(int(row[5]) for row in rows) > 0
    for name in ("pressure", "heat_flux", "slave_temperature"):
        a, b = (found[f"contact/C/{name}"][-1] for found in (few, enough))
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-6 * np.abs(b).max())
