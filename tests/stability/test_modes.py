"""States that last and states that do not: what *STABILITY finds, against dense eigenvalues, closed
forms and runs in time."""

from collections import Counter
from functools import partial
from itertools import product
from math import log, pi, sqrt

import h5py
import numpy as np
from blocks import write
from deck_runs import COUPLED, CYLINDER, run, solve
from physics import material, mesh
from pictures import save, subplots
from report import Picture, Table, check_rows, verdict
from scipy.optimize import brentq
from test_stability import BRANCHES, MIDDLE, middle, rod_deck, stability_of
from test_stored_heat import CONSTANT, STORED, TOP, heated
from thercon.post import style

import rod_modes
import rods
from frictional_heat import burton

TITLE = "States in time"
TEXT = """
Which states last, and how fast the others are left: figures of [\\*STABILITY](deck/steps.md#stability),
which disturbs a state a little and finds how heat, expansion, contact and conductance respond. "Growing"
is the number of motions that grow; the rate is that of the fastest, negative where all decay.

- Rates and periods agree with dense eigenvalues, closed forms and runs in time to 1e-3. No number
  of growing motions is wrong, at 796 states of two joints, either.
- Rates of a sliding face, `half_plane` in tests/stability/test_modes.py: above Vcr = 2 m k (1 -
  nu)/(mu alpha E) cos(m x) grows at ((sqrt(1 + 8 V/Vcr) - 1)^2/4 - 1) kappa m^2 (Burton).
- The coupling gain U' tells only a part. Of several states those with U' > 1 are unstable, but a
  state may be the only one, with U' = 0, and still oscillate with growing amplitude; one with
  U' = -1000 may last.
- All states of the cylinder and of its twin last, also where the simple iteration (4.1) fails.
"""
IN_DOCUMENT = ["Three states of two rods", "A state that oscillates, and rates of a sliding face", "States of two joints over load and conductance"]
CAPACITY = 3.6e6


def apart(found, rate):
    """Return by how much rate and period of an analysis differ from a complex rate, the larger."""
    errors = [abs(found["growth_rate"][-1] / rate.real - 1)]
    if rate.imag:
        errors.append(abs(found["period"][-1] * abs(rate.imag) / (2 * pi) - 1))
    return float(max(errors))


def motion(rate, period=0.0):
    """Return what becomes of a motion in words."""
    words = f"doubles in {log(2) / rate:.3g}" if rate > 0.0 else f"falls to 1/e in {-1 / rate:.3g}"
    return words + (f", period {period:.4g}" if period else "")


# Rods with three states

def three_states(folder):
    """Return the table of the three states of R3."""
    table = Table("Three states of two rods", [
        "state", "conductance", "growing", "rate, 1/s", "in seconds", "dense eigenvalues",
        "deviation", "verdict"], text=f"""The rods R3 of input/rods with 3.6e6 J/(m3 K), in each of their three states: open and closed last, the middle one is left at the rate of its only growing motion, towards the open state or the closed one; a run in time from beside it does so. Eight elements a rod; expected is the largest real part of the eigenvalues of both rods, with polynomials of degree {rod_modes.TERMS} (tests/reference/rod_modes.py).""")
    for name, branch in (("open", 0), ("middle", 1), ("closed", 2)):
        known = rod_modes.rates(MIDDLE, (CAPACITY, CAPACITY), BRANCHES[branch])
        found = stability_of(solve(write(folder / f"{name}.inp", middle(branch=branch))))
        rate, modes = float(found["growth_rate"][-1]), int(found["unstable_modes"][-1])
        deviation = apart(found, known[0])
        table.rows.append([name, BRANCHES[branch].conductance, str(modes), f"{rate:.6g}",
                           motion(rate), f"{known[0].real:.6g}", deviation, verdict(
                               modes == np.count_nonzero(known.real > 0) and deviation < 1e-3)])
    return table


# A state that is the only one and oscillates

ALIKE = rods.Rods((0.1, 0.1), (20.0, 20.0), (12e-6, 12e-6), (2e11, 2e11), (500.0, 0.0), 6.05e-4)
ALIKE_LAW = 0.005, 1e-6, 5000.0, 1e-4
(ONLY,) = rods.exact_solutions(ALIKE, *ALIKE_LAW)
CROSSING, CROSSING_PERIOD = 1.7094458842, 3076.8496   # of the closed form
COURSE, SMALL = 30000.0, 8000.0                       # s; the motion is small until then


def only_state(ratio):
    """Return the cards of rods that expand alike, the hot one with more capacity."""
    return rod_deck(ALIKE, ALIKE_LAW, (ratio * CAPACITY, CAPACITY), ONLY.conductance)


def oscillating(folder):
    """Return the table of a state that is the only one, by the capacity of the hot rod."""
    table = Table("A state that is the only one and oscillates", [
        "hot over cold capacity", "growing", "rate, 1/s", "in seconds", "expected", "deviation",
        "verdict"], text=f"""Rods of R3 that expand alike, with a gap of 6.05e-4 and omega = 0.005/(1e-6 + gap): heat that crosses moves both faces by the same amount, so that U' = 0, whatever the heat, and the state is the only one. Its faces are {ONLY.separation:.2g} apart. In time more heat warms the cold rod, which closes the gap further, and cools the hot one, which opens it again, but the later the more capacity it has. Expected are dense eigenvalues as above, for the capacities at which a pair of motions begins to grow the closed form.
"By a run" (picture below) is the motion of the heat rate in a run in time of increments of 10 s, after 1e-4 more at the hot end; it is small until {SMALL:g} s. In the end the heat rate goes round a cycle far from the state.""")

    def analysed(ratio):
        return stability_of(solve(write(folder / "only.inp", only_state(ratio))))

    def row(name, found, rate, allowed, modes):
        real, period = float(found["growth_rate"][-1]), float(found["period"][-1])
        deviation = apart(found, rate)
        table.rows.append([name, str(modes), f"{real:.6g}", motion(real, period),
                           motion(rate.real, 2 * pi / abs(rate.imag) if rate.imag else 0.0),
                           deviation, verdict(deviation < allowed)])

    for ratio in (1.0, 1.5, 2.0, 3.0):
        known = rod_modes.rates(ALIKE, (ratio * CAPACITY, CAPACITY), ONLY)
        found = analysed(ratio)
        modes = int(found["unstable_modes"][-1])
        row(f"{ratio:g}", found, known[0], 1e-3 if modes == np.count_nonzero(known.real > 0) else 0,
            modes)
    ratio = brentq(lambda at: float(analysed(at)["growth_rate"][-1]), 1.5, 2.0, xtol=1e-7)
    period = float(analysed(ratio)["period"][-1])
    error = max(abs(ratio / CROSSING - 1), abs(period / CROSSING_PERIOD - 1))
    table.rows.append([f"{ratio:.5f}", "0 or 2", "0", f"period {period:.5g}",
                       f"{CROSSING:.5f}, period {CROSSING_PERIOD:.5g}", error,
                       verdict(error < 1e-3)])
    time, heat = only_course(folder)
    rate, period = small_motion(time, heat)
    known = rod_modes.rates(ALIKE, (2 * CAPACITY, CAPACITY), ONLY)[0]
    row("2, by a run", {"growth_rate": [rate], "period": [period]}, known, 1e-2, "-")
    return table, (time, heat)


def only_course(folder):
    """Return times and heat per area of rods whose hot end gets a little warmer, from then on."""
    cards = only_state(2.0)
    deck = write(folder / "course.inp", ["*OPTIONS, ERRORS=NO"], cards, [
        "*STEP, INC=100000", "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT", f"10., {COURSE!r}",
        "*BOUNDARY", "HOT.TOP, 11, 11, 500.0001", "*NODE FILE, FREQUENCY=0", "NT", "*END STEP"])
    with h5py.File(solve(deck)) as file:
        time = file["history/time"][:]
        contact = file["contact/FACE"]
        return time - time[0], contact["heat_rate"][:] / np.sum(contact["weight"][:])


def small_motion(time, heat, lag=40):
    """Return rate and period of one motion a course consists of: with values v a lag apart,
    v'' = a v' + b v, whose roots are exp(rate lag)."""
    change = np.diff(heat)[(time[1:] > SMALL / 3) & (time[1:] < SMALL)]
    columns = np.column_stack((change[lag:-lag], change[:-2 * lag]))
    (a, b), *_ = np.linalg.lstsq(columns, change[2 * lag:], rcond=None)
    root = np.log(complex(a, sqrt(-a * a - 4 * b)) / 2) / (lag * (time[2] - time[1]))
    return root.real, 2 * pi / root.imag


# Hot spots of a sliding face

DEPTH, FRICTION, POISSON = 14.0, 0.5, 0.3
SPEEDS = 0.5, 0.9, 1.1, 1.5, 1.9, 2.5, 3.1, 3.9
UNIFORM = -(pi / 2 / DEPTH)**2   # rate of what is the same along the face, in the half-plane's depth


def half_plane(ratio, level=1):
    """Return half a wave of a half-plane on an insulator that slides out of the plane, with
    E alpha = k = rho c = 1 and V/Vcr = ratio."""
    steps = 1.25 ** (0.5 / level * np.arange(20 * level))
    ys = DEPTH * np.concatenate([[0.0], np.cumsum(steps)]) / np.sum(steps)
    xs = np.linspace(0.0, pi, 12 * level + 1)
    speed = ratio * 2 * (1 - POISSON) / FRICTION
    return [*mesh("HALF", xs, ys),
            *material("HALF", (1000.0, POISSON), 1e-3, 1.0, 1.0, 1.0),
            *mesh("WALL", xs, [-0.2, 0.0], first=100001),
            *material("WALL", (1000.0, POISSON), conductivity=1.0),
            "*SURFACE INTERACTION, NAME=FACE", "*FRICTION", f"{FRICTION!r}",
            "*GAP HEAT GENERATION", f"1., 1., {speed!r}",
            "*CONTACT PAIR, INTERACTION=FACE, NAME=FACE", "HALF.BOTTOM, WALL.TOP",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "HALF, 0.", "WALL, 0.",
            "*OPTIONS, ERRORS=NO", "*STEP",
            "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT", "1., 1.", "*STABILITY",
            "*BOUNDARY", "WALL, 1, 2, 0.", "WALL, 11, 11, 0.", "HALF.LEFT, 1, 1, 0.",
            "HALF.RIGHT, 1, 1, 0.", "HALF.TOP, 11, 11, 0.", "*DSLOAD", "HALF.TOP, P, 1.",
            "*END STEP"]


def wave_rates(ratio):
    """Return the rates of the waves that fit in, the uniform one first."""
    return [UNIFORM, *(m**2 * burton(ratio / m)[0] for m in range(1, 9))]


def hot_spots(folder, levels=(1, 2)):
    """Return the table of the half-plane, and what *STABILITY found at each speed."""
    table = Table("The speed at which a sliding face gets hot spots", [
        "mesh", "V/Vcr", "growing", "rate, kappa m^2", "wave", "closed form", "deviation",
        "verdict"], text=f"""A half-plane that slides out of the plane on a rigid insulator, in plane strain. Friction heats the face where it is pressed, and there it expands: beyond the speed Vcr = 2 m k (1 - nu)/(mu alpha E) a wave cos(m x) of the pressure grows, at the rate ((sqrt(1 + 8 V/Vcr) - 1)^2/4 - 1) kappa m^2 (Burton, Nerlikar & Kilaparti 1973). The model is half a wave wide and {DEPTH:g}/m deep, of 12 by 20 elements; "2 x" has half their size. The waves 2 m, 3 m and so on fit in, too, from twice and three times the speed on, and may grow faster: the table names the fastest one. Below Vcr what decays last is uniform along the face, at pi^2/4 times kappa over the square of the depth.
The critical speed is sought over V until the rate is 0.""")

    def analysed(ratio, level=1):
        return stability_of(solve(write(folder / "half.inp", half_plane(ratio, level))))

    shown = []
    for ratio in SPEEDS:
        known, found = wave_rates(ratio), analysed(ratio)
        rate, modes = float(found["growth_rate"][-1]), int(found["unstable_modes"][-1])
        wave, deviation = int(np.argmax(known)), apart(found, complex(max(known)))
        shown.append((ratio, rate))
        table.rows.append(["1 x", f"{ratio:g}", str(modes), f"{rate:.5g}",
                           f"{wave} m" if wave else "uniform", f"{max(known):.5g}", deviation,
                           verdict(modes == sum(k > 0 for k in known) and deviation < 1e-3)])
    for level in levels:
        critical = brentq(lambda at, level=level: float(analysed(at, level)["growth_rate"][-1]),
                          0.99, 1.1, xtol=1e-8)
        table.rows.append([f"{level} x", f"{critical:.6f}", "0 or 1", "0", "1 m", "1 at 0",
                           abs(critical - 1), verdict(abs(critical - 1) < 1e-3 / level**2)])
    return table, shown


# The cylinder and its twin

REST = 4e5   # s


def cylinders(folder):
    """Return the table of the cylinder and its twin."""
    table = Table("The cylinder and its twin", [
        "case", "temperature of the top", "coupling gain", "growing", "rate, 1/s",
        "falls to 1/e in, s",
        "over L^2/(pi^2 kappa)", "by a run", "verdict"], text=f"""The published cylinder and its strongly coupled twin (input/cylinder) with the capacity of steel, 3.6 J/(cm3 K). All their states last, also where the gain is far below -1: that a computation by (4.1) fails there says nothing of the state. The slowest motion warms both bodies alike. It sends no heat through the faces, and where the bodies are apart, or pass heat badly, it is that of the lower one alone, L^2/(pi^2 kappa) = {CONSTANT:.0f} s with the height L of both; the upper one is lower at its side, and quicker.
"By a run" is the rate at which temperatures of the face settle in a run in time after 0.1 more at the top, from 2.5e5 to 3.5e5 s on, when faster motions are gone. The increments are 2000 s long, which errs by 0.04 (rate dt)^2, 2e-4 of the rate.""")
    for name, deck, words in (("cylinder", CYLINDER, "METHOD=ZAITSEV"),
                              ("coupled twin", COUPLED, "METHOD=NEWTON")):
        head, _, _ = deck.read_text().partition("*STEP")
        for old, new in (STORED | {words: "METHOD=NEWTON, TOL=1.E-11"}).items():
            assert old in head, old
            head = head.replace(old, new)
        settle = heated("", f"2000., {REST!r}", TOP + 0.1, first="*STEP, INC=1000")
        path = write(folder / f"{deck.stem}.inp", ["*OPTIONS, ERRORS=NO"], head, heated(
            ", STEADY STATE", f"20., {TOP!r}", TOP, "*STABILITY, FREQUENCY=9"), settle)
        result = solve(path)
        found = stability_of(result)
        with h5py.File(result) as file:
            time, gain = file["history/time"][:], file["history/coupling_gain"][:]
            face = file["contact/FACE/slave_temperature"][:].mean(axis=1)
        late = (time > TOP + 2.5e5) & (time < TOP + 3.5e5)
        by_run = float(np.polyfit(time[late][1:], np.log(abs(np.diff(face[late]))), 1)[0])
        for k, at in enumerate(found["time"]):
            rate, modes = float(found["growth_rate"][k]), int(found["unstable_modes"][k])
            last = at == TOP
            good = modes == 0 and (not last or abs(by_run / rate - 1) < 1e-3)
            table.rows.append([name, f"{at:g}", float(gain[np.argmin(abs(time - at))]), str(modes),
                               f"{rate:.4e}", f"{-1 / rate:.0f}", f"{-1 / rate / CONSTANT:.3f}",
                               f"{by_run:.4e}" if last else "-", verdict(good)])
    return table


# Maps over load and conductance

KINDS = {  # number of states and, by ascending conductance, of the motions that grow of each
    (0,): ("one, lasts", style.SKY), (2,): ("one, oscillates ever more", style.VERMILION),
    (0, 1, 0): ("three, the middle one unstable", style.BLUE),
    (0, 1, 2): ("three, only the open one lasts", style.GREEN),
    (2, 1, 2): ("three, none lasts", style.BLACK)}
JOINTS = {
    "one rod expands": ((0.0, 12e-6), 1.2e-4, 1.0, np.linspace(400.0, 800.0, 17)),
    "rods that expand almost alike": ((11e-6, 12e-6), 5e-4, 4.0, np.linspace(435.0, 460.0, 21))}
TOUCHING = 10.0 ** np.linspace(1.0, 3.0, 13)   # conductance without gap and pressure
SPACE = 1e-5                                   # b of omega = a/(b + gap)


def joint(name, load, touch):
    """Return rods of a map, their law, capacities and states."""
    expansion, gap, ratio, _ = JOINTS[name]
    both = rods.Rods((0.1, 0.1), (20.0, 20.0), expansion, (2e11, 2e11), (float(load), 0.0), gap)
    law = float(touch) * SPACE, SPACE, float(touch), 1e-4
    return both, law, (ratio * CAPACITY, CAPACITY), rods.exact_solutions(both, *law)


def maps(folder, every=1):
    """Return the table of the maps, and of each joint the numbers of growing motions at each load,
    or every so many of them, and conductance."""
    table = Table("Maps over load and conductance", [
        "joint", *(words for words, _ in KINDS.values()), "states", "other conductance",
        "other number", "verdict"], text=f"""Two rods of R3 over the temperature of the hot end and the conductance omega0 of faces that just touch, omega = omega0 b/(b + gap) with b = {SPACE:g}, omega0 + 1e-4 p under pressure. In the first joint only the cold rod expands, across a gap of 1.2e-4; in the second the hot one expands by 11e-6 and the cold one by 12e-6, across 5e-4, and the hot one has four times the capacity.
The state is the only one, or there are three; two only on the curves between. Every state of the closed form is a run from there, which must stay ("other conductance": by more than 1e-4) and find as many growing motions as dense eigenvalues do ("other number"). Entries are numbers of points of the map.
In the first joint the answer is that of U': three states, and the middle one is left. In the second the only state oscillates ever more over a wide range, and of three states the open one lasts, or none.""")
    found = {}
    for name in JOINTS:
        points = list(product(JOINTS[name][3][::every], TOUCHING[::every]))
        decks, expected = [], {}
        for k, point in enumerate(points):
            both, law, capacities, states = joint(name, *point)
            for i, state in enumerate(states):
                path = write(folder / f"{len(found)}-{k}-{i}.inp", rod_deck(
                    both, law, capacities, state.conductance))
                decks.append(path.name)
                expected[path] = state.conductance, np.count_nonzero(
                    rod_modes.rates(both, capacities, state).real > 0.0)
        process = run("run", "--quiet", *decks, folder=folder, seconds=900)
        assert process.returncode == 0, process.stderr
        counts, elsewhere, others = {point: () for point in points}, 0, 0
        for path, (conductance, modes) in expected.items():
            result = path.with_suffix(".vtkhdf")
            with h5py.File(result) as file:
                at = file["contact/FACE/conductance"][-1]
            number = int(stability_of(result)["unstable_modes"][-1])
            elsewhere += bool(np.any(abs(at / conductance - 1) > 1e-4))
            others += number != modes
            counts[points[int(path.stem.split("-")[1])]] += (number,)
        found[name] = counts
        kinds = Counter(counts.values())
        known = kinds.keys() <= KINDS.keys()
        table.rows.append([name, *(str(kinds[kind]) for kind in KINDS), str(len(expected)),
                           str(elsewhere), str(others),
                           verdict(known and elsewhere == others == 0)])
    return table, found


# Pictures

def draw_motions(course, shown, path):
    """Draw the course of the state that oscillates, and the rates of the sliding face."""
    figure, (left, right) = subplots(1, 2, height=2.9)
    time, heat = course
    left.plot(time / 1000.0, heat / 1000.0, color=style.BLUE, linewidth=0.9)
    left.axhline(ALIKE.flux(ONLY.conductance) / 1000.0, color=style.BLACK, linewidth=0.6,
                 linestyle="--", label="steady state")
    left.set(xlabel="Time (1000 s)", ylabel="Heat flux (kW/m$^2$)")
    left.legend()
    style.panel_title(left, "The only state of two rods", "a")
    ratios = np.linspace(0.0, 4.0, 161)
    for m, (colour, line) in enumerate(zip(
            (style.BLUE, style.VERMILION, style.GREEN), ("-", "--", "-.")), 1):
        right.plot(ratios, [m**2 * burton(r / m)[0] for r in ratios], color=colour, linestyle=line,
                   linewidth=0.9, label=f"wave {m} m")
    right.plot(*zip(*shown), "o", color=style.BLACK, markersize=4, mfc="white",
               label="fastest found")
    right.axhline(0.0, color=style.BLACK, linewidth=0.6)
    right.set(xlabel="$V/V_\\mathrm{cr}$", ylabel="Rate ($\\kappa m^2$)", ylim=(-2.0, 7.0))
    right.legend()
    style.panel_title(right, "A sliding face", "b")
    save(figure, path)


def draw_maps(found, path):
    """Draw the maps of the joints."""
    figure, panels = subplots(1, 2, height=3.4)
    for axes, letter, (name, counts) in zip(panels, "ab", found.items()):
        for kind, (words, colour) in KINDS.items():
            at = [point for point, numbers in counts.items() if numbers == kind]
            filled = colour if len(kind) > 1 else "white"
            axes.plot(*(zip(*at) if at else ((), ())), "o" if kind[-1] < 2 else "s", color=colour,
                      mfc=filled, markersize=4, label=words)
        axes.set(xlabel="Temperature of the hot end", ylabel="Conductance of touching faces",
                 yscale="log")
        style.panel_title(axes, name.capitalize(), letter)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    save(figure, path)


def tables(folder):
    """Run the cases; return their tables and pictures."""
    only, course = oscillating(folder)
    sliding, shown = hot_spots(folder)
    joints, found = maps(folder)
    return [three_states(folder), only, sliding,
            Picture("motions.png", "A state that oscillates, and rates of a sliding face",
                    partial(draw_motions, course, shown)),
            cylinders(folder), joints,
            Picture("joint-maps.png", "States of two joints over load and conductance",
                    partial(draw_maps, found))]


def test_modes(tmp_path):
    """Of the maps a part, and the critical speed on one mesh."""
    check_rows([three_states(tmp_path), oscillating(tmp_path)[0],
                hot_spots(tmp_path, levels=(1,))[0], cylinders(tmp_path), maps(tmp_path, every=6)[0]])
