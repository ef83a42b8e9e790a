"""Curves that cover each other in a chart."""

from __future__ import annotations

import tracemalloc

import numpy as np

from linkwork.core.foundation.arrays import Array
from linkwork.writers.charts.lines import covering


def _below(*heights: Array) -> list[int]:
    x = np.linspace(0.0, 1.0, len(heights[0]))
    return covering([(x, y) for y in heights], range(len(heights)))


def test_a_curve_is_below_the_later_ones_that_cover_it() -> None:
    wave = np.sin(np.linspace(0.0, 6.0, 500))
    half = np.where(np.arange(500) < 250, wave, np.nan)
    apart = wave + 0.1
    assert _below(wave, apart, wave) == [1, 0, 0]
    assert _below(wave, half, wave) == [2, 1, 0]
    assert _below(np.full(500, np.nan), wave) == [0, 0]


def test_long_motions_are_compared_in_little_memory() -> None:
    wave = np.sin(np.linspace(0.0, 2000.0, 100_000))
    tracemalloc.start()
    assert _below(wave, wave) == [1, 0]
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # a few copies of the curves; a hundred points at once would take 160 MB for each
    assert peak < 40e6
