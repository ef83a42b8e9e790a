"""Values and derivatives of formulas over boxes contain those at every point of the box."""

from __future__ import annotations

import math

import numpy as np
import pytest

from linkwork.core.equations.model import FormulaRow
from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import NumberNode
from linkwork.core.foundation.units import AngleUnit

FORMULAS = (
    "x + y - x*y", "x/(y + 4)", "x^3 - x^2 + 1", "(x*y)^4", "(y + 4)^-2", "(y + 4)^(x/2)",
    "sin(3*x)", "cos(x*y)", "tan(x/3)", "asin(x/4)", "acos(y/4)", "atan(x)", "atan2(x, y + 4)",
    "exp(x)", "ln(x^2 + 1)", "log10(y + 4)", "sqrt(x + 4)", "abs(x)", "hypot(x, y)",
    "min(x, y, x*y)", "max(x, y)", "pi*x + e*y",
)  # fmt: skip


def row_of(text: str, unit: AngleUnit = AngleUnit.RADIAN) -> FormulaRow:
    return FormulaRow(
        left=parse(text), right=NumberNode(0.0), names=("x", "y"), variables=(0, 1), constants=(),
        unit=unit,
    )  # fmt: skip


@pytest.mark.parametrize("unit", AngleUnit, ids=lambda unit: unit.value)
@pytest.mark.parametrize("text", FORMULAS)
def test_a_box_contains_the_values_and_slopes_at_its_points(text: str, unit: AngleUnit) -> None:
    rng = np.random.default_rng(7)
    row = row_of(text, unit)
    v = rng.uniform(-3.0, 3.0, (60, 2))
    box = 10.0 ** rng.uniform(-14.0, -0.5, (60, 2))
    places = v + box * rng.uniform(-1.0, 1.0, (60, 2))
    value, slope = row.value_and_gradient(places)
    values, slopes = row.enclosure(v, box)
    # values and slopes at points are rounded themselves, relative to their terms: at most 1e3
    slack = 1e-12
    assert (values[0] - slack <= value).all()
    assert (value <= values[1] + slack).all()
    assert (slopes[0] - slack <= slope).all()
    assert (slope <= slopes[1] + slack).all()


@pytest.mark.parametrize("text", FORMULAS)
def test_a_point_is_enclosed_to_rounding(text: str) -> None:
    v = np.random.default_rng(8).uniform(0.2, 2.0, (40, 2))
    values, slopes = row_of(text).enclosure(v, np.zeros_like(v))
    # a hundred roundings of numbers up to 1e3
    assert (np.diff(values, axis=0) < 1e-11).all()
    assert (np.diff(slopes, axis=0) < 1e-11).all()


def test_a_cosine_is_never_more_than_one() -> None:
    """So that cos x = 1.0000000000000002 is proved to have no root."""
    values, _ = row_of("cos(x) - 1.0000000000000002").enclosure(
        np.array([[0.0, 0.0], [-5.2e-7, 0.0]]), np.array([[700.0, 0.0], [1e-3, 0.0]])
    )
    assert (values[1] < 0.0).all()


@pytest.mark.parametrize("text", ["ln(x)", "sqrt(x)", "atan2(y, x)", "1/x", "x^(1/3)", "asin(x)"])
def test_nothing_is_claimed_where_a_formula_has_no_value_or_jumps(text: str) -> None:
    values, slopes = row_of(text).enclosure(np.array([[-1.0, 0.0]]), np.array([[1.5, 1.0]]))
    bounds = [*values[:, 0], *slopes[:, 0, 0]]
    assert not all(math.isfinite(bound) for bound in bounds)
