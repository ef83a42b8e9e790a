"""Dead points close to change points: to rounding, within their brackets, or not located."""

from __future__ import annotations

import math

import numpy as np
import pytest

import linkwork as lw
from tests.campaigns.dead_points import NearChangePoint, dead_point_campaign
from tests.thinned import thinned

#: A change-point margin of 4e-8: the branch turns back within a thousandth of a radian.
BAR = NearChangePoint(
    g=3.7987789880185874,
    a=0.8346386545770186,
    b=3.303553688951543,
    c=1.3298639118425584,
    margin=4e-8,
    start=2.044938885028967,
    side=-1.0,
)
TRUE = 3.141243118790687


@pytest.mark.parametrize("certify", [True, False])
def test_a_hairpin_is_not_cut_short(certify: bool) -> None:
    motion = lw.loads(BAR.text(BAR.start + 4.5, 45)).sweep(certify=certify)
    (limit,) = (limit for limit in motion.limits if limit.input > BAR.start)
    assert limit.located
    assert limit.input == pytest.approx(TRUE, abs=1e-13)
    assert limit.bracket[0] <= TRUE <= limit.bracket[1]
    before = motion["t2"] < TRUE - 1e-9
    assert motion.found[before].all()


@pytest.mark.parametrize("part", thinned(range(2)))
def test_dead_points_of_random_four_bars_are_exact(part: int) -> None:
    counts, false = dead_point_campaign(part, 3)
    assert not false
    assert counts["dead points located"] == counts["dead points"] > 25
    assert counts["family dead point"] > 5


def test_a_limit_s_number_is_not_rounded_and_its_words_are_short() -> None:
    motion = lw.example("rapier-drive-limited").sweep()
    limit = motion.limits[0]
    assert limit.input != round(limit.input, 9)
    assert limit.bracket[0] <= limit.input <= limit.bracket[1]
    assert limit.bracket[1] - limit.bracket[0] < 1e-11
    words = limit.told("θ12", "deg")
    assert f"{limit.input:.12g}" in words
    assert repr(limit.input) not in words
    (row,) = np.flatnonzero(motion["θ12"] == limit.input)
    assert motion.limit[row] == "dead point"
    assert math.isfinite(motion.radius[row])
