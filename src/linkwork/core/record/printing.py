"""Recorded arithmetic written as Python statements, for floats or for arrays.

A value that is used once is written where it is used. Arrays that are no longer needed give their
name, and so their memory, to the next one. Code is kept in the user's cache: writing it takes some
milliseconds a shape.
"""

from __future__ import annotations

import hashlib
import importlib.util
import marshal
import math
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import CodeType
from typing import Any

import numpy as np

from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import cache_folder, save_bytes
from linkwork.core.record.recorder import LANES, ROLES, Code, Op, Recorder

_LONGEST = 120  # characters of an expression that is written where it is used

_COMMON_NAMES = {
    Op.ADD: "{0} + {1}",
    Op.SUB: "{0} - {1}",
    Op.MUL: "{0} * {1}",
    Op.DIV: "{0} / {1}",
    Op.NEG: "-{0}",
    Op.ABS: "abs({0})",
    Op.SQRT: "sqrt({0})",
    Op.SIN: "sin({0})",
    Op.COS: "cos({0})",
    Op.LE: "{0} <= {1}",
    Op.CALL: "{1}({0})",
    Op.PART: "{0}[{1}]",
}


@dataclass(frozen=True)
class Form:
    """Expressions of instructions; ``repeated``: those that name an argument twice.

    ``names``: the functions that expressions use.
    """

    name: str
    expressions: Mapping[Op, str]
    repeated: frozenset[Op]
    names: Mapping[str, object]

    def function(self, code: CodeType, name: str) -> Callable[..., Any]:
        """The function that a code defines."""
        space = dict(self.names)
        exec(code, space)
        found: Callable[..., Any] = space[name]  # type: ignore[assignment]
        return found


FLOATS = Form(
    "floats",
    _COMMON_NAMES
    | {
        Op.MAX: "{0} if {0} > {1} or {0} != {0} else {1}",
        Op.MIN: "{0} if {0} < {1} or {0} != {0} else {1}",
        Op.WHERE: "{1} if {0} else {2}",
        Op.AND: "{0} and {1}",
    },
    frozenset({Op.MAX, Op.MIN}),
    {"sin": math.sin, "cos": math.cos, "sqrt": math.sqrt, "inf": math.inf, "nan": math.nan},
)
ARRAYS = Form(
    "arrays",
    _COMMON_NAMES
    | {
        Op.MAX: "maximum({0}, {1})",
        Op.MIN: "minimum({0}, {1})",
        Op.WHERE: "where({0}, {1}, {2})",
        Op.AND: "{0} & {1}",
    },
    frozenset(),
    {
        "sin": np.sin, "cos": np.cos, "sqrt": np.sqrt, "maximum": np.maximum,
        "minimum": np.minimum, "where": np.where, "inf": math.inf, "nan": math.nan,
    },
)  # fmt: skip


class Statements:
    """The statements of a recording, stage by stage.

    Parameters
    ----------
    recorder : Recorder
    form : Form
    stages : sequence of sequences of int
        The values that each stage has to have computed.
    """

    def __init__(self, recorder: Recorder, form: Form, stages: Sequence[Sequence[int]]) -> None:
        self._ops, self._payload, self._form = recorder.ops, recorder.payload, form
        self._arguments = recorder.arguments
        self._order: list[list[int]] = []
        seen: set[int] = set()
        for stage in stages:
            needed = self._needed(stage) - seen
            seen |= needed
            self._order.append(sorted(needed))
        self._outputs = {k for stage in stages for k in stage}
        self._written: dict[int, str] = {}
        self._leaves: dict[int, tuple[int, ...]] = {}
        self._count = 0
        self._free: list[str] = []
        self._named = self._choose_names(seen)

    def _sources(self, k: int) -> tuple[int, ...]:
        if self._ops[k] is Op.COS:  # of the angle of its sine
            return self._arguments[self._arguments[k][0]]
        return self._arguments[k]

    def _needed(self, values: Iterable[int]) -> set[int]:
        found, stack = set[int](), list(values)
        while stack:
            k = stack.pop()
            if k not in found:
                found.add(k)
                stack += self._sources(k)
        return found

    def _choose_names(self, needed: set[int]) -> set[int]:
        """The values that get a name: outputs, and those that are used more than once."""
        uses = dict.fromkeys(needed, 0)
        for k in needed:
            for a in self._sources(k):
                uses[a] += 2 if self._ops[k] in self._form.repeated else 1
        plain = (Op.INPUT, Op.CONSTANT)
        return {
            k for k in needed if self._ops[k] not in plain and (uses[k] > 1 or k in self._outputs)
        }

    def stage(self, number: int) -> list[str]:
        """The statements that compute the values of a stage."""
        lines: list[str] = []
        last = self._last_uses(number)
        for k in self._order[number]:
            text = self._expression(k)
            inline = k not in self._named and len(text) < _LONGEST
            if self._ops[k] in (Op.INPUT, Op.CONSTANT):
                self._written[k], self._leaves[k] = text, ()
                continue
            leaves = {x for a in self._sources(k) for x in self._leaves[a]}
            if inline:
                call = self._ops[k] in (Op.ABS, Op.SQRT, Op.SIN, Op.COS, Op.CALL, Op.PART)
                self._written[k] = text if call else f"({text})"
                self._leaves[k] = tuple(leaves)
                continue
            if self._form is ARRAYS:
                for x in leaves:
                    if last.get(x, -1) == k:
                        self._free.append(self._written[x])
            if self._free:
                name = self._free.pop()
            else:
                name, self._count = f"a{self._count}", self._count + 1
            lines.append(f"{name} = {text}")
            self._written[k], self._leaves[k] = name, (k,)
        return lines

    def _last_uses(self, number: int) -> dict[int, int]:
        """After which named value of the last stage the name of another one is free."""
        if number + 1 < len(self._order):  # later stages may use it
            return {}
        # where a value without a name ends up: the first named value that contains it
        ends: dict[int, int] = {}
        users: dict[int, list[int]] = {}
        for k in self._order[number]:
            for a in self._sources(k):
                users.setdefault(a, []).append(k)
        for k in reversed(self._order[number]):
            if k in self._named or self._ops[k] in (Op.INPUT, Op.CONSTANT):
                ends[k] = k
            else:  # written where it is used, or under a name of its own if it is long
                ends[k] = max([ends[user] for user in users.get(k, [k]) if user != k], default=k)
        last = {}
        for k in self._named - self._outputs:
            if k in users:
                last[k] = max(ends[user] for user in users[k])
        return last

    def _expression(self, k: int) -> str:
        op, payload = self._ops[k], self._payload[k]
        if op is Op.INPUT:
            return local_name(str(payload))
        if op is Op.CONSTANT:
            return _number(float(payload))  # type: ignore[arg-type]
        parts = [self._written[a] for a in self._sources(k)]
        if op in (Op.CALL, Op.PART):
            parts.append(local_name(str(payload)))
        return self._form.expressions[op].format(*parts)

    def text(self, value: int) -> str:
        """The name or expression of a value that a stage has computed."""
        return self._written[value]


def local_name(name: str) -> str:
    """The local variable of a register."""
    return name.replace(".", "_")


def _number(x: float) -> str:
    if math.isnan(x):
        return "nan"
    if math.isinf(x):
        return "inf" if x > 0.0 else "(-inf)"
    return repr(x) if x >= 0.0 and math.copysign(1.0, x) > 0.0 else f"({x!r})"


# ----------------------------------------------------------------------
# Code kept in the user's cache.


_DIGEST = 32  # bytes


@cache
def _version() -> bytes:
    """A digest of all that decides how functions are written: code of another one is not used."""
    digest = hashlib.sha256(importlib.util.MAGIC_NUMBER)
    here = Path(__file__).parent
    constants = (here.parent / "foundation" / name for name in ("arrays.py", "statuses.py"))
    for source in (*sorted(here.glob("*.py")), *constants):  # numbers are printed, too
        digest.update(source.read_bytes())
    return digest.digest()


class KeptCode:
    """The code of a shape's functions; ``key`` tells shapes apart."""

    def __init__(self, key: str) -> None:
        self._key = key
        self._path: Path | None = None
        self._codes: dict[str, CodeType] | None = None

    def get(self, name: str, write: Callable[[], str]) -> CodeType:
        """The code of a function; ``write`` gives its source if it is not kept yet."""
        if self._codes is None:
            self._codes = self._read()
        code = self._codes.get(name)
        if code is None:
            code = self._codes[name] = compile(write(), f"<{name}>", "exec")
            self._keep()
        return code

    def _read(self) -> dict[str, CodeType]:
        if sys.platform == "emscripten":  # nothing lasts longer than the page
            return {}
        with suppress(OSError, RuntimeError):  # RuntimeError: no home
            digest = hashlib.sha256(_version() + self._key.encode()).hexdigest()[:_DIGEST]
            self._path = cache_folder("functions") / f"{digest}.bin"
            held = self._path.read_bytes()
            check, data = held[:_DIGEST], held[_DIGEST:]
            if hashlib.sha256(data).digest() == check:
                found: dict[str, CodeType] = marshal.loads(data)
                return found
        return {}

    def _keep(self) -> None:
        if self._path is None:
            return
        data = marshal.dumps(self._codes)
        with suppress(OSError, InputError):
            self._path.parent.mkdir(parents=True, exist_ok=True)
            save_bytes(hashlib.sha256(data).digest() + data, self._path)


# ----------------------------------------------------------------------
# Recorded arithmetic printed in a language.


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
