"""Decks that can be solved but may not be meant so are warned of, others are not."""

import re

import pytest
from blocks import block, solid, without_unused_surfaces, write
from changes import note_changes
from deck_runs import run
from physics import nodes_of

XS = [0.0, 1.0, 2.0, 3.0, 4.0]


def blocks(shift=0.0, gap=0.0, thickness=("1.", "1."), pair="B.BOTTOM, A.TOP", clearance=None):
    """Return two blocks, the upper one moved."""
    cards = block("A", XS, [0.0, 1.0, 2.0])
    cards += block("B", [x + shift for x in XS], [2.0 + gap, 3.0 + gap, 4.0 + gap], first=101)
    for name, value in zip("AB", thickness, strict=True):
        cards += [*solid(name, 2e5, 0.3), value]
    cards += ["*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I, NAME=F, PAIRING=NODES", pair]
    slave, master = pair.split(", ")
    if clearance is not None:
        cards += [f"*CLEARANCE, SLAVE={slave}, MASTER={master}, VALUE={clearance!r}"]
    return [*cards, "*BOUNDARY", "A.BOTTOM, 1, 2", "B.LEFT, 1"]


PRESSED = ["*STEP", "*STATIC", "1., 1.", "*DSLOAD", "B.TOP, P, 1.", "*END STEP"]


def warnings(folder, *cards, status=0):
    """Check a deck; return its warnings as (line image, message)."""
    deck = write(folder / "deck.inp", without_unused_surfaces([c for part in cards for c in part]))
    process = run("check", deck)
    assert process.returncode == status, process.stderr
    return re.findall(r"^.*: warning: (.*)\n(.*)$", process.stderr, re.M)


def warnings_of_run(folder, *cards, status=0):
    """Solve a deck; return the warnings of the run, which have no place in the deck."""
    deck = write(folder / "deck.inp", without_unused_surfaces([c for part in cards for c in part]))
    process = run("run", "--quiet", deck, "--out", folder)
    assert process.returncode == status, process.stderr
    found = re.findall(r"^[^:\n]*\.inp: warning: (.*)$", process.stderr, re.M)
    listing = deck.with_suffix(".lst").read_text()
    told = " ".join(listing[listing.rindex("WARNINGS\n"):].split()) if found else ""
    assert all(message in told for message in found)
    return found


def one(found, card):
    """Return the message of the only warning, which stands at a card."""
    assert len(found) == 1, found
    assert found[0][1].startswith(card)
    return found[0][0]


@pytest.mark.parametrize(("shift", "told"), [(0.0, None), (0.02, None), (0.03, "6 %"),
                                             (-0.2, "40 %"), (0.49, "98 %")])
def test_nodes_beside_each_other(tmp_path, shift, told):
    """Node spacing 0.5; a twentieth of it is allowed."""
    found = warnings(tmp_path, blocks(shift), PRESSED)
    if told is None:
        assert found == []
        return
    message = one(found, "*CONTACT PAIR")
    slave, master = ({p: n for n, p in nodes_of(block(*b)).items()}[x, 2.0] for *b, x in (
        ("B", [x + shift for x in XS], [2.0, 3.0, 4.0], 101, shift),
        ("A", XS, [0.0, 1.0, 2.0], 1, 0.0)))
    assert f"contact pair F: slave node {slave} and master node {master} are " in message
    assert float(re.search(r"are offset by (\S+),", message)[1]) == abs(shift)
    assert f"{told} of the node spacing (contact points with more than 5 %: 9)" in message
    assert "moment" in message


def test_an_offset_far_from_the_contact_is_that_of_curved_faces(tmp_path):
    """Half the gap is allowed, as where faces are refused."""
    assert warnings(tmp_path, blocks(0.2, gap=0.41), PRESSED) == []
    assert "40 %" in one(warnings(tmp_path, blocks(0.2, gap=0.39), PRESSED), "*CONTACT PAIR")


def test_warnings_of_pairs_stand_in_the_listing_too(tmp_path):
    deck = write(tmp_path / "deck.inp", blocks(0.2), PRESSED)
    assert "moment of force times offset is lost" in run("run", "--quiet", deck, "--out",
                                                         tmp_path).stderr
    listing = deck.with_suffix(".lst").read_text()
    assert "contact pair F: slave node" in listing[listing.index("WARNINGS"):]


@pytest.mark.parametrize(("gap", "clearance", "told"), [
    (-1.0, None, "1"), (-0.25, None, "0.25"), (-1e-7, None, "1E-7"), (-1e-10, None, None),
    (0.0, None, None), (1e-7, None, None), (-1.0, -1e-3, None)])
def test_bodies_inside_each_other(tmp_path, gap, clearance, told):
    """An overlap within the rounding of coordinates is none."""
    found = warnings(tmp_path, blocks(gap=gap, clearance=clearance), PRESSED)
    if told is None:
        assert found == []
        return
    message = one(found, "*CONTACT PAIR")
    overlap = float(re.search(r"the faces overlap by (\S+) at slave node ", message)[1])
    assert overlap == pytest.approx(float(told), rel=1e-6)


@pytest.mark.parametrize(("gap", "clearance", "told"), [
    (1e3, 0.0, "are 1000 apart "), (-2.5, -1e-3, "overlap by 2.5 "), (1e3, 1e3, None),
    (1.1, 0.05, "are 1.1 apart "), (0.9, 0.0, None), (-0.9, 0.0, None), (0.0, -0.9, None),
    (0.0, -1.1, "overlap by 0 ")])
@pytest.mark.parametrize("pairing", ["NODES", "SURFACES"])
@pytest.mark.parametrize("refine", [[], ["*REFINE, LEVELS=3"]], ids=["coarse", "fine"])
def test_a_clearance_in_place_of_a_long_way(tmp_path, gap, clearance, told, pairing, refine):
    """As where one mesh is in mm and the other in m: the gap of the mesh is off by more than a quarter
    of the face, 4, with sides of 1 or of 1/8."""
    cards = blocks(gap=gap, clearance=clearance)
    found = warnings(tmp_path, [c.replace("PAIRING=NODES", f"PAIRING={pairing}") for c in cards], refine,
                     PRESSED)
    if told is None:
        assert found == []
        return
    message = one(found, "*CONTACT PAIR")
    assert f"the faces {told}at slave node " in message and "*CLEARANCE" in message
    assert "; the face is 4 long" in message


def test_swapped_faces(tmp_path):
    """Top of the upper and bottom of the lower block named as the faces in contact: those that touch
    are not related."""
    found = warnings(tmp_path, blocks(pair="B.TOP, A.BOTTOM"), PRESSED)
    assert "touch at 9 places" in one(found[:1], "")
    assert "overlap by 4" in one(found[1:], "*CONTACT PAIR")


def step(*cards):
    """Return a step of mechanics with the load."""
    return [*PRESSED[:-1], *cards, "*END STEP"]


def test_a_second_value_for_one_degree_of_freedom(tmp_path):
    """The last card of a step holds. What stands before the first step may be replaced there, and
    the same value may be given twice."""
    pushed = ["*BOUNDARY", "B.TOP, 1, 1, 0.", "B.LEFT, 1, 1, 0.1", "B.LEFT, 1, 1, 0.1"]
    found = warnings(tmp_path, blocks(), step(*pushed))
    assert re.fullmatch(r"node \d+: another card of this step gives degree of freedom 1 another "
                        r"value; the last value is used \(1 node\)", one(found, "B.LEFT, 1, 1, 0.1"))
    crossing = ["*BOUNDARY", "A.TOP, 2, 2, 0.", "A, 2, 2, 0.1"]
    assert one(warnings(tmp_path, blocks(), step(*crossing)), "A, ").endswith("is used (9 nodes)")
    assert warnings(tmp_path, blocks(), step("*BOUNDARY", "A.BOTTOM, 1, 2, 0.1")) == []
    assert warnings(tmp_path, blocks(), step("*BOUNDARY", "A.BOTTOM, 1, 2, 0."),
                    step("*BOUNDARY", "A.BOTTOM, 1, 2, 0.1")) == []


def test_a_support_of_no_element(tmp_path):
    orphan = ["*NODE, NSET=LOST", "901, 9., 9.", "902, 9., 8."]
    message = one(warnings(tmp_path, blocks(), orphan, step("*BOUNDARY", "LOST, 1, 2")), "LOST")
    assert message == ("node 901 belongs to no element: what is prescribed there has no effect; "
                       "nodes without one: 2")


def test_loads_that_no_step_solves_for(tmp_path):
    """Mechanics in a deck of heat alone, heat in a deck of mechanics alone."""
    heat = ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY", "A.BOTTOM, 11",
            "B.TOP, 11, 11, 5."]
    cards = blocks()
    at = cards.index("*CONTACT PAIR, INTERACTION=I, NAME=F, PAIRING=NODES")
    cards = [*cards[:at], "*GAP LAW, TYPE=POWER", "0., 1., 1.", *cards[at:]]
    no_use = "without effect: no step from here on solves mechanics"
    for load, what in (("*DSLOAD", "B.TOP, P, 1."), ("*CLOAD", "101, 1, 1."),
                       ("*DLOAD", "B, BX, 1.")):
        assert one(warnings(tmp_path, cards, heat, [load, what, "*END STEP"]), what) \
            == f"a load {no_use}"
    moved = [*heat, "B.TOP, 2, 2, 0.", "B.TOP, 1, 1, 0.1", "*END STEP"]
    assert one(warnings(tmp_path, cards, moved), "B.TOP, 1") == f"a displacement {no_use}"
    flux = step("*DFLUX", "B, BF, 1.")
    assert "solves heat" in one(warnings(tmp_path, cards, flux), "B, BF")
    assert warnings(tmp_path, cards, [*heat, "*END STEP"], PRESSED) == []


@pytest.mark.parametrize(("keyword", "label"), [("*DLOAD", "P3, 1."), ("*DFLUX", "S3, 1."),
                                                ("*FILM", "F3, 20., 1.")])
def test_loads_on_sides_inside_a_body(tmp_path, keyword, label):
    """Elements 101 to 104 are the lower row of the upper block."""
    load = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
            "A.BOTTOM, 11", "B.TOP, 11", keyword]
    for target, said in (("B", "side 3 of element 101 lies inside a body; the load still acts "
                          "there; elements with such a side: 4"),
                         ("102", "side 3 of element 102 lies inside a body; the load still "
                          "acts there")):
        found = warnings(tmp_path, insulated(), [*load, f"{target}, {label}", "*END STEP"])
        assert one(found, target) == said
    assert warnings(tmp_path, insulated(), [*load, f"105, {label}", "*END STEP"]) == []


def test_conductance_that_rounding_leaves_unknown(tmp_path):
    """TOL below what a few units in the last place of the displacements change in omega."""
    cards = blocks()
    at = cards.index("*CONTACT PAIR, INTERACTION=I, NAME=F, PAIRING=NODES")
    heated = PRESSED.copy()
    heated[1:2] = ["*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "0.5, 1.", "*BOUNDARY",
                   "A.BOTTOM, 11", "B.TOP, 11, 11, 50."]
    del heated[6]
    for tolerance, warned in (("1.E-8", False), ("1.E-25", True)):
        deck = write(tmp_path / "deck.inp", cards[:at],
                     ["*GAP LAW, TYPE=POWER", "0., 0.1, 1."], cards[at:],
                     [f"*FIXED POINT, TOL={tolerance}"], heated)
        process = run("run", deck, "--out", tmp_path)
        assert process.returncode == 0, process.stderr
        summary = r"solved, 2 increments in [\d.]+ s; the contact conductance is accurate to \S+ only"
        assert bool(re.search(summary, process.stdout)) == warned
        found = re.findall(r"2: the contact conductance is accurate to (\S+) only, "
                           r"not TOL=", process.stderr)
        assert len(found) == warned
        assert all(0 < float(value) < 1e-8 for value in found)


def test_bodies_of_different_thickness(tmp_path):
    """The areas are the slave's; axisymmetric models have no thickness."""
    cards = blocks(thickness=("1.", "5."))
    message = one(warnings(tmp_path, cards, PRESSED), "*CONTACT PAIR")
    assert "is 1 thick; pressure and flux of all contact points are for the thickness 5 of" in message
    assert warnings(tmp_path, blocks(thickness=("5.", "5.")), PRESSED) == []
    assert warnings(tmp_path, ["*OPTIONS, PLANE=AXISYMMETRIC"], cards, PRESSED) == []


@pytest.mark.parametrize(("side", "told"), [(2e-5, False), (5e-6, True)])
def test_nodes_that_all_but_coincide(tmp_path, side, told):
    """Pressures beside a side of 5e-6 of the longest are lost to the rounding of doubles, 2^-52,
    over (5e-6)^2."""
    deck = [*block("A", [0.0, 1.0], [0.0, side]), *solid("A", 2e5, 0.3), "*BOUNDARY", "A.BOTTOM, 1, 2"]
    step = ["*STEP", "*STATIC", "1., 1.", "*DLOAD", "A, P3, 1.", "*END STEP"]
    found = warnings(tmp_path, deck, step)
    assert len(found) == told
    if told:
        lost = float(re.search(r"accurate to (\S+) only", one(found, "1, "))[1])
        assert lost == pytest.approx(2.0**-52 / side**2, rel=0.01)
        assert "shortest side is 5E-6 of its longest" in found[0][0]


@pytest.mark.parametrize(("ratio", "told"), [(1e-6, False), (1e-11, True)])
def test_a_stiff_body_on_a_far_softer_one(tmp_path, ratio, told):
    """What holds the upper block is lost in its rounding, which a run that goes on does not tell
    again."""
    cards = block("A", XS, [0.0, 1.0, 2.0]) + block("B", XS, [2.0, 3.0, 4.0], first=101)
    cards += solid("A", 1e5 * ratio, 0.0) + solid("B", 1e5, 0.0)
    cards += ["*SURFACE INTERACTION, NAME=I", "*CONTACT PAIR, INTERACTION=I, NAME=F", "B.BOTTOM, A.TOP",
              "*BOUNDARY", "A.BOTTOM, 1, 2", "B.LEFT, 1"]
    deck = write(tmp_path / "deck.inp", ["*RESTART, WRITE"], cards, [
        "0.5, 1." if card == "1., 1." else card for card in PRESSED])
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 0, process.stderr
    listing = deck.with_suffix(".lst").read_text()
    assert ("the smallest pivot of the bodies is" in listing) == told
    again = run("run", "--quiet", deck, "--restart", f"{deck.with_suffix('.vtkhdf')}@0.5", "--out",
                tmp_path / "again")
    assert again.returncode == 0 and "pivot" not in again.stderr


def test_faces_far_apart_are_paired_all_the_same(tmp_path):
    """Distances between all their ends are the same to rounding."""
    deck = write(tmp_path / "deck.inp", blocks(gap=1e12), PRESSED)
    process = run("check", deck)
    assert process.returncode == 0, process.stderr
    assert "9 node pairs, initial gaps 1E+12 to 1E+12" in process.stdout.replace("1E12", "1E+12")


def conducting(step, conductivity="50.", expansion="1.E-5"):
    """Return one block with cards of its step and two properties as written."""
    return [*block("A", XS, [0.0, 1.0, 2.0]), "*MATERIAL, NAME=A", "*ELASTIC", "1000., 0.",
            "*EXPANSION", expansion, "*CONDUCTIVITY", conductivity,
            "*SOLID SECTION, ELSET=A, MATERIAL=A", *step]


HEATED = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
          "A.BOTTOM, 1, 2", "A.BOTTOM, 11", "A.TOP, 11, 11, 5.", "*END STEP"]


def test_decimal_commas(tmp_path):
    """The number is read as the two fields that it is, and said to be."""
    message = one(warnings(tmp_path, conducting(HEATED, "1,18")), "1,18")
    assert message.startswith("decimal comma? 1,18 is two fields: 1, and a temperature, which ")
    assert "write 1.18, or 1. if that is meant" in message
    for legitimate in ("1.18", "50, 293", "50., 20.", "50., 20"):
        assert warnings(tmp_path, conducting(HEATED, legitimate)) == []


def test_an_expansion_that_is_no_small_strain(tmp_path):
    """The coefficient in 1e-6 per degree; 10 % are the limit, here over 5 degrees."""
    assert warnings(tmp_path, conducting(HEATED, expansion="0.0199")) == []
    message = one(warnings(tmp_path, conducting(HEATED, expansion="0.0201")), "*EXPANSION")
    assert "the expansion of A over the range of the temperatures, 5, is a strain of 0.1005" in message
    factors = ["*AMPLITUDE, NAME=UP", "0., 0., 1., 4."]
    follows = [card.replace("*BOUNDARY", "*BOUNDARY, AMPLITUDE=UP") for card in HEATED]
    assert warnings(tmp_path, conducting([*factors, *follows], expansion="0.004")) == []
    assert "range of the temperatures, 20, " in one(
        warnings(tmp_path, conducting([*factors, *follows], expansion="0.006")), "*EXPANSION")


def insulated():
    """Return the two blocks with a contact that says that no heat crosses it."""
    cards = blocks()
    at = cards.index("*CONTACT PAIR, INTERACTION=I, NAME=F, PAIRING=NODES")
    return [*cards[:at], "*GAP LAW, TYPE=POWER", "0., 0., 1.", *cards[at:]]


def test_contact_that_no_heat_crosses(tmp_path):
    """Unless the deck says that it is so, or has no heat."""
    heated = PRESSED.copy()
    heated[1:2] = ["*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE"]
    heated[3:3] = ["*BOUNDARY", "A.BOTTOM, 11", "B.TOP, 11, 11, 50."]
    cards = blocks()
    message = one(warnings(tmp_path, cards, heated), "*CONTACT PAIR")
    assert message.startswith("no heat crosses F: its interaction I has no conductance law")
    assert warnings(tmp_path, insulated(), heated) == []
    assert warnings(tmp_path, cards, PRESSED) == []


def test_constants_are_printed_as_understood(tmp_path):
    laws = ["*FRICTION", "0,155", "*GAP LAW, TYPE=GAS", "0.5, 0.25", "*GAP CONDUCTANCE, PRESSURE",
            "2., 0.", "3., 10."]
    cards = blocks()
    at = cards.index("*SURFACE INTERACTION, NAME=I") + 1
    cards[cards.index("*ELASTIC") + 1] = "20000, 0,4"
    cards = [*cards[:at], *laws, *cards[at:]]
    heat = [*PRESSED[:1], "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", *PRESSED[2:-1],
            "*BOUNDARY", "A.BOTTOM, 11", "B.TOP, 11, 11, 5.", "*END STEP"]
    deck = write(tmp_path / "deck.inp", cards, heat)
    checked = " ".join(run("check", deck).stdout.split())
    assert run("run", "--quiet", deck, "--out", tmp_path).returncode == 0
    listed = " ".join(deck.with_suffix(".lst").read_text().split())
    for text in (checked, listed):
        for constants in ("Young's modulus 20000, Poisson's ratio 0, coefficient of expansion 0, "
                          "conductivity 1", "A/(B + gap), A = 0.5, B = 0.25",
                          "table over the pressure: 2 at 0, 3 at 10"):
            assert constants in text, constants
    assert "interaction I ............. friction none" in checked
    assert "coefficient of friction ... none" in listed


def test_every_kind_of_constant_is_printed(tmp_path):
    """Of a property that is given twice the later card holds."""
    cards = conducting(HEATED, "50.")
    at = cards.index("*SOLID SECTION, ELSET=A, MATERIAL=A")
    more = ["*ELASTIC, TYPE=ENGINEERING CONSTANTS", "9., 8., 7., 0.1, 0.2, 0.15, 3., 4.", "5.",
            "*EXPANSION, TYPE=ORTHO", "1.E-6, 2.E-6, 3.E-6", "*CONDUCTIVITY, TYPE=ORTHO", "6., 7.",
            "*DENSITY", "2.5"]
    deck = write(tmp_path / "deck.inp", cards[:at], more, cards[at:])
    process = run("check", deck)
    assert process.returncode == 0, process.stderr
    assert ("material A ................ E1 9, E2 8, E3 7, nu12 0.1, nu13 0.2, nu23 0.15, G12 3, "
            "G13 4, G23 5, alpha11 1E-6, alpha22 2E-6, alpha33 3E-6, K11 6, K22 7, density 2.5"
            ) in process.stdout


def test_a_coupled_step_without_heat(tmp_path):
    cold = [card for card in HEATED if ", 11" not in card]
    message = one(warnings(tmp_path, conducting(cold)), "*STEP")
    assert message.startswith("step 1 solves no heat: nothing prescribes a temperature")
    assert warnings(tmp_path, conducting(HEATED)) == []


def test_definitions_that_nothing_uses(tmp_path):
    spare = ["*MATERIAL, NAME=SPARE", "*ELASTIC", "1., 0."]
    assert one(warnings(tmp_path, spare, conducting(HEATED)), "*MATERIAL, NAME=SPARE") == \
        "nothing uses the material SPARE"


@pytest.mark.parametrize(("initial", "rows", "value", "told"), [
    (20.0, "0., 0., 60., 1.", 500.0, True), (20.0, "0., 0.04, 60., 1.", 500.0, False),
    (0.0, "0., 0., 60., 1.", 500.0, False), (20.0, "0., 0., 60., 1.", 0.0, False)])
def test_an_amplitude_that_begins_far_from_the_initial_temperature(tmp_path, initial, rows, value, told):
    cards = [*conducting([]), "*INITIAL CONDITIONS, TYPE=TEMPERATURE", f"A, {initial!r}"]
    heated = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 60.", "*BOUNDARY", "A.BOTTOM, 1, 2",
              "*BOUNDARY, AMPLITUDE=WARM", f"A.TOP, 11, 11, {value!r}", "*END STEP"]
    found = [(message, card) for message, card in warnings(tmp_path, ["*AMPLITUDE, NAME=WARM", rows], cards, heated)
             if "jumps" in message]
    if told:
        assert one(found, "A.TOP") == (
            "the temperature jumps from 20 to 0 as step 1 begins: factors of an amplitude multiply the value, and WARM begins "
            "with 0; 4E-2 is the factor for 20")
    else:
        assert found == []


def test_an_amplitude_that_ends_long_before_its_step(tmp_path):
    cards = ["*AMPLITUDE, NAME=RISE", "0., 0., 1., 1."]
    slow = [card.replace("1., 1.", "9., 900.") for card in HEATED]
    slow[3] = "*BOUNDARY, AMPLITUDE=RISE"
    message = one(warnings(tmp_path, cards, conducting(slow)), "*AMPLITUDE")
    assert message == ("amplitude RISE ends at 1, long before the end of step 1 at 900: its last "
                       "factor, 1, is kept")


@pytest.mark.parametrize(("total", "times", "idle"), [
    ("", "1., 0., 2., 1.", True), ("", "5., 0., 6., 1.", True), ("", "0.9, 0., 2., 1.", False),
    (", TIME=TOTAL TIME", "1., 0., 2., 1.", False), (", TIME=TOTAL TIME", "2., 0., 3., 1.", True),
    ("", "0., 0., 0.5, 1., 1., 0.", False)])
def test_an_amplitude_that_begins_after_its_step(tmp_path, total, times, idle):
    """In the second of two steps, each 1 long."""
    cards = [f"*AMPLITUDE, NAME=LATE{total}", times]
    second = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.",
              "*DLOAD, AMPLITUDE=LATE", "A, BX, 1.", "*END STEP"]
    found = warnings(tmp_path, cards, conducting([*HEATED, *second]))
    said = "amplitude LATE is 0 throughout step 2, which begins to use it"
    if not total:
        said += "; without TIME=TOTAL TIME its times count from the start of the step"
    assert (one(found, "*AMPLITUDE") == said) if idle else (found == [])


@pytest.mark.parametrize(("direct", "total", "rows", "told"), [
    (True, "", "0., 0., 0.6, 0., 0.65, 1., 0.7, 0.", ("1", 1, 0.65, 0, 0)),
    (False, "", "0., 0., 0.6, 0., 0.65, 1., 0.7, 0.", None),
    (True, "", "0., 0., 0.4, 1., 0.8, -0.2, 1., 0.", ("1", 1, 0.4, 0, 0.7)),
    (True, "", "0., 0., 0.3, 0.7, 0.5, 1., 1., 0.", None),
    (True, "", "0., 0., 0.499, 0.999, 1., 0.", None),
    (True, ", TIME=TOTAL TIME", "0., 0., 1.6, 0.1, 1.7, 2., 3., 1.", ("2", 2, 1.7, "9.375E-2", 1.76923)),
    (True, ", TIME=TOTAL TIME", "0., 0., 1., 0.1, 1.5, 2., 3., 1.", None)])
def test_a_peak_that_fixed_increments_step_over(tmp_path, direct, total, rows, told):
    """Two steps of two increments of 0.5."""
    how, cards = ", DIRECT" if direct else "", ["*AMPLITUDE, NAME=PULSE" + total, rows]
    first = [card.replace("STEADY STATE", "STEADY STATE" + how).replace("1., 1.", "0.5, 1.")
             for card in HEATED]
    first[-1:-1] = ["*DLOAD, AMPLITUDE=PULSE", "A, BX, 1."]
    second = [*first[:3], "*END STEP"]
    found = warnings(tmp_path, cards, conducting([*first, *second]))
    if not told:
        assert found == []
        return
    number, factor, time, before, after = told
    assert one(found, "*AMPLITUDE") == (
        f"amplitude PULSE: the increments of step {number}, fixed by DIRECT, step over its factor "
        f"{factor} at {time}, and see {before} and {after}; without DIRECT they end on its corners")


@pytest.mark.parametrize(("gap", "closes"), [(1e-3, True), (0.2, False)])
def test_contact_that_never_closes(tmp_path, gap, closes):
    """The upper block is pushed down by 0.1."""
    pushed = ["*STEP", "*STATIC", "0.5, 1.", "*BOUNDARY", "B.TOP, 2, 2, -0.1", "*END STEP"]
    found = warnings_of_run(tmp_path, blocks(gap=gap), pushed)
    assert found == ([] if closes else ["contact pair F never closes: its smallest gap is 0.1"])


REMOVED, ADDED = ["*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE", "B.BOTTOM, A.TOP"], ["*MODEL CHANGE, TYPE=CONTACT PAIR, ADD",
                                                                         "B.BOTTOM, A.TOP"]


@pytest.mark.parametrize(("gap", "second", "told"), [(-0.1, [], None), (0.2, [], None), (0.2, ADDED, 0.2)])
def test_a_pair_that_is_removed_neither_closes_nor_is_pressed_apart(tmp_path, gap, second, told):
    """The upper block is pushed down by 0.1 while the pair is removed, and back again."""
    steps = [["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", f"B.TOP, 2, 2, {way!r}", *change, "*END STEP"]
             for way, change in ((-0.1, REMOVED), (0.0, second))]
    found = warnings_of_run(tmp_path, blocks(gap=gap), *steps)
    assert found == ([f"contact pair F never closes: its smallest gap is {told!r}"] if told else [])
    deck = tmp_path / "deck.inp"
    assert "the faces overlap" not in run("check", deck).stderr
    # One that a later step adds is.
    text = deck.read_text().rpartition("*END STEP")[0]
    deck.write_text("\n".join([text.rstrip(), *([] if second else ADDED), "*END STEP\n"]))
    assert ("pressed apart as soon as the pair acts" in run("check", deck).stderr) == (gap < 0.0)


def test_the_smallest_gap_is_one_of_an_increment(tmp_path):
    """Of bodies that touch and part, by 0.05 in the first of two increments."""
    lifted = ["*STEP", "*STATIC", "0.5, 1.", "*BOUNDARY", "B.TOP, 2, 2, 0.1", "*END STEP"]
    (found,) = warnings_of_run(tmp_path, blocks(gap=0.0), lifted)
    words, _, value = found.rpartition(" ")
    assert words == "contact pair F never closes: its smallest gap is"
    assert float(value) == pytest.approx(0.05, rel=1e-6)


def test_loads_that_never_act(tmp_path):
    """An amplitude that is 0, and temperatures that are prescribed as they are."""
    curve = ["*AMPLITUDE, NAME=NONE", "0., 0., 1., 0."]
    none = [*HEATED[:-2], "A.TOP, 11", "*DLOAD, AMPLITUDE=NONE", "A, BX, 1.", "*END STEP"]
    found = warnings_of_run(tmp_path, curve, conducting(none))
    assert found == ["no load acts: all displacements are 0 in all increments",
                     "no heat load acts: all temperatures keep their initial values in all "
                     "increments"]
    assert warnings_of_run(tmp_path, conducting(HEATED)) == []
    pulled = [*none[:-2], "A, BX, 1.", "*END STEP"]
    pulled[-3] = "*DLOAD"
    found = warnings_of_run(tmp_path, conducting(pulled))
    assert [message.split(":")[0] for message in found] == ["no heat load acts"]
    cold = warnings_of_run(tmp_path, conducting(HEATED, expansion="0."))
    assert [message.split(":")[0] for message in cold] == ["no load acts"]


@pytest.mark.changes("STEP, NLGEOM")
@pytest.mark.parametrize("told", [False, True])
def test_large_strains(tmp_path, told):
    """A block that is stretched uniformly, nu = 0; half of it in the first increment. NLGEOM itself
    is warned of at its place in the deck."""
    decks = []
    for nlgeom, limit in (("", 10), (", NLGEOM=NO", 10), (", NLGEOM", 5)):
        strain = limit / 100 + (0.001 if told else -0.001)
        decks.append(conducting([
            f"*STEP{nlgeom}", "*STATIC", "0.5, 1.", "*BOUNDARY", "A.BOTTOM, 1, 2",
            f"A.TOP, 2, 2, {2 * strain!r}", "A.TOP, 1", "A.LEFT, 1", "A.RIGHT, 1", "*END STEP"]))
        found = warnings_of_run(tmp_path, decks[-1])
        assert len(found) == told
        if told:
            assert re.match(rf"increment 2: the strain of element \d+ is {limit}.1 %; the theory ",
                            found[0])
            assert found[0].endswith(f"is not valid above {limit} %")
    note_changes(decks[0], decks[2])


def test_nlgeom_is_warned_of_once_and_not_in_steps_of_heat(tmp_path):
    heat = ["*STEP, NLGEOM", "*HEAT TRANSFER, STEADY STATE", "*BOUNDARY", "A.BOTTOM, 11",
            "A.TOP, 11, 11, 5.", "*END STEP"]
    pressed = ["*STATIC", "*BOUNDARY", "A.BOTTOM, 1, 2", "*END STEP"]
    asked = conducting([*heat, *2 * ["*STEP, NLGEOM=YES", *pressed]])
    message = one(warnings(tmp_path, asked), "*STEP, NLGEOM=YES")
    assert message == "NLGEOM is not modelled: displacements and strains stay small"
    assert warnings(tmp_path, conducting([*heat, "*STEP", *pressed])) == []


@pytest.mark.parametrize(("given", "missing"), [((), 0), (("A", "B"), 0), (("A",), 37)])
def test_initial_temperatures_of_some_nodes_only(tmp_path, given, missing):
    """The upper block has 4 x 2 elements with 15 corners and 22 midside nodes."""
    start = ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", *(f"{name}, 20." for name in given)] if given else []
    heated = ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY", "A.BOTTOM, 11, 11, 20.",
              "B.TOP, 11, 11, 50.", "*END STEP"]
    laws = blocks()
    at = laws.index("*SURFACE INTERACTION, NAME=I") + 1
    laws[at:at] = ["*GAP LAW, TYPE=CLEARANCE", "1., 0."]
    found = warnings(tmp_path, laws, start, heated)
    assert len(found) == (missing > 0)
    if missing:
        assert one(found, "A, 20.").endswith(
            f"no initial temperature to {missing} nodes of the bodies, such as 101: they start at 0")


@pytest.mark.parametrize(("bottom", "top", "start", "expansion", "warned"), [
    ("20.", "120.", [], "1.E-5", True), ("-20.", "-5.", [], "1.E-5", True),
    ("20.", "120.", ["A, 0."], "1.E-5", False), ("0.", "120.", [], "1.E-5", False),
    ("-5.", "5.", [], "1.E-5", False), ("20.", "120.", [], "0.", False)])
def test_bodies_that_expand_from_0_degrees(tmp_path, bottom, top, start, expansion, warned):
    """A temperature of 0 or on either side of it is one that counts from there."""
    step = ["*STEP", "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "1., 1.", "*BOUNDARY",
            "A.BOTTOM, 1, 2", f"A.BOTTOM, 11, 11, {bottom}", f"A.TOP, 11, 11, {top}", "*END STEP"]
    given = ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "A.BOTTOM, 1, 2", "*TEMPERATURE",
             f"A.BOTTOM, {bottom}", f"A.TOP, {top}", "*END STEP"]
    films = [*step[:5], "*FILM", f"1, F1, {bottom}, 5.", f"1, F4, {top}, 5.", "*END STEP"]
    card = "*INITIAL CONDITIONS, TYPE=TEMPERATURE"
    for loads, first in ((step, "A.BOTTOM, 11"), (given, "A.BOTTOM, "), (films, "1, F1")):
        found = warnings(tmp_path, [card, *start] if start else [], conducting(loads, expansion=expansion))
        found = [each for each in found if "bodies expand from 0" in each[0]]
        assert len(found) == warned
        if warned:
            assert one(found, first).endswith(f"give {card}, with the value 0 where temperatures are rises")


def test_a_table_of_conductances_that_are_all_0(tmp_path):
    """The first column is the conductance; the law of the other tables conducts somewhere."""
    for rows, warned in ((["0., 1.", "0., 2."], True), (["0., 1.", "1., 2."], False)):
        laws = blocks()
        at = laws.index("*SURFACE INTERACTION, NAME=I") + 1
        laws[at:at] = ["*GAP CONDUCTANCE", *rows]
        found = [told for told, _ in warnings(tmp_path, laws, PRESSED)]
        assert any("all conductances of this table of I are 0" in told for told in found) == warned


def test_a_support_out_of_the_plane_alone(tmp_path):
    """With a degree of freedom that the plane has, the others are ignored without a word; so are
    the rotations, which Abaqus/CAE writes with every support."""
    for degrees, warned in (("3", True), ("6", False), ("1, 3", False), ("PINNED", False)):
        support = ["*BOUNDARY", f"B.LEFT, {degrees}"]
        found = [told for told, _ in warnings(tmp_path, blocks(), support, PRESSED)]
        assert found == ["degree of freedom 3 does not exist in a plane model: this support is "
                         "ignored"][:warned]


def test_a_jump_in_a_step_is_warned_of_where_increments_are_too_short_for_its_elements(tmp_path):
    """rho c h^2/(4 k) = 0.09375; elements of half the size need a quarter of it. Nothing jumps in
    the step before."""
    def deck(sides):
        xs = [i / sides for i in range(sides + 1)]
        return [block("A", xs, [0.0, 1.0]), [
            "*MATERIAL, NAME=A", "*CONDUCTIVITY", "2.", "*DENSITY", "1.5", "*SPECIFIC HEAT", "2.",
            "*SOLID SECTION, ELSET=A, MATERIAL=A",
            "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "A, 20.",
            "*STEP", "*HEAT TRANSFER, DIRECT", "0.05, 0.1", "*BOUNDARY", "A.LEFT, 11, 11, 20.",
            "*END STEP", "*STEP", "*HEAT TRANSFER, DIRECT", "0.05, 0.1", "*BOUNDARY",
            "A.LEFT, 11, 11, 100.", "*END STEP"]]

    coarse = warnings_of_run(tmp_path, *deck(2))
    assert len(coarse) == 1
    assert coarse[0].startswith("increment 3: temperatures jump at 3 nodes, "), coarse
    assert "overshoot within 9.375E-2" in coarse[0]
    assert warnings_of_run(tmp_path, *deck(4)) == []
