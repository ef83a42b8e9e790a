"""An opened file with its history: undo, redo, saving, and changes by other programs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path
from typing import Protocol

from linkwork.foundation.errors import InputError
from linkwork.viewer.live import events as tell, requests as ask
from linkwork.viewer.live.history import History
from linkwork.viewer.live.mechanism_file import MechanismFile, OnDisk

__all__ = ["FILE_REQUESTS", "Events", "NoSign", "OpenedFile", "WorkSign"]

Events = list[tell.Event]

#: Requests that are the same for every kind of file.
FILE_REQUESTS = (ask.Undo, ask.Redo, ask.Save)


class WorkSign(Protocol):
    """Receives the finished fraction of long work, and what can be shown before its answer."""

    def __call__(self, fraction: float) -> None: ...

    def show(self, events: Events) -> None: ...


class NoSign:
    """Nobody waits for signs of work."""

    def __call__(self, fraction: float) -> None:
        """Nothing is told."""

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
        self._conflict: tell.FileChanged | None = None

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

    def _on_file(self, request: ask.Request) -> Events:
        """Undo, redo or save."""
        if isinstance(request, ask.Save):
            self._file.write(self.text, overwrite=request.overwrite)
            self._conflict = None
            return [tell.Saved(file=self._file.name), self._state()]
        undo = isinstance(request, ask.Undo)
        if (self._history.undone() if undo else self._history.redone()) is None:
            raise InputError(f"there is nothing to {'undo' if undo else 'redo'}")
        return self._went()

    def _changed(
        self, message: str, *, reloaded: bool = False, missing: bool = False
    ) -> tell.FileChanged:
        return tell.FileChanged(
            message=message, reloaded=reloaded, unsaved=self.unsaved, missing=missing
        )

    @abstractmethod
    def _taken_over(self) -> Events:
        """Load the changed file on disk, without loss of changes."""

    @abstractmethod
    def _went(self) -> Events:
        """Show the text to which the history went."""

    @abstractmethod
    def _state(self) -> tell.Event:
        """The state of the file."""
