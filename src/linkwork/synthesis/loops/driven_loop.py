"""Positions of one loop at any input of its branch, in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.core.foundation.units import FULL_TURN
from linkwork.synthesis.loops.candidates import Candidates, Drive, LoopKind
from linkwork.synthesis.loops.limits import (
    PRODUCT,
    DrivenLoops,
    angle_error,
    cross,
    dot,
    doubt_of,
    guide_loops,
    guide_pivots_at,
    phase_of,
)


def pivots_at(
    candidates: Candidates, drive: Drive, loops: DrivenLoops, place: Array
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """The pivots A and B and the guided point P on the branch of the first position.

    Parameters
    ----------
    candidates, drive, loops
        D designs.
    place : (D, K)
        Inputs measured from the loops' origins.

    Returns
    -------
    A, B, P : (D, K) complex
        NaN where the loop cannot be closed.
    """
    if not candidates.kind.has_crank:
        return guide_pivots_at(candidates, drive, loops, place)
    if candidates.kind is LoopKind.INVERTED:
        return _inverted_at(candidates, drive, loops, place)
    other = candidates.driven_at_b() if drive is Drive.B0 else candidates
    side = np.sign(loops.side[:, :1])
    first, second = other.moving_a[:, :1], other.moving_b[:, :1]
    length = np.abs(second - first)
    with np.errstate(invalid="ignore"):
        if drive is Drive.SLIDER:
            b = other.fixed_b[:, None] + (place + loops.origin[:, None]) * other.direction[:, None]
            crank = np.abs(first - other.fixed_a[:, None])
            a = b + _closed(other.fixed_a[:, None] - b, length, crank, side)
        else:
            phase = np.exp(1j * (place + loops.origin[:, None]))
            fixed = other.fixed_a[:, None]
            a = fixed + np.abs(first - fixed) * phase
            if candidates.kind is LoopKind.FOUR_BAR:
                pivot = other.fixed_b[:, None]
                b = a + _closed(pivot - a, length, np.abs(second - pivot), side)
            else:
                along = other.direction[:, None]
                height = dot(1j * along, a - other.fixed_b[:, None])
                b = a + (side * np.sqrt(length**2 - height**2) - 1j * height) * along
    body = (other.guided[:, :1] - first) / (second - first)
    p = a + body * (b - a)
    return (b, a, p) if drive is Drive.B0 else (a, b, p)


def _inverted_at(
    candidates: Candidates, drive: Drive, loops: DrivenLoops, place: Array
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """The same of inverted slider-cranks."""
    side = np.sign(loops.side[:, :1])
    first, block = candidates.moving_a[:, :1], candidates.fixed_b[:, None]
    line, fixed = candidates.lines[:, :1], candidates.fixed_a[:, None]
    phase = np.exp(1j * (place + loops.origin[:, None]))
    with np.errstate(invalid="ignore"):
        if drive is Drive.A0:
            a = fixed + np.abs(first - fixed) * phase
            # B0 - A = (s + ih) times the line
            base, h = block - a, cross(line, block - first)
            along = base / (side * np.sqrt(base.real**2 + base.imag**2 - h**2) + 1j * h)
        else:
            along = phase
            across = loops.q(place)
            reach = side * np.sqrt(np.abs(first - fixed) ** 2 - across**2)
            a = fixed + (reach + 1j * across) * along
    b = a + (candidates.moving_b[:, :1] - first) / line * along
    p = a + (candidates.guided[:, :1] - first) / line * along
    return a, b, p


def _closed(base: ComplexArray, one: Array, other: Array, side: Array) -> ComplexArray:
    """The vector of length ``one`` from the start of the base to the apex of a triangle, whose
    other side has length ``other``.
    """
    square = base.real**2 + base.imag**2
    along = 0.5 * (square + one**2 - other**2)
    across = np.sqrt(square * one**2 - along**2)
    return np.asarray(base * (along + 1j * side * across) / square)


# ----------------------------------------------------------------------
# The way of the input through the positions: branch, circuit and order, and the driven range.


#: Instead of a position's number.
NOWHERE = -1


@dataclass(frozen=True, kw_only=True)
class Range:
    """The inputs that a design is driven through: a whole turn, or from start to stop.

    ``start``, ``stop``: absolute inputs [rad or length].
    """

    turn: bool = False
    start: float = 0.0
    stop: float = 0.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Travel:
    """D designs at N positions.

    Parameters
    ----------
    place : (D, N)
        The inputs, measured from the loop's origin and unwrapped within the circuit, or along the
        direction of travel [rad or length].
    first, last : (D,)
        The ends of the driven range, in the same way; ``first`` may exceed ``last``.
    circuit, branch : (D,)
        The position after which the circuit, or only the branch, changes; ``NOWHERE`` for none.
    out_of_order : (D,)
        Whether the input passes the positions in another order.
    unreached : (D,)
        The position outside the driven range, N if the range itself leaves the circuit, N + 1 if
        the way beyond the positions is outside, ``NOWHERE`` if all is reached.
    decided : (D,)
        Whether all of this is certain with the errors.
    """

    place: Array
    first: Array
    last: Array
    circuit: IndexArray
    branch: IndexArray
    out_of_order: BoolArray
    unreached: IndexArray
    decided: BoolArray


def travel_of(
    loops: DrivenLoops,
    driven_range: Range | None,
    ordered: bool,
    beyond: float = 0.0,
) -> Travel:
    """How the loops pass the positions.

    ``driven_range``: without one, from ``beyond`` before the first position to ``beyond`` after
    the last.
    """
    free, split = loops.is_free, loops.is_split
    side, half = np.sign(loops.side), np.sign(loops.half)
    number = np.where(free[:, None], side, np.where(split[:, None], half, 0.0))
    circuit = _first_change(number)
    branch = np.where(circuit == NOWHERE, _first_change(side), NOWHERE)
    decided = _are_decided(loops, free, split)
    place, in_order, order_decided = _order_of_positions(loops, free)
    if ordered:
        decided &= order_decided
    else:
        in_order = np.ones_like(in_order)
    first, last, unreached = _driven_range(loops, place, free, driven_range, beyond)
    return Travel(
        place=place,
        first=first,
        last=last,
        circuit=circuit,
        branch=branch,
        out_of_order=~in_order,
        unreached=unreached,
        decided=decided & np.isfinite(loops.input_error),
    )


def _first_change(number: Array) -> IndexArray:
    """The first index after which numbers (D, N) differ from that of the first position."""
    changed = number[:, 1:] != number[:, :-1]
    return np.where(changed.any(axis=1), changed.argmax(axis=1), NOWHERE)


def _are_decided(loops: DrivenLoops, free: BoolArray, split: BoolArray) -> BoolArray:
    """Whether the signs of limits, sides and halves are certain."""
    limits = np.minimum(np.abs(loops.upper), np.abs(loops.lower)) > loops.limit_error
    sides = np.abs(loops.side).min(axis=1) > loops.sign_error
    halves = np.abs(loops.half).min(axis=1) > loops.sign_error
    return np.asarray(limits & sides & (halves | ~split))


def _order_of_positions(loops: DrivenLoops, free: BoolArray) -> tuple[Array, BoolArray, BoolArray]:
    """Unwrapped inputs, whether they are in order, and whether that is certain."""
    place = loops.input - loops.origin[:, None]
    error = 4.0 * loops.input_error
    if loops.turns:
        # a lower limit alone leaves half turns around the origin, an upper one those around π
        around = np.where((loops.upper > 0), 0.0, -np.pi)[:, None]
        place = np.mod(place - around, FULL_TURN) + around
    steps = np.diff(place, axis=1)
    in_order = np.asarray((steps > 0).all(axis=1) | (steps < 0).all(axis=1))
    certain = np.asarray(np.abs(steps).min(axis=1, initial=np.inf) > error)
    if not loops.turns:
        return place, in_order, certain
    # eq. (145): once around through all positions makes one turn, or all but one, if in order
    gaps = np.mod(np.diff(place, axis=1, append=place[:, :1]), FULL_TURN)
    count = np.rint(gaps.sum(axis=1) / FULL_TURN)
    forward = count == 1
    # of two positions both directions are in order: take the shorter way
    if place.shape[1] == 2:
        forward = gaps[:, 0] <= np.pi
    backward = ~forward & (count == place.shape[1] - 1)
    away = np.minimum(gaps, FULL_TURN - gaps).min(axis=1) > error
    ways = np.where(forward[:, None], gaps, gaps - FULL_TURN)[:, :-1]
    begin = place[:, :1]
    turning = begin + np.concatenate([np.zeros_like(begin), np.cumsum(ways, axis=1)], axis=1)
    around_in_order = forward | backward
    return (
        np.where((free & around_in_order)[:, None], turning, place),
        np.where(free, around_in_order, in_order),
        np.where(free, away, certain),
    )


def _driven_range(
    loops: DrivenLoops,
    place: Array,
    free: BoolArray,
    requested: Range | None,
    beyond: float,
) -> tuple[Array, Array, IndexArray]:
    """The ends of the driven range, and the position that is not reached."""
    count = place.shape[1]
    low, high = place.min(axis=1), place.max(axis=1)
    forward = place[:, -1] >= place[:, 0]
    needed = np.stack([low - beyond, high + beyond], axis=1)
    if requested is None:
        leaves = ~free & (beyond > 0.0) & _leaves(loops, needed[:, 0], needed[:, 1])
        first, last = np.where(forward, needed.T, needed.T[::-1])
        return first, last, np.where(leaves, count, NOWHERE)
    if requested.turn:
        first = place[:, 0]
        last = first + np.where(forward, FULL_TURN, -FULL_TURN)
        return first, last, np.where(free & loops.turns, NOWHERE, count)
    first = requested.start - loops.origin
    last = first + (requested.stop - requested.start)
    if loops.turns:
        # the whole turns that bring the range to the positions
        turns = np.round((needed.mean(axis=1) - 0.5 * (first + last)) / FULL_TURN) * FULL_TURN
        first, last = first + turns, last + turns
    begin, end = np.minimum(first, last), np.maximum(first, last)
    error = (4.0 * loops.input_error)[:, None]
    outside = (place < begin[:, None] - error) | (place > end[:, None] + error)
    leaves = ~free & _leaves(loops, begin, end)
    short = (needed[:, 0] < begin - error[:, 0]) | (needed[:, 1] > end + error[:, 0])
    unreached = np.where(outside.any(axis=1), outside.argmax(axis=1), NOWHERE)
    unreached = np.where((unreached == NOWHERE) & short, count + 1, unreached)
    unreached = np.where(leaves, count, unreached)
    return first, last, unreached


def _leaves(loops: DrivenLoops, begin: Array, end: Array) -> BoolArray:
    """Whether ranges leave their circuits, in doubt yes."""
    q = loops.q(np.stack([begin, end], axis=1))
    error = 2.0 * loops.q_error
    out = (q <= (loops.low + error)[:, None]) | (q >= (loops.high - error)[:, None])
    if loops.turns:
        poles = _passes(loops, begin, end, 0.0) & (loops.upper > 0)
        poles |= _passes(loops, begin, end, np.pi) & (loops.lower > 0)
    else:
        poles = _passes(loops, begin, end, 0.0) & (loops.lower > 0)
    return np.asarray(out.any(axis=1) | poles)


def _passes(loops: DrivenLoops, begin: Array, end: Array, pole: float) -> BoolArray:
    """Whether ranges contain a place, up to whole turns of an angle."""
    ahead = np.mod(pole - begin, FULL_TURN) if loops.turns else pole - begin
    return np.asarray((ahead >= 0) & (ahead <= end - begin))


# ----------------------------------------------------------------------
# One loop and its input: where it can move, with bounds of the errors of every sign.
#
# With the input φ (an angle) or s (a slider's displacement) the loop closes where
#
#     low ≤ q ≤ high,    q = q0 + q1 cos(φ - φ0)  or  q = q0 + s²,                         eq. (144)
#
# | loop | q | low, high | the side of the loop: sign of |
# |---|---|---|---|
# | four-bar driven at A0 | \|A - B0\|² | (b - c)², (b + c)² | (B - A) × (B - B0) |
# | slider-crank driven at A0 | distance of A from the line | -c, c | (B - A) · line |
# | slider-crank driven at B | \|B - A0\|² | (a - c)², (a + c)² | (A - B) × (A - A0) |
# | inverted slider-crank driven at A0 | \|A - B0\|² | h², ∞ | (B0 - A) · line |
# | inverted slider-crank driven at B0 | (A - A0) across the line | -a, a | (A - A0) · line |
#
# h is the distance of A from the line of the coupler, which slides through B0.
#
# A loop changes its side only at a limit, which is a dead point. Each limit that is reached cuts
# the circle of inputs around one of its poles φ0, φ0 + π: two limits leave two circuits, one limit
# one circuit, none two circuits that differ in their side.


def driven_loops(candidates: Candidates, drive: Drive) -> DrivenLoops:
    """The loops of designs with one driven link."""
    if not candidates.kind.has_crank:
        return guide_loops(candidates, drive)
    if candidates.kind is LoopKind.FOUR_BAR:
        return _four_bars(candidates if drive is Drive.A0 else candidates.driven_at_b())
    if candidates.kind is LoopKind.INVERTED:
        return _inverted(candidates) if drive is Drive.A0 else _driven_blocks(candidates)
    return _slider_cranks(candidates) if drive is Drive.A0 else _driven_sliders(candidates)


def _four_bars(candidates: Candidates) -> DrivenLoops:
    crank = candidates.moving_a - candidates.fixed_a[:, None]
    coupler = candidates.moving_b - candidates.moving_a
    rocker = candidates.moving_b - candidates.fixed_b[:, None]
    ground = candidates.fixed_b - candidates.fixed_a
    a, b, c = (np.abs(v[:, 0]) for v in (crank, rocker, coupler))
    g = np.abs(ground)
    size = np.maximum(np.maximum(a, b), np.maximum(c, g))
    doubt = doubt_of(candidates, size)
    toward = phase_of(ground)
    with np.errstate(all="ignore"):
        cosine = (b**2 + c**2) / (2.0 * b * c), -1.0 / (2.0 * b * c)
    return DrivenLoops(
        turns=True,
        input=phase_of(crank),
        input_error=angle_error(a, doubt),
        origin=toward + np.pi,
        q0=a**2 + g**2,
        q1=2.0 * a * g,
        low=(b - c) ** 2,
        high=(b + c) ** 2,
        upper=(a + g) - (b + c),
        lower=np.abs(b - c) - np.abs(a - g),
        limit_error=4.0 * doubt,
        side=cross(coupler, rocker),
        half=cross(crank, ground[:, None]),
        sign_error=PRODUCT * size * doubt,
        q_error=4.0 * PRODUCT * size * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )


def _slider_cranks(candidates: Candidates) -> DrivenLoops:
    crank = candidates.moving_a - candidates.fixed_a[:, None]
    rod = candidates.moving_b - candidates.moving_a
    normal = 1j * candidates.direction
    a, c = np.abs(crank[:, 0]), np.abs(rod[:, 0])
    height = dot(normal, candidates.fixed_a - candidates.fixed_b)
    size = np.maximum(np.maximum(a, c), np.abs(candidates.fixed_a - candidates.fixed_b))
    doubt = doubt_of(candidates, size)
    toward = phase_of(normal)
    with np.errstate(all="ignore"):
        cosine = np.zeros_like(c), 1.0 / c
    return DrivenLoops(
        turns=True,
        input=phase_of(crank),
        input_error=angle_error(a, doubt),
        origin=toward,
        q0=height,
        q1=a,
        low=-c,
        high=c,
        upper=height + a - c,
        lower=a - height - c,
        limit_error=4.0 * doubt,
        side=dot(rod, candidates.direction[:, None]),
        half=cross(normal[:, None], crank),
        sign_error=PRODUCT * doubt,
        q_error=4.0 * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )


def _driven_sliders(loops: Candidates) -> DrivenLoops:
    crank = loops.moving_a - loops.fixed_a[:, None]
    rod = loops.moving_a - loops.moving_b
    a, c = np.abs(crank[:, 0]), np.abs(rod[:, 0])
    to_crank = loops.fixed_a - loops.fixed_b
    height = dot(1j * loops.direction, to_crank)
    size = np.maximum(np.maximum(a, c), np.abs(loops.moving_b - loops.fixed_b[:, None]).max(axis=1))
    size = np.maximum(size, np.abs(to_crank))
    doubt = doubt_of(loops, size)
    foot = dot(loops.direction, to_crank)
    s = dot(loops.direction[:, None], loops.moving_b - loops.fixed_b[:, None])
    with np.errstate(all="ignore"):
        cosine = (a**2 + c**2) / (2.0 * a * c), -1.0 / (2.0 * a * c)
    return DrivenLoops(
        turns=False,
        input=s,
        input_error=4.0 * doubt,
        origin=foot,
        q0=height**2,
        q1=np.ones_like(a),
        low=(a - c) ** 2,
        high=(a + c) ** 2,
        # a slider far enough away reaches the outer limit always
        upper=np.full_like(a, np.inf),
        lower=np.abs(a - c) - np.abs(height),
        limit_error=4.0 * doubt,
        side=cross(rod, crank),
        half=size[:, None] * (s - foot[:, None]),
        sign_error=PRODUCT * size * doubt,
        q_error=4.0 * PRODUCT * size * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )


def _inverted(candidates: Candidates) -> DrivenLoops:
    crank = candidates.moving_a - candidates.fixed_a[:, None]
    ground = candidates.fixed_b - candidates.fixed_a
    to_block, lines = candidates.fixed_b[:, None] - candidates.moving_a, candidates.lines
    a, g = np.abs(crank[:, 0]), np.abs(ground)
    h = np.abs(cross(lines[:, 0], to_block[:, 0]))
    size = np.maximum(np.maximum(a, g), np.abs(to_block).max(axis=1))
    doubt = 2.0 * doubt_of(candidates, size)
    return DrivenLoops(
        turns=True,
        input=phase_of(crank),
        input_error=angle_error(a, doubt),
        origin=phase_of(ground) + np.pi,
        q0=a**2 + g**2,
        q1=2.0 * a * g,
        low=h**2,
        high=np.full_like(h, np.inf),
        # a block on an endless line limits one side only
        upper=np.full_like(h, -np.inf),
        lower=h - np.abs(a - g),
        limit_error=4.0 * doubt,
        side=size[:, None] * dot(lines, to_block),
        half=cross(crank, ground[:, None]),
        sign_error=PRODUCT * size * doubt,
        q_error=4.0 * PRODUCT * size * doubt,
        cosine=(np.zeros_like(h), np.zeros_like(h)),
        # rounding alone makes an offset of zero positive
        offset=h + doubt,
    )


def _driven_blocks(candidates: Candidates) -> DrivenLoops:
    crank = candidates.moving_a - candidates.fixed_a[:, None]
    ground = candidates.fixed_a - candidates.fixed_b
    to_block, lines = candidates.fixed_b[:, None] - candidates.moving_a, candidates.lines
    a, g = np.abs(crank[:, 0]), np.abs(ground)
    # A is h to the right of the line, A0 is g cos(φ - φ0) to the right of its parallel through B0
    h = cross(lines[:, 0], to_block[:, 0])
    size = np.maximum(np.maximum(a, g), np.abs(to_block).max(axis=1))
    doubt = 2.0 * doubt_of(candidates, size)
    toward = phase_of(ground) + 0.5 * np.pi
    with np.errstate(all="ignore"):
        cosine = np.zeros_like(a), 1.0 / a
    return DrivenLoops(
        turns=True,
        input=phase_of(lines),
        input_error=angle_error(size, doubt),
        origin=toward,
        q0=-h,
        q1=g,
        low=-a,
        high=a,
        upper=g - h - a,
        lower=g + h - a,
        limit_error=4.0 * doubt,
        side=dot(crank, lines),
        half=cross(1j * ground[:, None], lines),
        sign_error=PRODUCT * doubt,
        q_error=4.0 * doubt,
        cosine=cosine,
        offset=np.zeros_like(a),
    )
