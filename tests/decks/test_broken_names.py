"""A name that nothing has is an error that names it, on every card that takes a name, beside all
cards that are ignored."""

import re
import resource

import pytest
from deck_runs import DECKS, run

TABLE = (DECKS.parents[1] / "src" / "deck" / "reading" / "keywords.f90").read_text()
NOWHERE = "NOWHERE"
NUMBER = "7777"

# Decks that are right, of a mesh, a model and a step; what is in brackets is broken, one at a time.
MESH = """*NODE
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
11, 0., 1.
12, 1., 1.
13, 1., 2.
14, 0., 2.
*ELEMENT, TYPE=CPE4, ELSET=A
1, 1, 2, 3, 4
*ELEMENT, TYPE=CPE4, ELSET=B
2, 11, 12, 13, 14
*NSET, NSET=LOW
1, 2
*NSET, NSET=TOP
13, 14
"""
MODEL = """*SURFACE, NAME=SA
A, S3
*SURFACE, NAME=SB
B, S1
*SURFACE, NAME=ST
B, S3
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*CONDUCTIVITY
1.
*DENSITY
1.
*SOLID SECTION, ELSET=A, MATERIAL=M
*SOLID SECTION, ELSET=B, MATERIAL=M
*AMPLITUDE, NAME=RAMP
0., 0., 1., 1.
*TIME POINTS, NAME=TIMES
0.5
*SURFACE INTERACTION, NAME=I
*FRICTION
0.3
*GAP CONDUCTANCE
1., 0.
1., 1.
*CONTACT PAIR, INTERACTION=I, NAME=F
SB, SA
"""
STEP = """*STEP
*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE
0.5, 1.
*BOUNDARY
LOW, 1, 2
TOP, 1
LOW, 11, 11, 0.
TOP, 11, 11, 1.
*CLOAD
TOP, 2, -1.
"""
BODY = """*NODE
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
*ELEMENT, TYPE=CPE4, ELSET=A
1, 1, 2, 3, 4
*SURFACE, NAME=S
A, S3
*SOLID SECTION, ELSET=A, MATERIAL=M
"""
ASSEMBLY = f"""*PART, NAME=P
{BODY}*END PART
*ASSEMBLY, NAME=ALL
*INSTANCE, NAME=ONE, PART=[P]
*END INSTANCE
*NSET, NSET=LOW, INSTANCE=[ONE]
1, 2
*NSET, NSET=TOP, INSTANCE=ONE
[3], 4
*ELSET, ELSET=MORE, INSTANCE=[ONE]
1
*END ASSEMBLY
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*CONDUCTIVITY
1.
{STEP}"""


def model(cards):
    """Return a deck with more cards before its first step."""
    return MESH + MODEL + cards + STEP


def step(cards):
    """Return a deck with more cards in its step."""
    return MESH + MODEL + STEP + cards


def changed(old, new):
    """Return a deck in which a card is another one."""
    deck = MESH + MODEL + STEP
    assert old in deck
    return deck.replace(old, new)


REFERENCE = "*NODE\n99, 0.5, 2.\n98, 0.5, 2.\n*NSET, NSET=R\n99\n*NSET, NSET=Q\n98\n"
HELD = "*BOUNDARY\n99, 1, 2\n99, 6\n"
FREE = STEP.replace("TOP, 1\n", "").replace("*CLOAD\nTOP", "*CLOAD\n99")
DRAWING = """*NODE
99, 0., 3.
*SURFACE, NAME=DIE, TYPE=SEGMENTS
START, 2., 2.
LINE, -1., 2.
"""
# The cards that take names, and decks with them.
CARDS = {
    "ELEMENT": [MESH.replace("1, 1, 2", "1, [1], 2") + MODEL + STEP],
    "NGEN": [model("*NODE\n31, 5., 0.\n35, 5., 4.\n*NGEN, NSET=N\n[31], [35], 1\n"),
             model("*NODE\n31, 1., 0.\n35, 0., 1.\n39, 0., 0.\n*NGEN, LINE=C\n31, 35, 1, [39]\n")],
    "NFILL": [model("*NFILL\n[LOW], [TOP], 2, 100\n"), model("*NFILL\n[1], [14], 2, 100\n")],
    "NCOPY": [model("*NCOPY, OLD SET=[LOW], CHANGE NUMBER=100, SHIFT\n0., 9., 0.\n")],
    "ELGEN": [MESH + "*NODE\n15, 1., 3.\n16, 0., 3.\n*NSET, NSET=UP\n15, 16\n*ELEMENT, TYPE=CPE4, "
              "ELSET=C\n5, 14, 13, 15, 16\n*ELGEN, ELSET=C\n[5], 1\n" + MODEL.replace("B, S3", "C, S3")
              + "*SOLID SECTION, ELSET=C, MATERIAL=M\n" + STEP],
    "ELCOPY": [MESH + "*NCOPY, OLD SET=LOW, CHANGE NUMBER=20, SHIFT\n0., 5., 0.\n*NODE\n23, 1., 6.\n"
               "24, 0., 6.\n*ELCOPY, OLD SET=[A], ELEMENT SHIFT=50, SHIFT NODES=20, NEW SET=C\n" + MODEL
               + "*SOLID SECTION, ELSET=C, MATERIAL=M\n*BOUNDARY\n21, 1, 2\n22, 2\n21, 11\n" + STEP],
    "NSET": [model("*NSET, NSET=N\n[1], [LOW]\n*NSET, NSET=N, ELSET=[A]\n*NSET, NSET=N, SURFACE=[SA]\n"
                   "*NSET, NSET=G, GENERATE\n[1, 2|7777, 7778]\n"), ASSEMBLY],
    "ELSET": [model("*ELSET, ELSET=E\n[1], [A]\n*ELSET, ELSET=G, GENERATE\n[1, 2|7777, 7778]\n"),
              ASSEMBLY],
    "SURFACE": [changed("A, S3", "[A], S3"), changed("A, S3", "[1], S3"),
                changed("*SURFACE, NAME=ST\nB, S3", "*SURFACE, NAME=ST, TYPE=NODE\n[13]\n14"),
                changed("*SURFACE, NAME=ST\nB, S3", "*SURFACE, NAME=ST, TYPE=NODE\n[TOP]")],
    "SOLID SECTION": [changed(
        "*SOLID SECTION, ELSET=A, MATERIAL=M", "*ORIENTATION, NAME=O\n1., 0., 0., 0., 1., 0.\n"
        "*SOLID SECTION, ELSET=[A], MATERIAL=[M], ORIENTATION=[O]"),
        changed("*SOLID SECTION, ELSET=A, MATERIAL=M", "*NODE\n99, 0., 0.\n*SOLID SECTION, ELSET=A, "
                "MATERIAL=M, REF NODE=[99]").replace("CPE4, ELSET=A", "CPEG4, ELSET=A")],
    "SPRING": [model("*ELEMENT, TYPE=SPRINGA, ELSET=SP\n9, [13], [2]\n*SPRING, ELSET=[SP]\n1.\n"),
               model("*ELEMENT, TYPE=SPRING1, ELSET=SP\n9, [13]\n*SPRING, ELSET=SP\n1\n1.\n"),
               model("*ELEMENT, TYPE=SPRING2, ELSET=SP\n9, [13], [1]\n*SPRING, ELSET=SP\n1, 1\n1.\n"),
               model("*ELEMENT, TYPE=T2D2, ELSET=SP\n9, [13], [2]\n*SOLID SECTION, ELSET=[SP], "
                     "MATERIAL=[M]\n")],
    "INITIAL CONDITIONS": [model("*INITIAL CONDITIONS, TYPE=TEMPERATURE\n[LOW], 1.\n[13], 1.\n"),
                           model("*INITIAL CONDITIONS, TYPE=STRESS\n[A], 1., 0., 0.\n[2], 1., 0., 0.\n")],
    "CONTACT PAIR": [changed("*CONTACT PAIR, INTERACTION=I, NAME=F\nSB, SA",
                             "*NSET, NSET=BOTTOM\n11, 12\n*CONTACT PAIR, INTERACTION=[I], "
                             "NAME=F, ADJUST=[BOTTOM]\n[SB], [SA]")],
    "TIE": [changed("*CONTACT PAIR, INTERACTION=I, NAME=F\nSB, SA", "*TIE, NAME=T\n[SB], [SA]")],
    "CLEARANCE": [model("*CLEARANCE, MASTER=[SA], SLAVE=[SB], VALUE=0.\n")],
    "TRANSFORM": [model("*TRANSFORM, NSET=[TOP], TYPE=R\n1., 0., 0., 0., 1., 0.\n")],
    "INSTANCE": [ASSEMBLY],
    "START": [model("*START, FROM=GIVEN\n[F], 1.\n")],
    "REFINE": [model("*REFINE, LEVELS=1, SURFACE=[SA]\n"), model("*REFINE, LEVELS=1, ELSET=[A]\n")],
    "OPTIONS": ["*OPTIONS, LOAD=[TOP],11\n" + MESH + MODEL + STEP],
    "PARAMETER": [model("*PARAMETER\nk = 2\n*BOUNDARY\n1, 1, <[k]>\n"), ],
    "VERIFY": [model("*VERIFY, KIND=ANALYTIC\nNT, [LOW], LAST, 0., 1.\nNT, [1], LAST, 0., 1.\n"
                     "heat_rate, [F], LAST, 1., 1.\npressure, [F]@0., LAST, 1., 1.\n")],
    "ACCURACY": [model("*ACCURACY\nnormal_force, 0.01, REL, [F]\n")],
    "EQUATION": [model("*EQUATION\n2\n[3], 2, 1., [4], 2, -1.\n"),
                 model("*NSET, NSET=N\n4\n*NSET, NSET=E\n3\n*EQUATION\n2\n[E], 2, 1., [N], 2, -1.\n")],
    "COUPLING": [MESH + MODEL + REFERENCE + f"*COUPLING, REF NODE={node}, SURFACE=[ST], "
                 "CONSTRAINT NAME=C\n*KINEMATIC\n1, 2\n" + FREE for node in ("[99]", "[R]")],
    "RIGID BODY": [MESH + MODEL + REFERENCE + f"*RIGID BODY, REF NODE={node}, {members}\n" + FREE
                   for node, members in (("[99]", "ELSET=[B], ROT NODE=[98]"), ("[R]", "NSET=[TOP]"),
                                         ("99", "PIN NSET=[TOP], ROT NODE=[Q]"),
                                         ("99", "TIE NSET=[TOP]"))]
    + [MESH + MODEL + DRAWING + "*RIGID BODY, REF NODE=99, ANALYTICAL SURFACE=[DIE]\n*CONTACT PAIR, "
       "INTERACTION=I, NAME=D\nST, DIE\n*BOUNDARY\n99, 1, 2\n99, 6\n99, 11\n" + STEP.replace(
           "*CLOAD\nTOP, 2, -1.\n", "")],
    "PRE-TENSION SECTION": [
        MESH + "*NODE\n15, 1., 3.\n16, 0., 3.\n*NSET, NSET=R\n99\n*ELEMENT, TYPE=CPE4, ELSET=B\n"
        "3, 14, 13, 15, 16\n*NODE\n99, 5., 5.\n" + MODEL.replace("B, S3", "2, S3").replace(
            "B, S1", "2, S1") + f"*PRE-TENSION SECTION, NODE={node}, SURFACE=[ST]\n*BOUNDARY\n15, 2\n"
        "16, 1, 2\n" + STEP.replace("TOP, 1\n", "").replace("*CLOAD\nTOP, 2", "*CLOAD\n99, 1")
        for node in ("[99]", "[R]")],
    "BOUNDARY": [step("*BOUNDARY, AMPLITUDE=[RAMP]\n[LOW], 11, 11, 5.\n[2], 11, 11, 5.\n"),
                 model("*BOUNDARY\n[LOW], 1\n[2], 1\n")],
    "CLOAD": [step("*CLOAD, AMPLITUDE=[RAMP]\n[LOW], 2, 5.\n[4], 2, 5.\n")],
    "DLOAD": [step("*DLOAD, AMPLITUDE=[RAMP]\n[B], P3, 5.\n[1], GRAV, 5., 0., -1., 0.\n")],
    "DSLOAD": [step("*DSLOAD, AMPLITUDE=[RAMP]\n[ST], P, 5.\n")],
    "CFLUX": [step("*CFLUX, AMPLITUDE=[RAMP]\n[4], 11, 5.\n")],
    "DFLUX": [step("*DFLUX, AMPLITUDE=[RAMP]\n[B], S2, 5.\n[1], BF, 5.\n")],
    "FILM": [step("*FILM, AMPLITUDE=[RAMP], FILM AMPLITUDE=[RAMP]\n[B], F2, 5., 1.\n[1], F2, 5., 1.\n")],
    "DSFLUX": [step("*DSFLUX, AMPLITUDE=[RAMP]\n[ST], S, 5.\n")],
    "SFILM": [step("*SFILM, AMPLITUDE=[RAMP], FILM AMPLITUDE=[RAMP]\n[ST], F, 5., 1.\n")],
    "TEMPERATURE": [step("").replace("*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE", "*STATIC").replace(
        "LOW, 11, 11, 0.\nTOP, 11, 11, 1.\n", "") + "*TEMPERATURE, AMPLITUDE=[RAMP]\n[LOW], 1.\n[13], 1.\n"],
    "CHANGE FRICTION": [step("*CHANGE FRICTION, INTERACTION=[I]\n*FRICTION\n0.1\n")],
    "MODEL CHANGE": [step("*BOUNDARY\nTOP, 2\n*MODEL CHANGE, TYPE=CONTACT PAIR, REMOVE\n[SB], [SA]\n")],
    "CONTACT INTERFERENCE": [step("*CONTACT INTERFERENCE, AMPLITUDE=[RAMP]\n[SB], [SA], 0.001\n")],
    **{f"{what} {card}": [step(f"*{what} {card}, TIME POINTS=[TIMES]\n")]
       for card in ("FILE", "OUTPUT") for what in ("NODE", "EL", "CONTACT")
       if (what, card) != ("EL", "OUTPUT")},
    "ELEMENT OUTPUT": [step("*ELEMENT OUTPUT, TIME POINTS=[TIMES]\n")],
    "NODE PRINT": [step("*NODE PRINT, NSET=[LOW], TIME POINTS=[TIMES]\nU\n")],
    "EL PRINT": [step("*EL PRINT, ELSET=[A], TIME POINTS=[TIMES]\nS\n")],
    "CONTACT PRINT": [step("*CONTACT PRINT, TIME POINTS=[TIMES]\n")],
}
# The others.
NAMELESS = set("""HEADING, PHYSICAL CONSTANTS, NODE, MATERIAL, ELASTIC, EXPANSION, CONDUCTIVITY, DENSITY,
PLASTIC, CYCLIC HARDENING, CREEP, INELASTIC HEAT FRACTION, VISCO, CYCLE, LATENT HEAT,
ANNEAL TEMPERATURE, SPECIFIC HEAT, ORIENTATION, AMPLITUDE, SURFACE INTERACTION, FRICTION, GAP CONDUCTANCE, GAP LAW,
GAP HEAT GENERATION, GAP RADIATION, WEAR, SURFACE BEHAVIOR, PART, END PART, ASSEMBLY, END ASSEMBLY,
END INSTANCE, FIXED POINT, THERMAL SCHEME, CONTINUATION, SOLVER, KINEMATIC, STEP, STATIC, NO ANALYSIS,
STABILITY, TIME POINTS, HEAT TRANSFER, COUPLED TEMPERATURE-DISPLACEMENT,
UNCOUPLED TEMPERATURE-DISPLACEMENT, RESTART, END STEP, INCLUDE""".replace("\n", " ").split(", "))
# Parameters of the first that name nothing, or what their card defines.
VALUES = set("""ADJUST, BIAS, CHANGE NUMBER, DISTANCE, ELEMENT SHIFT, FORMAT, FREQUENCY, GLOBAL, ISOTHERMAL,
KIND, LEVELS, LINE, MULTIPLE, NAME, NEW SET, OP, ORDER, PAIRING, PLANE, POSITION, POSITION TOLERANCE,
REFLECT, ROUNDS, SHIFT NODES, SLIDING, SOURCE, TOTALS, TYPE, UNITS, VALUE, WIDTH, ERRORS, CONSTRAINT NAME,
FROM""".replace("\n", " ").split(", "))
DEFINED = {("ELEMENT", "ELSET"), ("NGEN", "NSET"), ("NFILL", "NSET"), ("ELGEN", "ELSET"),
           ("NSET", "NSET"), ("ELSET", "ELSET")}


def table():
    """Return the parameters with a value of each keyword that the program knows."""
    text = re.search(r"known_keywords\(\d+\) = \[.*?\n\n", TABLE, re.S)[0]
    constants = dict(re.findall(r"parameter :: (\w+) = '([^']*)'", TABLE))
    found = {}
    for name, rest in re.findall(r"keyword_type\('([^']*)'(.*?)\)(?=, &\n|\])", text, re.S):
        texts = re.findall(r"'[^']*'|file_parameters|stabilization", rest)
        words = "".join(constants.get(text, text.strip("'")) for text in texts)
        found[name] = re.findall(r"(?:^|/)([A-Z][^/]*)=", words)
    return found


def ignored(word):
    """Return all cards that are ignored, with a word in the place of every name and value."""
    kinds = re.findall(r"advice_type\((?:passed_over|not_printed|refused_with_data), '', ((?:[^,&]|&\n)*),",
                       TABLE)
    names = "/".join("".join(re.findall(r"'([^']*)'", text)) for text in kinds).split("/")
    parameters = ("NAME", "NODE", "NSET", "ELSET", "SURFACE", "FREQUENCY", "X")
    values = "".join(f", {parameter}={word}" for parameter in parameters)
    return "".join(f"*{name}{values}\n" for name in names)


def broken():
    """Return each deck with one name broken, as keyword, deck, what it says."""
    for keyword, decks in CARDS.items():
        for deck in decks:
            marks = list(re.finditer(r"\[(.*?)(?:\|(.*?))?\]", deck))
            for mark in marks:
                wrong = mark[2] or (NUMBER if mark[1].isdigit() else NOWHERE)
                text = deck[:mark.start()] + wrong + deck[mark.end():]
                yield keyword, plain(text), wrong.split(",")[0]


def plain(deck):
    """Return a deck without the marks of names."""
    return re.sub(r"\[(.*?)(?:\|.*?)?\]", r"\1", deck)


def with_ignored(deck, word):
    """Return a deck with the ignored cards at its start and its end."""
    return ignored(word) + deck + ignored(word) + f"*NODE OUTPUT, X={word}\n*END STEP\n"


def checked(folder, text):
    """Return status and messages of a check."""
    path = folder / "deck.inp"
    path.write_text(text)
    process = run("check", "--quiet", path)
    return process.returncode, process.stderr


def test_every_card_of_the_program_is_here():
    known = table()
    assert len(known) > 80
    assert known.keys() == CARDS.keys() | NAMELESS
    assert not CARDS.keys() & NAMELESS


@pytest.mark.parametrize("keyword", CARDS)
def test_every_name_on_a_card_is_broken(keyword):
    marks = " ".join(CARDS[keyword])
    names = {name for name in table()[keyword] if (keyword, name) not in DEFINED}
    for name in names - VALUES:
        assert f"{name}=[" in marks, f"{name}= of *{keyword}"


@pytest.mark.parametrize("keyword", CARDS)
def test_the_decks_are_right(tmp_path, keyword):
    for deck in CARDS[keyword]:
        status, said = checked(tmp_path, with_ignored(plain(deck), NUMBER))
        assert status == 0, deck + said


@pytest.mark.parametrize("keyword", CARDS)
def test_a_broken_name_is_an_error_beside_ignored_cards(tmp_path, keyword):
    count = 0
    for name, deck, word in broken():
        if name != keyword:
            continue
        count += 1
        status, said = checked(tmp_path, with_ignored(deck, word))
        assert status == 1, deck
        assert re.search(rf"error: .*\b{word}\b", said), deck + said
    assert count > 0


def test_an_ignored_card_does_not_stand_for_another(tmp_path):
    deck = plain(CARDS["COUPLING"][0]).replace("*KINEMATIC\n1, 2\n", ignored("X"))
    status, said = checked(tmp_path, deck + "*END STEP\n")
    assert status == 1
    assert "*KINEMATIC is missing" in said


def test_sets_that_hold_a_set_twice_do_not_double(tmp_path):
    """27 levels of a set of two nodes would have 1 GB of members."""
    sets = "".join(f"*NSET, NSET=S{k}\nS{k - 1}, S{k - 1}\n" for k in range(1, 28))
    deck = model("*NSET, NSET=S0\n1, 2\n" + sets + "*BOUNDARY\nS27, 1\n")
    status, said = checked(tmp_path, deck + "*END STEP\n")
    assert status == 0, said
    assert resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss < 500_000, "kB"


def test_sets_that_are_copied_may_hold_a_set_twice_or_each_other(tmp_path):
    """40 levels name the first set 2^40 times; two sets that hold each other have no last level."""
    sets = "".join(f"*NSET, NSET=S{k}\nS{k - 1}, S{k - 1}\n" for k in range(1, 41))
    copy = "*NCOPY, CHANGE NUMBER=100, OLD SET=S40, SHIFT\n9., 0., 0.\n"
    status, said = checked(tmp_path, model("*NSET, NSET=S0\n1, 2\n" + sets + copy) + "*END STEP\n")
    assert status == 0, said
    sets = "*NSET, NSET=X\n1, Y\n*NSET, NSET=Y\n2, X\n"
    status, said = checked(tmp_path, model(sets + copy.replace("S40", "X")) + "*END STEP\n")
    assert status == 1
    assert "unknown node set Y" in said
