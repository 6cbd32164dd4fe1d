"""Makes the modules of the other tests known to the themes."""

import report  # noqa: F401


def pytest_configure(config):
    config.addinivalue_line("markers", "changes(*cards): of tests/decks, whose decks themes use")
