"""Points drawn inside polygons, and pivots of samples in their region."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.synthesis.poses.guiding_linkage import spread_pivots
from linkwork.synthesis.precision.solving import points_in_polygon, positions_with_samples
from linkwork.synthesis.tasks.conditions import Wishes

# an L, a triangle without level sides, a narrow diagonal strip, two prongs
_POLYGONS = [
    [0, 4, 4 + 1j, 1 + 1j, 1 + 4j, 4j],
    [0, 3 + 1j, 1 + 2j],
    [0, 100 + 100j, 100 + 100.01j, 0.01j],
    [0, 6, 6 + 5j, 4 + 5j, 4 + 1j, 2 + 1j, 2 + 5j, 5j],
]


@pytest.mark.parametrize("corners", _POLYGONS)
@pytest.mark.parametrize("turned", [1.0, -1.0])
def test_points_are_inside_and_spread_by_area(corners: list[complex], turned: float) -> None:
    polygon = np.array(corners, dtype=complex) * complex(turned)
    z = points_in_polygon(polygon, np.random.default_rng(1).uniform(size=(4000, 2)))
    wishes = Wishes(region=polygon)
    assert wishes.within_region(z, np.full(len(z), 1e-12)).all()
    # the centroid by Green's formula, to four standard errors
    x, y, u, v = polygon.real, polygon.imag, np.roll(polygon.real, -1), np.roll(polygon.imag, -1)
    across = x * v - u * y
    centre = np.sum((x + u) * across) + 1j * np.sum((y + v) * across)
    centre /= 3.0 * np.sum(across)
    assert abs(z.mean() - centre) < 4.0 * np.sqrt(np.mean(np.abs(z - centre) ** 2) / len(z))


def test_drawn_pivots_are_in_the_polygon_of_a_region() -> None:
    points, free = np.array([0, 1 + 0.2j, 2, 2.5 + 1j]), np.full(4, np.nan)
    region = np.array(_POLYGONS[2], dtype=complex)
    rng = np.random.default_rng(2)
    drawn = positions_with_samples(points, free, np.zeros(0, complex), 20, rng, region)
    pivots = np.concatenate([task.pivots for task in drawn])
    assert len(pivots) == 40
    assert Wishes(region=region).within_region(pivots, np.full(40, 1e-12)).all()


def test_pivots_fill_a_narrow_region_too() -> None:
    wishes = Wishes(region=np.array(_POLYGONS[2], dtype=complex))
    z = spread_pivots(np.array([0j, 1.0]), wishes, 32)
    assert len(z) == 32
    assert wishes.within_region(z, np.full(32, 1e-12)).all()
    assert np.ptp(z.real) > 80.0


def test_four_bars_of_a_triangular_region_have_their_pivots_in_it() -> None:
    points = [(0, 0), (1, 0.2), (2, 0.1), (2.5, 1)]
    corners = [[-1, -3], [4, -3], [1.5, -1]]
    found = lw.Task.path(points, wanted={"fixed_pivots": {"inside": corners}}).solve()
    outside = sum(
        "fixed pivot outside its region" in [k.value for k in d.kinds] for d in found.designs
    )
    assert found.designs
    assert outside == 0
