"""The designs that were suggested for a task: of the atlas, improved, or its starting design."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise

from linkwork.app.live.opened_file import Events
from linkwork.app.live.task_events import DesignFound, DesignShown, DesignsSuggested
from linkwork.app.task.designs import design_shown, mechanism_found
from linkwork.core.foundation.errors import InputError, LinkworkError
from linkwork.core.mechanism.description import Description
from linkwork.synthesis.solvers.swept_design import SweptDesign
from linkwork.synthesis.suggestion.suggesting import Origin, SuggestedDesign, Suggesting
from linkwork.synthesis.tasks.task import Task

FIRST = -2  # the index of the first suggested design; further ones are below
_CLOSES = 2.0  # largest steps: how near the ends of a closed curve are
_OPEN = "The positions are no closed curve: paths are compared as if a straight line closed it."
_SHAPE = "Paths of the atlas are compared by shape; timing and order of positions are not."


class Suggestions:
    """Suggested designs, judged again by each task.

    Parameters
    ----------
    suggesting : callable
        Imports the module that makes them, at first use.

    Attributes
    ----------
    chosen : int, optional
        The index of the one that the visitor looks at.
    """

    def __init__(self, suggesting: Callable[[], Suggesting]) -> None:
        self._suggesting = suggesting
        self._designs: list[SuggestedDesign] = []
        self._judged: list[SweptDesign] = []
        self._of: tuple[object, ...] | None = None  # whose mechanism is the starting design
        self._note = ""
        self.chosen: int | None = None

    def __len__(self) -> int:
        return len(self._designs)

    def renew(self, task: Task | None) -> None:
        """Judge all designs by a changed task; an incomplete one keeps the verdicts before."""
        if task is None:
            return
        point = task.improvement and task.improvement.point
        known = (task.mechanisms, task.wanted, point) if task.kind == "improve" else None
        if known != self._of:
            self._give(task)
            self._of = known
        if self._designs:
            wishes = self._suggesting().wishes(task)
            self._judged = [design.judged(task, wishes) for design in self._designs]

    def _give(self, task: Task) -> None:
        """Replace the mechanism that a task improves, which is the first design."""
        self._designs = [d for d in self._designs if d.origin is not Origin.GIVEN]
        try:
            start = self._suggesting().starting_design(task)
        except LinkworkError:
            return  # the search reports its problems
        if start is not None:
            self._designs.insert(0, start)

    def find_nearest(self, task: Task, count: int, progress: Callable[[float], None]) -> Events:
        """Replace the designs of the atlas by those nearest to the positions.

        Raises
        ------
        InputError
            If the positions are no curve, or the atlas cannot be read.
        """
        try:
            nearest = self._suggesting().nearest(task, count, progress)
        except OSError:
            raise InputError(
                "the atlas of paths cannot be loaded: check the connection, then try again"
            ) from None
        self._note = _SHAPE if _is_closed(task) else f"{_OPEN} {_SHAPE}"
        others = [design for design in self._designs if design.origin is not Origin.ATLAS]
        self._designs = [*others, *nearest]
        self.renew(task)
        first = len(others)
        sound = (k for k in range(first, len(self._judged)) if not self._judged[k].kinds)
        return [self.listed(), *self.choose(FIRST - next(sound, first))]

    def improve(
        self,
        task: Task,
        description: Description,
        mechanism: str,
        progress: Callable[[float], None],
    ) -> Events:
        """Add an improved design.

        Raises
        ------
        InputError
            If the task has no goal, or the search gives nothing better.
        """
        improved = self._suggesting().improved(task, description, mechanism, progress)
        self._designs.append(improved)
        self.renew(task)
        return [self.listed(), *self.choose(FIRST - len(self._designs) + 1)]

    def listed(self) -> DesignsSuggested:
        """All suggested designs for the table."""
        return DesignsSuggested(
            designs=tuple(self._shown()),
            note=self._note if any(d.origin is Origin.ATLAS for d in self._designs) else "",
        )

    def choose(self, index: int) -> Events:
        """Choose a suggested design."""
        self.chosen = index
        return [self.in_motion(index)]

    def in_motion(self, index: int) -> DesignFound:
        """A suggested design in motion.

        Raises
        ------
        InputError
            If there is none with this index.
        """
        k = self._place(index)
        return mechanism_found(self._judged[k], [*self._shown()][k], self._designs[k].point)

    def description(self, index: int) -> tuple[Description, str, str]:
        """A suggested design with its kind in words, and a name for it.

        Raises
        ------
        InputError
            If there is none with this index.
        """
        design, shown = self._designs[self._place(index)], [*self._shown()][self._place(index)]
        name = f"{shown.origin} {shown.number}".replace("as given 1", "as given")
        description = design.improved.description
        return replace(description, name=f"{description.name}, {name}"), design.mechanism, name

    def _place(self, index: int) -> int:
        k = FIRST - index
        if not 0 <= k < len(self._judged):
            raise InputError("there is no such design any more: choose one of the new ones")
        return k

    def _shown(self) -> Iterator[DesignShown]:
        numbers = dict.fromkeys(Origin, 0)
        for k, (design, judged) in enumerate(zip(self._designs, self._judged, strict=True)):
            numbers[design.origin] += 1
            yield replace(
                design_shown(judged, FIRST - k),
                origin=design.origin.value,
                number=numbers[design.origin],
                mechanism=design.mechanism,
            )


def _is_closed(task: Task) -> bool:
    points = [complex(*position.point) for position in task.positions]
    steps = [abs(b - a) for a, b in pairwise(points)]
    return abs(points[-1] - points[0]) <= _CLOSES * max(steps, default=0.0)
