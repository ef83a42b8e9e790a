"""The kinds of keys in tables of files, each with its allowed values.

Checks of files and their JSON Schemas are both generated from such keys.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "Constant", "Either", "Flag", "Formula", "Key", "Kind", "ListOf", "Measured", "Named", "Number",
    "PlainNumber", "Several", "Speed", "Table", "Tables", "TablesOrFormula", "Text", "Whole",
]  # fmt: skip


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
class Number:
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
    """A table whose keys are known."""

    keys: tuple[Key, ...]


@dataclass(frozen=True)
class Tables:
    """A list of tables, ``[[slots]]``; with ``single`` one plain ``[input]`` will do."""

    keys: tuple[Key, ...]
    single: bool = False


@dataclass(frozen=True)
class TablesOrFormula:
    """A list of tables, or a formula in quotes."""

    keys: tuple[Key, ...]


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
    Constant
    | Text
    | Number
    | PlainNumber
    | Whole
    | Formula
    | Speed
    | Measured
    | Flag
    | ListOf
    | Table
    | Tables
    | TablesOrFormula
    | Named
    | Several
    | Either
)


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
