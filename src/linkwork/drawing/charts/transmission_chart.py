"""Transmission angles over the input, with the recommended range."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from linkwork.drawing.captions import printed_name, reached_caption
from linkwork.drawing.charts.chart import Axis, Band, Chart
from linkwork.drawing.charts.columns import Column, abscissa_of, column_of
from linkwork.drawing.charts.labels import with_unit
from linkwork.drawing.charts.motion_chart import across_axis, check_found, shared_panels
from linkwork.foundation.angles import AngleUnit
from linkwork.foundation.errors import InputError, UnknownNameError, choices
from linkwork.foundation.names import find_spelling
from linkwork.mechanism.dyad import Dyad, dyads_of
from linkwork.results.motion import Motion
from linkwork.results.quantities.transmission import RECOMMENDED, TRANSMISSION_ANGLE

__all__ = ["transmission_chart"]

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
