"""Words of files, as pages, pictures and tables can hold them."""

import re

# What is left of bytes that are not UTF-8, and characters that XML and HTML forbid.
NOT_SHOWN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


def printable(words):
    """Return words with U+FFFD for each character that no page, picture or table can hold."""
    return NOT_SHOWN.sub("\N{REPLACEMENT CHARACTER}", words)
