"""Axis-parallel rectangles in the plane."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property
from typing import TypeVar

import numpy as np

from linkwork.core.foundation.arrays import ComplexArray, FrozenDict
from linkwork.core.foundation.errors import UnknownNameError, choices, internal

#: A point of the plane in the mechanism's length unit.
XY = tuple[float, float]


@dataclass(frozen=True)
class Box:
    """The rectangle from (left, bottom) to (right, top), in the mechanism's length unit."""

    left: float
    bottom: float
    right: float
    top: float

    @classmethod
    def around(cls, points: Iterable[XY]) -> Box:
        """The smallest box around all points, at least one."""
        xs, ys = zip(*points, strict=True)
        return cls(min(xs), min(ys), max(xs), max(ys))

    @property
    def width(self) -> float:
        return self.right - self.left

    @property
    def height(self) -> float:
        return self.top - self.bottom

    @property
    def centre(self) -> XY:
        return (self.left + self.right) / 2, (self.bottom + self.top) / 2

    @property
    def corners(self) -> tuple[XY, XY]:
        return (self.left, self.bottom), (self.right, self.top)

    @property
    def edges(self) -> tuple[float, float, float, float]:
        """Left, bottom, right, top."""
        return self.left, self.bottom, self.right, self.top

    def grown(self, by: float) -> Box:
        """The box enlarged by ``by`` on every side."""
        return Box(self.left - by, self.bottom - by, self.right + by, self.top + by)

    def sized(self, width: float, height: float) -> Box:
        """A box of another size about the same centre."""
        x, y = self.centre
        return Box(x - width / 2, y - height / 2, x + width / 2, y + height / 2)

    def with_box(self, other: Box) -> Box:
        """The smallest box around both."""
        return Box.around((*self.corners, *other.corners))

    def distance(self, point: XY) -> float:
        """The distance of a point from the box; zero inside."""
        x, y = point
        return math.hypot(
            max(self.left - x, 0.0, x - self.right), max(self.bottom - y, 0.0, y - self.top)
        )


# ----------------------------------------------------------------------
# The sizes of symbols: fractions of the drawn size, reduced if pins are close together.


#: Relative to the size of a drawing, or to its longest vector: nearer points coincide.
#: Rounding errors are much smaller, and differences below 1e-4 are not visible.
COINCIDENT = 1e-6

_PIN_OF_SIZE = 0.0115  # pin radius over drawn size: a diameter of 10 points in a six-inch figure
_SMALLEST_OF_SIZE = 0.0055  # minimum for a visible circle
_PIN_OF_GAP = 0.22  # pin radius over the distance to its nearest neighbour


@dataclass(frozen=True, kw_only=True)
class Measures:
    """Lengths of a drawing in the mechanism's length unit.

    Parameters
    ----------
    size : float
        The larger side of the drawing.
    pin : float
        The radius of a pin; other symbols are multiples of it.
    larger : float
        Enlargement of names, for small pictures; symbols grow by its square root.
    """

    size: float
    pin: float
    larger: float = 1.0

    @classmethod
    def of(cls, box: Box, gaps: Iterable[float], larger: float = 1.0) -> Measures:
        """Measures for a drawing that fills a box, with constant distances between pins.

        A mechanism with a single point counts as one unit long.
        """
        size = max(box.width, box.height) or 1.0
        # points at the same place have no gap
        shortest = min((gap for gap in gaps if gap > 1e-6 * size), default=size)
        least, most = (
            share * size * math.sqrt(larger) for share in (_SMALLEST_OF_SIZE, _PIN_OF_SIZE)
        )
        return cls(size=size, pin=min(most, max(_PIN_OF_GAP * shortest, least)), larger=larger)

    @property
    def stroke(self) -> float:
        """The width of a thin line, the unit of line widths of roles."""
        return 0.22 * self.pin

    @property
    def dot(self) -> float:
        """The radius of a point that is not a pin."""
        return 0.5 * self.pin

    @property
    def text(self) -> float:
        """The font size (one em) of names, independent of the size of pins."""
        return 0.0275 * self.larger * self.size

    @property
    def block(self) -> tuple[float, float]:
        """Half length and half height of a sliding block."""
        return 3.0 * self.pin, 1.9 * self.pin

    @property
    def slot(self) -> float:
        """Half the width of a slot: a pin radius and some clearance."""
        return 1.55 * self.pin

    @property
    def barrel(self) -> float:
        """Half the width of a cylinder."""
        return 1.7 * self.pin

    @property
    def hatch(self) -> float:
        """The depth of hatching, and the distance of its strokes along the line."""
        return 1.4 * self.pin

    @property
    def head(self) -> float:
        """The length of an arrow head."""
        return 2.2 * self.pin


# ----------------------------------------------------------------------
# A picture as plain data: primitives with roles, in the mechanism's length unit.
#
# Writers translate primitives one by one and determine only colours and file formats.


_COVERED = 0.7  # fraction of the arrow head at which its line ends, for a sharp tip


class Role(Enum):
    """The meaning of a primitive, which determines its style; later members are drawn on top."""

    FRAME = "a fixed wheel"
    FRAME_BAND = "the rim of a fixed ring"
    BAND = "the rim of a ring"
    WHEEL = "a gear, pulley, wheel, roller, cam or rack"
    PITCH = "the pitch circle of a gear, the pitch line of a rack"
    MARK = "the spoke that shows a wheel's angle"
    BELT = "a belt or chain"
    PLATE = "a link of three or more points"
    SCALE = "a step of a colour scale"
    HATCH = "the hatching of ground"
    GROUND = "ground: pivots and rails"
    TRACE = "the path of a point"
    SPEED_TRACE = "a piece of the path of a point, coloured by its speed there"
    FIXED_CENTRODE = "the path of a link's instant centre in the plane"
    MOVING_CENTRODE = "the path of a link's instant centre on the link"
    EXTENSION = "an extension line of a dimension"
    DIMENSION = "a dimension line"
    SLOT = "the slot of a pin"
    SLIDER = "a sliding block"
    CYLINDER = "the barrel of a cylinder"
    SPRING = "a spring"
    LINK = "a link drawn as a bar"
    WELD = "a rigid joint of two links"
    PIN = "a pin joint"
    POINT = "a named point without joint"
    TRACED = "a point whose path is shown"
    POSITION = "a position of a task"
    LIMIT = "a dead point or change point"
    INPUT = "the arrow of an input"
    VECTOR = "a vector of a loop equation"
    VELOCITY = "the velocity of a point"
    ACCELERATION = "the acceleration of a point"
    FORCE = "a force on a point"
    CENTRE = "an instant centre"
    LINK_NAME = "the name of a link"
    LABEL = "the name of a point"
    POSITION_NAME = "the number of a position of a task"
    LIMIT_NAME = "kind and input of a limit"
    VECTOR_NAME = "the name of a vector of a loop equation"
    LOOP_NAME = "the name of a loop equation"
    VELOCITY_NAME = "the name of a velocity"
    ACCELERATION_NAME = "the name of an acceleration"
    FORCE_NAME = "the name of a force"
    CENTRE_NAME = "the links of an instant centre"
    DIMENSION_NAME = "the number of a dimension"
    SCALE_NAME = "the legend of a colour scale"

    @property
    def layer(self) -> int:
        """The height of the role in the stack, 0 at the bottom."""
        return _LAYERS[self]


_LAYERS = {role: layer for layer, role in enumerate(Role)}


@dataclass(frozen=True, kw_only=True)
class Primitive:
    """The common fields of all primitives.

    ``of`` names the part of the mechanism. ``tone`` is the colour number of a link: 0 for driven
    links and parts without a link colour, 1, 2, … for other links. ``fade`` mixes the colours with
    the page, from 0 (not at all) to 1 (invisible), for further positions of a motion, which are
    drawn below all others. ``level`` is the position on the theme's colour scale, 0 to 1, for roles
    coloured by it.
    """

    role: Role
    of: str = ""
    tone: int = 0
    fade: float = 0.0
    level: float = 0.0

    @property
    def outline(self) -> tuple[XY, ...]:
        """Points with the bounding box of the primitive (without line widths)."""
        raise NotImplementedError

    @property
    def layer(self) -> float:
        """The height of the primitive in the stack: that of its role; faint ones are lower."""
        return self.role.layer - (len(Role) * (1.0 + self.fade) if self.fade else 0.0)


@dataclass(frozen=True, kw_only=True)
class Polyline(Primitive):
    """An open line; with ``head`` > 0 it ends in an arrow head of that length."""

    points: tuple[XY, ...]
    head: float = 0.0

    @property
    def outline(self) -> tuple[XY, ...]:
        return self.points + self.arrow_head

    @property
    def shaft(self) -> tuple[XY, ...]:
        """The drawn line; with a head it ends inside the head, not at its tip."""
        if not self.head:
            return self.points
        tip, before = complex(*self.points[-1]), complex(*self.points[-2])
        end = tip - (tip - before) / abs(tip - before) * _COVERED * self.head
        return (*self.points[:-1], xy(end))

    @property
    def arrow_head(self) -> tuple[XY, ...]:
        """The triangle of the head, its tip at the last point; empty without one."""
        return _head(self.points, self.head)


@dataclass(frozen=True, kw_only=True)
class Polygon(Primitive):
    """A closed, filled outline."""

    points: tuple[XY, ...]

    @property
    def outline(self) -> tuple[XY, ...]:
        return self.points


@dataclass(frozen=True, kw_only=True)
class Disc(Primitive):
    """A filled circle."""

    centre: XY
    radius: float

    @property
    def outline(self) -> tuple[XY, ...]:
        (x, y), r = self.centre, self.radius
        return (x - r, y - r), (x + r, y + r)

    @property
    def rim(self) -> tuple[XY, ...]:
        """The circle as a closed line of short pieces."""
        return Arc(
            role=self.role, centre=self.centre, radius=self.radius, start=0.0, sweep=math.tau
        ).points


@dataclass(frozen=True, kw_only=True)
class Arc(Primitive):
    """A circular arc from angle ``start`` over ``sweep`` [rad, positive counter-clockwise]."""

    centre: XY
    radius: float
    start: float
    sweep: float
    head: float = 0.0

    @property
    def points(self) -> tuple[XY, ...]:
        """The arc as a line of short pieces."""
        return self._pieces(self.sweep)

    @property
    def shaft(self) -> tuple[XY, ...]:
        """The drawn line; with a head it ends inside the head, not at its tip."""
        return self._pieces(
            self.sweep - math.copysign(_COVERED * self.head / self.radius, self.sweep)
        )

    def _pieces(self, sweep: float) -> tuple[XY, ...]:
        # about 6° for each piece: the deviation from the circle is about 0.1 % of the radius
        count = max(8, round(abs(sweep) / 0.1))
        (x, y), r = self.centre, self.radius
        angles = [self.start + sweep * k / count for k in range(count + 1)]
        return tuple((x + r * math.cos(a), y + r * math.sin(a)) for a in angles)

    @property
    def outline(self) -> tuple[XY, ...]:
        return self.points + self.arrow_head

    @property
    def arrow_head(self) -> tuple[XY, ...]:
        """The triangle of the head, its tip at the end of the arc; empty without one."""
        if not self.head:
            return ()
        # The head is straight; its base must lie on the arc, not on the tangent.
        back = self.start + self.sweep - math.copysign(self.head / self.radius, self.sweep)
        (x, y), r = self.centre, self.radius
        foot = (x + r * math.cos(back), y + r * math.sin(back))
        return _head((foot, self.points[-1]), self.head)


@dataclass(frozen=True, kw_only=True)
class Hatch(Primitive):
    """Parallel strokes."""

    strokes: tuple[tuple[XY, XY], ...]

    @property
    def outline(self) -> tuple[XY, ...]:
        return tuple(end for stroke in self.strokes for end in stroke)


@dataclass(frozen=True, kw_only=True)
class Text(Primitive):
    """A line of text near ``anchor``; ``height`` is the font size (one em).

    The baseline passes through ``anchor + offset``, which is the left end (``align`` = -1), the
    middle (0) or the right end (1) of the text.
    """

    text: str
    anchor: XY
    offset: XY
    height: float
    align: int = 0

    @property
    def start(self) -> XY:
        """The point of the baseline selected by ``align``."""
        return self.anchor[0] + self.offset[0], self.anchor[1] + self.offset[1]

    @property
    def box(self) -> Box:
        """The box of the printed text, slightly enlarged since fonts differ."""
        width = text_width(self.text, self.height)
        x, y = self.start
        left = x - width * (self.align + 1) / 2
        return Box(left, y - 0.16 * self.height, left + width, y + 0.76 * self.height)

    @property
    def outline(self) -> tuple[XY, ...]:
        return self.box.corners


P = TypeVar("P", bound=Primitive)


@internal("primitives", "measures", "within", "box", "select")
@dataclass(frozen=True, kw_only=True)
class Scene:
    """A finished picture.

    Parameters
    ----------
    primitives : tuple of Primitive
        Sorted bottom to top.
    measures : Measures
        The sizes of symbols and lines.
    within : Box
        The minimum extent of the picture; the same for all pictures of a motion.
    unit : str
        The length unit of every coordinate.
    title, caption : str
        The mechanism's name; the input values.

    Examples
    --------
    >>> import linkwork as lw
    >>> scene = lw.example("four-bar").scene()
    >>> scene.title, scene.unit
    ('Four-bar linkage, open', 'mm')
    """

    primitives: tuple[Primitive, ...]
    measures: Measures
    within: Box
    unit: str
    title: str = ""
    caption: str = ""

    def __post_init__(self) -> None:
        ordered = tuple(sorted(self.primitives, key=lambda primitive: primitive.layer))
        object.__setattr__(self, "primitives", ordered)

    @cached_property
    def box(self) -> Box:
        """The bounding box of ``within`` and all primitives."""
        corners = [corner for primitive in self.primitives for corner in primitive.outline]
        return Box.around([*corners, *self.within.corners])

    def select(self, kind: type[P], role: Role | None = None, of: str | None = None) -> list[P]:
        """The primitives of one kind, optionally of one role and of one part."""
        return [
            p
            for p in self.primitives
            if isinstance(p, kind) and role in (None, p.role) and of in (None, p.of)
        ]


def xy(z: complex) -> XY:
    """x + iy as a pair."""
    return float(z.real), float(z.imag)


def round_up(number: float, steps: Sequence[float]) -> float:
    """The smallest of ``steps``, from 1 up, times a power of ten that is not smaller."""
    power: float = 10.0 ** int(f"{number:e}".partition("e")[2])
    return min(k * power for k in (*steps, 10.0) if k * power >= number * (1.0 - 1e-9))


def round_down(number: float, steps: Sequence[float]) -> float:
    """The largest of ``steps``, from 1 up, times a power of ten that is not larger."""
    power: float = 10.0 ** int(f"{number:e}".partition("e")[2])
    return max(k * power for k in steps if k * power <= number * (1.0 + 1e-9))


def drawn_line(
    role: Role, of: str, points: Iterable[complex], tone: int = 0, head: float = 0.0
) -> Polyline:
    """A line through points x + iy."""
    return Polyline(role=role, of=of, tone=tone, points=tuple(map(xy, points)), head=head)


def drawn_area(role: Role, of: str, corners: Iterable[complex], tone: int = 0) -> Polygon:
    """An area with corners x + iy."""
    return Polygon(role=role, of=of, tone=tone, points=tuple(map(xy, corners)))


def drawn_disc(role: Role, of: str, centre: complex, radius: float, tone: int = 0) -> Disc:
    """A disc about x + iy."""
    return Disc(role=role, of=of, tone=tone, centre=xy(centre), radius=radius)


def drawn_arc(
    role: Role, of: str, centre: complex, radius: float, start: float, sweep: float, head: float = 0
) -> Arc:
    """An arc about x + iy."""
    return Arc(
        role=role, of=of, centre=xy(centre), radius=radius, start=start, sweep=sweep, head=head
    )


def drawn_text(
    role: Role,
    of: str,
    text: str,
    anchor: complex,
    offset: XY,
    height: float,
    tone: int = 0,
    align: int = 0,
) -> Text:
    """A text near x + iy; by default centred there."""
    return Text(
        role=role,
        of=of,
        tone=tone,
        text=text,
        anchor=xy(anchor),
        offset=offset,
        height=height,
        align=align,
    )


def text_width(text: str, height: float) -> float:
    """The printed width of a text, estimated from a table of letter widths [em]."""
    return height * sum(_letter_width(letter) for letter in text)


def _letter_width(letter: str) -> float:
    if letter in "₀₁₂₃₄₅₆₇₈₉":
        return 0.42
    if letter in "iljt.,'|!: ":
        return 0.40
    if letter in "MWmw":
        return 1.0
    return 0.78 if letter.isupper() else 0.65


def _head(points: tuple[XY, ...], length: float) -> tuple[XY, ...]:
    if not length:
        return ()
    tip, before = complex(*points[-1]), complex(*points[-2])
    along = (tip - before) / abs(tip - before) * length
    return xy(tip), xy(tip - along * (1 - 0.38j)), xy(tip - along * (1 + 0.38j))


# ----------------------------------------------------------------------
# Colours and line widths of roles, shared by all writers.
#
# Colours are those of Okabe and Ito on a light page, and similarly chosen on a dark page; they are
# distinguishable with every kind of colour blindness.
#
# References
# ----------
# M. Okabe, K. Ito, Color universal design: how to make figures and presentations that are friendly
# to colorblind people, 2002.


T = TypeVar("T")

_BLUE, _GREEN, _ORANGE = "#0072B2", "#009E73", "#E69F00"
_VERMILLION, _PURPLE, _SKY = "#D55E00", "#CC79A7", "#56B4E9"


@dataclass(frozen=True, kw_only=True)
class Style:
    """The style of a role.

    ``line`` and ``fill`` are a colour, ``tone`` (the colour of the link), ``level`` (from the
    theme's colour scale) or empty; ``width`` is in strokes
    (:attr:`linkwork.core.drawing.scene.Measures.stroke`), the lengths of ``dashes`` and their gaps
    are in line widths.
    """

    line: str = ""
    width: float = 1.0
    fill: str = ""
    opacity: float = 1.0
    dashes: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Theme:
    """Colours of a page: background, ink of text, faint ink of axes, tones of links, styles.

    ``scale`` are colours at equal steps from 0 to 1 of a quantity such as speed; their lightness is
    monotonic.
    """

    background: str
    ink: str
    faint: str
    driven: str
    tones: tuple[str, ...]
    scale: tuple[str, ...]
    styles: Mapping[Role, Style]

    def line(self, primitive: Primitive) -> str:
        """The line colour of a primitive; empty for none."""
        return self._colour(self.styles[primitive.role].line, primitive)

    def fill(self, primitive: Primitive) -> str:
        """The fill colour of a primitive; empty for none."""
        return self._colour(self.styles[primitive.role].fill, primitive)

    def _colour(self, colour: str, primitive: Primitive) -> str:
        if colour == "tone":
            tone = primitive.tone
            colour = self.tones[(tone - 1) % len(self.tones)] if tone else self.driven
        elif colour == "level":
            colour = self.at_level(primitive.level)
        # mixed with the page and opaque, so that crossings stay faint
        faded = colour and primitive.fade
        return _between(colour, self.background, primitive.fade) if faded else colour

    def at_level(self, level: float) -> str:
        """The colour of the scale at a level from 0 to 1."""
        place = min(max(level, 0.0), 1.0) * (len(self.scale) - 1)
        k = min(int(place), len(self.scale) - 2)
        return _between(self.scale[k], self.scale[k + 1], place - k)


def _between(colour: str, other: str, share: float) -> str:
    """A colour #RRGGBB interpolated to another one."""
    one, two = ([int(c[k : k + 2], 16) for k in (1, 3, 5)] for c in (colour, other))
    mixed = (round((1.0 - share) * a + share * b) for a, b in zip(one, two, strict=True))
    return "#" + "".join(f"{part:02X}" for part in mixed)


@dataclass(frozen=True, kw_only=True)
class _Inks:
    """The base colours of styles; ``page`` also hides lower parts."""

    ink: str
    grey: str
    page: str
    still: str
    block: str
    driven: str
    velocity: str
    acceleration: str
    force: str


def _styles(c: _Inks) -> FrozenDict[Role, Style]:
    """The styles of all roles: equal lines in every theme, with its colours."""
    centrode = Style(line=c.velocity, width=1.6)
    return FrozenDict.of(
        {
            Role.FRAME: Style(line=c.grey, width=1.3, fill=c.block),
            Role.FRAME_BAND: Style(fill=c.block),
            Role.BAND: Style(fill="tone", opacity=0.16),
            Role.WHEEL: Style(line="tone", width=1.5, fill="tone", opacity=0.16),
            Role.PITCH: Style(line=c.grey, width=0.7, dashes=(14.0, 4.0, 2.0, 4.0)),
            Role.MARK: Style(line="tone", width=1.5, fill="tone"),
            Role.BELT: Style(line=c.ink, width=1.8),
            Role.PLATE: Style(line="tone", width=1.9, fill="tone", opacity=0.2),
            Role.SCALE: Style(fill="level"),
            Role.HATCH: Style(line=c.grey, width=0.8),
            Role.GROUND: Style(line=c.grey, width=1.3, fill=c.still),
            Role.TRACE: Style(line=c.ink, width=1.3, fill=c.ink, dashes=(0.01, 2.2)),
            Role.SPEED_TRACE: Style(line="level", width=2.6),
            Role.FIXED_CENTRODE: centrode,
            Role.MOVING_CENTRODE: replace(centrode, line=c.acceleration, dashes=(5.0, 2.5)),
            Role.EXTENSION: Style(line=c.grey, width=0.6),
            Role.DIMENSION: Style(line=c.ink, width=0.7, fill=c.ink),
            Role.SLOT: Style(line="tone", width=1.7, fill=c.page),
            Role.SLIDER: Style(line=c.ink, width=1.3, fill=c.block),
            Role.LINK: Style(line="tone", width=2.8),
            Role.SPRING: Style(line=c.ink, width=1.2),
            Role.CYLINDER: Style(line="tone", width=1.4, fill=c.page),
            Role.WELD: Style(line=c.ink, width=1.0, fill=c.ink),
            Role.PIN: Style(line=c.ink, width=1.4, fill=c.page),
            Role.POINT: Style(fill=c.ink),
            Role.TRACED: Style(fill=c.ink),
            Role.POSITION: Style(line=c.acceleration, width=1.6),
            Role.LIMIT: Style(line=c.ink, width=2.2, fill=c.page),
            Role.INPUT: Style(line=c.driven, width=1.7, fill=c.driven),
            Role.VECTOR: Style(line="tone", width=2.0, fill="tone"),
            Role.VELOCITY: Style(line=c.velocity, width=2.0, fill=c.velocity),
            Role.ACCELERATION: Style(line=c.acceleration, width=2.0, fill=c.acceleration),
            Role.FORCE: Style(line=c.force, width=2.4, fill=c.force),
            Role.CENTRE: Style(line=c.acceleration, width=1.8),
            Role.LINK_NAME: Style(fill="tone"),
            Role.LABEL: Style(fill=c.ink),
            Role.POSITION_NAME: Style(fill=c.acceleration),
            Role.LIMIT_NAME: Style(fill=c.grey),
            Role.VECTOR_NAME: Style(fill="tone"),
            Role.LOOP_NAME: Style(fill="tone"),
            Role.VELOCITY_NAME: Style(fill=c.velocity),
            Role.ACCELERATION_NAME: Style(fill=c.acceleration),
            Role.FORCE_NAME: Style(fill=c.force),
            Role.CENTRE_NAME: Style(fill=c.acceleration),
            Role.DIMENSION_NAME: Style(fill=c.ink),
            Role.SCALE_NAME: Style(fill=c.grey),
        }
    )


LIGHT = Theme(
    background="#FFFFFF",
    ink="#1A1A1A",
    faint="#8A8A8A",
    driven=_VERMILLION,
    tones=(_BLUE, _GREEN, _PURPLE, _ORANGE, _SKY),
    scale=("#0D0660", "#5B1A8C", "#A63A86", "#E3685F", "#FBA63A"),
    styles=_styles(
        _Inks(
            ink="#1A1A1A",
            grey="#5A5A5A",
            page="#FFFFFF",
            still="#E6E6E6",
            block="#EDEDED",
            driven=_VERMILLION,
            velocity="#1F3A93",
            acceleration="#8E1B5B",
            force="#6B4E00",
        )
    ),
)

#: For dark pages: lighter hues, equally distinguishable with colour blindness.
DARK = Theme(
    background="#15191E",
    ink="#ECEFF3",
    faint="#8B95A1",
    driven="#FF803D",
    tones=("#607AEA", "#1FCB8E", "#BE6BA0", "#E4F02D", "#B2AEF9"),
    scale=("#5A3FB5", "#3F76C0", "#2FA0A0", "#6CC96A", "#F2E63C"),
    styles=_styles(
        _Inks(
            ink="#ECEFF3",
            grey="#A7B0BA",
            page="#15191E",
            still="#333B44",
            block="#2A3139",
            driven="#FF803D",
            velocity="#A9C4FF",
            acceleration="#FFA9D2",
            force="#FFD27F",
        )
    ),
)

#: Themes by name.
THEMES: Mapping[str, Theme] = FrozenDict.of({"light": LIGHT, "dark": DARK})


def theme_named(name: str, themes: Mapping[str, T]) -> T:
    """The theme with a given name, of drawings or of charts.

    Raises
    ------
    UnknownNameError
        Lists the existing names.
    """
    if name not in themes:
        raise UnknownNameError(f'there is no theme "{name}" {choices("themes", themes, name)}')
    return themes[name]


# ----------------------------------------------------------------------
# The defining points of primitives.


def corners(shape: Primitive) -> ComplexArray:
    """The defining points x + iy of a primitive, shape (m,)."""
    match shape:
        case Polyline() | Polygon():
            places = shape.points
        case Disc():
            places = (shape.centre,)
        case Arc():
            turned = shape.radius * np.exp(1j * shape.start)
            places = (shape.centre, xy(complex(*shape.centre) + turned))
        case Hatch():
            places = tuple(end for stroke in shape.strokes for end in stroke)
        case Text():
            places = (shape.anchor,)
        case _:
            raise TypeError(f"{type(shape).__name__} is not known to move")
    return np.array([complex(*place) for place in places])


def with_corners(shape: Primitive, places: ComplexArray) -> Primitive:
    """The primitive with new :func:`corners`."""
    found = tuple(map(xy, places))
    match shape:
        case Polyline() | Polygon():
            return replace(shape, points=found)
        case Disc():
            return replace(shape, centre=found[0])
        case Arc():
            start = float(np.angle(places[1] - places[0]))
            return replace(shape, centre=found[0], start=start)
        case Hatch():
            return replace(shape, strokes=tuple(zip(found[::2], found[1::2], strict=True)))
        case Text():
            return replace(shape, anchor=found[0])
        case _:
            raise TypeError(f"{type(shape).__name__} is not known to move")


def same_sizes(shapes: Iterable[Primitive], size: float) -> bool:
    """Whether radii, sweeps and heads are equal."""
    numbers = np.array([_sizes(shape) for shape in shapes])
    return bool(np.ptp(numbers, axis=0).max(initial=0.0) <= 1e-7 * size)


def _sizes(shape: Primitive) -> tuple[float, ...]:
    match shape:
        case Disc():
            return (shape.radius,)
        case Arc():
            return shape.radius, shape.sweep * shape.radius, shape.head
        case _:
            return ()
