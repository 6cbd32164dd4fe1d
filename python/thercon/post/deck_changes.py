"""Whether a deck is still the one that its result was made of."""

import re
from itertools import chain
from pathlib import Path

INCLUDE = re.compile(r'\*\s*INCLUDE\s*,\s*INPUT\s*=\s*"?([^",]+)', re.IGNORECASE)
READ = re.compile(r"\*\s*RESTART\s*,.*\bREAD\b", re.IGNORECASE)
DEEPEST = 16  # files within files, as the program reads them


def changed(result):
    """Return that the deck has changed, in words; nothing where it has not, or is not found in the
    current folder, beside the result or above it."""
    beside = result.path.parent
    places = [folder / f"{result.name}.inp" for folder in (Path(), beside, beside / "..")]
    deck = next((path for path in places if path.is_file()), None)
    if deck is None or not result.deck:
        return ""
    try:
        found, of_result = told(cards(deck)), told(result.deck)
    except (OSError, RecursionError):
        return ""
    is_same = found == of_result
    if any(READ.match(line) for line in found):  # its cards are among those of an earlier deck
        rest = iter(of_result)
        is_same = all(line in rest for line in found)
    return "" if is_same else f"{deck} has changed since {result.path.name} was made"


def told(lines):
    """Return the lines that are no comments, without blanks at their ends."""
    return [line.rstrip() for line in lines if line.strip() and not line.startswith("**")]


def cards(path, depth=0):
    """Return the lines of a deck, those of a file that it includes behind its card."""
    if depth > DEEPEST:
        raise RecursionError
    data = path.read_bytes().removeprefix(b"\xef\xbb\xbf")
    try:
        lines = data.decode().split("\n")
    except UnicodeDecodeError:
        lines = data.decode("latin-1").split("\n")
    return list(chain.from_iterable(
        [line.rstrip("\r"), *included(path.parent, line, depth)] for line in lines))


def included(folder, line, depth):
    """Return the lines of the file that a card includes; none where it is no such card."""
    card = INCLUDE.match(line)
    if card is None:
        return []
    name = card[1].strip()
    beside = folder / name
    return cards(beside if beside.is_file() else Path(name), depth + 1)
