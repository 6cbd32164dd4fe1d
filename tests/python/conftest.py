"""The package, and a deck for it."""

import sys

import pytest
from first_deck import ROOT, joint_deck

sys.path.insert(0, str(ROOT / "python"))


@pytest.fixture
def joint(tmp_path, monkeypatch):
    """Return the deck in a new folder, which is the current one."""
    monkeypatch.chdir(tmp_path)
    deck = tmp_path / "joint.inp"
    deck.write_text(joint_deck())
    return deck
