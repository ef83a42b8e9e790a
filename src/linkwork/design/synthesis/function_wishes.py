"""Wishes of a task of functions as constraints on the lanes of its fits, eq. (155)."""

from __future__ import annotations

import numpy as np

from linkwork.design.improvement.coupler_curves import FourBarCurves, SliderCrankCurves
from linkwork.design.improvement.curve_constraints import CurveConstraints
from linkwork.design.improvement.curve_goal import CurveGoal
from linkwork.design.tasks.wishes import Wishes
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, IndexArray

__all__ = ["FunctionWishes"]

_MARGIN = 1e-4  # of lengths, relatively: what multipliers leave


class FunctionWishes:
    """The constraints of D lanes, which have crank, rocker or offset, coupler, and both starts.

    ``u`` (N,): inputs [rad]; ``size``: of lengths, 1 with a four-bar's ground; ``weights``: those
    of rounds, none without wishes.
    """

    def __init__(self, wishes: Wishes, u: Array, size: float, slides: bool, lanes: int) -> None:
        asked = wishes.range
        #: The driven range, unless it is that of the inputs, and moves with their start.
        self.range = None if asked is None or asked.turn else (asked.start, asked.stop)
        self.ends = sorted(self.range or (float(u.min()), float(u.max())))
        self.kind = SliderCrankCurves if slides else FourBarCurves
        self.columns = [2, 4, 3] if slides else [4, 6, 5]
        goal = CurveGoal(
            points=np.array([0.0, 2.0 * size], dtype=complex),
            closed=False,
            turns_fully=asked is not None and asked.turn,
            transmission=wishes.transmission,
            shortest=wishes.shortest * (1.0 + _MARGIN),
            longest=wishes.longest * (1.0 - _MARGIN),
            ratio=wishes.ratio * (1.0 - _MARGIN),
        )
        self.constraints = CurveConstraints(self.kind, goal, lanes)
        wanted = asked or goal.transmission or goal.shortest
        wanted = wanted or min(goal.longest, goal.ratio) < np.inf
        self.weights = (10.0, 30.0, 30.0, 100.0, 100.0) if wanted else ()

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
        """How far wishes are broken, (D, K), and by the parameters, (D, K, 5)."""
        if not self.weights:
            return np.zeros((len(x), 0)), np.zeros((len(x), 0, 5))
        loops, signs, angles = self._loops(x)
        h, slope = self.constraints.residuals(loops, lanes)
        by_start = np.zeros_like(h)
        found = self.constraints.at_points(loops, angles, lanes)
        if found is not None:
            h, slope = np.append(h, found[0], axis=1), np.append(slope, found[1], axis=1)
            by_start = np.append(by_start, 0.0 * found[2] if self.range else found[2], axis=1)
        by_x = slope[:, :, self.columns] * signs[:, None]
        return h, np.concatenate([by_x, by_start[:, :, None], 0.0 * h[:, :, None]], axis=2)

    def update(self, x: Array, weight: float) -> None:
        """New multipliers for all lanes at x, and the next weight."""
        loops, _, angles = self._loops(x)
        self.constraints.update(loops, angles, np.zeros(2, dtype=complex), np.arange(len(x)))
        self.constraints.weigh(weight)
