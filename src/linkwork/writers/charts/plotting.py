"""The chart of a kind of plot, and plots for notebooks and scripts.

``motion.plot`` and ``circuits.plot`` draw these charts with :func:`plot`. New figures
belong to pyplot, so that notebooks and ``matplotlib.pyplot.show`` display them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from inspect import signature
from typing import Any

from linkwork.circuits.results import Circuits
from linkwork.core.drawing.matplotlib_settings import house_settings
from linkwork.core.drawing.scene import THEMES, theme_named
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.writers.charts.axes import chart_theme
from linkwork.writers.charts.chart import Chart
from linkwork.writers.charts.circuits import branch_chart, circuit_chart
from linkwork.writers.charts.kinds import motion_chart, polar_chart, transmission_chart
from linkwork.writers.charts.plane import hodograph_chart, path_chart

#: The charts of a motion and of circuits, by their kinds; the first is the default.
MOTION_KINDS: Mapping[str, Callable[..., Chart]] = {
    "curves": motion_chart,
    "polar": polar_chart,
    "path": path_chart,
    "hodograph": hodograph_chart,
    TRANSMISSION_ANGLE.word: transmission_chart,
}
CIRCUIT_KINDS: Mapping[str, Callable[..., Chart]] = {
    "circuits": circuit_chart,
    "branches": branch_chart,
}


def motion_plot(
    motion: Motion,
    names: Sequence[str] = (),
    *,
    kind: str = "curves",
    against: str = "",
    wrapped: bool = False,
) -> Chart:
    """The chart of a motion.

    Parameters
    ----------
    names : sequence of str
        Columns; points for a path or a hodograph; pins for transmission angles.
    kind : str
        One of :data:`MOTION_KINDS`.
    against : str
        The column of the abscissa, or ``time``; by default the leading input.
    wrapped : bool
        Reduce angles to one turn.

    Raises
    ------
    InputError
        If there is nothing to plot, or the other options do not apply to this kind.
    UnknownNameError
        If a name or kind does not exist.
    """
    chart = _chart_of(kind, MOTION_KINDS, "of a motion", "circuits().plot")
    options = {name: value for name, value in (("against", against), ("wrapped", wrapped)) if value}
    for name in options:
        if name not in signature(chart).parameters:
            raise InputError(f'a plot of kind "{kind}" has no option {name}: leave it out')
    return chart(motion, names, **options)


def circuits_plot(
    circuits: Circuits, names: Sequence[str] = (), *, kind: str = "circuits"
) -> Chart:
    """The chart of all circuits, together or with one panel per branch.

    Raises
    ------
    InputError
        If there is no circuit, or there are too many branches.
    UnknownNameError
        If a quantity or kind does not exist.
    """
    return _chart_of(kind, CIRCUIT_KINDS, "of circuits", "sweep().plot")(circuits, names)


def _chart_of(
    kind: str, known: Mapping[str, Callable[..., Chart]], what: str, elsewhere: str
) -> Callable[..., Chart]:
    if kind in known:
        return known[kind]
    if kind in (*MOTION_KINDS, *CIRCUIT_KINDS):
        raise InputError(f'there is no plot {what} of kind "{kind}": use {elsewhere}')
    options = choices("kinds", known, kind)
    raise UnknownNameError(f'there is no plot {what} of kind "{kind}" {options}')


def plot(chart: Chart, ax: Any, theme: str, title: str | None) -> Any:
    """Draw a chart into a new figure or into existing axes; returns one axes, or a tuple."""
    drawings = theme_named(theme, THEMES)
    if title is not None:
        chart = replace(chart, title=title, caption=chart.caption if title else "")
    if ax is None:
        with house_settings():
            from matplotlib import pyplot

            drawn = chart.draw_on(pyplot.figure(), chart_theme(drawings))
    else:
        drawn = [ax] if hasattr(ax, "plot") else list(getattr(ax, "flat", ax))
        chart.draw_in(drawn, chart_theme(drawings))
    return drawn[0] if len(drawn) == 1 else tuple(drawn)
