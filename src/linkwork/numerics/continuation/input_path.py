"""Paths of inputs, and interpolation of positions along them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.numerics.rows import SolvedRows

__all__ = ["InputPath", "quintic"]


@dataclass(frozen=True, kw_only=True)
class InputPath:
    """Inputs as u(t) = origin + t · rate, both (p,).

    ``size``: natural size of t, one radian for an angle, a length of the mechanism for a length.
    """

    origin: Array
    rate: Array
    size: float = 1.0

    def at(self, t: float | Array) -> Array:
        """u(t), (p,) or (B, p)."""
        inputs: Array = self.origin + np.multiply.outer(np.asarray(t), self.rate)
        return inputs


def quintic(s: Array, h: Array, left: SolvedRows, right: SolvedRows) -> Array:
    """The polynomials through both ends of steps of length h (B or 1, 1), at the fractions s."""
    v0, v1 = left.v, right.v
    a1, b1 = left.first * h, right.first * h
    a2, b2 = left.second * h * h, right.second * h * h
    rise = v1 - v0
    c3 = 10 * rise - 6 * a1 - 4 * b1 - 1.5 * a2 + 0.5 * b2  # eq. (20)
    c4 = -15 * rise + 8 * a1 + 7 * b1 + 1.5 * a2 - b2
    c5 = 6 * rise - 3 * a1 - 3 * b1 - 0.5 * a2 + 0.5 * b2
    value: Array = v0 + s * (a1 + s * (0.5 * a2 + s * (c3 + s * (c4 + s * c5))))  # eq. (20)
    return value
