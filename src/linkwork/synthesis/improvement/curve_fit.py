"""Starts of a curve fit: of mechanisms drawn at random, those whose curves are most similar.

A drawn curve may be moved, turned and enlarged freely. With complex points q of the curve and z of
the goal the best such motion is a linear fit, eq. (154); its residual ranks the draws. Without
timing, points correspond by the shares of arc length at which they lie.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from linkwork.core.foundation.arrays import Array, Batch, BoolArray, ComplexArray, IndexArray
from linkwork.core.foundation.units import FULL_TURN, arc_in_order
from linkwork.synthesis.improvement.curves import INPUT, CouplerCurves, CurveGoal, FourBarCurves
from linkwork.synthesis.lane_least_squares import (
    LaneFit,
    LaneProblem,
    Multipliers,
    Residuals,
    RowVariables,
    different,
    starts_of,
)

_SAMPLES = 72  # of a curve: five degrees
_PART = 128  # curves compared at a time
_SHARES = (0.08, 0.15, 0.25, 0.4, 0.6, 0.8)  # of the arc length, for a part of a curve
_RANGE_SHARES = (0.3, 0.6, 0.9)  # the same, of the driven range
_FARTHEST = 8.0  # sizes of the goal: how far A0 is drawn from it, where it is bounded


@dataclass(frozen=True, kw_only=True, eq=False)
class CurveStarts(Batch):
    """D starts.

    Parameters
    ----------
    x : (D, P)
        Dimensions.
    t : (D, N)
        Crank angles at the points, in the sense of ``way`` [rad].
    side, way : (D,)
        Signs of the loops, and of the crank's sense of rotation.
    missed : (D,)
        The sum of squares that the comparison leaves [length²].
    """

    x: Array
    t: Array
    side: Array
    way: Array
    missed: Array


def random_loops(kind: type[CouplerCurves], count: int, rng: np.random.Generator) -> Array:
    """Dimensions (D, P) with a crank that turns fully, A0 at 0 and B0 or the line near 1."""
    loops: list[Array] = []
    left = count
    while left > 0:
        drawn = 4 * left + 16
        size = np.exp(rng.normal(0.0, 0.8, (drawn, 3)))
        p, q = (size[:, 1] * rng.normal(0.0, 1.2, drawn) for _ in range(2))
        nothing = np.zeros(drawn)
        if kind is FourBarCurves:
            columns = [nothing, nothing, nothing + 1.0, nothing, *size.T, p + 0.5 * size[:, 1], q]
        else:
            offset = rng.normal(0.0, 0.5, drawn) * size[:, 0]
            columns = [nothing, nothing, size[:, 0], size[:, 1], offset, nothing, p, q]
        x = np.stack(columns, axis=1)
        turning = (kind(nothing + 1.0).limits(x)[0] < 0.0).all(axis=1)
        loops.append(x[turning][:left])
        left -= len(loops[-1])
    return np.concatenate(loops)


def best_starts(
    kind: type[CouplerCurves],
    goal: CurveGoal,
    count: int,
    keep: int,
    rng: np.random.Generator,
    tell: Callable[[float], None],
) -> tuple[CurveStarts, bool]:
    """The best of ``count`` draws, each driven both ways on both sides of its loop, and whether
    all were compared: an interruption keeps those so far, if there are any.
    """
    free = goal.is_placed_freely
    x = random_loops(kind, count, rng)
    if not free:
        x = _spread(kind, x, goal, rng)
    parts: list[CurveStarts] = []
    finished = False
    try:
        for begin in range(0, count, _PART):
            tell(begin / count)
            some = x[begin : begin + _PART]
            for side in (1.0, -1.0):
                parts += [_compared(kind, some, side, way, goal, free) for way in goal.ways]
        finished = True
    except KeyboardInterrupt:
        if not parts:
            raise
    every = CurveStarts.joined(parts)
    return every.take(np.argsort(every.missed, kind="stable")[:keep]), finished


def _spread(
    kind: type[CouplerCurves], x: Array, goal: CurveGoal, rng: np.random.Generator
) -> Array:
    """Draws moved, turned and enlarged at random near the goal, then into the box."""
    count = len(x)
    size = goal.size * np.exp(rng.normal(0.3, 0.8, count))
    factor = size * np.exp(1j * rng.uniform(0.0, FULL_TURN, count))
    away = rng.normal(0.0, 1.5, (2, count)) * goal.size
    box, dimensions = goal.box(kind), len(kind.names)
    moved = kind(np.ones(count)).moved(x, goal.points.mean() + away[0] + 1j * away[1], factor)
    return np.asarray(np.clip(moved, box.least[:dimensions], box.most[:dimensions]))


def _compared(
    kind: type[CouplerCurves], x: Array, side: float, way: float, goal: CurveGoal, free: bool
) -> CurveStarts:
    """The best correspondence of each draw with the goal."""
    angles = way * np.linspace(0.0, FULL_TURN, _SAMPLES, endpoint=False)
    count = len(x)
    curves = kind(np.full(count, side))
    along = np.broadcast_to(angles, (count, _SAMPLES))
    q = curves.points(x, along).guided
    turns = along
    if goal.inputs is None:
        q, turns = _by_arc_length(q, along, way)
    missed = np.full(count, np.inf)
    t = np.zeros((count, len(goal.points)))
    factor = np.ones(count, dtype=complex)
    shift = np.zeros(count, dtype=complex)
    for index in _correspondences(goal, way):
        wraps, inside = np.divmod(index, _SAMPLES)
        fitted = _fitted(q, inside, goal.points, free)
        if goal.range is not None:
            place = turns[:, inside] + way * FULL_TURN * wraps + np.angle(fitted[1])[:, :, None]
            ends = place.min(axis=2), place.max(axis=2)
            if goal.inputs is not None:
                # a common angle of the inputs, and their arc
                begin, extent = arc_in_order(goal.inputs)
                first = place[:, :, 0] + begin - goal.inputs[0]
                ends = first, first + extent
            _, outside = goal.turned_inside(*ends)
            # points that are driven back into the range miss by about as much
            fitted[0][:] += len(goal.points) * (goal.size * outside) ** 2
        best = fitted[0].argmin(axis=1)
        lanes = np.arange(count)
        better = fitted[0][lanes, best] < missed
        missed = np.where(better, fitted[0][lanes, best], missed)
        factor = np.where(better, fitted[1][lanes, best], factor)
        shift = np.where(better, fitted[2][lanes, best], shift)
        place = turns[lanes[:, None], inside[best]] + way * FULL_TURN * wraps[best]
        t = np.where(better[:, None], place, t)
    fine = np.isfinite(missed)
    x, t = x[fine], t[fine]
    if free:
        x = curves.take(fine).moved(x, shift[fine], factor[fine])
        t = t + np.angle(factor[fine])[:, None]
    signs = np.ones(len(x))
    return CurveStarts(x=x, t=way * t, side=side * signs, way=way * signs, missed=missed[fine])


def _correspondences(goal: CurveGoal, way: float) -> Iterator[IndexArray]:
    """Samples for the points of the goal, (K, N): every first sample, one share at a time."""
    first = np.arange(_SAMPLES)[:, None]
    if goal.inputs is not None:
        low, high = goal.input_bounds if INPUT in goal.bounds else (0.0, FULL_TURN)
        low, high = low * _SAMPLES / FULL_TURN, high * _SAMPLES / FULL_TURN
        if high - low < _SAMPLES:
            # at least the one nearest to the middle
            inner = np.arange(np.ceil(low), np.floor(high) + 1.0)
            first = (inner if len(inner) else np.rint([0.5 * (low + high)])).astype(int)[:, None]
        yield first + np.rint(goal.inputs * (way * _SAMPLES / FULL_TURN)).astype(int)
        return
    shares: tuple[float, ...] = (1.0,) if goal.closed else _SHARES
    if goal.limited_range is not None:
        width = min(1.0, (goal.limited_range[1] - goal.limited_range[0]) / FULL_TURN)
        shares = (*shares, *(part * width for part in _RANGE_SHARES))
    for share in shares:
        yield first + np.rint(goal.arc_shares * (share * _SAMPLES)).astype(int)


def _by_arc_length(q: ComplexArray, angles: Array, way: float) -> tuple[ComplexArray, Array]:
    """Curves and their crank angles at equal steps of arc length."""
    closed = np.concatenate([q, q[:, :1]], axis=1)
    turns = np.concatenate([angles, angles[:, :1] + way * FULL_TURN], axis=1)
    length = np.cumsum(np.abs(np.diff(closed, axis=1)), axis=1)
    length = np.concatenate([np.zeros((len(q), 1)), length], axis=1)
    points, places = np.full_like(q, np.nan), np.full(q.shape, np.nan)
    for k in np.flatnonzero(np.isfinite(length[:, -1]) & (length[:, -1] > 0.0)):
        along = np.linspace(0.0, length[k, -1], _SAMPLES, endpoint=False)
        places[k] = np.interp(along, length[k], turns[k])
        points[k] = np.interp(along, length[k], closed[k].real) + 1j * np.interp(
            along, length[k], closed[k].imag
        )
    return points, places


def _fitted(
    q: ComplexArray, index: IndexArray, z: ComplexArray, free: bool
) -> tuple[Array, ComplexArray, ComplexArray]:
    """What the best motion of curves leaves, its factor and its shift, (D, K) each."""
    chosen = q[:, index]
    if not free:
        missed = np.sum(np.abs(chosen - z) ** 2, axis=2)
        one: ComplexArray = np.ones(missed.shape, dtype=complex)
        return np.asarray(np.where(np.isfinite(missed), missed, np.inf)), one, 0.0 * one
    middle = chosen.mean(axis=2)
    apart = chosen - middle[:, :, None]
    aim = z - z.mean()
    # eq. (154)
    norm = np.einsum("dkn,dkn->dk", apart.real, apart.real)
    norm += np.einsum("dkn,dkn->dk", apart.imag, apart.imag)
    with np.errstate(all="ignore"):
        factor = (apart.conj() @ aim) / norm
        missed = np.sum(np.abs(aim) ** 2) - np.abs(factor) ** 2 * norm
    left: Array = np.where(np.isfinite(missed), np.maximum(missed, 0.0), np.inf)
    shift: ComplexArray = z.mean() - factor * middle
    return left, factor, shift


# ----------------------------------------------------------------------
# Four-bars and slider-cranks whose coupler point follows a curve best, and their constraints.


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
