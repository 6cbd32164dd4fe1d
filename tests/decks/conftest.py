"""Holds tests to the cards that they say they change; see changes.py. Ends what a failed one leaves."""

import os
import signal
from pathlib import Path

import pytest
from changes import CHANGED


def pytest_configure(config):
    config.addinivalue_line("markers", "changes(*cards): compares two values of each of these")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    """Remember whether a test was skipped."""
    outcome = yield
    item.was_skipped = outcome.get_result().skipped or getattr(item, "was_skipped", False)


@pytest.fixture(autouse=True)
def changes_what_it_says(request):
    """Fail a test marked with a card in which its decks do not differ."""
    CHANGED.clear()
    yield
    if request.node.was_skipped:
        return
    said = {card for mark in request.node.iter_markers("changes") for card in mark.args}
    assert said <= CHANGED, f"not changed by this test: {sorted(said - CHANGED)}"


@pytest.fixture(autouse=True)
def no_run_goes_on():
    """End the runs that a test which failed has left, so that they disturb no other one."""
    yield
    own = os.getpid()
    for child in Path(f"/proc/{own}/task/{own}/children").read_text().split():
        os.kill(int(child), signal.SIGKILL)   # gone only once waited for
