"""Curves, marks and ticks of charts on Matplotlib's axes, in light and dark colours.

Curves have the colours of Okabe and Ito, ordered so that neighbours differ most; the dark theme
uses lighter colours of the same hues. They are distinguishable with every kind of colour blindness.
Texts have a contrast of at least 4.5 with the page (WCAG 2.2, success criterion 1.4.3).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwork.core.drawing.paths import UNSEEN, smoothed
from linkwork.core.drawing.scene import LIGHT, Theme, text_width
from linkwork.core.foundation.arrays import Array, ComplexArray
from linkwork.core.foundation.units import AngleUnit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis, XAxis, YAxis

#: Font sizes in points: title; captions, labels and panel names; legend and ticks.
TITLE, SMALL, KEY = 11.0, 9.0, 8.5


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


def chart_theme(theme: Theme) -> ChartTheme:
    """The colours of charts that match a theme of drawings."""
    from matplotlib.colors import rgb_to_hsv, to_rgb

    return LIGHT_CHART if rgb_to_hsv(to_rgb(theme.background))[2] > 0.5 else DARK_CHART


# ----------------------------------------------------------------------
# Curves and marks.


LINE = 1.6  # points: width of a curve
_WIDER, _QUIET = 1.7, 1.0  # more per curve on top; in the background
_DOT, _STATION = 2.2, 3.2
_STATION_TEXT = 7.5
_AWAY = 5.5  # points: distance of a text from its dot
_BESIDE = 0.35  # component of a unit vector beyond which a text is placed left or right
_FLAT = 0.35  # height of a usual panel by its width
_INPUT_MARGIN = 0.01  # so that marks at the ends of the input are whole
_SHAPES = {"dead point": "o", "change point": "D", "maximum": "^", "minimum": "v"}
#: Dashes of curves with the same colour.
_DASHES: tuple[Any, ...] = ("solid", (0, (4.0, 1.6)), (0, (1.0, 1.2)), (0, (4.0, 1.4, 1.0, 1.4)))
_RULE_DASHES = {"dead point": (0, (1.0, 1.6)), "change point": (0, (5.0, 2.0, 1.0, 2.0))}


@dataclass(frozen=True, kw_only=True, eq=False)
class ChartAxes:
    """Matplotlib's axes, and the colours in which a chart is drawn in them."""

    ax: Axes
    theme: ChartTheme

    def curve(
        self,
        x: Array,
        y: Array,
        name: str,
        tone: int,
        *,
        legend: bool = True,
        below: int = 0,
        quiet: bool = False,
        dots: bool = False,
        smooth: bool = True,
    ) -> None:
        """A line through (x, y), both (K,), broken at NaN.

        Parameters
        ----------
        tone : int
            Number of its colour from 1.
        legend : bool
            Whether the legend has its name.
        below : int
            The number of later curves that cover it: it is drawn wider to be visible beside them.
        quiet : bool
            A grey background.
        dots : bool
            Separate points without connecting lines.
        smooth : bool
            Draw it with points between its rows, where it turns quickly.
        """
        theme = self.theme
        style: dict[str, Any] = {"gid": f"curve:{name}", "label": name if legend else f"_{name}"}
        if dots:
            style |= {"color": theme.tone(tone), "linestyle": "none", "markersize": _DOT}
            self.ax.plot(x, y, marker="o", **style)
            return
        if smooth:
            x, y = self._smoothed(x, y)
        finite = np.concatenate(([False], np.isfinite(x + y), [False]))
        alone = np.flatnonzero(finite[1:-1] & ~finite[:-2] & ~finite[2:])
        style |= {"marker": "o", "markersize": LINE, "markevery": alone.tolist()}
        if quiet:
            style |= {"color": theme.rule, "linewidth": _QUIET, "zorder": 1.9}
        else:
            dashes = _DASHES[(tone - 1) // len(theme.tones) % len(_DASHES)]
            width = LINE + _WIDER * below
            style |= {"color": theme.tone(tone), "linestyle": dashes, "linewidth": width}
        self.ax.plot(x, y, **style)

    def _smoothed(self, x: Array, y: Array) -> tuple[Array, Array]:
        there = np.isfinite(x + y)
        if not there.any():
            return x, y
        wide, tall = (float(np.ptp(one[there])) or 1.0 for one in (x, y))
        tall /= _FLAT
        if self.ax.get_aspect() != "auto":
            wide = tall = max(wide, _FLAT * tall)
        # powers of two, so that the rows keep their values
        wide, tall = (float(np.exp2(np.round(np.log2(one)))) for one in (wide, tall))
        path = smoothed(x / wide + 1j * y / tall, UNSEEN)
        return wide * path.real, tall * path.imag

    def marks(self, x: Array, y: Array, kind: str, tone: int) -> None:
        """Symbols of a kind: ``dead point``, ``change point``, ``maximum``, ``minimum``."""
        style: dict[str, Any] = {
            "marker": _SHAPES.get(kind, "s"),
            "linestyle": "none",
            "color": self.theme.background,
            "markeredgewidth": 1.4,
            "markersize": 5.5,
        }
        colour = self.theme.tone(tone)
        gid = kind.replace(" ", "-")
        self.ax.plot(x, y, gid=gid, zorder=5, markeredgecolor=colour, **style)
        self.ax.plot([], [], label=kind, markeredgecolor=self.theme.ink, **style)

    def stations(self, places: ComplexArray, tone: int) -> None:
        """Dots at places x + iy."""
        style: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": _STATION}
        colour = self.theme.tone(tone)
        self.ax.plot(places.real, places.imag, gid="station", zorder=5, color=colour, **style)

    def station_text(self, text: str, place: complex, away: complex) -> None:
        """A text beside a dot, in the direction ``away`` with free space."""
        x, y = away.real, away.imag
        self.ax.annotate(
            text,
            (place.real, place.imag),
            xytext=(_AWAY * x, _AWAY * y),
            textcoords="offset points",
            # left or right of a dot, align the nearer end of the text; above or below, its middle
            ha="left" if x > _BESIDE else "right" if x < -_BESIDE else "center",
            va="bottom" if y > _BESIDE else "top" if y < -_BESIDE else "center",
            fontsize=_STATION_TEXT,
            color=self.theme.faint,
            zorder=6,
            parse_math=False,
        )

    def limit_rule(self, at: float, kind: str) -> None:
        """A thin line at the input of a limit at which the curves have no value."""
        style: dict[str, Any] = {
            "color": self.theme.faint,
            "linewidth": 1.1,
            "linestyle": _RULE_DASHES.get(kind, "dashed"),
            "label": kind,
        }
        self.ax.axvline(at, gid=f"rule:{kind.replace(' ', '-')}", zorder=2, **style)

    def pole(self) -> None:
        """The point (0, 0) with grey lines through it."""
        self.ax.axhline(0.0, color=self.theme.rule, linewidth=0.9, zorder=1.5)
        self.ax.axvline(0.0, color=self.theme.rule, linewidth=0.9, zorder=1.5)
        style: dict[str, Any] = {"linestyle": "none", "color": self.theme.ink, "markersize": 8.0}
        self.ax.plot([0.0], [0.0], marker="+", gid="pole", label="pole", zorder=5, **style)

    def band(self, low: float, high: float, name: str) -> None:
        """A recommended range."""
        style: dict[str, Any] = {"facecolor": self.theme.band, "edgecolor": "none", "zorder": 0.5}
        self.ax.axhspan(low, high, gid=f"band:{name}", label=name, **style)

    def show_input(self, low: float, high: float) -> None:
        """The range of the abscissa."""
        room = _INPUT_MARGIN * (high - low)
        self.ax.set_xlim(low - room, high + room)

    def labels(self, x: str, y: str, title: str = "") -> None:
        """Names of both axes and of the panel; then the look of numbers, grid and sides."""
        ax, theme = self.ax, self.theme
        ax.set_facecolor(theme.background)
        ax.grid(color=theme.rule, linewidth=0.4)
        ax.set_axisbelow(True)
        ax.tick_params(
            length=3, width=0.6, color=theme.rule, labelcolor=theme.faint, labelsize=KEY - 0.4
        )
        for side, spine in ax.spines.items():
            spine.set(visible=side in ("left", "bottom", "polar"), color=theme.rule, linewidth=0.8)
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_formatter(_number_text(axis))
        box = ax.get_window_extent()
        faint: dict[str, Any] = {"color": theme.faint, "parse_math": False}
        ax.set_xlabel(x, fontsize=_fitting(x, box.width), **faint)
        ax.set_ylabel(y, fontsize=_fitting(y, box.height), **faint)
        if title:
            size = _fitting(title, box.width)
            ax.set_title(title, color=theme.ink, fontsize=size, loc="left", parse_math=False)


def _fitting(text: str, side: float) -> float:
    """The font size of a text along a side of axes [1/100 inch], whose layout is preliminary."""
    widest = max(text_width(line, 1.0) for line in text.split("\n"))
    return min(SMALL, 0.9 * side / max(widest, 1.0))


# ----------------------------------------------------------------------
# Ticks: angles at parts of a turn, powers of ten on logarithmic axes.


_DEGREES = (1, 2, 5, 10, 15, 30, 45, 90, 180)
_TURNS = tuple(360 * times * 10**k for k in range(9) for times in (1, 2, 5))
_MOST_TICKS = {"x": 9, "y": 6, "radius": 5}
_ROUNDING = 1e-16  # smaller residuals are drawn near zero, since they are rounding errors
_FEW_DECADES = 1e3  # ratio of the ends of a logarithmic axis with ticks between powers of ten
_LARGE = 1e5
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


def tick_step(span: float, most: int, unit: AngleUnit | None = None) -> float:
    """The distance of at most ``most`` round values in a range; parts of a turn for an angle.

    Degrees are whole and radians parts of π, unless the range is too small.
    """
    from matplotlib.ticker import MaxNLocator

    if unit is not None:
        parts = _DEGREES if unit is AngleUnit.DEGREE else _DEGREES[4:]
        degrees = 360 * span / unit.turn
        if degrees >= 2 * parts[0]:
            fitting = (part for part in (*parts, *_TURNS) if degrees < (most + 1) * part)
            return float(next(fitting) * unit.turn / 360)
    values = MaxNLocator(most, steps=[1, 2, 5, 10]).tick_values(0.0, span)
    return float(values[1] - values[0])


def round_ticks(axis: XAxis | YAxis, unit: AngleUnit | None) -> None:
    """Ticks at round values, of angles at parts of a turn, as many as there is room for."""
    from matplotlib.ticker import MultipleLocator

    low, high = axis.get_view_interval()
    step = tick_step(
        abs(high - low), min(_MOST_TICKS[axis.axis_name], max(axis.get_tick_space(), 2)), unit
    )
    axis.set_major_locator(MultipleLocator(step))
    if unit is AngleUnit.RADIAN and step > math.pi / 13:
        axis.set_major_formatter(pi_text)


def pi_text(value: float, _: object = None) -> str:
    """A multiple of π/36 in usual notation: ``0``, ``π/4``, ``3π/2``, ``−π``."""
    part = Fraction(round(value / math.pi * 36), 36)
    if not part:
        return "0"
    times = "" if abs(part.numerator) == 1 else str(abs(part.numerator))
    below = "" if part.denominator == 1 else f"/{part.denominator}"
    return f"{times}π{below}" if part > 0 else f"\u2212{times}π{below}"


def set_scale(axes: ChartAxes, side: str, scale: str) -> None:
    """Scale and ticks of one side, ``x`` or ``y``, for a kind of number.

    Parameters
    ----------
    scale : str
        ``linear``, ``log``, ``rounding`` (logarithmic down to unit roundoff, and linear to zero
        below), or ``count`` (integers from zero).
    """
    from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator

    axis: Axis = getattr(axes.ax, f"{side}axis")
    if scale == "count":
        axis.set_major_locator(MaxNLocator("auto", integer=True))
        axes.ax.set(**{f"{side}lim": (-0.05, max(1.05, 1.05 * axis.get_data_interval()[1]))})
    elif scale == "rounding":
        getattr(axes.ax, f"set_{side}scale")("symlog", linthresh=_ROUNDING, linscale=0.6)
        axes.ax.set(**{f"{side}lim": (-0.2 * _ROUNDING, None)})
    elif scale == "log":
        axes.ax.set(**{f"{side}scale": "log"})
        low, high = axis.get_data_interval()
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if high < _FEW_DECADES * low else (1,)))
    if scale != "linear":
        axis.set_minor_locator(NullLocator())


def _number_text(axis: Axis) -> Callable[[float, object], str]:
    """Plain numbers; if a number of the axis is large, all with powers of ten."""

    def text(value: float, _: object) -> str:
        large = max(map(abs, axis.get_view_interval())) >= _LARGE
        return power_text(value) if large or axis.get_scale() != "linear" else _digits(value)

    return text


def _digits(value: float) -> str:
    return f"{value:.6g}".replace("-", "\u2212")


def power_text(value: float) -> str:
    """``20``, ``10⁻¹⁴``, ``−5·10⁶``."""
    power = math.floor(math.log10(abs(value)) + 1e-9) if value else 0
    if -3 <= power < 4:
        return _digits(value)
    tail = f"10{str(power).translate(_SUPERSCRIPTS)}"
    head = _digits(value / 10.0**power)
    return head.replace("1", tail) if head in ("1", "\u22121") else f"{head}·{tail}"
