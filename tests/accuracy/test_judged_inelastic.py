"""The theme of decks that yield or creep and judge the numerical uncertainties."""

import math
import re
from dataclasses import replace

import report  # isort: skip, it makes the modules below known

import numpy as np
import pytest
from inelastic_families import FAMILIES
from inelastic_rings import Ring, Step, solution
from judged_decks import (FILE, by_deck, check_shares, compared, judged, misses, of_families,
                          reference, solved, told_values)

TITLE = "Uncertainties of bodies that yield or creep"
TEXT = """
60 decks with \\*PLASTIC or \\*CREEP (`tests/accuracy/inelastic_families.py`) judge `ERRORS=FULL`: tubes
under pressure, heat and creep, press fits with hubs that yield or creep, punches on blocks that
yield. `LAST` has no estimate there, and no constant was chosen on them. Of all quantities 98 % hold,
errors outside are 1.5 times the uncertainty in the median, 2.5 times at most. Displacements, whose
errors of mesh and increments may have opposite signs, hold in 29 of these 33 decks and in 65 of 66
with rings drawn after their power was chosen (seeds 2000 to 2019, 3000 to 3019).
"""
DETAILS = """
Three families (`tests/accuracy/inelastic_families.py`), of each 20 seeds from 1000 on, judge
`ERRORS=FULL` on decks with \\*PLASTIC or \\*CREEP; `LAST` has no estimate there. No constant was
chosen on them.

| family | what is drawn |
|---|---|
| tubes | pressure up to 95 % of collapse or heat that makes a tube yield, then less; creep |
| fits | a hub that yields as it is pressed on a shaft, later heated or cooled; a hub that creeps |
| punches | a block that yields under a roller, a rounded punch or an elastic body, with friction or without, then sheared, heated or unloaded in part |

Yield surfaces stay, grow or move. True values of tubes and fits are those of a program of one
dimension (`tests/reference/inelastic_rings.py`) that agrees with Hill's tube and other closed
forms; those of punches are found [as above](#uncertainties-judged-on-decks-drawn-afterwards), with faces
divided once, not twice, beyond the rest. Displacements are those of the outside of rings; energies
are `ALLPD` or `ALLCD`, and `ALLWK`. Both have an uncertainty where \\*VERIFY names them.
"""
IN_DOCUMENT = []
SHARES, OF_FAMILIES = "Inelastic decks that hold", "Inelastic decks of each family that hold"
TESTED = "tubes 1000", "tubes 1002", "fits 1001", "fits 1004", "punches 1006"


def drawn(told):
    """Return the decks whose true values are kept."""
    names = dict.fromkeys(key[0] for key in told)
    return [FAMILIES[family](int(seed)) for family, seed in (name.split(" ") for name in names)
            if family in FAMILIES]


def tables(folder):
    """Judge all decks whose true values are kept, in folders of their own."""
    told = told_values(FILE)
    decks = drawn(told)
    cases = [case for deck in decks for case in judged(deck, told, "FULL")]
    found, known = {"FULL": cases}, sum(case.is_known for case in cases)
    missed = [float(row[-1]) for row in misses(found).rows]
    share = by_deck(cases)[0]
    text = f"""{len(decks)} decks; {known} of {len(cases)} errors at ends of steps are large enough
to be judged. Of all quantities {share} hold; errors outside are {np.median(missed):.1f} times the
uncertainty in the median, {max(missed):.1f} times at most."""
    return [compared(SHARES, found, text), of_families(OF_FAMILIES, found)]


def hill(radius):
    """Return the pressure on the bore of an incompressible tube 100/200 that yields up to a radius,
    and how far its outside moves."""
    k = 48.0 / math.sqrt(3.0)
    return (k * (math.log(radius / 100.0) + (1 - (radius / 200.0) ** 2) / 2),
            0.75 * k * radius**2 / (21e3 * 200.0))


def hardened(volume, limit, modulus):
    """Return the pressure on the bore of such a tube all of which hardens, of the product of
    displacement and radius."""
    strain = 2 * volume / math.sqrt(3.0) * (1e-4 - 0.25e-4) / 2
    total = limit * math.log(2.0) + modulus * strain
    return 2 / math.sqrt(3.0) * total / (1 + modulus / 21e3)


def tube(**more):
    """Return a tube 100/200 whose response is that of an incompressible one within about 1e-4."""
    return [Ring(100.0, 200.0, 21e3, 0.4999, yield_stress=24.0, **more)]


@pytest.mark.parametrize("radius", [120.0, 160.0])
def test_reference_yields_as_hill_says(radius):
    pressure, outside = hill(radius)
    (found,) = solution(tube(), [Step(pressure=pressure)])
    assert found["outside"][0] == pytest.approx(outside, rel=2e-4)
    assert found["mises", 1][0] == pytest.approx(24.0)


@pytest.mark.parametrize("moves", [False, True])
def test_reference_hardens_and_turns_round(moves):
    """A surface that moves yields on the way back by the same law, after twice its size
    (Masing)."""
    first, back = hardened(200.0, 24.0, 2e3), hardened(300.0, 48.0, 2e3)
    forth, after = solution(tube(hardening=2e3, moves=moves),
                            [Step(pressure=first), Step(pressure=first - back)])
    assert forth["outside"][0] == pytest.approx(1.0, rel=2e-4)
    assert (abs(after["outside"][0] + 0.5) < 2e-4) == moves


def test_reference_expands():
    (warm,) = solution([Ring(100.0, 200.0, 21e3, 0.3, expansion=1e-5)],
                       [Step(temperatures=(50.0,) * 4)])
    assert warm["outside"][0] == pytest.approx(1.3 * 1e-5 * 50.0 * 200.0)


def test_reference_creeps():
    """A tube becomes stationary, and a fit relaxes to pressures that other programs know to
    0.002."""
    law = {"rate": 3.125e-14, "power": 5.0}
    *_, found = solution([Ring(100.0, 200.0, 200e3, 0.3, **law)],
                         [Step(pressure=200.0), Step(pressure=200.0, time=10.0)])
    bore = math.sqrt(3.0) / 5 * 200.0 * 2**0.4 / (2**0.4 - 1)
    assert found["mises", 1][0] == pytest.approx(bore, rel=1e-4)
    fit = solution([Ring(0.0, 50.0, 200e3, 0.3), Ring(50.0, 100.0, 200e3, 0.3, **law)],
                   [Step(overlap=0.05), Step(overlap=0.05, time=10.0)])
    pressures = [each["joint"][0] for each in fit]
    assert np.allclose(pressures, [82.4176, 36.158], rtol=0.0, atol=0.002)


@pytest.mark.parametrize(("family", "seed"), [("tubes", 9), ("fits", 1)])
def test_the_program_comes_to_the_reference(family, seed, tmp_path):
    """At least in the first order, on a quarter of the elements, in an eighth of the increments."""
    deck = FAMILIES[family](seed)
    deck = replace(deck, text=re.sub("LOCAL ERROR=.*", "LOCAL ERROR=1.E-4", deck.text))
    runs = [solved(deck, level, part, tmp_path) for level, part in ((0, 1), (2, 8))]
    for key, (value, known) in reference(deck, tmp_path).items():
        coarse, fine = (np.nanmax(np.abs(run[key] - value)) / np.abs(value).max() for run in runs)
        assert fine < max(0.4 * coarse, 2e-4, known.max() / np.abs(value).max()), key


def test_uncertainties_hold_on_some_decks():
    """The document tells the share of all."""
    told = told_values(FILE)
    decks = [deck for deck in drawn(told) if deck.name in TESTED]
    cases = [case for deck in decks for case in judged(deck, told, "FULL") if case.is_known]
    assert {case.deck for case in cases} == set(TESTED)
    assert all(case.is_told for case in cases)
    assert np.mean([case.is_held for case in cases]) >= 0.95, misses({"FULL": cases}).rows


def test_the_document_tells_shares_of_95_percent_of_all_and_of_85_in_each_family():
    report.check_parts([TEXT])
    check_shares(SHARES, least=85)
    check_shares(OF_FAMILIES, "all", 85)
    shares = [row["FULL: all"].split(",")[0].split("/") for row in report.rows(OF_FAMILIES)]
    held, number = np.sum(np.array(shares, int), axis=0)
    assert held >= 0.95 * number
