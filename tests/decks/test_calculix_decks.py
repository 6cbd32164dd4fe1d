"""Decks as preprocessors of CalculiX write them: both programs read them as they are.

The forms are those of cgx, PrePoMax and FreeCAD; the decks are written for these tests.
"""

import h5py
import numpy as np
import pytest
from blocks import write
from calculix import DIGITS, assert_within, calculix, compared, differences, thercon
from deck_runs import run
from physics import follows, material, mesh, nodes_of

XS, YS = [1.0, 1.6, 2.5], [0.0, 0.5, 1.1]


def numbers(cards, heading):
    """Return the data of one card of a mesh, as lists of fields."""
    start = cards.index(heading) + 1
    rows = []
    for card in cards[start:]:
        if card.startswith("*"):
            break
        rows.append([field.strip() for field in card.split(",")])
    return rows


def written(folder, name, *lines):
    (folder / name).write_text("\n".join(lines) + "\n")


def test_a_deck_of_cgx(tmp_path):
    """Mesh, sets, surfaces, supports and loads in files of their own, included where they belong;
    a temperature that is prescribed before the first step, heat through a surface, two steps."""
    cards = mesh("Eall", XS, YS, kind="CPE8R", skew=0.07)
    written(tmp_path, "all.msh", "*NODE, NSET=Nall", *(
        f"{n:8d},{x:20.12E},{y:20.12E},{0.0:20.12E}" for n, (x, y) in nodes_of(cards).items()),
        "*ELEMENT, TYPE=CPE8R, ELSET=Eall", *(
            line for e in numbers(cards, "*ELEMENT, TYPE=CPE8R, ELSET=Eall")
            for line in (" ".join(f"{v}," for v in e[:6]), ", ".join(e[6:]))))
    bottom = [n for row in numbers(cards, "*NSET, NSET=Eall.BOTTOM") for n in row]
    written(tmp_path, "bottom.nam", "** Names based on bottom", "*NSET,NSET=Nbottom",
            *(f"{n}," for n in bottom))
    written(tmp_path, "top.sur", "** Surfaces based on top", "*SURFACE, NAME=Stop",
            *(f"{e},{s}" for e, s in numbers(cards, "*SURFACE, NAME=Eall.TOP")))
    written(tmp_path, "bottom_2.bou", "** BOUNDARY based on bottom", *(f"{n},2,,0." for n in bottom))
    written(tmp_path, "right.dlo", "** Pressure based on right", *(
        f"{e}, P{s[1:]}, 2.0" for e, s in numbers(cards, "*SURFACE, NAME=Eall.RIGHT")))
    assert_within(compared(tmp_path, """
        *include, input=all.msh
        *include, input=bottom.nam
        *include, input=top.sur
        *boundary
        *include, input=bottom_2.bou
        *boundary
        1,1
        Nbottom,11,,40.
        ** material definition
        *material, name=steel
        *elastic
        210000,0.3,0
        *expansion, zero=0
        1e-5,
        *conductivity
        50,0
        *solid section, elset=Eall, material=Steel
        *initial conditions, type=temperature
        Nall, 20
        *step
        *heat transfer, steady state
        1,1
        *dflux
        Eall, BF, 2.
        Stop, S0, -0.5
        *node file
        NT,
        *el file
        HFL
        *section print, surface=Stop, name=sp1
        FLUX
        *node print, nset=Nall
        nt
        *el print, elset=Eall
        hfl
        *end step
        *step
        *static
        *dload
        *include, input=right.dlo
        *node file, output=2D
        U,
        *el file
        S,
        *node print, nset=Nbottom, totals=only
        rf
        *node print, nset=Nall
        u
        *el print, elset=Eall
        s
        *end step"""), DIGITS)


PREPOMAX_HEAD = """
    **
    ** Heading +++++++++++++++++++++++++++++++++++++++++++++++++
    **
    *Heading
    Hash: 1q2w3e4r, Date: 21.11.2026, Unit system: MM_TON_S_C
    **
    ** Nodes +++++++++++++++++++++++++++++++++++++++++++++++++++
    **
    *Node"""

PREPOMAX_MODEL = """
    **
    ** Physical constants ++++++++++++++++++++++++++++++++++++++
    **
    *Physical constants, Absolute zero=-273.15, Stefan Boltzmann=5.670374419E-11
    **
    ** Materials +++++++++++++++++++++++++++++++++++++++++++++++
    **
    *Material, Name=S235
    *Density
    7.8E-09
    *Elastic
    210000, 0.28
    *Expansion, Zero=20
    1.1E-05
    *Conductivity
    14
    *Specific heat
    440000000
    **
    ** Sections ++++++++++++++++++++++++++++++++++++++++++++++++
    **
    *Solid section, Elset=Shell_part-1, Material=S235
    1
    **
    ** Amplitudes ++++++++++++++++++++++++++++++++++++++++++++++
    **
    *Amplitude, Name=Amplitude-1
    0, 0
    1, 0.5
    **
    ** Initial conditions ++++++++++++++++++++++++++++++++++++++
    **
    *Initial conditions, Type=Temperature
    Internal-1_All, 20"""


def prepomax_step(name, static, *cards, prints=()):
    """Return a step as PrePoMax writes it: what was given before ends, all is given anew."""
    return [
        "**", f"** {name} ++++++++++++++++++++++++++++++++++++++++++++++++++", "**",
        "*Step, Inc=1000", static, "1, 1, 1E-05, 1E+30", "**",
        "** Output frequency ++++++++++++++++++++++++++++++++++++++++", "**",
        "*Output, Frequency=1", "**",
        "** Boundary conditions +++++++++++++++++++++++++++++++++++++", "**",
        "*Boundary, op=New", "** Name: Roller", "*Boundary", "Bottom, 2, 2, 0", "** Name: Point",
        "*Boundary", "Corner, 1, 1, 0", "**",
        "** Loads +++++++++++++++++++++++++++++++++++++++++++++++++++", "**",
        "*Cload, op=New", "*Dload, op=New", *cards, "**",
        "** Defined fields ++++++++++++++++++++++++++++++++++++++++++", "**",
        "*Temperature, op=New", "**",
        "** History outputs +++++++++++++++++++++++++++++++++++++++++", "**", *prints, "**",
        "** Field outputs +++++++++++++++++++++++++++++++++++++++++++", "**",
        "*Node file", "RF, U, NT", "*El file", "S, E, HFL, NOE", "**",
        "** End step ++++++++++++++++++++++++++++++++++++++++++++++++", "**", "*End step"]


def test_a_deck_of_prepomax(tmp_path):
    cards = mesh("All", XS, YS, kind="CPE8R", skew=0.07)
    bottom = ", ".join(n for row in numbers(cards, "*NSET, NSET=All.BOTTOM") for n in row)
    top = numbers(cards, "*SURFACE, NAME=All.TOP")
    face = top[0][1]
    model = [
        *PREPOMAX_HEAD.splitlines()[1:],
        *(f"{n}, {x:.8E}, {y:.8E}, 0" for n, (x, y) in nodes_of(cards).items()),
        "**", "** Elements ++++++++++++++++++++++++++++++++++++++++++++++++", "**",
        "*Element, Type=CPE8R, Elset=Shell_part-1",
        *(", ".join(e) for e in numbers(cards, "*ELEMENT, TYPE=CPE8R, ELSET=All")),
        "**", "** Node sets +++++++++++++++++++++++++++++++++++++++++++++++", "**",
        "*Nset, Nset=Bottom", bottom, "*Nset, Nset=Corner", "1",
        "*Nset, Nset=Internal-1_All, Generate", "1, 21, 1",
        "**", "** Surfaces ++++++++++++++++++++++++++++++++++++++++++++++++", "**",
        f"*Elset, Elset=internal-1_Top_{face}", ", ".join(e for e, _ in top),
        "*Surface, Name=Top, Type=Element", f"internal-1_Top_{face}, {face}",
        *PREPOMAX_MODEL.splitlines()[1:]]
    prints = ["*Node print, Nset=Internal-1_All", "U, RF", "*El print, Elset=Shell_part-1", "S",
              "*Node print, Nset=Bottom, Totals=Only", "RF"]
    assert_within(compared(
        tmp_path, model,
        prepomax_step("Step-1", "*Static, Solver=Spooles", "** Name: Pressure-1", "*Dload",
                      f"internal-1_Top_{face}, P{face[1:]}, 5", prints=prints),
        prepomax_step("Step-2", "*Static", "** Name: Gravity-1", "*Dload",
                      "Shell_part-1, Grav, 9810, 0, -1, 0", "** Name: Pressure-1",
                      "*Dload, Amplitude=Amplitude-1",
                      f"internal-1_Top_{face}, P{face[1:]}, 5", prints=prints)), DIGITS)


def test_a_deck_of_freecad(tmp_path):
    """Triangles; sets of sets; blanks before commas."""
    cards = mesh("All", XS, YS, kind="CPE6")
    bottom = [n for row in numbers(cards, "*NSET, NSET=All.BOTTOM") for n in row]
    top = [n for row in numbers(cards, "*NSET, NSET=All.TOP") for n in row]
    assert_within(compared(
        tmp_path, "*************", "** Nodes and elements", "*Node, NSET=Nall",
        [f"{n}, {x!r}, {y!r}, 0.0" for n, (x, y) in nodes_of(cards).items()],
        "*Element, TYPE=CPE6, ELSET=Efaces",
        [", ".join(e) for e in numbers(cards, "*ELEMENT, TYPE=CPE6, ELSET=All")],
        "** Define element set Eall", "*ELSET, ELSET=Eall", "Efaces",
        "** constraints fixed node sets", "*NSET,NSET=ConstraintFixed", [f"{n}," for n in bottom],
        """*MATERIAL, NAME=CalculiX-Steel
        *ELASTIC
        210000,0.3
        *ELSET,ELSET=MaterialSolidSolidSection
        Efaces
        *SOLID SECTION, ELSET=MaterialSolidSolidSection, MATERIAL=CalculiX-Steel
        20
        *STEP
        *STATIC
        ** Fixed Constraints
        *BOUNDARY
        ConstraintFixed,1
        ConstraintFixed,2

        ** Nodal loads
        *CLOAD""", [f"{n},2,-1.000000000000E+03" for n in top], """
        ** Outputs --> frd file
        *NODE FILE
        U
        *EL FILE
        S, E
        ** outputs --> dat file
        ** reaction forces for Constraint fixed
        *NODE PRINT , NSET=ConstraintFixed , TOTALS=ONLY
        RF
        *NODE PRINT, NSET=Nall
        U
        *EL PRINT , ELSET=Eall
        S
        *END STEP"""), DIGITS)


ODD = """
    *heading
    ** a comment in it
      cards as they may be written
    *node
    1
    2, 1.
    \t3,\t1.,\t1.,\t0.
    4, ,1., 0.
    5, 0.5,0.
    6,1.,.5,0.,0.,0.,1.
    7,.5,1.,
    8,0.,.5
    *node, nset=more
    9, 2., 0.
    10, 2., 1.
    ** a comment between

    11, 1.5, 0.
    12, 2., .5
    13, 1.5, 1.
    *element, type=cpe8r, elset=Eall
    1, 1,2,3,4
    5,6,7,8
    *element, type=cpe8r
    2, 2,9,10,3,11,12,
    13,6
    *elset, elset=Eall
    2
    *elset, elset=Eright
    2
    *nset, nset=left
    1, 4, 8,
    *nset, nset=Nall, generate
    1, 13
    *surface, name=Stop, type=element
    1, s3
    Eright, s3
    *nset, nset=both
    left, more
    *material, name=steel
    *elastic, type=isotropic
     210000., .3
    *density
    7.8e-9
    *expansion, type=iso, zero=20.
    1.2e-5,
    *solid section, elset=Eall, material=steel
    *initial conditions, type=temperature
    Nall, 20.
    *boundary,
    left,1,,0
    1,2
    *step, inc=1000
    *static, solver=spooles
    1.,1.,1e-5,1e30
    *cload, op=new
    *dload, op=new
    *temperature, op=new
    *dload
    Stop, P, 5.
    Eall, GRAV, 9810., 0., -1.
    *cload
    10, 1, 2.
    *restart, write, frequency=3
    *output, frequency=1
    *node output
    U, RF
    *element output
    S, E
    *el file, section forces
    S
    *contact file, output=2d
    CDIS,
    *node print, nset=both
    U
    *el print, elset=Eall
    S
    *end step"""


def test_cards_as_they_may_be_written(tmp_path):
    assert_within(compared(tmp_path, ODD), DIGITS)


def test_what_is_passed_over_is_said(tmp_path):
    deck = write(tmp_path / "deck.inp", ODD)
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 0
    for node, missing in ((1, "x"), (1, "y"), (2, "y"), (4, "x")):
        assert f"warning: node {node} has no {missing}: 0 is used" in process.stderr
    notes = deck.with_suffix(".lst").read_text()
    for card in ("*EXPANSION: ZERO", "*OUTPUT", "*EL FILE: SECTION FORCES",
                 "*CONTACT FILE: OUTPUT", "*STATIC: SOLVER"):
        assert f"- {card} is ignored" in notes, card


# What CalculiX reads one way and another form of the same deck: (cards, the other form).
FORMS = {
    "Windows line ends": lambda text: text.replace("\n", "\r\n"),
    "blanks": lambda text: text.replace(",", " , "),
    "tabs": lambda text: text.replace(", ", ",\t"),
    "upper case": lambda text: text.upper(),
    "blank lines": lambda text: text.replace("\n", "\n\n"),
    "comments": lambda text: text.replace("\n", "\n** a comment\n"),
    "commas": lambda text: text.replace("*boundary\n", "*boundary,\n"),
    "a parameter on a line of its own": lambda text: text.replace(
        "*solid section, elset", "*solid section,\n elset"),
}


@pytest.mark.parametrize("form", FORMS)
def test_a_form_changes_nothing(tmp_path, form):
    cards = [*(card.lower() for card in mesh("body", XS, YS, kind="CPE8R")),
             *(card.lower() for card in material("body", (1000.0, 0.3))),
             "*boundary", "body.bottom, 1, 2", "*step", "*static", "*dsload", "body.top, p, 3.",
             "*node print, nset=body", "u", "*el print, elset=body", "s", "*end step"]
    plain = write(tmp_path / "plain.inp", cards)
    other = tmp_path / "other.inp"
    other.write_bytes(FORMS[form](plain.read_text()).encode())
    assert other.read_bytes() != plain.read_bytes()
    assert thercon(other) == thercon(plain)
    if form != "a parameter on a line of its own":   # which CalculiX takes for data
        assert_within(differences(calculix(other), thercon(other)), DIGITS)


@pytest.mark.changes("NSET, SURFACE")
def test_a_set_of_the_nodes_of_a_surface_or_of_elements(tmp_path):
    """Nodes on the face, and all of an element; CalculiX passes these parameters over."""
    cards = [*mesh("BODY", [0.0, 1.0, 2.0], [0.0, 1.0], kind="CPE8"),
             *material("BODY", (1000.0, 0.0))]

    def make(side):
        value = {"TOP": 0.01, "BOTTOM": 0.0}[side]
        return ([*cards, f"*NSET, NSET=SIDE, SURFACE=BODY.{side}", "*ELSET, ELSET=LAST", "2",
                 "*NSET, NSET=PART, ELSET=LAST", "*STEP", "*STATIC", "*BOUNDARY",
                 "BODY.BOTTOM, 1, 2", "BODY.TOP, 2, 2, 0.01", "*END STEP"],
                [("U2", "SIDE", "LAST", value, 1e-12, "ABS"),
                 ("S22", "PART", "LAST", 10.0, 1e-9)])

    follows(tmp_path, make, "TOP", "BOTTOM")


def test_more_increments_than_inc_grow(tmp_path):
    """As in CalculiX: each half as long again, up to the largest; with DIRECT they are an error."""
    cards = [*mesh("BODY", [0.0, 1.0], [0.0, 1.0]), *material("BODY"), "*STEP, INC=10", "*STATIC",
             "0.01, 1., 1.E-5, 0.5", "*BOUNDARY", "BODY.BOTTOM, 1, 2", "*CLOAD", "BODY.TOP, 2, 1.", "*END STEP"]
    deck = write(tmp_path / "deck.inp", cards)
    process = run("run", "--quiet", deck, "--out", tmp_path)
    assert process.returncode == 0
    assert "INC=" not in process.stderr
    assert "*STATIC: INC=10 is not enough for increments of 1E-2; they grow, each to 1.5 times the " \
        "one before, up to 0.5" in " ".join(deck.with_suffix(".lst").read_text().split())
    with h5py.File(deck.with_suffix(".vtkhdf")) as file:
        times = file["history/time"][()]
    np.testing.assert_allclose(times, [*(0.02 * (1.5**n - 1.0) for n in range(1, 10)), 1.0])
    direct = write(tmp_path / "direct.inp", [card.replace("*STATIC", "*STATIC, DIRECT")
                                             for card in cards])
    process = run("check", direct)
    assert process.returncode == 1
    assert "the step takes 100 increments of 1E-2, more than the 10 of INC=; give INC=100 or a first increment of 0.1" in process.stderr
