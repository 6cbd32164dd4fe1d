"""Thermal schemes at constant conductance, and analyses one after the other."""

import pytest
from physics import follows, judge, material, mesh, nodes_of

import conduction
from deck_runs import run

XS = [0.0, 0.4, 1.0]
YOUNG, EXPANSION, OMEGA, HOT, K = 1000.0, 1e-4, 0.7, 80.0, 2.0
GAP = 0.01
BODIES = [*mesh("UPPER", XS, [GAP, GAP + 0.2, GAP + 0.5]),
          *mesh("LOWER", XS, [-1.0, -0.4, 0.0], first=101)]


def model(*cards, expansion=0.0, start=0.0, law=()):
    """Return two blocks with a gap and a conductance that nothing changes (1e9 to the gap)."""
    law = law or ("*GAP LAW, TYPE=GAS", f"{OMEGA * 1e9!r}, 1e9", "*GAP LAW, TYPE=POWER",
                  f"{OMEGA!r}, 0., 1.")
    deck = list(BODIES)
    for name in ("UPPER", "LOWER"):
        deck += material(name, (YOUNG, 0.0), expansion if name == "UPPER" else None, K)
    return [*deck, "*SURFACE INTERACTION, NAME=FACES", *law,
            "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "UPPER.BOTTOM, LOWER.TOP",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"UPPER, {start!r}", f"LOWER, {start!r}",
            "UPPER.TOP, 0.", "LOWER.BOTTOM, 0.", *cards]


ENDS = ["*BOUNDARY", "UPPER.TOP, 2", "LOWER.BOTTOM, 2", "UPPER, 1", "LOWER, 1"]


def step(analysis, *cards, times="1., 1."):
    """Return a step of an analysis."""
    name = {"heat": "*HEAT TRANSFER, STEADY STATE", "static": "*STATIC",
            "coupled": "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE"}[analysis]
    return ["*STEP", name, times, *cards, "*END STEP"]


SCHEMES = ["IMPLICIT", "GALERKIN", "CRANK-NICOLSON", "EXPLICIT"]


def amplified(scheme, analysis):
    """Return a deck that starts with an error of 10 at every node but the ends, held at 0, and the
    error after each of four increments: a power of the factor of eq. (3.4)."""
    factor = conduction.amplification(scheme)
    deck = model(f"*THERMAL SCHEME, TYPE={scheme}", *ENDS, *step(
        analysis, "*BOUNDARY", "UPPER.TOP, 11", "LOWER.BOTTOM, 11", times="0.25, 1."), start=10.0)
    rows = [("NT", body, 0.25 * n, 10.0 * factor**n, 1e-7, "ABS")
            for n in range(1, 5) for body in (free("UPPER", "TOP"), free("LOWER", "BOTTOM"))]
    return [*deck[: deck.index("*STEP")], *sets(), *deck[deck.index("*STEP"):]], rows


def free(body, side):
    """Return the name of the set of the nodes of a body that are not on a side."""
    return f"{body}.BUT.{side}"


def sets():
    """Return the cards of the sets of nodes whose temperature is free."""
    nodes, cards = nodes_of(BODIES), []
    for body, side, first, y in (("UPPER", "TOP", 0, GAP + 0.5), ("LOWER", "BOTTOM", 101, -1.0)):
        cards += [f"*NSET, NSET={free(body, side)}"]
        cards += [str(n) for n, p in nodes.items() if (n >= 101) == (first == 101) and p[1] != y]
    return cards


@pytest.mark.parametrize("analysis", ["heat", "coupled"])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_error_of_the_start_at_constant_conductance(tmp_path, scheme, analysis):
    judge(tmp_path, *amplified(scheme, analysis))


@pytest.mark.changes("THERMAL SCHEME, TYPE")
def test_scheme_of_the_card_is_the_one_that_runs(tmp_path):
    follows(tmp_path, lambda scheme: amplified(scheme, "coupled"), "GALERKIN", "IMPLICIT")


@pytest.mark.parametrize("scheme", SCHEMES)
def test_every_scheme_follows_a_ramp_from_equilibrium_exactly(tmp_path, scheme):
    """At constant conductance T is linear in time, which all of them have."""
    flux, faces = conduction.wall([0.5, 1.0], [K, K], HOT, 0.0, contacts=[OMEGA])
    rows = []
    for part in (0.25, 0.5, 1.0):
        rows += [("slave_temperature", "FACE", part, part * faces[1], 1e-8),
                 ("master_temperature", "FACE", part, part * faces[2], 1e-8),
                 ("heat_flux", "FACE", part, part * flux, 1e-8)]
    judge(tmp_path, model(f"*THERMAL SCHEME, TYPE={scheme}", *ENDS, *step(
        "coupled", "*BOUNDARY", f"UPPER.TOP, 11, 11, {HOT}", "LOWER.BOTTOM, 11", times="0.25, 1.")),
        rows)


def test_sources_of_a_step_without_heat_are_of_the_past_of_the_next_one(tmp_path):
    """A flux of 10, 30 and 20 at the ends of three steps, the second without heat: under
    CRANK-NICOLSON, with K (T_i + T_i+1) = Q_i + Q_i+1, the third ends at (20 + 30 - 10)/K."""
    conductance = 4.0
    flux = ["*DFLUX, AMPLITUDE=COURSE", "1, S2, 1."]
    deck = [*mesh("BAR", [0.0, 1.0], [0.0, 1.0], "CPE4"),
            *material("BAR", (YOUNG, 0.0), conductivity=conductance),
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BAR, 0.", "*THERMAL SCHEME, TYPE=CRANK-NICOLSON",
            "*AMPLITUDE, NAME=COURSE, TIME=TOTAL TIME", "0., 0., 1., 10., 2., 30., 3., 20.",
            "*BOUNDARY", "BAR, 1, 2", "BAR.LEFT, 11, 11, 0.",
            *step("heat", *flux), *step("static"), *step("heat")]
    judge(tmp_path, deck, [("NT", "BAR.RIGHT", time, value, 1e-12)
                           for time, value in ((1, 10 / 4), (2, 10 / 4), (3, 40 / 4))])


HEATED = ["*BOUNDARY", f"UPPER.TOP, 11, 11, {HOT}", "LOWER.BOTTOM, 11"]
GAS = ("*GAP LAW, TYPE=GAS", "0.01, 0.02")


def grown(flux):
    """Return the expansion of the upper block towards the lower one."""
    return EXPANSION * 0.5 * (HOT - flux * 0.5 / (2 * K))


def test_heat_then_mechanics(tmp_path):
    """The first step keeps the initial gap; the second keeps the temperatures and moves the gap."""
    flux, faces = conduction.wall([0.5, 1.0], [K, K], HOT, 0.0, contacts=[0.01 / (0.02 + GAP)])
    deck = model(*ENDS, *step("heat", *HEATED), *step("static"), expansion=EXPANSION, law=GAS)
    judge(tmp_path, deck, [
        ("heat_flux", "FACE", 1.0, flux, 1e-9), ("gap", "FACE", 1.0, GAP, 1e-9),
        ("conductance", "FACE", 1.0, 0.01 / (0.02 + GAP), 1e-9),
        ("slave_temperature", "FACE", 2.0, faces[1], 1e-9), ("NT", "UPPER.TOP", 2.0, HOT, 1e-12),
        ("gap", "FACE", 2.0, GAP - grown(flux), 1e-9), ("U2", "LOWER", 2.0, 0.0, 1e-14, "ABS")])


def test_mechanics_then_heat(tmp_path):
    """The heat of the second step crosses the gap that the first one left, and moves nothing."""
    nearer = 0.004
    deck = model(*ENDS, *step("static", "*BOUNDARY", f"UPPER.TOP, 2, 2, {-nearer}"),
                 *step("heat", *HEATED), expansion=EXPANSION, law=GAS)
    omega = 0.01 / (0.02 + GAP - nearer)
    flux, _ = conduction.wall([0.5, 1.0], [K, K], HOT, 0.0, contacts=[omega])
    judge(tmp_path, deck, [("gap", "FACE", 2.0, GAP - nearer, 1e-9), ("conductance", "FACE", 2.0,
                           omega, 1e-9), ("heat_flux", "FACE", 2.0, flux, 1e-9)])


def test_coupled_after_heat_is_coupled_alone(tmp_path):
    """The steady state does not depend on the way to it while the gap stays open."""
    flux = 0.0
    for _ in range(200):
        gap = GAP - grown(flux)
        flux, _ = conduction.wall([0.5, 1.0], [K, K], HOT, 0.0, contacts=[0.01 / (0.02 + gap)])
    rows = [("gap", "FACE", "LAST", gap, 1e-6), ("heat_flux", "FACE", "LAST", flux, 1e-6)]
    assert 0.0 < gap < GAP
    judge(tmp_path, model(*ENDS, *step("coupled", *HEATED), expansion=EXPANSION, law=GAS), rows,
          name="alone")
    judge(tmp_path, model(*ENDS, *step("heat", *HEATED), *step("coupled"), expansion=EXPANSION,
                          law=GAS), rows, name="after")


def test_initial_gap_holds_in_a_deck_without_mechanics(tmp_path):
    def make(a):
        flux, _ = conduction.wall([0.5, 1.0], [K, K], HOT, 0.0, contacts=[a / (0.02 + GAP)])
        return model(*step("heat", *HEATED), law=("*GAP LAW, TYPE=GAS", f"{a!r}, 0.02")), [
            ("heat_flux", "FACE", "LAST", flux, 1e-9), ("gap", "FACE", "LAST", GAP, 1e-12),
            ("pressure", "FACE", "LAST", 0.0, 0.0, "ABS")]

    follows(tmp_path, make, 0.01, 0.012)


@pytest.mark.parametrize(("scheme", "warned"), [("CRANK-NICOLSON", True), ("IMPLICIT", False)])
def test_start_out_of_equilibrium_is_warned_of_by_crank_nicolson(tmp_path, scheme, warned):
    deck, checks = amplified(scheme, "coupled")
    judge(tmp_path, deck, checks, name=scheme)
    process = run("run", tmp_path / f"{scheme}.inp", "--out", tmp_path)
    assert ("CRANK-NICOLSON" in process.stderr and "warning" in process.stderr) == warned
