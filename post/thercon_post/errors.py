"""The one error type: something the user can mend, told in one line."""

from difflib import get_close_matches


class UserError(Exception):
    """A mistake in what was asked for or handed over; ends the program with status 1."""


def nearest_name(name, known):
    """Return ", nearest: 'x'" for the known name closest to `name`, or an empty text."""
    spelling = {each.lower(): each for each in known}
    matches = get_close_matches(name.lower(), spelling, n=1, cutoff=0.5)
    return f", nearest: '{spelling[matches[0]]}'" if matches else ""
