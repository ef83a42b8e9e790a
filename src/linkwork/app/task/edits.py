"""What of a task is shown on the canvas, read from its tables whether they are complete or not."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import singledispatch
from itertools import pairwise
from typing import Any

from linkwork.app.live import task_requests as do
from linkwork.app.live.file_state import Point, ProblemShown
from linkwork.app.live.history import History
from linkwork.app.live.opened_file import Events
from linkwork.app.live.task_events import (
    DesignFound,
    DesignShown,
    DesignsSuggested,
    PositionShown,
    TaskState,
)
from linkwork.app.live.task_requests import LISTS
from linkwork.app.task.designs import design_shown, mechanism_found
from linkwork.core.foundation.errors import InputError, LinkworkError, choices
from linkwork.core.mechanism.description import Description
from linkwork.core.textfile.writer import TextEdits
from linkwork.synthesis.solvers.swept_design import SweptDesign
from linkwork.synthesis.suggesting import Origin, SuggestedDesign, Suggesting
from linkwork.synthesis.tasks.task import Task

Tables = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class TaskSketch:
    """The tables of a task, with the checked task if it is complete.

    ``problems``: why it is not complete.
    """

    tables: Tables
    task: Task | None
    problems: tuple[ProblemShown, ...]

    @property
    def kind(self) -> str:
        """The kind of the task; "" without one."""
        return str(self.tables.get("task", ""))

    def state(self, file: str, text: str, history: History, *, unsaved: bool) -> TaskState:
        """The state of the file for the page."""
        from_file = self.task is not None and self.task.curve is not None
        listed: Any = self.tables.get("positions")
        if from_file and self.task is not None:
            listed = [{"point": [*position.point]} for position in self.task.positions]
        return TaskState(
            file=file,
            title=str(self.tables.get("name", "Task")),
            text=text,
            unsaved=unsaved,
            undo=history.undo_what,
            redo=history.redo_what,
            task=self.kind,
            length_unit=str(self.tables.get("length", Task.length)),
            angle_unit=str(self.tables.get("angle", "deg")),
            positions=tuple(map(_shown, listed if isinstance(listed, list) else ())),
            positions_from_file=from_file,
            fixed_pivots=self._points("fixed pivot"),
            moving_pivots=self._points("moving pivot"),
            region=self._points("corner"),
            obstacles=tuple(self._numbers("obstacle", 3)),
            entries=dict(_entries(self.tables, "")),
            problems=self.problems,
        )

    def _points(self, name: str) -> tuple[Point, ...]:
        return tuple((x, y) for x, y in self._numbers(name, 2))

    def _numbers(self, name: str, count: int) -> Iterator[Any]:
        listed = entry_of(self.tables, LISTS[name])
        for entry in listed if isinstance(listed, list) else []:
            yield _numbers_of(entry, count) or (0.0,) * count


def _shown(table: Any) -> PositionShown:
    position: Tables = table if isinstance(table, Mapping) else {}
    # a place without a point is kept, so that places in the list agree with the file
    x, y = _numbers_of(position.get("point"), 2) or (0.0, 0.0)
    return PositionShown(
        x=x,
        y=y,
        angle=_number(position.get("angle")),
        input=_number(position.get("input")),
        tolerance=_number(position.get("tolerance")) or 0.0,
        angle_tolerance=_number(position.get("angle_tolerance")) or 0.0,
    )


def entry_of(tables: Tables, key: tuple[str, ...]) -> Any:
    """The entry at a path of keys; ``None`` if there is none."""
    entry: Any = tables
    for part in key:
        entry = entry.get(part) if isinstance(entry, Mapping) else None
    return entry


def _number(entry: Any) -> float | None:
    plain = isinstance(entry, int | float) and not isinstance(entry, bool)
    return float(entry) if plain and math.isfinite(entry) else None


def _numbers_of(entry: Any, count: int) -> tuple[float, ...] | None:
    listed = [_number(part) for part in entry] if isinstance(entry, list) else []
    numbers = [part for part in listed if part is not None]
    return tuple(numbers) if len(listed) == len(numbers) == count else None


def _entries(tables: Tables, where: str) -> Iterator[tuple[str, float | str]]:
    """Numbers and texts of all tables but the lists of points, by their keys."""
    shown = {".".join(key) for key in LISTS.values()}
    for key, entry in tables.items():
        name = f"{where}{key}"
        number = _number(entry)
        if name in shown:
            continue
        if isinstance(entry, str) or number is not None:
            yield name, entry if number is None else number
        elif isinstance(entry, Mapping):
            yield from _entries(entry, f"{name}.")
        elif isinstance(entry, list) and all(isinstance(part, str) for part in entry):
            yield name, ", ".join(entry)
        elif isinstance(entry, list):
            yield from _entries({str(k): part for k, part in enumerate(entry)}, f"{name}.")


# ----------------------------------------------------------------------
# Changes of a task as edits of its text.


_MOST_POINTS = 200  # of a drawn curve

#: Where a point goes that is moved: the centre-point curve holds a fixed pivot.
Snap = Callable[[complex], complex]


@singledispatch
def edit_task(edit: do.TaskEdit, text: TextEdits, snap: Snap) -> None:
    """Apply a change to a text.

    Raises
    ------
    InputError
        If the entry does not exist; the text is then invalid.
    """
    raise TypeError(f"{type(edit).__name__} is not an edit of a task")


@edit_task.register
def _(edit: do.MoveTaskPoint, text: TextEdits, snap: Snap) -> None:
    key = _place(text, edit.of, edit.index)
    point = complex(edit.x, edit.y)
    if edit.of == "fixed pivot":
        point = snap(point)
    if edit.of == "position":
        key = (*key, "point")
    if not text.has((*key, 1)):
        text.put(key, [point.real, point.imag])
        return
    text.put((*key, 0), point.real)
    text.put((*key, 1), point.imag)
    if edit.of == "obstacle" and edit.radius is not None:
        text.put((*key, 2), abs(edit.radius))


@edit_task.register
def _(edit: do.TurnPose, text: TextEdits, snap: Snap) -> None:
    text.put((*_place(text, "position", edit.index), "angle"), edit.angle)


@edit_task.register
def _(edit: do.AddTaskPoint, text: TextEdits, snap: Snap) -> None:
    key = _list_of(edit.of)
    point = complex(edit.x, edit.y)
    if edit.of == "position":
        rows = [row for _, row in text.entries("positions")]
        posed = text.has(("task",)) and text.get(("task",)) == "motion"
        last = rows[-1].get("angle", 0.0 if posed else None) if rows else 0.0 if posed else None
        angle = {} if last is None else {"angle": last}
        text.append("positions", {"point": [edit.x, edit.y], **angle})
        return
    if edit.of == "fixed pivot":
        point = snap(point)
    new = [point.real, point.imag, *([edit.radius] if edit.of == "obstacle" else [])]
    listed = text.get(key) if text.has(key) else []
    _put(text, key, [*listed, new])


@edit_task.register
def _(edit: do.RemoveTaskPoint, text: TextEdits, snap: Snap) -> None:
    text.remove(_place(text, edit.of, edit.index))
    key = _list_of(edit.of)
    if text.has(key) and not text.get(key):
        text.remove(key)


@edit_task.register
def _(edit: do.SetTaskEntry, text: TextEdits, snap: Snap) -> None:
    key: tuple[str | int, ...] = tuple(
        int(part) if part.isdigit() else part for part in edit.key.split(".")
    )
    value: Any = edit.value
    if isinstance(key[-1], int):
        if value is None and key[0] == "positions":
            raise InputError("a position has two coordinates: type a number, or remove it")
        if value is None:  # without one of its ends a range is left out
            key = key[:-1]
        elif not text.has(key[:-1]):  # the other end of a new range is typed next
            key, value = key[:-1], [value, value]
            if isinstance(key[-1], int):  # a further pair of a list, or the first one
                key = key[:-1]
                value = [*(text.get(key) if text.has(key) else ()), value]
    if value is not None:
        _put(text, key, value)
    elif text.has(key):
        text.remove(key)


@edit_task.register
def _(edit: do.DrawCurve, text: TextEdits, snap: Snap) -> None:
    points = _pairs(edit.points)
    if not 2 <= len(points) <= _MOST_POINTS:
        raise InputError(f"a drawn curve has 2 to {_MOST_POINTS} points, got {len(points)}")
    for table in ("curve", "positions"):
        if text.has((table,)):
            text.remove((table,))
    text.put(("task",), "path")
    for x, y in points:
        text.append("positions", {"point": [x, y]})


@edit_task.register
def _(edit: do.SetRegion, text: TextEdits, snap: Snap) -> None:
    _put(text, do.LISTS["corner"], [list(corner) for corner in _pairs(edit.corners)])


def _pairs(numbers: tuple[float, ...]) -> list[tuple[float, float]]:
    if len(numbers) % 2:
        raise InputError(f"points are x, y, x, y, …: got {len(numbers)} numbers")
    return list(zip(numbers[::2], numbers[1::2], strict=True))


def _list_of(name: str) -> tuple[str, ...]:
    if name not in do.LISTS:
        raise InputError(f'a task has no "{name}" {choices("lists", do.LISTS, name)}')
    return do.LISTS[name]


def _place(text: TextEdits, name: str, index: int) -> tuple[str | int, ...]:
    key: tuple[str | int, ...] = (*_list_of(name), index)
    if index < 0 or not text.has(key):
        raise InputError(f"there is no {name} {index + 1}: it may have been removed")
    return key


def _put(text: TextEdits, key: Iterable[str | int], entry: Any) -> None:
    """Write an entry; a missing table inside a table is written in one line."""
    path = tuple(key)
    while len(path) > 2 and not text.has(path[:-1]):
        path, entry = path[:-1], {str(path[-1]): entry}
    text.put(path, entry)


_TITLES: dict[type, Callable[[Any], str]] = {
    do.MoveTaskPoint: lambda edit: f"{edit.of} {edit.index + 1} moved",
    do.TurnPose: lambda edit: f"position {edit.index + 1} turned",
    do.AddTaskPoint: lambda edit: f"{edit.of} added",
    do.RemoveTaskPoint: lambda edit: f"{edit.of} {edit.index + 1} removed",
    do.SetTaskEntry: lambda edit: f"{edit.key} changed",
    do.DrawCurve: lambda edit: "curve drawn",
    do.SetRegion: lambda edit: "region of pivots drawn",
}


def task_edit_title(edit: do.TaskEdit) -> str:
    """What a change is called in the history."""
    return _TITLES[type(edit)](edit)


# ----------------------------------------------------------------------
# The designs that were suggested for a task: of the atlas, improved, or its starting design.


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
