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
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import CodeType
from typing import Any

import numpy as np

from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.files import cache_folder, save_bytes
from linkwork.core.record.recorder import Op, Recorder

_LONGEST = 120  # characters of an expression that is written where it is used

_COMMON = {
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
    _COMMON
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
    _COMMON
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
    constants = (here.parent / "foundation" / name for name in ("rounding.py", "statuses.py"))
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
