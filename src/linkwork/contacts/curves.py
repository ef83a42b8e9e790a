"""Curves and non-circular gears."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, ClassVar, Self

from linkwork.core.expression.grammar import parse
from linkwork.core.expression.values import value
from linkwork.core.foundation.errors import ExpressionError
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.values import (
    Flag,
    Formula,
    Key,
    ListOf,
    NumberValue as NumberKey,
    Text,
)
from linkwork.core.mechanism.bodies import Bodies, Contour, Figure, Outline, Outlines, circle
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.part.gears import (
    ARM_KEYS,
    PHASE_KEY,
    PRESSURE_KEY,
    ArmPair,
    ToothedPart,
)
from linkwork.core.mechanism.part.part import (
    AGREE,
    LINK,
    POINT,
    Inversion,
    JointKind,
    NamedPart,
    PartChecks,
    pinned,
)

# ----------------------------------------------------------------------
# Curve: a point runs along a curve of another link.


COORDINATES = ListOf(ListOf(NumberKey("length"), "coordinate", 2, 2), "point", 3)

Pairs = tuple[tuple[Number, Number], ...]


def contours(
    kind: type[Contour], names: Iterable[str], outlines: Outlines, **more: Any
) -> Iterator[Contour]:
    """The contours of these names that have an outline."""
    for name in names:
        if name in outlines:
            link, center, points = outlines[name]
            corners = tuple(map(complex, points))
            yield kind(name=name, link=link, center=center, points=corners, **more)


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
        more = {"closed": self.closed, "point": self.point}
        yield from contours(CurvedSlot, [self.name], outlines, **more)

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


# ----------------------------------------------------------------------
# Non-circular gears, such as elliptical gears, given by their transmission law.


_LAWS = ("law", "table", "pitch_curve")
_PAIRS = ListOf(ListOf(NumberKey("angle"), "angle", 2, 2), "pair", 5)


class PitchCurve(Contour):
    """The pitch curve of one of the wheels."""

    @property
    def laid_by(self) -> tuple[str, ...]:
        """The centre."""
        return ()


@dataclass(frozen=True, kw_only=True)
class NoncircularGear(ToothedPart, ArmPair):
    """Two external gears that roll on each other with the transmission law ψ(φ).

    φ and ψ are the angles of the first and the second wheel relative to the arm; the pitch radius
    of the first at the contact is -ψ'/(1 - ψ') times the centre distance.

    Parameters
    ----------
    wheels, centers, arm, phase, pressure_angle
        As of :class:`~linkwork.core.mechanism.part.gears.Gear`.
    law : str, optional
        ψ as a decreasing function of phi; a formula of phi and dimensions.
    table : tuple of (φ, ψ), optional
        Alternatively pairs of angles over one turn of the first wheel, both ends included.
    pitch_curve : tuple of (x, y), optional
        Alternatively points of the first wheel's closed pitch curve about its centre, in its frame.
    start : number
        Angle of the first wheel at which φ is 0 in the formula or table.

    References
    ----------
    F. L. Litvin, A. Fuentes-Aznar, I. Gonzalez-Perez, K. Hayasaka, Noncircular Gears (2009).

    Examples
    --------
    >>> import linkwork as lw
    >>> motion = lw.example("elliptical-gears").sweep(step=90)
    >>> (motion["second"] - motion["second"][0]).round(1)
    array([   0. , -133.6, -180. , -226.4, -360. ])
    """

    title = "Non-circular gears"
    doc = "Two non-circular gears, such as ellipses, given by their transmission law"
    keys = (
        Key("name", Text(), "Name of the gear pair", required=True),
        *ARM_KEYS,
        Key("law", Formula(), "Angle of the second wheel as a formula of phi, the first one's"),
        Key("table", _PAIRS, "Or pairs of both angles over one turn of the first wheel"),
        Key("pitch_curve", COORDINATES, "Or the first wheel's pitch curve about its centre"),
        Key("start", NumberKey("angle"), "Angle of the first wheel at which phi is 0"),
        PHASE_KEY,
        PRESSURE_KEY,
    )
    kind = JointKind("G", 2, "non-circular gear pair")
    curves: ClassVar[tuple[str, str]] = ("_first", "_second")

    law: str | None = None
    table: tuple[tuple[Number, Number], ...] = ()
    pitch_curve: tuple[tuple[Number, Number], ...] = ()
    start: Number = 0

    def pairs(self, linkage: Bodies) -> None:
        return None

    def check(self, checks: PartChecks) -> None:
        """Check the wheels, the arm and the law."""
        super().check(checks)
        self.check_pressure(checks)
        given = [field for field in _LAWS if getattr(self, field)]
        if len(given) != 1:
            what = " and ".join(given) or "none of them"
            checks.add(f"needs one of law, table and pitch_curve, it has {what}")
            return
        checks.number(self.start, "start")
        if self.law is not None:
            self._check_law(self.law, checks)
        elif self.table:
            self._check_table(checks)
        else:
            checks.outline(self.pitch_curve, "pitch_curve", closed=True)
            if self.start != 0:
                checks.add("is used with law and table only", "start")

    def _check_law(self, law: str, checks: PartChecks) -> None:
        known = checks.linkage.numbers.known
        if "phi" in known:
            checks.add("phi is the angle of the first wheel here: rename the dimension", "law")
            return
        try:
            value(parse(law), {**known, "phi": 0.0}, checks.linkage.angle, law)
        except ExpressionError as error:
            # an invalid dimension is reported at its own key
            if not checks.linkage.numbers.wrong:
                checks.add(str(error), "law")

    def _check_table(self, checks: PartChecks) -> None:
        if any(len(pair) != 2 for pair in self.table) or len(self.table) < 5:
            checks.add("needs at least five pairs of angles", "table")
            return
        pairs = [
            tuple(checks.number(number, "table", k) for number in pair)
            for k, pair in enumerate(self.table)
        ]
        for k, (before, after) in enumerate(pairwise(pairs), 1):
            # external gears turn in opposite directions
            if after[0] <= before[0] or after[1] >= before[1]:
                checks.add("the first angle must increase, the second must decrease", "table", k)
        turn, over = checks.linkage.angle.turn, pairs[-1][0] - pairs[0][0]
        if abs(over - turn) > AGREE * turn:
            checks.add(f"covers {over:.10g}: one turn of the first wheel is {turn:g}", "table")

    def sketched_outlines(self, linkage: Bodies) -> Iterator[tuple[str, Outline]]:
        """Circles that share the distance of the centres."""
        for suffix, wheel, center in zip(self.curves, self.wheels, self.centers, strict=True):
            yield f"{self.name}{suffix}", (wheel, center, circle(self.distance(linkage) / 2))

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        names = [f"{self.name}{suffix}" for suffix in self.curves]
        yield from contours(PitchCurve, names, outlines)

    def size_of(self, link: str, linkage: Bodies) -> float | None:
        """Half of the centre distance."""
        return self.distance(linkage) / 2.0 if link in self.wheels else None

    def inverted(self, inversion: Inversion) -> Self:
        """Measure angles of the old ground from the line of its first two points."""
        same, turn = super().inverted(inversion), inversion.turn
        if self.pitch_curve:
            own = turned_back(self.pitch_curve, turn) if self.wheels[0] == GROUND else None
            return same if own is None else replace(same, pitch_curve=own)
        # the law's angle is that of the first wheel against the arm
        shift = turn * ((self.wheels[0] == GROUND) - (self.arm == GROUND))
        return replace(same, start=inversion.shifted(self.start, shift)) if shift else same
