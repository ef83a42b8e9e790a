"""What acts on links, as entries of a sheet: forces at points and moments, with their values."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from linkwork.export.formulas.cell_formula import CellFormula
from linkwork.expression.grammar import parse
from linkwork.foundation.angles import AngleUnit

__all__ = [
    "NO",
    "ONE",
    "Act",
    "Entry",
    "Follower",
    "Reading",
    "Unknown",
    "computed",
    "left_of",
    "minus",
    "opposite",
]

_CELL = re.compile(r"[$\w.]+")


@dataclass(frozen=True)
class Entry:
    """The text of a formula, without equals sign, and its value."""

    text: str
    value: float


NO, ONE = Entry("0", 0.0), Entry("1", 1.0)


def computed(text: str, names: dict[str, Entry], unit: AngleUnit = AngleUnit.RADIAN) -> Entry:
    """A formula of entries."""
    formula = CellFormula(parse(text), unit)
    cells = {
        name: own.text if _CELL.fullmatch(own.text) else f"({own.text})"
        for name, own in names.items()
    }
    value = formula.value({name: own.value for name, own in names.items()})
    return Entry(formula.text(cells), float(value))


def minus(entry: Entry) -> Entry:
    """The opposite."""
    return entry if entry == NO else Entry(f"-({entry.text})", -entry.value)


@dataclass(frozen=True)
class Act:
    """What a unit of something, or a load, does to a link at a point."""

    link: str
    point: str
    x: Entry = NO
    y: Entry = NO
    moment: Entry = NO


def left_of(along: tuple[Entry, Entry]) -> tuple[Entry, Entry]:
    """A unit vector turned by a right angle."""
    return minus(along[1]), along[0]


def opposite(on: str, against: str, point: str, along: tuple[Entry, Entry]) -> tuple[Act, ...]:
    """A unit force on one link, and its reaction on another."""
    x, y = along
    return Act(on, point, x, y), Act(against, point, minus(x), minus(y))


@dataclass(frozen=True)
class Unknown:
    """A reaction: its name, unit and acts."""

    name: str
    unit: str
    acts: tuple[Act, ...]


@dataclass(frozen=True)
class Follower:
    """A force whose size is a formula of one unknown ``t``, with the other names of the formula.

    It must not change this unknown.
    """

    name: str
    unit: str
    of: str
    size: str
    names: dict[str, Entry]
    acts: tuple[Act, ...]


@dataclass(frozen=True)
class Reading:
    """A formula of reactions, ``a`` and ``b`` those of these names, and of other names."""

    name: str
    unit: str
    text: str
    of: tuple[str, ...]
    names: dict[str, Entry] = field(default_factory=dict)
