"""Increments in which nothing moves with the conductance, pairs that rest, heat that runs away."""

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from deck_runs import run, solve
from physics import material, mesh

YOUNG, POISSON, EXPANSION, CONDUCTIVITY, HOT = 2e5, 0.3, 1e-5, 50.0, 100.0
LAWS = {
    "up": ["*GAP LAW, TYPE=POWER", "10., 9., 1."],
    "down": ["*GAP LAW, TYPE=GAS", "1E-3, 1E-5", "*GAP LAW, TYPE=POWER", "10., 9., 1."],
    "none": ["*GAP LAW, TYPE=GAS", "1E-4, 1E-5", "*GAP LAW, TYPE=POWER", "10., 9., 1."],
}


def stack(law, divisions, interfaces, kind="CPE8"):
    """Return equal blocks on top of each other between rigid plates, the lowest one heated. By
    symmetry their mean temperature is HOT/2 whatever the face conducts, and only that presses;
    with several faces as long as they conduct alike, by C1 = 0."""
    columns = [k / divisions for k in range(divisions + 1)]
    cards, pairs, held = [], [], []
    for k in range(interfaces + 1):
        cards += mesh(f"B{k}", columns, [k + c for c in columns], kind, first=1 + 1000 * k)
        cards += material(f"B{k}", (YOUNG, POISSON), EXPANSION, CONDUCTIVITY)
        held += [f"B{k}.LEFT, 1"]
        if k:
            pairs += [f"*CONTACT PAIR, INTERACTION=FACES, NAME=F{k}", f"B{k}.BOTTOM, B{k - 1}.TOP"]
    top = f"B{interfaces}.TOP"
    return ["*OPTIONS, ERRORS=NO", *without_unused_surfaces(
        [*cards, "*SURFACE INTERACTION, NAME=FACES",
         *(card.replace("10., 9.", "10., 0.") if interfaces > 1 else card for card in LAWS[law]),
         *pairs]),
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", *[f"B{k}, 0." for k in range(interfaces + 1)],
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.",
        "*BOUNDARY", *held, "B0.BOTTOM, 2", f"{top}, 2",
        f"B0.BOTTOM, 11, 11, {HOT!r}", f"{top}, 11, 11, 0.", "*END STEP"]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("divisions", "interfaces", "kind"), [
    *((n, 1, "CPE8") for n in range(1, 9)), (1, 1, "CAX8"), (3, 1, "CAX8"), (1, 1, "CPE4"),
    (1, 1, "CPE6"), (2, 1, "CAX4"), (1, 2, "CPE8"), (2, 3, "CPE8"), (1, 4, "CAX8")])
def test_heated_stacks_press_by_their_mean_temperature(tmp_path, law, divisions, interfaces, kind):
    deck = write(tmp_path / "stack.inp", stack(law, divisions, interfaces, kind))
    # Free sides: the mean of the stress across them is 0, axisymmetry has none around the axis.
    pressure = YOUNG * EXPANSION * HOT / 2 / (1 - POISSON if kind.startswith("CPE") else 1)
    area = 1.0 if kind.startswith("CPE") else np.pi
    with h5py.File(solve(deck)) as file:
        heat = []
        for k in range(1, interfaces + 1):
            face = {name: file[f"contact/F{k}/{name}"][-1] for name in (
                "status", "gap", "normal_force", "pressure", "conductance", "heat_flux",
                "slave_temperature", "master_temperature", "heat_rate")}
            assert face["normal_force"] == pytest.approx(pressure * area, rel=1e-9)
            slope = 9 if interfaces == 1 else 0
            assert (face["status"] == 1).all()
            assert not face["gap"].any()
            np.testing.assert_allclose(
                face["conductance"], 10 + slope * face["pressure"], rtol=1e-7)
            jump = face["slave_temperature"] - face["master_temperature"]
            np.testing.assert_allclose(face["heat_flux"], face["conductance"] * jump, rtol=1e-7)
            heat.append(-face["heat_rate"])
        # Upwards the same through every face, and less than through blocks without any.
        np.testing.assert_allclose(heat, heat[0], rtol=1e-9)
        assert 0 < heat[0] < CONDUCTIVITY * HOT * area / (interfaces + 1)
        assert file["history/iterations"][:].max() <= 12


SHRINKS, GAS_A, GAS_B = 1e-4, 1e-2, 1e-3


def bars(method, flux):
    """Return two bars of length and conductivity 1, end to end. The upper one is heated where it
    is held, at its top, and shrinks as it warms: the heat opens the gap that it has to cross."""
    return ["*OPTIONS, ERRORS=NO", *without_unused_surfaces([
        *mesh("LOWER", [0.0, 0.1], [0.0, 1.0]), *material("LOWER", (1e4, 0.0), 0.0, 1.0),
        *mesh("UPPER", [0.0, 0.1], [1.0, 2.0], first=101),
        *material("UPPER", (1e4, 0.0), -SHRINKS, 1.0),
        "*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=GAS", f"{GAS_A!r}, {GAS_B!r}",
        "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "UPPER.BOTTOM, LOWER.TOP"]),
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "LOWER, 0.", "UPPER, 0.",
        f"*FIXED POINT, METHOD={method}, MAXITER=3000",
        "*STEP, INC=1000", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.125, 1., 1E-3",
        "*BOUNDARY", "LOWER, 1", "UPPER, 1", "LOWER.BOTTOM, 2", "UPPER.TOP, 2",
        "LOWER.BOTTOM, 11, 11, 0.", "*DFLUX", f"101, S3, {flux!r}", "*END STEP"]


def gap_of(flux):
    """Return the gap from gamma = SHRINKS (mean temperature of the upper bar)."""
    return SHRINKS * flux * (1.5 + GAS_B / GAS_A) / (1 - SHRINKS * flux / GAS_A)


@pytest.mark.parametrize("method", ["NEWTON", "ANDERSON", "ZAITSEV", "PICARD"])
def test_every_method_names_thermal_runaway_where_it_begins(tmp_path, method):
    limit = GAS_A / SHRINKS
    deck = write(tmp_path / "bars.inp", bars(method, 2 * limit))
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 2
    assert "thermal runaway in contact pair FACE" in process.stderr, process.stderr
    assert "NEWTON solves" not in process.stderr
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        time, gap = file["history/time"][:], file["contact/FACE/gap"][:]
        assert 0.48 < time[-1] < 0.5
        for t, values in zip(time, gap, strict=True):
            np.testing.assert_allclose(values, gap_of(2 * limit * t), rtol=1e-4)
        assert file["history/heat_imbalance"][:].max() < 1e-8


@pytest.mark.parametrize("method", ["NEWTON", "PICARD"])
def test_hot_bars_below_the_limit_are_solved(tmp_path, method):
    flux = 0.9 * GAS_A / SHRINKS
    with h5py.File(solve(write(tmp_path / "bars.inp", bars(method, flux)))) as file:
        np.testing.assert_allclose(file["contact/FACE/gap"][-1], gap_of(flux), rtol=1e-5)


def test_a_pair_without_weight_does_not_keep_the_others_from_converging(tmp_path):
    """Only the pair on the axis touches, and the law jumps there: it carries no heat."""
    cards = [
        *mesh("A", [0.0, 1.0], [0.0, 1.0], "CAX8"), *material("A", (1e4, 0.3), None, 1.0),
        *mesh("B", [0.0, 1.0], [1.0, 2.0], "CAX8", first=101,
              to=lambda x, y: (x, y + 5e-4 * x * x * (2 - y))),
        *material("B", (1e4, 0.3), None, 1.0),
        "*SURFACE INTERACTION, NAME=I", "*GAP LAW, TYPE=GAS", "0.01, 0.01",
        "*GAP LAW, TYPE=POWER", "3., 1., 1.", "*CONTACT PAIR, INTERACTION=I, NAME=P",
        "A.TOP, B.BOTTOM"]
    deck = write(tmp_path / "axis.inp", without_unused_surfaces(cards), [
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "A, 0.", "B, 0.",
        "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.",
        "*BOUNDARY", "A.BOTTOM, 2", "A.LEFT, 1", "B.LEFT, 1", "A.BOTTOM, 11, 11, 0.",
        "B.TOP, 11, 11, 100.", "*DLOAD", "101, P3, 0.01", "*END STEP"])
    with h5py.File(solve(deck)) as file:
        face = {name: file[f"contact/P/{name}"][-1] for name in ("status", "gap", "conductance")}
        assert file["history/iterations"][-1] <= 5
    assert face["status"].tolist() == [1, 0, 0]
    np.testing.assert_allclose(face["conductance"][1:], 0.01 / (0.01 + face["gap"][1:]), rtol=1e-7)
    # A parabola that ends at the next node, at half the radius, carries the load on the whole area.
    assert face["conductance"][0] == pytest.approx(3.0 + 2 * 0.01 / 0.5**2, rel=1e-6)


@pytest.mark.parametrize("method", ["NEWTON", "ZAITSEV", "PICARD", "ANDERSON"])
def test_any_number_of_iterations_may_be_allowed(tmp_path, method):
    """The largest one that a deck can give changes nothing where a few are enough."""
    cards = stack("none", 2, 1)
    for limit in ("50", "2147483647"):
        at = cards.index("*STEP")
        deck = write(tmp_path / f"limit{limit}.inp", cards[:at], [
            f"*FIXED POINT, METHOD={method}, MAXITER={limit}"], cards[at:])
        with h5py.File(solve(deck)) as file:
            force = file["contact/F1/normal_force"][-1]
        assert force == pytest.approx(YOUNG * EXPANSION * HOT / 2 / (1 - POISSON), rel=1e-9)
