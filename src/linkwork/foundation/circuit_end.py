"""The ways in which the curve of a circuit ends or closes, as sentences."""

from __future__ import annotations

from enum import Enum

__all__ = ["CircuitEnd"]


class CircuitEnd(Enum):
    """How the curve of a circuit ends; the value is a sentence.

    Examples
    --------
    >>> import linkwork as lw
    >>> lw.example("four-bar").circuits()[0].end.story
    'the motion returns to its start'
    """

    CLOSED = "closed: the motion returns to its start"
    INPUT_CONSTANT = "input at rest: the mechanism moves while its input is constant"
    CHANGE_POINT = "change point: the curve was followed up to change points, where curves cross"
    RUNS_TO_INFINITY = "runs to infinity: a length grows without bound"
    NEVER_CLOSES = "never closes: within the turns followed the motion does not return to its start"
    SINGULAR = "stopped: the curve was followed to a singular position of unknown kind"

    @property
    def story(self) -> str:
        """The sentence without the keyword."""
        return self.value.partition(": ")[2]

    @property
    def closed(self) -> bool:
        """Whether the circuit was followed as a whole."""
        return self is CircuitEnd.CLOSED
