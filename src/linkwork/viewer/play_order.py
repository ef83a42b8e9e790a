"""The rows of a motion in playing order."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from linkwork.equations.input_motion import TIME
from linkwork.foundation.arrays import BoolArray, ComplexArray, CountArray
from linkwork.foundation.rounding import EQUAL_ROWS
from linkwork.results.motion import Motion

__all__ = ["falling", "in_time", "play_order"]

_MEETING = 1.5  # in multiples of the largest step: runs with nearer ends are joined


def play_order(motion: Motion) -> tuple[CountArray, bool]:
    """Found rows in order, and whether the first follows the last.

    A table starts anywhere on a circuit, may have a gap without positions, and lists further
    branches at its end. Runs of neighbouring rows are joined at common ends; other runs follow each
    other. The order follows time: it is reversed if the input speed is opposite to the table. Rows
    over the time keep their order, also where the mechanism rests.
    """
    if in_time(motion):
        return np.flatnonzero(motion.found), False
    places = _places(motion)
    runs = _runs(places, motion)
    limit = np.array([bool(what) for what in motion.limit], dtype=bool)
    usual = (places[run[~limit[run]]] for run in runs)
    near = _MEETING * max(map(_largest_step, usual), default=0.0)
    chain = [runs.pop(0)]
    while runs:
        last, first = places[chain[-1][-1]], places[chain[0][0]]
        after = [_apart(places[run[0]], last) for run in runs]
        back = [_apart(places[run[-1]], last) for run in runs]
        before = [_apart(places[run[-1]], first) for run in runs]
        k = int(np.argmin(np.minimum(np.minimum(after, back), before)))
        if before[k] < min(after[k], back[k]) and before[k] <= near:
            chain.insert(0, runs.pop(k))
        elif back[k] < after[k] and back[k] <= near:
            chain.append(runs.pop(k)[::-1])
        else:
            k = k if after[k] <= near else 0
            chain.append(runs.pop(k))
    closed = _apart(places[chain[-1][-1]], places[chain[0][0]]) <= near
    order = np.concatenate(chain)
    order = order[_passed_once(order, places)]
    if closed and len(order) > 2 and _apart(places[order[-1]], places[order[0]]) < 1e-3 * near:
        order = order[:-1]
    if closed:
        order = np.roll(order, -int(np.argmin(order)))
    if motion.speed:
        lead = next(iter(motion.inputs.values()))[motion.asked]
        if (motion.speed < 0) == (lead[-1] > lead[0]):
            order = np.roll(order[::-1], 1) if closed else order[::-1]
    return order, bool(closed and len(order) > 2)


def in_time(motion: Motion) -> bool:
    """Whether the rows are over the time: a law drives the mechanism, or loads move it."""
    return motion.input_units.get(TIME) == "s"


def falling(motion: Motion, rows: Sequence[int]) -> list[bool]:
    """Whether the leading input decreases from each of these rows to the next; for the last row,
    from the one before.
    """
    name, values = next(iter(motion.inputs.items()))
    ahead = np.diff(values[list(rows)])
    turn = {"deg": 360.0, "rad": 2.0 * np.pi}.get(motion.input_units[name])
    if turn is not None:  # the shorter direction
        ahead = np.remainder(ahead + 0.5 * turn, turn) - 0.5 * turn
    falls = (ahead < 0).tolist()
    return [*falls, *falls[-1:]] if falls else [False] * len(rows)


def _places(motion: Motion) -> ComplexArray:
    """Coordinates of all points, and of tips of links that may rotate about one, shape (N, m)."""
    points = [motion.trace(name) for name in motion.points]
    known = np.concatenate(points)[np.isfinite(np.concatenate(points))]
    size = float(np.abs(known - known[:1]).max(initial=0.0)) or 1.0
    radians = motion.units.angle.radians
    tips = [size * np.exp(1j * series.value * radians) for series in motion.links.values()]
    return np.stack([*points, *tips], axis=1)


def _passed_once(order: CountArray, places: ComplexArray) -> BoolArray:
    """The rows to keep: if runs meet in the same position, only the first listed row."""
    there = places[order]
    span = float(np.abs(there - there[0]).max())
    kept = np.ones(len(order), dtype=bool)
    for k in np.flatnonzero(np.abs(np.diff(there, axis=0)).max(axis=1) <= EQUAL_ROWS * span):
        kept[k if order[k] > order[k + 1] else k + 1] = False
    return kept


def _runs(places: ComplexArray, motion: Motion) -> list[CountArray]:
    """Runs of neighbouring found rows, interrupted at jumps of the mechanism.

    Near a limit, large motions for small input steps on one branch are not jumps.
    """
    rows = np.flatnonzero(motion.found)
    steps = np.abs(np.diff(places[rows], axis=0)).max(axis=1, initial=0.0)
    usual = float(np.quantile(steps, 0.95)) if len(steps) else 0.0
    limit = np.array([bool(what) for what in motion.limit], dtype=bool)[rows]
    branch = np.array(motion.branch)[rows]
    at_limit = (limit[:-1] | limit[1:]) & (branch[:-1] == branch[1:])
    breaks = (np.diff(rows) > 1) | ((steps > 8 * max(usual, 1e-300)) & ~at_limit)
    return list(np.split(rows, np.flatnonzero(breaks) + 1))


def _largest_step(places: ComplexArray) -> float:
    return float(np.abs(np.diff(places, axis=0)).max(initial=0.0))


def _apart(one: ComplexArray, other: ComplexArray) -> float:
    return float(np.abs(one - other).max())
