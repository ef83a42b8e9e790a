"""Rows in addition to those of a motion's table, at which a number of the motion is exact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.rounding import EQUAL_ROWS
from linkwork.results.quantities.asked import AskedOfMotion, Group
from linkwork.results.quantities.definition import UNKNOWN, MotionRows, Places, Solved
from linkwork.results.quantities.extreme_places import joined_places

__all__ = ["Between", "LocatedRows", "columns_of", "locate_rows"]

_MOST_PASSES, _SHARP = 16, 40  # the latter for extremes that are no poles so far
_POLE = 1e3  # times the values of the table: there may be a pole instead of an extreme,
_GROWS = 0.1  # of the value, where it still changes so much up to the nearest row
_MOST = 10_000  # further rows for one number: one of more than that is rounding of a constant
_AT_ROW = 1e-12  # of the input: places so near to a row are that row


class SolvedTable(Solved, Protocol):
    """Solved positions, some of which may be missing."""

    @property
    def found(self) -> BoolArray:
        """Whether a row has a position, (K,)."""


class Between(Protocol):
    """Solves positions between the rows of a motion."""

    @property
    def joined(self) -> BoolArray:
        """Between which neighbouring rows positions can be solved, (R - 1,)."""

    @property
    def switches(self) -> Array:
        """Leading inputs just before and just behind the switches of loads, rising, (K,)."""

    @property
    def far(self) -> float:
        """The largest step that shows all extremes of smooth quantities [rad or length]."""

    def __call__(self, row: IndexArray, at: Array) -> SolvedTable:
        """Positions at leading inputs (K,) [rad or length] between rows (K,) and the next ones."""


@dataclass(frozen=True, kw_only=True, eq=False)
class LocatedRows:
    """The rows of a motion with further ones in their places.

    ``further``: the solutions that were added. ``order``: the place of each row among those of the
    motion followed by all further ones.
    """

    rows: MotionRows
    further: Sequence[SolvedTable]
    order: IndexArray


def columns_of(
    asked: AskedOfMotion, solved: Solved, speed: float | None
) -> tuple[Array, Array, Array]:
    """The quantity and its derivatives by the leading input, NaN if it has none, in file units."""
    of, rate = asked.of, asked.of.rate
    if asked.quantity.of_point or (rate is None and of.group is not Group.EVIDENCE):
        return replace(asked, quantity=replace(asked.quantity, needs=2)).columns(solved, speed)
    value = of.values(solved, speed)
    if rate is None or rate.order > 1 or of.group is Group.POINT:
        return value, UNKNOWN, UNKNOWN
    return value, rate.of(of.jet(solved).d2, UNKNOWN, speed), UNKNOWN


def locate_rows(
    asked: AskedOfMotion, rows: MotionRows, between: Between | None, speed: float | None
) -> LocatedRows:
    """The rows with those that make the number exact, as far as positions can be solved there."""
    order, further = np.arange(len(rows.input)), list[SolvedTable]()
    places = asked.quantity.places
    still = asked.of.group in (Group.EVIDENCE, Group.INPUT)
    if between is None or places is None or still or len(order) < 2:
        return LocatedRows(rows=rows, further=further, order=order)
    rows, before, count = replace(rows, joined=between.joined), order, len(order)
    first = order
    most = _POLE * np.nanmax(np.abs(rows.value), initial=0.0)
    row, part = _places_within(rows, between.far)
    if any(each.word == asked.of.own.name for each in asked.names.further):
        row, part = joined_places((row, part), _places_of(rows, between.switches))
    sides = asked.quantity.sides
    for k in range(_SHARP if sides else _MOST_PASSES):
        if k == _MOST_PASSES and any(_poles(rows, side, most) for side in sides):
            break
        if k or not len(row):
            row, part = places(rows, asked.numbers)
        step = np.abs(rows.input[row + 1] - rows.input[row])
        size = np.maximum(np.ptp(rows.input), np.abs(rows.input[row]))
        fresh = np.minimum(part, 1.0 - part) * step > _AT_ROW * size
        at = np.unique(np.stack([row[fresh], part[fresh]]), axis=1)
        row, part = at[0].astype(np.intp), at[1]
        if not len(row) or (k and count + len(row) > len(first) + _MOST):
            break
        at = rows.input[row] + part * (rows.input[row + 1] - rows.input[row])
        more = between(before[row], at)
        there = np.flatnonzero(more.found)
        if not len(there):
            break
        own = [np.broadcast_to(x, len(at))[there] for x in columns_of(asked, more, speed)]
        behind = row[there] + 1
        rows = _inserted(rows, behind, at[there], own)
        order = np.insert(order, behind, count + there)
        before = np.insert(before, behind, before[row[there]])
        further.append(more)
        count += len(at)
    poles = [k for side in sides for k in _poles(rows, side, most)]
    if poles:
        value = rows.value.copy()
        value[poles] *= np.inf
        rows = replace(rows, value=value)
    return LocatedRows(rows=rows, further=further, order=order)


def _places_within(rows: MotionRows, far: float) -> Places:
    """Where further rows are wanted, so that none is farther from the next one."""
    assert rows.joined is not None
    parts = np.where(rows.joined, np.ceil(np.abs(np.diff(rows.input)) / far - EQUAL_ROWS), 1.0)
    more = np.maximum(parts.astype(np.intp) - 1, 0)
    row = np.repeat(np.arange(len(more)), more)
    number = np.arange(len(row)) - np.repeat(np.cumsum(more) - more, more)
    return row, (number + 1.0) / parts[row]


def _poles(rows: MotionRows, side: float, most: float) -> list[int]:
    """The row of the largest value, for a negative side the smallest, if its size is above ``most``
    and still grows from row to row: rows next to an extreme are so close that it does not.
    """
    k = int(np.nan_to_num(side * rows.value, nan=-np.inf).argmax())
    size = abs(float(rows.value[k]))
    beside = [j for j in (k - 1, k + 1) if 0 <= j < len(rows.value)]
    grown = abs(float(rows.first[k])) * np.abs(rows.input[beside] - rows.input[k]).min()
    if not np.isfinite(grown):
        grown = np.fmin.reduce(np.abs(rows.value[beside] - rows.value[k]))
    return [k] if size > most and not grown <= _GROWS * size else []


def _places_of(rows: MotionRows, at: Array) -> Places:
    """Between which rows leading inputs (K,) lie, and the part of the step there."""
    order = np.argsort(rows.input, kind="stable")
    k = np.clip(rows.input[order].searchsorted(at, side="right") - 1, 0, len(order) - 2)
    row = np.minimum(order[k], order[k + 1])
    return row, (at - rows.input[row]) / (rows.input[row + 1] - rows.input[row])


def _inserted(rows: MotionRows, behind: IndexArray, at: Array, own: Sequence[Array]) -> MotionRows:
    value, first, second = (
        np.insert(column, behind, new)
        for column, new in zip((rows.value, rows.first, rows.second), own, strict=True)
    )
    assert rows.joined is not None
    joined = np.insert(rows.joined, behind - 1, True)
    given = np.insert(rows.input, behind, at)
    return replace(rows, input=given, value=value, first=first, second=second, joined=joined)
