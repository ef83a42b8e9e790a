"""Dwells: ranges of the input over which a quantity stays within a band.

The dwell is the longest range of the input over which the quantity stays within a band of the
given height, wherever this band lies. Between rows the quantity is the cubic through values and
derivatives at the rows, evaluated at eighths of their distance and linear between these. A motion
of one whole turn continues from its end at its start.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array, IndexArray
from linkwork.results.quantities.definition import MotionQuantity, MotionRows, cubic

__all__ = ["DWELL"]

_PARTS = 8  # of the distance between rows


def _longest(rows: MotionRows, numbers: tuple[float, ...]) -> Array:
    """How long it is, in the unit of the input in files."""
    begin, end = _range(rows, numbers[0])
    found: Array = (end - begin) / rows.unit
    return found


def _start(rows: MotionRows, numbers: tuple[float, ...]) -> Array:
    """Where it begins, in the unit of the input in files."""
    return _range(rows, numbers[0])[0] / rows.unit


def _range(rows: MotionRows, band: float) -> tuple[Array, Array]:
    """Between which inputs the quantity stays within the band for longest, (…,) each."""
    shape = rows.value.shape[:-1]
    up = rows.ascending()
    if up is None or len(up.input) < 2:
        return np.full(shape, np.nan), np.full(shape, np.nan)
    flat = [x.reshape(-1, len(up.input)) for x in (up.value, up.first)]
    u, f = _fine(up.input, *flat)
    cycle = np.broadcast_to(up.cycle, shape).reshape(-1)
    once = len(u)
    if cycle.any():
        # a dwell may go on across the end of the turn
        u = np.concatenate([u, u[1:] + up.turn])
        again = np.where(cycle[:, None], f[:, 1:], np.nan)
        f = np.concatenate([f, again], axis=1)
    count = np.minimum(_counts(f, band), once)
    width = np.where(np.isnan(f), -1.0, u[np.arange(f.shape[1]) + count - 1] - u)
    # places of the second turn only serve ranges that begin in the first
    width[:, once:] = -1.0
    width[cycle, 0] = -1.0  # the same place as a turn later, where what is before it is known
    start = width.argmax(axis=1)
    begin, end = _ends(u, f, start, np.take_along_axis(count, start[:, None], 1)[:, 0], band)
    full = end - begin >= u[once - 1] - u[0]
    begin, end = np.where(full, u[0], begin), np.where(full, u[once - 1], end)
    lost = np.isnan(f).all(axis=1)
    begin, end = (np.where(lost, np.nan, x).reshape(shape) for x in (begin, end))
    return begin, end


def _fine(u: Array, value: Array, first: Array) -> tuple[Array, Array]:
    """Inputs (F,) and values (D, F) at parts of the distances between rows."""
    step = np.diff(u)
    s = np.arange(_PARTS) / _PARTS
    ends = value[:, :-1, None], value[:, 1:, None]
    slopes = ((step * x)[..., None] for x in (first[:, :-1], first[:, 1:]))
    begin, end = (np.where(np.isfinite(x), x, ends[1] - ends[0]) for x in slopes)
    inner = cubic(s, ends, (begin, end))
    inner[..., 0] = value[:, :-1]
    places = (u[:-1, None] + s * step[:, None]).reshape(-1)
    fine = inner.reshape(len(value), -1)
    return np.append(places, u[-1]), np.concatenate([fine, value[:, -1:]], axis=1)


def _counts(f: Array, band: float) -> IndexArray:
    """How many values from each one on stay within a band, (D, F): by doubling, then by halving."""
    highs, lows = [f], [f]
    while 2 ** len(highs) <= f.shape[1]:
        half = 2 ** (len(highs) - 1)
        highs.append(np.maximum(highs[-1][:, :-half], highs[-1][:, half:]))
        lows.append(np.minimum(lows[-1][:, :-half], lows[-1][:, half:]))
    here = np.arange(f.shape[1])
    count = np.ones(f.shape, dtype=np.intp)
    high, low = f, f
    for k in reversed(range(len(highs))):
        ahead = here + count
        inside = ahead < highs[k].shape[1]
        ahead = np.where(inside, ahead, 0)
        more_high = np.maximum(high, np.take_along_axis(highs[k], ahead, axis=1))
        more_low = np.minimum(low, np.take_along_axis(lows[k], ahead, axis=1))
        longer = inside & (more_high - more_low <= band)
        count = np.where(longer, count + 2**k, count)
        high, low = np.where(longer, more_high, high), np.where(longer, more_low, low)
    return count


def _ends(
    u: Array, f: Array, start: IndexArray, count: IndexArray, band: float
) -> tuple[Array, Array]:
    """Where the range begins and ends between values: where the quantity leaves the band."""
    rows = np.arange(len(f))
    inside = (np.arange(f.shape[1]) >= start[:, None]) & (
        np.arange(f.shape[1]) < (start + count)[:, None]
    )
    high = np.where(inside, f, -np.inf).max(axis=1)
    low = np.where(inside, f, np.inf).min(axis=1)
    found = []
    for place, way in ((start, -1), (start + count - 1, 1)):
        beside = place + way
        known = (beside >= 0) & (beside < f.shape[1])
        beside = np.where(known, beside, place)
        here, there = f[rows, place], f[rows, beside]
        level = np.clip(there, high - band, low + band)
        part = (level - here) / np.where(there == here, np.inf, there - here)
        part = np.where(np.isfinite(part), part, 0.0)
        high, low = (np.fmax(high, level), np.fmin(low, level))
        found.append(u[place] + part * (u[beside] - u[place]))
    return found[0], found[1]


DWELL = (
    MotionQuantity(
        word="dwell",
        about="longest range of input within a band of this height",
        evaluate=_longest,
        numbers=("band",),
        needs=1,
        measures="input",
    ),
    MotionQuantity(
        word="dwell_start",
        about="input at which the longest dwell begins",
        evaluate=_start,
        numbers=("band",),
        needs=1,
        measures="input",
    ),
)
