"""Dead points close to change points: to rounding, within their brackets, or not located."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import linkwork as lw
from tests.campaigns.dead_points import NearChangePoint, dead_point_campaign

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


#: Margins of 1e-12: branches a few millionths of a radian apart; their dead points from 60 digits.
NEAREST = {
    "the other circuit is next to the fold": (NearChangePoint(
        g=2.1597103362376124, a=1.4582999907943637, b=2.4161326821088487, c=1.7147223366522775,
        margin=1.3e-11, start=1.3108889920555715, side=-1.0,
    ), 2.43597041967401e-06, 6.283182871209167),
    "the other circuit lies straight ahead": (NearChangePoint(
        g=3.1074845156470308, a=1.6105873123795276, b=0.8406661614991207, c=2.3375633647683793,
        margin=1.8e-12, start=-0.8038459703244681, side=1.0,
    ), -1.35438965778794, -1.0247380928554838e-06),
    "every leader turns back": (NearChangePoint(
        g=0.8544240640503823, a=2.9044803242695525, b=4.483877403577447, c=2.4338211433570685,
        margin=1.2e-12, start=-1.3169695993574124, side=1.0,
    ), -6.283183894425889, -1.4127536975993568e-06),
    "the fastest variable turns back first": (NearChangePoint(
        g=1.6822701263741764, a=3.560405099007593, b=4.768833472060839, c=2.8906984994256306,
        margin=1.8e-12, start=-0.4830868007722132, side=-1.0,
    ), -6.283184247101873, -1.0600777134525057e-06),
}  # fmt: skip


@pytest.mark.parametrize(("bar", "low", "high"), NEAREST.values(), ids=NEAREST)
@pytest.mark.parametrize("certify", [True, pytest.param(False, marks=pytest.mark.extended)])
def test_branches_that_nearly_cross_are_told_apart(
    bar: NearChangePoint, low: float, high: float, certify: bool
) -> None:
    for ahead in (high + 1e-6, low - 1e-6):
        motion = lw.loads(bar.text(ahead, 48)).sweep(certify=certify)
        reached = motion.found[motion.asked]
        assert reached[:-1].all()
        assert not reached[-1]
        assert motion.counts[lw.Status.OUT_OF_REACH] == 1
        assert all(limit.located for limit in motion.limits)
        found = [limit.input for limit in motion.limits if abs(limit.input - ahead) < 1e-3]
        assert found == pytest.approx([high if ahead > high else low], abs=1e-15, rel=0)
    (circuit,) = (
        c for c in lw.loads(bar.text(ahead, 48)).circuits().circuits if c.branches[0].configuration
    )
    assert circuit.certified
    assert circuit.input_range == pytest.approx((low, high), abs=1e-9)


@pytest.mark.parametrize("gap", [3e-6, 3e-7])
def test_a_circuit_that_begins_next_to_its_dead_point_closes(gap: float) -> None:
    bar, low, high = NEAREST["the other circuit is next to the fold"]
    start = replace(bar, start=low + gap)
    (circuit,) = lw.loads(start.text(start.start + 0.1, 10)).circuits().circuits
    assert circuit.end is lw.CircuitEnd.CLOSED
    found = sorted(limit.input for limit in circuit.dead_points)
    assert found == pytest.approx([low, high], abs=1e-15, rel=0)


@pytest.mark.extended
@pytest.mark.parametrize("part", range(2))
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
