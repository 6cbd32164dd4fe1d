"""What the cards of a model change: two values of each, with answers that are known."""

import math

import h5py
import pytest
from blocks import write
from changes import note_changes
from deck_runs import run, solve
from physics import follows, judge, material, mesh, nodes_of, verify
from test_physics_loads import bar, block, heat, static, stressed

YOUNG, SMALL = 1000.0, 1e-9


# Text around the model.

def test_parameter_is_a_number_a_name_or_a_part(tmp_path):
    deck = block("*PARAMETER", "load = 5., where = BODY, side = TOP, kind = MUMPS",
                 "*SOLVER, TYPE=<kind>", *static("*DSLOAD", "<where>.<SIDE>, P, <load>"))
    judge(tmp_path, deck, stressed([0.0, -5.0, 0.0]))


def test_parameter_is_arithmetic(tmp_path):
    """Of earlier parameters, text among them; it follows one that the command line overrides."""
    deck = block("*PARAMETER", "base = 2., solid = BODY, where = solid, file = ../a-1.inc",
                 "load = (sqrt(base*8) + 1)**2/5 - 2**-1*0, levels = 4/2 - 1",
                 "*REFINE, LEVELS=<levels>", *static("*DSLOAD", "<where>.TOP, P, <load>"))
    result = judge(tmp_path, deck, stressed([0.0, -5.0, 0.0]))
    with h5py.File(result) as file:
        assert "uniform refinements" in (tmp_path / "deck.lst").read_text()
        assert file["run"].attrs["verify_failed"] == 0
    load = (math.sqrt(4.5 * 8) + 1) ** 2 / 5
    write(tmp_path / "other.inp", deck, verify(*stressed([0.0, -load, 0.0])))
    process = run("run", "--quiet", tmp_path / "other.inp", "--out", tmp_path, "--set", "base=4.5")
    assert process.returncode == 0, process.stderr


@pytest.mark.changes("PARAMETER")
def test_value_of_a_parameter(tmp_path):
    """Defined among others; overridden on the command line it gives the other deck's values."""
    def make(value):
        return block("*PARAMETER", f"other = 1., load = {value!r}", *static(
            "*DSLOAD", "BODY.TOP, P, <load>")), stressed([0.0, -value, 0.0])

    follows(tmp_path, make, 5.0, 4.0)
    deck = write(tmp_path / "crossed.inp", make(5.0)[0], verify(*make(4.0)[1]))
    for setting, status in (("LOAD=4.", 0), ("load=5.", 4)):
        process = run("run", "--quiet", deck, "--out", tmp_path, "--set", setting)
        assert process.returncode == status, process.stderr


@pytest.mark.changes("INCLUDE, INPUT")
def test_included_file_is_the_one_named(tmp_path):
    for value in (5.0, 4.0):
        write(tmp_path / f"load{value:g}.inc", [f"BODY.TOP, P, {value!r}"])
    follows(tmp_path, lambda value: (
        block(*static("*DSLOAD", f"*INCLUDE, INPUT=load{value:g}.inc")),
        stressed([0.0, -value, 0.0])), 5.0, 4.0)


def test_included_file_stands_beside_the_deck_or_in_the_current_folder(tmp_path):
    """Beside the deck comes first."""
    (tmp_path / "decks").mkdir()
    (tmp_path / "here").mkdir()
    deck = write(tmp_path / "decks" / "deck.inp",
                 block(*static("*DSLOAD", "*INCLUDE, INPUT=load.inc")),
                 verify(*stressed([0.0, -5.0, 0.0])))
    for folder, value in (("here", 5.0), ("decks", 4.0)):
        write(tmp_path / folder / "load.inc", [f"BODY.TOP, P, {value!r}"])
        process = run("run", "--quiet", deck, folder=tmp_path / "here")
        assert process.returncode == (0 if folder == "here" else 4), process.stderr


@pytest.mark.changes("HEADING")
def test_heading_is_the_title_of_the_listing(tmp_path):
    decks = [["*HEADING", title, "second line", *block(*static("*DSLOAD", "BODY.TOP, P, 5."))]
             for title in ("Of steel", "Of brass")]
    for deck, title in zip(decks, ("Of steel", "Of brass"), strict=True):
        solve(write(tmp_path / "deck.inp", deck))
        listing = (tmp_path / "deck.lst").read_text().splitlines()
        assert [line.split(maxsplit=1)[1] for line in listing if line.startswith("heading")] \
            == [title]
    note_changes(*decks)


@pytest.mark.changes("OPTIONS, UNITS")
def test_units_label_the_result(tmp_path):
    """And convert nothing."""
    decks = [[f'*OPTIONS, UNITS="{units}"', *block(*static("*DSLOAD", "BODY.TOP, P, 5."))]
             for units in ("cm MPa W C", "m Pa kW K", "mm MPa")]
    labels = ("cm", "MPa", "W", "C"), ("m", "Pa", "kW", "K"), ("mm", "MPa", "", "")
    for deck, words in zip(decks, labels, strict=True):
        with h5py.File(judge(tmp_path, deck, stressed([0.0, -5.0, 0.0]))) as file:
            found = [file["run"].attrs[f"unit_{name}"]
                     for name in ("length", "stress", "power", "temperature")]
        assert [text.decode() if isinstance(text, bytes) else text for text in found] == list(words)
    note_changes(*decks[:2])


@pytest.mark.changes("OPTIONS, WIDTH")
def test_width_of_a_card(tmp_path):
    """257 columns are one too many for the width of all decks."""
    load = "BODY.TOP, P," + " " * 243 + "5."
    assert len(load) == 257
    decks = [[f"*OPTIONS, WIDTH={width}", *block(*static("*DSLOAD", load)),
              *verify(*stressed([0.0, -5.0, 0.0]))] for width in (257, 256)]
    for deck, status in zip(decks, (0, 1), strict=True):
        process = run("run", "--quiet", write(tmp_path / "deck.inp", deck), "--out", tmp_path)
        assert process.returncode == status, process.stderr
        assert (":257: error: text past column 256" in process.stderr) == (status == 1)
    note_changes(*decks)


@pytest.mark.changes("OPTIONS, LOAD")
@pytest.mark.parametrize(("one", "other"), [("BODY.TOP,2", "BODY.RIGHT,1"), ("BODY.TOP,2",
                                            "BODY.TOP,1"), ("BODY.TOP,2", "BODY.TOP,11")])
def test_load_axis_follows_a_prescribed_value(tmp_path, one, other):
    values = {"BODY.TOP,2": 0.002, "BODY.RIGHT,1": -0.003, "BODY.TOP,1": 0.001, "BODY.TOP,11": 50.0}

    def make(axis):
        deck = [f"*OPTIONS, LOAD={axis}", *block(*[
            "*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.", "*BOUNDARY",
            *(f"{place.split(',')[0]}, {dof}, {dof}, {value!r}" for place, value in values.items()
              for dof in [place.split(",")[1]] if place in (one, other)), "BODY.BOTTOM, 11, 11, 0.",
            "*END STEP"])]
        deck.insert(deck.index("*STEP"), "*INITIAL CONDITIONS, TYPE=TEMPERATURE")
        deck.insert(deck.index("*STEP"), "BODY, 0.")
        at = next(k for k, card in enumerate(deck) if card.startswith("*SOLID"))
        deck[at:at] = ["*CONDUCTIVITY", "1."]
        return deck, [("load", "", 0.5, values[axis] / 2, 1e-12),
                      ("load", "", 1.0, values[axis], 1e-12)]

    follows(tmp_path, make, one, other)


@pytest.mark.parametrize(("node", "status"), [(11, 0), (77, 1)])
def test_load_axis_follows_a_node(tmp_path, node, status):
    deck = write(tmp_path / "deck.inp", [f"*OPTIONS, LOAD={node},1", *strip(), *material("BODY", (
        1000.0, 0.0)), "*BOUNDARY", "1, 1, 2", "11, 2", "*STEP", "*STATIC", "0.5, 1.",
        "*BOUNDARY", "11, 1, 1, 0.004", "*END STEP"])
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == status, process.stderr
    if status:
        assert "error: there is no node 77" in process.stderr
        return
    with h5py.File(tmp_path / "deck.vtkhdf") as file:
        assert list(file["history/load"]) == pytest.approx([0.002, 0.004], rel=1e-12)
        assert file["history/load"].attrs["label"] == "u_x of 11"


# Meshes.

def strip(length=2.0, kind="CPS4", more=()):
    """Return four elements in a row, 1 to 4, the nodes 1 to 5 below and 11 to 15 above; the last
    element is longer."""
    nodes = [f"{n + 10 * k}, {x!r}, {y!r}" for k, y in enumerate((0.0, 1.0))
             for n, x in enumerate((0.0, 1.0, 2.0, 3.0, 3.0 + length), 1)]
    elements = [f"{n}, {n}, {n + 1}, {n + 11}, {n + 10}" for n in range(1, 5)]
    return ["*NODE, NSET=BODY", *nodes, *more, f"*ELEMENT, TYPE={kind}, ELSET=BODY", *elements]


PULL = ["*BOUNDARY", "1, 1, 2", "11, 1", "*CLOAD"]


@pytest.mark.changes("NODE")
def test_coordinates_of_a_node(tmp_path):
    """A bar is stretched in proportion to its length and against its height."""
    def make(size):
        length, height = size
        cards = mesh("BODY", [0.0, length], [0.0, height], "CPS4")
        force = [f"{n}, 1, 3." for n, (x, _) in nodes_of(cards).items() if x > 0.0]
        return [*cards, *material("BODY", (YOUNG, 0.3)), *static(
            "*BOUNDARY", "BODY.LEFT, 1", "BODY.BOTTOM, 2", "*CLOAD", *force)], [
            ("U1", "BODY.RIGHT", "LAST", 6.0 / height / YOUNG * length, SMALL),
            ("S11", "BODY", "LAST", 6.0 / height, SMALL)]

    follows(tmp_path, make, (2.0, 1.0), (2.5, 1.0))
    follows(tmp_path, make, (2.0, 1.0), (2.0, 1.2))


@pytest.mark.changes("ELEMENT")
def test_nodes_of_an_element(tmp_path):
    """The last element of a strip ends at one of two pairs of nodes."""
    def make(last):
        far = {6: 3.5, 7: 4.5}
        more = [f"{n + 10 * k}, {x!r}, {y!r}" for k, y in enumerate((0.0, 1.0))
                for n, x in far.items()]
        deck = strip(more=more)
        deck[-1] = f"4, 4, {last}, {last + 10}, 14"
        return [*deck, *material("BODY", (YOUNG, 0.0)), *static(
            *PULL, f"{last}, 1, 1.", f"{last + 10}, 1, 1.")], [
            ("U1", 4, "LAST", 2.0 / YOUNG * 3.0, SMALL), ("S11", 4, "LAST", 2.0, SMALL),
            ("U1", last, "LAST", 2.0 / YOUNG * far[last], SMALL)]

    (cards, checks), (other, other_checks) = make(6), make(7)
    note_changes(cards, other)
    judge(tmp_path, cards, checks, name="one")
    judge(tmp_path, other, other_checks, name="other")
    # The nodes that the other deck loads belong to no element here.
    judge(tmp_path, cards, other_checks, status=1, name="crossed")


@pytest.mark.changes("ELEMENT, TYPE")
@pytest.mark.parametrize(("one", "other"), [("CPE8", "CPS8"), ("CPE4", "CPS4"), ("CPE8R", "CPS8R"),
                                            ("CPE6", "CPS6"), ("CPE3", "CPS3"), ("CPE4", "CAX4")])
def test_plane_of_a_type_of_element(tmp_path, one, other):
    """A square about x = 1.5 pressed on top: S33 by its plane; of a ring the stress is uniform."""
    def make(kind):
        cards = mesh("BODY", [1.0, 2.0], [0.0, 1.0], kind)
        held = "BODY.BOTTOM, 2" if kind.startswith("CAX") else "BODY.BOTTOM, 2\n1, 1"
        return [*cards, *material("BODY", (YOUNG, 0.3)), *static(
            "*BOUNDARY", *held.splitlines(), "*DSLOAD", "BODY.TOP, P, 10.")], [
            ("S22", "BODY", "LAST", -10.0, SMALL),
            ("S33", "BODY", "LAST", -3.0 if kind.startswith("CPE") else 0.0, SMALL, "ABS"),
            ("S11", "BODY", "LAST", 0.0, SMALL, "ABS")]

    if other.startswith("CAX"):
        (cards, checks), (ring, ring_checks) = make(one), make(other)
        note_changes(cards, ring)
        judge(tmp_path, cards, checks)
        judge(tmp_path, ring, ring_checks)
        judge(tmp_path, ring, checks, status=4)
    else:
        follows(tmp_path, make, one, other)


@pytest.mark.changes("ELEMENT, TYPE")
def test_shape_functions_of_a_type_of_element(tmp_path):
    """A heated wall, one element thick: eight nodes have its parabola, four only its ends."""
    def make(nodes):
        cards = mesh("BODY", [0.0, 2.0], [0.0, 0.5], f"CPE{nodes}")
        deck = [*cards, *material("BODY", conductivity=2.5), *heat(
            "*BOUNDARY", "BODY.LEFT, 11, 11, 20.", "BODY.RIGHT, 11, 11, 50.", "*DFLUX",
            "BODY, BF, 12.")]
        most = 35.0 + 12.0 * 2.0**2 / 8 / 2.5 if nodes == 8 else 50.0
        return deck, [("NT", "MAX", "LAST", max(most, 50.0), SMALL),
                      ("HFL1", "BODY.LEFT", "LAST", -2.5 * (30.0 / 2.0 + (
                          12.0 * 2.0 / 2 / 2.5 if nodes == 8 else 0.0)), SMALL)]

    follows(tmp_path, make, 8, 4)


def warm(*cards, of):
    """Return a strip that is held, with a set of nodes at 50, and its temperatures."""
    deck = [*strip(), *material("BODY", (YOUNG, 0.3)), *cards, *static(
        "*BOUNDARY", "BODY, 1, 2", "*TEMPERATURE", "SOME, 50.")]
    numbers = [n + k for k in (0, 10) for n in range(1, 6)]
    return deck, [("NT", n, "LAST", 50.0 if n in of else 0.0, 1e-12, "ABS") for n in numbers]


def pushed(*cards, of):
    """Return a strip that is held, with a set of elements pushed, and its reactions: a quarter of
    the force on an element at each of its nodes."""
    deck = [*strip(length=1.0), *material("BODY", (YOUNG, 0.3)), *cards, *static(
        "*BOUNDARY", "BODY, 1, 2", "*DLOAD", "SOME, BX, 8.")]
    rows = []
    for n in range(1, 6):
        touching = sum(e in of for e in (n - 1, n))
        rows += [("RF1", n + k, "LAST", -2.0 * touching, SMALL, "ABS") for k in (0, 10)]
    return deck, rows


SETS = {"NSET": warm, "ELSET": pushed}


@pytest.mark.parametrize("keyword", [pytest.param(k, marks=pytest.mark.changes(k)) for k in SETS])
@pytest.mark.parametrize(("one", "other"), [
    (("1, 2", {1, 2}), ("1, 3", {1, 3})), (("PART, 4", {2, 3, 4}), ("PART", {2, 3}))])
def test_members_of_a_set(tmp_path, keyword, one, other):
    def make(members):
        data, numbers = members
        return SETS[keyword](f"*{keyword}, {keyword}=PART", "2, 3",
                             f"*{keyword}, {keyword}=SOME", *data.splitlines(), of=numbers)

    follows(tmp_path, make, one, other)


@pytest.mark.parametrize("keyword", SETS)
def test_a_set_of_several_cards(tmp_path, keyword):
    judge(tmp_path, *SETS[keyword](f"*{keyword}, {keyword}=SOME", "1", f"*{keyword}, "
                                   f"{keyword}=OTHER", "2", f"*{keyword}, {keyword}=SOME", "3, 4",
                                   of={1, 3, 4}))


@pytest.mark.parametrize("keyword", [pytest.param(k, marks=pytest.mark.changes(f"{k}, GENERATE"))
                                     for k in SETS])
def test_a_set_that_is_generated(tmp_path, keyword):
    """1, 4, 2 is three members without GENERATE."""
    follows(tmp_path, lambda option: SETS[keyword](
        f"*{keyword}, {keyword}=SOME{option}", "1, 4, 2", of={1, 3} if option else {1, 2, 4}),
        "", ", GENERATE")


@pytest.mark.parametrize("keyword", [pytest.param(k, marks=pytest.mark.changes(k)) for k in SETS])
@pytest.mark.parametrize(("one", "other"), [
    (("1, 3", {1, 2, 3}), ("2, 3", {2, 3})), (("1, 3", {1, 2, 3}), ("1, 4", {1, 2, 3, 4})),
    (("1, 4, 1", {1, 2, 3, 4}), ("1, 4, 3", {1, 4})),
    (("1, 2", {1, 2}), ("1, 2\n4, 4", {1, 2, 4}))])
def test_first_last_and_increment_of_a_set(tmp_path, keyword, one, other):
    def make(members):
        data, numbers = members
        return SETS[keyword](f"*{keyword}, {keyword}=SOME, GENERATE", *data.splitlines(),
                             of=numbers)

    follows(tmp_path, make, one, other)


@pytest.mark.changes("SURFACE")
def test_face_of_a_surface(tmp_path):
    """One element between smooth walls; a pressure on the face named."""
    cards = mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS4")

    def make(face):
        deck = [*cards, *material("BODY", (YOUNG, 0.0)), "*SURFACE, NAME=FACE", f"BODY, S{face}",
                *static("*BOUNDARY", "BODY.BOTTOM, 2", "BODY.LEFT, 1", "*DSLOAD", "FACE, P, 10.")]
        return deck, [("S11", "BODY", "LAST", -10.0 * (face == 2), SMALL, "ABS"),
                      ("S22", "BODY", "LAST", -10.0 * (face == 3), SMALL, "ABS")]

    follows(tmp_path, make, 2, 3)


@pytest.mark.changes("SURFACE")
def test_elements_of_a_surface(tmp_path):
    """An element or a set of them, pushed along x by a traction."""
    def make(elements):
        deck = [*strip(length=1.0), *material("BODY", (YOUNG, 0.3)), "*ELSET, ELSET=SOME", "1, 2",
                "*SURFACE, NAME=LOADED", *(f"{e}, S3" for e in elements), *static(
                    "*BOUNDARY", "BODY, 1, 2", "*DSLOAD", "LOADED, TRVEC, 4., 1., 0., 0.")]
        of = {1, 2} if "SOME" in elements else set(elements)
        return deck, [("RF1", n + 10, "LAST", -2.0 * sum(e in of for e in (n - 1, n)), SMALL,
                       "ABS") for n in range(1, 6)]

    follows(tmp_path, make, [1], [2])
    follows(tmp_path, make, ["SOME"], [1])


# Sections.

@pytest.mark.changes("SOLID SECTION")
def test_thickness_of_a_section_scales_heat_and_areas(tmp_path):
    """And no temperature."""
    def make(thickness):
        deck = [*mesh("UP", [0.0, 1.0], [0.0, 0.5]), *mesh("LOW", [0.0, 1.0], [-0.5, 0.0],
                                                           first=101)]
        for name in ("UP", "LOW"):
            deck += [*material(name, conductivity=2.5), f"{thickness!r}"]
        deck += ["*SURFACE INTERACTION, NAME=FACES", "*GAP LAW, TYPE=POWER", "10., 0., 1.",
                 "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "UP.BOTTOM, LOW.TOP"]
        flux = 80.0 / (0.2 + 0.1 + 0.2)
        return [*deck, *heat("*BOUNDARY", "UP.TOP, 11, 11, 80.", "LOW.BOTTOM, 11")], [
            ("heat_in", "", "LAST", flux * thickness, SMALL),
            ("heat_rate", "FACE", "LAST", flux * thickness, SMALL),
            ("heat_flux", "FACE", "LAST", flux, SMALL),
            ("weight", "MAX", "LAST", 4 / 6 * thickness, SMALL)]

    follows(tmp_path, make, 1.0, 0.3)


def test_of_two_sections_the_later_one_holds(tmp_path):
    cards = mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS4")
    for order in ((900.0, 1000.0), (1000.0, 900.0)):
        deck = [*cards, *material("BODY", (order[0], 0.0)), "*MATERIAL, NAME=LATER", "*ELASTIC",
                f"{order[1]!r}, 0.", "*SOLID SECTION, ELSET=BODY, MATERIAL=LATER", *static(
                    "*BOUNDARY", "BODY.BOTTOM, 2", "BODY.LEFT, 1", "BODY.TOP, 2, 2, 0.001")]
        judge(tmp_path, deck, [("S22", "BODY", "LAST", order[1] * 0.001, SMALL)])
        process = run("check", tmp_path / "deck.inp")
        assert "warning: this section replaces an earlier one" in process.stderr


# Materials.

@pytest.mark.changes("ELASTIC")
@pytest.mark.parametrize("other", [(1100.0, 0.3), (1000.0, 0.25)])
def test_isotropic_elasticity(tmp_path, other):
    """Stretched by 0.001 between smooth ends, free aside, in plane strain."""
    def make(values):
        young, poisson = values
        stress = 0.001 * young / (1 - poisson**2)
        cards = mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPE8")
        return [*cards, *material("BODY", values), *static(
            "*BOUNDARY", "BODY.BOTTOM, 2", "BODY.LEFT, 1", "BODY.TOP, 2, 2, 0.001")], [
            ("S22", "BODY", "LAST", stress, SMALL), ("S33", "BODY", "LAST", poisson * stress,
                                                     SMALL),
            ("U1", "BODY.RIGHT", "LAST", -0.001 * poisson / (1 - poisson), SMALL)]

    follows(tmp_path, make, (1000.0, 0.3), other)


@pytest.mark.changes("EXPANSION")
def test_isotropic_expansion(tmp_path):
    def make(expansion):
        cards = mesh("BODY", [0.0, 2.0], [0.0, 3.0], "CPS8")
        return [*cards, *material("BODY", (YOUNG, 0.3), expansion), *static(
            "*BOUNDARY", "BODY.BOTTOM, 2", "BODY.LEFT, 1", "*TEMPERATURE", "BODY, 40.")], [
            ("U1", "BODY.RIGHT", "LAST", 80.0 * expansion, SMALL),
            ("U2", "BODY.TOP", "LAST", 120.0 * expansion, SMALL)]

    follows(tmp_path, make, 1e-5, 1.2e-5)


@pytest.mark.changes("EXPANSION", "EXPANSION, TYPE")
def test_type_of_expansion(tmp_path):
    """Behind the one coefficient of ISO stands a temperature."""
    def make(values):
        kind, data, moved = values
        cards = mesh("BODY", [0.0, 2.0], [0.0, 3.0], "CPS8")
        return [*cards, *material("BODY", (YOUNG, 0.3), data, expansion_type=kind), *static(
            "*BOUNDARY", "BODY.BOTTOM, 2", "BODY.LEFT, 1", "*TEMPERATURE", "BODY, 40.")], [
            ("U1", "BODY.RIGHT", "LAST", 80.0 * moved[0], SMALL),
            ("U2", "BODY.TOP", "LAST", 120.0 * moved[1], SMALL)]

    follows(tmp_path, make, ("ISO", (1e-5, 2e-5), (1e-5, 1e-5)),
            ("ORTHO", (1e-5, 2e-5, 0.0), (1e-5, 2e-5)))


@pytest.mark.changes("CONDUCTIVITY")
def test_isotropic_conductivity(tmp_path):
    def make(conductivity):
        cards = bar(*heat("*BOUNDARY", "BODY.LEFT, 11, 11, 20.", "*DFLUX", "2, S2, 10."))
        at = cards.index("*CONDUCTIVITY") + 1
        cards[at] = f"{conductivity!r}"
        return cards, [("NT", "BODY.RIGHT", "LAST", 20.0 + 10.0 * 2.0 / conductivity, SMALL)]

    follows(tmp_path, make, 2.5, 2.0)


@pytest.mark.changes("CONDUCTIVITY", "CONDUCTIVITY, TYPE")
def test_type_of_conductivity(tmp_path):
    """Behind the one conductivity of ISO stands a temperature."""
    def make(values):
        kind, data, across = values
        cards = mesh("BODY", [0.0, 2.0], [0.0, 3.0])
        return [*cards, *material("BODY", conductivity=data, conductivity_type=kind), *heat(
            "*BOUNDARY", "BODY.BOTTOM, 11, 11, 20.", "*DFLUX", "1, S3, 10.")], [
            ("NT", "BODY.TOP", "LAST", 20.0 + 10.0 * 3.0 / across, SMALL)]

    follows(tmp_path, make, ("ISO", (2.5, 1.5), 2.5), ("ORTHO", (2.5, 1.5, 1.0), 1.5))
