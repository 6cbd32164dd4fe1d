"""Interfaces that a pattern means are drawn as one, along a common coordinate."""

import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "decks"), str(TESTS.parent / "post")]

from blocks import write  # noqa: E402
from comparing import coarse_pictures  # noqa: E402, F401  fixture
from deck_runs import solve  # noqa: E402
from pellets import rod  # noqa: E402

from thercon_post.cli import main as plot  # noqa: E402
from thercon_post.result import Result  # noqa: E402

PELLETS = 11   # W10 comes before W2 by name


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    return solve(write(tmp_path_factory.mktemp("joined") / "rod.inp", rod(PELLETS)))


def test_points_of_all_interfaces_follow_each_other_along_the_rod(result):
    with Result(result) as one, h5py.File(result) as file:
        joined = one.contact("w*")
        along, places = joined.axis(None)
        assert along == "y"
        assert np.all(np.diff(places) >= 0.0)
        assert places[[0, -1]] == pytest.approx([0.0, 10.0 * PELLETS])
        pairs = [file[f"contact/W{k}"] for k in range(PELLETS)]
        for name in ("y", "status", "pressure", "heat_flux"):
            assert np.array_equal(joined[name], np.concatenate([pair[name][()] for pair in pairs], axis=-1))
        assert joined["normal_force"] == pytest.approx(sum(pair["normal_force"][()] for pair in pairs))
        assert joined.friction == pytest.approx(0.1)
        assert len(joined.pieces) == PELLETS
        own = np.sort(np.concatenate([pair["y"][0] + pair["edges_contact"][-1] for pair in pairs]))
        edges = joined.edge_on_axis(joined["edges_contact"][-1], places)
        assert np.sum(~np.isnan(own)) > PELLETS
        assert edges == pytest.approx(own, nan_ok=True)


@pytest.mark.usefixtures("coarse_pictures")
def test_zones_and_profiles_of_all_interfaces_are_one_picture_each(result, tmp_path, capsys):
    for picture in ("zones", "profiles"):
        assert plot([picture, str(result), "--contact", "W*", "--out", str(tmp_path), "--csv"]) == 0
    written = {Path(line).name for line in capsys.readouterr().out.split()}
    assert {"rod.zones-W_.png", "rod.zones-W_-pairs.csv", "rod.profiles-W_.png"} <= written


def test_a_pattern_that_no_interface_has_is_an_error(result, tmp_path, capsys):
    assert plot(["zones", str(result), "--contact", "Q*", "--out", str(tmp_path)]) == 2
    assert "no contact 'Q*'" in capsys.readouterr().err
