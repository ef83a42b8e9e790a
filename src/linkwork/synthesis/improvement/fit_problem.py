"""Several objectives of lanes as one sum of squares: weights, and limits of some of them.

An objective f is the root mean square of the misses of one goal. A lane minimises the sum of w² f²
over the objectives, eq. (169); a limit f ≤ e is a constraint with a multiplier, eq. (155). Weights
reach the convex parts of a front only, limits reach every point of it.

References
----------
Y. Y. Haimes, L. S. Lasdon, D. A. Wismer, On a bicriterion formulation of the problems of integrated
system identification and system optimization, IEEE Transactions on Systems, Man, and Cybernetics 1
(1971) 296-297.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from linkwork.core.foundation.arrays import Array, IndexArray
from linkwork.core.foundation.errors import LinkworkError, MechanismError, Problem
from linkwork.core.foundation.loading import cores, share_out
from linkwork.core.mechanism.varied_numbers import VariedNumber, with_numbers
from linkwork.core.motion.branch_rows import between_rows
from linkwork.core.motion.model import Model, model_of
from linkwork.core.motion.sweeping import sweep
from linkwork.core.results.motion import Motion
from linkwork.synthesis.improvement.curves import row_inputs
from linkwork.synthesis.improvement.goals import Misses, NumberMisses, PathGoal, goal_of
from linkwork.synthesis.improvement.lanes import DesignWriter, SolvedLanes, inputs_away
from linkwork.synthesis.improvement.settings import Aid, Goal, Together
from linkwork.synthesis.lane_least_squares import (
    POWERS,
    Box,
    LaneFit,
    LaneProblem,
    Multipliers,
    Residuals,
    largest_misses,
    starts_of,
)

_STIFF = 10.0  # weight of limits, in spans of their objectives: their shifts converge faster
_EQUAL = 1e-12  # relative: numbers of motions that differ less are equal
_MARGIN = 1e-9  # of an objective's scale: by which limits hold in the end
_PATH = b"path"  # in place of the inputs of rows


@dataclass(frozen=True, kw_only=True, eq=False)
class Objectives:
    """Which residuals are the misses of which goal.

    Parameters
    ----------
    names : tuple of str
    columns : tuple of slice, optional
        Of the shared residuals; ``None``: the rows.
    weights : (K,)
        Of the goals, which the residuals contain.
    bounds : sequence of slice
        The shared residuals that are broken bounds.
    """

    names: tuple[str, ...]
    columns: tuple[slice | None, ...]
    weights: Array
    bounds: tuple[slice, ...]

    def misses(self, result: Residuals, k: int) -> tuple[Array, Array]:
        """The misses of an objective, (D, n), and by the numbers, (D, n, P)."""
        columns = self.columns[k]
        if columns is not None:
            return result.shared[:, columns], result.shared_by_x[:, columns]
        count = len(result.rows)
        return result.rows.reshape(count, -1), result.by_x.reshape(count, -1, result.by_x.shape[-1])

    def count(self, residuals: Residuals, k: int) -> int:
        """The number of misses of an objective; a distance from a point is one."""
        columns = self.columns[k]
        return int(residuals.rows.shape[1] if columns is None else columns.stop - columns.start)

    def values(self, residuals: Residuals) -> Array:
        """The objectives, (D, K), without the weights of their goals."""
        values = [
            np.linalg.norm(self.misses(residuals, k)[0], axis=1) / np.sqrt(self.count(residuals, k))
            for k in range(len(self.names))
        ]
        # there may be bounds only
        return np.array(values).reshape(len(values), len(residuals.shared)).T / self.weights

    def broken(self, result: Residuals) -> Array:
        """The largest residual of a bound, (D,)."""
        every = [np.abs(result.shared[:, part]).max(axis=1, initial=0.0) for part in self.bounds]
        return np.asarray(np.max([np.zeros(len(result.shared)), *every], axis=0))


class TradeOff:
    """The weights and limits of lanes.

    Parameters
    ----------
    objectives : Objectives
    scale : (K,)
        Units of the objectives.
    weights, limits : (L, K)
        Of scaled objectives; infinite: no limit.

    Attributes
    ----------
    stiffness : (L, K)
        Further weights of broken limits.
    """

    def __init__(self, objectives: Objectives, scale: Array, weights: Array, limits: Array) -> None:
        self.objectives, self.units = objectives, scale
        self.scale = scale * objectives.weights
        self.weights, self.limits = weights, limits
        self.stiffness = np.ones_like(limits)
        self.limited = Multipliers(*limits.shape)

    @property
    def has_limits(self) -> bool:
        """Whether an objective of a lane is limited."""
        return bool(np.isfinite(self.limits).any())

    def applied(self, residuals: Residuals, lanes: IndexArray) -> Residuals:
        """Weighted residuals of lanes, and those of broken limits after them."""
        rows, by_x, by_t = residuals.rows, residuals.by_x, residuals.by_t
        shared, shared_by_x = np.array(residuals.shared), np.array(residuals.shared_by_x)
        values, slopes = [], []
        for k, columns in enumerate(self.objectives.columns):
            unit = self.scale[k] * np.sqrt(self.objectives.count(residuals, k))
            misses, slope = self.objectives.misses(residuals, k)
            value = np.linalg.norm(misses / unit, axis=1)
            along = misses / unit / np.where(value > 0.0, value, 1.0)[:, None]
            values.append(value)
            slopes.append(np.einsum("dn,dnp->dp", along, slope / unit))
            # eq. (169)
            factor = self.weights[lanes, k] / unit
            if columns is None:
                rows, by_x = rows * factor[:, None, None], by_x * factor[:, None, None, None]
                by_t = None if by_t is None else by_t * factor[:, None, None]
            else:
                shared[:, columns] *= factor[:, None]
                shared_by_x[:, columns] *= factor[:, None, None]
        # eq. (155)
        h = np.stack(values, axis=1) - self.limits[lanes] + _MARGIN
        over, rise = self.limited.residuals(lanes, h, np.stack(slopes, axis=1))
        stiff = _STIFF * self.stiffness[lanes]
        return Residuals(
            rows,
            by_x,
            by_t,
            np.concatenate([shared, stiff * over], axis=1),
            np.concatenate([shared_by_x, stiff[:, :, None] * rise], axis=1),
        )


def numbered_names(names: Sequence[str]) -> tuple[str, ...]:
    """Names, with a number behind those that occur again."""
    return tuple(
        name if name not in names[:k] else f"{name} ({1 + list(names[:k]).count(name)})"
        for k, name in enumerate(names)
    )


# ----------------------------------------------------------------------
# Residuals of all goals of a mechanism, for lanes of designs on all cores.


APPROACH = 4  # parts of the way from the mechanism to a start


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
        """The numbers (D, P) at the parameters of the fit, (D, G)."""
        return x if self.together is None else self.together.numbers(x)


@dataclass(frozen=True, kw_only=True, eq=False)
class FittedNumbers:
    """D designs, one for each start that went to the end.

    Parameters
    ----------
    fitting : Fitting
        What was fitted.
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

    fitting: Fitting
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


class FitProblem(LaneProblem):
    """Residuals of all goals, for lanes of designs.

    Parameters
    ----------
    fitting : Fitting
    lanes : int

    Attributes
    ----------
    trade : TradeOff, optional
        Weights and limits of objectives; ``None``: the sum of all.
    moved, missed : (K,)
        How much numbers change each goal, and how far it is missed, as far as is known; else NaN.
    """

    def __init__(self, fitting: Fitting, lanes: int) -> None:
        self.fitting, model, motion, path = fitting, fitting.model, fitting.motion, fitting.path
        self.model, self.motion, self.path = model, motion, path
        self.numbers = np.array([float(q.of(model.description)) for q in fitting.numbers])
        self.x = self.numbers if fitting.together is None else fitting.together.sizes
        lead = next(iter(motion.inputs))
        scale = float(model.input_scale[0])
        # limits between the rows of the table move with the numbers
        table = (np.asarray(motion.inputs[lead]) * scale)[motion.asked]
        there = np.asarray(motion.found[motion.asked])
        self.writer = DesignWriter(model, fitting.numbers)
        self.goals = [goal_of(model, goal, table, there, scale) for goal in fitting.goals]
        # of the shared residuals, those that are no bounds
        counted = [np.full(misses.count, not misses.is_bound) for misses in self.goals]
        # goals of the same rows share their positions
        tables = {misses.at.tobytes(): misses.at for misses in self.goals}
        if path is not None:
            tables = {_PATH: path.inputs, **tables}
        super().__init__(
            fitting.box,
            row_inputs(path, model, table),
            lanes,
            sum(map(len, tables.values())),
            np.concatenate([np.zeros(0, bool), *counted]),
        )
        self.solved = {key: self._solved_lanes(at) for key, at in tables.items()}
        self._there = there
        #: How much the numbers of a fit are above the exact ones, for each goal (K, lanes).
        self.errors = np.zeros((len(self.goals), lanes))
        self.bounds = self._new_bounds()
        self.trade: TradeOff | None = None
        self._reached = np.zeros(lanes, dtype=bool)
        self.moved, self.missed = np.full((2, len(self.goals)), np.nan)

    def _new_bounds(self) -> list[Multipliers | None]:
        return [
            Multipliers(self.lanes, 2, misses.count) if misses.is_bound else None
            for misses in self.goals
        ]

    @property
    def multipliers(self) -> list[Multipliers]:
        """Those of goals that are bounds, and of limits of objectives."""
        limits = [self.trade.limited] if self.trade is not None and self.trade.has_limits else []
        return [*limits, *(bound for bound in self.bounds if bound is not None)]

    @cached_property
    def objectives(self) -> Objectives:
        """The goals that are no bounds, the path first."""
        names: list[str] = [] if self.path is None else [self.path.point]
        columns: list[slice | None] = [] if self.path is None else [None]
        weights, bounds, first = [1.0] * len(names), [], 0
        for misses in self.goals:
            part = slice(first, first + misses.count)
            first = part.stop
            if misses.is_bound:
                bounds.append(part)
                continue
            names.append(misses.goal.of)
            columns.append(part)
            weights.append(misses.goal.weight)
        return Objectives(
            names=numbered_names(names),
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
        """Start lanes at the present state of other lanes."""
        for name in ("x", "t", "total"):
            getattr(fit, name)[to] = getattr(fit, name)[of]
        for solved in self.solved.values():
            solved.copy_lanes(of, to)
        self.errors[:, to] = self.errors[:, of]
        self._reached[to] = True

    def _solved_lanes(self, at: Array) -> SolvedLanes:
        """Lanes at inputs, begun between or at the nearest rows of the mechanism's motion."""
        away = inputs_away(at, self.motion, self.model)
        q = self.motion.q[away.argmin(axis=1)]
        far = away.min(axis=1) > 0.0
        if far.any() and self.motion.found.all():
            between = between_rows(self.model, self.motion)(at[far]).columns[0][:, : q.shape[1]]
            q[far] = np.where(np.isfinite(between), between, q[far])
        return SolvedLanes(self.writer, self.numbers, q, at, self.lanes)

    def begun(self, starts: Array) -> LaneFit:
        """The starts, which are reached from the mechanism when their lanes are first worked on."""
        free_inputs = 0 if self.path is None or self.path.timed else len(self.path.places)
        inputs = self.path.inputs[:free_inputs] if self.path else np.zeros(0)
        return starts_of(starts, np.array(np.broadcast_to(inputs, (len(starts), free_inputs))))

    def reached(self, fit: LaneFit, lanes: IndexArray) -> LaneFit:
        """Starts reached from the mechanism, with their sums; infinite where lost."""
        every = fit.take(np.arange(len(fit)))

        def work(part: IndexArray, count: Callable[[], None]) -> None:
            every.total[part] = self._reach(fit.take(part), part, count)

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
        """Go from numbers to others in steps, so that positions follow; the sums there."""
        total = np.zeros(0)
        for part in range(1, APPROACH + 1):
            count()
            for solved in self.solved.values():
                solved.total[lanes] = np.inf
            total = self.evaluate(begin + (end - begin) * (part / APPROACH), t, lanes).total
        return total

    def prepare(self, fit: LaneFit, lanes: IndexArray, count: Callable[[], None]) -> LaneFit:
        """Lanes that are reached, if they were not before."""
        if not self._reached[lanes].all():
            fit = replace(fit, total=self._reach(fit, lanes, count))
        for solved in self.solved.values():
            # sums of an earlier round are no measure of this one
            solved.total[lanes] = np.inf
        return fit

    def evaluate(
        self, x: Array, t: Array, lanes: IndexArray, power: int | None = None
    ) -> Residuals:
        """All misses of designs (D, P); NaN for those of other equations."""
        x = self.fitting.all_numbers(x)
        count, parameters = x.shape
        rows, by_x = np.zeros((count, 0, 2)), np.zeros((count, 0, 2, parameters))
        by_t: Array | None = None
        designs = self.writer.written(x)
        free = self.path is not None and not self.path.timed
        positions = {
            key: solved.at(designs, lanes, t if free and key == _PATH else None)
            for key, solved in self.solved.items()
        }
        if self.path is not None:
            rows, by_x, slope = self.path.misses(positions[_PATH])
            by_t = slope if free else None
        shared, shared_by_x = [np.zeros((count, 0))], [np.zeros((count, 0, parameters))]
        for k, misses in enumerate(self.goals):
            arguments = positions[misses.at.tobytes()], self.errors[k, lanes], self.bounds[k], lanes
            missed, slopes = misses.of(*arguments)
            if not self.moved[k] > 0.0 and (there := np.isfinite(missed)).any():
                self.moved[k] = float(np.abs(slopes[there]).max())
                self.missed[k] = float(np.abs(missed[there]).max())
            shared.append(missed)
            shared_by_x.append(slopes)
        slopes = np.concatenate(shared_by_x, axis=1)
        if self.fitting.together is not None:
            by_x, slopes = (slope @ self.fitting.together.slopes for slope in (by_x, slopes))
        result = Residuals(rows, by_x, by_t, np.concatenate(shared, axis=1), slopes)
        if self.trade is not None:
            result = self.trade.applied(result, lanes)
        result = self.raised(result, lanes, power)
        for key, solved in self.solved.items():
            solved.keep(positions[key], lanes, result.total)
        return result

    def correct(self, fit: LaneFit, lanes: IndexArray) -> IndexArray:
        """Take the errors of polynomials off numbers of the motion; the lanes with other errors.

        Errors are measured on the motions of designs: a deferred correction. A design without all
        rows of the mechanism keeps its error.
        """
        goals = {k: miss for k, miss in enumerate(self.goals) if isinstance(miss, NumberMisses)}
        changed: list[int] = []
        known = lanes[np.isfinite(fit.total[lanes])] if goals else lanes[:0]
        for part in self.work.parts(known) if len(known) else ():
            x = self.fitting.all_numbers(fit.x[part])
            designs = self.writer.written(x)
            values = []
            for goal in goals.values():
                solved = self.solved[goal.at.tobytes()].at(designs, part)
                values.append(goal.values(solved)[0][:, 0])
            for d, lane in enumerate(part.tolist()):
                motion = self._motion(x[d])
                if motion is None:
                    continue
                exact = np.array([goal.exact(motion) for goal in goals.values()])
                error = np.array([value[d] for value in values]) - exact
                error[np.isnan(error)] = 0.0
                away = np.abs(error - self.errors[[*goals], lane])
                self.errors[[*goals], lane] = error
                if not (away <= _EQUAL * np.abs(exact)).all():
                    changed.append(lane)
        return np.array(changed, dtype=np.intp)

    def _motion(self, x: Array) -> Motion | None:
        """The motion of a design, if it has all rows that the mechanism has."""
        new = dict(zip(self.fitting.numbers, x.tolist(), strict=True))
        try:
            model = model_of(with_numbers(self.model.description, new))
            motion = sweep(model, certify=False)
        except LinkworkError:
            return None
        return motion if motion.found[motion.asked][self._there].all() else None

    def measured(self, fit: LaneFit, lanes: IndexArray) -> Residuals:
        """The misses of lanes without powers, weights and shifts."""
        kept = self.power, self.trade, self.bounds
        self.power, self.trade, self.bounds = 1, None, self._new_bounds()
        for solved in self.solved.values():
            solved.total[lanes] = np.inf
        parts = self.work.parts(lanes)
        measured: dict[int, Residuals] = {}

        def measure(k: int) -> None:
            measured[k] = self.evaluate(fit.x[parts[k]], fit.t[parts[k]], parts[k])

        share_out(measure, range(len(parts)), cores())
        self.power, self.trade, self.bounds = kept
        return Residuals.joined([measured[k] for k in range(len(parts))])

    def result(self, fit: LaneFit, most: int | None = None) -> FittedNumbers:
        """All lanes that are known, or the best ones, with their misses."""
        known = np.argsort(fit.total, kind="stable")[: max(1, np.isfinite(fit.total).sum())]
        known = np.sort(known[:most])
        self.correct(fit, known)
        there = self.measured(fit, known)
        beyond = [misses.beyond(there.shared[:, columns]) for misses, columns in self._kept]
        fit = fit.take(known)
        timed = self.path is None or self.path.timed
        t = fit.t
        if timed and self.path is not None:
            t = np.array(np.broadcast_to(self.path.inputs, (len(fit), len(self.path.places))))
        return FittedNumbers(
            fitting=self.fitting,
            x=self.fitting.all_numbers(fit.x),
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


# ----------------------------------------------------------------------
# Whether the numbers that vary change the goals of an improvement at all.


_PROBES, _PROBED = 4, 0.05  # designs that are drawn in this part of the bounds


def check_moved(problem: FitProblem) -> None:
    """Refuse goals that are missed, and that no number changes at any design so far, nor at some
    that are drawn.

    Raises
    ------
    MechanismError
    """
    unmoved = _unmoved(problem)
    if unmoved:
        probe, width = FitProblem(problem.fitting, _PROBES), problem.box.most - problem.box.least
        draws = np.random.default_rng(0).uniform(-1.0, 1.0, (_PROBES, len(problem.x)))
        x = problem.box.inside(problem.x + _PROBED * width * draws)
        probe.reached(probe.begun(x), np.arange(_PROBES))
        unmoved &= _unmoved(probe)
    reason = "changes with no number that varies, at any start: vary numbers that it depends on, or"
    problems = [
        Problem(
            key=("goals", k, "of"),
            message=f'"{problem.goals[k].goal.of}" {reason} leave this goal out',
        )
        for k in sorted(unmoved)
    ]
    if problems:
        raise MechanismError(problems, "the improvement")


def _unmoved(problem: FitProblem) -> set[int]:
    """Goals that are missed and that no number has changed; none that was nowhere known."""
    still = (problem.moved == 0.0) & (problem.missed > 0.0)
    return {int(k) for k in np.flatnonzero(still) if not problem.goals[k].is_bound}


# ----------------------------------------------------------------------
# The numbers of any mechanism that meet goals best, from many starts in lanes on all cores.


_STEPS = (60, 200, 200)  # of all lanes, then of the better half
_BOUND_STEPS = (60,) * 7  # the same; after each the shifts of bounds change
_POWER_STEPS = 60
_CORRECTIONS, _CORRECTION_STEPS = 14, 20
_ALL = 64  # so few lanes all go on, and are left of an interrupted fit


def fit_numbers(
    fitting: Fitting,
    starts: Array,
    *,
    minimax: bool = False,
    progress: Callable[[float], None] | None = None,
) -> FittedNumbers:
    """Improve starts (D, P).

    ``minimax``: the largest miss counts, instead of the sum of squares.

    Raises
    ------
    UnknownNameError, InputError
        For goals that are not known, or whose derivatives are not known.
    """
    problem = FitProblem(fitting, len(starts))
    rounds = [(1, steps) for steps in (_BOUND_STEPS if problem.multipliers else _STEPS)]
    rounds += [(power, _POWER_STEPS) for power in (POWERS if minimax else ())]
    problem.work.tell, problem.work.whole = progress, sum(steps for _, steps in rounds)
    fit = problem.begun(starts)
    for k, (power, steps) in enumerate(rounds):
        problem.power = power
        # sums of other powers and shifts say nothing of this round
        changed = power > 1 or problem.multipliers
        left = np.flatnonzero(np.isfinite(fit.total) if k and changed else ~fit.done | (k == 0))
        # of many lanes only the better half goes on
        most = len(starts) if len(starts) <= _ALL or not k else len(starts) // 2
        keep = left[np.argsort(fit.total[left], kind="stable")[:most]]
        if not len(keep):
            continue
        fit = problem.further(fit, keep, steps)
        if fit.interrupted:
            break
        check_moved(problem)
    left = np.arange(len(starts))
    for _ in range(0 if fit.interrupted else _CORRECTIONS):
        try:
            left = problem.correct(fit, left)
        except KeyboardInterrupt:
            fit = replace(fit, interrupted=True)
        if not len(left) or fit.interrupted:
            break
        fit = problem.further(fit, left, _CORRECTION_STEPS)
    return problem.result(fit, _ALL if fit.interrupted else None)


def path_misses(
    model: Model, motion: Motion, numbers: Sequence[VariedNumber], path: PathGoal, x: Array
) -> Array:
    """The distances of one mechanism from timed points, (N,), reached from the nearest rows of its
    motion; NaN where it has no position on their branch.
    """
    away = inputs_away(path.inputs, motion, model)
    writer = DesignWriter(model, numbers)
    solved = SolvedLanes(writer, x, motion.q[away.argmin(axis=1)], path.inputs, 1)
    positions = solved.at(writer.written(x[None]), np.zeros(1, dtype=int))
    place = positions.rows.place(path.point).v
    value = positions.values([place.real, place.imag])[0][0]
    return np.asarray(np.abs(value[:, 0] + 1j * value[:, 1] - path.places))


def misses_before(fitting: Fitting, *, minimax: bool) -> float:
    """What a fit makes small, of the mechanism as it is; infinite if it breaks a bound."""
    problem = FitProblem(fitting, 1)
    now = problem.result(problem.reached(problem.begun(problem.x[None]), np.arange(1)))
    kept = now.broken[0] == 0.0 and not now.beyond.any()
    return float((now.largest if minimax else now.total)[0]) if kept else np.inf
