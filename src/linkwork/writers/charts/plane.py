"""Charts in the plane: paths of points, and hodographs (paths of velocity vectors)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from inspect import signature
from typing import Any

import numpy as np

from linkwork.circuits.results import Circuits
from linkwork.core.drawing.matplotlib_writer import house_settings
from linkwork.core.drawing.pose import printed_name, printed_value, reached_caption
from linkwork.core.drawing.scene import THEMES, theme_named
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import find_spelling
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantities.rows import TRANSMISSION_ANGLE
from linkwork.core.results.quantity import Kind, Rate
from linkwork.writers.charts.axes import ChartAxes, chart_theme, tick_step
from linkwork.writers.charts.chart import Chart, Panel, abscissa_of, lead_of, rate_label, with_unit
from linkwork.writers.charts.kinds import (
    check_positions,
    motion_chart,
    polar_chart,
    transmission_chart,
)
from linkwork.writers.charts.lines import branch_chart, breaks, broken, circuit_chart

_APART = 0.09  # of the larger side: minimum distance of the texts of stations
_STATIONS = 9  # the largest number of stations, for angles up to a turn
_MARGIN = 0.12  # of the range of the paths, for the texts of stations
_TICKS = 6  # the largest number on a side
_FLATTEST, _TALLEST = 0.4, 1.15  # height-to-width ratio of a panel
_USUAL = 80  # percentile of the values used as reference
_BEYOND, _SHOWN = 4.0, 2.0  # multiples of the reference: unbounded curves, and their shown range


def path_chart(motion: Motion, points: Sequence[str] = ()) -> Chart:
    """The paths of points, with stations at round values of the input.

    Parameters
    ----------
    points : sequence of str
        By default the traced points.

    Raises
    ------
    InputError
        If no position was found, or the mechanism has no points.
    UnknownNameError
        If a point does not exist.
    """
    check_positions(motion)
    names = _points(motion, points)
    paths = {name: motion.trace(name) for name in names}
    labels = with_unit("x", motion.units.length), with_unit("y", motion.units.length)
    return _chart(motion, [_panel(motion, paths, labels)], names)


def hodograph_chart(motion: Motion, points: Sequence[str] = ()) -> Chart:
    """Velocities and accelerations of points as vectors from a pole, and the paths of their tips.

    Without an input speed, these are the derivatives with respect to the input.

    Parameters
    ----------
    points : sequence of str
        By default the first traced point.

    Raises
    ------
    InputError
        If no position was found, or the mechanism has no points.
    UnknownNameError
        If a point does not exist.
    """
    check_positions(motion)
    names = _points(motion, points)[: None if points else 1]
    by_time = motion.speed is not None
    rates = (Rate.VELOCITY, Rate.ACCELERATION) if by_time else (Rate.FIRST, Rate.SECOND)
    panels = []
    for rate in rates:
        paths = {name: motion.trace(f"{name}.{rate.value}") for name in names}
        unit = rate.unit(Kind.LENGTH, motion.units, motion.derivative_unit)
        x, y = (with_unit(_component(motion, rate, axis), unit) for axis in "xy")
        panels.append(_panel(motion, paths, (x, y), _title(motion, rate, names), pole=True))
    return _chart(motion, panels, names)


def _points(motion: Motion, requested: Sequence[str]) -> list[str]:
    if not motion.points:
        raise InputError(f'"{motion.mechanism}" has no points to plot: add [points]')
    usual = motion.skeleton.traced or _moving(motion)
    names = [find_spelling(name, motion.points) for name in requested or usual]
    for name in names:
        if name not in motion.points:
            known = choices("points", motion.points, name)
            raise UnknownNameError(f'there is no point "{name}" {known}')
    return list(dict.fromkeys(names))


def _moving(motion: Motion) -> tuple[str, ...]:
    """The last moving point."""
    fixed = set(motion.skeleton.fixed)
    return tuple(name for name in motion.points if name not in fixed)[-1:] or (
        next(iter(motion.points)),
    )


def _component(motion: Motion, rate: Rate, axis: str) -> str:
    if rate.by_time:
        return f"{'v' if rate is Rate.VELOCITY else 'a'}{'ₓ' if axis == 'x' else 'ᵧ'}"
    return rate_label(axis, rate, lead_of(motion))


def _title(motion: Motion, rate: Rate, names: Sequence[str]) -> str:
    if len(names) > 1:
        return {Rate.VELOCITY: "velocity", Rate.ACCELERATION: "acceleration"}.get(rate, "")
    return rate_label(names[0], rate, lead_of(motion))


def _chart(motion: Motion, panels: Sequence[Panel], names: Sequence[str]) -> Chart:
    lead = printed_name(lead_of(motion))
    where = reached_caption(motion)
    caption = where if lead in where else f"{lead} {where}"
    if len(panels) == len(names) == 1:
        caption = f"path of {printed_name(names[0])}, {caption}"
    return Chart(
        title=motion.mechanism,
        caption=caption,
        panels=tuple(panels),
        columns=len(panels),
        projection="plane",
    )


def _panel(
    motion: Motion,
    paths: Mapping[str, ComplexArray],
    labels: tuple[str, str],
    title: str = "",
    *,
    pole: bool = False,
) -> Panel:
    view = _View.of(motion, [*paths.values(), np.zeros(int(pole), complex)])
    return Panel(
        label=labels[1],
        draw=partial(_draw, motion, paths, view, labels, title, pole),
        ratio=min(max(view.half.imag / view.half.real, _FLATTEST), _TALLEST),
    )


@dataclass(frozen=True, kw_only=True)
class _View:
    """The area of a plane: all paths, or of unbounded paths the part near their middle.

    Parameters
    ----------
    middle, size
        Middle and larger side.
    half : complex
        Half of both sides, with room for texts.
    """

    middle: complex
    size: float
    half: complex

    @classmethod
    def of(cls, motion: Motion, paths: Sequence[ComplexArray]) -> _View:
        every = np.concatenate(paths)
        every = every[np.isfinite(every)]
        if not len(every):
            return cls._around(0j, 1 + 1j)
        if "dead point" in motion.limit or "change point" in motion.limit:
            middle = complex(np.median(every.real), np.median(every.imag))
            away = np.abs(every - middle)
            usual = float(np.percentile(away, _USUAL))
            if away.max() > _BEYOND * usual > 0.0:
                return cls._around(middle, 2 * _SHOWN * usual * (1 + 1j))
        low = complex(every.real.min(), every.imag.min())
        high = complex(every.real.max(), every.imag.max())
        return cls._around(0.5 * (low + high), high - low)

    @classmethod
    def _around(cls, middle: complex, sides: complex) -> _View:
        size = max(sides.real, sides.imag) or 1.0
        return cls(middle=middle, size=size, half=0.5 * sides + _MARGIN * size * (1 + 1j))

    def shows(self, place: complex) -> bool:
        away = place - self.middle
        return abs(away.real) < self.half.real and abs(away.imag) < self.half.imag


def _draw(
    motion: Motion,
    paths: Mapping[str, ComplexArray],
    view: _View,
    labels: tuple[str, str],
    title: str,
    pole: bool,
    axes: ChartAxes,
) -> None:
    """Paths with their limits and with stations, to one scale."""
    ax = axes.ax
    ax.set_aspect("equal", adjustable="datalim")
    where = breaks(motion, motion.inputs[lead_of(motion)])
    texts: list[complex] = []
    for tone, (name, path) in enumerate(paths.items(), start=1):
        x, y = broken(path.real, where), broken(path.imag, where)
        axes.curve(x, y, printed_name(name), tone, legend=len(paths) > 1)
        for kind in ("dead point", "change point"):
            rows = (np.array(motion.limit) == kind) & np.isfinite(path)
            if rows.any():
                axes.marks(path.real[rows], path.imag[rows], kind, tone)
        stations = [(k, text) for k, text in _stations(motion) if np.isfinite(path[k])]
        axes.stations(np.array([path[k] for k, _ in stations], dtype=complex), tone)
        for k, text in stations:
            away = _outwards(path, k, complex(np.nanmean(path)))
            place = complex(path[k]) + 0.5 * _APART * view.size * away
            if view.shows(place) and all(abs(place - t) > _APART * view.size for t in texts):
                texts.append(place)
                axes.station_text(text, complex(path[k]), away)
    if pole:
        axes.pole()
    axes.labels(*labels, title)
    ends = (view.middle - view.half, view.middle + view.half)
    ax.dataLim.set_points(np.array([(end.real, end.imag) for end in ends]))
    ax.margins(0.0)
    ax.locator_params(nbins=_TICKS)


def _outwards(path: ComplexArray, k: int, middle: complex) -> complex:
    """The unit normal of a path, pointing away from its middle."""
    around = [path[j] for j in (k - 1, k, k + 1) if 0 <= j < len(path) and np.isfinite(path[j])]
    tangent = around[-1] - around[0]
    normal = 1j * tangent / abs(tangent) if abs(tangent) else 0j
    outward = path[k] - middle
    if not abs(normal):
        return complex(outward / abs(outward)) if abs(outward) else 1 + 0j
    return complex(normal if (outward * normal.conjugate()).real >= 0 else -normal)


def _stations(motion: Motion) -> Iterator[tuple[int, str]]:
    """Rows at round values of the leading input, with these values; rounder ones first."""
    across = abscissa_of(motion)
    values, rows = across.values, motion.asked & motion.found
    span = float(np.ptp(values[motion.asked]))
    if not span:
        return
    step = tick_step(span, _STATIONS, motion.units.angle if across.turn else None)
    on = [k for k in np.flatnonzero(rows) if _multiple(float(values[k]), step)]
    for k in sorted(on, key=lambda k: not _multiple(float(values[k]), 2 * step)):
        yield (
            int(k),
            printed_value(round(float(values[k]) / step) * step, across.unit, motion.units),
        )


def _multiple(value: float, step: float) -> bool:
    return bool(abs(value / step - round(value / step)) < 1e-6)


# ----------------------------------------------------------------------
# The chart of a kind of plot, and plots for notebooks and scripts.
#
# ``motion.plot`` and ``circuits.plot`` draw these charts with :func:`plot`. New figures
# belong to pyplot, so that notebooks and ``matplotlib.pyplot.show`` display them.


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
