"""The problems with which an edit is refused."""

from __future__ import annotations

from collections.abc import Callable

from linkwork.foundation.errors import Problem
from linkwork.viewer.live import requests as ask

__all__ = ["Refusing", "refusing"]

Refusing = Callable[[Problem], bool]

#: Edits that change numbers or choices, not what there is.
_OF_NUMBERS = (
    ask.SetNumber, ask.SetPart, ask.SetEntry, ask.MovePoint, ask.MovePoints, ask.SetInput,
    ask.ChooseConfiguration, ask.TracePoint, ask.ChangeUnits, ask.AddOutput,
)  # fmt: skip


def refusing(edit: ask.Edit) -> Refusing:
    """The problems with which an edit is refused.

    An edit that only changes numbers or choices may not cause any, and a new part may not be wrong
    itself; other edits may leave a draft.
    """
    if isinstance(edit, _OF_NUMBERS):
        return lambda problem: True
    if isinstance(edit, ask.AddPart | ask.DrawPart):
        return lambda problem: problem.key[:1] == (edit.table,)
    return lambda problem: False
