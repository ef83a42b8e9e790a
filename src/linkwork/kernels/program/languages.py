"""The languages in which programs are printed: a form for each instruction."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from linkwork.kernels.program.program import Op

__all__ = ["JAVASCRIPT", "PYTHON", "C", "Language"]


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
