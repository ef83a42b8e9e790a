"""Arcs that contain angles."""

from __future__ import annotations

import numpy as np
import pytest

from linkwork.core.foundation.units import arc_in_order, least_arc


@pytest.mark.parametrize(
    ("angles", "begin", "extent"),
    [
        ([20.0, 50.0, 140.0], 20.0, 120.0),
        ([350.0, 10.0, 30.0], 350.0, 40.0),
        ([10.0, 350.0, 30.0], 350.0, 40.0),
        ([-30.0, 400.0], -30.0, 70.0),
        ([77.0], 77.0, 0.0),
    ],
)
def test_the_least_arc_contains_all_angles(
    angles: list[float], begin: float, extent: float
) -> None:
    found = least_arc(np.array(angles), 360.0)
    assert found[1] == pytest.approx(extent, abs=1e-12)
    assert (found[0] - begin) % 360.0 == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("angles", "begin", "extent"),
    [
        ([20.0, 50.0, 140.0], 20.0, 120.0),
        ([140.0, 50.0, 20.0], 20.0, 120.0),
        ([350.0, 10.0, 30.0], 350.0, 40.0),
        ([5.0, 89.0, 173.0, 257.0, 341.0], 5.0, 336.0),  # the least arc leaves a wider gap
        ([5.0, 200.0, 100.0], -260.0, 265.0),
        ([0.0, 200.0, 100.0, 300.0], 100.0, 260.0),  # in no order: the least one
        ([300.0, 10.0], 300.0, 70.0),
        ([77.0, 77.0], 77.0, 0.0),
    ],
)
def test_the_arc_through_angles_keeps_their_order(
    angles: list[float], begin: float, extent: float
) -> None:
    found = arc_in_order(np.array(angles), 360.0)
    assert np.allclose(found, (begin, extent), rtol=0.0, atol=1e-12)
