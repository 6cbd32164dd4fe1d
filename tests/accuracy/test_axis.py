"""Peak pressures on the axis under a ball, on linear elements."""

import numpy as np
from axis_decks import ball, judged, peak_of


def test_a_requested_peak_on_the_axis_is_within_its_uncertainty(tmp_path):
    """Of a seed that judges."""
    error, uncertainty = judged(1000, "CAX4", tmp_path)
    assert abs(error) <= uncertainty <= 0.02


def test_one_finer_mesh_tells_no_peak_on_the_axis_of_linear_elements(tmp_path):
    for kind, pairing, reason in (("CAX4", "NODES", "axis"), ("CAX3", "SURFACES", "axis"), ("CAX8", "NODES", ""),
                                  ("CAX8", "SURFACES", "")):
        text = ball(1000, kind).replace("PAIRING=NODES", f"PAIRING={pairing}")
        _, uncertainty, why = peak_of(text, [], tmp_path)
        assert f"PAIRING={pairing}" in text and why == reason and np.isnan(uncertainty) == bool(reason)
