"""Columns of a motion over its input, over time, or over each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain, pairwise

import numpy as np

from linkwork.drawing.captions import reached_caption
from linkwork.drawing.charts.chart import Axis, Chart, Curve, Mark, Panel, Pen, Rule, Scale
from linkwork.drawing.charts.columns import Column, abscissa_of, column_of, lead_of, usual_columns
from linkwork.drawing.charts.labels import with_unit
from linkwork.drawing.charts.lines import breaks, broken, limit_marks, runs
from linkwork.drawing.charts.overlap import layered
from linkwork.drawing.charts.scales import across_step, angle_ends, finite_ends, level_ends
from linkwork.drawing.charts.turns import Window, origin, rounded, turn_axis
from linkwork.drawing.scene import text_width
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion

__all__ = ["across_axis", "check_found", "columns_of", "motion_chart", "shared_panels"]

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
