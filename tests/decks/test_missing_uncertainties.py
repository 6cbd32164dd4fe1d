"""Numbers without a numerical uncertainty: which they are, and the reason that is told."""

import re

import h5py
import numpy as np
import pytest
from blocks import without_unused_surfaces, write
from deck_runs import INPUT, copy_deck, run
from physics import material, mesh

RODS, FLANGE = (INPUT / "examples" / f"{name}.inp" for name in ("two_rods", "bolted_flange"))
STEADY = "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT"
CONDUCTIVITY = "*CONDUCTIVITY\n0.2\n"
PATH = "path; ERRORS=FULL"
DECKS = {  # what there is -> reason, deck, cards and changes
    "pre-tension": (PATH, FLANGE, (), {}),
    "branches": ("branches", RODS, (), {"*END STEP": "*CONTINUATION, POINTS=10\n*END STEP"}),
    "stored heat": (PATH, RODS, (), {
        CONDUCTIVITY: f"{CONDUCTIVITY}*DENSITY\n1.\n*SPECIFIC HEAT\n3.6\n",
        STEADY: "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT"}),
    "tables over temperature": (PATH, RODS, (), {
        CONDUCTIVITY: "*CONDUCTIVITY\n0.2, 0.\n0.2001, 500.\n"}),
    "nothing wanted": ("ERRORS=NO", RODS, ["*OPTIONS, ERRORS=NO"], {})}
QUANTITY = re.compile(r"^    ((?:normal|shear) force|heat rate|peak pressure|edge of \w+)  +\S+(.*)$",
                      re.MULTILINE)


def solved(folder, name, *options):
    """Solve a deck with checks; return its result and output."""
    _, source, cards, changes = DECKS[name]
    for mesh in source.parent.glob(f"{source.stem}.mesh"):
        (folder / mesh.name).write_text(mesh.read_text())
    (folder / "plain.txt").write_text(source.read_text().split("*VERIFY")[0])
    deck = copy_deck(folder / "plain.txt", folder / "deck.inp", cards, changes)
    with deck.open("a") as file:
        file.write("*VERIFY, KIND=FIGURE\npressure, MAX, LAST, 0., 1.E9, ABS\n"
                   "NT, MAX, LAST, 0., 1.E9, ABS\nU1, MAX, LAST, 0., 1.E9, ABS\n")
    process = run("run", deck, "--out", folder, *options)
    assert process.returncode == 0, process.stderr
    return deck.with_suffix(".vtkhdf"), process.stdout


def is_no_number(name, words):
    """Return whether an edge is one of the face, or none."""
    return name.startswith("edge") and re.search(r"whole face|end of the face|\(open\)", words)


@pytest.mark.parametrize("name", DECKS)
def test_every_number_says_why_it_has_no_uncertainty(tmp_path, name):
    """In summary, listing, result file and at the checks."""
    reason = DECKS[name][0]
    result, printed = solved(tmp_path, name)
    listing, mark = result.with_suffix(".lst").read_text(), f" (no estimate: {reason})"
    told = QUANTITY.findall(printed)
    assert {"normal force", "heat rate", "peak pressure"} <= {name for name, _ in told}
    for quantity, words in told:
        assert is_no_number(quantity, words) or words.startswith(mark), (quantity, words)
    assert "+-" not in printed and "NUMERICAL UNCERTAINTY" not in listing
    assert listing.count(mark) >= printed.count(mark)
    # All checks are of numbers of this kind.
    assert len(re.findall(rf"found:  \S+{re.escape(mark)}\n", listing)) == 3
    with h5py.File(result) as file:
        steps, words = file["uncertainty"], file["uncertainty/reasons"].asstr()[:]
        for name in (name for name in steps if isinstance(steps[name], h5py.Group)):
            why = steps[name]["no_estimate"]
            for quantity, column in zip(why.attrs["components"].split(), why[:].T, strict=True):
                rows = steps[name][quantity][:]
                assert np.isnan(rows[:, 1:]).all()
                told = words[column]
                np.testing.assert_array_equal(told, np.where(np.isnan(rows[:, 0]), "", reason))


@pytest.mark.parametrize("name", [name for name in DECKS if DECKS[name][0] == PATH])
def test_a_complete_finer_run_estimates_what_follows_a_path(tmp_path, name):
    result, printed = solved(tmp_path, name, "--errors", "full")
    told, listing = QUANTITY.findall(printed), result.with_suffix(".lst").read_text()
    assert told and "path" not in printed + listing
    pairs = re.findall(r"^   pre-tension +(\S+)\n   uncertainty +(\S+)$", listing, re.MULTILINE)
    assert len(pairs) == len(re.findall(r"^   pre-tension +\S", listing, re.MULTILINE))
    assert bool(pairs) == (name == "pre-tension")
    # The force is prescribed in the first step alone.
    assert all((float(number) < 1e-9) == (k == 0) for k, (_, number) in enumerate(pairs))
    for quantity, words in told:
        assert is_no_number(quantity, words) or words.startswith(" +- ") or (
            quantity == "peak pressure" and words.startswith(" (no estimate: at a corner)")), quantity


def test_tables_of_points_and_forces_of_single_nodes_have_none(tmp_path):
    """The finer mesh has other points, and other forces at its nodes; sums of these have one."""
    fit = INPUT / "examples" / "press_fit.inp"
    (tmp_path / "press_fit.mesh").write_text(fit.with_suffix(".mesh").read_text())
    deck = copy_deck(fit, tmp_path / "press_fit.inp", (), {
        "*END STEP": "*EL PRINT\nS\n*NODE PRINT, TOTALS=YES\nU, RF\n*END STEP"})
    mark = " (no estimate: single points)\n"
    assert run("run", deck, "--out", tmp_path, "--errors", "full").returncode == 0
    listing = deck.with_suffix(".lst").read_text()
    assert listing.count(mark) == 2
    assert "INTEGRATION POINTS OF ALL" + mark in listing and "NODES OF ALL: RF" + mark in listing
    assert "UNCERTAINTIES (95 %) OF TOTALS OF ALL" in listing


@pytest.mark.parametrize("held", ["BODY.LEFT, 1, 2", "BODY.LEFT, 1"], ids=["clamped", "smooth"])
def test_a_largest_value_at_a_singular_corner_has_no_uncertainty(tmp_path, held):
    deck = write(tmp_path / "plate.inp", without_unused_surfaces([
        *mesh("BODY", [0.0, 0.5, 1.0, 1.5, 2.0], [0.0, 0.5, 1.0], "CPE8"), *material("BODY", (1000.0, 0.3)),
        "*BOUNDARY", held, "BODY.BOTTOM, 2", "*STEP", "*STATIC", "1., 1.", "*DSLOAD", "BODY.RIGHT, P, -1.",
        "*END STEP", "*VERIFY, KIND=ANALYTIC, SOURCE=none", "MISES, MAX, LAST, 1., 10., ABS"]))
    assert run("run", deck, "--out", tmp_path).returncode == 0
    found = re.search(r"found: +\S+(.*)", deck.with_suffix(".lst").read_text())[1]
    assert found.startswith(" (no estimate: at a corner)" if held.endswith("2") else " +- ")


def test_a_number_with_an_uncertainty_has_no_reason(tmp_path):
    result, printed = tmp_path / "two_rods.vtkhdf", run("run", RODS, "--out", tmp_path).stdout
    assert "+-" in printed and "no estimate" not in printed
    with h5py.File(result) as file:
        assert not file["uncertainty/GAP/no_estimate"][:].any()
        assert file["uncertainty/reasons"].asstr()[0] == ""
        assert file["uncertainty"].attrs["inside_step"] == "needs ERRORS=FULL"


def test_the_former_name_of_the_group_is_the_same_group(tmp_path):
    run("run", RODS, "--out", tmp_path)
    with h5py.File(tmp_path / "two_rods.vtkhdf") as file:
        assert file["errors"] == file["uncertainty"]
