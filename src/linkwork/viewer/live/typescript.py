"""The messages of the live page as TypeScript types, generated from the Python dataclasses."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Iterator
from typing import Any

from linkwork.viewer.live.events import EVENTS
from linkwork.viewer.live.messages import kind_of
from linkwork.viewer.live.requests import EDITS, REQUESTS
from linkwork.viewer.page_data import PageData

__all__ = ["typescript_types"]

_PLAIN = {str: "string", float: "number", int: "number", bool: "boolean", type(None): "null"}
_HEAD = """\
// Written by scripts/frontend types from the dataclasses in
// linkwork.viewer.live.requests and linkwork.viewer.live.events: change those.

import type { PageData } from "./page_data";
"""


def typescript_types() -> str:
    """A module with an interface for every message, and the unions ``Request`` and ``Event``.

    Fields with a default in Python are optional in requests; events have all fields.
    """
    parts = [_HEAD]
    for message in REQUESTS:
        own = [f'kind: "{kind_of(message)}"', "id?: number"]
        parts.append(_interface(message, own, asked=True))
    for message in EVENTS:
        own = [f'kind: "{kind_of(message)}"', "answers: number | null"]
        parts.append(_interface(message, own, asked=False))
    asked = dict.fromkeys(_parts_of(REQUESTS))
    parts += [_interface(part, [], asked=True) for part in asked]
    parts += [_interface(part, [], asked=False) for part in _parts_of(EVENTS) if part not in asked]
    unions = (("Edit", EDITS), ("Request", REQUESTS), ("Event", EVENTS))
    # spelled differently from the browser's own Event and Request
    parts += [f"export type Live{name} =\n{_one_of(messages)};\n" for name, messages in unions]
    return "\n".join(parts)


def _interface(message: type, own: list[str], *, asked: bool) -> str:
    types = typing.get_type_hints(message)
    lines = [*own]
    for field in dataclasses.fields(message):
        optional = asked and field.default is not dataclasses.MISSING
        lines.append(f"{field.name}{'?' if optional else ''}: {_type(types[field.name])}")
    body = "".join(f"  {line};\n" for line in lines)
    return f"export interface {message.__name__} {{\n{body}}}\n"


def _one_of(messages: tuple[type, ...]) -> str:
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
    found: dict[type, None] = {}

    def look(kind: Any) -> None:
        if kind is PageData:  # defined in its own module
            return
        if dataclasses.is_dataclass(kind) and isinstance(kind, type):
            if kind in REQUESTS and kind not in messages:
                return
            if kind not in messages:
                found[kind] = None
            for inner in typing.get_type_hints(kind).values():
                look(inner)
        for part in typing.get_args(kind):
            look(part)

    for message in messages:
        look(message)
    yield from found
