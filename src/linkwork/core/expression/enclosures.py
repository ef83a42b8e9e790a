"""Enclosures: a formula's values and derivatives over a box, as intervals that contain rounding.

An operand is an interval of values with one interval for each derivative. Every result is widened
by its rounding, so that the exact value at every point of the box lies within: by a neighbouring
float where an operation is rounded once, by ``_ULPS`` for functions of a library.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.core.expression.derivatives import Functions
from linkwork.core.foundation.arrays import Array, BoolArray
from linkwork.core.foundation.lanes import Arithmetic, Operand
from linkwork.core.foundation.rounding import EPSILON

#: Vectorised libraries state errors of up to four units in the last place.
_ULPS = 8.0
_SMALLEST = 5e-324


class _IntervalArithmetic(Arithmetic["Interval"]):
    """Interval arithmetic, rounded outwards."""

    def plain(self, number: float) -> Interval:
        """A number as it is."""
        x = np.asarray(number, dtype=float)
        return Interval(x, x)

    def add(self, x: Interval, y: Interval) -> Interval:
        """x + y."""
        return _outwards(x.low + y.low, x.high + y.high)

    def negate(self, x: Interval) -> Interval:
        """-x."""
        return Interval(-x.high, -x.low)

    def multiply(self, x: Interval, y: Interval) -> Interval:
        """x y, where 0 · ∞ is 0."""
        corners = [a * b for a in (x.low, x.high) for b in (y.low, y.high)]
        corners = [np.where(np.isnan(corner), 0.0, corner) for corner in corners]
        return _outwards(_least(corners), _most(corners)).where(x.known & y.known)

    def divide(self, x: Interval, y: Interval) -> Interval:
        """x / y; unbounded where y may be 0."""
        zero = (y.low <= 0.0) & (y.high >= 0.0)
        inverse = _outwards(1.0 / y.high, 1.0 / y.low)
        low, high = np.where(zero, -np.inf, inverse.low), np.where(zero, np.inf, inverse.high)
        return x * Interval(low, high).where(y.known)

    def power(self, x: Interval, y: Interval) -> Interval:
        """x to a whole power that is at least 0."""
        exponent = int(y.low)
        ends = [x.low**exponent, x.high**exponent]
        low, high = _least(ends), _most(ends)
        if exponent and exponent % 2 == 0:
            low = np.where((x.low < 0.0) & (x.high > 0.0), 0.0, low)
        return widened(low, high)


_INTERVALS = _IntervalArithmetic()


@dataclass(frozen=True)
class Interval(Operand):
    """All numbers from ``low`` to ``high``, arrays of one shape; NaN where nothing is known."""

    arithmetic = _INTERVALS
    low: Array
    high: Array

    @property
    def known(self) -> BoolArray:
        """Where there are values."""
        return ~(np.isnan(self.low) | np.isnan(self.high))

    def where(self, known: BoolArray) -> Interval:
        """NaN elsewhere."""
        return Interval(np.where(known, self.low, np.nan), np.where(known, self.high, np.nan))

    def clipped(self, least: float, most: float) -> Interval:
        """Without numbers that cannot occur."""
        return Interval(np.maximum(self.low, least), np.minimum(self.high, most))


def _least(parts: Sequence[Array]) -> Array:
    return np.asarray(np.minimum.reduce(np.broadcast_arrays(*parts)))


def _most(parts: Sequence[Array]) -> Array:
    return np.asarray(np.maximum.reduce(np.broadcast_arrays(*parts)))


def _outwards(low: Array, high: Array) -> Interval:
    """Widened by one rounding."""
    return Interval(np.nextafter(low, -np.inf), np.nextafter(high, np.inf))


def widened(low: Array, high: Array) -> Interval:
    """Widened by the errors of a library's function."""
    slack = _ULPS * EPSILON
    return Interval(low - slack * np.abs(low) - _SMALLEST, high + slack * np.abs(high) + _SMALLEST)


class _EnclosureArithmetic(Arithmetic["Enclosure"]):
    """Interval arithmetic with the product rule and the chain rule."""

    def plain(self, number: float) -> Enclosure:
        """A number as it is."""
        return Enclosure(_INTERVALS.plain(number), _NO_CHANGE)

    def add(self, x: Enclosure, y: Enclosure) -> Enclosure:
        """x + y."""
        return Enclosure(x.v + y.v, x.d + y.d)

    def negate(self, x: Enclosure) -> Enclosure:
        """-x."""
        return Enclosure(-x.v, -x.d)

    def multiply(self, x: Enclosure, y: Enclosure) -> Enclosure:
        """x y."""
        return Enclosure(x.v * y.v, x.d * y.v + x.v * y.d)

    def divide(self, x: Enclosure, y: Enclosure) -> Enclosure:
        """x / y."""
        inverse = 1.0 / y.v
        return x * y.chain(inverse, -(inverse**2))

    def power(self, x: Enclosure, y: Enclosure) -> Enclosure:
        """x to the power y; an exponent that is no whole number needs a positive base."""
        # a constant is no array of places
        number = float(y.v.low) if np.ndim(y.v.low) == 0 and y.v.low == y.v.high else np.nan
        if not number.is_integer():
            return _exp(y * _ln(x))
        whole = int(abs(number))
        found = x.chain(x.v**whole, whole * x.v ** max(whole - 1, 0))
        return found if number >= 0.0 else self.divide(self.plain(1.0), found)

    def absolute(self, x: Enclosure) -> Enclosure:
        """|x|; where x may be 0 the derivative is any between those of both sides."""
        low, high = x.v.low, x.v.high
        size = Interval(np.maximum(0.0, np.maximum(low, -high)), np.maximum(-low, high))
        sign = Interval(np.where(low > 0.0, 1.0, -1.0), np.where(high < 0.0, -1.0, 1.0))
        return x.chain(size.where(~np.isnan(low)), sign)


#: Of constants, (1, 1).
_NO_CHANGE = Interval(np.zeros((1, 1)), np.zeros((1, 1)))
_ENCLOSURES = _EnclosureArithmetic()


@dataclass(frozen=True)
class Enclosure(Operand):
    """Values ``v`` (B,) and derivatives ``d`` (k, B) over boxes."""

    arithmetic = _ENCLOSURES
    v: Interval
    d: Interval

    def chain(self, f: Interval, slope: Interval) -> Enclosure:
        """f(self), given the values of f and of its derivative."""
        return Enclosure(f, self.d * slope)


def _rounded(number: float) -> Enclosure:
    """A number that was rounded once or twice, such as π."""
    x = np.asarray(number, dtype=float)
    slack = 2.0 * EPSILON * np.abs(x)
    return Enclosure(Interval(x - slack, x + slack), _NO_CHANGE)


def _growing(f: Callable[[Array], Array], x: Interval) -> Interval:
    return widened(f(x.low), f(x.high))


def _exp(x: Enclosure) -> Enclosure:
    e = _growing(np.exp, x.v).clipped(0.0, np.inf)
    return x.chain(e, e)


def _ln(x: Enclosure) -> Enclosure:
    positive = x.v.where(x.v.low > 0.0)
    return x.chain(_growing(np.log, positive), 1.0 / positive)


def _log10(x: Enclosure) -> Enclosure:
    return _ln(x) / _ln(_ENCLOSURES.plain(10.0))


def _sqrt(x: Enclosure) -> Enclosure:
    root = _growing(np.sqrt, x.v).clipped(0.0, np.inf).where(x.v.low >= 0.0)
    return x.chain(root, 0.5 / root)


def _wave(f: Callable[[Array], Array], x: Interval, top: float) -> Interval:
    """A sine or cosine, which is 1 at ``top`` and -1 half a turn later."""
    found = _growing(f, Interval(x.low, x.low)), _growing(f, Interval(x.high, x.high))
    low = np.minimum(found[0].low, found[1].low)
    high = np.maximum(found[0].high, found[1].high)
    for place, edge in ((top, 1.0), (top + np.pi, -1.0)):
        turns = [(end - place) / (2.0 * np.pi) for end in (x.low, x.high)]
        slack = [8.0 * EPSILON * (1.0 + np.abs(turn)) for turn in turns]
        met = np.floor(turns[1] + slack[1]) > np.floor(turns[0] - slack[0])
        high = np.where(met & (edge > 0.0), 1.0, high)
        low = np.where(met & (edge < 0.0), -1.0, low)
    known = np.isfinite(x.low) & np.isfinite(x.high)
    return Interval(np.where(known, low, -1.0), np.where(known, high, 1.0)).clipped(-1.0, 1.0)


def _sin(x: Enclosure) -> Enclosure:
    return x.chain(_wave(np.sin, x.v, 0.5 * np.pi), _wave(np.cos, x.v, 0.0))


def _cos(x: Enclosure) -> Enclosure:
    return x.chain(_wave(np.cos, x.v, 0.0), -_wave(np.sin, x.v, 0.5 * np.pi))


def _tan(x: Enclosure) -> Enclosure:
    cosine = _wave(np.cos, x.v, 0.0)
    regular = x.v.where((cosine.low > 0.0) | (cosine.high < 0.0))
    tangent = _growing(np.tan, regular)
    return x.chain(tangent, 1.0 + tangent**2)


def _arc_slope(x: Interval) -> Interval:
    return 1.0 / _sqrt(Enclosure(1.0 - x**2, x)).v


def _asin(x: Enclosure) -> Enclosure:
    return x.chain(_growing(np.arcsin, x.v), _arc_slope(x.v))


def _acos(x: Enclosure) -> Enclosure:
    return x.chain(-_growing(lambda z: -np.arccos(z), x.v), -_arc_slope(x.v))


def _atan(x: Enclosure) -> Enclosure:
    return x.chain(_growing(np.arctan, x.v), 1.0 / (1.0 + x.v**2))


def _atan2(y: Enclosure, x: Enclosure) -> Enclosure:
    corners = [np.arctan2(a, b) for a in (y.v.low, y.v.high) for b in (x.v.low, x.v.high)]
    # no jump by a whole turn within the box
    cut = (y.v.low <= 0.0) & (y.v.high >= 0.0) & (x.v.low <= 0.0)
    angle = widened(_least(corners), _most(corners)).where(~cut)
    return Enclosure(angle, (y.d * x.v - x.d * y.v) / (x.v**2 + y.v**2))


def _hypot(x: Enclosure, y: Enclosure) -> Enclosure:
    return _sqrt(x**2.0 + y**2.0)


def _max(*parts: Enclosure) -> Enclosure:
    """The largest; where more than one may be it, any derivative between theirs."""
    low, high = (_most([getattr(x.v, end) for x in parts]) for end in ("low", "high"))
    below: list[Array] = []
    above: list[Array] = []
    for x in parts:
        # any comparison with NaN fails
        possible = ~(x.v.high < low)
        below.append(np.where(possible, x.d.low, np.inf))
        above.append(np.where(possible, x.d.high, -np.inf))
    return Enclosure(Interval(low, high), Interval(_least(below), _most(above)))


def _min(*parts: Enclosure) -> Enclosure:
    return -_max(*(-x for x in parts))


#: Functions that are evaluated as enclosures.
ENCLOSURES: Functions[Enclosure] = Functions(
    literal=_ENCLOSURES.plain,
    rounded=_rounded,
    plain={
        "sqrt": _sqrt, "exp": _exp, "ln": _ln, "log10": _log10, "abs": abs, "hypot": _hypot,
        "min": _min, "max": _max,
    },
    of_angle={"sin": _sin, "cos": _cos, "tan": _tan},
    to_angle={"asin": _asin, "acos": _acos, "atan": _atan, "atan2": _atan2},
)  # fmt: skip
