"""All quantities beyond a mechanism's own: those of every row, and those of a whole motion."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cache, cached_property

import numpy as np

from linkwork import wings
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import as_name, canonical, find_spelling
from linkwork.core.results.quantities.definition import (
    Asked,
    AskedOfMotion,
    Group,
    MechanismNames,
    MotionQuantity,
    RowQuantity,
)
from linkwork.core.results.quantities.dwell import DWELL
from linkwork.core.results.quantities.motions import EXTREMES, PATH_LENGTH, STROKE, TIME_RATIO
from linkwork.core.results.quantities.rows import (
    MECHANICAL_ADVANTAGE,
    PATH_CURVATURE,
    PRESSURE_ANGLE,
    TRANSMISSION,
)
from linkwork.core.results.quantity import Kind, Quantity, Rate

ROW_QUANTITIES: tuple[RowQuantity, ...] = (
    *TRANSMISSION,
    *MECHANICAL_ADVANTAGE,
    *PATH_CURVATURE,
    *PRESSURE_ANGLE,
)

MOTION_QUANTITIES: tuple[MotionQuantity, ...] = (
    *EXTREMES,
    *STROKE,
    *TIME_RATIO,
    *PATH_LENGTH,
    *DWELL,
)


@cache
def row_quantities() -> tuple[RowQuantity, ...]:
    """All quantities of rows: those of the core, then those of wings."""
    places = [place for wing in wings.wings() for place in wing.quantities]
    return (*ROW_QUANTITIES, *(row for place in places for row in wings.load(place)))


def row_quantity(name: str) -> RowQuantity | None:
    """The quantity that a name ends with: that of ``B.transmission``."""
    if "." not in name:
        return None
    # other packages are looked through last, which takes time
    found = (row for row in ROW_QUANTITIES if name.endswith(f".{row.word}"))
    return next(found, None) or next(
        (row for row in row_quantities() if name.endswith(f".{row.word}")), None
    )


# ----------------------------------------------------------------------
# The registry of quantities: all quantities of a mechanism, found by name.


#: Numbers about a position: how well it closes, how it was found, what is proved of it.
EVIDENCE = {
    "residual": "how well the position closes, relative to the longest link",
    "iterations": "steps of Newton-Raphson to the position",
    "condition": "how much the equations magnify errors there",
    "radius": "within this a true position lies, relative to the longest link",
    "unique_within": "within this there is no other position, relative to the longest link",
}

_CALL = re.compile(r"\s*(\w+)\s*\(\s*([^()<>=]*[^()<>=\s])\s*\)\s*")
#: Rates that any quantity has, by the suffix of its name.
RATES = {
    Rate.FIRST: "first derivative with respect to the input",
    Rate.SECOND: "second derivative with respect to the input",
    Rate.VELOCITY: "first derivative with respect to time; the input needs a speed",
    Rate.ACCELERATION: "second derivative with respect to time; the input needs a speed",
    Rate.JERK: "third derivative with respect to time; the input needs a speed",
    Rate.SNAP: "fourth derivative with respect to time; the input needs a speed",
}


_ABOUT = {
    Group.INPUT: "input",
    Group.UNKNOWN: "unknown of the loop equations",
    Group.LINK: "angle of the link",
    Group.SLIDER: "displacement along the guide, or length",
    Group.OUTPUT: "formula in [outputs]",
    Group.COORDINATE: "coordinate of the point",
}


@cache
def _of_motions() -> dict[str, MotionQuantity]:
    return {quantity.word: quantity for quantity in MOTION_QUANTITIES}


@dataclass(frozen=True, kw_only=True)
class Listed:
    """A line of the list of quantities."""

    name: str
    kind: str
    unit: str
    about: str


@dataclass(frozen=True)
class Quantities:
    """All quantities of one mechanism."""

    names: MechanismNames

    @cached_property
    def own(self) -> dict[str, Asked]:
        """The mechanism's own quantities by name, inputs first."""
        parts = self.names
        tables = (
            (Group.INPUT, parts.inputs),
            (Group.UNKNOWN, parts.unknowns),
            (Group.LINK, dict.fromkeys(parts.links, Kind.ANGLE)),
            (Group.SLIDER, dict.fromkeys(parts.sliders, Kind.LENGTH)),
            (Group.OUTPUT, parts.outputs),
            (Group.COORDINATE, dict.fromkeys(_coordinates(parts.points), Kind.LENGTH)),
        )
        found: dict[str, Asked] = {}
        for group, table in tables:
            for name, kind in table.items():
                quantity = Quantity(name=name, kind=kind)
                found.setdefault(name, Asked(names=parts, own=quantity, group=group))
        return found

    @cached_property
    def derived(self) -> dict[str, Asked]:
        """Quantities that follow from the mechanism's own, by name."""
        found: dict[str, Asked] = {}
        for row in (*row_quantities(), *self.names.further):
            for part, kind in row.of(self.names).items():
                own = Quantity(name=f"{part}.{row.word}" if part else row.word, kind=kind)
                found[own.name] = Asked(
                    names=self.names, own=own, group=Group.DERIVED, row=row, part=part
                )
        # names of the file come before derived ones
        return {name: asked for name, asked in found.items() if name not in self.own}

    @cached_property
    def evidence(self) -> dict[str, Asked]:
        """Numbers about positions by name."""
        return {
            name: Asked(
                names=self.names, own=Quantity(name=name, kind=Kind.NUMBER), group=Group.EVIDENCE
            )
            for name in EVIDENCE
            if name not in self.own
        }

    @cached_property
    def _known(self) -> dict[str, Asked]:
        """Requested quantities by the name as written."""
        return {}

    def find(self, name: str) -> Asked:
        """A quantity of every row, or one of its rates, by name.

        Raises
        ------
        UnknownNameError
            With the nearest names, and the command that lists all.
        """
        if as_name(name) not in self._known:
            self._known[name] = self._find(name)
        return self._known[name]

    def _find(self, name: str) -> Asked:
        whole, rate = Rate.split(name)
        # the mechanism's own names come first: a point may be named like a rate
        for table in (self.own, self.evidence):
            own = find_spelling(whole, table)
            if own in table and not (rate and table[own].group is Group.EVIDENCE):
                return _with_rate(table[own], rate)
        point = find_spelling(whole, self.names.points)
        if rate is not None and point in self.names.points:
            place = Quantity(name=point, kind=Kind.LENGTH)
            return Asked(names=self.names, own=place, group=Group.POINT, rate=rate)
        own = find_spelling(whole, self.derived)
        if own in self.derived:
            return _with_rate(self.derived[own], rate)
        call = _CALL.fullmatch(name)
        if call and call[1] in _of_motions():
            raise UnknownNameError(
                f'"{name}" is a number of a whole motion, not of every row: '
                "ask a motion, a family or a study for its value"
            )
        raise self.unknown(whole)

    def find_of_motion(self, text: str) -> AskedOfMotion:
        """A number of a whole motion by name: ``stroke(s16)``, ``dwell(s16, 0.5)``.

        Raises
        ------
        InputError
            If it is not one, or a number is missing.
        UnknownNameError
            With the nearest names, and the command that lists all.
        """
        call = Call.read(text)
        quantity = call.quantity
        if quantity.of_point:
            point = find_spelling(call.of, self.names.points)
            if point not in self.names.points:
                points = choices("points", self.names.points, call.of)
                raise UnknownNameError(f'there is no point "{call.of}" {points}')
            own = Quantity(name=point, kind=Kind.LENGTH)
            asked = Asked(names=self.names, own=own, group=Group.POINT)
        else:
            asked = self.find(call.of)
        found = AskedOfMotion(names=self.names, quantity=quantity, of=asked, numbers=call.numbers)
        if found.needs > 2 or (quantity.needs and (asked.rate or asked.group is Group.EVIDENCE)):
            raise UnknownNameError(
                f'"{text}" is not known: positions have two derivatives, which are not enough; '
                "ask for it of a quantity that is no rate"
            )
        return found

    def unknown(self, name: str) -> UnknownNameError:
        """The error for a name that does not exist, with the three nearest names."""
        known = [*self.own, *self.derived, *self.evidence]
        return UnknownNameError(f'there is no "{name}" {nearest(name, known)}')

    def listed(self, *, timed: bool) -> Iterator[Listed]:
        """All quantities, one line each; rates and numbers of motions last."""
        for asked in (*self.own.values(), *self.derived.values()):
            about = asked.row.about if asked.row else _ABOUT[asked.group]
            kind, unit = asked.own.kind.value, asked.unit
            yield Listed(name=asked.name, kind=kind, unit=unit, about=about)
        for name in self.evidence:
            yield Listed(name=name, kind=Kind.NUMBER.value, unit="", about=EVIDENCE[name])
        for rate, about in RATES.items():
            if timed or not rate.by_time:
                yield Listed(name=f"….{rate.value}", kind="rate", unit="", about=about)
        for quantity in MOTION_QUANTITIES:
            inside = ["POINT" if quantity.of_point else "…", *map(str.upper, quantity.numbers)]
            name = f"{quantity.word}({', '.join(inside)})"
            yield Listed(name=name, kind="of a motion", unit="", about=quantity.about)


@dataclass(frozen=True)
class Call:
    """A requested number of a motion, read from text: word, quantity, further numbers."""

    word: str
    of: str
    numbers: tuple[float, ...] = ()

    def __str__(self) -> str:
        return f"{self.word}({', '.join([self.of, *(f'{number:g}' for number in self.numbers)])})"

    @property
    def quantity(self) -> MotionQuantity:
        """Which number it is."""
        return _of_motions()[self.word]

    @classmethod
    def read(cls, text: str) -> Call:
        """From text.

        Raises
        ------
        InputError
            If it is not one.
        """
        call = _CALL.fullmatch(as_name(text))
        known = nearest(text if call is None else call[1], _of_motions())
        if call is None:
            own, dot, last = text.strip().rpartition(".")
            known = f'(write "{last}({own})")' if dot and last in _of_motions() else known
            raise InputError(
                f'must be a number of a whole motion, as in "stroke(rocker)", got "{text}" {known}'
            )
        if call[1] not in _of_motions():
            raise InputError(f'there is no number "{call[1]}" of a motion {known}')
        of, *rest = (part.strip() for part in call[2].split(","))
        numbers = tuple(finite for part in rest if (finite := _finite(part)) is not None)
        wanted = _of_motions()[call[1]].numbers
        if len(rest) != len(wanted) or len(numbers) != len(rest):
            form = ", ".join([of, *map(str.upper, wanted)])
            raise InputError(f'"{text}" must be {call[1]}({form})')
        for word, number in zip(wanted, numbers, strict=True):
            if number <= 0.0:
                raise InputError(f'"{text}": {word} must be positive, got {number:g}')
        return cls(call[1], of, numbers)


def _finite(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if np.isfinite(number) else None


def nearest(name: str, known: Iterable[str]) -> str:
    """The three nearest names and the command that lists all, for the end of a message.

    Quantities of the same part, and the same quantity of other parts, come before all others.
    """
    folded = {canonical(own): own for own in known}
    wanted = canonical(name)
    part, dot, word = wanted.rpartition(".")
    mates = [own for own in folded if dot and own.startswith(f"{part}.")]
    mates += [own for own in folded if dot and own.endswith(f".{word}")]
    others = get_close_matches(wanted, folded, n=3, cutoff=0.0)
    # relatives first: a mistyped part or word is likelier than another name
    near = dict.fromkeys([*get_close_matches(wanted, mates, n=3, cutoff=0.0), *others])
    told = ", ".join(folded[own] for own in [*near][:3])
    return f"(nearest: {told}; all: linkwork quantities FILE)"


def _with_rate(asked: Asked, rate: Rate | None) -> Asked:
    return asked if rate is None else replace(asked, rate=rate)


def _coordinates(points: Iterable[str]) -> Iterator[str]:
    for point in points:
        yield from (f"{point}.x", f"{point}.y")
