"""What docs/deck.md calls ignored: it changes nothing, and the listing says so."""

import pytest
from blocks import write
from deck_runs import CYLINDER, copy_deck, run
from physics import judge, material, mesh, verify

CARDS = mesh("UP", [0.0, 1.0], [0.0, 0.5]) + mesh("LOW", [0.0, 1.0], [-1.0, 0.0], first=101)
PAIR = "*CONTACT PAIR, INTERACTION=FACES, NAME=FACE"
SECTION = next(card for card in material("UP", (1000.0, 0.0)) if card.startswith("*SOLID"))


def deck():
    """Return two blocks, nu = 0, pressed together by 5 and heated by 40 between smooth walls, and
    what is then known."""
    cards = list(CARDS)
    for name in ("UP", "LOW"):
        cards += material(name, (1000.0, 0.0), 1e-5)
    cards += ["*SURFACE INTERACTION, NAME=FACES", "*FRICTION", "0.3", PAIR, "UP.BOTTOM, LOW.TOP",
              "*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "LOW.BOTTOM, 2", "UP, 1", "LOW, 1",
              "*DSLOAD", "UP.TOP, P, 5.", "*TEMPERATURE", "UP, 40.", "LOW, 40.", "*END STEP"]
    return cards, [("pressure", "FACE", "LAST", 5.0, 1e-9),
                   ("S11", "UP", "LAST", -1000.0 * 1e-5 * 40.0, 1e-9),
                   ("U2", "UP.TOP", "LAST", 1.5 * (1e-5 * 40.0 - 5.0 / 1000.0), 1e-9)]


# A card or a part of one, what takes its place, and what the listing says of it.
CHANGES = {
    "SURFACE BEHAVIOR": ("*FRICTION", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1.E7, 3.\n"
                         "*FRICTION", "*SURFACE BEHAVIOR"),
    "hard": ("*FRICTION", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD\n*FRICTION",
             "*SURFACE BEHAVIOR"),
    "variables of the user": ("*EXPANSION", "*USER OUTPUT VARIABLES\n3,\n*EXPANSION", "*USER OUTPUT VARIABLES"),
    "CONTROLS": ("*STEP", "*CONTROLS, RESET\n*STEP", "*CONTROLS"),
    "SPECIFIC HEAT": ("*EXPANSION", "*SPECIFIC HEAT\n460.\n*EXPANSION", "*SPECIFIC HEAT"),
    "type of a pair": (PAIR, PAIR + ", TYPE=SURFACE TO SURFACE", "TYPE"),
    "ZERO": ("*EXPANSION", "*EXPANSION, ZERO=300.", "ZERO"),
    "SOLVER": ("*STATIC", "*STATIC, SOLVER=SPOOLES", "SOLVER"),
    "stick slope": ("0.3", "0.3, 1.E5", "stick slope"),
    "thickness": ("*FRICTION", "1.,\n*FRICTION", "*SURFACE INTERACTION"),
    "section controls": (SECTION, "*SECTION CONTROLS, NAME=EC, HOURGLASS=ENHANCED\n1., 1., 1.\n"
                         + SECTION + ", CONTROLS=EC", "SECTION CONTROLS"),
    "controls of a section": (SECTION, SECTION + ", CONTROLS=EC", "CONTROLS is ignored"),
    "slip tolerance": ("*FRICTION", "*FRICTION, SLIP TOLERANCE=0.005", "SLIP TOLERANCE"),
    "name of a step": ("*STEP", "*STEP, NAME=PRESS, UNSYMM=YES, EXTRAPOLATION=NO",
                       "EXTRAPOLATION"),
    "stabilization": ("*STATIC", "*STATIC, STABILIZE=2.E-4, ALLSDTOL=0.05, CONTINUE=NO",
                      "STABILIZE"),
    "stabilization by default": ("*STATIC", "*STATIC, STABILIZE", "STABILIZE"),
    "axes of output": ("*END STEP", "*ELEMENT OUTPUT, DIRECTIONS=YES\nS\n*END STEP",
                       "DIRECTIONS"),
    "symmetry of the third axis": ("*BOUNDARY", "*BOUNDARY, TYPE=DISPLACEMENT\nUP, ZSYMM", "3 to 6"),
    "no thickness": (PAIR, PAIR + ", NO THICKNESS, CPSET=WHOLE, GEOMETRIC CORRECTION=ROUND",
                     "GEOMETRIC CORRECTION"),
    "penetration": (PAIR, PAIR + ", HCRIT=0.1, EXTENSION ZONE=0.2", "HCRIT"),
    "multipliers": ("*FRICTION", "*FRICTION, LAGRANGE", "LAGRANGE"),
    "no dependence": ("*EXPANSION", "*EXPANSION, DEPENDENCIES=0", "DEPENDENCIES"),
    "title of a step": ("*STEP", "*STEP\n#1 Pressed by 5, " + "and heated " * 60, "title"),
    "energies": ("*END STEP", "*ENERGY OUTPUT, ELSET=NOTHING, VARIABLE=PRESELECT\nALLSE\n*END STEP",
                 "*ENERGY OUTPUT"),
    "controls of increments": ("*STATIC", "*CONTROLS, ANALYSIS=DISCONTINUOUS\n*STATIC", "*CONTROLS"),
    "averages of output": ("*END STEP", "*EL FILE, POSITION=AVERAGED AT NODES, LAST MODE=2\nS\n"
                           "*END STEP", "LAST MODE"),
    "print without data": ("*END STEP", "*EL PRINT, POS=CENTROIDAL, FREQ=2\n*NODE PRINT\n*END STEP",
                           "without data prints nothing"),
    "node beside the plane": ("*STEP", "*NODE\n9999, 3., 3., 3.\n*STEP", "third coordinates"),
    "points of a section": (SECTION, SECTION + "\n1., 5", "behind the thickness"),
    "fields": ("*STEP", "*INITIAL CONDITIONS, TYPE=FIELD, VARIABLE=1\nUP, 3.\n*STEP", "TYPE=FIELD"),
    "states": ("*STEP", "*INITIAL CONDITIONS, TYPE=SOLUTION\nUP, 3., 4.\n*STEP", "TYPE=SOLUTION"),
    "speeds": ("*STEP", "*INITIAL CONDITIONS, TYPE=VELOCITY\nUP, 1, 4.\n*STEP", "TYPE=VELOCITY"),
    "techniques": ("*STATIC", "*SOLUTION TECHNIQUE, TYPE=QUASI-NEWTON\n*STATIC",
                   "SOLUTION TECHNIQUE"),
    "sensitivities": ("*STEP", "*DESIGN PARAMETER\nE\n*STEP, DSA", "DSA"),
    "responses": ("*END STEP", "*DESIGN RESPONSE, FREQ=1\n*NODE RESPONSE, NSET=UP\nU\n*END STEP",
                  "*NODE RESPONSE"),
    "followers": ("*DSLOAD", "*DSLOAD, FOLLOWER=NO, CONSTANT RESULTANT=YES", "CONSTANT RESULTANT"),
    "force that follows": ("*DSLOAD", "*CLOAD, FOLLOWER\nUP, 2, 0.\n*DSLOAD", "FOLLOWER"),
    "limits of stress": ("*EXPANSION", "*FAIL STRESS\n1., -1., 1., -1., 1.\n*EXPANSION",
                         "FAIL STRESS"),
    "temperature": ("1e-05", "1e-05, 20.", "temperature"),
}


@pytest.mark.parametrize("name", CHANGES)
def test_what_is_not_needed_changes_nothing(tmp_path, name):
    old, new, said = CHANGES[name]
    cards, checks = deck()
    assert old in cards
    changed = "\n".join(new if card == old else card for card in cards).splitlines()
    judge(tmp_path, changed, checks)
    text = (tmp_path / "deck.lst").read_text()
    notes = text[text.index("\nDEFAULTS AND IGNORED CARDS"):text.index("\nINCREMENTS")]
    assert said in notes, notes


def test_a_third_coordinate_of_zero_is_passed_over(tmp_path):
    cards, checks = deck()
    nodes = [card + ", 0." if card.count(",") == 2 and card[0].isdigit() and "S" not in card
             else card for card in cards]
    assert nodes != cards
    process = run("run", "--quiet", write(tmp_path / "deck.inp", nodes, verify(*checks)), "--out",
                  tmp_path)
    assert process.returncode == 0, process.stderr


def test_creep_none_is_what_happens(tmp_path):
    card = "*COUPLED TEMPERATURE-DISPLACEMENT, STEADY STATE, DIRECT"
    deck = copy_deck(CYLINDER, tmp_path / "creep.inp", changes={card: card + ", CREEP=NONE"})
    plain = run("check", CYLINDER)
    process = run("check", deck)
    assert process.returncode == plain.returncode == 0
    assert process.stderr == plain.stderr
    assert process.stdout.removeprefix(str(deck)) == plain.stdout.removeprefix(str(CYLINDER))


def test_a_deck_without_analysis_is_checked_only(tmp_path):
    cards, checks = deck()
    at = cards.index("*STATIC")
    path = write(tmp_path / "deck.inp", cards[:at], ["*NO ANALYSIS"], cards[at + 2:])
    process = run("run", path, "--out", tmp_path)
    assert (process.returncode, process.stdout) == (0, "")
    assert "note: not solved: it has *NO ANALYSIS" in process.stderr
    assert not path.with_suffix(".vtkhdf").exists()
    path.write_text(path.read_text().replace("*FRICTION", "*FRICTIN"))
    assert run("check", path).returncode == 1


def test_no_card_of_output_stops_a_run(tmp_path):
    """The misspelt frequency is taken: the only table is that of the end."""
    cards, checks = deck()
    output = ["*NODE PRINT, FREQENCY=10", "U, PEEQ", "*EL PRINT, POSITION=NODES", "S, MISES",
              "*CONTACT PRINT, NSET=WHOLE", "CDIS", "*NODE FILE, NSET=WHOLE, XYZ", "U, WHAT",
              "*CONTACT OUTPUT, SLAVE=THAT", "CSTRESS"]
    judge(tmp_path, [*cards[:-1], *output, cards[-1]], checks)
    listing = (tmp_path / "deck.lst").read_text()
    said = " ".join(listing.split())
    for words in ("FREQUENCY is taken", "quantity PEEQ of *NODE PRINT is not printed",
                  "quantity MISES of *EL PRINT", "*NODE FILE: XYZ is ignored"):
        assert words in said
    tables = listing[listing.index("\nINCREMENTS"):]
    assert tables.count("NODES OF ALL") == tables.count("INTEGRATION POINTS OF ALL") == 1
    nodes = tables.partition("NODES OF ALL")[2].partition("INTEGRATION")[0]
    assert sum(line[:8].strip().isdigit() for line in nodes.splitlines()) == sum(
        card.split(",")[0].isdigit() and card.count(",") == 2 for card in CARDS)
