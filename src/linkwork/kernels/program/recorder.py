"""Recording arithmetic, for any interpreter or compiler."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from linkwork.foundation.operand import Arithmetic, Operand
from linkwork.kernels.program.program import Op

__all__ = ["Recorder", "Value"]

_SYMMETRIC = frozenset({Op.ADD, Op.MUL, Op.MAX, Op.MIN, Op.AND})


class Value(Operand):
    """A number in the making; arithmetic with it is recorded under its ``number``."""

    __slots__ = ("arithmetic", "number")
    arithmetic: Recorder

    def __init__(self, recorder: Recorder, number: int) -> None:
        self.arithmetic = recorder
        self.number = number


_Key = tuple[Op, tuple[int, ...], object]


class Recorder(Arithmetic[Value]):
    """Records arithmetic on values; equal computations are done once, zeros and ones not at all."""

    def __init__(self) -> None:
        self.ops: list[Op] = []
        self.arguments: list[tuple[int, ...]] = []
        self.payload: list[object] = []  # the name of an input, the value of a constant
        self.writes: dict[str, int] = {}
        self._known: dict[_Key, int] = {}

    def plain(self, number: float) -> Any:
        """A number as it is: it is recorded only where an operation keeps it."""
        return number

    def _new(self, op: Op, *arguments: int, payload: object = None) -> Value:
        if op in _SYMMETRIC:
            arguments = tuple(sorted(arguments))
        key: _Key = (op, arguments, payload)
        number = self._known.get(key)
        if number is None:
            number = len(self.ops)
            self._known[key] = number
            self.ops.append(op)
            self.arguments.append(arguments)
            self.payload.append(payload)
        return Value(self, number)

    def input(self, name: str) -> Value:
        """The value of a named register before the program ran."""
        return self._new(Op.INPUT, payload=name)

    def constant(self, value: float) -> Value:
        """The same number in every lane."""
        number = float(value)
        return self._new(Op.CONSTANT, payload=number if number == number else math.nan)

    def write(self, name: str, value: Value | float) -> None:
        """Leave a value in a named register when the program has run."""
        self.writes[name] = self._value(value).number

    def _value(self, x: Value | float) -> Value:
        return x if isinstance(x, Value) else self.constant(x)

    def known_value(self, x: Value | float) -> float | None:
        """The value of a constant, ``None`` for anything else."""
        if not isinstance(x, Value):
            return float(x)
        held = self.payload[x.number]
        return held if self.ops[x.number] is Op.CONSTANT and isinstance(held, float) else None

    def is_zero(self, x: Value | float) -> bool:
        """Whether a number is the constant 0."""
        return self.known_value(x) == 0.0

    def _negated(self, x: Value) -> Value | None:
        """y for x = -y."""
        if self.ops[x.number] is not Op.NEG:
            return None
        return Value(self, self.arguments[x.number][0])

    def add(self, x: Value | float, y: Value | float) -> Value:
        """x + y."""
        a, b = self.known_value(x), self.known_value(y)
        if a is not None and b is not None:
            return self.constant(a + b)
        if a == 0.0:
            return self._value(y)
        if b == 0.0:
            return self._value(x)
        x, y = self._value(x), self._value(y)
        minus_y, minus_x = self._negated(y), self._negated(x)
        if minus_y is not None:
            return self.subtract(x, minus_y)
        if minus_x is not None:
            return self.subtract(y, minus_x)
        return self._new(Op.ADD, x.number, y.number)

    def subtract(self, x: Value | float, y: Value | float) -> Value:
        """x - y."""
        a, b = self.known_value(x), self.known_value(y)
        if a is not None and b is not None:
            return self.constant(a - b)
        if b == 0.0:
            return self._value(x)
        if a == 0.0:
            return self.negate(y)
        x, y = self._value(x), self._value(y)
        minus_y = self._negated(y)
        if minus_y is not None:
            return self.add(x, minus_y)
        return self._new(Op.SUB, x.number, y.number)

    def multiply(self, x: Value | float, y: Value | float) -> Value:
        """x y; signs move outwards."""
        a, b = self.known_value(x), self.known_value(y)
        if a is not None and b is not None:
            return self.constant(a * b)
        for factor, other in ((a, y), (b, x)):
            if factor == 0.0:
                return self.constant(0.0)
            if factor == 1.0:
                return self._value(other)
            if factor == -1.0:
                return self.negate(other)
        x, y = self._value(x), self._value(y)
        minus_x, minus_y = self._negated(x), self._negated(y)
        if minus_x is not None or minus_y is not None:
            product = self.multiply(minus_x or x, minus_y or y)
            return product if minus_x is not None and minus_y is not None else -product
        return self._new(Op.MUL, x.number, y.number)

    def divide(self, x: Value | float, y: Value | float) -> Value:
        """x / y."""
        a, b = self.known_value(x), self.known_value(y)
        if a is not None and b is not None:
            with np.errstate(all="ignore"):  # as in a lane: infinite, or not a number
                return self.constant(float(np.divide(a, b)))
        if b is not None and b and abs(np.frexp(b)[0]) == 0.5:  # exact for powers of two
            return self.multiply(x, 1.0 / b)
        if a == 0.0:
            return self.constant(0.0)
        return self._new(Op.DIV, self._value(x).number, self._value(y).number)

    def negate(self, x: Value | float) -> Value:
        """-x."""
        a = self.known_value(x)
        if a is not None:
            return self.constant(-a)
        x = self._value(x)
        inner = self._negated(x)
        return inner if inner is not None else self._new(Op.NEG, x.number)

    def absolute(self, x: Value | float) -> Value:
        """|x|."""
        a = self.known_value(x)
        if a is not None:
            return self.constant(abs(a))
        x = self._negated(self._value(x)) or self._value(x)
        return x if self.ops[x.number] is Op.ABS else self._new(Op.ABS, x.number)

    def sqrt(self, x: Value) -> Value:
        """The square root."""
        return self._new(Op.SQRT, x.number)

    def largest(self, values: Iterable[Value | float]) -> Value:
        """The largest of some values; not a number if one of them is not."""
        return self._fold_pairs(Op.MAX, values)

    def smallest(self, values: Iterable[Value | float]) -> Value:
        """The smallest of some values; not a number if one of them is not."""
        return self._fold_pairs(Op.MIN, values)

    def all_of(self, masks: Iterable[Value]) -> Value:
        """Where all masks are true."""
        return self._fold_pairs(Op.AND, masks)

    def _fold_pairs(self, op: Op, values: Iterable[Value | float]) -> Value:
        first, *rest = [self._value(x) for x in values]
        for x in rest:
            if x.number != first.number:
                first = self._new(op, first.number, x.number)
        return first

    def sin_cos(self, x: Value) -> tuple[Value, Value]:
        """Sine and cosine of an angle [rad]."""
        sine = self._new(Op.SIN, x.number)
        return sine, self._new(Op.COS, sine.number)

    def direction(self, y: Value | float, x: Value | float) -> Value:
        """The angle of (x, y), in printed programs only."""
        return self._new(Op.ATAN2, self._value(y).number, self._value(x).number)

    def at_most(self, x: Value | float, y: Value | float) -> Value:
        """Where x <= y; false where one is not a number."""
        return self._new(Op.LE, self._value(x).number, self._value(y).number)

    def where(self, mask: Value, x: Value | float, y: Value | float) -> Value:
        """x where the mask is true, else y."""
        x, y = self._value(x), self._value(y)
        if x.number == y.number:
            return x
        return self._new(Op.WHERE, mask.number, x.number, y.number)

    def total(self, values: Sequence[Value | float]) -> Value:
        """The sum of some values."""
        result: Value = self.constant(0.0)
        for value in values:
            result = self.add(result, value)
        return result
