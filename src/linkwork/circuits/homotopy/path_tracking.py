"""The step control of a homotopy's solution paths.

Compiled code calls these functions with numbers, NumPy with arrays of them. The predictor is the
cubic through the last two points and slopes, the corrector two steps of Newton's method; the first
correction measures the predictor's error and sets the next step (Allgower & Georg, Numerical
Continuation Methods, ch. 6).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from linkwork.core.foundation.arrays import (
    Array,
    BoolArray,
    ComplexArray,
    IndexArray,
    StatusArray,
    solutions,
)
from linkwork.core.numerics.marching import HALF

ARRIVED, SINGULAR, LOST = 0, 1, 2

NEAR = 1e-4  # σ at which a singular path's distance from infinity is noted,
_END = 1e-10  # and at which it ends,
_STUCK = 1e-6  # or may end if rounding lets it go no further
_ARRIVAL = 1e-4  # largest second correction at the end of a path
FIRST_STEP = 0.02
_CAUTION, SMALLEST_CHANGE, _LARGEST_CHANGE = 0.85, 0.3, 2.5  # of the step


@dataclass(frozen=True, kw_only=True)
class PathOptions:
    """How carefully paths are followed.

    Parameters
    ----------
    error : float
        The predictor's error aimed at, relative to the size of w.
    contraction : float
        Largest ratio of the second correction to the first.
    rounding : float
        Second corrections this small are as good as the equations allow.
    floor : float
        With 0 the size of w is 1 + max |w_k|; otherwise every unknown has the size
        ``floor`` + |w_k| of its own.
    attempts : int
        Steps tried before a path is given up.
    smallest : float
        A smaller step, as a part of σ, leads nowhere.
    """

    error: float = 5e-2
    contraction: float = 0.3
    rounding: float = 1e-9
    floor: float = 0.0
    attempts: int = 600
    smallest: float = 1e-7


BOLD = PathOptions(error=1e-1)
CAREFUL = PathOptions(error=1e-4, contraction=0.05)


def cubic_weights(s: Any) -> tuple[Any, Any, Any, Any]:
    """Weights of Hermite's cubic at ``s``, in units of the last step beyond its end.

    Of the last point, its slope times that step, the point before and its slope times that step.
    """
    square = s * s
    back = square * (3.0 + 2.0 * s)
    slope_before = -square * (1.0 + s)
    return 1.0 - back, slope_before - s * (1.0 + s), back, slope_before


def is_good(e1: Any, e2: Any, last: Any, error: float, contraction: float, rounding: float) -> Any:
    """Whether an attempt is a step along the path, from the relative sizes of its corrections.

    ``last``: whether it ended at σ = 0. The other arguments are those of :class:`PathOptions`.
    """
    # quadratic convergence: the second correction must be much smaller than the first
    least = np.minimum(contraction * e1, error + last * (min(_ARRIVAL, error) - error))
    return (e1 < 4.0 * error) & (e2 <= np.maximum(least, rounding))


def step_factor(e1: Any, error: float) -> Any:
    """The ratio of the next step to an attempt, by its first correction."""
    factor = _CAUTION * (error / np.maximum(e1, 1e-12)) ** 0.25  # eq. (50)
    return np.minimum(np.maximum(factor, SMALLEST_CHANGE), _LARGEST_CHANGE)


def is_singular(stuck: Any, sigma: Any) -> Any:
    """Whether a path that has not arrived ends at a singular solution."""
    return (sigma < _END) | (stuck & (sigma < _STUCK))


# ----------------------------------------------------------------------
# Following many solution paths of a homotopy at once, each with its own step.
#
# H(w, σ) = 0 is followed from σ = 1, where every solution is known, to σ = 0. The control of steps
# is that of ``marching``, which compiled code shares
# (``families.paths``). A path that cannot jump to σ = 0 in one step approaches it in ever
# smaller ones and ends as singular; unknowns on projective patches keep a path to infinity bounded.


class Homotopy(Protocol):
    """A square system of analytic equations in w and σ."""

    def evaluate(
        self, w: ComplexArray, sigma: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """H (B, n), ∂H/∂w (B, n, n) and ∂H/∂σ (B, n) at w (B, n), σ (B,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Paths:
    """Ends of B paths.

    ``w`` (B, n); ``near`` (B, n): where a singular path was at a larger σ; ``state`` (B,):
    ARRIVED at a regular point of σ = 0, SINGULAR or LOST; ``steps``: rounds of the whole batch.
    """

    w: ComplexArray
    near: ComplexArray
    state: StatusArray
    steps: int


@dataclass(frozen=True, kw_only=True, eq=False)
class Ends:
    """Ends of paths in the unknowns, (B, n), and what they are, (B,)."""

    x: ComplexArray
    regular: BoolArray
    infinite: BoolArray
    singular: BoolArray

    @property
    def lost(self) -> BoolArray:
        """Those that are nothing else."""
        return ~(self.regular | self.infinite | self.singular)


def track(
    homotopy: Homotopy,
    start: ComplexArray,
    options: PathOptions | None = None,
    progress: Callable[[float], None] | None = None,
) -> Paths:
    """Follow every start (B, n), a solution at σ = 1, to σ = 0.

    ``progress``: called with the finished fraction after rounds; may raise an error to end it.
    """
    with np.errstate(all="ignore"):
        return _Tracker(homotopy, start, options or PathOptions()).run(progress)


class _Tracker:
    """The batch: lanes that are done leave."""

    def __init__(self, homotopy: Homotopy, start: ComplexArray, options: PathOptions) -> None:
        count = len(start)
        self.homotopy, self.options = homotopy, options
        self.w = start.copy()
        self.near = start.copy()
        self.state = np.full(count, LOST, dtype=np.int8)
        self.lane: IndexArray = np.arange(count)
        self.sigma = np.ones(count)
        self.step = np.full(count, FIRST_STEP)
        _, jacobian, change = homotopy.evaluate(start, self.sigma)
        slope = -solutions(jacobian, change[:, :, None])[:, :, 0]  # eq. (49)
        # points and slopes: here, there, before, there
        self.path = np.stack([start, slope, start, slope])
        self.gone = np.zeros(count)  # length of the last step, 0 before the first

    def run(self, progress: Callable[[float], None] | None = None) -> Paths:
        """Step until every lane has left."""
        rounds, count = 0, len(self.w)
        while len(self.lane) and rounds < self.options.attempts:
            self._advance()
            rounds += 1
            if progress is not None:
                progress(1.0 - float(self.sigma.sum()) / count)
        self.w[self.lane] = self.path[0]
        return Paths(w=self.w, near=self.near, state=self.state, steps=rounds)

    def _predict(self, h: Array) -> ComplexArray:
        """The cubic through the last two points, extrapolated; a line before the first step."""
        here, slope, before, slope_before = self.path
        first = self.gone == 0.0
        g = np.where(first, 1.0, self.gone)
        a, b, c, d = (weight[:, None] for weight in cubic_weights(h / g))
        guess: ComplexArray = a * here + c * before + g[:, None] * (b * slope + d * slope_before)
        if first.any():
            guess[first] = (here - h[:, None] * slope)[first]
        return guess

    def _advance(self) -> None:
        evaluate, options = self.homotopy.evaluate, self.options
        h = np.minimum(self.step, self.sigma)
        # exactly 0: the last system is the one that was asked for
        goal = np.where(self.sigma <= self.step, 0.0, self.sigma - h)
        guess = self._predict(h)
        f, jacobian, _ = evaluate(guess, goal)
        first = solutions(jacobian, f[:, :, None])[:, :, 0]
        w = guess - first
        e1 = relative_size(first, w, options.floor)
        f, jacobian, change = evaluate(w, goal)
        # one factorisation serves the second correction and the slope
        both = solutions(jacobian, np.stack([f, change], axis=2))
        w -= both[:, :, 0]
        e2 = relative_size(both[:, :, 0], w, options.floor)
        error, contraction, rounding = options.error, options.contraction, options.rounding
        good = is_good(e1, e2, goal == 0.0, error, contraction, rounding)
        factor = step_factor(e1, error)
        # eq. (49): the slope of the next prediction
        arrived = np.stack([w, -both[:, :, 1], self.path[0], self.path[1]])
        if good.all():
            self.step, self.gone, self.path = h * factor, self.sigma - goal, arrived
        else:
            # a singular Jacobian on the way: try a shorter step
            factor[np.isnan(factor)] = SMALLEST_CHANGE
            self.step = h * np.where(good, factor, np.minimum(factor, HALF))
            self.gone = np.where(good, self.sigma - goal, self.gone)
            self.path = np.where(good[:, None], arrived, self.path)
            goal = np.where(good, goal, self.sigma)
        passed = (self.sigma > NEAR) & (goal <= NEAR)
        if passed.any():
            self.near[self.lane[passed]] = self.path[0][passed]
        self.sigma = goal
        self._leave()

    def _leave(self) -> None:
        arrived = self.sigma == 0.0
        stuck = ~arrived & (self.step < self.options.smallest * self.sigma)
        singular = ~arrived & is_singular(stuck, self.sigma)
        ended = arrived | singular | stuck
        if not ended.any():
            return
        self.state[self.lane[arrived]] = ARRIVED
        self.state[self.lane[singular]] = SINGULAR
        self.w[self.lane[ended]] = self.path[0][ended]
        self._keep(~ended)

    def _keep(self, stay: BoolArray) -> None:
        self.path = self.path[:, stay]
        self.lane, self.sigma = self.lane[stay], self.sigma[stay]
        self.step, self.gone = self.step[stay], self.gone[stay]


def relative_size(change: ComplexArray, w: ComplexArray, floor: float) -> Array:
    """Changes (B, n) relative to the size of w (B, n), as :class:`PathOptions` defines it, (B,)."""
    if floor:
        own: Array = (np.abs(change) / (floor + np.abs(w))).max(axis=1)
        return own
    largest: Array = np.abs(change).max(axis=1) / (1.0 + np.abs(w).max(axis=1))
    return largest


# ----------------------------------------------------------------------
# Straight paths between members of a family of polynomial systems F(z; c) = 0.
#
# Almost all complex parameters c have the same number of isolated solutions, and the straight path
# from random ones to any others leads to all isolated solutions of the latter with probability one
# (Morgan & Sommese 1989, Appl. Math. Comput. 29, 123). The equations are written once, with
# operators only: they are computed with arrays here, and recorded for compiled code by
# ``families.paths``.


#: Every unknown has a size of its own: isotropic coordinates differ by powers of ten. Near a
#: singular end corrections are as large as rounding makes them; solutions are polished afterwards.
QUICK = PathOptions(error=1e-2, contraction=0.1, rounding=1e-6, floor=0.1, attempts=1500)
#: The same with more care.
SURE = PathOptions(
    error=1e-3, contraction=0.05, rounding=1e-6, floor=0.1, attempts=5000, smallest=1e-11
)
_POLISH = 8  # steps of Newton's method
_NOISE = 1e-10  # relative: the correction after one so small is rounding
_LINEAR, _SLOW = 0.2, 4  # steps between 0.3 and 0.7 of the one before, so many: no quadratic method
_SETTLED = 1e-6  # relative: the last correction of a solution, also of a nearly singular one

#: F (n), ∂F/∂z (n rows of n) and the change of F with the parameters' rate (n).
Equations = tuple[Sequence[Any], Sequence[Sequence[Any]], Sequence[Any]]


class ParametrizedSystem(Protocol):
    """n polynomial equations in n unknowns z, with parameters c."""

    @property
    def unknowns(self) -> int:
        """n."""

    @property
    def parameters(self) -> int:
        """P."""

    def equations(self, z: Sequence[Any], c: Sequence[Any], rate: Sequence[Any]) -> Equations:
        """The equations, with operators on z (n), c (P) and the rates of c (P) alone."""


@dataclass(frozen=True)
class StraightHomotopy:
    """F(z; (1 - σ) c1 + σ c0), for all c0 and c1: its parameters are both, one after the other."""

    system: ParametrizedSystem

    @property
    def unknowns(self) -> int:
        """n."""
        return self.system.unknowns

    @property
    def parameters(self) -> int:
        """2 P."""
        return 2 * self.system.parameters

    def compute(self, w: Sequence[Any], sigma: Any, parameters: Sequence[Any]) -> Equations:
        """H, ∂H/∂w and ∂H/∂σ."""
        half = self.system.parameters
        goal = parameters[half:]
        rate = [a - b for a, b in zip(parameters[:half], goal, strict=True)]
        c = [b + r * sigma for b, r in zip(goal, rate, strict=True)]
        return self.system.equations(w, c, rate)


@dataclass(frozen=True, kw_only=True, eq=False)
class ParameterPath:
    """A straight path from the parameters ``start`` (P,) to ``goal`` (P,)."""

    system: ParametrizedSystem
    start: ComplexArray
    goal: ComplexArray

    @property
    def ends(self) -> ComplexArray:
        """Both, (2P,): the parameters of a :class:`StraightHomotopy`."""
        return np.concatenate([self.start, self.goal])

    def evaluate(
        self, w: ComplexArray, sigma: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """H (B, n), ∂H/∂w (B, n, n) and ∂H/∂σ (B, n) at w (B, n), σ (B,)."""
        columns = list(np.ascontiguousarray(w.T))
        homotopy = StraightHomotopy(self.system)
        return as_batch(len(w), homotopy.compute(columns, sigma, self.ends.tolist()))

    def residual_and_jacobian(self, x: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """F (B, n) and its derivative (B, n, n) of the goal, at x (B, n)."""
        columns, c = list(np.ascontiguousarray(x.T)), self.goal.tolist()
        f, jacobian, _ = as_batch(len(x), self.system.equations(columns, c, [0.0] * len(c)))
        return f, jacobian


def as_batch(count: int, found: Equations) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """M equations of numbers (B,) in n unknowns, some of which may be plain zeros, as arrays."""
    rows, n = len(found[0]), len(found[1][0])
    f, change = (np.empty((rows, count), dtype=complex) for _ in range(2))
    jacobian = np.empty((rows, n, count), dtype=complex)
    for k in range(rows):
        f[k], change[k] = found[0][k], found[2][k]
        for i in range(n):
            jacobian[k, i] = found[1][k][i]
    return f.T.copy(), jacobian.transpose(2, 0, 1).copy(), change.T.copy()


@dataclass(frozen=True, kw_only=True, eq=False)
class PolishedEnds:
    """Ends of paths x (B, n), and whether they are ``regular`` or ``multiple`` solutions, (B,)."""

    x: ComplexArray
    regular: BoolArray
    multiple: BoolArray


class Tracker(Protocol):
    """Follows many solution paths, in NumPy or compiled."""

    def __call__(self, path: ParameterPath, start: ComplexArray, options: PathOptions, /) -> Paths:
        """Follow every start (B, n), a solution at σ = 1, to σ = 0."""


def polish_ends(path: ParameterPath, x: ComplexArray) -> PolishedEnds:
    """Newton's method at the goal from x (B, n), until rounding is all that is left."""
    x, live = x.copy(), np.arange(len(x))
    last, slow = np.full(len(x), np.inf), np.zeros(len(x), dtype=np.int64)
    for _ in range(_POLISH):
        here, before = x[live], last[live]
        f, jacobian = path.residual_and_jacobian(here)
        change = solutions(jacobian, f[:, :, None])[:, :, 0]
        size = relative_size(change, here, QUICK.floor)
        better, rounded = size < before, size <= _NOISE
        # a double solution halves the distance at every step
        slow[live] += better & ~rounded & (np.abs(size - 0.5 * before) < _LINEAR * before)
        x[live[better]], last[live[better]] = (here - change)[better], size[better]
        live = live[better & ~rounded]
        if not len(live):
            break
    multiple = slow >= _SLOW
    return PolishedEnds(x=x, regular=(last < _SETTLED) & ~multiple, multiple=multiple)
