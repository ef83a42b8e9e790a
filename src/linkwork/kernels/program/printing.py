"""Programs written out as Python source: one statement for each instruction.

The code names registers only, so no text of a mechanism's file gets into it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field

from linkwork.kernels.program.interpreter import LANES
from linkwork.kernels.program.program import ROLES, Code, Op

__all__ = ["Body", "trial_source"]

_STATEMENT = {
    Op.COPY: "{a}",
    Op.ADD: "{a} + {b}",
    Op.SUB: "{a} - {b}",
    Op.MUL: "{a} * {b}",
    Op.DIV: "{a} / {b}",
    Op.FMA: "{a} * {b} + {c}",
    Op.FMS: "{a} * {b} - {c}",
    Op.FNMA: "{c} - {a} * {b}",
    Op.NEG: "-{a}",
    Op.ABS: "abs({a})",
    Op.MAX: "{a} if ({a} > {b}) | ({a} != {a}) else {b}",
    Op.MIN: "{a} if ({a} < {b}) | ({a} != {a}) else {b}",
    Op.SQRT: "math.sqrt({a})",
    Op.WHERE: "{b} if {a} > 0.5 else {c}",
    Op.LE: "1.0 if {a} <= {b} else 0.0",
    Op.AND: "{a} * {b}",
    Op.KEEP: "{b} if {a} > 0.5 else {d}",
    Op.LESS: "{d} - {a}",
}


@dataclass
class Body:
    """Statements over local names; registers are read where first needed and written at the end."""

    place: Callable[[int], str]
    constants: Mapping[int, float]
    lines: list[str] = field(default_factory=list)
    known: set[int] = field(default_factory=set)
    changed: set[int] = field(default_factory=set)

    def value(self, register: int) -> str:
        """The expression that a register holds now."""
        if register in self.constants:
            return _number(self.constants[register])
        if register not in self.known:
            self.known.add(register)
            self.lines.append(f"r{register} = {self.place(register)}")
        return f"r{register}"

    def _set(self, *registers: int) -> None:
        self.known.update(registers)
        self.changed.update(registers)

    def add(self, code: Code) -> None:
        """The statements of a program."""
        for number, d, a, b, c in code.tolist():
            op = Op(number)
            if op is Op.SIN:
                self.lines.append(f"r{d}, r{c} = sin_cos({self.value(a)})")
                self._set(d, c)
                continue
            form = _STATEMENT[op]
            used = {
                key: self.value(register)
                for key, register in (("a", a), ("b", b), ("c", c), ("d", d))
                if "{" + key + "}" in form
            }
            self.lines.append(f"r{d} = {form.format(**used)}")
            self._set(d)

    def end(self, kept: Set[int]) -> None:
        """Write the registers that are kept and have changed."""
        for register in sorted(self.changed & kept):
            self.lines.append(f"{self.place(register)} = r{register}")


def _number(value: float) -> str:
    """A number as Python writes it; infinities and NaN by name."""
    if math.isnan(value):
        return "math.nan"
    if math.isinf(value):
        return "math.inf" if value > 0.0 else "-math.inf"
    return repr(value)


def trial_source(
    programs: Sequence[Code], height: int, kept: Set[int], constants: Mapping[int, float]
) -> str:
    """A function ``trial`` over lanes that runs programs one after the other.

    Parameters
    ----------
    programs : sequence of (K, 5)
        In the first turn.
    height : int
        How many registers each of the five places has; they come first.
    kept : set of int
        Registers that are written; others that change are local.
    constants : Mapping[int, float]
        Registers of constants.
    """
    body = Body(lambda register: _lane_place(register, height), constants)
    for code in programs:
        body.add(code)
    body.end(kept)
    statements = "\n".join(f"        {line}" for line in body.lines)
    return f"""\
import math

from linkwork.kernels.program.compiling import trial_at
from linkwork.kernels.program.sine import sin_cos


@trial_at
def trial(place0, place1, place2, place3, place4, others, lanes):
    for i in range(lanes):
{statements}
"""


def _lane_place(register: int, height: int) -> str:
    role, number = divmod(register, height)
    if role < ROLES:
        return f"place{role}[{number * LANES} + i]"
    return f"others[{(register - ROLES * height) * LANES} + i]"
