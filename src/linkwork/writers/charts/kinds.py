"""Columns of a motion over its input, over time, over each other, or around a pole."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, pairwise

import numpy as np

from linkwork.core.drawing.pose import printed_name, reached_caption
from linkwork.core.drawing.scene import text_width
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import find_spelling
from linkwork.core.foundation.units import AngleUnit
from linkwork.core.mechanism.skeleton import Dyad, dyads_of
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.rows import RECOMMENDED, TRANSMISSION_ANGLE
from linkwork.core.results.quantity import Kind, Rate
from linkwork.writers.charts.axes import ChartAxes, pi_text, round_ticks, set_scale
from linkwork.writers.charts.chart import (
    TIME,
    Chart,
    Column,
    Panel,
    abscissa_of,
    column_of,
    lead_of,
    usual_columns,
    with_unit,
)
from linkwork.writers.charts.lines import (
    SINGULAR,
    Window,
    bounded_ends,
    breaks,
    broken,
    covering,
    level_ends,
    limits_on,
    repeated,
)

_MOST_CURVES = 6  # curves in a panel: the number of colours
_SPANS = 20.0  # largest ratio of the ranges of curves in a panel: flatter ones show nothing
_BESIDE = 15.0  # em: the longest axis label that names all curves of a panel
_MOST_VALUES = (2.0, 98.0)  # percentiles


def motion_chart(
    motion: Motion, names: Sequence[str] = (), *, against: str = "", wrapped: bool = False
) -> Chart:
    """Columns over the leading input, in panels of one unit and similar range, with limits marked.

    Lines are broken at rows without position.

    Parameters
    ----------
    names : sequence of str
        The columns; by default those of :func:`usual_columns` and the outputs.
    against : str
        The column of the abscissa, or ``time``; by default the leading input.
    wrapped : bool
        Reduce angles to one turn; lines continue at the other side of the panel.

    Raises
    ------
    InputError
        If no position was found, a name is text or a point, or the input has no speed.
    UnknownNameError
        If a column does not exist.
    """
    check_positions(motion)
    graph = _Graph(motion, abscissa_of(motion, against), alone=not against, wrapped=wrapped)
    columns = columns_of(motion, names or [*usual_columns(motion), *motion.outputs])
    return Chart(
        title=motion.mechanism,
        caption=reached_caption(motion),
        panels=shared_panels(columns, graph.draw),
    )


def check_positions(motion: Motion) -> None:
    """Reject a motion without positions."""
    if not motion.found.any():
        raise InputError(f'"{motion.mechanism}" has no position to plot: {motion.message}')


def columns_of(motion: Motion, names: Sequence[str]) -> list[Column]:
    """The columns with these names, without duplicates."""
    by_name = {column.name: column for column in (column_of(motion, name) for name in names)}
    return list(by_name.values())


def shared_panels(
    columns: Sequence[Column], draw: Callable[..., None], ratio: float = 0.75
) -> tuple[Panel, ...]:
    """Panels of columns of one unit and similar range.

    ``draw`` is called with the columns of a panel, the number of the first one's colour, and the
    axes.
    """
    panels: list[Panel] = []
    tone = 1
    for group in _grouped(columns):
        panels.append(Panel(label=_label(group), draw=partial(draw, group, tone), ratio=ratio))
        tone += len(group)
    return tuple(panels)


def _grouped(columns: Sequence[Column]) -> list[list[Column]]:
    """Groups of columns of one unit and similar range, limited to the number of colours."""
    groups: dict[tuple[str, str], list[Column]] = {}
    for column in columns:
        key = (column.measure, column.unit) if column.measure else ("", column.name)
        groups.setdefault(key, []).append(column)
    shared: list[list[Column]] = []
    for group in chain.from_iterable(map(_of_similar_range, groups.values())):
        count = math.ceil(len(group) / _MOST_CURVES)
        size = math.ceil(len(group) / count)
        shared += [group[k : k + size] for k in range(0, len(group), size)]
    return shared


def _of_similar_range(columns: list[Column]) -> list[list[Column]]:
    """Columns of one unit, divided at the largest step of their ranges until these are similar."""
    spans = {column.name: _span(column) for column in columns}
    # a level line is as legible on any axis
    varying = sorted((c for c in columns if spans[c.name]), key=lambda c: spans[c.name])
    if not varying or spans[varying[-1].name] <= _SPANS * spans[varying[0].name]:
        return [columns]
    gaps = [spans[b.name] / spans[a.name] for a, b in pairwise(varying)]
    flat = varying[: 1 + gaps.index(max(gaps))]
    parts = [c for c in columns if c in flat], [c for c in columns if c not in flat]
    groups = chain.from_iterable(map(_of_similar_range, parts))
    return sorted(groups, key=lambda group: columns.index(group[0]))


def _span(column: Column) -> float:
    """The range of most values: a rate is unbounded near a dead point. Zero for a level line."""
    values = column.values[np.isfinite(column.values)]
    if not len(values) or level_ends(values, column.size) is not None:
        return 0.0
    low, high = np.percentile(values, _MOST_VALUES)
    return float(high - low)


def _label(group: Sequence[Column]) -> str:
    """The names of columns, or their common quantity if there are too many."""
    first = group[0]
    label = with_unit(", ".join(column.label for column in group), first.unit)
    if len(group) > 1 and text_width(label, 1.0) > _BESIDE:
        label = with_unit(first.measure, first.unit)
    return label


@dataclass(frozen=True, eq=False)
class _Graph:
    """Columns of a motion over an abscissa.

    Parameters
    ----------
    alone : bool
        The abscissa is the input, shown over its requested range.
    wrapped : bool
        Reduce angles to one turn.
    legend : bool
        Name a single curve in the legend too.
    """

    motion: Motion
    across: Column
    alone: bool = False
    wrapped: bool = False
    legend: bool = False

    def draw(self, group: Sequence[Column], tone: int, axes: ChartAxes) -> None:
        """A panel of columns, from colour ``tone`` on."""
        across, first, unit = self.across, group[0], self.motion.units.angle
        lines = self.draw_columns(group, tone, axes)
        set_scale(axes, "x", across.scale)
        set_scale(axes, "y", first.scale)
        axes.labels(with_unit(across.label, across.unit), _label(group))
        low, high = np.nanmin(across.values), np.nanmax(across.values)
        if (self.alone or across.measure == TIME) and low < high:
            axes.show_input(low, high)
        ends = _ends(self.motion, group, lines)
        if ends is not None:
            axes.ax.set_ylim(*ends)
        for axis, column in ((axes.ax.xaxis, across), (axes.ax.yaxis, first)):
            if column.turn:
                round_ticks(axis, unit)

    def draw_columns(
        self, group: Sequence[Column], tone: int, axes: ChartAxes, factor: float = 1.0
    ) -> list[tuple[Array, Array]]:
        """The curves with their limits; returns the lines. ``factor``: unit of the abscissa."""
        motion, across = self.motion, self.across
        lead = motion.inputs[lead_of(motion)]
        lines: list[tuple[Array, Array]] = []
        for column in group:
            where = breaks(motion, lead, across, column)
            lines.append((broken(across.values, where) * factor, broken(column.values, where)))
        window = Window.around([y for _, y in lines], group[0].turn if self.wrapped else 0.0)
        polar = axes.ax.name == "polar"
        smooth = not polar and across.scale == group[0].scale == "linear"
        below = covering(lines, range(len(lines))) if len(lines) > 1 else [0]
        for k, (column, line) in enumerate(zip(group, lines, strict=True)):
            axes.curve(
                *repeated(*line, Window(), window),
                column.label,
                tone + k,
                legend=self.legend or len(group) > 1,
                below=below[k],
                dots=across.dots or column.dots,
                smooth=smooth,
            )
            for kind, rows in limits_on(motion, column).items():
                x, valued = across.values * factor, np.isfinite(column.values)
                if (rows & valued).any():
                    places = repeated(x, column.values, Window(), window, rows & valued)
                    axes.marks(*places, kind, tone + k)
                if kind in SINGULAR and not polar:
                    for at in x[rows & ~valued & np.isfinite(x)].tolist():
                        axes.limit_rule(at, kind)
        if window.whole:
            axes.ax.set_ylim(*window.ends)
        return lines


def _ends(
    motion: Motion, group: Sequence[Column], lines: Sequence[tuple[Array, Array]]
) -> tuple[float, float] | None:
    """The range of constant or of unbounded columns; ``None`` for other columns."""
    values = np.concatenate([y for _, y in lines])
    if group[0].scale != "linear" or not np.isfinite(values).any():
        return None
    level = level_ends(values, max(column.size for column in group))
    singular = any(kind in ("dead point", "change point") for kind in motion.limit)
    if level is None and singular and any(column.rate for column in group):
        return bounded_ends(lines)
    return level


# ----------------------------------------------------------------------
# Columns of a motion as radii over an angle, usually that of the crank.


_AROUND = 12  # rays per turn
_RADII_AT = 15.0  # degrees: the ray with the labels of radii


def polar_chart(motion: Motion, names: Sequence[str] = (), *, against: str = "") -> Chart:
    """Columns as radii over the leading input, counter-clockwise from the right.

    Parameters
    ----------
    names : sequence of str
        The columns. By default the unknown lengths, or if there are none the speeds of the traced
        points.
    against : str
        The angle; by default the leading input.

    Raises
    ------
    InputError
        If no position was found, or ``against`` is not an angle.
    UnknownNameError
        If a column does not exist.
    """
    check_positions(motion)
    across = abscissa_of(motion, against)
    if not across.turn:
        raise InputError(
            f'a polar plot needs an angle, and "{across.name}" is not one: name an angle with '
            "against= (--against)"
        )
    columns = columns_of(motion, names or _usual(motion))
    panels = shared_panels(columns, partial(_draw_polar, motion, across), ratio=1.0)
    return Chart(
        title=motion.mechanism,
        caption=f"over {with_unit(across.label, across.unit)}, {reached_caption(motion)}",
        panels=panels,
        columns=min(len(panels), 2),
        projection="polar",
    )


def _usual(motion: Motion) -> list[str]:
    """The default columns: unknown lengths, else rates of traced points, else the usual ones."""
    lengths = [n for n, series in motion.unknowns.items() if series.quantity.kind is Kind.LENGTH]
    rate = Rate.FIRST if motion.speed is None else Rate.VELOCITY
    rates = [f"{point}.{rate.value}" for point in motion.skeleton.traced]
    return lengths or rates or list(usual_columns(motion))


def _draw_polar(
    motion: Motion, across: Column, group: Sequence[Column], tone: int, axes: ChartAxes
) -> None:
    """Radii start at zero, or below it if some are negative: then a circle marks zero."""
    ax, unit = axes.ax, motion.units.angle
    graph = _Graph(motion, across)
    lines = graph.draw_columns(group, tone, axes, factor=math.tau / across.turn)
    set_scale(axes, "y", group[0].scale)
    axes.labels("", "", _label(group))
    values = np.concatenate([y for _, y in lines])
    level = level_ends(values, max(column.size for column in group))
    low, high = level or (float(np.nanmin(values)), float(np.nanmax(values)))
    if group[0].scale == "linear":
        ax.set_ylim(1.05 * min(low, 0.0), 1.05 * max(high, 0.0))
        round_ticks(ax.yaxis, unit if group[0].turn else None)
    if low < 0.0:
        around = np.linspace(0.0, math.tau, 181)
        zero = np.zeros_like(around)
        ax.plot(around, zero, color=axes.theme.rule, linewidth=1.4, zorder=1.5, gid="zero")
    rays = [math.tau * k / _AROUND for k in range(_AROUND)]
    degrees = unit is AngleUnit.DEGREE
    ax.set_xticks(rays, [f"{math.degrees(r):.0f}°" if degrees else pi_text(r) for r in rays])
    ax.set_rlabel_position(_RADII_AT)  # type: ignore[attr-defined]  # polar axes only
    for label in ax.get_yticklabels():
        label.set_bbox(
            {"facecolor": axes.theme.background, "alpha": 0.75, "edgecolor": "none", "pad": 0.6}
        )


# ----------------------------------------------------------------------
# Transmission angles over the input, with the recommended range.


_TICKS = (0.0, RECOMMENDED[0], math.pi / 2, RECOMMENDED[1], math.pi)


def transmission_chart(motion: Motion, names: Sequence[str] = (), *, against: str = "") -> Chart:
    """The transmission angle of every dyad, or of those at some pins.

    Parameters
    ----------
    names : sequence of str
        Pins of dyads, or columns of angles, reduced to half a turn; by default all dyads.
    against : str
        The column of the abscissa, or ``time``; by default the leading input.

    Raises
    ------
    InputError
        If no position was found, or there is no dyad and no name.
    UnknownNameError
        If a name is neither the pin of a dyad nor an angle.
    """
    check_positions(motion)
    pins = {dyad.pin: dyad for dyad in dyads_of(motion.skeleton)}
    if not names and not pins:
        raise InputError(
            f'"{motion.mechanism}" has no pair of links with a known transmission angle: '
            'add it to [outputs], as in mu = "rocker - coupler", and name it'
        )
    columns = [_column(motion, pins, name) for name in names or pins]
    graph = _Graph(motion, abscissa_of(motion, against), alone=not against, legend=True)
    return Chart(
        title=motion.mechanism,
        caption=reached_caption(motion),
        panels=shared_panels(columns, partial(_draw_transmission, graph)),
    )


def _draw_transmission(graph: _Graph, group: Sequence[Column], tone: int, axes: ChartAxes) -> None:
    """From 0 to half a turn, with the recommended band and ticks at its ends."""
    unit = graph.motion.units.angle
    graph.draw(group, tone, axes)
    low, high = (bound / unit.radians for bound in RECOMMENDED)
    named = f"{low:.0f}° to {high:.0f}°" if unit is AngleUnit.DEGREE else "2π/9 to 7π/9 rad"
    axes.band(low, high, f"recommended: {named}")
    axes.ax.set_ylabel(with_unit("transmission angle", unit.value))
    axes.ax.set_ylim(0.0, unit.turn / 2)
    ticks = [tick / unit.radians for tick in _TICKS]
    axes.ax.set_yticks(
        ticks, None if unit is AngleUnit.DEGREE else [pi_text(tick) for tick in _TICKS]
    )


def _column(motion: Motion, pins: Mapping[str, Dyad], name: str) -> Column:
    """The angle at the pin of a dyad, or another angle reduced to half a turn."""
    pin = find_spelling(name, pins)
    if pin not in pins and name in motion.points:
        known = choices("pins with a known transmission angle", pins, name)
        raise UnknownNameError(f'the transmission angle at "{name}" is not known {known}')
    column = column_of(motion, f"{pin}.{TRANSMISSION_ANGLE.word}" if pin in pins else name)
    if not column.turn:
        raise UnknownNameError(
            f'"{name}" is not an angle {choices("pins", pins, name)}; name a pin between two '
            "links, or an angle"
        )
    label, values = column.label, column.values
    if pin in pins:
        label = f"{printed_name(pin)}: {', '.join(pins[pin].links)}"
    else:
        radians = motion.units.angle.radians
        values = np.abs(np.angle(np.exp(1j * values * radians))) / radians
    return replace(
        column,
        name=name,
        label=label,
        measure="transmission angle",
        values=values,
        slope=None,
        size=column.turn,
    )
