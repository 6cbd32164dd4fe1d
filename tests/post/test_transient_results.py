"""Results of steps that store heat: pages and pictures have the true time, comparisons meet."""

import csv
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "decks"), str(TESTS.parent / "python")]

import calculix  # noqa: E402
import transients as two  # noqa: E402
from comparing import compare, line_of  # noqa: E402, F401  fixtures
from deck_runs import solve  # noqa: E402

from thercon.post.cli import main as plot  # noqa: E402
from thercon.post.report.cli import main as report  # noqa: E402

UNITS = '*OPTIONS, UNITS="m Pa W C"'


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """Return a result with increments by error: the first is a thousandth of the last."""
    folder = tmp_path_factory.mktemp("transient")
    deck = two.two_blocks(folder / "deck.inp", UNITS, how=", DILATATION=YES")
    found = solve(deck)
    assert report([str(found), "--out", str(folder)]) == 0
    times, = two.history(found, "time")
    assert np.diff(times).max() > 100 * times[0]
    return found


LOOK = """const of = id => document.getElementById(id);
    return {now: of('now').textContent, place: Number(of('load').value),
        label: document.querySelector('label[for=load]').textContent,
        range: of('range').textContent,
        marker: of('history-0').querySelector('.upright').getAttribute('d')}"""
MOVE = """const slider = document.getElementById('load'); slider.value = arguments[0];
    slider.dispatchEvent(new Event('input', {bubbles: true}))"""


def test_the_slider_of_a_page_has_the_true_time(result, browser):
    """Its places are times; arrow keys go from one increment to the next, other places to the
    nearest one."""
    times, = two.history(result, "time")
    with h5py.File(result) as file:
        warmest = file["VTKHDF/PointData/temperature"][()].reshape(len(times), -1).max(axis=1)
    browser.open(result.with_suffix(".html"))
    browser.run("""const box = document.getElementById('quantity');
        box.value = [...box.options].find(
            each => each.textContent.startsWith('Temperature')).value;
        box.dispatchEvent(new Event('input', {bubbles: true}))""")
    seen = {-1: browser.run(LOOK)}
    browser.press("#load", "left")
    seen[-2] = browser.run(LOOK)
    browser.press("#load", "home")
    seen[0] = browser.run(LOOK)
    browser.press("#load", "left", "right", "right")
    seen[2] = browser.run(LOOK)
    for row, found in seen.items():
        assert found["label"] == "Time"
        assert found["place"] == pytest.approx(times[row], rel=1e-12)
        number = row % len(times) + 1
        assert found["now"].startswith(f"{number} of {len(times)}: time ")
        shown = found["now"].split()[-1].replace("−", "-")
        assert float(shown) == pytest.approx(times[row], rel=1e-3)
        assert f"largest {warmest[row]:.5g} at node" in found["range"]
    middle = times[-1] / 2
    browser.run(MOVE, str(middle))
    near = int(np.argmin(np.abs(times - middle)))
    assert browser.run(LOOK)["now"].startswith(f"{near + 1} of {len(times)}: ")
    assert near > 0.6 * len(times)   # by number half would be far earlier
    # The marker of the histories stands at the time.
    starts = [float(found["marker"][1:].split()[0].split("V")[0]) for found in seen.values()]
    places = [float(times[row]) for row in seen]
    np.testing.assert_allclose(np.polyval(np.polyfit(places, starts, 1), places), starts, atol=0.2)
    assert np.ptp(starts) > 100
    rates = browser.run("""return [...document.querySelectorAll('figure[id^=history]')].map(
        each => each.textContent)""")
    for name in ("that strains take up", "in", "out", "stored"):
        (words,) = (words for words in rates if f"Heat {name}:" in words)
        assert words.endswith(" W")
    assert browser.messages() == []


def drawn(folder, name):
    """Return a written table as {column: values}."""
    with open(folder / name, newline="") as file:
        rows = list(csv.DictReader(file))
    return {key: np.array([float(row[key] or "nan") for row in rows]) for key in rows[0]}


def test_pictures_have_the_time_as_abscissa(result, tmp_path):
    for picture in ("mesh", "profiles", "zones", "fields", "courses", "convergence"):
        assert plot([picture, str(result), "--csv", "--out", str(tmp_path)]) == 0
    times, stored, strains = two.history(result, "time", "heat_stored", "heat_dilatation")
    courses = drawn(tmp_path, "deck.courses.csv")
    np.testing.assert_allclose(courses["time"], times, rtol=1e-12)
    np.testing.assert_allclose(courses["heat_stored"], stored, rtol=1e-12)
    np.testing.assert_allclose(courses["heat_taken_up_by_strains"], strains, rtol=1e-12)
    zones = drawn(tmp_path, "deck.zones-pairs.csv")
    assert set(zones["load"]) == set(times)
    row = len(times) // 3
    chosen = ["--load", repr(float(times[row]))]
    assert plot(["profiles", str(result), *chosen, "--csv", "--out", str(tmp_path)]) == 0
    (name,) = (path.name for path in tmp_path.glob("deck.profiles-*.csv"))
    with h5py.File(result) as file:
        np.testing.assert_allclose(drawn(tmp_path, name)["pressure"],
                                   file["contact/FACE/pressure"][row], rtol=1e-12)


def test_results_of_other_increments_meet_in_their_histories(compare, tmp_path):  # noqa: F811
    """Along time, to what their increments err; a body that stores half does not."""
    one = solve(two.two_blocks(tmp_path / "one.inp", how=""))
    fine = solve(two.two_blocks(tmp_path / "fine.inp", how=", LOCAL ERROR=1.E-4"))
    bodies = [card.replace("2.0", "1.0") if before == "*SPECIFIC HEAT" else card
              for before, card in zip(["", *two.bodies()], two.bodies(), strict=False)]
    light = solve(two.write_deck(tmp_path / "light.inp", bodies, two.contact(), two.heated(how="")))
    quantities = "heat_in", "heat_stored", "normal_force"
    arguments = ("--only", *quantities, "--by", "curve", "--block", 2e-3)
    status, said, _ = compare(fine, one, *arguments)
    assert status == 0, said
    for quantity in quantities:
        assert line_of(said, quantity)["by"] == "curve"
    assert compare(fine, light, *arguments)[0] == 1
    status, said, _ = compare(one, one, "--block", 0)
    assert status == 0
    assert line_of(said, "heat_stored")["rows"] > 50


def test_a_result_meets_that_of_calculix(compare, tmp_path):  # noqa: F811
    """Heat in bodies of eight-node elements with backward differences, digit for digit."""
    cards = ["*THERMAL SCHEME, TYPE=IMPLICIT", *two.bodies()]
    cards = cards[:cards.index("*BOUNDARY")]
    step = ["*STEP, INC=100", "*HEAT TRANSFER, DIRECT", f"{two.FIRST!r}, {two.PERIOD!r}", "*FILM",
            *(f"{n}, F3, {two.HOT!r}, {two.HOT_FILM!r}" for n in (5, 6)),
            *(f"{n}, F1, {two.COLD!r}, {two.COLD_FILM!r}" for n in (1001, 1002)),
            "*NODE FILE", "NT", "*NODE PRINT, NSET=UPPER", "NT", "*END STEP"]
    deck = two.write_deck(tmp_path / "deck.inp", cards, step)
    calculix.calculix(deck)
    status, said, error = compare(solve(deck), tmp_path / "ccx" / "deck.frd", "--only", "NT",
                                  "--block", 1e-5)
    assert status == 0, said + error
    line = line_of(said, "NT")
    assert (line["by"], line["times"]) == ("node", 10)
    assert line["not_in_a"] == line["not_in_b"] == 0
