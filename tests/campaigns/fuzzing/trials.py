"""One random input of every kind, loaded and, where it loads, solved."""

from __future__ import annotations

import contextlib
import json
import typing
from collections.abc import Callable
from dataclasses import fields
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from click.testing import CliRunner

import linkwork as lw
from linkwork.batch.study import read_plan, run_study
from linkwork.cli.main import linkwork as program
from linkwork.viewer.live.events import ProblemsFound, Refused
from linkwork.viewer.live.mechanism_file import MechanismFile
from linkwork.viewer.live.messages import decoded, encoded, kind_of
from linkwork.viewer.live.requests import REQUESTS
from linkwork.viewer.live.workbench import Workbench
from tests.campaigns.fuzzing.odd import FORMULAS, NAMES, NUMBERS, pick
from tests.campaigns.fuzzing.python_calls import python_call
from tests.campaigns.fuzzing.texts import (
    changed_bytes,
    changed_text,
    equation_text,
    library_text,
    plan_text,
)
from tests.campaigns.fuzzing.witness import Witness

__all__ = ["KINDS", "trial"]

_MOST_ROWS = 40  # of sweeps tried
_MOST_DESIGNS = 40
_RANGES = ((0, 30), (0, 30), (1e6, 10), (-1e9, 60), (1e300, 1), (0, 1e-9), (3, 1))
#: Calls that may take longer because they show progress.
_SHOWS_PROGRESS = 30.0


def _file(rng: np.random.Generator, witness: Witness, folder: Path) -> None:
    text = library_text(rng)
    if rng.random() < 0.2:
        path = folder / "changed.toml"
        path.write_bytes(changed_bytes(rng, text))
        mechanism = witness.call("load", lambda: lw.load(path))
    else:
        changed = changed_text(rng, text)
        mechanism = witness.call("loads", lambda: lw.loads(changed))
    if mechanism is not None:
        _solved(rng, witness, mechanism)


def _equations(rng: np.random.Generator, witness: Witness, folder: Path) -> None:
    text = equation_text(rng)
    mechanism = witness.call("loads", lambda: lw.loads(text))
    if mechanism is not None:
        _solved(rng, witness, mechanism)


def _solved(rng: np.random.Generator, witness: Witness, mechanism: lw.Mechanism) -> None:
    """Solve a mechanism that loads, and follow a short table."""
    witness.counts["files that load"] += 1
    call = witness.call
    call("repr", lambda: repr(mechanism))
    position = call("solve", mechanism.solve)
    if position is not None:
        call("repr of a position", lambda: repr(position))
    first, step = pick(rng, _RANGES)
    call(
        f"sweep from {first}",
        lambda: mechanism.sweep(start=first, stop=first + 6 * step, step=step),
        _SHOWS_PROGRESS,
    )
    if rng.random() < 0.3:
        call("check", lambda: repr(mechanism.check()))
        call("equations", lambda: repr(mechanism.equations()))
    rows = call("rows", lambda: len(mechanism.model.rows_in_file_units))
    if rows is not None and rows <= 2 * _MOST_ROWS:
        motion = call("sweep of the file", mechanism.sweep, _SHOWS_PROGRESS)
        if motion is not None:
            call("repr of a motion", lambda: repr(motion))
    if rng.random() < 0.02:
        call("configurations", lambda: repr(mechanism.configurations()), _SHOWS_PROGRESS)
    if rng.random() < 0.01:
        call("circuits", lambda: repr(mechanism.circuits()), _SHOWS_PROGRESS)


def _plan(rng: np.random.Generator, witness: Witness, folder: Path) -> None:
    path = folder / "plan.toml"
    path.write_bytes(plan_text(rng).encode("utf-8", "replace"))
    study = witness.call("read_plan", lambda: read_plan(path))
    if study is None:
        return
    witness.call("repr of a study", lambda: repr(study))
    small = study.plan.count <= _MOST_DESIGNS and study.chunks <= _MOST_DESIGNS
    if small and len(study.model.rows_in_file_units) <= _MOST_ROWS and rng.random() < 0.3:
        store = folder / "store.zarr"
        witness.call(
            "run_study",
            lambda: repr(run_study(study, store, workers=1, fresh=store.exists())),
            _SHOWS_PROGRESS,
        )


_BENCH = """\
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


def _messages(rng: np.random.Generator, witness: Witness, folder: Path) -> None:
    path = folder / "bench.toml"
    path.write_text(_BENCH, encoding="utf-8")
    bench = witness.call("workbench", lambda: Workbench(MechanismFile(path), lw.loads))
    for _ in range(int(rng.integers(1, 5))):
        if bench is not None:
            _asked(witness, bench, _message(rng))


def _asked(witness: Witness, bench: Workbench, text: str) -> None:
    """Send a message and judge the events that answer it."""
    asked = witness.call(f"decoded {text[:200]}", lambda: decoded(text))
    if asked is None:
        return
    events = witness.call(f"handle {text[:200]}", lambda: bench.handle(asked[0]))
    for event in events or ():
        told = witness.call("encoded", partial(encoded, event))
        if told and isinstance(event, Refused | ProblemsFound):
            witness.judge_message(f"answer to {text[:200]}", told)


def _message(rng: np.random.Generator) -> str:
    data = _request(rng, pick(rng, REQUESTS))
    text = json.dumps({"id": 1, **data}, allow_nan=True)
    if rng.random() < 0.2:
        return changed_bytes(rng, text).decode("utf-8", "replace")
    return text


def _request(rng: np.random.Generator, kind: type) -> dict[str, Any]:
    types = typing.get_type_hints(kind)
    data: dict[str, Any] = {"kind": kind_of(kind)}
    for field in fields(kind):
        if rng.random() < 0.93:
            data[field.name] = _sent(rng, types[field.name])
    if rng.random() < 0.03:
        data[pick(rng, NAMES)] = 1
    return data


_BENCH_NAMES = ("O2", "A", "B", "O4", "P", "crank", "coupler", "rocker", "ground", "a", "O2 A",
    "A B",
                "B A P", "O4.x", "link", "sliders", "gears", "cams", "racks", "s")  # fmt: skip
_BENCH_NUMBERS = (0.0, -0.0, 1.0, -5.0, 30.0, 60.0, 1e-9, 1e-300, 1e6, 1e12, 1e23, -1e300, 1e308)
_BENCH_TEXTS = (*FORMULAS, "40", "a", "a/2", "300 rpm", *NUMBERS)


def _sent(rng: np.random.Generator, kind: Any) -> Any:
    """A value for a field of a request, mostly of its type."""
    if rng.random() < 0.03:
        return pick(
            rng,
            [
                None,
                True,
                3,
                -1,
                1e308,
                float("nan"),
                "",
                [],
                {},
                [[]],
                {"a": {}},
                "x" * 2000,
                10**30,
            ],
        )
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    names = _BENCH_NAMES if rng.random() < 0.85 else NAMES
    if origin is tuple:
        return [_sent(rng, parts[0]) for _ in range(int(rng.integers(4)))]
    if origin is dict:
        return {pick(rng, names): _sent(rng, parts[1]) for _ in range(int(rng.integers(4)))}
    if parts:
        return _sent(rng, pick(rng, parts))
    if kind is str:
        return pick(rng, names) if rng.random() < 0.7 else pick(rng, _BENCH_TEXTS)
    if kind is bool:
        return bool(rng.integers(2))
    if kind is int:
        return pick(rng, [0, 1, -1, 50, 10**6, 2**53])
    if kind is float:
        return pick(rng, _BENCH_NUMBERS)
    return None if kind is type(None) else _request(rng, kind)


_COMMANDS = ("check", "equations", "solve", "solve", "quantities", "sweep", "sweep",
    "configurations", "circuits",
             "draw", "plot", "animate", "study", "examples", "schema", "nothing")  # fmt: skip
_SOURCES = ("four-bar", "four-bar", "slider-crank", "newton-another-root", "rapier-drive",
    "crank-shaper", "scotch-yoke",
            "belt-drive", "nowhere.toml", "", ".", "-", "changed.toml", "bench.toml",
            "plan.toml")  # fmt: skip
_OUTPUTS = ("x.png", "x.svg", "x.pdf", "x.csv", "x.html", "x.gif", "x", ".", "/nowhere/x.png",
    "", "-", "x.zarr",
            "x.toml", "x.exe")  # fmt: skip


def _command(rng: np.random.Generator, witness: Witness, folder: Path) -> None:
    (folder / "bench.toml").write_text(_BENCH, encoding="utf-8")
    (folder / "changed.toml").write_bytes(changed_bytes(rng, library_text(rng)))
    (folder / "plan.toml").write_bytes(plan_text(rng).encode("utf-8", "replace"))
    name = pick(rng, _COMMANDS)
    arguments = [name]
    if name == "study":
        arguments += ["plan.toml", "--quiet"] if rng.random() < 0.8 else [pick(rng, _SOURCES)]
    elif name not in ("schema",) and rng.random() < 0.97:
        arguments.append(pick(rng, _SOURCES))
    command = program.get_command(None, name)  # type: ignore[arg-type]  # the context is not used
    options = [] if command is None else command.params
    for _ in range(int(rng.integers(5)) if options else 0):
        arguments += _option(rng, pick(rng, options))
    if name in ("draw", "animate", "plot", "study") and rng.random() < 0.7:
        arguments += ["-o", pick(rng, _OUTPUTS)]
    if rng.random() < 0.1:
        arguments.insert(
            int(rng.integers(len(arguments))), pick(rng, [*NAMES, "--", "-x", "--json=1"])
        )
    typed = " ".join(map(repr, arguments))
    runner = CliRunner()
    with contextlib.chdir(folder):
        ended = witness.call(
            typed, lambda: runner.invoke(program, arguments, input="format = 1"), _SHOWS_PROGRESS
        )
    if ended is None:
        return
    if ended.exit_code not in (0, 1, 2) or not isinstance(ended.exception, SystemExit | None):
        witness.false.append(
            f"{typed}: exit {ended.exit_code}: {ended.output[-300:]!r} {ended.exception!r}"
        )
        witness.counts["internal errors of commands"] += 1
    elif ended.exit_code:
        witness.judge_message(typed, ended.output)


def _option(rng: np.random.Generator, parameter: Any) -> list[str]:
    if not parameter.opts[0].startswith("-") or parameter.name in (
        "help",
        "debug",
        "scheduler",
        "workers",
    ):
        return []
    flag = pick(rng, parameter.opts)
    if parameter.is_flag:
        return [flag]
    if parameter.name in ("output", "csv", "xlsx", "picture", "plot", "draw", "store"):
        return [flag, pick(rng, _OUTPUTS)]
    if parameter.name == "changes":
        return [flag, f"{pick(rng, _BENCH_NAMES)}={pick(rng, _BENCH_TEXTS)}"]
    if parameter.name == "step":
        return [
            flag,
            pick(rng, ["10", "30", "0", "-10", "nan", "inf", "1e300", "x", "1e-300", "1/0"]),
        ]
    if parameter.name in ("start", "stop", "at"):
        return [
            flag,
            pick(
                rng, ["0", "90", "360", "a=1", "theta2=9", "x", "1e6", "1e300", "nan", "-inf", ""]
            ),
        ]
    if parameter.name == "forces":
        return [
            flag,
            pick(rng, ["A=0,1 N", "B=1e308,-1e308", "A", "A=1", "Z=1,1 N", "A=nan,1", "=1,2"]),
        ]
    if parameter.name in ("fps", "rows"):
        return [flag, pick(rng, ["1", "3", "0", "-1", "nan", "1e9", "x", "24.5"])]
    return [
        flag,
        pick(rng, [*_BENCH_NAMES, *NAMES, *NUMBERS, "curves", "path", "light", "stop", "turn"]),
    ]


def _call(rng: np.random.Generator, witness: Witness, folder: Path) -> None:
    with contextlib.chdir(folder):
        python_call(rng, witness)


Trial = Callable[[np.random.Generator, Witness, Path], None]
#: What is tried, and its share.
KINDS: dict[str, tuple[Trial, float]] = {
    "files": (_file, 0.45),
    "equations": (_equations, 0.2),
    "plans": (_plan, 0.1),
    "messages": (_messages, 0.1),
    "commands": (_command, 0.05),
    "Python calls": (_call, 0.1),
}


def trial(number: int, folder: Path) -> Witness:
    """The outcome of the input of a number; the same number gives the same input."""
    rng = np.random.default_rng([59, number])
    shares = [share for _, share in KINDS.values()]
    kind = [*KINDS][int(rng.choice(len(shares), p=shares))]
    witness = Witness()
    witness.counts[f"inputs: {kind}"] += 1
    KINDS[kind][0](rng, witness, folder)
    return witness
