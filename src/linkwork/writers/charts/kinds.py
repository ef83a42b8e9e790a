"""Columns of a motion over its input, over time, or over each other."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
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
from linkwork.writers.charts.chart import (
    Axis,
    Band,
    Chart,
    Curve,
    Mark,
    Panel,
    Pen,
    Rule,
    Scale,
    Shape,
    Window,
    across_step,
    angle_ends,
    finite_ends,
    level_ends,
    origin,
    round_step,
    rounded,
    turn_axis,
    with_unit,
)
from linkwork.writers.charts.columns import (
    Column,
    abscissa_of,
    breaks,
    broken,
    column_of,
    layered,
    lead_of,
    limit_marks,
    runs,
    usual_columns,
)

_MOST_CURVES = 6  # curves in a panel: the number of colours
_SPANS = 20.0  # largest ratio of the ranges of curves in a panel: flatter ones show nothing
_BESIDE = 15.0  # em: the longest axis label that names all curves of a panel
_MOST_VALUES = (2.0, 98.0)  # percentiles
_BEYOND = 4.0  # beyond this multiple of its usual range a curve runs to infinity at a dead point


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
    check_found(motion)
    across = abscissa_of(motion, against)
    columns = columns_of(motion, names or [*usual_columns(motion), *motion.outputs])
    panels = shared_panels(motion, across, columns, wrapped=wrapped)
    named = [curve.name for p in panels if len(p.curves) > 1 for curve in p.curves]
    kinds = [mark.kind for p in panels for mark in p.marks]
    kinds += [rule.kind for p in panels for rule in p.rules]
    return Chart(
        title=motion.mechanism,
        caption=reached_caption(motion),
        axis=across_axis(motion, across, own=not against),
        panels=tuple(panels),
        legend=tuple(dict.fromkeys([*named, *kinds])),
    )


def check_found(motion: Motion) -> None:
    """Reject a motion without positions."""
    if not motion.found.any():
        raise InputError(f'"{motion.mechanism}" has no position to plot: {motion.message}')


def columns_of(motion: Motion, names: Sequence[str]) -> list[Column]:
    """The columns with these names, without duplicates."""
    found = {column.name: column for column in (column_of(motion, name) for name in names)}
    return list(found.values())


def shared_panels(
    motion: Motion, across: Column, columns: Sequence[Column], *, wrapped: bool = False
) -> list[Panel]:
    """Panels of columns over one abscissa; columns of one unit and similar range share a panel."""
    groups = _grouped(columns)
    order = [column.name for group in groups for column in group]
    tones = {name: tone for tone, name in enumerate(order, start=1)}
    return [_panel(motion, across, group, tones, wrapped) for group in groups]


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


def _panel(
    motion: Motion, across: Column, group: list[Column], tones: dict[str, int], wrapped: bool
) -> Panel:
    curves: list[Curve] = []
    marks: list[Mark] = []
    rules: list[Rule] = []
    for column in group:
        tone = tones[column.name]
        where = breaks(motion, motion.inputs[lead_of(motion)], across, column)
        x, y = broken(across.values, where), broken(column.values, where)
        pen = Pen.DOTS if Pen.DOTS in (across.pen, column.pen) else Pen.LINE
        curves.append(Curve(x=x, y=y, tone=tone, name=column.label, pen=pen))
        own, gaps = limit_marks(motion, across, column, tone)
        marks, rules = marks + own, rules + gaps
    axis = _value_axis(motion, group, curves)
    if wrapped and axis.turn and any(np.isfinite(curve.y).any() for curve in curves):
        axis, curves, marks = _wrapped(motion, axis, curves, marks)
    drawn = tuple(layered(curves)) if len(curves) > 1 else tuple(curves)
    unique = tuple(dict.fromkeys(rules))
    return Panel(axis=axis, curves=drawn, marks=tuple(marks), rules=unique)


def _value_axis(motion: Motion, group: Sequence[Column], curves: Sequence[Curve]) -> Axis:
    """Label and range of the axis of columns that share a panel."""
    first = group[0]
    label = with_unit(", ".join(column.label for column in group), first.unit)
    if len(group) > 1 and text_width(label, 1.0) > _BESIDE:
        label = with_unit(first.measure, first.unit)
    axis = Axis(label=label, turn=first.turn, scale=first.scale)
    values = np.concatenate([curve.y for curve in curves])
    if not np.isfinite(values).any() or first.scale is not Scale.LINEAR:
        return axis
    if first.turn:
        ends, step = angle_ends(values, motion.units.angle)
        return replace(axis, ends=ends, step=step)
    level = level_ends(values, max(column.size for column in group))
    if level is not None:
        return replace(axis, ends=level)
    singular = any(kind in ("dead point", "change point") for kind in motion.limit)
    if singular and any(column.rate for column in group):
        most = finite_ends(curves)
        reach = float(np.nanmax(values) - np.nanmin(values))
        if most is not None and reach > _BEYOND * (most[1] - most[0]):
            return replace(axis, ends=most)
    return axis


def _wrapped(
    motion: Motion, axis: Axis, curves: Sequence[Curve], marks: Sequence[Mark]
) -> tuple[Axis, list[Curve], list[Mark]]:
    """The panel over one turn, chosen to cut the fewest lines."""
    turn = axis.turn
    pieces = [list(runs(curve.x, rounded(curve.y, turn))) for curve in curves]
    low = origin([y for lines in pieces for _, y in lines], turn)
    window = Window(x_turn=0.0, y_turn=turn, low=low)
    folded = []
    for curve, lines in zip(curves, pieces, strict=True):
        x, y = _joined([window.folded(x, y) for x, y in lines])
        folded.append(replace(curve, x=x, y=y))
    ends = np.concatenate([np.stack([curve.x, curve.y], axis=1) for curve in folded])
    placed = [
        replace(mark, x=x, y=y)
        for mark in marks
        for x, y in window.shown_on(ends, mark.x, float(rounded(np.array(mark.y), turn)))
    ]
    return turn_axis(axis, [c.y for c in folded], low, motion.units.angle), folded, placed


def _joined(pieces: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Pieces of a line concatenated with NaN between them."""
    gap = (np.array([np.nan]), np.array([np.nan]))
    parts = [part for piece in pieces for part in (gap, piece)][1:] or [gap]
    return np.concatenate([x for x, _ in parts]), np.concatenate([y for _, y in parts])


def across_axis(motion: Motion, across: Column, *, own: bool) -> Axis:
    """The common axis of all panels; an input is shown over its requested range."""
    axis = Axis(label=with_unit(across.label, across.unit), turn=across.turn, scale=across.scale)
    values = across.values[np.isfinite(across.values)]
    low, high = float(values.min()), float(values.max())
    if high <= low:
        return axis
    step = across_step(high - low, motion.units.angle) if across.turn else 0.0
    if own or across.measure == "time":
        return replace(axis, ends=(low, high), step=step)
    if across.turn:
        ends, step = angle_ends(values, motion.units.angle)
        return replace(axis, ends=ends, step=step)
    return axis


# ----------------------------------------------------------------------
# Columns of a motion as radii over an angle, usually that of the crank.


_AROUND = 12  # rays per turn
_RINGS = 4  # approximate number


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
    check_found(motion)
    across = abscissa_of(motion, against)
    if not across.turn:
        raise InputError(
            f'a polar plot needs an angle, and "{across.name}" is not one: name an angle with '
            f"against= (--against){_an_angle(motion)}"
        )
    columns = columns_of(motion, names or _usual(motion))
    panels = [_round(motion, panel) for panel in shared_panels(motion, across, columns)]
    named = [curve.name for panel in panels if len(panel.curves) > 1 for curve in panel.curves]
    kinds = [mark.kind for panel in panels for mark in panel.marks]
    return Chart(
        title=motion.mechanism,
        caption=f"over {with_unit(across.label, across.unit)}, {reached_caption(motion)}",
        axis=Axis(label=across.label, turn=across.turn, step=across.turn / _AROUND),
        panels=tuple(panels),
        columns=min(len(panels), 2),
        legend=tuple(dict.fromkeys([*named, *kinds])),
    )


def _usual(motion: Motion) -> list[str]:
    """The default columns: unknown lengths, else rates of traced points, else the usual ones."""
    lengths = [n for n, series in motion.unknowns.items() if series.quantity.kind is Kind.LENGTH]
    rate = Rate.FIRST if motion.speed is None else Rate.VELOCITY
    rates = [f"{point}.{rate.value}" for point in motion.skeleton.traced]
    return lengths or rates or list(usual_columns(motion))


def _an_angle(motion: Motion) -> str:
    """An existing angle, for the end of a message."""
    angles = [n for n, series in motion.unknowns.items() if series.quantity.kind is Kind.ANGLE]
    return f', as in "{angles[0]}"' if angles else ""


def _round(motion: Motion, panel: Panel) -> Panel:
    """A polar panel; radii start at zero, or below it if some are negative."""
    axis = panel.axis
    values = np.concatenate([curve.y for curve in panel.curves])
    low, high = axis.ends or (float(np.nanmin(values)), float(np.nanmax(values)))
    low, high = min(low, 0.0), max(high, 0.0)
    if axis.turn:
        ends, step = angle_ends(np.append(values, 0.0), motion.units.angle)
        axis = replace(axis, ends=ends, step=step)
    elif axis.scale is Scale.LINEAR and high > low:
        step = round_step((high - low) / _RINGS)
        ends = (math.floor(low / step) * step, math.ceil(high / step) * step)
        axis = replace(axis, ends=ends, step=step)
    zero = (Rule(along="y", at=0.0),) if low < 0.0 else ()
    return replace(panel, shape=Shape.POLAR, axis=axis, title=axis.label, rules=zero)


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
    check_found(motion)
    pins = {dyad.pin: dyad for dyad in dyads_of(motion.skeleton)}
    if not names and not pins:
        raise InputError(
            f'"{motion.mechanism}" has no pair of links with a known transmission angle: '
            'add it to [outputs], as in mu = "rocker - coupler", and name it'
        )
    columns = [_column(motion, pins, name) for name in names or pins]
    across = abscissa_of(motion, against)
    axis, band = _axis(motion), _band(motion)
    panels = [
        replace(panel, axis=axis, bands=(band,)) for panel in shared_panels(motion, across, columns)
    ]
    kinds = [mark.kind for panel in panels for mark in panel.marks]
    legend = dict.fromkeys([*(column.label for column in columns), *kinds, band.name])
    return Chart(
        title=motion.mechanism,
        caption=reached_caption(motion),
        axis=across_axis(motion, across, own=not against),
        panels=tuple(panels),
        legend=tuple(legend),
    )


def _axis(motion: Motion) -> Axis:
    """From 0 to half a turn, with ticks at the ends of the band."""
    unit = motion.units.angle
    return Axis(
        label=with_unit("transmission angle", unit.value),
        turn=unit.turn,
        ends=(0.0, math.pi / unit.radians),
        ticks=tuple(tick / unit.radians for tick in _TICKS),
    )


def _band(motion: Motion) -> Band:
    unit = motion.units.angle
    low, high = (bound / unit.radians for bound in RECOMMENDED)
    told = ("2π/9", "7π/9 rad")
    if unit is AngleUnit.DEGREE:
        told = (f"{low:.0f}°", f"{high:.0f}°")
    return Band(low=low, high=high, name=f"recommended: {told[0]} to {told[1]}")


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
