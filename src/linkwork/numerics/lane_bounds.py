"""Bounds of the parameters and of the own variables of a fit of lanes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray

__all__ = ["Box", "OwnVariables"]


@dataclass(frozen=True, kw_only=True, eq=False)
class Box:
    """Bounds of the parameters.

    Parameters
    ----------
    least, most : (P,)
    least_effect : float
        Parameters that change residuals less than this part of the largest change, each over its
        whole range, are damped as if they changed them so much.
    """

    least: Array
    most: Array
    least_effect: float = 0.0

    def inside(self, x: Array) -> Array:
        """The nearest parameters in the box."""
        return np.asarray(np.clip(x, self.least, self.most))

    def least_scale(self, scale: Array) -> Array:
        """What is added to the squares of effects (D, P) that damp parameters."""
        square = (self.most - self.least) ** 2
        ranged = np.isfinite(square) & (square > 0.0)
        most = np.where(ranged, scale * square, 0.0).max(axis=1, keepdims=True, initial=0.0)
        return np.where(ranged, self.least_effect**2 * most / square, 0.0)


@dataclass(frozen=True, kw_only=True)
class OwnVariables:
    """Where the own variables of rows may be: between bounds, and in order.

    Parameters
    ----------
    least, most : float
        The bounds of all of them.
    in_order : bool
        Whether they rise from row to row.
    gap, span : float
        Of variables in order: they rise by ``gap`` or more, and by less than ``span`` altogether.
    """

    least: float = -np.inf
    most: float = np.inf
    in_order: bool = False
    gap: float = 0.0
    span: float = np.inf

    def inside(self, t: Array) -> Array:
        """Variables (D, N) moved into order, each as little as those before it allow, and between
        the bounds.
        """
        low, high = self._bounds(t.shape[1])
        if self.in_order:
            steps = self.gap * np.arange(t.shape[1])
            t = np.maximum.accumulate(t - steps, axis=1) + steps
            t = np.minimum(t, t[:, :1] + self.span - steps[::-1])
        return np.asarray(np.clip(t, low, high))

    def held(self, t: Array, slope: Array) -> BoolArray:
        """Whether a row is at a bound that it would pass down the slope, (D, N)."""
        low, high = self._bounds(t.shape[1])
        return np.asarray(((t <= low) & (slope > 0.0)) | ((t >= high) & (slope < 0.0)))

    def together(self, t: Array, pull: Array) -> Array | None:
        """Which rows move as one, (D, N, N): those that touch and are pushed together."""
        if not self.in_order:
            return None
        contact = np.zeros(t.shape, dtype=bool)
        # down the slope the later row would come before the earlier one
        contact[:, 1:] = np.diff(t, axis=1) <= self.gap * (1.0 + 1e-3)
        contact[:, 1:] &= pull[:, 1:] >= pull[:, :-1]
        if not contact.any():
            return None
        group = np.cumsum(~contact, axis=1)
        return np.asarray((group[:, :, None] == group[:, None, :]).astype(float))

    def _bounds(self, count: int) -> tuple[Array, Array]:
        """Bounds of each row, which leave room for those before and after it."""
        steps = self.gap * np.arange(count)
        return np.asarray(self.least + steps), np.asarray(self.most - steps[::-1])
