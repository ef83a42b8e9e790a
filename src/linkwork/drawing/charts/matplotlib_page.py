"""Charts as Matplotlib figures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from linkwork.drawing.charts.chart import Chart, Shape
from linkwork.drawing.charts.matplotlib_panel import (
    band_style,
    curve_style,
    draw_panel,
    mark_style,
    rule_style,
)
from linkwork.drawing.charts.page import KEY, SMALL, TITLE, Page, page_of
from linkwork.drawing.charts.theme import ChartTheme
from linkwork.drawing.theme import Theme

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["chart_figure", "draw_page", "legend_entries"]


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
        _legend(figure, entry, page, place, theme)
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


def _legend(
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
