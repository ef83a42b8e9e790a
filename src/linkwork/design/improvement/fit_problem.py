"""Residuals of all goals of a mechanism, for lanes of designs on all cores."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.design.improvement.exact_numbers import ExactNumbers
from linkwork.design.improvement.free_timing import own_inputs
from linkwork.design.improvement.goals import Misses, PathGoal, goal_of
from linkwork.design.improvement.kept_relations import Together
from linkwork.design.improvement.lane_work import LaneWork
from linkwork.design.improvement.largest_miss import largest_misses, powered
from linkwork.design.improvement.settings import Aid, Goal
from linkwork.design.improvement.solved_lanes import SolvedLanes, inputs_away
from linkwork.design.improvement.trade_off import Objectives, TradeOff, told_apart
from linkwork.design.improvement.written_designs import DesignWriter
from linkwork.foundation.arrays import Array, IndexArray
from linkwork.foundation.sharing import cores, share_out
from linkwork.mechanism.varied_number import VariedNumber
from linkwork.motion.between_rows import between_rows
from linkwork.motion.model import Model
from linkwork.numerics.lane_bounds import Box
from linkwork.numerics.lane_least_squares import LaneFit, Residuals, minimise, starts_of
from linkwork.results.motion import Motion

__all__ = ["APPROACH", "FitProblem", "FittedNumbers", "Fitting"]

APPROACH = 4  # parts of the way from the mechanism to a start


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
    names : tuple of str
        Of the goals that are no bounds.
    objectives : (D, K)
        Root mean squares of the misses of each goal that is no bound, without its weight.
    broken : (D,)
        The largest weighted residual of a bound.
    bounds : tuple of Goal
        Those that a design has to keep.
    beyond : (D, B, 2)
        How far it is below and above them.
    start : (D,)
        The numbers of their starts.
    interrupted : bool
    """

    x: Array
    t: Array
    total: Array
    largest: Array
    path: Array
    names: tuple[str, ...]
    objectives: Array
    broken: Array
    bounds: tuple[Goal, ...]
    beyond: Array
    start: IndexArray
    interrupted: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class Fitting:
    """What is fitted.

    Parameters
    ----------
    model, motion : Model, Motion
        The mechanism as it is.
    numbers : sequence of VariedNumber
        Those that vary.
    box : Box
        Their bounds.
    path : PathGoal, optional
    goals : sequence of Goal
    together : Together, optional
        Numbers that change together: their sizes are fitted, and ``box`` is theirs.
    """

    model: Model
    motion: Motion
    numbers: Sequence[VariedNumber]
    box: Box
    path: PathGoal | None
    goals: Sequence[Goal]
    together: Together | None = None

    def all_numbers(self, x: Array) -> Array:
        """The numbers (D, P) of what is fitted, (D, G)."""
        return x if self.together is None else self.together.numbers(x)


class FitProblem:
    """Residuals of all goals, for lanes of designs.

    Parameters
    ----------
    given : Fitting
    lanes : int

    Attributes
    ----------
    power : int
        Of the misses, for the largest one, see :mod:`~linkwork.design.improvement.largest_miss`.
    trade : TradeOff, optional
        Weights and limits of objectives; ``None``: the sum of all.
    moved, missed : (K,)
        How much numbers change each goal, and how far it is missed, as far as is known; else NaN.
    """

    def __init__(self, given: Fitting, lanes: int) -> None:
        self.given, model, motion, path = given, given.model, given.motion, given.path
        self.model, self.motion = model, motion
        self.box, self.path, self.lanes = given.box, path, lanes
        self.numbers = np.array([float(q.of(model.description)) for q in given.numbers])
        self.x = self.numbers if given.together is None else given.together.sizes
        lead = next(iter(motion.inputs))
        scale = float(model.input_scale[0])
        # limits between the rows of the table move with the numbers
        table = (np.asarray(motion.inputs[lead]) * scale)[motion.asked]
        there = np.asarray(motion.found[motion.asked])
        self.own_variables = own_inputs(path, model, table)
        self.writer = DesignWriter(model, given.numbers)
        self.goals = [goal_of(model, goal, table, there, scale) for goal in given.goals]
        self.points = None if path is None else self._rows(path.inputs)
        # goals of the same rows share their positions
        self.rows: dict[bytes, SolvedLanes] = {}
        for misses in self.goals:
            if misses.at.tobytes() not in self.rows:
                self.rows[misses.at.tobytes()] = self._rows(misses.at)
        own = given.numbers, self.goals, self.rows
        self.exact = ExactNumbers(self.writer, *own, there, lanes)
        self.shifts = [np.zeros((2, lanes, misses.count)) for misses in self.goals]
        self.new_shifts = [np.zeros_like(shift) for shift in self.shifts]
        self.power, self.largest = 1, np.ones(lanes)
        self.trade: TradeOff | None = None
        # of the shared residuals, those that are no bounds
        self.counted = np.concatenate(
            [np.zeros(0, bool), *(np.full(m.count, not m.is_bound) for m in self.goals)]
        )
        self.work = LaneWork(sum(len(solved.rows_at) for solved in self._solvers))
        self._reached = np.zeros(lanes, dtype=bool)
        self.moved, self.missed = np.full((2, len(self.goals)), np.nan)

    @property
    def has_bounds(self) -> bool:
        """Whether a goal is a bound, or an objective has a limit."""
        limited = self.trade is not None and self.trade.has_limits
        return limited or any(misses.is_bound for misses in self.goals)

    @cached_property
    def objectives(self) -> Objectives:
        """The goals that are no bounds, the path first."""
        names: list[str] = [] if self.path is None else [self.path.point]
        columns: list[slice | None] = [] if self.path is None else [None]
        weights, bounds, first = [1.0] * len(names), [], 0
        for misses in self.goals:
            own = slice(first, first + misses.count)
            first = own.stop
            if misses.is_bound:
                bounds.append(own)
                continue
            names.append(misses.goal.of)
            columns.append(own)
            weights.append(misses.goal.weight)
        return Objectives(
            names=told_apart(names),
            columns=tuple(columns),
            weights=np.array(weights),
            bounds=tuple(bounds),
        )

    @property
    def _kept(self) -> list[tuple[Misses, slice]]:
        """The bounds that a design has to keep, and their residuals."""
        bounds = [misses for misses in self.goals if misses.is_bound]
        pairs = zip(bounds, self.objectives.bounds, strict=True)
        return [pair for pair in pairs if not isinstance(pair[0].goal, Aid)]

    def copy_lanes(self, fit: LaneFit, of: IndexArray, to: IndexArray) -> None:
        """Begin lanes where others are now."""
        for name in ("x", "t", "total"):
            getattr(fit, name)[to] = getattr(fit, name)[of]
        for solved in self._solvers:
            solved.copy_lanes(of, to)
        self.exact.errors[:, to] = self.exact.errors[:, of]
        self._reached[to] = True

    def _rows(self, at: Array) -> SolvedLanes:
        """Lanes at inputs, begun between or at the nearest rows of the mechanism's motion."""
        away = inputs_away(at, self.motion, self.model)
        q = self.motion.q[away.argmin(axis=1)]
        far = away.min(axis=1) > 0.0
        if far.any() and self.motion.found.all():
            between = between_rows(self.model, self.motion)(at[far]).columns[0][:, : q.shape[1]]
            q[far] = np.where(np.isfinite(between), between, q[far])
        return SolvedLanes(self.writer, self.numbers, q, at, self.lanes)

    @property
    def _solvers(self) -> list[SolvedLanes]:
        return [*([self.points] if self.points is not None else []), *self.rows.values()]

    def begun(self, starts: Array) -> LaneFit:
        """The starts, which are reached from the mechanism when their lanes are first worked on."""
        own = 0 if self.path is None or self.path.timed else len(self.path.places)
        inputs = self.path.inputs[:own] if self.path else np.zeros(0)
        return starts_of(starts, np.array(np.broadcast_to(inputs, (len(starts), own))))

    def reached(self, fit: LaneFit, lanes: IndexArray) -> LaneFit:
        """Starts reached from the mechanism, with their sums; infinite where lost."""
        every = fit.take(np.arange(len(fit)))

        def work(own: IndexArray, count: Callable[[], None]) -> None:
            every.total[own] = self._reach(fit.take(own), own, count)

        self.work.share(lanes, APPROACH, work)
        return replace(every, interrupted=self.work.stopped)

    def _reach(self, fit: LaneFit, lanes: IndexArray, count: Callable[[], None]) -> Array:
        """The sums of starts that are reached in some steps."""
        begin = np.broadcast_to(self.x, fit.x.shape)
        total = self._lead(begin, fit.x, fit.t, lanes, count)
        self._reached[lanes] = True
        return total

    def move(self, fit: LaneFit, lanes: IndexArray, x: Array) -> None:
        """Lanes that were at a design of another lane, led to other numbers (D, P)."""
        self._lead(fit.x[lanes], x, fit.t[lanes], lanes)
        fit.x[lanes] = x

    def _lead(
        self,
        begin: Array,
        end: Array,
        t: Array,
        lanes: IndexArray,
        count: Callable[[], None] = lambda: None,
    ) -> Array:
        """From numbers to others in some steps, so that positions follow; the sums there."""
        total = np.zeros(0)
        for part in range(1, APPROACH + 1):
            count()
            for solved in self._solvers:
                solved.total[lanes] = np.inf
            total = self.evaluate(begin + (end - begin) * (part / APPROACH), t, lanes).total
        return total

    def further(self, fit: LaneFit, keep: IndexArray, steps: int) -> LaneFit:
        """Some lanes after more steps."""
        found: list[tuple[IndexArray, LaneFit]] = []

        def work(own: IndexArray, count: Callable[[], None]) -> None:
            start = fit.take(own)
            if not self._reached[own].all():
                start = replace(start, total=self._reach(start, own, count))
                found.append((own, start))
            for solved in self._solvers:
                # sums of an earlier round are no measure of this one
                solved.total[own] = np.inf
            if self.power > 1:
                now = self.evaluate(start.x, start.t, own, power=1)
                self.largest[own] = np.maximum(largest_misses(now, self.counted), 1e-300)

            def evaluate(x: Array, t: Array, lanes: IndexArray) -> Residuals:
                count()
                return self.evaluate(x, t, own[lanes])

            after = minimise(evaluate, start, self.box, steps, own=self.own_variables)
            found.append((own, after))
            if after.interrupted:
                raise KeyboardInterrupt
            if self.has_bounds:
                self.evaluate(after.x, after.t, own)
                for shift, new in zip(self.shifts, self.new_shifts, strict=True):
                    shift[:, own] = new[:, own]
                if self.trade is not None:
                    self.trade.update(own)

        self.work.share(keep, steps, work)
        every = fit.take(np.arange(len(fit)))
        for own, after in found:
            every.put(own, after)
        return replace(every, interrupted=self.work.stopped)

    def evaluate(
        self, x: Array, t: Array, lanes: IndexArray, power: int | None = None
    ) -> Residuals:
        """All misses of designs (D, P); NaN for those of other equations."""
        power = power or self.power
        x = self.given.all_numbers(x)
        count, parameters = x.shape
        rows, by_x = np.zeros((count, 0, 2)), np.zeros((count, 0, 2, parameters))
        by_t: Array | None = None
        kept = []
        designs = self.writer.written(x)
        if self.path is not None and self.points is not None:
            at = np.broadcast_to(self.path.inputs, (count, len(self.path.places)))
            at = at if self.path.timed else t
            found = self.points.at(designs, at, lanes)
            rows, by_x, slope = self.path.misses(found)
            by_t = None if self.path.timed else slope
            kept.append((self.points, found, at))
        positions = {}
        for key, solved in self.rows.items():
            at = np.broadcast_to(solved.rows_at, (count, len(solved.rows_at)))
            positions[key] = solved.at(designs, at, lanes)
            kept.append((solved, positions[key], at))
        shared, shared_by_x = [np.zeros((count, 0))], [np.zeros((count, 0, parameters))]
        for k, misses in enumerate(self.goals):
            given = self.exact.errors[k, lanes], self.shifts[k][:, lanes]
            own, slopes, new = misses.of(positions[misses.at.tobytes()], *given)
            self.new_shifts[k][:, lanes] = new
            if not self.moved[k] > 0.0 and (there := np.isfinite(own)).any():
                self.moved[k] = float(np.abs(slopes[there]).max())
                self.missed[k] = float(np.abs(own[there]).max())
            shared.append(own)
            shared_by_x.append(slopes)
        slopes = np.concatenate(shared_by_x, axis=1)
        if self.given.together is not None:
            by_x, slopes = (own @ self.given.together.slopes for own in (by_x, slopes))
        result = Residuals(rows, by_x, by_t, np.concatenate(shared, axis=1), slopes)
        if self.trade is not None:
            result = self.trade.applied(result, lanes)
        if power > 1:
            result = powered(result, power, self.largest[lanes], self.counted)
        for solver, found, at in kept:
            solver.keep(found, x, at, lanes, result.total)
        return result

    def correct(self, fit: LaneFit, lanes: IndexArray) -> IndexArray:
        """Make goals of numbers of the motion exact; the lanes in which they were not."""
        known = lanes[np.isfinite(fit.total[lanes])]
        parts = self.work.parts(known) if len(known) else []
        return self.exact.correct(self.given.all_numbers(fit.x), parts)

    def measured(self, fit: LaneFit, lanes: IndexArray) -> Residuals:
        """The misses of lanes without powers, weights and shifts."""
        kept = self.power, self.trade, self.shifts
        self.power, self.trade = 1, None
        self.shifts = [np.zeros_like(shift) for shift in self.shifts]
        for solved in self._solvers:
            solved.total[lanes] = np.inf
        parts = self.work.parts(lanes)
        found: dict[int, Residuals] = {}

        def measure(k: int) -> None:
            found[k] = self.evaluate(fit.x[parts[k]], fit.t[parts[k]], parts[k])

        share_out(measure, range(len(parts)), cores())
        self.power, self.trade, self.shifts = kept
        return Residuals.joined([found[k] for k in range(len(parts))])

    def result(self, fit: LaneFit, most: int | None = None) -> FittedNumbers:
        """All lanes that are known, or the best ones, with their misses."""
        known = np.argsort(fit.total, kind="stable")[: max(1, np.isfinite(fit.total).sum())]
        known = np.sort(known[:most])
        self.correct(fit, known)
        there = self.measured(fit, known)
        beyond = [misses.beyond(there.shared[:, own]) for misses, own in self._kept]
        fit = fit.take(known)
        timed = self.path is None or self.path.timed
        t = fit.t
        if timed and self.path is not None:
            t = np.array(np.broadcast_to(self.path.inputs, (len(fit), len(self.path.places))))
        return FittedNumbers(
            x=self.given.all_numbers(fit.x),
            t=t,
            total=np.where(np.isfinite(fit.total), there.total, np.inf),
            largest=largest_misses(there, self.counted),
            path=np.asarray(np.einsum("dnm,dnm->d", there.rows, there.rows)),
            names=self.objectives.names,
            objectives=self.objectives.values(there),
            broken=self.objectives.broken(there),
            bounds=tuple(misses.goal for misses, _ in self._kept),
            beyond=np.reshape(beyond, (len(self._kept), len(known), 2)).swapaxes(0, 1),
            start=known,
            interrupted=fit.interrupted,
        )
