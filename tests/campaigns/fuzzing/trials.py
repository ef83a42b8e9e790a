"""One random input of every kind, loaded and, where it loads, solved."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

import linkwork as lw
from linkwork.families.study import read_plan, run_study
from tests.campaigns.fuzzing.commands import command
from tests.campaigns.fuzzing.loads import LOADED, loaded_text
from tests.campaigns.fuzzing.odd import pick
from tests.campaigns.fuzzing.pages import messages
from tests.campaigns.fuzzing.python_calls import python_call
from tests.campaigns.fuzzing.texts import (
    changed_bytes,
    changed_text,
    equation_text,
    library_text,
    plan_text,
    task_text,
)
from tests.campaigns.fuzzing.witness import SHOWS_PROGRESS, Witness

__all__ = ["KINDS", "trial"]

_MOST_ROWS = 40  # of sweeps tried
_MOST_DESIGNS = 40
_RANGES = ((0, 30), (0, 30), (1e6, 10), (-1e9, 60), (1e300, 1), (0, 1e-9), (3, 1))


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
        lambda: mechanism.sweep(from_=first, to=first + 6 * step, step=step),
        SHOWS_PROGRESS,
    )
    if rng.random() < 0.3:
        call("check", lambda: repr(mechanism.check()))
        call("equations", lambda: repr(mechanism.equations()))
    rows = call("rows", lambda: len(mechanism.model.rows_in_file_units))
    if rows is not None and rows <= 2 * _MOST_ROWS:
        motion = call("sweep of the file", mechanism.sweep, SHOWS_PROGRESS)
        if motion is not None:
            call("repr of a motion", lambda: repr(motion))
    if rng.random() < 0.02:
        call("configurations", lambda: repr(mechanism.configurations()), SHOWS_PROGRESS)
    if rng.random() < 0.01:
        call("circuits", lambda: repr(mechanism.circuits()), SHOWS_PROGRESS)


def _loads(rng: np.random.Generator, witness: Witness, folder: Path) -> None:
    """A mechanism with masses, loads, springs and questions: its forces and questions."""
    text = loaded_text(rng, library_text(rng)) if rng.random() < 0.6 else LOADED
    if text == LOADED or rng.random() < 0.4:
        text = changed_text(rng, text)
    mechanism = witness.call("loads", lambda: lw.loads(text))
    if mechanism is None:
        return
    witness.counts["files that load"] += 1
    call = witness.call
    call("repr", lambda: repr(mechanism))
    at = pick(rng, [None, 0, 30, 60, 90, 1e6, 1e300])
    found = [call(f"forces at {at}", lambda: mechanism.forces(at=at), SHOWS_PROGRESS)]
    rows = call("rows", lambda: len(mechanism.model.rows_in_file_units))
    if rows is not None and rows <= 2 * _MOST_ROWS:
        motion = call("sweep of the file", mechanism.sweep, SHOWS_PROGRESS)
        if motion is not None:
            call("questions", lambda: repr(motion.skeleton.questions))
            found.append(call("forces", lambda: mechanism.forces(motion=motion), SHOWS_PROGRESS))
    for reactions in found:
        if reactions is not None:
            call("repr of forces", partial(repr, reactions))
            call("table of forces", reactions.table)
            for name in reactions.efforts:
                call(f"effort {name}", partial(reactions.__getitem__, name))


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
            lambda: repr(run_study(study, store, workers=1, force=store.exists())),
            SHOWS_PROGRESS,
        )


def _task(rng: np.random.Generator, witness: Witness, folder: Path) -> None:
    """A task of synthesis and its designs."""
    text = task_text(rng)
    task = witness.call("Task.loads", lambda: lw.Task.loads(text))
    if task is None:
        return
    witness.counts["tasks that load"] += 1
    witness.call("repr of a task", lambda: repr(task))
    found = witness.call("Task.solve", task.solve, SHOWS_PROGRESS)
    if found is not None:
        witness.call("repr of a synthesis", lambda: repr(found))
        witness.call("table of designs", lambda: len(found.table()))
        witness.call("save", lambda: found.save(folder / "designs", refused=True))


def _call(rng: np.random.Generator, witness: Witness, folder: Path) -> None:
    with contextlib.chdir(folder):
        python_call(rng, witness)


Trial = Callable[[np.random.Generator, Witness, Path], None]
#: What is tried, and its share.
KINDS: dict[str, tuple[Trial, float]] = {
    "files": (_file, 0.3),
    "loads": (_loads, 0.15),
    "equations": (_equations, 0.15),
    "plans": (_plan, 0.05),
    "tasks": (_task, 0.05),
    "messages": (messages, 0.15),
    "commands": (command, 0.05),
    "Python calls": (_call, 0.1),
}


def trial(number: int, folder: Path) -> Witness:
    """The outcome of the input of a number; the same number gives the same input."""
    rng = np.random.default_rng([60, number])
    shares = [share for _, share in KINDS.values()]
    kind = [*KINDS][int(rng.choice(len(shares), p=shares))]
    witness = Witness()
    witness.counts[f"inputs: {kind}"] += 1
    KINDS[kind][0](rng, witness, folder)
    return witness
