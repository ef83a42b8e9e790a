"""Requests of the live page about mechanisms, loaded mechanisms and drafts."""

from __future__ import annotations

import json
import typing
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import linkwork as lw
from linkwork.app.live.events import ProblemsFound, Refused
from linkwork.app.live.messages import decoded, encoded, kind_of
from linkwork.app.live.opened_file import MechanismFile
from linkwork.app.live.requests import REQUESTS, Picked, Simulate
from linkwork.app.live.session import Bench
from linkwork.core.mechanism.part.index import PARTS
from linkwork.core.textfile.reader import blank_sheet
from linkwork.synthesis.solvers.solving import solve_task
from tests.campaigns.fuzzing.loads import LOADED, loaded_text, names_in
from tests.campaigns.fuzzing.odd import FORMULAS, NAMES, NUMBERS, pick
from tests.campaigns.fuzzing.texts import changed_bytes, changed_text, library_text, task_text
from tests.campaigns.fuzzing.witness import LIMIT, SHOWS_PROGRESS, Witness

__all__ = ["BENCH", "BENCH_NAMES", "BENCH_TEXTS", "messages"]

BENCH = """\
format = 1
[points]
O2 = [0, 0]
A = [35, 20]
B = [146, 66]
O4 = [100, 0]
P = [90, 90]
[links]
ground = ["O2", "O4"]
crank = ["O2", "A"]
coupler = ["A", "B", "P"]
rocker = ["O4", "B"]
[dimensions]
a = 40
[lengths]
"O2 A" = "a"
"A B" = 120
[input]
link = "crank"
from = 0
to = 360
step = 30
"""


BENCH_NAMES = (
    "O2", "A", "B", "O4", "P", "crank", "coupler", "rocker", "ground", "a", "O2 A", "A B", "B A P",
    "O4.x", "link", "sliders", "gears", "cams", "racks", "s",
)  # fmt: skip
BENCH_TEXTS = (*FORMULAS, "40", "a", "a/2", "300 rpm", *NUMBERS)
_BENCH_NUMBERS = (
    0.0, -0.0, 1.0, -5.0, 20.0, 30.0, 40.0, 60.0, 80.0, 100.0, 1e-9, 1e-300, 1e6, 1e12, 1e23,
    -1e300, 1e308,
)  # fmt: skip
_TYPED = (
    "40", "2", "-1", "0", "A", "B", "crank", "rocker", "crank, rocker", "A, B", "0, 0", "10, 20",
    "rod", "9.81 m/s^2", "t", "-500*(t < 0.1)", "rocker.velocity", "true", "x^2", "1e308", "3 in",
)  # fmt: skip
_FIELD_KEYS = tuple(dict.fromkeys(key.name for part in PARTS.values() for key in part.keys))
_QUANTITIES = (
    "crank.effort", "A.force.x", "B.force.y", "shaking.moment", "disagreement", "return.tension",
    "P.load.x", "power", "P.x", "rocker.velocity", "max(crank.effort)", "stroke(P.y)", "mu",
)  # fmt: skip


@dataclass(frozen=True)
class _Sheet:
    """The file that the requests concern, and how long they may take."""

    text: str
    names: Sequence[str]
    limit: float = LIMIT


def messages(rng: np.random.Generator, witness: Witness, folder: Path) -> None:
    """Requests to what a page has, one after the other."""
    sheet = _sheet(rng)
    path = folder / "bench.toml"
    path.write_text(sheet.text, encoding="utf-8", errors="replace")
    bench = witness.call(
        "bench", lambda: Bench(MechanismFile(path), lw.loads, solve_task), sheet.limit
    )
    if bench is None:
        return
    witness.call("opened", bench.opened, sheet.limit)
    for _ in range(int(rng.integers(1, 8))):
        _asked(witness, bench, _message(rng, sheet.names), sheet.limit)


def _sheet(rng: np.random.Generator) -> _Sheet:
    kind = rng.random()
    if kind < 0.35:
        return _Sheet(BENCH, BENCH_NAMES)
    if kind < 0.6:
        return _Sheet(LOADED, (*BENCH_NAMES, "return", "torsion", *_QUANTITIES))
    if kind < 0.65:
        return _Sheet(task_text(rng), BENCH_NAMES, SHOWS_PROGRESS)
    if kind < 0.75:
        return _Sheet(blank_sheet("Untitled"), BENCH_NAMES)
    text = library_text(rng)
    if rng.random() < 0.3:
        text = loaded_text(rng, text)
    names = [*names_in(text, "points"), *names_in(text, "links"), *_QUANTITIES]
    if rng.random() < 0.5:
        text = changed_text(rng, text)
    return _Sheet(text, [name.strip('"') for name in names], SHOWS_PROGRESS)


def _asked(witness: Witness, bench: Bench, text: str, limit: float) -> None:
    """Send a message and judge the events that answer it."""
    asked = witness.call(f"decoded {text[:200]}", lambda: decoded(text))
    if asked is None:
        return
    # simulations show their progress on every page, and can be cancelled
    limit = SHOWS_PROGRESS if isinstance(asked[0], Simulate) else limit
    events = witness.call(f"handle {text[:200]}", lambda: bench.handle(asked[0]), limit)
    for event in events or ():
        told = witness.call("encoded", partial(encoded, event))
        if told and isinstance(event, Refused | ProblemsFound):
            witness.judge_message(f"answer to {text[:200]}", told)


def _message(rng: np.random.Generator, names: Sequence[str]) -> str:
    data = _request(rng, pick(rng, REQUESTS), names)
    text = json.dumps({"id": 1, **data}, allow_nan=True)
    if rng.random() < 0.1:
        return changed_bytes(rng, text).decode("utf-8", "replace")
    return text


def _request(rng: np.random.Generator, kind: type, names: Sequence[str]) -> dict[str, Any]:
    types = typing.get_type_hints(kind)
    # a place that is picked is part of a request
    data: dict[str, Any] = {} if kind is Picked else {"kind": kind_of(kind)}
    for field in fields(kind):
        if rng.random() < 0.95:
            data[field.name] = _field(rng, field.name, types[field.name], names)
    if rng.random() < 0.03:
        data[pick(rng, NAMES)] = 1
    return data


def _field(rng: np.random.Generator, name: str, kind: Any, names: Sequence[str]) -> Any:
    """A value for a field, often one that the field knows."""
    if rng.random() < 0.8:
        if name == "table":
            return pick(rng, [*PARTS])
        if name == "typed" and typing.get_origin(kind) is dict:
            return _form(rng, names)
        if name == "of" and kind is str:
            return pick(rng, ["point", "link", "part"])
        if name == "format":
            return pick(rng, ["toml", "svg", "csv", "html", "png", "gifs", "xlsx"])
        if name in ("width", "span"):
            return pick(rng, [1.0, 20.0, 300.0])
        if name == "key":
            return pick(rng, _FIELD_KEYS)
    return _sent(rng, kind, names)


def _form(rng: np.random.Generator, names: Sequence[str]) -> dict[str, Any]:
    """What is typed into the form of a part of any kind."""
    part = pick(rng, [*PARTS.values()])
    form: dict[str, Any] = {}
    for key in part.keys:
        if rng.random() < 0.6:
            texts = [pick(rng, names if rng.random() < 0.5 else _TYPED) for _ in range(3)]
            many = rng.random() < 0.4
            form[key.name] = texts[: int(rng.integers(1, 4))] if many else texts[0]
    return form


_WRONG_TYPES: tuple[Any, ...] = (
    None, True, 3, -1, 1e308, float("nan"), "", [], {}, [[]], {"a": {}}, "x" * 2000, 10**30,
)  # fmt: skip


def _sent(rng: np.random.Generator, kind: Any, names: Sequence[str]) -> Any:
    """A value for a field of a request, mostly of its type."""
    if rng.random() < 0.02:
        return pick(rng, _WRONG_TYPES)
    origin, inner = typing.get_origin(kind), typing.get_args(kind)
    known = names if rng.random() < 0.9 else NAMES
    if origin is tuple:
        if Ellipsis not in inner:
            return [_sent(rng, part, names) for part in inner]
        return [_sent(rng, inner[0], names) for _ in range(int(rng.integers(4)))]
    if origin is dict:
        count = int(rng.integers(4))
        return {pick(rng, known): _sent(rng, inner[1], names) for _ in range(count)}
    if inner:
        return _sent(rng, pick(rng, inner), names)
    simple = {
        str: pick(rng, known) if rng.random() < 0.7 else pick(rng, (*BENCH_TEXTS, *_TYPED)),
        bool: bool(rng.integers(2)),
        int: pick(rng, [0, 1, -1, 50, 10**6, 2**53]),
        float: pick(rng, _BENCH_NUMBERS),
        type(None): None,
    }
    return simple[kind] if kind in simple else _request(rng, kind, names)
