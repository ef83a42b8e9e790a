"""The table of a sweep: requested rows, and rows of limits in their places."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.core.foundation.names import short_number
from linkwork.core.foundation.rounding import EPSILON
from linkwork.core.foundation.statuses import Certification, Status
from linkwork.core.foundation.units import FULL_TURN
from linkwork.core.motion.branch_rows import Asked, BranchRows
from linkwork.core.motion.following import Drive
from linkwork.core.motion.limits import BranchEnd
from linkwork.core.numerics.system import SolvedRows

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
    period : float
        How far away rows are the same position, or infinity.
    """

    def __init__(
        self,
        drive: Drive,
        asked: Asked,
        found: BranchRows,
        windows: tuple[tuple[float, float], tuple[float, float]],
        period: float,
    ) -> None:
        self.drive, self.asked, self.rows = drive, asked, found.rows
        self.window, self.span = windows
        self.period = period
        self._placed = found.placed.copy()
        self._order = np.argsort(asked.t, kind="stable")
        self._sorted = asked.t[self._order]
        self._ends: list[NamedEnd] = []
        self._replaced: dict[int, SolvedRows] = {}  # by the row of the table
        self._between: dict[float, SolvedRows] = {}  # by t
        self._between_t: list[float] = []  # sorted

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

    def places_of(self, t: float) -> Array:
        """Where a value belongs in the table's range, whole periods apart too, (P,).

        Of many places between two rows only those next to the rows count.
        """
        low, high = self.window
        slack = _slack_at(max(abs(low), abs(high)))
        here = np.array([t])
        if np.isfinite(self.period):
            first = np.ceil((low - slack - t) / self.period)
            last = np.floor((high + slack - t) / self.period)
            if last - first < 2 * len(self._sorted):
                number = np.arange(first, last + 1.0)
            else:
                below = np.floor((self._sorted - t) / self.period)
                number = np.unique(np.concatenate([below, below + 1.0]))
            here = t + number * self.period
        return here[(here >= low - slack) & (here <= high + slack)]

    def _beside(self, here: Array, apart: float) -> tuple[IndexArray, IndexArray]:
        """The sorted rows below values of t (P,) and above them, -1 and B where there is none.

        ``apart``: how far away at least, relative; negative for rows that may be there.
        """
        slack = apart * np.maximum(1.0, np.abs(here))
        below = np.searchsorted(self._sorted, here - slack, side="left") - 1
        return below, np.searchsorted(self._sorted, here + slack, side="right")

    def turns_at(self, here: float) -> int:
        """By how many whole turns the names of rows next to a value of t differ from it.

        On a further branch the rows bear the inputs of the table, whole turns away if need be:
        one put between them does the same, inside the table's range if it can.
        """
        lead, scale = self.drive.lead, self.drive.unit
        at = int(np.searchsorted(self._sorted, here))
        near = np.arange(max(0, at - 2), min(len(self._sorted), at + 2))
        beside = self._order[near[np.argsort(np.abs(self._sorted[near] - here), kind="stable")[:2]]]
        named = self.asked.in_file_units[beside, lead] * scale
        turns = [round(float(gap) / FULL_TURN) for gap in named - self.asked.t[beside]]
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
        for row in self._rows_at(here, _slack_at(here)):
            asked = float(self.asked.in_file_units[row, lead])
            if low <= asked <= high:
                return replace(named, limit=replace(named.limit, input=asked))
        return named

    def _rows_at(self, here: float, slack: float) -> IndexArray:
        """The rows that were asked for at a value of t."""
        first = np.searchsorted(self._sorted, here - slack, side="left")
        last = np.searchsorted(self._sorted, here + slack, side="right")
        return self._order[first:last]

    def _places(self, end: BranchEnd) -> list[_PlaceOfEnd]:
        """Where an end belongs in the table, best first.

        It belongs whole turns away only if rows on the branch's side of it were found as many turns
        away, or no such row was found.
        """
        here = self.places_of(end.t)
        below, above = self._beside(here, _SAME_PLACE)
        nearest = below if end.side > 0 else above
        none = (nearest < 0) | (nearest == len(self._sorted))
        row = self._order[np.where(none, 0, nearest)]
        gap = self.asked.t[row] - self._placed[row] - (here - end.t)
        guessed = none | np.isnan(gap)
        keep = np.flatnonzero(guessed | (np.abs(gap) <= 1.0))
        return sorted(
            _PlaceOfEnd(bool(guessed[k]), abs(float(here[k]) - end.t), float(here[k])) for k in keep
        )

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
        place = bisect_left(self._between_t, here - slack)
        if any(t <= here + slack for t in self._between_t[place : place + 1]):
            return False
        same = self._rows_at(here, slack).tolist()
        fresh = [k for k in same if k not in self._replaced]
        for k in fresh:
            self._replaced[k] = row.set(inputs=self.rows.inputs[k])
        if not same:
            insort(self._between_t, here)
            self._between[here] = row
        return bool(fresh) or not same

    def finish(self) -> tuple[SolvedRows, BoolArray]:
        """All rows in the table's order, and which of them were not asked for."""
        everywhere = [(p, k) for k, (end, _) in enumerate(self._ends) for p in self._places(end)]
        for place, k in sorted(everywhere):  # where nothing else is, whole turns away
            self._put_at(*self._ends[k], place.t)
        rows = self.rows
        if self._replaced:
            others = SolvedRows.concatenate(list(self._replaced.values()))
            rows = rows.put(np.array(list(self._replaced)), others)
        added = np.arange(len(rows) + len(self._between)) >= len(rows)
        if not self._between:
            return rows, added
        t = np.concatenate([self.asked.t, list(self._between)])
        backwards = len(self.asked.t) > 1 and self.asked.t[-1] < self.asked.t[0]
        order = np.argsort(-t if backwards else t, kind="stable")
        rows = SolvedRows.concatenate([rows, *self._between.values()])
        return rows.take(order), added[order]

    def shows(self, t: float, here: Array, own: BoolArray) -> BoolArray:
        """At which places (P,) of a value of t a neighbouring row shows the same turn of a branch.

        Parameters
        ----------
        own : (B,)
            The rows of that branch.
        """
        shown = np.zeros(len(here), dtype=bool)
        below, above = self._beside(here, -_SAME_PLACE)
        for beside in (below, above):
            row = self._order[beside.clip(0, len(self._sorted) - 1)]
            away = self.asked.t[row] - self._placed[row] - (here - t)
            there = (beside >= 0) & (beside < len(self._sorted))
            shown |= there & own[row] & (np.abs(away) <= 1.0)
        return shown

    def _inputs(self, end: BranchEnd, here: float) -> Array:
        """The inputs at an end as short numbers, shifted by the whole turns to ``here``, (1, p)."""
        scale, path = self.drive.model.input_scale, self.drive.path
        in_file_units = np.array([short_number(x) for x in path.at(end.t) / scale])
        in_file_units[self.drive.lead] = end.limit.input
        turns = round((here - end.t) / FULL_TURN) + self.turns_at(here)
        return (in_file_units + turns * path.rate * (FULL_TURN / scale))[None, :]
