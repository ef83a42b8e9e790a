"""Layout of the parts of a chart on a page [inches], without overlap."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from linkwork.circuits.results import Circuits
from linkwork.core.drawing.matplotlib_settings import house_settings
from linkwork.core.drawing.paths import UNSEEN, smoothed
from linkwork.core.drawing.pose import lines_within
from linkwork.core.drawing.scene import Theme, text_width, theme_named
from linkwork.core.foundation.arrays import Array, BoolArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.results.motion import Motion
from linkwork.writers.charts.chart import (
    THEMES,
    Axis,
    Chart,
    ChartTheme,
    Curve,
    Mark,
    Panel,
    Pen,
    Rule,
    Scale,
    Shape,
)
from linkwork.writers.charts.plotting import PlotKind, circuits_plot, motion_plot

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis as TickedAxis
    from matplotlib.figure import Figure

#: Font sizes in points: title; captions, labels and panel names; legend.
TITLE, SMALL, KEY = 11.0, 9.0, 8.5

_WIDTH = 6.95
_LEFT, _RIGHT, _ABOVE, _BELOW = 0.85, 0.25, 0.17, 0.6
_GAP, _PAGE_BESIDE = 0.22, 0.3  # between panels with a common axis
_PAGE_LINE, _NAME = 0.19, 0.15  # heights of a title and of a panel name
_LEGEND_LINE, _HANDLE = 0.2, 0.4
_HEIGHTS = (3.4, 2.4, 1.9)  # height of a full-width graph: alone, of two, of more
_CELL = 0.75  # height-to-width ratio of graphs side by side
_PLANE = 4.6  # the longer side of a single plane or polar panel
_FLATTEST, _TALLEST = 0.4, 1.15  # height-to-width ratio of a plane
_LOWEST = 1.7  # minimum height of a plane, for its label
_RIM = 0.3  # margin of a polar panel, for angle labels


@dataclass(frozen=True, kw_only=True)
class Page:
    """The layout of a page.

    Parameters
    ----------
    heading : tuple of (str, float)
        Lines of the title and of the caption with the height of their middles; the first
        ``titles`` belong to the title.
    legend : tuple of (float, float)
        Left end and upper edge of every legend entry.
    panels : tuple of (float, float, float, float)
        Left, bottom, width, height of every panel.
    left : float
        Left end of the headings.
    """

    width: float
    height: float
    heading: tuple[tuple[str, float], ...]
    titles: int
    legend: tuple[tuple[float, float], ...]
    panels: tuple[tuple[float, float, float, float], ...]
    left: float = _LEFT


def page_of(chart: Chart, legend: Sequence[str], ratio: float = 1.0) -> Page:
    """The layout of a chart.

    Parameters
    ----------
    legend : sequence of str
        The texts of the legend's entries.
    ratio : float
        Height-to-width ratio of the area shown by planes.
    """
    room = _WIDTH - _LEFT - _RIGHT
    titles = lines_within(chart.title, room * 72 / TITLE)
    lines = [*titles, *lines_within(chart.caption, room * 72 / SMALL)]
    entries = _page_legend(legend)
    rows = 1 + max((row for _, row in entries), default=-1)
    top = _ABOVE + _PAGE_LINE * len(lines)
    above = top + _LEGEND_LINE * rows + _GAP / 2
    cells, below = _cells(chart, ratio)
    height = above + below + _BELOW
    return Page(
        width=_WIDTH,
        height=height,
        heading=tuple(
            (line, height - _ABOVE - (k + 0.5) * _PAGE_LINE) for k, line in enumerate(lines)
        ),
        titles=len(titles),
        legend=tuple((left, height - top - row * _LEGEND_LINE) for left, row in entries),
        panels=tuple((x, height - above - y - tall, wide, tall) for x, y, wide, tall in cells),
    )


def _page_legend(texts: Sequence[str]) -> list[tuple[float, int]]:
    """Left end and row of every entry, with as many entries in a row as fit."""
    found: list[tuple[float, int]] = []
    left, row = math.inf, -1
    for text in texts:
        width = _HANDLE + text_width(text, KEY) / 72
        if left + width > _WIDTH:
            left, row = _LEFT, row + 1
        found.append((left, row))
        left += width
    return found


def _cells(chart: Chart, ratio: float) -> tuple[list[tuple[float, float, float, float]], float]:
    """Left, distance from the top, width and height of every panel; and the total height."""
    count, columns = len(chart.panels), chart.columns
    room = _WIDTH - _LEFT - _RIGHT
    shape = chart.panels[0].shape
    between = {Shape.GRAPH: _PAGE_BESIDE, Shape.PLANE: _LEFT, Shape.POLAR: 3 * _RIM}[shape]
    wide = (room - (columns - 1) * between) / columns
    if shape is Shape.GRAPH:
        tall = _CELL * wide if columns > 1 else _HEIGHTS[min(count, len(_HEIGHTS)) - 1]
    else:
        wide = min(wide, _PLANE)
        flattest = max(_FLATTEST, _LOWEST / wide)
        ratio = min(max(ratio, flattest), _TALLEST) if shape is Shape.PLANE else 1.0
        tall = wide * ratio
    rows = math.ceil(count / columns)
    names = max(len(panel.title.split("\n")) if panel.title else 0 for panel in chart.panels)
    first = (_NAME * names + 0.09 if names else 0.0) + (_RIM if shape is Shape.POLAR else 0.0)
    step = tall + (_GAP if shape is Shape.GRAPH else _BELOW) + first
    inset = (room - wide) / 2 if shape is Shape.POLAR and columns == 1 else 0.0
    cells = [
        (
            _LEFT + inset + (k % columns) * (wide + between),
            first + (k // columns) * step,
            wide,
            tall,
        )
        for k in range(count)
    ]
    return cells, rows * step - (step - first - tall)


# ----------------------------------------------------------------------
# The translation of one panel of a chart to Matplotlib axes.


_MATPLOTLIB_PANEL_LINE, _WIDER = (
    1.6,
    1.7,
)  # points: width of a curve, and increase per curve on top
_QUIET = 1.0
_FLAT = 0.35  # height of a usual panel by its width
_DOT = 2.2  # points: the diameter of an isolated value
_TICK = 0.9 * SMALL
_STATION, _STATION_TEXT = 3.2, 7.5
_MATPLOTLIB_PANEL_BESIDE = (
    0.35  # component of a unit vector beyond which a text is placed left or right
)
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
    return {"color": colour, "linestyle": dashes, "linewidth": _MATPLOTLIB_PANEL_LINE}


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
        dots = {
            "color": style["color"],
            "linestyle": "none",
            "marker": "o",
            "markersize": _MATPLOTLIB_PANEL_LINE,
        }
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
            ha="left"
            if x > _MATPLOTLIB_PANEL_BESIDE
            else "right"
            if x < -_MATPLOTLIB_PANEL_BESIDE
            else "center",
            va="bottom"
            if y > _MATPLOTLIB_PANEL_BESIDE
            else "top"
            if y < -_MATPLOTLIB_PANEL_BESIDE
            else "center",
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


# ----------------------------------------------------------------------
# Charts as Matplotlib figures.


def chart_figure(chart: Chart, theme: Theme | ChartTheme) -> Figure:
    """A chart as a new figure."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure()
    FigureCanvasAgg(figure)
    draw_page(figure, chart, ChartTheme.of(theme))
    return figure


def draw_page(figure: Figure, chart: Chart, theme: ChartTheme) -> list[Axes]:
    """Draw a chart on an empty figure and set its size; returns the axes of the panels."""
    entries = legend_entries(chart, theme)
    page = page_of(chart, [entry.get_label() for entry in entries], _ratio(chart))
    figure.set_size_inches(page.width, page.height)
    figure.set_facecolor(theme.background)
    for k, (line, height) in enumerate(page.heading):
        size, colour = (TITLE, theme.ink) if k < page.titles else (SMALL, theme.faint)
        place = (page.left / page.width, height / page.height)
        figure.text(*place, line, fontsize=size, color=colour, va="center", parse_math=False)
    for entry, place in zip(entries, page.legend, strict=True):
        _matplotlib_page_legend(figure, entry, page, place, theme)
    return [_panel(figure, chart, k, page, theme) for k in range(len(chart.panels))]


def _panel(figure: Figure, chart: Chart, k: int, page: Page, theme: ChartTheme) -> Axes:
    panel = chart.panels[k]
    x, y, wide, tall = page.panels[k]
    ax = figure.add_axes(
        (x / page.width, y / page.height, wide / page.width, tall / page.height),
        gid=f"panel:{k + 1}",
        projection="polar" if panel.shape is Shape.POLAR else None,
    )
    draw_panel(ax, panel, chart.axis, theme)
    if panel.shape is Shape.POLAR:
        return ax
    if panel.across is not None or k + chart.columns >= len(chart.panels):
        label = (panel.across or chart.axis).label
        ax.set_xlabel(label, fontsize=SMALL, color=theme.faint, parse_math=False)
    else:
        ax.tick_params(labelbottom=False)
    if panel.shape is Shape.GRAPH and k % chart.columns:
        ax.tick_params(labelleft=False)
        ax.set_ylabel("")
    return ax


def _ratio(chart: Chart) -> float:
    """The largest height-to-width ratio of the areas shown by planes."""
    ratios = []
    for panel in chart.panels:
        sides = []
        for along in ("x", "y"):
            values = [getattr(part, along) for part in (*panel.marks, *panel.rules[:0])]
            values += [v for c in panel.curves for v in getattr(c, along)[np.isfinite(c.x + c.y)]]
            sides.append(max(values, default=1.0) - min(values, default=0.0))
        ratios.append(sides[1] / sides[0] if sides[0] else 1.0)
    return max(ratios)


def legend_entries(chart: Chart, theme: ChartTheme) -> list[Any]:
    """Curves by colour and dashes, marks by shape, bands: handles of the legend."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    curves = [curve for panel in chart.panels for curve in panel.curves if not curve.quiet]
    names = {curve.name: (curve.tone, curve.pen) for curve in curves}
    marks = dict.fromkeys(mark.kind for panel in chart.panels for mark in panel.marks)
    rules = dict.fromkeys(rule.kind for panel in chart.panels for rule in panel.rules)
    bands = dict.fromkeys(band.name for panel in chart.panels for band in panel.bands)
    entries = [
        *(
            Line2D([], [], label=name, **curve_style(theme, tone, pen))
            for name, (tone, pen) in names.items()
        ),
        *(
            Line2D([], [], label=kind, **mark_style(theme, kind, theme.ink))
            for kind in marks
            if kind != "station"
        ),
        *(
            Line2D([], [], label=kind, **rule_style(theme, kind))
            for kind in rules
            if kind and kind not in marks
        ),
        *(Patch(label=name, **band_style(theme)) for name in bands),
    ]
    return [e for e in entries if chart.legend is None or e.get_label() in chart.legend]


def _matplotlib_page_legend(
    figure: Figure, entry: Any, page: Page, place: tuple[float, float], theme: ChartTheme
) -> None:
    """One legend entry with its upper left corner at ``place`` [inches]."""
    figure.legend(
        handles=[entry],
        loc="upper left",
        bbox_to_anchor=(place[0] / page.width, place[1] / page.height),
        frameon=False,
        fontsize=KEY,
        labelcolor=theme.faint,
        borderaxespad=0.0,
        borderpad=0.0,
        handlelength=1.6,
    )


# ----------------------------------------------------------------------
# Charts for notebooks and scripts, in new figures or in existing axes.
#
# This module implements ``motion.plot`` and ``circuits.plot``. New figures belong to pyplot, so
# that notebooks and ``matplotlib.pyplot.show`` display them.


if TYPE_CHECKING:
    from matplotlib.axes import Axes

    PlotAxes = Axes | tuple[Axes, ...]


_COLUMNS = 4  # columns of a legend in existing axes
_ROW = 1.7  # height of a legend row, in font sizes


def plot_motion(
    motion: Motion,
    *names: str,
    kind: str = PlotKind.CURVES.value,
    against: str = "",
    wrapped: bool = False,
    ax: Any = None,
    theme: str = "light",
    title: str | None = None,
) -> PlotAxes:
    """Plot a motion; see :meth:`linkwork.core.results.motion.Motion.plot`."""
    chart = motion_plot(motion, names, kind=kind, against=against, wrapped=wrapped)
    return plot_chart(chart, ax=ax, theme=theme, title=title)


def plot_circuits(
    circuits: Circuits,
    *names: str,
    kind: str = PlotKind.CIRCUITS.value,
    ax: Any = None,
    theme: str = "light",
    title: str | None = None,
) -> PlotAxes:
    """Plot circuits; see :meth:`linkwork.circuits.results.Circuits.plot`."""
    chart = circuits_plot(circuits, names, kind=kind)
    return plot_chart(chart, ax=ax, theme=theme, title=title)


def plot_chart(
    chart: Chart, *, ax: Any = None, theme: str = "light", title: str | None = None
) -> PlotAxes:
    """Draw a chart into a new figure, or its panels into existing axes.

    Returns
    -------
    Axes or tuple of Axes
        One for each panel; a single Axes for a chart with one panel.

    Raises
    ------
    InputError
        If the number of axes differs from that of panels, or a polar panel needs polar axes.
    MissingPackageError
        If Matplotlib is not installed.
    """
    colours = theme_named(theme, THEMES)
    if title is not None:
        chart = replace(chart, title=title, caption=chart.caption if title else "")
    if ax is None:
        with house_settings():
            from matplotlib import pyplot

            drawn = draw_page(pyplot.figure(), chart, colours)
    else:
        drawn = _given(ax, chart)
        for panel_ax, panel in zip(drawn, chart.panels, strict=True):
            draw_panel(panel_ax, panel, chart.axis, colours)
        _label(drawn, chart, colours)
    return drawn[0] if len(drawn) == 1 else tuple(drawn)


def _given(ax: Any, chart: Chart) -> list[Axes]:
    """The caller's axes, one for each panel."""
    given = [ax] if hasattr(ax, "plot") else list(getattr(ax, "flat", ax))
    if len(given) != len(chart.panels):
        labels = ", ".join(panel.axis.label for panel in chart.panels)
        raise InputError(
            f"the plot has {len(chart.panels)} panels ({labels}), but there are {len(given)} axes: "
            "give one for each, or fewer columns"
        )
    for each, panel in zip(given, chart.panels, strict=True):
        polar = panel.shape is Shape.POLAR
        if polar and each.name != "polar":
            raise InputError('this plot needs polar axes: plt.subplot(projection="polar")')
        if not polar and each.name == "polar":
            raise InputError("this plot needs axes that are not polar: plt.subplot()")
    return given


def _label(drawn: Sequence[Axes], chart: Chart, theme: ChartTheme) -> None:
    """Add title, legend and lower labels; the legend is above the first panel."""
    entries = legend_entries(chart, theme)
    rows = -(-len(entries) // _COLUMNS)
    first = drawn[0]
    polar = chart.panels[0].shape is Shape.POLAR
    if entries:
        first.legend(
            handles=entries,
            loc="lower left",
            bbox_to_anchor=(0.0, 1.1 if polar else 1.0),
            ncols=_COLUMNS,
            frameon=False,
            fontsize=KEY,
            labelcolor=theme.faint,
            borderaxespad=0.2,
            handlelength=1.6,
        )
    pad = 6.0 + rows * _ROW * KEY + (16.0 if polar else 0.0)
    named = "\n".join(filter(None, (chart.title, chart.panels[0].title)))
    first.set_title(named, fontsize=TITLE, color=theme.ink, loc="left", pad=pad, parse_math=False)
    for ax, panel in zip(drawn, chart.panels, strict=True):
        if panel.shape is not Shape.POLAR:
            label = (panel.across or chart.axis).label
            ax.set_xlabel(label, fontsize=SMALL, color=theme.faint, parse_math=False)
