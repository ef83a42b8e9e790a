"""The texts that a file has been, one behind the other, to be taken back and done again."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["History"]

_MOST_CHARACTERS = 20_000_000  # of all texts together; the oldest go first


@dataclass(frozen=True)
class _Step:
    """A text, and what led to it: ``A B = 50``."""

    text: str
    what: str


class History:
    """A line of texts and a place in it.

    Parameters
    ----------
    text : str
        The first one.
    """

    def __init__(self, text: str) -> None:
        self._steps = [_Step(text, "")]
        self._here = 0

    @property
    def text(self) -> str:
        """The text at this place."""
        return self._steps[self._here].text

    @property
    def undo_what(self) -> str:
        """What would be taken back, "" if there is nothing."""
        return self._steps[self._here].what

    @property
    def redo_what(self) -> str:
        """What would be done again, "" if there is nothing."""
        ahead = self._steps[self._here + 1 : self._here + 2]
        return ahead[0].what if ahead else ""

    def add(self, text: str, what: str) -> None:
        """A new text behind this place; what was ahead of it is forgotten."""
        if text == self.text:
            return
        self._steps[self._here + 1 :] = [_Step(text, what)]
        self._here += 1
        while self._here > 1 and sum(len(s.text) for s in self._steps) > _MOST_CHARACTERS:
            del self._steps[0]
            self._here -= 1

    def undone(self) -> str | None:
        """The text before, and there the place is from now on; ``None`` at the first one."""
        if not self._here:
            return None
        self._here -= 1
        return self.text

    def redone(self) -> str | None:
        """The text behind, likewise."""
        if self._here + 1 == len(self._steps):
            return None
        self._here += 1
        return self.text
