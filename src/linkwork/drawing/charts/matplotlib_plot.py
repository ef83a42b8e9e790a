"""Charts for notebooks and scripts, in new figures or in existing axes.

This module implements ``motion.plot`` and ``circuits.plot``. New figures belong to pyplot, so that
notebooks and ``matplotlib.pyplot.show`` display them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from linkwork.drawing.charts.chart import Chart, Shape
from linkwork.drawing.charts.matplotlib_page import draw_page, legend_entries
from linkwork.drawing.charts.matplotlib_panel import draw_panel
from linkwork.drawing.charts.page import KEY, SMALL, TITLE
from linkwork.drawing.charts.plotting import PlotKind, circuits_plot, motion_plot
from linkwork.drawing.charts.theme import THEMES, ChartTheme
from linkwork.drawing.matplotlib_settings import house_settings
from linkwork.drawing.theme import theme_named
from linkwork.foundation.errors import InputError
from linkwork.results.circuits import Circuits
from linkwork.results.motion import Motion

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    PlotAxes = Axes | tuple[Axes, ...]

__all__ = ["plot_chart", "plot_circuits", "plot_motion"]

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
    """Plot a motion; see :meth:`linkwork.results.motion.Motion.plot`."""
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
    """Plot circuits; see :meth:`linkwork.results.circuits.Circuits.plot`."""
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
