"""What the cards and parameters of steps that store heat change: two values of each."""

import h5py
import numpy as np
import pytest
from blocks import write
from changes import note_changes
from deck_runs import solve
from physics import follows, judge, material, mesh

import transient

CAPACITY, DENSITY, SOURCE = 2.0, 3.0, 30.0
STEEL = {"elastic": (2.1e11, 0.3), "expansion": 1.2e-5, "density": 7800.0, "specific_heat": 460.0}


def body(*cards, capacity=CAPACITY, name="BODY", **more):
    """Return an insulated square at 20."""
    properties = {"conductivity": 1.0, "density": DENSITY, "specific_heat": capacity} | more
    return [*mesh(name, [0.0, 1.0], [0.0, 1.0], "CPS8"), *material(name, **properties),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"{name}, 20.", *cards]


def step(analysis, times, *cards, first="*STEP, INC=100000"):
    """Return a step."""
    return [first, analysis, times, *cards, "*END STEP"]


def warmed(analysis="*HEAT TRANSFER, DIRECT", times="0.25, 1."):
    """Return a step in which a source warms the body by source over rho c per time."""
    return step(analysis, times, "*DFLUX", f"BODY, BF, {SOURCE!r}")


def rise(time, capacity=CAPACITY):
    """Return the check of the temperature at a time."""
    return [("NT", "BODY", "LAST", 20.0 + SOURCE * time / (DENSITY * capacity), 1e-10)]


@pytest.mark.changes("SPECIFIC HEAT")
def test_specific_heat(tmp_path):
    def make(capacity):
        return [*body(capacity=capacity), *warmed()], rise(1.0, capacity)

    follows(tmp_path, make, 2.0, 5.0)


@pytest.mark.changes("HEAT TRANSFER")
def test_period_of_a_transient(tmp_path):
    def make(period):
        return [*body(), *warmed(times=f"0.25, {period!r}")], rise(period)

    follows(tmp_path, make, 1.0, 2.0)


@pytest.mark.changes("UNCOUPLED TEMPERATURE-DISPLACEMENT")
def test_period_of_an_uncoupled_step(tmp_path):
    def make(period):
        cards = body(elastic=(1000.0, 0.3))
        held = ["*BOUNDARY", "BODY.LEFT, 1", "BODY.BOTTOM, 2"]
        return [*cards, *step("*UNCOUPLED TEMPERATURE-DISPLACEMENT", f"0.25, {period!r}", *held,
                              "*DFLUX", f"BODY, BF, {SOURCE!r}")], rise(period)

    follows(tmp_path, make, 1.0, 2.0)


def wall(analysis):
    """Return half a wall whose face is at 100 at once."""
    xs = [float(x) for x in np.linspace(0.0, 1.0, 81)]
    held = []
    if not analysis.startswith("*HEAT"):
        held = ["*BOUNDARY", "BODY.LEFT, 1", "BODY, 2"]
    return [*mesh("BODY", xs, [0.0, xs[1]], "CPE8"),
            *material("BODY", (1000.0, 0.3), conductivity=1.0, density=1.0, specific_heat=1.0),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.",
            *step(analysis, "0.01, 0.2, 1.E-9", *held, "*BOUNDARY", "BODY.LEFT, 11, 11, 100.")]


def course(folder, cards, name):
    """Return times and nodal temperatures of a deck."""
    result = solve(write(folder / f"{name}.inp", cards))
    with h5py.File(result) as file:
        times = file["VTKHDF/Steps/Values"][:]
        return times, file["VTKHDF/PointData/temperature"][:].reshape(len(times), -1)


ANALYSES = [pytest.param(f"*{name}", id=name) for name in
            ("HEAT TRANSFER", "COUPLED TEMPERATURE-DISPLACEMENT")]


@pytest.mark.parametrize("analysis", [
    pytest.param(f"*{name}", marks=pytest.mark.changes(f"{name}, LOCAL ERROR"))
    for name in ("HEAT TRANSFER", "COUPLED TEMPERATURE-DISPLACEMENT")])
def test_a_tenth_of_the_local_error_takes_more_increments_and_errs_less(tmp_path, analysis):
    """The estimate falls with the square of the increments: a hundredth takes ten times as many, but
    for the first ones, which are no shorter than heat takes to cross an element."""
    decks = [wall(f"{analysis}, LOCAL ERROR={part}") for part in ("1.E-2", "1.E-4")]
    (times, rough), (more_times, fine) = (course(tmp_path, deck, f"d{k}")
                                          for k, deck in enumerate(decks))
    exact = 100.0 * transient.mean_of_shocked_wall(0.2)
    errors = [abs(found[-1].mean() - exact) for found in (rough, fine)]
    assert 5.0 < len(more_times) / len(times) < 20.0
    mean = [transient.shocked_wall(x, 0.2) * 100.0 for x in (0.25, 0.5, 1.0)]
    assert np.ptp(rough[-1]) < 100.0 and min(mean) > 0.0
    assert max(errors) < 2.0   # means over nodes, not over the volume
    note_changes(*decks)


@pytest.mark.parametrize("analysis", [
    pytest.param(f"*{name}", marks=pytest.mark.changes(f"{name}, DELTMX"))
    for name in ("HEAT TRANSFER", "COUPLED TEMPERATURE-DISPLACEMENT")])
def test_no_temperature_changes_by_more_than_deltmx(tmp_path, analysis):
    decks = [wall(f"{analysis}, LOCAL ERROR=1., DELTMX={most}") for most in (20.0, 5.0)]
    for most, deck in zip((20.0, 5.0), decks, strict=True):
        _, found = course(tmp_path, deck, f"d{most:.0f}")
        free = found[0] < 99.9
        changes = np.abs(np.diff(np.vstack([np.zeros_like(found[0]), found]), axis=0))
        assert changes[:, free].max() <= 1.1 * most   # an increment may exceed 1.2 of its square
        assert changes[:, free].max() > 0.3 * most
    note_changes(*decks)


@pytest.mark.changes("COUPLED TEMPERATURE-DISPLACEMENT, DILATATION")
def test_a_stretched_plate_cools_with_dilatation_alone(tmp_path):
    """Kelvin: alpha T0 sigma/(rho c_p), T0 293 K, 100 MPa."""
    cooling = 1.2e-5 * 293.0 * 1e8 / (7800.0 * 460.0)

    def make(how):
        return ["*PHYSICAL CONSTANTS, ABSOLUTE ZERO=-273.", *body(**STEEL),
                *step(f"*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT, DILATATION={how}", "0.5, 1.",
                      "*BOUNDARY", "BODY.LEFT, 1", "BODY.BOTTOM, 2",
                      "*DSLOAD", "BODY.TOP, P, -1.E8")], [
            ("NT", "BODY", "LAST", 20.0 - cooling * (how == "YES"), 1e-9)]

    follows(tmp_path, make, "YES", "NO")


@pytest.mark.changes("THERMAL SCHEME, TYPE")
def test_schemes_of_stored_heat_differ(tmp_path):
    """One increment of a square that a film cools: T is R(z) of the start, z = -h dt/(rho c)."""
    z = -1.0
    gamma = 1.0 - np.sqrt(0.5)
    factors = {"IMPLICIT": 1.0 / (1.0 - z), "CRANK-NICOLSON": (1.0 + z / 2) / (1.0 - z / 2),
               "L-STABLE": (1.0 + (1.0 - 2.0 * gamma) * z) / (1.0 - gamma * z) ** 2}

    def make(scheme):
        cards = body(conductivity=1e6, density=1.0, capacity=1.0)
        return [*cards, *step("*HEAT TRANSFER, DIRECT", "1., 1.", "*SFILM",
                              "BODY.LEFT, F, 0., 1."),
                ][:-4] + ["*THERMAL SCHEME, TYPE=" + scheme, "*SFILM", "BODY.LEFT, F, 0., 1.",
                          "*END STEP"], [("NT", "BODY", "LAST", 20.0 * factors[scheme], 3e-6)]

    for one, other in (("IMPLICIT", "CRANK-NICOLSON"), ("L-STABLE", "IMPLICIT")):
        follows(tmp_path, make, one, other)


# Two sets of time points, and the times that they are.

POINTS = ["*TIME POINTS, NAME=ODD", "0.3, 0.7", "*TIME POINTS, NAME=EVEN, GENERATE", "0.2, 0.8, 0.2"]
TIMES = {"ODD": [0.3, 0.7, 1.0], "EVEN": [0.2, 0.4, 0.6, 0.8, 1.0]}
QUIET = ["*NODE FILE, FREQUENCY=0", "NT"]


def output(points, *cards):
    """Return a deck of heat with output cards."""
    return [*body(), *points, *step("*HEAT TRANSFER, LOCAL ERROR=1.", "0.1, 1.", "*DFLUX",
                                    f"BODY, BF, {SOURCE!r}", *cards)]


def field_times(folder, cards):
    """Return the times of the fields of a deck."""
    with h5py.File(solve(write(folder / "deck.inp", cards))) as file:
        return file["VTKHDF/Steps/Values"][:]


@pytest.mark.parametrize("keyword", [
    pytest.param(keyword, marks=pytest.mark.changes(f"{keyword}, TIME POINTS"))
    for keyword in ("NODE FILE", "EL FILE", "CONTACT FILE")])
def test_fields_are_those_of_the_time_points(tmp_path, keyword):
    decks = [output(POINTS, f"*{keyword}, TIME POINTS={name}") for name in TIMES]
    for deck, times in zip(decks, TIMES.values(), strict=True):
        np.testing.assert_allclose(field_times(tmp_path, deck), times, rtol=1e-12)
    note_changes(*decks)


@pytest.mark.parametrize(("keyword", "data", "title"), [
    pytest.param("NODE PRINT, NSET=BODY", "NT", "NODES OF",
                 marks=pytest.mark.changes("NODE PRINT, TIME POINTS")),
    pytest.param("EL PRINT, ELSET=BODY", "HFL", "INTEGRATION POINTS OF",
                 marks=pytest.mark.changes("EL PRINT, TIME POINTS"))])
def test_tables_are_those_of_the_time_points(tmp_path, keyword, data, title):
    decks = [output(POINTS, *QUIET, f"*{keyword}, TIME POINTS={name}", data) for name in TIMES]
    for deck, times in zip(decks, TIMES.values(), strict=True):
        field_times(tmp_path, deck)
        listing = (tmp_path / "deck.lst").read_text()
        assert listing.count(title) == len(times)
    note_changes(*decks)


@pytest.mark.changes("CONTACT PRINT, TIME POINTS")
def test_tables_of_contact_are_those_of_the_time_points(tmp_path):
    decks = [[*contact(), *POINTS, *step("*HEAT TRANSFER, LOCAL ERROR=1.", "0.1, 1.", "*BOUNDARY",
                                         "BODY.LEFT, 11, 11, 50.", *QUIET,
                                         f"*CONTACT PRINT, TIME POINTS={name}")]
             for name in TIMES]
    for deck, times in zip(decks, TIMES.values(), strict=True):
        field_times(tmp_path, deck)
        assert (tmp_path / "deck.lst").read_text().count("CONTACT POINTS OF FACE") == len(times)
    note_changes(*decks)


def contact():
    """Return two squares that conduct into each other."""
    more = {"conductivity": 1.0, "density": DENSITY, "specific_heat": CAPACITY}
    return [*body(), *mesh("OTHER", [1.0, 2.0], [0.0, 1.0], "CPS8", first=1001),
            *material("OTHER", **more), "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "OTHER, 20.",
            "*SURFACE INTERACTION, NAME=FACES", "*GAP CONDUCTANCE", "5., 0.", "5., 1.",
            "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "BODY.RIGHT, OTHER.LEFT"]


@pytest.mark.changes("TIME POINTS", "TIME POINTS, NAME", "TIME POINTS, GENERATE",
                     "TIME POINTS, TIME")
def test_time_points(tmp_path):
    """Times, or start, end and interval; of the step or total, here of a second step."""
    before = step("*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY", "BODY.LEFT, 11, 11, 20.")
    known = {("*TIME POINTS, NAME=A", "0.3, 0.7"): [1.3, 1.7],
             ("*TIME POINTS, NAME=A", "0.25"): [1.25],
             ("*TIME POINTS, NAME=A, TIME=TOTAL TIME", "0.3, 1.7"): [1.7],
             ("*TIME POINTS, NAME=A, GENERATE", "0.25, 0.75, 0.25"): [1.25, 1.5, 1.75]}
    decks = []
    for cards, times in known.items():
        decks.append([*body(), *cards, *before, *step(
            "*HEAT TRANSFER, LOCAL ERROR=1.", "0.1, 1.", "*NODE FILE, TIME POINTS=A", "NT")])
        np.testing.assert_allclose(field_times(tmp_path, decks[-1]), [1.0, *times, 2.0])
    for deck in decks[1:]:
        note_changes(decks[0], deck)
    renamed = [card.replace("=A", "=B") for card in decks[0]]
    np.testing.assert_allclose(field_times(tmp_path, renamed), [1.0, 1.3, 1.7, 2.0])
    note_changes(decks[0], renamed)


def test_a_steady_step_is_a_start_in_equilibrium(tmp_path):
    """Nothing changes behind it, whatever the scheme."""
    ends = ["*BOUNDARY", "BODY.LEFT, 11, 11, 20.", "BODY.RIGHT, 11, 11, 80."]
    deck = [*body(), *step("*HEAT TRANSFER, STEADY STATE", "1., 1.", *ends),
            *step("*HEAT TRANSFER, DIRECT", "0.1, 1.")]
    judge(tmp_path, deck, [("NT", "BODY.RIGHT", "LAST", 80.0, 1e-12),
                           ("heat_stored", "", "LAST", 0.0, 1e-10, "ABS"),
                           ("heat_in", "", "LAST", 60.0, 1e-10)])
