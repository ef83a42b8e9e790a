"""Numbers of many designs at once, for code written for one design.

The code that builds a mechanism computes with floats and complex numbers. :class:`Lanes` stand for
such a number in n designs; arithmetic goes lane by lane. Where the code tests a condition (``if``,
``and``, ``max``), one lane, the leader, gives the answer, and the lanes with another answer leave
the :class:`Consensus`. Results are valid for the remaining lanes; the others are built again, with
a leader among them. So every design takes the same branches of the code as it does alone.

Functions annotated for ``float`` and ``complex`` accept lanes;
:mod:`~linkwork.foundation.elementwise` has functions for both. Operations that need a plain number
(``float``, ``math``, arrays) raise :class:`NotElementwise` for lanes.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar, cast

import numpy as np

from linkwork.foundation.arrays import AnyArray, BoolArray
from linkwork.foundation.operand import Arithmetic, NotElementwise, Operand

if TYPE_CHECKING:
    from typing import TypeGuard

__all__ = ["Consensus", "LaneArithmetic", "Lanes", "Rest", "Truths", "is_batched", "rest_of"]

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
