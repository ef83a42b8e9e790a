"""Operands: whatever computes with them, plain numbers join in and foreign operands are refused."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from linkwork.core.expression.derivatives import Jet
from linkwork.core.expression.tree import Name
from linkwork.core.foundation.lanes import LaneArithmetic, NotElementwise
from linkwork.core.record.recorder import Recorder
from linkwork.writers.formulas.traced import LinearForm, Trace


def _jet(name: str) -> Jet:
    return Jet(np.array([2.0, 3.0]), np.ones(2), np.zeros(2))


KINDS: dict[str, Callable[[str], Any]] = {
    "lanes": lambda name: LaneArithmetic(2).lanes(np.array([2.0, 3.0])),
    "traced": lambda name: Trace().number(2.0, LinearForm.named(name)),
    "formula": LinearForm.named,
    "jet": _jet,
    "recording": lambda name: Recorder().input(name),
}
OPERATORS = [operator.add, operator.sub, operator.mul, operator.truediv]


def _meaning(x: Any) -> object:
    """What an operand holds, comparable with that of another one."""
    recording = getattr(x, "arithmetic", None)
    if isinstance(recording, Recorder):
        return [recording.ops, recording.arguments, recording.payload, x.number]
    if isinstance(x, LinearForm):
        return x.terms, x.constant
    own = [getattr(x, part, None) for part in ("values", "re", "im", "v", "d1", "d2")]
    return [part.tolist() if isinstance(part, np.ndarray) else part for part in own]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("operation", OPERATORS)
def test_scalars_of_numpy_are_plain_numbers_on_either_side(
    kind: str, operation: Callable[[Any, Any], Any]
) -> None:
    make, two = KINDS[kind], np.float64(2.0)
    assert _meaning(operation(make("x"), two)) == _meaning(operation(make("x"), 2.0))
    assert _meaning(operation(two, make("x"))) == _meaning(operation(2.0, make("x")))
    assert _meaning(operation(make("x"), 2.0)) != _meaning(make("x"))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("operation", OPERATORS)
def test_arrays_texts_and_operands_of_another_kind_are_refused(
    kind: str, operation: Callable[[Any, Any], Any]
) -> None:
    x = KINDS[kind]("x")
    others = [make("y") for other, make in KINDS.items() if other != kind]
    for foreign in (np.ones(2), "2", None, *others):
        for pair in ((x, foreign), (foreign, x)):
            with pytest.raises(NotElementwise):
                operation(*pair)


@pytest.mark.parametrize("kind", ["lanes", "traced", "recording"])
def test_operands_of_two_computations_are_not_mixed(kind: str) -> None:
    with pytest.raises(NotElementwise):
        KINDS[kind]("x") + KINDS[kind]("y")


def test_an_operation_that_an_arithmetic_lacks_is_refused() -> None:
    with pytest.raises(NotElementwise):
        Recorder().input("x") ** 2
    with pytest.raises(NotElementwise):
        abs(LinearForm.of(Name("x")))
    with pytest.raises(NotElementwise):
        2.0 ** LinearForm.of(Name("x"))
