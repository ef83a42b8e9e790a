"""A mechanism with improved numbers, and the evidence for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from linkwork.design.improvement.motion_bounds import MotionBounds
from linkwork.foundation.internal import internal
from linkwork.mechanism.description import Description
from linkwork.results.motion import Motion

__all__ = ["ImprovedDesign"]


@internal("description", "motion", "whole_motion")
@dataclass(frozen=True, kw_only=True, eq=False)
class ImprovedDesign:
    """A mechanism with improved numbers.

    Parameters
    ----------
    description : Description
        With its new numbers.
    numbers : Mapping[str, float]
        Those that varied [file units].
    total : float
        The weighted sum of squares of all misses.
    largest : float
        The largest weighted miss, broken bounds aside.
    rms : float
        The root mean square of the distances from the points; 0 without points [length].
    sound : bool
        Whether all rows of its table are proved to be on one branch, which does not end between
        them, and goals are within their bounds.
    message : str
        Why it is not sound, and how the search ended.
    inputs : tuple of float
        The leading inputs at the points; none without points [file units].
    misses : tuple of float
        The distances from the points, on the branch of the table; NaN where this has no position.
    goals : Mapping[str, float]
        The root mean square of the misses of each goal that is no bound, by quantity or point,
        without its weight [file units].
    broken : tuple of str
        The bounds of goals that it breaks, in words.
    near_dead : str
        That it all but reaches a dead point, in words; else empty.
    unmoved : str
        Why it is the mechanism as it was, whose goals are missed; else empty.
    motion : Motion, optional
        Its table with the proofs; ``None`` if it has no position.
    whole_motion : MotionBounds, optional
        The motion between the rows too; ``None`` if that is not proved.

    Examples
    --------
    >>> import linkwork as lw
    >>> goal = {"of": "rocker", "at": [0, 90, 180], "values": [60, 80, 100]}
    >>> best = lw.example("four-bar").improve(goal, vary=["A B", "O4 B"], starts=4)[0]
    >>> sorted(best.numbers), best.sound
    (['A B', 'O4 B'], True)
    """

    description: Description
    numbers: Mapping[str, float]
    total: float
    largest: float
    rms: float
    sound: bool
    message: str
    inputs: tuple[float, ...] = ()
    misses: tuple[float, ...] = ()
    goals: Mapping[str, float] = field(default_factory=dict)
    broken: tuple[str, ...] = ()
    near_dead: str = ""
    unmoved: str = ""
    motion: Motion | None = None
    whole_motion: MotionBounds | None = None

    def __repr__(self) -> str:
        return f"<ImprovedDesign: total {self.total:.4g}, {self.message}>"
