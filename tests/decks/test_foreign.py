"""Decks as other programs write them run unchanged."""

import math

import pytest
from blocks import write
from calculix import thercon
from changes import note_changes
from deck_runs import DECKS, run
from physics import judge, material, mesh

FOREIGN = DECKS / "foreign"


def cards_of(name):
    """Return the cards of a deck of the folder `foreign`."""
    return (FOREIGN / name).read_text().splitlines()


def pressed_and_heated():
    """Return what is known of two blocks of height 2 and width 2 between smooth walls, E = 1000,
    nu = 0, K = 10, pressed by 20 and heated from 0 to 100: a closed contact with 5 + 0.2 p."""
    flux = 100.0 / (2.0 / 10.0 + 1.0 / (5.0 + 0.2 * 20.0) + 2.0 / 10.0)
    lower, upper = flux * 0.2, 100.0 - flux * 0.2
    mean = (lower / 2.0 + (upper + 100.0) / 2.0) / 2.0
    return [("pressure", "Slave", "LAST", 20.0, 1e-9),
            ("heat_rate", "Slave", "LAST", 2.0 * flux, 1e-9),
            ("slave_temperature", "Slave", "LAST", upper, 1e-9),
            ("U2", "Top", "LAST", 4.0 * (1e-5 * mean - 20.0 / 1000.0), 1e-9),
            ("NT", "Top", 0.5, 50.0, 1e-12)]


@pytest.mark.parametrize("kind", ["CPE4T", "CPE4RT", "CPE4RHT", "CPE4I"])
def test_a_flat_deck_of_abaqus_cae(tmp_path, kind):
    cards = [card.replace("CPE4T", kind) for card in cards_of("abaqus_cae_flat.inp")]
    judge(tmp_path, cards, pressed_and_heated())


def test_a_deck_of_abaqus_cae_with_parts(tmp_path):
    judge(tmp_path, cards_of("abaqus_cae_parts.inp"), pressed_and_heated())


def test_a_deck_of_prepomax(tmp_path):
    """A sheet pulled by 10: strain 0.01, nu = 0.25."""
    judge(tmp_path, cards_of("prepomax.inp"), [
        ("U1", "Node_Set-1", "LAST", 0.02, 1e-9), ("S11", "MIN", "LAST", 10.0, 1e-9),
        ("U2", "MIN", "LAST", -0.0025, 1e-9)])


def test_a_deck_of_freecad(tmp_path):
    """A strip, 10 high and 2 thick, pulled by 60: sigma = 3, strain 0.003 over 20."""
    judge(tmp_path, cards_of("freecad.inp"), [
        ("U1", "3", "LAST", 0.06, 1e-9), ("S11", "MAX", "LAST", 3.0, 1e-9)])


def test_a_deck_of_gmsh(tmp_path):
    judge(tmp_path, cards_of("gmsh.inp"), [("S11", "MIN", "LAST", 10.0, 1e-9)])


@pytest.mark.parametrize("name", sorted(path.name for path in FOREIGN.glob("*.inp")))
def test_it_is_sound_as_it_is(name):
    process = run("check", FOREIGN / name)
    assert process.returncode == 0, process.stderr
    assert "error" not in process.stderr


def corner_grid(columns, rows):
    """Return the cards of the corners of a grid of unit squares, numbered by tens upwards."""
    return ["*NODE", "1, 0., 0.", f"{columns + 1}, {columns}., 0.",
            f"{10 * rows + 1}, 0., {rows}.", f"{10 * rows + columns + 1}, {columns}., {rows}."]


def generated_grid(columns=3, rows=2):
    """Return the cards of a grid of unit squares, generated."""
    right = columns + 1
    return [*corner_grid(columns, rows), "*NGEN, NSET=LEFT", f"1, {10 * rows + 1}, 10",
            "*NGEN, NSET=RIGHT", f"{right}, {10 * rows + right}, 10", "*NGEN, NSET=GRID",
            *[f"{10 * j + 1}, {10 * j + right}" for j in range(rows + 1)],
            "*ELEMENT, TYPE=CPE4", "7, 1, 2, 12, 11",
            "*ELGEN, ELSET=GRID", f"7, {columns}, 1, 1, {rows}, 10, 100"]


def listed_grid(columns=3, rows=2):
    """Return the same cards, written out."""
    numbers = {(i, j): 10 * j + i + 1 for j in range(rows + 1) for i in range(columns + 1)}
    cards = ["*NODE, NSET=GRID", *[f"{n}, {i}., {j}." for (i, j), n in numbers.items()]]
    for name, column in (("LEFT", 0), ("RIGHT", columns)):
        cards += [f"*NSET, NSET={name}", *[str(numbers[column, j]) for j in range(rows + 1)]]
    cards += ["*ELEMENT, TYPE=CPE4, ELSET=GRID"]
    return cards + [
        f"{7 + i + 100 * j}, {numbers[i, j]}, {numbers[i + 1, j]}, {numbers[i + 1, j + 1]}, "
        f"{numbers[i, j + 1]}" for j in range(rows) for i in range(columns)]


def stretched(mesh):
    """Return a deck that stretches a grid along x and shifts one node."""
    return [*mesh, *material("GRID"), "*BOUNDARY", "LEFT, ENCASTRE", "RIGHT, 1, 1, 0.01",
            "13, 2, 2, 0.02", "*STEP", "*STATIC", "*NODE PRINT, NSET=GRID", "U, RF",
            "*EL PRINT, ELSET=GRID", "S", "*END STEP"]


@pytest.mark.changes("NGEN", "NGEN, NSET", "ELGEN", "ELGEN, ELSET")
def test_a_generated_mesh_is_the_mesh_that_is_written_out(tmp_path):
    decks = stretched(generated_grid()), stretched(listed_grid())
    note_changes(*decks)
    one, other = (thercon(write(tmp_path / f"{name}.inp", deck))
                  for name, deck in zip(("generated", "listed"), decks, strict=True))
    assert one == other
    assert len(one[1.0, "U1"]) == 12
    assert len({element for element, _ in one[1.0, "S11"]}) == 6


def test_nodes_are_generated_at_equal_distances_on_a_line(tmp_path):
    """The strain of a bar is the same everywhere."""
    cards = [*generated_grid(7, 3), *material("GRID", (1000.0, 0.0)), "*BOUNDARY", "GRID, 2",
             "LEFT, 1", "RIGHT, 1, 1, 0.07", "*STEP", "*STATIC", "*END STEP"]
    judge(tmp_path, cards, [("S11", "MAX", "LAST", 10.0, 1e-13), ("U1", "14", "LAST", 0.03, 1e-13),
                            ("S11", "MIN", "LAST", 10.0, 1e-13)])


def quarter(cards, middle):
    """Return a deck that presses a ring of four elements, a quarter of it given; `middle` makes the
    rest."""
    return [*cards, *middle, *material("RING", (1000.0, 0.3)), "*BOUNDARY", "INNER, 1, 2", "*STEP",
            "*STATIC", "*CLOAD", "OUTER, 1, 1.", "OUTER, 2, -0.5", "*NODE PRINT, NSET=OUTER", "U, RF",
            "*EL PRINT, ELSET=RING", "S", "*END STEP"]


def ring_nodes(radii=(1.0, 1.4, 2.0), angles=(0.0, 45.0, 90.0, 135.0, 180.0)):
    """Return the places of the nodes of a half ring: 100 for each angle, 1 for each radius."""
    return {100 * k + i + 1: (radius * math.cos(math.radians(angle)),
                              radius * math.sin(math.radians(angle)))
            for k, angle in enumerate(angles) for i, radius in enumerate(radii)}


def written_ring(radii):
    """Return the cards of the half ring, written out."""
    places = ring_nodes(radii)
    rows = [f"{n}, {x!r}, {y!r}" for n, (x, y) in places.items()]
    ends = [(name, [100 * k + i for k in range(5)]) for name, i in (("INNER", 1), ("OUTER", 3))]
    sets = [card for name, nodes in ends for card in
            (f"*NSET, NSET={name}", ", ".join(map(str, nodes)))]
    elements = [f"{10 * k + i}, {100 * k + i}, {100 * k + i + 1}, {100 * k + 101 + i}, "
                f"{100 * k + 100 + i}" for k in range(4) for i in (1, 2)]
    return ["*NODE", *rows, *sets, "*ELEMENT, TYPE=CPE4, ELSET=RING", *elements]


def copied_ring(bias, change="200"):
    """Return the cards of the half ring: nodes filled in, and a quarter turned or reflected."""
    ends = {n: x for n, x in ring_nodes().items() if n < 300 and n % 100 != 2}
    rows = [f"{n}, {x!r}, {y!r}" for n, (x, y) in ends.items()]
    fill = ["*NODE", *rows, "*NSET, NSET=INNER, GENERATE", "1, 201, 100", "*NSET, NSET=OUTER",
            "3, 103, 203", f"*NFILL, NSET=FIRST, BIAS={bias!r}", "INNER, OUTER, 2, 1",
            "*ELEMENT, TYPE=CPE4, ELSET=RING", "1, 1, 2, 102, 101", "2, 2, 3, 103, 102",
            "11, 101, 102, 202, 201", "12, 102, 103, 203, 202"]
    turn = [f"*NCOPY, OLD SET=FIRST, CHANGE NUMBER={change}, NEW SET=SECOND, SHIFT, MULTIPLE=2",
            "0., 0., 0.", "0., 0., 0., 0., 0., 1., 45."]
    return fill, [*turn, "*NSET, NSET=INNER", "301, 401", "*NSET, NSET=OUTER", "303, 403",
                  f"*ELCOPY, OLD SET=RING, ELEMENT SHIFT=20, SHIFT NODES={change}, NEW SET=RING"]


def assert_same_tables(tmp_path, one, other):
    """Assert that two decks print the same."""
    found = [thercon(write(tmp_path / f"{name}.inp", deck))
             for name, deck in zip(("one", "other"), (one, other), strict=True)]
    assert found[0].keys() == found[1].keys()
    for key, values in found[0].items():
        assert values == pytest.approx(found[1][key], rel=1e-5, abs=1e-9), key


@pytest.mark.changes("NFILL", "NFILL, BIAS", "NCOPY", "NCOPY, MULTIPLE")
@pytest.mark.parametrize("bias", [1.0, 2.0 / 3.0])
def test_a_mesh_of_filled_and_turned_nodes_is_the_one_that_is_written_out(tmp_path, bias):
    """Of a bias of 2/3 the first of two distances is 2/5 of the whole."""
    middle = 1.0 + 1.0 * bias / (1.0 + bias)
    fill, copies = copied_ring(bias)
    note_changes(copied_ring(1.0)[0], copied_ring(2.0 / 3.0)[0])
    note_changes(fill, [card.replace("OUTER, 2, 1", "OUTER, 4, 1") for card in fill])
    note_changes(copies, [card.replace("MULTIPLE=2", "MULTIPLE=3").replace("45.", "30.")
                          for card in copies])
    thrice = [card.replace("MULTIPLE=2", "MULTIPLE=3").replace("45.", "30.") for card in copies]
    whole = quarter(written_ring((1.0, middle, 2.0)), [])
    for made in (copies, thrice):
        assert_same_tables(tmp_path, quarter(fill, made), whole)


@pytest.mark.changes("NFILL, NSET", "NCOPY, REFLECT", "NCOPY, SHIFT", "NCOPY, OLD SET",
                     "NCOPY, NEW SET", "NCOPY, CHANGE NUMBER", "ELCOPY, OLD SET",
                     "ELCOPY, NEW SET", "ELCOPY, ELEMENT SHIFT", "ELCOPY, SHIFT NODES",
                     "ELCOPY, REFLECT")
def test_a_reflected_mesh_is_the_one_that_is_written_out(tmp_path):
    """Reflected at the line x = 0, elements whose nodes go round the other way are sound."""
    fill, turned = copied_ring(1.0)
    fill = [card.replace("FIRST", "WHOLE") for card in fill]
    reflected = ["*NCOPY, OLD SET=WHOLE, CHANGE NUMBER=1000, NEW SET=MIRROR, REFLECT=LINE",
                 "0., 0., 0., 0., 1., 0.",
                 "*ELCOPY, OLD SET=RING, ELEMENT SHIFT=500, SHIFT NODES=1000, NEW SET=COPIES, REFLECT"]
    note_changes(fill, copied_ring(1.0)[0])
    note_changes(turned, reflected)
    places = {n: x for n, x in ring_nodes((1.0, 1.5, 2.0)).items() if n < 300}
    given = ["*NODE, NSET=MIRROR", *(f"{1000 + n}, {-x!r}, {y!r}" for n, (x, y) in places.items()),
             "*ELEMENT, TYPE=CPE4, ELSET=COPIES", "501, 1001, 1101, 1102, 1002",
             "502, 1002, 1102, 1103, 1003", "511, 1101, 1201, 1202, 1102",
             "512, 1102, 1202, 1203, 1103"]
    ends = ["*NSET, NSET=INNER", "1001, 1101, 1201", "*NSET, NSET=OUTER", "1003, 1103, 1203",
            "*ELSET, ELSET=RING", "COPIES"]
    assert_same_tables(tmp_path, quarter(fill, reflected + ends), quarter(fill, given + ends))
    halves = ["*ELSET, ELSET=FEW", "1, 2", "*ELSET, ELSET=OTHERS", "11, 12",
              *(card.replace("OLD SET=RING", f"OLD SET={name}") for name in ("FEW", "OTHERS")
                for card in reflected[2:])]
    note_changes(halves[4:5], halves[5:6])
    assert_same_tables(tmp_path, quarter(fill, reflected[:2] + halves + ends),
                       quarter(fill, given + ends))


def test_pairs_without_names_may_share_a_slave_surface(tmp_path):
    """A block on two others: each carries its half."""
    cards = [*mesh("UP", [0.0, 1.0, 3.0], [0.0, 0.5]), *mesh("A", [0.0, 1.0], [-1.0, 0.0], first=101),
             *mesh("B", [1.0, 3.0], [-1.0, 0.0], first=201), "*SURFACE INTERACTION, NAME=DRY"]
    for name in ("UP", "A", "B"):
        cards += material(name, (1000.0, 0.0), 1e-5)
    for name in ("A", "B"):
        cards += ["*CONTACT PAIR, INTERACTION=DRY", f"UP.BOTTOM, {name}.TOP"]
    cards += ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "A.BOTTOM, 1, 2", "B.BOTTOM, 1, 2",
              "UP.LEFT, 1", "*DSLOAD", "UP.TOP, P, 5.", "*END STEP"]
    judge(tmp_path, cards, [("normal_force", "UP.BOTTOM", "LAST", 5.0, 1e-9),
                            ("normal_force", "UP.BOTTOM-B.TOP", "LAST", 10.0, 1e-9)])


@pytest.mark.changes("NGEN, LINE")
@pytest.mark.parametrize("center", ["", "400", ", 0., 0., 0.", ", 0., 0., 0., 0., 0., 1."])
def test_nodes_on_a_circle_are_those_that_are_written_out(tmp_path, center):
    """Half a turn goes anticlockwise about the normal z; elsewhere the shorter way. The origin is
    the center of a card without one."""
    half = "0., 0., 1." in center
    places, given = ring_nodes((1.0, 1.5, 2.0)), []
    if not half:   # the same nodes, from a quarter each
        spans = [(1, 201), (201, 401)]
    else:
        spans = [(1, 401)]
    nodes = [n for n in places if n % 100 in (1, 3) and any(n - i in span for i in (0, 2)
                                                           for span in spans)]
    given = ["*NODE", "400, 0., 0.", *(f"{n}, {places[n][0]!r}, {places[n][1]!r}" for n in nodes),
             "*NGEN, LINE=C, NSET=INNER", *(f"{a}, {b}, 100, {center}" for a, b in spans),
             "*NGEN, LINE=C, NSET=OUTER", *(f"{a + 2}, {b + 2}, 100, {center}" for a, b in spans),
             "*NFILL", "INNER, OUTER, 2"]
    note_changes(given, [card.replace(", LINE=C", "") for card in given])
    elements = written_ring((1.0, 1.5, 2.0))
    elements = elements[elements.index("*ELEMENT, TYPE=CPE4, ELSET=RING"):]
    assert_same_tables(tmp_path, quarter(given, elements), quarter(written_ring((1.0, 1.5, 2.0)), []))
