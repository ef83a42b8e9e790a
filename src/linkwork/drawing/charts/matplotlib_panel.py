"""The translation of one panel of a chart to Matplotlib axes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwork.drawing.charts.chart import Axis, Curve, Mark, Panel, Pen, Rule, Scale, Shape
from linkwork.drawing.charts.page import SMALL
from linkwork.drawing.charts.theme import ChartTheme
from linkwork.drawing.scene import text_width
from linkwork.drawing.smooth_path import UNSEEN, smoothed
from linkwork.foundation.arrays import Array, BoolArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis as TickedAxis

__all__ = ["band_style", "curve_style", "draw_panel", "mark_style", "rule_style"]

_LINE, _WIDER = (
    1.6,
    1.7,
)  # points: width of a curve, and increase per curve on top
_QUIET = 1.0
_FLAT = 0.35  # height of a usual panel by its width
_DOT = 2.2  # points: the diameter of an isolated value
_TICK = 0.9 * SMALL
_STATION, _STATION_TEXT = 3.2, 7.5
_BESIDE = 0.35  # component of a unit vector beyond which a text is placed left or right
_ROOM = 0.33  # inches around a plane's curves, for the texts of stations
_LABEL_AT = 0.62  # inches left of a panel
_MOST_TICKS = ((4.0, 8), (1.5, 5), (0.0, 3))  # for the length of a side [inches]
_SHAPES = {"dead point": "o", "change point": "D", "maximum": "^", "minimum": "v"}
#: Dashes of curves with the same colour.
_DASHES: tuple[Any, ...] = ("solid", (0, (4.0, 1.6)), (0, (1.0, 1.2)), (0, (4.0, 1.4, 1.0, 1.4)))
_RULE_DASHES = {"dead point": (0, (1.0, 1.6)), "change point": (0, (5.0, 2.0, 1.0, 2.0))}
_LARGE = 1e5  # larger numbers are written with powers of ten
_ROUNDING = 1e-16  # smaller residuals are shown as zero
_DECADES = 3  # with more decades, ticks are at powers of ten only
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


def draw_panel(ax: Axes, panel: Panel, across: Axis, theme: ChartTheme) -> None:
    """Draw a panel into axes (polar axes for a polar panel)."""
    polar = panel.shape is Shape.POLAR
    ax.set_facecolor(theme.background)
    across = panel.across or across
    turned = math.tau / across.turn if polar else 1.0
    leaves = panel.axis.ends is not None and not panel.axis.turn
    for band in panel.bands:
        ax.axhspan(band.low, band.high, gid=f"band:{band.name}", **band_style(theme))
    for rule in panel.rules:
        _rule(ax, rule, theme)
    for curve in panel.curves:
        _curve(ax, _bent(panel, across, curve), turned, theme, leaves)
    for mark in panel.marks:
        _mark(ax, mark, turned, theme, leaves)
    _scale(ax.yaxis, panel.axis, ax.set_ylim)
    if polar:
        _polar_sides(ax, panel, across, theme)
    else:
        _scale(ax.xaxis, across, ax.set_xlim)
        _sides(ax, panel, across, theme)


def curve_style(theme: ChartTheme, tone: int, pen: Pen = Pen.LINE) -> dict[str, Any]:
    """Colour and dashes of a curve."""
    colour = theme.tone(tone)
    if pen is Pen.DOTS:
        return {"color": colour, "linestyle": "none", "marker": "o", "markersize": _DOT}
    dashes = _DASHES[(tone - 1) // len(theme.tones) % len(_DASHES)]
    return {"color": colour, "linestyle": dashes, "linewidth": _LINE}


def mark_style(theme: ChartTheme, kind: str, colour: str) -> dict[str, Any]:
    """The symbol of a kind of mark."""
    if kind == "station":
        return {"marker": "o", "linestyle": "none", "color": colour, "markersize": _STATION}
    if kind == "pole":
        return {"marker": "+", "linestyle": "none", "color": colour, "markersize": 8.0}
    return {
        "marker": _SHAPES.get(kind, "s"),
        "linestyle": "none",
        "color": theme.background,
        "markeredgecolor": colour,
        "markeredgewidth": 1.4,
        "markersize": 5.5,
    }


def rule_style(theme: ChartTheme, kind: str) -> dict[str, Any]:
    """The line of a kind of rule."""
    if not kind:
        return {"color": theme.rule, "linewidth": 0.9, "linestyle": "solid"}
    return {"color": theme.faint, "linewidth": 1.1, "linestyle": _RULE_DASHES.get(kind, "dashed")}


def band_style(theme: ChartTheme) -> dict[str, Any]:
    """The area of recommended values."""
    return {"facecolor": theme.band, "edgecolor": "none", "zorder": 0.5}


def _curve(ax: Axes, curve: Curve, turned: float, theme: ChartTheme, leaves: bool) -> None:
    """Draw a curve; isolated positions are dots."""
    style = curve_style(theme, curve.tone, curve.pen)
    if curve.quiet:
        style = {"color": theme.rule, "linestyle": "solid", "linewidth": _QUIET}
    elif curve.pen is Pen.LINE:
        style["linewidth"] += _WIDER * curve.below
    # do not clip a line along an edge, unless it leaves the panel
    place: dict[str, Any] = {"clip_on": leaves, "zorder": 2.5 if curve.quiet else 3}
    x, y = curve.x * turned, curve.y
    ax.plot(x, y, gid=f"curve:{curve.name}", **style, **place)
    alone = _alone(y)
    if curve.pen is Pen.LINE and alone.any():
        dots = {"color": style["color"], "linestyle": "none", "marker": "o", "markersize": _LINE}
        ax.plot(x[alone], y[alone], gid=f"alone:{curve.name}", **dots, **place)


def _bent(panel: Panel, across: Axis, curve: Curve) -> Curve:
    """A curve with points between its rows, where it turns quickly on linear axes."""
    x, y = curve.x, curve.y
    there = np.isfinite(x) & np.isfinite(y)
    linear = across.scale is Scale.LINEAR and panel.axis.scale is Scale.LINEAR
    if panel.shape is Shape.POLAR or not linear or not there.any():
        return curve
    wide, tall = (float(np.ptp(one[there])) or 1.0 for one in (x, y))
    tall /= _FLAT
    if panel.shape is Shape.PLANE:
        wide = tall = max(wide, _FLAT * tall)
    # powers of two, so that the rows keep their values
    wide, tall = (float(np.exp2(np.round(np.log2(one)))) for one in (wide, tall))
    path = smoothed(x / wide + 1j * y / tall, UNSEEN)
    return replace(curve, x=wide * path.real, y=tall * path.imag)


def _alone(y: Array) -> BoolArray:
    found = np.concatenate(([False], np.isfinite(y), [False]))
    alone: BoolArray = found[1:-1] & ~found[:-2] & ~found[2:]
    return alone


def _mark(ax: Axes, mark: Mark, turned: float, theme: ChartTheme, leaves: bool) -> None:
    style = mark_style(theme, mark.kind, theme.tone(mark.tone))
    gid = mark.kind.replace(" ", "-")
    ax.plot([mark.x * turned], [mark.y], gid=gid, clip_on=leaves, zorder=5, **style)
    if mark.text:
        x, y = mark.away
        ax.annotate(
            mark.text,
            (mark.x * turned, mark.y),
            xytext=(5.5 * x, 5.5 * y),
            textcoords="offset points",
            # left or right of a dot, align the nearer end of the text; above or below, its middle
            ha="left" if x > _BESIDE else "right" if x < -_BESIDE else "center",
            va="bottom" if y > _BESIDE else "top" if y < -_BESIDE else "center",
            fontsize=_STATION_TEXT,
            color=theme.faint,
            zorder=6,
            parse_math=False,
        )


def _rule(ax: Axes, rule: Rule, theme: ChartTheme) -> None:
    gid = f"rule:{rule.kind.replace(' ', '-')}" if rule.kind else "rule"
    style = {"gid": gid, "zorder": 2 if rule.kind else 1.5, **rule_style(theme, rule.kind)}
    if ax.name == "polar":
        around = np.linspace(0.0, math.tau, 181)
        ax.plot(around, np.full_like(around, rule.at), **style)
    else:
        (ax.axvline if rule.along == "x" else ax.axhline)(rule.at, **style)


def _sides(ax: Axes, panel: Panel, across: Axis, theme: ChartTheme) -> None:
    """Labels, grid and sides of a panel that is not polar."""
    if panel.shape is Shape.PLANE:
        _to_one_scale(ax, panel, across)
    _name(ax, panel, theme, pad=4.0)
    room = 0.96 * _length(ax, "y") * 72
    size = min(SMALL, room / max(text_width(panel.axis.label, 1.0), 1.0))
    ax.set_ylabel(panel.axis.label, fontsize=size, color=theme.faint, parse_math=False)
    ax.yaxis.set_label_coords(-_LABEL_AT / _length(ax, "x"), 0.5)
    ax.grid(color=theme.rule, linewidth=0.4)
    ax.set_axisbelow(True)
    ax.tick_params(length=3, width=0.6, color=theme.rule, labelcolor=theme.faint, labelsize=_TICK)
    for side, spine in ax.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(theme.rule)
        spine.set_linewidth(0.8)


def _to_one_scale(ax: Axes, panel: Panel, across: Axis) -> None:
    """Set the limits of a plane to its curves, enlarged to fill the axes."""
    wanted = []
    for axis, ticked in ((across, ax.xaxis), (panel.axis, ax.yaxis)):
        low, high = axis.ends or ticked.get_data_interval()
        wanted.append((0.5 * (low + high), 0.5 * (high - low)))
    sides = [_length(ax, name) for name in "xy"]
    room = [max(side - 2 * _ROOM, 0.5 * side) for side in sides]
    scale = max(half / side for (_, half), side in zip(wanted, room, strict=True)) or 1.0
    (x, _), (y, _) = wanted
    ax.set_xlim(x - scale * sides[0], x + scale * sides[0])
    ax.set_ylim(y - scale * sides[1], y + scale * sides[1])
    ax.set_aspect("equal", adjustable="box")


def _name(ax: Axes, panel: Panel, theme: ChartTheme, pad: float) -> None:
    if panel.title:
        place: dict[str, Any] = {"loc": "left", "pad": pad, "parse_math": False}
        widest = max(text_width(line, 1.0) for line in panel.title.split("\n"))
        size = min(SMALL, _length(ax, "x") * 72 / widest)
        ax.set_title(panel.title, fontsize=size, color=theme.ink, **place)


def _polar_sides(ax: Axes, panel: Panel, across: Axis, theme: ChartTheme) -> None:
    """Angle labels, radius labels along a ray, and the zero circle if radii may be negative."""
    places = np.arange(0.0, across.turn - 1e-9, across.step)
    text = _tick_text(across)
    ax.set_xticks([place * math.tau / across.turn for place in places])
    sign = "°" if abs(across.turn - 360.0) < 1e-9 else ""
    ax.set_xticklabels([text(place) + sign for place in places])
    ax.grid(color=theme.rule, linewidth=0.5)
    ax.set_axisbelow(True)
    ax.tick_params(colors=theme.faint, labelsize=_TICK)
    ax.spines["polar"].set_color(theme.rule)
    ax.set_rlabel_position(15.0)  # type: ignore[attr-defined]  # polar axes only
    for label in ax.get_yticklabels():
        label.set_bbox(
            {"facecolor": theme.background, "alpha": 0.75, "edgecolor": "none", "pad": 0.6}
        )
    _name(ax, panel, theme, pad=16.0)


def _scale(ticked: TickedAxis, axis: Axis, show: Callable[[float, float], Any]) -> None:
    """Set the ends and ticks of an axis."""
    from matplotlib.ticker import FixedLocator, MaxNLocator, MultipleLocator, NullLocator

    ax = ticked.axes
    ticked.set_minor_locator(NullLocator())
    name = "y" if ticked is ax.yaxis else "x"
    if axis.scale is Scale.LOG:
        _log_scale(ax, name, ticked)
        return
    if axis.scale is Scale.ROUNDING:
        _rounding_scale(ax, name, ticked)
        return
    if axis.ticks:
        ticked.set_major_locator(FixedLocator(list(axis.ticks)))
    elif axis.step:
        ticked.set_major_locator(MultipleLocator(axis.step))
    else:
        side = _length(ax, name)
        most = next(count for length, count in _MOST_TICKS if side >= length)
        whole = axis.scale is Scale.COUNT
        ticked.set_major_locator(MaxNLocator(most, steps=[1, 2, 5, 10], integer=whole))
    if axis.scale is Scale.COUNT:
        show(0.0, max(1.0, math.ceil(ticked.get_data_interval()[1] * 1.05)))
    if axis.ends is not None:
        show(*axis.ends)
    text = _tick_text(axis)
    ticked.set_major_formatter(
        lambda value, _: (_power_text if _large(ticked, axis) else text)(value)
    )


def _large(ticked: TickedAxis, axis: Axis) -> bool:
    """Whether any tick needs a power of ten; then all are written with it."""
    return not axis.turn and max(map(abs, ticked.get_view_interval())) >= _LARGE


def _length(ax: Axes, name: str) -> float:
    """The length of a side of axes [inches]."""
    page = ax.get_figure(root=True)
    assert page is not None
    box = ax.get_position()
    return float(
        box.width * page.get_figwidth() if name == "x" else box.height * page.get_figheight()
    )


def _log_scale(ax: Axes, name: str, ticked: TickedAxis) -> None:
    from matplotlib.ticker import LogLocator, NullLocator

    low, high = ticked.get_data_interval()
    ax.set(**{f"{name}scale": "log"})
    if not (low > 0 and math.isfinite(high)):
        return
    few = math.log10(high / low) < _DECADES
    # ends at ticks, for at least two ticks
    steps = (1, 2, 5) if few else (1,)
    every = [s * 10.0**k for k in range(-324 + 16, 308) for s in steps]
    first = max((v for v in every if v <= low * 1.001), default=low)
    last = min((v for v in every if v >= high * 0.999), default=high)
    if last <= first:
        first, last = first / 2, last * 2
    ax.set(**{f"{name}lim": (first, last)})
    ticked.set_major_locator(LogLocator(subs=steps, numticks=9))
    ticked.set_minor_locator(NullLocator())
    ticked.set_major_formatter(lambda value, _: _power_text(value))


def _rounding_scale(ax: Axes, name: str, ticked: TickedAxis) -> None:
    """Set a scale of decades above unit roundoff, and zero below."""
    from matplotlib.ticker import FixedLocator, NullLocator

    _, high = ticked.get_data_interval()
    top = max(math.ceil(math.log10(max(high, 10 * _ROUNDING))), -15)
    ax.set(**{f"{name}scale": "symlog"})
    options = {"linthresh": _ROUNDING, "linscale": 0.6}
    (ax.set_yscale if name == "y" else ax.set_xscale)("symlog", **options)
    every = max(1, math.ceil((top + 16) / 6))
    ticks = [0.0, *(10.0**k for k in range(-16, top + 1, every))]
    ticked.set_major_locator(FixedLocator(ticks))
    ticked.set_minor_locator(NullLocator())
    ticked.set_major_formatter(lambda value, _: _power_text(value))
    ax.set(**{f"{name}lim": (-0.1 * _ROUNDING, 10.0**top)})


def _power_text(value: float) -> str:
    """``20``, ``10⁻¹⁴``, ``−5·10⁶``."""
    if value == 0:
        return "0"
    power = math.floor(math.log10(abs(value)) + 1e-9)
    if -3 <= power < 4:
        return _plain(value)
    head = f"{value / 10.0**power:.6g}".replace("-", "\u2212")
    tail = f"10{str(power).translate(_SUPERSCRIPTS)}"
    return {"1": tail, "\u22121": f"\u2212{tail}"}.get(head, f"{head}·{tail}")


def _tick_text(axis: Axis) -> Callable[[float], str]:
    """The format of ticks: radians as fractions of π where possible."""
    stands = axis.ticks or (axis.step,)
    parts = [value / math.pi * 36 for value in stands]
    whole = all(abs(part - round(part)) < 1e-9 for part in parts) and max(parts) >= 1
    of_pi = abs(axis.turn - math.tau) < 1e-9 and whole
    return _pi_text if of_pi else _plain


def _plain(value: float) -> str:
    """``0.25``, ``−30``, ``1.5·10⁶``."""
    if value and not 1e-4 <= abs(value) < _LARGE:
        return _power_text(value)
    return f"{value:.6g}".replace("-", "\u2212")


def _pi_text(value: float) -> str:
    """A multiple of π/36 in usual notation: ``0``, ``π/4``, ``3π/2``, ``−π``."""
    part = Fraction(round(value / math.pi * 36), 36)
    if not part:
        return "0"
    times = "" if abs(part.numerator) == 1 else str(abs(part.numerator))
    below = "" if part.denominator == 1 else f"/{part.denominator}"
    return f"{times}π{below}" if part > 0 else f"\u2212{times}π{below}"
