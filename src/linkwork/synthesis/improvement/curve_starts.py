"""Starts of a curve fit: of mechanisms drawn at random, those whose curves are most similar.

A drawn curve may be moved, turned and enlarged freely. With complex points q of the curve and z of
the goal the best such motion is a linear fit, eq. (154); its residual ranks the draws. Without
timing, points correspond by the shares of arc length at which they lie.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array, Batch, ComplexArray, IndexArray
from linkwork.core.foundation.units import FULL_TURN, arc_in_order
from linkwork.synthesis.improvement.curves import INPUT, CouplerCurves, CurveGoal, FourBarCurves

_SAMPLES = 72  # of a curve: five degrees
_PART = 128  # curves compared at a time
_SHARES = (0.08, 0.15, 0.25, 0.4, 0.6, 0.8)  # of the arc length, for a part of a curve
_RANGE_SHARES = (0.3, 0.6, 0.9)  # the same, of the driven range
_FARTHEST = 8.0  # sizes of the goal: how far A0 is drawn from it, where it is bounded


@dataclass(frozen=True, kw_only=True, eq=False)
class CurveStarts(Batch):
    """D starts.

    Parameters
    ----------
    x : (D, P)
        Dimensions.
    t : (D, N)
        Crank angles at the points, in the sense of ``way`` [rad].
    side, way : (D,)
        Signs of the loops, and of the crank's sense of rotation.
    missed : (D,)
        The sum of squares that the comparison leaves [length²].
    """

    x: Array
    t: Array
    side: Array
    way: Array
    missed: Array


def random_loops(kind: type[CouplerCurves], count: int, rng: np.random.Generator) -> Array:
    """Dimensions (D, P) with a crank that turns fully, A0 at 0 and B0 or the line near 1."""
    loops: list[Array] = []
    left = count
    while left > 0:
        drawn = 4 * left + 16
        size = np.exp(rng.normal(0.0, 0.8, (drawn, 3)))
        p, q = (size[:, 1] * rng.normal(0.0, 1.2, drawn) for _ in range(2))
        nothing = np.zeros(drawn)
        if kind is FourBarCurves:
            columns = [nothing, nothing, nothing + 1.0, nothing, *size.T, p + 0.5 * size[:, 1], q]
        else:
            offset = rng.normal(0.0, 0.5, drawn) * size[:, 0]
            columns = [nothing, nothing, size[:, 0], size[:, 1], offset, nothing, p, q]
        x = np.stack(columns, axis=1)
        turning = (kind(nothing + 1.0).limits(x)[0] < 0.0).all(axis=1)
        loops.append(x[turning][:left])
        left -= len(loops[-1])
    return np.concatenate(loops)


def best_starts(
    kind: type[CouplerCurves],
    goal: CurveGoal,
    count: int,
    keep: int,
    rng: np.random.Generator,
    tell: Callable[[float], None],
) -> tuple[CurveStarts, bool]:
    """The best of ``count`` draws, each driven both ways on both sides of its loop, and whether
    all were compared: an interruption keeps those so far, if there are any.
    """
    free = goal.is_placed_freely
    x = random_loops(kind, count, rng)
    if not free:
        x = _spread(kind, x, goal, rng)
    parts: list[CurveStarts] = []
    finished = False
    try:
        for begin in range(0, count, _PART):
            tell(begin / count)
            some = x[begin : begin + _PART]
            for side in (1.0, -1.0):
                parts += [_compared(kind, some, side, way, goal, free) for way in goal.ways]
        finished = True
    except KeyboardInterrupt:
        if not parts:
            raise
    every = CurveStarts.joined(parts)
    return every.take(np.argsort(every.missed, kind="stable")[:keep]), finished


def _spread(
    kind: type[CouplerCurves], x: Array, goal: CurveGoal, rng: np.random.Generator
) -> Array:
    """Draws moved, turned and enlarged at random near the goal, then into the box."""
    count = len(x)
    size = goal.size * np.exp(rng.normal(0.3, 0.8, count))
    factor = size * np.exp(1j * rng.uniform(0.0, FULL_TURN, count))
    away = rng.normal(0.0, 1.5, (2, count)) * goal.size
    box, dimensions = goal.box(kind), len(kind.names)
    moved = kind(np.ones(count)).moved(x, goal.points.mean() + away[0] + 1j * away[1], factor)
    return np.asarray(np.clip(moved, box.least[:dimensions], box.most[:dimensions]))


def _compared(
    kind: type[CouplerCurves], x: Array, side: float, way: float, goal: CurveGoal, free: bool
) -> CurveStarts:
    """The best correspondence of each draw with the goal."""
    angles = way * np.linspace(0.0, FULL_TURN, _SAMPLES, endpoint=False)
    count = len(x)
    curves = kind(np.full(count, side))
    along = np.broadcast_to(angles, (count, _SAMPLES))
    q = curves.points(x, along).guided
    turns = along
    if goal.inputs is None:
        q, turns = _by_arc_length(q, along, way)
    missed = np.full(count, np.inf)
    t = np.zeros((count, len(goal.points)))
    factor = np.ones(count, dtype=complex)
    shift = np.zeros(count, dtype=complex)
    for index in _correspondences(goal, way):
        wraps, inside = np.divmod(index, _SAMPLES)
        fitted = _fitted(q, inside, goal.points, free)
        if goal.range is not None:
            place = turns[:, inside] + way * FULL_TURN * wraps + np.angle(fitted[1])[:, :, None]
            ends = place.min(axis=2), place.max(axis=2)
            if goal.inputs is not None:
                # a common angle of the inputs, and their arc
                begin, extent = arc_in_order(goal.inputs)
                first = place[:, :, 0] + begin - goal.inputs[0]
                ends = first, first + extent
            _, outside = goal.turned_inside(*ends)
            # points that are driven back into the range miss by about as much
            fitted[0][:] += len(goal.points) * (goal.size * outside) ** 2
        best = fitted[0].argmin(axis=1)
        lanes = np.arange(count)
        better = fitted[0][lanes, best] < missed
        missed = np.where(better, fitted[0][lanes, best], missed)
        factor = np.where(better, fitted[1][lanes, best], factor)
        shift = np.where(better, fitted[2][lanes, best], shift)
        place = turns[lanes[:, None], inside[best]] + way * FULL_TURN * wraps[best]
        t = np.where(better[:, None], place, t)
    fine = np.isfinite(missed)
    x, t = x[fine], t[fine]
    if free:
        x = curves.take(fine).moved(x, shift[fine], factor[fine])
        t = t + np.angle(factor[fine])[:, None]
    signs = np.ones(len(x))
    return CurveStarts(x=x, t=way * t, side=side * signs, way=way * signs, missed=missed[fine])


def _correspondences(goal: CurveGoal, way: float) -> Iterator[IndexArray]:
    """Samples for the points of the goal, (K, N): every first sample, one share at a time."""
    first = np.arange(_SAMPLES)[:, None]
    if goal.inputs is not None:
        low, high = goal.input_bounds if INPUT in goal.bounds else (0.0, FULL_TURN)
        low, high = low * _SAMPLES / FULL_TURN, high * _SAMPLES / FULL_TURN
        if high - low < _SAMPLES:
            # at least the one nearest to the middle
            inner = np.arange(np.ceil(low), np.floor(high) + 1.0)
            first = (inner if len(inner) else np.rint([0.5 * (low + high)])).astype(int)[:, None]
        yield first + np.rint(goal.inputs * (way * _SAMPLES / FULL_TURN)).astype(int)
        return
    shares: tuple[float, ...] = (1.0,) if goal.closed else _SHARES
    if goal.limited_range is not None:
        width = min(1.0, (goal.limited_range[1] - goal.limited_range[0]) / FULL_TURN)
        shares = (*shares, *(part * width for part in _RANGE_SHARES))
    for share in shares:
        yield first + np.rint(goal.arc_shares * (share * _SAMPLES)).astype(int)


def _by_arc_length(q: ComplexArray, angles: Array, way: float) -> tuple[ComplexArray, Array]:
    """Curves and their crank angles at equal steps of arc length."""
    closed = np.concatenate([q, q[:, :1]], axis=1)
    turns = np.concatenate([angles, angles[:, :1] + way * FULL_TURN], axis=1)
    length = np.cumsum(np.abs(np.diff(closed, axis=1)), axis=1)
    length = np.concatenate([np.zeros((len(q), 1)), length], axis=1)
    points, places = np.full_like(q, np.nan), np.full(q.shape, np.nan)
    for k in np.flatnonzero(np.isfinite(length[:, -1]) & (length[:, -1] > 0.0)):
        along = np.linspace(0.0, length[k, -1], _SAMPLES, endpoint=False)
        places[k] = np.interp(along, length[k], turns[k])
        points[k] = np.interp(along, length[k], closed[k].real) + 1j * np.interp(
            along, length[k], closed[k].imag
        )
    return points, places


def _fitted(
    q: ComplexArray, index: IndexArray, z: ComplexArray, free: bool
) -> tuple[Array, ComplexArray, ComplexArray]:
    """What the best motion of curves leaves, its factor and its shift, (D, K) each."""
    chosen = q[:, index]
    if not free:
        missed = np.sum(np.abs(chosen - z) ** 2, axis=2)
        one: ComplexArray = np.ones(missed.shape, dtype=complex)
        return np.asarray(np.where(np.isfinite(missed), missed, np.inf)), one, 0.0 * one
    middle = chosen.mean(axis=2)
    apart = chosen - middle[:, :, None]
    aim = z - z.mean()
    # eq. (154)
    norm = np.einsum("dkn,dkn->dk", apart.real, apart.real)
    norm += np.einsum("dkn,dkn->dk", apart.imag, apart.imag)
    with np.errstate(all="ignore"):
        factor = (apart.conj() @ aim) / norm
        missed = np.sum(np.abs(aim) ** 2) - np.abs(factor) ** 2 * norm
    left: Array = np.where(np.isfinite(missed), np.maximum(missed, 0.0), np.inf)
    shift: ComplexArray = z.mean() - factor * middle
    return left, factor, shift
