"""Recorded arithmetic printed in a language."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field

import numpy as np

from linkwork.core.record.recorder import LANES, ROLES, Code, Op

# ----------------------------------------------------------------------
# The languages in which programs are printed: a form for each instruction.


@dataclass(frozen=True, kw_only=True)
class Language:
    """How statements are written.

    Parameters
    ----------
    forms : Mapping[Op, str]
        Expressions of the arguments a, b, c and of the target's present value d.
    first, later : str
        The first and any later assignment of ``{value}`` to a ``{name}``.
    store : str
        Writes a ``{value}`` to a ``{place}``.
    sine : str
        Sine ``{d}`` and cosine ``{c}`` of ``{a}``, as assignments of two names.
    function : str
        A function with a ``{name}``, ``{arguments}`` and a ``{body}`` of statements.
    argument : str
        An array handed to a function.
    between : str
        Between two statements.
    not_a_number, infinity : str
    """

    forms: Mapping[Op, str]
    first: str
    later: str
    store: str
    sine: str
    function: str
    argument: str
    between: str
    not_a_number: str
    infinity: str
    declares: bool = False
    typed: bool = True

    def written(self, name: str, arguments: Sequence[str], statements: Sequence[str]) -> str:
        """A function of arrays."""
        taken = ", ".join(self.argument.format(name=argument) for argument in arguments)
        body = self.between.join(statements)
        return self.function.format(name=name, arguments=taken, body=body)

    def number(self, value: float) -> str:
        """A number, by all its digits."""
        if math.isnan(value):
            return self.not_a_number
        if math.isinf(value):
            return self.infinity if value > 0.0 else f"(-{self.infinity})"
        text = repr(value) if self.typed else repr(value).removesuffix(".0")
        return text if math.copysign(1.0, value) > 0.0 else f"({text})"


_COMMON = {
    Op.COPY: "{a}",
    Op.ADD: "{a} + {b}",
    Op.SUB: "{a} - {b}",
    Op.MUL: "{a} * {b}",
    Op.DIV: "{a} / {b}",
    Op.FMA: "{a} * {b} + {c}",
    Op.FMS: "{a} * {b} - {c}",
    Op.FNMA: "{c} - {a} * {b}",
    Op.NEG: "-{a}",
    Op.AND: "{a} * {b}",
    Op.LESS: "{d} - {a}",
}
# the zero turns -0.0, which depends on the order of terms, into 0.0: half a turn is π then
PYTHON = Language(
    forms=_COMMON
    | {
        Op.ABS: "abs({a})",
        Op.MAX: "{a} if ({a} > {b}) | ({a} != {a}) else {b}",
        Op.MIN: "{a} if ({a} < {b}) | ({a} != {a}) else {b}",
        Op.SQRT: "math.sqrt({a})",
        Op.WHERE: "{b} if {a} > 0.5 else {c}",
        Op.LE: "1.0 if {a} <= {b} else 0.0",
        Op.KEEP: "{b} if {a} > 0.5 else {d}",
        Op.ATAN2: "math.atan2({a} + 0.0, {b})",
    },
    first="{name} = {value}",
    later="{name} = {value}",
    store="{place} = {value}",
    sine="{d}, {c} = sin_cos({a})",
    function="def {name}({arguments}):\n    {body}\n",
    argument="{name}",
    between="\n    ",
    not_a_number="math.nan",
    infinity="math.inf",
)
# languages with the operators of C; KEEP and WHERE as in Python
_OF_C = _COMMON | {
    Op.MAX: "{a} > {b} || {a} != {a} ? {a} : {b}",
    Op.MIN: "{a} < {b} || {a} != {a} ? {a} : {b}",
    Op.WHERE: "{a} > 0.5 ? {b} : {c}",
    Op.LE: "{a} <= {b} ? 1 : 0",
    Op.KEEP: "{a} > 0.5 ? {b} : {d}",
}
#: Without contraction (``-ffp-contract=off``) C gives the numbers of the other languages.
C = Language(
    forms=_OF_C | {Op.ABS: "fabs({a})", Op.SQRT: "sqrt({a})", Op.ATAN2: "atan2({a} + 0.0, {b})"},
    first="double {name} = {value};",
    later="{name} = {value};",
    store="{place} = {value};",
    sine="double {d}, {c}; sin_cos({a}, &{d}, &{c});",
    function="static void {name}({arguments}) {{\n    {body}\n}}\n",
    argument="double *{name}",
    between="\n    ",
    not_a_number="NAN",
    infinity="INFINITY",
    declares=True,
)
JAVASCRIPT = Language(
    forms={op: form.replace(" ", "") for op, form in _OF_C.items()}
    | {Op.ABS: "abs({a})", Op.SQRT: "sqrt({a})", Op.ATAN2: "atan2({a}+0,{b})"},
    first="var {name}={value};",
    later="{name}={value};",
    store="{place}={value};",
    sine="sinCos({a});var {d}=turn[0],{c}=turn[1];",
    function="function {name}({arguments}){{{body}}}\n",
    argument="{name}",
    between="",
    not_a_number="NaN",
    infinity="Infinity",
    typed=False,
)


# ----------------------------------------------------------------------
# Programs written out as source text of a language: one statement for each instruction.
#
# The code names registers only, so no text of a mechanism's file gets into it.


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

from linkwork.families.compiled.compiling import trial_at
from linkwork.families.compiled.interpreter import (sin_cos)


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
