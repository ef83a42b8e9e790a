"""Values that are computed when they are first asked for."""

from __future__ import annotations

import pickle

import pytest

from linkwork.core.foundation.arrays import Deferred


def test_a_value_is_computed_once_and_only_when_it_is_asked_for() -> None:
    calls: list[int] = []

    def compute() -> int:
        calls.append(1)
        return 7

    late = Deferred(compute)
    assert not calls
    assert (late.value, late.value, len(calls)) == (7, 7, 1)


def test_a_copy_has_the_value_whatever_computes_it() -> None:
    number = 3
    late = Deferred(lambda: number + 4)
    assert pickle.loads(pickle.dumps(late)).value == 7


def test_a_failed_computation_is_tried_again() -> None:
    tries: list[int] = []

    def compute() -> float:
        tries.append(1)
        return 1.0 / (len(tries) - 1)

    late = Deferred(compute)
    with pytest.raises(ZeroDivisionError):
        assert late.value
    assert late.value == 1.0
