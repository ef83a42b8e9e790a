"""Requests that wait for a workbench, and their answers, in a thread or in a browser."""

from __future__ import annotations

import logging
import time
from collections import deque
from collections.abc import Callable

from linkwork.viewer.live.answers import Hurry
from linkwork.viewer.live.bench import Bench
from linkwork.viewer.live.drag import same_thing
from linkwork.viewer.live.events import Event, Refused, Working
from linkwork.viewer.live.requests import EDITS, Cancel, Request
from linkwork.viewer.live.task_requests import TASK_EDITS
from linkwork.viewer.live.workbench import Workbench

__all__ = ["Tell", "Waiting", "WorkSigns", "answer", "answers_of"]

#: Receives events and the id of the request that they answer.
Tell = Callable[[list[Event], int | None], None]

_PACE = 0.25  # between reports of progress [s]
_log = logging.getLogger("linkwork.viewer")


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
        self._told_at = 0.0
        self._early: list[Event] = []

    def begin(self, number: int | None) -> None:
        """Begin with a request of this id."""
        self._number, self._told_at = number, time.monotonic()
        self._early = []

    def __call__(self, fraction: float) -> None:
        """Report the finished fraction, a few times per second at most."""
        now = time.monotonic()
        if now - self._told_at >= _PACE:
            self._told_at = now
            self._tell([Working(fraction=min(1.0, max(0.0, fraction)))], self._number)

    def show(self, events: list[Event]) -> None:
        """Send what is known before the answer."""
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
        told = f"a file that this needs cannot be read ({error}): check the connection, try again"
        return [Refused(message=told)]
    except Exception as error:
        _log.exception("a request failed")
        mistake = f"{type(error).__name__}: {error}"
        return [Refused(message=f"this is an error in Linkwork, please report it: {mistake}")]
