"""Generalized plane strain: bars, rings and press fits with ends that are free or turn."""

from math import cos, log, radians, sin

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from changes import note_changes
from deck_runs import CYLINDER, solve
from free_ends import (HEIGHT, KINDS, MODULUS, STRAIN, THICK, WIDTH, bar, bent, corner, forces,
                       general, hot_ring)
from inelastic import A, N, YOUNG, law, step
from pellets import rod
from physics import follows, judge, material, mesh
from test_inelastic import balances
from test_restart import assert_same, go_on

import lame


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("is_loaded", [True, False], ids=["loaded", "given"])
def test_a_bar_bends_about_both_axes(tmp_path, kind, is_loaded):
    """N = E A e, M = E I kappa about any reference node; the section deforms freely."""
    judge(tmp_path, *bent(STRAIN, (0.7, -1.2), kind, is_loaded))


@pytest.mark.changes("SOLID SECTION, REF NODE")
def test_moments_and_strains_are_those_at_the_reference_node(tmp_path):
    follows(tmp_path, lambda x: bent(STRAIN, (x, 0.0), "CPEG8", True), 0.0, 3.0)
    note_changes(bar(place=(0.0, 0.0)), [card.replace("REF NODE=900", "REF NODE=901")
                                         for card in bar(place=(0.0, 0.0))])


@pytest.mark.parametrize("options", [["*OPTIONS, ERRORS=FULL"], ["*REFINE, LEVELS=1"],
                                     ["*REFINE, LEVELS=1, SURFACE=BODY.RIGHT"],
                                     ["*OPTIONS, ERRORS=FULL", "*SOLVER, TYPE=MUMPS"],
                                     ["*OPTIONS, PLANE=STRESS"]])
def test_a_bar_bends_on_divided_meshes_and_by_both_solvers(tmp_path, options):
    cards, checks = bent(STRAIN, (0.7, -1.2), "CPEG8R", True)
    judge(tmp_path, [*options, *cards], checks)


def test_a_bar_of_corners_alone_is_pulled(tmp_path):
    force, about_x, about_y = forces((1e-3, 0.0, 0.0), (0.7, -1.2))
    judge(tmp_path, ["*OPTIONS, ORDER=1", *bar("CPEG8", (0.7, -1.2)), *step(
        "*STATIC", "1., 1.", "*CLOAD", f"900, 3, {force!r}", f"900, 4, {about_x!r}",
        f"900, 5, {about_y!r}")],
        [("U3", "900", "LAST", 1e-3 * THICK, 1e-9), ("S33", "MAX", "LAST", 1.0, 1e-9),
         ("UR1", "900", "LAST", 0.0, 1e-12, "ABS")])


@pytest.mark.parametrize("kind", ["CPEG4", "CPEG3"])
def test_bars_of_linear_elements_converge_to_the_bending_stiffness(tmp_path, kind):
    errors = []
    for count in (8, 16):
        deck = write(tmp_path / f"{count}.inp", [*bar(kind, counts=(count, count)), *step(
            "*STATIC", "1., 1.", "*CLOAD", f"900, 4, {forces(STRAIN, (0, 0))[1]!r}")])
        with h5py.File(solve(deck)) as file:
            errors.append(abs(file["history/UR1"][-1] / (THICK * STRAIN[1]) - 1))
    assert errors[1] < 0.01 and errors[0] / errors[1] > 2**1.8


def test_bodies_with_one_reference_node_have_one_strain(tmp_path):
    """Two bars of different expansion: e = sum(E A alpha T)/sum(E A), and the stress of the rest."""
    young, growth, areas = (1000.0, 3000.0), (1e-5, 3e-5), (2.0, 3.0)
    cards, held = ["*NODE", "900, 5., 5."], []
    for k, (name, width) in enumerate((("ONE", 2.0), ("TWO", 3.0))):
        start = 10.0 * k
        body = mesh(name, [start, start + width], [0.0, 1.0], "CPEG8", first=100 * k + 1)
        given = material(name, (young[k], 0.3), growth[k])
        cards += [*body, *given[:-1], given[-1] + ", REF NODE=900", f"{THICK}"]
        held += [f"{corner(body, start, 0)}, 1, 2", f"{corner(body, start + width, 0)}, 2"]
    warmth = 100.0
    mean = (sum(e * a * g for e, a, g in zip(young, areas, growth, strict=True)) * warmth
            / sum(e * a for e, a in zip(young, areas, strict=True)))
    judge(tmp_path, [*cards, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ONE, 0.", "TWO, 0.",
                     "*BOUNDARY", *held, "900, 4, 5", *step(
                         "*STATIC", "1., 1.", "*TEMPERATURE", f"ONE, {warmth}", f"TWO, {warmth}")],
          [("U3", "900", "LAST", THICK * mean, 1e-9), ("RF3", "900", "LAST", 0.0, 1e-9, "ABS"),
           *(("S33", name, "LAST", young[k] * (mean - growth[k] * warmth), 1e-9)
             for k, name in enumerate(("ONE", "TWO")))])


def test_one_of_two_bodies_with_one_strain_yields(tmp_path):
    """N = Y A of the one that yields, and E A e of the other."""
    limit, strain, cards, held = 2.0, 5e-3, ["*NODE", "900, 5., 5."], []
    for k, (name, laws) in enumerate((("ONE", ["*PLASTIC", f"{limit}"]), ("TWO", []))):
        body = mesh(name, [10.0 * k, 10.0 * k + 1.0, 10.0 * k + 2.0], [0.0, 1.0], "CPEG8R",
                    first=100 * k + 1)
        given = law(*laws, elastic=(MODULUS, 0.3), name=name)
        cards += [*body, *given[:-1], given[-1] + ", REF NODE=900", f"{THICK}"]
        held += [f"{corner(body, 10 * k, 0)}, 1, 2", f"{corner(body, 10 * k + 2, 0)}, 2"]
    judge(tmp_path, [*cards, "*BOUNDARY", *held, *step(
        "*STATIC", "0.25, 1.", "*BOUNDARY", f"900, 3, 3, {strain * THICK!r}", "900, 4, 5")],
          [("RF3", "900", "LAST", 2.0 * (limit + MODULUS * strain), 1e-8),
           ("S33", "ONE", "LAST", limit, 1e-8), ("S33", "TWO", "LAST", MODULUS * strain, 1e-8)])


@pytest.mark.parametrize("kind", ["CAX4", "mortar", "transient"])
def test_a_sparse_tail_has_the_strains_of_all_bodies(tmp_path, kind):
    """A stack of three plates beside a wall, each with a reference node, with friction and heat."""
    found = []
    for tail in ("FULL", "SPARSE"):
        cards, number = [], 900000
        for card in rod(3, tail, kind):
            if card.startswith("*SOLID SECTION"):
                number += 1
                cards = ["*NODE", f"{number}, 2., 5.", *cards]
                card += f", REF NODE={number}"
            cards += ["TUBE.RIGHT, 1"] if card == "TUBE.BOTTOM, 2" else []
            cards.append(card.replace("TYPE=CAX", "TYPE=CPEG").replace("1E-12", "1E-10"))
        with h5py.File(solve(write(tmp_path / f"{tail}.inp", cards))) as file:
            found.append([file[f"history/{name}"][-1] for name in ("U3", "UR1", "UR2")]
                         + [file[f"contact/{name}/pressure"][-1] for name in ("W0", "W1", "E1")])
    for full, sparse in zip(*found, strict=True):
        assert sparse == pytest.approx(full, abs=1e-9 * np.max(np.abs(full)))


def test_a_bar_yields_under_a_force_along_z(tmp_path):
    """Strain s/E + (s - Y)/H under a stress s; the latter stays. U3 is held in the third step."""
    stress, limit, hardening = 4.0, 2.0, 50.0
    plastic = (stress - limit) / hardening
    cards = [*mesh("BODY", [-2.0, 0.0, 2.0], [-1.0, 0.0, 1.0], "CPEG4I"),
             *general(law("*PLASTIC", f"{limit}, 0.", f"{limit + hardening}, 1.",
                          elastic=(MODULUS, 0.3))), "*BOUNDARY", "1, 1, 2", "BODY.BOTTOM, 2"]
    force = stress * WIDTH * HEIGHT
    judge(tmp_path, ["*OPTIONS, ERRORS=FULL", *cards,
                     *step("*STATIC", "0.25, 1.", "*CLOAD", f"900, 3, {force!r}"),
                     *step("*STATIC", "0.5, 1.", "*CLOAD", "900, 3, 0."),
                     *step("*STATIC", "0.5, 1.", "*BOUNDARY, FIXED", "900, 3, 3", "*CLOAD, OP=NEW")],
          [("U3", "900", "1.", THICK * (stress / MODULUS + plastic), 1e-6),
           ("UR2", "900", "1.", 0.0, 1e-9, "ABS"), ("PE33", "BODY", "1.", plastic, 1e-6),
           ("U3", "900", "2.", THICK * plastic, 1e-6), ("U3", "900", "LAST", THICK * plastic, 1e-6),
           ("RF3", "900", "LAST", 0.0, 1e-5, "ABS")])


def test_work_along_z_is_stored_or_dissipated(tmp_path):
    def make(n):
        return [*mesh("BODY", [1.0, 1.5, 2.0], [0.0, 0.4, 1.0], "CPEG4I", skew=0.05),
                *general(law("*PLASTIC", "200., 0.", "300., 0.02", "*CREEP", f"{A!r}, {N!r}")),
                "*BOUNDARY", "BODY.BOTTOM, 2", "BODY.LEFT, 1",
                *step("*STATIC, DIRECT", f"{1 / n!r}, 1.", "*CLOAD", "900, 3, 250.",
                      "900, 4, 130.", "900, 5, -380."),
                *step("*STATIC, DIRECT", f"{1 / n!r}, 1.", "*CLOAD", "900, 3, 150.", "900, 4, 75.",
                      "900, 5, -225."),
                *step("*VISCO, DIRECT", f"{10 / n!r}, 10.")]

    balances(tmp_path, make)


def test_a_bar_yields_as_it_bends(tmp_path):
    """M = Y W h^2/4 (1 - (k_e/k)^2/3) of perfect plasticity: with nu near 1/2 the section is free
    of stress in its plane. The outermost points carry the yield stress."""
    limit, rows = 2.0, 16
    first = limit / MODULUS / (HEIGHT / 2)
    body = mesh("BODY", [-2.0, 0.0, 2.0], [float(y) for y in np.linspace(-1.0, 1.0, rows + 1)],
                "CPEG8R")
    moment = limit * WIDTH * HEIGHT**2 / 4 * (1 - (1 / 2.0) ** 2 / 3)
    judge(tmp_path, [*body, *general(law("*PLASTIC", f"{limit}", elastic=(MODULUS, 0.499))),
                     "*BOUNDARY", f"{corner(body, -2, -1)}, 1, 2", f"{corner(body, 2, -1)}, 2",
                     *step("*STATIC", "0.1, 1.", "*BOUNDARY",
                           f"900, 4, 4, {2.0 * first * THICK!r}")],
          [("RM1", "900", "LAST", moment, 2e-3), ("RF3", "900", "LAST", 0.0, 1e-6, "ABS")])


def test_a_bar_creeps_under_a_force_along_z(tmp_path):
    stress, time = 100.0, 100.0
    cards = [*mesh("BODY", [-2.0, 2.0], [-1.0, 1.0], "CPEG8"),
             *general(law("*CREEP", f"{A!r}, {N!r}")), "*BOUNDARY", "1, 1, 2", "BODY.BOTTOM, 2"]
    load = ["*CLOAD", f"900, 3, {stress * WIDTH * HEIGHT!r}"]
    judge(tmp_path, [*cards, *step("*STATIC", "1., 1.", *load), *step("*VISCO", f"1., {time}")],
          [("U3", "900", "LAST", THICK * (stress / YOUNG + A * stress**N * time), 1e-8),
           ("CE33", "BODY", "LAST", A * stress**N * time, 1e-8),
           ("CE11", "BODY", "LAST", -A * stress**N * time / 2, 1e-8)])


def test_a_force_along_z_cools_a_bar(tmp_path):
    """-T0 alpha s/(rho c) of a stress s that acts at once."""
    start, stress, growth, capacity = 300.0, 2.0, 1e-5, 4.0
    cards = [*bar("CPEG4I", expansion=growth, conductivity=1.0, density=2.0, specific_heat=2.0)]
    judge(tmp_path, ["*PHYSICAL CONSTANTS, ABSOLUTE ZERO=0.", *cards,
                     "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"BODY, {start}",
                     *step("*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT, DILATATION=YES", "1., 1.",
                           "*CLOAD", f"900, 3, {stress * WIDTH * HEIGHT!r}")],
          [("NT", "BODY", "LAST", start - start * growth * stress / capacity, 1e-12)])


@pytest.mark.parametrize("kind", ["CPEG8R", "CPEG8", "CPEG6"])
def test_a_hot_ring_has_no_force_along_z(tmp_path, kind):
    cards, known = hot_ring(32, kind)
    (node, grown), bore, outside = known.values()
    judge(tmp_path, without_unused_surfaces(cards), [
        ("U3", node, "LAST", grown, 2e-6), ("RF3", node, "LAST", 0.0, 1e-9, "ABS"),
        ("UR1", node, "LAST", 0.0, 1e-12, "ABS"), ("UR2", node, "LAST", 0.0, 1e-12, "ABS"),
        ("S33", bore[0], "LAST", bore[1], 0.02), ("S33", outside[0], "LAST", outside[1], 0.02)])


RADII = 20.0, 50.0, 100.0


def tubes(turn=10.0, elements=10, lengths=(2.0, 2.0)):
    """Return a sector of two tubes, each with a reference node of its own, closed by heat."""
    def to(r, t):
        return r * cos(radians(t)), r * sin(radians(t))

    cards, growth = [], {"IN": 2e-5, "OUT": 1e-5}
    for k, name in enumerate(growth):
        body = mesh(name, [float(r) for r in np.linspace(*RADII[k:k + 2], elements + 1)],
                    [0.0, turn / 2, turn], "CPEG8R", first=1000 * k + 1, to=to)
        cards += [*body, *general(material(name, (YOUNG, 0.3), growth[name], 40.0), 9000 + k,
                                  thickness=lengths[k])]
    axes = f"{cos(radians(turn))!r}, {sin(radians(turn))!r}, 0., {-sin(radians(turn))!r}, " \
           f"{cos(radians(turn))!r}, 0."
    return [*cards, "*NSET, NSET=HIGH", "IN.TOP, OUT.TOP", "*TRANSFORM, NSET=HIGH", axes,
            "*SURFACE INTERACTION, NAME=JOINT", "*GAP CONDUCTANCE", "0.5, 0.", "0.5, 1000.",
            "*GAP CONDUCTANCE, PRESSURE", "0.5, 0.", "0.5, 1000.",
            "*CONTACT PAIR, INTERACTION=JOINT, NAME=FIT", "IN.RIGHT, OUT.LEFT",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "IN, 0.", "OUT, 0.",
            "*BOUNDARY", "IN.BOTTOM, 2", "OUT.BOTTOM, 2", "HIGH, 2", "9000, 4, 5", "9001, 4, 5"]


def test_hot_tubes_with_free_ends_press_on_each_other(tmp_path):
    """Tubes that are free along z grow by their mean temperatures; the pressure is Lame's of free
    ends. Heat flows through both and the joint."""
    inside, outside, turn, (a, b, c) = 200.0, 20.0, 10.0, RADII
    rate = (inside - outside) / (log(b / a) / 40.0 + 1 / (0.5 * b) + log(c / b) / 40.0)
    faces = inside - rate * log(b / a) / 40.0, outside + rate * log(c / b) / 40.0

    def mean(inner, outer, hot, cold):
        slope = (cold - hot) / log(outer / inner)
        return cold - slope / 2 + slope * inner**2 * log(outer / inner) / (outer**2 - inner**2)

    means = mean(a, b, inside, faces[0]), mean(b, c, faces[1], outside)
    overlap = (2e-5 * means[0] - 1e-5 * means[1]) * b
    pressure = lame.press_fit(a, b, c, (YOUNG, 0.3), (YOUNG, 0.3), overlap, "stress")
    squeeze = [lame.cylinder(a, a, b, 0.0, pressure), lame.cylinder(b, b, c, pressure)]
    grown = [2.0 * (growth * warm - 0.3 * float(np.sum(stress)) / YOUNG)
             for growth, warm, stress in zip((2e-5, 1e-5), means, squeeze, strict=True)]
    judge(tmp_path, without_unused_surfaces(
        [*tubes(), *step("*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
                         f"IN.LEFT, 11, 11, {inside}", f"OUT.RIGHT, 11, 11, {outside}")]),
        [("normal_force", "FIT", "LAST", pressure * b * radians(turn) * 2.0, 2e-4),
         ("heat_rate", "FIT", "LAST", rate * radians(turn) * 2.0, 1e-4),
         ("U3", "9000", "LAST", grown[0], 2e-4), ("U3", "9001", "LAST", grown[1], 2e-4),
         ("RF3", "9000", "LAST", 0.0, 1e-8, "ABS"), ("RF3", "9001", "LAST", 0.0, 1e-8, "ABS")])


def held(text):
    """Return a deck of CPE elements with CPEG in their place, whose ends are held."""
    sections = text.count("*SOLID SECTION")
    nodes = [f"{900001 + k}, {3.0 * k}, 1." for k in range(sections)]
    for k in range(sections):
        text = text.replace("*SOLID SECTION,", f"*SOLID  SECTION, REF NODE={900001 + k},", 1)
    text = text.replace("TYPE=CPE", "TYPE=CPEG").replace("*SOLID  SECTION", "*SOLID SECTION")
    first = text.index("*MATERIAL")
    text = text[:first] + "\n".join(["*NODE", *nodes, ""]) + text[first:]
    first = text.index("*STEP")
    supports = ["*BOUNDARY", *(f"{900001 + k}, ZSYMM" for k in range(sections)), ""]
    return text[:first] + "\n".join(supports) + text[first:]


def test_held_ends_are_plane_strain(tmp_path):
    """The published cylinder, with friction and heat."""
    found = []
    for name, change in (("plain", str), ("held", held)):
        deck = tmp_path / f"{name}.inp"
        deck.write_text(change(CYLINDER.read_text()))
        with h5py.File(solve(deck)) as file:
            found.append([file["contact"][next(iter(file["contact"]))][what][-1]
                          for what in ("pressure", "shear", "heat_flux")])
    for plain, general_one in zip(*found, strict=True):
        assert general_one == pytest.approx(plain, abs=1e-8 * np.max(np.abs(plain)))


def creeping(options=(), more=()):
    """Return a press fit of tubes whose ends are free, and its creep."""
    cards = tubes(elements=4)
    at = cards.index("*MATERIAL, NAME=OUT")
    cards[at + 1:at + 1] = ["*CREEP", f"{A!r}, {N!r}"]
    return [*options, *cards, "*CLEARANCE, SLAVE=IN.RIGHT, MASTER=OUT.LEFT, VALUE=-0.05", *more,
            *step("*STATIC", "1., 1."), *step("*VISCO, CETOL=1e-4", "0.1, 100.")]


def test_a_run_that_goes_on_is_the_same(tmp_path):
    deck = write(tmp_path / "deck.inp", without_unused_surfaces(
        creeping(["*OPTIONS, ERRORS=FULL"], ["*RESTART, WRITE, FREQUENCY=5"])))
    whole = solve(deck)
    (folder := tmp_path / "later").mkdir()
    assert_same(whole, go_on(deck, whole, folder, 1.0), but="restart")


def test_uncertainties_change_nothing_and_contain_finer_runs(tmp_path):
    """ERRORS=FULL, which divides all elements and halves the increments."""
    found = {}
    for errors, levels in (("NO", 0), ("FULL", 0), ("NO", 2)):
        deck = write(tmp_path / f"{errors}{levels}.inp", without_unused_surfaces(creeping(
            [f"*OPTIONS, ERRORS={errors}"], [f"*REFINE, LEVELS={levels}"] if levels else [])))
        with h5py.File(solve(deck)) as file:
            found[errors, levels] = (file["contact/FIT/normal_force"][-1],
                                     file["history/U3"][-1].copy())
            if errors == "FULL":
                bound = file["uncertainty/FIT/normal_force"][-1, 1]
    assert found["NO", 0][0] == found["FULL", 0][0]
    np.testing.assert_array_equal(found["NO", 0][1], found["FULL", 0][1])
    assert abs(found["NO", 0][0] - found["NO", 2][0]) < bound
