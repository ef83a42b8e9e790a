"""Numbers of many designs at once, for code written for one design.

The code that builds a mechanism computes with floats and complex numbers. :class:`Lanes` stand for
such a number in n designs; arithmetic goes lane by lane. Where the code asks *whether* something
holds (``if``, ``and``, ``max``), one lane leads: the answer is the leader's, and the lanes in which
it is another one leave the :class:`Consensus`. What is computed is right for the lanes that are
left; the others are built anew, with a leader of their own. So every design goes exactly the way
that it would have gone alone.

Lanes pass through functions that are annotated for ``float`` and ``complex``, as a number would.
The functions below take plain numbers and lanes alike; a plain number takes the path it took before
there were lanes. Everything else that wants a plain number (``float``, ``math``, arrays) gets a
:class:`NotElementwise` from lanes.
"""

from __future__ import annotations

import cmath
import math
import operator
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar, cast

import numpy as np

from linkwork.foundation.arrays import AnyArray, Array, BoolArray, ComplexArray

if TYPE_CHECKING:
    from typing import TypeGuard

__all__ = [
    "Consensus",
    "Lanes",
    "NotElementwise",
    "Rest",
    "Truths",
    "as_float",
    "choose",
    "cis",
    "copysign",
    "degrees",
    "display_value",
    "everywhere",
    "exponential",
    "finite",
    "hypot",
    "is_batched",
    "is_fractional",
    "is_structurally_nonzero",
    "largest",
    "leader_value",
    "phase",
    "rect",
    "remainder",
    "remainders",
    "rest_of",
    "row_of",
    "smallest",
    "sqrt",
    "uniform_value",
    "vector",
    "with_parts",
]


_Number = TypeVar("_Number", float, complex)


class NotElementwise(Exception):
    """Something that is done with one number only was asked of many."""


class Consensus:
    """Which lanes went the leader's way.

    Parameters
    ----------
    count : int
        n lanes.
    leader : int
        The lane that decides. What is only shown (a sign in a printed equation) follows lane 0.
    widest : bool
        Whether what varies counts as there where it is 0: the terms of all lanes together.

    Attributes
    ----------
    agreeing : (n,) bool
        Lanes in which every decision was the leader's.
    apart : (n,) bool
        Lanes with another value of a number that has to be one for all, as a gear ratio.
    """

    def __init__(self, count: int, leader: int = 0, *, widest: bool = False) -> None:
        self.leader = leader
        self.widest = widest
        self.agreeing: BoolArray = np.ones(count, dtype=bool)
        self.apart: BoolArray = np.zeros(count, dtype=bool)

    def decide(self, truths: BoolArray) -> bool:
        """The leader's answer; lanes with another one leave."""
        answer = bool(truths[self.leader])
        self.agreeing &= truths if answer else ~truths
        return answer

    def settle(self, values: AnyArray) -> Any:
        """The leader's value; lanes with another one stand apart."""
        value = values[self.leader]
        self.apart |= values != value
        return value.item()

    def lanes(self, values: AnyArray) -> float:
        """Values (n,) as one number."""
        return cast(float, Lanes(values, self))

    def pick(self, values: AnyArray) -> Any:
        """Values (n,) that are each one of two plain numbers as one number."""
        return self.lanes(values)


class Truths:
    """Whether something holds, lane by lane; as a condition the leader's answer."""

    __slots__ = ("consensus", "values")

    def __init__(self, values: BoolArray, consensus: Consensus) -> None:
        self.values = values
        self.consensus = consensus

    def __bool__(self) -> bool:
        return self.consensus.decide(self.values)

    def __and__(self, other: object) -> Truths:
        return Truths(self.values & _bare(other), self.consensus)

    def __or__(self, other: object) -> Truths:
        return Truths(self.values | _bare(other), self.consensus)

    def __eq__(self, other: object) -> Any:
        return Truths(self.values == _bare(other), self.consensus)

    def __ne__(self, other: object) -> Any:
        return Truths(self.values != _bare(other), self.consensus)

    __hash__ = None  # type: ignore[assignment]
    __rand__ = __and__
    __ror__ = __or__


class Lanes:
    """One number, real or complex, in n designs: ``values`` (n,)."""

    __slots__ = ("consensus", "values")

    def __init__(self, values: AnyArray, consensus: Consensus) -> None:
        self.values = values
        self.consensus = consensus

    def like(self, values: AnyArray) -> Lanes:
        """Other values of the same lanes."""
        return Lanes(values, self.consensus)

    def apply(self, function: Callable[..., Any], *numbers: object) -> Lanes:
        """A NumPy function of plain numbers and lanes, lane by lane."""
        return self.like(np.asarray(function(*map(_bare, numbers))))

    def uniform_value(self) -> Any:
        """The leader's number, which has to be that of all lanes."""
        return self.consensus.settle(self.values)

    def holds(self, truths: BoolArray) -> Truths:
        """Whether something holds in the same lanes."""
        return Truths(truths, self.consensus)

    # Arithmetic

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **_: object) -> Any:
        """NumPy scalars compute with lanes as floats do; arrays do not."""
        arrays = any(isinstance(number, np.ndarray) for number in inputs)
        if arrays or ufunc not in _OPERATORS or method != "__call__":
            raise NotElementwise
        return _OPERATORS[ufunc](*(n.item() if isinstance(n, np.generic) else n for n in inputs))

    def __add__(self, other: object) -> Lanes:
        return self.like(self.values + _bare(other))

    def __radd__(self, other: object) -> Lanes:
        return self.like(_bare(other) + self.values)

    def __sub__(self, other: object) -> Lanes:
        return self.like(self.values - _bare(other))

    def __rsub__(self, other: object) -> Lanes:
        return self.like(_bare(other) - self.values)

    def __mul__(self, other: object) -> Lanes:
        bare = _bare(other)
        if not isinstance(bare, np.ndarray) and bare == 1:
            return self
        return self.like(self.values * bare)

    __rmul__ = __mul__

    def __truediv__(self, other: object) -> Lanes:
        return self.like(self.values / _bare(other))

    def __rtruediv__(self, other: object) -> Lanes:
        return self.like(_bare(other) / self.values)

    def __pow__(self, other: object) -> Lanes:
        return _power(self, self.values, _bare(other))

    def __rpow__(self, other: object) -> Lanes:
        return _power(self, _bare(other), self.values)

    def __neg__(self) -> Lanes:
        return self.like(-self.values)

    def __abs__(self) -> Lanes:
        return self.like(np.abs(self.values))

    def __round__(self) -> Lanes:
        return self.like(np.rint(self.values))

    def conjugate(self) -> Lanes:
        """The complex conjugate."""
        return self.like(self.values.conjugate())

    @property
    def real(self) -> Lanes:
        """The real part."""
        return self.like(self.values.real)

    @property
    def imag(self) -> Lanes:
        """The imaginary part."""
        return self.like(self.values.imag)

    # Questions

    def __eq__(self, other: object) -> Any:
        return self.holds(self.values == _bare(other))

    def __ne__(self, other: object) -> Any:
        return self.holds(self.values != _bare(other))

    def __lt__(self, other: object) -> Truths:
        return self.holds(self.values < _bare(other))

    def __le__(self, other: object) -> Truths:
        return self.holds(self.values <= _bare(other))

    def __gt__(self, other: object) -> Truths:
        return self.holds(self.values > _bare(other))

    def __ge__(self, other: object) -> Truths:
        return self.holds(self.values >= _bare(other))

    def __bool__(self) -> bool:
        return self.consensus.decide(self.values != 0)

    # Text stands for the number of any lane

    def __format__(self, spec: str) -> str:
        return "…"

    def __repr__(self) -> str:
        return "…"

    # What wants a single number

    def _refuse(self, *_: object, **__: object) -> NoReturn:
        raise NotElementwise

    __float__ = __int__ = __complex__ = __index__ = __hash__ = _refuse
    __array__ = __floor__ = __ceil__ = __trunc__ = _refuse
    __floordiv__ = __mod__ = __rfloordiv__ = __rmod__ = __iter__ = _refuse


_OPERATORS: dict[object, Callable[..., Any]] = {
    np.add: operator.add, np.subtract: operator.sub, np.multiply: operator.mul,
    np.true_divide: operator.truediv, np.power: operator.pow, np.equal: operator.eq,
    np.not_equal: operator.ne, np.less: operator.lt, np.less_equal: operator.le,
    np.greater: operator.gt, np.greater_equal: operator.ge,
}  # fmt: skip


def _bare(number: object) -> Any:
    if isinstance(number, Lanes | Truths):
        return number.values
    if isinstance(number, np.ndarray):
        raise NotElementwise  # its entries are no lanes
    return number


def _power(own: Lanes, base: Any, exponent: Any) -> Lanes:
    """base ** exponent with the exceptions of plain numbers."""
    found = np.asarray(base**exponent)
    wrong = ~np.isfinite(found)
    if wrong.any():
        if own.consensus.decide(wrong & np.broadcast_to(base == 0, wrong.shape)):
            raise ZeroDivisionError
        if own.consensus.decide(wrong & np.isfinite(base) & np.isfinite(exponent)):
            raise OverflowError
    return own.like(found)


def is_batched(number: object) -> TypeGuard[Lanes]:
    """Whether a number is one of many designs."""
    return isinstance(number, Lanes)


def _real(number: Lanes) -> float:
    return cast(float, number)


def _complex(number: Lanes) -> complex:
    return cast(complex, number)


def _first_of_many(numbers: Iterable[object]) -> Lanes | None:
    return next((number for number in numbers if isinstance(number, Lanes)), None)


# Functions of plain numbers and lanes


def vector(x: float, y: float) -> complex:
    """x + iy."""
    lanes = _first_of_many((x, y))
    if lanes is None:
        return complex(x, y)
    return _complex(lanes.apply(with_parts, x, y))


def with_parts(x: Array, y: Array) -> ComplexArray:
    """Arrays x + iy, signs of zeros kept."""
    values = np.empty(np.broadcast_shapes(np.shape(x), np.shape(y)), dtype=complex)
    values.real, values.imag = x, y
    return values


def phase(z: complex) -> float:
    """The direction of a vector, in (-π, π]."""
    if is_batched(z):
        return _real(z.apply(np.angle, z))
    return cmath.phase(z)


def cis(angle: float) -> complex:
    """e^(i angle)."""
    if is_batched(angle):
        return vector(_real(angle.apply(np.cos, angle)), _real(angle.apply(np.sin, angle)))
    return cmath.exp(1j * angle)


def exponential(z: complex) -> complex:
    """e^z; raises OverflowError where it is too large, as ``cmath`` does."""
    if not is_batched(z):
        return cmath.exp(z)
    found = z.apply(np.exp, z)
    if (wrong := ~np.isfinite(found.values)).any() and z.consensus.decide(wrong):
        raise OverflowError
    return _complex(found)


def rect(length: float, angle: float) -> complex:
    """length · e^(i angle)."""
    if _first_of_many((length, angle)) is None:
        return cmath.rect(length, angle)
    return length * cis(angle)


def sqrt(x: float) -> float:
    """The square root; NaN in lanes where it is not real."""
    return _real(x.apply(np.sqrt, x)) if is_batched(x) else math.sqrt(x)


def hypot(x: float, y: float) -> float:
    """√(x² + y²)."""
    lanes = _first_of_many((x, y))
    if lanes is None:
        return math.hypot(x, y)
    return _real(lanes.apply(np.hypot, x, y))


def copysign(size: float, sign: float) -> float:
    """A plain size with the sign of a number."""
    if is_batched(sign):
        return _real(sign.apply(np.copysign, size, sign))
    return math.copysign(size, sign)


def remainder(x: float, period: float) -> float:
    """x less whole periods, at most half a period in size; exact."""
    if not is_batched(x):
        return math.remainder(x, period)
    return _real(x.apply(remainders, x, period))


def remainders(x: Array, period: float) -> Array:
    """:func:`remainder` of an array."""
    rest = np.fmod(x, period)
    size, odd = np.abs(rest), np.trunc(x / period) % 2 == 1
    over = (size > period / 2) | ((size == period / 2) & odd)
    return np.where(over, rest - np.copysign(period, rest), rest)


def degrees(angle: float) -> float:
    """Radians in degrees."""
    if is_batched(angle):
        return _real(angle * (180.0 / math.pi))
    return math.degrees(angle)


def finite(x: float) -> bool:
    """Whether a number is neither NaN nor infinite."""
    return cast(bool, x.holds(np.isfinite(x.values))) if is_batched(x) else math.isfinite(x)


def is_fractional(x: float) -> bool:
    """Whether a number is no whole number."""
    if is_batched(x):
        return cast(bool, x.holds(x.values != np.floor(x.values)))
    return not float(x).is_integer()


def choose(condition: bool, yes: _Number, no: _Number) -> _Number:
    """``yes`` where the condition holds, else ``no``; both are computed."""
    truths: object = condition
    if isinstance(truths, Truths):
        lanes = _first_of_many((yes, no))
        if lanes is None:
            picked: _Number = truths.consensus.pick(np.where(truths.values, yes, no))
            return picked
        return cast(_Number, lanes.apply(np.where, truths, yes, no))
    return yes if condition else no


def everywhere(condition: bool) -> bool:
    """Whether it holds in all lanes that are left: no lane leaves for it."""
    truths: object = condition
    if isinstance(truths, Truths):
        return bool((truths.values | ~truths.consensus.agreeing).all())
    return condition


class Rest:
    """The lanes in which something is not done yet, by themselves, with the leader.

    Work goes on with the numbers of these lanes only, led as before; :meth:`leave` tells the whole
    which of them left meanwhile.
    """

    def __init__(self, done: Truths) -> None:
        self.whole = done.consensus
        wanted = ~done.values & self.whole.agreeing
        wanted[self.whole.leader] = False
        self.lanes = np.concatenate([[self.whole.leader], np.flatnonzero(wanted)])
        self.part = Consensus(len(self.lanes))

    def narrow(self, number: _Number) -> _Number:
        """A number in these lanes."""
        if not is_batched(number):
            return number
        return cast(_Number, Lanes(number.values[self.lanes], self.part))

    def widen(self, whole: _Number, part: _Number) -> _Number:
        """A number of all lanes with what has become of it in these."""
        values = np.array(np.broadcast_to(_bare(whole), self.whole.agreeing.shape))
        values[self.lanes] = _bare(part)
        return cast(_Number, Lanes(values, self.whole))

    def leave(self) -> None:
        """Lanes that went another way leave the whole."""
        self.whole.agreeing[self.lanes] &= self.part.agreeing


def rest_of(done: bool) -> Rest | None:
    """The lanes in which something is not done; ``None`` for a plain condition."""
    truths: object = done
    return Rest(truths) if isinstance(truths, Truths) else None


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
    """Whether something of this size is there."""
    return (is_batched(x) and x.consensus.widest) or bool(x)


def display_value(x: complex) -> complex:
    """The plain number by which something is shown."""
    return complex(x.values[0]) if is_batched(x) else x


def as_float(x: float) -> float:
    """A float of any plain number; lanes as they are."""
    if is_batched(x):
        return _real(x)
    return float(x)


def leader_value(x: float) -> float:
    """The leader's number."""
    return cast(float, x.values[x.consensus.leader].item()) if is_batched(x) else x


def uniform_value(x: float) -> float:
    """A number that has to be one for all designs, as a weight of an angle."""
    return cast(float, x.uniform_value()) if is_batched(x) else x


def row_of(numbers: Iterable[float]) -> Array:
    """Numbers as an array (k,); with lanes among them, of objects."""
    found = list(numbers)
    if _first_of_many(found) is None:
        return np.array(found)
    row = np.empty(len(found), dtype=object)
    for k, number in enumerate(found):
        row[k] = number
    return cast(Array, row)
