"""A file of another program: its text, numbers, refusals, and the list of what is left out."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NoReturn

from linkwork.foundation.errors import MechanismFileError, Problem
from linkwork.mechanism.dimensions import LARGEST as LARGEST_NUMBER

__all__ = ["LARGEST", "LeftOut", "Source"]

#: Maximum size of a file, packed or unpacked [bytes].
LARGEST = 4_000_000
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_SHOWN = 60  # characters of a wrong word in a message


@dataclass(frozen=True, kw_only=True)
class LeftOut:
    """Something in a file of another program that was not carried over.

    Parameters
    ----------
    what : str
        What it is, and why.
    places : tuple of str
        Where it is in the file.

    Examples
    --------
    >>> import linkwork as lw
    >>> print(lw.LeftOut(what="force", places=("line 3", "line 7", "line 9")))
    line 3 and 2 more: force
    """

    what: str
    places: tuple[str, ...]

    def __str__(self) -> str:
        more = len(self.places) - 1
        return f"{self.places[0]}{f' and {more} more' if more else ''}: {self.what}"


class Source:
    """The bytes of a file, its name for messages, and what was left out so far."""

    def __init__(self, data: bytes, name: str) -> None:
        self.data, self.name = data, name
        self._left_out: dict[str, dict[str, None]] = {}
        if len(data) > LARGEST:
            self.refuse(f"has more than {LARGEST / 1e6:.0f} MB: more is not read")

    @property
    def left_out(self) -> tuple[LeftOut, ...]:
        """What was left out, in the file's order."""
        found = self._left_out.items()
        return tuple(LeftOut(what=what, places=tuple(places)) for what, places in found)

    def leave_out(self, place: str, what: str) -> None:
        """Note what is not carried over."""
        self._left_out.setdefault(what, {})[place] = None

    def refuse(
        self, message: str, line: int | None = None, key: Sequence[str | int] = ()
    ) -> NoReturn:
        """Refuse the file.

        Raises
        ------
        MechanismFileError
            Always: with the reason and its place.
        """
        problem = Problem(key=tuple(key), message=message, line=line)
        raise MechanismFileError([problem], self.name)

    def text(self) -> str:
        """The file as text, without byte order mark."""
        try:
            text = self.data.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            line = self.data.count(b"\n", 0, error.start) + 1
            self.refuse(f"byte {error.start} (0x{self.data[error.start]:02x}) is not UTF-8", line)
        if "\0" in text:
            self.refuse("contains a NUL character: not a text file")
        return text

    def number(self, given: object, what: str, line: int | None = None) -> float:
        """A finite number that is a text or a number of JSON."""
        if isinstance(given, str) and _NUMBER.fullmatch(given.strip()):
            number = float(given)
        elif isinstance(given, int | float) and not isinstance(given, bool):
            number = float(given) if abs(given) <= LARGEST_NUMBER else math.inf
        else:
            self.refuse(f"{what} must be a number, got {_shown(given)}", line)
        if not abs(number) <= LARGEST_NUMBER:
            self.refuse(f"{what} is {_shown(given)}: at most {LARGEST_NUMBER:g}", line)
        return number

    def numbers(self, given: str, count: int, what: str, line: int | None = None) -> list[float]:
        """So many numbers between spaces."""
        words = given.split()
        if len(words) != count:
            self.refuse(f"{what} must be {count} numbers, got {len(words)}", line)
        return [self.number(word, what, line) for word in words]

    def chosen(self, given: str, known: Mapping[str, str], what: str) -> str:
        """The word that stands for an entry of a list, or its first word, with a note."""
        if given in known:
            return known[given]
        usual = next(iter(known.values()))
        self.leave_out(what, f"unknown {_shown(given)}, {usual} is assumed")
        return usual


def _shown(given: object) -> str:
    text = given if isinstance(given, str) else type(given).__name__
    return '"' + "".join(c if c.isprintable() else "?" for c in text[:_SHOWN]) + '"'
