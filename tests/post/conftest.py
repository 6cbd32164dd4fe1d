"""Registers the marks of tests/decks, whose decks some tests here use."""


def pytest_configure(config):
    config.addinivalue_line("markers", "changes(*cards): of tests/decks")
