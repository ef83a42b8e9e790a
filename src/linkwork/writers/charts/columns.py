"""Columns of a motion for charts: labels, units and scales."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.core.drawing.pose import printed_name
from linkwork.core.foundation.arrays import Array, BoolArray
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import find_spelling
from linkwork.core.results.limit import LimitKind
from linkwork.core.results.listing.motion_listing import coordinates_off_ground
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Asked, Group
from linkwork.core.results.quantity import Kind, Rate
from linkwork.writers.charts.chart import Curve, Mark, Pen, Rule, Scale, rate_label, size_label

#: Name of the time in ``against``.
TIME = "time"

#: Text columns of a table.
_TEXTS = ("status", "certified", "branch", "limit")

#: Scale and style of evidence not drawn as lines over a logarithmic axis.
_EVIDENCE: Mapping[str, tuple[Scale, Pen]] = {
    "residual": (Scale.ROUNDING, Pen.DOTS),
    "iterations": (Scale.COUNT, Pen.DOTS),
}


@dataclass(frozen=True, kw_only=True, eq=False)
class Column:
    """One column of a motion.

    Parameters
    ----------
    name : str
        As in the motion, ``theta13.d1``.
    label, unit : str
        The printed label without unit, and the unit as in tables.
    measure : str
        Kind of quantity: ``angle``, ``length``, ``velocity``; columns with equal measure and unit
        share a panel. "" for numbers with a panel of their own.
    values : array (N,)
        File units, NaN where there is no position.
    turn : float
        A full turn in that unit, 0 unless it is an angle.
    slope : array (N,), optional
        For an angle that may jump: its derivative with respect to the input, in these units.
    size : float
        Typical size: differences below 1e-9 of it are rounding.
    scale, pen
        Scale of its axis and style of its curve.
    """

    name: str
    label: str
    unit: str
    measure: str
    values: Array
    turn: float = 0.0
    slope: Array | None = None
    size: float = 1.0
    scale: Scale = Scale.LINEAR
    pen: Pen = Pen.LINE

    @property
    def rate(self) -> bool:
        """Whether it is a derivative, which is unbounded at dead points."""
        return Rate.split(self.name)[1] is not None


def lead_of(motion: Motion) -> str:
    """The leading input: the first one that changes from row to row."""
    rows = motion.asked
    moving = (name for name, values in motion.inputs.items() if np.ptp(values[rows]))
    return next(moving, next(iter(motion.inputs)))


def usual_columns(motion: Motion) -> tuple[str, ...]:
    """The unknowns; without unknowns the outputs, or else the coordinates of the traced points, or
    of all moving ones.

    Raises
    ------
    InputError
        If there are none of these.
    """
    traced = [f"{point}.{axis}" for point in motion.skeleton.traced for axis in "xy"]
    found = tuple(motion.unknowns) or tuple(motion.outputs) or tuple(traced)
    found = found or coordinates_off_ground(motion)
    if not found:
        raise InputError(f'"{motion.mechanism}" has no unknowns: name the columns to plot')
    return found


def column_of(motion: Motion, name: str) -> Column:
    """A column by name: quantity, input, coordinate, rate, or evidence such as ``residual``.

    ``B.velocity`` of a point B is the magnitude of the vector.

    Raises
    ------
    UnknownNameError
        Lists the existing names; for rates with respect to time, states the missing speed.
    InputError
        If the column is text, or a point without coordinate.
    """
    if name in _TEXTS:
        raise InputError(f'"{name}" is text and cannot be plotted')
    point = find_spelling(name, motion.points)
    own = motion.quantities.own
    if point in motion.points and find_spelling(name, own) not in own:
        raise InputError(
            f'"{point}" is a point: plot a coordinate, "{point}.x" or "{point}.y", or its '
            'path, kind="path" (--kind path)'
        )
    asked = motion.quantity(name)
    if asked.group is Group.EVIDENCE:
        return _evidence(motion, asked)
    if asked.rate is not None:
        return _rate(motion, asked, asked.rate)
    units, kind, lead = motion.units, asked.own.kind, lead_of(motion)
    turn = units.angle.turn if kind is Kind.ANGLE else 0.0
    slope = None
    if asked.group is not Group.INPUT and kind is Kind.ANGLE:
        by_input = 1.0 if motion.input_units[lead] != units.angle.value else units.angle.radians
        slope = asked.jet(motion).d1 * by_input / units.scale(kind)
    return Column(
        name=asked.name,
        label=printed_name(asked.name),
        unit=asked.unit,
        measure=asked.measure,
        values=motion[asked.name],
        turn=turn,
        slope=slope,
        size=turn or (_reach(motion) if kind is Kind.LENGTH else 1.0),
    )


def _evidence(motion: Motion, asked: Asked) -> Column:
    """A number about the positions found."""
    scale, pen = _EVIDENCE.get(asked.name, (Scale.LOG, Pen.LINE))
    shown = motion.found
    if asked.name == "condition":  # infinite at dead points, up to rounding
        shown = shown & ~np.isin(motion.limit, ("dead point", "change point"))
    values = np.where(shown, motion[asked.name].astype(float), np.nan)
    label = asked.name.replace("_", " ")
    return Column(
        name=asked.name, label=label, unit="", measure="", values=values, scale=scale, pen=pen
    )


def _rate(motion: Motion, asked: Asked, rate: Rate) -> Column:
    """A rate of a quantity, or its magnitude for a point."""
    own, of_point = asked.own, asked.group is Group.POINT
    size = _reach(motion) if own.kind is Kind.LENGTH else 1.0
    return Column(
        name=asked.name,
        label=(size_label if of_point else rate_label)(own.name, rate, lead_of(motion)),
        unit=asked.unit,
        measure=asked.measure,
        values=motion[asked.name],
        size=size * abs(motion.speed or 1.0) ** (rate.order if rate.by_time else 0),
    )


def _reach(motion: Motion) -> float:
    """The typical length: the extent of the mechanism's points."""
    places = [series.value for pair in motion.points.values() for series in pair]
    found = [p[np.isfinite(p)] for p in places]
    return max((float(np.ptp(p)) for p in found if len(p)), default=0.0) or 1.0


def abscissa_of(motion: Motion, against: str = "") -> Column:
    """The abscissa of a motion: the leading input, ``time``, or any column.

    Raises
    ------
    InputError
        If there is no input speed, or as :func:`column_of`.
    """
    if not against:
        return column_of(motion, lead_of(motion))
    if against == TIME and TIME not in motion.quantities.own:
        return _time(motion)
    return column_of(motion, against)


def _time(motion: Motion) -> Column:
    """Time since the first row, at constant speed of the leading input."""
    lead = lead_of(motion)
    if motion.speed is None:
        raise InputError(
            f"a plot over time needs the speed of {lead}: set it in [input], as in "
            f'speed = "{_speed_of(motion)}", or plot against {lead}'
        )
    if len(set(motion.branch) - {""}) > 1:
        raise InputError(
            f"several branches have no common time: {lead} reverses between them, so its speed "
            f"is not constant; plot against {lead}, or sweep one branch"
        )
    values = motion.inputs[lead]
    angle = motion.input_units[lead] == motion.units.angle.value
    unit = motion.units.angle.radians if angle else 1.0
    passed = (values - values[0]) * unit / motion.speed
    return Column(name=TIME, label=TIME, unit="s", measure=TIME, values=passed)


def _speed_of(motion: Motion) -> str:
    """An example of a speed for this input."""
    unit = motion.input_units[lead_of(motion)]
    return "60 rpm" if unit == motion.units.angle.value else f"50 {unit}/s" if unit else "50"


# ----------------------------------------------------------------------
# Rows of a motion as lines, broken at missing positions, gaps and jumps of angles.


_DEAD = LimitKind.DEAD_POINT.word
_FURTHER = 1.5  # steps of the table: rows further apart are not neighbours
_SINGULAR = (_DEAD, LimitKind.CHANGE_POINT.word, LimitKind.UNKNOWN.word)


def breaks(motion: Motion, lead: Array, *columns: Column) -> BoolArray:
    """Whether the line between neighbouring rows is interrupted, shape (N - 1,).

    It is between rows on different branches, between rows whose inputs differ by more than the
    table's step, and between two dead points without a row between them. An angle jumps if its
    change differs by more than half a turn from that predicted by its derivative.

    Parameters
    ----------
    lead : array (N,)
        The leading input, in file units.
    """
    branch = np.array(motion.branch)
    dead = np.array(motion.limit) == _DEAD
    found: BoolArray = (branch[1:] != branch[:-1]) | (dead[1:] & dead[:-1])
    steps = np.abs(np.diff(lead[motion.asked]))
    if len(steps):
        found |= np.abs(np.diff(lead)) > _FURTHER * steps.max()
    for column in columns:
        if column.turn and column.slope is not None:
            found |= _jumps(column, column.slope, np.diff(lead))
    return found


def _jumps(column: Column, slope: Array, dx: Array) -> BoolArray:
    dy = np.diff(column.values)
    # the first finite one of both ends; none at a dead point
    ahead, behind = slope[:-1], slope[1:]
    steady = np.where(np.isfinite(ahead), ahead, behind)
    expected = np.where(np.isfinite(steady), steady, 0.0) * dx
    half = 0.5 * column.turn
    jumps: BoolArray = (np.abs(dy) > half) & (np.abs(dy - expected) > half)
    return jumps


def broken(values: Array, where: BoolArray) -> Array:
    """Values (N,) with NaN inserted between the rows marked in ``where`` (N - 1,)."""
    return np.insert(values, np.flatnonzero(where) + 1, np.nan)


def runs(x: Array, y: Array) -> Iterator[tuple[Array, Array]]:
    """The pieces of a line between NaN values."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], np.isfinite(x + y).astype(int), [0]))))
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        yield x[start:stop], y[start:stop]


def limit_marks(
    motion: Motion, across: Column, column: Column, tone: int
) -> tuple[list[Mark], list[Rule]]:
    """Dead points, change points and extremes of a column: marks on it, or rules if it has no
    value.

    Derivatives and conditions have no value at a dead point; a rule shows the input.
    """
    marks: list[Mark] = []
    rules: list[Rule] = []
    for k, kind in enumerate(motion.limit):
        x, y = float(across.values[k]), float(column.values[k])
        word, _, of = kind.partition(" of ")
        if not kind or (of and of != column.name) or not np.isfinite(x):
            continue
        if np.isfinite(y):
            marks.append(Mark(x=x, y=y, tone=tone, kind=word))
        elif word in _SINGULAR:
            rules.append(Rule(along="x", at=x, kind=word))
    return marks, rules


# ----------------------------------------------------------------------
# Overlapping curves: the lower one is drawn wider, so that both are visible.


_NEAR = 0.004  # of the panel's sides: nearer curves cover each other
_LOOKED_AT = 100  # points of a curve checked for cover by another one
_HIDDEN = 0.4  # a curve with a larger covered share is drawn wider


def layered(curves: Sequence[Curve]) -> list[Curve]:
    """The curves, each with the number of later tones that cover much of it."""
    points = [np.stack([curve.x, curve.y], axis=1) for curve in curves]
    every = np.concatenate(points)
    if not np.isfinite(every).all(axis=1).any():
        return list(curves)
    size = np.nanmax(every, axis=0) - np.nanmin(every, axis=0)
    scaled = [line / np.where(size > 0.0, size, 1.0) for line in points]
    layered = []
    for k, curve in enumerate(curves):
        hiding = {
            other.tone
            for other, line in zip(curves, scaled, strict=True)
            if other.tone > curve.tone and _hidden_share(scaled[k], line) > _HIDDEN
        }
        layered.append(replace(curve, below=len(hiding)))
    return layered


def _hidden_share(line: Array, other: Array) -> float:
    """The share of points of a line (K, 2) on another line (M, 2)."""
    points = line[np.isfinite(line).all(axis=1)]
    points = points[:: max(1, len(points) // _LOOKED_AT)]
    start, step = other[:-1], np.diff(other, axis=0)
    ends = np.sort(np.stack([other[:-1, 0], other[1:, 0]]), axis=0)
    hidden = 0
    for point in points:
        # a curve of many turns has few sides near a point
        close = (ends[0] < point[0] + _NEAR) & (point[0] - _NEAR < ends[1])
        hidden += bool((_distances(point, start[close], step[close]) < _NEAR).any())
    return hidden / max(len(points), 1)


def _distances(point: Array, start: Array, step: Array) -> Array:
    """The distance of a point from sides (M, 2), (M,)."""
    offset = point - start
    squared = np.maximum((step**2).sum(axis=1), 1e-30)
    share = np.clip((offset * step).sum(axis=1) / squared, 0.0, 1.0)
    distances: Array = np.linalg.norm(offset - share[:, None] * step, axis=1)
    return distances
