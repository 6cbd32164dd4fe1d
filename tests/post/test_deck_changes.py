"""Pictures and pages say where the deck is no longer the one that the result was made of."""

import shutil
import sys
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "decks"), str(TESTS.parent / "python")]

from deck_runs import INPUT, run  # noqa: E402
from program import CYLINDER, write_deck  # noqa: E402

from thercon.post.cli import main as plot  # noqa: E402
from thercon.post.deck_changes import changed  # noqa: E402
from thercon.post.report.cli import main as report  # noqa: E402
from thercon.post.result import Result  # noqa: E402


@pytest.fixture
def rods(tmp_path, monkeypatch):
    """Return a solved deck that includes two files, in the current folder."""
    for path in (INPUT / "rods").iterdir():
        shutil.copy(path, tmp_path)
    monkeypatch.chdir(tmp_path)
    assert run("run", "r2.inp", "--out", "results", folder=tmp_path).returncode == 0
    return tmp_path / "r2.inp"


def words_of(path):
    with Result(path) as result:
        return changed(result)


@pytest.mark.vectors
def test_a_deck_that_changed_after_its_result_is_named(rods, capsys):
    result = "results/r2.vtkhdf"
    assert plot(["profiles", result.removesuffix(".vtkhdf")]) == 0 and not capsys.readouterr().err
    rods.write_text("** a comment\n" + rods.read_text().replace("\n", "\r\n"))
    assert words_of(result) == ""
    good = rods.read_text()
    rods.write_text(good.replace("METHOD=NEWTON", "METHOD=PICARD"))
    said = "r2.inp has changed since r2.vtkhdf was made"
    assert words_of(result) == said
    for picture in ("profiles", "zones", "mesh"):
        assert plot([picture, result]) == 0
        assert capsys.readouterr().err == f"plot: note: {said}\n"
        assert said in Path(f"r2.{picture}.svg").read_text()
    assert report([result]) == 0
    assert f'<p class="note">{said}.</p>' in Path("r2.html").read_text()
    rods.write_text(good)
    included = rods.with_name("rods.inc")
    included.write_text(included.read_text() + "*NODE\n999, 0., 0.\n")
    assert words_of(result) == said
    included.unlink()
    assert words_of(result) == ""
    rods.unlink()
    assert words_of(result) == ""


def test_a_deck_that_goes_on_from_a_result_is_its_own(tmp_path):
    deck = write_deck(tmp_path / "first.inp", ["*RESTART, WRITE, FREQUENCY=100"])
    text = CYLINDER.read_text()
    deck.write_text(deck.read_text().split("*VERIFY")[0])
    new = tmp_path / "second.inp"
    step = text[text.index("*STEP"):].split("*VERIFY")[0]
    new.write_text("*RESTART, READ\n" + step)
    assert run("run", deck, "--out", tmp_path).returncode == 0
    done = run("run", new, "--restart", tmp_path / "first.vtkhdf", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert words_of(tmp_path / "second.vtkhdf") == ""
    new.write_text(new.read_text().replace("*STEP", "*STEP, INC=101", 1))
    assert "second.inp has changed" in words_of(tmp_path / "second.vtkhdf")
