"""Wheels that roll without slip on a line or a circle of a link."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.values import Flag, Key, NumberValue as NumberKey, Text
from linkwork.core.mechanism.bodies import Bodies, DiscFigure, Figure, Outlines
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.part.part import (
    LINK,
    POINT,
    POINT_PAIR,
    AddedBody,
    Coupling,
    JointKind,
    KinematicPairs,
    NamedPart,
    Pair,
    PairKind,
    PartChecks,
    meshing,
    sliding_block,
)


@dataclass(frozen=True, kw_only=True)
class RollingLine(Figure):
    """The line through two points of the body ``on``, on which a wheel rolls."""

    on: str
    line: tuple[str, str]
    center: str
    radius: float

    @property
    def laid_by(self) -> tuple[str, ...]:
        return self.line if self.on == GROUND else ()


@dataclass(frozen=True, kw_only=True)
class Rolling(NamedPart):
    """A wheel that rolls without slip on a line or circle of another link.

    Parameters
    ----------
    name : str
        The displacement of the point of contact along ``line``, zero at its first point [length];
        on a circle the angle of the line of centres.
    wheel : str
        The link that rolls.
    center : str
        The centre of the wheel.
    radius : number
        The radius of the wheel [length].
    on : str
        The link on which it rolls.
    line : (str, str), optional
        Two points of that link; either this or ``circle``.
    circle : str, optional
        The centre of a circle on that link.
    circle_radius : number, optional
        The radius of the circle [length].
    inside : bool
        Whether the smaller of wheel and circle rolls inside the larger one.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Rolling(name="x", wheel="w", center="C", radius=40, line=("S", "T")).on
    'ground'
    >>> round(lw.example("rolling-wheel").solve(at=-180)["x"] / 40, 6)
    1.570796
    """

    title = "Rolling wheel"
    doc = "A wheel that rolls without slip"
    keys = (
        Key(
            "name",
            Text(),
            "Displacement of the point of contact along the line, or angle of the line of centres",
            required=True,
        ),
        Key("wheel", LINK, "The link that rolls", required=True),
        Key("center", POINT, "Its centre", required=True),
        Key("radius", NumberKey("length"), "Its radius", required=True),
        Key("on", LINK, "The link on which it rolls; default ground"),
        Key("line", POINT_PAIR, "Two points of that link: it rolls along this line"),
        Key("circle", POINT, "Or the centre of the circle on which it rolls"),
        Key("circle_radius", NumberKey("length"), "The radius of that circle"),
        Key("inside", Flag(), "The smaller of wheel and circle is inside the larger one"),
    )
    kind = JointKind("W", 1, "rolling contact")
    lets_go = ("lifts off", "slips")

    wheel: str
    center: str
    radius: Number
    on: str = "ground"
    line: tuple[str, str] | None = None
    circle: str | None = None
    circle_radius: Number | None = None
    inside: bool = False

    @property
    def turning(self) -> tuple[str, ...]:
        return (self.wheel,)

    @property
    def drive(self) -> str:
        return "" if self.line is None else "slider"

    @property
    def friction_sizes(self) -> tuple[str, ...]:
        return ()

    @property
    def guided(self) -> tuple[str, str, str] | None:
        return None if self.line is None else ("center", self.center, self.on)

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        return self.wheel, self.on

    def pairs(self, linkage: Bodies) -> KinematicPairs:
        radius = linkage.numbers(self.radius)
        if self.line is not None:
            turns = ((self.wheel, radius), (self.on, -radius))
            slide = (self.name, linkage.side_of(self.line, self.center))
            rolls = Coupling(name=self.name, turns=turns, slides=(slide,))
            block = sliding_block(self.name, self.on, self.line, self.center)
            return replace(block.with_pin(self.wheel), couplings=(rolls,))
        assert self.circle is not None
        assert self.circle_radius is not None
        arm = AddedBody(name=f"{self.name} arm", points=(self.circle, self.center), angle=self.name)
        ends = {self.circle: (self.on, arm.name), self.center: (arm.name, self.wheel)}
        radii = (linkage.numbers(self.circle_radius), radius)
        wheels, outside = (self.on, self.wheel), not self.inside
        return KinematicPairs(
            bodies=(arm,),
            pairs=tuple(
                Pair(kind=PairKind.PIN, name=point, bodies=bodies, point=point)
                for point, bodies in ends.items()
            ),
            couplings=(meshing(self.name, wheels, arm.name, radii, outside=outside),),
        )

    def check(self, checks: PartChecks) -> None:
        """Check that the wheel is on a line or circle of another link."""
        known = [checks.link(self.wheel, "wheel"), checks.link(self.on, "on")]
        radius = checks.positive(self.radius, "radius", "radius")
        if (self.line is None) == (self.circle is None):
            what = "both" if self.line is not None else "neither"
            checks.add(f"needs either a line or a circle to roll on, it has {what}")
            return
        if not all(known):
            return
        if self.wheel == self.on:
            checks.add(f'"{self.on}" cannot roll on itself', "on")
            return
        checks.on(self.center, self.wheel, "center")
        if self.center in checks.linkage.links[self.on]:
            checks.add(
                f'{self.center} is fixed on "{self.on}", so the wheel cannot roll along it',
                "center",
            )
        if self.line is not None:
            if checks.two(self.line, "point", "line"):
                for point in self.line:
                    checks.on(point, self.on, "line")
            if self.inside or self.circle_radius is not None:
                field = "inside" if self.inside else "circle_radius"
                checks.add("is used with circle only", field)
        else:
            self._check_circle(checks, radius)

    def _check_circle(self, checks: PartChecks, radius: float) -> None:
        assert self.circle is not None
        checks.on(self.circle, self.on, "circle")
        if self.circle_radius is None:
            checks.add("is missing: the size of the circle", "circle_radius")
            return
        both = {self.center, self.circle}
        links = checks.linkage.links
        # an arm fixes the distance already: the pair would be overconstrained
        arm = next((name for name, own in links.items() if both <= set(own)), None)
        if arm is not None:
            checks.add(
                f'"{arm}" carries both centres {self.circle} and {self.center} already: two '
                "wheels on an arm are [[gears]]",
                "circle",
            )
        size = checks.positive(self.circle_radius, "radius", "circle_radius")
        if self.inside and radius == size:
            checks.add("equals circle_radius: a wheel inside a circle must be smaller", "radius")
        elif radius > 0 and size > 0:
            checks.comparable(radius, size, "circle_radius", "and radius ")

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        small = linkage.numbers(self.radius)
        large = linkage.numbers(self.circle_radius or 0)
        wheel = DiscFigure(
            name=self.name, link=self.wheel, center=self.center, radius=small, kind="wheel",
            ring=self.inside and small > large,
        )  # fmt: skip
        yield wheel
        if self.circle is not None:
            ring = self.inside and large > small
            yield replace(wheel, link=self.on, center=self.circle, radius=large, ring=ring)
        if self.line is not None:
            yield RollingLine(
                name=self.name, on=self.on, line=self.line, center=self.center, radius=small
            )
