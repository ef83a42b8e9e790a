"""Read mechanism files: a description, or every problem with its line."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Set
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from linkwork.core.foundation.errors import (
    MechanismError,
    MechanismFileError,
    Problem,
    UnknownNameError,
    choices,
)
from linkwork.core.foundation.names import as_name
from linkwork.core.foundation.values import (
    Constant,
    Key,
    Kind,
    ListOf,
    Named,
    Table,
    Tables,
    TablesOrFormula,
)
from linkwork.core.mechanism.linkage import Draft, Linkage
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.textfile.keys import FORMAT, LINKAGE, form_of
from linkwork.core.textfile.structure import Structure
from linkwork.core.textfile.toml_text import Lines, bytes_of, data_of, text_of

#: Tables that only mechanisms have.
_DESCRIBED = ("points", "links", "loops", "equations")

#: Tables and keys that no other table refers to.
_LEAVES = frozenset(
    {"name", "purpose", "length", "source", "family", "configuration", "input", "trace", "outputs"}
    | {"questions"}
)


@dataclass(frozen=True, kw_only=True)
class ReadFile:
    """A mechanism file without errors, and the lines of its keys.

    Parameters
    ----------
    description : Linkage, Loops or PlainEquations
        The mechanism described.
    lines : Lines
        From key path to line number.
    name : str
        The file's name, for messages.
    text : str
        The file's content.
    """

    description: Linkage | Loops | PlainEquations
    lines: Lines
    name: str
    text: str

    def located(self, error: MechanismError) -> MechanismFileError:
        """The same problems with file name and line numbers, in the file's order."""
        return located_error(error.problems, self.lines, self.name)


def read_file(path: Path | str) -> ReadFile:
    """Read the mechanism in a file.

    Raises
    ------
    MechanismFileError
        With every problem found: file, line, key and remedy.
    """
    return read_bytes(bytes_of(Path(path), str(path)), str(path))


def read_bytes(data: bytes, name: str = "standard input") -> ReadFile:
    """Read the mechanism in the bytes of a file; raises like :func:`read_file`."""
    return read_text(text_of(data, name), name)


def read_text(text: str, name: str = "the text") -> ReadFile:
    """Read the mechanism in a text; raises like :func:`read_file`.

    Examples
    --------
    >>> file = read_text('''
    ... format = 1
    ... [equations]
    ... f = "x^2 - 2 = 0"
    ... [guess]
    ... x = 1
    ... ''')
    >>> dict(file.description.guess)
    {'x': 1}
    """
    data = data_of(text, name)
    lines = Lines.of(text)
    check_format(data, lines, name)
    check_kind(data, lines, name, task=False)
    form = form_of(data)
    structure = Structure(data, form)
    problems = list(structure.problems)
    lost = {(key,) for key in structure.lost}
    # if a required table has errors, the mechanism would only report consequences
    if structure.lost <= _LEAVES:
        kept = {key: entry for key, entry in structure.content.items() if key not in structure.lost}
        try:
            description = form.made(**_fields(kept, form.keys))
        except MechanismError as error:
            # a table with a structural problem is not reported twice
            problems += [p for p in error.problems if p.key[:1] not in lost]
        else:
            if not problems:
                return ReadFile(description=description, lines=lines, name=name, text=text)
    raise located_error(problems, lines, name) from None


@dataclass(frozen=True, kw_only=True)
class DraftFile:
    """A file of points and links that need not be a mechanism yet.

    Parameters
    ----------
    draft : Draft
        What the file contains, without tables whose keys or types are wrong.
    problems : tuple of Problem
        All that keeps the file from being a mechanism, with lines, in the file's order; none if it
        is a linkage, which may still lack an input.
    """

    draft: Draft
    problems: tuple[Problem, ...]


def read_draft(text: str, name: str = "the text") -> DraftFile:
    """Read points, links and parts, whether or not they are a mechanism.

    Raises
    ------
    MechanismFileError
        If the text is not TOML, is in a newer format, or contains equations, with every problem.

    Examples
    --------
    >>> file = read_draft("format = 1\\n[points]\\nA = [0, 0]")
    >>> list(file.draft.points), len(file.problems)
    (['A'], 2)
    """
    data = data_of(text, name)
    lines = Lines.of(text)
    check_format(data, lines, name)
    form = form_of(data)
    structure = Structure(data, form)
    if form is not LINKAGE:
        raise located_error(structure.problems, lines, name)
    kept = _without(structure.problems, structure.content, structure.lost)
    draft = Draft(**_fields(kept, form.keys))
    lost = {(key,) for key in structure.lost}
    found = [*structure.problems, *(p for p in draft.problems if p.key[:1] not in lost)]
    return DraftFile(draft=draft, problems=tuple(located_error(found, lines, name).problems))


def located_error(problems: Iterable[Problem], lines: Lines, name: str) -> MechanismFileError:
    """Problems with file name and line numbers, in the file's order."""
    found = [p if p.line is not None else p.at_line(lines.line(p.key)) for p in problems]
    return MechanismFileError(sorted(found, key=lambda p: p.line or 0), name)


def check_format(data: dict[str, Any], lines: Lines, name: str) -> None:
    """Reject other formats; further checks do not apply to them."""
    number = data.get("format", FORMAT)
    if type(number) is int and number > FORMAT:
        message = (
            f"is {number if number < 10**9 else 'too large'}, this version of Linkwork "
            f"reads format = {FORMAT}: update Linkwork"
        )
        raise located_error([Problem(key=("format",), message=message)], lines, name)


def check_kind(data: dict[str, Any], lines: Lines, name: str, *, task: bool) -> None:
    """Reject a task where a mechanism is wanted, and the other way round, in one sentence."""
    kind, command, function = (
        ("mechanism", "sweep", "load") if task else ("task", "synthesize", "Task.load")
    )
    marks = [key for key in data if key in ("task", *_DESCRIBED)]
    if {"task" if key == "task" else "mechanism" for key in marks} != {kind}:
        return
    told = (
        f"this is a {kind}: linkwork {command} FILE or linkwork view FILE, "
        f"in Python linkwork.{function}"
    )
    raise located_error([Problem(key=(marks[0],), message=told)], lines, name)


def _fields(content: Mapping[str, Any], keys: Iterable[Key]) -> dict[str, Any]:
    """The checked values of a table by the fields of the object that it describes."""
    known = {key.name: key for key in keys if not isinstance(key.kind, Constant)}
    kept = {known[name]: entry for name, entry in content.items() if name in known}
    return {key.attribute: _made(entry, key.kind) for key, entry in kept.items()}


def _made(entry: Any, kind: Kind) -> Any:
    """A checked value as the object that it describes; lists become tuples."""
    match kind:
        case Table(keys, made):
            return made(**_fields(entry, keys))
        case Tables() | TablesOrFormula() if not isinstance(entry, str):
            return tuple(kind.made(**_fields(each, kind.keys)) for each in entry)
        case Named(of):
            return {name: _made(each, of) for name, each in entry.items()}
        case ListOf(of):
            return tuple(_made(each, of) for each in entry)
        case _:
            return entry


def _without(
    problems: Iterable[Problem], content: dict[str, Any], lost: Set[str]
) -> dict[str, Any]:
    """The content of a file without the entries that have problems."""
    wrong = {problem.key[:2] for problem in problems}
    kept = {key: entry for key, entry in content.items() if key not in lost}
    for key in lost & content.keys():
        if isinstance(content[key], dict) and (key,) not in wrong:
            named = content[key].items()
            kept[key] = {name: entry for name, entry in named if (key, name) not in wrong}
    return kept


# ----------------------------------------------------------------------
# The mechanism files that come with Linkwork, by name.


_FOLDER = Path(__file__).parents[2] / "library"


def examples() -> tuple[str, ...]:
    """The names of all mechanisms of the library, in alphabetical order.

    Returns
    -------
    tuple of str

    Examples
    --------
    >>> import linkwork as lw
    >>> "rapier-drive" in lw.examples()
    True
    """
    return tuple(path.stem for path in sorted(_FOLDER.glob("*.toml")))


def example_text(name: str) -> str:
    """The text of a mechanism file of the library.

    Parameters
    ----------
    name : str
        One of :func:`examples`.

    Returns
    -------
    str
        TOML, as ``linkwork examples NAME`` prints it.

    Raises
    ------
    UnknownNameError
        If the library has no such mechanism.

    Examples
    --------
    >>> import linkwork as lw
    >>> print(lw.example_text("four-bar").splitlines()[1])
    name   = "Four-bar linkage, open"
    """
    known = examples()
    if as_name(name) not in known:
        raise UnknownNameError(f'there is no example "{name}" {choices("examples", known, name)}')
    return (_FOLDER / f"{name}.toml").read_text(encoding="utf-8")


def blank_sheet(name: str) -> str:
    """The text of a mechanism without points."""
    return f'format = 1\nname = {json.dumps(name, ensure_ascii=False)}\nlength = "mm"\n'
