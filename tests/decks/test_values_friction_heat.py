"""Heat of friction and radiation as Abaqus writes it: two values of each field and parameter."""

import math

import h5py
import numpy as np
import pytest
from blocks import write
from deck_runs import run
from physics import follows, judge, material, mesh, nodes_of
from scipy.optimize import brentq
from test_gap_heat import SIGMA, slabs
from test_physics_schemes import step
from test_values_contact import K, PRESSURE, pressed

OMEGA, MU = 4.0, 0.3
LAWS = ["*GAP LAW, TYPE=POWER", f"{OMEGA!r}, 0., 1.", "*FRICTION", f"{MU!r}"]


def faces_of(power, share):
    """Return the temperatures of both faces of the blocks of `pressed`, 80 above and 0 below."""
    upper, lower, omega = K / 0.5, K / 1.0, OMEGA
    matrix = np.array([[upper + omega, -omega], [-omega, lower + omega]])
    return np.linalg.solve(matrix, [upper * 80.0 + share * power, (1 - share) * power])


@pytest.mark.changes("GAP HEAT GENERATION")
@pytest.mark.parametrize("other", [(0.8, 0.3, 7.0), (1.0, 0.5, 7.0), (1.0, 0.3, 9.0)])
def test_every_field_of_the_heat_of_friction(tmp_path, other):
    def make(values):
        eta, share, speed = values
        power = eta * MU * PRESSURE * speed
        slave, master = faces_of(power, share)
        return pressed(*LAWS, "*GAP HEAT GENERATION", f"{eta!r}, {share!r}, {speed!r}"), [
            ("heat_friction", "", "LAST", power, 1e-10),
            ("slave_temperature", "FACE", "LAST", slave, 1e-10),
            ("master_temperature", "FACE", "LAST", master, 1e-10),
            ("shear", "FACE", "LAST", 0.0, 1e-12, "ABS")]

    follows(tmp_path, make, (1.0, 0.3, 7.0), other)


def test_the_card_may_be_before_the_friction_and_has_defaults(tmp_path):
    heating = ["*GAP HEAT GENERATION", ", , 7."]
    power = MU * PRESSURE * 7.0
    slave, master = faces_of(power, 0.5)
    for laws in ([*LAWS, *heating], [*heating, *LAWS]):
        judge(tmp_path, pressed(*laws), [("slave_temperature", "FACE", "LAST", slave, 1e-10),
                                         ("master_temperature", "FACE", "LAST", master, 1e-10)])


def test_a_largest_shear_bounds_the_heat(tmp_path):
    laws = [*LAWS[:2], "*FRICTION, TAUMAX=1.2", f"{MU!r}", "*GAP HEAT GENERATION", "1., 0.5, 7."]
    judge(tmp_path, pressed(*laws), [("heat_friction", "", "LAST", 1.2 * 7.0, 1e-10)])


def test_open_faces_make_no_heat(tmp_path):
    laws = ["*GAP LAW, TYPE=GAS", "0.8, 0.1", "*FRICTION", "0.3", "*GAP HEAT GENERATION",
            "1., 0.5, 7."]
    judge(tmp_path, pressed(*laws, gap=0.1), [("heat_friction", "", "LAST", 0.0, 0.0, "ABS")])


def test_later_steps_have_the_heat_of_their_friction(tmp_path):
    """A step of heat alone keeps the pressure; friction changes; faces that are removed make none."""
    laws, heat = [*LAWS, "*GAP HEAT GENERATION", "1., 0.3, 7."], MU * PRESSURE * 7.0
    later = [*step("heat"),
             *step("coupled", "*CHANGE FRICTION, INTERACTION=FACES", "*FRICTION", f"{2 * MU!r}"),
             *step("coupled", "*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE",
                   "UPPER.BOTTOM, LOWER.TOP", "*BOUNDARY", "UPPER.TOP, 2")]
    judge(tmp_path, [*pressed(*laws), *later], [
        ("heat_friction", "", f"{time}.", value, 1e-10 if value else 0.0, "REL" if value else "ABS")
        for time, value in ((1, heat), (2, heat), (3, 2 * heat), (4, 0.0))])


def test_heat_before_mechanics_is_that_of_the_increment_before(tmp_path):
    """The pressure ramps; the heat of the second increment is that of the first."""
    laws = [*LAWS, "*GAP HEAT GENERATION", "1., 0.3, 7."]
    deck = [card.replace("*COUPLED", "*UNCOUPLED") if card.startswith("*COUPLED") else card
            for card in pressed(*laws)]
    deck[deck.index("1., 1.")] = "0.5, 1."
    judge(tmp_path, deck, [("heat_friction", "", "0.5", 0.0, 0.0, "ABS"),
                           ("heat_friction", "", "1.", MU * PRESSURE / 2 * 7.0, 1e-10)])


def ring(velocity):
    """Return rings that turn on each other, and the heat of their friction."""
    radii = [1.0, 1.4, 2.0]
    deck = [*mesh("UPPER", radii, [0.0, 0.5], "CAX8"),
            *mesh("LOWER", radii, [-1.0, 0.0], "CAX8", first=101)]
    for name in ("UPPER", "LOWER"):
        deck += material(name, (1000.0, 0.0), 0.0, K)
    return [*deck, "*SURFACE INTERACTION, NAME=FACES", *LAWS,
            f"*GAP HEAT GENERATION, ANGULAR VELOCITY={velocity!r}",
            "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "UPPER.BOTTOM, LOWER.TOP",
            *step("coupled", "*BOUNDARY", "LOWER.BOTTOM, 2", "LOWER.BOTTOM, 11, 11, 0.",
                  "*DSLOAD", f"UPPER.TOP, P, {PRESSURE!r}")], [
        ("heat_friction", "", "LAST", 2 * math.pi * MU * PRESSURE * velocity * 7 / 3, 1e-10)]


@pytest.mark.changes("GAP HEAT GENERATION, ANGULAR VELOCITY")
def test_turning_faces_slide_with_the_radius(tmp_path):
    follows(tmp_path, ring, 3.0, 5.0)


def slid(scheme, pairing="NODES", expansion=0.0, young=1e5, times="0.1, 1.2"):
    """Return blocks of which one is pressed, then slid by 0.1 until the time 1, then at rest."""
    deck = [*mesh("LOWER", [0.0, 1.0, 2.0, 3.0], [0.0, 1.0]),
            *mesh("UPPER", [0.0, 1.0, 2.0, 3.0], [1.0, 2.0], first=101)]
    for name in ("UPPER", "LOWER"):
        deck += material(name, (young, 0.3), expansion, K, density=1.0, specific_heat=2.0)
    return [*deck, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LOWER, 0.", "UPPER, 0.",
            "*SURFACE INTERACTION, NAME=FACES", *LAWS, "*GAP HEAT GENERATION", "0.9, 0.2",
            f"*CONTACT PAIR, INTERACTION=FACES, NAME=FACE, PAIRING={pairing}",
            "UPPER.BOTTOM, LOWER.TOP",
            "*BOUNDARY", "LOWER.BOTTOM, 1, 2, 0.", "UPPER.TOP, 1, 1, 0.",
            "*AMPLITUDE, NAME=SLIDE", "0., 0., 1., 1., 2., 1.",
            "*STEP", "*STATIC", "1., 1.", "*DSLOAD", f"UPPER.TOP, P, {PRESSURE!r}", "*END STEP",
            "*STEP, INC=1000", "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", times,
            f"*THERMAL SCHEME, TYPE={scheme}",
            "*BOUNDARY, AMPLITUDE=SLIDE", "UPPER.TOP, 1, 1, 0.1", "*END STEP"]


def course_of(folder, deck):
    """Solve a deck; return the columns of its history, and its file."""
    path = write(folder / "deck.inp", ["*OPTIONS, ERRORS=NO"], deck)
    process = run("run", "--quiet", path, "--out", folder)
    assert process.returncode == 0, process.stderr
    with h5py.File(path.with_suffix(".vtkhdf")) as file:
        courses = {name: file[f"history/{name}"][()] for name in
                   ("time", "heat_friction", "heat_stored", "heat_in", "heat_out",
                    "heat_imbalance", "heat_imbalance_pointwise")}
        courses |= {name: file[f"contact/FACE/{name}"][()] for name in ("shear_force", "slip")}
    return courses


SCHEMES = ["L-STABLE", "IMPLICIT", "CRANK-NICOLSON", "GALERKIN", "EXPLICIT"]


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_heat_is_the_work_of_friction_and_balances(tmp_path, scheme, pairing):
    courses = course_of(tmp_path, slid(scheme, pairing, expansion=1e-3))
    made, transient = courses["heat_friction"], ~np.isnan(courses["heat_stored"])
    scale = np.nanmax(made)
    rest = (courses["heat_in"] + made - courses["heat_out"] - courses["heat_stored"])[transient]
    assert np.max(np.abs(rest)) < 1e-10 * scale
    assert np.nanmax(courses["heat_imbalance"][transient]) < 1e-10
    if scheme in SCHEMES[:2]:   # others have the conductance of the start, too
        assert np.nanmax(courses["heat_imbalance_pointwise"][transient]) < 1e-10


@pytest.mark.parametrize("scheme", SCHEMES)
def test_slip_that_ends_within_an_increment_heats_by_its_work(tmp_path, scheme):
    """The bodies are so stiff that only friction takes up work, and end at one temperature."""
    deck = [*slid(scheme, young=1e10, times="0.07, 1.19"),
            "*STEP, INC=1000", "*HEAT TRANSFER, DIRECT", "1., 40.", "*END STEP"]
    if scheme == "CRANK-NICOLSON":   # never damps
        deck[-3:-3] = ["*THERMAL SCHEME, TYPE=IMPLICIT"]
    work = MU * PRESSURE * 3.0 * 0.1
    rise = 0.9 * work / (2.0 * 3.0 * 2.0)
    judge(tmp_path, deck, [("ALLFD", "", 2.19, work, 1e-6),
                           ("NT", "MIN", "LAST", rise, 1e-6), ("NT", "MAX", "LAST", rise, 1e-6)])


@pytest.mark.parametrize("later", ["HEAT TRANSFER, DIRECT", "HEAT TRANSFER, STEADY STATE"])
def test_a_step_of_heat_alone_has_no_slip(tmp_path, later):
    """Behind one that ends while the upper block slides at 0.1, with 0.9 of the work as heat."""
    deck = [*slid("IMPLICIT", young=1e10, times="0.1, 0.5"), "*STEP", f"*{later}", "1., 1.",
            "*BOUNDARY", "LOWER.BOTTOM, 11", "*END STEP"]
    judge(tmp_path, deck, [("heat_friction", "", 1.5, 0.9 * MU * PRESSURE * 3.0 * 0.1, 1e-6),
                           ("heat_friction", "", 2.5, 0.0, 0.0, "ABS")])


def test_heat_of_the_increment_before_is_none_behind_a_static_step(tmp_path):
    """The explicit scheme takes it; the block goes on at 0.1 in all steps."""
    deck = slid("EXPLICIT", young=1e10, times="0.1, 0.5")
    at = deck.index("*STEP")
    judge(tmp_path, [
        *deck[:at], "*AMPLITUDE, NAME=FIRST", "0., 0.5, 1., 1.5", "*AMPLITUDE, NAME=LAST",
        "0., 1.5, 1., 2.5", *deck[at:], "*STEP", "*STATIC", "0.5, 1.", "*BOUNDARY, AMPLITUDE=FIRST",
        "UPPER.TOP, 1, 1, 0.1", "*END STEP", "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT",
        "0.1, 0.5", "*THERMAL SCHEME, TYPE=EXPLICIT", "*BOUNDARY, AMPLITUDE=LAST",
        "UPPER.TOP, 1, 1, 0.1", "*END STEP"], [
        ("heat_friction", "", time, heat, 1e-6, *how) for time, heat, *how in (
            (1.5, 0.9 * MU * PRESSURE * 0.3), (2.6, 0.0, "ABS"), (2.7, 0.9 * MU * PRESSURE * 0.3))])


@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize(("scheme", "times"), [
    ("CRANK-NICOLSON", "0.1, 20."), ("CRANK-NICOLSON", "0.05, 12."), ("CRANK-NICOLSON", "0.02, 4."),
    ("GALERKIN", "0.05, 12."), ("GALERKIN", "0.02, 4."), ("L-STABLE", "0.1, 20.")])
def test_blocks_come_to_rest_after_they_slid(tmp_path, scheme, pairing, times):
    """Slips become the rounding of positions, and the heat that they make no longer converges."""
    made = course_of(tmp_path, slid(scheme, pairing, 3e-3, times=times))["heat_friction"]
    assert abs(made[-1]) < 0.01 * np.nanmax(made)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_bodies_that_do_not_expand_slide_at_a_rate(tmp_path, scheme):
    """Where the whole face slides, at the speed of the top, heat is the friction times that."""
    courses = course_of(tmp_path, slid(scheme))
    slides = np.abs(courses["time"] - 1.6) < 1e-9
    work = MU * PRESSURE * 3.0 * 0.1
    assert courses["heat_friction"][slides] == pytest.approx(0.9 * work, rel=1e-9)
    at_rest = np.abs(courses["time"] - 2.2) < 1e-9
    assert courses["heat_friction"][at_rest] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(("scheme", "part"), [("CRANK-NICOLSON", 0.5), ("GALERKIN", 2 / 3),
                                              ("IMPLICIT", 1.0)])
def test_both_faces_have_the_heat_of_both_ends_of_an_increment(tmp_path, scheme, part):
    """Faces that slide at a given speed, on insulated bodies that conduct so well that they have one
    temperature: pressure rises from 10 to 30 in the one increment, which has parts of both heats."""
    speed, share, capacity, mean = 7.0, 0.2, 2.0, (1 - part) * 10.0 + part * 30.0
    deck = [*mesh("UPPER", [0.0, 1.0, 2.0], [0.0, 1.0], "CPE4"),
            *mesh("LOWER", [0.0, 1.0, 2.0], [-1.0, 0.0], "CPE4", first=101)]
    for name in ("UPPER", "LOWER"):
        deck += material(name, (1000.0, 0.0), 0.0, 1e8, 1.0, capacity)
    pressing = ["*DSLOAD, AMPLITUDE=COURSE", "UPPER.TOP, P, 1."]
    judge(tmp_path, [
        *deck, "*SURFACE INTERACTION, NAME=FACES", "*FRICTION", f"{MU!r}", "*GAP HEAT GENERATION",
        f"1., {share!r}, {speed!r}", "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE",
        "UPPER.BOTTOM, LOWER.TOP", "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "UPPER, 0.",
        "LOWER, 0.", "*AMPLITUDE, NAME=COURSE, TIME=TOTAL TIME", "0., 0., 1., 10., 2., 30.",
        "*BOUNDARY", "UPPER, 1", "LOWER, 1", "LOWER.BOTTOM, 2",
        "*STEP", "*STATIC", "1., 1.", *pressing, "*END STEP",
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", "1., 1.",
        f"*THERMAL SCHEME, TYPE={scheme}", *pressing, "*END STEP"], [
        ("NT", "UPPER", "LAST", share * MU * mean * speed / capacity, 1e-6),
        ("NT", "LOWER", "LAST", (1 - share) * MU * mean * speed / capacity, 1e-6)])


def bar_on_a_wall(number, pressure=1.0, analysis="STEADY STATE", times="1., 1.", k=1.0):
    """Return a bar on an insulating wall that slides, S = mu V E alpha L/k, pressed and cold at its
    other end; the wall, which is cold, conducts k. Another pair, in front of it, is open."""
    idle = [card for name, at in (("IDLE", 3.0), ("BACK", 1.5)) for card in (
        *mesh(name, [at, at + 1.0], [0.0, 0.25], "CPS8", first=int(200 * at)),
        *material(name, (1000.0, 0.0), 0.0, 1.0))]
    bar = mesh("BAR", np.linspace(0.0, 1.0, 5), [0.0, 0.25], "CPS8")
    wall = mesh("WALL", [-0.25, 0.0], [0.0, 0.25], "CPS8", first=101)
    return [*bar, *material("BAR", (1000.0, 0.0), (1e-3, 0.0, 0.0), 1.0, density=1.0,
                            specific_heat=1.0, expansion_type="ORTHO"),
            *wall, *material("WALL", (1000.0, 0.0), 0.0, k), *idle,
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BAR, 0.", "WALL, 0.", "IDLE, 0.", "BACK, 0.",
            "*BOUNDARY", *(f"{name}, {dofs}, 0." for name in ("IDLE", "BACK") for dofs in (
                "1, 2", "11, 11")), "*SURFACE INTERACTION, NAME=FACES", "*FRICTION", "0.5",
            "*GAP HEAT GENERATION", f"1., 1., {2 * number!r}",
            "*CONTACT PAIR, INTERACTION=FACES, NAME=OPEN", "IDLE.LEFT, BACK.RIGHT",
            "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "BAR.LEFT, WALL.RIGHT",
            "*STEP, INC=1000", f"*COUPLED TEMPERATURE-DISPLACEMENT, {analysis}", times,
            "*BOUNDARY", "WALL, 1, 2, 0.", "WALL, 11, 11, 0.", "BAR.BOTTOM, 2, 2, 0.",
            f"BAR.RIGHT, 1, 1, {-pressure / 1000!r}", "BAR.RIGHT, 11, 11, 0.", "*END STEP"]


@pytest.mark.changes("GAP HEAT GENERATION")
@pytest.mark.parametrize("k", [1.0, [(1.0, 0.0), (2.0, 100.0)]])
def test_the_gain_of_a_bar_on_a_sliding_wall_is_half_of_its_number(tmp_path, k):
    def make(number):
        pressure = 1 / (1 - number / 2)
        return bar_on_a_wall(number, k=k), [
            ("coupling_gain", "", "LAST", number / 2, 1e-9),
            ("coupling_gain_max", "", "LAST", number / 2, 1e-9),
            ("pressure", "FACE", "LAST", pressure, 1e-9),
            ("NT", "BAR.LEFT", "LAST", number * pressure, 1e-9)]

    follows(tmp_path, make, 1.0, 1.5)


def test_gain_and_newtons_method_know_heat_and_conductance_together(tmp_path):
    """With h = 0.5 + 0.1 p to the wall the face has T = q/(1 + h) and the pressure 1 + T/2 from the
    heat q = S p: the gain is that of h and q together."""
    number, touching, rise = 1.0, 0.5, 0.1
    cards = bar_on_a_wall(number)
    at = cards.index("*FRICTION")
    cards[at:at] = ["*GAP LAW, TYPE=POWER", f"{touching!r}, {rise!r}, 1."]
    pressure = brentq(lambda p: p - 1 - number * p / (1 + touching + rise * p) / 2, 0.1, 10.0,
                      xtol=1e-14)
    series = 1 + touching + rise * pressure
    gain = number / series / 2 - rise * number * pressure / series**2 / 2
    judge(tmp_path, ["*FIXED POINT, METHOD=NEWTON, TOL=1E-11", *cards], [
        ("pressure", "FACE", "LAST", pressure, 1e-9), ("coupling_gain", "", "LAST", gain, 1e-9),
        ("coupling_gain_max", "", "LAST", gain, 1e-9)])
    rows = (tmp_path / "deck.cvg").read_text().splitlines()[1:]
    before, last = (float(row.split()[2]) for row in rows[-2:])
    assert last < before**2


def test_above_the_critical_speed_no_steady_state_presses_the_bar(tmp_path):
    deck = write(tmp_path / "bar.inp", bar_on_a_wall(2.5, analysis="STEADY STATE, DIRECT"))
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 2
    assert "the heat of friction and the contact do not converge together" in process.stderr


def test_an_increment_that_hides_growth_is_warned_of(tmp_path):
    """Slowly growing modes have the rate 0.5965; an implicit increment of 20 stays where it is."""
    cards = bar_on_a_wall(2.5, analysis="DIRECT", times="20., 20.")
    start = cards.index("BAR, 0.")   # steady: under a pressure of 1 from 2.5 to 0
    cards[start:start + 1] = [f"{node}, {2.5 * (1 - x)!r}" for node, (x, _) in
                              nodes_of(cards[:start]).items() if node < 100]
    at = next(i for i, card in enumerate(cards) if card.startswith("*STEP"))
    presses = ["*STEP", "*STATIC", "1., 1.",
               *(card for card in cards[at + 3:] if ", 11, " not in card)]
    deck = write(tmp_path / "bar.inp", cards[:at], presses, cards[at:at + 3],
                 ["*THERMAL SCHEME, TYPE=IMPLICIT"], cards[at + 3:])
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert "det(I - U') is negative: the increment is too long" in process.stderr, process.stderr


@pytest.mark.changes("GAP RADIATION")
@pytest.mark.parametrize("other", [(0.5, 0.6, 1.0), (0.8, 0.9, 1.0), (0.8, 0.6, 0.7)])
def test_radiation_as_abaqus_has_it(tmp_path, other):
    def make(values):
        one, two, factor = values
        law = ["*GAP RADIATION", f"{one!r}, {two!r}", f"{factor!r}, 0.", f"{factor!r}, 0.5"]
        flux = factor / (1 / one + 1 / two - 1) * SIGMA * (1000.0**4 - 400.0**4)
        deck = slabs(law, (1000.0, 400.0), flux)
        verify = next(i for i, card in enumerate(deck) if card.startswith("*VERIFY"))
        return deck[:verify], [("heat_flux", "FACE", "LAST", flux, 1e-9),
                               ("slave_temperature", "FACE", "LAST", 1000.0, 1e-9)]

    follows(tmp_path, make, (0.8, 0.6, 1.0), other)


def test_the_view_factor_falls_with_the_clearance(tmp_path):
    """The gap of 5E-5 lies in the middle of a table that falls to 0; beyond it nothing radiates."""
    whole = SIGMA * (1000.0**4 - 400.0**4) / (1 / 0.8 + 1 / 0.6 - 1)
    gas = 0.1 / (5e-5 + 1e-6) * 600
    for end, seen in ((1e-4, 0.5), (2e-4, 0.75), (5e-5, 0.0), (1e-5, 0.0)):
        flux = gas + seen * whole
        deck = slabs(["*GAP LAW, TYPE=GAS", "0.1, 1.E-6", "*GAP RADIATION", "0.8, 0.6", "1., 0.",
                      f"0., {end!r}"], (1000.0, 400.0), flux)
        verify = next(i for i, card in enumerate(deck) if card.startswith("*VERIFY"))
        judge(tmp_path, deck[:verify], [("heat_flux", "FACE", "LAST", flux, 1e-9)])


def test_radiation_adds_to_a_table_of_clearances(tmp_path):
    flux = 700.0 * 600 + SIGMA * (1000.0**4 - 400.0**4) / (1 / 0.8 + 1 / 0.6 - 1)
    for card in ("*GAP CONDUCTANCE, CLEARANCE", "*GAP CONDUCTANCE"):
        law = [card, "1400., 0.", "0., 1.E-4", "*GAP RADIATION", "0.8, 0.6"]
        deck = slabs(law, (1000.0, 400.0), flux)
        verify = next(i for i, card in enumerate(deck) if card.startswith("*VERIFY"))
        judge(tmp_path, deck[:verify], [("heat_flux", "FACE", "LAST", flux, 1e-9)])


def test_radiation_adds_to_a_gas_in_any_order(tmp_path):
    radiation, gas = ["*GAP RADIATION", "0.8, 0.6"], ["*GAP LAW, TYPE=GAS", "0.1, 1.E-6"]
    flux = 0.1 / (5e-5 + 1e-6) * 600 + SIGMA * (1000.0**4 - 400.0**4) / (1 / 0.8 + 1 / 0.6 - 1)
    for law in (radiation + gas, gas + radiation):
        deck = slabs(law, (1000.0, 400.0), flux)
        verify = next(i for i, card in enumerate(deck) if card.startswith("*VERIFY"))
        judge(tmp_path, deck[:verify], [("heat_flux", "FACE", "LAST", flux, 1e-9)])
