"""Light and dark colours of charts, based on those of drawings.

Curves have the colours of Okabe and Ito, ordered so that neighbours differ most; the dark theme
uses lighter colours of the same hues. They are distinguishable with every kind of colour blindness.
Texts have a contrast of at least 4.5 with the page (WCAG 2.2, success criterion 1.4.3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import Enum, auto
from itertools import pairwise

import numpy as np

from linkwork.core.drawing.pose import printed_name
from linkwork.core.drawing.scene import LIGHT, Theme
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.containers import read_only
from linkwork.core.foundation.names import pretty
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.results.quantity import Rate


@dataclass(frozen=True, kw_only=True)
class ChartTheme:
    """Colours #RRGGBB of a chart.

    Parameters
    ----------
    background : str
    ink, faint : str
        Colour of the title; of labels, ticks and captions.
    rule : str
        Sides of panels, grid and background curves.
    band : str
        Recommended ranges.
    tones : tuple of str
        Curves, by tone.
    """

    background: str
    ink: str
    faint: str
    rule: str
    band: str
    tones: tuple[str, ...]

    def tone(self, number: int) -> str:
        """The colour of a tone; 0 is the ink."""
        return self.tones[(number - 1) % len(self.tones)] if number else self.ink

    @classmethod
    def of(cls, theme: Theme | ChartTheme) -> ChartTheme:
        """The chart colours that match a theme of drawings."""
        if isinstance(theme, ChartTheme):
            return theme
        return LIGHT_CHART if _luminous(theme.background) else DARK_CHART


def _luminous(colour: str) -> bool:
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    return 0.299 * red + 0.587 * green + 0.114 * blue > 127


LIGHT_CHART = ChartTheme(
    background=LIGHT.background,
    ink=LIGHT.ink,
    faint="#5F6368",
    rule="#C4C7CC",
    band="#DDF1EA",
    tones=("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"),
)

DARK_CHART = ChartTheme(
    background="#15191E",
    ink="#F2F3F5",
    faint="#A9AFB8",
    rule="#474C55",
    band="#173A31",
    tones=("#4FB0F2", "#FF8B42", "#2CCB9B", "#E79AC6", "#F5C043", "#A5DBFF"),
)

#: Themes by name.
THEMES = {"light": LIGHT_CHART, "dark": DARK_CHART}


# ----------------------------------------------------------------------
# Labels of columns in figures: ``θ₁₃ [deg]``, ``ds₁₆/dθ₁₂ [mm/rad]``.


_BY_TIME = {rate: rate.value for rate in Rate if rate.by_time}


def printed_unit(unit: str) -> str:
    """A unit as printed: ``mm/rad^2`` → ``mm/rad²``."""
    return unit.replace("^2", "²").replace("^3", "³").replace("^4", "⁴")


def with_unit(text: str, unit: str) -> str:
    """``ds₁₆/dθ₁₂ [mm/rad]``; without brackets if there is no unit."""
    return f"{text} [{printed_unit(unit)}]" if unit.replace("^2", "") not in ("", "1/1") else text


def axis_label(name: str, unit: str) -> str:
    """The axis label of a quantity: ``θ₁₃ [deg]``."""
    return with_unit(printed_name(name), unit)


def rate_label(name: str, rate: Rate, driver: str) -> str:
    """A rate of a quantity: ``ds₁₆/dθ₁₂``, ``velocity of s₁₆``; ``driver`` is the input."""
    if rate.by_time:
        return f"{_BY_TIME[rate]} of {printed_name(name)}"
    power = "" if rate.order == 1 else "²"
    return f"d{power}{_term(name)}/d{_term(driver)}{power}"


def size_label(point: str, rate: Rate, driver: str) -> str:
    """The magnitude of a point's rate: ``|velocity of B|``."""
    return f"|{rate_label(point, rate, driver)}|"


def _term(name: str) -> str:
    """A name after the d of a derivative; words are separated by a space."""
    stem = pretty(name).partition(".")[0].rstrip("0123456789'")
    return printed_name(name) if len(stem) == 1 else f" {printed_name(name)}"


# ----------------------------------------------------------------------
# Charts as plain data: panels of curves, drawn by the writers.


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


# ----------------------------------------------------------------------
# Ranges and ticks of axes: angles at fractions of a turn, lengths at round numbers; rounding
# errors are not magnified.


_FINE = tuple(d * 10.0**k for k in range(-6, 0) for d in (1, 2, 5))
_DEGREES = (*_FINE, 1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0)
_RADIANS = (*_FINE[:-1], *(math.pi / part for part in (12, 6, 4, 2)))
_TURNS = (0.5, *(d * 10.0**k for k in range(9) for d in (1, 2, 5)))
_MOST_STEPS = 5
_MOST_ACROSS = 9
_FREE = 0.1  # of a step: a nearer curve runs along an edge,
_ALONG = 0.1  # if at least this share does, and looks like the edge

_TAIL = 0.1  # of the input's range, excluded at either end of the values of unbounded curves
_LEVEL = 1e-9  # of its size: maximum variation of a constant quantity
_LEVEL_ROOM = 0.1  # of its size: range shown above and below a constant


def _steps(unit: AngleUnit) -> tuple[float, ...]:
    own = _DEGREES if unit is AngleUnit.DEGREE else _RADIANS
    return (*own, *(times * unit.turn for times in _TURNS))


def angle_ends(values: Array, unit: AngleUnit) -> tuple[tuple[float, float], float]:
    """The ends of an axis of angles (which may include NaN), and the distance of its ticks.

    Both are multiples of a round fraction of a turn; a constant angle gets a margin of a degree or
    0.05 rad on either side.
    """
    least, most = float(np.nanmin(values)), float(np.nanmax(values))
    smallest = 0.0
    if most - least <= _LEVEL * unit.turn:
        smallest = 1.0 if unit is AngleUnit.DEGREE else 0.05
        least = most = 0.5 * (least + most)
    found = values[np.isfinite(values)]
    for step in _steps(unit):
        if step < smallest:
            continue
        first, last = math.floor(least / step), math.ceil(most / step)
        first -= _along(found / step - first)
        last += _along(last - found / step)
        if last - first <= _MOST_STEPS:
            return (first * step, last * step), step
    return (least, most), 0.0


def _along(away: Array) -> int:
    """An additional step if a curve runs along an edge; ``away`` [steps] are its distances."""
    return int(float((away < _FREE).mean()) > _ALONG)


def across_step(span: float, unit: AngleUnit) -> float:
    """The distance of ticks along an axis of angles."""
    return next((step for step in _steps(unit) if span <= _MOST_ACROSS * step), 0.0)


def round_step(wanted: float) -> float:
    """``wanted`` rounded up to 1, 2 or 5 times a power of ten."""
    power: float = 10.0 ** math.floor(math.log10(wanted))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= wanted)


def level_ends(values: Array, size: float) -> tuple[float, float] | None:
    """The axis range of a quantity that is constant up to rounding; ``None`` if it varies.

    Parameters
    ----------
    values : array
        May include NaN.
    size : float
        The typical size of the quantity; rounding is a small fraction of it.
    """
    least, most = float(np.nanmin(values)), float(np.nanmax(values))
    size = max(size, abs(least), abs(most))
    if most - least > _LEVEL * size:
        return None
    middle = 0.5 * (least + most)
    if abs(middle) <= _LEVEL * size:
        middle = 0.0
    room = _LEVEL_ROOM * (abs(middle) or size)
    return middle - room, middle + room


def finite_ends(curves: Sequence[Curve]) -> tuple[float, float] | None:
    """The axis range of unbounded curves: twice that over most of the input's range."""
    y = np.concatenate([0.5 * (curve.y[1:] + curve.y[:-1]) for curve in curves])
    share = np.concatenate([np.abs(np.diff(curve.x)) for curve in curves])
    order = np.argsort(y)[: int(np.isfinite(y * share).sum())]
    passed = np.cumsum(share[order])
    if not passed.size or not passed[-1]:
        return None
    low, high = np.interp([_TAIL, 1 - _TAIL], passed / passed[-1], y[order])
    room = 0.5 * (high - low)
    return (float(low - room), float(high + room)) if room else None


# ----------------------------------------------------------------------
# Angles reduced to one turn: lines leave at one edge of the panel and continue at the other.


#: In turns: tolerance of whole turns.
ROUNDING = 1e-9

_ORIGINS = (0.0, -0.5, -0.25, -0.75)  # in turns: possible starts of the turn shown


def rounded(values: Array, turn: float) -> Array:
    """Values (K,) rounded to quarter turns if very near, so that rounding does not break a line."""
    if not turn:
        return values
    quarter = turn / 4
    whole = np.round(values / quarter) * quarter
    return np.where(np.abs(values - whole) < ROUNDING * turn, whole, values)


def origin(lines: Sequence[Array], turn: float) -> float:
    """The start of the turn that cuts the fewest lines of angles; 0 if no other cuts fewer.

    Among equal ones, that with the fewest positions on its edges.
    """
    if not turn:
        return 0.0
    return turn * min(
        _ORIGINS, key=lambda low: _cuts([np.round(line / turn - low, 9) for line in lines])
    )


def _cuts(lines: Sequence[Array]) -> tuple[int, int]:
    """Numbers of crossings of whole turns by lines of angles [turns], and of positions there."""
    ends = [(np.minimum(y[:-1], y[1:]), np.maximum(y[:-1], y[1:])) for y in lines]
    passed = sum(int(np.maximum(np.ceil(b) - np.floor(a) - 1, 0).sum()) for a, b in ends)
    return passed, sum(int((y == np.round(y)).sum()) for y in lines)


def turn_axis(axis: Axis, lines: Sequence[Array], low: float, unit: AngleUnit) -> Axis:
    """The axis over the turn from ``low``, or less if all angles lie within half of it."""
    turn = unit.turn
    values = np.concatenate(lines)
    if np.nanmax(values) - np.nanmin(values) <= turn / 2:
        ends, step = angle_ends(values, unit)
        return replace(axis, ends=ends, step=step)
    return replace(axis, ends=(low, low + turn), step=turn / 4)


@dataclass(frozen=True, kw_only=True)
class Window:
    """The shown turn of both coordinates, 0 for one that is not an angle; y begins at ``low``."""

    x_turn: float
    y_turn: float
    low: float

    def folded(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Both coordinates inside the turn; the line continues at the other side of the panel."""
        x_turn, y_turn = self.x_turn, self.y_turn
        y = rounded(y - self.low, y_turn)
        cuts = [(x[0], y[0])] if len(x) else []
        for k in range(len(x) - 1):
            places = {1.0}
            for here, there, turn in ((x[k], x[k + 1], x_turn), (y[k], y[k + 1], y_turn)):
                if turn:
                    low, high = sorted((here / turn, there / turn))
                    edges = np.arange(np.floor(low) + 1.0, np.ceil(high))
                    places |= {float((e * turn - here) / (there - here)) for e in edges}
            cuts += [
                (x[k] + s * (x[k + 1] - x[k]), y[k] + s * (y[k + 1] - y[k])) for s in sorted(places)
            ]
        pieces: list[tuple[float, float]] = []
        last: tuple[float, float] | None = None
        for (x0, y0), (x1, y1) in pairwise(cuts):
            shift_x = x_turn * np.floor(0.5 * (x0 + x1) / x_turn) if x_turn else 0.0
            shift_y = y_turn * np.floor(0.5 * (y0 + y1) / y_turn) if y_turn else 0.0
            start = (float(x0 - shift_x), float(y0 - shift_y))
            if last is None or max(abs(start[0] - last[0]), abs(start[1] - last[1])) > 1e-9:
                pieces += [(np.nan, np.nan), start] if last is not None else [start]
            last = (float(x1 - shift_x), float(y1 - shift_y))
            pieces.append(last)
        line = np.array(pieces).reshape(-1, 2)
        return line[:, 0], line[:, 1] + self.low

    def places(self, x: float, y: float) -> list[tuple[float, float]]:
        """The positions of a point in the panel: whole turns are at both edges."""
        return [
            (at_x, at_y + self.low)
            for at_x in _edges(x, self.x_turn)
            for at_y in _edges(y - self.low, self.y_turn)
        ]

    def tolerance(self, line: Array) -> Array:
        """The distance below which a point equals a point of a line (K, 2) up to rounding."""
        reach = np.array([self.x_turn, self.y_turn])
        size = np.maximum(1.0, np.nanmax(np.abs(line), 0))
        near: Array = ROUNDING * np.where(reach > 0.0, reach, size)
        return near

    def shown_on(self, line: Array, x: float, y: float) -> list[tuple[float, float]]:
        """The positions of a point that are points of a folded line (K, 2)."""
        near = self.tolerance(line)
        places = self.places(x, y)
        return [place for place in places if (np.abs(line - place) < near).all(axis=1).any()]


def _edges(value: float, turn: float) -> tuple[float, ...]:
    """The positions of a value inside one turn: a whole turn is at both edges."""
    if not turn:
        return (value,)
    folded = float(np.mod(rounded(np.array(value), turn), turn))
    return (folded,) if folded else (0.0, turn)
