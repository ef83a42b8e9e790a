"""Intermediate changes of a drag, which become one step of the history."""

from __future__ import annotations

from dataclasses import dataclass

from linkwork.textfile.text_edits import TextEdits
from linkwork.viewer.live import requests as ask, task_requests as do
from linkwork.viewer.live.messages import kind_of
from linkwork.viewer.live.moving_points import Before
from linkwork.viewer.live.queries import Query

__all__ = ["Drag", "goes_on", "same_thing"]


@dataclass(kw_only=True)
class Drag:
    """An intermediate change: the text it changes, and the mechanism at its start."""

    kind: str
    text: TextEdits
    before: Before
    what: str = ""
    latest: str | None = None


def same_thing(edit: ask.Request) -> str:
    """A key of the dragged object: changes with equal keys are merged."""
    match edit:
        case ask.SetNumber():
            return f"number {edit.name}"
        case ask.MovePoint():
            return f"point {edit.point} {edit.lengths_follow}"
        case ask.MovePoints():
            return f"points {' '.join(edit.places)}"
        case do.MoveTaskPoint():
            return f"{edit.of} {edit.index}"
        case do.TurnPose():
            return f"angle {edit.index}"
        case do.SetTaskEntry():
            return f"entry {edit.key}"
        case _:
            return kind_of(type(edit))


def goes_on(request: ask.Request, drag: Drag | None) -> bool:
    """Whether a request belongs to an intermediate change or does not affect it."""
    asking = isinstance(request, Query | ask.Question) and not isinstance(request, ask.Export)
    if drag is None or asking:
        return True
    return isinstance(request, ask.EDITS) and same_thing(request) == drag.kind
