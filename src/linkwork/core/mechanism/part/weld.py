"""Weld: two links that share a point and turn together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.precise import Precise
from linkwork.core.foundation.values import Key, ListOf, NumberValue as NumberKey, Text
from linkwork.core.mechanism.bodies import Bodies, Figure, Outlines
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.part.part import (
    Inversion,
    KinematicPairs,
    Pair,
    PairKind,
    Part,
    PartChecks,
    turning_links,
)


@dataclass(frozen=True, kw_only=True)
class RigidJoint(Figure):
    """Two links welded together at a common point."""

    over: ClassVar[bool] = True

    links: tuple[str, str]
    point: str


@dataclass(frozen=True, kw_only=True)
class Weld(Part):
    """A weld: two links share a point and turn together.

    Parameters
    ----------
    links : (str, str)
        The two links.
    angle : number, optional
        Angle from the direction of the first link to that of the second [file's angle unit]; by
        default measured in the sketch.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Weld(links=["pulley", "crank"], angle=0).links
    ('pulley', 'crank')
    """

    title = "Weld"
    doc = "Two links that share a point and rotate together"
    keys = (
        Key("links", ListOf(Text(), "link", 2, 2), "Two links that share a point", required=True),
        Key("angle", NumberKey("angle"), "From the first link's direction to the second's"),
    )

    links: tuple[str, str]
    angle: Number | None = None

    @property
    def label(self) -> str:
        return " ".join(self.links)

    @property
    def mobility(self) -> int:
        """The weld removes the freedom of the pin between its two links."""
        return -1

    def kept_angle(self, linkage: Bodies) -> tuple[str, str, Precise]:
        first, second = self.links
        angle = self.measured_angle(linkage)
        if angle is None:
            angle = linkage.numbers.precise_angle(self.angle or 0)
        return second, first, angle

    def measured_angle(self, linkage: Bodies) -> Precise | None:
        if self.angle is not None:
            return None
        first, second = map(linkage.exact_angle, self.links)
        return second - first

    def pairs(self, linkage: Bodies) -> KinematicPairs:
        first, second = (linkage.links[link] for link in self.links)
        shared = next(point for point in first if point in second)
        name = self.label.replace(" ", "_")
        pair = Pair(kind=PairKind.FIXED, name=name, bodies=self.links, point=shared)
        return KinematicPairs(pairs=(pair,))

    def check(self, checks: PartChecks) -> None:
        if not checks.two(self.links, "link", "links"):
            return
        known = [checks.link(name, "links") for name in self.links]
        if not all(known):
            return
        first, second = (checks.linkage.links[name] for name in self.links)
        if not set(first) & set(second):
            checks.add(
                f"{' and '.join(self.links)} share no point: let both carry the point at which "
                "they are welded",
                "links",
            )
        # their angles are separate unknowns; other links have a direction by two points
        directed = {GROUND, *turning_links(checks.linkage)}
        for name, points in zip(self.links, (first, second), strict=True):
            if len(points) < 2 and name not in directed:
                checks.add(
                    f'"{name}" has only the point {points[0]}, so its direction is not known: '
                    "make one link of both",
                    "links",
                )
        if self.angle is not None:
            checks.number(self.angle, "angle")

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        first, second = (linkage.links[name] for name in self.links)
        shared = next(point for point in first if point in second)
        yield RigidJoint(name=self.label, links=self.links, point=shared)

    def inverted(self, inversion: Inversion) -> Self:
        # the angle follows from the sketch, which is an assembled position
        return replace(super().inverted(inversion), angle=None)
