"""A homotopy as a program over lanes: every lane is at a point of a path of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from linkwork.foundation.arrays import IndexArray
from linkwork.kernels.program.complex_recorder import ComplexRecorder
from linkwork.kernels.program.lowering import lower_program, reserve
from linkwork.kernels.program.program import Program, Registers
from linkwork.kernels.program.recorder import Recorder

__all__ = ["Layout", "PathProgram", "Recordable", "record_homotopy"]


class Recordable(Protocol):
    """A homotopy H(w, σ) = 0 that is computed with operators alone."""

    @property
    def unknowns(self) -> int:
        """n."""

    @property
    def parameters(self) -> int:
        """Complex numbers that all paths share."""

    def compute(
        self, w: Sequence[Any], sigma: Any, parameters: Sequence[Any]
    ) -> tuple[Sequence[Any], Sequence[Sequence[Any]], Sequence[Any]]:
        """H (n), ∂H/∂w (n rows of n) and ∂H/∂σ (n)."""


class Layout(NamedTuple):
    """Registers of a path program: σ, and the first of w, H, ∂H/∂σ and ∂H/∂w (row by row).

    Complex numbers take two registers each, one after the other.
    """

    unknowns: int
    sigma: int
    point: int
    value: int
    change: int
    jacobian: int


@dataclass(frozen=True, kw_only=True, eq=False)
class PathProgram:
    """The program of a homotopy; ``parameters`` (2 P,): their registers."""

    program: Program
    registers: Registers
    layout: Layout
    parameters: IndexArray


def record_homotopy(homotopy: Recordable) -> PathProgram:
    """Record a homotopy; the same program serves all values of its parameters."""
    n, count = homotopy.unknowns, homotopy.parameters
    rec, registers = Recorder(), Registers()
    numbers = ComplexRecorder(rec)
    sigma = registers.of("sigma")
    point, value, change = (_pairs(registers, name, n) for name in ("w", "h", "c"))
    jacobian = _pairs(registers, "j", n * n)
    given = _pairs(registers, "p", count)
    h, slopes, rates = homotopy.compute(
        [numbers.input(f"w{k}") for k in range(n)],
        numbers.real("sigma"),
        [numbers.input(f"p{k}") for k in range(count)],
    )
    for k in range(n):
        numbers.write(f"h{k}", h[k])
        numbers.write(f"c{k}", rates[k])
        for i in range(n):
            numbers.write(f"j{k * n + i}", slopes[k][i])
    reserve(rec, registers)
    return PathProgram(
        program=lower_program(rec, registers, registers.count),
        registers=registers,
        layout=Layout(n, sigma, point, value, change, jacobian),
        parameters=registers.all_of(f"p{k}.{part}" for k in range(count) for part in ("re", "im"))
        if count
        else registers.all_of(()) + given,
    )


def _pairs(registers: Registers, name: str, count: int) -> int:
    """Registers for complex numbers, one after the other; the first of them."""
    first = registers.count
    for k in range(count):
        registers.of(f"{name}{k}.re")
        registers.of(f"{name}{k}.im")
    return first
