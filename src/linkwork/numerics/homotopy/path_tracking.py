"""Following many solution paths of a homotopy at once, each with its own step.

H(w, σ) = 0 is followed from σ = 1, where every solution is known, to σ = 0. The predictor is the
cubic through the last two points and slopes, the corrector two steps of Newton's method; the first
correction measures the predictor's error and sets the next step (Allgower & Georg, Numerical
Continuation Methods, ch. 6). Unknowns are on projective patches, so a path to infinity stays
bounded. A path that cannot jump to σ = 0 in one step approaches it in ever smaller ones and ends as
singular.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray, StatusArray
from linkwork.numerics.homotopy.polynomial_system import solve_linear

__all__ = [
    "ARRIVED",
    "BOLD",
    "CAREFUL",
    "LOST",
    "SINGULAR",
    "Homotopy",
    "PathOptions",
    "Paths",
    "track",
]

ARRIVED, SINGULAR, LOST = 0, 1, 2

_NEAR = 1e-4  # σ at which a singular path's distance from infinity is noted,
_END = 1e-10  # and at which it ends,
_STUCK = 1e-6  # or may end if rounding lets it go no further
_ROUNDING = 1e-9  # second corrections this small are as good as the equations allow
_ARRIVAL = 1e-4  # largest second correction at the end of a path
_LARGEST_STEPS = 600
_FIRST_STEP = 0.02
_CAUTION, _SMALLEST_CHANGE, _LARGEST_CHANGE = 0.85, 0.3, 2.5  # of the step


class Homotopy(Protocol):
    """A square system of analytic equations in w and σ."""

    def evaluate(
        self, w: ComplexArray, sigma: Array
    ) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """H (B, n), ∂H/∂w (B, n, n) and ∂H/∂σ (B, n) at w (B, n), σ (B,)."""


@dataclass(frozen=True, kw_only=True)
class PathOptions:
    """How carefully paths are followed.

    Parameters
    ----------
    error : float
        The predictor's error aimed at, relative to the size of w.
    contraction : float
        Largest ratio of the second correction to the first.
    """

    error: float = 5e-2
    contraction: float = 0.3


BOLD = PathOptions(error=1e-1)
CAREFUL = PathOptions(error=1e-4, contraction=0.05)


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


def track(homotopy: Homotopy, start: ComplexArray, options: PathOptions | None = None) -> Paths:
    """Follow every start (B, n), a solution at σ = 1, to σ = 0."""
    with np.errstate(all="ignore"):
        return _Tracker(homotopy, start, options or PathOptions()).run()


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
        self.step = np.full(count, _FIRST_STEP)
        _, jacobian, change = homotopy.evaluate(start, self.sigma)
        slope = -solve_linear(jacobian, change[:, :, None])[:, :, 0]  # eq. (49)
        # points and slopes: here, there, before, there
        self.path = np.stack([start, slope, start, slope])
        self.gone = np.zeros(count)  # length of the last step, 0 before the first

    def run(self) -> Paths:
        """Step until every lane has left."""
        rounds = 0
        while len(self.lane) and rounds < _LARGEST_STEPS:
            self._advance()
            rounds += 1
        self.w[self.lane] = self.path[0]
        return Paths(w=self.w, near=self.near, state=self.state, steps=rounds)

    def _predict(self, h: Array) -> ComplexArray:
        """The cubic through the last two points, extrapolated; a line before the first step."""
        here, slope, before, slope_before = self.path
        g = np.where(self.gone == 0.0, 1.0, self.gone)[:, None]
        s = h[:, None] / g
        # a polynomial in s with ends at -1 (before) and 0 (here), slopes per σ downwards
        a, rise = g * slope, here - before
        # Hermite's cubic in s, with both slopes scaled to the last step
        c = g * slope_before + a + 2.0 * rise
        cubic: ComplexArray = here - s * (a + s * (c + a + rise + s * c))
        first = self.gone == 0.0
        if first.any():
            cubic[first] = (here - s * a)[first]
        return cubic

    def _advance(self) -> None:
        evaluate, h = self.homotopy.evaluate, np.minimum(self.step, self.sigma)
        # exactly 0: the last system is the one that was asked for
        goal = np.where(self.sigma <= self.step, 0.0, self.sigma - h)
        guess = self._predict(h)
        f, jacobian, _ = evaluate(guess, goal)
        first = solve_linear(jacobian, f[:, :, None])[:, :, 0]
        w = guess - first
        f, jacobian, change = evaluate(w, goal)
        # one factorisation serves the second correction and the slope
        both = solve_linear(jacobian, np.stack([f, change], axis=2))
        second = both[:, :, 0]
        w -= second
        size = 1.0 + np.abs(w).max(axis=1)
        e1, e2 = np.abs(first).max(axis=1) / size, np.abs(second).max(axis=1) / size
        aim = self.options.error
        # quadratic convergence: the second correction must be much smaller than the first
        near = np.minimum(self.options.contraction * e1, np.where(goal == 0.0, _ARRIVAL, aim))
        good = (e1 < 4.0 * aim) & (e2 <= np.maximum(near, _ROUNDING))
        factor = _CAUTION * (aim / np.maximum(e1, 1e-12)) ** 0.25  # eq. (50)
        factor = np.minimum(np.maximum(factor, _SMALLEST_CHANGE), _LARGEST_CHANGE)
        # eq. (49): the slope of the next prediction
        arrived = np.stack([w, -both[:, :, 1], self.path[0], self.path[1]])
        if good.all():
            self.step, self.gone, self.path = h * factor, self.sigma - goal, arrived
        else:
            # a singular Jacobian on the way: try a shorter step
            factor[np.isnan(factor)] = _SMALLEST_CHANGE
            self.step = h * np.where(good, factor, np.minimum(factor, 0.5))
            self.gone = np.where(good, self.sigma - goal, self.gone)
            self.path = np.where(good[:, None], arrived, self.path)
            goal = np.where(good, goal, self.sigma)
        passed = (self.sigma > _NEAR) & (goal <= _NEAR)
        if passed.any():
            self.near[self.lane[passed]] = self.path[0][passed]
        self.sigma = goal
        self._leave()

    def _leave(self) -> None:
        arrived = self.sigma == 0.0
        # a step too small for its place on the path leads nowhere
        stuck = ~arrived & (self.step < 1e-7 * self.sigma)
        singular = ~arrived & ((self.sigma < _END) | (stuck & (self.sigma < _STUCK)))
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
