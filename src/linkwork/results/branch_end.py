"""Whether a branch ends in the table of a motion, be it between two rows."""

from __future__ import annotations

from linkwork.foundation.rounding import EQUAL_ROWS
from linkwork.results.limit import Limit
from linkwork.results.motion import Motion

__all__ = ["branch_end", "is_in_table"]


def branch_end(motion: Motion) -> Limit | None:
    """The first limit in the table at which the branch ends.

    Without a lost row it is between two rows: those behind it belong to the same branch, and were
    reached from its other end.
    """
    ends = (limit for limit in motion.limits if not limit.passed)
    return next((limit for limit in ends if is_in_table(limit, motion)), None)


def is_in_table(limit: Limit, motion: Motion) -> bool:
    """Whether a row is lost, or a limit is at an input between the first row and the last."""
    lead = next(iter(motion.inputs))
    values, turn = motion.inputs[lead], motion.units.angle.turn
    if not len(values) or not motion.found.all():
        return True
    low, high = float(values.min()), float(values.max())
    # rounding may leave a limit at an end of the table just beyond it
    slack = EQUAL_ROWS * max(abs(low), abs(high))
    if motion.input_units[lead] != motion.units.angle.value:
        return low - slack <= limit.input <= high + slack
    away = (limit.input - low) % turn
    return bool(away <= high - low + slack or away > turn - slack)
