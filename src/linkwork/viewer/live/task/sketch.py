"""What of a task is shown on the canvas, read from its tables whether they are complete or not."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from linkwork.design.tasks.task import Task
from linkwork.viewer.live.events import TaskState
from linkwork.viewer.live.file_state import Point, ProblemShown
from linkwork.viewer.live.history import History
from linkwork.viewer.live.task_events import PositionShown
from linkwork.viewer.live.task_requests import LISTS

__all__ = ["TaskSketch", "entry_of"]

Tables = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class TaskSketch:
    """The tables of a task, with the checked task if it is complete.

    ``problems``: what keeps it from being complete.
    """

    tables: Tables
    task: Task | None
    problems: tuple[ProblemShown, ...]

    @property
    def kind(self) -> str:
        """The kind of the task; "" if it is not given."""
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
    found: Any = tables
    for part in key:
        found = found.get(part) if isinstance(found, Mapping) else None
    return found


def _number(entry: Any) -> float | None:
    plain = isinstance(entry, int | float) and not isinstance(entry, bool)
    return float(entry) if plain and math.isfinite(entry) else None


def _numbers_of(entry: Any, count: int) -> tuple[float, ...] | None:
    listed = [_number(part) for part in entry] if isinstance(entry, list) else []
    found = [part for part in listed if part is not None]
    return tuple(found) if len(listed) == len(found) == count else None


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
