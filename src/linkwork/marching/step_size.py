"""How large the next step of a march is: towards a goal, after success, after failure."""

from __future__ import annotations

import math

__all__ = ["GROWTH", "HALF", "aim", "by_error", "grow", "is_lost", "stride"]

GROWTH = 2.0  # largest factor from one step to the next
HALF = 0.5  # of a step that failed: the next attempt
_NEARLY_FULL = 0.5  # part of the allowed step: after one as long as this a larger step may succeed


def aim(goal: float, here: float, h: float) -> float:
    """Where a step of at most ``h`` from ``here`` towards ``goal`` ends: at the goal, if it can."""
    away = goal - here
    # the goal itself: here + away may be off by a rounding
    return goal if abs(away) <= h else here + math.copysign(h, away)


def stride(goal: float, here: float, h: float) -> float:
    """The step that :func:`aim` takes, with its sign."""
    away = goal - here
    return away if abs(away) <= h else math.copysign(h, away)


def is_lost(t: float, here: float, goal: float) -> bool:
    """Whether rounding leaves nothing of a step that should lead on."""
    return t == here and t != goal


def grow(h: float, moved: float, largest: float) -> float:
    """The next step's bound after a step of length ``moved`` that was taken."""
    return min(GROWTH * h, largest) if moved >= _NEARLY_FULL * h else h


def by_error(error: float, target: float, order: int) -> float:
    """The factor that brings a prediction's error, which grows like h^order, to ``target``."""
    return float((target / error) ** (1.0 / order)) if error > 0.0 else GROWTH  # eq. (22)
