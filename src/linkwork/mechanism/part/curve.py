"""Curve: a point runs along a curve of another link."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from linkwork.foundation.file_keys import Flag, Key, ListOf, Number as NumberKey, Text
from linkwork.foundation.names import GROUND
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.figures import Contour, Figure, Outline, Outlines
from linkwork.mechanism.joint import JointKind
from linkwork.mechanism.part.part import LINK, POINT, Inversion, NamedPart, PartChecks, pinned

__all__ = ["COORDINATES", "Curve", "CurvedSlot", "coordinates", "turned_back"]

COORDINATES = ListOf(ListOf(NumberKey("length"), "coordinate", 2, 2), "point", 3)

Pairs = tuple[tuple[Number, Number], ...]


@dataclass(frozen=True, kw_only=True)
class CurvedSlot(Contour):
    """A curve along which the pin ``point`` moves."""

    filled: ClassVar[bool] = False

    point: str

    @property
    def pins(self) -> tuple[str, ...]:
        return (self.point,)


@dataclass(frozen=True, kw_only=True)
class Curve(NamedPart):
    """A point that moves along a curve of another link.

    Parameters
    ----------
    name : str
        The coordinate along the curve: an angle from 0 to a full turn if the curve is closed,
        otherwise a length.
    point : str
        The moving point, on another link.
    on : str
        The link with the curve.
    origin : str
        A point of that link; the coordinates of the curve are relative to it in the link's own
        frame.
    through : tuple of (x, y)
        Interpolation points of the spline [length].
    closed : bool
        Whether the curve returns to its first point.

    Examples
    --------
    >>> import linkwork as lw
    >>> path = [(80, 0), (57, 57), (0, 80)]
    >>> lw.Curve(name="slot", point="B", on="ground", origin="O4", through=path).through[1]
    (57, 57)
    """

    title = "Curve"
    doc = "A point moves along a curve of another link"
    keys = (
        Key("name", Text(), "Name of the coordinate along the curve", required=True),
        Key("point", POINT, "The point that moves along it, of another link", required=True),
        Key("on", LINK, "The link with the curve", required=True),
        Key("origin", POINT, "The point of that link from which coordinates are measured", True),
        Key("through", COORDINATES, "Points of the curve in that link's own frame", required=True),
        Key("closed", Flag(), "Whether the curve is closed"),
    )
    kind = JointKind("C", 2, "pin on a curve")

    point: str
    on: str
    origin: str
    through: Pairs
    closed: bool = False

    @property
    def names(self) -> tuple[str, ...]:
        return self.name, f"{self.name}_x", f"{self.name}_y"

    @property
    def friction_sizes(self) -> tuple[str, ...]:
        return ()

    @property
    def drive(self) -> str:
        return "" if self.closed else "slider"

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        return pinned(linkage, self.point), self.on

    def pairs(self, linkage: Bodies) -> None:
        return None

    def check(self, checks: PartChecks) -> None:
        """Check that curve and point are on different links."""
        if not checks.link(self.on, "on"):
            return
        checks.on(self.origin, self.on, "origin")
        fixed = self.point in checks.linkage.links[self.on]
        if checks.defined(self.point, "point") and fixed:
            checks.add(
                f'{self.point} is fixed on "{self.on}" and cannot move along its curve', "point"
            )
        checks.outline(self.through, "through", closed=self.closed)

    def sketched_outlines(self, linkage: Bodies) -> Iterator[tuple[str, Outline]]:
        """The given points."""
        yield self.name, (self.on, self.origin, coordinates(self.through, linkage))

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        if self.name in outlines:
            link, center, points = outlines[self.name]
            yield CurvedSlot(
                name=self.name,
                link=link,
                center=center,
                points=tuple(map(complex, points)),
                closed=self.closed,
                point=self.point,
            )

    def inverted(self, inversion: Inversion) -> Self:
        """The curve on the same link; one of the old ground is given in its new axes."""
        same = super().inverted(inversion)
        if self.on != GROUND:
            return same
        return replace(same, through=turned_back(self.through, inversion.turn))


def coordinates(pairs: Pairs, linkage: Bodies) -> list[complex]:
    """Points given by numbers or formulas."""
    return [complex(linkage.numbers(x), linkage.numbers(y)) for x, y in pairs]


def turned_back(pairs: Pairs, turn: float) -> Pairs:
    """Coordinates in axes rotated by ``turn`` [rad]."""
    if not turn:
        return pairs
    c, s = math.cos(turn), math.sin(turn)

    def combined(x: Number, y: Number, by_x: float, by_y: float) -> Number:
        # coordinates that are formulas stay formulas
        if isinstance(x, str) or isinstance(y, str):
            return f"({by_x!r})*({x}) + ({by_y!r})*({y})"
        return by_x * x + by_y * y

    return tuple((combined(x, y, c, s), combined(x, y, -s, c)) for x, y in pairs)
