"""Charts as Matplotlib figures: translated, not designed, here."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from linkwork.drawing.captions import lines_within
from linkwork.drawing.chart import Axis, Chart, Panel
from linkwork.drawing.scene import text_width
from linkwork.drawing.theme import Theme

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis as TickedAxis
    from matplotlib.figure import Figure

__all__ = ["chart_figure"]

_WIDTH, _PANEL, _ABOVE, _BELOW = 6.95, 1.9, 0.17, 0.6  # inches
_LEFT, _RIGHT, _GAP = 0.85, 0.25, 0.22
_TITLE_LINE, _LEGEND_LINE, _HANDLE = 0.19, 0.2, 0.4
_TITLE, _SMALL, _KEY = 11.0, 9.0, 8.5  # font sizes in points
_LABEL_AT = 0.62  # inches left of a panel
_LINE, _WIDER = 1.6, 1.7  # points: a curve, and what it grows by for every curve that hides it
_SHAPES = {"dead point": "o", "change point": "D"}
#: Circuits of one colour differ in these.
_DASHES: tuple[Any, ...] = ("solid", (0, (4.0, 1.6)), (0, (1.0, 1.2)), (0, (4.0, 1.4, 1.0, 1.4)))


def chart_figure(chart: Chart, theme: Theme) -> Figure:
    """A chart as a figure of its own."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    room = (_WIDTH - _LEFT - _RIGHT) * 72
    heading = [(line, _TITLE, theme.ink) for line in lines_within(chart.title, room / _TITLE)]
    heading += [(line, _SMALL, theme.faint) for line in lines_within(chart.caption, room / _SMALL)]
    entries = _entries(chart, theme)
    rows = _rows_of(entries)
    legend = _ABOVE + _TITLE_LINE * len(heading)
    above = legend + _LEGEND_LINE * len(rows) + _GAP / 2
    count = len(chart.panels)
    height = above + count * _PANEL + (count - 1) * _GAP + _BELOW
    page = Figure(figsize=(_WIDTH, height), facecolor=theme.background)
    FigureCanvasAgg(page)
    for k, (line, size, colour) in enumerate(heading):
        place = (_LEFT / _WIDTH, 1 - (_ABOVE + (k + 0.5) * _TITLE_LINE) / height)
        page.text(*place, line, fontsize=size, color=colour, parse_math=False)
    for k, row in enumerate(rows):
        _legend(page, row, legend + k * _LEGEND_LINE, theme)
    for k, panel in enumerate(chart.panels):
        bottom = _BELOW + (count - 1 - k) * (_PANEL + _GAP)
        wide = _WIDTH - _LEFT - _RIGHT
        ax = page.add_axes(
            (_LEFT / _WIDTH, bottom / height, wide / _WIDTH, _PANEL / height), gid=f"panel:{k + 1}"
        )
        _draw(ax, chart, panel, theme)
        if k < count - 1:
            ax.tick_params(labelbottom=False)
        else:
            ax.set_xlabel(chart.axis.label, fontsize=_SMALL, color=theme.faint, parse_math=False)
    return page


def _draw(ax: Axes, chart: Chart, panel: Panel, theme: Theme) -> None:
    ax.set_facecolor(theme.background)
    leaves = panel.axis.ends is not None and not panel.axis.turn
    for curve in panel.curves:
        width = _LINE + _WIDER * curve.below
        ax.plot(
            curve.x,
            curve.y,
            linewidth=width,
            gid=f"curve:{curve.name}",
            clip_on=leaves,  # else half of a line along an edge would be cut off
            zorder=3,
            **_pen(theme, curve.tone),
        )
    for mark in panel.marks:
        ax.plot(
            [mark.x],
            [mark.y],
            gid=mark.kind.replace(" ", "-"),
            clip_on=leaves,
            zorder=5,
            **_symbol(theme, mark.kind, _colour(theme, mark.tone)),
        )
    _scale(ax.xaxis, chart.axis, ax.set_xlim)
    _scale(ax.yaxis, panel.axis, ax.set_ylim)
    room = 0.96 * _PANEL * 72
    size = min(_SMALL, room / text_width(panel.axis.label, 1.0))
    ax.set_ylabel(panel.axis.label, fontsize=size, color=theme.faint, parse_math=False)
    ax.yaxis.set_label_coords(-_LABEL_AT / (_WIDTH - _LEFT - _RIGHT), 0.5)
    ax.grid(color=theme.faint, linewidth=0.3, alpha=0.5)
    ax.tick_params(length=3, width=0.6, colors=theme.faint, labelsize=0.9 * _SMALL)
    for side, spine in ax.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(theme.faint)
        spine.set_linewidth(0.6)


def _scale(ticked: TickedAxis, axis: Axis, show: Callable[[float, float], Any]) -> None:
    """Ends and ticks of an axis; radians as parts of π where the ticks stand at them."""
    from matplotlib.ticker import MaxNLocator, MultipleLocator

    ticked.set_major_locator(
        MultipleLocator(axis.step) if axis.step else MaxNLocator(5, steps=[1, 2, 5, 10])
    )
    if axis.ends is not None:
        show(*axis.ends)
    parts = axis.step / math.pi * 12
    of_pi = abs(axis.turn - math.tau) < 1e-9 and parts >= 1 and abs(parts - round(parts)) < 1e-9
    ticked.set_major_formatter(lambda value, _: _pi_text(value) if of_pi else _plain(value))


def _plain(value: float) -> str:
    return f"{value:.6g}".replace("-", "\u2212")


def _pi_text(value: float) -> str:
    """A multiple of π/12 as one writes it: ``0``, ``π/4``, ``3π/2``, ``−π``."""
    part = Fraction(round(value / math.pi * 12), 12)
    if not part:
        return "0"
    times = "" if abs(part.numerator) == 1 else str(abs(part.numerator))
    below = "" if part.denominator == 1 else f"/{part.denominator}"
    return f"{times}π{below}" if part > 0 else f"\u2212{times}π{below}"


def _entries(chart: Chart, theme: Theme) -> list[Any]:
    """Circuits by colour and dashes, kinds of marks by shape: handles of the legend."""
    from matplotlib.lines import Line2D

    names = {curve.name: curve.tone for panel in chart.panels for curve in panel.curves}
    kinds = dict.fromkeys(mark.kind for panel in chart.panels for mark in panel.marks)
    return [
        *(
            Line2D([], [], linewidth=_LINE, label=name, **_pen(theme, tone))
            for name, tone in names.items()
        ),
        *(Line2D([], [], label=kind, **_symbol(theme, kind, theme.ink)) for kind in kinds),
    ]


def _rows_of(entries: Sequence[Any]) -> list[list[tuple[Any, float]]]:
    """The entries of the legend in rows that fit the page, each with its left end in inches."""
    rows: list[list[tuple[Any, float]]] = []
    left = math.inf
    for entry in entries:
        width = _HANDLE + text_width(entry.get_label(), _KEY) / 72
        if left + width > _WIDTH:
            rows.append([])
            left = _LEFT
        rows[-1].append((entry, left))
        left += width
    return rows


def _legend(page: Figure, row: Sequence[tuple[Any, float]], down: float, theme: Theme) -> None:
    """One row of the legend, ``down`` inches below the upper edge."""
    height = page.get_figheight()
    for entry, left in row:
        page.legend(
            handles=[entry],
            loc="upper left",
            bbox_to_anchor=(left / _WIDTH, 1 - down / height),
            frameon=False,
            fontsize=_KEY,
            labelcolor=theme.faint,
            borderaxespad=0.0,
            borderpad=0.0,
            handlelength=1.6,
        )


def _pen(theme: Theme, tone: int) -> dict[str, Any]:
    """Colour and dashes of a circuit's curves."""
    dashes = _DASHES[(tone - 1) // len(theme.tones) % len(_DASHES)]
    return {"color": _colour(theme, tone), "linestyle": dashes}


def _symbol(theme: Theme, kind: str, colour: str) -> dict[str, Any]:
    return {
        "marker": _SHAPES.get(kind, "s"),
        "linestyle": "none",
        "color": theme.background,
        "markeredgecolor": colour,
        "markeredgewidth": 1.4,
        "markersize": 5.5,
    }


def _colour(theme: Theme, tone: int) -> str:
    return theme.tones[(tone - 1) % len(theme.tones)]
