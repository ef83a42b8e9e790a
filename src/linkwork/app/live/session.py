"""Whatever is open, a mechanism or a task, and the way from one to the other."""

from __future__ import annotations

import logging
import re
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from linkwork.app.live import task_requests as do
from linkwork.app.live.events import Event, Refused, Working
from linkwork.app.live.messages import Hurry, MessageError, decoded, encoded
from linkwork.app.live.opened_file import (
    Events,
    MechanismFile,
    NoSign,
    WorkSign,
    new_file,
    same_thing,
    task_template,
)
from linkwork.app.live.requests import EDITS, Cancel, OpenExample, OpenFile, Request, SetText
from linkwork.app.live.result_events import problems_found
from linkwork.app.live.subject import Read
from linkwork.app.live.task_events import DesignOpened
from linkwork.app.live.task_requests import TASK_EDITS
from linkwork.app.live.workbench import Workbench
from linkwork.core.foundation.errors import InputError, MechanismError
from linkwork.core.textfile.link import text_of_link
from linkwork.core.textfile.reader import blank_sheet

if TYPE_CHECKING:
    from linkwork.app.task.bench import SolveTask, TaskBench
    from linkwork.synthesis.suggesting import Suggesting

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
        from linkwork.app.live.opened_file import read_visitor_file

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


# ----------------------------------------------------------------------
# Requests that wait for a workbench, and their answers, in a thread or in a browser.


#: Receives events and the id of the request that they answer.
Tell = Callable[[list[Event], int | None], None]

_PACE = 0.25  # between reports of progress [s]
_log = logging.getLogger("linkwork.app")


class Waiting:
    """Requests in order of arrival, with their ids; ``None`` asks for the complete state.

    Intermediate changes are skipped if a newer one of the same kind follows: only the latest
    position of a slider matters.
    """

    def __init__(self) -> None:
        self._requests: deque[tuple[Request | None, int | None]] = deque()

    def __len__(self) -> int:
        return len(self._requests)

    @property
    def hurry(self) -> Hurry:
        """Whether a change of the file or a cancellation waits."""
        if any(isinstance(request, (*EDITS, *TASK_EDITS)) for request, _ in self._requests):
            return Hurry.CHANGE
        cancelled = any(isinstance(request, Cancel) for request, _ in self._requests)
        return Hurry.STOP if cancelled else Hurry.NONE

    def add(self, request: Request | None, number: int | None) -> None:
        """Queue a request."""
        self._requests.append((request, number))

    def next(self) -> tuple[Request | None, int | None]:
        """The next request; outdated intermediate changes are skipped."""
        request, number = self._requests.popleft()
        while getattr(request, "live", False) and self._requests:
            newer = self._requests[0][0]
            if request is None or newer is None or same_thing(newer) != same_thing(request):
                break
            # a dragged point sends positions faster than they are solved: use only the
            # last
            request, number = self._requests.popleft()
        return request, number


class WorkSigns:
    """Reports the progress of an answer."""

    def __init__(self, tell: Tell) -> None:
        self._tell = tell
        self._number: int | None = None
        self._sent_at = 0.0
        self._early: list[Event] = []

    def begin(self, number: int | None) -> None:
        """Begin with a request of this id."""
        self._number, self._sent_at = number, time.monotonic()
        self._early = []

    def __call__(self, fraction: float) -> None:
        """Report the finished fraction, a few times per second at most."""
        now = time.monotonic()
        if now - self._sent_at >= _PACE:
            self._sent_at = now
            self._tell([Working(fraction=min(1.0, max(0.0, fraction)))], self._number)

    def show(self, events: list[Event]) -> None:
        """Send events before the answer."""
        self._early = events
        self._tell(events, None)

    def show_again(self) -> None:
        """Send this to a page that connects before the answer."""
        if self._early:
            self._tell(self._early, None)


def answers_of(workbench: Workbench | Bench, request: Request | None) -> list[Event]:
    """The events that answer a request."""
    return workbench.opened() if request is None else workbench.handle(request)


def answer(work: Callable[[], list[Event]]) -> list[Event]:
    """The events of some work; an unexpected error becomes an event, which keeps the page and
    unsaved changes.
    """
    try:
        return work()
    except OSError as error:
        text = f"a file that this needs cannot be read ({error}): check the connection, try again"
        return [Refused(message=text)]
    except Exception as error:
        _log.exception("a request failed")
        mistake = f"{type(error).__name__}: {error}"
        return [Refused(message=f"this is an error in Linkwork, please report it: {mistake}")]


# ----------------------------------------------------------------------
# The thread that processes requests for a workbench, separate from the network.


_LOOK_AT_FILE = 0.5  # interval of checks of the file on disk [s]


class Desk:
    """Processes requests in order of arrival.

    Intermediate changes are skipped if a newer one of the same kind is waiting: only the latest
    position of a slider matters.

    Parameters
    ----------
    workbench : Workbench or Bench
        For exclusive use until :meth:`close`.
    tell : callable
        Called in the desk's thread.
    """

    def __init__(self, workbench: Workbench | Bench, tell: Tell) -> None:
        self._workbench, self._tell = workbench, tell
        self._waiting = Waiting()
        self._changed = threading.Condition()
        self._closing = False
        self._signs = WorkSigns(tell)
        workbench.listen(self._hurried, self._signs)
        self._thread = threading.Thread(target=self._work, name="linkwork desk", daemon=True)
        self._thread.start()

    @property
    def waiting(self) -> int:
        """The number of waiting requests."""
        return len(self._waiting)

    def prepare(self) -> None:
        """Compute the results that :meth:`open` sends."""
        self.ask(*_UNTOLD)

    def open(self) -> None:
        """Send the complete state: its known part at once, while a long answer is prepared."""
        self._signs.show_again()
        self.ask(None, None)

    def ask(self, request: Request | None, number: int | None) -> None:
        """Queue a request; its events have this id."""
        with self._changed:
            self._waiting.add(request, number)
            self._changed.notify()

    def close(self, patience: float = 5.0) -> bool:
        """Finish the current request and stop; returns whether this took less than the time [s]."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        self._thread.join(patience)
        return not self._thread.is_alive()

    def _hurried(self) -> Hurry:
        with self._changed:
            return Hurry.CHANGE if self._closing else self._waiting.hurry

    def _work(self) -> None:
        while True:
            with self._changed:
                if not self._waiting and not self._closing:
                    self._changed.wait(_LOOK_AT_FILE)
                if self._closing:
                    return
                request = self._waiting.next() if self._waiting else _NOTHING
            self._do(*request)

    def _do(self, request: Request | None, number: int | None) -> None:
        self._signs.begin(number if (number or 0) >= 0 else None)
        if (request, number) == _UNTOLD:
            answer(self._workbench.opened)
            return
        if (request, number) == _NOTHING:
            number, events = None, answer(self._workbench.poll)
        else:
            events = answer(partial(answers_of, self._workbench, request))
        if events or number is not None:
            self._tell(events, number)


#: Besides requests with ids: checks of the file, and background work.
_NOTHING: tuple[Request | None, int | None] = (None, -1)
_UNTOLD: tuple[Request | None, int | None] = (None, -2)


# ----------------------------------------------------------------------
# A workbench that runs in a browser's worker, which has no threads and no disk.


_LOOK_FOR_MESSAGES = 0.025  # interval at which long work looks for newer changes [s]
_LONGEST_NAME = 100  # characters of a file's name
_EXAMPLE = "example="
_TASK = "task="


class BrowserDesk:  # noqa: V102  # the page in a browser makes it
    """Processes the requests of one page, one at each call of :meth:`work`.

    Parameters
    ----------
    read : callable
        Builds a solvable mechanism from a text; ``linkwork.loads``.
    library : callable
        The text of a library mechanism by its name; ``linkwork.example_text``.
    tell : callable
        Receives each event as JSON.
    take : callable
        Returns the messages that have arrived since the last call, as JSON.
    solve : callable
        Solves a task.
    pause : callable, optional
        Lets the browser deliver messages during long work. Without it a newer change cannot cancel
        a cycle that is being solved.
    suggesting : callable, optional
        Imports the module that suggests designs for a task.
    """

    def __init__(
        self,
        read: Read,
        library: Callable[[str], str],
        tell: Callable[[str], None],
        take: Callable[[], Iterable[str]],
        solve: SolveTask,
        pause: Callable[[], None] | None = None,
        suggesting: Callable[[], Suggesting] | None = None,
    ) -> None:
        self._read, self._library, self._solve = read, library, solve
        self._tell, self._take, self._pause = tell, take, pause
        self._suggesting = suggesting
        self._waiting = Waiting()
        self._signs = WorkSigns(self._send)
        self._workbench: Bench | None = None
        self._looked = 0.0

    def begin(self, fragment: str, name: str = "", saved: str = "", text: str = "") -> None:
        """Open the file that the page kept when it was last closed, else the one of its address.

        Parameters
        ----------
        fragment : str
            The part of the address from ``#`` on: a link to a file, ``#example=NAME``,
            ``#task=NAME`` or "".
        name, saved, text : str
            The file that the page kept: its name, its text, and the text with changes that are not
            saved; ``name`` is "" if it kept none.
        """
        if name:
            self.open(name, saved, text)
            return
        refused: list[Event] = []
        try:
            linked = self._linked(fragment)
        except InputError as error:
            refused = [Refused(message=str(error))]
            linked = self._linked("")
        self.open(*linked, start=fragment in ("", "#") or bool(refused))
        self._send(refused)

    def _linked(self, fragment: str) -> tuple[str, str]:
        """The name and the text of the file that the fragment of an address contains or names."""
        code = fragment.removeprefix("#")
        if code.startswith(_EXAMPLE) and code != _EXAMPLE:
            name = unquote(code.removeprefix(_EXAMPLE))
            return f"{name}.toml", self._library(name)
        if code.startswith(_TASK):
            file = task_template(unquote(code.removeprefix(_TASK)))
            return file.name, file.text
        if code in ("", _EXAMPLE):
            return "untitled.toml", blank_sheet("Untitled")
        return "linked.toml", text_of_link(code)

    def open(self, name: str, saved: str, text: str | None = None, *, start: bool = False) -> None:
        """Open a file in the memory of the browser, and send the complete state.

        Parameters
        ----------
        name : str
            The name of the file; folders in it are dropped.
        saved : str
            The text of the file.
        text : str, optional
            The text with changes that are not saved.
        start : bool
            Offer the library to begin with.
        """
        path = Path(Path(name).name[-_LONGEST_NAME:] or "mechanism.toml")
        path.unlink(missing_ok=True)
        file = MechanismFile(path, saved)
        workbench = Bench(file, self._read, self._solve, self._suggesting, start=start)
        self._workbench, self._waiting = workbench, Waiting()
        workbench.listen(self._hurried, self._signs)
        if text is not None and text != saved:
            answer(partial(workbench.handle, SetText(text=text)))
        self._send(answer(workbench.opened))

    def work(self) -> bool:
        """Process the next request; returns whether there was one."""
        self._receive()
        if not self._waiting or self._workbench is None:
            return False
        self._looked = time.monotonic()
        request, number = self._waiting.next()
        self._signs.begin(number)
        self._send(answer(partial(answers_of, self._workbench, request)), number)
        return True

    def _receive(self) -> None:
        for message in self._take():
            try:
                self._waiting.add(*decoded(message))
            except MessageError as error:
                self._send([Refused(message=str(error))], error.id)

    def _hurried(self) -> Hurry:
        """Whether a newer change waits; called often during long work."""
        now = time.monotonic()
        if self._pause is not None and now - self._looked > _LOOK_FOR_MESSAGES:
            self._pause()
            self._receive()
            self._looked = time.monotonic()
        return self._waiting.hurry

    def _send(self, events: list[Event], number: int | None = None) -> None:
        for event in events:
            self._tell(encoded(event, number))
