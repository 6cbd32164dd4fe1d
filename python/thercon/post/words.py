"""Words of files, as pages, pictures and tables can hold them, and numbers in words."""

import re

import numpy as np

# What is left of bytes that are not UTF-8, and characters that XML and HTML forbid.
NOT_SHOWN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


def printable(words):
    """Return words with U+FFFD for each character that no page, picture or table can hold."""
    return NOT_SHOWN.sub("\N{REPLACEMENT CHARACTER}", words)


def place_words(value, among):
    """Return a coordinate in words; 0 where it is the rounding of the others `among` which it is,
    as the sine of a multiple of pi is."""
    accurate_to = 1e4 * np.finfo(float).eps * np.max(np.abs(among))  # of some thousand operations
    return f"{value if abs(value) > accurate_to else 0.0:.4g}"
