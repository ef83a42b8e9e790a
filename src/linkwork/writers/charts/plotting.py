"""The chart of a kind of plot, and plots for notebooks and scripts.

``plot_motion`` and ``plot_circuits`` implement ``motion.plot`` and ``circuits.plot``. New figures
belong to pyplot, so that notebooks and ``matplotlib.pyplot.show`` display them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from enum import Enum
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


class PlotKind(Enum):
    """Kinds of plots; the values are those of ``kind=`` and ``--kind``."""

    CURVES = "curves"
    POLAR = "polar"
    PATH = "path"
    HODOGRAPH = "hodograph"
    TRANSMISSION = TRANSMISSION_ANGLE.word
    CIRCUITS = "circuits"
    BRANCHES = "branches"


CIRCUIT_KINDS = (PlotKind.CIRCUITS, PlotKind.BRANCHES)
MOTION_KINDS = tuple(kind for kind in PlotKind if kind not in CIRCUIT_KINDS)


def motion_plot(
    motion: Motion,
    names: Sequence[str] = (),
    *,
    kind: str = PlotKind.CURVES.value,
    against: str = "",
    wrapped: bool = False,
) -> Chart:
    """The chart of a motion.

    Parameters
    ----------
    names : sequence of str
        Columns; points for a path or a hodograph; pins for transmission angles.
    kind : str
        The value of one of :data:`MOTION_KINDS`.
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
    which = _kind(kind, MOTION_KINDS, "of a motion", "circuits().plot")
    if wrapped and which is not PlotKind.CURVES:
        raise InputError(f'angles of kind="{kind}" are not wrapped: leave out wrapped')
    if against and which in (PlotKind.PATH, PlotKind.HODOGRAPH):
        raise InputError(f'a {kind} is drawn in the plane: leave out against="{against}"')
    match which:
        case PlotKind.POLAR:
            return polar_chart(motion, names, against=against)
        case PlotKind.PATH:
            return path_chart(motion, names)
        case PlotKind.HODOGRAPH:
            return hodograph_chart(motion, names)
        case PlotKind.TRANSMISSION:
            return transmission_chart(motion, names, against=against)
        case _:
            return motion_chart(motion, names, against=against, wrapped=wrapped)


def circuits_plot(
    circuits: Circuits, names: Sequence[str] = (), *, kind: str = PlotKind.CIRCUITS.value
) -> Chart:
    """The chart of all circuits, together or with one panel per branch.

    Raises
    ------
    InputError
        If there is no circuit, or there are too many branches.
    UnknownNameError
        If a quantity or kind does not exist.
    """
    which = _kind(kind, CIRCUIT_KINDS, "of circuits", "sweep().plot")
    return (
        branch_chart(circuits, names)
        if which is PlotKind.BRANCHES
        else circuit_chart(circuits, names)
    )


def _kind(kind: str, known: Sequence[PlotKind], what: str, elsewhere: str) -> PlotKind:
    for which in known:
        if which.value == kind:
            return which
    if kind in [which.value for which in PlotKind]:
        raise InputError(f'there is no plot {what} of kind "{kind}": use {elsewhere}')
    options = choices("kinds", [which.value for which in known], kind)
    raise UnknownNameError(f'there is no plot {what} of kind "{kind}" {options}')


def plot_motion(
    motion: Motion,
    *names: str,
    kind: str = PlotKind.CURVES.value,
    against: str = "",
    wrapped: bool = False,
    ax: Any = None,
    theme: str = "light",
    title: str | None = None,
) -> Any:
    """Plot a motion; see :meth:`linkwork.core.results.motion.Motion.plot`."""
    chart = motion_plot(motion, names, kind=kind, against=against, wrapped=wrapped)
    return _plot(chart, ax, theme, title)


def plot_circuits(
    circuits: Circuits,
    *names: str,
    kind: str = PlotKind.CIRCUITS.value,
    ax: Any = None,
    theme: str = "light",
    title: str | None = None,
) -> Any:
    """Plot circuits; see :meth:`linkwork.circuits.results.Circuits.plot`."""
    return _plot(circuits_plot(circuits, names, kind=kind), ax, theme, title)


def _plot(chart: Chart, ax: Any, theme: str, title: str | None) -> Any:
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
