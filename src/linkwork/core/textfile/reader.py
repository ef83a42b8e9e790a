"""Check that TOML data has the tables, keys and types of :mod:`~linkwork.core.textfile.keys`."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Set
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from linkwork.core.foundation.errors import (
    MechanismError,
    MechanismFileError,
    Problem,
    UnknownNameError,
    choices,
)
from linkwork.core.foundation.names import as_name, canonical
from linkwork.core.foundation.values import (
    Constant,
    Either,
    Flag,
    Formula,
    Key,
    Kind,
    ListOf,
    Measured,
    Named,
    NumberValue,
    PlainNumber,
    Several,
    Speed,
    Table,
    Tables,
    TablesOrFormula,
    Text,
    Whole,
)
from linkwork.core.mechanism.linkage import Draft, Linkage
from linkwork.core.mechanism.loops import Loops, PlainEquations
from linkwork.core.textfile.keys import FORMAT, FORMS, LINKAGE, Form, form_of
from linkwork.core.textfile.toml_text import KeyPath, Lines, bytes_of, data_of, text_of

_LONGEST_SHOWN = 40  # characters of a value in a message


class Structure:
    """The checked content of a file.

    ``problems`` lists the errors; ``lost`` names the top-level tables and keys with omitted
    content, for which further checks would report misleading errors.
    """

    def __init__(self, data: dict[str, Any], form: Form) -> None:
        self.form = form
        self.problems: list[Problem] = []
        self.lost: set[str] = set()
        self.content = self._table(data, form.keys, ())

    def _wrong(self, path: KeyPath, message: str, lost: bool = True) -> None:
        self.problems.append(Problem(key=path, message=message))
        if lost:
            self.lost.add(str(path[0]))

    def _table(self, data: dict[str, Any], keys: Iterable[Key], path: KeyPath) -> dict[str, Any]:
        """The known keys of a table with their checked values."""
        known = {key.name: key for key in keys}
        checked = {}
        for name, entry in data.items():
            if name in known:
                checked[name] = self._value(entry, known[name].kind, (*path, name))
            else:
                self._unknown_key(name, set(data), list(known), path)
        for key in known.values():
            if key.required and key.name not in data:
                doc = key.doc[:1].lower() + key.doc[1:]
                self._wrong((*path, key.name), f"is missing: {doc}")
        return checked

    def _unknown_key(self, name: str, present: set[str], known: list[str], path: KeyPath) -> None:
        table = _table_text(path)
        forms = FORMS if self.form in FORMS else ()
        # a key of another kind of file is not a spelling mistake
        others = [form for form in forms if name in _names_in_form(form, path)]
        free = [key for key in known if key not in present]
        titles = " and ".join(f"{form.title} files" for form in others)
        if others and not path:
            message = f"belongs to {titles}, but this is a {self.form.title} file{_why(self.form)}"
        elif others:
            message = f"belongs to {titles} {choices(f'keys of {table} here', known, name)}"
        else:
            message = f"is not a key of {table} {choices('keys', known, name)}"
        # A misspelt key would be reported again as missing, or as having no effect.
        lost = bool(others or get_close_matches(name, free, n=1))
        self._wrong((*path, name), message, lost)

    def _value(self, entry: Any, kind: Kind, path: KeyPath) -> Any:
        """The entry converted to its kind; a mismatch is recorded as a problem."""
        match kind:
            case Text() if isinstance(entry, dict) and self._has_table(f"{path[-1]}s"):
                self._wrong(path, f"is the unit, a text in quotes: name the table [{path[-1]}s]")
            case Table(keys):
                return self._sub_table(entry, keys, path)
            case Tables(keys, True) if isinstance(entry, dict):
                return [self._table(entry, keys, path)]
            case Tables(keys, single):
                wanted = f"[{path[-1]}] or [[{path[-1]}]]" if single else f"[[{path[-1]}]]"
                return self._tables(entry, keys, f"written as {wanted}", path)
            case TablesOrFormula(keys) if not isinstance(entry, str):
                wanted = f"a formula in quotes or a list of tables, {path[-1]} = [{{ … }}, …]"
                return self._tables(entry, keys, wanted, path)
            case Named():
                return self._named(entry, kind, path)
            case ListOf():
                return self._list(entry, kind, path)
            case Several():
                return self._several(entry, kind, path)
            case Either():
                return self._either(entry, kind, path)
            case NumberValue():
                self._check_number(entry, "a number or a formula in quotes", path)
            case PlainNumber():
                self._check_number(entry, "a number", path, text=False)
            case Whole(least, most) if type(entry) is not int or not least <= entry <= most:
                above = type(entry) is int and entry > most
                bound = f"at most {most}" if above else f"at least {least}"
                self._wrong(path, f"must be a whole number of {bound}, got {_shown(entry)}")
            case Speed():
                self._check_number(entry, 'a number or text such as "300 rpm"', path)
            case Measured(example):
                self._check_number(entry, f'a number or text such as "{example}"', path)
            case Text(words) if words and entry not in words:
                wanted = " or ".join(f'"{word}"' for word in words)
                self._wrong(path, f"must be {wanted}, got {_shown(entry)}")
            case Text() if not isinstance(entry, str):
                self._wrong(path, f"must be text in quotes, got {_shown(entry)}")
            case Formula(equation) if not isinstance(entry, str):
                what = "an equation" if equation else "a formula"
                self._wrong(path, f"must be {what} in quotes, got {_shown(entry)}")
            case Flag() if not isinstance(entry, bool):
                self._wrong(path, f"must be true or false, got {_shown(entry)}")
            case Constant(number) if type(entry) is not int or entry != number:
                self._wrong(path, f"must be {number}, got {_shown(entry)}")
        return entry

    def _has_table(self, name: str) -> bool:
        return any(key.name == name for key in self.form.keys)

    def _several(self, entry: Any, kind: Several, path: KeyPath) -> Any:
        if isinstance(entry, dict):
            return self._table(entry, kind.table.keys, path)
        if isinstance(entry, list):
            return self._list(entry, kind.many, path)
        self._check_number(entry, kind.wanted, path, text=False)
        return entry

    def _either(self, entry: Any, kind: Either, path: KeyPath) -> Any:
        other = dict if isinstance(kind.other, Table) else list
        if isinstance(entry, other):
            return self._value(entry, kind.other, path)
        if isinstance(kind.plain, PlainNumber) and isinstance(entry, int | float):
            return self._value(entry, kind.plain, path)
        words = kind.plain.words if isinstance(kind.plain, Text) else None
        if words is None or not isinstance(entry, str) or (words and entry not in words):
            self._wrong(path, f"must be {kind.wanted}, got {_shown(entry)}")
        return entry

    def _check_number(self, entry: Any, wanted: str, path: KeyPath, text: bool = True) -> None:
        """A finite number, or ``text``, which is checked later."""
        if text and isinstance(entry, str):
            return
        # bool is a subclass of int in Python
        if isinstance(entry, bool) or not isinstance(entry, int | float):
            self._wrong(path, f"must be {wanted}, got {_shown(entry)}")
        elif not _finite(entry):
            self._wrong(path, f"must be a finite number, got {_shown(entry)}")

    def _sub_table(self, entry: Any, keys: tuple[Key, ...], path: KeyPath) -> dict[str, Any]:
        if isinstance(entry, dict):
            return self._table(entry, keys, path)
        self._wrong(path, f"must be a table {_table_text(path)}, got {_shown(entry)}")
        return {}

    def _tables(
        self, entry: Any, keys: tuple[Key, ...], wanted: str, path: KeyPath
    ) -> list[dict[str, Any]]:
        if not isinstance(entry, list) or not all(isinstance(each, dict) for each in entry):
            self._wrong(path, f"must be {wanted}, got {_shown(entry)}")
            return []
        return [self._table(each, keys, (*path, k)) for k, each in enumerate(entry)]

    def _named(self, entry: Any, kind: Named, path: KeyPath) -> dict[str, Any]:
        if not isinstance(entry, dict):
            self._wrong(path, f"must be a table {_table_text(path)}, got {_shown(entry)}")
            return {}
        taken: dict[str, str] = {}
        for name in entry:
            # Greek letters and subscripts have two spellings: both name the same thing
            folded = " ".join(canonical(name).split()) if kind.words != 1 else None
            if kind.words and folded is not None and folded in taken:
                self._wrong((*path, name), f'is the same as "{taken[folded]}": leave one out')
            taken[folded or name] = name
        return {name: self._value(each, kind.of, (*path, name)) for name, each in entry.items()}

    def _list(self, entry: Any, kind: ListOf, path: KeyPath) -> Any:
        if not isinstance(entry, list):
            self._wrong(path, f"must be a list {_list_text(kind)}, got {_shown(entry)}")
            return []
        short = len(entry) < kind.least
        if short or (kind.most is not None and len(entry) > kind.most):
            self._wrong(path, f"needs {_count_text(kind)}, got {len(entry)}")
        return [self._value(each, kind.of, (*path, k)) for k, each in enumerate(entry)]


def _finite(number: float) -> bool:
    try:
        return math.isfinite(number)
    except OverflowError:  # an integer larger than every float
        return False


def _names_in_form(form: Form, path: KeyPath) -> set[str]:
    """The keys of another form in the same table."""
    keys: tuple[Key, ...] = form.keys
    for part in (part for part in path if isinstance(part, str)):
        kind = next((key.kind for key in keys if key.name == part), None)
        keys = kind.keys if isinstance(kind, Table | Tables) else ()
    return {key.name for key in keys}


def _why(form: Form) -> str:
    return f" because it has [{form.marker}]" if form.marker else ": it has no [loops]"


def _table_text(path: KeyPath) -> str:
    names = [part for part in path if isinstance(part, str)]
    if not names:
        return "the file"
    inner = ".".join(names)
    return f"[[{inner}]]" if isinstance(path[-1], int) else f"[{inner}]"


def _list_text(kind: ListOf) -> str:
    if isinstance(kind.of, ListOf):
        return f"[{_list_text(kind.of)}, …]"
    if isinstance(kind.of, PlainNumber) and kind.least == 3:
        return "[x, y, radius]"
    return "[x, y]" if isinstance(kind.of, NumberValue | PlainNumber) else '["A", "B"]'


def _count_text(kind: ListOf) -> str:
    words = {0: "no", 1: "one", 2: "two", 3: "three"}
    least, most = words[kind.least], words.get(kind.most or 0)
    if kind.most is None:
        return f"at least {least} {kind.noun}{'s' if kind.least > 1 else ''}"
    plural = "" if kind.least == kind.most == 1 else "s"
    return f"{least if least == most else f'{least} or {most}'} {kind.noun}{plural}"


def _shown(entry: Any) -> str:
    """A value in TOML notation, shortened."""
    match entry:
        case bool():
            return "true" if entry else "false"
        case str():
            short = entry if len(entry) <= _LONGEST_SHOWN else entry[:_LONGEST_SHOWN] + "…"
            return f'"{short}"'
        case dict():
            return "a table"
        case list():
            return "a list"
        case float():
            return f"{entry}"
        case int() if abs(entry) >= 10**_LONGEST_SHOWN:
            return f"a whole number of {entry.bit_length()} bits"
        case int():
            return str(entry)
        case _:
            return f"the {type(entry).__name__} {entry}"


# ----------------------------------------------------------------------
# Read mechanism files: a description, or every problem with its line.


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
