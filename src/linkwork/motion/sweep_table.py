"""The table of a sweep as it fills: rows asked for, and rows of limits in their places."""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.status import Status
from linkwork.motion.branch_rows import Asked
from linkwork.motion.limits import BranchEnd
from linkwork.motion.model import Model
from linkwork.motion.rows import SolvedRows
from linkwork.numerics.track import InputPath

__all__ = ["SweepTable"]

_SAME_INPUT = 1e-11  # relative: a row asked for at a limit is that limit's row
_FULL_TURN = 2.0 * np.pi


class SweepTable:
    """Rows over values ``t`` of a path, in the order they were asked for.

    Parameters
    ----------
    lead : int
        The input that t is.
    window : (float, float)
        Smallest and largest value of t that has a place in the table.
    free : bool
        Whether a row a whole turn away is the same position.
    """

    def __init__(
        self,
        model: Model,
        path: InputPath,
        lead: int,
        asked: Asked,
        rows: SolvedRows,
        window: tuple[float, float],
        free: bool,
    ) -> None:
        self.model, self.path, self.lead = model, path, lead
        self.asked, self.rows = asked, rows
        self.window, self.free = window, free
        self._extra: list[SolvedRows] = []
        self._extra_t: list[float] = []

    def place_of(self, t: float) -> float | None:
        """Where a value belongs in the table's range, whole turns apart if need be."""
        low, high = self.window
        slack = self._slack(max(abs(low), abs(high)))
        here = t
        if self.free:
            up = max(0.0, np.ceil((low - slack - t) / _FULL_TURN))
            down = max(0.0, np.ceil((t - high - slack) / _FULL_TURN))
            here = float(t + (up - down) * _FULL_TURN)
        return here if low - slack <= here <= high + slack else None

    def put_end(self, end: BranchEnd, branch: str) -> None:
        """A row of its own for the end of a branch, if its place lies in the table."""
        here = None if end.v is None else self.place_of(end.t)
        if here is None or end.v is None or end.first is None:
            return
        solver = self.model.compiled.solver
        row = SolvedRows.blank(self._inputs(end, here), solver.variables, Status.CONVERGED)
        row.v[0], row.first[0] = end.v, end.first
        row.residual[0] = float(solver.residual(end.v[None, :])[0])
        row.condition[0] = np.inf
        row.certification[0] = end.certification.code
        row.radius[0], row.unique[0] = end.radius, end.unique
        row.branch[0], row.limit[0] = branch, end.limit.kind.word
        self.put(row, here)

    def put(self, row: SolvedRows, here: float) -> None:
        """A row at a value of t: in the place of one that was asked for just there, or between."""
        slack = self._slack(abs(here))
        if any(abs(t - here) <= slack for t in self._extra_t):
            return
        same = np.flatnonzero(np.abs(self.asked.t - here) <= slack)
        for k in same:
            row.inputs[0] = self.rows.inputs[k]
            self.rows.put(np.array([k]), row)
        if not len(same):
            self._extra.append(row)
            self._extra_t.append(here)

    def finished(self) -> tuple[SolvedRows, BoolArray]:
        """All rows in the table's order, and which of them were not asked for."""
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
        scale = self.model.input_scale
        everyday = np.array([_short(x) for x in self.path.at(end.t) / scale])
        everyday[self.lead] = end.limit.input
        turns = round((here - end.t) / _FULL_TURN)
        return (everyday + turns * self.path.rate * (_FULL_TURN / scale))[None, :]

    @staticmethod
    def _slack(size: float) -> float:
        return _SAME_INPUT * max(1.0, size)


def _short(value: float) -> float:
    """The value to nine decimals where that is the same number to rounding."""
    short = round(float(value), 9)
    return short if abs(short - value) <= 1e-14 * max(1.0, abs(value)) else float(value)
