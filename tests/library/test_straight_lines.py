"""Straight lines, exact and nearly so."""

from __future__ import annotations

import math

import numpy as np
import pytest

import linkwork as lw
from tests.library.laws import degrees, law, motion_of, same
from tests.oracles.circles import circles_meet
from tests.oracles.four_bar import FourBar


@law("peaucellier")
def test_peaucellier_inverts_a_circle_into_the_line_x_16_thirds() -> None:
    """OP·OR = 16, so R = 16/3 (1 + i tan(φ/2)): x = 16/3 exactly.

    OP = 3 cos(φ/2) at the angle φ/2.
    """
    motion = motion_of("peaucellier")
    half = degrees(motion, "crank") / 2
    same(motion.trace("P"), 3 * np.cos(half) * np.exp(1j * half), 5)
    same(motion.trace("R"), 16 / 3 * (1 + 1j * np.tan(half)), 5)
    same(motion["power"], 16, 16)


@law("hart-inversor")
def test_hart_inverts_a_circle_into_a_line_on_the_other_side() -> None:
    """OP·OQ = (m² - n²)/4 = 16 in opposite directions: Q = -16/conj(P), x = -3.2."""
    motion = motion_of("hart-inversor")
    p = 2.5 + 2.5 * np.exp(1j * degrees(motion, "crank"))
    same(motion.trace("P"), p, 10)
    same(motion.trace("Q"), -16 / np.conj(p), 10)
    same(motion.trace("Q").real, -3.2, 10)


@law("scott-russell")
def test_scott_russell_moves_on_the_line_through_the_pivot() -> None:
    """C = (0, 2r sin θ), on the line through the crank's pivot."""
    motion = motion_of("scott-russell")
    crank = degrees(motion, "crank")
    same(motion.trace("C"), 200j * np.sin(crank), 200)
    same(motion["s"], 200 * np.cos(crank), 200)


@law("watt-linkage")
def test_watt_linkage_draws_watts_curve() -> None:
    """r² = b² - (a sin θ ± √(c² - a² cos² θ))² with a = b = 8, c = 2."""
    path = motion_of("watt-linkage").trace("P")
    squared, theta = np.abs(path) ** 2, np.angle(path)
    sine, under = 8 * np.sin(theta), 4 - 64 * np.cos(theta) ** 2
    # without the root, which has no digits left where it is small
    same((64 - squared - sine**2 - under) ** 2, 4 * sine**2 * under, 64**2)
    assert np.ptp(squared) > 25
    straight = path[np.abs(path.imag) < 2]
    across = straight.real - np.polyval(np.polyfit(straight.imag, straight.real, 1), straight.imag)
    assert np.max(np.abs(across)) < 0.001  # over 4 of height


@law("chebyshev")
def test_chebyshev_stays_between_4_and_4_009754_from_pivot_to_pivot() -> None:
    """y = (2 + cos φ) √((20 - 4 cos φ)/(5 + 4 cos φ)): 4 to 4.009754 from pivot to pivot."""
    motion = motion_of("chebyshev")
    a, p = motion.trace("A"), motion.trace("P")
    cosine = (a - p).real
    y = (2 + cosine) * np.sqrt((20 - 4 * cosine) / (5 + 4 * cosine))
    same(p.imag, y, 5)
    same(p.real, 2 - y * (a - p).imag / (2 + cosine), 5)
    between = p.imag[(p.real > 0) & (p.real < 4)]
    assert len(between) > 50
    assert between.min() > 4 - 1e-12
    assert 4.0097 < between.max() < 4.009754
    linkage = lw.example("chebyshev")
    for at, x in ((math.degrees(math.atan2(4, 3)), 2), (90, 0)):  # x = 4 is a dead point
        assert linkage.solve(at=at).points["P"] == pytest.approx((x, 4), abs=1e-12 * 5)


@law("roberts")
def test_roberts_apex_is_on_the_line_of_the_pivots_three_times() -> None:
    """y = 0 in the middle and at either pivot, between them within 0.3 % of their distance."""
    motion = motion_of("roberts")
    bar = FourBar(4, 3, 2, 3)
    left = degrees(motion, "left")
    a, b = bar.crank_end(left), bar.coupler_end(left, 1)
    apex = a + (b - a) * complex(0.5, -math.sqrt(2))  # √8 below the middle of the base 2
    same(motion.trace("P"), apex, 4)
    between = motion.trace("P")[(apex.real > 0) & (apex.real < 4)]
    assert np.max(np.abs(between.imag)) < 0.003 * 4
    fold = math.degrees(math.atan2(math.sqrt(5), 2))  # A on both circles of radius 3
    turn = math.degrees(2 * math.asin(1 / 3))
    for at, x in ((fold, 4), (math.degrees(math.acos(1 / 3)), 2), (fold + turn, 0)):
        place = lw.example("roberts").solve(at=at).points["P"]
        assert place == pytest.approx((x, 0), abs=1e-12 * 40)


@law("evans")
def test_evans_keeps_a_right_angle_at_the_cranks_pivot() -> None:
    """The angle P O2 B is 90° (Thales); x within 0.033 over a height of 12."""
    motion = motion_of("evans")
    pivot = 5 * complex(math.sqrt(3), -1)
    a = 5 * np.exp(1j * degrees(motion, "crank"))
    b = circles_meet(a, 5, np.full(a.shape, pivot), 5, 1)
    same(motion.trace("B"), b, 10)
    same(motion.trace("P"), 2 * a - b, 10)
    same((motion.trace("P") * np.conj(motion.trace("B"))).real, 0, 100)
    high = motion.trace("P")[np.abs(motion.trace("P").imag) < 6]
    assert np.max(np.abs(high.real)) < 0.033


@law("hoeken")
def test_hoeken_stays_between_4_and_4_009754_for_half_a_turn() -> None:
    """y between 4 and 4.009754 while the crank turns from 90° to 270°."""
    motion = motion_of("hoeken")
    crank = degrees(motion, "crank")
    bar = FourBar(2, 1, 2.5, 2.5)
    a, b = bar.crank_end(crank), bar.coupler_end(crank, 1)
    same(motion.trace("P"), 2 * b - a, 5)
    straight = motion.trace("P").imag[90:271]
    assert straight.min() >= 4 - 1e-12
    limits = lw.example("hoeken").sweep(from_=90, to=270, limits_of=["P.y"]).output_limits
    highest = max(limit.value for limit in limits)
    assert highest == pytest.approx(4.009754, abs=5e-7)
