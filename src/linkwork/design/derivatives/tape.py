"""The derivatives of functions of NumPy: from the value and the arguments, dz = a dx + b conj(dx).

Where a function has a corner or no value, its derivative is NaN.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial, partialmethod, reduce
from math import isfinite
from typing import Any, NoReturn, cast

import numpy as np

from linkwork.core.expression.values import least, most
from linkwork.core.foundation.arrays import RANK_TOLERANCE, AnyArray, Array, BoolArray
from linkwork.core.foundation.lanes import (
    Consensus,
    Lanes,
    NotElementwise,
    Truths,
    remainders,
    with_parts,
)

#: a and b for one argument; ``None`` if b is 0.
Partial = tuple[Any, Any]
#: Of the value and the arguments; ``None`` for an argument whose derivatives do not count.
Rule = Callable[..., Sequence[Partial | None]]

_NOTHING: Partial = (0.0, None)


def _constant(*_: Any) -> Sequence[Partial | None]:
    return (_NOTHING,)


def carried(value: Any, _number: Any) -> Any:
    """A value that keeps the derivatives of a number."""
    return np.atleast_1d(value)


def _power(z: Any, x: Any, y: Any) -> Sequence[Partial | None]:
    # x to the power 0 is constant, also at 0
    base = y * np.power(x, np.where(np.equal(y, 0), 1.0, y - 1.0))
    positive = np.where(np.real(x) > 0.0, x, np.nan)
    return (base, None), (z * np.log(positive), None)


def _modulus(z: Any, x: Any) -> Sequence[Partial | None]:
    if not np.iscomplexobj(x):
        return ((np.where(np.equal(x, 0.0), np.nan, np.sign(x)), None),)
    unit = x / np.where(z == 0.0, np.nan, z)
    return ((0.5 * np.conj(unit), 0.5 * unit),)


def one_sided(z: Any, x: Any) -> Sequence[Partial | None]:
    """|x| with the derivative 1 at 0, where a sign of 1 belongs to it."""
    if np.iscomplexobj(x):
        return _modulus(z, x)
    return ((np.copysign(1.0, x), None),)


def _direction(_: Any, x: Any) -> Sequence[Partial | None]:
    # d arg x = Im(dx / x)
    a = -0.5j / np.where(np.equal(x, 0.0), np.nan, x)
    return ((a, np.conj(a)),)


def _hypot(z: Any, x: Any, y: Any) -> Sequence[Partial | None]:
    size = np.where(z == 0.0, np.nan, z)
    return (x / size, None), (y / size, None)


def _arctan2(_: Any, y: Any, x: Any) -> Sequence[Partial | None]:
    square = x * x + y * y
    return (x / square, None), (-y / square, None)


def _where(_: Any, mask: Any, x: Any, y: Any) -> Sequence[Partial | None]:
    taken = np.asarray(mask, dtype=bool)
    return _NOTHING, (np.where(taken, 1.0, 0.0), None), (np.where(taken, 0.0, 1.0), None)


def _chosen(z: Any, x: Any, y: Any) -> Sequence[Partial | None]:
    first, second = np.equal(z, x), np.equal(z, y)
    # of two equal numbers either may be the larger one after a change
    tie = np.where(first & second, np.nan, 1.0)
    return (np.where(first, tie, 0.0), None), (np.where(second, tie, 0.0), None)


def _copysign(_: Any, x: Any, sign: Any) -> Sequence[Partial | None]:
    return (np.copysign(1.0, sign) * np.sign(x), None), _NOTHING


def _remainder(z: Any, x: Any, period: Any) -> Sequence[Partial | None]:
    return (1.0, None), (-np.round((x - z) / period), None)


RULES: dict[Callable[..., Any], Rule] = {
    np.add: lambda z, x, y: ((1.0, None), (1.0, None)),
    np.subtract: lambda z, x, y: ((1.0, None), (-1.0, None)),
    np.multiply: lambda z, x, y: ((y, None), (x, None)),
    np.true_divide: lambda z, x, y: ((1.0 / np.asarray(y), None), (-z / y, None)),
    np.power: _power,
    np.negative: lambda z, x: ((-1.0, None),),
    np.square: lambda z, x: ((2.0 * x, None),),
    np.reciprocal: lambda z, x: ((-z * z, None),),
    np.abs: _modulus,
    np.fabs: _modulus,
    np.angle: _direction,
    np.real: lambda z, x: ((0.5, 0.5),),
    np.imag: lambda z, x: ((-0.5j, 0.5j),),
    np.conjugate: lambda z, x: ((0.0, 1.0),),
    with_parts: lambda z, x, y: ((1.0, None), (1j, None)),
    np.exp: lambda z, x: ((z, None),),
    np.log: lambda z, x: ((1.0 / x, None),),
    np.log10: lambda z, x: ((1.0 / (x * np.log(10.0)), None),),
    np.sqrt: lambda z, x: ((0.5 / z, None),),
    np.sin: lambda z, x: ((np.cos(x), None),),
    np.cos: lambda z, x: ((-np.sin(x), None),),
    np.tan: lambda z, x: ((1.0 + z * z, None),),
    np.arcsin: lambda z, x: ((1.0 / np.sqrt(1.0 - x * x), None),),
    np.arccos: lambda z, x: ((-1.0 / np.sqrt(1.0 - x * x), None),),
    np.arctan: lambda z, x: ((1.0 / (1.0 + x * x), None),),
    np.arctan2: _arctan2,
    np.hypot: _hypot,
    np.where: _where,
    np.fmax: _chosen,
    np.fmin: _chosen,
    np.maximum: _chosen,
    np.minimum: _chosen,
    np.copysign: _copysign,
    np.unwrap: lambda z, x: ((1.0, None),),
    np.nan_to_num: lambda z, x: ((np.where(np.isfinite(x), 1.0, 0.0), None),),
    remainders: _remainder,
    carried: lambda z, x, y: (None, (1.0, None)),
    **dict.fromkeys((np.sign, np.rint, np.round, np.floor, np.ceil), _constant),
}

#: Questions about each row.
QUESTIONS: frozenset[Callable[..., Any]] = frozenset(
    {
        np.isfinite, np.isnan, np.logical_and, np.logical_or,
        np.equal, np.not_equal, np.less, np.less_equal, np.greater, np.greater_equal,
    }
)  # fmt: skip

#: Questions, and sizes that serve as tolerances.
PLAIN: frozenset[Callable[..., Any]] = QUESTIONS | frozenset(
    {
        np.any, np.all, np.zeros_like, np.ones_like, np.iscomplexobj, np.nanmax, np.max, np.ndim,
    }
)  # fmt: skip


# ----------------------------------------------------------------------
# Numbers that remember how they were computed, so that a result has exact derivatives.
#
# The equations of a mechanism and its quantities are written for floats and arrays. A taped number
# passes through the same code and records every operation with its local derivatives. The record
# then gives the derivatives of all results by one number (forward), or of one result by all numbers
# (backward, the adjoint), at the cost of a few evaluations.
#
# A complex number depends on others by dz = a dx + b conj(dx), so that conjugates, moduli and
# directions of vectors need no separate treatment.
#
# References
# ----------
# A. Griewank, A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008, chapter 3.


_OF_TWO: dict[Callable[..., Any], Any] = {least: np.minimum, most: np.maximum}
_NEUTRAL: dict[object, float] = {np.add: 0.0, np.subtract: 0.0, np.multiply: 1.0}
_ZERO = np.zeros(())
_STEADY = 1e-9  # relative: a number whose derivatives are below is one that cannot vary


class Tape(Consensus):
    """An arithmetic that records.

    Shapes of values broadcast; an operation never adds rows up, so that every row keeps its
    derivatives.

    Parameters
    ----------
    count : int
        Rows whose equations are written together; several rows may have different numbers.
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
        """A number by which results are differentiated; (count,) if it differs from row to row."""
        number = self._node(np.atleast_1d(value), (), ())
        self.inputs.append(number.node)
        return cast(float, number)

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

    def stepped(self, values: Array, inverse: Array, rest: Sequence[Any]) -> list[Any]:
        """Values (B, n) less ``inverse`` (B, n, m) times m numbers that are 0: they have only
        derivatives.
        """
        return [
            self.combine(value, [(-row[:, i], x) for i, x in enumerate(rest)])
            for value, row in zip(values.T, inverse.swapaxes(0, 1), strict=True)
        ]

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
        operands = [self.operand(number) for number in numbers]
        neutral = _NEUTRAL.get(function)
        if neutral is not None:
            # rates of fixed points are plain zeros: they need no node of a sum or product
            for x, y in (operands, operands[::-1])[: 1 if function is np.subtract else 2]:
                if _is_plain(y, neutral):
                    return x
                if function is np.multiply and _is_plain(y, 0.0):
                    return _ZERO
        if function in _OF_TWO:
            return reduce(partial(self.apply, _OF_TWO[function]), operands)
        return self.computed(function, operands)

    def bare(self, number: Any) -> Any:
        """The values of an operand."""
        return number.values if isinstance(number, _HELD) else number

    def computed(self, function: Callable[..., Any], operands: Sequence[Any]) -> Any:
        """The value of a function of operands."""
        bare = [*map(self.bare, operands)]
        if function in PLAIN:
            return self.decidable(function(*bare))
        rule = one_sided if function is np.abs and self.writing else RULES.get(function)
        if rule is None:
            raise NotElementwise
        values = np.asarray(function(*bare))
        taped = [isinstance(x, TapedNumber) for x in operands]
        if not any(taped):
            return values
        linked = [
            (x.node, rate)
            for x, rate, is_taped in zip(operands, rule(values, *bare), taped, strict=True)
            if is_taped and rate is not None
        ]
        return self._node(values, [node for node, _ in linked], [rate for _, rate in linked])

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
        self, results: Sequence[object], seeds: Mapping[int, AnyArray] | None = None
    ) -> list[AnyArray]:
        """The derivatives of results by all inputs, or by the parameters of ``seeds``, (P, …).

        ``seeds``: the derivatives of nodes by P parameters, (P, …) each, in the place of inputs.
        """
        units = np.eye(len(self.inputs))[:, :, None]
        rates: dict[int, AnyArray] = dict(
            zip(self.inputs, units, strict=True) if seeds is None else seeds
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
            adjoint = adjoints.get(node)
            # an input keeps its adjoint; other nodes drop theirs once it is passed on
            if adjoint is None or not self._parents[node]:
                continue
            for parent, (a, b) in zip(self._parents[node], self._partials[node], strict=True):
                # eq. (122): the transpose of eq. (121)
                part = _product(np.conj(a), adjoint)
                if b is not None:
                    part = part + _product(b, np.conj(adjoint))
                part = np.real(part) if self._real[parent] else part
                known = adjoints.get(parent)
                adjoints[parent] = part if known is None else known + part
            del adjoints[node]
        shape = np.shape(result.values)
        gradient = np.zeros((len(self.inputs), *shape))
        for k, node in enumerate(self.inputs):
            gradient[k] = adjoints.get(node, 0.0)
        return gradient

    def _needed(
        self, results: Sequence[int], uses: Mapping[int, Sequence[int]] | None = None
    ) -> list[int]:
        """The nodes on which results depend, or of which they make use, in order."""
        needed = bytearray(len(self._parents))
        for node in results:
            needed[node] = 1
        # parents come before their children
        for node in range(max(results, default=-1), -1, -1):
            if needed[node]:
                for parent in self._parents[node] if uses is None else uses.get(node, ()):
                    needed[parent] = 1
        return [node for node, used in enumerate(needed) if used]


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
        self, function: Callable[..., Any], types: object, arguments: Sequence[Any], named: object
    ) -> Any:
        if function is np.shape:
            return np.shape(self.values)
        if function is np.broadcast_to or function is np.atleast_1d:
            return arguments[0]  # operations broadcast by themselves
        return self.arithmetic.apply(function, *arguments)

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


# ----------------------------------------------------------------------
# Equations written once, and computed again for the numbers of other designs.
#
# A recorded tape keeps every operation of the builder and every decision that it takes for the
# mechanism as it is. Other designs follow the record; those in which a decision is another one have
# other equations. What the builder does with values that it reads is no operation on the record, so
# they cannot be read.


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
        """Truth values with a node on the tape."""
        return _RecordedTruths(truths, self, self._node(truths, (), ()).node)

    def computed(self, function: Callable[..., Any], operands: Sequence[Any]) -> Any:
        """The value of a function on the record."""
        result = super().computed(function, operands)
        constants = [x for x in operands if not isinstance(x, _RECORDED)]
        if len(constants) == len(operands):
            return result
        # arrays of constants may not fit to the number of designs
        if function not in _ELEMENTWISE or any(np.ndim(x) for x in constants):
            raise NotElementwise
        if not isinstance(result, _RECORDED):
            result = self._node(result, (), ())  # one of two constants
        self._steps[result.node] = function, operands
        self._uses[result.node] = [x.node for x in operands if isinstance(x, _RECORDED)]
        return result

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
        steady = super().is_steady(number)
        if steady and isinstance(number, _RecordedNumber):
            self._steady.append(number)
        return steady

    # Following

    def keep(self, numbers: Sequence[TapedNumber]) -> None:
        """End the record: keep the steps that lead to these numbers."""
        self._results = [*self._steady, *numbers]
        nodes = [number.node for number in self._results]
        rated = set(self._needed(nodes))
        needed = self._needed([*nodes, *(node for node, _ in self._decisions)], self._uses)
        self._plan = [(k, k in rated, self._steps[k]) for k in needed if k in self._steps]

    @np.errstate(all="ignore")
    def follow(self, x: Array) -> tuple[BoolArray, list[tuple[AnyArray, AnyArray]]]:
        """Which of D designs with inputs (P, D) follow the record in everything, (D,), and the kept
        numbers: values (D,), and derivatives by the inputs, (P, D).
        """
        tape = Tape(x.shape[1])
        tape.writing = True
        numbers: dict[int, Any] = dict(zip(self.inputs, map(tape.number, x), strict=True))
        for node, is_rated, (function, operands) in self._plan:
            parts = [numbers[x.node] if isinstance(x, _RECORDED) else x for x in operands]
            # steps of decisions alone need no derivatives
            numbers[node] = tape.computed(function, parts if is_rated else [*map(tape.bare, parts)])
        for node, answer in self._decisions:
            tape.agreeing &= tape.bare(numbers[node]) == answer
        results = [numbers[number.node] for number in self._results]
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
