"""The words and signs of a TOML text, in one linear pass that accepts any text.

Up to the first syntax error the tokens are those of TOML; after it they are arbitrary. This allows
limits to be checked before parsing, and lines to be found afterwards.
"""

from __future__ import annotations

import os
import re
import tomllib
from bisect import bisect_right
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from glob import escape
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from linkwork.core.foundation.errors import MechanismFileError, Problem, choices
from linkwork.core.foundation.names import canonical

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


# ----------------------------------------------------------------------
# The line number of every key of a TOML text.


#: Keys, and indices in lists: ``("input", 1, "from")``.
KeyPath = tuple[str | int, ...]
_LINES_DEEPEST = 8  # keys below are not kept: the format needs four, hostile files have thousands


@dataclass(frozen=True)
class Lines:
    """Line numbers, from 1, of the keys of one file.

    They are computed at the first request, since most files have no problem.

    Parameters
    ----------
    text : str
        Valid TOML (with or without BOM, LF or CRLF).
    """

    text: str

    @classmethod
    def of(cls, text: str) -> Lines:
        """The index of a text that is valid TOML (with or without BOM, LF or CRLF)."""
        return cls(text)

    @cached_property
    def at(self) -> Mapping[KeyPath, int]:
        """Lines of all keys, list entries and first mentions of tables."""
        return _Scanner(self.text.removeprefix("\ufeff").replace("\r\n", "\n")).scanned()

    def line(self, path: Sequence[str | int]) -> int:
        """The line of a key, or of the nearest enclosing key; 1 for the file itself.

        A single ``[[input]]`` is found without its index, and a name in any spelling.
        """
        for end in range(len(path), 0, -1):
            found = self._exact(tuple(path[:end]))
            if found is not None:
                return found
        return 1

    def _exact(self, path: KeyPath) -> int | None:
        if path in self.at:
            return self.at[path]
        # a single table may be written [input] or [[input]]
        for candidate in (path, (path[0], 0, *path[1:])):
            if _folded(candidate) in self._by_folded:
                return self._by_folded[_folded(candidate)]
        return None

    @cached_property
    def _by_folded(self) -> dict[KeyPath, int]:
        found: dict[KeyPath, int] = {}
        for path, line in self.at.items():
            found.setdefault(_folded(path), line)
        return found


def _folded(path: KeyPath) -> KeyPath:
    return tuple(
        " ".join(canonical(part).split()) if isinstance(part, str) else part for part in path
    )


class _Scanner:
    """Reads the tokens of a valid text and records where each path begins."""

    def __init__(self, text: str) -> None:
        self.tokens = Tokens(text)
        self.k = 0
        self.lines: dict[KeyPath, int] = {}
        self.counts: dict[KeyPath, int] = {}  # number of tables in every array of tables

    def scanned(self) -> dict[KeyPath, int]:
        table: KeyPath | None = ()
        while self.token is not None:
            if self.token.kind == "newline":
                self.k += 1
            elif self.is_sign("["):
                table = self.header()
            else:
                self.pair(table)
        return self.lines

    @property
    def token(self) -> Token | None:
        return self.tokens.all[self.k] if self.k < len(self.tokens.all) else None

    def is_sign(self, *signs: str) -> bool:
        token = self.token
        return token is not None and token.kind == "sign" and token.text in signs

    def skip(self, *signs: str) -> bool:
        """Skip one of the signs, if it is next."""
        if self.is_sign(*signs):
            self.k += 1
            return True
        return False

    def skip_newlines(self) -> None:
        while self.token is not None and self.token.kind == "newline":
            self.k += 1

    def note(self, path: KeyPath | None, token: Token) -> None:
        """Record the line of a path and of tables first mentioned in it."""
        for end in range(1, len(path or ()) + 1):
            self.lines.setdefault((path or ())[:end], self.tokens.line(token.at))

    def key(self) -> tuple[str, ...]:
        """The parts of a dotted key; moves the cursor past it."""
        parts: list[str] = []
        while (token := self.token) is not None and token.kind in ("string", "word"):
            parts.append(_unquoted(token))
            self.k += 1
            if not self.skip("."):
                break
        return tuple(parts)

    def header(self) -> KeyPath | None:
        """``[a.b]`` or ``[[a.b]]``: the path of the table that begins."""
        token = self.tokens.all[self.k]
        self.k += 1
        many = self.skip("[")
        *parents, last = self.key()
        self.skip("]")
        self.skip("]")
        path = self.resolved(parents)
        if path is None or len(path) + 2 > _LINES_DEEPEST:
            return None
        path = (*path, last)
        if many:
            self.note(path, token)
            # indices in a list count from 0
            self.counts[path] = self.counts.get(path, -1) + 1
            # keys below the header belong to the entry just begun
            path = (*path, self.counts[path])
        else:
            path = self.current(path)
        self.note(path, token)
        return path

    def resolved(self, parts: Iterable[str]) -> KeyPath | None:
        """The path of a header's parents: an array of tables means its last table."""
        path: KeyPath = ()
        for part in parts:
            path = self.current((*path, part))
            if len(path) > _LINES_DEEPEST:
                return None
        return path

    def current(self, path: KeyPath) -> KeyPath:
        return (*path, self.counts[path]) if path in self.counts else path

    def pair(self, table: KeyPath | None) -> None:
        """``key = value``."""
        token = self.tokens.all[self.k]
        path = _joined(table, self.key())
        self.note(path, token)
        if not self.skip("="):
            self.k += 1  # not TOML: skip, to avoid an endless loop
        self.value(path)

    def value(self, path: KeyPath | None) -> None:
        if self.skip("["):
            self.array(path)
        elif self.skip("{"):
            self.inline_table(path)
        else:
            while (token := self.token) is not None and token.kind != "newline":
                if self.is_sign(",", "]", "}"):
                    return
                self.k += 1

    def array(self, path: KeyPath | None) -> None:
        for k in range(len(self.tokens.all)):
            self.skip_newlines()
            token = self.token
            if token is None or self.skip("]"):
                return
            item = _joined(path, (k,))
            self.note(item, token)
            self.value(item)
            self.skip_newlines()
            self.skip(",")

    def inline_table(self, path: KeyPath | None) -> None:
        while True:
            self.skip_newlines()
            if self.token is None or self.skip("}"):
                return
            self.pair(path)
            self.skip_newlines()
            self.skip(",")


def _joined(table: KeyPath | None, parts: KeyPath) -> KeyPath | None:
    """The path below a table, or ``None`` if paths are too deep to record."""
    if table is None or len(table) + len(parts) > _LINES_DEEPEST:
        return None
    return (*table, *parts)


def _unquoted(token: Token) -> str:
    if token.kind == "word":
        return token.text
    if "\\" not in token.text:
        return token.text[1:-1]
    # escapes are decoded by the TOML parser itself
    return str(tomllib.loads(f"k = {token.text}")["k"])


# ----------------------------------------------------------------------
# Parse the bytes of a TOML file; reject broken or hostile files with a reason.


#: Maximum size of a file [bytes].
LARGEST = 1_000_000
_TOML_TEXT_DEEPEST = 20  # nested brackets; the format needs three
_MOST_PARTS = 8  # of a dotted key; the parser's memory grows quadratically
_LONGEST_WORD = 400  # bare keys and numbers: Python itself rejects longer numbers
_PLACE = re.compile(r" \((?:at line (\d+), column (\d+)|at end of document)\)$")
_TWICE = re.compile(r"cannot declare \('(.*)'(?:,)?\) twice")
_SEPARATOR = "', '"
_NOT_QUOTED = re.compile(r"[\w']+")


def _refuse(name: str, message: str, line: int | None = None) -> NoReturn:
    raise MechanismFileError([Problem(key=(), message=message, line=line)], name)


def bytes_of(path: Path, name: str, most: int = LARGEST) -> bytes:
    """The bytes of a file, at most so many.

    Raises
    ------
    MechanismFileError
        If the file does not exist, cannot be read or is too large.
    """
    try:
        with path.open("rb") as file:
            # one byte more than allowed shows that the file is too large without reading all of it
            data = file.read(most + 1)
            if len(data) > most:
                _refuse(name, _too_large(max(path.stat().st_size, len(data)), most))
            return data
    except FileNotFoundError:
        _refuse(name, f"there is no such file {_files_beside(path)}")
    except (OSError, ValueError) as error:
        if os.path.isdir(path):
            _refuse(name, f"is a folder: name one file in it {_files_beside(path / 'x')}")
        reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
        _refuse(name, f"cannot be read: {reason}")


def _files_beside(path: Path) -> str:
    suffix = path.suffix or ".toml"
    try:
        found = sorted(other.name for other in path.parent.glob(f"*{escape(suffix)}"))
    except (OSError, ValueError):
        found = []
    return choices(f"{suffix[1:].upper()} files there", found, path.name)


def _too_large(size: int, most: int = LARGEST) -> str:
    return f"has {size / 1e6:.1f} MB: at most {most / 1e6:.0f} MB is read"


def text_of(data: bytes, name: str) -> str:
    """The text of UTF-8 bytes with or without BOM.

    Raises
    ------
    MechanismFileError
        If there are too many bytes, or they are not UTF-8.
    """
    if len(data) > LARGEST:
        _refuse(name, _too_large(len(data)))
    # byte order marks of UTF-16, written by Windows editors
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        _refuse(name, "is UTF-16 text: save it as UTF-8", 1)
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        _refuse(
            name,
            f"byte {error.start} (0x{data[error.start]:02x}) is not UTF-8: save the file as UTF-8",
            line,
        )


def data_of(text: str, name: str) -> dict[str, Any]:
    """The data of a TOML text.

    Raises
    ------
    MechanismFileError
        If the text is too long, too deeply nested or not TOML; with line and column.
    """
    if len(text) > LARGEST:
        _refuse(name, _too_large(len(text)))
    text = text.removeprefix("\ufeff").replace("\r\n", "\n")
    if "\0" in text:
        at = text.index("\0")
        _refuse(name, "contains a NUL character: not a text file", text.count("\n", 0, at) + 1)
    if not text.strip():
        _refuse(name, 'is empty: "linkwork examples" lists files to start from', 1)
    _check_limits(Tokens(text), name)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        _refuse(name, *_explained(str(error), text))
    except (ValueError, RecursionError, OverflowError) as error:
        # The limits prevent all known cases; the parser may find others.
        _refuse(name, f"is not TOML: {error}", 1)


def _check_limits(tokens: Tokens, name: str) -> None:
    """Reject text that would need excessive memory or recursion in the parser."""
    depth = parts = 0
    previous = beyond = ""
    for kind, text, at in tokens.all:
        if kind == "sign":
            depth += (text in "[{") - (text in "]}")
        elif kind in ("word", "string"):
            parts = parts + 1 if previous == "." else 1
            if kind == "word" and len(text) > _LONGEST_WORD:
                beyond = f"a word of {len(text)} characters: at most {_LONGEST_WORD} are allowed"
        if depth > _TOML_TEXT_DEEPEST:
            beyond = f"brackets nested deeper than {_TOML_TEXT_DEEPEST} levels"
        if parts > _MOST_PARTS:
            beyond = f"a dotted key of more than {_MOST_PARTS} parts"
        if beyond:
            _refuse(name, beyond, tokens.line(at))
        previous = text


def _explained(message: str, text: str) -> tuple[str, int]:
    """The parser's message with a hint, and its line."""
    rows = text.split("\n")
    place = _PLACE.search(message)
    what = _PLACE.sub("", message)
    what = what[:1].lower() + what[1:]
    if twice := _TWICE.fullmatch(what):
        what = f"the table [{twice[1].replace(_SEPARATOR, '.')}] occurs twice"
    if place is None or place[1] is None:
        # the parser gives no line for the end of the text: use the last line with content
        line = max((k for k, row in enumerate(rows, 1) if row.strip()), default=1)
        return f"is not TOML: {what} (at the end){_hint(what, rows[line - 1], None)}", line
    line, column = int(place[1]), int(place[2])
    row = rows[line - 1]
    return f"is not TOML: {what} (column {column}){_hint(what, row, column)}", line


def _hint(what: str, row: str, column: int | None) -> str:
    """The remedy; empty if it is uncertain."""
    if what == "cannot overwrite a value":
        return f": {row.split('=')[0].strip()} is given twice"
    if what.startswith("unclosed"):
        return ": a closing bracket or comma is missing before this"
    if what == r"illegal character '\n'":
        return ": the closing quote is missing"
    if column is None or column > len(row):
        return ""
    spaced = re.match(r"\s*([^\s=\"'#\[]+(?: +[^\s=\"'#\[]+)+)\s*=", row)
    if spaced and column <= spaced.end():
        return f': write a name with spaces in quotes: "{spaced[1]}"'
    if what == "invalid value":
        return ": write text, names and formulas in quotes"
    # a decimal comma, as in 1,5
    if row[column - 1] == "," and re.search(r"=\s*[-+]?\d+,\d+\s*(#.*)?$", row):
        return ": write decimals with a point"
    if unit := re.search(r"=\s*[-+]?[\d.]+\s*(mm|cm|dm|m|km|in|inch|ft|deg|rad)\s*(#.*)?$", row):
        key = "angle" if unit[1] in ("deg", "rad") else "length"
        return f': write numbers without a unit; {key} = "{unit[1]}" sets the unit'
    if row[column - 1] == "°":
        return ': write numbers without a unit; angle = "deg" sets the unit'
    word = next((w.group() for w in _NOT_QUOTED.finditer(row) if w.end() >= column), "")
    if "=" in row[: column - 1] and "{" not in row:
        return ": write text, names and formulas in quotes"
    if row[column - 1].isascii() or not word:
        return ""
    spelled = canonical(word)
    other = f", or write {spelled}" if spelled.isascii() and spelled.isidentifier() else ""
    return f': TOML needs quotes around names that are not ASCII: "{word}"{other}'
