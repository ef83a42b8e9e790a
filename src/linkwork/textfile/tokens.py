"""The words and signs of a TOML text, in one linear pass that accepts any text.

Up to the first syntax error the tokens are those of TOML; after it they are arbitrary. This allows
limits to be checked before parsing, and lines to be found afterwards.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from functools import cached_property
from typing import NamedTuple

__all__ = ["Token", "Tokens"]

# Every alternative matches unterminated text too and never backtracks: time is linear.
_PATTERN = re.compile(
    r"""
      (?P<string> \"""(?:\\[\s\S]|"(?!"")|[^"\\])*+(?:\"""(?:"{0,2}))?
                | '''(?:'(?!'')|[^'])*+(?:'''(?:'{0,2}))?
                | "(?:\\[^\n]|[^"\\\n])*+"?
                | '[^'\n]*+'? )
    | (?P<comment> \#[^\n]*+ )
    | (?P<newline> \n )
    | (?P<space> [^\S\n]++ )
    | (?P<sign> [\[\]{}=,.] )
    | (?P<word> [^\s\[\]{}=,.\#"']++ )
    """,
    re.VERBOSE,
)


class Token(NamedTuple):
    """``kind`` is string, newline, sign or word; ``at`` is its index in the text."""

    kind: str
    text: str
    at: int


class Tokens:
    """The tokens of a text, without blanks and comments.

    Parameters
    ----------
    text : str
        With ``\\n`` line ends.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.all = [
            Token(str(found.lastgroup), found.group(), found.start())
            for found in _PATTERN.finditer(text)
            if found.lastgroup not in ("space", "comment")
        ]

    @cached_property
    def _starts(self) -> list[int]:
        return [0, *(k + 1 for k, c in enumerate(self.text) if c == "\n")]

    def line(self, at: int) -> int:
        """The line, from 1, of an index in the text."""
        return bisect_right(self._starts, at)
