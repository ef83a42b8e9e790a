"""Parts in contact: welds, gears, racks, rolling wheels, belts, cams and curves."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.mechanism.parts import Number, as_tuples

__all__ = ["Belt", "Cam", "Curve", "Gear", "Rack", "Rolling", "Segment", "Weld", "names_of"]


@dataclass(frozen=True, kw_only=True)
class Weld:
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

    links: tuple[str, str]
    angle: Number | None = None

    def __post_init__(self) -> None:
        as_tuples(self, "links")


@dataclass(frozen=True, kw_only=True)
class Gear:
    """Two wheels in mesh: r1 (θ1 - θ_arm) ± r2 (θ2 - θ_arm) is constant.

    Parameters
    ----------
    name : str
        The name of the gear pair.
    wheels : (str, str)
        The two links that turn.
    centers : (str, str)
        The points about which they turn on ``arm``.
    arm : str
        The link with both centres: ground, or the carrier of a planetary gear.
    radii : (number, number), optional
        Pitch radii [length]; either these or ``teeth``.
    teeth : (number, number), optional
        Numbers of teeth; the radii follow from the distance of the centres.
    internal : bool
        Whether the larger wheel is a ring gear around the smaller one.
    phase : number, optional
        Angle of the second wheel relative to the arm where that of the first is zero [file's angle
        unit]; by default as sketched.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Gear(name="mesh", wheels=("left", "right"), centers=("O", "P"), teeth=(20, 40)).teeth
    (20, 40)
    >>> round(lw.example("geared-five-bar").solve(at=45)["right"], 6)
    -60.0
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
    """A belt or chain around two wheels: r1 (θ1 - θ_arm) ∓ r2 (θ2 - θ_arm) is constant.

    Parameters
    ----------
    name : str
        The name of the belt.
    wheels : (str, str)
        The two links that turn.
    centers : (str, str)
        The points about which they turn on ``arm``.
    arm : str
        The link with both centres.
    radii : (number, number), optional
        Pitch radii [length]; either these or ``teeth``.
    teeth : (number, number), optional
        Numbers of teeth.
    crossed : bool
        Whether the belt crosses itself, so that the wheels turn in opposite directions.
    phase : number, optional
        Angle of the second wheel relative to the arm where that of the first is zero [file's angle
        unit]; by default as sketched.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Belt(name="b", wheels=("m", "p"), centers=("M", "O"), radii=(25, 50)).crossed
    False
    >>> round(lw.example("belt-drive").solve(at=90)["pulley"], 6)
    45.0
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
    """A rack and pinion: the displacement of a slider is the rolled arc of the pinion.

    The sketch decides on which side of the rack the pinion is.

    Parameters
    ----------
    name : str
        The name of the rack and pinion.
    pinion : str
        The link that turns.
    center : str
        The point about which it turns, on the link along which the rack slides.
    slider : str
        The name of the slider of the rack.
    radius : number
        Pitch radius of the pinion [length].

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.Rack(name="mesh", pinion="pinion", center="G", slider="s", radius=20).slider
    's'
    >>> motion = lw.example("rack-and-pinion").sweep(start=90, stop=180, step=90)
    >>> turn = motion["pinion"][0] - motion["pinion"][1]
    >>> stroke = motion["s"][0] - motion["s"][1]
    >>> round(float(abs(stroke / turn)) * 180 / 3.141592653589793, 6)
    20.0
    """

    name: str
    pinion: str
    center: str
    slider: str
    radius: Number


@dataclass(frozen=True, kw_only=True)
class Rolling:
    """A wheel that rolls without slipping on a line or on a circle of another link.

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


@dataclass(frozen=True, kw_only=True)
class Cam:
    """A cam with its follower, given by the motion of the follower or by the outline of the cam.

    Parameters
    ----------
    name : str
        The name of the cam.
    cam, center : str
        The link that turns, and the point about which it turns.
    slider : str, optional
        A translating follower: the slider that moves. Its first point is the knife edge, the centre
        of the roller, or on the flat face.
    link, pivot, point : str, optional
        An oscillating follower: the link, the point about which it turns, and its knife edge or the
        centre of its roller; a flat face runs from the pivot to ``point``.
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
    """A point that moves along a curve of another link.

    Parameters
    ----------
    name : str
        The place on the curve: an angle from 0 to a full turn if the curve is closed, otherwise a
        length.
    point : str
        The point that moves, of another link.
    on : str
        The link with the curve.
    origin : str
        A point of that link; the coordinates of the curve are relative to it in the link's own
        frame.
    through : tuple of (x, y)
        Points of the curve [length]; a spline runs through them.
    closed : bool
        Whether the curve returns to its first point.

    Examples
    --------
    >>> import linkwork as lw
    >>> path = [(80, 0), (57, 57), (0, 80)]
    >>> lw.Curve(name="slot", point="B", on="ground", origin="O4", through=path).through[1]
    (57, 57)
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
