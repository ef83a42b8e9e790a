"""Positions of one loop at any input of its branch, in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.core.foundation.units import FULL_TURN
from linkwork.synthesis.loops.limits import (
    Candidates,
    Drive,
    DrivenLoops,
    Side,
    cross,
    dot,
    meeting,
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
    driven, driver, other = candidates.driven_by(drive)
    first, second = driven.moving_a[:, :1], driven.moving_b[:, :1]
    fixed, end = driven.fixed_a[:, None], driven.fixed_b[:, None]
    value = place + loops.origin[:, None]
    with np.errstate(all="ignore"):
        if driver is Side.BLOCK:
            turn = np.exp(1j * value) / driven.lines_a[:, :1]
            a = _behind_block(driven, other, turn, loops, place)
        else:
            along_line = driver is Side.LINE
            phase = value * driven.direction_a[:, None] if along_line else np.exp(1j * value)
            a = fixed + (1.0 if along_line else np.abs(first - fixed)) * phase
            turn = _closed(driven, other, end - a, np.sign(loops.side[:, :1]))
    b = a + (second - first) * turn
    p = a + (driven.guided[:, :1] - first) * turn
    return (b, a, p) if drive.at_b else (a, b, p)


def _behind_block(
    driven: Candidates, other: Side, turn: ComplexArray, loops: DrivenLoops, place: Array
) -> ComplexArray:
    """A on a body that a block at A0 has turned by factors ``turn``."""
    first, second = driven.moving_a[:, :1], driven.moving_b[:, :1]
    fixed, end = driven.fixed_a[:, None], driven.fixed_b[:, None]
    line = driven.lines_a[:, :1]
    if other is Side.BLOCK:
        start = meeting(fixed, line, end, driven.lines[:, :1])
        crossing = meeting(fixed, line * turn, end, driven.lines[:, :1] * turn)
        return np.asarray(crossing + (first - start) * turn)
    if other is Side.PIN:
        across = loops.q(place)
        reach = np.sign(loops.side[:, :1]) * np.sqrt(np.abs(second - end) ** 2 - across**2)
        b = end + (reach + 1j * across) * line * turn
    else:
        guide, along, h = driven.direction[:, None], line * turn, cross(line, fixed - second)
        b = end + (cross(along, fixed - end) - h) / cross(along, guide) * guide
    return np.asarray(b + (first - second) * turn)


def _closed(driven: Candidates, other: Side, base: ComplexArray, side: Array) -> ComplexArray:
    """The factors that turn the body so that the loop closes; ``base``: B0 - A, or to a point of
    the line of B.
    """
    first, second = driven.moving_a[:, :1], driven.moving_b[:, :1]
    square = base.real**2 + base.imag**2
    length = np.abs(second - first)
    if other is Side.BLOCK:
        # B0 - A = (s + ih) times the line
        line = driven.lines[:, :1]
        h = cross(line, driven.fixed_b[:, None] - first)
        return np.asarray(base / (side * np.sqrt(square - h**2) + 1j * h) / line)
    if other is Side.LINE:
        guide = driven.direction[:, None]
        height = -dot(1j * guide, base)
        coupler = (side * np.sqrt(length**2 - height**2) - 1j * height) * guide
    else:
        along = 0.5 * (square + length**2 - np.abs(second - driven.fixed_b[:, None]) ** 2)
        coupler = base * (along + 1j * side * np.sqrt(square * length**2 - along**2)) / square
    return np.asarray(coupler / (second - first))


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
