"""One look for all pictures: sizes of a printed page, fonts, lines, and how files are written."""

from pathlib import Path

import matplotlib
import numpy as np

from .errors import UserError
from .tables import write_table
from .words import printable

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402  the backend is chosen first
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter  # noqa: E402

SEEN = 0.01  # of the height of a panel: thinner bands are not seen
SINGLE_COLUMN, DOUBLE_COLUMN = 3.39, 7.01  # inches: 86 and 178 mm

# Colours that stay apart for the colour-blind (Okabe and Ito) and in grey.
BLACK, BLUE, VERMILION, GREY = "#000000", "#0072B2", "#D55E00", "#8C8C8C"
ORANGE, GREEN, SKY = "#E69F00", "#009E73", "#56B4E9"
SERIES = [BLACK, VERMILION, BLUE, GREEN, ORANGE, SKY]
MARKERS = ["o", "s", "^", "D", "v", "P"]
TINTS = ["#F6E3D0", "#DCE8F2", "#E4EEDC", "#EFE2EE", "#F5F0D0", "#E6E6E6"]

DEEPER = 1.8  # by which the power of the tints grows with each further round of bodies that takes them
ROUNDS = 4  # of bodies before tints repeat

# Places of legends outside the figure, which is written with all that it has.
BELOW = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0)}
ABOVE = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0)}

SETTINGS = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 8.5,
    "axes.labelsize": 8.5,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "legend.fontsize": 7.5,
    "legend.frameon": False,
    "legend.handlelength": 2.4,
    "axes.linewidth": 0.6,
    "lines.linewidth": 0.9,
    "lines.markersize": 3.2,
    "lines.markeredgewidth": 0.6,
    "patch.linewidth": 0.5,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "xtick.major.size": 3.0,
    "ytick.major.size": 3.0,
    "xtick.minor.size": 1.6,
    "ytick.minor.size": 1.6,
    "axes.unicode_minus": True,
    "figure.dpi": 100,
    "savefig.dpi": 400,
    "savefig.bbox": "tight",
    "savefig.pad_inches": 0.03,
    "svg.hashsalt": "thercon",
}


def apply():
    """Use this style for every figure that follows."""
    plt.rcdefaults()
    plt.rcParams.update(SETTINGS)


def write(figure, columns, options, name):
    """Write figure and, where they are asked for and there are some, curves to the folder of the
    options as name.png, .svg and .csv; return what was written."""
    folder, is_told = Path(options.out), options.csv and columns is not None
    if options.note:
        figure.suptitle(plain(options.note), fontsize=7.5, color=VERMILION)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        figure.savefig(folder / f"{name}.png")
        figure.set_layout_engine("none")  # both files have one layout, which takes long
        # No date in the file: the same result gives the same picture.
        figure.savefig(folder / f"{name}.svg", metadata={"Date": None})
        if is_told:
            write_table(folder / f"{name}.csv", columns)
    except OSError as reason:
        raise UserError(f"{folder / name}: cannot be written ({reason})") from None
    finally:
        plt.close(figure)
    return [folder / f"{name}.{kind}" for kind in ("png", "svg", "csv")[: 2 + is_told]]


def file_name(result, picture, *parts):
    """Return the file name NAME.picture-part-part without its ending."""
    words = [f"{part:g}" if isinstance(part, (int, float)) else str(part) for part in parts]
    words = ["all" if word == "*" else word for word in words]
    safe = ["".join(c if c.isalnum() or c in "._+-" else "_" for c in word) for word in words]
    return f"{result.name}.{'-'.join([picture, *safe])}"


def plain(words):
    """Return words, such as a file's name, so that none of them is read as a formula."""
    return printable(words).replace("$", r"\$")


def marker(number):
    """Return the marker of the curve with this number."""
    return MARKERS[number % len(MARKERS)]


def shades(count):
    """Return `count` line colours from light to dark, apart in grey as well."""
    if count == 1:
        return [BLACK]
    return [matplotlib.colormaps["viridis"](t) for t in np.linspace(0.72, 0.0, count)]


def body_tint(number):
    """Return the tint of the body with this number, from 0: further ones take the same hues deeper."""
    colour = np.array(matplotlib.colors.to_rgb(TINTS[number % len(TINTS)]))
    return tuple(colour ** (1.0 + DEEPER * (number // len(TINTS) % ROUNDS)))


def log_ticks(axis, low, high):
    """Label a logarithmic axis from `low` to `high`: decades, or 1, 2 and 5 of each where these are
    few."""
    first, last = int(np.floor(np.log10(low))), int(np.ceil(np.log10(high)))
    decades = [10.0**k for k in range(first, last + 1) if low <= 10.0**k <= high]
    every = -(-len(decades) // 6)
    ticks = decades[::every] if every else []
    if len(decades) < 3:
        ticks = [m * 10.0**k for k in range(first, last + 1) for m in (1, 2, 5)]
    axis.set_major_locator(FixedLocator([tick for tick in ticks if low <= tick <= high]))
    axis.set_major_formatter(FuncFormatter(lambda value, _: number_words(value)))
    axis.set_minor_formatter(NullFormatter())


def log_abscissa(axes, low, high):
    """Make the abscissa logarithmic, from `low` to `high`."""
    axes.set(xscale="log", xlim=(low, high))
    log_ticks(axes.xaxis, low, high)


def decade(values):
    """Return a range about values: a decade at least, so that what is equal looks equal."""
    low, high = 0.7 * min(values), 1.4 * max(values)
    short = max(1.0, 10.0 * low / high) ** 0.5
    return low / short, high * short


def number_words(value):
    """Return a number as a label: plain where that is short, else a power of ten."""
    if value == 0.0 or 1e-3 <= value < 1e5:
        return f"{value:g}"
    power = int(np.floor(np.log10(value) + 1e-9))
    factor = f"{value / 10.0**power:.3g}"
    return f"$10^{{{power}}}$" if factor == "1" else rf"${factor}\times10^{{{power}}}$"


def mark_judged(axes, abscissa, judged):
    """Mark the increments with the accuracy that was requested, unless all have it."""
    for place in abscissa[judged] if not judged.all() else ():
        axes.axvline(place, color=GREY, ls=":", lw=0.8, zorder=0.5)


def band(axes, at, low, high, colour):
    """Fill between low and high over an abscissa that may turn: each way has a band of its own, and
    a single place a line."""
    line = 3 if len(at) == 1 else 0
    ways = np.sign(np.diff(at))
    turns = [0, *np.flatnonzero(np.diff(ways)) + 1, len(at) - 1]
    for first, last in zip(turns, turns[1:]):
        part = slice(first, last + 1)
        axes.fill_between(at[part], low[part], high[part], color=colour, alpha=0.15, linewidth=line)


def has_band(values):
    """Whether the range of values (rows, members) is seen beside their changes from row to row."""
    spread = np.nanmax(np.nanmax(values, axis=1) - np.nanmin(values, axis=1))
    return bool(spread > SEEN * (np.nanmax(values) - np.nanmin(values)))


def panel_title(axes, words, letter=""):
    """Put "(a)" and so on, where there is a letter, and words above the axes."""
    words = f"({letter}) {words}".rstrip(" ") if letter else words
    axes.set_title(words, loc="left", fontsize=8.5, pad=4)
