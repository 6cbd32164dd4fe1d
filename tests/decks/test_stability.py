"""Whether states last: growing small motions of rods, against dense eigenvalues of the rods in
closed form, and what *STABILITY says where there is nothing to analyse."""

import csv
import re

import h5py
import numpy as np
import pytest
from changes import note_changes
from deck_runs import run
from physics import mesh, material
from scipy.optimize import brentq
from test_values_friction_heat import bar_on_a_wall

import rod_modes
import rods
from frictional_heat import burton

WIDTH = 1e-3   # so that temperatures even out across the rods
RODS = 500
RESTING = 10   # of the many rods whose motions all die out without a period


def rod_deck(both, law, capacities, omega, *cards, stability="*STABILITY", elements=(8, 8),
             width=WIDTH):
    """Return the cards of two rods with the laws gas(a, b) and power(touch, c, 1), solved steadily
    from a conductance."""
    a, b, touch, c = law
    cold = np.linspace(-both.length[1], 0.0, elements[1] + 1)
    hot = np.linspace(0.0, both.length[0], elements[0] + 1)
    xs = [0.0, width]
    made = [*mesh("HOT", xs, hot), *mesh("COLD", xs, cold, first=1001)]
    for i, name in enumerate(("HOT", "COLD")):
        made += material(name, (both.young[i], 0.0), expansion=both.expansion[i],
                         conductivity=both.conductivity[i], **(
                             {"density": 1.0, "specific_heat": capacities[i]} if capacities else {}))
    ends = "HOT.TOP", "COLD.BOTTOM"
    return [*made, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HOT, 0.", "COLD, 0.",
            "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=GAS", f"{a!r}, {b!r}",
            "*GAP LAW, TYPE=POWER", f"{touch!r}, {c!r}, 1.",
            "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "HOT.BOTTOM, COLD.TOP",
            f"*CLEARANCE, SLAVE=HOT.BOTTOM, MASTER=COLD.TOP, VALUE={both.gap!r}",
            "*FIXED POINT, METHOD=NEWTON, TOL=1.E-11", "*START, FROM=GIVEN", f"FACE, {omega!r}",
            *cards, "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.",
            stability, "*BOUNDARY", "HOT, 1, 1, 0.", "COLD, 1, 1, 0.",
            *(line for end, t in zip(ends, both.temperature, strict=True)
              for line in (f"{end}, 2, 2, 0.", f"{end}, 11, 11, {t!r}")), "*END STEP"]


def stability_of(result):
    """Return the rows of /stability."""
    with h5py.File(result) as file:
        return {name: values[:] for name, values in file["stability"].items()}


def random_rods(random):
    """Return two rods, their laws and capacities, and one of their solutions that does not rest."""
    while True:
        length, conductivity = random.uniform(0.05, 0.2, 2), 10 ** random.uniform(0.7, 2, 2)
        capacity = 10 ** random.uniform(6, 7, 2)
        expansion = random.uniform(0.0, 2e-5, 2)
        temperature = (500.0, 0.0) if random.integers(2) else (0.0, 500.0)
        a, b = 10 ** random.uniform(-3, -1), 10 ** random.uniform(-6, -4)
        law = a, b, a / b, 10 ** random.uniform(-6, -3)
        both = rods.Rods(*(tuple(map(float, values)) for values in (
            length, conductivity, expansion, (2e11, 2e11))), temperature, 0.0)
        # The gap of a conductance by which the gain is of the order of 1.
        gap = -both.separation(both.flux(10 ** random.uniform(0, 5))) + 10 ** random.uniform(-6, -3)
        both = rods.Rods(both.length, both.conductivity, both.expansion, both.young,
                         both.temperature, float(gap))
        found = [s for s in rods.exact_solutions(both, *map(float, law)) if s.slope]
        if found:
            return (both, tuple(map(float, law)), tuple(map(float, capacity)),
                    found[random.integers(len(found))])


def test_number_of_growing_modes_is_that_of_dense_eigenvalues(tmp_path):
    random = np.random.default_rng(17)
    expected, resting = {}, 0
    for i in range(RODS):
        both, law, capacities, solution = random_rods(random)
        rates = rod_modes.rates(both, capacities, solution)
        if rates[0].real <= 0.0 and not rates[0].imag:
            resting += 1
            if resting > RESTING:
                continue
        (tmp_path / f"{i}.inp").write_text("\n".join(rod_deck(
            both, law, capacities, solution.conductance)) + "\n")
        expected[i] = rates, solution
    process = run("run", "--quiet", "--errors", "no", *(f"{i}.inp" for i in expected),
                  folder=tmp_path)
    assert process.returncode == 0, process.stderr
    counts, told = [], []
    for i, (rates, solution) in expected.items():
        with h5py.File(tmp_path / f"{i}.vtkhdf") as file:
            assert file["contact/FACE/conductance"][-1] == pytest.approx(solution.conductance)
        found = stability_of(tmp_path / f"{i}.vtkhdf")
        growing = np.count_nonzero(rates.real > 0.0)
        assert found["unstable_modes"] == growing, (i, rates[:3], found)
        # Fast motions stay in a layer at the face that is thinner than an element.
        assert found["growth_rate"] == pytest.approx(rates[0].real, rel=0.03), (i, rates[:3])
        assert found["period"] == pytest.approx(2 * np.pi / abs(rates[0].imag) if rates[0].imag
                                                else 0.0, rel=0.03)
        # A pair that oscillates is one of the leading motions; those that decay faster are coarser.
        leading = rates[rates.imag >= 0.0][:3]
        known = np.isfinite(found["growth_rates"][0])
        assert found["growth_rates"][0, 0] == found["growth_rate"][0]
        np.testing.assert_allclose(found["growth_rates"][0, known], leading.real[known], rtol=0.1,
                                   atol=0.02 * abs(rates[0]), err_msg=f"{i}")
        np.testing.assert_allclose(found["periods"][0, known], np.divide(
            2 * np.pi, leading.imag, out=np.zeros(3), where=leading.imag > 0.0)[known], rtol=0.1)
        counts.append((growing, rates[0].imag != 0.0))
        told.append(np.count_nonzero(known))
    # The rods show all kinds of motions.
    for kind in (0, False), (0, True), (1, False), (2, True):
        assert counts.count(kind) > 5, kind
    assert told.count(3) > 0.95 * len(told)


MIDDLE = rods.Rods((0.1, 0.1), (20.0, 20.0), (0.0, 12e-6), (2e11, 2e11), (500.0, 0.0), 1.2e-4)
LAW = 0.005, 1e-5, 500.0, 1e-4
BRANCHES = rods.exact_solutions(MIDDLE, *LAW)


def middle(*cards, branch=1, capacities=(3.6e6, 3.6e6), **options):
    """Return the cards of the rods with three solutions in one of them."""
    return rod_deck(MIDDLE, LAW, capacities, BRANCHES[branch].conductance, *cards, **options)


def solved(folder, cards, *arguments, status=0, name="deck"):
    """Solve cards; return the result and what was printed."""
    deck = folder / f"{name}.inp"
    deck.write_text("\n".join(cards) + "\n")
    process = run("run", deck, "--out", folder, *arguments)
    assert process.returncode == status, process.stderr
    return deck.with_suffix(".vtkhdf"), process.stdout + process.stderr


@pytest.mark.parametrize("cards", [
    [], ["*SOLVER, TYPE=MUMPS"], ["*REFINE, LEVELS=1, SURFACE=HOT.BOTTOM"]],
    ids=["skyline", "mumps", "refined"])
@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
def test_rate_is_the_same_with_any_solver_mesh_and_pairing(cards, pairing, tmp_path):
    made = [line.replace("NAME=FACE", f"NAME=FACE, PAIRING={pairing}")
            if line.startswith("*CONTACT PAIR") else line for line in middle(*cards)]
    result, printed = solved(tmp_path, made)
    rate = float(rod_modes.rates(MIDDLE, (3.6e6, 3.6e6), BRANCHES[1])[0].real)
    found = stability_of(result)
    assert found["growth_rate"] == pytest.approx(rate, rel=1e-4)
    assert found["unstable_modes"] == 1
    assert "unstable: 1 mode grows, doubling in 270\n" in printed


def test_times_have_the_unit_of_the_deck(tmp_path):
    printed = solved(tmp_path, middle('*OPTIONS, UNITS="m Pa W C h"'))[1]
    assert "unstable: 1 mode grows, doubling in 270 h\n" in printed
    assert "growth rates of the leading modes in 1/h: " in " ".join(printed.split())


@pytest.mark.changes("STABILITY, MODES")
@pytest.mark.parametrize("branch", [0, 1, 2])
def test_leading_modes_are_those_of_dense_eigenvalues(branch, tmp_path):
    """As many as the card asks for, the stable ones too, in listing, summary and result file."""
    decks = [middle(branch=branch, elements=(24, 24), stability=f"*STABILITY{modes}")
             for modes in ("", ", MODES=6", ", MODES=1")]
    note_changes(*decks[1:])
    rates = rod_modes.rates(MIDDLE, (3.6e6, 3.6e6), BRANCHES[branch])
    rates = rates[rates.imag >= 0.0]
    for cards, count in zip(decks, (3, 6, 1), strict=True):
        result, printed = solved(tmp_path, cards)
        found = stability_of(result)
        assert found["growth_rates"].shape == found["periods"].shape == (1, count)
        np.testing.assert_allclose(found["growth_rates"][0], rates[:count].real, rtol=2e-4)
        np.testing.assert_allclose(found["periods"][0], [2 * np.pi / s.imag if s.imag else 0.0
                                                         for s in rates[:count]], rtol=2e-4)
        assert found["growth_rate"] == found["growth_rates"][:, 0]
        for words in (printed, result.with_suffix(".lst").read_text()):
            words = " ".join(words.split())
            said = re.search("growth rates? of the leading modes?: ((?:[^ ,]+(?:, )?)+)", words)[1]
            np.testing.assert_allclose([float(word) for word in said.split(", ")[:count]],
                                       rates[:count].real, rtol=1e-3)
            assert said and "(no estimate: not there on a finer mesh)" in words


def test_mode_is_that_of_the_rods(tmp_path):
    """Each rod has sinh(sqrt(s/kappa) x) from its wall on, the hot one against the cold one."""
    result, _ = solved(tmp_path, middle())
    rate = stability_of(result)["growth_rate"][0]
    with h5py.File(result) as file:
        grid = file["VTKHDF"]
        points, mode = grid["Points"][:], grid["PointData/mode_temperature"][:]
        moved = grid["PointData/mode_displacement"][:]
    number = np.sqrt(rate * 3.6e6 / 20.0)
    # A little more heat warms the cold rod, which expands, and cools the hot one.
    expected = np.sign(points[:, 1]) * np.sinh(number * (0.1 - abs(points[:, 1])))
    inside = abs(points[:, 1]) > 1e-9
    scale = mode[inside] @ expected[inside] / (expected[inside] @ expected[inside])
    np.testing.assert_allclose(mode[inside], scale * expected[inside], atol=1e-4)
    assert abs(mode).max() == pytest.approx(1.0)
    # The end of the cold rod moves by alpha times the integral of its temperature.
    integral = abs(scale) * (np.cosh(number * 0.1) - 1) / number
    assert abs(moved[:, 1]).max() == pytest.approx(12e-6 * integral, rel=1e-3)


def test_transient_that_leaves_the_state_has_the_rate(tmp_path):
    """Both ways: a little more or less than the middle state, with increments by their error."""
    rate = float(rod_modes.rates(MIDDLE, (3.6e6, 3.6e6), BRANCHES[1])[0].real)
    for way in 1, -1:
        cards = middle("*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HOT, 0.")
        end = cards.index("*END STEP")
        made = [*cards[:end + 1], "*STEP, INC=10000",
                "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", "4., 1600.", "*BOUNDARY",
                f"HOT.TOP, 11, 11, {500 + way * 1e-3}", "*END STEP"]
        result, _ = solved(tmp_path, made, name=f"way{way}")
        with h5py.File(result) as file:
            time, heat = file["history/time"][:], file["contact/FACE/heat_rate"][:]
        # The prescribed change adds a constant; differences grow with the motion alone.
        late = time > 1 + 900
        growth = np.polyfit(time[late][1:], np.log(abs(np.diff(heat[late]))), 1)[0]
        assert growth == pytest.approx(rate, rel=0.01)
        assert way * (heat[-1] - heat[0]) > 0


def half_plane(ratio, depth, slow=None):
    """Return half a wave of a half-plane on an insulator that slides out of the plane, with
    E alpha = k = rho c = 1 and V/Vcr = ratio, and beside it a body of a length and a conductivity
    that touches nothing."""
    xs, ys = np.linspace(0.0, np.pi, 13), [0.0]
    while ys[-1] < depth:
        ys.append(min(1.3 * ys[-1] + 0.13, depth))
    cards = [*mesh("HALF", xs, ys), *material("HALF", (1000.0, 0.3), 1e-3, 1.0, 1.0, 1.0),
             *mesh("WALL", xs, [-0.2, 0.0], first=100001),
             *material("WALL", (1000.0, 0.3), conductivity=1.0)]
    held = []
    if slow:
        cards += [*mesh("SLOW", [0.0, slow[0]], [-2.0, -1.0], first=200001),
                  *material("SLOW", (1000.0, 0.3), conductivity=slow[1], density=1.0,
                            specific_heat=1.0)]
        held = ["SLOW, 1, 2, 0.", "SLOW.LEFT, 11, 11, 0."]
    return [*cards, "*SURFACE INTERACTION, NAME=FACE", "*FRICTION", "0.5", "*GAP HEAT GENERATION",
            f"1., 1., {2.8 * ratio!r}", "*CONTACT PAIR, INTERACTION=FACE, NAME=FACE",
            "HALF.BOTTOM, WALL.TOP", "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HALF, 0.",
            "WALL, 0.", "*OPTIONS, ERRORS=NO", "*STEP",
            "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.", "*STABILITY",
            "*BOUNDARY", "WALL, 1, 2, 0.", "WALL.BOTTOM, 11, 11, 0.", "HALF.LEFT, 1, 1, 0.",
            "HALF.RIGHT, 1, 1, 0.", "HALF.TOP, 11, 11, 0.", *held, "*DSLOAD", "HALF.TOP, P, 1.",
            "*END STEP"]


@pytest.mark.parametrize("ratio", [0.9, 4.5])
@pytest.mark.parametrize(("depth", "slow"), [
    (14.0, None), (300.0, None), (3e4, None), (14.0, (30.0, 1e-4)), (14.0, (3e3, 1e-6)),
    (300.0, (30.0, 1e-8))])
def test_motions_grow_alike_however_slow_a_body_is(ratio, depth, slow, tmp_path):
    """Each wave m, 2 m ... of the half-plane grows as in Burton's closed form."""
    rates = [m**2 * burton(ratio / m)[0] for m in range(1, 9)]
    result, printed = solved(tmp_path, half_plane(ratio, depth, slow))
    found = stability_of(result)
    assert found["certain"] == 1, printed
    assert found["unstable_modes"] == sum(rate > 0.0 for rate in rates)
    if ratio > 1.0:
        assert found["growth_rate"] == pytest.approx(max(rates), rel=2e-3)


@pytest.mark.parametrize("ratio", [0.2, 0.9, 1.9, 4.5])
def test_motions_of_a_sparse_tail_grow_as_in_closed_form(ratio, tmp_path):
    """It is certain that none grows where the bound of the gain says so."""
    rates = [m**2 * burton(ratio / m)[0] for m in range(1, 9)]
    growing = sum(rate > 0.0 for rate in rates)
    result, printed = solved(tmp_path, ["*SOLVER, TAIL=SPARSE", *half_plane(ratio, 14.0)])
    found = stability_of(result)
    assert found["certain"] == (ratio < 0.5), printed
    assert ("nothing proves that no other motion grows" in printed) == (ratio > 0.5)
    assert found["unstable_modes"] == growing
    if growing:
        assert found["growth_rate"] == pytest.approx(max(rates), rel=2e-3)


def test_heat_of_a_largest_shear_follows_no_pressure(tmp_path):
    """A bar on an insulating wall, at 0 at its other end, cools with exp(-(pi/2)^2 t)."""
    cards = bar_on_a_wall(2.0, analysis="STEADY STATE, DIRECT")
    cards[cards.index("*FRICTION")] = "*FRICTION, TAUMAX=0.1"
    cards.insert(cards.index("*END STEP"), "*STABILITY")
    found = stability_of(solved(tmp_path, cards)[0])
    assert found["growth_rate"] == pytest.approx(-(np.pi / 2)**2, rel=1e-4)


def test_films_hold_the_ends_of_rods(tmp_path):
    """At 1e5 times the conductance of a rod, as prescribed temperatures do."""
    cards = middle()
    for name in "HOT.TOP", "COLD.BOTTOM":
        at = next(i for i, card in enumerate(cards) if card.startswith(f"{name}, 11, 11"))
        sink = cards.pop(at).rsplit(",", 1)[1]
        cards[-1:] = ["*SFILM", f"{name}, F, {sink}, 2e7", "*END STEP"]
    found = stability_of(solved(tmp_path, cards)[0])
    rate = float(rod_modes.rates(MIDDLE, (3.6e6, 3.6e6), BRANCHES[1])[0].real)
    assert found["growth_rate"] == pytest.approx(rate, rel=1e-3)


@pytest.mark.parametrize(("across", "capacity", "beside"), [
    (0.0, 0.8, []), (5e-4, 1.0, []), (0.0, 0.6, ["*GAP HEAT GENERATION", "1., 1., 2."]),
    (0.0, 0.1, [])])
def test_slip_in_the_plane_heats_at_the_rate_of_a_motion(tmp_path, across, capacity, beside):
    """A block of one temperature T expands along a wall, one side held, and against it: the other
    side slips by s = alpha T - mu p/(2 E), p = p0 + E beta T, and makes q = mu p s'/2 of heat. With
    a film H, C T' = -H (T - 20) + q. Equations keep the block from bending and warping. Where slip
    makes more heat than the block stores, motions grow however fast they are. Another pair, in
    front of it, slips without heat, or slides out of the plane."""
    friction, given, expansion, film, young = 0.5, 100.0, 1e-2, 3.0, 1e4

    def pressure(warmth):
        return given + young * across * warmth

    def slip(warmth):
        return expansion * warmth - friction * pressure(warmth) / 2 / young

    # The increment of the steady state has the duration 1.
    warmth = brentq(lambda t: film * (t - 20.0) - friction / 2 * pressure(t) * slip(t), 0.0, 30.0)
    alike = [f"{node}, 11, 1., 1, 11, -1." for node in (2, 3, 4)] + ["3, 1, 1., 2, 1, -1."]
    cards = [*mesh("BLOCK", [0.0, 1.0], [0.0, 1.0], "CPS4"),
             *material("BLOCK", (young, 0.0), (expansion, across, 0.0), 1.0, 1.0, capacity,
                       expansion_type="ORTHO"),
             *mesh("WALL", [0.0, 1.0], [-1.0, 0.0], "CPS4", first=101),
             *mesh("ASIDE", [3.0, 4.0], [0.0, 1.0], "CPS4", first=201),
             *mesh("BASE", [3.0, 4.0], [-1.0, 0.0], "CPS4", first=301),
             *(card for name in ("WALL", "ASIDE", "BASE") for card in material(
                 name, (young, 0.0), None, 1.0, 1.0, 1.0)),
             "*EQUATION", *(line for card in alike for line in ("2", card)),
             "*SURFACE INTERACTION, NAME=COLD", "*FRICTION", f"{friction!r}", *beside,
             "*CONTACT PAIR, INTERACTION=COLD, NAME=ASIDE", "ASIDE.BOTTOM, BASE.TOP",
             "*SURFACE INTERACTION, NAME=FACE", "*FRICTION", f"{friction!r}",
             "*GAP HEAT GENERATION", "1., 1.", "*CONTACT PAIR, INTERACTION=FACE, NAME=FACE",
             "BLOCK.BOTTOM, WALL.TOP", "*INITIAL CONDITIONS, TYPE=TEMPERATURE",
             *(f"{name}, 0." for name in ("BLOCK", "WALL", "ASIDE", "BASE")),
             "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT",
             "1., 1.", "*STABILITY", "*BOUNDARY",
             *(f"{name}, 11, 11, 0." for name in ("WALL", "ASIDE", "BASE")),
             "WALL, 1, 2, 0.", "BASE, 1, 2, 0.", "ASIDE.TOP, 1, 1, 0.03",
             *(f"{name}.TOP, 2, 2, {-given / young!r}" for name in ("BLOCK", "ASIDE")),
             "BLOCK.LEFT, 1, 1, 0.", "*SFILM", f"BLOCK.TOP, F, 20., {film!r}", "*END STEP"]
    result, printed = solved(tmp_path, cards)
    found = stability_of(result)
    by_slip = friction / 2 * pressure(warmth) * (slip(1.0) - slip(0.0))
    by_pressure = friction / 2 * (pressure(1.0) - pressure(0.0)) * slip(warmth)
    rate = (by_pressure - film) / (capacity - by_slip)
    if by_slip < capacity:
        assert found["growth_rate"] == pytest.approx(rate, rel=1e-6)
    # The bound of |eigenvalue of U'|^2 is twice 2 (1/C) 2 (by_slip^2/C): at two rates, both fast.
    excluded = 8 * (by_slip / capacity) ** 2 < 1
    assert ("faster motions may grow" in " ".join(printed.split())) == (not excluded)
    assert "doubling in -" not in printed


@pytest.mark.parametrize(("slave", "gap"), [("BLOCK", None), ("WALL", None), ("WALL", 0.1)])
def test_tables_follow_openings_and_temperatures_beside_the_heat_of_a_speed(tmp_path, slave, gap):
    """A block of one temperature T expands against a wall of 30, or towards it, across which heat h
    goes by pressure or gap and the mean of both temperatures; faces slide out of the plane.
    Another pair, in front of it, has one temperature."""
    young, film, sink, wall, capacity, friction, speed = 1e4, 3.0, 90.0, 30.0, 2.0, 0.5, 0.8
    expansion = 1e-3 if gap else 1e-4
    share = 0.3 if slave == "BLOCK" else 0.7

    def pressure(warmth):
        return 100.0 + young * expansion * warmth if gap is None else 0.0

    def conductance(warmth):
        part = (warmth + wall) / 2 / 400.0
        if gap is None:
            across = pressure(warmth) / 200.0
            return (1 - part) * (2.0 + 10.0 * across) + part * (6.0 + 20.0 * across)
        return (8.0 + 12.0 * part) * (1 - (gap - expansion * warmth) / 0.2)

    def heat(warmth):
        return (conductance(warmth) * (wall - warmth) + film * (sink - warmth)
                + share * friction * pressure(warmth) * speed)

    warmth = brentq(heat, 0.0, 90.0, xtol=1e-13)
    table = (["PRESSURE", "2., 0., 0.", "12., 200., 0.", "6., 0., 400.", "26., 200., 400."]
             if gap is None else
             ["CLEARANCE", "8., 0., 0.", "0., 0.2, 0.", "20., 0., 400.", "0., 0.2, 400."])
    top, down = 1.0 + (gap or 0.0), -100.0 / young if gap is None else 0.0
    idle = [card for name, y, first in (("IDLE", 0.05, 201), ("BACK", -1.0, 301)) for card in (
        *mesh(name, [3.0, 4.0], [y, y + 1.0], "CPS4", first=first),
        *material(name, (young, 0.0), None, 1.0, 1.0, 1.0))]
    cards = [*mesh("BLOCK", [0.0, 1.0], [top - 1.0, top], "CPS4"),
             *material("BLOCK", (young, 0.0), (0.0, expansion, 0.0), 1.0, 1.0, capacity,
                       expansion_type="ORTHO"),
             *mesh("WALL", [0.0, 1.0], [-1.0, 0.0], "CPS4", first=101),
             *material("WALL", (young, 0.0), None, 1.0, 1.0, 1.0), *idle,
             "*EQUATION", *(line for node in (2, 3, 4) for line in (
                 "2", f"{node}, 11, 1., 1, 11, -1.")),
             "*SURFACE INTERACTION, NAME=FACE", "*FRICTION", f"{friction!r}",
             "*GAP HEAT GENERATION", f"1., 0.3, {speed!r}", f"*GAP CONDUCTANCE, {table[0]}",
             *table[1:],
             "*CONTACT PAIR, INTERACTION=FACE, NAME=IDLE", "IDLE.BOTTOM, BACK.TOP",
             "*CONTACT PAIR, INTERACTION=FACE, NAME=FACE",
             "BLOCK.BOTTOM, WALL.TOP" if slave == "BLOCK" else "WALL.TOP, BLOCK.BOTTOM",
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BLOCK, 0.", *(
                 f"{name}, {wall!r}" for name in ("WALL", "IDLE", "BACK")), "*STEP",
             "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.", "*STABILITY",
             "*BOUNDARY", *(card for name in ("WALL", "IDLE", "BACK") for card in (
                 f"{name}, 1, 2, 0.", f"{name}, 11, 11, {wall!r}")), "BLOCK.LEFT, 1, 1, 0.",
             f"BLOCK.TOP, 2, 2, {down!r}", "*SFILM", f"BLOCK.TOP, F, {sink!r}, {film!r}",
             "*END STEP"]
    found = stability_of(solved(tmp_path, cards)[0])
    rate = (heat(warmth + 1e-4) - heat(warmth - 1e-4)) / 2e-4 / capacity
    assert found["growth_rate"] == pytest.approx(rate, rel=1e-6)


def test_radiation_follows_the_temperature_of_either_face(tmp_path):
    """A body of one temperature T and a film H of it below a hotter one that keeps its own: C s =
    -H - 4 sigma T^3, for black faces."""
    sigma, hot, warm, cold, capacity = 5.67e-8, 1000.0, 600.0, 300.0, 3.0
    film = sigma * (hot**4 - warm**4) / (warm - cold)
    cards = [f"*PHYSICAL CONSTANTS, ABSOLUTE ZERO=0., STEFAN BOLTZMANN={sigma!r}",
             *mesh("HOT", [0.0, 1.0], [0.1, 1.1], "CPE4"),
             *mesh("WARM", [0.0, 1.0], [-1.0, 0.0], "CPE4", first=101),
             *(card for name in ("HOT", "WARM") for card in material(
                 name, conductivity=1.0, density=1.0, specific_heat=capacity)),
             "*EQUATION", *(line for node in (102, 103, 104) for line in (
                 "2", f"{node}, 11, 1., 101, 11, -1.")),
             "*SURFACE INTERACTION, NAME=FACE", "*GAP RADIATION", "1., 1.", "1., 0.", "1., 1.",
             "*CONTACT PAIR, INTERACTION=FACE, NAME=FACE", "HOT.BOTTOM, WARM.TOP",
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"HOT, {hot!r}", f"WARM, {warm!r}", "*STEP",
             "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.", "*STABILITY",
             "*BOUNDARY", "HOT, 1", "WARM, 1", "HOT.TOP, 2", "WARM.BOTTOM, 2",
             f"HOT, 11, 11, {hot!r}", "*SFILM",
             f"WARM.BOTTOM, F, {cold!r}, {film!r}", "*END STEP"]
    found = stability_of(solved(tmp_path, cards)[0])
    rate = -(film + 4 * sigma * warm**3) / capacity
    assert found["growth_rate"] == pytest.approx(rate, rel=1e-6)


@pytest.mark.parametrize(("columns", "curve"), [(4, 2e-3), (8, 2e-3), (8, 1e-3)])
def test_an_edge_that_moves_takes_its_heat_along(columns, curve, tmp_path):
    """A curved face in partial contact: after a small change of the load temperatures decay at the
    rate of the slowest motion, and the edge of contact moves inside a side of mortar points."""
    time, count = 0.01, 100

    def bend(x, y):
        return x, y + curve * x * x * (1 - y)

    cards = [*mesh("UP", np.linspace(0.0, 1.0, columns + 1), [0.0, 0.4, 1.0], to=bend),
             *mesh("LOW", np.linspace(0.0, 1.0, columns + 3), [-1.0, -0.4, 0.0], first=1001),
             *material("UP", (1e5, 0.0), 1e-5, 1.0, 1.0, 1.0),
             *material("LOW", (1e5, 0.0), None, 50.0, 1.0, 1.0),
             "*SURFACE INTERACTION, NAME=FACE", "*GAP LAW, TYPE=GAS", "1e-6, 1.",
             "*GAP LAW, TYPE=POWER", "1e-6, 0.05, 1.",
             "*CONTACT PAIR, INTERACTION=FACE, NAME=FACE, PAIRING=SURFACES", "UP.BOTTOM, LOW.TOP",
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "UP, 0.", "LOW, 0.", "*OPTIONS, ERRORS=NO",
             "*FIXED POINT, METHOD=NEWTON, TOL=1e-12", "*STEP",
             "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "0.25, 1.", "*STABILITY",
             "*BOUNDARY", "UP.LEFT, 1", "LOW.LEFT, 1", "LOW.BOTTOM, 2", "UP.TOP, 2",
             "UP.TOP, 11, 11, 100.", "LOW.BOTTOM, 11, 11, 0.", "*END STEP", f"*STEP, INC={count}",
             "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", f"{time}, {time * count}", "*BOUNDARY",
             "UP.TOP, 11, 11, 100.001", "*END STEP"]
    result, _ = solved(tmp_path, cards)
    with h5py.File(result) as file:
        heat, states = (file[f"contact/FACE/{name}"][:] for name in ("heat_rate", "status"))
    assert 0 < np.count_nonzero(states[-1]) < columns + 1
    rates = np.diff(np.log(abs(np.diff(heat[-count // 4:])))) / time
    assert stability_of(result)["growth_rate"] == pytest.approx(np.mean(rates), rel=5e-4)


def test_an_expansion_without_heat_capacity_leaves_doubt(tmp_path):
    """The bar answers at once, whatever the rate: nothing bounds the rates of motions that grow."""
    cards = [*mesh("BAR", np.linspace(0.0, 1.0, 9), [0.0, 0.125], first=1),
             *material("BAR", (1000.0, 0.0), expansion=(1e-3, 0.0, 0.0), conductivity=1.0,
                       expansion_type="ORTHO"),
             *mesh("WALL", [-0.25, 0.0], [0.0, 0.125], first=5001),
             *material("WALL", (1000.0, 0.0), conductivity=1.0, density=1.0, specific_heat=1.0),
             "*SURFACE INTERACTION, NAME=FACE", "*FRICTION", "0.5", "*GAP HEAT GENERATION",
             "1., 1., 3.", "*CONTACT PAIR, INTERACTION=FACE, NAME=FACE", "BAR.LEFT, WALL.RIGHT",
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BAR, 0.", "WALL, 0.", "*STEP",
             "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.", "*STABILITY",
             "*BOUNDARY", "WALL, 1, 2, 0.", "WALL.LEFT, 11, 11, 0.", "BAR.BOTTOM, 2, 2, 0.",
             "BAR.RIGHT, 1, 1, -1e-3", "BAR.RIGHT, 11, 11, 0.", "*END STEP"]
    result, printed = solved(tmp_path, cards)
    assert stability_of(result)["certain"] == 0
    assert "faster motions may grow, as where what expands" in " ".join(printed.split())


@pytest.mark.changes("STABILITY, FREQUENCY")
def test_frequency_asks_for_increments_in_between(tmp_path):
    cards = {n: [line.replace("1., 1.", "0.25, 1.") for line in middle(
        stability=f"*STABILITY, FREQUENCY={n}", branch=0)] for n in (1, 2)}
    note_changes(cards[1], cards[2])
    for n, times in (1, [0.25, 0.5, 0.75, 1.0]), (2, [0.5, 1.0]):
        result, _ = solved(tmp_path, cards[n], name=f"every{n}")
        assert stability_of(result)["time"] == pytest.approx(times)


def test_steps_behind_a_result_may_be_the_first_to_ask(tmp_path):
    before, _ = solved(tmp_path, middle("*RESTART, WRITE", stability="**"), name="before")
    cards = ["*RESTART, READ", "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT",
             "1., 1.", "*STABILITY", "*END STEP"]
    result, _ = solved(tmp_path, cards, "--restart", before, name="behind")
    whole, _ = solved(tmp_path, middle(), name="whole")
    assert stability_of(result)["time"] == pytest.approx([2.0])
    assert stability_of(result)["growth_rate"] == pytest.approx(
        stability_of(whole)["growth_rate"], rel=1e-6)


def test_an_uncertain_answer_says_so_in_the_result(tmp_path):
    certain, _ = solved(tmp_path, middle(), name="certain")
    result, printed = solved(tmp_path, middle(capacities=None, branch=0))
    assert stability_of(certain)["certain"] == 1
    assert stability_of(result)["certain"] == 0
    assert np.isnan(stability_of(result)["unstable_modes"]).all()
    assert "uncertain" in printed


def test_all_doubts_are_told(tmp_path):
    cards = middle("*PHYSICAL CONSTANTS, ABSOLUTE ZERO=-273.15")
    text = "\n".join(cards).replace(
        "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT",
        "*COUPLED TEMPERATURE-DISPLACEMENT, DILATATION=YES, DIRECT").replace(
        "*CONDUCTIVITY\n20.0\n", "*CONDUCTIVITY\n20., 0.\n20.1, 600.\n", 1)
    result, printed = solved(tmp_path, text.splitlines())
    assert stability_of(result)["certain"] == 0
    assert "changes of properties with the temperature are left out; the heat that strains " \
        "take up is left out" in " ".join(printed.split())


def test_all_growing_modes_of_a_pattern_are_found(tmp_path):
    """Contact points at both ends of the face grow alike, and each against the other."""
    cards, _ = pattern("*START, FROM=CLOSED")
    at = [i for i, line in enumerate(cards) if line == "*CONDUCTIVITY"]
    for i in reversed(at):
        cards[i:i] = ["*DENSITY", "1.", "*SPECIFIC HEAT", "3.6e6"]
    cards[cards.index("**")] = "*STABILITY"
    result, printed = solved(tmp_path, cards)
    assert stability_of(result)["certain"] == 1, printed


def test_steady_states_without_capacities_say_what_remains(tmp_path):
    _, printed = solved(tmp_path, middle(capacities=None, stability="**"))
    assert "unstable whatever the heat capacities are: det(I - U') is negative" in printed
    result, printed = solved(tmp_path, middle(capacities=None, branch=0))
    assert "uncertain: bodies without *SPECIFIC HEAT and *DENSITY have no course" in printed
    assert np.isnan(stability_of(result)["growth_rate"]).all()


def test_checks_may_name_what_is_found(tmp_path):
    rate = float(rod_modes.rates(MIDDLE, (3.6e6, 3.6e6), BRANCHES[1])[0].real)
    check = ['*VERIFY, KIND=ANALYTIC, SOURCE="dense eigenvalues"',
             "unstable_modes, , LAST, 1., 0., ABS", "period, , LAST, 0., 0., ABS"]
    solved(tmp_path, [*middle(), *check, f"growth_rate, , LAST, {rate!r}, 1e-3"])
    solved(tmp_path, [*middle(), *check, f"growth_rate, , LAST, {2 * rate!r}, 1e-3"], status=4)


def test_a_table_of_runs_has_the_fastest_mode(tmp_path):
    """Of the middle state of the rods, whose only growing motion doubles in 270 s."""
    deck = tmp_path / "deck.inp"
    deck.write_text("\n".join(["*PARAMETER", "number = 1.", *middle()]) + "\n")
    (tmp_path / "values.csv").write_text("number\n1.\n")
    done = run("run", deck, "--quiet", "--table", tmp_path / "values.csv", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "deck.table.csv", newline="") as file:
        (row,) = csv.DictReader(file)
    assert float(row["unstable_modes"]) == 1.0
    assert np.log(2.0) / float(row["growth_rate"]) == pytest.approx(270.0, rel=2e-3)
    assert float(row["period"]) == 0.0


@pytest.mark.parametrize(("ratio", "depth", "words"), [
    (1.0, 300.0, "at the limit of stability: a growth rate is nearly 0"),
    (1.5, 14.0, "det(I - U') is negative: the state is unstable, an odd number of modes grows"),
    (2.6, 14.0, "above 1: modes may grow, which *STABILITY counts")])
def test_warnings_of_a_sliding_face_agree_with_its_modes(ratio, depth, words, tmp_path):
    """One mode grows above the critical speed, two above twice that: det(I - U') is positive."""
    printed = solved(tmp_path, half_plane(ratio, depth))[1]
    assert words in printed
    assert "branch" not in printed
    assert "is ignored: no step stores heat" not in (tmp_path / "deck.lst").read_text()


def test_analysis_changes_no_digit_of_the_run(tmp_path):
    results = [solved(tmp_path, middle(stability=card, branch=2), name=name)[0]
               for card, name in (("*STABILITY", "with"), ("**", "without"))]
    with h5py.File(results[0]) as one, h5py.File(results[1]) as two:
        assert "stability" not in two
        for group in "history", "contact/FACE", "uncertainty/FACE":
            for name in two[group]:
                np.testing.assert_array_equal(one[f"{group}/{name}"][:], two[f"{group}/{name}"][:])


def test_ridges_of_hot_pellets_are_no_pattern(tmp_path):
    """Pellets take the shape of an hour-glass: closed at their ends and about the middle."""
    heights = np.linspace(0.0, 10.0, 7)
    radii = np.linspace(0.0, 4.1, 5)
    uranium = (2e5, 0.316), {"expansion": 1e-5, "conductivity": 3e-3}
    cards = [*mesh("ONE", radii, heights, "CAX8"),
             *mesh("TWO", radii, heights + 10.0, "CAX8", first=1001),
             *mesh("TUBE", [4.12, 4.72], np.linspace(0.0, 30.0, 19), "CAX8", first=2001),
             *material("ONE", uranium[0], **uranium[1]), *material("TWO", uranium[0], **uranium[1]),
             *material("TUBE", (8e4, 0.34), 6e-6, 0.016),
             "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ONE, 20.", "TWO, 20.", "TUBE, 20.",
             "*SURFACE INTERACTION, NAME=HELIUM", "*FRICTION", "0.4", "*GAP LAW, TYPE=GAS",
             "3e-4, 0.01", "*GAP LAW, TYPE=POWER", "0.03, 1e-3, 1.",
             "*CONTACT PAIR, INTERACTION=HELIUM, NAME=LOW, PAIRING=SURFACES", "ONE.RIGHT, TUBE.LEFT",
             "*CONTACT PAIR, INTERACTION=HELIUM, NAME=HIGH, PAIRING=SURFACES",
             "TWO.RIGHT, TUBE.LEFT",
             "*CONTACT PAIR, INTERACTION=HELIUM, NAME=END", "TWO.BOTTOM, ONE.TOP",
             "*BOUNDARY", "ONE.LEFT, 1", "TWO.LEFT, 1", "ONE.BOTTOM, 2", "TUBE.BOTTOM, 2"]
    for power in (0.0, 0.4734):
        cards += ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.25, 1.",
                  "*SFILM", "TUBE.RIGHT, F, 300., 0.03", "*DSLOAD", "TWO.TOP, P, 2.",
                  "*DFLUX", f"ONE, BF, {power!r}", f"TWO, BF, {power!r}", "*END STEP"]
    result, printed = solved(tmp_path, cards, "--errors", "no")
    with h5py.File(result) as file:
        closed = file["contact/HIGH/status"][-1] > 0
    assert closed.astype(int).tolist() == [1, 0, 0, 1, 0, 0, 1]
    assert "alternate" not in printed


def pattern(*cards):
    """Return the cards of two rods, three contact points wide, whose faces are uniform: there is
    one uniform solution, q = 41054.97, and patterns."""
    both = rods.Rods((0.27562411602468528, 0.17065966503820518), (52.413934057605438,
                     40.448857908897281), (8.3028851643860443e-06, 7.9320987911076132e-06),
                     (2e11, 2e11), (500.0, 0.0), 1.01444715514876e-3)
    law = 4.5163293095943511e-08, 6.2290230987686257e-11, 725.04616537098616, 1e-4
    (only,) = rods.exact_solutions(both, *law)
    made = rod_deck(both, law, None, only.conductance, stability="**", elements=(3, 3),
                    width=0.1)
    start = made.index("*START, FROM=GIVEN")
    return [*made[:start], *cards, *made[start + (0 if not cards else 2):]], both.flux(
        only.conductance)


def test_patterns_are_told_from_the_uniform_solution(tmp_path):
    cards, flux = pattern()
    assert flux == pytest.approx(41054.97, rel=1e-6)
    result, printed = solved(tmp_path, cards)
    with h5py.File(result) as file:
        np.testing.assert_allclose(file["contact/FACE/heat_flux"][:], flux, rtol=1e-4)
    assert "above 1: the solution may be one of several" in printed
    _, printed = solved(tmp_path, pattern("*START, FROM=CLOSED")[0])
    assert re.search("closed and open contact points alternate in a uniform face", printed)
    _, printed = solved(tmp_path, pattern("*START, FROM=BOTH")[0])
    assert "leads to a different solution; this is one of several" in printed

