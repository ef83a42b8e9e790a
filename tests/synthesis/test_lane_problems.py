"""Problems in lanes with known answers: constraints, the largest miss, and interruptions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from linkwork.core.foundation.arrays import Array, IndexArray
from linkwork.synthesis.lane_least_squares import (
    POWERS,
    Box,
    LaneFit,
    LaneProblem,
    Multipliers,
    Residuals,
    RowVariables,
    different,
    starts_of,
)

_PLACES = np.array([0.0, 1.0, 5.0])


class _Mean(LaneProblem):
    """A number near some places, at most 1."""

    def __init__(self, lanes: int) -> None:
        box = Box(least=np.array([-9.0]), most=np.array([9.0]))
        super().__init__(box, RowVariables(), lanes, len(_PLACES), np.zeros(1, dtype=bool))
        self.bound = Multipliers(lanes, 1)
        self.is_bounded = False

    @property
    def multipliers(self) -> Sequence[Multipliers]:
        return [self.bound] if self.is_bounded else []

    def evaluate(
        self, x: Array, t: Array, lanes: IndexArray, power: int | None = None
    ) -> Residuals:
        rows = (x - _PLACES)[:, :, None]
        shared, by_x = np.zeros((len(x), 1)), np.zeros((len(x), 1, 1))
        if self.is_bounded:
            shared, by_x = self.bound.residuals(lanes, x - 1.0, np.ones((len(x), 1, 1)))
        found = Residuals(rows, np.ones((*rows.shape, 1)), None, shared, by_x)
        return self.raised(found, lanes, power)


def _begun(*starts: float) -> tuple[_Mean, LaneFit, IndexArray]:
    x = np.array(starts)[:, None]
    return _Mean(len(x)), starts_of(x, np.zeros((len(x), 0))), np.arange(len(x))


def test_a_mean_is_found_and_the_middle_of_the_largest_misses() -> None:
    problem, fit, every = _begun(-3.0, 8.0)
    fit = problem.further(fit, every, 30)
    assert fit.x[:, 0] == pytest.approx([2.0, 2.0], abs=1e-9)
    for problem.power in POWERS:
        fit = problem.further(fit, every, 60)
    # of three misses the largest is above the least possible one by 3^(1/1024) at most
    assert fit.x[:, 0] == pytest.approx([2.5, 2.5], abs=5e-3)


@pytest.mark.parametrize("weight", [1.0, 10.0])
def test_a_constraint_holds_after_some_rounds_whatever_its_weight(weight: float) -> None:
    problem, fit, every = _begun(-3.0, 8.0)
    problem.is_bounded = True
    problem.weigh(weight)
    one = problem.further(fit, every, 30).x[:, 0]
    assert (one > 1.0 + 1e-3 / weight**2).all()
    for _ in range(60):
        fit = problem.further(fit, every, 30)
    assert fit.x[:, 0] == pytest.approx([1.0, 1.0], abs=1e-6)
    # weight² times the shift is the multiplier: 3 (2 - 1)
    assert weight**2 * problem.bound.shift[:, 0] == pytest.approx([3.0, 3.0], rel=1e-5)
    problem.weigh(2.0 * weight)
    assert problem.further(fit, every, 30).x[:, 0] == pytest.approx([1.0, 1.0], abs=1e-6)


def test_lanes_that_are_not_kept_stay_and_an_interruption_keeps_what_is_measured() -> None:
    problem, fit, _ = _begun(-3.0, 8.0)
    told: list[float] = []
    problem.work.tell = told.append
    after = problem.further(fit, np.array([1]), 30)
    assert after.x[0] == -3.0
    assert after.x[1] == pytest.approx(2.0, abs=1e-9)
    assert not after.interrupted
    assert told == sorted(told)

    def stop(fraction: float) -> None:
        raise KeyboardInterrupt

    problem.work.tell = stop
    after = problem.further(fit, np.arange(2), 30)
    assert after.interrupted
    assert after.x[:, 0].tolist() == [-3.0, 8.0]
    assert after.total.tolist() == [9.0 + 16.0 + 64.0, 64.0 + 49.0 + 9.0]


def test_different_lanes_are_the_best_of_each_kind() -> None:
    x = np.array([1.0, 1.05, 3.0, 3.01, 7.0])
    measure = np.array([2.0, 1.0, 5.0, 4.0, np.inf])
    found = different(measure, lambda chosen, k: np.abs(x[chosen] - x[k]) < 0.1)
    assert found.tolist() == [1, 3]
