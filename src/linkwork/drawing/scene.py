"""A picture as plain data: primitives with roles, in the mechanism's length unit.

Writers translate primitives one by one and determine only colours and file formats.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import TypeVar

from linkwork.drawing.box import XY, Box
from linkwork.drawing.measures import Measures
from linkwork.foundation.internal import internal

__all__ = [
    "XY",
    "Arc",
    "Box",
    "Disc",
    "Hatch",
    "Polygon",
    "Polyline",
    "Primitive",
    "Role",
    "Scene",
    "Text",
    "text_width",
    "xy",
]


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
