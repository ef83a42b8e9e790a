"""Cams, given by the motion of the follower or by the outline of the cam."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Self

from linkwork.contacts.curves import COORDINATES, contours, coordinates, turned_back
from linkwork.core.foundation.errors import choices
from linkwork.core.foundation.names import GROUND
from linkwork.core.foundation.values import (
    Key,
    NumberValue as NumberKey,
    Tables,
    Text,
    check_values,
)
from linkwork.core.mechanism.bodies import (
    Bodies,
    CamOutline,
    DiscFigure,
    Figure,
    Follower,
    Outline,
    Outlines,
    circle,
)
from linkwork.core.mechanism.dimensions import Number
from linkwork.core.mechanism.inputs import LAWS
from linkwork.core.mechanism.part.guides import GuidePart, Slider, Slot, guide_named
from linkwork.core.mechanism.part.part import (
    AGREE,
    LINK,
    POINT,
    SLIDER,
    Inversion,
    JointKind,
    NamedPart,
    PartChecks,
    carriers,
    pinned,
)

__all__ = ["Cam", "CamOutline", "Follower", "Segment", "follower_frame"]

_CONTACTS = ("knife", "roller", "flat")
_SHORTEST = 1e-6  # minimum length of a segment, in turns
_SEGMENT = (
    Key("law", Text(LAWS), "Motion law of the follower", required=True),
    Key("over", NumberKey("angle"), "Angle by which the cam turns", required=True),
    Key("lift", NumberKey("lift"), "Displacement of the follower, positive away from the centre"),
)


@dataclass(frozen=True, kw_only=True)
class Segment:
    """A segment of a cam: the follower moves by ``lift`` while the cam turns by ``over``.

    Parameters
    ----------
    law : str
        The motion law: ``dwell``, ``cycloidal``, ``modified sine``, …; see the page on files.
    over : number
        Angle of the cam [file's angle unit].
    lift : number
        Displacement of the follower: a length, or an angle of an oscillating follower.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Segment(law="cycloidal", over=100, lift=25)
    Segment(law='cycloidal', over=100, lift=25)
    """

    law: str
    over: Number
    lift: Number = 0

    def __post_init__(self) -> None:
        check_values(self)


@dataclass(frozen=True, kw_only=True)
class Cam(NamedPart):
    """A cam with its follower, given by the motion of the follower or by the outline of the cam.

    Parameters
    ----------
    name : str
        The name of the cam.
    cam, center : str
        The rotating link and its centre of rotation.
    slider : str, optional
        A translating follower: the slider that moves. Its first point is the knife edge, the centre
        of the roller, or on the flat face.
    link, pivot, point : str, optional
        An oscillating follower: the link, its pivot, and its knife edge or the centre of its
        roller; a flat face runs from the pivot to ``point``.
    contact : str
        ``knife``, ``roller`` or ``flat``.
    radius : number
        Radius of the roller [length].
    base : number, optional
        Radius of the base circle [length], with ``segments``.
    segments : tuple of Segment
        The motion of the follower in one turn of the cam.
    start : number
        The cam's angle at which the first segment begins [file's angle unit].
    profile : tuple of (x, y), optional
        Instead of segments: the closed outline of the cam in its own frame about its centre
        [length].

    Examples
    --------
    >>> import linkwork as lw
    >>> rise = lw.Segment(law="cycloidal", over=180, lift=25)
    >>> fall = lw.Segment(law="cycloidal", over=180, lift=-25)
    >>> cam = lw.Cam(name="c", cam="disc", center="O", slider="s", base=40, segments=[rise, fall])
    >>> len(cam.segments), cam.contact
    (2, 'knife')
    """

    title = "Cam"
    doc = "A cam and its follower"
    keys = (
        Key("name", Text(), "Name of the cam", required=True),
        Key("cam", LINK, "The rotating link", required=True),
        Key("center", POINT, "Its centre of rotation", required=True),
        Key("slider", SLIDER, "The slider moved by the cam"),
        Key("link", LINK, "Or the oscillating link moved by the cam"),
        Key("pivot", POINT, "With link: the point about which it oscillates"),
        Key(
            "point",
            POINT,
            "With link: its knife edge, the centre of its roller or the end of its face",
        ),
        Key("contact", Text(_CONTACTS), "Kind of the follower; default knife"),
        Key("radius", NumberKey("length"), "Radius of the roller"),
        Key("base", NumberKey("length"), "Radius of the base circle, with segments"),
        Key("start", NumberKey("angle"), "Angle of the cam at which the segments begin; default 0"),
        Key("segments", Tables(_SEGMENT, made=Segment), "The follower's motion in one turn"),
        Key("profile", COORDINATES, "Or the outline, in the cam's frame about its centre"),
    )
    kind = JointKind("C", 2, "cam")
    lets_go = ("lifts off",)

    cam: str
    center: str
    slider: str | None = None
    link: str | None = None
    pivot: str | None = None
    point: str | None = None
    contact: str = "knife"
    radius: Number = 0
    base: Number | None = None
    segments: tuple[Segment, ...] = ()
    start: Number = 0
    profile: tuple[tuple[Number, Number], ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        added: tuple[str, ...] = ()
        if self.profile:
            added = ("x", "y")
            if self.contact != "knife":
                added += ("dx", "dy", "speed")
                added += ("normal",) if self.contact == "roller" else ("way", "contact")
        return (self.name, *(f"{self.name}_{word}" for word in added))

    @property
    def friction_sizes(self) -> tuple[str, ...] | None:
        return None if self.contact == "roller" else ()

    @property
    def turning(self) -> tuple[str, ...]:
        return (self.cam,)

    def joined(self, linkage: Bodies) -> tuple[str, ...]:
        guide = guide_named(linkage, self.slider)
        if isinstance(guide, Slider):
            return self.cam, guide.link
        return self.cam, str(self.link) if guide is None else pinned(linkage, guide.point_on_line)

    def pairs(self, linkage: Bodies) -> None:
        return None

    def check(self, checks: PartChecks) -> None:
        """Check that the cam has one follower and one shape."""
        if not checks.link(self.cam, "cam"):
            return
        checks.on(self.center, self.cam, "center")
        self._check_follower(checks)
        if self.contact not in _CONTACTS:
            checks.add(f"must be knife, roller or flat, got {self.contact}", "contact")
        elif self.contact == "roller":
            checks.positive(self.radius, "radius", "radius")
        elif self.radius != 0:
            checks.add(f"is used with a roller only, the contact is {self.contact}", "radius")
        # the motion determines the outline and the outline the motion: both together could disagree
        if bool(self.segments) == bool(self.profile):
            what = "both" if self.segments else "neither"
            checks.add(f"needs either segments or a profile, it has {what}")
        elif self.segments:
            self._check_segments(checks)
        else:
            if self.base is not None:
                checks.add("is used with segments only: a profile contains its own size", "base")
            checks.outline(self.profile, "profile", closed=True)

    def _check_follower(self, checks: PartChecks) -> None:
        if (self.slider is None) == (self.link is None):
            what = "both" if self.slider is not None else "neither"
            checks.add(f"needs a follower, either a slider or an oscillating link; it has {what}")
        elif self.slider is not None:
            self._check_sliding(checks)
        elif self.link is not None and checks.link(self.link, "link"):
            self._check_swinging(checks, self.link)

    def _check_sliding(self, checks: PartChecks) -> None:
        linkage = checks.linkage
        guide = guide_named(linkage, self.slider)
        if guide is None:
            names = [s.name for kind in (Slider, Slot) for s in linkage.of(kind)]
            checks.add(
                f'slider "{self.slider}" is not defined {choices("sliders", names)}', "slider"
            )
        elif self.center not in linkage.links.get(guide.on, ()):
            checks.add(
                f'"{guide.on}", along which the follower slides, does not carry {self.center}',
                "center",
            )
        elif self.contact == "flat" and isinstance(guide, Slot):
            checks.add(
                f'"{guide.name}" is a slot, whose pin has no face: a flat follower needs a slider',
                "contact",
            )
        for field in ("pivot", "point"):
            if getattr(self, field) is not None:
                checks.add("is used with link, not with slider", field)

    def _check_swinging(self, checks: PartChecks, link: str) -> None:
        for field in ("pivot", "point"):
            name = getattr(self, field)
            if name is None:
                checks.add("is missing: an oscillating follower needs it", field)
            else:
                checks.on(name, link, field)
        if self.pivot is not None and self.pivot == self.point:
            checks.add("must be another point than the pivot", "point")
        if self.pivot is not None and not any(_swinging_frames(checks.linkage, self)):
            checks.add(
                f"no link carries both {self.center} and {self.pivot}: cam and follower need "
                "one frame",
                "pivot",
            )

    def _check_segments(self, checks: PartChecks) -> None:
        unit = checks.linkage.angle
        if self.base is None:
            checks.add("is missing: the radius of the base circle", "base")
        else:
            checks.positive(self.base, "radius", "base")
        checks.number(self.start, "start")
        overs, lifts = [], []
        for k, segment in enumerate(self.segments):
            over = checks.number(segment.over, "segments", k, "over")
            lift = checks.number(segment.lift, "segments", k, "lift")
            if segment.law not in LAWS:
                message = f"must be one of {', '.join(LAWS)}, got {segment.law}"
                checks.add(message, "segments", k, "law")
            if over <= 0:
                checks.add(f"must be a positive angle, got {over:g}", "segments", k, "over")
            # derivatives grow with 1/over²
            elif over < _SHORTEST * unit.turn:
                message = f"{over:g} is too small: at least {_SHORTEST * unit.turn:g}"
                checks.add(message, "segments", k, "over")
            if segment.law == "dwell" and lift:
                checks.add("must be 0: a dwell has no rise", "segments", k, "lift")
            overs.append(over)
            lifts.append(lift)
        # NaN for invalid numbers, which are reported already
        total = sum(overs)
        if not math.isnan(total) and abs(total - unit.turn) > AGREE * unit.turn:
            checks.add(
                f"turn the cam by {total:.10g} in total: a closed cam needs {unit.turn:.10g}",
                "segments",
            )
        height = sum(lifts)
        if not math.isnan(height) and abs(height) > AGREE * max(map(abs, lifts), default=0.0):
            checks.add(
                f"end {height:+.10g} away from their start: on a closed cam the "
                "follower returns to its start",
                "segments",
            )

    def figures(self, linkage: Bodies, outlines: Outlines) -> Iterator[Figure]:
        follower = self._follower(linkage)
        if self.contact == "roller":
            yield DiscFigure(
                name=self.name,
                link=follower.link,
                center=follower.point,
                radius=linkage.numbers(self.radius),
                kind="roller",
            )
        yield from contours(CamOutline, [self.name], outlines)
        yield follower

    def sketched_outlines(self, linkage: Bodies) -> Iterator[tuple[str, Outline]]:
        """The base circle, or the given points."""
        base = 0.0 if self.base is None else linkage.numbers(self.base)
        points = coordinates(self.profile, linkage) if self.profile else circle(base)
        yield self.name, (self.cam, self.center, points)

    def _follower(self, linkage: Bodies) -> Follower:
        guide = guide_named(linkage, self.slider)
        point, link = self.point, self.link
        if guide is not None:
            point = guide.point_on_line
            link = guide.link if isinstance(guide, Slider) else _other_body(linkage, guide, point)
        assert point is not None
        assert link is not None
        return Follower(
            name=self.name,
            link=link,
            point=point,
            center=self.center,
            contact=self.contact,
            slider=self.slider,
            pivot=self.pivot,
        )

    def size_of(self, link: str, linkage: Bodies) -> float | None:
        """The radius of the base circle or of the first point of the outline."""
        if link != self.cam:
            return super().size_of(link, linkage)
        if self.base is not None:
            return linkage.numbers(self.base)
        return abs(complex(*map(linkage.numbers, self.profile[0])))

    def inverted(self, inversion: Inversion) -> Self:
        """Measure angles of the old ground from the line of its first two points."""
        linkage, turn = inversion.linkage, inversion.turn
        same = super().inverted(inversion)
        if self.cam == GROUND and self.profile:
            return replace(same, profile=turned_back(self.profile, turn))
        # the law's angle is that of the cam against the follower's frame
        shift = turn * ((self.cam == GROUND) - (follower_frame(linkage, self) == GROUND))
        if not shift or not self.segments:
            return same
        return replace(same, start=inversion.shifted(self.start, shift))


def follower_frame(linkage: Bodies, cam: Cam) -> str:
    """The link on which the follower slides, or with its pivot and the cam's centre."""
    guide = guide_named(linkage, cam.slider)
    return next(_swinging_frames(linkage, cam)) if guide is None else guide.on


def _swinging_frames(linkage: Bodies, cam: Cam) -> Iterator[str]:
    """Links with both the cam's centre and the pivot of its follower."""
    both = {cam.center, cam.pivot}
    for name, points in linkage.links.items():
        if name not in (cam.cam, cam.link) and both <= set(points):
            yield name


def _other_body(linkage: Bodies, guide: GuidePart, point: str) -> str:
    """The body whose pin runs in a slot."""
    return next(body for body in carriers(linkage)[point] if body != guide.on)
