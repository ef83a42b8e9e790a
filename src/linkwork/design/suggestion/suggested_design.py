"""A design for a task that its search has not found, judged by the wishes of the task."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from typing import Protocol

import numpy as np

from linkwork.design.improvement.improved_design import ImprovedDesign
from linkwork.design.synthesis.improved_mechanism import ImprovedMechanism
from linkwork.design.tasks.task import Task
from linkwork.design.tasks.task_conditions import Point
from linkwork.design.tasks.wishes import Wishes, distances_to_segments
from linkwork.mechanism.description import Description

__all__ = ["Origin", "SuggestedDesign", "Suggesting"]


class Origin(Enum):
    """Where a design comes from."""

    GIVEN = "as given"
    ATLAS = "atlas"
    IMPROVED = "improved"


@dataclass(frozen=True, kw_only=True, eq=False)
class SuggestedDesign:
    """A mechanism of any kind with its motion.

    Parameters
    ----------
    origin : Origin
    mechanism : str
        Its kind in words.
    improved : ImprovedDesign
    point : str
        The point that passes the positions; "" if there are none.
    positions : tuple of (float, float)
        Where its inputs and misses are measured; others of a task are compared with its path.
    """

    origin: Origin
    mechanism: str
    improved: ImprovedDesign
    point: str
    positions: tuple[Point, ...]

    def judged(self, task: Task, wishes: Wishes) -> ImprovedMechanism:
        """The design with its defects. The order of positions is judged only where the inputs at
        them are known.
        """
        own, points = self.improved, tuple(position.point for position in task.positions)
        if points != self.positions:
            own = replace(own, inputs=(), misses=self._misses(points))
        return ImprovedMechanism(task=task, improved=own, wishes=wishes)

    def _misses(self, points: tuple[Point, ...]) -> tuple[float, ...]:
        """The distances of points from the path; NaN without a path."""
        motion = self.improved.motion
        if motion is None or not self.point:
            return tuple(float("nan") for _ in points)
        path = motion.trace(self.point)
        steps = motion.found[:-1] & motion.found[1:]
        one, other = path[:-1][steps], path[1:][steps]
        return tuple(
            float(distances_to_segments(np.array(complex(*p)), one, other).min(initial=np.inf))
            for p in points
        )


class Suggesting(Protocol):
    """What finds such designs; ``progress`` may raise an error to end the work."""

    def wishes(self, task: Task) -> Wishes:
        """The wishes of a task."""

    def given(self, task: Task) -> SuggestedDesign | None:
        """The mechanism that a task improves; ``None`` for other tasks."""

    def nearest(
        self, task: Task, count: int, progress: Callable[[float], None]
    ) -> tuple[SuggestedDesign, ...]:
        """The designs of the atlas whose paths are nearest to the positions."""

    def improved(
        self,
        task: Task,
        description: Description,
        mechanism: str,
        progress: Callable[[float], None],
    ) -> SuggestedDesign:
        """A better design; at an interruption the best so far."""
