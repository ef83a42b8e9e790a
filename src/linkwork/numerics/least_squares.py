"""The nearest miss: where a system that may have no solution comes closest to one.

Levenberg-Marquardt (Marquardt 1963, doi:10.1137/0111030) on scaled residuals and variables. Where
much is missing, its model JᵀJ of the curvature is too poor for more than slow progress; the last
stretch then uses Newton's method with all of the curvature, JᵀJ + Σ r_k ∇²r_k.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.numerics.system import System

__all__ = ["nearest_miss"]

_MOST_UNKNOWNS = 40  # of a system whose whole curvature is formed
_NEWTON_STEPS = 30
_CLOSED = 1e-20  # sum of squares of a position: there is nothing to refine


def nearest_miss(system: System, start: Array, steps: int = 200) -> tuple[Array, Array]:
    """Minimise the sum of squares of the scaled residuals from one start.

    Parameters
    ----------
    start : (N,)
        Guess of the unknowns followed by the inputs.

    Returns
    -------
    v, f : (N,), (m,)
        The minimiser found and the unscaled residuals there.
    """
    n = system.unknowns
    v = start[None, :].copy()
    scale, weights = system.equation_scale, system.variable_scale[:n]
    damping = 1e-3
    f, jacobian = system.residual_and_jacobian(v)
    r = f[0] / scale
    for _ in range(steps):
        j = jacobian[0, :, :n] * weights / scale[:, None]
        gradient = j.T @ r
        if not np.isfinite(gradient).all() or np.abs(gradient).max(initial=0.0) < 1e-15:
            break
        normal = j.T @ j
        try:
            change = -np.linalg.solve(normal + damping * np.eye(n), gradient)  # eq. (9)
        except np.linalg.LinAlgError:  # so little damping is lost to rounding
            damping *= 5.0
            continue
        trial = v.copy()
        trial[0, :n] += change * weights
        f_trial, j_trial = system.residual_and_jacobian(trial)
        r_trial = f_trial[0] / scale
        if np.isfinite(r_trial).all() and r_trial @ r_trial < r @ r:
            v, f, jacobian, r = trial, f_trial, j_trial, r_trial
            # a good step is followed by one nearer to Newton, a bad one by one nearer to the
            # gradient
            damping = max(damping * 0.2, 1e-15)
            if np.abs(change).max() < 1e-14:
                break
        else:
            damping *= 5.0
            if damping > 1e12:
                break
    if n <= _MOST_UNKNOWNS and np.isfinite(r).all() and r @ r > _CLOSED:
        v, f = _refine_minimum(system, v, f)
    return v[0], f[0]


def _refine_minimum(system: System, v: Array, f: Array) -> tuple[Array, Array]:
    """Newton's method for the minimum near v (1, N); stops where it would lead uphill."""
    n = system.unknowns
    scale, weights = system.equation_scale, system.variable_scale[:n]
    for _ in range(_NEWTON_STEPS):
        r = f[0] / scale
        j = system.jacobian(v)[0, :, :n] * weights / scale[:, None]
        gradient = j.T @ r
        bends = system.hessians(v[0], (r / scale)[None, :])[0, :n, :n]
        hessian = j.T @ j + weights[:, None] * bends * weights  # eq. (10)
        try:
            # only a positive definite Hessian leads downhill, and then to a minimum
            np.linalg.cholesky(hessian)
            change = -np.linalg.solve(hessian, gradient)
        except np.linalg.LinAlgError:
            break
        trial = v.copy()
        trial[0, :n] += change * weights
        f_trial = system.residual(trial)
        r_trial = f_trial[0] / scale
        if not (np.isfinite(r_trial).all() and r_trial @ r_trial < r @ r):
            break
        v, f = trial, f_trial
        if np.abs(change).max() < 1e-14:
            break
    return v, f
