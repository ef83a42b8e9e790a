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

from linkwork.export.workbook.linear_form import (
    LinearForm,
    call,
    cosine,
    product,
    quotient,
    sine,
)
from linkwork.expression.lane_functions import FUNCTIONS, least, most
from linkwork.expression.tree import Binary, Call, Node, Number
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import AnyArray
from linkwork.foundation.lanes import (
    Consensus,
    Lanes,
    NotElementwise,
    Truths,
    remainders,
    with_parts,
)

__all__ = ["Trace", "TracedNumber"]

Formula = Callable[..., "TracedNumber"]

_EQUAL_VALUES = 1e-15  # two formulas of one number may differ by this: a few roundings


class Trace(Consensus):
    """What the traced numbers of one mechanism have in common.

    Attributes
    ----------
    settled : set of Node
        Formulas that had to become plain numbers, as ratios of teeth.
    angles : dict
        Angles by which something was turned, by how they are written: form and value.
    """

    def __init__(self) -> None:
        super().__init__(1, widest=True)
        self.settled: set[Node] = set()
        self.angles: dict[Node, tuple[LinearForm, float]] = {}

    def number(self, value: float, form: LinearForm) -> float:
        """A real number with its formula."""
        return cast(float, TracedNumber(np.array([value]), self, form, LinearForm()))

    def pick(self, values: AnyArray) -> Any:
        """One of two plain numbers."""
        return self.number(values[0], LinearForm(float(values[0])))

    def lanes(self, values: AnyArray) -> float:
        """Refused: numbers of an array have lost their formulas."""
        raise NotElementwise


class TracedNumber(Lanes):
    """A number with the formulas ``re`` and ``im`` of its parts."""

    __slots__ = ("im", "re")
    consensus: Trace

    def __init__(self, values: AnyArray, consensus: Trace, re: LinearForm, im: LinearForm) -> None:
        super().__init__(values, consensus)
        self.re, self.im = re, im

    def like(self, values: AnyArray) -> Lanes:
        """Refused: values alone have no formula."""
        raise NotElementwise

    def _made(self, values: Any, re: LinearForm, im: LinearForm | None = None) -> TracedNumber:
        return TracedNumber(np.asarray(values), self.consensus, re, im or LinearForm())

    def _with(self, other: object) -> TracedNumber:
        """The other operand of an operation."""
        if isinstance(other, TracedNumber):
            return other
        if not isinstance(other, int | float | complex):
            raise NotElementwise
        z = complex(other)
        return self._made([other], LinearForm(z.real), LinearForm(z.imag))

    def apply(self, function: Callable[..., Any], *numbers: object) -> Lanes:
        """A function for which there is a formula."""
        if function is np.where:
            return self._chosen(*numbers)
        if function not in _FORMULAS:
            raise NotElementwise
        given = [self._with(number) for number in numbers]
        values = function(*(number.values for number in given))
        return _FORMULAS[function](self, values, *given)

    def _chosen(self, condition: object, yes: object, no: object) -> TracedNumber:
        """The number that holds by its value; where both are one, the one with a formula."""
        a, b = self._with(yes), self._with(no)
        taken, other = (a, b) if bool(cast(Truths, condition)) else (b, a)
        plain = taken.re.fixed and taken.im.fixed
        same = abs(complex(taken.values[0]) - complex(other.values[0])) <= _EQUAL_VALUES
        return other if plain and same else taken

    def uniform_value(self) -> Any:
        """The plain number, noted as such."""
        if not self.re.fixed:
            self.consensus.settled.add(self.re.node)
        return super().uniform_value()

    # Arithmetic

    def __add__(self, other: object) -> TracedNumber:
        own = self._with(other)
        return self._made(self.values + own.values, self.re + own.re, self.im + own.im)

    __radd__ = __add__

    def __neg__(self) -> TracedNumber:
        return self._made(-self.values, -self.re, -self.im)

    def __sub__(self, other: object) -> TracedNumber:
        return self + -self._with(other)

    def __rsub__(self, other: object) -> TracedNumber:
        return self._with(other) - self

    def __mul__(self, other: object) -> TracedNumber:
        a, b = self, self._with(other)
        return self._made(
            a.values * b.values,
            product(a.re, b.re) - product(a.im, b.im),
            product(a.re, b.im) + product(a.im, b.re),
        )

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> TracedNumber:
        a, b = self, self._with(other)
        if not b.im.zero:
            return a * b.conjugate() / (b * b.conjugate()).real
        return self._made(a.values / b.values, quotient(a.re, b.re), quotient(a.im, b.re))

    def __rtruediv__(self, other: object) -> TracedNumber:
        return self._with(other) / self

    def __pow__(self, other: object) -> TracedNumber:
        exponent = self._with(other)
        if not (self.im.zero and exponent.im.zero):
            raise NotElementwise
        if exponent.re == LinearForm(2.0):
            return self * self
        power = Binary("^", self.re.node, exponent.re.node)
        return self._made(self.values**exponent.values, LinearForm.of(power))

    def __rpow__(self, other: object) -> TracedNumber:
        return self._with(other) ** self

    def __abs__(self) -> TracedNumber:
        values = np.abs(self.values)
        if self.im.zero:
            return self._made(values, _positive(self.re, self.values.real))
        if self.re.zero:
            return self._made(values, _positive(self.im, self.values.imag))
        turned = _turned(self)
        return self._made(values, LinearForm(1.0) if turned else call("hypot", self.re, self.im))

    def __round__(self) -> TracedNumber:
        values = np.rint(self.values)
        return self._made(values, LinearForm(float(values[0])))

    def conjugate(self) -> TracedNumber:
        """The complex conjugate."""
        return self._made(self.values.conjugate(), self.re, -self.im)

    @property
    def real(self) -> TracedNumber:
        """The real part."""
        return self._made(self.values.real, self.re)

    @property
    def imag(self) -> TracedNumber:
        """The imaginary part."""
        return self._made(self.values.imag, self.im)


def _positive(form: LinearForm, value: AnyArray) -> LinearForm:
    """The size of a number that keeps its sign."""
    return -form if value[0] < 0.0 else form


def _turned(z: TracedNumber) -> Node | None:
    """The angle of cos x + i sin x."""
    match z.re.single, z.im.single:
        case (Call("cos", (x,)), 1.0), (Call("sin", (y,)), 1.0) if x == y:
            return x
    return None


# The formulas of functions: of the number that asks, the values, and the arguments


def _angle(asked: TracedNumber, values: AnyArray, z: TracedNumber) -> TracedNumber:
    """The direction of a vector; of one that was turned, the angle by which."""
    turned = asked.consensus.angles.get(_turned(z) or Number(0.0))
    if turned is not None:
        form, value = turned
        turns = round((float(values[0]) - value) / FULL_TURN)
        return asked._made(values, form + LinearForm(turns * FULL_TURN))
    if z.im.zero or (z.re.fixed and z.im.fixed):
        return asked._made(values, LinearForm(float(values[0])))
    return asked._made(values, call("atan2", z.im, z.re))


def _cosine(asked: TracedNumber, values: AnyArray, angle: TracedNumber) -> TracedNumber:
    asked.consensus.angles[angle.re.angle] = (angle.re, float(angle.values[0]))
    return asked._made(values, cosine(angle.re))


def _sine(asked: TracedNumber, values: AnyArray, angle: TracedNumber) -> TracedNumber:
    return asked._made(values, sine(angle.re))


def _tangent(asked: TracedNumber, values: AnyArray, angle: TracedNumber) -> TracedNumber:
    return asked._made(values, LinearForm.of(Call("tan", (angle.re.angle,))))


def _vector(
    asked: TracedNumber, values: AnyArray, x: TracedNumber, y: TracedNumber
) -> TracedNumber:
    return asked._made(values, x.re, y.re)


def _root(asked: TracedNumber, values: AnyArray, x: TracedNumber) -> TracedNumber:
    if x.re.fixed:
        return asked._made(values, LinearForm(float(values[0])))
    return asked._made(values, call("sqrt", x.re))


def _signed(asked: TracedNumber, values: AnyArray, *_: TracedNumber) -> TracedNumber:
    return asked._made(values, LinearForm(float(values[0])))


def _reduced(asked: TracedNumber, values: AnyArray, x: TracedNumber, *_: object) -> TracedNumber:
    return asked._made(values, x.re + LinearForm(float(values[0] - x.values[0])))


def _size(asked: TracedNumber, values: AnyArray, x: TracedNumber) -> TracedNumber:
    return abs(x)


def _called(name: str) -> Formula:
    """A function that has the same name in formulas."""

    def made(asked: TracedNumber, values: AnyArray, *arguments: TracedNumber) -> TracedNumber:
        if not all(argument.im.zero for argument in arguments):
            raise NotElementwise
        if all(argument.re.fixed for argument in arguments):
            return asked._made(values, LinearForm(float(values[0])))
        return asked._made(values, call(name, *(argument.re for argument in arguments)))

    return made


_FORMULAS: dict[Callable[..., Any], Formula] = {
    np.angle: _angle, np.cos: _cosine, np.sin: _sine, np.tan: _tangent, with_parts: _vector,
    np.sqrt: _root, np.copysign: _signed, remainders: _reduced, np.abs: _size,
    np.hypot: _called("hypot"), np.exp: _called("exp"), np.fmax: _called("max"),
    np.fmin: _called("min"), most: _called("max"), least: _called("min"),
    **{FUNCTIONS[name]: _called(name) for name in ("ln", "log10", "asin", "acos", "atan", "atan2")},
}  # fmt: skip
