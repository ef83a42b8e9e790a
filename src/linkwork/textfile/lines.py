"""The line number of every key of a TOML text."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from linkwork.foundation.names import canonical
from linkwork.textfile.tokens import Token, Tokens

__all__ = ["Lines", "Path"]

#: Keys, and from 0 the places in lists: ``("input", 1, "from")``.
Path = tuple[str | int, ...]
_DEEPEST = 8  # keys below are not kept: the format needs four, hostile files have thousands


@dataclass(frozen=True)
class Lines:
    """Line numbers, from 1, of the keys of one file.

    They are looked for when the first one is asked for: most files have no problem.

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
    def at(self) -> Mapping[Path, int]:
        """Line of every key, of every entry of a list, and of every table's first mention."""
        return _Scanner(self.text.removeprefix("\ufeff").replace("\r\n", "\n")).scanned()

    def line(self, path: Sequence[str | int]) -> int:
        """The line of a key, or of the nearest key around it; of the file itself, 1.

        A single ``[[input]]`` is found without its place in the list, and a name in any spelling.
        """
        for end in range(len(path), 0, -1):
            found = self._exact(tuple(path[:end]))
            if found is not None:
                return found
        return 1

    def _exact(self, path: Path) -> int | None:
        if path in self.at:
            return self.at[path]
        # a single table may be written [input] or [[input]]
        for candidate in (path, (path[0], 0, *path[1:])):
            if _folded(candidate) in self._by_folded:
                return self._by_folded[_folded(candidate)]
        return None

    @cached_property
    def _by_folded(self) -> dict[Path, int]:
        found: dict[Path, int] = {}
        for path, line in self.at.items():
            found.setdefault(_folded(path), line)
        return found


def _folded(path: Path) -> Path:
    return tuple(
        " ".join(canonical(part).split()) if isinstance(part, str) else part for part in path
    )


class _Scanner:
    """Walks the tokens of a valid text and notes where each path begins."""

    def __init__(self, text: str) -> None:
        self.tokens = Tokens(text)
        self.k = 0
        self.lines: dict[Path, int] = {}
        self.counts: dict[Path, int] = {}  # arrays of tables, and how many tables they have

    def scanned(self) -> dict[Path, int]:
        table: Path | None = ()
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
        """Step over one of the signs, if it stands here."""
        if self.is_sign(*signs):
            self.k += 1
            return True
        return False

    def skip_newlines(self) -> None:
        while self.token is not None and self.token.kind == "newline":
            self.k += 1

    def note(self, path: Path | None, token: Token) -> None:
        """Keep the line of a path and of every table it mentions for the first time."""
        for end in range(1, len(path or ()) + 1):
            self.lines.setdefault((path or ())[:end], self.tokens.line(token.at))

    def key(self) -> tuple[str, ...]:
        """The parts of a dotted key; the cursor ends behind it."""
        parts: list[str] = []
        while (token := self.token) is not None and token.kind in ("string", "word"):
            parts.append(_unquoted(token))
            self.k += 1
            if not self.skip("."):
                break
        return tuple(parts)

    def header(self) -> Path | None:
        """``[a.b]`` or ``[[a.b]]``: the path of the table that begins."""
        token = self.tokens.all[self.k]
        self.k += 1
        many = self.skip("[")
        *parents, last = self.key()
        self.skip("]")
        self.skip("]")
        path = self.resolved(parents)
        if path is None or len(path) + 2 > _DEEPEST:
            return None
        path = (*path, last)
        if many:
            self.note(path, token)
            # places in a list are counted from 0
            self.counts[path] = self.counts.get(path, -1) + 1
            # keys below the header belong to the entry just begun
            path = (*path, self.counts[path])
        else:
            path = self.current(path)
        self.note(path, token)
        return path

    def resolved(self, parts: Iterable[str]) -> Path | None:
        """The path of a header's parents: an array of tables stands for its last table."""
        path: Path = ()
        for part in parts:
            path = self.current((*path, part))
            if len(path) > _DEEPEST:
                return None
        return path

    def current(self, path: Path) -> Path:
        return (*path, self.counts[path]) if path in self.counts else path

    def pair(self, table: Path | None) -> None:
        """``key = value``."""
        token = self.tokens.all[self.k]
        path = _joined(table, self.key())
        self.note(path, token)
        if not self.skip("="):
            self.k += 1  # not TOML: go on rather than stand still
        self.value(path)

    def value(self, path: Path | None) -> None:
        if self.skip("["):
            self.array(path)
        elif self.skip("{"):
            self.inline_table(path)
        else:
            while (token := self.token) is not None and token.kind != "newline":
                if self.is_sign(",", "]", "}"):
                    return
                self.k += 1

    def array(self, path: Path | None) -> None:
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

    def inline_table(self, path: Path | None) -> None:
        while True:
            self.skip_newlines()
            if self.token is None or self.skip("}"):
                return
            self.pair(path)
            self.skip_newlines()
            self.skip(",")


def _joined(table: Path | None, parts: Path) -> Path | None:
    """The path below a table, or ``None`` where paths are too deep to be kept."""
    if table is None or len(table) + len(parts) > _DEEPEST:
        return None
    return (*table, *parts)


def _unquoted(token: Token) -> str:
    if token.kind == "word":
        return token.text
    if "\\" not in token.text:
        return token.text[1:-1]
    # escapes are decoded by the TOML parser itself
    return str(tomllib.loads(f"k = {token.text}")["k"])
