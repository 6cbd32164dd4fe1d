"""Branches of steady states through turning points of the load: folds that closed forms know, folds
in corners, and a twin of the cylinder with a hysteresis."""

from functools import partial

import numpy as np
from branch_rods import Rods
from deck_runs import solve
from pictures import save
from report import Picture, Table, check_rows, verdict
from scipy.optimize import brentq, minimize_scalar
from test_branches import branch_of_r3, exchanged_twin, factor_of, followed
from thercon.post import branch, style
from thercon.post.result import Result

TITLE = "Branches"
TEXT = """
Steady states over the load factor that [\\*CONTINUATION](deck/method.md#continuation) follows, stable and
not. On 200 random rods (tests/decks/test_branches.py) it finds all states of an independent scan.
Folds, the loads at which two states meet, are accurate to 1e-6, also in corners, where a contact
closes.

A twin of the cylinder with a hysteresis (picture) has two folds. The upper one, at which the open
bodies snap together, converges with order 2. The lower one does not: contact points close one by
one, each in a pair of folds that belongs to the mesh and vanishes with its elements, so only the
size of its load is known, 0.07.
"""
IN_DOCUMENT = ["Heat rate of the twin with a hysteresis over the load"]
MOST = 1e-6     # of the load
POINTS = {1: 400, 2: 400, 3: 52}   # of a branch by how often elements are halved: the last one in part
LIMIT = 0.673159   # upper fold of the twin with quadratic elements, refined twice


def row(case, kind, found, known):
    """Return the row of a fold."""
    deviation = abs(found / known - 1.0)
    return [case, kind, f"{found:.9f}", f"{known:.9f}", deviation, verdict(deviation < MOST)]


def smooth_and_sharp(folder):
    """Return the table of folds that are known."""
    table = Table("Folds that are known", [
        "rods", "fold", "load factor", "expected", "deviation", "verdict"], text="""The load of the rods R3 is explicit in the opening of their faces, and turns where its derivative is zero. Of random rods (tests/decks/branch_rods.py) two turn in a corner, where a contact closes and the slope of its conductance jumps: expected is the load at which its opening is 0. All three nodes of a face close there at once, and each could close alone: such patterns are solutions of the discrete equations, too, but the branch goes on with all of them.""")
    _, deck = branch_of_r3(folder, "*CONTINUATION, HIGHEST=1.5")
    factor, folds, _ = followed(solve(deck))
    upper = -minimize_scalar(lambda z: -factor_of(z), bounds=(1e-5, 6e-5), method="bounded",
                             options={"xatol": 1e-14}).fun
    lower = minimize_scalar(factor_of, bounds=(-1e-5, -1e-6), method="bounded",
                            options={"xatol": 1e-14}).fun
    for kind, found, known in zip(("upper", "lower"), factor[folds], (upper, lower), strict=True):
        table.rows.append(row("R3", kind, found, known))
    for seed, near in ((1078, 0.4577), (2073, 0.6172)):
        rods = Rods(seed)
        deck = folder / f"corner{seed}.inp"
        deck.write_text(rods.cards(first=0.05, continuation="*CONTINUATION, POINTS=1000"))
        factor, folds, _ = followed(solve(deck))
        known = brentq(lambda t, rods=rods: float(rods.state(0.0, t)[2]), 0.999 * near,
                       1.001 * near, xtol=1e-15)
        found = factor[folds][np.argmin(np.abs(factor[folds] - known))]
        table.rows.append(row(f"seed {seed}", "corner", found, known))
    return table


def hysteresis(folder, most=POINTS):
    """Return the table of the twin's folds, and the last result of a whole branch, of so many points
    at most."""
    table = Table("A twin with a hysteresis", [
        "elements halved", "upper fold", "order", "lower fold", "pairs of folds above it",
        "widest pair", "verdict"], text=f"""The coupled twin of input/cylinder has one state at every load. With the expansions of both bodies exchanged, the cylinder lifted by 0.006 and no friction, heat closes the gap that it crosses, and states lie between two folds (picture below, of elements halved twice; they are linear). The upper fold is where the open bodies snap together. Its load converges with the order of the elements, 2, to the {LIMIT} of quadratic elements on a mesh refined twice. From the lower fold on contact points of the closed bodies close one after the other as the load grows, each in a pair of folds of its own. With half the elements there are about twice as many pairs, and the widest is half as wide: they belong to the mesh and vanish with its elements. The lower fold is the first of them, where few points are closed. Its load moves by -4 % and 5 % from mesh to mesh: it does not converge on these meshes, and nothing but its size is known.""")
    upper, lower, shown = [], [], None
    for levels, points in most.items():
        result = solve(exchanged_twin(folder / f"twin{levels}.inp", levels, points))
        factor, folds, _ = followed(result)
        upper.append(factor[folds][0])
        lower.append(factor[folds][1])
        whole = factor[-1] == 1.0
        if whole:
            shown = result
            pairs = factor[folds][2:].reshape(-1, 2)
        order = "-"
        if len(upper) == 3:
            changes = np.diff(upper)
            order = f"{np.log2(changes[0] / changes[1]):.1f}"
        table.rows.append([str(levels), f"{upper[-1]:.6f}", order, f"{lower[-1]:.4f}",
                           *([str(len(pairs)), f"{np.max(-np.diff(pairs)):.4f}"] if whole else "--"), "-"])
    ends = upper[-1] + np.diff(upper)[-1] / 3
    table.rows[-1][-1] = verdict(abs(ends / LIMIT - 1) < 2e-6 and order == "2.0")
    return table, shown


def draw_branch(path_of_result, path):
    """Draw the heat rate over the load, as post/plot branch does."""
    style.apply()
    with Result(path_of_result) as result:
        (contact,) = result.contacts(None)
        found = branch.of_branch(result)
        figure = branch.picture(result, contact, "heat_rate", found,
                                contact.totals()["heat_rate"][found[0]])
        save(figure, path)


def tables(folder):
    """Run the cases; return their tables and the picture."""
    table, result = hysteresis(folder)
    return [smooth_and_sharp(folder), table,
            Picture("twin-branch.png", "Heat rate of the twin with a hysteresis over the load",
                    partial(draw_branch, result))]


def test_hysteresis(tmp_path):
    """Of the twin's branches the part with the folds that are judged."""
    parts = dict.fromkeys(POINTS, min(POINTS.values()))
    check_rows([smooth_and_sharp(tmp_path), hysteresis(tmp_path, parts)[0]])
