"""Pictures of the documents: the look of post/plot, in the size of a page, as small files."""

import sys
from pathlib import Path

from PIL import Image

sys.path.append(str(Path(__file__).resolve().parents[2] / "python"))
from thercon.post import style  # noqa: E402  its folder is made known first
from thercon.post.style import DOUBLE_COLUMN, plt  # noqa: E402

DOTS = 155  # an inch: about 1100 points across a page
COLOURS = 96


def subplots(rows, columns, height, width=DOUBLE_COLUMN, **options):
    """Return a new figure and its axes; width and height in inches."""
    style.apply()
    return plt.subplots(rows, columns, figsize=(width, height), layout="constrained", **options)


def save(figure, path):
    """Write a figure as PNG with few colours, and close it."""
    figure.savefig(path, dpi=DOTS)
    plt.close(figure)
    with Image.open(path) as picture:
        reduced = picture.convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
    reduced.save(path, optimize=True)
