"""Commands with odd arguments."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any

import numpy as np
from click.testing import CliRunner

from linkwork.core.commands.main import linkwork as program
from tests.campaigns.fuzzing.loads import LOADED
from tests.campaigns.fuzzing.odd import NAMES, NUMBERS, pick
from tests.campaigns.fuzzing.pages import BENCH, BENCH_NAMES, BENCH_TEXTS
from tests.campaigns.fuzzing.texts import changed_bytes, library_text, plan_text, task_text
from tests.campaigns.fuzzing.witness import SHOWS_PROGRESS, Witness

__all__ = ["command"]

_COMMANDS = (
    "check", "equations", "solve", "solve", "quantities", "sweep", "sweep", "configurations",
    "circuits", "draw", "plot", "animate", "study", "examples", "schema", "nothing", "forces",
    "forces", "new", "link", "web", "export", "export", "simulate", "sensitivity", "tolerance",
    "design", "synthesize",
)  # fmt: skip
_WRITERS = ("draw", "animate", "plot", "study", "export", "synthesize")
_SOURCES = (
    "four-bar", "four-bar", "slider-crank", "newton-another-root", "rapier-drive", "crank-shaper",
    "scotch-yoke", "belt-drive", "crank-press", "balanced-lamp", "nowhere.toml", "", ".", "-",
    "changed.toml", "bench.toml", "loaded.toml", "loaded.toml", "plan.toml", "pendulum",
    "task.toml",
)  # fmt: skip
_OUTPUTS = (
    "x.png", "x.svg", "x.pdf", "x.csv", "x.html", "x.gif", "x", ".", "/nowhere/x.png", "", "-",
    "x.zarr", "x.toml", "x.exe", "x.xlsx", "x.mjcf", "x.urdf", "x.sdf", "x.py", "x.m", "x.c",
    "x.js", "x.st", "x.tikz",
)  # fmt: skip


def command(rng: np.random.Generator, witness: Witness, folder: Path) -> None:
    """A command with odd options."""
    (folder / "bench.toml").write_text(BENCH, encoding="utf-8")
    (folder / "loaded.toml").write_text(LOADED, encoding="utf-8")
    (folder / "changed.toml").write_bytes(changed_bytes(rng, library_text(rng)))
    (folder / "plan.toml").write_bytes(plan_text(rng).encode("utf-8", "replace"))
    (folder / "task.toml").write_bytes(task_text(rng).encode("utf-8", "replace"))
    name = pick(rng, _COMMANDS)
    arguments = [name]
    if name == "study":
        arguments += ["plan.toml", "--quiet"] if rng.random() < 0.8 else [pick(rng, _SOURCES)]
    elif name == "synthesize":
        arguments.append("task.toml" if rng.random() < 0.9 else pick(rng, _SOURCES))
    elif name in ("new", "web"):
        arguments.append(pick(rng, _OUTPUTS))
    elif name not in ("schema",) and rng.random() < 0.97:
        arguments.append(pick(rng, _SOURCES))
    found = program.get_command(None, name)  # type: ignore[arg-type]  # the context is not used
    options = [] if found is None else found.params
    for _ in range(int(rng.integers(5)) if options else 0):
        arguments += _option(rng, pick(rng, options))
    if name in _WRITERS and rng.random() < 0.7:
        arguments += ["-o", pick(rng, _OUTPUTS)]
    if rng.random() < 0.1:
        arguments.insert(
            int(rng.integers(len(arguments))), pick(rng, [*NAMES, "--", "-x", "--json=1"])
        )
    typed = " ".join(map(repr, arguments))
    runner = CliRunner()
    with contextlib.chdir(folder):
        ended = witness.call(
            typed, lambda: runner.invoke(program, arguments, input="format = 1"), SHOWS_PROGRESS
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
        return [flag, f"{pick(rng, BENCH_NAMES)}={pick(rng, BENCH_TEXTS)}"]
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
        pick(rng, [*BENCH_NAMES, *NAMES, *NUMBERS, "curves", "path", "light", "stop", "turn"]),
    ]
