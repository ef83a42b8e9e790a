"""Paths between rows: smooth near dead points and quick turns, straight at corners."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.core.drawing.paths import UNSEEN, smoothed
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.results.motion import Motion

_SIZE = 800.0  # pixels
_SEEN = 0.3  # pixels
_FOUR_BAR = """
format = 1
name = "Four-bar with dead points"
[points]
O = [0, 0]
C = [100, 0]
A = [{ax}, {ay}]
B = [{bx}, {by}]
P = [{px}, {py}]
[links]
ground = ["O", "C"]
crank = ["O", "A"]
coupler = ["A", "B", "P"]
rocker = ["C", "B"]
[input]
link = "crank"
from = 0
to = 360
"""
_SLIDER_CRANK = """
format = 1
name = "Slider-crank with dead points"
[points]
O = [0, 0]
T = [50, 0]
A = [60, 0]
B = [105, 0]
P = [{px}, {py}]
[links]
ground = ["O", "T"]
block = ["B"]
crank = ["O", "A"]
rod = ["A", "B", "P"]
[[sliders]]
name = "s"
link = "block"
points = ["B"]
on = "ground"
line = ["O", "T"]
[input]
link = "crank"
from = 0
to = 360
"""


def _four_bar(crank: float, coupler: float, rocker: float, at: float) -> lw.Mechanism:
    a = crank * np.exp(1j * at)
    far = abs(100 - a)
    u = (coupler**2 - rocker**2 + far**2) / (2 * far)
    b = a + (100 - a) / far * complex(u, np.sqrt(coupler**2 - u**2))
    p = a + (b - a) * complex(0.6, 0.7)
    places = {"ax": a.real, "ay": a.imag, "bx": b.real, "by": b.imag, "px": p.real, "py": p.imag}
    return lw.loads(_FOUR_BAR.format(**places))


def _largest(motion: Motion, dense: Motion, *, bent: bool = True) -> float:
    """The largest distance of a point of a dense sweep from a drawn path [pixels]."""
    every = np.concatenate([motion.trace(p) for p in motion.points])
    every = every[np.isfinite(every)]
    size = max(np.ptp(every.real), np.ptp(every.imag))
    apart = 0.0
    for point in motion.points:
        jet = motion.place(point)
        path = smoothed(jet.v, UNSEEN * size, jet.d1, jet.d2) if bent else jet.v
        true = dense.trace(point)
        apart = max(apart, float(_distances(true[np.isfinite(true)], path).max()))
    return float(apart / size * _SIZE)


def _distances(points: ComplexArray, path: ComplexArray) -> Array:
    whole = np.isfinite(path[:-1]) & np.isfinite(path[1:])
    start, step = path[:-1][whole], np.diff(path)[whole]
    squared = np.where(step == 0, 1.0, np.abs(step) ** 2)
    best = []
    for point in points:
        share = np.clip(((point - start) * step.conj()).real / squared, 0.0, 1.0)
        best.append(np.abs(point - start - share * step).min())
    return np.array(best)


@pytest.mark.parametrize(
    ("crank", "coupler", "rocker", "at"),
    [(102, 119, 114, 0.4), (83, 65, 128, 1.2), (61, 127, 81, 0.6)],
)
def test_the_path_of_a_rocker_with_dead_points_is_smooth(
    crank: float, coupler: float, rocker: float, at: float
) -> None:
    mechanism = _four_bar(crank, coupler, rocker, at)
    motion, dense = mechanism.cycle(), mechanism.sweep(step=0.4, through=True)
    assert any(motion.limit)
    assert _largest(motion, dense, bent=False) > 2 * _SEEN
    assert _largest(motion, dense) < _SEEN


def test_the_path_of_a_slider_crank_with_dead_points_is_smooth() -> None:
    mechanism = lw.loads(_SLIDER_CRANK.format(px=80, py=30))
    motion, dense = mechanism.cycle(), mechanism.sweep(step=0.4, through=True)
    assert any(motion.limit)
    assert _largest(motion, dense, bent=False) > 2 * _SEEN
    assert _largest(motion, dense) < _SEEN


def test_few_points_are_added() -> None:
    motion = _four_bar(102, 119, 114, 0.4).cycle()
    jet = motion.place("P")
    size = float(np.nanmax(np.abs(jet.v)))
    assert len(jet.v) < len(smoothed(jet.v, UNSEEN * size, jet.d1, jet.d2)) < 1.2 * len(jet.v)
    leg = lw.example("jansen-leg").cycle().place("F")
    np.testing.assert_array_equal(smoothed(leg.v, UNSEEN * 130, leg.d1, leg.d2), leg.v)


def test_points_of_a_circle_give_a_circle() -> None:
    circle = 100 * np.exp(1j * np.radians([0.0, 40, 50, 80, 81]))
    round_ = smoothed(circle, 0.01)
    middles = (round_[1:] + round_[:-1]) / 2
    assert np.abs(middles).min() > 99.98
    assert np.abs(round_).max() < 100.002
    assert set(circle) <= set(round_)


def test_corners_gaps_and_coinciding_points_are_kept() -> None:
    nan = complex(np.nan, np.nan)
    path = np.array([0, 50, 50 + 50j, nan, 7, 7, nan, 100, 100 + 1j, 100])
    np.testing.assert_array_equal(smoothed(path, 0.01), path)
    np.testing.assert_array_equal(smoothed(path[:1], 0.01), path[:1])
    np.testing.assert_array_equal(smoothed(path[:0], 0.01), path[:0])
    still = np.zeros(3, dtype=complex)
    np.testing.assert_array_equal(smoothed(still, 0.01, still, still), still)
