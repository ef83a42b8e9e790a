"""The designs of the task under edit: solved once, ended when a newer change waits."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import singledispatchmethod
from pathlib import Path
from typing import Protocol

import numpy as np

from linkwork.app.live import task_requests as do
from linkwork.app.live.events import Refused
from linkwork.app.live.file_state import ProblemShown
from linkwork.app.live.messages import GivenUpError, Hurry, link_made
from linkwork.app.live.opened_file import (
    FILE_REQUESTS,
    Events,
    MechanismFile,
    NoSign,
    OpenedFile,
    WorkSign,
    same_thing,
)
from linkwork.app.live.requests import Cancel, MakeLink, Reload, Request, SetText
from linkwork.app.live.task_events import CognatesFound, TaskSolved, TaskState, TaskUnsolved
from linkwork.app.task.designs import alike, cognates_found, design_found, nearest_on, task_solved
from linkwork.app.task.edits import FIRST, Suggestions, TaskSketch, edit_task, task_edit_title
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.errors import InputError, MechanismError, Problem, key_text
from linkwork.core.textfile.toml_text import data_of
from linkwork.core.textfile.writer import TextEdits, write_text
from linkwork.synthesis.defects.verdicts import JudgedDesign
from linkwork.synthesis.solvers.result import Synthesis, SynthesizedDesign
from linkwork.synthesis.solvers.solving import near_misses
from linkwork.synthesis.suggesting import Suggesting
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


# ----------------------------------------------------------------------
# A task file under edit: every change is read, solved, reported and kept in the history.


_MOST_NEAREST = 100


class TaskBench(OpenedFile):
    """One task file, its text, its history and its designs.

    Parameters
    ----------
    file : MechanismFile
    solve : callable
        Solves a task.
    suggesting : callable, optional
        Imports the module that suggests designs.

    Attributes
    ----------
    cycle : TaskCycle
        The task and its designs.
    suggestions : Suggestions
        Designs from outside the search.
    """

    def __init__(
        self,
        file: MechanismFile,
        solve: SolveTask,
        suggesting: Callable[[], Suggesting] | None = None,
    ) -> None:
        super().__init__(file)
        self.suggestions = Suggestions(suggesting or _none_suggested)
        self._signs: WorkSign = NoSign()
        self.cycle = TaskCycle(solve, file.name, Path(file.name).parent)
        self._take(file.text)
        self._dragged = ""  # the object of a drag
        self._latest: tuple[str, str] | None = None  # its last text and its title

    @property
    def text(self) -> str:
        """The current text, including an intermediate change."""
        return self._history.text if self._latest is None else self._latest[0]

    def opened(self) -> Events:
        """All events that a page needs at its start."""
        return self._everything()

    def listen(self, hurried: Callable[[], int], working: WorkSign) -> None:
        """Let long work end for a newer change, and report its progress."""
        self._signs = working
        self.cycle.hurried, self.cycle.working = hurried, working

    def _suggested(self) -> Events:
        """The suggested designs; the first one is looked at while there is no other."""
        if not len(self.suggestions):
            return []
        chosen = FIRST if self.suggestions.chosen is None else self.suggestions.chosen
        return [self.suggestions.listed(), self.suggestions.in_motion(chosen)]

    def _take(self, text: str) -> None:
        self.cycle.take(text)
        self.suggestions.renew(self.cycle.sketch.task)

    def _solved(self, *, live: bool = False) -> Events:
        """Solve the task, which is shown before; a suggested design in sight stays there."""
        if not live:
            self._signs.show([self._state(), *self._suggested()])
        events, chosen = self.cycle.events(live=live), self.suggestions.chosen
        looked = None if chosen is None else self.suggestions.in_motion(chosen)
        if looked is not None:
            events = [
                replace(event, chosen=looked) if isinstance(event, TaskSolved) else event
                for event in events
            ]
        if live or not len(self.suggestions):
            return events
        unsolved = any(isinstance(event, TaskUnsolved) for event in events)
        return [self.suggestions.listed(), *events, *(self._suggested()[1:] if unsolved else [])]

    def handle(self, request: Request) -> Events:
        """Process a request and send its events; invalid requests are answered, not raised."""
        owed = self.cycle.owed
        try:
            if self._dragged and not _goes_on(request, self._dragged):
                self._end_drag()
            events = self._handle(request)
        except InputError as error:
            events = [Refused(message=str(error))]
        return [*events, *(self._solved() if owed and self.cycle.owed else [])]

    def design_text(self, index: int) -> tuple[str, str]:
        """The text of a design as a mechanism file, and a name for it.

        Raises
        ------
        InputError
            If the design does not exist.
        """
        if index <= FIRST:
            description, _, name = self.suggestions.description(index)
            stem = Path(self._file.name).stem
            return f"{stem}-{name.replace(' ', '-')}", write_text(description)
        design = self.cycle.design(index)
        refused = "-refused" if design.kinds else ""
        stem = Path(self._file.name).stem
        return f"{stem}{refused}-{design.number}", write_text(design.linkage)

    @singledispatchmethod
    def _handle(self, request: Request) -> Events:
        if isinstance(request, do.TASK_EDITS):
            return self._edited(request)  # type: ignore[arg-type]
        if isinstance(request, FILE_REQUESTS):
            return self._on_file(request)
        raise InputError("this is a task: open one of its designs to change a mechanism")

    def _edited(self, edit: do.TaskEdit) -> Events:
        live = bool(getattr(edit, "live", False))
        text = self._text_edits()
        edit_task(edit, text, self._snap)
        self._take(text.text)
        self._keep_on_curve(text)
        if live:
            self._dragged, self._latest = same_thing(edit), (text.text, task_edit_title(edit))
            return self._solved(live=True)
        self._dragged, self._latest = "", None
        self._history.add(text.text, task_edit_title(edit))
        return [self._state(), *self._solved()]

    def _keep_on_curve(self, text: TextEdits) -> None:
        """Let fixed pivots of four poses follow the centre-point curve of changed poses."""
        task = self.cycle.sketch.task
        if task is None:
            return
        for k, (x, y) in enumerate(task.given.fixed_pivots):
            near = nearest_on(task, complex(x, y))
            text.put((*do.LISTS["fixed pivot"], k, 0), near.real)
            text.put((*do.LISTS["fixed pivot"], k, 1), near.imag)
        if text.text != task.text:
            self._take(text.text)

    def _text_edits(self) -> TextEdits:
        try:
            data_of(self.text, self._file.name)
        except MechanismError as error:
            (problem,) = error.problems
            place = f"line {problem.line} " if problem.line else "it "
            raise InputError(f"correct the text first: {place}{problem.message}") from None
        return TextEdits(self.text)

    def _snap(self, point: complex) -> complex:
        """Where a fixed pivot goes that is dragged to a point."""
        task = self.cycle.sketch.task
        return point if task is None else nearest_on(task, point)

    @_handle.register
    def _(self, request: SetText) -> Events:
        return self._accepted(request.text, "text")

    @_handle.register
    def _(self, request: Reload) -> Events:
        text = self._file.read()
        events = self._accepted(text, "reload")
        self._file.accept(text)
        self._conflict = None
        return [self._state(), *events[1:]]

    @_handle.register
    def _(self, request: Cancel) -> Events:
        return self.cycle.end()

    @_handle.register
    def _(self, request: do.SolveTask) -> Events:
        return self._solved()

    @_handle.register
    def _(self, request: do.ShowDesign) -> Events:
        if request.design <= FIRST:
            return self.suggestions.choose(request.design)
        self.suggestions.chosen = None
        return self.cycle.choose(request.design)

    @_handle.register
    def _(self, request: do.FindNearest) -> Events:
        if not 1 <= request.count <= _MOST_NEAREST:
            raise InputError(f"1 to {_MOST_NEAREST} designs can be requested, got {request.count}")
        try:
            return self.suggestions.find_nearest(self._complete(), request.count, self.cycle.go_on)
        except (GivenUpError, KeyboardInterrupt):
            raise InputError("the comparison was ended: ask for the nearest paths again") from None

    @_handle.register
    def _(self, request: do.ImproveDesign) -> Events:
        task = self._complete()
        if request.design <= FIRST:
            description, mechanism, _ = self.suggestions.description(request.design)
        else:
            design = self.cycle.design(request.design)
            description, mechanism = design.linkage, design.mechanism
        try:
            return self.suggestions.improve(task, description, mechanism, self._improving)
        except MechanismError as error:
            raise InputError("; ".join(problem.message for problem in error.problems)) from None
        except (GivenUpError, KeyboardInterrupt):
            raise InputError("the improvement was ended before its first design") from None

    def _improving(self, fraction: float) -> None:
        """Report progress; a change or a cancellation ends it with the best so far."""
        if self.cycle.hurried():
            raise KeyboardInterrupt
        self._signs(fraction)

    def _complete(self) -> Task:
        task = self.cycle.sketch.task
        if task is None:
            raise InputError("the task is not complete: complete it first")
        return task

    @_handle.register
    def _(self, request: do.ShowCognates) -> Events:
        if request.design <= FIRST:
            self.suggestions.in_motion(request.design)
            return [CognatesFound(design=request.design, cognates=(), curve=())]
        self.cycle.design(request.design)
        return [cognates_found(self.cycle.synthesis, request.design)]

    @_handle.register
    def _(self, request: MakeLink) -> Events:
        return [link_made(self.text, self.name, request.app)]

    def _accepted(self, text: str, what: str) -> Events:
        self._dragged, self._latest = "", None
        self._history.add(text, what)
        return self._went()

    def _end_drag(self) -> None:
        """Complete a drag that has not ended."""
        if self._latest is not None:
            self._history.add(*self._latest)
        self._dragged, self._latest = "", None

    def _everything(self) -> Events:
        self._end_drag()
        conflict = [] if self._conflict is None else [self._conflict]
        return [self._state(), *self._solved(), *conflict]

    def _went(self) -> Events:
        self._take(self._history.text)
        return [self._state(), *self._solved()]

    def _taken_over(self) -> Events:
        self._end_drag()
        changed = f'"{self._file.name}" has been read again'
        try:
            events = self._handle(Reload())
        except InputError as error:
            return [Refused(message=str(error))]
        return [self._changed(changed, reloaded=True), *events]

    def _state(self) -> TaskState:
        return self.cycle.sketch.state(
            self._file.name, self.text, self._history, unsaved=self.unsaved
        )


def _none_suggested() -> Suggesting:
    raise InputError("no designs are suggested here")


def _goes_on(request: Request, dragged: str) -> bool:
    """Whether a request belongs to a drag, or does not affect it."""
    if isinstance(request, do.ShowDesign | do.ShowCognates | MakeLink):
        return True
    return isinstance(request, do.TASK_EDITS) and same_thing(request) == dragged
