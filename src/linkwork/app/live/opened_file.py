"""The file that a live page reads and writes, and its changes by other programs."""

from __future__ import annotations

import base64
import binascii
import hashlib
import re
from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Protocol

from linkwork.app.live import task_requests as do
from linkwork.app.live.events import Event, FileChanged, FileOpened, Saved
from linkwork.app.live.history import History
from linkwork.app.live.messages import Query, kind_of
from linkwork.app.live.moving_points import Before
from linkwork.app.live.requests import (
    EDITS,
    Export,
    MovePoint,
    MovePoints,
    OpenFile,
    Question,
    Redo,
    Request,
    Save,
    SetNumber,
    Undo,
)
from linkwork.core.foundation.errors import InputError, MechanismFileError, Problem
from linkwork.core.foundation.files import save_text, unwritten
from linkwork.core.textfile.reader import blank_sheet, example_text
from linkwork.core.textfile.toml_text import bytes_of, data_of, text_of
from linkwork.core.textfile.writer import TextEdits, write_text
from linkwork.readers.importing import FORMATS, read_foreign
from linkwork.synthesis.tasks.templates import template_text

_MOST_COPIES = 100  # names tried for a copy next to the file


def new_file(example: str = "", text: str | None = None) -> MechanismFile:
    """A mechanism of the library, a blank sheet or a text, under a name that no file has.

    Raises
    ------
    UnknownNameError
        If the library does not have the mechanism.
    """
    stem = example or "untitled"
    if text is None:
        text = example_text(example) if example else blank_sheet("Untitled")
    for k in range(1, _MOST_COPIES):
        path = Path(f"{stem}.toml" if k == 1 else f"{stem}-{k}.toml")
        if not path.exists():
            return MechanismFile(path, text)
    raise InputError(f'"{path}" and all earlier names exist already: remove some of these files')


class FileConflictError(InputError):
    """The file on disk differs from the version that was read."""


class OnDisk(Enum):
    """State of the file on disk relative to the edited version."""

    SAME = "same"
    CHANGED = "changed"
    MISSING = "missing"


class MechanismFile:
    """A mechanism file on disk, and the version of it that is edited.

    Parameters
    ----------
    path : str or Path
        A symbolic link is resolved once, here.
    begun : str, optional
        The text to begin with if the file does not exist or is empty; it is written when it is
        saved.

    Raises
    ------
    MechanismFileError
        If the file does not exist or cannot be read.
    """

    def __init__(self, path: str | Path, begun: str | None = None) -> None:
        self.name = str(path)
        self._begun = begun
        self._path = Path(path).resolve()
        self._stamp = self._stamp_now()
        self.text = self.read()
        self.accept(self.text)

    def read(self) -> str:
        """The text on disk; does not change the edited version."""
        if self._begun is not None and self._stamp_now() is None:
            return self._begun
        text = text_of(bytes_of(self._path, self.name), self.name)
        return text if self._begun is None or text.strip() else self._begun

    def accept(self, text: str) -> None:
        """Set the edited version to a text of this file."""
        self.text = text
        begun = self._begun is not None and text == self._begun
        self._known = self._reported = self._digest_now() if begun else _digest(text.encode())

    def news(self) -> OnDisk | None:
        """The change by another program since the last call; ``None`` without a change.

        Contents are compared, not dates.
        """
        stamp = self._stamp_now()
        if stamp == self._stamp:
            return None
        self._stamp = stamp
        digest = self._digest_now()
        # the date changes also when the same text is written again
        if digest == self._reported:
            return None
        self._reported = digest
        return self._state(digest)

    def _state(self, digest: bytes) -> OnDisk:
        if digest == self._known:
            return OnDisk.SAME
        return OnDisk.CHANGED if digest else OnDisk.MISSING

    def _digest_now(self) -> bytes:
        """Digest of the content on disk; empty if there is no file."""
        try:
            return _digest(bytes_of(self._path, self.name))
        except MechanismFileError:
            return b"" if self._stamp_now() is None else b"unreadable"

    def write(self, text: str, *, overwrite: bool = False) -> None:
        """Write the file completely or not at all.

        Raises
        ------
        FileConflictError
            If another program has changed or removed the file, unless ``overwrite``.
        InputError
            If the file cannot be written; it is then unchanged.
        """
        state = self._state(self._digest_now())  # compares contents, not dates
        if state is not OnDisk.SAME and not overwrite:
            what = "has been removed" if state is OnDisk.MISSING else "has been changed"
            raise FileConflictError(
                f'"{self.name}" {what} by another program since it was read here: reload it, '
                "or save again and overwrite it"
            )
        save_text(text, self._path)
        self._begun = None  # from now on the file is current
        # changes by this program are not reported
        self._stamp = self._stamp_now()
        self.accept(text)

    def keep_beside(self, text: str) -> Path:
        """Write an unsaved text to a new file next to this one, without overwriting any file.

        Raises
        ------
        InputError
            If it cannot be written.
        """
        for k in range(1, _MOST_COPIES):
            number = "" if k == 1 else f"-{k}"
            beside = self._path.with_name(f"{self._path.stem}.unsaved{number}.toml")
            try:
                # "x" fails if the file exists, even if just created
                with beside.open("x", encoding="utf-8", newline="") as file:
                    file.write(text)
                return beside
            except FileExistsError:
                continue
            except OSError as error:
                raise unwritten(beside, error) from None
        raise InputError(
            f'"{beside}" and all earlier names exist already: remove some of these files'
        )

    def _stamp_now(self) -> tuple[int, int, int] | None:
        try:
            stat = self._path.stat()
        except OSError:
            return None
        # the inode changes when an editor replaces the file, even within one tick of the clock
        return stat.st_mtime_ns, stat.st_size, stat.st_ino


def _digest(data: bytes) -> bytes:
    return hashlib.blake2b(data).digest()


# ----------------------------------------------------------------------
# A file of the visitor, opened as a new one: of Linkwork, or imported from another program.


_NOT_OF_NAMES = re.compile(r"[^\w .+-]")
_LONGEST_STEM = 80  # characters
_SUFFIX = ".toml"


@dataclass(frozen=True, kw_only=True)
class VisitorFile:
    """The text to open, under a name that no file has, and the event that announces it."""

    file: MechanismFile
    opened: FileOpened


def read_visitor_file(request: OpenFile) -> VisitorFile:
    """A mechanism or task from the bytes of a file; nothing in it is executed.

    Raises
    ------
    MechanismFileError
        With the reason why it is not read, and its place.
    InputError
        If the message does not contain bytes.
    """
    name = PurePosixPath(PureWindowsPath(request.name).name).name
    try:
        data = base64.b64decode(request.content, validate=True)
    except (binascii.Error, ValueError):
        raise InputError(f'"{name}" has not arrived as base64: open it again') from None
    stem = _NOT_OF_NAMES.sub("-", PurePosixPath(name).stem).strip(" .")[:_LONGEST_STEM]
    if name.lower().endswith(_SUFFIX):
        text = text_of(data, name)
        if "format" not in data_of(text, name):
            message = "is not a file of Linkwork: these begin with format = 1"
            raise MechanismFileError([Problem(key=(), message=message)], name)
        opened = FileOpened(source=name, format="", carried={}, renamed={}, left_out=())
    else:
        reading = read_foreign(data, name)
        text = write_text(reading.description)
        opened = FileOpened(
            source=name,
            format=str(FORMATS[reading.format].TITLE),
            carried=reading.carried,
            renamed=dict(reading.renamed),
            left_out=tuple(map(str, reading.left_out)),
        )
    return VisitorFile(file=new_file(stem or "opened", text), opened=opened)


def task_template(name: str) -> MechanismFile:
    """A task to begin with, under a name that no file has; raises like `template_text`."""
    return new_file(name, template_text(name))


# ----------------------------------------------------------------------
# An opened file with its history: undo, redo, saving, and changes by other programs.


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
