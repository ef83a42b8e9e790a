"""Structural errors of four-bars and slider-cranks, and largest ones that are equal."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from linkwork.core.foundation.arrays import (
    EPSILON,
    UNIT_ROUNDOFF,
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
)
from linkwork.core.foundation.statuses import Completeness
from linkwork.core.foundation.units import FULL_TURN
from linkwork.synthesis.improvement.curve_fit import CurveConstraints
from linkwork.synthesis.improvement.curves import CurveGoal, FourBarCurves, SliderCrankCurves
from linkwork.synthesis.lane_least_squares import (
    POWERS,
    Box,
    LaneProblem,
    Multipliers,
    Progress,
    Residuals,
    RowVariables,
    different,
    starts_of,
)
from linkwork.synthesis.loops.limits import (
    Candidates,
    Drive,
    LoopKind,
    cross,
    dot,
    solve_with_bound,
)
from linkwork.synthesis.poses.burmester import DyadSet, PoseSet, sampled_dyads
from linkwork.synthesis.poses.dyads import solve_five_poses
from linkwork.synthesis.solvers.result import SolvedTask
from linkwork.synthesis.tasks.conditions import Wishes
from linkwork.synthesis.tasks.task import Task

#: Structural errors (K,) of parameters (n,), and derivatives (K, n); NaN where a loop is open.
Errors = Callable[[Array], tuple[Array, Array]]

_MOST_STEPS = 100
_SMALLEST_STEP = 1e-13  # relative: Newton steps end in rounding
_REGULAR = 1e-7  # relative: far above the rounding of derivatives
_LEVEL = 1e-9  # by which the largest error may exceed that of the reference points


def rocker_errors(inputs: Array, outputs: Array, side: float | Array) -> Errors:
    """The errors of a rocker's angle, for parameters a, b, c of a four-bar with ground 1.

    ``inputs``, ``outputs``: (K,) [rad]; ``side``: the sign of (B - A) × (B - B0). With lanes
    (D, K), sides (D, 1) and parameters (3, D, 1), errors are (D, K). The last derivative is that
    by the input.
    """

    def errors(lengths: Array) -> tuple[Array, Array]:
        a, b, c = lengths
        crank = np.exp(1j * inputs)
        base = 1.0 - a * crank
        square = np.abs(base) ** 2
        along = 0.5 * (square + c**2 - b**2)
        with np.errstate(invalid="ignore", divide="ignore"):
            across = np.sqrt(square * c**2 - along**2)
            coupler = base * (along + 1j * side * across) / square
            # B - B0 = A + coupler - 1, divided by a signed length
            rocker = (coupler - base) / b
            angle = np.angle(rocker)
            wrong = np.mod(angle - outputs + np.pi, 2.0 * np.pi) - np.pi
            slope = b * dot(coupler, 1j * rocker)
            gradient = [dot(coupler, crank), -dot(coupler, rocker), c + 0.0 * wrong]
            gradient.append(dot(coupler, 1j * a * crank))
            return wrong, np.stack([part / slope for part in gradient], axis=-1)

    return errors


def slider_errors(inputs: Array, outputs: Array, side: float | Array) -> Errors:
    """The errors of a slider's displacement, for parameters a, e, c: crank, offset and rod.

    ``inputs`` (K,) [rad], ``outputs`` (K,) [length]; ``side``: the sign of (B - A) along the line.
    Lanes and derivatives as of :func:`rocker_errors`.
    """

    def errors(lengths: Array) -> tuple[Array, Array]:
        a, e, c = lengths
        crank = np.exp(1j * inputs)
        height = e - a * crank.imag
        with np.errstate(invalid="ignore", divide="ignore"):
            reach = side * np.sqrt(c**2 - height**2)
            wrong = a * crank.real + reach - outputs
            gradient = [crank.real + height * crank.imag / reach, -height / reach, c / reach]
            gradient.append(a * (height * crank.real / reach - crank.imag))
            return wrong, np.stack(gradient, axis=-1)

    return errors


def levels_minimise(errors: Errors, x: Array, points: list[int]) -> bool:
    """Whether n + 1 equal errors, the largest ones, are a strict local minimum of the largest one.

    They are if every step enlarges one of them: a sum of their derivatives with positive weights
    is zero, and n of the derivatives are independent (Kuhn and Tucker).
    """
    e, jacobian = errors(x)
    if np.abs(e).max() > np.abs(e[points]).min() * (1.0 + _LEVEL) + EPSILON:
        return False
    rows = np.sign(e[points])[:, None] * jacobian[points]
    scale = np.linalg.norm(rows, axis=0)
    if not scale.all():  # errors of zero, too: there is nothing to make smaller
        return False
    rows = rows / scale
    _, values, turned = np.linalg.svd(rows.T)
    weights = turned[-1] * np.sign(turned[-1].sum())
    return bool(values[-1] > _REGULAR * values[0] and weights.min() > _REGULAR)


def levelled(errors: Errors, start: Array, points: list[int]) -> tuple[Array, float] | None:
    """The parameters for which errors at the points are ±E, and E."""
    x = start.copy()
    e, jacobian = errors(x)
    signs = np.sign(e[points])
    for _ in range(_MOST_STEPS):
        matrix = np.column_stack([jacobian[points], -signs])
        try:
            change = np.linalg.solve(matrix, -e[points])
        except np.linalg.LinAlgError:
            return None
        x = x + change[:-1]
        e, jacobian = errors(x)
        if not np.isfinite(e).all():
            return None
        if np.abs(change[:-1]).max() <= _SMALLEST_STEP * np.abs(x).max():
            break
    return x, float(np.abs(e[points]).max())


# ----------------------------------------------------------------------
# Wishes of a task of functions as constraints on the lanes of its fits, eq. (155).


_MARGIN = 1e-4  # of lengths, relative: the error that multipliers leave


class FunctionWishes:
    """The constraints of D lanes, which have crank, rocker or offset, coupler, and both starts.

    ``u`` (N,): inputs [rad]; ``size``: of lengths, 1 with a four-bar's ground.
    """

    def __init__(self, wishes: Wishes, u: Array, size: float, slides: bool, lanes: int) -> None:
        span = wishes.range
        #: The driven range, unless it is that of the inputs, and moves with their start.
        self.range = None if span is None or span.turn else (span.start, span.stop)
        self.ends = sorted(self.range or (float(u.min()), float(u.max())))
        self.kind = SliderCrankCurves if slides else FourBarCurves
        self.columns = [2, 4, 3] if slides else [4, 6, 5]
        goal = CurveGoal(
            points=np.array([0.0, 2.0 * size], dtype=complex),
            closed=False,
            turns_fully=span is not None and span.turn,
            transmission=wishes.transmission,
            shortest=wishes.shortest * (1.0 + _MARGIN),
            longest=wishes.longest * (1.0 - _MARGIN),
            ratio=wishes.ratio * (1.0 - _MARGIN),
        )
        self.constraints = CurveConstraints(self.kind, goal, lanes)
        limits = span or goal.transmission or goal.shortest
        self.are_any = bool(limits or min(goal.longest, goal.ratio) < np.inf)

    def _loops(self, x: Array) -> tuple[Array, Array, Array]:
        """Dimensions (D, P) of the same loops as curves, signs of theirs here, and the angles of
        the crank where transmission angles may be least.
        """
        signs = np.where(x[:, :3] < 0.0, -1.0, 1.0)
        loops = np.zeros((len(x), len(self.kind.names)))
        if self.kind is FourBarCurves:
            loops[:, 2] = 1.0
        else:
            signs[:, 1] = 1.0  # of an offset
        loops[:, self.columns] = signs * x[:, :3]
        turned = 0.25 * FULL_TURN * (1.0 - signs[:, :1]) + (0.0 if self.range else x[:, 3:4])
        middle, half = turned + 0.5 * sum(self.ends), 0.5 * (self.ends[1] - self.ends[0])
        extreme = self.kind(np.ones(1)).extreme(loops)[:, None] + [0.0, 0.5 * FULL_TURN]
        away = (extreme - middle + 0.5 * FULL_TURN) % FULL_TURN - 0.5 * FULL_TURN
        return loops, signs, middle + np.clip(away, -half, half)

    def broken(self, x: Array, lanes: IndexArray) -> tuple[Array, Array]:
        """How far requirements are broken, (D, K), and by the parameters, (D, K, 5)."""
        if not self.are_any:
            return np.zeros((len(x), 0)), np.zeros((len(x), 0, 5))
        loops, signs, angles = self._loops(x)
        h, slope = self.constraints.residuals(loops, lanes)
        by_start = np.zeros_like(h)
        more = self.constraints.at_points(loops, angles, lanes)
        if more is not None:
            h, slope = (np.append(h, more[0], axis=1), np.append(slope, more[1], axis=1))
            by_start = np.append(by_start, 0.0 * more[2] if self.range else more[2], axis=1)
        by_x = slope[:, :, self.columns] * signs[:, None]
        return h, np.concatenate([by_x, by_start[:, :, None], 0.0 * h[:, :, None]], axis=2)


# ----------------------------------------------------------------------
# Fits of functions: dimensions whose output follows pairs best, by least squares or minimax.
#
# Each lane has the dimensions of a four-bar (crank a, rocker b, coupler c, ground 1) or
# slider-crank (crank a, offset e, rod c), then the angle that is added to the inputs, and the angle
# or displacement that is added to the outputs: 0 where the starts are given, free where only
# differences count. With given starts a negative crank or rocker points the other way.


_STEPS, _POWER_STEPS = 150, 40
_WEIGHTS = (10.0, 30.0, 30.0, 100.0, 100.0)  # of requirements, round by round
_LANES = 120  # of the starts, those with the smallest sums of squares
_KEPT = 24  # lanes that minimise the largest miss
_FAR = 1e3  # ratios of lengths
_HARDLY = 0.01  # the sine of the least transmission angle
_ALIKE = 0.02  # relative: lanes that end at one fit, or in one valley


@dataclass(frozen=True, kw_only=True, eq=False)
class FittedPairs:
    """What a fit follows.

    Parameters
    ----------
    u, v : (N,)
        Inputs [rad] and outputs [rad or length].
    slides : bool
        Whether the mechanism is a slider-crank.
    minimax : bool
        Whether the largest error counts, instead of the sum of squares.
    first : (float, float), optional
        Bounds of the angle that is added to the inputs [rad]; ``None``: starts are given.
    wishes : Wishes
    """

    u: Array
    v: Array
    slides: bool
    minimax: bool
    first: tuple[float, float] | None
    wishes: Wishes

    @property
    def size(self) -> float:
        """Of lengths: the range of a slider, or 1 with a four-bar's ground."""
        return float(np.ptp(self.v)) if self.slides else 1.0

    def wishes_of(self, lanes: int) -> FunctionWishes:
        """The requirements of so many lanes."""
        return FunctionWishes(self.wishes, self.u, self.size, self.slides, lanes)

    @property
    def box(self) -> Box:
        """Bounds of lengths, which may point the other way at given starts, and of starts."""
        small, large = self.size / _FAR, _FAR * self.size
        if self.first is None:
            least, starts = [-large, -large, small], [(0.0, 0.0), (0.0, 0.0)]
        else:
            least = [small, -large if self.slides else small, small]
            starts = [self.first, (-np.inf, np.inf)]
        return Box(
            least=np.array([*least, *(low for low, _ in starts)]),
            most=np.array([large] * 3 + [high for _, high in starts]),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class FunctionFits:
    """D different fits, best first.

    Parameters
    ----------
    x : (D, 5)
    wrong : (D, N)
        Structural errors at the pairs [rad or length].
    closes : (D,)
        Whether a loop closes with some transmission angle, or its fit is proved to be minimal.
    minimal : (D,)
        Whether a fit is proved to be a local minimum of the largest error, to first order.
    interrupted : bool
        Whether the user stopped the fit, which keeps the best so far.
    """

    x: Array
    wrong: Array
    closes: BoolArray
    minimal: BoolArray
    interrupted: bool = False


class _FunctionProblem(LaneProblem):
    """Structural errors of lanes."""

    most_lanes = 128

    def __init__(self, pairs: FittedPairs, side: Array) -> None:
        self.u, self.v, self.side = pairs.u, pairs.v, side
        self.wishes = pairs.wishes_of(len(side))
        self.make = slider_errors if pairs.slides else rocker_errors
        none = np.zeros(self.wishes.broken(np.ones((0, 5)), np.arange(0))[0].shape[1], dtype=bool)
        super().__init__(pairs.box, RowVariables(), len(side), len(self.u), none)

    @property
    def multipliers(self) -> list[Multipliers]:
        """Multipliers of the requirements."""
        return self.wishes.constraints.multipliers if self.wishes.are_any else []

    def errors(self, x: Array, lanes: IndexArray) -> tuple[Array, Array]:
        """Errors (D, N) and their derivatives (D, N, 5)."""
        u, v = self.u + x[:, 3:4], self.v + x[:, 4:5]
        made = self.make(u, v, self.side[lanes, None])
        wrong, by_x = made(x[:, :3].T[:, :, None])
        return wrong, np.concatenate([by_x, np.full((*wrong.shape, 1), -1.0)], axis=2)

    def evaluate(
        self, x: Array, t: Array, lanes: IndexArray, power: int | None = None
    ) -> Residuals:
        """Errors as rows of one number, and broken requirements."""
        wrong, by_x = self.errors(x, lanes)
        broken = self.wishes.broken(x, lanes)
        residuals = Residuals(wrong[:, :, None], by_x[:, :, None], None, *broken)
        return self.raised(residuals, lanes, power)


def fit_functions(
    pairs: FittedPairs, starts: tuple[Array, Array], progress: Progress | None = None
) -> FunctionFits:
    """Fits of pairs from starts (D, 5) with their sides (D,).

    Fits whose loops hardly close are left out but for the best one: most are no local minima, and
    end where errors would fall on beyond the last loop that closes.
    """
    (x, side), box, minimax, first = starts, pairs.box, pairs.minimax, pairs.first
    if first is not None and np.isfinite(sum(first)):
        # whole turns that bring starts nearest to their bounds
        x[:, 3] += FULL_TURN * np.round((0.5 * sum(first) - x[:, 3]) / FULL_TURN)
    x = box.inside(x)
    lanes = _FunctionProblem(pairs, side)
    wrong = lanes.errors(x, np.arange(len(x)))[0]
    if not np.isfinite(wrong).all(axis=1).any():
        none = np.zeros(0, dtype=bool)
        return FunctionFits(x=x[:0], wrong=wrong[:0], closes=none, minimal=none)
    total = lanes.evaluate(x, x[:, :0], np.arange(len(x))).total
    some = np.argsort(total, kind="stable")[: min(_LANES, int(np.isfinite(total).sum()))]
    lanes, side = _FunctionProblem(pairs, side[some]), side[some]
    every = np.arange(len(some))
    fit = lanes.further(starts_of(x[some], np.zeros((len(some), 0))), every, _STEPS)
    for weight in _WEIGHTS if lanes.multipliers else ():
        lanes.weigh(weight)
        fit = lanes.further(fit, every, _POWER_STEPS)
    order = _different(fit.x, fit.total)[:_KEPT]
    lanes, fit = _FunctionProblem(pairs, side[order]), fit.take(order)
    powers = (*POWERS, *POWERS[-1:] * (len(_WEIGHTS) if lanes.multipliers else 0))
    lanes.work.tell, lanes.work.whole = progress, len(powers) * _POWER_STEPS
    for lanes.power in powers if minimax and not fit.interrupted else ():
        fit = lanes.further(fit, np.arange(len(fit)), _POWER_STEPS)
        lanes.weigh(_WEIGHTS[-1])
    x, minimal = fit.x.copy(), np.zeros(len(fit), dtype=bool)
    for k in range(len(fit)) if minimax else ():
        sharp, least = _sharpened(lanes, x[k], k, box)
        if not pairs.wishes_of(1).broken(sharp[None], np.zeros(1, dtype=np.intp))[0].any():
            x[k], minimal[k] = sharp, least
    wrong = lanes.errors(x, np.arange(len(x)))[0]
    measure = np.abs(wrong).max(axis=1, initial=0.0) if minimax else (wrong**2).sum(axis=1)
    index = _different(x, measure)
    closes = _closes(x, pairs.u, pairs.slides) | minimal  # a proved minimum is one all the same
    index = index[closes[index] | (np.arange(len(index)) == 0)]
    return FunctionFits(
        x=x[index], wrong=wrong[index], closes=closes[index],
        minimal=minimal[index], interrupted=fit.interrupted,
    )  # fmt: skip


def _closes(x: Array, u: Array, slides: bool) -> BoolArray:
    """Whether loops close with some transmission angle at all inputs, (D,)."""
    a, second, c = x[:, :3].T[:, :, None]
    crank = a * np.exp(1j * (u + x[:, 3:4]))
    if slides:
        cosine = (second - crank.imag) / c
    else:
        cosine = (second**2 + c**2 - np.abs(1.0 - crank) ** 2) / (2.0 * second * c)
    return np.asarray((1.0 - cosine**2 >= _HARDLY**2).all(axis=1))


def _different(x: Array, measure: Array) -> IndexArray:
    """Lanes with different lengths by rising measure, without those that have none."""

    def alike(chosen: list[int], k: int) -> BoolArray:
        apart = np.abs(x[chosen, :3] - x[k, :3]).max(axis=1)
        return np.asarray(apart <= _ALIKE * np.abs(x[k, :3]).max())

    return different(measure, alike)


def _sharpened(lanes: _FunctionProblem, x: Array, k: int, box: Box) -> tuple[Array, bool]:
    """A fit whose largest errors are made equal, if that lowers them, and whether it is minimal;
    numbers at their bounds stay there.
    """
    free, fixed = (x > box.least) & (x < box.most), box.least == box.most

    def errors(free_values: Array) -> tuple[Array, Array]:
        every = x.copy()
        every[free] = free_values
        wrong, by_x = lanes.errors(every[None], np.array([k]))
        return wrong[0], by_x[0][:, free]

    before = np.abs(errors(x[free])[0])
    count = int(free.sum()) + 1
    if not np.isfinite(before).all() or len(before) < count:
        return x, False
    points = [int(n) for n in np.sort(np.argsort(-before, kind="stable")[:count])]
    level = levelled(errors, x[free], points)
    if level is None or not np.abs(errors(level[0])[0]).max() <= before.max() * (1.0 + _LEVEL):
        return x, False
    sharp = x.copy()
    sharp[free] = level[0]
    if (box.inside(sharp) != sharp).any():
        return x, False
    return sharp, bool((free | fixed).all()) and levels_minimise(errors, level[0], points)


# ----------------------------------------------------------------------
# Function generation: all loops whose output follows given pairs, or fits a function best.


#: Of the longest to the shortest link of fits without [wanted] lengths, so that one can draw them.
USUAL_RATIO = 20.0

_LOSS = 16.0 * UNIT_ROUNDOFF  # of angles, their sines, and sums of few of them
_SMALL = 0.05  # relative errors up to which a quotient's error is at most 1.1 times its first order
_STARTS = 24  # start angles in each direction, where two are free
_TRIVIAL = 1e-6  # relative: both moving pivots at the fixed ones move in every function
_FIVE, _FOUR = 5, 4
_SHARES = (0.067, 0.15, 0.25, 0.0)  # of the range, before the first point of a start
# for given start angles: before the first and behind the last point, and before the middle one
_FIRSTS, _MIDDLES = (0.0, 0.067, 0.15, 0.25, 0.35), (0.4, 0.5, 0.6)


def solve_function(task: Task, wishes: Wishes, progress: Progress | None = None) -> SolvedTask:
    """All designs, or a sample of the family, for a function task."""
    goal = task.function
    assert goal is not None, "a task of functions has one"
    slides = task.mechanisms[0] == "slider-crank"
    inputs, outputs = goal.points()
    u = np.array([inputs * task.angle.radians])
    v = np.array([outputs * (1.0 if slides else task.angle.radians)])
    if not goal.starts_fixed:
        u, v = u - u[:, :1], v - v[:, :1]
    # the ground of a four-bar, or a power of two near the outputs, which divides without rounding
    unit = float(2.0 ** np.frexp(np.abs(v).max())[1]) if slides else task.given.ground
    of_outputs = unit if slides else 1.0
    wishes = replace(wishes, shortest=wishes.shortest / unit, longest=wishes.longest / unit)
    solved = _solved(task, wishes, u, v / of_outputs, progress)
    first = complex(*(task.given.fixed_pivots or [(0.0, 0.0)])[0])
    return replace(
        solved,
        candidates=tuple(
            replace(part.moved(first, unit), miss=of_outputs * part.miss)
            for part in solved.candidates
        ),
        zeros=tuple((begin, of_outputs * output) for begin, output in solved.zeros),
    )


def _solved(
    task: Task, wishes: Wishes, u: Array, v: Array, progress: Progress | None
) -> SolvedTask:
    """Designs whose fixed pivot A0 is at 0, for inputs and outputs (1, K)."""
    goal, slides = task.function, task.mechanisms[0] == "slider-crank"
    assert goal is not None, "a task of functions has one"
    if goal.fit:
        return _fitted(task, wishes, u[0], v[0], slides, progress)
    if goal.starts_fixed:
        made, determined = _through_three(u, v, slides)
        zeros = ((float(u[0, 0]), float(v[0, 0])),) * len(made)
        return _solved_function(task, made, complete=1 if determined.all() else -1, zeros=zeros)
    if u.shape[1] == _FIVE:
        return _through_five(task, u, v, slides)
    if u.shape[1] == _FOUR:
        return _through_four(task, u, v, slides)
    made, _ = _through_three(*_freely_begun(u, v, slides), slides)
    return _solved_function(task, made, complete=0)


def _freely_begun(u: Array, v: Array, slides: bool) -> tuple[Array, Array]:
    """Inputs and outputs (1, K) from a grid of starts, (B, K) each."""
    # half a turn more is a negative length
    grid = np.linspace(0.0, np.pi, _STARTS, endpoint=False)
    first, second = (x.ravel() for x in np.meshgrid(grid, grid))
    if slides:
        # displacements may begin anywhere within twice their range
        second = (second * (2.0 / np.pi) - 1.0) * 2.0 * np.ptp(v)
    return u + first[:, None], v + second[:, None]


def freudenstein(u: Array, v: Array) -> tuple[Array, Array]:
    """K of cos(φ - ψ) = K1 cos ψ - K2 cos φ + K3, (B, 3), with bounds of the errors, eq. (149).

    Parameters
    ----------
    u, v : (B, 3)
        Angles φ of the crank and ψ of the rocker, both from the line of the ground [rad].

    Returns
    -------
    (B, 3), (B, 3)
        K1 = d/a, K2 = d/b, K3 = (a² + b² - c² + d²)/(2ab); a negative length points the other way.

    References
    ----------
    F. Freudenstein: Approximate synthesis of four-bar linkages. Transactions of the ASME 77 (1955)
    """
    # eq. (149)
    matrix = np.stack([np.cos(v), -np.cos(u), np.ones_like(u)], axis=-1)
    doubt = _LOSS * (1.0 + np.abs(u).max(axis=1) + np.abs(v).max(axis=1))
    return solve_with_bound(matrix, np.cos(u - v), doubt, doubt)


def _through_three(u: Array, v: Array, slides: bool) -> tuple[list[Candidates], BoolArray]:
    """Loops with given start angles, for B functions (B, 3), and which functions determine a loop,
    also with complex numbers only.
    """
    if slides:
        # eq. (150)
        matrix = np.stack([2.0 * v * np.cos(u), 2.0 * np.sin(u), np.ones_like(u)], axis=-1)
        far = _LOSS * (1.0 + np.abs(v).max(axis=1) ** 2) * (1.0 + np.abs(u).max(axis=1))
        k, error = solve_with_bound(matrix, v**2, far, far)
        with np.errstate(all="ignore"):
            a, e = k[:, 0], k[:, 1] / k[:, 0]
            square = k[:, 2] + a**2 + e**2
            doubt = 1.1 * error[:, 0] * (1.0 + np.abs(e)) / np.abs(a)
        determined = error[:, 0] < _SMALL * np.abs(k[:, 0])
        good = (square > 0) & determined
        return _loops(u[good], v[good], a[good], e[good], doubt[good], slides), determined
    k, error = freudenstein(u, v)
    with np.errstate(all="ignore"):
        a, b = 1.0 / k[:, 0], 1.0 / k[:, 1]
        square = a**2 + b**2 + 1.0 - 2.0 * a * b * k[:, 2]
        doubt = 1.1 * error[:, 0] * np.maximum(a**2, b**2)
    determined = np.asarray((error[:, :2] < _SMALL * np.abs(k[:, :2])).all(axis=1))
    good = (square > 0) & determined
    return _loops(u[good], v[good], a[good], b[good], doubt[good], slides), determined


def _loops(
    u: Array, v: Array, a: Array, second: Array, error: Array, slides: bool
) -> list[Candidates]:
    """Loops with A0 at 0, for cranks (D,) with rockers or offsets, inputs and outputs (D, K)."""
    if not len(u):
        return []
    zero = np.zeros(len(u), dtype=complex)
    moving = a[:, None] * np.exp(1j * u)
    fixed_b = np.asarray(1j * second if slides else zero + 1.0, dtype=np.complex128)
    output = v if slides else second[:, None] * np.exp(1j * v)
    return [
        Candidates(
            kind=LoopKind.SLIDER_CRANK if slides else LoopKind.FOUR_BAR,
            fixed_a=zero,
            fixed_b=fixed_b,
            direction=np.full(len(u), slides, dtype=complex),
            moving_a=moving,
            moving_b=fixed_b[:, None] + output,
            error=error,
        )
    ]


def _relative_poses(u: Array, v: Array, slides: bool) -> tuple[ComplexArray, Array]:
    """The output link as the crank's link sees it, (B, N) complex and (B, N) [rad].

    A dyad of these poses is the coupler: its fixed pivot is A in the crank's frame, its moving
    pivot B in the output's frame.
    """
    if slides:
        return np.asarray(np.exp(-1j * u) * v), -u
    return np.asarray(np.exp(-1j * u)), v - u


def _coupled(dyads: DyadSet, u: Array, v: Array, slides: bool) -> list[Candidates]:
    """Loops from the dyads of relative poses, without the trivial one."""
    size = 1.0 if not slides else float(np.abs(v).max())
    real = (dyads.kind == 0) & (np.abs(dyads.fixed) > _TRIVIAL * size)
    real &= slides | (np.abs(dyads.moving) > _TRIVIAL * size)
    some = dyads.take(real)
    crank = some.moving
    begin, second = (crank.real, crank.imag) if slides else (np.angle(crank), np.abs(crank))
    phi, out = u[some.task] + np.angle(some.fixed)[:, None], v[some.task] + begin[:, None]
    return _loops(phi, out, np.abs(some.fixed), second, some.error, slides)


def _through_five(task: Task, u: Array, v: Array, slides: bool) -> SolvedTask:
    points, angles = _relative_poses(u, v, slides)
    solved = solve_five_poses(points, angles)
    poses = PoseSet(points=points, turns=np.exp(1j * angles))
    made = _coupled(DyadSet.of_solutions(solved, poses), u, v, slides)
    return _solved_function(task, made, complete=3 if bool(solved.complete[0]) else -3)


def _through_four(task: Task, u: Array, v: Array, slides: bool) -> SolvedTask:
    points, angles = _relative_poses(u, v, slides)
    dyads = sampled_dyads(points[0], angles[0])
    return _solved_function(task, _coupled(dyads, u, v, slides), complete=0)


def _fitted(
    task: Task,
    wishes: Wishes,
    u: Array,
    v: Array,
    slides: bool,
    progress: Progress | None,
) -> SolvedTask:
    """Different fits of pairs, with given starts or by differences, from loops through three."""
    goal = task.function
    assert goal is not None, "a task of functions has one"
    first = None if goal.starts_fixed else _first_inputs(task, u)
    begun = _begins_at_fixed_angles(u, v) if goal.starts_fixed else _free_begins(u, v, slides)
    starts = [
        _lanes(loops, u[index[0]], v[index[0]], slides, goal.starts_fixed)
        for index, x_fit in begun
        for loops in _through_three(*x_fit, slides)[0]
    ]
    starts.append((np.zeros((0, 5)), np.zeros(0)))
    x, side = (np.concatenate(part) for part in zip(*starts, strict=True))
    if usual := has_usual_ratio(task):
        # a slider-crank's lengths may grow without end; its output has a size
        far = max(float(np.ptp(v)), float(np.abs(v).max()) if goal.starts_fixed else 0.0)
        longest = USUAL_RATIO * far if slides else math.inf
        wishes = replace(wishes, ratio=USUAL_RATIO, longest=longest)
    minimax = goal.fit == "minimax"
    pairs = FittedPairs(u=u, v=v, slides=slides, minimax=minimax, first=first, wishes=wishes)
    fits = fit_functions(pairs, (x, side), progress)
    made: list[Candidates] = []
    zeros: list[tuple[float, float]] = []
    for x_fit, wrong in zip(fits.x, fits.wrong, strict=True):
        miss = float(np.abs(wrong).max())
        # without bounds in the first turn
        begin = x_fit[3] if first is None or np.isfinite(first[0]) else x_fit[3] % FULL_TURN
        made += _fit_design(u + x_fit[3], v + x_fit[4] + wrong, x_fit[:3], slides, miss)
        zeros.append((float(u[0] + begin), float(v[0] + x_fit[4])))
    result = _solved_function(task, made, complete=0, zeros=tuple(zeros))
    text = f"1 {goal.fit} fit" if len(made) == 1 else f"{len(made)} different {goal.fit} fits"
    message = f"a sample: {text} from {len(x)} starts"
    if fits.interrupted:
        message = f"interrupted: the best so far of {len(x)} starts"
    if not made:
        message = "no result: no loop through three of the pairs follows all of them"
    if fits.minimal.any():
        message += f", {int(fits.minimal.sum())} of them proved to be local minima"
    if not fits.closes.all():
        message += "; the loop of the best one hardly closes: it may be no local minimum"
    if usual:
        of = "the shortest and the size of the output" if slides else "the shortest"
        message += f"; lengths up to {USUAL_RATIO:g} times {of} unless [wanted] bounds them"
    return replace(result, message=message, starts=len(x), interrupted=fits.interrupted)


def has_usual_ratio(task: Task) -> bool:
    """Whether the lengths of a fit are bounded though its task bounds none, but counts size."""
    goal, wanted = task.function, task.wanted
    bounded = wanted.shortest > 0.0 or min(wanted.longest, wanted.ratio) < math.inf
    return goal is not None and bool(goal.fit and task.rank.size) and not bounded


def _first_inputs(task: Task, u: Array) -> tuple[float, float]:
    """Bounds of the angle that is added to inputs (N,), of which the first is 0."""
    if task.wanted.range is None:
        return -np.inf, np.inf
    ends = sorted(map(task.in_radians, task.wanted.range))
    low, high = ends[0] - float(u.min()), ends[1] - float(u.max())
    return low, max(low, high)  # equal to rounding, if the pairs fill the range


#: Three places of pairs, and inputs and outputs there (B, 3).
_Begun = tuple[IndexArray, tuple[Array, Array]]


def _free_begins(u: Array, v: Array, slides: bool) -> Iterator[_Begun]:
    """A grid of starts, at a few places."""
    for share in _SHARES:
        index = _spread_index(len(u), (share, 0.5, 1.0 - share))
        yield index, _freely_begun(u[None, index], v[None, index], slides)


def _begins_at_fixed_angles(u: Array, v: Array) -> Iterator[_Begun]:
    """Many places."""
    for shares in product(_FIRSTS, _MIDDLES, _FIRSTS):
        index = _spread_index(len(u), (shares[0], shares[1], 1.0 - shares[2]))
        if len(set(index)) == len(index):
            yield index, (u[None, index], v[None, index])


def _spread_index(count: int, shares: Sequence[float]) -> IndexArray:
    return np.asarray((np.array(shares) * (count - 1)).round().astype(np.intp))


def _lanes(loops: Candidates, u: float, v: float, slides: bool, fixed: bool) -> tuple[Array, Array]:
    """Parameters (D, 5) and sides (D,) of loops at their first place, at input u and output v."""
    a = loops.moving_a[:, 0]
    coupler = loops.moving_b[:, 0] - a
    rocker = loops.moving_b[:, 0] - loops.fixed_b
    side = np.sign(coupler.real if slides else cross(coupler, rocker))
    crank, second = np.abs(a), loops.fixed_b.imag if slides else np.abs(rocker)
    begin = np.angle(a) - u, (rocker.real if slides else np.angle(rocker)) - v
    if fixed:
        crank, begin = (a * np.exp(-1j * u)).real, (np.zeros(len(a)), np.zeros(len(a)))
        second = second if slides else (rocker * np.exp(-1j * v)).real
    return np.stack([crank, second, np.abs(coupler), *begin], axis=1), side


def _fit_design(u: Array, v: Array, lengths: Array, slides: bool, miss: float) -> list[Candidates]:
    a, second, _ = (np.array([x]) for x in lengths)
    # the loop closes to rounding at every point, whatever its structural error
    error = np.array([_LOSS * (1.0 + np.abs(lengths).max()) * (1.0 + np.abs(u).max())])
    made = _loops(u[None], v[None], a, second, error, slides)
    for design in made:
        design.miss[:] = miss
    return made


def _solved_function(
    task: Task, made: list[Candidates], complete: int, zeros: tuple[tuple[float, float], ...] = ()
) -> SolvedTask:
    """The loops with their counts.

    ``complete``: the number of solutions of a complete list, negative if this is not proved, 0
    for a sample.
    """
    real = sum(map(len, made))
    proved = sum(int(np.isfinite(part.error).sum()) for part in made)
    grade, message = Completeness.SAMPLED, "a sample: these conditions leave a family of mechanisms"
    if complete > 0:
        grade = Completeness.PROVED
        message = "all solutions: the equations have no others"
    elif complete < 0:
        grade = Completeness.NOT_PROVED
        message = "not proved: to rounding, the equations are singular: families of mechanisms, "
        message += "such as parallelograms, are not listed"
    return SolvedTask(
        candidates=tuple(made),
        complex=abs(complete) or real,
        real=real,
        proved=proved,
        completeness=grade,
        message=message,
        drives=(Drive.A0,),
        zeros=zeros,
        output="slide" if task.mechanisms[0] == "slider-crank" else "rocker",
    )
