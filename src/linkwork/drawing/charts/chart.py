"""Charts as plain data: panels of curves, drawn by the writers."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

from linkwork.foundation.arrays import Array
from linkwork.foundation.frozen import read_only

__all__ = ["Axis", "Band", "Chart", "Curve", "Mark", "Panel", "Pen", "Rule", "Scale", "Shape"]


class Shape(Enum):
    """What the sides of a panel are."""

    GRAPH = auto()  # one quantity over another one
    PLANE = auto()  # both coordinates to one scale
    POLAR = auto()  # a radius over an angle


class Scale(Enum):
    """How values are spread along an axis."""

    LINEAR = auto()
    LOG = auto()
    ROUNDING = auto()  # logarithmic down to the rounding of numbers, zero below it
    COUNT = auto()  # whole numbers from zero on


class Pen(Enum):
    """How a curve is drawn."""

    LINE = auto()
    DOTS = auto()  # every value by itself: neighbours have nothing to do with each other


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """A line through (x, y), both (K,); NaN breaks it. ``tone`` counts colours from 1.

    ``below`` counts the later curves that run over it: it shows on both sides of them only if it
    is drawn wider. ``quiet`` curves are a background for the others and have no colour.
    """

    x: Array
    y: Array
    tone: int
    name: str
    below: int = 0
    quiet: bool = False
    pen: Pen = Pen.LINE

    def __post_init__(self) -> None:
        object.__setattr__(self, "x", read_only(self.x))
        object.__setattr__(self, "y", read_only(self.y))


@dataclass(frozen=True, kw_only=True)
class Mark:
    """A point of a curve: ``dead point``, ``change point``, ``maximum``, ``minimum``; or a
    ``station``, a dot with the value of the input beside it.

    ``away`` is the direction (x, y) in which there is room for ``text``.
    """

    x: float
    y: float
    tone: int
    kind: str
    text: str = ""
    away: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Rule:
    """A thin line across a panel, where ``along`` (x or y) has the value ``at``.

    ``kind`` as in :class:`Mark`; without one it is a quiet line.
    """

    along: str
    at: float
    kind: str = ""


@dataclass(frozen=True, kw_only=True)
class Band:
    """Values of y that are recommended."""

    low: float
    high: float
    name: str


@dataclass(frozen=True, kw_only=True)
class Axis:
    """What an axis is called, what it shows, and where its ticks stand.

    Without ``ends`` it shows all of its curves; with them, curves may leave it if it is no angle.
    Ticks stand at ``ticks``, or else at multiples of ``step``, or else at round numbers. ``turn``
    is a full turn in the unit of an angle, 0 if it is none.
    """

    label: str
    turn: float = 0.0
    ends: tuple[float, float] | None = None
    step: float = 0.0
    ticks: tuple[float, ...] = ()
    scale: Scale = Scale.LINEAR


@dataclass(frozen=True, kw_only=True)
class Panel:
    """Curves over the common axis, or over an axis ``across`` of their own."""

    axis: Axis
    curves: tuple[Curve, ...]
    marks: tuple[Mark, ...] = ()
    rules: tuple[Rule, ...] = ()
    bands: tuple[Band, ...] = ()
    across: Axis | None = None
    title: str = ""
    shape: Shape = Shape.GRAPH


@dataclass(frozen=True, kw_only=True)
class Chart:
    """Panels in rows of ``columns``; graphs stand over one common axis.

    ``legend`` names the curves and marks that a reader could not tell otherwise: all of them
    unless it is given.
    """

    title: str
    caption: str
    axis: Axis
    panels: tuple[Panel, ...]
    columns: int = 1
    legend: tuple[str, ...] | None = None
