"""Four-bars and slider-cranks whose coupler point follows a curve best, and their constraints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray
from linkwork.core.foundation.units import FULL_TURN
from linkwork.synthesis.improvement.curve_starts import CurveStarts, best_starts
from linkwork.synthesis.improvement.curves import CouplerCurves, CurveGoal, FourBarCurves
from linkwork.synthesis.lane_least_squares import LaneFit, Residuals, RowVariables, starts_of
from linkwork.synthesis.lane_problems import LaneProblem, Multipliers, different

#: By how much fits exceed the required transmission angle [rad]: between rows, and where their last
#: steps end, designs fell short of it by up to 2e-5.
ANGLE_MARGIN = 1e-4

_MARGIN = 1e-6  # sizes of the goal: by which constraints hold in the end
_DEAD = np.radians(0.25)  # the least transmission angle of all: dead points are kept off


class CurveConstraints:
    """The constraints of a goal, for lanes of mechanisms of one kind."""

    def __init__(self, kind: type[CouplerCurves], goal: CurveGoal, lanes: int) -> None:
        self.kind, self.goal = kind, goal
        self._curves = kind(np.ones(1))
        count = self._constraints(np.ones((1, len(kind.names) + 1)))[0].shape[1]
        self._of_dimensions = Multipliers(lanes, count)
        self._at_points, self._of_reach = (Multipliers(lanes, len(goal.points)) for _ in range(2))

    @property
    def multipliers(self) -> list[Multipliers]:
        """Those of all constraints."""
        return [self._of_dimensions, self._at_points, self._of_reach]

    def residuals(self, x: Array, lanes: IndexArray) -> tuple[Array, ...]:
        """How far constraints are broken, (D, K), and by the parameters, (D, K, P)."""
        return self._of_dimensions.residuals(lanes, *self._constraints(x))

    def at_points(self, x: Array, angles: Array, lanes: IndexArray) -> tuple[Array, ...] | None:
        """How far the transmission angle is too small at points, (D, N), by the dimensions and by
        the angles; ``None`` where the whole driven range is constrained.
        """
        if self.goal.must_turn or self.goal.range is not None:
            return None
        cosine, by_x, by_angle = self._curves.cosines(x, angles)
        sign = np.sign(cosine) * self.goal.size
        h = np.abs(cosine) * self.goal.size - self._most
        return self._at_points.residuals(lanes, h, by_x, by_angle, unit=sign)

    def beyond(
        self, missed: ComplexArray, by_x: ComplexArray, by_angle: ComplexArray, lanes: IndexArray
    ) -> tuple[Array, ...] | None:
        """How far points are missed beyond their tolerances, (D, N), by the dimensions and by the
        angles, from the same of P - the points; ``None`` without tolerances.
        """
        if self.goal.reach is None:
            return None
        # a narrow tolerance keeps a narrow margin
        margin = np.minimum(_MARGIN * self.goal.size, _MARGIN * self.goal.reach)
        h = np.abs(missed) - self.goal.reach + margin
        with np.errstate(all="ignore"):
            along = np.nan_to_num(missed.conj() / np.abs(missed))
            return self._of_reach.residuals(lanes, h, by_x, by_angle, unit=along)

    @property
    def _most(self) -> float:
        return float(np.cos(self._least_angle + _MARGIN)) * self.goal.size

    @property
    def _least_angle(self) -> float:
        """The least transmission angle that fits may have [rad]."""
        return float(max(self.goal.transmission + ANGLE_MARGIN, _DEAD))

    def _constraints(self, x: Array) -> tuple[Array, Array]:
        """h (D, K) and its derivatives, in lengths."""
        goal, count = self.goal, len(self.kind.names)
        values, slopes = [np.zeros((len(x), 0))], [np.zeros((len(x), 0, x.shape[1]))]
        margin = _MARGIN * goal.size

        def add(h: Array, by_x: Array) -> None:
            wide = np.zeros((*h.shape, x.shape[1]))
            wide[:, :, :count] = by_x
            values.append(h + margin)
            slopes.append(wide)

        dimensions = x[:, :count]
        if goal.must_turn:
            add(*self._curves.limits(dimensions))
            add(*self._transmission(dimensions))
        if goal.limited_range is not None:
            add(*self._transmission_in(dimensions, *goal.limited_range))
        lengths, by_x = self._lengths(dimensions)
        if goal.shortest > 0.0:
            add(goal.shortest - lengths, -by_x)
        if np.isfinite(goal.longest):
            add(lengths - goal.longest, by_x)
            arms, arms_by_x = self._arms(dimensions)
            add(arms - goal.longest, arms_by_x)
        if np.isfinite(goal.ratio):
            rows = np.arange(len(x))
            longest, shortest = lengths.argmax(axis=1), lengths.argmin(axis=1)
            h = lengths[rows, longest] - goal.ratio * lengths[rows, shortest]
            slope = by_x[rows, longest] - goal.ratio * by_x[rows, shortest]
            add(h[:, None], slope[:, None])
        return np.concatenate(values, axis=1), np.concatenate(slopes, axis=1)

    def _lengths(self, x: Array) -> tuple[Array, Array]:
        """The lengths of links, of a four-bar the ground too, (D, L), and by x."""
        index = list(self.kind.lengths)
        lengths, by_x = x[:, index], np.zeros((len(x), len(index), x.shape[1]))
        by_x[:, np.arange(len(index)), index] = 1.0
        if self.kind is not FourBarCurves:
            return lengths, by_x
        length, along = FourBarCurves.ground(x)
        slope = np.zeros((len(x), 1, x.shape[1]))
        slope[:, 0, :2], slope[:, 0, 2:4] = -along, along
        return np.column_stack([lengths, length]), np.concatenate([by_x, slope], axis=1)

    def _arms(self, x: Array) -> tuple[Array, Array]:
        """The distances of the guided point from A and B, (D, 2), and by x."""
        coupler = self.kind.lengths[1]
        along = np.stack([x[:, -2], x[:, -2] - x[:, coupler]], axis=1)
        arms = np.hypot(along, x[:, -1:])
        by_x = np.zeros((len(x), 2, x.shape[1]))
        with np.errstate(all="ignore"):
            by_x[:, :, -2] = np.nan_to_num(along / arms)
            by_x[:, :, -1] = np.nan_to_num(x[:, -1:] / arms)
        by_x[:, 1, coupler] = -by_x[:, 1, -2]
        return arms, by_x

    def _transmission_in(self, x: Array, start: float, stop: float) -> tuple[Array, Array]:
        """(|cos ψ| - cos μ) times the size, at the two angles of a range where it may be largest:
        those nearest to the extremes, where the cosine has no slope, or ends of the range.
        """
        middle, half = 0.5 * (start + stop), 0.5 * (stop - start)
        extreme = self._curves.extreme(x)[:, None] + np.array([0.0, 0.5 * FULL_TURN]) - middle
        away = np.mod(extreme + 0.5 * FULL_TURN, FULL_TURN) - 0.5 * FULL_TURN
        cosine, by_x, _ = self._curves.cosines(x, middle + np.clip(away, -half, half))
        most, size = np.cos(self._least_angle), self.goal.size
        return (np.abs(cosine) - most) * size, by_x * (np.sign(cosine) * size)[:, :, None]

    def _transmission(self, x: Array) -> tuple[Array, Array]:
        """|b² + c² - (g ± a)²| - 2 b c cos μ, divided by b + c, or a ± h - c cos μ, for a whole
        turn of the crank.
        """
        cosine = np.cos(self._least_angle)
        if self.kind is not FourBarCurves:
            limits, by_x = self._curves.limits(x)
            by_x[:, :, 3] *= cosine
            return limits + (1.0 - cosine) * x[:, 3, None], by_x
        g, along = FourBarCurves.ground(x)
        a, c, b = (x[:, k, None] for k in (4, 5, 6))
        sense = np.array([1.0, -1.0])
        d = g[:, None] + sense * a
        inner = b**2 + c**2 - d**2
        sign, size = np.sign(inner), b + c
        h = (np.abs(inner) - 2.0 * b * c * cosine) / size
        slope = np.zeros((*h.shape, x.shape[1]))
        by_d = -2.0 * sign * d / size
        slope[..., 2:4] = by_d[:, :, None] * along[:, None]
        slope[..., :2] = -slope[..., 2:4]
        slope[..., 4] = sense * by_d
        slope[..., 5] = (2.0 * sign * c - 2.0 * b * cosine - h) / size
        slope[..., 6] = (2.0 * sign * b - 2.0 * c * cosine - h) / size
        return h, slope


# ----------------------------------------------------------------------
# Four-bars and slider-cranks whose coupler point follows a curve best, from many starts.
#
# All starts run as lanes; after some steps only the better ones go on, so that most of the time is
# spent on those that may become the best.


_GAP = 1e-7  # between inputs of positions in order [rad]: far above rounding
_DRAWS = 6  # for each start that is kept
_DRAWING = 0.1  # of the work of the steps
#: Lanes that go on, as shares of the starts, their steps, and the weight of constraints.
_STAGES = (
    (1.0, 12, 10.0),
    (0.4, 30, 30.0),
    (0.12, 120, 30.0),
    *((0.04, 200, 30.0),) * 3,
    *((0.04, 200, 100.0),) * 2,
)
_FEWEST = 12  # lanes of a stage
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
) -> FittedCurves:
    """The best mechanisms of one kind; the same for the same generator, whatever the cores.

    An interruption of the draws improves the few best ones so far, one of the steps ends these.
    """
    whole = (1.0 + _DRAWING) * sum(share * steps for share, steps, _ in _STAGES)
    drawing, requested = _DRAWING / (1.0 + _DRAWING), starts
    tell = progress or (lambda part: None)
    draws = _DRAWS * starts
    best, drawn = best_starts(kind, goal, draws, starts, rng, lambda part: tell(part * drawing))
    if not drawn:
        best, starts = best.take(np.arange(min(_FEWEST, len(best.x)))), _FEWEST
    problem = _CurveProblem(kind, goal, best)
    problem.work.whole, problem.work.done = whole, drawing * whole
    # an interruption of the draws would interrupt this too
    problem.work.tell = tell if drawn else None
    fit = problem.begun
    keep = np.arange(len(fit))
    for share, steps, weight in _STAGES:
        problem.weigh(weight)
        most = max(_FEWEST, round(share * starts))
        keep = keep[np.argsort(fit.total[keep], kind="stable")[:most]]
        problem.work.share_of_lanes = share
        fit = problem.further(fit, keep, steps)
        if fit.interrupted:
            most = max(_FEWEST, round(_STAGES[-1][0] * starts))
            keep = keep[np.argsort(fit.total[keep], kind="stable")[:most]]
            break
    return problem.result(fit, keep, requested, finished=drawn and not fit.interrupted)


class _CurveProblem(LaneProblem):
    """The residuals of a goal for lanes of starts."""

    most_lanes = 128

    def __init__(self, kind: type[CouplerCurves], goal: CurveGoal, best: CurveStarts) -> None:
        self.kind, self.goal = kind, goal
        self.curves, self.way = kind(best.side), best.way
        self.constraints = CurveConstraints(kind, goal, len(best.side))
        #: Crank angles at which row variables are 0: the begin of the driven range.
        self.origin = 0.0 * self.way
        width = np.inf
        if goal.range is not None:
            self.origin = np.where(self.way > 0.0, *goal.range)
            width = goal.range[1] - goal.range[0]
        gap = min(_GAP, 0.5 * width / len(goal.points))
        row_variables = RowVariables(
            least=-width if goal.range is None else 0.0,
            most=width,
            in_order=goal.ordered and goal.inputs is None,
            gap=gap if goal.ordered else 0.0,
            span=FULL_TURN - gap,
        )
        none = np.zeros(0, dtype=bool)
        super().__init__(goal.box(kind), row_variables, len(best.side), len(goal.points), none)
        self.begun = starts_of(self._entries(best), self._row_variables(best))

    @property
    def multipliers(self) -> list[Multipliers]:
        """Those of all constraints."""
        return self.constraints.multipliers

    def _entries(self, best: CurveStarts) -> Array:
        """Parameters of starts, (D, P)."""
        if self.goal.inputs is None:
            return best.x
        turned = (best.t - self.goal.inputs).mean(axis=1, keepdims=True)
        low, high = self.goal.input_bounds
        if self.goal.range is not None:
            # whole turns that bring starts nearest to their bounds
            turned += FULL_TURN * np.round((0.5 * (low + high) - turned) / FULL_TURN)
        return np.concatenate([best.x, turned], axis=1)

    def _row_variables(self, best: CurveStarts) -> Array:
        """Row variables of starts: crank angles, unless the task gives them."""
        if self.goal.inputs is not None:
            return np.zeros((len(best.x), 0))
        return np.asarray(best.t + self.way[:, None] * (self._turns(best) - self.origin[:, None]))

    def _turns(self, best: CurveStarts) -> Array:
        """The whole turns (D, 1) that bring the crank's angles to the driven range [rad]."""
        angles = self.way[:, None] * best.t
        turns, _ = self.goal.turned_inside(angles.min(axis=1), angles.max(axis=1))
        return turns[:, None]

    def angles(self, x: Array, t: Array, lanes: IndexArray) -> Array:
        """The crank's angles at the points, (D, N)."""
        if self.goal.inputs is None:
            return np.asarray(self.origin[lanes, None] + self.way[lanes, None] * t)
        return np.asarray(x[:, -1:] + self.goal.inputs)

    def evaluate(
        self, x: Array, t: Array, lanes: IndexArray, power: int | None = None
    ) -> Residuals:
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

    def result(
        self, fit: LaneFit, lanes: IndexArray, starts: int, *, finished: bool
    ) -> FittedCurves:
        """Different mechanisms among lanes, best first."""
        fit, count = fit.take(lanes), len(self.kind.names)
        missed = self.evaluate(fit.x, fit.t, lanes).rows[:, :, :2]
        total = np.einsum("dnm,dnm->d", missed, missed)
        lengths, turns = self.curves.take(lanes).shapes(fit.x[:, :count])
        # of timed points the common angle of the inputs
        turns = np.concatenate([turns, np.exp(1j * fit.x[:, count:])], axis=1)

        def alike(chosen: list[int], k: int) -> BoolArray:
            scale = self.goal.size + np.abs(lengths[k]).max()
            apart = np.abs(lengths[chosen] - lengths[k]).max(axis=1) / scale
            turned = np.abs(turns[chosen] - turns[k]).max(axis=1)
            return np.asarray(np.maximum(apart, turned) <= _SAME_DIMENSIONS)

        index = different(total, alike)
        return FittedCurves(
            kind=self.kind,
            x=fit.x[index][:, :count],
            angles=self.angles(fit.x[index], fit.t[index], lanes[index]),
            side=self.curves.side[lanes[index]],
            total=total[index],
            starts=starts,
            finished=finished,
        )


def _split(z: ComplexArray) -> Array:
    """Complex numbers (D, N) as pairs (D, N, 2)."""
    return np.stack([z.real, z.imag], axis=2)
