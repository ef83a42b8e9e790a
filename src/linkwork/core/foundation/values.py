"""Values that users pass: numbers, formulas, flags, and their checks."""

from __future__ import annotations

import math
import types
import typing
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from decimal import Decimal
from functools import cache
from numbers import Integral, Real
from typing import Any, TypeVar, cast

import numpy as np

from linkwork.core.foundation.errors import InputError

# ----------------------------------------------------------------------
# Numbers from a caller: conversion to float, or an error for anything else.


_LONGEST_TOLD = 40
_LARGE = 1e308  # no number below is infinite as a float


def plain_number(given: object) -> float | None:
    """A real number or an array without axes as a float; ``None`` for anything else.

    Booleans, texts and rows are not numbers; a number too large for a float is infinite.
    """
    if type(given) is float:  # most are, and abstract classes take long to ask
        return given
    if type(given) is int and -_LARGE < given < _LARGE:
        return float(given)
    if isinstance(given, np.ndarray) and given.ndim == 0:
        given = given[()]
    # True is a number for Python, and a mistake here
    if isinstance(given, bool) or not isinstance(given, Real | Decimal):
        return None
    try:
        return float(given)
    except OverflowError:
        # an integer beyond all floats: infinite, which callers refuse
        return math.inf if cast(Any, given) > 0 else -math.inf


def finite_number(what: str, given: object) -> float:
    """The float of a number.

    Raises
    ------
    InputError
        If it is not a number, or not finite; ``what`` names it in the message.
    """
    number = plain_number(given)
    if number is None or not math.isfinite(number):
        told = as_told(given if number is None else number)
        raise InputError(f"{what} must be a finite number, got {told}")
    return number


def whole_number(what: str, given: object, *, least: int = 0) -> int:
    """An integer that was given.

    Raises
    ------
    InputError
        If it is not an integer, or too small; ``what`` names it in the message.
    """
    if isinstance(given, bool) or not isinstance(given, Integral) or given < least:
        told = as_told(given)
        raise InputError(f"{what} must be a whole number, {least} or more, got {told}")
    return int(given)


def as_told(given: object) -> str:
    """A given value for a message: its ``repr``, with NumPy's numbers as plain ones, cut short."""
    told = repr(_plain(given))
    return told if len(told) <= _LONGEST_TOLD else f"{told[:_LONGEST_TOLD]}…"


def told_beside(number: float, other: float) -> str:
    """A number with so many digits, six or more, that it is told from another one."""
    digits = next((k for k in range(6, 16) if f"{number:.{k}g}" != f"{other:.{k}g}"), 6)
    return f"{number:.{digits}g}"


def _plain(given: Any) -> object:
    if isinstance(given, np.generic | np.ndarray):
        return given.tolist()
    if isinstance(given, list | tuple):
        return type(given)([_plain(part) for part in given])
    return given


# ----------------------------------------------------------------------
# The types of the values that a caller gives for fields and arguments.


T = TypeVar("T")


def check_values(owner: Any) -> None:
    """Check that every field of a part, input or option has a value of its declared type.

    Lists become tuples. Numbers that may be formulas are checked where they are evaluated.

    Raises
    ------
    InputError
        With the field, the type it must have, and what was given.
    """
    owner_type: type = type(owner)
    for name, kind in _declared(owner_type).items():
        given = getattr(owner, name)
        kinds = (kind, *typing.get_args(kind)) if is_listed(given) else ()
        if any(typing.get_origin(part) is tuple for part in kinds):
            given = _frozen(given)
            object.__setattr__(owner, name, given)
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


def _frozen(entry: Any) -> object:
    """Rows of rows as tuples of tuples."""
    if isinstance(entry, np.ndarray):
        entry = entry.tolist()
    return tuple(map(_frozen, entry)) if is_listed(entry) else entry


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


# ----------------------------------------------------------------------
# The kinds of keys in tables of files, each with its allowed values.
#
# Checks of files and their JSON Schemas are both generated from such keys.


@dataclass(frozen=True)
class Constant:
    """The one whole number allowed."""

    number: int


@dataclass(frozen=True)
class Text:
    """Text, or one of a few words; ``of`` is what it names: a point, link or slider."""

    words: tuple[str, ...] = ()
    of: str = ""


@dataclass(frozen=True)
class NumberValue:
    """A number, or a formula in the named dimensions.

    ``of``: what it measures: number, length, angle, area; ``driven``: as the input, ``ranged``: so
    too, unless the input has a law, which makes it a time, ``lift``: as the follower of the cam,
    ``named``: as formulas use it, ``stiffness`` and ``free``: of a spring between points or links.
    """

    of: str = "number"


@dataclass(frozen=True)
class PlainNumber:
    """A number; no formula."""


@dataclass(frozen=True)
class Whole:
    """A whole number within bounds."""

    least: int
    most: int = 2**53


@dataclass(frozen=True)
class Formula:
    """A formula in quotes; with ``equation`` it has an equals sign."""

    equation: bool = False


@dataclass(frozen=True)
class Speed:
    """A number, or text with a unit: ``"300 rpm"``."""


@dataclass(frozen=True)
class Measured:
    """A number, or text with a unit, such as the ``example``."""

    example: str


@dataclass(frozen=True)
class Flag:
    """true or false."""


@dataclass(frozen=True)
class ListOf:
    """A list; ``noun`` is what one entry is called in messages."""

    of: Kind
    noun: str
    least: int = 0
    most: int | None = None


@dataclass(frozen=True)
class Table:
    """A table whose keys are known; ``made`` makes an object of its values."""

    keys: tuple[Key, ...]
    made: Callable[..., Any] = dict


@dataclass(frozen=True)
class Tables:
    """A list of tables, ``[[slots]]``; with ``single`` one plain ``[input]`` will do."""

    keys: tuple[Key, ...]
    single: bool = False
    made: Callable[..., Any] = dict


@dataclass(frozen=True)
class TablesOrFormula:
    """A list of tables, or a formula in quotes."""

    keys: tuple[Key, ...]
    made: Callable[..., Any] = dict


@dataclass(frozen=True)
class Named:
    """A table whose keys the author chooses; each key has ``words`` words."""

    of: Kind
    words: int = 1


@dataclass(frozen=True)
class Several:
    """One number, a list of numbers, or a table; ``wanted`` says so in a message."""

    many: ListOf
    table: Table
    wanted: str


@dataclass(frozen=True)
class Either:
    """A text or number, or a list or table; ``wanted`` says so in a message."""

    plain: Text | PlainNumber
    other: ListOf | Table
    wanted: str


Kind = (
    Constant | Text | NumberValue | PlainNumber | Whole | Formula | Speed | Measured | Flag
    | ListOf | Table | Tables | TablesOrFormula | Named | Several | Either
)  # fmt: skip


@dataclass(frozen=True)
class Key:
    """One key: its name, its allowed values, and one line of description.

    ``field`` is the attribute with its value, if Python cannot have the key's name there.
    """

    name: str
    kind: Kind
    doc: str
    required: bool = False
    field: str = ""

    @property
    def attribute(self) -> str:
        """The attribute of a description with its value."""
        return self.field or self.name
