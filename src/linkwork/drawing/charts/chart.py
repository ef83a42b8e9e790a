"""Charts as plain data: panels of curves, drawn by the writers."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, auto

from linkwork.foundation.arrays import Array
from linkwork.foundation.frozen import read_only

__all__ = ["Axis", "Band", "Chart", "Curve", "Mark", "Panel", "Pen", "Rule", "Scale", "Shape"]


class Shape(Enum):
    """The kind of a panel's axes."""

    GRAPH = auto()  # one quantity against another
    PLANE = auto()  # both coordinates with equal scale
    POLAR = auto()  # radius against angle


class Scale(Enum):
    """The scale of an axis."""

    LINEAR = auto()
    LOG = auto()
    ROUNDING = auto()  # logarithmic down to unit roundoff, linear to zero below
    COUNT = auto()  # integers from zero


class Pen(Enum):
    """The style of a curve."""

    LINE = auto()
    DOTS = auto()  # separate points without connecting lines


@dataclass(frozen=True, kw_only=True, eq=False)
class Curve:
    """A line through (x, y), both (K,), broken at NaN. ``tone`` is the colour number from 1.

    ``below`` is the number of later curves that cover it: it is drawn wider to be visible beside
    them. ``quiet`` curves are a grey background.
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
    ``station``, a dot labelled with the input value.

    ``away`` is the direction (x, y) with free space for ``text``.
    """

    x: float
    y: float
    tone: int
    kind: str
    text: str = ""
    away: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Rule:
    """A thin line across a panel at the value ``at`` of ``along`` (x or y).

    ``kind`` as in :class:`Mark`; without a kind the line is grey.
    """

    along: str
    at: float
    kind: str = ""


@dataclass(frozen=True, kw_only=True)
class Band:
    """A recommended range of y."""

    low: float
    high: float
    name: str


@dataclass(frozen=True, kw_only=True)
class Axis:
    """Label, range and ticks of an axis.

    Without ``ends`` it shows all of its curves; otherwise curves may leave it unless it is an
    angle. Ticks are at ``ticks``, otherwise at multiples of ``step``, otherwise at round numbers.
    ``turn`` is a full turn in the unit of an angle, 0 for other quantities.
    """

    label: str
    turn: float = 0.0
    ends: tuple[float, float] | None = None
    step: float = 0.0
    ticks: tuple[float, ...] = ()
    scale: Scale = Scale.LINEAR


@dataclass(frozen=True, kw_only=True)
class Panel:
    """Curves over the common axis, or over a separate axis ``across``."""

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
    """Panels in rows of ``columns``; graphs share one axis.

    ``legend`` names the curves and marks that need a legend entry; by default all.
    """

    title: str
    caption: str
    axis: Axis
    panels: tuple[Panel, ...]
    columns: int = 1
    legend: tuple[str, ...] | None = None
