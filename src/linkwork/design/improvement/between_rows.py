"""Extremes of a quantity between the rows of a regular table, on the quartic through five rows."""

from __future__ import annotations

import math

import numpy as np

from linkwork.foundation.arrays import Array, BoolArray
from linkwork.foundation.rounding import EQUAL_ROWS

__all__ = ["BetweenRows"]

_SAFE = 1.5  # fifth differences are known at some rows only
_NEWTON = 3  # steps to an extreme of the quartic from that of the parabola
# from five neighbouring values to the coefficients of their quartic
_QUARTIC = np.linalg.inv(np.vander(np.arange(-2.0, 3.0), increasing=True))
_FIFTH = np.array([-1.0, 5.0, -10.0, 10.0, -5.0, 1.0])


class BetweenRows:
    """Where a quantity is least or greatest half-way to the rows next to each.

    Parameters
    ----------
    at : (R,)
        Inputs of the rows.
    """

    def __init__(self, at: Array) -> None:
        count, steps = len(at), np.diff(at)
        #: Whether five rows or more are equally far apart.
        self.is_regular = count >= len(_QUARTIC) and bool(
            np.ptp(steps) <= EQUAL_ROWS * max(np.abs(at).max(), np.abs(steps).max())
        )
        row = np.arange(count)
        middle = np.clip(row, 2, count - 3)
        self._window = middle[:, None] + np.arange(-2, 3)
        place = (row - middle).astype(float)
        self._low = place - 0.5 * (row > 0)
        self._high = place + 0.5 * (row < count - 1)

    def extremes(self, value: Array, by_x: Array, greatest: BoolArray) -> tuple[Array, Array]:
        """The least or greatest values (D, R) with the derivatives by P numbers, (D, R, P).

        ``value``, ``by_x``: those of the rows. What the quartic may miss makes values more extreme.
        """
        near = value[:, self._window]
        sign = np.where(greatest, -1.0, 1.0)
        with np.errstate(all="ignore"):
            t = self._places(sign[:, :, None] * (near @ _QUARTIC.T))
            weights = t[:, :, None] ** np.arange(5) @ _QUARTIC
            found = (weights * near).sum(axis=2) - sign * self._missed(value, t)
        slopes = np.einsum("drk,drkp->drp", weights, by_x[:, self._window])
        return found, slopes

    def _places(self, c: Array) -> Array:
        """Where quartics with coefficients (D, R, 5) are least, in steps from their middle row."""
        ends = [np.broadcast_to(end, c.shape[:2]) for end in (self._low, self._high)]
        t = np.clip(-0.5 * c[:, :, 1] / c[:, :, 2], *ends)
        for _ in range(_NEWTON):
            slope = c[:, :, 1] + t * (2 * c[:, :, 2] + t * (3 * c[:, :, 3] + t * 4 * c[:, :, 4]))
            bend = 2 * c[:, :, 2] + t * (6 * c[:, :, 3] + t * 12 * c[:, :, 4])
            t = np.clip(t - slope / bend, *ends)
        tried = np.stack([*ends, np.where(np.isfinite(t), t, ends[0])])
        heights = ((tried[..., None] ** np.arange(5)) * c).sum(axis=-1)
        best = np.nan_to_num(heights, nan=np.inf).argmin(axis=0)
        return np.asarray(np.take_along_axis(tried, best[None], axis=0)[0])

    def _missed(self, value: Array, t: Array) -> Array:
        """What quartics miss, from the fifth differences next to a row, (D, R)."""
        if value.shape[1] < len(_FIFTH):
            return np.zeros_like(t)
        windows = np.lib.stride_tricks.sliding_window_view(value, len(_FIFTH), axis=1)
        differences = np.abs(windows @ _FIFTH)
        first = self._window[:, 0]
        last = differences.shape[1] - 1
        largest = np.maximum(
            differences[:, np.minimum(first, last)], differences[:, np.clip(first - 1, 0, last)]
        )
        away = np.abs(t * (t**2 - 1.0) * (t**2 - 4.0))
        return np.asarray(_SAFE * away * largest / math.factorial(5))
