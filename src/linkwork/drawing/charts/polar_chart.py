"""Columns of a motion as radii over an angle, usually that of the crank."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from linkwork.drawing.captions import reached_caption
from linkwork.drawing.charts.chart import Axis, Chart, Panel, Rule, Scale, Shape
from linkwork.drawing.charts.columns import abscissa_of, usual_columns
from linkwork.drawing.charts.labels import with_unit
from linkwork.drawing.charts.motion_chart import check_found, columns_of, shared_panels
from linkwork.drawing.charts.scales import angle_ends, round_step
from linkwork.foundation.errors import InputError
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind, Rate

__all__ = ["polar_chart"]

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
