"""Numbers of about 32 digits, each the sum of two floats: for what is rounded once, at the end.

Coefficients of equations follow from the numbers of a file by formulas that may lose digits: the
height of a flat triangle, a difference of long sums. In this arithmetic (Dekker 1971,
doi:10.1007/BF01397083; Hida, Li, Bailey 2001, doi:10.1109/ARITH.2001.930115) the loss stays below
the rounding of a float. The two parts are floats, complex numbers, arrays or lanes; numbers of
other arithmetics (formulas of cells, tapes, programs) are computed without second part.
"""

from __future__ import annotations

import math
from functools import reduce
from typing import Any

import numpy as np

from linkwork.core.foundation.lanes import (
    Arithmetic,
    LaneArithmetic,
    Operand,
    choose,
    cis,
    finite,
    hypot,
    is_batched,
    phase as elementwise_phase,
    sqrt as elementwise_sqrt,
    vector,
)

_SPLITTER = 2.0**27 + 1.0
_NOTHING = 1e-30
_TERMS = 29  # of the series of sine and exponential, to 1e-33


def _has_rest(x: Any) -> bool:
    """Whether rounding errors of this number are numbers of the same kind."""
    return not is_batched(x) or isinstance(x.arithmetic, LaneArithmetic)


def _is_complex(x: Any) -> bool:
    if type(x) is float or type(x) is complex:
        return type(x) is complex
    return np.iscomplexobj(x.values if is_batched(x) else x)


def _sum(a: Any, b: Any) -> tuple[Any, Any]:
    """a + b and its rounding error."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def _halves(a: Any) -> tuple[Any, Any]:
    far = _SPLITTER * a
    high = far - (far - a)
    return high, a - high


def _product(a: Any, b: Any) -> tuple[Any, Any]:
    """a b and its rounding error."""
    product = a * b
    (a1, a2), (b1, b2) = _halves(a), _halves(b)
    return product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2


def _normal(high: Any, low: Any) -> Precise:
    total = high + low
    return Precise(total, low - (total - high))


class _PreciseArithmetic(Arithmetic["Precise"]):
    """Sums and products with their rounding errors."""

    def plain(self, number: Any) -> Precise:
        """A number without rounding error."""
        return Precise(number)

    def operand(self, number: object) -> Precise:
        """A precise number, or any other one."""
        return number if isinstance(number, Precise) else Precise(number)

    def add(self, x: Precise, y: Precise) -> Precise:
        """x + y."""
        if not (x.has_rest and y.has_rest):
            return Precise(x.high + y.high)
        high, error = _sum(x.high, y.high)
        low, least = _sum(x.low, y.low)
        both = _normal(high, error + low)
        return _normal(both.high, both.low + least)

    def multiply(self, x: Precise, y: Precise) -> Precise:
        """x y."""
        if not (x.has_rest and y.has_rest):
            return Precise(x.high * y.high)
        if not (x.is_complex or y.is_complex):
            high, error = _product(x.high, y.high)
            return _normal(high, error + (x.high * y.low + x.low * y.high))
        if not x.is_complex:
            return joined(x * y.real, x * y.imag)
        if not y.is_complex:
            return joined(x.real * y, x.imag * y)
        re, im = x.real * y.real - x.imag * y.imag, x.real * y.imag + x.imag * y.real
        return joined(re, im)

    def divide(self, x: Precise, y: Precise) -> Precise:
        """x / y."""
        if not (x.has_rest and y.has_rest):
            return Precise(x.high / y.high)
        if y.is_complex:
            return x * y.conjugate() / (y.real * y.real + y.imag * y.imag)
        if x.is_complex:
            return joined(x.real / y, x.imag / y)
        first = x.high / y.high
        return _normal(first, (x - y * first).high / y.high)

    def power(self, x: Precise, y: Precise) -> Precise:
        """x to the power y."""
        if isinstance(y.high, float) and y.high.is_integer() and not y.low and abs(y.high) <= 64.0:
            found = reduce(lambda total, _: total * x, range(abs(int(y.high))), Precise(1.0))
            return found if y.high >= 0.0 else Precise(1.0) / found
        return exp(y * log(x))

    def negate(self, x: Precise) -> Precise:
        """-x."""
        return Precise(-x.high, -x.low)

    def absolute(self, x: Precise) -> Precise:
        """|x|."""
        if not x.has_rest:
            return Precise(abs(x.high))
        if x.is_complex:
            return sqrt(x.real * x.real + x.imag * x.imag)
        return chosen(x.high < 0.0, -x, x)


class Precise(Operand):
    """``high`` + ``low``, real or complex; ``high`` is the number rounded to floats."""

    __slots__ = ("high", "low")
    arithmetic = _PreciseArithmetic()

    def __init__(self, high: Any, low: Any = 0.0) -> None:
        self.high, self.low = high, low

    @property
    def is_complex(self) -> bool:
        """Whether the number has an imaginary part."""
        return _is_complex(self.high)

    @property
    def has_rest(self) -> bool:
        """Whether ``low`` is known: not in arithmetics of formulas, tapes and programs."""
        return _has_rest(self.high)

    @property
    def real(self) -> Precise:
        """The real part."""
        return Precise(self.high.real, self.low.real)

    @property
    def imag(self) -> Precise:
        """The imaginary part."""
        return Precise(self.high.imag, self.low.imag)

    def part(self, which: slice) -> Precise:
        """Some numbers of arrays."""
        return Precise(self.high[which], self.low[which])

    def conjugate(self) -> Precise:
        """The complex conjugate."""
        return Precise(self.high.conjugate(), self.low.conjugate())


def precise(number: Any) -> Precise:
    """A precise number, or any other one."""
    return Precise.arithmetic.operand(number)


def joined(x: Precise, y: Precise) -> Precise:
    """x + iy."""
    high = vector(x.high, y.high)
    return Precise(high, vector(x.low, y.low) if _has_rest(high) else 0.0)


def chosen(condition: bool, yes: Precise, no: Precise) -> Precise:
    """``yes`` where the condition holds, else ``no``."""
    return Precise(
        *(_either(condition, *both) for both in ((yes.high, no.high), (yes.low, no.low)))
    )


def _either(condition: Any, yes: Any, no: Any) -> Any:
    pick = np.where if isinstance(condition, np.ndarray) and condition.size > 1 else choose
    return pick(condition, yes, no)


PI = Precise(math.pi, 1.2246467991473532e-16)
E = Precise(math.e, 1.4456468917292502e-16)
_LOG_2 = Precise(0.6931471805599453, 2.3190468138462996e-17)


def _corrected(value: Any, low: Any) -> Precise:
    """A value and what it lacks, where that is finite."""
    return Precise(value, _either(low - low == 0.0, low, 0.0))


def sqrt(x: Precise) -> Precise:
    """The square root."""
    if not x.has_rest:
        return Precise(elementwise_sqrt(x.high))
    root = np.sqrt(x.high) if isinstance(x.high, np.ndarray) else elementwise_sqrt(x.high)
    if not is_batched(root) and not isinstance(root, np.ndarray) and not root:
        return Precise(root)
    return _corrected(root, (x - _squared(root)).high / (2.0 * root))


def _squared(x: Any) -> Precise:
    return Precise(*_product(x, x))


def sin_cos(x: Precise) -> tuple[Precise, Precise]:
    """Sine and cosine of an angle of few turns [rad]."""
    if not _has_rest(x.high):
        unit = cis(x.high)
        return Precise(unit.imag), Precise(unit.real)
    quarters = round(x.high / (math.pi / 2.0))
    rest = x - PI * (0.5 * quarters)
    # a right angle is one: nothing is left but the error of π
    rest = chosen(abs(rest.high) < _NOTHING, Precise(0.0 * rest.high), rest)
    sine, cosine, term = Precise(0.0), Precise(1.0), Precise(1.0)
    for n in range(1, _TERMS if is_batched(rest.high) or rest.high else 1):
        term = term * rest / float(n)
        part = -term if n % 4 in (2, 3) else term
        sine, cosine = (sine + part, cosine) if n % 2 else (sine, cosine + part)
    way = quarters - 4 * round(quarters / 4)
    flip, odd = abs(way) == 2, abs(way) == 1
    s, c = chosen(flip, -sine, sine), chosen(flip, -cosine, cosine)
    s, c = chosen(odd, way * cosine, s), chosen(odd, -way * sine, c)
    return s, c


def phase(z: Precise) -> Precise:
    """The direction of a vector, in (-π, π]."""
    angle = elementwise_phase(z.high)
    if not _has_rest(angle) or (not is_batched(angle) and not angle):
        return Precise(angle)
    sine, cosine = sin_cos(Precise(angle))
    across = z.imag * cosine - z.real * sine
    return _corrected(angle, across.high / hypot(z.high.real, z.high.imag))


def acos(x: Precise) -> Precise:
    """The angle between 0 and π with this cosine [rad]."""
    return phase(joined(x, sqrt((1.0 - x) * (1.0 + x))))


def asin(x: Precise) -> Precise:
    """The angle with this sine [rad], at most a right angle."""
    return phase(joined(sqrt((1.0 - x) * (1.0 + x)), x))


def exp(x: Precise) -> Precise:
    """e to the power x."""
    if not finite(x.high):
        return Precise(x.high)
    doublings = round(x.high / math.log(2.0))
    rest, total, term = x - _LOG_2 * doublings, Precise(1.0), Precise(1.0)
    for n in range(1, _TERMS):
        term = term * rest / float(n)
        total = total + term
    found: Precise = total * 2.0**doublings
    return found


def log(x: Precise) -> Precise:
    """The natural logarithm."""
    value = x.high.apply(np.log, x.high) if is_batched(x.high) else math.log(x.high)
    return _corrected(value, (x * exp(Precise(-value)) - 1.0).high)
