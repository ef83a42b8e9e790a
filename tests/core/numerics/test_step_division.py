"""Steps are looked into only where a rate may be zero, or the starting value may be passed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from linkwork.core.equations.compiling import ParametrizedTable
from linkwork.core.numerics import curve_tracing as step_division
from linkwork.core.numerics.branch_tracking import InputPath
from linkwork.core.numerics.curve_tracing import StartingValue, divide_step, reach
from tests.core.numerics.systems import four_bar_table
from tests.oracles.four_bar import FourBar

LEADS = ParametrizedTable(
    four_bar_table(FourBar(4.0, 2.0, 5.0, 4.0)), InputPath(origin=np.zeros(1), rate=np.ones(1)), 0
)


def test_functions_stay_between_the_bounds_of_a_step() -> None:
    """Sums of waves that are five steps long or longer."""
    rng = np.random.default_rng(8)
    t, decided = np.linspace(0.0, 1.0, 401), 0
    for _ in range(2000):
        waves, phases = rng.uniform(0.0, 0.4 * math.pi, 3), rng.uniform(0.0, 2.0 * math.pi, 3)
        sizes, mean = rng.normal(size=3), rng.normal()
        value = mean + np.sin(t[:, None] * waves + phases) @ sizes
        slope = np.cos(t[:, None] * waves + phases) @ (sizes * waves)
        low, high = reach(1.0, value[0], slope[0], value[-1], slope[-1])
        assert low <= value.min() + 1e-15
        assert value.max() <= high + 1e-15
        decided += low > 0.0 or high < 0.0
    # most of those without a zero are known to have none
    assert decided > 800


def test_no_position_is_solved_in_a_step_whose_rate_stays_away_from_zero(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    led = LEADS.with_parameter(LEADS.parameter)
    assert led is not None
    e3, e4 = FourBar(4.0, 2.0, 5.0, 4.0).phasors(np.array([0.8, 1.0]), 1)
    rows = np.stack([np.angle(e3), np.angle(e4), [0.8, 1.0]], axis=1)
    low, high = (led.node(row) for row in rows)
    place = int(np.abs(low.first[:2]).argmax())
    monkeypatch.delattr(step_division, "node_between")
    assert divide_step(led, place, low, high) == [low, high]


@pytest.mark.parametrize(
    ("low", "high", "between"),
    [
        (0.4, 0.6, True),
        (0.6, 6.7, False),
        (-5.8, -5.7, True),
        (0.5 + 2.0 * math.pi, 0.5 + 2.0 * math.pi, True),
        (-0.2, 0.5 - 1e-9, False),
    ],
)
def test_values_at_which_a_curve_can_close_are_turns_apart(
    low: float, high: float, between: bool
) -> None:
    own = LEADS.with_parameter(LEADS.parameter)
    assert own is not None
    home = StartingValue(LEADS, own, np.array([0.0, 0.0, 0.5]))
    assert home.is_between(low, high) is between
