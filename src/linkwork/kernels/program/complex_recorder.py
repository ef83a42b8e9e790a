"""Recording arithmetic of complex numbers, as that of their parts."""

from __future__ import annotations

from typing import Any

from linkwork.foundation.operand import Arithmetic, Operand
from linkwork.kernels.program.recorder import Recorder, Value

__all__ = ["ComplexRecorder", "ComplexValue"]


class ComplexValue(Operand):
    """A complex number in the making, with a real and an imaginary part."""

    __slots__ = ("arithmetic", "imaginary", "real")
    arithmetic: ComplexRecorder

    def __init__(self, arithmetic: ComplexRecorder, real: Any, imaginary: Any) -> None:
        self.arithmetic = arithmetic
        self.real: Value | float = real
        self.imaginary: Value | float = imaginary


class ComplexRecorder(Arithmetic[ComplexValue]):
    """Records arithmetic on complex values with a recorder of real ones."""

    def __init__(self, recorder: Recorder) -> None:
        self.parts = recorder

    def plain(self, number: Any) -> ComplexValue:
        """A number as it is."""
        given = complex(number)
        return ComplexValue(self, given.real, given.imag)

    def input(self, name: str) -> ComplexValue:
        """The value of two named registers before the program ran."""
        return ComplexValue(self, self.parts.input(f"{name}.re"), self.parts.input(f"{name}.im"))

    def real(self, name: str) -> ComplexValue:
        """The value of one named register, a real number."""
        return ComplexValue(self, self.parts.input(name), 0.0)

    def write(self, name: str, number: ComplexValue | complex) -> None:
        """Leave a number in two named registers when the program has run."""
        value = number if isinstance(number, ComplexValue) else self.plain(number)
        self.parts.write(f"{name}.re", value.real)
        self.parts.write(f"{name}.im", value.imaginary)

    def add(self, x: ComplexValue, y: ComplexValue) -> ComplexValue:
        """x + y."""
        rec = self.parts
        real, imaginary = rec.add(x.real, y.real), rec.add(x.imaginary, y.imaginary)
        return ComplexValue(self, real, imaginary)

    def subtract(self, x: ComplexValue, y: ComplexValue) -> ComplexValue:
        """x - y."""
        rec = self.parts
        real = rec.subtract(x.real, y.real)
        return ComplexValue(self, real, rec.subtract(x.imaginary, y.imaginary))

    def negate(self, x: ComplexValue) -> ComplexValue:
        """-x."""
        return ComplexValue(self, self.parts.negate(x.real), self.parts.negate(x.imaginary))

    def multiply(self, x: ComplexValue, y: ComplexValue) -> ComplexValue:
        """x y."""
        rec = self.parts
        a, b, c, d = x.real, x.imaginary, y.real, y.imaginary
        real = rec.subtract(rec.multiply(a, c), rec.multiply(b, d))
        return ComplexValue(self, real, rec.add(rec.multiply(a, d), rec.multiply(b, c)))

    def divide(self, x: ComplexValue, y: ComplexValue) -> ComplexValue:
        """x / y, for numbers far from overflow."""
        rec = self.parts
        a, b = y.real, y.imaginary
        size = rec.add(rec.multiply(a, a), rec.multiply(b, b))
        inverse = ComplexValue(self, rec.divide(a, size), rec.negate(rec.divide(b, size)))
        return self.multiply(x, inverse)
