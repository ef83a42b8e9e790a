"""Transmission angles against closed forms of the four-bar and the slider-crank."""

from __future__ import annotations

import numpy as np
import pytest

import linkwork as lw
from linkwork.writers.charts.chart import column_of


def four_bar_angle(a: float, b: float, c: float, d: float, theta: np.ndarray) -> np.ndarray:
    """By the law of cosines in both triangles on the diagonal A O4 [rad]."""
    diagonal = a * a + d * d - 2 * a * d * np.cos(theta)
    return np.asarray(np.arccos((b * b + c * c - diagonal) / (2 * b * c)))


def test_of_a_four_bar_it_follows_from_the_diagonal() -> None:
    motion = lw.example("four-bar").sweep()
    points = {p: motion.trace(p) for p in ("O2", "A", "B", "O4")}
    a, b = (abs(points[q] - points[p])[0] for p, q in (("O2", "A"), ("A", "B")))
    c, d = (abs(points[q] - points[p])[0] for p, q in (("B", "O4"), ("O2", "O4")))
    expected = np.degrees(four_bar_angle(a, b, c, d, np.radians(motion["crank"])))
    np.testing.assert_allclose(motion["B.transmission"], expected, atol=1e-11)
    assert motion.quantity("B.transmission").unit == "deg"


def test_of_a_slider_crank_it_is_complementary_to_the_rod() -> None:
    motion = lw.example("slider-crank").sweep()
    lean = np.degrees(np.arcsin((40 * np.sin(np.radians(motion["crank"])) + 20) / 120))
    np.testing.assert_allclose(motion["B.transmission"], 90 - lean, atol=1e-11)


def test_its_rates_are_those_of_its_values() -> None:
    mechanism, h = lw.example("four-bar"), 1e-3
    here, ahead, behind = (mechanism.solve(50 + k * h) for k in (0, 1, -1))
    step = np.radians(h)
    values = [np.radians(p["B.transmission"]) for p in (behind, here, ahead)]
    assert here["B.transmission.d1"] == pytest.approx(
        (values[2] - values[0]) / (2 * step), rel=1e-8
    )
    rates = [p["B.transmission.d1"] for p in (behind, ahead)]
    assert here["B.transmission.d2"] == pytest.approx((rates[1] - rates[0]) / (2 * step), rel=1e-8)


def test_it_is_0_where_both_arms_lie_in_one_line() -> None:
    parallel = lw.linkage(
        points={"O2": (0, 0), "A": (0, 30), "B": (100, 30), "O4": (100, 0)},
        links={"ground": ["O2", "O4"], "r2": ["O2", "A"], "r3": ["A", "B"], "r4": ["O4", "B"]},
        inputs=lw.Input(link="r2", from_=90, to=0, step=-10),
    )
    motion = parallel.sweep()
    np.testing.assert_allclose(motion["B.transmission"], motion["r2"], atol=1e-9)


def test_charts_measure_it_as_an_angle() -> None:
    column = column_of(lw.example("four-bar").sweep(), "B.transmission")
    assert (column.unit, column.measure, column.turn) == ("deg", "angle", 360.0)
