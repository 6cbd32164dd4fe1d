"""What steps that store heat cost: a pass of the fixed point does not see the mesh behind the
contact points, and an increment of heat alone takes few back substitutions."""

import h5py
import numpy as np
import pytest
import report  # noqa: F401  makes the modules of decks known
import transients as two
from instructions import profile
from test_needed import MEASURED

COLUMNS = [float(x) for x in np.linspace(0.0, 1.0, 4)]
QUIET = ["*NODE FILE, FREQUENCY=0", "NT"]
STEADY = ["*BOUNDARY", f"UPPER.TOP, 11, 11, {two.HOT!r}", f"LOWER.BOTTOM, 11, 11, {two.COLD!r}"]


def pressed(path, rows):
    """Write two blocks of so many rows of elements each, relaxed slowly, in a step that stores heat
    and in a steady one; return the path."""
    high = [float(y) for y in np.linspace(0.0, 1.0, rows + 1)]
    low = [y - 1.0 for y in high]
    steps = [two.heated(*cards, *QUIET, how=analysis, times="0.1, 0.2")
             for analysis, cards in ((", LOCAL ERROR=1.", []), (", STEADY STATE, DIRECT", STEADY))]
    return two.write_deck(path, ["*OPTIONS, ERRORS=NO", "*SOLVER, TYPE=SKYLINE"],
                          two.bodies(upper=(COLUMNS, high), lower=(COLUMNS, low),
                                     apart=10000), two.contact(),
                          ["*FIXED POINT, METHOD=ZAITSEV, G=0.1, CONSTANT=500, MAXITER=500, "
                           "TOL=1.E-5"], *steps)


def cost_of_a_pass(folder, rows):
    """Return the instructions of a pass, and the number of equations."""
    deck = pressed(folder / "deck.inp", rows)
    found = profile("run", "--quiet", deck, "--out", folder, path=folder / "deck.out")
    spent = sum(cost for (source, target), cost in found.calls.items()
                if target == ("increment_iteration", "iterate") and source[0] != target[0])
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        passes, times = file["history/iterations"][()], file["history/time"][()]
        size = file["run"].attrs
        equations = int(size["equations_thermal"] + size["equations_mechanical"])
    assert spent > 0
    assert passes[times < 0.21].sum() > 100 and passes[times > 0.21].sum() > 100
    return spent / passes.sum(), equations


@MEASURED
def test_a_pass_does_not_see_the_mesh_behind(tmp_path):
    """Ten times the equations behind the same contact points."""
    (small, few), (large, many) = (cost_of_a_pass(tmp_path, rows) for rows in (1, 14))
    assert many > 10 * few
    assert large == pytest.approx(small, rel=0.03)


@MEASURED
@pytest.mark.parametrize("how", [", DIRECT", ", LOCAL ERROR=1.E-3"], ids=["fixed", "by error"])
def test_an_increment_of_heat_alone_takes_few_back_substitutions(tmp_path, how):
    """At most five, attempts that are repeated included; each eliminates and substitutes."""
    deck = two.write_deck(
        tmp_path / "deck.inp", ["*SOLVER, TYPE=SKYLINE"], two.bodies(),
        [card.replace(two.COUPLED, "*HEAT TRANSFER") for card in two.heated(
            *QUIET, how=how, pressed=(), times="0.03, 2.")])
    found = profile("run", "--quiet", deck, "--out", tmp_path, path=tmp_path / "deck.out")
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        increments = len(file["history/time"])
    assert increments > 50
    for kernel in ("eliminate", "substitute"):
        assert 2 * increments < found.called["column_panels", kernel] <= 5 * increments
