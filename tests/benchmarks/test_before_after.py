"""Comparing two checkouts: the interval that decides, and a run of one entry."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from benchmarks.before_after import interval_of_median, main

ROOT = Path(__file__).resolve().parents[2]


def test_the_interval_covers_the_median_as_often_as_it_says() -> None:
    rng = np.random.default_rng(4)
    covered = 0
    for _ in range(2_000):
        low, high = interval_of_median(rng.exponential(size=15).tolist())
        covered += low <= np.log(2.0) <= high
    assert 0.95 <= covered / 2_000 <= 0.98  # 0.965 by the binomial distribution


def test_five_pairs_decide_nothing() -> None:
    assert interval_of_median([2.0] * 5) == (-np.inf, np.inf)
    assert interval_of_median([2.0] * 6) == (2.0, 2.0)


def test_a_tree_is_as_fast_as_itself(capfd: pytest.CaptureFixture[str]) -> None:
    main([str(ROOT), "start", "--pairs", "1"])
    lines = capfd.readouterr().out.splitlines()
    assert [line.split()[:2] for line in lines[:2]] == [["start:", "import"], ["start:", "solve"]]
    assert all(0.1 < float(re.split(r"\s+", line)[2]) < 10.0 for line in lines[:2])
