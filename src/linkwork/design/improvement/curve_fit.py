"""Four-bars and slider-cranks whose coupler point follows a curve best, from many starts.

All starts run as lanes; after some steps only the better ones go on, so that most of the time is
spent on those that may become the best.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from linkwork.design.improvement.coupler_curves import CouplerCurves
from linkwork.design.improvement.curve_constraints import CurveConstraints
from linkwork.design.improvement.curve_goal import CurveGoal
from linkwork.design.improvement.curve_starts import CurveStarts, best_starts
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, ComplexArray, IndexArray
from linkwork.foundation.sharing import share_out
from linkwork.numerics.lane_bounds import OwnVariables
from linkwork.numerics.lane_least_squares import LaneFit, Residuals, minimise, starts_of

__all__ = ["FittedCurves", "fit_curve"]

_GAP = 1e-7  # between inputs of positions in order [rad]: far above rounding
_DRAWS = 6  # for each start that is kept
_DRAWING = 0.1  # of the work of the steps
#: Lanes that go on, as shares of the starts, their steps, and the weight of constraints; after each
#: the multipliers of constraints change.
_STAGES = (
    (1.0, 12, 10.0),
    (0.4, 30, 30.0),
    (0.12, 120, 30.0),
    *((0.04, 200, 30.0),) * 3,
    *((0.04, 200, 100.0),) * 2,
)
_FEWEST = 12  # lanes of a stage
_PART = 128  # lanes of one thread
_SAME_DIMENSIONS = 0.05  # relative difference of lengths, and of unit vectors


@dataclass(frozen=True, kw_only=True, eq=False)
class FittedCurves:
    """D mechanisms of one kind, best first.

    Parameters
    ----------
    kind : type of CouplerCurves
    x : (D, P)
        Dimensions, without the common angle of the inputs.
    angles : (D, N)
        The crank's angles at the points [rad].
    side : (D,)
        The sign of the loop.
    total : (D,)
        The sum of squares of the distances from the points [length²].
    starts : int
        How many starts there were.
    finished : bool
        Whether all stages were done; an interrupted fit keeps the best so far.
    """

    kind: type[CouplerCurves]
    x: Array
    angles: Array
    side: Array
    total: Array
    starts: int
    finished: bool = True

    def __len__(self) -> int:
        return len(self.total)


def fit_curve(
    kind: type[CouplerCurves],
    goal: CurveGoal,
    starts: int,
    rng: np.random.Generator,
    progress: Callable[[float], None] | None = None,
    threads: int = 1,
) -> FittedCurves:
    """The best mechanisms of one kind; the same for the same generator, whatever the threads.

    An interruption of the draws improves the few best ones so far, one of the steps ends these.
    """
    work = sum(share * steps for share, steps, _ in _STAGES)
    drawing, asked = _DRAWING * work, starts

    def told(part: float) -> None:
        if progress is not None:
            progress(part / (drawing + work))

    found, drawn = best_starts(
        kind, goal, _DRAWS * starts, starts, rng, lambda part: told(part * drawing)
    )
    if not drawn:
        found, starts = found.take(np.arange(min(_FEWEST, len(found.x)))), _FEWEST
    problem = _Problem(kind, goal, found)
    fit = starts_of(problem.entries(found), problem.own(found))
    numbers = np.arange(len(fit))
    done = 0.0
    for share, steps, weight in _STAGES:
        problem.constraints.weigh(weight)
        keep = np.argsort(fit.total, kind="stable")[: max(_FEWEST, round(share * starts))]
        if done:
            fit, numbers = fit.take(keep), numbers[keep]

        def tell(part: float, done: float = done, whole: float = share * steps) -> None:
            if drawn:  # what has stopped the draws would stop this too
                told(drawing + done + part * whole)

        fit = problem.minimised(fit, numbers, steps, threads, tell)
        done += share * steps
        if fit.interrupted:
            keep = np.argsort(fit.total, kind="stable")
            keep = keep[: max(_FEWEST, round(_STAGES[-1][0] * starts))]
            fit, numbers = fit.take(keep), numbers[keep]
            break
    return problem.result(replace(fit, interrupted=fit.interrupted or not drawn), numbers, asked)


class _Problem:
    """The residuals of a goal for lanes of starts."""

    def __init__(self, kind: type[CouplerCurves], goal: CurveGoal, found: CurveStarts) -> None:
        self.kind, self.goal = kind, goal
        self.curves, self.way = kind(found.side), found.way
        self.box = goal.box(kind)
        self.constraints = CurveConstraints(kind, goal, len(found.side))
        #: Crank angles at which own variables are 0: the begin of the driven range.
        self.origin = 0.0 * self.way
        width = np.inf
        if goal.range is not None:
            self.origin = np.where(self.way > 0.0, *goal.range)
            width = goal.range[1] - goal.range[0]
        gap = min(_GAP, 0.5 * width / len(goal.points))
        self.own_variables = OwnVariables(
            least=-width if goal.range is None else 0.0,
            most=width,
            in_order=goal.ordered and goal.inputs is None,
            gap=gap if goal.ordered else 0.0,
            span=FULL_TURN - gap,
        )

    def entries(self, found: CurveStarts) -> Array:
        """Parameters of starts, (D, P)."""
        if self.goal.inputs is None:
            return found.x
        turned = (found.t - self.goal.inputs).mean(axis=1, keepdims=True)
        low, high = self.goal.input_bounds
        if self.goal.range is not None:
            # whole turns that bring starts nearest to their bounds
            turned += FULL_TURN * np.round((0.5 * (low + high) - turned) / FULL_TURN)
        return np.concatenate([found.x, turned], axis=1)

    def own(self, found: CurveStarts) -> Array:
        """Own variables of starts: crank angles, unless they are given."""
        if self.goal.inputs is not None:
            return np.zeros((len(found.x), 0))
        return np.asarray(found.t + self.way[:, None] * (self._turns(found) - self.origin[:, None]))

    def _turns(self, found: CurveStarts) -> Array:
        """The whole turns (D, 1) that bring the crank's angles to the driven range [rad]."""
        angles = self.way[:, None] * found.t
        turns, _ = self.goal.turned_inside(angles.min(axis=1), angles.max(axis=1))
        return turns[:, None]

    def angles(self, x: Array, t: Array, lanes: IndexArray) -> Array:
        """The crank's angles at the points, (D, N)."""
        if self.goal.inputs is None:
            return np.asarray(self.origin[lanes, None] + self.way[lanes, None] * t)
        return np.asarray(x[:, -1:] + self.goal.inputs)

    def evaluate(self, x: Array, t: Array, lanes: IndexArray) -> Residuals:
        """Distances from the points, and how far constraints are broken."""
        goal, count = self.goal, len(self.kind.names)
        curves = self.curves.take(lanes)
        angles = self.angles(x, t, lanes)
        p, by_x, by_angle = curves.with_derivatives(x[:, :count], angles)
        missed, by_t = _split(p - goal.points), _split(by_angle)
        columns = np.stack([by_x.real, by_x.imag], axis=2)
        for more in (
            self.constraints.at_points(x[:, :count], angles, lanes),
            self.constraints.beyond(p - goal.points, by_x, by_angle, lanes),
        ):
            if more is None:
                continue
            missed = np.concatenate([missed, more[0][:, :, None]], axis=2)
            columns = np.concatenate([columns, more[1][:, :, None, :]], axis=2)
            by_t = np.concatenate([by_t, more[2][:, :, None]], axis=2)
        shared, shared_by_x = self.constraints.residuals(x, lanes)
        if goal.inputs is None:
            return Residuals(
                missed, columns, by_t * self.way[lanes, None, None], shared, shared_by_x
            )
        columns = np.concatenate([columns, by_t[:, :, :, None]], axis=3)
        return Residuals(missed, columns, None, shared, shared_by_x)

    def minimised(
        self,
        fit: LaneFit,
        numbers: IndexArray,
        steps: int,
        threads: int,
        tell: Callable[[float], None],
    ) -> LaneFit:
        """Lanes after some steps; an interruption by ``tell`` leaves all of them where they are."""
        if not len(fit):  # no start closes
            return fit
        # parts of one size, so that results do not depend on the number of threads
        parts = [np.arange(k, min(k + _PART, len(fit))) for k in range(0, len(fit), _PART)]
        done: list[LaneFit] = [fit] * len(parts)

        tried, stopped = 0, False

        def work(k: int) -> None:
            nonlocal stopped
            own, begun = numbers[parts[k]], False

            def evaluate(x: Array, t: Array, lanes: IndexArray) -> Residuals:
                nonlocal tried, begun
                if begun and stopped:
                    raise KeyboardInterrupt
                if begun:  # the starts themselves are measured in any case
                    tell(min(1.0, tried / (steps * len(parts))))
                tried, begun = tried + 1, True
                return self.evaluate(x, t, own[lanes])

            done[k] = minimise(
                evaluate, fit.take(parts[k]), self.box, steps, own=self.own_variables
            )
            stopped = stopped or done[k].interrupted

        share_out(work, range(len(parts)), threads)
        found = LaneFit.joined(done)
        angles, count = self.angles(found.x, found.t, numbers), len(self.kind.names)
        p = self.curves.take(numbers).points(found.x[:, :count], angles).guided
        self.constraints.update(found.x, angles, p - self.goal.points, numbers)
        return found

    def result(self, fit: LaneFit, numbers: IndexArray, starts: int) -> FittedCurves:
        """Different mechanisms, best first."""
        count = len(self.kind.names)
        there = self.evaluate(fit.x, fit.t, numbers)
        missed = there.rows[:, :, :2]
        total = np.einsum("dnm,dnm->d", missed, missed)
        order = [int(k) for k in np.argsort(total, kind="stable") if np.isfinite(total[k])]
        lengths, turns = self.curves.take(numbers).shapes(fit.x[:, :count])
        # of timed points the common angle of the inputs
        turns = np.concatenate([turns, np.exp(1j * fit.x[:, count:])], axis=1)
        chosen: list[int] = []
        for k in order:
            scale = self.goal.size + np.abs(lengths[k]).max()
            apart = np.abs(lengths[chosen] - lengths[k]).max(axis=1) / scale
            turned = np.abs(turns[chosen] - turns[k]).max(axis=1)
            if (np.maximum(apart, turned) > _SAME_DIMENSIONS).all():
                chosen.append(k)
        index = np.array(chosen, dtype=int)
        angles = self.angles(fit.x[index], fit.t[index], numbers[index])
        return FittedCurves(
            kind=self.kind,
            x=fit.x[index][:, :count],
            angles=angles,
            side=self.curves.side[numbers[index]],
            total=total[index],
            starts=starts,
            finished=not fit.interrupted,
        )


def _split(z: ComplexArray) -> Array:
    """Complex numbers (D, N) as pairs (D, N, 2)."""
    return np.stack([z.real, z.imag], axis=2)
