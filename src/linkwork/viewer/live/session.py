"""The thread that processes requests for a workbench, separate from the network."""

from __future__ import annotations

import threading
from functools import partial

from linkwork.viewer.live.answers import Hurry
from linkwork.viewer.live.bench import Bench
from linkwork.viewer.live.requests import Request
from linkwork.viewer.live.waiting import Tell, Waiting, WorkSigns, answer, answers_of
from linkwork.viewer.live.workbench import Workbench

__all__ = ["Desk"]

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
        """Send the complete state; what is known of it at once, while a long answer is prepared."""
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
