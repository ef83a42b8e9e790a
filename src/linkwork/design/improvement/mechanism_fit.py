"""The numbers of any mechanism that meet goals best, from many starts in lanes on all cores."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from linkwork.design.improvement.goals import PathGoal, goal_of
from linkwork.design.improvement.largest_miss import POWERS, largest_misses, powered
from linkwork.design.improvement.settings import Goal
from linkwork.design.improvement.solved_lanes import SolvedLanes
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, IndexArray
from linkwork.foundation.operand import NotElementwise
from linkwork.foundation.sharing import cores, share_out
from linkwork.mechanism.varied_number import VariedNumber
from linkwork.motion.model import Model
from linkwork.numerics.lane_least_squares import (
    Box,
    LaneFit,
    Residuals,
    Sequenced,
    minimise,
    starts_of,
)
from linkwork.results.motion import Motion
from linkwork.results.quantity import Kind

__all__ = ["FittedNumbers", "fit_numbers", "path_misses"]

_GAP = 1e-7  # between inputs of positions in order [rad or length]
_STEPS = (60, 200, 200)  # of all lanes, then of the better half
_BOUND_STEPS = (60,) * 7  # the same; after each the shifts of bounds change
_POWER_STEPS = 60
_ALL = 64  # so few lanes all go on
_APPROACH = 4  # parts of the way from the mechanism to a start
_PART = 8  # lanes of one thread


@dataclass(frozen=True, kw_only=True, eq=False)
class FittedNumbers:
    """D designs, one for each start that went to the end.

    Parameters
    ----------
    x : (D, P)
        The numbers, file units.
    t : (D, N)
        Leading inputs at the points [rad or length].
    total, largest : (D,)
        Weighted sums of squares of all misses, and the largest one that is no broken bound.
    path : (D,)
        Sums of squares of the distances from the points [length²].
    interrupted : bool
    """

    x: Array
    t: Array
    total: Array
    largest: Array
    path: Array
    interrupted: bool


def fit_numbers(
    model: Model,
    motion: Motion,
    numbers: Sequence[VariedNumber],
    box: Box,
    starts: Array,
    path: PathGoal | None,
    goals: Sequence[Goal],
    *,
    minimax: bool = False,
    progress: Callable[[float], None] | None = None,
) -> FittedNumbers:
    """Improve starts (D, P); the motion is that of the mechanism as it is.

    ``minimax``: the largest miss counts, instead of the sum of squares.

    Raises
    ------
    UnknownNameError, InputError
        For goals that are not known, or whose derivatives are not known.
    """
    problem = _Problem(model, motion, numbers, box, path, goals, len(starts))
    rounds = [(1, steps) for steps in (_BOUND_STEPS if problem.has_bounds else _STEPS)]
    rounds += [(power, _POWER_STEPS) for power in (POWERS if minimax else ())]
    problem.tell, problem.whole = progress, sum(steps for _, steps in rounds)
    fit = problem.begun(starts)
    for k, (power, steps) in enumerate(rounds):
        problem.power = power
        # sums of other powers and shifts say nothing of this round
        changed = power > 1 or problem.has_bounds
        left = np.flatnonzero(np.isfinite(fit.total) if k and changed else ~fit.done | (k == 0))
        # of many lanes only the better half goes on
        most = len(starts) if len(starts) <= _ALL or not k else len(starts) // 2
        keep = left[np.argsort(fit.total[left], kind="stable")[:most]]
        if not len(keep):
            continue
        fit = problem.further(fit, keep, steps)
        if fit.interrupted:
            break
    return problem.result(fit)


def path_misses(
    model: Model, motion: Motion, numbers: Sequence[VariedNumber], path: PathGoal, x: Array
) -> Array:
    """The distances of one mechanism from timed points, (N,), reached from the nearest rows of its
    motion; NaN where it has no position on their branch.
    """
    away = _inputs_away(path.inputs, motion, model)
    solved = SolvedLanes(model, numbers, x, motion.q[away.argmin(axis=1)], path.inputs, 1)
    found = solved.at(x[None], path.inputs[None], np.zeros(1, dtype=int))
    place = found.rows.place(path.point).v
    value = found.values([place.real, place.imag])[0][0]
    return np.asarray(np.abs(value[:, 0] + 1j * value[:, 1] - path.places))


def _inputs_away(at: Array, motion: Motion, model: Model) -> Array:
    """The distances of inputs (N,) from those of rows (R,), infinite from lost ones, (N, R)."""
    lead = next(iter(motion.inputs))
    table = np.asarray(motion.inputs[lead]) * float(model.input_scale[0])
    away = at[:, None] - table
    if model.equations.inputs[0].kind == Kind.ANGLE.value:
        away = np.mod(away + 0.5 * FULL_TURN, FULL_TURN) - 0.5 * FULL_TURN
    return np.where(motion.found, np.abs(away), np.inf)


class _Problem:
    """Residuals of all goals, for lanes of designs."""

    def __init__(
        self,
        model: Model,
        motion: Motion,
        numbers: Sequence[VariedNumber],
        box: Box,
        path: PathGoal | None,
        goals: Sequence[Goal],
        lanes: int,
    ) -> None:
        self.model, self.numbers, self.motion = model, numbers, motion
        self.box, self.path, self.lanes = box, path, lanes
        self.x = np.array([float(q.of(model.description)) for q in numbers])
        lead = next(iter(motion.inputs))
        scale = float(model.input_scale[0])
        # limits between the rows of the table move with the numbers
        table = (np.asarray(motion.inputs[lead]) * scale)[motion.asked]
        there = np.asarray(motion.found[motion.asked])
        self.goals = [goal_of(model, goal, table, there, scale) for goal in goals]
        self.points = None if path is None else self._rows(path.inputs)
        # goals of the same rows share their positions
        self.rows: dict[bytes, SolvedLanes] = {}
        for misses in self.goals:
            if misses.at.tobytes() not in self.rows:
                self.rows[misses.at.tobytes()] = self._rows(misses.at)
        self.shifts = [np.zeros((2, lanes, misses.count)) for misses in self.goals]
        self.new_shifts = [np.zeros_like(shift) for shift in self.shifts]
        self.power, self.largest = 1, np.ones(lanes)
        # of the shared residuals, those that are no bounds
        self.counted = np.concatenate(
            [np.zeros(0, bool), *(np.full(m.count, not m.is_bound) for m in self.goals)]
        )
        self.tell: Callable[[float], None] | None = None
        self.whole, self.done, self.stopped = 1, 0, False

    @property
    def has_bounds(self) -> bool:
        """Whether a goal is a bound."""
        return any(misses.is_bound for misses in self.goals)

    def _rows(self, at: Array) -> SolvedLanes:
        """Lanes at inputs, begun at the nearest rows of the mechanism's motion."""
        away = _inputs_away(at, self.motion, self.model)
        q = self.motion.q[away.argmin(axis=1)]
        return SolvedLanes(self.model, self.numbers, self.x, q, at, self.lanes)

    @property
    def _solvers(self) -> list[SolvedLanes]:
        return [*([self.points] if self.points is not None else []), *self.rows.values()]

    def begun(self, starts: Array) -> LaneFit:
        """The starts, reached from the mechanism in some steps; infinite where lost."""
        own = 0 if self.path is None or self.path.timed else len(self.path.places)
        inputs = self.path.inputs[:own] if self.path else np.zeros(0)
        t = np.array(np.broadcast_to(inputs, (len(starts), own)))
        lanes = np.arange(len(starts))
        for part in range(1, _APPROACH + 1):
            x = self.x + (starts - self.x) * (part / _APPROACH)
            for solved in self._solvers:
                solved.total[:] = np.inf
            self.evaluate(x, t, lanes)
        return starts_of(starts, t)

    def further(self, fit: LaneFit, keep: IndexArray, steps: int) -> LaneFit:
        """Some lanes after more steps."""
        sequenced = None
        if self.path is not None and not self.path.timed and self.path.ordered:
            turns = self.model.equations.inputs[0].kind == Kind.ANGLE.value
            sequenced = Sequenced(gap=_GAP, span=(FULL_TURN if turns else np.inf) - _GAP)
        for solved in self._solvers:
            # sums of an earlier round are no measure of this one
            solved.total[keep] = np.inf
        if self.power > 1:
            self.power, power = 1, self.power
            now = self.evaluate(fit.x[keep], fit.t[keep], keep)
            self.largest[keep] = np.maximum(largest_misses(now, self.counted), 1e-300)
            self.power = power
        parts = [keep[k : k + _PART] for k in range(0, len(keep), _PART)]
        found = [fit.take(part) for part in parts]

        def work(k: int) -> None:
            own = parts[k]

            def evaluate(x: Array, t: Array, lanes: IndexArray) -> Residuals:
                if self.stopped:
                    raise KeyboardInterrupt
                if k == 0 and self.tell is not None:
                    self.tell(min(1.0, (self.done + tried[0]) / self.whole))
                    tried[0] += 1
                return self.evaluate(x, t, own[lanes])

            found[k] = minimise(evaluate, fit.take(own), self.box, steps, sequenced=sequenced)
            self.stopped = self.stopped or found[k].interrupted

        tried = [0]
        try:
            share_out(work, range(len(parts)), cores())
        except KeyboardInterrupt:
            # while waiting for the other threads, which stop at their next step
            self.stopped = True
        self.done += steps
        own = replace(LaneFit.joined(found), interrupted=self.stopped)
        every = {
            name: np.array(getattr(fit, name)) for name in ("x", "t", "total", "damping", "idle")
        }
        for name, whole in every.items():
            whole[keep] = getattr(own, name)
        if self.has_bounds and not own.interrupted:
            self.evaluate(own.x, own.t, keep)
            for shift, new in zip(self.shifts, self.new_shifts, strict=True):
                shift[:, keep] = new[:, keep]
        return LaneFit(**every, interrupted=own.interrupted)

    def evaluate(self, x: Array, t: Array, lanes: IndexArray) -> Residuals:
        """All misses of designs (D, P); NaN where a design cannot be built like the others."""
        try:
            found = self._together(x, t, lanes)
        except NotElementwise:
            half = len(x) // 2
            if half:
                first, second = slice(0, half), slice(half, None)
                return Residuals.joined(
                    self.evaluate(x[first], t[first], lanes[first]),
                    self.evaluate(x[second], t[second], lanes[second]),
                )
            # the mechanism itself can be built: its residuals have the shapes
            found = self._together(self.x[None], t, lanes, keep=False)
            found = replace(found, rows=found.rows * np.nan, shared=found.shared * np.nan)
        return found

    def _together(self, x: Array, t: Array, lanes: IndexArray, *, keep: bool = True) -> Residuals:
        count, parameters = x.shape
        rows, by_x = np.zeros((count, 0, 2)), np.zeros((count, 0, 2, parameters))
        by_t: Array | None = None
        kept = []
        if self.path is not None and self.points is not None:
            at = np.broadcast_to(self.path.inputs, (count, len(self.path.places)))
            at = at if self.path.timed else t
            found = self.points.at(x, at, lanes)
            rows, by_x, slope = self.path.misses(found)
            by_t = None if self.path.timed else slope
            kept.append((self.points, found, at))
        positions = {}
        for key, solved in self.rows.items():
            at = np.broadcast_to(solved.rows_at, (count, len(solved.rows_at)))
            positions[key] = solved.at(x, at, lanes)
            kept.append((solved, positions[key], at))
        shared, shared_by_x = [np.zeros((count, 0))], [np.zeros((count, 0, parameters))]
        for k, misses in enumerate(self.goals):
            own, slopes, new = misses.of(positions[misses.at.tobytes()], self.shifts[k][:, lanes])
            self.new_shifts[k][:, lanes] = new
            shared.append(own)
            shared_by_x.append(slopes)
        result = Residuals(
            rows, by_x, by_t, np.concatenate(shared, axis=1), np.concatenate(shared_by_x, axis=1)
        )
        if self.power > 1:
            result = powered(result, self.power, self.largest[lanes], self.counted)
        for solver, found, at in kept if keep else ():
            solver.keep(found, x, at, lanes, result.total)
        return result

    def result(self, fit: LaneFit) -> FittedNumbers:
        """All lanes with their misses, without powers and shifts."""
        self.power = 1
        for shift in self.shifts:
            shift[:] = 0.0
        for solved in self._solvers:
            solved.total[:] = np.inf
        there = self.evaluate(fit.x, fit.t, np.arange(len(fit)))
        timed = self.path is None or self.path.timed
        t = fit.t
        if timed and self.path is not None:
            t = np.array(np.broadcast_to(self.path.inputs, (len(fit), len(self.path.places))))
        known = np.isfinite(fit.total)
        return FittedNumbers(
            x=fit.x,
            t=t,
            total=np.where(known, there.total, np.inf),
            largest=np.where(known, largest_misses(there, self.counted), np.inf),
            path=np.asarray(np.einsum("dnm,dnm->d", there.rows, there.rows)),
            interrupted=fit.interrupted,
        )
