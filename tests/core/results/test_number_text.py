"""Numbers as text: lower bounds are never rounded up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from linkwork.core.results.listing import rounded_down


@pytest.mark.parametrize(
    ("value", "shown"),
    [(40.0546, 40.05), (44.9999, 44.99), (9.9996, 9.999), (45.0, 45.0), (0.25057, 0.2505), (0, 0)],
)
def test_a_lower_bound_is_rounded_down(value: float, shown: float) -> None:
    assert rounded_down(value, 4) == shown


def test_rounding_down_loses_less_than_one_digit() -> None:
    for value in np.random.default_rng(1).lognormal(0.0, 3.0, 200).tolist():
        assert value * (1.0 - 1e-3) < rounded_down(value, 4) <= value
    assert math.isnan(rounded_down(math.nan, 4))
