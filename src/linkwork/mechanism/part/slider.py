"""Slider: a link translates along a line of another link without relative rotation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Self

from linkwork.foundation.file_keys import Key, ListOf, Number as NumberKey, Text
from linkwork.foundation.names import GROUND
from linkwork.foundation.precise import PI, Precise, chosen, phase
from linkwork.mechanism.bodies import Bodies
from linkwork.mechanism.dimensions import Number
from linkwork.mechanism.figures import Figure, Guide, Outlines
from linkwork.mechanism.joint import JointKind
from linkwork.mechanism.part.guide import GuidePart
from linkwork.mechanism.part.pairs import KinematicPairs, Pair, PairKind
from linkwork.mechanism.part.part import LINK, POINT_PAIR, Inversion, Part, PartChecks

__all__ = ["Slider"]


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
        checks.length(self.offset, "offset")
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
