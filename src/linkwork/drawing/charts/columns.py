"""Columns of a motion, ready to be drawn: what they are called, measured in, spread over."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from linkwork.drawing.captions import printed_name
from linkwork.drawing.charts.chart import Pen, Scale
from linkwork.drawing.charts.labels import rate_label, size_label
from linkwork.foundation.arrays import Array
from linkwork.foundation.errors import InputError
from linkwork.foundation.names import find_spelling
from linkwork.results.motion import Motion
from linkwork.results.quantities.asked import Asked, Group
from linkwork.results.quantity import Kind, Rate

__all__ = ["TIME", "Column", "abscissa_of", "column_of", "lead_of"]

#: What ``against`` calls the time.
TIME = "time"

#: Columns of a table that are text.
_TEXTS = ("status", "certified", "branch", "limit")

#: Numbers about a position that are not drawn as lines over a logarithmic axis.
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
        As the motion spells it, ``theta13.d1``.
    label, unit : str
        As printed without the unit, and the unit as tables write it.
    measure : str
        What it measures, in a word: ``angle``, ``length``, ``velocity``; columns of one measure
        and unit share a panel. "" for numbers that share it with nothing.
    values : array (N,)
        File units, NaN where there is no position.
    turn : float
        A full turn in that unit, 0 if it is no angle.
    slope : array (N,), optional
        Of an angle that may jump: its derivative by the input, both as they are counted here.
    size : float
        What is large for it: differences of a billionth are rounding.
    scale, pen
        How it is spread along an axis and drawn.
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
        """Whether it is a derivative: these grow beyond all limits at dead points."""
        return Rate.split(self.name)[1] is not None


def lead_of(motion: Motion) -> str:
    """The leading input: the first one that changes from row to row."""
    rows = motion.asked
    moving = (name for name, values in motion.inputs.items() if np.ptp(values[rows]))
    return next(moving, next(iter(motion.inputs)))


def column_of(motion: Motion, name: str) -> Column:
    """A column by its name: quantity, input, coordinate, rate, or ``residual`` and the like.

    ``B.velocity`` is the length of the vector, of a point B.

    Raises
    ------
    UnknownNameError
        With the names that exist; for rates by time, with what to add.
    InputError
        If the column is text, or a point has to be followed by one of its coordinates.
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
    """A number about positions, of those found."""
    scale, pen = _EVIDENCE.get(asked.name, (Scale.LOG, Pen.LINE))
    shown = motion.found
    if asked.name == "condition":  # infinite at dead points but for rounding
        shown = shown & ~np.isin(motion.limit, ("dead point", "change point"))
    values = np.where(shown, motion[asked.name].astype(float), np.nan)
    label = asked.name.replace("_", " ")
    return Column(
        name=asked.name, label=label, unit="", measure="", values=values, scale=scale, pen=pen
    )


def _rate(motion: Motion, asked: Asked, rate: Rate) -> Column:
    """A rate of a quantity, or the length of a point's."""
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
    """How far the mechanism's points are from each other: the size of its lengths."""
    places = [series.value for pair in motion.points.values() for series in pair]
    found = [p[np.isfinite(p)] for p in places]
    return max((float(np.ptp(p)) for p in found if len(p)), default=0.0) or 1.0


def abscissa_of(motion: Motion, against: str = "") -> Column:
    """What a motion is drawn over: the leading input, ``time``, or any column.

    Raises
    ------
    InputError
        If the time is not known, or as :func:`column_of`.
    """
    if not against:
        return column_of(motion, lead_of(motion))
    if against == TIME and TIME not in motion.quantities.own:
        return _time(motion)
    return column_of(motion, against)


def _time(motion: Motion) -> Column:
    """Time from the first row on, while the leading input moves at its speed."""
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
    """A speed as one would write it for this input."""
    unit = motion.input_units[lead_of(motion)]
    return "60 rpm" if unit == motion.units.angle.value else f"50 {unit}/s" if unit else "50"
