"""Numbers without a bound of their error: which they are, and the reason that is told."""

import re

import h5py
import numpy as np
import pytest
from deck_runs import INPUT, copy_deck, run

RODS, FLANGE = (INPUT / "examples" / f"{name}.inp" for name in ("two_rods", "bolted_flange"))
STEADY = "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT"
CONDUCTIVITY = "*CONDUCTIVITY\n0.2\n"
DECKS = {  # reason -> deck, cards and changes
    "pre-tension": (FLANGE, (), {}),
    "branches": (RODS, (), {"*END STEP": "*CONTINUATION, POINTS=10\n*END STEP"}),
    "stored heat": (RODS, (), {
        CONDUCTIVITY: f"{CONDUCTIVITY}*DENSITY\n1.\n*SPECIFIC HEAT\n3.6\n",
        STEADY: "*COUPLED TEMPERATURE-DISPLACEMENT, DIRECT"}),
    "tables over temperature": (RODS, (), {CONDUCTIVITY: "*CONDUCTIVITY\n0.2, 0.\n0.2001, 500.\n"}),
    "ERRORS=NO": (RODS, ["*OPTIONS, ERRORS=NO"], {})}
QUANTITY = re.compile(r"^    ((?:normal|shear) force|heat rate|peak pressure|edge of \w+)  +\S+(.*)$",
                      re.MULTILINE)


def solved(folder, reason):
    """Solve a deck whose numbers have no bounds, with checks; return its result and output."""
    source, cards, changes = DECKS[reason]
    for mesh in source.parent.glob(f"{source.stem}.mesh"):
        (folder / mesh.name).write_text(mesh.read_text())
    (folder / "plain.txt").write_text(source.read_text().split("*VERIFY")[0])
    deck = copy_deck(folder / "plain.txt", folder / "deck.inp", cards, changes)
    with deck.open("a") as file:
        file.write("*VERIFY, KIND=FIGURE\npressure, MAX, LAST, 0., 1.E9, ABS\n"
                   "NT, MAX, LAST, 0., 1.E9, ABS\nU1, MAX, LAST, 0., 1.E9, ABS\n")
    process = run("run", deck, "--out", folder)
    assert process.returncode == 0, process.stderr
    return deck.with_suffix(".vtkhdf"), process.stdout


@pytest.mark.parametrize("reason", DECKS)
def test_every_number_says_why_it_has_no_bound(tmp_path, reason):
    """In summary, listing, result file and at the checks."""
    result, printed = solved(tmp_path, reason)
    listing, mark = result.with_suffix(".lst").read_text(), f" (no estimate: {reason})"
    told = QUANTITY.findall(printed)
    assert {"normal force", "heat rate", "peak pressure"} <= {name for name, _ in told}
    for name, words in told:
        is_no_number = name.startswith("edge") and re.search(
            r"whole face|end of the face|\(open\)", words)
        assert is_no_number or words.startswith(mark), (name, words)
    assert "+-" not in printed and "uncertain" not in printed
    assert listing.count(mark) >= printed.count(mark) and "NUMERICAL UNCERTAINTY (95 %)" not in listing
    # The largest of all temperatures is a number of this kind, a displacement is not.
    assert len(re.findall(rf"found:  \S+{re.escape(mark)}\n", listing)) == (1 if reason == "pre-tension"
                                                                           else 2)
    with h5py.File(result) as file:
        steps, words = file["uncertainty"], file["uncertainty/reasons"].asstr()[:]
        for name in (name for name in steps if isinstance(steps[name], h5py.Group)):
            why = steps[name]["no_estimate"]
            for quantity, column in zip(why.attrs["components"].split(), why[:].T, strict=True):
                rows = steps[name][quantity][:]
                assert np.isnan(rows[:, 1:]).all()
                told = words[column]
                np.testing.assert_array_equal(told, np.where(np.isnan(rows[:, 0]), "", reason))


def test_a_number_with_a_bound_has_no_reason(tmp_path):
    result, printed = tmp_path / "two_rods.vtkhdf", run("run", RODS, "--out", tmp_path).stdout
    assert "+-" in printed and "no estimate" not in printed
    with h5py.File(result) as file:
        assert not file["uncertainty/GAP/no_estimate"][:].any()
        assert file["uncertainty/reasons"].asstr()[0] == ""
        assert file["uncertainty"].attrs["inside_step"] == "inside a step"
