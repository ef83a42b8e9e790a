"""Functions that take plain numbers as well as numbers of many designs (lanes).

Plain numbers are computed by ``math`` and ``cmath``, lanes by NumPy.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable
from typing import Any, TypeVar, cast

import numpy as np

from linkwork.foundation.arrays import Array, ComplexArray
from linkwork.foundation.lanes import Lanes, Truths, is_batched

__all__ = [
    "as_float",
    "chained",
    "choose",
    "cis",
    "copysign",
    "degrees",
    "detached",
    "display_value",
    "estimated",
    "everywhere",
    "exponential",
    "finite",
    "hypot",
    "is_fractional",
    "is_steady",
    "is_structurally_nonzero",
    "largest",
    "leader_value",
    "phase",
    "plain_value",
    "rect",
    "remainder",
    "remainders",
    "replaced",
    "row_of",
    "smallest",
    "snap",
    "sqrt",
    "uniform_value",
    "vector",
    "with_parts",
]

_Number = TypeVar("_Number", float, complex)
_Function = Callable[..., Any]


def _first_of_many(numbers: Iterable[object]) -> Lanes | None:
    for number in numbers:
        if isinstance(number, Lanes):
            return number
    return None


def _apply(of_arrays: _Function, of_numbers: _Function, *numbers: object) -> Any:
    """Apply a function of arrays if an argument has lanes, else a function of plain numbers."""
    lanes = _first_of_many(numbers)
    return of_numbers(*numbers) if lanes is None else lanes.apply(of_arrays, *numbers)


def vector(x: float, y: float) -> complex:
    """x + iy."""
    return cast(complex, _apply(with_parts, complex, x, y))


def with_parts(x: Array, y: Array) -> ComplexArray:
    """Arrays x + iy, signs of zeros kept."""
    values = np.empty(np.broadcast_shapes(np.shape(x), np.shape(y)), dtype=complex)
    values.real, values.imag = x, y
    return values


def phase(z: complex) -> float:
    """The direction of a vector, in (-π, π]."""
    return cast(float, _apply(np.angle, _phase, z))


def _phase(z: complex) -> float:
    # cmath.phase fails where the direction of a vector is too small for a float
    return math.atan2(z.imag, z.real)


def cis(angle: float) -> complex:
    """e^(i angle)."""
    if is_batched(angle):
        return vector(_apply(np.cos, math.cos, angle), _apply(np.sin, math.sin, angle))
    return cmath.exp(1j * angle)


def exponential(z: complex) -> complex:
    """e^z; raises OverflowError where it is too large, as ``cmath`` does."""
    if not is_batched(z):
        return cmath.exp(z)
    found = z.apply(np.exp, z)
    if not found.holds(np.isfinite):
        raise OverflowError
    return cast(complex, found)


def rect(length: float, angle: float) -> complex:
    """length · e^(i angle)."""
    if _first_of_many((length, angle)) is None:
        return cmath.rect(length, angle)
    return length * cis(angle)


def sqrt(x: float) -> float:
    """The square root; NaN in lanes where it is not real."""
    return cast(float, _apply(np.sqrt, math.sqrt, x))


def hypot(x: float, y: float) -> float:
    """√(x² + y²)."""
    return cast(float, _apply(np.hypot, math.hypot, x, y))


def copysign(size: float, sign: float) -> float:
    """The size of a plain number with the sign of another number."""
    return cast(float, _apply(np.copysign, math.copysign, size, sign))


def remainder(x: float, period: float) -> float:
    """x minus whole periods, at most half a period in size; exact."""
    return cast(float, _apply(remainders, math.remainder, x, period))


def remainders(x: Array, period: float) -> Array:
    """:func:`remainder` of an array."""
    rest = np.fmod(x, period)
    size, odd = np.abs(rest), np.trunc(x / period) % 2 == 1
    over = (size > period / 2) | ((size == period / 2) & odd)
    return np.where(over, rest - np.copysign(period, rest), rest)


def degrees(angle: float) -> float:
    """Radians in degrees."""
    return cast(float, angle * (180.0 / math.pi)) if is_batched(angle) else math.degrees(angle)


def finite(x: float) -> bool:
    """Whether a number is neither NaN nor infinite."""
    return cast(bool, x.holds(np.isfinite)) if is_batched(x) else math.isfinite(x)


def is_fractional(x: float) -> bool:
    """Whether a number is not an integer."""
    if is_batched(x):
        return cast(bool, x.holds(np.not_equal, x.apply(np.floor, x)))
    return not float(x).is_integer()


def choose(condition: bool, yes: _Number, no: _Number) -> _Number:
    """``yes`` in lanes where the condition holds, else ``no``; both are computed."""
    truths: object = condition
    if isinstance(truths, Truths):
        lanes = _first_of_many((yes, no))
        if lanes is None:
            picked: _Number = truths.consensus.pick(truths, yes, no)
            return picked
        return cast(_Number, lanes.apply(np.where, truths, yes, no))
    return yes if condition else no


def snap(near: bool, place: float, number: float) -> float:
    """``place`` in lanes where the number is near it, else the number."""
    found: float = replaced(choose(near, place, number), number)
    return found


def replaced(value: Any, number: Any) -> Any:
    """A value in the place of a number very near to it, whose derivatives it keeps."""
    return number.arithmetic.carry(value, number) if is_batched(number) else value


def chained(value: Any, slope: Any, number: Any) -> Any:
    """A function's value at a number, which has this slope there."""
    return number.arithmetic.chain(value, slope, number) if is_batched(number) else value


def everywhere(condition: bool) -> bool:
    """Whether a condition holds in all lanes that still agree; it excludes no lane."""
    truths: object = condition
    if isinstance(truths, Truths):
        return bool((truths.values | ~truths.consensus.agreeing).all())
    return condition


def largest(numbers: Iterable[float], default: float = 0.0) -> float:
    """The largest of numbers, lane by lane."""
    return _extreme(list(numbers), default, most=True)


def smallest(numbers: Iterable[float], default: float = 0.0) -> float:
    """The smallest of numbers, lane by lane."""
    return _extreme(list(numbers), default, most=False)


def _extreme(numbers: list[float], default: float, *, most: bool) -> float:
    lanes = _first_of_many(numbers)
    if lanes is None:
        return max(numbers, default=default) if most else min(numbers, default=default)
    plain = [number for number in numbers if not is_batched(number)]
    found: Any = (max(plain) if most else min(plain)) if plain else None
    for number in numbers:
        if is_batched(number):
            better = np.fmax if most else np.fmin
            found = number if found is None else lanes.apply(better, found, number)
    return cast(float, found)


def is_structurally_nonzero(x: complex) -> bool:
    """Whether a term with this coefficient belongs to the equations."""
    return (is_batched(x) and x.arithmetic.widest) or bool(x)


def display_value(x: complex) -> complex:
    """The plain number that is displayed: of lanes, the first."""
    return complex(x.arithmetic.value_in(x, 0)) if is_batched(x) else x


def as_float(x: float) -> float:
    """A plain number as a float; lanes are returned unchanged."""
    return cast(float, x) if is_batched(x) else float(x)


def leader_value(x: float) -> float:
    """The number in the leading lane."""
    return x.arithmetic.value_in(x, x.arithmetic.leader) if is_batched(x) else x


def plain_value(x: _Number) -> _Number:
    """A number as a plain one where its derivatives do not matter; lanes are refused."""
    return x.arithmetic.value_of(x) if is_batched(x) else x


def detached(x: _Number) -> _Number:
    """A number without derivatives, in arithmetics that know them."""
    return x.arithmetic.detached(x) if is_batched(x) else x


def estimated(x: _Number) -> _Number:
    """A number for an estimate, without its formula in arithmetics that know them."""
    return x.arithmetic.estimate(x) if is_batched(x) else x


def is_steady(x: float) -> bool:
    """Whether a number has no derivatives; plain numbers have none."""
    return x.arithmetic.is_steady(x) if is_batched(x) else True


def uniform_value(x: float) -> float:
    """A number that must be equal in all designs, such as the weight of an angle."""
    return cast(float, x.arithmetic.settle(x)) if is_batched(x) else x


def row_of(numbers: Iterable[float]) -> Array:
    """Numbers as an array (k,); its entries are objects if some have lanes."""
    found = list(numbers)
    if _first_of_many(found) is None:
        return np.array(found)
    row = np.empty(len(found), dtype=object)
    for k, number in enumerate(found):
        row[k] = number
    return cast(Array, row)
