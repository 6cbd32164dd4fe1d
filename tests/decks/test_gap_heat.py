"""Heat through gaps whose conductance depends on the temperatures of the faces, and through closed
faces, in closed form.

Two slabs with the face temperatures T1 and T2 across a gap: the flux is

    q = k(T)/(gap + lengths) (T1 - T2) + sigma eps (T1^4 - T2^4),    T = (T1 + T2)/2,

and the temperatures far from the gap follow from it by Fourier's law. T is that of a row of the
table, so k(T) is the formula's.
"""

import math
import re
from types import SimpleNamespace

import h5py
import pytest
from blocks import block, solid, without_unused_surfaces, write
from deck_runs import run, solve
from physics import follows, mesh
from test_values_contact import PRESSURE, crossing, pressed

SIGMA, GAP, B = 5.670374419e-8, 5e-5, 1e-6
LENGTHS, CONDUCTIVITIES = (4e-3, 6e-4), (3.0, 15.0)
GASES = {"helium": lambda t: 2.639e-3 * t**0.7085, "xenon": lambda t: 4.351e-5 * t**0.8616}
TABLE = range(300, 1600, 100)
ZERO = "*PHYSICAL CONSTANTS, ABSOLUTE ZERO={!r}, STEFAN BOLTZMANN={!r}"


def slabs(law, faces, flux, **options):
    """Return the cards of two slabs whose faces have given temperatures and flux, and the checks."""
    o = SimpleNamespace(analysis="HEAT TRANSFER", method="NEWTON", pairing="NODES", zero=0.0,
                        expansion=0.0, gap=GAP, scheme="IMPLICIT")  # fmt: skip
    vars(o).update(options)
    (l1, l2), (k1, k2) = LENGTHS, CONDUCTIVITIES
    far = [faces[0] + flux * l1 / k1 + o.zero, faces[1] - flux * l2 / k2 + o.zero]
    # The gap is that of the warm slabs: each expands by its mean temperature above the first one.
    grown = sum(length * ((face + end) / 2 - 300 - o.zero) for length, face, end in
                zip(LENGTHS, [t + o.zero for t in faces], far, strict=True)) * o.expansion
    gap, xs = o.gap + grown, [0.0, 1e-3, 3e-3]
    checks = [("heat_flux", flux), ("slave_temperature", faces[0] + o.zero),
              ("master_temperature", faces[1] + o.zero), ("gap", o.gap)]  # fmt: skip
    cards = [
        *block("HOT", xs, [gap, gap + 1.5e-3, gap + l1], 1),
        *block("COLD", xs, [-l2, -2e-4, 0.0], 101),
        *solid("HOT", 2e11, 0.0, o.expansion, k1), *solid("COLD", 1e11, 0.0, o.expansion, k2),
        ZERO.format(o.zero, SIGMA), "*SURFACE INTERACTION, NAME=FACES", *law,
        f"*CONTACT PAIR, INTERACTION=FACES, NAME=FACE, PAIRING={o.pairing}", "HOT.BOTTOM, COLD.TOP",
        f"*FIXED POINT, METHOD={o.method}, TOL=1.E-11",
        f"*THERMAL SCHEME, TYPE={o.scheme}",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"HOT, {300 + o.zero!r}", f"COLD, {300 + o.zero!r}",
        "*STEP", f"*{o.analysis}, STEADY STATE", "0.5, 1.", "*BOUNDARY",
        *([] if o.analysis == "HEAT TRANSFER" else
          ["HOT.TOP, 2, 2, 0.", "COLD.BOTTOM, 2, 2, 0.", "HOT, 1, 1, 0.", "COLD, 1, 1, 0."]),
        f"HOT.TOP, 11, 11, {far[0]!r}", f"COLD.BOTTOM, 11, 11, {far[1]!r}", "*END STEP",
        '*VERIFY, KIND=ANALYTIC, SOURCE="Fourier"']  # fmt: skip
    cards += [f"{q}, {at}, LAST, {value!r}, 1.E-9" for q, value in checks for at in ("MIN", "MAX")]
    return without_unused_surfaces(cards)


def gas_law(gas, zero=0.0, emissivity=None, jump=4e-6, roughness=6e-6, t=(700.0, 500.0), gap=GAP):
    """Return the cards of a gas, face temperatures and the flux between them."""
    k = GASES[gas]
    radiation = "" if emissivity is None else f", EMISSIVITY={emissivity!r}"
    law = [f"*GAP LAW, TYPE=GAS, JUMP={jump!r}, ROUGHNESS={roughness!r}{radiation}",
           *(f"{k(at)!r}, {B!r}, {at + zero!r}" for at in TABLE)]  # fmt: skip
    flux = k((t[0] + t[1]) / 2) / (gap + B + jump + roughness) * (t[0] - t[1])
    return law, t, flux + (emissivity or 0) * SIGMA * (t[0] ** 4 - t[1] ** 4)


COUPLED = "COUPLED TEMPERATURE-DISPLACEMENT"
CASES = [
    ("helium", None, {}), ("helium", 0.8, {"pairing": "SURFACES"}), ("xenon", None, {"zero": -273.15}),
    ("xenon", 0.8, {}), ("helium", None, {"analysis": COUPLED, "expansion": 1e-5}),
    ("helium", 0.8, {"analysis": COUPLED, "zero": -273.15}),
    ("xenon", 0.8, {"analysis": COUPLED, "expansion": 1e-5, "pairing": "SURFACES"}),
    ("xenon", 0.5, {"analysis": COUPLED, "expansion": 1e-5, "method": "PICARD"}),
    ("xenon", 0.5, {"analysis": COUPLED, "method": "ZAITSEV"}),
    ("helium", 0.5, {"analysis": COUPLED, "expansion": 1e-5, "method": "ANDERSON"}),
]  # fmt: skip


@pytest.mark.parametrize(("gas", "emissivity", "options"), CASES)
def test_slabs_across_a_gas_gap_have_the_closed_form(tmp_path, gas, emissivity, options):
    case = gas_law(gas, options.get("zero", 0.0), emissivity)
    solve(write(tmp_path / "slabs.inp", slabs(*case, **options)))


def test_a_vacuum_gap_radiates(tmp_path):
    faces, emissivity = (1000.0, 400.0), 1 / (1 / 0.8 + 1 / 0.6 - 1)
    law = [f"*GAP LAW, TYPE=GAS, EMISSIVITY={emissivity!r}", "0., 1.E-6"]
    flux = emissivity * SIGMA * (faces[0] ** 4 - faces[1] ** 4)
    solve(write(tmp_path / "slabs.inp", slabs(law, faces, flux)))


def test_kennards_jump_distance_adds_to_the_gap(tmp_path):
    """Argon at 1e4 Pa: g = (2 - a)/a 2 gamma/(gamma + 1) mean free path/Prandtl, of both faces."""
    k, pressure, gamma, prandtl, diameter, mean = 0.0268, 1e4, 5 / 3, 0.667, 3.66e-10, 450.0
    free_path = 1.380649e-23 * mean / (math.sqrt(2) * math.pi * diameter**2 * pressure)
    jump = sum((2 - a) / a * 2 * gamma / (gamma + 1) * free_path / prandtl for a in (0.9, 0.8))
    assert jump > 0.05 * GAP
    faces = (500.0, 400.0)
    law = [f"*GAP LAW, TYPE=GAS, JUMP={jump!r}", f"{k!r}"]
    solve(write(tmp_path / "slabs.inp", slabs(law, faces, k / (GAP + jump) * 100.0)))


@pytest.mark.changes("GAP LAW, JUMP", "GAP LAW, ROUGHNESS", "GAP LAW, EMISSIVITY",
                     "PHYSICAL CONSTANTS, ABSOLUTE ZERO", "PHYSICAL CONSTANTS, STEFAN BOLTZMANN")
def test_every_addition_to_a_gas_changes_the_heat_as_it_should(tmp_path):
    def make(values):
        jump, roughness, emissivity, zero, sigma = values
        law = [f"*GAP LAW, TYPE=GAS, JUMP={jump!r}, ROUGHNESS={roughness!r}, "
               f"EMISSIVITY={emissivity!r}", "0.1, 1.E-6"]
        one, other = 400.0 - zero, 300.0 - zero
        flux = 0.1 / (GAP + B + jump + roughness) * 100 + emissivity * sigma * (one**4 - other**4)
        deck = slabs(law, (400.0, 300.0), flux)
        at = next(i for i, card in enumerate(deck) if card.startswith("*PHYSICAL"))
        deck[at] = ZERO.format(zero, sigma)
        verify = next(i for i, card in enumerate(deck) if card.startswith("*VERIFY"))
        return deck[:verify], [("heat_flux", "FACE", "LAST", flux, 1e-9),
                               ("slave_temperature", "FACE", "LAST", 400.0, 1e-9)]

    follows(tmp_path, make, (0.0, 2e-6, 0.3, -273.15, SIGMA), (3e-6, 0.0, 0.5, 0.0, 2 * SIGMA))


K1, K2 = 3.0, 16.0
SPOTS = 2 * K1 * K2 / (K1 + K2)
CMY = (["*GAP LAW, TYPE=CMY", f"{K1!r}, {K2!r}, 0.15, 0.5, 2000."],
       1.25 * SPOTS * 0.15 / 0.5 * (PRESSURE / 2000.0) ** 0.95)
ROSS_STOUTE = (["*GAP LAW, TYPE=ROSS-STOUTE", f"{K1!r}, {K2!r}, 0.09, 2000., 0.05"],
               SPOTS * PRESSURE / (0.05 * 0.3 * 2000.0))


@pytest.mark.changes("GAP LAW, TYPE", "GAP LAW")
def test_closed_faces_have_the_formulas_of_rough_faces(tmp_path):
    def make(case):
        return pressed(*case[0]), crossing(case[1])

    follows(tmp_path, make, CMY, ROSS_STOUTE)


def test_the_gas_between_rough_faces_adds_to_their_spots(tmp_path):
    def make(case):
        gas = ["*GAP LAW, TYPE=GAS, ROUGHNESS=0.5", "0.2"]
        return pressed(*gas, *case[0]), crossing(case[1] + 0.4)

    follows(tmp_path, make, CMY, ROSS_STOUTE)


@pytest.mark.changes("GAP CONDUCTANCE")
def test_the_temperature_of_a_table_is_the_mean_of_the_faces(tmp_path):
    """The conductance w is 0.5 + T/100 at the pressure: of faces at 80 - q/4 and q/2."""
    def make(slope):
        flux = solve_flux(slope)
        omega = 0.5 + slope * (80 + flux / 4) / 2
        rows = ["*GAP CONDUCTANCE, PRESSURE", "0.3, 0., 0.", "0.7, 10., 0.",
                f"{0.3 + 80 * slope!r}, 0., 80.", f"{0.5 + 80 * slope!r}, 5., 80."]
        return pressed(*rows), [("conductance", "FACE", "LAST", omega, 1e-8),
                                ("heat_flux", "FACE", "LAST", flux, 1e-8)]

    def solve_flux(slope):
        low, high = 0.0, 80.0
        for _ in range(200):
            q = (low + high) / 2
            excess = (0.5 + slope * (80 + q / 4) / 2) * (80 - 0.75 * q) - q
            low, high = (q, high) if excess > 0 else (low, q)
        return q

    follows(tmp_path, make, 0.01, 0.03)


@pytest.mark.parametrize(("method", "pairing"), [("NEWTON", "NODES"), ("ZAITSEV", "SURFACES")])
def test_heat_follows_a_table_by_temperature_across_a_gap(tmp_path, method, pairing):
    """The conductance is T - 200 at all gaps, T = 600 the mean of the faces: it falls with half the
    temperature, so that conductance and temperature have to be found together."""
    table = ["*GAP CONDUCTANCE, CLEARANCE", "100., 0., 300.", "100., 1., 300.",
             "1100., 0., 1300.", "1100., 1., 1300."]
    solve(write(tmp_path / "deck.inp", slabs(table, (700.0, 500.0), 400.0 * 200.0, method=method,
                                             pairing=pairing)))


def test_radiation_below_absolute_zero_is_an_error(tmp_path):
    law, _, _ = gas_law("helium", emissivity=0.8)
    deck = write(tmp_path / "slabs.inp", slabs(law, (100.0, -50.0), 1.0))
    process = run("run", deck, "--out", tmp_path)
    assert process.returncode == 2
    assert "contact pair FACE radiates below absolute zero, 0; check" in process.stderr


@pytest.mark.parametrize(("cards", "words"), [
    (["*GAP LAW, TYPE=GAS", "1., 1., 0.", "2., 1., 100.", "*GAP LAW, TYPE=POWER", "1., 0., 1."],
     "jumps by -1 where the gap closes without pressure at a mean temperature of 100: from 2 open"),
    (["*GAP LAW, TYPE=GAS, EMISSIVITY=0.8", "1., 1.", "*GAP LAW, TYPE=POWER", "1., 0., 1."],
     "radiate where they are open and not where they are closed"),
    (["*GAP CONDUCTANCE", "1., 0., 0.", "2., 1., 0.", "2., 0., 9.", "1., 1., 9."],
     "falls along the table"),
    (["*GAP LAW, TYPE=GAS, EMISSIVITY=0.8", "1., 1.", *CMY[0]], "")])
def test_warnings_know_the_temperatures(tmp_path, cards, words):
    deck = write(tmp_path / "deck.inp", [ZERO.format(0.0, SIGMA), *pressed(*cards)])
    process = run("check", deck)
    assert process.returncode == 0
    assert (words in process.stderr) if words else ("FACES" not in process.stderr)


LEFT = "contact pair FACE leaves a table of FACES"


@pytest.mark.parametrize(("gap", "cards", "words"), [
    (None, ["*GAP CONDUCTANCE, PRESSURE", "0.5, 0.", "1.5, 4."], "above its last pressure, 4, "),
    (None, ["*GAP CONDUCTANCE, PRESSURE", "0.5, 6.", "1.5, 10."], "below its first pressure, 6, "),
    (None, ["*GAP CONDUCTANCE, PRESSURE", "0.5, 0.", "1.5, 5."], None),
    (None, ["*GAP CONDUCTANCE, PRESSURE", "0.5, 0.", "1.5, 2.", "1.5, 4."], None),
    (None, ["*GAP CONDUCTANCE, PRESSURE", "0.5, 0.", "0.5, 4."], None),
    (None, ["*GAP CONDUCTANCE, PRESSURE", "0.5, 0., 0.", "1.5, 9., 0.", "0.6, 0., 20.", "1.5, 9., 20."],
     "above its last mean temperature, 20, "),
    (None, ["*GAP LAW, TYPE=CLEARANCE", "0.5, 0.1", "0.2, 0.2"], "below its first gap, 0.1, "),
    (0.1, ["*GAP LAW, TYPE=CLEARANCE", "0.8, 0.", "0.4, 0.05"], "above its last gap, 5E-2, "),
    (0.1, ["*GAP LAW, TYPE=CLEARANCE", "0.8, 0.", "0.4, 0.15"], None),
    (0.1, ["*GAP LAW, TYPE=CLEARANCE", "0.8, 0.", "0., 0.05"], None),
    (0.1, ["*GAP CONDUCTANCE, CLEARANCE", "0.8, 0.", "0., 0.05"], None),
    (0.1, ["*GAP CONDUCTANCE, CLEARANCE", "0.8, 0., 0.", "0., 0.3, 0.", "0.9, 0., 20.", "0., 0.3, 20."],
     "above its last mean temperature, 20, "),
    (0.1, ["*GAP LAW, TYPE=GAS", "1., 1., 0.", "2., 1., 20."], "above its last mean temperature, 20, "),
    (0.1, ["*GAP RADIATION", "0.8, 0.6", "1., 0.", "0.4, 0.05"], "above its last gap, 5E-2, ")])
def test_a_table_of_conductances_that_a_run_leaves_is_one_warning(tmp_path, gap, cards, words):
    """Faces are pressed by 5, or apart by 0.1; the mean of their temperatures is above 20."""
    deck = write(tmp_path / "deck.inp", [ZERO.format(-273.0, 1e-9), *pressed(*cards, gap=gap)])
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    found = [line for line in process.stderr.splitlines() if LEFT in line]
    assert len(found) == (words is not None)
    for line in found:
        assert f"{LEFT} {words}and the conductance there is held: {words.split(', ')[0].split(maxsplit=3)[3]} " in line
        assert "at slave node" in line


@pytest.mark.parametrize(("cards", "told"), [
    (["*GAP CONDUCTANCE", "5., 0.", "5., 1."], True), (["*GAP CONDUCTANCE", "5., 0."], False),
    (["*GAP CONDUCTANCE", "5., 1."], True), (["*GAP CONDUCTANCE", "5., 0.", "6., 1."], False),
    (["*GAP CONDUCTANCE", "5., 0., 0.", "5., 1., 0.", "6., 0., 9.", "6., 1., 9."], True),
    (["*GAP CONDUCTANCE, PRESSURE", "5., 0.", "5., 1."], False)])
def test_a_conductance_that_is_one_over_pressure_or_clearance_is_ambiguous(tmp_path, cards, told):
    process = run("check", write(tmp_path / "deck.inp", pressed(*cards)))
    assert process.returncode == 0
    assert ("the conductance of FACES is the same in all rows; its second column is taken as the "
            "pressure" in process.stderr) == told


@pytest.mark.parametrize(("last", "told"), [((0.0, 0.0, 0.0), None), ((0.0, 56.0, 0.0), 56), ((30.0, 0.0, 40.0), 40)])
def test_a_table_of_clearances_that_ends_above_0_at_one_of_its_temperatures(tmp_path, last, told):
    rows = [row for value, t in zip(last, (100, 300, 400), strict=True) for row in (f"180., 0., {t}.", f"{value}, 0.002, {t}.")]
    process = run("check", write(tmp_path / "deck.inp", pressed("*GAP CONDUCTANCE, CLEARANCE", *rows, gap=1e-3)))
    assert process.returncode == 0
    assert ("where the gap exceeds that of the last row" in process.stderr) == (told is not None)
    assert f"the conductance of FACES falls from {told} to 0" in process.stderr or told is None


def rings(kind, outer, law):
    """Return two tubes of radii 4 and 5, `outer` and 12, the inner one at 100 degrees, the other at 0."""
    def place(r, t):
        return (r, t) if kind == "CAX8" else (r * math.cos(t), r * math.sin(t))

    turns = [math.pi / 32 * n for n in range(17)]
    return without_unused_surfaces([
        *mesh("IN", [4.0, 5.0], turns, kind, to=place), *mesh("OUT", [outer, 12.0], turns, kind, 1001, to=place),
        *solid("IN", 1e5, 0.3, 0.0, 1e6), *solid("OUT", 1e5, 0.3, 0.0, 1e6), ZERO.format(-273.15, SIGMA),
        "*SURFACE INTERACTION, NAME=FACES", *law, "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "OUT.LEFT, IN.RIGHT",
        "*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY", "IN.LEFT, 11, 11, 100.", "OUT.RIGHT, 11, 11, 0.",
        "*END STEP"])


@pytest.mark.parametrize("kind", ["CPE8", "CAX8"])
@pytest.mark.parametrize("outer", [5.4, 10.0, 11.5])
@pytest.mark.parametrize(("law", "radiates"), [(["*GAP LAW, TYPE=GAS", "0.1, 1.E-9"], False),
                                               (["*GAP RADIATION", "1., 1."], True)])
def test_heat_across_a_wide_gap_of_round_faces_is_warned_of(tmp_path, kind, outer, law, radiates):
    """Beside concentric cylinders: conduction 2 pi k/ln(r2/r1), radiation of black ones from the inner to the outer."""
    deck = write(tmp_path / "deck.inp", rings(kind, outer, law))
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    angle, height = (math.pi / 2, 1.0) if kind == "CPE8" else (2 * math.pi, math.pi / 2)
    exact = 0.1 * 100.0 / math.log(outer / 5.0)
    if radiates:
        exact = SIGMA * 5.0 * (373.15**4 - 273.15**4)
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        heat = abs(file["contact/FACE/heat_rate"][-1])
    excess = heat / (exact * angle * height) - 1.0
    formula = (5 + outer) / (10 if radiates else 2 * (outer - 5) / math.log(outer / 5)) - 1
    assert excess == pytest.approx(formula, abs=2e-4)
    told = re.findall(r"(radiation|conduction) between round ones is (up to )?(\S+) % too large", process.stderr)
    assert len(told) == (excess > 0.05)
    for what, up_to, percent in told:
        assert (what, bool(up_to)) == (("radiation", True) if radiates else ("conduction", False))
        assert float(percent) == pytest.approx(100 * excess, rel=0.02)
