"""Why the curve of a circuit ends, or that it closes: sentences."""

from __future__ import annotations

from enum import Enum

__all__ = ["CircuitEnd"]


class CircuitEnd(Enum):
    """How the positions reachable without taking the mechanism apart come to an end."""

    CLOSED = "closed: the motion comes back to where it began"
    INPUT_CONSTANT = "input at rest: the mechanism moves while its input stands still"
    CHANGE_POINT = "change point: it is followed up to change points, where curves cross"
    RUNS_TO_INFINITY = "runs to infinity: a length grows without bound"
    NEVER_CLOSES = "never closes: the motion does not come back within the turns that were followed"
    SINGULAR = "stopped: it was followed only to a singular position that was not recognised"

    @property
    def story(self) -> str:
        """The sentence without the keyword."""
        return self.value.partition(": ")[2]

    @property
    def closed(self) -> bool:
        """Whether the circuit was followed as a whole."""
        return self is CircuitEnd.CLOSED
