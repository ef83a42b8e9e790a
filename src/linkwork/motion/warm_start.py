"""The cycle of a design, started from the cycle of a neighbouring design."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, BoolArray, StatusArray
from linkwork.foundation.certification import Certification
from linkwork.foundation.status import Status
from linkwork.foundation.value_types import check_class
from linkwork.motion.model import Model
from linkwork.motion.motion_of_rows import motion_of_rows
from linkwork.motion.positions import input_rate
from linkwork.motion.start import first_position
from linkwork.motion.tracking import turns_freely
from linkwork.numerics.newton import NewtonOptions
from linkwork.numerics.rows import SolvedRows
from linkwork.results.motion import Limit, LimitKind, Motion

__all__ = ["warm_started"]

_STEPS = 8  # of Newton-Raphson; a neighbour needs three or four
_NEAR = 0.2  # rad, or of the longest link: the largest change of a row from one design to the next
_NEAR_FOLD = 0.6  # the same from a parabola, near a dead point
_GROWTH = 12  # rows by which a dead point may recede from one design to the next
_SAME_DIRECTION = 1e-9  # rad: a table over a whole turn ends where it begins


def warm_started(model: Model, before: Motion) -> Motion | None:
    """The positions of a design from those of a neighbour, all rows at once.

    Newton-Raphson starts every row from the neighbour's. Where dead points bound the motion, rows
    are lost or won near them one by one. Nothing is proved, and where a dead point lies is only
    estimated.

    Parameters
    ----------
    before : Motion
        The cycle of a design whose numbers differ a little.

    Returns
    -------
    Motion or None
        ``None`` where the branch has to be followed anew: the neighbour's cycle has another
        table or ends at more than dead points, rows move far, or dead points do.
    """
    check_class("the neighbour", before, Motion)
    asked = before.asked
    q, found = before.q[asked], before.found[asked]
    rows, solver = model.rows, model.compiled.solver
    fits = q.shape == (len(rows), solver.unknowns) and found.any()
    if not fits or any(limit.kind is not LimitKind.DEAD_POINT for limit in before.limits):
        return None
    work = _Renewal(model, np.concatenate([q, rows], axis=1))
    work.correct(found)
    limits: tuple[Limit, ...] = ()
    if not (work.found.all() and work.has_one_sign):
        ends = work.bound()
        if ends is None:
            return None
        limits = tuple(work.limit(*end) for end in ends)
    names = [name for name, ok in zip(before.branch, before.found, strict=True) if ok]
    lost = int((~work.found).sum())
    message = f"{lost} of {len(rows)} positions were not found" if lost else Status.CONVERGED.value
    none_added = np.zeros(len(rows), dtype=bool)
    motion = motion_of_rows(model, work.solve(names[0]), message, none_added)
    return replace(motion, limits=limits)


@dataclass(frozen=True)
class _Fold:
    """Unknowns (n,) near a dead point as a parabola over the one that moves fastest, x.

    From x' = a, x'' = b by the input u follow du/dx = 1/a and d²u/dx² = -b/a³: the input turns
    back where dx = a²/b, du = a/2b.
    """

    first: Array
    second: Array

    @property
    def _fastest(self) -> tuple[float, float]:
        k = int(np.argmax(np.abs(self.first)))
        return float(self.first[k]), float(self.second[k])

    @property
    def distance(self) -> float:
        """How far away the input turns back, negative backwards; infinite where it does not."""
        a, b = self._fastest
        return a / (2.0 * b) if b else math.inf

    def moved(self, step: float) -> Array:
        """By how much the unknowns change with the input; at most as far as to the dead point."""
        a, b = self._fastest
        # without a second derivative there is no parabola: straight on
        if not a or not b:
            return step * self.first
        # the root of u(dx) = step that vanishes with the step, cut off at the dead point
        dx = a * a / b * (1.0 - math.sqrt(max(0.0, 1.0 - 2.0 * b * step / a)))
        bend = (self.second * a - self.first * b) / a**3
        return np.asarray(self.first / a * dx + 0.5 * bend * dx * dx)


@dataclass
class _Renewal:
    """Rows on their way to a new design: v (B, N), and which of them are found (B,)."""

    model: Model
    v: Array

    def __post_init__(self) -> None:
        count, solver = len(self.v), self.model.compiled.solver
        self.rate = input_rate(self.model)
        self.found: BoolArray = np.zeros(count, dtype=bool)
        self.first, self.second = np.full_like(self.v, np.nan), np.full_like(self.v, np.nan)
        self.iterations = np.zeros(count, dtype=np.int64)
        self.residual, self.condition = np.full(count, np.nan), np.full(count, np.inf)
        self.orientation = np.zeros((count, len(solver.blocks)), dtype=np.int8)

    @property
    def has_one_sign(self) -> bool:
        """Whether det J has one sign, and is not zero, over all rows that are found."""
        signs = self.orientation[self.found]
        return bool(signs.all() and (signs == signs[:1]).all())

    def correct(self, rows: BoolArray, near: float = _NEAR) -> None:
        """Newton-Raphson at some rows, from where they are; found are those that stay near."""
        solver = self.model.compiled.solver
        here = np.flatnonzero(rows)
        options = replace(solver.options, max_steps=_STEPS, largest_turn=math.inf)
        done = solver.solve(self.v[here], options)
        moved = np.abs((done.v - self.v[here]) / solver.variable_scale).max(axis=1)
        # a row that moves far has probably found another configuration
        good = (done.status == Status.CONVERGED.code) & (moved <= near)
        here = here[good]
        self.found[here] = True
        self.v[here] = done.v[good]
        self.iterations[here], self.residual[here] = done.iterations[good], done.residual[good]
        rates = solver.rates(self.v[here], self.rate)
        self.first[here], self.second[here] = rates.first, rates.second
        self.condition[here], self.orientation[here] = rates.condition, rates.orientation

    def bound(self) -> list[tuple[int, int]] | None:
        """Keep the rows that are connected with the start, and win those next to them.

        Returns
        -------
        list of (last row found, first row missing) or None
            The dead points; ``None`` if the connected rows cannot be found.
        """
        model = self.model
        start = first_position(model, model.start_inputs, NewtonOptions(), explained=False)
        origin = self._row_of_start()
        if not start.status.ok or origin is None:
            return None
        sign = model.compiled.solver.rates(start.v[None, :], self.rate).orientation[0]
        # rows on the other side of a dead point belong to another branch
        self.found &= (self.orientation == sign).all(axis=1)
        if not self.found[origin]:
            return None
        reached = np.zeros_like(self.found)
        reached[origin] = True
        ends = []
        for way in (-1, 1):
            last, won = origin, 0
            while (ahead := self._next(last, way)) not in (None, origin):
                if not self.found[ahead]:
                    # a dead point that recedes so far is better found by following the branch
                    if won == _GROWTH:
                        return None
                    if not self._win_row(last, ahead, sign):
                        ends.append((last, ahead))
                        break
                    won += 1
                last = ahead
                reached[last] = True
        self.found &= reached
        return ends

    @cached_property
    def _around(self) -> bool:
        """Whether the table leads once around, to where it began."""
        span = abs(float(np.ptp(self.model.rows[:, 0])))
        return abs(span - FULL_TURN) < _SAME_DIRECTION and turns_freely(self.model)

    def _row_of_start(self) -> int | None:
        """The row nearest to the start's own input; ``None`` if the table does not lead by it."""
        if len(self.rate) != 1:
            return None
        away = self.model.rows[:, 0] - self.model.start_inputs[0]
        if self._around:
            away = np.remainder(away + FULL_TURN / 2, FULL_TURN) - FULL_TURN / 2
        elif turns_freely(self.model) or away.min() > 0.0 or away.max() < 0.0:
            return None
        return int(np.argmin(np.abs(away)))

    def _next(self, row: int, way: int) -> int | None:
        ahead = row + way
        if 0 <= ahead < len(self.v):
            return ahead
        return ahead % len(self.v) if self._around else None

    def _win_row(self, last: int, ahead: int, sign: StatusArray) -> bool:
        """Whether a row is found from its neighbour."""
        n = self.model.compiled.solver.unknowns
        step = self.model.rows[ahead, 0] - self.model.rows[last, 0]
        step = 0.0 if abs(ahead - last) > 1 else step  # around: the same place
        self.v[ahead, :n] = self.v[last, :n] + self._fold(last).moved(step)
        alone = np.zeros_like(self.found)
        alone[ahead] = True
        self.correct(alone, _NEAR_FOLD)
        self.found[ahead] &= (self.orientation[ahead] == sign).all()
        return bool(self.found[ahead])

    def _fold(self, row: int) -> _Fold:
        n = self.model.compiled.solver.unknowns
        return _Fold(self.first[row, :n], self.second[row, :n])

    def limit(self, last: int, ahead: int) -> Limit:
        """The dead point between two rows, estimated."""
        t = self.model.rows_in_file_units[:, 0]
        here, step = float(t[last]), float(t[1] - t[0])
        upwards = (ahead > last) == (abs(ahead - last) == 1)  # not so around the table's end
        beyond = here + (step if upwards else -step)
        place = here + self._fold(last).distance / float(self.model.input_scale[0])
        # the parabola is only an estimate: the limit lies between the two rows in any case
        if not min(here, beyond) < place < max(here, beyond):
            place = 0.5 * (here + beyond)
        return Limit(
            kind=LimitKind.DEAD_POINT,
            input=place,
            bracket=(here, beyond),
            located=False,
            status=Status.OUT_OF_REACH,
        )

    def solve(self, branch: str) -> SolvedRows:
        """The rows with their rates and evidence."""
        here = np.flatnonzero(self.found)
        blank = SolvedRows.blank(
            self.model.rows_in_file_units, self.v.shape[1], Status.OUT_OF_REACH
        )
        return blank.set(
            here,
            v=self.v[here],
            first=self.first[here],
            second=self.second[here],
            status=Status.CONVERGED.code,
            iterations=self.iterations[here],
            residual=self.residual[here],
            condition=self.condition[here],
            certification=Certification.NOT_ASKED.code,
            branch=branch,
        )
