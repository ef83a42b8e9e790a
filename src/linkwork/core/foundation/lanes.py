"""Functions of numbers that work on floats, arrays and lanes alike."""

from __future__ import annotations

import cmath
import math
import operator
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, Generic, NoReturn, Self, TypeVar, cast

import numpy as np

from linkwork.core.foundation.arrays import AnyArray, Array, BoolArray, ComplexArray

if TYPE_CHECKING:
    from typing import TypeGuard

# ----------------------------------------------------------------------
# Overloaded operators: ``a * b + 2`` is computed by the arithmetic of the operands.
#
# :class:`Operand` is the only class of the package with operators. They call an
# :class:`Arithmetic`, of which there are seven: numbers of many designs
# (:class:`Lanes`), numbers of 32 digits (``precise``), values with two
# derivatives (:mod:`linkwork.core.expression.derivatives`), formulas of cells, numbers with such
# formulas (both in ``linkwork.writers.formulas``), and programs for kernels
# (``linkwork.core.record.recorder``, and ``complex_recorder`` for complex numbers).


T = TypeVar("T")

_PLAIN = (int, float, complex, np.number)


class NotElementwise(TypeError):
    """An arithmetic does not define an operation, or does not accept an operand."""


class Arithmetic(Generic[T]):
    """Computes with operands of one kind; refuses the operations that it does not define."""

    def operand(self, number: object) -> T:
        """The second operand of an operation: one of this arithmetic, or a plain number.

        Raises
        ------
        NotElementwise
            For anything else, such as an array or an operand of another arithmetic.
        """
        if isinstance(number, Operand):
            if number.arithmetic is self:
                return number  # type: ignore[return-value]  # its own are of type T
        elif isinstance(number, _PLAIN):
            return self.plain(number)
        raise NotElementwise

    def plain(self, number: Any) -> T:
        """A plain number as an operand."""
        raise NotElementwise

    def of_numpy(self, function: Any, inputs: Sequence[Any]) -> Any:
        """NumPy scalars compute with operands as floats do; arrays do not."""
        arrays = any(isinstance(number, np.ndarray) for number in inputs)
        if arrays or function not in _OPERATORS:
            raise NotElementwise
        plain = (n.item() if isinstance(n, np.generic) else n for n in inputs)
        return _OPERATORS[function](*plain)

    def add(self, x: T, y: T) -> T:
        """x + y."""
        raise NotElementwise

    def subtract(self, x: T, y: T) -> T:
        """x - y."""
        return self.add(x, self.negate(y))

    def multiply(self, x: T, y: T) -> T:
        """x y."""
        raise NotElementwise

    def divide(self, x: T, y: T) -> T:
        """x / y."""
        raise NotElementwise

    def power(self, x: T, y: T) -> T:
        """x to the power y."""
        raise NotElementwise

    def negate(self, x: T) -> T:
        """-x."""
        raise NotElementwise

    def absolute(self, x: T) -> T:
        """|x|."""
        raise NotElementwise


class Operand:
    """A number with the operators of a float; ``arithmetic`` computes them."""

    __slots__ = ()
    arithmetic: Arithmetic[Self]

    def __add__(self, other: object) -> Self:
        return self.arithmetic.add(self, self.arithmetic.operand(other))

    def __sub__(self, other: object) -> Self:
        return self.arithmetic.subtract(self, self.arithmetic.operand(other))

    def __rsub__(self, other: object) -> Self:
        return self.arithmetic.subtract(self.arithmetic.operand(other), self)

    def __mul__(self, other: object) -> Self:
        return self.arithmetic.multiply(self, self.arithmetic.operand(other))

    def __truediv__(self, other: object) -> Self:
        return self.arithmetic.divide(self, self.arithmetic.operand(other))

    def __rtruediv__(self, other: object) -> Self:
        return self.arithmetic.divide(self.arithmetic.operand(other), self)

    def __pow__(self, other: object) -> Self:
        return self.arithmetic.power(self, self.arithmetic.operand(other))

    def __rpow__(self, other: object) -> Self:
        return self.arithmetic.power(self.arithmetic.operand(other), self)

    def __neg__(self) -> Self:
        return self.arithmetic.negate(self)

    def __abs__(self) -> Self:
        return self.arithmetic.absolute(self)

    __radd__ = __add__
    __rmul__ = __mul__

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **_: object) -> Any:
        """What NumPy computes with operands."""
        if method != "__call__":
            raise NotElementwise
        return self.arithmetic.of_numpy(ufunc, inputs)


_OPERATORS: dict[object, Callable[..., Any]] = {
    np.add: operator.add, np.subtract: operator.sub, np.multiply: operator.mul,
    np.true_divide: operator.truediv, np.power: operator.pow, np.equal: operator.eq,
    np.not_equal: operator.ne, np.less: operator.lt, np.less_equal: operator.le,
    np.greater: operator.gt, np.greater_equal: operator.ge,
}  # fmt: skip


# ----------------------------------------------------------------------
# Numbers of many designs at once, for code written for one design.
#
# The code that builds a mechanism computes with floats and complex numbers. :class:`Lanes` stand
# for such a number in n designs; arithmetic goes lane by lane. Where the code tests a condition
# (``if``, ``and``, ``max``), one lane, the leader, gives the answer, and the lanes with another
# answer leave the :class:`Consensus`. Results are valid for the remaining lanes; the others are
# built again, with a leader among them. So every design takes the same branches of the code as it
# does alone.
#
# Functions annotated for ``float`` and ``complex`` accept lanes;
# This module has functions for both. Operations that need a plain
# number (``float``, ``math``, arrays) raise :class:`NotElementwise` for lanes.


_Number = TypeVar("_Number", float, complex)


class Consensus(Arithmetic[Any]):
    """An arithmetic of n lanes, with a record of the lanes that agree with the leader.

    Parameters
    ----------
    count : int
        n lanes.
    leader : int
        The lane that decides. Displayed values (a sign in a printed equation) are those of lane 0.
    widest : bool
        Whether a varied coefficient that is 0 keeps its term: all lanes then have the same terms.

    Attributes
    ----------
    agreeing : (n,) bool
        Lanes in which every decision was the leader's.
    apart : (n,) bool
        Lanes with another value of a number that must be equal in all, such as a gear ratio.
    """

    def __init__(self, count: int, leader: int = 0, *, widest: bool = False) -> None:
        self.leader = leader
        self.widest = widest
        self.agreeing: BoolArray = np.ones(count, dtype=bool)
        self.apart: BoolArray = np.zeros(count, dtype=bool)

    def decide(self, truths: BoolArray) -> bool:
        """The leader's answer; lanes with another answer leave."""
        answer = bool(truths[self.leader])
        self.agreeing &= truths if answer else ~truths
        return answer

    def settle(self, number: Any) -> Any:
        """The leader's value of a number; lanes with another value are marked as ``apart``."""
        value = number.values[self.leader]
        self.apart |= number.values != value
        return value.item()

    def lanes(self, values: AnyArray) -> float:
        """Values (n,) as one number."""
        raise NotElementwise

    def pick(self, truths: Truths, yes: complex, no: complex) -> Any:
        """One of two plain numbers, lane by lane."""
        return self.lanes(np.where(truths.values, yes, no))

    def value_of(self, number: Any) -> Any:
        """The value of a number that starts an iteration or decides a rank; lanes have many."""
        raise NotElementwise

    def value_in(self, number: Any, lane: int) -> Any:
        """The value of a number in one lane."""
        return number.values[lane].item()

    def detached(self, number: Any) -> Any:
        """A number without its derivatives, in arithmetics that know them."""
        return number

    def estimate(self, number: Any) -> Any:
        """A number for an estimate; arithmetics with formulas leave them out."""
        return number

    def is_steady(self, number: Any) -> bool:
        """Whether a number has no derivatives, in arithmetics that know them."""
        return True

    def solve_shortest(
        self, matrix: Sequence[Sequence[Any]], right: Sequence[Any]
    ) -> Sequence[Any] | None:
        """The shortest least-squares solution; ``None`` where lanes are solved as arrays.

        Arithmetics with derivatives expect a matrix without any.
        """
        return None

    def carry(self, value: Any, number: Any) -> Any:
        """A value that replaces a number very near to it; arithmetics with derivatives keep those
        of the number.
        """
        return value

    def chain(self, value: Any, slope: Any, number: Any) -> Any:
        """A function's value at a number, in arithmetics with derivatives."""
        raise NotElementwise

    def apply(self, function: Callable[..., Any], *numbers: object) -> Lanes:
        """A NumPy function of plain numbers and lanes, lane by lane."""
        raise NotElementwise


class Truths:
    """A condition lane by lane; its truth value is the leader's answer."""

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


class Lanes(Operand):
    """One number, real or complex, in n designs: ``values`` (n,)."""

    __slots__ = ("arithmetic", "values")
    arithmetic: Consensus

    def __init__(self, values: AnyArray, arithmetic: Consensus) -> None:
        self.values = values
        self.arithmetic = arithmetic

    def apply(self, function: Callable[..., Any], *numbers: object) -> Lanes:
        """A NumPy function of plain numbers and lanes, lane by lane."""
        return self.arithmetic.apply(function, *numbers)

    def holds(self, question: Callable[..., Any], *others: object) -> Truths:
        """The answer to a question of NumPy about this number and others, lane by lane."""
        return Truths(question(self.values, *map(_bare, others)), self.arithmetic)

    def __round__(self) -> Lanes:
        return self.arithmetic.apply(np.rint, self)

    def conjugate(self) -> Lanes:
        """The complex conjugate."""
        return self.arithmetic.apply(np.conjugate, self)

    @property
    def real(self) -> Lanes:
        """The real part."""
        return self.arithmetic.apply(np.real, self)

    @property
    def imag(self) -> Lanes:
        """The imaginary part."""
        return self.arithmetic.apply(np.imag, self)

    # Questions

    def __eq__(self, other: object) -> Any:
        return self.holds(np.equal, other)

    def __ne__(self, other: object) -> Any:
        return self.holds(np.not_equal, other)

    def __lt__(self, other: object) -> Truths:
        return self.holds(np.less, other)

    def __le__(self, other: object) -> Truths:
        return self.holds(np.less_equal, other)

    def __gt__(self, other: object) -> Truths:
        return self.holds(np.greater, other)

    def __ge__(self, other: object) -> Truths:
        return self.holds(np.greater_equal, other)

    def __bool__(self) -> bool:
        return self.arithmetic.decide(self.values != 0)

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


class LaneArithmetic(Consensus):
    """Computes with arrays, with the exceptions of plain numbers."""

    def lanes(self, values: AnyArray) -> float:
        """Values (n,) as one number."""
        return cast(float, Lanes(values, self))

    def apply(self, function: Callable[..., Any], *numbers: object) -> Lanes:
        """A NumPy function of plain numbers and lanes, lane by lane."""
        return Lanes(np.asarray(function(*map(_bare, numbers))), self)

    def plain(self, number: Any) -> Lanes:
        """The same number in all lanes; NumPy broadcasts it."""
        return Lanes(number, self)

    def add(self, x: Lanes, y: Lanes) -> Lanes:
        """x + y."""
        return Lanes(x.values + y.values, self)

    def subtract(self, x: Lanes, y: Lanes) -> Lanes:
        """x - y."""
        return Lanes(x.values - y.values, self)

    def multiply(self, x: Lanes, y: Lanes) -> Lanes:
        """x y."""
        factor: Any = y.values  # an array, or a plain number
        if not isinstance(factor, np.ndarray) and factor == 1:
            return x
        return Lanes(x.values * factor, self)

    def divide(self, x: Lanes, y: Lanes) -> Lanes:
        """x / y."""
        return Lanes(x.values / y.values, self)

    def power(self, x: Lanes, y: Lanes) -> Lanes:
        """x to the power y; raises what plain numbers raise."""
        base, exponent = x.values, y.values
        found = np.asarray(base**exponent)
        wrong = ~np.isfinite(found)
        if wrong.any():
            if self.decide(wrong & np.broadcast_to(base == 0, wrong.shape)):
                raise ZeroDivisionError
            if self.decide(wrong & np.isfinite(base) & np.isfinite(exponent)):
                raise OverflowError
        return Lanes(found, self)

    def negate(self, x: Lanes) -> Lanes:
        """-x."""
        return Lanes(-x.values, self)

    def absolute(self, x: Lanes) -> Lanes:
        """|x|."""
        return Lanes(np.abs(x.values), self)


_MANY = (Lanes, Truths)


def _bare(number: object) -> Any:
    if isinstance(number, _MANY):
        return number.values
    if isinstance(number, np.ndarray):
        raise NotElementwise  # its entries are no lanes
    return number


def is_batched(number: object) -> TypeGuard[Lanes]:
    """Whether a number is one of many designs."""
    return isinstance(number, Lanes)


class Rest:
    """The lanes in which an iteration has not ended, and the leader, as an arithmetic of their own.

    The iteration continues with these lanes only and the same leader; :meth:`leave` then removes
    from the whole those that disagreed.
    """

    def __init__(self, done: Truths) -> None:
        self.whole = done.consensus
        wanted = ~done.values & self.whole.agreeing
        wanted[self.whole.leader] = False
        self.lanes = np.concatenate([[self.whole.leader], np.flatnonzero(wanted)])
        self.part = LaneArithmetic(len(self.lanes))

    def narrow(self, number: _Number) -> _Number:
        """A number restricted to these lanes."""
        if not is_batched(number):
            return number
        return cast(_Number, Lanes(number.values[self.lanes], self.part))

    def widen(self, whole: _Number, part: _Number) -> _Number:
        """A number of all lanes, with the values of ``part`` in these lanes."""
        values = np.array(np.broadcast_to(_bare(whole), self.whole.agreeing.shape))
        values[self.lanes] = _bare(part)
        return self.whole.lanes(values)

    def leave(self) -> None:
        """Remove the lanes that disagreed from the whole."""
        self.whole.agreeing[self.lanes] &= self.part.agreeing


def rest_of(done: bool) -> Rest | None:
    """The lanes in which ``done`` is false; ``None`` for a plain condition."""
    truths: object = done
    return Rest(truths) if isinstance(truths, Truths) else None


# ----------------------------------------------------------------------
# Functions that take plain numbers as well as numbers of many designs (lanes).
#
# Plain numbers are computed by ``math`` and ``cmath``, lanes by NumPy.


_Function = Callable[..., Any]


def first_lanes(numbers: Iterable[object]) -> Lanes | None:
    """The first number of many designs, if there is one."""
    return next((number for number in numbers if isinstance(number, Lanes)), None)


def _apply(of_arrays: _Function, of_numbers: _Function, *numbers: object) -> Any:
    """Apply a function of arrays if an argument has lanes, else a function of plain numbers."""
    lanes = first_lanes(numbers)
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
    if first_lanes((length, angle)) is None:
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
        lanes = first_lanes((yes, no))
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
    lanes = first_lanes(numbers)
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
    if first_lanes(found) is None:
        return np.array(found)
    row = np.empty(len(found), dtype=object)
    for k, number in enumerate(found):
        row[k] = number
    return cast(Array, row)
