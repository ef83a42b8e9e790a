"""Why the curve of a circuit ends, or that it closes: sentences."""

from __future__ import annotations

from enum import Enum

__all__ = ["CircuitEnd"]


class CircuitEnd(Enum):
    """How the positions reachable without taking the mechanism apart come to an end."""

    CLOSED = "closed: the motion comes back to where it began"
    CHANGE_POINT = "ends at change points, where other positions branch off"
    RUNS_TO_INFINITY = "a length grows without bound"
    NEVER_CLOSES = "the motion does not come back within the turns that were followed"
    INPUT_CONSTANT = "the mechanism moves while its input stands still"
    SINGULAR = "followed only to a singular position that was not recognised"

    @property
    def closed(self) -> bool:
        """Whether the circuit was followed as a whole."""
        return self is CircuitEnd.CLOSED
