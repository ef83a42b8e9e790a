"""Charts as Matplotlib figures: translated, not designed, here."""

from __future__ import annotations

from typing import TYPE_CHECKING

from linkwork.drawing.chart import Chart, Panel
from linkwork.drawing.theme import Theme

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["chart_figure"]

_WIDTH, _PANEL, _ABOVE, _BELOW = 6.95, 1.9, 0.75, 0.6  # inches
_LEFT, _RIGHT, _GAP = 0.85, 0.25, 0.22
_TITLE, _SMALL = 11.0, 9.0  # font sizes in points
_SHAPES = {"dead point": "o", "change point": "D"}


def chart_figure(chart: Chart, theme: Theme) -> Figure:
    """A chart as a figure of its own."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    count = max(len(chart.panels), 1)
    height = _ABOVE + count * _PANEL + (count - 1) * _GAP + _BELOW
    page = Figure(figsize=(_WIDTH, height), facecolor=theme.background)
    FigureCanvasAgg(page)
    page.text(
        _LEFT / _WIDTH, 1 - 0.27 / height, chart.title, fontsize=_TITLE, color=theme.ink,
        parse_math=False,
    )  # fmt: skip
    names: dict[str, int] = {}
    for k, panel in enumerate(chart.panels):
        bottom = _BELOW + (count - 1 - k) * (_PANEL + _GAP)
        ax = page.add_axes(
            (
                _LEFT / _WIDTH,
                bottom / height,
                (_WIDTH - _LEFT - _RIGHT) / _WIDTH,
                _PANEL / height,
            )
        )
        _draw(ax, chart, panel, theme)
        names |= {curve.name: curve.tone for curve in panel.curves}
        if k < count - 1:
            ax.tick_params(labelbottom=False)
        else:
            ax.set_xlabel(chart.label, fontsize=_SMALL, color=theme.faint, parse_math=False)
    _legend(page, names, chart, theme, height)
    return page


def _draw(ax: Axes, chart: Chart, panel: Panel, theme: Theme) -> None:
    from matplotlib.ticker import MultipleLocator

    ax.set_facecolor(theme.background)
    for curve in panel.curves:
        ax.plot(curve.x, curve.y, color=_tone(theme, curve.tone), linewidth=1.6)
    for mark in panel.marks:
        ax.plot(
            [mark.x],
            [mark.y],
            _SHAPES.get(mark.kind, "s"),
            color=theme.background,
            markeredgecolor=_tone(theme, mark.tone),
            markeredgewidth=1.4,
            markersize=5.5,
            clip_on=False,
            zorder=5,
        )
    if chart.whole_turns:
        ax.set_xlim(0.0, chart.turn)
        ax.xaxis.set_major_locator(MultipleLocator(chart.turn / 8))
    if panel.whole_turns:
        ax.set_ylim(0.0, chart.turn)
        ax.yaxis.set_major_locator(MultipleLocator(chart.turn / 4))
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(lambda value, _: f"{value:.6g}".replace("-", "\u2212"))
    ax.set_ylabel(panel.label, fontsize=_SMALL, color=theme.faint, parse_math=False)
    ax.grid(color=theme.faint, linewidth=0.3, alpha=0.5)
    ax.tick_params(length=3, width=0.6, colors=theme.faint, labelsize=0.9 * _SMALL)
    for side, spine in ax.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(theme.faint)
        spine.set_linewidth(0.6)


def _legend(page: Figure, names: dict[str, int], chart: Chart, theme: Theme, height: float) -> None:
    """Circuits by colour, kinds of marks by shape, in one line under the title."""
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], color=_tone(theme, tone), linewidth=1.6, label=name)
        for name, tone in names.items()
    ]
    kinds = dict.fromkeys(mark.kind for panel in chart.panels for mark in panel.marks)
    handles += [
        Line2D(
            [],
            [],
            marker=_SHAPES.get(kind, "s"),
            linestyle="none",
            color=theme.background,
            markeredgecolor=theme.ink,
            markersize=5.5,
            label=kind,
        )
        for kind in kinds
    ]
    page.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(_LEFT / _WIDTH - 0.01, 1 - 0.32 / height),
        ncols=min(len(handles), 6),
        frameon=False,
        fontsize=0.95 * _SMALL,
        labelcolor=theme.faint,
        borderaxespad=0.2,
        columnspacing=1.4,
        handlelength=1.6,
    )


def _tone(theme: Theme, tone: int) -> str:
    return theme.tones[(tone - 1) % len(theme.tones)]
