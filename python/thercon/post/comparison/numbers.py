"""Numbers as Fortran programs print them."""

import re

# An exponent without its letter (0.123-105), which formats print where it has three digits.
BARE_EXPONENT = re.compile(r"^([-+]?(?:\d+\.?\d*|\.\d+))([-+]\d+)$")

# A blank in place of the plus sign of an exponent (0.123E 05), as old libraries print it.
BLANK_SIGN = re.compile(r"([EeDdQq]) (?=\d)")

NUMBER = re.compile(
    r"^[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[Ee][-+]?\d+)?|nan(?:\(.*\))?|inf(?:inity)?)$", re.I
)


def fortran_number(text):
    """Return the number that a text is, NaN and infinities included; None if it is none."""
    text = BLANK_SIGN.sub(r"\1+", text.strip())
    text = re.sub("[DdQq]", "E", text) if re.match(r"[-+\d.]", text) else text
    text = BARE_EXPONENT.sub(r"\1E\2", text)
    if not NUMBER.match(text):
        return None
    return float(re.sub(r"\(.*\)", "", text))
