"""Constraints on the dimensions of curve drawers, by the method of multipliers.

A constraint h(x) ≤ 0 adds the residual max(0, h + s), eq. (155). After a round of steps its shift s
becomes max(0, h + s), so that in the end h ≤ 0 holds and not only nearly.

References
----------
M. J. D. Powell, A method for nonlinear constraints in minimization problems, in: Optimization,
Academic Press 1969, 283-298.
"""

from __future__ import annotations

import numpy as np

from linkwork.design.improvement.coupler_curves import CouplerCurves, FourBarCurves
from linkwork.design.improvement.curve_goal import CurveGoal
from linkwork.foundation.angles import FULL_TURN
from linkwork.foundation.arrays import Array, ComplexArray, IndexArray

__all__ = ["ANGLE_MARGIN", "CurveConstraints"]

#: By how much fits exceed a wanted transmission angle [rad]: between rows, and where their last
#: steps end, designs fell short of it by up to 2e-5.
ANGLE_MARGIN = 1e-4

_MARGIN = 1e-6  # sizes of the goal: by which constraints hold in the end
_DEAD = np.radians(0.25)  # the least transmission angle of all: dead points are kept off


class CurveConstraints:
    """The constraints of a goal, for lanes of mechanisms of one kind."""

    def __init__(self, kind: type[CouplerCurves], goal: CurveGoal, lanes: int) -> None:
        self.kind, self.goal = kind, goal
        self._curves = kind(np.ones(1))
        #: The weight of the residuals of constraints, which grows.
        self.weight = 1.0
        self._point_shift, self._reach_shift = np.zeros((2, lanes, len(goal.points)))
        self._shift = np.zeros(
            (lanes, self._constraints(np.ones((1, len(kind.names) + 1)))[0].shape[1])
        )

    def residuals(self, x: Array, lanes: IndexArray) -> tuple[Array, Array]:
        """How far constraints are broken, (D, K), and by the parameters, (D, K, P)."""
        h, by_x = self._constraints(x)
        h = h + self._shift[lanes]  # eq. (155)
        broken = h > 0.0
        weight = self.weight
        return np.where(broken, weight * h, 0.0), np.where(broken[:, :, None], weight * by_x, 0.0)

    def weigh(self, weight: float) -> None:
        """Change the weight; the multipliers, weight² times the shifts, stay."""
        for shift in (self._shift, self._point_shift, self._reach_shift):
            shift *= (self.weight / weight) ** 2
        self.weight = weight

    def at_points(
        self, x: Array, angles: Array, lanes: IndexArray
    ) -> tuple[Array, Array, Array] | None:
        """How far the transmission angle is too small at points, (D, N), by the dimensions and by
        the angles; ``None`` where the whole driven range is constrained.
        """
        if self.goal.must_turn or self.goal.range is not None:
            return None
        cosine, by_x, by_angle = self._curves.cosines(x, angles)
        weight = self.weight
        sign = weight * np.sign(cosine) * self.goal.size
        h = np.abs(cosine) * self.goal.size - self._most + self._point_shift[lanes]
        broken = h > 0.0
        return (
            np.where(broken, weight * h, 0.0 * h),
            np.where(broken[:, :, None], by_x * sign[:, :, None], 0.0),
            np.where(broken, by_angle * sign, 0.0),
        )

    def beyond(
        self, missed: ComplexArray, by_x: ComplexArray, by_angle: ComplexArray, lanes: IndexArray
    ) -> tuple[Array, Array, Array] | None:
        """How far points are missed beyond their tolerances, (D, N), by the dimensions and by the
        angles, from the same of P - the points; ``None`` without tolerances.
        """
        if self.goal.reach is None:
            return None
        h = self._excess(missed) + self._reach_shift[lanes]
        broken, weight = h > 0.0, self.weight
        with np.errstate(all="ignore"):
            along = np.nan_to_num(missed.conj() / np.abs(missed)) * weight
            return (
                np.where(broken, weight * h, 0.0 * h),
                np.where(broken[:, :, None], (along[:, :, None] * by_x).real, 0.0),
                np.where(broken, (along * by_angle).real, 0.0),
            )

    def _excess(self, missed: ComplexArray) -> Array:
        assert self.goal.reach is not None
        # a narrow tolerance keeps a narrow margin
        margin = np.minimum(_MARGIN * self.goal.size, _MARGIN * self.goal.reach)
        return np.asarray(np.abs(missed) - self.goal.reach + margin)

    def update(self, x: Array, angles: Array, missed: ComplexArray, lanes: IndexArray) -> None:
        """New shifts for lanes that are at x, where points are missed by P - the points (D, N)."""
        if self.goal.reach is not None:
            shift = self._excess(missed) + self._reach_shift[lanes]
            self._reach_shift[lanes] = np.maximum(0.0, np.nan_to_num(shift))
        self._shift[lanes] = np.maximum(0.0, self._constraints(x)[0] + self._shift[lanes])
        points = self.at_points(x[:, : len(self.kind.names)], angles, lanes)
        if points is not None:
            self._point_shift[lanes] = np.nan_to_num(points[0]) / self.weight

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
        found, slopes = [np.zeros((len(x), 0))], [np.zeros((len(x), 0, x.shape[1]))]
        margin = _MARGIN * goal.size

        def add(h: Array, by_x: Array) -> None:
            wide = np.zeros((*h.shape, x.shape[1]))
            wide[:, :, :count] = by_x
            found.append(h + margin)
            slopes.append(wide)

        own = x[:, :count]
        if goal.must_turn:
            add(*self._curves.limits(own))
            add(*self._transmission(own))
        if goal.limited_range is not None:
            add(*self._transmission_in(own, *goal.limited_range))
        lengths, by_x = self._lengths(own)
        if goal.shortest > 0.0:
            add(goal.shortest - lengths, -by_x)
        if np.isfinite(goal.longest):
            add(lengths - goal.longest, by_x)
            arms, arms_by_x = self._arms(own)
            add(arms - goal.longest, arms_by_x)
        if np.isfinite(goal.ratio):
            rows = np.arange(len(x))
            longest, shortest = lengths.argmax(axis=1), lengths.argmin(axis=1)
            h = lengths[rows, longest] - goal.ratio * lengths[rows, shortest]
            slope = by_x[rows, longest] - goal.ratio * by_x[rows, shortest]
            add(h[:, None], slope[:, None])
        return np.concatenate(found, axis=1), np.concatenate(slopes, axis=1)

    def _lengths(self, x: Array) -> tuple[Array, Array]:
        """The lengths of links, of a four-bar the ground too, (D, L), and by x."""
        index = list(self.kind.lengths)
        lengths, by_x = x[:, index], np.zeros((len(x), len(index), x.shape[1]))
        by_x[:, np.arange(len(index)), index] = 1.0
        if self.kind is not FourBarCurves:
            return lengths, by_x
        ground = x[:, 2:4] - x[:, :2]
        length = np.hypot(ground[:, 0], ground[:, 1])
        slope = np.zeros((len(x), 1, x.shape[1]))
        with np.errstate(all="ignore"):
            along = np.nan_to_num(ground / length[:, None])
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
            found, by_x = self._curves.limits(x)
            by_x[:, :, 3] *= cosine
            return found + (1.0 - cosine) * x[:, 3, None], by_x
        ground = x[:, 2:4] - x[:, :2]
        g = np.hypot(ground[:, 0], ground[:, 1])
        a, c, b = x[:, 4], x[:, 5], x[:, 6]
        both, slopes = [], []
        with np.errstate(all="ignore"):
            along = np.nan_to_num(ground / g[:, None])
        for sense in (1.0, -1.0):
            d = g + sense * a
            inner = b**2 + c**2 - d**2
            sign, size = np.sign(inner), b + c
            h = (np.abs(inner) - 2.0 * b * c * cosine) / size
            slope = np.zeros((len(x), x.shape[1]))
            by_d = -2.0 * sign * d / size
            slope[:, :2], slope[:, 2:4] = -by_d[:, None] * along, by_d[:, None] * along
            slope[:, 4] = sense * by_d
            slope[:, 5] = (2.0 * sign * c - 2.0 * b * cosine - h) / size
            slope[:, 6] = (2.0 * sign * b - 2.0 * c * cosine - h) / size
            both.append(h)
            slopes.append(slope)
        return np.stack(both, axis=1), np.stack(slopes, axis=1)
