"""The numbers of a mechanism that a family can vary, and their names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.frozen import FrozenDict
from linkwork.foundation.names import canonical
from linkwork.mechanism.description import Description
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.loops import Loops, PlainEquations

__all__ = [
    "VariedNumber",
    "number_named",
    "numbers_named",
    "varied_numbers",
    "with_numbers",
]


@dataclass(frozen=True)
class VariedNumber:
    """A number of a description: its table, its key in it, and its name.

    ``axis`` is 0 for x and 1 for y of a point.
    """

    name: str
    table: str  # dimensions | lengths | angles | points | sliders | guess
    key: str
    axis: int = 0

    def of(self, description: Description) -> float:
        """Its value in a description, in file units."""
        return description.numbers(self.written(description))

    def unit(self, description: Description, kinds: Mapping[str, str] = FrozenDict()) -> str:
        """Its unit in the file; ``kinds``: angle, length or number for the variables of equations.

        That of a named dimension is not known.
        """
        kind = "angle" if self.table == "angles" else kinds.get(self.key, "")
        if kind == "length" or self.table in ("lengths", "points", "sliders"):
            return description.length
        return description.angle.value if kind == "angle" else ""

    def written(self, description: Description) -> Number:
        table: Any = getattr(description, self.table)
        if self.table == "points":
            number: Number = table[self.key][self.axis]
        elif self.table == "sliders":
            number = next(part.offset for part in table if part.name == self.key)
        else:
            number = table[self.key]
        return number


def varied_numbers(description: Description) -> Iterator[VariedNumber]:
    """All numbers that can vary."""
    for name in description.dimensions:
        yield VariedNumber(name, "dimensions", name)
    if isinstance(description, Loops | PlainEquations):
        for name in description.guess:
            yield VariedNumber(name, "guess", name)
    if isinstance(description, Draft):
        for table in ("lengths", "angles"):
            for key in getattr(description, table):
                yield VariedNumber(key, table, key)
        for point in description.points:
            for axis, letter in enumerate("xy"):
                yield VariedNumber(f"{point}.{letter}", "points", point, axis)
        for slider in description.sliders:
            yield VariedNumber(f"{slider.name}.offset", "sliders", slider.name)


def number_named(description: Description, name: str) -> VariedNumber:
    """The number with a given name: ``a2``, ``O2 A``, ``B A P``, ``O4.x`` or ``s16.offset``.

    The two points of a length may be given in either order.

    Raises
    ------
    UnknownNameError
        Lists the existing numbers, those with similar names first.
    """
    found = {_folded(quantity.name): quantity for quantity in varied_numbers(description)}
    words = _folded(name).split()
    wanted = " ".join(words)
    if wanted not in found and len(words) == 2:
        wanted = " ".join(reversed(words))
    if wanted not in found:
        names = [quantity.name for quantity in found.values()]
        raise UnknownNameError(
            f'"{name}" is not a number of {description.name} that can vary '
            f"{choices('numbers', names, name)}"
        )
    return found[wanted]


def numbers_named(
    description: Description, changes: Iterable[tuple[str, Number]]
) -> dict[VariedNumber, Number]:
    """New values by the numbers that their names mean.

    Raises
    ------
    UnknownNameError
        For a name of nothing that can vary.
    InputError
        If a number is given twice.
    """
    found: dict[VariedNumber, Number] = {}
    for name, value in changes:
        number = number_named(description, name)
        if number in found:
            raise InputError(f'"{name}" has a value already: {found[number]}')
        found[number] = value
    return found


def _folded(name: str) -> str:
    return " ".join(canonical(name).split())


def with_numbers(description: Description, numbers: Mapping[VariedNumber, Number]) -> Description:
    """A copy with some numbers replaced.

    Raises
    ------
    MechanismError
        With every problem found.
    """
    tables: dict[str, dict[str, Any]] = {}
    for quantity, number in numbers.items():
        changed = tables.setdefault(quantity.table, {})
        if quantity.table == "points":
            assert isinstance(description, Draft)
            place = list(changed.get(quantity.key, description.points[quantity.key]))
            place[quantity.axis] = number
            changed[quantity.key] = tuple(place)
        else:
            changed[quantity.key] = number
    changes = {table: _changed(description, table, new) for table, new in tables.items()}
    if isinstance(description, Draft):
        return description.with_tables(changes)
    return replace(description, **changes)


def _changed(description: Description, table: str, changes: Mapping[str, Any]) -> Any:
    if table != "sliders":
        return FrozenDict({**getattr(description, table), **changes})
    assert isinstance(description, Draft)
    return tuple(
        replace(part, offset=changes[part.name]) if part.name in changes else part
        for part in description.sliders
    )
