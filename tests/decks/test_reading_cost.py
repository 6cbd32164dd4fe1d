"""The time to read and check a deck grows no faster than what is in it, nearly."""

import resource

import pytest
from blocks import block, solid, without_unused_surfaces
from deck_runs import run

MESH = [*without_unused_surfaces(block("BLOCK", [0.0, 1.0], [0.0, 1.0])),
        *solid("BLOCK", 1000.0, 0.25)]
HELD = ["*BOUNDARY", "BLOCK.BOTTOM, 2, 2, 0.", "BLOCK.LEFT, 1, 1, 0."]
COUNT = 8000

# What is repeated in the model, and in its step: n is a number, | ends a line.
CARDS = {
    "amplitudes": ("*AMPLITUDE, NAME=an|0., 0., 1., 1.|", ""),
    "parameters": ("*PARAMETER|pn = 0.|", "*CLOAD|3, 1, <pn>|"),
    "node sets": ("*NSET, NSET=sn|3|", "*CLOAD|sn, 1, 0.|"),
    "element sets": ("*ELSET, ELSET=sn|1|", "*DLOAD|sn, P3, 0.|"),
    "surfaces": ("*SURFACE, NAME=sn|1, S3|", "*DSLOAD|sn, P, 0.|"),
    "interactions": ("*SURFACE INTERACTION, NAME=sn|*FRICTION|0.3|", ""),
}


def seconds(path, model, step, count):
    """Return the least CPU time of two checks of a deck with so many cards."""
    model, step = ("".join(text.replace("n", str(k)) for k in range(count)).replace("|", "\n")
                   for text in (model, step))
    path.write_text("\n".join([*MESH, model + HELD[0], *HELD[1:], "*STEP", "*STATIC", "1., 1.",
                               step + "*END STEP", ""]))
    used = []
    for _ in range(2):
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        process = run("check", "--quiet", path)
        assert process.returncode == 0, process.stderr[:400]
        used.append(resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before)
    return min(used)


@pytest.mark.parametrize("cards", CARDS)
def test_four_times_the_cards_take_less_than_eight_times_the_time(tmp_path, cards):
    """Between 4, where the time grows with the deck, and 16, where it grows with its square."""
    few, lots = (seconds(tmp_path / "many.inp", *CARDS[cards], count)
                 for count in (COUNT // 4, COUNT))
    assert lots < 8 * few, f"{few:.2f} s, {lots:.2f} s"
