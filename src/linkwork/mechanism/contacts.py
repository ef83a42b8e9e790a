"""Parts in contact: welds, gears, racks, rolling wheels, belts, cams and curves."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.mechanism.parts import Number, as_tuples

__all__ = ["Belt", "Cam", "Curve", "Gear", "Rack", "Rolling", "Segment", "Weld", "names_of"]


@dataclass(frozen=True, kw_only=True)
class Weld:
    """Two links that share a point and turn together.

    ``angle`` leads from the first link's direction to the second's; measured if left out.
    """

    links: tuple[str, str]
    angle: Number | None = None

    def __post_init__(self) -> None:
        as_tuples(self, "links")


@dataclass(frozen=True, kw_only=True)
class Gear:
    """Two wheels in mesh: r1 (θ1 - θ_arm) ± r2 (θ2 - θ_arm) is constant.

    Parameters
    ----------
    wheels, centers : (str, str)
        Links, and the points at which they turn on ``arm``.
    arm : str
        The link that carries both centres: ground, or the carrier of a planetary gear.
    radii, teeth : (number, number)
        One of both; with teeth the radii follow from the distance of the centres.
    internal : bool
        The larger wheel is a ring around the smaller one.
    phase : number, optional
        The second wheel's angle against the arm where the first one's is zero; as sketched if
        left out.
    """

    name: str
    wheels: tuple[str, str]
    centers: tuple[str, str]
    arm: str = "ground"
    radii: tuple[Number, Number] | None = None
    teeth: tuple[Number, Number] | None = None
    internal: bool = False
    phase: Number | None = None

    def __post_init__(self) -> None:
        as_tuples(self, "wheels", "centers", "radii", "teeth")


@dataclass(frozen=True, kw_only=True)
class Belt:
    """A belt or chain around two wheels, open or crossed; it keeps r1 θ1 ∓ r2 θ2 against the arm.

    Fields as of :class:`Gear`.
    """

    name: str
    wheels: tuple[str, str]
    centers: tuple[str, str]
    arm: str = "ground"
    radii: tuple[Number, Number] | None = None
    teeth: tuple[Number, Number] | None = None
    crossed: bool = False
    phase: Number | None = None

    def __post_init__(self) -> None:
        as_tuples(self, "wheels", "centers", "radii", "teeth")


@dataclass(frozen=True, kw_only=True)
class Rack:
    """Rack and pinion: a slider's displacement is rolled off by a pinion.

    ``slider`` names a slider; the pinion turns about ``center`` on the link along which it slides.
    The sketch tells on which side of the rack's line the pinion stands.
    """

    name: str
    pinion: str
    center: str
    slider: str
    radius: Number


@dataclass(frozen=True, kw_only=True)
class Rolling:
    """A wheel that rolls without slipping on a line or a circle of a link.

    Parameters
    ----------
    name : str
        The way of the point of contact along ``line``, zero at its first point; on a circle the
        angle of the line of centres.
    wheel, center, radius
        The link that rolls, its centre and size.
    on : str
        The link on which it rolls.
    line : (str, str), optional
    circle, circle_radius : str, number, optional
        Centre and size of the circle; with ``inside`` one runs inside the other.
    """

    name: str
    wheel: str
    center: str
    radius: Number
    on: str = "ground"
    line: tuple[str, str] | None = None
    circle: str | None = None
    circle_radius: Number | None = None
    inside: bool = False

    def __post_init__(self) -> None:
        as_tuples(self, "line")


@dataclass(frozen=True, kw_only=True)
class Segment:
    """A part of a cam's turn: ``over`` an angle the follower moves by ``lift``."""

    law: str
    over: Number
    lift: Number = 0


@dataclass(frozen=True, kw_only=True)
class Cam:
    """A cam that moves a follower, by the follower's motion or by the cam's own outline.

    Parameters
    ----------
    cam, center : str
        The link that turns, and the point about which it turns.
    slider : str, optional
        The slider that is moved; its first point is the knife edge, the roller's centre or on the
        flat face.
    link, pivot, point : str, optional
        Else the link that swings about ``pivot``, with the edge or the roller's centre ``point``;
        a flat face leads from the pivot to ``point``.
    contact : str
        ``knife``, ``roller`` or ``flat``.
    radius : number
        Of the roller.
    base : number, optional
        Radius of the base circle, with ``segments``.
    segments : tuple of Segment
        What the follower does in one turn, from the cam's angle ``start`` on.
    profile : tuple of (x, y), optional
        Else the cam's outline, closed, in the cam's own frame about its centre.
    """

    name: str
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

    def __post_init__(self) -> None:
        as_tuples(self, "segments", "profile")
        object.__setattr__(self, "profile", tuple(tuple(pair) for pair in self.profile))


@dataclass(frozen=True, kw_only=True)
class Curve:
    """A point that runs along a curve of a link.

    Parameters
    ----------
    name : str
        The place on the curve: an angle from 0 to a turn if it is closed, else a length.
    point, on : str
        The point of another link, and the link that carries the curve.
    origin : str
        A point of ``on``; the curve's coordinates are in that link's own frame about it.
    through : tuple of (x, y)
        Points of the curve.
    closed : bool
    """

    name: str
    point: str
    on: str
    origin: str
    through: tuple[tuple[Number, Number], ...]
    closed: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "through", tuple(tuple(pair) for pair in self.through))


def names_of(part: Gear | Belt | Rack | Rolling | Cam | Curve) -> tuple[str, ...]:
    """The name of a part and those of what it adds to results."""
    added: tuple[str, ...] = ()
    if isinstance(part, Curve):
        added = ("x", "y")
    elif isinstance(part, Cam) and part.profile:
        added = ("x", "y")
        if part.contact != "knife":
            added += ("dx", "dy", "speed")
            added += ("normal",) if part.contact == "roller" else ("way", "contact")
    return (part.name, *(f"{part.name}_{word}" for word in added))
