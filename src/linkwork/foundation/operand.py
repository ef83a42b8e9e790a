"""Overloaded operators: ``a * b + 2`` is computed by the arithmetic of the operands.

:class:`Operand` is the only class of the package with operators. They call an
:class:`Arithmetic`, of which there are seven: numbers of many designs
(:mod:`~linkwork.foundation.lanes`), numbers of 32 digits (``precise``), values with two
derivatives (:mod:`linkwork.expression.jets`), formulas of cells, numbers with such formulas (both
in ``linkwork.export.workbook``), and programs for kernels (``linkwork.kernels.program.recorder``,
and ``complex_recorder`` for complex numbers).
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Sequence
from typing import Any, Generic, Self, TypeVar

import numpy as np

__all__ = ["Arithmetic", "NotElementwise", "Operand"]

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
