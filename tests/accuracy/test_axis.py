"""Peak pressures on the axis under a ball, on linear elements."""

from axis_decks import judged


def test_peaks_on_the_axis_are_within_their_uncertainties(tmp_path):
    """Of a seed that judges, by the last increment, the whole run and a request of 0.5 %."""
    found = judged(1000, "CAX4", tmp_path)
    assert len(found) == 3 and all(abs(error) <= uncertainty for error, uncertainty, _ in found.values())
    assert max(rounds for *_, rounds in found.values()) > 1
