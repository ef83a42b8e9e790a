"""The numbers of a mechanism that a family can vary, and their names."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

from linkwork.core.foundation.arrays import FrozenDict
from linkwork.core.foundation.errors import InputError, Problem, UnknownNameError, choices
from linkwork.core.foundation.names import canonical
from linkwork.core.foundation.values import Key, Named, NumberValue, Table
from linkwork.core.mechanism.bodies import Bodies
from linkwork.core.mechanism.description import Description, Problems
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.linkage import Draft
from linkwork.core.mechanism.loops import Loops, PlainEquations


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


# ----------------------------------------------------------------------
# Deviations of a mechanism's numbers, and clearances of its pins.


_DEVIATION = Key("deviation", NumberValue("varied"), "Its standard deviation", required=True)
TOLERANCES = Key(
    "tolerances",
    Named(Table((_DEVIATION,), made=lambda deviation: deviation), 0),
    'How much numbers deviate: "A B" = { deviation = 0.05 }',
)
CLEARANCES = Key(
    "clearances",
    Named(NumberValue("length")),
    "How far a pin can move in its hole, by point: the difference of the radii",
)


def deviations_of(description: Description) -> dict[VariedNumber, float]:
    """The standard deviation of every number that has one, in file units."""
    return {
        number_named(description, name): description.numbers(number)
        for name, number in description.tolerances.items()
    }


def pins_of(description: Description) -> dict[str, tuple[str, ...]]:
    """The points at which links are pinned together, with these links."""
    if not isinstance(description, Draft):
        return {}
    welded = {frozenset(weld.links) for weld in description.welds}
    found = {}
    for point, carriers in description.carriers().items():
        links = [name for name in carriers if name in description.links]
        if any(frozenset((links[0], link)) not in welded for link in links[1:]):
            found[point] = tuple(links)
    return found


def tolerance_problems(description: Description) -> list[Problem]:
    """Deviations of what cannot vary, clearances of what is no pin, and negative ones."""
    problems = Problems()
    known: dict[VariedNumber, str] = {}
    for name, number in description.tolerances.items():
        key = ("tolerances", name)
        try:
            varied = number_named(description, name)
        except UnknownNameError as error:
            problems.add(key, str(error))
            continue
        if varied in known:
            problems.add(key, f'is the same number as "{known[varied]}": give it once')
        known[varied] = name
        _check_size(description, problems, (*key, "deviation"), number, _limit(description, varied))
    if isinstance(description, Bodies):
        pins = pins_of(description)
        spelled = {canonical(point): point for point in pins}
        for name, number in description.clearances.items():
            key = ("clearances", name)
            if canonical(name) not in spelled:
                problems.add(key, f'"{name}" is no pin of two links {choices("pins", pins, name)}')
            limit = _extent(description), f"the largest length, {_extent(description):g}"
            _check_size(description, problems, key, number, limit)
    return list(problems)


def _limit(description: Description, varied: VariedNumber) -> tuple[float, str]:
    """What a deviation must not reach, and what it is."""
    if varied.table == "lengths":
        own = varied.of(description)
        return own, f"the length itself, {own:g}"
    if varied.table == "angles":
        return description.angle.turn, "a full turn"
    extent = _extent(description)
    if varied.table == "dimensions":  # a length or an angle
        return max(extent, description.angle.turn), "all lengths and a full turn"
    return extent, f"the largest length, {extent:g}"


def _extent(description: Description) -> float:
    """The largest distance of two points, or the largest number of a mechanism without any."""
    if isinstance(description, Draft):
        places = [complex(*map(description.numbers, x)) for x in description.points.values()]
        lengths = [description.numbers(each) for each in description.lengths.values()]
        return max([*lengths, *(abs(a - b) for a in places for b in places)], default=math.inf)
    given = (varied.of(description) for varied in varied_numbers(description))
    return max(map(abs, given), default=math.inf)


def _check_size(
    description: Description, problems: Problems, key: tuple[str, ...], number: float | int | str,
    limit: tuple[float, str],
) -> None:  # fmt: skip
    amount = description.numbers.check_number(problems.add, key, number)
    if amount < 0:
        problems.add(key, f"must not be negative, got {amount:g}")
    elif amount >= limit[0]:
        problems.add(key, f"must be smaller than {limit[1]}, got {amount:g}")


def clearances_of(description: Description) -> Iterator[tuple[str, float]]:
    """The clearance of every pin that has one, by the point's name, in file units."""
    if isinstance(description, Bodies):
        spelled = {canonical(point): point for point in pins_of(description)}
        for name, number in description.clearances.items():
            yield spelled[canonical(name)], description.numbers(number)
