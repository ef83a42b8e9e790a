"""The table of a sweep: requested rows, and rows of limits in their places."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.rounding import EPSILON
from linkwork.foundation.short_number import short_number
from linkwork.foundation.status import Status
from linkwork.motion.branch_rows import Asked, BranchRows
from linkwork.motion.drive import Drive
from linkwork.motion.limits import BranchEnd
from linkwork.numerics.rows import SolvedRows

__all__ = ["NamedEnd", "SweepTable"]

_SAME_PLACE = 1e-11  # relative: values of the path so near to each other are one place


class _PlaceOfEnd(NamedTuple):
    """Where an end may be in the table, and how far that is from where it was met."""

    guessed: bool  # no row of its branch is next to it
    away: float
    t: float


def _slack_at(t: float) -> float:
    return _SAME_PLACE * max(1.0, abs(t))


#: The end of a branch, and the branch's name.
NamedEnd = tuple[BranchEnd, str]


class SweepTable:
    """Rows over values ``t`` of a path, in the order they were asked for.

    Parameters
    ----------
    found : BranchRows
        The rows of the branch that the table is begun with.
    windows : ((float, float), (float, float))
        Smallest and largest value of t that has a place in the table, and those that the sweep was
        asked for.
    free : bool
        Whether a row a whole turn away is the same position.
    """

    def __init__(
        self,
        drive: Drive,
        asked: Asked,
        found: BranchRows,
        windows: tuple[tuple[float, float], tuple[float, float]],
        free: bool,
    ) -> None:
        self.drive, self.asked, self.rows = drive, asked, found.rows
        self.window, self.span = windows
        self.free = free
        self._placed = found.placed.copy()
        self._ends: list[NamedEnd] = []
        self._extra: list[SolvedRows] = []
        self._extra_t: list[float] = []

    def not_straight(self, end: BranchEnd) -> IndexArray:
        """Rows beyond the end of a branch that are not there, or only whole turns around."""
        missing = self.rows.status != Status.CONVERGED.code
        missing |= self._placed != self.asked.t
        slack = end.slack + 4.0 * EPSILON * abs(end.t)
        return np.flatnonzero(missing & (end.side * (self.asked.t - end.t) > slack))

    def take(self, found: BranchRows, where: IndexArray) -> BoolArray:
        """Take rows of another branch, asked for at the rows ``where``; which of all were taken.

        Straight ahead comes before whole turns around, and of these the first position found.
        """
        straight = found.converged & (found.placed == self.asked.t[where])
        put = straight | (self.rows.status[where] != Status.CONVERGED.code)
        self.rows = self.rows.put(where[put], found.rows.take(np.flatnonzero(put)))
        self._placed[where[put]] = found.placed[put]
        taken = np.zeros(len(self.rows), dtype=bool)
        taken[where[put & found.converged]] = True
        return taken

    def leave_out(self, where: IndexArray, status: Status) -> None:
        """Give those of some rows that have no position a status."""
        there = self.rows.status[where] == Status.CONVERGED.code
        self.rows = self.rows.set(where[~there], status=status.code)

    def drop(self, where: IndexArray, status: Status) -> None:
        """Remove the positions of some rows, which were reached the other way around."""
        proved = self.rows.asks_for_proofs
        why = Certification.NO_POSITION if proved else Certification.NOT_ASKED
        inputs, variables = self.rows.inputs[where], self.rows.v.shape[1]
        self.rows = self.rows.put(where, SolvedRows.blank(inputs, variables, status, why))
        self._placed[where] = np.nan

    def places_of(self, t: float) -> list[float]:
        """Where a value belongs in the table's range, whole turns apart too."""
        low, high = self.window
        slack = _slack_at(max(abs(low), abs(high)))
        turns = np.zeros(1)
        if self.free:
            first = np.ceil((low - slack - t) / FULL_TURN)
            turns = np.arange(first, np.floor((high + slack - t) / FULL_TURN) + 1.0)
        here = t + turns * FULL_TURN
        return [float(x) for x in here if low - slack <= x <= high + slack]

    def turns_at(self, here: float) -> int:
        """By how many whole turns the names of rows next to a value of t differ from it.

        On a further branch the rows bear the inputs of the table, whole turns away if need be:
        one put between them does the same, inside the table's range if it can.
        """
        lead, scale = self.drive.lead, self.drive.unit
        named = self.asked.in_file_units[:, lead] * scale
        beside = np.argsort(np.abs(self.asked.t - here), kind="stable")[:2]
        turns = [round(float(named[k] - self.asked.t[k]) / FULL_TURN) for k in beside]
        slack = _slack_at(abs(here))
        low, high = self.span
        inside = [k for k in turns if low - slack <= here + k * FULL_TURN <= high + slack]
        return (inside or turns or [0])[0]

    def put_ends(self, ends: Sequence[NamedEnd]) -> list[BranchEnd]:
        """A row of its own for every end of a branch whose place lies in the table.

        Returned are the ends with their limits named as those rows are.
        """
        self._ends += ends
        placed = {k: places[0] for k, (end, _) in enumerate(ends) if (places := self._places(end))}
        named = [end for end, _ in ends]
        for k in sorted(placed, key=placed.__getitem__):
            (end, branch), here = ends[k], placed[k].t
            if self._put_at(end, branch, here) or not placed[k].guessed:
                named[k] = self._named(end, here)
        return named

    def named(self, end: BranchEnd) -> BranchEnd:
        """An end with its limit named in the range of the table, if it has a place there."""
        places = self._places(end)
        return self._named(end, places[0].t) if places else end

    def _named(self, end: BranchEnd, here: float) -> BranchEnd:
        """The end named at a place; as a row that was asked for there is, if it may be that."""
        lead = self.drive.lead
        named = end.with_input_named(float(self._inputs(end, here)[0, lead]))
        low, high = named.limit.bracket
        if not named.limit.located:
            return named
        for row in np.flatnonzero(np.abs(self.asked.t - here) <= _slack_at(here)):
            asked = float(self.asked.in_file_units[row, lead])
            if low <= asked <= high:
                return replace(named, limit=replace(named.limit, input=asked))
        return named

    def _places(self, end: BranchEnd) -> list[_PlaceOfEnd]:
        """Where an end belongs in the table, best first.

        It belongs whole turns away only if rows on the branch's side of it were found as many turns
        away, or no such row was found.
        """
        found = []
        for here in self.places_of(end.t):
            away = abs(here - end.t)
            beside = np.flatnonzero(end.side * (here - self.asked.t) > _slack_at(abs(here)))
            if not len(beside):
                found.append(_PlaceOfEnd(True, away, here))
                continue
            nearest = beside[np.abs(self.asked.t[beside] - here).argmin()]
            gap = self.asked.t[nearest] - self._placed[nearest] - (here - end.t)
            if not abs(gap) > 1.0:  # NaN is no row
                found.append(_PlaceOfEnd(bool(np.isnan(gap)), away, here))
        return sorted(found)

    def _put_at(self, end: BranchEnd, branch: str, here: float) -> bool:
        if end.v is None or end.first is None:
            return True
        slack = end.slack + 4.0 * EPSILON * abs(here)
        return self.put(self._row_of(end, end.v, end.first, branch, here), here, slack)

    def _row_of(
        self, end: BranchEnd, v: Array, first: Array, branch: str, here: float
    ) -> SolvedRows:
        solver = self.drive.solver
        row = SolvedRows.blank(self._inputs(end, here), solver.variables, Status.CONVERGED)
        return row.set(
            v=v,
            first=first,
            residual=solver.residual(v[None, :]),
            condition=np.inf,
            certification=end.certification.code,
            radius=end.radius,
            uniqueness_radius=end.uniqueness_radius,
            branch=branch,
            limit=end.limit.kind.word,
        )

    def put(self, row: SolvedRows, here: float, slack: float | None = None) -> bool:
        """A row at a value of t: in the place of one that was asked for just there, or between.

        ``slack``: how far a row that was asked for just there may be. Whether it was put: where a
        limit is already nothing is.
        """
        slack = _slack_at(here) if slack is None else slack
        if any(abs(t - here) <= slack for t in self._extra_t):
            return False
        same = np.flatnonzero(np.abs(self.asked.t - here) <= slack)
        fresh = [k for k in same if not self.rows.limit[k]]
        for k in fresh:
            row = row.set(inputs=self.rows.inputs[k])
            self.rows = self.rows.put(np.array([k]), row)
        if not len(same):
            self._extra.append(row)
            self._extra_t.append(here)
        return bool(fresh) or not len(same)

    def finish(self) -> tuple[SolvedRows, BoolArray]:
        """All rows in the table's order, and which of them were not asked for."""
        everywhere = [(p, k) for k, (end, _) in enumerate(self._ends) for p in self._places(end)]
        for place, k in sorted(everywhere):  # where nothing else is, whole turns away
            self._put_at(*self._ends[k], place.t)
        added = np.arange(len(self.rows) + len(self._extra)) >= len(self.rows)
        if not self._extra:
            return self.rows, added
        t = np.concatenate([self.asked.t, self._extra_t])
        backwards = len(self.asked.t) > 1 and self.asked.t[-1] < self.asked.t[0]
        order = np.argsort(-t if backwards else t, kind="stable")
        return SolvedRows.concatenate([self.rows, *self._extra]).take(order), added[order]

    def is_among(self, here: float, own: BoolArray) -> bool:
        """Whether one of the rows next to a value of t is among some rows (B,)."""
        order = np.argsort(self.asked.t, kind="stable")
        t = self.asked.t[order]
        slack = _slack_at(abs(here))
        left = int(np.searchsorted(t, here + slack, side="right")) - 1
        right = int(np.searchsorted(t, here - slack, side="left"))
        beside = [order[k] for k in (left, right) if 0 <= k < len(t)]
        return bool(own[beside].any())

    def _inputs(self, end: BranchEnd, here: float) -> Array:
        """The inputs at an end as short numbers, shifted by the whole turns to ``here``, (1, p)."""
        scale, path = self.drive.model.input_scale, self.drive.path
        in_file_units = np.array([short_number(x) for x in path.at(end.t) / scale])
        in_file_units[self.drive.lead] = end.limit.input
        turns = round((here - end.t) / FULL_TURN) + self.turns_at(here)
        return (in_file_units + turns * path.rate * (FULL_TURN / scale))[None, :]
