"""Whether links meet circles anywhere on a driven range, with proof that they do not."""

from __future__ import annotations

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.synthesis.loops.candidates import Candidates, Drive, LoopKind, Side
from linkwork.synthesis.loops.driven_loop import Travel, pivots_at
from linkwork.synthesis.loops.limits import DrivenLoops, cross, meeting
from linkwork.synthesis.tasks.conditions import Wishes, distances_to_segments

_PIECES = 64  # of a driven range, to begin with
_HALVINGS = 14  # pieces that are still in doubt then count as contacts
_MOST_PIECES = 200_000


def meets_obstacle(
    candidates: Candidates,
    drive: Drive,
    loops: DrivenLoops,
    travel: Travel,
    index: IndexArray,
    wishes: Wishes,
) -> BoolArray:
    """Whether a link of each design comes into a circle, or nearer than can be excluded.

    A piece of the range is clear if at its middle every link is farther from the circle than any of
    its points can move within half the piece, eq. (146). Other pieces are halved.

    Parameters
    ----------
    candidates : Candidates
        D designs; ``index`` is their place in ``loops`` and ``travel``.
    """
    loops, first, last = loops.take(index), travel.first[index], travel.last[index]
    speed = _fastest(candidates, drive, loops, first, last)
    met = ~np.isfinite(speed)
    width = (last - first) / _PIECES
    which = np.repeat(np.arange(len(candidates)), _PIECES)
    middle = (first[:, None] + width[:, None] * (np.arange(_PIECES) + 0.5)).ravel()
    half = np.repeat(np.abs(width) / 2, _PIECES)
    for _ in range(_HALVINGS):
        keep = ~met[which]
        which, middle, half = which[keep], middle[keep], half[keep]
        if not which.size:
            return met
        gap = _gaps(candidates.take(which), drive, loops.take(which), middle, wishes.obstacles)
        gap -= candidates.error[which]
        # NaN: no position, which cannot be within a driven range that is proved
        met[which[~(gap > 0)]] = True
        # eq. (146)
        doubt = (gap <= speed[which] * half) & ~met[which]
        which, middle, half = which[doubt], middle[doubt], half[doubt] / 2
        if which.size > _MOST_PIECES:
            break
        middle = np.concatenate([middle - half, middle + half])
        which, half = np.tile(which, 2), np.tile(half, 2)
    met[which] = True
    return met


def _gaps(
    candidates: Candidates, drive: Drive, loops: DrivenLoops, place: Array, circles: Array
) -> Array:
    """The smallest distances of links from circles, at one place of each design, (D,)."""
    a, b, p = (z[:, 0] for z in pivots_at(candidates, drive, loops, place[:, None]))
    ends: list[tuple[ComplexArray, ComplexArray]] = [(a, b), (a, p), (b, p)]
    # a crank, a rocker, or the body from its end to the block
    both = {"A0": (candidates.fixed_a, a), "B0": (candidates.fixed_b, b)}
    ends += [both[name] for name in candidates.kind.pivots]
    if candidates.kind.body_line:
        corner = _corner(candidates, a, b)
        ends += [(corner, a), (corner, b), (corner, candidates.fixed_b)]
        if candidates.kind is LoopKind.OLDHAM:
            ends.append((corner, candidates.fixed_a))
    gaps = [
        distances_to_segments(np.asarray(x + 1j * y), start, end) - radius
        for x, y, radius in circles
        for start, end in ends
    ]
    return np.asarray(np.min(gaps, axis=0))


def _corner(loops: Candidates, a: ComplexArray, b: ComplexArray) -> ComplexArray:
    """Where the body's line through B begins: the foot of A, or the crossing with that through A,
    at places of A and B (D,).
    """
    first, second, line = (loops.moving_a[:, 0], loops.moving_b[:, 0], loops.lines[:, 0])
    if loops.kind is LoopKind.OLDHAM:
        start = _crossing(loops)
    else:
        start = first + 1j * cross(line, second - first) * line
    return np.asarray(a + (start - first) * (b - a) / (second - first))


def _fastest(
    candidates: Candidates, drive: Drive, loops: DrivenLoops, first: Array, last: Array
) -> Array:
    """A bound of the speed of every point of every link, per unit of the input, (D,)."""
    driven, driver, other = candidates.driven_by(drive)
    a, b, p = driven.moving_a[:, 0], driven.moving_b[:, 0], driven.guided[:, 0]
    ground = driven.fixed_b - driven.fixed_a
    sine = np.sin(loops.least_transmission(first, last))
    with np.errstate(all="ignore"):
        if driver is not Side.BLOCK:
            centre, speed = a, np.ones(len(driven))
            if driver is Side.PIN:
                speed = np.abs(a - driven.fixed_a)
            lever = np.abs(b - a)
            if other is Side.BLOCK:
                # A moves across the line by at most its speed, at least q sin μ from the block
                lever = np.sqrt(
                    np.maximum(loops.extremes(first, last).min(axis=1) - loops.q_error, 0.0)
                )
            # the body turns fastest where the driving force is farthest from the line of the rocker
            turning = speed / (lever * sine)
        else:
            centre, turning = b, np.ones(len(driven))
            if other is Side.PIN:
                speed = (np.abs(b - driven.fixed_b) + np.abs(ground)) / sine
            elif other is Side.LINE:
                h = np.abs(cross(driven.lines_a[:, 0], driven.fixed_a - b))
                speed = (np.abs(cross(driven.direction, ground)) + h) / sine**2
            else:
                # the crossing of the body's lines runs around a circle through A0 and B0
                centre, speed = _crossing(driven), np.abs(ground) / sine
        farthest = np.max([np.abs(point - centre) for point in (a, b, p)], axis=0)
        fastest = speed + farthest * turning
    return np.where(np.isfinite(fastest), fastest, np.inf)


def _crossing(loops: Candidates) -> ComplexArray:
    """Where the body's lines through two blocks cross at the first position, (D,)."""
    return meeting(loops.fixed_a, loops.lines_a[:, 0], loops.fixed_b, loops.lines[:, 0])
