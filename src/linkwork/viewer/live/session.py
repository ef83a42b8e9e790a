"""The thread that processes requests for a workbench, separate from the network."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable

from linkwork.viewer.live.events import Event, Refused, Working
from linkwork.viewer.live.requests import EDITS, Request
from linkwork.viewer.live.workbench import Workbench

__all__ = ["Desk", "Tell"]

_log = logging.getLogger("linkwork.viewer")

#: Receives events and the id of the request that they answer.
Tell = Callable[[list[Event], int | None], None]

_PACE = 0.25  # between reports of progress [s]
_LOOK_AT_FILE = 0.5  # interval of checks of the file on disk [s]


class Desk:
    """Processes requests in order of arrival.

    Intermediate changes are skipped if a newer one of the same kind is waiting: only the latest
    position of a slider matters.

    Parameters
    ----------
    workbench : Workbench
        For exclusive use until :meth:`close`.
    tell : callable
        Called in the desk's thread.
    """

    def __init__(self, workbench: Workbench, tell: Tell) -> None:
        self._workbench, self._tell = workbench, tell
        self._waiting: deque[tuple[Request | None, int | None]] = deque()
        self._changed = threading.Condition()
        self._closing = False
        workbench.hurried, workbench.working = self._hurried, self._working
        self._number: int | None = None  # id of the request being processed
        self._told_at = 0.0
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
        """Send the complete state."""
        self.ask(None, None)

    def ask(self, request: Request | None, number: int | None) -> None:
        """Queue a request; its events have this id."""
        with self._changed:
            self._waiting.append((request, number))
            self._changed.notify()

    def close(self, patience: float = 5.0) -> bool:
        """Finish the current request and stop; returns whether this took less than the time [s]."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        self._thread.join(patience)
        return not self._thread.is_alive()

    def _hurried(self) -> bool:
        with self._changed:
            return self._closing or any(isinstance(r, EDITS) for r, _ in self._waiting)

    def _working(self, fraction: float) -> None:
        """Tell the progress of an answer, a few times per second."""
        now = time.monotonic()
        if now - self._told_at >= _PACE:
            self._told_at = now
            self._tell([Working(fraction=min(1.0, max(0.0, fraction)))], self._number)

    def _work(self) -> None:
        while True:
            with self._changed:
                if not self._waiting and not self._closing:
                    self._changed.wait(_LOOK_AT_FILE)
                if self._closing:
                    return
                request = self._next() if self._waiting else _NOTHING
            self._do(*request)

    def _next(self) -> tuple[Request | None, int | None]:
        """The next request; outdated intermediate changes are skipped."""
        request, number = self._waiting.popleft()
        while getattr(request, "live", False) and self._waiting:
            if not _replaces(self._waiting[0][0], request):
                break
            # a dragged point sends positions faster than they are solved: use only the
            # last
            request, number = self._waiting.popleft()
        return request, number

    def _do(self, request: Request | None, number: int | None) -> None:
        self._number, self._told_at = (number if (number or 0) >= 0 else None), time.monotonic()
        try:
            if (request, number) == _NOTHING:
                number, events = None, self._workbench.poll()
            elif (request, number) == _UNTOLD:
                self._workbench.opened()
                return
            elif request is None:
                events = self._workbench.opened()
            else:
                events = self._workbench.handle(request)
        except Exception as error:  # any error: keep the page and unsaved changes
            _log.exception("a request failed")
            mistake = f"{type(error).__name__}: {error}"
            number = None if request is None else number
            events = [Refused(message=f"this is an error in Linkwork, please report it: {mistake}")]
        if events or number is not None:
            self._tell(events, number)


#: Besides requests with ids: checks of the file, and background work.
_NOTHING: tuple[Request | None, int | None] = (None, -1)
_UNTOLD: tuple[Request | None, int | None] = (None, -2)


def _replaces(newer: Request | None, older: Request | None) -> bool:
    """Whether a newer change makes the older intermediate one obsolete."""
    if type(newer) is not type(older):
        return False
    same = ("name", "point", "lengths_follow")
    return all(getattr(newer, field, None) == getattr(older, field, None) for field in same)
