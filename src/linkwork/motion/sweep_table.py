"""The table of a sweep as it fills: rows asked for, and rows of limits in their places."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.short_number import short_number
from linkwork.foundation.status import Status
from linkwork.motion.branch_rows import Asked
from linkwork.motion.drive import Drive
from linkwork.motion.limits import BranchEnd
from linkwork.motion.rows import SolvedRows

__all__ = ["SweepTable"]

_SAME_INPUT = 1e-11  # relative: a row asked for at a limit is that limit's row


class SweepTable:
    """Rows over values ``t`` of a path, in the order they were asked for.

    Parameters
    ----------
    window : (float, float)
        Smallest and largest value of t that has a place in the table.
    span : (float, float)
        Smallest and largest value of t that the sweep was asked for.
    free : bool
        Whether a row a whole turn away is the same position.
    """

    def __init__(
        self,
        drive: Drive,
        asked: Asked,
        rows: SolvedRows,
        window: tuple[float, float],
        span: tuple[float, float],
        free: bool,
    ) -> None:
        self.drive, self.asked, self.rows = drive, asked, rows
        self.window, self.span, self.free = window, span, free
        self._ends: list[tuple[BranchEnd, str]] = []
        self._extra: list[SolvedRows] = []
        self._extra_t: list[float] = []

    def places_of(self, t: float) -> list[float]:
        """Where a value belongs in the table's range, whole turns apart too."""
        low, high = self.window
        slack = self._slack(max(abs(low), abs(high)))
        turns = np.zeros(1)
        if self.free:
            first = np.ceil((low - slack - t) / FULL_TURN)
            turns = np.arange(first, np.floor((high + slack - t) / FULL_TURN) + 1.0)
        here = t + turns * FULL_TURN
        return [float(x) for x in here if low - slack <= x <= high + slack]

    def turns_at(self, here: float) -> int:
        """By how many whole turns rows beside a value of t are named apart from it.

        On a further branch the rows bear the inputs of the table, whole turns away if need be:
        one put between them does the same, inside the table's range if it can.
        """
        lead, scale = self.drive.lead, self.drive.unit
        named = self.asked.everyday[:, lead] * scale
        beside = np.argsort(np.abs(self.asked.t - here), kind="stable")[:2]
        turns = [round(float(named[k] - self.asked.t[k]) / FULL_TURN) for k in beside]
        slack = self._slack(abs(here))
        low, high = self.span
        inside = [k for k in turns if low - slack <= here + k * FULL_TURN <= high + slack]
        return (inside or turns or [0])[0]

    def put_end(self, end: BranchEnd, branch: str) -> BranchEnd:
        """A row of its own for the end of a branch, if its place lies in the table.

        Returned is the end with its limit named as that row is.
        """
        self._ends.append((end, branch))
        here = self._place_of(end)
        if here is not None:
            self._put_at(end, branch, here)
        return self.named(end)

    def named(self, end: BranchEnd) -> BranchEnd:
        """An end with its limit named in the range of the table, if it has a place there."""
        here = self._place_of(end)
        if here is None:
            return end
        return end.named(float(self._inputs(end, here)[0, self.drive.lead]))

    def _place_of(self, end: BranchEnd) -> float | None:
        """Where an end belongs in the table: where the table goes on on the branch's side of it."""
        low, high = self.span
        slack = self._slack(max(abs(low), abs(high)))
        places = self.places_of(end.t)
        beside = [
            here for here in places if (here > low + slack if end.side > 0 else here < high - slack)
        ]
        return min(beside or places, key=lambda here: abs(here - end.t), default=None)

    def _put_at(self, end: BranchEnd, branch: str, here: float) -> None:
        if end.v is not None and end.first is not None:
            self.put(self._row_of(end, end.v, end.first, branch, here), here)

    def _row_of(
        self, end: BranchEnd, v: Array, first: Array, branch: str, here: float
    ) -> SolvedRows:
        solver = self.drive.solver
        row = SolvedRows.blank(self._inputs(end, here), solver.variables, Status.CONVERGED)
        row.v[0], row.first[0] = v, first
        row.residual[0] = float(solver.residual(v[None, :])[0])
        row.condition[0] = np.inf
        row.certification[0] = end.certification.code
        row.radius[0], row.unique[0] = end.radius, end.unique
        row.branch[0], row.limit[0] = branch, end.limit.kind.word
        return row

    def put(self, row: SolvedRows, here: float) -> None:
        """A row at a value of t: in the place of one that was asked for just there, or between."""
        slack = self._slack(abs(here))
        if any(abs(t - here) <= slack for t in self._extra_t):
            return
        same = np.flatnonzero(np.abs(self.asked.t - here) <= slack)
        for k in same:
            if self.rows.limit[k]:
                continue
            row.inputs[0] = self.rows.inputs[k]
            self.rows.put(np.array([k]), row)
        if not len(same):
            self._extra.append(row)
            self._extra_t.append(here)

    def finished(self) -> tuple[SolvedRows, BoolArray]:
        """All rows in the table's order, and which of them were not asked for."""
        for end, branch in self._ends:  # where nothing else is, whole turns away
            for here in self.places_of(end.t):
                self._put_at(end, branch, here)
        added = np.arange(len(self.rows) + len(self._extra)) >= len(self.rows)
        if not self._extra:
            return self.rows, added
        t = np.concatenate([self.asked.t, self._extra_t])
        backwards = len(self.asked.t) > 1 and self.asked.t[-1] < self.asked.t[0]
        order = np.argsort(-t if backwards else t, kind="stable")
        return SolvedRows.joined([self.rows, *self._extra]).take(order), added[order]

    def is_among(self, here: float, own: BoolArray) -> bool:
        """Whether one of the rows beside a value of t is among some rows (B,)."""
        order = np.argsort(self.asked.t, kind="stable")
        t = self.asked.t[order]
        slack = self._slack(abs(here))
        left = int(np.searchsorted(t, here + slack, side="right")) - 1
        right = int(np.searchsorted(t, here - slack, side="left"))
        beside = [order[k] for k in (left, right) if 0 <= k < len(t)]
        return bool(own[beside].any())

    def _inputs(self, end: BranchEnd, here: float) -> Array:
        """Everyday inputs at an end, shifted by the whole turns to ``here``, (1, p)."""
        scale, path = self.drive.model.input_scale, self.drive.path
        everyday = np.array([short_number(x) for x in path.at(end.t) / scale])
        everyday[self.drive.lead] = end.limit.input
        turns = round((here - end.t) / FULL_TURN) + self.turns_at(here)
        return (everyday + turns * path.rate * (FULL_TURN / scale))[None, :]

    @staticmethod
    def _slack(size: float) -> float:
        return _SAME_INPUT * max(1.0, size)
