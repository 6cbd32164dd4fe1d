"""Makes the modules of the manual and of the other tests known to the themes."""

import manual  # noqa: F401


def pytest_configure(config):
    config.addinivalue_line("markers", "changes(*cards): of tests/decks, whose modules themes use")
