"""Rows of a motion as lines, broken at missing positions, gaps and jumps of angles."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from linkwork.drawing.charts.chart import Mark, Rule
from linkwork.drawing.charts.columns import Column
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.results.motion import LimitKind, Motion

__all__ = ["breaks", "broken", "limit_marks", "runs"]

_DEAD = LimitKind.DEAD_POINT.word
_FURTHER = 1.5  # steps of the table: rows further apart are not neighbours
_SINGULAR = (_DEAD, LimitKind.CHANGE_POINT.word, LimitKind.UNKNOWN.word)


def breaks(motion: Motion, lead: Array, *columns: Column) -> BoolArray:
    """Whether the line between neighbouring rows is interrupted, shape (N - 1,).

    It is between rows on different branches, between rows whose inputs differ by more than the
    table's step, and between two dead points without a row between them. An angle jumps if its
    change differs by more than half a turn from that predicted by its derivative.

    Parameters
    ----------
    lead : array (N,)
        The leading input, in file units.
    """
    branch = np.array(motion.branch)
    dead = np.array(motion.limit) == _DEAD
    found: BoolArray = (branch[1:] != branch[:-1]) | (dead[1:] & dead[:-1])
    steps = np.abs(np.diff(lead[motion.asked]))
    if len(steps):
        found |= np.abs(np.diff(lead)) > _FURTHER * steps.max()
    for column in columns:
        if column.turn and column.slope is not None:
            found |= _jumps(column, column.slope, np.diff(lead))
    return found


def _jumps(column: Column, slope: Array, dx: Array) -> BoolArray:
    dy = np.diff(column.values)
    # the first finite one of both ends; none at a dead point
    ahead, behind = slope[:-1], slope[1:]
    steady = np.where(np.isfinite(ahead), ahead, behind)
    expected = np.where(np.isfinite(steady), steady, 0.0) * dx
    half = 0.5 * column.turn
    jumps: BoolArray = (np.abs(dy) > half) & (np.abs(dy - expected) > half)
    return jumps


def broken(values: Array, where: BoolArray) -> Array:
    """Values (N,) with NaN inserted between the rows marked in ``where`` (N - 1,)."""
    return np.insert(values, np.flatnonzero(where) + 1, np.nan)


def runs(x: Array, y: Array) -> Iterator[tuple[Array, Array]]:
    """The pieces of a line between NaN values."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], np.isfinite(x + y).astype(int), [0]))))
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        yield x[start:stop], y[start:stop]


def limit_marks(
    motion: Motion, across: Column, column: Column, tone: int
) -> tuple[list[Mark], list[Rule]]:
    """Dead points, change points and extremes of a column: marks on it, or rules if it has no
    value.

    Derivatives and conditions have no value at a dead point; a rule shows the input.
    """
    marks: list[Mark] = []
    rules: list[Rule] = []
    for k, kind in enumerate(motion.limit):
        x, y = float(across.values[k]), float(column.values[k])
        word, _, of = kind.partition(" of ")
        if not kind or (of and of != column.name) or not np.isfinite(x):
            continue
        if np.isfinite(y):
            marks.append(Mark(x=x, y=y, tone=tone, kind=word))
        elif word in _SINGULAR:
            rules.append(Rule(along="x", at=x, kind=word))
    return marks, rules
