"""Programs written out as source text of a language: one statement for each instruction.

The code names registers only, so no text of a mechanism's file gets into it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field

from linkwork.kernels.program.interpreter import LANES
from linkwork.kernels.program.languages import PYTHON, Language
from linkwork.kernels.program.program import ROLES, Code, Op

__all__ = ["Body", "trial_source"]


@dataclass
class Body:
    """Statements over local names; registers are read where first needed and written at the end."""

    place: Callable[[int], str]
    constants: Mapping[int, float]
    language: Language = PYTHON
    lines: list[str] = field(default_factory=list)
    known: set[int] = field(default_factory=set)
    changed: set[int] = field(default_factory=set)
    turns: int = 0

    def value(self, register: int) -> str:
        """The expression that a register holds now."""
        if register in self.constants:
            return self.language.number(self.constants[register])
        if register not in self.known:
            self._assign(register, self.place(register))
        return f"r{register}"

    def _assign(self, register: int, value: str) -> None:
        form = self.language.later if register in self.known else self.language.first
        self.lines.append(form.format(name=f"r{register}", value=value))
        self.known.add(register)

    def add(self, code: Code) -> None:
        """The statements of a program."""
        for number, d, a, b, c in code.tolist():
            op = Op(number)
            if op is Op.SIN:
                self._add_sine(self.value(a), d, c)
                continue
            form = self.language.forms[op]
            used = {
                key: self.value(register)
                for key, register in (("a", a), ("b", b), ("c", c), ("d", d))
                if "{" + key + "}" in form
            }
            self._assign(d, form.format(**used))
            self.changed.add(d)

    def _add_sine(self, angle: str, sine: int, cosine: int) -> None:
        names = {sine: f"r{sine}", cosine: f"r{cosine}"}
        if self.language.declares:
            self.turns += 1
            names = {sine: f"s{self.turns}", cosine: f"c{self.turns}"}
        form = self.language.sine
        self.lines.append(form.format(a=angle, d=names[sine], c=names[cosine]))
        for register, name in names.items():
            if self.language.declares:
                self._assign(register, name)
        self.known |= names.keys()
        self.changed |= names.keys()

    def end(self, kept: Set[int]) -> None:
        """Write the registers that are kept and have changed."""
        for register in sorted(self.changed & kept):
            place = self.place(register)
            self.lines.append(self.language.store.format(place=place, value=f"r{register}"))


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
