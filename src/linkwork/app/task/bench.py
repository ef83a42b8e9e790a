"""A task file under edit: every change is read, solved, reported and kept in the history."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import singledispatchmethod
from pathlib import Path

from linkwork.app.live import task_requests as do
from linkwork.app.live.answers import GivenUpError, link_made
from linkwork.app.live.events import Refused
from linkwork.app.live.mechanism_file import MechanismFile
from linkwork.app.live.opened_file import (
    FILE_REQUESTS,
    Events,
    NoSign,
    OpenedFile,
    WorkSign,
    same_thing,
)
from linkwork.app.live.requests import Cancel, MakeLink, Reload, Request, SetText
from linkwork.app.live.task_events import CognatesFound, TaskSolved, TaskState, TaskUnsolved
from linkwork.app.task.cycle import SolveTask, TaskCycle
from linkwork.app.task.designs import cognates_found, nearest_on
from linkwork.app.task.edits import edit_task, task_edit_title
from linkwork.app.task.suggestions import FIRST, Suggestions
from linkwork.core.foundation.errors import InputError, MechanismError
from linkwork.core.textfile.text_edits import TextEdits
from linkwork.core.textfile.toml_text import data_of
from linkwork.core.textfile.writer import write_text
from linkwork.synthesis.suggestion.suggesting import Suggesting
from linkwork.synthesis.tasks.task import Task

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
