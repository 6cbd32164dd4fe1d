"""Local refinement, *REFINE with SURFACE= or ELSET=: hanging nodes, contact faces, refusals."""

import itertools
import shutil

import h5py
import numpy as np
import pytest
from changes import note_changes
from deck_runs import CYLINDER, INPUT, copy_deck, run, solve
from physics import judge, judge_linear_fields, material, mesh

ROLLER = INPUT / "examples" / "roller.inp"
KINDS = ["CPE8", "CPE8R", "CPE6", "CPS8", "CPS6", "CPE4", "CPE4I", "CPE3"]
EDGES = [0.0, 0.6, 1.5, 2.0, 2.6, 3.0], [0.0, 0.5, 1.2, 1.7, 2.1, 2.6]


def inner_set(cards, name="INNER"):
    """Return an element set of those elements that reach into the middle of the 5 x 5 cells."""
    inside, place, chosen = None, {}, []
    for card in cards:
        if card.startswith("*"):
            inside = card.split(",")[0]
        elif inside == "*NODE":
            number, x, y = card.split(",")[:3]
            place[int(number)] = float(x), float(y)
        elif inside == "*ELEMENT":
            number, *nodes = map(int, card.split(","))
            x, y = np.mean([place[n] for n in nodes[:3]], axis=0)
            if 1.45 < x < 2.05 and 1.15 < y < 1.75:
                chosen.append(str(number))
    assert chosen
    return [f"*ELSET, ELSET={name}", *chosen]


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_patch_with_hanging_nodes_is_exact(tmp_path, kind, order):
    """Linear displacements and temperatures, given at outer nodes, where nothing is divided."""
    cards = mesh("BODY", *EDGES, kind, skew=0.05)
    judge_linear_fields(tmp_path, [f"*OPTIONS, ORDER={order}"], [
        *cards, *inner_set(cards), "*REFINE, LEVELS=3, ELSET=INNER"], kind)


XS = [0.0, 0.3, 0.7, 1.0, 1.4]
UPPER, LOWER = [0.0, 0.4, 0.8], [-1.0, -0.3, 0.0]


def pressed(path, refine, kind="CPE8", kinds=None, cards=(), pair="", lower=XS):
    """Two blocks without lateral expansion under a uniform pressure and flux of heat."""
    upper = mesh("UPPER", XS, UPPER, kind, first=1)
    below = mesh("LOWER", lower, LOWER, kinds or kind, first=1001)
    first = next(card for card in upper[upper.index("*SURFACE, NAME=UPPER.BOTTOM") + 1:])
    path.write_text("\n".join([
        *upper, *below, "*SURFACE, NAME=CORNER", first, *material("UPPER", (1e4, 0.0), 0.0, 3.0),
        *material("LOWER", (2e4, 0.0), 0.0, 0.5), "*SURFACE INTERACTION, NAME=I",
        "*GAP LAW, TYPE=POWER", "0.7, 0., 1.",
        f"*CONTACT PAIR, INTERACTION=I, NAME=FACE{pair}", "UPPER.BOTTOM, LOWER.TOP",
        *refine, *cards, "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.",
        "*BOUNDARY", "LOWER.BOTTOM, 2, 2", "UPPER.LEFT, 1, 1", "LOWER.LEFT, 1, 1",
        "UPPER.TOP, 11, 11, 90.", "LOWER.BOTTOM, 11, 11, 20.",
        "*DSLOAD", "UPPER.TOP, P, 12.5", "*END STEP"]) + "\n")
    return path


def sides_that_hang(deck):
    """Return how many sides of the listing's mesh have hanging nodes."""
    for line in deck.with_suffix(".lst").read_text().splitlines():
        if "sides with hanging nodes" in line:
            return int(line.split()[-1])
    return 0


FACE = "*REFINE, LEVELS=2, SURFACE=UPPER.BOTTOM"
CORNER = "*REFINE, LEVELS=3, SURFACE=CORNER"


@pytest.mark.parametrize("refine", [FACE, CORNER, FACE + ", DISTANCE=0.45"])
@pytest.mark.parametrize("kind", ["CPE8", "CPE8R", "CPE6", "CPE4", "CPE3", "CAX8", "CAX6", "CAX4",
                                  "CPE4I", "CAX4I"])
def test_uniform_pressure_and_flux_cross_a_locally_refined_face(tmp_path, kind, refine):
    """q = (T1 - T2)/(L1/k1 + L2/k2 + 1/omega); both faces are divided together."""
    deck = pressed(tmp_path / "deck.inp", [refine], kind)
    flux = 70.0 / (0.8 / 3.0 + 1.0 / 0.5 + 1.0 / 0.7)
    with h5py.File(solve(deck)) as file:
        face = file["contact/FACE"]
        np.testing.assert_allclose(face["pressure"][-1], 12.5, rtol=1e-10)
        np.testing.assert_allclose(face["heat_flux"][-1], flux, rtol=1e-10)
        sides = (len(face["s"]) - 1) // (1 if kind[-1] in "43" else 2)
        stress = file["VTKHDF/PointData/stress"][()]
        np.testing.assert_allclose(stress[:, 1], -12.5, rtol=1e-9)
        np.testing.assert_allclose(file["VTKHDF/CellData/stress_error"][()], 0.0, atol=1e-8)
        np.testing.assert_allclose(file["VTKHDF/CellData/heat_flux_error"][()], 0.0, atol=1e-8)
    assert sides > len(XS) - 1
    assert sides_that_hang(deck) > 0


def elements_of(folder, refine, name):
    """Return how many elements there are, and the cards of the deck."""
    deck = pressed(folder / f"{name}.inp", refine,
                   cards=["*ELSET, ELSET=TIP", "1", "*ELSET, ELSET=PART", "1, 2"])
    with h5py.File(solve(deck)) as file:
        return len(file["VTKHDF/CellData/element_id"]), deck.read_text().splitlines()


@pytest.mark.changes("REFINE, SURFACE", "REFINE, ELSET")
def test_elements_of_the_region_are_divided_and_those_opposite(tmp_path):
    """Of 16 elements one or more are on the surface or in the set, and as many lie opposite."""
    for region, *names in (("SURFACE", ("UPPER.BOTTOM", 4), ("CORNER", 1)),
                           ("ELSET", ("TIP", 1), ("PART", 2))):
        decks = []
        for name, inside in names:
            found, cards = elements_of(tmp_path, [f"*REFINE, LEVELS=1, {region}={name}"], name)
            assert found == 16 + 3 * 2 * inside, name
            decks.append(cards)
        note_changes(*decks)


@pytest.mark.changes("REFINE, DISTANCE")
def test_elements_within_the_distance_are_divided(tmp_path):
    """The layers begin at 0 and 0.4 above the face, at 0 and 0.3 below; what touches stays."""
    card = "*REFINE, LEVELS=1, SURFACE=UPPER.BOTTOM, DISTANCE="
    counts, decks = zip(*[elements_of(tmp_path, [f"{card}{d}"], f"d{i}")
                          for i, d in enumerate((0.3, 0.35, 0.45))], strict=True)
    assert counts == (16 + 3 * 8, 16 + 3 * 12, 16 + 3 * 16)
    note_changes(decks[0], decks[1])


def test_levels_of_several_cards_add_up(tmp_path):
    """All elements once, those at the face once more."""
    found, _ = elements_of(tmp_path, ["*REFINE, LEVELS=1", "*REFINE, LEVELS=1, SURFACE=CORNER"],
                           "both")
    assert found == 4 * 16 + 3 * 2 * 2


@pytest.mark.parametrize("lower", [XS, [0.0, 0.5, 1.4]])
def test_faces_whose_nodes_do_not_match_need_not_refine_together(tmp_path, lower):
    """Pressure and flux stay uniform; the lower body is divided only if its nodes match."""
    deck = pressed(tmp_path / "deck.inp", [FACE], pair=", PAIRING=SURFACES", lower=lower)
    with h5py.File(solve(deck)) as file:
        np.testing.assert_allclose(file["contact/FACE/pressure"][-1], 12.5, rtol=1e-9)
        assert np.sum(file["VTKHDF/CellData/body"][()] == 2) == 2 * (len(lower) - 1)


def test_many_levels_at_one_side(tmp_path):
    """The side beside it is divided next to it, one level less; the pressure stays uniform."""
    deck = pressed(tmp_path / "deck.inp", ["*REFINE, LEVELS=6, SURFACE=CORNER"], "CPE4",
                   cards=["*OPTIONS, ERRORS=NO"])
    with h5py.File(solve(deck)) as file:
        np.testing.assert_allclose(file["contact/FACE/pressure"][-1], 12.5, rtol=1e-9)
        assert len(file["contact/FACE/s"]) == 5 + 2**6 - 1 + 5


def test_loads_sets_and_sections_follow(tmp_path):
    """A block of two materials side by side under its weight, heated inside: T'' = -s/k."""
    cards = mesh("BODY", [0.0, 0.4, 1.0], [0.0, 0.5, 1.0, 2.0])
    deck = [*cards, "*ELSET, ELSET=MIDDLE", "3", *material("BODY", (1e4, 0.0), 0.0, 2.0),
            "*REFINE, LEVELS=2, ELSET=MIDDLE", "*STEP",
            "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
            "BODY.BOTTOM, 1, 2", "BODY.BOTTOM, 11, 11, 10.", "*DLOAD", "BODY, BY, -3.",
            "*DFLUX", "BODY, BF, 4.", "*END STEP"]
    judge(tmp_path, deck, [
        ("U2", "BODY.TOP", "LAST", -3.0 * 2.0**2 / 2 / 1e4, 1e-10),
        ("NT", "BODY.TOP", "LAST", 10.0 + 4.0 * 2.0**2 / 2 / 2.0, 1e-10),
        ("heat_in", "", "LAST", 4.0 * 2.0, 1e-10),
        ("force_imbalance", "", "LAST", 0.0, 1e-10, "ABS"),
        ("heat_imbalance", "", "LAST", 0.0, 1e-10, "ABS")])


def faces_of(cards, name):
    """Return element and number of each face of a surface."""
    lines = cards[cards.index(f"*SURFACE, NAME={name}") + 1:]
    faces = itertools.takewhile(lambda line: not line.startswith("*"), lines)
    return [[part.strip() for part in line.split(",")] for line in faces]


@pytest.mark.parametrize("lower", [XS, [0.0, 0.5, 1.4]])
@pytest.mark.parametrize("surface", ["UPPER.BOTTOM", "LOWER.TOP", "UPPER.TOP"])
def test_ties_and_loads_on_faces_follow(tmp_path, surface, lower):
    """Tied blocks whose nodes match or not, refined at the tie or under the loads: pressure and
    film on the top, q = (T1 - T2)/(1/h + L/k)."""
    upper = mesh("UPPER", XS, UPPER, first=1)
    top = faces_of(upper, "UPPER.TOP")
    film, load = [[f"{element}, {kind}{face[1:]}, {values}" for element, face in top]
                  for kind, values in (("F", "100., 3."), ("P", "5."))]
    deck = [*upper, *mesh("LOWER", lower, LOWER, first=1001),
            *material("UPPER", (1e4, 0.3), 0.0, 2.0), *material("LOWER", (1e4, 0.3), 0.0, 2.0),
            "*TIE, NAME=T", "UPPER.BOTTOM, LOWER.TOP",
            f"*REFINE, LEVELS=2, SURFACE={surface}", "*STEP",
            "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
            "LOWER.BOTTOM, 2, 2", "UPPER.LEFT, 1, 1", "LOWER.LEFT, 1, 1",
            "LOWER.BOTTOM, 11, 11, 20.", "*FILM", *film, "*DLOAD", *load, "*END STEP"]
    flux = 80.0 / (1.0 / 3.0 + 1.8 / 2.0)
    judge(tmp_path, deck, [
        *((quantity, body, "LAST", value, 1e-9) for body in ("UPPER", "LOWER")
          for quantity, value in (("S22", -5.0), ("HFL2", -flux))),
        ("heat_in", "", "LAST", 1.4 * flux, 1e-10),
        ("force_imbalance", "", "LAST", 0.0, 1e-10, "ABS"),
        ("heat_imbalance", "", "LAST", 0.0, 1e-10, "ABS")])


@pytest.fixture
def cylinder(tmp_path):
    """Return a copy of the cylinder without checks, in 5 increments."""
    text = CYLINDER.read_text().split("*VERIFY")[0]
    assert "\n20., 900.\n" in text
    path = tmp_path / "cylinder.txt"
    path.write_text(text.replace("\n20., 900.\n", "\n180., 900.\n"))
    return path


def test_a_face_refined_alone_gives_what_the_whole_mesh_would(tmp_path, cylinder):
    """On the cylinder heat and peak pressure come from the face: of what the second uniform level
    changes, a level at the face alone changes all but a tenth, with a third of the unknowns."""
    found = []
    for i, cards in enumerate((["*REFINE, LEVELS=1"], ["*REFINE, LEVELS=2"],
                               ["*REFINE, LEVELS=1", "*REFINE, LEVELS=1, SURFACE=CURVED"])):
        deck = copy_deck(cylinder, tmp_path / f"{i}.inp", [*cards, "*OPTIONS, ERRORS=NO"])
        with h5py.File(solve(deck)) as file:
            face, size = file["contact/FACE"], file["run"].attrs
            found.append((face["heat_rate"][-1], face["pressure"][-1].max(),
                          int(size["equations_thermal"] + size["equations_mechanical"])))
    once, twice, local = found
    for k in range(2):
        assert abs(local[k] - twice[k]) < 0.1 * abs(once[k] - twice[k])
    assert local[2] < 0.35 * twice[2]


def test_the_uncertainty_of_a_locally_refined_mesh_holds_its_error(tmp_path, cylinder):
    """Against a mesh that is four times as fine everywhere: below the uncertainty, and not far."""
    cards = ["*REFINE, LEVELS=1, SURFACE=CURVED"]
    deck = copy_deck(cylinder, tmp_path / "local.inp", [*cards, "*OPTIONS, ERRORS=FULL"])
    with h5py.File(solve(deck)) as file:
        face = file["contact/FACE"]
        found = face["normal_force"][-1], face["pressure"][-1].max()
    fine = copy_deck(cylinder, tmp_path / "fine.inp",
                     ["*REFINE, LEVELS=2", *cards, "*OPTIONS, ERRORS=NO"])
    with h5py.File(solve(fine)) as file:
        face = file["contact/FACE"]
        exact = face["normal_force"][-1], face["pressure"][-1].max()
    errors = deck.with_suffix(".lst").read_text().rsplit("NUMERICAL UNCERTAINTY (95 %) OF FACE", 1)[1]
    for name, value, true in zip(("normal force", "peak pressure"), found, exact, strict=True):
        line = next(line for line in errors.splitlines() if name in line)
        uncertainty = float(line.split()[3])
        assert 0.1 * uncertainty < abs(true - value) < uncertainty, name


def test_a_coarse_triangle_between_three_divided_ones_is_solved(tmp_path):
    """All of its midside nodes hang, so that none is its own: the body still has a middle about which
    it may turn."""
    shutil.copy(ROLLER.with_suffix(".gmsh"), tmp_path)
    cards = ["*ELSET, ELSET=CH", "114, 359, 360", "*REFINE, LEVELS=1, ELSET=CH"]
    deck = tmp_path / "roller.inp"
    head, step = ROLLER.read_text().split("*STEP", 1)
    deck.write_text("\n".join([head.rstrip(), *cards, f"*STEP{step}"]))
    solve(deck)   # with its checks


@pytest.mark.parametrize(("card", "message"), [
    ("LEVELS=1, SURFACE=UPPER.BOTOM", "surface UPPER.BOTOM"),
    ("LEVELS=1, ELSET=NONE", "element set NONE"),
    ("LEVELS=1, SURFACE=CORNER, ELSET=TIP", "SURFACE= or ELSET=, not both"),
    ("LEVELS=1, DISTANCE=0.1", "give SURFACE= or ELSET= too"),
    ("LEVELS=12, SURFACE=CORNER", "LEVELS= must lie between 0 and 11"),
    ("LEVELS=-1, ELSET=TIP", "LEVELS= must lie between 0 and 11"),
    ("SURFACE=CORNER", "*REFINE needs LEVELS="),
    ("LEVELS=1, SURFACE=CORNER, DISTANCE=0.", "DISTANCE= must be positive"),
    ("LEVELS=1, ELSET=TIP, DISTANCE=near", "'near'"),
    ("LEVELS=1\n*REFINE, LEVELS=1", "a second *REFINE of the whole model"),
    ("LEVELS=1, ELSET=", "ELSET"),
])
def test_refused(tmp_path, card, message):
    deck = pressed(tmp_path / "deck.inp", ["*REFINE, " + card], cards=["*ELSET, ELSET=TIP", "1"])
    process = run("check", deck)
    assert process.returncode == 1
    assert message in process.stderr
    assert process.stderr.count("error:") == 1


def test_more_elements_than_memory_holds_are_refused(tmp_path):
    deck = pressed(tmp_path / "deck.inp", ["*REFINE, LEVELS=11, ELSET=LOWER"], "CPE4")
    process = run("check", deck)
    assert process.returncode != 0
    assert "memory" in process.stderr or "elements, more than" in process.stderr
