"""Branches of solutions (*CONTINUATION) through turning points of the load."""

import h5py
import numpy as np
import pytest
from branch_rods import YOUNG, Rods
from changes import note_changes
from deck_runs import COUPLED, CYLINDER, INPUT, copy_deck, run, solve
from scipy.optimize import minimize_scalar

LOADS = (0.3, 0.45, 0.55, 0.65, 0.75, 0.85, 0.95)
FOLD = 1e-6   # of the load
NEAR = 0.04   # of a flux: what a line between points of a branch leaves


def followed(path):
    """Return load factors, folds, and flux and opening of every contact of a branch."""
    with h5py.File(path) as file:
        history = file["history"]
        contacts = {name: {key: group[key][:] for key in ("gap", "pressure", "heat_rate")}
                    for name, group in file["contact"].items()}
        return history["load_factor"][:], history["fold"][:] > 0, contacts


def crossings(factor, flux, load):
    """Return the fluxes with which a branch crosses a load."""
    k = np.flatnonzero((factor[:-1] - load) * (factor[1:] - load) <= 0.0)
    part = (load - factor[k]) / (factor[k + 1] - factor[k])
    return flux[k] + part * (flux[k + 1] - flux[k])


class Scan:
    """The branches of random rods beside the solutions that a scan finds."""

    def __init__(self, seed, folder):
        self.rods, self.folder, self.count = Rods(seed), folder, 0
        self.found = {load: [] for load in LOADS}
        self.states = {load: self.rods.solutions(load) for load in LOADS}
        self.follow(first=0.05, continuation="*CONTINUATION, POINTS=1000")

    def follow(self, **cards):
        """Follow a branch: each crossing must be a solution, each fold where two of them meet."""
        deck = self.folder / f"branch{self.count}.inp"
        self.count += 1
        deck.write_text(self.rods.cards(**cards))
        factor, folds, contacts = followed(solve(deck))
        flux = contacts["C0"]["heat_rate"]
        for load, states in self.states.items():
            for q in crossings(factor, flux, load):
                assert np.min(np.abs(states[:, 0] / q - 1.0)) < NEAR, (load, q, states)
                self.found[load].append(q)
        compliance = self.rods.length[:2].sum() / YOUNG
        for k in np.flatnonzero(folds):
            opening = contacts["C0"]["gap"][k].mean() - compliance * contacts["C0"]["pressure"][k].mean()
            side = np.geomspace(1e-10, 0.05, 4001) * self.rods.gap[0]
            around = np.unique([*(opening - side), 0.0, *(opening + side)])
            around = around[np.abs(around - opening) <= side[-1]]
            counts = [len(self.rods.solutions(factor[k] * side, around))
                      for side in (1.0 - FOLD, 1.0 + FOLD)]
            assert abs(counts[1] - counts[0]) == 2, (deck, factor[k], counts)
        return factor

    def missing(self):
        """Return a solution that is on no branch so far: (load, state); None without one."""
        for load, states in self.states.items():
            for state in states:
                near = [q for q in self.found[load] if abs(q / state[0] - 1.0) < NEAR]
                if not near:
                    return load, state
        return None


def test_all_solutions_of_random_rods_are_on_branches_and_folds_are_where_two_meet(tmp_path):
    most = 0
    for seed in range(20):
        scan = Scan(seed, tmp_path)
        most = max(most, *(len(states) for states in scan.states.values()))
        # Branches that are not joined to the first within the range begin at a solution.
        while (beside := scan.missing()) is not None and scan.count < 12:
            load, state = beside
            omega = [float(scan.rods.omega(j, z)) for j, z in enumerate(state[1:])]
            start = ["*START, FROM=GIVEN", *(f"C{j}, {w:.4g}" for j, w in enumerate(omega))]
            for direction in ("UP", "DOWN"):
                factor = scan.follow(
                    first=load, start=start,
                    continuation=f"*CONTINUATION, POINTS=1000, DIRECTION={direction}")
                scan.found[load].append(state[0])
                assert factor[0] == load
        assert scan.missing() is None, (seed, scan.missing())
    assert most >= 3, "no rods have several solutions"


# The rods R3 of input/rods: one contact, the load factor explicit in the opening.
LENGTH, CONDUCTIVITY, GAP, A, B, TOUCH = 0.1, 20.0, 1.2e-4, 0.005, 1e-5, 500.0


def factor_of(opening):
    """Return the load factor with which the second of the rods R3, alone expanding, leaves a gap or
    an overlap."""
    pressure = max(-opening, 0.0) * 2e11 / (2 * LENGTH)
    omega = A / (B + opening) if opening > 0.0 else TOUCH + 1e-4 * pressure
    flux = 500.0 / (2 * LENGTH / CONDUCTIVITY + 1 / omega)
    return (GAP - opening) / (12e-6 * LENGTH * flux * LENGTH / (2 * CONDUCTIVITY))


def branch_of_r3(folder, continuation, first="0.02", start=(), more=()):
    """Return the cards of the rods R3, and the result of their branch."""
    cards = ["*PARAMETER", f"gap = {GAP}, alpha1 = 0., alpha2 = 12.E-6",
             f"a = {A}, b = {B}, touch = {TOUCH}", f"*INCLUDE, INPUT={INPUT}/rods/rods.inc",
             *start, "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", f"{first}, 1.",
             continuation, f"*INCLUDE, INPUT={INPUT}/rods/rods.step", *more, "*END STEP"]
    deck = folder / f"r3-{len(list(folder.iterdir()))}.inp"
    deck.write_text("\n".join(["*OPTIONS, WIDTH=300", *cards]) + "\n")
    return cards, deck


def test_folds_of_rods_are_those_of_the_closed_form(tmp_path):
    _, deck = branch_of_r3(tmp_path, "*CONTINUATION, HIGHEST=1.5")
    factor, folds, contacts = followed(solve(deck))
    exact = [minimize_scalar(lambda z: -factor_of(z), bounds=(1e-5, 6e-5), options={"xatol": 1e-14},
                             method="bounded").fun * -1,
             minimize_scalar(factor_of, bounds=(-1e-5, -1e-6), options={"xatol": 1e-14},
                             method="bounded").fun]
    np.testing.assert_allclose(factor[folds], exact, rtol=FOLD)
    face = contacts["FACE"]
    for k, (gap, pressure) in enumerate(zip(face["gap"], face["pressure"], strict=True)):
        opening = gap.mean() or -pressure.mean() * 2 * LENGTH / 2e11
        assert factor_of(opening) == pytest.approx(factor[k], rel=1e-7)
    summary = deck.with_suffix(".lst").read_text()
    assert "the branch turns at load factors 1.08, 0.916317 (no estimate: branches)" in summary
    assert "the branch ends here: the load factor is 1.5" in summary


def test_labels_and_times_of_points(tmp_path):
    """The middle of three states is unstable; times rise where the load factor falls."""
    _, deck = branch_of_r3(tmp_path, "*CONTINUATION, HIGHEST=1.5")
    with h5py.File(solve(deck)) as file:
        history = {key: values[:] for key, values in file["history"].items()}
    first = np.flatnonzero(history["fold"])[0]
    assert not history["unstable"][:first].any()
    assert history["unstable"][first + 1]
    np.testing.assert_allclose(np.diff(history["time"]), 1.0 / 200, rtol=1e-9)
    # Without *OPTIONS, LOAD= the load axis is the time, of branches too.
    np.testing.assert_array_equal(history["load"], history["time"])


def test_a_closed_branch_ends_at_its_first_point(tmp_path):
    rods = Rods(31)
    state = rods.solutions(0.75)[0]
    start = [f"C{j}, {float(rods.omega(j, z)):.4g}" for j, z in enumerate(state[1:])]
    deck = tmp_path / "closed.inp"
    deck.write_text(rods.cards(first=0.75, start=["*START, FROM=GIVEN", *start],
                               continuation="*CONTINUATION"))
    factor, folds, contacts = followed(solve(deck))
    assert factor[-1] == pytest.approx(0.75, abs=1e-12)
    assert folds.sum() == 2
    flux = contacts["C0"]["heat_rate"]
    assert flux[-1] == pytest.approx(flux[0], rel=1e-8)
    assert "it comes back to its first point" in deck.with_suffix(".lst").read_text()
    for side, count in ((min(factor) - 1e-6, 1), (min(factor) + 1e-6, 3),
                        (max(factor) - 1e-6, 3), (max(factor) + 1e-6, 1)):
        assert len(rods.solutions(side)) == count


def test_friction_that_reverses_ends_the_branch_by_name(tmp_path):
    """The cylinder, unloaded: its contact points slip back."""
    card = "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE"
    deck = copy_deck(CYLINDER, tmp_path / "unloaded.inp", ["*OPTIONS, ERRORS=NO"], {
        f"{card}, DIRECT\n20., 900.": f"{card}\n900., 900.\n*CONTINUATION, DIRECTION=DOWN"})
    deck.write_text(deck.read_text().split("*VERIFY")[0])
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 2
    assert "friction reverses in contact pair FACE at load factor" in process.stderr


def test_a_constant_conductance_has_no_branch(tmp_path):
    cards, deck = branch_of_r3(tmp_path, "*CONTINUATION")
    rods = (INPUT / "rods" / "rods.inc").read_text()
    laws = "*GAP LAW, TYPE=GAS\n<a>, <b>\n*GAP LAW, TYPE=POWER\n<touch>, 1.E-4, 1.\n"
    assert laws in rods
    (tmp_path / "rods.inc").write_text(rods.replace(
        laws, "*GAP LAW, TYPE=CLEARANCE\n500., 0.\n*GAP LAW, TYPE=POWER\n500., 0., 1.\n"))
    deck.write_text(deck.read_text().replace(f"INPUT={INPUT}/rods/rods.inc", "INPUT=rods.inc"))
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 2
    assert "no conductance depends on gap or pressure" in process.stderr


def exchanged_twin(path, levels, points=24):
    """Write the twin with the base expanding in place of the cylinder, 0.006 below it, with elements
    of first order: heat closes the gap that it crosses."""
    lines, inside = [], False
    for line in COUPLED.read_text().split("*VERIFY")[0].splitlines():
        if line.startswith("*"):
            inside = line.startswith("*NODE, NSET=CYLINDER")
        elif inside:
            node, x, y = line.split(",")
            line = f"{node}, {x}, {float(y) - 0.5 + 0.006:.12g}"
        lines.append(line)
    text = "\n".join(lines) + "\n"
    for old, new in {"*EXPANSION\n1.2E-5": "*EXPANSION\nHOT", "*EXPANSION\n0.": "*EXPANSION\n1.2E-5",
                     "*EXPANSION\nHOT": "*EXPANSION\n0.", "*FRICTION\n0.155, 1.E5\n": "",
                     ", DIRECT\n20., 900.": f"\n20., 900.\n*CONTINUATION, POINTS={points}",
                     "*OPTIONS, UNITS": "*OPTIONS, ORDER=1, ERRORS=NO, UNITS",
                     "*FIXED POINT": f"*REFINE, LEVELS={levels}\n*FIXED POINT"}.items():
        assert old in text, old
        text = text.replace(old, new, 1)
    path.write_text(text)
    return path


def test_fold_of_the_twin_on_three_meshes_converges_with_the_order_of_its_elements(tmp_path):
    loads = []
    for levels in (1, 2, 3):
        factor, folds, _ = followed(solve(exchanged_twin(tmp_path / f"twin{levels}.inp", levels)))
        loads.append(factor[folds][0])
    changes = np.diff(loads)
    order = np.log2(changes[0] / changes[1])
    assert 1.8 < order < 2.2, (loads, order)
    # The quadratic elements of the published mesh, refined twice.
    assert loads[-1] + changes[-1] / 3 == pytest.approx(0.673159, rel=2e-6)


@pytest.mark.changes("CONTINUATION, POINTS")
def test_points(tmp_path):
    decks = [branch_of_r3(tmp_path, f"*CONTINUATION, POINTS={count}") for count in (5, 9)]
    note_changes(decks[0][0], decks[1][0])
    assert [len(followed(solve(deck))[0]) for _, deck in decks] == [5, 9]


@pytest.mark.changes("CONTINUATION, HIGHEST")
def test_highest(tmp_path):
    decks = [branch_of_r3(tmp_path, f"*CONTINUATION, HIGHEST={end}") for end in (0.5, 0.7)]
    note_changes(decks[0][0], decks[1][0])
    assert [followed(solve(deck))[0][-1] for _, deck in decks] == [0.5, 0.7]


@pytest.mark.changes("CONTINUATION, LOWEST")
def test_lowest(tmp_path):
    decks = [branch_of_r3(tmp_path, f"*CONTINUATION, DIRECTION=DOWN, LOWEST={end}", first="0.5")
             for end in (0.1, 0.2)]
    note_changes(decks[0][0], decks[1][0])
    assert [followed(solve(deck))[0][-1] for _, deck in decks] == [0.1, 0.2]


@pytest.mark.changes("CONTINUATION, DIRECTION")
def test_direction(tmp_path):
    decks = [branch_of_r3(tmp_path, f"*CONTINUATION, DIRECTION={way}", first="0.5")
             for way in ("UP", "DOWN")]
    note_changes(decks[0][0], decks[1][0])
    up, down = (followed(solve(deck))[0] for _, deck in decks)
    assert up[1] > up[0] and down[1] < down[0]


@pytest.mark.changes("CONTINUATION, ARC")
def test_arc(tmp_path):
    """Steps are no longer than the length given, and mostly as long."""
    decks = [branch_of_r3(tmp_path, f"*CONTINUATION, ARC={arc}") for arc in (0.02, 0.05)]
    note_changes(decks[0][0], decks[1][0])
    counts = []
    for (_, deck), arc in zip(decks, (0.02, 0.05), strict=True):
        factor, _, _ = followed(solve(deck))
        assert np.abs(np.diff(factor)).max() < arc
        counts.append(len(factor))
    assert counts[0] / counts[1] == pytest.approx(2.5, rel=0.15)
