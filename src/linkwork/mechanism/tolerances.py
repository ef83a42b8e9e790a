"""Deviations of a mechanism's numbers, and clearances of its pins."""

from __future__ import annotations

import math
from collections.abc import Iterator

from linkwork.foundation.errors import Problem, UnknownNameError, choices
from linkwork.foundation.file_keys import Key, Named, Number, Table
from linkwork.foundation.names import canonical
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.description import Description, Problems
from linkwork.mechanism.draft import Draft
from linkwork.mechanism.varied_number import VariedNumber, number_named, varied_numbers

__all__ = [
    "CLEARANCES",
    "TOLERANCES",
    "clearances_of",
    "deviations_of",
    "pins_of",
    "tolerance_problems",
]

TOLERANCES = Key(
    "tolerances",
    Named(Table((Key("deviation", Number("varied"), "Its standard deviation", required=True),)), 0),
    'How much numbers deviate: "A B" = { deviation = 0.05 }',
)
CLEARANCES = Key(
    "clearances",
    Named(Number("length")),
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
