"""The link of an edited file, with its QR code and its HTML for other pages."""

from __future__ import annotations

import dataclasses
import json
import math
import re
import sys
import types
import typing
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from functools import cache, singledispatch
from types import MappingProxyType
from typing import Any, NoReturn

from linkwork.app.live.events import (
    EVENTS,
    CannotClose,
    Event,
    LinkMade,
    QuantitiesListed,
    QuantityListed,
)
from linkwork.app.live.requests import (
    EDITS,
    REQUESTS,
    Export,
    ListCircuits,
    ListConfigurations,
    ListQuantities,
    MakeLink,
    NewtonSteps,
    OpenFile,
    Question,
    Request,
    SetText,
    SolveAt,
)
from linkwork.app.live.result_events import (
    cannot_close,
    circuits_found,
    configurations_found,
    exported,
    exported_file,
    newton_shown,
    position_found,
)
from linkwork.app.live.subject import Subject
from linkwork.app.pages.offline_page import embed_snippet, qr_svg
from linkwork.app.pages.page_data import PageData
from linkwork.circuits.failure.remedies import nearest_assembly
from linkwork.core.api.mechanism import Mechanism
from linkwork.core.foundation.errors import InputError, choices
from linkwork.core.motion.iterating import guessed_points, pulled_guess
from linkwork.core.numerics.newton import NewtonOptions
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Group
from linkwork.core.results.quantities.registry import Call
from linkwork.core.textfile.link import link_of


def link_made(text: str, title: str, app: str) -> LinkMade:
    """The text of a file as a link to an app; with ``app`` empty as a fragment only.

    Raises
    ------
    InputError
        If the text is too long for a link, or ``app`` is not the address of a page.
    """
    if not app:
        return LinkMade(link=link_of(text), embed="", qr="", note="")
    link = link_of(text, app)
    try:
        qr, note = qr_svg(link), ""
    except InputError as error:  # too long, or segno is missing; a page in a browser has none
        qr, note = "", "" if sys.platform == "emscripten" else str(error)
    return LinkMade(link=link, embed=embed_snippet(link, title), qr=qr, note=note)


# ----------------------------------------------------------------------
# Questions about a mechanism and its motion: circuits, quantities, files, links.


_MOST_QUANTITIES = 40  # shown besides the usual ones
_POSITION_DERIVATIVES = 2

Events = list[Event]


class Hurry(IntEnum):
    """Whether work should end: for a cancellation, which keeps its best results, or a change."""

    NONE = 0
    STOP = 1
    CHANGE = 2


class GivenUpError(Exception):
    """A computation was cancelled because of a newer change."""


@dataclass(frozen=True, kw_only=True)
class About:
    """The subject of requests: a text with its mechanism, its motion if it has one, and its file.

    ``progress`` receives the finished fraction and may raise :class:`GivenUpError`.
    """

    subject: Subject
    motion: Motion | None
    text: str
    file: str
    progress: Callable[[float], None]


@singledispatch
def reply(request: Question, about: About) -> Events:
    """The events that answer a question.

    Raises
    ------
    InputError
        If the question does not fit the mechanism, or the answer was cancelled.
    """
    raise TypeError(f"{type(request).__name__} is not a question")


@reply.register
def _(request: ListCircuits, about: About) -> Events:
    try:
        circuits = about.subject.mechanism.circuits(progress=about.progress)
    except GivenUpError:
        raise InputError("the search for circuits was ended by a change: list them again") from None
    return [circuits_found(circuits, about.motion)]


@reply.register
def _(request: ListQuantities, about: About) -> Events:
    motion = about.motion
    if motion is None:
        return [QuantitiesListed(quantities=())]
    known = motion.quantities
    listed = list(known.listed(timed=motion.speed is not None))
    quantities = {**known.own, **known.derived, **known.evidence}
    return [
        QuantitiesListed(
            quantities=tuple(
                QuantityListed(
                    name=line.name,
                    unit=line.unit,
                    about=line.about,
                    derivatives=_derivatives(quantity.group, quantity.needs),
                )
                for line in listed
                if (quantity := quantities.get(line.name)) is not None
            ),
        )
    ]


def _derivatives(group: Group, needs: int) -> int:
    """How many derivatives of a quantity are known."""
    return 0 if group is Group.EVIDENCE else max(0, _POSITION_DERIVATIVES - needs)


@reply.register
def _(request: Export, about: About) -> Events:
    if request.simulated and request.format != "csv":
        raise InputError(f"a simulation is written as csv, not as {request.format}")
    try:
        file = exported_file(
            request.format,
            about.subject,
            about.motion,
            about.text,
            row=request.row,
            dark=request.dark,
            progress=about.progress,
        )
    except GivenUpError:
        raise InputError(f"the {request.format} file was ended by a change: ask again") from None
    return [exported(file, about.file, "-simulation" if request.simulated else "")]


@reply.register
def _(request: MakeLink, about: About) -> Events:
    return [link_made(about.text, about.subject.description.name, request.app)]


def check_quantities(motion: Motion, names: Sequence[str]) -> None:
    """Check that a motion has these quantities, rates and numbers.

    Raises
    ------
    InputError, UnknownNameError
        If there are too many, or one does not exist; with the nearest names.
    """
    if len(names) > _MOST_QUANTITIES:
        raise InputError(f"at most {_MOST_QUANTITIES} quantities are shown, got {len(names)}")
    for name in names:
        if "(" in name:
            motion.quantities.find_of_motion(str(Call.read(name)))
        else:
            motion.quantity(name)


# ----------------------------------------------------------------------
# Questions about a mechanism, which change nothing.


Query = SolveAt | ListConfigurations | NewtonSteps

_MOST_ITERATIONS = 200


@singledispatch
def answered(query: Query, mechanism: Mechanism) -> list[Event]:
    """The answer to a question.

    Raises
    ------
    InputError
        If the question does not fit the mechanism.
    """
    raise TypeError(f"{type(query).__name__} is not a question")


@answered.register
def _(query: SolveAt, mechanism: Mechanism) -> list[Event]:
    at = query.at or None
    position = mechanism.solve(at, configuration=query.configuration)
    events: list[Event] = [position_found(position)]
    if not position.status.ok:
        failure = position.failure
        remedies = {} if failure is None else {r.length: r.needed for r in failure.remedies}
        events.append(nearest_closure(mechanism, at, position.message, remedies))
    return events


@answered.register
def _(query: ListConfigurations, mechanism: Mechanism) -> list[Event]:
    return [configurations_found(mechanism.configurations(query.at or None))]


@answered.register
def _(query: NewtonSteps, mechanism: Mechanism) -> list[Event]:
    if not 1 <= query.max_steps <= _MOST_ITERATIONS:
        raise InputError(f"max_steps must be from 1 to {_MOST_ITERATIONS}")
    options = NewtonOptions(max_steps=query.max_steps)
    if query.full_steps:
        options = replace(options, largest_turn=math.inf)
    guess, at = query.guess, query.at or None
    if query.pull:
        guess = pulled_guess(mechanism.model, query.pull, (query.x, query.y), guess, at)
    shown = mechanism.iterates(guess, at, options=options)
    return [newton_shown(shown, guess, guessed_points(mechanism.model))]


def nearest_closure(
    mechanism: Mechanism,
    at: Mapping[str, float] | None,
    message: str,
    remedies: Mapping[str, float],
    elsewhere: Mapping[str, float] = MappingProxyType({}),
) -> CannotClose:
    """The position nearest to closure, with lengths and inputs that would close the loops."""
    return cannot_close(nearest_assembly(mechanism.model, at), message, remedies, elsewhere)


# ----------------------------------------------------------------------
# Requests from JSON, strictly, and events to JSON.
#
# A message is an object with its ``kind``, an optional integer ``id`` that the answers repeat, and
# the fields of its dataclass. A field that is missing, unknown, of another type, not finite or too
# long is rejected with its path in the message.


#: Maximum size of a message [bytes]: a file of maximum size, escaped as JSON.
LARGEST_MESSAGE = 2_500_000
_LARGEST_ID = 2**53  # largest exact integer in JavaScript
_LONGEST_TEXT = 1_000  # characters of a name or formula
#: Characters of a whole file, as text or in base64.
_LONGEST_FILES = {SetText: 1_000_000, OpenFile: 2_400_000}
_MOST_ENTRIES = 1_000  # of a list or table
_REQUESTS = frozenset(REQUESTS)


class MessageError(InputError):
    """A message that is not a valid request; ``id`` is that of the message, if readable."""

    def __init__(self, message: str, id: int | None = None) -> None:
        super().__init__(message)
        self.id = id


def kind_of(message: type) -> str:
    """``SetNumber`` → ``set_number``."""
    return _snake_case(message.__name__)


@cache
def _snake_case(name: str) -> str:
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name).lower()


def decoded(text: str | bytes) -> tuple[Request, int | None]:
    """The request in a JSON text, and its id.

    Raises
    ------
    MessageError
        If it is not a valid request; with problem and path.
    """
    data = _object(text)
    number = _id(data.pop("id", None))
    try:
        return _message(data, REQUESTS, ""), number
    except MessageError as error:
        raise MessageError(str(error), number) from None


def encoded(event: Event, answers: int | None = None) -> str:
    """An event as JSON; ``answers`` is the id of its request."""
    fields = {"kind": kind_of(type(event)), "answers": answers, **_message_fields(event)}
    # in ASCII: a browser keeps other texts in twice the memory
    return json.dumps(fields, allow_nan=False, separators=(",", ":"), default=_message_fields)


def _message_fields(message: Any) -> dict[str, Any]:
    """The fields of a dataclass, not copied: a cycle has thousands of numbers."""
    fields = vars(message)
    # a remedy has the requests that the page sends back
    return {"kind": kind_of(type(message)), **fields} if type(message) in _REQUESTS else fields


def _refuse(message: str) -> NoReturn:
    raise MessageError(message)


def _object(text: str | bytes) -> dict[str, Any]:
    size = len(text) if isinstance(text, bytes) else len(text.encode("utf-8", "surrogatepass"))
    if size > LARGEST_MESSAGE:
        _refuse(f"the message has {size} bytes: at most {LARGEST_MESSAGE} are read")
    try:
        data = json.loads(text, object_pairs_hook=_unique, parse_constant=_no_number)
    except MessageError:
        raise
    except (ValueError, RecursionError) as error:
        _refuse(f"the message is not JSON: {str(error)[:200]}")
    if not isinstance(data, dict):
        _refuse(f"a message is a JSON object with its kind, got {_shown(data)}")
    return data


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    entries = dict(pairs)
    if len(entries) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        _refuse(f"{_shown(twice)} occurs twice in one object: send it once")
    return entries


def _no_number(text: str) -> NoReturn:
    _refuse(f"{text} is not a number in JSON: send a finite number or null")


def _id(entry: Any) -> int | None:
    if entry is None or (type(entry) is int and 0 <= entry <= _LARGEST_ID):
        return entry
    _refuse(f"id: must be a whole number from 0 to {_LARGEST_ID}, got {_shown(entry)}")


def _message(data: Any, known: tuple[type, ...], where: str) -> Any:
    """The dataclass selected by the kind of a JSON object."""
    kinds = {kind_of(each): each for each in known}
    kind = data.get("kind") if isinstance(data, dict) else None
    if not isinstance(kind, str) or kind not in kinds:
        listed = choices("kinds", kinds, kind if isinstance(kind, str) else "")
        _refuse(f"{where or 'kind: '}there is no kind {_shown(kind)} {listed}")
    entries = {name: entry for name, entry in data.items() if name != "kind"}
    return _filled(kinds[kind], entries, where or f"{kind}: ")


@cache
def _fields(message: type) -> Mapping[str, tuple[Any, bool]]:
    """Type of every field, and whether it is required."""
    types_ = typing.get_type_hints(message)
    return {
        field.name: (types_[field.name], field.default is dataclasses.MISSING)
        for field in dataclasses.fields(message)
    }


def _filled(message: type, entries: dict[str, Any], where: str) -> Any:
    fields = _fields(message)
    for name in entries:
        if name not in fields:
            _refuse(f"{where}{_shown(name)} is not a field {choices('fields', fields, name)}")
    for name, (_, needed) in fields.items():
        if needed and name not in entries:
            _refuse(f"{where}{name} is missing: send it with the message")
    longest = _LONGEST_FILES.get(message, _LONGEST_TEXT)
    return message(
        **{
            name: _value(entry, fields[name][0], f"{where}{name}", longest)
            for name, entry in entries.items()
        }
    )


def _value(entry: Any, kind: Any, where: str, longest: int) -> Any:
    """An entry converted to the type of its field."""
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if origin in (types.UnionType, typing.Union):
        return _messages_one_of(entry, parts, where, longest)
    if origin is tuple and parts[-1] is not Ellipsis:
        if len(_listed(entry, where)) != len(parts):
            _refuse(f"{where}: must have {len(parts)} entries, got {len(entry)}")
        return tuple(_each(entry, parts[0], where, longest))
    if origin is tuple:
        return tuple(_each(_listed(entry, where), parts[0], where, longest))
    if origin is dict:
        table = _tabled(entry, where)
        for name in table:
            _text(name, f"{where}: a name", longest)
        return dict(zip(table, _each(table.values(), parts[1], where, longest), strict=True))
    if dataclasses.is_dataclass(kind):
        return _filled(typing.cast(type, kind), _tabled(entry, where), f"{where}: ")
    return _plain(entry, kind, where, longest)


def _each(entries: Any, kind: Any, where: str, longest: int) -> list[Any]:
    return [_value(entry, kind, f"{where}[{k}]", longest) for k, entry in enumerate(entries)]


def _messages_one_of(entry: Any, kinds: tuple[Any, ...], where: str, longest: int) -> Any:
    messages: tuple[Any, ...] = tuple(k for k in kinds if dataclasses.is_dataclass(k))
    if messages:
        return _message(entry, messages, f"{where}: ")
    if entry is None and type(None) in kinds:
        return None
    others = [kind for kind in kinds if kind not in (str, type(None))]
    if str in kinds and (isinstance(entry, str) or not others):
        return _text(entry, where, longest)
    return _value(entry, others[0], where, longest)


def _plain(entry: Any, kind: Any, where: str, longest: int) -> Any:
    if kind is str:
        return _text(entry, where, longest)
    if kind is bool:
        if not isinstance(entry, bool):
            _refuse(f"{where}: must be true or false, got {_shown(entry)}")
        return entry
    if isinstance(entry, bool) or not isinstance(entry, int | float):
        _refuse(f"{where}: must be a number, got {_shown(entry)}")
    if kind is int:
        if not isinstance(entry, int) or abs(entry) > _LARGEST_ID:
            _refuse(f"{where}: must be a whole number, got {_shown(entry)}")
        return entry
    try:
        number = float(entry)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        _refuse(f"{where}: must be a finite number, got one that is too large")
    return number


def _text(entry: Any, where: str, longest: int) -> str:
    if not isinstance(entry, str):
        _refuse(f"{where}: must be text, got {_shown(entry)}")
    if len(entry) > longest:
        _refuse(f"{where}: has {len(entry)} characters, at most {longest} are read")
    if any("\ud800" <= letter <= "\udfff" for letter in entry):
        _refuse(f"{where}: contains a lone surrogate: send valid Unicode")
    return entry


def _listed(entry: Any, where: str) -> list[Any]:
    if not isinstance(entry, list):
        _refuse(f"{where}: must be a list, got {_shown(entry)}")
    _check_few(entry, where)
    return entry


def _tabled(entry: Any, where: str) -> dict[str, Any]:
    if not isinstance(entry, dict):
        _refuse(f"{where}: must be an object of names and numbers, got {_shown(entry)}")
    _check_few(entry, where)
    return entry


def _check_few(entries: list[Any] | dict[str, Any], where: str) -> None:
    if len(entries) > _MOST_ENTRIES:
        _refuse(f"{where}: has {len(entries)} entries, at most {_MOST_ENTRIES} are read")


def _shown(entry: Any) -> str:
    """A short text of any entry, for messages."""
    match entry:
        case dict():
            return "an object"
        case list():
            return "a list"
        case None:
            return "null"
        case bool():
            return "true" if entry else "false"
        case str():
            plain = entry.encode("utf-8", "replace").decode()
            return f'"{plain[:40]}…"' if len(plain) > 40 else f'"{plain}"'
        case int() if abs(entry) > 10**18:
            return "a number of many digits"
        case _:
            return f"{entry:g}" if isinstance(entry, float) else str(entry)


# ----------------------------------------------------------------------
# The messages of the live page as TypeScript types, generated from the Python dataclasses.


_PLAIN = {str: "string", float: "number", int: "number", bool: "boolean", type(None): "null"}
_HEAD = """\
// Written by scripts/frontend types from the dataclasses in
// linkwork.app.live.requests and linkwork.app.live.events: change those.

import type { PageData } from "./page_data";
"""


def typescript_types() -> str:
    """A module with an interface for every message, and the unions ``Request`` and ``Event``.

    Fields with a default in Python are optional in requests; events have all fields.
    """
    parts = [_HEAD]
    for message in REQUESTS:
        head = [f'kind: "{kind_of(message)}"', "id?: number"]
        parts.append(_interface(message, head, is_request=True))
    for message in EVENTS:
        head = [f'kind: "{kind_of(message)}"', "answers: number | null"]
        parts.append(_interface(message, head, is_request=False))
    sent = dict.fromkeys(_parts_of(REQUESTS))
    received = (part for part in _parts_of(EVENTS) if part not in sent)
    parts += [_interface(part, [], is_request=True) for part in sent]
    parts += [_interface(part, [], is_request=False) for part in received]
    unions = (("Edit", EDITS), ("Request", REQUESTS), ("Event", EVENTS))
    # spelled differently from the browser's own Event and Request
    parts += [
        f"export type Live{name} =\n{_typescript_one_of(messages)};\n" for name, messages in unions
    ]
    return "\n".join(parts)


def _interface(message: type, head: list[str], *, is_request: bool) -> str:
    types = typing.get_type_hints(message)
    lines = [*head]
    for field in dataclasses.fields(message):
        optional = is_request and field.default is not dataclasses.MISSING
        lines.append(f"{field.name}{'?' if optional else ''}: {_type(types[field.name])}")
    body = "".join(f"  {line};\n" for line in lines)
    return f"export interface {message.__name__} {{\n{body}}}\n"


def _typescript_one_of(messages: tuple[type, ...]) -> str:
    return "\n".join(f"  | {message.__name__}" for message in messages)


def _type(kind: Any) -> str:
    """The TypeScript type of a field's type."""
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if kind in _PLAIN:
        return _PLAIN[kind]
    if dataclasses.is_dataclass(kind):
        return str(typing.cast(type, kind).__name__)
    if origin is dict:
        return f"Record<string, {_type(parts[1])}>"
    if origin is tuple and parts[-1] is Ellipsis:
        return f"readonly ({_type(parts[0])})[]"
    if origin is tuple:
        return f"readonly [{', '.join(map(_type, parts))}]"
    if set(EDITS) <= set(parts):
        return "LiveEdit"
    if parts:
        return " | ".join(map(_type, parts))
    raise TypeError(f"{kind} has no type in TypeScript")


def _parts_of(messages: tuple[type, ...]) -> Iterator[type]:
    """The dataclasses used in messages, without duplicates."""
    kinds: dict[type, None] = {}

    def look(kind: Any) -> None:
        if kind is PageData:  # defined in the module of the kind
            return
        if dataclasses.is_dataclass(kind) and isinstance(kind, type):
            if kind in REQUESTS and kind not in messages:
                return
            if kind not in messages:
                kinds[kind] = None
            for inner in typing.get_type_hints(kind).values():
                look(inner)
        for part in typing.get_args(kind):
            look(part)

    for message in messages:
        look(message)
    yield from kinds
