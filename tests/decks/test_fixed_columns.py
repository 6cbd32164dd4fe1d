"""*NODE and *ELEMENT in the fixed columns of FORMAT=."""

import pytest
from blocks import write
from deck_runs import assert_alike, datasets, run, solve
from physics import follows, material, mesh

YOUNG, POISSON, LOAD = 1000.0, 0.3, 5.0


def split(cards):
    """Return the data of *NODE and of *ELEMENT of some cards, and the other cards."""
    nodes, elements, rest, to = [], [], [], None
    for card in cards:
        if card.startswith("*"):
            to = {"*NODE": nodes, "*ELEMENT": elements}.get(card.split(",")[0], rest)
            if to is rest:
                rest.append(card)
        else:
            to.append(card if to is rest else [float(field) for field in card.split(",")])
    return nodes, [[int(n) for n in element] for element in elements], rest


def pressed(kind="CPS8", skew=0.03):
    """Return a distorted block of 2 x 2, its support and its load."""
    return [*mesh("BODY", [0.0, 0.7, 1.5], [0.0, 0.6, 1.1], kind, skew=skew),
            *material("BODY", (YOUNG, POISSON)), "*STEP", "*STATIC", "*BOUNDARY", "BODY.LEFT, 1",
            "BODY.BOTTOM, 2", "*DSLOAD", f"BODY.TOP, P, {LOAD}", "*END STEP"]


# A format of nodes, a function that writes one, a format of elements, and one that writes one as
# several lines.
STYLES = {
    "plain": ("(I5,2F15.0)", lambda n, x, y: f"{n:5d}{x:15.10f}{y:15.10f}",
              "(9I5)", lambda e: ["".join(f"{n:5d}" for n in e)]),
    "lower case and blanks": ("( i5, 2 f15.10 )", lambda n, x, y: f"{n:5d}{x:15.10f}{y:15.10f}",
                              "( 9 i5 )", lambda e: ["".join(f"{n:5d}" for n in e)]),
    "no points": ("(I4,2F12.8)",
                  lambda n, x, y: f"{n:4d}{round(x * 1e8):12d}{round(y * 1e8):12d}",
                  "(9I4)", lambda e: ["".join(f"{n:4d}" for n in e)]),
    "third coordinates": ("(I5,3F15.0)", lambda n, x, y: f"{n:5d}{x:15.10f}{y:15.10f}{0:15.1f}",
                          "(5I5)", lambda e: ["".join(f"{n:5d}" for n in e[k:k + 5])
                                                 for k in range(0, len(e), 5)]),
}


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("kind", ["CPS8", "CPS4"])
def test_fixed_columns_are_the_fields_between_commas(tmp_path, style, kind):
    cards = pressed(kind)
    nodes, elements, rest = split(cards)
    of_node, write_node, of_element, write_element = STYLES[style]
    fixed = [f'*NODE, NSET=BODY, FORMAT="{of_node}"', *(write_node(int(n), x, y)
                                                       for n, x, y in nodes),
             f'*ELEMENT, TYPE={kind}, FORMAT="{of_element}", ELSET=BODY',
             *(line for element in elements for line in write_element(element))]
    (tmp_path / "commas.inp").write_text("\n".join(cards) + "\n")
    (tmp_path / "fixed.inp").write_text("\n".join([*fixed, *rest]) + "\n")
    results = [datasets(solve(tmp_path / name), "VTKHDF", "history")
               for name in ("commas.inp", "fixed.inp")]
    # Ten decimals of coordinates of order 1, which stresses feel alike.
    assert_alike(*results, 1e-9)


SQUARE = ["    1         0         0", "    2       100         0", "    3       100       100",
          "    4         0       100"]
PRESSED = ["*STEP", "*STATIC", "*BOUNDARY", "1, 1, 2", "2, 2", "*DLOAD", f"E, P3, {LOAD}",
           "*END STEP"]


@pytest.mark.changes("NODE, FORMAT")
def test_format_of_nodes_says_where_the_point_is(tmp_path):
    """The same digits are a square of another size, and its displacements are as many times."""
    follows(tmp_path, lambda decimals: (
        [f'*NODE, FORMAT="(I5,2F10.{decimals})"', *SQUARE, "*ELEMENT, TYPE=CPS4, ELSET=E",
         "1, 1, 2, 3, 4", *material("E", (YOUNG, POISSON)), *PRESSED],
        [("U2", 3, "LAST", -LOAD / YOUNG * 10.0 ** (2 - decimals), 1e-10)]), 2, 1)


@pytest.mark.changes("ELEMENT, FORMAT")
def test_format_of_elements_says_which_columns_are_nodes(tmp_path):
    """The same digits are nodes of a square, or of one that is twice as high."""
    follows(tmp_path, lambda case: (
        ["*NODE", "1, 0., 0.", "2, 1., 0.", "13, 1., 1.", "14, 0., 1.", "3, 1., 2.", "4, 0., 2.",
         f'*ELEMENT, TYPE=CPS4, ELSET=E, FORMAT="{case[0]}"', case[2],
         *material("E", (YOUNG, POISSON)), *PRESSED],
        [("U2", "MIN", "LAST", -LOAD / YOUNG * case[1], 1e-10)]),
        ("(5I2)", 1.0, " 1 1 21314"), ("(5I1)", 2.0, "11234"))


def test_cards_are_as_wide_as_the_deck_says(tmp_path):
    deck = ['*NODE, FORMAT="(I5,2F140.0)"', *(f"{n:5d}{x:140.1f}{y:140.1f}" for n, x, y in (
        (1, 0, 0), (2, 1, 0), (3, 1, 1), (4, 0, 1))), "*ELEMENT, TYPE=CPS4, ELSET=E",
        "1, 1, 2, 3, 4", *material("E", (YOUNG, POISSON)), *PRESSED]
    path = write(tmp_path / "deck.inp", deck)
    assert "text past column 256" in run("check", path).stderr
    assert run("check", path, "--width", "285").returncode == 0


def test_no_shift_is_read_as_other_numbers(tmp_path):
    """A blank more anywhere in a card that is full is an error, one less is an error or leaves all
    numbers as they are."""
    nodes = ["    1       0.0       0.0", "    2       1.0       0.0", "    3 1.0000000 1.0000000",
             "    4      0E00         1"]
    elements = ["    1    1    2    3    4"]
    rest = [*material("E", (YOUNG, POISSON)), *PRESSED]

    def listed(nodes, elements):
        deck = ['*NODE, FORMAT="(I5,2F10.0)"', *nodes,
                '*ELEMENT, TYPE=CPS4, ELSET=E, FORMAT="(5I5)"', *elements, *rest]
        process = run("run", "--quiet", write(tmp_path / "deck.inp", deck), "--out", tmp_path)
        if process.returncode == 1:
            assert ": error: " in process.stderr
            return None
        return datasets(tmp_path / "deck.vtkhdf", "VTKHDF")

    right = listed(nodes, elements)
    for cards in (nodes, elements):
        for k, card in enumerate(cards):
            shifted = [card[:c] + " " + card[c:] for c in range(len(card))]
            shifted += [card[:c] + card[c + 1:] for c in range(len(card)) if card[c] == " "]
            for other in set(shifted):
                cards[k] = other
                found = listed(nodes, elements)
                if found is not None:
                    assert len(other) < len(card), other
                    assert_alike(right, found, 0.0)
            cards[k] = card
