"""The decks that judge the numerical uncertainties, and how they are judged."""

import re
from dataclasses import replace

import numpy as np
import pytest
from judged_decks import Case, by_deck, ends_of_steps, reference, solved
from judged_families import FAMILIES


@pytest.mark.parametrize("family", FAMILIES)
def test_a_deck_of_each_family_is_solved_and_closes(tmp_path, family):
    deck = FAMILIES[family](0)
    found = solved(deck, (0, deck.own_levels), 1, tmp_path)
    for face in deck.faces:
        assert len(found[face, "normal_force"]) == len(ends_of_steps(deck.text)) >= 1
        assert found[face, "normal_force"][0] > 0 and (deck.has_corners or found[face, "peak_pressure"][0] > 0)
    for body, quantity, _ in deck.maxima:
        assert np.isfinite(found[f"body {body}", quantity]).all()


def test_true_values_of_a_cylinder_on_a_block_are_those_of_hertz(tmp_path):
    """Of E and the load that are drawn, with R = 100 on aluminium; bodies 40 times as large as the contact."""
    deck = FAMILIES["local"](2)
    young, poisson = map(float, re.search(r"NAME=STEEL\n\*ELASTIC\n(.+), (.+)", deck.text).groups())
    load = 2 * 40 * float(re.search(r"P2, (.+)", deck.text)[1])
    modulus = 1 / ((1 - poisson**2) / young + (1 - 0.33**2) / 7e4)
    half = np.sqrt(4 * load * 100 / (np.pi * modulus))
    found = reference(deck, tmp_path)
    for quantity, exact in (("normal_force", load / 2), ("edge_contact", half),
                            ("peak_pressure", 2 * load / (np.pi * half))):
        value, known = found["FACE", quantity]
        assert abs(value[-1] / exact - 1) < (half / 40) ** 2 + 1e-4 and known[-1] < 2e-3 * value[-1]


def test_a_deck_holds_where_all_ends_of_its_steps_do():
    inside = Case("family", "one", "normal_force", 1.0, 2.0, "")
    cases = [inside, replace(inside, deck="two"), replace(inside, deck="two", error=-3.0),
             replace(inside, deck="three", uncertainty=np.nan, reason="stored heat")]
    assert by_deck(cases)[:3] == ["1/2, 50 %", "1/3", "2.0"]
