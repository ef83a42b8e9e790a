"""Whatever is open, a mechanism or a task, and the way from one to the other."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from linkwork.app.live import task_requests as do
from linkwork.app.live.answers import Hurry
from linkwork.app.live.events import Refused
from linkwork.app.live.mechanism_file import MechanismFile, new_file, task_template
from linkwork.app.live.opened_file import Events, NoSign, WorkSign
from linkwork.app.live.requests import OpenExample, OpenFile, Request
from linkwork.app.live.result_events import problems_found
from linkwork.app.live.subject import Read
from linkwork.app.live.task_events import DesignOpened
from linkwork.app.live.workbench import Workbench
from linkwork.core.foundation.errors import InputError, MechanismError

if TYPE_CHECKING:
    from linkwork.app.task.bench import TaskBench
    from linkwork.app.task.cycle import SolveTask
    from linkwork.synthesis.suggestion.suggesting import Suggesting


_KIND = re.compile(r"^\s*task\s*=", re.MULTILINE)
_FIRST_TABLE = re.compile(r"^\s*\[", re.MULTILINE)


def _is_task(text: str) -> bool:
    """Whether a text is meant as a task, with mistakes or without: its head has the key task."""
    return _KIND.search(_FIRST_TABLE.split(text, maxsplit=1)[0]) is not None


class Bench:
    """The opened file: a mechanism or a task; behind a design, its task.

    Parameters
    ----------
    file : MechanismFile
    read : callable
        Builds a solvable mechanism from a text; ``linkwork.loads``.
    solve : callable
        Solves a task.
    suggesting : callable, optional
        Imports the module that suggests designs for a task; without it only the search does.
    start : bool
        Offer the start page.
    """

    def __init__(
        self,
        file: MechanismFile,
        read: Read,
        solve: SolveTask,
        suggesting: Callable[[], Suggesting] | None = None,
        *,
        start: bool = False,
    ) -> None:
        self._read, self._solve, self._suggesting = read, solve, suggesting
        self._hurried: Callable[[], int] = lambda: Hurry.NONE
        self._working: WorkSign = NoSign()
        self._behind: TaskBench | None = None
        self.current: Workbench | TaskBench = self._bench_of(file, start=start)

    @property
    def text(self) -> str:
        """The current text."""
        return self.current.text

    def opened(self) -> Events:
        """All events that a page needs at its start."""
        behind = [] if self._behind is None else [DesignOpened(task=self._behind.name)]
        return [*self.current.opened(), *behind]

    def listen(self, hurried: Callable[[], int], working: WorkSign) -> None:
        """Let long work end for a newer change, and report its progress."""
        self._hurried, self._working = hurried, working
        for bench in (self.current, self._behind):
            if bench is not None:
                bench.listen(hurried, working)

    def poll(self) -> Events:
        """Report changes of the file by other programs."""
        return self.current.poll()

    def keep_unsaved(self) -> tuple[Path, ...]:
        """Write unsaved texts to copies next to their files.

        Raises
        ------
        InputError
            If a copy cannot be written.
        """
        paths = [b.keep_unsaved() for b in (self.current, self._behind) if b is not None]
        return tuple(path for path in paths if path is not None)

    def handle(self, request: Request) -> Events:
        """Process a request and send its events; invalid requests are answered, not raised."""
        try:
            match request:
                case do.OpenTask():
                    self._check_saved(request.discard)
                    return self._open(task_template(request.name))
                case OpenExample() if self._behind or not isinstance(self.current, Workbench):
                    self._check_saved(request.discard)
                    return self._open(new_file(request.name))
                case OpenFile():
                    return self._visitor_file(request)
                case do.OpenDesign():
                    return self._design(request.design)
                case do.ReturnToTask():
                    return self._task(request.discard)
        except MechanismError as error:
            return [problems_found(error)]
        except InputError as error:
            return [Refused(message=str(error))]
        if isinstance(self.current, Workbench) and isinstance(request, do.OF_TASKS):
            return [Refused(message="no task is open: a mechanism is")]
        return self.current.handle(request)

    def _check_saved(self, discard: bool) -> None:
        unsaved = [b.name for b in (self.current, self._behind) if b is not None and b.unsaved]
        if unsaved and not discard:
            names = " and of ".join(f'"{name}"' for name in unsaved)
            raise InputError(f"changes of {names} are not saved: save them first, or discard them")

    def _open(self, file: MechanismFile) -> Events:
        self.current, self._behind = self._bench_of(file), None
        return self.opened()

    def _visitor_file(self, request: OpenFile) -> Events:
        # with all formats of other programs: most visitors do without them
        from linkwork.app.live.mechanism_file import read_visitor_file

        visitor = read_visitor_file(request)  # a wrong file changes nothing
        self._check_saved(request.discard)
        return [*self._open(visitor.file), visitor.opened]

    def _design(self, index: int) -> Events:
        task = self.current
        if isinstance(task, Workbench):
            raise InputError("no task is open: a mechanism is")
        name, text = task.design_text(index)
        self.current, self._behind = self._bench_of(new_file(name, text)), task
        return self.opened()

    def _task(self, discard: bool) -> Events:
        if self._behind is None:
            raise InputError("this mechanism is not a design of an opened task")
        if self.current.unsaved and not discard:
            raise InputError(
                f'changes of "{self.current.name}" are not saved: save them first, or discard them'
            )
        self.current, self._behind = self._behind, None
        return self.opened()

    def _bench_of(self, file: MechanismFile, *, start: bool = False) -> Workbench | TaskBench:
        bench: Workbench | TaskBench
        if _is_task(file.text):
            # with all of synthesis: the page of a mechanism does without it
            from linkwork.app.task.bench import TaskBench

            bench = TaskBench(file, self._solve, self._suggesting)
        else:
            bench = Workbench(file, self._read, start=start)
        bench.listen(self._hurried, self._working)
        return bench
