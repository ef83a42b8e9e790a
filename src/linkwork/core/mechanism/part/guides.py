"""Sliders, slots, cylinders."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar, Self

from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.precise import PI, Precise, chosen, phase
from linkwork.core.foundation.values import Key, ListOf, NumberValue as NumberKey, Text
from linkwork.core.mechanism.bodies import Bodies, Figure, Guide, Outlines
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.part.part import (
    LINK,
    POINT,
    POINT_PAIR,
    AddedBody,
    Inversion,
    Joint,
    JointKind,
    KinematicPairs,
    NamedPart,
    Pair,
    PairKind,
    Part,
    PartChecks,
    pinned,
    sliding_block,
)

# ----------------------------------------------------------------------
# Guides: parts that guide a point along the line through two points of a link.


@dataclass(frozen=True, kw_only=True)
class GuidePart(NamedPart):
    """A slider or slot along the line through two points of the link ``on``."""

    on: str
    line: tuple[str, str]

    @property
    def drive(self) -> str:
        return "slider"

    @property
    def point_on_line(self) -> str:
        """The guided point."""
        raise NotImplementedError

    def check_shapes(self, checks: PartChecks) -> None:
        """Check that the sketch shows the direction of the line."""
        first, second = self.line
        if checks.linkage.sketched(first) == checks.linkage.sketched(second):
            checks.add(
                f"{first} and {second} are sketched at the same place: draw them apart", "line"
            )


def guide_named(linkage: Bodies, name: str | None) -> GuidePart | None:
    """The slider or slot with this name."""
    return next((guide for guide in linkage.of(GuidePart) if guide.name == name), None)


# ----------------------------------------------------------------------
# Slider: a link translates along a line of another link without relative rotation.


@dataclass(frozen=True, kw_only=True)
class Slider(GuidePart):
    """A prismatic joint: a link slides along a line of another link without rotation.

    Parameters
    ----------
    name : str
        The displacement, zero at the first point of ``line``, positive towards the second [length].
    link : str
        The sliding link.
    points : tuple of str
        One or two points of the sliding link at the distance ``offset`` from the line.
    on : str
        The link on which it slides.
    line : (str, str)
        Two points of that link.
    offset : number
        Distance of the points from the line, positive to its left [length].
    angle : number, optional
        With one point: the angle from the line to the sliding link's direction [file's angle unit].

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Slider(name="d", link="block", points=("B",), on="ground", line=("S", "T")).offset
    0
    >>> round(lw.example("slider-crank").solve(at=60)["d"], 3)
    126.838
    """

    title = "Slider"
    doc = "A link slides along a line of another without rotation"
    keys = (
        Key("name", Text(), "Name of the displacement, zero at the first point of the line", True),
        Key("link", LINK, "The link that slides without rotation", required=True),
        Key(
            "points",
            ListOf(Text(), "point", 1, 2),
            "Two points of the sliding link on the line, or one point and angle",
            required=True,
        ),
        Key("on", LINK, "The link along which it slides", required=True),
        Key("line", POINT_PAIR, "Two points of that link; positive from first to second", True),
        Key(
            "offset",
            NumberKey("length"),
            "Distance of the points from the line, positive to its left",
        ),
        Key(
            "angle",
            NumberKey("angle"),
            "With one point: the angle from the line to the sliding link",
        ),
    )
    kind = JointKind.PRISMATIC
    holders = "sliders"

    link: str
    points: tuple[str, ...]
    offset: Number = 0
    angle: Number | None = None

    @property
    def point_on_line(self) -> str:
        return self.points[0]

    @property
    def friction_sizes(self) -> tuple[str, ...]:
        return ("length",)

    @property
    def guided(self) -> tuple[str, str, str] | None:
        return ("points", self.points[0], self.on) if self.points else None

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        return self.link, self.on

    def pairs(self, linkage: Bodies) -> KinematicPairs:
        slide = Pair(
            kind=PairKind.SLIDE,
            name=self.name,
            bodies=(self.on, self.link),
            point=self.points[0],
            line=self.line,
        )
        return KinematicPairs(pairs=(slide,))

    def kept_angle(self, linkage: Bodies) -> tuple[str, str, Precise]:
        return self.link, self.on, self._angle_against(linkage)

    def _angle_against(self, linkage: Bodies) -> Precise:
        """The angle of the link relative to its carrier, from the line and the sliding points."""
        line = phase(linkage.shapes.direction(self.on, self.line))
        if len(self.points) == 2:
            own = phase(linkage.shapes.direction(self.link, (self.points[0], self.points[1])))
            d, e, a, b = (linkage.sketched(p) for p in (*self.points, *self.line))
            # two points on a line allow two directions half a turn apart: use that of the
            # sketch
            along = ((e - d) * (b - a).conjugate()).real >= 0
            return line - own + chosen(along, Precise(0.0), PI)
        if self.angle is not None:
            return line + linkage.numbers.precise_angle(self.angle)
        measured = self.measured_angle(linkage)
        # a one-point block has no direction: use that of the line
        return line if measured is None else line + measured

    def measured_angle(self, linkage: Bodies) -> Precise | None:
        directed = self.link == GROUND or len(linkage.links[self.link]) > 1
        if len(self.points) == 2 or self.angle is not None or not directed:
            return None
        a, b = map(linkage.precisely_sketched, self.line)
        return linkage.exact_angle(self.link) - phase(b - a)

    def check(self, checks: PartChecks) -> None:
        links = checks.linkage.links
        checks.line(self.on, self.line)
        if not checks.link(self.link, "link"):
            return
        if self.link == self.on:
            checks.add(f'"{self.link}" cannot slide on itself', "on")
        if len(self.points) not in (1, 2):
            checks.add(f"needs one or two points, got {len(self.points)}", "points")
        for point in self.points:
            if not checks.defined(point, "points"):
                continue
            if self.link != self.on and point in links.get(self.on, ()):
                message = f'point "{point}" is fixed on "{self.on}" and cannot slide on it'
                checks.add(message, "points")
            else:
                checks.on(point, self.link, "points")
        if len(set(self.points)) < len(self.points):
            checks.add(f"names {self.points[0]} twice", "points")
        if len(self.points) == 2 and self.angle is not None:
            checks.add("is already given by the two points: leave one of them out", "angle")
        checks.amount(self.offset, "offset")
        if self.angle is not None:
            checks.number(self.angle, "angle")

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        for point in self.points:
            yield Guide(
                name=self.name,
                point=point,
                on=self.on,
                line=self.line,
                offset=linkage.numbers(self.offset),
                block=True,
                link=self.link,
            )

    def inverted(self, inversion: Inversion) -> Self:
        """The slider; if the sliding link is the new ground, the roles of both links are exchanged.

        The displacement stays the same, since the new line has the opposite direction. The guide of
        a cam's follower or of a rack remains the guide.
        """
        linkage, seen, fixed = inversion.linkage, inversion.seen, inversion.fixed
        led = {getattr(part, "slider", None) for part in linkage.of(Part)}
        if self.link != inversion.link or self.name in led:
            same = super().inverted(inversion)
            return replace(same, angle=self._angle_from_line(inversion))
        start, end = (seen[point] for point in self.line)
        along = (end - start) / abs(end - start)
        own = seen[self.points[0]]
        # the offset is measured to the left of the line
        foot = own - 1j * along * linkage.numbers(self.offset)
        line = []
        for name, place in (("foot", foot), ("guide", foot - (end - start))):
            line.append(inversion.free_name(f"{self.name}_{name}"))
            seen[line[-1]] = place
        if foot == own:  # then the block's point is the foot of the normal
            del seen[line[0]]
            line[0] = self.points[0]
        fixed += [point for point in line if point not in fixed]
        return type(self)(
            name=self.name,
            link=inversion.name(self.on),
            points=self.line,
            on=inversion.ground,
            line=(line[0], line[1]),
        )

    def _angle_from_line(self, inversion: Inversion) -> Number | None:
        """The angle of a one-point slider; that of ground is measured from the x axis."""
        angle = self.angle
        if angle is None or self.link != inversion.ground or not inversion.turn:
            return angle
        return inversion.shifted(angle, inversion.turn)


# ----------------------------------------------------------------------
# Pin in slot: a point moves along a line of another link.


_FEWEST, _MOST = 3, 60  # slots of a Geneva wheel


@dataclass(frozen=True, kw_only=True)
class GenevaWheel(Figure):
    """A wheel with ``count`` equal slots about ``center``; ``rim`` is at the mouth of one of them.

    ``name`` is that of the slot, ``pin`` the point that runs in it.
    """

    link: str
    center: str
    rim: str
    pin: str
    count: int


@dataclass(frozen=True, kw_only=True)
class Slot(GuidePart):
    """A pin in a slot: a point of one link moves along a line of another link.

    Parameters
    ----------
    name : str
        The displacement, zero at the first point of ``line``, positive towards the second [length].
    point : str
        The pin.
    on : str
        The link with the slot.
    line : (str, str)
        Two points of that link.
    count : number, optional
        The number of equal slots around the first point of ``line``, their mouths as far from it as
        the second: a Geneva wheel, drawn as a star.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Slot(name="s", point="A", on="lever", line=("O4", "Q")).name
    's'
    >>> round(lw.example("crank-shaper").solve(at=90)["s"], 6)
    210.0
    """

    title = "Pin in slot"
    doc = "Pin in slot: a point moves along a line of another link"
    keys = (
        Key("name", Text(), "Name of the displacement, zero at the first point of the line", True),
        Key("point", POINT, "The pin: a point of another link", required=True),
        Key("on", LINK, "The link with the slot", required=True),
        Key("line", POINT_PAIR, "Two points of that link; positive from first to second", True),
        Key(
            "count",
            NumberKey(),
            "For drawings: equal slots around the first point of the line, open at the second",
        ),
    )
    kind = JointKind.PIN_IN_SLOT

    point: str
    count: Number | None = None

    @property
    def point_on_line(self) -> str:
        return self.point

    @property
    def friction_sizes(self) -> tuple[str, ...]:
        return ()

    @property
    def guided(self) -> tuple[str, str, str]:
        return "point", self.point, self.on

    def joint(self, linkage: Bodies) -> Joint:
        # the pin's name joins the slot to the pin of other links at this point
        links = (pinned(linkage, self.point), self.on)
        return Joint(kind=self.kind, name=self.name, links=links, point=self.point)

    def pairs(self, linkage: Bodies) -> KinematicPairs:
        block = sliding_block(self.name, self.on, self.line, self.point)
        link = pinned(linkage, self.point)
        return block.with_pin(link)

    def check(self, checks: PartChecks) -> None:
        checks.line(self.on, self.line)
        fixed = self.point in checks.linkage.links.get(self.on, ())
        if checks.defined(self.point, "point") and fixed:
            checks.add(
                f'point "{self.point}" is fixed on "{self.on}" and cannot move in its slot', "point"
            )

        if self.count is None:
            return
        count = checks.number(self.count, "count")
        if not (_FEWEST <= count <= _MOST and count == round(count)):
            checks.add(
                f"must be a whole number from {_FEWEST} to {_MOST}, it is {count:g}", "count"
            )

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        yield Guide(name=self.name, point=self.point, on=self.on, line=self.line)
        if self.count is not None:
            yield GenevaWheel(
                name=self.name,
                link=self.on,
                center=self.line[0],
                rim=self.line[1],
                pin=self.point,
                count=round(linkage.numbers(self.count)),
            )


# ----------------------------------------------------------------------
# Cylinder: a link of variable length between two points.


@dataclass(frozen=True, kw_only=True)
class Strut(Figure):
    """A body of variable length between two points."""

    over: ClassVar[bool] = True

    between: tuple[str, str]


@dataclass(frozen=True, kw_only=True)
class Cylinder(NamedPart):
    """A link of variable length between two points, such as a hydraulic cylinder.

    Parameters
    ----------
    name : str
        The name of the variable length.
    between : (str, str)
        The two points.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Cylinder(name="ram", between=("P", "Q")).angle_name
    'ram_angle'
    """

    title = "Cylinder"
    doc = "A link of variable length between two points"
    keys = (
        Key("name", Text(), "Name of the variable length", required=True),
        Key("between", POINT_PAIR, "The two points it connects", required=True),
    )
    kind = JointKind.PRISMATIC

    between: tuple[str, str]

    @property
    def angle_name(self) -> str:
        """The name of the cylinder's angle in results."""
        stem = self.name.rstrip("'")
        return f"{stem}_angle{self.name[len(stem) :]}"  # primes are at the end of a name

    @property
    def names(self) -> tuple[str, ...]:
        return self.name, self.angle_name

    @property
    def drive(self) -> str:
        return "cylinder"

    @property
    def body(self) -> tuple[str, ...]:
        return self.between

    @property
    def ends(self) -> tuple[str, str]:
        """The two links of a cylinder, at its first and at its second point."""
        return f"{self.name} barrel", f"{self.name} rod"

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        return self.ends

    def pairs(self, linkage: Bodies) -> KinematicPairs:
        ends = zip(self.ends, self.between, strict=True)
        slide = Pair(
            kind=PairKind.SLIDE,
            name=self.name,
            bodies=self.ends,
            point=self.between[1],
            line=self.between,
        )
        return KinematicPairs(
            bodies=tuple(
                AddedBody(name=end, points=(point,), angle=self.angle_name, pinned=True)
                for end, point in ends
            ),
            pairs=(slide,),
        )

    def check(self, checks: PartChecks) -> None:
        checks.ends(self.between)

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        yield Strut(name=self.name, between=self.between)
