"""Members of public classes that serve the package only."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from itertools import islice
from typing import TypeVar

T = TypeVar("T", bound=type)
_NAMES = "__linkwork_internal__"


def internal(*names: str) -> Callable[[T], T]:
    """A class decorator: these fields and methods are no part of the public interface.

    The reference leaves them out; all others have public types in their signatures.
    """

    def marked(kind: T) -> T:
        setattr(kind, _NAMES, frozenset(names))
        return kind

    return marked


def internal_members(kind: type) -> frozenset[str]:
    """The internal members of a class and its base classes."""
    return frozenset().union(*(vars(base).get(_NAMES, ()) for base in kind.__mro__))


# ----------------------------------------------------------------------
# All exceptions that Linkwork raises.
#
# ::
#
#     LinkworkError                   exit code 3: an error of Linkwork, except for the subclasses
#     ├── InputError                  exit code 2: the input is wrong
#     │   ├── ExpressionError         a formula: text, column, what was expected
#     │   ├── MechanismError          a mechanism: every problem found, each with its key
#     │   │   └── MechanismFileError  the same, with file name and line numbers
#     │   ├── UnknownNameError        a name that the mechanism or the library does not have
#     │   └── MissingPackageError     an optional package, with its install command
#     └── NotConvergedError           exit code 1: raised only on request (``throw=True``)
#
# Wrong input raises an error. A computation that fails returns a
# :class:`~linkwork.core.foundation.statuses.Status`.


_MOST_COMPARED = 100  # known names with a wrong one


class LinkworkError(Exception):
    """Base of all exceptions that Linkwork raises on purpose.

    ``exit_code`` is the exit code of the command line.

    Examples
    --------
    >>> import linkwork as lw
    >>> issubclass(lw.InputError, lw.LinkworkError), lw.InputError.exit_code
    (True, 2)
    """

    exit_code = 3


class InputError(LinkworkError):
    """Wrong or contradictory input; the base of all such errors.

    Examples
    --------
    >>> import linkwork as lw
    >>> try:
    ...     lw.forces.Force(at="B", x=float("nan"), y=0)
    ... except lw.InputError as error:
    ...     print(error)
    the force at B is not finite: nan, 0
    """

    exit_code = 2


class ExpressionError(InputError):
    """A formula that cannot be read.

    Parameters
    ----------
    message : str
        What is wrong.
    text : str
        The formula.
    column : int
        Where it is wrong, counted from 1.

    Examples
    --------
    >>> import linkwork as lw
    >>> try:
    ...     lw.example("crank-shaper").description.numbers("2 * q")
    ... except lw.ExpressionError as error:
    ...     print(error.column, error.message)
    5 column 5: "q" is not defined (dimensions: r, d)
    """

    def __init__(self, message: str, text: str, column: int) -> None:
        super().__init__(message, text, column)
        self.message = message
        self.text = text
        self.column = column

    def __str__(self) -> str:
        return f"{self.message}\n{self.marked()}"

    def marked(self, width: int = 60) -> str:
        """The formula with a caret under the column, cut to ``width`` characters."""
        # the column is in the middle of a long formula
        start = max(0, self.column - 1 - width // 2)
        piece = self.text[start : start + width].replace("\n", " ").replace("\t", " ")
        before = "…" if start else ""
        after = "…" if start + width < len(self.text) else ""
        caret = " " * (len(before) + self.column - 1 - start) + "^"
        return f"    {before}{piece}{after}\n    {caret}"


@internal("at_line")
@dataclass(frozen=True, kw_only=True)
class Problem:
    """One problem of a mechanism or file.

    Parameters
    ----------
    key : tuple of str and int
        The key path, as ``("lengths", "O2 A")``.
    message : str
        What is wrong and how to correct it.
    line : int, optional
        The line of the file.

    Examples
    --------
    >>> import linkwork as lw
    >>> try:
    ...     lw.linkage(points={"A": (0, 0)}, links={"ground": ["A", "B"]})
    ... except lw.MechanismError as error:
    ...     print(error.problems[0].key, error.problems[0].message)
    ('links', 'ground') point "B" is not defined (points: A)
    """

    key: tuple[str | int, ...]
    message: str
    line: int | None = None

    def at_line(self, line: int | None) -> Problem:
        """The same problem with its line number in the file."""
        return replace(self, line=line)


class MechanismError(InputError):
    """A wrong description of a mechanism, with every problem that was found.

    Parameters
    ----------
    problems : iterable of Problem
        The problems; the attribute is a tuple.
    where : str
        The name of the mechanism or file, for the message.

    Examples
    --------
    >>> import linkwork as lw
    >>> try:
    ...     lw.example("four-bar").changed(lengths={"O2 A": -40})
    ... except lw.MechanismError as error:
    ...     print(error)
    1 problem in mechanism "Four-bar linkage, open"
      lengths."O2 A"  must be a positive length, got -40
    """

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
    """A mechanism file, or the plan of a study, with errors; every problem has its line number.

    Parameters are those of :class:`MechanismError`.

    Examples
    --------
    >>> import linkwork as lw
    >>> text = lw.example_text("four-bar").replace('link  = "crank"', 'link  = "crnk"')
    >>> try:
    ...     lw.loads(text, "bar.toml")
    ... except lw.MechanismFileError as error:
    ...     print(error.problems[0].line, error.problems[0].message)
    28 link "crnk" is not defined (links: crank, ground, coupler, rocker)
    """


class UnknownNameError(InputError, KeyError):
    """A name that does not exist; the message lists the nearest existing names.

    Examples
    --------
    >>> import linkwork as lw
    >>> try:
    ...     lw.example("four-bar").solve()["rockr"]
    ... except lw.UnknownNameError as error:
    ...     print(error)
    there is no "rockr" (nearest: rocker, crank, coupler; all: linkwork quantities FILE)
    """

    def __str__(self) -> str:
        return str(self.args[0])


class MissingPackageError(InputError, ImportError):
    """An optional package is needed and not installed; the message contains the install command.

    Examples
    --------
    >>> import linkwork as lw
    >>> issubclass(lw.MissingPackageError, ImportError)
    True
    """


class NotConvergedError(LinkworkError):
    """No position was found, and the caller asked for an exception with ``throw=True``.

    Examples
    --------
    >>> import linkwork as lw
    >>> short = {"O2 A": 40, "A B": 30, "O4 B": 20, "O2 O4": 100}
    >>> try:
    ...     lw.example("four-bar").changed(lengths=short).solve(throw=True)
    ... except lw.NotConvergedError as error:
    ...     print(error.exit_code)
    1
    """

    exit_code = 1


#: Words the path of a key for a message.
KeyWords = Callable[[Sequence[str | int]], str]


def key_text(key: Sequence[str | int]) -> str:
    """A key path in TOML notation: ``lengths."O2 A"``, ``input[2].from``."""
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
    """The existing names for the end of a message: ``(joints: A, C, D)``, nearest names first."""
    known = list(map(str, names))  # a table of a user may name its columns by numbers
    if not known:
        return f"(there are no {kind})"
    # the nearest names first: lists are cut after eight
    near = _nearest(wanted, known) if wanted and isinstance(wanted, str) else []
    ordered = near + [name for name in known if name not in near]
    shown = ", ".join(ordered[:8]) + (f", … {len(ordered) - 8} more" if len(ordered) > 8 else "")
    return f"({kind}: {shown})"


def undefined(kind: str, name: str, known: Iterable[str]) -> str:
    """The message about a name that does not exist: ``point "B" is not defined (points: A)``."""
    return f'{kind} "{name}" is not defined {choices(f"{kind}s", known, name)}'


def _nearest(wanted: str, known: list[str]) -> list[str]:
    # to compare every wrong name with every known one would take minutes for thousands of each
    if len(known) > _MOST_COMPARED:
        alike = (name for name in known if name[:2] == wanted[:2])
        known = list(islice(alike, _MOST_COMPARED))
    return get_close_matches(wanted, known, n=3)
