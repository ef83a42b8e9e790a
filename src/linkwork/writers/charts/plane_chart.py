"""Charts in the plane: paths of points, and hodographs (paths of velocity vectors)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from linkwork.core.drawing.pose import printed_name, printed_value, reached_caption
from linkwork.core.foundation.arrays import ComplexArray
from linkwork.core.foundation.errors import InputError, UnknownNameError, choices
from linkwork.core.foundation.names import find_spelling
from linkwork.core.results.motion import Motion
from linkwork.core.results.quantity import Kind, Rate
from linkwork.writers.charts.chart import (
    Axis,
    Chart,
    Curve,
    Mark,
    Panel,
    Rule,
    Shape,
    across_step,
    rate_label,
    round_step,
    with_unit,
)
from linkwork.writers.charts.columns import abscissa_of, breaks, broken, lead_of
from linkwork.writers.charts.kinds import check_found

__all__ = ["hodograph_chart", "path_chart"]

_NO_AXIS = Axis(label="")
_APART = 0.09  # of the larger side: minimum distance of the texts of stations
_HIDDEN = 1e-3  # of the larger side: nearer dots cover each other
_STATIONS = 8  # approximate number for an input that is not an angle
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
    check_found(motion)
    names = _points(motion, points)
    paths = {name: motion.trace(name) for name in names}
    unit = motion.units.length
    panel = _plane(
        motion, paths, (with_unit("x", unit), with_unit("y", unit)), title="", pole=False
    )
    return _chart(motion, [panel], names)


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
    check_found(motion)
    names = _points(motion, points)[: None if points else 1]
    by_time = motion.speed is not None
    rates = (Rate.VELOCITY, Rate.ACCELERATION) if by_time else (Rate.FIRST, Rate.SECOND)
    panels = []
    for rate in rates:
        paths = {name: motion.trace(f"{name}.{rate.value}") for name in names}
        unit = rate.unit(Kind.LENGTH, motion.units, motion.derivative_unit)
        sides = [_component(motion, rate, axis) for axis in "xy"]
        labels = (with_unit(sides[0], unit), with_unit(sides[1], unit))
        title = _title(motion, rate, names)
        panels.append(_plane(motion, paths, labels, title=title, pole=True))
    return _chart(motion, panels, names)


def _points(motion: Motion, asked: Sequence[str]) -> list[str]:
    if not motion.points:
        raise InputError(f'"{motion.mechanism}" has no points to plot: add [points]')
    usual = motion.skeleton.traced or _moving(motion)
    names = [find_spelling(name, motion.points) for name in asked or usual]
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
    lead = lead_of(motion)
    told = printed_name(lead)
    where = reached_caption(motion)
    caption = where if told in where else f"{told} {where}"
    several = [printed_name(name) for name in names] if len(names) > 1 else []
    kinds = [mark.kind for panel in panels for mark in panel.marks if mark.kind != "station"]
    if len(panels) == 1 and not several:
        caption = f"path of {printed_name(names[0])}, {caption}"
    return Chart(
        title=motion.mechanism,
        caption=caption,
        axis=_NO_AXIS,
        panels=tuple(panels),
        columns=len(panels),
        legend=tuple(dict.fromkeys([*several, *kinds])),
    )


def _plane(
    motion: Motion,
    paths: dict[str, ComplexArray],
    labels: tuple[str, str],
    *,
    title: str,
    pole: bool,
) -> Panel:
    lead = motion.inputs[lead_of(motion)]
    where = breaks(motion, lead)
    curves = tuple(
        Curve(x=broken(z.real, where), y=broken(z.imag, where), tone=tone, name=printed_name(name))
        for tone, (name, z) in enumerate(paths.items(), start=1)
    )
    room = _room(motion, list(paths.values()), pole)
    told: list[complex] = []
    marks = [
        mark
        for tone, path in enumerate(paths.values(), start=1)
        for mark in (*room.limits(motion, path, tone), *room.stations(motion, path, tone, told))
    ]
    if pole:
        marks.append(Mark(x=0.0, y=0.0, tone=0, kind="pole"))
    rules = (Rule(along="x", at=0.0), Rule(along="y", at=0.0)) if pole else ()
    x_ends, y_ends = room.ends
    return Panel(
        axis=Axis(label=labels[1], ends=y_ends),
        across=Axis(label=labels[0], ends=x_ends),
        curves=curves,
        marks=tuple(marks),
        rules=rules,
        title=title,
        shape=Shape.PLANE,
    )


@dataclass(frozen=True, kw_only=True)
class _Room:
    """The area of a plane: all curves, or for unbounded curves the part near ``centre``."""

    centre: complex
    radius: float
    size: float

    @property
    def ends(self) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
        if not self.radius:
            return None, None
        (x, y), r = (self.centre.real, self.centre.imag), self.radius
        return (x - r, x + r), (y - r, y + r)

    def shows(self, place: complex) -> bool:
        return bool(np.isfinite(place)) and not 0 < self.radius < abs(place - self.centre)

    def limits(self, motion: Motion, path: ComplexArray, tone: int) -> Iterator[Mark]:
        """Dead points and change points on a path."""
        for k, kind in enumerate(motion.limit):
            if kind in ("dead point", "change point") and self.shows(path[k]):
                yield Mark(x=path[k].real, y=path[k].imag, tone=tone, kind=kind)

    def stations(
        self, motion: Motion, path: ComplexArray, tone: int, told: list[complex]
    ) -> Iterator[Mark]:
        """Stations on a path, labelled with the input where space permits.

        ``told`` are the positions of texts; those of this path are added.
        """
        found = np.isfinite(path)
        middle = complex(path[found].mean()) if found.any() else 0j
        dots: list[complex] = []
        for k, text in _stations(motion):
            here = complex(path[k])
            if not self.shows(here) or any(abs(here - d) < _HIDDEN * self.size for d in dots):
                continue
            dots.append(here)
            away = _outwards(path, k, middle)
            place = here + 0.5 * _APART * self.size * away
            free = all(abs(place - other) > _APART * self.size for other in told)
            told += [place] if free else []
            yield Mark(
                x=here.real,
                y=here.imag,
                tone=tone,
                kind="station",
                text=text if free else "",
                away=(away.real, away.imag),
            )


def _room(motion: Motion, paths: Sequence[ComplexArray], pole: bool) -> _Room:
    every = np.concatenate(paths)
    every = every[np.isfinite(every)]
    if pole:
        every = np.append(every, 0j)
    if not len(every):
        return _Room(centre=0j, radius=0.0, size=1.0)
    size = float(max(np.ptp(every.real), np.ptp(every.imag))) or 1.0
    centre = complex(np.median(every.real), np.median(every.imag))
    away = np.abs(every - centre)
    usual = float(np.percentile(away, _USUAL))
    singular = "dead point" in motion.limit or "change point" in motion.limit
    if not singular or away.max() <= _BEYOND * usual or not usual:
        return _Room(centre=centre, radius=0.0, size=size)
    return _Room(centre=centre, radius=_SHOWN * usual, size=2 * _SHOWN * usual)


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
    step = across_step(span, motion.units.angle) if across.turn else round_step(span / _STATIONS)
    on = [k for k in np.flatnonzero(rows) if _multiple(float(values[k]), step)]
    for k in sorted(on, key=lambda k: not _multiple(float(values[k]), 2 * step)):
        yield int(k), printed_value(_cleaned(float(values[k]), step), across.unit, motion.units)


def _multiple(value: float, step: float) -> bool:
    return bool(abs(value / step - round(value / step)) < 1e-6)


def _cleaned(value: float, step: float) -> float:
    return round(value / step) * step
