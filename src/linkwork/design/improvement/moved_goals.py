"""Whether the numbers that vary change the goals of an improvement at all."""

from __future__ import annotations

import numpy as np

from linkwork.design.improvement.fit_problem import FitProblem
from linkwork.foundation.errors import MechanismError, Problem

__all__ = ["check_moved"]

_PROBES, _PROBED = 4, 0.05  # designs that are drawn in this part of the bounds


def check_moved(problem: FitProblem) -> None:
    """Refuse goals that are missed, and that no number changes at any design so far, nor at some
    that are drawn.

    Raises
    ------
    MechanismError
    """
    unmoved = _unmoved(problem)
    if unmoved:
        probe, width = FitProblem(problem.given, _PROBES), problem.box.most - problem.box.least
        draws = np.random.default_rng(0).uniform(-1.0, 1.0, (_PROBES, len(problem.x)))
        x = problem.box.inside(problem.x + _PROBED * width * draws)
        probe.reached(probe.begun(x), np.arange(_PROBES))
        unmoved &= _unmoved(probe)
    told = "changes with no number that varies, at any start: vary numbers that it depends on, or"
    found = [
        Problem(
            key=("goals", k, "of"),
            message=f'"{problem.goals[k].goal.of}" {told} leave this goal out',
        )
        for k in sorted(unmoved)
    ]
    if found:
        raise MechanismError(found, "the improvement")


def _unmoved(problem: FitProblem) -> set[int]:
    """Goals that are missed and that no number has changed; none that was nowhere known."""
    still = (problem.moved == 0.0) & (problem.missed > 0.0)
    return {int(k) for k in np.flatnonzero(still) if not problem.goals[k].is_bound}
