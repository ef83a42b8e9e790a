"""The designs of the task under edit: solved once, ended when a newer change waits."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from linkwork.app.live.answers import GivenUpError, Hurry
from linkwork.app.live.file_state import ProblemShown
from linkwork.app.live.opened_file import Events
from linkwork.app.live.task_events import TaskUnsolved
from linkwork.app.task.designs import alike, design_found, task_solved
from linkwork.app.task.edits import TaskSketch
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.errors import InputError, MechanismError, Problem, key_text
from linkwork.core.textfile.toml_text import data_of
from linkwork.synthesis.defects.verdicts import JudgedDesign
from linkwork.synthesis.solvers.result import Synthesis, SynthesizedDesign
from linkwork.synthesis.solvers.solving import near_misses
from linkwork.synthesis.tasks.task import Task
from linkwork.synthesis.tasks.task_file import located_task_error, read_task_text

_WHILE_DRAGGED = 0.12  # a task that takes longer is solved when the drag ends [s]
_NOT_LOADED = "Data of the solver cannot be loaded: check the connection, then solve again."
_CANCELLED = "The search was ended: no designs are shown."


class SolveTask(Protocol):
    """All designs for a task; ``progress`` may raise an error to end the search."""

    def __call__(
        self, task: Task, *, progress: Callable[[float], None] | None = None
    ) -> Synthesis: ...


@dataclass(frozen=True, kw_only=True)
class _Chosen:
    """The design that the visitor looks at, identified after a change by its pivots."""

    kind: str
    drive: str
    pivots: ComplexArray

    @classmethod
    def of(cls, design: JudgedDesign) -> _Chosen | None:
        if not isinstance(design, SynthesizedDesign):
            return None  # other starts find other designs: the best one is shown
        loops, k = design.group.candidates, design.index
        ends = [loops.fixed_a[k], loops.fixed_b[k], loops.moving_a[k, 0], loops.moving_b[k, 0]]
        return cls(kind=loops.kind.value, drive=design.drive.value, pivots=np.array(ends))


class TaskCycle:
    """A task, complete or not, with the events that show its designs.

    Parameters
    ----------
    solve : callable
    name : str
        The name of its file, for messages.
    folder : Path
        Where files are that the task names.

    Attributes
    ----------
    sketch : TaskSketch
    owed : bool
        Whether a search was ended and no other has been sent since.
    hurried : callable
        Whether a newer change is waiting, which ends a search.
    working : callable
        Called with the finished fraction of a search.
    """

    def __init__(self, solve: SolveTask, name: str, folder: Path) -> None:
        self.hurried: Callable[[], int] = lambda: Hurry.NONE
        self.working: Callable[[float], None] = lambda fraction: None
        self.owed = False
        self._solve, self._name, self._folder = solve, name, folder
        self._synthesis: Synthesis | None = None
        self._chosen: _Chosen | None = None
        self._index: int | None = None
        self._took = 0.0  # the last search [s]
        self.sketch = TaskSketch(tables={}, task=None, problems=())

    def take(self, text: str) -> None:
        """Continue with a changed text."""
        self._synthesis, self.owed = None, False
        tables, task = self.sketch.tables, None
        problems: tuple[ProblemShown, ...] = ()
        try:
            tables = data_of(text, self._name)  # else the canvas stays as it was
            task = read_task_text(text, self._name, self._folder)
        except MechanismError as error:
            problems = _shown(error.problems)
        except InputError as error:
            problems = (ProblemShown(line=None, key="", message=str(error)),)
        self.sketch = TaskSketch(tables=tables, task=task, problems=problems)

    @property
    def synthesis(self) -> Synthesis:
        """The designs.

        Raises
        ------
        InputError
            If there are none, or not yet.
        """
        if self._synthesis is None:
            raise InputError("this task is not solved: complete it, or solve it again")
        return self._synthesis

    def design(self, index: int) -> JudgedDesign:
        """A design by its place in the list.

        Raises
        ------
        InputError
            If there is none.
        """
        if not 0 <= index < len(self.synthesis.designs):
            raise InputError(f"there is no design {index + 1}: the task has been solved again")
        return self.synthesis.designs[index]

    def events(self, *, live: bool = False) -> Events:
        """Solve the task, and find the chosen design again.

        ``live``: during a drag, if the last search was short.
        """
        task = self.sketch.task
        if task is None:
            return [self._unsolved(live, "The task is not complete.", self.sketch.problems)]
        if live and self._took > _WHILE_DRAGGED:
            return [self._unsolved(live, "Designs are solved when the drag ends.", slow=True)]
        try:
            if self._synthesis is None:
                begun = time.perf_counter()
                self._synthesis = self._solve(task, progress=self.go_on)
                self._took = time.perf_counter() - begun
        except (GivenUpError, KeyboardInterrupt):
            self.owed = True
            return []
        except OSError:
            return [self._unsolved(live, _NOT_LOADED, ended=True)]
        except MechanismError as error:
            located = located_task_error(error, task, self._name)
            return [self._unsolved(live, "This task cannot be solved.", _shown(located.problems))]
        except InputError as error:
            return [self._unsolved(live, str(error))]
        self.owed = False
        self._index = self._same_design()
        chosen = None if self._index is None else design_found(self._synthesis, self._index)
        return [task_solved(self._synthesis, chosen, live=live)]

    def end(self) -> Events:
        """Do not solve the task now."""
        if not self.owed:
            return []
        self.owed = False
        return [self._unsolved(False, _CANCELLED, ended=True)]

    def choose(self, index: int) -> Events:
        """Look at a design from now on."""
        self._chosen = _Chosen.of(self.design(index))
        self._index = index
        return [design_found(self.synthesis, index)]

    def _same_design(self) -> int | None:
        """The place of the chosen design after a change; by default the best one."""
        designs = self.synthesis.designs
        if not designs:
            return None
        chosen, solved = self._chosen, self.synthesis
        index = None
        if chosen is not None:
            index = alike(solved, chosen.kind, chosen.drive, chosen.pivots)
        if index is None:
            index = next(iter(() if self.synthesis.sound else near_misses(self.synthesis)), 0)
        self._chosen = _Chosen.of(designs[index])
        return index

    def go_on(self, fraction: float) -> None:
        """Report progress, or end the work. Where the work is only cancelled, solvers that can do
        so keep their results so far.
        """
        hurry = self.hurried()
        if hurry == Hurry.STOP:
            raise KeyboardInterrupt
        if hurry:
            raise GivenUpError
        self.working(fraction)

    def _unsolved(
        self,
        live: bool,
        message: str,
        problems: tuple[ProblemShown, ...] = (),
        *,
        slow: bool = False,
        ended: bool = False,
    ) -> TaskUnsolved:
        return TaskUnsolved(live=live, message=message, problems=problems, slow=slow, ended=ended)


def _shown(problems: tuple[Problem, ...]) -> tuple[ProblemShown, ...]:
    return tuple(
        ProblemShown(line=p.line, key=key_text(p.key), message=p.message) for p in problems
    )
