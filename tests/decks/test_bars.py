"""Springs and trusses: CalculiX on the same deck where it runs, and closed forms.

CalculiX 2.20 ends without a message where SPRINGA or T2D2 stand beside plane elements.
"""

import pytest
from calculix import DIGITS, assert_within, compared
from changes import note_changes
from physics import judge, material, mesh, nodes_of

EXACT = 1e-9
STIFFNESS = 1000.0   # E A/L of the block, 2 x 0.5 and 1 high, along y; nu = 0
HEATED = 30.0
BLOCK = [*mesh("BODY", [0.0, 2.0], [0.0, 1.0], kind="CPS8"), *material("BODY", (1000.0, 0.0), 1e-4),
         "0.5"]
# The upper face moves with a node of no element, which springs and trusses pull.
HANDLE = ["*NODE, NSET=HANDLE", "100, 1., 2.", "*COUPLING, REF NODE=HANDLE, SURFACE=BODY.TOP, "
          "CONSTRAINT NAME=GRIP", "*KINEMATIC", "2"]
COLD = ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 0.", "HANDLE, 0.", "ANCHOR, 0."]
HELD = ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "BODY.BOTTOM, 1, 2", "HANDLE, 1", "ANCHOR, 1"]
BALANCED = ("force_imbalance", "", "LAST", 0.0, 1e-12, "ABS")


def anchor(x, y):
    """Return a node that pulls."""
    return ["*NODE, NSET=ANCHOR", f"101, {x}, {y}"]


def springs(kind, nodes, *values, name="SPRINGS", number=51):
    """Return a spring element and its *SPRING."""
    return [f"*ELEMENT, TYPE={kind}, ELSET={name}", f"{number}, {nodes}", f"*SPRING, ELSET={name}",
            *values]


@pytest.mark.changes("SPRING")
@pytest.mark.parametrize("options", [[], ["*REFINE, LEVELS=1"], ["*OPTIONS, ORDER=1"]])
def test_a_slanted_spring_pulls_along_its_line(tmp_path, options):
    """Along (3, 4)/5: 16/25 of its constant along y; its other end is moved by 0.01."""
    spring = springs("SPRINGA", "100, 101", "50.")
    moved = 32.0 * 0.01 / (STIFFNESS + 32.0)
    pull = 50.0 * 0.8 * (0.01 - moved)
    judge(tmp_path, [*options, *BLOCK, *HANDLE, *anchor(4.0, 6.0), *spring, *HELD,
                     "*BOUNDARY", "ANCHOR, 2, 2, 0.01", "*END STEP"],
          [("U2", "100", "LAST", moved, EXACT), ("RF2", "101", "LAST", 0.8 * pull, EXACT),
           ("RF1", "101", "LAST", 0.6 * pull, EXACT), BALANCED])
    note_changes(springs("SPRINGA", "100, 101", "40."), spring)


@pytest.mark.changes("SPRING, ELSET")
def test_springs_of_two_sets_have_their_own_constants(tmp_path):
    """One along x, which does not move the handle, and one along y."""
    for upright, level in (("A", "B"), ("B", "A")):
        both = [*springs("SPRINGA", "100, 101", "50.", name=upright),
                *springs("SPRINGA", "100, 102", "20.", name=level, number=52)]
        judge(tmp_path, [*BLOCK, *HANDLE, *anchor(1.0, 4.0), "*NODE, NSET=SIDE", "102, 5., 2.", *both,
                         *HELD, "SIDE, 1, 2", "ANCHOR, 2, 2, 0.01", "*END STEP"],
              [("U2", "100", "LAST", 50.0 * 0.01 / (STIFFNESS + 50.0), EXACT), BALANCED])
    note_changes(springs("SPRINGA", "100, 101", "50.", name="A"),
                 springs("SPRINGA", "100, 101", "50.", name="B"))


@pytest.mark.parametrize("options", [[], ["*OPTIONS, ORDER=1"]])
def test_a_spring_at_a_node_that_drops_out_pulls_its_neighbours(tmp_path, options):
    """ORDER=1 leaves the corners of the upper face, whose middle is pulled by 0.01."""
    top = next(number for number, place in nodes_of(BLOCK).items() if place == (1.0, 1.0))
    judge(tmp_path, [*options, *BLOCK, *HANDLE, *anchor(1.0, 3.0),
                     *springs("SPRINGA", f"{top}, 101", "50."), *HELD, "ANCHOR, 2, 2, 0.01",
                     "*END STEP"],
          [("U2", "BODY.TOP", "LAST", 50.0 * 0.01 / (STIFFNESS + 50.0), EXACT), BALANCED])


@pytest.mark.parametrize("young", [1000.0, [(1000.0, 0.0, 0.0), (600.0, 0.0, 60.0)]])
@pytest.mark.parametrize("beside", [0.0, 50.0])
@pytest.mark.parametrize("anchor_at", [HEATED, 0.0])
def test_a_warm_truss_pushes(tmp_path, anchor_at, beside, young):
    """E A/L = 100; both become longer by alpha (T - T0), the truss by that of the mean of its ends.
    A spring beside it does not. Both pull a node of the body, whose modulus falls to 800 at 30."""
    elastic, stiffness = ((young, 0.0), STIFFNESS) if young == 1000.0 else (young, 0.8 * STIFFNESS)
    cards = [*mesh("BODY", [0.0, 2.0], [0.0, 1.0], kind="CPS8", first=201),
             *material("BODY", elastic, 1e-4), "0.5"]
    top = next(number for number, place in nodes_of(cards).items() if place == (1.0, 1.0))
    ends = f"{top}, 101" if beside else f"101, {top}"
    truss = ["*ELEMENT, TYPE=T2D2, ELSET=BAR", f"51, {ends}", *material(
        "BAR", (1000.0, 0.0), 2e-4), "0.2"]
    starts = ["*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 12.", "HANDLE, -40.", "ANCHOR, -4."]
    free, longer = 1e-4 * (HEATED - 12.0), 2.0 * 2e-4 * (HEATED - 12.0 + anchor_at + 4.0) / 2
    spring = springs("SPRINGA", ends, f"{beside!r}", number=50) if beside else []
    judge(tmp_path, [*HANDLE[:2], *cards, *HANDLE[2:], *anchor(1.0, 3.0), *spring, *truss, *starts,
                     *HELD, "ANCHOR, 2",
                     "*TEMPERATURE", "BODY, 30.", "HANDLE, 30.", f"ANCHOR, {anchor_at!r}",
                     "*END STEP"],
          [("U2", "100", "LAST",
            (stiffness * free - 100.0 * longer) / (stiffness + 100.0 + beside), EXACT), BALANCED])


@pytest.mark.parametrize("sliding", ["", ", SLIDING=FINITE"])
def test_a_spring_holds_a_body_that_contact_stops(tmp_path, sliding):
    """A block of one element is pushed by 5 over a gap of 0.01 against a spring of 100."""
    gap, push, spring = 0.01, 5.0, 100.0
    give = 2.0 / STIFFNESS
    base = [*mesh("BASE", [0.0, 2.0], [-1.0 - gap, -gap], kind="CPS8", first=201),
            *material("BASE", (1000.0, 0.0), 1e-4), "0.5"]
    joint = ["*SURFACE INTERACTION, NAME=DRY",
             f"*CONTACT PAIR, INTERACTION=DRY, NAME=JOINT{sliding}", "BODY.BOTTOM, BASE.TOP"]
    judge(tmp_path, [*BLOCK, *base, *HANDLE, *anchor(1.0, 4.0), *joint,
                     *springs("SPRINGA", "100, 101", str(spring)),
                     "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "BASE.BOTTOM, 1, 2", "BODY.LEFT, 1",
                     "HANDLE, 1", "ANCHOR, 1, 2", "*CLOAD", f"100, 2, {-push}", "*END STEP"],
          [("normal_force", "JOINT", "LAST", (push - spring * gap) / (1.0 + spring * give), EXACT),
           BALANCED])


@pytest.mark.parametrize("spring", [springs("SPRING1", "4", "1", "200."),
                                    springs("SPRING2", "2, 3", "2, 1", "300.")])
def test_springs_along_degrees_of_freedom_as_in_calculix(tmp_path, spring):
    """Forces of nodes are left out: those of CalculiX lack what springs exert."""
    found = compared(
        tmp_path, mesh("BODY", [0.0, 1.0, 2.0], [0.0, 1.0]), material("BODY", (1000.0, 0.3), 1e-4),
        spring, ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "BODY.BOTTOM, 2", "1, 1", "*DSLOAD",
                 "BODY.TOP, P, 20.", "*CLOAD", "3, 1, 4.", "*NODE PRINT, NSET=BODY", "U",
                 "*EL PRINT, ELSET=BODY", "S", "*END STEP"])
    assert_within(found, DIGITS)


@pytest.mark.parametrize("analysis", ["*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "*COUPLED TEMPERATURE-DISPLACEMENT"])
@pytest.mark.parametrize("coupled", [True, False])
def test_an_anchor_of_no_element_keeps_its_temperature_where_heat_is_solved(tmp_path, analysis, coupled):
    """A truss along (3, 4)/5 is warmed by 100 at its one end, by 50 in the mean; E A alpha is 2."""
    steps = ["*STEP", analysis if coupled else "*STATIC", "1., 1.", "*BOUNDARY", "BODY, 1, 2", "ANCHOR, 1, 2",
             *(["BODY, 11, 11, 120."] if coupled else ["*TEMPERATURE", "BODY, 120."]), "*END STEP"]
    body = mesh("BODY", [0.0, 1.0], [0.0, 1.0], "CPS4")
    end = next(number for number, place in nodes_of(body).items() if place == (1.0, 1.0))
    judge(tmp_path, [
        *body, *material("BODY", (1000.0, 0.3), 0.0, conductivity=1.0, density=1.0, specific_heat=1.0),
        *anchor(4.0, 5.0), "*MATERIAL, NAME=BAR", "*ELASTIC", "1.E5, 0.3", "*EXPANSION", "1.E-5",   # and no conductivity
        "*ELEMENT, TYPE=T2D2, ELSET=BAR", f"51, {end}, 101", "*SOLID SECTION, ELSET=BAR, MATERIAL=BAR", "2.",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "BODY, 20.", "ANCHOR, 20.", *steps],
        [("RF1", "101", "LAST", -2.0 * 50.0 * 0.6, EXACT), ("RF2", "101", "LAST", -2.0 * 50.0 * 0.8, EXACT)])
