"""Parts and instances are the flat deck that they stand for."""

import pytest
from blocks import write
from calculix import thercon
from changes import note_changes


PART = ["*PART, NAME=BLOCK", "*NODE", "1, 0., 0.", "2, 2., 0.", "3, 2., 1.", "4, 0., 1.",
        "*NGEN", "1, 2", "*ELEMENT, TYPE=CPE4", "1, 1, 2, 3, 4", "*NSET, NSET=ALL, GENERATE", "1, 4",
        "*ELSET, ELSET=ALL", "1", "*NSET, NSET=LOW", "1, 2", "*NSET, NSET=HIGH", "3, 4",
        "*SURFACE, NAME=UPPER", "ALL, S3", "*SURFACE, NAME=LOWER", "ALL, S1",
        "*ORIENTATION, NAME=GRAIN", "1., 0., 0., 0., 1., 0.",
        "*SOLID SECTION, ELSET=ALL, MATERIAL=WOOD, ORIENTATION=GRAIN", "*END PART"]
WOOD = ["*MATERIAL, NAME=WOOD", "*ELASTIC, TYPE=ENGINEERING CONSTANTS",
        "1200., 500., 800., .3, .2, .25, 260., 240.", "230."]
STEP = ["*SURFACE INTERACTION, NAME=SMOOTH", "*CONTACT PAIR, INTERACTION=SMOOTH, NAME=FACE",
        "FOOT, SEAT", "*STEP", "*STATIC", "*BOUNDARY", "BASE, 1, 2", "SIDE, 1",
        "TOP, 2, 2, -0.01", "*NODE PRINT, NSET=BODIES", "U, RF", "*EL PRINT, ELSET=BODIES", "S",
        "*END STEP"]


def assembled(part="BLOCK", low="A", high="B", x=0.0):
    """Return a deck of two instances, the upper one on its side: 1 wide, from 1 to 3, all of it
    moved by x."""
    return [*(card.replace("NAME=BLOCK", f"NAME={part}") for card in PART), "*PART, NAME=EMPTY",
            "*END PART", "*ASSEMBLY, NAME=STACK",
            f"*INSTANCE, NAME={low}, PART={part}", f"{x}, 0., 0.", "*END INSTANCE",
            f"*INSTANCE, NAME={high}, PART={part}", f"{1 + x}, 1., 0.",
            f"{1 + x}, 1., 0., {1 + x}, 1., 1., 90.", "*END INSTANCE",
            f"*NSET, NSET=BASE, INSTANCE={low}", "LOW", "*NSET, NSET=SIDE",
            f"{high}.1, {high}.4", "*NSET, NSET=TOP", f"{high}.2, {high}.3",
            f"*ELSET, ELSET=BODIES, INSTANCE={low}", "1", "*ELSET, ELSET=BODIES",
            f"{high}.ALL", "*NSET, NSET=BODIES", f"{low}.ALL, {high}.ALL",
            f"*ELSET, ELSET=FOOT, INSTANCE={high}", "ALL", "*SURFACE, NAME=FOOT", "FOOT, S4",
            f"*ELSET, ELSET=SEAT, INSTANCE={low}", "ALL", "*SURFACE, NAME=SEAT", "SEAT, S3",
            "*END ASSEMBLY", *WOOD, *STEP]


def flat():
    """Return this deck written out: the numbers of the second instance are raised by 10."""
    return ["*NODE", "1, 0., 0.", "2, 2., 0.", "3, 2., 1.", "4, 0., 1.", "11, 1., 1.",
            "12, 1., 3.", "13, 0., 3.", "14, 0., 1.", "*ELEMENT, TYPE=CPE4", "1, 1, 2, 3, 4",
            "11, 11, 12, 13, 14", "*NSET, NSET=BODIES", "1, 2, 3, 4, 11, 12, 13, 14",
            "*ELSET, ELSET=BODIES", "1, 11", "*NSET, NSET=BASE", "1, 2", "*NSET, NSET=SIDE",
            "11, 14", "*NSET, NSET=TOP", "12, 13", "*SURFACE, NAME=FOOT", "11, S4",
            "*SURFACE, NAME=SEAT", "1, S3", *WOOD, "*ORIENTATION, NAME=LEVEL",
            "1., 0., 0., 0., 1., 0.", "*ORIENTATION, NAME=UPRIGHT", "0., 1., 0., -1., 0., 0.",
            "*ELSET, ELSET=ONE", "1", "*ELSET, ELSET=OTHER", "11",
            "*SOLID SECTION, ELSET=ONE, MATERIAL=WOOD, ORIENTATION=LEVEL",
            "*SOLID SECTION, ELSET=OTHER, MATERIAL=WOOD, ORIENTATION=UPRIGHT", *STEP]


@pytest.mark.changes("PART, NAME", "INSTANCE", "INSTANCE, NAME", "INSTANCE, PART",
                     "NSET, INSTANCE", "ELSET, INSTANCE")
def test_an_assembly_is_the_flat_deck(tmp_path):
    """A turned instance turns its nodes and its orientation; forces, stresses, contact agree.
    Names, and where the whole stands, change nothing."""
    decks = [assembled(), assembled(part="BRICK", low="UNDER", high="OVER", x=3.0)]
    other = thercon(write(tmp_path / "flat.inp", flat()))
    for deck in decks:
        one = thercon(write(tmp_path / "assembly.inp", deck))
        assert one.keys() == other.keys()
        for quantity, table in other.items():
            assert one[quantity] == pytest.approx(table, rel=1e-9, abs=1e-12), quantity
    note_changes(*decks)
