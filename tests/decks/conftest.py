"""Holds tests to the cards that they say they change; see changes.py."""

import pytest
from changes import CHANGED


def pytest_configure(config):
    config.addinivalue_line("markers", "changes(*cards): compares two values of each of these")


@pytest.fixture(autouse=True)
def changes_what_it_says(request):
    """Fail a test marked with a card in which its decks do not differ."""
    CHANGED.clear()
    yield
    said = {card for mark in request.node.iter_markers("changes") for card in mark.args}
    assert said <= CHANGED, f"not changed by this test: {sorted(said - CHANGED)}"
