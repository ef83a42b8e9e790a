"""A number that records its formula while the equations are built from it.

The builder of a mechanism's equations computes with floats and complex numbers. A traced number
passes through it as :class:`~linkwork.foundation.lanes.Lanes` of one design do, and knows
afterwards by which formula it follows from the dimensions. Decisions are taken by its value: which
way round a link is, in which half turn an angle lies.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import numpy as np

from linkwork.export.formulas.linear_form import LinearForm, call, cosine, sine
from linkwork.expression.lane_functions import FUNCTIONS, least, most
from linkwork.expression.tree import Binary, Call, Node, Number
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import AnyArray
from linkwork.foundation.elementwise import remainders, with_parts
from linkwork.foundation.lanes import Consensus, Lanes, Truths
from linkwork.foundation.operand import NotElementwise

__all__ = ["Trace", "TracedNumber"]

Formula = Callable[..., "TracedNumber"]

_ZERO = LinearForm()
_EQUAL_VALUES = 1e-15  # two formulas of one number may differ by this: a few roundings


class Trace(Consensus):
    """What the traced numbers of one mechanism have in common.

    Attributes
    ----------
    settled : dict of Node
        Formulas that had to become plain numbers, as ratios of teeth.
    angles : dict
        Angles by which something was turned, by how they are written: form and value.
    """

    def __init__(self) -> None:
        super().__init__(1, widest=True)
        self.settled: dict[Node, None] = {}
        self.angles: dict[Node, tuple[LinearForm, float]] = {}

    def number(self, value: float, form: LinearForm) -> float:
        """A real number with its formula."""
        return cast(float, self.make([value], form))

    def make(self, values: Any, re: LinearForm, im: LinearForm = _ZERO) -> TracedNumber:
        """A number, values (1,), with the formulas of its parts."""
        return TracedNumber(np.asarray(values), self, re, im)

    def plain(self, number: complex) -> TracedNumber:
        """A plain number, which is its own formula."""
        z = complex(number)
        return self.make([number], LinearForm(z.real), LinearForm(z.imag))

    def pick(self, truths: Truths, yes: complex, no: complex) -> TracedNumber:
        """One of two plain numbers."""
        return self.plain(yes if truths.values[0] else no)

    def settle(self, number: TracedNumber) -> Any:
        """The plain number, noted as such."""
        if not number.re.fixed:
            self.settled[number.re.node] = None
        return super().settle(number)

    def value_of(self, number: TracedNumber) -> Any:
        """The number with its formula: what needs a plain one refuses it later."""
        return number

    def estimate(self, number: Any) -> Any:
        """The number without its formula."""
        return self.value_in(number, 0)

    def apply(self, function: Callable[..., Any], *numbers: object) -> TracedNumber:
        """A function for which there is a formula."""
        if function is np.where:
            return self._choose(*numbers)
        if function not in _FORMULAS:
            raise NotElementwise
        given = [self.operand(number) for number in numbers]
        values = function(*(number.values for number in given))
        return _FORMULAS[function](self, values, *given)

    def _choose(self, condition: object, yes: object, no: object) -> TracedNumber:
        """The number that holds by its value; where both are one, the one with a formula."""
        taken: TracedNumber = self.operand(yes)
        other: TracedNumber = self.operand(no)
        if not cast(Truths, condition):
            taken, other = other, taken
        plain = taken.re.fixed and taken.im.fixed
        same = abs(complex(taken.values[0]) - complex(other.values[0])) <= _EQUAL_VALUES
        return other if plain and same else taken

    def add(self, x: TracedNumber, y: TracedNumber) -> TracedNumber:
        """x + y."""
        return self.make(x.values + y.values, x.re + y.re, x.im + y.im)

    def negate(self, x: TracedNumber) -> TracedNumber:
        """-x."""
        return self.make(-x.values, -x.re, -x.im)

    def multiply(self, x: TracedNumber, y: TracedNumber) -> TracedNumber:
        """x y."""
        re, im = x.re * y.re - x.im * y.im, x.re * y.im + x.im * y.re
        return self.make(x.values * y.values, re, im)

    def divide(self, x: TracedNumber, y: TracedNumber) -> TracedNumber:
        """x / y."""
        if not y.im.zero:
            return x * y.conjugate() / (y * y.conjugate()).real
        return self.make(x.values / y.values, x.re / y.re, x.im / y.re)

    def power(self, x: TracedNumber, y: TracedNumber) -> TracedNumber:
        """x to the power y, both real."""
        if not (x.im.zero and y.im.zero):
            raise NotElementwise
        if y.re == LinearForm(2.0):
            return x * x
        power = Binary("^", x.re.node, y.re.node)
        return self.make(x.values**y.values, LinearForm.of(power))

    def absolute(self, x: TracedNumber) -> TracedNumber:
        """|x|."""
        return self.apply(np.abs, x)


class TracedNumber(Lanes):
    """A number with the formulas ``re`` and ``im`` of its parts."""

    __slots__ = ("im", "re")
    arithmetic: Trace

    def __init__(self, values: AnyArray, trace: Trace, re: LinearForm, im: LinearForm) -> None:
        super().__init__(values, trace)
        self.re, self.im = re, im


def _positive(form: LinearForm, value: AnyArray) -> LinearForm:
    """The size of a number that keeps its sign."""
    return -form if value[0] < 0.0 else form


def _turned(z: TracedNumber) -> Node | None:
    """The angle of cos x + i sin x."""
    match z.re.single, z.im.single:
        case (Call("cos", (x,)), 1.0), (Call("sin", (y,)), 1.0) if x == y:
            return x
    return None


# The formulas of functions: from the trace, the values, and the arguments


def _angle(trace: Trace, values: AnyArray, z: TracedNumber) -> TracedNumber:
    """The direction of a vector; of one that was turned, the angle by which."""
    turned = trace.angles.get(_turned(z) or Number(0.0))
    if turned is not None:
        form, value = turned
        turns = round((float(values[0]) - value) / FULL_TURN)
        return trace.make(values, form + LinearForm(turns * FULL_TURN))
    if z.im.zero or (z.re.fixed and z.im.fixed):
        return trace.make(values, LinearForm(float(values[0])))
    return trace.make(values, call("atan2", z.im, z.re))


def _cosine(trace: Trace, values: AnyArray, angle: TracedNumber) -> TracedNumber:
    trace.angles[angle.re.angle] = (angle.re, float(angle.values[0]))
    return trace.make(values, cosine(angle.re))


def _sine(trace: Trace, values: AnyArray, angle: TracedNumber) -> TracedNumber:
    return trace.make(values, sine(angle.re))


def _tangent(trace: Trace, values: AnyArray, angle: TracedNumber) -> TracedNumber:
    return trace.make(values, LinearForm.of(Call("tan", (angle.re.angle,))))


def _vector(trace: Trace, values: AnyArray, x: TracedNumber, y: TracedNumber) -> TracedNumber:
    return trace.make(values, x.re, y.re)


def _root(trace: Trace, values: AnyArray, x: TracedNumber) -> TracedNumber:
    if x.re.fixed:
        return trace.make(values, LinearForm(float(values[0])))
    return trace.make(values, call("sqrt", x.re))


def _signed(trace: Trace, values: AnyArray, *_: TracedNumber) -> TracedNumber:
    return trace.make(values, LinearForm(float(values[0])))


def _reduced(trace: Trace, values: AnyArray, x: TracedNumber, *_: object) -> TracedNumber:
    return trace.make(values, x.re + LinearForm(float(values[0] - x.values[0])))


def _size(trace: Trace, values: AnyArray, x: TracedNumber) -> TracedNumber:
    if x.im.zero:
        return trace.make(values, _positive(x.re, x.values.real))
    if x.re.zero:
        return trace.make(values, _positive(x.im, x.values.imag))
    return trace.make(values, LinearForm(1.0) if _turned(x) else call("hypot", x.re, x.im))


def _conjugate(trace: Trace, values: AnyArray, x: TracedNumber) -> TracedNumber:
    return trace.make(values, x.re, -x.im)


def _real(trace: Trace, values: AnyArray, x: TracedNumber) -> TracedNumber:
    return trace.make(values, x.re)


def _imaginary(trace: Trace, values: AnyArray, x: TracedNumber) -> TracedNumber:
    return trace.make(values, x.im)


def _called(name: str) -> Formula:
    """A function that has the same name in formulas."""

    def made(trace: Trace, values: AnyArray, *arguments: TracedNumber) -> TracedNumber:
        if not all(argument.im.zero for argument in arguments):
            raise NotElementwise
        if all(argument.re.fixed for argument in arguments):
            return trace.make(values, LinearForm(float(values[0])))
        return trace.make(values, call(name, *(argument.re for argument in arguments)))

    return made


_FORMULAS: dict[Callable[..., Any], Formula] = {
    np.angle: _angle, np.cos: _cosine, np.sin: _sine, np.tan: _tangent, with_parts: _vector,
    np.sqrt: _root, np.copysign: _signed, np.rint: _signed, remainders: _reduced, np.abs: _size,
    np.conjugate: _conjugate, np.real: _real, np.imag: _imaginary,
    np.hypot: _called("hypot"), np.exp: _called("exp"), np.fmax: _called("max"),
    np.fmin: _called("min"), most: _called("max"), least: _called("min"),
    **{FUNCTIONS[x]: _called(x) for x in ("abs", "ln", "log10", "asin", "acos", "atan", "atan2")},
}  # fmt: skip
