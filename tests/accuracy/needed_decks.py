"""Decks of the cylinder's mesh, on which heat, contact, friction and coupling are switched on."""

import re
from dataclasses import dataclass

from deck_runs import CYLINDER

LOAD, PUSH = 900.0, -0.4
CONSTANT = ["*GAP LAW, TYPE=CLEARANCE", "0.8, 0.", "0.8, 1."]
VARIABLE = ["*GAP LAW, TYPE=GAS", "0.24E-5, 0.3E-5", "*GAP LAW, TYPE=POWER", "0.8, 0.24, 1."]


@dataclass(frozen=True)
class Case:
    """What is on in a deck."""

    name: str
    heat: bool = False
    mechanics: bool = True
    contact: bool = False
    friction: bool = False
    law: tuple[str, ...] = ()
    errors: bool = False

    @property
    def on(self):
        """Return the parts of the program that the deck needs."""
        on = {name for name in ("heat", "mechanics", "contact", "friction") if getattr(self, name)}
        on |= {"strain by heat"} if self.heat and self.mechanics else set()
        on |= {"coupling"} if list(self.law) == VARIABLE else set()
        return on | ({"estimated errors", "refinement"} if self.errors else set())

    @property
    def analysis(self):
        """Return the card of the analysis, but for its increments."""
        if not self.heat:
            return "*STATIC"
        kind = "*COUPLED TEMPERATURE-DISPLACEMENT" if self.mechanics else "*HEAT TRANSFER"
        return f"{kind}, STEADY STATE"


CASES = (
    Case("mechanics"),
    Case("mechanics, contact", contact=True),
    Case("mechanics, contact, friction", contact=True, friction=True),
    Case("heat", heat=True, mechanics=False),
    Case("heat, contact", heat=True, mechanics=False, contact=True, law=tuple(CONSTANT)),
    Case("heat, mechanics", heat=True),
    Case("heat, mechanics, contact, friction", heat=True, contact=True, friction=True,
         law=tuple(CONSTANT)),
    Case("the same, coupled", heat=True, contact=True, friction=True, law=tuple(VARIABLE)),
    Case("coupled, ERRORS=LAST", heat=True, contact=True, friction=True, law=tuple(VARIABLE),
         errors=True),
)


def mesh():
    """Return the cards of the cylinder's mesh and materials."""
    text = CYLINDER.read_text()
    return re.sub(r", LOAD=TOP,11", "", text[: text.index("*SURFACE INTERACTION")])


def write_deck(case, path, levels, increments):
    """Write the deck of a case; without heat the top is pushed. Return its path."""
    cards = [f"*OPTIONS, ERRORS={'LAST' if case.errors else 'NO'}"]
    cards += [f"*REFINE, LEVELS={levels}"] if levels else []
    if case.contact:
        cards += ["*SURFACE INTERACTION, NAME=FACES", *case.law]
        cards += ["*FRICTION", "0.155"] if case.friction else []
        cards += ["*CONTACT PAIR, INTERACTION=FACES, NAME=FACE", "CURVED, FLAT"]
    cards += ["*STEP, INC=1000", f"{case.analysis}, DIRECT", f"{LOAD / increments!r}, {LOAD!r}"]
    cards += ["*BOUNDARY"]
    if case.heat:
        cards += [f"TOP, 11, 11, {LOAD!r}", "BOTTOM, 11, 11, 0."]
    if case.mechanics:
        cards += ["BOTTOM, 2, 2, 0.", "AXIS, 1, 1, 0.", f"TOP, 2, 2, {0.0 if case.heat else PUSH}"]
    path.write_text(mesh() + "\n".join([*cards, "*END STEP"]) + "\n")
    return path
