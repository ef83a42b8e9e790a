"""Where a part pushes links in contact, as formulas of points: a place and a unit vector."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from linkwork.core.expression.grammar import parse
from linkwork.core.foundation.units import AngleUnit
from linkwork.writers.formulas.closure_formulas import cell_text, of_radians, value_of

#: The distance of the points ``a`` and ``b``.
SPAN = "hypot(bx-ax, by-ay)"


@dataclass(frozen=True, kw_only=True)
class Contact:
    """A row of the sheet; ``points`` are those of the formulas' names: ``ax`` is the x of ``a``."""

    name: str
    points: dict[str, str]
    place: tuple[str, str]
    way: tuple[str, str]


def offset_contact(
    name: str, center: str, line: tuple[str, str], side: float, reach: float
) -> Contact:
    """``reach`` to the left of a line from a centre; the unit vector is to its ``side``."""
    return Contact(
        name=name,
        points={"a": line[0], "b": line[1], "c": center},
        place=(f"cx - {reach!r}*(by-ay)/{SPAN}", f"cy + {reach!r}*(bx-ax)/{SPAN}"),
        way=(f"{-side!r}*(by-ay)/{SPAN}", f"{side!r}*(bx-ax)/{SPAN}"),
    )


# ----------------------------------------------------------------------
# What acts on links, as entries of a sheet: forces at points and moments, with their values.


_CELL = re.compile(r"[$\w.]+")


@dataclass(frozen=True)
class Entry:
    """The text of a formula, without equals sign, and its value."""

    text: str
    value: float


NO, ONE = Entry("0", 0.0), Entry("1", 1.0)


def computed(text: str, names: dict[str, Entry], unit: AngleUnit = AngleUnit.RADIAN) -> Entry:
    """A formula of entries."""
    formula = of_radians(parse(text), unit)
    cells = {
        name: entry.text if _CELL.fullmatch(entry.text) else f"({entry.text})"
        for name, entry in names.items()
    }
    value = value_of(formula, {name: entry.value for name, entry in names.items()})
    return Entry(cell_text(formula, cells), float(value))


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
