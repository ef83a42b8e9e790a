"""Newton-Raphson for many starts at once, with the two tolerances of the textbook."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from linkwork.foundation.status import Status
from linkwork.numerics.system import Array, System

__all__ = ["NewtonOptions", "NewtonResult", "newton"]

_CONVERGED = Status.CONVERGED.code
_RUNNING = -1
_FAR = 1e9  # weighted size of an unknown beyond which the iteration has run away


@dataclass(frozen=True, kw_only=True)
class NewtonOptions:
    """When to stop, and how far one step may go.

    Parameters
    ----------
    equation_tolerance : float
        ε_e: stop when every scaled residual is at most this.
    solution_tolerance : float
        ε_s: stop when every weighted change is at most this.
    max_steps : int
        m: stop without a solution after so many steps.
    largest_turn : float
        A step that would turn an angle further [rad] is shortened as a whole; ``inf`` gives the
        textbook's bare method.
    """

    equation_tolerance: float = 1e-14
    solution_tolerance: float = 1e-11
    max_steps: int = 50
    largest_turn: float = math.radians(40.0)


@dataclass(frozen=True, kw_only=True)
class NewtonResult:
    """The end of every iteration; arrays over B starts.

    ``v`` (B, N); ``status`` codes; ``iterations``; ``residual`` scaled, largest row;
    ``first_step`` weighted size of the first correction; ``contraction`` largest ratio of
    successive corrections that were above rounding.
    """

    v: Array
    status: npt.NDArray[np.int8]
    iterations: npt.NDArray[np.int64]
    residual: Array
    first_step: Array
    contraction: Array


Watch = Callable[[int, Array, Array, Array | None], None]


def newton(
    system: System,
    start: Array,
    options: NewtonOptions | None = None,
    watch: Watch | None = None,
) -> NewtonResult:
    """Solve F(v) = 0 for the first n variables from every row of ``start``.

    Parameters
    ----------
    system : System
    start : (B, N)
        Guesses of the unknowns with the inputs behind.
    options : NewtonOptions
    watch : callable, optional
        Called as ``watch(k, v, residual, change)`` at every iterate, for showing a single start.

    Returns
    -------
    NewtonResult
        The loop's exit is the status.

    Notes
    -----
    Quadratic at regular solutions. Rows that are done leave the batch.
    """
    opt = options or NewtonOptions()
    count, n = len(start), system.unknowns
    v = start.copy()
    status = np.full(count, _RUNNING, dtype=np.int8)
    iterations = np.zeros(count, dtype=np.int64)
    residual = np.full(count, np.inf)
    first = np.zeros(count)
    contraction = np.zeros(count)
    last = np.full(count, np.inf)  # weighted size of the latest correction
    live = np.arange(count)
    weights, scale = system.variable_scale[:n], system.equation_scale
    turns = system.turns[:n]
    for k in range(opt.max_steps + 1):
        here = v[live] if len(live) < count else v
        with np.errstate(all="ignore"):
            f, jacobian = system.residual_and_jacobian(here)
        error = np.abs(f / scale).max(axis=1, initial=0.0)
        residual[live] = error
        bad = ~np.isfinite(error) | (np.abs(here[:, :n] / weights).max(axis=1, initial=0.0) > _FAR)
        done = (error <= opt.equation_tolerance) | (last[live] <= opt.solution_tolerance)
        if bad.any() or done.any() or k == opt.max_steps:
            status[live[done]] = _CONVERGED
            status[live[bad]] = Status.DIVERGED.code
            stay = ~(bad | done)
            if k == opt.max_steps:
                status[live[stay]] = Status.STEP_LIMIT.code
                stay[:] = False
            if watch is not None and not stay[0]:
                watch(k, here, f, None)
            if not stay.any():
                break
            live, here, f, jacobian = live[stay], here[stay], f[stay], jacobian[stay]
        change, singular = _corrections(jacobian[:, :, :n], f)
        if singular.any():
            status[live[singular]] = Status.SINGULAR_JACOBIAN.code
            if watch is not None:
                watch(k, here, f, None)
            keep = ~singular
            live, here, f, change = live[keep], here[keep], f[keep], change[keep]
            if not len(live):
                break
        change = _shortened(change, turns, opt.largest_turn)
        if watch is not None:
            watch(k, here, f, change)
        v[live, :n] += change
        iterations[live] += 1
        size = np.abs(change / weights).max(axis=1, initial=0.0)
        if k == 0:
            first[live] = size
        else:
            ratio = np.where(size > 1e-9, size / last[live], 0.0)
            contraction[live] = np.maximum(contraction[live], ratio)
        last[live] = size
    return NewtonResult(
        v=v,
        status=status,
        iterations=iterations,
        residual=residual,
        first_step=first,
        contraction=contraction,
    )


def _corrections(jacobian: Array, f: Array) -> tuple[Array, npt.NDArray[np.bool_]]:
    """-J⁻¹F per lane, and the lanes where J is singular to rounding."""
    try:
        change = -np.linalg.solve(jacobian, f[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:
        change = np.full_like(f, np.nan)
        for lane in range(len(f)):
            try:
                change[lane] = -np.linalg.solve(jacobian[lane], f[lane])
            except np.linalg.LinAlgError:
                continue
    return change, ~np.isfinite(change).all(axis=1)


def _shortened(change: Array, turns: npt.NDArray[np.bool_], largest: float) -> Array:
    """Corrections scaled down so that no angle turns further than allowed."""
    if not turns.any() or math.isinf(largest):
        return change
    turn = np.abs(change[:, turns]).max(axis=1)
    if not (turn > largest).any():
        return change
    return change * np.minimum(1.0, largest / np.maximum(turn, 1e-300))[:, None]
