"""What a requested accuracy gives and costs: five decks, three targets, against converged values."""

import h5py
import numpy as np
from deck_runs import COUPLED, CYLINDER, HERTZ, INPUT, run
from report import Table, check_parts, rows

TITLE = "Accuracy on request"
TEXT = """
`thercon run DECK --accuracy P%` solves in rounds until the bounds of normal force, heat rate, peak
pressure and edge of contact are inside P per cent ([deck.md](deck.md), `*ACCURACY`). Below, the
largest true error over its target, which must stay below 1 where the status is 0, and the largest
bound over its target. True errors are those to the converged values above. Of the roller, whose
faces do not match, there are none; its mesh divided twice, and twice more at the faces, has a peak
of 606.11 MPa and an edge at 0.4193 mm. With 3 % the edge is 0.7 % from that, with 1 % 0.4 %, and
the peak 0.3 % in both. CPU seconds are those of all rounds together, with estimates and results.

- **Bounds** are those above; from the second round on that of the mesh is at least half of what the
  round changed.
- **Where elements are divided.** At the edges of zones, as often as an edge must be resolved, and
  by the recovered energy norm, weighted for the peak pressure with the distance from the peak.
- **What it costs.** Every round is solved from the start, with all of its increments. The aim is
  2.5 times the CPU seconds of the cheapest mesh refined by hand, and at 0.3 % a tenth of those of
  uniform refinement. For 3, 1 and 0.3 % the press fit takes 1.1, 1.7 and 1.4 times as much, the
  cylinder 1.2, 3.6 and 6.2, Hertz 2.1, 2.4 and 5.3, the twin 2.3, 2.8 and 30 times. The other mesh
  is the cheapest one with a true error inside the target at the end of the load, without
  estimates: refined as a whole (0 to 3 levels), at the contact faces (1 to 4), or by 1 and then by
  1 to 3 there.
- **Such a mesh is known only with the converged value.** Errors at one load are partly chance: on
  the cylinder refined uniformly by 0 to 3 levels they are 0.53, 0.07, 0.09 and 0.13 %. Bounds
  cannot count on that: on none of these meshes are they inside 0.3 % (1.13 times that on the
  finest, in 5.9 s, against 1.8 s with a request). On the twin the bound of the increments asks for
  180 of them at 0.3 %.
- **Where no bound can be given.** Peak pressures at corners grow without limit: after two rounds
  that bring nothing the run ends with status 4.
"""
HEAD = ["deck", "target", "status", "rounds", "CPU s", "elements", "increments",
        "largest bound/target", "true error/target"]
PERCENT = (3, 1, 0.3)
DECKS = {"cylinder": (CYLINDER, "FACE"), "coupled twin": (COUPLED, "FACE"), "Hertz": (HERTZ, "FACE"),
         "press fit": (INPUT / "examples" / "press_fit.inp", "SEAT"),
         "roller": (INPUT / "examples" / "roller.inp", "LINE")}
TITLES = {"normal_force": "normal force", "heat_rate": "heat rate", "peak_pressure": "peak pressure",
          "edge_contact": "edge of contact"}


def converged(name):
    """Return the converged values of a deck that the document tells."""
    told = {row["deck"]: row for row in rows("Converged values of the five decks")}
    return {q: float(told[name][title]) for q, title in TITLES.items()
            if told.get(name, {}).get(title, "-") != "-"}


def measured(name, percent, folder):
    """Return the row of a deck and a target."""
    deck, face = DECKS[name]
    process = run("run", "--quiet", deck, "--out", folder, "--accuracy", f"{percent}%", seconds=900)
    exact, errors, excess = converged(name), [], []
    with h5py.File(folder / f"{deck.stem}.vtkhdf") as file:
        group = file["accuracy"]
        for quantity, found in group[f"bounds/{face}"].items():
            step, value, bound, allowed = found[-1]
            if step == 0:
                continue
            excess.append(bound / allowed)
            if quantity in exact:
                errors.append(abs(value - exact[quantity]) / allowed)
        costs = group["cpu_seconds"][:]
        return [name, f"{percent} %", process.returncode, len(costs), f"{costs.sum():.2f}",
                group["elements"][-1], group["increments"][-1], f"{max(excess):.2f}",
                f"{max(errors):.2f}" if errors else "-"]


def tables(folder):
    """Run all decks with all targets."""
    return [Table("Targets, bounds and true errors", HEAD, [
        measured(name, percent, folder) for name in DECKS for percent in PERCENT
        if (name, percent) != ("roller", 0.3)])]


def test_cheap_requests_hold_as_the_document_tells(tmp_path):
    """A status of 0 is told of every request of 1 % or more, and true errors are inside all targets."""
    check_parts([TEXT])
    told = {(row["deck"], row["target"]): row for row in rows("Targets, bounds and true errors")}
    for row in told.values():
        assert row["status"] == "0" and float(row["largest bound/target"]) <= 1.0
        assert row["true error/target"] == "-" or float(row["true error/target"]) < 1.0
    for name, percent in (("cylinder", 1), ("coupled twin", 3), ("press fit", 0.3)):
        found = dict(zip(HEAD, measured(name, percent, tmp_path), strict=True))
        row = told[name, f"{percent} %"]
        assert [str(found[head]) for head in ("status", "rounds")] == [row["status"], row["rounds"]]
        np.testing.assert_allclose(float(found["true error/target"]), float(row["true error/target"]),
                                   rtol=0.1, atol=0.01)
