"""An opened file with its history: undo, redo, saving, and changes by other programs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from linkwork.app.live import task_requests as do
from linkwork.app.live.answers import Query
from linkwork.app.live.events import Event, FileChanged, Saved
from linkwork.app.live.history import History
from linkwork.app.live.mechanism_file import MechanismFile, OnDisk
from linkwork.app.live.messages import kind_of
from linkwork.app.live.moving_points import Before
from linkwork.app.live.requests import (
    EDITS,
    Export,
    MovePoint,
    MovePoints,
    Question,
    Redo,
    Request,
    Save,
    SetNumber,
    Undo,
)
from linkwork.core.foundation.errors import InputError
from linkwork.core.textfile.text_edits import TextEdits

Events = list[Event]

#: Requests that are the same for every kind of file.
FILE_REQUESTS = (Undo, Redo, Save)


class WorkSign(Protocol):
    """Receives the finished fraction of long work, and events to show before its answer."""

    def __call__(self, fraction: float) -> None: ...

    def show(self, events: Events) -> None: ...


class NoSign:
    """Nobody waits for signs of work."""

    def __call__(self, fraction: float) -> None:
        """Send nothing."""

    def show(self, events: Events) -> None:
        """Nothing is shown."""


class OpenedFile(ABC):
    """A file under edit: every accepted text is kept in the history.

    Parameters
    ----------
    file : MechanismFile
    """

    def __init__(self, file: MechanismFile) -> None:
        self._file = file
        self._history = History(file.text)
        self._conflict: FileChanged | None = None

    @property
    def text(self) -> str:
        """The current text."""
        return self._history.text

    @property
    def unsaved(self) -> bool:
        """Whether the text differs from the one last read or written."""
        return self.text != self._file.text

    @property
    def name(self) -> str:
        """The name of the file."""
        return self._file.name

    def poll(self) -> Events:
        """Report changes of the file by other programs; load them unless changes are unsaved."""
        news = self._file.news()
        if news is None:
            return []
        name = self._file.name
        if news is OnDisk.SAME:
            self._conflict = None
            return [self._changed(f'"{name}" again has the content that was read here')]
        if news is OnDisk.MISSING:
            message = f'"{name}" has been deleted: save to write it again'
            self._conflict = self._changed(message, missing=True)
            return [self._conflict]
        if self.unsaved:
            message = (
                f'"{name}" has been changed by another program, and changes made here are not '
                "saved: reload the file, or save and overwrite it"
            )
            self._conflict = self._changed(message)
            return [self._conflict]
        return self._taken_over()

    def keep_unsaved(self) -> Path | None:
        """Write unsaved text to a copy next to the file; ``None`` if all is saved.

        Raises
        ------
        InputError
            If the copy cannot be written.
        """
        return self._file.keep_beside(self.text) if self.unsaved else None

    def _on_file(self, request: Request) -> Events:
        """Undo, redo or save."""
        if isinstance(request, Save):
            self._file.write(self.text, overwrite=request.overwrite)
            self._conflict = None
            return [Saved(file=self._file.name), self._state()]
        undo = isinstance(request, Undo)
        if (self._history.undone() if undo else self._history.redone()) is None:
            raise InputError(f"there is nothing to {'undo' if undo else 'redo'}")
        return self._went()

    def _changed(
        self, message: str, *, reloaded: bool = False, missing: bool = False
    ) -> FileChanged:
        return FileChanged(
            message=message, reloaded=reloaded, unsaved=self.unsaved, missing=missing
        )

    @abstractmethod
    def _taken_over(self) -> Events:
        """Load the changed file on disk, without loss of changes."""

    @abstractmethod
    def _went(self) -> Events:
        """Show the text to which the history went."""

    @abstractmethod
    def _state(self) -> Event:
        """The state of the file."""


# ----------------------------------------------------------------------
# Intermediate changes of a drag, which become one step of the history.


@dataclass(kw_only=True)
class Drag:
    """An intermediate change: the text it changes, and the mechanism at its start."""

    kind: str
    text: TextEdits
    before: Before
    what: str = ""
    latest: str | None = None


def same_thing(edit: Request) -> str:
    """A key of the dragged object: changes with equal keys are merged."""
    match edit:
        case SetNumber():
            return f"number {edit.name}"
        case MovePoint():
            return f"point {edit.point} {edit.lengths_follow}"
        case MovePoints():
            return f"points {' '.join(edit.places)}"
        case do.MoveTaskPoint():
            return f"{edit.of} {edit.index}"
        case do.TurnPose():
            return f"angle {edit.index}"
        case do.SetTaskEntry():
            return f"entry {edit.key}"
        case _:
            return kind_of(type(edit))


def goes_on(request: Request, drag: Drag | None) -> bool:
    """Whether a request belongs to an intermediate change or does not affect it."""
    asking = isinstance(request, Query | Question) and not isinstance(request, Export)
    if drag is None or asking:
        return True
    return isinstance(request, EDITS) and same_thing(request) == drag.kind
