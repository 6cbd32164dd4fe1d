"""The deck of README.md with the parameters of docs/python.md, and what theory says of it."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CHANGES = {"2, P3, 50.": "2, P3, <pressure>", "0., 2.E-4, 1.": "0., <factor>, <exponent>"}


def joint_deck():
    """Return the cards of the deck as docs/python.md says."""
    cards = (ROOT / "README.md").read_text().split("```")[1].lstrip()
    document = (ROOT / "docs/python.md").read_text()
    parameters = re.search(r"^    (\*PARAMETER\n)    (.*\n)", document, re.M)
    for old, new in CHANGES.items():
        assert cards.count(f"\n{old}\n") == 1 and f"`{new}`" in document
        cards = cards.replace(f"\n{old}\n", f"\n{new}\n")
    prints = re.search(r"^    (\*NODE PRINT.*\n)    (.*\n)", document, re.M)
    assert cards.count("*END STEP\n") == 1
    cards = cards.replace("*END STEP\n", f"{prints[1]}{prints[2]}*END STEP\n")
    own = "*PARAMETER\nslip = 0.2\n"
    assert cards.startswith(own) and "slip = 0.2" in parameters[2]
    return parameters[1] + parameters[2] + cards.removeprefix(own)


def heat_rate(pressure, factor=2e-4, exponent=1.0):
    """Return the heat through three resistances in series, as in README.md."""
    return 1800.0 / (400.0 + 1.0 / (factor * pressure**exponent))
