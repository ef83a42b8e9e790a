"""Lanes of bounded least squares with own variables of rows, beside SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

from linkwork.core.foundation.arrays import Array, IndexArray
from linkwork.synthesis.lane_least_squares import Box, Residuals, RowVariables, minimise, starts_of

_POINTS = np.array([[1.9, -0.4], [2.1, 0.3], [1.7, 1.2], [0.6, 1.9], [-0.5, 1.8]])


def _ellipse(x: Array, t: Array, lanes: IndexArray) -> Residuals:
    """(x0 cos t, x1 sin t) + (x2, 0) beside the points."""
    rows = np.stack([x[:, :1] * np.cos(t) + x[:, 2:], x[:, 1:2] * np.sin(t)], axis=2) - _POINTS
    by_x = np.zeros((*rows.shape, 3))
    by_x[:, :, 0, 0], by_x[:, :, 1, 1], by_x[:, :, 0, 2] = np.cos(t), np.sin(t), 1.0
    by_t = np.stack([-x[:, :1] * np.sin(t), x[:, 1:2] * np.cos(t)], axis=2)
    return Residuals(rows, by_x, by_t, np.zeros((len(x), 0)), np.zeros((len(x), 0, 3)))


@pytest.mark.parametrize(("least", "most"), [(0.1, 1.3), (-0.1, 3.0), (0.6, 0.9)])
@pytest.mark.parametrize("in_order", [False, True])
def test_bounded_row_variables_reach_the_minimum_of_scipy(
    least: float, most: float, in_order: bool
) -> None:
    box = Box(least=np.array([0.5, 0.5, -0.2]), most=np.array([3.0, 3.0, 0.2]))
    rows = RowVariables(least=least, most=most, in_order=in_order, gap=1e-9 * in_order)
    x, t = np.array([[1.5, 1.5, 0.0]]), np.linspace(least, most, 5)[None]
    found = minimise(_ellipse, starts_of(x, t), box, 200, row_variables=rows)

    def flat(z: Array) -> Array:
        return _ellipse(z[None, :3], z[None, 3:], np.zeros(1, dtype=np.intp)).rows.ravel()

    bounds = [*box.least, *[least] * 5], [*box.most, *[most] * 5]
    expected = least_squares(
        flat, [*x[0], *t[0]], bounds=bounds, xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    # the points rise along the ellipse, so that their order binds only between bounds
    assert found.total[0] == pytest.approx(2.0 * expected.cost, rel=1e-6)
    assert (least <= found.t).all()
    assert (found.t <= most).all()
    assert not in_order or (np.diff(found.t) > 0.0).all()


def test_variables_in_order_leave_room_for_each_other() -> None:
    rows = RowVariables(least=0.0, most=1.0, in_order=True, gap=0.1, span=0.7)
    t = rows.inside(np.array([[-3.0, -4.0, 5.0, 4.9]]))
    assert t[0] == pytest.approx([0.0, 0.1, 0.2, 0.3], abs=1e-15)
    t = rows.inside(np.array([[0.9, 0.95, 3.0, 4.0]]))
    assert t[0] == pytest.approx([0.7, 0.8, 0.9, 1.0], abs=1e-15)


def test_few_steps_fail_along_a_bent_valley() -> None:
    """Rosenbrock's, a hundred times narrower: a damping that has failed is not tried again."""
    tried = list[float]()

    def evaluate(x: Array, t: Array, lanes: IndexArray) -> Residuals:
        rows = np.stack([1000.0 * (x[:, 1] - x[:, 0] ** 2), 1.0 - x[:, 0]], axis=1)
        slopes = np.zeros((len(x), 2, 2))
        slopes[:, 0, 0], slopes[:, 0, 1], slopes[:, 1, 0] = -2000.0 * x[:, 0], 1000.0, -1.0
        found = Residuals(np.zeros((1, 0, 2)), np.zeros((1, 0, 2, 2)), None, rows, slopes)
        tried.append(float(found.total[0]))
        return found

    box = Box(least=np.full(2, -np.inf), most=np.full(2, np.inf))
    start = starts_of(np.array([[-1.2, 1.0]]), np.zeros((1, 0)))
    assert minimise(evaluate, start, box, 2000).total[0] < 1e-20
    assert len(tried) < 500
