"""Numbers that record their arithmetic as instructions."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any, TypeVar

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray, allocate_aligned
from linkwork.core.foundation.lanes import Arithmetic, Operand

# ----------------------------------------------------------------------
# Straight-line programs: lists of instructions over registers.
#
# A register holds one number for every lane. Some registers are named and stay between runs
# (variables, coefficients); constants have registers of their own; the rest are scratch. Programs
# are recorded (:mod:`recorder`), given their registers (:mod:`lowering`) and run
# (:mod:`interpreter`).


#: Roles that a node of a march takes in turn: the trial first, then the nodes behind it.
ROLES = 5
#: Instructions, (K, 5) uint32; see :class:`Program`.
Code = np.ndarray[tuple[int, int], np.dtype[np.uint32]]

_ProgramKey = TypeVar("_ProgramKey", str, float)


class Op(IntEnum):
    """Instructions over the registers a, b, c; masks are 1.0 and 0.0."""

    # The numbers stay: kernels that an earlier process has compiled know them.
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
    SIN = 13  # of a; the same instruction computes
    COS = 14  # the cosine of a, into the register that follows as b
    WHERE = 15  # b where a is a true mask, else c
    LE = 16  # a <= b as a mask
    AND = 17  # of two masks
    KEEP = 18  # b where a is a true mask, else the target's present value
    LESS = 19  # the target's present value less a
    INPUT = 20  # a named register; no instruction
    CONSTANT = 21  # no instruction
    # printed only, no kernel runs them:
    ATAN2 = 22  # the direction of (b, a)
    CALL = 23  # a function of a, by its name
    PART = 24  # one of the numbers that a call gives, by its place


_ONE = (Op.COPY, Op.NEG, Op.ABS, Op.SQRT, Op.SIN, Op.LESS, Op.CALL, Op.PART)
_THREE = (Op.FMA, Op.FMS, Op.FNMA, Op.WHERE)
#: How many of a, b, c an instruction reads.
SOURCES = {op: 1 if op in _ONE else 3 if op in _THREE else 2 for op in Op}


@dataclass
class Registers:
    """Where named values and constants live; shared by the programs of one mechanism.

    ``count``: how many there are so far, the scratch registers of every program follow.
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

    def _in(self, table: dict[_ProgramKey, int], key: _ProgramKey) -> int:
        found = table.get(key)
        if found is None:
            found = table[key] = self.count
            self.count += 1
        return found

    def all_of(self, names: Iterable[str]) -> IndexArray:
        """The registers of some names."""
        return np.array([self.of(name) for name in names], dtype=np.intp)

    def filled(self, height: int, lanes: int) -> Array:
        """A workspace (height, lanes) with the constants in their places."""
        space = allocate_aligned(height, lanes)
        space[:] = 0.0
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

    code: Code
    height: int


def registers_read(programs: Sequence[Program]) -> set[int]:
    """The registers that programs read before they write them."""
    read, written = set[int](), set[int]()
    for program in programs:
        for number, target, *sources in program.code.tolist():
            op = Op(number)
            count = SOURCES[op]
            read.update(set(sources[:count]) - written)
            if op in (Op.KEEP, Op.LESS):
                read.update({target} - written)
            written.update({target, sources[2]} if op is Op.SIN else {target})
    return read


# ----------------------------------------------------------------------
# Recording arithmetic, for any interpreter or compiler.


_SYMMETRIC = frozenset({Op.ADD, Op.MUL, Op.MAX, Op.MIN, Op.AND})


class Value(Operand):
    """A number in the making; arithmetic with it is recorded under its ``number``."""

    __slots__ = ("arithmetic", "number")
    arithmetic: Recorder

    def __init__(self, recorder: Recorder, number: int) -> None:
        self.arithmetic = recorder
        self.number = number


_RecorderKey = tuple[Op, tuple[int, ...], object]


class Recorder(Arithmetic[Value]):
    """Records arithmetic on values; equal computations are done once, zeros and ones not at all."""

    def __init__(self) -> None:
        self.ops: list[Op] = []
        self.arguments: list[tuple[int, ...]] = []
        self.payload: list[object] = []  # the name of an input, the value of a constant
        self.writes: dict[str, int] = {}
        self._known: dict[_RecorderKey, int] = {}

    def plain(self, number: float) -> Any:
        """A number as it is: it is recorded only where an operation keeps it."""
        return number

    def _new(self, op: Op, *arguments: int, payload: object = None) -> Value:
        if op in _SYMMETRIC:
            arguments = tuple(sorted(arguments))
        key: _RecorderKey = (op, arguments, payload)
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

    def call(self, function: str, x: Value | float, part: int) -> Value:
        """One of the numbers that a function gives at x, in printed functions only."""
        called = self._new(Op.CALL, self._value(x).number, payload=function)
        return self._new(Op.PART, called.number, payload=part)

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


# ----------------------------------------------------------------------
# Recording arithmetic of complex numbers, as that of their parts.


class ComplexValue(Operand):
    """A complex number in the making, with a real and an imaginary part."""

    __slots__ = ("arithmetic", "imaginary", "real")
    arithmetic: ComplexRecorder

    def __init__(self, arithmetic: ComplexRecorder, real: Any, imaginary: Any) -> None:
        self.arithmetic = arithmetic
        self.real: Value | float = real
        self.imaginary: Value | float = imaginary


class ComplexRecorder(Arithmetic[ComplexValue]):
    """Records arithmetic on complex values with a recorder of real ones."""

    def __init__(self, recorder: Recorder) -> None:
        self.parts = recorder

    def plain(self, number: Any) -> ComplexValue:
        """A number as it is."""
        given = complex(number)
        return ComplexValue(self, given.real, given.imag)

    def input(self, name: str) -> ComplexValue:
        """The value of two named registers before the program ran."""
        return ComplexValue(self, self.parts.input(f"{name}.re"), self.parts.input(f"{name}.im"))

    def real(self, name: str) -> ComplexValue:
        """The value of one named register, a real number."""
        return ComplexValue(self, self.parts.input(name), 0.0)

    def write(self, name: str, number: ComplexValue | complex) -> None:
        """Leave a number in two named registers when the program has run."""
        value = number if isinstance(number, ComplexValue) else self.plain(number)
        self.parts.write(f"{name}.re", value.real)
        self.parts.write(f"{name}.im", value.imaginary)

    def add(self, x: ComplexValue, y: ComplexValue) -> ComplexValue:
        """x + y."""
        rec = self.parts
        real, imaginary = rec.add(x.real, y.real), rec.add(x.imaginary, y.imaginary)
        return ComplexValue(self, real, imaginary)

    def subtract(self, x: ComplexValue, y: ComplexValue) -> ComplexValue:
        """x - y."""
        rec = self.parts
        real = rec.subtract(x.real, y.real)
        return ComplexValue(self, real, rec.subtract(x.imaginary, y.imaginary))

    def negate(self, x: ComplexValue) -> ComplexValue:
        """-x."""
        return ComplexValue(self, self.parts.negate(x.real), self.parts.negate(x.imaginary))

    def multiply(self, x: ComplexValue, y: ComplexValue) -> ComplexValue:
        """x y."""
        rec = self.parts
        a, b, c, d = x.real, x.imaginary, y.real, y.imaginary
        real = rec.subtract(rec.multiply(a, c), rec.multiply(b, d))
        return ComplexValue(self, real, rec.add(rec.multiply(a, d), rec.multiply(b, c)))

    def divide(self, x: ComplexValue, y: ComplexValue) -> ComplexValue:
        """x / y, for numbers far from overflow."""
        rec = self.parts
        a, b = y.real, y.imaginary
        size = rec.add(rec.multiply(a, a), rec.multiply(b, b))
        inverse = ComplexValue(self, rec.divide(a, size), rec.negate(rec.divide(b, size)))
        return self.multiply(x, inverse)


# ----------------------------------------------------------------------
# From a recording to a program: an order, registers, products and sums in one instruction.


@dataclass
class _Lowering:
    """Assigning registers: a scratch register is free again after its last use."""

    recorder: Recorder
    registers: Registers
    scratch_from: int

    def run(self) -> Program:
        rec = self.recorder
        live = self._find_needed()
        self.fused = self._fuse_products(live)
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
        """Writes to named registers that are left, in an order in which every source is read
        before it is overwritten; of a circle of sources one is copied first.
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

    def _find_needed(self) -> set[int]:
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

    def _fuse_products(self, live: set[int]) -> dict[int, tuple[Op, tuple[int, int, int]]]:
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
                    one, two = rec.arguments[product]
                    found[k] = (kind, (one, two, other))
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

        Only where no later instruction reads the register's old value.
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
        """Whether a value is the old value in some lanes, or the old value less a number."""
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


def lower_program(recorder: Recorder, registers: Registers, scratch_from: int) -> Program:
    """The program of recorded arithmetic, its scratch registers from a number on.

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


LANES = 64
