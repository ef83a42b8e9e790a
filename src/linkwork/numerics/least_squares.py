"""The nearest miss: where a system that may have no solution comes closest to one.

Levenberg-Marquardt (Marquardt 1963, doi:10.1137/0111030) on scaled residuals and variables.
"""

from __future__ import annotations

import numpy as np

from linkwork.foundation.arrays import Array
from linkwork.numerics.system import System

__all__ = ["nearest_miss"]


def nearest_miss(system: System, start: Array, steps: int = 200) -> tuple[Array, Array]:
    """Minimise the sum of squares of the scaled residuals from one start.

    Parameters
    ----------
    start : (N,)
        Guess of the unknowns with the inputs behind.

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
        change = -np.linalg.solve(normal + damping * np.eye(n), gradient)
        trial = v.copy()
        trial[0, :n] += change * weights
        f_trial, j_trial = system.residual_and_jacobian(trial)
        r_trial = f_trial[0] / scale
        if np.isfinite(r_trial).all() and r_trial @ r_trial < r @ r:
            v, f, jacobian, r = trial, f_trial, j_trial, r_trial
            damping = max(damping * 0.2, 1e-15)
            if np.abs(change).max() < 1e-14:
                break
        else:
            damping *= 5.0
            if damping > 1e12:
                break
    return v[0], f[0]
