"""Numbers that remember how they were computed, so that a result has exact derivatives.

The equations of a mechanism and its quantities are written for floats and arrays. A taped number
passes through the same code and records every operation with its local derivatives. The record then
gives the derivatives of all results by one number (forward), or of one result by all numbers
(backward, the adjoint), at the cost of a few evaluations.

A complex number depends on others by dz = a dx + b conj(dx), so that conjugates, moduli and
directions of vectors need no separate treatment.

References
----------
A. Griewank, A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, chapter 3.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial, reduce
from math import isfinite
from typing import Any, cast

import numpy as np

from linkwork.design.derivatives.derivative_rules import PLAIN, RULES, Partial, carried, one_sided
from linkwork.expression.lane_functions import least, most
from linkwork.foundation.arrays import AnyArray, Array, BoolArray
from linkwork.foundation.lanes import Consensus, Lanes, Truths
from linkwork.foundation.operand import NotElementwise
from linkwork.foundation.rounding import RANK_TOLERANCE

__all__ = ["Tape", "TapedNumber", "is_still"]

_OF_TWO: dict[Callable[..., Any], Any] = {least: np.minimum, most: np.maximum}
_NEUTRAL: dict[object, float] = {np.add: 0.0, np.subtract: 0.0, np.multiply: 1.0}
_ZERO = np.zeros(())
_STEADY = 1e-9  # relative: a number whose derivatives are below is one that cannot vary


class Tape(Consensus):
    """An arithmetic that records.

    Shapes of values broadcast; an operation never adds rows up, so that every row keeps derivatives
    of its own.

    Parameters
    ----------
    count : int
        Rows whose equations are written together; more than one have numbers of their own.
    """

    def __init__(self, count: int = 1) -> None:
        super().__init__(count, widest=True)
        self._parents: list[tuple[int, ...]] = []
        self._partials: list[tuple[Partial, ...]] = []
        self._real: list[bool] = []
        self.inputs: list[int] = []
        #: Whether equations are being written, in which |x| only serves to show x without a sign.
        self.writing = False

    def number(self, value: float | Array) -> float:
        """A number by which results are differentiated; (count,) if rows have their own."""
        found = self._node(np.atleast_1d(value), (), ())
        self.inputs.append(found.node)
        return cast(float, found)

    def _node(
        self, values: AnyArray, parents: Sequence[int], partials: Sequence[Partial]
    ) -> TapedNumber:
        self._parents.append(tuple(parents))
        self._partials.append(tuple(partials))
        self._real.append(not np.iscomplexobj(values))
        return TapedNumber(values, self, len(self._parents) - 1)

    def combine(self, values: AnyArray, terms: Sequence[tuple[Any, Any]]) -> Any:
        """Values whose derivatives are the sum of factors times those of other numbers.

        Parameters
        ----------
        terms : sequence of (factor, number)
            Numbers that are not taped add nothing.
        """
        taped = [(factor, x) for factor, x in terms if isinstance(x, TapedNumber)]
        if not taped:
            return values
        # one node for a whole sum keeps the tape short
        nodes = [x.node for _, x in taped]
        return self._node(np.asarray(values), nodes, [(factor, None) for factor, _ in taped])

    def decidable(self, truths: AnyArray) -> Any:
        """Truths that rows agree on while their equations are written."""
        together = self.writing and not self.is_shared and truths.dtype == bool
        return Truths(truths, self) if together else truths

    # Arithmetic

    def operand(self, number: object) -> Any:
        """A taped number, truths, or a constant: a plain number or an array."""
        if isinstance(number, TapedNumber) and number.arithmetic is not self:
            raise NotElementwise
        # NumPy broadcasts constants by itself
        return number

    def plain(self, number: Any) -> Any:
        """A constant."""
        return number

    def lanes(self, values: AnyArray) -> float:
        """A constant (1,)."""
        return cast(float, values[0].item())

    def carry(self, value: Any, number: Any) -> Any:
        """A value with the derivatives of a number."""
        return self.apply(carried, value, number)

    def chain(self, value: Any, slope: Any, number: Any) -> Any:
        """A function's value at a number, which has this slope there."""
        return self.combine(value, [(slope, number)])

    def pick(self, truths: Truths, yes: complex, no: complex) -> Any:
        """One of two plain numbers."""
        if self.is_shared:
            return yes if truths.values[0] else no
        return self.apply(np.where, truths, yes, no)

    # A number that must not vary may still be written with numbers that do: 2 f / f

    def settle(self, number: TapedNumber) -> Any:
        """A number that must not vary, such as the ratio of wheels."""
        if not self.is_steady(number):
            raise NotElementwise
        return self.value_in(number, 0)

    def value_in(self, number: TapedNumber, lane: int) -> Any:
        """The value of a number in one lane."""
        return self.bare(number)[lane].item()

    def value_of(self, number: Any) -> Any:
        """The value of a number."""
        if not self.is_shared:
            raise NotElementwise
        return number.values[0].item()

    @property
    def is_shared(self) -> bool:
        """Whether all rows have the same numbers."""
        return len(self.agreeing) == 1

    def detached(self, number: Any) -> Any:
        """The value of a number, a constant."""
        return self.value_of(number) if isinstance(number, TapedNumber) else number

    def is_steady(self, number: Any) -> bool:
        """Whether no input changes a number."""
        if not isinstance(number, TapedNumber):
            return True
        return bool(is_still(self.bare(number), self.forward([number])[0]).all())

    def solve_shortest(
        self, matrix: Sequence[Sequence[Any]], right: Sequence[Any]
    ) -> Sequence[Any] | None:
        """The solution for a right side with derivatives and a matrix without."""
        if not self.is_shared:
            raise NotElementwise
        a = np.array(matrix, dtype=float)
        b = np.array([self.detached(x) for x in right], dtype=float)
        if not (np.isfinite(a).all() and np.isfinite(b).all()):
            raise np.linalg.LinAlgError
        inverse = np.linalg.pinv(a, rcond=RANK_TOLERANCE)
        return [
            self.combine(np.array([row @ b]), list(zip(row, right, strict=True))) for row in inverse
        ]

    def of_numpy(self, function: Any, inputs: Sequence[Any]) -> Any:
        """A universal function of NumPy."""
        return self.apply(function, *inputs)

    def apply(self, function: Callable[..., Any], *numbers: object) -> Any:
        """A function of NumPy; those without derivatives give plain arrays."""
        given = [self.operand(number) for number in numbers]
        neutral = _NEUTRAL.get(function)
        if neutral is not None:
            # rates of what does not move are plain zeros: of a sum or product they need no node
            for x, y in (given, given[::-1])[: 1 if function is np.subtract else 2]:
                if _is_plain(y, neutral):
                    return x
                if function is np.multiply and _is_plain(y, 0.0):
                    return _ZERO
        if function in _OF_TWO:
            return reduce(partial(self.apply, _OF_TWO[function]), given)
        return self.computed(function, given)

    def bare(self, number: Any) -> Any:
        """The values of an operand."""
        return number.values if isinstance(number, _HELD) else number

    def computed(self, function: Callable[..., Any], given: Sequence[Any]) -> Any:
        """The value of a function of operands."""
        bare = [*map(self.bare, given)]
        if function in PLAIN:
            return self.decidable(function(*bare))
        rule = one_sided if function is np.abs and self.writing else RULES.get(function)
        if rule is None:
            raise NotElementwise
        values = np.asarray(function(*bare))
        taped = [isinstance(x, TapedNumber) for x in given]
        if not any(taped):
            return values
        linked = [
            (x.node, own)
            for x, own, is_taped in zip(given, rule(values, *bare), taped, strict=True)
            if is_taped and own is not None
        ]
        return self._node(values, [node for node, _ in linked], [own for _, own in linked])

    def add(self, x: Any, y: Any) -> Any:
        """x + y."""
        return self.apply(np.add, x, y)

    def subtract(self, x: Any, y: Any) -> Any:
        """x - y."""
        return self.apply(np.subtract, x, y)

    def multiply(self, x: Any, y: Any) -> Any:
        """x y."""
        return self.apply(np.multiply, x, y)

    def divide(self, x: Any, y: Any) -> Any:
        """x / y."""
        return self.apply(np.true_divide, x, y)

    def power(self, x: Any, y: Any) -> Any:
        """x to the power y."""
        return self.apply(np.power, x, y)

    def negate(self, x: Any) -> Any:
        """-x."""
        return self.apply(np.negative, x)

    def absolute(self, x: Any) -> Any:
        """|x|."""
        return self.apply(np.abs, x)

    # Derivatives

    @np.errstate(all="ignore")  # a derivative that does not exist is no number
    def forward(
        self, results: Sequence[object], given: Mapping[int, AnyArray] | None = None
    ) -> list[AnyArray]:
        """The derivatives of results by all inputs, or by the parameters of given ones, (P, …).

        ``given``: the derivatives of nodes by P parameters, (P, …) each, in the place of inputs.
        """
        units = np.eye(len(self.inputs))[:, :, None]
        rates: dict[int, AnyArray] = dict(
            zip(self.inputs, units, strict=True) if given is None else given
        )
        nothing = np.zeros((len(next(iter(rates.values()), ())), 1))
        for node in self._needed([x.node for x in results if isinstance(x, TapedNumber)]):
            if node not in rates:
                total: Any = 0.0
                for parent, (a, b) in zip(self._parents[node], self._partials[node], strict=True):
                    # eq. (121)
                    part = _product(a, rates[parent])
                    if b is not None:
                        part = part + _product(b, np.conj(rates[parent]))
                    total = total + part
                rates[node] = np.asarray(np.real(total) if self._real[node] else total)
        return [rates[x.node] if isinstance(x, TapedNumber) else nothing for x in results]

    @property
    def lacks_derivatives(self) -> bool:
        """Whether a number that inputs change has no derivative by them."""
        every = [TapedNumber(np.zeros(1), self, node) for node in range(len(self._parents))]
        return not all(np.isfinite(rates).all() for rates in self.forward(every))

    @np.errstate(all="ignore")
    def backward(self, result: object) -> Array:
        """The derivatives of one real result by all inputs, (P, …): the adjoint."""
        if not isinstance(result, TapedNumber):
            return np.zeros((len(self.inputs), 1))
        adjoints: dict[int, Any] = {result.node: np.ones(np.shape(result.values))}
        for node in reversed(self._needed([result.node])):
            own = adjoints.get(node)
            # an input keeps its adjoint; all others are given up once they are passed on
            if own is None or not self._parents[node]:
                continue
            for parent, (a, b) in zip(self._parents[node], self._partials[node], strict=True):
                # eq. (122): the transpose of eq. (121)
                part = _product(np.conj(a), own)
                if b is not None:
                    part = part + _product(b, np.conj(own))
                part = np.real(part) if self._real[parent] else part
                known = adjoints.get(parent)
                adjoints[parent] = part if known is None else known + part
            del adjoints[node]
        shape = np.shape(result.values)
        found = np.zeros((len(self.inputs), *shape))
        for k, node in enumerate(self.inputs):
            found[k] = adjoints.get(node, 0.0)
        return found

    def _needed(
        self, results: Sequence[int], uses: Mapping[int, Sequence[int]] | None = None
    ) -> list[int]:
        """The nodes on which results depend, or of which they make use, in order."""
        wanted = bytearray(len(self._parents))
        for node in results:
            wanted[node] = 1
        # parents come before their children
        for node in range(max(results, default=-1), -1, -1):
            if wanted[node]:
                for parent in self._parents[node] if uses is None else uses.get(node, ()):
                    wanted[parent] = 1
        return [node for node, used in enumerate(wanted) if used]


def is_still(values: AnyArray, rates: AnyArray) -> BoolArray:
    """Where no input changes a number with these values (n,) and derivatives (P, n)."""
    size = np.maximum(1.0, np.abs(values))
    return np.asarray((np.abs(rates) <= _STEADY * size).all(axis=0))


def _is_plain(x: Any, value: float) -> bool:
    """Whether something is this number, not taped."""
    return not isinstance(x, _HELD) and np.ndim(x) == 0 and x == value


def _product(factor: Any, rate: Any) -> Any:
    """A factor times a rate; without a rate 0, even where the factor does not exist."""
    if type(factor) is float and factor == 1.0:
        return rate
    product = factor * rate
    # squares say whether all are finite in half the time; where they overflow nothing is wrong
    if isfinite(np.vdot(factor, factor).real):
        return product
    return np.where(rate == 0.0, 0.0, product)


class TapedNumber(Lanes):
    """A number, or one number in many rows, on a tape."""

    __slots__ = ("node",)
    arithmetic: Tape
    __hash__ = object.__hash__  # type: ignore[assignment]  # lanes are no keys; these are

    def __init__(self, values: AnyArray, tape: Tape, node: int) -> None:
        super().__init__(values, tape)
        self.node = node

    def __array_function__(
        self, function: Callable[..., Any], types: object, given: Sequence[Any], named: object
    ) -> Any:
        if function is np.shape:
            return np.shape(self.values)
        if function is np.broadcast_to or function is np.atleast_1d:
            return given[0]  # operations broadcast by themselves
        return self.arithmetic.apply(function, *given)

    def conj(self) -> Any:
        """The complex conjugate."""
        return self.conjugate()

    def __len__(self) -> int:
        return len(self.values)

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the values."""
        return np.shape(self.values)

    def holds(self, question: Callable[..., Any], *others: object) -> Any:
        """The answer to a question: a plain array, or truths to be decided."""
        return self.arithmetic.apply(question, self, *others)

    def __bool__(self) -> bool:
        if self.arithmetic.is_shared:
            return bool(self.values[0] != 0.0)
        return bool(self != 0.0)


_HELD = (TapedNumber, Truths)
