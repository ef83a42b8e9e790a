"""Columns of a motion for charts: labels, units and scales."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.core.drawing.pose import printed_name
from linkwork.core.foundation.arrays import Array
from linkwork.core.foundation.errors import InputError
from linkwork.core.foundation.names import find_spelling, pretty
from linkwork.core.results.listing.motion_listing import coordinates_off_ground
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.definition import Asked, Group
from linkwork.core.results.quantity import Kind, Rate

#: Name of the time in ``against``.
TIME = "time"

#: Text columns of a table.
_TEXTS = ("status", "certified", "branch", "limit")

#: Scales of evidence that is scattered; other evidence is drawn as lines over a logarithmic axis.
_SCATTERED = {"residual": "rounding", "iterations": "count"}

# ----------------------------------------------------------------------
# Labels of columns in figures: ``θ₁₃ [deg]``, ``ds₁₆/dθ₁₂ [mm/rad]``.


def with_unit(text: str, unit: str) -> str:
    """``ds₁₆/dθ₁₂ [mm/rad]``; without brackets if there is no unit."""
    printed = unit.replace("^2", "²").replace("^3", "³").replace("^4", "⁴")
    return f"{text} [{printed}]" if unit.replace("^2", "") not in ("", "1/1") else text


def rate_label(name: str, rate: Rate, driver: str) -> str:
    """A rate of a quantity: ``ds₁₆/dθ₁₂``, ``velocity of s₁₆``; ``driver`` is the input."""
    if rate.by_time:
        return f"{rate.value} of {printed_name(name)}"
    power = "" if rate.order == 1 else "²"
    return f"d{power}{_term(name)}/d{_term(driver)}{power}"


def size_label(point: str, rate: Rate, driver: str) -> str:
    """The magnitude of a point's rate: ``|velocity of B|``."""
    return f"|{rate_label(point, rate, driver)}|"


def _term(name: str) -> str:
    """A name after the d of a derivative; words are separated by a space."""
    stem = pretty(name).partition(".")[0].rstrip("0123456789'")
    return printed_name(name) if len(stem) == 1 else f" {printed_name(name)}"


# ----------------------------------------------------------------------
# Columns.


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
        share a panel. "" for numbers with a separate panel.
    values : array (N,)
        File units, NaN where there is no position.
    turn : float
        A full turn in that unit, 0 unless it is an angle.
    slope : array (N,), optional
        For an angle that may jump: its derivative with respect to the input, in these units.
    size : float
        Typical size: differences below 1e-9 of it are rounding.
    scale : str
        Scale of its axis, as in :func:`linkwork.writers.charts.axes.set_scale`.
    dots : bool
        Whether neighbouring rows have nothing to do with each other: no line joins them.
    """

    name: str
    label: str
    unit: str
    measure: str
    values: Array
    turn: float = 0.0
    slope: Array | None = None
    size: float = 1.0
    scale: str = "linear"
    dots: bool = False

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
        If the motion has none of these.
    """
    traced = [f"{point}.{axis}" for point in motion.skeleton.traced for axis in "xy"]
    names = tuple(motion.unknowns) or tuple(motion.outputs) or tuple(traced)
    names = names or coordinates_off_ground(motion)
    if not names:
        raise InputError(f'"{motion.mechanism}" has no unknowns: name the columns to plot')
    return names


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
    known = motion.quantities.own
    if point in motion.points and find_spelling(name, known) not in known:
        raise InputError(
            f'"{point}" is a point: plot a coordinate, "{point}.x" or "{point}.y", or its '
            'path, kind="path" (--kind path)'
        )
    quantity = motion.quantity(name)
    if quantity.group is Group.EVIDENCE:
        return _evidence(motion, quantity)
    if quantity.rate is not None:
        return _rate(motion, quantity, quantity.rate)
    units, kind, lead = motion.units, quantity.own.kind, lead_of(motion)
    turn = units.angle.turn if kind is Kind.ANGLE else 0.0
    slope = None
    if quantity.group is not Group.INPUT and kind is Kind.ANGLE:
        by_input = 1.0 if motion.input_units[lead] != units.angle.value else units.angle.radians
        slope = quantity.jet(motion).d1 * by_input / units.scale(kind)
    return Column(
        name=quantity.name,
        label=printed_name(quantity.name),
        unit=quantity.unit,
        measure=quantity.measure,
        values=motion[quantity.name],
        turn=turn,
        slope=slope,
        size=turn or (_reach(motion) if kind is Kind.LENGTH else 1.0),
    )


def _evidence(motion: Motion, quantity: Asked) -> Column:
    """A number of the evidence of positions."""
    shown = motion.found
    if quantity.name == "condition":  # infinite at dead points, up to rounding
        shown = shown & ~np.isin(motion.limit, ("dead point", "change point"))
    values = np.where(shown, motion[quantity.name].astype(float), np.nan)
    label = quantity.name.replace("_", " ")
    return Column(
        name=quantity.name,
        label=label,
        unit="",
        measure="",
        values=values,
        scale=_SCATTERED.get(quantity.name, "log"),
        dots=quantity.name in _SCATTERED,
    )


def _rate(motion: Motion, quantity: Asked, rate: Rate) -> Column:
    """A rate of a quantity, or its magnitude for a point."""
    base, of_point = quantity.own, quantity.group is Group.POINT
    size = _reach(motion) if base.kind is Kind.LENGTH else 1.0
    return Column(
        name=quantity.name,
        label=(size_label if of_point else rate_label)(base.name, rate, lead_of(motion)),
        unit=quantity.unit,
        measure=quantity.measure,
        values=motion[quantity.name],
        size=size * abs(motion.speed or 1.0) ** (rate.order if rate.by_time else 0),
    )


def _reach(motion: Motion) -> float:
    """The typical length: the extent of the mechanism's points."""
    places = [series.value for pair in motion.points.values() for series in pair]
    finite = [p[np.isfinite(p)] for p in places]
    return max((float(np.ptp(p)) for p in finite if len(p)), default=0.0) or 1.0


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
            f"a plot over time needs the speed of {lead}: set it in [input], or plot against {lead}"
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
