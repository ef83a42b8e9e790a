"""A workbench that runs in a browser's worker, which has no threads and no disk."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote

from linkwork.app.live.answers import Hurry
from linkwork.app.live.bench import Bench
from linkwork.app.live.events import Event, Refused
from linkwork.app.live.mechanism_file import MechanismFile, task_template
from linkwork.app.live.messages import MessageError, decoded, encoded
from linkwork.app.live.requests import SetText
from linkwork.app.live.session import Waiting, WorkSigns, answer, answers_of
from linkwork.app.live.subject import Read
from linkwork.core.foundation.errors import InputError
from linkwork.core.textfile.link import text_of_link
from linkwork.core.textfile.reader import blank_sheet

if TYPE_CHECKING:
    from linkwork.app.task.cycle import SolveTask
    from linkwork.synthesis.suggestion.suggesting import Suggesting


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
