"""Words of files, as pages, pictures and tables can hold them, and numbers in words."""

import re

import numpy as np

# What is left of bytes that are not UTF-8, and characters that XML and HTML forbid.
NOT_SHOWN = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


# Names of *VERIFY -> what pictures of fields, and histories of sets, call them.
OF_VERIFY = {
    "NT": ("temperature",), "MISES": ("von_mises",), "SOLID": ("solid_fraction",),
    "PEEQ": ("plastic_strain", "equivalent_plastic_strain"),
    "CEEQ": ("creep_strain", "equivalent_creep_strain"),
    "HFL1": ("flux_x", "heat_flux_x"), "HFL2": ("flux_y", "heat_flux_y"),
    "U1": ("displacement_x",), "U2": ("displacement_y",),
    "RF1": ("external_force_x",), "RF2": ("external_force_y",), "RFL": ("external_heat",),
}
AXES = {"11": "xx", "22": "yy", "33": "zz", "12": "xy"}
OF_VERIFY |= {f"S{key}": (axes, f"stress_{axes}") for key, axes in AXES.items()}
OF_VERIFY |= {f"{kind[:1].upper()}E{key}": (f"{kind}_strain_{axes}",) for kind in ("plastic", "creep")
              for key, axes in AXES.items()}


def known_name(name, known):
    """Return the one of the names `known` that is meant, in any case or as *VERIFY calls it; the name
    itself where there is none."""
    spelled = {each.lower(): each for each in known}
    meant = [name.lower(), *OF_VERIFY.get(name.upper(), ())]
    return next((spelled[each] for each in meant if each in spelled), name)


def number_text(value):
    """Return a number as legends and footers show it, with a minus sign."""
    return f"{value:g}".replace("-", "\N{MINUS SIGN}")


def runs_text(numbers):
    """Return ascending whole numbers in words, such as "1 to 10, 41"; of many runs the ends."""
    numbers = np.asarray(numbers)
    runs = np.split(numbers, np.flatnonzero(np.diff(numbers) > 1) + 1)
    found = [f"{run[0]} to {run[-1]}" if len(run) > 1 else f"{run[0]}" for run in runs]
    return ", ".join(found if len(found) <= 6 else [*found[:3], "...", *found[-2:]])


def printable(words):
    """Return words with U+FFFD for each character that no page, picture or table can hold."""
    return NOT_SHOWN.sub("\N{REPLACEMENT CHARACTER}", words)


def place_words(value, among):
    """Return a coordinate in words; 0 where it is the rounding of the others `among` which it is,
    as the sine of a multiple of pi is."""
    accurate_to = 1e4 * np.finfo(float).eps * np.max(np.abs(among))  # of some thousand operations
    return f"{value if abs(value) > accurate_to else 0.0:.4g}"
