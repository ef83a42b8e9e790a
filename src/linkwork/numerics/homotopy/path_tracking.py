"""Following many solution paths of a homotopy at once, each with its own step.

H(w, σ) = 0 is followed from σ = 1, where every solution is known, to σ = 0. The control of steps is
:mod:`linkwork.marching.solution_path`, which compiled code shares (``linkwork.kernels.paths``). A
path that cannot jump to σ = 0 in one step approaches it in ever smaller ones and ends as singular;
unknowns on projective patches keep a path to infinity bounded.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray, ComplexArray, IndexArray, StatusArray
from linkwork.foundation.stacked_systems import solutions
from linkwork.marching.solution_path import (
    ARRIVED,
    FIRST_STEP,
    LOST,
    NEAR,
    SINGULAR,
    SMALLEST_CHANGE,
    PathOptions,
    cubic_weights,
    is_good,
    is_singular,
    step_factor,
)
from linkwork.marching.step_size import HALF

__all__ = ["Homotopy", "Paths", "relative_size", "track"]


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
