"""The thread that runs a workbench, one request after the other, separate from the network."""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable

from linkwork.viewer.live.events import Event, Refused
from linkwork.viewer.live.requests import EDITS, Request
from linkwork.viewer.live.workbench import Workbench

__all__ = ["Desk", "Tell"]

_log = logging.getLogger("linkwork.viewer")

#: Takes the events that came of something, and the id of the request that they answer.
Tell = Callable[[list[Event], int | None], None]

_LOOK_AT_FILE = 0.5  # seconds between looks at the file on disk


class Desk:
    """Works on requests in the order in which they came.

    Changes on the way that wait behind a newer one of the same kind are left out: only the latest
    place of a slider matters.

    Parameters
    ----------
    workbench : Workbench
        Nobody else may use it until :meth:`close`.
    tell : callable
        Called in the desk's thread.
    """

    def __init__(self, workbench: Workbench, tell: Tell) -> None:
        self._workbench, self._tell = workbench, tell
        self._waiting: deque[tuple[Request | None, int | None]] = deque()
        self._changed = threading.Condition()
        self._closing = False
        workbench.hurried = self._hurried
        self._thread = threading.Thread(target=self._work, name="linkwork desk", daemon=True)
        self._thread.start()

    @property
    def waiting(self) -> int:
        """How many requests wait."""
        return len(self._waiting)

    def prepare(self) -> None:
        """Solve what :meth:`open` will tell."""
        self.ask(*_UNTOLD)

    def open(self) -> None:
        """Tell everything from the beginning."""
        self.ask(None, None)

    def ask(self, request: Request | None, number: int | None) -> None:
        """A request to be worked on; its events come with this id."""
        with self._changed:
            self._waiting.append((request, number))
            self._changed.notify()

    def close(self, patience: float = 5.0) -> bool:
        """Finish what is being worked on and stop; whether that was done in time [s]."""
        with self._changed:
            self._closing = True
            self._changed.notify()
        self._thread.join(patience)
        return not self._thread.is_alive()

    def _hurried(self) -> bool:
        with self._changed:
            return self._closing or any(isinstance(r, EDITS) for r, _ in self._waiting)

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
        """The next request; older places of a thing that is being dragged are left out."""
        request, number = self._waiting.popleft()
        while getattr(request, "live", False) and self._waiting:
            if not _replaces(self._waiting[0][0], request):
                break
            # a point that is dragged sends places faster than they are solved: only the last
            # matters
            request, number = self._waiting.popleft()
        return request, number

    def _do(self, request: Request | None, number: int | None) -> None:
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
        except Exception as error:  # whatever it is, the page and what is unsaved must live on
            _log.exception("a request failed")
            mistake = f"{type(error).__name__}: {error}"
            number = None if request is None else number
            events = [Refused(message=f"this is an error in Linkwork, please report it: {mistake}")]
        if events or number is not None:
            self._tell(events, number)


#: Beside requests and their ids: a look at the file, and work that nobody waits for.
_NOTHING: tuple[Request | None, int | None] = (None, -1)
_UNTOLD: tuple[Request | None, int | None] = (None, -2)


def _replaces(newer: Request | None, older: Request | None) -> bool:
    """Whether the older change on the way is worthless beside the newer one."""
    if type(newer) is not type(older):
        return False
    same = ("name", "point", "lengths_follow")
    return all(getattr(newer, field, None) == getattr(older, field, None) for field in same)
