"""Names of cards and the parameters that use them: swapped, what they give changes places."""

import pytest
from physics import follows, material, mesh

import conduction

# Two square elements, nu = 0, held aside. Everything that has a name has two, A and B; each square
# gets what its chain of names leads to, and a key of SWAPS swaps one link of the chains.

ALONG = (1000.0, 3000.0), (2000.0, 5000.0)   # E1 and E2 of both materials
WARM, PUSH, PULL, MOVED = (10.0, 20.0), (1.0, 2.0), (3.0, 5.0), (0.001, 0.003)
FACTORS = 1.0, 0.5


def swaps(key):
    """Return the names of both cards of a key of its own, and what one is led to by some keys."""
    return (lambda own: ("B", "A") if key == own else ("A", "B"),
            lambda b, *keys: 1 - b if key in keys else b)


def two_squares(key):
    """Return the cards of both squares with one key swapped, and what is then known of them."""
    swapped, at = swaps(key)
    deck, rows = [], []
    for b, x in enumerate((0.0, 3.0)):
        first = 1 + 10 * b
        corners = (x, 0.0), (x + 1.0, 0.0), (x + 1.0, 1.0), (x, 1.0)
        deck += [f"*NODE, NSET=N{swapped('NODE, NSET')[b]}",
                 *(f"{first + n}, {p!r}, {q!r}" for n, (p, q) in enumerate(corners)),
                 f"*ELEMENT, TYPE=CPS4, ELSET=E{swapped('ELEMENT, ELSET')[b]}",
                 f"{1 + b}, {first}, {first + 1}, {first + 2}, {first + 3}",
                 f"*NSET, NSET=T{swapped('NSET, NSET')[b]}", f"{first + 2}, {first + 3}",
                 f"*ELSET, ELSET=X{swapped('ELSET, ELSET')[b]}", f"{1 + b}",
                 f"*SURFACE, NAME=S{swapped('SURFACE, NAME')[b]}", f"{1 + b}, S3"]
    for b in (0, 1):
        one, two = ALONG[b]
        deck += [f"*MATERIAL, NAME=M{swapped('MATERIAL, NAME')[b]}",
                 "*ELASTIC, TYPE=ENGINEERING CONSTANTS",
                 f"{one!r}, {two!r}, 1000., 0., 0., 0., 500., 500.", "500.",
                 f"*ORIENTATION, NAME=O{swapped('ORIENTATION, NAME')[b]}",
                 ("1., 0., 0., 0., 1., 0.", "0., 1., 0., -1., 0., 0.")[b],
                 f"*AMPLITUDE, NAME=C{swapped('AMPLITUDE, NAME')[b]}",
                 f"0., 0., 1., {FACTORS[b]!r}"]
    for b in (0, 1):
        deck += [f"*SOLID SECTION, ELSET=E{swapped('SOLID SECTION, ELSET')[b]}, "
                 f"MATERIAL=M{swapped('SOLID SECTION, MATERIAL')[b]}, "
                 f"ORIENTATION=O{swapped('SOLID SECTION, ORIENTATION')[b]}"]
    deck += ["*STEP", "*STATIC", "1., 1.", "*BOUNDARY", "1, 1, 2", "2, 1, 2", "11, 1, 2",
             "12, 1, 2", "TA, 1", "TB, 1"]
    for b, name in enumerate("AB"):
        deck += [f"*BOUNDARY, AMPLITUDE=C{swapped('BOUNDARY, AMPLITUDE')[b]}",
                 f"T{name}, 2, 2, {MOVED[b]!r}", "*TEMPERATURE", f"N{name}, {WARM[b]!r}", "*DLOAD",
                 f"X{name}, BX, {PUSH[b]!r}", "*DSLOAD", f"S{name}, TRVEC, {PULL[b]!r}, 1., 0., 0."]
    deck += ["*END STEP"]
    for b in (0, 1):
        section = "ELEMENT, ELSET", "SOLID SECTION, ELSET"
        axis = 1 - at(b, *section, "SOLID SECTION, ORIENTATION", "ORIENTATION, NAME")
        young = ALONG[at(b, *section, "SOLID SECTION, MATERIAL", "MATERIAL, NAME")][axis]
        moved = MOVED[at(b, "NSET, NSET")] * FACTORS[
            at(b, "NSET, NSET", "BOUNDARY, AMPLITUDE", "AMPLITUDE, NAME")]
        force = PUSH[at(b, "ELSET, ELSET")] / 4
        first = 1 + 10 * b
        rows += [("U2", first + 2, "LAST", moved, 1e-9),
                 ("S22", first, "LAST", young * moved, 1e-9),
                 ("NT", first, "LAST", WARM[at(b, "NODE, NSET")], 1e-9),
                 ("RF1", first, "LAST", -force, 1e-9), ("RF1", first + 2, "LAST",
                  -force - PULL[at(b, "SURFACE, NAME")] / 2, 1e-9)]
    return deck, rows


NAMES = ["NODE, NSET", "ELEMENT, ELSET", "NSET, NSET", "ELSET, ELSET", "SURFACE, NAME",
         "MATERIAL, NAME", "ORIENTATION, NAME", "AMPLITUDE, NAME", "SOLID SECTION, ELSET",
         "SOLID SECTION, MATERIAL", "SOLID SECTION, ORIENTATION", "BOUNDARY, AMPLITUDE"]


@pytest.mark.parametrize("key", [pytest.param(key, marks=pytest.mark.changes(key))
                                 for key in NAMES])
def test_names_of_a_model(tmp_path, key):
    follows(tmp_path, two_squares, "", key)


# Two stacks of two blocks, with heat through the gap of each.

WIDTHS, GAPS, OMEGAS, HOT, K = (1.0, 2.0), (0.25, 0.5), (3.0, 4.0), 80.0, 2.0


def two_stacks(key):
    """Return two stacks with names as above and what is then known of them."""
    swapped, at = swaps(key)
    deck, rows = [], []
    for b, name in enumerate("AB"):
        xs = [10.0 * b, 10.0 * b + WIDTHS[b]]
        for k, (part, ys) in enumerate((("UP", [1.0, 2.0]), ("LOW", [0.0, 1.0]))):
            deck += mesh(part + name, xs, ys, first=1 + 20 * b + 10 * k)
            deck += material(part + name, conductivity=K)
    for b in (0, 1):
        deck += [f"*SURFACE INTERACTION, NAME=I{swapped('SURFACE INTERACTION, NAME')[b]}",
                 "*GAP LAW, TYPE=GAS", f"{OMEGAS[b]!r}, 1."]
    for b in (0, 1):
        deck += [f"*CONTACT PAIR, INTERACTION=I{swapped('CONTACT PAIR, INTERACTION')[b]}, "
                 f"NAME=P{swapped('CONTACT PAIR, NAME')[b]}",
                 f"UP{swapped('CONTACT PAIR')[b]}.BOTTOM, LOW{swapped('CONTACT PAIR')[b]}.TOP"]
    for b in (0, 1):
        name = swapped("CLEARANCE")[b]
        deck += [f"*CLEARANCE, MASTER=LOW{name}.TOP, SLAVE=UP{name}.BOTTOM, VALUE={GAPS[b]!r}"]
    deck += ["*STEP", "*HEAT TRANSFER, STEADY STATE", "1., 1.", "*BOUNDARY"]
    for name in "AB":
        deck += [f"UP{name}.TOP, 11, 11, {HOT!r}", f"LOW{name}.BOTTOM, 11, 11, 0."]
    for b in (0, 1):
        # Pairs are named by cards; each joins the blocks of a stack.
        where = "P" + swapped("CONTACT PAIR, NAME")[at(b, "CONTACT PAIR")]
        omega = OMEGAS[at(b, "CONTACT PAIR", "CONTACT PAIR, INTERACTION",
                          "SURFACE INTERACTION, NAME")] / (1 + GAPS[at(b, "CLEARANCE")])
        flux, _ = conduction.wall([1.0, 1.0], [K, K], HOT, 0.0, contacts=[omega])
        rows += [("heat_flux", where, "LAST", flux, 1e-9),
                 ("gap", where, "LAST", GAPS[at(b, "CLEARANCE")], 1e-12),
                 ("heat_rate", where, "LAST", flux * WIDTHS[b], 1e-9)]
    return [*deck, "*END STEP"], rows


@pytest.mark.parametrize("key", [pytest.param(key, marks=pytest.mark.changes(key)) for key in (
    "SURFACE INTERACTION, NAME", "CONTACT PAIR", "CONTACT PAIR, INTERACTION",
    "CONTACT PAIR, NAME")])
def test_names_of_contact(tmp_path, key):
    follows(tmp_path, two_stacks, "", key)


@pytest.mark.changes("CLEARANCE, MASTER", "CLEARANCE, SLAVE")
def test_surfaces_of_a_clearance(tmp_path):
    follows(tmp_path, two_stacks, "", "CLEARANCE")
