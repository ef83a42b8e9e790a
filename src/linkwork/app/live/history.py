"""The history of a file's text, for undo and redo."""

from __future__ import annotations

from dataclasses import dataclass

_MOST_CHARACTERS = 20_000_000  # of all texts together; the oldest texts are dropped first


@dataclass(frozen=True)
class _Step:
    """A text and the change that led to it: ``A B = 50``."""

    text: str
    what: str


class History:
    """A sequence of texts and the current position in it.

    Parameters
    ----------
    text : str
        The initial text.
    """

    def __init__(self, text: str) -> None:
        self._steps = [_Step(text, "")]
        self._here = 0

    @property
    def text(self) -> str:
        """The current text."""
        return self._steps[self._here].text

    @property
    def undo_what(self) -> str:
        """The change that undo reverts; "" if there is none."""
        return self._steps[self._here].what

    @property
    def redo_what(self) -> str:
        """The change that redo repeats; "" if there is none."""
        ahead = self._steps[self._here + 1 : self._here + 2]
        return ahead[0].what if ahead else ""

    def add(self, text: str, what: str) -> None:
        """Add a text after the current one; later texts are dropped."""
        if text == self.text:
            return
        self._steps[self._here + 1 :] = [_Step(text, what)]
        self._here += 1
        # always keep the current text and the previous one
        while self._here > 1 and sum(len(s.text) for s in self._steps) > _MOST_CHARACTERS:
            del self._steps[0]
            self._here -= 1

    def undone(self) -> str | None:
        """Go to the previous text and return it; ``None`` at the first one."""
        if not self._here:
            return None
        self._here -= 1
        return self.text

    def redone(self) -> str | None:
        """Go to the next text and return it; ``None`` at the last one."""
        if self._here + 1 == len(self._steps):
            return None
        self._here += 1
        return self.text
