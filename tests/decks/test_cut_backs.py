"""Increments that fail are cut back, and grow again; the smallest one that fails ends the run.

The rods are those of test_rods.py. Plain iteration (4.1) multiplies an error by U' in a pass, so it
fails where U' < -1, and where it is allowed too few passes for its start; the start is extrapolated
from the increment before, and so the better the smaller the increment is.
"""

import re

import h5py
import numpy as np
import pytest
import test_rods as rods
from deck_runs import COUPLED, INPUT, copy_deck, data_cards, datasets, run, solve
from test_held import CLAMP, MU, clamped

SMALLEST = 1e-5  # of the period, the default
COUNTS = ("history/iterations", "convergence")


@pytest.fixture
def deck(tmp_path):
    """Return a function that writes the deck of the rods with other cards; its path."""

    def make(increments="1., 1.", fixed_point="PICARD, TOL=1.E-12, MAXITER=10", step="*STEP",
             law=None, cards=()):
        path = rods.write_rods(tmp_path / "rods.inp")
        changes = {"0.1, 1.": increments, "*STEP\n": f"{step}\n",
                   "ZAITSEV, TOL=1.E-12": fixed_point}
        if law:
            a, b = law
            changes |= {f"{rods.GAS_A}, {rods.GAS_B}": f"{a!r}, {b!r}",
                        f"{rods.GAS_A / rods.GAS_B!r}, {rods.CLOSED_C}": f"{a / b!r}, 1.E-4"}
        return copy_deck(path, path, cards, changes)

    return make


def rows_of(result, extension):
    """Return the fields of the lines of a .sta or .cvg file, without its heading."""
    lines = result.with_suffix(extension).read_text().splitlines()
    return [line.split() for line in lines[1:]]


def cut_backs(result):
    """Return the cut-backs of each increment, by the .sta."""
    return np.array([int(row[5]) for row in rows_of(result, ".sta")])


def history(result, name):
    """Return a dataset of the history."""
    with h5py.File(result) as file:
        return file[f"history/{name}"][()]


def test_a_load_that_fails_at_once_is_reached_in_parts(deck):
    """Whether the passes sufficed or the increment was cut back, the answer is the closed form."""
    fails = deck("1., 1., 1.")
    assert run("run", fails, "--out", fails.parent).returncode == 2
    result = solve(deck())
    gamma, flux = rods.open_rods(rods.MESHED_GAP)
    np.testing.assert_allclose(rods.last(result, "gap"), gamma, rtol=1e-9)
    np.testing.assert_allclose(rods.last(result, "heat_flux"), flux, rtol=1e-9)
    assert cut_backs(result).sum() > 0
    assert history(result, "time")[-1] == 1.0


def test_every_attempt_is_on_record(deck):
    result = solve(deck())
    cuts, iterations = cut_backs(result), history(result, "iterations")
    with h5py.File(result) as file:
        passes = {name: file[f"convergence/{name}"][()] for name in file["convergence"]}
    # Passes of all attempts count.
    np.testing.assert_array_equal(np.bincount(passes["increment"])[1:], iterations)
    for increment in np.flatnonzero(cuts) + 1:
        of_it = passes["increment"] == increment
        np.testing.assert_array_equal(np.unique(passes["cut_backs"][of_it]),
                                      np.arange(cuts[increment - 1] + 1))
        for attempt in range(cuts[increment - 1]):
            failed = of_it & (passes["cut_backs"] == attempt)
            np.testing.assert_array_equal(passes["iteration"][failed], np.arange(1, 11))
            assert passes["residual"][failed].min() > 1e-12
    rows = rows_of(result, ".cvg")
    assert [int(row[7]) for row in rows] == passes["cut_backs"].tolist()
    assert [int(row[0]) for row in rows] == passes["increment"].tolist()
    listing = result.with_suffix(".lst").read_text()
    assert len(re.findall(r"^ +attempt \d+ of size .* not kept: the conductance", listing, re.M)) \
        == cuts.sum()
    assert "attempt 1 of size 1, to time 1, not kept" in listing
    blocks = re.findall(r"iterations (\d+) +cut-backs (\d+)", listing)
    assert [(int(a), int(b)) for a, b in blocks] == list(zip(iterations, cuts, strict=True))


def test_after_a_cut_back_increments_land_where_they_must(deck):
    """On multiples of the first increment, times of *VERIFY and corners of amplitudes; and they
    grow again: behind the last cut-back none takes longer than it must."""
    cards = ["*AMPLITUDE, NAME=UNUSED", "0., 0., 0.61, 1.",
             '*VERIFY, KIND=ANALYTIC, SOURCE="where it lands"', "time, , 0.37, 0.37, 0., ABS"]
    result = solve(deck("0.25, 1.", cards=cards))
    times, cuts = history(result, "time"), cut_backs(result)
    assert cuts.sum() > 0
    for landing in (0.25, 0.37, 0.5, 0.61, 0.75, 1.0):
        assert landing in times
    sizes = np.diff(times, prepend=0.0)
    assert sizes.max() <= 0.25 * (1 + 1e-12)
    # A size doubles behind an increment that did not fail, unless something was landed on.
    landings = np.isclose(times[:, None], [0.25, 0.37, 0.5, 0.61, 0.75, 1.0], rtol=0).any(axis=1)
    for k in np.flatnonzero((cuts[:-1] == 0) & (cuts[1:] == 0) & ~landings[1:]) + 1:
        assert sizes[k] >= 2 * sizes[k - 1] * (1 - 1e-9)


HELD_BACK = {"0.1, 1.": "1., 1.", "*STEP\n": "*STEP, INC=1000\n"}


@pytest.mark.parametrize(("scheme", "pairing"), [
    ("IMPLICIT", "NODES"), ("GALERKIN", "NODES"), ("IMPLICIT", "SURFACES")])
def test_cut_backs_leave_nothing_behind(tmp_path, scheme, pairing):
    """A run whose increments were cut back is, bit by bit, the one whose increments were given.

    Friction and (3.4) remember the increments before, films make factors of their own at each
    instant. The second deck is told by *VERIFY to land where the first one did.
    """
    source = INPUT / "examples" / "brake_pad.inp"
    (tmp_path / "brake_pad.mesh").write_text((source.parent / "brake_pad.mesh").read_text())
    text = source.read_text()
    text = text[: text.index("*VERIFY")].replace("NAME=TRACK", f"NAME=TRACK, PAIRING={pairing}")
    assert text.count("PAIRING") == 1
    plain = tmp_path / "plain.inp"
    plain.write_text(text)
    cards = ["*FIXED POINT, METHOD=ZAITSEV, MAXITER=6", f"*THERMAL SCHEME, TYPE={scheme}"]
    cut = copy_deck(plain, tmp_path / "cut.inp", cards, HELD_BACK)
    first = solve(cut)
    assert cut_backs(first).sum() >= 3
    checks = ['*VERIFY, KIND=ANALYTIC, SOURCE="lands"']
    checks += [f"time, , {float(t)!r}, {float(t)!r}, 1.E-12" for t in history(first, "time")]
    given = copy_deck(cut, tmp_path / "given.inp")
    given.write_text(given.read_text() + "\n".join(checks) + "\n")
    second = solve(given)
    assert cut_backs(second).sum() == 0
    one, other = (datasets(result, "history", "contact", "VTKHDF") for result in (first, second))
    assert one.keys() == other.keys()
    for name, values in one.items():
        if name != "history/iterations":
            np.testing.assert_array_equal(other[name], values, err_msg=name)


STEEP = 0.001, 1e-6  # R2: U' = -11.4 at the whole load
STEEP_GAP = 4.7e-4


def steep_rods(share):
    """Return gamma and U' of the open rods at a share of the load: hot wall and approach of the
    walls. gamma is the positive root of (gamma - g0 + e0) (R0 A + B + gamma) = -e1 A T1, and U' is
    (d omega/d gamma) (d gamma/d q) (d q/d omega): (-omega/(B + gamma)) (-e1) (q^2/(T1 omega^2)).
    """
    (a, b), hot = STEEP, share * rods.HOT
    gap = rods.MESHED_GAP + share * (STEEP_GAP - rods.MESHED_GAP)
    closed, lag = rods.EXPANSION * rods.LENGTH * hot - gap, rods.RESISTANCE * a + b
    gamma = max(np.roots([1.0, closed + lag, closed * lag - rods.PER_FLUX * a * hot]))
    omega = a / (b + gamma)
    flux = hot / (rods.RESISTANCE + 1 / omega)
    return gamma, -omega / (b + gamma) * rods.PER_FLUX * flux**2 / (hot * omega**2)


def test_gain_is_that_of_the_two_rods_with_known_answers():
    gamma, slope = steep_rods(1.0)
    assert gamma == pytest.approx(4.947181134e-7, rel=1e-7)
    assert slope == pytest.approx(-11.3526, rel=1e-4)


def test_smallest_increment_ends_the_run_and_keeps_what_was_solved(deck):
    path = deck("0.25, 1.", "PICARD, TOL=1.E-12", "*STEP, INC=3000", STEEP)
    nearer = f"NEARER={STEEP_GAP - rods.MESHED_GAP!r}"
    process = run("run", "--quiet", path, "--out", path.parent, "--set", nearer)
    assert process.returncode == 2
    said = re.search(
        r"increment (\d+) \(time ([^)]+)\): the conductance does not converge in 50 iterations; "
        r".*; step 1, increment size 1E-5, the smallest that the step allows",
        process.stderr,
    )
    assert said, process.stderr
    assert "shorter" not in process.stderr   # than the default, which hardly helps
    result = path.with_suffix(".vtkhdf")
    times = history(result, "time")
    assert int(said[1]) == len(times) + 1
    assert float(said[2]) == pytest.approx(times[-1] + SMALLEST, abs=1e-6)
    assert len(rows_of(result, ".sta")) == len(times)
    with h5py.File(result) as file:
        gaps = file["contact/FACE/gap"][()]
        passes, residual = file["convergence/increment"][()], file["convergence/residual"][()]
    assert passes[-1] == len(times) + 1
    assert residual[-1] > 1e-12
    listing = result.with_suffix(".lst").read_text()
    ending = " ".join(listing[listing.rindex("ENDED EARLY"):].split())
    assert "does not converge in 50 iterations" in ending
    assert "increment size 1E-5, the smallest that the step allows" in ending
    for time, gap in zip(times, gaps, strict=True):
        gamma, _ = steep_rods(time)
        np.testing.assert_allclose(gap, gamma, rtol=1e-9, atol=1e-15)
    # 50 passes bring any error below 1e-12 while |U'|^49 < 1e-12, and none once U' < -1.
    _, slope = steep_rods(times[-1])
    assert -1.0 < slope < -(1e-12 ** (1 / 49))


def test_given_smallest_increment_is_obeyed(deck):
    path = deck("1., 1., 0.1")
    process = run("run", "--quiet", path, "--out", path.parent)
    assert process.returncode == 2
    assert re.search("increment size 0.1, the smallest that the step allows.*; give a shorter smallest "
                     "increment, the third value of the step's times", process.stderr)
    attempts = np.array([[float(x) for x in found] for found in re.findall(
        r"attempt \d+ of size (\S+), to time (\S+), not kept", path.with_suffix(".lst").read_text())])
    assert attempts[:, 0].min() == 0.1


def test_direct_increments_are_not_cut_back(deck):
    path = deck()
    path.write_text(path.read_text().replace("STEADY STATE", "STEADY STATE, DIRECT"))
    process = run("run", "--quiet", path, "--out", path.parent)
    assert process.returncode == 2
    assert "increment size 1, which DIRECT does not allow to be cut back: leave DIRECT out" in process.stderr
    assert not path.with_suffix(".vtkhdf").exists()
    assert {row[7] for row in rows_of(path, ".cvg")} == {"0"}


def test_inc_counts_increments_and_not_attempts(deck):
    whole = solve(deck())
    count, cuts = len(history(whole, "time")), cut_backs(whole).sum()
    assert cuts > 0
    assert len(history(solve(deck(step=f"*STEP, INC={count}")), "time")) == count
    path = deck(step=f"*STEP, INC={count - 1}")
    process = run("run", "--quiet", path, "--out", path.parent)
    assert process.returncode == 2
    assert f"step 1 is not finished after INC={count - 1} increments, at " in process.stderr
    assert "of its period 1; a larger INC= allows more; the listing" in process.stderr
    assert len(history(path.with_suffix(".vtkhdf"), "time")) == count - 1


def test_the_limit_load_is_found_to_the_smallest_increment(tmp_path):
    """Friction on both faces carries 2 mu N at most; the step goes to 1.1 of that."""
    limit = 2 * MU * CLAMP
    path = clamped(tmp_path / "limit.inp", 1.1 * limit)
    process = run("run", "--quiet", path, "--out", tmp_path)
    assert process.returncode == 2
    assert "body 1 (of MIDDLE, first node 1) is free to slide along x" in process.stderr
    assert "step 2, increment size 1E-5, the smallest that the step allows" in process.stderr
    with h5py.File(path.with_suffix(".vtkhdf")) as file:
        shear = sum(file[f"contact/{pair}/shear_force"][-1] for pair in ("BELOW", "ABOVE"))
    assert cut_backs(path).sum() > 0
    assert 1.0 - 1.1 * 2 * SMALLEST < -shear / limit <= 1.0 + 1e-9


def test_the_coupled_twin_goes_further_with_smaller_increments(tmp_path):
    """Its increments of 20 C fail from 500 C on by (4.2); landing on the same multiples of 20 C,
    smaller ones give the same answers and go on."""
    (first, period), = ([float(x) for x in row[:2]] for row in data_cards(
        COUPLED, "*COUPLED TEMPERATURE-DISPLACEMENT"))
    given = re.search(r"^\*FIXED POINT.*$", COUPLED.read_text(), flags=re.MULTILINE)[0]
    ends = {}
    for ending in (", DIRECT", ""):
        changes = {given: "*FIXED POINT, METHOD=ZAITSEV",
                   "STEADY STATE, DIRECT": f"STEADY STATE{ending}"}
        path = copy_deck(COUPLED, tmp_path / f"twin{len(ending)}.inp", changes=changes)
        assert run("run", "--quiet", path, "--out", tmp_path).returncode == 2
        result = path.with_suffix(".vtkhdf")
        with h5py.File(result) as file:
            ends[ending] = file["history/time"][()], file["contact/FACE/gap"][()]
    times, gaps = ends[""]
    fixed, fixed_gaps = ends[", DIRECT"]
    assert times[-1] > fixed[-1] + first
    assert period > times[-1]
    np.testing.assert_array_equal(times[: len(fixed)], fixed)
    np.testing.assert_array_equal(gaps[: len(fixed)], fixed_gaps)
    assert fixed[-1] + first in times
