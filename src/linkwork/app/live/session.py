"""Requests that wait for a workbench, and their answers, in a thread or in a browser."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable
from functools import partial

from linkwork.app.live.answers import Hurry
from linkwork.app.live.bench import Bench
from linkwork.app.live.events import Event, Refused, Working
from linkwork.app.live.opened_file import same_thing
from linkwork.app.live.requests import EDITS, Cancel, Request
from linkwork.app.live.task_requests import TASK_EDITS
from linkwork.app.live.workbench import Workbench

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
