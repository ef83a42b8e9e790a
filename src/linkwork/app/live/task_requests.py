"""Requests of the page of a task: changes of its text, and questions about its designs.

A thing of a task that is moved on the canvas is named by its list, see :data:`LISTS`, and its place
in it.
"""

from __future__ import annotations

from dataclasses import dataclass

#: The lists of points of a task, with their keys in the file.
LISTS = {
    "position": ("positions",),
    "fixed pivot": ("given", "fixed_pivots"),
    "moving pivot": ("given", "moving_pivots"),
    "corner": ("wanted", "fixed_pivots", "inside"),
    "obstacle": ("wanted", "clear_of"),
}


@dataclass(frozen=True, kw_only=True)
class MoveTaskPoint:
    """Move a point of a task [length]; a fixed pivot of four poses stays on their centre-point
    curve. ``radius``: of an obstacle, by default the present one.
    """

    of: str
    index: int
    x: float
    y: float
    radius: float | None = None
    live: bool = False


@dataclass(frozen=True, kw_only=True)
class TurnPose:
    """Set the angle of a pose [file's angle unit]."""

    index: int
    angle: float
    live: bool = False


@dataclass(frozen=True, kw_only=True)
class AddTaskPoint:
    """Add a point at the end of its list [length]; a position of poses gets the angle of the last.

    ``radius``: of an obstacle.
    """

    of: str
    x: float
    y: float
    radius: float = 0.0


@dataclass(frozen=True, kw_only=True)
class RemoveTaskPoint:
    """Remove a point of a task."""

    of: str
    index: int


@dataclass(frozen=True, kw_only=True)
class SetTaskEntry:
    """Set an entry of a task, named by its keys, or remove it if the value is ``None``.

    Numbers among the keys are places in lists: ``positions.0.angle``.
    """

    key: str
    value: float | str | None = None
    live: bool = False


@dataclass(frozen=True, kw_only=True)
class DrawCurve:
    """Replace all positions by points of a drawn curve, in their order: x, y, x, y, …"""

    points: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class SetRegion:
    """Set the corners of the region of all fixed pivots: x, y, x, y, …"""

    corners: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class ShowDesign:
    """Show a design, by its place in the list."""

    design: int


@dataclass(frozen=True, kw_only=True)
class ShowCognates:
    """List the cognates of a four-bar with one coupler curve, by its place in the list."""

    design: int


@dataclass(frozen=True, kw_only=True)
class FindNearest:
    """Find the designs of the atlas whose paths are nearest to the positions."""

    count: int = 10


@dataclass(frozen=True, kw_only=True)
class ImproveDesign:
    """Improve a design, by its place in the list; a cancellation keeps the best so far."""

    design: int


@dataclass(frozen=True, kw_only=True)
class SolveTask:
    """Solve the task again, after the search was ended."""


@dataclass(frozen=True, kw_only=True)
class OpenTask:
    """Open a task to begin with as a new file; ``discard``: even if changes are not saved."""

    name: str
    discard: bool = False


@dataclass(frozen=True, kw_only=True)
class OpenDesign:
    """Open a design as a mechanism, by its place in the list; the task stays behind it."""

    design: int


@dataclass(frozen=True, kw_only=True)
class ReturnToTask:
    """Go back to the task of an opened design; ``discard``: even if it has unsaved changes."""

    discard: bool = False


#: A change of the text of a task.
TaskEdit = (
    MoveTaskPoint | TurnPose | AddTaskPoint | RemoveTaskPoint | SetTaskEntry | DrawCurve | SetRegion
)

#: A question about the designs of a task, which changes nothing.
TaskQuestion = ShowDesign | ShowCognates | FindNearest | ImproveDesign | SolveTask

TaskRequest = TaskEdit | TaskQuestion | OpenTask | OpenDesign | ReturnToTask

TASK_EDITS: tuple[type, ...] = TaskEdit.__args__
#: Requests that need an opened task.
OF_TASKS: tuple[type, ...] = (*TASK_EDITS, *TaskQuestion.__args__)
