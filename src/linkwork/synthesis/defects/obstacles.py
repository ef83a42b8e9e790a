"""Whether links meet circles anywhere on a driven range, with proof that they do not."""

from __future__ import annotations

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.synthesis.loops.candidates import Candidates, Drive, LoopKind
from linkwork.synthesis.loops.driven_loop import Travel, pivots_at
from linkwork.synthesis.loops.limits import DrivenLoops, cross, guide_speeds, meeting
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
        start = meeting(loops.fixed_a, loops.lines_a[:, 0], loops.fixed_b, line)
    else:
        start = first + 1j * cross(line, second - first) * line
    return np.asarray(a + (start - first) * (b - a) / (second - first))


def _fastest(
    candidates: Candidates, drive: Drive, loops: DrivenLoops, first: Array, last: Array
) -> Array:
    """A bound of the speed of every point of every link, per unit of the input, (D,)."""
    other = candidates.driven_at_b() if drive is Drive.B0 else candidates
    a, b, p = other.moving_a[:, 0], other.moving_b[:, 0], other.guided[:, 0]
    sine = np.sin(loops.least_transmission(first, last))
    with np.errstate(all="ignore"):
        pivot = 1.0 / sine if drive is Drive.SLIDER else np.abs(a - other.fixed_a)
        # the coupler turns fastest where the driving force is farthest from the line of the rocker
        lever = 1.0 if drive is Drive.SLIDER else pivot
        turning = lever / (np.abs(b - a) * sine)
        if candidates.kind is LoopKind.INVERTED or not candidates.kind.has_crank:
            bounds = _fastest_inverted if candidates.kind.has_crank else guide_speeds
            pivot, turning = bounds(candidates, drive, loops, first, last)
            a, b, p = candidates.moving_a[:, 0], candidates.moving_b[:, 0], candidates.guided[:, 0]
        fastest = pivot + np.maximum(np.abs(b - a), np.abs(p - a)) * turning
    return np.where(np.isfinite(fastest), fastest, np.inf)


def _fastest_inverted(
    candidates: Candidates, drive: Drive, loops: DrivenLoops, first: Array, last: Array
) -> tuple[Array, Array]:
    """Bounds of the speed of A, and of the turning of the coupler, of inverted slider-cranks."""
    crank = np.abs(candidates.moving_a[:, 0] - candidates.fixed_a)
    sine = np.sin(loops.least_transmission(first, last))
    if drive is Drive.A0:
        # A moves across the line by at most its speed, at least q sin μ from the block
        nearest = np.sqrt(np.maximum(loops.extremes(first, last).min(axis=1) - loops.q_error, 0.0))
        return crank, crank / (nearest * sine)
    ground = np.abs(candidates.fixed_b - candidates.fixed_a)
    return (crank + ground) / sine, np.ones_like(crank)
