"""Names with * in cards of sets, surfaces and contact, and instances by their number: as decks in
which every name and every instance has a card of its own."""

import h5py
import numpy as np
import pytest
from blocks import write
from changes import note_changes
from deck_runs import solve
from pellets import ALONG, POWER, rod
from physics import material, mesh

# Of the largest value: one deck in another order of interfaces.
ROUNDING = 1e-9
VALUES = ("pressure", "shear", "heat_flux", "gap", "slip", "status")


def without(cards, *keywords):
    """Return the cards without those that begin with these words, and without their data."""
    kept, skips = [], False
    for card in cards:
        skips = card.startswith(keywords) if card.startswith("*") else skips
        if not skips:
            kept.append(card)
    return kept


def by_pattern(pellets, kind="CAX4"):
    """Return the cards of a rod with two contact pairs and sets of all pellets."""
    cards = without(rod(pellets, None, kind), "*CONTACT PAIR", *(f"*SURFACE, NAME=TUBE{k}" for k in range(10)))
    pairing = ", PAIRING=SURFACES" if kind == "mortar" else ""
    place = cards.index("*FIXED POINT, TOL=1E-12")
    cards[place:place] = [f"*CONTACT PAIR, INTERACTION=G, NAME=W{pairing}", "P*.RIGHT, TUBE.LEFT",
                          f"*CONTACT PAIR, INTERACTION=G, NAME=E{pairing}", "P*.BOTTOM, p*.Top",
                          "*NSET, NSET=AXIS", "P*.LEFT", "*ELSET, ELSET=FUEL", "P*"]
    text = "\n".join(cards)
    for k in range(pellets):
        text = text.replace(f"\nP{k}.LEFT, 1", "\nAXIS, 1" if k == 0 else "")
        text = text.replace(f"\nP{k}, BF, {POWER}", f"\nFUEL, BF, {POWER}" if k == 0 else "")
    return text.splitlines()


def contact_of(result, names):
    with h5py.File(result) as file:
        return {value: np.concatenate([file["contact"][name][value][-1] for name in names]) for value in VALUES}


def assert_same(one, other):
    for value in VALUES:
        largest = np.max(np.abs(other[value]))
        assert largest > 0.0 or value in ("shear", "slip")
        assert one[value] == pytest.approx(other[value], rel=0, abs=ROUNDING * largest), value


@pytest.mark.parametrize("kind", ["CAX4", "CAX8", "mortar"])
def test_pairs_by_pattern_are_pairs_of_a_card_each(tmp_path, kind):
    """Each pellet faces its own part of the tube, and the pellet below; the lowest one has none."""
    pellets = 4
    whole = solve(write(tmp_path / "whole.inp", rod(pellets, None, kind)))
    deck = write(tmp_path / "pattern.inp", by_pattern(pellets, kind))
    ks = range(pellets)
    assert_same(contact_of(solve(deck), [f"W-P{k}.RIGHT" for k in ks] + [f"E-P{k}.BOTTOM" for k in ks[1:]]),
                contact_of(whole, [f"W{k}" for k in ks] + [f"E{k}" for k in ks[1:]]))
    listing = " ".join(deck.with_suffix(".lst").read_text().split())
    assert "*CONTACT PAIR P*.BOTTOM, P*.TOP: 3 pairs, named after the slave surfaces" in listing
    assert "opposite no face of the master, and in no pair: P0.BOTTOM" in listing


def assembly(instances, tube=("*INSTANCE, NAME=TUBE, PART=TUBE", "*END INSTANCE")):
    """Return the cards of pellets, part of an assembly, in a tube."""
    pellet = mesh("F", np.linspace(0, 4.1, 4), np.linspace(0, 10, ALONG + 1), "CAX4")
    wall = mesh("C", [4.12, 4.7], np.linspace(0, 30, 3 * ALONG + 1), "CAX4")
    return ["*OPTIONS, ERRORS=NO", "*PART, NAME=PELLET", *pellet, "*SOLID SECTION, ELSET=F, MATERIAL=OX",
            "*END PART", "*PART, NAME=TUBE", *wall, "*SOLID SECTION, ELSET=C, MATERIAL=ZR", "*END PART",
            "*ASSEMBLY, NAME=ROD", *instances, *tube, "*NSET, NSET=AXIS", "PELLET-*.F.LEFT",
            "*ELSET, ELSET=FUEL", "ROD.PELLET-*.F", "*SURFACE, NAME=OUTSIDE", "TUBE.C.RIGHT, S2",
            "*END ASSEMBLY",
            *without(material("OX", [1.8e5, 0.316], [1e-5], [3e-3]), "*SOLID"),
            *without(material("ZR", [7e4, 0.35], [6e-6], [0.017]), "*SOLID"),
            "*SURFACE INTERACTION, NAME=G", "*FRICTION", "0.1", "*GAP LAW, TYPE=GAS", "3.E-4, 0.005",
            "*CONTACT PAIR, INTERACTION=G, NAME=WALL", "PELLET-*.F.RIGHT, TUBE.C.LEFT",
            "*CONTACT PAIR, INTERACTION=G, NAME=END", "PELLET-*.F.BOTTOM, PELLET-*.F.TOP",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "FUEL_NODES, 0.", "TUBE.C, 0.",
            "*NSET, NSET=FUEL_NODES", "PELLET-*.F",
            "*BOUNDARY", "TUBE.C.BOTTOM, 2", "PELLET-1.F.BOTTOM, 2", "AXIS, 1",
            "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.", "*DFLUX", "FUEL, BF, 0.4",
            "*SFILM", "TUBE.C.RIGHT, F, 300., 0.03", "*DSLOAD", "PELLET-3.F.TOP, P, 2.", "*END STEP"]


def fields_of(result):
    with h5py.File(result) as file:
        return {name: file["VTKHDF/PointData"][name][()] for name in ("displacement", "temperature")}


@pytest.mark.changes("INSTANCE, MULTIPLE")
def test_instances_by_number_are_instances_of_a_card_each(tmp_path):
    many = assembly(["*INSTANCE, NAME=PELLET, PART=PELLET, MULTIPLE=3", "0., 10., 0.", "*END INSTANCE"])
    many = [card.replace("TUBE.C.RIGHT, S2", "TUBE.C, S2") for card in many]
    each = [card for k in range(3) for card in (f"*INSTANCE, NAME=PELLET-{k + 1}, PART=PELLET",
                                                f"0., {10.0 * k}, 0.", "*END INSTANCE")]
    each = [card.replace("TUBE.C.RIGHT, S2", "TUBE.C, S2") for card in assembly(each)]
    decks = [without(cards, "*SURFACE, NAME=OUTSIDE") for cards in (many, each)]
    note_changes(*decks)
    one, other = (fields_of(solve(write(tmp_path / f"{name}.inp", cards)))
                  for name, cards in zip(("many", "each"), decks, strict=True))
    for name, values in one.items():
        assert np.array_equal(values, other[name])
        assert np.max(np.abs(values)) > 0.0


def test_each_of_several_instances_is_moved_once_more(tmp_path):
    """Shifted and turned: a quarter turn about a point after a shift, four times."""
    part = ["*PART, NAME=ARM", "*NODE", "1, 2., 0.", "2, 3., 0.", "3, 3., 1.", "4, 2., 1.",
            "*ELEMENT, TYPE=CPE4, ELSET=ALL", "1, 1, 2, 3, 4", "*SOLID SECTION, ELSET=ALL, MATERIAL=M",
            "*END PART", "*ASSEMBLY, NAME=STAR"]
    end = ["*END ASSEMBLY", "*MATERIAL, NAME=M", "*ELASTIC", "1000., 0.3", "*NSET, NSET=ALL", "1, 2, 3, 4",
           "11, 12, 13, 14", "21, 22, 23, 24", "*BOUNDARY", "ALL, 1, 2", "*STEP", "*STATIC", "*END STEP"]
    motion = ["0.5, 0., 0.", "1., 1., 0., 1., 1., 1., 90."]
    result = solve(write(tmp_path / "d.inp", part, ["*INSTANCE, NAME=A, PART=ARM, MULTIPLE=3", *motion],
                         ["*NSET, NSET=OWN", "1", "*END INSTANCE", "*NSET, NSET=EVERY", "A-*.OWN"], end))
    corner, expected = np.array([2.0, 0.0]), []
    for _ in range(3):
        expected.append(corner)
        x, y = corner + (0.5, 0.0) - np.array([1.0, 1.0])
        corner = np.array([1.0, 1.0]) + (-y, x)
    with h5py.File(result) as file:
        places = file["VTKHDF/Points"][:, :2]
    for place in expected:
        assert np.min(np.linalg.norm(places - place, axis=1)) < 1e-12


def stack(heights, cards):
    """Return plates of one row of elements, one on the other with a gap, of other divisions each."""
    plates, y = [], 0.0
    for k, height in enumerate(heights):
        plates += [*mesh(f"L{k}", np.linspace(0.0, 4.0, 5 + k % 2), [y, y + height], "CPE4", first=1 + 100 * k),
                   *material(f"L{k}", [1000.0, 0.3])]
        y += height + 0.01
    return [*plates, "*SURFACE INTERACTION, NAME=I", *cards, "*NSET, NSET=SIDES", "L*.LEFT", "*NSET, NSET=FEET",
            "L0.BOTTOM", "*BOUNDARY", "SIDES, 1", "FEET, 2", "*STEP", "*STATIC", "*BOUNDARY",
            f"L{len(heights) - 1}.TOP, 2, 2, -0.2", "*END STEP"]


def test_plates_thinner_than_their_elements_are_long_face_the_next_one(tmp_path):
    """Not the far side of themselves, nor the plate behind it; neither the first nor the last."""
    deck = write(tmp_path / "d.inp", stack([0.05, 0.03, 0.02, 0.05], [
        "*CONTACT PAIR, INTERACTION=I", "L*.BOTTOM, L*.TOP"]))
    with h5py.File(solve(deck)) as file:
        assert sorted(file["contact"]) == ["L1.BOTTOM", "L2.BOTTOM", "L3.BOTTOM"]
        for k in (1, 2, 3):
            pair = file[f"contact/L{k}.BOTTOM"]
            assert set(pair["master_node"][()]) <= set(range(100 * k - 99, 100 * k + 1))
            assert np.all(pair["pressure"][-1] > 0.0)


CHANGES = {
    "clearance": (["*CLEARANCE, SLAVE={0}, MASTER={1}, VALUE=-0.001"], []),
    "removed": ([], ["*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", "{0}, {1}"]),
    "interference": ([], ["*CONTACT INTERFERENCE, AMPLITUDE=STAYS", "{0}, {1}, 0.002"])}


STAYS = ["*AMPLITUDE, NAME=STAYS", "0., 1., 1., 1.", "*BOUNDARY", "L1.RIGHT, 2"]


@pytest.mark.parametrize("change", CHANGES)
def test_what_changes_contact_takes_patterns(tmp_path, change):
    """And the name of a single pair of the pattern, whose master is a part of its surface."""
    heights, found = [1.0, 1.0, 1.0], []
    pair = ["*CONTACT PAIR, INTERACTION=I, NAME=J", "L*.BOTTOM, L*.TOP"]
    for names in ([("L*.BOTTOM", "L*.TOP")], [("L1.BOTTOM", "L0.TOP"), ("L2.BOTTOM", "L1.TOP")]):
        model, step = ([card.format(*each) for each in names for card in part] for part in CHANGES[change])
        cards = stack(heights, pair + STAYS + model)
        place = len(cards) - 3
        result = solve(write(tmp_path / f"{len(names)}.inp", cards[:place] + step + cards[place:]))
        found.append(contact_of_static(result))
    assert found[0]["gap"] == pytest.approx(found[1]["gap"], abs=1e-12)
    assert found[0]["pressure"] == pytest.approx(found[1]["pressure"], abs=1e-9)
    plain = contact_of_static(solve(write(tmp_path / "plain.inp", stack(heights, pair + STAYS))))
    assert not np.allclose(found[0]["pressure"], plain["pressure"], rtol=1e-4)


def contact_of_static(result):
    with h5py.File(result) as file:
        return {value: np.concatenate([pair[value][-1] for pair in file["contact"].values()])
                for value in ("pressure", "gap")}


def test_surfaces_by_pattern_are_those_of_all_names(tmp_path):
    found = []
    for faces in (["L*.EDGE, S2"], ["L0.EDGE, S2", "L1.EDGE, S2"], ["L0.EDGE, S2"]):
        cards = stack([1.0, 1.0], ["*CONTACT PAIR, INTERACTION=I", "L1.BOTTOM, L0.TOP"])
        place = cards.index("*SURFACE INTERACTION, NAME=I")
        cards[place:place] = ["*ELSET, ELSET=L0.EDGE", "4", "*ELSET, ELSET=L1.EDGE", "105",
                              "*SURFACE, NAME=ENDS", *faces]
        cards[-1:-1] = ["*DSLOAD", "ENDS, P, 3."]
        with h5py.File(solve(write(tmp_path / f"{len(found)}.inp", cards))) as file:
            found.append(file["VTKHDF/PointData/displacement"][()])
    assert np.array_equal(found[0], found[1])
    assert not np.allclose(found[0], found[2], rtol=1e-3)
