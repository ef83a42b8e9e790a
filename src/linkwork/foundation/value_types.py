"""The types of the values that a caller gives for fields and arguments."""

from __future__ import annotations

import types
import typing
from collections.abc import Iterable, Mapping
from dataclasses import fields
from functools import cache
from numbers import Integral
from typing import Any, TypeVar, cast

import numpy as np

from linkwork.foundation.errors import InputError
from linkwork.foundation.plain_numbers import as_told, plain_number

__all__ = ["check_class", "check_flags", "check_values", "given_or", "is_listed"]

T = TypeVar("T")


def check_values(owner: Any) -> None:
    """Check that every field of a part, input or option has a value of its declared type.

    Numbers that may be formulas are checked where they are evaluated.

    Raises
    ------
    InputError
        With the field, the type it must have, and what was given.
    """
    owner_type: type = type(owner)
    for name, kind in _declared(owner_type).items():
        given = getattr(owner, name)
        if not _fits(given, kind):
            raise InputError(
                f"{name} of lw.{owner_type.__name__} must be {_wanted(kind)}, got {as_told(given)}"
            )


def check_class(name: str, given: Any, kind: type) -> None:
    """Check that an argument is of a class.

    Raises
    ------
    InputError
        With the argument, its class, and what was given.
    """
    if not isinstance(given, kind):
        raise InputError(f"{name} must be a {kind.__name__}, got {as_told(given)}")


def check_flags(progress: object = None, /, **flags: object) -> None:
    """Check that arguments are True or False, and that ``progress`` is a function.

    Raises
    ------
    InputError
        With the argument and what was given.
    """
    for name, given in flags.items():
        if not isinstance(given, int | np.bool_):
            raise InputError(f"{name} must be True or False, got {as_told(given)}")
    if progress is not None and not callable(progress):
        raise InputError(f"progress must be a function of the fraction, got {as_told(progress)}")


def given_or(default: T, name: str, given: T | None) -> T:
    """The given argument, of the class of the default; the default in place of ``None``."""
    if given is None:
        return default
    check_class(name, given, type(default))
    return given


def is_listed(given: object) -> bool:
    """Whether something has entries; a text, a dictionary and an array of no axes are one thing."""
    if isinstance(given, str | bytes | Mapping) or not isinstance(given, Iterable):
        return False
    return not isinstance(given, np.ndarray) or given.ndim > 0


@cache
def _declared(kind: type) -> Mapping[str, Any]:
    """The types of all fields."""
    hints = typing.get_type_hints(kind)
    return {field.name: hints[field.name] for field in fields(cast(Any, kind)) if field.init}


def _fits(given: Any, kind: Any) -> bool:
    """Whether a value has a declared type; a number may be of any class of numbers."""
    parts = typing.get_args(kind)
    if isinstance(kind, types.UnionType):
        return {float, str} <= {*parts} or any(_fits(given, part) for part in parts)
    if typing.get_origin(kind) is tuple:
        if not isinstance(given, tuple):
            return False
        each = parts[:1] * len(given) if parts[-1] is Ellipsis else parts
        return len(each) == len(given) and all(map(_fits, given, each))
    if kind is int:
        return isinstance(given, Integral) and not isinstance(given, bool)
    if kind is float:
        return plain_number(given) is not None
    return isinstance(given, kind)


def _wanted(kind: Any) -> str:
    """A declared type in words."""
    parts = typing.get_args(kind)
    if isinstance(kind, types.UnionType):
        return " or ".join(dict.fromkeys(_wanted(part) for part in parts if part not in _UNSAID))
    if typing.get_origin(kind) is tuple:
        count = "" if parts[-1] is Ellipsis else f"{len(parts)} "
        return f"a list of {count}{_wanted(parts[0]).removeprefix('a ')}s"
    return _WORDS.get(kind, f"lw.{kind.__name__}(…)")


#: Messages that list the kinds of a value leave these out.
_UNSAID = (types.NoneType,)
_WORDS = {str: "a text", bool: "True or False", int: "a whole number", float: "a number"}
