"""The derivatives of functions of NumPy: from the value and the arguments, dz = a dx + b conj(dx).

Where a function has a corner or no value, its derivative is NaN.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from linkwork.foundation.elementwise import remainders, with_parts

__all__ = ["PLAIN", "QUESTIONS", "RULES", "Partial", "Rule", "carried", "one_sided"]

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
