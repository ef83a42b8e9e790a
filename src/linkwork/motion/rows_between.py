"""Positions between neighbouring rows of a motion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, BoolArray, IndexArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import CONVERGED, Status
from linkwork.motion.drive import Drive
from linkwork.motion.leading_input import leading_input
from linkwork.motion.model import Model
from linkwork.motion.motion_of_rows import motion_of_rows
from linkwork.numerics.continuation.branch_tracking import (
    follow,
    node_at,
    quintic,
    rows_of_nodes,
)
from linkwork.numerics.newton import unlimited
from linkwork.numerics.rows import SolvedRows
from linkwork.results.motion import Motion
from linkwork.results.quantities.definition import CLOSE_ROWS
from linkwork.results.quantity import Kind

__all__ = ["RowsBetween"]

_MOVED = 0.1  # weighted: further from the interpolation a position may be on another branch
# from the straight line between two rows; on another turn positions are farther
_REACH = 1.0  # weighted
_REACH_OF_CHANGE = 0.5  # in addition, of what changes between the rows
_OF_PIECE = 5  # rows in a piece of a cam or law
_MOST_PARTS = 3600  # of the table
_SAME_TURN = 1.0  # of the leading input: rows named whole turns away differ by more


@dataclass(frozen=True, eq=False)
class RowsBetween:
    """Solves positions between the rows of a motion, each on the branch of its neighbours."""

    model: Model
    rows: SolvedRows

    @cached_property
    def _drive(self) -> Drive:
        lead, rate = leading_input(self.model.rows)
        return Drive.through(self.model, self.model.rows[0], rate, lead)

    @cached_property
    def _places(self) -> tuple[Array, Array]:
        """The leading input of the positions and as rows name it, (R,) [rad or length]."""
        drive, rows = self._drive, self.rows
        t = rows.v[:, drive.solver.unknowns + drive.lead]
        return t, rows.inputs[:, drive.lead] * drive.unit

    @cached_property
    def _regular(self) -> BoolArray:
        """Rows with rates, (R,)."""
        rows = self.rows
        parts = (rows.v, rows.first, rows.second)
        regular: BoolArray = np.all([np.isfinite(part).all(axis=1) for part in parts], axis=0)
        regular &= rows.status == CONVERGED
        return regular

    @cached_property
    def joined(self) -> BoolArray:
        """Whether a row and the next one are neighbours on one branch, (R - 1,)."""
        (t, named), found, branch = self._places, self.rows.status == CONVERGED, self.rows.branch
        regular = self._regular
        with np.errstate(invalid="ignore"):
            near = np.abs(np.diff(named - t)) < _SAME_TURN
            apart = np.diff(t) != 0.0
        one = near & apart & (branch[1:] == branch[:-1])
        joined: BoolArray = one & found[1:] & found[:-1] & (regular[1:] | regular[:-1])
        return joined

    @cached_property
    def switches(self) -> Array:
        """Where rows just beside switches of loads would be, as rows name them, rising, (K,)."""
        t = self._places[1]
        if not self.joined.all() or len(t) < 2:
            return np.zeros(0)
        order = np.argsort(t, kind="stable")
        rising = t[order]

        def at(places: Array) -> Motion:
            k = np.clip(rising.searchsorted(places, side="right") - 1, 0, len(t) - 2)
            return self(np.minimum(order[k], order[k + 1]), places)

        return self.model.beside_switches(at, rising)

    @cached_property
    def far(self) -> float:
        """The largest step that shows all extremes of smooth quantities [rad or length]."""
        model, span = self.model, float(np.ptp(self._places[1]))
        description, numbers = model.description, model.description.numbers
        kind = Kind(model.equations.inputs[self._drive.lead].kind)
        if description.timed:
            laws = [which.law for which in description.inputs if isinstance(which.law, tuple)]
            pieces = [segment.duration(numbers) for law in laws for segment in law]
        else:
            cams = [getattr(part, "segments", ()) for part in getattr(description, "parts", ())]
            unit = description.angle.radians if kind is Kind.ANGLE else np.inf
            pieces = [numbers(segment.over) * unit for cam in cams for segment in cam]
        whole = FULL_TURN if kind is Kind.ANGLE else span
        least = max(min(pieces, default=np.inf) / _OF_PIECE, span / _MOST_PARTS)
        return min(whole / CLOSE_ROWS, least)

    def __call__(self, row: IndexArray, at: Array) -> Motion:
        """Positions at leading inputs (K,) between rows (K,) and the next ones.

        Rows that lead to none have the status of a lost branch.
        """
        solver, rows = self._drive.solver, self.rows
        t, named = self._places
        here = t[row] + (at - named[row])
        found = SolvedRows.blank(
            self._inputs(row, here), solver.variables, Status.LOST, Certification.NOT_ASKED
        )
        smooth = np.flatnonzero(self._regular[row] & self._regular[row + 1])
        if len(smooth):
            found = found.put(smooth, self._interpolated(row[smooth], here[smooth]))
        left = np.flatnonzero(found.status != CONVERGED)
        found = found.put(*self._followed(left, row[left], here[left]))
        found = found.set(branch=rows.branch[row])
        return motion_of_rows(self.model, found, "", np.ones(len(row), dtype=bool))

    def _followed(
        self, number: IndexArray, row: IndexArray, here: Array
    ) -> tuple[IndexArray, SolvedRows]:
        """Positions followed from rows with rates, one after the other; those that were reached,
        by their numbers.
        """
        (t, _), drive, rows = self._places, self._drive, self.rows
        begin = np.where(self._regular[row], row, row + 1)
        reached, nodes = [], []
        node, last = None, -1
        for k in np.lexsort((np.abs(here - t[begin]), begin)).tolist():
            if node is None or begin[k] != last:
                last = int(begin[k])
                node = node_at(drive.solver, drive.path, float(t[last]), rows.v[last])
            track, end = follow(drive.solver, drive.path, node, float(here[k]))
            if end is None:
                node = track[-1] if track else node
                reached.append(k)
                nodes.append(node)
        if not nodes:
            return number[:0], rows.take(slice(0))
        solved = rows_of_nodes(nodes)
        found = solved.with_columns(
            status=np.full(len(nodes), CONVERGED, dtype=np.int8),
            condition=np.array([node.condition for node in nodes]),
        )
        return number[reached], found

    def _inputs(self, row: IndexArray, here: Array) -> Array:
        """All inputs as neighbouring rows name them, (K, p) file units."""
        t, rate = self._places[0], self._drive.path.rate
        away = (here - t[row])[:, None] * rate / self.model.input_scale
        return np.asarray(self.rows.inputs[row] + away)

    def _interpolated(self, row: IndexArray, here: Array) -> SolvedRows:
        """Positions from quintics between rows; lost where they may be on another branch."""
        drive, solver, rows, t = self._drive, self._drive.solver, self.rows, self._places[0]
        h = (t[row + 1] - t[row])[:, None]
        left, right = rows.take(row), rows.take(row + 1)
        guess = quintic((here - t[row])[:, None] / h, h, left, right)
        guess[:, solver.unknowns :] = drive.path.at(here)
        tolerance = solver.options.solution_tolerance
        done = solver.solve(guess, unlimited(solver.options, 12, tolerance))
        rates = solver.rates(done.v, drive.path.rate)
        expected = solver.rates(left.v, drive.path.rate).orientation
        moved = np.abs((done.v - guess) / solver.variable_scale).max(axis=1)
        good = (done.status == CONVERGED) & (moved <= _MOVED)
        good &= (rates.orientation == expected).all(axis=1)
        away = np.abs(done.v - left.v - (here - t[row])[:, None] / h * (right.v - left.v))
        scale = solver.variable_scale
        good &= (away <= _REACH * scale + _REACH_OF_CHANGE * np.abs(right.v - left.v)).all(axis=1)
        return SolvedRows(
            v=done.v,
            first=rates.first,
            second=rates.second,
            condition=rates.condition,
            residual=done.residual,
            iterations=done.iterations,
            status=np.where(good, CONVERGED, Status.LOST.code).astype(np.int8),
        )
