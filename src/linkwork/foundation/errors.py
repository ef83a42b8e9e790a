"""Every exception Linkwork raises.

::

    LinkworkError                   exit code 3: our fault unless a subclass says otherwise
    ├── InputError                  exit code 2: what was asked cannot be understood
    │   ├── ExpressionError         a formula: text, column, what was expected
    │   ├── MechanismError          a mechanism: every problem found, each with its key
    │   │   └── MechanismFileError  the same, with file name and line numbers
    │   ├── UnknownNameError        a name that the mechanism or the library does not have
    │   └── MissingPackageError     an optional package, with its install command
    └── NotConvergedError           exit code 1: raised only on request (``throw=True``)

Wrong input raises. Mathematics that does not work out returns a
:class:`~linkwork.foundation.status.Status`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches

__all__ = [
    "ExpressionError",
    "InputError",
    "LinkworkError",
    "MechanismError",
    "MechanismFileError",
    "MissingPackageError",
    "NotConvergedError",
    "Problem",
    "UnknownNameError",
    "choices",
    "key_text",
]


class LinkworkError(Exception):
    """Base of every exception raised on purpose by this package."""

    exit_code = 3


class InputError(LinkworkError):
    """What was asked cannot be understood or contradicts itself."""

    exit_code = 2


class ExpressionError(InputError):
    """A formula that cannot be read; ``column`` counts from 1 in ``text``."""

    def __init__(self, message: str, text: str, column: int) -> None:
        super().__init__(message, text, column)
        self.message = message
        self.text = text
        self.column = column

    def __str__(self) -> str:
        return f"{self.message}\n{self.marked()}"

    def marked(self, width: int = 60) -> str:
        """The formula with a caret under the column, cut to ``width`` characters."""
        start = max(0, self.column - 1 - width // 2)
        piece = self.text[start : start + width].replace("\n", " ").replace("\t", " ")
        before = "…" if start else ""
        after = "…" if start + width < len(self.text) else ""
        caret = " " * (len(before) + self.column - 1 - start) + "^"
        return f"    {before}{piece}{after}\n    {caret}"


@dataclass(frozen=True, kw_only=True)
class Problem:
    """One thing that is wrong with a mechanism: where (key path, line) and what."""

    key: tuple[str | int, ...]
    message: str
    line: int | None = None

    def at_line(self, line: int | None) -> Problem:
        """The same problem with its line number in the file."""
        return replace(self, line=line)


class MechanismError(InputError):
    """A mechanism that cannot be understood; carries every problem that was found."""

    def __init__(self, problems: Iterable[Problem], where: str = "the mechanism") -> None:
        self.problems: tuple[Problem, ...] = tuple(problems)
        self.where = where
        super().__init__(self.problems, where)

    def __str__(self) -> str:
        count = len(self.problems)
        head = f"{count} problem{'s' if count != 1 else ''} in {self.where}"
        lines = [f"line {p.line}" if p.line is not None else "" for p in self.problems]
        keys = [key_text(p.key) for p in self.problems]
        line_width = max(map(len, lines), default=0)
        key_width = min(max(map(len, keys), default=0), 28)
        rows = [head]
        for line, key, problem in zip(lines, keys, self.problems, strict=True):
            place = f"  {line:<{line_width}}  " if line_width else "  "
            first, *rest = problem.message.split("\n")
            rows.append(f"{place}{key:<{key_width}}  {first}" if key else f"{place}{first}")
            rows += ["    " + text for text in rest]
        return "\n".join(rows)


class MechanismFileError(MechanismError):
    """A mechanism file, or the plan of a study, that cannot be understood, with line numbers."""


class UnknownNameError(InputError, KeyError):
    """A name that does not exist where it was looked up."""

    def __str__(self) -> str:
        return str(self.args[0])


class MissingPackageError(InputError, ImportError):
    """An optional package is needed and not installed."""


class NotConvergedError(LinkworkError):
    """A position that was asked for with ``throw=True`` could not be found."""

    exit_code = 1


def key_text(key: Sequence[str | int]) -> str:
    """A key path as it would be written in TOML: ``lengths."O2 A"``, ``input[2].from``."""
    parts: list[str] = []
    for part in key:
        if isinstance(part, int):
            parts[-1] += f"[{part + 1}]"
        elif part.replace("_", "").replace("-", "").isalnum():
            parts.append(part)
        else:
            parts.append(f'"{part}"')
    return ".".join(parts)


def choices(kind: str, names: Iterable[str], wanted: object = "") -> str:
    """What exists, for the end of a message: ``(joints: A, C, D)``, nearest names first."""
    known = list(names)
    if not known:
        return f"(there are no {kind})"
    near = get_close_matches(wanted, known, n=3) if wanted and isinstance(wanted, str) else []
    ordered = near + [name for name in known if name not in near]
    shown = ", ".join(ordered[:8]) + (f", … {len(ordered) - 8} more" if len(ordered) > 8 else "")
    return f"({kind}: {shown})"
