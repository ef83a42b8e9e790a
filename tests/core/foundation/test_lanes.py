"""Lanes: numbers of many designs are what the plain numbers would be, and so are decisions."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from linkwork.core.expression.grammar import parse
from linkwork.core.expression.tree import Node
from linkwork.core.expression.values import value
from linkwork.core.foundation import lanes as elementwise
from linkwork.core.foundation.errors import ExpressionError
from linkwork.core.foundation.lanes import LaneArithmetic, NotElementwise, rest_of
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.mechanism.link_shape import independent, least_norm

RNG = np.random.default_rng(9)
REAL = np.concatenate([RNG.normal(0, 3, 12), [0.0, -1.0, math.pi, -math.pi, 3 * math.pi, 7.5]])
COMPLEX = REAL + 1j * np.roll(REAL, 5)

FUNCTIONS: dict[str, tuple[Any, ...]] = {  # a function, and arrays
    "vector": (elementwise.vector, REAL, np.roll(REAL, 1)),
    "phase": (elementwise.phase, COMPLEX),
    "turn": (elementwise.cis, REAL),
    "rect": (elementwise.rect, REAL, np.roll(REAL, 1)),
    "sqrt": (elementwise.sqrt, np.abs(REAL)),
    "exponential": (elementwise.exponential, COMPLEX),
    "hypot": (elementwise.hypot, REAL, np.roll(REAL, 1)),
    "copysign": (lambda x: elementwise.copysign(2.0, x), REAL),
    "remainder": (lambda x: elementwise.remainder(x, 2 * math.pi), 3 * REAL),
    "degrees": (elementwise.degrees, REAL),
    "largest": (lambda x, y: elementwise.largest((x, 0.5, y)), REAL, np.roll(REAL, 1)),
    "smallest": (lambda x, y: elementwise.smallest((x, 0.5, y)), REAL, np.roll(REAL, 1)),
    "choose": (lambda x, y: elementwise.choose(x > y, x, 2.0 * y), REAL, np.roll(REAL, 1)),
    "power": (operator.pow, np.abs(REAL) + 0.1, np.roll(REAL, 1)),
    "divide": (operator.truediv, COMPLEX, COMPLEX[::-1] + 0.1),
    "round": (round, 2.5 * np.round(REAL)),
    "mixed": (lambda z: (2.0 - z) * 1j / (3.0 + abs(z.conjugate())) - z.real * z.imag, COMPLEX),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_of_lanes_are_those_of_plain_numbers(name: str) -> None:
    function, *given = FUNCTIONS[name]
    consensus = LaneArithmetic(len(given[0]))
    together = function(*(consensus.lanes(values) for values in given)).values
    alone = [function(*(number.item() for number in row)) for row in zip(*given, strict=True)]
    np.testing.assert_allclose(together, alone, rtol=1e-15, atol=1e-15)
    assert consensus.agreeing.all()


def test_the_leader_decides_and_lanes_of_another_mind_leave() -> None:
    consensus = LaneArithmetic(4, leader=1)
    x = consensus.lanes(np.array([1.0, 2.0, 3.0, np.nan]))
    assert x < 2.5
    assert consensus.agreeing.tolist() == [True, True, False, False]
    assert x != 1.0
    assert consensus.agreeing.tolist() == [False, True, False, False]


def test_both_of_two_conditions_are_one_question() -> None:
    consensus = LaneArithmetic(3)
    x = consensus.lanes(np.array([-1.0, 2.0, -3.0]))
    assert not (x < 0.0) & (x < -2.0)
    assert consensus.agreeing.tolist() == [True, True, False]
    assert (x < 0.0) != (x > 0.0)
    assert consensus.agreeing.tolist() == [True, True, False]


def test_a_settled_number_sets_others_apart_without_making_them_leave() -> None:
    consensus = LaneArithmetic(3)
    assert elementwise.uniform_value(consensus.lanes(np.array([2.0, 2.0, 3.0]))) == 2.0
    assert consensus.apart.tolist() == [False, False, True]
    assert consensus.agreeing.all()


@pytest.mark.parametrize(
    "use",
    [float, int, complex, math.sqrt, hash, np.array, np.sin, lambda x: np.ones(3) * x,
     lambda x: x * np.ones(3), lambda x: np.zeros(3).fill(x), list],
)  # fmt: skip
def test_what_wants_one_number_gets_none(use: Callable[[Any], object]) -> None:
    with pytest.raises(NotElementwise):
        use(LaneArithmetic(3).lanes(np.array([1.0, 2.0, 3.0])))


def test_numpy_scalars_compute_with_lanes() -> None:
    x = LaneArithmetic(2).lanes(np.array([1.0, 2.0]))
    three: Any = np.float64(3.0)
    unit: Any = np.complex128(1j)
    assert (three - x).values.tolist() == [2.0, 1.0]
    assert (unit * x).values.tolist() == [1j, 2j]


FORMULAS = (
    "a + 2*b", "sqrt(a)", "a^b", "a^0.5", "(a-2)^3", "1/b", "ln(a)*log10(b)", "exp(300*a)",
    "asin(a/3)", "acos(b)", "atan2(a, b)", "min(a, b, 1)", "max(a, 2)", "hypot(a, b)",
    "sin(a) + cos(b) - tan(a)", "abs(a)", "exp(a)", "a*1e308",
)  # fmt: skip


@pytest.mark.parametrize("text", FORMULAS)
def test_formulas_have_the_values_and_the_errors_that_they_have_alone(text: str) -> None:
    rows = [(1.0, 2.0), (2.5, -1.0), (-1.0, 0.5), (0.0, -2.0), (4.0, 0.0), (0.0, 0.0), (3.5, 3.0)]
    tree = parse(text)
    for leader in range(len(rows)):
        consensus = LaneArithmetic(len(rows), leader=leader)
        names = {
            name: consensus.lanes(np.array(column))
            for name, column in zip("ab", zip(*rows, strict=True), strict=True)
        }
        with np.errstate(all="ignore"):
            together = _outcome(tree, names, text)
        told = [_outcome(tree, {"a": a, "b": b}, text) for a, b in rows]
        assert consensus.agreeing[leader]
        for k in np.flatnonzero(consensus.agreeing):
            if isinstance(together, str):
                assert isinstance(told[k], str)
            else:
                assert together.values[k] == pytest.approx(told[k], rel=1e-15)


def _outcome(tree: Node, names: Mapping[str, Any], text: str) -> Any:
    try:
        return value(tree, names, AngleUnit.DEGREE, text)
    except ExpressionError as error:
        return str(error)


def test_what_is_not_done_goes_on_with_the_leader_and_comes_back() -> None:
    consensus = LaneArithmetic(5, leader=1)
    x = consensus.lanes(np.array([1.0, 2.0, 3.0, 4.0, 5.0]))
    assert x < 4.5  # the last lane leaves
    rest = rest_of(x < 2.5)
    assert rest is not None
    assert rest.lanes.tolist() == [1, 2, 3]
    part = rest.narrow(x)
    assert part < 3.5  # and the fourth
    rest.leave()
    whole: Any = rest.widen(x, 10.0 * part)
    assert whole.values.tolist() == [1.0, 20.0, 30.0, 40.0, 5.0]
    assert consensus.agreeing.tolist() == [True, True, True, False, False]
    assert rest.narrow(7.0) == 7.0
    assert rest_of(True) is None


def test_least_norm_solutions_in_lanes_are_those_of_each_lane() -> None:
    matrices = RNG.normal(size=(6, 3, 5))
    matrices[2, 2] = matrices[2, 0] + matrices[2, 1]  # dependent rows
    right = RNG.normal(size=(6, 3))
    right[2, 2] = right[2, 0] + right[2, 1]
    consensus = LaneArithmetic(6)
    rows = [[consensus.lanes(matrices[:, i, j]) for j in range(5)] for i in range(3)]
    found: Sequence[Any] = least_norm(rows, [consensus.lanes(right[:, i]) for i in range(3)])
    for k in range(6):
        alone = least_norm(matrices[k].tolist(), right[k].tolist())
        np.testing.assert_allclose([x.values[k] for x in found], alone, rtol=1e-12, atol=1e-13)


def test_rows_that_depend_on_those_before_are_left_out() -> None:
    first, second, other = RNG.normal(size=(3, 5))
    rows = np.array([first, 1e-3 * second, first - 2.0 * second, other, second + other])
    assert independent(rows.tolist()) == [0, 1, 3]
