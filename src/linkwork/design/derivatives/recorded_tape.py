"""Equations written once, and computed again for the numbers of other designs.

A recorded tape keeps every operation of the builder and every decision that it takes for the
mechanism as it is. Other designs follow the record; those in which a decision is another one have
other equations. What the builder does with values that it reads is no operation on the record, so
they cannot be read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partialmethod
from typing import Any, NoReturn

import numpy as np

from linkwork.design.derivatives.derivative_rules import QUESTIONS, RULES
from linkwork.design.derivatives.tape import Tape, TapedNumber, is_still
from linkwork.foundation.arrays import AnyArray, Array, BoolArray
from linkwork.foundation.lanes import Truths
from linkwork.foundation.operand import NotElementwise

__all__ = ["RecordedTape"]

_ELEMENTWISE = (QUESTIONS | RULES.keys()) - {np.unwrap}
_Step = tuple[Callable[..., Any], Sequence[Any]]


class RecordedTape(Tape):
    """A tape of one mechanism, the leader of the designs that follow.

    Raises
    ------
    NotElementwise
        Where the builder does anything but operations and decisions with its numbers.
    """

    def __init__(self) -> None:
        super().__init__(2)  # not shared: designs to come have other numbers
        self.writing = True
        #: How nodes that are no inputs are computed.
        self._steps: dict[int, _Step] = {}
        self._uses: dict[int, list[int]] = {}
        self._decisions: list[tuple[int, bool]] = []
        #: Numbers on which something depends because no input changes them.
        self._steady: list[TapedNumber] = []
        self._plan: list[tuple[int, bool, _Step]] = []
        self._results: list[TapedNumber] = []

    # Recording

    def bare(self, number: Any) -> Any:
        """The values of an operand."""
        return number.own if isinstance(number, _RECORDED) else number

    def _node(self, values: AnyArray, *links: Any) -> TapedNumber:
        return _RecordedNumber(values, self, super()._node(values, *links).node)

    def decidable(self, truths: AnyArray) -> Any:
        """Truths with a node of their own."""
        return _RecordedTruths(truths, self, self._node(truths, (), ()).node)

    def computed(self, function: Callable[..., Any], given: Sequence[Any]) -> Any:
        """The value of a function on the record."""
        found = super().computed(function, given)
        constants = [x for x in given if not isinstance(x, _RECORDED)]
        if len(constants) == len(given):
            return found
        # arrays of constants may not fit to the number of designs
        if function not in _ELEMENTWISE or any(np.ndim(x) for x in constants):
            raise NotElementwise
        if not isinstance(found, _RECORDED):
            found = self._node(found, (), ())  # one of two constants
        self._steps[found.node] = function, given
        self._uses[found.node] = [x.node for x in given if isinstance(x, _RECORDED)]
        return found

    def combine(self, values: AnyArray, terms: Sequence[tuple[Any, Any]]) -> NoReturn:
        """Not on the record: values that are computed elsewhere."""
        raise NotElementwise

    def decide(self, truths: Any) -> bool:
        """A decision by truths on the record."""
        if not isinstance(truths, _RecordedTruths):
            raise NotElementwise
        answer = bool(truths.own.item())
        self._decisions.append((truths.node, answer))
        return answer

    def is_steady(self, number: Any) -> bool:
        """Whether no input changes a number; designs that follow have to agree if it is so."""
        found = super().is_steady(number)
        if found and isinstance(number, _RecordedNumber):
            self._steady.append(number)
        return found

    # Following

    def keep(self, numbers: Sequence[TapedNumber]) -> None:
        """End the record of what leads to numbers."""
        self._results = [*self._steady, *numbers]
        nodes = [number.node for number in self._results]
        rated = set(self._needed(nodes))
        wanted = self._needed([*nodes, *(node for node, _ in self._decisions)], self._uses)
        self._plan = [(k, k in rated, self._steps[k]) for k in wanted if k in self._steps]

    @np.errstate(all="ignore")
    def follow(self, x: Array) -> tuple[BoolArray, list[tuple[AnyArray, AnyArray]]]:
        """Which of D designs with inputs (P, D) follow the record in everything, (D,), and the kept
        numbers: values (D,), and derivatives by the inputs, (P, D).
        """
        tape = Tape(x.shape[1])
        tape.writing = True
        found: dict[int, Any] = dict(zip(self.inputs, map(tape.number, x), strict=True))
        for node, is_rated, (function, given) in self._plan:
            own = [found[x.node] if isinstance(x, _RECORDED) else x for x in given]
            # what decides only needs no derivatives
            found[node] = tape.computed(function, own if is_rated else [*map(tape.bare, own)])
        for node, answer in self._decisions:
            tape.agreeing &= tape.bare(found[node]) == answer
        results = [found[number.node] for number in self._results]
        values, rates = [*map(tape.bare, results)], tape.forward(results)
        steady = len(self._steady)
        for value, rate in zip(values[:steady], rates[:steady], strict=True):
            tape.agreeing &= is_still(value, rate)
        kept = [
            (np.broadcast_to(value, x.shape[1]), np.broadcast_to(rate, x.shape))
            for value, rate in zip(values[steady:], rates[steady:], strict=True)
        ]
        return tape.agreeing, kept


class _Unread:
    """What is done with values that are read would not be on the record."""

    __slots__ = ()

    @property
    def values(self) -> NoReturn:
        raise NotElementwise


class _RecordedNumber(_Unread, TapedNumber):  # type: ignore[misc]  # no values
    """A number on a record."""

    __slots__ = ("own",)

    def __init__(self, values: AnyArray, record: RecordedTape, node: int) -> None:
        self.own, self.arithmetic, self.node = values, record, node


class _RecordedTruths(_Unread, Truths):  # type: ignore[misc]  # no values
    """Truths on a record."""

    __slots__ = ("node", "own")
    consensus: RecordedTape
    __hash__ = None

    def __init__(self, values: AnyArray, record: RecordedTape, node: int) -> None:
        self.own, self.consensus, self.node = values, record, node

    def __bool__(self) -> bool:
        return self.consensus.decide(self)

    def _with(self, other: object, function: Callable[..., Any]) -> Any:
        return self.consensus.apply(function, self, other)

    __and__ = __rand__ = partialmethod(_with, function=np.logical_and)
    __or__ = __ror__ = partialmethod(_with, function=np.logical_or)
    __eq__ = partialmethod(_with, function=np.equal)
    __ne__ = partialmethod(_with, function=np.not_equal)


_RECORDED = (_RecordedNumber, _RecordedTruths)
