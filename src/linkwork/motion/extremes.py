"""Extremes of an output: positions at which its derivative with respect to the input is zero.

Rates, efforts and forces have no second derivative: they are compared at more and more positions.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.errors import InputError
from linkwork.foundation.names import as_names
from linkwork.foundation.rounding import EPSILON
from linkwork.foundation.status import Status
from linkwork.motion.drive import Drive
from linkwork.motion.limits import BranchEnd
from linkwork.motion.model import Model
from linkwork.motion.named_quantities import RowValues
from linkwork.numerics.continuation.branch_tracking import Track, rows_on_track
from linkwork.results.limit import OutputLimit
from linkwork.results.quantities.asked import Asked, Group
from linkwork.results.quantities.located_rows import columns_of, locate_rows

__all__ = ["check_quantities", "output_limit_at", "output_limits"]

_NEAR = 1e-6  # of the leader: extremes of values alone are known so well
_AT_ONCE = 1e-12  # of the leader: a quantity and the input that turn back so near turn back at once


def check_quantities(model: Model, names: str | Iterable[str]) -> tuple[str, ...]:
    """One name or several, all of them of quantities of positions.

    Raises
    ------
    UnknownNameError
        With the names that exist.
    InputError
        For values that are no names, and for numbers about how a position was found.
    """
    names = as_names("the quantities", names)
    for name in names:
        asked = model.quantities.find(name)
        if asked.group is Group.EVIDENCE:
            raise InputError(
                f'limits of "{name}" are not known: it measures how a position was found'
            )
        asked.check_rate(model.speed)
    return names


def output_limits(drive: Drive, track: Track, name: str) -> list[tuple[float, OutputLimit]]:
    """Where a quantity is largest or smallest along a track.

    The quantity's derivative changes sign between two nodes; Newton-Raphson on it, kept inside the
    sign change, finds the place.

    Returns
    -------
    list of (t, limit)
    """
    t = np.unique([node.t for node in track.nodes])
    # between the nodes of a bold track a quantity may turn twice
    t = np.unique(np.concatenate([t, *(t[:-1] + s * np.diff(t) for s in (0.25, 0.5, 0.75))]))
    if len(t) < 2:
        return []
    asked = drive.model.quantities.find(name)
    if asked.needs:
        return list(_limits_by_values(drive, track, asked, t))
    search = _Search(drive, track, name)
    rate = search.at(t)[1]
    found = []
    for k in np.flatnonzero(rate[:-1] * rate[1:] < 0.0):
        here, error = search.between(float(t[k]), float(t[k + 1]), float(rate[k]))
        value, _, second, condition = (float(part[0]) for part in search.at(np.array([here])))
        # the derivative is known to its rounding only
        size = max(abs(float(rate[k])), abs(float(rate[k + 1])), abs(second))
        # errors of the position, magnified by the condition, shift the zero of the derivative
        noise = 8.0 * EPSILON * condition * size
        error = max(error, noise / abs(second)) if second else np.inf
        unit = drive.unit
        limit = OutputLimit(
            name=name,
            kind="maximum" if second < 0.0 else "minimum",
            input=float(here / unit),
            value=value,
            bracket=(float((here - error) / unit), float((here + error) / unit)),
            # a flat extreme is known by its value, hardly by its input
            located=bool(error <= 1e-9 * max(1.0, abs(here))),
        )
        found.append((here, limit))
    return found


def output_limit_at(drive: Drive, end: BranchEnd, name: str) -> OutputLimit | None:
    """A quantity's extreme at a dead point, if it rests there together with the input.

    The quantity's derivative by the input does not vanish there; that by the variable that leads
    through the dead point does.
    """
    if end.led is None or end.node is None or drive.model.quantities.find(name).needs:
        return None
    led, node, model = end.led, end.node, drive.model
    v, first, second = (led.whole(x)[None, :] for x in (node.v, node.first, node.second))
    series = RowValues(model, v, first, second, np.ones(1, dtype=bool)).series(name)
    rate, bend = float(series.first[0]), float(series.second[0])
    noise = 8.0 * EPSILON * node.condition * float(np.abs(series.first[0]) + np.abs(bend))
    # how far the leader would still have to move for the rate to vanish
    away = (abs(rate) + noise) / abs(bend) if bend else np.inf
    if not away <= _AT_ONCE * led.path.size * max(1.0, node.condition):
        return None
    return OutputLimit(
        name=name,
        kind="maximum" if bend < 0.0 else "minimum",
        input=end.limit.input,
        value=float(series.value[0]),
        bracket=end.limit.bracket,
        located=end.limit.located,
    )


class _Search:
    """A quantity along a track: value, first and second derivative by the leading input, and the
    condition of the positions.
    """

    def __init__(self, drive: Drive, track: Track, name: str) -> None:
        self.drive, self.track, self.name = drive, track, name

    def at(self, t: Array) -> tuple[Array, Array, Array, Array]:
        """At the values t (B,)."""
        model = self.drive.model
        rows = rows_on_track(self.drive.solver, self.drive.path, self.track, t)
        good = rows.status == Status.CONVERGED.code
        series = RowValues(model, rows.v, rows.first, rows.second, good).series(self.name)
        return series.value, series.first, series.second, rows.condition

    def between(self, low: float, high: float, rate: float) -> tuple[float, float]:
        """Where the derivative is zero, and how far from it that may be."""
        here = best = 0.5 * (low + high)
        least, error = np.inf, high - low
        for _ in range(60):
            _, first, second, _ = (float(part[0]) for part in self.at(np.array([here])))
            if not np.isfinite(first):
                break
            step = -first / second if second else np.inf
            tiny = 4.0 * EPSILON * max(1.0, abs(here))
            if abs(first) < least:
                best, least, error = here, abs(first), abs(step)
            elif abs(step) < 1e-9:
                break  # to rounding
            if abs(step) <= tiny:
                break
            if first * rate > 0.0:
                low = here
            else:
                high = here
            here = here + step if low < here + step < high else 0.5 * (low + high)
        return best, max(error, 4.0 * EPSILON * max(1.0, abs(best)))


class _TrackRows(RowValues):
    """Quantities of positions on a track."""

    @property
    def found(self) -> BoolArray:
        """Whether a row has a position, (B,)."""
        return np.logical_not(self.lost)


@dataclass(frozen=True, eq=False)
class _OnTrack:
    """Solves positions between three values of t on a track."""

    drive: Drive
    track: Track

    @property
    def joined(self) -> BoolArray:
        """All of them."""
        return np.ones(2, dtype=bool)

    @property
    def switches(self) -> Array:
        """None: limits are those of quantities of positions alone."""
        return np.zeros(0)

    @property
    def far(self) -> float:
        """Tracks show their extremes themselves."""
        return np.inf

    def __call__(self, row: IndexArray, at: Array) -> _TrackRows:
        """At the values t (B,)."""
        rows = rows_on_track(self.drive.solver, self.drive.path, self.track, at)
        good = rows.status == Status.CONVERGED.code
        return _TrackRows(self.drive.model, rows.v, rows.first, rows.second, good)


def _limits_by_values(
    drive: Drive, track: Track, asked: Asked, t: Array
) -> Iterator[tuple[float, OutputLimit]]:
    """The extremes of a quantity whose second derivative is not known, next to values of t."""
    between, speed, unit = _OnTrack(drive, track), drive.model.speed, drive.unit
    solved = between(np.zeros(len(t), dtype=np.intp), t)
    for word, side in (("max", 1.0), ("min", -1.0)):
        number = drive.model.quantities.find_of_motion(f"{word}({asked.name})")
        columns = [np.broadcast_to(x, len(t)) for x in columns_of(number, solved, speed)]
        f = side * columns[0]
        higher = (f[1:-1] >= f[:-2]) & (f[1:-1] >= f[2:])
        bent = 2.0 * f[1:-1] - f[:-2] - f[2:] > 16.0 * EPSILON * np.abs(f[1:-1])
        for k in np.flatnonzero(higher & bent) + 1:
            part = slice(k - 1, k + 2)
            own = number.rows(t[part], *(column[part] for column in columns))
            rows = locate_rows(number, own, between, speed).rows
            best = int(np.clip((side * rows.value).argmax(), 1, len(rows.input) - 2))
            if np.isinf(rows.value[best]):
                continue  # a pole
            here = float(rows.input[best])
            # the last correction: a flat extreme is known by its value, hardly by its input
            error = float(np.abs(rows.input[[best - 1, best + 1]] - here).min())
            yield (
                here,
                OutputLimit(
                    name=asked.name,
                    kind="maximum" if side > 0.0 else "minimum",
                    input=here / unit,
                    value=float(rows.value[best]),
                    bracket=((here - error) / unit, (here + error) / unit),
                    located=error <= _NEAR * max(1.0, abs(here)),
                ),
            )
