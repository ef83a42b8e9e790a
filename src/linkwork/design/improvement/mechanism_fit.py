"""The numbers of any mechanism that meet goals best, from many starts in lanes on all cores."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from linkwork.design.improvement.fit_problem import FitProblem, FittedNumbers, Fitting
from linkwork.design.improvement.goals import PathGoal
from linkwork.design.improvement.largest_miss import POWERS
from linkwork.design.improvement.moved_goals import check_moved
from linkwork.design.improvement.solved_lanes import SolvedLanes, inputs_away
from linkwork.design.improvement.written_designs import DesignWriter
from linkwork.foundation.arrays import Array
from linkwork.mechanism.varied_number import VariedNumber
from linkwork.motion.model import Model
from linkwork.results.motion import Motion

__all__ = ["fit_numbers", "misses_before", "path_misses"]

_STEPS = (60, 200, 200)  # of all lanes, then of the better half
_BOUND_STEPS = (60,) * 7  # the same; after each the shifts of bounds change
_POWER_STEPS = 60
_CORRECTIONS, _CORRECTION_STEPS = 14, 20
_ALL = 64  # so few lanes all go on, and are left of an interrupted fit


def fit_numbers(
    given: Fitting,
    starts: Array,
    *,
    minimax: bool = False,
    progress: Callable[[float], None] | None = None,
) -> FittedNumbers:
    """Improve starts (D, P).

    ``minimax``: the largest miss counts, instead of the sum of squares.

    Raises
    ------
    UnknownNameError, InputError
        For goals that are not known, or whose derivatives are not known.
    """
    problem = FitProblem(given, len(starts))
    rounds = [(1, steps) for steps in (_BOUND_STEPS if problem.has_bounds else _STEPS)]
    rounds += [(power, _POWER_STEPS) for power in (POWERS if minimax else ())]
    problem.work.tell, problem.work.whole = progress, sum(steps for _, steps in rounds)
    fit = problem.begun(starts)
    for k, (power, steps) in enumerate(rounds):
        problem.power = power
        # sums of other powers and shifts say nothing of this round
        changed = power > 1 or problem.has_bounds
        left = np.flatnonzero(np.isfinite(fit.total) if k and changed else ~fit.done | (k == 0))
        # of many lanes only the better half goes on
        most = len(starts) if len(starts) <= _ALL or not k else len(starts) // 2
        keep = left[np.argsort(fit.total[left], kind="stable")[:most]]
        if not len(keep):
            continue
        fit = problem.further(fit, keep, steps)
        if fit.interrupted:
            break
        check_moved(problem)
    left = np.arange(len(starts))
    for _ in range(0 if fit.interrupted else _CORRECTIONS):
        try:
            left = problem.correct(fit, left)
        except KeyboardInterrupt:
            fit = replace(fit, interrupted=True)
        if not len(left) or fit.interrupted:
            break
        fit = problem.further(fit, left, _CORRECTION_STEPS)
    return problem.result(fit, _ALL if fit.interrupted else None)


def path_misses(
    model: Model, motion: Motion, numbers: Sequence[VariedNumber], path: PathGoal, x: Array
) -> Array:
    """The distances of one mechanism from timed points, (N,), reached from the nearest rows of its
    motion; NaN where it has no position on their branch.
    """
    away = inputs_away(path.inputs, motion, model)
    writer = DesignWriter(model, numbers)
    solved = SolvedLanes(writer, x, motion.q[away.argmin(axis=1)], path.inputs, 1)
    found = solved.at(writer.written(x[None]), path.inputs[None], np.zeros(1, dtype=int))
    place = found.rows.place(path.point).v
    value = found.values([place.real, place.imag])[0][0]
    return np.asarray(np.abs(value[:, 0] + 1j * value[:, 1] - path.places))


def misses_before(given: Fitting, *, minimax: bool) -> float:
    """What a fit makes small, of the mechanism as it is; infinite if it breaks a bound."""
    problem = FitProblem(given, 1)
    now = problem.result(problem.reached(problem.begun(problem.x[None]), np.arange(1)))
    kept = now.broken[0] == 0.0 and not now.beyond.any()
    return float((now.largest if minimax else now.total)[0]) if kept else np.inf
