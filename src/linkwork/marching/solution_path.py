"""The step control of a homotopy's solution paths.

Compiled code calls these functions with numbers, NumPy with arrays of them. The predictor is the
cubic through the last two points and slopes, the corrector two steps of Newton's method; the first
correction measures the predictor's error and sets the next step (Allgower & Georg, Numerical
Continuation Methods, ch. 6).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

__all__ = [
    "ARRIVED",
    "BOLD",
    "CAREFUL",
    "FIRST_STEP",
    "LOST",
    "NEAR",
    "SINGULAR",
    "SMALLEST_CHANGE",
    "PathOptions",
    "cubic_weights",
    "is_good",
    "is_singular",
    "step_factor",
]

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
