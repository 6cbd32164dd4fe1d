"""Latent heat and annealing of small decks; the verification manual has fronts."""

import json
import re

import numpy as np
import pytest
from blocks import write
from deck_runs import assert_alike, datasets, run
from physics import follows, judge, material, mesh, nodes_of

KINDS = ["CPS3", "CAX4", "CPE4", "CPE4I"]
SCHEMES = ["IMPLICIT", "GALERKIN", "CRANK-NICOLSON", "L-STABLE"]
FILES = "VTKHDF/PointData", "history"


def melting(rows, kind="CPS4", size=2, **more):
    """Return a square that melts, k = rho c = 1."""
    points = [float(x) for x in np.linspace(0.0, 1.0, size + 1)]
    given = material("BODY", more.pop("elastic", None), conductivity=1.0, density=2.0,
                     specific_heat=0.5, **more)
    return [*mesh("BODY", points, points, kind), *given[:-1], "*LATENT HEAT", *rows, given[-1]]


def step(*cards, analysis="*HEAT TRANSFER, DIRECT", times="0.25, 4."):
    """Return a step."""
    return ["*STEP, INC=10000", analysis, times, *cards, "*END STEP"]


def start(value):
    """Return the card of an initial temperature."""
    return ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"BODY, {value!r}"]


@pytest.mark.changes("LATENT HEAT")
@pytest.mark.parametrize("kind", KINDS)
def test_a_body_that_is_cooled_evenly_gives_off_its_latent_heat(tmp_path, kind):
    """From 50 by a power of 20 a volume: 20 to the liquidus 30, then half of what melting holds."""
    def make(latent):
        volume = 2 * latent          # by its density
        within = 40.0 / (10.0 + volume) * 10.0
        return [*melting([f"{latent!r}, 20., 30."], kind), *start(50.0),
                *step("*DFLUX", "BODY, BF, -20.", times="0.25, 3.")], [
            ("NT", "BODY", "1.", 30.0, 1e-8), ("NT", "BODY", "LAST", 30.0 - within, 1e-8),
            ("SOLID", "BODY", "LAST", within / 10.0, 1e-8)]

    follows(tmp_path, make, 25.0, 40.0)


@pytest.mark.parametrize(("begin", "power", "said"), [
    (40.0, 20.0, r"solid fraction +0\.8, least at node \d+ \(.*\)"), (40.0, 35.0, r"all solid at +\S+ .*"), (20.0, 15.0, None)])
def test_the_summary_tells_what_is_not_solid_yet(tmp_path, begin, power, said):
    """From 40 in one second: 10 to the liquidus, then 12.5 to the solidus, of which 10 are of melting."""
    cards = [*melting(["5., 27.5, 30."]), *start(begin), *step("*DFLUX", f"BODY, BF, -{power!r}", times="0.25, 1.")]
    process = run("run", write(tmp_path / "deck.inp", cards), "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    told = [line.strip() for line in process.stdout.splitlines() if "solid" in line]
    assert len(told) == (said is not None)
    assert all(re.fullmatch(said, line) for line in told)


@pytest.mark.parametrize("increment", [2.8, 1.4, 0.7, 0.35])
def test_times_at_which_levels_are_reached_hold_across_a_plateau(tmp_path, increment):
    """From 40 by 20 a time: 0.5 to the liquidus, 1 to the solidus, half of it for melting."""
    levels = {35.0: 0.25, 25.0: 1.0, 15.0: 1.75, 5.0: 2.25}
    cards = ["*OPTIONS, ERRORS=FULL", "*THERMAL SCHEME, TYPE=IMPLICIT", *melting(["5., 20., 30."]), *start(40.0),
             *step("*DFLUX", "BODY, BF, -20.", times=f"{increment!r}, 2.8")]
    asked = ["*VERIFY, KIND=NONE", *(f"NT reaches {level!r}, 1, LAST" for level in levels)]
    process = run("run", "--json", write(tmp_path / "deck.inp", cards, asked), "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    for check, exact in zip(json.loads(process.stdout)["checks"], levels.values(), strict=True):
        assert abs(check["found"] - exact) <= check["uncertainty"] + 1e-9 <= increment + 1e-3


@pytest.mark.parametrize("scheme", SCHEMES)
def test_two_rows_take_up_their_heats_one_after_the_other(tmp_path, scheme):
    """Solid fractions are shares of the whole latent heat; the last point is solid at a time that
    increments of one length find."""
    cards = [f"*THERMAL SCHEME, TYPE={scheme}", *melting(["5., 10., 20.", "15., 30., 40."]),
             *start(0.0), *step("*DFLUX", "BODY, BF, 20.", times="0.25, 4."),
             *step("*DFLUX, OP=NEW", "BODY, BF, -20.", times="0.25, 4.25")]
    judge(tmp_path, cards, [("NT", "BODY", "1.", 15.0, 1e-8), ("SOLID", "BODY", "1.", 0.875, 1e-8),
                            ("NT", "BODY", "4.", 40.0, 1e-8), ("SOLID", "BODY", "4.", 0.0, 1e-8,
                                                             "ABS"),
                            ("NT", "BODY", "LAST", -5.0, 1e-7),
                            ("solid_time", "", "LAST", 7.5, 1e-8)])


@pytest.mark.parametrize("kind", ["CPE8", "CPS4"])
def test_heat_that_leaves_is_what_a_front_gives_off(tmp_path, kind):
    """From 1.2 to 0 through a front without an interval, in Euler's increments."""
    cards = ["*THERMAL SCHEME, TYPE=IMPLICIT", *melting(["1., 1., 1."], kind, size=8), *start(1.2),
             *step("*SFILM", "BODY.LEFT, F, 0., 10.", "BODY.BOTTOM, F, 0., 10.", times="0.02, 8.")]
    process = run("run", "--quiet", write(tmp_path / "front.inp", cards), "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    found = datasets(tmp_path / "front.vtkhdf", "history")
    assert np.max(found["history/heat_imbalance"]) < 1e-10
    # rho c 1.2 and rho times the latent heat; 8 is long.
    assert np.sum(0.02 * found["history/heat_out"]) == pytest.approx(1.2 + 2.0, rel=1e-7)
    listing = (tmp_path / "front.lst").read_text()
    assert len(re.findall("the last point is solid at time", listing)) == 1
    assert "the smallest interval is 1e-4 of latent over specific heat" in listing


def test_a_front_that_is_foreseen_needs_one_solution_a_stage(tmp_path):
    """Nodes enter and leave the interval in nearly every increment."""
    cards = [*melting(["1., 0.99, 1."], size=12), *start(1.0), *step(
        "*BOUNDARY", "BODY.LEFT, 11, 11, 0.", "BODY.BOTTOM, 11, 11, 0.", times="0.002, 0.2")]
    process = run("run", "--quiet", write(tmp_path / "front.inp", cards), "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    passes = [int(count) for count in re.findall(r"^ +corrections (\d+)", (
        tmp_path / "front.lst").read_text(), re.MULTILINE)]
    assert len(passes) == 100
    assert sum(passes) < 110


def test_tables_of_nodes_have_the_solid_fraction(tmp_path):
    """Half of the latent heat is given off after 1."""
    cards = [*melting(["10., 20., 30."], size=1), *start(30.0), *step(
        "*DFLUX", "BODY, BF, -15.", "*NODE PRINT", "SOLID", times="0.25, 1.")]
    process = run("run", "--quiet", write(tmp_path / "half.inp", cards), "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    table = re.findall(r"node +x +y +SOLID\n((?: +\d.*\n)+)", (tmp_path / "half.lst").read_text())[-1]
    assert [float(line.split()[-1]) for line in table.splitlines()] == pytest.approx(4 * [0.5])


def test_a_solid_fraction_needs_latent_heat(tmp_path):
    cards = [card for card in melting(["10., 20., 30."], size=1)
             if card not in ("*LATENT HEAT", "10., 20., 30.")]
    process = run("run", "--quiet", write(tmp_path / "none.inp", [*cards, *start(30.0), *step(
        "*DFLUX", "BODY, BF, -15.", "*NODE PRINT", "SOLID", times="0.25, 1.")]), "--out", tmp_path)
    assert "SOLID of *NODE PRINT is not there without *LATENT HEAT" in process.stderr


def test_steady_steps_say_that_latent_heat_does_nothing(tmp_path):
    cards = [*melting(["1., 1., 2."]), *start(1.2),
             *step("*BOUNDARY", "BODY.LEFT, 11, 11, 0.", "BODY.RIGHT, 11, 11, 3.",
                   analysis="*HEAT TRANSFER, STEADY STATE", times="1., 1.")]
    judge(tmp_path, cards, [("NT", "BODY.RIGHT", "LAST", 3.0, 1e-12)])
    listing = next(tmp_path.glob("*.lst")).read_text()
    assert "*LATENT HEAT does nothing in steps that store no heat, such as step 1" in listing


@pytest.mark.changes("ANNEAL TEMPERATURE")
def test_stress_begins_below_the_annealing_temperature(tmp_path):
    def make(temperature):
        given = material("BODY", (200e3, 0.3), expansion=1e-5)
        return [*mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS4"), *given[:-1], "*ANNEAL TEMPERATURE",
                f"{temperature!r}", given[-1], *start(700.0),
                *step("*BOUNDARY", "BODY.LEFT, 1", "BODY.RIGHT, 1", "BODY.BOTTOM, 2",
                      "*TEMPERATURE", "BODY, 100.", analysis="*STATIC, DIRECT", times="0.3, 1.")], [
            ("S11", "BODY", "LAST", 2.0 * (temperature - 100.0), 1e-9)]

    follows(tmp_path, make, 400.0, 550.0)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_solid_begins_within_the_stages_of_an_increment(tmp_path, scheme):
    """Cooled evenly by 600, solid from 530 on, soon after an increment began."""
    given = material("BODY", (200e3, 0.3), expansion=1e-5, conductivity=1.0, density=2.0,
                     specific_heat=0.5)
    cards = [f"*THERMAL SCHEME, TYPE={scheme}", *mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS4"),
             *given[:-1], "*ANNEAL TEMPERATURE", "530.", given[-1], *start(700.0),
             *step("*BOUNDARY", "BODY.LEFT, 1", "BODY.RIGHT, 1", "BODY.BOTTOM, 2", "*DFLUX",
                   "BODY, BF, -600.", analysis="*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT",
                   times="0.25, 1.")]
    judge(tmp_path, cards, [("NT", "BODY", "LAST", 100.0, 1e-9),
                            ("S11", "BODY", "LAST", 860.0, 1e-8)])


@pytest.mark.parametrize(("cards", "warns"), [
    (["*ANNEAL TEMPERATURE", "530."], False), ([], True),
    (["*ANNEAL TEMPERATURE", "520."], True)], ids=["solid from there", "no solid", "solid below"])
def test_secants_of_a_casting_may_begin_where_it_is_solid(tmp_path, cards, warns):
    given = material("BODY", (200e3, 0.3), expansion=[(1e-5, 530.0), (0.0, 531.0)], zero=530.0)
    process = run("check", write(tmp_path / "zero.inp", [
        *mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS4"), *given[:-1], *cards, given[-1],
        *start(700.0), *step("*BOUNDARY", "BODY.LEFT, 1, 2", "*TEMPERATURE", "BODY, 100.",
                             analysis="*STATIC")]))
    assert ("far from the initial temperature" in process.stdout + process.stderr) == warns


@pytest.mark.parametrize("kind", ["CPE4I", "CPS4I", "CAX4I"])
def test_enhanced_modes_of_a_melt_are_found(tmp_path, kind):
    """Uneven above its temperature: the modes work against nothing but the drag of the melt."""
    given = material("BODY", (200e3, 0.3), expansion=1e-5)
    cards = [*mesh("BODY", [1.0, 1.5, 2.0], [0.0, 1.0], kind), *given[:-1], "*ANNEAL TEMPERATURE",
             "555.", given[-1], *start(700.0),
             *step("*BOUNDARY", "BODY.BOTTOM, 1, 2", "*TEMPERATURE", "BODY, 650.",
                   "BODY.LEFT, 600.", analysis="*STATIC, DIRECT", times="0.5, 1.")]
    judge(tmp_path, cards, [("MISES", "BODY", "LAST", 0.0, 1e-9, "ABS")])


def test_a_front_passes_fine_elements_that_may_yield(tmp_path):
    """A bar that solidifies from its side. It shrinks freely and yields nowhere, but what is about
    to become solid is soft, and passes may yield."""
    width, height = (np.linspace(0.0, end, n).tolist() for end, n in ((20.0, 17), (10.0, 9)))
    given = material("BODY", (40e3, 0.33), expansion=2.4e-5, conductivity=0.15, density=2.5e-6,
                     specific_heat=1000.0)
    cards = [*mesh("BODY", width, height, "CAX4"), *given[:-1], "*PLASTIC", "20.",
             "*LATENT HEAT", "390.E3, 555., 615.", "*ANNEAL TEMPERATURE", "555.", given[-1],
             *start(700.0), *step(
                 "*BOUNDARY", "BODY.BOTTOM, 2", "*SFILM", "BODY.RIGHT, F, 20., 2.E-3",
                 analysis="*COUPLED TEMPERATURE-DISPLACEMENT", times="0.1, 12.")]
    judge(tmp_path, cards, [("MISES", "BODY.LEFT", "LAST", 0.0, 1e-9, "ABS"),
                            ("PEEQ", "BODY", "LAST", 0.0, 0.0, "ABS")])


@pytest.mark.parametrize(("temperature", "warns"), [(500.0, True), (900.0, False)],
                         ids=["melt", "solid"])
@pytest.mark.parametrize("pair", ["HOT.BOTTOM, COLD.TOP", "COLD.TOP, HOT.BOTTOM"])
def test_a_gap_beside_a_melt_is_named(tmp_path, pair, temperature, warns):
    given = {name: material(name, (200e3, 0.3), expansion=1e-6, conductivity=0.1, density=1e-6,
                            specific_heat=1000.0) for name in ("COLD", "HOT")}
    given["HOT"][-1:] = ["*ANNEAL TEMPERATURE", f"{temperature!r}", given["HOT"][-1]]
    process = run("run", "--quiet", "--out", tmp_path, write(tmp_path / "gap.inp", [
        *mesh("COLD", [0.0, 1.0], [-1.0, 0.0], "CPS4"),
        *mesh("HOT", [0.0, 1.0], [0.02, 1.0], "CPS4", first=101), *given["COLD"], *given["HOT"],
        "*SURFACE INTERACTION, NAME=AIR", "*GAP LAW, TYPE=GAS", "5.E-5, 0.01",
        f"*CONTACT PAIR, INTERACTION=AIR, NAME=FACE\n{pair}",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HOT, 700.", "COLD, 20.",
        *step("*BOUNDARY", "COLD.BOTTOM, 1, 2", "HOT.TOP, 1, 2",
              analysis="*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", times="1.E-4, 1.E-4")]))
    assert process.returncode == 0, process.stderr
    assert ("contact pair FACE opens where a face is above its *ANNEAL" in process.stderr) == warns


def casting(*cards):
    """Return a square that solidifies between walls, whose stress follows its temperatures."""
    return [*melting(["1., 0.9, 1."], size=4, elastic=[(1e3, 0.3, 0.0), (500.0, 0.3, 1.0)],
                     expansion=1e-3)[:-1], "*ANNEAL TEMPERATURE", "0.92",
            "*SOLID SECTION, ELSET=BODY, MATERIAL=BODY", *start(1.1), *cards,
            *step("*BOUNDARY", "BODY.LEFT, 1", "BODY.RIGHT, 1", "BODY.BOTTOM, 2",
                  "BODY.LEFT, 11, 11, 0.", "BODY.TOP, 11, 11, 0.5", "*RESTART, WRITE, FREQUENCY=1",
                  analysis="*COUPLED TEMPERATURE-DISPLACEMENT, LOCAL ERROR=0.01",
                  times="0.001, 0.3")]


def test_a_casting_goes_on_from_every_increment_with_the_same_digits(tmp_path):
    whole = tmp_path / "casting.vtkhdf"
    process = run("run", "--quiet", write(tmp_path / "casting.inp", casting()), "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    times = datasets(whole, "history")["history/time"]
    for time in times[3:-1:len(times) // 4]:
        folder = tmp_path / str(time)
        process = run("run", "--quiet", tmp_path / "casting.inp", "--restart",
                      f"{whole}@{float(time)!r}", "--out", folder)
        assert process.returncode == 0, process.stderr
        assert_alike(datasets(whole, *FILES), datasets(folder / whole.name, *FILES), 0.0)


def test_the_last_point_is_solid_by_the_heat_of_a_table(tmp_path):
    """Heat capacity 1 at 100, 4 from 500 on: 400 from 600 to 500, then 39.625 and 100 of melting."""
    cards = melting(["50., 490., 500."])
    place = cards.index("*SPECIFIC HEAT") + 1
    cards[place:place + 1] = ["0.5, 100.", "2., 500."]
    judge(tmp_path, [*cards, *start(600.0), *step("*DFLUX", "BODY, BF, -1.", times="200., 1000.")],
          [("solid_time", "", "LAST", 539.625, 1e-8)])


def front(elements, interval, *times):
    """Return a slab that Stefan's front passes, Ste = 1, and when that is at its end."""
    points = [float(x) for x in np.linspace(0.0, 1.0, elements + 1)]
    given = material("BODY", conductivity=1.0, density=1.0, specific_heat=1.0, elastic=None)
    exact = 1.0 / (2 * 0.6200626) ** 2
    return [*mesh("BODY", points, [0.0, 1 / elements], "CPS4"), *given[:-1], "*LATENT HEAT",
            f"1., {1 - interval!r}, 1.", given[-1], "*OPTIONS, ERRORS=FULL", *start(1.0),
            *step("*BOUNDARY", "BODY.LEFT, 11, 11, 0.",
                  times=", ".join(repr(time * exact) for time in times))], exact


def test_a_time_of_solidification_has_an_uncertainty(tmp_path):
    """An interval of 0.01 delays the front by some 0.3 %."""
    cards, exact = front(16, 0.01, 0.0075, 1.05)
    judge(tmp_path, cards, [("solid_time", "", "LAST", exact, 0.01)])
    listing = next(tmp_path.glob("*.lst")).read_text()
    assert re.search(r"solid_time +\S+ +\S+", listing.split("UNCERTAINT")[-1])
    assert "no estimate: path" not in listing


@pytest.mark.parametrize(("elements", "increments"), [(16, 40), (32, 40), (32, 60)])
def test_the_uncertainty_of_a_time_of_solidification_holds(tmp_path, elements, increments):
    """A front passes one node after the other, so that its change on a finer mesh may be small by
    chance; but not beside the increment."""
    cards, exact = front(elements, 2e-4, 1.3 / increments, 1.3)
    last = next(number for number, place in nodes_of(cards).items() if place[0] == 1.0)
    asked = ["*VERIFY, KIND=NONE", "solid_time, , LAST", f"SOLID reaches 1., {last}, LAST"]
    process = run("run", "--json", write(tmp_path / "front.inp", cards, asked), "--out", tmp_path)
    told = json.loads(process.stdout)
    for found in (told["summary"]["fields"]["solid_time"], *told["checks"]):
        assert abs(found["value" if "value" in found else "found"] - exact) <= found["uncertainty"]
    assert told["checks"][0]["uncertainty"] == told["summary"]["fields"]["solid_time"]["uncertainty"]
