"""The size of the next step of a march: towards a goal, after a success, after a failure."""

from __future__ import annotations

import math

__all__ = ["GROWTH", "HALF", "NEARLY_FULL", "aim", "by_error", "grow", "is_lost", "stride"]

GROWTH = 2.0  # largest factor from one step to the next
HALF = 0.5  # the next attempt after a step that failed, as a part of it
# A step often ends early, at a row of the table, and then tests only a part of its bound. The bound
# grows where that part is half or more: it is then at most 4 (GROWTH / 0.5) times a step that
# succeeded, while rows just short of the bound do not keep it from growing.
NEARLY_FULL = 0.5


def aim(goal: float, here: float, h: float) -> float:
    """The end of a step of at most ``h`` from ``here`` towards ``goal``."""
    away = goal - here
    # the goal itself: here + away may be off by a rounding
    return goal if abs(away) <= h else here + math.copysign(h, away)


def stride(goal: float, here: float, h: float) -> float:
    """The length of the step to :func:`aim`, with its sign."""
    away = goal - here
    return away if abs(away) <= h else math.copysign(h, away)


def is_lost(t: float, here: float, goal: float) -> bool:
    """Whether a step is lost to rounding: it ends where it began, before the goal."""
    return t == here and t != goal


def grow(h: float, moved: float, largest: float) -> float:
    """The bound of the next step after a successful step of length ``moved``."""
    return min(GROWTH * h, largest) if moved >= NEARLY_FULL * h else h


def by_error(error: float, target: float, order: int) -> float:
    """The factor that brings a prediction's error, which grows like h^order, to ``target``."""
    return float((target / error) ** (1.0 / order)) if error > 0.0 else GROWTH  # eq. (22)
