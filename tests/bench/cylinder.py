"""The published cylinder, refined, as the themes here run it."""

import re

from deck_runs import CYLINDER, copy_deck

OUTPUT = ("*NODE FILE", "*EL FILE", "*CONTACT FILE", "*CONTACT PRINT")


def refined(folder, levels, *cards):
    """Write the deck with so many refinements and more cards, without checks and estimates of
    errors, with fields and tables of the last increment only; return its path."""
    deck = copy_deck(CYLINDER, folder / "deck.inp",
                     [f"*REFINE, LEVELS={levels}", "*OPTIONS, ERRORS=NO", *cards],
                     {f"{card}\n": f"{card}, FREQUENCY=1000\n" for card in OUTPUT})
    deck.write_text(re.sub(r"(?ms)^\*VERIFY.*?(?=^\*(?!VERIFY|\*)|\Z)", "", deck.read_text()))
    return deck
