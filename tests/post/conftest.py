"""Fixtures of several tests, and the marks of tests/decks, whose decks some tests here use."""

import shutil
import sys
from pathlib import Path

import pytest
from browser import Browser
from synthetic import write_result


def pytest_configure(config):
    config.addinivalue_line("markers", "changes(*cards): of tests/decks")
    config.addinivalue_line("markers", "vectors: reads .svg, which are not drawn else")


@pytest.fixture(autouse=True)
def coarse_pictures(request, monkeypatch):
    """Draw few dots, and once: the tests look at what is written, not at the pictures."""
    if "thercon.post.style" not in sys.modules:
        return
    from matplotlib.figure import Figure
    from thercon.post import style

    monkeypatch.setitem(style.SETTINGS, "savefig.dpi", 50)
    monkeypatch.setitem(style.SETTINGS, "savefig.bbox", None)
    if "thercon.post.fields" in sys.modules:
        monkeypatch.setattr(sys.modules["thercon.post.fields"], "FINE_CELLS", 1000)
    if request.node.get_closest_marker("vectors") is None:
        save = Figure.savefig
        monkeypatch.setattr(Figure, "savefig", lambda figure, path, **options:
                            path.write_text("not drawn") if path.suffix == ".svg"
                            else save(figure, path, **options))


@pytest.fixture(scope="session")
def browser():
    """Return a headless browser; to start one takes longer than to draw a page."""
    with Browser() as opened:
        yield opened


@pytest.fixture(scope="session")
def usual(tmp_path_factory):
    """Return the path of the usual synthetic result, which tests leave as it is."""
    path = tmp_path_factory.mktemp("usual") / "case.vtkhdf"
    write_result(path)
    return path


@pytest.fixture
def result(usual, tmp_path):
    """Return the path of the usual synthetic result, a copy that the test may change."""
    return Path(shutil.copy(usual, tmp_path))
