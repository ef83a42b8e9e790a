"""Straight-line programs: what is computed, before it is known by which machine.

A program is a list of instructions over registers; a register holds one number for every lane. Some
registers are named and stay between runs (variables, coefficients); constants have registers of
their own; the rest are scratch. One and the same program is run by the interpreter over lanes
(:mod:`machine`), or written out as a function.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["Op", "Program", "Recorder", "Registers", "Value", "lowered"]


class Op(IntEnum):
    """What an instruction does with the registers a, b, c; masks are 1.0 and 0.0."""

    COPY = 0  # a
    ADD = 1  # a + b
    SUB = 2  # a - b
    MUL = 3  # a b
    DIV = 4  # a / b
    FMA = 5  # a b + c
    FMS = 6  # a b - c
    FNMA = 7  # c - a b
    NEG = 8  # -a
    ABS = 9  # |a|
    MAX = 10  # the larger one; not a number if one of them is not
    MIN = 11
    SQRT = 12
    SIN = 13  # of a, and beside it
    COS = 14  # the cosine, in the register that follows as b
    WHERE = 15  # b where a is a true mask, else c
    LE = 16  # a <= b as a mask
    AND = 17  # of two masks
    KEEP = 18  # b where a is a true mask, else what the target holds
    LESS = 19  # what the target holds, less a
    INPUT = 20  # a named register; no instruction
    CONSTANT = 21  # no instruction


_SYMMETRIC = frozenset({Op.ADD, Op.MUL, Op.MAX, Op.MIN, Op.AND})


@dataclass(frozen=True, eq=False)
class Value:
    """A number in the making; arithmetic with it is recorded."""

    recorder: Recorder
    number: int

    def __add__(self, other: Value | float) -> Value:
        return self.recorder.add(self, other)

    def __radd__(self, other: float) -> Value:
        return self.recorder.add(self, other)

    def __sub__(self, other: Value | float) -> Value:
        return self.recorder.subtract(self, other)

    def __rsub__(self, other: float) -> Value:
        return self.recorder.subtract(other, self)

    def __mul__(self, other: Value | float) -> Value:
        return self.recorder.multiply(self, other)

    def __rmul__(self, other: float) -> Value:
        return self.recorder.multiply(self, other)

    def __truediv__(self, other: Value | float) -> Value:
        return self.recorder.divide(self, other)

    def __rtruediv__(self, other: float) -> Value:
        return self.recorder.divide(other, self)

    def __neg__(self) -> Value:
        return self.recorder.negate(self)

    def __abs__(self) -> Value:
        return self.recorder.absolute(self)


_Key = tuple[Op, tuple[int, ...], object]


class Recorder:
    """Records arithmetic on values; equal computations are done once, zeros and ones not at all."""

    def __init__(self) -> None:
        self.ops: list[Op] = []
        self.arguments: list[tuple[int, ...]] = []
        self.payload: list[object] = []  # the name of an input, the value of a constant
        self.writes: dict[str, int] = {}
        self._known: dict[_Key, int] = {}

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
        """What a named register held before the program ran."""
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

    def _number(self, x: Value | float) -> float | None:
        """The value of a constant, ``None`` for anything else."""
        if not isinstance(x, Value):
            return float(x)
        held = self.payload[x.number]
        return held if self.ops[x.number] is Op.CONSTANT and isinstance(held, float) else None

    def is_zero(self, x: Value | float) -> bool:
        """Whether something is the constant 0."""
        return self._number(x) == 0.0

    def _negated(self, x: Value) -> Value | None:
        """y for x = -y."""
        if self.ops[x.number] is not Op.NEG:
            return None
        return Value(self, self.arguments[x.number][0])

    def add(self, x: Value | float, y: Value | float) -> Value:
        """x + y."""
        a, b = self._number(x), self._number(y)
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
        a, b = self._number(x), self._number(y)
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
        a, b = self._number(x), self._number(y)
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
        a, b = self._number(x), self._number(y)
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
        a = self._number(x)
        if a is not None:
            return self.constant(-a)
        x = self._value(x)
        inner = self._negated(x)
        return inner if inner is not None else self._new(Op.NEG, x.number)

    def absolute(self, x: Value | float) -> Value:
        """|x|."""
        a = self._number(x)
        if a is not None:
            return self.constant(abs(a))
        x = self._negated(self._value(x)) or self._value(x)
        return x if self.ops[x.number] is Op.ABS else self._new(Op.ABS, x.number)

    def sqrt(self, x: Value) -> Value:
        """The square root."""
        return self._new(Op.SQRT, x.number)

    def largest(self, values: Iterable[Value | float]) -> Value:
        """The largest of some values; not a number if one of them is not."""
        return self._folded(Op.MAX, values)

    def smallest(self, values: Iterable[Value | float]) -> Value:
        """The smallest of some values; not a number if one of them is not."""
        return self._folded(Op.MIN, values)

    def all_of(self, masks: Iterable[Value]) -> Value:
        """Where all masks are true."""
        return self._folded(Op.AND, masks)

    def _folded(self, op: Op, values: Iterable[Value | float]) -> Value:
        first, *rest = [self._value(x) for x in values]
        for x in rest:
            if x.number != first.number:
                first = self._new(op, first.number, x.number)
        return first

    def sin_cos(self, x: Value) -> tuple[Value, Value]:
        """Sine and cosine of an angle [rad]."""
        sine = self._new(Op.SIN, x.number)
        return sine, self._new(Op.COS, sine.number)

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


@dataclass
class Registers:
    """Where named values and constants live; shared by the programs of one mechanism.

    ``count``: how many there are so far, scratch registers of every program behind.
    """

    named: dict[str, int] = field(default_factory=dict)
    constants: dict[float, int] = field(default_factory=dict)
    count: int = 0

    def of(self, name: str) -> int:
        """The register of a name, a new one if need be."""
        return self._in(self.named, name)

    def of_constant(self, value: float) -> int:
        """The register of a constant."""
        return self._in(self.constants, value)

    def _in(self, table: dict[str, int] | dict[float, int], key: str | float) -> int:
        found = table.get(key)  # type: ignore[arg-type]
        if found is None:
            found = table[key] = self.count  # type: ignore[index]
            self.count += 1
        return found

    def all_of(self, names: Iterable[str]) -> IndexArray:
        """The registers of some names."""
        return np.array([self.of(name) for name in names], dtype=np.intp)

    def filled(self, height: int, lanes: int) -> Array:
        """A workspace (height, lanes) with the constants in their places."""
        space = np.zeros((height, lanes))
        for value, register in self.constants.items():
            space[register] = value
        return space


@dataclass(frozen=True, kw_only=True, eq=False)
class Program:
    """Instructions over numbered registers.

    Parameters
    ----------
    code : (K, 5) uint32
        Operation, target, a, b, c; unused places repeat the target. A sine's c is the register
        its cosine goes to.
    height : int
        How many registers a workspace needs.
    """

    code: np.ndarray[tuple[int, int], np.dtype[np.uint32]]
    height: int


@dataclass
class _Lowering:
    """Assigning registers: a scratch register is free again after its last use."""

    recorder: Recorder
    registers: Registers
    scratch_from: int

    def run(self) -> Program:
        rec = self.recorder
        live = self._needed()
        self.fused = self._fused(live)
        order = [k for k in sorted(live) if self._is_computed(k)]
        self.last = self._last_uses(order)
        self.place: dict[int, int] = {}
        self.free: list[int] = []
        self.top = self.scratch_from
        target = self._direct_targets(order)
        code: list[tuple[int, int, int, int, int]] = []
        for position, k in enumerate(order):
            if rec.ops[k] is not Op.COS:  # which its sine has written
                code.append(self._instruction(k, target))
            self._release(k, position)
        code += self._copies()
        return Program(code=np.array(code, dtype=np.uint32).reshape(len(code), 5), height=self.top)

    def _copies(self) -> list[tuple[int, int, int, int, int]]:
        """What is left to be written to named registers, in an order in which all sources still
        hold what they held; where they go round in a circle, one is put aside.
        """
        left = {
            self.registers.of(name): self._register(value)
            for name, value in self.recorder.writes.items()
        }
        left = {there: here for there, here in left.items() if here != there}
        found: list[tuple[int, int, int, int, int]] = []
        while left:
            read = set(left.values())
            there = next((there for there in left if there not in read), None)
            if there is None:
                there = next(iter(left))
                aside, self.top = self.top, self.top + 1
                found.append((int(Op.COPY), aside, there, aside, aside))
                left = {to: aside if here == there else here for to, here in left.items()}
            here = left.pop(there)
            found.append((int(Op.COPY), there, here, there, there))
        return found

    def _needed(self) -> set[int]:
        rec, todo, found = self.recorder, list(self.recorder.writes.values()), set[int]()
        while todo:
            k = todo.pop()
            if k in found:
                continue
            found.add(k)
            todo += rec.arguments[k]
            if rec.ops[k] is Op.SIN:  # its cosine is computed with it
                cosine = rec._known.get((Op.COS, (k,), None))
                todo += [] if cosine is None else [cosine]
        return found

    def _fused(self, live: set[int]) -> dict[int, tuple[Op, tuple[int, int, int]]]:
        """Sums with a product that is used nowhere else, as one instruction."""
        rec = self.recorder
        uses = dict.fromkeys(live, 0)
        for k in live:
            for a in rec.arguments[k]:
                uses[a] += 1
        for k in rec.writes.values():
            uses[k] += 1
        found: dict[int, tuple[Op, tuple[int, int, int]]] = {}
        self.swallowed: set[int] = set()
        for k in sorted(live):
            if rec.ops[k] not in (Op.ADD, Op.SUB):
                continue
            a, b = rec.arguments[k]
            for product, other, op in ((b, a, Op.FNMA), (a, b, Op.FMS)):
                if rec.ops[product] is Op.MUL and uses[product] == 1:
                    kind = Op.FMA if rec.ops[k] is Op.ADD else op
                    found[k] = (kind, (*rec.arguments[product], other))  # type: ignore[assignment]
                    self.swallowed.add(product)
                    break
        return found

    def _is_computed(self, k: int) -> bool:
        return self.recorder.ops[k] not in (Op.INPUT, Op.CONSTANT) and k not in self.swallowed

    def _sources(self, k: int) -> tuple[int, ...]:
        return self.fused[k][1] if k in self.fused else self.recorder.arguments[k]

    def _last_uses(self, order: list[int]) -> dict[int, int]:
        last: dict[int, int] = {}
        for position, k in enumerate(order):
            last[k] = position
            for a in self._sources(k):
                last[a] = position
        for k in self.recorder.writes.values():
            last[k] = len(order)
        return last

    def _direct_targets(self, order: list[int]) -> dict[int, int]:
        """Values computed straight into the named register they are written to.

        Only where nobody reads what the register held before from then on.
        """
        rec = self.recorder
        position = {k: p for p, k in enumerate(order)}
        for k in order:
            if rec.ops[k] is Op.COS:
                position[k] = position[rec.arguments[k][0]]
        found: dict[int, int] = {}
        self.in_place: set[int] = set()
        for name, value in rec.writes.items():
            before = rec._known.get((Op.INPUT, (), name))
            still_read = -1 if before is None else self.last.get(before, -1)
            if value not in position or value in found:
                continue
            if still_read < position[value]:
                found[value] = self.registers.of(name)
            elif still_read == position[value] and self._changes(value, before):
                found[value] = self.registers.of(name)
                self.in_place.add(value)
        return found

    def _changes(self, value: int, old: int | None) -> bool:
        """Whether a value is the old one but for some lanes, or less something."""
        op, arguments = self.recorder.ops[value], self.recorder.arguments[value]
        if value in self.fused or arguments.count(old or -1) != 1:
            return False
        return (op is Op.WHERE and arguments[2] == old) or (op is Op.SUB and arguments[0] == old)

    def _register(self, k: int) -> int:
        rec = self.recorder
        if rec.ops[k] is Op.INPUT:
            return self.registers.of(_name(rec.payload[k]))
        if rec.ops[k] is Op.CONSTANT:
            return self.registers.of_constant(_constant(rec.payload[k]))
        return self.place[k]

    def _new_place(self, k: int, target: Mapping[int, int]) -> int:
        if k in target:
            place = target[k]
        elif self.free:
            place = self.free.pop()
        else:
            place = self.top
            self.top += 1
        self.place[k] = place
        return place

    def _instruction(self, k: int, target: Mapping[int, int]) -> tuple[int, int, int, int, int]:
        rec = self.recorder
        op, arguments = self.fused.get(k, (rec.ops[k], rec.arguments[k]))
        sources = [self._register(a) for a in arguments]
        place = self._new_place(k, target)
        if k in self.in_place:
            if op is Op.WHERE:
                return int(Op.KEEP), place, sources[0], sources[1], sources[1]
            return int(Op.LESS), place, sources[1], sources[1], sources[1]
        if op is Op.SIN:
            cosine = rec._known.get((Op.COS, (k,), None))
            if cosine is None:
                beside = self._new_place(-1 - k, {})
                self.free.append(beside)
            else:
                beside = self._new_place(cosine, target)
            return int(op), place, sources[0], place, beside
        sources += [place] * (3 - len(sources))
        return int(op), place, sources[0], sources[1], sources[2]

    def _release(self, k: int, position: int) -> None:
        for a in {k, *self._sources(k)}:
            place = self.place.get(a)
            if place is not None and place >= self.scratch_from and self.last[a] <= position:
                del self.place[a]
                self.free.append(place)


def lowered(recorder: Recorder, registers: Registers, scratch_from: int) -> Program:
    """The program of what was recorded, its scratch registers from a number on.

    Every name and constant it uses must have its register before (see :func:`reserve`).
    """
    return _Lowering(recorder, registers, scratch_from).run()


def reserve(recorder: Recorder, registers: Registers) -> None:
    """Give every name and constant of a recording its register."""
    for op, payload in zip(recorder.ops, recorder.payload, strict=True):
        if op is Op.INPUT:
            registers.of(_name(payload))
        elif op is Op.CONSTANT:
            registers.of_constant(_constant(payload))
    for name in recorder.writes:
        registers.of(name)


def _name(payload: object) -> str:
    assert isinstance(payload, str)
    return payload


def _constant(payload: object) -> float:
    assert isinstance(payload, float)
    return payload
