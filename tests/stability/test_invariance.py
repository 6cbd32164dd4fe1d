"""The theme of invariance: units, place, numbers and the order of the faces do not count."""

import report  # isort: skip, it makes the modules below known
import h5py
import numpy as np
import press
from cases import Outcome
from press import Look

TITLE = "Invariance"
TEXT = """
A deck gives the same results in other units, at another position, with other numbers and with the
faces exchanged. It is a press of two blocks with inclined and bent faces, friction, gas and power
conductance, films, sources, weights, forces on faces, volumes and nodes; contact points open, slip,
stick and close. In three other systems of units, mirrored, turned, renumbered, with the faces
exchanged, by MUMPS, and all at once no dataset of `/contact` and `/history` deviates by more than
2e-12 of its largest value. If the contact points run in the opposite direction, `shear` and `slip`
change their signs and `s` counts from the other end.
"""
IN_DOCUMENT = []
HEAD = ["the press", "datasets", "deviation", "allowed", "verdict"]
SAME = 1e-9
DIMENSIONS = {  # powers of length, stress and power
    "x": (1, 0, 0), "y": (1, 0, 0), "s": (1, 0, 0), "weight": (2, 0, 0), "gap": (1, 0, 0),
    "slip": (1, 0, 0), "pressure": (0, 1, 0), "shear": (0, 1, 0), "normal_force": (2, 1, 0),
    "shear_force": (2, 1, 0), "heat_rate": (0, 0, 1), "heat_flux": (-2, 0, 1),
    "conductance": (-2, 0, 1), "edge_contact": (1, 0, 0), "edge_stick": (1, 0, 0),
    "edges_contact": (1, 0, 0), "edges_stick": (1, 0, 0), "heat_in": (0, 0, 1),
    "heat_out": (0, 0, 1), "ALLFD": (3, 1, 0),
}
RUNNING = ("shear", "slip", "shear_force")  # signs along the tangent to growing s
ROUNDING = ("heat_imbalance", "heat_imbalance_pointwise", "force_imbalance")
MIRROR_X, MIRROR_Y = np.diag([-1.0, 1.0]), np.diag([1.0, -1.0])


def turned(degrees):
    """Return a rotation; those by right angles are exact."""
    angle = np.radians(degrees)
    matrix = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return np.round(matrix) if degrees % 90 == 0 else matrix


LOOKS = {
    "as it is": Look(),
    "in mm, N, tonne": Look(1e3, 1e-6, 1e3, 1e-3),
    "in cm, MPa, W": Look(1e2, 1e-6, 1.0, 1.0),
    "in micrometres, MPa, pW": Look(1e6, 1e-6, 1e12, 1.0),
    "mirrored, x to -x": Look(turn=MIRROR_X),
    "mirrored, y to -y": Look(turn=MIRROR_Y),
    "turned by 17 degrees": Look(turn=turned(17)),
    "turned by 90 degrees": Look(turn=turned(90)),
    "turned by 180 degrees": Look(turn=turned(180)),
    "turned by 253 degrees": Look(turn=turned(253)),
    "renumbered": Look(seed=1),
    "renumbered differently": Look(seed=2),
    "faces exchanged": Look(swapped=True),
    "by MUMPS": Look(solver="MUMPS"),
    "all at once": Look(1e3, 1e-6, 1e3, 1e-3, MIRROR_X @ turned(17), 3, True),
}


def solved(folder, look):
    """Return all datasets of the press, as it looks, of /contact and /history."""
    case = Outcome(folder, "press", press.cards(look))
    with h5py.File(case.path) as file:
        found = {name: item[()] for name, item in file["contact/F"].items()}
        found |= {name: item[()] for name, item in file["history"].items()}
    return found


def like(plain, found, look):
    """Return what the datasets of the plain press are as it looks."""
    expected = {name: np.array(values, dtype=float) for name, values in plain.items()}
    if look.swapped:
        for name in ("heat_flux", "heat_rate", *RUNNING):
            expected[name] = -expected[name]
        for one in ("node", "temperature"):
            pair = f"slave_{one}", f"master_{one}"
            expected[pair[0]], expected[pair[1]] = expected[pair[1]], expected[pair[0]]
    nodes, _ = press.numbers(press.plain_mesh(), look.seed)
    moved = press.places(look)
    for k, axis in enumerate("xy"):
        expected[axis] = np.array([moved[int(n)][k] for n in expected["slave_node"]]) / look.length
    for name in ("slave_node", "master_node"):
        expected[name] = np.array([nodes[int(n)] for n in expected[name]], float)
    # A mirror turns the way in which the tangent goes with the normal, not the way along s.
    if expected["slave_node"][0] != found["slave_node"][0]:
        turn_round(expected, plain["s"][-1])
    for name in expected:
        length, stress, power = DIMENSIONS.get(name, (0, 0, 0))
        expected[name] *= look.length**length * look.stress**stress * look.power**power
    return expected


def turn_round(expected, length):
    """Let the pairs run the other way, with a total length."""
    pairs = len(expected["s"])
    for name, values in expected.items():
        if name.startswith("edges"):
            expected[name] = np.sort(length - values, axis=1)  # NaN stay last
        elif values.shape[-1] == pairs:
            expected[name] = values[..., ::-1]
    expected["s"] = length - expected["s"]
    for name in RUNNING:
        expected[name] = -expected[name]
    # The zone with the largest s and the outer edge are others then; all are in edges_contact.
    del expected["edge_contact"], expected["edge_stick"]


def worst(plain, found, look):
    """Return how many datasets are compared, and the largest deviation."""
    expected = like(plain, found, look)
    off = 0.0
    names = [n for n in expected if n not in ROUNDING and n != "iterations"]
    for name in names:
        one, other = expected[name], np.array(found[name], float)
        assert one.shape == other.shape, name
        assert np.array_equal(np.isnan(one), np.isnan(other)), (name, one, other)
        assert "edge" in name or not np.isnan(one).any(), name
        scale = np.nanmax(np.abs(one), initial=0.0)
        if scale == 0.0 or np.isnan(scale):
            scale = 1.0
        off = max(off, float(np.nanmax(np.abs(one - other), initial=0.0)) / scale)
    assert all((np.abs(found[name]) < 1e-10).all() for name in ROUNDING), "the balances"
    return len(names), off


def tables(folder):
    """Return the table of the theme."""
    plain = solved(folder, Look())
    found = {int(k) for k in np.unique(plain["status"])}
    changes = (np.diff(plain["status"] == 0, axis=0)).any()
    assert found == {0, 1, 2} and changes, "open, slipping, stuck and closing pairs"
    table = report.Table("The press in other forms", HEAD)
    for name, look in LOOKS.items():
        count, off = worst(plain, solved(folder, look), look)
        table.rows.append([name, count, off, SAME, report.verdict(off <= SAME)])
    return [table]


def test_invariance(tmp_path):
    """Every look of the press holds, and the document tells the same."""
    import test_invariance

    report.check(test_invariance, tmp_path)
