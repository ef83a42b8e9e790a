"""Programs written out as source text of a language: one statement for each instruction.

The code names registers only, so no text of a mechanism's file gets into it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field

import numpy as np

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
    names: dict[int, str] = field(default_factory=dict)
    changed: set[int] = field(default_factory=set)
    turns: int = 0

    def value(self, register: int) -> str:
        """The expression that a register holds now."""
        if register in self.constants:
            return self.language.number(self.constants[register])
        if register not in self.names:
            self._assign(register, self.place(register))
        return self.names[register]

    def _name(self, register: int) -> str:
        """The name of a register, short: there are many of them."""
        name = f"r{np.base_repr(len(self.names), 36).lower()}"
        return self.names.setdefault(register, name)

    def _assign(self, register: int, value: str) -> None:
        form = self.language.later if register in self.names else self.language.first
        self.lines.append(form.format(name=self._name(register), value=value))

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
        form, own = self.language.sine, (sine, cosine)
        if self.language.declares:
            self.turns += 1
            pair = f"s{self.turns}", f"c{self.turns}"
            self.lines.append(form.format(a=angle, d=pair[0], c=pair[1]))
            for register, name in zip(own, pair, strict=True):
                self._assign(register, name)
        else:
            self.lines.append(form.format(a=angle, d=self._name(sine), c=self._name(cosine)))
        self.changed.update(own)

    def end(self, kept: Set[int]) -> None:
        """Write the registers that are kept and have changed."""
        for register in sorted(self.changed & kept):
            place = self.place(register)
            self.lines.append(self.language.store.format(place=place, value=self.names[register]))


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
